"""The impact in three dimensions: boxes that strike with a corner, an edge or a face, and what tells what follows.

The reference is the law itself in far finer steps. That the law is right the tests show: by other solutions of one
contact, the exact path in the plane, and stiff springs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import log
from random import Random
from types import SimpleNamespace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...mechanics.impact.spatial import STEPS, Body, ContactPoints, solve_spatial_impact, solve_spatial_impacts
from ...mechanics.types import ContactState
from ...prediction.uncertainty import normal_points
from . import GAPS, SPATIAL, AccuracyScene, Methods

MOST, FINEST = 64, 2048
"""Steps for a quarter of an oscillation: the most that are compared, and the reference's."""

DRAWS, ALL = (16, 32, 64), 1024
"""Draws over uncertain gaps: those that are compared, and the reference's."""

DEVIATION: Final = 4.5e-4
"""Standard deviation of uncertain gaps in m: as at the corners of a cube that was measured."""

SLOWEST: Final = 0.1
"""m/s; every contact that strikes is faster."""


class SpatialAftermath(NamedTuple):
    """Right after an impact: the twist (6,), and how likely each contact leaves, None where a method tells none."""

    twist: NDArray[np.float64]
    leaves: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class StruckBox:
    """What `solve_spatial_impact` is asked, the inertia as a tensor; `strikes` (n,) tells the contacts that strike."""

    body: Body
    contacts: ContactPoints
    twist: NDArray[np.float64]
    strikes: NDArray[np.bool_]

    def size(self, twist: NDArray[np.float64]) -> float:
        """The size of a twist, by kinetic energy."""
        mass, inertia = np.asarray(self.body.mass), np.asarray(self.body.inertia)
        return float(np.sqrt(mass * (twist[:3] @ twist[:3]) + twist[3:] @ inertia @ twist[3:]))


def box(source: Random, tilt: int, stand: int, strike: int, bounces: bool) -> StruckBox:
    """A box of 0.1 to 1 m, tilted about so many axes, on lowest corners: some stand and slip, the next ones strike."""
    uniform, mass = source.uniform, source.uniform(0.5, 5.0)
    sides = np.array([uniform(0.1, 1.0) for _ in range(3)])
    angles = [uniform(-3.0, 3.0), *(uniform(0.2, 1.3) if k < tilt else 0.0 for k in range(2))]
    axes = Rotation.from_euler("ZYX", angles).as_matrix()
    corners = 0.5 * sides * list(product((-1, 1), repeat=3)) @ axes.T
    arms = corners[np.argsort(np.round(corners[:, 2], 9), kind="stable")[: stand + strike]]
    inertia = axes @ np.diag(mass / 12.0 * (sides @ sides - sides**2)) @ axes.T
    contacts = ContactPoints(arms, uniform(0.05, 0.8), uniform(0.1, 0.6) if bounces else 0.0)
    while True:
        spin = np.array([source.gauss(0.0, 1.0) for _ in range(3)]) / sides.max()
        if stand == 2:  # about the line of both, and about the normal
            edge = (arms[1] - arms[0])[:2]
            spin[:2] = spin[:2] @ edge / (edge @ edge) * edge
        velocity = uniform(-1.0, 1.0), uniform(-1.0, 1.0), 0.0 if stand else -uniform(0.5, 2.0)
        twist = np.concatenate((velocity - np.cross(spin, arms[0]), spin))
        strikes = (twist[:3] + np.cross(spin, arms))[:, 2] < -SLOWEST
        if strikes[stand:].all():
            return StruckBox(Body(mass, 0.5 * (inertia + inertia.T)), contacts, twist, strikes)


def solved(strike: StruckBox, law: str = "path", steps: int = STEPS) -> SpatialAftermath:
    """One impact by the law in three dimensions."""
    found = solve_spatial_impact(strike.body, strike.contacts, strike.twist, law, steps=steps)
    leaves = [state is ContactState.LEAVES for state in found.states]
    return SpatialAftermath(np.asarray(found.twist), np.array(leaves, float))


