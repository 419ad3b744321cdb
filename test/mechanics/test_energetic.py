"""Energetic restitution on the impulse path: the new contact gives e^2 of the work back that it took."""

import math
import sys
from itertools import pairwise

import exact
import numpy as np
import pytest
from alone import random_impacts
from exact import NB
from exact_error import error_of
from golden_impacts import CASES, KINDS, body_of
from seen_by_contacts import contact_velocity, seen_by_contacts, velocities

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, cylinder, plate, solve_impact, solve_impacts
from impact_predictor.mechanics import contact_space, random_problems
from impact_predictor.mechanics.impact import batch
from impact_predictor.mechanics.invariants import CLAIMED, LIMITS, violations
from impact_predictor.mechanics.margins import margins
from impact_predictor.mechanics.sensitivity import sensitivity

PATH_KINDS = [kind for kind in KINDS if kind != "both"]
UNANSWERED = Flag.LAST_RESORT | Flag.NO_SOLUTION


def energetic(body, twist, law="path"):
    return solve_impact(body, twist, law, restitution="energetic")


def normal(angle):
    return -math.sin(angle), math.cos(angle)


def impact_in_a_wedge(square, old, new, angles, omega, slip, lift):
    """A body of mass 1 with the contacts (x, y, friction) and its restitution, which slips on A and leaves it."""
    (ax, ay, fa), (bx, by, fb, restitution) = old, new
    (nx, ny), normal_b = normal(angles[0]), normal(angles[1])
    body = TwoPointBody(1.0, square, Contact(ax, ay, fa, (nx, ny)), Contact(bx, by, fb, normal_b, restitution))
    return body, Twist(omega * ay + slip * ny + lift * nx, -omega * ax - slip * nx + lift * ny, omega)


DIPS = impact_in_a_wedge(
    1.71, (-0.61, -0.78, 0.94), (0.37, -1.05, 0.82, 0.5), (-1.24, 1.34), omega=0.42, slip=0.0, lift=0.87
)
"""Found by chance: the body comes back to A while B expands, and turns into B again, which stops before B is full."""

FILLS = [
    impact_in_a_wedge(
        1.07, (-0.45, -1.51, 1.0), (1.92, -0.73, 1.0, 1.0), (2.28, -1.12), omega=-1.93, slip=-0.47, lift=1.48
    ),
    impact_in_a_wedge(
        1.416, (-0.364, -1.965, 3.864), (0.493, -0.71, 3.864, 0.125), (0.13, -0.94), omega=1.039, slip=0.0, lift=0.56
    ),
]
"""The same, until B is full and its compression goes on: the first then stops, the second expands once more."""


@pytest.mark.parametrize("kind", PATH_KINDS)
def test_golden_geometries_end_where_exact_arithmetic_ends(kind):
    for case in (case for case in CASES if case["kind"] == kind):
        for restitution in (0.125, 0.5, 1.0):
            body, twist = body_of(case, restitution), Twist(*case["twist"])
            error_of(body, twist, "path", "energetic")
            assert not energetic(body, twist).flags & (Flag.WORK_LIMITED | UNANSWERED)


@pytest.mark.parametrize("kind", ["cylinder", "floor", "wedge", "tilted", "apart", "one-point"])
def test_random_impacts_end_where_exact_arithmetic_ends(kind):
    jams = 0
    for body, twist in random_impacts(kind, 150, seed=3):
        error_of(body, twist, "path", "energetic")
        jams += bool(body.new.restitution and energetic(body, twist).flags & Flag.JAMMED)
    assert jams > 0 or kind not in ("floor", "wedge")


@pytest.mark.parametrize(("body", "twist"), [DIPS, *FILLS])
def test_a_contact_that_is_pressed_again_takes_the_work_as_it_gave_it(body, twist):
    answer = exact.path(exact.problem_of(body, twist), energetic=True)
    speeds = [c[NB] for c in answer.history]
    assert any(before > 0 > after for before, after in pairwise(speeds))  # it is
    assert error_of(body, twist, "path", "energetic") < 1e-14
    outcome = energetic(body, twist)
    assert outcome.segments == answer.segments
    assert outcome.flags & (Flag.WORK_LIMITED | Flag.JAMMED | UNANSWERED) == Flag.NONE
    assert outcome.energy_lost > 0.0


