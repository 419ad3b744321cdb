"""What happened in a replay: stances of feet, and the true impacts and onsets where the bag tells them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from ..prediction.scene import Walking
from ..prediction.types import Prediction
from ..ros.messages import MalformedMessage
from ..scenarios.matching import Announcements
from ..scenarios.truth import (
    ONSET_TOPIC,
    TRUTH_TOPIC,
    TrueImpact,
    TrueOnset,
    decode_true_impacts,
    decode_true_onsets,
)

if TYPE_CHECKING:
    from ..scenarios.warned import Warned, Warnings


class FootStance(NamedTuple):
    """A foot, by its place in feet.names, that stands from `begin` to `end` (stamps in ns)."""

    foot: int
    begin: int
    end: int


class Gait:
    """The stances of one machine as they were inferred, and the true ones where they are known."""

    def __init__(self, walking: Walking) -> None:
        self.feet = walking.feet
        self.begin = self.end = 0
        """Stamps of the first and the last sample in ns."""
        self.samples = 0
        self._inferred, self._true = _Stances(), _Stances()

    @property
    def stances(self) -> list[FootStance]:
        """As they were inferred."""
        return self._inferred.until(self.end)

    @property
    def true_stances(self) -> list[FootStance]:
        """Those that the record tells; none where it tells of none."""
        return self._true.until(self.end)

    def tell(self, stamp: int, stands: tuple[bool, ...]) -> None:
        """Take which feet truly stand at a stamp in ns."""
        for foot, stands_now in enumerate(stands[: len(self.feet)]):
            self._true.take(foot, stands_now, stamp)

    def take(self, prediction: Prediction) -> None:
        """Take the answer to an accepted sample."""
        self.end = prediction.sample.stamp
        self.begin = self.begin if self.samples else self.end
        self.samples += 1
        for number, foot in enumerate(prediction.feet):
            # What stands or swings from the beginning on has not begun at any stamp.
            self._inferred.take(number, foot.stands, foot.since or self.begin)


class _Stances:
    """The stances of feet, from whether they stand, sample by sample."""

    def __init__(self) -> None:
        self._ended: list[FootStance] = []
        self._since: dict[int, int] = {}

    def take(self, foot: int, stands: bool, stamp: int) -> None:
        """Know that a foot stands, or does not, since a stamp."""
        if stands:
            self._since.setdefault(foot, stamp)
        elif foot in self._since:
            self._ended.append(FootStance(foot, self._since.pop(foot), stamp))

    def until(self, end: int) -> list[FootStance]:
        return [*self._ended, *[FootStance(foot, begin, end) for foot, begin in self._since.items()]]


class TrueEvents:
    """The true impacts and onsets of a bag, and what was announced and, where margins are watched, warned of.

    `takers` take the messages that tell of them, as log time in ns and bytes, by their topics.
    """

    def __init__(self, *, watches: bool) -> None:
        """Nothing has happened yet."""
        self.impacts: list[TrueImpact] = []
        self.announcements = Announcements()
        self.warnings: Warnings | None = None
        self._onsets: list[TrueOnset] = []
        self.takers: dict[str, Callable[[int, bytes], None]] = {
            TRUTH_TOPIC: partial(_take, self.impacts, decode_true_impacts),
            ONSET_TOPIC: partial(_take, self._onsets, decode_true_onsets),
        }
        if watches:
            from ..scenarios.warned import Warnings

            self.warnings = Warnings()

    def warned(self, bodies: Iterable[str]) -> dict[str, Warned]:
        """How bodies were warned of, where margins are watched."""
        if self.warnings is None:
            return {}
        names = self.announcements.names
        impacts: dict[str, list[TrueImpact]] = defaultdict(list)
        onsets: dict[str, list[TrueOnset]] = defaultdict(list)
        for impact in self.impacts:
            impacts[names.get(impact.body, impact.body)].append(impact)
        for onset in self._onsets:
            onsets[names.get(onset.body, onset.body)].append(onset)
        # A body alone may have no name; it goes by its frame.
        frame = next(iter([*names.values(), *impacts]), "")
        return {body or frame: self.warnings.of(body, impacts[body or frame], onsets[body or frame]) for body in bodies}


def _take(known: list[Any], decode: Callable[[bytes], Iterable[Any]], log_time: int, data: bytes) -> None:
    # What tells no truth there is another program's.
    with suppress(MalformedMessage):
        known.extend(decode(data))
