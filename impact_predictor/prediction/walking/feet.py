"""The contacts of a walking machine: when the points of its feet land, and the impacts they make."""

from __future__ import annotations

from collections import deque
from math import sqrt
from operator import attrgetter

from ...stamps import NANOSECONDS
from ..checks import LARGEST, PAUSE, order_of
from ..planar import posture_of
from ..predictor import DEEP, DEEP_TOLERANCES, Contacts
from ..scene import Scene, Walking
from ..score import MEASURED, Pending, Track
from ..types import (
    Foot,
    Geometry,
    Joints,
    Landing,
    Moment,
    Sample,
    Schedule,
    Status,
    Touchdown,
    Wrench,
)
from ..vectors import add, axes_of, cross, dot, to_world
from .cubic import PointFrame
from .landings import FootForces, LandingSchedule, LandingTracker, PendingLanding, part_of
from .mechanism import REMEMBERED, ArticulatedMachine, BaseMotion, LeggedMachine, RigidMachine
from .stance import ExpectedLanding, FootPoint, Ground


class FeetContacts(Contacts):
    """The contacts of a machine that walks: the points of its feet, which move against its base.

    Points, or joints, are told before or after the sample of the same stamp.

    Raises:
        InputError: the robot's model, or the inertia of the scene, is none.
    """

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        assert scene.walking is not None
        self._walking: Walking = scene.walking
        self._articulated: ArticulatedMachine | None = None
        if self._walking.robot is not None:
            self._articulated = ArticulatedMachine(self._walking.robot)
            self.scene = scene = scene._replace(mass=self._articulated.body.mass)
            self.joints = self._articulated.body.joints
        self._machine: LeggedMachine = self._articulated or RigidMachine(scene)
        self._timeout = round(self._walking.timeout * NANOSECONDS)
        self._count = len(self._walking.feet) * self._walking.points
        self._schedule = LandingSchedule(self._walking.feet)
        self._forces = FootForces(self._walking)
        self._waiting: deque[Geometry] = deque(maxlen=REMEMBERED)
        self._dues: list[ExpectedLanding | None] = []
        self._begin()

    def tell(self, message: Geometry | Joints | Wrench | Schedule) -> Status:
        """Take where the points or the joints are, the force on a foot, or when the feet are planned to stand."""
        if isinstance(message, Geometry):
            return self._set_geometry(message)
        if isinstance(message, Wrench):
            return self._forces.set(message)
        if isinstance(message, Schedule):
            return self._schedule.set(message)
        assert self._articulated is not None
        geometry = self._articulated.geometry_of(message)
        self.unknown_joints = self._articulated.unknown
        return geometry if isinstance(geometry, Status) else self._set_geometry(geometry)

    def follow(self, other: Contacts) -> None:
        assert isinstance(other, FeetContacts)
        self.geometry, self.frame_id = other.geometry, other.frame_id
        self._waiting, self._schedule = other._waiting, other._schedule

    def check(self, stamp: int) -> Status:
        if self.geometry is None:
            return Status.NO_GEOMETRY
        return Status.GEOMETRY_STALE if abs(stamp - self.geometry.stamp) > self._timeout else Status.ACCEPTED

    def take(self, sample: Sample, moment: Moment | None) -> Status:
        self._settles = bool(self._landed)
        self.stamp = sample.stamp
        self._base.add(sample)
        self._see()
        status = self._found
        if status is Status.ACCEPTED and not self._points[0].trajectory.frames:
            status = Status.NO_GEOMETRY
        return status

    def touchdown(self) -> Touchdown | Status | None:
        sample = self._base.samples[-1]
        self._dues = [point.revise(sample.stamp, self._ground) for point in self._points]
        touchdown = self._tracker.soonest(sample, self._dues)
        # What lands now is told with the next sample, which has less to do.
        if self._settles and not self.settled and not isinstance(touchdown, Status):
            self._settle()
        return touchdown

    def feet(self) -> tuple[Foot, ...]:
        stamp = self._base.samples[-1].stamp
        return tuple([self._foot(number, stamp, self._dues) for number in range(len(self._walking.feet))])

    def forget(self) -> None:
        for landed in self._landed:
            self._measure(landed.pending)
            if (score := self._tracker.score(landed)) is not None:
                self.settled.append(score)
        self.stamp = None
        self._begin()

    def _begin(self) -> None:
        dead_time = round(self._walking.dead_time * NANOSECONDS)
        self._points = [FootPoint(self.scene, dead_time) for _ in range(self._count)]
        self._ground = Ground(self.scene)
        self._landed: deque[PendingLanding] = deque()
        self._settles = False
        self._base = BaseMotion()
        self._found = Status.ACCEPTED  # what became of the last geometry that met a sample
        self._tracker = LandingTracker(self.scene, self._machine, self._points, self._walking.points, self._base)

    def _set_geometry(self, geometry: Geometry) -> Status:
        points, velocities = geometry.points, geometry.velocities
        if len(points) != self._count or len(velocities) not in (0, self._count):
            return Status.FEET_CHANGED
        if not sum([dot(vector, vector) for vector in points + velocities], 0.0) < LARGEST:
            return Status.NOT_FINITE
        last = None if self.geometry is None else self.geometry.stamp
        status = order_of(geometry.stamp, last)
        if status is Status.ACCEPTED:
            self.geometry, self.frame_id = geometry, geometry.frame_id
            self._waiting.append(geometry)
            return self._see()
        if last is not None and last - geometry.stamp > PAUSE:
            self.geometry = None
            self._waiting.clear()
            self.forget()
        return status

    def _see(self) -> Status:
        """Take where the feet were over the ground at the stamps that samples have reached."""
        waiting, status = self._waiting, Status.ACCEPTED
        while self._base.samples and waiting and waiting[0].stamp <= self._base.samples[-1].stamp:
            geometry = waiting.popleft()
            found = self._frames(geometry, self._base.at(geometry.stamp))
            if isinstance(found, Status):
                status = self._found = found
                continue
            status = self._found = Status.ACCEPTED
            landed = [point.add(frame, self._ground) for point, frame in zip(self._points, found, strict=True)]
            for i in [i for i, has_landed in enumerate(landed) if has_landed]:
                self._land(i)
        return status

    def _frames(self, geometry: Geometry, base: Sample) -> list[PointFrame] | Status:
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
            frames.append(PointFrame(geometry.stamp, gap, rate, place, velocity))
        return frames

    def _land(self, i: int) -> None:
        """Settle the landing of a point that has come to stand, alone or as the first of its foot.

        The first contact of a foot is told even where it was not announced.
        """
        point, each = self._points[i], self._walking.points
        stamp, announced = point.since, self._tracker.settle(i)
        first = i - i % each
        if announced is None and any(one.stands for one in self._points[first : first + each] if one is not point):
            return
        new = announced.last.new if announced is not None and i in announced.last.new else (i,)
        foot = self._walking.feet[i // each]
        times = () if announced is None else announced.times
        errors = [
            ((stamp - made) / NANOSECONDS, (made - stamp) / NANOSECONDS + lead_time)
            for made, lead_time in times
            if made <= stamp
        ]
        landing = Landing(
            foot=foot,
            stamp=stamp,
            late=self._schedule.late(foot, stamp),
            confirmed=self._forces.agree(foot, True, self._base.samples[-1].stamp),
            history=tuple(errors),
            point=part_of(new, each),
        )
        last = None if announced is None else announced.last
        self._landed.append(PendingLanding(Pending(Track(), stamp), landing, last, self._tracker.seen(i, new)))
        self._base.begin(stamp)

    def _settle(self) -> None:
        """Settle the next landing that is complete; of its two impacts a sample computes one."""
        self._measure(self._landed[0].pending)
        if not self._landed[0].pending.complete:
            return
        landed = self._landed.popleft()
        if landed.seen is not None:
            self._landed.appendleft(self._tracker.struck(landed))
        elif (score := self._tracker.score(landed)) is not None:
            self.settled.append(score)

    def _measure(self, pending: Pending) -> None:
        """Hand the samples after a touchdown to it, once there are enough of them."""
        after = [sample for sample in self._base.samples if sample.stamp > pending.stamp][: MEASURED.stop]
        if len(after) == MEASURED.stop and not pending.complete:
            for sample in after:
                pending.add(sample, posture_of(self.scene, (), sample))

    def _foot(self, number: int, stamp: int, dues: list[ExpectedLanding | None]) -> Foot:
        """A foot as the sample of a stamp in ns shows it."""
        name, each = self._walking.feet[number], self._walking.points
        own = self._points[number * each : (number + 1) * each]
        standing = [landed for point in own if (landed := point.landed) is not None]
        since = min(standing) if standing else max([point.since for point in own])
        gaps = [point.trajectory.frames[-1].gap for point in own]
        lowest = own[gaps.index(min(gaps))].trajectory
        lead_time = speed = late = place = None
        ahead = [due for due in dues[number * each : (number + 1) * each] if due is not None]
        if ahead:
            due = min(ahead, key=attrgetter("stamp"))
            lead_time, speed = (due.stamp - stamp) / NANOSECONDS, -dot(self.scene.normal, due.velocity)
            late, place = self._schedule.late(name, due.stamp), due.position
        if standing:
            late = self._schedule.late(name, since) if since else None
        confirmed = self._forces.agree(name, bool(standing), stamp)
        last = lowest.frames[-1]
        return Foot(
            name=name,
            stands=bool(standing),
            since=since,
            gap=last.gap,
            approach=-lowest.rate,
            lead_time=lead_time,
            landing_speed=speed,
            late=late,
            confirmed=confirmed,
            position=last.position,
            place=place,
        )
