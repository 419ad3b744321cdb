"""What lashings, chocks and wind add to the margins of bodies on a moving support.

A body that begins to slide a way, to tip about an edge or to lift moves against some of what holds it. Lashings are
springs that stretch with it from their preload, and slacken where it comes nearer, until the first one bears its MSL or
the body has shifted by SHIFT. Chocks are stiff: they bear before any lashing stretches, so that the strength of both
never adds up, and the larger one of two counts: chocks with lashings at their preload, or the stretched lashings alone.
What pulls the body down adds friction. A chock's force needs another one against it, and there is none but what pushes
the body there: about an edge it takes off the height at which that acts, and no more.

All this is known before the support moves, so that a message costs a few products for each body.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, hypot, inf, pi, sin
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..types import Vector3
from ..vectors import add, cross, dot, times, total
from .stance import Edge, Holder, StandingBody, unit_across

SHIFT: Final = 0.1
"""m: a body that shifts farther has slid, or tipped, whatever its lashings then bear."""

WAYS: Final = 24
"""Ways along the support in which it may slide: of any other 0.9 % of what acts is left out at most."""

_LEAST: Final = 1e-9  # m/s^2, and m^2/s^2, of what is divided by

_BLOCKS: Final = 0.02
"""A chock holds what moves against it by this part of the motion: less slides along it."""

_Motion = Callable[[Vector3], Vector3]


class Secured:
    """Some bodies with holders or wind; `felt` (n, 3, 12) are the rows of what each feels, `width` its most edges."""

    def __init__(self, stances: Sequence[StandingBody], felt: NDArray[np.float64], width: int) -> None:
        ways = [_ways(stance) for stance in stances]
        count = max(map(len, ways))
        # A way that is there twice changes nothing.
        ways = [(one * count)[:count] for one in ways]
        slides = [
            [(_along(stance, way, stance.friction), _wind(stance, way)) for way in one]
            for stance, one in zip(stances, ways, strict=True)
        ]
        absent = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        tips = [([_tip(one, edge) for edge in one.edges] + [absent] * width)[:width] for one in stances]
        outward = [([edge.outward for edge in one.edges] + [(0.0, 0.0, 0.0)] * width)[:width] for one in stances]
        mass = np.array([[stance.mass] for stance in stances])
        self._rows = np.concatenate((np.array(ways), np.array(outward)), axis=1) @ felt
        self._count = count
        self._friction = np.array([[[stance.friction]] for stance in stances])
        self._held, self._wind = np.moveaxis(np.array(slides), 2, 0)[..., None] / mass[:, :, None]
        parts = np.moveaxis(np.array(tips), 2, 0)[..., None] / mass[:, :, None]
        self._stretched, self._preload, self._chocked, self._tipping, self._blown, self._height = parts
        self._height *= mass[:, :, None]
        self._lift = np.array([[_along(one, one.normal, 0.0)] for one in stances]) / mass

    def ratios(
        self,
        motion: NDArray[np.float64],
        weight: NDArray[np.float64],
        tips: NDArray[np.float64],
        levers: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """The parts used up of the margins against sliding (n, times) and tipping (n, edges, times), and whether a body
        lifts, at a support's `motions`: of bodies of `weight` (n, 1, times) that are tipped by `tips` (n, edges, times)
        with `levers` (n, edges, 1), all for 1 kg.
        """
        numbers = (self._rows.reshape(-1, len(motion)) @ motion).reshape(*self._rows.shape[:2], -1)
        acts, outwards = numbers[:, : self._count], numbers[:, self._count :]
        acts += self._wind
        slide = _parts(acts, self._friction * weight + self._held).max(axis=1)
        tips, bears = tips + self._tipping, levers * weight
        eased = tips - self._height * np.maximum(outwards + self._blown, 0.0)
        tip = np.maximum(_parts(tips, bears + (self._preload + self._chocked)), _parts(eased, bears + self._preload))
        return slide, np.minimum(tip, _parts(tips, bears + self._stretched)), weight[:, 0] + self._lift <= 0.0


def _parts(acts: NDArray[np.float64], holds: NDArray[np.float64]) -> NDArray[np.float64]:
    """The parts used up; far above FULL where nothing holds."""
    np.maximum(holds, _LEAST, out=holds)
    found: NDArray[np.float64] = acts / holds
    return found


def _ways(stance: StandingBody) -> list[Vector3]:
    """Unit vectors along the support: all around, and along each chock."""
    first = unit_across(stance.normal)
    second = cross(stance.normal, first)
    angles = [2.0 * pi * k / WAYS for k in range(WAYS)]
    found = [add(times(first, cos(angle)), second, sin(angle)) for angle in angles]
    for holder in stance.holders:
        along = cross(stance.normal, holder.direction)
        if holder.stiffness == inf and (length := hypot(*along)) > _BLOCKS:
            found += [times(along, 1.0 / length), times(along, -1.0 / length)]
    return found


def _along(stance: StandingBody, way: Vector3, friction: float) -> float:
    """What holds a body (N) that shifts a way, with the friction that it is pressed down for."""
    pulls = [-dot(holder.direction, stance.normal) * friction for holder in stance.holders]
    stretched, preload, chocked = _held(stance.holders, lambda _: way, SHIFT, pulls)
    return max(stretched, preload + chocked)


def _tip(stance: StandingBody, edge: Edge) -> tuple[float, ...]:
    """About an edge: the moments (N m) of stretched lashings, of lashings at rest and of chocks, those of the wind and
    its force (N), and the height (m) above the edge at which the chocks push back what acts outwards.
    """
    axis = cross(stance.normal, edge.outward)

    def motion(point: Vector3) -> Vector3:
        return cross(axis, add(point, edge.point, -1.0))

    reach = SHIFT / max(hypot(*motion(stance.center)), SHIFT)
    pushing = [one for one in stance.holders if one.stiffness == inf and -dot(one.direction, edge.outward) > _BLOCKS]
    stretched, preload, clamped = _held([one for one in stance.holders if one not in pushing], motion, reach)
    chocked = _held(pushing, motion, reach)[2]
    heights = [dot(one.direction, motion(one.point)) / dot(one.direction, edge.outward) for one in pushing]
    blown = _wind(stance, edge.outward)
    above = 0.0 if stance.wind is None else dot(stance.normal, add(stance.wind.center, edge.point, -1.0))
    return stretched, preload + clamped, chocked, blown * above, blown, max([0.0, *heights])


def _wind(stance: StandingBody, way: Vector3) -> float:
    return 0.0 if stance.wind is None else stance.wind.along(way)


def _held(
    holders: Sequence[Holder], motion: _Motion, reach: float, pulls: Sequence[float] = ()
) -> tuple[float, float, float]:
    """What lashings that are stretched by a motion hold against it, up to `reach` of it; lashings at rest; and chocks.

    `pulls` are what a force of 1 in each holds by other means.
    """
    rates = [-dot(holder.direction, motion(holder.point)) for holder in holders]
    for holder, rate in zip(holders, rates, strict=True):
        if holder.stiffness < inf and rate > 0.0:
            reach = min(reach, (holder.strength - holder.preload) / (holder.stiffness * rate))
    stretched, rest, chocked = [], [], []
    for holder, rate, pull in zip(holders, rates, pulls or [0.0] * len(rates), strict=True):
        if holder.stiffness < inf:
            grown = holder.stiffness * rate * reach if rate and reach < inf else 0.0
            stretched.append(min(max(holder.preload + grown, 0.0), holder.strength) * (rate + pull))
            rest.append(holder.preload * (rate + pull))
        elif rate > _BLOCKS and rate + pull > 0.0:
            chocked.append(holder.strength * (rate + pull))
    return total(stretched), total(rest), total(chocked)
