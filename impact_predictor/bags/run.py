"""One bag on its way through the predictors: every message is answered as the node would answer it."""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..prediction.monitor import Monitor
from ..prediction.scene import CONTACT_GEOMETRY, IMU, JOINTS, ODOM, SCHEDULE, WRENCH, Input, Scene
from ..prediction.types import Geometry, Imu, Joints, Prediction, Sample, Score, Status
from ..ros.messages import (
    DIAGNOSTIC_ARRAY,
    INPUT_TYPES,
    MARKER_ARRAY,
    OUTPUTS,
    MalformedMessage,
    decode_odometry,
    encode_reports,
)
from .read import BagMessage, UnusableMessage

if TYPE_CHECKING:
    from ..ros.markers.scene import MarkerScene
    from ..scenarios.comparison import Landings
    from .adapters import AdapterReader
    from .events import Gait, TrueEvents
    from .remarks import ContactPoints

Write = Callable[[str, str, int, bytes], None]
"""Takes topic, type, log time (ns) and bytes of a message."""

NODE: Final = "/impact_predictor"
"""The name of the node whose topics are written."""

_REMEMBERED: Final = 256

Take = Callable[[Any, int], Status]
"""Takes a message that asks for no answer, and its log time (ns)."""

_PROGRESS_EVERY: Final = 256


class Settled(NamedTuple):
    """A touchdown that has happened: the body, its score, and what the last prediction of it cost in s.

    The body goes by its name, or where it has none by its frame.
    """

    body: str
    score: Score
    cost: float | None


class BodyStream:
    """The answers to the samples of one body."""

    def __init__(self, body: str, update: Callable[[Sample], Prediction], write: Write | None) -> None:
        self.body = body
        self.update = update
        prefix = f"{NODE}/{body}/" if body else f"{NODE}/"
        self._write = write
        self._outputs = [(prefix + name, *output) for name, output in OUTPUTS.items()]
        self._first: int | None = None
        self._last: tuple[Sample, int] | None = None
        # What the predictions cost whose touchdowns may still be scored.
        self._costs: deque[tuple[int, float]] = deque(maxlen=_REMEMBERED)

    def answered(self, prediction: Prediction, log_time: int, cost: float) -> None:
        """Write the answer to a sample of a log time in ns, which took a time in s."""
        self._last = prediction.sample, log_time
        if self._first is None:
            self._first = prediction.sample.stamp
        if prediction.touchdown is not None:
            self._costs.append((prediction.sample.stamp, cost))
        if self._write is not None:
            for topic, type_name, encode in self._outputs:
                data = encode(prediction)
                if data is not None:
                    self._write(topic, type_name, log_time, data)

    @property
    def extent(self) -> tuple[int, int] | None:
        """Stamps in ns of the first and the last sample that was answered; None without any."""
        return None if self._first is None or self._last is None else (self._first, self._last[0].stamp)

    def settle(self, score: Score) -> Settled:
        """The touchdown of a score."""
        cost = next((cost for stamp, cost in reversed(self._costs) if stamp <= score.stamp), None)
        frame = "" if self._last is None else self._last[0].child_frame_id
        return Settled(self.body or frame, score, cost)

    def end(self, score: Score) -> Settled:
        """The touchdown of a score that came with the end, written with the time of the last sample."""
        if self._write is not None and self._last is not None:
            sample, log_time = self._last
            topic, type_name, encode = next(one for one in self._outputs if one[0].endswith("/score"))
            data = encode(Prediction(Status.ACCEPTED, sample, None, score))
            if data is not None:
                self._write(topic, type_name, log_time, data)
        return self.settle(score)


