"""Reading the touchdowns of an earlier run: what `replay` wrote into a bag or printed as JSON."""

from __future__ import annotations

import json
import os
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from ..bags.find import name_of
from ..bags.read import read_messages, topics
from ..bags.run import NODE
from ..errors import InputError
from ..mechanics.types import Mode, Twist
from ..ros.messages import DIAGNOSTIC_ARRAY, MalformedMessage, decode_diagnostic_array
from .summary import TouchdownRow

_HINT: Final = "give what `impact-predictor replay` wrote with -o, or printed with --json"
_OTHER_JSON: Final = (KeyError, TypeError, ValueError, AttributeError)
"""What comes of taking another JSON for that of a replay."""


def row_of_message(body: str, values: Mapping[str, str], cost: float | None = None) -> TouchdownRow:
    """The row of the values of a message on `~/score`, as `decode_diagnostic_array` reads them; `cost` in s."""

    def twist(name: str) -> Twist:
        return Twist(*(float(values[f"{name}.{part}"]) for part in Twist._fields))

    def number(name: str) -> float | None:
        return float(values[name]) if name in values else None

    def points(name: str) -> tuple[int, ...]:
        return tuple(map(int, values[name].split()))

    return TouchdownRow(
        body=body,
        stamp=int(values["stamp"]),
        announced=float(values["announced"]),
        lead_time=float(values["lead_time"]),
        mode=Mode[values["mode"]],
        before=twist("before"),
        predicted=twist("predicted"),
        measured=twist("measured") if "measured.vx" in values else None,
        half_distance=float(values["half_distance"]),
        relative_error=number("relative_error"),
        out_of_plane=float(values["off_axis"]),
        scored=values["scored"] == "true",
        flags=tuple(flag for key in ("leftover", "flags") for flag in values[key].split("|") if flag != "NONE"),
        contacts=(points("old"), points("new")) if "old" in values else None,
        foot=values.get("foot", ""),
        time_error=number("time_error"),
        cost=cost,
    )


def row_of_json(fields: Mapping[str, Any]) -> TouchdownRow:
    """The row of a touchdown in the JSON of a replay; that of older versions tells neither contacts nor announcements.

    Raises:
        KeyError, TypeError, ValueError: it is none.
    """
    measured = fields["measured_twist"]
    return TouchdownRow(
        body=fields["body"],
        stamp=int(fields["stamp"]),
        announced=fields.get("announced_lead_time", fields["lead_time"]),
        lead_time=fields["lead_time"],
        mode=Mode[fields["mode"]],
        before=Twist(*fields["before_twist"]),
        predicted=Twist(*fields["predicted_twist"]),
        measured=None if measured is None else Twist(*measured),
        half_distance=fields["half_distance"],
        relative_error=fields["relative_error"],
        out_of_plane=fields["out_of_plane"],
        scored=fields["scored"],
        flags=tuple(fields["flags"]),
        contacts=(tuple(fields["old"]), tuple(fields["new"])) if "old" in fields else None,
        foot=fields.get("foot", ""),
        time_error=fields.get("time_error"),
    )


class Earlier:
    """An earlier run of one bag or of several.

    That is the bag that the run wrote or a recording of the node's topics, or the JSON of the run; of a run of several
    bags the folder of what was written, or the JSON with one object for each.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Look at it; JSON is read at once, bags when they are asked for.

        Raises:
            InputError: it does not exist, or is JSON that cannot be read, or none of a replay.
        """
        self.path = Path(path)
        if not self.path.exists():
            raise InputError(f"the baseline {self.path} does not exist; {_HINT}")
        self._runs = _runs_of(self.path) if self.path.suffix == ".json" else None

    def check_of_several(self, bags: int) -> None:
        """Whether it can be of so many bags.

        Raises:
            InputError: it is the run of one bag, and there are several.
        """
        is_of_one = self._runs.is_of_one if self._runs is not None else not self._is_folder
        if bags > 1 and is_of_one:
            raise InputError(
                f"the baseline {self.path} is the run of one bag, but {bags:,} bags are given; give what a run of "
                "several wrote: its folder (-o), or its --json"
            )

    def touchdowns_of(self, bag: str | os.PathLike[str], name: str | os.PathLike[str] = "") -> tuple[TouchdownRow, ...]:
        """The touchdowns of a bag, which has a `name` in a run of several (`names_of`; without one that of its file).

        There it may also be called by more of its path: there were more bags in the earlier run.

        Raises:
            InputError: nothing is there, it is no run, or none of this bag.
        """
        name = Path(name or name_of(bag))
        folders = Path(bag).resolve().parent.parts[1:]
        longer = [Path(*folders[k:], name.name) for k in range(len(folders) + 1 - len(name.parts), -1, -1)]
        if self._runs is not None:
            return self._runs.touchdowns_of(self.path, os.fspath(bag), [name, *longer])
        if not self._is_folder:
            return _read_bag(self.path)
        found = [path for one in (name, *longer) if (path := self.path / f"{one}.mcap").exists()]
        if not found:
            raise InputError(f"the baseline {self.path} has no {name}.mcap; write it with `impact-predictor replay -o`")
        return _read_bag(found[0])

    @property
    def _is_folder(self) -> bool:
        """Whether it is a folder of what was written of several bags."""
        return self.path.is_dir() and not (self.path / "metadata.yaml").exists()


