"""Impacts known by W and c: exact arithmetic, invariants, almost rigid machines, singular W, bad numbers."""

import math
import random
from fractions import Fraction

import exact
import numpy as np
import pytest
from exact_algebra import dot
from seen_by_contacts import condition, seen_by_contacts

from impact_predictor import Flag, Mode, plate
from impact_predictor.mechanics.contact_space import solve

LAWS = ("path", "total")
CLOSE = 1e-11
"""Largest error of a contact velocity, as a part of the largest one, where W is well conditioned."""
ERROR = 5e-15
"""The same for each unit of W's condition number, and part of the terms of W P: a few dozen roundings."""


def largest_difference(one, other):
    return max(abs(u - v) for u, v in zip(one, other, strict=True) if u < math.inf)


def random_mechanism(source, freedoms, decades=0):
    """An exact problem with a W of rank `freedoms`, or 4: the old contact rests, slips or leaves, the new is struck."""

    def some(low, high):
        return Fraction(source.randint(64 * low, 64 * high), 64)

    rows = [[some(-2, 2) for _ in range(freedoms)] for _ in range(4)]
    if freedoms > 2 and source.random() < 0.3:  # B's tangent moves only with A
        u, v = some(-2, 2), some(-2, 2)
        rows[3] = [u * x + v * y for x, y in zip(rows[0], rows[1], strict=True)]
    inverse = [Fraction(10) ** source.randint(-decades, decades) for _ in range(freedoms)]
    w = [[dot(u, [x * m for x, m in zip(v, inverse, strict=True)]) for v in rows] for u in rows]
    motion = [some(-2, 2) for _ in range(freedoms)]
    if freedoms > 1 and source.random() < 0.6:  # A rests on its support
        share = dot(rows[0], motion) / (dot(rows[0], rows[0]) or 1)
        motion = [x - share * y for x, y in zip(motion, rows[0], strict=True)]
    c = [dot(row, motion) for row in rows]
    if freedoms > 3 and source.random() < 0.5:  # velocities that depend on nothing
        c = [Fraction(0), source.choice([Fraction(0), some(-2, 2)]), c[2], source.choice([Fraction(0), some(-2, 2)])]
    if c[2] > 0:
        c = [-speed for speed in c]
    friction = tuple(some(0, 1) * source.choice([0, 1, 2, 4, 8]) for _ in range(2))
    restitution = (Fraction(0), source.choice([Fraction(0), Fraction(1, 8), Fraction(1, 2)]))
    return exact.Problem(rows, w, (Fraction(1),) * 2, c, friction, restitution, tuple(inverse))


def as_floats(problem):
    w = np.array([[float(number) for number in row] for row in problem.w])
    return w, *(tuple(map(float, part)) for part in (problem.velocities, problem.frictions, problem.restitutions))


@pytest.mark.parametrize(("freedoms", "decades"), [(6, 0), (4, 0), (3, 0), (2, 0), (1, 0), (5, 2), (5, 4), (3, 2)])
def test_impacts_of_any_w_end_where_exact_arithmetic_ends(freedoms, decades):
    source = random.Random(freedoms)
    compared = {"path": 0, "jams": 0, "total": 0, "several": 0, "none": 0}
    for _ in range(150):
        problem = random_mechanism(source, freedoms, decades)
        w, c, friction, restitution = as_floats(problem)
        if c[2] == 0.0 or min(np.diag(w)) == 0.0:
            continue
        close = max(map(abs, c)) * max(CLOSE, ERROR * condition(w))

        def error_of(speeds, answer, w=w, close=close):
            """How far contact velocities are from an exact answer, in units of what they may be."""
            terms = abs(w) @ [abs(float(part)) for part in answer.impulses]
            return largest_difference(map(float, answer.history[-1]), speeds) / (close + ERROR * max(terms))

        if c[0] >= 0.0:
            outcome = solve(w, c, friction, restitution)
            try:
                answer = exact.path(problem)
            except exact.Undecided:
                assert outcome.flags & (Flag.JAMMED | Flag.LAST_RESORT | Flag.NO_SOLUTION)
            else:
                assert outcome.law == "path"
                assert error_of(outcome.velocities, answer) <= 1.0
                assert bool(outcome.flags & Flag.JAMMED) is answer.jammed
                assert outcome.unique or answer.choices > 1
                compared["path"] += 1
                compared["jams"] += answer.jammed
        outcome = solve(w, c, friction, restitution, "total")
        answers = exact.total(problem)
        if not answers:
            assert outcome.flags & (Flag.NO_SOLUTION | Flag.LAST_RESORT)
            compared["none"] += 1
            continue
        ours = [outcome.velocities, *(other.velocities for other in outcome.alternatives)]
        assert all(min(error_of(one, answer) for answer in answers) <= 1.0 for one in ours)
        if c[0] <= 0.0:  # else friction could hold an A that leaves, which is an answer only where it is the only one
            assert all(min(error_of(one, answer) for one in ours) <= 1.0 for answer in answers)
        compared["total"] += 1
        compared["several"] += len(ours) > 1
    assert min(compared["path"], compared["total"]) > 50
    if freedoms > 2:
        assert compared["jams"] + compared["several"] > 3
    if freedoms < 3:  # contacts whose velocities are not those of a motion cannot both be held
        assert compared["none"] > 10


