"""Feet, joints, forces, plans and heights as bytes of ROS 2 Jazzy: what simulations, searches and tests tell."""

from __future__ import annotations

import struct

from ...prediction.types import FeetStates, Joints, Schedule, Terrain, Wrench
from ..cdr import LITTLE_ENDIAN, LITTLE_ENDIAN_HEADER, align8, stamp, string
from .message import write_length, write_numbers, write_texts


def encode_feet(feet: FeetStates) -> bytes:
    """A sensor_msgs/MultiDOFJointState of points that do not turn."""
    data = _headed(feet.stamp, feet.frame_id)
    write_texts(data, feet.names)
    rests = (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3
    for vectors, rest in zip((feet.positions, feet.velocities, feet.forces), rests, strict=True):
        write_length(data, len(vectors))
        if vectors:
            data += bytes(align8(len(data)) - len(data))
            data += b"".join([struct.pack(f"<{3 + len(rest)}d", *vector, *rest) for vector in vectors])
    return bytes(data)


def encode_joints(joints: Joints) -> bytes:
    """A sensor_msgs/JointState."""
    data = _headed(joints.stamp, "")
    write_texts(data, joints.names)
    for numbers in (joints.positions, joints.velocities, joints.efforts):
        write_numbers(data, numbers)
    return bytes(data)


def encode_wrench(wrench: Wrench) -> bytes:
    """A geometry_msgs/WrenchStamped without a torque."""
    data = _headed(wrench.stamp, wrench.frame_id)
    data += bytes(align8(len(data)) - len(data))
    return bytes(data + LITTLE_ENDIAN.wrench_numbers.pack(*wrench.force, 0.0, 0.0, 0.0))


def encode_schedule(schedule: Schedule) -> bytes:
    """A trajectory_msgs/JointTrajectory whose positions are 1 where a foot stands and 0 where it swings."""
    data = _headed(schedule.stamp, "")
    write_texts(data, schedule.feet)
    write_length(data, len(schedule.times))
    for time, stands in zip(schedule.times, schedule.stands, strict=True):
        for numbers in ([1.0 if one else 0.0 for one in stands], (), (), ()):
            write_numbers(data, numbers)
        data += stamp(time - schedule.stamp)
    return bytes(data)


def encode_terrain(terrain: Terrain) -> bytes:
    """A sensor_msgs/PointCloud2 with a row of points, which float32 rounds."""
    data = _headed(terrain.stamp, terrain.frame_id)
    data += struct.pack("<3I", 1, len(terrain.points), 3)
    for k, name in enumerate("xyz"):
        data += string(name) + struct.pack("<IB3xI", 4 * k, 7, 1)
    points = terrain.points.astype("<f4").tobytes()
    return bytes(data + struct.pack("<?3x3I", False, 12, len(points), len(points)) + points + b"\x01")


def _headed(nanoseconds: int, frame_id: str) -> bytearray:
    return bytearray(LITTLE_ENDIAN_HEADER + stamp(nanoseconds) + string(frame_id))
