"""Impacts over twelve decades, at borders and near singular geometry, against exact arithmetic (see `exact_error`)."""

import itertools
import math
import random

import numpy as np
import pytest
from alone import random_impacts
from exact_error import CLOSE, error_of

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, cylinder, plate, rod, solve_impact
from impact_predictor.mechanics.invariants import CLAIMED
from impact_predictor.mechanics.random_problems import KINDS

LAWS = ("path", "total")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in (*CLAIMED, "deck")])
def test_an_ordinary_impact_has_no_error_above_the_target(kind, law):
    for body, twist in random_impacts(kind, 40, seed=2):
        assert error_of(body, twist, law) <= CLOSE, (body, twist)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", CLAIMED)
def test_a_stiff_impact_has_no_error_above_its_conditioning(kind, law):
    errors = [error_of(body, twist, law) for body, twist in random_impacts(kind, 60, seed=2)]
    assert np.median(errors) <= CLOSE


DECADES = [10.0**exponent for exponent in range(-6, 7, 2)]


@pytest.mark.parametrize("law", LAWS)
def test_twelve_decades_of_any_one_parameter_leave_all_digits(law):
    for value, friction in itertools.product(DECADES, (0.1, 1.5)):
        bodies = [
            plate(1.0, 0.4, value, friction),
            plate(value, 0.4 * value, 10.0, friction),
            plate(1.0, 0.4, 10.0, friction, inertia=value),
            plate(1.0, 1.6, 10.0, friction, a=min(value, 1.0)),
            cylinder(value, 0.8, 2.0, friction, gamma_new=0.6),
            rod(1.0, min(value, 0.1), 0.1, 0.2, 1.0, friction),
        ]
        cases = [(body, body.turning(-1.0)) for body in bodies]
        cases += [(bodies[0], bodies[0].turning(-value)), (bodies[4], bodies[4].turning(-value))]
        for body, twist in cases:
            assert error_of(body, twist, law) <= CLOSE


def neighbours(number):
    """The number and some of those next to it."""
    return [number * (1.0 + k * 2.0**-52) for k in (-3, -1, 0, 1, 3)]


PLATES = {
    "stops, does not slip: f = h/a": (1.0, 2.0, 0.5, 1.0, 0.5),
    "stops or lifts, slips: ab = rho^2 + h^2": (1.0, 2.0, 1.0, 1.0, 0.25),
    "stops or lifts, without friction": (1.0, 1.0, 0.0, 1.0, 0.0),
    "stops or lifts, sticks": (1.0, 2.0, 1.0, 1.0, 2.0),
    "all at once: ab = rho^2 + h^2, f = h/a": (1.0, 2.0, 1.0, 1.0, 1.0),
    "lifts, slips: f h a = ab - rho^2": (1.0, 1.25, 1.0, 1.0, 0.25),
    "lifts, sticks: f = h b/(rho^2 + h^2)": (1.0, 1.0, 1.0, 1.0, 0.5),
}
"""a, b, h, rho^2 and f of bodies at a border between modes (the paper, section 3)."""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("border", PLATES)
def test_a_plate_at_a_border_and_next_to_it(border, law):
    a, b, h, square, friction = PLATES[border]
    for height, f in itertools.product(neighbours(h), neighbours(friction)):
        for restitution in (0.0, 0.5):
            new = Contact(b, -height, f, restitution=restitution)
            body = TwoPointBody(2.0, 2.0 * square, Contact(-a, -height, f), new)
            assert error_of(body, body.turning(-1.0), law) <= CLOSE


@pytest.mark.parametrize("law", LAWS)
def test_a_cylinder_at_the_borders_of_its_modes(law):
    # All four meet at f = 1/sqrt 3 and 60 degrees (section 4).
    cases = [(gamma, f) for gamma in neighbours(math.pi / 3.0) for f in neighbours(1.0 / math.sqrt(3.0))]
    for gamma in (0.3, 0.7, 1.0):
        cases += [(gamma, f) for f in neighbours(math.tan(gamma) / 3.0)]
        slips = math.tan(gamma)
        cases += [(gamma, f) for f in neighbours(0.5 * (slips - 1.0 / slips)) if f > 0.0]
    for gamma, friction in cases:
        body = cylinder(1.0, gamma, 2.0, friction)
        assert error_of(body, body.turning(-1.0), law) <= CLOSE


