"""Who tells when feet land: the plan, gap over speed, or the predictor."""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import Final

import numpy as np
from controller import TICK, Array, Landing, Measured

from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Geometry, Sample

SCENE: Final = Path(__file__).resolve().parents[2] / "config/walker.yaml"


class Plan:
    """The plan, with the contact sensors or without them."""

    def __init__(self, senses: bool) -> None:
        self.senses = senses

    def tell(self, measured: Measured, planned: Landing) -> list[Landing | None]:
        return [planned] * 4


class GapOverSpeed:
    """The gap over the mean speed of the last 10 ms, above the level of the feet that the sensors feel."""

    senses = True

    def __init__(self) -> None:
        self._past: deque[Array] = deque(maxlen=5)
        self._level = 0.0

    def tell(self, measured: Measured, planned: Landing) -> list[Landing | None]:
        arms = measured.feet @ measured.axes.T
        heights = measured.position[2] + arms[:, 2]
        moves = measured.feet_velocity @ measured.axes.T + np.cross(measured.spin, arms)
        self._past.append(-measured.velocity[2] - moves[:, 2])
        if any(measured.felt):
            self._level += 0.05 * (float(np.mean(heights[list(measured.felt)])) - self._level)
        gaps, speeds = (heights - self._level).tolist(), np.mean(self._past, axis=0).tolist()
        return [Landing(gap / v, gap, v) if v > 0.05 else None for gap, v in zip(gaps, speeds, strict=True)]


class Predicted:
    """What the predictor tells of each foot."""

    senses = True

    def __init__(self) -> None:
        self._predictor = Predictor(Scene.from_parameters(read_values(SCENE)))

    def tell(self, measured: Measured, planned: Landing) -> list[Landing | None]:
        self._predictor.tell(geometry_of(measured))
        feet = self._predictor.update(sample_of(measured)).feet
        told = [None if foot.lead_time is None else Landing(foot.lead_time, foot.gap, foot.approach) for foot in feet]
        return told or [None] * 4


def sample_of(measured: Measured) -> Sample:
    """What odometry publishes."""
    axes = measured.axes
    w = 0.5 * np.sqrt(1.0 + np.trace(axes))
    turns = np.array([axes[2, 1] - axes[1, 2], axes[0, 2] - axes[2, 0], axes[1, 0] - axes[0, 1], 4.0 * w * w])
    x, y, z, w = (turns / np.linalg.norm(turns)).tolist()
    return Sample(
        stamp=round(measured.tick * TICK * 1e9),
        frame_id="world",
        child_frame_id="base_link",
        position=tuple(measured.position.tolist()),
        orientation=(x, y, z, w),
        linear=tuple((measured.velocity @ axes).tolist()),
        angular=tuple((measured.spin @ axes).tolist()),
        pose_covariance=(0.0,) * 36,
        twist_covariance=(0.0,) * 36,
    )


def geometry_of(measured: Measured) -> Geometry:
    """The lowest points of the feet, and their velocities, as the joints' encoders tell them."""
    points, velocities = (tuple(map(tuple, each.tolist())) for each in (measured.feet, measured.feet_velocity))
    return Geometry(round(measured.tick * TICK * 1e9), "base_link", points, velocities)
