"""The rimless wheel in closed form: its steady rolling, how fast it gets there, the friction it needs, its stop.

McGeer, "Passive dynamic walking", Int. J. Robotics Research 9(2), 1990; Coleman, Chatterjee and Ruina, "Motions of a
rimless spoked wheel: a simple three-dimensional system with impacts", Dynamics and Stability of Systems, 1997, for its
motion in one plane. Legs that do not slip; the inertia may be 0, that of a point mass.
"""

from __future__ import annotations

from math import cos, inf, sin, sqrt
from typing import NamedTuple

from ..mechanics.motion.pivot import turn
from .wheel import Hub, Wheel


class Steady(NamedTuple):
    """Steady rolling: rates (rad/s) right before and after an impact, time of a step (s), speed of the hub (m/s)."""

    before: float
    after: float
    time: float
    speed: float


def kept(hub: Hub, ahead: float) -> float:
    """Part of the rate that an impact leaves, the legs `ahead` rad behind and ahead of the normal; with its sign.

    The angular momentum about the new foot stays: (J + m l^2) after = (J + m l^2 cos 2 ahead) before.
    """
    square = hub.mass * hub.leg * hub.leg
    return (hub.inertia + square * cos(2.0 * ahead)) / (hub.inertia + square)


def gained(hub: Hub, start: float, end: float) -> float:
    """What the square of the rate (rad^2/s^2) gains while the standing leg turns from one angle to another."""
    inertia = hub.inertia + hub.mass * hub.leg * hub.leg
    # cos(start + slope) - cos(end + slope), in which nothing cancels.
    fall = 2.0 * sin(0.5 * (start + end) + hub.slope) * sin(0.5 * (end - start))
    return 2.0 * hub.mass * hub.gravity * hub.leg * fall / inertia


def passes(hub: Hub, start: float, rate: float) -> bool:
    """Whether a leg that leans by `start` and turns forwards at `rate` comes over its highest place."""
    return start >= -hub.slope or rate * rate + gained(hub, start, -hub.slope) > 0.0


def steady(wheel: Wheel) -> Steady | None:
    """The rolling ahead in which each step is as the one before; None where the wheel stops.

    From any rate with which it rolls on, the squares of the rates come nearer to it by kept^2 with each step.
    """
    hub, alpha = wheel.hub, wheel.alpha
    part, gain = kept(hub, alpha), gained(hub, -alpha, alpha)
    if part <= 0.0 or gain <= 0.0:
        return None
    before = sqrt(gain / (1.0 - part * part))
    if not passes(hub, -alpha, part * before):
        return None
    time = step_time(hub, -alpha, alpha, part * before)
    return Steady(before, part * before, time, wheel.step / time)


def downhill(wheel: Wheel) -> Wheel:
    """The wheel seen from the side from which it rolls ahead, not backwards, down its slope."""
    return wheel._replace(hub=wheel.hub._replace(slope=abs(wheel.hub.slope)))


def step_time(hub: Hub, start: float, end: float, rate: float) -> float:
    """Time (s) in which the leg turns from one angle to a later one, at `rate` at first; inf where it turns back."""
    if not passes(hub, start, rate):
        return inf
    arm = hub.leg * sin(start), hub.leg * cos(start)
    gravity = hub.gravity * sin(hub.slope), -hub.gravity * cos(hub.slope)
    return turn(arm, -rate, (end - start, inf), hub.inertia / hub.mass, inf, gravity).time


def impact_friction(hub: Hub, ahead: float) -> float:
    """The smallest friction coefficient with which the new foot does not slip in the impact.

    The impulse leans from the leg towards the normal by delta, tan(delta) = tan(ahead) J / (J + m l^2): it turns the
    hub. That of a point mass lies along the leg: it needs tan(ahead).
    """
    square = hub.leg * hub.leg
    return square * sin(ahead) * cos(ahead) / (hub.inertia / hub.mass + square * cos(ahead) ** 2)


def stance_friction(hub: Hub, angle: float, rate: float) -> float:
    """The smallest friction coefficient with which the standing foot does not slip, at an angle and a rate.

    The reaction along the leg is m (g cos(angle + slope) - l rate^2), and across it, against gravity's turning,
    m g sin(angle + slope) J / (J + m l^2): none for a point mass, whose foot needs tan|angle| at any rate. With inertia
    it depends on the rate. Right after an impact at angle -a it needs more than the impact did where
    sin(a - slope) < tan(a) (cos(a - slope) - l rate^2 / g); before the next one a fast wheel may slip backwards. inf
    where the ground would have to pull.
    """
    lean, square = angle + hub.slope, hub.mass * hub.leg * hub.leg
    along = hub.gravity * cos(lean) - hub.leg * rate * rate
    across = -hub.gravity * sin(lean) * hub.inertia / (hub.inertia + square)
    normal = along * cos(angle) - across * sin(angle)
    return abs(along * sin(angle) + across * cos(angle)) / normal if normal > 0.0 else inf


def least_friction(wheel: Wheel) -> float:
    """The smallest friction coefficient with which nothing slips in steady rolling: of the impact or of the stance.

    inf where none is enough, for the ground would have to pull: the wheel slips or takes off. ValueError where the
    wheel stops.
    """
    rolling = steady(wheel)
    if rolling is None:
        raise ValueError("the wheel stops: it has no steady rolling")
    hub, alpha = wheel.hub, wheel.alpha
    looks = [alpha * (k / 100.0 - 1.0) for k in range(201)]
    stance = [stance_friction(hub, angle, sqrt(rolling.after**2 + gained(hub, -alpha, angle))) for angle in looks]
    return max(impact_friction(hub, alpha), *stance)
