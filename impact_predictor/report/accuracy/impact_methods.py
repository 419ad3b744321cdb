"""Methods for the impact itself: closed forms, the laws one at a time and in batches, and simpler models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from ...mechanics import closed_forms, contact_space
from ...mechanics.batch import solve_impacts
from ...mechanics.impact import solve_impact
from ...mechanics.transverse import Transverse, solve_transverse_impact
from ...mechanics.types import Contact, Mode, Twist
from ...prediction.impact import TOLERANCE
from .impact_scenes import After, Strike, joined
from .methods import Method, always, method, over

TOLERANCES = (1e-1, 1e-2, TOLERANCE, 1e-4, 1e-5, 1e-6)
EVERYWHERE = (TOLERANCE, 1e-6)
"""Tolerances for slip across the plane: that of the node among them; what slips only in the plane needs no more."""

SWEEPS = (1, 4, 16, 64, 256)

ACROSS = "path law with slip across"

FAMILIES = {
    "closed forms": "The paper's formulas, corrected: the mode from its domain, then its formula.",
    "path law": "The impulse path of this program (Routh's hypothesis): what the node uses.",
    "total law": "The paper's laws on the impulses of the whole impact, at both contacts at once.",
    "contact space": "The path law for any mechanism, from the mobility of its contacts alone.",
    ACROSS: "Friction against the slip across the plane, too; steps along the impulse, within a tolerance.",
    "no slip": "Housner's rocking model: the old contact leaves and the new one neither slips nor bounces.",
    "Gauss-Seidel": "The total law by projected Gauss-Seidel on the impulses, with n sweeps over the contacts, as "
    "game engines and many simulators solve it.",
}

NO_MOTION = Transverse(0.0)


def law(strike: Strike, name: str) -> After:
    """One impact by one of the laws."""
    outcome = solve_impact(strike.body, strike.twist, name)
    return After(outcome.twist, outcome.mode)


def batch(name: str) -> Callable[[Sequence[Strike]], Callable[[], list[After]]]:
    """Many impacts at once, compiled where numba is there."""

    def prepare(strikes: Sequence[Strike]) -> Callable[[], Any]:
        body, twist = joined(strikes)
        return lambda: solve_impacts(body, twist, name)

    return prepare


def closed_form(strike: Strike) -> After:
    """One impact by its formula."""
    found = getattr(closed_forms, strike.shape)(**strike.given)
    return After(Twist(*found.twist.tolist()), Mode(int(found.mode)))


def closed_batch(strikes: Sequence[Strike]) -> Callable[[], Any]:
    """Many impacts by their formula."""
    given = {name: np.array([strike.given[name] for strike in strikes]) for name in strikes[0].given}
    return lambda: getattr(closed_forms, strikes[0].shape)(**given)


def answers_of(found: Any) -> list[After]:
    """The answers in what a method gives for many problems at once, `Outcomes` or a `ClosedForm`."""
    return [
        After(Twist(*twist), Mode(mode)) for twist, mode in zip(found.twist.tolist(), found.mode.tolist(), strict=True)
    ]


Row = tuple[float, float, float]


def rows_of(contact: Contact) -> tuple[Row, Row]:
    """Rows of G: what the normal and the tangential velocity of a contact are of (vx, vy, omega)."""
    x, y, _, (nx, ny), _, _ = contact
    return (nx, ny, x * ny - y * nx), (ny, -nx, -(x * nx + y * ny))


def in_contact_space(strike: Strike) -> tuple[list[Row], list[list[float]], list[float]]:
    """The rows of both contacts, their mobilities W and their velocities."""
    mass, inertia, old, new = strike.body
    assert old is not None
    vx, vy, omega = strike.twist
    rows, velocities = [], []
    for contact in (old, new):
        ux, uy = contact.velocity
        for x, y, q in rows_of(contact):
            rows.append((x, y, q))
            velocities.append(x * (vx - ux) + y * (vy - uy) + q * omega)
    W = [[(x * u + y * v) / mass + q * w / inertia for u, v, w in rows] for x, y, q in rows]
    return rows, W, velocities


def pushed(strike: Strike, rows: list[Row], impulses: Sequence[float]) -> Twist:
    """The twist after impulses along the rows."""
    mass, inertia = strike.body[:2]
    x, y, q = (sum([row[i] * push for row, push in zip(rows, impulses, strict=True)]) for i in range(3))
    vx, vy, omega = strike.twist
    return Twist(vx + x / mass, vy + y / mass, omega + q / inertia)


def by_contact_space(strike: Strike) -> After:
    """W of the body's contacts, and the path law on it."""
    old, new = strike.body.old, strike.body.new
    assert old is not None
    rows, W, velocities = in_contact_space(strike)
    # The old contact rests up to rounding where the body turns about it.
    frictions, restitutions = (old.friction, new.friction), (old.restitution, new.restitution)
    outcome = contact_space.solve(W, velocities, frictions, restitutions)
    return After(pushed(strike, rows, (*outcome.impulses[0], *outcome.impulses[1])), outcome.mode)


