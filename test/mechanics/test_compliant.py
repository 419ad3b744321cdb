"""Impacts on compliant contacts: the contact's own physics, what converges with stiffness, and to which rigid law."""

import math
import random
from itertools import pairwise

import numpy as np
import pytest

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, cylinder, plate, solve_impact
from impact_predictor.mechanics import closed_forms
from impact_predictor.mechanics.compliant.equations import Equations, Point, loaded
from impact_predictor.mechanics.compliant.force import (
    PLASTIC,
    Compliance,
    damping_ratio,
    force,
    restitution_of,
    slopes,
)
from impact_predictor.mechanics.compliant.impact import compliant_impact
from impact_predictor.mechanics.compliant.integrator import METHODS, Status

FIRM = (50.0, 50.0)
"""Damping ratios of contacts that rebound by a ten-thousandth."""

REBOUND = 5e-3
"""Of V: a plastic contact rebounds by PLASTIC, and through friction and the other contact by a few times as much."""

SLIPS = plate(1.0, 0.6, 10.0, 0.5), Twist(0.1, -0.5, -1.0)
"""Slips backwards on A at 0.2 m/s while it turns: the path law lets the slip reverse, the total law stops it."""


def velocities(body, twist):
    found = []
    for contact in (body.old, body.new):
        if contact is not None:
            (nx, ny), (ux, uy) = contact.normal, contact.velocity
            cx, cy = twist[0] - twist[2] * contact.y - ux, twist[1] + twist[2] * contact.x - uy
            found += [nx * cx + ny * cy, ny * cx - nx * cy]
    return np.array(found)


def difference(body, one, other, before):
    """The largest difference of a contact velocity over the sum of the contact speeds before."""
    return np.abs(velocities(body, one) - velocities(body, other)).max() / np.abs(velocities(body, before)).sum()


def springy(body, old, new):
    return body._replace(old=body.old._replace(restitution=old), new=body.new._replace(restitution=new))


def test_a_contact_never_pulls_and_its_friction_stays_in_the_cone():
    contact, source = Compliance(100.0, 3.0, 0.4, 1e-3), random.Random(1)
    for _ in range(1000):
        gap, rate, slip = source.uniform(-1.0, 0.5), source.uniform(-50.0, 50.0), source.uniform(-0.01, 0.01)
        normal, tangential = force(contact, gap, rate, slip)
        assert normal >= 0.0
        assert abs(tangential) <= 0.4 * normal
        assert tangential * slip <= 0.0
        if gap > 0.0:
            assert normal == 0.0


def test_slopes_are_the_derivatives_of_the_force():
    contact, step = Compliance(100.0, 3.0, 0.4, 0.1), 1e-6
    for gap, rate, slip in ((-0.5, 0.3, 0.05), (-0.2, -1.0, -0.3), (0.1, -1.0, 0.2), (-0.01, 5.0, 0.2)):
        by = slopes(contact, gap, rate, slip)
        expected = ((by.gap, by.tangential * by.gap), (by.rate, by.tangential * by.rate), (0.0, by.slip))
        for i, pair in enumerate(expected):
            ahead, behind = [gap, rate, slip], [gap, rate, slip]
            ahead[i] += step
            behind[i] -= step
            change = np.subtract(force(contact, *ahead), force(contact, *behind)) / (2.0 * step)
            assert change == pytest.approx(pair, abs=1e-6)  # central differences: step**2 and roundings / step


def test_the_jacobian_is_the_derivative_of_the_right_hand_side():
    points = (
        Point((-0.8, -0.5), (0.0, 1.0), (0.1, 0.0), Compliance(2.0, 0.5, 0.4, 0.3)),
        Point((0.9, -0.4), (-0.6, 0.8), (0.0, 0.2), Compliance(1.0, 0.8, 0.7, 0.3)),
    )
    equations, step = Equations(points, 0.3, (0.0, -0.1)), 1e-6
    state = np.array([0.1, -0.3, -0.2, 0.3, -0.4, -0.5, 0.0, 0.0, 0.0, 0.0])
    assert all(gap < 0.0 for gap, *_ in equations.contacts(0.2, state))
    exact = equations.jacobian(0.2, state)
    for i in range(6):
        ahead, behind = state.copy(), state.copy()
        ahead[i] += step
        behind[i] -= step
        change = np.subtract(equations.rates(0.2, ahead), equations.rates(0.2, behind)) / (2.0 * step)
        assert change == pytest.approx(exact[:, i], abs=1e-8)


