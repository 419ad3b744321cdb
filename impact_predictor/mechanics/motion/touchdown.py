"""The next touchdown of a rigid planar body over a fixed straight support.

The support is the line y = 0, x along it and y out of it; gravity is uniform and may have a part along the support (a
slope). A body moves in phases, and each ends with an event:

- flight: the mass centre is thrown, the angular velocity stays; the first point to reach the support strikes;
- turning about a stance contact that sticks (`pivot`);
- sliding over a stance contact that slips (`slip`).

Where a slipping contact jams (Painleve: no finite reaction keeps it on the support) its slip stops at once by a
tangential impact, and the body goes on turning about it.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

from ..types import Vector
from .events import ROUNDING, SLIP_ROUNDING, Event, first_descent
from .pivot import FULL_TURN, turn
from .slip import slide
from .support import PlanarState

_MAX_PHASES = 32
"""More has only a body that hangs through its support and swings there."""


class MotionKind(IntEnum):
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
    motion: MotionKind


_Arm = tuple[float, float, float, int]
"""A point seen from the stance contact at angle 0: its direction in rad from +x and (clockwise) from -x, its distance
in m, and its index."""


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
    `horizon` in s; `tolerance` the error aimed at where a stance slips, relative to the time and the angular velocity
    (all else is exact). Numbers must be finite (but friction and horizon) and friction not negative.

    A stance point is taken to stand: its gap and its normal velocity count as rounding and are dropped, and so is a
    tangential velocity within 1e-12 of the speeds that it is the difference of. A point that is on the support or below
    it strikes at time 0 when it moves down, and after it has risen otherwise. A body at rest on its points, or
    balanced, has no touchdown. Never raises and never returns NaN.
    """
    if stance is None:
        return _fly(state, points, gravity, horizon)
    # Numbers of numpy would compare to its booleans, with which nothing can be counted.
    rho_squared, friction, horizon, gravity = float(rho_squared), float(friction), float(horizon), _floats(gravity)
    state, points = PlanarState(*map(float, state)), tuple([_floats(point) for point in points])
    foot_x, foot_y = points[stance]
    arms: list[_Arm] = []
    for index, (x, y) in enumerate(points):
        if x != foot_x or y != foot_y:
            x, y = x - foot_x, y - foot_y
            arms.append((math.atan2(y, x), math.atan2(y, -x), math.hypot(x, y), index))
    start, turned, angle, omega, time = state.angle, 0.0, state.angle, state.omega, 0.0
    arm_x, arm_y = _from_contact(foot_x, foot_y, angle)
    contact_x = state.x - arm_x
    slip = state.vx + omega * arm_y
    if friction == math.inf or abs(slip) <= SLIP_ROUNDING * (abs(state.vx) + abs(omega) * (abs(foot_x) + abs(foot_y))):
        slip = 0.0
    direction = (slip > 0.0) - (slip < 0.0)

    for _ in range(_MAX_PHASES):
        travel, next_points = _ahead(arms, start, turned)
        if direction:
            drag, left = direction * friction, horizon - time
            phase = slide((arm_x, arm_y), omega, slip, drag, travel, rho_squared, gravity, left, tolerance)
        else:
            phase = turn((arm_x, arm_y), omega, travel, rho_squared, friction, gravity)
        time += phase.time
        if phase.event is Event.NEVER or not time <= horizon:
            break
        turned += phase.turned
        angle, omega, slip, contact_x = start + turned, phase.omega, phase.slip, contact_x + phase.moved
        arm_x, arm_y = _from_contact(foot_x, foot_y, angle)
        vx, vy = slip - omega * arm_y, omega * arm_x
        now = PlanarState(x=contact_x + arm_x, y=arm_y, angle=angle, vx=vx, vy=vy, omega=omega)
        motion = MotionKind.SLIDING if direction else MotionKind.TURNING
        if phase.event is Event.TOUCHES:
            return Fall(time=time, point=next_points[phase.direction > 0], state=now, motion=motion)
        if phase.event is Event.LIFTS:
            fall = _fly(now, points, gravity, horizon - time, stance)
            return fall._replace(time=time + fall.time, state=state if fall.point < 0 else fall.state)
        if phase.event is Event.TURNS_BACK:
            continue
        start, turned = angle, 0.0
        if phase.event is Event.JAMS:
            # The impulse acts at the contact, so the angular momentum about it stays.
            omega -= arm_y * slip / (rho_squared + arm_x * arm_x + arm_y * arm_y)
        direction, slip = (phase.event is Event.SLIPS) - (phase.event is Event.SLIPS_BACK), 0.0
    motion = MotionKind.SLIDING if direction else MotionKind.TURNING
    return Fall(time=math.inf, point=-1, state=state, motion=motion)


