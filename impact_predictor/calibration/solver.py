"""The impacts of touchdowns, solved again and again with other coefficients, those in their planes all at once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.impact.batch import numbers_of, solve_impacts
from ..mechanics.types import Contact, Twist, TwoPointBody, Validity
from .touchdowns import Coefficients, ScoredTouchdown, with_coefficients

ROUGH: Final = Coefficients(1.0, 0.0)
"""With friction; how much does not matter for whether an impact slips across its plane."""


class _Batch(NamedTuple):
    """Impacts that are solved at once: the places of their touchdowns, bodies and twists before as arrays."""

    law: str
    validity: Validity
    places: list[int]
    bodies: TwoPointBody
    before: Twist


class Solver:
    """The twists after some touchdowns with other coefficients, and by what they miss the measured."""

    def __init__(self, touchdowns: Sequence[ScoredTouchdown]) -> None:
        """Sort the touchdowns by the ways in which they are solved."""
        self._touchdowns = touchdowns
        kinds: dict[tuple[str, Validity, bool], list[int]] = defaultdict(list)
        for k, one in enumerate(touchdowns):
            kinds[one.scene.law, one.scene.validity, one.impact.body.old is None].append(k)
        self._batches = [
            _Batch(law, validity, places, *_stacked([touchdowns[k] for k in places]))
            for (law, validity, _), places in kinds.items()
        ]
        self._measured = np.array([(one.measured.vx, one.measured.omega) for one in touchdowns])
        self._half_distances = np.array([one.half_distance for one in touchdowns])
        self._speeds = np.array([one.speed for one in touchdowns])

    def after(self, coefficients: Coefficients) -> NDArray[np.float64]:
        """The twists after the impacts, (n, 3)."""
        after = np.empty((len(self._touchdowns), 3))
        for law, validity, places, bodies, before in self._batches:
            after[places] = solve_impacts(with_coefficients(bodies, coefficients), before, law, validity).twist
        return after

    def misses(self, coefficients: Coefficients) -> NDArray[np.float64]:
        """By what the predictions miss the measured (vx, omega s), relative to the speed before: (n, 2)."""
        misses: NDArray[np.float64] = self.after(coefficients)[:, (0, 2)] - self._measured
        misses[:, 1] *= self._half_distances
        misses /= self._speeds[:, None]
        return misses


def _stacked(touchdowns: Sequence[ScoredTouchdown]) -> tuple[TwoPointBody, Twist]:
    """Bodies and twists before the impacts, their fields as arrays (n,)."""
    bodies = [one.impact.body for one in touchdowns]
    old = [body.old for body in bodies if body.old is not None]
    mass, inertia = _columns([(body.mass, body.inertia) for body in bodies])
    before = Twist(*_columns([one.impact.before for one in touchdowns]))
    return TwoPointBody(mass, inertia, _contact(old) if old else None, _contact([one.new for one in bodies])), before


def _contact(contacts: Sequence[Contact]) -> Contact:
    """Contacts as one whose fields are arrays."""
    x, y, friction, nx, ny, restitution, ux, uy = _columns([numbers_of(one) for one in contacts])
    return Contact(x, y, friction, (nx, ny), restitution, (ux, uy))


def _columns(rows: Sequence[Sequence[float]]) -> Any:
    return np.array(rows).T
