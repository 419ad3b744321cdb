"""The ground under the feet, as standing ones show it: its level under each place, and the noise of their gaps."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import erfc, exp, pi, sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..planar import direction_of
from ..scene import Scene
from ..types import Vector3
from ..vectors import cross, dot, total
from .cubic import GapNoise, PointFrame
from .descent import LandingPrior
from .terrain import TerrainMap

LEAST = GapNoise(gap=1e-5, rate=2e-4)  # by so much a planned course differs from a cubic over few frames: no noise
GUESS: Final = 0.2  # until feet have stood their gaps are taken to scatter by this part of the contact tolerance ...
GUESS_RATE: Final = 0.02  # ... and the rates of those by so much, in m/s
DRIFT: Final = 1.0  # contact tolerances in a second by which standing feet may shift the level: an estimator's drift
UNSURE: Final = 0.02  # contact tolerances by which that is not known
MEMORY: Final = 100  # frames of standing feet over which noise is averaged ...
FEWEST: Final = 10  # ... and from how many on that is believed
HOVERS: Final = 0.5  # contact tolerances above the lowest foot within which feet stand at first
LEAVES: Final = 0.1  # contact tolerances by which a foot that has come to rest leaves its foothold
SINKS: Final = 0.5  # contact tolerances that a foot may sink in
SOFT: Final = 1.5  # points that soft ground was seen to brake lately, from which on others sink in as they have
STEADY: Final = 15  # frames over which the level of a foothold is averaged ...
SETTLES: Final = 100_000_000  # ... while feet and ground may still yield, in ns
FOLLOWS: Final = 15  # ... and over which the drift is

FOOTHOLDS: Final = 24  # that are remembered: a hind foot steps where a front foot stood some steps before
PLANE: Final = 12  # of them, the last ones, that tell the plane about which levels scatter ...
RECENT: Final = 0.8  # ... each with that part of the weight of the next one
SLOPE: Final = 0.1  # standard deviation of the plane's slopes before footholds show them
FORGETS: Final = 0.9  # part of what earlier footholds told of the scatter that counts beside one more
NEIGHBOUR: Final = 0.1  # m: the ground is as high here as at a foothold that is much nearer than that
FAR: Final = 5.0  # squares of that distance, or standard deviations, beyond which nothing is told
ROUGH: Final = 0.2  # contact tolerances by which levels are taken to scatter until footholds show it ...
GUESSED: Final = 0.3  # ... and how much that counts beside one
ROUNDING: Final = 1e-15  # of one less a number near one: a foothold's error is no smaller part of the scatter


class GroundLevel:
    """Where the ground is under a place: its `height` in m over the scene's plane, with its standard `deviation`."""

    def __init__(self, height: float, deviation: float) -> None:
        self.height, self.deviation = height, deviation

    def below(self, gap: float, deviation: float) -> GroundLevel:
        """The level under a point that has come down to a gap with a standard deviation (m), and has met no ground.

        It is a normal deviate that is known to be less than another one, the gap.
        """
        spread = sqrt(self.deviation**2 + deviation**2)
        off = (gap - self.height) / spread
        # Mills' ratio, and the first terms of its series (Abramowitz and Stegun, 26.2.12).
        ratio = (
            -off - 1.0 / off if off < -FAR else 2.0 * exp(-0.5 * off * off) / sqrt(2.0 * pi) / erfc(-off / sqrt(2.0))
        )
        part = self.deviation**2 / spread**2
        left = 1.0 - part * min(1.0, ratio * (off + ratio))
        return GroundLevel(self.height - part * spread * ratio, self.deviation * sqrt(left))


class Foothold:
    """A place where a point stands, or stood.

    `u` and `v` (m) say where on the scene's plane. Heights (m) are less the drift of all: the point is at `rest`, the
    mean of `count` frames, below the `level` of the ground as far as it has sunk in. Whether it was seen to have
    `touched` that, and the `stamp` when it was stepped on (ns); `moves` are the last differences of its gap and rate.
    """

    __slots__ = ("count", "level", "moves", "rest", "stamp", "touched", "u", "v")

    def __init__(self, u: float, v: float, rest: float, count: int, stamp: int) -> None:
        self.u, self.v, self.rest, self.count, self.stamp = u, v, rest, count, stamp
        self.level, self.touched = rest, False
        self.moves: tuple[float, float] | None = None


