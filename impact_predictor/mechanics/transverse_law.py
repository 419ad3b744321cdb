"""The impulse path with slip across the plane: Routh's hypothesis where the directions of the slips turn.

While A or B slips across the plane the rates turn with the slips, and the path is integrated along the normal impulse
of B (one contact: J. B. Keller, Impact with friction, Journal of Applied Mechanics 53 (1986)). Once no closed contact
slips across the plane any more the rest is straight, with the states of the planar law.
"""

from __future__ import annotations

from math import inf, sqrt

from .pair import JAMMED, MINUS, NO_SOLUTION, OPEN, PLUS, REVERSED, SHARED_FRICTION, STICK, WORK_LIMITED
from .transverse_states import Across, Rates, States, Way, descent, margin, rates, spatial_states, way_of
from .transverse_step import STRAIGHT, Arc, State, advance, straight_arc

MAX_STEPS = 400
"""An impact needs five to forty, at the finest tolerance two hundred; jams can follow each other without end."""

ROOM = 1 << 52
"""A code of segments below this has room for two more in 64 bits; later segments are not told."""

FAR = 1e9
"""A contact that does not exist leaves this many times faster than anything moves."""

BEYOND = 1.25
"""How much further than the next event is foreseen a step may reach, so that it falls within one step."""

Velocities = tuple[float, float, float, float, float, float]
"""c_nA, c_tA, c_zA, c_nB, c_tB, c_zB."""


