"""The impacts that benchmarks/compliant.py studies: a few bodies, and random problems that both laws answer."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from compliant_impact import compliant_impact, velocities

from impact_predictor.mechanics.bodies import plate
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.invariants import problem_at
from impact_predictor.mechanics.random_problems import problems_of
from impact_predictor.mechanics.types import Flag, Mode, Outcome, Twist, TwoPointBody

SEED = 5

UNANSWERED = Flag.NO_SOLUTION | Flag.LAST_RESORT
FIRM, FIRMER = (50.0, 50.0), (500.0, 500.0)
"""Damping ratios of contacts that rebound by 1e-4 and 1e-6."""

DIFFERENT = 0.02
"""The laws differ where their answers do by more than this; an answer is a law's within a tenth of the difference."""

BODIES: dict[str, tuple[TwoPointBody, float, float]] = {
    "PIVOT": (plate(1.0, 1.0, 10.0, 0.8), -1.0, 0.0),
    "PIVOT_SLIDE": (plate(1.0, 1.0, 10.0, 0.5), -1.0, 0.0),
    "SLIDE": (plate(1.0, 0.4, 10.0, 0.1), -1.0, 0.0),
    "STOP": (plate(1.0, 0.4, 10.0, 0.5), -1.0, 0.0),
    "slips before": (plate(1.0, 0.6, 10.0, 0.5), -1.0, -0.2),
}
"""A body, the angular velocity at which it turns about the old contact, and the slip there."""


class Case(NamedTuple):
    """A plastic impact, the answers of both laws, and V."""

    kind: str
    body: TwoPointBody
    twist: Twist
    path: Outcome
    total: Outcome
    speed: float


def difference(body: TwoPointBody, one: Twist, other: Twist, before: Twist) -> float:
    """The largest difference of a contact velocity, over the contact speeds before."""
    change = np.abs(np.subtract(velocities(body, one), velocities(body, other))).max()
    return float(change / np.abs(velocities(body, before)).sum())


def moving(name: str) -> tuple[TwoPointBody, Twist]:
    """One of the `BODIES` with its twist."""
    body, omega, slip = BODIES[name]
    twist = body.turning(omega)
    return body, twist._replace(vx=twist.vx + slip)


def cases(kind: str, count: int) -> Iterator[Case]:
    """Random plastic impacts of one kind that both laws answer."""
    problems = problems_of(kind, np.random.default_rng(SEED), count)
    for i in range(count):
        body, twist = problem_at(problems.body, i), problem_at(problems.twist, i)
        body = body._replace(old=body.old._replace(restitution=0.0), new=body.new._replace(restitution=0.0))
        path, total = solve_impact(body, twist), solve_impact(body, twist, "total")
        if path.mode is not Mode.NO_IMPACT and not (path.flags | total.flags) & UNANSWERED:
            yield Case(kind, body, twist, path, total, float(np.abs(velocities(body, twist)).sum()))


def disputed(count: int) -> list[Case]:
    """Cases of the kinds in which a body may slip before, in which the laws differ."""
    return [
        case
        for kind in ("floor", "wedge", "tilted")
        for case in cases(kind, count)
        if difference(case.body, case.path.twist, case.total.twist, case.twist) > DIFFERENT
    ]


def place(case: Case, ratio: float) -> tuple[float, float, float]:
    """Where the limit lies between the total law (0) and the path law (1); its distances from them, over theirs."""
    outcome = compliant_impact(case.body, case.twist, math.inf, ratio=ratio, damping=FIRM)
    path, total, found = (np.array(velocities(case.body, one.twist)) for one in (case.path, case.total, outcome))
    apart = path - total
    size = float(np.linalg.norm(apart))
    return (
        float((found - total) @ apart) / size**2,
        float(np.linalg.norm(found - path)) / size,
        float(np.linalg.norm(found - total)) / size,
    )
