"""Whether a body was warned of in time, from reports and truths that one can read off."""

from __future__ import annotations

import pytest

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.watch.watch import Level, Report
from impact_predictor.scenarios.truth import TrueImpact, TrueOnset
from impact_predictor.scenarios.warned import APART, Warned, Warnings, events_of

ZERO = (0.0, 0.0, 0.0)


def reported(*levels: Level, body: str = "crate") -> Warnings:
    """A report for each level, one after the other from stamp 0 on."""
    warnings = Warnings()
    for stamp, level in enumerate(levels):
        warnings.take([Report(body, stamp, level, "", {})])
    return warnings


def impact(stamp: int) -> TrueImpact:
    return TrueImpact(stamp, "crate", Mode.PIVOT, (0,), (1,), 1.0, 0.5, 1.0, ZERO, ZERO, ZERO, ZERO)


def slide(stamp: int) -> TrueOnset:
    return TrueOnset(stamp, "crate", slides=True, lifts=False)


OK, WARN, ERROR, STALE = Level.OK, Level.WARN, Level.ERROR, Level.STALE


def lift(stamp: int) -> TrueOnset:
    return TrueOnset(stamp, "crate", slides=False, lifts=True)


def test_the_first_warning_and_the_first_events_are_told() -> None:
    warned = reported(OK, OK, WARN, ERROR).of("crate", [impact(9), impact(7)], [slide(8), slide(6), lift(5)])
    assert warned == Warned(0, 2, 6, 7, 5, warned_ahead=4e-9, events=1, events_warned=1)
    assert (warned.first_event, warned.before_first_impact) == (6, True)


@pytest.mark.parametrize(("happened", "answer"), [(2, False), (3, True)])
def test_a_warning_comes_before_what_it_warns_of(happened: int, answer: bool) -> None:
    assert reported(OK, OK, WARN).of("crate", [impact(happened)], []).before_first_impact is answer
    assert reported(OK, OK, WARN).of("crate", [], [slide(happened)]).before_first_impact is answer


@pytest.mark.parametrize("other", [OK, STALE])
def test_a_warning_that_did_not_stand_until_then_does_not_count(other: Level) -> None:
    warned = reported(OK, WARN, other, OK).of("crate", [impact(5)], [])
    assert (warned.first_warning, warned.warned_ahead, warned.before_first_impact) == (1, None, False)
    assert (warned.events, warned.events_warned) == (1, 0)


def test_a_warning_is_as_old_as_its_last_beginning() -> None:
    warned = reported(OK, WARN, OK, OK, WARN, ERROR, WARN).of("crate", [impact(8)], [])
    assert (warned.first_warning, warned.warned_ahead) == (1, 4e-9)


def test_a_warning_that_ends_after_the_event_counts() -> None:
    assert reported(OK, WARN, WARN, WARN, OK).of("crate", [impact(3)], []).warned_ahead == 2e-9


def test_that_something_is_not_known_is_no_warning() -> None:
    assert reported(OK, STALE, STALE).of("crate", [impact(3)], []) == Warned(0, None, None, 3, events=1)
    assert reported(OK, STALE).of("crate", [impact(3)], []).before_first_impact is False


def test_what_happened_before_anything_was_known_does_not_count() -> None:
    warned = reported(STALE, STALE, OK, WARN).of("crate", [impact(1), impact(5 + APART)], [slide(0)])
    assert warned[:4] == (2, 3, None, 5 + APART)
    assert (warned.events, warned.events_warned) == (1, 1)
    assert reported(STALE, STALE).of("crate", [impact(1)], []) == Warned(None, None, None, None)


def test_a_body_that_only_lifts_has_an_event_but_neither_slide_nor_impact() -> None:
    warned = reported(OK, WARN).of("crate", [], [lift(3)])
    assert warned == Warned(0, 1, None, None, 3, warned_ahead=2e-9, events=1, events_warned=1)
    assert (warned.first_event, warned.before_first_impact) == (3, None)


def test_what_follows_soon_is_the_same_event() -> None:
    assert events_of([]) == []
    # Each is less than that after the one before, though the last is more than that after the first.
    assert events_of([APART, 0, 2 * APART - 1, 4 * APART]) == [0, APART, 4 * APART]
    assert events_of([0, APART - 1, 2 * (APART - 1)]) == [0]


def test_each_event_is_looked_at_for_a_warning_of_its_own() -> None:
    warnings = reported(OK, WARN, OK)
    warned = warnings.of("crate", [impact(2), impact(2 * APART)], [lift(4 * APART)])
    assert (warned.events, warned.events_warned) == (3, 1)


def test_where_nothing_happened_there_is_no_answer() -> None:
    assert reported(OK, WARN).of("crate", [], []).before_first_impact is None
    assert reported(OK, WARN).of("drum", [], []) == Warned(None, None, None, None)