class Run:
    """The messages of one bag, in the order in which they were logged.

    `write` takes what the node would publish, with the log time of the message that caused it. `readers` read the
    topics whose messages have an adapter. `statuses` say what became of the messages on each input, `unusable` what an
    adapter said of the first one that it refused, and `points` what is known of the contact points of each body.
    `costs` are the times in s that the answers to the accepted samples took, without reading and writing.
    `truth` is what the bag tells of what truly happened, where it does.
    `unnamed_feet` are the bodies whose messages tell which feet stand, though their scene names none.
    """

    def __init__(
        self,
        scenes: Mapping[str, Scene],
        topics: Mapping[Input, str],
        write: Write | None,
        readers: Mapping[str, AdapterReader] = MappingProxyType({}),
        *,
        knows_truth: bool,
        markers: bool,
        monitor: Monitor | None = None,
    ) -> None:
        self.samples = 0
        self.costs = array("d")
        self.settled: list[Settled] = []
        self.statuses = {one: [0] * len(Status) for one in topics}
        self.unusable: dict[Input, str] = {}
        self.points: dict[str, ContactPoints] = {}
        self.truth: TrueEvents | None = None
        self.landings: Landings | None = None
        self.gaits: dict[str, Gait] = {}
        self.unnamed_feet: set[str] = set()
        self.monitor = Monitor(scenes) if monitor is None else monitor
        self._write = write
        self._drawing: MarkerScene | None = None
        self._watches = self.monitor.watch is not None
        self._streams = {
            body: BodyStream(body, partial(self.monitor.update, body) if self._watches else predictor.update, write)
            for body, predictor in self.monitor.predictors.items()
        }
        telling = [one.body or "" for one in topics if one.kind in (CONTACT_GEOMETRY, JOINTS)]
        if telling:
            from .remarks import ContactPoints

            self.points = {
                body: ContactPoints(scenes[body], self.monitor.predictors[body].contacts) for body in telling
            }
        self._takers = {topic: self._taker(one) for one, topic in topics.items() if topic not in readers}
        for topic, read in readers.items():
            inputs = {one.kind: one for one, its_topic in topics.items() if its_topic == topic}
            takes = {kind: self._taker_of(one) for kind, one in inputs.items() if kind != ODOM}
            self._takers[topic] = partial(self._take_adapted, read, inputs, takes)
        walking = {body: scene.walking for body, scene in scenes.items() if scene.walking is not None}
        if walking:
            from .events import Gait

            self.gaits = {body: Gait(one) for body, one in walking.items()}
        if readers and walking:
            from ..scenarios.comparison import Landings

            self.landings = Landings(scenes)
        if knows_truth:
            from .events import TrueEvents

            self.truth = TrueEvents(watches=self._watches)
            self._takers |= self.truth.takers
        if markers:
            from ..ros.markers.scene import MarkerScene

            self._drawing = MarkerScene(self.monitor.scenes)

    def take(self, messages: Iterable[BagMessage], progress: Callable[[int], None] | None) -> None:
        """Answer every message; `progress` is told now and then how many samples are done."""
        takers, watches, due = self._takers, self._watches, _PROGRESS_EVERY
        for topic, log_time, data in messages:
            takers[topic](log_time, data)
            if watches:
                self._report(log_time)
            if progress is not None and self.samples >= due:
                due = self.samples + _PROGRESS_EVERY
                progress(self.samples)

    def finish(self) -> None:
        """End the record: what it settles is written with the time of the last sample of its body."""
        for body, scores in self.monitor.finish().items():
            stream = self._streams[body]
            self.settled += [stream.end(score) for score in scores]

    @property
    def extent(self) -> tuple[int, int] | None:
        """Stamps in ns of the first and the last sample that was accepted; None without any."""
        extents = [stream.extent for stream in self._streams.values() if stream.extent is not None]
        return (min(first for first, _ in extents), max(last for _, last in extents)) if extents else None

    def _taker(self, one: Input) -> Callable[[int, bytes], None]:
        """What takes the messages on an input, as log time in ns and bytes."""
        if one.kind == ODOM and one.body is not None:
            return partial(self._take_sample, self._streams[one.body], self.statuses[one])
        return partial(self._take_other, INPUT_TYPES[one.kind].decode, self._taker_of(one), self.statuses[one])

    def _taker_of(self, one: Input) -> Take:
        """What takes a message on an input that asks for no answer."""
        monitor, body = self.monitor, one.body
        if body is None:
            return partial(self._set_support, monitor.update_support_imu if one.kind == IMU else monitor.update_support)
        if one.kind == IMU:
            return partial(self._set_tilt, body)
        if one.kind == CONTACT_GEOMETRY:
            return partial(self._set_geometry, body)
        if one.kind == JOINTS:
            return partial(self._set_joints, body)
        return lambda message, _: monitor.tell(body, message)

    def _take_sample(self, stream: BodyStream, counts: list[int], log_time: int, data: bytes) -> None:
        self.samples += 1
        try:
            sample = decode_odometry(data)
        except MalformedMessage:
            counts[Status.MALFORMED] += 1
            return
        self._answer(stream, counts, log_time, sample)

    def _answer(self, stream: BodyStream, counts: list[int], log_time: int, sample: Sample) -> None:
        began = perf_counter()
        prediction = stream.update(sample)
        cost = perf_counter() - began
        counts[prediction.status] += 1
        if stream.body in self.points:
            self.points[stream.body].take(prediction)
        if prediction.status is not Status.ACCEPTED:
            return
        self.costs.append(cost)
        stream.answered(prediction, log_time, cost)
        if self.truth is not None:
            self.truth.announcements.add(prediction, stream.body)
        if self.landings is not None:
            self.landings.add(prediction, stream.body)
        if stream.body in self.gaits:
            self.gaits[stream.body].take(prediction)
        if prediction.score is not None:
            self.settled.append(stream.settle(prediction.score))
        if self._drawing is not None:
            self._drawing.take(stream.body, prediction)
            self._draw(sample.stamp, log_time)

    def _take_other(
        self, decode: Callable[[bytes], Any], take: Take, counts: list[int], log_time: int, data: bytes
    ) -> None:
        status = Status.MALFORMED
        with suppress(MalformedMessage):
            status = take(decode(data), log_time)
        counts[status] += 1

    def _take_adapted(
        self, read: AdapterReader, inputs: Mapping[str, Input], takes: Mapping[str, Take], log_time: int, data: bytes
    ) -> None:
        """Take a message that has an adapter as the messages on all inputs that it is told to be."""
        state = inputs.get(ODOM)
        self.samples += state is not None
        try:
            adapted = read(data)
        except MalformedMessage as error:
            for one in inputs.values():
                self.statuses[one][Status.MALFORMED] += 1
                if isinstance(error, UnusableMessage):
                    self.unusable.setdefault(one, str(error))
            return
        about = (CONTACT_GEOMETRY, adapted.geometry), (JOINTS, adapted.joints), (SCHEDULE, adapted.schedule)
        for kind, message in (*about, *[(WRENCH, wrench) for wrench in adapted.wrenches]):
            if message is not None and kind in takes:
                self.statuses[inputs[kind]][takes[kind](message, log_time)] += 1
        sample = adapted.sample
        if sample is not None and state is not None:
            stream = self._streams[state.body or ""]
            if adapted.stands and stream.body not in self.gaits:
                self.unnamed_feet.add(stream.body)
            elif adapted.stands and self.landings is not None:
                read.check_stands(adapted, self.gaits[stream.body].feet)
                self.landings.tell(stream.body or sample.child_frame_id, sample.stamp, adapted.stands)
                self.gaits[stream.body].tell(sample.stamp, adapted.stands)
            self._answer(stream, self.statuses[state], log_time, sample)

    def _set_geometry(self, body: str, geometry: Geometry, log_time: int) -> Status:
        status = self.monitor.set_geometry(body, geometry)
        self.points[body].take_geometry(geometry, status)
        if status is Status.ACCEPTED and self._drawing is not None:
            self._drawing.set_geometry(body, geometry)
            if body in self.gaits:
                self._draw(geometry.stamp, log_time)
        return status

    def _set_joints(self, body: str, joints: Joints, _: int) -> Status:
        status = self.monitor.tell(body, joints)
        self.points[body].take_joints(joints, status)
        return status

    def _set_support(self, update: Callable[[Any], Status], message: Sample | Imu, log_time: int) -> Status:
        status, deck = update(message), self.monitor.deck
        if status is Status.ACCEPTED and self._drawing is not None and deck is not None and deck.last is not None:
            self._drawing.take_support(deck.last)
            self._draw(message.stamp, log_time)
        return status

    def _set_tilt(self, body: str, imu: Imu, log_time: int) -> Status:
        status = self.monitor.update_imu(body, imu)
        if status is Status.ACCEPTED and self._drawing is not None:
            self._drawing.take_tilt(body, imu.stamp, self.monitor.tilts[body])
            self._draw(imu.stamp, log_time)
        return status

    def _report(self, log_time: int) -> None:
        """Write what is to be said of the units now."""
        reports = self.monitor.reports()
        if not reports:
            return
        if self.truth is not None and self.truth.warnings is not None:
            self.truth.warnings.take(reports)
        if self._drawing is not None:
            self._drawing.take_reports(reports)
        if self._write is not None:
            stamp = max(report.stamp for report in reports)
            self._write("/diagnostics", DIAGNOSTIC_ARRAY, log_time, encode_reports(reports, stamp))

    def _draw(self, stamp: int, log_time: int) -> None:
        if self._drawing is not None and self._write is not None:
            data = self._drawing.due(stamp)
            if data is not None:
                self._write(f"{NODE}/markers", MARKER_ARRAY, log_time, data)
