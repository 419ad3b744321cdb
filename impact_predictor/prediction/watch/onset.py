"""How near bodies on a moving support are to sliding and to tipping, all of them at once, and how often they are over.

At rest on the support a body feels at its mass centre r the acceleration a = g - W' x r - W x (W x r): g what is felt
at the frame's origin, W the support's angular velocity. It slides when the friction that holds it does not suffice,
|a_t| > f a_n. About an edge with direction e (to the left of which the body stands) the reactions must balance the
moment of m a about the edge less the rate of change of the angular momentum, I W' + W x I W. They can only push, so it
tips when h a_o - e . (I W' + W x I W) / m > b a_n: h the height of the mass centre over the edge, b its distance
inwards, a_o the part of a outwards. In a plane that is h a_t + rho^2 W' > b a_n.

Everything is linear in g, W' and the products of W, so that one matrix serves all bodies and all times.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..types import Felt
from ..vectors import add
from .peaks import HOUR
from .stance import StandingBody, unit_across

if TYPE_CHECKING:
    from .secured import Secured

FULL: Final = 99.0
"""The ratio of a body that nothing holds: it weighs nothing on the support, or its mass centre is beyond an edge."""

BLOCK: Final = 152  # times at once: more do not stay in the cache of a processor

_ROUNDING: Final = 1e-12
"""Part of the acceleration felt below which its tangential part is none: without friction any other slides."""

_LEAST: Final = 1e-300  # of what is divided by
_MOTIONS: Final = 12  # numbers of a support's motion: g, W', and the products xx, yy, zz, xy, xz, yz of W


LEAST_WATCHED: Final = 60.0
"""s: a shorter watch counts as one of a minute, so that a single onset is not a thousand per hour."""


class OnsetMargins(NamedTuple):
    """Arrays (n,) over the bodies; of several times (n, times).

    `slide` and `tip` are the parts that are used up of the margins, from 0 over 1 (the onset) to FULL; `edge` the one
    that is nearest to tipping, by its number; `lifted` where nothing presses the body on the support.
    """

    slide: NDArray[np.float64]
    tip: NDArray[np.float64]
    edge: NDArray[np.intp]
    lifted: NDArray[np.bool_]


def motions(
    gravity: NDArray[np.float64], angular: NDArray[np.float64], turning: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The numbers (12, times) of a support's motion: what is felt at its origin in m/s^2, its angular velocity in rad/s
    and its derivative, each (times, 3), along its axes.
    """
    x, y, z = angular.T
    return np.concatenate((gravity.T, turning.T, (x * x, y * y, z * z, x * y, x * z, y * z)))


def motion_of(felt: Felt) -> NDArray[np.float64]:
    """As `motions`, (12,) of one time."""
    return motions(*np.array(felt)[:, None])[:, 0]


