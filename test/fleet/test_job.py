"""What became of one bag of many: small enough to be sent, and never an exception for what is wrong with the bag."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from impact_predictor import read_scenes
from impact_predictor.fleet import job
from impact_predictor.fleet.job import Job, failed, renamed, replay_bag

SCENE = str(Path(__file__).parents[2] / "config/cube_tosses.yaml")


def test_an_outcome_has_the_result_and_the_json_where_it_is_wanted_but_nothing_of_each_sample(bags: list[str]) -> None:
    asked = Job(read_scenes(SCENE), {}, answers=True)
    outcome = replay_bag(asked, bags[0], None)
    assert outcome.result is not None
    assert (outcome.result.costs, outcome.result.matches) == ((), ())
    assert outcome.answer["touchdowns"]
    assert outcome.answer["samples"] > 50
    # About 1.5 kB of a touchdown: twice that leaves no room for samples.
    assert len(pickle.dumps(outcome)) < 3000 * len(outcome.answer["touchdowns"]) + 10_000
    assert replay_bag(asked._replace(answers=False), bags[0], None).answer == {}


def test_a_bag_that_cannot_be_used_is_an_outcome_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = str(tmp_path / "missing.mcap")
    outcome = replay_bag(Job(read_scenes(SCENE), {}), missing, None)
    assert outcome.result is None
    assert outcome.error.startswith(f"{missing} does not exist")
    assert outcome.answer == {"bag": missing, "error": outcome.error}

    def exhausted(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(job, "replay", exhausted)
    assert "needs more memory than there is" in replay_bag(Job({}, {}), missing, None).error


def test_an_outcome_speaks_of_its_bag_by_another_name_everywhere(bags: list[str]) -> None:
    outcome = replay_bag(Job(read_scenes(SCENE), {}, answers=True), bags[0], None)
    assert outcome.result is not None
    assert bags[0] in str(outcome.result.notes)
    outcome.answer["damaged"] = f"{bags[0]} is damaged"
    outcome = outcome._replace(result=outcome.result._replace(damaged=bags[0], unpredictable=bags[0]))
    other = renamed(outcome, {bags[0]: "toss.mcap"})
    assert bags[0] not in str(other)
    assert other.result is not None
    assert (other.bag, other.result.bag, other.answer["bag"]) == ("toss.mcap",) * 3
    assert other.answer["touchdowns"] == outcome.answer["touchdowns"]
    error = renamed(failed("/data/run", "/data/run is no bag, /tmp/out stays"), {"/data/run": "run", "/tmp/out": "out"})
    assert error == failed("run", "run is no bag, out stays")
