"""Whether a point rests, as its last frames show it wherever the ground is, and whether it hovers."""

from __future__ import annotations

from collections import deque
from math import inf, sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..types import Sample
from ..vectors import add, axes_of, cross, dot, mean, to_world, total
from .cubic import SCALE, CubicSums, GapNoise, PointFrame, slope_of, square_of, value_of

SURE: Final = 3.0  # standard deviations of its mean rate within which a point rests
WINDOWS: Final = (1, 2, 4)  # contact times over which it is looked at: the more of them, the less noise hides
COURSE: Final = 6  # contact times of the descent before that, from which its course is told
FEWEST: Final = 5  # frames of that course at least
JERK: Final = 1000.0  # standard deviation in m/s^3 of how the acceleration of a foot changes
FELL: Final = 5.0  # standard deviations by which it would have come further down, had it gone on as before ...
BRAKES: Final = 4.0  # ... and as many times faster at least than gravity makes it in a contact time: drives brake less
YIELDS: Final = 0.15  # part of the speed of a foot that strikes with which it may bounce
SETTLES: Final = 2  # dead times for which a foot rests that has come down otherwise than by a strike
LASTS: Final = 0.9  # part of that which the frames span at least
STILL: Final = 0.2  # part of the way, at the speed that gravity gives in a contact time, within which it rests


def rate_of(frames: list[PointFrame], noise: GapNoise) -> tuple[float, float]:
    """The mean rate (m/s) of the gap over two frames or more, with its standard deviation."""
    first, last, count = frames[0], frames[-1], float(len(frames))
    span = (last.stamp - first.stamp) / NANOSECONDS
    rate, deviation = (last.gap - first.gap) / span, sqrt(2.0) * noise.gap / span
    if noise.rate < deviation * sqrt(count):
        rates = [frame.rate for frame in frames if frame.rate is not None]
        if len(rates) == len(frames):
            return total(rates) / count, noise.rate / sqrt(count)
    return rate, deviation


def falls(frames: list[PointFrame], slow: float, noise: GapNoise) -> bool:
    """Whether a point surely comes down, faster than a `slow` one (m/s), over two frames or more."""
    rate, unsure = rate_of(frames, noise)
    return rate < -slow - SURE * unsure


def is_slow(frames: list[PointFrame], slow: float, noise: GapNoise) -> bool:
    """Whether a point may rest, or bounce where it struck, over two frames or more."""
    rate, unsure = rate_of(frames, noise)
    return abs(rate) <= slow + SURE * unsure + YIELDS


def since(frames: deque[PointFrame], stamp: int, end: float = inf, fewest: int = 2) -> list[PointFrame]:
    """The frames from a stamp in ns on until an `end`, and at least the last `fewest` until that."""
    found = list[PointFrame]()
    for frame in reversed(frames):
        if frame.stamp <= end:
            if frame.stamp < stamp and len(found) >= fewest:
                break
            found.append(frame)
    found.reverse()
    return found


def stop_of(frames: deque[PointFrame], contact_time: int, slow: float, noise: GapNoise) -> int | None:
    """The stamp in ns at which a point broke off its descent, if it has rested since for a `contact_time` (ns).

    Its course before that, a parabola, would have led it further down. None where it goes on, or brakes as a drive may.
    """
    for window in WINDOWS:
        rested = since(frames, frames[-1].stamp - window * contact_time)
        rate, unsure = rate_of(rested, noise)
        if abs(rate) > slow + SURE * unsure + YIELDS:
            continue
        end = rested[0].stamp - contact_time
        course = since(frames, end - COURSE * contact_time, end, FEWEST)
        if len(course) < FEWEST or rate_of(course, noise)[0] > -BRAKES * slow:
            continue
        sums = CubicSums(course[0].stamp, course[0].gap, course[0].rate)
        for frame in course[1:]:
            sums.add(frame.stamp, frame.gap, frame.rate)
        found = sums.fit(noise.ratio if sums.measured else 0.0, (noise.gap / (JERK * SCALE**3 / 6.0)) ** 2)
        if found is None:
            continue
        cubic, factor, _ = found
        s, t, u = ((one.stamp - course[0].stamp) / (SCALE * NANOSECONDS) for one in (course[-1], rested[0], rested[-1]))
        ways = (0.0, u - t, u * u - t * t, u**3 - t**3)
        span = (u - t) * SCALE
        expected, doubt = (
            (value_of(cubic, u) - value_of(cubic, t)) / span,
            noise.gap * sqrt(square_of(factor, ways)) / span,
        )
        if abs(rate) > slow + SURE * unsure - YIELDS * expected:
            continue
        if rate - expected < max(BRAKES * slow, FELL * sqrt(unsure * unsure + doubt * doubt)):
            continue
        level = total([frame.gap for frame in rested]) / len(rested)
        speed = -slope_of(cubic, s) / SCALE
        late = (course[0].gap + value_of(cubic, s) - level) / speed * NANOSECONDS if speed > 0.0 else 0.0
        return course[-1].stamp + round(max(0.0, min(late, rested[0].stamp - course[-1].stamp)))
    return None


def hovers(frames: list[PointFrame], base: Sample) -> bool:
    """Whether a point moves with its base rather than it rests on the ground, over two frames or more."""
    axes, first, last = axes_of(base.orientation), frames[0], frames[-1]
    arm = add(last.position, base.position, -1.0)
    speed = add(to_world(axes, base.linear), cross(to_world(axes, base.angular), arm))
    way = add(last.position, first.position, -1.0)
    relative = add(way, speed, -(last.stamp - first.stamp) / NANOSECONDS)
    return dot(relative, relative) <= dot(way, way)


def settles(frames: deque[PointFrame], dead_time: int, slow: float, noise: GapNoise) -> tuple[list[PointFrame], float]:
    """The frames in which a point has been quite at rest, where they last two dead times (ns), and what counts as rest
    in m; else none.
    """
    found = since(frames, frames[-1].stamp - SETTLES * dead_time)
    third = len(found) // 3
    if found[-1].stamp - found[0].stamp < LASTS * SETTLES * dead_time or third == 0:
        return [], 0.0
    parts = [mean([one.position for one in found[k * third : (k + 1) * third]]) for k in range(3)]
    still = STILL * slow * dead_time / NANOSECONDS + SURE * noise.gap * sqrt(2.0 / third)
    ways = [add(one, parts[0], -1.0) for one in parts[1:]]
    return found if all(dot(way, way) <= still * still for way in ways) else [], still
