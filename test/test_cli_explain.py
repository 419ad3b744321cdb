"""`impact-predictor explain`: what it prints, and what it refuses."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

from command_line import invoke

from impact_predictor.native import form

CONFIG = Path(__file__).parents[1] / "config"

run = partial(invoke, "explain")


def test_a_program_gets_every_feature_with_its_reason_and_the_topics() -> None:
    answer = json.loads(run(str(CONFIG / "deck_many.yaml"), "--json").stdout)
    parts = {part["name"]: part for part in answer["parts"]}
    assert answer["scene"] == "deck_many"
    assert parts["moving support"]["on"]
    assert parts["tilt"]["why"] == "source is imu (for 1 of 7 bodies)"
    assert not parts["feet"]["on"]
    assert "feet.names" in parts["feet"]["why"]
    assert answer["topics"][0] == "support/odom"
    assert answer["runs"] == form()


def test_a_person_gets_a_table_of_what_is_on_before_what_is_off() -> None:
    result = run(str(CONFIG / "cube_tosses.yaml"))
    assert result.exit_code == 0
    words = result.stdout.split()
    assert "cube_tosses:" in words
    assert words.index("on") < words.index("off")
    *_, topics, runs = result.stdout.splitlines()
    assert topics == "The node subscribes to contact_geometry and odom."
    assert runs.startswith("The predictor runs ")


def test_a_file_that_is_no_scene_is_refused_in_one_sentence(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text("/**:\n  ros__parameters:\n    body:\n      mass: 1.0\n")
    for name, said in ((file, "the parameter body.inertia is missing"), (tmp_path / "no.yaml", "cannot be read")):
        result = run(str(name))
        assert result.exit_code == 2
        assert result.stdout == ""
        assert said in result.stderr
        assert len(result.stderr.splitlines()) == 1
