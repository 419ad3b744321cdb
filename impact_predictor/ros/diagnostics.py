"""What a running predictor says about itself on /diagnostics: counts, rates, costs, and a level with its reason."""

from __future__ import annotations

from collections import Counter, deque
from typing import Final, NamedTuple

from ..prediction.score import median
from ..prediction.types import Score, Status
from .cdr import ERROR, NANOSECONDS, OK, WARN, DiagnosticForm

STALE_AFTER: Final = 1.0
"""Seconds without a sample after which the input counts as stale."""

COMPARABLE: Final = 10.0
"""Stamps further than this many seconds from the clock were not taken from it, so that no latency follows from them."""

REMEDIES: Final[dict[Status, str]] = {
    Status.NOT_FINITE: "a field is NaN or infinite; look at its source",
    Status.BAD_QUATERNION: "the orientation is zero or not of unit length; look at its source",
    Status.STAMP_REPEATED: "the stamp is that of the message before; let a single source publish, with its own stamps",
    Status.STAMP_WENT_BACK: "the stamp is older than the one before; let a single source publish, in order",
    Status.WRONG_FRAME: "its frame is not that of the scene; compare frame_id with support.frame, and child_frame_id "
    "with the frame of the contact points",
    Status.NO_GEOMETRY: "no contact points are known; publish them on contact_geometry or give body.contact_points",
    Status.TOO_FEW_POINTS: "a body needs at least two contact points",
    Status.COINCIDENT_POINTS: "two of its points coincide",
    Status.MALFORMED: "its bytes are not a message of the topic's type; look at who else publishes there",
}
"""What is wrong with a message of each status but ACCEPTED, and where to look."""


class Refused(NamedTuple):
    """Why a message was refused: the relative name of its input, and its status."""

    input: str
    status: Status

    def __str__(self) -> str:
        return f"{self.input} {self.status.name}: {REMEDIES[self.status]}"


class _Second(NamedTuple):
    """Figures of a second that is over: Hz, then s."""

    rate: float = 0.0
    largest_gap: float = 0.0
    latency: float | None = None
    update_median: float | None = None
    update_max: float | None = None
    total_median: float | None = None


