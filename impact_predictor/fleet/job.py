"""What is asked of every bag, and what became of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ..bags.replay import Result, replay
from ..errors import InputError
from ..prediction.scene import Scene


class Job(NamedTuple):
    """What is asked of every bag: arguments of `bags.replay.replay`, and whether the `answers` in JSON are wanted, and
    logs of watches over a deck; `messages` as the parameter.
    """

    scenes: Mapping[str, Scene]
    remap: Mapping[str, str]
    markers: bool = False
    answers: bool = False
    logs: bool = False
    messages: str = "auto"


class BagOutcome(NamedTuple):
    """What became of a bag: its result and, where it is wanted, the JSON; without a result `error` says why.

    It grows with the touchdowns of the bag, not with its samples, so that it is fit to be sent.
    """

    bag: str
    result: Result | None
    answer: dict[str, Any]
    error: str = ""


def failed(bag: str, error: str) -> BagOutcome:
    """The outcome of a bag that was not replayed, and why in one sentence."""
    return BagOutcome(bag, None, {"bag": bag, "error": error}, error)


def replay_bag(job: Job, bag: str, output: Path | None, progress: Callable[[int], None] | None = None) -> BagOutcome:
    """Replay a bag into an output, if any; `progress` is told now and then how many samples are done."""
    try:
        result = replay(bag, job.scenes, job.remap, output, progress, job.markers, messages=job.messages)
    except InputError as error:
        return failed(bag, str(error))
    except MemoryError:
        return failed(bag, f"{bag} needs more memory than there is; use fewer workers, or a machine with more of it")
    answer: dict[str, Any] = {}
    if job.answers:
        from ..report.answers import as_json

        answer = as_json(result)
    kept = result._replace(costs=(), matches=(), watch=result.watch if job.logs else None)
    return BagOutcome(bag, kept, answer)


def renamed(outcome: BagOutcome, names: Mapping[str, str]) -> BagOutcome:
    """An outcome that calls its bag and what else it speaks of by other names, a name for each path."""

    def said(words: str) -> str:
        for path, name in names.items():
            words = words.replace(path, name)
        return words

    result, answer = outcome.result, outcome.answer
    if result is not None:
        result = result._replace(
            bag=said(result.bag),
            notes=tuple(map(said, result.notes)),
            unpredictable=said(result.unpredictable),
            damaged=said(result.damaged),
        )
    answer = {key: said(value) if isinstance(value, str) else value for key, value in answer.items()}
    if "notes" in answer:
        answer["notes"] = list(map(said, answer["notes"]))
    return BagOutcome(said(outcome.bag), result, answer, said(outcome.error))
