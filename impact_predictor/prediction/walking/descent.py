"""When a point that comes down will land: the time that is left for which its motion fits what landings are like.

Seen backwards from a landing, the gap is nearly a cubic of the time that is left. Its height over the ground's level,
speed, acceleration and jerk there have a mean and a variance, which landings that have happened teach. Feet strike the
ground or brake to rest on it: both are tried, and weighed by how well they fit and by how often they have happened.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import exp, log, sqrt
from typing import TYPE_CHECKING, Final

from ...stamps import NANOSECONDS
from ..vectors import total
from .cubic import Cubic, Triangle, back, factored, halfway, square_of
from .point_filter import PointFilter, carried, carried_covariance
from .rhythm import DeviationScale, StrideRhythm

if TYPE_CHECKING:
    from .ground import GroundLevel

STRIKE: Final = 0
REST: Final = 1
AXES: Final[tuple[Cubic, ...]] = (
    (1.0, 0.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0, 0.0),
    (0.0, 0.0, 0.0, 1.0),
)
FIRST_MEAN: tuple[Cubic, Cubic] = ((0.0, -0.5, 0.0, 0.0), (0.0, 0.0, 15.0, 0.0))
"""Of a landing that strikes, and of one that brakes to rest, before any was seen: height, rate, acceleration, jerk."""
FIRST_DEVIATION: tuple[Cubic, Cubic] = ((5e-4, 0.25, 30.0, 1000.0), (1e-4, 0.02, 30.0, 1000.0))
LEAST_DEVIATION: tuple[Cubic, Cubic] = ((1e-5, 0.05, 2.0, 50.0), (1e-5, 0.005, 2.0, 50.0))
FIRST_WEIGHT: Final = 0.2  # landings that the first deviation counts for ...
MEAN_WEIGHT: Final = 0.5  # ... and the first mean
VARIES: Final = 0.5  # a machine may change its gait: by this part of the mean do acceleration and jerk vary at least
SLOW: Final = 0.1  # m/s below which a foot has rather braked to rest
MEMORY: Final = 20.0  # landings that are remembered, about
TAIL: Final = 4.0  # degrees of freedom of how landings scatter
NEVER: Final = 0.5  # landings of a kind that are taken to have been seen before any was

FURTHEST: Final = 0.3  # s ahead beyond which no landing is looked for ...
MIDDLE: Final = 0.15  # ... and where the search for it begins at most
STEPS: Final = 4  # Gauss-Newton steps for a sample at most: the next begins where the last has ended
EXACT: Final = 5e-4  # a step in s that is small enough to be the last one
FALLS: Final = 3.0  # a point comes down when its rate is so many standard deviations below zero ...
LEAST_RATE: Final = 0.02  # ... and at least so many m/s
UNLIKELY: Final = 1e-3  # a kind whose odds are below that ...
SAMPLES_LEFT_OUT: Final = 3  # ... is not looked at for so many samples
MEMORY_OF_SWING: Final = 200  # samples of a descent that are remembered
SHORT: Final = 0.015  # s from the last frame in the air to its landing from which that can be told

BIN: Final = 0.01  # s of lead time that are learnt of together ...
BINS: Final = 12  # ... and how many there are
KNOWN: Final = 2.0  # landings that the deviation as it is computed counts for
CHANCE: Final = 4.0  # variances of a mean error that are taken off it
HUBER: Final = 1.5  # standard deviations beyond which an error counts no more
WORST: Final = 25.0  # an error counts no more than so many variances
BROAD: Final = 0.05  # a told deviation in s from which an error says nothing


class LandingMoments:
    """Mean and variance of height, rate, acceleration and jerk at landings of one kind (SI), and their `count`."""

    def __init__(self, kind: int) -> None:
        self.mean = FIRST_MEAN[kind]
        self._strikes = kind == STRIKE
        self._first = [one * one for one in FIRST_DEVIATION[kind]]
        self._least = [one * one for one in LEAST_DEVIATION[kind]]
        self.variance = tuple(self._first)
        self.count = 0.0
        self._square = [0.0] * 4

    def learn(self, found: Cubic, doubt: Sequence[float]) -> None:
        """Take what was found of a landing, with the variance that is left of it (expectation maximization)."""
        self.count = min(self.count + 1.0, MEMORY)
        mean, share = [], 1.0 / (self.count + MEAN_WEIGHT)
        for k, (m, x, d) in enumerate(zip(self.mean, found, doubt, strict=True)):
            mean.append(m + share * (x - m))
            self._square[k] += ((1.0 - share) * (x - m) ** 2 + d - self._square[k]) / self.count
        self.mean = (mean[0], mean[1] if self._strikes else 0.0, mean[2], mean[3])
        whole = FIRST_WEIGHT + self.count
        both = zip(self._first, self._square, self._least, strict=True)
        self.variance = tuple([max(least, (FIRST_WEIGHT * first + self.count * s) / whole) for first, s, least in both])
        h, v, a, j = self.variance
        self.variance = h, v, max(a, (VARIES * mean[2]) ** 2), max(j, (VARIES * mean[3]) ** 2)


class LandingFit:
    """The landing of one kind that fits best: `time` s ahead, its `variance`, the logarithm of its `evidence`, the
    squares in variances that are `left`, the `state` of the gap then, and the `factor` of its covariance.
    """

    def __init__(
        self, time: float, variance: float, evidence: float, left: float, state: Cubic, factor: Triangle
    ) -> None:
        self.time, self.variance, self.evidence, self.left = time, variance, evidence, left
        self.state, self.factor = state, factor


class LandingPrior:
    """What landings are like, of either kind."""

    def __init__(self) -> None:
        self.kinds = LandingMoments(STRIKE), LandingMoments(REST)
        self.deviations = DeviationScale()
        self.announced = self.came = 0.0
        """How many landings were announced, and how many of them came."""

    @property
    def shares(self) -> tuple[float, float]:
        """How often landings are of either kind."""
        strike, rest = self.kinds[STRIKE].count + NEVER, self.kinds[REST].count + NEVER
        return strike / (strike + rest), rest / (strike + rest)

    @property
    def came_true(self) -> float:
        """The part of the announced landings that came; of the first ones nine of ten are taken to come."""
        return (self.came + 0.9) / (self.announced + 1.0)

    def learn(self, gap: Cubic, covariance: Triangle, snap: float, time: float, unsure: float) -> None:
        """Take a landing `time` s after a gap, over a level of the variance `unsure`, was as it is told."""
        # Its kind is told by its speed, as the filter knows it: kinds that are learnt could change places.
        fresh = tried_at(LandingMoments(STRIKE), gap, covariance, snap, time, unsure)
        if fresh is None:
            return
        kind = self.kinds[STRIKE if fresh[0].state[1] < -SLOW else REST]
        tried = tried_at(kind, gap, covariance, snap, time, unsure)
        if tried is None:
            return
        one = tried[0]
        sures = [square_of(one.factor, axis) for axis in AXES]
        height, *others = kind.variance
        height += unsure
        doubts = [v - v * v * sure for v, sure in zip((height, *others), sures, strict=True)]
        kind.learn(one.state, (max(0.0, doubts[0] - unsure), *doubts[1:]))


def tried_at(
    kind: LandingMoments, gap: Cubic, covariance: Triangle, snap: float, time: float, unsure: float
) -> tuple[LandingFit, float] | None:
    """How a landing of a kind `time` s ahead fits, and by how many s another time would fit better (Gauss-Newton).

    The gap is that over a level of the variance `unsure`.
    """
    p = carried_covariance(covariance, time, snap)
    h, v, a, j = kind.variance
    h += unsure
    factor = factored((p[0] + h, p[1], p[2] + v, p[3], p[4], p[5] + a, p[6], p[7], p[8], p[9] + j))
    if factor is None:
        return None
    there, mean = carried(gap, time), kind.mean
    off = there[0] - mean[0], there[1] - mean[1], there[2] - mean[2], there[3] - mean[3]
    y0, y1, y2, y3 = halfway(factor, off)
    k0, k1, k2, k3 = back(factor, (y0, y1, y2, y3))
    # The state then, with what is known of such landings, and how it changes with the time.
    state = mean[0] + h * k0, mean[1] + v * k1, mean[2] + a * k2, mean[3] + j * k3
    u0, u1, u2, u3 = halfway(factor, (state[1], state[2], state[3], 0.0))
    information = u0 * u0 + u1 * u1 + u2 * u2 + u3 * u3
    if information <= 0.0:
        return None
    step = -(u0 * y0 + u1 * y1 + u2 * y2 + u3 * y3) / information
    left = y0 * y0 + y1 * y1 + y2 * y2 + y3 * y3
    # That of a t distribution: a landing that is like none before speaks little for the other kind.
    unlike = (TAIL + 4.0) * log(1.0 + left / TAIL)
    evidence = log(factor[0] * factor[2] * factor[5] * factor[9]) - 0.5 * (unlike + log(information))
    return LandingFit(time, 1.0 / information, evidence, left, state, factor), step


def solution_of(
    kind: LandingMoments, gap: Cubic, filtered: PointFilter, unsure: float, start: float | None
) -> LandingFit | None:
    """The landing of a kind that fits best, looked for from a `start` in s; None where there is none before long."""
    time, tried, moved = start, None, 0.0
    if time is None:
        time = min(MIDDLE, 2.0 * max(gap[0], 0.0) / max(LEAST_RATE, -gap[1] - kind.mean[1]))
    for _ in range(STEPS):
        tried = tried_at(kind, gap, filtered.covariance, filtered.snap, time, unsure)
        if tried is None:
            return None
        limit = 0.5 * time + 0.005
        following = max(0.0, min(time + max(-limit, min(tried[1], limit)), FURTHEST))
        moved, time = abs(following - time), following
        if moved < EXACT:
            break
    if tried is None or time >= FURTHEST:
        return None
    # What fits badly, or has not been found yet, is less sure than it seems.
    one = tried[0]
    variance = one.variance * max(1.0, 0.25 * one.left) + moved * moved
    return LandingFit(time, variance, one.evidence, one.left, one.state, one.factor)


class LeadTimeErrors:
    """What the past errors of a point say of the times that are told now, by their lead time.

    A swing repeats itself: what the filter cannot know of its course, it errs by each time. The mean of the errors is
    taken off, as far as their scatter shows it, and the deviation is scaled by what it was too small or too large.
    """

    def __init__(self) -> None:
        self._mean = [0.0] * BINS
        self._square = [0.0] * BINS
        self._scale = [1.0] * BINS
        self._count = [0.0] * BINS

    def offset(self, time: float) -> float:
        """What is to be taken off a time in s until a landing."""
        x = max(0.0, time / BIN - 0.5)
        k = min(int(x), BINS - 1)
        here = self._shrunk(k)
        return here + min(x - k, 1.0) * (self._shrunk(min(k + 1, BINS - 1)) - here)

    def scale(self, time: float) -> float:
        """What the variance of a time in s until a landing is to be multiplied by."""
        return self._scale[min(int(time / BIN), BINS - 1)]

    def learn(self, told: Sequence[tuple[float, float, float, float]]) -> None:
        """Take a landing: of some samples the time in s that was found, the one told, its variance, the true one."""
        bins: list[list[tuple[float, float, float]]] = [[] for _ in range(BINS)]
        for found, said, variance, true in told:
            if found < BINS * BIN and variance < BROAD * BROAD:
                scaled = min((said - true) ** 2 / variance, WORST)
                bins[int(found / BIN)].append((found - true, variance, scaled))
        for k, ones in enumerate(bins):
            if not ones:
                continue
            error, variance, scaled = (total(values) / len(ones) for values in zip(*ones, strict=True))
            count = self._count[k] = min(self._count[k] + 1.0, MEMORY)
            # What errs as no other landing does says little of the next (Huber).
            most = HUBER * sqrt(max(variance * self._scale[k], self._square[k]))
            off = max(-most, min(error - self._mean[k], most))
            self._mean[k] += off / count
            # The scatter of its own errors, of the first one what was told of it.
            own = variance * self._scale[k] if count == 1.0 else (1.0 - 1.0 / count) * off * off
            self._square[k] += (own - self._square[k]) / count
            self._scale[k] += (scaled - self._scale[k]) / (count + KNOWN)

    def _shrunk(self, k: int) -> float:
        """The mean error of a lead time, less what may be chance of it (positive-part shrinkage, James and Stein)."""
        mean, count = self._mean[k], self._count[k]
        chance = CHANCE * self._square[k]
        return 0.0 if count * mean * mean <= chance else mean - chance / (count * mean)


class Descent:
    """A landing that is expected `time` s after a sample, with the standard `deviation` of that in s.

    `strikes` is the probability that the foot strikes the ground and does not brake to rest on it, `rate` (m/s) that of
    the gap at the landing, 0 of one that rather rests.
    """

    def __init__(self, time: float, deviation: float, strikes: float, rate: float) -> None:
        self.time, self.deviation, self.strikes, self.rate = time, deviation, strikes, rate


DescentRecord = tuple[int, tuple[float, float, float], tuple[float, float], tuple[Cubic, Triangle, float]]
"""The stamp of a sample (ns); the time until the landing that it showed, that less its usual error, and the variance of
it; the time and the deviation that were told; and the gap, its covariance and its snap, which they are from."""


class DescentEstimator:
    """Tells when a point lands, from its filter and from what landings are like."""

    def __init__(self) -> None:
        self._errors = LeadTimeErrors()
        self._times: list[float | None] = [None, None]
        self._rhythm = StrideRhythm()
        self._told: deque[DescentRecord] = deque(maxlen=MEMORY_OF_SWING)
        self._left_out = [0, 0]
        self._stamp = 0

    def rest(self) -> None:
        """Forget the descent: the point stands."""
        self._told.clear()
        self._times, self._left_out = [None, None], [0, 0]

    def estimate(self, filtered: PointFilter, level: GroundLevel, prior: LandingPrior) -> Descent | None:
        """The landing of a point that comes down on a level; None of one that does not, or not before long."""
        x, v, a, j = filtered.rows[0]
        gap, unsure = (x - level.height, v, a, j), level.deviation**2
        if v > -max(LEAST_RATE, FALLS * sqrt(filtered.covariance[2])):
            self._times, self._left_out = [None, None], [0, 0]
            return None
        passed = (filtered.stamp - self._stamp) / NANOSECONDS
        self._stamp = filtered.stamp
        found, shares = [], prior.shares
        for k, kind in enumerate(prior.kinds):
            start = self._times[k]
            start = self._times[k] = None if start is None or start <= passed else start - passed
            if self._left_out[k] > 0:
                self._left_out[k] -= 1
                continue
            one = solution_of(kind, gap, filtered, unsure, start)
            self._times[k] = None if one is None else one.time
            if one is not None:
                found.append((one.evidence + log(shares[k]), k, one))
        if not found:
            self._left_out = [0, 0]
            return None
        most, likelier, best = max(found)
        whole = strikes = variance = 0.0
        for evidence, k, one in found:
            weight = exp(evidence - most)
            if weight < UNLIKELY:
                self._left_out[k] = SAMPLES_LEFT_OUT
            whole += weight
            strikes += weight if k == STRIKE else 0.0
            variance += weight * (one.variance + (one.time - best.time) ** 2)
        strikes, variance = strikes / whole, variance / whole
        less = max(0.0, best.time - self._errors.offset(best.time))
        time, square = self._rhythm.weighed(filtered.stamp, less, variance * self._errors.scale(best.time))
        time, deviation = max(0.0, time), sqrt(square)
        state = gap, filtered.covariance, filtered.snap
        self._told.append((filtered.stamp, (best.time, less, variance), (time, deviation), state))
        return Descent(time, deviation, strikes, 0.0 if likelier == REST else min(0.0, best.state[1]))

    def learn(self, stamp: int, last: int, level: GroundLevel, prior: LandingPrior) -> None:
        """Take that the point has landed on a level at a stamp in ns, after its `last` frame in the air."""
        self._rhythm.learn(stamp)
        last = min(last, stamp)
        told = [((stamp - one[0]) / NANOSECONDS, one) for one in self._told if one[0] <= last]
        if told:
            prior.deviations.learn([(*one[2], true) for true, one in told])
            self._errors.learn([(*one[1], true) for true, one in told])
            time, (_, _, _, (gap, covariance, snap)) = told[-1]
            if time < SHORT:
                prior.learn(gap, covariance, snap, time, level.deviation**2)
