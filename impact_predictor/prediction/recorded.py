"""Touchdowns as a record shows them, whatever was predicted: found from the heights of the contact points alone."""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from typing import Final, NamedTuple

from ..stamps import NANOSECONDS
from .planar import STANDING, Posture
from .scene import Scene
from .types import Sample, kind_of
from .vectors import dot

FRAME: Final = 4_000_000
"""ns. Samples nearer to the last one are left out: from their poses no velocity could be told."""

TOGETHER: Final = 5_000_000
"""ns. Points that strike within it make one touchdown."""

GAINS: Final = 1.5
"""A point strikes that approaches faster than so many times what gravity adds from one frame to the next ..."""

STOPPED: Final = 0.5
"""... and loses more than this part of its approach."""

SCATTER: Final = 1.0 / 3.0
"""Standard deviation of the gap of a point that rests, relative to the contact tolerance."""

UNEVEN: Final = 1.5
"""Frames follow one another without a pause where none is so many times as long as another."""

BEFORE, AFTER = 2, 4
"""Frames before and after a touchdown that tell whether another one is near it."""

KEPT: Final = 12
"""Frames for which a touchdown is kept, so that its prediction finds it."""

NEAR: Final = 1.2
"""Frames that a touchdown may come earlier or later than it was predicted."""


class Frame:
    """A sample of a stamp in ns, and its posture over the support."""

    def __init__(self, stamp: int, sample: Sample, posture: Posture) -> None:
        self.stamp, self.sample, self.posture = stamp, sample, posture


class RecordedTouchdown:
    """A touchdown between the second and the third of its `frames`.

    `stamp` in ns; the points `new` strike, those in `old` stood; `approach` in m/s of the fastest new point. It is
    isolated while no other one is known from the first frame to the fifth, announced once a prediction before it is
    known that was near it in time, and matched once one is compared with it.
    """

    def __init__(
        self, stamp: int, old: tuple[int, ...], new: tuple[int, ...], approach: float, frames: list[Frame]
    ) -> None:
        self.stamp, self.old, self.new, self.approach, self.frames = stamp, old, new, approach, frames
        self.is_isolated, self.is_announced, self.is_matched = True, False, False

    @property
    def kind(self) -> str:
        """What stood and what struck, as of a `Touchdown`."""
        return kind_of(self.old, self.new)

    @property
    def last_before(self) -> int:
        """Stamp in ns up to which a sample was surely before it: its time is not known to less than a frame."""
        return min(self.stamp, self.frames[2].stamp - 1)

    @property
    def is_complete(self) -> bool:
        """Whether all frames are there that measure it."""
        return len(self.frames) >= BEFORE + AFTER

    @property
    def is_last(self) -> bool:
        """Whether it is not kept any longer."""
        return len(self.frames) >= KEPT

    def is_near(self, stamp: int) -> bool:
        """Whether a touchdown predicted for a stamp in ns may be this one."""
        return abs(self.stamp - stamp) < NEAR * (self.frames[2].stamp - self.frames[1].stamp)

    @property
    def is_even(self) -> bool:
        """Whether its frames follow one another without a pause."""
        steps = [other.stamp - one.stamp for one, other in pairwise(self.frames[: BEFORE + AFTER])]
        return max(steps) <= UNEVEN * min(steps)


class Announced(NamedTuple):
    """How many touchdowns there were, and of how many the last sample before them told that they came."""

    touchdowns: int
    announced: int


