"""`impact-predictor replay --baseline`: silent on the same, and what has changed with exit status 1."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from impact_predictor.cli import main

SCENE = Path(__file__).parents[1] / "config/rocking_plate.yaml"


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two impacts of a plate on the floor, and the way to a third."""
    path = tmp_path_factory.mktemp("plate") / "plate.mcap"
    options = ["--friction", "0.4", "--restitution", "0.1", "--duration", "0.7", "-o", str(path)]
    assert CliRunner().invoke(main, ["simulate", "plate", *options]).exit_code == 0
    return path


def replay(*options: str | Path, scene: Path = SCENE) -> Result:
    return CliRunner().invoke(main, ["replay", "--params", str(scene), *map(str, options)])


def test_a_run_compared_with_itself_says_that_nothing_has_changed(tmp_path: Path, bag: Path) -> None:
    old, told = tmp_path / "old.mcap", tmp_path / "old.json"
    assert replay(bag, "-o", old).exit_code == 0
    # The new run takes the place of the baseline, which was read before.
    same = replay(bag, "--baseline", old, "--baseline-time", "0", "--baseline-error", "0", "-o", old)
    assert (same.exit_code, same.stdout.splitlines()[-1]) == (0, f"Nothing has changed against {old}: 3 touchdowns.")
    told.write_text(replay(bag, "--json").stdout)
    answer = json.loads(replay(bag, "--baseline", told, "--json").stdout)["baseline"]
    assert answer == {"file": str(told), "touchdowns_before": 3, "touchdowns": 3, "unchanged": 3, "changes": []}


def test_another_scene_changes_the_run_in_words_and_in_json(tmp_path: Path, bag: Path) -> None:
    old, scene = tmp_path / "old.mcap", tmp_path / "other.yaml"
    scene.write_text(SCENE.read_text().replace("restitution: 0.1", "restitution: 0.3"))
    replay(bag, "-o", old)
    other = replay(bag, "--baseline", old, scene=scene)
    assert other.stdout.splitlines()[-1] == f"Against {old} 1 of 3 touchdowns are as they were: 2 worse."
    told = replay(bag, "--baseline", old, "--json", scene=scene)
    answer = json.loads(told.stdout)["baseline"]
    assert (answer["unchanged"], [one["change"] for one in answer["changes"]]) == (1, ["worse"] * 2)
    alike = replay(bag, "--baseline", old, "--baseline-error", "1", scene=scene)
    assert (other.exit_code, told.exit_code, alike.exit_code) == (1, 1, 0)


def test_a_bag_that_the_earlier_run_lacks_is_told_and_stops_no_other(tmp_path: Path, bag: Path) -> None:
    new, old = tmp_path / "new.mcap", tmp_path / "old.json"
    new.hardlink_to(bag)
    old.write_text(f"[{replay(bag, '--json').stdout}]")
    said = f"the baseline {old} has no run of {new}; replay that bag with -o or --json again"
    result = replay(bag, new, "--baseline", old)
    assert (result.exit_code, said in result.stderr) == (1, True)
    assert f"Nothing has changed against {old}: 3 touchdowns." in result.stdout
    compared = [answer["baseline"] for answer in json.loads(replay(bag, new, "--baseline", old, "--json").stdout)]
    assert (compared[0]["unchanged"], compared[1]) == (3, {"file": str(old), "error": said})
    alone = replay(new, "--baseline", old)
    assert (alone.exit_code, alone.stderr) == (2, f"error: {said}\n")


def test_what_is_no_run_of_these_bags_is_refused_before_anything_is_replayed(tmp_path: Path, bag: Path) -> None:
    old, new = tmp_path / "old.json", tmp_path / "new.mcap"
    old.write_text(replay(bag, "--json").stdout)
    new.hardlink_to(bag)
    for bags, baseline, said in (
        ((bag, new), old, "is the run of one bag, but 2 bags are given; give what a run of several"),
        ((bag,), bag, "has no predictions"),
    ):
        refused = replay(*bags, "--baseline", baseline, "-o", tmp_path / "out")
        assert (refused.exit_code, refused.stdout) == (2, "")
        assert refused.stderr.startswith(f"error: the baseline {baseline} {said}")
    assert not (tmp_path / "out").exists()
