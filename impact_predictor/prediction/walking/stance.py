"""A point of a foot: whether it stands, as its gaps and velocities tell."""

from __future__ import annotations

from collections import deque
from math import sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..planar import hardly
from ..scene import Scene
from ..types import Sample
from ..vectors import total
from .announcement import ExpectedLanding, LandingAnnouncement
from .cubic import GapNoise, PointFrame
from .ground import Foothold, Ground, GroundLevel
from .rest import falls, hovers, is_slow, rate_of, settles, since, stop_of
from .trajectory import NEAREST, Arrival, ArrivalFit, FootTrajectory

FAR: Final = 3.0  # a point was off the ground when its gap was so many standard deviations above it
FELL: Final = 5.0  # times as far as it may seem to move at rest a point has come down before it rests
SURE: Final = 3.0  # standard deviations of its mean rate within which a point rests ...
BOUNCE: Final = 0.1  # ... and m/s by which it may still bounce where it has struck
SETTLED = (
    3  # a frame shows the ground when the point is still near it, and has not begun to lift, so many dead times later
)


class FootPoint:
    """A point of a foot: its trajectory, whether it stands, and the landing that it announces.

    A change of the stance is believed when it has lasted for the dead time. A point comes to stand when it has hardly
    moved for so long, where the ground is expected, or where it stopped as only the ground stops a foot; it stands
    until it has stayed further above its foothold than the contact tolerance.
    """

    def __init__(self, scene: Scene, dead_time: int) -> None:
        """Follow a point of a scene; `dead_time` in ns."""
        self.trajectory = FootTrajectory()
        self.stands = False
        self.since = 0
        """Stamp in ns of the last change of the stance, 0 where there was none."""
        self.announcement = LandingAnnouncement(scene, dead_time)
        self.arrival: Arrival | None = None
        """How the point came to stand last."""
        self._scene, self._slow = scene, hardly(scene)
        self._dead_time, self._contact_time = dead_time, round(scene.contact_time * NANOSECONDS)
        self._other: int | None = None  # stamp in ns since when the other stance shows
        self._stopped: int | None = None  # stamp in ns at which it broke off its descent, and has rested since
        self._has_moved = self._near = False
        self._arriving: ArrivalFit | None = None
        self._edge: tuple[Arrival, PointFrame] | None = None  # it was stopped there, and has slipped off since
        self._foothold: Foothold | None = None
        self._standing: deque[PointFrame] = deque()

    @property
    def due(self) -> ExpectedLanding | None:
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        return self.announcement.due

    @property
    def closed(self) -> bool:
        """Whether it has reached the ground and rests there, though not yet for the dead time."""
        return self._stopped is not None or self.announcement.closed

    @property
    def landed(self) -> int | None:
        """Stamp in ns since which it stands, or has just closed, if it does."""
        if self.stands:
            return self.since
        if self._stopped is not None:
            return self._stopped
        return self.due.stamp if self.closed and self.due is not None else None

    @property
    def lands(self) -> int | None:
        """Stamp in ns at which it lands, as announced, or has landed."""
        return self.landed if self.due is None or self._stopped is not None else self.due.stamp

    def stood(self, stamp: int) -> bool:
        """Whether it stood at a stamp in ns, as its last change tells."""
        landed = self.landed
        return self.since > stamp if landed is None else landed <= stamp

    def add(self, frame: PointFrame, ground: Ground, base: Sample | None = None, alone: bool = False) -> bool:
        """Take the next frame; whether the point has come to stand.

        The base, where it is told, is that of the frame's stamp; a point is `alone` where no other stands and none is
        lower. A foot that brakes before it lands seems to rest before it does: while its landing is surely ahead it
        swings.
        """
        trajectory, announcement = self.trajectory, self.announcement
        trajectory.frames.append(frame)
        self._has_moved |= abs(frame.gap - trajectory.frames[0].gap) > self._scene.tolerance
        level = ground.level_at(frame.position) if self._foothold is None else ground.level_of(self._foothold)
        off, tolerance = frame.gap - level.height, self._scene.tolerance
        near = self._near = off <= tolerance
        if self.stands and off < -tolerance and falls(trajectory.last(2), self._slow, ground.noise):
            near = False  # It has slipped off an edge.
        stopped, arriving = self._stopped, self._arriving
        rests = None if self.stands else self._rests(near, ground, base, alone)
        if stopped is not None and self._stopped is None and arriving is not None and self._edge is None:
            self._edge = arriving.arrival(ground.depth), trajectory.frames[-2]
        elif self._edge is not None and frame.gap > self._edge[1].gap + tolerance:
            self._edge = None
        changed = self._changes(near, rests, level, ground)
        self._arrive(level, ground, rests, changed)
        if not self.stands:
            if changed:
                self._standing.clear()
                self._foothold = None
            trajectory.follow(ground.noise, near)
            return False
        landed = changed and self._has_moved
        if landed and self._arriving is not None:
            self.arrival = self._arriving.arrival(ground.depth)
            if self._edge is None:
                announcement.learn(self.arrival.stamp, trajectory.frames[-self.arrival.age], ground)
            else:
                # It has landed on an edge then, and come further down without having left the ground.
                self.arrival = self._slipped(*self._edge)
            self.since = self.arrival.stamp
        if changed:
            self._arriving = self._stopped = self._edge = None
            announcement.end()
            trajectory.rest()
        if self._foothold is None:
            # It has sunk in and come back while it was not believed yet.
            lasted = since(trajectory.frames, frame.stamp - self._contact_time) if self.since else [frame]
            touched = self.arrival.height if landed and self.arrival is not None else None
            self._foothold = ground.begin(lasted, first=not self.since, touched=touched)
        if near or changed:
            self._standing.append(frame)
            if frame.stamp - self._standing[0].stamp > SETTLED * self._dead_time:
                ground.add(self._standing.popleft(), self._standing[0], self._foothold)
        return landed

    def revise(self, stamp: int, ground: Ground) -> ExpectedLanding | None:
        """The landing ahead of a stamp in ns."""
        if self.stands or self._stopped is not None:
            return None
        return self.announcement.revise(self.trajectory, stamp, ground, self._near)

    def _arrive(self, level: GroundLevel, ground: Ground, rests: int | None, changed: bool) -> None:
        """Look when the point arrived, once it rests, until it stands."""
        frame = self.trajectory.frames[-1]
        if rests is None:
            self._arriving = None
        elif (self._arriving is None or not self._arriving.add(frame)) and (changed or not self.stands):
            frames, begin = self.trajectory.last(NEAREST), self.trajectory.begin
            # Where the ground was not expected it is known only now that the point rests since then.
            air = [one for one in frames if one.stamp <= max(rests, frames[0].stamp)]
            unsure = max(self._scene.tolerance, 2.0 * level.deviation)
            self._arriving = ArrivalFit(air, begin, level, unsure, ground.noise)
            for one in frames[len(air) :]:
                self._arriving.add(one)

    def _rests(self, near: bool, ground: Ground, base: Sample | None, alone: bool) -> int | None:
        """Stamp in ns since which the point may be on the ground; None where it is in the air."""
        frames, noise = self.trajectory.frames, ground.noise
        frame = frames[-1]
        may_rest = len(frames) > 3 and is_slow([frames[-2], frame], self._slow, noise)
        self._stopped = self._stop(near, ground, base) if may_rest else None
        if near:
            return frame.stamp
        if self._stopped is not None:
            return self._stopped - self._contact_time
        if not may_rest or not (alone or base is not None):
            return None
        settled, still = settles(frames, self._dead_time, self._slow, noise)
        if not settled:
            return None
        fell = max([one.gap for one in frames]) - frame.gap > self._scene.tolerance + FELL * still
        if alone or (fell and base is not None and not hovers(settled, base)):
            return settled[0].stamp
        return None

    def _stop(self, near: bool, ground: Ground, base: Sample | None) -> int | None:
        """Stamp in ns at which the point stopped as only the ground stops a foot, if it has rested since."""
        frames, noise = self.trajectory.frames, ground.noise
        if self._stopped is None:
            return stop_of(frames, self._contact_time, self._slow, noise)
        rested = since(frames, frames[-1].stamp - self._contact_time)
        rate, unsure = rate_of(rested, noise)
        if abs(rate) > self._slow + SURE * unsure + BOUNCE:
            return None
        # A drive may have stopped the foot, which goes on with the base then.
        late = frames[-1].stamp - self._stopped > self._dead_time
        held = late and not near and base is not None and hovers(rested, base)
        return None if held else self._stopped

    def _changes(self, near: bool, rests: int | None, level: GroundLevel, ground: Ground) -> bool:
        """Whether the last frame changes the stance."""
        frames = self.trajectory.frames
        frame = frames[-1]
        if len(frames) == 1:
            near = frame.gap - level.height <= self._scene.tolerance
            self.stands = near and (frame.rate is None or abs(frame.rate) <= self._slow + 3.0 * ground.noise.rate)
            return False
        if near if self.stands else rests is None:
            self._other = None
            return False
        if self._other is None:
            self._other = frame.stamp if rests is None else rests
        if frame.stamp - self._other < self._dead_time:
            return False
        if self.stands:
            self.since = self._left(level, ground.noise)
        elif self._is_still(ground.noise) and (self._stopped or not self.announcement.awaits(frame.stamp)):
            self.since = self._other
        else:
            return False
        self.stands, self._other = not self.stands, None
        return True

    def _slipped(self, arrival: Arrival, last: PointFrame) -> Arrival:
        """An arrival at an edge, which was told when a `last` frame came in; its height is not that of the foothold."""
        later = len([frame for frame in self.trajectory.frames if frame.stamp > last.stamp])
        return arrival._replace(age=min(arrival.age + later, len(self.trajectory.frames)), height=None)

    def _left(self, level: GroundLevel, noise: GapNoise) -> int:
        """The stamp in ns of the last frame in which the point was on the ground: the tolerance is left later."""
        for frame in reversed(self.trajectory.frames):
            if frame.stamp < self.since or frame.gap - level.height <= FAR * noise.gap:
                break
        return max(frame.stamp, self.since)

    def _is_still(self, noise: GapNoise) -> bool:
        """Whether the point has hardly moved along the normal within the dead time."""
        lasted = since(self.trajectory.frames, self.trajectory.frames[-1].stamp - self._dead_time)
        rates = [frame.rate for frame in lasted if frame.rate is not None]
        if rates:
            return abs(total(rates)) / len(rates) <= self._slow + SURE * noise.rate / sqrt(len(rates))
        half = len(lasted) // 2
        late, early = lasted[-half:], lasted[:half]
        span = (sum([f.stamp for f in late]) - sum([f.stamp for f in early])) / half / NANOSECONDS
        rise = (total([f.gap for f in late]) - total([f.gap for f in early])) / half
        return abs(rise) <= self._slow * span + SURE * noise.gap * sqrt(2.0 / half)
