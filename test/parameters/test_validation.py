"""The table of parameters, and the sentences for values that are not allowed."""

from __future__ import annotations

import array
import math
from typing import Any

import pytest

from impact_predictor.errors import InputError
from impact_predictor.parameters.validation import PARAMETERS, is_of_every_node, validate

NO_BODY = "no body has it: about each axis, inertia is at most the sum of that about the two axes across it"
REQUIRED: dict[str, Any] = {"body.mass": 0.37, "body.inertia": [8.1e-4], "contact.friction": 0.18}


def refusal(**values: Any) -> str:
    """What is said about values given beside the required ones; a dot in a name is written as two underscores."""
    given = {name.replace("__", "."): value for name, value in values.items()}
    with pytest.raises(InputError) as caught:
        validate({**REQUIRED, **given})
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


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


def test_every_default_is_allowed() -> None:
    defaults = {name: one.default for name, one in PARAMETERS.items() if one.default not in (None, ())}
    empty = {"body.contact_points", "bodies", "support.edges", "support.extent", "feet.names", "robot.frames"}
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


def test_an_integer_for_a_double_is_refused_as_ros_refuses_it() -> None:
    expected = "the parameter body.mass is 9, but ROS takes no integer for a double, so write 9.0 for 9"
    assert refusal(body__mass=9) == expected
    assert refusal(gravity=[0.0, 0.0, -10]).endswith("so write -10.0 for -10")


@pytest.mark.parametrize("value", [-1.0, 0.0, math.nan, math.inf, -math.inf, True, "9.0", [9.0], None])
def test_a_mass_is_a_positive_finite_double(value: object) -> None:
    assert refusal(body__mass=value) == (
        f"the parameter body.mass is {value!r}, but it must be a finite double from 1e-09 to 1e+12 kg"
    )


def test_the_sentence_about_an_unknown_name_stays_one_line_whatever_the_name_is() -> None:
    for name in ("a\nb", "", "a\0b"):
        with pytest.raises(InputError) as error:
            validate({**REQUIRED, name: 1.0})
        assert str(error.value).startswith(f"there is no parameter {name!r}")
        assert str(error.value).isprintable()


def test_lengths_are_those_of_something_on_earth() -> None:
    assert refusal(body__center_of_mass=[0.0, 0.0, 1e200]).endswith("list of 3 finite doubles from -1e+09 to 1e+09 m")
    assert "but it must be" in refusal(support__height=-1e200)


def test_a_friction_is_not_negative_and_a_restitution_at_most_one() -> None:
    assert refusal(contact__friction=-0.1).endswith("but it must be a finite double from 0 to 100")
    assert refusal(contact__restitution=1.01).endswith("but it must be a finite double from 0 to 1")
    validate({**REQUIRED, "contact.friction": 0.0, "contact.restitution": 1.0})


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
    assert refusal(body__inertia=value) == f"the parameter body.inertia is {value!r}, but {why}"


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


def test_a_horizon_reaches_ahead() -> None:
    assert refusal(horizon=0.0).endswith("but it must be a finite double from 0.001 to 60 s")


@pytest.mark.parametrize(
    ("value", "why"),
    [
        ([1.0, 2.0, 3.0, 4.0], "it must have three numbers for each point, not 4 in all"),
        ([1.0, 2.0, 3.0], "a body needs at least two contact points"),
        ([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0], "the points 0 and 2 coincide"),
    ],
)
def test_contact_points_are_at_least_two_and_apart(value: list[float], why: str) -> None:
    assert refusal(body__contact_points=value) == f"the parameter body.contact_points is {value!r}, but {why}"


def test_a_normal_has_a_direction() -> None:
    assert refusal(support__normal=[0.0, 0.0, 0.0]).endswith("but it must have a direction")
    validate({**REQUIRED, "support.normal": [0.0, 3.0, 4.0]})


def test_a_text_is_one_of_its_choices() -> None:
    assert refusal(law="pth") == "the parameter law is 'pth', but it must be 'path' or 'total'"
    assert refusal(law=1) == "the parameter law is 1, but it must be 'path' or 'total'"
    assert refusal(executor="multi").endswith("it must be 'single' or 'events'")
    assert refusal(support__frame=5).endswith("but it must be a text")
    assert refusal(source="lidar").endswith("but it must be 'odom', 'imu' or 'none'")


@pytest.mark.parametrize("value", [1, 0.0, "true", [True], None])
def test_a_switch_is_true_or_false(value: object) -> None:
    assert refusal(transverse_slip=value) == f"the parameter transverse_slip is {value!r}, but it must be true or false"
    assert validate({**REQUIRED, "transverse_slip": False})["transverse_slip"] is False


@pytest.mark.parametrize("value", [-1, 4097, 64.0, True, "64", [64], None])
def test_a_count_is_a_whole_number(value: object) -> None:
    assert refusal(uncertainty__samples=value) == (
        f"the parameter uncertainty.samples is {value!r}, but it must be a whole number from 0 to 4096"
    )
    assert validate({**REQUIRED, "uncertainty.samples": 64})["uncertainty.samples"] == 64


def test_an_unknown_name_is_answered_with_the_nearest_one() -> None:
    assert refusal(body__masss=1.0) == "there is no parameter body.masss, did you mean body.mass?"
    assert refusal(friction=1.0) == "there is no parameter friction, did you mean contact.friction?"


def test_a_name_like_no_other_is_answered_with_all_of_them() -> None:
    assert refusal(zzz=1.0) == f"there is no parameter zzz; there are {', '.join(PARAMETERS)}"


def test_parameters_of_every_node_are_passed_over() -> None:
    of_ros = {
        "use_sim_time": True,
        "qos_overrides./odom.subscription.depth": 5,
        "start_type_description_service": False,
    }
    assert all(is_of_every_node(name) for name in of_ros)
    assert validate({**REQUIRED, **of_ros}) == validate(REQUIRED)
