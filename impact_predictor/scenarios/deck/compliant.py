"""Cargo on compliant contacts, in three dimensions: a truth that shares no impact law, no modes and no events with a
prediction.

Stiff springs with dampers and friction move the unit, and lashings that bear no more than their MSL (`stepping`). Its
impacts are read from the gaps and velocities of its points alone: one begins where points close that were open, and is
over when the normal forces have fallen to those of rest. A unit on its feet is left at rest until the part of its
margins that is used up, by a rough rule, is near one; from there on the steps tell what it does.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, cos, inf, sin, sqrt
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ...errors import InputError
from ...mechanics.compiled import door
from ...mechanics.impact import solve_impact
from ...mechanics.motion import End, PlanarState
from ...mechanics.types import Contact, Mode, Twist, TwoPointBody
from ...stamps import NANOSECONDS
from ..sensors import Poses, rotated, rotations
from ..truth import TrueImpact, TrueOnset, border_of
from . import stepping
from .cargo import SPAN, CargoUnit, Span
from .motion import DeckMotion

STEP: Final = 1e-4
"""s, where nothing strikes."""

CHUNK: Final = 0.5
"""Seconds that are followed at once while a unit moves."""

KEPT: Final = 10
"""One in so many states is kept."""

STIFFNESS: Final = 1e6
"""N/m of each contact for each kg: the weight sinks in by micrometres, an impact takes about a millisecond."""

NODES: Final = 24
"""Moments in the shortest swing of the deck at which it is asked what is felt; cubic splines go through them."""

DAMPING: Final = 8.0
"""Of a contact, as part of the critical one: what strikes keeps 0.4 % of its speed."""

NEAR: Final = 0.8
"""Part of the margins used up from which a unit is followed."""

LOOKS: Final = 0.05
"""s between the moments at which they are looked at."""

FEET: Final = 1e-6
"""m: points that are as low as the lowest one, and farther from each other."""

ACROSS_ONLY: Final = 0.05
"""Part of a turn about the deck's x axis below which the other turns are none."""

RESTED: Final = 0.1
"""Seconds without slip or lift after which a unit stands."""

SLOWEST: Final = 1e-3
"""Approach in m/s of the slowest contact that counts as striking."""

OPEN: Final = 2e-3
"""Seconds that a contact must have been open before it strikes."""

TOGETHER: Final = 5e-3
"""Points that close within so many seconds strike together."""

LONGEST: Final = 0.02
"""Seconds after which an impact is over in any case."""

PRESSED: Final = 2.0
"""Weights with which the contacts press no more when an impact is over."""

PART: Final = 0.02
"""A velocity above this part of the approach is one: out of the deck the contact opens, along it it slips."""

STRETCH: Final = 0.01
"""Of its length, by a lashing of unknown stiffness under its MSL."""

HELD_DAMPING: Final = 0.1
"""Of a lashing, as part of the critical one."""

FAR: Final = 1e4
"""m to the anchor of a lashing that stands for a chock: so far away it always pulls the same way."""

SHIFTED: Final = 0.1
"""m from where it stood: a unit that is held has moved, whatever still holds it."""

SETTLES: Final = 6
"""Looks before a unit comes near, in which the springs take its load: a unit that is high and narrow sways on them."""


class _Stretch(NamedTuple):
    """Steps of a motion at `times` (k,): `rows` (k, 15) and `marks` (k, 2, n) as in `stepping`."""

    times: NDArray[np.float64]
    rows: NDArray[np.float64]
    marks: NDArray[np.int64]


