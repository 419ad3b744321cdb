"""One point of a foot: its course, whether it stands, and the landing that it announces."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from ..scene import Scene
from ..types import Vector3
from ..vectors import add, dot
from .arrival import Arrival, arrival
from .course import Course
from .cubic import NANOSECONDS, Fit, Frame
from .stance import Ground, Stance

AHEAD = 1.5
"""A landing is first announced when it is no further ahead than so many times as long as the point has descended: from
less the cubic of a foot that need not follow one tells nothing."""

SOON = 0.5
"""... and where noise leaves doubt that it lands at all, no further than so many times."""

SETTLED = 3
"""A frame shows the ground when the point is still near it so many dead times later: it has not begun to lift then."""


class Due(NamedTuple):
    """A landing that is announced: `stamp` in ns, and where and how fast the point will be then (m, m/s)."""

    stamp: int
    position: Vector3
    velocity: Vector3


class Point:
    """A point of a foot of a scene."""

    def __init__(self, scene: Scene) -> None:
        assert scene.walking is not None
        self.course = Course(scene.walking.window, scene.normal)
        self.stance = Stance(scene)
        self.due: Due | None = None
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        self.arrival: Arrival | None = None
        """When the point came to stand last."""
        self._tolerance, self._horizon, self._normal = scene.tolerance, scene.horizon, scene.normal
        self._dead_time = round(scene.walking.dead_time * NANOSECONDS)
        self._doubted: int | None = None
        self._last: Fit | None = None
        self._standing: deque[Frame] = deque()

    @property
    def stands(self) -> bool:
        return self.stance.stands

    def add(self, frame: Frame, ground: Ground) -> None:
        """Take the next frame.

        A foot that brakes before it lands seems to rest before it does: while its landing is surely ahead it swings.
        """
        course, stance = self.course, self.stance
        course.add(frame)
        awaited = self.due is not None and self._doubted is None and self.due.stamp > frame.stamp
        changed = stance.update(course.frames, ground, awaited)
        if not stance.stands:
            if changed:
                self._standing.clear()
            course.follow()
            return
        if changed:
            begin = course.top
            if self._last is not None:
                ground.habit.learn(self._last)
                begin = max(begin, self._last.begin)
            self.arrival = arrival(list(course.frames), begin, ground.level, self._tolerance, ground.noise)
            stance.since, self._last = self.arrival.stamp, None
        course.rest()
        if frame.gap - ground.level <= self._tolerance:
            self._standing.append(frame)
            if frame.stamp - self._standing[0].stamp > SETTLED * self._dead_time:
                ground.add(self._standing.popleft(), self._standing[0])
        self.due = self._doubted = None

    def revise(self, stamp: int, ground: Ground) -> Due | None:
        """The landing ahead of a stamp in ns."""
        if self.stance.stands:
            return None
        last = self.course.frames[-1]
        near = last.gap - ground.level <= self._tolerance
        due = self.due
        if due is not None and due.stamp <= stamp and near:
            return None  # It is landing now: what its course shows is the ground already.
        course = self.course
        fit = course.fit(ground.noise, ground.habit)
        if fit is not None and not near:
            self._last = fit
        if due is not None and near and course.broke:
            return due if due.stamp > stamp else None  # It may be landing already, so its last announcement stands.
        landing = None if fit is None else fit.landing(ground.level, self._tolerance, self._horizon)
        if fit is not None and landing is not None:
            descended, wait = fit.stamp - course.top, landing.time * NANOSECONDS
            shown = due is not None or wait < AHEAD * descended
            sure = (landing.sure and shown) or (landing.precise and wait < SOON * descended)
            # So near to the ground a little noise makes the curve of a foot that brakes pass through it at once.
            leaps = near and due is not None and due.stamp - fit.stamp - wait > self._dead_time
            sure = sure and not (course.broke or leaps)
            if sure or self._doubted_for(stamp):
                if sure:
                    self._doubted = None
                position, velocity = course.motion(fit, landing.time)
                velocity = add(velocity, self._normal, landing.rate - dot(velocity, self._normal))
                due = self.due = Due(fit.stamp + round(landing.time * NANOSECONDS), position, velocity)
        elif due is not None and self._doubted_for(stamp):
            due = self.due = self._doubted = None
        return due if due is not None and due.stamp > stamp else None

    def _doubted_for(self, stamp: int) -> bool:
        """Whether what is announced has not surely shown for the dead time."""
        if self.due is None:
            return False
        if self._doubted is None:
            self._doubted = stamp
        return stamp - self._doubted >= self._dead_time
