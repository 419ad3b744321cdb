"""Input that no body can have: a flag, never an exception or a number that is not finite."""

import math

import numpy as np
import pytest

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, plate, solve_impact, solve_impacts
from impact_predictor.native import form

GOOD = plate(1.0, 0.4, 10.0, 0.3)
BAD_CONTACTS = [
    {"x": math.nan},
    {"y": math.inf},
    {"friction": -0.1},
    {"friction": math.inf},
    {"friction": math.nan},
    {"normal": (0.0, 2.0)},
    {"normal": (0.0, 0.0)},
    {"normal": (math.nan, 1.0)},
    {"restitution": 2.0},
    {"restitution": -0.1},
    {"restitution": math.nan},
    {"velocity": (0.0, math.inf)},
    {"velocity": (math.nan, 0.0)},
]


def assert_invalid(body, twist):
    for law in ("path", "total"):
        outcome = solve_impact(body, twist, law)
        assert outcome.flags is Flag.INVALID_INPUT
        assert outcome.mode is Mode.NO_IMPACT
        assert all(math.isfinite(part) for part in outcome.twist)
        assert outcome.impulses == ((0.0, 0.0), (0.0, 0.0))


@pytest.mark.parametrize("change", BAD_CONTACTS, ids=str)
def test_a_contact_that_cannot_be_is_answered_with_a_flag(change):
    twist = GOOD.turning(-1.0)
    assert_invalid(GOOD._replace(new=GOOD.new._replace(**change)), twist)
    assert_invalid(GOOD._replace(old=GOOD.old._replace(**change)), twist)
    assert_invalid(GOOD._replace(old=None, new=GOOD.new._replace(**change)), twist)


@pytest.mark.parametrize("name", ["mass", "inertia"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, -math.inf])
def test_a_body_that_cannot_be_is_answered_with_a_flag(name, value):
    assert_invalid(GOOD._replace(**{name: value}), GOOD.turning(-1.0))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["vx", "vy", "omega"])
def test_a_twist_that_cannot_be_is_answered_with_a_flag_and_rest(name, value):
    twist = GOOD.turning(-1.0)._replace(**{name: value})
    assert_invalid(GOOD, twist)
    assert solve_impact(GOOD, twist).twist == (0.0, 0.0, 0.0)


def test_an_unknown_law_is_refused_with_one_sentence():
    with pytest.raises(ValueError, match=r"^law is 'newton'; use 'path' or 'total'$"):
        solve_impact(GOOD, GOOD.turning(-1.0), "newton")


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("far", [1e101, 1e155, -1e300])
def test_a_contact_further_away_than_products_are_numbers_is_refused(law, far):
    body = TwoPointBody(mass=1.0, inertia=1.0, old=Contact(-1.0, -1.0, 0.3), new=Contact(far, -1.0, 0.3))
    twist = Twist(0.0, -1.0, -1.0)
    assert solve_impact(body, twist, law=law).flags == Flag.INVALID_INPUT
    assert solve_impacts(body, twist, law=law).flags == Flag.INVALID_INPUT
    near = body._replace(new=Contact(math.copysign(1e99, far), -1.0, 0.3))
    assert not solve_impact(near, twist, law=law).flags & Flag.INVALID_INPUT


@pytest.mark.parametrize(("wrong", "error"), [(None, TypeError), ("1", TypeError), (10**400, OverflowError)])
def test_what_is_no_number_raises_alike_for_one_impact_and_for_many(wrong, error):
    body = TwoPointBody(mass=1.0, inertia=1.0, old=Contact(-1.0, -1.0, 0.3), new=Contact(1.0, -1.0, 0.3))
    for changed, twist in ((body._replace(mass=wrong), (0.0, 0.0, -1.0)), (body, (0.0, 0.0, wrong))):
        # Compiled, the law of one impact calls an integer beyond all doubles no float.
        of_one = TypeError if form() == "compiled" else error
        for solve, raised in ((solve_impact, of_one), (solve_impacts, error)):
            with pytest.raises(raised):
                solve(changed, Twist(*twist))


@pytest.mark.parametrize(
    ("body", "twist"),
    [(plate(length=np.ones(3), height=1.0, mass=1.0, friction=0.3), (0.0, 0.0, -1.0)), (GOOD, (1.0, 2.0))],
    ids=["arrays", "two numbers"],
)
def test_what_is_not_one_impact_is_told_where_to_go(body, twist):
    with pytest.raises(TypeError, match=r"^solve_impact takes numbers, and `solve_impacts` arrays of them: "):
        solve_impact(body, twist)