class _States(NamedTuple):
    """States (k, 13) of a unit at `times` (k,): mass centre, quaternion and velocities in the deck's frame."""

    unit: CargoUnit
    times: NDArray[np.float64]
    rows: NDArray[np.float64]

    def at(self, times: Any) -> NDArray[np.float64]:
        """The states (13, n) at some times, linear between those that are kept."""
        found = np.array([np.interp(times, self.times, column) for column in self.rows.T])
        found[3:7] /= np.sqrt(np.square(found[3:7]).sum(0))
        return found

    def poses(self, times: NDArray[np.float64]) -> Poses:
        """The poses of the unit's frame, seen from the deck."""
        center, found = self.unit.mount.center, self.at(times)
        matrices = rotations(found[3:7].T)
        linear, angular = (rotated(matrices, part.T, back=True) for part in (found[7:10], found[10:]))
        return Poses(found[:3].T - matrices @ center, found[3:7].T, linear - np.cross(angular, center), angular)

    def across(self, times: Any) -> PlanarState:
        """The part of the motion across the deck, seen from the unit's foot."""
        _, y, z, qx, qy, qz, qw, _, vy, vz, spin, _, _ = self.at(times)
        foot_y, foot_z = self.unit.foot
        # Of a turn about x and one about z before it.
        angle = 2.0 * np.arctan2(np.copysign(np.hypot(qx, qy), qx * qw - qy * qz), np.hypot(qz, qw))
        return PlanarState(y - foot_y, z - foot_z, angle, vy, vz, spin)


def follow_compliant(unit: CargoUnit, deck: DeckMotion, duration: float, begin: float = 0.0) -> Iterator[Span]:
    """The motion of a unit on points from where it stands, one span after the other; as `cargo.follow`. InputError
    where it stands on a line.
    """
    return _Compliant(unit, deck).follow(duration, begin)


