"""The recorded tosses as a sensor in other frames tells of them, connected by /tf and /tf_static."""

from __future__ import annotations

from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np
from recordings import TYPESTORE, WANTED, write_bag

from impact_predictor.bags.read import BagMessage
from impact_predictor.prediction.vectors import axes_of, composed
from impact_predictor.ros.messages import decode_odometry, decode_polygon, encode_odometry, encode_polygon

TF = "tf2_msgs/msg/TFMessage"
MAP, MAP_TURN = np.array((1.0, -2.0, 0.5)), (0.0, 0.0, sin(0.4), cos(0.4))
"""The world of the scene, as seen from the frame in which the odometry is told."""
DRIFT, SPIN = np.array((1e-3, 0.0, -2e-3)), np.array((0.0, 0.01, 0.0))
"""How the sensor creeps along the axes of the cube, in m/s and rad/s."""


def arm_at(time: float) -> tuple[Any, Any]:
    """Place and orientation of the sensor on the cube, on which it creeps."""
    turn = (0.0, sin(0.5 * SPIN[1] * time), 0.0, cos(0.5 * SPIN[1] * time))
    return np.array((0.03, -0.01, 0.02)) + DRIFT * time, turn


def matrix(orientation: Any) -> Any:
    return np.array(axes_of(orientation)).T


def transforms(stamp: int, *links: tuple[str, str, Any, Any]) -> bytes:
    """A tf2_msgs/TFMessage of links: parent, child, place and orientation of each."""
    types, (seconds, rest) = TYPESTORE.types, divmod(stamp, 10**9)
    stamped = [
        types["geometry_msgs/msg/TransformStamped"](
            types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](seconds, rest), parent),
            child,
            types["geometry_msgs/msg/Transform"](
                types["geometry_msgs/msg/Vector3"](*map(float, place)), types["geometry_msgs/msg/Quaternion"](*turn)
            ),
        )
        for parent, child, place, turn in links
    ]
    return bytes(TYPESTORE.serialize_cdr(types[TF](stamped), TF))


def told_elsewhere(message: BagMessage, creeps: bool) -> list[BagMessage]:
    """A message of the record as another sensor tells it, after the transform of the sensor where that moves."""
    if message.topic != "/cube/odom":
        # In axes of a leg that is a quarter turn from the cube's.
        polygon = decode_polygon(message.data)
        points = tuple((y, -x, z) for x, y, z in polygon.points)
        return [message._replace(data=encode_polygon(polygon._replace(frame_id="leg", points=points)))]
    sample = decode_odometry(message.data)
    time = (sample.stamp - 10**9) / 1e9 if creeps else 0.0
    arm, turn = arm_at(time)
    drift, spin = (DRIFT, SPIN) if creeps else (0.0 * DRIFT, 0.0 * SPIN)
    cube, own = matrix(sample.orientation), matrix(turn)
    angular = np.array(sample.angular)
    place = np.array(sample.position) + cube @ arm
    sensed = sample._replace(
        frame_id="map",
        child_frame_id="imu",
        position=tuple(MAP + matrix(MAP_TURN) @ place),
        orientation=composed(MAP_TURN, composed(sample.orientation, turn)),
        linear=tuple(own.T @ (np.array(sample.linear) + np.cross(angular, arm) + drift)),
        angular=tuple(own.T @ (angular + spin)),
    )
    told = [message._replace(data=encode_odometry(sensed))]
    if creeps:
        # With one pose alone, as after a pause, nobody knows how the sensor moves.
        moved = [transforms(sample.stamp - ago, ("cube", "imu", *arm_at(time - 1e-9 * ago))) for ago in (10**6, 0)]
        told = [*[BagMessage("/tf", message.log_time, data) for data in moved], *told]
    return told


def bag_of(path: Path, messages: list[BagMessage], creeps: bool) -> Path:
    """A bag of messages of the record as the sensor tells them, with the transforms."""
    quarter = (0.0, 0.0, 0.5**0.5, 0.5**0.5)
    links = [("map", "world", MAP, MAP_TURN), ("cube", "leg", (0.0, 0.0, 0.0), quarter)]
    if not creeps:
        links.append(("cube", "imu", *arm_at(0.0)))
    static = BagMessage("/tf_static", messages[0].log_time, transforms(0, *links))
    told = [static, *[each for one in messages for each in told_elsewhere(one, creeps)]]
    return write_bag(path, told, {**WANTED, "/tf": TF, "/tf_static": TF})
