"""A trot on level ground with four feet, made up, for measurements and tests: the trunk glides, diagonal feet swing."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor
from typing import Final

from impact_predictor.prediction.types import Geometry, Sample, Schedule, Vector3

SPEED: Final = 0.4
"""Of the trunk, in m/s."""
HEIGHT: Final = 0.58
"""Of the trunk, in m."""
PERIOD: Final = 0.6
"""Seconds of a stride."""
DUTY: Final = 0.6
"""The part of it for which a foot stands."""
LIFT: Final = 0.08
"""How high a foot swings, in m, about."""
FEET: Final = ("LF", "RF", "LH", "RH")
HIPS: Final = ((0.31, 0.29, 0.0), (0.31, -0.29, 0.5), (-0.31, 0.29, 0.5), (-0.31, -0.29, 0.0))
"""x and y of each foot where it is right below its hip, in m, and when it first lands, in periods."""

_LEVEL: Final = (0.0, 0.0, 0.0, 1.0)
_UNKNOWN: Final = (0.0,) * 36


def trot(rate: float, duration: float, begin: int = 0, frame: str = "world") -> Iterator[tuple[Geometry, Sample]]:
    """Feet and trunk at each sample: `rate` in Hz, `duration` in s, `begin` the first stamp in ns.

    Each of the FEET is a point. It lands with 4 LIFT (1 - 0.8) / ((1 - DUTY) PERIOD) = 0.27 m/s.
    """
    for k in range(round(rate * duration)):
        time, stamp = k / rate, begin + round(k / rate * 1e9)
        trunk = (SPEED * time, 0.0, HEIGHT)
        points = tuple(_point(time, trunk, *hip) for hip in HIPS)
        sample = Sample(stamp, frame, "base", trunk, _LEVEL, (SPEED, 0.0, 0.0), (0.0, 0.0, 0.0), _UNKNOWN, _UNKNOWN)
        yield Geometry(stamp, "base", points), sample


def plan(duration: float, begin: int = 0, earlier: float = 0.0) -> Schedule:
    """When the feet stand, each time of it so many s `earlier` than they do; arguments else as of `trot`."""
    strides = {n + hip[2] + part for n in range(-1, ceil(duration / PERIOD)) for hip in HIPS for part in (0.0, DUTY)}
    # Strides that rounding tells apart are one.
    changes = sorted({round(stride * PERIOD, 9) for stride in strides if stride >= 0.0})
    stands = [tuple(_phase(time + 1e-6, hip[2])[1] < DUTY for hip in HIPS) for time in changes]
    times = [begin + round((time - earlier) * 1e9) for time in changes]
    return Schedule(begin, FEET, tuple(times), tuple(stands))


def _phase(time: float, landing: float) -> tuple[int, float]:
    """The number of the stride of a foot that first lands at `landing`, in periods, and the part of it that is over."""
    stride = time / PERIOD - landing
    number = floor(stride)
    return number, stride - number


def _point(time: float, trunk: Vector3, x: float, y: float, landing: float) -> Vector3:
    """A foot seen from the trunk: it stands, or it swings to where it will be below its hip halfway through stance."""
    number, phase = _phase(time, landing)
    place = x + SPEED * PERIOD * (landing + number + 0.5 * DUTY)
    height = 0.0
    if phase > DUTY:
        s = (phase - DUTY) / (1.0 - DUTY)
        place += SPEED * PERIOD * s * s * (3.0 - 2.0 * s)
        height = 4.0 * LIFT * s * (1.0 - s) * (1.0 - 0.8 * s)
    return place - trunk[0], y, height - trunk[2]
