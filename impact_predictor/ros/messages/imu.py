"""Inertial sensors, both ways: sensor_msgs/Imu of ROS 2 Jazzy."""

from __future__ import annotations

from typing import Final

from ...prediction.types import Imu
from ..cdr import (
    LITTLE_ENDIAN,
    LITTLE_ENDIAN_HEADER,
    align8,
    check_end,
    decoder,
    read_header,
    stamp,
    string,
)
from .inputs import IMU

_NUMBERS_SIZE: Final = LITTLE_ENDIAN.imu_numbers.size
_UNKNOWN: Final = (0.0,) * 9
_ABSENT: Final = (-1.0, *_UNKNOWN[1:])
"""The covariance of what a sensor does not measure, by the definition of the message."""


@decoder(IMU)
def decode_imu(data: bytes) -> Imu:
    """The measurement in the bytes of a sensor_msgs/Imu, of either byte order; its numbers are taken as they are.

    Raises:
        MalformedMessage: the bytes are no such message.
    """
    order, nanoseconds, frame_id, end = read_header(data)
    start = align8(end)
    n = order.imu_numbers.unpack_from(data, start)
    check_end(data, start + _NUMBERS_SIZE)
    orientation = None if n[4] == -1.0 else n[0:4]
    return Imu(nanoseconds, frame_id, orientation, n[13:16], n[25:28])


def encode_imu(imu: Imu) -> bytes:
    """A sensor_msgs/Imu of a measurement, with unknown covariances; without an orientation it says so."""
    head = LITTLE_ENDIAN_HEADER + stamp(imu.stamp) + string(imu.frame_id)
    orientation, covariance = (
        ((0.0, 0.0, 0.0, 1.0), _ABSENT) if imu.orientation is None else (imu.orientation, _UNKNOWN)
    )
    numbers = (*orientation, *covariance, *imu.angular, *_UNKNOWN, *imu.specific_force, *_UNKNOWN)
    return head + bytes(align8(len(head)) - len(head)) + LITTLE_ENDIAN.imu_numbers.pack(*numbers)
