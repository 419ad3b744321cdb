"""The inputs of the predictor as bytes of ROS 2 Jazzy, both ways.

nav_msgs/Odometry, geometry_msgs/PolygonStamped and WrenchStamped, sensor_msgs/Imu, JointState, MultiDOFJointState and
PointCloud2, trajectory_msgs/JointTrajectory, and of tf2_msgs/TFMessage what is read. Each decoder takes either byte
order, takes numbers as they are, and raises MalformedMessage where the bytes are no such message.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final, NamedTuple

from ...prediction.types import FeetStates, Geometry, Imu, Joints, Sample, Schedule, Terrain, Transform, Wrench
from ...stamps import NANOSECONDS
from ..cdr import (
    HEADER_SIZE,
    LITTLE_ENDIAN,
    LITTLE_ENDIAN_HEADER,
    MalformedMessage,
    align4,
    align8,
    byte_order,
    check_end,
    decoder,
    read_doubles,
    read_header,
    read_string,
    read_strings,
    stamp,
    string,
)

ODOMETRY: Final = "nav_msgs/msg/Odometry"
POLYGON: Final = "geometry_msgs/msg/PolygonStamped"
IMU: Final = "sensor_msgs/msg/Imu"
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
MULTI_DOF_JOINT_STATE: Final = "sensor_msgs/msg/MultiDOFJointState"
WRENCH: Final = "geometry_msgs/msg/WrenchStamped"
JOINT_TRAJECTORY: Final = "trajectory_msgs/msg/JointTrajectory"
POINT_CLOUD: Final = "sensor_msgs/msg/PointCloud2"
TF_MESSAGE: Final = "tf2_msgs/msg/TFMessage"

_ODOMETRY_NUMBERS_SIZE: Final = LITTLE_ENDIAN.odometry_numbers.size
_POINT_SIZE: Final = LITTLE_ENDIAN.point32.size
_UNKNOWN: Final = (0.0,) * 9
_ABSENT: Final = (-1.0, *_UNKNOWN[1:])
"""The covariance of what a sensor does not measure, by the definition of the message."""
STANDS: Final = 0.5
"""The position above which a foot of a plan stands: 1 stands, 0 swings."""


@decoder(ODOMETRY)
def decode_odometry(data: bytes) -> Sample:
    """The sample in the bytes of a nav_msgs/Odometry."""
    order, nanoseconds, frame_id, end = read_header(data)
    child_frame_id, end = read_string(data, align4(end), order)
    start = align8(end)
    n = order.odometry_numbers.unpack_from(data, start)
    check_end(data, start + _ODOMETRY_NUMBERS_SIZE)
    return Sample(
        stamp=nanoseconds,
        frame_id=frame_id,
        child_frame_id=child_frame_id,
        position=n[0:3],
        orientation=n[3:7],
        linear=n[43:46],
        angular=n[46:49],
        pose_covariance=n[7:43],
        twist_covariance=n[49:85],
    )


@decoder(POLYGON)
def decode_polygon(data: bytes) -> Geometry:
    """The contact points in the bytes of a geometry_msgs/PolygonStamped, as float32 gives them."""
    order, nanoseconds, frame_id, end = read_header(data)
    (count,) = order.length.unpack_from(data, align4(end))
    start = align4(end) + 4
    end = start + count * _POINT_SIZE
    check_end(data, end)
    points = tuple((x, y, z) for x, y, z in order.point32.iter_unpack(data[start:end]))
    return Geometry(nanoseconds, frame_id, points)


@lru_cache(maxsize=64)
def _odometry_frames(frame_id: str, child_frame_id: str) -> bytes:
    """What lies between the stamp and the first double of a nav_msgs/Odometry."""
    frames = string(frame_id) + string(child_frame_id)
    # The stamp before them has eight bytes, so they end at a multiple of eight when they are one.
    return frames if len(frames) % 8 == 0 else frames + bytes(4)


_pack_numbers = LITTLE_ENDIAN.odometry_numbers.pack


def encode_odometry(sample: Sample) -> bytes:
    """A nav_msgs/Odometry of a sample."""
    return b"".join(
        (
            LITTLE_ENDIAN_HEADER,
            stamp(sample.stamp),
            _odometry_frames(sample.frame_id, sample.child_frame_id),
            _pack_numbers(
                *sample.position,
                *sample.orientation,
                *sample.pose_covariance,
                *sample.linear,
                *sample.angular,
                *sample.twist_covariance,
            ),
        )
    )


def encode_polygon(geometry: Geometry) -> bytes:
    """A geometry_msgs/PolygonStamped of contact points, which float32 rounds."""
    head = LITTLE_ENDIAN_HEADER + stamp(geometry.stamp) + string(geometry.frame_id)
    points = b"".join([LITTLE_ENDIAN.point32.pack(*point) for point in geometry.points])
    return head + LITTLE_ENDIAN.length.pack(len(geometry.points)) + points


@decoder(IMU)
def decode_imu(data: bytes) -> Imu:
    """The measurement in the bytes of a sensor_msgs/Imu."""
    order, nanoseconds, frame_id, end = read_header(data)
    start = align8(end)
    n = order.imu_numbers.unpack_from(data, start)
    check_end(data, start + order.imu_numbers.size)
    orientation = None if n[4] == -1.0 else n[0:4]
    return Imu(stamp=nanoseconds, frame_id=frame_id, orientation=orientation, angular=n[13:16], specific_force=n[25:28])


def encode_imu(imu: Imu) -> bytes:
    """A sensor_msgs/Imu of a measurement, with unknown covariances; without an orientation it says so."""
    turned = (0.0, 0.0, 0.0, 1.0, *_ABSENT) if imu.orientation is None else (*imu.orientation, *_UNKNOWN)
    numbers = LITTLE_ENDIAN.imu_numbers.pack(*turned, *imu.angular, *_UNKNOWN, *imu.specific_force, *_UNKNOWN)
    head = LITTLE_ENDIAN_HEADER + stamp(imu.stamp) + string(imu.frame_id)
    return head + bytes(align8(len(head)) - len(head)) + numbers


@decoder(JOINT_STATE)
def decode_joints(data: bytes) -> Joints:
    """The joints in the bytes of a sensor_msgs/JointState."""
    order, nanoseconds, _, end = read_header(data)
    names, end = read_strings(data, end, order)
    positions, end = read_doubles(data, end, order)
    velocities, end = read_doubles(data, end, order)
    efforts, end = read_doubles(data, end, order)
    check_end(data, end, 3)
    return Joints(stamp=nanoseconds, names=names, positions=positions, velocities=velocities, efforts=efforts)


@decoder(MULTI_DOF_JOINT_STATE)
def decode_feet(data: bytes) -> FeetStates:
    """The feet in the bytes of a sensor_msgs/MultiDOFJointState: each is a joint that moves in all directions."""
    order, nanoseconds, frame_id, end = read_header(data)
    names, end = read_strings(data, end, order)
    parts = []
    for each in (7, 6, 6):  # transforms, twists and wrenches: the first three numbers of each are those of the point
        numbers, end = read_doubles(data, end, order, each)
        parts.append(tuple(zip(numbers[::each], numbers[1::each], numbers[2::each], strict=True)))
    check_end(data, end, 3)
    return FeetStates(nanoseconds, frame_id, names, *parts)


@decoder(WRENCH)
def decode_wrench(data: bytes) -> Wrench:
    """The force in the bytes of a geometry_msgs/WrenchStamped."""
    order, nanoseconds, frame_id, end = read_header(data)
    start = align8(end)
    x, y, z, *_ = order.wrench_numbers.unpack_from(data, start)
    check_end(data, start + order.wrench_numbers.size)
    return Wrench(nanoseconds, frame_id, (x, y, z))


@decoder(JOINT_TRAJECTORY)
def decode_schedule(data: bytes) -> Schedule:
    """The plan in the bytes of a trajectory_msgs/JointTrajectory: its joints are feet.

    A foot stands from the time of a point on where its position there is above `STANDS`.
    """
    order, nanoseconds, _, end = read_header(data)
    feet, end = read_strings(data, end, order)
    (count,) = order.length.unpack_from(data, align4(end))
    end = align4(end) + 4
    times, stands = [], []
    for _ in range(count):
        positions, end = read_doubles(data, end, order)
        for _ in ("velocities", "accelerations", "effort"):
            _, end = read_doubles(data, end, order)
        seconds, rest = order.stamp.unpack_from(data, align4(end))
        end = align4(end) + 8
        times.append(nanoseconds + seconds * NANOSECONDS + rest)
        stands.append(tuple(position > STANDS for position in positions))
    check_end(data, end, 4 * count)
    return Schedule(stamp=nanoseconds, feet=feet, times=tuple(times), stands=tuple(stands))


_FLOATS: Final = {7: "f4", 8: "f8"}
"""The types of numbers in a sensor_msgs/PointField that heights have: FLOAT32 and FLOAT64."""


@decoder(POINT_CLOUD)
def decode_terrain(data: bytes) -> Terrain:
    """The heights in the bytes of a sensor_msgs/PointCloud2, whose fields x, y and z are floats."""
    order, nanoseconds, frame_id, end = read_header(data)
    height, width, count = (order.length.unpack_from(data, align4(end) + 4 * k)[0] for k in range(3))
    end = align4(end) + 12
    fields = {}
    for _ in range(count):
        name, end = read_string(data, align4(end), order)
        (offset,) = order.length.unpack_from(data, align4(end))
        fields[name] = offset, data[align4(end) + 4]
        end = align4(end) + 12
    mark = ">" if data[end] else "<"
    step, row, size = (order.length.unpack_from(data, align4(end + 1) + 4 * k)[0] for k in range(3))
    start = align4(end + 1) + 12
    check_end(data, start + size + 1)
    told = [fields.get(name, (0, 0)) for name in "xyz"]
    if height * row > size or width * step > row or any(kind not in _FLOATS for _, kind in told):
        raise MalformedMessage(f"not a {POINT_CLOUD} with the floats x, y and z")
    import numpy as np  # only a scene with a terrain asks: what starts before ROS does has no threads of numpy's

    formats, offsets = [mark + _FLOATS[kind] for _, kind in told], [offset for offset, _ in told]
    try:
        layout = np.dtype({"names": list("xyz"), "formats": formats, "offsets": offsets, "itemsize": step})
        rows = np.ndarray((height, width), layout, data, start, (row, step))
    except ValueError as error:
        raise MalformedMessage(f"not a {POINT_CLOUD}: {error}") from None
    points = np.stack([rows[name].ravel().astype(float) for name in "xyz"], axis=1)
    return Terrain(nanoseconds, frame_id, points)


@decoder(TF_MESSAGE)
def decode_transforms(data: bytes) -> tuple[Transform, ...]:
    """The transforms in the bytes of a tf2_msgs/TFMessage."""
    order = byte_order(data)
    (count,) = order.length.unpack_from(data, HEADER_SIZE)
    end = HEADER_SIZE + 4
    found = []
    for _ in range(count):
        seconds, rest = order.stamp.unpack_from(data, align4(end))
        frame_id, end = read_string(data, align4(end) + 8, order)
        child_frame_id, end = read_string(data, align4(end), order)
        start = align8(end)
        n = order.transform_numbers.unpack_from(data, start)
        end = start + order.transform_numbers.size
        found.append(Transform(seconds * NANOSECONDS + rest, frame_id, child_frame_id, n[0:3], n[3:7]))
    check_end(data, end)
    return tuple(found)


class InputType(NamedTuple):
    """How the messages on an input travel: the name of their type, and what reads their bytes."""

    name: str
    decode: Callable[[bytes], Any]


INPUT_TYPES: Final = {
    "odom": InputType(ODOMETRY, decode_odometry),
    "imu": InputType(IMU, decode_imu),
    "contact_geometry": InputType(POLYGON, decode_polygon),
    "feet_states": InputType(MULTI_DOF_JOINT_STATE, decode_feet),
    "joint_states": InputType(JOINT_STATE, decode_joints),
    "contact_wrench": InputType(WRENCH, decode_wrench),
    "schedule": InputType(JOINT_TRAJECTORY, decode_schedule),
    "terrain": InputType(POINT_CLOUD, decode_terrain),
    "tf": InputType(TF_MESSAGE, decode_transforms),
    "tf_static": InputType(TF_MESSAGE, decode_transforms),
}
"""The types of the messages on each kind of input (see `impact_predictor.prediction.scene`)."""
