"""What one impact costs, for each of the paper's bodies and both laws.

    python benchmarks/bench_impact.py

The bodies take turns, so that a slow moment of the machine meets all of them. Prints medians in microseconds, and
in units of `[i * i for i in range(100)]`, which says how slow the machine was; where the laws were compiled
(`make compiled`) beside the same files as Python.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from time import perf_counter_ns

from rich.console import Console
from rich.table import Table

from impact_predictor import Twist, TwoPointBody, cylinder, native, plate, rod, solve_impact

TURNS = 300
CALLS = 20
"""Calls that are timed together."""


def turning(body: TwoPointBody) -> tuple[TwoPointBody, Twist]:
    """The body while it turns about its old contact."""
    return body, body.turning(-1.0)


CASES = {
    "plate, slides": turning(plate(length=1.0, height=0.4, mass=10.0, friction=0.2)),
    "plate, stops": turning(plate(length=1.0, height=0.4, mass=10.0, friction=0.9)),
    "plate, pivots": turning(plate(length=1.0, height=3.0, mass=10.0, friction=0.9)),
    "rod, pivots": turning(rod(length=0.4, thickness=0.01, a=0.1, b=0.1, mass=0.3, friction=0.4)),
    "cube with slip, restitution": (
        plate(length=0.1, height=0.1, mass=0.37, friction=0.18, inertia=8.1e-4, restitution=0.125),
        Twist(-0.3, -0.5, -10.0),
    ),
    "cylinder, rolls over the edge": turning(cylinder(radius=1.0, gamma=0.9, mass=2.0, friction=0.5)),
    "cylinder, slides": turning(cylinder(radius=1.0, gamma=1.3, mass=2.0, friction=0.1)),
    "cylinder, locks in the wedge": turning(cylinder(radius=1.0, gamma=1.2, mass=2.0, friction=1.0)),
}


def calibrate() -> object:
    """A piece of plain Python of the length of an impact, to compare machines by."""
    return [i * i for i in range(100)]


def call(solve: Callable[..., object], case: tuple[TwoPointBody, Twist], law: str) -> Callable[[], object]:
    """The impact as a function without arguments."""
    body, twist = case
    return lambda: solve(body, twist, law)


def main() -> None:
    """Time every body under both laws and print the table."""
    forms: dict[str, Callable[..., object]] = {native.form(): solve_impact}
    if "compiled" in forms:
        forms["as Python"] = native.as_python("mechanics.impact.solve").solve_impact
    functions = {
        (name, law, form): call(solve, case, law)
        for name, case in CASES.items()
        for law in ("path", "total")
        for form, solve in forms.items()
    }
    functions["calibration", "", ""] = calibrate
    times: dict[tuple[str, str, str], list[float]] = {key: [] for key in functions}
    for _ in range(TURNS):
        for key, function in functions.items():
            start = perf_counter_ns()
            for _ in range(CALLS):
                function()
            times[key].append((perf_counter_ns() - start) / CALLS / 1e3)
    medians = {key: statistics.median(values) for key, values in times.items()}
    unit = medians["calibration", "", ""]
    for form in forms:
        table = Table("body", "mode", "path: us", "units", "total: us", "units", title=f"One impact, median, {form}")
        for name, (body, twist) in CASES.items():
            mode = solve_impact(body, twist).mode.name
            path, total = medians[name, "path", form], medians[name, "total", form]
            table.add_row(name, mode, *(f"{number:.1f}" for number in (path, path / unit, total, total / unit)))
        Console().print(table)
    print(f"unit: {unit:.2f} us")


if __name__ == "__main__":
    main()
