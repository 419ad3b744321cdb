"""What a walking machine is told, both ways: its joints, the forces at its feet, and when they are to stand.

sensor_msgs/JointState, geometry_msgs/WrenchStamped and trajectory_msgs/JointTrajectory of ROS 2 Jazzy.
"""

from __future__ import annotations

from typing import Final

from ...prediction.types import Joints, Schedule, Wrench
from ...stamps import NANOSECONDS
from ..cdr import (
    LITTLE_ENDIAN,
    LITTLE_ENDIAN_HEADER,
    add_doubles,
    add_strings,
    align4,
    align8,
    check_end,
    decoder,
    read_doubles,
    read_header,
    read_strings,
    stamp,
    string,
)
from .inputs import JOINT_STATE, JOINT_TRAJECTORY, WRENCH

STANDS: Final = 0.5
"""The position above which a foot of a plan stands: 1 stands, 0 swings."""

_WRENCH_SIZE: Final = LITTLE_ENDIAN.wrench_numbers.size


@decoder(JOINT_STATE)
def decode_joints(data: bytes) -> Joints:
    """The joints in the bytes of a sensor_msgs/JointState, of either byte order; its numbers are taken as they are.

    Raises:
        MalformedMessage: the bytes are no such message.
    """
    order, nanoseconds, _, end = read_header(data)
    names, end = read_strings(data, end, order)
    positions, end = read_doubles(data, end, order)
    velocities, end = read_doubles(data, end, order)
    _, end = read_doubles(data, end, order)
    check_end(data, end, 3)
    return Joints(nanoseconds, names, positions, velocities)


@decoder(WRENCH)
def decode_wrench(data: bytes) -> Wrench:
    """The force in the bytes of a geometry_msgs/WrenchStamped, of either byte order; its numbers are taken as they are.

    Raises:
        MalformedMessage: the bytes are no such message.
    """
    order, nanoseconds, frame_id, end = read_header(data)
    start = align8(end)
    x, y, z, *_ = order.wrench_numbers.unpack_from(data, start)
    check_end(data, start + _WRENCH_SIZE)
    return Wrench(nanoseconds, frame_id, (x, y, z))


@decoder(JOINT_TRAJECTORY)
def decode_schedule(data: bytes) -> Schedule:
    """The plan in the bytes of a trajectory_msgs/JointTrajectory, of either byte order: its joints are feet.

    A foot stands from the time of a point on where its position there is above `STANDS`.

    Raises:
        MalformedMessage: the bytes are no such message.
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
    return Schedule(nanoseconds, feet, tuple(times), tuple(stands))


def encode_joints(joints: Joints) -> bytes:
    """A sensor_msgs/JointState without efforts."""
    data = _headed(joints.stamp, "")
    add_strings(data, joints.names)
    for numbers in (joints.positions, joints.velocities, ()):
        add_doubles(data, numbers)
    return bytes(data)


def encode_wrench(wrench: Wrench) -> bytes:
    """A geometry_msgs/WrenchStamped without a torque."""
    data = _headed(wrench.stamp, wrench.frame_id)
    data += bytes(align8(len(data)) - len(data))
    return bytes(data + LITTLE_ENDIAN.wrench_numbers.pack(*wrench.force, 0.0, 0.0, 0.0))


def encode_schedule(schedule: Schedule) -> bytes:
    """A trajectory_msgs/JointTrajectory whose positions are 1 where a foot stands and 0 where it swings."""
    data = _headed(schedule.stamp, "")
    add_strings(data, schedule.feet)
    data += LITTLE_ENDIAN.length.pack(len(schedule.times))
    for time, stands in zip(schedule.times, schedule.stands, strict=True):
        for numbers in ([1.0 if one else 0.0 for one in stands], (), (), ()):
            add_doubles(data, numbers)
        data += stamp(time - schedule.stamp)
    return bytes(data)


def _headed(nanoseconds: int, frame_id: str) -> bytearray:
    return bytearray(LITTLE_ENDIAN_HEADER + stamp(nanoseconds) + string(frame_id))
