"""What kinds of values messages hold: each in a typed message, and as texts by their keys in a diagnostic array."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import Enum
from functools import lru_cache
from math import nan
from operator import attrgetter
from typing import Any, Final, NamedTuple

from ...mechanics.types import Flag, Mode
from ...prediction.skill import SIMPLE
from ...prediction.types import Bound, Covariance, Leftover, SpatialTwist, Status
from ..cdr import seconds_and_rest

PACKAGE: Final = "impact_predictor_msgs"


class Kind(NamedTuple):
    """A kind of values.

    In a typed message it has the `type`, and as bytes the `numbers` of a value by a `layout` of `struct`, or those that
    are `missing` where nobody knows the value; without `numbers` a value is its own one. What has no layout varies in
    size. In a diagnostic array its keys end with `ends`, and `told` makes the values of these keys.
    """

    type: str
    layout: str = ""
    missing: tuple[Any, ...] = ()
    numbers: Callable[[Any], Iterable[Any]] | None = None
    ends: tuple[str, ...] = ("",)
    told: Callable[[Any], Iterable[object]] | None = None


class Field(NamedTuple):
    """A field of a record: its key, its unit ("" where there is none) and meaning, its kind, and what `get`s its value.

    A value of None is left out of a diagnostic array.
    """

    key: str
    kind: Kind
    unit: str
    meaning: str
    get: Callable[[Any], Any]


def field(key: str, kind: Kind, unit: str, meaning: str, get: str | Callable[[Any], Any] = "") -> Field:
    """A field whose value is that of an attribute, by its name or path; left out, the key is the path."""
    return Field(key, kind, unit, meaning, attrgetter(get or key) if isinstance(get, str) else get)


@lru_cache(maxsize=256, typed=True)
def names(flags: Flag | Leftover) -> str:
    """The names of flags, or NONE."""
    return "|".join([flag.name or "" for flag in type(flags) if flag & flags]) or "NONE"


def _truth(value: bool) -> str:
    return "true" if value else "false"


def _items(items: Iterable[object]) -> str:
    return " ".join([str(item) for item in items])


_TEXTS: Final[dict[type, Callable[[Any], str]]] = {
    **dict.fromkeys((str, int), str),
    bool: _truth,
    tuple: _items,
    # What an enumeration makes of `name` takes ten times as long.
    **dict.fromkeys((Covariance, Mode, Status), attrgetter("_name_")),
    **dict.fromkeys((Flag, Leftover), names),
    Bound: attrgetter("_value_"),
}


def text(value: object) -> str:
    """A value as a text: flags separated by "|", items of a tuple by spaces; every number reads back."""
    known = _TEXTS.get(type(value))
    # What else there is are numbers, perhaps those of NumPy.
    return repr(float(value)) if known is None else known(value)  # type: ignore[arg-type]


def _of_parts(parts: tuple[Iterable[Any], ...]) -> list[Any]:
    return [number for part in parts for number in part]


def _of_twist(twist: SpatialTwist) -> list[float]:
    return [*map(float, twist.linear), *map(float, twist.angular)]


def _of_bound(bound: Bound) -> tuple[int]:
    return (BOUNDS.index(bound) + 1,)


def _of_margin(margin: tuple[float, Mode | None]) -> tuple[float, int]:
    return margin[0], margin[1] or Mode.NO_IMPACT


def _beyond(margin: tuple[float, Mode | None]) -> tuple[float, object]:
    return margin[0], "NONE" if margin[1] is None else margin[1]


def _of_lift(lift: tuple[bool, bool, float | None]) -> tuple[bool, bool, float]:
    return lift[0], lift[1], nan if lift[2] is None else lift[2]


def _floats(kind: str, count: int, *ends: str, numbers: Callable[[Any], Iterable[Any]] = tuple) -> Kind:
    return Kind(kind, "d" * count, (nan,) * count, numbers, ends or ("",), numbers if ends else None)


BOUNDS: Final = tuple(Bound)
NUMBER: Final = Kind("float64", "d", (nan,))
TRUTH: Final = Kind("bool", "?", (False,))
ANSWER: Final = Kind("int8", "b", (-1,))
"""Yes, no, or that nobody knows: 1, 0 or -1."""
CHOICE: Final = Kind("uint8", "B", (0,))
FLAGS: Final = Kind("uint32", "I", (0,))
BOUND: Final = Kind("uint8", "B", (0,), _of_bound)
INDEX: Final = Kind("uint32", "I", (0,))
STAMP: Final = Kind("builtin_interfaces/Time", "iI", (0, 0), seconds_and_rest)
POINT: Final = _floats("geometry_msgs/Point", 3, ".x", ".y", ".z")
VECTOR: Final = _floats("geometry_msgs/Vector3", 3, ".x", ".y", ".z")
PLANAR_TWIST: Final = _floats(f"{PACKAGE}/PlanarTwist", 3, ".vx", ".vy", ".omega")
TWIST: Final = _floats("geometry_msgs/Twist", 6, ".vx", ".vy", ".vz", ".wx", ".wy", ".wz", numbers=_of_twist)
POSE: Final = _floats("geometry_msgs/PoseWithCovariance", 43, numbers=_of_parts)
TWIST_WITH_COVARIANCE: Final = _floats("geometry_msgs/TwistWithCovariance", 42, numbers=_of_parts)
IMPULSES: Final = _floats(
    "float64[4]", 4, ".old.normal", ".old.tangent", ".new.normal", ".new.tangent", numbers=_of_parts
)
PROBABILITIES: Final = _floats("float64[7]", 7, *[f".{mode.name}" for mode in sorted(Mode)])
SIMPLE_ERRORS: Final = _floats(f"float64[{len(SIMPLE)}]", len(SIMPLE), *[f".{name}" for name in SIMPLE])
MARGIN: Final = Kind(f"{PACKAGE}/Margin", "dB", (nan, 0), _of_margin, ("", ".mode"), _beyond)
LIFT: Final = Kind(f"{PACKAGE}/Lift", "bbd", (-1, -1, nan), _of_lift, (".told", ".measured", ".probability"), tuple)
# Of no fixed size.
TEXT: Final = Kind("string")
TEXTS: Final = Kind("string[]")
INDICES: Final = Kind("uint32[]")
NUMBERS: Final = Kind("float64[]")
HEADER: Final = Kind("std_msgs/Header")


def constants(enumeration: type[Enum]) -> dict[str, int]:
    """The numbers of the members of an enumeration in messages, by their names."""
    # What has no numbers of its own is counted from 1, because 0 stands for none.
    return {
        name: member.value if isinstance(member.value, int) else place
        for place, (name, member) in enumerate(enumeration.__members__.items(), 1)
    }
