"""The touchdowns of many bags as one Parquet file, written bag by bag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Final, NamedTuple

from ..errors import need
from ..mechanics.types import Twist
from .files import named, whole
from .touchdowns import FIELDS, TouchdownField

_GROUP: Final = 10_000
"""Rows that are written at a time: few enough for any memory, many enough to be read fast."""


_PARTS: Final = {"twist": Twist._fields, "impulse": ("normal", "tangential")}
"""What a column of numbers is split into."""


class ParquetColumn(NamedTuple):
    """A column: its name, the name of its type in Arrow, and its unit, "" where it has none."""

    name: str
    type: str
    unit: str = ""


def _columns_of(field: TouchdownField) -> list[ParquetColumn]:
    if field.type == "mode":
        return [ParquetColumn(field.key, "string")]
    if field.type not in _PARTS:
        return [ParquetColumn(field.key, field.type, field.unit)]
    units = {"omega": "rad/s", "vx": "m/s", "vy": "m/s"}
    stem = field.key.removesuffix("_twist")
    return [ParquetColumn(f"{stem}_{part}", "float64", units.get(part, field.unit)) for part in _PARTS[field.type]]


COLUMNS: Final = (
    ParquetColumn("bag", "string"),
    ParquetColumn("bag_status", "string"),
    ParquetColumn("bag_problem", "string"),
    ParquetColumn("bag_samples", "int64"),
    *(column for field in FIELDS for column in _columns_of(field)),
)
"""What is known of a touchdown, in SI units; docs/fleets.md tells what each column is."""


def _rows(answer: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The rows of the JSON of a replay: one for each touchdown, and of a bag without any one that tells of the bag."""
    problem = answer.get("error") or answer.get("unpredictable") or answer.get("damaged")
    failed = answer.get("error") or answer.get("unpredictable")
    bag = {
        "bag": answer["bag"],
        "bag_status": "failed" if failed else "damaged" if problem else "ok",
        "bag_problem": problem,
        "bag_samples": answer.get("samples"),
    }
    for touchdown in answer.get("touchdowns") or [{}]:
        row = dict(bag)
        for field in FIELDS:
            columns, value = _columns_of(field), touchdown.get(field.key)
            values = (value or [None] * len(columns)) if field.type in _PARTS else [value]
            row |= {column.name: one for column, one in zip(columns, values, strict=True)}
        yield row


class TouchdownTable:
    """Writes the touchdowns of bags into one Parquet file; a context manager.

    The rows come in the order in which the bags are added, and the bytes depend on the answers alone. It has its name
    when it is whole; after an exception it is gone, and an older one stays as it was.
    """

    def __init__(self, path: str | Path) -> None:
        """Write to `path`; nothing happens before the context is entered.

        Raises:
            InputError: pyarrow is missing, the name does not end in .parquet, or its folder does not exist.
        """
        self.path = named(path, "Parquet table", (".parquet",))
        need("pyarrow")
        import pyarrow
        import pyarrow.parquet

        self._arrow = pyarrow
        self._schema = pyarrow.schema(
            [
                pyarrow.field(one.name, self._type(one.type), metadata={"unit": one.unit} if one.unit else {})
                for one in COLUMNS
            ]
        )
        self._rows: list[dict[str, Any]] = []
        self._stack = ExitStack()

    def __enter__(self) -> TouchdownTable:
        """Begin the file.

        Raises:
            InputError: it cannot be written.
        """
        with ExitStack() as stack:
            partial = stack.enter_context(whole(self.path))
            self._writer = stack.enter_context(
                self._arrow.parquet.ParquetWriter(partial, self._schema, compression="zstd")
            )
            self._stack = stack.pop_all()
        return self

    def add(self, answer: Mapping[str, Any]) -> None:
        """Add the touchdowns of a bag, from the JSON of its replay (`summary.as_json`, or its `bag` and `error`)."""
        self._rows += _rows(answer)
        if len(self._rows) >= _GROUP:
            self._flush()

    def _type(self, name: str) -> Any:
        """A type of Arrow by its name; `list<string>` is one of strings."""
        if name.startswith("list<"):
            return self._arrow.list_(self._type(name[5:-1]))
        return self._arrow.type_for_alias(name)

    def _flush(self) -> None:
        # One group of rows, wherever the borders of the bags are.
        table = self._arrow.Table.from_pylist(self._rows, schema=self._schema)
        self._writer.write_table(table, row_group_size=max(len(self._rows), 1))
        self._rows = []

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """End the file and, unless an exception passes, give it its name.

        Raises:
            InputError: it cannot be written.
        """
        if kind is not None:
            self._stack.__exit__(kind, error, traceback)
            return
        with self._stack:
            if self._rows:
                self._flush()
