"""Two runs of one bag compared: only what has changed is told, and it is told rightly."""

from __future__ import annotations

import io
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.report.baseline import (
    ChangeKind,
    ChangeLimits,
    RunComparison,
    compare_runs,
    comparison_as_json,
    concluded,
    print_changes,
    sentences,
)
from impact_predictor.report.summary import TouchdownRow

MS = 1_000_000
STOP = TouchdownRow(
    body="crate",
    stamp=1000 * MS,
    announced=0.05,
    lead_time=0.01,
    mode=Mode.STOP,
    before=Twist(1.0, 0.0, -2.0),
    predicted=Twist(0.5, 0.0, -1.0),
    measured=None,
    half_distance=0.5,
    relative_error=0.1,
    out_of_plane=0.0,
    scored=True,
    flags=(),
    contacts=((0, 1), (2, 3)),
)
LATER = STOP._replace(stamp=2000 * MS, contacts=((2, 3), (0, 1)), mode=Mode.SLIDE, relative_error=0.05)
LANDED = STOP._replace(body="robot", foot="LF", scored=False, relative_error=None, time_error=0.002)


def kinds(was: list[TouchdownRow], now: list[TouchdownRow]) -> list[ChangeKind]:
    return [change.kind for change in compare_runs(was, now).changes]


RUNS = st.lists(
    st.builds(
        STOP._replace,
        body=st.sampled_from(["crate", "drum"]),
        # Often one stamp, or many within the time in which touchdowns may be the same.
        stamp=st.integers(0, 20).map(lambda k: k * 5 * MS),
        contacts=st.sampled_from([((0, 1), (2, 3)), ((2, 3), (4, 5)), None]),
        mode=st.sampled_from([Mode.STOP, Mode.SLIDE]),
        relative_error=st.floats(0.0, 2.0),
    ),
    max_size=12,
)


@given(RUNS)
def test_whatever_run_against_itself_has_not_changed(run: list[TouchdownRow]) -> None:
    assert compare_runs(run, run, ChangeLimits(0.0, 0.0)) == RunComparison((), len(run), len(run), len(run))


@given(RUNS, RUNS)
def test_two_runs_the_other_way_round_have_changed_too(was: list[TouchdownRow], now: list[TouchdownRow]) -> None:
    there, back = compare_runs(was, now), compare_runs(now, was)
    assert bool(there.changes) == bool(back.changes)
    assert there.were - len([one for one in there.changes if one.kind is ChangeKind.VANISHED]) == (
        there.are - len([one for one in there.changes if one.kind is ChangeKind.APPEARED])
    )


@pytest.mark.parametrize(
    ("changes", "kind", "was", "now"),
    [
        ({"mode": Mode.SLIDE}, ChangeKind.MODE, "STOP", "SLIDE"),
        ({"stamp": 1002 * MS}, ChangeKind.MOVED, 1000 * MS, 1002 * MS),
        ({"relative_error": 0.2}, ChangeKind.WORSE, 0.1, 0.2),
        ({"relative_error": 0.02}, ChangeKind.BETTER, 0.1, 0.02),
        ({"scored": False, "relative_error": None}, ChangeKind.SCORED, "scored", "not scored"),
        ({"contacts": ((0, 1), (4, 5))}, ChangeKind.CONTACTS, "0 1 then 2 3", "0 1 then 4 5"),
        ({"contacts": ((), (4,))}, ChangeKind.CONTACTS, "0 1 then 2 3", "none then 4"),
        # 0.04 rad/s at half a metre, against hypot(1, 2 * 0.5) m/s before it: 1.4 %.
        ({"predicted": Twist(0.5, 0.0, -1.04)}, ChangeKind.VELOCITIES, (0.5, 0.0, -1.0), (0.5, 0.0, -1.04)),
    ],
)
def test_a_change_is_told_with_what_was_and_what_is(
    changes: dict[str, Any], kind: ChangeKind, was: Any, now: Any
) -> None:
    compared = compare_runs([STOP, LATER], [STOP._replace(**changes), LATER])
    assert [change[3:] for change in compared.changes] == [(kind, was, now)]
    assert (compared.were, compared.are, compared.alike) == (2, 2, 1)


@pytest.mark.parametrize(
    "changes",
    [{"stamp": 1001 * MS}, {"relative_error": 0.109}, {"predicted": Twist(0.5, 0.0, -1.02)}],
    ids=["1 ms", "0.9 %", "velocities by 0.7 %"],
)
def test_what_stays_within_the_limits_has_not_changed(changes: dict[str, Any]) -> None:
    changed = STOP._replace(**changes)
    assert compare_runs([STOP], [changed]).changes == ()
    assert len(compare_runs([STOP], [changed], ChangeLimits(0.0, 0.0)).changes) == 1


def test_touchdowns_come_and_go() -> None:
    assert kinds([STOP], [STOP, LATER]) == [ChangeKind.APPEARED]
    assert kinds([STOP, LATER], [LATER]) == [ChangeKind.VANISHED]
    # Farther apart than any two announcements of one touchdown.
    assert kinds([STOP], [STOP._replace(stamp=1021 * MS)]) == [ChangeKind.VANISHED, ChangeKind.APPEARED]
    assert kinds([STOP], [STOP._replace(body="drum")]) == [ChangeKind.VANISHED, ChangeKind.APPEARED]
    assert kinds([LANDED], [LANDED._replace(foot="RF")]) == [ChangeKind.VANISHED, ChangeKind.APPEARED]


