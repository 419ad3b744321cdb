"""Whether a body was warned of before something happened to it.

A warning counts only if it stands: a level of WARN or ERROR from its beginning up to what happens, without a report of
another level between them.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, Final, NamedTuple

from ..ros.cdr import ERROR, STALE, WARN
from .truth import TrueImpact, TrueOnset

if TYPE_CHECKING:
    from ..prediction.watch.watch import Report

APART: Final = 5_000_000_000
"""ns without slide, lift or impact after which the next one is an event of its own: half a roll of a ship, as long as
levels are usually held. A body that rocks strikes many times within it."""


class Warned(NamedTuple):
    """How a body was warned of.

    Stamps in ns of the first report on it with another level than STALE and of the first with WARN or ERROR; from that
    on which it was known at all, of its first slide, its first impact and the first time that it lifted a contact.
    `warned_ahead`: how long before the first event a warning had been standing, in s. None where there was none.

    `events`: slides, lifts and impacts that follow each other by less than `APART` are one; of them `events_warned`
    found a warning standing when they began.
    """

    first_known: int | None
    first_warning: int | None
    first_slide: int | None
    first_impact: int | None
    first_lift: int | None = None
    warned_ahead: float | None = None
    events: int = 0
    events_warned: int = 0

    @property
    def first_event(self) -> int | None:
        """The first slide or impact; of a body that only lifted, as one that topples may, that."""
        happened = [stamp for stamp in (self.first_slide, self.first_impact) if stamp is not None]
        return min(happened, default=self.first_lift)

    @property
    def before_first_impact(self) -> bool | None:
        """Whether a warning stood before the first slide or impact; None where there was none."""
        if self.first_slide is None and self.first_impact is None:
            return None
        return self.warned_ahead is not None


class Warnings:
    """The warnings of each body."""

    def __init__(self) -> None:
        self._known: dict[str, int] = {}
        # When each warning began, and when another level ended it.
        self._stood: dict[str, list[tuple[int, float]]] = defaultdict(list)

    def take(self, reports: Iterable[Report]) -> None:
        """Take reports in the order of their stamps."""
        for report in reports:
            if report.level != STALE:
                self._known.setdefault(report.body, report.stamp)
            stood = self._stood[report.body]
            stands = bool(stood) and stood[-1][1] == inf
            if report.level in (WARN, ERROR):
                if not stands:
                    stood.append((report.stamp, inf))
            elif stands:
                stood[-1] = stood[-1][0], report.stamp

    def of(self, body: str, impacts: Iterable[TrueImpact], onsets: Iterable[TrueOnset]) -> Warned:
        """How a body was warned of, with what happened to it."""
        known, stood = self._known.get(body), self._stood.get(body, [])
        if known is None:
            return Warned(None, None, None, None)
        onsets = list(onsets)
        slides = [onset.stamp for onset in onsets if onset.slides]
        lifts = [onset.stamp for onset in onsets if onset.lifts]
        struck = [impact.stamp for impact in impacts]
        # Nothing can be told before it is known.
        slide, impact, lift = (
            min((stamp for stamp in stamps if stamp >= known), default=None) for stamps in (slides, struck, lifts)
        )
        events = [stamp for stamp in events_of([*slides, *lifts, *struck]) if stamp >= known]
        warned = Warned(known, stood[0][0] if stood else None, slide, impact, lift)
        return warned._replace(
            warned_ahead=None if warned.first_event is None else self._ahead(body, warned.first_event),
            events=len(events),
            events_warned=sum(self._ahead(body, stamp) is not None for stamp in events),
        )

    def _ahead(self, body: str, stamp: int) -> float | None:
        """How long a warning had been standing at a stamp, in s; None where none stood."""
        begun = [begin for begin, end in self._stood[body] if begin < stamp <= end]
        return (stamp - begun[-1]) / 1e9 if begun else None


def events_of(stamps: Iterable[int]) -> list[int]:
    """The stamps, in ns, at which something begins to happen after a time of `APART` in which nothing did."""
    happened = sorted(stamps)
    return happened[:1] + [after for before, after in pairwise(happened) if after - before >= APART]
