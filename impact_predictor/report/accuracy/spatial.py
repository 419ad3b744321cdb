"""The impact in three dimensions: boxes that strike with a corner, an edge or a face, and what tells what follows.

The reference is the law itself in far finer steps. That the law is right the tests show: by other solutions of one
contact, the exact path in the plane, and stiff springs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import product
from random import Random
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...mechanics.impact.spatial import STEPS, Body, ContactPoints, solve_spatial_impact
from ...mechanics.types import ContactState
from . import SPATIAL, AccuracyScene, Methods

FINEST: Final = 2048
"""Steps of the reference for a quarter of an oscillation."""

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


def errors_of(strike: StruckBox, after: SpatialAftermath, right: SpatialAftermath) -> dict[str, float]:
    """Error of the twist, relative to the size of the one before, and of what is told of the contacts that leave."""
    error = strike.size(after.twist - right.twist) / strike.size(strike.twist)
    if after.leaves is None or right.leaves is None:
        return {"twist_error": error}
    return {"twist_error": error, "wrong_modes": float(np.abs(after.leaves - right.leaves).mean())}


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
