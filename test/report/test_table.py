"""Tables: every number is whole, whatever the width of the terminal."""

from __future__ import annotations

import io
import re

import pytest
from rich.console import Console
from rich.table import Table

from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.report.replay import lead_time_table, touchdown_table
from impact_predictor.report.summary import Distribution, SpanErrors, TouchdownRow, TouchdownTally
from impact_predictor.report.table import show

ROW = TouchdownRow(
    body="cube",
    stamp=5_690_729_123_456,
    announced=0.058,
    lead_time=0.0123,
    mode=Mode.PIVOT_SLIDE,
    before=Twist(-1.3, -0.9, -15.0),
    predicted=Twist(-1.234, 0.571, -11.52),
    measured=Twist(-1.199, 0.512, -10.25),
    half_distance=0.05,
    relative_error=0.1234,
    out_of_plane=0.01,
    scored=True,
    flags=("REVERSED_SLIP",),
    cost=98e-6,
)
UNSCORED = ROW._replace(scored=False, flags=("OUT_OF_PLANE", "ONE_CORNER_FIRST"), cost=None)
UNMEASURED = ROW._replace(measured=None, relative_error=None, scored=False, flags=("TOO_SHORT",))
NUMBERS = {"-1.234", "0.571", "-11.52", "-1.199", "0.512", "-10.25", "12.3", "98"}


def printed(table: Table, width: int) -> str:
    text = io.StringIO()
    show(Console(file=text, width=width), table)
    return text.getvalue()


@pytest.mark.parametrize("width", [40, 80, 100, 120])
def test_no_number_is_cut_off_at_any_width_and_from_80_columns_on_the_lines_fit(width: int) -> None:
    text = printed(touchdown_table([ROW, UNSCORED, UNMEASURED], width), width)
    assert set(text.split()) >= {*NUMBERS, "5690.729", "12.3", "PIVOT_SLIDE"}
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= max(width, 80)


def test_the_lines_of_several_bodies_fit_too() -> None:
    rows = [ROW, UNSCORED._replace(body="container")]
    lines = printed(touchdown_table(rows, 80), 80).splitlines()
    assert max(map(len, lines)) <= 80
    named = next(place for place, line in enumerate(lines) if "container" in line)
    assert lines[named + 1].split()[0] == "5690.729"


def test_a_wide_terminal_has_predicted_beside_measured() -> None:
    (line,) = [line for line in printed(touchdown_table([ROW], 120), 120).splitlines() if "PIVOT_SLIDE" in line]
    assert set(line.split()) >= NUMBERS


def test_very_large_numbers_are_whole_too() -> None:
    row = ROW._replace(predicted=Twist(-123456.789, 0.0, -1234567.89))
    assert set(printed(touchdown_table([row], 80), 80).split()) >= {"-123456.789", "-1234567.89"}


def test_times_of_day_are_counted_from_the_first_touchdown() -> None:
    first = ROW._replace(stamp=1_605_971_434_083_000_000)
    text = printed(touchdown_table([first, first._replace(stamp=first.stamp + 1_500_000_000)], 120), 120)
    assert "since" in text
    assert {"0.000", "1.500"} <= set(text.split())


def test_why_a_touchdown_is_not_scored_stands_beside_it() -> None:
    text = printed(touchdown_table([UNSCORED], 160), 160)
    assert "not scored: out of plane, one corner first" in text


def test_without_costs_and_notes_and_of_one_body_there_are_no_columns_for_them() -> None:
    text = printed(touchdown_table([ROW._replace(cost=None, flags=())], 120), 120)
    assert not any(word in text for word in ("cost", "notes", "cube"))


def test_lead_times_without_predictions_have_no_error() -> None:
    errors = [SpanErrors(0.0, 0.01, Distribution(3, 0.0625, 0.125)), SpanErrors(0.01, 0.02, Distribution())]
    lines = [re.split(r"\s{2,}", line.strip()) for line in printed(lead_time_table(errors), 80).splitlines()]
    assert ["0 to 10", "3", "6.2", "12.5"] in lines
    assert ["10 to 20", "0", "-", "-"] in lines


SCORED = "A touchdown is scored where the samples after it show the velocities that the impact left; they do not"


def test_conclusions_count_the_scored_and_explain_the_others() -> None:
    assert TouchdownTally([ROW, UNSCORED, UNMEASURED]).sentences() == [
        "1 of 3 touchdowns scored: relative error 12.3 % in the median, 90 % below 12.3 %.",
        f"{SCORED} for 2, for one or several reasons each:",
        "  1 out of plane: the body also turned off the plane of the impact, or its contacts lay beside it",
        "  1 one corner first: one corner of the edge that struck came before the other",
        "  1 too short: the record ended, or paused, too soon after",
    ]
    assert TouchdownTally([]).sentences() == ["No touchdown was predicted."]
    assert TouchdownTally([UNMEASURED]).sentences()[0] == "0 of 1 touchdown scored."
    assert TouchdownTally([UNMEASURED]).sentences()[1] == f"{SCORED} for 1:"
    assert TouchdownTally([ROW]).sentences() == [
        "1 of 1 touchdown scored: relative error 12.3 % in the median, 90 % below 12.3 %."
    ]
