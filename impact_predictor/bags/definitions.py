"""The types of messages by the definitions that a bag itself holds, so that no package of messages is needed."""

from __future__ import annotations

import os
from collections.abc import Collection
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from ..errors import InputError
from .chunks import BagChannel

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_HEADER: Final = "std_msgs/msg/Header"
_IDL: Final = f"{'=' * 80}\nIDL: "


def typestore_of(path: str | os.PathLike[str], channels: Collection[BagChannel]) -> Typestore:
    """The types of the messages of some channels; InputError where the bag holds no definition of one of them, or one
    that cannot be read.
    """
    for one in channels:
        if one.schema not in ("ros2msg", "ros2idl", "ros1msg"):
            raise InputError(
                f"{os.fspath(path)} holds no definition of {one.type_name} on {one.topic}; "
                "record it again as MCAP (`ros2 bag record -s mcap`)"
            )
    definitions = tuple(sorted({(one.type_name, one.schema, one.definition) for one in channels}))
    try:
        return _typestore_of(definitions, any(one.encoding == "ros1" for one in channels))
    # A damaged definition may raise anything from the depths of the reader, not only its own errors.
    except Exception as error:
        names = ", ".join(name for name, _, _ in definitions)
        raise InputError(f"{os.fspath(path)} holds a damaged definition ({names}); record it again") from error


@lru_cache(maxsize=16)
def _typestore_of(definitions: tuple[tuple[str, str, str], ...], ros1: bool) -> Typestore:
    """The types of some definitions; many bags have the same, which take a fifth of a second to read."""
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    typestore = get_typestore(Stores.EMPTY)
    types = {}
    for type_name, schema, definition in definitions:
        if schema == "ros2idl":
            # One section for each type, under a line with its name.
            for section in definition.split(_IDL)[1:]:
                types.update(get_types_from_idl(section.partition("\n")[2]))
        else:
            types.update(get_types_from_msg(definition, type_name))
    if ros1:
        # The conversion drops the sequence number of ROS 1 headers, and expects the definition without it.
        types[_HEADER] = get_typestore(Stores.ROS2_JAZZY).fielddefs[_HEADER]
    typestore.register(types)
    return typestore
