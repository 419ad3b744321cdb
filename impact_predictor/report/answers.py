"""What a replay answers to programs: JSON of a bag, and the touchdowns of many bags as one Parquet file.

SI units, stamps in ns, relative errors as fractions of 1; docs/replay.md has the keys, docs/fleets.md the columns.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ..errors import need
from ..files import named, whole
from ..prediction.types import Status
from ..stamps import NANOSECONDS
from .skill import skill_as_json
from .summary import SpanErrors, errors_ahead, errors_of, spread_of, to_json, velocity_errors_ahead
from .touchdowns import FIELDS, PARTS, row_as_json, rows_of

if TYPE_CHECKING:
    from pyarrow.parquet import ParquetWriter

    from ..bags.replay import Result
    from ..scenarios.matching import Match, Truth

_GROUP: Final = 10_000
"""Rows that are written at a time: few enough for any memory, many enough to be read fast."""
_UNITS: Final = {"v": "m/s", "w": "rad/s", "o": "rad/s", "n": "N s", "t": "N s"}
"""Of the parts of twists and impulses, by their first letters."""
_SHORT: Final = {"from": "from", "to": "to", "count": "count", "median": "p50", "p90": "p90"}
"""What the JSON has of a spread under `error_by_lead_time`."""


def as_json(result: Result) -> dict[str, Any]:
    """Everything that a replay found; what a bag does not have, its JSON has not."""
    rows = rows_of(result.settled)
    errors, times = errors_of(rows), times_ahead(result)
    ahead = [_span(one) for one in velocity_errors_ahead(result.settled)]
    begin, end = result.extent or (None, None)
    known = {
        "inputs": {name: _counts(counts) for name, counts in result.inputs.items()},
        "damaged": result.damaged,
        "truth": {} if result.truth is None else _truth(result, result.truth),
        "time_errors_ahead": [_span(one) for one in errors_ahead(times)] if times else None,
        "true_touchdowns": [_match(match) for match in result.matches],
        "gaits": {
            body: {key: getattr(gait, key) for key in ("feet", "stances", "true_stances")}
            for body, gait in result.gaits.items()
        },
        "notes": list(result.notes),
        "unpredictable": result.unpredictable,
    }
    if not set(result.inputs) - {"odom", "contact_geometry"}:
        del known["inputs"]
    return {
        "bag": result.bag,
        "samples": result.samples,
        "us_per_sample": result.seconds / result.samples * 1e6 if result.samples else None,
        "touchdowns": [row_as_json(row) for row in rows],
        "scored": errors.number,
        "median_relative_error": errors.p50,
        "p90_relative_error": errors.p90,
        "error_by_lead_time": [{key: one[name] for key, name in _SHORT.items()} for one in ahead],
        "relative_errors_ahead": ahead,
        "statuses": _counts(result.statuses),
        "geometry_statuses": _counts(result.geometry_statuses),
        "begin": begin,
        "end": end,
        "cost_us": to_json(spread_of([1e6 * cost for cost in result.costs])),
        **skill_as_json(rows, result.recorded),
        **{key: value for key, value in known.items() if value},
    }


def _counts(counts: Mapping[Status, int]) -> dict[str, int]:
    return {status.name: count for status, count in counts.items()}


def _span(span: SpanErrors) -> dict[str, Any]:
    return {"from": span.begin, "to": span.end} | to_json(span.errors)


def times_ahead(result: Result) -> list[tuple[float, float]]:
    """Lead time and error in s of the time of each prediction, where the record has when touchdowns were.

    That is by the truth where the bag has it, else of feet by when their motion ends.
    """
    if result.matches:
        return [
            ((match.stamp - one.seen) / NANOSECONDS, (one.stamp - match.stamp) / NANOSECONDS)
            for match in result.matches
            if match.stamp is not None and match.shown
            for one in match.predictions
        ]
    landings = [settled.score.landing for settled in result.settled]
    return [one for landing in landings if landing is not None for one in landing.history]


def _truth(result: Result, truth: Truth) -> dict[str, Any]:
    """The comparison with the truth, of all bodies and of each."""
    bodies: dict[str, dict[str, Any]] = {}
    for body, one in result.truths.items():
        bodies[body] = {} if one.truth is None else one.truth._asdict()
        if one.warned is not None:
            bodies[body] |= one.warned._asdict() | {"warned_before_first_impact": one.warned.before_first_impact}
    answer, warned = truth._asdict(), [one.warned for one in result.truths.values() if one.warned is not None]
    if warned:
        answers = [one.before_first_impact for one in warned if one.before_first_impact is not None]
        answer |= {"bodies_with_slide_or_impact": len(answers), "warned_before_first_impact": sum(answers)}
        answer |= {key: sum(getattr(one, key) for one in warned) for key in ("events", "events_warned")}
    return answer | ({"bodies": bodies} if bodies else {})


def _match(match: Match) -> dict[str, Any]:
    """A true touchdown with its first and its last prediction, or a false alarm."""
    first, last = (match.predictions[0], match.predictions[-1]) if match.predictions else (None, None)
    return {
        "body": match.body,
        **({"foot": match.foot} if match.foot else {}),
        "stamp": match.stamp,
        "mode": None if match.mode is None else match.mode.name,
        "first_seen": None if first is None else first.seen,
        "predicted_stamp": None if last is None else last.stamp,
        "predicted_mode": None if last is None or last.touchdown is None else last.touchdown.mode.name,
        "velocity_error": match.velocity_error,
        "shown": match.shown,
    }


def _columns_of(key: str) -> dict[str, tuple[str, str]]:
    """The columns of a field: for each name the type in Arrow, and the unit."""
    field, stem = FIELDS[key], key.removesuffix("_twist").replace("_twist_6d", "_6d")
    if field.type == "lift":
        types = ("bool", ""), ("bool", ""), ("float64", "1")
        return {f"{key}_{part}": of for part, of in zip(PARTS["lift"], types, strict=True)}
    if field.type in PARTS:
        return {f"{stem}_{part}": ("float64", field.unit or _UNITS[part[0]]) for part in PARTS[field.type]}
    return {} if field.type == "json" else {key: ("string" if field.type == "mode" else field.type, field.unit)}


class TouchdownTable:
    """Writes the touchdowns of bags in the order in which these are added; the bytes depend on the answers alone."""

    def __init__(self, writer: ParquetWriter) -> None:
        self._writer = writer
        self._rows: list[dict[str, Any]] = []

    def add(self, answer: Mapping[str, Any]) -> None:
        """Add the touchdowns of a bag, from the JSON of its replay (`as_json`, or its `bag` and `error`).

        A bag without any has one row that tells of the bag.
        """
        failure = answer.get("error") or answer.get("unpredictable")
        damage = answer.get("damaged")
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
def parquet_table(path: str | Path) -> Iterator[TouchdownTable]:
    """A table in a Parquet file; it has its name when it is whole, and after an exception an older one stays.

    Raises:
        InputError: pyarrow is missing, the name does not end in .parquet, or its folder does not exist; or it cannot be
            written.
    """
    path = named(path, "Parquet table", (".parquet",))
    need("pyarrow")
    import pyarrow
    from pyarrow.parquet import ParquetWriter

    types = {"list<string>": pyarrow.list_(pyarrow.string()), "list<int32>": pyarrow.list_(pyarrow.int32())}
    columns = dict.fromkeys(("bag", "bag_status", "bag_problem"), ("string", "")) | {"bag_samples": ("int64", "")}
    for key in FIELDS:
        columns |= _columns_of(key)
    schema = pyarrow.schema(
        pyarrow.field(name, types.get(kind) or pyarrow.type_for_alias(kind), metadata={"unit": unit} if unit else {})
        for name, (kind, unit) in columns.items()
    )
    with whole(path) as partial, ParquetWriter(partial, schema, compression="zstd") as writer:
        table = TouchdownTable(writer)
        yield table
        table.flush()
