"""The way of a point of a foot over the ground: its last frames, its motion in the air, and when it arrived."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from itertools import islice
from math import inf
from typing import TYPE_CHECKING, Final, NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3
from .braking import BrakedCourse, braked_course
from .cubic import SCALE, CubicSums, GapNoise, PointFrame, slope_of, square_of, value_of
from .point_filter import SNAP, PointFilter
from .rest import rate_of

if TYPE_CHECKING:
    from .ground import GroundLevel

FEWEST: Final = 5  # frames that a cubic is fitted to at least: four would leave nothing to tell how well it fits
MOST: Final = 200  # frames that are kept: half a second at 400 Hz

LEAST_SPAN: Final = 0.03  # s over which one cubic is taken to follow a descent
LEAST: Final = (
    6  # frames in the air in which an arrival is looked for; they may be from before the foot began to descend
)
NEAREST: Final = 42  # the most of them that are looked at, besides those that may have been on the ground already
FULL: Final = 150  # frames after which a point that hovers near the ground is looked at anew
SHARE: Final = 4  # frames that are caught up with while the next one comes in
YIELDS: Final = 1.2  # contact tolerances that soft contacts may yield further than they stay
KNOWN: Final = 0.2  # contact tolerances of standard deviation below which a level is known
CLEAR: Final = 3.0  # standard deviations of the noise of a gap from which on a frame shows that it has sunk in
BENDS: Final = 100.0  # m/s^2 by which a foot may be accelerated as it arrives
SINKS_FOR: Final = 0.005  # s for which a foot sinks in at most, ...
LEAST_SPEED: Final = 0.1  # ... and m/s with which at least
COURSE: Final = 10_000_000  # ns before an arrival over which the speed is taken
MET: Final = 0.2  # part of the way between two frames by which the height is unsure at which a point has met the ground
UNSEEN: Final = 250_000_000  # ns without a frame after which a point follows another motion than before
SAME: Final = 0.01  # a later arrival is believed where it leaves less by this part of the noise's square


class FootTrajectory:
    """The last frames of a point over its ground, and the filter of its motion while it is in the air."""

    def __init__(self) -> None:
        self.frames: deque[PointFrame] = deque(maxlen=MOST)
        self.filter: PointFilter | None = None
        self._snap = SNAP
        self.top = 0
        """Stamp in ns of the highest place that the point descends from."""
        self._rises = False
        self.begin = 0
        """Stamp in ns since which the point has come down along one cubic, until it was near the ground."""

    @property
    def rate(self) -> float:
        """The rate of the gap now, in m/s: measured, or else from the last two frames; 0 from one."""
        last = self.frames[-1]
        if last.rate is not None or len(self.frames) < 2:
            return last.rate or 0.0
        before = self.frames[-2]
        return (last.gap - before.gap) / (last.stamp - before.stamp) * NANOSECONDS

    def follow(self, noise: GapNoise, near: bool) -> None:
        """Filter the last frame with those before it; one that is `near` the ground may be in the air no more."""
        frame, filtered = self.frames[-1], self.filter
        if filtered is None or frame.stamp - filtered.stamp > UNSEEN:
            filtered = self.filter = PointFilter(frame, noise, self._snap)
        else:
            filtered.add(frame, noise, learns=not near)
        rises = filtered.rows[0][1] >= 0.0
        if rises:
            self.top = frame.stamp
        elif self._rises:
            filtered.turn()
        self._rises = rises
        if not near:
            span = max(LEAST_SPAN, filtered.span(noise))
            self.begin = max(self.top, frame.stamp - round(span * NANOSECONDS))

    def rest(self) -> None:
        """Follow the point no more; what comes later is another trajectory."""
        if self.filter is not None:
            self._snap = self.filter.snap
        self.filter = None

    def last(self, count: int) -> list[PointFrame]:
        return list(islice(self.frames, max(0, len(self.frames) - count), None))


class Arrival(NamedTuple):
    """A point reached the ground at `stamp` (ns); its frame of index -`age` was the last in the air.

    `velocity` (m/s) is what it had there: measured, or else that of the cubic through its frames in the air; None where
    these are too few, `height` (m) the gap where the ground began to brake the point, where that shows.
    """

    stamp: int
    age: int
    velocity: Vector3 | None
    height: float | None


ArrivalCandidate = tuple[int, float, tuple[float, float], tuple[float, float], tuple[float, float]]
"""The cubic of the frames up to the one of that index, if the point arrived between that and the next frame: the least
square of what it leaves of them; its gaps (m) at the two frames, each with what is unsure of it; the sums over the
frames near the ground up to that one."""


class ArrivalFit:
    """A point that is near the ground and does not stand yet, from its first frame there on.

    `frames` are the last ones up to that; the point came down since `begin` (ns) to about a `level`. The work is
    shared between the frames that come in: the first of them finds many that are new.
    """

    def __init__(
        self, frames: Sequence[PointFrame], begin: int, level: GroundLevel, tolerance: float, noise: GapNoise
    ) -> None:
        first = max(0, len(frames) - 2)
        start = next((k for k, frame in enumerate(frames) if frame.stamp >= begin), 0)
        start = max(0, min(start, first - LEAST))
        self._frames = list(frames[start:])
        self._first = first - start
        self._level, self._tolerance, self._noise, self._unsure = level.height, tolerance, noise, level.deviation
        self._least = KNOWN * tolerance
        self._is_known = level.deviation < self._least
        begun = self._frames[0]
        self._sums = CubicSums(begun.stamp, begun.gap, begun.rate)
        self._near = 0.0, 0.0
        self._tried: list[ArrivalCandidate] = []

    def add(self, frame: PointFrame) -> bool:
        """Take the next frame near the ground; False where it has so many that this one is to begin another."""
        if len(self._frames) >= FULL:
            return False
        self._frames.append(frame)
        self._catch_up(SHARE)
        return True

    def _catch_up(self, most: int) -> None:
        done = self._sums.count
        for k in range(done, min(done + most, len(self._frames))):
            frame = self._frames[k]
            if k > self._first:
                ratio = self._noise.ratio if self._sums.measured else 0.0
                if k >= FEWEST:
                    self._try(k, ratio)
                off, (near, square) = frame.gap - self._level, self._near
                self._near = near + off, square + off * off + ratio * (SCALE * (frame.rate or 0.0)) ** 2
            self._sums.add(frame.stamp, frame.gap, frame.rate)

    def _try(self, k: int, ratio: float) -> None:
        """The arrival between frame `k`, which is the next one, and the one before."""
        frames, found = self._frames, self._sums.fit(ratio)
        if found is None:
            return
        cubic, factor, left = found
        # Between these two frames another foot may strike, or this one.
        time = (frames[k].stamp - frames[k - 1].stamp) / NANOSECONDS
        bends = (0.5 * BENDS * time * time / self._noise.gap) ** 2
        ends = []
        for one in frames[k - 1 : k + 1]:
            s = (one.stamp - frames[0].stamp) / (SCALE * NANOSECONDS)
            off = frames[0].gap - self._level + value_of(cubic, s)
            ends.append((off, square_of(factor, (1.0, s, s * s, s * s * s)) + bends))
        self._tried.append((k - 1, left, ends[0], ends[1], self._near))

    def arrival(self, sinks: float = 0.0) -> Arrival:
        """The arrival, once the point rests, at a ground into which it `sinks` (m).

        In the air the frames follow one cubic, then they rest at the level of the cubic's end: of all pairs of
        neighbours that the arrival may lie between it is the one where both together leave least (least squares). A
        foot that strikes arrives where the cubic meets the level; one that brakes to rest hardly meets it: it arrives
        with the nearest frame.
        """
        self._catch_up(FULL)
        frames, noise = self._frames, self._noise
        best, last, air, level = inf, self._first, 0, 0.0
        stamp = frames[min(last + 1, len(frames) - 1)].stamp
        # What comes to rest does so near the level of the others, by half a tolerance or so: as good as so many frames.
        known = (2.0 * noise.gap / self._tolerance) ** 2
        for until, leaves, (here, unsure), (there, unsure_there), (near, square) in self._tried:
            near, square = self._near[0] - near, self._near[1] - square
            rest = near / (len(frames) - 1 - until + known)
            here, there = here - rest, there - rest
            cost, later = here * here / unsure, there * there / unsure_there
            part = 0.0 if cost <= later else 1.0
            if here > 0.0 > there:
                part, cost = here / (here - there), 0.0
            left = leaves + square - near * rest + min(cost, later)
            if left < best - SAME * noise.gap**2:
                best, air, last, level = left, until + 1, until if part > 0.0 else until - 1, rest
                before = frames[until].stamp
                stamp = before + round(part * (frames[until + 1].stamp - before))
        # Soft contacts yield further than they stay: where the level is known the surface is, too.
        is_soft = self._is_known and max(self._least, CLEAR * noise.gap) < -level < YIELDS * self._tolerance
        depth = -level if is_soft else sinks
        if depth > 0.0:
            stamp = self._touched(last, stamp, self._level + level + depth, depth)
        braked = braked_course(frames, self._first, noise, 2.0 * self._least)
        height = None
        if braked is not None:
            stamp, height = self._met(braked, self._level)
        while last > 1 and frames[last].stamp > stamp:
            last -= 1
        velocity = frames[last].velocity
        if velocity is None and air > 0:
            velocity = _velocity_of(frames[:air], frames[last].stamp)
        return Arrival(stamp, len(frames) - last, velocity, height)

    def _met(self, braked: BrakedCourse, surface: float) -> tuple[int, float]:
        """When (ns) and at which height (m) a point met about a surface (m) that braked it."""
        frames = self._frames
        k = next(k for k in range(1, len(frames)) if frames[k].stamp >= braked.stamp or k == len(frames) - 1)
        a, b = frames[k - 1], frames[k]
        height = a.gap + (b.gap - a.gap) * (braked.stamp - a.stamp) / (b.stamp - a.stamp)
        late = braked.deviation + MET * (b.stamp - a.stamp) / NANOSECONDS
        square = (braked.speed * late) ** 2 + self._noise.gap**2
        off = (surface - height) * square / (square + self._unsure**2)
        return braked.stamp - round(off / max(braked.speed, LEAST_SPEED) * NANOSECONDS), height

    def _touched(self, last: int, stamp: int, surface: float, depth: float) -> int:
        """The stamp in ns at which a point has touched a surface (m), which it has sunk into by a depth at a stamp."""
        frames, k = self._frames, last + 1
        if depth < CLEAR * self._noise.gap:
            course = [one for one in frames[:k] if one.stamp > frames[last].stamp - COURSE]
            speed = -rate_of(course, self._noise)[0] if len(course) > 1 else 0.0
            return stamp - round(min(depth / max(speed, LEAST_SPEED), SINKS_FOR) * NANOSECONDS)
        while k + 1 < len(frames) and frames[k].gap >= surface:
            k += 1
        while k > 1 and frames[k - 1].gap < surface:
            k -= 1
        before, after = frames[k - 1], frames[k]
        if after.gap >= surface or before.gap < surface:
            return stamp
        part = (before.gap - surface) / (before.gap - after.gap)
        return before.stamp + round(part * (after.stamp - before.stamp))


def _velocity_of(frames: Sequence[PointFrame], stamp: int) -> Vector3 | None:
    """The velocity (m/s) at a stamp in ns by the cubics nearest to the places; None where these are too few."""
    s, speeds = (stamp - frames[0].stamp) / (SCALE * NANOSECONDS), list[float]()
    for axis in range(3):
        sums = CubicSums(frames[0].stamp, frames[0].position[axis], None)
        for frame in frames[1:]:
            sums.add(frame.stamp, frame.position[axis], None)
        found = sums.fit(0.0)
        if found is None:
            return None
        speeds.append(slope_of(found[0], s) / SCALE)
    return speeds[0], speeds[1], speeds[2]
