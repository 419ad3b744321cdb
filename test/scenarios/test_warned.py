"""Whether a body was warned of in time, from reports and truths that one can read off."""

from __future__ import annotations

import pytest

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.watch.watch import Level, Report
from impact_predictor.scenarios.truth import TrueImpact, TrueOnset
from impact_predictor.scenarios.warned import Warned, Warnings

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


def test_the_first_warning_and_the_first_events_are_told() -> None:
    warned = reported(OK, OK, WARN, ERROR, OK).of("crate", [impact(9), impact(7)], [slide(8), slide(6)])
    assert warned == Warned(0, 2, 6, 7)
    assert (warned.first_event, warned.before_first_impact) == (6, True)


@pytest.mark.parametrize(("happened", "answer"), [(2, False), (3, True)])
def test_a_warning_comes_before_what_it_warns_of(happened: int, answer: bool) -> None:
    assert reported(OK, OK, WARN).of("crate", [impact(happened)], []).before_first_impact is answer
    assert reported(OK, OK, WARN).of("crate", [], [slide(happened)]).before_first_impact is answer


def test_that_something_is_not_known_is_no_warning() -> None:
    assert reported(OK, STALE, STALE).of("crate", [impact(3)], []) == Warned(0, None, None, 3)
    assert reported(OK, STALE).of("crate", [impact(3)], []).before_first_impact is False


def test_what_happened_before_anything_was_known_does_not_count() -> None:
    warned = reported(STALE, STALE, OK, WARN).of("crate", [impact(1), impact(5)], [slide(0)])
    assert warned == Warned(2, 3, None, 5)
    assert reported(STALE, STALE).of("crate", [impact(1)], []).before_first_impact is None


def test_where_nothing_happened_there_is_no_answer() -> None:
    lifted = TrueOnset(1, "crate", slides=False, lifts=True)
    assert reported(OK, WARN).of("crate", [], [lifted]).before_first_impact is None
    assert reported(OK, WARN).of("drum", [], []) == Warned(None, None, None, None)
