"""The tracker of a moving support against motions that are known exactly, and against bad input."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, hypot, inf, isfinite, nan, pi, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from touchdowns import SAMPLE

from impact_predictor.prediction.checks import PAUSE
from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.scene import MovingDeck
from impact_predictor.prediction.types import Felt, Imu, Moment, Quaternion, Sample, Status, Vector3
from impact_predictor.prediction.vectors import add, axes_of, rotation_between, times, to_body, turned

GRAVITY = (0.0, 0.0, -9.81)
UP = (0.0, 0.0, 1.0)
SECOND = 1_000_000_000
TIMEOUT = MovingDeck().timeout

Motion = Callable[[float], tuple[Sample, Felt]]


def message(time: float, position: Vector3, orientation: Quaternion, velocity: Vector3, angular: Vector3) -> Sample:
    """A message of a deck that moves with a velocity along the world's axes, and an angular one along its own."""
    linear = to_body(axes_of(orientation), velocity)
    return still(round(time * SECOND), position=position, orientation=orientation, linear=linear, angular=angular)


def accelerating(
    rate: float = 0.3,
    turning: float = -0.4,
    axis: Vector3 = (1.0, 0.0, 0.0),
    velocity: Vector3 = (5.0, -1.0, 0.5),
    acceleration: Vector3 = (0.4, -1.5, 2.0),
) -> Motion:
    """A deck with constant acceleration, and constant angular acceleration about one axis, from an odd pose on."""
    start = turned((0.0, 0.0, 0.0, 1.0), (0.1, -0.2, 2.5))

    def at(time: float) -> tuple[Sample, Felt]:
        orientation = turned(start, times(axis, rate * time + 0.5 * turning * time * time))
        position = add(add((100.0, 200.0, 300.0), velocity, time), acceleration, 0.5 * time * time)
        spin = times(axis, rate + turning * time)
        pull = to_body(axes_of(orientation), add(GRAVITY, acceleration, -1.0))
        seen = message(time, position, orientation, add(velocity, acceleration, time), spin)
        return seen, Felt(pull, spin, times(axis, turning))

    return at


def swinging(omega: float, angle: float = 0.1, sway: float = 1.0) -> Motion:
    """A deck that rolls and sways in harmonics."""

    def at(time: float) -> tuple[Sample, Felt]:
        s, c = sin(omega * time), cos(omega * time)
        orientation = (sin(0.5 * angle * s), 0.0, 0.0, cos(0.5 * angle * s))
        spin, turning = (angle * omega * c, 0.0, 0.0), (-angle * omega * omega * s, 0.0, 0.0)
        pull = to_body(axes_of(orientation), (0.0, sway * omega * omega * c, GRAVITY[2]))
        seen = message(time, (0.0, sway * c, 0.0), orientation, (0.0, -sway * omega * s, 0.0), spin)
        return seen, Felt(pull, spin, turning)

    return at


def apart(felt: Felt, wanted: Felt) -> float:
    """The largest difference in any number."""
    return max(abs(a - b) for one, other in zip(felt, wanted, strict=True) for a, b in zip(one, other, strict=True))


def still(stamp: int = 0, **changes: Any) -> Sample:
    return SAMPLE._replace(stamp=stamp, child_frame_id="deck", **changes)


def deck_at_rest(until: float = 1.0, **settings: Any) -> Deck:
    """A deck that has heard messages at 100 Hz for a while."""
    deck = Deck(MovingDeck(**settings), GRAVITY, UP)
    for k in range(round(100 * until) + 1):
        assert deck.update(still(k * 10_000_000)) is Status.ACCEPTED
    return deck


def followed(motion: Motion, times: Any, **settings: Any) -> Deck:
    deck = Deck(MovingDeck(**settings), GRAVITY, UP)
    for time in times:
        assert deck.update(motion(float(time))[0]) is Status.ACCEPTED
    return deck


def moment_at(deck: Deck, stamp: int) -> Moment:
    moment = deck.at(stamp)
    assert isinstance(moment, Moment), moment
    return moment


EVEN = np.arange(101) / 100.0
IRREGULAR = np.round(np.cumsum(np.random.default_rng(3).uniform(0.002, 0.03, 80)), 9)
SLOW = np.arange(12) / 10.24

