"""The bytes of what a walking machine is told, against rosbags and rclpy; numbers must come through exactly."""

import random
import struct
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from impact_predictor.prediction.types import Joints, Schedule, Wrench
from impact_predictor.ros.messages import (
    MalformedMessage,
    decode_joints,
    decode_schedule,
    decode_wrench,
    encode_joints,
    encode_schedule,
    encode_wrench,
)
from impact_predictor.ros.messages.inputs import JOINT_STATE, JOINT_TRAJECTORY, WRENCH

TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
TYPES = TYPESTORE.types
ENDIAN = pytest.mark.parametrize("little_endian", [True, False], ids=["little", "big"])
# Lengths of 0 to 8 bytes meet every alignment of what follows a string.
NAMES = ("", "a", "ab", "abc", "LF_H", "jointé", "base/x1", "KFE_left")


def header(stamp: int, frame_id: str) -> Any:
    return TYPES["std_msgs/msg/Header"](TYPES["builtin_interfaces/msg/Time"](*divmod(stamp, 10**9)), frame_id)


def serialize(message: Any, type_name: str, little_endian: bool = True) -> bytes:
    return bytes(TYPESTORE.serialize_cdr(message, type_name, little_endian=little_endian))


def numbers(rng: random.Random, count: int) -> tuple[float, ...]:
    return tuple(rng.choice((rng.gauss(0.0, 2.0), -0.0, float("inf"))) for _ in range(count))


def random_stamp(rng: random.Random) -> int:
    return rng.randrange(2**31 * 10**9)


@ENDIAN
def test_joints_are_what_is_in_a_joint_state_both_ways(little_endian: bool) -> None:
    rng = random.Random(1)
    for count in (0, 1, 2, 3, 12) * 20:
        names = [rng.choice(NAMES) for _ in range(count)]
        # A source may leave out velocities or efforts, by the definition of the message.
        positions, velocities, efforts = (numbers(rng, rng.choice((0, count))) for _ in range(3))
        joints = Joints(random_stamp(rng), tuple(names), positions, velocities)
        fields = [np.array(field) for field in (positions, velocities, efforts)]
        message = TYPES[JOINT_STATE](header(joints.stamp, rng.choice(NAMES)), names, *fields)
        assert decode_joints(serialize(message, JOINT_STATE, little_endian)) == joints
        message = TYPES[JOINT_STATE](header(joints.stamp, ""), names, *fields[:2], np.array([]))
        assert encode_joints(joints) == serialize(message, JOINT_STATE)


@ENDIAN
def test_the_force_of_a_foot_is_what_is_in_a_wrench_both_ways(little_endian: bool) -> None:
    rng = random.Random(2)
    vector = TYPES["geometry_msgs/msg/Vector3"]
    for name in NAMES:
        x, y, z, *torque = numbers(rng, 6)
        wrench = Wrench(random_stamp(rng), name, (x, y, z))

        def message(torque: list[float], wrench: Wrench = wrench) -> Any:
            both = TYPES["geometry_msgs/msg/Wrench"](vector(*wrench.force), vector(*torque))
            return TYPES[WRENCH](header(wrench.stamp, wrench.frame_id), both)

        assert decode_wrench(serialize(message(torque), WRENCH, little_endian)) == wrench
        assert encode_wrench(wrench) == serialize(message([0.0] * 3), WRENCH)


@ENDIAN
def test_a_plan_is_what_is_in_a_joint_trajectory_both_ways(little_endian: bool) -> None:
    rng = random.Random(3)
    point, duration = TYPES["trajectory_msgs/msg/JointTrajectoryPoint"], TYPES["builtin_interfaces/msg/Duration"]
    for count in (0, 1, 2, 7) * 20:
        feet = tuple(rng.sample(NAMES, rng.choice((0, 1, 4))))
        stamp = rng.randrange(2**30 * 10**9)
        times = tuple(sorted(stamp + rng.randrange(-(10**9), 10**11) for _ in range(count)))
        stands = tuple(tuple(rng.random() < 0.5 for _ in feet) for _ in times)
        schedule = Schedule(stamp, feet, times, stands)

        def message(others: int, schedule: Schedule = schedule) -> Any:
            rest = [np.array(numbers(rng, others))] * 3
            points = [
                point(np.array([float(one) for one in now]), *rest, duration(*divmod(time - schedule.stamp, 10**9)))
                for time, now in zip(schedule.times, schedule.stands, strict=True)
            ]
            return TYPES[JOINT_TRAJECTORY](header(schedule.stamp, ""), list(schedule.feet), points)

        for others in (0, 1, 4):
            data = serialize(message(others), JOINT_TRAJECTORY, little_endian)
            assert decode_schedule(data) == schedule
        assert encode_schedule(schedule) == serialize(message(0), JOINT_TRAJECTORY)


