"""What a replay prints: tables whose numbers are whole at any width, and the truth in its bag in few sentences."""

from __future__ import annotations

import io
import re

import pytest
from rich.console import Console
from rich.table import Table
from touchdowns import LANDED, LANDING, SCORE

from impact_predictor.bags.replay import Result, Settled
from impact_predictor.mechanics.types import Flag, Mode, Twist
from impact_predictor.prediction.types import Status
from impact_predictor.report.replay import (
    MOST_OF_A_KIND,
    landings_table,
    lead_time_table,
    of_each_kind,
    print_replay,
    touchdown_table,
    truth_sentences,
)
from impact_predictor.report.summary import Distribution, SpanErrors
from impact_predictor.report.table import show
from impact_predictor.report.touchdowns import row_of, rows_of
from impact_predictor.scenarios.comparison import BodyTruth, Truth, Warned


def test_the_truth_is_said_in_four_sentences() -> None:
    found, right, time, unseen = truth_sentences(Truth(4, 1, 2, 3, 0.75, 0.0123, 1.5e-6))
    assert found == "Against the truth in the bag: 3 of 4 touchdowns found, 2 false alarms."
    assert right == (
        "Of those found, 75.0 % have the right mode; the velocities after them are within 1.2 % of the true ones in "
        "the median."
    )
    assert time == "Against the truth in the bag, the time predicted 20 ms ahead is 1.5 us wrong in the median."
    assert unseen.startswith("3 more impacts of the truth cannot be seen at this rate of samples and do not count")


def test_of_landings_the_truth_tells_times_alone() -> None:
    assert truth_sentences(Truth(1, 0, 1, 0, None, None, 1.1e-3)) == [
        "Against the truth in the bag: 1 of 1 touchdown found, 1 false alarm.",
        "Against the truth in the bag, the time predicted 20 ms ahead is 1.1 ms wrong in the median.",
    ]


def printed(result: Result, width: int = 80) -> str:
    text = io.StringIO()
    print_replay(Console(file=text, width=width), result)
    return text.getvalue()


TRUTH = Truth(50, 3, 1, 0, 0.98, 0.005, None)
CARGO = Result(
    bag="cargo.mcap",
    samples=1250,
    seconds=1.0,
    settled=(),
    statuses={Status.ACCEPTED: 1239, Status.NO_SUPPORT: 10, Status.OFF_SUPPORT: 1},
    geometry_statuses={},
    notes=(),
    unpredictable="",
    damaged="",
    truth=TRUTH,
    truths={
        "crate": BodyTruth(TRUTH, Warned(1, 10**9, None, 3 * 10**9, warned_ahead=2.0, events=12, events_warned=11)),
        "drum": BodyTruth(
            Truth(0, 0, 0, 0, None, None, None), Warned(1, 2 * 10**9, 10**9, None, events=1, events_warned=0)
        ),
        "blind": BodyTruth(None, Warned(1, None, None, None, 10**9, warned_ahead=0.5, events=1, events_warned=1)),
        "still": BodyTruth(None, Warned(1, 10**9, None, None)),
    },
    inputs={
        "support/odom": {Status.ACCEPTED: 990, Status.SUPPORT_JUMPED: 10},
        "crate/odom": {Status.ACCEPTED: 1000},
        "drum/odom": {Status.ACCEPTED: 239, Status.NO_SUPPORT: 10, Status.OFF_SUPPORT: 1},
    },
)


def row_of_body(text: str, body: str) -> list[str]:
    """The cells of a body in the table of bodies, without its name."""
    (cells,) = [line.split() for line in text.replace(" of ", "_of_").splitlines() if line.split()[:1] == [body]]
    return cells[1:]


@pytest.mark.parametrize("width", [80, 120])
def test_several_bodies_have_a_row_each(width: int) -> None:
    text = printed(CARGO, width)
    assert "…" not in text
    assert "\n\n\n" not in text
    assert "No touchdown was predicted." in text
    assert row_of_body(text, "crate") == ["1,000", "47_of_50", "1", "98.0", "0.5", "11_of_12", "2.0"]
    assert row_of_body(text, "drum") == ["250", "-", "0", "-", "-", "0_of_1", "-"]
    assert row_of_body(text, "blind") == ["0", "-", "0", "-", "-", "1_of_1", "0.5"]
    assert row_of_body(text, "still")[-2:] == ["-", "-"]
    assert "A warning stood before 12 of 14 events." in text
    assert "Refused messages of support/odom: 10 support jumped." in text


