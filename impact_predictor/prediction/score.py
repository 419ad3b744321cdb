"""Predicted against happened: the predictions of one touchdown, and the velocities measured after it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from math import hypot

from ..mechanics.types import Twist
from ..stamps import NANOSECONDS
from .course import Course, Pose
from .planar import Posture, center_of
from .recorded import BEFORE, RecordedTouchdown, TouchdownRecorder
from .scene import Scene
from .spatial_score import LEAST_SPEED, SpatialScore
from .types import Leftover, Sample, Score, Touchdown, Vector3
from .vectors import add, axes_of, cross, dot, lines, to_world

MEASURED = slice(1, 4)
"""Samples 2 to 4 after a touchdown: the first may average the impact itself, later ones see friction and bounces."""

LONGEST = 1000  # how many predictions of one touchdown are remembered


class Track:
    """The predictions of one touchdown, from the first to the last."""

    def __init__(self) -> None:
        self.answers: deque[tuple[int, Touchdown]] = deque(maxlen=LONGEST)
        """Stamp (ns) of each sample that announced the touchdown, and how it did."""
        self.stamp = 0
        """When the touchdown is predicted, in ns."""
        self.approach = 0.0
        """How fast the new contact approached at that sample, in m/s."""
        self.has_landed = False
        """Whether the touchdown waits for the samples that measure it, or is scored."""

    def add(self, stamp: int, touchdown: Touchdown, approach: float) -> None:
        """A prediction made from the sample of `stamp`, which measured the approach."""
        self.stamp = stamp + round(touchdown.lead_time * NANOSECONDS)
        self.approach = approach
        self.answers.append((stamp, touchdown))

    def hold(self, stamp: int) -> Touchdown:
        """The last prediction as it reads at a later sample."""
        touchdown = self.last._replace(lead_time=max(0.0, self.lead_time(stamp)))
        self.answers.append((stamp, touchdown))
        return touchdown

    @property
    def last(self) -> Touchdown:
        return self.answers[-1][1]

    def until(self, stamp: int) -> Track | None:
        """The same as it was at a stamp in ns; None before its first prediction."""
        track = Track()
        track.answers.extend([one for one in self.answers if one[0] <= stamp])
        if not track.answers:
            return None
        made, touchdown = track.answers[-1]
        track.stamp, track.approach = made + round(touchdown.lead_time * NANOSECONDS), self.approach
        return track

    def lead_time(self, stamp: int) -> float:
        """Seconds from a stamp in ns to the predicted touchdown."""
        return (self.stamp - stamp) / NANOSECONDS


class PointRecord:
    """What is known of a body on points when it touches down: its points, the acceleration of a free body there
    (m/s^2), and the touchdowns that its samples show.
    """

    def __init__(self, points: tuple[Vector3, ...], gravity: Vector3, touchdowns: TouchdownRecorder) -> None:
        self.points, self.gravity, self.touchdowns = points, gravity, touchdowns


class Landed:
    """A touchdown that has happened, however often it seemed to until its points rose again.

    Of these `times` the ones that a record shows are scored, without any the last one; where there is no record, the
    first one. It `is_over` once one of the points has risen.
    """

    def __init__(self) -> None:
        self.times, self.is_over, self.is_scored = 1, False, False


class Pending:
    """A touchdown that has happened and waits for the samples that measure it; `stamp` in ns.

    Only of a body on points there is a `record` that shows its whole twist. `leftover` is why the planar score does not
    count, besides what was seen before it.
    """

    def __init__(
        self, track: Track, stamp: int, record: PointRecord | None = None, leftover: Leftover = Leftover.NONE
    ) -> None:
        self.track = track
        self.stamp = stamp
        self.recorded: RecordedTouchdown | None = None
        """What the record shows of it ..."""
        self.told: Track | None = None
        """... and what was predicted until then."""
        self.landed, self._time = Landed(), 1
        self._record, self._leftover = record, leftover
        self._measured: list[tuple[int, Vector3, Vector3]] = []

    def add(self, sample: Sample, posture: Posture) -> None:
        axes = posture.axes
        self._measured.append((sample.stamp, to_world(axes, posture.velocity), to_world(axes, sample.angular)))

    @property
    def complete(self) -> bool:
        known = self.recorded or self._record is None or self._record.touchdowns.knows(self.stamp)
        return bool(known) and self._is_measured

    def shares(self, track: Track) -> bool:
        """Whether it has a new point of other predictions."""
        return not set(self.track.last.new).isdisjoint(track.last.new)

    def joins(self, other: Pending) -> None:
        """Count as the same touchdown as the one before, if the points came down with that and none has risen since."""
        if not other.landed.is_over and set(self.track.last.new) <= set(other.track.last.new):
            self.landed = other.landed
            self.landed.times += 1
            self._time = self.landed.times

    @property
    def counts(self) -> bool:
        """Whether it is scored, of all times that its touchdown seemed to happen."""
        wanted = 1 if self._record is None else self.landed.times
        return self.recorded is not None or (self._time == wanted and not self.landed.is_scored)

    @property
    def _is_measured(self) -> bool:
        return len(self._measured) >= MEASURED.stop

    def score(self, scene: Scene) -> Score:
        """The score; where the record ended before it was complete, without what was measured."""
        # What was repeated after it told nothing new.
        made = self.track.until(self.stamp) or self.track
        last = made.last
        leftover = last.leftover | self._leftover
        score = Score(
            stamp=self.stamp,
            touchdown=last,
            measured=None,
            relative_error=None,
            scored=False,
            leftover=leftover | Leftover.TOO_SHORT,
            history=(),
            announced=made.lead_time(made.answers[0][0]),
            sample=made.answers[-1][0],
        )
        if self._record is not None:
            unscored, spatial = self._spatial(scene, self._record)
            score = score._replace(leftover_6d=unscored, spatial=spatial)
        if not self._is_measured:
            return score
        measured = self._twist(scene, last)
        score = score._replace(measured=measured, leftover=leftover)
        scale = hypot(last.before.vx, last.before.omega * last.half_distance)
        if not last.old or scale < LEAST_SPEED:
            return score
        errors = []
        for stamp, touchdown in self.track.answers:
            if stamp <= self.stamp and touchdown.old == last.old and touchdown.new == last.new:
                seen = measured if touchdown.axis == last.axis else self._twist(scene, touchdown)
                error = _distance(touchdown.after, seen, last.half_distance) / scale
                errors.append(((self.stamp - stamp) / NANOSECONDS, error))
        error = _distance(last.after, measured, last.half_distance) / scale
        return score._replace(relative_error=error, scored=not leftover, history=tuple(errors))

    def _spatial(self, scene: Scene, record: PointRecord) -> tuple[Leftover, SpatialScore | None]:
        """Why the whole twist is not scored, and what the record shows of it."""
        leftover, recorded = self.track.last.leftover & Leftover.TOO_SLOW, self.recorded
        if recorded is None:
            unseen = Leftover.UNSEEN if record.touchdowns.knows(self.stamp) else Leftover.TOO_SHORT
            return leftover | unseen, None
        if self.told is None:
            return leftover | Leftover.UNANNOUNCED, None
        if not recorded.is_even:
            return leftover | Leftover.TOO_SHORT, None
        told, stamp, frames = self.told.last, self.told.stamp, recorded.frames[BEFORE : BEFORE + 3]
        first, second, third = [(frame.stamp - stamp) / NANOSECONDS for frame in frames]
        center = add(told.position, to_world(axes_of(told.orientation), scene.center_of_mass))
        resting = tuple([contact.point for contact in told.contacts]) or told.old + told.new
        if recorded.approach < record.touchdowns.slowest:
            leftover |= Leftover.TOO_SLOW
        if not recorded.is_isolated:
            leftover |= Leftover.NOT_ISOLATED
        poses = [Pose(center_of(scene, frame.sample, frame.posture), frame.sample.orientation) for frame in frames]
        score = SpatialScore(
            stamp=recorded.stamp,
            late=(stamp - recorded.stamp) / NANOSECONDS,
            kind=recorded.kind,
            old=recorded.old,
            new=recorded.new,
            told=told,
            course=Course(scene, record.points, record.gravity, Pose(center, told.orientation), resting),
            moments=(first, second, third),
            step=third - second,
            seen=(poses[0], poses[1], poses[2]),
        )
        return leftover, score

    def _twist(self, scene: Scene, touchdown: Touchdown) -> Twist:
        ahead = cross(touchdown.axis, scene.normal)
        along = [dot(ahead, velocity) for _, velocity, _ in self._measured]
        up = [dot(scene.normal, velocity) for _, velocity, _ in self._measured]
        spin = [-dot(touchdown.axis, spin) for _, _, spin in self._measured]
        if scene.deck is None or scene.twist_window:
            vx, vy, omega = [median(values[MEASURED]) for values in (along, up, spin)]
        else:
            # What rocks on a deck comes slowly and has turned on by then: it is followed back to the touchdown.
            times = [(stamp - self.stamp) / NANOSECONDS for stamp, _, _ in self._measured]
            (vx, _), (vy, _), (omega, _) = lines(times, (along, up, spin))
        return Twist(vx, vy, omega)


def _distance(one: Twist, other: Twist, half_distance: float) -> float:
    """How far two twists are apart in the plane, as a speed in m/s."""
    return hypot(one.vx - other.vx, (one.omega - other.omega) * half_distance)


def median(numbers: Iterable[float]) -> float:
    """The middle one of some numbers, or halfway between the two; that of `statistics` takes a tenth of the start."""
    ordered = sorted(numbers)
    half = len(ordered) // 2
    return 0.5 * (ordered[half] + ordered[~half])
