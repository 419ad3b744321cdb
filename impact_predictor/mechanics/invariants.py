"""What holds for every impact, as numbers that rounding alone keeps from being zero.

Each is computed for arrays of problems and their outcomes from the statements of mechanics, without the laws' code. A
violation is relative to the terms that it is the sum of; where an invariant does not apply it is zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .impact.batch import Outcomes, solve_impacts
from .random_problems import CHUNK, KINDS, STIFF, random_problems
from .types import Contact, Flag, Twist, TwoPointBody

Violations = NDArray[np.float64]
Solve = Callable[[TwoPointBody, Twist, str], Outcomes]

UNITS = 2.0**20, 2.0**-13, 2.0**7
"""Units of mass, length and time: powers of two, which change no digit."""

STEP = 2.0**-40
"""Part by which friction and places change, to see that the outcome does not jump."""

UNANSWERED = int(Flag.NO_SOLUTION | Flag.INVALID_INPUT)


class SolvedProblems(NamedTuple):
    """Problems, whose fields may be arrays (...) as for `solve_impacts`, and their outcomes by a law."""

    body: TwoPointBody
    twist: Twist
    law: str
    solve: Solve
    outcomes: Outcomes

    @property
    def contacts(self) -> list[tuple[Contact, Violations, Violations]]:
        """The contacts, with their normal and tangential impulses (N s)."""
        impulses = self.outcomes.impulses
        both = enumerate((self.body.old, self.body.new))
        return [(contact, impulses[..., i, 0], impulses[..., i, 1]) for i, contact in both if contact is not None]

    @property
    def supports_move(self) -> NDArray[np.bool_]:
        """Whether the support of a contact moves."""
        speeds = [abs(part) for contact, _, _ in self.contacts for part in contact.velocity]
        return np.asarray(largest(speeds) > 0.0)

    def terms(self, *twists: Any) -> Violations:
        """The largest size of the terms of the contact velocities (m/s) in several twists."""
        return largest([sum(velocity(contact, twist)[2] for twist in twists) for contact, _, _ in self.contacts])

    def apart(self, one: Any, other: Any) -> Violations:
        """How far two twists after are apart at the contacts: a part of the terms of the contact velocities."""
        found = []
        for contact, _, _ in self.contacts:
            (n, t, _), (other_n, other_t, _) = velocity(contact, one), velocity(contact, other)
            found += [abs(n - other_n), abs(t - other_t)]
        return relative(largest(found), self.terms(self.twist, one, other))


def parts(twist: Any) -> tuple[Any, Any, Any]:
    """vx, vy and omega of a twist, or of an array (..., 3) of them."""
    return tuple(np.moveaxis(twist, -1, 0)) if isinstance(twist, np.ndarray) else twist


def velocity(contact: Contact, twist: Any) -> tuple[Any, Any, Any]:
    """Normal and tangential velocity of a contact relative to its support, and the size of their terms (m/s)."""
    vx, vy, omega = parts(twist)
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    px, py = omega * contact.y, omega * contact.x
    cx, cy = vx - px - ux, vy + py - uy
    terms = abs(vx) + abs(vy) + abs(px) + abs(py) + abs(ux) + abs(uy)
    return nx * cx + ny * cy, ny * cx - nx * cy, terms


def relative(value: Any, size: Any) -> Violations:
    """A value as a part of a size; where both are zero it is zero."""
    value, size = np.broadcast_arrays(value, size)
    return np.asarray(np.divide(value, size, out=np.zeros(value.shape), where=size > 0.0))


def largest(values: list[Any]) -> Violations:
    return np.asarray(np.maximum.reduce(np.broadcast_arrays(*values)))


def not_finite(solved: SolvedProblems) -> Violations:
    """1 where a number of an outcome is not finite."""
    outcomes = solved.outcomes
    total = outcomes.energy_lost + outcomes.twist.sum(-1) + outcomes.impulses.sum((-1, -2))
    return np.asarray(~np.isfinite(total), np.float64)


def outside_cones(solved: SolvedProblems) -> Violations:
    """How far impulses lie outside of their friction cones (Coulomb): a part of all impulses."""
    outside = [np.maximum(-n, (abs(t) - one.friction * n) / (1.0 + one.friction)) for one, n, t in solved.contacts]
    return relative(np.maximum(largest(outside), 0.0), np.abs(solved.outcomes.impulses).sum((-1, -2)))


def momentum_gained(solved: SolvedProblems) -> Violations:
    """Change of linear and angular momentum that the impulses do not explain: a part of the terms of the balance."""
    mass, inertia, _, _ = solved.body
    (vx, vy, omega), (wx, wy, after) = solved.twist, parts(solved.outcomes.twist)
    gains = [mass * (wx - vx), mass * (wy - vy), inertia * (after - omega)]
    sizes = [mass * (abs(vx) + abs(wx)), mass * (abs(vy) + abs(wy)), inertia * (abs(omega) + abs(after))]
    for contact, n, t in solved.contacts:
        nx, ny = contact.normal
        px, py, push = nx * n + ny * t, ny * n - nx * t, abs(n) + abs(t)
        turn, turn_size = contact.x * py - contact.y * px, (abs(contact.x) + abs(contact.y)) * push
        gains = [gain - part for gain, part in zip(gains, (px, py, turn), strict=True)]
        sizes = [size + part for size, part in zip(sizes, (push, push, turn_size), strict=True)]
    linear = relative(np.hypot(gains[0], gains[1]), sizes[0] + sizes[1])
    return np.maximum(linear, relative(abs(gains[2]), sizes[2]))


def approach_left(solved: SolvedProblems) -> Violations:
    """Approach that an impact leaves at a contact: a part of the terms of the contact velocities."""
    after = solved.outcomes.twist
    approach = largest([-velocity(contact, after)[0] for contact, _, _ in solved.contacts])
    return np.maximum(relative(approach, solved.terms(solved.twist, after)), 0.0)


def work_gained(solved: SolvedProblems) -> Violations:
    """Work of the impulses on the body relative to its supports, P . (c + c') / 2: a part of the terms of the sum.

    It is never positive on the impulse path; in the total law where there is no restitution (Newton's can gain energy).
    """
    flags, work, size = solved.outcomes.flags, 0.0, 0.0
    bounces: Any = False
    for contact, n, t in solved.contacts:
        (cn, ct, terms), (vn, vt, terms_after) = (
            velocity(contact, twist) for twist in (solved.twist, solved.outcomes.twist)
        )
        work = work + n * (cn + vn) + t * (ct + vt)
        size = size + (abs(n) + abs(t)) * (terms + terms_after)
        bounces = bounces | (np.asarray(contact.restitution) > 0.0)
    total = (flags & int(Flag.BOTH_STRUCK)) > 0 if solved.law == "path" else True
    may_gain = bounces & total & ((flags & int(Flag.LAST_RESORT)) == 0)
    return np.where(may_gain, 0.0, np.maximum(relative(work, size), 0.0))


def energy_unexplained(solved: SolvedProblems) -> Violations:
    """Difference between the energy lost and the loss of kinetic energy, where supports rest: a part of their terms."""
    body, twists = solved.body, (solved.twist, solved.outcomes.twist)
    before, after = (
        0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * omega * omega) for vx, vy, omega in map(parts, twists)
    )
    size = before + after
    for contact, n, t in solved.contacts:
        size = size + sum(velocity(contact, twist)[2] for twist in twists) * (abs(n) + abs(t))
    unexplained = relative(abs(before - after - solved.outcomes.energy_lost), size)
    return np.where(solved.supports_move, 0.0, unexplained)


def changed_by_units(solved: SolvedProblems) -> Violations:
    """What other units of mass, length and time change in the outcome."""
    mass, length, time = UNITS
    speed = length / time

    def scaled(contact: Contact) -> Contact:
        (ux, uy), x, y = contact.velocity, contact.x * length, contact.y * length
        return contact._replace(x=x, y=y, velocity=(ux * speed, uy * speed))

    body, (vx, vy, omega) = solved.body, solved.twist
    old = body.old and scaled(body.old)
    other = TwoPointBody(body.mass * mass, body.inertia * mass * length * length, old, scaled(body.new))
    after = solved.solve(other, Twist(vx * speed, vy * speed, omega / time), solved.law).twist
    vx, vy, omega = parts(after)
    return solved.apart(solved.outcomes.twist, (vx / speed, vy / speed, omega * time))


def changed_by_mirror(solved: SolvedProblems) -> Violations:
    """What a mirror (x to -x) changes in the outcome, where it is unique: of several the laws take + before -."""

    def mirrored(contact: Contact) -> Contact:
        (nx, ny), (ux, uy) = contact.normal, contact.velocity
        return contact._replace(x=-contact.x, normal=(-nx, ny), velocity=(-ux, uy))

    body, (vx, vy, omega), outcomes = solved.body, solved.twist, solved.outcomes
    image = body._replace(old=body.old and mirrored(body.old), new=mirrored(body.new))
    reflected = solved.solve(image, Twist(-vx, vy, -omega), solved.law)
    vx, vy, omega = parts(reflected.twist)
    return np.where(outcomes.unique & reflected.unique, solved.apart(outcomes.twist, (-vx, vy, -omega)), 0.0)


def jump(solved: SolvedProblems) -> Violations:
    """How far the outcome moves when friction, inertia and, where the supports rest, the place of B change by a `STEP`.

    It may jump where it is not unique or a law has no answer, and where the path jams, which sets in suddenly.
    """

    def rougher(contact: Contact) -> Contact:
        return contact._replace(friction=contact.friction * (1.0 + STEP) + STEP)

    body, outcomes = solved.body, solved.outcomes
    x, y = body.new.x, body.new.y
    dx, dy = (x - body.old.x, y - body.old.y) if body.old else (x, y)
    step: Any = STEP * ~solved.supports_move
    new = rougher(body.new)._replace(x=x + step * (dx - dy), y=y + step * (dy + dx))
    near = TwoPointBody(body.mass, body.inertia * (1.0 + STEP), body.old and rougher(body.old), new)
    others = solved.solve(near, solved.twist, solved.law)
    sudden = int(Flag.JAMMED | Flag.LAST_RESORT) | UNANSWERED
    steady = outcomes.unique & others.unique & (((outcomes.flags | others.flags) & sudden) == 0)
    return np.where(steady, solved.apart(outcomes.twist, others.twist), 0.0)


INVARIANTS: dict[str, Callable[[SolvedProblems], Violations]] = {
    "finite": not_finite,
    "cone": outside_cones,
    "momentum": momentum_gained,
    "approach": approach_left,
    "work": work_gained,
    "energy": energy_unexplained,
    "units": changed_by_units,
    "mirror": changed_by_mirror,
    "continuity": jump,
}

LIMITS = dict(zip(INVARIANTS, (0.0, 1e-12, 1e-9, 1e-9, 1e-12, 1e-9, 0.0, 1e-12, 1e-5), strict=True))
"""How large a violation rounding explains where the problem is not stiff (`random_problems`).

Most are below 1e-15; of 1e8 random impacts a few have a condition number of 1e5."""

EXACT = ("finite", "units")
"""The invariants that no condition number excuses."""


def violations(
    body: TwoPointBody, twist: Twist, law: str, solve: Solve = solve_impacts
) -> tuple[Outcomes, dict[str, Violations]]:
    """The outcomes of problems and, for each of the `INVARIANTS`, how much they violate it.

    The fields of `body` and `twist` may be arrays (...), as for `solve_impacts`; so are the violations.
    """
    outcomes = solve(body, twist, law)
    answered = (outcomes.flags & UNANSWERED) == 0
    solved = SolvedProblems(body=body, twist=twist, law=law, solve=solve, outcomes=outcomes)
    found = {name: violation(solved) for name, violation in INVARIANTS.items()}
    return outcomes, {name: np.where(answered | (name == "finite"), value, 0.0) for name, value in found.items()}


class WorstViolation(NamedTuple):
    """The worst violation of an invariant by a law, and the problem that made it; no problem where there was none.

    Of stiff kinds of problems or of the others. `broken_by` are those that violate it by more than rounding explains.
    """

    invariant: str
    law: str
    stiff: bool
    violation: float = 0.0
    kind: str = ""
    body: TwoPointBody | None = None
    twist: Twist | None = None
    broken_by: tuple[str, ...] = ()

    @property
    def limit(self) -> float:
        """How large a violation rounding explains: any one where a stiff problem multiplies it."""
        return inf if self.stiff and self.invariant not in EXACT else LIMITS[self.invariant]

    @property
    def replay(self) -> str:
        """Python that computes the violation again, to the last bit."""
        return f"violations({self.body!r}, {self.twist!r}, {self.law!r})[1][{self.invariant!r}]"


class Soak:
    """Random problems of all kinds through `laws`: the `worst` violations so far, and how many problems are `done`."""

    def __init__(self, count: int, seed: int, laws: Sequence[str]) -> None:
        self.count, self.seed, self.laws, self.done = count, seed, tuple(laws), 0
        cases = [(law, stiff, name) for law in laws for stiff in (False, True) for name in INVARIANTS]
        self.worst = {(law, stiff, name): WorstViolation(name, law, stiff) for law, stiff, name in cases}

    def run(self, tell: Callable[[int], object] = lambda done: None) -> None:
        """Solve the problems; `tell` is told now and then how many are done. What was found stays if it is stopped."""
        # Every kind has its turn in a short soak too.
        chunk = min(CHUNK, -(-self.count // len(KINDS)))
        for kind, body, twist in random_problems(self.seed, self.count, chunk):
            for law in self.laws:
                # Sizes over many decades overflow in sums of squares; what is not a number then counts as a violation.
                with np.errstate(all="ignore"):
                    _, found = violations(body, twist, law)
                for name, values in found.items():
                    case = law, kind in STIFF, name
                    self.worst[case] = worse(self.worst[case], kind, values, body, twist)
            self.done += np.size(body.mass)
            tell(self.done)

    @property
    def broken(self) -> list[WorstViolation]:
        """The invariants that are violated by more than rounding explains."""
        return [worst for worst in self.worst.values() if worst.broken_by]


def worse(worst: WorstViolation, kind: str, values: Any, body: TwoPointBody, twist: Twist) -> WorstViolation:
    """The worst violation so far, or that of the problems of a kind if it is greater."""
    values = np.where(np.isnan(values), inf, values)
    i = int(np.argmax(values))
    violation = float(values[i])
    if violation > worst.limit and kind not in worst.broken_by:
        worst = worst._replace(broken_by=(*worst.broken_by, kind))
    if violation <= worst.violation:
        return worst
    return worst._replace(violation=violation, kind=kind, body=problem_at(body, i), twist=problem_at(twist, i))


def problem_at(many: Any, i: int) -> Any:
    """One of many problems, in plain numbers: of a body or of a twist whose fields are arrays."""
    if isinstance(many, tuple):
        parts = [problem_at(part, i) for part in many]
        return type(many)(*parts) if hasattr(many, "_fields") else tuple(parts)
    return many if many is None else float(many if np.ndim(many) == 0 else many[i])
