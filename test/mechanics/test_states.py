"""No contact state is overlooked: the laws try few of them, a search finds no others."""

import math
import random

import numpy as np
import pytest

from impact_predictor.mechanics.impact import total_law
from impact_predictor.mechanics.impact.contacts import MINUS, OPEN, PLUS, STICK, planar_contacts, push_interval
from impact_predictor.mechanics.impact.rates import (
    choose,
    open_rates,
    rolling_rates,
    slide_rates,
    slide_stick_rates,
    state_alone,
    stick_rates,
    try_all,
    wedged_rates,
)


def random_pair(source, flat=False):
    angle = 0.0 if flat else source.uniform(-2.0, 2.0)
    cos, sin = math.cos(angle), math.sin(angle)
    qa, sa, qb, sb = source.uniform(-3, 1), source.uniform(-2, 3), source.uniform(-1, 3), source.uniform(-2, 3)
    top = source.choice((0.5, 1.0, 3.0))
    return cos, sin, qa, sa, qb, sa if flat else sb, source.uniform(0.0, top), source.uniform(0.0, top)


def all_states(contacts, cta, ctb, tied=False):
    """Every consistent pair of states of a closed A and an approached B, without regard to what was proved.

    `tied`: B's tangent passes through A, so that at rest both stick or none does.
    """
    found = []
    b = state_alone(contacts, ctb)
    if open_rates(contacts, b, 0.0)[0]:
        found.append((OPEN, b))
    for a in (STICK, PLUS, MINUS):
        if (a == STICK and cta != 0.0) or (a == PLUS and cta < 0.0) or (a == MINUS and cta > 0.0):
            continue
        for b in (STICK, PLUS, MINUS):
            if (b == STICK and ctb != 0.0) or (b == PLUS and ctb < 0.0) or (b == MINUS and ctb > 0.0):
                continue
            if tied and (a == STICK) != (b == STICK):
                continue
            if tied and a == STICK:
                rates = rolling_rates(contacts)
            elif b == STICK:
                rates = wedged_rates(contacts) if a == STICK else slide_stick_rates(contacts, a, cta)
            else:
                rates = stick_rates(contacts, b, ctb) if a == STICK else slide_rates(contacts, a, b, cta, ctb)
            ends = (a >= PLUS and cta * rates[5] < 0.0) or (b >= PLUS and ctb * rates[7] < 0.0)
            if rates[0] and (rates[6] > 0.0 or ends):
                found.append((a, b))
    return found


def test_a_body_at_rest_on_one_flat_floor_has_one_consistent_pair_of_states():
    source = random.Random(4)
    for _ in range(20000):
        pair = random_pair(source, flat=True)
        if pair[4] <= pair[2]:
            continue
        contacts = planar_contacts(*pair)
        b = state_alone(contacts, 0.0)
        alone = open_rates(contacts, b, 0.0)
        found, a, b, rates = try_all(contacts, b, alone, 0.0, 0.0, True, 0)
        assert found == 1
        assert choose(contacts, 0.0, 0.0, 0.0, True, 0) == (found, a, b, rates)
        if a == STICK:
            assert rates == rolling_rates(contacts)


def test_the_states_that_the_path_law_does_not_try_are_not_consistent():
    source = random.Random(5)
    several = 0
    for _ in range(20000):
        contacts = planar_contacts(*random_pair(source))
        cta, ctb = (source.choice((0.0, source.uniform(-1.0, 1.0))) for _ in range(2))
        states = all_states(contacts, cta, ctb)
        found, a, b, _ = choose(contacts, 0.0, cta, ctb, True, 0)
        assert found == len(states)
        assert not states or states[0] == (a, b)
        for choice, state in enumerate(states):
            assert choose(contacts, 0.0, cta, ctb, True, choice)[1:3] == state
        several += found > 1
    assert several > 100


