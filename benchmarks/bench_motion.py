"""What the next touchdown costs: the golden falls, a stance that slips, a flight.

    python benchmarks/bench_motion.py

Prints the median time of a call in microseconds, and that of the slowest tenth.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter_ns

from impact_predictor.mechanics.motion import PlanarState, next_touchdown
from impact_predictor.mechanics.types import Vector

FALLS = Path(__file__).resolve().parents[1] / "test/mechanics/golden/motion.json"
PLATE = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
CALLS = 2000

Arguments = tuple[PlanarState, tuple[Vector, ...], int | None, float, float]


def standing(point: Vector, angle: float, omega: float, slip: float) -> PlanarState:
    """A body that stands on a point, turns about it and slips."""
    sine, cosine = math.sin(angle), math.cos(angle)
    x, y = cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]
    return PlanarState(0.0, -y, angle, slip + omega * y, -omega * x, omega)


def cases() -> Iterator[tuple[str, Arguments]]:
    """What is timed, and the arguments of the call."""
    for fall in json.loads(FALLS.read_text())["falls"]:
        a, h, rho_squared, _, angle, omega, *_ = (float(value) for value in fall.values())
        points = ((-a, -h), (a, -h))
        state = standing(points[0], angle, omega, 0.0)
        name = f"golden fall, a = {a}, h = {h}, phi0 = {angle}, omega0 = {omega}"
        yield name, (state, points, 0, rho_squared, math.inf)
    fallen = standing(PLATE[0], 0.2, -0.5, 0.0)
    yield "plate, turning inside the friction cone", (fallen, PLATE, 0, 0.1, 1.0)
    yield "plate, slip starts on the way", (standing(PLATE[0], 0.2, 0.0, 0.0), PLATE, 0, 0.1, 0.2)
    yield "plate, slip stops on the way", (standing(PLATE[0], 0.2, 0.0, 0.02), PLATE, 0, 0.1, 1.0)
    yield "plate, slips all the way", (standing(PLATE[0], 0.2, -0.5, 1.0), PLATE, 0, 0.1, 0.2)
    yield "plate, thrown", (PlanarState(0.0, 1.0, 0.2, 1.0, 0.5, 6.0), PLATE, None, 0.1, 0.2)


def main() -> None:
    """Time every case and print a row for it."""
    print(f"{'median':>8} {'90 %':>8}   us per call")
    for name, arguments in cases():
        times = []
        for _ in range(CALLS):
            start = perf_counter_ns()
            next_touchdown(*arguments)
            times.append(perf_counter_ns() - start)
        times.sort()
        print(f"{times[CALLS // 2] / 1e3:8.1f} {times[CALLS * 9 // 10] / 1e3:8.1f}   {name}")


if __name__ == "__main__":
    main()
