"""What comes on each input of the node, and in words where nothing of use does."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..prediction.checks import REMEDIES
from ..prediction.scene import IMU, STATES, TRANSFORMS, Input
from ..prediction.types import Status
from ..wording import counted, listed

if TYPE_CHECKING:
    from ..prediction.monitor import Monitor

STALE_AFTER: Final = 1.0
"""Seconds without a sample after which the input counts as stale."""

SILENT: Final = 5.0
"""Seconds without a message on an input after which the log says so, and without any state after which the node is in
error."""

_SUPPORT: Final = "support/"
_OF_SUPPORT: Final = (Status.NO_SUPPORT, Status.SUPPORT_STALE, Status.SUPPORT_JUMPED, Status.GRAVITY_WRONG)
_OF_CONTACTS: Final = (Status.NO_GEOMETRY, Status.GEOMETRY_STALE)


def route(monitor: Monitor, one: Input) -> Callable[[Any], Status]:
    """What of the monitor takes the messages on an input that is no state of a body."""
    if one.kind in TRANSFORMS:
        return partial(monitor.update_frames, is_fixed=one.kind == TRANSFORMS[0])
    if one.body is None:
        return monitor.update_support_imu if one.kind == IMU else monitor.update_support
    return partial(monitor.update_imu if one.kind == IMU else monitor.tell, one.body)


class Refusal(NamedTuple):
    """Why a message was refused: the relative name of its input, and its status."""

    input: str
    status: Status

    def said(self, flaw: str = "") -> str:
        """It as words, with the `flaw` of the message as far as it is known."""
        return f"{self.input} {self.why(flaw)}"

    def why(self, flaw: str = "") -> str:
        """As `said`, without the input."""
        return f"{self.status.name}: {flaw or REMEDIES[self.status]}"

    @property
    def is_of_support(self) -> bool:
        """Whether a body was refused for what its support tells, or does not."""
        return self.status in _OF_SUPPORT and not self.input.startswith(_SUPPORT)

    @property
    def is_consequence(self) -> bool:
        """Whether another input than its own is to blame."""
        return self.is_of_support or self.status in _OF_CONTACTS


class Misfit(NamedTuple):
    """An endpoint that DDS keeps apart from one of the node's: by its "QoS" or its "type", on which topic, in words."""

    kind: str
    topic: str
    said: str


class _Refused(NamedTuple):
    """What was refused on an input since its last accepted message; `now` in s is when the last one was."""

    number: int
    now: float
    reason: Refusal
    flaw: str