def test_damping_gives_the_wanted_restitution():
    for wanted in (1.0, 0.8, 0.5, math.exp(-2.0), 0.1, 0.01, PLASTIC):
        assert restitution_of(damping_ratio(wanted)) == pytest.approx(wanted, rel=1e-9)
    assert damping_ratio(math.exp(-2.0)) == pytest.approx(1.0, rel=1e-9)
    assert restitution_of(50.0) == pytest.approx(1.0 / (4.0 * 50.0**2), rel=0.01)  # the first term for large ratios
    assert damping_ratio(0.0) == damping_ratio(PLASTIC)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.7, 1.0])
def test_a_one_point_impact_has_the_wanted_restitution(restitution):
    contact = Contact(0.7, -0.4, 0.0, (-0.6, 0.8), restitution, (0.3, -0.1))
    body, twist = TwoPointBody(3.0, 0.5, None, contact), Twist(0.2, -1.5, 0.4)
    outcome = compliant_impact(body, twist, math.inf)
    before = velocities(body, twist)
    assert outcome.status is Status.OVER
    assert outcome.mode is (Mode.PIVOT_SLIDE if restitution == 0.0 else Mode.FLIGHT)
    # QUIET, where the force counts as gone, is a millionth.
    assert outcome.velocities[2] == pytest.approx(-max(restitution, PLASTIC) * before[0], rel=1e-3)
    assert outcome.impulses[1][1] == 0.0
    assert outcome.velocities[0] == math.inf


@pytest.mark.parametrize("method", METHODS)
def test_every_integrator_gives_the_same_impact(method):
    body, twist = SLIPS
    exact = compliant_impact(body, twist, 1e8, method="Radau", tolerance=1e-10)
    outcome = compliant_impact(body, twist, 1e8, method=method)
    assert outcome.status is Status.OVER
    assert difference(body, outcome.twist, exact.twist, twist) < 1e-6  # a hundred steps with errors of 1e-8
    assert outcome.evaluations > 100


def test_only_the_depth_counts_of_stiffness_mass_and_speed():
    body, twist = SLIPS
    one = compliant_impact(body, twist, 1e5)
    # V sqrt(m / k) / rho is the same: no number of the equations changes but by rounding.
    heavy = body._replace(mass=4.0 * body.mass, inertia=4.0 * body.inertia)
    other = compliant_impact(heavy, Twist(*(2.0 * part for part in twist)), 16e5)
    assert [0.5 * part for part in other.twist] == pytest.approx(one.twist, abs=1e-10)
    assert other.duration == pytest.approx(0.5 * one.duration, rel=1e-9)
    assert other.evaluations == one.evaluations
    assert other.energy_lost == pytest.approx(16.0 * one.energy_lost, rel=1e-9)


@pytest.mark.parametrize(("gravity", "tolerance"), [((0.0, 0.0), 0.02), ((0.0, -9.81), 0.3)])
def test_the_state_after_converges_to_its_limit_with_the_root_of_the_stiffness(gravity, tolerance):
    body = plate(1.0, 1.0, 10.0, 0.5)
    twist = body.turning(-1.0)
    limit = compliant_impact(body, twist, math.inf, tolerance=1e-11)
    errors = [
        difference(body, compliant_impact(body, twist, k, gravity=gravity, tolerance=1e-11).twist, limit.twist, twist)
        for k in (1e8, 1e10, 1e12)
    ]
    # With gravity the time in which the forces fall to the weight has a logarithm of it.
    for error, next_error in pairwise(errors):
        assert error / next_error == pytest.approx(10.0, rel=tolerance)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.25, 0.4, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("height", [0.4, 1.0, 2.0])
