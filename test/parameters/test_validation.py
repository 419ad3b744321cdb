"""The table of parameters, and the sentences for values that are not allowed."""

from __future__ import annotations

import array
import math
from pathlib import Path
from typing import Any

import pytest

from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_values
from impact_predictor.parameters.types import Parameter, allowed
from impact_predictor.parameters.validation import PARAMETERS, foreign, is_of_every_node, validate

NO_BODY = "no body has it: about each axis, inertia is at most the sum of that about the two axes across it"
REQUIRED: dict[str, Any] = {"body.mass": 0.37, "body.inertia": [8.1e-4], "contact.friction": 0.18}


def refusal(**values: Any) -> str:
    """What is said about values given beside the required ones."""
    with pytest.raises(InputError) as caught:
        validate({**REQUIRED, **values})
    assert str(caught.value).isprintable()
    return str(caught.value)


def test_what_is_not_given_has_its_default() -> None:
    values = validate(REQUIRED)
    assert list(values) == list(PARAMETERS)
    defaults = {name: parameter.default for name, parameter in PARAMETERS.items() if name not in REQUIRED}
    assert values == {**REQUIRED, "body.inertia": (8.1e-4,), **defaults}


def test_every_parameter_is_declared_so_that_a_node_can_declare_it() -> None:
    for name, parameter in PARAMETERS.items():
        assert parameter.name == name
        assert parameter.kind in ("bool", "integer", "double", "double_array", "string", "string_array")
        assert parameter.description.endswith(".")
        assert parameter.low < parameter.high
        assert bool(parameter.unit) == (parameter.kind not in ("bool", "string", "string_array"))


def test_types_defaults_and_ranges_are_those_that_users_rely_on() -> None:
    kept = (Path(__file__).parent / "contract.txt").read_text().splitlines()
    assert [contract(parameter) for parameter in PARAMETERS.values()] == kept


def contract(parameter: Parameter) -> str:
    """What a scene that is written today relies on."""
    words = [f"{parameter.name} = {parameter.default!r}:", allowed(parameter)]
    words += ["shared"] * parameter.shared + ["fixed"] * bool(parameter.fixed) + ["of model"] * parameter.of_model
    return " ".join(words)


def test_every_default_is_allowed() -> None:
    defaults = {name: one.default for name, one in PARAMETERS.items() if one.default not in (None, ())}
    empty = {"body.contact_points", "bodies", "support.edges", "support.extent", "feet.names", "robot.frames"}
    empty |= {
        "feet.friction",
        "feet.restitution",
        "feet.radius",
        "robot.joints",
        "robot.armature",
        "robot.kp",
        "robot.kd",
        "contact.friction_band",
        "lashings.points",
        "lashings.anchors",
        "lashings.msl",
        "lashings.preload",
        "lashings.stiffness",
        "chocks.points",
        "chocks.normals",
        "chocks.strength",
        "wind.area",
        "robot.soles",
    }
    assert set(PARAMETERS) - set(defaults) == {*REQUIRED, *empty}
    validate({**REQUIRED, **defaults})


@pytest.mark.parametrize("name", list(REQUIRED))
def test_what_nobody_else_can_know_must_be_given(name: str) -> None:
    with pytest.raises(InputError, match=f"^the parameter {name} is missing: give a ") as caught:
        validate({key: value for key, value in REQUIRED.items() if key != name})
    assert "\n" not in str(caught.value)


def test_lists_become_tuples_whatever_holds_them() -> None:
    for gravity in ([0.0, 0.0, -1.62], (0.0, 0.0, -1.62), array.array("d", [0.0, 0.0, -1.62])):
        assert validate({**REQUIRED, "gravity": gravity})["gravity"] == (0.0, 0.0, -1.62)


NEITHER = (None, "9.0", [9.0])
OUT_OF_RANGE: list[tuple[str, tuple[object, ...], str]] = [
    ("body.mass", (-1.0, 0.0, math.nan, math.inf, -math.inf, True, *NEITHER), "a finite double from 1e-09 to 1e+12 kg"),
    ("body.center_of_mass", ([0.0, 0.0, 1e200], [0.0, 0.0]), "a list of 3 finite doubles from -1e+09 to 1e+09 m"),
    ("support.height", (-1e200,), "a finite double from -1e+09 to 1e+09 m"),
    ("contact.friction", (-0.1, 101.0), "a finite double from 0 to 100"),
    ("contact.restitution", (-0.1, 1.01), "a finite double from 0 to 1"),
    ("horizon", (0.0,), "a finite double from 0.001 to 60 s"),
    ("uncertainty.samples", (-1, 4097, 64.0, True, *NEITHER), "a whole number from 0 to 4096"),
    ("margins", (1, 0.0, "true", [True], None), "true or false"),
    ("law", ("pth", 1), "'path' or 'total'"),
    ("executor", ("multi",), "'single' or 'events'"),
    ("source", ("lidar",), "'odom', 'imu' or 'none'"),
    ("support.frame", (5,), "a text"),
]


