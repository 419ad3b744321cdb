"""The contacts of a walking machine: when the points of its feet land, and the impacts they make."""

from __future__ import annotations

from collections import deque
from math import hypot, inf, isnan, sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..checks import LARGEST, PAUSE, order_of
from ..foot import Foot, impulse_at
from ..predictor import DEEP, DEEP_TOLERANCES, Contacts
from ..scene import Scene
from ..types import (
    ContactInput,
    FeetStates,
    Geometry,
    Joints,
    Moment,
    Sample,
    Schedule,
    Status,
    Terrain,
    Touchdown,
    Vector3,
    Wrench,
)
from ..vectors import add, axes_of, cross, dot, times, to_body, to_world
from .announcement import ExpectedLanding
from .articulated import ArticulatedMachine, LeggedMachine
from .base import REMEMBERED, BaseMotion
from .clock import Delay, FeetClock
from .cubic import PointFrame
from .doubts import GroundDoubts
from .forces import FootForces
from .ground import Ground
from .landings import LandingTracker
from .machine import RigidMachine
from .schedule import LandingSchedule
from .stance import FootPoint
from .terrain import TerrainMap

STEP: Final = 0.5  # part of a foot's distance from the base by which the next foothold may lie below all others


class FeetContacts(Contacts):
    """The contacts of a machine that walks: the points of its feet, which move against its base.

    Points, or joints, are told before or after the sample of the same stamp.

    Raises:
        InputError: the robot's model, or the inertia of the scene, is none.
    """

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        assert scene.walking is not None
        self._walking = walking = scene.walking
        points = list(range(len(walking.feet) * walking.points))
        self._radii = walking.at_points(walking.radius, points) if walking.radius else []
        self._articulated: ArticulatedMachine | None = None
        if walking.robot is not None:
            self._articulated = ArticulatedMachine(walking.robot, self._radii)
            self.scene = scene._replace(mass=self._articulated.body.mass)
            self.joints = self._articulated.body.joints
        self._machine: LeggedMachine = self._articulated or RigidMachine(scene)
        self._timeout = round(walking.timeout * NANOSECONDS)
        self._count = len(walking.feet) * walking.points
        self._schedule = LandingSchedule(walking.feet)
        self._terrain = TerrainMap(walking.terrain, scene.tolerance) if walking.terrain else None
        self._forces = FootForces(walking)
        self._waiting: deque[Geometry] = deque(maxlen=REMEMBERED)
        self._named: int | None = None  # stamp of the last feet that were told by their names
        self._dues: list[ExpectedLanding | None] = []
        self._clock = FeetClock(self._count, scene.normal, round(walking.dead_time * NANOSECONDS), walking.delay)
        self._ahead: Touchdown | Status | None = None
        self._doubts = GroundDoubts(scene)
        self._begin()

    def _begin(self) -> None:
        dead_time = round(self._walking.dead_time * NANOSECONDS)
        self._points = [FootPoint(self.scene, dead_time) for _ in range(self._count)]
        self._ground = Ground(self.scene, self._terrain)
        self._base = BaseMotion()
        self._clock.begin()
        self._found = Status.ACCEPTED  # what became of the last geometry that met a sample
        self._landings = LandingTracker(
            self.scene, self._machine, self._points, self._base, self._schedule, self._forces, self._ground
        )

    def tell(self, message: ContactInput) -> Status:
        """Take where points or joints are, the force on a foot, when the feet are planned to stand, or the terrain."""
        if isinstance(message, Wrench):
            return self._forces.set(message)
        if isinstance(message, Schedule):
            return self._schedule.set(message)
        if isinstance(message, FeetStates):
            return self._by_name(message)
        if isinstance(message, Terrain):
            assert self._terrain is not None
            if self.scene.frame and message.frame_id != self.scene.frame:
                return Status.WRONG_FRAME
            return self._terrain.set(message)
        if isinstance(message, Joints):
            assert self._articulated is not None
            down = times(self.scene.normal, -1.0)
            if self._base.samples:
                down = to_body(axes_of(self._base.samples[-1].orientation), down)
            geometry = self._articulated.geometry_of(message, down)
            self.unknown_joints = self._articulated.unknown
            if isinstance(geometry, Status):
                return geometry
            if self._walking.force_source == "effort" and self._base.samples and self._forces.is_due(message.stamp):
                axes = axes_of(self._base.samples[-1].orientation)
                forces = self._articulated.forces_of(message, to_body(axes, self.scene.gravity))
                self._forces.are_missing = forces is None
                if forces is not None:
                    normal = to_body(axes, self.scene.normal)
                    self._forces.press(message.stamp, [times(normal, max(0.0, dot(normal, one))) for one in forces])
            return self._place(geometry)
        if self._named is not None and abs(message.stamp - self._named) <= self._timeout:
            return Status.ACCEPTED  # Feet by their names tell more.
        return self._place(message)

    def follow(self, other: Contacts) -> None:
        assert isinstance(other, FeetContacts)
        self.geometry, self.frame_id = other.geometry, other.frame_id
        self._waiting, self._schedule = other._waiting, other._schedule
        if self._walking.terrain == other._walking.terrain:
            self._terrain = other._terrain
        self._clock.follow(other._clock)
        self._begin()

    def check(self, stamp: int) -> Status:
        if self.geometry is None:
            return Status.NO_GEOMETRY
        return Status.GEOMETRY_STALE if abs(stamp - self.geometry.stamp) > self._timeout else Status.ACCEPTED

    def take(self, sample: Sample, moment: Moment | None) -> Status:
        self.stamp = sample.stamp
        self._base.add(sample)
        # What lands now is settled with the next sample, which has less to do.
        if not self.settled and (score := self._landings.settle()) is not None:
            self.settled.append(score)
        self._see()
        status = self._found
        if status is Status.ACCEPTED and not self._points[0].trajectory.frames:
            status = Status.NO_GEOMETRY
        return status

    def touchdown(self) -> Touchdown | Status | None:
        sample = self._base.samples[-1]
        self._dues = [point.revise(sample.stamp, self._ground) for point in self._points]
        self._ahead = self._landings.soonest(sample, self._dues)
        return self._ahead

    def feet(self) -> tuple[Foot, ...]:
        stamp = self._base.samples[-1].stamp
        return tuple([self._foot(number, stamp) for number in range(len(self._walking.feet))])

    @property
    def delay(self) -> Delay | None:
        return self._clock.delay

    def doubts(self) -> tuple[str, ...]:
        found, delay = [self._schedule.doubt, "" if self._articulated is None else self._articulated.doubt], self.delay
        if delay is not None and self._clock.is_wrong and not self._walking.find_delay:
            found.append(f"the feet are {delay}: set feet.delay to {delay.time:.4f}, or feet.find_delay to true")
        if self._forces.are_missing:
            found.append(
                "joint_states lacks the effort of a joint of robot.urdf, so that nothing confirms that feet stand: "
                "publish efforts, or set feet.force_source to sensor"
            )
        return tuple(filter(None, [*found, *self._doubts.texts(self._ground)]))

    def forget(self) -> None:
        self.settled.extend(self._landings.finish())
        self._doubts.begin(self._ground)
        self.stamp = None
        self._begin()

    def _by_name(self, told: FeetStates) -> Status:
        """Take points that are told by the names of their feet; those of other names are left out."""
        feet, names, forces = self._walking.feet, told.names, told.forces
        order = [i for foot in feet for i, name in enumerate(names) if name == foot]
        if any(names.count(foot) != self._walking.points for foot in feet):
            return Status.FEET_CHANGED
        if len(told.positions) != len(names) or any(len(one) not in (0, len(names)) for one in told[4:6]):
            return Status.MALFORMED
        velocities = tuple([told.velocities[i] for i in order]) if told.velocities else ()
        if any(isnan(part) for velocity in velocities for part in velocity):  # what is told where none are measured
            velocities = ()
        if forces and self._walking.force > 0.0 and self._walking.force_source == "sensor":
            self._forces.press(told.stamp, [forces[i] for i in order])
        points = tuple([told.positions[i] for i in order])
        status = self._place(Geometry(told.stamp, told.frame_id, points, velocities))
        if status is Status.ACCEPTED:
            self._named = told.stamp
        return status

    def _place(self, geometry: Geometry) -> Status:
        points, velocities = geometry.points, geometry.velocities
        if len(points) != self._count or len(velocities) not in (0, self._count):
            return Status.FEET_CHANGED
        if not sum([dot(vector, vector) for vector in points + velocities], 0.0) < LARGEST:
            return Status.NOT_FINITE
        last = None if self.geometry is None else self.geometry.stamp
        status = order_of(geometry.stamp, last)
        if status is Status.ACCEPTED:
            self.geometry, self.frame_id = geometry, geometry.frame_id
            # What is announced is to come true first; then what was learnt has the old delay in it.
            is_free = self._walking.find_delay and all(point.due is None for point in self._points)
            if is_free and self._clock.correct():
                self._waiting.clear()
                self.forget()
            late = round(self._clock.taken * NANOSECONDS)
            self._waiting.append(geometry._replace(stamp=geometry.stamp - late) if late else geometry)
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
            base = self._base.at(geometry.stamp)
            found = self._frames(geometry, base)
            if isinstance(found, Status):
                status = self._found = found
                continue
            status = self._found = Status.ACCEPTED
            supported = any(point.stands or point.closed for point in self._points)
            lowest = -inf if supported else min([frame.gap for frame in found]) + self.scene.tolerance
            landed = []
            for i, frame in enumerate(found):
                if self._points[i].add(frame, self._ground, base, alone=frame.gap <= lowest):
                    landed.append(i)
            for i in landed:
                self._landings.land(i)
            self._doubts.see(found, any(point.stands for point in self._points), self._ground)
            self._clock.see(base, geometry.points, self._points)
        return status

    def _frames(self, geometry: Geometry, base: Sample) -> list[PointFrame] | Status:
        """The points of the feet over the ground, with the base as it was at their stamp."""
        scene, axes, position, spin = self.scene, axes_of(base.orientation), base.position, base.angular
        nx, ny, nz = scene.normal
        linear = to_world(axes, base.linear)
        frames = []
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = axes
        px, py, pz = position
        for i, arm in enumerate(geometry.points):
            u, v, w = arm
            # The base, and its axes times the arm, written out: this is done for each point of each sample.
            x, y, z = px + (u * ax + v * bx + w * cx), py + (u * ay + v * by + w * cy), pz + (u * az + v * bz + w * cz)
            if self._radii and self._articulated is None:  # that tells the lowest points itself
                x, y, z = add((x, y, z), scene.normal, -self._radii[i])
            gap = nx * x + ny * y + nz * z - scene.height
            if gap < -DEEP_TOLERANCES * scene.tolerance and self._is_deep(gap, arm):
                gaps = [dot(scene.normal, add(position, to_world(axes, one))) for one in geometry.points]
                self.depth = scene.height - min(gaps)
                return Status.BELOW_GROUND
            velocity = rate = None
            if geometry.velocities:
                velocity = add(linear, to_world(axes, add(cross(spin, arm), geometry.velocities[i])))
                rate = nx * velocity[0] + ny * velocity[1] + nz * velocity[2]
            frames.append(PointFrame(geometry.stamp, gap, rate, (x, y, z), velocity))
        return frames

    def _is_deep(self, gap: float, arm: Vector3) -> bool:
        """Whether a point at an `arm` from the base's origin is deeper in the ground than noise puts it."""
        # The ground goes down where nobody has stood yet; what nobody has stood on is where the scene has it.
        lowest = self._ground.lowest
        lowest, deep = (0.0, DEEP) if lowest is None else (min(0.0, lowest), STEP)
        return gap < lowest - DEEP_TOLERANCES * self.scene.tolerance - deep * sqrt(dot(arm, arm))

    def _foot(self, number: int, stamp: int) -> Foot:
        name, each = self._walking.feet[number], self._walking.points
        own = slice(number * each, (number + 1) * each)
        points, due = self._points[own], None
        for one in self._dues[own]:
            if one is not None and (due is None or one.stamp < due.stamp):
                due = one
        landed = [since for point in points if (since := point.landed) is not None]
        since = min(landed) if landed else max([point.since for point in points])
        lowest = points[0].trajectory
        for point in points[1:]:
            if point.trajectory.frames[-1].gap < lowest.frames[-1].gap:
                lowest = point.trajectory
        frame = lowest.frames[-1]
        lead_time = speed = late = place = deviation = lands = strikes = None
        if due is not None:
            lead_time, speed = (due.stamp - stamp) / NANOSECONDS, -dot(self.scene.normal, due.velocity)
            late, place = self._schedule.late(name, due.stamp), due.position
            deviation, lands, strikes = hypot(due.deviation, self._clock.left), due.lands, due.strikes
        impulse = bound = None
        if isinstance(self._ahead, Touchdown):
            impulse = impulse_at(self._ahead, range(own.start, own.stop))
            bound = None if impulse is None else self._ahead.bound
        if landed:
            late = self._schedule.late(name, since) if since else None
        return Foot(
            name=name,
            stands=bool(landed),
            since=since,
            gap=frame.gap,
            approach=-lowest.rate,
            lead_time=lead_time,
            landing_speed=speed,
            late=late,
            confirmed=self._forces.agree(name, bool(landed), stamp),
            position=frame.position,
            place=place,
            impulse=impulse,
            bound=bound,
            landing_deviation=deviation,
            lands=lands,
            strikes=strikes,
        )
