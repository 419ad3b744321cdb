"""Distributions of errors, and what touchdowns say together."""

from __future__ import annotations

import json

import numpy as np
import pytest
import touchdowns

from impact_predictor.mechanics.types import Twist
from impact_predictor.prediction.types import Leftover
from impact_predictor.report.summary import (
    PER_DECADE,
    WHY,
    Distribution,
    Tally,
    errors_ahead,
    errors_of,
    from_json,
    reasons,
    spread_of,
    to_json,
    together,
)
from impact_predictor.report.touchdowns import row_of

SCORED = row_of("cube", touchdowns.SCORE)
UNSCORED = row_of("cube", touchdowns.UNSCORED)
UNMEASURED = row_of("cube", touchdowns.UNMEASURED)._replace(flags=("OUT_OF_PLANE",))
LANDED = row_of("robot", touchdowns.LANDED)._replace(
    foot="LF",
    announced_lead_time=0.1,
    time_errors=(-0.002, None),
    late=None,
    landing_speed=0.123,
    impulse=(3.0, -4.0),
    velocity_change=Twist(-0.03, 0.04, 0.1),
)


def test_every_reason_that_a_touchdown_is_not_scored_has_words() -> None:
    assert WHY.keys() == {str(flag.name) for flag in Leftover if flag}


def test_only_scored_rows_count() -> None:
    rows = [SCORED, SCORED._replace(relative_error=0.75), UNSCORED, UNMEASURED]
    assert errors_of(rows)[:3] == (2, 0.5, pytest.approx(0.7))
    assert errors_of([]) == Distribution()


def test_every_reason_of_an_unscored_row_is_counted() -> None:
    assert reasons([SCORED, UNSCORED, UNSCORED, UNMEASURED]) == {"OUT_OF_PLANE": 3, "ONE_CORNER_FIRST": 2}


def test_every_prediction_counts_at_its_lead_time() -> None:
    made = [(0.055, 0.5), (0.01, 0.3), (0.004, 0.25), (0.07, 9.0), (-0.001, 9.0), (0.0, -0.1)]
    errors = errors_ahead(made)
    assert [(one.begin, one.errors.number) for one in errors] == [
        (0.0, 2),
        (0.01, 1),
        (0.02, 0),
        (0.03, 0),
        (0.04, 0),
        (0.05, 1),
    ]
    assert errors[0].errors.p50 == pytest.approx(0.175)
    assert errors[2].errors.p50 is None


def test_touchdowns_together_count_the_scored_and_explain_the_others() -> None:
    scored = "scored: relative error 25.0 % in the median, 90 % below 25.0 %."
    assert Tally([SCORED, UNSCORED, UNMEASURED]).sentences() == [
        f"1 of 3 touchdowns {scored}",
        "The samples after the others do not show what the impact left, for one or several reasons each:",
        "  2 out of plane: the body also turned off the plane of the impact, or its contacts lay beside it",
        "  1 one corner first: one corner of the edge that struck came before the other",
    ]
    assert Tally().sentences() == ["No touchdown was predicted."]
    assert Tally([UNMEASURED]).sentences()[0] == "0 of 1 touchdown scored."
    assert Tally([SCORED]).sentences() == [f"1 of 1 touchdown {scored}"]
    whole = SCORED._replace(relative_error_6d=0.125, not_scored_6d=())
    near = UNSCORED._replace(not_scored_6d=("NOT_ISOLATED",))
    whole = whole._replace(simple_errors_6d=(0.7, 0.8, 0.2, 0.5, 0.25))
    simple = "nothing happens 70.0 %, all stops 80.0 %, 0.85 v 20.0 %, no slip 50.0 %, planar law 25.0 %"
    assert Tally([whole, near]).sentences() == [
        "1 of 2 touchdowns scored by the whole twist: relative error 12.5 % in the median, 90 % below 12.5 %.",
        f"Simple answers to these, in the median: {simple}.",
        "1 of 2 touchdowns scored in the impact plane: relative error 25.0 % in the median, 90 % below 25.0 %.",
        "The samples after the others do not show what the impact left, for one or several reasons each:",
        "  1 not isolated: another touchdown was too near",
    ]