def test_without_a_truth_the_bodies_are_compared_with_the_samples() -> None:
    settled = (Settled("crate", SCORE, None), Settled("crate", SCORE._replace(scored=False), None))
    text = printed(CARGO._replace(settled=settled, truth=None, truths={}))
    assert row_of_body(text, "crate") == ["1,000", "1_of_2", "25.0"]


def test_the_table_of_a_long_record_fits_a_narrow_terminal() -> None:
    truth = Truth(1_234, 100, 123, 0, 1.0, 0.0123, None)
    warned = Warned(1, 2, 3, 4, warned_ahead=3599.9, events=120, events_warned=100)
    long = CARGO._replace(
        truths={"container_7": BodyTruth(truth, warned)},
        inputs={"container_7/odom": {Status.ACCEPTED: 3_600_000, Status.OFF_SUPPORT: 36_000}},
    )
    table = printed(long).split("No touchdown")[0]
    assert max(map(len, table.splitlines())) <= 80
    assert {"3,636,000", "1,134", "1,234", "123", "1.2", "3599.9"} <= set(table.split())


def test_what_was_refused_of_every_input_is_said() -> None:
    inputs = {
        "odom": {Status.ACCEPTED: 5},
        "contact_geometry": {Status.FEET_CHANGED: 1},
        "contact_wrench": {Status.ACCEPTED: 3, Status.WRONG_FRAME: 2},
        "schedule": {Status.ACCEPTED: 1},
    }
    walked = CARGO._replace(
        truth=None, truths={}, statuses=inputs["odom"], geometry_statuses=inputs["contact_geometry"], inputs=inputs
    )
    refused = [line for line in printed(walked).splitlines() if line.startswith("Refused")]
    assert refused == [
        "Refused messages of contact_geometry: 1 feet changed.",
        "Refused messages of contact_wrench: 2 wrong frame.",
    ]


def test_a_body_alone_has_no_such_table() -> None:
    alone = CARGO._replace(truths={"cube": BodyTruth(TRUTH, None)}, inputs={"odom": {Status.ACCEPTED: 5}})
    assert "body" not in printed(alone)


def shown(table: Table, width: int) -> str:
    text = io.StringIO()
    show(Console(file=text, width=width), table)
    return text.getvalue()


ROW = row_of("cube", SCORE, cost=98e-6)._replace(
    stamp=5_690_729_123_456,
    lead_time=0.0123,
    predicted_twist=Twist(-1.234, 0.571, -11.52),
    measured_twist=Twist(-1.199, 0.512, -10.25),
)
LARGE = ROW._replace(predicted_twist=Twist(-123456.789, 0.0, -1234567.89))
UNSCORED = ROW._replace(scored=False, flags=("OUT_OF_PLANE", "ONE_CORNER_FIRST"), cost=None)
UNMEASURED = ROW._replace(measured_twist=None, relative_error=None, scored=False, flags=("TOO_SHORT",))
NUMBERS = {"1.360", "0.571", "11.52", "1.304", "0.512", "10.25", "12.3", "98"}
"""Speeds, their upward parts and angular speeds among them."""
WHOLE = ROW._replace(
    predicted_twist_6d=(3.0, 4.0, 0.0, 0.0, 0.0, -2.0),
    measured_twist_6d=(0.0, 0.0, -0.75, 1.0, 2.0, 2.0),
    relative_error_6d=0.375,
    not_scored_6d=(),
    before_twist_6d=(1.0,) * 6,
    lift_old=(True, False, None),
)


@pytest.mark.parametrize("width", [40, 80, 100, 120])
def test_no_number_is_cut_off_at_any_width_and_from_80_columns_on_the_lines_fit(width: int) -> None:
    text = shown(touchdown_table([ROW, UNSCORED, UNMEASURED]), width)
    assert set(text.split()) >= {*NUMBERS, "5690.729", "12.3", "PIVOT_SLIDE"}
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= max(width, 80)
    assert set(shown(touchdown_table([LARGE]), width).split()) >= {"123456.789", "1234567.89"}


