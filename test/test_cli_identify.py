"""`impact-predictor identify`: bags in, mass centre, inertia and a scene file out."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import pytest
from command_line import answer_of, invoke
from scipy.spatial.transform import Rotation
from tossed_bodies import CENTER, GIVEN, TRUE, tosses

from impact_predictor.bags.write import BagWriter
from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.types import Geometry, Sample
from impact_predictor.ros.messages import ODOMETRY, POLYGON, encode_odometry, encode_polygon

STILL, FLAT = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
SCENE = f"""# A box in the hall.
/**:
  ros__parameters:
    body:
      mass: 0.5
      inertia: [{GIVEN[0]}, {GIVEN[1]}, {GIVEN[2]}, 0.0, 0.0, 0.0]  # as drawn
    contact:
      friction: 0.3
"""

run = partial(invoke, "identify")


def record(path: Path, number: int) -> str:
    """A bag of tosses, a second apart."""
    with BagWriter(path) as writer:
        begin = 0
        for toss in tosses(number):
            motion = toss.motion
            points = tuple((x, y, z) for x, y, z in motion.points.tolist())
            writer.write("/contact_geometry", POLYGON, begin, encode_polygon(Geometry(begin, "box", points)))
            turns = Rotation.from_matrix(motion.rotations).as_quat().tolist()
            for stamp, place, turn in zip(motion.stamps.tolist(), motion.positions.tolist(), turns, strict=True):
                covariance = (0.0,) * 36
                at = begin + stamp
                sample = Sample(at, "world", "box", tuple(place), tuple(turn), STILL, STILL, covariance, covariance)
                writer.write("/odom", ODOMETRY, at, encode_odometry(sample))
            begin += int(motion.stamps[-1]) + 1_000_000_000
    return str(path)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("identify")
    (folder / "scene.yaml").write_text(SCENE)
    record(folder / "box.mcap", 60)
    return folder


@pytest.mark.slow
@pytest.mark.usefixtures("few_resamples")
def test_the_json_tells_the_true_body_and_the_scene_file_has_it(folder: Path) -> None:
    scene, output = str(folder / "scene.yaml"), str(folder / "identified.yaml")
    result = run(str(folder / "box.mcap"), "--params", scene, "-o", output, "--json")
    answer = answer_of(result)
    assert result.stderr.splitlines()[-1] == (
        "note: fitting mass centre and inertia to 60 motions and 200 resamples of them"
    )
    assert (answer["motions"], answer["repeated_motions"]) == (60, 0)
    assert list(answer["body"]) == ["ixx", "iyy", "izz", "ixy", "ixz", "iyz", "center_x", "center_y", "center_z"]
    assert all(one["told"] and one["low"] <= one["value"] <= one["high"] for one in answer["body"].values())
    assert answer["inconsistency"]["held_out"]["median"] < 0.01 < answer["inconsistency"]["given"]["median"]
    assert answer["corner_radius"]["high"] < 5e-4
    assert answer["roundings"][0]["radius"] == 0.0
    values = read_values(output)
    assert values["body.inertia"] == pytest.approx(TRUE, abs=1e-6)
    assert values["body.center_of_mass"] == pytest.approx(CENTER, abs=1e-5)
    assert tuple(answer["parameters"]["body.inertia"]) == values["body.inertia"]
    text = Path(output).read_text()
    assert text.startswith("# A box in the hall.\n")
    assert "with 95 %; as drawn" in text


@pytest.mark.slow
@pytest.mark.usefixtures("few_resamples")
def test_the_tables_tell_intervals_what_is_held_out_and_what_cannot_be_told(folder: Path) -> None:
    result = run(str(folder / "box.mcap"), "--params", str(folder / "scene.yaml"), "--tensor", "isotropic")
    assert result.exit_code == 0, result.output
    said = result.stdout
    for words in ("95 % interval", "corner radius (mm)", "Held out, its median is", "cannot be told"):
        assert words in said
    assert "inertia (kg m^2)" in said
    assert "ixx" not in said


@pytest.mark.parametrize(
    ("inertia", "tensor", "moments"),
    [("0.1", "scene", 1), ("0.1, 0.1, 0.2, 0.0, 0.0, 0.0", "scene", 6), ("0.1", "principal", 3)],
)
def test_as_many_moments_are_fitted_as_the_scene_has_unless_told_otherwise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inertia: str, tensor: str, moments: int
) -> None:
    asked: list[int] = []

    def noted(scene: Any, motions: Any, moments: int, *others: Any) -> None:
        asked.append(moments)
        raise InputError("no more is asked for")

    monkeypatch.setattr("impact_predictor.calibration.identify.identify", noted)
    given = f"[{GIVEN[0]}, {GIVEN[1]}, {GIVEN[2]}, 0.0, 0.0, 0.0]"
    (tmp_path / "scene.yaml").write_text(SCENE.replace(given, f"[{inertia}]"))
    with BagWriter(tmp_path / "none.mcap") as writer:
        points = (0.1, 0.0, 0.0), (-0.1, 0.0, 0.0)
        writer.write("/contact_geometry", POLYGON, 0, encode_polygon(Geometry(0, "box", points)))
        writer.write("/odom", ODOMETRY, 0, encode_odometry(Sample(0, "world", "box", STILL, FLAT, STILL, STILL)))
    run(str(tmp_path / "none.mcap"), "--params", str(tmp_path / "scene.yaml"), "--tensor", tensor)
    assert asked == [moments]


def test_too_few_impacts_end_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE)
    result = run(record(tmp_path / "few.mcap", 2), "--params", str(tmp_path / "scene.yaml"))
    assert result.exit_code == 2
    (said,) = [line for line in result.stderr.splitlines() if line.startswith("error: ")]
    assert "in 2 motions, cannot tell mass centre and inertia" in said
