"""The impulse path with slip across the plane: Routh's hypothesis where the directions of the slips turn.

While A or B slips across the plane the rates turn with the slips, and the path is integrated along the normal impulse
of B (one contact: J. B. Keller, Impact with friction, Journal of Applied Mechanics 53 (1986)). Once no closed contact
slips across the plane any more the rest is straight, with the states of the planar law.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, sqrt

from .impact.contacts import (
    JAMMED,
    MINUS,
    NO_SOLUTION,
    OPEN,
    PLUS,
    REVERSED,
    ROUNDING,
    SHARED_FRICTION,
    STICK,
    WORK_LIMITED,
    below_rounding,
    planar_contacts,
)
from .impact.rates import Rates, choose, open_rates, state_alone
from .impact.restitution import poisson
from .transverse_step import (
    EXPLICIT,
    SLACK,
    SLIP,
    Across,
    Arc,
    RatesAcross,
    Slips,
    State,
    TransverseInstant,
    advance,
    margin,
    rates,
    straight_arc,
    way_of,
)

MAX_STEPS = 400
"""An impact needs two to forty, at the finest tolerance two hundred; jams can follow each other without end."""

ROOM = 1 << 52
"""A code of segments below this has room for two more in 64 bits; later segments are not told."""

FAR = 1e9
"""A contact that does not exist leaves this many times faster than anything moves."""

BEYOND = 1.25
"""How much further than the next event is foreseen a step may reach, so that it falls within one step."""

ARRIVED = 1.0 - 1e-12
"""An impulse above this part of the one aimed at is it."""

STRAIGHT = 0.9
"""Square of the cosine of the angle from a slip to its rate below which it grows in its direction."""

SpatialPath = tuple[State, int, int]
"""The state at the end of an impact; the contact states along it (see `impact.contacts`); notes."""

SpatialVelocities = tuple[float, float, float, float, float, float]
"""c_nA, c_tA, c_zA, c_nB, c_tB, c_zB."""

StatesAcross = tuple[int, int, Slips, RatesAcross, bool]
"""States of A and B, the directions in which they slip, the rates, and whether these stay as they are."""

COMPASS = tuple(
    (x / sqrt(x * x + z * z), z / sqrt(x * x + z * z))
    for x, z in (
        *((4.0, float(k)) for k in range(-4, 4)),
        *((float(-k), 4.0) for k in range(-4, 4)),
        *((-4.0, float(-k)) for k in range(-4, 4)),
        *((float(k), -4.0) for k in range(-4, 4)),
    )
)
"""Directions all around, in the order of their angle."""


def follow(across: Across, before: SpatialVelocities, small: float, restitution: float) -> SpatialPath:
    """Follow the impulse path of a body of unit mass from contact velocities with c_nB <= 0 and c_nA >= 0.

    The restitution at B is Poisson's, limited by the work that the compression stored. A step adds less than `small` to
    the error of a slip, and slower slips end. NO_SOLUTION in the notes says that the path was lost on the way.
    """
    (_, _, _, sa, _, sb, fa, fb), waa, _, wbb = across
    turn_a, turn_b = (fa * max(1.0 + sa * sa, waa)) ** 2, (fb * max(1.0 + sb * sb, wbb)) ** 2
    state: State = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, *before)
    first_a, first_b = before[1], before[4]
    states: StatesAcross | None = None
    target, reach = inf, inf
    compressing = True
    told, segments, notes, tries = -1, 0, 0, 0
    work = 0.0
    for _ in range(MAX_STEPS):
        if states is None:
            states = spatial_states(across, state[6:], compressing)
        if states is None:
            freed, state, segments = strike_old(across, state, small, segments)
            if not freed:
                break
            notes |= JAMMED
        else:
            a, b, way, rate, straight = states
            _, _, _, nb, _, _, cna, cta, cza, cnb, ctb, czb = state
            _, _, _, _, _, _, rna, rta, rza, rnb, rtb, rzb = rate
            sign_a, sign_b = a, b
            if a >= PLUS:
                slip = cta or rta
                sign_a = MINUS if slip < 0.0 else PLUS
                if slip * first_a < 0.0:
                    notes |= REVERSED
                first_a = first_a or slip
            if b >= PLUS:
                slip = ctb or rtb
                sign_b = MINUS if slip < 0.0 else PLUS
                if slip * first_b < 0.0:
                    notes |= REVERSED
                first_b = first_b or slip
            elif a == STICK and b == STICK:
                notes |= SHARED_FRICTION
            if told != 4 * sign_a + sign_b:
                told = 4 * sign_a + sign_b
                if segments < ROOM:
                    segments = 16 * segments + told

            # How far N_B may grow until a contact changes its state, were the rates to stay as they are.
            span = inf if straight else reach
            if a == OPEN and cna > 0.0 and rna < 0.0:
                span = min(span, -cna / rna * (1.0 if straight else BEYOND))
            # A slip that slows down turns, or passes zero, within an impulse of its own size.
            if a >= PLUS and cta * rta + cza * rza < 0.0:
                square = rta * rta + rza * rza
                if square < turn_a and not straight:
                    square = turn_a
                span = min(span, sqrt((cta * cta + cza * cza) / square))
            if b >= PLUS and ctb * rtb + czb * rzb < 0.0:
                square = rtb * rtb + rzb * rzb
                if square < turn_b and not straight:
                    square = turn_b
                span = min(span, sqrt((ctb * ctb + czb * czb) / square))
            if compressing:
                whole = -cnb / rnb if rnb > 0.0 else inf
            else:
                whole = target - nb
            ends = whole <= span
            if ends:
                span = whole
            if span == inf:
                break

            if straight or span == 0.0:
                arc = straight_arc(state, rate, span, way)
            else:
                step = advance(
                    TransverseInstant(across, a, b, way, state, rate), span, ends and compressing, small, tries
                )
                if step is None:
                    break
                arc, longer, tries = step
                reach = longer * arc.last_span
                if tries >= EXPLICIT:
                    turn_a = turn_b = 0.0
            state, way, rate = arc.end, arc.way, arc.last
            event = state[9] > small if compressing else arc.work > work + small * nb
            if a == OPEN:
                event = event or (cna > 0.0 and state[6] < -small)
            elif not straight:
                event = event or margin(across, a, b, rate) < 0.0
            if event:
                part, spent = first_event(across, a, b, arc, straight, inf if compressing else work, small)
                state = arc.at(part)
                work = 0.0 if spent else work - arc.worked(part)
                if spent:
                    notes |= WORK_LIMITED
                if not straight:
                    way = way_of(state[7], state[8], state[10], state[11], way, small)
                    rate = rates(across, a, b, way) or rate
            else:
                work -= arc.work

            # What has come to zero is made exactly zero.
            na, ta, za, nb, tb, zb, cna, cta, cza, cnb, ctb, czb = state
            _, _, _, _, _, _, rna, rta, rza, rnb, rtb, rzb = rate
            ended = event or straight
            if compressing and cnb >= -small and rnb > 0.0:
                cnb = 0.0
            if a == OPEN:
                if cna <= small and rna < 0.0:
                    cna, ended = 0.0, True
            elif a >= PLUS and cta * cta + cza * cza <= small * small and not grows(cta, cza, rta, rza):
                cta, cza, ended = 0.0, 0.0, True
            if b >= PLUS and ctb * ctb + czb * czb <= small * small and not grows(ctb, czb, rtb, rzb):
                ctb, czb, ended = 0.0, 0.0, True
            if abs(czb) <= small and (cna > 0.0 or abs(cza) <= small) and (czb != 0.0 or (cza != 0.0 and cna == 0.0)):
                czb, ended = 0.0, True
                cza = cza if cna > 0.0 else 0.0
            state = (na, ta, za, nb, tb, zb, cna, cta, cza, cnb, ctb, czb)
            states = None if ended else (a, b, way, rate, False)

        _, _, _, nb, _, _, _, _, _, cnb, _, _ = state
        if compressing:
            if cnb >= 0.0:
                if restitution == 0.0 or cnb > 0.0:
                    return state, segments, notes
                compressing, target, told = False, poisson(restitution, nb), -1
        elif nb >= ARRIVED * target or work <= 0.0:
            if cnb >= -small:
                return state, segments, notes
            # B was pressed again while it expanded: a plastic compression ends that.
            compressing, restitution, told = True, 0.0, -1
    return state, segments, notes | NO_SOLUTION


def first_event(
    across: Across, a: int, b: int, arc: Arc, straight: bool, work: float, small: float
) -> tuple[float, bool]:
    """The part of a stretch after which the first condition ends, and whether it is that B's work is spent.

    `work` is what B has stored, inf while it is compressed.
    """
    part, spent = 1.0, False
    if work == inf:
        if arc.end[9] > 0.0:
            part = descent(lambda t: -arc.component(9, t), -arc.begin[9], -arc.end[9])
    elif arc.work > work:
        part = descent(lambda t: work - arc.worked(t), work, work - arc.work)
        spent = True
    if a == OPEN and arc.begin[6] > 0.0 > arc.end[6]:
        closes = descent(lambda t: arc.component(6, t), arc.begin[6], arc.end[6])
        if closes < part:
            part, spent = closes, False
    last = 1.0 if straight else margin(across, a, b, arc.last)
    if last < 0.0:

        def held(t: float) -> float:
            _, _, _, _, _, _, _, cta, cza, _, ctb, czb = arc.at(t)
            there = rates(across, a, b, way_of(cta, cza, ctb, czb, arc.way, small))
            return -1.0 if there is None else margin(across, a, b, there)

        slips = descent(held, margin(across, a, b, arc.first), last)
        if slips < part:
            part, spent = slips, False
    return part, spent


def strike_old(across: Across, state: State, small: float, segments: int) -> tuple[bool, State, int]:
    """End a jam by a tangential impact at A: B is held, and A follows its own one-contact path.

    Its normal impulse grows while its slip presses it into the support and on until it leaves it. Returns whether there
    is such an impact, the state after it and the code of the segments with its own.
    """
    (cos, sin, qa, sa, qb, sb, fa, fb), waa, wab, wbb = across
    na, ta, za, nb, tb, zb, cna, cta, cza, cnb, ctb, czb = state
    if cna > 0.0 or (cta == 0.0 and cza == 0.0):
        return False, state, segments
    alone = (1.0, 0.0, 0.0, 0.0, qa, sa, 0.0, fa), 1.0, 0.0, waa
    before = (FAR * (abs(cta) + abs(cza)), 0.0, 0.0, 0.0, cta, cza)
    (_, _, _, n, t, z, _, _, _, _, cta, cza), code, notes = follow(alone, before, small, 0.0)
    if notes & NO_SOLUTION or n == 0.0:
        return False, state, segments
    code, size = 4 * code, 16  # a digit of a path of B alone is the state of B
    while size <= code:
        size *= 16
    if segments * size < ROOM:
        segments = segments * size + code
    q = qa * n + sa * t
    cnb, ctb, czb = cnb + cos * n - sin * t + qb * q, ctb + cos * t + sin * n + sb * q, czb + wab * z
    return True, (na + n, ta + t, za + z, nb, tb, zb, 0.0, cta, cza, cnb, ctb, czb), segments


def grows(t: float, z: float, rate_t: float, rate_z: float) -> bool:
    """Whether a slip (t, z) grows in the direction that it has, as one does that has just begun."""
    along = t * rate_t + z * rate_z
    return along > 0.0 and along * along >= STRAIGHT * (t * t + z * z) * (rate_t * rate_t + rate_z * rate_z)


def spatial_states(across: Across, velocities: tuple[float, ...], compressing: bool) -> StatesAcross | None:
    """The first consistent states in the order O, S, slip (A before B); None where the path jams."""
    pair, _, _, _ = across
    cos, sin, qa, _, qb, sb, _, fb = pair
    contacts = planar_contacts(*pair)
    cna, cta, cza, _, ctb, czb = velocities
    way = way_of(cta, cza, ctb, czb, (1.0, 0.0, 1.0, 0.0), 0.0)
    if czb == 0.0 and (cna > 0.0 or cza == 0.0):
        found, a, b, rate = choose(contacts, cna, cta, ctb, compressing, 0)
        return (a, b, way, from_plane(rate), True) if found else None
    if ctb == 0.0 and czb == 0.0:
        b = state_alone(contacts, 0.0)
        alone = open_rates(contacts, b, cna)
        if alone[0]:
            return OPEN, b, way, from_plane(alone), True
        return slipping(across, SLIP, STICK, way) or set_off(across, 1, way)
    if cna > 0.0:
        return slipping(across, OPEN, SLIP, way)
    tb = -fb * way[2]
    lift, turn = tb * sin + cos, qa * (qb + tb * sb)
    if not below_rounding(lift + turn, ROUNDING, lift, turn):
        return slipping(across, OPEN, SLIP, way)
    if cta == 0.0 and cza == 0.0:
        return slipping(across, STICK, SLIP, way) or set_off(across, 0, way)
    return slipping(across, SLIP, SLIP, way)


def slipping(across: Across, a: int, b: int, way: Slips) -> StatesAcross | None:
    """These states, if their impulses lie within the cones."""
    rate = rates(across, a, b, way)
    if rate is None or margin(across, a, b, rate) < 0.0:
        return None
    return a, b, way, rate, False


def set_off(across: Across, contact: int, way: Slips) -> StatesAcross | None:
    """Both contacts slip, the one at rest, A (0) or B (1), in the direction in which its own slip grows.

    The direction is one that the slip keeps, and to which it returns when it is turned. Of several the slip that
    grows most is taken.
    """
    t, z = (7, 8) if contact == 0 else (10, 11)

    def towards(x: float, y: float) -> tuple[Slips, RatesAcross | None]:
        size = sqrt(x * x + y * y)
        x, y = x / size, y / size
        there = (x, y, way[2], way[3]) if contact == 0 else (way[0], way[1], x, y)
        return there, rates(across, SLIP, SLIP, there)

    def turning(x: float, y: float) -> float:
        _, rate = towards(x, y)
        return (x * rate[z] - y * rate[t]) if rate is not None and rate[0] >= 0.0 else -1.0

    best: StatesAcross | None = None
    growth = -SLACK
    turns = [turning(x, y) for x, y in COMPASS]
    for k, (x, y) in enumerate(COMPASS):
        u, v = COMPASS[k - 1]
        if turns[k - 1] > 0.0 >= turns[k]:

            def between(part: float, u: float = u, v: float = v, x: float = x, y: float = y) -> float:
                return turning(u + part * (x - u), v + part * (y - v))

            part = descent(between, turns[k - 1], turns[k])
            there, rate = towards(u + part * (x - u), v + part * (y - v))
            if rate is not None and rate[0] >= 0.0:
                grows = there[2 * contact] * rate[t] + there[2 * contact + 1] * rate[z]
                if grows > growth:
                    best, growth = (SLIP, SLIP, there, rate, False), grows
    return best


def descent(value: Callable[[float], float], first: float, last: float) -> float:
    """Where in 0..1 a value falls to zero, on the far side, from its values at both ends (regula falsi, Illinois)."""
    low, high, side = 0.0, 1.0, 0
    for _ in range(60):
        if high - low < SLACK or first == last:  # both are zero where halves of the least number were
            break
        middle = high - last * (high - low) / (last - first)
        middle = min(max(middle, low + 0.25 * SLACK), high - 0.25 * SLACK)
        now = value(middle)
        if now > 0.0:
            low, first = middle, now
            if side == 1:
                last *= 0.5
            side = 1
        else:
            high, last = middle, now
            if side == -1:
                first *= 0.5
            side = -1
    return high


def from_plane(rate: Rates) -> RatesAcross:
    """Rates of a body that no friction pushes across the plane."""
    _, na, ta, tb, rna, rta, rnb, rtb, _, _, _ = rate
    return na, ta, 0.0, 1.0, tb, 0.0, rna, rta, 0.0, rnb, rtb, 0.0
