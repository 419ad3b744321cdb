"""How far an impact is from another mode, against the closed forms' borders and against the law itself."""

import subprocess
import sys
from itertools import pairwise
from math import inf, isfinite, nan, sqrt

import numpy as np
import pytest
from alone import random_impacts

from impact_predictor import Contact, Mode, Twist, TwoPointBody, cylinder, plate, rod, solve_impact
from impact_predictor.mechanics import margins as module
from impact_predictor.mechanics.closed_forms import cylindrical, flat
from impact_predictor.mechanics.margins import BEYOND, NO_MARGIN, NO_MARGINS, Margin, margins
from impact_predictor.mechanics.random_problems import KINDS

EXACT = 1e-9
"""The borders are rational in what changes; a velocity that vanishes there has rounding of 1e-15 and a slope."""

LAWS = ("path", "total")


def ways_of(monkeypatch, body, twist, law):
    """The margins, each with its way and the unchanged impact."""
    found = []
    nearest_border = module.nearest_border

    def keeping(way, here):
        margin = nearest_border(way, here)
        found.append((way, here, margin))
        return margin

    with monkeypatch.context() as patch:
        patch.setattr(module, "nearest_border", keeping)
        margins(body, twist, law)
    return found


def flat_borders(shape):
    """Frictions at which the mode of a body on a floor changes."""
    return [float(of(shape)) for of in (flat.stop_friction, flat.lift_friction, flat.pivot_friction)]


def cylinder_borders(t):
    return [float(of(t)) for of in (cylindrical.stop_friction, cylindrical.lift_friction, cylindrical.pivot_friction)]


def friction_cases():
    """Bodies with the friction borders of the closed forms."""
    source = np.random.default_rng(11)
    for _ in range(60):
        height, friction = source.uniform(0.05, 3.0), source.uniform(0.0, 1.2)
        body = plate(length=1.0, height=height, mass=10.0, friction=friction)
        yield body, flat_borders(flat.rectangle(height))
        length, thickness = 0.4, source.uniform(0.0, 0.1)
        a, b = source.uniform(0.02, 0.2, 2)
        body = rod(length, thickness, a, b, mass=0.3, friction=friction)
        yield body, flat_borders(flat.bar(length, thickness, a, b))
        gamma = source.uniform(0.1, 1.45)
        body = cylinder(radius=0.3, gamma=gamma, mass=2.0, friction=friction)
        yield body, cylinder_borders(np.tan(gamma))


def test_the_friction_margin_is_the_distance_to_the_closed_form_border():
    compared = 0
    for body, borders in friction_cases():
        friction = body.new.friction
        distances = [border - friction for border in borders if abs(border - friction) < 2.0]
        margin = margins(body, body.turning(-1.0)).friction
        if not distances:
            assert margin == Margin(inf, None)
            continue
        assert abs(margin.change) == pytest.approx(min(map(abs, distances)), abs=EXACT)
        assert min(abs(margin.change - distance) for distance in distances) < EXACT
        compared += 1
    assert compared > 120


def test_the_mode_beyond_a_friction_border_is_that_of_the_closed_form():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.3)
    margin = margins(body, body.turning(-1.0)).friction
    assert margin == (pytest.approx(0.1, abs=EXACT), Mode.STOP)
    body = plate(length=1.0, height=1.0, mass=10.0, friction=0.5)
    margin = margins(body, body.turning(-1.0)).friction
    assert margin == (pytest.approx(0.1, abs=EXACT), Mode.PIVOT)  # 3 delta / (4 delta^2 + 1) = 0.6
    body = plate(length=1.0, height=1.0, mass=10.0, friction=0.4)
    margin = margins(body, body.turning(-1.0)).friction
    assert margin == (pytest.approx(-1.0 / 15.0, abs=EXACT), Mode.SLIDE)  # (2 - delta^2) / (3 delta) = 1/3


def test_frictions_that_differ_change_together_and_stop_at_zero():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.5)
    body = body._replace(old=body.old._replace(friction=0.0))
    margin = margins(body, body.turning(-1.0)).friction
    edge = body._replace(
        old=body.old._replace(friction=max(0.0, margin.change)), new=body.new._replace(friction=0.5 + margin.change)
    )
    assert abs(margin.change) > 0.01
    # On the border the slip that is left is rounding.
    assert abs(solve_impact(edge, edge.turning(-1.0)).twist.vx) < EXACT


def test_a_plate_that_stops_stands_as_far_from_pivoting_as_its_mass_centre_may_shift():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=5.0)
    a = b = 0.5
    h, rho2 = 0.2, body.inertia / body.mass
    found = margins(body, body.turning(-1.0))
    # ab = rho^2 + h^2 at the border, with each of a and b, h, and b alone changed
    shift = sqrt(a * b - rho2 - h * h)
    assert abs(found.center.change) == pytest.approx(shift, abs=EXACT)
    assert found.height == (pytest.approx(sqrt(a * b - rho2) - h, abs=EXACT), Mode.PIVOT)
    assert found.reach == (pytest.approx((rho2 + h * h) / a - b, abs=EXACT), Mode.PIVOT)


def test_a_mass_centre_on_the_line_of_the_contacts_does_not_shift_into_the_support():
    body = TwoPointBody(1.0, 0.24, Contact(-0.5, 0.0, 0.1), Contact(0.5, 0.0, 0.1))
    found = margins(body, body.turning(-1.0)._replace(vx=-0.3)).height
    below = body._replace(old=Contact(-0.5, 0.21, 0.1), new=Contact(0.5, 0.21, 0.1))
    here, there = (solve_impact(one, one.turning(-1.0)._replace(vx=-0.3)).mode for one in (body, below))
    assert here is not there  # a border that is nearer
    assert found.change > 0.21


