"""One impact of one body: `solve_impact` by either law."""

from __future__ import annotations

from functools import cache
from math import isfinite
from typing import Final

from ..types import Alternative, Contact, Flag, Mode, Outcome, Twist, TwoPointBody, Validity
from .answer import (
    ENERGETIC_PATH,
    LAST_RESORT,
    PATH,
    STAYS,
    TOTAL,
    VALIDITY,
    answer,
    differ,
    follow,
    mode_of,
    nearest,
    solved,
    speed_of,
    without_restitution,
)
from .contacts import Impact, Problem, problem_of, twist_after
from .restitution import RULES

LAWS = ("path", "total")
"""The names of the laws."""

NUMBERS: Final = {("path", "poisson"): PATH, ("total", "poisson"): TOTAL, ("path", "energetic"): ENERGETIC_PATH}
"""The numbers of the laws, each with a rule of restitution; of the total law, which has its own, the rule that is the
default."""

NAMES: Final = tuple([law for law, rule in NUMBERS])
"""The names of the laws, at their numbers."""

MODES: Final = tuple(Mode)

NOWHERE: Final = Contact(0.0, 0.0, 0.0)
"""What a body without an old contact has in its place."""


def solve_impact(
    body: TwoPointBody,
    twist: Twist,
    law: str = "path",
    validity: Validity = VALIDITY,
    restitution: str = "poisson",
) -> Outcome:
    """What the impact at the new contact does to a body that stands on the old one.

    `body` is a TwoPointBody in SI units; without an old contact the impact is a one-point impact. `twist` is
    (vx, vy, omega) of the mass centre right before. `law` is "path" (Routh's impulse path) or "total" (the paper's
    impulses of the whole impact, with Newton's restitution). `restitution` is the path law's rule for the new contact:
    "poisson", by impulses and limited by the work, or "energetic", by the work alone, as the law in three dimensions
    has it. Where both contacts are struck the total law answers; without restitution it is the last resort where a law
    has no answer. `validity` says from where on an outcome is flagged because rigid theory is too simple for it.

    Input that no body can have gives Flag.INVALID_INPUT, never an exception; an unknown law or rule, and the total law
    with another rule than its own, raise ValueError. Sources: the paper, sections 2 to 4, generalised; Stronge, Rigid
    body collisions with friction (1990), for the energetic rule.
    """
    number = number_of(law, restitution)
    try:
        mass, inertia, old, new = body
        mode, after, na, ta, nb, tb, segments, flags, energy_lost, unique, used = answer(
            mass, inertia, old is not None, old or NOWHERE, new, twist, number, validity
        )
    except (TypeError, ValueError) as error:
        raise TypeError(f"solve_impact takes numbers, and `solve_impacts` arrays of them: {error}") from None
    return Outcome(
        mode=MODES[mode],
        twist=Twist(*after),
        impulses=((na, ta), (nb, tb)),
        segments=states_of(segments),
        flags=flags_of(flags),
        energy_lost=energy_lost,
        unique=unique,
        alternatives=() if unique else alternatives(body, twist, used, flags),
        law=NAMES[used],
        body=body,
        before=twist,
        restitution=restitution,
    )


def number_of(law: str, restitution: str = "poisson") -> int:
    """The number of a law with a rule of restitution; what is unknown, or not one of both, raises ValueError."""
    number = NUMBERS.get((law, restitution))
    if number is not None:
        return number
    for name, given, known in (("law", law, LAWS), ("restitution", restitution, RULES)):
        if given not in known:
            raise ValueError(f"{name} is {given!r}; use {' or '.join(map(repr, known))}")
    raise ValueError(f"the law {law!r} has its own restitution, not the {restitution!r} one; use the law 'path'")


def alternatives(body: TwoPointBody, twist: Twist, law: int, flags: int) -> tuple[Alternative, ...]:
    """The answers that the law which answered allows as well."""
    mass, inertia, old, new = body
    valid, problem, frame = problem_of(mass, inertia, old is not None, old or NOWHERE, new, twist)
    zero = STAYS * speed_of(problem)
    found = []
    for other in others(problem, law, flags):
        na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, notes, choices = other
        after = Twist(*twist_after(twist, frame, dx, dy, dq))
        if all(map(isfinite, after)):
            mode = MODES[mode_of(zero, vna, vta, vnb, vtb)]
            found.append(Alternative(mode=mode, twist=after, segments=states_of(segments)))
    return tuple(found)


def others(problem: Problem, law: int, flags: int) -> list[Impact]:
    """All answers of the law which answered, with these flags, that differ from the answer and from each other."""
    if flags & LAST_RESORT:
        problem = without_restitution(problem)
    first = follow(problem, law, 0)
    answers = [nearest(problem, law, first)[0]]
    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, notes, choices = first
    for choice in range(choices):
        other = follow(problem, law, choice)
        if solved(other) and all(differ(problem, other, one) for one in answers):
            answers.append(other)
    return answers[1:]


@cache
def flags_of(notes: int) -> Flag:
    """The notes on an answer as flags: looked up once, because making a Flag is slow."""
    return Flag(notes)


@cache
def states_of(code: int) -> tuple[str, ...]:
    """The contact states of a law's answer as text, first to last."""
    states = []
    while code:
        states.append("OS+-"[code % 16 // 4] + "OS+-"[code % 4])
        code //= 16
    return tuple(reversed(states))
