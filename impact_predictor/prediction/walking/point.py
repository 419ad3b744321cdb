"""One point of a foot: its trajectory, whether it stands, and the landing that it announces."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..scene import Scene
from ..types import Vector3
from ..vectors import add, dot
from .arrival import MOST, Arrival, ArrivalFit
from .cubic import Fit, PointFrame
from .stance import Ground, StanceDetector
from .trajectory import FootTrajectory

AHEAD = 1.5
"""A landing is first announced when it is no further ahead than so many times as long as the point has descended: from
less the cubic of a foot that need not follow one tells nothing."""

SOON = 0.5
"""... and where noise leaves doubt that it lands at all, no further than so many times."""

LASTS = 0.8
"""... or up to so many times, once it has shown in every sample for the dead time."""

SETTLED = 3
"""A frame shows the ground when the point is still near it so many dead times later: it has not begun to lift then."""


class ExpectedLanding(NamedTuple):
    """A landing that is announced: `stamp` in ns, and where and how fast the point will be then (m, m/s)."""

    stamp: int
    position: Vector3
    velocity: Vector3


class FootPoint:
    """A point of a foot of a scene."""

    def __init__(self, scene: Scene, dead_time: int) -> None:
        """Follow a point of a scene; a change of its stance is believed after a `dead_time` in ns."""
        self.trajectory = FootTrajectory()
        self.stance = StanceDetector(scene, dead_time)
        self.due: ExpectedLanding | None = None
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        self.arrival: Arrival | None = None
        """How the point came to stand last."""
        self.closed = False
        """Whether it was to land by now and is near the ground: it stands, though not yet for the dead time."""
        self._tolerance, self._horizon, self._normal = scene.tolerance, scene.horizon, scene.normal
        self._dead_time = dead_time
        self._doubted: int | None = None
        self._shown: int | None = None
        self._last: Fit | None = None
        self._arriving: ArrivalFit | None = None
        self._standing: deque[PointFrame] = deque()

    @property
    def stands(self) -> bool:
        return self.stance.stands

    @property
    def landed(self) -> int | None:
        """Stamp in ns since which it stands, or has just closed, if it does."""
        if self.stance.stands:
            return self.stance.since
        return self.due.stamp if self.closed and self.due is not None else None

    @property
    def lands(self) -> int | None:
        """Stamp in ns at which it lands, as announced, or has landed."""
        return self.landed if self.due is None else self.due.stamp

    def stood(self, stamp: int) -> bool:
        """Whether it stood at a stamp in ns, as its last change tells."""
        landed = self.landed
        return self.stance.since > stamp if landed is None else landed <= stamp

    def add(self, frame: PointFrame, ground: Ground) -> bool:
        """Take the next frame; whether the point has come to stand.

        A foot that brakes before it lands seems to rest before it does: while its landing is surely ahead it swings.
        """
        trajectory, stance = self.trajectory, self.stance
        trajectory.add(frame)
        awaited = self.due is not None and self._doubted is None and self.due.stamp > frame.stamp
        changed = stance.update(trajectory.frames, ground, awaited)
        near = frame.gap - ground.level <= self._tolerance
        if not near:
            self._arriving = None
        elif self._arriving is not None and not self._arriving.is_full:
            self._arriving.add(frame)
        elif changed or not stance.stands:
            begin = trajectory.top if self._last is None else max(trajectory.top, self._last.begin)
            self._arriving = ArrivalFit(trajectory.last(MOST), begin, ground.level, self._tolerance, ground.noise)
        if not stance.stands:
            if changed:
                self._standing.clear()
            trajectory.follow()
            return False
        if changed and self._arriving is not None:
            if self._last is not None:
                ground.prior.learn(self._last)
            self.arrival = self._arriving.arrival()
            stance.since, self._last, self._arriving = self.arrival.stamp, None, None
        trajectory.rest()
        if near:
            self._standing.append(frame)
            if frame.stamp - self._standing[0].stamp > SETTLED * self._dead_time:
                ground.add(self._standing.popleft(), self._standing[0])
        self.due = self._doubted = None
        self._shown = None
        self.closed = False
        return changed

    def revise(self, stamp: int, ground: Ground) -> ExpectedLanding | None:
        """The landing ahead of a stamp in ns."""
        if self.stance.stands:
            return None
        last = self.trajectory.frames[-1]
        near = last.gap - ground.level <= self._tolerance
        due = self.due
        self.closed = due is not None and due.stamp <= stamp and near
        if self.closed:
            return None  # What its trajectory shows is the ground already.
        trajectory = self.trajectory
        fit = trajectory.fit(ground.noise, ground.prior)
        if fit is not None and not near:
            self._last = fit
        if due is not None and near and trajectory.broke:
            return due if due.stamp > stamp else None  # It may be landing already, so its last announcement stands.
        landing = None if fit is None else fit.landing(ground.level, self._tolerance, self._horizon)
        if fit is None or landing is None:
            self._shown = None
            if due is not None and self._doubted_for(stamp):
                due = self.due = self._doubted = None
            return due if due is not None and due.stamp > stamp else None
        self._shown = stamp if self._shown is None else self._shown
        descended, wait = fit.stamp - trajectory.top, landing.time * NANOSECONDS
        sure = landing.sure and (due is not None or wait < AHEAD * descended)
        sure |= landing.precise and wait < SOON * descended
        sure |= stamp - self._shown >= self._dead_time and wait < LASTS * descended
        # So near to the ground a little noise makes the curve of a foot that brakes pass through it at once.
        leaps = near and due is not None and due.stamp - fit.stamp - wait > self._dead_time
        sure = sure and not (trajectory.broke or leaps)
        if sure or self._doubted_for(stamp):
            if sure:
                self._doubted = None
            position, velocity = trajectory.motion(fit, landing.time)
            velocity = add(velocity, self._normal, landing.rate - dot(velocity, self._normal))
            due = self.due = ExpectedLanding(fit.stamp + round(landing.time * NANOSECONDS), position, velocity)
        return due if due is not None and due.stamp > stamp else None

    def _doubted_for(self, stamp: int) -> bool:
        """Whether what is announced has not surely shown for the dead time."""
        if self.due is None:
            return False
        if self._doubted is None:
            self._doubted = stamp
        return stamp - self._doubted >= self._dead_time
