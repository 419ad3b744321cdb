"""The motion of a point in the air: a Kalman filter of it whose jerk is a random walk.

Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation (2001), section 6.2, one order
higher: a foot that is driven to the ground is nearly a cubic of time, though never for long.
"""

from __future__ import annotations

from math import sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..types import Vector3
from .cubic import Cubic, GapNoise, PointFrame, Triangle

FIRST = (1.0, 1e4, 1e8)  # variances of speed, acceleration and jerk (SI) of a point of which one frame is known
SNAP: Final = 1e5  # power density in (m/s^3)^2/s of how the jerk of a foot changes, until its motion shows it ...
LEAST_SNAP, MOST_SNAP = 1e3, 3e8
TURN: Final = 2.5e5  # variance of how the jerk changes at the highest place
ADAPTS: Final = 0.08  # ... by this part with each measurement
OUTLIER: Final = 3.0  # a point moves otherwise than before when a measurement is off by so many standard deviations
LASTS: Final = 2520.0  # a cubic is followed until it is off by the root of a tenth of so many variances of a gap

FilterRows = tuple[Cubic, Cubic, Cubic, Cubic]
"""Value, rate, acceleration and jerk of a gap, and of each coordinate."""


class PointFilter:
    """The gap of a point and its place, with their rates, accelerations and jerks.

    The gap and the coordinates have the same noise, and so the same gains. Where a gap is off by more than the
    covariance allows, that is scaled up: the point has begun another motion (Xia, Rao, Ying and Shen, Adaptive fading
    Kalman filter with an application, Automatica 1994).
    """

    def __init__(self, frame: PointFrame, noise: GapNoise, snap: float = SNAP) -> None:
        self.stamp = frame.stamp
        self.snap = snap
        self._surprises = 0.0, 0.0
        self.broke = False
        """Whether the last frame was off by more than the covariance allowed."""
        speed, acceleration, jerk = FIRST
        rates = (0.0,) * 4
        if frame.rate is not None and frame.velocity is not None:
            speed, rates = noise.rate**2, (frame.rate, *frame.velocity)
        gap, along, across, up = zip((frame.gap, *frame.position), rates, (0.0,) * 4, (0.0,) * 4, strict=True)
        self.rows: FilterRows = gap, along, across, up
        self.covariance: Triangle = (noise.gap**2, 0.0, speed, 0.0, 0.0, acceleration, 0.0, 0.0, 0.0, jerk)

    def add(self, frame: PointFrame, noise: GapNoise, learns: bool = True) -> None:
        """Take the next frame; whether the filter `learns` from it how rough the motion is."""
        time = (frame.stamp - self.stamp) / NANOSECONDS
        self.stamp = frame.stamp
        self.rows = self._carried(time)
        self.covariance = carried_covariance(self.covariance, time, self.snap)
        gap = self._correct(0, (frame.gap, *frame.position), noise.gap**2)
        rate = 0.0
        if frame.rate is not None and frame.velocity is not None:
            rate = self._correct(1, (frame.rate, *frame.velocity), noise.rate**2)
        self.broke = max(abs(gap), abs(rate)) > OUTLIER
        # Surprises that follow each other with the same sign show that the filter is too slow, with changing ones that
        # it follows the noise (Mehra, On the identification of variances and adaptive Kalman filtering, 1970).
        before, self._surprises = self._surprises, (0.0, 0.0) if self.broke else (gap, rate)
        if not learns or self.broke:
            return
        self.snap *= 1.0 + ADAPTS * (gap * before[0] + rate * before[1])
        self.snap = max(LEAST_SNAP, min(MOST_SNAP, self.snap))

    def turn(self) -> None:
        """Take that the point begins to come down: planners lower a foot along another curve than they lift it."""
        *others, jerk = self.covariance
        self.covariance = (*others, jerk + TURN)  # type: ignore[assignment]

    def motion(self, time: float) -> tuple[Vector3, Vector3]:
        """Position (m) and velocity (m/s) of the point `time` s after the last frame."""
        gap, along, across, up = self._carried(time)
        return (along[0], across[0], up[0]), (along[1], across[1], up[1])

    def span(self, noise: GapNoise) -> float:
        """How long, in s, one cubic follows the gap about as well as the noise lets it be seen."""
        return float((LASTS * noise.gap**2 / self.snap) ** (1.0 / 7.0))

    def _correct(self, order: int, measured: tuple[float, float, float, float], noise: float) -> float:
        """Take measured values, or rates (order 1), with the variance of their noise; by how many
        deviations the gap was off.
        """
        rows, cov = self.rows, self.covariance
        own = cov[2] if order else cov[0]
        off = measured[0] - (rows[0][1] if order else rows[0][0])
        surprise = off / sqrt(own + noise)
        if abs(surprise) > OUTLIER:
            factor = min(FIRST[2] / cov[9], ((off / OUTLIER) ** 2 - noise) / own)
            if factor > 1.0:
                cov = tuple([one * factor for one in cov])  # type: ignore[assignment]
        p00, p10, p11, p20, p21, p22, p30, p31, p32, p33 = cov
        c0, c1, c2, c3 = (p10, p11, p21, p31) if order else (p00, p10, p20, p30)
        scale = 1.0 / ((c1 if order else c0) + noise)
        k0, k1, k2, k3 = c0 * scale, c1 * scale, c2 * scale, c3 * scale
        self.covariance = (
            # A rounding must not make a variance negative.
            max(p00 - k0 * c0, 0.0) if order else k0 * noise,
            p10 - k1 * c0,
            k1 * noise if order else max(p11 - k1 * c1, 0.0),
            p20 - k2 * c0,
            p21 - k2 * c1,
            max(p22 - k2 * c2, 0.0),
            p30 - k3 * c0,
            p31 - k3 * c1,
            p32 - k3 * c2,
            max(p33 - k3 * c3, 0.0),
        )
        (x0, v0, a0, j0), (x1, v1, a1, j1), (x2, v2, a2, j2), (x3, v3, a3, j3) = rows
        e0, e1, e2, e3 = measured
        if order:
            e0, e1, e2, e3 = e0 - v0, e1 - v1, e2 - v2, e3 - v3
        else:
            e0, e1, e2, e3 = e0 - x0, e1 - x1, e2 - x2, e3 - x3
        self.rows = (
            (x0 + k0 * e0, v0 + k1 * e0, a0 + k2 * e0, j0 + k3 * e0),
            (x1 + k0 * e1, v1 + k1 * e1, a1 + k2 * e1, j1 + k3 * e1),
            (x2 + k0 * e2, v2 + k1 * e2, a2 + k2 * e2, j2 + k3 * e2),
            (x3 + k0 * e3, v3 + k1 * e3, a3 + k2 * e3, j3 + k3 * e3),
        )
        return surprise

    def _carried(self, time: float) -> FilterRows:
        gap, along, across, up = self.rows
        return carried(gap, time), carried(along, time), carried(across, time), carried(up, time)


