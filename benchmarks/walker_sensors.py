"""Sensor noise on a machine that walks, where a record is a plan or a simulation and has none."""

from __future__ import annotations

from typing import Final

import numpy as np

from impact_predictor.prediction.types import Geometry, Sample
from impact_predictor.prediction.vectors import axes_of, to_world

POSITION: Final = 1e-3
"""Standard deviation of each coordinate of base and feet, in m."""

VELOCITY: Final = 0.02
"""Standard deviation of each part of their velocities, in m/s."""


def noisy(
    sample: Sample, geometry: Geometry, rng: np.random.Generator, *, on_robot: bool = False
) -> tuple[Sample, Geometry]:
    """A sample and the geometry of its stamp, with white noise on all positions and velocities of base and feet.

    The feet are told in the world, as by motion capture, each with the deviations `POSITION` and `VELOCITY` there. Or
    `on_robot`, as by the joints, with these deviations relative to the base, and the base's own on top of them.
    """
    count = len(geometry.points)
    place, speed = (rng.normal(0.0, deviation, (1 + count, 3)) for deviation in (POSITION, VELOCITY))
    feet, rates = place[1:], speed[1:]
    if not on_robot:
        feet = feet - place[0]
        rates = rates - speed[0] - np.cross(sample.angular, feet)
    shift = to_world(axes_of(sample.orientation), tuple(place[0].tolist()))
    return (
        sample._replace(
            position=tuple((np.array(sample.position) + shift).tolist()),
            linear=tuple((np.array(sample.linear) + speed[0]).tolist()),
        ),
        geometry._replace(
            points=tuple(map(tuple, (np.array(geometry.points) + feet).tolist())),
            velocities=tuple(map(tuple, (np.array(geometry.velocities) + rates).tolist())),
        ),
    )
