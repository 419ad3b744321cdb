"""The way of a point of a foot over the ground: the cubic that it follows, and when it reached the ground.

A cubic is the simplest curve that has a foot brake before it lands, and begin to brake before that.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from itertools import islice
from math import inf, sqrt
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3
from .cubic import SCALE, CubicSums, Fit, GapNoise, PointFrame, factored, shifted, square_of, value_of

FEWEST = 5  # frames that a cubic is fitted to at least: four would leave nothing to tell how well it fits ...
MOST = 200  # ... and at most: half a second at 400 Hz
SHORTER = 3  # quarters of the frames that are kept where one cubic does not fit them all
MISFIT = 4.0  # a cubic does not fit where the residuals' mean square is so many standard deviations above the noise's
BROKE = 2.0  # the last frame did not follow the others where it makes them scatter so many times more about their cubic
TURNED = 3.0  # a rate is surely not zero when it is so many standard deviations from it

JERK = 1000.0  # standard deviation in m/s^3 of how the acceleration of a foot changes, as long as none has landed
DIFFERENCE = 0.2  # a foot comes down otherwise than before by this part of the mean at least
FORGETS = 0.98  # part of what was known before that counts beside one more landing
TELLING = 0.01  # a descent tells something by itself from this part of what is known in the end
LEAST_DEVIATION = 100.0  # m/s^3 by which the next descent may differ: a machine may change its gait
JERK_UNIT = SCALE**3 / 6.0  # the third power's coefficient in a fit of a jerk of 1 m/s^3

LEAST = 6  # frames in the air in which an arrival is looked for; they may be from before the foot began to descend
NEAREST = 42  # the most of them that are looked at, besides those that may have been on the ground already
FULL = 150  # frames after which a point that hovers near the ground is looked at anew
SHARE = 4  # frames that are caught up with while the next one comes in
SAME = 0.01  # a later arrival is believed where it leaves less by this part of the noise's square


class DescentPrior:
    """Mean and deviation of the jerk of feet that come down: what noise hides of it in one descent, many show."""

    def __init__(self) -> None:
        self._mean = 0.0
        self._square = JERK * JERK
        self._precision = 1.0 / self._square

    def learn(self, fit: Fit) -> None:
        """Take the cubic of a descent that has ended on the ground.

        What the descent itself tells is learnt, without the prior that was in its fit: else that would confirm itself.
        """
        weight, expected = fit.prior
        whole = 1.0 / fit.factor[9] ** 2
        own = whole - weight
        if own <= TELLING * whole:
            return
        jerk = (whole * fit.gap[3] * SCALE**3 - weight * expected) / own / JERK_UNIT
        doubt = fit.deviation / sqrt(own) / JERK_UNIT
        # What noise adds to a jerk is none of the prior: an unsure one counts less, and spreads less than it seems to.
        precision = 1.0 / (doubt * doubt + LEAST_DEVIATION * LEAST_DEVIATION)
        self._precision = FORGETS * self._precision + precision
        share, off = precision / self._precision, jerk - self._mean
        self._mean += share * off
        self._square = max(0.0, self._square + share * (off * off - doubt * doubt - self._square))

    def coefficient(self, noise: float) -> tuple[float, float]:
        """Weight and value of the third power's coefficient, before the frames of noise (m) are seen."""
        deviation = max(LEAST_DEVIATION, sqrt(self._square) + DIFFERENCE * abs(self._mean))
        return (noise / (deviation * JERK_UNIT)) ** 2, self._mean * JERK_UNIT


