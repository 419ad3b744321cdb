"""A body on contact points: the touchdown that a sample shows to be ahead, followed until it has happened."""

from __future__ import annotations

from bisect import insort
from collections import deque
from collections.abc import Mapping
from math import cos, hypot, sin
from operator import attrgetter
from typing import Final

from ..mechanics.motion import Fall, PlanarState, next_touchdown
from ..mechanics.types import Contact, TwoPointBody, Vector
from ..stamps import NANOSECONDS
from .checks import PAUSE, check_points, with_motion
from .impact import SLOWEST, Collision, ImpactModel, collision_after
from .planar import ImpactPlane, Posture, center_of, contacts_of, edge_of, hardly, inertia_about, plane_of, posture_of
from .predictor import DEEP, DEEP_TOLERANCES, Contacts
from .recorded import AFTER, BEFORE, Announced, RecordedTouchdown, TouchdownRecorder
from .scatter import SLACK, Scatter
from .scene import Scene
from .score import Pending, PointRecord, Track
from .spatial import SpatialModel
from .spatial_impact import SpatialCollision
from .types import ContactInput, Geometry, Leftover, Moment, Sample, Status, Touchdown, Vector3
from .vectors import add, axes_of, rotation_between, times, to_body, total

ACCURACY: Final = (
    1e-6  # of the motion before the touchdown, relative: a thousandth of what poses and twists are measured to
)
SETTLED: Final = 0.5
"""A touchdown has happened when less than this part of the approach is left, within the contact tolerance, that the
predicting sample measured: the approach predicted for the touchdown has gravity's gain on the way added to it."""

PLANE: Final = 2
"""A body on so many points moves in a plane, as those of the paper do: nothing more is prepared for it."""

HIGH: Final = 1.0
"""A body is off its moving support when all of it is farther above than this part of its size. No impact throws it
there: for a body of 1 m that takes 4.4 m/s, and one that topples keeps a contact, or one near it."""

GUESS: Final = 0.01
"""Part of a body's size that gaps over a moving support, whose noise is in them, may scatter by until that is known,
where no contact tolerance is given."""

SURELY: Final = 2.0  # times the rates that are not told from none: a point that is faster moves
WORTH: Final = 1e-4
"""m: that gaps scatter by less is not worth a word."""