def works_along(body, twist, segments):
    """The work -c_nB dN_B of each segment of the exact path, from what the states' impulses do to the velocities."""
    w, _, (fa, fb), _ = seen_by_contacts(body, twist)
    slides = {"+": -1.0, "-": 1.0}
    works = []
    history = exact.path(exact.problem_of(body, twist), energetic=True).history
    for (before, after), (a, b) in zip(pairwise(history), segments, strict=True):
        before, after = np.array(before, float), np.array(after, float)
        ways = [w[:, 2] + slides[b] * fb * w[:, 3]] if b in slides else [w[:, 2], w[:, 3]]
        if a != "O":
            ways += [w[:, 0] + slides[a] * fa * w[:, 1]] if a in slides else [w[:, 0], w[:, 1]]
        push, rest, *_ = np.linalg.lstsq(np.transpose(ways), after - before, rcond=None)
        assert np.all(rest < 1e-20)
        works.append(-push[0] * (before[NB] + after[NB]) / 2.0)
    return works


def test_the_part_e_squared_of_all_the_work_comes_back():
    body, twist = FILLS[1]
    outcome = energetic(body, twist)
    assert outcome.segments == ("O-", "O-", "+-", "+-", "S-", "OS")
    first, given, taken, *second, last = works_along(body, twist, outcome.segments)
    assert given < 0.0 < taken == pytest.approx(-given)
    assert last == pytest.approx(-(0.125**2) * (first + sum(second)))


def test_a_slip_that_stops_has_the_energetic_rebound_of_stronge():
    # One contact: c_nB grows by r1 while B slips and by r2 when it sticks, from the impulse N1 on.
    body = TwoPointBody(1.0, 0.1, None, Contact(0.2, -0.3, 0.6, restitution=0.7))
    twist = Twist(0.3, -1.0, 0.0)
    nn, nt, tt = 1.0 + 0.2**2 / 0.1, 0.2 * 0.3 / 0.1, 1.0 + 0.3**2 / 0.1
    r1, slowing = nn - 0.6 * nt, 0.6 * tt - nt
    n1 = 0.3 / slowing
    r2, speed = nn - nt * nt / tt, 1.0 - r1 * n1
    stored = n1 * (1.0 + speed) / 2.0 + speed * speed / (2.0 * r2)
    outcome = energetic(body, twist)
    assert outcome.segments == ("O+", "OS", "OS")
    assert contact_velocity(body.new, outcome.twist) == pytest.approx((0.7 * math.sqrt(2.0 * r2 * stored), 0.0))
    assert contact_velocity(body.new, solve_impact(body, twist).twist)[0] > 1.02 * 0.7 * math.sqrt(2.0 * r2 * stored)


@pytest.mark.parametrize("kind", ["plate", "cylinder", "floor", "wedge", "tilted", "one-point"])
def test_it_is_poissons_and_newtons_where_the_states_stay(kind):
    compared = 0
    for body, twist in random_impacts(kind, 400, seed=2):
        outcome = energetic(body, twist)
        if body.new.restitution == 0.0 or outcome.mode is Mode.NO_IMPACT or len({*outcome.segments}) > 1:
            continue
        before, after = (contact_velocity(body.new, each)[0] for each in (twist, outcome.twist))
        size = max(velocities(body, twist)[1])
        assert after == pytest.approx(-body.new.restitution * before, abs=1e-12 * size)
        assert outcome.twist == pytest.approx(solve_impact(body, twist).twist, rel=1e-10, abs=1e-12 * size)
        compared += 1
    assert compared > 20


def test_without_restitution_the_rules_are_one_to_the_last_bit():
    for case in (case for case in CASES if case["kind"] != "both"):
        body, twist = body_of(case), Twist(*case["twist"])
        assert energetic(body, twist) == solve_impact(body, twist)._replace(restitution="energetic")


