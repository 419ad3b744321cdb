"""What is checked of a run, and what is said of it where it is wrong."""

from __future__ import annotations

from typing import Any

import pytest
from touchdowns import TOUCHDOWN

from impact_predictor.bags.replay import Result, Settled
from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Twist
from impact_predictor.prediction.types import Landing, Leftover, Score
from impact_predictor.scenarios.comparison import Truth
from impact_predictor.testing.checks import Check, Range, Tolerances, checks_of, read_tolerances
from impact_predictor.testing.plugin import TOLERANCES as OPTIONS

TOLERANCES = Tolerances(
    error=0.3, median_error=0.2, time_error=0.01, mode_accuracy=0.9, missed=1, false=1, touchdowns=Range(1)
)
HISTORY = ((0.055, 0.5), (0.004, 0.25))
RIGHT = Score(
    23_410_000_000, TOUCHDOWN, Twist(0.5, 0.125, -2.0), 0.25, True, Leftover.NONE, HISTORY, announced=HISTORY[0][0]
)
WRONG = RIGHT._replace(stamp=24_000_000_000, relative_error=0.345)
UNSCORED = RIGHT._replace(stamp=25_000_000_000, scored=False, leftover=Leftover.OUT_OF_PLANE | Leftover.TOO_SHORT)
LANDINGS = ((0.2, 0.004), (0.06, 0.012), (0.021, -0.0125), (0.004, -0.001))
LANDED = Score(
    26_000_000_000,
    TOUCHDOWN,
    None,
    None,
    False,
    Leftover.DRIVEN,
    (),
    Landing("LF", 26_000_000_000, None, None, LANDINGS, 0.25),
)


def run(*settled: tuple[str, Score], **others: Any) -> Result:
    result = Result("run.mcap", 4, 0.001, tuple(Settled(*one, None) for one in settled), {}, {}, (), "", "")
    return result._replace(**others)


def by_name(result: Result, **tolerances: Any) -> dict[str, Check]:
    checks = checks_of(result, TOLERANCES._replace(**tolerances))
    found = {check.name: check for check in checks}
    assert len(found) == len(checks)
    return found


def test_each_touchdown_is_numbered_in_the_order_of_time_with_its_time_in_its_name() -> None:
    names = [check.name for check in checks_of(run(("cube", WRONG), ("cube", RIGHT)), TOLERANCES)]
    of_run = ["samples", "number of touchdowns", "median error"]
    assert names == [*of_run, "touchdown 1 at 23.41 s", "touchdown 2 at 24.00 s"]


def test_names_tell_the_body_where_there_are_several_and_the_foot_of_a_landing() -> None:
    names = list(by_name(run(("crate", RIGHT), ("drum", WRONG), ("robot", LANDED))))[-3:]
    assert [name.partition(" (")[2] for name in names] == ["crate)", "drum)", "robot LF)"]


def test_times_of_day_are_counted_from_the_first_touchdown() -> None:
    day = 1_700_000_000_000_000_000
    scores = [("cube", score._replace(stamp=score.stamp + day)) for score in (RIGHT, WRONG)]
    assert list(by_name(run(*scores)))[-2:] == ["touchdown 1 at 0.00 s", "touchdown 2 at 0.59 s"]


def test_a_touchdown_within_the_tolerance_passes_and_one_beyond_it_tells_what_was_predicted_and_measured() -> None:
    checks = by_name(run(("cube", RIGHT), ("cube", WRONG)))
    assert checks["touchdown 1 at 23.41 s"] == Check("touchdown 1 at 23.41 s", figures={"relative_error": 0.25})
    wrong = checks["touchdown 2 at 24.00 s"]
    assert wrong.figures == {"relative_error": 0.345}
    assert wrong.flaw.splitlines() == [
        "the error is 34.5 %, more than 30.0 % (impact_error)",
        "PIVOT_SLIDE was predicted 4.0 ms ahead, first 55.0 ms ahead",
        "                vx m/s    vy m/s  omega rad/s",
        "before          1.0000   -0.5000       -4.000",
        "predicted       0.7500    0.2500       -3.000",
        "measured        0.5000    0.1250       -2.000",
        "flags: reversed slip",
    ]


def test_a_touchdown_that_is_not_scored_is_skipped_with_the_reason() -> None:
    check = by_name(run(("cube", UNSCORED)))["touchdown 1 at 25.00 s"]
    assert (check.flaw, check.skipped) == ("", "not scored: out of plane, too short")


