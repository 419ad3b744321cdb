"""Rest on both contacts of a moving support: when it ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..support import MovingSupport
from .arcs import Arc, Happening
from .follow import Event

_SAMPLES = 16
"""Samples of the conditions in a shortest period of the support."""
_FIRST_BLOCK, _LAST_BLOCK = 4, 128
"""Pairs of samples that are taken at once."""
_DEPTH = 40
"""Halvings down to which a graze is told from a crossing."""

Margins = Callable[[float], list[float]]


def wait(arc: Arc, after: float, last: float, most: int) -> Event:
    """Wait until the reactions that rest needs leave their cones of friction, from `after` s on and for `last` s.

    At most `most` swings of the support are waited for.
    """
    import numpy as np

    shape, support, start, z = arc.shape, arc.support, arc.start, arc.instants[0].z
    assert isinstance(support, MovingSupport)
    rest = arc.instants[0]
    if not shape.facets:  # friction locks the body between its contacts
        after = max(after, last)

    def margins(time: float) -> list[float]:
        return shape.hold_margins(support.felt_exactly(start + time), z)

    spacing, patient = support.period / _SAMPLES, min(last, most * support.period)
    time, block = after, _FIRST_BLOCK
    while time < patient:
        times = np.minimum(time + spacing * np.arange(2 * block + 1), last)
        felt = support.felt_at(start + times)
        values: Any = np.array(shape.hold_margins((felt[:, 0], felt[:, 1], felt[:, 2], felt[:, 3]), z))
        low, middle, high = values[:, :-2:2], values[:, 1:-1:2], values[:, 2::2]
        for k in np.flatnonzero(_doubtful(low, middle, high).any(axis=0)).tolist():
            sides = low[:, k].tolist(), middle[:, k].tolist(), high[:, k].tolist()
            at = _first_fall(margins, float(times[2 * k]), float(times[2 * k + 2]), *sides, _DEPTH)
            if at is not None:
                arc.instants.append(rest._replace(time=at))
                return Event(Happening.YIELDS, arc.contact, arc.instants[-1])
        time, block = float(times[-1]), min(2 * block, _LAST_BLOCK)
    arc.instants.append(rest._replace(time=max(time, rest.time)))
    happening = Happening.TIME_IS_UP if time >= last else Happening.TAKES_TOO_LONG
    return Event(happening, arc.contact, arc.instants[-1])


def _doubtful(first: Any, half: Any, last: Any) -> Any:
    """Where a margin may fall below zero between three samples: their parabola does, with what it may be wrong by."""
    bend, slope = first - 2.0 * half + last, last - first
    bends = abs(bend) + (bend == 0.0)  # no division by zero
    dips = (bend > 0.0) & (abs(slope) < 2.0 * bend) & (half - 0.125 * slope * slope / bends - 0.1 * bend < 0.0)
    return dips | (first < 0.0) | (half < 0.0) | (last < 0.0)


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
    if not any(_doubtful(*samples) for samples in zip(low, middle, high, strict=True)):
        return None
    centre = 0.5 * (start + end)
    if depth == 0 or not start < centre < end:
        return end if min(high) < 0.0 else None
    early = margins(0.5 * (start + centre))
    found = _first_fall(margins, start, centre, low, early, middle, depth - 1)
    if found is not None:
        return found
    return _first_fall(margins, centre, end, middle, margins(0.5 * (centre + end)), high, depth - 1)
