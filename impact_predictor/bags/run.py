"""One bag on its way through the predictors: every message is answered as the node would answer it."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from operator import add
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from ..prediction.flaws import flaw_of
from ..prediction.monitor import Monitor
from ..prediction.recorded import Announced
from ..prediction.scene import CONTACT_GEOMETRY, JOINTS, ODOM, SCHEDULE, WRENCH, Input, Scene
from ..prediction.types import FeetStates, Geometry, Joints, Sample, Status
from ..ros.inputs import route
from ..ros.messages import DIAGNOSTIC_ARRAY, INPUT_TYPES, MARKER_ARRAY, MalformedMessage, encode_reports, is_typed
from ..scenarios.truth import LANDING_TOPIC, ONSET_TOPIC, TRUTH_TOPIC, TrueImpact, TrueLanding, TrueOnset, decode_truths
from .body import NODE as NODE
from .body import BodyRecord, Write
from .body import Settled as Settled
from .read import BagMessage, UnusableMessage

if TYPE_CHECKING:
    from ..ros.markers.scene import MarkerScene
    from ..scenarios.comparison import Comparison
    from .adapters import AdapterReader
    from .watched import WatchLog, WatchRecorder

Take = Callable[[Any, int], Status]
"""Takes a message and its log time (ns); what became of it."""

_FITTING: Final = (Status.ACCEPTED, Status.BELOW_GROUND)
"""What becomes of contact points that fit the scene, wherever they are."""

_PROGRESS_EVERY: Final = 256


class Run:
    """The messages of one bag, in the order in which they were logged.

    `write` takes what the node would publish, with the log time of the message that caused it. `readers` read the
    topics whose messages have an adapter. `statuses` say what became of the messages on each input, and `flaws` what
    was wrong with the first one that was refused for a reason, as far as more is known of that. `bodies` are the
    records of the bodies that are predicted. `costs` are the times in s that the answers to the accepted samples took,
    without reading and writing. `comparison` has what the bag tells of what truly happened, where it does.
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
        knows_landings: bool = False,
        markers: bool,
        monitor: Monitor | None = None,
        messages: str = "auto",
    ) -> None:
        self.costs = array("d")
        self.settled: list[Settled] = []
        self.statuses = {one: [0] * len(Status) for one in topics}
        self.flaws: dict[tuple[Input, Status], str] = {}
        self.comparison: Comparison | None = None
        self.unnamed_feet: set[str] = set()
        self.monitor = Monitor(scenes) if monitor is None else monitor
        self._write, self._is_typed = write, is_typed(messages)
        self._drawing: MarkerScene | None = None
        self.watched: WatchRecorder | None = None
        if self.monitor.watch is not None and self.monitor.deck is not None:
            from .watched import WatchRecorder

            names = [name for name, scene in scenes.items() if scene.watching is not None]
            self.watched = WatchRecorder(self.monitor.watch, self.monitor.deck, names)
        self.bodies = {body: BodyRecord(body, scenes[body], write, messages) for body in self.monitor.predictors}
        takes = {one: self._take_of(one) for one in topics}
        self._takers: dict[str, Callable[[int, bytes], None]] = {
            topic: partial(self._take, one, INPUT_TYPES[one.kind].decode, takes[one])
            for one, topic in topics.items()
            if topic not in readers
        }
        for topic, read in readers.items():
            inputs = {one.kind: one for one, its_topic in topics.items() if its_topic == topic}
            self._takers[topic] = partial(self._take_adapted, read, inputs, takes)
        walks = any(scene.walking is not None for scene in scenes.values())
        if knows_truth or knows_landings or (readers and walks):
            from ..scenarios.comparison import Comparison

            known = self.comparison = Comparison(scenes, knows_impacts=knows_truth, knows_landings=knows_landings)
            if knows_landings:
                self._takers[LANDING_TOPIC] = partial(_take_truth, known.landings, TrueLanding)
            if knows_truth:
                self._takers[TRUTH_TOPIC] = partial(_take_truth, known.impacts, TrueImpact)
                self._takers[ONSET_TOPIC] = partial(_take_truth, known.onsets, TrueOnset)
        if markers:
            from ..ros.markers.scene import MarkerScene

            self._drawing = MarkerScene(self.monitor.scenes)

    @property
    def samples(self) -> int:
        """How many messages told the state of a body."""
        return sum(sum(counts) for one, counts in self.statuses.items() if one.kind == ODOM and one.body is not None)

    def take(self, messages: Iterable[BagMessage], progress: Callable[[int], None] | None) -> None:
        """Answer every message; `progress` is told now and then how many samples are done."""
        takers, watches = self._takers, self.monitor.watch is not None
        for number, (topic, log_time, data) in enumerate(messages, 1):
            takers[topic](log_time, data)
            if watches:
                self._report(log_time)
            if progress is not None and number % _PROGRESS_EVERY == 0:
                progress(self.samples)

    def finish(self) -> None:
        """End the record: what it settles is written with the time of the last sample of its body."""
        for body, scores in self.monitor.finish().items():
            self.settled += [self.bodies[body].end(score) for score in scores]

    @property
    def extent(self) -> tuple[int, int] | None:
        """Stamps in ns of the first and the last sample that was accepted; None without any."""
        firsts = [one.first.stamp for one in self.bodies.values() if one.first is not None]
        lasts = [one.last.stamp for one in self.bodies.values() if one.last is not None]
        return (min(firsts), max(lasts)) if firsts else None

    @property
    def watch(self) -> WatchLog | None:
        """The log of the watch; None where none watches over a moving deck."""
        if self.watched is None:
            return None
        return self.watched.log(None if self.comparison is None else self.comparison.events())

    @property
    def recorded(self) -> dict[str, Announced]:
        """The touchdowns that the samples of all bodies show, by kind."""
        found: dict[str, Announced] = {}
        for predictor in self.monitor.predictors.values():
            for kind, counts in predictor.contacts.recorded.items():
                found[kind] = Announced(*map(add, found.get(kind, (0, 0)), counts))
        return found

    def _take_of(self, one: Input) -> Take:
        """What takes a message on an input."""
        if one.kind == ODOM and one.body is not None:
            return partial(self._answer, self.bodies[one.body])
        return partial(self._tell, one, route(self.monitor, one))

    def _take(self, one: Input, decode: Callable[[bytes], Any], take: Take, log_time: int, data: bytes) -> None:
        message, status = None, Status.MALFORMED
        with suppress(MalformedMessage):
            message = decode(data)
            status = take(message, log_time)
        self._count(one, status, message)

    def _take_adapted(
        self, read: AdapterReader, inputs: Mapping[str, Input], takes: Mapping[Input, Take], log_time: int, data: bytes
    ) -> None:
        """Take a message that has an adapter as the messages on all inputs that it is told to be."""
        try:
            adapted = read(data)
        except MalformedMessage as error:
            for one in inputs.values():
                self._count(one, Status.MALFORMED, None)
                if isinstance(error, UnusableMessage):
                    self.flaws.setdefault((one, Status.MALFORMED), str(error))
            return
        sample, state = adapted.sample, inputs.get(ODOM)
        if adapted.stands and sample is not None and state is not None:
            record = self.bodies[state.body or ""]
            if record.gait is None:
                self.unnamed_feet.add(record.body)
            elif self.comparison is not None:
                read.check_stands(adapted, record.gait.feet)
                record.gait.tell(sample.stamp, adapted.stands)
                self.comparison.add_stances(record.body or sample.child_frame_id, sample.stamp, adapted.stands)
        # What is told about a body comes before its state, so that the state finds what it needs.
        told = (CONTACT_GEOMETRY, adapted.geometry), (JOINTS, adapted.joints), (SCHEDULE, adapted.schedule)
        for kind, message in (*told, *[(WRENCH, wrench) for wrench in adapted.wrenches], (ODOM, sample)):
            if message is not None and kind in inputs:
                self._count(inputs[kind], takes[inputs[kind]](message, log_time), message)

    def _count(self, one: Input, status: Status, message: Any) -> None:
        """Note what became of a message, and what is wrong with the first one that is refused so."""
        self.statuses[one][status] += 1
        if status is not Status.ACCEPTED and (one, status) not in self.flaws:
            flaw = flaw_of(self.monitor, one.body, status, message)
            if flaw:
                self.flaws[one, status] = flaw

    def _answer(self, record: BodyRecord, sample: Sample, log_time: int) -> Status:
        began = perf_counter()
        prediction = self.monitor.update(record.body, sample)
        cost = perf_counter() - began
        if prediction.status is Status.ACCEPTED:
            self.costs.append(cost)
            record.answered(prediction, log_time, cost)
            if self.comparison is not None:
                self.comparison.add(prediction, record.body)
            if prediction.score is not None:
                self.settled.append(record.settle(prediction.score))
            if self._drawing is not None:
                self._drawing.take(record.body, prediction)
                self._draw(sample.stamp, log_time)
        return prediction.status

    def _tell(self, one: Input, update: Callable[[Any], Status], message: Any, log_time: int) -> Status:
        """Hand on what is no state of a body; contact points that it tells are noted, and what moves by it is drawn."""
        status, record = update(message), self.bodies.get(one.body or "")
        if record is not None and status in _FITTING and isinstance(message, Geometry | FeetStates | Joints):
            told = message if isinstance(message, Geometry) else self.monitor.predictors[record.body].contacts.geometry
            if told is not None:
                record.take_geometry(told)
        if status is Status.ACCEPTED and self._drawing is not None:
            # Over its points a machine moves.
            moves = one.kind == CONTACT_GEOMETRY and record is not None and record.gait is not None
            if self._drawing.hear(self.monitor, one, message) or moves:
                self._draw(message.stamp, log_time)
        return status

    def _report(self, log_time: int) -> None:
        """Write what is to be said of the units now."""
        reports = self.monitor.reports()
        if self.watched is not None:
            self.watched.take(reports)
            self.watched.look()
        if not reports:
            return
        if self.comparison is not None:
            self.comparison.add_reports(reports)
        if self._drawing is not None:
            self._drawing.take_reports(reports)
        if self._write is not None:
            stamp, deck = max(report.stamp for report in reports), self.monitor.deck_report(reports)
            self._write("/diagnostics", DIAGNOSTIC_ARRAY, log_time, encode_reports(reports, stamp, deck=deck))
            if self._is_typed:
                from ..ros.messages.deck_state import DECK_STATE, encode_deck_state

                self._write(f"{NODE}/deck", DECK_STATE.type_name, log_time, encode_deck_state(reports, deck))

    def _draw(self, stamp: int, log_time: int) -> None:
        if self._drawing is not None and self._write is not None:
            data = self._drawing.due(stamp)
            if data is not None:
                self._write(f"{NODE}/markers", MARKER_ARRAY, log_time, data)


def _take_truth(known: list[Any], kind: type, _: int, data: bytes) -> None:
    # What tells no truth there is another program's.
    with suppress(MalformedMessage):
        known.extend(decode_truths(kind, data))
