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

LIMITS = {
    "finite": 0.0,
    "cone": 1e-12,
    "momentum": 1e-9,
    "approach": 1e-9,
    "work": 1e-12,
    "energy": 1e-9,
    "units": 0.0,
    "mirror": 1e-12,
    "continuity": 1e-5,
}
"""The invariants, and how large a violation rounding explains where the problem is not stiff (`random_problems`).

Most are below 1e-15; of 1e8 random impacts a few have a condition number of 1e5."""

EXACT = ("finite", "units")
"""The invariants that no condition number excuses."""

UNITS = 2.0**20, 2.0**-13, 2.0**7
"""Units of mass, length and time: powers of two, which change no digit."""

STEP = 2.0**-40
"""Part by which friction and places change, to see that the outcome does not jump."""

UNANSWERED = int(Flag.NO_SOLUTION | Flag.INVALID_INPUT)


def violations(
    body: TwoPointBody, twist: Twist, law: str, solve: Solve = solve_impacts
) -> tuple[Outcomes, dict[str, Violations]]:
    """The outcomes of problems and, for each of the `LIMITS`, how much they violate it.

    The fields of `body` and `twist` may be arrays (...), as for `solve_impacts`; so are the violations.
    """
    outcomes = solve(body, twist, law)
    answered = (outcomes.flags & UNANSWERED) == 0
    found = {
        "finite": not_finite(outcomes),
        "cone": outside_cones(body, outcomes),
        "momentum": momentum_gained(body, twist, outcomes),
        "approach": approach_left(body, twist, outcomes),
        "work": work_gained(body, twist, outcomes, law),
        "energy": energy_unexplained(body, twist, outcomes),
        "units": changed_by_units(body, twist, outcomes, law, solve),
        "mirror": changed_by_mirror(body, twist, outcomes, law, solve),
        "continuity": jump(body, twist, outcomes, law, solve),
    }
    return outcomes, {name: np.where(answered | (name == "finite"), value, 0.0) for name, value in found.items()}


def contacts_of(body: TwoPointBody) -> list[tuple[int, Contact]]:
    """The contacts, with their place in the impulses of an outcome."""
    return [(i, contact) for i, contact in enumerate((body.old, body.new)) if contact is not None]


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


def not_finite(outcomes: Outcomes) -> Violations:
    """1 where a number of an outcome is not finite."""
    numbers = (*parts(outcomes.twist), *np.moveaxis(outcomes.impulses.reshape(*outcomes.mode.shape, 4), -1, 0))
    return np.asarray(~np.isfinite(sum(numbers, start=outcomes.energy_lost)), np.float64)


def outside_cones(body: TwoPointBody, outcomes: Outcomes) -> Violations:
    """How far impulses lie outside of their friction cones (Coulomb): a part of all impulses."""
    size = np.abs(outcomes.impulses).sum((-1, -2))
    found = []
    for i, contact in contacts_of(body):
        n, t = outcomes.impulses[..., i, 0], outcomes.impulses[..., i, 1]
        found.append(relative(np.maximum(-n, (abs(t) - contact.friction * n) / (1.0 + contact.friction)), size))
    return np.maximum(largest(found), 0.0)


def momentum_gained(body: TwoPointBody, twist: Twist, outcomes: Outcomes) -> Violations:
    """Change of linear and angular momentum that the impulses do not explain: a part of the terms of the balance."""
    (vx, vy, omega), (wx, wy, after) = twist, parts(outcomes.twist)
    gains = [body.mass * (wx - vx), body.mass * (wy - vy), body.inertia * (after - omega)]
    sizes = [body.mass * (abs(vx) + abs(wx)), body.mass * (abs(vy) + abs(wy)), body.inertia * (abs(omega) + abs(after))]
    for i, contact in contacts_of(body):
        (nx, ny), n, t = contact.normal, outcomes.impulses[..., i, 0], outcomes.impulses[..., i, 1]
        px, py, push = nx * n + ny * t, ny * n - nx * t, abs(n) + abs(t)
        turn, turn_size = contact.x * py - contact.y * px, (abs(contact.x) + abs(contact.y)) * push
        gains = [gain - part for gain, part in zip(gains, (px, py, turn), strict=True)]
        sizes = [size + part for size, part in zip(sizes, (push, push, turn_size), strict=True)]
    linear = relative(np.hypot(gains[0], gains[1]), sizes[0] + sizes[1])
    return np.maximum(linear, relative(abs(gains[2]), sizes[2]))


