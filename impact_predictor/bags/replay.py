"""A recorded bag through the predictor: the same messages in and out as on the node's topics."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from ..errors import InputError
from ..prediction.scene import CONTACT_GEOMETRY, STATES, Scene, inputs_of
from ..prediction.types import Status
from ..ros.messages import DIAGNOSTIC_ARRAY, INPUT_TYPES
from ..scenarios.truth import LANDING_TOPIC, ONSET_TOPIC, TRUTH_TOPIC
from .inputs import adapted_topics, find_topics
from .inputs import remapping as remapping
from .read import Bag, BagMessage
from .remarks import StatusCounts as StatusCounts
from .remarks import remarks, total_of, why_unpredictable
from .run import NODE as NODE
from .run import Run
from .run import Settled as Settled
from .write import BagWriter

if TYPE_CHECKING:
    from ..prediction.monitor import Monitor
    from ..prediction.recorded import Announced
    from ..scenarios.comparison import BodyTruth, Truth
    from ..scenarios.matching import Match
    from .body import Gait
    from .watched import WatchLog


class Result(NamedTuple):
    """What a replay found.

    `samples` counts the messages of odom, `seconds` is what everything took, reading and writing included. `statuses`
    and `geometry_statuses` say what became of the messages about states and about contact points of all bodies, and
    `inputs` the same for each input by its name. `notes` are sentences about choices that were made, what was refused
    and what looks wrong; `unpredictable` says why nothing could be predicted, and `damaged` what of the bag was lost,
    or "". `truth` is how the predictions compare with the truth, where the bag carries it, and `truths` the same for
    each body. `gaits` are those of the bodies that walk. `extent` has the stamps in ns of the first and the last sample
    that was accepted, `costs` the time in s that the answer to each took, and `matches` every true touchdown and every
    false alarm, where the bag carries the truth. `watch` is the log of a watch over a moving deck.
    """

    bag: str
    samples: int
    seconds: float
    settled: tuple[Settled, ...]
    statuses: StatusCounts
    geometry_statuses: StatusCounts
    notes: tuple[str, ...]
    unpredictable: str
    damaged: str
    truth: Truth | None = None
    truths: Mapping[str, BodyTruth] = MappingProxyType({})
    inputs: Mapping[str, StatusCounts] = MappingProxyType({})
    gaits: Mapping[str, Gait] = MappingProxyType({})
    extent: tuple[int, int] | None = None
    costs: Sequence[float] = ()
    matches: Sequence[Match] = ()
    recorded: Mapping[str, Announced] = MappingProxyType({})
    watch: WatchLog | None = None


def replay(
    path: str | os.PathLike[str],
    scenes: Scene | Mapping[str, Scene],
    remap: Mapping[str, str] | None = None,
    output: str | os.PathLike[str] | None = None,
    progress: Callable[[int], None] | None = None,
    markers: bool = False,
    monitor: Monitor | None = None,
    messages: str = "auto",
) -> Result:
    """Predict every touchdown of recorded bodies, and score it by what was recorded after it.

    `scenes` are those of the bodies by their names, or that of a body without one. `remap` gives the topics of the
    inputs, as in {"odom": "/cube/odom"} (see `find_topics`). With an `output` (see `BagWriter`) every message is
    written that the node would publish, `markers` too where they are asked for, with the log time of the input that
    caused it. `progress` is told now and then how many samples are done. `monitor` takes the messages in the place of
    a new one. `messages` is the parameter of that name.

    Messages are taken in the order of their log times, those of one log time in that of the recording. The node, which
    takes them as they arrive, gives the same answers to messages that arrive in this order.

    Raises:
        InputError: the bag cannot be read or lacks a topic, a remapping fits no input, or the output cannot be
            written or is the bag itself.
    """
    started = perf_counter()
    if output is not None and Path(output).resolve() == Path(path).resolve():
        raise InputError(f"{os.fspath(output)} is the bag itself; give the predictions another name")
    if isinstance(scenes, str | os.PathLike):
        raise InputError(f"{os.fspath(scenes)!r} names a file of scenes; give read_scenes({os.fspath(scenes)!r})")
    by_name = {"": scenes} if isinstance(scenes, Scene) else scenes
    damage: list[str] = []
    with ExitStack() as stack:
        bag = stack.enter_context(Bag(path))
        recorded = bag.topics()
        names, notes = find_topics(path, recorded, inputs_of(by_name), remap or {})
        adapted = adapted_topics(recorded, names)
        wanted = {topic: INPUT_TYPES[one.kind].name for one, topic in names.items()} | adapted
        truths = [one for one in (TRUTH_TOPIC, ONSET_TOPIC, LANDING_TOPIC) if recorded.get(one) == DIAGNOSTIC_ARRAY]
        knows_truth, knows_landings = TRUTH_TOPIC in truths, LANDING_TOPIC in truths
        if not knows_truth:
            truths = [one for one in truths if one == LANDING_TOPIC]
        wanted |= dict.fromkeys(truths, DIAGNOSTIC_ARRAY)
        recording, readers = bag.messages(wanted), {}
        if adapted:
            from .adapters import readers as readers_of

            readers = readers_of(bag, adapted)
        write = None if output is None else stack.enter_context(BagWriter(output)).write
        run = Run(
            by_name,
            names,
            write,
            readers,
            knows_truth=knows_truth,
            knows_landings=knows_landings,
            markers=markers,
            monitor=monitor,
            messages=messages,
        )
        run.take(_readable(recording, damage), progress)
        inputs = {one: _counts(counts) for one, counts in run.statuses.items()}
        if damage and not any(counts for one, counts in inputs.items() if one.kind in STATES):
            raise InputError(damage[0])
        run.finish()
    compared = None if run.comparison is None else run.comparison.compare()
    unpredictable = why_unpredictable(run, inputs, names, by_name)
    if not unpredictable:
        notes += tuple(f"in {os.fspath(path)}, {said}" for said in remarks(run, inputs, names, by_name))
    of_states = [counts for one, counts in inputs.items() if one.body is not None and one.kind in STATES]
    return Result(
        bag=os.fspath(path),
        samples=run.samples,
        seconds=perf_counter() - started,
        settled=tuple(run.settled),
        statuses=total_of(of_states),
        geometry_statuses=total_of([counts for one, counts in inputs.items() if one.kind == CONTACT_GEOMETRY]),
        notes=notes,
        unpredictable=unpredictable,
        damaged=damage[0] if damage else "",
        truth=None if compared is None else compared.together,
        truths={} if compared is None else compared.bodies,
        inputs={one.name: counts for one, counts in inputs.items()},
        gaits={body: record.gait for body, record in run.bodies.items() if record.gait is not None},
        extent=run.extent,
        costs=run.costs,
        matches=() if compared is None else compared.matches,
        recorded=run.recorded,
        watch=run.watch,
    )


def _readable(messages: Iterator[BagMessage], damage: list[str]) -> Iterator[BagMessage]:
    """The messages up to where a bag is damaged, and what is said about the damage."""
    try:
        yield from messages
    except InputError as error:
        damage.append(str(error))


def _counts(by_number: list[int]) -> StatusCounts:
    return {status: by_number[status] for status in Status if by_number[status]}
