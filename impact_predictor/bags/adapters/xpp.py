"""xpp_msgs/RobotStateCartesian: the plan of a legged robot in bags of xpp and TOWR (github.com/leggedrobotics).

| field | becomes |
| --- | --- |
| `time_from_start` | the stamp: the message has no header |
| `base.pose` | pose of the body in the world |
| `base.twist`, both parts along the axes of the world | twist, along the axes of the body |
| `ee_motion[].pos`, `.vel`, in the world | contact points and their velocities, seen from the body |
| `ee_contact[]`, the plan's own flags | the truth: whether each foot stands |

The accelerations and the forces of the plan are not read: no sensor of a robot would tell them.
"""

from __future__ import annotations

from typing import Any

from ...prediction.types import Vector3
from .adapted import Adapted, of_world


def adapt(message: Any) -> Adapted:
    """A message of xpp_msgs/RobotStateCartesian as sample and geometry, and as truth which feet stand."""
    pose, twist = message.base.pose, message.base.twist
    turn = pose.orientation
    sample, geometry = of_world(
        message.time_from_start.sec * 10**9 + message.time_from_start.nanosec,
        _vector(pose.position),
        (turn.x, turn.y, turn.z, turn.w),
        _vector(twist.linear),
        _vector(twist.angular),
        [_vector(foot.pos) for foot in message.ee_motion],
        [_vector(foot.vel) for foot in message.ee_motion],
    )
    return Adapted(sample, geometry, stands=tuple(map(bool, message.ee_contact)))


def _vector(message: Any) -> Vector3:
    return message.x, message.y, message.z
