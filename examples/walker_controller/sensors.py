"""What the biped's sensors and state estimation publish: its pose over the ground under its feet, and where they are.

A robot that feels its way knows where it is over the ground on which it stands, so that is the frame `ground` of its
odometry: x along the ground and forwards, z out of it.
"""

from __future__ import annotations

from math import cos, sin
from typing import Final

from machine import Walk

from impact_predictor.prediction.types import Geometry, Sample, Vector3

FEET: Final = ("left", "right")
FRAME: Final = "ground"
BODY: Final = "hub"

_UNKNOWN: Final = (0.0,) * 36


def sample_of(walk: Walk) -> Sample:
    """Pose and twist of the hub, which turns with the leg that stands."""
    leg, lean, pitch = walk.machine.leg, walk.lean, walk.pitch
    position = walk.x, 0.0, walk.foot_z + leg * cos(lean)
    vx, vz = walk.slip + leg * walk.rate * cos(lean), -leg * walk.rate * sin(lean)
    s, c = sin(pitch), cos(pitch)
    return Sample(
        stamp=walk.stamp,
        frame_id=FRAME,
        child_frame_id=BODY,
        position=position,
        orientation=(0.0, sin(0.5 * pitch), 0.0, cos(0.5 * pitch)),
        linear=(c * vx - s * vz, 0.0, s * vx + c * vz),
        angular=(0.0, walk.rate, 0.0),
        pose_covariance=_UNKNOWN,
        twist_covariance=_UNKNOWN,
    )


def geometry_of(walk: Walk) -> Geometry:
    """The left and the right foot in the frame of the hub."""
    stands = foot(walk.machine.leg, walk.lean - walk.pitch)
    swings = foot(walk.length, walk.lean - walk.angle - walk.pitch)
    return Geometry(walk.stamp, BODY, (swings, stands) if walk.steps % 2 else (stands, swings))


def foot(length: float, lean: float) -> Vector3:
    return -length * sin(lean), 0.0, -length * cos(lean)
