"""Random problems through the laws for as long as asked for, keeping the worst violation of each invariant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np

from .batch import numbers_of
from .invariants import LIMITS, violations
from .random_problems import CHUNK, KINDS, STIFF, random_problems
from .types import Contact, Twist, TwoPointBody

EXACT = ("finite", "units")
"""The invariants that no condition number excuses."""


class Worst(NamedTuple):
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
            (law, stiff, name): Worst(name, law, stiff) for law in laws for stiff in (False, True) for name in LIMITS
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

    def _take(self, worst: Worst, kind: str, values: Any, body: TwoPointBody, twist: Twist) -> None:
        values = np.where(np.isnan(values), inf, values)
        i = int(np.argmax(values))
        violation = float(values[i])
        if violation > worst.limit and kind not in worst.broken_by:
            worst = worst._replace(broken_by=(*worst.broken_by, kind))
        if violation > worst.violation:
            one_body, one_twist = problem_at(body, twist, i)
            worst = worst._replace(violation=violation, kind=kind, body=one_body, twist=one_twist)
        self.worst[worst.law, worst.stiff, worst.invariant] = worst

    @property
    def broken(self) -> list[Worst]:
        """The invariants that are violated by more than rounding explains."""
        return [worst for worst in self.worst.values() if worst.broken_by]


def problem_at(body: TwoPointBody, twist: Twist, i: int) -> tuple[TwoPointBody, Twist]:
    """One of many problems, in plain numbers."""

    def one(value: Any) -> float:
        return float(value if np.ndim(value) == 0 else value[i])

    def contact(many: Contact) -> Contact:
        x, y, friction, nx, ny, restitution, ux, uy = map(one, numbers_of(many))
        return Contact(x, y, friction, (nx, ny), restitution, (ux, uy))

    old = None if body.old is None else contact(body.old)
    return TwoPointBody(one(body.mass), one(body.inertia), old, contact(body.new)), Twist(*map(one, twist))
