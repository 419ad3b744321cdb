"""The bytes of inputs against two other implementations: rosbags, and rclpy where ROS is installed.

Samples are random with a fixed seed; numbers must come through exactly, since nothing is computed on the way.
"""

from __future__ import annotations

import random
import struct
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from messages_of_rosbags import FRAMES, TYPES, TYPESTORE, header, numbers, odometry, random_sample, serialize

from impact_predictor.prediction.types import FeetStates, Geometry, Imu, Joints, Schedule, Transform, Wrench
from impact_predictor.ros.messages import (
    IMU,
    JOINT_STATE,
    JOINT_TRAJECTORY,
    MULTI_DOF_JOINT_STATE,
    ODOMETRY,
    POLYGON,
    WRENCH,
    MalformedMessage,
    decode_diagnostic_array,
    decode_feet,
    decode_imu,
    decode_joints,
    decode_odometry,
    decode_polygon,
    decode_schedule,
    decode_transforms,
    decode_wrench,
    encode_imu,
    encode_odometry,
    encode_polygon,
)
from impact_predictor.ros.messages.inputs import TF_MESSAGE
from impact_predictor.ros.messages.walker_inputs import encode_feet, encode_joints, encode_schedule, encode_wrench

ENDIAN = pytest.mark.parametrize("little_endian", [True, False], ids=["little", "big"])


@ENDIAN
def test_a_sample_is_what_is_in_an_odometry_both_ways(little_endian: bool) -> None:
    rng = random.Random(2)
    for _ in range(300):
        sample = random_sample(rng)
        assert decode_odometry(serialize(odometry(sample), ODOMETRY, little_endian)) == sample
        assert encode_odometry(sample) == serialize(odometry(sample), ODOMETRY)


@ENDIAN
def test_geometry_is_what_is_in_a_polygon_both_ways(little_endian: bool) -> None:
    rng = random.Random(3)
    for count in [0, 1, 2, 8, 100]:
        # Point32 holds float32, so the numbers must be some.
        points = tuple(tuple(float(np.float32(rng.gauss(0.0, 1.0))) for _ in range(3)) for _ in range(count))
        geometry = Geometry(rng.randrange(2**31 * 10**9), rng.choice(FRAMES), points)  # type: ignore[arg-type]
        polygon = TYPES["geometry_msgs/msg/Polygon"]([TYPES["geometry_msgs/msg/Point32"](*point) for point in points])
        message = TYPES[POLYGON](header(geometry.stamp, geometry.frame_id), polygon)
        assert decode_polygon(serialize(message, POLYGON, little_endian)) == geometry
        assert encode_polygon(geometry) == serialize(message, POLYGON)


def imu_message(imu: Imu, rng: random.Random) -> Any:
    vector = TYPES["geometry_msgs/msg/Vector3"]
    known = np.array([rng.random() for _ in range(9)])
    return TYPES[IMU](
        header(imu.stamp, imu.frame_id),
        TYPES["geometry_msgs/msg/Quaternion"](*(imu.orientation or (0.0, 0.0, 0.0, 0.0))),
        known if imu.orientation else np.array([-1.0, *known[1:]]),
        vector(*imu.angular),
        known,
        vector(*imu.specific_force),
        known,
    )


@ENDIAN
def test_a_measurement_is_what_is_in_an_imu_both_ways(little_endian: bool) -> None:
    rng = random.Random(3)
    for _ in range(200):
        sample = random_sample(rng)
        orientation = sample.orientation if rng.random() < 0.5 else None
        imu = Imu(sample.stamp, sample.frame_id, orientation, sample.linear, sample.angular)
        assert decode_imu(serialize(imu_message(imu, rng), IMU, little_endian)) == imu
        assert decode_imu(encode_imu(imu)) == imu
        read = TYPESTORE.deserialize_cdr(encode_imu(imu), IMU)
        assert (read.orientation_covariance[0] == -1.0) == (orientation is None)
        assert serialize(read, IMU) == encode_imu(imu)


@ENDIAN
def test_joints_are_what_is_in_a_joint_state_both_ways(little_endian: bool) -> None:
    rng = random.Random(1)
    for count in (0, 1, 2, 3, 12) * 20:
        names = [rng.choice(FRAMES) for _ in range(count)]
        # A source may leave out velocities or efforts, by the definition of the message.
        positions, velocities, efforts = (numbers(rng, rng.choice((0, count))) for _ in range(3))
        joints = Joints(rng.randrange(2**31 * 10**9), tuple(names), positions, velocities, efforts)
        fields = [np.array(field) for field in (positions, velocities, efforts)]
        message = TYPES[JOINT_STATE](header(joints.stamp, rng.choice(FRAMES)), names, *fields)
        assert decode_joints(serialize(message, JOINT_STATE, little_endian)) == joints
        message = TYPES[JOINT_STATE](header(joints.stamp, ""), names, *fields)
        assert encode_joints(joints) == serialize(message, JOINT_STATE)


