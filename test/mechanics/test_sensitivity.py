"""Derivatives of the twist after an impact, against differences of exact solutions and of the closed forms."""

from fractions import Fraction
from math import nan

import exact
import numpy as np
import pytest
from alone import random_impacts

from impact_predictor import Contact, Flag, Twist, TwoPointBody, plate, solve_impact
from impact_predictor.mechanics.random_problems import KINDS
from impact_predictor.mechanics.sensitivity import FREE, INPUTS, NO_CHANGE, allowed_changes, sensitivity

STEP = Fraction(1, 2**40)
"""Exact differences over it miss the derivative by 1e-12 of the curvature; speeds of 1e-14 count as none."""

ROUNDING = 1e-10
"""Derivatives are sums of a few hundred terms of size 1e2 at most, each with a rounding of 1e-16."""

NEAR_BORDER = 1e-7
"""At a border the derivative is taken 1e-9 away from it, and curvatures are up to 1e2."""

LAWS = ("path", "total")


def changed(body, twist, direction, step):
    """The body and the twist with their inputs changed by a step along a direction, in the numbers of the step."""
    old = body.old.friction if body.old else 0.0
    inputs = (old, body.new.friction, body.new.restitution, *twist)
    kind = type(step)
    friction_old, friction_new, restitution, *moved = (
        kind(x) + step * kind(d) for x, d in zip(inputs, direction, strict=True)
    )
    new = body.new._replace(friction=friction_new, restitution=restitution)
    return body._replace(old=body.old and body.old._replace(friction=friction_old), new=new), Twist(*moved)


def exact_difference(body, twist, direction, law, one_sided):
    """The derivative along a change of the inputs, or None where there is no answer, or one on another branch."""
    steps = (-STEP, STEP)
    if one_sided:
        steps = (-2 * STEP, -STEP) if direction[2] and body.new.restitution == 1.0 else (STEP, 2 * STEP)
    beside = changed(body, twist, direction, 1e-9 if steps[1] > STEP else -1e-9 if one_sided else 0.0)
    states = solve_impact(*beside, law).segments
    ends = []
    for step in steps:
        there, moved = changed(body, twist, direction, step)
        problem = exact.problem_of(there, moved)
        answers = [exact.path(problem)] if law == "path" else exact.total(problem)
        if not answers or answers[0].segments != states:
            return None
        ends.append([v + d for v, d in zip(moved, answers[0].change, strict=True)])
    return [float((after - before) / (steps[1] - steps[0])) for before, after in zip(*ends, strict=True)]


def columns_of(derivatives):
    """The derivatives by each of the INPUTS."""
    by_friction_and_restitution = derivatives.friction_old, derivatives.friction_new, derivatives.restitution
    return dict(zip(INPUTS, (*by_friction_and_restitution, *zip(*derivatives.twist, strict=True)), strict=True))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", ["plate", "cylinder", "floor", "wedge", "tilted", "deck", "one-point"])
def test_derivatives_are_those_of_exact_solutions(kind, law):
    compared = 0
    for body, twist in random_impacts(kind, 6, seed=4):
        outcome = solve_impact(body, twist, law)
        if not outcome.segments or not outcome.unique or outcome.flags & Flag.LAST_RESORT:
            continue
        derivatives = sensitivity(body, twist, law)
        size = body.inertia / body.mass
        weights = np.array([1.0, 1.0, size**0.5])
        allowed = np.array(allowed_changes(body, twist))
        directions = np.block([[np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), allowed]])
        for name, direction, column in zip(INPUTS, directions.T, columns_of(derivatives).values(), strict=True):
            if name == "friction_old" and body.old is None:
                continue
            one_sided = name in derivatives.one_sided
            expected = exact_difference(body, twist, direction.tolist(), law, one_sided)
            if expected is not None:
                scale = np.abs(weights * expected).sum() + abs(twist.vx) + abs(twist.vy)
                error = np.abs(weights * (np.array(column) - expected)).max()
                assert error <= (NEAR_BORDER if one_sided else ROUNDING) * scale, (name, body, twist)
                compared += 1
    assert compared > 12


def test_a_sliding_plate_has_the_derivatives_of_its_closed_form():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    a, h, w = 0.5, 0.2, 2.0
    derivatives = sensitivity(body, body.turning(-w))
    # v_s = w (h - f a), eq. (3.2), and omega = -w
    by_friction = np.add(derivatives.friction_old, derivatives.friction_new)
    assert by_friction == pytest.approx([-w * a, 0.0, 0.0], abs=ROUNDING)
    assert np.array(derivatives.twist)[:, 2] == pytest.approx([-(h - 0.2 * a), 0.0, 0.0], abs=ROUNDING)


