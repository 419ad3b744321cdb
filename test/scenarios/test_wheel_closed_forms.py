"""The rimless wheel in closed form, against its published numbers and against what the mechanics of impacts say."""

from __future__ import annotations

from math import cos, inf, pi, sin, sqrt, tan

import pytest

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Mode
from impact_predictor.scenarios.wheel import Hub, Wheel, roll
from impact_predictor.scenarios.wheel_closed_forms import (
    downhill,
    gained,
    impact_friction,
    kept,
    least_friction,
    passes,
    stance_friction,
    steady,
    step_time,
)

ALPHA = pi / 8.0
POINT_MASS = Wheel(Hub(mass=1.0, inertia=0.0, leg=1.0, friction=1.0, slope=0.08, gravity=9.8), ALPHA)


def sloping(slope: float, inertia: float = 0.0) -> Wheel:
    return POINT_MASS._replace(hub=POINT_MASS.hub._replace(slope=slope, inertia=inertia))


def test_a_point_mass_on_a_slope_of_008_rolls_at_the_known_rates() -> None:
    rolling = steady(POINT_MASS)
    assert rolling is not None
    # Ten digits are known.
    assert rolling.before == pytest.approx(1.548428592, abs=1e-9)
    assert rolling.after == pytest.approx(1.094904357, abs=1e-9)
    assert least_friction(POINT_MASS) == pytest.approx(0.414214, abs=5e-7)
    # (J + m l^2) (before^2 - after^2) / 2 = m g times the fall of a step, and the impact keeps cos 45 degrees.
    assert rolling.before**2 - rolling.after**2 == pytest.approx(2.0 * 9.8 * 2.0 * sin(ALPHA) * sin(0.08), rel=1e-14)
    assert rolling.after / rolling.before == pytest.approx(sqrt(0.5), rel=1e-14)


def test_on_a_slope_of_005_a_point_mass_stops_and_it_rolls_from_where_it_just_comes_over_its_top() -> None:
    assert steady(sloping(0.05)) is None
    low, high = 0.05, 0.08
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if steady(sloping(middle)) is None else (low, middle)
    # Coming over the top takes (g / l) 2 (1 - cos(alpha - slope)) = after^2 = 4 (g / l) sin(alpha) sin(slope) here.
    assert 1.0 - cos(ALPHA - low) == pytest.approx(2.0 * sin(ALPHA) * sin(low), rel=1e-12)


def test_the_level_and_the_uphill_stop_every_wheel_and_so_do_three_or_four_spokes() -> None:
    for slope in (0.0, -0.1):
        assert steady(sloping(slope, 1.0)) is None
    assert steady(downhill(sloping(-0.1, 1.0))) == steady(sloping(0.1, 1.0)) == steady(downhill(sloping(0.1, 1.0)))
    for spokes in (3, 4):
        assert steady(POINT_MASS._replace(alpha=pi / spokes)) is None


@pytest.mark.parametrize("inertia", [0.0, 1e-9, 0.1, 0.5, 3.0])
def test_an_impact_multiplies_the_rate_by_what_the_inertia_and_the_angle_say(inertia: float) -> None:
    hub = Hub(mass=2.0, inertia=inertia, leg=0.7, friction=10.0)
    part = (inertia + 2.0 * 0.49 * cos(2.0 * ALPHA)) / (inertia + 2.0 * 0.49)
    assert kept(hub, ALPHA) == pytest.approx(part, rel=1e-15)
    if inertia:
        body = hub.body(ALPHA)
        for law in ("path", "total"):
            outcome = solve_impact(body, body.turning(-1.3), law)
            assert outcome.mode is Mode.PIVOT
            assert outcome.twist.omega == pytest.approx(-1.3 * part, rel=1e-13)


def test_a_point_mass_needs_tan_alpha_because_its_impulse_goes_through_it() -> None:
    # J (after - before) is the moment of the impulse about the mass centre: without inertia there is none, so that the
    # impulse lies along the leg, alpha from the normal.
    for inertia in (1e-3, 1e-6, 1e-9):
        body = POINT_MASS.hub._replace(inertia=inertia).body(ALPHA)
        outcome = solve_impact(body, body.turning(-1.5))
        normal, tangential = outcome.impulses[1]
        moment = body.new.x * normal - body.new.y * tangential
        assert moment == pytest.approx(inertia * (outcome.twist.omega + 1.5), rel=1e-6)
        assert abs(tangential) / normal == pytest.approx(tan(ALPHA), abs=inertia)
    assert impact_friction(POINT_MASS.hub, ALPHA) == pytest.approx(tan(ALPHA), rel=1e-15)


