"""Rest on both contacts of a moving support: when it ends."""

from __future__ import annotations

from collections.abc import Callable

from .rocking_arcs import Arc, Happening
from .rocking_follow import Event

_SAMPLES = 16
"""Samples of the conditions in a shortest period of the support."""
_DEPTH = 40
"""Halvings down to which a graze is told from a crossing."""

Margins = Callable[[float], list[float]]


def wait(arc: Arc, after: float, last: float, most: int) -> Event:
    """Wait until the reactions that rest needs leave their cones of friction, from `after` s on and for `last` s.

    At most `most` swings of the support are waited for.
    """
    shape, felt, start, z = arc.shape, arc.support.felt, arc.start, arc.instants[0].z

    def margins(time: float) -> list[float]:
        return shape.hold_margins(felt(start + time), z)

    spacing = arc.support.period / _SAMPLES
    patient = min(last, most * arc.support.period)
    time, low = after, margins(after)
    rest = arc.instants[0]
    while time < patient:
        then = min(time + 2.0 * spacing, last)
        middle, high = margins(0.5 * (time + then)), margins(then)
        at = _first_fall(margins, time, then, low, middle, high, _DEPTH)
        if at is not None:
            arc.instants.append(rest._replace(time=at))
            return Event(Happening.YIELDS, arc.contact, arc.instants[-1])
        time, low = then, high
    arc.instants.append(rest._replace(time=time))
    happening = Happening.TIME_IS_UP if time >= last else Happening.TAKES_TOO_LONG
    return Event(happening, arc.contact, arc.instants[-1])


def _first_fall(
    margins: Margins,
    start: float,
    end: float,
    low: list[float],
    middle: list[float],
    high: list[float],
    depth: int,
) -> float | None:
    """First time in an interval at which a margin falls below zero; None where none does."""
    doubtful = False
    for first, half, last in zip(low, middle, high, strict=True):
        bend, slope = first - 2.0 * half + last, last - first
        least = min(first, half, last)
        if bend > 0.0 and abs(slope) < 2.0 * bend:
            least = min(least, half - 0.125 * slope * slope / bend - 0.1 * bend)
        doubtful = doubtful or least < 0.0
    if not doubtful:
        return None
    centre = 0.5 * (start + end)
    if depth == 0 or not start < centre < end:
        return end if min(high) < 0.0 else None
    early = margins(0.5 * (start + centre))
    found = _first_fall(margins, start, centre, low, early, middle, depth - 1)
    if found is not None:
        return found
    return _first_fall(margins, centre, end, middle, margins(0.5 * (centre + end)), high, depth - 1)
