"""Impulses against exact arithmetic: their error bound, jams, and restitution that the stored work ends.

In the norms of kinetic energy, |q| of a twist and |g| of the twist that a unit impulse gives, the error of an impulse
is

    |dP_j| |g_j| <= 16 2^-53 kappa (|q| + |q'| + sum_i |P_i| |g_i|),

where kappa is the norm of the inverse of the system of the contacts that hold: its rows are what is kept (the normal
velocity, and the tangential one of a contact that sticks), its columns the rays along which impulses are, both of
length 1. Along a path the greatest of those of its segments counts. Two sticking contacts have no such bound: their
impulses are one choice of many.
"""

import math

import numpy as np
import pytest
from alone import random_impacts
from exact import Undecided, path, problem_of, total

from impact_predictor import Flag, Mode, solve_impact
from impact_predictor.mechanics.random_problems import KINDS

BOUND = 16.0 * 2.0**-53
"""Sixteen roundings. Sizes over twelve decades are left out: the total law makes some more of those."""


def rows_of(contact, body):
    """What unit impulses along the normal and the tangent do to (vx, vy, omega), in the norm of kinetic energy."""
    (nx, ny), x, y = contact.normal, contact.x, contact.y
    by_mass, by_inertia = 1.0 / math.sqrt(body.mass), 1.0 / math.sqrt(body.inertia)
    scale = np.array([by_mass, by_mass, by_inertia])
    return scale * [nx, ny, x * ny - y * nx], scale * [ny, -nx, -x * nx - y * ny]


def kappa(body, states):
    kept, rays = [], []
    for contact, state in zip((body.old, body.new), states, strict=True):
        if state != "O":
            normal, tangent = rows_of(contact, body)
            slide = {"+": -contact.friction, "-": contact.friction, "S": 0.0}[state]
            kept.append(normal)
            rays.append(normal + slide * tangent)
            if state == "S":
                kept.append(tangent)
                rays.append(tangent)
    kept, rays = (np.array([each / np.linalg.norm(each) for each in some]) for some in (kept, rays))
    return float(1.0 / np.linalg.svd(kept @ rays.T, compute_uv=False)[-1])


def weighed_error(outcome, answer):
    """The largest error of the impulses of a contact over its bound without the roundings."""
    body, mass, inertia = outcome.body, outcome.body.mass, outcome.body.inertia
    contacts = [(body.new, outcome.impulses[1], answer.impulses[2:])]
    if body.old is not None:
        contacts.append((body.old, outcome.impulses[0], answer.impulses[:2]))
    size = sum(math.sqrt(mass * (q[0] ** 2 + q[1] ** 2) + inertia * q[2] ** 2) for q in (outcome.before, outcome.twist))
    size += sum(math.sqrt(mass) * math.hypot(*each.velocity) for each, _, _ in contacts)
    errors = []
    for contact, ours, exact in contacts:
        for row, one, other in zip(rows_of(contact, body), ours, exact, strict=True):
            size += abs(one) * float(np.linalg.norm(row))
            errors.append(abs(one - float(other)) * float(np.linalg.norm(row)))
    return max(errors) / (max(kappa(body, states) for states in answer.segments) * size)


def compared(body, twist, law):
    """An outcome and the exact answer, where there is one answer whose impulses are determined; else None."""
    problem, outcome = problem_of(body, twist), solve_impact(body, twist, law)
    if outcome.mode is Mode.NO_IMPACT or outcome.law != law:
        return None
    try:
        answers = total(problem) if law == "total" else [path(problem)]
    except Undecided:
        return None
    if len(answers) != 1 or answers[0].choices > 1 or any("SS" in each.segments for each in (answers[0], outcome)):
        return None
    return (outcome, answers[0]) if outcome.segments == answers[0].segments else None


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("extreme")])
def test_impulses_are_within_their_bound(kind, law):
    found = [pair for body, twist in random_impacts(kind, 60, seed=3) if (pair := compared(body, twist, law))]
    assert len(found) > (25 if kind != "both" or law == "total" else -1)
    for outcome, answer in found:
        assert weighed_error(outcome, answer) <= BOUND, (outcome.body, outcome.before)


def rare(kind, count, seed):
    """Impacts of a kind with much friction and restitution, which jam and whose stored work ends often."""
    source = np.random.default_rng(seed)
    for body, twist in random_impacts(kind, count, seed):
        frictions = source.uniform(1.0, 6.0, 2).tolist()
        old = body.old and body.old._replace(friction=frictions[0], restitution=0.0)
        new = body.new._replace(friction=frictions[1], restitution=float(source.choice([0.5, 0.9, 1.0])))
        yield body._replace(old=old, new=new), twist


@pytest.mark.parametrize("kind", ["floor", "wedge", "tilted", "deck", "apart", "slender"])
def test_jams_and_restitution_that_the_stored_work_ends_are_those_of_exact_arithmetic(kind):
    jams = limited = 0
    for body, twist in rare(kind, 80, 5):
        pair = compared(body, twist, "path")
        if pair is None:
            continue
        outcome, answer = pair
        assert bool(outcome.flags & Flag.JAMMED) is answer.jammed, (body, twist)
        assert bool(outcome.flags & Flag.WORK_LIMITED) is answer.work_limited, (body, twist)
        assert weighed_error(outcome, answer) <= BOUND, (body, twist)
        jams, limited = jams + answer.jammed, limited + answer.work_limited
    assert jams + limited > 4