class TouchdownRecorder:
    """Finds the touchdowns of one body in its samples."""

    def __init__(self, scene: Scene, slowest: float) -> None:
        self.slowest = slowest
        """m/s: the approach of the slowest touchdown that is clear."""
        self.counts: dict[str, Announced] = {}
        """Clear touchdowns, by kind."""
        self._scene, self._fall = scene, -dot(scene.gravity, scene.normal) / NANOSECONDS**2
        self._frames: deque[Frame] = deque(maxlen=AFTER + 1)
        self.found: deque[RecordedTouchdown] = deque()
        """The last ones, the oldest first."""
        self._struck: dict[int, int] = {}
        """Stamp of the frame before the last strike of each point."""

    def take(self, sample: Sample, posture: Posture) -> None:
        """Look at the next sample."""
        frames, stamp = self._frames, sample.stamp
        if frames and stamp - frames[-1].stamp < FRAME:
            return
        frame = Frame(stamp, sample, posture)
        frames.append(frame)
        for touchdown in self.found:
            touchdown.frames.append(frame)
        if len(frames) >= 4:
            self._look(frames[-4], frames[-3], frames[-2], frame)
        while self.found and len(self.found[0].frames) > KEPT:
            self._drop()

    def forget(self) -> None:
        """Begin anew with the next sample."""
        while self.found:
            self._drop()
        self._frames.clear()
        self._struck.clear()

    def knows(self, stamp: int) -> bool:
        """Whether a touchdown near a stamp in ns would be known and complete by now."""
        if any(touchdown.is_near(stamp) and not touchdown.is_complete for touchdown in self.found):
            return False
        return len(self._frames) > AFTER and self._frames[-AFTER].stamp >= stamp

    def _drop(self) -> None:
        touchdown = self.found.popleft()
        if touchdown.is_complete and touchdown.approach >= self.slowest:
            number, announced = self.counts.get(touchdown.kind, Announced(0, 0))
            self.counts[touchdown.kind] = Announced(number + 1, announced + touchdown.is_announced)

    def _look(self, one: Frame, last: Frame, following: Frame, after: Frame) -> None:
        """Find what strikes between the last frame and the following one."""
        to_last, step, to_after = last.stamp - one.stamp, following.stamp - last.stamp, after.stamp - following.stamp
        before, gaps = one.posture.gaps, last.posture.gaps
        # At the last frame gravity has added half a frame's gain to the mean rate of the frame before it.
        gain, ratio = self._fall * step, step / to_last
        reach, deepest = gain * step + SCATTER * self._scene.tolerance, -self._scene.tolerance
        least = GAINS * gain * to_last
        falling = [
            i
            for i, gap in enumerate(gaps)
            if before[i] - gap > least and deepest < gap < (before[i] - gap) * ratio + reach
        ]
        steps = to_last, step, to_after
        if not falling or max(steps) > UNEVEN * min(steps):
            return
        strikes = []
        for i in falling:
            approach = (before[i] - gaps[i]) / to_last
            away = (after.posture.gaps[i] - following.posture.gaps[i]) / to_after
            rest = min(max(gaps[i] / (approach + 0.5 * gain), 0.0), step)
            rises_from = following.posture.gaps[i] - away * (step - rest)
            recently = self._struck.get(i, -1) >= self._frames[0].stamp
            if away + approach > STOPPED * approach and rises_from < gain * step - deepest and not recently:
                self._struck[i] = last.stamp
                strikes.append((last.stamp + round(rest), i, approach * NANOSECONDS))
        for stamp, i, approach in sorted(strikes):
            self._add(stamp, i, approach, GAINS * gain * NANOSECONDS)

    def _add(self, stamp: int, point: int, approach: float, slowest: float) -> None:
        if self.found and stamp - self.found[-1].stamp <= TOGETHER:
            touchdown = self.found[-1]
            touchdown.new = tuple(sorted((*touchdown.new, point)))
            touchdown.old = tuple([i for i in touchdown.old if i != point])
            touchdown.approach = max(touchdown.approach, approach)
            return
        frames = list(self._frames)[-4:]
        one, last = frames[:2]
        step = (last.stamp - one.stamp) / NANOSECONDS
        rates = [abs(gap - earlier) / step for gap, earlier in zip(last.posture.gaps, one.posture.gaps, strict=True)]
        still, gaps = max(slowest, STANDING * max(rates)), last.posture.gaps
        old = [i for i, gap in enumerate(gaps) if i != point and gap < self._scene.tolerance and rates[i] < still]
        touchdown = RecordedTouchdown(stamp, tuple(old), (point,), approach, frames)
        for other in self.found:
            if other.stamp >= one.stamp:
                touchdown.is_isolated = False
            if len(other.frames) <= AFTER or stamp <= other.frames[AFTER].stamp:
                other.is_isolated = False
        self.found.append(touchdown)
