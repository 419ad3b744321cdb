"""A body that turns over a stance contact which slips: one phase of it, with one direction of slip.

The contact stays on the support (y = 0) and friction is T = -drag N with drag = friction * sign(slip). With the arm
(x, y) from the contact to the mass centre, per unit of mass:

    along the support   x_C'' = gx - drag N
    normal to it        y_C'' = gy + N,  y_C = y
    rotation            rho^2 alpha = -N (x + drag y)

so that (rho^2 + x (x + drag y)) alpha = (omega^2 y + gy) (x + drag y). The angle of the next touchdown is known, so the
motion is integrated over the angle (`quadrature`), in one sweep where that is accurate enough and nothing else
happens. N has the sign of -(omega^2 y + gy) while the bracket is positive.
The slip needs no integration: x_C' + drag y_C' of the mass centre grows by gx + drag gy per second.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from ..types import Vector
from .events import Condition, Event, cubic, fall
from .pivot import Pivot
from .quadrature import PivotPose, SlipStance, Sweep, pose_at, sweep, weighted

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
_ROUNDING = 16.0 * 2.0**-52
"""Some units in the last place of a slip that is a sum of a few terms."""
_MARGIN = 0.05
"""Relative to its terms: more than a smooth condition falls between two nodes."""

SweepInstant = tuple[float, float, float, float, float, float, float]
"""Time in s and angle in rad since the start of a sweep, angular speed, and the arm (x, y), L and B there."""


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
) -> Pivot:
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
    motion = SlipPhase(arm, omega, slip, drag, rho_squared, gravity, direction or 1)
    if push >= 0.0:
        return motion.end(Event.LIFTS)
    if jams:
        return motion.end(Event.JAMS)
    if not direction:
        return _glide(motion, horizon)
    reach = travel[direction > 0]
    if reach <= 0.0:
        return motion.end(Event.TOUCHES if omega else Event.NEVER)
    try:
        end = _follow(motion, reach, horizon, tolerance)
    except (ArithmeticError, ValueError):  # numbers overflow
        end = Event.JAMS
    return motion.end(end)


def _glide(motion: SlipPhase, horizon: float) -> Pivot:
    """The phase of a contact that slips while nothing turns the body: the slip changes at a constant rate."""
    if motion.stance.drag * motion.drive < 0.0:
        motion.time = -motion.slip / motion.drive
        if motion.time <= horizon:
            return motion.end(Event.STOPS)
    return Pivot(event=Event.NEVER, time=0.0, turned=0.0, omega=0.0, slip=motion.slip)


def _follow(motion: SlipPhase, reach: float, horizon: float, tolerance: float) -> Event:
    """Go on, sweep by sweep, to the first event, and say which it is."""
    allowed, close = _ALLOWED * tolerance**_ORDER, math.sqrt(tolerance)
    pose, longest = pose_at(motion.stance, motion.x, motion.y, motion.rate), math.inf
    if pose.rate * pose.rate < _NO_ENERGY * abs(pose.alpha):
        if pose.alpha < 0.0:
            motion.rate = 0.0
            return Event.TURNS_BACK
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
                return Event.JAMS
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
            return Event.TURNS_BACK
        if motion.turned >= reach:
            motion.turned = reach
            return Event.TOUCHES
        if motion.time >= horizon:
            break
        longest *= _step(allowed, swept.error)
        pose = motion.pose(0.0, motion.rate)
        span, stop = _plan(motion, pose, min(reach - motion.turned, longest))
    return Event.NEVER


def _locate(
    motion: SlipPhase,
    pose: PivotPose,
    rest: PivotPose | None,
    span: float,
    time: float,
    angle: float,
    end: Event,
    close: float,
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


def _plan(motion: SlipPhase, pose: PivotPose, longest: float) -> tuple[float, float]:
    """How far to sweep from a pose, and where the body would come to a standstill, inf where it does not."""
    stop = _standstill(pose)
    if pose.growth > 0.0:
        longest = min(longest, _GROWTH * (abs(pose.alpha) / pose.growth + pose.rate / math.sqrt(pose.growth)))
    return min(longest, _WIDEST, stop, _BEYOND * motion.until_stop(pose)), stop


def _standstill(pose: PivotPose) -> float:
    """How far in rad the motion linearised about a pose goes on until it stands still; inf when it does not."""
    _, _, rate, _, _, alpha, growth = pose
    square = alpha * alpha - growth * rate * rate
    return rate * rate / (math.sqrt(square) - alpha) if alpha < 0.0 <= square else math.inf


def _sweep(motion: SlipPhase, pose: PivotPose, rest: PivotPose | None, span: float) -> Sweep | None:
    """A sweep from a pose, or back from a rest; None where it fails, as near a jam: the acceleration has its pole."""
    try:
        return sweep(motion.stance, pose, span) if rest is None else sweep(motion.mirrored(), rest, span)
    except (ArithmeticError, ValueError):
        return None


def _missed(pose: PivotPose, rest: PivotPose, swept: Sweep) -> float:
    """By which angle a rest lies too far, from the energy to which a sweep back from it leads."""
    # What the work there counts here is left of it by the integrating factor.
    slope = rest.alpha * rest.bracket / (pose.bracket * swept.factor)
    faster = (swept.rates[-1] - pose.rate) * (swept.rates[-1] + pose.rate)
    return 0.5 * faster / slope if slope > 0.0 else math.inf


def _again(
    motion: SlipPhase, swept: Sweep | None, missed: float, span: float, stop: float, allowed: float
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


class SlipPhase:
    """One phase of a slipping stance: what does not change in it, and how far it is.

    Angles count positive the way the body turns, and lengths along the support with them.
    """

    __slots__ = ("direction", "drive", "radius", "rate", "slip", "spin", "stance", "time", "turned", "x", "y")

    def __init__(
        self,
        arm: Vector,
        omega: float,
        slip: float,
        drag: float,
        rho_squared: float,
        gravity: Vector,
        direction: int,
    ) -> None:
        drag, self.direction = direction * drag, direction
        side = (drag > 0.0) - (drag < 0.0)
        self.stance = SlipStance(drag=drag, side=side, rho_squared=rho_squared, gravity=gravity[1])
        self.x, self.y, self.radius = direction * arm[0], arm[1], math.hypot(*arm)
        self.slip, self.drive = direction * slip, direction * gravity[0] + drag * gravity[1]
        self.spin = abs(omega) * (drag * self.x - self.y)
        self.time, self.turned, self.rate = 0.0, 0.0, abs(omega)

    def arm(self, turned: float) -> Vector:
        """From the contact to the mass centre, that much further."""
        sine, cosine = math.sin(self.turned + turned), math.cos(self.turned + turned)
        return self.x * cosine - self.y * sine, self.x * sine + self.y * cosine

    def pose(self, turned: float, rate: float) -> PivotPose:
        """The pose that much further, with its angular speed."""
        return pose_at(self.stance, *self.arm(turned), rate)

    def mirrored(self) -> SlipStance:
        """The stance seen so that the body turns back."""
        return self.stance._replace(drag=-self.stance.drag)

    def standstill(self, turned: float) -> PivotPose:
        """A standstill that much further, seen so that the body turns back from it."""
        x, y = self.arm(turned)
        return pose_at(self.mirrored(), -x, y, 0.0)

    def until_stop(self, pose: PivotPose) -> float:
        """How far in rad the body turns until the slip stops, if slip and turning change at their present rates."""
        x, y, rate, lever, bracket, alpha, _ = pose
        slip, change = self.slips((0.0, 0.0, rate, x, y, lever, bracket))
        if not slip > 0.0 > change:
            return math.inf
        time = -slip / change
        return (rate + 0.5 * alpha * time) * time if rate + alpha * time > 0.0 else math.inf

    def stays(self, swept: Sweep, back: bool) -> bool:
        """Whether load and slip keep far from zero in a sweep, forth or back, by bounds that cost little."""
        drag, side, _, gravity = self.stance
        fastest = max(swept.rates)
        if fastest * fastest * self.radius > (_MARGIN - 1.0) * gravity:
            return False
        if not side:
            return True
        if back:
            drag = -drag
        # Every other node, with both ends, tells enough of so smooth a function.
        some = zip(swept.nodes[1::2], swept.rates[1::2], strict=True)
        spins = [(drag * x - y) * rate for (_, x, y, _, _), rate in some]
        if back:
            spins.append(0.0)
        loss = max(spins) if side > 0 else -min(spins)
        start, drift = side * (self.slip + self.spin), side * self.drive
        least = start + drift * (self.time + swept.time if drift < 0.0 else self.time) - loss
        return least > _MARGIN * (abs(start) + abs(loss))

    def first_event(self, swept: Sweep, back: bool, horizon: float) -> tuple[float, Event] | None:
        """At which angle of a sweep the load or the slip vanishes first, or might, and which."""
        along = _instants(swept, back)
        (drag, side, _, gravity), fastest = self.stance, max(swept.rates)
        lifts = stops = (math.inf, 0.0)
        if fastest * fastest * self.radius > (_MARGIN - 1.0) * gravity:
            lifts = _first_fall(along, self.load, 0.0)
        if side:
            terms = abs(self.slip) + abs(self.spin) + fastest * self.radius * (1.0 + abs(drag))
            # A slip that begins is smaller than the errors at the nodes, and does not end by them.
            noise = _ROUNDING if self.slip or self.time else max(_ROUNDING, swept.error)
            stops = _first_fall(along, self.slips, noise * (terms + abs(self.drive) * swept.time))
        time, angle = min(lifts, stops)
        if time == math.inf or self.time + time > horizon:
            return None
        return angle, Event.LIFTS if time == lifts[0] else Event.STOPS

    def load(self, now: SweepInstant) -> Condition:
        """The normal force over a factor that stays positive."""
        _, _, rate, x, y, lever, bracket = now
        square = rate * rate
        push = square * y + self.stance.gravity
        return -push, -rate * (2.0 * push * lever / bracket * y + square * x)

    def slips(self, now: SweepInstant) -> Condition:
        """The speed of the slip."""
        drag, side, _, gravity = self.stance
        time, _, rate, x, y, lever, bracket = now
        square, swing = rate * rate, drag * x - y
        alpha = (square * y + gravity) * lever / bracket
        slip = self.slip + self.drive * (self.time + time) - (rate * swing - self.spin)
        return side * slip, side * (self.drive - alpha * swing + square * lever)

    def reaches(self, end: Event, time: float, turned: float, rate: float, within: float) -> tuple[bool, float]:
        """Go to an event if it lies within so many seconds of an instant that much further, by Newton's method.

        Returns whether it does, and how far in rad the body turns from that instant until the event.
        """
        x, y, _, lever, bracket, alpha, _ = self.pose(turned, rate)
        now = time, turned, rate, x, y, lever, bracket
        value, change = self.load(now) if end is Event.LIFTS else self.slips(now)
        left = -value / change if change < 0.0 else math.inf
        more = (rate + 0.5 * alpha * left) * left
        if not abs(left) <= within:
            return False, more
        self.go(time + left, turned + more, rate + alpha * left)
        return True, more

    def go(self, time: float, turned: float, rate: float) -> None:
        """Go on to an instant that much further."""
        self.time, self.turned, self.rate = self.time + time, self.turned + turned, rate

    def end(self, end: Event) -> Pivot:
        """The phase that ends now."""
        x, y = self.arm(0.0)
        drag, sign, rate = self.stance.drag, self.direction, self.rate
        slip = self.slip + self.drive * self.time - (rate * (drag * x - y) - self.spin)
        moved = (self.slip + self.spin + 0.5 * self.drive * self.time) * self.time
        moved -= drag * (y - self.y) + (x - self.x)
        return Pivot(
            event=end,
            time=self.time,
            turned=sign * self.turned,
            omega=sign * rate,
            slip=sign * slip,
            moved=sign * moved,
            direction=sign,
        )


def _instants(swept: Sweep, back: bool) -> list[SweepInstant]:
    """The instants of a sweep, also of one back from a standstill, in the order of time."""
    (nodes, _, rows, *_), places, rates, lags, linear_time, end, *_ = swept
    times = [0.0, *[linear_time * (s - weighted(row, lags)) for s, row in zip(nodes, rows, strict=True)]]
    all_of_it = zip(times, places, rates, strict=True)
    if not back:
        return [(time, turned, rate, x, y, lever, bracket) for time, (turned, x, y, lever, bracket), rate in all_of_it]
    angle = places[-1][0]
    return [(end - t, angle - turned, rate, -x, y, -lever, b) for t, (turned, x, y, lever, b), rate in all_of_it][::-1]


def _first_fall(
    along: list[SweepInstant], condition: Callable[[SweepInstant], Condition], noise: float
) -> tuple[float, float]:
    """Time and turned angle where a condition first falls to zero, or might; inf where it does not."""
    found = [condition(now) for now in along]
    values, last = [value for value, _ in found], len(along) - 1
    for index in range(1, last + 1):
        before, here = values[index - 1], values[index]
        dips = before <= here and (index == 1 or values[index - 2] >= before)
        dips = dips or (here <= before and (index == last or values[index + 1] >= here))
        if here <= 0.0 or dips:
            start, now = along[index - 1], along[index]
            (value, slope), (end_value, end_slope), gap = found[index - 1], found[index], now[0] - start[0]
            at = fall(value, slope * gap, end_value, end_slope * gap, noise)
            if at <= 1.0:
                square, cube = cubic(start[1], start[2] * gap, now[1], now[2] * gap)
                return start[0] + at * gap, start[1] + at * (start[2] * gap + at * (square + at * cube))
    return math.inf, 0.0
