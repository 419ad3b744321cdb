"""The definitions of the typed messages, as files of rosidl have them and as bags carry them."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from textwrap import wrap
from typing import TYPE_CHECKING, Final

from .deck_state import DECK_STATE, UNIT_STATE
from .kinds import ANSWER, CHOICE, NUMBER, PACKAGE, STAMP, Kind, constants, field
from .message import Message, MessageSection
from .typed import CONTACT, FOOT_STATE, PREDICTION_MESSAGE, SCORE_MESSAGE

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_WIDTH: Final = 110
_LARGEST_BYTE: Final = 255


def _part(name: str, meaning: str, parts: dict[str, tuple[Kind, str, str]]) -> Message:
    """A message that is a part of others, by the kind, unit and meaning of its fields."""
    return Message(name, meaning, MessageSection("", 0, {key: field(key, *part) for key, part in parts.items()}))


PARTS: Final = (
    _part(
        "PlanarTwist",
        "A twist of the mass centre in the impact plane, relative to the support.",
        {
            "vx": (NUMBER, "m/s", "along the support"),
            "vy": (NUMBER, "m/s", "along its normal"),
            "omega": (NUMBER, "rad/s", "minus the angular velocity about the axis of the impact"),
        },
    ),
    _part(
        "Margin",
        "The nearest change that changes the mode of an impact, up or down.",
        {
            "change": (NUMBER, "", "unit as where it is used; inf where none was found"),
            "mode": (CHOICE, "", "the mode beyond: MODE_* of Prediction"),
        },
    ),
    _part(
        "Lift",
        "Whether a contact lifts: 1 yes, 0 no, -1 not known.",
        {
            "told": (ANSWER, "", "as it was predicted"),
            "measured": (ANSWER, "", "as the record shows it"),
            "probability": (NUMBER, "1", "that it lifts, as it was predicted"),
        },
    ),
)
"""What a field of a message is made of."""

MESSAGES: Final = {
    one.name: one for one in (*PARTS, CONTACT, FOOT_STATE, PREDICTION_MESSAGE, SCORE_MESSAGE, UNIT_STATE, DECK_STATE)
}
"""All messages of the package by their names."""


def definition(message: Message, meanings: Mapping[type[Enum], Mapping[str, str]] | None = None) -> str:
    """The text of a message's file, perhaps with the `meanings` of the members of enumerations by their names."""
    lines = [f"# {line}".rstrip() for line in message.meaning.split("\n")]
    for prefix, enumeration in message.constants.items():
        lines += ["", f"# {(enumeration.__doc__ or '').splitlines()[0].partition('. ')[0].rstrip('.')}"]
        numbers, told = constants(enumeration), (meanings or {}).get(enumeration, {})
        size = "uint32" if max(numbers.values()) > _LARGEST_BYTE else "uint8"
        for name, number in numbers.items():
            lines += _said(f"{size} {prefix}_{name}={number}", told.get(name, ""))
    for section in message.sections:
        if section.title:
            lines += ["", f"# --- {section.title}"]
        elif section is message.sections[0]:
            lines.append("")
        for name, one in section.fields.items():
            unit = f"[{one.unit}] " if one.unit and one.kind is not STAMP else ""
            lines += _said(f"{one.kind.type} {name}", unit + one.meaning)
    return "\n".join(lines) + "\n"


def _said(line: str, meaning: str) -> list[str]:
    """A line with its meaning: behind it, or above it where there is no room."""
    if not meaning:
        return [line]
    if len(line) + len(meaning) < _WIDTH:
        return [f"{line}  # {meaning}"]
    return [*[f"# {words}" for words in wrap(meaning, _WIDTH)], line]


def register(typestore: Typestore) -> None:
    """Add the typed messages to the types of a store that knows the common ones."""
    from rosbags.typesys import get_types_from_msg

    types = {}
    for message in MESSAGES.values():
        types.update(get_types_from_msg(definition(message), f"{PACKAGE}/msg/{message.name}"))
    typestore.register(types)
