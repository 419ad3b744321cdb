"""The whole twist after a touchdown in three dimensions: as it was predicted, and as the record shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import sqrt
from typing import Final, NamedTuple

from ..mechanics.types import Mode
from .course import STEP, Course, Pose, between
from .skill import simple_answers
from .types import SpatialTwist, Touchdown, Vector3
from .vectors import add, axes_of, dot, mean, to_world, total

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
