"""Parameters, which values they may have, and what is wrong with a value: a part of a sentence, or ""."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final, NamedTuple

from ..errors import InputError

FURTHEST: Final = 1e9
"""m: nothing that is predicted is larger or further away, and squares of it are numbers that can be added."""

Value = bool | int | float | str | tuple[float, ...] | tuple[str, ...]


class Parameter(NamedTuple):
    """A parameter of the node.

    `kind` is the name of the type in rclpy.parameter.Parameter.Type, in small letters: bool, integer, double,
    double_array, string or string_array; `default` is None where nobody but the user can know the value. `low` and
    `high` bound every number, ends included. `flaw` looks at a list of the right type and range and says what is wrong
    with it, or "". One that is `shared` holds for all bodies; any other may be given for each. `fixed` says why it
    cannot change while the node runs, "" where it can. A machine whose model is known does without one `of_model`.
    """

    kind: str
    name: str
    default: Value | None
    description: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()
    lengths: tuple[int, ...] = ()
    flaw: Callable[[tuple[float, ...]], str] | Callable[[tuple[str, ...]], str] | None = None
    shared: bool = False
    fixed: str = ""
    of_model: bool = False


boolean = partial(Parameter, "bool")
integer = partial(Parameter, "integer")
double = partial(Parameter, "double")
doubles = partial(Parameter, "double_array")
metres = partial(Parameter, "double_array", unit="m", low=-FURTHEST, high=FURTHEST)
ratio = partial(Parameter, "double", unit="1", low=0.0)
seconds = partial(Parameter, "double", unit="s", low=0.0)
text = partial(Parameter, "string")
texts = partial(Parameter, "string_array")

TOPICS: Final = "the topics follow from it"
SUPPORT: Final = "all that is known of the support rests on it"
BEGINNING: Final = "it tells where the body began"
COMPUTED: Final = "what is computed and loaded follows from it"
EXECUTOR: Final = "messages are waited for by it"


def newtons(name: str, description: str, unit: str = "N") -> Parameter:
    """A load for each of several things, or one for all."""
    return Parameter("double_array", name, (), description, unit, 0.0, 1e12, fixed=COMPUTED)


def places(name: str, description: str, unit: str = "m") -> Parameter:
    """Points or directions, x y z of each."""
    bounds = -FURTHEST, FURTHEST
    return Parameter("double_array", name, (), description, unit, *bounds, flaw=threes_flaw, fixed=COMPUTED)


def values_of(values: Mapping[str, Any], body: str) -> dict[str, Any]:
    """The values that hold for one body of validated ones: its own, and the common ones."""
    prefix = f"{body}."
    own = {name.removeprefix(prefix): value for name, value in values.items() if body and name.startswith(prefix)}
    return {**values, **own}


_TYPES: Final[dict[str, type]] = {"bool": bool, "integer": int, "double": float, "string": str}


def check(parameter: Parameter, value: object) -> Value:
    """The value of a parameter, a list as a tuple; InputError where it has the wrong type, is out of range, or has a
    flaw.
    """
    kind, is_list = parameter.kind.removesuffix("_array"), parameter.kind.endswith("_array")
    is_sequence = isinstance(value, Sequence) and not isinstance(value, str | bytes)
    items: Any = tuple(value) if is_list and is_sequence else (value,)  # type: ignore[arg-type]
    flaw = "" if is_list <= is_sequence else f"it must be {allowed(parameter)}"
    for item in items:
        flaw = flaw or _flaw(parameter, kind, item)
    if not flaw and parameter.lengths and len(items) not in parameter.lengths:
        flaw = f"it must be {allowed(parameter)}"
    if not flaw and parameter.flaw:
        flaw = parameter.flaw(items)
    if flaw:
        shown = list(value) if is_sequence else value  # type: ignore[call-overload]
        raise InputError(f"the parameter {parameter.name} is {shown!r}, but {flaw}")
    if kind == "double":
        items = tuple(map(float, items))
    return items if is_list else items[0]  # type: ignore[no-any-return]


def _flaw(parameter: Parameter, kind: str, item: Any) -> str:
    """What is wrong with one value, or one of a list, or ""."""
    is_whole = isinstance(item, int) and not isinstance(item, bool)
    if kind == "double" and is_whole:
        return f"ROS takes no integer for a double, so write {item}.0 for {item}"
    fits = is_whole if kind == "integer" else isinstance(item, _TYPES[kind])
    if fits and kind in ("integer", "double"):
        fits = parameter.low <= item <= parameter.high and abs(item) < math.inf
    elif fits and parameter.choices:
        fits = item in parameter.choices
    return "" if fits else f"it must be {allowed(parameter)}"


def allowed(parameter: Parameter) -> str:
    """What a value may be, as the end of a sentence."""
    if parameter.choices:
        *others, last = map(repr, parameter.choices)
        return f"{', '.join(others)} or {last}"
    count = f"{' or '.join(map(str, parameter.lengths))} " if parameter.lengths else ""
    words = {
        "bool": "true or false",
        "string": "a text",
        "string_array": "a list of texts",
        "integer": "a whole number",
        "double": "a finite double",
        "double_array": f"a list of {count}finite doubles",
    }[parameter.kind]
    low = f" from {parameter.low:g}" if math.isfinite(parameter.low) else ""
    high = f" to {parameter.high:g}" if math.isfinite(parameter.high) else ""
    return f"{words}{low}{high}" + (f" {parameter.unit}" if parameter.unit not in ("", "1") else "")


ROUNDED: Final = 0.01
"""By this part of its trace an inertia may miss the triangle inequality: thin plates are given with few digits."""

_PART_OF_A_NAME: Final = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*")
"""No two underscores in a row: ROS keeps those for itself."""

SIZES_OF_INERTIA: Final = (1e-30, 1e30)
"""kg m^2: of a grain of dust and of a moon; products of three still are numbers."""


def inertia_flaw(inertia: tuple[float, ...]) -> str:
    """Of one number, or of ixx, iyy, izz, ixy, ixz, iyz (kg m^2)."""
    least, greatest = SIZES_OF_INERTIA
    if max(inertia) > greatest:
        return f"it must be at most {greatest:g} kg m^2"
    moments = [inertia[0]] * 3
    if len(inertia) > 1:
        from numpy.linalg import eigvalsh

        xx, yy, zz, xy, xz, yz = inertia
        moments = [float(moment) for moment in eigvalsh([(xx, xy, xz), (xy, yy, yz), (xz, yz, zz)])]
    if not moments[0] > 0.0:
        return "its matrix must be positive definite" if len(inertia) > 1 else "it must be positive"
    if moments[2] > (0.5 + ROUNDED) * (moments[0] + moments[1] + moments[2]):
        return "no body has it: about each axis, inertia is at most the sum of that about the two axes across it"
    return "" if moments[0] >= least else f"it must be at least {least:g} kg m^2"


def points_flaw(numbers: tuple[float, ...]) -> str:
    """Of contact points, x y z of each (m)."""
    if len(numbers) % 3:
        return f"it must have three numbers for each point, not {len(numbers)} in all"
    points = [numbers[k : k + 3] for k in range(0, len(numbers), 3)]
    if len(points) == 1:
        return "a body needs at least two contact points"
    places = {point: k for k, point in reversed(list(enumerate(points)))}
    twins = (f"the points {places[point]} and {k} coincide" for k, point in enumerate(points) if places[point] != k)
    return next(twins, "")


def threes_flaw(numbers: tuple[float, ...]) -> str:
    """Of points or directions, x y z of each."""
    return f"it must have three numbers for each, not {len(numbers)} in all" if len(numbers) % 3 else ""


def normal_flaw(normal: tuple[float, ...]) -> str:
    """Of a direction."""
    return "" if 0.0 < math.hypot(*normal) < math.inf else "it must have a direction"


def edges_flaw(numbers: tuple[float, ...]) -> str:
    """Of two edges, x y z of a point of each (m)."""
    return "the two edges coincide" if numbers[:3] == numbers[3:] else ""


def extent_flaw(extent: tuple[float, ...]) -> str:
    """Of a rectangle: least x, greatest x, least y, greatest y (m)."""
    least_x, greatest_x, least_y, greatest_y = extent
    return "" if least_x < greatest_x and least_y < greatest_y else "each least must be below its greatest"


def names_flaw(names: tuple[str, ...]) -> str:
    """Of the names of bodies, which become parts of the names of topics."""
    for name in names:
        if not _PART_OF_A_NAME.fullmatch(name):
            return (
                f"{name!r} is no part of a ROS name: take letters, digits and single underscores, and begin and end "
                "with a letter or a digit, the first one a letter"
            )
    return _twice(names)


def feet_flaw(names: tuple[str, ...]) -> str:
    """Of the names of feet or of frames, by which messages and models call them."""
    return "a name is empty" if "" in names else _twice(names)


def _twice(names: tuple[str, ...]) -> str:
    return next((f"{name!r} is there twice" for k, name in enumerate(names) if name in names[:k]), "")
