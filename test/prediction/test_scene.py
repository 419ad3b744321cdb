"""The scene that parameters describe."""

from __future__ import annotations

from typing import Any

import pytest

from impact_predictor.mechanics.types import Validity
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import (
    Chock,
    Lashing,
    MovingDeck,
    Robot,
    Scene,
    Walking,
    Watching,
    Wind,
    inertia_matrix,
)

BODY = {"body.mass": 2.0, "body.inertia": [0.1, 0.2, 0.25, 0.01, 0.02, 0.03], "contact.friction": 0.4}

# Parameter, value, field of the scene, value there.
FIELDS: list[tuple[str, Any, str, Any]] = [
    ("body.mass", 3.0, "mass", 3.0),
    ("body.inertia", [0.5], "inertia", ((0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 0.5))),
    ("body.center_of_mass", [0.1, 0.2, 0.3], "center_of_mass", (0.1, 0.2, 0.3)),
    ("body.contact_points", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "points", ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))),
    ("contact.friction", 0.7, "friction", 0.7),
    ("contact.restitution", 0.2, "restitution", 0.2),
    ("contact.tolerance", 0.001, "tolerance", 0.001),
    ("contact.time", 0.002, "contact_time", 0.002),
    ("contact.stiffness", 1e5, "stiffness", 1e5),
    ("contact.most_points", 50, "most_points", 50),
    ("contact.merge", 0.003, "merge", 0.003),
    ("odom.twist", "poses", "poses", True),
    ("uncertainty.gap", 0.001, "gap_deviation", 0.001),
    ("uncertainty.law", 0.1, "law_deviation", 0.1),
    ("support.frame", "map", "frame", "map"),
    ("tf.body_frame", "base", "body_frame", "base"),
    ("support.normal", [0.0, 3.0, 4.0], "normal", (0.0, 0.6, 0.8)),
    ("support.height", -0.5, "height", -0.5),
    ("odom.twist_window", 0.01, "twist_window", 0.01),
    ("gravity", [0.1, 0.0, -1.6], "gravity", (0.1, 0.0, -1.6)),
    ("law", "total", "law", "total"),
    ("contact.stiffness", 1e5, "stiffness", 1e5),
    ("uncertainty.samples", 64, "samples", 64),
    ("uncertainty.friction", 0.03, "friction_deviation", 0.03),
    ("uncertainty.restitution", 0.05, "restitution_deviation", 0.05),
    ("margins", True, "margins", True),
    ("horizon", 0.5, "horizon", 0.5),
    ("validity.gravity_share", 0.1, "validity", Validity(gravity_share=0.1)),
    ("support.motion", "odom", "deck", MovingDeck()),
    ("source", "imu", "source", "imu"),
    ("place.position", [1.0, 2.0, 3.0], "place", (1.0, 2.0, 3.0)),
    ("place.yaw", 0.5, "yaw", 0.5),
    ("body.radius", 0.3, "radius", 0.3),
    ("support.edges", [0.0, -0.2, 0.0, 0.0, 0.2, 0.0], "edges", ((0.0, -0.2, 0.0), (0.0, 0.2, 0.0))),
    ("onset.watch", True, "watching", Watching()),
    ("lashings.points", [1.0, 2.0, 3.0], "lashings", (Lashing((1.0, 2.0, 3.0), (1.0, 5.0, 0.0), 1e4, 1e3, 1e6),)),
    ("chocks.points", [1.0, 2.0, 3.0], "chocks", (Chock((1.0, 2.0, 3.0), (0.0, 0.6, 0.8), 5e3),)),
    ("wind.pressure", 300.0, "wind", Wind(300.0, (2.0, 3.0), (0.0, 0.0, 1.0))),
    ("contact.friction_band", [0.1, 0.6], "friction_band", (0.1, 0.6)),
    ("feet.names", ["left", "right"], "walking", Walking(("left", "right"))),
]


