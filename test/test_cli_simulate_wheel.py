"""`impact-predictor simulate wheel`: what it prints and writes, and one sentence for each mistake."""

from __future__ import annotations

import shlex
from functools import partial
from math import pi, tan
from pathlib import Path
from typing import Any

import pytest
from command_line import answer_of, invoke

from impact_predictor.bags.read import topics
from impact_predictor.commands.simulate import EXAMPLES, STICKS
from impact_predictor.parameters.file import read_values
from impact_predictor.scenarios.truth import TRUTH_TOPIC

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "config/wheel.yaml"


pytestmark = pytest.mark.usefixtures("folder")

run = partial(invoke, "simulate", "wheel")


def simulated(*arguments: str) -> Any:
    return answer_of(run(*arguments, "--json"))


def test_the_example_of_a_point_mass_ends_with_its_known_rates() -> None:
    answer = simulated(*shlex.split(EXAMPLES["wheel"][1])[3:-1])
    assert set(answer) == {"impacts", "steps", "speed", "steady", "impact_friction", "time", "end"}
    assert (answer["end"], answer["steps"], len(answer["impacts"])) == ("STEPS_DONE", 40, 40)
    last = answer["impacts"][-1]
    for found in (last, answer["steady"]):
        assert found["omega_before"] == pytest.approx(1.548428592, abs=1e-8)
        assert found["omega_after"] == pytest.approx(1.094904357, abs=1e-8)
    assert (last["mode"], last["old"], last["new"]) == ("PIVOT", 7, 0)
    assert answer["impact_friction"] == pytest.approx(tan(pi / 8.0), abs=1e-10)
    assert answer["steady"]["friction"] == pytest.approx(tan(pi / 8.0), abs=1e-10)
    # The wheel begins from rest, so that it was slower than it is now.
    assert 0.9 * answer["steady"]["speed"] < answer["speed"] < answer["steady"]["speed"]


def test_where_no_friction_is_enough_for_steady_rolling_its_rates_are_not_told() -> None:
    assert simulated("--slope", "20", "--steps", "2")["steady"] is None
    text = run("--alpha", "1", "--slope", "2").stdout
    said = "On this slope it cannot roll steadily without slip, with any friction (closed form).\n"
    assert text.endswith(said)
    assert said in run("--slope", "20").stdout


def test_the_table_tells_the_impacts_and_the_closed_form() -> None:
    text = run().stdout
    assert "wheel, 8 spokes 1 m long, slope 5 degrees" in text
    assert "8 more impacts: read them with --json." in text
    assert ": steps done, 20 steps and 15." in text
    assert (
        "Steady rolling without slip, closed form: 1.605412029 rad/s before each impact, 1.177944487 after it" in text
    )
    assert "friction coefficient of 0.370775 in the impacts, between them 0.375327; the wheel has 100." in text
    assert all(len(line) <= 80 for line in text.splitlines()[:15])


def test_the_replay_of_its_bag_with_the_shipped_scene_finds_every_impact(folder: Path) -> None:
    result = run("--steps", "6", "--rate", "500", "-o", "wheel.mcap")
    assert result.exit_code == 0, result.stderr
    assert "Bag: wheel.mcap" in result.stdout
    assert TRUTH_TOPIC in topics(folder / "wheel.mcap")
    truth = answer_of(invoke("replay", "wheel.mcap", "--params", str(SCENE), "--json"))["truth"]
    assert (truth["touchdowns"], truth["missed"], truth["false"], truth["mode_accuracy"]) == (6, 0, 0, 1.0)
    # The motion is followed to 1e-11, stamps are whole ns.
    assert truth["median_velocity_error"] < 1e-8
    assert truth["median_time_error"] < 2e-9


def test_the_defaults_are_those_of_the_shipped_scene() -> None:
    values = read_values(SCENE)
    assert values["contact.friction"] == STICKS
    assert (values["body.mass"], list(values["body.inertia"])) == (1.0, [0.1])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ["--alpha", "23"],
            "alpha is 23 degrees, half the angle between two spokes; give 180 degrees divided by a whole",
        ),
        (["--inertia", "0"], "inertia is 0.0; give a finite number above 0"),
        (["--slope", "nan"], "slope is nan degrees"),
        (["--duration", "0"], "duration is 0.0; give a number of seconds"),
        (["--omega", "inf"], "rate is inf; give a finite number"),
        (["--rate", "100"], "--rate is that of a bag: give -o BAG too"),
    ],
)
def test_a_mistake_is_told_in_one_sentence_and_nothing_is_written(
    folder: Path, arguments: list[str], sentence: str
) -> None:
    result = run(*arguments)
    assert result.exit_code != 0
    assert sentence in result.stderr
    assert not list(folder.iterdir())


def test_the_examples_of_the_help_name_options_that_exist() -> None:
    text = run("--help").stdout
    for line in EXAMPLES["wheel"]:
        assert line in text
        assert all(word in text for word in shlex.split(line) if word.startswith("-"))