def carried(row: Cubic, time: float) -> Cubic:
    """A value with its rate, acceleration and jerk, `time` s later."""
    x, v, a, j = row
    return x + time * (v + time * (0.5 * a + time * j / 6.0)), v + time * (a + 0.5 * time * j), a + time * j, j


def carried_covariance(covariance: Triangle, time: float, snap: float) -> Triangle:
    """The covariance `time` s later of a motion whose jerk is a random walk of the power density `snap`."""
    p00, p10, p11, p20, p21, p22, p30, p31, p32, p33 = covariance
    t = time
    h = 0.5 * t * t
    c = t * h / 3.0
    a01 = p10 + t * p11 + h * p21 + c * p31
    a02 = p20 + t * p21 + h * p22 + c * p32
    a03 = p30 + t * p31 + h * p32 + c * p33
    a12 = p21 + t * p22 + h * p32
    a13 = p31 + t * p32 + h * p33
    a23 = p32 + t * p33
    s = snap * t
    s2, t2 = s * t, t * t
    return (
        p00 + t * p10 + h * p20 + c * p30 + t * a01 + h * a02 + c * a03 + s * t2 * t2 * t2 / 252.0,
        a01 + t * a02 + h * a03 + s2 * t2 * t2 / 72.0,
        p11 + t * p21 + h * p31 + t * a12 + h * a13 + s * t2 * t2 / 20.0,
        a02 + t * a03 + s * t2 * t2 / 30.0,
        a12 + t * a13 + s2 * t2 / 8.0,
        p22 + t * p32 + t * a23 + s * t2 / 3.0,
        a03 + s2 * t2 / 24.0,
        a13 + s * t2 / 6.0,
        a23 + 0.5 * s2,
        p33 + s,
    )
