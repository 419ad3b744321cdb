"""`impact-predictor simulate deck`: what it prints and writes, and one sentence for each mistake."""

from __future__ import annotations

import shlex
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from command_line import answer_of, invoke, refusal_of
from records import impacts_of, samples_of

from impact_predictor.bags.read import topics
from impact_predictor.commands.simulate_deck import EXAMPLES, SCENE, simulate_deck
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.ros.messages import ODOMETRY
from impact_predictor.scenarios.deck.cargo import units_of
from impact_predictor.scenarios.deck.vessel import Vessel

ROOT = Path(__file__).parents[1]
SCENES = ("deck_crate.yaml", "deck_drum.yaml", "deck_lashed.yaml", "deck_many.yaml")


@pytest.fixture(autouse=True)
def folder(folder: Path) -> Path:
    (folder / "config").symlink_to(ROOT / "config")
    return folder


run = partial(invoke, "simulate", "deck")


def simulated(*arguments: str) -> Any:
    return answer_of(run(*arguments, "--json"))


def scenes(name: str) -> dict[str, Scene]:
    return scenes_of(read_values(ROOT / "config" / name))


@pytest.mark.parametrize("name", SCENES)
def test_a_shipped_scene_stands_on_its_deck(name: str) -> None:
    found = scenes(name)
    for unit in units_of(found):
        # place.position is where the simulation puts it: on the deck.
        (x, y, z), (foot_y, foot_z) = unit.scene.place, unit.foot
        assert (unit.start.x + foot_y, unit.start.y + foot_z) == pytest.approx((y, z), abs=1e-5)
        assert unit.mount.beside == x
        assert unit.scene.watching is not None
        assert unit.scene.deck is not None
    assert len(found) == {"deck_many.yaml": 7, "deck_lashed.yaml": 2}.get(name, 1)


def test_the_json_has_the_impacts_of_all_and_of_each_unit() -> None:
    answer = simulated("--params", "config/deck_many.yaml", "--duration", "60", "--hs", "1.5")
    assert set(answer) == {"duration", "impacts", "accumulation_time", "end", "deck", "standing", "units"}
    assert answer["end"] == "TIME_UP"
    assert list(answer["units"]) == list(scenes("deck_many.yaml"))
    times = [impact["time"] for impact in answer["impacts"]]
    assert times == sorted(times)
    assert len(times) == sum(len(unit["impacts"]) for unit in answer["units"].values()) > 20
    for impact in answer["impacts"]:
        assert set(impact) == {"unit", "time", "mode", "omega_before", "omega_after"}
        assert impact["omega_before"] >= 0.0
        unit = answer["units"][impact["unit"]]
        assert {name: value for name, value in impact.items() if name != "unit"} in unit["impacts"]


def test_people_read_what_each_unit_did() -> None:
    lines = run("--params", "config/deck_many.yaml", "--duration", "60").stdout.splitlines()
    assert "1 min on a deck that rolls up to" in lines[0]
    for name in scenes("deck_many.yaml"):
        assert any(line.startswith(f"{name} ") and line.rstrip().endswith("stands") for line in lines)
    assert any("impacts, " in line and "a minute" in line for line in lines)


def test_the_bag_is_that_of_the_default_scene_and_its_truth() -> None:
    result = run("--duration", "30", "--rate", "20", "--deck-rate", "40", "-o", "crate.mcap")
    assert result.stdout.splitlines()[-1] == "Bag: crate.mcap"
    found = topics("crate.mcap")
    assert found["/odom"] == found["/support/odom"] == ODOMETRY
    assert [len(samples_of("crate.mcap", topic)) for topic in ("/odom", "/support/odom")] == [601, 1201]
    told = impacts_of("crate.mcap")
    answer = simulated("--duration", "30")
    assert [impact.stamp / 1e9 for impact in told] == [impact["time"] for impact in answer["impacts"]]
    assert [impact.mode.name for impact in told] == [impact["mode"] for impact in answer["impacts"]]


def test_sea_vessel_and_seed_reach_the_simulation() -> None:
    first = simulated("--duration", "60")["deck"]
    assert first == simulated("--duration", "60", "--params", SCENE)["deck"]
    for options in (
        ["--seed", "2"],
        ["--hs", "1.0"],
        ["--tp", "6"],
        ["--gamma", "2"],
        ["--roll-period", "6"],
        ["--breadth", "8"],
        ["--roll-damping", "0.1"],
    ):
        assert simulated("--duration", "60", *options)["deck"] != first
    # It rolls about the middle of the vessel: further up there is more sway.
    assert simulated("--duration", "60", "--deck-height", "5")["deck"]["most_lateral"] > first["most_lateral"]


def test_a_recorded_deck_carries_the_units_as_long_as_it_lasts() -> None:
    assert run("--duration", "40", "--hs", "1.2", "-o", "sea.mcap").exit_code == 0
    first = simulated("--duration", "40", "--hs", "1.2")
    again = simulated("--record", "sea.mcap", "--record-topic", "/support/odom")
    assert again["duration"] == 40.0
    # Looked for at other times.
    assert again["deck"]["most_rolled"] == pytest.approx(first["deck"]["most_rolled"], rel=0.02)
    assert [impact["time"] for impact in again["impacts"]][:5] == pytest.approx(
        [impact["time"] for impact in first["impacts"]][:5], abs=1e-4
    )
    result = run("--record", "sea.mcap", "--record-topic", "/support/odom", "--duration", "50")
    assert (result.exit_code, "the recorded deck ends after 40 s" in result.stderr) == (2, True)