class InputReport:
    """Knows of each input that is to keep coming when a message was last accepted, and what was refused since.

    `now` is always in s of one steady clock.
    """

    def __init__(self, names: Sequence[str], now: float) -> None:
        self.publishers = dict.fromkeys(names, 0)
        """How many publish on each input. A plan need not keep coming, so it is none of them."""
        self.misfits: list[Misfit] = []
        """What DDS keeps apart from this node now."""
        self._began = now
        self._heard: dict[str, float] = {}
        self._refused: dict[str, _Refused] = {}
        self._told: set[str] = set()
        is_state = [name.rpartition("/")[2] in STATES and not name.startswith(_SUPPORT) for name in names]
        self._states = [name for name, one in zip(names, is_state, strict=True) if one] or list(names)

    def accepted(self, now: float, name: str) -> float:
        """Note an accepted message; for how many seconds there was none before it."""
        was = self._heard.get(name, -math.inf)
        self._heard[name] = now
        if name in self._refused:
            del self._refused[name]
        return now - was

    def refused(self, now: float, reason: Refusal, flaw: str) -> None:
        """Note a refused message."""
        before = self._refused.get(reason.input)
        self._refused[reason.input] = _Refused(1 + (before.number if before else 0), now, reason, flaw)

    def has_heard(self, name: str) -> bool:
        """Whether a message on an input was accepted."""
        return name in self._heard

    def since_last(self, now: float) -> float | None:
        """Seconds since the last accepted message on any input; None where there was none."""
        last = [self._heard[name] for name in self.publishers if name in self._heard]
        return now - max(last) if last else None

    def flaw(self, now: float) -> tuple[str, bool]:
        """What is wrong with what comes, "" where nothing is; and whether nothing is predicted any more for it."""
        silent = {name for name in self.publishers if now - self._heard.get(name, -math.inf) > STALE_AFTER}
        refused = [self._refused[name] for name in self.publishers if name in silent and name in self._refused]
        quiet = [name for name in self.publishers if name in silent and name not in self._refused]
        said = [self._apart(), _only_refused(now, refused), self._missing(quiet), self._stopped(now, quiet)]
        idle = now - max([self._heard.get(name, self._began) for name in self._states], default=now)
        is_awaited = not any(
            self.publishers.get(name) or name in {*self._heard, *self._refused} for name in self._states
        )
        is_refused = any(one.reason.status is not Status.NO_GEOMETRY for one in refused)
        is_lost = idle > STALE_AFTER if is_refused else idle > SILENT and not is_awaited
        return "; ".join([one for one in said if one]), is_lost

    def _apart(self) -> str:
        """What DDS keeps apart, the first of it in words."""
        if not self.misfits:
            return ""
        kind, _, said = self.misfits[0]
        return f"{kind} does not match ({[one.kind for one in self.misfits].count(kind)}): {said}"

    def _missing(self, quiet: Iterable[str]) -> str:
        """Which inputs never had a message."""
        names = [name for name in quiet if name not in self._heard]
        lonely = [name for name in names if not self.publishers[name]]
        if not names:
            return ""
        has_others = len(self.publishers) > 1
        where = f" on {listed(names, last='and')}" if has_others else ""
        there = "there" if has_others and lonely == names else f"on {listed(lonely, last='and')}"
        return f"no sample yet{where}" + (f": nobody publishes {there}" if lonely else "")

    def _stopped(self, now: float, quiet: Iterable[str]) -> str:
        """Which inputs had messages, and have none any more."""
        names = [name for name in quiet if name in self._heard]
        if not names:
            return ""
        where = f" on {listed(names, last='and')}" if len(self.publishers) > 1 else ""
        return f"no sample{where} for {now - min([self._heard[name] for name in names]):.1f} s"

    def fallen_silent(self, now: float, topics: Mapping[str, str]) -> list[str]:
        """A sentence for each reason why inputs have told nothing for a while, about each once until it is heard again.

        `topics` are the resolved names of the inputs.
        """
        silent = {name for name in self.publishers if now - self._heard.get(name, self._began) > SILENT}
        fallen: dict[str | Status, list[str]] = {}
        for name in sorted(silent - self._told):
            reason = self._refused[name].reason if name in self._refused else None
            why = self._why_nothing(name, topics[name]) if reason is None else reason.status
            # What is to be said of a support that is silent itself holds for all that it carries.
            if reason is None or not (reason.is_of_support and any(one.startswith(_SUPPORT) for one in silent)):
                fallen.setdefault(why, []).append(name)
        self._told = silent
        return [self._silence(why, names, topics) for why, names in fallen.items()]

    def _why_nothing(self, name: str, topic: str) -> str:
        apart = [one.said for one in self.misfits if one.topic == topic]
        number = self.publishers[name]
        return apart[0] if apart else f"{counted(number, 'publisher')} there" if number else "nobody publishes there"

    def _silence(self, why: str | Status, names: Sequence[str], topics: Mapping[str, str]) -> str:
        where = f"on {listed([topics[name] for name in names], 4, 'and')} for {SILENT:.0f} s"
        if isinstance(why, str):
            return f"nothing has come {where}: {why}"
        refused = [self._refused[name] for name in names]
        number, last = sum([one.number for one in refused]), max(refused, key=lambda one: one.now)
        support = next((topics[name] for name in self.publishers if name.startswith(_SUPPORT)), "")
        because = f" because of {support}" if support and last.reason.is_of_support else ""
        return f"nothing but refused messages has come {where} ({number:,}){because}: {last.reason.why(last.flaw)}"


def _only_refused(now: float, refused: Sequence[_Refused]) -> str:
    """Which inputs had refused messages last, and have none any more."""
    if not refused:
        return ""
    names, number = [one.reason.input for one in refused], sum([one.number for one in refused])
    first = min(refused, key=lambda one: one.reason.is_consequence)
    ago = now - max([one.now for one in refused])
    where = f" on {listed(names, last='and')}" if len(names) > 1 else ""
    return f"nothing but refused messages{where} ({number}), the last {ago:.1f} s ago; {first.reason.said(first.flaw)}"
