"""Whether a body was warned of before anything happened to it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from ..ros.cdr import ERROR, STALE, WARN
from .truth import TrueImpact, TrueOnset

if TYPE_CHECKING:
    from ..prediction.watch.watch import Report


class Warned(NamedTuple):
    """Stamps in ns of the first report on a body with another level than STALE and of the first with WARN or ERROR.

    And, from that on which it was known at all, of its first slide and its first impact. None where there was none.
    """

    first_known: int | None
    first_warning: int | None
    first_slide: int | None
    first_impact: int | None

    @property
    def first_event(self) -> int | None:
        """The first slide or impact."""
        return min((stamp for stamp in (self.first_slide, self.first_impact) if stamp is not None), default=None)

    @property
    def before_first_impact(self) -> bool | None:
        """Whether the first warning came before the first slide or impact; None where nothing happened."""
        happened = self.first_event
        if happened is None:
            return None
        return self.first_warning is not None and self.first_warning < happened


class Warnings:
    """The first warning of each body."""

    def __init__(self) -> None:
        self._known: dict[str, int] = {}
        self._warned: dict[str, int] = {}

    def take(self, reports: Iterable[Report]) -> None:
        """Take reports in the order of their stamps."""
        for report in reports:
            if report.level != STALE:
                self._known.setdefault(report.body, report.stamp)
            if report.level in (WARN, ERROR):
                self._warned.setdefault(report.body, report.stamp)

    def of(self, body: str, impacts: Iterable[TrueImpact], onsets: Iterable[TrueOnset]) -> Warned:
        """How a body was warned of, with what happened to it."""
        known = self._known.get(body)
        # Nothing can be told before.
        slides = [onset.stamp for onset in onsets if onset.slides and known is not None and onset.stamp >= known]
        struck = [impact.stamp for impact in impacts if known is not None and impact.stamp >= known]
        return Warned(known, self._warned.get(body), min(slides, default=None), min(struck, default=None))