def test_compliant_contacts_tell_impacts_too() -> None:
    options = ["--duration", "20", "--hs", "1.2"]
    first = []
    for contacts in ("rigid", "compliant"):
        impacts = simulated(*options, "--contacts", contacts)["impacts"]
        first.append(next(one for one in impacts if one["omega_before"] > 0.02))
    rigid, compliant = first
    assert compliant["time"] == pytest.approx(rigid["time"], abs=5e-3)
    assert compliant["mode"] == rigid["mode"]


def test_waves_from_the_quarter_move_units_every_way() -> None:
    sea = ["--heading", "45", "--hs", "4", "--tp", "6", "--duration", "120", "--params", "config/deck_many.yaml"]
    answer = simulated(*sea)
    assert answer["deck"]["most_pitched"] > 0.05
    assert sum(len(unit["onsets"]) for unit in answer["units"].values()) > 5
    assert simulated(*sea, "--spread", "20")["deck"] != answer["deck"]


def test_a_unit_that_toppled_stands_again() -> None:
    sea = ["--duration", "200", "--hs", "2"]
    once, again = simulated(*sea), simulated(*sea, "--restand", "20")
    (fallen,), (risen,) = once["units"].values(), again["units"].values()
    assert (fallen["end"], fallen["toppled"]) == ("OVERTURNED", 1)
    assert once["standing"] == pytest.approx(fallen["time"] / 200.0)
    assert risen["end"] == "TIME_UP"
    assert risen["toppled"] > 1
    assert 1.0 - 20.0 * risen["toppled"] / 200.0 == pytest.approx(again["standing"], abs=20.0 / 200.0)
    assert risen["onsets"][: len(fallen["onsets"])] == fallen["onsets"]
    assert "Cargo stands in" in run(*sea).stdout


def test_the_noise_is_that_of_the_options() -> None:
    for name, options in (("one", []), ("two", ["--noise-position", "0.05"])):
        assert run("--duration", "10", "-o", name, *options).exit_code == 0
    places = [[sample.position[0] for sample in samples_of(name)] for name in ("one", "two")]
    apart = [one - two for one, two in zip(*places, strict=True)]
    assert (sum(part * part for part in apart) / len(apart)) ** 0.5 == pytest.approx(0.05, rel=0.15)


def test_the_options_of_the_vessel_are_by_default_those_of_its_model() -> None:
    defaults = {option.name: option.default for option in simulate_deck.params}
    assert Vessel(**{name: defaults[name] for name in Vessel._fields if name != "height"}) == Vessel()
    assert defaults["deck_height"] == Vessel().height


@pytest.mark.slow
def test_the_default_sea_gives_two_impacts_a_minute_and_topples_nothing() -> None:
    answer = simulated("--duration", "900")
    assert answer["end"] == "TIME_UP"
    assert len(answer["impacts"]) > 2 * 15


@pytest.mark.slow
def test_every_example_works() -> None:
    for line in EXAMPLES:
        assert line in run("--help").stdout
        arguments = shlex.split(line)[1:]
        if "--duration" not in arguments:
            arguments += ["--duration", "60"]
        result = invoke(*arguments)
        assert result.exit_code == 0, result.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--hs", "20"], "degrees, which no cargo is simulated on; give a lower sea"),
        (["--hs", "0"], "the significant wave height is 0.0"),
        (["--duration", "0"], "the duration is 0.0"),
        (["--deck-rate", "-1"], "the deck rate is -1.0"),
        (["--noise-gyro", "-1"], "the noise of the gyro is -1.0"),
        (["--roll-period", "0"], "roll_period is 0.0"),
        (["--record", "no.mcap", "--hs", "2"], "--hs is of a sea, but --record takes a recorded deck"),
        (["--record-topic", "/deck/odom"], "--record-topic is of a recorded deck: give --record"),
        (["--deck-rate", "1", "-o", "slow.mcap"], "--deck-rate 1 is too slow: after support.timeout, 0.5 s,"),
        (["--params", "config/rocking_plate.yaml"], "the support of the parameter file is fixed"),
        (["--heading", "45", "--contacts", "rigid"], "rigid units move across the vessel alone: give --heading 90"),
        (["--length", "0"], "length is 0.0"),
        (["--spread", "-1"], "the waves head 90 degrees with a spread of -1"),
        (["--restand", "0"], "units stand again after 0.0 s"),
        (["-o", "taken"], "taken is there and is not an output of impact_predictor"),
    ],
)
def test_a_mistake_is_said_in_one_sentence_and_nothing_is_written(
    folder: Path, arguments: list[str], sentence: str
) -> None:
    (folder / "taken").write_text("something else")
    assert sentence in refusal_of(run(*arguments))
    assert sorted(file.name for file in folder.iterdir()) == ["config", "taken"]