def test_plastic_contacts_give_the_closed_forms_of_a_plate_at_any_ratio(height, friction):
    body = plate(1.0, height, 10.0, friction)
    twist = body.turning(-1.0)
    exact = closed_forms.plate(1.0, height, 10.0, friction, omega=-1.0)
    for ratio in (0.01, 100.0):
        outcome = compliant_impact(body, twist, math.inf, ratio=ratio, damping=FIRM)
        assert difference(body, outcome.twist, exact.twist, twist) < 0.1 * REBOUND


def test_the_limit_keeps_momentum_and_loses_energy():
    for seed in range(5):
        source = random.Random(seed)
        old = Contact(-source.uniform(0.2, 1.0), -0.5, 0.6)
        new = Contact(source.uniform(0.2, 1.0), -source.uniform(0.0, 0.5), 0.6, (-0.6, 0.8), source.random())
        body, before = TwoPointBody(2.0, 0.7, old, new), Twist(-0.1, -0.2, -1.0)
        outcome = compliant_impact(body, before, math.inf, trajectory=True)
        px = py = moment = 0.0
        for contact, (normal, tangential) in zip((old, new), outcome.impulses, strict=True):
            (nx, ny), x, y = contact.normal, contact.x, contact.y
            fx, fy = normal * nx + tangential * ny, normal * ny - tangential * nx
            px, py, moment = px + fx, py + fy, moment + x * fy - y * fx
        change = [2.0 * (outcome.twist.vx - before.vx), 2.0 * (outcome.twist.vy - before.vy)]
        assert [px, py] == pytest.approx(change, abs=1e-9)
        assert moment == pytest.approx(0.7 * (outcome.twist.omega - before.omega), abs=1e-9)
        twists, gaps = outcome.trajectory.twist, outcome.trajectory.gap
        energy = twists[:, 0] ** 2 + twists[:, 1] ** 2 + 0.35 * twists[:, 2] ** 2
        speed = np.abs(velocities(body, before)).sum()
        # Both springs have the stiffness 1 in units in which a gap is one of V sqrt(m / k).
        energy += speed**2 * (np.minimum(gaps, 0.0) ** 2).sum(axis=1)
        assert np.diff(energy).max() < 1e-6 * energy[0]
        kinetic = [2.0 * (t.vx**2 + t.vy**2) / 2.0 + 0.7 * t.omega**2 / 2.0 for t in (before, outcome.twist)]
        assert outcome.energy_lost == pytest.approx(kinetic[0] - kinetic[1], abs=1e-9)


def test_a_support_that_moves_as_one_carries_the_impact_with_it():
    body, twist = SLIPS
    carried = TwoPointBody(
        body.mass, body.inertia, *(contact._replace(velocity=(3.0, -2.0)) for contact in (body.old, body.new))
    )
    one = compliant_impact(body, twist, 1e6)
    other = compliant_impact(carried, twist._replace(vx=twist.vx + 3.0, vy=twist.vy - 2.0), 1e6)
    # The integrator's tolerance of 1e-8 is relative to velocities that are larger now.
    assert other.velocities == pytest.approx(one.velocities, abs=1e-6)


def test_a_stiff_old_contact_leads_to_the_path_law():
    body, twist = SLIPS
    path = solve_impact(body, twist)
    errors = [
        difference(body, compliant_impact(body, twist, math.inf, ratio=ratio, damping=FIRM).twist, path.twist, twist)
        for ratio in (1.0, 1e2, 1e4)
    ]
    assert path.mode is Mode.SLIDE
    # Like the root of the ratio: it is that of two dampers, which are proportional to the roots of the stiffnesses.
    assert errors[0] > 0.02
    assert errors[2] < 0.1 * errors[1] < 0.1 * errors[0]