def test_the_lines_of_several_bodies_fit_too() -> None:
    rows = [ROW, UNSCORED._replace(body="container")]
    lines = shown(touchdown_table(rows), 80).splitlines()
    assert max(map(len, lines)) <= 80
    named = next(place for place, line in enumerate(lines) if "container" in line)
    assert lines[named + 1].split()[0] == "5690.729"


def test_times_of_day_are_counted_from_the_first_touchdown() -> None:
    first = ROW._replace(stamp=1_605_971_434_083_000_000)
    text = shown(touchdown_table([first, first._replace(stamp=first.stamp + 1_500_000_000)]), 120)
    assert "since" in text
    assert {"0.000", "1.500"} <= set(text.split())


def test_costs_notes_and_bodies_have_columns_only_where_they_are_known() -> None:
    assert "not scored: out of plane, one corner first" in shown(touchdown_table([UNSCORED]), 160)
    text = shown(touchdown_table([ROW._replace(cost=None, flags=())]), 120)
    assert not any(word in text for word in ("cost", "notes", "cube"))


def test_a_whole_twist_stands_with_its_lifts_before_the_error_in_the_plane() -> None:
    cells = [re.split(r"\s{2,}", line.strip()) for line in shown(touchdown_table([WHOLE]), 120).splitlines()[-2:]]
    assert cells[0][2:7] == ["edge>face", "5.000", "0.000", "2.00", "yes"]
    assert cells[1][1:6] == ["PIVOT_SLIDE", "0.750", "-0.750", "3.00", "no"]
    assert "37.5" in cells[0]
    assert "25.0" in cells[1]


def test_some_touchdowns_of_each_kind_are_listed_and_the_skill_of_all_is_told() -> None:
    corners = [WHOLE._replace(kind="flight>corner", stamp=k) for k in range(MOST_OF_A_KIND + 2)]
    assert of_each_kind([*corners, WHOLE, UNSCORED]) == [*corners[:MOST_OF_A_KIND], WHOLE]


def test_below_the_touchdowns_stands_when_they_are_measured_and_how_those_that_are_listed_were_chosen() -> None:
    settled = tuple(Settled("crate", SCORE._replace(stamp=k), None) for k in range(MOST_OF_A_KIND + 1))
    text = printed(CARGO._replace(settled=settled))
    assert "1 more touchdown: listed are the first of each kind that are scored; list them with --all" in text
    assert "as no sample shows it right after that" in text


def test_lead_times_without_predictions_have_no_error() -> None:
    errors = [SpanErrors(0.0, 0.01, Distribution(3, 0.0625, 0.125)), SpanErrors(0.01, 0.02, Distribution())]
    lines = [re.split(r"\s{2,}", line.strip()) for line in shown(lead_time_table(errors), 80).splitlines()]
    assert ["0 to 10", "3", "6.2", "12.5"] in lines
    assert ["10 to 20", "0", "-", "-"] in lines


TOUCHDOWN = LANDED.touchdown._replace(
    before=Twist(0.5, 0.0, 0.0), after=Twist(0.47, 0.04, 0.1), impulses=((1.0, 0.5), (3.0, -4.0)), flags=Flag.NONE
)
HISTORY = ((0.1, 0.004), (0.06, -0.0123), (0.05, 0.0034), (0.03, 0.002), (0.01, 0.001))


def landed(at: float, foot: str = "LF", body: str = "robot", **changes: object) -> Settled:
    """A landing at a time in s."""
    stamp = round(at * 1e9)
    landing = LANDING._replace(
        foot=foot, stamp=stamp, late=None, confirmed=None, history=HISTORY, speed=0.123, impact=TOUCHDOWN
    )._replace(**changes)  # type: ignore[arg-type]
    announced = landing.history[0][0] if landing.history else 0.0
    return Settled(body, LANDED._replace(stamp=stamp, announced=announced, touchdown=TOUCHDOWN, landing=landing), None)


