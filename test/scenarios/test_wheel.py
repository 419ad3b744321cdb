"""A rimless wheel that rolls, slips and stops, and its closed forms, against each other and published numbers."""

from __future__ import annotations

import itertools
from math import cos, inf, nan, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Mode
from impact_predictor.scenarios.wheel import Hub, RollEnd, Rolling, RollingPart, Wheel, roll
from impact_predictor.scenarios.wheel_closed_forms import (
    downhill,
    gained,
    impact_friction,
    kept,
    least_friction,
    passes,
    stance_friction,
    steady,
)

ALPHA = pi / 8.0
HUB = Hub(mass=1.0, inertia=1e-12, leg=1.0, friction=1.0, slope=0.08, gravity=9.8)
POINT_MASS = Wheel(HUB._replace(inertia=0.0), ALPHA)


def rates_of(rolling: Rolling) -> list[tuple[float, float]]:
    """Rates downhill before and after each impact."""
    return [(-one.strike.before.omega, -one.strike.after.omega) for one in rolling.impacts]


def rates_on(wheel: Wheel, after: float) -> list[float]:
    """Rates right after each impact from the one on, `after` which the wheel turns so, by its closed form."""
    found, gain = [after], gained(wheel.hub, -wheel.alpha, wheel.alpha)
    while found[-1] > 0.0 and passes(wheel.hub, -wheel.alpha, found[-1]) and len(found) < 50:
        found.append(kept(wheel.hub, wheel.alpha) * (found[-1] ** 2 + gain) ** 0.5)
    return found


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("rate", [0.0, 2.0])
def test_a_point_mass_on_a_slope_of_008_comes_to_its_known_rates(rate: float, law: str) -> None:
    rolling = roll(Wheel(HUB, ALPHA), rate, steps=32, law=law)
    assert rolling.end is RollEnd.STEPS_DONE
    assert rolling.steps == 32
    assert {one.strike.outcome.mode for one in rolling.impacts} == {Mode.PIVOT}
    # 32 steps bring the squares of the rates nearer by 2^32; ten digits are published.
    before, after = rates_of(rolling)[-1]
    assert before == pytest.approx(1.548428592, abs=1e-8)
    assert after == pytest.approx(1.094904357, abs=1e-8)


@pytest.mark.parametrize("inertia", [1e-9, 0.1, 1.0])
def test_the_wheel_rolls_from_its_first_impact_on_as_its_closed_form_says(inertia: float) -> None:
    wheel = Wheel(HUB._replace(inertia=inertia, friction=100.0), ALPHA)
    rolling = roll(wheel, 0.3, steps=40)
    found = [after for _, after in rates_of(rolling)]
    assert found == pytest.approx(rates_on(wheel, found[0])[: len(found)], rel=1e-10)


def test_on_a_slope_of_005_it_stops_after_the_steps_of_the_closed_form_and_rocks_to_rest_on_two_spokes() -> None:
    wheel = Wheel(HUB._replace(slope=0.05), ALPHA)
    rolling = roll(wheel, 1.5, steps=None)
    assert rolling.end is RollEnd.RESTS
    found = [after for _, after in rates_of(rolling)]
    onwards = [rate for rate in found if rate > 0.0]
    known = rates_on(wheel, found[0])
    # The last of the known rates does not bring it over its spoke: from there on it rocks.
    assert onwards[: len(known)] == pytest.approx(known, rel=1e-9)
    assert found[len(known)] < 0.0
    assert rolling.steps == len(known) - 1
    # Each rocking impact keeps cos 45 degrees, and they accumulate.
    rocking = np.abs(found[len(known) : len(known) + 10])
    assert rocking[1:] / rocking[:-1] == pytest.approx(cos(2.0 * ALPHA), rel=1e-9)
    assert rolling.parts[-1].run.accumulations[-1].time == pytest.approx(rolling.time, abs=1e-6)
    assert rolling.parts[-1].run.states(rolling.time) == "SS"


def test_with_less_friction_than_the_slope_it_slides_down_for_ever() -> None:
    rolling = roll(Wheel(HUB._replace(inertia=0.1, friction=0.05), ALPHA), 0.0, steps=None, duration=5.0)
    assert rolling.end is RollEnd.TIME_UP
    assert rolling.time == 5.0
    assert set(rolling.parts[-1].run.states(5.0)) - {"O"} == {"+"}
    late, later = rolling.world(np.array([4.0, 5.0])).vx
    assert later - late == pytest.approx(9.8 * (sin(0.08) - 0.05 * cos(0.08)) * cos(0.08), rel=1e-9)


def test_its_motion_is_continuous_and_its_rates_are_the_derivatives_of_its_pose() -> None:
    rolling = roll(Wheel(HUB._replace(inertia=0.1, friction=0.35), ALPHA), 0.2, steps=6)
    times = np.linspace(0.0, rolling.time, 20_001)
    state = rolling.world(times)
    step = times[1]
    strikes = np.array([one.strike.time for one in rolling.impacts])
    smooth = np.array([not np.any((strikes >= a) & (strikes <= b)) for a, b in itertools.pairwise(times)])
    for place, rate in ((state.x, state.vx), (state.y, state.vy), (state.angle, state.omega)):
        # The largest acceleration jumps by a few m/s^2 where a slip ends.
        assert np.diff(place)[smooth] / step == pytest.approx(0.5 * (rate[1:] + rate[:-1])[smooth], abs=5e-3)
        assert np.max(np.abs(np.diff(place))) < 2.0 * np.max(np.abs(rate)) * step
    assert rolling.world(0.0).angle == pytest.approx(ALPHA - 0.08, rel=1e-12)
    # Six spokes on, over the last one: turned by six times the angle between two of them.
    assert rolling.world(rolling.time).angle == pytest.approx(ALPHA - 0.08 - 12.0 * ALPHA, rel=1e-9)
    assert rolling.world(times[7]).x == state.x[7]


