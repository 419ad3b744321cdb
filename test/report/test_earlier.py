"""An earlier run is read from the bag it wrote and from its JSON alike; what is none is refused in one sentence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import touchdowns
from touchdowns import SAMPLE

from impact_predictor.bags.body import BodyRecord
from impact_predictor.bags.replay import Result, Settled
from impact_predictor.bags.write import BagWriter
from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Twist
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Landing, Leftover, Prediction, Score, Status
from impact_predictor.report.earlier import Earlier
from impact_predictor.report.replay_json import as_json
from impact_predictor.report.summary import row_of
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY

TOUCHDOWN = touchdowns.TOUCHDOWN._replace(after=Twist(0.1 + 0.2, 0.25, -3.0), old=())
SCORED = Score(1_004_000_000, TOUCHDOWN, Twist(0.5, 0.125, -2.0), 0.25, True, Leftover.NONE, ((0.004, 0.25),))
UNSCORED = SCORED._replace(stamp=2_000_000_000, scored=False, leftover=Leftover.OUT_OF_PLANE)
UNMEASURED = SCORED._replace(stamp=3_000_000_000, measured=None, relative_error=None, scored=False, history=())
LANDED = UNMEASURED._replace(
    stamp=4_000_000_000,
    leftover=Leftover.DRIVEN,
    landing=Landing("LF", 4_000_000_000, None, None, ((0.02, 0.001),), 0.2),
)
SCORES = (SCORED, UNSCORED, UNMEASURED, LANDED)


def run(body: str, scores: tuple[Score, ...] = SCORES) -> dict[str, Any]:
    settled = tuple(Settled(body, score, None) for score in scores)
    return as_json(Result("run.mcap", 4, 0.001, settled, {}, {}, (), "", ""))


def write_run(path: Path, body: str = "", scores: tuple[Score, ...] = SCORES, namespace: str = "") -> Path:
    with BagWriter(path) as writer:

        def write(topic: str, type_name: str, log_time: int, data: bytes) -> None:
            writer.write(namespace + topic, type_name, log_time, data)

        record = BodyRecord(body, Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5), write)
        record.answered(Prediction(Status.ACCEPTED, SAMPLE), 1, 0.0)
        for score in scores:
            record.answered(Prediction(Status.ACCEPTED, SAMPLE, None, score), 1, 0.0)
    return path


@pytest.fixture
def json_of(tmp_path: Path) -> Any:
    def write(answer: Any) -> Path:
        path = tmp_path / "run.json"
        path.write_text(json.dumps(answer))
        return path

    return write


def test_bag_and_json_of_a_run_tell_the_same_to_the_last_bit(tmp_path: Path, json_of: Any) -> None:
    for body, name in (("", "cube"), ("crate", "crate")):
        told = Earlier(json_of(run(name))).touchdowns_of("run.mcap")
        assert told == Earlier(write_run(tmp_path / f"{name}.mcap", body)).touchdowns_of("run.mcap")
        assert told == tuple(row_of(name, score) for score in SCORES)
        assert [one.error for one in told] == [0.25, None, None, None]


def test_a_bag_of_several_is_not_taken_for_another_of_its_name(json_of: Any) -> None:
    """The names are those of `names_of`: where two bags of a name are replayed, each has a part of its path."""
    other = run("cube", SCORES[:1])
    one = Earlier(json_of([run("cube") | {"bag": "monday/run.mcap"}, other | {"bag": "other.mcap"}]))
    assert len(one.touchdowns_of("/new/monday/run.mcap", "monday/run")) == len(SCORES)
    with pytest.raises(InputError, match=r"has no run of tuesday/run\.mcap"):
        one.touchdowns_of("tuesday/run.mcap", "tuesday/run")
    # One of them alone has the short name, and needs a longer one only where the earlier run had several.
    assert len(one.touchdowns_of("tuesday/run.mcap", "run")) == len(SCORES)
    both = Earlier(json_of([run("cube") | {"bag": "monday/run.mcap"}, other | {"bag": "tuesday/run.mcap"}]))
    assert len(both.touchdowns_of("/new/tuesday/run.mcap", "run")) == 1
    with pytest.raises(InputError, match="has no run of"):
        both.touchdowns_of("wednesday/run.mcap", "run")
    twins = Earlier(json_of([run("cube") | {"bag": "/old/run.mcap"}, other | {"bag": "/old/run.db3"}]))
    assert len(twins.touchdowns_of("/new/run.db3", "run.db3")) == 1


def test_a_recording_of_a_node_in_a_namespace_is_a_run(tmp_path: Path, json_of: Any) -> None:
    for body, name in (("", "cube"), ("crate", "crate")):
        recorded = write_run(tmp_path / f"{name}.mcap", body, namespace="/robot")
        assert Earlier(recorded).touchdowns_of("run.mcap") == Earlier(json_of(run(name))).touchdowns_of("run.mcap")


def test_a_run_without_a_touchdown_is_a_run(tmp_path: Path) -> None:
    assert Earlier(write_run(tmp_path / "none.mcap", scores=())).touchdowns_of("run.mcap") == ()


def test_a_run_from_before_contacts_were_told_is_read(json_of: Any) -> None:
    answer = run("cube")
    for one in answer["touchdowns"]:
        del one["old"], one["new"]
    assert {one.contacts for one in Earlier(json_of(answer)).touchdowns_of("run.mcap")} == {None}


def test_of_several_bags_the_run_of_this_one_is_read(tmp_path: Path, json_of: Any) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    write_run(folder / "monday.mcap", scores=(SCORED,))
    write_run(folder / "tuesday.mcap", scores=(SCORED, UNSCORED))
    assert len(Earlier(folder).touchdowns_of("bags/tuesday.bag")) == 2
    runs = [run("cube", SCORES[:k]) | {"bag": f"bags/{name}"} for k, name in ((1, "monday.mcap"), (2, "tuesday.mcap"))]
    assert len(Earlier(json_of(runs)).touchdowns_of("bags/tuesday.mcap")) == 2
    assert len(Earlier(json_of(runs)).touchdowns_of("elsewhere/monday.mcap")) == 1


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("not json", "is not JSON"),
        ("3", "is not the JSON of a replay"),
        ("[1, 2]", "is not the JSON of a replay"),
        ('{"touchdowns": [{"stamp": 1}]}', "is not the JSON of a replay"),
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


def test_what_is_not_there_or_is_no_run_is_refused(tmp_path: Path) -> None:
    for name in ("none.json", "none.mcap"):
        with pytest.raises(InputError, match=name):
            Earlier(tmp_path / name).touchdowns_of("run.mcap")
    with pytest.raises(InputError, match=r"has no run\.mcap; write it"):
        Earlier(tmp_path).touchdowns_of("run.mcap")
    with BagWriter(tmp_path / "other.mcap") as writer:
        writer.write("/odom", DIAGNOSTIC_ARRAY, 1, b"")
    with pytest.raises(InputError, match="has no predictions"):
        Earlier(tmp_path / "other.mcap").touchdowns_of("run.mcap")
    with BagWriter(tmp_path / "damaged.mcap") as writer:
        for name in ("prediction", "score"):
            writer.write(f"/impact_predictor/{name}", DIAGNOSTIC_ARRAY, 1, bytes(8))
    with pytest.raises(InputError, match="a message on /impact_predictor/score that is no score"):
        Earlier(tmp_path / "damaged.mcap").touchdowns_of("run.mcap")
