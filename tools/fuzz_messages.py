"""Messages that were changed, on their way through the predictor of every kind of scene, as the node takes them."""

from __future__ import annotations

import math
import struct
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

from fuzz_choices import Choices
from made_motions import OfSupport, made

from impact_predictor.bags.read import BagMessage
from impact_predictor.bags.run import Run
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import TRANSFORMS, Input, Scene, inputs_of, scenes_of
from impact_predictor.prediction.types import FeetStates, Geometry, Imu, Joints, Sample, Schedule, Transform, Wrench
from impact_predictor.ros import messages as coded
from impact_predictor.ros.cdr import (
    LITTLE_ENDIAN_HEADER,
    MalformedMessage,
    align8,
    decode_diagnostic_array,
    stamp,
    string,
)
from impact_predictor.ros.messages.walker_inputs import encode_feet, encode_joints, encode_schedule, encode_wrench
from impact_predictor.stamps import NANOSECONDS

ROOT: Final = Path(__file__).parents[1]
STICK: Final = """<robot name="r"><link name="base"><inertial><mass value="5"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>{legs}</robot>"""
LEG: Final = """<link name="{0}"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hip_{0}" type="revolute"><origin xyz="{1} 0 0"/><parent link="base"/><child link="{0}"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="{0}_foot"><collision><origin xyz="0 0 0"/><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="ankle_{0}" type="fixed"><origin xyz="0 0 -0.5"/><parent link="{0}"/>
<child link="{0}_foot"/></joint>"""

ENDLESS: Final = ("time_to_tip", "time_to_slide", "energy_to_topple", "margin.")
"""Keys of answers whose value is inf where nothing that is looked for happens."""


class Flaw(AssertionError):
    """The property that is searched against does not hold."""


class Course(NamedTuple):
    """A scene with messages that belong to it: topic and value of each, in order."""

    name: str
    scenes: Mapping[str, Scene]
    topics: Mapping[Input, str]
    messages: tuple[tuple[Input, Any], ...]


@cache
def courses() -> tuple[Course, ...]:
    """One for each scene that is shipped, and for kinds of scenes that are not."""
    shipped: dict[str, dict[str, Any]] = {
        path.stem: dict(read_parameters(path)) for path in sorted((ROOT / "config").glob("*.yaml"))
    }
    crate, cube, walker = shipped["deck_crate"], shipped["cube_tosses"], shipped["walker_hyq"]
    points = tuple(x for a in (-0.05, 0.05) for b in (-0.05, 0.05) for c in (-0.05, 0.05) for x in (a, b, c))
    sure = {"uncertainty.samples": 16, "uncertainty.friction": 0.05, "uncertainty.restitution": 0.05, "margins": True}
    kinds: dict[str, Mapping[str, Any]] = {
        **shipped,
        "imu": crate | {"support.motion": "imu"},
        "watched floor": cube | {"onset.watch": True, "body.contact_points": points},
        "unsure": cube | sure,
        "total law": cube | {"law": "total", "margins": True, "odom.twist_window": 0.02, "support.frame": ""},
        "frames": cube | {"tf.body_frame": "cube", "body.contact_points": points},
        "soles": walker
        | {"feet.names": ("left", "right"), "feet.points": 2, "feet.force": 30.0, "feet.has_schedule": True},
    }
    if robot := robot_of_stick():
        kinds["joints"] = walker | {"feet.names": ("left", "right"), "feet.points": 1, **robot}
    return tuple(made_course(name, values) for name, values in kinds.items())


@cache
def robot_of_stick() -> dict[str, Any]:
    """The parameters of a robot with legs, where Pinocchio is installed."""
    try:
        import pinocchio  # noqa: F401
    except ImportError:
        return {}
    path = Path(tempfile.mkdtemp(prefix="fuzz_")) / "robot.urdf"
    path.write_text(STICK.format(legs=LEG.format("left", 0.2) + LEG.format("right", -0.2)))
    return {"robot.urdf": str(path), "robot.frames": ("left_foot", "right_foot")}


