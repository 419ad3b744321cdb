"""A moving support that is known from an inertial sensor on it alone, in calm and in survival conditions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cos, hypot, inf, isfinite, nan, pi, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from impact_predictor.prediction.deck.motion import ahead
from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.scene import MovingDeck
from impact_predictor.prediction.types import Felt, Imu, Moment, Status, Vector3
from impact_predictor.prediction.vectors import add, axes_of, cross, rotation_between, to_body, turned

G = 9.81
GRAVITY = (0.0, 0.0, -G)
UP = (0.0, 0.0, 1.0)
LEVEL = (0.0, 0.0, 0.0, 1.0)
SECOND = 1_000_000_000
PLACE = (12.0, -3.0, 7.0)


def still(stamp: int = 0, **changes: Any) -> Imu:
    return Imu(stamp, "imu", LEVEL, (0.0, 0.0, 0.0), (0.0, 0.0, G))._replace(**changes)


def imu_deck(**changes: Any) -> Deck:
    return Deck(MovingDeck(source="imu", **changes), GRAVITY, UP)


def deck_at_rest(until: float = 2.0, **changes: Any) -> Deck:
    deck = imu_deck(**changes)
    for k in range(round(100 * until) + 1):
        assert deck.update_imu(still(k * 10_000_000)) is Status.ACCEPTED
    return deck


def sensed(felt: Felt, place: Vector3 = PLACE) -> Vector3:
    """The specific force of a sensor at a place of a deck on which this is felt at the origin."""
    pull, spin, turning = felt
    force = add(cross(turning, place), cross(spin, cross(spin, place)))
    return add(force, pull, -1.0)


def rolling(time: float, rate: float = 0.3, turning: float = -0.2) -> tuple[Imu, Felt]:
    """A deck that accelerates steadily, and turns with constant angular acceleration about its x axis."""
    angle = 0.2 + rate * time + 0.5 * turning * time * time
    orientation = (sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle))
    pull = to_body(axes_of(orientation), (-0.4, 1.5, -G - 1.0))
    felt = Felt(pull, (rate + turning * time, 0.0, 0.0), (turning, 0.0, 0.0))
    return Imu(round(time * SECOND), "imu", orientation, felt.angular, sensed(felt)), felt


@pytest.mark.parametrize("oriented", [True, False])
@pytest.mark.parametrize("turning", [0.0, -0.2])
def test_what_is_felt_at_the_origin_follows_from_a_sensor_elsewhere(oriented: bool, turning: float) -> None:
    deck = imu_deck(imu_position=PLACE)
    for k in range(201):
        imu, felt = rolling(k / 100.0, turning=turning)
        assert deck.update_imu(imu if oriented else imu._replace(orientation=None)) is Status.ACCEPTED
    assert deck.last is not None
    moment = deck.last
    assert moment.frame_id == ""
    assert moment.child_frame_id == "imu"
    assert moment.position == moment.linear == (0.0, 0.0, 0.0)
    assert not oriented or moment.orientation == imu.orientation
    assert moment.felt.angular == felt.angular
    assert moment.felt.turning == pytest.approx(felt.turning, abs=1e-12)
    # Exact where the force of a steady turning grows in a straight line over the window; the curvature of
    # turning x place, 0.2 13 m/s^2 over 0.06 rad, leaves 0.2 13 0.06^2/12.
    assert moment.felt.gravity == pytest.approx(felt.gravity, abs=1e-11 if not turning and oriented else 2e-3)
    later = rolling(2.2, turning=turning)[1]
    assert np.allclose(moment.ahead(0.2), later, atol=1e-11 if not turning and oriented else 3e-3)
    assert np.allclose(ahead(*felt, 0.2), later, atol=1e-13)


def test_without_an_orientation_the_tilt_is_that_in_which_the_mean_force_points_up() -> None:
    deck = imu_deck()
    bias = 0.0005  # rad/s, of a cheap sensor
    for k in range(6000):
        time = k / 100.0
        roll = 0.1 + 0.15 * sin(0.8 * time)
        orientation = (sin(0.5 * roll), 0.0, 0.0, cos(0.5 * roll))
        force = to_body(axes_of(orientation), (0.0, 0.8 * sin(0.8 * time), G + 1.5 * cos(0.8 * time)))
        angular = (0.12 * cos(0.8 * time) + bias, 0.0, bias)
        deck.update_imu(Imu(k * 10_000_000, "imu", None, angular, force))
        if time > 30.0:
            assert deck.last is not None
            off = rotation_between(orientation, deck.last.orientation)
            # The sway of 0.08 g counts with 1/(w 10 s), and the drift for 10 s.
            assert hypot(off[0], off[1]) < 0.08 / 8.0 + 10.0 * bias + 0.003


Sea = Callable[[float], tuple[float, float, float]]


def survival(time: float) -> tuple[float, float, float]:
    """Roll of 35 degrees in 9 s, heave with 0.7 g in 8 s, and a slam of 3 g for 0.15 s at each bottom of it.

    Gives the angle, its rate and the force along the vertical.
    """
    roll, omega = 0.61, 2.0 * pi / 9.0
    heave = 0.7 * G * cos(2.0 * pi / 8.0 * time)
    slam = 3.0 * G if time % 8.0 < 0.15 else 0.0
    return roll * sin(omega * time), roll * omega * cos(omega * time), G + heave + slam


def fast_boat(time: float) -> tuple[float, float, float]:
    """The bow of a fast boat: 0.8 g in 3 s, 5 g for 0.1 s at each landing, and nothing felt before it."""
    phase = time % 3.0
    vertical = 6.0 * G if phase < 0.1 else 0.0 if phase > 2.6 else G + 0.8 * G * cos(2.0 * pi / 3.0 * time)
    return 0.0, 0.0, vertical


def listing(time: float) -> tuple[float, float, float]:
    """Forty degrees of list, and rolling about it."""
    return 0.7 + 0.2 * sin(0.5 * time), 0.1 * cos(0.5 * time), G


def measured(sea: Sea, begin: float, duration: float) -> Iterator[Imu]:
    """What a sensor on the deck measures, at 25 Hz."""
    for k in range(round(25 * duration)):
        angle, rate, vertical = sea(begin + k / 25.0)
        orientation = (sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle))
        force = to_body(axes_of(orientation), (0.0, 0.0, vertical))
        yield Imu(k * 40_000_000, "imu", orientation, (rate, 0.0, 0.0), force)


SEAS = {"calm": lambda time: (0.0, 0.0, G), "survival": survival, "fast boat": fast_boat, "listing": listing}


@pytest.mark.parametrize("begin", np.arange(0.0, 8.0))
@pytest.mark.parametrize("sea", [survival, fast_boat, listing], ids=["survival", "fast boat", "listing"])
def test_no_motion_that_a_deck_survives_makes_its_gravity_wrong(sea: Sea, begin: float) -> None:
    deck = imu_deck()
    for imu in measured(sea, float(begin), 40.0):
        assert deck.update_imu(imu) is Status.ACCEPTED
        answer = deck.at(imu.stamp)
        # Trusted within the first wave, and from then on always.
        assert isinstance(answer, Moment) or (answer is Status.NO_SUPPORT and imu.stamp < 8 * SECOND)


def scaled(force: Vector3, factor: float) -> Vector3:
    x, y, z = force
    return factor * x, factor * y, factor * z


WRONG: dict[str, Callable[[Imu], Vector3]] = {
    "in g": lambda imu: scaled(imu.specific_force, 1.0 / G),
    "without gravity": lambda imu: add(imu.specific_force, to_body(axes_of(imu.orientation or LEVEL), UP), -G),
    "upside down": lambda imu: (imu.specific_force[0], -imu.specific_force[1], -imu.specific_force[2]),
    "on its side": lambda imu: (imu.specific_force[2], imu.specific_force[1], -imu.specific_force[0]),
    "with the other sign": lambda imu: scaled(imu.specific_force, -1.0),
    "in feet": lambda imu: scaled(imu.specific_force, 1.0 / 0.3048),
}


@pytest.mark.parametrize("fault", WRONG)
@pytest.mark.parametrize("sea", ["calm", "survival"])
def test_a_sensor_that_does_not_feel_gravity_is_named_and_never_trusted(fault: str, sea: str) -> None:
    for begin in (0.0, 2.5, 5.0):
        deck = imu_deck()
        for imu in measured(SEAS[sea], begin, 24.0):
            deck.update_imu(imu._replace(specific_force=WRONG[fault](imu)))
            answer = deck.at(imu.stamp)
            if imu.stamp >= 8 * SECOND and sea == "calm":
                assert answer is Status.GRAVITY_WRONG
            if imu.stamp >= 20 * SECOND:
                assert answer is Status.GRAVITY_WRONG
            if sea == "calm":
                assert not isinstance(answer, Moment)


def test_a_sensor_that_goes_wrong_is_named_within_half_a_minute_and_trusted_again_when_it_is_right() -> None:
    deck = deck_at_rest(60.0)
    now = 60 * SECOND
    for k in range(1, 1501):
        status = deck.update_imu(still(now + k * 20_000_000, specific_force=(0.0, 0.0, 1.0)))
    assert status is Status.GRAVITY_WRONG
    assert deck.last is None
    now += 1500 * 20_000_000
    for k in range(1, 1501):
        status = deck.update_imu(still(now + k * 20_000_000))
    assert status is Status.ACCEPTED
    assert deck.last is not None


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"specific_force": (nan, 0.0, 9.81)}, Status.NOT_FINITE),
        ({"specific_force": (0.0, inf, -inf)}, Status.NOT_FINITE),
        ({"angular": (0.0, 1e200, 0.0)}, Status.NOT_FINITE),
        ({"orientation": (0.0, 0.0, 0.0, 0.0)}, Status.BAD_QUATERNION),
        ({"orientation": (0.0, 0.0, inf, 1.0)}, Status.NOT_FINITE),
        ({"frame_id": "other"}, Status.WRONG_FRAME),
        ({"stamp": 2 * SECOND}, Status.STAMP_REPEATED),
        ({"stamp": 2 * SECOND - 1}, Status.STAMP_WENT_BACK),
        ({"angular": (0.3, 0.0, 0.0)}, Status.SUPPORT_JUMPED),
        ({"orientation": turned(LEVEL, (0.0, 0.0, 0.2))}, Status.SUPPORT_JUMPED),
    ],
)
def test_a_bad_message_is_named(changes: dict[str, Any], status: Status) -> None:
    deck = deck_at_rest()
    assert deck.update_imu(still(2 * SECOND + 10_000_000)._replace(**changes)) is status
    if status is not Status.SUPPORT_JUMPED:
        assert deck.update_imu(still(2 * SECOND + 10_000_000)) is Status.ACCEPTED


def test_a_sensor_may_lose_its_orientation_and_find_it_again() -> None:
    deck = deck_at_rest()
    heading = (0.0, 0.0, sin(1.0), cos(1.0))
    for k in range(1, 400):
        oriented = 100 < k < 200 or k > 300
        status = deck.update_imu(still(2 * SECOND + k * 10_000_000, orientation=heading if oriented else None))
        assert status is Status.ACCEPTED
        if deck.last is not None:
            assert deck.last.felt.gravity == pytest.approx(GRAVITY, abs=1e-9)
    assert deck.last is not None
    assert deck.last.orientation == heading


ANY = st.floats(width=64) | st.sampled_from([0.0, G, 1e12, 1e-300, 1e308])
NUMBERS = st.tuples(ANY, ANY, ANY)


@given(NUMBERS, NUMBERS, st.none() | st.tuples(ANY, ANY, ANY, ANY) | st.just(LEVEL), st.integers(1, 400_000_000))
@settings(max_examples=300, deadline=None)
def test_whatever_a_sensor_tells_there_is_a_status_or_numbers(
    force: Vector3, angular: Vector3, orientation: Any, step: int
) -> None:
    deck = imu_deck(imu_position=PLACE)
    deck.learn()
    for k in range(40):
        odd = still(k * step, specific_force=force, angular=angular, orientation=orientation)
        assert isinstance(deck.update_imu(odd if k != 20 else still(k * step)), Status)
        answer = deck.at(k * step + 1)
        if isinstance(answer, Moment):
            numbers = (*answer.orientation, *(one for part in (*answer.felt, *answer.ahead(0.3)) for one in part))
            assert all(map(isfinite, numbers))
        else:
            assert answer is not Status.ACCEPTED
        assert all(np.isfinite(part).all() for part in deck.outlook(5.0)[:4])
