"""Compliant contacts: their physics, motions against rigid ones, and the rigid laws to which stiff impacts come."""

import math
import random
from itertools import pairwise

import numpy as np
import pytest
from compliant_impact import compliant_impact
from compliant_motion import (
    PLASTIC,
    Compliance,
    compliant_motion,
    damping_ratio,
    force,
    restitution_of,
)
from harmonic_deck import Wave, harmonic_support

from impact_predictor import Contact, Mode, Twist, TwoPointBody, plate, solve_impact
from impact_predictor.mechanics.motion import rock, standing
from impact_predictor.mechanics.motion.support import FixedSupport

FIRM = (50.0, 50.0)
"""Damping ratios of contacts that rebound by a ten-thousandth."""

REBOUND = 5e-3
"""Of V: a plastic contact rebounds by PLASTIC, and through friction and the other contact by a few times as much."""

SLIPS = plate(1.0, 0.6, 10.0, 0.5), Twist(0.1, -0.5, -1.0)
"""Slips backwards on A at 0.2 m/s while it turns: the path law lets the slip reverse, the total law stops it."""

PLATE = plate(1.0, 2.0, 10.0, 0.9)
"""Friction holds it, so that it rocks."""

DECK = harmonic_support(angle=(Wave(0.1, 2.0, 0.3),), x=(Wave(0.5, 1.3),), y=(Wave(0.3, 0.9, 1.0),))


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
    outcome = compliant_impact(body, twist, 1e8)
    assert outcome.mode is (Mode.PIVOT_SLIDE if restitution == 0.0 else Mode.FLIGHT)
    # The body turns by its speed times the root of m / k during the impact: 1e-4.
    assert velocities(body, outcome.twist)[0] == pytest.approx(
        -max(restitution, PLASTIC) * velocities(body, twist)[0], rel=0.01, abs=2e-4
    )


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


def test_an_impact_keeps_momentum_and_loses_energy():
    for seed in range(5):
        source = random.Random(seed)
        old = Contact(-source.uniform(0.2, 1.0), -0.5, 0.6)
        new = Contact(source.uniform(0.2, 1.0), -source.uniform(0.0, 0.5), 0.6, (-0.6, 0.8), source.random())
        body, before = TwoPointBody(2.0, 0.7, old, new), Twist(-0.1, -0.2, -1.0)
        outcome = compliant_impact(body, before, math.inf)
        px = py = moment = 0.0
        for contact, (normal, tangential) in zip((old, new), outcome.impulses, strict=True):
            (nx, ny), x, y = contact.normal, contact.x, contact.y
            fx, fy = normal * nx + tangential * ny, normal * ny - tangential * nx
            px, py, moment = px + fx, py + fy, moment + x * fy - y * fx
        change = [2.0 * (outcome.twist.vx - before.vx), 2.0 * (outcome.twist.vy - before.vy)]
        assert [px, py] == pytest.approx(change, abs=1e-9)
        assert moment == pytest.approx(0.7 * (outcome.twist.omega - before.omega), abs=1e-9)
        kinetic = [2.0 * (t.vx**2 + t.vy**2) / 2.0 + 0.7 * t.omega**2 / 2.0 for t in (before, outcome.twist)]
        assert outcome.energy_lost == pytest.approx(kinetic[0] - kinetic[1], abs=1e-9)
        assert outcome.energy_lost > 0.0


@pytest.mark.parametrize("support", [FixedSupport(), DECK], ids=["floor", "deck"])
def test_a_rocking_plate_converges_to_the_rigid_motion(support):
    start = standing(PLATE, 0.1)
    rigid = rock(PLATE, start, support, duration=1.0)
    assert len(rigid.impacts) >= 2
    errors = []
    for stiffness in (1e7, 1e9):
        run = compliant_motion(PLATE, start, support, 1.0, stiffness=stiffness, regularisation=1e-6)
        assert run.complete
        errors.append(max(np.abs(np.subtract(run.state(t), rigid.state(t))).max() for t in (0.2, 0.5, 1.0)))
    # Between k**-0.5, as one impact, and the depth under the weight, which is as 1 / k.
    assert errors[0] < 3e-3
    assert errors[1] < 0.1 * errors[0]


def test_more_points_hold_a_body_that_falls_over():
    corners = tuple(Contact(x, y, 0.9) for x, y in ((-0.5, 1.0), (0.5, 1.0)))
    run = compliant_motion(PLATE, standing(PLATE, 0.6), duration=3.0, more=corners, stiffness=1e6)
    assert run.state(3.0).angle == pytest.approx(0.5 * math.pi, abs=1e-3)
    assert run.state(3.0).y == pytest.approx(0.5, abs=1e-3)


def test_a_motion_ends_where_a_contact_closes():
    run = compliant_motion(PLATE, standing(PLATE, 0.1), until_closed=1)
    rigid = rock(PLATE, standing(PLATE, 0.1), FixedSupport(), duration=1.0)
    assert run.complete
    assert run.time == pytest.approx(rigid.impacts[0].time, abs=1e-4)  # it stands on a spring
    assert run.body.contacts(run.time, run.way(run.time))[1].gap == pytest.approx(0.0, abs=1e-12)
