"""`impact-predictor explain`: what it prints, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from impact_predictor.cli import main
from impact_predictor.report.parts import measure

ANSWER: dict[str, Any] = {
    "scene": "crate",
    "parts": [
        {"name": "core", "on": True, "why": "every scene", "us_per_sample": 60.0, "start_ms": 45.0, "start_mb": 2.0}
    ],
    "us_per_sample": 60.0,
    "start_ms": 45.0,
    "start_mb": 2.0,
    "all_on": {"us_per_sample": 60.0, "us_scatter": 0.0, "start_ms": 45.0, "start_mb": 2.0},
    "node": None,
    "why_no_node": "ROS 2 is not here",
    "outputs": {"mode": 0.2},
    "record": "300 samples",
}


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ("explain", *arguments), terminal_width=100)


@pytest.fixture
def measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Costs that are known, at once."""
    monkeypatch.setattr(measure, "measure_parts", lambda params, tell: ANSWER)


@pytest.mark.usefixtures("measured")
def test_json_alone_is_printed_where_it_is_asked_for() -> None:
    result = run("scene.yaml", "--json")
    assert result.exit_code == 0
    assert json.loads(result.stdout) == ANSWER


@pytest.mark.usefixtures("measured")
def test_a_person_gets_a_table() -> None:
    result = run("scene.yaml")
    assert result.exit_code == 0
    assert "crate: what this scene pays for" in result.stdout
    assert "This scene: 60 us per sample" in result.stdout


def test_a_file_that_is_no_scene_is_refused_in_one_sentence(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text("/**:\n  ros__parameters:\n    body:\n      mass: 1.0\n")
    for name, said in ((file, "the parameter body.inertia is missing"), (tmp_path / "no.yaml", "cannot be read")):
        result = run(str(name))
        assert result.exit_code == 2
        assert result.stdout == ""
        assert said in result.stderr
        assert len(result.stderr.splitlines()) == 1


def test_the_help_shows_how_it_is_called() -> None:
    result = run("--help")
    assert "impact-predictor explain config/cube_tosses.yaml" in result.stdout
