"""Rates of a body that also slips across the impact plane, and one step along the impulse while its slips turn.

Friction at a contact opposes the whole slip (t, z), z being the transverse direction x cross y. Within its cone it
holds a contact at rest; else it is f N against the unit vector of the slip, so that its part in the plane is less
than the planar law's. Impulses Z_A, Z_B along z change the transverse velocities by the mobilities waa, wab, wbb and
nothing else; the plane answers as in `impact.contacts`, whose units hold here too.

Most steps are explicit, of order 3, and their last rates are the next step's first: P. Bogacki, L. F. Shampine, A 3(2)
pair of Runge-Kutta formulas, Applied Mathematics Letters 2 (1989). A step that ends the compression of B is one along
c_nB, whose end is known, and not along N_B: each of its rates counts for as much of N_B as stops c_nB.

A path that needs many steps is stiff: the direction of a slip that is about to vanish, or has just begun, follows
within an impulse r / m, r being the slip and m of the size of friction times mobility. Its other steps are linearly
implicit, by ROS3, of order 3 and L-stable: A. Sandu, J. G. Verwer, J. G. Blom, E. J. Spee, G. R. Carmichael,
F. A. Potra, Benchmarking stiff ODE solvers for atmospheric chemistry problems II, Atmospheric Environment 31 (1997).
The rates depend on no more than the directions of two slips, so that its linear systems are two by two.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

from .impact.contacts import OPEN, PLUS, STICK

SLIP = PLUS
"""State of a contact that slips in any direction."""

SLACK = 1e-12
"""A cone of friction left by less than this impulse, per unit of N_B, still holds: less is rounding."""

Pair = tuple[float, float, float, float, float, float, float, float]
"""Of a planar body: cosine and sine of the angle between the normals, moments of normal and tangent of A and of B (see
`impact.contacts`), and the frictions."""

Across = tuple[Pair, float, float, float]
"""The pair of contacts, and the transverse mobilities waa, wab, wbb in units of 1 / mass."""

Slips = tuple[float, float, float, float]
"""Unit vectors (t, z) of the slip at A and at B; of no meaning where a contact does not slip."""

State = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
"""N_A, T_A, Z_A, N_B, T_B, Z_B so far, and c_nA, c_tA, c_zA, c_nB, c_tB, c_zB; or the rates of all per unit N_B."""

PathSegment = tuple[int, int, Slips, State, bool]
"""States of A and B, the ways in which they slip, the rates, and whether these stay as they are."""

EXPLICIT = 24
"""Attempts at explicit steps before a path counts as stiff: one to a tolerance of 1e-3 needs two to eight."""

ATTEMPTS = 40
"""How often a step is shortened before the path counts as lost: by a factor of two at least each time."""

SURE = 0.1
"""What the second difference of the rates counts as the error of an explicit step. 1 / 24 would make it that of a step
of order 2, which is too little where a slip turns by much."""

GAMMA = 0.43586652150845900
C21, C31, C32 = -1.0156171083877702, 4.0759956452537700, 9.2076794298330791
M2, M3 = 6.1697947043828246, -0.42772256543218573
E1, E2, E3 = 0.5, -2.9079558716805470, 0.22354069897811570
"""Coefficients of ROS3 (the cited paper's table 2); those left out are 1."""

TURNED = 1e-7
"""rad. How far a slip is turned to see how the rates depend on its direction: half the digits of a double."""

Stage = tuple[float, float, float, float]
"""A stage of an implicit step: its parts of the rates at the beginning, those in the middle, and the derivatives of the
former by the angles of the slips at A and at B."""

NO_CHANGE: State = (0.0,) * 12


def rates(across: Across, a: int, b: int, way: Slips) -> State | None:
    """Rates while A is in state `a` and B in state `b`, at least one of them slipping along its `way`.

    None where no finite impulse at A keeps it closed (Painleve).
    """
    (cos, sin, qa, sa, qb, sb, fa, fb), waa, wab, wbb = across
    ut, uz, wt, wz = way
    na = ta = za = 0.0
    if b == STICK:
        # T_B keeps c_tB, so that N_A has less left to do.
        ax, hold, cross = -fa * ut, 1.0 + sb * sb, sin + sb * qa
        along = cross + ax * (cos + sb * sa)
        den = 1.0 + qa * (qa + ax * sa) - cross * along / hold
        if not den > 0.0:
            return None
        na = -(cos + qa * qb - cross * qb * sb / hold) / den
        ta, za = ax * na, -fa * uz * na
        tb, zb = -(qb * sb + na * along) / hold, -wab / wbb * za
        bx, by, bq = tb * cos - sin, tb * sin + cos, qb + tb * sb
    else:
        tb, zb = -fb * wt, -fb * wz
        bx, by, bq = tb * cos - sin, tb * sin + cos, qb + tb * sb
        if a == STICK:
            sa2, qa2 = 1.0 + sa * sa, 1.0 + qa * qa
            size = sa2 + qa * qa
            na = (qa * (sa * bx - bq) - by * sa2) / size
            ta = (sa * (qa * by - bq) - bx * qa2) / size
            za = -wab / waa * zb
        elif a != OPEN:
            ax = -fa * ut
            den = 1.0 + qa * (qa + ax * sa)
            if not den > 0.0:
                return None
            na = -(by + qa * bq) / den
            ta, za = ax * na, -fa * uz * na
    x, y, q = ta + bx, na + by, qa * na + sa * ta + bq
    rna = y + qa * q if a == OPEN else 0.0
    rta, rza = (0.0, 0.0) if a == STICK else (x + sa * q, waa * za + wab * zb)
    rtb, rzb = (0.0, 0.0) if b == STICK else (cos * x + sin * y + sb * q, wab * za + wbb * zb)
    return na, ta, za, 1.0, tb, zb, rna, rta, rza, cos * y - sin * x + qb * q, rtb, rzb


def margin(across: Across, a: int, b: int, rate: State | None) -> float:
    """How far the impulses of closed contacts are within their cones of friction, per unit N_B."""
    if rate is None:
        return -1.0
    na, ta, za, _, tb, zb, _, _, _, _, _, _ = rate
    (_, _, _, _, _, _, fa, fb), _, _, _ = across
    least = 1.0 if a == OPEN else na
    if a == STICK:
        least = min(least, fa * na - sqrt(ta * ta + za * za))
    if b == STICK:
        least = min(least, fb - sqrt(tb * tb + zb * zb))
    return least + SLACK


def way_of(cta: float, cza: float, ctb: float, czb: float, way: Slips, small: float = 0.0) -> Slips:
    """Directions of the slips; one of at most `small` keeps its direction."""
    ut, uz, wt, wz = way
    slip = sqrt(cta * cta + cza * cza)
    if slip > small:
        ut, uz = cta / slip, cza / slip
    slip = sqrt(ctb * ctb + czb * czb)
    if slip > small:
        wt, wz = ctb / slip, czb / slip
    return ut, uz, wt, wz


class Arc(NamedTuple):
    """A stretch of the path.

    The states at its ends; the rates there, and the N_B in which each of them would make the whole stretch; `work` of
    the normal impulse at B on the body; the ways of the slips at its end.
    """

    begin: State
    end: State
    first: State
    last: State
    first_span: float
    last_span: float
    work: float
    way: Slips

    def at(self, part: float) -> State:
        """The state at a part (0..1) of the stretch, by the cubic through both ends."""
        return tuple([self.component(index, part) for index in range(12)])  # type: ignore[return-value]

    def component(self, index: int, part: float) -> float:
        """A component of `at`."""
        first, last = self.first_span * self.first[index], self.last_span * self.last[index]
        return cubic(self.begin[index], self.end[index], first, last, part)

    def worked(self, part: float) -> float:
        """The work until a part of the stretch."""
        return cubic(0.0, self.work, self.first_span * self.begin[9], self.last_span * self.end[9], part)


def cubic(begin: float, end: float, first: float, last: float, part: float) -> float:
    """A part (0..1) of the way from `begin` to `end`, with the slopes `first` and `last` there."""
    slopes = (1.0 - part) * first - part * last
    return begin + part * part * (3.0 - 2.0 * part) * (end - begin) + part * (1.0 - part) * slopes


def advance(
    across: Across, phase: PathSegment, y: State, span: float, ends: bool, small: float, tries: int
) -> tuple[Arc, float, int] | None:
    """A step in which N_B grows by `span` or less, with an error below `small` in every slip; None where none is found.

    With `ends` the compression would end with the step, were the rates to stay. Returns also how far the next step may
    go, and the number of attempts on this path, `tries` before the step.
    """
    _, _, way, rate, straight = phase
    if straight or span == 0.0:
        end: State = tuple([p + span * q for p, q in zip(y, rate, strict=True)])  # type: ignore[assignment]
        work = 0.5 * span * (y[9] + end[9])
        arc = Arc(begin=y, end=end, first=rate, last=rate, first_span=span, last_span=span, work=work, way=way)
        return arc, inf, tries
    for attempt in range(tries, tries + ATTEMPTS):
        if attempt < EXPLICIT:
            step = explicit_step(across, phase, y, span, ends, small)
        else:
            step = implicit_step(across, phase, y, span, small)
        if step is None:
            span *= 0.25
        else:
            arc, error = step
            factor = 0.8 * sqrt(sqrt(small / error)) if error > 0.0 else 4.0
            if error <= small:
                return arc, min(factor, 4.0) * arc.last_span, attempt + 1
            span *= min(max(factor, 0.1), 0.5)
        ends = False
    return None


def explicit_step(
    across: Across, phase: PathSegment, y: State, span: float, ends: bool, small: float
) -> tuple[Arc, float] | None:
    """The stretch that a step makes, and the largest error of a slip in it.

    None where the rates end on the way: a slip jams, or B is not slowed down by all of them.
    """
    a, b, way, first, _ = phase
    _, _, _, _, _, _, _, cta, cza, cnb, ctb, czb = y
    _, _, _, _, _, _, _, rta1, rza1, rnb1, rtb1, rzb1 = first
    span2 = span3 = span4 = span
    h = 0.5 * span
    second = rates(across, a, b, way_of(cta + h * rta1, cza + h * rza1, ctb + h * rtb1, czb + h * rzb1, way))
    if second is None:
        return None
    _, _, _, _, _, _, _, rta2, rza2, rnb2, rtb2, rzb2 = second
    if ends:
        span2 = span * rnb1 / rnb2 if rnb2 > 0.0 else inf
    h = 0.75 * span2
    third = rates(across, a, b, way_of(cta + h * rta2, cza + h * rza2, ctb + h * rtb2, czb + h * rzb2, way))
    if third is None:
        return None
    if ends:
        span3 = span * rnb1 / third[9] if third[9] > 0.0 else inf

    p, q, r = 2.0 / 9.0 * span, 1.0 / 3.0 * span2, 4.0 / 9.0 * span3
    end: State = tuple([v + p * d + q * e + r * f for v, d, e, f in zip(y, first, second, third, strict=True)])  # type: ignore[assignment]
    _, _, _, _, _, _, _, cta, cza, _, ctb, czb = end
    there = way_of(cta, cza, ctb, czb, way, small)
    last = rates(across, a, b, there)
    if last is None:
        return None
    _, _, _, _, _, _, _, rta4, rza4, rnb4, rtb4, rzb4 = last
    if ends:
        span4 = span * rnb1 / rnb4 if rnb4 > 0.0 else inf
        if not span2 + span3 + span4 < inf:
            return None
    error = SURE * max(
        abs(span * rta1 - 2.0 * span2 * rta2 + span4 * rta4),
        abs(span * rza1 - 2.0 * span2 * rza2 + span4 * rza4),
        abs(span * rtb1 - 2.0 * span2 * rtb2 + span4 * rtb4),
        abs(span * rzb1 - 2.0 * span2 * rzb2 + span4 * rzb4),
    )
    work = p * cnb + q * (cnb + 0.5 * span * rnb1) + r * (cnb + 0.75 * span2 * rnb2)
    arc = Arc(begin=y, end=end, first=first, last=last, first_span=span, last_span=span4, work=work, way=there)
    return arc, error


def implicit_step(across: Across, phase: PathSegment, y: State, span: float, small: float) -> tuple[Arc, float] | None:
    """As `explicit_step`, linearly implicit and along N_B; the error is that of all contact velocities.

    None where the step is too long: a slip turns away further than it can be followed, or jams.
    """
    a, b, way, rate, _ = phase
    (_, _, _, _, _, _, friction_a, friction_b), _, _, _ = across
    ut, uz, wt, wz = way
    _, _, _, _, _, _, _, cta, cza, _, ctb, czb = y
    turn_a = turn_b = NO_CHANGE
    # A contact that does not slip, or without friction, has no angle that matters.
    ra = rb = 1.0
    if a == SLIP and friction_a > 0.0:
        turn_a = derivative(across, a, b, (ut - TURNED * uz, uz + TURNED * ut, wt, wz), rate)
        ra = sqrt(cta * cta + cza * cza)
    if b == SLIP and friction_b > 0.0:
        turn_b = derivative(across, a, b, (ut, uz, wt - TURNED * wz, wz + TURNED * wt), rate)
        rb = sqrt(ctb * ctb + czb * czb)
    (aa, ba), (ab, bb) = turning(way, turn_a), turning(way, turn_b)
    h = GAMMA * span
    left_a, left_b = ra - h * aa, rb - h * bb
    det = left_a * left_b - h * h * ab * ba
    if not (left_a >= 0.5 * ra and left_b >= 0.5 * rb and det > 0.0):
        return None

    def stage(rated: float, middled: float, turned_a: float, turned_b: float) -> Stage:
        """The stage of a force that is these parts of rate, middle, turn_a and turn_b, as such parts itself."""
        # Forces across the slips turn them.
        fa = h * (rated * rate_a + middled * middle_a + turned_a * aa + turned_b * ab)
        fb = h * (rated * rate_b + middled * middle_b + turned_a * ba + turned_b * bb)
        ya, yb = (left_b * fa + h * ab * fb) / det, (left_a * fb + h * ba * fa) / det
        return h * rated, h * middled, h * (turned_a + ya), h * (turned_b + yb)

    rate_a, rate_b = turning(way, rate)
    middle_a = middle_b = 0.0
    a1, _, c1, d1 = stage(1.0, 0.0, 0.0, 0.0)
    moved = zip(y, rate, turn_a, turn_b, strict=True)
    _, _, _, _, _, _, _, cta, cza, _, ctb, czb = [v + a1 * p + c1 * q + d1 * r for v, p, q, r in moved]
    middle = rates(across, a, b, way_of(cta, cza, ctb, czb, way))
    if middle is None:
        return None
    middle_a, middle_b = turning(way, middle)
    c = C21 / span
    a2, b2, c2, d2 = stage(c * a1, 1.0, c * c1, c * d1)
    c, d = C31 / span, C32 / span
    a3, b3, c3, d3 = stage(c * a1 + d * a2, 1.0 + d * b2, c * c1 + d * c2, c * d1 + d * d2)

    changes = list(zip(rate, middle, turn_a, turn_b, strict=True))
    to_rate, to_middle = a1 + M2 * a2 + M3 * a3, M2 * b2 + M3 * b3
    to_a, to_b = c1 + M2 * c2 + M3 * c3, d1 + M2 * d2 + M3 * d3
    end: State = tuple(  # type: ignore[assignment]
        [v + to_rate * p + to_middle * q + to_a * r + to_b * s for v, (p, q, r, s) in zip(y, changes, strict=True)]
    )
    to_rate, to_middle = E1 * a1 + E2 * a2 + E3 * a3, E2 * b2 + E3 * b3
    to_a, to_b = E1 * c1 + E2 * c2 + E3 * c3, E1 * d1 + E2 * d2 + E3 * d3
    error = max([abs(to_rate * p + to_middle * q + to_a * r + to_b * s) for p, q, r, s in changes[6:]])
    _, _, _, _, _, _, _, cta, cza, cnb, ctb, czb = end
    there = way_of(cta, cza, ctb, czb, way, small)
    last = rates(across, a, b, there)
    if last is None:
        return None
    work = span * (0.5 * (y[9] + cnb) + span * (rate[9] - last[9]) / 12.0)
    arc = Arc(begin=y, end=end, first=rate, last=last, first_span=span, last_span=span, work=work, way=there)
    return arc, error


def turning(way: Slips, rate: State) -> tuple[float, float]:
    """How fast the slips at A and at B turn, times their sizes."""
    ut, uz, wt, wz = way
    _, _, _, _, _, _, _, rta, rza, _, rtb, rzb = rate
    return ut * rza - uz * rta, wt * rzb - wz * rtb


def derivative(across: Across, a: int, b: int, turned: Slips, rate: State) -> State:
    """Derivative of the rates by the angle of a slip, from those where it is turned a little."""
    there = rates(across, a, b, turned)
    return NO_CHANGE if there is None else tuple([(p - q) / TURNED for p, q in zip(there, rate, strict=True)])  # type: ignore[return-value]