def seen_plate(friction):
    """W and c of a plate that tips over onto its front edge."""
    body = plate(length=1.0, height=0.4, mass=2.0, friction=friction)
    return seen_by_contacts(body, body.turning(-1.0))


@pytest.mark.parametrize("friction", [0.2, 0.9])
@pytest.mark.parametrize("law", LAWS)
def test_a_machine_that_is_almost_a_rigid_body_has_almost_its_impact(law, friction):
    w, c, frictions, _ = seen_plate(friction)
    expected = solve(w, c, frictions, law=law)
    given = np.array([0.3, -0.5, 0.2, 0.7])
    for size in (1e-3, 1e-6, 1e-9, 1e-11, 1e-13, 1e-15):
        outcome = solve(w + size * np.outer(given, given), c, frictions, law=law)
        # 30: how much softer W makes the contacts, against the least that it was; below its rounding it is singular.
        assert outcome.velocities == pytest.approx(expected.velocities, abs=30.0 * size + 1e-15)
        assert outcome.impulses[0][0] == pytest.approx(expected.impulses[0][0], rel=1e-2)


@pytest.mark.parametrize("law", LAWS)
def test_a_point_mass_that_slides_down_one_wall_of_a_wedge_meets_the_other(law):
    # Walls at 45 degrees, so that the second one stops it, and friction there may hold it: W has rank 2.
    half, mass = math.sqrt(0.5), 2.0
    rows = np.array([(half, half), (half, -half), (-half, half), (half, half)])
    outcome = solve(rows @ rows.T / mass, (0.0, 1.0, -1.0, 0.0), (0.3, 0.3), law=law)
    assert outcome.mode is Mode.STOP
    assert outcome.velocities == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-15)
    assert outcome.impulses[1] == pytest.approx((mass, 0.0), abs=1e-14)
    assert outcome.energy_lost == pytest.approx(0.5 * mass)
    # With a rebound it slides back up.
    outcome = solve(rows @ rows.T / mass, (0.0, 1.0, -1.0, 0.0), (0.3, 0.3), (0.0, 0.5), law)
    assert outcome.velocities == pytest.approx((0.0, -0.5, 0.5, 0.0), abs=1e-15)
    assert outcome.mode is Mode.BACK_PIVOT


def test_a_lever_with_one_freedom_stops_and_without_a_way_to_stop_says_so():
    lever = np.array([0.0, 0.3, 0.8, 0.1])  # contact velocities for a unit of turning; A only slips
    w, c = np.outer(lever, lever) / 0.5, -lever
    for law in LAWS:
        outcome = solve(w, c, (0.4, 0.4), law=law)
        assert outcome.mode is Mode.STOP
        assert outcome.velocities == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-15)
        assert outcome.energy_lost == pytest.approx(0.25, rel=1e-14)
        stuck = solve(np.zeros((4, 4)), c, (0.4, 0.4), law=law)
        assert stuck.flags == Flag.NO_SOLUTION
        assert stuck.velocities == tuple(c)


