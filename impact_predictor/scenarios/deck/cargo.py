"""Cargo units on a moving deck: each in the deck's y-z plane, followed from event to event.

Units stand in a row along the deck and do not touch each other: what slides or topples meets none. A toppled unit's
motion ends there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from math import asin, atan2, cos, hypot, sin
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...mechanics.bodies import wedged
from ...mechanics.motion import End, PlanarState, RockingImpact, Trajectory, rock, standing
from ...mechanics.motion.support import MovingSupport
from ...mechanics.types import Contact, TwoPointBody, Vector
from ...prediction.planar import inertia_about
from ...prediction.scene import Scene
from ...prediction.types import Vector3
from ...stamps import NANOSECONDS
from ..sensors import ACROSS, Mount, Poses, poses
from ..truth import TrueImpact, TrueOnset, border_of, true_impact

ALONE: Final = "unit"
"""Frame of the unit of a scene file without `bodies`."""

SPAN: Final = 60.0
"""Seconds that are followed at once: what is kept of a motion does not grow with its length."""

NEAR: Final = 1e-6
"""Contact points that lie as near (m) lie at the same end of a unit."""

STILL: Final = "SS"
"""Both contacts closed and neither slips."""

_MOST_EVENTS: Final = 100_000

_DIGITS: Final = 9
_MOST_KNOWN: Final = 4096


class CargoUnit(NamedTuple):
    """A cargo unit in the deck's plane, planar x to port and planar y up.

    `start` is its state on both contacts, seen from the place `foot` of the deck (y, z); `mount` tells how its frame
    moves with it; `contacts` are the indices of the scene's points, or edges, that the two contacts stand for.
    """

    name: str
    scene: Scene
    body: TwoPointBody
    start: PlanarState
    foot: Vector
    mount: Mount
    contacts: tuple[tuple[int, ...], tuple[int, ...]]


class Span(NamedTuple):
    """A part of a motion, from `start` to `time` (s).

    `poses` tells those of the unit's frame at an array of times, seen from the deck, and `state` the mass centre's in
    the transverse plane, seen from the unit's foot; `impacts` and `onsets` are those in it, `sums` the times at which
    accumulating impacts ended; `end` is how the motion ended, TIME_UP where it may go on; the
    unit `lies` if it has toppled before.
    """

    start: float
    time: float
    state: Callable[[NDArray[np.float64]], PlanarState]
    poses: Callable[[NDArray[np.float64]], Poses]
    impacts: tuple[TrueImpact, ...]
    onsets: tuple[TrueOnset, ...]
    sums: tuple[float, ...]
    end: End
    lies: bool = False


def units_of(scenes: Mapping[str, Scene]) -> list[CargoUnit]:
    """The units of a parameter file's scenes, see `prediction.scene.scenes_of`; InputError where a unit cannot be
    simulated in the deck's plane.
    """
    return [unit_of(name or ALONE, scene) for name, scene in scenes.items()]


def unit_of(name: str, scene: Scene) -> CargoUnit:
    """The unit of one scene, standing where its `place` and `yaw` tell, on the deck; InputError where it cannot be
    simulated in the deck's plane.
    """
    if hypot(scene.normal[0], scene.normal[1]) > NEAR or scene.normal[2] <= 0.0:
        raise InputError(
            f"the support.normal of {name} is {list(scene.normal)}; a deck is simulated with [0.0, 0.0, 1.0]"
        )
    return _drum(name, scene) if scene.radius > 0.0 else _box(name, scene)


def _box(name: str, scene: Scene) -> CargoUnit:
    """A unit that stands on points of it: of its lowest ones those furthest to starboard and to port."""
    if len(scene.points) < 2:
        raise InputError(f"{name} has no contact points; give body.contact_points in the parameter file")
    center = _ahead(scene.center_of_mass, scene.yaw)
    arms = [_ahead(point, scene.yaw) for point in scene.points]
    lowest = min(z for _, _, z in arms)
    low = [k for k, (_, _, z) in enumerate(arms) if z - lowest <= NEAR]
    ends = []
    for extreme in (min(arms[k][1] for k in low), max(arms[k][1] for k in low)):
        end = tuple(k for k in low if abs(arms[k][1] - extreme) <= NEAR)
        along = [arms[k][0] - center[0] for k in end]
        if not min(along) - NEAR <= 0.0 <= max(along) + NEAR:
            raise InputError(
                f"{name} would turn out of the deck's y-z plane, in which it is simulated; "
                "give a place.yaw with which two of its lower edges lie along the deck's x axis"
            )
        ends.append(end)
    old, new = ends
    if not arms[old[0]][1] < arms[new[0]][1]:
        raise InputError(f"{name} stands on one line along the deck's x axis; give it contact points beside each other")
    on_edges = min(map(len, ends)) > 1
    contacts = [
        Contact(arms[end[0]][1] - center[1], arms[end[0]][2] - center[2], scene.friction, (0.0, 1.0), scene.restitution)
        for end in ends
    ]
    body = TwoPointBody(scene.mass, _inertia(scene, on_edges), contacts[0], contacts[1])
    y = scene.place[1] + arms[old[0]][1]
    mount = Mount(scene.place[0] + center[0], scene.yaw, scene.center_of_mass)
    return CargoUnit(
        name=name,
        scene=scene,
        body=body,
        start=standing(body, 0.0, x=y),
        foot=(0.0, scene.height),
        mount=mount,
        contacts=(old, new),
    )


def _drum(name: str, scene: Scene) -> CargoUnit:
    """A cylinder along the deck that lies on two of the support's edges."""
    if len(scene.edges) != 2:
        raise InputError(f"{name} lies on {len(scene.edges)} edges; give support.edges two points, one of each chock")
    edges = sorted(range(2), key=lambda k: scene.edges[k][1])
    (_, y, z), (_, other_y, other_z) = (scene.edges[k] for k in edges)
    across, up = other_y - y, other_z - z
    half, radius = 0.5 * hypot(across, up), scene.radius
    if not across > 0.0 or half >= radius:
        raise InputError(
            f"the edges under {name} are {2.0 * half:g} m apart; a drum of radius {radius:g} m falls through"
        )
    # Angles from the perpendicular of the line between the edges, which leans by `tilt`.
    tilt, gamma = atan2(up, across), asin(half / radius)
    body = wedged(
        scene.mass, _inertia(scene, True), radius, gamma - tilt, gamma + tilt, scene.friction, scene.restitution
    )
    assert body.old is not None
    body = body._replace(old=body.old._replace(restitution=scene.restitution))
    mount = Mount(scene.place[0] + scene.center_of_mass[0], scene.yaw, scene.center_of_mass)
    return CargoUnit(
        name=name,
        scene=scene,
        body=body,
        start=standing(body, 0.0),
        foot=(y, z),
        mount=mount,
        contacts=((edges[0],), (edges[1],)),
    )


