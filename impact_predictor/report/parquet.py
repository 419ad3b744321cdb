"""The touchdowns of many bags as one Parquet file, written bag by bag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..errors import need
from .files import named, whole
from .touchdowns import FIELDS, TouchdownField

if TYPE_CHECKING:
    from pyarrow.parquet import ParquetWriter

_GROUP: Final = 10_000
"""Rows that are written at a time: few enough for any memory, many enough to be read fast."""
_PARTS: Final = {
    "twist": {"vx": "m/s", "vy": "m/s", "omega": "rad/s"},
    "impulse": {"normal": "N s", "tangential": "N s"},
}
"""What the JSON has as a list of numbers: the ends of the names of its columns, and their units."""


class ParquetColumn(NamedTuple):
    """A column: its name, the name of its type in Arrow, and its unit, "" where it has none."""

    name: str
    type: str
    unit: str = ""


def _columns_of(field: TouchdownField) -> list[ParquetColumn]:
    stem, parts = field.key.removesuffix("_twist"), _PARTS.get(field.type)
    if parts is None:
        return [ParquetColumn(field.key, "string" if field.type == "mode" else field.type, field.unit)]
    return [ParquetColumn(f"{stem}_{part}", "float64", unit) for part, unit in parts.items()]


COLUMNS: Final = (
    ParquetColumn("bag", "string"),
    ParquetColumn("bag_status", "string"),
    ParquetColumn("bag_problem", "string"),
    ParquetColumn("bag_samples", "int64"),
    *(column for field in FIELDS for column in _columns_of(field)),
)
"""What is known of a touchdown, in SI units; docs/fleets.md tells what each column is."""


class TouchdownTable:
    """Writes the touchdowns of bags in the order in which these are added; the bytes depend on the answers alone."""

    def __init__(self, writer: ParquetWriter) -> None:
        """Write with a writer of pyarrow."""
        self._writer = writer
        self._rows: list[dict[str, Any]] = []

    def add(self, answer: Mapping[str, Any]) -> None:
        """Add the touchdowns of a bag, from the JSON of its replay (`as_json`, or its `bag` and `error`).

        A bag without any has one row that tells of the bag.
        """
        failure = answer.get("error") or answer.get("unpredictable")
        damage = answer.get("damaged")
        bag = {
            "bag": answer["bag"],
            "bag_status": "failed" if failure else "damaged" if damage else "ok",
            "bag_problem": failure or damage,
            "bag_samples": answer.get("samples"),
        }
        for touchdown in answer.get("touchdowns") or [{}]:
            row = dict(bag)
            for field in FIELDS:
                value = touchdown.get(field.key)
                values = (value,) if field.type not in _PARTS or value is None else value
                row |= zip((column.name for column in _columns_of(field)), values, strict=False)
            self._rows.append(row)
        if len(self._rows) >= _GROUP:
            self.flush()

    def flush(self) -> None:
        """Write the rows as one group, wherever the borders of the bags are."""
        import pyarrow

        if self._rows:
            table = pyarrow.Table.from_pylist(self._rows, schema=self._writer.schema)
            self._writer.write_table(table, row_group_size=len(self._rows))
        self._rows = []


@contextmanager
def touchdown_table(path: str | Path) -> Iterator[TouchdownTable]:
    """A table in a Parquet file; it has its name when it is whole, and after an exception an older one stays.

    Raises:
        InputError: pyarrow is missing, the name does not end in .parquet, or its folder does not exist; or it cannot be
            written.
    """
    path = named(path, "Parquet table", (".parquet",))
    need("pyarrow")
    import pyarrow
    from pyarrow.parquet import ParquetWriter

    def arrow_type(name: str) -> Any:
        if name.startswith("list<"):
            return pyarrow.list_(arrow_type(name[5:-1]))
        return pyarrow.type_for_alias(name)

    units = [{"unit": column.unit} if column.unit else {} for column in COLUMNS]
    fields = [
        pyarrow.field(one.name, arrow_type(one.type), metadata=unit) for one, unit in zip(COLUMNS, units, strict=True)
    ]
    with whole(path) as partial, ParquetWriter(partial, pyarrow.schema(fields), compression="zstd") as writer:
        table = TouchdownTable(writer)
        yield table
        table.flush()