class Diagnostics:
    """Counts what happens to the messages, judges it, and reports it as a diagnostic_msgs/DiagnosticArray.

    `now` is always in s of one steady clock. `second_over` is to be called once a second. `level` is that of the last
    judgement; `accepted`, `refused` and `second_over` say whether it has changed, so that a report is due at once.
    """

    def __init__(self, name: str, now: float) -> None:
        """Count from `now` on, and report under the name of the node."""
        self.level = WARN
        self.message = "no sample yet"
        self.lost = 0
        """Messages that the middleware says it has lost."""
        self.misfits: list[str] = []
        """Whom QoS keeps apart from this node now: topic, node and reason of each."""
        self.publishers = 0
        """Publishers of samples."""
        self._name = name
        self._body = ""
        self._accepted = 0
        self._refused: Counter[Refused] = Counter()
        self._last_sample: float | None = None
        self._last_stamp: int | None = None
        self._touchdowns = 0
        self._scored = 0
        self._errors: deque[float] = deque(maxlen=1000)
        self._second = _Second()
        self._refused_now: Counter[Refused] = Counter()
        self._begin_second(now)

    def _begin_second(self, now: float) -> None:
        self._began = now
        self._updates: list[float] = []
        self._totals: list[float] = []
        self._largest_gap = 0
        self._latency: int | None = None
        self._refused_before = self._refused_now
        self._refused_now = Counter()

    def accepted(self, now: float, stamp: int, latency: int, update: float, total: float) -> bool:
        """Count an accepted sample; `stamp` and its `latency` in ns, the costs of `update` and in `total` in s."""
        self._accepted += 1
        self._updates.append(update)
        self._totals.append(total)
        if self._last_stamp is not None and stamp - self._last_stamp > self._largest_gap:
            self._largest_gap = stamp - self._last_stamp
        self._last_stamp = stamp
        self._latency = latency
        self._last_sample = now
        return self.level != OK and self._judge(now)

    def refused(self, now: float, reason: Refused) -> bool:
        """Count a refused message."""
        self._refused[reason] += 1
        self._refused_now[reason] += 1
        return self.level == OK and self._judge(now)

    def is_news(self, reason: Refused) -> bool:
        """Whether a message is the first in this second to be refused for a reason, and so worth a line in the log."""
        return self._refused_now[reason] == 1

    @property
    def served(self) -> int:
        """How many samples were accepted and messages refused so far."""
        return self._accepted + self._refused.total()

    def settled(self, body: str, score: Score) -> None:
        """Count a touchdown of a body, which has happened."""
        self._body = body
        self._touchdowns += 1
        if score.scored and score.relative_error is not None:
            self._scored += 1
            self._errors.append(score.relative_error)

    def second_over(self, now: float) -> bool:
        """Sum up the second that ends, and begin the next."""
        changed = self._judge(now, at_its_end=True)
        updates = self._updates
        self._second = _Second(
            rate=len(updates) / max(now - self._began, 1e-9),
            largest_gap=self._largest_gap / NANOSECONDS,
            latency=None if self._latency is None else self._latency / NANOSECONDS,
            update_median=median(updates) if updates else None,
            update_max=max(updates) if updates else None,
            total_median=median(self._totals) if updates else None,
        )
        self._begin_second(now)
        return changed

    def report(self, now: float, nanoseconds: int) -> bytes:
        """The bytes of a diagnostic_msgs/DiagnosticArray with everything, stamped in ns."""
        values = self._values(now)
        form = DiagnosticForm(f"{self._name}: predictions", *values)
        return form.fill(nanoseconds, "", self.level, self.message, self._body, list(values.values()))

    def _values(self, now: float) -> dict[str, str]:
        second = self._second
        values = {
            "samples.accepted": str(self._accepted),
            "samples.rate": f"{second.rate:.1f}",
            "samples.largest_gap": f"{second.largest_gap:.4f}",
            "samples.publishers": str(self.publishers),
            "samples.lost": str(self.lost),
            "incompatible_qos": str(len(self.misfits)),
        }
        if self._last_sample is not None:
            values["samples.seconds_since_last"] = f"{now - self._last_sample:.3f}"
        if second.latency is not None and abs(second.latency) < COMPARABLE:
            values["samples.latency"] = f"{second.latency:.6f}"
        for reason in sorted(self._refused):
            values[f"refused.{reason.input}.{reason.status.name}"] = str(self._refused[reason])
        for name, cost in (
            ("update.median", second.update_median),
            ("update.max", second.update_max),
            ("total.median", second.total_median),
        ):
            if cost is not None:
                values[f"cost_us.{name}"] = f"{cost * 1e6:.1f}"
        values["touchdowns"] = str(self._touchdowns)
        values["touchdowns.scored"] = str(self._scored)
        if self._errors:
            values["touchdowns.median_relative_error"] = f"{median(self._errors):.4f}"
        return values

    def _judge(self, now: float, *, at_its_end: bool = False) -> bool:
        """Find the level anew; whether it has changed.

        That nothing but refused messages came is known only at the end of a second.
        """
        before = self.level
        self.level, self.message = self._verdict(now, at_its_end)
        return self.level != before

    def _verdict(self, now: float, at_its_end: bool) -> tuple[int, str]:
        # A refusal counts until a whole second went without one, so that the level does not flicker.
        refused = self._refused_now if at_its_end else self._refused_before + self._refused_now
        if refused:
            count = refused.total()
            reason, _ = refused.most_common(1)[0]
            only_refused = not self._updates and (at_its_end or self.level == ERROR)
            if only_refused and reason.status is not Status.NO_GEOMETRY:
                return ERROR, f"nothing but refused messages ({count}); {reason}"
            return WARN, f"{count} messages refused in the last second; {reason}"
        if self.misfits:
            return WARN, f"QoS does not match ({len(self.misfits)}): {self.misfits[0]}"
        if self._last_sample is None:
            return WARN, "no sample yet" if self.publishers else "no sample yet: nobody publishes on odom"
        age = now - self._last_sample
        if age > STALE_AFTER:
            return WARN, f"no sample for {age:.1f} s"
        return OK, "predicting"
