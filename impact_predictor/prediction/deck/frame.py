"""The frame of a moving support: a body's samples seen from there, and the way back to the world.

With R the support's rotation, p and v the place and the velocity of its origin, W its angular velocity (v and W along
its own axes): a body at r in the support's frame moves there with R^T r' - v - W x r, where r' is its velocity in the
world, and turns with its angular velocity less W.
"""

from __future__ import annotations

from ..types import Felt, Moment, Prediction, Quaternion, Sample, Vector3
from ..vectors import add, axes_of, composed, cross, times, to_body, to_world, turned


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
    return sample._replace(
        frame_id=moment.child_frame_id,
        position=place,
        orientation=orientation,
        linear=add(sample.linear, to_body(axes, add(moment.linear, cross(spin, place))), -1.0),
        angular=add(sample.angular, to_body(axes, spin), -1.0),
    )


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
    state = touchdown.position, touchdown.orientation, touchdown.linear, touchdown.angular
    if moment is None or prediction.sample.frame_id != moment.frame_id:
        return state
    return in_world(moment, touchdown.lead_time, *state)


def in_world(
    moment: Moment,
    time: float,
    position: Vector3,
    orientation: Quaternion,
    linear: Vector3,
    angular: Vector3,
) -> tuple[Vector3, Quaternion, Vector3, Vector3]:
    """A pose and twist in the support's frame, `time` s after the moment, in the world; see `post_impact`."""
    felt, start = moment.felt, axes_of(moment.orientation)
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
