"""One stride of a hub on legs without mass: when the next foot lands, what its impact leaves, and how it can fail."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Mode
from impact_predictor.scenarios.walking.closed_forms import gained, kept, step_time
from impact_predictor.scenarios.walking.stride import Hub, Stance, Stride, StrideEnd, stride

ALPHA = pi / 8.0
HUB = Hub(mass=1.0, inertia=0.1, leg=1.0, friction=1.0, slope=0.08, gravity=9.8)


def landed(found: Stride) -> tuple[Stance, Stance]:
    assert found.end is StrideEnd.LANDS
    assert found.before is not None
    assert found.after is not None
    return found.before, found.after


@pytest.mark.parametrize("ahead", [0.2, ALPHA, 0.6])
def test_a_foot_lands_where_its_leg_is_put_at_the_rate_and_the_time_that_the_energy_gives(ahead: float) -> None:
    start = Stance(-0.3, 1.5, foot=2.0)
    found = stride(HUB, start, ahead)
    before, after = landed(found)
    rate = (1.5**2 + gained(HUB, -0.3, ahead)) ** 0.5
    # A stance that sticks is followed exactly, up to rounding.
    assert before.rate == pytest.approx(rate, rel=1e-12)
    assert found.time == pytest.approx(step_time(HUB, -0.3, ahead, 1.5), rel=1e-12)
    assert (before.angle, before.slip) == (ahead, 0.0)
    assert before.foot == pytest.approx(2.0, rel=1e-15)
    assert after.rate == pytest.approx(kept(HUB, ahead) * rate, rel=1e-12)
    assert (after.angle, after.slip) == (-ahead, 0.0)
    assert after.foot == pytest.approx(2.0 + 2.0 * sin(ahead), rel=1e-14)
    assert found.outcome is not None
    assert found.outcome.mode is Mode.PIVOT


def test_strides_that_follow_each_other_come_to_the_known_steady_rolling_of_a_point_mass() -> None:
    hub, stance = HUB._replace(inertia=1e-12), Stance(0.0, 0.5)
    for _ in range(40):
        before, stance = landed(stride(hub, stance, ALPHA))
    assert before.rate == pytest.approx(1.548428592, abs=1e-8)
    assert stance.rate == pytest.approx(1.094904357, abs=1e-8)


def test_a_stride_may_be_followed_anew_from_any_moment_of_it() -> None:
    start = Stance(-ALPHA, 1.2)
    whole = stride(HUB, start, ALPHA)
    middle = whole.world(0.5)
    # World angles count from the pose with both feet on level ground: the leg's lean, turned by the slope.
    angle = ALPHA - (middle.angle + HUB.slope)
    rest = stride(HUB, Stance(angle, -middle.omega), ALPHA)
    assert 0.5 + rest.time == pytest.approx(whole.time, rel=1e-12)
    assert landed(rest)[0].rate == pytest.approx(landed(whole)[0].rate, rel=1e-12)


def test_the_motion_in_between_keeps_its_foot_its_energy_and_its_derivatives() -> None:
    found = stride(HUB, Stance(-ALPHA, 1.2, foot=1.0), ALPHA)
    times = np.linspace(0.0, found.time, 2001)
    state = found.world(times)
    foot = np.array([cos(HUB.slope), -sin(HUB.slope)])
    # The leg ends on the slope, one leg from the hub.
    assert np.hypot(state.x - foot[0], state.y - foot[1]) == pytest.approx(1.0, abs=1e-12)
    energy = 0.5 * (np.square(state.vx) + np.square(state.vy) + 0.1 * np.square(state.omega)) + 9.8 * np.array(state.y)
    assert np.ptp(energy) < 1e-10  # of 9.3 J; dense output is good to 1e-12 of the rates
    for place, rate in ((state.x, state.vx), (state.y, state.vy), (state.angle, state.omega)):
        assert np.diff(place) / np.diff(times) == pytest.approx(0.5 * (rate[1:] + rate[:-1]), abs=1e-6)
    last = found.world(found.time)
    assert -last.omega == pytest.approx(landed(found)[0].rate, rel=1e-9)  # before the impact, not after it


def test_a_stance_too_slow_to_come_over_its_leg_falls_back_onto_the_one_behind() -> None:
    slow = Stance(-ALPHA, 0.5)
    back = stride(HUB, slow, ALPHA, behind=ALPHA)
    assert back.end is StrideEnd.FALLS_BACK
    assert back.outcome is None
    # It comes back at the rate at which it began.
    assert back.world(back.time).omega == pytest.approx(0.5, rel=1e-9)
    flat = stride(HUB, slow, ALPHA)
    assert flat.end is StrideEnd.FALLS_BACK
    assert flat.time > back.time


def test_a_stance_at_rest_over_its_foot_balances_and_one_beyond_it_does_not() -> None:
    level = HUB._replace(slope=0.0)  # else rounding makes it fall
    assert stride(level, Stance(0.0, 0.0), ALPHA).end is StrideEnd.BALANCES
    assert stride(level, Stance(0.01, 0.0), ALPHA).end is StrideEnd.LANDS


def test_a_stance_that_turns_too_fast_for_its_weight_takes_off() -> None:
    found = stride(HUB, Stance(-ALPHA, 4.0), ALPHA)
    assert found.end is StrideEnd.TAKES_OFF
    assert found.time == 0.0


def test_the_time_may_be_up_first() -> None:
    found = stride(HUB, Stance(-ALPHA, 1.2), ALPHA, duration=0.1)
    assert (found.end, found.time, found.outcome) == (StrideEnd.TIME_UP, 0.1, None)


def test_on_too_slippery_a_ground_the_new_foot_slips_forwards_and_goes_on_slipping_in_the_next_stride() -> None:
    slippery = HUB._replace(friction=0.3)
    first = stride(slippery, Stance(0.0, 0.8), ALPHA)
    _, after = landed(first)
    assert first.outcome is not None
    assert first.outcome.mode is Mode.PIVOT_SLIDE
    assert after.slip > 0.1
    # The hub's velocity is the same, told by the foot's slip or by the outcome.
    vx = after.slip + after.rate * cos(ALPHA)
    assert first.outcome.twist.vx == pytest.approx(vx, rel=1e-12)
    then = stride(slippery, after, ALPHA, behind=ALPHA)
    assert then.run.phases[0].states == "+O"
    assert then.run.state(1e-3).vx != pytest.approx(vx, rel=1e-6)


def test_a_foot_that_comes_down_on_a_slippery_place_slips_where_its_hub_s_friction_would_hold_it() -> None:
    start = Stance(-ALPHA, 1.2)
    assert landed(stride(HUB, start, ALPHA))[1].slip == 0.0
    found = stride(HUB, start, ALPHA, grip=0.2)
    assert landed(found)[1].slip > 0.0
    assert found.run.phases[0].states == "SO"  # the old foot still has the hub's


def test_both_laws_agree_on_a_foot_that_turns_over_one_that_sticks() -> None:
    for friction in (0.35, 1.0):
        hub = HUB._replace(friction=friction)
        path, total = (landed(stride(hub, Stance(0.3, 1.0), ALPHA, law=law))[1] for law in ("path", "total"))
        assert tuple(path) == pytest.approx(tuple(total), abs=1e-12)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"start": Stance(0.5, 1.0)}, "below the support"),
        ({"ahead": 0.0}, "ahead is 0.0; give an angle between 0 and pi / 2"),
        ({"hub": HUB._replace(inertia=0.0)}, "inertia is 0.0; give a finite number above 0"),
        ({"hub": HUB._replace(friction=-1.0)}, "friction is -1.0"),
        ({"hub": HUB._replace(slope=float("nan"))}, "slope is nan degrees; give an angle between -90 and 90 degrees"),
        ({"grip": -0.1}, "grip is -0.1"),
        ({"duration": float("nan")}, "duration is nan"),
    ],
)
def test_numbers_out_of_their_range_are_refused_in_one_sentence(change: dict[str, object], sentence: str) -> None:
    arguments: dict[str, object] = {"hub": HUB, "start": Stance(-0.3, 1.0), "ahead": ALPHA}
    with pytest.raises(InputError, match=sentence):
        stride(**(arguments | change))  # type: ignore[arg-type]
