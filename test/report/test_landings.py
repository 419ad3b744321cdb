"""Landings of feet as a person reads them: whole at any width, and in words."""

from __future__ import annotations

import io

import pytest
import touchdowns
from rich.console import Console
from rich.table import Table

from impact_predictor.bags.replay import Result, Settled
from impact_predictor.mechanics.types import Flag, Mode, Twist
from impact_predictor.prediction.types import Landing, Leftover, Score
from impact_predictor.report.landings import (
    LandingRow,
    LandingTally,
    error_ahead,
    feet_table,
    landings_of,
    landings_table,
)
from impact_predictor.report.replay import print_replay
from impact_predictor.report.replay_json import landing_as_json
from impact_predictor.report.table import show

TOUCHDOWN = touchdowns.TOUCHDOWN._replace(
    before=Twist(0.5, 0.0, 0.0),
    after=Twist(0.47, 0.04, 0.1),
    impulses=((1.0, 0.5), (3.0, -4.0)),
    flags=Flag.NONE,
    old=(1,),
    new=(0,),
    leftover=Leftover.DRIVEN,
)
HISTORY = ((0.1, 0.004), (0.06, -0.0123), (0.05, 0.0034), (0.03, 0.002), (0.01, 0.001))


def landed(at: float, foot: str = "LF", body: str = "robot", **changes: object) -> Settled:
    """A landing at a time in s."""
    stamp = round(at * 1e9)
    landing = Landing(foot, stamp, None, None, HISTORY, 0.123, TOUCHDOWN)._replace(**changes)  # type: ignore[arg-type]
    return Settled(body, Score(stamp, TOUCHDOWN, None, None, False, Leftover.DRIVEN, (), landing), None)


KNOWN = {"late": -0.0123, "confirmed": False}


def printed(table: Table, width: int) -> str:
    text = io.StringIO()
    show(Console(file=text, width=width), table)
    return text.getvalue()


def landing_sentences(landings: list[LandingRow]) -> list[str]:
    tally = LandingTally()
    for one in landings:
        tally.add(one)
    return tally.sentences()


def replayed(settled: list[Settled], width: int = 80) -> str:
    text = io.StringIO()
    result = Result("walk.bag", 100, 0.1, tuple(settled), {}, {}, (), "", "")
    print_replay(Console(file=text, width=width), result)
    return text.getvalue()


def test_the_error_of_time_is_that_of_the_last_prediction_made_so_long_ahead() -> None:
    landing = landed(1.0).score.landing
    assert landing is not None
    assert [error_ahead(landing, ahead) for ahead in (0.2, 0.1, 0.05, 0.02, 0.0)] == [None, 0.004, 0.0034, 0.002, 0.001]


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("changes", [{}, KNOWN])
def test_the_tables_fit_the_terminal_and_no_number_is_cut_off(width: int, changes: dict[str, object]) -> None:
    landings = landings_of([landed(12.5, **changes), landed(123.456, "RF")])
    text = printed(landings_table(landings, width), width)
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= width
    assert set(text.split()) >= {"123.456", "LF", "100", "+2.0", "+3.4", "0.123", "PIVOT_SLIDE", "5.00", "0.050"}
    assert ({"-12.3", "no"} <= set(text.split())) == bool(changes)
    text = printed(feet_table(landings), width)
    assert max(map(len, text.splitlines())) <= width


def test_the_table_of_feet_has_the_worst_of_impacts_and_the_middle_of_times() -> None:
    first, second = landed(1.0), landed(2.0, history=((0.07, -0.001),), speed=0.5, **KNOWN)
    lines = printed(feet_table(landings_of([second, first, landed(1.5, "RH")])), 80).splitlines()
    (left,) = [line.split() for line in lines if line.startswith("LF")]
    assert left == [
        "LF",
        "2",
        "70",
        "1.5",
        "2.2",
        "0.500",
        "5.00",
        "0.050",
        "-12.3",
        "0/1",
    ]
    (together,) = [line.split() for line in lines if line.startswith("all")]
    assert together[:3] == ["all", "3", "70"]


def test_what_rounds_to_nothing_has_no_sign() -> None:
    (line,) = [
        line
        for line in printed(
            landings_table(landings_of([landed(1.0, history=((0.1, -1e-9),), speed=-1e-9)]), 120), 120
        ).splitlines()
        if "LF" in line
    ]
    assert "-0" not in line
    assert line.split()[3:6] == ["0.0", "0.0", "PIVOT_SLIDE"]
    assert line.split()[6] == "0.000"