def drawn(strike: StruckBox, draws: int) -> SpatialAftermath:
    """The mean over draws of the gaps at the contacts that strike."""
    points = DEVIATION * normal_points(draws, len(strike.strikes)).T
    gaps = np.where(strike.strikes, points - points[:, strike.strikes].min(axis=1, keepdims=True), 0.0)
    found = solve_spatial_impacts(strike.body, strike.contacts._replace(gaps=gaps), strike.twist)
    leaves = found.states == list(ContactState).index(ContactState.LEAVES)
    return SpatialAftermath(found.twist.mean(axis=0), leaves.mean(axis=0))


def errors_of(strike: StruckBox, after: SpatialAftermath, right: SpatialAftermath) -> dict[str, float]:
    """Error of the twist, relative to the size of the one before, and of what is told of the contacts that leave."""
    error = strike.size(after.twist - right.twist) / strike.size(strike.twist)
    if after.leaves is None or right.leaves is None:
        return {"twist_error": error}
    return {"twist_error": error, "wrong_modes": float(np.abs(after.leaves - right.leaves).mean())}


def orders(rows: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """The power of the steps with which the median error falls, from the usual ones to the most, on each scene."""
    errors = {(row["scene"], row["setting"]): row["twist_error"] for row in rows if row["question"] == SPATIAL}
    few, many = (f"{steps} steps" for steps in (STEPS, MOST))
    return {scene.name: log(errors[scene.name, few] / errors[scene.name, many]) / log(MOST / STEPS) for scene in SCENES}


FINE: Final = f"the path law with {FINEST} steps; the other solutions that it is held against are in the tests"
SCENES: Final[dict[AccuracyScene, Callable[[Random], StruckBox]]] = {
    AccuracyScene(name, SPATIAL, title, description, FINE): partial(
        box, tilt=tilt, stand=stand, strike=strike, bounces=bounces
    )
    for name, title, description, tilt, stand, strike, bounces in (
        ("corner", "Corner", "A box in the air strikes with a corner and bounces.", 2, 0, 1, True),
        ("edge", "Edge", "A box in the air strikes with an edge and bounces.", 1, 0, 2, True),
        ("flat", "Face", "A box in the air strikes with four corners at once, plastically.", 0, 0, 4, False),
        ("beside", "Corner beside an edge", "One corner strikes, plastically; two stand.", 0, 2, 1, False),
        ("landing", "Edge beside an edge", "Two corners strike and bounce; two stand.", 0, 2, 2, True),
    )
}
reference_of: Final[Callable[[StruckBox], SpatialAftermath]] = partial(solved, steps=FINEST)
"""What is held to be right."""

USED: Final = ("path law", f"{STEPS} steps")
METHODS: Final[Methods] = {
    **{("path law", f"{2**k} steps"): partial(solved, steps=2**k) for k in range(1, 7)},
    ("total law", ""): partial(solved, law="total"),
}

UNCERTAIN: Final = SimpleNamespace(
    SCENES={
        AccuracyScene(name, GAPS, title, description, f"{ALL} draws"): partial(
            box, tilt=0, stand=stand, strike=strike, bounces=True
        )
        for name, title, description, stand, strike in (
            ("gaps of an edge", "Edge beside an edge", "Two corners strike, their gaps known to 0.45 mm.", 2, 2),
            ("gaps of a face", "Face", "Four corners strike, their gaps known to 0.45 mm.", 0, 4),
        )
    },
    METHODS={("one solution", ""): solved}
    | {("mean", f"{draws} draws"): partial(drawn, draws=draws) for draws in DRAWS},
    reference_of=partial(drawn, draws=ALL),
    errors_of=errors_of,
)
"""The question what follows where gaps are known to a part of a millimetre only: means and probabilities."""
