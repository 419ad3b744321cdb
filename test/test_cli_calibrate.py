"""`impact-predictor calibrate`: bags in, coefficients and a scene file out."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from math import radians
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
from command_line import answer_of, invoke

from impact_predictor.bags.read import read_messages
from impact_predictor.bags.write import BagWriter
from impact_predictor.calibration import search
from impact_predictor.calibration.scene_file import NewValues, changed
from impact_predictor.commands.calibrate import friction_seen
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.watch.slips import FrictionSeen
from impact_predictor.resources import find
from impact_predictor.ros.messages import ODOMETRY, POLYGON
from impact_predictor.scenarios.record import rocking_actor, write_record
from impact_predictor.scenarios.rocking import release, rocking_plate

FRICTION, RESTITUTION = 0.15, 0.1
ANGLES = range(5, 29, 2)
CUBES = ("examples/cube_tosses", "config/cube_tosses.yaml")

SCENE = f"""# Plates in the hall.
/**:
  ros__parameters:
    body:
      mass: 1.0
      inertia: [{1.16 / 12.0}]
    contact:
      friction: 0.4  # from a book
      tolerance: 1.0e-3
      time: 1.0e-3
"""

run = partial(invoke, "calibrate")


def record(folder: Path, angles: Sequence[int]) -> list[str]:
    """Bags of a plate that is released at several angles (degrees)."""
    rocker = rocking_plate(1.0, 0.4, None, None, 1.0, FRICTION, None, RESTITUTION)
    bags = []
    for angle in angles:
        bags.append(str(folder / f"plate{angle}.mcap"))
        write_record(bags[-1], [rocking_actor("plate", release(rocker, radians(angle)).run)], 1000.0)
    return bags


@pytest.fixture(scope="module")
def plates(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    return record(tmp_path_factory.mktemp("plates"), ANGLES)


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return str(path)


def fitted(*arguments: str) -> Any:
    return answer_of(run(*arguments, "--json"))


def test_the_friction_of_simulated_plates_comes_back_within_its_interval_though_one_bag_cannot_be_read(
    plates: list[str], scene: str
) -> None:
    result = run(*plates, "nowhere.mcap", "--params", scene, "--json")
    assert result.exit_code == 2
    assert "nowhere.mcap does not exist" in result.stderr
    answer = json.loads(result.stdout)
    for name, truth in (("friction", FRICTION), ("restitution", RESTITUTION)):
        one = answer["coefficients"][name]
        assert one["told"]
        assert one["low"] <= truth <= one["high"]
        # Until it touches down a plate that slips is followed with the given friction.
        assert one["value"] == pytest.approx(truth, abs=6e-3)
    assert not answer["coefficients"]["merge"]["told"]
    assert answer["parameters"].keys() == {"contact.friction", "contact.restitution"}
    assert "planar law" in answer["simple_errors"]
    assert answer["held_out_error"]["median"] < 0.02 < answer["given_error"]["median"]
    assert answer["bags"] == [*plates, "nowhere.mcap"]
    assert answer["touchdowns"] >= len(plates)
    fitted_to = f"{answer['touchdowns']} touchdowns and 1,000 resamples of them"
    assert f"note: fitting coefficients to {fitted_to}" in result.stderr.splitlines()


class Written(NamedTuple):
    """What a run printed, and the folder with its scene file."""

    lines: list[str]
    folder: Path


@pytest.fixture(scope="module")
def written(plates: list[str], tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("written")
    scene, output = (str(folder / name) for name in ("scene.yaml", "fitted.yaml"))
    Path(scene).write_text(SCENE)
    result = run(*plates, "--params", scene, "-o", output)
    assert result.exit_code == 0, result.output
    return Written(result.stdout.splitlines(), folder)


def test_the_scene_file_keeps_its_comments_and_is_read_by_replay(plates: list[str], written: Written) -> None:
    output = written.folder / "fitted.yaml"
    assert written.lines[-1] == f"Scene: {output}"
    text = output.read_text()
    assert text.startswith("# Plates in the hall.\n")
    assert "; from a book" in text
    assert text.count("fitted to ") == 2
    assert read_values(output)["contact.friction"] == pytest.approx(FRICTION, abs=6e-3)
    assert read_values(output)["contact.restitution"] == pytest.approx(RESTITUTION, abs=6e-3)
    assert list(written.folder.glob("*.partial")) == []
    assert invoke("replay", plates[0], "--params", str(output)).exit_code == 0


def test_the_table_tells_the_intervals_and_what_is_not_told(written: Written) -> None:
    said = "\n".join(written.lines)
    assert "95 % interval" in said
    assert "The merge time cannot be told" in said
    assert "Held out, each is predicted with what was fitted to the other" in said


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("-o", "no/such/fitted.yaml"), "the folder of no/such/fitted.yaml does not exist"),
        (("-r", "odom=/x"), "is not of the form from:=to"),
        (("-r", "odom:=/x"), "has no topic /x"),
        ((), "can be fitted to, but 10 are needed; give more bags"),
    ],
)
def test_what_cannot_be_used_is_told_in_one_sentence(
    plates: list[str], scene: str, arguments: tuple[str, ...], sentence: str
) -> None:
    result = run(plates[0], "--params", scene, *arguments)
    assert result.exit_code == 2
    assert sentence in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert result.stderr.startswith("error: ")


@pytest.mark.slow
def test_cube_tosses_are_predicted_better_with_what_is_fitted_to_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every third of the tosses, for the time it takes; `python benchmarks/halves.py` fits to halves of them."""
    monkeypatch.setattr(search, "RESAMPLES", 50)  # no interval is looked at here
    tosses, body = tmp_path / "tosses.mcap", tmp_path / "body.yaml"
    types = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
    with BagWriter(tosses) as writer:
        for topic, log_time, data in read_messages(find(CUBES[0]), types):
            # The first toss begins at 10 s, and 20 s later the next one.
            if topic == "/cube/contact_geometry" or (log_time // 10**9 - 10) // 20 % 3 == 0:
                writer.write(topic, types[topic], log_time, data)
    published = {
        "body.inertia": NewValues((8.1e-4,), "", listed=True),
        "body.center_of_mass": NewValues((0.0, 0.0, 0.0), "", listed=True),
        "contact.friction": NewValues((0.18,), ""),
        "contact.restitution": NewValues((0.125,), ""),
    }
    (tmp_path / "given.yaml").write_text(changed(find(CUBES[1]).read_text(), published))
    arguments = ("identify", str(tosses), "--params", str(tmp_path / "given.yaml"), "-o", str(body))
    assert invoke(*arguments).exit_code == 0
    answer = fitted(str(tosses), "--params", str(body))
    for part in ("median", "p90", "mean"):
        assert answer["held_out_error"][part] < answer["given_error"][part]
        assert answer["held_out_error"][part] < 0.7 * min(each[part] for each in answer["simple_errors"].values())
    assert answer["held_out_error"]["median"] < 0.065
    # What all of them tell, and four times as much as a third of them scatters.
    assert answer["coefficients"]["friction"]["value"] == pytest.approx(0.173, abs=0.012)
    assert answer["coefficients"]["restitution"]["value"] == pytest.approx(0.322, abs=0.024)


def test_the_friction_of_a_crate_that_slides_on_a_deck_is_told_as_an_interval(tmp_path: Path) -> None:
    scene, bag = tmp_path / "scene.yaml", str(tmp_path / "deck.mcap")
    given = find("config/deck_crate.yaml").read_text(encoding="utf-8")
    scene.write_text(changed(given, {"contact.friction": NewValues((0.3,), "")}), encoding="utf-8")
    sail = ["simulate", "deck", "--params", str(scene), "--duration", "60", "--rate", "20", "--deck-rate", "20"]
    assert invoke(*sail, "-o", bag).exit_code == 0
    result = run(bag, "--params", str(scene), "--json")
    assert result.exit_code == 0
    held, slid = json.loads(result.stdout)["friction_seen"][""]
    assert 0.2 < held < 0.3 < slid < 0.4
    assert result.stderr.startswith("note: nothing is fitted: no touchdowns can be fitted to")
    said = run(bag, "--params", str(scene)).stdout
    assert said == f"Friction of the body, from when it held and when it slid: {held:.3f} to {slid:.3f}.\n"
    assert run(bag, "--params", str(scene), "-o", str(tmp_path / "fitted.yaml")).exit_code == 2


def test_what_several_watches_saw_of_the_friction_of_a_body_counts_together() -> None:
    def monitor(**seen: FrictionSeen) -> Any:
        return SimpleNamespace(watch=SimpleNamespace(friction_seen=lambda: seen))

    held, slid, nothing = FrictionSeen(held=0.2), FrictionSeen(held=0.1, slid=0.4), FrictionSeen()
    monitors: list[Any] = [monitor(crate=held, drum=nothing), SimpleNamespace(watch=None), monitor(crate=slid)]
    assert friction_seen(monitors) == {"crate": FrictionSeen(held=0.2, slid=0.4)}