def test_landings_together_say_how_early_they_were_predicted_and_what_their_impacts_do() -> None:
    predicted, times, impacts = Tally([LANDED]).sentences()
    assert predicted == "1 landing of 1 foot, 1 predicted, 100 ms ahead or earlier."
    assert times == (
        "Against the motion of the feet as recorded, which ends when they stand, the time predicted 20 ms ahead is "
        "2.0 ms wrong in the median, a foot's gap over its speed 12.0 ms."
    )
    assert impacts == (
        "Feet come down with 0.123 m/s in the median, at most 0.123 m/s; "
        "that gives at most 5.00 N s to a foot and 0.050 m/s to the body."
    )
    bounds = [LANDED._replace(bound=bound) for bound in ("upper bound", "estimate")]
    assert Tally(bounds).sentences()[-1].endswith("0.050 m/s to the body (estimate, upper bound).")
    weak = LANDED._replace(impulse=(0.0, 0.0), velocity_change=Twist(0.0, 0.0, 0.0), landing_speed=0.023)
    largest = Tally([weak, LANDED]).sentences()[-1]
    assert all(said in largest for said in ("0.073 m/s in", "most 0.123 m/s", "most 5.00 N s", "0.050 m/s to the body"))
    mixed = Tally([LANDED, SCORED]).sentences()
    assert any(one.startswith("1 landing") for one in mixed)
    assert any(one.startswith("1 of 1 touchdown scored") for one in mixed)


def test_landings_that_nobody_announced_are_said_and_never_silent() -> None:
    missed = LANDED._replace(time_error=None, time_errors=(None, None))
    assert Tally([missed]).sentences()[0].startswith("1 landing of 1 foot, 0 predicted. The others came too suddenly, ")
    said = Tally([missed, LANDED, LANDED._replace(foot="RF")]).sentences()[0]
    assert said.startswith("3 landings of 2 feet, 2 predicted, 100 ms ahead or earlier. The others came too suddenly, ")


def test_a_second_contact_hides_no_lead_time_of_the_first() -> None:
    second = LANDED._replace(point="toe", old=(0,), new=(1,), announced_lead_time=0.02)
    assert Tally([LANDED, second]).sentences()[0] == "2 landings of 1 foot, 2 predicted, 100 ms ahead or earlier."


def test_the_spread_of_some_numbers_has_their_own_percentiles_and_counts_each_in_its_bin() -> None:
    spread = spread_of([1.0, 1.01, 100.0, 0.0])
    assert (spread.number, spread.p50, spread.most) == (4, 1.005, 100.0)
    # 1.01 is less than 10**(1 / 100); 0 lies with the least number.
    assert spread.bins == {0: 2, 2 * PER_DECADE: 1, -12 * PER_DECADE: 1}


def test_a_spread_comes_back_from_its_json() -> None:
    spread = spread_of([3.0, 0.02, 5e-5])
    assert from_json(json.loads(json.dumps(to_json(spread)))) == spread
    assert from_json(None) == Distribution() == spread_of([])
    assert to_json(Distribution()) == {"count": 0, "p50": None, "p90": None, "p99": None, "max": None, "bins": []}


def test_one_spread_among_empty_ones_stays_exact() -> None:
    spread = spread_of([1.0, 2.0, 4.0])
    assert together([Distribution(), spread, Distribution()]) is spread
    assert together([]) == Distribution()


@pytest.mark.parametrize("ends", [[10], [10, 700]], ids=["two", "three"])
def test_spreads_together_are_those_of_all_numbers(ends: list[int]) -> None:
    numbers = np.random.default_rng(5).lognormal(size=3000)
    parts = [spread_of([float(number) for number in part]) for part in np.split(numbers, ends)]
    spread = together(parts)
    assert (spread.number, spread.most) == (3000, max(numbers))
    for part, value in ((0.5, spread.p50), (0.9, spread.p90), (0.99, spread.p99)):
        # Half the width of a bin, 1.2 %.
        assert value == pytest.approx(float(np.quantile(numbers, part)), rel=0.012)
