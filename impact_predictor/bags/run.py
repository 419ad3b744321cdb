"""One bag on its way through the predictors: every message is answered as the node would answer it."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..prediction.inputs import CONTACT_GEOMETRY, IMU, Input
from ..prediction.monitor import Monitor
from ..prediction.scene import Scene
from ..prediction.types import Imu, Prediction, Sample, Score, Status
from ..ros.messages import DIAGNOSTIC_ARRAY, MARKER_ARRAY, OUTPUTS, MalformedMessage, decode_odometry, decode_polygon
from ..scenarios.truth import (
    ONSET_TOPIC,
    TRUTH_TOPIC,
    TrueImpact,
    TrueOnset,
    decode_true_impacts,
    decode_true_onsets,
)
from .read import BagMessage

if TYPE_CHECKING:
    from ..ros.markers.scene import MarkerScene
    from ..scenarios.comparison import Announcements
    from ..scenarios.warned import Warned, Warnings

Write = Callable[[str, str, int, bytes], None]
"""Takes topic, type, log time (ns) and bytes of a message."""

NODE: Final = "/impact_predictor"
"""The name of the node whose topics are written."""

_TELL_EVERY: Final = 256
_REMEMBERED: Final = 256


class Settled(NamedTuple):
    """A touchdown that has happened: the body, its score, and what the last prediction of it cost in s.

    The body goes by its name, or where it has none by its frame.
    """

    body: str
    score: Score
    cost: float | None


class Run:
    """The messages of one bag, in the order in which they were logged.

    `write` takes what the node would publish, with the log time of the message that caused it. `statuses` say what
    became of the messages on each input, by its name.
    """

    def __init__(
        self,
        scenes: Mapping[str, Scene],
        topics: Mapping[Input, str],
        write: Write | None,
        *,
        knows_truth: bool,
        markers: bool,
    ) -> None:
        self.samples = 0
        self.settled: list[Settled] = []
        self.statuses = {one: [0] * len(Status) for one in topics}
        self.true_impacts: list[TrueImpact] = []
        self.true_onsets: list[TrueOnset] = []
        self.announcements: Announcements | None = None
        self.warnings: Warnings | None = None
        self.monitor = Monitor(scenes)
        self._write = write
        self._drawing: MarkerScene | None = None
        self._watches = self.monitor.watch is not None
        self._streams = {
            body: _Stream(body, partial(self.monitor.update, body) if self._watches else predictor.update, write)
            for body, predictor in self.monitor.predictors.items()
        }
        self._takers = {topic: self._taker(one) for one, topic in topics.items()}
        if knows_truth:
            from ..scenarios.comparison import Announcements

            self.announcements = Announcements()
            self._takers[TRUTH_TOPIC] = self._take_true_impact
            self._takers[ONSET_TOPIC] = self._take_true_onset
            if self._watches:
                from ..scenarios.warned import Warnings

                self.warnings = Warnings()
        if markers:
            from ..ros.markers.scene import MarkerScene

            self._drawing = MarkerScene(scenes)

    def take(self, messages: Iterable[BagMessage], progress: Callable[[int], None] | None) -> None:
        """Answer every message; `progress` is told now and then how many samples are done."""
        takers, watches, told = self._takers, self._watches, _TELL_EVERY
        for topic, log_time, data in messages:
            takers[topic](log_time, data)
            if watches:
                self._report(log_time)
            if progress is not None and self.samples >= told:
                told = self.samples + _TELL_EVERY
                progress(self.samples)

    def finish(self) -> None:
        """End the record: what it settles is written with the time of the last sample of its body."""
        for body, scores in self.monitor.finish().items():
            stream = self._streams[body]
            self.settled += [stream.end(score) for score in scores]

    def warned(self, bodies: Iterable[str]) -> dict[str, Warned]:
        """How bodies were warned of, where the bag tells what happened to them."""
        if self.warnings is None or self.announcements is None:
            return {}
        names = self.announcements.names
        impacts: dict[str, list[TrueImpact]] = defaultdict(list)
        onsets: dict[str, list[TrueOnset]] = defaultdict(list)
        for impact in self.true_impacts:
            impacts[names.get(impact.body, impact.body)].append(impact)
        for onset in self.true_onsets:
            onsets[names.get(onset.body, onset.body)].append(onset)
        # A body alone may have no name; it goes by its frame.
        frame = next(iter([*names.values(), *impacts]), "")
        return {body or frame: self.warnings.of(body, impacts[body or frame], onsets[body or frame]) for body in bodies}

    def _taker(self, one: Input) -> Callable[[int, bytes], None]:
        """What takes the messages on an input, as log time in ns and bytes."""
        counts, monitor = self.statuses[one], self.monitor
        if one.kind == CONTACT_GEOMETRY:
            return partial(self._take_geometry, one.body or "", counts)
        if one.kind == IMU:
            from ..ros.messages.imu import decode_imu

            if one.body is not None:
                return partial(self._take_tilt, one.body, decode_imu, counts)
            return partial(self._take_support, decode_imu, monitor.update_support_imu, counts)
        if one.body is not None:
            return partial(self._take_sample, self._streams[one.body], counts)
        return partial(self._take_support, decode_odometry, monitor.update_support, counts)

    def _take_sample(self, stream: _Stream, counts: list[int], log_time: int, data: bytes) -> None:
        self.samples += 1
        try:
            sample = decode_odometry(data)
        except MalformedMessage:
            counts[Status.MALFORMED] += 1
            return
        began = perf_counter()
        prediction = stream.update(sample)
        cost = perf_counter() - began
        counts[prediction.status] += 1
        if prediction.status is not Status.ACCEPTED:
            return
        stream.answered(prediction, log_time, cost)
        if self.announcements is not None:
            self.announcements.add(prediction, stream.body)
        if prediction.score is not None:
            self.settled.append(stream.settle(prediction.score))
        if self._drawing is not None:
            self._drawing.take(stream.body, prediction)
            self._draw(sample.stamp, log_time)

    def _take_geometry(self, body: str, counts: list[int], log_time: int, data: bytes) -> None:
        status = Status.MALFORMED
        with suppress(MalformedMessage):
            geometry = decode_polygon(data)
            status = self.monitor.set_geometry(body, geometry)
        counts[status] += 1
        if status is Status.ACCEPTED and self._drawing is not None:
            self._drawing.set_geometry(body, geometry)

    def _take_support(
        self,
        decode: Callable[[bytes], Any],
        update: Callable[[Any], Status],
        counts: list[int],
        log_time: int,
        data: bytes,
    ) -> None:
        status = Status.MALFORMED
        with suppress(MalformedMessage):
            message = decode(data)
            status = update(message)
        counts[status] += 1
        deck = self.monitor.deck
        if status is Status.ACCEPTED and self._drawing is not None and deck is not None and deck.last is not None:
            self._drawing.take_support(deck.last)
            self._draw(message.stamp, log_time)

    def _take_tilt(
        self, body: str, decode: Callable[[bytes], Imu], counts: list[int], log_time: int, data: bytes
    ) -> None:
        status = Status.MALFORMED
        with suppress(MalformedMessage):
            imu = decode(data)
            status = self.monitor.update_imu(body, imu)
        counts[status] += 1
        if status is Status.ACCEPTED and self._drawing is not None:
            self._drawing.take_tilt(body, imu.stamp, self.monitor.tilts[body])
            self._draw(imu.stamp, log_time)

    def _take_true_impact(self, log_time: int, data: bytes) -> None:
        # What tells no impact there is another program's.
        with suppress(MalformedMessage):
            self.true_impacts += decode_true_impacts(data)

    def _take_true_onset(self, log_time: int, data: bytes) -> None:
        with suppress(MalformedMessage):
            self.true_onsets += decode_true_onsets(data)

    def _report(self, log_time: int) -> None:
        """Write what is to be said of the units now."""
        reports = self.monitor.reports()
        if not reports:
            return
        if self.warnings is not None:
            self.warnings.take(reports)
        if self._drawing is not None:
            self._drawing.take_reports(reports)
        if self._write is not None:
            from ..ros.messages.reports import encode_reports

            stamp = max(report.stamp for report in reports)
            self._write("/diagnostics", DIAGNOSTIC_ARRAY, log_time, encode_reports(reports, stamp))

    def _draw(self, stamp: int, log_time: int) -> None:
        if self._drawing is not None and self._write is not None:
            data = self._drawing.due(stamp)
            if data is not None:
                self._write(f"{NODE}/markers", MARKER_ARRAY, log_time, data)


class _Stream:
    """The answers to the samples of one body."""

    def __init__(self, body: str, update: Callable[[Sample], Prediction], write: Write | None) -> None:
        self.body = body
        self.update = update
        prefix = f"{NODE}/{body}/" if body else f"{NODE}/"
        self._write = write
        self._outputs = [(prefix + name, *output) for name, output in OUTPUTS.items()]
        self._last: tuple[Sample, int] | None = None
        # What the predictions cost whose touchdowns may still be scored.
        self._costs: deque[tuple[int, float]] = deque(maxlen=_REMEMBERED)

    def answered(self, prediction: Prediction, log_time: int, cost: float) -> None:
        """Write the answer to a sample of a log time in ns, which took a time in s."""
        self._last = prediction.sample, log_time
        if prediction.touchdown is not None:
            self._costs.append((prediction.sample.stamp, cost))
        if self._write is not None:
            for topic, type_name, encode in self._outputs:
                data = encode(prediction)
                if data is not None:
                    self._write(topic, type_name, log_time, data)

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
