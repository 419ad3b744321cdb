"""A body that turns over a stance contact which slips: one stretch of it, with one direction of slip.

The contact stays on the support (y = 0) and friction is T = -drag N with drag = friction * sign(slip). With the arm
(x, y) from the contact to the mass centre, per unit of mass:

    along the support   x_C'' = gx - drag N
    normal to it        y_C'' = gy + N,  y_C = y
    rotation            rho^2 alpha = -N (x + drag y)

so that (rho^2 + x (x + drag y)) alpha = (omega^2 y + gy) (x + drag y). The angle of the next touchdown is known, so the
motion is integrated over the angle (`sliding_sweep`), in one sweep where that is accurate enough and nothing else
happens. N has the sign of -(omega^2 y + gy) while the bracket is positive.
"""

from __future__ import annotations

import math

from .sliding_events import Slip
from .sliding_sweep import Pose, Sweep, pose_at, sweep
from .stretch import End, Stretch
from .types import Vector

_WIDEST = 1.5
"""rad in one sweep: less than half a turn, in which an arc tangent is unique."""
_GROWTH = 1000.0
"""How far in one sweep a body leaves its balance, relative to how far it is from there: more drowns the start."""
_NO_ENERGY = 1e-40
"""rad. A motion is at rest that gets its energy within less."""
_BEYOND = 1.2
"""How far a sweep goes to find the end of a slip, relative to where it is expected."""
_MAX_SWEEPS = 200
"""Several times what the longest slides take."""
_SMALLEST = 1e-10
"""Relative to the first sweep. Where shorter ones are refused, no smooth motion goes on."""
_ALLOWED, _ORDER = 25.0, 0.6
"""The error of the polynomials through the nodes that keeps a tolerance, as their factor on its power: the integrals
converge faster. Found by trial over thousands of bodies."""
_NEWTON_STEPS = 4
"""More than Newton's method needs from a cubic through the nodes."""
_FASTEST = 100.0
"""Factor on a sweep after one that is better than it need be."""
_SHORTER = 0.4
"""Factor on a sweep that fails."""


def slide(
    arm: Vector,
    omega: float,
    slip: float,
    drag: float,
    travel: Vector,
    rho_squared: float,
    gravity: Vector,
    horizon: float,
    tolerance: float,
) -> Stretch:
    """Follow a slipping stance until its first event.

    `arm` from the stance contact to the mass centre in m; `slip` velocity of the contact in m/s; `drag` the friction
    coefficient with the sign of the slip (which is its direction where `slip` is still 0); `travel` how far in rad
    the body can turn clockwise and counter-clockwise until another point touches (0: it rests on that point already);
    `rho_squared` in m^2; `gravity` in m/s^2; `horizon` in s; `tolerance` the error aimed at, relative to the time and
    the rate. A body that is pressed onto a point on which it rests ends with NEVER, and so does one that nothing
    happens to within the horizon and 200 sweeps.
    """
    lever = arm[0] + drag * arm[1]
    push = omega * omega * arm[1] + gravity[1]
    jams = not rho_squared + arm[0] * lever > 0.0
    heading = omega or (0.0 if jams else push * lever)
    direction = (heading > 0.0) - (heading < 0.0)
    motion = Slip(arm, omega, slip, drag, rho_squared, gravity, direction or 1)
    if push >= 0.0:
        return motion.end(End.LIFTS)
    if jams:
        return motion.end(End.JAMS)
    if not direction:
        return _glide(motion, horizon)
    reach = travel[direction > 0]
    if reach <= 0.0:
        return motion.end(End.TOUCHES if omega else End.NEVER)
    try:
        end = _follow(motion, reach, horizon, tolerance)
    except (ArithmeticError, ValueError):  # numbers overflow
        end = End.JAMS
    return motion.end(end)


def _glide(motion: Slip, horizon: float) -> Stretch:
    """The stretch of a contact that slips while nothing turns the body: the slip changes at a constant rate."""
    if motion.stance.drag * motion.drive < 0.0:
        motion.time = -motion.slip / motion.drive
        if motion.time <= horizon:
            return motion.end(End.STOPS)
    return Stretch(End.NEVER, 0.0, 0.0, 0.0, motion.slip)


