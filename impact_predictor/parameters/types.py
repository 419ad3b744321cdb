"""Parameters, and which values they may have."""

from __future__ import annotations

import math
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


def values_of(values: Mapping[str, Any], body: str) -> dict[str, Any]:
    """The values that hold for one body of validated ones: its own, and the common ones."""
    prefix = f"{body}."
    own = {name.removeprefix(prefix): value for name, value in values.items() if body and name.startswith(prefix)}
    return {**values, **own}


def check(parameter: Parameter, value: object) -> Value:
    """The value of a parameter, a list as a tuple.

    Raises:
        InputError: it has the wrong type, is out of range, or has a flaw.
    """
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
        return _numbers(parameter, value, [value])[0]
    if isinstance(value, str | bytes) or not isinstance(value, Sequence):
        raise _refusal(parameter, value)
    items: Any = tuple(value)
    if parameter.kind == "double_array":
        items = _numbers(parameter, value, value)
    elif not all(isinstance(item, str) for item in items):
        raise _refusal(parameter, value)
    if parameter.lengths and len(items) not in parameter.lengths:
        raise _refusal(parameter, value)
    flaw = parameter.flaw(items) if parameter.flaw else ""
    if flaw:
        raise _refusal(parameter, value, flaw)
    return items  # type: ignore[no-any-return]


def _numbers(parameter: Parameter, value: object, numbers: Sequence[object]) -> tuple[float, ...]:
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
    return InputError(f"the parameter {parameter.name} is {shown!r}, but {flaw or f'it must be {allowed(parameter)}'}")


def allowed(parameter: Parameter) -> str:
    """What a value may be, as the end of a sentence."""
    if parameter.choices:
        *others, last = map(repr, parameter.choices)
        return f"{', '.join(others)} or {last}"
    if parameter.kind == "bool":
        return "true or false"
    if parameter.kind == "string":
        return "a text"
    if parameter.kind == "string_array":
        return "a list of texts"
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
