"""What arrives about one body in a replay, and what is answered to it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import dist
from typing import Final, NamedTuple

from ..prediction.scene import Scene, Walking
from ..prediction.types import Geometry, Prediction, Sample, Score
from ..ros.messages import outputs_of
from ..stamps import NANOSECONDS

Write = Callable[[str, str, int, bytes], None]
"""Takes topic, type, log time (ns) and bytes of a message."""

NODE: Final = "/impact_predictor"
"""The name of the node whose topics are written."""

MOVED: Final = 0.01
"""Contact points that are further than so many m from where they were first have moved."""

_REMEMBERED: Final = 256


class Settled(NamedTuple):
    """A touchdown that has happened: the body, its score, and what the last prediction of it cost in s.

    The body goes by its name, or where it has none by its frame.
    """

    body: str
    score: Score
    cost: float | None


class FootStance(NamedTuple):
    """A foot, by its place in feet.names, that stands from `begin` to `end` (stamps in ns)."""

    foot: int
    begin: int
    end: int


class Gait:
    """The stances of one machine as they were inferred, and the true ones where they are known."""

    def __init__(self, walking: Walking) -> None:
        self.feet = walking.feet
        self.begin = self.end = 0
        """Stamps of the first and the last sample in ns."""
        self.samples = 0
        self._inferred: tuple[list[FootStance], dict[int, int]] = [], {}
        self._true: tuple[list[FootStance], dict[int, int]] = [], {}

    @property
    def stances(self) -> list[FootStance]:
        """As they were inferred."""
        return self._until_the_end(*self._inferred)

    @property
    def true_stances(self) -> list[FootStance]:
        """Those that the record tells; none where it tells of none."""
        return self._until_the_end(*self._true)

    def tell(self, stamp: int, stands: tuple[bool, ...]) -> None:
        """Take which feet truly stand at a stamp in ns."""
        for foot, stands_now in enumerate(stands[: len(self.feet)]):
            _note(*self._true, foot, stands_now, stamp)

    def take(self, prediction: Prediction) -> None:
        """Take the answer to an accepted sample."""
        self.end = prediction.sample.stamp
        self.begin = self.begin if self.samples else self.end
        self.samples += 1
        for number, foot in enumerate(prediction.feet):
            # What stands or swings from the beginning on has not begun at any stamp.
            _note(*self._inferred, number, foot.stands, foot.since or self.begin)

    def _until_the_end(self, ended: list[FootStance], since: dict[int, int]) -> list[FootStance]:
        return [*ended, *[FootStance(foot, begin, self.end) for foot, begin in since.items()]]


def _note(ended: list[FootStance], since: dict[int, int], foot: int, stands: bool, stamp: int) -> None:
    """Note that a foot stands, or does not, since a stamp."""
    if stands:
        since.setdefault(foot, stamp)
    elif foot in since:
        ended.append(FootStance(foot, since.pop(foot), stamp))


class BodyRecord:
    """One body: the answers to its samples, its gait, and what its contact points were told to be.

    `first` and `last` are the samples that were accepted. Of the contact points, `geometry` is
    what was told last, `told` how often, and `moved` how often elsewhere than first. `is_pressed` tells
    whether a force on a foot was told.
    """

    def __init__(self, body: str, scene: Scene, write: Write | None, messages: str = "auto") -> None:
        self.body, self.scene = body, scene
        self.gait = None if scene.walking is None else Gait(scene.walking)
        self.first: Sample | None = None
        self.last: Sample | None = None
        self._answer: Prediction | None = None
        self.geometry: Geometry | None = None
        self.told = self.moved = 0
        self.is_pressed = False
        self._first_geometry: Geometry | None = None
        self._write = write
        prefix = f"{NODE}/{body}/" if body else f"{NODE}/"
        self._outputs = [(prefix + name, *output) for name, output in outputs_of(messages).items()]
        self._log_time = 0
        # What the predictions cost whose touchdowns may still be scored.
        self._costs: deque[tuple[int, float]] = deque(maxlen=_REMEMBERED)

    def answered(self, prediction: Prediction, log_time: int, cost: float) -> None:
        """Write the answer to an accepted sample of a log time in ns, which took a time in s."""
        self.last, self._answer, self._log_time = prediction.sample, prediction, log_time
        self.first = self.first or self.last
        if self.gait is not None:
            self.gait.take(prediction)
            self.is_pressed = self.is_pressed or any(foot.confirmed is not None for foot in prediction.feet)
        if prediction.touchdown is not None:
            self._costs.append((prediction.sample.stamp, cost))
        self._publish(prediction)

    def settle(self, score: Score) -> Settled:
        """The touchdown of a score."""
        cost = next((cost for stamp, cost in reversed(self._costs) if stamp <= score.stamp), None)
        return Settled(self.body or ("" if self.last is None else self.last.child_frame_id), score, cost)

    def end(self, score: Score) -> Settled:
        """The touchdown of a score that came with the end, written with the time of the last sample."""
        if self._answer is not None:
            self._publish(self._answer._replace(score=score), "/score")
        return self.settle(score)

    def take_geometry(self, geometry: Geometry) -> None:
        """Take contact points that were told and fit the scene."""
        first = self._first_geometry = self._first_geometry or geometry
        self.geometry, self.told = geometry, self.told + 1
        self.moved += any(dist(*pair) > MOVED for pair in zip(first.points, geometry.points, strict=False))

    @property
    def interval(self) -> float:
        """The mean time in s between two messages about the contact points."""
        first, last = self._first_geometry, self.geometry
        if first is None or last is None or self.told < 2:
            return 0.0
        return (last.stamp - first.stamp) / NANOSECONDS / (self.told - 1)

    def _publish(self, prediction: Prediction, only: str = "") -> None:
        if self._write is not None:
            for topic, type_name, encode, _ in self._outputs:
                if topic.endswith(only) and (data := encode(prediction)) is not None:
                    self._write(topic, type_name, self._log_time, data)
