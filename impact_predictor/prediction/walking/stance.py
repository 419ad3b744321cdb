"""A point of a foot: whether it stands, as its gaps and velocities tell."""

from __future__ import annotations

from collections import deque
from math import sqrt

from ...stamps import NANOSECONDS
from ..planar import hardly
from ..scene import Scene
from ..vectors import total
from .announcement import ExpectedLanding, LandingAnnouncement
from .cubic import GapNoise, PointFrame
from .ground import Ground
from .trajectory import NEAREST, Arrival, ArrivalFit, FootTrajectory

FAR = 3.0  # a point was off the ground when its gap was so many standard deviations above it
SETTLED = (
    3  # a frame shows the ground when the point is still near it, and has not begun to lift, so many dead times later
)


class FootPoint:
    """A point of a foot: its trajectory, whether it stands, and the landing that it announces.

    A change of the stance is believed when it has lasted for the dead time. A point comes to stand when it has stayed
    within the contact tolerance above the ground and has hardly moved; it stands until it has stayed further away.
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
        self._dead_time = dead_time
        self._other: int | None = None  # stamp in ns since when the other stance shows
        self._arriving: ArrivalFit | None = None
        self._standing: deque[PointFrame] = deque()

    @property
    def due(self) -> ExpectedLanding | None:
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        return self.announcement.due

    @property
    def closed(self) -> bool:
        """Whether it was to land by now and is near the ground: it stands, though not yet for the dead time."""
        return self.announcement.closed

    @property
    def landed(self) -> int | None:
        """Stamp in ns since which it stands, or has just closed, if it does."""
        if self.stands:
            return self.since
        return self.due.stamp if self.closed and self.due is not None else None

    @property
    def lands(self) -> int | None:
        """Stamp in ns at which it lands, as announced, or has landed."""
        return self.landed if self.due is None else self.due.stamp

    def stood(self, stamp: int) -> bool:
        """Whether it stood at a stamp in ns, as its last change tells."""
        landed = self.landed
        return self.since > stamp if landed is None else landed <= stamp

    def add(self, frame: PointFrame, ground: Ground) -> bool:
        """Take the next frame; whether the point has come to stand.

        A foot that brakes before it lands seems to rest before it does: while its landing is surely ahead it swings.
        """
        trajectory, announcement, near = self.trajectory, self.announcement, ground.is_near(frame)
        trajectory.frames.append(frame)
        changed = self._changes(ground, awaited=announcement.awaits(frame.stamp))
        if not near:
            self._arriving = None
        elif (self._arriving is None or not self._arriving.add(frame)) and (changed or not self.stands):
            fit = announcement.fit
            begin = trajectory.top if fit is None else max(trajectory.top, fit.begin)
            frames = trajectory.last(NEAREST)
            self._arriving = ArrivalFit(frames, begin, ground.level, self._scene.tolerance, ground.noise)
        if not self.stands:
            if changed:
                self._standing.clear()
            trajectory.follow()
            return False
        if changed and self._arriving is not None:
            if announcement.fit is not None:
                ground.prior.learn(announcement.fit)
            self.arrival = self._arriving.arrival()
            self.since, self._arriving, announcement.fit = self.arrival.stamp, None, None
        trajectory.rest()
        if near:
            self._standing.append(frame)
            if frame.stamp - self._standing[0].stamp > SETTLED * self._dead_time:
                ground.add(self._standing.popleft(), self._standing[0])
        announcement.end()
        return changed

    def revise(self, stamp: int, ground: Ground) -> ExpectedLanding | None:
        """The landing ahead of a stamp in ns."""
        if self.stands:
            return None
        return self.announcement.revise(self.trajectory, stamp, ground)

    def _changes(self, ground: Ground, awaited: bool) -> bool:
        """Whether the last frame changes the stance; not to standing while that is still `awaited`."""
        frames = self.trajectory.frames
        frame = frames[-1]
        near = ground.is_near(frame)
        if len(frames) == 1:
            self.stands = near and (frame.rate is None or abs(frame.rate) <= self._slow + 3.0 * ground.noise.rate)
            return False
        if near is self.stands:
            self._other = None
            return False
        if self._other is None:
            self._other = frame.stamp
        if frame.stamp - self._other < self._dead_time or (near and (awaited or not self._rests(ground.noise))):
            return False
        self.stands, self.since, self._other = near, self._other if near else self._left(ground), None
        return True

    def _left(self, ground: Ground) -> int:
        """The stamp in ns of the last frame in which the point was on the ground: the tolerance is left later."""
        for frame in reversed(self.trajectory.frames):
            if frame.stamp < self.since or frame.gap - ground.level <= FAR * ground.noise.gap:
                break
        return max(frame.stamp, self.since)

    def _rests(self, noise: GapNoise) -> bool:
        """Whether the point has hardly moved along the normal within the dead time."""
        frames = self.trajectory.frames
        begin = frames[-1].stamp - self._dead_time
        lasted = [frame for frame in frames if frame.stamp >= begin]
        if len(lasted) < 2:
            lasted = self.trajectory.last(2)
        rates = [frame.rate for frame in lasted if frame.rate is not None]
        if rates:
            return abs(total(rates)) / len(rates) <= self._slow + 3.0 * noise.rate / sqrt(len(rates))
        half = len(lasted) // 2
        late, early = lasted[-half:], lasted[:half]
        span = (sum([f.stamp for f in late]) - sum([f.stamp for f in early])) / half / NANOSECONDS
        rise = (total([f.gap for f in late]) - total([f.gap for f in early])) / half
        return abs(rise) <= self._slow * span + 3.0 * noise.gap * sqrt(2.0 / half)