def made_course(name: str, values: Mapping[str, Any]) -> Course:
    """A scene of parameters with the messages of motions that are made up for it."""
    scenes = scenes_of(validate(values))
    inputs = {(one.kind, one.body): one for one in inputs_of(scenes)}
    found: list[tuple[int, Input, Any]] = []
    kinds = {Geometry: "contact_geometry", Joints: "joint_states", Wrench: "contact_wrench", Schedule: "schedule"}
    for body, scene in scenes.items():
        for message in made(scene):
            # Of what is not measured only the support tells.
            if scene.source == "none" and not isinstance(message, OfSupport):
                continue
            value: Any = message
            key: tuple[str, str | None] = (kinds.get(type(message), "odom"), body)
            if isinstance(message, OfSupport):
                value = message.message
                key = ("imu" if isinstance(value, Imu) else "odom"), None
            if isinstance(message, Sample) and scene.source == "imu":
                gravity = tuple(-part for part in scene.gravity)
                value = Imu(message.stamp, message.frame_id, message.orientation, message.angular, gravity)  # type: ignore[arg-type]
                key = "imu", body
            if isinstance(message, Geometry) and scene.walking is not None and len(found) % 2:
                names = tuple([name for name in scene.walking.feet for _ in range(scene.walking.points)])
                value, key = FeetStates(message.stamp, message.frame_id, names, message.points), ("feet_states", body)
            if scene.body_frame and isinstance(value, Sample):
                value = value._replace(child_frame_id="sensor")
                link = Transform(value.stamp, scene.body_frame, "sensor", (0.01, 0.0, 0.0), (0.0, 0.0, 0.6, 0.8))
                found += [(link.stamp, inputs[kind, None], link) for kind in TRANSFORMS[len(found) % 2 :]]
            if key in inputs:
                found.append((value.stamp, inputs[key], value))
    if any(one.body is None for one in inputs.values()) and not any(one.body is None for _, one, _ in found):
        raise Flaw(f"{name} has no messages about its support")
    found.sort(key=lambda one: one[0])
    return Course(name, scenes, {one: f"/{one.name}" for one in inputs.values()}, tuple(one[1:] for one in found))


def encode(value: Any) -> bytes:
    """The bytes of any value that is told; of numbers too large for a message, an Odometry that is none."""
    encoders: dict[type, Any] = {
        Sample: coded.encode_odometry,
        Imu: coded.encode_imu,
        Geometry: coded.encode_polygon,
        FeetStates: encode_feet,
        Joints: encode_joints,
        Wrench: encode_wrench,
        Schedule: encode_schedule,
        Transform: encode_transform,
    }
    try:
        return bytes(encoders[type(value)](value))
    except (OverflowError, struct.error):  # float32 has no such number
        return b"\0\1\0\0"


def encode_transform(one: Transform) -> bytes:
    """A tf2_msgs/TFMessage of a transform."""
    head = LITTLE_ENDIAN_HEADER + b"\1\0\0\0" + stamp(one.stamp) + string(one.frame_id) + string(one.child_frame_id)
    return head.ljust(align8(len(head)), b"\0") + struct.pack("<7d", *one.position, *one.orientation)


def sequence(choices: Choices, course: Course, longest: int = 80) -> list[BagMessage]:
    """Some messages of a course that follow each other, changed here and there."""
    start = choices.below(max(len(course.messages) - longest, 1))
    chosen = list(course.messages[start : start + 8 + choices.below(longest)])
    clock = choices.of((0, 10**9, 1_700_000_000 * 10**9, -(2**31) * 10**9, 2**31 * 10**9 - 10**8))
    often = choices.of((1000, 100, 20, 5))
    changed: list[BagMessage] = []
    for one, value in chosen:
        if choices.once_in(often * 4):
            clock += choices.of((-1, 1)) * choices.of((1, 10**6, 3 * 10**8, 10**9, 10**12, 2**61))
        value = value._replace(stamp=min(max(value.stamp + clock, -(2**31) * 10**9), 2**31 * 10**9 - 1))
        if choices.once_in(often):
            value = _changed(choices, value)
        data = encode(value)
        if choices.once_in(often):
            data = choices.damaged(data)
        topic = choices.of(list(course.topics.values())) if choices.once_in(often * 10) else course.topics[one]
        changed.append(BagMessage(topic, value.stamp, data))
        if choices.once_in(often):
            changed.append(changed[choices.below(len(changed))])
        if choices.once_in(often):
            del changed[choices.below(len(changed))]
        if choices.once_in(often) and len(changed) > 1:
            changed[-1], changed[-2] = changed[-2], changed[-1]
    return changed