def _inertia(scene: Scene, blocked: bool) -> float:
    """Inertia about the deck's x axis."""
    return inertia_about(scene, (cos(scene.yaw), -sin(scene.yaw), 0.0), blocked)


def _ahead(vector: Vector3, yaw: float) -> Vector3:
    """A vector of the body frame in the deck's, while the unit stands."""
    x, y, z = vector
    c, s = cos(yaw), sin(yaw)
    return c * x - s * y, s * x + c * y, z


def follow(unit: CargoUnit, support: MovingSupport, duration: float, begin: float = 0.0) -> Iterator[Span]:
    """The motion of a unit that stands at the time `begin`, one span after the other, until `duration` (s).

    `support` has its origin at the unit's foot.
    """
    time, state, end, rested, law = begin, unit.start, End.TIME_UP, True, unit.scene.law
    borders: dict[tuple[float, ...], float] = {}
    while time < duration and end is End.TIME_UP:
        # Times of a motion are told to the last digit only where they count from near it.
        run = rock(unit.body, state, _later(support, time), law, min(SPAN, duration - time), max_events=_MOST_EVENTS)
        impacts = [
            true_impact(strike, unit.name, ACROSS, 0.0, unit.contacts, remembered_border(strike, borders), time)
            for strike in run.impacts
        ]
        until = min(time + run.time, duration)
        yield Span(
            start=time,
            time=until,
            state=partial(_state_at, run, time),
            poses=partial(_poses_at, unit, run, time),
            impacts=tuple(impacts),
            onsets=tuple(_onsets(unit.name, run, rested, time)),
            sums=tuple(time + one.time for one in run.accumulations),
            end=run.end,
        )
        rested = run.states(run.time) == STILL
        state, time, end = run.state(run.time), until, run.end


def _later(support: MovingSupport, since: float) -> MovingSupport:
    """The support with its time counted from `since` in s."""
    return MovingSupport(lambda time: support.motion(since + time), support.period, support.gravity)


def _state_at(run: Trajectory, since: float, times: NDArray[np.float64]) -> PlanarState:
    return run.state(times - since)


def _poses_at(unit: CargoUnit, run: Trajectory, since: float, times: NDArray[np.float64]) -> Poses:
    state, (y, z) = run.state(times - since), unit.foot
    return poses(state._replace(x=state.x + y, y=state.y + z), ACROSS, unit.mount)


def _onsets(name: str, run: Trajectory, rested: bool, since: float) -> Iterator[TrueOnset]:
    """Where a unit left its rest; `rested`: whether it was at rest right before the run."""
    for phase in run.phases:
        still = phase.states == STILL
        if rested and not still:
            slides, lifts = "+" in phase.states or "-" in phase.states, "O" in phase.states
            yield TrueOnset(round((since + phase.start) * NANOSECONDS), name, slides, lifts)
        rested = still


def remembered_border(strike: RockingImpact, known: dict[tuple[float, ...], float]) -> float:
    """How far an impact is from another mode, see `truth.border_of`, from those `known` where it is one of them.

    A unit that turns about one contact until the other strikes does it with the same twist each time, but for its size,
    on which no mode depends.
    """
    before = strike.outcome.before
    assert before is not None
    if strike.old is None or before.omega == 0.0:
        return border_of(strike.outcome)
    key = (strike.old, round(before.vx / before.omega, _DIGITS), round(before.vy / before.omega, _DIGITS))
    if key not in known:
        if len(known) >= _MOST_KNOWN:
            known.clear()
        known[key] = border_of(strike.outcome)
    return known[key]
