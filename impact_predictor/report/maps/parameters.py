"""The bodies of which maps are drawn, and the parameters that may be their axes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf, pi
from typing import Any, Final, NamedTuple

from ...errors import InputError
from ...mechanics.bodies import cylinder, plate, refuse, rod
from ...mechanics.types import Twist, TwoPointBody

OMEGA: Final = -1.0
"""Angular velocity before the impact (rad/s); without a slip the mode does not depend on it."""

Values = Mapping[str, Any]
"""Parameters by name: numbers, or arrays that broadcast."""


class Parameter(NamedTuple):
    """A parameter: its symbol in the picture, unit and meaning; its value, or what it follows, unless given.

    `together` is its meaning where another parameter follows it.
    """

    symbol: str
    unit: str
    meaning: str
    default: float | None = None
    otherwise: str = ""
    together: str = ""


class Axis(NamedTuple):
    """A parameter along an axis of the map, from `low` to `high`."""

    name: str
    low: float
    high: float


class Subject(NamedTuple):
    """A body of which maps are drawn, and what its map shows unless something else is asked for."""

    parameters: dict[str, Parameter]
    x: Axis
    y: Axis
    build: Callable[[Values], TwoPointBody]


CONTACTS: Final = {
    "friction": Parameter("f", "", "friction coefficient of both contacts", 0.5),
    "friction_old": Parameter("f_A", "", "friction coefficient of the old contact A", None, "friction"),
    "friction_new": Parameter("f_B", "", "friction coefficient of the new contact B", None, "friction"),
    "restitution": Parameter("e", "", "restitution at the new contact B", 0.0),
    "slip": Parameter("v_{tA}", "m/s", "slip of the old contact A before the impact, at ω = −1 rad/s", 0.0),
}


def plate_of(values: Values) -> TwoPointBody:
    length = values["length"]
    height = values["height"] if "height" in values else values["delta"] * length
    inertia, a, b = (values.get(name) for name in ("inertia", "a", "b"))
    return plate(length, height, 1.0, values.get("friction", 0.0), inertia, a, b, values["restitution"])


def rod_of(values: Values) -> TwoPointBody:
    length, thickness, a = (values[name] for name in ("length", "thickness", "a"))
    inertia, b = values.get("inertia"), values.get("b", a)
    return rod(length, thickness, a, b, 1.0, values.get("friction", 0.0), inertia, values["restitution"])


def cylinder_of(values: Values) -> TwoPointBody:
    ahead = values.get("gamma_new", values["gamma"])
    refuse(
        {"gamma + gamma-new": values["gamma"] + ahead},
        lambda value: (value > 0.0) & (value < 180.0),
        "angles in degrees with a sum between 0 and 180",
    )
    return cylinder(
        values["radius"],
        values["gamma"] * (pi / 180.0),
        1.0,
        values.get("friction", 0.0),
        ahead * (pi / 180.0),
        values.get("inertia"),
        values["restitution"],
    )


def inertia_of(otherwise: str) -> Parameter:
    return Parameter("J/m", "m²", "inertia about the mass centre by mass", None, otherwise)


SUBJECTS: Final = {
    "plate": Subject(
        {
            "delta": Parameter("δ = H/L", "", "height by length", 1.0),
            "length": Parameter("L", "m", "length", 1.0),
            "height": Parameter("H", "m", "height, in the place of δ"),
            "a": Parameter("a", "m", "distance of the old contact A behind the mass centre", None, "L/2"),
            "b": Parameter("b", "m", "distance of the new contact B ahead of the mass centre", None, "L/2"),
            "inertia": inertia_of("(L² + H²)/12"),
            **CONTACTS,
        },
        Axis("delta", 0.0, 2.0),
        Axis("friction", 0.0, 1.5),
        plate_of,
    ),
    "rod": Subject(
        {
            "length": Parameter("l", "m", "length", 0.4),
            "thickness": Parameter("h", "m", "thickness", 0.005),
            "a": Parameter(
                "a",
                "m",
                "distance of the old support A behind the middle",
                0.1,
                together="distance of the supports from the middle",
            ),
            "b": Parameter("b", "m", "distance of the new support B ahead of the middle", None, "a"),
            "inertia": inertia_of("l²/12"),
            **CONTACTS,
        },
        Axis("a", 0.0, 0.2),
        Axis("friction", 0.0, 0.05),
        rod_of,
    ),
    "cylinder": Subject(
        {
            "gamma": Parameter(
                "γ_1",
                "°",
                "central angle of the old edge A behind the vertical",
                45.0,
                together="central angle γ of each edge from the vertical",
            ),
            "gamma_new": Parameter("γ_2", "°", "central angle of the new edge B ahead of it", None, "gamma"),
            "radius": Parameter("R", "m", "radius", 1.0),
            "inertia": inertia_of("R²/2"),
            **CONTACTS,
        },
        Axis("gamma", 0.0, 90.0),
        Axis("friction", 0.0, 1.5),
        cylinder_of,
    ),
}


def fixed_values(subject: Subject, axes: tuple[Axis, Axis], given: Mapping[str, float]) -> dict[str, float]:
    """The parameters that are the same all over the map: as given, else their defaults.

    Raises:
        InputError: an axis is none of the parameters, or is given as a number too, or has no extent.
    """
    names = [axis.name for axis in axes]
    for axis in axes:
        if axis.name not in subject.parameters:
            allowed = ", ".join(map(option_of, subject.parameters))
            raise InputError(f"there is no parameter {axis.name!r} for an axis; give one of {allowed}")
        if axis.name in given:
            name = option_of(axis.name)
            raise InputError(f"{name} is an axis of the map and --{name} a number; leave one of them out")
        if not -inf < axis.low < axis.high < inf:
            raise InputError(
                f"the axis {option_of(axis.name)} goes from {axis.low:g} to {axis.high:g}; "
                "give two finite numbers, the lower one first"
            )
    if names[0] == names[1]:
        raise InputError(f"both axes, --x and --y, are {option_of(names[0])}; give two parameters")
    chosen = {*names, *given}
    if {"friction_old", "friction_new"} <= chosen:
        chosen.add("friction")  # it is the friction of none
    if {"delta", "height"} <= chosen:
        raise InputError("delta and height are one thing, height = delta length; leave one of them out")
    defaults = {
        name: parameter.default
        for name, parameter in subject.parameters.items()
        if parameter.default is not None and name not in chosen and not (name == "delta" and "height" in chosen)
    }
    return {name: value for name, value in {**defaults, **given}.items() if name not in names}


def problem_at(subject: Subject, values: Values) -> tuple[TwoPointBody, Twist]:
    """The body with these parameters, and its twist right before the impact.

    Raises:
        InputError: a parameter is out of its range.
    """
    body = subject.build(values)
    old, new = body.old, body.new
    assert old is not None  # each of the bodies stands on one
    for name in ("friction_old", "friction_new"):
        if name in values:
            refuse({name: values[name]}, lambda value: (value >= 0.0) & (value < inf), "a finite number, 0 or above")
    body = body._replace(
        old=old._replace(friction=values.get("friction_old", old.friction)),
        new=new._replace(friction=values.get("friction_new", new.friction)),
    )
    (nx, ny), slip, turning = old.normal, values["slip"], body.turning(OMEGA)
    refuse({"slip": slip}, lambda value: abs(value) <= 1e6, "a number of at most 1e6")
    return body, Twist(turning.vx + slip * ny, turning.vy - slip * nx, turning.omega)


def option_of(name: str) -> str:
    """The name of a parameter as it is written on the command line."""
    return name.replace("_", "-")