def test_a_body_at_rest_on_a_step_or_between_walls_has_the_states_that_a_search_finds():
    source = random.Random(7)
    several, opposite = 0, 0
    for _ in range(20000):
        cos, sin, qa, sa, qb, _, fa, fb = random_pair(source)
        contacts = planar_contacts(cos, sin, qa, sa, qb, sa * cos + qa * sin, fa, fb)
        states = all_states(contacts, 0.0, 0.0, tied=True)
        found, a, b, _ = choose(contacts, 0.0, 0.0, 0.0, True, 0)
        assert found == len(states)
        assert not states or states[0] == (a, b)
        several += found > 1
        opposite += (PLUS, MINUS) in states or (MINUS, PLUS) in states
    # Between walls more than a right angle apart the slips are opposite.
    assert min(several, opposite) > 100


def test_a_frictionless_contact_can_be_pushed_but_not_pulled():
    assert push_interval(-1.0, 0.0, 1.0, 0.0, 0.0) == (1.0, math.inf)
    assert push_interval(2.0, 0.0, -1.0, 0.0, 0.0) == (-math.inf, 2.0)
    assert push_interval(-1.0, 0.0, 0.0, 1.0, 0.0) == (math.inf, -math.inf)
    assert push_interval(1.0, 0.5, 0.0, 1.0, 0.3) == pytest.approx((-0.8, -0.2))


def solutions_by_elimination(problem):
    """Twist changes of all solutions of the total law but stick-stick, each pair of states a 4 x 4 linear system."""
    contacts, (restitution_old, restitution), before, _ = problem
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, _, fb), *_ = contacts
    rows, frictions = np.array([(0, an, qa), (at, 0, sa), (nx, ny, nq), (tx, ty, tq)]), (fa, fb)
    w = rows @ rows.T
    c = np.array(before)
    newton = c * (1 + np.array([restitution_old, 0, restitution, 0]))
    solutions = []
    for states in [(a, b) for a in "OS+-" for b in "OS+-"]:
        matrix, right = np.zeros((4, 4)), np.zeros(4)
        for n, (state, friction) in zip((0, 2), zip(states, frictions, strict=True), strict=True):
            t = n + 1
            if state == "O":
                matrix[n, n] = matrix[t, t] = 1.0
                continue
            matrix[n], right[n] = w[n], -newton[n]
            if state == "S":
                matrix[t], right[t] = w[t], -c[t]
            else:
                matrix[t, t], matrix[t, n] = 1.0, friction if state == "+" else -friction
        if states == ("S", "S") or np.linalg.matrix_rank(matrix, tol=1e-9) < 4:
            continue
        impulses = np.linalg.solve(matrix, right)
        after = c + w @ impulses
        for n, (state, friction) in zip((0, 2), zip(states, frictions, strict=True), strict=True):
            normal, tangential = impulses[n], impulses[n + 1]
            if (
                (state == "O" and after[n] - c[n] + newton[n] < 0)
                or (state != "O" and normal < 0)
                or (state == "S" and abs(tangential) > friction * normal)
                or (state == "+" and after[n + 1] < 0)
                or (state == "-" and after[n + 1] > 0)
            ):
                break
        else:
            solutions.append(rows.T @ impulses)
    return solutions


def test_the_total_law_finds_the_solutions_that_elimination_finds():
    source = random.Random(6)
    several = 0
    for _ in range(1500):
        pair = random_pair(source)
        velocities = (0.0, source.uniform(-1, 1), -source.uniform(0.1, 1.0), source.uniform(-1, 1))
        if source.random() < 0.3:
            velocities = (-source.uniform(0.1, 1.0), *velocities[1:])
        problem = planar_contacts(*pair), (0.3, source.choice((0.0, 0.5))), velocities, (1e-14,) * 4
        expected = solutions_by_elimination(problem)
        count = total_law.solve(problem, 0)[13]
        # Generic velocities of two contacts are not those of one support, so that both cannot stick.
        assert count == len(expected)
        found = [total_law.solve(problem, choice)[8:11] for choice in range(count)]
        for solution in expected:
            assert min(max(abs(solution - other)) for other in found) <= 1e-8 * max(abs(solution))
        several += count > 1
    assert several > 10
