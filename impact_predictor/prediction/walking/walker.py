"""The predictor of a walking machine: samples of its base and of its feet in, a prediction for each sample out."""

from __future__ import annotations

from collections import deque
from math import sqrt
from typing import TYPE_CHECKING

from ...stamps import NANOSECONDS
from ..checks import LARGEST, check_numbers, order_of
from ..planar import posture_of
from ..predictor import PAUSE
from ..scene import Scene, Walking
from ..score import MEASURED, Pending, Track
from ..types import (
    Foot,
    Geometry,
    Joints,
    Landing,
    Prediction,
    Sample,
    Schedule,
    Score,
    Status,
    Wrench,
)
from ..vectors import add, axes_of, cross, dot, to_world
from .ahead import Ahead, Landed, point_of
from .base import Twists, base_at
from .cubic import Frame
from .forces import Forces
from .mechanism import Mechanism, Trunk
from .plan import Plan
from .point import Due, Point
from .stance import Ground

if TYPE_CHECKING:
    from .legs import Articulated

DEEP = 0.05
"""A foot is below the ground when it lies deeper than this part of the distance from its base ..."""

DEEP_TOLERANCES = 4.0
"""... and so many contact tolerances: more than noise makes of a gap, or 3 degrees of a wrong orientation."""

REMEMBERED = 64
"""Samples that are kept for feet that are told later, and for landings that are noticed later."""


