"""One impact of one body: `solve_impact` by either law."""

from __future__ import annotations

from functools import cache
from math import isfinite

from . import path_law, total_law
from .pair import NO_SOLUTION, Impact, Problem
from .problem import Frame, new_tuple, problem_of, twist_after
from .types import Alternative, Flag, Mode, Outcome, Twist, TwoPointBody

STAYS = 1e-10
"""A contact velocity below this part of the contact speeds before the impact is zero for the mode."""

ENERGY_ROUNDING = 1e-12
"""Work of the contacts below this part of mass times the contact speeds squared is rounding."""

LAWS = {"path": path_law.solve, "total": total_law.solve}

OLD_RESTITUTION_IGNORED, BOTH_STRUCK, LAST_RESORT, ENERGY_GAINED = (
    int(flag) for flag in (Flag.OLD_RESTITUTION_IGNORED, Flag.BOTH_STRUCK, Flag.LAST_RESORT, Flag.ENERGY_GAINED)
)

NO_IMPACT, STOP, SLIDE, PIVOT_SLIDE, PIVOT, BACK_PIVOT, FLIGHT = Mode

NO_IMPULSE = ((0.0, 0.0), (0.0, 0.0))


def solve_impact(body: TwoPointBody, twist: Twist, law: str = "path") -> Outcome:
    """What the impact at the new contact does to a body that stands on the old one.

    `body` is a TwoPointBody in SI units; without an old contact the impact is a one-point impact. `twist` is
    (vx, vy, omega) of the mass centre right before. `law` is "path" (Routh's impulse path, Poisson restitution at the
    new contact) or "total" (the paper's impulses of the whole impact, Newton restitution). Where both contacts are
    struck the total law answers; without restitution it is the last resort where a law has no answer.

    Input that no body can have gives Flag.INVALID_INPUT, never an exception; an unknown law raises ValueError.
    Source: the paper, sections 2 to 4, generalised.
    """
    if law not in LAWS:
        raise ValueError(f"law is {law!r}; use {' or '.join(map(repr, LAWS))}")
    valid, problem, frame = problem_of(body, twist)
    if not valid:
        return unchanged(twist, law, Flag.INVALID_INPUT)
    _, restitution_old, _, cna, cta, cnb, ctb, _, _ = problem
    if cnb >= 0.0 and cna >= 0.0:
        return unchanged(twist, law, Flag.NONE)

    mass, _, old, _ = body
    notes = OLD_RESTITUTION_IGNORED if restitution_old > 0.0 and cna >= 0.0 else 0
    if law == "path" and cna < 0.0:
        law, notes = "total", notes | BOTH_STRUCK
    impact = LAWS[law](problem, 0)
    if impact[12] & NO_SOLUTION:
        law, problem = "total", without_restitution(problem)
        impact = total_law.solve(problem, 0)
        if impact[12] & NO_SOLUTION:
            return unchanged(twist, law, flags_of(notes | NO_SOLUTION))
        notes |= LAST_RESORT
    others: list[Impact] = []
    if impact[13] > 1:
        impact, others = all_answers(problem, law, impact)

    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, flags, _ = impact
    after = twist_after(twist, frame, dx, dy, dq)
    if not isfinite(after[0] + after[1] + after[2]):
        return unchanged(twist, law, flags_of(notes | NO_SOLUTION))
    speed = abs(cnb) + abs(ctb)
    work = nb * (cnb + vnb) + tb * (ctb + vtb)
    if old is not None:
        speed += abs(cna) + abs(cta)
        work += na * (cna + vna) + ta * (cta + vta)
    if work > ENERGY_ROUNDING * speed * speed:
        notes |= ENERGY_GAINED
    outcome = (
        mode_of(STAYS * speed, vna, vta, vnb, vtb),
        after,
        ((mass * na, mass * ta), (mass * nb, mass * tb)),
        segments_of(segments),
        flags_of(flags | notes),
        -0.5 * mass * work,
        not others,
        tuple([alternative(other, twist, frame, STAYS * speed) for other in others]) if others else (),
        law,
    )
    return new_tuple(Outcome, outcome)


def without_restitution(problem: Problem) -> Problem:
    pair, _, _, cna, cta, cnb, ctb, zero_a, zero_b = problem
    return pair, 0.0, 0.0, cna, cta, cnb, ctb, zero_a, zero_b


def alternative(impact: Impact, twist: Twist, frame: Frame, zero: float) -> Alternative:
    return Alternative(mode_of(zero, *impact[4:8]), twist_after(twist, frame, *impact[8:11]), segments_of(impact[11]))


def all_answers(problem: Problem, law: str, first: Impact) -> tuple[Impact, list[Impact]]:
    """The answer and the different ones that the law allows as well.

    Of several total solutions the one nearest to the end of the impulse path answers: it is the one that an impact
    reaches from its beginning.
    """
    solve = LAWS[law]
    answers = [first]
    for choice in range(1, first[13]):
        other = solve(problem, choice)
        if not other[12] & NO_SOLUTION and all(differ(other, answer) for answer in answers):
            answers.append(other)
    if law == "total" and len(answers) > 1 and problem[3] >= 0.0:
        path = path_law.solve(problem, 0)
        if not path[12] & NO_SOLUTION:
            answers.sort(key=lambda answer: sum(abs(answer[i] - path[i]) for i in (8, 9, 10)))
    return answers[0], answers[1:]


def differ(one: Impact, other: Impact) -> bool:
    """Whether two answers change the twist differently, beyond rounding."""
    scale = sum(abs(one[i]) + abs(other[i]) for i in (8, 9, 10))
    return sum(abs(one[i] - other[i]) for i in (8, 9, 10)) > STAYS * scale


def unchanged(twist: Twist, law: str, flags: Flag) -> Outcome:
    """The outcome of a twist that no impact changes; a twist that is no number becomes rest."""
    vx, vy, omega = twist
    kept = Twist(vx, vy, omega) if isfinite(vx + vy + omega) else Twist(0.0, 0.0, 0.0)
    return Outcome(NO_IMPACT, kept, NO_IMPULSE, (), flags, 0.0, True, (), law)


def mode_of(zero: float, vna: float, vta: float, vnb: float, vtb: float) -> Mode:
    """The mode from the contact velocities after the impact, which are zero up to `zero`."""
    if vna <= zero:
        if vnb > zero:
            return BACK_PIVOT
        return STOP if abs(vta) <= zero and abs(vtb) <= zero else SLIDE
    if vnb > zero:
        return FLIGHT
    return PIVOT if abs(vtb) <= zero else PIVOT_SLIDE


@cache
def flags_of(notes: int) -> Flag:
    """The notes on an answer as flags: looked up once, because making a Flag is slow."""
    return Flag(notes)


@cache
def segments_of(code: int) -> tuple[str, ...]:
    """The contact states of a law's answer as text, first to last."""
    segments = []
    while code:
        segments.append("OS+-"[code % 16 // 4] + "OS+-"[code % 4])
        code //= 16
    return tuple(reversed(segments))
