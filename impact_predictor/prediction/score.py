"""Predicted against happened: the predictions of one touchdown, and the velocities measured after it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import hypot, sqrt
from typing import Final, NamedTuple

from ..mechanics.types import Mode, Twist
from ..stamps import NANOSECONDS
from .course import STEP, Course, Pose, between
from .planar import Posture, center_of
from .recorded import BEFORE, RecordedTouchdown, TouchdownRecorder
from .scene import Scene
from .skill import simple_answers
from .types import Leftover, Sample, Score, SpatialTwist, Touchdown, Vector3
from .vectors import add, axes_of, cross, dot, lines, mean, to_world, total

MEASURED = slice(1, 4)
"""Samples 2 to 4 after a touchdown: the first may average the impact itself, later ones see friction and bounces."""

LONGEST = 1000  # how many predictions of one touchdown are remembered

LEAST_SPEED: Final = 1e-100
"""m/s: below it what a twist was before a touchdown is rounding, and parts of it would overflow."""

LIFT: Final = 0.1
"""Contacts have lifted when their mean gap rises by more than this part of the contact tolerance between the first and
the third frame after the touchdown, and by more than the steps of the predicted course may raise them."""

LIFTS: Final = (Mode.PIVOT_SLIDE, Mode.PIVOT, Mode.FLIGHT), (Mode.BACK_PIVOT, Mode.FLIGHT)
"""The modes in which the old and the new contact lift."""


class Lift(NamedTuple):
    """Whether a group of contacts lifts, as told and as measured, and its probability where that was told."""

    told: bool
    measured: bool
    probability: float | None


@dataclass(frozen=True)
class SpatialScore:
    """The whole twist after a touchdown, as predicted and as the record shows it between two frames.

    `stamp` in ns is when the record shows the touchdown, `late` by how many s it was predicted later, `kind` and the
    points `old` and `new` what stood and struck; `told` is the touchdown as it was predicted last, `course` how the
    body goes on from there, and `seen` its pose in the three frames after it, `moments` s after the predicted one, of
    which the last two are a `step` apart. What follows from these is computed when it is asked for.
    """

    stamp: int
    late: float
    kind: str
    old: tuple[int, ...]
    new: tuple[int, ...]
    told: Touchdown
    course: Course
    moments: tuple[float, float, float]
    step: float
    seen: tuple[Pose, Pose, Pose]

    @cached_property
    def measured(self) -> SpatialTwist:
        """Between the second and the third frame after the touchdown."""
        return between(self.seen[1], self.seen[2], self.step)

    @cached_property
    def predicted(self) -> SpatialTwist:
        """What the predicted twist has become between these frames."""
        return between(self._expected[1], self._expected[2], self.step)

    @property
    def error(self) -> float:
        """The distance of both, relative to the twist before the touchdown."""
        return self._relative(self.predicted)

    @property
    def lifts(self) -> tuple[Lift | None, Lift | None]:
        """Whether the old and the new contact lift; a corner alone always does, and is not asked."""
        groups = self.old, () if len(self.new) == 1 and not self.old else self.new
        same = (self.told.old, self.told.new) == (self.old, self.new)
        chances = self.told.uncertainty.probabilities if same and self.told.uncertainty else None
        least = max(LIFT * self.course.scene.tolerance, self._chord)
        return tuple(  # type: ignore[return-value]
            Lift(
                told=self._rise(group, self._expected) > least,
                measured=self._rise(group, self.seen) > least,
                probability=None if chances is None else total([chances[mode] for mode in modes]),
            )
            if group
            else None
            for group, modes in zip(groups, LIFTS, strict=True)
        )

    @cached_property
    def simple_errors(self) -> tuple[float, ...]:
        """The errors of `SIMPLE` answers."""
        answers = [course.poses(twist, self.moments) for course, twist in simple_answers(self.told, self.course)]
        return tuple([self._relative(between(second, third, self.step)) for _, second, third in answers])

    @cached_property
    def size(self) -> float:
        """Half the least distance of two points in m, which makes speeds of angular velocities."""
        lines = [add(one, other, -1.0) for one, other in combinations(self.course.points, 2)]
        return 0.5 * sqrt(min([dot(line, line) for line in lines], default=0.0))

    @cached_property
    def _expected(self) -> list[Pose]:
        return self.course.poses(self.told.after_6d, self.moments)

    @property
    def _chord(self) -> float:
        """How far in m a point at rest may leave the support where the body turns about it along chords, as it does in
        the steps of its course: half the square of the angle of one, times the way to the mass centre.
        """
        spin, center = self.told.after_6d[1], self.course.scene.center_of_mass
        reach = max([dot(arm, arm) for arm in [add(point, center, -1.0) for point in self.course.points]], default=0.0)
        return 0.5 * dot(spin, spin) * STEP * STEP * sqrt(reach)

    def _relative(self, twist: SpatialTwist) -> float:
        (linear, angular), (other, spin), before = twist, self.measured, self.told.before_6d
        error = self._speed(add(linear, other, -1.0), add(angular, spin, -1.0))
        scale = self._speed(*before)
        return error / scale if scale >= LEAST_SPEED else 0.0

    def _speed(self, linear: Vector3, angular: Vector3) -> float:
        return sqrt(dot(linear, linear) + self.size * self.size * dot(angular, angular))

    def _rise(self, group: tuple[int, ...], poses: Sequence[Pose]) -> float:
        """How much the mean gap of points grows from the first to the last pose."""
        scene = self.course.scene
        middle = add(mean([self.course.points[i] for i in group]), scene.center_of_mass, -1.0)
        first, last = [
            dot(scene.normal, add(at, to_world(axes_of(turn), middle))) for at, turn in (poses[0], poses[-1])
        ]
        return last - first


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
        track.answers.extend(one for one in self.answers if one[0] <= stamp)
        if not track.answers:
            return None
        made, touchdown = track.answers[-1]
        track.stamp, track.approach = made + round(touchdown.lead_time * NANOSECONDS), self.approach
        return track

    def lead_time(self, stamp: int) -> float:
        """Seconds from a stamp in ns to the predicted touchdown."""
        return (self.stamp - stamp) / NANOSECONDS


class PointRecord(NamedTuple):
    """What is known of a body on points when it touches down: its points, the acceleration of a free body there
    (m/s^2), and the touchdowns that its samples show.
    """

    points: tuple[Vector3, ...]
    gravity: Vector3
    touchdowns: TouchdownRecorder


@dataclass
class Landed:
    """A touchdown that has happened, however often it seemed to until its points rose again.

    Of these `times` the ones that a record shows are scored, without any the last one; where there is no record, the
    first one. It `is_over` once one of the points has risen.
    """

    times: int = 1
    is_over: bool = False
    is_scored: bool = False


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
