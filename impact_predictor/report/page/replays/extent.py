"""The time that a timeline shows: without long pauses, how far it can be magnified, and which times are told."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import ceil, floor, log10
from typing import Final, NamedTuple

from ....stamps import NANOSECONDS
from ...summary import quantile
from .answers import Answer
from .lanes import Row, begin_of

ZOOMS: Final = (1, 4, 16, 64, 256, 1024)
"""How many times a timeline can be magnified; the page's style has the same."""
NEIGHBOURS: Final = 8
"""Touchdowns at most on a window's width at the greatest magnification that is offered, where they are closest."""
PAUSE: Final = 2 * NANOSECONDS
"""Pauses (ns) that are longer can be cut out."""
KEPT: Final = NANOSECONDS // 10
"""What is kept of a pause (ns) after what came before it and, at least, before what comes after it."""
CUTS: Final = 25
"""Cuts on average at most on a window's width where they are drawn."""


class Piece(NamedTuple):
    """A part of a record without a long pause: its first and last stamp, and its place in the shown time (ns)."""

    begin: int
    end: int
    place: int


class Extent(NamedTuple):
    """The time that is shown: the pieces of a record, one after the other."""

    pieces: Sequence[Piece]

    @property
    def begin(self) -> int:
        """The first stamp (ns)."""
        return self.pieces[0].begin

    @property
    def length(self) -> int:
        """How much time is shown (ns)."""
        last = self.pieces[-1]
        return last.place + last.end - last.begin

    @property
    def cut(self) -> int:
        """How much time is cut out (ns)."""
        return self.pieces[-1].end - self.begin - self.length

    def is_cut_at(self, zoom: int) -> bool:
        """Whether its cuts are drawn at a magnification."""
        return len(self.pieces) <= CUTS * zoom

    def shown(self, stamp: int) -> int:
        """The place (ns) of a stamp in the time that is shown; in a pause that of its cut."""
        piece = self.pieces[max(bisect_right(self.pieces, stamp, key=lambda one: one.begin) - 1, 0)]
        return piece.place + min(stamp, piece.end) - piece.begin

    def at(self, stamp: int) -> str:
        """Where a stamp lies, as SVG has it."""
        return self.part(self.shown(stamp))

    def part(self, length: int) -> str:
        """A length (ns) of the time that is shown, as SVG has it."""
        return f"{100.0 * length / self.length:.6g}%"


def extent_of(answer: Answer, rows: Iterable[Row]) -> Extent:
    """From the first sample to the last one, and what lies beyond; without long pauses where they are most of it."""
    begin = begin_of(answer)
    moments = {begin, max(answer.get("end") or 0, begin + 1)}
    for lane in (lane for row in rows for lane in row.lanes):
        moments |= {stamp for spot in lane.spots for stamp in (spot.stamp, spot.since or spot.stamp)}
        moments |= {stamp for bar in lane.bars for stamp in bar[:2]}
    stamps = sorted(max(stamp, begin) for stamp in moments)
    pauses = [(one, other) for one, other in pairwise(stamps) if other - one > PAUSE]
    if 2 * sum(other - one for one, other in pauses) < stamps[-1] - begin:
        pauses = []
    # A piece begins at a whole tenth of a second, so that its time is told exactly.
    begins = [begin, *(begin + (other - begin - KEPT) // KEPT * KEPT for _, other in pauses)]
    ends = [*(one + KEPT for one, _ in pauses), stamps[-1]]
    pieces: list[Piece] = []
    place = 0
    for first, last in zip(begins, ends, strict=True):
        pieces.append(Piece(first, last, place))
        place += last - first
    return Extent(pieces)


def zooms_of(rows: Iterable[Row], extent: Extent) -> list[int]:
    """The magnifications that are worth while: until the closest quarter of the marks stand apart."""
    places = sorted({extent.shown(spot.stamp) for row in rows for lane in row.lanes for spot in lane.spots})
    gaps = [later - earlier for earlier, later in pairwise(places)]
    if not gaps:
        return [1]
    width = NEIGHBOURS * max(quantile(gaps, 0.25), 1.0)
    return [zoom for zoom in ZOOMS if zoom == 1 or extent.length / zoom > 0.25 * width]


def times_of(extent: Extent, step: int) -> Iterable[tuple[int, int]]:
    """Times (ns) since the beginning that are told, at least a step apart, each with what it is a multiple of.

    These are the multiples of the step; where pieces are so short that none is shown for a whole step, the roundest
    time within half a step.
    """
    free = 0
    while free <= extent.length:
        for unit in units_of(step):
            time = _first_multiple(extent, unit, free, free + (step - 1 if unit == step else step // 2))
            if time is not None:
                yield time, unit
                free = extent.shown(extent.begin + time)
                break
        free += step


def _first_multiple(extent: Extent, unit: int, first: int, last: int) -> int | None:
    """The first multiple of a unit (ns) since the beginning that is shown between two places; None without any."""
    pieces = extent.pieces
    for piece in pieces[bisect_right(pieces, first, key=lambda one: one.place) - 1 :]:
        if piece.place > last:
            break
        before = piece.begin - extent.begin - piece.place
        # The last place of a piece is that of the next one.
        end = min(last, piece.place + piece.end - piece.begin - (piece is not pieces[-1]))
        time = -(-(max(first, piece.place) + before) // unit) * unit
        if time <= end + before:
            return time
    return None


def units_of(step: int) -> Iterable[int]:
    """A step (ns), then smaller ones, the roundest first: 5, 2 and 1 times powers of ten down to `KEPT`."""
    yield step
    power = 10 ** floor(log10(step))
    while power >= KEPT:
        yield from (factor * power for factor in (5, 2, 1) if factor * power < step)
        power //= 10


def is_near(time: int, ordered: Sequence[int], most: int) -> bool:
    """Whether one of some times in their order is at most so far away."""
    place = bisect_left(ordered, time - most)
    return place < len(ordered) and ordered[place] <= time + most


def nice(length: float) -> int:
    """The least of 1, 2, 2.5 and 5 times a power of ten, in ns, that is not below a length."""
    power = 10.0 ** floor(log10(max(length, 1.0)))
    lengths = (factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0))
    return ceil(next(one for one in lengths if one >= length * (1.0 - 1e-9)))
