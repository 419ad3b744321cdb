"""Where soft ground began to brake a point that came down, as the rates of its gap show it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import sqrt
from operator import mul
from typing import Final, NamedTuple

from ...stamps import NANOSECONDS
from ..vectors import total
from .cubic import GapNoise, PointFrame

APART: Final = 0.002  # s between frames that are looked at
COURSE: Final = 0.01  # s over which the rates are lines, before and after the ground brakes the point
FEWEST: Final = 3  # frames of those
STOPS: Final = (
    3.0  # frames in which soft ground stops a point at least, and times as long at most as if it braked on as first
)
SUDDEN: Final = 0.4  # part of how the ground brakes a point by which drives may have braked it just before
SHOWS: Final = 5.0  # standard deviations by which it brakes more than before
YIELDING: Final = 0.3  # part of its speed that is left when soft ground has braked it most ...
BOW: Final = 0.02  # ... and by which a line through that braking begins too low: springs with critical damping bend it


class BrakedCourse(NamedTuple):
    """Soft ground began to brake a point at a `stamp` (ns, with a `deviation` in s), which had the `speed` (m/s)."""

    stamp: int
    speed: float
    deviation: float


class RateLine:
    """The line nearest to rates (m/s) at some times (s): its `slope`, and the squares that are `left` of the rates.

    `spread` is the sum of the squares of the times about their mean.
    """

    def __init__(self, rates: Sequence[tuple[float, float]]) -> None:
        self.count = n = len(rates)
        times, values = zip(*rates, strict=True)
        self._time, self._rate = total(times) / n, total(values) / n
        arms, offs = [t - self._time for t in times], [v - self._rate for v in values]
        self.spread, both = total(map(mul, arms, arms)), total(map(mul, arms, offs))
        self.slope = both / self.spread
        self.left = max(0.0, total(map(mul, offs, offs)) - self.slope * both)

    def rate(self, time: float) -> float:
        return self._rate + self.slope * (time - self._time)

    def doubt(self, time: float) -> float:
        """The variance of the rate at a time, in those of one rate."""
        return 1.0 / self.count + (time - self._time) ** 2 / self.spread


def braked_course(frames: Sequence[PointFrame], first: int, noise: GapNoise, unsure: float) -> BrakedCourse | None:
    """Where soft ground began to brake a point; it came near the ground in the `first` of some frames or later.

    There the rate of its course, a line, meets that of its braking: of all frames it is the one where both lines leave
    least beside a single one (a broken line by least squares), if that is more than the noise makes. None where nothing
    shows it, or not to a height of about `unsure` m.
    """
    apart = (frames[-1].stamp - frames[0].stamp) / NANOSECONDS / max(1, len(frames) - 1)
    if len(frames) < 2 or apart * FEWEST > 2.0 * COURSE:
        return None
    step = max(1, round(APART / apart))
    rates, deviation = rates_of(frames[first % step :: step], noise)
    first, apart = max(FEWEST - 1, first // step - FEWEST), apart * step
    end = next((k for k in range(first, len(rates)) if rates[k][1] >= -deviation), len(rates) - 1)
    count, best, most = max(FEWEST, round(COURSE / apart)), None, 0.0
    for k in range(first, end - 1):
        before = RateLine(rates[max(0, k + 1 - count) : k + 1])
        speed = -before.rate(rates[k][0])
        last = next((i for i in range(k + 2, end) if rates[i][1] > -YIELDING * speed), end)
        after = RateLine(rates[k + 1 : max(k + 3, min(last, k + 1 + count))])
        turns = after.slope - before.slope
        drop = turns * turns / (1.0 / before.spread + 1.0 / after.spread)
        freedom = max(1, before.count + after.count - 4)
        square = max(deviation * deviation, (before.left + after.left) / freedom)
        if drop <= most * square or turns <= 0.0:
            continue
        met = (before.rate(0.0) - after.rate(0.0) + BOW * speed) / turns
        late = sqrt(square * (before.doubt(met) + after.doubt(met))) / turns
        # Drives brake ever more.
        drives = before.slope > SUDDEN * after.slope
        vague = drop < SHOWS * SHOWS * square or late * speed > unsure
        if drives or vague or not rates[k - 1][0] <= met <= rates[k + 1][0] + apart:
            continue
        # Soft ground brakes a point ever less, so that it stops no sooner than the line does; one that is stopped
        # between two frames or so shows its level better than when it met that.
        lasts, slow = rates[end][0] - met, YIELDING * speed + deviation
        stops = rates[last][1] < after.rate(rates[last][0]) + slow and rates[end - (end - k) // 4][1] > -slow
        if stops and STOPS * apart <= lasts <= STOPS * speed / after.slope:
            most, best = drop / square, BrakedCourse(frames[0].stamp + round(met * NANOSECONDS), speed, late)
    return best


def rates_of(frames: Sequence[PointFrame], noise: GapNoise) -> tuple[list[tuple[float, float]], float]:
    """The rates of some frames by their times in s from the first one, and their standard deviation in m/s."""
    start = frames[0].stamp
    rates = [((one.stamp - start) / NANOSECONDS, one.rate) for one in frames if one.rate is not None]
    if len(rates) == len(frames):
        return rates, noise.rate
    pairs = [(a, b, (b.stamp - a.stamp) / NANOSECONDS) for a, b in pairwise(frames)]
    rates = [((a.stamp - start) / NANOSECONDS + 0.5 * time, (b.gap - a.gap) / time) for a, b, time in pairs]
    return rates, sqrt(2.0) * noise.gap / max(time for *_, time in pairs) if pairs else 0.0
