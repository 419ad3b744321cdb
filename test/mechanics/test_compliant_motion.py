"""Long motions on compliant contacts: against free fall, slopes, the rigid motion of a rocking plate, and energy."""

import math

import numpy as np
import pytest

from impact_predictor import Contact, TwoPointBody, plate
from impact_predictor.mechanics.compliant.integrator import Status
from impact_predictor.mechanics.compliant.motion import compliant_motion
from impact_predictor.mechanics.motion import PlanarState, rock, standing
from impact_predictor.mechanics.motion.support import FixedSupport, Wave, harmonic_support

PLATE = plate(1.0, 2.0, 10.0, 0.9)
"""Friction holds it, so that it rocks."""

DECK = harmonic_support(angle=(Wave(0.1, 2.0, 0.3),), x=(Wave(0.5, 1.3),), y=(Wave(0.3, 0.9, 1.0),))


def test_a_body_in_the_air_is_thrown():
    start = PlanarState(0.0, 9.0, 0.3, 2.0, 1.0, 0.7)
    run = compliant_motion(PLATE, start, duration=1.0)
    x, y, angle, vx, vy, omega = run.state(1.0)
    assert run.status is Status.OVER
    assert (x, y) == pytest.approx((2.0, 10.0 - 0.5 * 9.81), abs=1e-6)
    assert (angle, vx, vy, omega) == pytest.approx((1.0, 2.0, 1.0 - 9.81, 0.7), abs=1e-6)
    assert run.forces(0.5) == ((0.0, 0.0), (0.0, 0.0))


@pytest.mark.parametrize("friction", [0.05, 0.5])
def test_a_crate_on_a_slope_slides_when_its_friction_is_too_small(friction):
    slope = 0.2
    body = plate(1.0, 0.4, 10.0, friction)
    run = compliant_motion(body, standing(body, 0.0), FixedSupport(slope), 1.0, stiffness=1e7)
    tangential = -9.81 * (math.sin(slope) - friction * math.cos(slope))
    if friction < math.tan(slope):
        # The springs shake when the load comes on them, by 1e-5 m and as much of the friction's impulse.
        assert run.state(1.0).vx == pytest.approx(tangential, rel=1e-3)
        assert run.state(1.0).x == pytest.approx(0.5 * tangential + standing(body, 0.0).x, abs=1e-3)
    else:
        # It creeps: by less than the regularisation times the part of the friction that it needs.
        assert abs(run.state(1.0).vx) < 1e-4
    (left, _), (right, _) = run.forces(1.0)
    assert left + right == pytest.approx(10.0 * 9.81 * math.cos(slope), rel=1e-4)
    assert right < left  # it leans downhill, to the left


@pytest.mark.parametrize("support", [FixedSupport(), DECK], ids=["floor", "deck"])
def test_a_rocking_plate_converges_to_the_rigid_motion(support):
    start = standing(PLATE, 0.1)
    rigid = rock(PLATE, start, support, duration=1.0)
    assert len(rigid.impacts) >= 2
    errors = []
    for stiffness in (1e7, 1e9):
        run = compliant_motion(PLATE, start, support, 1.0, stiffness=stiffness, regularisation=1e-6)
        assert run.status is Status.OVER
        errors.append(max(np.abs(np.subtract(run.state(t), rigid.state(t))).max() for t in (0.2, 0.5, 1.0)))
    # Between k**-0.5, as one impact, and the depth under the weight, which is as 1 / k.
    assert errors[0] < 3e-3
    assert errors[1] < 0.1 * errors[0]


def test_energy_is_only_lost_on_a_fixed_support():
    stiffness = 1e6
    body = TwoPointBody(10.0, 4.0, Contact(-0.5, -1.0, 0.3, restitution=0.6), Contact(0.5, -1.0, 0.3, restitution=0.6))
    run = compliant_motion(body, standing(body, 0.3), duration=1.5, stiffness=stiffness)
    energies = []
    for time in np.linspace(0.0, run.time, 2001):
        x, y, _, vx, vy, omega = run.state(time)
        springs = sum(0.5 * stiffness * min(gap, 0.0) ** 2 for gap in run.gaps(time))
        energies.append(5.0 * (vx**2 + vy**2) + 2.0 * omega**2 + 98.1 * y + springs)
    assert np.diff(energies).max() < 1e-5
    assert energies[-1] < energies[0] - 1.0


def test_more_points_hold_a_body_that_falls_over():
    corners = tuple(Contact(x, y, 0.9) for x, y in ((-0.5, 1.0), (0.5, 1.0)))
    run = compliant_motion(PLATE, standing(PLATE, 0.6), duration=3.0, more=corners, stiffness=1e6)
    assert run.state(3.0).angle == pytest.approx(0.5 * math.pi, abs=1e-3)
    assert run.state(3.0).y == pytest.approx(0.5, abs=1e-3)


def test_a_run_may_start_later_on_a_deck_that_moves():
    start = standing(PLATE, 0.05)
    run = compliant_motion(PLATE, start, DECK, 0.2, start_time=3.0)
    assert run.time == pytest.approx(3.2)
    assert run.state(3.0) == pytest.approx(start, abs=1e-12)
    base = DECK.motion(3.0)
    assert run.world(3.0).omega == pytest.approx(base.rate)


def test_odd_input_is_named():
    start = standing(PLATE, 0.1)
    assert compliant_motion(PLATE, start, duration=1.0, evaluations=50).status is Status.TOO_COSTLY
    for run in (
        compliant_motion(PLATE, start._replace(x=math.nan)),
        compliant_motion(PLATE, start, stiffness=0.0),
        compliant_motion(PLATE._replace(mass=-1.0), start),
        compliant_motion(PLATE, start, duration=math.inf),
    ):
        assert run.status is Status.INVALID_INPUT
        assert all(map(math.isfinite, run.world(0.0)))
    with pytest.raises(ValueError, match="use one of Radau"):
        compliant_motion(PLATE, start, method="Euler")
