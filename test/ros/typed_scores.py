"""A typed score as the texts of a diagnostic array, so that tests read both forms alike."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from enum import Enum
from functools import lru_cache
from math import isnan
from typing import TYPE_CHECKING, Any, Final

from impact_predictor.mechanics.types import Flag, Mode
from impact_predictor.prediction.types import Leftover
from impact_predictor.ros.cdr import decode_diagnostic_array
from impact_predictor.ros.messages.definitions import register
from impact_predictor.ros.messages.fields import LANDING, SCORE
from impact_predictor.ros.messages.kinds import ANSWER, BOUND, BOUNDS, LIFT, STAMP, Field, text
from impact_predictor.ros.messages.outputs import DIAGNOSTIC_ARRAY
from impact_predictor.ros.messages.typed import SCORE_MESSAGE
from impact_predictor.stamps import NANOSECONDS

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

SCORES: Final = (DIAGNOSTIC_ARRAY, SCORE_MESSAGE.type_name)
"""The types of messages on `~/score`."""

_NUMBERED: Final[dict[str, type[Enum]]] = {"mode": Mode, "flags": Flag, "leftover": Leftover, "leftover_6d": Leftover}


@lru_cache(maxsize=1)
def _typestore() -> Typestore:
    from rosbags.typesys import Stores, get_typestore

    typestore = get_typestore(Stores.ROS2_JAZZY)
    register(typestore)
    return typestore


def decode_scores(type_name: str, data: bytes) -> list[tuple[str, dict[str, str]]]:
    """The body and the values, by their keys, of each score in a message of one of `SCORES`.

    Raises:
        MalformedMessage: the bytes of a diagnostic array are none.
    """
    if type_name == DIAGNOSTIC_ARRAY:
        return [(one.hardware_id, one.values) for one in decode_diagnostic_array(data)]
    message: Any = _typestore().deserialize_cdr(data, type_name)
    values: dict[str, str] = {}
    for _, record, fields in SCORE_MESSAGE.sections:
        # What is told of a foot has keys of the touchdown too, and counts where there is one.
        table = _TABLES.get(record)
        if table is not None and (table is SCORE or message.foot):
            for name, one in fields.items():
                if one.key in table.fields:
                    values |= dict(_values(one, getattr(message, name)))
    return [(message.body, values)]


_TABLES: Final = {1: SCORE, 2: LANDING}
"""Those of the records of a score."""


def _values(field: Field, value: Any) -> Iterator[tuple[str, str]]:
    """The keys of a field and their texts, without what nobody knows."""
    if field.kind is STAMP:
        found: Sequence[object] = [value.sec * NANOSECONDS + value.nanosec]
    elif field.kind is BOUND:
        found = [BOUNDS[value - 1] if value else None]
    elif field.key in _NUMBERED:
        found = [_NUMBERED[field.key](value)]
    elif dataclasses.is_dataclass(value):
        found = [*_numbers(value)]
    elif len(field.kind.ends) > 1:
        found = [*map(float, value)]
    else:
        found = [value if isinstance(value, str | bool | int | float) else tuple(map(int, value))]
    answers = (True, True, False) if field.kind is LIFT else (field.kind is ANSWER,)
    for place, (end, one) in enumerate(zip(field.kind.ends, found, strict=True)):
        is_answer = answers[place % len(answers)]
        is_missing = one is None or one == "" or (isinstance(one, float) and isnan(one)) or (is_answer and one == -1)
        if not is_missing:
            yield field.key + end, text(bool(one) if is_answer else one)


def _numbers(message: Any) -> Iterator[object]:
    for one in dataclasses.fields(message):
        value = getattr(message, one.name)
        if dataclasses.is_dataclass(value):
            yield from _numbers(value)
        elif not one.name.startswith("_"):
            yield value