class FootTrajectory:
    """The last frames of a point over its ground, and the longest stretch of them that one cubic fits."""

    def __init__(self) -> None:
        self.frames: deque[PointFrame] = deque(maxlen=MOST)
        self._sums: CubicSums | None = None
        self._falls = False
        self._deviation = 0.0
        self.top = 0
        """Stamp in ns of the highest place that the point descends from."""
        self.broke = False
        """Whether the last frame did not follow the cubic of those before it."""

    @property
    def rate(self) -> float:
        """The rate of the gap now, in m/s: measured, or else from the last two frames; 0 from one."""
        last = self.frames[-1]
        if last.rate is not None or len(self.frames) < 2:
            return last.rate or 0.0
        before = self.frames[-2]
        return (last.gap - before.gap) / (last.stamp - before.stamp) * NANOSECONDS

    def follow(self) -> None:
        """Fit the last frame together with those that were followed before it."""
        frame = self.frames[-1]
        if self._sums is None:
            self._sums = CubicSums([frame])
        else:
            self._sums.add(frame)

    def rest(self) -> None:
        """Follow the point no more; what comes later is another trajectory."""
        self._sums = None
        self._falls = False
        self._deviation = 0.0

    def fit(self, noise: GapNoise, prior: DescentPrior) -> Fit | None:
        """The cubic of the last frames once the point descends; None before, and while there are too few of them."""
        sums = self._sums
        if sums is None or sums.count < FEWEST:
            return None
        rate = self.frames[-1].rate
        if not self._falls and rate is not None and rate > TURNED * noise.rate:
            return None
        if sums.count >= MOST:
            sums = self._sums = CubicSums(self.last(SHORTER * MOST // 4))
        fit = self._fit_of(sums, noise, prior)
        self.broke = fit is not None and not fit.fits and fit.deviation > BROKE * self._deviation
        count = sums.count
        while fit is not None and not (fit.fits or count == FEWEST):
            count = max(FEWEST, SHORTER * count // 4)
            fit = self._fit_of(CubicSums(self.last(count), places=False), noise, prior)
        if count < sums.count:
            self._sums = CubicSums(self.last(count))
        if fit is None:
            return None
        self._deviation = fit.deviation
        return fit if self._descends(fit) else None

    def motion(self, fit: Fit, time: float) -> tuple[Vector3, Vector3]:
        """Position and velocity of the point `time` s after the fit's stamp, by the cubic through the same frames."""
        assert self._sums is not None
        # What is expected of the gap says nothing of the motion along the ground.
        factor = factored(self._sums.normal(fit.ratio)) or fit.factor
        return self._sums.motion(factor, fit.ratio, fit.end + time / SCALE)

    def last(self, count: int) -> list[PointFrame]:
        return list(islice(self.frames, max(0, len(self.frames) - count), None))

    def _fit_of(self, sums: CubicSums, noise: GapNoise, prior: DescentPrior) -> Fit | None:
        """The cubic nearest to the gaps, and to their rates where all are measured."""
        ratio = noise.ratio if sums.measured else 0.0
        weight, expected = prior.coefficient(noise.gap)
        found = sums.fit(ratio, weight, expected)
        if found is None:
            return None
        cubic, factor, left = found
        free = (2 if sums.measured else 1) * sums.count - 3
        share = left / (free * noise.gap * noise.gap)
        fits = share <= 1.0 + MISFIT * sqrt(2.0 / free)
        stamp = self.frames[-1].stamp
        end = (stamp - sums.first.stamp) / (SCALE * NANOSECONDS)
        return Fit(
            stamp=stamp,
            end=end,
            gap=shifted((sums.first.gap + cubic[0], *cubic[1:]), end, 1.0 / SCALE),
            factor=factor,
            ratio=ratio,
            deviation=noise.gap if fits else noise.gap * sqrt(share),
            fits=fits,
            prior=(weight, expected),
        )

    def _descends(self, fit: Fit) -> bool:
        """Whether the point descends, and has not just begun to.

        At its highest place a planner goes over from lifting the foot to lowering it, by another curve: what came
        before tells nothing of the landing, and is left out of the fits from then on.
        """
        _, slope, bend, _ = fit.gap
        if slope > TURNED * fit.deviation_of(1, 0.0):
            self._falls = False
        elif not self._falls and slope < -TURNED * fit.deviation_of(1, 0.0):
            self._falls = True
            top = fit.stamp + 0.5 * slope / -bend * NANOSECONDS if bend < 0.0 else 0.0
            self.top = round(top)
            since = sum([frame.stamp >= top for frame in self.frames])
            if self._sums is not None and since < self._sums.count:
                self._sums = CubicSums(self.last(max(1, since)))
            return False
        return self._falls


class Arrival(NamedTuple):
    """A point reached the ground at `stamp` (ns); its frame of index -`age` was the last in the air.

    `velocity` (m/s) is what it had there: measured, or else that of the cubic through its frames in the air; None where
    these are too few.
    """

    stamp: int
    age: int
    velocity: Vector3 | None


class ArrivalCandidate(NamedTuple):
    """The cubic of the frames up to `last`, if the point arrived between that and the next frame.

    `left` is the least square of what it leaves of them; `here` and `there` are its gaps (m) at the two frames, with
    what is unsure of them; `near` are the sums over the frames near the ground up to the last.
    """

    last: int
    left: float
    here: tuple[float, float]
    there: tuple[float, float]
    near: tuple[float, float]


class ArrivalFit:
    """A point that is near the ground and does not stand yet, from its first frame there on.

    `frames` are the last ones up to that; the point came down since `begin` (ns) to about a `level` (m). The work is
    shared between the frames that come in: the first of them finds many that are new.
    """

    def __init__(
        self, frames: Sequence[PointFrame], begin: int, level: float, tolerance: float, noise: GapNoise
    ) -> None:
        first = max(0, len(frames) - 2)
        start = next((k for k, frame in enumerate(frames) if frame.stamp >= begin), 0)
        start = max(0, min(start, first - LEAST))
        self._frames = list(frames[start:])
        self._first = first - start
        self._level, self._tolerance, self._noise = level, tolerance, noise
        self._sums = CubicSums(self._frames[:1], places=False)
        self._near = 0.0, 0.0
        self._tried: list[ArrivalCandidate] = []

    def add(self, frame: PointFrame) -> bool:
        """Take the next frame near the ground; False where it has so many that this one is to begin another."""
        if len(self._frames) >= FULL:
            return False
        self._frames.append(frame)
        self._catch_up(SHARE)
        return True

    def _catch_up(self, most: int) -> None:
        done = self._sums.count
        for k in range(done, min(done + most, len(self._frames))):
            frame = self._frames[k]
            if k > self._first:
                ratio = self._noise.ratio if self._sums.measured else 0.0
                if k >= FEWEST:
                    self._try(k, ratio)
                off, (near, square) = frame.gap - self._level, self._near
                self._near = near + off, square + off * off + ratio * (SCALE * (frame.rate or 0.0)) ** 2
            self._sums.add(frame)

    def _try(self, k: int, ratio: float) -> None:
        """The arrival between frame `k`, which is the next one, and the one before."""
        frames, found = self._frames, self._sums.fit(ratio)
        if found is None:
            return
        cubic, factor, left = found
        ends = []
        for one in frames[k - 1 : k + 1]:
            s = (one.stamp - frames[0].stamp) / (SCALE * NANOSECONDS)
            off = frames[0].gap - self._level + value_of(cubic, s)
            ends.append((off, square_of(factor, (1.0, s, s * s, s * s * s))))
        self._tried.append(ArrivalCandidate(last=k - 1, left=left, here=ends[0], there=ends[1], near=self._near))

    def arrival(self) -> Arrival:
        """The arrival, once the point rests.

        In the air the frames follow one cubic, then they rest at the level of the cubic's end: of all pairs of
        neighbours that the arrival may lie between it is the one where both together leave least (least squares). A
        foot that strikes arrives where the cubic meets the level; one that brakes to rest hardly meets it: it arrives
        with the nearest frame.
        """
        self._catch_up(FULL)
        frames, noise = self._frames, self._noise
        best, last, air = inf, self._first, 0
        stamp = frames[min(last + 1, len(frames) - 1)].stamp
        # What comes to rest does so near the level of the others, by half a tolerance or so: as good as so many frames.
        known = (2.0 * noise.gap / self._tolerance) ** 2
        for one in self._tried:
            near, square = self._near[0] - one.near[0], self._near[1] - one.near[1]
            rest = near / (len(frames) - 1 - one.last + known)
            here, there = one.here[0] - rest, one.there[0] - rest
            cost, later = here * here / one.here[1], there * there / one.there[1]
            part = 0.0 if cost <= later else 1.0
            if here > 0.0 > there:
                part, cost = here / (here - there), 0.0
            left = one.left + square - near * rest + min(cost, later)
            if left < best - SAME * noise.gap**2:
                best, air, last = left, one.last + 1, one.last if part > 0.0 else one.last - 1
                before = frames[one.last].stamp
                stamp = before + round(part * (frames[one.last + 1].stamp - before))
        velocity = frames[last].velocity
        sums = None if air == 0 or self._sums.measured else CubicSums(frames[:air])
        factor = None if sums is None else factored(sums.normal(0.0))
        if velocity is None and sums is not None and factor is not None:
            s = (frames[last].stamp - frames[0].stamp) / (SCALE * NANOSECONDS)
            _, velocity = sums.motion(factor, 0.0, s)
        return Arrival(stamp, len(frames) - last, velocity)