@pytest.mark.parametrize("inertia", [1e-6, 0.1, 1.0, 5.0])
def test_the_least_friction_of_an_impact_divides_a_foot_that_sticks_from_one_that_slips(inertia: float) -> None:
    hub = POINT_MASS.hub._replace(inertia=inertia)
    least = impact_friction(hub, ALPHA)
    assert least == pytest.approx(sin(ALPHA) * cos(ALPHA) / (inertia + cos(ALPHA) ** 2), rel=1e-14)
    # A slip below 1e-9 of the speeds is none.
    for friction, sticks in ((least * (1.0 + 1e-6), True), (least * (1.0 - 1e-6), False)):
        body = hub._replace(friction=friction).body(ALPHA)
        outcome = solve_impact(body, body.turning(-1.5))
        assert (outcome.mode is Mode.PIVOT) is sticks
        if not sticks:
            assert outcome.mode in (Mode.PIVOT_SLIDE, Mode.SLIDE)


@pytest.mark.parametrize("rate", [0.3, 1.0, 2.5])
def test_the_standing_foot_of_a_point_mass_needs_the_tangent_of_its_angle_at_any_rate(rate: float) -> None:
    for angle in (-ALPHA, -0.1, 0.2, ALPHA):
        assert stance_friction(POINT_MASS.hub, angle, rate) == pytest.approx(tan(abs(angle)), rel=1e-12)


@pytest.mark.parametrize("inertia", [0.1, 1.0, 5.0])
def test_with_inertia_the_stance_needs_more_than_the_impact_while_it_turns_slowly(inertia: float) -> None:
    hub = sloping(0.08, inertia).hub
    # sin(alpha - slope) = tan(alpha) (cos(alpha - slope) - l rate^2 / g)
    border = sqrt(9.8 * (cos(ALPHA - 0.08) - sin(ALPHA - 0.08) / tan(ALPHA)))
    assert stance_friction(hub, -ALPHA, border) == pytest.approx(impact_friction(hub, ALPHA), rel=1e-12)
    assert stance_friction(hub, -ALPHA, 0.9 * border) > impact_friction(hub, ALPHA)
    assert stance_friction(hub, -ALPHA, 1.1 * border) < impact_friction(hub, ALPHA)


@pytest.mark.parametrize("inertia", [0.05, 0.3, 2.0])
def test_the_least_friction_of_steady_rolling_divides_wheels_that_slip_from_those_that_do_not(inertia: float) -> None:
    wheel = sloping(0.08, inertia)
    rolling = steady(wheel)
    assert rolling is not None
    # From the steady rate over a spoke: the first impact is one of steady rolling.
    rate = sqrt(rolling.after**2 + gained(wheel.hub, -ALPHA, 0.0))
    for part, sticks in ((1.0 + 1e-6, True), (1.0 - 1e-6, False)):
        hub = wheel.hub._replace(friction=part * least_friction(wheel))
        found = roll(wheel._replace(hub=hub), rate, steps=2)
        assert all(state == "S" for stand in found.stands for _, state in stand.tips) is sticks


@pytest.mark.parametrize("inertia", [1e-9, 0.1, 1.0])
def test_the_time_and_the_gain_of_a_step_are_those_of_the_motion(inertia: float) -> None:
    wheel = sloping(0.08, inertia)._replace(hub=sloping(0.08, inertia).hub._replace(friction=100.0))
    rolling = steady(wheel)
    assert rolling is not None
    first, second = roll(wheel, sqrt(rolling.after**2 + gained(wheel.hub, -ALPHA, 0.0)), steps=2).impacts
    # The motion is followed to 1e-11, the closed form is exact.
    assert second.strike.time - first.strike.time == pytest.approx(rolling.time, rel=1e-10)
    assert -second.strike.before.omega == pytest.approx(rolling.before, rel=1e-10)
    assert rolling.speed == pytest.approx(2.0 * sin(ALPHA) / rolling.time, rel=1e-15)


def test_a_rate_too_small_does_not_bring_a_wheel_over_its_spoke() -> None:
    hub = sloping(0.05).hub
    least = sqrt(-gained(hub, -ALPHA, -hub.slope))
    assert passes(hub, -ALPHA, least * (1.0 + 1e-12))
    assert not passes(hub, -ALPHA, least * (1.0 - 1e-12))
    assert step_time(hub, -ALPHA, ALPHA, least * (1.0 - 1e-12)) == inf
