"""A recorded bag through the predictor: the same messages in and out as on the node's topics."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Final, NamedTuple

from ..errors import InputError
from ..prediction.predictor import Predictor
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Sample, Score, Status
from ..ros.diagnostics import REMEDIES
from ..ros.messages import (
    DIAGNOSTIC_ARRAY,
    ODOMETRY,
    OUTPUTS,
    POLYGON,
    MalformedMessage,
    decode_odometry,
    decode_polygon,
)
from ..scenarios.truth import TRUTH_TOPIC, TrueImpact, decode_true_impacts
from .read import BagMessage, read_messages, topics
from .write import BagWriter

if TYPE_CHECKING:
    from ..scenarios.comparison import Announcements, Truth

INPUTS: Final = {"odom": ODOMETRY, "contact_geometry": POLYGON}
"""The inputs of the predictor by their relative names, with the types of their messages."""

NODE: Final = "/impact_predictor"
_REPORT_EVERY: Final = 256


class Settled(NamedTuple):
    """A touchdown that has happened: the body's frame, its score, and what the last prediction of it cost in s."""

    body: str
    score: Score
    cost: float | None


class Result(NamedTuple):
    """What a replay found.

    `samples` counts the messages of odom, `seconds` is what everything took, reading and writing included. `statuses`
    and `geometry_statuses` say what became of the messages of the two inputs. `notes` are sentences about choices that
    were made; `unpredictable` says why nothing could be predicted, and `damaged` what of the bag was lost, or "".
    `truth` is how the predictions compare with the true impacts, where the bag carries them.
    """

    bag: str
    samples: int
    seconds: float
    settled: tuple[Settled, ...]
    statuses: dict[Status, int]
    geometry_statuses: dict[Status, int]
    notes: tuple[str, ...]
    unpredictable: str
    damaged: str
    truth: Truth | None = None


