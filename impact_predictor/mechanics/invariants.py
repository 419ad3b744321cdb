"""What holds for every impact, as numbers that rounding alone keeps from being zero.

Each is computed for arrays of problems and their outcomes from the statements of mechanics, without the laws' code. A
violation is relative to the terms that it is the sum of; where an invariant does not apply it is zero.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .impact.batch import Outcomes, solve_impacts
from .random_problems import CHUNK, KINDS, random_problems
from .types import Contact, Flag, Twist, TwoPointBody

Violations = NDArray[np.float64]
Solve = Callable[[TwoPointBody, Twist, str], Outcomes]

UNITS = 2.0**20, 2.0**-13, 2.0**7
"""Units of mass, length and time: powers of two, which change no digit."""

STEP = 2.0**-40
"""Part by which friction and places change, to see that the outcome does not jump."""

UNANSWERED = int(Flag.NO_SOLUTION | Flag.INVALID_INPUT)


class SolvedContact(NamedTuple):
    """A contact in an impact: its impulses (N s) and its velocities (m/s) before and after, normal and tangential."""

    contact: Contact
    impulses: tuple[Violations, Violations]
    before: tuple[Violations, Violations]
    after: tuple[Violations, Violations]


class SolvedProblems:
    """Problems, whose fields may be arrays (...) as for `solve_impacts`, and their outcomes by a law.

    `terms` is the size of the terms of the contact velocities after the impact, c + W P, of which rounding is a part:
    those of the twists, and all impulses times the mobility of the contact that is farthest from the mass centre.
    """

    def __init__(self, body: TwoPointBody, twist: Twist, law: str, solve: Solve) -> None:
        self.body, self.twist, self.law, self.solve = body, twist, law, solve
        self.outcomes = solve(body, twist, law)
        self.contacts: list[SolvedContact] = []
        self.push: Any = 0.0
        lever: Any = 0.0
        sizes: Any = 0.0
        for i, contact in enumerate((body.old, body.new)):
            if contact is not None:
                n, t = (self.outcomes.impulses[..., i, k] for k in range(2))
                (before, size), (after, size_after) = (velocity(contact, each) for each in (twist, self.outcomes.twist))
                self.contacts.append(SolvedContact(contact, (n, t), before, after))
                self.push = self.push + abs(n) + abs(t)
                lever = np.maximum(lever, abs(contact.x) + abs(contact.y))
                sizes = np.maximum(sizes, size + size_after)
        self.terms = sizes + self.push * (1.0 / body.mass + lever * lever / body.inertia)

    @property
    def supports_move(self) -> NDArray[np.bool_]:
        """Whether the support of a contact moves."""
        speeds = [abs(part) for struck in self.contacts for part in struck.contact.velocity]
        return np.asarray(largest(speeds) > 0.0)

    def apart(self, one: Any, other: Any) -> Violations:
        """How far two twists are apart: at the contacts and at the mass centre, and in omega times the radius of
        gyration; a part of the terms.
        """
        (vx, vy, omega), (wx, wy, turning) = parts(one), parts(other)
        dx, dy, turn = vx - wx, vy - wy, omega - turning
        found = [abs(dx), abs(dy)]
        for contact, _, _, _ in self.contacts:
            found += [abs(dx - turn * contact.y), abs(dy + turn * contact.x)]
        radius = np.sqrt(self.body.inertia / self.body.mass)
        spin = relative(radius * abs(turn), self.terms + radius * (abs(omega) + abs(turning)))
        return np.maximum(relative(largest(found), self.terms), spin)


def parts(twist: Any) -> tuple[Any, Any, Any]:
    """vx, vy and omega of a twist, or of an array (..., 3) of them."""
    return tuple(np.moveaxis(twist, -1, 0)) if isinstance(twist, np.ndarray) else twist


def velocity(contact: Contact, twist: Any) -> tuple[tuple[Any, Any], Any]:
    """Normal and tangential velocity of a contact relative to its support, and the size of their terms (m/s)."""
    vx, vy, omega = parts(twist)
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    px, py = omega * contact.y, omega * contact.x
    cx, cy = vx - px - ux, vy + py - uy
    terms = abs(vx) + abs(vy) + abs(px) + abs(py) + abs(ux) + abs(uy)
    return (nx * cx + ny * cy, ny * cx - nx * cy), terms


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
    outside = [
        np.maximum(-n, (abs(t) - contact.friction * n) / (1.0 + contact.friction))
        for contact, (n, t), _, _ in solved.contacts
    ]
    return relative(np.maximum(largest(outside), 0.0), solved.push)


def momentum_gained(solved: SolvedProblems) -> Violations:
    """How far the twist is from the one that the impulses make by the balance of momentum."""
    mass, inertia, _, _ = solved.body
    vx, vy, omega = parts(solved.twist)
    for contact, (n, t), _, _ in solved.contacts:
        nx, ny = contact.normal
        px, py = nx * n + ny * t, ny * n - nx * t
        vx, vy, omega = vx + px / mass, vy + py / mass, omega + (contact.x * py - contact.y * px) / inertia
    return solved.apart(solved.outcomes.twist, (vx, vy, omega))


def approach_left(solved: SolvedProblems) -> Violations:
    """Approach that an impact leaves at a contact: a part of the terms of the contact velocities."""
    approach = largest([-struck.after[0] for struck in solved.contacts])
    return np.maximum(relative(approach, solved.terms), 0.0)


def work_gained(solved: SolvedProblems) -> Violations:
    """Work of the impulses on the body relative to its supports, P . (c + c') / 2: a part of the terms of the sum.

    It is never positive on the impulse path; in the total law where there is no restitution (Newton's can gain energy).
    """
    flags = solved.outcomes.flags
    work: Any = 0.0
    bounces: Any = False
    for contact, (n, t), (cn, ct), (vn, vt) in solved.contacts:
        work = work + n * (cn + vn) + t * (ct + vt)
        bounces = bounces | (np.asarray(contact.restitution) > 0.0)
    total = (flags & int(Flag.BOTH_STRUCK)) > 0 if solved.law == "path" else True
    may_gain = bounces & total & ((flags & int(Flag.LAST_RESORT)) == 0)
    return np.where(may_gain, 0.0, np.maximum(relative(work, solved.push * solved.terms), 0.0))


def energy_unexplained(solved: SolvedProblems) -> Violations:
    """Difference between the energy lost and the loss of kinetic energy, where supports rest: a part of their terms."""
    body, twists = solved.body, (solved.twist, solved.outcomes.twist)
    before, after = (
        0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * omega * omega) for vx, vy, omega in map(parts, twists)
    )
    size = before + after + solved.push * solved.terms
    return np.where(solved.supports_move, 0.0, relative(abs(before - after - solved.outcomes.energy_lost), size))


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
"""How large a violation rounding explains.

Most are below 1e-15; of 1e8 random impacts a few have a condition number of 1e5."""

CLAIMED = {
    "slender": tuple(LIMITS)[:-1],
    "extreme": ("finite", "units"),
    "extreme-apart": ("finite", "units"),
}
"""What is claimed of the kinds that are stiff; of the others everything.

A slender body multiplies a change of its lengths without bound. An extreme one has contacts at 1e-18 to 1e18 of its
radius of gyration, so that turning and moving may have no digit in common."""

SOLVED_AGAIN = ("units", "mirror", "continuity")
"""The invariants for which the problems are solved again, otherwise."""


def violations(
    body: TwoPointBody,
    twist: Twist,
    law: str,
    solve: Solve = solve_impacts,
    names: Iterable[str] = INVARIANTS,
) -> tuple[Outcomes, dict[str, Violations]]:
    """The outcomes of problems and, for each of the `INVARIANTS` by their names, how much they violate it.

    The fields of `body` and `twist` may be arrays (...), as for `solve_impacts`; so are the violations.
    """
    solved = SolvedProblems(body, twist, law, solve)
    answered = (solved.outcomes.flags & UNANSWERED) == 0
    found = {name: INVARIANTS[name](solved) for name in names}
    return solved.outcomes, {name: np.where(answered | (name == "finite"), value, 0.0) for name, value in found.items()}


class WorstViolation(NamedTuple):
    """The worst violation of an invariant by a law, and the problem that made it, in Python; "" where there is none.

    `checked` counts the problems; `broken_by` are the kinds that violate it by more than rounding explains.
    """

    invariant: str
    law: str
    violation: float = 0.0
    kind: str = ""
    problem: str = ""
    checked: int = 0
    broken_by: Sequence[str] = ()

    @property
    def limit(self) -> float:
        """How large a violation rounding explains."""
        return LIMITS[self.invariant]

    @property
    def replay(self) -> str:
        """Python that computes the violation again, to the last bit."""
        return f"violations({self.problem}, {self.law!r})[1][{self.invariant!r}]"


OFTEN = 8
"""One round of the kinds in so many is solved again, otherwise, too."""


class Soak:
    """Random problems of all kinds through `laws`: the `worst` violations so far, and how many problems are `done`."""

    def __init__(self, count: int, seed: int, laws: Sequence[str]) -> None:
        self.count, self.seed, self.laws, self.done = count, seed, tuple(laws), 0
        # Every kind has its turn in a short soak too.
        self.chunk = min(CHUNK, -(-count // len(KINDS)))
        self.worst = {(law, name): WorstViolation(name, law) for law in laws for name in INVARIANTS}

    def run(self, tell: Callable[[int], object] = lambda done: None) -> None:
        """Solve the problems; `tell` is told now and then how many are done. What was found stays if it is stopped."""
        for kind, body, twist in random_problems(self.seed, self.count, self.chunk, self.done):
            again = self.done // (self.chunk * len(KINDS)) % OFTEN == 0
            names = [name for name in CLAIMED.get(kind, INVARIANTS) if again or name not in SOLVED_AGAIN]
            found: dict[tuple[str, str], WorstViolation] = {}
            for law in self.laws:
                # Sizes over many decades overflow in sums of squares; what is not a number then counts as a violation.
                with np.errstate(all="ignore"):
                    _, each = violations(body, twist, law, names=names)
                found |= {(law, name): worse(self.worst[law, name], kind, each[name], body, twist) for name in each}
            # All of it at once, so that it can be stopped and go on anywhere.
            self.worst, self.done = self.worst | found, self.done + np.size(body.mass)
            tell(self.done)

    @property
    def broken(self) -> list[WorstViolation]:
        """The invariants that are violated by more than rounding explains."""
        return [worst for worst in self.worst.values() if worst.broken_by]

    def state(self) -> dict[str, Any]:
        """Where it stands, for a file."""
        return {
            "problems": [self.count, self.seed, *self.laws],
            "done": self.done,
            "worst": [worst._asdict() for worst in self.worst.values()],
        }

    def go_on(self, state: dict[str, Any]) -> None:
        """Go on from a `state`, of which ValueError is raised if it is of other problems."""
        if state["problems"] != self.state()["problems"]:
            raise ValueError("it is of another count, seed or law")
        self.done = state["done"]
        self.worst = {(one["law"], one["invariant"]): WorstViolation(**one) for one in state["worst"]}


def worse(worst: WorstViolation, kind: str, values: Any, body: TwoPointBody, twist: Twist) -> WorstViolation:
    """The worst violation so far, or that of the problems of a kind if it is greater."""
    values = np.where(np.isnan(values), inf, values)
    i = int(np.argmax(values))
    violation = float(values[i])
    worst = worst._replace(checked=worst.checked + len(values))
    if violation > worst.limit and kind not in worst.broken_by:
        worst = worst._replace(broken_by=(*worst.broken_by, kind))
    if violation <= worst.violation:
        return worst
    problem = f"{problem_at(body, i)!r}, {problem_at(twist, i)!r}"
    return worst._replace(violation=violation, kind=kind, problem=problem)


def problem_at(many: Any, i: int) -> Any:
    """One of many problems, in plain numbers: of a body or of a twist whose fields are arrays."""
    if isinstance(many, tuple):
        parts = [problem_at(part, i) for part in many]
        return type(many)(*parts) if hasattr(many, "_fields") else tuple(parts)
    return many if many is None else float(many if np.ndim(many) == 0 else many[i])