class Relief:
    """How the levels of footholds lie about a plane: those of near ones are alike, others scatter.

    This is kriging with a plane for the trend (Cressie, Statistics for Spatial Data, 1993, 3.4), except that each
    neighbour tells for itself, as if the others did not: that takes no matrix for each place.
    """

    def __init__(self, tolerance: float) -> None:
        """Know nothing but the contact tolerance in m."""
        self.known = False
        """Whether there has been a foothold."""
        self._footholds: deque[tuple[Foothold, float]] = deque(maxlen=FOOTHOLDS)
        self._settling = deque[tuple[Foothold, float, float]]()
        self._square, self._weight = (ROUGH * tolerance) ** 2, GUESSED
        self._error = (UNSURE * tolerance) ** 2
        self._u = self._v = self._mean = 0.0
        self._count = 1.0
        self.slopes = 0.0, 0.0
        """Those of the plane along u and v."""
        # Of the slopes xx, xy and yy of the covariance matrix, in parts of the scatter's square.
        self._unsure = 0.0, 0.0, 0.0

    def add(self, foothold: Foothold, datum: float, first: bool) -> None:
        """Take a foothold whose level counts from a datum (m); the `first` ones have been stood on for long."""
        if self._footholds:
            trend, unsure = self._trend(foothold.u, foothold.v)
            self._settling.append((foothold, datum + trend, unsure))
        # How far they lie off what was expected is seen once they have settled.
        while self._settling and (first or foothold.stamp - self._settling[0][0].stamp > SETTLES):
            one, expected, unsure = self._settling.popleft()
            self._weight = FORGETS * self._weight + 1.0
            self._square += ((one.level - expected) ** 2 / (1.0 + unsure) - self._square) / self._weight
        self.known = True
        self._footholds.append((foothold, datum))
        self._fit(list(self._footholds)[-PLANE:])

    def at(self, u: float, v: float) -> GroundLevel:
        """The level at a place, over the datum there."""
        trend, unsure = self._trend(u, v)
        square = self._square + LEAST.gap**2
        error, precision, off = max(self._error / square, ROUNDING), 1.0, 0.0
        for one, datum in self._footholds if error < 1.0 else ():  # else they tell nothing but the plane
            x, y = one.u - u, one.v - v
            far = (x * x + y * y) / NEIGHBOUR**2
            if far < FAR:
                alike = exp(-far)
                weight = alike / (1.0 + error - alike * alike)
                precision += alike * weight
                off += weight * (one.level - datum - self._trend(one.u, one.v)[0])
        return GroundLevel(trend + off / precision, sqrt(square * (1.0 / precision + unsure)))

    @property
    def lowest(self) -> float | None:
        return min([one.level - datum for one, datum in self._footholds], default=None)

    def _trend(self, u: float, v: float) -> tuple[float, float]:
        """The plane's height at a place, and the square of its standard deviation in parts of the scatter's."""
        x, y = u - self._u, v - self._v
        (a, b), (p, q, r) = self.slopes, self._unsure
        return self._mean + a * x + b * y, 1.0 / self._count + p * x * x + 2.0 * q * x * y + r * y * y

    def _fit(self, footholds: list[tuple[Foothold, float]]) -> None:
        """The plane nearest to footholds (least squares), which hardly slopes as long as they do not show it."""
        weights = [RECENT**k for k in range(len(footholds) - 1, -1, -1)]
        self._count = whole = total(weights)
        told = [(w, one.u, one.v, one.level - datum) for w, (one, datum) in zip(weights, footholds, strict=True)]
        self._u = total([w * u for w, u, _, _ in told]) / whole
        self._v = total([w * v for w, _, v, _ in told]) / whole
        self._mean = total([w * level for w, _, _, level in told]) / whole
        p = r = self._square / SLOPE**2
        q = a = b = 0.0
        for w, u, v, level in told:
            x, y, off = u - self._u, v - self._v, w * (level - self._mean)
            p, q, r = p + w * x * x, q + w * x * y, r + w * y * y
            a, b = a + x * off, b + y * off
        whole = p * r - q * q
        if whole > 0.0:
            self.slopes = (r * a - q * b) / whole, (p * b - q * a) / whole
            self._unsure = r / whole, -q / whole, p / whole


