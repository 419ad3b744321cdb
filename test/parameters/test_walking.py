"""Parameters of machines that walk: what their feet and their model need, and what does not fit together."""

from __future__ import annotations

from typing import Any

import pytest

from impact_predictor.errors import InputError
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import scenes_of

BODY: dict[str, Any] = {"body.mass": 83.0, "body.inertia": [5.0], "contact.friction": 0.7}
FEET: dict[str, Any] = {**BODY, "feet.names": ["left", "right"]}
POINTS = [0.0, 0.1, -0.5, 0.0, -0.1, -0.5]


def refusal(given: dict[str, Any]) -> str:
    with pytest.raises(InputError) as caught:
        validate(given)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("source", "none", "source is none, but feet.names makes the body a machine that walks, and its pose and "),
        ("support.motion", "odom", "support.motion is odom, but feet.names makes the body a machine that walks, and "),
        ("body.radius", 0.3, "body.radius is 0.3, but feet.names makes the body a machine that walks, and it touches "),
        ("onset.watch", True, "onset.watch is true, but feet.names makes the body a machine that walks, and it is "),
        ("margins", True, "margins is true, but feet.names makes the body a machine that walks, and the margins of "),
        ("odom.twist_window", 0.01, "odom.twist_window is 0.01, but feet.names makes the body a machine that walks"),
        ("uncertainty.samples", 64, "uncertainty.samples is 64, but feet.names makes the body a machine that walks"),
    ],
)
def test_what_a_machine_that_walks_does_not_have_is_refused_with_what_to_give(name: str, value: Any, said: str) -> None:
    sentence = refusal({**FEET, name: value})
    assert sentence.startswith(said)
    assert ": give " in sentence


def test_points_that_move_are_no_parameters_but_those_of_the_other_bodies_may_be() -> None:
    assert refusal({**FEET, "body.contact_points": POINTS}) == (
        "body.contact_points and feet.names are both given: feet move, so their points come with messages"
    )
    both = {**BODY, "bodies": ["crate", "walker"], "body.contact_points": POINTS, "walker.feet.names": ["one"]}
    scenes = scenes_of(validate(both))
    assert [len(scene.points) for scene in scenes.values()] == [2, 0]
    assert [scene.walking is not None for scene in scenes.values()] == [False, True]
    assert refusal({**both, "walker.onset.watch": True}).startswith(
        "walker.onset.watch is true, but walker.feet.names makes the body of walker a machine that walks"
    )


@pytest.mark.parametrize(
    ("name", "value"), [("feet.points", 2), ("feet.force", 30.0), ("feet.has_schedule", True), ("robot.urdf", "a.urdf")]
)
def test_feet_have_names(name: str, value: Any) -> None:
    assert refusal({**BODY, name: value}) == (
        f"{name} is for a machine that walks: give the names of its feet as feet.names"
    )
    validate({**BODY, "bodies": ["crate", "walker"], name: value, "walker.feet.names": ["a"], "robot.frames": ["a"]})


def test_names_of_feet_are_there_once_and_not_empty() -> None:
    assert refusal({**BODY, "feet.names": ["a", "b", "a"]}).endswith("but 'a' is there twice")
    assert refusal({**BODY, "feet.names": ["a", ""]}).endswith("but a name is empty")
    assert refusal({**FEET, "robot.urdf": "a.urdf", "robot.frames": ["a", "a"]}).endswith("but 'a' is there twice")
    validate({**BODY, "feet.names": ["left foot", "LF_FOOT-1"]})


def test_a_machine_whose_model_tells_its_mass_needs_neither_mass_nor_inertia() -> None:
    model = {"contact.friction": 0.7, "feet.names": ["foot"], "robot.urdf": "robot.urdf", "robot.frames": ["sole"]}
    values = validate(model)
    assert "body.mass" not in values
    assert "body.inertia" not in values
    assert validate({**model, "body.mass": 3.0})["body.mass"] == 3.0
    assert validate({name: value for name, value in values.items() if value not in ((), "")}) == values
    assert "body.mass is missing" in refusal({**model, "robot.urdf": ""})
    several = {**{f"dog.{name}": value for name, value in model.items()}, "bodies": ["dog", "crate"]}
    assert "or crate.body.mass for crate alone" in refusal({**several, "crate.contact.friction": 0.2})


def test_a_model_has_a_frame_for_each_point_of_each_foot() -> None:
    frames = ["a", "b", "c"]
    assert refusal({**FEET, "robot.urdf": "a.urdf", "robot.frames": frames}) == (
        "robot.frames has 3 names, but feet.names has 2 and feet.points is 1: give one frame for each point of each "
        "foot"
    )
    assert refusal({**FEET, "robot.urdf": "a.urdf"}).startswith("robot.frames has 0 names, but")
    assert refusal({**FEET, "robot.frames": frames}) == (
        "robot.frames are frames of a model: give its file as robot.urdf"
    )
    validate({**FEET, "feet.points": 2, "robot.urdf": "a.urdf", "robot.frames": [*frames, "d"]})