def test_equal_contacts_do_not_lead_to_the_path_law_however_stiff_they_are():
    body, twist = SLIPS
    path, total = solve_impact(body, twist), solve_impact(body, twist, "total")
    for k in (1e4, 1e8, 1e12, math.inf):
        outcome = compliant_impact(body, twist, k)
        assert outcome.mode is total.mode is Mode.STOP
        assert difference(body, outcome.twist, path.twist, twist) > 0.02
        assert difference(body, outcome.twist, total.twist, twist) < REBOUND


def test_an_old_contact_that_opens_and_closes_again_keeps_every_ratio_from_the_path_law():
    # The path law closes A when its velocity is back at zero; but its gap is open then, and B has done with the impact
    # before A is met.
    normal = math.cos(1.012), math.sin(1.012)
    body = TwoPointBody(1.0, 1.77, Contact(-0.79, -0.87, 2.8), Contact(0.034, -0.363, 2.8, (-normal[1], normal[0])))
    twist = Twist(0.935, 1.337, 1.173)
    path = solve_impact(body, twist)
    assert path.segments == ("O+", "++")
    for ratio in (1e4, 1e8):
        outcome = compliant_impact(body, twist, math.inf, ratio=ratio, damping=FIRM)
        assert outcome.mode is not path.mode
        assert difference(body, outcome.twist, path.twist, twist) > 0.04


def test_a_springy_old_contact_rebounds_which_the_path_law_leaves_out():
    body = plate(1.0, 0.4, 10.0, 0.5)
    twist = body.turning(-1.0)
    assert compliant_impact(body, twist, math.inf).mode is Mode.STOP
    able = springy(body, 0.5, 0.0)
    assert solve_impact(able, twist).mode is Mode.STOP
    outcome = compliant_impact(able, twist, math.inf)
    assert outcome.mode is Mode.PIVOT
    assert outcome.velocities[0] > 0.1
    # If it is stiff it only follows the load of the new one and rebounds no more.
    assert compliant_impact(springy(body, 0.5, 0.5), twist, math.inf).mode is Mode.FLIGHT
    assert compliant_impact(springy(body, 0.5, 0.5), twist, math.inf, ratio=1e3).mode is Mode.BACK_PIVOT


def test_an_undamped_spring_returns_all_its_work_whatever_poisson_says():
    body = TwoPointBody(5.0, 9.0, None, Contact(1.84, -0.58, 1.34, restitution=1.0))
    twist = Twist(-0.86, -0.71, -0.79)
    path = solve_impact(body, twist)
    assert not path.flags & Flag.WORK_LIMITED
    outcome = compliant_impact(body, twist, math.inf, trajectory=True)
    assert difference(body, outcome.twist, path.twist, twist) > 0.05
    # The work of the normal force over the impact is zero: Stronge's restitution of energy is 1.
    gaps, forces = outcome.trajectory.gap[:, 0], outcome.trajectory.force[:, 0, 0]
    stored = -np.trapezoid(forces, gaps)
    assert abs(stored) < 1e-3 * np.abs(forces).max() * np.abs(gaps).max()
    assert outcome.impulses[1][0] > 1.02 * path.impulses[1][0]


def test_a_jam_is_a_tangential_impact_of_a_stiff_old_contact():
    body, twist = plate(1.0, 2.0, 10.0, 2.0), Twist(-1.2, -0.5, -1.0)
    path = solve_impact(body, twist)
    assert path.flags & Flag.JAMMED
    outcome = compliant_impact(body, twist, math.inf, ratio=1e6)
    assert outcome.mode is path.mode is Mode.BACK_PIVOT
    assert difference(body, outcome.twist, path.twist, twist) < 2e-3


@pytest.mark.parametrize("ratio", [0.01, 1.0, 100.0])
def test_a_cylinder_that_might_lock_in_its_wedge_rolls_out_of_it(ratio):
    body = cylinder(0.5, math.radians(40.0), 10.0, 1.5)
    twist = body.turning(-1.0)
    assert {one.mode for one in solve_impact(body, twist, "total").alternatives} == {Mode.STOP}
    outcome = compliant_impact(body, twist, math.inf, ratio=ratio)
    assert outcome.mode is Mode.PIVOT
    assert difference(body, outcome.twist, solve_impact(body, twist).twist, twist) < REBOUND


