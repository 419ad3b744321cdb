"""What a replay says of bags of machines that walk in which something is wrong: with numbers, and what to do."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import cos, degrees, sin
from pathlib import Path
from typing import Any

import pytest
from made_motions import made

from impact_predictor.bags.replay import Result, replay
from impact_predictor.bags.write import BagWriter
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Geometry, Joints, Sample, Status
from impact_predictor.ros.messages import JOINT_STATE, ODOMETRY, POLYGON, encode_odometry, encode_polygon
from impact_predictor.ros.messages.walker_inputs import encode_joints

GIVEN: dict[str, Any] = {
    "body.mass": 20.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.6,
    "feet.names": ["left", "right"],
    "feet.points": 2,
}
SCENE = Scene.from_parameters(validate(GIVEN))
TYPES = {
    Geometry: ("/contact_geometry", POLYGON, encode_polygon),
    Sample: ("/odom", ODOMETRY, encode_odometry),
    Joints: ("/joint_states", JOINT_STATE, encode_joints),
}
Told = Geometry | Sample | Joints
STEPS: list[Told] = [one for one in made(SCENE) if isinstance(one, Geometry | Sample)]
"""400 times geometry, then sample, of steps on the spot whose feet stand 0.5 m below the base."""


def as_told(number: int, one: Any) -> Any:
    return one


def replayed(
    folder: Path, scene: Scene = SCENE, change: Callable[[int, Any], Any] = as_told, steps: list[Told] = STEPS
) -> Result:
    """The replay of the steps, each message changed, where it is told, by its number among those of its kind."""
    with BagWriter(folder / "walk.mcap") as writer:
        numbers = dict.fromkeys(TYPES, 0)
        for one in steps:
            told = change(numbers[type(one)], one)
            numbers[type(one)] += 1
            if told is not None:
                topic, kind, encode = TYPES[type(told)]
                writer.write(topic, kind, one.stamp, encode(told))  # type: ignore[operator]
    return replay(folder / "walk.mcap", scene)


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ({"feet.names": ["a", "b", "c"]}, "feet.names (3) x feet.points (2) wants 6"),
        ({"feet.points": 1}, "feet.names (2) x feet.points (1) wants 2"),
    ],
)
def test_another_number_of_points_is_told_with_the_one_that_the_scene_wants(
    tmp_path: Path, given: dict[str, Any], wanted: str
) -> None:
    said = replayed(tmp_path, Scene.from_parameters(validate({**GIVEN, **given}))).unpredictable
    assert f"400 of 400 messages on /contact_geometry are FEET_CHANGED: 4 points came, but {wanted}" in said


def lowered(_: int, one: Any) -> Any:
    return one._replace(position=(*one.position[:2], one.position[2] - 0.3)) if isinstance(one, Sample) else one


def in_mm(_: int, one: Any) -> Any:
    if isinstance(one, Geometry):
        return one._replace(points=tuple((1e3 * x, 1e3 * y, 1e3 * z) for x, y, z in one.points), velocities=())
    return one


@pytest.mark.parametrize(
    ("change", "depth", "odom_first"),
    # In mm the feet lie 500 m below a base that is 0.5 m high.
    [(lowered, "0.3", False), (lowered, "0.3", True), (in_mm, "500", False)],
)
def test_feet_below_the_ground_are_told_with_their_depth(
    tmp_path: Path, change: Callable[[int, Any], Any], depth: str, odom_first: bool
) -> None:
    pairs = zip(STEPS[::2], STEPS[1::2], strict=True)
    steps = [one for pair in pairs for one in (pair[::-1] if odom_first else pair)]
    said = replayed(tmp_path, change=change, steps=steps).unpredictable
    assert f"BELOW_GROUND: the lowest foot lies {depth} m below the ground: compare support.height, the units" in said
    assert "no contact points are known" not in said


def test_feet_that_change_on_the_way_are_counted_with_what_to_do(tmp_path: Path) -> None:
    def loses_one(number: int, one: Any) -> Any:
        if isinstance(one, Geometry) and number >= 200:
            return one._replace(points=one.points[:3], velocities=())
        return one

    result = replayed(tmp_path, change=loses_one)
    assert result.unpredictable == ""
    stale, changed = result.notes
    count = result.statuses[Status.GEOMETRY_STALE]
    # The last 200 of 400 samples at 200 Hz, without those within the timeout of 0.1 s.
    assert 150 <= count <= 200
    assert f"{count} of 400 messages on /odom were refused as GEOMETRY_STALE: no message about the feet could" in stale
    assert "200 of 400 messages on /contact_geometry were refused as FEET_CHANGED: 3 points came, but feet" in changed


def test_feet_that_are_told_of_too_seldom_are_told_with_the_interval(tmp_path: Path) -> None:
    def seldom(number: int, one: Any) -> Any:
        return None if isinstance(one, Geometry) and number % 50 else one

    (note,) = replayed(tmp_path, change=seldom).notes
    rate = 1e-9 * (STEPS[101].stamp - STEPS[1].stamp)
    assert f"the feet are told of every {rate:.2g} s, but feet.timeout is 0.1 s: tell of them with each sample" in note


def test_feet_that_stand_elsewhere_than_on_the_ground_of_the_scene_are_told_with_the_height_to_set(
    tmp_path: Path,
) -> None:
    result = replayed(tmp_path, Scene.from_parameters(validate({**GIVEN, "support.height": -0.1})))
    # They show the ground themselves.
    assert result.settled
    (note,) = result.notes
    assert re.search(r"feet stand 0\.1\d* m above the ground: set support\.height to -?0\.000\d, or feet\.radius", note)


def test_points_that_move_are_taken_for_feet_that_the_scene_does_not_name(tmp_path: Path) -> None:
    rigid = Scene.from_parameters(validate({k: v for k, v in GIVEN.items() if not k.startswith("feet")}))
    stepping = replayed(tmp_path, rigid)
    assert stepping.settled == stepping.notes == ()
    assert stepping.unpredictable.startswith("no touchdown was predicted, and /contact_geometry: the contact points")
    assert stepping.unpredictable.endswith(
        "of 400 messages; if they are the feet of a machine that walks, give the names of these as feet.names"
    )

    def at_rest(number: int, one: Any) -> Any:
        return one._replace(points=STEPS[0].points) if isinstance(one, Geometry) else one  # type: ignore[union-attr]

    def seldom(number: int, one: Any) -> Any:
        return one if number % 10 == 0 else at_rest(number, one)

    for change in (at_rest, seldom):
        still = replayed(tmp_path, rigid, change)
        assert (still.notes, still.unpredictable) == ((), "")


def test_what_the_scene_asks_for_and_nobody_tells_is_noted(tmp_path: Path) -> None:
    wants = Scene.from_parameters(validate({**GIVEN, "feet.force": 20.0, "feet.has_schedule": True}))
    forces, plan = replayed(tmp_path, wants).notes
    assert "nothing comes on contact_wrench, though feet.force asks for it" in forces
    assert "--remap contact_wrench:=TOPIC" in forces
    assert "nothing comes on schedule, though feet.has_schedule asks for it" in plan


LIMIT = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'
LINK = """<link name="{name}"><inertial><mass value="{mass}"/><origin xyz="0 0 {at}"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
LEG = """{thigh}{shin}<link name="{n}_foot"/>
<joint name="{n}_hip" type="revolute"><parent link="base"/><child link="{n}_thigh"/><origin xyz="0 {y} 0"/>
  <axis xyz="0 1 0"/>{limit}</joint>
<joint name="{n}_knee" type="revolute"><parent link="{n}_thigh"/><child link="{n}_shin"/><origin xyz="0 0 -0.3"/>
  <axis xyz="0 1 0"/>{limit}</joint>
<joint name="{n}_end" type="fixed"><parent link="{n}_shin"/><child link="{n}_foot"/><origin xyz="0 0 -0.3"/></joint>"""
BENT = 0.6
JOINTS = ("left_hip", "left_knee", "right_hip", "right_knee")


