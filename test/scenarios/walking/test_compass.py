"""The compass gait: its published steady gaits, its stability, and its impact by contacts and by momenta.

M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, "The simplest walking model: stability, complexity, and scaling",
J. Biomechanical Engineering 120(2), 1998; the digits are those of the authors' program for it, "to 1e-10".
"""

from __future__ import annotations

import itertools
from math import cos, radians, sin, tan
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Mode
from impact_predictor.scenarios.walking.compass import (
    Compass,
    Gait,
    after_impact,
    fixed_point,
    multipliers,
    step,
    strike,
)

SIMPLEST = Compass(hip_mass=1.0, leg_mass=1e-15, to_foot=0.0, to_hip=1.0, slope=0.009, gravity=1.0)
"""Its feet have hardly any mass: what is left of them is below rounding."""

LONG, SHORT = (0.20031090049483, 0.19983247291764), (0.19393736960624, 0.20386692731962)
"""Angle and rate of the standing leg right after an impact, of the long (stable) and the short steps."""


def gait_of(angle: float, rate: float) -> Gait:
    """A gait of the simplest walker, whose impact gives the old leg cos(2 angle) times its rate before."""
    return Gait(angle, rate, rate * cos(2.0 * angle))


@pytest.mark.parametrize(("published", "error"), [(LONG, 1e-10), (SHORT, 3e-10)])
def test_the_simplest_walker_has_its_published_steady_gaits(published: tuple[float, float], error: float) -> None:
    # The short gait multiplies errors by 4 with each step, so that its published digits are less sure.
    found = fixed_point(SIMPLEST, gait_of(*published))
    assert found[:2] == pytest.approx(published, abs=error)
    landed = step(SIMPLEST, found)
    assert landed is not None
    assert tuple(landed.after) == pytest.approx(tuple(found), abs=1e-12)


def test_the_steady_gait_repeats_itself_in_the_equations_of_the_paper_too() -> None:
    # In the paper's angles: theta of the standing leg, positive backwards, and phi between the legs.
    found = fixed_point(SIMPLEST, gait_of(*LONG))

    def paper(_: float, state: Any) -> list[float]:
        theta, theta_rate, phi, _ = state
        fall = sin(theta - 0.009)
        return [
            theta_rate,
            fall,
            state[3],
            fall + theta_rate**2 * sin(phi) - cos(theta - 0.009) * sin(phi),
        ]

    def lands(_: float, state: Any) -> float:
        return float(state[2] - 2.0 * state[0]) if state[0] < 0.0 else -1.0

    lands.terminal, lands.direction = True, 1.0  # type: ignore[attr-defined]
    rate = -found.stance
    start = [found.angle, rate, 2.0 * found.angle, rate * (1.0 - cos(2.0 * found.angle))]
    ended: Any = solve_ivp(paper, (0.0, 10.0), start, "DOP853", events=lands, rtol=1e-13, atol=1e-15)
    theta, theta_rate, _, _ = ended.y_events[0][0]
    assert -theta == pytest.approx(found.angle, abs=1e-11)
    assert cos(2.0 * theta) * theta_rate == pytest.approx(rate, abs=1e-11)


def test_the_long_steps_are_stable_and_the_short_ones_are_not() -> None:
    # The paper: one of the two gaits is stable for slopes up to 0.015.
    long, short = (multipliers(SIMPLEST, fixed_point(SIMPLEST, gait_of(*one))) for one in (LONG, SHORT))
    assert np.abs(long) == pytest.approx([0.5891, 0.5891, 0.0], abs=1e-4)
    # The authors' program: 4.000 and 0.459.
    assert np.abs(short) == pytest.approx([4.0, 0.459, 0.0], abs=5e-3)


def test_feet_with_mass_change_the_gait_in_proportion_to_it() -> None:
    none = fixed_point(SIMPLEST, gait_of(*LONG))
    changes = [
        fixed_point(SIMPLEST._replace(leg_mass=mass), none).angle - none.angle for mass in (1e-3, 1e-4, 1e-5, 1e-6)
    ]
    assert [one / other for one, other in itertools.pairwise(changes)] == pytest.approx([10.0] * 3, rel=2e-2)


