"""Cargo on compliant contacts: a truth that shares no impact law, no modes and no events with a prediction.

Stiff springs with dampers and regularised friction move the unit (`mechanics.compliant`). Its impacts are read from the
gaps and velocities of its contacts alone: an impact begins where a contact closes that was open, and is over when the
normal forces have fallen to those of rest. Contacts that move out of the support then have opened. Onsets are not told:
a regularised contact creeps before it slides.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ...errors import InputError
from ...mechanics.compliant import CompliantMotion, compliant_motion
from ...mechanics.impact import solve_impact
from ...mechanics.motion import End, PlanarState
from ...mechanics.motion.support import MovingSupport, from_world
from ...mechanics.types import Contact, Mode, Twist, TwoPointBody
from ...stamps import NANOSECONDS
from ..sensors import ACROSS
from ..truth import TrueImpact, border_of, half_distance
from .cargo import CargoUnit, Span

SPAN: Final = 10.0
"""Seconds that are integrated at once."""

STIFFNESS: Final = 1e9
"""N/m of each contact: some tonnes sink in by hundredths of a millimetre, and an impact takes about a millisecond."""

REGULARISATION: Final = 1e-4
"""Slip (m/s) at which friction is 0.71 of its full."""

METHOD: Final = "BDF"
"""Integrator: with contacts as stiff as these others get stuck now and then."""

SLOWEST: Final = 1e-3
"""Approach in m/s of the slowest contact that counts as striking."""

OPEN: Final = 1e-3
"""Seconds that a contact must have been open before it strikes."""

LONGEST: Final = 0.02
"""Seconds after which an impact is over in any case."""

PRESSED: Final = 2.0
"""Weights with which the contacts press no more when an impact is over."""

PART: Final = 0.02
"""A velocity above this part of the approach is one: out of the support the contact opens, along it it slips."""


def follow_compliant(unit: CargoUnit, support: MovingSupport, duration: float, law: str = "path") -> Iterator[Span]:
    """The motion of a unit on compliant contacts, one span after the other; as `deck.follow`.

    `law` judges how near the state before an impact is to another mode, and nothing else.

    Raises:
        InputError: the unit lies on edges, or the motion cannot be integrated.
    """
    if unit.scene.radius > 0.0:
        raise InputError(f"{unit.name} is a drum; compliant contacts are of points: simulate it with --contacts rigid")
    time, state, end = 0.0, unit.start, End.TIME_UP
    last_open = [-1.0, -1.0]
    while time < duration and end is End.TIME_UP:
        motion = compliant_motion(
            unit.body,
            state,
            support,
            min(SPAN, duration - time),
            start_time=time,
            stiffness=STIFFNESS,
            regularisation=REGULARISATION,
            method=METHOD,
        )
        if not motion.complete:
            raise InputError(
                f"{unit.name} cannot be followed on compliant contacts beyond {motion.time:g} s; try rigid"
            )
        until, seen, times = motion.time, _Stretch(unit, support, motion), motion.way.ts
        over = np.abs(seen.state(times).angle - unit.start.angle) > 0.5 * pi
        if over.any():
            end, until = End.OVERTURNED, float(times[over.argmax()])
        impacts = tuple(seen.impacts(times[times <= until], last_open, law))
        yield Span(start=time, time=until, state=seen.state, impacts=impacts, onsets=(), sums=(), end=end)
        state, time = PlanarState(*[float(part) for part in seen.state(until)]), until


class _Stretch:
    """A stretch of compliant motion, seen from the support."""

    def __init__(self, unit: CargoUnit, support: MovingSupport, motion: CompliantMotion) -> None:
        self.unit, self.support, self.motion = unit, support, motion
        old = unit.body.old
        assert old is not None
        self.points = (old.x, old.y), (unit.body.new.x, unit.body.new.y)

    def state(self, times: NDArray[np.float64] | float) -> PlanarState:
        """The mass centre's states at a time or an array of times."""
        return from_world(self.support.motion(times), PlanarState(*self.motion.way(times)))

    def contact(self, i: int, state: PlanarState) -> tuple[Any, Any, Any]:
        """Gap (m), its rate and the slip (m/s) of a contact in a state of numbers or arrays."""
        _, y, angle, vx, vy, omega = state
        (px, py), c, s = self.points[i], np.cos(angle), np.sin(angle)
        return y + s * px + c * py, vy + omega * (c * px - s * py), vx - omega * (s * px + c * py)

    def impacts(self, times: NDArray[np.float64], last_open: list[float], law: str) -> Iterator[TrueImpact]:
        """The impacts between the steps `times` of the integrator, in order.

        `last_open` is since when each contact has been open, below zero for a closed one; it is kept up to date.
        """
        states = self.state(times)
        closings: list[tuple[float, int]] = []
        for i in (0, 1):
            gaps, _, _ = self.contact(i, states)
            is_open = gaps > 0.0
            if is_open[0] and last_open[i] < 0.0:
                last_open[i] = float(times[0])
            for k in np.flatnonzero(is_open[1:] != is_open[:-1]).tolist():
                if is_open[k + 1]:
                    last_open[i] = float(times[k + 1])
                    continue
                at = self._closing(i, float(times[k]), float(times[k + 1]))
                if last_open[i] >= 0.0 and at - last_open[i] > OPEN:
                    closings.append((at, i))
                last_open[i] = -1.0
        for at, new in sorted(closings):
            impact = self._impact(at, new, float(times[-1]), law)
            if impact is not None:
                yield impact

    def _closing(self, i: int, low: float, high: float) -> float:
        """When a contact closes between two times."""

        def gap(time: float) -> float:
            width, _, _ = self.contact(i, self.state(time))
            return float(width)

        # One time by itself is rounded otherwise than in an array of them.
        return float(brentq(gap, low, high, xtol=1e-16)) if gap(low) > 0.0 > gap(high) else high

    def _over(self, start: float, end: float) -> float:
        """When the contacts press no more than at rest."""
        weight = PRESSED * self.unit.body.mass * self.support.gravity
        steps = self.motion.way.ts
        pressed = False
        for time in steps[(steps > start) & (steps <= min(end, start + LONGEST))].tolist():
            force = sum(normal for normal, _ in self.motion.forces(time))
            if pressed and force < weight:
                return float(time)
            pressed = pressed or force > weight
        return min(end, start + LONGEST)

    def _impact(self, at: float, new: int, last: float, law: str) -> TrueImpact | None:
        """The impact of a contact that closes; None where it comes too slowly."""
        unit, before = self.unit, self.state(at)
        (gap, _, _), (_, rate, _) = self.contact(1 - new, before), self.contact(new, before)
        approach, stood = -float(rate), float(gap) <= 0.0
        if approach <= SLOWEST:
            return None
        after, least = self.state(self._over(at, last)), PART * approach
        (_, old_rate, _), (_, new_rate, slip) = self.contact(1 - new, after), self.contact(new, after)
        slips = abs(float(slip)) > least + 10.0 * REGULARISATION
        body = self._body(before, new, stood)
        twist, twist_after = (Twist(float(one.vx), float(one.vy), float(one.omega)) for one in (before, after))
        return TrueImpact(
            stamp=round(at * NANOSECONDS),
            body=unit.name,
            mode=_mode(stood and float(old_rate) <= least, float(new_rate) <= least, slips),
            old=unit.contacts[1 - new] if stood else (),
            new=unit.contacts[new],
            approach=approach,
            half_distance=half_distance(body),
            energy_lost=_energy(body, twist) - _energy(body, twist_after),
            linear_before=ACROSS.vector(twist.vx, twist.vy),
            angular_before=ACROSS.spin(twist.omega),
            linear_after=ACROSS.vector(twist_after.vx, twist_after.vy),
            angular_after=ACROSS.spin(twist_after.omega),
            border=border_of(solve_impact(body, twist, law)),
        )

    def _body(self, state: PlanarState, new: int, stood: bool) -> TwoPointBody:
        """The unit as an impact law sees it."""
        body, (c, s) = self.unit.body, (cos(state.angle), sin(state.angle))
        contacts = []
        for contact in (body.old, body.new):
            assert contact is not None
            x, y = c * contact.x - s * contact.y, s * contact.x + c * contact.y
            contacts.append(Contact(x, y, contact.friction, (0.0, 1.0), contact.restitution))
        return TwoPointBody(body.mass, body.inertia, contacts[1 - new] if stood else None, contacts[new])


def _mode(old_stays: bool, new_stays: bool, slips: bool) -> Mode:
    if not new_stays:
        return Mode.BACK_PIVOT if old_stays else Mode.FLIGHT
    if old_stays:
        return Mode.SLIDE if slips else Mode.STOP
    return Mode.PIVOT_SLIDE if slips else Mode.PIVOT


def _energy(body: TwoPointBody, twist: Twist) -> float:
    """Kinetic energy relative to the support, in J."""
    vx, vy, omega = twist
    return 0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * omega * omega)