def terms_of(body: TwoPointBody, *twists: Any) -> Violations:
    """The size of the terms of the contact velocities (m/s) in several twists, at the contact where it is largest."""
    return largest([sum(velocity(contact, twist)[2] for twist in twists) for _, contact in contacts_of(body)])


def approach_left(body: TwoPointBody, twist: Twist, outcomes: Outcomes) -> Violations:
    """Approach that an impact leaves at a contact: a part of the terms of the contact velocities."""
    approach = largest([-velocity(contact, outcomes.twist)[0] for _, contact in contacts_of(body)])
    return np.maximum(relative(approach, terms_of(body, twist, outcomes.twist)), 0.0)


def work_gained(body: TwoPointBody, twist: Twist, outcomes: Outcomes, law: str) -> Violations:
    """Work of the impulses on the body relative to its supports, P . (c + c') / 2: a part of the terms of the sum.

    It is never positive on the impulse path; in the total law where there is no restitution (Newton's can gain energy).
    """
    work = size = np.zeros(outcomes.mode.shape)
    plastic = (outcomes.flags & int(Flag.LAST_RESORT)) > 0
    bounces = np.zeros(outcomes.mode.shape, np.bool_)
    for i, contact in contacts_of(body):
        before, after = velocity(contact, twist), velocity(contact, outcomes.twist)
        for k in (0, 1):
            impulse = outcomes.impulses[..., i, k]
            work = work + impulse * (before[k] + after[k])
            size = size + abs(impulse) * (before[2] + after[2])
        bounces = bounces | (np.asarray(contact.restitution) > 0.0)
    total = (outcomes.flags & int(Flag.BOTH_STRUCK)) > 0 if law == "path" else True
    return np.where(bounces & total & ~plastic, 0.0, np.maximum(relative(work, size), 0.0))


def energy_unexplained(body: TwoPointBody, twist: Twist, outcomes: Outcomes) -> Violations:
    """Difference between the energy lost and the loss of kinetic energy, where supports rest: a part of their terms."""
    before, after = (
        0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * omega * omega)
        for vx, vy, omega in (twist, parts(outcomes.twist))
    )
    size = before + after
    for i, contact in contacts_of(body):
        speeds = velocity(contact, twist)[2] + velocity(contact, outcomes.twist)[2]
        size = size + speeds * np.abs(outcomes.impulses[..., i, :]).sum(-1)
    return np.where(supports_move(body), 0.0, relative(abs(before - after - outcomes.energy_lost), size))


def supports_move(body: TwoPointBody) -> NDArray[np.bool_]:
    """Whether a contact's support moves."""
    speeds = [abs(part) for _, contact in contacts_of(body) for part in contact.velocity]
    return np.asarray(largest(speeds) > 0.0)


def apart(body: TwoPointBody, twist: Twist, one: Any, other: Any) -> Violations:
    """How far two twists after the impact are apart at the contacts: a part of the terms of the contact velocities."""
    found = []
    for _, contact in contacts_of(body):
        first, second = velocity(contact, one), velocity(contact, other)
        found += [abs(first[k] - second[k]) for k in (0, 1)]
    return relative(largest(found), terms_of(body, twist, one, other))


def changed_by_units(body: TwoPointBody, twist: Twist, outcomes: Outcomes, law: str, solve: Solve) -> Violations:
    """What other units of mass, length and time change in the outcome."""
    mass, length, time = UNITS
    speed = length / time

    def scaled(contact: Contact) -> Contact:
        (ux, uy), x, y = contact.velocity, contact.x * length, contact.y * length
        return contact._replace(x=x, y=y, velocity=(ux * speed, uy * speed))

    vx, vy, omega = twist
    old = body.old and scaled(body.old)
    other = TwoPointBody(body.mass * mass, body.inertia * mass * length * length, old, scaled(body.new))
    vx, vy, omega = parts(solve(other, Twist(vx * speed, vy * speed, omega / time), law).twist)
    return apart(body, twist, outcomes.twist, (vx / speed, vy / speed, omega * time))