@pytest.mark.parametrize("share", [1e-12, 1e-3, 0.1, 1.0])
def test_the_impact_of_feet_with_mass_is_the_published_one(share: float) -> None:
    # The authors' program: the standing leg's rate becomes cos(2 theta) / (1 + beta sin^2(2 theta)) of it.
    compass = SIMPLEST._replace(leg_mass=share)
    stance, _ = after_impact(compass, (0.2, -0.2), (0.25, 0.1))
    assert stance == pytest.approx(0.25 * cos(0.4) / (1.0 + share * sin(0.4) ** 2), rel=1e-13)


@pytest.mark.parametrize("inertia", [0.0, 0.02])
def test_a_compass_with_heavy_legs_walks_steadily_down_3_degrees(inertia: float) -> None:
    compass = Compass(slope=radians(3.0), leg_inertia=inertia)
    found = fixed_point(compass, Gait(0.27, 1.1, 0.4))
    landed = step(compass, found)
    assert landed is not None
    assert tuple(landed.after) == pytest.approx(tuple(found), abs=1e-11)
    assert np.abs(multipliers(compass, found)).max() < 1.0
    # In a step gravity gives what the impact takes.
    gain = (10.0 + 2.0 * 5.0) * 9.81 * 2.0 * sin(found.angle) * sin(compass.slope)
    outcome, _ = strike(compass, landed.angles, landed.rates, 1.0, law="total")
    assert outcome.energy_lost == pytest.approx(gain, rel=1e-10)


def test_its_impact_by_the_total_law_is_that_of_the_momenta_where_friction_holds_the_new_foot() -> None:
    compass = Compass(slope=radians(3.0))
    landed = step(compass, Gait(0.27, 1.1, 0.4))
    assert landed is not None
    for friction in (0.3, 0.5, 1.0):
        outcome, rates = strike(compass, landed.angles, landed.rates, friction, law="total")
        assert outcome.mode is Mode.PIVOT
        assert rates == pytest.approx(after_impact(compass, landed.angles, landed.rates), abs=1e-13)
    (_, _), (normal, tangential) = outcome.impulses
    least = abs(tangential) / normal
    assert strike(compass, landed.angles, landed.rates, least * 0.999)[0].mode is Mode.PIVOT_SLIDE


def test_along_the_impulse_path_the_old_foot_of_heavy_legs_is_pressed_a_little_before_it_leaves() -> None:
    # The published impact takes the old foot to leave at once: an assumption that the growing impulse does not share.
    compass = Compass(slope=radians(3.0))
    landed = step(compass, fixed_point(compass, Gait(0.27, 1.1, 0.4)))
    assert landed is not None
    outcome, rates = strike(compass, landed.angles, landed.rates, 1.0, law="path")
    known = after_impact(compass, landed.angles, landed.rates)
    assert outcome.mode is Mode.PIVOT
    assert 0.0 < outcome.impulses[0][0] < 0.01 * outcome.impulses[1][0]
    assert 1e-3 < rates[0] / known[0] - 1.0 < 1e-2


@pytest.mark.parametrize("share", [1e-2, 1e-4, 1e-6])
def test_with_light_feet_both_laws_and_the_momenta_agree_and_the_friction_needed_is_that_of_a_point_mass(
    share: float,
) -> None:
    compass, angles, rates = SIMPLEST._replace(leg_mass=share), (0.2, -0.2), (0.22, 0.21)
    known = after_impact(compass, angles, rates)
    for law in ("path", "total"):
        outcome, found = strike(compass, angles, rates, 1.0, law)
        assert outcome.mode is Mode.PIVOT
        # W has a condition number of about 1 / share.
        assert found == pytest.approx(known, abs=1e-15 / share + 1e-14)
        normal, tangential = outcome.impulses[1]
        assert abs(tangential) / normal == pytest.approx(tan(0.2), abs=share)


def test_a_compass_without_enough_speed_falls_and_has_no_gait_next_to_it() -> None:
    assert step(SIMPLEST, Gait(0.2, 0.05, 0.05)) is None
    with pytest.raises(InputError, match="the compass falls from the gait that is given"):
        fixed_point(SIMPLEST, Gait(0.2, 0.05, 0.05))
