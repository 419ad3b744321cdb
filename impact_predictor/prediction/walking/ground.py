"""The ground under the feet: the level at which they stand, and the noise of their gaps."""

from __future__ import annotations

from math import sqrt

from ...stamps import NANOSECONDS
from ..scene import Scene
from .cubic import GapNoise, PointFrame
from .trajectory import DescentPrior

LEAST = GapNoise(gap=1e-5, rate=2e-4)  # by so much a planned course differs from a cubic over few frames: no noise
GUESS = 0.2  # until feet have stood their gaps are taken to scatter by this part of the contact tolerance ...
GUESS_RATE = 0.02  # ... and the rates of those by so much, in m/s
DRIFT = 1.0  # contact tolerances in a second by which a standing foot may shift the level: an estimator's drift
MEMORY = 100  # frames of standing feet over which level and noise are averaged ...
FEWEST = 10  # ... and from how many on that is believed


class Ground:
    """The level at which feet stand and the noise of their gaps, as the standing ones show both."""

    def __init__(self, scene: Scene) -> None:
        self.level = 0.0
        self.noise = GapNoise(GUESS * scene.tolerance, GUESS_RATE)
        self.prior = DescentPrior()
        self._tolerance = scene.tolerance
        self._seen = 0
        self._square = self._square_rate = 0.0

    def is_near(self, frame: PointFrame) -> bool:
        """Whether a point is within the contact tolerance above the ground."""
        return frame.gap - self.level <= self._tolerance

    def add(self, frame: PointFrame, before: PointFrame) -> None:
        """Take two frames of a standing point that follow each other."""
        self._seen = min(self._seen + 1, MEMORY)
        share = 1.0 / self._seen
        # The height of a base drifts, and the ground that its feet show with it.
        limit = self._tolerance
        if self._seen > FEWEST:
            limit *= DRIFT * abs(frame.stamp - before.stamp) / NANOSECONDS
        self.level += max(-limit, min(share * (frame.gap - self.level), limit))
        # Differences of two frames leave the motion of the base's drift out, and have twice the square of the noise.
        self._square += share * (0.5 * (frame.gap - before.gap) ** 2 - self._square)
        rate = self.noise.rate
        if frame.rate is not None:
            self._square_rate += share * (frame.rate**2 - self._square_rate)
            rate = max(LEAST.rate, sqrt(self._square_rate))
        if self._seen >= FEWEST:
            self.noise = GapNoise(max(LEAST.gap, sqrt(self._square)), rate)
