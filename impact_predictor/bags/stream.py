"""The answers to the samples of one body on their way into an output, and the touchdowns that they settle."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final, NamedTuple

from ..prediction.types import Prediction, Sample, Score, Status
from ..ros.messages import OUTPUTS

Write = Callable[[str, str, int, bytes], None]
"""Takes topic, type, log time (ns) and bytes of a message."""

NODE: Final = "/impact_predictor"
"""The name of the node whose topics are written."""

_REMEMBERED: Final = 256


class Settled(NamedTuple):
    """A touchdown that has happened: the body, its score, and what the last prediction of it cost in s.

    The body goes by its name, or where it has none by its frame.
    """

    body: str
    score: Score
    cost: float | None


class Stream:
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
