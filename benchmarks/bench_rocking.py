"""What following a rocking motion costs: the three rods of Fig. 2, and a crate and a drum on a ship's deck.

What the next strike alone costs, too: as a predictor asks for it, over a deck told by functions quadratic in time.

    python benchmarks/bench_rocking.py

Prints minima and medians of several runs. The first lines include the start of Python and all imports.
"""

from __future__ import annotations

import math
import random
import statistics
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter

from harmonic_deck import Wave, harmonic_support

from impact_predictor import TwoPointBody, cylinder, plate, rod
from impact_predictor.mechanics.motion import PlanarState, Trajectory, next_strike, rock, standing
from impact_predictor.mechanics.motion.felt import FeltPolynomials, FrameAcceleration
from impact_predictor.mechanics.motion.support import MovingSupport

REPEATS = 5
HORIZON, STRIKES = 0.25, 1000
RODS = tuple(rod(0.4, 0.0, a, a, mass=0.3, friction=1e3) for a in (0.1, 0.075, 0.05))
ALONE = """
from math import radians
from impact_predictor import rod
from impact_predictor.mechanics.motion import rock, standing
for a in (0.1, 0.075, 0.05):
    body = rod(0.4, 0.0, a, a, mass=0.3, friction=1e3)
    rock(body, standing(body, radians(30.0)))
"""


def timed(work: Callable[[], object], repeats: int = REPEATS) -> tuple[float, float]:
    """Minimum and median of some runs, in s."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return min(times), statistics.median(times)


def show(name: str, times: tuple[float, float], unit: float = 1e3, per: float = 1.0) -> None:
    print(f"{times[0] * unit / per:10.2f} {times[1] * unit / per:10.2f}   {name}")


def rods() -> list[Trajectory]:
    return [rock(body, standing(body, math.radians(30.0))) for body in RODS]


def deck(waves: int, sway: float, slowest: float, fastest: float, roll: float = 0.05) -> MovingSupport:
    """A deck in a sea of some waves each (rad/s) of roll, sway and heave, 5 m beside its axis and 4 m above it.

    `sway` and `roll` are the rms accelerations in m/s^2 and rad/s^2.
    """
    draw = random.Random(1)

    def sea(size: float) -> tuple[Wave, ...]:
        paces = [draw.uniform(slowest, fastest) for _ in range(waves)]
        return tuple(Wave(size * math.sqrt(2.0 / waves) / pace**2, pace, draw.uniform(0.0, 6.3)) for pace in paces)

    return harmonic_support(angle=sea(roll), x=sea(sway), y=sea(1.0)).at(5.0, 4.0)


def main() -> None:
    """Time every case and print a row for it."""
    print(f"{'min':>10} {'median':>10}   ms")
    root = Path(__file__).resolve().parents[1]
    show("start of Python alone", timed(lambda: subprocess.run([sys.executable, "-c", ""], check=True)))
    start = [sys.executable, "-c", ALONE]
    show("the three rods of Fig. 2, with start and imports", timed(lambda: subprocess.run(start, check=True, cwd=root)))
    show("the three rods of Fig. 2", timed(rods))
    runs = rods()
    impacts = sum(len(run.impacts) for run in runs)
    print(f"{'':>21}   ... {impacts} impacts followed one by one, {len(runs)} accumulations passed")
    show("dense output of the three rods at 1000 times each", timed(lambda: [sample(run) for run in rods()]))

    print(f"\n{'min':>10} {'median':>10}   us for each simulated second on a moving deck")
    crate = plate(length=0.6, height=1.2, mass=500.0, friction=0.6)
    slippery = plate(length=0.8, height=0.6, mass=500.0, friction=0.1)
    drum = cylinder(radius=0.4, gamma=0.35, mass=300.0, friction=0.4)
    for name, body, support in (
        ("crate at rest, 3 waves", crate, deck(1, 0.5, 0.8, 1.5)),
        ("crate at rest, 60 waves", crate, deck(20, 0.5, 0.8, 1.5)),
        ("crate that slides, 60 waves", slippery, deck(20, 0.5, 0.8, 1.5)),
        ("crate that rocks, 60 waves", crate, deck(20, 1.6, 3.0, 9.0)),
        ("drum that rolls in its gap, 60 waves", drum, deck(20, 0.9, 3.0, 9.0)),
    ):
        deck_case(name, body, support)

    print(f"\n{'min':>10} {'median':>10}   us for the next strike within {HORIZON} s, steps to 1e-6; minimum to 1e-9")
    for name, body, state, old in (
        ("crate that sticks", crate, standing(crate, 0.06, -0.5), 0),
        ("crate whose slip stops", crate, standing(crate, 0.06, -0.5, 0.05), 0),
        ("crate that slips", slippery, standing(slippery, 0.06, -0.5, 0.4), 0),
        ("crate in flight", crate, standing(crate, 0.05, -0.5)._replace(vx=0.1, vy=0.3), None),
        ("crate that does not strike", crate, standing(crate, 0.2), 0),
        ("drum that rolls", drum, standing(drum, 0.1, -0.5), 0),
    ):
        strike_case(name, body, state, old)


def felt(time: float) -> FrameAcceleration:
    """What is felt on a deck, of functions of time that cost next to nothing."""
    return 0.3 + (0.4 - 0.1 * time) * time, -9.7 + (0.5 + 0.3 * time) * time, 0.05 + 0.1 * time, 0.1


def strike_case(name: str, body: TwoPointBody, start: PlanarState, old: int | None) -> None:
    """Time the next strike, and say when and how it comes."""
    support = FeltPolynomials(lambda times: [felt(time) for time in times], HORIZON, nodes=3)
    fast, exact = (
        timed(partial(next_strike, body, start, old, support, HORIZON, tolerance), STRIKES)
        for tolerance in (1e-6, 1e-9)
    )
    fall = next_strike(body, start, old, support, HORIZON)
    comes = "none" if fall is None else f"after {fall.time:.3f} s, {fall.motion.name}"
    show(f"{exact[0] * 1e6:8.2f}   {name}: {comes}", fast, 1e6)


def sample(run: Trajectory) -> object:
    import numpy as np

    return run.state(np.linspace(0.0, run.time, 1000))


def deck_case(name: str, body: TwoPointBody, support: MovingSupport) -> None:
    """Time ten minutes on a deck, and say what happened."""
    runs: list[Trajectory] = []

    def follow() -> None:
        # A new support each time: it keeps what it has worked out.
        runs.append(rock(body, standing(body, 0.0), support.at(0.0, 0.0), duration=600.0))

    times = timed(follow)
    run = runs[-1]
    moves = sum(phase.end - phase.start for phase in run.phases if phase.states != "SS")
    show(
        f"{name}: {run.end.name}, {len(run.impacts)} impacts, moves {moves:.0f} of {run.time:.0f} s",
        times,
        1e6,
        run.time,
    )


if __name__ == "__main__":
    main()