GOOD = np.diag([1.0, 2.0, 3.0, 4.0]) + 0.1
AT = (0.0, 0.0, -1.0, 0.5)


def changed(matrix, i, j, value):
    matrix = matrix.copy()
    matrix[i, j] = value
    return matrix


@pytest.mark.parametrize(
    "given",
    [
        {"W": changed(GOOD, 0, 1, math.nan)},
        {"W": changed(GOOD, 2, 2, math.inf)},
        {"W": changed(GOOD, 0, 1, 0.2)},  # not symmetric
        {"W": changed(changed(GOOD, 0, 1, 2.0), 1, 0, 2.0)},  # a negative eigenvalue
        {"W": changed(GOOD, 3, 3, -1.0)},
        {"W": -GOOD},
        {"c": (math.nan, 0.0, -1.0, 0.0)},
        {"c": (-math.inf, 0.0, -1.0, 0.0)},
        {"c": (0.0, 0.0, -math.inf, 0.0)},
        {"c": (0.0, math.inf, -1.0, 0.0)},
        {"friction": (-0.1, 0.5)},
        {"friction": (0.1, math.nan)},
        {"friction": (0.1, math.inf)},
        {"restitution": (0.0, 1.1)},
        {"restitution": (-0.1, 0.5)},
        {"restitution": (math.nan, 0.5)},
    ],
)
@pytest.mark.parametrize("law", LAWS)
def test_numbers_that_no_mechanism_has_give_a_flag(given, law):
    outcome = solve(**{"W": GOOD, "c": AT, "friction": (0.3, 0.3), "restitution": (0.0, 0.0), "law": law, **given})
    assert outcome.flags == Flag.INVALID_INPUT
    assert outcome.mode is Mode.NO_IMPACT
    assert outcome.impulses == ((0.0, 0.0), (0.0, 0.0))
    assert all(math.isfinite(speed) for speed in outcome.velocities)


def test_a_contact_that_is_not_approached_has_no_impact():
    outcome = solve(GOOD, (0.0, 1.0, 0.5, 1.0), (0.3, 0.3))
    assert (outcome.mode, outcome.flags, outcome.velocities) == (Mode.NO_IMPACT, Flag.NONE, (0.0, 1.0, 0.5, 1.0))


def test_an_unknown_law_or_another_shape_raises():
    with pytest.raises(ValueError, match="law is 'newton'; use 'path' or 'total'"):
        solve(GOOD, AT, (0.3, 0.3), law="newton")
    with pytest.raises(ValueError, match=r"W has the shape \(3, 3\); give \(4, 4\)"):
        solve(GOOD[:3, :3], AT, (0.3, 0.3))


@pytest.mark.parametrize("decades", [3.0, 12.0, 150.0])
def test_no_number_raises_or_gives_one_that_is_not_finite(decades):
    source = random.Random(7)

    def wild():
        return source.choice([-1.0, 0.0, 1.0, 1.0]) * 10.0 ** source.uniform(-decades, decades)

    odd = [math.nan, math.inf, -math.inf, 1e308, -1.0, 5e-324]
    for _ in range(300):
        rows = np.array([[wild() for _ in range(4)] for _ in range(4)])
        rows[:, source.randint(1, 4) :] = 0.0
        with np.errstate(all="ignore"):
            w = rows @ rows.T
        c = [source.choice([0.0, math.inf, wild()]), wild(), -abs(wild()), wild()]
        if source.random() < 0.1:
            w[source.randrange(4), source.randrange(4)] = source.choice(odd)
            c[source.randrange(4)] = source.choice(odd)
        for law in LAWS:
            outcome = solve(w, c, (abs(wild()), abs(wild())), (0.5, source.choice([0.0, 0.5, 1.0])), law)
            numbers = [outcome.energy_lost, *outcome.impulses[0], *outcome.impulses[1]]
            for one in (outcome, *outcome.alternatives):
                numbers += one.velocities[1:]
            assert all(math.isfinite(number) for number in numbers)
