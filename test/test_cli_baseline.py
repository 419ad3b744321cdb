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


@pytest.fixture
def other_scene(tmp_path: Path) -> Path:
    path = tmp_path / "other.yaml"
    path.write_text(SCENE.read_text().replace("restitution: 0.1", "restitution: 0.3"))
    return path


def replay(bag: Path, scene: Path, *options: str | Path) -> Result:
    return CliRunner().invoke(main, ["replay", str(bag), "--params", str(scene), *map(str, options)])


def test_a_run_compared_with_itself_says_that_nothing_has_changed(tmp_path: Path, bag: Path) -> None:
    old = tmp_path / "old.mcap"
    assert replay(bag, SCENE, "-o", old).exit_code == 0
    # The new run takes the place of the baseline, which was read before.
    same = replay(bag, SCENE, "--baseline", old, "--baseline-time", "0", "--baseline-error", "0", "-o", old)
    assert (same.exit_code, same.stdout.splitlines()[-1]) == (0, f"Nothing has changed against {old}: 3 touchdowns.")
    told = tmp_path / "old.json"
    told.write_text(replay(bag, SCENE, "--json").stdout)
    assert replay(bag, SCENE, "--baseline", told).exit_code == 0


def test_another_scene_changes_the_run_in_words_and_in_json(tmp_path: Path, bag: Path, other_scene: Path) -> None:
    old = tmp_path / "old.mcap"
    replay(bag, SCENE, "-o", old)
    other = replay(bag, other_scene, "--baseline", old)
    assert other.exit_code == 1
    assert other.stdout.splitlines()[-1] == f"Against {old} 1 of 3 touchdowns are as they were: 2 worse."
    assert replay(bag, other_scene, "--baseline", old, "--baseline-error", "1").exit_code == 0
    told = replay(bag, other_scene, "--baseline", old, "--json")
    answer = json.loads(told.stdout)["baseline"]
    assert (told.exit_code, answer["unchanged"], [one["change"] for one in answer["changes"]]) == (1, 1, ["worse"] * 2)
    same = json.loads(replay(bag, SCENE, "--baseline", old, "--json").stdout)["baseline"]
    assert same == {"file": str(old), "touchdowns_before": 3, "touchdowns": 3, "unchanged": 3, "changes": []}


def test_a_bag_that_the_earlier_run_lacks_is_told_and_stops_no_other(tmp_path: Path, bag: Path) -> None:
    (tmp_path / "new.mcap").hardlink_to(bag)
    old, both = tmp_path / "old.json", (tmp_path / "new.mcap", "--baseline", tmp_path / "old.json")
    old.write_text(f"[{replay(bag, SCENE, '--json').stdout}]")
    said = f"the baseline {old} has no run of {tmp_path / 'new.mcap'}; replay that bag with -o or --json again"
    result = replay(bag, SCENE, *both)
    assert (result.exit_code, said in result.stderr) == (1, True)
    assert f"Nothing has changed against {old}: 3 touchdowns." in result.stdout
    compared = [answer["baseline"] for answer in json.loads(replay(bag, SCENE, *both, "--json").stdout)]
    assert (compared[0]["unchanged"], compared[1]) == (3, {"file": str(old), "error": said})
    alone = replay(tmp_path / "new.mcap", SCENE, "--baseline", old)
    assert (alone.exit_code, alone.stderr) == (2, f"error: {said}\n")


def test_a_set_of_bags_may_grow_beside_its_baseline(tmp_path: Path, bag: Path) -> None:
    """Where a second bag of the name comes, the folder calls both otherwise, so that it has none of them."""
    days = [tmp_path / day / "run.mcap" for day in ("monday", "tuesday", "wednesday")]
    for day in days:
        day.parent.mkdir()
        day.hardlink_to(bag)
    old = tmp_path / "old"
    old.mkdir()
    assert replay(days[0], SCENE, "-o", old / "run.mcap").exit_code == 0
    grown = replay(days[0], SCENE, days[1], "--baseline", old)
    assert grown.exit_code == 1
    notes = [line for line in grown.stderr.splitlines() if "the baseline" in line]
    assert notes == [
        f"note: the baseline {old} has no run of {day}; replay that bag with -o or --json again" for day in days[:2]
    ]
    assert "2 bags together" in grown.stdout
    assert replay(days[0], SCENE, days[1], "-o", old).exit_code == 0
    assert replay(days[0], SCENE, days[1], "--baseline", old).exit_code == 0
    assert replay(days[0], SCENE, *days[1:], "--baseline", old).exit_code == 1
    # One of them alone is still found.
    (old / "run.mcap").unlink()
    assert replay(days[1], SCENE, "--baseline", old).exit_code == 0


def test_the_run_of_one_bag_is_no_baseline_of_several(tmp_path: Path, bag: Path) -> None:
    (tmp_path / "new.mcap").hardlink_to(bag)
    for old, option in ((tmp_path / "old.mcap", "-o"), (tmp_path / "old.json", "--json")):
        done = replay(bag, SCENE, "-o", old) if option == "-o" else replay(bag, SCENE, "--json")
        if option == "--json":
            old.write_text(done.stdout)
        refused = replay(bag, SCENE, tmp_path / "new.mcap", "--baseline", old)
        said = f"error: the baseline {old} is the run of one bag, but 2 bags are given; give what a run of several"
        assert (refused.exit_code, refused.stderr.startswith(said), refused.stdout) == (2, True, "")


def test_a_baseline_that_is_no_run_is_refused_before_anything_is_replayed(tmp_path: Path, bag: Path) -> None:
    refused = replay(bag, SCENE, "--baseline", bag, "-o", tmp_path / "new.mcap")
    assert refused.exit_code == 2
    assert refused.stderr.startswith(f"error: the baseline {bag} has no predictions")
    assert not (tmp_path / "new.mcap").exists()