@pytest.mark.parametrize("width", [80, 120])
def test_what_the_other_feet_get_stands_beside_the_impulse_of_the_foot(width: int) -> None:
    """Of two feet that land together one may have braked: the impulse is at the other alone."""
    impact = TOUCHDOWN._replace(impulses=((3.0, 0.0), (0.0, 0.0)))
    soft, alone = (
        landed(1.0, impact=impact),
        landed(2.0, "RF", impact=impact._replace(old=(), impulses=((0, 0), (4, 3)))),
    )
    lines = printed(landings_table(landings_of([soft, alone]), width), width).splitlines()
    first, second = (next(k for k, line in enumerate(lines) if foot in line) for foot in ("LF", "RF"))
    told = " ".join(lines[first:second]).split()
    assert told.count("0.00") == told.count("3.00") == 1
    assert {"5.00", "-"} <= set(" ".join(lines[second:]).split())
    assert soft.score.landing is not None
    assert alone.score.landing is not None
    assert landing_as_json(soft.score.landing)["others_impulse"] == (3.0, 0.0)
    assert landing_as_json(alone.score.landing)["others_impulse"] is None


def test_feet_are_named_with_their_bodies_where_there_are_several() -> None:
    landings = landings_of([landed(1.0), landed(2.0, body="other")])
    for table in (landings_table(landings, 120), feet_table(landings)):
        assert {"robot/LF", "other/LF"} <= set(printed(table, 120).split())


def test_what_landings_say_together() -> None:
    one = landings_of([landed(1.0)])
    assert landing_sentences(one)[0].startswith("1 landing of 1 foot, each predicted 100 ms ahead or earlier; ")
    assert landing_sentences(one)[1] == "Predicted modes: 1 PIVOT_SLIDE."
    assert landing_sentences(one)[2] == (
        "Speeds are those of the last sample in the air, 0.123 m/s in the median, at most 0.123 m/s; impulses are "
        "those of an impact with that speed, as if the foot braked no more: at most 5.00 N s. By that and by what the "
        "others get, which stand or land together with it, the body's velocity changes by at most 0.050 m/s."
    )
    weak = TOUCHDOWN._replace(impulses=((0.0, 0.0), (0.0, 0.0)), after=TOUCHDOWN.before)
    largest = landing_sentences(landings_of([landed(1.0), landed(2.0, impact=weak, speed=0.023)]))[2]
    assert all(told in largest for told in ("0.073 m/s in", "most 0.123 m/s", "most 5.00 N s", "most 0.050 m/s"))
    several = [landed(1.0, **KNOWN), landed(2.0, "RF", late=0.02), landed(3.0)]
    assert landing_sentences(landings_of(several))[-1] == (
        "Against the plan 2 landings came +3.9 ms late in the median, from -12.3 to +20.0 ms."
    )
    assert landing_sentences([]) == []
    soft = [one._replace(mode=Mode.NO_IMPACT, speed=None) for one in one + one]
    assert landing_sentences(soft)[1:] == [
        "Predicted modes: 2 NO_IMPACT: every foot brakes to rest as it reaches the ground."
    ]


def test_a_replay_lists_landings_apart_from_other_touchdowns() -> None:
    text = replayed([landed(0.1 * k, "LF" if k % 2 else "RF") for k in range(30)])
    assert "10 more landings: list them with --all, or read them with --json." in text
    assert "30 landings of 2 feet" in text
    assert "scored" not in text  # driven feet tell no impact by itself
    assert "\n\n\n" not in text
    mixed = replayed([landed(1.0), landed(2.0)._replace(score=landed(2.0).score._replace(landing=None))])
    assert "1 landing of 1 foot" in mixed
    assert "0 of 1 touchdown scored." in mixed
    assert "No touchdown was predicted." in replayed([])


def test_landings_that_nobody_announced_are_said_and_never_silent() -> None:
    missed = landed(1.0, history=())
    table = printed(landings_table(landings_of([missed]), 120), 120)
    assert table.split()[table.split().index("LF") + 1] == "-"
    assert "1 landing of 1 foot, none of them predicted" in landing_sentences(landings_of([missed]))[0]
    said = landing_sentences(landings_of([missed, landed(2.0), landed(3.0, "RF")]))
    assert said[0].startswith("3 landings of 2 feet, 2 of them predicted 100 ms ahead or earlier")
    assert said[1].startswith("1 landing was not predicted")


def test_the_parts_of_a_foot_are_named_and_a_second_contact_hides_no_lead_time_of_the_first() -> None:
    heel = landed(1.0, point="heel")
    heel = heel._replace(score=heel.score._replace(touchdown=TOUCHDOWN._replace(old=(2,), new=(0,))))
    toe = landed(1.04, point="toe", history=((0.02, 0.001),))
    toe = toe._replace(score=toe.score._replace(touchdown=TOUCHDOWN._replace(old=(0,), new=(1,))))
    landings = landings_of([heel, toe])
    assert [one.foot for one in landings] == ["LF heel", "LF toe"]
    assert "LF heel" in printed(feet_table(landings), 120)
    said = landing_sentences(landings)[0]
    assert said.startswith(
        "1 landing of 1 foot, each predicted 100 ms ahead or earlier, besides 1 second contact of feet that stood "
        "already; "
    )
    assert landing_as_json(toe.score.landing)["point"] == "toe"  # type: ignore[arg-type]