def _changed(choices: Choices, value: Any) -> Any:
    """A message with another number, name or list in one of its fields."""
    field = choices.of(value._fields)
    was = getattr(value, field)
    now: Any = was
    if field == "stamp":
        now = max(-(2**63), min(2**31 * 10**9 - 1, was + round(choices.of((-1, 1)) * 10.0 ** choices.below(19))))
    elif isinstance(was, str):
        now = choices.of(("", "world", "cube", "elsewhere", "left", "a" * 300, "\u00e4\u6f22\t\n\x00"))
    elif was is None or not was:
        now = choices.of((was, ((0.0, 0.0, 1.0),) if isinstance(value, FeetStates) else (0.0, 0.0, 0.0, 1.0)))
    elif isinstance(was[0], float):
        now = _numbers(choices, was)
    elif isinstance(was[0], tuple) and isinstance(was[0][0], float):
        points = [*was]
        points[choices.below(len(points))] = _numbers(choices, points[choices.below(len(points))])
        now = choices.of((tuple(points), tuple(points), was[: choices.below(len(was) + 1)], was + was[:1], ()))
    elif isinstance(was[0], int | str) and field != "names":
        now = choices.of((was[::-1], was[:-1], was * 2))
    else:
        now = choices.of((was[::-1], was[:-1], ("other", *was[1:])))
    return value._replace(**{field: now})


def _numbers(choices: Choices, numbers: tuple[float, ...]) -> tuple[float, ...]:
    scale = choices.of((None, None, *[10.0**k for k in (-200, -20, -3, 3, 6, 11, 20, 200)]))
    if scale is not None:
        return tuple(number * scale for number in numbers)
    at = choices.below(len(numbers))
    return (*numbers[:at], choices.number(numbers[at]), *numbers[at + 1 :])


def feed(course: Course, sent: list[BagMessage], markers: bool = True) -> None:
    """Answer messages, and look at every byte of the answers.

    Raises:
        Flaw: a number in an answer is not finite, or an answer is no message.
    """
    written: list[tuple[str, str, bytes]] = []

    def write(topic: str, kind: str, _: int, data: bytes) -> None:
        written.append((topic, kind, data))

    run = Run(course.scenes, course.topics, write, knows_truth=True, markers=markers)
    run.take(sent, None)
    for topic, kind, data in written:
        check_answer(topic, kind, data)
    written.clear()
    if sent:
        run.monitor.silent(sent[-1][1] + 10 * NANOSECONDS)
        run._report(sent[-1][1])
    run.finish()
    for topic, kind, data in written:
        check_answer(topic, kind, data)


def check_answer(topic: str, kind: str, data: bytes) -> None:
    """Read the bytes of an answer again.

    Raises:
        Flaw: a number in it is not finite, or it is no message.
    """
    try:
        if kind == coded.ODOMETRY:
            sample = coded.decode_odometry(data)
            if not all(math.isfinite(number) for field in sample[3:] for number in field):
                raise Flaw(f"{topic} is not finite: {sample}")
            if abs(math.hypot(*sample.orientation) - 1.0) > 1e-3:
                raise Flaw(f"{topic} has the orientation {sample.orientation}")
        elif kind == coded.DIAGNOSTIC_ARRAY:
            for status in decode_diagnostic_array(data):
                for key, text in status.values.items():
                    if not (_is_finite(text) or (text == "inf" and key.startswith(ENDLESS))):
                        raise Flaw(f"{topic} says {key}: {text}")
        elif kind == coded.MARKER_ARRAY:
            _check_markers(topic, data)
    except MalformedMessage as error:
        raise Flaw(f"{topic} is no {kind}: {error}") from error


def _is_finite(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return True


@cache
def _typestore() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _check_markers(topic: str, data: bytes) -> None:
    for marker in _typestore().deserialize_cdr(data, coded.MARKER_ARRAY).markers:
        vectors = [marker.pose.position, marker.scale, *marker.points]
        numbers = [number for one in vectors for number in (one.x, one.y, one.z)]
        turn = marker.pose.orientation
        if not all(map(math.isfinite, (*numbers, turn.x, turn.y, turn.z, turn.w))):
            raise Flaw(f"{topic} has a marker that is not finite: {marker.ns} {marker.id}")


def fuzz_messages(choices: Choices) -> str:
    """One input: a sequence of messages for a scene; what it was about.

    Raises:
        Flaw: the property does not hold.
    """
    course = choices.of(courses())
    feed(course, sequence(choices, course), markers=choices.once_in(4))
    return course.name