@pytest.fixture
def modelled(tmp_path: Path) -> Scene:
    """A machine on two legs whose mass only its model tells."""
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    legs = [
        LEG.format(
            n=name,
            y=y,
            limit=LIMIT,
            thigh=LINK.format(name=f"{name}_thigh", mass=1.0, at=-0.15),
            shin=LINK.format(name=f"{name}_shin", mass=1.0, at=-0.15),
        )
        for name, y in (("left", 0.1), ("right", -0.1))
    ]
    file = tmp_path / "legs.urdf"
    file.write_text(f'<robot name="legs">{LINK.format(name="base", mass=20.0, at=0.0)}{"".join(legs)}</robot>')
    given = {"contact.friction": 0.6, "feet.names": ["left", "right"], "robot.urdf": str(file)}
    return Scene.from_parameters(validate({**given, "robot.frames": ["left_foot", "right_foot"]}))


def steps_of_joints() -> list[Told]:
    """A machine that stands on its right leg, and lifts the left one again and again."""
    steps: list[Told] = []
    for k, sample in enumerate(one for one in STEPS if isinstance(one, Sample)):
        lifted = 0.3 * max(0.0, sin(0.05 * k))
        angles = BENT + lifted, -2.0 * (BENT + lifted), BENT, -2.0 * BENT
        still = (0.0, 0.0, 0.0)
        steps.append(Joints(sample.stamp, JOINTS, angles, ()))
        steps.append(sample._replace(position=(0.0, 0.0, 0.6 * cos(BENT)), linear=still, angular=still))
    return steps