DECODERS = {decode_joints: Joints, decode_wrench: Wrench, decode_schedule: Schedule}
VALID = {
    decode_joints: encode_joints(Joints(1, ("hip", "knee"), (0.1, 0.2), (0.3, 0.4))),
    decode_wrench: encode_wrench(Wrench(1, "LF", (0.0, 0.0, 200.0))),
    decode_schedule: encode_schedule(Schedule(1, ("LF", "RF"), (1, 10**9), ((True, False), (False, True)))),
}


@pytest.mark.parametrize("decode", DECODERS)
def test_what_is_cut_off_or_too_long_or_another_message_is_malformed(decode: Any) -> None:
    data = VALID[decode]
    others = [other for other in VALID.values() if other is not data]
    for bad in (*(data[:size] for size in range(len(data))), data + bytes(100), b"\0\3" + data[2:], *others):
        with pytest.raises(MalformedMessage):
            decode(bad)


@pytest.mark.parametrize("count", [3, 2**20, 2**29, 2**32 - 1])
def test_a_wrong_count_is_malformed_at_once_however_large(count: int) -> None:
    for decode, place in ((decode_joints, 20), (decode_schedule, 20), (decode_schedule, 40)):
        data = bytearray(VALID[decode])
        assert struct.unpack_from("<I", data, place) == (2,)
        struct.pack_into("<I", data, place, count)
        with pytest.raises(MalformedMessage):
            decode(bytes(data))


@given(st.binary(max_size=300))
def test_any_bytes_are_a_message_or_malformed(data: bytes) -> None:
    for decode, kind in DECODERS.items():
        for head in (b"", b"\0\1\0\0", b"\0\0\0\0"):
            with suppress(MalformedMessage):
                assert isinstance(decode(head + data), kind)


@given(
    st.sampled_from(list(DECODERS)),
    st.lists(st.tuples(st.integers(0, 1000), st.integers(0, 255)), max_size=4),
    st.integers(0, 1000),
)
def test_any_damage_to_a_message_leaves_a_message_or_malformed(
    decode: Any, changes: list[tuple[int, int]], cut: int
) -> None:
    damaged = bytearray(VALID[decode])
    for place, value in changes:
        damaged[place % len(damaged)] = value
    for data in (bytes(damaged), bytes(damaged[: -cut % len(damaged)])):
        with suppress(MalformedMessage):
            assert isinstance(decode(data), DECODERS[decode])


def test_rclpy_reads_what_is_written_and_writes_what_is_read() -> None:
    serialization = pytest.importorskip("rclpy.serialization", reason="ROS is not installed: rclpy is not compared")
    from geometry_msgs.msg import WrenchStamped
    from sensor_msgs.msg import JointState
    from trajectory_msgs.msg import JointTrajectory

    classes: dict[Any, Any] = {
        decode_joints: JointState,
        decode_wrench: WrenchStamped,
        decode_schedule: JointTrajectory,
    }
    for decode, data in VALID.items():
        message = serialization.deserialize_message(data, classes[decode])
        assert decode(serialization.serialize_message(message)) == decode(data)
    joints = serialization.deserialize_message(VALID[decode_joints], JointState)
    assert (list(joints.name), list(joints.position)) == (["hip", "knee"], [0.1, 0.2])
    empty = JointState(name=["hip"], position=[0.5])
    assert decode_joints(serialization.serialize_message(empty)) == Joints(0, ("hip",), (0.5,), ())
    plan = serialization.deserialize_message(VALID[decode_schedule], JointTrajectory)
    assert [list(point.positions) for point in plan.points] == [[1.0, 0.0], [0.0, 1.0]]
