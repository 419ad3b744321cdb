"""Reading the touchdowns of an earlier run: what `replay` wrote into a bag or printed as JSON."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Final

from ..bags.read import read_messages, topics
from ..bags.stream import NODE
from ..errors import InputError
from ..mechanics.types import Twist
from ..ros.messages import DIAGNOSTIC_ARRAY, MalformedMessage, decode_diagnostic_array
from .baseline import Happened, happened

_HINT: Final = "give what `impact-predictor replay` wrote with -o, or printed with --json"


def name_of(bag: str | os.PathLike[str]) -> str:
    """What a bag is called without its folder and suffix."""
    path = Path(bag).resolve()
    return path.stem if path.suffix in (".mcap", ".db3", ".bag") else path.name


def read_earlier(path: str | os.PathLike[str], bag: str | os.PathLike[str]) -> tuple[Happened, ...]:
    """The touchdowns of an earlier run of a bag.

    `path` is the bag that the run wrote or a recording of the node's topics, or the JSON of the run; of a run of
    several bags it is the folder of what was written, in which the predictions have the name of their bag, or the JSON
    with one object for each.

    Raises:
        InputError: nothing is there, it is no run, or none of this bag.
    """
    path = Path(path)
    if path.suffix == ".json":
        return _read_json(path, bag)
    of_several = path / f"{name_of(bag)}.mcap"
    if path.is_dir() and not (path / "metadata.yaml").exists():
        if not of_several.exists():
            raise InputError(
                f"the baseline {path} has no {of_several.name}; write it with `impact-predictor replay -o`"
            )
        path = of_several
    return _read_bag(path)


def _read_json(path: Path, bag: str | os.PathLike[str]) -> tuple[Happened, ...]:
    try:
        answer = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"the baseline {path} cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise InputError(f"the baseline {path} is not JSON ({error}); {_HINT}") from error
    try:
        run = _run_of_bag(answer, bag) if isinstance(answer, list) else answer
        found = None if run is None else tuple(happened(fields) for fields in run["touchdowns"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"the baseline {path} is not the JSON of a replay; {_HINT}") from error
    if found is None:
        raise InputError(f"the baseline {path} has no run of {os.fspath(bag)}; replay that bag with --json again")
    return found


def _run_of_bag(runs: list[Any], bag: str | os.PathLike[str]) -> Any | None:
    """The only run of a bag of this path, or else of this name."""
    same = [run for run in runs if run["bag"] == os.fspath(bag)]
    same = same or [run for run in runs if name_of(run["bag"]) == name_of(bag)]
    return same[0] if len(same) == 1 and "touchdowns" in same[0] else None


def _read_bag(path: Path) -> tuple[Happened, ...]:
    recorded = topics(path)
    told = [topic for topic in recorded if f"{NODE}/" in topic and topic.endswith("/prediction")]
    if not told:
        raise InputError(f"the baseline {path} has no predictions: no topic {NODE}/prediction; {_HINT}")
    # A run without any touchdown has no scores.
    scores = [topic.removesuffix("prediction") + "score" for topic in told]
    wanted = {topic: DIAGNOSTIC_ARRAY for topic in scores if topic in recorded}
    if not wanted:
        return ()
    found = []
    for topic, _, data in read_messages(path, wanted):
        body = topic.rpartition(f"{NODE}/")[2].removesuffix("score").strip("/")
        try:
            found += [_told(body or one.hardware_id, one.values) for one in decode_diagnostic_array(data)]
        except (MalformedMessage, KeyError, ValueError) as error:
            raise InputError(f"the baseline {path} has a message on {topic} that is no score; {_HINT}") from error
    return tuple(found)


def _told(body: str, values: dict[str, str]) -> Happened:
    """The touchdown of a message on `~/score`."""

    def twist(name: str) -> Twist:
        return Twist(*(float(values[f"{name}.{part}"]) for part in Twist._fields))

    def number(name: str) -> float | None:
        return float(values[name]) if name in values else None

    def points(name: str) -> tuple[int, ...]:
        return tuple(map(int, values[name].split()))

    scored = values["scored"] == "true"
    return Happened(
        body,
        values.get("foot", ""),
        int(values["stamp"]),
        (points("old"), points("new")) if "old" in values else None,
        values["mode"],
        twist("before"),
        twist("predicted"),
        float(values["half_distance"]),
        scored,
        number("relative_error") if scored else None,
        number("time_error"),
    )
