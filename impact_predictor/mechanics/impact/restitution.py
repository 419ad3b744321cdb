"""The restitution of an impact: all that the laws know of it. Law code (see `contacts`)."""

from __future__ import annotations

from math import inf, sqrt

RULES = ("poisson", "energetic")
"""The names of the rules that the path law knows; the total law has Newton's."""


def newton(restitution: float, velocity: float) -> float:
    """The normal velocity that the impulses of a whole impact have to stop, by Newton's rule (m/s)."""
    return (1.0 + restitution) * velocity if velocity < 0.0 else velocity


def poisson(restitution: float, compression: float) -> float:
    """The normal impulse at which the expansion ends, by Poisson's rule; `compression` is that of the compression."""
    return (1.0 + restitution) * compression


def energetic(restitution: float, work: float) -> float:
    """The part of the normal `work` stored in the compression that comes back, by Stronge's rule."""
    return restitution * restitution * work


def span_of_work(work: float, velocity: float, rate: float) -> float:
    """The normal impulse that returns the stored normal `work` to a contact that leaves with `velocity`; inf if none.

    Energy is not gained in an impact: the expansion ends with the work that the compression stored. `rate` is that of
    the velocity per unit of the impulse.
    """
    square = velocity * velocity + 2.0 * rate * work
    if square >= 0.0:
        speed = velocity + sqrt(square)
        if speed > 0.0:
            return 2.0 * work / speed
    return inf


def span_to_give(work: float, velocity: float, rate: float) -> float:
    """As `span_of_work`, also exact where the contact is approached first; none is needed to give no work.

    With all signs but that of `work` changed it is the impulse that stores as much.
    """
    square = velocity * velocity + 2.0 * rate * work
    if square >= 0.0:
        if velocity > 0.0:
            return 2.0 * work / (velocity + sqrt(square))
        if rate > 0.0:
            return (sqrt(square) - velocity) / rate
    return inf
