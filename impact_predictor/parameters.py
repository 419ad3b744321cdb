"""Every ROS parameter, declared once: the node declares these, and the offline commands check files against them."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Final, NamedTuple

from .errors import InputError
from .parameter_flaws import inertia_flaw, normal_flaw, points_flaw

Value = bool | int | float | str | tuple[float, ...]


class Parameter(NamedTuple):
    """A parameter of the node.

    `kind` is the name of the type in rclpy.parameter.Parameter.Type, in small letters: bool, integer, double,
    double_array or string; `default` is None where nobody but the user can know the value. `low` and `high` bound every
    number, ends included. `flaw` looks at a value of the right type and range and says what is wrong with it, or "".
    """

    name: str
    kind: str
    default: Value | None
    unit: str
    description: str
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()
    lengths: tuple[int, ...] = ()
    flaw: Callable[[tuple[float, ...]], str] | None = None


PARAMETERS: Final[dict[str, Parameter]] = {
    parameter.name: parameter
    for parameter in (
        Parameter("body.mass", "double", None, "kg", "Mass of the body.", low=1e-9, high=1e12),
        Parameter(
            "body.inertia",
            "double_array",
            None,
            "kg m^2",
            "Inertia about the mass centre, in the axes of the body frame: ixx iyy izz ixy ixz iyz, the last "
            "three as elements of the matrix (URDF); or one number if it is the same about every axis (sphere, cube).",
            lengths=(1, 6),
            flaw=inertia_flaw,
        ),
        Parameter(
            "body.center_of_mass", "double_array", (0.0, 0.0, 0.0), "m", "Mass centre in the body frame.", lengths=(3,)
        ),
        Parameter(
            "body.contact_points",
            "double_array",
            (),
            "m",
            "Points that can touch the support, in the body frame: x y z of each, one after the other. Left out, they "
            "come from the topic contact_geometry; given, there is no such subscription.",
            flaw=points_flaw,
        ),
        Parameter(
            "contact.friction",
            "double",
            None,
            "1",
            "Coulomb friction coefficient between body and support.",
            low=0.0,
            high=100.0,
        ),
        Parameter(
            "contact.restitution",
            "double",
            0.0,
            "1",
            "Coefficient of restitution at the contact that strikes; 0 is a plastic impact.",
            low=0.0,
            high=1.0,
        ),
        Parameter(
            "contact.tolerance",
            "double",
            0.005,
            "m",
            "Gap to the support below which a point counts as touching.",
            low=0.0,
            high=1.0,
        ),
        Parameter(
            "contact.time",
            "double",
            0.005,
            "s",
            "Duration of a contact: an edge strikes as one when its ends close within it.",
            low=0.0,
            high=1.0,
        ),
        Parameter("support.frame", "string", "", "", "frame_id that odom must have; empty accepts any."),
        Parameter(
            "support.normal",
            "double_array",
            (0.0, 0.0, 1.0),
            "1",
            "Direction out of the support, in the frame of odom; of any length but zero.",
            lengths=(3,),
            flaw=normal_flaw,
        ),
        Parameter(
            "support.height", "double", 0.0, "m", "Distance of the support's plane from the origin, along its normal."
        ),
        Parameter(
            "odom.twist_window",
            "double",
            0.0,
            "s",
            "Time over which the source of odom averages its twist; 0 for a twist of the very instant.",
            low=0.0,
            high=1.0,
        ),
        Parameter(
            "gravity",
            "double_array",
            (0.0, 0.0, -9.81),
            "m/s^2",
            "Acceleration of a free body, in the frame of odom.",
            low=-1000.0,
            high=1000.0,
            lengths=(3,),
        ),
        Parameter(
            "law",
            "string",
            "path",
            "",
            "Impact law: path follows the growing impulse (Routh), total solves for the whole impulse at once.",
            choices=("path", "total"),
        ),
        Parameter(
            "transverse_slip",
            "bool",
            True,
            "",
            "Whether friction also opposes slip across the impact plane, so that a body that slips there too has less "
            "friction left in the plane. Only the law path knows it.",
        ),
        Parameter(
            "uncertainty.samples",
            "integer",
            0,
            "1",
            "How many points carry the uncertainty of a sample through its impact, 16 or more and even; 0 for none.",
            low=0,
            high=4096,
        ),
        Parameter(
            "uncertainty.friction",
            "double",
            0.0,
            "1",
            "Standard deviation of contact.friction.",
            low=0.0,
            high=100.0,
        ),
        Parameter(
            "uncertainty.restitution",
            "double",
            0.0,
            "1",
            "Standard deviation of contact.restitution.",
            low=0.0,
            high=1.0,
        ),
        Parameter(
            "margins",
            "bool",
            False,
            "",
            "Whether a prediction tells how far its impact is from another mode, in friction, geometry and slip.",
        ),
        Parameter(
            "validity.slenderness",
            "double",
            0.01,
            "1",
            "Thickness over length below which a body is flagged THIN_BODY: it bends while it strikes.",
            low=0.0,
            high=1.0,
        ),
        Parameter(
            "validity.gravity_share",
            "double",
            0.25,
            "1",
            "Part of the new contact's impulse above which gravity's during contact.time gives the flag SLOW_IMPACT.",
            low=1e-6,
            high=1e6,
        ),
        Parameter(
            "horizon", "double", 0.25, "s", "How far ahead of a sample a touchdown is looked for.", low=1e-3, high=60.0
        ),
        Parameter(
            "executor",
            "string",
            "single",
            "",
            "How the node waits for messages: single is rclpy's single-threaded executor, events its experimental one, "
            "which costs less per message.",
            choices=("single", "events"),
        ),
    )
}

_OF_EVERY_NODE: Final = ("use_sim_time", "start_type_description_service")
_QOS_OVERRIDES: Final = "qos_overrides."


def is_of_every_node(name: str) -> bool:
    """Whether a parameter belongs to ROS itself, so that it may stand beside those of this program."""
    return name in _OF_EVERY_NODE or name.startswith(_QOS_OVERRIDES)


def validate(values: Mapping[str, object]) -> dict[str, Value]:
    """The values of all parameters, with the defaults of those that are not given; lists become tuples.

    Parameters that every ROS node has are passed over.

    Raises:
        InputError: a name is unknown, a value has the wrong type or is out of range, or one without default is missing.
    """
    given = {name: value for name, value in values.items() if not is_of_every_node(name)}
    for name in given:
        if name not in PARAMETERS:
            raise InputError(f"there is no parameter {name}{_hint(name)}")
    checked: dict[str, Value] = {}
    for parameter in PARAMETERS.values():
        if parameter.name in given:
            checked[parameter.name] = _check(parameter, given[parameter.name])
        elif parameter.default is None:
            meaning = parameter.description.rstrip(".")
            raise InputError(f"the parameter {parameter.name} is missing: give {_allowed(parameter)} ({meaning})")
        else:
            checked[parameter.name] = parameter.default
    return checked


def _hint(name: str) -> str:
    close = difflib.get_close_matches(name, PARAMETERS, n=1, cutoff=0.5)
    return f", did you mean {close[0]}?" if close else f"; there are {', '.join(PARAMETERS)}"


def _check(parameter: Parameter, value: object) -> Value:
    if parameter.kind == "bool":
        if not isinstance(value, bool):
            raise _refusal(parameter, value)
        return value
    if parameter.kind == "integer":
        if not isinstance(value, int) or isinstance(value, bool) or not parameter.low <= value <= parameter.high:
            raise _refusal(parameter, value)
        return value
    if parameter.kind == "string":
        if not isinstance(value, str) or (parameter.choices and value not in parameter.choices):
            raise _refusal(parameter, value)
        return value
    if parameter.kind == "double":
        return _check_numbers(parameter, value, [value])[0]
    if isinstance(value, str | bytes) or not isinstance(value, Sequence):
        raise _refusal(parameter, value)
    numbers = _check_numbers(parameter, value, value)
    if parameter.lengths and len(numbers) not in parameter.lengths:
        raise _refusal(parameter, value)
    flaw = parameter.flaw(numbers) if parameter.flaw else ""
    if flaw:
        raise _refusal(parameter, value, flaw)
    return numbers


def _check_numbers(parameter: Parameter, value: object, numbers: Sequence[object]) -> tuple[float, ...]:
    checked = []
    for number in numbers:
        if isinstance(number, int) and not isinstance(number, bool):
            raise _refusal(
                parameter, value, f"ROS takes no integer for a double, so write {float(number)} for {number}"
            )
        if not isinstance(number, float) or not (math.isfinite(number) and parameter.low <= number <= parameter.high):
            raise _refusal(parameter, value)
        checked.append(float(number))
    return tuple(checked)


def _refusal(parameter: Parameter, value: object, flaw: str = "") -> InputError:
    shown = list(value) if isinstance(value, Sequence) and not isinstance(value, str | bytes) else value
    return InputError(f"the parameter {parameter.name} is {shown!r}, but {flaw or f'it must be {_allowed(parameter)}'}")


def _allowed(parameter: Parameter) -> str:
    """What a value may be, as the end of a sentence."""
    if parameter.choices:
        return " or ".join(repr(choice) for choice in parameter.choices)
    if parameter.kind == "bool":
        return "true or false"
    if parameter.kind == "string":
        return "a text"
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    bounds = []
    if math.isfinite(parameter.low):
        bounds.append(f"from {parameter.low:g}")
    if math.isfinite(parameter.high):
        bounds.append(f"to {parameter.high:g}")
    limits = " ".join(["", *bounds])
    if parameter.kind == "integer":
        return f"a whole number{limits}"
    if parameter.kind == "double":
        return f"a finite double{limits}{unit}"
    count = f"{' or '.join(map(str, parameter.lengths))} " if parameter.lengths else ""
    return f"a list of {count}finite doubles{limits}{unit}"
