"""The motion until the next touchdown over a moving support, in an impact plane.

A body in a plane that is fixed in the support, with axes `ahead` and the support's normal, feels of the support's
rotation

- about the plane's axis: the accelerations of Euler, of the centrifugal force and of Coriolis in the plane, and minus
  the angular acceleration;
- about the other two: everything at the plane's origin. From there on Euler's and Coriolis' acceleration of a motion in
  the plane point along the axis, where the contacts take them up. What remains in the plane is of second order in these
  rates, times the body's size, and so is the gyroscopic moment where the axis is a principal one: both are left out.
  Coriolis' acceleration of a velocity along the axis lies in the plane and is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import hypot, inf

from ...mechanics.motion import Fall, MotionKind, PlanarState, next_strike
from ...mechanics.motion.support import FeltPolynomials, FrameAcceleration
from ...mechanics.types import Contact, TwoPointBody
from ..planar import ORIGIN, ImpactPlane, Posture, center_of
from ..scene import Scene
from ..types import Felt, Moment, Sample, Vector3
from ..vectors import add, cross, dot, times, to_world
from .frame import pull_at

APART = 1e-6
"""Contacts nearer to each other in the plane than this part of their distance from the mass centre are one."""


PART = 0.25
"""Length in s of one polynomial."""

NODES = 7
"""Values that a polynomial goes through. Of what swings at w rad/s it misses (w / 8 s)^7 / 322560: 2e-10 at 2 rad/s."""


def planar_support(
    moment: Moment, age: float, place: Vector3, ahead: Vector3, normal: Vector3, lateral: float
) -> FeltPolynomials:
    """A moving support as an impact plane sees it, from `age` s before the moment on.

    The plane has its origin at `place` in the support's frame, and `ahead` and `normal` are its axes there; what is
    felt counts along them, and rates counter-clockwise. The body moves with `lateral` m/s along the axis normal x
    ahead, which is against the plane's own z.
    """
    axis = cross(normal, ahead)
    felt_at = partial(_felt_at, moment.ahead, age, place, times(axis, lateral), (ahead, normal, axis))
    return FeltPolynomials(felt_at, PART, NODES, gravity=hypot(*moment.felt.gravity))


def _felt_at(
    later: Callable[[float], Felt],
    age: float,
    place: Vector3,
    velocity: Vector3,
    axes: tuple[Vector3, Vector3, Vector3],
    moments: Sequence[float],
) -> list[FrameAcceleration]:
    """What is felt at the plane's origin at some times, exactly."""
    ahead, normal, axis = axes
    found = []
    for time in moments:
        felt = later(time - age)
        pull = pull_at(felt, place, velocity)
        found.append((dot(ahead, pull), dot(normal, pull), -dot(axis, felt.angular), -dot(axis, felt.turning)))
    return found


def gravity_over(scene: Scene, moment: Moment, sample: Sample, posture: Posture) -> Vector3:
    """Acceleration that the body would have now without contacts, in the support's frame."""
    return pull_at(moment.felt, center_of(scene, sample, posture), to_world(posture.axes, posture.velocity))


def is_uniform(moment: Moment, horizon: float) -> bool:
    """Whether what is felt stays as it is everywhere: the support does not turn, and keeps its acceleration."""
    felt = moment.felt
    return felt.angular == ORIGIN and felt.turning == ORIGIN and moment.ahead(horizon) == felt


def fall_over(
    scene: Scene,
    moment: Moment,
    sample: Sample,
    posture: Posture,
    plane: ImpactPlane,
    inertia: float,
    start: PlanarState,
    height: float,
) -> Fall:
    """The next touchdown of a body on points, from `start` in its impact plane, as `next_touchdown` tells it.

    The mass centre is at `height` above the support at the sample, half a twist window after the start.
    """
    age = 0.5 * scene.twist_window
    place = add(center_of(scene, sample, posture), scene.normal, -height)
    ahead = to_world(posture.axes, plane.ahead)
    support = planar_support(moment, age, place, ahead, scene.normal, dot(plane.axis, posture.velocity))
    new = Contact(*plane.new, scene.friction)
    duration = scene.horizon + age
    old = None if plane.old is None else Contact(*plane.old, scene.friction)
    if old and hypot(new.x - old.x, new.y - old.y) <= APART * (hypot(new.x, new.y) + hypot(old.x, old.y)):
        return never(start)
    body = TwoPointBody(scene.mass, inertia, old, new)
    fall = next_strike(body, start, None if old is None else 0, support, duration)
    if fall is None:
        return never(start)
    return fall if old else fall._replace(point=0)


def never(state: PlanarState) -> Fall:
    """No touchdown."""
    return Fall(time=inf, point=-1, state=state, motion=MotionKind.FLIGHT)