def replay(
    path: str | os.PathLike[str],
    scene: Scene,
    remap: Mapping[str, str] | None = None,
    output: str | os.PathLike[str] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Result:
    """Predict every touchdown of a recorded body, and score it by what was recorded after it.

    `remap` gives the topics of the inputs, as in {"odom": "/cube/odom"}; without it the only topic of the right type
    is taken. With an `output` (see `BagWriter`) every message is written that the node would publish, with the log
    time of the input that caused it. `progress` is told now and then how many samples are done.

    Raises:
        InputError: the bag cannot be read or lacks a topic, a remapping fits no input, or the output cannot be
            written or is the bag itself.
    """
    started = perf_counter()
    if output is not None and Path(output).resolve() == Path(path).resolve():
        raise InputError(f"{os.fspath(output)} is the bag itself; give the predictions another name")
    recorded = topics(path)
    names, notes = _find_topics(path, recorded, scene, remap or {})
    wanted = {topic: INPUTS[name] for name, topic in names.items()}
    knows_truth = recorded.get(TRUTH_TOPIC) == DIAGNOSTIC_ARRAY
    if knows_truth:
        wanted[TRUTH_TOPIC] = DIAGNOSTIC_ARRAY
    messages = read_messages(path, wanted)
    run = _Run(scene, names, knows_truth)
    damage: list[str] = []
    with ExitStack() as stack:
        if output is not None:
            run.write = stack.enter_context(BagWriter(output)).write
        run.take(_readable(messages, damage), progress)
        if damage and not run.samples:
            raise InputError(damage[0])
        run.finish()
    return Result(
        os.fspath(path),
        run.samples,
        perf_counter() - started,
        tuple(run.settled),
        _counts(run.statuses),
        _counts(run.geometry_statuses),
        notes,
        run.why_unpredictable(),
        damage[0] if damage else "",
        run.truth(),
    )


def remapping(rules: tuple[str, ...]) -> dict[str, str]:
    """The remapping of rules like `odom:=/cube/odom`, as `replay` takes it.

    Raises:
        InputError: a rule is not of that form.
    """
    remap = {}
    for rule in rules:
        name, separator, topic = rule.partition(":=")
        if not (name and separator and topic):
            raise InputError(f"the remapping {rule!r} is not of the form from:=to; write for example odom:=/cube/odom")
        remap[name] = topic
    return remap


def _find_topics(
    path: str | os.PathLike[str], recorded: Mapping[str, str], scene: Scene, remap: Mapping[str, str]
) -> tuple[dict[str, str], tuple[str, ...]]:
    """The topic of each input that the scene needs and the bag has, and what was chosen without being told."""
    given = {}
    for name, topic in remap.items():
        relative = name.removeprefix("/")
        if relative not in INPUTS:
            raise InputError(f"the remapping {name}:={topic} is of no input; the inputs are {' and '.join(INPUTS)}")
        given[relative] = "/" + topic.removeprefix("/")
    found, chosen = {}, []
    for name, type_name in INPUTS.items():
        needed = not (name == "contact_geometry" and scene.points)
        of_type = [topic for topic, its_type in recorded.items() if its_type == type_name]
        if not needed:
            continue
        if name in given:
            found[name] = given[name]
        elif f"/{name}" in of_type or (not of_type and name == "odom"):
            # A missing state is reported by the reader, which says what there is instead.
            found[name] = f"/{name}"
        elif len(of_type) == 1:
            found[name] = of_type[0]
            chosen.append(f"{of_type[0]} as {name}")
        elif of_type:
            raise InputError(
                f"{os.fspath(path)} has {len(of_type)} topics that could be {name}: {', '.join(of_type)}; "
                f"choose one: --remap {name}:={of_type[0]}"
            )
    if len(set(found.values())) < len(found):
        raise InputError(f"{' and '.join(found)} cannot both be {found['odom']}; remap one of them to another topic")
    note = f"in {os.fspath(path)}, took {' and '.join(chosen)}: there is no other of the type"
    return found, (note,) if chosen else ()


def _readable(messages: Iterator[BagMessage], damage: list[str]) -> Iterator[BagMessage]:
    """The messages up to where a bag is damaged, and what is said about the damage."""
    try:
        yield from messages
    except InputError as error:
        damage.append(str(error))


def _counts(by_number: list[int]) -> dict[Status, int]:
    return {status: by_number[status] for status in Status if by_number[status]}


class _Run:
    """One bag on its way through the predictor."""

    def __init__(self, scene: Scene, names: Mapping[str, str], knows_truth: bool) -> None:
        self.write: Callable[[str, str, int, bytes], None] | None = None
        self.samples = 0
        self.settled: list[Settled] = []
        self.statuses = [0] * len(Status)
        self.geometry_statuses = [0] * len(Status)
        self._predictor = Predictor(scene)
        self._names = names
        self._outputs = [(f"{NODE}/{name}", *output) for name, output in OUTPUTS.items()]
        self._last: tuple[Sample, int] | None = None
        # What the predictions cost whose touchdowns may still be scored.
        self._costs: deque[tuple[int, float]] = deque(maxlen=256)
        self._true_impacts: list[TrueImpact] = []
        self._announcements: Announcements | None = None
        if knows_truth:
            from ..scenarios.comparison import Announcements

            self._announcements = Announcements()

    def take(self, messages: Iterator[BagMessage], progress: Callable[[int], None] | None) -> None:
        """Answer every message as the node would."""
        odom_topic, announcements = self._names["odom"], self._announcements
        statuses, update, costs = self.statuses, self._predictor.update, self._costs
        for topic, log_time, data in messages:
            if topic != odom_topic:
                self._take_true_impact(data) if topic == TRUTH_TOPIC else self._take_geometry(data)
                continue
            self.samples += 1
            if progress is not None and self.samples % _REPORT_EVERY == 0:
                progress(self.samples)
            try:
                sample = decode_odometry(data)
            except MalformedMessage:
                statuses[Status.MALFORMED] += 1
                continue
            began = perf_counter()
            prediction = update(sample)
            cost = perf_counter() - began
            statuses[prediction.status] += 1
            if prediction.status is not Status.ACCEPTED:
                continue
            self._last = sample, log_time
            if announcements is not None:
                announcements.add(prediction)
            if prediction.touchdown is not None:
                costs.append((sample.stamp, cost))
            if prediction.score is not None:
                self._settle(sample.child_frame_id, prediction.score)
            if self.write is not None:
                self._publish(prediction, log_time)

    def finish(self) -> None:
        """End the record: what it settles is written with the time of the last sample."""
        if self._last is None:
            return
        sample, log_time = self._last
        for score in self._predictor.finish():
            self._settle(sample.child_frame_id, score)
            if self.write is not None:
                _, type_name, encode = next(one for one in self._outputs if one[0] == f"{NODE}/score")
                data = encode(Prediction(Status.ACCEPTED, sample, None, score))
                if data is not None:
                    self.write(f"{NODE}/score", type_name, log_time, data)

    def why_unpredictable(self) -> str:
        """Why no sample could be answered with a touchdown, in one sentence, or ""."""
        if not self.samples:
            return f"there is no message on {self._names['odom']}, so nothing was predicted"
        if self.statuses[Status.ACCEPTED]:
            return ""
        status = max(Status, key=lambda status: self.statuses[status])
        if status is not Status.NO_GEOMETRY:
            refused = f"{self.statuses[status]} of {self.samples} messages on {self._names['odom']}"
            return f"no sample was accepted, so nothing was predicted: {refused} are {status.name}: {REMEDIES[status]}"
        topic = self._names.get("contact_geometry")
        where = f"there is no {POLYGON} in the bag" if topic is None else f"{topic} told none that can be used"
        return (
            f"no contact points are known, so nothing was predicted: {where}; "
            "give body.contact_points in the parameter file, or --remap contact_geometry:=TOPIC"
        )

    def truth(self) -> Truth | None:
        """How the predictions compare with the true impacts, where the bag has their topic."""
        if self._announcements is None:
            return None
        from ..scenarios.comparison import compare

        return compare(self._true_impacts, self._announcements, self._predictor.scene)

    def _take_geometry(self, data: bytes) -> None:
        try:
            status = self._predictor.set_geometry(decode_polygon(data))
        except MalformedMessage:
            status = Status.MALFORMED
        self.geometry_statuses[status] += 1

    def _take_true_impact(self, data: bytes) -> None:
        # What tells no impact there is another program's.
        with suppress(MalformedMessage):
            self._true_impacts += decode_true_impacts(data)

    def _settle(self, body: str, score: Score) -> None:
        cost = next((cost for stamp, cost in reversed(self._costs) if stamp <= score.stamp), None)
        self.settled.append(Settled(body, score, cost))

    def _publish(self, prediction: Prediction, log_time: int) -> None:
        assert self.write is not None
        for topic, type_name, encode in self._outputs:
            data = encode(prediction)
            if data is not None:
                self.write(topic, type_name, log_time, data)
