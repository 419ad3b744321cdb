"""Impacts of a recorded body on contact points, found from the heights of its points alone."""

from __future__ import annotations

from math import ceil, inf
from typing import Final, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from ..prediction.planar import STANDING
from ..prediction.scene import Scene
from ..prediction.types import kind_of
from .motions import Reals, RecordedMotion

DEVIATIONS: Final = 3.0
"""A contact tolerance is so many standard deviations of the gap of a point that rests."""

GAINS: Final = 1.5
"""An approach slower than so many times what gravity adds from one pose to the next is not told from rest ..."""

NOISES: Final = 5.0
"""... nor one slower than so many standard deviations of a rate between two poses."""

STOPPED: Final = 0.5
"""A point has struck when more than this part of its approach is gone."""

BEFORE: Final = 1
"""An impact lies between the poses k and k + 1. The motion before it is that between the poses k - 1 and k, with none
of the impact in it ..."""

AFTER: Final = 2
"""... and the motion after it that between the poses k + 2 and k + 3: the contact may last until the pose k + 2."""


class FrameMotion(NamedTuple):
    """The mean motion of a body between two poses.

    `time` in s midway, since the first pose of the motion; `position` (3,) of the body frame's origin in m and
    `rotation` (3, 3) midway; `linear` velocity of that origin in m/s and `angular` velocity in rad/s, in world axes;
    `turning` (3, 3), the change of the rotation in 1/s: a point c of the body frame moves by linear + turning c.
    """

    time: float
    position: Reals
    rotation: Reals
    linear: Reals
    angular: Reals
    turning: Reals

    def turned(self, time: float) -> Reals:
        """The rotation at a time (s) in free flight, (3, 3)."""
        turned: Reals = Rotation.from_rotvec((time - self.time) * self.angular).as_matrix() @ self.rotation
        return turned

    def place(self, point: Reals, center: Reals, gravity: Reals, time: float) -> Reals:
        """Where a point of a body with a mass centre (m, body frame) is in the world at a time (s) in free flight."""
        ahead = time - self.time
        middle = self.position + self.rotation @ center + ahead * (self.linear + self.turning @ center)
        place: Reals = middle + 0.5 * ahead**2 * gravity + self.turned(time) @ (point - center)
        return place


class RecordedImpact(NamedTuple):
    """An impact between the poses `frame` and `frame` + `stride` of a motion.

    `time` in s since the first pose; the points `new` strike, those in `old` stood; `approach` in m/s of the fastest
    new point. It is `isolated` where no other impact lies in the frames from the motion `before` it to that `after` it,
    over which all other points stay `clear` of the support by so many m.
    """

    frame: int
    stride: int
    time: float
    new: tuple[int, ...]
    old: tuple[int, ...]
    approach: float
    before: FrameMotion
    after: FrameMotion
    isolated: bool
    clear: float

    @property
    def kind(self) -> str:
        """What stood, and what struck, as of a `Touchdown`."""
        return kind_of(self.old, self.new)

    def meeting(self, scene: Scene, point: Reals) -> tuple[float, float]:
        """The time (s) at which, and the height (m) above the support in which, the paths of a point before and after
        the impact meet: where it truly turned back, whatever its shape.
        """
        normal, center, gravity = (np.array(one) for one in (scene.normal, scene.center_of_mass, scene.gravity))

        def heights(time: float) -> tuple[float, float]:
            before, after = (side.place(point, center, gravity, time) @ normal for side in (self.before, self.after))
            return float(before) - scene.height, float(after - before)

        time, step = self.time, 1e-3
        for _ in range(3):
            apart = heights(time)[1]
            closing = (heights(time + step)[1] - apart) / step
            if closing == 0.0:
                break
            time = min(max(time - apart / closing, self.before.time), self.after.time)
        return time, heights(time)[0]


class _Strike(NamedTuple):
    """A point that strikes between the poses k and k + 1, at a time in s, with an approach in m/s."""

    time: float
    k: int
    point: int
    approach: float


