"""Whether a body was warned of in time, from reports and truths that one can read off."""

from __future__ import annotations

import pytest

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.scene import Scene, Watching
from impact_predictor.prediction.watch.watch import Level, Report
from impact_predictor.scenarios.comparison import APART, Comparison, Warned, events_of
from impact_predictor.scenarios.truth import TrueImpact, TrueOnset

ZERO = (0.0, 0.0, 0.0)


WATCHED = Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5, watching=Watching())


def warned_of(levels: tuple[Level, ...], impacts: list[int], onsets: list[TrueOnset], body: str = "crate") -> Warned:
    """How a body was warned of by a report on the crate for each level, one after the other from stamp 0 on."""
    made = Comparison({body: WATCHED})
    made.impacts += map(impact, impacts)
    made.onsets += onsets
    for stamp, level in enumerate(levels):
        made.add_reports([Report("crate", stamp, level, "", {})])
    warned = made.compare().bodies[body].warned
    assert warned is not None
    return warned


def impact(stamp: int) -> TrueImpact:
    return TrueImpact(stamp, "crate", Mode.PIVOT, (0,), (1,), 1.0, 0.5, 1.0, ZERO, ZERO, ZERO, ZERO)


def slide(stamp: int) -> TrueOnset:
    return TrueOnset(stamp, "crate", slides=True, lifts=False)


OK, WARN, ERROR, STALE = Level.OK, Level.WARN, Level.ERROR, Level.STALE


def lift(stamp: int) -> TrueOnset:
    return TrueOnset(stamp, "crate", slides=False, lifts=True)


FOUND = {"events": 1, "events_warned": 1}


@pytest.mark.parametrize(
    ("levels", "impacts", "onsets", "expected"),
    [
        ((OK, OK, WARN, ERROR), [9, 7], [slide(8), slide(6), lift(5)], Warned(0, 2, 6, 7, 5, 4e-9, **FOUND)),
        # It did not stand until then.
        ((OK, WARN, OK, OK), [5], [], Warned(0, 1, None, 5, events=1)),
        ((OK, WARN, STALE, OK), [5], [], Warned(0, 1, None, 5, events=1)),
        # It is as old as its last beginning, and ends after the event.
        ((OK, WARN, OK, OK, WARN, ERROR, WARN), [8], [], Warned(0, 1, None, 8, None, 4e-9, **FOUND)),
        ((OK, WARN, WARN, WARN, OK), [3], [], Warned(0, 1, None, 3, None, 2e-9, **FOUND)),
        # That something is not known is no warning, and what happened before anything was known does not count.
        ((OK, STALE, STALE), [3], [], Warned(0, None, None, 3, events=1)),
        ((STALE, OK, WARN), [0, 5 + APART], [slide(0)], Warned(1, 2, None, 5 + APART, None, 5.000000003, **FOUND)),
        ((STALE, STALE), [1], [], Warned(None, None, None, None)),
        # It only lifts, or nothing happens.
        ((OK, WARN), [], [lift(3)], Warned(0, 1, None, None, 3, 2e-9, **FOUND)),
        ((OK, WARN), [], [], Warned(0, 1, None, None)),
    ],
)
def test_the_first_warning_and_the_first_events_are_told(
    levels: tuple[Level, ...], impacts: list[int], onsets: list[TrueOnset], expected: Warned
) -> None:
    assert warned_of(levels, impacts, onsets) == expected


def test_the_first_event_is_a_slide_or_an_impact_and_a_lift_where_there_is_neither() -> None:
    events = Warned(0, 2, 6, 7, 5, 4e-9), Warned(0, 1, None, None, 3, 2e-9)
    assert [(one.first_event, one.before_first_impact) for one in events] == [(6, True), (3, None)]


def test_what_follows_soon_is_the_same_event() -> None:
    assert events_of([]) == []
    # Each is less than that after the one before, though the last is more than that after the first.
    assert events_of([APART, 0, 2 * APART - 1, 4 * APART]) == [0, APART, 4 * APART]
    assert events_of([0, APART - 1, 2 * (APART - 1)]) == [0]


def test_each_event_is_looked_at_for_a_warning_of_its_own() -> None:
    warned = warned_of((OK, WARN, OK), [2, 2 * APART], [lift(4 * APART)])
    assert (warned.events, warned.events_warned) == (3, 1)


def test_events_tell_what_begins_and_are_unknown_without_a_truth() -> None:
    made = Comparison({"crate": WATCHED})
    made.impacts += [impact(2 * APART), impact(2 * APART + 1)]
    made.onsets += [slide(5), lift(4 * APART)]
    assert made.events() == {"crate": {5: "slides", 2 * APART: "impact, PIVOT", 4 * APART: "lifts"}}
    assert Comparison({"crate": WATCHED}, knows_impacts=False).events() is None