MOTIONS = {
    "rolling": accelerating(),
    "off axis": accelerating(axis=(0.6, 0.0, 0.8)),
    "not turning": accelerating(0.0, 0.0),
    "in one direction": accelerating(0.2, 0.0, acceleration=(0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("times", [EVEN, IRREGULAR, SLOW], ids=["even", "irregular", "slow"])
@pytest.mark.parametrize("name", MOTIONS)
def test_constant_accelerations_are_found_exactly_at_any_stamp(name: str, times: Any) -> None:
    motion = MOTIONS[name]
    deck, last = followed(motion, times), float(times[-1])
    for time in (last - 0.0929, last - 0.05, last, last + 0.0031, last + 0.2):
        moment = moment_at(deck, round(time * SECOND))
        sample, felt = motion(time)
        assert moment[:3] == (sample.stamp, "world", "deck")
        # A rounding of 5 m/s, times 13.9/(T sqrt(n)) with a few roundings for the irregular stamps.
        assert apart(moment.felt, felt) < 1e-11
        assert apart(moment.ahead(0.1), motion(time + 0.1)[1]) < 1e-11
        assert moment.position == pytest.approx(sample.position, abs=1e-12)  # roundings of 300 m
        assert hypot(*rotation_between(sample.orientation, moment.orientation)) < 1e-13
        assert moment.linear == pytest.approx(sample.linear, abs=1e-12)
        assert moment.gravity == GRAVITY


def test_nothing_is_told_before_three_messages_span_the_window() -> None:
    deck = Deck(MovingDeck(), GRAVITY, UP)
    assert deck.at(0) is Status.NO_SUPPORT
    assert deck.last is None
    for k in range(20):
        assert deck.update(still(k * 10_000_000)) is Status.ACCEPTED
        assert deck.at(k * 10_000_000) is Status.NO_SUPPORT
    deck.update(still(200_000_000))
    assert moment_at(deck, 200_000_000).felt == Felt(GRAVITY, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"position": (nan, 0.0, 0.0)}, Status.NOT_FINITE),
        ({"position": (1e200, 0.0, 0.0)}, Status.NOT_FINITE),
        ({"linear": (0.0, inf, 0.0)}, Status.NOT_FINITE),
        ({"linear": (inf, -inf, 0.0)}, Status.NOT_FINITE),
        ({"angular": (0.0, 0.0, -inf)}, Status.NOT_FINITE),
        ({"orientation": (nan, 0.0, 0.0, 1.0)}, Status.NOT_FINITE),
        ({"orientation": (0.0, 0.0, 0.0, 0.0)}, Status.BAD_QUATERNION),
        ({"orientation": (0.0, 0.0, 0.0, 1.01)}, Status.BAD_QUATERNION),
        ({"frame_id": "map"}, Status.WRONG_FRAME),
        ({"child_frame_id": "hull"}, Status.WRONG_FRAME),
        ({"stamp": SECOND}, Status.STAMP_REPEATED),
        ({"stamp": SECOND - 1}, Status.STAMP_WENT_BACK),
    ],
)
def test_a_bad_message_is_named_and_changes_nothing(changes: dict[str, Any], status: Status) -> None:
    deck = deck_at_rest()
    assert deck.update(still(SECOND + 10_000_000)._replace(**changes)) is status
    assert moment_at(deck, SECOND).stamp == SECOND
    assert deck.update(still(SECOND + 10_000_000)) is Status.ACCEPTED
    moment_at(deck, SECOND + 10_000_000)


def test_a_deck_that_falls_silent_is_stale_after_the_timeout() -> None:
    deck = deck_at_rest()
    last = SECOND
    for k in range(1, 100):
        stamp = last + k * 50_000_000
        answer = deck.at(stamp)
        if stamp - last > TIMEOUT * SECOND:
            assert answer is Status.SUPPORT_STALE
        else:
            assert isinstance(answer, Moment)
    # It comes again elsewhere, which is no jump, and is known when its messages fill the window.
    begin = last + 10 * SECOND
    for k in range(21):
        assert deck.at(begin + k * 10_000_000) is Status.SUPPORT_STALE
        assert deck.update(still(begin + k * 10_000_000, position=(50.0, 0.0, 0.0))) is Status.ACCEPTED
    assert moment_at(deck, begin + 200_000_000).position == (50.0, 0.0, 0.0)


