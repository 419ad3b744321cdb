"""A typed message of the package impact_predictor_msgs: its fields in their order, and its bytes in CDR."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from struct import Struct
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from ..cdr import HEADER_SIZE, LENGTHS, LITTLE_ENDIAN, LITTLE_ENDIAN_HEADER, PADDING, stamp
from .fields import Table
from .kinds import HEADER, INDICES, NUMBERS, PACKAGE, TEXT, TEXTS, Field, Kind

_SIZES: Final = {"b": 1, "B": 1, "?": 1, "i": 4, "I": 4, "d": 8}
_LARGEST: Final = 8
NOTHING: Final[Mapping[str, type[Enum]]] = MappingProxyType({})


class MessageSection(NamedTuple):
    """Fields of one record, by their names in the message: `record` is its place among those of the message."""

    title: str
    record: int
    fields: dict[str, Field]


def fields_of(table: Table, *names: str, **keys: str) -> dict[str, Field]:
    """Fields of a table, whose name is their key or another one."""
    return {name: table.fields[key] for name, key in (dict(zip(names, names, strict=True)) | keys).items()}


class Message:
    """A message made of some records, which may be None: then the values of their fields are not known."""

    def __init__(
        self, name: str, meaning: str, *sections: MessageSection, constants: Mapping[str, type[Enum]] = NOTHING
    ) -> None:
        """`constants` are the enumerations that it declares, by what the names of their constants begin with."""
        self.name, self.meaning, self.sections, self.constants = name, meaning, sections, constants
        self.elements = Kind(f"{self.type_name.replace('/msg', '')}[]")
        """The kind of a sequence of such messages, each of one record."""
        self._steps: list[FixedFields | Variable] = []
        for section in sections:
            for one in section.fields.values():
                if one.kind.layout:
                    self._run().append(section.record, one)
                else:
                    self._steps.append(Variable(section.record, one))
        _MESSAGES[self.elements.type] = self

    @property
    def type_name(self) -> str:
        return f"{PACKAGE}/msg/{self.name}"

    def _run(self) -> FixedFields:
        """The last step, to which fields of fixed sizes can be added."""
        last = self._steps[-1] if self._steps else None
        if not isinstance(last, FixedFields):
            last = FixedFields()
            self._steps.append(last)
        return last

    def encode(self, *records: Any) -> bytes:
        """The message as bytes."""
        data = bytearray(LITTLE_ENDIAN_HEADER)
        self.add_to(data, records)
        # Padded as DDS does, so that a bag holds what a topic carried.
        return bytes(data + PADDING[(len(data) - 1) & 3][: -len(data) & 3])

    def add_to(self, data: bytearray, records: Sequence[Any]) -> None:
        """Append its fields to the bytes of a message that has it."""
        for step in self._steps:
            step.add_to(data, records)


_MESSAGES: Final[dict[str, Message]] = {}
"""Those that are elements of others, by the types of such sequences."""


_Numbers = tuple[Callable[[Any], Any], Callable[[Any], Iterable[Any]] | None, tuple[Any, ...]]


class FixedFields:
    """Fields of fixed sizes that follow each other: one structure for each place at which it may begin."""

    def __init__(self) -> None:
        self._layout = ""
        self._records: list[tuple[int, list[_Numbers], list[Any]]] = []
        self._structs: dict[int, Struct] = {}

    def append(self, record: int, field: Field) -> None:
        """Add a field of a record."""
        kind = field.kind
        if not self._records or self._records[-1][0] != record:
            self._records.append((record, [], []))
        _, fields, missing = self._records[-1]
        fields.append((field.get, kind.numbers, kind.missing))
        missing += kind.missing
        self._layout += kind.layout

    def add_to(self, data: bytearray, records: Sequence[Any]) -> None:
        values: list[Any] = []
        for place, fields, nothing in self._records:
            record = records[place]
            if record is None:
                values += nothing
                continue
            for get, numbers, missing in fields:
                value = get(record)
                if value is None:
                    values += missing
                elif numbers is None:
                    values.append(value)
                else:
                    values += numbers(value)
        data += self._struct((len(data) - HEADER_SIZE) % _LARGEST).pack(*values)

    def _struct(self, start: int) -> Struct:
        found = self._structs.get(start)
        if found is None:
            layout, end = "<", start
            for one in self._layout:
                padding = -end % _SIZES[one]
                layout += "x" * padding + one
                end += padding + _SIZES[one]
            found = self._structs[start] = Struct(layout)
        return found


class Variable:
    """A field whose size is not fixed."""

    def __init__(self, record: int, field: Field) -> None:
        self._record, self._get = record, field.get
        self._elements = _MESSAGES.get(field.kind.type)
        self._write = _WRITERS.get(field.kind.type, _write_text)

    def add_to(self, data: bytearray, records: Sequence[Any]) -> None:
        record = records[self._record]
        value = None if record is None else self._get(record)
        if self._elements is None:
            self._write(data, value or "")
            return
        write_length(data, len(value or ()))
        for one in value or ():
            self._elements.add_to(data, (one,))


def write_length(data: bytearray, count: int) -> None:
    data += bytes(-len(data) & 3) + LITTLE_ENDIAN.length.pack(count)


def _write_text(data: bytearray, text: str) -> None:
    raw = text.encode()
    size = len(raw)
    data += bytes(-len(data) & 3)
    data += LENGTHS[size] if size < len(LENGTHS) else LITTLE_ENDIAN.length.pack(size + 1)
    data += raw
    data.append(0)


def _write_header(data: bytearray, header: tuple[int, str]) -> None:
    """A std_msgs/Header, which begins a message: its stamp in ns, and its frame."""
    data += stamp(header[0])
    _write_text(data, header[1])


def write_texts(data: bytearray, texts: Sequence[str]) -> None:
    write_length(data, len(texts))
    for one in texts:
        _write_text(data, one)


def _write_indices(data: bytearray, indices: Sequence[int]) -> None:
    write_length(data, len(indices))
    data += b"".join([LITTLE_ENDIAN.length.pack(one) for one in indices])


def write_numbers(data: bytearray, numbers: Sequence[float]) -> None:
    write_length(data, len(numbers))
    if numbers:
        data += bytes(-(len(data) - HEADER_SIZE) % _LARGEST)
        data += Struct(f"<{len(numbers)}d").pack(*numbers)


_WRITERS: Final[dict[str, Callable[[bytearray, Any], None]]] = {
    TEXT.type: _write_text,
    HEADER.type: _write_header,
    TEXTS.type: write_texts,
    INDICES.type: _write_indices,
    NUMBERS.type: write_numbers,
}