def test_a_ball_that_grips_slips_from_the_speed_at_which_friction_cannot_stop_it():
    friction, k = 0.3, 0.4
    body = TwoPointBody(2.0, k * 2.0 * 0.01, None, Contact(0.0, -0.1, friction))
    slip = margins(body, Twist(0.5, -1.0, 0.0)).slip
    # T = m c_t k / (1 + k) stops the slip, and N = m.
    assert slip == (pytest.approx(friction * (1.0 + k) / k - 0.5, abs=EXACT), Mode.PIVOT_SLIDE)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", ["plate", "cylinder", "floor", "wedge", "tilted", "deck", "one-point"])
def test_the_mode_is_the_same_before_a_border_and_another_behind_it(kind, law, monkeypatch):
    for body, twist in random_impacts(kind, 15, seed=3):
        for way, here, margin in ways_of(monkeypatch, body, twist, law):
            if margin.mode is None:
                continue
            step = BEYOND * way.unit * (1.0 if margin.change > 0.0 else -1.0)
            assert way.at(margin.change + step).mode == margin.mode != here.mode
            if abs(margin.change) > abs(step):
                assert way.at(margin.change - step).mode == here.mode


@pytest.mark.parametrize("kind", ["plate", "cylinder", "floor", "wedge", "one-point"])
def test_no_mode_that_holds_for_long_lies_nearer_than_the_border(kind, monkeypatch):
    for body, twist in random_impacts(kind, 10, seed=5):
        for way, here, margin in ways_of(monkeypatch, body, twist, "path"):
            for side in (1.0, -1.0):
                end = min(abs(margin.change), 2.0 * way.unit)
                changes = [side * end * k / 100.0 for k in range(100) if side * end * k / 100.0 >= way.least]
                other = [change for change in changes if way.at(change).mode != here.mode]
                # the longest run of other modes, by neighbours in the list of changes
                run = longest = 0.0
                for one, two in pairwise(other):
                    run = run + abs(two - one) if abs(two - one) < 1.5 * end / 100.0 else 0.0
                    longest = max(longest, run)
                assert longest <= max(way.unit / 32.0, 0.5 * end)


def test_a_narrow_mode_is_found_where_the_contact_states_beyond_it_differ():
    """A rod that slips: at hardly any other speed than that at which it sticks does it pivot without slip."""
    body = rod(length=0.4, thickness=0.004, a=0.108, b=0.09, mass=1.0, friction=0.6)
    twist = body.turning(-1.0)
    twist = twist._replace(vx=twist.vx + 0.79)
    margin = margins(body, twist).slip
    assert margin.mode is Mode.PIVOT

    def mode(change):
        return solve_impact(body, twist._replace(vx=twist.vx + change)).mode

    here = mode(0.0)
    assert mode(margin.change + 1e-6) is here
    assert mode(margin.change - 1e-6) is Mode.PIVOT
    assert mode(margin.change - 0.2) is here


def test_an_impact_on_a_border_has_no_room():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.4)
    margin = margins(body, body.turning(-1.0)).friction
    assert solve_impact(body, body.turning(-1.0)).mode == Mode.STOP
    assert margin == (pytest.approx(0.0, abs=EXACT), Mode.SLIDE)


def test_without_an_impact_there_are_no_margins():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.4)
    assert margins(body, body.turning(1.0)) == NO_MARGINS
    assert margins(body, Twist(nan, 0.0, 0.0)) == NO_MARGINS
    assert margins(body._replace(mass=-1.0), body.turning(-1.0)) == NO_MARGINS
    with pytest.raises(ValueError, match="law is"):
        margins(body, body.turning(-1.0), "laws")


def test_a_point_mass_grips_with_more_friction_or_less_slip_and_has_no_other_margins():
    # It slips by 1 m/s and arrives with 1 m/s: friction 0.5 stops half of the slip.
    body = TwoPointBody(2.0, 3.0, None, Contact(0.0, 0.0, friction=0.5))
    found = margins(body, Twist(1.0, -1.0, 0.0))
    assert found.friction.change == pytest.approx(0.5, abs=EXACT)
    assert found.slip.change == pytest.approx(-0.5, abs=EXACT)
    assert found.friction.mode is found.slip.mode is Mode.PIVOT
    assert (found.center, found.height, found.reach) == (NO_MARGIN, NO_MARGIN, NO_MARGIN)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_margins_are_numbers_whatever_the_impact(kind, law):
    for body, twist in random_impacts(kind, 10, seed=9):
        for margin in margins(body, twist, law):
            assert isfinite(margin.change) == (margin.mode is not None)
            assert margin.change == inf or margin.mode is not None


def test_an_outcome_tells_its_margins_when_it_is_asked():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    for law in LAWS:
        assert solve_impact(body, body.turning(-1.0), law).margins == margins(body, body.turning(-1.0), law)
    struck = body.turning(-1.0)._replace(vy=-1.0)  # both contacts: the total law answers for the path law
    assert solve_impact(body, struck).margins == margins(body, struck)


def test_an_outcome_loads_nothing_for_margins_that_nobody_asks_for():
    code = (
        "import sys; from impact_predictor import plate, solve_impact; body = plate(1.0, 0.4, 10.0, 0.2)\n"
        "outcome = solve_impact(body, body.turning(-1.0)); print('impact_predictor.mechanics.margins' in sys.modules)\n"
        "outcome.margins; print('numpy' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert said.split() == ["False", "False"]
