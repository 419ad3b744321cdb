"""What a fit changes in a parameter file, and that file with other values, everything else as it was, comments too."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Final, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode

from .impulses import parts_of
from .search import interval

if TYPE_CHECKING:
    from .fit import Calibration

PARAMETERS: Final = {
    "friction": "contact.friction",
    "restitution": "contact.restitution",
    "merge": "contact.merge",
    "inertia": "body.inertia",
}
"""Where the fitted coefficients stand in a parameter file."""

_KEY: Final = "ros__parameters"


class NewValues(NamedTuple):
    """The values of a parameter, in brackets where they are a list, and a remark for the end of their line."""

    values: tuple[float, ...]
    remark: str
    listed: bool = False

    @property
    def text(self) -> str:
        numbers = ", ".join(map(number_text, self.values))
        return f"[{numbers}]" if self.listed else numbers


def number_text(value: float) -> str:
    """A number with four digits, as ROS reads a double: with a point."""
    text = f"{value:.4g}"
    mantissa, exponent, power = text.partition("e")
    return text if "." in mantissa else f"{mantissa}.0{exponent}{power}"


def changed(text: str, changes: Mapping[str, NewValues]) -> str:
    """The text of a parameter file with some parameters set, by their full names.

    The values are replaced where they stand, in each section that sets them. One that no section sets is added, in
    front of the first other one of its group.
    """
    for name, change in changes.items():
        spots = [spot for spot in _spots(text) if spot.name == name]
        for spot in reversed(spots):
            text = f"{text[: spot.start]}{change.text}{_with_remark(text[spot.end :], change.remark)}"
        if not spots:
            text = _with_new(text, name, change)
    return text


class _Spot(NamedTuple):
    """Where a parameter stands in a file: its key, and the beginning and the end of its value."""

    name: str
    key: str
    at: int
    start: int
    end: int
    in_braces: bool


def _spots(text: str) -> Iterator[_Spot]:
    """The parameters of a file, in its order."""
    root = YAML(typ="rt", pure=True).compose(text)
    if isinstance(root, MappingNode):
        yield from _below(root, None)


def _below(node: MappingNode, prefix: str | None) -> Iterator[_Spot]:
    for key, value in node.value:
        inside = "" if key.value == _KEY else None if prefix is None else f"{prefix}{key.value}."
        if isinstance(value, MappingNode):
            yield from _below(value, inside)
        elif prefix is not None:
            at, start, end = key.start_mark.index, value.start_mark.index, value.end_mark.index
            yield _Spot(f"{prefix}{key.value}", key.value, at, start, end, bool(node.flow_style))


def _with_remark(rest: str, remark: str) -> str:
    """What follows a value, with a remark before it where only a comment or nothing follows on its line."""
    line, newline, others = rest.partition("\n")
    if line.strip() and not line.lstrip().startswith("#"):
        return rest
    old = f"; {line.strip().removeprefix('#').strip()}" if line.strip() else ""
    return f"  # {remark}{old}{newline}{others}"


def _with_new(text: str, name: str, change: NewValues) -> str:
    group, _, last = name.rpartition(".")
    spot = next(spot for spot in _spots(text) if spot.name.rpartition(".")[0] == group)
    # A name may be written out, with its points.
    entry = f"{name if '.' in spot.key else last}: {change.text}"
    if spot.in_braces:
        return f"{text[: spot.at]}{entry}, {text[spot.at :]}"
    indent = text[text.rfind("\n", 0, spot.at) + 1 : spot.at]
    return f"{text[: spot.at]}{entry}  # {change.remark}\n{indent}{text[spot.at :]}"


def changes_of(calibration: Calibration) -> dict[str, NewValues]:
    """What the fit changes in the parameter file of the scene, which has a parameter for each of `PARAMETERS`."""
    changes = {}
    for name, one in calibration.estimates.items():
        if one.value == one.given:
            continue
        values: tuple[float, ...] = (one.value,)
        of = ""
        if name == "inertia":
            parts = parts_of(calibration.touchdowns[0].scene.inertia)
            given = parts[:1] if len(set(parts[:3])) == 1 and not any(parts[3:]) else parts
            values, of = tuple(one.value * part for part in given), "factor "
        remark = f"fitted to {len(calibration.touchdowns)} touchdowns; {of}{interval(one)} with 95 %"
        changes[PARAMETERS[name]] = NewValues(values, remark, listed=name == "inertia")
    return changes