def test_spokes_count_on_every_turn_and_uphill_they_count_back() -> None:
    down = roll(Wheel(HUB, ALPHA), 0.0, steps=17)
    assert [one.new for one in down.impacts] == [k % 8 for k in range(1, 18)]
    assert [one.old for one in down.impacts] == [k % 8 for k in range(17)]
    up = roll(Wheel(HUB, ALPHA), -2.4, steps=5)
    assert [(one.old, one.new) for one in up.impacts[:2]] == [(0, 7), (7, 6)]
    assert up.end is RollEnd.RESTS
    assert up.steps < 0
    assert up.distance < 0.0


def slips(part: RollingPart) -> bool:
    return any({*phase.states} & {"+", "-"} and phase.end > phase.start for phase in part.run.phases)


@pytest.mark.parametrize(("slope", "spokes", "end"), [(20.0, 8, "STEPS_DONE"), (40.0, 8, "TAKES_OFF")])
def test_a_wheel_for_which_no_friction_is_enough_slips_or_takes_off(slope: float, spokes: int, end: str) -> None:
    wheel = Wheel(HUB._replace(inertia=0.1, friction=100.0, slope=radians(slope)), pi / spokes)
    assert steady(wheel) is not None
    assert least_friction(wheel) == inf
    rolling = roll(wheel, 0.0)
    assert rolling.end.name == end
    assert any(slips(part) for part in rolling.parts)


def test_on_the_level_it_stands_balanced_on_a_spoke_for_ever() -> None:
    rolling = roll(Wheel(HUB._replace(slope=0.0), ALPHA), 0.0)
    assert (rolling.end, rolling.steps, rolling.distance) == (RollEnd.BALANCED, 0, 0.0)


@pytest.mark.parametrize("alpha", [0.0, -0.1, radians(23.0), pi / 2.0, float("nan"), pi / 2000.0])
def test_angles_that_do_not_go_around_are_refused_in_one_sentence(alpha: float) -> None:
    with pytest.raises(InputError, match=r"alpha is .* degrees, .*; give 180 degrees divided by a whole number"):
        roll(Wheel(HUB, alpha))


@pytest.mark.parametrize("duration", [-1.0, 0.0, 1e5, inf, nan])
def test_a_duration_that_is_none_or_too_long_is_refused_with_those_that_are_not(duration: float) -> None:
    with pytest.raises(InputError, match=r"duration is .*; give a number of seconds between 0 and 1e5"):
        roll(Wheel(HUB._replace(slope=0.0), ALPHA), duration=duration)


def sloping(slope: float, inertia: float = 0.0) -> Wheel:
    return POINT_MASS._replace(hub=HUB._replace(slope=slope, inertia=inertia))


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


def test_a_wheel_whose_mass_and_inertia_are_a_few_times_larger_moves_the_same_and_needs_the_same_friction() -> None:
    light = Wheel(HUB._replace(inertia=0.3), ALPHA)
    heavy = light._replace(hub=light.hub._replace(mass=2.5, inertia=2.5 * 0.3))
    assert steady(heavy) == pytest.approx(steady(light), rel=1e-14)
    assert gained(heavy.hub, -0.2, 0.3) == pytest.approx(gained(light.hub, -0.2, 0.3), rel=1e-14)
    assert least_friction(heavy) == pytest.approx(least_friction(light), rel=1e-14)


@pytest.mark.parametrize("inertia", [1e-6, 0.1, 1.0, 5.0])
def test_the_least_friction_of_an_impact_divides_a_foot_that_sticks_from_one_that_slips(inertia: float) -> None:
    hub = HUB._replace(inertia=inertia)
    least = impact_friction(hub, ALPHA)
    assert least == pytest.approx(sin(ALPHA) * cos(ALPHA) / (inertia + cos(ALPHA) ** 2), rel=1e-14)
    # A slip below 1e-9 of the speeds is none.
    for friction, sticks in ((least * (1.0 + 1e-6), True), (least * (1.0 - 1e-6), False)):
        body = hub._replace(friction=friction).body(ALPHA)
        outcome = solve_impact(body, body.turning(-1.5))
        assert (outcome.mode is Mode.PIVOT) is sticks
        if not sticks:
            assert outcome.mode in (Mode.PIVOT_SLIDE, Mode.SLIDE)


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
        assert any(slips(part) for part in found.parts) is not sticks


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


@pytest.mark.parametrize("rate", [0.3, 1.0, 2.5])
def test_the_standing_foot_of_a_point_mass_needs_the_tangent_of_its_angle_at_any_rate(rate: float) -> None:
    for angle in (-ALPHA, -0.1, 0.2, ALPHA):
        assert stance_friction(POINT_MASS.hub, angle, rate) == pytest.approx(tan(abs(angle)), rel=1e-12)
