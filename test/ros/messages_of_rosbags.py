"""What several tests of messages share: rosbags as the other implementation, and samples of random numbers."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_typestore

from impact_predictor.prediction.types import Sample
from impact_predictor.ros.messages import ODOMETRY

TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
TYPES = TYPESTORE.types
# Lengths of 0 to 8 bytes meet every alignment of what follows a string.
FRAMES = ("", "a", "ab", "abc", "odom", "world", "decké", "cube/a1", "base_lnk")
ODD_NUMBERS = (0.0, -0.0, 5e-324, 1.7976931348623157e308, float("inf"), -float("inf"), 0.1)


def numbers(rng: random.Random, count: int) -> Any:
    return tuple(rng.choice(ODD_NUMBERS) if rng.random() < 0.1 else rng.gauss(0.0, 10.0) for _ in range(count))


def random_sample(rng: random.Random) -> Sample:
    return Sample(
        stamp=rng.randrange(-(2**31) * 10**9, 2**31 * 10**9),
        frame_id=rng.choice(FRAMES),
        child_frame_id=rng.choice(FRAMES),
        position=numbers(rng, 3),
        orientation=numbers(rng, 4),
        linear=numbers(rng, 3),
        angular=numbers(rng, 3),
        pose_covariance=numbers(rng, 36),
        twist_covariance=numbers(rng, 36),
    )


def header(stamp: int, frame_id: str) -> Any:
    seconds, nanoseconds = divmod(stamp, 10**9)
    time = TYPES["builtin_interfaces/msg/Time"](seconds, nanoseconds)
    return TYPES["std_msgs/msg/Header"](time, frame_id)


def odometry(sample: Sample) -> Any:
    point, vector = TYPES["geometry_msgs/msg/Point"], TYPES["geometry_msgs/msg/Vector3"]
    pose = TYPES["geometry_msgs/msg/Pose"](
        point(*sample.position), TYPES["geometry_msgs/msg/Quaternion"](*sample.orientation)
    )
    twist = TYPES["geometry_msgs/msg/Twist"](vector(*sample.linear), vector(*sample.angular))
    return TYPES[ODOMETRY](
        header(sample.stamp, sample.frame_id),
        sample.child_frame_id,
        TYPES["geometry_msgs/msg/PoseWithCovariance"](pose, np.array(sample.pose_covariance)),
        TYPES["geometry_msgs/msg/TwistWithCovariance"](twist, np.array(sample.twist_covariance)),
    )


def serialize(message: Any, type_name: str, little_endian: bool = True) -> bytes:
    return bytes(TYPESTORE.serialize_cdr(message, type_name, little_endian=little_endian))


def padded(data: bytes) -> bytes:
    """As DDS carries it, in multiples of four bytes."""
    return data + bytes(-len(data) % 4)