@pytest.mark.parametrize("law", LAWS)
def test_normals_that_are_parallel_or_opposed_and_contacts_on_one_line(law):
    up, down, left, right = (0.0, 1.0), (0.0, -1.0), (-1.0, 0.0), (1.0, 0.0)
    places = ((-1.0, -0.5), (1.0, -0.5), (1.0, 0.5), (-1.0, 0.5), (0.0, -0.5), (0.0, 0.0))
    for (first, second), (one, other) in itertools.product(
        itertools.permutations(places, 2), itertools.product((up, down, left, right), repeat=2)
    ):
        body = TwoPointBody(1.0, 0.25, Contact(*first, 0.5, one), Contact(*second, 0.5, other))
        for omega in (1.0, -1.0):
            error_of(body, body.turning(omega), law)


@pytest.mark.parametrize("law", LAWS)
def test_contacts_at_one_place(law):
    for one, other in itertools.permutations(((0.0, 1.0), (-0.6, 0.8), (1.0, 0.0)), 2):
        body = TwoPointBody(1.0, 0.25, Contact(0.5, -0.5, 0.5, one), Contact(0.5, -0.5, 0.25, other))
        for vx, vy in ((1.0, 0.0), (0.5, -0.5), (-1.0, -0.25)):
            error_of(body, Twist(vx, vy, 0.0), law)


SLIM = Contact(-1.6581, -1.4522, 1.8782), Contact(1.2691, -0.7467, 1.8782, (0.1611439001926167, 0.9869309213064064))
STEEP = (
    Contact(-1.32249, -1.18662, 1.485868, (-0.4902482760531686, -0.8715828290110448)),
    Contact(0.777413, -1.267315, 1.485868, (-0.18104933234388387, 0.9834740155478607)),
)
WALL = (
    Contact(-1.24589, -1.965026, 1.54648, (0.8510626071185565, 0.5250642234665828)),
    Contact(1.36201, -0.345366, 1.54648, (-0.9275376406619465, 0.3737297488229558)),
)
slim, steep, wall = (
    TwoPointBody(mass, inertia, *contacts)
    for mass, inertia, contacts in ((0.104, 0.0818, SLIM), (0.16125, 0.083571, STEEP), (0.301185, 0.141184, WALL))
)
ENDLESS = {
    "0.15 times as fast each time": (slim, slim.turning(-0.4767)),
    "0.89 times as fast each time": (steep, steep.turning(-1.0)),
    "while B expands": (wall, Twist(2.478728, -1.527409, -1.243449)),
}
"""Bodies whose old contact jams again and again, found by chance."""


@pytest.mark.parametrize("restitution", [0.0, 0.125, 0.5, 1.0])
@pytest.mark.parametrize("case", ENDLESS)
def test_jams_without_end_are_followed_to_their_limit(case, restitution):
    body, twist = ENDLESS[case]
    body = body._replace(new=body.new._replace(restitution=restitution))
    outcome = solve_impact(body, twist)
    assert outcome.law == "path"
    assert outcome.flags & Flag.JAMMED or (case == "while B expands" and restitution == 0.0)
    assert error_of(body, twist, "path") <= CLOSE


EDGES = (0.0, 5e-324, 1e-310, 2.3e-308, 1e-200, 1e-154, 1e-30, 1e-8, 0.5, 1.0, 3.0, 1e8, 1e30, 1e154, 1e200, 1.7e308)


def test_denormal_and_huge_numbers_give_finite_answers_or_a_flag():
    source = random.Random(3)

    def number():
        return source.choice((-1.0, 1.0)) * (
            source.choice(EDGES) if source.random() < 0.5 else source.uniform(0.0, 2.0)
        )

    def contact():
        angle = source.choice((0.0, 1e-300, 1e-9, 0.5, -1.2, math.pi / 2, math.pi))
        moves = (number(), number()) if source.random() < 0.2 else (0.0, 0.0)
        normal = (-math.sin(angle), math.cos(angle))
        return Contact(number(), number(), abs(number()), normal, source.choice((0.0, 5e-324, 0.5, 1.0)), moves)

    answered = 0
    for _ in range(20_000):
        old = contact() if source.random() < 0.9 else None
        body = TwoPointBody(abs(number()), abs(number()), old, old if old and source.random() < 0.05 else contact())
        twist = body.turning(number()) if old and source.random() < 0.5 else Twist(number(), number(), number())
        for law in LAWS:
            outcome = solve_impact(body, twist, law)
            numbers = (*outcome.twist, *outcome.impulses[0], *outcome.impulses[1], outcome.energy_lost)
            assert all(map(math.isfinite, numbers))
            assert all(math.isfinite(part) for other in outcome.alternatives for part in other.twist)
            if outcome.flags & (Flag.INVALID_INPUT | Flag.NO_SOLUTION):
                assert outcome.mode is Mode.NO_IMPACT
            answered += outcome.mode is not Mode.NO_IMPACT
    assert answered > 2000
