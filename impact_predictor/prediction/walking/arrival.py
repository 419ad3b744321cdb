"""When a point that has come to stand reached the ground, from its frames before and after that."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3
from ..vectors import total
from .cubic import SCALE, Cubic, CubicSums, Factor, GapNoise, PointFrame, factored, solved, square_of

FEWEST = 5
"""Frames in the air from which a cubic is told."""

LEAST = 6
"""... so many are looked at, where there are so many, ...

They may be from before the foot began to descend, which is no great harm."""

MOST = 42
"""... and the most of them that are looked at, besides those that may have been on the ground already."""

FULL = 150
"""Frames after which a point that hovers near the ground is looked at anew: fewer than its trajectory remembers."""

SHARE = 4
"""Frames that are caught up with while the next one comes in."""

SAME = 0.01
"""A later arrival is believed where it leaves less by this part of the noise's square, else the earlier."""


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
    what is unsure of them; `near` are the sums over the frames near the ground up to the last; `places` are those of
    the coordinates, where the velocities of the frames are not measured.
    """

    last: int
    factor: Factor
    left: float
    here: tuple[float, float]
    there: tuple[float, float]
    near: tuple[float, float]
    places: tuple[Cubic, ...]


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
        self._ratio = (noise.gap / (noise.rate * SCALE)) ** 2
        measured = all(frame.velocity is not None for frame in self._frames)
        self._sums = CubicSums(self._frames[:1], places=not measured)
        self._near = 0.0, 0.0
        self._tried: list[ArrivalCandidate] = []

    @property
    def is_full(self) -> bool:
        """Whether it has so many frames that the next one is to begin another."""
        return len(self._frames) >= FULL

    def add(self, frame: PointFrame) -> None:
        """Take the next frame near the ground."""
        self._frames.append(frame)
        self._catch_up(SHARE)

    def _catch_up(self, most: int) -> None:
        """Look at up to so many of the frames that were not looked at yet."""
        done = self._sums.count
        for k in range(done, min(done + most, len(self._frames))):
            frame = self._frames[k]
            if k > self._first:
                self._try(k)
                off, (near, square) = frame.gap - self._level, self._near
                ratio = self._ratio if self._sums.measured else 0.0
                self._near = near + off, square + off * off + ratio * (SCALE * (frame.rate or 0.0)) ** 2
            self._sums.add(frame)

    def _try(self, k: int) -> None:
        """The arrival between frame `k`, which is the next one, and the one before."""
        frames, sums = self._frames, self._sums
        ratio = self._ratio if sums.measured else 0.0
        factor = factored(sums.normal(ratio)) if k >= FEWEST else None
        if factor is None:
            return
        right = sums.gaps.right(ratio)
        a, b, c, d = cubic = solved(factor, right)
        left = sums.square + ratio * sums.square_rate - total([x * y for x, y in zip(cubic, right, strict=True)])
        ends = []
        for one in frames[k - 1 : k + 1]:
            s = (one.stamp - frames[0].stamp) / (SCALE * NANOSECONDS)
            off = frames[0].gap - self._level + a + s * (b + s * (c + s * d))
            ends.append((off, square_of(factor, (1.0, s, s * s, s * s * s))))
        places = tuple([series.right(0.0) for series in sums.places])
        here, there = ends
        self._tried.append(
            ArrivalCandidate(
                last=k - 1, factor=factor, left=left, here=here, there=there, near=self._near, places=places
            )
        )

    def arrival(self) -> Arrival:
        """The arrival, once the point rests.

        In the air the frames follow one cubic, then they rest at the level of the cubic's end: of all pairs of
        neighbours that the arrival may lie between it is the one where both together leave least (least squares). A
        foot that strikes arrives where the cubic meets the level; one that brakes to rest hardly meets it: it arrives
        with the nearest frame.
        """
        self._catch_up(FULL)
        frames, noise = self._frames, self._noise
        best, last, found = inf, self._first, None
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
                best, found, last = left, one, one.last if part > 0.0 else one.last - 1
                before = frames[one.last].stamp
                stamp = before + round(part * (frames[one.last + 1].stamp - before))
        velocity = frames[last].velocity
        if velocity is None and found is not None and found.places:
            # By the cubic through the frames up to the end of the air.
            s = (frames[last].stamp - frames[0].stamp) / (SCALE * NANOSECONDS)
            cubics = [solved(found.factor, along) for along in found.places]
            x, y, z = [(b + s * (2.0 * c + 3.0 * d * s)) / SCALE for _, b, c, d in cubics]
            velocity = x, y, z
        return Arrival(stamp, len(frames) - last, velocity)
