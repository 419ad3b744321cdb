"""What the next touchdown in three dimensions costs where bodies come to rest, and how long the longest take.

    python benchmarks/bench_falls.py [BODIES]

Boxes stand on up to four corners, or fall from nearby. Their tilt, lift, slip and spin go down to rounding: there
points rest and lift in turns, and directions of slips turn within no time. Prints microseconds of the thread, by numba
where that is installed, and which bodies take longest.
"""

from __future__ import annotations

import random
import sys
from itertools import product
from time import thread_time_ns

import numpy as np
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.motion.spatial import SpatialState, fall
from impact_predictor.mechanics.types import Vector3

BODIES = 20_000
FRICTIONS = (0.0, 0.1, 0.17, 0.5, 1.0, 2.0)
HORIZON = 0.25


def box(draw: random.Random) -> tuple[SpatialState, list[float], list[Vector3], list[int], float]:
    """A box in m, what stands of it, and its friction: the arguments of `fall`."""
    a, b, c = (
        draw.uniform(0.02, 0.08),
        draw.uniform(0.02, 0.08),
        draw.uniform(0.02, 0.08) * draw.choice([0.1, 1.0, 5.0]),
    )
    corners = [(x, y, z) for x, y, z in product((-a, a), (-b, b), (-c, c))]
    inertia = [(b * b + c * c) / 3.0, (a * a + c * c) / 3.0, (a * a + b * b) / 3.0, 0.0, 0.0, 0.0]
    tilt, slip, turn = 10.0 ** draw.uniform(-9.0, 0.0), 10.0 ** draw.uniform(-8.0, 0.3), 10.0 ** draw.uniform(-8.0, 0.7)
    pose = Rotation.from_rotvec(
        [draw.gauss(0.0, tilt), draw.choice([0.0, draw.gauss(0.0, tilt)]), draw.uniform(-3.0, 3.0)]
    )
    heights = pose.apply(corners)[:, 2]
    standing = [int(i) for i in heights.argsort()[: draw.randrange(5)]]
    above = draw.choice([0.0, draw.gauss(0.0, 1e-4)]) if standing else 10.0 ** draw.uniform(-9.0, -1.0)
    lifts = draw.choice([0.0, turn])
    vx, vy, vz = (draw.gauss(0.0, slip) for _ in range(3))
    state = SpatialState(
        position=(0.0, 0.0, above - float(heights.min())),
        orientation=tuple(pose.as_quat().tolist()),
        velocity=(vx, vy, vz),
        angular_velocity=(draw.gauss(0.0, lifts), draw.gauss(0.0, lifts), draw.gauss(0.0, turn)),
    )
    return state, inertia, corners, standing, draw.choice(FRICTIONS)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else BODIES
    draw, costs = random.Random(1), []
    fall(*box(random.Random(0)), horizon=HORIZON)
    for number in range(count):
        given = box(draw)
        started = thread_time_ns()
        fall(*given, horizon=HORIZON)
        costs.append(((thread_time_ns() - started) * 1e-3, number))
    times = [time for time, _ in costs]
    median, late, later = np.percentile(times, [50.0, 99.0, 99.9])
    print(f"{count} bodies: median {median:.0f} us, 99 % below {late:.0f}, 99.9 % below {later:.0f}")
    for time, number in sorted(costs, reverse=True)[:3]:
        print(f"{time:8.0f} us  body {number}")


if __name__ == "__main__":
    main()