def test_restitution_limited_by_the_stored_work_has_exact_derivatives():
    """The one place with a square root: found among random wedges, compared with exact differences."""
    compared = 0
    for body, twist in random_impacts("wedge", 2000, seed=2):
        outcome = solve_impact(body, twist)
        if outcome.flags & Flag.WORK_LIMITED and outcome.unique:
            derivatives = sensitivity(body, twist)
            direction = (0.0, 0.0, 0.0, *np.array(allowed_changes(body, twist))[:, 2])
            expected = exact_difference(body, twist, direction, "path", False)
            column = np.array(derivatives.twist)[:, 2]
            assert column == pytest.approx(np.array(expected), rel=1e-9, abs=1e-9)
            assert derivatives.restitution == NO_CHANGE
            compared += 1
    assert compared > 3


def test_at_a_border_the_derivative_is_that_of_the_greater_side_and_says_so():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.4)  # f = h / a
    derivatives = sensitivity(body, body.turning(-1.0))
    assert "friction_old" in derivatives.one_sided
    assert "friction_new" in derivatives.one_sided
    # With more friction at both the plate stops; with more at one alone it does, too.
    assert np.array([derivatives.friction_old, derivatives.friction_new]) == pytest.approx(
        np.zeros((2, 3)), abs=ROUNDING
    )


@pytest.mark.parametrize("speed", [1e-6, 1e6])
def test_borders_and_derivatives_by_the_twist_are_the_same_at_any_speed(speed):
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.4)._replace(old=None)
    slow, other = (sensitivity(body, Twist(0.0, -each, 0.0)) for each in (1.0, speed))
    assert other.one_sided == slow.one_sided
    assert "vx" in other.one_sided  # with slip it is another impact
    assert np.array(other.twist) == pytest.approx(np.array(slow.twist), abs=NEAR_BORDER)


def test_without_and_with_full_restitution_the_derivative_is_one_sided():
    for restitution in (0.0, 1.0):
        body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2, restitution=restitution)
        derivatives = sensitivity(body, body.turning(-1.0))
        assert derivatives.one_sided == ("restitution",)
        inside = body._replace(new=body.new._replace(restitution=abs(restitution - 1e-4)))
        twists = [np.array(solve_impact(each, each.turning(-1.0)).twist) for each in (body, inside)]
        slope = (twists[1] - twists[0]) / (inside.new.restitution - restitution)
        assert slope == pytest.approx(np.array(derivatives.restitution), abs=1e-6)


def test_what_would_move_a_resting_contact_is_no_change():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    turning = np.array(allowed_changes(body, body.turning(-1.0)))
    assert turning @ (1.0, 2.0, 3.0) == pytest.approx(body.turning(3.0))
    slipping = body.turning(-1.0)._replace(vx=0.3)
    vx, vy, omega = np.array(allowed_changes(body, slipping)) @ (1.0, 2.0, 3.0)
    assert (vx, omega) == (1.0, 3.0)
    assert vy + omega * body.old.x == pytest.approx(0.0, abs=ROUNDING)
    assert allowed_changes(body, slipping._replace(vy=3.0)) == FREE
    assert allowed_changes(body._replace(old=None), slipping) == FREE


def test_without_an_impact_the_twist_stays():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    for twist in (body.turning(1.0), Twist(nan, 0.0, 0.0)):
        assert sensitivity(body, twist) == (NO_CHANGE, NO_CHANGE, NO_CHANGE, FREE, ())
    with pytest.raises(ValueError, match="law is"):
        sensitivity(body, body.turning(-1.0), "laws")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_are_finite_whatever_the_impact(kind, law):
    for body, twist in random_impacts(kind, 20, seed=6):
        derivatives = sensitivity(body, twist, law)
        assert np.isfinite(np.array([*derivatives[:3], *derivatives.twist])).all()


@pytest.mark.parametrize("x", [0.0, 5e-324])
def test_a_contact_at_the_mass_centre_up_to_the_least_number_has_derivatives(x):
    contact = Contact(x, 0.0, 1.0, normal=(-1.0, 0.0), restitution=1.0, velocity=(0.4, 0.0))
    found = sensitivity(TwoPointBody(1.0, 1.0, None, contact), Twist(1.6, 0.1, -0.6))
    assert found.twist[2][2] == 1.0  # nothing turns it
    assert "omega" not in found.one_sided
