"""Contact states of a body that also slips across the impact plane, and the rates that they give.

Friction at a contact opposes the whole slip (t, z), z being the transverse direction x cross y. Within its cone it
holds a contact at rest; else it is f N against the unit vector of the slip, so that its part in the plane is less
than the planar law's. Impulses Z_A, Z_B along z change the transverse velocities by the mobilities waa, wab, wbb and
nothing else; the plane answers as in `impact.contacts`, whose units hold here too.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

from .impact.contacts import OPEN, PLUS, ROUNDING, STICK, below_rounding, planar_contacts
from .impact.rates import Rates as PlanarRates
from .impact.rates import choose, open_rates, state_alone

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

RatesAcross = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
"""Per unit N_B: N_A, T_A, Z_A, N_B (1), T_B, Z_B and the rates of c_nA, c_tA, c_zA, c_nB, c_tB, c_zB."""

StatesAcross = tuple[int, int, Slips, RatesAcross, bool]
"""StatesAcross of A and B, the directions in which they slip, the rates, and whether these stay as they are."""

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


def rates(across: Across, a: int, b: int, way: Slips) -> RatesAcross | None:
    """RatesAcross while A is in state `a` and B in state `b`, at least one of them slipping along its `way`.

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


def margin(across: Across, a: int, b: int, rate: RatesAcross) -> float:
    """How far the impulses of closed contacts are within their cones of friction, per unit N_B."""
    na, ta, za, _, tb, zb = rate[:6]
    pair = across[0]
    least = 1.0 if a == OPEN else na
    if a == STICK:
        least = min(least, pair[6] * na - sqrt(ta * ta + za * za))
    if b == STICK:
        least = min(least, pair[7] - sqrt(tb * tb + zb * zb))
    return least + SLACK


def way_of(cta: float, cza: float, ctb: float, czb: float, way: Slips, small: float) -> Slips:
    """Directions of the slips; one of at most `small` keeps its direction."""
    ut, uz, wt, wz = way
    slip = sqrt(cta * cta + cza * cza)
    if slip > small:
        ut, uz = cta / slip, cza / slip
    slip = sqrt(ctb * ctb + czb * czb)
    if slip > small:
        wt, wz = ctb / slip, czb / slip
    return ut, uz, wt, wz


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


def from_plane(rate: PlanarRates) -> RatesAcross:
    """RatesAcross of a body that no friction pushes across the plane."""
    _, na, ta, tb, rna, rta, rnb, rtb, _, _, _ = rate
    return na, ta, 0.0, 1.0, tb, 0.0, rna, rta, 0.0, rnb, rtb, 0.0