KNOWN = {"late": -0.0123, "confirmed": False}
WALK = Result("walk.bag", 100, 0.1, (), {}, {}, (), "", "")


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("changes", [{}, KNOWN])
def test_the_table_of_landings_fits_the_terminal_and_no_number_is_cut_off(
    width: int, changes: dict[str, object]
) -> None:
    landings = rows_of([landed(12.5, **changes), landed(123.456, "RF")])
    text = shown(landings_table(landings), width)
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= width
    assert set(text.split()) >= {"123.456", "LF", "100", "+2.0", "0.123", "PIVOT_SLIDE", "5.00", "0.050"}
    assert ({"-12.3", "no"} <= set(text.split())) == bool(changes)


def test_what_rounds_to_nothing_has_no_sign_and_what_nobody_announced_has_no_time() -> None:
    still, missed = landed(1.0, history=((0.1, -1e-9),), speed=-1e-9), landed(2.0, history=())
    first, _, second, _ = shown(landings_table(rows_of([still, missed])), 80).splitlines()[-4:]
    assert first.split()[2:6] == ["100", "0.0", "0.000", "PIVOT_SLIDE"]
    assert second.split()[2:4] == ["-", "-"]


def test_a_landing_has_the_mode_of_the_impact_whose_impulse_stands_beside_it() -> None:
    """What is announced of a foot that brakes until it lands is another: no impact."""
    braked = landed(1.0)
    touchdown = braked.score.touchdown._replace(mode=Mode.NO_IMPACT)
    braked = braked._replace(score=braked.score._replace(touchdown=touchdown))
    (row,) = rows_of([braked])
    *_, line, _ = shown(landings_table([row]), 80).splitlines()
    assert line.split()[4:7] == ["0.123", "PIVOT_SLIDE", "5.00"]
    assert "NO_IMPACT" not in shown(landings_table([row, row._replace(landing_mode=None)]), 80)
    assert "A foot that brakes until it lands gives less" in printed(WALK._replace(settled=(braked,)))


def test_the_head_of_the_impulses_says_which_bound_they_are() -> None:
    (row,) = rows_of([landed(1.0)])
    for bound in (None, "upper bound", "estimate"):
        head = " ".join(shown(landings_table([row._replace(bound=bound)]), 100).split("LF")[0].split())
        assert [bound is not None and word in head for word in ("upper", "estimate")] == [
            bound == "upper bound",
            bound == "estimate",
        ]


def test_what_the_other_feet_get_stands_below_the_impulse_of_the_foot() -> None:
    """Of two feet that land together one may have braked: the impulse is at the other alone."""
    impact = TOUCHDOWN._replace(impulses=((3.0, 0.0), (0.0, 0.0)))
    alone = impact._replace(old=(), impulses=((0.0, 0.0), (4.0, 3.0)))
    *_, soft, others, hard = shown(
        landings_table(rows_of([landed(1.0, impact=impact), landed(2.0, "RF", impact=alone)])), 80
    ).splitlines()
    assert ("0.00" in soft, others.split(), "5.00" in hard) == (True, ["3.00"], True)


def test_feet_are_named_with_their_parts_and_with_their_bodies_where_there_are_several() -> None:
    text = shown(landings_table(rows_of([landed(1.0, point="heel"), landed(2.0, body="other")])), 120)
    assert {"robot", "LF", "heel", "other"} <= set(text.split())


def test_a_replay_lists_landings_apart_from_other_touchdowns() -> None:
    walked = [landed(0.1 * k, "LF" if k % 2 else "RF") for k in range(30)]
    text = printed(WALK._replace(settled=tuple(walked)))
    assert "10 more landings: list them with --all, or read them with --json." in text
    assert "30 landings of 2 feet" in text
    assert "scored" not in text  # driven feet tell no impact by itself
    assert "\n\n\n" not in text
    other = landed(2.0)._replace(score=landed(2.0).score._replace(landing=None))
    mixed = printed(WALK._replace(settled=(landed(1.0), other)))
    assert "1 landing of 1 foot" in mixed
    assert "0 of 1 touchdown scored." in mixed
    assert "No touchdown was predicted." in printed(WALK)
