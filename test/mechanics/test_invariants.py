"""What holds for every impact, by both laws; and that the invariants see an impact that breaks them."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from impact_predictor import Contact, Flag, Twist, TwoPointBody, plate, solve_impact
from impact_predictor.mechanics.impact.batch import Outcomes
from impact_predictor.mechanics.invariants import CLAIMED, LIMITS, Soak, violations
from impact_predictor.mechanics.random_problems import KINDS, problems_of

LAWS = st.sampled_from(["path", "total"])


def between(low, high):
    """Numbers of six decimals, which are read easily where a test fails."""
    return st.integers(round(low * 1e6), round(high * 1e6)).map(lambda number: number * 1e-6)


lengths, speeds = between(0.02, 2.0), between(-3.0, 3.0)
frictions, restitutions = between(0.0, 4.0), st.sampled_from([0.0, 0.125, 0.5, 1.0])


def angle_of_step(old, new):
    """Of B's normal, so that its tangent passes through A."""
    return math.atan2(new[1] - old[1], new[0] - old[0])


@st.composite
def problems(draw, supports=("still", "deck", "apart")):
    """A body that approaches B while it rests or slips on A, leaves it or falls on it, or that has no A."""
    old_at, new_at = (-draw(lengths), -draw(lengths)), (draw(lengths), -draw(lengths))
    kind = draw(st.sampled_from(["floor", "step", "wedge", "any"]))
    if kind == "floor":
        new_at = (new_at[0], old_at[1])
    old_angle = draw(between(-3.0, 3.0)) if kind == "any" else 0.0
    new_angle = draw(between(-1.5, 1.5)) if kind in ("wedge", "any") else angle_of_step(old_at, new_at)
    old_normal, new_normal = ((-math.sin(angle), math.cos(angle)) for angle in (old_angle, new_angle))

    omega, slip = draw(speeds), draw(st.sampled_from([0.0, 1.0])) * draw(speeds)
    lift = draw(st.sampled_from([0.0, 0.0, 0.0, 0.5, -0.5]))
    vx = omega * old_at[1] + slip * old_normal[1] + lift * old_normal[0]
    vy = -omega * old_at[0] - slip * old_normal[0] + lift * old_normal[1]
    cx, cy = vx - omega * new_at[1], vy + omega * new_at[0]
    approach = -(new_normal[0] * cx + new_normal[1] * cy)
    assume(abs(approach) > 1e-3 * (math.hypot(cx, cy) + abs(slip)))
    if approach < 0.0 and lift == 0.0:
        vx, vy, omega = -vx, -vy, -omega

    support = draw(st.sampled_from(supports))
    ux, uy, turning = (draw(speeds) for _ in range(3)) if support == "deck" else (0.0, 0.0, 0.0)
    still = [(ux - turning * y, uy + turning * x) for x, y in (old_at, new_at)]
    if support == "apart":
        still[1] = (draw(speeds), draw(speeds))
    mass, square = draw(between(0.1, 10.0)), draw(between(0.01, 2.0))
    old = Contact(*old_at, draw(frictions), old_normal, 0.0, still[0])
    new = Contact(*new_at, draw(frictions), new_normal, draw(restitutions), still[1])
    stands = draw(st.sampled_from([True, True, True, False]))
    return TwoPointBody(mass, mass * square, old if stands else None, new), Twist(vx + ux, vy + uy, omega + turning)


def solve(body, twist, law):
    """`solve_impact` in the arrays that the invariants read."""
    outcome = solve_impact(body, twist, law)
    return Outcomes(
        mode=np.asarray(outcome.mode),
        twist=np.array(outcome.twist),
        impulses=np.array(outcome.impulses),
        segments=np.asarray(len(outcome.segments)),
        flags=np.asarray(int(outcome.flags)),
        energy_lost=np.asarray(outcome.energy_lost),
        unique=np.asarray(outcome.unique),
    )


@settings(max_examples=1000, deadline=None, derandomize=True)
@given(problems(), LAWS)
def test_every_invariant_holds_for_one_impact_of_any_kind(problem, law):
    _, found = violations(*problem, law, solve)
    assert {name: float(value) for name, value in found.items() if value > LIMITS[name]} == {}


@pytest.mark.slow
@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("kind", KINDS)
def test_many_random_impacts_keep_within_the_limits(kind, law):
    # The same numbers wherever the test runs.
    problem = problems_of(kind, np.random.default_rng(1), 20_000)
    _, found = violations(problem.body, problem.twist, law)
    for name, values in found.items():
        if name in CLAIMED.get(kind, LIMITS):
            assert values.max() <= LIMITS[name], name


BODY = plate(1.0, 0.4, 10.0, 0.3)
TWIST = BODY.turning(-1.0)


def broken(change, body, twist, law):
    """Outcomes with a field changed."""
    outcomes = solve(body, twist, law)
    return outcomes._replace(**change(outcomes))


@pytest.mark.parametrize(
    ("names", "change"),
    [
        (("finite",), lambda each: {"energy_lost": each.energy_lost * np.nan}),
        (("cone", "momentum", "work"), lambda each: {"impulses": -each.impulses}),
        (("cone", "momentum"), lambda each: {"impulses": np.add(each.impulses, [[0.0, 0.0], [0.0, -9.0]])}),
        (("momentum", "energy", "units", "mirror"), lambda each: {"twist": np.add(each.twist, [0.01, 0.0, 0.0])}),
        (("approach", "momentum"), lambda each: {"twist": np.add(each.twist, [0.0, -0.01, 0.0])}),
        (("energy",), lambda each: {"energy_lost": 1.1 * each.energy_lost}),
    ],
    ids=["not finite", "pulled", "rough", "pushed", "pressed", "heated"],
)
@pytest.mark.parametrize("law", ["path", "total"])
def test_an_impact_that_breaks_an_invariant_is_seen(names, change, law):
    _, found = violations(BODY, TWIST, law, partial(broken, change))
    for name in names:
        assert found[name] > LIMITS[name]


def test_a_jump_is_seen():
    def jumps(body, twist, law):
        outcomes = solve(body, twist, law)
        return outcomes if body is BODY else outcomes._replace(twist=np.add(outcomes.twist, [0.1, 0.0, 0.0]))

    _, found = violations(BODY, TWIST, "path", jumps)
    assert found["continuity"] > LIMITS["continuity"]


def test_what_no_law_answers_violates_nothing():
    bad = BODY._replace(mass=math.nan)
    outcomes, found = violations(bad, TWIST, "path", solve)
    assert outcomes.flags & int(Flag.INVALID_INPUT)
    assert set(found) == set(LIMITS)
    assert all(value == 0.0 for value in found.values())


def test_every_kind_has_its_turn_in_a_short_soak_too():
    told, soak = [], Soak(2 * len(KINDS) - 1, 3, ["path"])
    soak.run(told.append)
    assert told == [*range(2, 2 * len(KINDS) - 1, 2), 2 * len(KINDS) - 1]
    assert not soak.broken
