"""What the predictor is told, both ways: nav_msgs/Odometry and geometry_msgs/PolygonStamped of ROS 2 Jazzy."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

from ...prediction.types import Geometry, Sample
from ..cdr import (
    LITTLE_ENDIAN,
    LITTLE_ENDIAN_HEADER,
    align4,
    align8,
    check_end,
    decoder,
    read_header,
    read_string,
    stamp,
    string,
)

ODOMETRY: Final = "nav_msgs/msg/Odometry"
POLYGON: Final = "geometry_msgs/msg/PolygonStamped"
IMU: Final = "sensor_msgs/msg/Imu"
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
WRENCH: Final = "geometry_msgs/msg/WrenchStamped"
JOINT_TRAJECTORY: Final = "trajectory_msgs/msg/JointTrajectory"

_ODOMETRY_NUMBERS_SIZE: Final = LITTLE_ENDIAN.odometry_numbers.size
_POINT_SIZE: Final = LITTLE_ENDIAN.point32.size


@decoder(ODOMETRY)
def decode_odometry(data: bytes) -> Sample:
    """The sample in the bytes of a nav_msgs/Odometry, of either byte order; its numbers are taken as they are.

    Raises:
        MalformedMessage: the bytes are no such message.
    """
    order, nanoseconds, frame_id, end = read_header(data)
    child_frame_id, end = read_string(data, align4(end), order)
    start = align8(end)
    n = order.odometry_numbers.unpack_from(data, start)
    check_end(data, start + _ODOMETRY_NUMBERS_SIZE)
    return Sample(
        nanoseconds,
        frame_id,
        child_frame_id,
        n[0:3],
        n[3:7],
        n[43:46],
        n[46:49],
        n[7:43],
        n[49:85],
    )


@decoder(POLYGON)
def decode_polygon(data: bytes) -> Geometry:
    """The contact points in the bytes of a geometry_msgs/PolygonStamped, of either byte order, as float32 gives them.

    Raises:
        MalformedMessage: the bytes are no such message.
    """
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
    points = geometry.points
    return b"".join(
        (
            LITTLE_ENDIAN_HEADER,
            stamp(geometry.stamp),
            string(geometry.frame_id),
            LITTLE_ENDIAN.length.pack(len(points)),
            *[LITTLE_ENDIAN.point32.pack(*point) for point in points],
        )
    )
