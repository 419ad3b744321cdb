"""Random problems: of every kind, the same for the same seed, and of the kind that their name says."""

import numpy as np
import pytest

from impact_predictor.mechanics.random_problems import KINDS, Draw, problems_of

COUNT = 2000


def numbers(value):
    """All arrays in tuples of tuples."""
    return [part for each in value for part in numbers(each)] if isinstance(value, tuple) else [value]


def arrays(problem):
    return [part for part in numbers((problem.body, problem.twist)) if part is not None]


def normal_velocity(contact, twist):
    vx, vy, omega = twist
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    return nx * (vx - omega * contact.y - ux) + ny * (vy + omega * contact.x - uy)


@pytest.mark.parametrize("kind", KINDS)
def test_a_problem_is_arrays_of_finite_numbers_and_mostly_an_impact(kind):
    problem = problems_of(kind, np.random.default_rng(1), COUNT)
    assert all(each.shape == (COUNT,) and np.isfinite(each).all() for each in arrays(problem))
    assert (problem.body.mass > 0.0).all()
    assert (problem.body.inertia > 0.0).all()
    struck = normal_velocity(problem.body.new, problem.twist) < 0.0
    assert struck.mean() > (0.6 if "apart" in kind else 0.8)
    assert 0.3 < (problem.body.new.restitution == 0.0).mean() < 0.7


def test_kinds_are_what_they_are_called():
    made = {kind: problems_of(kind, np.random.default_rng(1), COUNT) for kind in KINDS}
    assert [kind for kind, each in made.items() if each.body.old is None] == ["one-point"]
    assert (normal_velocity(made["both"].body.old, made["both"].twist) < 0.0).all()
    for edge in (made["cylinder"].body.old, made["cylinder"].body.new):
        along, across = edge.normal  # to the axis
        assert np.stack((edge.x, edge.y)) == pytest.approx(-np.hypot(edge.x, edge.y) * (along, across))
    deck = made["deck"].body
    rise, run = deck.new.y - deck.old.y, deck.new.x - deck.old.x
    stretch = run * (deck.new.velocity[0] - deck.old.velocity[0]) + rise * (deck.new.velocity[1] - deck.old.velocity[1])
    assert abs(stretch).max() < 1e-13
    apart = made["apart"].body
    assert np.ptp(apart.new.velocity[0] - apart.old.velocity[0]) > 3.0
    wide = made["extreme"].body
    for number in (wide.mass, abs(wide.old.x), abs(made["extreme"].twist.omega)):
        number = number[number > 0.0]
        assert np.log10(number.max() / number.min()) > 11.0
    square = np.log10(wide.inertia / wide.mass)  # of the radius of gyration
    assert (square.min(), square.max()) == pytest.approx((-12.0, 12.0), abs=0.1)
    slender = made["slender"].body
    assert slender.new.friction.max() > 5e3


def test_what_is_not_extreme_turns_at_2_rad_per_s_at_most_about_a_support_that_does_not():
    for kind in KINDS.keys() - {"extreme", "extreme-apart", "deck"}:
        omega = abs(problems_of(kind, np.random.default_rng(1), COUNT).twist.omega)
        assert 1.9 < omega.max() <= 2.0


def test_wild_numbers_have_both_signs_over_twelve_decades_and_are_zero_in_a_tenth():
    found = Draw(np.random.default_rng(2), 20_000).wild()
    size = np.log10(np.abs(found[found != 0.0]))
    assert -6.0 <= size.min() < -5.99
    assert 5.99 < size.max() <= 6.0
    assert np.mean(found == 0.0) == pytest.approx(0.1, abs=0.01)
    assert np.mean(found > 0.0) == pytest.approx(0.45, abs=0.02)
