"""The next touchdown of a rigid planar body over a fixed straight support.

The support is the line y = 0, x along it and y out of it; gravity is uniform and may have a part along the support (a
slope). A body moves in stretches, and each ends with an event:

- flight: the mass centre is thrown, the angular velocity stays; the first point to reach the support strikes;
- turning about a stance contact that sticks (`turning_stance`);
- sliding over a stance contact that slips (`sliding_stance`).

Where a slipping contact jams (Painleve: no finite reaction keeps it on the support) its slip stops at once by a
tangential impact, and the body goes on turning about it.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

from .first_root import first_descent
from .sliding_stance import slide
from .stretch import End
from .turning_stance import turn
from .types import Vector

_ROUNDING = 8.0 * 2.0**-52
"""A few units in the last place of a value that is a sum of a few terms."""
_FULL_TURN = 2.0 * math.pi
_SLIP_ROUNDING = 1e-12
"""A slip this small, relative to the speeds it is the difference of, is none: states come through conversions."""
_MAX_STRETCHES = 32
"""More has only a body that hangs through its support and swings there."""


class PlanarState(NamedTuple):
    """Place of the mass centre (m), angle (rad), its velocity (m/s) and angular velocity (rad/s), CCW positive."""

    x: float
    y: float
    angle: float
    vx: float
    vy: float
    omega: float


class Motion(IntEnum):
    """How a body moves."""

    FLIGHT = 0
    """No contact stands."""
    TURNING = 1
    """The stance contact sticks."""
    SLIDING = 2
    """The stance contact slips."""


class Fall(NamedTuple):
    """The next touchdown.

    `time` in s from the given state, inf when there is none within the horizon; `point` the index of the one that
    strikes, or -1; `state` at the touchdown (the given state when there is none); `motion` that led to it.
    """

    time: float
    point: int
    state: PlanarState
    motion: Motion


class _Arm(NamedTuple):
    """A point seen from the stance contact at angle 0: its direction in rad from +x and (clockwise) from -x."""

    bearing: float
    bearing_back: float
    length: float
    point: int


def next_touchdown(
    state: PlanarState,
    points: tuple[Vector, ...],
    stance: int | None,
    rho_squared: float,
    friction: float,
    gravity: Vector = (0.0, -9.81),
    horizon: float = 10.0,
    tolerance: float = 1e-10,
) -> Fall:
    """When, where and with which velocities the body touches the support next.

    `points` are the contact points (x, y) in m relative to the mass centre at angle 0; `stance` is the index of the
    one that stands on the support, None in flight; `rho_squared` = inertia / mass in m^2; `friction` is the stance's
    coefficient: 0 slips freely, inf holds the stance like a hinge, which neither slips nor lifts; `gravity` in m/s^2;
    `horizon` in s; `tolerance` the error allowed to each step of a stance that slips, relative to the turning in it
    (all else is exact). Numbers must be finite (but friction and horizon) and friction not negative.

    A stance point is taken to stand: its gap and its normal velocity count as rounding and are dropped, and so is a
    tangential velocity within 1e-12 of the speeds that it is the difference of. A point that is on the support or below
    it strikes at time 0 when it moves down, and after it has risen otherwise. A body at rest on its points, or
    balanced, has no touchdown. Never raises and never returns NaN.
    """
    if stance is None:
        return _fly(state, points, gravity, horizon)
    foot = points[stance]
    arms = tuple(
        _Arm(math.atan2(y, x), math.atan2(y, -x), math.hypot(x, y), index)
        for index, (x, y) in enumerate((x - foot[0], y - foot[1]) for x, y in points)
        if x or y
    )
    start, turned, angle, omega, time = state.angle, 0.0, state.angle, state.omega, 0.0
    arm_x, arm_y = _from_contact(foot, angle)
    contact_x = state.x - arm_x
    slip = state.vx + omega * arm_y
    if friction == math.inf or abs(slip) <= _SLIP_ROUNDING * (abs(state.vx) + abs(omega) * math.hypot(*foot)):
        slip = 0.0
    direction = (slip > 0.0) - (slip < 0.0)

    for _ in range(_MAX_STRETCHES):
        next_points = _ahead(arms, start, turned, -1.0), _ahead(arms, start, turned, 1.0)
        travel = next_points[0][0], next_points[1][0]
        if direction:
            drag = direction * friction
            left = horizon - time
            stretch = slide((arm_x, arm_y), omega, slip, drag, travel, rho_squared, gravity, left, tolerance)
        else:
            stretch = turn((arm_x, arm_y), omega, travel, rho_squared, friction, gravity)
        time += stretch.time
        if stretch.end is End.NEVER or not time <= horizon:
            break
        turned += stretch.turned
        angle, omega, slip, contact_x = start + turned, stretch.omega, stretch.slip, contact_x + stretch.moved
        arm_x, arm_y = _from_contact(foot, angle)
        now = PlanarState(contact_x + arm_x, arm_y, angle, slip - omega * arm_y, omega * arm_x, omega)
        motion = Motion.SLIDING if direction else Motion.TURNING
        if stretch.end is End.TOUCHES:
            return Fall(time, next_points[stretch.direction > 0][1], now, motion)
        if stretch.end is End.LIFTS:
            fall = _fly(now, points, gravity, horizon - time, stance)
            return fall._replace(time=time + fall.time, state=state if fall.point < 0 else fall.state)
        if stretch.end is End.TURNS:
            continue
        start, turned = angle, 0.0
        if stretch.end is End.JAMS:
            # The impulse acts at the contact, so the angular momentum about it stays.
            omega -= arm_y * slip / (rho_squared + arm_x * arm_x + arm_y * arm_y)
        direction, slip = (stretch.direction if stretch.end is End.SLIPS else 0), 0.0
    return Fall(math.inf, -1, state, Motion.SLIDING if direction else Motion.TURNING)


def _from_contact(foot: Vector, angle: float) -> Vector:
    """The mass centre seen from the stance contact, in the world's axes."""
    sine, cosine = math.sin(angle), math.cos(angle)
    return foot[1] * sine - foot[0] * cosine, -foot[0] * sine - foot[1] * cosine


