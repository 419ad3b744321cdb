"""The impacts of touchdowns, solved again and again with other coefficients, many at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..mechanics.impact.spatial import Body, ContactPoints, solve_spatial_impacts
from ..prediction.planar import hardly
from ..prediction.skill import SIMPLE
from ..prediction.spatial import WINDOW
from .motions import Reals
from .touchdowns import ScoredTouchdown


class Coefficients(NamedTuple):
    """What is fitted.

    `friction`, `restitution` and the time `merge` (s) of a compression are those of the scene. `inertia` is a factor on
    the given one.
    """

    friction: float
    restitution: float
    merge: float
    inertia: float = 1.0


_KEPT = 8
"""Answers of `Solver.misses` that are kept: a search ends where the next one begins."""

LATEST = 1e9
"""s: when the first contact closes of a body that has none."""


class Solver:
    """The twists after some touchdowns with other coefficients, and by what they miss the measured."""

    def __init__(self, touchdowns: Sequence[ScoredTouchdown]) -> None:
        """Put what is known of the touchdowns into arrays; bodies of fewer points get some that take no part."""
        self.touchdowns = touchdowns
        most = max((len(one.arms) for one in touchdowns), default=0)

        def padded(arrays: Sequence[Reals], fill: float = 0.0) -> Reals:
            rows = [np.concatenate((one, np.full((most - len(one), *one.shape[1:]), fill))) for one in arrays]
            return np.array(rows)

        self._arms = padded([one.arms for one in touchdowns])
        self._normals = padded([one.normals for one in touchdowns])
        self._gaps = padded([one.gaps for one in touchdowns], np.inf)
        self._stood = padded([one.stood.astype(float) for one in touchdowns]) > 0.0
        self._masses = np.array([one.scene.mass for one in touchdowns])
        self._inertias = np.array([one.inertia for one in touchdowns])
        self._before = np.array([one.twist for one in touchdowns])
        self._measured = np.array([one.measured for one in touchdowns])
        self._scales = np.array([one.scales / one.speed for one in touchdowns])
        laws = [(one.scene.law, hardly(one.scene)) for one in touchdowns]
        self._laws = {law: np.array([law == other for other in laws]) for law in laws}
        self._later = np.zeros_like(self._before)
        self._solved: dict[Coefficients, tuple[Reals, Reals]] = {}

    def after(self, coefficients: Coefficients) -> Reals:
        """The twists right after the impacts (n, 6)."""
        (friction, restitution, merge, factor), arms, gaps = coefficients, self._arms, self._gaps
        moving = self._before[:, None, :3] + np.cross(self._before[:, None, 3:], arms)
        speeds = -np.einsum("nki,nki->nk", self._normals, moving)
        closing = (speeds > 0.0) & ~self._stood & np.isfinite(gaps)
        due = np.where(closing, gaps / np.where(closing, speeds, 1.0), np.inf)
        first = np.minimum(due.min(axis=1, keepdims=True), LATEST)
        strikes = closing & (due - first <= WINDOW * merge)
        open_gaps = np.where(strikes, np.where(closing, due - first, 0.0) * speeds, 0.0)
        # Those that stood come first, and those that take no part last.
        order = np.argsort(np.where(self._stood, 0, np.where(strikes, 1, 2)), axis=1, kind="stable")
        counts = (self._stood | strikes).sum(axis=1)
        after = self._before.copy()
        for (law, threshold), of_law in self._laws.items():
            for count in np.unique(counts[of_law & (counts > 0)]).tolist():
                some = np.flatnonzero(of_law & (counts == count))
                rows, which = some[:, None], order[some, :count]
                contacts = ContactPoints(
                    positions=arms[rows, which],
                    friction=friction,
                    restitution=restitution,
                    normals=self._normals[rows, which],
                    gaps=open_gaps[rows, which],
                )
                bodies = Body(self._masses[some], factor * self._inertias[some])
                after[some] = solve_spatial_impacts(bodies, contacts, self._before[some], law, merge, threshold).twist
        return after

    def misses(self, coefficients: Coefficients) -> Reals:
        """By what the predictions miss the measured twist, relative to the speed before (n, 6)."""
        if coefficients not in self._solved:
            if len(self._solved) == _KEPT:
                self._solved.pop(next(iter(self._solved)))
            after = self.after(coefficients)
            later = self.continued(after, coefficients)
            self._solved[coefficients] = self.of(later), later - after
        missed, self._later = self._solved[coefficients]
        return missed

    def near(self, coefficients: Coefficients) -> Reals:
        """What `misses` gives if the bodies go on as they did with the last coefficients of `misses`, in less time."""
        return self.of(self.after(coefficients) + self._later)

    def continued(self, after: Reals, coefficients: Coefficients) -> Reals:
        """What twists right after the impacts have become where they are measured (n, 6)."""
        friction, factor = coefficients.friction, coefficients.inertia
        pairs = zip(self.touchdowns, after, strict=True)
        return np.array([one.continued(twist, friction, factor) for one, twist in pairs])

    def simple_errors(self) -> dict[str, Reals]:
        """The errors of simple answers, by what they say; none where a body does not go on as one on points."""
        scores = [one.score for one in self.touchdowns if one.score is not None]
        if len(scores) < len(self.touchdowns):
            return {}
        errors = np.array([score.simple_errors for score in scores]).T
        return dict(zip(SIMPLE.values(), errors, strict=True))

    def of(self, twists: Reals) -> Reals:
        """By what twists miss the measured, relative to the speed before (n, 6)."""
        missed: Reals = (twists - self._measured) * self._scales
        return missed


def lengths(misses: Reals) -> Reals:
    found: Reals = np.linalg.norm(misses, axis=1)
    return found
