"""What one impact in three dimensions costs, at 1 to 8 contacts.

    python benchmarks/bench_spatial.py

Bodies of random twists strike a floor with the corners of a regular polygon. Prints medians in microseconds: of the law
as the predictor calls it, by numba, as machine code (`make compiled`) and as Python; of 16 draws at once; and of a call
of `solve_spatial_impact`. What a whole sample costs, with draws and without, is told by `bench_predictor.py`.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from time import perf_counter_ns

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from impact_predictor import Body, ContactPoints, solve_spatial_impact
from impact_predictor.mechanics.compiled import without_numba
from impact_predictor.mechanics.impact import spatial_body
from impact_predictor.mechanics.impact.spatial import STEPS, solver, workspace
from impact_predictor.mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT
from impact_predictor.native import as_python
from impact_predictor.prediction.draws import DRAW_STEPS

TURNS, BODIES = 15, 64
MASS, MOMENTS, FRICTION, RESTITUTION = 2.0, (0.03, 0.04, 0.05), 0.4, 0.3
MERGE, THRESHOLD = 1.5e-3, 0.05
DRAWS, DEVIATION = 16, 5e-4


def corners(n: int) -> NDArray[np.float64]:
    """The corners (n, 3) of a regular polygon below the mass centre, in m."""
    angles = 0.3 + 2.0 * np.pi * np.arange(n) / n
    return np.stack((0.2 * np.cos(angles), 0.15 * np.sin(angles), np.full(n, -0.1)), axis=1)


def twists() -> NDArray[np.float64]:
    """Twists (BODIES, 6) of bodies that come down, in m/s and rad/s."""
    numbers = np.random.default_rng(1).normal(size=(BODIES, 6)) * (0.5, 0.5, 0.1, 1.0, 1.0, 1.0)
    numbers[:, 2] -= 1.5
    return numbers


def problems(n: int) -> NDArray[np.float64]:
    """The bodies as the law takes them (see `spatial_body`)."""
    contacts = [(*place, 0.0, 0.0, 1.0, FRICTION, RESTITUTION, 0.0, 0.0, 0.0, 0.0) for place in corners(n)]
    return np.array([(MASS, *MOMENTS, 0.0, 0.0, 0.0, *twist, *np.ravel(contacts)) for twist in twists()])


def law_of(n: int, law: Callable[..., None]) -> Callable[[], object]:
    """The law over all bodies, as a function without arguments."""
    given, notes = problems(n), np.zeros(BODIES, np.int64)
    answers, work = np.zeros((BODIES, ANSWER + RESULT * n)), workspace(n)
    return lambda: law(n, given, False, MERGE, THRESHOLD, STEPS, answers, notes, *work)


def draws_of(n: int) -> Callable[[], object]:
    """The compiled law over draws of all bodies, which differ in what contacts are still open, as `law_of`."""
    law, source = solver(), np.random.default_rng(2)
    drawn = np.repeat(problems(n), DRAWS, axis=0)
    gaps = np.abs(source.normal(size=(len(drawn), n)) * DEVIATION)
    drawn[:, BODY:].reshape(-1, n, CONTACT)[:, :, 11] = gaps - gaps.min(axis=1)[:, None]
    answers, notes, work = np.zeros((len(drawn), ANSWER + RESULT * n)), np.zeros(len(drawn), np.int64), workspace(n)
    return lambda: law(n, drawn, False, MERGE, THRESHOLD, DRAW_STEPS, answers, notes, *work)


def calls_of(n: int) -> Callable[[], object]:
    """A call for each body, as a function without arguments."""
    body, points, all_of = Body(MASS, MOMENTS), ContactPoints(corners(n), FRICTION, RESTITUTION), twists()
    return lambda: [solve_spatial_impact(body, points, twist) for twist in all_of]


def main() -> None:
    """Time all of them in turns and print the table."""
    laws = {
        "law, numba": solver(),
        "law, machine code": without_numba(spatial_body.strike_all),
        "law, Python": without_numba(as_python(spatial_body.__name__.partition(".")[2]).strike_all),
    }
    functions = {(name, n): law_of(n, law) for n in (1, 2, 4, 8) for name, law in laws.items()}
    functions |= {(f"law, {DRAWS} draws", n): draws_of(n) for n in (1, 2, 4, 8)}
    functions |= {("solve_spatial_impact", n): calls_of(n) for n in (1, 2, 4, 8)}
    times: dict[tuple[str, int], list[float]] = {key: [] for key in functions}
    for _ in range(TURNS):
        for key, function in functions.items():
            start = perf_counter_ns()
            function()
            times[key].append((perf_counter_ns() - start) / BODIES / 1e3)
    table = Table("us per impact, by contacts", "1", "2", "4", "8")
    for name in (*laws, f"law, {DRAWS} draws", "solve_spatial_impact"):
        table.add_row(name, *(f"{statistics.median(times[name, n]):.1f}" for n in (1, 2, 4, 8)))
    Console().print(table)


if __name__ == "__main__":
    main()
