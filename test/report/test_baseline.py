"""Two runs of one bag: the earlier one is read from its JSON, and only what has changed is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import touchdowns
from hypothesis import given
from hypothesis import strategies as st

from impact_predictor.bags.replay import Result, Settled
from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.prediction.types import Score
from impact_predictor.report.answers import as_json
from impact_predictor.report.baseline import (
    ChangeKind,
    Earlier,
    RunComparison,
    compare_runs,
    concluded,
    sentences,
)
from impact_predictor.report.touchdowns import TouchdownRow, row_of

MS = 1_000_000
STOP = row_of("crate", touchdowns.SCORE)._replace(
    stamp=1000 * MS,
    mode=Mode.STOP,
    before_twist=Twist(1.0, 0.0, -2.0),
    predicted_twist=Twist(0.5, 0.0, -1.0),
    half_distance=0.5,
    relative_error=0.1,
)
LATER = STOP._replace(stamp=2000 * MS, old=(2, 3), new=(0, 1), mode=Mode.SLIDE, relative_error=0.05)
LANDED = STOP._replace(body="robot", foot="LF", scored=False, relative_error=None, time_error=0.002)


def kinds(was: list[TouchdownRow], now: list[TouchdownRow]) -> list[ChangeKind]:
    return [change.kind for change in compare_runs(was, now).changes]


RUNS = st.lists(
    st.builds(
        STOP._replace,
        body=st.sampled_from(["crate", "drum"]),
        # Often one stamp, or many within the time in which touchdowns may be the same.
        stamp=st.integers(0, 20).map(lambda k: k * 5 * MS),
        old=st.sampled_from([(0, 1), (2, 3)]),
        mode=st.sampled_from([Mode.STOP, Mode.SLIDE]),
        relative_error=st.floats(0.0, 2.0),
    ),
    max_size=12,
)


@given(RUNS)
def test_whatever_run_against_itself_has_not_changed(run: list[TouchdownRow]) -> None:
    assert compare_runs(run, run) == RunComparison((), len(run), len(run), len(run))


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
        ({"new": (4, 5)}, ChangeKind.CONTACTS, "0 1 then 2 3", "0 1 then 4 5"),
        ({"old": (), "new": (4,)}, ChangeKind.CONTACTS, "0 1 then 2 3", "none then 4"),
        # 0.04 rad/s at half a metre, against hypot(1, 2 * 0.5) m/s before it: 1.4 %.
        ({"predicted_twist": Twist(0.5, 0.0, -1.04)}, ChangeKind.VELOCITIES, (0.5, 0.0, -1.0), (0.5, 0.0, -1.04)),
    ],
)
def test_a_change_is_told_with_what_was_and_what_is(
    changes: dict[str, Any], kind: ChangeKind, was: Any, now: Any
) -> None:
    compared = compare_runs([STOP, LATER], [STOP._replace(**changes), LATER])
    assert [change[1:] for change in compared.changes] == [(kind, was, now)]
    assert (compared.were, compared.are, compared.alike) == (2, 2, 1)


@pytest.mark.parametrize(
    "changes",
    [{"stamp": 1001 * MS}, {"relative_error": 0.109}, {"predicted_twist": Twist(0.5, 0.0, -1.02)}],
    ids=["1 ms", "0.9 %", "velocities by 0.7 %"],
)
def test_what_stays_within_the_limits_has_not_changed(changes: dict[str, Any]) -> None:
    changed = STOP._replace(**changes)
    assert compare_runs([STOP], [changed]).changes == ()


def test_touchdowns_come_and_go() -> None:
    assert kinds([STOP], [STOP, LATER]) == [ChangeKind.APPEARED]
    assert kinds([STOP, LATER], [LATER]) == [ChangeKind.VANISHED]
    # Farther apart than any two announcements of one touchdown.
    assert kinds([STOP], [STOP._replace(stamp=1021 * MS)]) == [ChangeKind.VANISHED, ChangeKind.APPEARED]
    assert kinds([STOP], [STOP._replace(body="drum")]) == [ChangeKind.VANISHED, ChangeKind.APPEARED]
    assert kinds([LANDED], [LANDED._replace(foot="RF")]) == [ChangeKind.VANISHED, ChangeKind.APPEARED]


def test_touchdowns_close_together_are_told_apart_by_their_contacts() -> None:
    first, second = STOP, STOP._replace(stamp=1006 * MS, old=(2, 3), new=(4, 5), mode=Mode.SLIDE)
    # Each has moved by 4 ms, so that the other one is nearer.
    later = [one._replace(stamp=one.stamp + 4 * MS) for one in (first, second)]
    assert kinds([first, second], later) == [ChangeKind.MOVED, ChangeKind.MOVED]


def test_of_a_landing_the_error_of_its_time_counts_whatever_its_sign() -> None:
    assert kinds([LANDED], [LANDED._replace(time_error=-0.002)]) == []
    assert kinds([LANDED], [LANDED._replace(time_error=-0.004)]) == [ChangeKind.WORSE]
    assert kinds([LANDED], [LANDED._replace(time_error=0.0)]) == [ChangeKind.BETTER]


LATER_STOPS = [STOP._replace(stamp=k * 1000 * MS) for k in (3, 4, 6)]
WAS = [STOP, LATER, *LATER_STOPS, LANDED._replace(stamp=5000 * MS)]
NOW = [
    STOP._replace(mode=Mode.SLIDE, relative_error=0.345),
    LATER._replace(stamp=2004 * MS),
    LATER_STOPS[0]._replace(predicted_twist=Twist(-10.5, -10.25, -12.25)),
    LATER_STOPS[2]._replace(old=(0, 1, 2, 3), new=(4, 5, 6, 7)),
    LANDED._replace(stamp=5000 * MS, time_error=-0.012),
    STOP._replace(stamp=7000 * MS),
]


def test_each_change_is_said_with_what_was_and_what_is() -> None:
    compared = compare_runs(WAS, NOW)
    assert sentences(compared) == [
        "1.000 s crate: other mode, was STOP, now SLIDE",
        "1.000 s crate: worse, was 10.0 %, now 34.5 %",
        "2.004 s crate: moved, was 2.0000, now 2.0040",
        "3.000 s crate: other vx, vy, omega, was 0.500 0.000 -1.00, now -10.500 -10.250 -12.25",
        "4.000 s crate: vanished, was STOP, now -",
        "5.000 s robot LF: worse, was +2.0 ms, now -12.0 ms",
        "6.000 s crate: other contacts, was 0 1 then 2 3, now 0 1 2 3 then 4 5 6 7",
        "7.000 s crate: appeared, was -, now STOP",
    ]
    kinds = "2 worse, 1 other mode, 1 moved, 1 other vx, vy, omega, 1 vanished, 1 other contacts, 1 appeared"
    assert concluded(compared, "old.mcap") == f"Against old.mcap 0 of 6 touchdowns are as they were: {kinds}."
    assert concluded(compare_runs(WAS, WAS), "a") == "Nothing has changed against a: 6 touchdowns."


def test_times_of_day_are_counted_from_the_first_touchdown() -> None:
    day = 1_700_000_000_000 * MS
    was = [one._replace(stamp=one.stamp + day) for one in (STOP, LATER)]
    compared = compare_runs(was, [was[0], was[1]._replace(stamp=was[1].stamp + 4 * MS)])
    assert sentences(compared) == ["1.004 s crate: moved, was 1.0000, now 1.0040"]


TOUCHDOWN = touchdowns.TOUCHDOWN._replace(after=Twist(0.1 + 0.2, 0.25, -3.0), old=())
SCORED = touchdowns.SCORE._replace(touchdown=TOUCHDOWN)
UNSCORED = touchdowns.UNSCORED._replace(stamp=2_000_000_000)
STOOD = touchdowns.LANDED._replace(stamp=4_000_000_000, landing=touchdowns.LANDING._replace(impact=None))
SCORES = (SCORED, UNSCORED, touchdowns.UNMEASURED._replace(stamp=3_000_000_000), STOOD)


def run(body: str, scores: tuple[Score, ...] = SCORES) -> dict[str, Any]:
    settled = tuple(Settled(body, score, None) for score in scores)
    return as_json(Result("run.mcap", 4, 0.001, settled, {}, {}, (), "", ""))


def write_json(path: Path, answer: Any) -> Path:
    path.write_text(json.dumps(answer))
    return path


def test_the_json_of_a_run_tells_its_touchdowns_to_the_last_bit(tmp_path: Path) -> None:
    told = list(Earlier(write_json(tmp_path / "run.json", run("cube"))).touchdowns_of("run.mcap"))
    assert told == [row_of("cube", score)._replace(time_errors=(), simple_time_error=None) for score in SCORES]
    assert not Earlier(write_json(tmp_path / "none.json", run("cube", ()))).touchdowns_of("run.mcap")


@pytest.mark.parametrize(
    ("bag", "name", "runs", "chosen"),
    [
        ("bags/run.mcap", "run", ["bags/run.mcap", "old/run.mcap"], 0),
        ("/new/run.mcap", "run", ["/old/other.mcap", "/old/run.mcap"], 1),
        ("/new/tuesday/run.mcap", "tuesday/run", ["monday/run.mcap", "tuesday/run.mcap"], 1),
        ("/new/wednesday/run.mcap", "wednesday/run", ["monday/run.mcap", "tuesday/run.mcap"], None),
        # Another bag of today is called run as well, and the earlier run may be of that one.
        ("/new/tuesday/run.mcap", "tuesday/run", ["monday/run.mcap"], None),
        ("/new/run.db3", "run.db3", ["/old/run.mcap", "/old/run.db3"], 1),
        ("run.mcap", "run", [], None),
    ],
)
def test_of_several_bags_the_run_of_this_one_is_chosen(
    tmp_path: Path, bag: str, name: str, runs: list[str], chosen: int | None
) -> None:
    told = [run("cube", SCORES[: k + 1]) | {"bag": path} for k, path in enumerate(runs)]
    earlier = Earlier(write_json(tmp_path / "runs.json", told), 2)
    if chosen is None:
        with pytest.raises(InputError, match=f"has no run of {bag}; replay that bag with --json again"):
            earlier.touchdowns_of(bag, name)
    else:
        assert len(earlier.touchdowns_of(bag, name)) == chosen + 1


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("not json", "cannot be read as the JSON of a replay"),
        ("3", "cannot be read as the JSON of a replay"),
        ("[1, 2]", "cannot be read as the JSON of a replay"),
        ('{"touchdowns": [{"stamp": 1}]}', "cannot be read as the JSON of a replay"),
        ("[]", "has no run of bags/run.mcap"),
        ('[{"bag": "bags/run.mcap", "error": "damaged"}]', "has no run of bags/run.mcap"),
    ],
)
def test_json_that_is_no_run_of_the_bag_is_refused_in_one_sentence(tmp_path: Path, content: str, said: str) -> None:
    path = tmp_path / "old.json"
    path.write_text(content)
    with pytest.raises(InputError, match=said) as caught:
        Earlier(path).touchdowns_of("bags/run.mcap")
    assert "\n" not in str(caught.value)


def test_what_is_not_there_or_of_one_bag_only_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.json cannot be read as the JSON of a replay"):
        Earlier(tmp_path / "none.json")
    with pytest.raises(InputError, match="is the run of one bag, but 2 bags are given"):
        Earlier(write_json(tmp_path / "one.json", run("cube")), 2)
