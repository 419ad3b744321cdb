"""The next touchdown of a rigid body on points over a plane support in three dimensions: `fall`.

A free body turns by Euler's equations. Points that stand hold the body, slip with Coulomb's friction against their
whole slip, begin to slip where they leave the cone of friction, and lift where the support would have to pull. Time,
place and twist at a touchdown are right to about 1e-6 of the motion's scales, and to 1e-4 of its speed where a slip
that turned came to its end on the way.

The same code runs compiled, where numba is installed, and as plain Python, and gives the same bits.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import cache
from math import inf
from typing import Any, NamedTuple

import numpy as np

from ..compiled import door
from ..types import Quaternion, Vector3
from . import falling, reactions, spatial_problem, stances
from .reactions import OPEN
from .spatial_problem import OUTPUT, WORK

AT_REST = (0.0, 0.0, 0.0)


class SpatialState(NamedTuple):
    """A rigid body in its support's frame: the support is the plane z = 0, and z points out of it.

    `position` of the mass centre in m, `orientation` as a quaternion (x, y, z, w) that turns the body's axes to the
    frame's, `velocity` of the mass centre in m/s and `angular_velocity` in rad/s, relative to the frame, along its
    axes.
    """

    position: Vector3
    orientation: Quaternion
    velocity: Vector3
    angular_velocity: Vector3


class Pull(NamedTuple):
    """What a free body feels in the support's frame, along its axes.

    `gravity` in m/s^2 at rest at the frame's origin now, and its `growth` in m/s^3. Where the frame turns: its angular
    velocity `spin` in rad/s now, and its angular acceleration `turning` in rad/s^2.
    """

    gravity: Vector3 = (0.0, 0.0, -9.81)
    growth: Vector3 = AT_REST
    spin: Vector3 = AT_REST
    turning: Vector3 = AT_REST


class SpatialFall(NamedTuple):
    """The next touchdown of a body.

    `time` in s from the given state, inf when there is none within the horizon, or when the numbers are none that a
    body can have; `point` is the index of the one that strikes, or -1; `state` right before the touchdown (the given
    one when there is none); `gaps` in m and `rates` in m/s of all points then; `standing`, the points that still stand.
    """

    time: float
    point: int
    state: SpatialState
    gaps: tuple[float, ...]
    rates: tuple[float, ...]
    standing: tuple[int, ...]


def fall(
    state: SpatialState,
    inertia: Sequence[float],
    points: Sequence[Vector3],
    standing: Collection[int] = (),
    friction: float | Sequence[float] = 0.0,
    pull: Pull = Pull(),  # noqa: B008
    horizon: float = 1.0,
) -> SpatialFall:
    """When, where and with which velocities the body touches its support next.

    `inertia` about the mass centre over the mass in m^2, as ixx, iyy, izz, ixy, ixz, iyz along the body's axes;
    `points` (n, 3) in m from the mass centre along the body's axes; `standing` are the indices of those that rest on
    the support: their gaps count as zero from then on, and what moves them out of it or into it is taken from the twist
    by the least impulse; `friction` coefficient, one number or (n,); `horizon` in s. Never raises for bad numbers, and
    never returns NaN.
    """
    # Of any sequences, as in Python: machine code would ask for the tuples that these have.
    start: Any = state
    feels: Any = pull
    arms: Any = points
    n = len(points)
    frictions = [friction] * n if isinstance(friction, float | int) else friction
    numbers = [horizon, *start.position, *start.orientation, *start.velocity, *start.angular_velocity]
    numbers += [*inertia, *feels.gravity, *feels.growth, *feels.spin, *feels.turning, *frictions]
    for arm in arms:
        numbers += arm
    marks: Any = np.zeros(5 * n + 1, np.int64)
    told: Any = np.empty(OUTPUT + 2 * n)
    for i in standing:
        marks[i] = 1
    work = np.empty(WORK[0] + WORK[1] * n + WORK[2] * n * n)
    struck = solver()(n, np.array(numbers, float), marks, work, told)
    if struck < 0:
        return SpatialFall(inf, -1, state, (), (), tuple(standing))
    out = told.tolist()
    px, py, pz, qx, qy, qz, qw, vx, vy, vz, wx, wy, wz = out[1:OUTPUT]
    return SpatialFall(
        time=out[0],
        point=struck,
        state=SpatialState((px, py, pz), (qx, qy, qz, qw), (vx, vy, vz), (wx, wy, wz)),
        gaps=tuple(out[OUTPUT::2]),
        rates=tuple(out[OUTPUT + 1 :: 2]),
        standing=tuple([i for i, mark in enumerate(marks[:n].tolist()) if mark != OPEN]),
    )


USED = (reactions, stances, falling)

INLINED = (reactions.derive, reactions.fill, reactions.locate, falling.measure, falling.crossing, stances.margins)
"""Law functions that become a part of those that call them: calls with so many sequences take a third of the time."""


@cache
def solver() -> Callable[..., int]:
    """The law code that finds a touchdown, compiled if that can be; the first time on a machine this takes seconds."""
    return door(spatial_problem.fall, USED, INLINED)