class PointContacts(Contacts):
    """The contacts of a rigid body on points."""

    is_spatial = True
    """Whether touchdowns may be in three dimensions."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.points: tuple[Vector3, ...] = scene.points
        self.size = 0.0
        """Distance in m of the contact points that are furthest apart, where the support moves."""
        self.collision: tuple[Sample, Posture, Collision | SpatialCollision] | None = None
        """The last collision whose impact was computed, with the sample that shows it."""
        self.scatter = Scatter(scene)
        self._impact = ImpactModel(scene)
        self._spatial: SpatialModel | None = None
        self._moment: Moment | None = None
        self._track: Track | None = None
        self._landed: Pending | None = None
        self._pending: list[Pending] = []
        self._recent: deque[tuple[Sample, Posture]] = deque(maxlen=4)
        self._last: Sample | None = None
        self._told: deque[tuple[int, Track]] = deque(maxlen=64)
        """What the last samples announced, by their stamps in ns."""
        self._recorder = TouchdownRecorder(scene, SLOWEST * hardly(scene))
        self._measure_points()
        # What is compiled for the first touchdown is compiled now.
        if self.is_spatial and not self.points:
            SpatialModel(scene, ((0.0, 0.0, 0.0),), self.scatter)

    def tell(self, message: ContactInput) -> Status:
        assert isinstance(message, Geometry)
        status = check_points(message.points, self.scene.most_points)
        if status is Status.ACCEPTED:
            if message.points != self.points:
                self.points = message.points
                self._track = None
                self._recorder.forget()
                self._measure_points()
            self.geometry = message
            self.frame_id = message.frame_id
        return status

    def check(self, stamp: int) -> Status:
        return Status.ACCEPTED if self.points else Status.NO_GEOMETRY

    def follow(self, other: Contacts) -> None:
        if other.geometry is not None:
            self.tell(other.geometry)

    def take(self, sample: Sample, moment: Moment | None) -> Status:
        if self.scene.poses:
            sample, self._last = differenced(self._last, sample), sample
        posture = self.posture_of(sample)
        if moment is not None:
            status = self._place_of(sample, posture)
            if status is not Status.ACCEPTED:
                return status
        self.scatter.take(sample.stamp, posture)
        self.stamp = sample.stamp
        self._moment = moment
        self._measure(sample, posture)
        self._recent.append((sample, posture))
        return Status.ACCEPTED

    def touchdown(self) -> Touchdown | Status | None:
        sample, posture = self._recent[-1]
        track, collision = self._track, self.collision_of(sample, posture, self._moment)
        if self._landed is not None:
            # What an averaged twist still has of the approach before the last touchdown is no approach.
            last, since = self._landed.track.last, (sample.stamp - self._landed.stamp) / NANOSECONDS
            fresh = since < self.scene.twist_window
            if fresh and not (collision and set(collision.contacts.new).isdisjoint(last.new)):
                collision = None
                if self._spatial is not None and last.contacts:
                    collision = self._spatial.collision_after(last, since, posture, self._moment)
        if collision is None:
            self._track = None
            return None
        if track is not None and set(collision.contacts.new).isdisjoint(track.last.new):
            track = None
        if track is None:
            if self._rests():
                return None
            track = self._track = Track()
        elif 0 <= sample.stamp - track.stamp < self.scene.twist_window * NANOSECONDS or (
            self._recent[-2][0].stamp <= track.stamp <= sample.stamp
        ):
            # The impact itself may be in this twist, averaged or just begun: the last prediction stands.
            self._told.append((sample.stamp, track))
            return track.hold(sample.stamp)
        touchdown = self.touchdown_of(sample, posture, collision)
        self.collision = sample, posture, collision
        track.add(sample.stamp, touchdown, collision.measured)
        self._told.append((sample.stamp, track))
        return touchdown

    def _rests(self) -> bool:
        """Whether what seems to strike is noise: this sample or the one before shows no point off the support, and this
        one none that surely approaches.
        """
        _, posture = self._recent[-1]
        if self.scatter.is_known and min(posture.rates) < -SURELY * self.scatter.rate:
            return False
        return any(max(posture.gaps) <= self.slack for _, posture in list(self._recent)[-2:])

    def forget(self) -> None:
        for pending in self._pending:
            self._settle(pending)
        self._pending.clear()
        self._recent.clear()
        self._told.clear()
        self._recorder.forget()
        self.scatter.forget()
        self._track = self._landed = self._last = None
        self.stamp = None

    @property
    def slack(self) -> float:
        is_guessed = self._moment is not None and self.scene.tolerance == 0.0 and not self.scatter.is_known
        return GUESS * self.size if is_guessed else self.scatter.gap

    def doubts(self) -> tuple[str, ...]:
        given, gap = self.scene.tolerance, self.scatter.gap
        if not 0.0 < given < gap or gap < WORTH:
            return ()
        said = (
            f"points that stand scatter by {gap / SLACK:.2g} m, too much for a contact.tolerance of {given:g}: set it "
            f"to {gap:.2g}, or to 0.0, so that it follows what is measured"
        )
        return (said,)

    @property
    def recorded(self) -> Mapping[str, Announced]:
        return self._recorder.counts

    def posture_of(self, sample: Sample) -> Posture:
        return posture_of(self.scene, self.points, sample)

    def collision_of(
        self, sample: Sample, posture: Posture, moment: Moment | None
    ) -> Collision | SpatialCollision | None:
        """The collision that a sample shows to be ahead; None where there is none within the horizon."""
        return collision_of(self.scene, self.points, sample, posture, moment, self._spatial, self.scatter)

    def touchdown_of(self, sample: Sample, posture: Posture, collision: Collision | SpatialCollision) -> Touchdown:
        """The touchdown at the end of an approach, with its impact."""
        if isinstance(collision, Collision):
            return self._impact.touchdown(sample, posture, collision)
        assert self._spatial is not None
        return self._spatial.impact.touchdown(sample, posture.axes, collision, self._spatial.gap_deviation)

    def _measure_points(self) -> None:
        if not self.points:
            return
        if self.scene.deck is not None:
            self.size = hypot(*edge_of(list(self.points)))
        is_spatial = self.is_spatial and len(self.points) > PLANE
        self._spatial = SpatialModel(self.scene, self.points, self.scatter) if is_spatial else None

    def _place_of(self, sample: Sample, posture: Posture) -> Status:
        """Whether a body can be where it is seen on a moving support."""
        scene, lowest = self.scene, min(posture.gaps)
        if lowest < -(DEEP * self.size + DEEP_TOLERANCES * max(scene.tolerance, self.slack)):
            return Status.BELOW_SUPPORT
        if lowest > HIGH * self.size:
            return Status.OFF_SUPPORT
        center = center_of(scene, sample, posture)
        if self.has_left(center):
            return Status.OFF_SUPPORT
        extent = () if scene.deck is None else scene.deck.extent
        if extent:
            back, front, right, left = extent
            if not (back <= center[0] <= front and right <= center[1] <= left):
                return Status.OFF_SUPPORT
        return Status.ACCEPTED

    def _measure(self, sample: Sample, posture: Posture) -> None:
        """Hand the sample to the touchdowns that wait for it, and settle the tracked one if it has happened."""
        if self.is_spatial:
            self._recorder.take(sample, posture)
            for recorded in self._recorder.found:
                if recorded.is_complete and not recorded.is_matched:
                    self._match(recorded)
        for pending in self._pending:
            pending.add(sample, posture)
        while self._pending and self._pending[0].complete:
            self._settle(self._pending.pop(0))
        track, last = self._track, self._landed
        if track is not None and self._has_landed(track, posture):
            self._track, track.has_landed = None, True
            pending = Pending(track, min(track.stamp, sample.stamp), self._record)
            if last is not None:
                pending.joins(last)
            for earlier in self._recent:
                if earlier[0].stamp > pending.stamp:
                    pending.add(*earlier)
            pending.add(sample, posture)
            self._wait(pending)
            self._landed = last = pending
        least = max(hardly(self.scene), self.scatter.rate)
        if last is not None and any(posture.rates[i] > least for i in last.track.last.new):
            last.landed.is_over = True

    def _wait(self, pending: Pending) -> None:
        insort(self._pending, pending, key=attrgetter("stamp"))

    def _settle(self, pending: Pending) -> None:
        """Hand out the score of a touchdown, unless it has another one."""
        if pending.counts:
            pending.landed.is_scored = True
            self.settled.append(pending.score(self.scene))

    @property
    def _record(self) -> PointRecord | None:
        gravity = self.scene.gravity if self._moment is None else self._moment.felt.gravity
        return PointRecord(self.points, gravity, self._recorder) if self.is_spatial else None

    def _match(self, recorded: RecordedTouchdown) -> None:
        """Find what the last sample before a touchdown told of it, which the record shows, and what waits for it."""
        end = recorded.last_before
        told = [track for stamp, track in self._told if recorded.frames[1].stamp <= stamp <= end]
        last = told[-1].until(end) if told else None
        if last is not None and not recorded.is_near(last.stamp):
            last = None
        recorded.is_announced = last is not None
        near = [one for one in (*self._pending, self._landed) if one is not None and recorded.is_near(one.stamp)]
        if waiting := [one for one in near if one.recorded is None and one in self._pending]:
            _, nearest = min([(abs(one.stamp - recorded.stamp), number) for number, one in enumerate(waiting)])
            pending = waiting[nearest]
            pending.told = last or pending.track.until(end)
        else:
            is_ahead = bool(told) and told[-1] == self._track and not recorded.is_last
            if last is None or told[-1].has_landed or is_ahead or any(one.shares(last) for one in near):
                return  # what is ahead may still land, and what has landed is scored once
            told[-1].has_landed = True
            pending = Pending(last, last.stamp, self._record, Leftover.OTHER_POINTS)
            pending.told = last
            for frame in recorded.frames[BEFORE : BEFORE + AFTER]:
                pending.add(frame.sample, frame.posture)
            self._wait(pending)
        pending.recorded, recorded.is_matched = recorded, True

    def _has_landed(self, track: Track, posture: Posture) -> bool:
        gaps, rates = posture.gaps, posture.rates
        old, new = track.last.old, track.last.new
        gap = total([gaps[i] for i in new]) / len(new)
        if old:
            gap -= total([gaps[i] for i in old]) / len(old)
        approach = -total([rates[i] for i in new]) / len(new)
        near = max(self.scene.tolerance, self.scatter.gap)
        # What still rose when it was announced comes down first.
        return gap <= near and approach < SETTLED * track.approach and track.approach > 0.0


def collision_of(
    scene: Scene,
    points: tuple[Vector3, ...],
    sample: Sample,
    posture: Posture,
    moment: Moment | None = None,
    spatial: SpatialModel | None = None,
    scatter: Scatter | None = None,
) -> Collision | SpatialCollision | None:
    """The collision that a sample shows to be ahead; None where there is none within the horizon.

    Over a moving support the sample is seen from there, and `moment` is the support at its stamp. Without a `spatial`
    model the collision is one in the impact plane, which leaves out what goes across it.
    """
    contacts = contacts_of(scene, posture, scatter)
    if contacts is None:
        return None
    gravity, uniform = scene.gravity, True
    if moment is not None:
        from .deck.frame import fall_over, gravity_over, is_uniform  # only where the support moves

        gravity = gravity_over(scene, moment, sample, posture)
        uniform = is_uniform(moment, scene.horizon)
    if spatial is not None and not spatial.is_planar(sample, posture, contacts, gravity):
        return spatial.collision(sample, posture, moment)
    if uniform:
        moment = None
    plane = plane_of(scene, points, sample, posture, contacts, gravity)
    on_edge = len(contacts.old) > 1
    inertia = inertia_about(scene, plane.axis, blocked=on_edge)
    # An averaged twist is that of half its window ago: the motion is followed from there.
    age = 0.5 * scene.twist_window
    vx, vy, omega = plane.twist
    old, new = plane.old, plane.new
    if old is None:
        striking: tuple[Vector, ...] = (new,)
        height = max(0.0, total([posture.gaps[i] for i in contacts.new]) / len(contacts.new)) - new[1]
    else:
        striking = (old, new)
        height = -old[1]
    start = PlanarState(x=-vx * age, y=height - vy * age, angle=-omega * age, vx=vx, vy=vy, omega=omega)
    fall: Fall | None
    if moment is None:
        fall = next_touchdown(
            start,
            striking,
            None if old is None else 0,
            inertia / scene.mass,
            scene.friction,
            plane.gravity[:2],
            scene.horizon + age,
            ACCURACY,
        )
    else:
        fall = fall_over(scene, moment, sample, posture, plane, inertia, start, height)
    if fall is None or fall.point != len(striking) - 1:
        return None
    body = body_at(scene, plane, inertia, fall.state.angle)
    if on_edge and (body.old is None or len(contacts.new) == 1):
        body = TwoPointBody(body.mass, inertia_about(scene, plane.axis, blocked=False), body.old, body.new)
    if body.old is not None and body.old.x >= body.new.x:
        return None  # it falls back, and other points strike before
    return collision_after(sample, posture, contacts, plane, body, fall, (0.0, height), age)


def body_at(scene: Scene, plane: ImpactPlane, inertia: float, angle: float) -> TwoPointBody:
    """The body when it has turned by `angle` in the impact plane and the new contact is on the support."""
    c, s = cos(angle), sin(angle)
    x, y = plane.new
    new = Contact(c * x - s * y, s * x + c * y, scene.friction, restitution=scene.restitution)
    if plane.old is None:
        return TwoPointBody(scene.mass, inertia, None, new)
    x, y = plane.old
    if s * x + c * y - new.y > scene.tolerance:
        return TwoPointBody(scene.mass, inertia, None, new)  # it has lifted on the way
    # Where it stands both are on one level up to rounding; made exact, so that rounding does not make it a step.
    return TwoPointBody(scene.mass, inertia, Contact(c * x - s * y, new.y, scene.friction), new)


def differenced(last: Sample | None, sample: Sample) -> Sample:
    """A sample whose twist is the difference to the pose of the one before; without that as it is."""
    if last is None or not 0 < sample.stamp - last.stamp <= PAUSE:
        return sample
    rate = NANOSECONDS / (sample.stamp - last.stamp)
    linear = times(to_body(axes_of(sample.orientation), add(sample.position, last.position, -1.0)), rate)
    angular = rotation_between(last.orientation, sample.orientation, rate)
    return with_motion(sample, sample.stamp, sample.frame_id, sample.position, sample.orientation, linear, angular)