@pytest.mark.parametrize(("name", "values", "allowed"), OUT_OF_RANGE, ids=[name for name, _, _ in OUT_OF_RANGE])
def test_a_value_that_is_not_allowed_is_told_with_those_that_are(
    name: str, values: tuple[object, ...], allowed: str
) -> None:
    for value in values:
        assert refusal(**{name: value}) == f"the parameter {name} is {value!r}, but it must be {allowed}"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"body.mass": 9}, "the parameter body.mass is 9, but ROS takes no integer for a double, so write 9.0 for 9"),
        ({"gravity": [0.0, 0.0, -10]}, "so write -10.0 for -10"),
        ({"body.mass": 10**400}, "so write 1000"),
        ({"uncertainty.samples": 10**400}, "but it must be a whole number from"),
        ({"support.normal": [0.0, 0.0, 0.0]}, "but it must have a direction"),
        ({"body.masss": 1.0}, "there is no parameter body.masss, did you mean body.mass?"),
        ({"friction": 1.0}, "there is no parameter friction, did you mean contact.friction?"),
        ({"transverse_slip": False}, "there is no parameter transverse_slip any more: friction opposes the whole slip"),
        ({"body.zzz": 1.0}, "there is no parameter body.zzz"),
        ({"crate.horizon": 0.1}, "there is no parameter crate.horizon, for bodies is not given"),
        # One line, whatever the name is.
        *[({name: 1.0}, f"there is no parameter {name!r}") for name in ("a\nb", "", "a\0b")],
    ],
)
def test_a_wrong_name_or_value_is_told_in_one_sentence(given: dict[str, Any], said: str) -> None:
    assert said in refusal(**given)


@pytest.mark.parametrize(
    ("value", "why"),
    [
        ([0.0], "it must be positive"),
        ([-1.0], "it must be positive"),
        ([1.0, 1.0, -1.0, 0.0, 0.0, 0.0], "its matrix must be positive definite"),
        ([1.0, 1.0, 1.0, 1.0, 0.0, 0.0], "its matrix must be positive definite"),
        ([1.0, 1.0, 1.0, 0.7, 0.7, -0.7], "its matrix must be positive definite"),
        ([1.0, 1.0, 3.0, 0.0, 0.0, 0.0], NO_BODY),
        ([3.0, 1.0, 1.0, 0.0, 0.0, 0.0], NO_BODY),
        ([1.0, 1.0, 1.0, 0.6, 0.0, 0.0], NO_BODY),  # its principal moments are 0.4, 1.0 and 1.6
        ([1.0, 1.0, 1.0, 0.4, 0.4, 0.4], NO_BODY),  # 0.6, 0.6 and 1.8
        ([1e-60], "it must be at least 1e-30 kg m^2"),
        ([1e-60, 1e-60, 1e-60, 0.0, 0.0, 0.0], "it must be at least 1e-30 kg m^2"),
        ([1e60], "it must be at most 1e+30 kg m^2"),
        ([1.0, 1.0, 1.0], "it must be a list of 1 or 6 finite doubles kg m^2"),
        ([], "it must be a list of 1 or 6 finite doubles kg m^2"),
        ([math.nan], "it must be a list of 1 or 6 finite doubles kg m^2"),
        (8.1e-4, "it must be a list of 1 or 6 finite doubles kg m^2"),
        ("8.1e-4", "it must be a list of 1 or 6 finite doubles kg m^2"),
    ],
)
def test_an_inertia_is_that_of_a_body(value: object, why: str) -> None:
    assert refusal(**{"body.inertia": value}) == f"the parameter body.inertia is {value!r}, but {why}"


@pytest.mark.parametrize(
    "inertia",
    [
        [1.0, 1.1, 1.2, 0.3, -0.2, 0.1],
        [1.0, 1.0, 1.0, 0.4, 0.4, -0.4],  # its principal moments are 0.2, 1.4 and 1.4
        [1.0, 1.0, 2.0, 0.0, 0.0, 0.0],  # a thin plate
        [0.0833, 0.0833, 0.167, 0.0, 0.0, 0.0],  # a thin plate, rounded
    ],
)
def test_an_inertia_of_a_body_is_allowed_with_products_and_rounded(inertia: list[float]) -> None:
    assert validate({**REQUIRED, "body.inertia": inertia})["body.inertia"] == tuple(inertia)


@pytest.mark.parametrize(
    ("value", "why"),
    [
        ([1.0, 2.0, 3.0, 4.0], "it must have three numbers for each point, not 4 in all"),
        ([1.0, 2.0, 3.0], "a body needs at least two contact points"),
        ([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0], "the points 0 and 2 coincide"),
    ],
)
def test_contact_points_are_at_least_two_and_apart(value: list[float], why: str) -> None:
    assert refusal(**{"body.contact_points": value}) == f"the parameter body.contact_points is {value!r}, but {why}"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("contact.friction", 0.0), ("contact.restitution", 1.0), ("support.normal", (0.0, 3.0, 4.0))),
        *(("margins", False), ("uncertainty.samples", 64)),
    ],
)
def test_the_ends_of_a_range_and_what_has_a_direction_are_allowed(name: str, value: object) -> None:
    assert validate({**REQUIRED, name: value})[name] == value


def test_parameters_of_every_node_are_passed_over() -> None:
    of_ros = {
        "use_sim_time": True,
        "qos_overrides./odom.subscription.depth": 5,
        "start_type_description_service": False,
    }
    assert all(is_of_every_node(name) for name in of_ros)
    assert validate({**REQUIRED, **of_ros}) == validate(REQUIRED)


@pytest.mark.parametrize(
    "name", ["zzz", "controller.gains.p", "FollowPath.max_vel_x", "robot_description", "use_gpu", "camera_name"]
)
def test_a_parameter_of_another_node_in_a_shared_file_is_passed_over(name: str) -> None:
    others = {**REQUIRED, name: 1.0, "use_sim_time": True}
    assert foreign(others) == [name]
    assert validate(others) == validate(REQUIRED)


def test_a_file_that_is_shared_with_another_node_is_read_with_a_note(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    scene = tmp_path / "scene.yaml"
    given = "controller: {p: 2.0}, body: {mass: 1.0, inertia: [1.0]}, contact: {friction: 0.5}"
    scene.write_text(f"/**:\n  ros__parameters: {{{given}}}\n")
    assert read_values(scene)["body.mass"] == 1.0
    assert caplog.messages == [f"note: controller.p of {scene} is no parameter of impact_predictor, and passed over"]
