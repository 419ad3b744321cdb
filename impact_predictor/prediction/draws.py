"""How sure an impact in three dimensions is: modes, lifts and twist after it, from what is uncertain before it.

Uncertain are the gaps of the points that strike, whose order of closing decides what lifts; the twist; friction and
restitution; and the law itself, which a measured contact follows only so far. Fixed points carry the first of these
through the law, all of them at once; the last one blurs what each contact does after it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mechanics.compiled import door
from ..mechanics.impact.solve import MODES
from ..mechanics.impact.spatial import STEPS
from ..mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT
from ..mechanics.types import Mode, Twist
from . import drawn
from .drawn import LIFTS, LIKELIEST, OF_MODE, PLANAR, SCRATCH
from .planar import RESTS, hardly
from .scene import Scene
from .types import Covariance, Sample, Uncertainty, Vector3
from .uncertainty import factor_of, normal_points, product
from .vectors import Axes, cross

NOTHING = np.empty((0, 0))
"""What turns no draw of a twist that is sure."""

DRAW_STEPS = 5
"""Steps of the law for a draw: its error is small beside what the draws differ by."""


class Draws:
    """Carries what is uncertain about the impacts of a scene through the law that `solve` solves."""

    def __init__(self, scene: Scene, solve: Any) -> None:
        self._scene, self._solve = scene, solve
        self._spread, self._tell = law_code()
        self._coefficients = bool(scene.friction_deviation or scene.restitution_deviation)

    def drawn(
        self,
        sample: Sample,
        axes: Axes,
        problem: NDArray[np.float64],
        standing: int,
        rates: list[float],
        gap: float,
        now: Axes,
        axis: Vector3,
    ) -> tuple[Mode, list[float], int, list[float], Uncertainty]:
        """What the draws of an impact say: the likeliest mode that a draw has; the mean answer over the draws with it,
        and the notes of one of them; the probabilities with which each contact lifts; how sure the impact is.

        `problem` is as the law takes it, and the first `standing` of the contacts stand; the `axes` of the
        sample turn the covariance of its twist; `rates` in m/s are those of the other gaps, whose standard deviation is
        `gap`; `now` are the body's axes at the touchdown, and `axis` that of the impact plane.
        """
        scene, n = self._scene, (len(problem) - BODY) // CONTACT
        factor, given = factor_of(sample.twist_covariance)
        used = given is Covariance.USED
        turns = used and any(sample.twist_covariance)
        striking = n - standing if gap > 0.0 and n - standing > 1 else 0
        dimensions = (6 if turns else 0) + (2 if self._coefficients else 0) + striking
        size, count, problems = ANSWER + RESULT * n, 1, problem[None]
        if dimensions:
            points = normal_points(scene.samples, dimensions)
            count = points.shape[1]
            problems = np.empty((count, len(problem)))
            moves = product(into_world(axes, scene.center_of_mass), factor) if turns else NOTHING
            deviations = scene.friction_deviation, scene.restitution_deviation, gap if striking else 0.0
            self._spread(n, standing, problem, moves, points, np.array((*deviations, *rates)), problems)
        answers, notes = np.empty((count, size)), np.empty(count, np.int64)
        self._solve(problems, answers, notes, DRAW_STEPS if dimensions else STEPS)
        told = np.empty(LIFTS + n + size + SCRATCH + count)
        frame = *now[0], *now[1], *now[2], *scene.center_of_mass, *axis, *scene.normal
        how = np.array((-RESTS * min(rates), scene.law_deviation, hardly(scene), *frame))
        self._tell(n, standing, problem, answers, how, told)
        numbers = told.tolist()
        x, y, turn, xx, yy, turning = numbers[PLANAR : PLANAR + 6]
        uncertainty = Uncertainty(
            given=given,
            probabilities=tuple(numbers[0:PLANAR:OF_MODE]),
            mean=Twist(x, y, turn),
            deviation=Twist(sqrt(xx), sqrt(yy), sqrt(turning)),
            twist_covariance=tuple(numbers[PLANAR + 6 : LIKELIEST]) if used else sample.twist_covariance,
        )
        mode, one = (int(number) for number in numbers[LIKELIEST:LIFTS])
        return (
            MODES[mode],
            numbers[LIFTS + n : LIFTS + n + size],
            int(notes[one]),
            numbers[LIFTS : LIFTS + n],
            uncertainty,
        )


@cache
def law_code() -> tuple[Callable[..., None], Callable[..., None]]:
    """The law code that makes draws, and that which reads their answers, compiled, where it can be, and loaded."""
    spread, tell = door(drawn.spread), door(drawn.tell, inlined=(drawn.over,))
    problem, draw = np.ones(BODY + CONTACT), np.ones((1, BODY + CONTACT))
    spread(1, 0, problem, NOTHING, np.ones((1, 1)), np.array((0.0, 0.0, 1.0, -1.0)), draw)
    numbers = np.empty(LIFTS + 2 + ANSWER + RESULT + SCRATCH)
    tell(1, 0, problem, np.ones((1, ANSWER + RESULT)), np.ones(21), numbers)
    return spread, tell


def into_world(axes: Axes, center: Vector3) -> NDArray[np.float64]:
    """From a twist at the body frame's origin to that of the mass centre in the world (6, 6)."""
    # a . R (v + w x c) = (R^T a) . v + (c x R^T a) . w
    rows = [(*world, *cross(center, world)) for world in zip(*axes, strict=True)]
    rows += [(0.0, 0.0, 0.0, *world) for world in zip(*axes, strict=True)]
    return np.array(rows)
