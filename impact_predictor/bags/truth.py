"""What a bag of a simulation tells of what truly happened, beside what was announced and warned of."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

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