class Ground:
    """The level of the ground under each place and the noise of gaps, as the standing feet show both.

    Heights may drift, as those of an estimator do: what standing feet show while they stand is drift, and where each of
    them came to stand is ground. Where a map tells of the terrain footholds show how that is off.
    """

    def __init__(self, scene: Scene, terrain: TerrainMap | None = None) -> None:
        self.noise = GapNoise(GUESS * scene.tolerance, GUESS_RATE)
        self.prior = LandingPrior()
        self.drift = 0.0
        """By how much in m the ground that feet show has moved along the normal, since the scene was written."""
        self.sinks = 0.0
        """By how much in m what stands has sunk in: feet touch the ground that much higher."""
        self.yields = 0.0
        """How far in m soft ground has let points come down lately before it stopped them."""
        self._braked = self._deep = 0.0
        self._first = list[Foothold]()  # those on which the machine stood before it walked
        self._tolerance = scene.tolerance
        self._u = direction_of(scene.normal, [])
        self._v = cross(scene.normal, self._u)
        self._relief, self._residual = Relief(scene.tolerance), Relief(scene.tolerance)
        self._terrain, self._scene = terrain, scene
        self.footholds = self.unmapped = 0
        """How many footholds there were, and of how many the map told nothing."""
        self._seen = 0
        self._square = self._square_rate = 0.0

    @property
    def lowest(self) -> float | None:
        """The level (m) of the lowest foothold that is remembered; None before there is one."""
        level = self._relief.lowest
        return None if level is None else self.drift + level

    @property
    def depth(self) -> float:
        """By how much in m points sink in as they land: on soft ground as deep as they were seen to, on the mean."""
        return self._deep if self._braked > SOFT else self.sinks

    def level_at(self, place: Vector3) -> GroundLevel:
        """The level of the ground under a place (m, in the frame of odom)."""
        u, v = dot(self._u, place), dot(self._v, place)
        told = self._told(place)
        if told is None:
            level = self._relief.at(u, v)
            return GroundLevel(self.drift + level.height, level.deviation)
        datum, edge = told
        level = self._residual.at(u, v)
        return GroundLevel(self.drift + datum + level.height, sqrt(level.deviation * level.deviation + edge * edge))

    def level_of(self, foothold: Foothold) -> GroundLevel:
        """The level of a foothold now."""
        return GroundLevel(self.drift + (foothold.level if foothold.touched else foothold.rest), 0.0)

    def begin(self, frames: Sequence[PointFrame], first: bool = False, touched: float | None = None) -> Foothold:
        """The foothold of a point that stands, and has rested there for some frames, or since the `first` one.

        The ground is at the height (m) where the point has touched it, if that was seen.
        """
        place, rest = frames[-1].position, total([frame.gap for frame in frames]) / len(frames)
        self._braked *= FORGETS
        if touched is not None:
            self._braked += 1.0
            self._deep += (touched - rest - self._deep) / self._braked
        elif self._braked > SOFT:
            touched = rest + self._deep
        gap = rest + self.sinks if touched is None else touched
        self.yields = max(FORGETS * self.yields, gap - rest)
        if not self._relief.known:
            self.drift = gap
        # What is off is ground, but for the little drift that nobody has seen yet.
        level, unsure = self.level_at(place), UNSURE * self._tolerance
        off, square = gap - level.height, level.deviation**2 + unsure**2
        self.drift += max(-unsure, min(off * unsure * unsure / (square + unsure * unsure), unsure))
        found = Foothold(dot(self._u, place), dot(self._v, place), rest - self.drift, len(frames), frames[-1].stamp)
        found.level, found.touched = gap - self.drift, touched is not None
        if first or not self._seen:
            self._first.append(found)
        else:
            self._first.clear()
        told = self._told(place)
        self.footholds += 1
        self._relief.add(found, 0.0, first)
        if told is not None:
            self._residual.add(found, told[0], first)
        elif self._terrain is not None:
            self.unmapped += 1
        return found

    def add(self, frame: PointFrame, before: PointFrame, foothold: Foothold) -> None:
        """Take two frames of a point that stands on a foothold; they follow each other."""
        off = frame.gap - self.drift - foothold.rest
        settled = frame.stamp - foothold.stamp >= SETTLES
        near = (HOVERS if foothold.touched else LEAVES) * self._tolerance
        if abs(off) > (max(near, FAR * self.noise.gap) if settled else self._tolerance):
            # The foot has slipped off an edge, the ground has given way, or it has not come down yet.
            foothold.count, foothold.stamp, foothold.touched, settled = 1, frame.stamp, False, False
        if settled and not foothold.touched:
            limit = DRIFT * self._tolerance * abs(frame.stamp - before.stamp) / NANOSECONDS
            self.drift += max(-limit, min(off / FOLLOWS, limit))
        else:
            foothold.count = min(foothold.count + 1, STEADY)
            foothold.rest += off / foothold.count
        if not foothold.touched:
            foothold.level = foothold.rest + self.sinks
        if self._first:
            # The scene has the height at which feet touch, as nothing else can: if it is about right. One may hover.
            rests = [one.rest for one in self._first]
            rests = [one for one in rests if one < min(rests) + HOVERS * self._tolerance]
            sunk = -self.drift - total(rests) / len(rests)
            self.sinks = sunk if 0.0 < sunk < SINKS * self._tolerance else 0.0
        moved, foothold.moves = foothold.moves, (frame.gap - before.gap, (frame.rate or 0.0) - (before.rate or 0.0))
        if moved is None:
            return
        self._seen = min(self._seen + 1, MEMORY)
        share = 1.0 / self._seen
        # How these differ leaves slow motion out, and has six times the square of the noise.
        self._square += share * ((foothold.moves[0] - moved[0]) ** 2 / 6.0 - self._square)
        rate = self.noise.rate
        if frame.rate is not None and before.rate is not None:
            self._square_rate += share * ((foothold.moves[1] - moved[1]) ** 2 / 6.0 - self._square_rate)
            rate = max(LEAST.rate, sqrt(self._square_rate))
        if self._seen >= FEWEST:
            self.noise = GapNoise(max(LEAST.gap, sqrt(self._square)), rate)

    def _told(self, place: Vector3) -> tuple[float, float] | None:
        """The height of the terrain under a place over the scene's plane, and how much it may be off (m)."""
        found = None if self._terrain is None else self._terrain.at(place)
        if found is None:
            return None
        height, edge = found
        return dot(self._scene.normal, (place[0], place[1], height)) - self._scene.height, edge