@ENDIAN
def test_feet_by_their_names_are_what_is_in_a_multi_dof_joint_state_both_ways(little_endian: bool) -> None:
    rng = random.Random(2)
    vector, turn = TYPES["geometry_msgs/msg/Vector3"], TYPES["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    for count in (0, 1, 2, 4) * 20:
        names = [rng.choice(FRAMES) for _ in range(count)]
        # Velocities and forces may be left out.
        vectors = [tuple([numbers(rng, 3) for _ in range(size)]) for size in (count, *rng.choices((0, count), k=2))]
        feet = FeetStates(rng.randrange(2**31 * 10**9), rng.choice(FRAMES), tuple(names), *vectors)
        transforms = [TYPES["geometry_msgs/msg/Transform"](vector(*one), turn) for one in vectors[0]]
        nothing = vector(0.0, 0.0, 0.0)
        twists = [TYPES["geometry_msgs/msg/Twist"](vector(*one), nothing) for one in vectors[1]]
        wrenches = [TYPES["geometry_msgs/msg/Wrench"](vector(*one), nothing) for one in vectors[2]]
        message = TYPES[MULTI_DOF_JOINT_STATE](header(feet.stamp, feet.frame_id), names, transforms, twists, wrenches)
        assert decode_feet(serialize(message, MULTI_DOF_JOINT_STATE, little_endian)) == feet
        assert encode_feet(feet) == serialize(message, MULTI_DOF_JOINT_STATE)


@ENDIAN
def test_transforms_are_what_is_in_a_tf_message(little_endian: bool) -> None:
    rng = random.Random(12)
    vector, quaternion = TYPES["geometry_msgs/msg/Vector3"], TYPES["geometry_msgs/msg/Quaternion"]
    for count in (0, 1, 2, 30):
        told = [random_sample(rng) for _ in range(count)]
        stamped = [
            TYPES["geometry_msgs/msg/TransformStamped"](
                header(one.stamp, one.frame_id),
                one.child_frame_id,
                TYPES["geometry_msgs/msg/Transform"](vector(*one.position), quaternion(*one.orientation)),
            )
            for one in told
        ]
        found = decode_transforms(serialize(TYPES[TF_MESSAGE](stamped), TF_MESSAGE, little_endian))
        assert found == tuple([Transform(*one[:5]) for one in told])


@ENDIAN
def test_the_force_of_a_foot_is_what_is_in_a_wrench_both_ways(little_endian: bool) -> None:
    rng = random.Random(2)
    vector = TYPES["geometry_msgs/msg/Vector3"]
    for name in FRAMES:
        x, y, z, *torque = numbers(rng, 6)
        wrench = Wrench(rng.randrange(2**31 * 10**9), name, (x, y, z))

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
        feet = tuple(rng.sample(FRAMES, rng.choice((0, 1, 4))))
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


def test_bytes_that_a_middleware_pads_to_four_are_read() -> None:
    sample = random_sample(random.Random(4))
    data = serialize(odometry(sample), ODOMETRY)
    assert decode_odometry(data + bytes(3)) == sample


def test_an_empty_string_without_its_nul_is_read() -> None:
    data = struct.pack("<4siIIIxxxx85d", b"\0\1\0\0", 1, 2, 0, 0, *range(85))
    sample = decode_odometry(data[:20] + data[24:])
    assert (sample.frame_id, sample.child_frame_id, sample.position) == ("", "", (0.0, 1.0, 2.0))


VALID: dict[Any, bytes] = {
    decode_odometry: encode_odometry(
        random_sample(random.Random(5))._replace(stamp=1, frame_id="odom", child_frame_id="cube")
    ),
    decode_imu: encode_imu(Imu(1, "imu", (0.0, 0.0, 0.0, 1.0), (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))),
    decode_polygon: encode_polygon(Geometry(1, "cube", ((1.0, 2.0, 3.0), (0.5, -1.0, 0.0)))),
    decode_feet: encode_feet(FeetStates(1, "base", ("LF", "RF"), ((0.1, 0.2, 0.3),) * 2, (), ((0.0, 0.0, 9.0),) * 2)),
    decode_joints: encode_joints(Joints(1, ("hip", "knee"), (0.1, 0.2), (0.3, 0.4))),
    decode_wrench: encode_wrench(Wrench(1, "LF", (0.0, 0.0, 200.0))),
    decode_schedule: encode_schedule(Schedule(1, ("LF", "RF"), (1, 10**9), ((True, False), (False, True)))),
}
A_SAMPLE = VALID[decode_odometry]


@pytest.mark.parametrize("decode", VALID)
def test_what_is_cut_off_or_too_long_or_another_message_is_malformed(decode: Any) -> None:
    data = VALID[decode]
    others = [other for other in VALID.values() if other is not data]
    for bad in (*(data[:size] for size in range(len(data))), data + bytes(100), b"\0\3" + data[2:], *others):
        with pytest.raises(MalformedMessage):
            decode(bad)


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"\0\7" + A_SAMPLE[2:], "XCDR2"),
        (b"\1\0" + A_SAMPLE[2:], "no encapsulation"),
        (A_SAMPLE[:12] + b"\xff\xff\xff\xff" + A_SAMPLE[16:], "a string of 4 GB"),
        (A_SAMPLE[:12] + b"\xe0\2\0\0" + A_SAMPLE[16:], "a string beyond the end"),
        (A_SAMPLE[:20] + b"!" + A_SAMPLE[21:], "a string without NUL"),
        (A_SAMPLE[:16] + b"\xff" + A_SAMPLE[17:], "a string that is not UTF-8"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_bytes_that_are_no_odometry_are_malformed(data: bytes, why: str) -> None:
    with pytest.raises(MalformedMessage):
        decode_odometry(data)


@pytest.mark.parametrize("count", [3, 2**20, 2**29, 2**32 - 1])
def test_a_wrong_count_is_malformed_at_once_however_large(count: int) -> None:
    places = (decode_polygon, 24), (decode_feet, 24), (decode_joints, 20), (decode_schedule, 20), (decode_schedule, 40)
    for decode, place in places:
        data = bytearray(VALID[decode])
        assert struct.unpack_from("<I", data, place) == (2,)
        struct.pack_into("<I", data, place, count)
        with pytest.raises(MalformedMessage):
            decode(bytes(data))


def check_all_decoders(data: bytes) -> None:
    for decode in (*VALID, decode_diagnostic_array):
        with suppress(MalformedMessage):
            decode(data)


@given(st.binary(max_size=900))
def test_any_bytes_are_a_message_or_malformed(data: bytes) -> None:
    for head in (b"", b"\0\1\0\0", b"\0\0\0\0"):
        check_all_decoders(head + data)


@given(
    st.sampled_from([*VALID.values()]),
    st.lists(st.tuples(st.integers(0, 1000), st.integers(0, 255)), max_size=4),
    st.integers(0, 1000),
)
def test_any_damage_to_a_message_leaves_a_message_or_malformed(
    data: bytes, changes: list[tuple[int, int]], cut: int
) -> None:
    damaged = bytearray(data)
    for place, value in changes:
        damaged[place % len(damaged)] = value
    check_all_decoders(bytes(damaged))
    check_all_decoders(bytes(damaged[: -cut % len(damaged)]))


def test_rclpy_reads_what_is_written_and_writes_what_is_read() -> None:
    serialization = pytest.importorskip("rclpy.serialization", reason="ROS is not installed: rclpy is not compared")
    from geometry_msgs.msg import PolygonStamped, WrenchStamped
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Imu as ImuMessage
    from sensor_msgs.msg import JointState, MultiDOFJointState
    from trajectory_msgs.msg import JointTrajectory

    classes = (Odometry, ImuMessage, PolygonStamped, MultiDOFJointState, JointState, WrenchStamped, JointTrajectory)
    for (decode, data), kind in zip(VALID.items(), classes, strict=True):
        message = serialization.deserialize_message(data, kind)
        assert decode(serialization.serialize_message(message)) == decode(data)
    joints = serialization.deserialize_message(VALID[decode_joints], JointState)
    assert (list(joints.name), list(joints.position)) == (["hip", "knee"], [0.1, 0.2])
    empty = JointState(name=["hip"], position=[0.5])
    assert decode_joints(serialization.serialize_message(empty)) == Joints(0, ("hip",), (0.5,), ())
    plan = serialization.deserialize_message(VALID[decode_schedule], JointTrajectory)
    assert [list(point.positions) for point in plan.points] == [[1.0, 0.0], [0.0, 1.0]]