class Path:
    """The impulse path of a body of unit mass from contact velocities with c_nB <= 0 and c_nA >= 0.

    The restitution at B is Poisson's, limited by the work that the compression stored. A step adds less than `small` to
    the error of a velocity, and slower slips end. `follow` goes to the end of the impact: `state` and the normal
    impulse `nb` there, the code of the `segments` (see `pair.Impact`) and `notes` tell what happened.
    """

    def __init__(self, across: Across, before: Velocities, small: float) -> None:
        self.across = across
        self.small = small
        self.state: State = (0.0, 0.0, 0.0, 0.0, 0.0, *before)
        self.nb = 0.0
        self.segments = self.notes = 0
        self._work = 0.0
        self._first_a, self._first_b = before[1], before[4]
        self._states: States | None = None
        self._told = -1
        self._reach = inf

    def follow(self, restitution: float) -> None:
        """Go to the end of the impact; NO_SOLUTION in `notes` says that the path was lost on the way."""
        arrived = self._press(inf)
        if arrived and restitution > 0.0 and self.state[8] == 0.0:
            arrived = self._press((1.0 + restitution) * self.nb)
            if arrived and self.state[8] < -self.small:
                # B was pressed again while it expanded: a plastic compression ends that.
                arrived = self._press(inf)
        if not arrived:
            self.notes |= NO_SOLUTION

    def _press(self, target: float) -> bool:
        """Compress B to the end (`target` inf), or let it expand until the normal impulse `target`."""
        self._states, self._told = None, -1
        for _ in range(MAX_STEPS):
            if self._states is None:
                self._states = spatial_states(self.across, self.state[5:], target == inf)
            if not (self._strike_old() if self._states is None else self._step(self._states, target)):
                return False
            if self.state[8] >= 0.0 if target == inf else self.nb >= target or self._work <= 0.0:
                return True
        return False

    def _tell(self, states: States) -> None:
        """Note the contact states, where they are new, and slips in the plane that reverse."""
        a, b, _, rate, _ = states
        a, self._first_a = self._signed(a, self.state[6], rate[6], self._first_a)
        b, self._first_b = self._signed(b, self.state[9], rate[9], self._first_b)
        if a == STICK and b == STICK:
            self.notes |= SHARED_FRICTION
        if self._told != 4 * a + b:
            self._told = 4 * a + b
            if self.segments < ROOM:
                self.segments = 16 * self.segments + self._told

    def _signed(self, state: int, slip: float, rate: float, first: float) -> tuple[int, float]:
        """A state with the sign of the slip in the plane, and the slip that it began with."""
        if state < PLUS:
            return state, first
        slip = slip or rate
        if first == 0.0:
            first = slip
        elif slip * first < 0.0:
            self.notes |= REVERSED
        return (MINUS if slip < 0.0 else PLUS), first

    def _step(self, states: States, target: float) -> bool:
        """Go on to the next event, or as far as the path can be followed in one step; False where it is lost."""
        self._tell(states)
        a, b, way, rate, straight = states
        span = self._foreseen(a, b, rate, target, 1.0 if straight else BEYOND)
        if span == inf:
            return False
        if straight or span == 0.0:
            arc = straight_arc(self.state, rate, span)
        else:
            step = advance(self.across, a, b, way, self.state, rate, min(span, self._reach), self.small)
            if step is None:
                return False
            arc, way, self._reach = step
        part, spent = self._first_event(states, way, arc, target)
        last = arc.last
        self.state = arc.at(part) if part < 1.0 else arc.end
        if part < 1.0 and not straight:
            way = way_of(self.state[5:], way, self.small)
            last = rates(self.across, a, b, way) or last
        self.nb = target if part == 1.0 and arc.span == target - self.nb else self.nb + part * arc.span
        self._work = 0.0 if spent else self._work - arc.pressed(part)
        if spent:
            self.notes |= WORK_LIMITED
        ended = self._settle(a, b, last, target)
        self._states = None if ended or straight or part < 1.0 else (a, b, way, last, False)
        return True

    def _foreseen(self, a: int, b: int, rate: Rates, target: float, beyond: float) -> float:
        """How far N_B may grow until the rates or a condition change, were they to stay as they are."""
        _, _, _, _, _, cna, cta, cza, cnb, ctb, czb = self.state
        _, _, _, _, _, rna, rta, rza, rnb, rtb, rzb = rate
        span = inf
        if target == inf and rnb > 0.0:
            span = -cnb / rnb * beyond
        if a == OPEN and cna > 0.0 and rna < 0.0:
            span = min(span, -cna / rna * beyond)
        # A slip that turns passes zero at about its own size.
        if a >= PLUS and cta * rta + cza * rza < 0.0:
            span = min(span, sqrt(cta * cta + cza * cza) / (abs(rta) + abs(rza)))
        if b >= PLUS and ctb * rtb + czb * rzb < 0.0:
            span = min(span, sqrt(ctb * ctb + czb * czb) / (abs(rtb) + abs(rzb)))
        return min(span, target - self.nb)

    def _first_event(self, states: States, way: Way, arc: Arc, target: float) -> tuple[float, bool]:
        """The part of a stretch after which the first condition ends, and whether it is that B's work is spent."""
        a, b, _, _, straight = states
        across, small = self.across, self.small
        part, spent = 1.0, False
        if target == inf:
            if arc.end[8] > small:
                part = descent(lambda t: -arc.velocity(8, t), -arc.begin[8], -arc.end[8])
        elif arc.pressed(1.0) > self._work + small * self.nb:
            part = descent(lambda t: self._work - arc.pressed(t), self._work, self._work - arc.pressed(1.0))
            spent = True
        if a == OPEN and arc.begin[5] > 0.0 and arc.end[5] < -small:
            closes = descent(lambda t: arc.velocity(5, t), arc.begin[5], arc.end[5])
            if closes < part:
                part, spent = closes, False
        last = 1.0 if straight else margin(across, a, b, arc.last)
        if last < 0.0:

            def held(t: float) -> float:
                there = rates(across, a, b, way_of(arc.at(t)[5:], way, small))
                return -1.0 if there is None else margin(across, a, b, there)

            slips = descent(held, margin(across, a, b, arc.rate), last)
            if slips < part:
                part, spent = slips, False
        return part, spent

    def _settle(self, a: int, b: int, rate: Rates, target: float) -> bool:
        """Make what has come to zero exactly zero; whether the states of the contacts change with it."""
        na, ta, za, tb, zb, cna, cta, cza, cnb, ctb, czb = self.state
        _, _, _, _, _, rna, rta, rza, rnb, rtb, rzb = rate
        small = self.small
        ended = False
        if target == inf and cnb >= -small and rnb > 0.0:
            cnb = 0.0
        if a == OPEN and cna <= small and rna < 0.0:
            cna, ended = 0.0, True
        if a >= PLUS and cta * cta + cza * cza <= small * small and not grows(cta, cza, rta, rza):
            cta, cza, ended = 0.0, 0.0, True
        if b >= PLUS and ctb * ctb + czb * czb <= small * small and not grows(ctb, czb, rtb, rzb):
            ctb, czb, ended = 0.0, 0.0, True
        if abs(czb) <= small and (cna > 0.0 or abs(cza) <= small) and (czb != 0.0 or (cza != 0.0 and cna == 0.0)):
            czb, ended = 0.0, True
            cza = cza if cna > 0.0 else 0.0
        self.state = (na, ta, za, tb, zb, cna, cta, cza, cnb, ctb, czb)
        return ended

    def _strike_old(self) -> bool:
        """End a jam by a tangential impact at A: B is held, and A follows its own one-contact path.

        Its normal impulse grows while its slip presses it into the support and on until it leaves it.
        """
        (cos, sin, qa, sa, qb, sb, fa, fb), waa, wab, wbb = self.across
        na, ta, za, tb, zb, cna, cta, cza, cnb, ctb, czb = self.state
        if cna > 0.0 or (cta == 0.0 and cza == 0.0):
            return False
        alone = (1.0, 0.0, 0.0, 0.0, qa, sa, 0.0, fa), 1.0, 0.0, waa
        path = Path(alone, (FAR * (abs(cta) + abs(cza)), 0.0, 0.0, 0.0, cta, cza), self.small)
        path.follow(0.0)
        if path.notes & NO_SOLUTION or path.nb == 0.0:
            return False
        self.notes |= JAMMED
        code, size = 4 * path.segments, 16  # a digit of a path of B alone is the state of B
        while size <= code:
            size *= 16
        if self.segments * size < ROOM:
            self.segments = self.segments * size + code
        n, t, z = path.nb, path.state[3], path.state[4]
        q = qa * n + sa * t
        _, _, _, _, _, _, _, _, _, cta, cza = path.state
        cnb, ctb, czb = cnb + cos * n - sin * t + qb * q, ctb + cos * t + sin * n + sb * q, czb + wab * z
        self.state = (na + n, ta + t, za + z, tb, zb, 0.0, cta, cza, cnb, ctb, czb)
        return True


def grows(t: float, z: float, rate_t: float, rate_z: float) -> bool:
    """Whether a slip (t, z) grows in the direction that it has, as one does that has just begun."""
    along = t * rate_t + z * rate_z
    return along > 0.0 and along * along >= STRAIGHT * (t * t + z * z) * (rate_t * rate_t + rate_z * rate_z)
