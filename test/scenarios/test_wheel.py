"""A rimless wheel that rolls, slips and stops, against its closed form and its published numbers."""

from __future__ import annotations

import itertools
from math import cos, inf, pi, radians, sin

import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Mode
from impact_predictor.scenarios.wheel import Hub, RollEnd, Rolling, Wheel, roll
from impact_predictor.scenarios.wheel_closed_forms import gained, impact_friction, kept, least_friction, passes, steady

ALPHA = pi / 8.0
HUB = Hub(mass=1.0, inertia=1e-12, leg=1.0, friction=1.0, slope=0.08, gravity=9.8)


def rates_of(rolling: Rolling) -> list[tuple[float, float]]:
    """Rates downhill before and after each impact."""
    return [(-one.strike.before.omega, -one.strike.after.omega) for one in rolling.impacts]


def rates_on(wheel: Wheel, after: float) -> list[float]:
    """Rates right after each impact from the one on, `after` which the wheel turns so, by its closed form."""
    found, gain = [after], gained(wheel.hub, -wheel.alpha, wheel.alpha)
    while found[-1] > 0.0 and passes(wheel.hub, -wheel.alpha, found[-1]) and len(found) < 50:
        found.append(kept(wheel.hub, wheel.alpha) * (found[-1] ** 2 + gain) ** 0.5)
    return found


def modes_of(rolling: Rolling) -> list[Mode]:
    return [one.strike.outcome.mode for one in rolling.impacts]


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("rate", [0.0, 2.0])
def test_a_point_mass_on_a_slope_of_008_comes_to_its_known_rates(rate: float, law: str) -> None:
    rolling = roll(Wheel(HUB, ALPHA), rate, steps=32, law=law)
    assert rolling.end is RollEnd.STEPS_DONE
    assert rolling.steps == 32
    assert set(modes_of(rolling)) == {Mode.PIVOT}
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
    times = np.diff([one.strike.time for one in rolling.impacts])
    steadily = steady(wheel)
    assert steadily is not None
    assert times[-1] == pytest.approx(steadily.time, rel=1e-5)
    assert wheel.step / times[-1] == pytest.approx(steadily.speed, rel=1e-5)


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
    assert [state for _, state in rolling.stood(rolling.time)] == ["S", "S"]


@pytest.mark.parametrize(("friction", "slips"), [(0.38, False), (0.36, True), (0.3, True), (0.2, True)])
def test_below_its_limit_a_spoke_slips_in_the_impact_and_goes_on_slipping(friction: float, slips: bool) -> None:
    wheel = Wheel(HUB._replace(inertia=0.1, friction=friction), ALPHA)
    assert (friction < impact_friction(wheel.hub, ALPHA)) is slips
    assert (friction < least_friction(wheel)) is slips
    rolling = roll(wheel, 0.0, steps=4)
    first = rolling.impacts[0]
    assert first.strike.outcome.mode is (Mode.PIVOT_SLIDE if slips else Mode.PIVOT)
    assert rolling.stood(first.strike.time) == ((1, "+" if slips else "S"),)
    # The tip's way, from the motion itself.
    times = first.strike.time + np.linspace(0.0, 0.01, 50)
    state = rolling.world(times)
    x, y = wheel.tips[1]
    tip = state.x + np.cos(state.angle) * x - np.sin(state.angle) * y
    moved = (tip[-1] - tip[0]) / cos(wheel.hub.slope)
    assert (moved > 1e-4) if slips else (abs(moved) < 1e-12)


def test_with_less_friction_than_the_slope_it_slides_down_for_ever() -> None:
    rolling = roll(Wheel(HUB._replace(inertia=0.1, friction=0.05), ALPHA), 0.0, steps=None, duration=5.0)
    assert rolling.end is RollEnd.TIME_UP
    assert rolling.time == 5.0
    assert {state for _, state in rolling.stood(5.0)} == {"+"}
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


@pytest.mark.parametrize("friction", [1.0, 0.35])
@pytest.mark.parametrize("steps", [1, 2, 9])
def test_on_a_slope_that_rises_ahead_it_rolls_backwards_as_its_mirror_image_rolls_ahead(
    steps: int, friction: float
) -> None:
    hub = HUB._replace(inertia=0.1, friction=friction)
    ahead, back = (roll(Wheel(hub._replace(slope=slope), ALPHA), 0.0, steps) for slope in (0.08, -0.08))
    assert (back.end, back.steps) == (RollEnd.STEPS_DONE, -steps)
    assert back.time == pytest.approx(ahead.time, rel=1e-9)
    assert back.distance == pytest.approx(-ahead.distance, rel=1e-9)
    assert rates_of(back) == [pytest.approx((-before, -after), rel=1e-9) for before, after in rates_of(ahead)]
    assert [one.new for one in back.impacts] == [-one.new % 8 for one in ahead.impacts]


@pytest.mark.parametrize(("slope", "spokes", "end"), [(20.0, 8, "STEPS_DONE"), (40.0, 8, "TAKES_OFF")])
def test_a_wheel_for_which_no_friction_is_enough_slips_or_takes_off(slope: float, spokes: int, end: str) -> None:
    wheel = Wheel(HUB._replace(inertia=0.1, friction=100.0, slope=radians(slope)), pi / spokes)
    assert steady(wheel) is not None
    assert least_friction(wheel) == inf
    rolling = roll(wheel, 0.0)
    assert rolling.end.name == end
    assert any(state in ("+", "-") for stand in rolling.stands for _, state in stand.tips)


def test_a_wheel_that_turns_too_fast_for_its_weight_takes_off() -> None:
    rolling = roll(Wheel(HUB, ALPHA), 3.2)
    assert (rolling.end, rolling.time, rolling.impacts) == (RollEnd.TAKES_OFF, 0.0, ())


def test_on_the_level_it_stands_balanced_on_a_spoke_for_ever() -> None:
    rolling = roll(Wheel(HUB._replace(slope=0.0), ALPHA), 0.0)
    assert (rolling.end, rolling.steps, rolling.distance) == (RollEnd.BALANCED, 0, 0.0)


@pytest.mark.parametrize("alpha", [0.0, -0.1, radians(23.0), pi / 2.0, float("nan"), pi / 2000.0])
def test_angles_that_do_not_go_around_are_refused_in_one_sentence(alpha: float) -> None:
    with pytest.raises(InputError, match=r"alpha is .* degrees, .*; give 180 degrees divided by a whole number"):
        roll(Wheel(HUB, alpha))


def test_angles_in_degrees_go_around_whatever_their_rounding() -> None:
    for spokes in (3, 7, 13, 360, 1000):
        assert Wheel(HUB, radians(180.0 / spokes)).spokes == spokes
        roll(Wheel(HUB, radians(180.0 / spokes)), 0.5, steps=2, duration=0.1)


@pytest.mark.parametrize(("name", "value"), [("rate", float("inf")), ("duration", 0.0), ("steps", 0)])
def test_numbers_out_of_their_range_are_refused(name: str, value: float) -> None:
    with pytest.raises(InputError, match=f"{name} is {value}"):
        roll(Wheel(HUB, ALPHA), **{name: value})  # type: ignore[arg-type]