def _follow(motion: Slip, reach: float, horizon: float, tolerance: float) -> End:
    """Go on, sweep by sweep, to the first event, and say which it is."""
    allowed, close = _ALLOWED * tolerance**_ORDER, math.sqrt(tolerance)
    pose, longest = pose_at(motion.stance, motion.x, motion.y, motion.rate), math.inf
    if pose.rate * pose.rate < _NO_ENERGY * abs(pose.alpha):
        if pose.alpha < 0.0:
            motion.rate = 0.0
            return End.TURNS
        pose = pose_at(motion.stance, motion.x, motion.y, 0.0)
    span, stop = _plan(motion, pose, reach)
    smallest = _SMALLEST * span
    for _ in range(_MAX_SWEEPS):
        rest = motion.standstill(stop) if span >= stop else None
        swept = _sweep(motion, pose, rest, span)
        missed = 0.0 if rest is None or swept is None else _missed(pose, rest, swept)
        if swept is None or not swept.error <= allowed or not abs(missed) <= 0.1 * tolerance * span:
            span, stop = _again(motion, swept, missed, span, stop, allowed)
            span = longest = min(span, reach - motion.turned)
            if not span > smallest:
                return End.JAMS
            continue
        if not motion.stays(swept, rest is not None):
            event = motion.first_event(swept, rest is not None, horizon)
            if event is not None:
                angle, end = event
                if angle <= 0.0 or _locate(motion, pose, rest, span, swept.time, angle, end, close):
                    return end
                if angle < (1.0 - close) * span:
                    span = angle  # it only comes near
                    continue
        motion.go(swept.time, span, swept.rates[-1] if rest is None else 0.0)
        if rest is not None:
            return End.TURNS
        if motion.turned >= reach:
            motion.turned = reach
            return End.TOUCHES
        if motion.time >= horizon:
            break
        longest *= _step(allowed, swept.error)
        pose = motion.pose(0.0, motion.rate)
        span, stop = _plan(motion, pose, min(reach - motion.turned, longest))
    return End.NEVER


def _locate(
    motion: Slip, pose: Pose, rest: Pose | None, span: float, time: float, angle: float, end: End, close: float
) -> bool:
    """Go to an event near `angle` in a sweep of `span` and `time`; False where there is none."""
    for _ in range(_NEWTON_STEPS):
        swept = _sweep(motion, pose, rest, angle if rest is None else span - angle)
        if swept is None or swept.error == math.inf:
            break
        at = swept.time if rest is None else time - swept.time
        found, more = motion.reaches(end, at, angle, swept.rates[-1], close * at)
        if found:
            return True
        angle += more
        if not 0.0 < angle <= span:
            break
    return False


def _plan(motion: Slip, pose: Pose, longest: float) -> tuple[float, float]:
    """How far to sweep from a pose, and where the body would come to a standstill, inf where it does not."""
    stop = _standstill(pose)
    if pose.growth > 0.0:
        longest = min(longest, _GROWTH * (abs(pose.alpha) / pose.growth + pose.rate / math.sqrt(pose.growth)))
    return min(longest, _WIDEST, stop, _BEYOND * motion.until_stop(pose)), stop


def _standstill(pose: Pose) -> float:
    """How far in rad the motion linearised about a pose goes on until it stands still; inf when it does not."""
    _, _, rate, _, _, alpha, growth = pose
    square = alpha * alpha - growth * rate * rate
    return rate * rate / (math.sqrt(square) - alpha) if alpha < 0.0 <= square else math.inf


def _sweep(motion: Slip, pose: Pose, rest: Pose | None, span: float) -> Sweep | None:
    """A sweep from a pose, or back from a rest; None where it fails, as near a jam: the acceleration has its pole."""
    try:
        return sweep(motion.stance, pose, span) if rest is None else sweep(motion.mirrored(), rest, span)
    except (ArithmeticError, ValueError):
        return None


def _missed(pose: Pose, rest: Pose, swept: Sweep) -> float:
    """By which angle a rest lies too far, from the energy to which a sweep back from it leads."""
    # What the work there counts here is left of it by the integrating factor.
    slope = rest.alpha * rest.bracket / (pose.bracket * swept.factor)
    faster = (swept.rates[-1] - pose.rate) * (swept.rates[-1] + pose.rate)
    return 0.5 * faster / slope if slope > 0.0 else math.inf


def _again(
    motion: Slip, swept: Sweep | None, missed: float, span: float, stop: float, allowed: float
) -> tuple[float, float]:
    """The sweep to try and the standstill to assume in place of one that is refused."""
    if swept is None:
        return _SHORTER * span, math.inf
    if swept.error <= allowed:
        # Newton's method for the energy finds the standstill.
        better = stop - missed
        return (better, better) if 0.5 * stop < better < 2.0 * stop else (_SHORTER * span, math.inf)
    if swept.error < math.inf:
        return min(0.8, _step(allowed, swept.error)) * span, stop
    if span >= stop:
        return _SHORTER * span, math.inf
    last = len(swept.rates) - 1
    turned, beyond = swept.nodes[last][0], swept.nodes[last + 1][0]
    stop = turned + min(_standstill(motion.pose(turned, swept.rates[last])), 0.5 * (beyond - turned))
    return stop, stop


def _step(allowed: float, error: float) -> float:
    """Factor on a sweep that brings its error to what is allowed, by the degree of its interpolation."""
    return min(_FASTEST, max(0.1, 0.9 * (allowed / error) ** (1.0 / 6.0))) if error > 0.0 else _FASTEST