class _Runs:
    """The JSON of a run of one bag, or of several by their paths and by their names."""

    def __init__(self, answer: Any) -> None:
        self.is_of_one = not isinstance(answer, list)
        self._all = [answer] if self.is_of_one else answer
        self._by_name: dict[str, list[Any]] = defaultdict(list)
        for run in () if self.is_of_one else answer:
            for key in {run["bag"], name_of(run["bag"])}:
                self._by_name[key].append(run)

    def touchdowns_of(self, path: Path, bag: str, names: Sequence[Path]) -> tuple[TouchdownRow, ...]:
        same = self._all
        if not self.is_of_one:
            same = [run for run in self._by_name[bag] if run["bag"] == bag]
            if not same:
                same = self._called(name_of(bag), names)
            if len(same) != 1 or "error" in same[0]:
                raise InputError(f"the baseline {path} has no run of {bag}; replay that bag with --json again")
        try:
            return tuple(map(row_of_json, same[0]["touchdowns"]))
        except _OTHER_JSON as error:
            raise InputError(f"the baseline {path} is not the JSON of a replay; {_HINT}") from error

    def _called(self, last: str, names: Sequence[Path]) -> list[Any]:
        """The runs of a bag by the shortest of its names that no other run has."""
        same = self._by_name[last]
        for name in names:
            same = [run for run in same if _ends_with(run["bag"], name)]
            if len(same) < 2:
                break
        return same


def _ends_with(bag: str, name: Path) -> bool:
    """Whether a bag is called so, with its suffix or without."""
    path = Path(bag)
    return any(one.parts[-len(name.parts) :] == name.parts for one in (path, path.parent / name_of(bag)))


def _runs_of(path: Path) -> _Runs:
    try:
        return _Runs(json.loads(path.read_bytes()))
    except OSError as error:
        raise InputError(f"the baseline {path} cannot be read: {error.strerror}") from error
    except json.JSONDecodeError as error:
        raise InputError(f"the baseline {path} is not JSON ({error}); {_HINT}") from error
    except _OTHER_JSON as error:
        raise InputError(f"the baseline {path} is not the JSON of a replay; {_HINT}") from error


def _read_bag(path: Path) -> tuple[TouchdownRow, ...]:
    recorded = topics(path)
    predictions = [topic for topic in recorded if f"{NODE}/" in topic and topic.endswith("/prediction")]
    if not predictions:
        raise InputError(f"the baseline {path} has no predictions: no topic {NODE}/prediction; {_HINT}")
    # A run without any touchdown has no scores.
    topics_of_scores = [topic.removesuffix("prediction") + "score" for topic in predictions]
    wanted = {topic: DIAGNOSTIC_ARRAY for topic in topics_of_scores if topic in recorded}
    if not wanted:
        return ()
    found = []
    for topic, _, data in read_messages(path, wanted):
        body = topic.rpartition(f"{NODE}/")[2].removesuffix("score").strip("/")
        try:
            found += [row_of_message(body or one.hardware_id, one.values) for one in decode_diagnostic_array(data)]
        except (MalformedMessage, KeyError, ValueError) as error:
            raise InputError(f"the baseline {path} has a message on {topic} that is no score; {_HINT}") from error
    return tuple(found)