def changed_by_mirror(body: TwoPointBody, twist: Twist, outcomes: Outcomes, law: str, solve: Solve) -> Violations:
    """What a mirror (x to -x) changes in the outcome, where it is unique: of several the laws take + before -."""

    def mirrored(contact: Contact) -> Contact:
        (nx, ny), (ux, uy) = contact.normal, contact.velocity
        return contact._replace(x=-contact.x, normal=(-nx, ny), velocity=(-ux, uy))

    vx, vy, omega = twist
    image = body._replace(old=body.old and mirrored(body.old), new=mirrored(body.new))
    reflected = solve(image, Twist(-vx, vy, -omega), law)
    vx, vy, omega = parts(reflected.twist)
    unique = outcomes.unique & reflected.unique
    return np.where(unique, apart(body, twist, outcomes.twist, (-vx, vy, -omega)), 0.0)


def jump(body: TwoPointBody, twist: Twist, outcomes: Outcomes, law: str, solve: Solve) -> Violations:
    """How far the outcome moves when friction, inertia and, where the supports rest, the place of B change by a `STEP`.

    It may jump where it is not unique or a law has no answer, and where the path jams, which sets in suddenly.
    """

    def rougher(contact: Contact) -> Contact:
        return contact._replace(friction=contact.friction * (1.0 + STEP) + STEP)

    x, y = body.new.x, body.new.y
    dx, dy = (x - body.old.x, y - body.old.y) if body.old else (x, y)
    step: Any = STEP * ~supports_move(body)
    new = rougher(body.new)._replace(x=x + step * (dx - dy), y=y + step * (dy + dx))
    near = TwoPointBody(body.mass, body.inertia * (1.0 + STEP), body.old and rougher(body.old), new)
    others = solve(near, twist, law)
    sudden = int(Flag.JAMMED | Flag.LAST_RESORT | Flag.NO_SOLUTION | Flag.INVALID_INPUT)
    steady = outcomes.unique & others.unique & (((outcomes.flags | others.flags) & sudden) == 0)
    return np.where(steady, apart(body, twist, outcomes.twist, others.twist), 0.0)


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
        self.count, self.seed = count, seed
        self.done = 0
        self.worst = {
            (law, stiff, name): WorstViolation(name, law, stiff)
            for law in laws
            for stiff in (False, True)
            for name in LIMITS
        }
        self.laws = tuple(laws)

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
                    self._take(self.worst[law, kind in STIFF, name], kind, values, body, twist)
            self.done += np.size(body.mass)
            tell(self.done)

    def _take(self, worst: WorstViolation, kind: str, values: Any, body: TwoPointBody, twist: Twist) -> None:
        values = np.where(np.isnan(values), inf, values)
        i = int(np.argmax(values))
        violation = float(values[i])
        if violation > worst.limit and kind not in worst.broken_by:
            worst = worst._replace(broken_by=(*worst.broken_by, kind))
        if violation > worst.violation:
            one = {"body": problem_at(body, i), "twist": problem_at(twist, i)}
            worst = worst._replace(violation=violation, kind=kind, **one)
        self.worst[worst.law, worst.stiff, worst.invariant] = worst

    @property
    def broken(self) -> list[WorstViolation]:
        """The invariants that are violated by more than rounding explains."""
        return [worst for worst in self.worst.values() if worst.broken_by]


def problem_at(many: Any, i: int) -> Any:
    """One of many problems, in plain numbers: of a body or of a twist whose fields are arrays."""
    if isinstance(many, tuple):
        parts = [problem_at(part, i) for part in many]
        return type(many)(*parts) if hasattr(many, "_fields") else tuple(parts)
    return many if many is None else float(many if np.ndim(many) == 0 else many[i])
