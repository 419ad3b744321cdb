"""The compass gait, two legs with a hinge at the hip: its impact in contact space and its momenta.

Sources: M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, The simplest walking model: stability, complexity, and scaling,
J. Biomechanical Engineering 120(2), 1998; the digits are those of the authors' program for it, "to 1e-10". And
A. Goswami, B. Thuilot, B. Espiau, A study of the passive gait of a compass-like biped robot: symmetry and chaos (1998),
section 2.3: a foot that strikes sticks while the other lifts, so that the impact keeps the angular momentum of the
machine about the striking foot and that of the trailing leg about the hip.
"""

import math

import numpy as np
import pytest
from compass import Compass, after_impact, step, strike
from scipy.optimize import root

from impact_predictor import Mode

LAWS = ("path", "total")


def point_mass_map(compass, half_angle):
    """Q+^-1 Q- of the paper, whose legs are point masses: rates (swing, stance) before to those after the impact.

    `half_angle` is half the angle between the legs. After the impact the legs have changed their roles.
    """
    beta, mu = compass.to_hip / compass.to_foot, compass.hip_mass / compass.leg_mass
    cos = math.cos(2.0 * half_angle)
    before = [[-beta, -beta + (mu * (1 + beta) ** 2 + 2 * (1 + beta)) * cos], [0.0, -beta]]
    after = [
        [beta * (beta - (1 + beta) * cos), (1 + beta) * (1 + beta - beta * cos) + 1 + mu * (1 + beta) ** 2],
        [beta**2, -beta * (1 + beta) * cos],
    ]
    return np.linalg.solve(after, before)


def random_compasses(count, seed):
    """Compasses, half the angle between their legs, and the rates (old leg, new leg) of a passive gait."""
    source = np.random.default_rng(seed)
    for _ in range(count):
        hip, leg, low, high, inertia = source.uniform((1.0, 0.5, 0.2, 0.2, 0.0), (40.0, 10.0, 0.8, 0.8, 0.2)).tolist()
        # Both legs turn forward, the swing leg slower or faster.
        rates = source.uniform(0.5, 2.0), source.uniform(-0.5, 2.0)
        yield Compass(hip, leg, low, high, leg_inertia=inertia), source.uniform(0.1, 0.4), rates


def test_the_momenta_of_the_closed_form_are_those_of_goswami():
    for compass, half_angle, (old, new) in random_compasses(50, seed=1):
        points = compass._replace(leg_inertia=0.0)
        swing, stance = point_mass_map(points, half_angle) @ (new, old)
        found = after_impact(points, (half_angle, -half_angle), (old, new))
        assert found == pytest.approx((stance, swing), abs=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_a_compass_gait_by_hand_in_contact_space_follows_the_closed_form(law):
    pivots = 0
    for compass, half_angle, rates in random_compasses(300, seed=2):
        angles = half_angle, -half_angle
        if closing(compass, half_angle, rates) > -0.05:
            continue  # the swing leg does not strike
        outcome, after = strike(compass, angles, rates, 5.0, law)
        if outcome.mode is not Mode.PIVOT or outcome.impulses[0][0] != 0.0:
            continue
        assert after == pytest.approx(after_impact(compass, angles, rates), abs=1e-10)  # the accuracy that is promised
        pivots += 1
    assert pivots > 100


def closing(compass, half_angle, rates):
    """How fast the new foot rises, in m/s."""
    return -compass.leg * math.sin(half_angle) * sum(rates)


SIMPLEST = Compass(hip_mass=1.0, leg_mass=1e-15, to_foot=0.0, to_hip=1.0, slope=0.009, gravity=1.0)
"""Its feet have hardly any mass: what is left of them is below rounding."""

LONG, SHORT = (0.20031090049483, 0.19983247291764), (0.19393736960624, 0.20386692731962)
"""Angle and rate of the standing leg right after an impact, of the published long and short steps of that slope."""


def steady(compass, law, angle, rate):
    """The steady gait near one of the simplest walker, whose impact gives the old leg cos(2 angle) times its rate."""
    near = np.array([angle, rate, rate * math.cos(2.0 * angle)])
    return root(lambda gait: step(compass, gait, law) - gait, near, tol=1e-13).x


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("published", "error"), [(LONG, 1e-10), (SHORT, 3e-10)])
def test_the_steady_gaits_of_light_feet_come_to_the_published_ones_of_the_simplest_walker(published, error, law):
    # W is known to 1e-15 / mass, so the gait without foot mass is the limit of the parabolas through three masses.
    # The short gait multiplies errors by 4 with each step, so that its published digits are less sure, too.
    masses = np.array([1e-4, 2e-4, 4e-4])
    gaits = [steady(SIMPLEST._replace(leg_mass=mass), law, *published) for mass in masses]
    found = np.linalg.solve(np.vander(masses, increasing=True), gaits)[0]
    assert found[:2] == pytest.approx(published, abs=error)


def test_the_long_steps_are_stable_and_the_short_ones_are_not():
    light = SIMPLEST._replace(leg_mass=1e-5)
    # The authors' program: 4.000 and 0.459; the paper: one of the two gaits is stable for slopes up to 0.015.
    for published, multipliers in ((LONG, [0.5891, 0.5891, 0.0]), (SHORT, [4.0, 0.459, 0.0])):
        gait = steady(light, "path", *published)
        nudges = 1e-5 * np.eye(3)
        change = [(step(light, gait + one, "path") - step(light, gait - one, "path")) / 2e-5 for one in nudges]
        assert sorted(np.abs(np.linalg.eigvals(change)), reverse=True) == pytest.approx(multipliers, abs=5e-3)


STEADY = Compass(slope=math.radians(3.0))
ANGLES = 0.2710286804988206, -0.2710286804988206
RATES = 1.4942048971003643, 1.8056788689878236
"""Angles and rates of its legs right before the impact of the steady gait down that slope."""


@pytest.mark.parametrize("share", [1e-12, 1e-3, 0.1, 1.0])
def test_the_impact_of_feet_with_mass_is_the_published_one(share):
    # The authors' program: the standing leg's rate becomes math.cos(2 theta) / (1 + beta sin^2(2 theta)) of it.
    compass = SIMPLEST._replace(leg_mass=share)
    stance, _ = after_impact(compass, (0.2, -0.2), (0.25, 0.1))
    assert stance == pytest.approx(0.25 * math.cos(0.4) / (1.0 + share * math.sin(0.4) ** 2), rel=1e-13)


def test_its_impact_by_the_total_law_is_that_of_the_momenta_where_friction_holds_the_new_foot():
    for friction in (0.3, 0.5, 1.0):
        outcome, rates = strike(STEADY, ANGLES, RATES, friction, law="total")
        assert outcome.mode is Mode.PIVOT
        assert rates == pytest.approx(after_impact(STEADY, ANGLES, RATES), abs=1e-13)
    (_, _), (normal, tangential) = outcome.impulses
    least = abs(tangential) / normal
    assert strike(STEADY, ANGLES, RATES, least * 0.999)[0].mode is Mode.PIVOT_SLIDE


def test_along_the_impulse_path_the_old_foot_of_heavy_legs_is_pressed_a_little_before_it_leaves():
    # The published impact takes the old foot to leave at once: an assumption that the growing impulse does not share.
    outcome, rates = strike(STEADY, ANGLES, RATES, 1.0, law="path")
    known = after_impact(STEADY, ANGLES, RATES)
    assert outcome.mode is Mode.PIVOT
    assert 0.0 < outcome.impulses[0][0] < 0.01 * outcome.impulses[1][0]
    assert 1e-3 < rates[0] / known[0] - 1.0 < 1e-2