@pytest.mark.extras
def test_joints_that_the_model_does_not_know_are_left_out_and_named(tmp_path: Path, modelled: Scene) -> None:
    def with_arm(_: int, one: Any) -> Any:
        if isinstance(one, Joints):
            # What is not used may be unknown.
            return one._replace(names=("arm", *one.names, "gripper"), positions=(9.0, *one.positions, float("nan")))
        return one

    plain = replayed(tmp_path, modelled, steps=steps_of_joints())
    assert (plain.notes, plain.unpredictable) == ((), "")
    assert len(plain.settled) >= 2
    more = replayed(tmp_path, modelled, with_arm, steps_of_joints())
    assert [settled.score for settled in more.settled] == [settled.score for settled in plain.settled]
    (note,) = more.notes
    assert "/joint_states: robot.urdf does not know arm, gripper, so what is told of these joints is left out" in note


def test_a_delay_that_is_to_be_found_is_told_whether_there_is_one_or_not(tmp_path: Path) -> None:
    (note,) = replayed(tmp_path, Scene.from_parameters(validate({**GIVEN, "feet.find_delay": True}))).notes
    assert re.search(r"the feet are (not yet known to be late|.* than the trunk: 0\.0 ms are taken out)$", note)


@pytest.mark.extras
@pytest.mark.parametrize(("pressed", "confirmed"), [(200.0, True), (20.0, False), (None, None)])
def test_efforts_of_the_joints_confirm_a_landing_and_are_named_where_they_are_missing(
    tmp_path: Path, modelled: Scene, pressed: float | None, confirmed: bool | None
) -> None:
    assert modelled.walking is not None
    asked = modelled._replace(walking=modelled.walking._replace(force=50.0, force_source="effort"))

    def loaded(_: int, one: Any) -> Any:
        if isinstance(one, Joints) and pressed is not None:
            # A force straight up from the foot below the hip works on the knee alone, which is 0.3 sin q before it.
            stands = one.positions[0] == BENT
            return one._replace(efforts=(0.0, 0.3 * sin(BENT) * (pressed if stands else 0.0), 0.0, 0.0))
        return one

    found = replayed(tmp_path, asked, loaded, steps_of_joints())
    assert {one.score.landing.confirmed for one in found.settled if one.score.landing is not None} == {confirmed}
    lacks = "joint_states lacks the effort of a joint of robot.urdf, so that nothing confirms that feet stand"
    assert any(lacks in note for note in found.notes) is (pressed is None)


@pytest.mark.extras
def test_joints_that_are_missing_are_named(tmp_path: Path, modelled: Scene) -> None:
    def renamed(_: int, one: Any) -> Any:
        if isinstance(one, Joints):
            return one._replace(names=tuple(name.replace("knee", "elbow") for name in one.names))
        return one

    assert (
        "400 of 400 messages on /joint_states are WRONG_JOINTS: it lacks left_knee, right_knee of robot.urdf, while "
        "robot.urdf does not know its left_elbow, right_elbow: tell every joint of the model by its name there"
    ) in replayed(tmp_path, modelled, renamed, steps_of_joints()).unpredictable


@pytest.mark.extras
def test_a_joint_in_degrees_is_named(tmp_path: Path, modelled: Scene) -> None:
    def in_degrees(_: int, one: Any) -> Any:
        return one._replace(positions=tuple(map(degrees, one.positions))) if isinstance(one, Joints) else one

    found = replayed(tmp_path, modelled, in_degrees, steps_of_joints())
    assert any("but robot.urdf lets it go from" in note for note in found.notes)
    assert not any("but robot.urdf" in note for note in replayed(tmp_path, modelled, steps=steps_of_joints()).notes)