class Onset:
    """The bodies of some stances; `replace` gives one another."""

    def __init__(self, stances: Sequence[StandingBody]) -> None:
        self._stances = list(stances)
        self._changed = set(range(len(self._stances)))
        self._height: NDArray[np.float64] = np.zeros((0, 0))
        self._collect()

    def replace(self, number: int, stance: StandingBody) -> None:
        self._stances[number] = stance
        self._changed.add(number)

    def margins(self, motion: NDArray[np.float64]) -> OnsetMargins:
        """The margins at a support's `motions` (12, times), or (12,) at one time."""
        if motion.ndim == 1:
            one = self._margins(motion[:, None])
            return OnsetMargins(one.slide[:, 0], one.tip[:, 0], one.edge[:, 0], one.lifted[:, 0])
        blocks = [self._margins(motion[:, k : k + BLOCK]) for k in range(0, motion.shape[1], BLOCK)]
        return OnsetMargins(*[np.concatenate(parts, axis=1) for parts in zip(*blocks, strict=True)])

    def _margins(self, motion: NDArray[np.float64]) -> OnsetMargins:
        """The margins at `motions` of not too many times."""
        numbers = self._numbers(motion)
        rolling = self._drum_slide(numbers) if self._drums else None
        weight = numbers[:, :1]
        used = numbers[:, 2:]  # its first row, one part along the support, makes place for the whole of it
        np.hypot(numbers[:, 1], used[:, 0], out=used[:, 0])
        used[:, 0][used[:, 0] <= _ROUNDING * np.abs(weight[:, 0])] = 0.0
        limits = self._limits * weight
        ratios: NDArray[np.float64] = np.full(used.shape, FULL)
        np.divide(used, limits, out=ratios, where=limits > 0.0)
        if self._smooth.size:
            ratios[self._smooth, 0] = np.where(used[self._smooth, 0] > 0.0, FULL, 0.0)
        if rolling is not None:
            ratios[self._drums, 0] = rolling
        lifted = weight[:, 0] <= 0.0
        if self._secured is not None:
            at, secured = self._secured
            held = secured.ratios(motion, weight[at], used[at, 1:], self._limits[at, 1:])
            ratios[at, 0], ratios[at, 1:], lifted[at] = held
        np.clip(ratios, 0.0, FULL, out=ratios)
        np.copyto(ratios, FULL, where=lifted[:, None])
        tips = ratios[:, 1:]
        return OnsetMargins(ratios[:, 0], tips.max(axis=1), tips.argmax(axis=1), lifted)

    def felt(self, motion: NDArray[np.float64]) -> NDArray[np.float64]:
        """What bodies feel at their mass centres (n, 3, times) in m/s^2 along the support's axes, at `motions`."""
        if self._changed:
            self._collect()
        return self._felt @ motion

    def barriers(self, motion: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
        """The work (n,) in J until bodies topple over the easiest edge, and its number, at `motions` (12,) of a time.

        The mass centre must get to where it is highest against the acceleration felt, on its way about the edge: the
        rest of that way it falls. It is nothing beyond there.
        """
        numbers = self._numbers(motion[:, None])[:, :, 0]
        weight = numbers[:, :1]
        a = np.einsum("nkc,nk->nc", self._axes, numbers[:, :3])
        outwards = (self._outward * a[:, None]).sum(axis=2)
        lever, height = self._limits[:, 1:, 0], self._height
        steepest = np.hypot(outwards, weight) * np.hypot(lever, height)
        work = self._mass[:, None] * (steepest - lever * outwards - height * weight)
        work[(height * outwards >= lever * weight) | (weight <= 0.0)] = 0.0
        work[self._absent] = np.inf
        edge = work.argmin(axis=1)
        return np.maximum(work[np.arange(len(work)), edge], 0.0), edge

    def _numbers(self, motion: NDArray[np.float64]) -> NDArray[np.float64]:
        """For each body what presses it on the support, its two parts along it, and what tips it about each edge, in
        m/s^2 and m^2/s^2, as (n, 3 + edges, times).
        """
        if self._changed:
            self._collect()
        return (self._rows.reshape(-1, _MOTIONS) @ motion).reshape(*self._rows.shape[:2], -1)

    def _drum_slide(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """The part of the friction on their edges that cylinders use against spinning, and against slip along the axis.

        While one spins, both reactions are on the same side of their cones; where they cannot be so together it rolls
        over an edge first, and the whole force counts, which is less than both together.
        """
        arms, both, radius, friction, height = self._rolling
        weight, push, axial, first = numbers[self._drums, :4].swapaxes(0, 1)
        turn = (height * push - first) / radius
        wanted = np.hypot(turn, axial)
        # The reactions, inclined by the part of their friction that holds the spin, along (ahead, normal).
        lean = friction * turn / np.maximum(wanted, _LEAST)
        (x, y), (u, v) = [(arm[0] - lean * arm[1], arm[1] + lean * arm[0]) for arm in arms]
        width = np.where(both, x * v - y * u, 1.0)
        one, other = (-push * v - weight * u) / width, (x * weight + y * push) / width
        whole = np.hypot(push, weight)
        held = friction * np.where(both & (one >= 0.0) & (other >= 0.0), one + other, whole)
        wanted[wanted <= _ROUNDING * whole] = 0.0
        ratios: NDArray[np.float64] = np.where(wanted > 0.0, FULL, 0.0)
        np.divide(wanted, held, out=ratios, where=held > 0.0)
        return ratios

    def _collect(self) -> None:
        """Bring the arrays up to date with the stances that were replaced."""
        at = sorted(self._changed)
        self._changed.clear()
        count, stances = len(self._stances), [self._stances[number] for number in at]
        width = max(2, *(len(stance.edges) for stance in stances))
        if width > self._height.shape[1]:
            at, stances = list(range(count)), self._stances
            self._felt, self._rows = np.zeros((count, 3, _MOTIONS)), np.zeros((count, 3 + width, _MOTIONS))
            self._limits, self._height = np.zeros((count, 1 + width, 1)), np.zeros((count, width))
            self._axes, self._outward = np.zeros((count, 3, 3)), np.zeros((count, width, 3))
            self._mass, self._absent = np.zeros(count), np.zeros((count, width), dtype=bool)
        width = self._height.shape[1]
        spare = [((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))] * width
        edges = np.array([([edge[:2] for edge in stance.edges] + spare)[:width] for stance in stances])
        point, outward = edges[:, :, 0], edges[:, :, 1]
        absent = np.array([[k >= len(stance.edges) for k in range(width)] for stance in stances])
        center, normal = np.array([s.center for s in stances]), np.array([s.normal for s in stances])
        mass, inertia = np.array([s.mass for s in stances]), np.array([s.inertia for s in stances])
        arm = center[:, None] - point
        height = np.where(absent, 0.0, (normal[:, None] * arm).sum(axis=2))
        # Any two directions along the support; of a cylinder's across its axis and along it.
        ahead = np.array([s.edges[0].outward if s.edges else unit_across(s.normal) for s in stances])
        axes = np.stack((-normal, ahead, np.cross(normal, ahead)), axis=1)
        felt = _felt_rows(center)
        spin = _spin_rows(np.cross(normal[:, None], outward), inertia / mass[:, None, None])
        self._felt[at] = felt
        self._rows[at] = np.concatenate((axes @ felt, height[:, :, None] * (outward @ felt) - spin), axis=1)
        self._limits[at, 0, 0] = [stance.friction for stance in stances]
        self._limits[at, 1:, 0] = np.where(absent, 1.0, -(outward * arm).sum(axis=2))
        self._axes[at], self._outward[at], self._height[at], self._mass[at] = axes, outward, height, mass
        self._absent[at] = absent
        self._smooth = np.flatnonzero(self._limits[:, 0, 0] == 0.0)
        if count == len(at) or any(one.radius or one.holders or one.wind for one in stances):
            self._collect_others()

    def _collect_others(self) -> None:
        """What more there is to know of cylinders, and of bodies that more than friction holds."""
        stances = self._stances
        at = [number for number, stance in enumerate(stances) if stance.holders or stance.wind]
        self._secured: tuple[list[int], Secured] | None = None
        if at:
            from .secured import Secured

            self._secured = at, Secured([stances[k] for k in at], self._felt[at], self._height.shape[1])
        self._drums = [number for number, stance in enumerate(stances) if stance.radius > 0.0 and stance.edges]
        if self._drums:
            # The directions from the edges of cylinders to their axes along (ahead, normal), whether they lie on both.
            drums = [stances[number] for number in self._drums]
            radius = np.array([[stance.radius] for stance in drums])
            ways = self._axes[self._drums, 1], -self._axes[self._drums, 0]
            arms = []
            for k in (0, -1):
                arm = np.array([add(stance.center, stance.edges[k].point, -1.0) for stance in drums]) / radius
                arms.append([(way * arm).sum(axis=1)[:, None] for way in ways])
            both = np.array([[len(stance.edges) == 2] for stance in drums])
            self._rolling = arms, both, radius, self._limits[self._drums, 0], self._height[self._drums, :1]


class OnsetCounts:
    """How often each of some bodies began to tip and to slide, and struck.

    Onsets are counted as motion-induced interruptions are: each time that the part of the margin which is used up
    passes 1, a body that stands freely would begin to slide or to tip (Graham, Motion-induced interruptions as ship
    operability criteria, Naval Engineers Journal, 1990). Here each body feels its own acceleration, and the next onset
    counts once the part has been below 1 by a hysteresis.
    """

    def __init__(self, hysteresis: NDArray[np.float64]) -> None:
        self._again = 1.0 - hysteresis
        self._over = np.zeros((2, len(hysteresis)), dtype=bool)
        self._counts = np.zeros((3, len(hysteresis)), dtype=np.int64)
        self._seconds = 0.0

    def update(self, tip: NDArray[np.float64], slide: NDArray[np.float64], seconds: float) -> None:
        """Take the parts (n,) of the margins used up, so many s after those before."""
        self._seconds += seconds
        used = np.array((tip, slide))
        over = used >= 1.0
        self._counts[:2] += over > self._over
        self._over = over | (self._over & (used > self._again))

    def struck(self, number: int) -> None:
        self._counts[2, number] += 1

    def per_hour(self, number: int) -> list[float]:
        """Tips, slides and impacts of a body per hour of the time watched."""
        scale = HOUR / max(self._seconds, LEAST_WATCHED)
        return [count * scale for count in self._counts[:, number].tolist()]


def first_times(ratios: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """When each row of ratios (n, times) first reaches 1, linear between the times; inf where it does not."""
    over = ratios >= 1.0
    number = over.argmax(axis=1)
    row = np.arange(len(ratios))
    before = np.maximum(number - 1, 0)
    low, high = ratios[row, before], ratios[row, number]
    part = np.divide(1.0 - low, high - low, out=np.ones_like(low), where=high > low)
    found = times[before] + part * (times[number] - times[before])
    return np.where(over.any(axis=1), found, np.inf)


def _felt_rows(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """a = g - W' x r - W x (W x r) as rows (n, 3, 12) of the numbers of the motion, for r (n, 3)."""
    still = np.broadcast_to(np.eye(3), (len(r), 3, 3))
    # W x (W x r) = W (W . r) - r (W . W)
    outwards = r[:, :, None, None] * np.eye(3) - np.einsum("ki,nj->nkij", np.eye(3), r)
    return np.concatenate((still, _across(r), _products(outwards)), axis=2)


def _spin_rows(along: NDArray[np.float64], inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """e . (I W' + W x I W) as rows (n, edges, 12), for directions e (n, edges, 3) and tensors I (n, 3, 3)."""
    # e . (W x I W) = (e x W) . I W
    gyroscopic = np.swapaxes(_across(along), 2, 3) @ inertia[:, None]
    return np.concatenate((np.zeros_like(along), along @ inertia, _products(gyroscopic)), axis=2)


def _across(u: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrices (..., 3, 3) of the products u x v."""
    x, y, z = np.moveaxis(u, -1, 0)
    none = np.zeros_like(x)
    return np.stack([none, -z, y, z, none, -x, -y, x, none], axis=-1).reshape(*u.shape, 3)


def _products(square: NDArray[np.float64]) -> NDArray[np.float64]:
    """What xx, yy, zz, xy, xz and yz of W count (..., 6) in W . M W, for matrices M (..., 3, 3)."""
    both = square + np.swapaxes(square, -1, -2)
    pairs = [0.5 * both[..., i, i] for i in range(3)] + [both[..., i, j] for i, j in ((0, 1), (0, 2), (1, 2))]
    return np.stack(pairs, axis=-1)
