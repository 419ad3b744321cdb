"""When a point that has come to stand reached the ground, from its frames before and after that."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf
from typing import NamedTuple

from ..types import Vector3
from .cubic import NANOSECONDS, SCALE, Frame, Noise, factored, solved, square_of
from .sums import Gaps, Sums

FEWEST = 5
"""Frames in the air from which a cubic is told."""

LEAST = 6
"""... so many are looked at, where there are so many, ...

They may be from before the foot began to descend, which is no great harm."""

MOST = 40
"""... and the most of them that are looked at, besides those that may have been on the ground already."""


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


def arrival(frames: Sequence[Frame], begin: int, level: float, tolerance: float, noise: Noise) -> Arrival:
    """Find the arrival of a point that rests in its last frames, and came down since `begin` (ns) to about a level (m).

    In the air the frames follow one cubic, then they rest at the level of the cubic's end: of all pairs of neighbours
    that the arrival may lie between it is the one where both together leave least (least squares). A foot that strikes
    arrives where the cubic meets the level; one that brakes to rest hardly meets it: it arrives with the nearest frame.
    """
    first = next((k for k in range(len(frames) - 1, -1, -1) if frames[k].gap - level > tolerance), 0)
    start = next((k for k, frame in enumerate(frames) if frame.stamp >= begin), 0)
    start = max(0, first - MOST, min(start, first - LEAST))
    own, first = frames[start:], first - start
    sums, ratio = Gaps(own[0]), 0.0
    if all(frame.rate is not None for frame in own):
        ratio = (noise.gap / (noise.rate * SCALE)) ** 2
    # What comes to rest does so near the level of the others, by half a tolerance or so: as good as so many frames.
    known = (2.0 * noise.gap / tolerance) ** 2
    resting, total, square, rates = float(len(own) - 1), 0.0, 0.0, 0.0
    for frame in own[1:]:
        off = frame.gap - level
        total, square = total + off, square + off * off
        rates += ratio * (SCALE * (frame.rate or 0.0)) ** 2
    best, stamp, last = inf, own[min(first + 1, len(own) - 1)].stamp, first
    for k, (frame, following) in enumerate(pairwise(own)):
        if k:
            sums.add(frame)
            off = frame.gap - level
            resting, total, square = resting - 1.0, total - off, square - off * off
            rates -= ratio * (SCALE * (frame.rate or 0.0)) ** 2
        factor = factored(sums.normal(ratio)) if k >= max(first, FEWEST - 1) else None
        if factor is None:
            continue
        right = sums.right(ratio)
        a, b, c, d = cubic = solved(factor, right)
        rest = total / (resting + known)
        left = square - total * rest + rates + sums.square + ratio * sums.square_rate
        left -= sum([x * y for x, y in zip(cubic, right, strict=True)])
        ends = []
        for one in (frame, following):
            s = (one.stamp - own[0].stamp) / (SCALE * NANOSECONDS)
            off = own[0].gap - level - rest + a + s * (b + s * (c + s * d))
            ends.append((off, off * off / square_of(factor, (1.0, s, s * s, s * s * s))))
        (here, cost), (there, later) = ends
        part = 0.0 if cost <= later else 1.0
        if here > 0.0 > there:
            part, cost = here / (here - there), 0.0
        left += min(cost, later)
        if left < best - SAME * noise.gap**2:
            best, last = left, k if part > 0.0 else max(0, k - 1)
            stamp = frame.stamp + round(part * (following.stamp - frame.stamp))
    return Arrival(stamp, len(own) - last, own[last].velocity or _velocity(own[: last + 1]))


def _velocity(own: Sequence[Frame]) -> Vector3 | None:
    """The velocity in the last of some frames without velocities, by the cubic through them."""
    sums = Sums(own[0])
    for frame in own[1:]:
        sums.add(frame)
    factor = factored(sums.normal(0.0)) if len(own) >= FEWEST else None
    if factor is None:
        return None
    s = (own[-1].stamp - own[0].stamp) / (SCALE * NANOSECONDS)
    x, y, z = [
        (b + s * (2.0 * c + 3.0 * d * s)) / SCALE
        for _, b, c, d in [solved(factor, sums.along(axis, 0.0)) for axis in range(3)]
    ]
    return x, y, z
