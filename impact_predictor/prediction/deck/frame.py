"""The frame of a moving support: a body's samples seen from there, its motion there, and the way back to the world.

With R the support's rotation, p and v the place and the velocity of its origin, W its angular velocity (v and W along
its own axes): a body at r in the support's frame moves there with R^T r' - v - W x r, where r' is its velocity in the
world, and turns with its angular velocity less W.

A body in an impact plane that is fixed in the support, with axes `ahead` and the support's normal, feels of the
support's rotation

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
from math import hypot
from typing import Final

from ...mechanics.motion import Fall, PlanarState, next_strike
from ...mechanics.motion.felt import FeltPolynomials, FrameAcceleration
from ...mechanics.types import Contact, TwoPointBody
from ..checks import with_motion
from ..planar import ORIGIN, ImpactPlane, Posture, center_of
from ..scene import Scene
from ..types import Felt, Moment, Prediction, Quaternion, Sample, Vector3
from ..vectors import add, axes_of, composed, cross, dot, times, to_body, to_world, turned

APART: Final = 1e-6
"""Contacts nearer to each other in the plane than this part of their distance from the mass centre are one."""

PART: Final = 0.25  # length in s of one polynomial
NODES: Final = 7
"""Values that a polynomial goes through. Of what swings at w rad/s it misses (w / 8 s)^7 / 322560: 2e-10 at 2 rad/s."""


def seen_from(moment: Moment, frame: str, sample: Sample) -> Sample | None:
    """The sample in the support's frame, its twist relative to the support; None where its frame is neither's.

    `moment` is that of the sample's stamp. A sample in the world frame of the support is converted; one in the
    support's own frame, or in the `frame` by which the scene calls it, is relative already and comes back as it is.
    The covariances stay as they are: the support's motion counts as exact, and that of the twist is along the body's
    axes.
    """
    if sample.frame_id != moment.frame_id or not sample.frame_id:
        known = sample.frame_id and sample.frame_id in (moment.child_frame_id, frame)
        return sample if known else None
    support = axes_of(moment.orientation)
    place = to_body(support, add(sample.position, moment.position, -1.0))
    x, y, z, w = moment.orientation
    orientation = composed((-x, -y, -z, w), sample.orientation)
    axes = axes_of(orientation)
    spin = moment.felt.angular
    linear = add(sample.linear, to_body(axes, add(moment.linear, cross(spin, place))), -1.0)
    angular = add(sample.angular, to_body(axes, spin), -1.0)
    return with_motion(sample, sample.stamp, moment.child_frame_id, place, orientation, linear, angular)


def post_impact(prediction: Prediction) -> tuple[Vector3, Quaternion, Vector3, Vector3]:
    """Position, orientation, linear and angular velocity of the body right after its touchdown, as in its samples.

    Over a moving support whose samples are in the world they are brought back there: the support goes on until the
    touchdown with constant acceleration, in the world, and constant angular acceleration.

    Raises:
        ValueError: the prediction has no touchdown.
    """
    touchdown, moment = prediction.touchdown, prediction.support
    if touchdown is None:
        raise ValueError("a prediction without a touchdown has no state after it")
    position, orientation = touchdown.position, touchdown.orientation
    linear, angular = touchdown.linear, touchdown.angular
    if moment is None or prediction.sample.frame_id != moment.frame_id:
        return position, orientation, linear, angular
    felt, start, time = moment.felt, axes_of(moment.orientation), touchdown.lead_time
    acceleration = add(moment.gravity, to_world(start, felt.gravity), -1.0)
    velocity = add(to_world(start, moment.linear), acceleration, time)
    origin = add(add(moment.position, to_world(start, moment.linear), time), acceleration, 0.5 * time * time)
    rotation = times(add(felt.angular, felt.turning, 0.5 * time), time)
    pose = turned(moment.orientation, rotation)
    support, spin = axes_of(pose), add(felt.angular, felt.turning, time)
    axes = axes_of(orientation)
    drift = add(to_body(support, velocity), cross(spin, position))
    return (
        add(origin, to_world(support, position)),
        composed(pose, orientation),
        add(linear, to_body(axes, drift)),
        add(angular, to_body(axes, spin)),
    )


def pull_at(felt: Felt, place: Vector3, velocity: Vector3) -> Vector3:
    """Acceleration in m/s^2 that a free body has in the support's frame, along its axes.

    `place` in m and `velocity` in m/s are in and relative to that frame: gravity felt at the origin, and the
    accelerations of Euler, of the centrifugal force and of Coriolis.
    """
    spin = felt.angular
    inner = add(cross(spin, place), velocity, 2.0)
    euler = cross(felt.turning, place)
    outer = cross(spin, inner)
    gx, gy, gz = felt.gravity
    return gx - euler[0] - outer[0], gy - euler[1] - outer[1], gz - euler[2] - outer[2]


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
) -> Fall | None:
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
        return None
    body = TwoPointBody(scene.mass, inertia, old, new)
    fall = next_strike(body, start, None if old is None else 0, support, duration)
    return fall if old or fall is None else fall._replace(point=0)
