"""Impacts by the path law in 40 digits: the law code of the program, run on numbers of mpmath.

It is the law as the program has it, without its roundings. That the law itself is right is not shown here: an exact
rational solver, which shares no code with it, and the paper's closed forms do that in the tests.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from mpmath import mp

from ...mechanics.dual import load
from ...mechanics.impact import NOWHERE
from ...mechanics.transverse import solve_transverse_impact
from ...mechanics.types import Contact, Flag, Mode, Twist
from .impact_scenes import Strike
from .touchdown_reference import DIGITS, Real

FINEST = 1e-7
"""Tolerance of the reference where a body slips across the plane, too."""

UNANSWERED = int(Flag.NO_SOLUTION | Flag.INVALID_INPUT)


class Reference(NamedTuple):
    """Right after an impact: the twist in 40 digits, and the mode."""

    twist: tuple[Real, Real, Real]
    mode: Mode


@cache
def answer() -> Callable[..., Any]:
    """The law code loaded again, with a square root for numbers of mpmath."""
    problem, path_law, total, law = (load(name) for name in ("problem", "path_law", "total_law", "answer"))
    problem.sqrt = path_law.sqrt = mp.sqrt  # type: ignore[attr-defined]
    law.problem_of, law.path_law, law.total_law = problem.problem_of, path_law, total  # type: ignore[attr-defined]
    return law.answer  # type: ignore[no-any-return]


def reference_of(strike: Strike) -> Reference | None:
    """The impact by the path law; None where it has no answer."""
    body, twist, across = strike.body, strike.twist, strike.across
    if across is not None:
        outcome = solve_transverse_impact(body, twist, across, FINEST).outcome
        return Reference(tuple(map(mp.mpf, outcome.twist)), outcome.mode)
    with mp.workdps(DIGITS):
        mass, inertia, old, new = body
        found = answer()(
            mp.mpf(mass),
            mp.mpf(inertia),
            old is not None,
            wide(old or NOWHERE),
            wide(new),
            Twist(*map(mp.mpf, twist)),
            0,
        )
    return None if found[7] & UNANSWERED else Reference(found[1], Mode(found[0]))


def wide(contact: Contact) -> Contact:
    """A contact in numbers of mpmath."""
    x, y, friction, normal, restitution, velocity = contact
    return Contact(
        mp.mpf(x),
        mp.mpf(y),
        mp.mpf(friction),
        tuple(map(mp.mpf, normal)),
        mp.mpf(restitution),
        tuple(map(mp.mpf, velocity)),
    )