# What else must be given with some parameters.
NEEDS: dict[str, dict[str, Any]] = {
    "source": {"onset.watch": True, "body.contact_points": [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]},
    "body.radius": {"support.edges": [0.0, -0.2, 0.0, 0.0, 0.2, 0.0]},
    "support.edges": {"body.radius": 0.3},
    "lashings.points": {
        "onset.watch": True,
        "lashings.anchors": [1.0, 5.0, 0.0],
        "lashings.msl": [1e4],
        "lashings.preload": [1e3],
        "lashings.stiffness": [1e6],
    },
    "chocks.points": {"onset.watch": True, "chocks.normals": [0.0, 3.0, 4.0], "chocks.strength": [5e3]},
    "wind.pressure": {"onset.watch": True, "wind.area": [2.0, 3.0], "wind.center": [0.0, 0.0, 1.0]},
    "contact.friction_band": {"onset.watch": True},
}


@pytest.mark.parametrize(("name", "value", "field", "expected"), FIELDS, ids=[field[0] for field in FIELDS])
def test_every_parameter_of_the_prediction_reaches_its_field(name: str, value: Any, field: str, expected: Any) -> None:
    scene = Scene.from_parameters(validate({**BODY, **NEEDS.get(name, {}), name: value}))
    assert getattr(scene, field) == expected


def test_the_validity_of_rigid_theory_has_the_contact_time_and_the_gravity_of_the_scene() -> None:
    values = {"validity.slenderness": 0.02, "contact.time": 0.002, "gravity": [0.0, 3.0, -4.0]}
    scene = Scene.from_parameters(validate({**BODY, **values}))
    assert scene.validity == Validity(slenderness=0.02, gravity=5.0, contact_time=0.002, gravity_share=0.25)


def test_no_field_of_the_scene_is_left_to_chance() -> None:
    assert {field for _, _, field, _ in FIELDS} == set(Scene._fields)


def test_the_defaults_of_the_parameters_are_those_of_the_scene() -> None:
    assert Scene.from_parameters(validate(BODY)) == Scene(2.0, inertia_matrix(BODY["body.inertia"]), 0.4)  # type: ignore[arg-type]


def test_the_feet_of_a_machine_and_its_model_reach_the_scene() -> None:
    given = {
        "feet.names": ["left", "right"],
        "feet.points": 2,
        "feet.dead_time": 0.01,
        "feet.timeout": 0.2,
        "feet.force": 30.0,
        "feet.has_schedule": True,
        "feet.friction": [0.4, 0.5],
        "feet.restitution": [0.1],
        "robot.urdf": "robot.urdf",
        "robot.frames": ["left_heel", "left_toe", "right_heel", "right_toe"],
        "robot.joints": ["hip", "knee"],
        "robot.armature": [0.1, 0.2],
        "robot.drives": "pd",
        "robot.kp": [100.0],
        "robot.kd": [1.0, 2.0],
    }
    scene = Scene.from_parameters(validate({**BODY, **given}))
    frames, joints = ("left_heel", "left_toe", "right_heel", "right_toe"), ("hip", "knee")
    robot = Robot("robot.urdf", frames, joints, (0.1, 0.2), "pd", (100.0,), (1.0, 2.0))
    expected = Walking(
        feet=("left", "right"),
        points=2,
        dead_time=0.01,
        timeout=0.2,
        force=30.0,
        has_schedule=True,
        robot=robot,
        friction=(0.4, 0.5),
        restitution=(0.1,),
    )
    assert scene.walking == expected
    assert not scene.needs_geometry  # the joints tell where the feet are
    without = {name: value for name, value in given.items() if not name.startswith("robot.")}
    assert Scene.from_parameters(validate({**BODY, **without})).needs_geometry


def test_an_inertia_of_six_numbers_has_the_diagonal_before_xy_xz_and_yz() -> None:
    assert inertia_matrix([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]) == ((1.0, 0.1, 0.2), (0.1, 2.0, 0.3), (0.2, 0.3, 3.0))