def _from_contact(foot_x: float, foot_y: float, angle: float) -> Vector:
    """The mass centre seen from the stance contact, in the world's axes."""
    sine, cosine = math.sin(angle), math.cos(angle)
    return foot_y * sine - foot_x * cosine, -foot_x * sine - foot_y * cosine


def _ahead(arms: list[_Arm], start: float, turned: float) -> tuple[Vector, tuple[int, int]]:
    """How far in rad the body turns clockwise and counter-clockwise until the next point touches, and which points.

    A point touches when the line from the contact to it lies along the support; one that touches already is 0 away. Of
    points on one such line the farthest strikes. The body's angle is start + turned, in two parts because a body that
    rises from the support and falls back may turn by less than the rounding of its angle.
    """
    rounding = ROUNDING * (abs(start) + math.pi)
    back, forth, back_length, forth_length, back_point, forth_point = math.inf, math.inf, 0.0, 0.0, -1, -1
    for bearing, bearing_back, length, point in arms:
        travel = _away(bearing + start, turned, rounding)
        if travel < back - rounding or (travel <= back + rounding and length > back_length):
            back, back_length, back_point = travel, length, point
        travel = _away(bearing_back - start, -turned, rounding)
        if travel < forth - rounding or (travel <= forth + rounding and length > forth_length):
            forth, forth_length, forth_point = travel, length, point
    return (back, forth), (back_point, forth_point)


def _away(travel: float, turned: float, rounding: float) -> float:
    """The turn until a point touches, less what is turned already."""
    travel %= FULL_TURN
    if travel > 1.5 * math.pi:
        travel -= FULL_TURN  # below the support and moving down
    if -rounding <= travel <= rounding:
        travel = 0.0
    travel += turned
    return travel if travel > 0.0 else 0.0


def _fly(
    state: PlanarState, points: tuple[Vector, ...], gravity: Vector, horizon: float, leaving: int | None = None
) -> Fall:
    """The first point to reach the support while the mass centre is thrown; one may be leaving it just now."""
    x, y, angle, vx, vy, omega = state
    sine, cosine = math.sin(angle), math.cos(angle)
    time, struck = math.inf, -1
    for index, (point_x, point_y) in enumerate(points):
        sinusoid = point_x * sine + point_y * cosine, point_x * cosine - point_y * sine, omega
        strikes = first_descent(y, vy, gravity[1], (sinusoid,), min(time, horizon), index == leaving)
        if strikes < time:
            time, struck = strikes, index
    if struck < 0:
        return Fall(time=time, point=struck, state=state, motion=MotionKind.FLIGHT)
    gx, gy = gravity
    now = PlanarState(
        x=x + (vx + 0.5 * gx * time) * time,
        y=y + (vy + 0.5 * gy * time) * time,
        angle=angle + omega * time,
        vx=vx + gx * time,
        vy=vy + gy * time,
        omega=omega,
    )
    return Fall(time=time, point=struck, state=now, motion=MotionKind.FLIGHT)


def _floats(vector: Vector) -> Vector:
    x, y = vector
    return float(x), float(y)
