"""What one impact of many costs, for both laws, on kinds of impacts and shuffled mixtures of them.

    python benchmarks/bench_batch.py

Prints nanoseconds per impact (median of the turns) for the kinds in turn and for their mixtures, by threads on all
processors and by one, the memory that is needed beyond inputs and outputs, and how long a map of 1000 x 1000 takes.
"""

from __future__ import annotations

import os
import statistics
import sys
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from impact_predictor import Twist, TwoPointBody, plate, solve_impacts
from impact_predictor.mechanics.impact.batch import numbers_of, processors
from impact_predictor.mechanics.random_problems import problems_of

COUNT = 1_000_000
TURNS = 5
LAWS = ("total", "path")
MIXTURE = ("plate", "cylinder", "floor", "wedge", "tilted", "deck", "both")
PAPER = ("plate", "cylinder", "floor")


def mixture(count: int, kinds: tuple[str, ...] = MIXTURE) -> tuple[TwoPointBody, Twist]:
    """Impacts of several kinds in random order."""
    source = np.random.default_rng(1)
    parts: Any = [problems_of(kind, source, count // len(kinds) + 1) for kind in kinds]
    order = source.permutation(count)
    rows = [(body.mass, body.inertia, *twist, *numbers_of(body.old), *numbers_of(body.new)) for _, body, twist in parts]
    fields: list[Any] = [np.concatenate(column)[order] for column in zip(*rows, strict=True)]
    mass, inertia, vx, vy, omega, *numbers = fields
    old, new = (
        parts[0][1].new._replace(
            x=x, y=y, friction=friction, normal=(nx, ny), restitution=restitution, velocity=(ux, uy)
        )
        for x, y, friction, nx, ny, restitution, ux, uy in (numbers[:8], numbers[8:])
    )
    return TwoPointBody(mass, inertia, old, new), Twist(vx, vy, omega)


def median_seconds(function: Callable[[], object]) -> float:
    function()
    times = []
    for _ in range(TURNS):
        start = perf_counter()
        function()
        times.append(perf_counter() - start)
    return statistics.median(times)


@contextmanager
def one_processor() -> Iterator[None]:
    """Leave the process one of its processors meanwhile, so that there is one thread."""
    usual = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(usual)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, usual)


def both_medians(function: Callable[[], object]) -> tuple[float, float]:
    """By threads on all processors, and by one."""
    by_all = median_seconds(function)
    with one_processor():
        return by_all, median_seconds(function)


def beyond_outputs(body: TwoPointBody, twist: Twist, law: str) -> float:
    """Bytes per impact at the peak, less those of the outcomes."""
    tracemalloc.start()
    outcomes = solve_impacts(body, twist, law)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return (peak - sum(field.nbytes for field in outcomes)) / outcomes.mode.size


def main() -> None:
    """Time the kinds and their mixture, and print the tables."""
    if "numba" not in sys.modules:
        solve_impacts(*problems_of("plate", np.random.default_rng(0), 1)[1:])
    fast = f"compiled with numba, {processors()} threads"
    print(fast if "numba" in sys.modules else "plain Python: install the extra `fast` for numba")
    count = COUNT if "numba" in sys.modules else COUNT // 100
    cases: dict[str, Any] = {kind: problems_of(kind, np.random.default_rng(1), count // 10)[1:] for kind in MIXTURE}
    cases[f"{', '.join(PAPER)}, shuffled, {count:,}"] = mixture(count, PAPER)
    cases[f"all of them, shuffled, {count:,}"] = mixture(count)
    columns = (column for law in LAWS for column in (f"{law}: ns", "one thread"))
    table = Table("kind", *columns, title="One impact of many, median")
    for name, (body, twist) in cases.items():
        medians = (both_medians(partial(solve_impacts, body, twist, law)) for law in LAWS)
        size = np.broadcast(body.mass, twist.omega).size
        table.add_row(name, *(f"{1e9 * seconds / size:.0f}" for pair in medians for seconds in pair))
    Console().print(table)
    print(f"memory beyond inputs and outputs: {beyond_outputs(*mixture(count), 'path'):.2f} bytes per impact")
    heights, frictions = np.linspace(0.01, 2.0, 1000)[:, None], np.linspace(0.0, 1.5, 1000)
    body = plate(length=1.0, height=heights, mass=1.0, friction=frictions)
    for law in LAWS:
        by_all, by_one = both_medians(partial(solve_impacts, body, body.turning(omega=-1.0), law))
        print(f"map of 1000 x 1000, {law} law: {by_all:.3f} s, one thread {by_one:.3f} s")


if __name__ == "__main__":
    main()
