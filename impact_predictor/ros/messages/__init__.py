"""Messages of ROS 2 as bytes, both ways: samples and geometry in, predictions, scores and reports out.

The node takes and publishes these bytes as they are and a bag holds them as they are, so both give the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..cdr import Diagnostic, MalformedMessage, decode_diagnostic_array
from .inputs import (
    IMU,
    JOINT_STATE,
    JOINT_TRAJECTORY,
    ODOMETRY,
    POLYGON,
    WRENCH,
    decode_odometry,
    decode_polygon,
    encode_odometry,
    encode_polygon,
)
from .outputs import (
    DIAGNOSTIC_ARRAY,
    MARKER_ARRAY,
    OUTPUTS,
    UINT8,
    Output,
    encode_mode,
    encode_post_impact,
    encode_prediction,
    encode_score,
)

if TYPE_CHECKING:
    from .imu import decode_imu, encode_imu
    from .reports import encode_reports
    from .walking import decode_joints, decode_schedule, decode_wrench, encode_joints, encode_schedule, encode_wrench

__all__ = [
    "DIAGNOSTIC_ARRAY",
    "IMU",
    "JOINT_STATE",
    "JOINT_TRAJECTORY",
    "MARKER_ARRAY",
    "ODOMETRY",
    "OUTPUTS",
    "POLYGON",
    "UINT8",
    "WRENCH",
    "Diagnostic",
    "MalformedMessage",
    "Output",
    "decode_diagnostic_array",
    "decode_imu",
    "decode_joints",
    "decode_odometry",
    "decode_polygon",
    "decode_schedule",
    "decode_wrench",
    "encode_imu",
    "encode_joints",
    "encode_mode",
    "encode_odometry",
    "encode_polygon",
    "encode_post_impact",
    "encode_prediction",
    "encode_reports",
    "encode_schedule",
    "encode_score",
    "encode_wrench",
]

LATER = {
    **dict.fromkeys(("decode_imu", "encode_imu"), "imu"),
    **dict.fromkeys(("decode_joints", "decode_wrench", "decode_schedule"), "walking"),
    **dict.fromkeys(("encode_joints", "encode_wrench", "encode_schedule"), "walking"),
    "encode_reports": "reports",
}
"""Names that are loaded when they are asked for, and their modules: not every scene has them."""


def __getattr__(name: str) -> object:
    if name not in LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{LATER[name]}"), name)
