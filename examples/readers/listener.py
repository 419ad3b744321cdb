"""Prints the touchdowns that the predictor announces, as `listener.cpp` does: python listener.py [topic]."""

from __future__ import annotations

import sys
from contextlib import suppress
from math import hypot

import rclpy
from rclpy.executors import ExternalShutdownException

from impact_predictor_msgs.msg import Contact, Prediction


def said(told: Prediction) -> str:
    """What a controller would do with a prediction."""
    if told.mode == Prediction.MODE_NO_IMPACT:
        return ""
    stamp, after = told.header.stamp, told.after.linear
    text = (
        f"{told.body} {stamp.sec}.{stamp.nanosec:09d} {told.lead_time:.6f} s ahead, mode {told.mode}, "
        f"after {after.x:.4f} {after.y:.4f} {after.z:.4f} m/s, flags {told.flags}"
    )
    for contact in told.contacts:
        does = "leaves" if contact.state == Contact.STATE_LEAVES else "stays"
        impulse, place = contact.impulse, contact.position
        text += f"; point {contact.point} {does}, {hypot(impulse.x, impulse.y, impulse.z):.4f} N s"
        text += f" at {place.x:.4f} {place.y:.4f} {place.z:.4f}"
    return text + "".join([f"; {foot.name} {'stands' if foot.stands else 'swings'}" for foot in told.feet])


def show(told: Prediction) -> None:
    text = said(told)
    if text:
        print(text, flush=True)


def main() -> None:
    topic = sys.argv[1] if len(sys.argv) > 1 else "/impact_predictor/prediction"
    rclpy.init()
    node = rclpy.create_node("listener_py")
    node.create_subscription(Prediction, topic, show, 1000)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main()