class MotionRecord:
    """The impacts of one recorded `motion` over the support of a scene.

    Poses closer than the contact time are left out, so that an impact is over two frames later. A point strikes where
    it falls to the support, within a standard deviation of its gap, before the next pose, loses half of its approach
    by the frame after that, and comes from the support then. Points that strike within the contact time strike
    together. A point stood that was within the tolerance and hardly moved.
    """

    def __init__(self, scene: Scene, motion: RecordedMotion) -> None:
        steps = np.diff(motion.times)
        self.stride = max(1, ceil(scene.contact_time / float(np.median(steps)) - 1e-9)) if len(steps) else 1
        self.motion = motion.every(self.stride)
        self._scene = scene
        self._times, self._gaps = self.motion.times, self.motion.gaps(scene)
        self._steps = np.diff(self._times)
        self._rates = np.diff(self._gaps, axis=0) / self._steps[:, None]
        self._step = float(np.median(self._steps)) if len(self._steps) else inf
        self._events: list[list[_Strike]] = []
        if len(self._times) < BEFORE + AFTER + 2:
            return
        self._fall = -float(np.dot(scene.gravity, scene.normal))
        # Third differences hold hardly any motion. Of white noise they have 20 times its variance, a rate has twice.
        thirds = np.abs(np.diff(self._gaps, n=3, axis=0))
        noise = float(np.median(thirds)) / 0.6745 / np.sqrt(10.0) / self._step
        self._slowest = max(GAINS * self._fall * self._step, NOISES * noise)
        for strike in sorted(self._strikes()):
            if self._events and strike.time - self._events[-1][0].time <= scene.contact_time:
                self._events[-1].append(strike)
            else:
                self._events.append([strike])

    def _strikes(self) -> list[_Strike]:
        """The strikes of each point; the first of several frames in which it may be is that of the strike."""
        scene, gain = self._scene, self._fall * self._steps[1:-1, None]
        gaps, step = self._gaps[1:-2], self._steps[1:-1, None]
        approach, away = -self._rates[:-2], self._rates[2:]
        # At the pose k gravity has added half a frame's gain to the mean rate of the frame before it.
        speed = approach + 0.5 * gain
        rest = np.clip(gaps / np.maximum(speed, self._slowest), 0.0, step)
        strikes = (
            (approach > self._slowest)
            & (gaps > -scene.tolerance)
            & (gaps - (approach + gain) * step < scene.tolerance / DEVIATIONS)
            & (away + approach > STOPPED * approach)
            & (self._gaps[2:-1] - away * (step - rest) < scene.tolerance)
        )
        found, last = [], np.full(gaps.shape[1], -inf)
        for row, point in np.argwhere(strikes).tolist():
            if row - last[point] > AFTER:
                last[point] = row
                time = float(self._times[row + 1] + rest[row, point])
                found.append(_Strike(time, row + 1, point, float(approach[row, point])))
        return found

    @property
    def impacts(self) -> list[RecordedImpact]:
        """The impacts in the order of time whose motions before and after are recorded without a pause."""
        starts = [min(strike.k for strike in event) for event in self._events]
        found = []
        for event, k, last, following in zip(self._events, starts, [-inf, *starts], [*starts[1:], inf], strict=False):
            begin, end = k - BEFORE, k + AFTER + 1
            if begin < 0 or end >= len(self._times) or self._steps[begin:end].max() > 1.5 * self._step:
                continue
            new = sorted({strike.point for strike in event})
            speeds = np.abs(self._rates[begin])
            still = max(self._slowest, STANDING * float(speeds.max()))
            others = [i for i in range(self._gaps.shape[1]) if i not in new]
            found.append(
                RecordedImpact(
                    frame=k * self.stride,
                    stride=self.stride,
                    time=event[0].time,
                    new=tuple(new),
                    old=tuple(i for i in others if self._gaps[k, i] < self._scene.tolerance and speeds[i] < still),
                    approach=max(strike.approach for strike in event),
                    before=self._frame(begin),
                    after=self._frame(k + AFTER),
                    isolated=last < begin and following > end,
                    clear=float(self._gaps[begin : end + 1, others].min(initial=inf)),
                )
            )
        return found

    def _frame(self, k: int) -> FrameMotion:
        """The motion between the poses k and k + 1."""
        (one, other), step = self.motion.rotations[k : k + 2], self._steps[k]
        here, there = self.motion.positions[k : k + 2]
        turn = Rotation.from_matrix(other @ one.T).as_rotvec()
        return FrameMotion(
            time=float(self._times[k] + 0.5 * step),
            position=0.5 * (here + there),
            rotation=Rotation.from_rotvec(0.5 * turn).as_matrix() @ one,
            linear=(there - here) / step,
            angular=turn / step,
            turning=(other - one) / step,
        )