def test_touchdowns_close_together_are_told_apart_by_their_contacts() -> None:
    first, second = STOP, STOP._replace(stamp=1006 * MS, contacts=((2, 3), (4, 5)), mode=Mode.SLIDE)
    # Each has moved by 4 ms, so that the other one is nearer.
    later = [one._replace(stamp=one.stamp + 4 * MS) for one in (first, second)]
    assert kinds([first, second], later) == [ChangeKind.MOVED, ChangeKind.MOVED]
    # A run from before contacts were told has times alone.
    untold = [one._replace(contacts=None) for one in (first, second)]
    assert kinds(untold, [first, second]) == []


def test_of_a_landing_the_error_of_its_time_counts_whatever_its_sign() -> None:
    assert kinds([LANDED], [LANDED._replace(time_error=-0.002)]) == []
    assert kinds([LANDED], [LANDED._replace(time_error=-0.004)]) == [ChangeKind.WORSE]
    assert kinds([LANDED], [LANDED._replace(time_error=0.0)]) == [ChangeKind.BETTER]


def printed(compared: RunComparison, every: bool = False) -> str:
    text = io.StringIO()
    print_changes(Console(file=text, width=80), compared, "old.mcap", every)
    return text.getvalue()


MANY = [
    STOP,
    LATER,
    STOP._replace(stamp=3000 * MS),
    STOP._replace(stamp=4000 * MS),
    LANDED._replace(stamp=5000 * MS),
    STOP._replace(stamp=6000 * MS),
]
CHANGED = [
    STOP._replace(mode=Mode.SLIDE, relative_error=0.345),
    LATER._replace(stamp=2004 * MS),
    STOP._replace(stamp=3000 * MS, predicted=Twist(-10.5, -10.25, -12.25)),
    LANDED._replace(stamp=5000 * MS, time_error=-0.012),
    STOP._replace(stamp=6000 * MS, contacts=((0, 1, 2, 3), (4, 5, 6, 7))),
    STOP._replace(stamp=7000 * MS),
]


def test_the_table_says_what_was_and_what_is_in_80_columns() -> None:
    text = printed(compare_runs(MANY, CHANGED))
    assert max(map(len, text.splitlines()[:-1])) <= 80
    lines = [line.split() for line in text.splitlines()]
    assert ["1.000", "crate", "other", "mode", "STOP", "SLIDE"] in lines
    assert ["1.000", "crate", "worse", "10.0", "%", "34.5", "%"] in lines
    assert ["2.004", "crate", "moved", "2.000", "2.004", "(+4.0", "ms)"] in lines
    changed = [
        "3.000",
        "crate",
        "other",
        "vx,",
        "vy,",
        "omega",
        "0.500",
        "0.000",
        "-1.00",
        "-10.500",
        "-10.250",
        "-12.25",
    ]
    assert changed in lines
    assert ["4.000", "crate", "vanished", "STOP", "-"] in lines
    assert ["5.000", "robot", "LF", "worse", "+2.0", "ms", "-12.0", "ms"] in lines
    assert ["7.000", "crate", "appeared", "-", "STOP"] in lines
    assert text.splitlines()[-1] == (
        "Against old.mcap 0 of 6 touchdowns are as they were: 2 worse, 1 other mode, 1 moved, 1 other vx, vy, omega, "
        "1 vanished, 1 other contacts, 1 appeared."
    )


def test_only_the_first_of_many_changes_are_listed_unless_all_are_asked_for() -> None:
    many = [STOP._replace(stamp=k * 100 * MS) for k in range(30)]
    compared = compare_runs(many, [])
    assert printed(compared).count("vanished") == 20 + 1
    assert "10 more changes: list them with --all" in printed(compared)
    assert printed(compared, every=True).count("vanished") == 30 + 1


def test_times_of_day_are_counted_from_the_first_touchdown() -> None:
    day = 1_700_000_000_000 * MS
    was = [one._replace(stamp=one.stamp + day) for one in (STOP, LATER)]
    compared = compare_runs(was, [was[0], was[1]._replace(stamp=was[1].stamp + 4 * MS)])
    assert sentences(compared) == ["1.004 s crate: moved, was 1.000, now 1.004 (+4.0 ms)"]


def test_the_json_has_every_change_in_plain_units() -> None:
    answer = json.loads(json.dumps(comparison_as_json(compare_runs(MANY, CHANGED), "old.mcap"), allow_nan=False))
    assert (answer["file"], answer["touchdowns_before"], answer["touchdowns"], answer["unchanged"]) == (
        "old.mcap",
        6,
        6,
        0,
    )
    assert answer["changes"][0] == {
        "stamp": 1000 * MS,
        "body": "crate",
        "foot": None,
        "change": "mode",
        "was": "STOP",
        "now": "SLIDE",
    }
    landing = next(one for one in answer["changes"] if one["foot"] == "LF")
    assert (landing["change"], landing["was"], landing["now"]) == ("worse", 0.002, -0.012)
    assert concluded(compare_runs(MANY, MANY), "a").startswith("Nothing has changed")
