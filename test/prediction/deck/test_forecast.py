"""The forecast of a support in waves: on the recorded vessel and on sums of waves, how sure it says it is, and what it
does while it knows too little.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pytest
from vessel import read_vessel

from impact_predictor.prediction.deck.forecast import LEADS, REACH, STEP, DeckOutlook, ForecastStatus, WaveForecast
from impact_predictor.prediction.deck.motion import LEVEL, SupportState
from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.scene import MovingDeck
from impact_predictor.prediction.types import Sample
from impact_predictor.prediction.vectors import add, axes_of, composed, to_body, turned

GRAVITY = (0.0, 0.0, -9.81)
UP = (0.0, 0.0, 1.0)
NOISE = {"linear": 0.02, "angular": 0.01}


def noisy(samples: list[Sample]) -> Iterator[Sample]:
    rng = np.random.default_rng(1)
    for sample in samples:
        yield sample._replace(
            **{name: tuple(np.add(getattr(sample, name), rng.normal(0.0, s, 3))) for name, s in NOISE.items()}
        )


def outlooks(samples: list[Sample], every: int) -> Iterator[tuple[int, DeckOutlook]]:
    deck = Deck(MovingDeck(window=1.0), GRAVITY, UP)
    deck.learn()
    for number, sample in enumerate(samples):
        deck.update(sample)
        if number % every == 0 and (outlook := deck.outlook(10.0)).is_learnt:
            yield number, outlook


class Judgement(NamedTuple):
    """Error of the gravity felt some time ahead, as a part of its deviation; that of keeping the one of now; and the
    part of the truth that the middle two thirds of the courses hold.
    """

    error: float
    persistence: float
    held: float


def judged(samples: list[Sample], true: list[Sample], felt: np.ndarray, times: Sequence[float]) -> list[Judgement]:
    """How right the outlooks are at some times ahead, in s."""
    stamps = np.array([sample.stamp for sample in true]) / 1e9
    found: list[list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = [[] for _ in times]
    for number, outlook in outlooks(samples, 7):
        for ahead, rows in zip(times, found, strict=True):
            then = stamps[number] + ahead
            if then < stamps[-1]:
                courses = np.array(
                    [[np.interp(ahead, outlook.times, one) for one in course.T] for course in outlook.gravity]
                )
                truth = np.array([np.interp(then, stamps, one) for one in felt.T])
                low, high = np.quantile(courses, [1 / 6, 5 / 6], axis=0)
                rows.append((courses.mean(axis=0) - truth, felt[number] - truth, (low < truth) & (truth < high)))
    deviation = np.sqrt(np.square(felt - felt.mean(axis=0)).mean())
    judgements = []
    for rows in found:
        errors, kept, held = (np.array(column) for column in zip(*rows, strict=True))
        error, persistence = (float(np.sqrt(np.square(one).mean())) / deviation for one in (errors, kept))
        judgements.append(Judgement(error, persistence, float(held.mean())))
    return judgements


@pytest.fixture(scope="module")
def record() -> tuple[list[Sample], np.ndarray]:
    pairs = read_vessel()
    return [sample for sample, _ in pairs], -np.array([imu.specific_force for _, imu in pairs])


def test_a_noisy_record_is_forecast_better_than_by_what_is_or_what_is_usual(
    record: tuple[list[Sample], np.ndarray],
) -> None:
    samples, felt = record
    found = judged(list(noisy(samples)), samples, felt, (1.0, 2.0, 5.0))
    for judgement, allowed in zip(found, (0.3, 0.35, 0.6), strict=True):
        assert judgement.error < allowed  # of the deviation, which the mean errs by
        assert judgement.error < judgement.persistence
        assert 0.5 < judgement.held < 0.9  # of two thirds


def test_nothing_is_forecast_before_the_sea_is_learnt_nor_right_after_a_jump(
    record: tuple[list[Sample], np.ndarray],
) -> None:
    samples, _ = record
    first = next(number for number, _ in outlooks(samples, 1))
    assert 60.0 < (samples[first].stamp - samples[0].stamp) / 1e9 < 120.0
    deck = Deck(MovingDeck(), GRAVITY, UP)
    deck.learn()
    moved = [one._replace(position=tuple(np.add(one.position, (50.0, 0.0, 0.0)))) for one in samples[first + 100 :]]
    learnt = []
    for sample in samples[: first + 100] + moved[:200]:
        deck.update(sample)
        learnt.append(deck.outlook(5.0).is_learnt)
    assert learnt[first + 99]
    assert not any(learnt[first + 100 : first + 175])  # 8 s of new rows are needed
    assert learnt[-1]  # but what was learnt of the sea is not lost


def state(time: float, felt: tuple[float, float, float], angular: tuple[float, float, float]) -> SupportState:
    axes = axes_of((0.0, 0.0, 0.0, 1.0))
    return SupportState(
        stamp=round(time * 1e9), orientation=(0.0, 0.0, 0.0, 1.0), axes=axes, angular=angular, felt=felt
    )


def test_waves_of_one_period_are_forecast_as_they_go_on() -> None:
    forecast, w = WaveForecast(GRAVITY, is_felt=True), 2.0 * np.pi / 7.0

    def roll(time: float) -> float:
        return 0.2 * float(np.sin(w * time))

    times = np.arange(0.0, 300.0, 0.04)
    for time in times:
        felt = to_body(axes_of((np.sin(0.5 * roll(time)), 0.0, 0.0, np.cos(0.5 * roll(time)))), GRAVITY)
        forecast.add(state(float(time), felt, (0.2 * w * float(np.cos(w * time)), 0.0, 0.0)))
    outlook = forecast.outlook(round(times[-1] * 1e9))
    assert outlook.times[-1] > 9.5
    wanted = [[0.0, -9.81 * np.sin(roll(times[-1] + t)), -9.81 * np.cos(roll(times[-1] + t))] for t in outlook.times]
    assert outlook.gravity.mean(axis=0) == pytest.approx(np.array(wanted), abs=0.1)  # of 1.9 m/s^2
    turning = [-0.2 * w * w * np.sin(w * (times[-1] + t)) for t in outlook.times]
    assert outlook.turning.mean(axis=0)[:, 0] == pytest.approx(np.array(turning), abs=0.02)  # of 0.16 rad/s^2


def test_a_record_is_forecast_alike_wherever_within_a_step_it_begins() -> None:
    noise, told = np.random.default_rng(0).normal(0.0, 0.05, (2000, 6)), []
    for begin in (1, 4):
        forecast = WaveForecast(GRAVITY, is_felt=True)
        for k in range(begin, 2000):
            wave = 2.0 * np.pi * 0.05 * k / 7.0
            seen = noise[k] + (0.0, np.sin(wave), -9.81, 0.2 * np.cos(wave), 0.0, 0.0)
            forecast.add(state(0.05 * k, tuple(seen[:3]), tuple(seen[3:])))
        told.append(forecast.outlook(100 * 10**9).gravity.mean(axis=0))
    assert told[0] == pytest.approx(told[1], abs=1e-9)


@pytest.mark.parametrize("is_felt", [False, True])
def test_roll_and_pitch_are_told_fifteen_seconds_ahead_with_how_unsure_they_are(is_felt: bool) -> None:
    forecast, w = WaveForecast(GRAVITY, is_felt), 2.0 * np.pi / 7.0

    def angles(time: float) -> tuple[float, float]:
        """Roll with port up, and pitch with the bow down."""
        return 0.1 * float(np.sin(w * time)), 0.05 * float(np.cos(0.9 * w * time))

    for time in np.arange(0.0, 250.0, 0.05).tolist():
        (roll, pitch), (later, other) = angles(time), angles(time + 1e-6)
        orientation = composed(turned(LEVEL, (0.0, pitch, 0.0)), turned(LEVEL, (roll, 0.0, 0.0)))
        seen = state(time, GRAVITY, ((later - roll) * 1e6, (other - pitch) * 1e6, 0.0))
        seen.axes, seen.felt = axes_of(orientation), GRAVITY
        forecast.add(seen)
    ahead = forecast.outlook(250 * 10**9).at(LEADS)
    assert ahead.angles is not None
    wanted = np.array([angles(250.0 + lead) for lead in LEADS])
    assert ahead.angles.mean(axis=0) == pytest.approx(wanted, abs=0.02)
    assert (ahead.angles.std(axis=0) < 0.03).all()
    assert LEADS[-1] == 15.0
    assert min(forecast.skills["roll"].skill[:4]) > 0.8
    assert min(forecast.skills["pitch"].skill[:4]) > 0.8


def test_a_deck_at_rest_stays_at_rest() -> None:
    forecast = WaveForecast(GRAVITY, is_felt=False)
    for time in np.arange(0.0, 120.0, 0.1):
        forecast.add(state(float(time), GRAVITY, (0.0, 0.0, 0.0)))
    outlook = forecast.outlook(120 * 10**9)
    assert outlook.gravity.reshape(-1, 3) == pytest.approx(np.tile(GRAVITY, (outlook.gravity.size // 3, 1)))
    assert not outlook.angular.any()


@pytest.mark.parametrize("speed", [10.0, 1e4, 1e9])
def test_a_velocity_that_stays_hides_nothing_however_large_it_is(speed: float) -> None:
    forecast = WaveForecast(GRAVITY, is_felt=False)
    for time in np.arange(0.0, 120.0, 0.1):
        seen = state(float(time), GRAVITY, (0.0, 0.0, 0.0))
        seen.velocity = speed, 0.0, 0.0
        forecast.add(seen)
    assert forecast.status is ForecastStatus.TRUSTED
    gravity = forecast.outlook(120 * 10**9).gravity
    assert gravity.reshape(-1, 3) == pytest.approx(np.tile(GRAVITY, (gravity.size // 3, 1)), abs=1e-15 * speed)


@pytest.mark.parametrize("speed", [1e4, 1e9, 1e150])
def test_a_leap_whose_squares_hide_all_else_is_no_error(speed: float) -> None:
    forecast = WaveForecast(GRAVITY, is_felt=False)
    with np.errstate(over="ignore", invalid="ignore"):
        for time in np.arange(0.0, 120.0, 0.1):
            seen = state(float(time), GRAVITY, (0.0, 0.0, 0.0))
            seen.velocity = speed if time > 3.0 else 0.0, 0.0, 0.0
            forecast.add(seen)
    assert forecast.status is not ForecastStatus.TRUSTED


def test_a_forecast_stays_finite_where_nothing_repeats() -> None:
    forecast, rng = WaveForecast(GRAVITY, is_felt=True), np.random.default_rng(0)
    level = np.zeros(6)
    for time in np.arange(0.0, 200.0, 0.1):
        level = 1.02 * level + rng.normal(size=6)  # it grows and grows
        forecast.add(state(float(time), tuple(level[:3]), tuple(level[3:])))
    outlook = forecast.outlook(200 * 10**9)
    assert all(np.isfinite(part).all() for part in outlook)
    assert len(outlook.times) == pytest.approx(REACH, abs=3)
    assert np.diff(outlook.times) == pytest.approx(STEP / 1e9)


def sea(seconds: float, noise: float, change: float = 0.0) -> Iterator[SupportState]:
    """A deck in waves about 7 s long, from which on a `change` it is thrown about."""
    rng = np.random.default_rng(3)
    waves = [(2.0 * np.pi / 7.0 * (1.0 + 0.05 * k), phase) for k, phase in enumerate(rng.uniform(0.0, 6.0, 5))]
    for time in np.arange(0.0, seconds, 0.05).tolist():
        roll = 0.02 * sum(float(np.sin(w * time + phase)) for w, phase in waves)
        sway = 0.0 if not 0.0 < change <= time else 1.0
        felt = add((0.0, 0.0, -9.81), (0.0, 9.81 * roll, 0.0))
        yield state(time, add(felt, tuple(rng.normal(size=3).tolist()), noise + sway), (0.0, 0.0, 0.0))


def test_the_skill_of_forecasts_is_that_of_errors_against_what_came() -> None:
    forecast, told, statuses = WaveForecast(GRAVITY, is_felt=True), [], []
    states = list(sea(400.0, 0.02))
    for k, one in enumerate(states):
        forecast.add(one)
        statuses.append(forecast.status)
        if k > 6000 and k % 40 == 0:
            told.append((k, forecast.outlook(one.stamp)))
    assert [*dict.fromkeys(statuses)] == [ForecastStatus.LEARNING, ForecastStatus.TRUSTED]
    skill = forecast.skills["felt"]
    errors = []
    for k, outlook in told[:-3]:
        there = np.interp(5.0, outlook.times, outlook.gravity.mean(0)[:, 1])
        errors.append(there - states[k + 100].felt[1])
    error = float(np.sqrt(np.mean(np.square(errors))))
    assert error < 3.0 * skill.forecast[2] + 0.02
    # Waves of a sum of sines: half of the time what is comes with the other sign.
    assert skill.persistence[2] > skill.mean[2] > 3.0 * skill.forecast[2]
    assert skill.skill[2] > 0.9


def test_what_cannot_be_foreseen_is_expected_to_be_as_on_the_mean() -> None:
    """Noise alone: the least squares of so few rows forecast 0.41 of its deviation, all of that by chance."""
    forecast, rng, expected = WaveForecast(GRAVITY, is_felt=True), np.random.default_rng(4), []
    for k in range(1, 600):
        felt, angular = rng.normal(size=(2, 3)).tolist()
        forecast.add(state(0.25 * k, add(GRAVITY, tuple(felt)), tuple(angular)))
        if k > 400 and k % 20 == 0:
            ahead = forecast.outlook(k * STEP).gravity[:, 4:]
            expected.append(ahead.mean(axis=0) - GRAVITY)
    assert np.std(expected) < 0.3 * np.std(ahead - ahead.mean(axis=0))


def test_a_forecast_that_is_no_better_than_simple_answers_is_not_trusted_and_says_so() -> None:
    noise = WaveForecast(GRAVITY, is_felt=True)
    for one in sea(300.0, 0.02, change=100.0):
        noise.add(one)
    assert noise.status is ForecastStatus.NO_SKILL
    noise.clear()
    assert noise.status is ForecastStatus.INTERRUPTED
