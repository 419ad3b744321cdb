"""What touchdowns tell of the inertia: how their errors grow where it is another one, friction and restitution free."""

from __future__ import annotations

from itertools import pairwise
from typing import Final, NamedTuple

from scipy.optimize import minimize

from .search import COARSE, Estimate, Search
from .table import Array
from .touchdowns import Coefficients

FACTORS: Final = (1 / 3, 0.5, 0.7, 0.84, 1.0, 1.2, 1.45, 2.0, 3.0)
"""Of the given inertia, between a body with its mass at the middle and one with it all outside."""

KNOWN: Final = 1.2
"""An inertia is told when the ends of its interval differ by less than this factor: a drawing tells it as well."""

ALIKE: Final = 1e-3
"""Mean errors that differ by less are alike for an inertia, which friction and restitution stand in for: a thousandth
of the speed is less than any record or rigid theory holds."""

_HALVINGS: Final = 3


class _Fit(NamedTuple):
    """The least mean error at one factor: the coefficients there, and the errors summed in blocks."""

    coefficients: Coefficients
    errors: Array

    @property
    def factor(self) -> float:
        return self.coefficients.inertia


class Profile:
    """The best friction and restitution at several factors on the inertia; the search begins at `start`."""

    def __init__(self, search: Search, start: Coefficients) -> None:
        self._search = search
        self._fits = [self._fit(start, 1.0)]
        for factor in sorted(FACTORS, key=lambda factor: max(factor, 1.0 / factor)):
            if factor != 1.0:
                self._add(factor)

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Each factor with its least mean error."""
        count = self._search.number
        return tuple((fit.factor, float(fit.errors.sum()) / count) for fit in self._fits)

    def at(self, factor: float) -> Coefficients:
        """The best coefficients with one of the factors."""
        return next(fit.coefficients for fit in self._fits if fit.factor == factor)

    def estimate(self) -> Estimate:
        """What the touchdowns tell of the inertia; one within its interval stays as given."""
        for _ in range(_HALVINGS):
            edges = self._edges()
            if len(edges) == 2:
                place = [fit.factor for fit in self._fits].index(self._best.factor)
                edges += pairwise(self._fits[place - 1 : place + 2])
            for factor in sorted({(one.factor * other.factor) ** 0.5 for one, other in edges}):
                self._add(factor)
        below = above = None
        for one, other in self._edges():
            if self._alike(other):
                below = one.factor
            else:
                above = other.factor
        told = below is not None and above is not None and above <= KNOWN * below
        value = 1.0
        if told and not (below or 0.0) <= 1.0 <= (above or 0.0):
            value = self._best.factor
        return Estimate(1.0, value, below, above, told)

    @property
    def _best(self) -> _Fit:
        return min(self._fits, key=lambda fit: float(fit.errors.sum()))

    def _edges(self) -> list[tuple[_Fit, _Fit]]:
        """The neighbours of which one predicts as well as the best and the other worse: the outermost of each side."""
        edges = [(a, b) for a, b in pairwise(self._fits) if self._alike(a) != self._alike(b)]
        rising, falling = [e for e in edges if self._alike(e[1])], [e for e in edges if self._alike(e[0])]
        outermost = [] if not rising or self._alike(self._fits[0]) else rising[:1]
        return outermost + ([] if not falling or self._alike(self._fits[-1]) else falling[-1:])

    def _alike(self, fit: _Fit) -> bool:
        return not self._search.surely_more(fit.errors - self._best.errors, ALIKE)

    def _add(self, factor: float) -> None:
        nearest = min(self._fits, key=lambda fit: max(fit.factor / factor, factor / fit.factor))
        self._fits = sorted([*self._fits, self._fit(nearest.coefficients, factor)], key=lambda fit: fit.factor)

    def _fit(self, start: Coefficients, factor: float) -> _Fit:
        def loss(point: Array) -> float:
            return float(self._search.block_errors(Coefficients(float(point[0]), float(point[1]), factor)).sum())

        friction, restitution = start[:2]
        step = 0.05 if restitution < 0.5 else -0.05
        found = minimize(
            loss,
            (friction, restitution),
            method="Nelder-Mead",
            bounds=[(axis[0], axis[-1]) for axis in COARSE],
            options={
                "initial_simplex": [
                    (friction, restitution),
                    (1.1 * friction + 0.02, restitution),
                    (friction, restitution + step),
                ],
                "xatol": 5e-3,
                "fatol": 0.1 * ALIKE * self._search.number,
                "maxfev": 60,
            },
        )
        best = Coefficients(float(found.x[0]), float(found.x[1]), factor)
        return _Fit(best, self._search.block_errors(best))