@pytest.mark.parametrize("offset", [-3.0, -0.8, 0.8, 3.0, 1e6])
def test_clocks_that_stay_apart_are_named(offset: float) -> None:
    deck = deck_at_rest()
    answers = []
    for k in range(101, 400):
        now = k * 10_000_000
        assert deck.update(still(now)) is Status.ACCEPTED
        if k % 5 == 0:
            answers.append(deck.at(now + round(offset * SECOND)))
    # The first stamp far ahead might also be that of a deck that has just fallen silent.
    assert set(answers[:1]) <= {Status.SUPPORT_STALE, Status.CLOCKS_APART}
    assert set(answers[1:]) == {Status.CLOCKS_APART}


JUMPS: dict[str, dict[str, Any]] = {
    "place": {"position": (0.0, 0.2, 0.0)},
    "place far away": {"position": (0.0, 2000.0, 0.0)},
    "orientation": {"orientation": turned((0.0, 0.0, 0.0, 1.0), (0.0, 0.05, 0.0))},
    "heading": {"orientation": (0.0, 0.0, 1.0, 0.0)},
    "velocity": {"linear": (0.0, 0.0, 1.0)},
    "angular velocity": {"angular": (0.3, 0.0, 0.0)},
}


@pytest.mark.parametrize("name", JUMPS)
def test_a_jump_is_refused_until_new_messages_fill_a_window(name: str) -> None:
    deck = deck_at_rest()
    jumped = still(**JUMPS[name])
    for k in range(1, 22):
        time = k / 100.0
        moving = jumped._replace(
            stamp=SECOND + k * 10_000_000,
            position=add(jumped.position, jumped.linear, time),
            orientation=turned(jumped.orientation, times(jumped.angular, time)),
        )
        status = deck.update(moving)
        if k < 21:
            assert status is deck.at(moving.stamp) is Status.SUPPORT_JUMPED
            assert deck.last is None
    assert status is Status.ACCEPTED
    gravity = to_body(axes_of(moving.orientation), GRAVITY)
    assert moment_at(deck, moving.stamp).felt.gravity == pytest.approx(gravity, abs=1e-9)
    # Of the time of the jump nothing is told later either.
    assert deck.at(SECOND + 100_000_000) is Status.SUPPORT_JUMPED


def test_a_noisy_source_is_trusted_from_its_first_message_on() -> None:
    rng = np.random.default_rng(4)
    deck = Deck(MovingDeck(), GRAVITY, UP)
    statuses = []
    for k in range(3000):
        place, rotation = (0.03 * rng.standard_normal(3)).tolist(), (0.005 * rng.standard_normal(3)).tolist()
        orientation = turned((0.0, 0.0, 0.0, 1.0), tuple(rotation))
        statuses.append(deck.update(still(k * 10_000_000, position=tuple(place), orientation=orientation)))
    assert set(statuses) == {Status.ACCEPTED}


def test_a_slam_is_no_jump() -> None:
    deck = deck_at_rest()
    for k in range(1, 100):  # 3 g for 0.15 s, and it stays in motion
        time = k / 100.0
        hit = min(time, 0.15)
        moving = still(
            SECOND + k * 10_000_000,
            position=(0.0, 0.0, 15.0 * hit * hit + 30.0 * hit * (time - hit)),
            linear=(0.0, 0.0, 30.0 * hit),
        )
        assert deck.update(moving) is Status.ACCEPTED


def test_a_clock_that_is_set_back_begins_anew() -> None:
    deck = deck_at_rest(2.0)
    assert deck.update(still(2 * SECOND - PAUSE)) is Status.STAMP_WENT_BACK
    moment_at(deck, 2 * SECOND)
    assert deck.update(still(0, position=(100.0, 0.0, 0.0))) is Status.STAMP_WENT_BACK
    for k in range(1, 22):
        assert deck.at(k * 10_000_000) is Status.NO_SUPPORT
        assert deck.update(still(k * 10_000_000, position=(100.0, 0.0, 0.0))) is Status.ACCEPTED
    assert moment_at(deck, 210_000_000).position == (100.0, 0.0, 0.0)


def test_frames_may_change_with_a_new_beginning_only() -> None:
    deck = deck_at_rest()
    for k in range(1, 50):
        assert deck.update(still(SECOND + k * 10_000_000, frame_id="map")) is Status.WRONG_FRAME
    assert deck.at(SECOND + 600_000_000) is Status.SUPPORT_STALE
    for k in range(60, 82):
        assert deck.update(still(SECOND + k * 10_000_000, frame_id="map")) is Status.ACCEPTED
    assert moment_at(deck, SECOND + 810_000_000).frame_id == "map"


