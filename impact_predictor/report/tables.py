"""Rows of many bags as one Parquet or CSV file: touchdowns, or what a watch saw; docs/fleets.md has the columns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from ..errors import need
from ..files import named, whole
from .touchdowns import FIELDS, PARTS

Columns = Mapping[str, tuple[str, str]]
"""Of each column by its name the type in Arrow, and the unit."""

_GROUP: Final = 10_000
"""Rows that are written at a time: few enough for any memory, many enough to be read fast."""
_UNITS: Final = {"v": "m/s", "w": "rad/s", "o": "rad/s", "n": "N s", "t": "N s"}
"""Of the parts of twists and impulses, by their first letters."""


def _columns_of(key: str) -> Columns:
    """The columns of a field of a touchdown."""
    field, stem = FIELDS[key], key.removesuffix("_twist").replace("_twist_6d", "_6d")
    if field.type == "lift":
        types = ("bool", ""), ("bool", ""), ("float64", "1")
        return {f"{key}_{part}": of for part, of in zip(PARTS["lift"], types, strict=True)}
    if field.type in PARTS:
        return {f"{stem}_{part}": ("float64", field.unit or _UNITS[part[0]]) for part in PARTS[field.type]}
    return {} if field.type == "json" else {key: ("string" if field.type == "mode" else field.type, field.unit)}


TOUCHDOWNS: Final[Columns] = {
    **dict.fromkeys(("bag", "bag_status", "bag_problem"), ("string", "")),
    "bag_samples": ("int64", ""),
    **{name: of for key in FIELDS for name, of in _columns_of(key).items()},
}


def touchdown_rows(answer: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The rows of a bag, from the JSON of its replay (`as_json`, or its `bag` and `error`).

    A bag without any touchdown has one row that tells of the bag.
    """
    failure, damage = answer.get("error") or answer.get("unpredictable"), answer.get("damaged")
    for touchdown in answer.get("touchdowns") or [{}]:
        row = {
            "bag": answer["bag"],
            "bag_status": "failed" if failure else "damaged" if damage else "ok",
            "bag_problem": failure or damage,
            "bag_samples": answer.get("samples"),
        }
        for key, field in FIELDS.items():
            value = touchdown.get(key)
            row |= zip(_columns_of(key), value if field.type in PARTS and value else (value,), strict=False)
        yield row


class RowTable:
    """Writes rows in the order in which they are added; the bytes depend on the rows alone."""

    def __init__(self, write: Callable[[list[dict[str, Any]]], None]) -> None:
        self._write = write
        self._rows: list[dict[str, Any]] = []

    def add(self, rows: Iterable[dict[str, Any]]) -> None:
        """Add rows; a column that a row does not have is null."""
        self._rows += rows
        if len(self._rows) >= _GROUP:
            self.flush()

    def flush(self) -> None:
        """Write the rows as one group, wherever the borders of the bags are."""
        if self._rows:
            self._write(self._rows)
        self._rows = []


@contextmanager
def table_file(path: str | Path, columns: Columns) -> Iterator[RowTable]:
    """A table in a Parquet or CSV file; it has its name when it is whole, and after an exception an older one stays.
    InputError where pyarrow is missing, the name does not end in .parquet or .csv, or its folder does not exist; or it
    cannot be written.
    """
    path = named(path, "table", (".parquet", ".csv"))
    need("pyarrow")
    import pyarrow
    from pyarrow.csv import CSVWriter
    from pyarrow.parquet import ParquetWriter

    is_text = path.suffix.lower() == ".csv"
    lists = {name for name, (kind, _) in columns.items() if kind.startswith("list")}
    types = {f"list<{kind}>": pyarrow.list_(pyarrow.type_for_alias(kind)) for kind in ("string", "int32")}
    schema = pyarrow.schema(
        pyarrow.field(
            name,
            pyarrow.string() if is_text and name in lists else types.get(kind) or pyarrow.type_for_alias(kind),
            metadata={"unit": unit} if unit else {},
        )
        for name, (kind, unit) in columns.items()
    )

    def write(rows: list[dict[str, Any]]) -> None:
        if is_text:  # lists with spaces between their items
            rows = [
                row | {name: " ".join(map(str, row[name])) for name in lists if row.get(name) is not None}
                for row in rows
            ]
            writer.write_table(pyarrow.Table.from_pylist(rows, schema=schema))
        else:
            writer.write_table(pyarrow.Table.from_pylist(rows, schema=schema), row_group_size=len(rows))

    with (
        whole(path) as partial,
        CSVWriter(partial, schema) if is_text else ParquetWriter(partial, schema, compression="zstd") as writer,
    ):
        table = RowTable(write)
        yield table
        table.flush()
