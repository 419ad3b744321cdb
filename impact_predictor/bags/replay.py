"""A recorded bag through the predictor: the same messages in and out as on the node's topics."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from ..errors import InputError
from ..prediction.inputs import CONTACT_GEOMETRY, Input, inputs_of
from ..prediction.remedies import REMEDIES
from ..prediction.scene import Scene
from ..prediction.types import Status
from ..ros.messages import DIAGNOSTIC_ARRAY, POLYGON
from ..scenarios.truth import ONSET_TOPIC, TRUTH_TOPIC
from .inputs import TYPES, find_topics
from .inputs import remapping as remapping
from .read import BagMessage, read_messages, topics
from .run import NODE as NODE
from .run import Run
from .run import Settled as Settled
from .write import BagWriter

if TYPE_CHECKING:
    from ..scenarios.comparison import Truth
    from ..scenarios.warned import Warned

Statuses = dict[Status, int]


class BodyTruth(NamedTuple):
    """How the predictions of a body compare with what happened to it, and whether it was warned of; None where not."""

    truth: Truth | None
    warned: Warned | None


class Result(NamedTuple):
    """What a replay found.

    `samples` counts the messages of odom, `seconds` is what everything took, reading and writing included. `statuses`
    and `geometry_statuses` say what became of the messages about states and about contact points of all bodies, and
    `inputs` the same for each input by its name. `notes` are sentences about choices that were made; `unpredictable`
    says why nothing could be predicted, and `damaged` what of the bag was lost, or "". `truth` is how the predictions
    compare with the true impacts, where the bag carries them, and `truths` the same for each body.
    """

    bag: str
    samples: int
    seconds: float
    settled: tuple[Settled, ...]
    statuses: Statuses
    geometry_statuses: Statuses
    notes: tuple[str, ...]
    unpredictable: str
    damaged: str
    truth: Truth | None = None
    truths: Mapping[str, BodyTruth] = MappingProxyType({})
    inputs: Mapping[str, Statuses] = MappingProxyType({})


def replay(
    path: str | os.PathLike[str],
    scenes: Scene | Mapping[str, Scene],
    remap: Mapping[str, str] | None = None,
    output: str | os.PathLike[str] | None = None,
    progress: Callable[[int], None] | None = None,
    markers: bool = False,
) -> Result:
    """Predict every touchdown of recorded bodies, and score it by what was recorded after it.

    `scenes` are those of the bodies by their names, or that of a body without one. `remap` gives the topics of the
    inputs, as in {"odom": "/cube/odom"} (see `find_topics`). With an `output` (see `BagWriter`) every message is
    written that the node would publish, `markers` too where they are asked for, with the log time of the input that
    caused it. `progress` is told now and then how many samples are done.

    Messages are taken in the order of their log times, those of one log time in that of the recording. The node, which
    takes them as they arrive, gives the same answers to messages that arrive in this order.

    Raises:
        InputError: the bag cannot be read or lacks a topic, a remapping fits no input, or the output cannot be
            written or is the bag itself.
    """
    started = perf_counter()
    if output is not None and Path(output).resolve() == Path(path).resolve():
        raise InputError(f"{os.fspath(output)} is the bag itself; give the predictions another name")
    by_name = {"": scenes} if isinstance(scenes, Scene) else scenes
    recorded = topics(path)
    names, notes = find_topics(path, recorded, inputs_of(by_name), remap or {})
    wanted = {topic: TYPES[one.kind] for one, topic in names.items()}
    knows_truth = recorded.get(TRUTH_TOPIC) == DIAGNOSTIC_ARRAY
    if knows_truth:
        wanted |= {one: DIAGNOSTIC_ARRAY for one in (TRUTH_TOPIC, ONSET_TOPIC) if recorded.get(one) == DIAGNOSTIC_ARRAY}
    messages = read_messages(path, wanted)
    damage: list[str] = []
    with ExitStack() as stack:
        write = None if output is None else stack.enter_context(BagWriter(output)).write
        run = Run(by_name, names, write, knows_truth=knows_truth, markers=markers)
        run.take(_readable(messages, damage), progress)
        inputs = {one: _counts(counts) for one, counts in run.statuses.items()}
        if damage and not any(counts for one, counts in inputs.items() if one.kind != CONTACT_GEOMETRY):
            raise InputError(damage[0])
        run.finish()
    truth, truths = _compare(run, by_name)
    return Result(
        os.fspath(path),
        run.samples,
        perf_counter() - started,
        tuple(run.settled),
        _sum([counts for one, counts in inputs.items() if one.body is not None and one.kind != CONTACT_GEOMETRY]),
        _sum([counts for one, counts in inputs.items() if one.kind == CONTACT_GEOMETRY]),
        notes,
        _why_unpredictable(inputs, names),
        damage[0] if damage else "",
        truth,
        truths,
        {one.name: counts for one, counts in inputs.items()},
    )


def _readable(messages: Iterator[BagMessage], damage: list[str]) -> Iterator[BagMessage]:
    """The messages up to where a bag is damaged, and what is said about the damage."""
    try:
        yield from messages
    except InputError as error:
        damage.append(str(error))


def _counts(by_number: list[int]) -> Statuses:
    return {status: by_number[status] for status in Status if by_number[status]}


def _sum(counts: list[Statuses]) -> Statuses:
    total = sum(map(Counter, counts), Counter[Status]())
    return {status: total[status] for status in Status if total[status]}


def _why_unpredictable(inputs: Mapping[Input, Statuses], names: Mapping[Input, str]) -> str:
    """Why no state could be used, in one sentence, or ""."""
    states = {one: counts for one, counts in inputs.items() if one.body is not None and one.kind != CONTACT_GEOMETRY}
    # Bodies of which nothing is measured are watched by the motion of the support alone.
    states = states or dict(inputs)
    if not states:
        return "nothing is measured in this scene, so there is nothing for it in a bag"
    counts = _sum(list(states.values()))
    where = ", ".join(names[one] for one in states)
    if not counts:
        return f"there is no message on {where}, so nothing was predicted"
    if Status.ACCEPTED in counts:
        return ""
    status = max(counts, key=lambda status: counts[status])
    if status is not Status.NO_GEOMETRY:
        refused = f"{counts[status]} of {sum(counts.values())} messages on {where}"
        return f"no sample was accepted, so nothing was predicted: {refused} are {status.name}: {REMEDIES[status]}"
    topics_of_points = [topic for one, topic in names.items() if one.kind == CONTACT_GEOMETRY]
    told = f"{', '.join(topics_of_points)} told none that can be used"
    where = told if topics_of_points else f"there is no {POLYGON} in the bag"
    return (
        f"no contact points are known, so nothing was predicted: {where}; "
        "give body.contact_points in the parameter file, or --remap contact_geometry:=TOPIC"
    )


def _compare(run: Run, scenes: Mapping[str, Scene]) -> tuple[Truth | None, dict[str, BodyTruth]]:
    """How the predictions compare with the true impacts, all together and of each body."""
    if run.announcements is None:
        return None, {}
    from ..scenarios.comparison import compare

    together, bodies = compare(run.true_impacts, run.announcements, scenes)
    warned = run.warned({body: scene for body, scene in scenes.items() if scene.watching is not None})
    return together, {body: BodyTruth(bodies.get(body), warned.get(body)) for body in {**bodies, **warned}}
