"""Parameters and their values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

FURTHEST: Final = 1e9
"""m: nothing that is predicted is larger or further away, and squares of it are numbers that can be added."""

Value = bool | int | float | str | tuple[float, ...] | tuple[str, ...]


class Parameter(NamedTuple):
    """A parameter of the node.

    `kind` is the name of the type in rclpy.parameter.Parameter.Type, in small letters: bool, integer, double,
    double_array, string or string_array; `default` is None where nobody but the user can know the value. `low` and
    `high` bound every number, ends included. `flaw` looks at a list of the right type and range and says what is wrong
    with it, or "". One that is `shared` holds for all bodies; any other may be given for each.
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
    flaw: Callable[[tuple[float, ...]], str] | Callable[[tuple[str, ...]], str] | None = None
    shared: bool = False


def values_of(values: Mapping[str, Any], body: str) -> dict[str, Any]:
    """The values that hold for one body of validated ones: its own, and the common ones."""
    prefix = f"{body}."
    own = {name.removeprefix(prefix): value for name, value in values.items() if body and name.startswith(prefix)}
    return {**values, **own}