def test_of_a_landing_the_time_told_20_ms_ahead_counts() -> None:
    name = "touchdown 1 at 26.00 s (LF)"
    assert not by_name(run(("robot", LANDED)), time_error=0.0125)[name].flaw
    assert by_name(run(("robot", LANDED)))[name].flaw.splitlines() == [
        "the time told 20 ms ahead was 12.5 ms too early, more than 10 ms (impact_time_error)",
        "PIVOT_SLIDE predicted; by its motion LF stood at 26.0000 s",
        "told 200.0 ms ahead: 26.0040 s, +4.0 ms",
        "told   4.0 ms ahead: 25.9990 s, -1.0 ms",
    ]
    assert LANDED.landing is not None
    late = LANDED._replace(landing=LANDED.landing._replace(history=((0.012, 0.0),)))
    assert by_name(run(("robot", late)))[name].flaw == (
        "no time was told 20 ms ahead of LF's landing, the first time was told 12.0 ms ahead"
    )
    never = LANDED._replace(landing=LANDED.landing._replace(history=()))
    assert by_name(run(("robot", never)))[name].flaw == "no time was told 20 ms ahead of LF's landing, nor later"


def test_the_median_error_of_the_run_is_checked_where_anything_is_scored() -> None:
    result = run(("cube", RIGHT), ("cube", UNSCORED._replace(relative_error=0.9)))
    assert not by_name(result, median_error=0.25)["median error"].flaw
    assert by_name(result)["median error"].flaw == "the median error is 25.0 %, more than 20.0 % (impact_median_error)"
    unscored = by_name(run(("cube", UNSCORED)))["median error"]
    assert unscored.skipped == "no touchdown is scored: 1 out of plane, 1 too short"
    assert "median error" not in by_name(run(("robot", LANDED)))


def test_the_number_of_touchdowns_is_checked() -> None:
    name = "number of touchdowns"
    assert by_name(run())[name].flaw == "0 touchdowns, not 1.. (impact_touchdowns)"
    flaw = by_name(run(("cube", RIGHT)), touchdowns=Range(2, 3))[name].flaw
    assert flaw == "1 touchdown, not 2..3 (impact_touchdowns)"


@pytest.mark.parametrize("field", ["unpredictable", "damaged"])
def test_a_bag_that_could_not_be_used_or_only_in_part_fails(field: str) -> None:
    assert by_name(run(("cube", RIGHT), **{field: "why"}))["samples"].flaw == "why"
    assert by_name(run(("cube", RIGHT)))["samples"] == Check("samples", figures={"samples": 4})


def test_against_a_truth_in_the_bag_missed_and_false_touchdowns_modes_velocities_and_times_are_checked() -> None:
    right = Truth(50, 1, 1, 0, 0.5, 0.2, 0.01, clear=40, clear_mode_accuracy=0.9)
    checks = by_name(run(("cube", RIGHT), truth=right))
    names = ["missed touchdowns", "false alarms", "modes", "median error against the truth", "median error of time"]
    assert list(checks)[3:-1] == names
    assert not any(checks[name].flaw for name in names)
    wrong = Truth(50, 2, 2, 0, 0.5, 0.25, 0.0125, clear=40, clear_mode_accuracy=0.875)
    checks = by_name(run(("cube", RIGHT), truth=wrong))
    assert [checks[name].flaw for name in names] == [
        "2 of 50 true touchdowns missed, more than 1 (impact_missed)",
        "2 false alarms, more than 1 (impact_false)",
        "87.5 % of 40 clear modes are right, less than 90.0 % (impact_mode_accuracy)",
        "the median error against the truth is 25.0 %, more than 20.0 % (impact_median_error)",
        "the times told 20 ms ahead are 12.5 ms wrong in the median, more than 10 ms (impact_time_error)",
    ]
    # What a truth does not tell is no test.
    assert list(by_name(run(truth=Truth(0, 0, 0, 0, None, None, None))))[2:] == names[:2]


DEFAULTS = {name: default for name, (default, _) in OPTIONS.items()}


def test_every_tolerance_has_an_option_with_a_default() -> None:
    assert set(OPTIONS) == set(Tolerances._fields)
    assert read_tolerances(DEFAULTS) == Tolerances(0.5, 0.2, 0.02, 0.9, 0, 0, Range(1))


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [("12", [12], [11, 13]), ("10..12", [10, 12], [9, 13]), ("10..", [10, 14], [9]), ("0", [0], [1])],
)
def test_a_range_of_touchdowns_is_one_number_two_or_open(text: str, inside: list[int], outside: list[int]) -> None:
    wanted = read_tolerances(DEFAULTS | {"touchdowns": text}).touchdowns
    assert str(wanted) == text
    for number in inside + outside:
        found = by_name(run(*number * [("cube", RIGHT)]), touchdowns=wanted)["number of touchdowns"]
        assert bool(found.flaw) == (number in outside)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        *[("error", text) for text in ("", "much", "-0.1", "nan")],
        *[("missed", text) for text in ("", "-1", "0.5", "one")],
        *[("touchdowns", text) for text in ("", "..", "..5", "5..3", "5-6", "-1", "1.5", "1...3")],
    ],
)
def test_what_is_no_such_number_is_refused_by_its_name(name: str, text: str) -> None:
    with pytest.raises(InputError, match=f"^impact_{name} is '{text}'; give "):
        read_tolerances(DEFAULTS | {name: text})