def _ahead(arms: tuple[_Arm, ...], start: float, turned: float, direction: float) -> tuple[float, int]:
    """How far in rad the body turns until the next point touches, and which; 0 for one that touches already.

    A point touches when the line from the contact to it lies along the support. Of points on one such line the farthest
    strikes. The body's angle is start + turned, in two parts because a body that rises from the support and falls back
    may turn by less than the rounding of its angle.
    """
    rounding = _ROUNDING * (abs(start) + math.pi)
    nearest, length, struck = math.inf, 0.0, -1
    for arm in arms:
        travel = (arm.bearing + start if direction < 0.0 else arm.bearing_back - start) % _FULL_TURN
        if travel > 1.5 * math.pi:
            travel -= _FULL_TURN  # below the support and moving down
        if abs(travel) <= rounding:
            travel = 0.0
        travel = max(0.0, travel - direction * turned)
        if travel < nearest - rounding or (travel <= nearest + rounding and arm.length > length):
            nearest, length, struck = travel, arm.length, arm.point
    return nearest, struck


def _fly(
    state: PlanarState, points: tuple[Vector, ...], gravity: Vector, horizon: float, leaving: int | None = None
) -> Fall:
    """The first point to reach the support while the mass centre is thrown; one may be leaving it just now."""
    x, y, angle, vx, vy, omega = state
    sine, cosine = math.sin(angle), math.cos(angle)
    time, struck = math.inf, -1
    for index, (point_x, point_y) in enumerate(points):
        wave = point_x * sine + point_y * cosine, point_x * cosine - point_y * sine, omega
        strikes = first_descent(y, vy, gravity[1], (wave,), min(time, horizon), index == leaving)
        if strikes < time:
            time, struck = strikes, index
    if struck < 0:
        return Fall(time, struck, state, Motion.FLIGHT)
    return Fall(
        time,
        struck,
        PlanarState(
            x + (vx + 0.5 * gravity[0] * time) * time,
            y + (vy + 0.5 * gravity[1] * time) * time,
            angle + omega * time,
            vx + gravity[0] * time,
            vy + gravity[1] * time,
            omega,
        ),
        Motion.FLIGHT,
    )
