"""Reading and writing of CDR, the bytes in which ROS 2 messages travel (OMG DDSI-RTPS 2.3, section 10; XCDR1).

Four bytes say the byte order, then every number lies at a multiple of its own size, counted from behind them.
A string is its length with the closing NUL as uint32, the UTF-8 text and the NUL.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from struct import Struct
from typing import Final, NamedTuple, TypeVar

from ..stamps import NANOSECONDS

HEADER_SIZE: Final = 4
LITTLE_ENDIAN_HEADER: Final = b"\x00\x01\x00\x00"
LARGEST_TRAILER: Final = 3
"""Bytes that a middleware may leave behind a message, because it pads to a multiple of four."""
TRAILER_OF_DOUBLES: Final = 4
"""Bytes more for each sequence of doubles: rclpy makes room to align them also where there are none."""

OK, WARN, ERROR, STALE = range(4)
"""The levels of a diagnostic_msgs/DiagnosticStatus."""


Decoded = TypeVar("Decoded")


class MalformedMessage(ValueError):
    """The bytes are not a message of the expected type."""


class ByteOrder(NamedTuple):
    """The structures of one byte order, prepared once, and its mark in a format of `struct`."""

    mark: str
    stamp: Struct
    length: Struct
    odometry_numbers: Struct
    imu_numbers: Struct
    wrench_numbers: Struct
    transform_numbers: Struct
    point32: Struct


def _byte_order(mark: str) -> ByteOrder:
    return ByteOrder(mark, *[Struct(mark + layout) for layout in ("iI", "I", "85d", "37d", "6d", "7d", "3f")])


LITTLE_ENDIAN: Final = _byte_order("<")
BIG_ENDIAN: Final = _byte_order(">")
_ORDERS: Final = {b"\x00\x01": LITTLE_ENDIAN, b"\x00\x00": BIG_ENDIAN}


def byte_order(data: bytes) -> ByteOrder:
    """The byte order that the first bytes of a message name; MalformedMessage where the message is not plain CDR."""
    order = _ORDERS.get(data[:2])
    if order is None or len(data) < HEADER_SIZE:
        raise MalformedMessage("the message does not begin with a CDR header")
    return order


def align4(offset: int) -> int:
    """The next offset at which a 4-byte number may lie."""
    return (offset + 3) & -4


def align8(offset: int) -> int:
    """The next offset at which an 8-byte number may lie."""
    return ((offset + 3) & -8) + HEADER_SIZE


def read_string(data: bytes, offset: int, order: ByteOrder) -> tuple[str, int]:
    """The string at an offset, which is a multiple of four, and the offset behind it; MalformedMessage where the string
    does not end with NUL inside the message; struct.error or UnicodeDecodeError where its length is cut off, or it is
    not UTF-8.
    """
    (size,) = order.length.unpack_from(data, offset)
    start = offset + 4
    end = start + size
    if size == 0:
        # CDR demands at least the NUL; some middlewares write an empty string without it.
        return "", end
    if end > len(data) or data[end - 1] != 0:
        raise MalformedMessage(f"the string at byte {offset} does not end inside the message")
    return str(data[start : end - 1], "utf-8"), end


def read_header(data: bytes) -> tuple[ByteOrder, int, str, int]:
    """What begins a message with a std_msgs/Header: its byte order, stamp in ns and frame, and the offset behind it;
    MalformedMessage, struct.error or UnicodeDecodeError where it does not begin so.
    """
    order = byte_order(data)
    seconds, nanoseconds = order.stamp.unpack_from(data, HEADER_SIZE)
    frame_id, end = read_string(data, HEADER_SIZE + 8, order)
    return order, seconds * NANOSECONDS + nanoseconds, frame_id, end


def read_strings(data: bytes, offset: int, order: ByteOrder) -> tuple[tuple[str, ...], int]:
    """The sequence of strings behind an offset, and the offset behind it; raises as `read_string`."""
    end = align4(offset)
    (count,) = order.length.unpack_from(data, end)
    end += 4
    found = []
    for _ in range(count):
        text, end = read_string(data, align4(end), order)
        found.append(text)
    return tuple(found), end


def read_doubles(data: bytes, offset: int, order: ByteOrder, each: int = 1) -> tuple[tuple[float, ...], int]:
    """The sequence of doubles behind an offset, or of structures of `each` so many, and the offset behind it;
    struct.error where it does not end inside the message.
    """
    start = align4(offset)
    (count,) = order.length.unpack_from(data, start)
    if not count:
        # Nothing has to be aligned where no double follows.
        return (), start + 4
    start, count = align8(start + 4), count * each
    return struct.unpack_from(f"{order.mark}{count}d", data, start), start + 8 * count


def decoder(type_name: str) -> Callable[[Callable[[bytes], Decoded]], Callable[[bytes], Decoded]]:
    """Makes what a decoder raises where it reads beyond the bytes a MalformedMessage that names their type."""
    return partial(partial, _decoded, type_name)


def _decoded(type_name: str, decode: Callable[[bytes], Decoded], data: bytes) -> Decoded:
    try:
        return decode(data)
    except (struct.error, UnicodeDecodeError, IndexError) as error:
        raise MalformedMessage(f"not a {type_name}: {error}") from None


def check_end(data: bytes, end: int, sequences: int = 0) -> None:
    """Compare the end of the last field with the length of a message that has so many sequences of doubles;
    MalformedMessage where something is missing or left over.
    """
    if not end <= len(data) <= end + LARGEST_TRAILER + sequences * TRAILER_OF_DOUBLES:
        raise MalformedMessage(f"the message has {len(data)} bytes in the place of {end}")


PADDING: Final = (b"\0\0\0\0", b"\0\0\0", b"\0\0", b"\0")
_pack_length = LITTLE_ENDIAN.length.pack
_pack_stamp = LITTLE_ENDIAN.stamp.pack
_SHORT: Final = 64
_PARTS_OF_PAIR: Final = 4
LENGTHS: Final = tuple([_pack_length(size + 1) for size in range(_SHORT)])
"""The lengths of short strings with their NUL, by those without."""


def string(text: str) -> bytes:
    """A string, padded so that whatever follows is aligned to four bytes."""
    raw = text.encode()
    size = len(raw)
    return (LENGTHS[size] if size < _SHORT else _pack_length(size + 1)) + raw + PADDING[size & 3]


def seconds_and_rest(nanoseconds: int) -> tuple[int, int]:
    """The numbers of a builtin_interfaces/Time: beyond the range of its int32 seconds (the year 2038) the end of it."""
    seconds, rest = divmod(nanoseconds, NANOSECONDS)
    return min(max(seconds, -(2**31)), 2**31 - 1), rest


def stamp(nanoseconds: int) -> bytes:
    """A builtin_interfaces/Time."""
    return _pack_stamp(*seconds_and_rest(nanoseconds))


_name = lru_cache(maxsize=1024)(string)
"""A string that comes again and again: a key, the name of a status, a frame."""


_LEVELS: Final = tuple(bytes((level, 0, 0, 0)) for level in (OK, WARN, ERROR, STALE))


class StatusBytes(NamedTuple):
    """A diagnostic_msgs/DiagnosticStatus for `diagnostic_array`: its level, and the rest, the last `padding` bytes of
    which only align what follows.
    """

    level: int
    parts: list[bytes]
    padding: int


def add_pair(pairs: list[bytes], key: bytes, value: str) -> None:
    """Append a diagnostic_msgs/KeyValue to those of a status, in four parts; `key` is a `string`."""
    raw = value.encode()
    size = len(raw)
    pairs += (key, LENGTHS[size] if size < _SHORT else _pack_length(size + 1), raw, PADDING[size & 3])


def pairs_of(values: Mapping[str, str]) -> list[bytes]:
    """The values of a status by their keys."""
    pairs: list[bytes] = []
    for key, value in values.items():
        add_pair(pairs, _name(key), value)
    return pairs


def diagnostic_status(level: int, name: str, message: str, hardware_id: str, pairs: list[bytes]) -> StatusBytes:
    """A diagnostic_msgs/DiagnosticStatus; `level` is one of OK, WARN, ERROR and STALE, `pairs` as of `add_pair`."""
    head = [_name(name), string(message), _name(hardware_id), _pack_length(len(pairs) // _PARTS_OF_PAIR)]
    return StatusBytes(level, head + pairs, len(pairs[-1]) - 1 if pairs else 0)


def diagnostic_array(nanoseconds: int, frame_id: str, statuses: Sequence[StatusBytes]) -> bytes:
    """A diagnostic_msgs/DiagnosticArray of statuses, stamped in ns."""
    parts = [LITTLE_ENDIAN_HEADER, stamp(nanoseconds), _name(frame_id), _pack_length(len(statuses))]
    padding = 0
    for level, own, its_padding in statuses:
        # A level is a byte, which needs no alignment: it follows at once on the last text before it.
        if padding:
            parts[-1] = bytes((0, level, *bytes(padding - 1)))
        else:
            parts.append(_LEVELS[level])
        parts += own
        padding = its_padding
    # The padding of the last value pads the whole, as DDS does, so that a bag holds what a topic carried.
    return b"".join(parts)


class Diagnostic(NamedTuple):
    """One diagnostic_msgs/DiagnosticStatus: its values by their keys."""

    name: str
    level: int
    message: str
    values: dict[str, str]
    hardware_id: str


@decoder("diagnostic_msgs/msg/DiagnosticArray")
def decode_diagnostic_array(data: bytes) -> list[Diagnostic]:
    """The statuses in the bytes of a diagnostic_msgs/DiagnosticArray, of either byte order; MalformedMessage where the
    bytes are no such message.
    """
    order, _, _, end = read_header(data)
    length = order.length.unpack_from
    found = []
    (count,) = length(data, align4(end))
    end = align4(end) + 4
    for _ in range(count):
        level = data[end]
        name, end = read_string(data, align4(end + 1), order)
        message, end = read_string(data, align4(end), order)
        hardware_id, end = read_string(data, align4(end), order)
        (pairs,) = length(data, align4(end))
        end = align4(end) + 4
        values = {}
        for _ in range(pairs):
            key, end = read_string(data, align4(end), order)
            values[key], end = read_string(data, align4(end), order)
        found.append(Diagnostic(name, level, message, values, hardware_id))
    check_end(data, end)
    return found