@pytest.mark.parametrize(
    ("gravity", "orientation", "wrong"),
    [
        ((0.0, 0.0, 9.81), (0.0, 0.0, 0.0, 1.0), True),
        (GRAVITY, (1.0, 0.0, 0.0, 0.0), True),  # axes forward, right, down
        (GRAVITY, (sin(0.3 * pi), 0.0, 0.0, cos(0.3 * pi)), True),  # capsized
        (GRAVITY, (sin(0.225 * pi), 0.0, 0.0, cos(0.225 * pi)), False),  # a list of 81 degrees
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), True),
    ],
)
def test_a_deck_off_which_everything_would_fall_is_named(gravity: Vector3, orientation: Any, wrong: bool) -> None:
    deck = Deck(MovingDeck(), gravity, UP)
    for k in range(40):
        status = deck.update(still(k * 10_000_000, orientation=orientation))
        assert status is (Status.GRAVITY_WRONG if wrong and k >= 20 else Status.ACCEPTED)
        answer = deck.at(k * 10_000_000)
        expected = Status.NO_SUPPORT if k < 20 else Status.GRAVITY_WRONG if wrong else None
        assert (None if isinstance(answer, Moment) else answer) is expected


def test_messages_of_the_source_that_the_scene_does_not_name_are_refused() -> None:
    assert Deck(MovingDeck(source="imu"), GRAVITY, UP).update(still()) is Status.MALFORMED
    imu = Imu(0, "imu", None, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81))
    assert Deck(MovingDeck(), GRAVITY, UP).update_imu(imu) is Status.MALFORMED


def test_a_forecast_begins_with_what_is_known_and_ends_with_what_is_usual() -> None:
    deck = followed(swinging(0.8), np.arange(1600) / 100.0)  # two waves
    times, *felt, is_learnt, _ = deck.outlook(15.0)
    assert not is_learnt
    assert (times[0], times[-1]) == (0.0, 15.0)
    assert deck.last is not None
    assert apart(Felt(*(tuple(part[0, 0].tolist()) for part in felt)), deck.last.felt) < 1e-14
    gravity, angular, turning = (part[0, -1] for part in felt)
    assert hypot(*angular, *turning) < 1e-30
    # The mean of harmonics is that of gravity turned by up to 0.1 rad, less what the last minute does not even out.
    assert gravity == pytest.approx(GRAVITY, abs=0.15)


def test_a_forecast_of_nothing_known_is_a_level_support_at_rest() -> None:
    deck = Deck(MovingDeck(), GRAVITY, UP)
    times, gravity, angular, turning, *_ = deck.outlook(5.0)
    assert gravity.shape == angular.shape == turning.shape == (1, len(times), 3)
    assert (gravity == GRAVITY).all()
    assert not angular.any()
    assert not turning.any()


ANY = st.floats(width=64) | st.sampled_from([0.0, 1.0, 1e12, 1e-300, 1e308])
NUMBERS = st.tuples(ANY, ANY, ANY)
ODD = st.fixed_dictionaries(
    {"stamp": st.integers(-(2**62), 2**62) | st.integers(0, 2 * SECOND)},
    optional={
        "frame_id": st.sampled_from(["", "world", "map"]),
        "position": NUMBERS,
        "orientation": st.tuples(ANY, ANY, ANY, ANY) | st.sampled_from([(0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)]),
        "linear": NUMBERS,
        "angular": NUMBERS,
    },
)


@given(st.lists(ODD, max_size=12), st.floats(-10.0, 10.0))
@settings(max_examples=300, deadline=None)
def test_whatever_comes_there_is_a_status_or_numbers(odd: list[dict[str, Any]], time: float) -> None:
    deck = deck_at_rest(0.25)
    deck.learn()
    for changes in odd:
        assert isinstance(deck.update(still(**changes)), Status)
        for stamp in (changes["stamp"], changes["stamp"] - 7, 300_000_000):
            check(deck.at(stamp), time)
        assert all(np.isfinite(part).all() for part in deck.outlook(5.0)[:4])


def check(answer: Moment | Status, time: float) -> None:
    """A status that says why, or a moment of finite numbers."""
    if isinstance(answer, Moment):
        numbers = (*answer.position, *answer.orientation, *answer.linear)
        felt = (*answer.felt, *answer.ahead(time))
        assert all(map(isfinite, (*numbers, *(number for part in felt for number in part))))
    else:
        assert answer is not Status.ACCEPTED
