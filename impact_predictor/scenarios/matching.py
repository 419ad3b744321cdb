"""Which predictions belong to which true touchdowns, those of impacts or the landings of feet.

Predictions of one touchdown follow each other: the next sample announces the same contacts again, unless the announced
moment has passed. Such a row of predictions belongs to the true touchdown, of those after its last sample, that is
nearest to what it announced last, if they are within `NEAREST` of each other; a row without one was a false alarm.
What was announced for a time less than `NEAREST` before the end of the record, or after it, may still come when nobody
sees it: without a true touchdown it is neither found nor false, and is left out.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from math import inf
from statistics import median
from typing import Final, NamedTuple

from ..mechanics.types import Mode
from ..prediction.types import Touchdown
from ..stamps import NANOSECONDS

NEAREST: Final = 20_000_000
"""ns between an announced touchdown and the true one that it is taken for."""


LEAD_TIMES: Final = (0.02, 0.05)
"""Seconds before a touchdown at which the predictions are made whose errors of time count."""

BORDER: Final = 0.02
"""Relative change of friction or geometry within which another mode may be as right as the true one."""


class Announcement(NamedTuple):
    """A prediction: the stamps of its sample and of the touchdown that it announces, in ns.

    `touchdown` is None where another one is sooner, so that nothing is known of its impact.
    """

    seen: int
    stamp: int
    touchdown: Touchdown | None


class Match(NamedTuple):
    """A true touchdown and what was announced of it, or a false alarm.

    `stamp` in ns and `mode` are those of the true one, None for a false alarm, and `mode` also where the truth does not
    know it; `predictions` are in order, none where it was missed; `shown` says whether the record can show it at its
    rate. `velocity_error` is that of the velocities after the impact, relative to those before, where the truth knows
    them, and `border` is that of the impact, see `truth.border_of`. `foot` is its name where a foot lands, else "".
    """

    body: str
    foot: str
    stamp: int | None
    mode: Mode | None
    predictions: Sequence[Announcement]
    shown: bool = True
    velocity_error: float | None = None
    border: float = inf

    @property
    def mode_is_right(self) -> bool:
        """Whether the last prediction had the true mode."""
        last = self.predictions[-1].touchdown
        return last is not None and last.mode is self.mode

    @property
    def first_lead_time(self) -> float:
        """How long before the true touchdown, in s, the first prediction of it was made."""
        assert self.stamp is not None
        return (self.stamp - self.predictions[0].seen) / NANOSECONDS

    def time_error(self, lead_time: float) -> float | None:
        """Error in s of the time announced a lead time in s ahead, or last before that; None where none was."""
        assert self.stamp is not None
        made = [one for one in self.predictions if one.seen <= self.stamp - round(lead_time * NANOSECONDS)]
        return abs(made[-1].stamp - self.stamp) / NANOSECONDS if made else None


class Rows:
    """The predictions of what touches down again and again, in rows of one touchdown each."""

    def __init__(self) -> None:
        self.all: list[list[Announcement]] = []
        self._goes_on = False

    def add(self, seen: int, lead_time: float | None, touchdown: Touchdown | None) -> None:
        """Take what a sample of a stamp in ns announces; without a lead time in s nothing."""
        if lead_time is None:
            self._goes_on = False
        elif lead_time > 0.0:
            last = self.all[-1][-1] if self._goes_on else None
            same = (
                last is not None
                and seen <= last.stamp
                and (
                    touchdown is None or last.touchdown is None or not set(touchdown.new).isdisjoint(last.touchdown.new)
                )
            )
            if not same:
                self.all.append([])
            self.all[-1].append(Announcement(seen, seen + round(lead_time * NANOSECONDS), touchdown))
            self._goes_on = True


def match(
    stamps: Sequence[int], rows: Iterable[list[Announcement]], end: int, late: int = 0
) -> tuple[dict[int, list[Announcement]], list[list[Announcement]]]:
    """The predictions of each true touchdown by its place, from their stamps in order, and those that are false alarms.

    The record ends at the stamp `end`; a row may go on for `late` ns after its touchdown.
    """
    matched: dict[int, list[Announcement]] = defaultdict(list)
    alarms: list[list[Announcement]] = []
    for row in rows:
        seen, announced, _ = row[-1]
        first = bisect_left(stamps, seen - late)
        later = bisect_left(stamps, announced, lo=first)
        near = [k for k in (later - 1, later) if first <= k < len(stamps) and abs(stamps[k] - announced) <= NEAREST]
        if near:
            matched[min(near, key=lambda k: abs(stamps[k] - announced))] += row
        elif announced <= end - NEAREST:
            alarms.append(row)
    return matched, alarms


class Truth(NamedTuple):
    """How the predictions compare with what happened.

    `touchdowns` that a record can show, and how many of them were `missed`; `false` alarms; `unresolved` impacts that
    no record shows at its rate: fewer than two samples lie between them and the one before, or they come slower than
    gravity moves a body within the contact time. Of those found: the part whose mode the last prediction had right; the
    median relative error of the velocities after them, all three in the plane; the median error in s of the time that
    was announced 20 ms ahead, or last before that. None where there is none.

    `time_error_by_lead_time` has that error for each of `LEAD_TIMES`, and `least_lead_time` is the shortest time in s
    from the first prediction of one to it.

    `clear` of those found are far enough from another mode to tell it: so small an error as `BORDER` does not change
    theirs; then the part of them whose mode was right. `unresolved_wrong` of the unresolved impacts were predicted all
    the same, with another mode than they had.
    """

    touchdowns: int = 0
    missed: int = 0
    false: int = 0
    unresolved: int = 0
    mode_accuracy: float | None = None
    median_velocity_error: float | None = None
    median_time_error: float | None = None
    clear: int = 0
    clear_mode_accuracy: float | None = None
    unresolved_wrong: int = 0
    time_error_by_lead_time: Mapping[str, float | None] = {}
    least_lead_time: float | None = None

    @property
    def found(self) -> int:
        """How many were not missed."""
        return self.touchdowns - self.missed


def truth_of(matches: Sequence[Match]) -> Truth:
    """What is said of true touchdowns and false alarms."""
    shown = [one for one in matches if one.stamp is not None and one.shown]
    hidden = [one for one in matches if one.stamp is not None and not one.shown]
    found = [one for one in shown if one.predictions]
    right = [one.mode_is_right for one in found if one.mode is not None]
    clear = [one.mode_is_right for one in found if one.mode is not None and one.border > BORDER]
    time_errors = {str(lead_time): _median(one.time_error(lead_time) for one in found) for lead_time in LEAD_TIMES}
    return Truth(
        touchdowns=len(shown),
        missed=len(shown) - len(found),
        false=sum(one.stamp is None for one in matches),
        unresolved=len(hidden),
        mode_accuracy=sum(right) / len(right) if right else None,
        median_velocity_error=_median(one.velocity_error for one in matches),
        median_time_error=time_errors[str(LEAD_TIMES[0])],
        clear=len(clear),
        clear_mode_accuracy=sum(clear) / len(clear) if clear else None,
        unresolved_wrong=sum(bool(one.predictions) and not one.mode_is_right for one in hidden),
        time_error_by_lead_time=time_errors,
        least_lead_time=min((one.first_lead_time for one in found), default=None),
    )


def _median(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return median(known) if known else None