@pytest.mark.parametrize("kind", random_problems.KINDS)
def test_no_impact_breaks_an_invariant_or_needs_a_limit_of_its_work(kind):
    _, body, twist = random_problems.problems_of(kind, np.random.default_rng(2), 5000)
    body = body._replace(new=body.new._replace(restitution=np.maximum(body.new.restitution, 0.1)))
    with np.errstate(all="ignore"):
        outcomes, found = violations(
            body, twist, "path", lambda *problem: solve_impacts(*problem, restitution="energetic")
        )
    assert not np.any(outcomes.flags & Flag.WORK_LIMITED)
    for name, values in found.items():
        if name in CLAIMED.get(kind, LIMITS):
            assert values.max() <= LIMITS[name], name


@pytest.mark.parametrize("kind", ["cylinder", "wedge", "apart", "both", "extreme"])
def test_many_impacts_have_the_answers_of_each_alone_compiled_or_not(kind, monkeypatch):
    _, body, twist = random_problems.problems_of(kind, np.random.default_rng(9), 300)
    compiled = solve_impacts(body, twist, restitution="energetic")
    monkeypatch.setitem(sys.modules, "numba", None)  # an import of it fails
    batch.chunk_solver.cache_clear()
    try:
        plain = solve_impacts(body, twist, restitution="energetic")
    finally:
        batch.chunk_solver.cache_clear()
    assert [field.tobytes() for field in plain] == [field.tobytes() for field in compiled]
    each = [energetic(*problem) for problem in random_impacts(kind, 300, seed=9)]
    assert np.array([one.twist for one in each]).tobytes() == compiled.twist.tobytes()
    assert [one.mode for one in each] == compiled.mode.tolist()


@pytest.mark.parametrize("kind", ["plate", "cylinder", "wedge", "tilted"])
def test_a_machine_known_by_its_w_has_the_impact_of_the_body(kind):
    for body, twist in random_impacts(kind, 100, seed=4):
        outcome = contact_space.solve(*seen_by_contacts(body, twist), rule="energetic")
        expected = velocities(body, energetic(body, twist).twist)[0]
        assert outcome.velocities == pytest.approx(expected, abs=1e-11 * max(velocities(body, twist)[1]))
        assert not outcome.flags & Flag.WORK_LIMITED


def test_a_body_that_locks_in_its_wedge_keeps_the_work():
    bodies = [cylinder(radius=1.0, gamma=1.3, mass=2.0, friction=2.0, restitution=each) for each in (0.0, 0.5)]
    plastic, locked = (energetic(body, body.turning(-1.0)) for body in bodies)
    assert plastic.mode is locked.mode is Mode.STOP
    assert locked.twist == pytest.approx(plastic.twist, abs=1e-15)
    assert locked.impulses[1] == pytest.approx(plastic.impulses[1])
    assert locked.energy_lost == pytest.approx(plastic.energy_lost)


def test_margins_and_derivatives_are_those_of_the_rule():
    body = plate(length=1.0, height=0.8, mass=10.0, friction=0.3, restitution=0.5)
    twist = Twist(-0.35, -0.5, -1.0)
    outcome = energetic(body, twist)
    assert outcome.twist != pytest.approx(solve_impact(body, twist).twist, rel=1e-3)
    assert outcome.margins == margins(body, twist, restitution="energetic") != margins(body, twist)
    step = 1e-6
    nearby = [energetic(body._replace(new=body.new._replace(restitution=0.5 + d)), twist).twist for d in (-step, step)]
    slope = [(more - less) / (2.0 * step) for less, more in zip(*nearby, strict=True)]
    assert sensitivity(body, twist, restitution="energetic").restitution == pytest.approx(slope, rel=1e-6)


def test_unknown_rules_and_that_of_the_total_law_are_refused_with_one_sentence():
    body = plate(1.0, 0.4, 10.0, 0.3)
    twist = body.turning(-1.0)
    for solve in (solve_impact, solve_impacts):
        with pytest.raises(ValueError, match=r"^restitution is 'newton'; use 'poisson' or 'energetic'$"):
            solve(body, twist, restitution="newton")
        with pytest.raises(ValueError, match=r"^the law 'total' has its own restitution, not the 'energetic' one; use"):
            solve(body, twist, "total", restitution="energetic")
    with pytest.raises(ValueError, match="restitution is 'newton'"):
        contact_space.solve(np.eye(4), (0.0, 0.0, -1.0, 0.0), (0.3, 0.3), rule="newton")
