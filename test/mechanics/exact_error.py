"""How far an impact is from exact arithmetic, and how far it may be.

The error of a velocity is a part of the largest contact speed before, during and after the impact. It is at most 1e-12,
or else at most the *conditioning*: how far the exact answer moves when each number that a law is given changes by
`ROUNDINGS` roundings of 2^-53, up or down at random. These numbers are mass, inertia, places, frictions, restitution,
which change in proportion; the directions of the normals, which turn by that angle; each contact velocity on its own,
which changes by that part of the terms that it is the sum of. In other words the error is at most `ROUNDINGS` times
2^-53 times the condition number of the problem; where so little decides between different answers it is their distance.
"""

import math
import random
from fractions import Fraction

import exact
from exact_algebra import dot, root

from impact_predictor import Flag, Mode, TwoPointBody, solve_impact

CLOSE = 1e-12
ROUNDINGS = 128
"""As many as a law makes along a path of some segments; and below as many a condition of a law counts as met."""
CHANGE = ROUNDINGS * Fraction(1, 2**53)


def speeds(problem, velocities):
    """Contact speeds in m/s: normals of floats are not of length 1."""
    return [float(abs(c) / root(problem.squares[k // 2])) for k, c in enumerate(velocities) if c is not None]


def distance(problem, answer, change):
    """How far changes of the twist are from that of the exact answer, at the contacts."""
    apart = [Fraction(v) - w for v, w in zip(change, answer.change, strict=True)]
    stands = problem.velocities[exact.NA] is not None
    velocities = [dot(row, apart) if stands or k in exact.NEW else None for k, row in enumerate(problem.rows)]
    largest = max(speed for c in answer.history for speed in speeds(problem, c))
    return max(speeds(problem, velocities)) / largest


def answers_of(problem, law, rule):
    """The exact answers of the law that `solve_impact` uses, or []: the plastic total law is the last resort."""
    if law == "path" and not (problem.velocities[exact.NA] or 0) < 0:
        try:
            return [exact.path(problem, energetic=rule == "energetic")]
        except exact.Undecided:
            found = []
    else:
        found = exact.total(problem)
    return found or exact.total(problem._replace(restitutions=(0, 0)))


def nudged(body, twist, problem, source):
    """The exact problem after a `CHANGE` of each number that a law is given."""

    def rounded(number):
        return Fraction(number) * (1 + source.choice((-1, 1)) * CHANGE)

    def contact(each):
        (nx, ny), turn = map(Fraction, each.normal), source.choice((-1, 1)) * CHANGE
        return each._replace(
            x=rounded(each.x),
            y=rounded(each.y),
            friction=rounded(each.friction),
            normal=(nx - turn * ny, ny + turn * nx),
        )

    near = TwoPointBody(rounded(body.mass), rounded(body.inertia), body.old and contact(body.old), contact(body.new))
    velocities = list(problem.velocities)
    for k, speed in enumerate(velocities):
        if speed:
            each = (body.old, body.new)[k // 2]
            terms = map(Fraction, (*twist[:2], twist[2] * each.x, twist[2] * each.y, *each.velocity))
            moved = speed + source.choice((-1, 1)) * CHANGE * sum(map(abs, terms))
            velocities[k] = speed if k in (exact.NA, exact.NB) and moved * speed < 0 else moved
    restitutions = [rounded(restitution) for restitution in problem.restitutions]
    return exact.problem_of(near, twist)._replace(velocities=velocities, restitutions=restitutions)


def conditioning(body, twist, problem, answer, law, rule):
    source, largest = random.Random(1), 0.0
    for _ in range(8):
        near = answers_of(nudged(body, twist, problem, source), law, rule)
        moved = min((distance(problem, answer, each.change) for each in near), default=math.inf)
        largest = max(largest, moved)
    return largest


def error_of(body, twist, law, rule="poisson"):
    """Compare an impact with exact arithmetic and return its error."""
    outcome = solve_impact(body, twist, law, restitution=rule)
    assert all(map(math.isfinite, (*outcome.twist, *outcome.impulses[0], *outcome.impulses[1], outcome.energy_lost)))
    problem = exact.problem_of(body, twist)
    if not any(problem.velocities[n] is not None and problem.velocities[n] < 0 for n in (exact.NA, exact.NB)):
        assert outcome.mode is Mode.NO_IMPACT
        return 0.0
    answers = answers_of(problem, law, rule)
    if not answers:
        assert outcome.flags & Flag.NO_SOLUTION
        return 0.0
    assert not outcome.flags & (Flag.NO_SOLUTION | Flag.INVALID_INPUT), (body, twist)
    error, nearest = math.inf, None
    for each in (outcome, *outcome.alternatives):
        change = [Fraction(after) - Fraction(before) for before, after in zip(twist, each.twist, strict=True)]
        for answer in answers:
            if (apart := distance(problem, answer, change)) < error:
                error, nearest = apart, answer
    if error > CLOSE:
        assert error <= conditioning(body, twist, problem, nearest, law, rule), (body, twist)
    return error