def gauss_seidel(strike: Strike, sweeps: int) -> After:
    """Each impulse in turn makes its own contact velocity zero, as far as N >= 0 and |T| <= f N allow."""
    old, new = strike.body.old, strike.body.new
    assert old is not None
    rows, W, c = in_contact_space(strike)
    targets = [-contact.restitution * min(0.0, c[k]) for contact, k in ((old, 0), (new, 2))]
    impulses = [0.0] * 4
    frictions = old.friction, new.friction
    for _ in range(sweeps):
        for contact in (1, 0):
            k = 2 * contact
            row = W[k]
            impulses[k] = max(0.0, impulses[k] - (dot(row, impulses) + c[k] - targets[contact]) / row[k])
            row = W[k + 1]
            held = impulses[k + 1] - (dot(row, impulses) + c[k + 1]) / row[k + 1]
            most = frictions[contact] * impulses[k]
            impulses[k + 1] = max(-most, min(most, held))
    return After(pushed(strike, rows, impulses))


def dot(row: list[float], impulses: list[float]) -> float:
    return row[0] * impulses[0] + row[1] * impulses[1] + row[2] * impulses[2] + row[3] * impulses[3]


def no_slip(strike: Strike) -> After:
    """The angular momentum about the new contact stays, and the body turns about it."""
    mass, inertia, _, new = strike.body
    (vx, vy, omega), (ux, uy), x, y = strike.twist, new.velocity, new.x, new.y
    vx, vy = vx - ux, vy - uy
    after = (inertia * omega + mass * (y * vx - x * vy)) / (inertia + mass * (x * x + y * y))
    return After(Twist(ux + after * y, uy - after * x, after), Mode.PIVOT)


def across(strike: Strike, tolerance: float) -> After:
    """One impact with slip across the plane."""
    outcome = solve_transverse_impact(strike.body, strike.twist, strike.across or NO_MOTION, tolerance).outcome
    return After(outcome.twist, outcome.mode)


def stands(strike: Strike) -> bool:
    """Whether the body stands on an old contact that is not struck itself."""
    return strike.body.old is not None


def slips_across(strike: Strike) -> bool:
    """Whether the body also moves across the impact plane."""
    return strike.across is not None


ONE, MANY = "one at a time", "all of the scene at once"

METHODS: list[Method] = [
    method("closed forms", "closed forms", ONE, closed_form, lambda strike: bool(strike.shape)),
    Method(
        "closed forms", "closed forms", MANY, closed_batch, lambda strike: bool(strike.shape), answers_of=answers_of
    ),
    method("path law", "path law", ONE, lambda strike: law(strike, "path")),
    Method("path law", "path law", MANY, batch("path"), answers_of=answers_of),
    method("total law", "total law", ONE, lambda strike: law(strike, "total")),
    Method("total law", "total law", MANY, batch("total"), answers_of=answers_of),
    method("contact space", "contact space", "", by_contact_space, stands),
    *(
        method(
            ACROSS,
            ACROSS,
            f"tolerance = {tolerance:g}",
            partial(across, tolerance=tolerance),
            always if tolerance in EVERYWHERE else slips_across,
        )
        for tolerance in TOLERANCES
    ),
    *over("Gauss-Seidel", "projected Gauss-Seidel", "n = {}", SWEEPS, gauss_seidel, applies=stands),
    method("no slip", "no slip (Housner)", "", no_slip),
]
