"""One impact of a body that also slips across the impact plane: `solve_transverse_impact`.

The body is rigid and moves in space: in the plane with (vx, vy, omega), across it with the velocity vz of the mass
centre along z = x cross y, the roll rate about x and the yaw rate about y. Its contacts lie in the plane of the mass
centre, and x, y, z are principal axes (an edge that lies along z stands for its middle). Then a contact at (x, y) moves
across the plane with

    c_z = vz + roll y - yaw x,

an impulse Z at it changes vz by Z / m, roll by y Z / J_roll and yaw by -x Z / J_yaw, and neither acts on the motion in
the plane: the contact velocities answer Z_A, Z_B with the mobilities

    w_ij = 1 / m + y_i y_j / J_roll + x_i x_j / J_yaw.

An infinite inertia blocks a rotation. Two corners at each end of an edge along z block the roll, which would lift one
of them, while the tilting moment h Z stays below their normal impulses times half the edge; yaw remains, and the
friction that the corners of one edge add against it by slipping in opposite directions is left out. A body on single
points is free to roll.

What joins the plane and z is friction: it opposes the whole slip (c_t, c_z), so that a body that slides across the
plane has less friction left in it. While A or B slips across the plane the rates turn with the slips (Routh's
hypothesis), and the path is integrated along the normal impulse of B (one contact: J. B. Keller, Impact with friction,
Journal of Applied Mechanics 53 (1986)). Once no closed contact slips across the plane any more the rest is straight,
with the states of the planar law.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, isfinite, nan, sqrt
from typing import NamedTuple

from .impact import NOWHERE, outcome_of, solve_impact
from .impact.answer import INVALID_INPUT, OLD_RESTITUTION_IGNORED, PATH, VALIDITY, doubts, mode_of, unchanged
from .impact.contacts import (
    JAMMED,
    MINUS,
    NO_SOLUTION,
    OPEN,
    PLUS,
    REVERSED,
    ROUNDING,
    SHARED_FRICTION,
    SPEED_ROUNDING,
    STICK,
    WORK_LIMITED,
    below_rounding,
    planar_contacts,
    problem_of,
    twist_after,
)
from .impact.path_law import ROOM
from .impact.rates import Rates, choose, open_rates, state_alone
from .impact.restitution import poisson
from .motion.events import falling_root
from .transverse_step import (
    EXPLICIT,
    SLACK,
    SLIP,
    Across,
    Arc,
    PathSegment,
    Slips,
    State,
    advance,
    margin,
    rates,
    way_of,
)
from .types import Contact, Flag, Outcome, Twist, TwoPointBody, Validity

GAIN = 10.0
"""Energy may rise by this many times the tolerance, of mass times these speeds squared: more is no error of the
steps but roundings of a body far from any shape."""

MAX_STEPS = 400
"""An impact needs two to forty, at the finest tolerance two hundred; jams can follow each other without end."""

FAR = 1e9
"""A contact that does not exist leaves this many times faster than anything moves."""

BEYOND = 1.25
"""How much further than the next event is foreseen a step may reach, so that it falls within one step."""

ARRIVED = 1.0 - 1e-12
"""An impulse above this part of the one aimed at is it."""

STRAIGHT = 0.9
"""Square of the cosine of the angle from a slip to its rate below which it grows in its direction."""

QUARTER = tuple([(4.0 / sqrt(16.0 + k * k), k / sqrt(16.0 + k * k)) for k in range(-4, 4)])
COMPASS = QUARTER + tuple(
    [(-z, t) for t, z in QUARTER] + [(-t, -z) for t, z in QUARTER] + [(z, -t) for t, z in QUARTER]
)
"""Directions (t, z) all around, in the order of their angle."""

SpatialPath = tuple[State, int, int]
"""The state at the end of an impact; the contact states along it (see `impact.contacts`); notes."""

SpatialVelocities = tuple[float, float, float, float, float, float]
"""c_nA, c_tA, c_zA, c_nB, c_tB, c_zB."""


class Transverse(NamedTuple):
    """Motion of a body across the impact plane, relative to its supports, and its inertia in it.

    `velocity` of the mass centre along z in m/s; `roll` and `yaw` rates about x and y in rad/s; the inertias about x
    and y in kg m^2, infinite where the contacts block the rotation, the rate of which is 0 then.
    """

    velocity: float
    roll: float = 0.0
    yaw: float = 0.0
    roll_inertia: float = inf
    yaw_inertia: float = inf


class TransverseOutcome(NamedTuple):
    """What an impact does to a body that also slips across the plane.

    `outcome` in the plane, where + and - in the segments are the signs of the slip's part in the plane, and
    `energy_lost` is that of the whole motion; `transverse` the motion across the plane after it; `impulses` along z at
    the old and the new contact in N s.
    """

    outcome: Outcome
    transverse: Transverse
    impulses: tuple[float, float]


def solve_transverse_impact(
    body: TwoPointBody,
    twist: Twist,
    transverse: Transverse,
    tolerance: float = 1e-4,
    validity: Validity = VALIDITY,
) -> TransverseOutcome:
    """What the impact at the new contact does to a body that also moves across the impact plane.

    As `solve_impact` by its path law, with friction against the whole slip. `tolerance`, part of the sum of the contact
    speeds in the plane and 1e-7 at the finest, bounds the error of a slip in each step along the impulse; slower slips
    end.

    Without slip across the plane the answer is that of `solve_impact`, to the last bit, and where both contacts are
    struck it answers for the plane alone. Where the path is lost it does so too, with Flag.LAST_RESORT. Input that no
    body can have gives Flag.INVALID_INPUT, never an exception. Where several contact states are consistent the first is
    followed and the others are not told.
    """
    mass, inertia, old, new = body
    stands, foot = old is not None, old or NOWHERE
    velocity, roll, yaw, roll_inertia, yaw_inertia = transverse
    cza, czb = slip_across(foot, transverse) if stands else 0.0, slip_across(new, transverse)
    if not (isfinite(velocity + roll + yaw + cza + czb) and roll_inertia > 0.0 and yaw_inertia > 0.0):
        velocity, roll, yaw = (rate if isfinite(rate) else 0.0 for rate in (velocity, roll, yaw))
        still = transverse._replace(velocity=velocity, roll=roll, yaw=yaw)
        return TransverseOutcome(outcome_of(unchanged(twist, INVALID_INPUT, PATH)), still, (0.0, 0.0))
    valid, problem, frame = problem_of(mass, inertia, stands, foot, new, twist)
    contacts, (restitution_old, restitution), (cna, cta, cnb, ctb), _ = problem
    if (cza == 0.0 and czb == 0.0) or not valid or cna < 0.0 or cnb >= 0.0:
        return TransverseOutcome(solve_impact(body, twist, "path", validity), transverse, (0.0, 0.0))

    (_, _, qa, sa, fa), (minus_sin, cos, qb, _, _, sb, _, fb), _, _, _ = contacts
    speed = abs(cta) + abs(cnb) + abs(ctb) + (cna if stands else 0.0)
    waa, wab, wbb = 1.0, 0.0, mobility(new, new, mass, transverse)
    if stands:
        waa, wab = mobility(foot, foot, mass, transverse), mobility(foot, new, mass, transverse)
    (na, ta, za, nb, tb, zb, vna, vta, vza, vnb, vtb, vzb), segments, notes = follow(
        ((cos, -minus_sin, qa, sa, qb, sb, fa, fb), waa, wab, wbb),
        (cna if stands else FAR * speed, cta, cza, cnb, ctb, czb),
        tolerance * speed,
        restitution,
    )
    dx, dy = ta + tb * cos + nb * minus_sin, na - tb * minus_sin + nb * cos
    twist_now = twist_after(twist, frame, dx, dy, qa * na + sa * ta + qb * nb + sb * tb)
    across_now = transverse._replace(
        velocity=velocity + za + zb,
        roll=roll + mass * (foot.y * za + new.y * zb) / roll_inertia,
        yaw=yaw - mass * (foot.x * za + new.x * zb) / yaw_inertia,
    )
    work = nb * (cnb + vnb) + tb * (ctb + vtb) + zb * (czb + vzb)
    if stands:
        work += na * (cna + vna) + ta * (cta + vta) + za * (cza + vza)
    lost = notes & NO_SOLUTION or work > GAIN * tolerance * speed * speed
    if lost or not isfinite(sum(twist_now) + sum(across_now[:3]) + mass * work):
        outcome = solve_impact(body, twist, "path", validity)
        return TransverseOutcome(outcome._replace(flags=outcome.flags | Flag.LAST_RESORT), transverse, (0.0, 0.0))

    mode = mode_of(tolerance * speed, vna, sqrt(vta * vta + vza * vza), vnb, sqrt(vtb * vtb + vzb * vzb))
    notes |= doubts(contacts, stands, nb, validity) | (OLD_RESTITUTION_IGNORED if restitution_old > 0.0 else 0)
    na, ta, nb, tb = mass * na, mass * ta, mass * nb, mass * tb
    found = mode, twist_now, na, ta, nb, tb, segments, notes, -0.5 * mass * work, True, PATH
    return TransverseOutcome(outcome_of(found), across_now, (mass * za, mass * zb))


def slip_across(contact: Contact, transverse: Transverse) -> float:
    """Velocity of the body at a contact across the plane (m/s); rounding counts as zero."""
    velocity, roll, yaw, _, _ = transverse
    by_roll, by_yaw = roll * contact.y, yaw * contact.x
    slip = velocity + by_roll - by_yaw
    return slip if abs(slip) > SPEED_ROUNDING * (abs(velocity) + abs(by_roll) + abs(by_yaw)) else 0.0


def mobility(one: Contact, other: Contact, mass: float, transverse: Transverse) -> float:
    """How an impulse across the plane at one contact moves the other across it, times the mass."""
    return mass * (1.0 / mass + one.y * other.y / transverse.roll_inertia + one.x * other.x / transverse.yaw_inertia)


def follow(across: Across, before: SpatialVelocities, small: float, restitution: float) -> SpatialPath:
    """Follow the impulse path of a body of unit mass from contact velocities with c_nB <= 0 and c_nA >= 0.

    The restitution at B is Poisson's, limited by the work that the compression stored. A step adds less than `small` to
    the error of a slip, and slower slips end. NO_SOLUTION in the notes says that the path was lost on the way.
    """
    (_, _, _, sa, _, sb, fa, fb), waa, _, wbb = across
    turn_a, turn_b = (fa * max(1.0 + sa * sa, waa)) ** 2, (fb * max(1.0 + sb * sb, wbb)) ** 2
    state: State = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, *before)
    _, first_a, _, _, first_b, _ = before
    phase: PathSegment | None = None
    target, reach = inf, inf
    compressing = True
    told, segments, notes, tries = -1, 0, 0, 0
    work = 0.0
    for steps in range(MAX_STEPS):
        _, _, _, nb, _, _, _, _, _, cnb, _, _ = state
        if compressing and cnb >= 0.0 and steps:
            if restitution == 0.0 or cnb > 0.0:
                return state, segments, notes
            compressing, target, told = False, poisson(restitution, nb), -1
        elif not compressing and (nb >= ARRIVED * target or work <= 0.0):
            if cnb >= -small:
                return state, segments, notes
            # B was pressed again while it expanded: a plastic compression ends that.
            compressing, restitution, told = True, 0.0, -1
        if phase is None:
            phase = phase_at(across, state, compressing)
        if phase is None:
            freed, state, segments = strike_old(across, state, small, segments)
            if not freed:
                break
            notes |= JAMMED
            continue
        a, b, way, rate, straight = phase
        _, _, _, nb, _, _, cna, cta, cza, cnb, ctb, czb = state
        _, _, _, _, _, _, rna, rta, rza, rnb, rtb, rzb = rate
        sign_a, sign_b = a, b
        if a >= PLUS:
            slip = cta or rta
            sign_a = MINUS if slip < 0.0 else PLUS
            first_a = first_a or slip
            notes |= REVERSED if slip * first_a < 0.0 else 0
        if b >= PLUS:
            slip = ctb or rtb
            sign_b = MINUS if slip < 0.0 else PLUS
            first_b = first_b or slip
            notes |= REVERSED if slip * first_b < 0.0 else 0
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
        if a >= PLUS:
            span = min(span, until_turned(cta, cza, rta, rza, 0.0 if straight else turn_a))
        if b >= PLUS:
            span = min(span, until_turned(ctb, czb, rtb, rzb, 0.0 if straight else turn_b))
        whole = target - nb
        if compressing:
            whole = -cnb / rnb if rnb > 0.0 else inf
        ends, span = whole <= span, min(whole, span)
        if span == inf:
            break
        step = advance(across, phase, state, span, ends and compressing, small, tries)
        if step is None:
            break
        arc, further, tries = step
        if tries >= EXPLICIT:
            turn_a = turn_b = 0.0
        reach = further if further < inf else reach
        event, spent = first_event(across, phase, arc, inf if compressing else work, small)
        state, way, rate = arc.end, arc.way, arc.last
        if event <= 1.0:
            state = arc.at(event)
            if not straight:
                _, _, _, _, _, _, _, cta, cza, _, ctb, czb = state
                way = way_of(cta, cza, ctb, czb, way, small)
                rate = rates(across, a, b, way) or rate
        work = 0.0 if spent else work - arc.worked(min(event, 1.0))
        notes |= WORK_LIMITED if spent else 0

        # What has come to zero is made exactly zero.
        na, ta, za, nb, tb, zb, cna, cta, cza, cnb, ctb, czb = state
        _, _, _, _, _, _, rna, rta, rza, rnb, rtb, rzb = rate
        ended = straight or event <= 1.0
        if compressing and cnb >= -small and rnb > 0.0:
            cnb = 0.0
        if a == OPEN:
            if cna <= small and rna < 0.0:
                cna, ended = 0.0, True
        elif a >= PLUS and rests(cta, cza, rta, rza, small):
            cta, cza, ended = 0.0, 0.0, True
        if b >= PLUS and rests(ctb, czb, rtb, rzb, small):
            ctb, czb, ended = 0.0, 0.0, True
        if abs(czb) <= small and (cna > 0.0 or abs(cza) <= small) and (czb != 0.0 or (cza != 0.0 and cna == 0.0)):
            czb, ended = 0.0, True
            cza = cza if cna > 0.0 else 0.0
        state = (na, ta, za, nb, tb, zb, cna, cta, cza, cnb, ctb, czb)
        phase = None if ended else (a, b, way, rate, False)
    return state, segments, notes | NO_SOLUTION


def strike_old(across: Across, state: State, small: float, segments: int) -> tuple[bool, State, int]:
    """End a jam by a tangential impact at A: B is held, and A follows its own one-contact path.

    Its normal impulse grows while its slip presses it into the support and on until it leaves it. Returns whether there
    is such an impact, the state after it and the code of the segments with its own.
    """
    (cos, sin, qa, sa, qb, sb, fa, fb), waa, wab, _ = across
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


def until_turned(t: float, z: float, rate_t: float, rate_z: float, least: float) -> float:
    """The impulse of its own size within which a slip that slows down turns, or passes zero; inf if it does not."""
    if t * rate_t + z * rate_z >= 0.0:
        return inf
    return sqrt((t * t + z * z) / max(rate_t * rate_t + rate_z * rate_z, least))


def rests(t: float, z: float, rate_t: float, rate_z: float, small: float) -> bool:
    """Whether a slip (t, z) has ended: it is small, and does not grow in its own direction as one that has begun."""
    square = t * t + z * z
    if square > small * small:
        return False
    along = t * rate_t + z * rate_z
    return not (along > 0.0 and along * along >= STRAIGHT * square * (rate_t * rate_t + rate_z * rate_z))


def first_event(across: Across, phase: PathSegment, arc: Arc, work: float, small: float) -> tuple[float, bool]:
    """The part of a stretch after which the first condition ends, inf without one, and whether it is B's work.

    `work` is what B has stored, inf while it is compressed.
    """
    a, b, _, _, straight = phase
    _, _, _, nb, _, _, cna, _, _, cnb, _, _ = arc.begin
    _, _, _, _, _, _, cna_end, _, _, cnb_end, _, _ = arc.end
    event = spent = inf
    if arc.work > work + small * nb:
        event = spent = descent(lambda part: work - arc.worked(part), work, work - arc.work)
    elif work == inf and cnb_end > small:
        event = descent(lambda part: -arc.component(9, part), -cnb, -cnb_end)
    if a == OPEN and cna > 0.0 and cna_end < -small:
        event = min(event, descent(lambda part: arc.component(6, part), cna, cna_end))
    last = 1.0 if straight else margin(across, a, b, arc.last)
    if last < 0.0:

        def held(part: float) -> float:
            _, _, _, _, _, _, _, cta, cza, _, ctb, czb = arc.at(part)
            return margin(across, a, b, rates(across, a, b, way_of(cta, cza, ctb, czb, arc.way, small)))

        event = min(event, descent(held, margin(across, a, b, arc.first), last))
    return event, event == spent < inf


def phase_at(across: Across, state: State, compressing: bool) -> PathSegment | None:
    """The first consistent states in the order O, S, slip (A before B); None where the path jams."""
    pair, _, _, _ = across
    cos, sin, qa, _, qb, sb, _, fb = pair
    contacts = planar_contacts(*pair)
    _, _, _, _, _, _, cna, cta, cza, _, ctb, czb = state
    way = way_of(cta, cza, ctb, czb, (1.0, 0.0, 1.0, 0.0))
    if czb == 0.0 and (cna > 0.0 or cza == 0.0):
        found, a, b, rate = choose(contacts, cna, cta, ctb, compressing, 0)
        return (a, b, way, from_plane(rate), True) if found else None
    if ctb == 0.0 and czb == 0.0:
        b = state_alone(contacts, 0.0)
        alone = open_rates(contacts, b, cna)
        if alone[0]:
            return OPEN, b, way, from_plane(alone), True
        return slipping(across, SLIP, STICK, way) or set_off(across, 1, way)
    _, _, ways_t, _ = way
    tb = -fb * ways_t
    lift, turn = tb * sin + cos, qa * (qb + tb * sb)
    if cna > 0.0 or not below_rounding(lift + turn, ROUNDING, lift, turn):
        return slipping(across, OPEN, SLIP, way)
    if cta == 0.0 and cza == 0.0:
        return slipping(across, STICK, SLIP, way) or set_off(across, 0, way)
    return slipping(across, SLIP, SLIP, way)


def slipping(across: Across, a: int, b: int, way: Slips) -> PathSegment | None:
    """These states, if their impulses lie within the cones."""
    rate = rates(across, a, b, way)
    return None if rate is None or margin(across, a, b, rate) < 0.0 else (a, b, way, rate, False)


def set_off(across: Across, contact: int, way: Slips) -> PathSegment | None:
    """Both contacts slip, the one at rest, A (0) or B (1), in the direction in which its own slip grows.

    The direction is one that the slip keeps, and to which it returns when it is turned. Of several the slip that
    grows most is taken.
    """

    def towards(k: int, part: float) -> tuple[PathSegment | None, float, float]:
        """The phase with a direction next to the k-th; how fast the slip turns in it, and how fast it grows."""
        (u, v), (t, z), (ut, uz, wt, wz) = COMPASS[k - 1], COMPASS[k], way
        t, z = u + part * (t - u), v + part * (z - v)
        size = sqrt(t * t + z * z)
        t, z = t / size, z / size
        there = (t, z, wt, wz) if contact == 0 else (ut, uz, t, z)
        rate = rates(across, SLIP, SLIP, there)
        if rate is None or rate[0] < 0.0:
            return None, -1.0, 0.0
        rate_t, rate_z = rate[7:9] if contact == 0 else rate[10:]
        return (SLIP, SLIP, there, rate, False), t * rate_z - z * rate_t, t * rate_t + z * rate_z

    best, most = None, -SLACK
    turns = [towards(k, 1.0)[1] for k in range(len(COMPASS))]
    for k in range(len(COMPASS)):
        if turns[k - 1] > 0.0 >= turns[k]:
            at = descent(lambda part, k=k: towards(k, part)[1], turns[k - 1], turns[k])  # type: ignore[misc]
            phase, _, growth = towards(k, at)
            if phase is not None and growth > most:
                best, most = phase, growth
    return best


def descent(value: Callable[[float], float], first: float, last: float) -> float:
    """Where in 0..1 a value falls to zero, on the far side, from its values at both ends."""
    guess = first / (first - last) if first > 0.0 else 0.5
    return min(falling_root(lambda part: (value(part), nan), 1.0, last, guess) + SLACK, 1.0)


def from_plane(rate: Rates) -> State:
    """Rates of a body that no friction pushes across the plane."""
    _, na, ta, tb, rna, rta, rnb, rtb, _, _, _ = rate
    return na, ta, 0.0, 1.0, tb, 0.0, rna, rta, 0.0, rnb, rtb, 0.0