def test_a_slow_impact_under_gravity_does_not_turn_the_body_over():
    body = plate(1.0, 1.0, 10.0, 0.8)
    assert compliant_impact(body, body.turning(-1.0), 1e6, gravity=(0.0, -9.81)).mode is Mode.PIVOT
    slow = compliant_impact(body, body.turning(-0.01), 1e6, gravity=(0.0, -9.81))
    assert slow.mode is Mode.STOP
    assert slow.status is Status.OVER
    assert solve_impact(body, body.turning(-0.01)).mode is Mode.PIVOT


@pytest.mark.parametrize(("slip", "friction"), [(0.0, 2.0), (0.0, 0.1), (-0.3, 0.4)])
def test_a_loaded_old_contact_neither_lifts_nor_sinks_before_the_impact(slip, friction):
    old = Point((-0.8, -0.5), (0.0, 1.0), (0.0, 0.0), Compliance(2.0, 0.5, friction, 1e-6))
    state = np.array([0.0, 0.0, 0.0, 0.5 + slip, -0.8, -1.0, 0.0, 0.0])
    equations = loaded(Equations((old,), 0.02, (0.0, -0.3)), state)
    _, _, _, ax, ay, aq, normal, tangential = equations.rates(0.0, state)
    assert normal > 0.0
    assert equations.points[0].gap == pytest.approx(-normal / 2.0)
    # Where it sticks friction needs the slip of a creep, which comes at once.
    if abs(tangential) == pytest.approx(friction * normal, rel=1e-9):
        assert ay + aq * -0.8 + 0.02 * 0.5 == pytest.approx(0.0, abs=1e-12)
    for gravity in ((0.0, -9.81), (3.0, -9.81)):
        body = plate(1.0, 0.4, 10.0, 0.5)
        outcome = compliant_impact(body, body.turning(-1.0), 1e7, gravity=gravity, trajectory=True)
        first, *_ = outcome.trajectory.force
        assert 0.0 < first[0, 0] < 10.0 * 9.81


def test_a_trajectory_is_in_si_units():
    body = plate(1.0, 0.4, 10.0, 0.5)
    outcome = compliant_impact(body, body.turning(-1.0), 1e7, trajectory=True)
    way = outcome.trajectory
    assert way.time[-1] == pytest.approx(outcome.duration)
    assert way.twist[-1] == pytest.approx(outcome.twist, abs=1e-9)
    assert np.trapezoid(way.force[:, 1, 0], way.time) == pytest.approx(outcome.impulses[1][0], rel=2e-2)
    assert way.gap.shape == (len(way.time), 2)
    rate = np.gradient(way.gap[:, 1], way.time)
    closing = [velocities(body, twist)[2] for twist in way.twist]
    assert np.median(np.abs(rate - closing)) < 1e-2
    assert compliant_impact(body, body.turning(-1.0), 1e7).trajectory is None


def test_odd_input_is_named():
    body, twist = SLIPS
    assert compliant_impact(body, Twist(0.0, 1.0, 0.0), 1e6).status is Status.NO_IMPACT
    assert compliant_impact(body, twist, 1e6, evaluations=20).status is Status.TOO_COSTLY
    bad = (
        compliant_impact(body, Twist(math.nan, 0.0, 0.0), 1e6),
        compliant_impact(body._replace(mass=-1.0), twist, 1e6),
        compliant_impact(body, twist, 0.0),
        compliant_impact(body, twist, math.nan),
        compliant_impact(body, twist, 1e6, ratio=0.0),
        compliant_impact(body, twist, 1e6, damping=(-1.0, 1.0)),
        compliant_impact(body, twist, 1e6, gravity=(math.inf, 0.0)),
        compliant_impact(body, twist, 1e6, tolerance=0.0),
    )
    for outcome in bad:
        assert outcome.status is Status.INVALID_INPUT
        assert all(map(math.isfinite, outcome.twist))
    with pytest.raises(ValueError, match="use one of Radau"):
        compliant_impact(body, twist, 1e6, method="Euler")