class Walker:
    """Predicts the landings of the feet of one machine.

    `update` answers each sample of the base, in the order of their stamps; `set_geometry` or `set_joints` tell where
    the feet are, before or after the sample of the same stamp; `set_wrench` what their force sensors measure,
    `set_schedule` when they are planned to stand; `finish` ends the record.

    Raises:
        InputError: the robot's model, or the inertia of the scene, is none.
    """

    def __init__(self, scene: Scene) -> None:
        assert scene.walking is not None
        self.scene = scene
        self._walking: Walking = scene.walking
        self._articulated: Articulated | None = None
        if self._walking.robot is not None:
            from .legs import Articulated

            self._articulated = Articulated(self._walking.robot)
            self.scene = scene = scene._replace(mass=self._articulated.body.mass)
        self._mechanism: Mechanism = self._articulated or Trunk(scene)
        self._timeout = round(self._walking.timeout * NANOSECONDS)
        self._count = len(self._walking.feet) * self._walking.points
        self._plan = Plan(self._walking.feet)
        self._forces = Forces(self._walking)
        self._geometry: Geometry | None = None
        self._waiting: deque[Geometry] = deque(maxlen=REMEMBERED)
        self._scores: deque[Score] = deque()
        self._recent: deque[Sample] = deque(maxlen=REMEMBERED)
        self._begin()

    @property
    def geometry(self) -> Geometry | None:
        """Where the feet are, as it was told last."""
        return self._geometry

    @property
    def articulated(self) -> Articulated | None:
        """The model of the robot; None where the feet are told of themselves."""
        return self._articulated

    def become(self, other: Walker) -> None:
        """Go on as the machine of another scene: feet and plan stay known, and all that was seen begins anew."""
        other._geometry, other._waiting, other._plan = self._geometry, self._waiting, self._plan
        other._scores.extend(self.finish())
        vars(self).update(vars(other))

    def set_geometry(self, geometry: Geometry) -> Status:
        """Take where the points of the feet are; what became of the message. A refused one leaves the last."""
        points, velocities = geometry.points, geometry.velocities
        if len(points) != self._count or len(velocities) not in (0, self._count):
            return Status.FEET_CHANGED
        if not sum([dot(vector, vector) for vector in points + velocities]) < LARGEST:
            return Status.NOT_FINITE
        last = None if self._geometry is None else self._geometry.stamp
        status = order_of(geometry.stamp, last)
        if status is Status.ACCEPTED:
            self._geometry = geometry
            self._waiting.append(geometry)
            return self._see()
        if last is not None and last - geometry.stamp > PAUSE:
            self._geometry = None
            self._waiting.clear()
            self._forget()
        return status

    def set_joints(self, joints: Joints) -> Status:
        """Take where the joints are, and the feet with them; what became of the message."""
        assert self._articulated is not None
        geometry = self._articulated.geometry_of(joints)
        return geometry if isinstance(geometry, Status) else self.set_geometry(geometry)

    def set_wrench(self, wrench: Wrench) -> Status:
        """Take the force on a foot, which confirms its stance; what became of the message."""
        return self._forces.set(wrench)

    def set_schedule(self, schedule: Schedule) -> Status:
        """Take when the feet are planned to stand; what became of the message."""
        return self._plan.set(schedule)

    def update(self, sample: Sample) -> Prediction:
        """The prediction from a sample of the base: the landings ahead, every foot, and a score that is complete."""
        status = self._check(sample)
        if status is not Status.ACCEPTED:
            return Prediction(status, sample)
        landed = len(self._landed)
        self._recent.append(sample)
        self._twists.add(sample)
        self._see()
        status = self._found
        if status is Status.ACCEPTED and not self._points[0].course.frames:
            status = Status.NO_GEOMETRY
        if status is not Status.ACCEPTED:
            return Prediction(status, sample)
        dues = [point.revise(sample.stamp, self._ground) for point in self._points]
        touchdown = self._ahead.soonest(sample, dues)
        if isinstance(touchdown, Status):
            return Prediction(touchdown, sample)
        feet = tuple([self._foot(number, sample.stamp, dues) for number in range(len(self._walking.feet))])
        # What lands now is told with the next sample, which has less to do.
        return Prediction(status, sample, touchdown, self._score() if landed or self._scores else None, feet=feet)

    def finish(self) -> tuple[Score, ...]:
        """End the record: the scores not yet handed out, those without enough samples after them included."""
        self._forget()
        scores = tuple(self._scores)
        self._scores.clear()
        return scores

    def _begin(self) -> None:
        self._points = [Point(self.scene) for _ in range(self._count)]
        self._ground = Ground(self.scene)
        self._landed: deque[Landed] = deque()
        self._twists = Twists()
        self._found = Status.ACCEPTED  # what became of the last geometry that met a sample
        self._ahead = Ahead(self.scene, self._mechanism, self._points, self._twists)

    def _forget(self) -> None:
        """Begin anew; what waits for its measurement will not get it."""
        for landed in self._landed:
            self._measure(landed.pending)
            if (score := self._ahead.score(landed)) is not None:
                self._scores.append(score)
        self._recent.clear()
        self._begin()

    def _check(self, sample: Sample) -> Status:
        status = check_numbers(sample)
        if status is not Status.ACCEPTED:
            return status
        if self.scene.frame and sample.frame_id != self.scene.frame:
            return Status.WRONG_FRAME
        geometry = self._geometry
        if geometry is None:
            return Status.NO_GEOMETRY
        if geometry.frame_id and sample.child_frame_id and sample.child_frame_id != geometry.frame_id:
            return Status.WRONG_FRAME
        last = self._recent[-1].stamp if self._recent else None
        status = order_of(sample.stamp, last)
        if last is not None and abs(sample.stamp - last) > PAUSE:
            self._forget()
        if status is Status.ACCEPTED and abs(sample.stamp - geometry.stamp) > self._timeout:
            return Status.GEOMETRY_STALE
        return status

    def _see(self) -> Status:
        """Take where the feet were over the ground at the stamps that samples have reached."""
        waiting, status = self._waiting, Status.ACCEPTED
        while self._recent and waiting and waiting[0].stamp <= self._recent[-1].stamp:
            geometry = waiting.popleft()
            found = self._frames(geometry, base_at(self._recent, geometry.stamp))
            if isinstance(found, Status):
                status = self._found = found
                continue
            status = self._found = Status.ACCEPTED
            landed = [point.add(frame, self._ground) for point, frame in zip(self._points, found, strict=True)]
            for i in [i for i, has_landed in enumerate(landed) if has_landed]:
                self._land(i)
        return status

    def _frames(self, geometry: Geometry, base: Sample) -> list[Frame] | Status:
        """The points of the feet over the ground, with the base as it was at their stamp."""
        scene, axes, position, spin = self.scene, axes_of(base.orientation), base.position, base.angular
        nx, ny, nz = scene.normal
        linear = to_world(axes, base.linear)
        frames = []
        for i, arm in enumerate(geometry.points):
            x, y, z = place = add(position, to_world(axes, arm))
            gap = nx * x + ny * y + nz * z - scene.height
            if gap < -DEEP_TOLERANCES * scene.tolerance - DEEP * sqrt(dot(arm, arm)):
                return Status.BELOW_GROUND
            velocity = rate = None
            if geometry.velocities:
                velocity = add(linear, to_world(axes, add(cross(spin, arm), geometry.velocities[i])))
                rate = nx * velocity[0] + ny * velocity[1] + nz * velocity[2]
            frames.append(Frame(geometry.stamp, gap, rate, place, velocity))
        return frames

    def _land(self, i: int) -> None:
        """Settle the landing of a point that has come to stand, alone or as the first of its foot.

        The first contact of a foot is told even where it was not announced.
        """
        point, each = self._points[i], self._walking.points
        stamp, told = point.stance.since, self._ahead.settle(i)
        first = i - i % each
        if told is None and any(one.stands for one in self._points[first : first + each] if one is not point):
            return
        new = told.last.new if told is not None and i in told.last.new else (i,)
        foot = self._walking.feet[i // each]
        late, confirmed = self._plan.late(foot, stamp), self._forces.agree(foot, True, self._recent[-1].stamp)
        times = () if told is None else told.times
        history = tuple(
            [
                ((stamp - made) / NANOSECONDS, (made - stamp) / NANOSECONDS + lead_time)
                for made, lead_time in times
                if made <= stamp
            ]
        )
        landing = Landing(foot, stamp, late, confirmed, history, point=point_of(new, each))
        last = None if told is None else told.last
        self._landed.append(Landed(Pending(Track(), stamp), landing, last, self._ahead.seen(i, new, self._recent)))
        self._twists.begin(stamp)

    def _score(self) -> Score | None:
        """The next score that is complete; of its two impacts a sample computes one."""
        if self._scores:
            return self._scores.popleft()
        self._measure(self._landed[0].pending)
        if not self._landed[0].pending.complete:
            return None
        landed = self._landed.popleft()
        if landed.seen is not None:
            self._landed.appendleft(self._ahead.struck(landed))
            return None
        return self._ahead.score(landed)

    def _measure(self, pending: Pending) -> None:
        """Hand the samples after a touchdown to it, once there are enough of them."""
        after = [sample for sample in self._recent if sample.stamp > pending.stamp][: MEASURED.stop]
        if len(after) == MEASURED.stop and not pending.complete:
            for sample in after:
                pending.add(sample, posture_of(self.scene, (), sample))

    def _foot(self, number: int, stamp: int, dues: list[Due | None]) -> Foot:
        """A foot as the sample of a stamp in ns shows it."""
        name, each = self._walking.feet[number], self._walking.points
        own = self._points[number * each : (number + 1) * each]
        standing = [landed for point in own if (landed := point.landed) is not None]
        since = min(standing) if standing else max([point.stance.since for point in own])
        lowest = min(own, key=lambda point: point.course.frames[-1].gap) if each > 1 else own[0]
        lead_time = speed = late = place = None
        ahead = [due for due in dues[number * each : (number + 1) * each] if due is not None]
        if ahead:
            due = min(ahead, key=lambda one: one.stamp)
            lead_time, speed = (due.stamp - stamp) / NANOSECONDS, -dot(self.scene.normal, due.velocity)
            late, place = self._plan.late(name, due.stamp), due.position
        if standing:
            late = self._plan.late(name, since) if since else None
        confirmed = self._forces.agree(name, bool(standing), stamp)
        last, approach = lowest.course.frames[-1], -lowest.course.rate
        where = last.position, place
        return Foot(name, bool(standing), since, last.gap, approach, lead_time, speed, late, confirmed, *where)
