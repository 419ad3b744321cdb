"""The predictor of a walking machine: samples of its base and of its feet in, a prediction for each sample out."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import hypot, sqrt
from typing import TYPE_CHECKING

from ..planar import posture_of
from ..predictor import LARGEST, PAUSE, check_numbers
from ..scene import Scene, Walking
from ..score import NANOSECONDS, Pending, Track
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
    Touchdown,
    Vector3,
    Wrench,
)
from ..vectors import add, axes_of, cross, dot, mean, to_body, to_world
from .base import Twists, base_at
from .cubic import Frame
from .forces import Forces, order_of
from .impact import touchdown_of
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
        self._recent.append(sample)
        self._twists.add(sample)
        status = self._see()
        if status is Status.ACCEPTED and not self._points[0].course.frames:
            status = Status.NO_GEOMETRY
        if status is not Status.ACCEPTED:
            return Prediction(status, sample)
        for pending, _ in self._pending:
            self._measure(pending, sample)
        while self._pending and self._pending[0][0].complete:
            done, landing = self._pending.pop(0)
            self._scores.append(done.score(self.scene)._replace(landing=landing))
        dues = [point.revise(sample.stamp, self._ground) for point in self._points]
        touchdowns = self._touchdowns(sample, dues)
        if isinstance(touchdowns, Status):
            return Prediction(touchdowns, sample)
        feet = tuple([self._foot(number, sample.stamp, dues) for number in range(len(self._walking.feet))])
        score = self._scores.popleft() if self._scores else None
        return Prediction(status, sample, touchdowns[0] if touchdowns else None, score, None, None, touchdowns, feet)

    def finish(self) -> tuple[Score, ...]:
        """End the record: the scores not yet handed out, those without enough samples after them included."""
        self._forget()
        scores = tuple(self._scores)
        self._scores.clear()
        return scores

    def _begin(self) -> None:
        self._points = [Point(self.scene) for _ in range(self._count)]
        self._ground = Ground(self.scene)
        self._tracks: dict[int, Track] = {}
        self._joined: dict[int, int] = {}
        self._pending: list[tuple[Pending, Landing]] = []
        self._twists = Twists()

    def _forget(self) -> None:
        """Begin anew; what waits for its measurement will not get it."""
        self._scores.extend([pending.unmeasured()._replace(landing=landing) for pending, landing in self._pending])
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
                status = found
                continue
            for i, (point, frame) in enumerate(zip(self._points, found, strict=True)):
                stood = point.stands
                due = point.add(frame, self._ground)
                if point.stands and not stood and due is not None:
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
        """Settle the touchdown that a point which has come to stand has made, alone or as the first of its foot."""
        track, stamp = self._tracks.pop(i, None), self._points[i].stance.since
        if track is None or self._joined.pop(i, None) is not None:
            return
        for j in track.last.new:
            if j != i:
                self._joined[j] = stamp + round(self.scene.contact_time * NANOSECONDS)
        foot = self._walking.feet[i // self._walking.points]
        history = tuple(
            [
                ((stamp - seen) / NANOSECONDS, (seen - stamp) / NANOSECONDS + told.lead_time)
                for seen, told in track.answers
                if seen <= stamp
            ]
        )
        late, confirmed = self._plan.late(foot, stamp), self._forces.agree(foot, True, self._recent[-1].stamp)
        pending = Pending(track, stamp)
        landing = Landing(foot, stamp, late, confirmed, history, *self._last_seen(track.last.new, stamp))
        self._pending.append((pending, landing))
        self._twists.begin(stamp)
        for sample in self._recent:
            self._measure(pending, sample)

    def _last_seen(self, new: tuple[int, ...], stamp: int) -> tuple[float, Touchdown] | tuple[()]:
        """The speed of points of a foot in their last frame in the air, and the touchdown that they make with it."""
        frames = self._points[new[0]].course.frames
        k = next((k for k in range(-1, -len(frames), -1) if frames[k].stamp < stamp), None)
        if k is None:
            return ()
        velocity = mean([self._points[i].course.velocity(k) for i in new])
        seen = frames[k].stamp
        base = base_at(self._recent, seen)
        others = tuple([i for i, point in enumerate(self._points) if point.stands and point.stance.since <= seen])
        touchdown = self._impact(
            base, others, new, 0.0, [point.course.frames[k].position for point in self._points], velocity
        )
        return () if isinstance(touchdown, Status) else (hypot(*velocity), touchdown)

    def _impact(
        self,
        base: Sample,
        standing: tuple[int, ...],
        new: tuple[int, ...],
        lead_time: float,
        places: Sequence[Vector3],
        velocity: Vector3,
    ) -> Touchdown | Status:
        """The touchdown of the `new` points at some `velocity`, all points being at `places` in the world then."""
        axes = axes_of(base.orientation)
        points = tuple([to_body(axes, add(place, base.position, -1.0)) for place in places])
        return touchdown_of(self.scene, self._mechanism, base, points, standing, new, lead_time, velocity)

    def _measure(self, pending: Pending, sample: Sample) -> None:
        """Hand a sample to a touchdown that waits for those after it."""
        if sample.stamp > pending.stamp and not pending.complete:
            pending.add(sample, posture_of(self.scene, (), sample))

    def _touchdowns(self, sample: Sample, dues: list[Due | None]) -> tuple[Touchdown, ...] | Status:
        """The touchdowns of the feet, the soonest first; points of one foot that land together make one."""
        each = self._walking.points
        found: list[Touchdown] = []
        for i, point in enumerate(self._points):
            if point.stands or point.due is None:
                self._joined.pop(i, None)
            if point.due is None:
                self._tracks.pop(i, None)
        for first in range(0, self._count, each):
            own = [(due, i) for i in range(first, first + each) if (due := dues[i]) and not self._has_joined(i, due)]
            if own and each > 1:
                own = self._without_joining(own, range(first, first + each), sample.stamp)
            if own:
                touchdown = self._touchdown(sample, own)
                if isinstance(touchdown, Status):
                    return touchdown
                found.append(touchdown)
        return tuple(sorted(found, key=lambda one: one.lead_time))

    def _has_joined(self, i: int, due: Due) -> bool:
        """Whether the landing of a point belongs to one that its foot has made already."""
        last = self._joined.get(i)
        if last is None or due.stamp <= last:
            return last is not None
        del self._joined[i]
        return False

    def _without_joining(self, own: list[tuple[Due, int]], foot: range, stamp: int) -> list[tuple[Due, int]]:
        """The landings ahead that do not belong to one that another point of the foot makes at this moment."""
        now = [due.stamp for i in foot if (due := self._points[i].due) is not None and due.stamp <= stamp]
        last = min(now, default=stamp) + round(self.scene.contact_time * NANOSECONDS)
        return [one for one in own if one[0].stamp > last] if now else own

    def _touchdown(self, sample: Sample, own: list[tuple[Due, int]]) -> Touchdown | Status:
        """The touchdown that a foot makes with the first of its points, and with those that close soon after it."""
        stamp = min([due.stamp for due, _ in own])
        last = stamp + round(self.scene.contact_time * NANOSECONDS)
        landing = [(due, i) for due, i in own if due.stamp <= last]
        new = tuple([i for _, i in landing])
        lead_time = (stamp - sample.stamp) / NANOSECONDS
        base = self._twists.ahead(sample, lead_time)
        places = [point.course.frames[-1].position for point in self._points]
        for due, i in landing:
            places[i] = due.position
        standing = tuple([i for i, point in enumerate(self._points) if point.stands])
        velocity = mean([due.velocity for due, _ in landing])
        touchdown = self._impact(base, standing, new, lead_time, places, velocity)
        if isinstance(touchdown, Touchdown):
            track = next((self._tracks[i] for i in new if i in self._tracks), None) or Track()
            track.add(sample.stamp, touchdown, -dot(self.scene.normal, velocity))
            for i in new:
                self._tracks[i] = track
        return touchdown

    def _foot(self, number: int, stamp: int, dues: list[Due | None]) -> Foot:
        """A foot as the sample of a stamp in ns shows it."""
        name, each = self._walking.feet[number], self._walking.points
        own = self._points[number * each : (number + 1) * each]
        standing = [point.stance.since for point in own if point.stands]
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