class _Compliant:
    def __init__(self, unit: CargoUnit, deck: DeckMotion) -> None:
        scene, half = unit.scene, 0.5 * unit.scene.yaw
        self.unit, self.deck, self.scene, self.inertia = unit, deck, scene, np.array(scene.inertia)
        self.points = np.array(scene.points) - np.array(scene.center_of_mass)
        feet = self.points[self.points[:, 2] <= self.points[:, 2].min() + FEET]
        if np.linalg.matrix_rank(feet - feet[0], tol=FEET) < 2:
            raise InputError(f"{unit.name} stands on a line and would fall; give it three contact points or more")
        stiffness = STIFFNESS * scene.mass
        damping = DAMPING * 2.0 * sqrt(stiffness * scene.mass / len(feet))
        numbers = [STEP, scene.height, scene.mass, scene.friction, scene.restitution, stiffness, damping]
        self.numbers = np.array([*numbers, *self.inertia.ravel(), *np.linalg.inv(self.inertia).ravel()])
        self.advance = door(stepping.advance)
        place = unit.mount.beside, unit.start.x + unit.foot[0], unit.start.y + unit.foot[1]
        c, s = cos(0.5 * unit.start.angle), sin(0.5 * unit.start.angle)
        turn = s * cos(half), -s * sin(half), c * sin(half), c * cos(half)
        self.y = np.array([*place, *turn, *[0.0] * 6])
        self.start, self.held = self.y[:3].copy(), self._holders(stiffness)
        self.work = np.zeros(11 * len(self.points) + 1)
        self.closed = self._gaps(self.y[None])[0] <= FEET
        self.opened = np.full(len(self.points), -inf)  # s, when
        self.moved, self.settled = -inf, -inf  # s, when it last did, and from when on that counts
        self.leans = unit.start.angle != 0.0

    def _holders(self, stiff: float) -> NDArray[np.float64]:
        """The lashings, and chocks as very long ones that pull a body away from them, as `stepping` has them."""
        found, matrix, center = [], rotations(self.y[None, 3:7])[0], self.y[:3]
        for lashing in self.scene.lashings:
            point = np.subtract(lashing.point, self.scene.center_of_mass)
            length = float(np.linalg.norm(center + matrix @ point - lashing.anchor))
            stiffness = lashing.stiffness or lashing.msl / (STRETCH * length)
            found.append((*point, *lashing.anchor, length - lashing.preload / stiffness, stiffness, lashing.msl))
        for chock in self.scene.chocks:
            anchor = np.add(chock.point, np.multiply(FAR, chock.normal))
            found.append((*matrix.T @ np.subtract(chock.point, center), *anchor, FAR, stiff, chock.strength))
        rows = np.array(found).reshape(-1, stepping.HOLDER - 1)
        return np.insert(rows, 8, HELD_DAMPING * 2.0 * np.sqrt(rows[:, 7] * self.scene.mass), axis=1)

    def _gives_way(self, rows: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether a lashing bears all it can at some states (k, 13), or the unit is far from where it stood."""
        points, anchors = self.held[:, :3], self.held[:, 3:6]
        ends = rows[:, None, :3] + np.einsum("tij,pj->tpi", rotations(rows[:, 3:7]), points)
        pulls = self.held[:, 7] * (np.linalg.norm(anchors - ends, axis=2) - self.held[:, 6])
        far = np.linalg.norm(rows[:, :3] - self.start, axis=1) > SHIFTED
        found: NDArray[np.bool_] = far | (pulls >= self.held[:, 9]).any(axis=1)
        return found

    def follow(self, duration: float, begin: float) -> Iterator[Span]:
        time, end = begin, End.TIME_UP
        while time < duration and end is End.TIME_UP:
            until = min(duration, time + SPAN)
            times = np.append(np.arange(time, until, LOOKS), until)
            over = np.flatnonzero((self._used(times) > NEAR) | self.leans)
            self.leans = False
            rested = float(times[max(0, over[0] - SETTLES)]) if len(over) else until
            if rested > time:
                self.y[7:] = 0.0
                yield self._span(time, np.array([time, rested]), np.stack([self.y, self.y]))
                time, self.settled = rested, rested + SETTLES * LOOKS
            while len(over) and time < duration and end is End.TIME_UP:
                before, stretch = self.y.copy(), self._steps(time, duration)
                if len(toppled := np.flatnonzero(rotations(stretch.rows[:, 3:7])[:, 2, 2] < 0.0)):
                    end, stretch = End.OVERTURNED, _Stretch._make(part[: int(toppled[0]) + 1] for part in stretch)
                kept = np.append(np.arange(KEPT - 1, len(stretch.times) - 1, KEPT), len(stretch.times) - 1)
                rows = np.concatenate([before[None], stretch.rows[kept, :13]])
                yield self._span(time, np.append(time, stretch.times[kept]), rows, stretch, end)
                time = float(stretch.times[-1])
                ahead = np.arange(time, time + CHUNK, LOOKS)
                if time - self.moved > RESTED and not (self._used(ahead) > NEAR).any():
                    break

    def _span(
        self,
        start: float,
        times: NDArray[np.float64],
        rows: NDArray[np.float64],
        stretch: _Stretch | None = None,
        end: End = End.TIME_UP,
    ) -> Span:
        states = _States(self.unit, times, rows)
        return Span(
            start=start,
            time=float(times[-1]),
            state=states.across,
            poses=states.poses,
            impacts=() if stretch is None else tuple(self._impacts(stretch)),
            onsets=() if stretch is None else tuple(self._onsets(stretch)),
            sums=(),
            end=end,
        )

    def _used(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """About how much of its margins a unit that stands uses at some times: by the box about its feet."""
        matrix, state = rotations(self.y[None, 3:7])[0], self.deck.at(times)
        arms = self.points @ matrix.T
        feet = arms[arms[:, 2] <= arms[:, 2].min() + 1e-3 * np.ptp(arms)]
        felt = state.felt_at(self.y[:3])
        turning = state.turning @ (matrix @ self.inertia @ matrix.T) / self.scene.mass
        along, down = felt[:, :2], np.maximum(-felt[:, 2], 1e-9)[:, None]
        slide = np.hypot(*along.T) / (max(self.scene.friction, 1e-9) * down[:, 0])
        # Where the deck must press for it to keep its turn: beyond the feet it tips.
        press = (-feet[:, 2].mean() * along + np.stack([-turning[:, 1], turning[:, 0]], axis=1)) / down
        low, high = np.minimum(feet[:, :2].min(0), -1e-9), np.maximum(feet[:, :2].max(0), 1e-9)
        used: NDArray[np.float64] = np.maximum(slide, np.maximum(press / high, press / low).max(axis=1))
        return used

    def _steps(self, start: float, duration: float) -> _Stretch:
        """The steps of a while, and of as much longer as it takes that no impact is cut off."""
        parts, time, n = list[_Stretch](), start, len(self.points)
        while not parts or (time < duration and self._closes(parts[-1])):
            end = min(duration, time + (CHUNK if not parts else 2.0 * LONGEST))
            steps = max(1, ceil((end - time) / STEP))
            self.numbers[0] = (end - time) / steps
            nodes = np.linspace(time, end, 4 + ceil((end - time) * NODES / self.deck.period))
            state = self.deck.at(nodes)
            felt = CubicSpline(nodes, np.hstack([state.gravity, state.poses.angular, state.turning]))
            told = felt(time + self.numbers[0] * (np.arange(steps) + 0.5)).ravel()
            most = steps * stepping.FINE
            rows, marks = np.empty(15 * most), np.empty(2 * n * most, np.int64)
            given = self.numbers, told, self.y, self.points.ravel(), self.held.ravel(), self.work
            count = self.advance(steps, n, *given, rows, marks)
            states, told = rows.reshape(-1, 15)[:count], marks.reshape(-1, 2, n)[:count]
            parts.append(_Stretch(np.append(time + states[:-1, 14], end), states, told))
            time = end
        return _Stretch(*map(np.concatenate, zip(*parts, strict=True)))

    def _gaps(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        up = rotations(rows[:, 3:7])[:, 2]
        gaps: NDArray[np.float64] = up @ self.points.T + rows[:, 2:3] - self.scene.height
        return gaps

    def _closes(self, stretch: _Stretch) -> bool:
        """Whether a point closes right before the end of a stretch."""
        closed = self._gaps(stretch.rows)[stretch.times > stretch.times[-1] - LONGEST - TOGETHER] <= 0.0
        return bool((closed[1:] & ~closed[:-1]).any())

    def _onsets(self, stretch: _Stretch) -> Iterator[TrueOnset]:
        """When a unit that stood begins to slide on all of its feet, or to stand on fewer than three.

        One that is held does so when what holds it gives way: until then it is only pulled tight.
        """
        presses, slips = stretch.marks.sum(axis=2).T
        slides, lifts = (slips == presses) & (presses > 0), presses < 3
        if len(self.held):
            gives_way = self._gives_way(stretch.rows[:, :13])
            slides, lifts = slides & gives_way, lifts & gives_way
        for k in np.flatnonzero((slides | lifts) & (stretch.times > self.settled)).tolist():
            time = float(stretch.times[k])
            if time - self.moved > RESTED:
                yield TrueOnset(round(time * NANOSECONDS), self.unit.name, bool(slides[k]), bool(lifts[k]))
            self.moved = time

    def _impacts(self, stretch: _Stretch) -> Iterator[TrueImpact]:
        """The impacts of a stretch, in order; which points are closed since when is kept up to date."""
        closed = self._gaps(stretch.rows) <= 0.0
        before = np.concatenate([self.closed[None], closed[:-1]])
        closings = []
        for k, i in np.argwhere(closed != before).tolist():
            if not closed[k, i]:
                self.opened[i] = stretch.times[k]
            elif stretch.times[k] - self.opened[i] > OPEN:
                closings.append((k, i))
        self.closed = closed[-1]
        while closings:
            first = closings[0][0]
            new = sorted({i for k, i in closings if stretch.times[k] - stretch.times[first] <= TOGETHER})
            old = [i for i in np.flatnonzero(closed[first]).tolist() if i not in new]
            closings = [one for one in closings if stretch.times[one[0]] - stretch.times[first] > TOGETHER]
            if (impact := self._impact(stretch, first, old, new)) is not None:
                yield impact

    def _impact(self, stretch: _Stretch, first: int, old: list[int], new: list[int]) -> TrueImpact | None:
        """The impact of some points that close at a step; None where they come too slowly."""
        load = stretch.rows[first : np.searchsorted(stretch.times, stretch.times[first] + LONGEST), 13]
        pressed = int((load > PRESSED).argmax())
        over = np.flatnonzero(load[pressed:] < PRESSED)
        last = first + (pressed + int(over[0]) if len(over) else len(load) - 1)
        rows = stretch.rows[[first, last]]
        matrices = rotations(rows[:, 3:7])
        arms = np.einsum("tij,pj->tpi", matrices, self.points)
        # Velocities (2, points, 3) right before and after it.
        moves = rows[:, None, 7:10] + np.cross(rows[:, None, 10:13], arms)
        approach = float(-moves[0, new, 2].mean())
        if approach <= SLOWEST:
            return None
        least, struck = PART * approach, arms[0, new].mean(0)
        after, slips = moves[1, :, 2], np.hypot(*moves[1, new, :2].mean(0)) > least
        stood = bool(old) and float(after[old].mean()) <= least
        tensors = matrices @ self.inertia @ matrices.swapaxes(1, 2)
        energies = 0.5 * self.scene.mass * np.square(rows[:, 7:10]).sum(1)
        energies += 0.5 * np.einsum("ti,tij,tj->t", rows[:, 10:13], tensors, rows[:, 10:13])
        vectors = [tuple(part) for row in rows.tolist() for part in (row[7:10], row[10:13])]
        return TrueImpact(
            stamp=round(float(stretch.times[first]) * NANOSECONDS),
            body=self.unit.name,
            mode=_mode(stood, float(after[new].mean()) <= least, bool(slips)),
            old=tuple(old),
            new=tuple(new),
            approach=approach,
            half_distance=float(np.linalg.norm(0.5 * (struck - arms[0, old].mean(0)) if old else struck)),
            energy_lost=float(energies[0] - energies[1]),
            linear_before=vectors[0],
            angular_before=vectors[1],
            linear_after=vectors[2],
            angular_after=vectors[3],
            border=self._border(rows[0], old, new),
        )

    def _border(self, row: NDArray[np.float64], old: list[int], new: list[int]) -> float:
        """As `border_of`, of a unit that turns about its edges along the deck; inf of another."""
        _, other = self.unit.contacts
        if np.hypot(row[11], row[12]) > ACROSS_ONLY * abs(row[10]) or not row[10]:
            return inf
        angle, body = _States(self.unit, np.zeros(1), row[None, :13]).across(0.0).angle, self.unit.body
        c, s = cos(angle), sin(angle)
        contacts = []
        for one in (body.old, body.new):
            assert one is not None
            x, y = c * one.x - s * one.y, s * one.x + c * one.y
            contacts.append(Contact(x, y, one.friction, (0.0, 1.0), one.restitution))
        if not set(new) & set(other):
            contacts.reverse()
        seen = TwoPointBody(body.mass, body.inertia, contacts[0] if old else None, contacts[1])
        return border_of(solve_impact(seen, Twist(float(row[8]), float(row[9]), float(row[10])), self.scene.law))


def _mode(old_stays: bool, new_stays: bool, slips: bool) -> Mode:
    if not new_stays:
        return Mode.BACK_PIVOT if old_stays else Mode.FLIGHT
    if old_stays:
        return Mode.SLIDE if slips else Mode.STOP
    return Mode.PIVOT_SLIDE if slips else Mode.PIVOT
