"""The window over which accelerations are found: the one that errs least is taken, and one that errs is named."""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np
import pytest

from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.deck.window import SLOPE, NoiseBalance, slope_weights
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import MovingDeck, Scene, Watching
from impact_predictor.prediction.types import Imu, Sample, Vector3
from impact_predictor.prediction.vectors import add, cross
from impact_predictor.prediction.watch.levels import Level

GRAVITY, UP = (0.0, 0.0, -9.81), (0.0, 0.0, 1.0)
RATE = 20.0
NOISE = 0.02  # m/s, and half of it in rad/s


def samples(omega: float, noise: float, seconds: float) -> list[tuple[Sample, Vector3]]:
    """A deck that heaves by 0.5 m/s and rolls by 0.05 rad/s, and its acceleration."""
    rng, found = np.random.default_rng(0), []
    for k in range(round(seconds * RATE)):
        time = k / RATE
        s, c = sin(omega * time), cos(omega * time)
        half = 0.025 * s / omega
        place, off, turn = (noise * rng.normal(size=(3, 3))).tolist()
        linear = (0.0, 0.5 * c * sin(2.0 * half), 0.5 * c * cos(2.0 * half))
        sample = Sample(
            round(1e9 * time),
            "world",
            "deck",
            position=add((0.0, 0.0, 0.5 * s / omega), tuple(place), 0.25),
            orientation=(sin(half), 0.0, 0.0, cos(half)),
            linear=add(linear, tuple(off)),
            angular=add((0.05 * c, 0.0, 0.0), tuple(turn), 0.5),
            pose_covariance=(),
            twist_covariance=(),
        )
        found.append((sample, (0.0, 0.0, -0.5 * omega * s)))
    return found


def error(window: float, omega: float, noise: float) -> float:
    """Of the acceleration in the second minute, as root mean square."""
    deck, squares = Deck(MovingDeck(window=window), GRAVITY, UP), []
    for sample, acceleration in samples(omega, noise, 120.0):
        deck.update(sample)
        if sample.stamp > 60e9 and deck.last is not None:
            found = add(GRAVITY, deck.last.felt.gravity, -1.0)
            # Along the deck's axes gravity itself swings by less than this is wrong.
            squares.append((found[2] - acceleration[2]) ** 2)
    return float(np.sqrt(np.mean(squares)))


@pytest.mark.parametrize("omega", [0.6, 1.5])
@pytest.mark.parametrize("noise", [0.002, NOISE])
def test_the_window_that_follows_the_noise_errs_hardly_more_than_the_best_given_one(omega: float, noise: float) -> None:
    best = min(error(window, omega, noise) for window in (0.2, 0.3, 0.5, 0.7, 1.0, 1.5))
    assert error(0.0, omega, noise) < 1.3 * best


@pytest.mark.parametrize("window", [0.0, 0.2])
def test_a_deck_that_does_not_move_at_all_has_no_noise_and_hardly_an_error(window: float) -> None:
    deck, still = Deck(MovingDeck(window=window), GRAVITY, UP), (0.0, 0.0, 0.0)
    for sample, _ in samples(1.0, 0.0, 20.0):
        at_rest = sample._replace(position=still, orientation=(0.0, 0.0, 0.0, 1.0), linear=still, angular=still)
        deck.update(at_rest)
    assert max(deck.errors) < 0.01
    assert not deck.doubts()


def test_without_noise_the_window_is_as_short_as_it_can_be() -> None:
    deck = Deck(MovingDeck(window=0.0), GRAVITY, UP)
    for sample, _ in samples(1.5, 0.0, 60.0):
        deck.update(sample)
    assert 0.0 < deck.window < 3.5 / RATE


@pytest.mark.parametrize(("window", "wrong"), [(0.2, "short"), (0.0, ""), (2.0, "long"), (0.8, "")])
def test_a_window_that_errs_is_named_with_one_that_would_do(window: float, wrong: str) -> None:
    deck = Deck(MovingDeck(window=window), GRAVITY, UP)
    for sample, _ in samples(1.5, NOISE, 60.0):
        deck.update(sample)
    doubts = deck.doubts()
    assert len(doubts) == bool(wrong)
    for doubt in doubts:
        assert f"support.window of {window:g} s is too {wrong}" in doubt
        told = float(doubt.partition("set that to ")[2].partition(",")[0])
        assert error(told, 1.5, NOISE) < 0.5 * error(window, 1.5, NOISE)


def test_the_window_of_an_inertial_sensor_follows_its_noise() -> None:
    rng, deck = np.random.default_rng(0), Deck(MovingDeck(source="imu", window=0.0), GRAVITY, UP)
    squares = []
    for k in range(2400):
        felt = 9.81 + 0.5 * sin(0.05 * k)
        force = add((0.0, 0.0, felt), tuple(rng.normal(size=3).tolist()), 0.5)
        deck.update_imu(Imu(k * 50_000_000, "imu", (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), force))
        if k > 1200 and deck.last is not None:
            squares.append((-deck.last.felt.gravity[2] - felt) ** 2)
    assert np.sqrt(np.mean(squares)) < 0.25


UNIT = Scene(
    mass=6000.0,
    inertia=((11700.0, 0.0, 0.0), (0.0, 11700.0, 0.0), (0.0, 0.0, 5760.0)),
    friction=0.45,
    points=tuple((x, y, -2.1) for x in (-1.2, 1.2) for y in (-1.2, 1.2)),
    tolerance=0.0,
    contact_time=0.002,
    place=(0.0, 3.0, 2.1),
    deck=MovingDeck(window=0.0),
    watching=Watching(),
)


def watched(scene: Scene, scatter: float = 0.0) -> tuple[int, int, tuple[str, ...]]:
    """Errors and announcements of a unit that stands on a noisy deck for a minute, and what is doubted; its height
    scatters by so many m.
    """
    monitor, errors, announced, rng = Monitor({"": scene}), 0, 0, np.random.default_rng(1)
    exact = samples(1.5, 0.0, 60.0)
    for (sample, _), (true, _) in zip(samples(1.5, NOISE, 60.0), exact, strict=True):
        monitor.update_support(sample)
        s = 2.0 * true.orientation[0] * true.orientation[3]
        y, z = UNIT.place[1:]
        c = (1.0 - s * s) ** 0.5
        unit = true._replace(
            child_frame_id="unit",
            position=add(true.position, (0.0, c * y - s * z, s * y + c * z + rng.normal(0.0, scatter))),
            linear=add(true.linear, cross(true.angular, UNIT.place)),
        )
        announced += monitor.update("", unit).touchdown is not None
        errors += any(report.level is Level.ERROR for report in monitor.reports())
    return errors, announced, monitor.doubts()


def test_noise_of_a_deck_raises_no_level_of_a_unit_that_stands_and_announces_nothing() -> None:
    assert watched(UNIT) == (0, 0, ())


def test_a_narrow_unit_whose_pose_is_noisy_stands_on_the_deck_and_not_below_it() -> None:
    narrow = tuple((x, y, -2.1) for x in (-0.3, 0.3) for y in (-0.3, 0.3))
    assert watched(UNIT._replace(points=narrow), 0.02)[0] == 0


def test_a_tolerance_below_the_scatter_of_points_that_stand_is_named() -> None:
    _, _, (doubt,) = watched(UNIT._replace(tolerance=1e-3))
    assert "contact.tolerance of 0.001: set it to 0.0" in doubt


@pytest.mark.parametrize("x", [[-1.0, -0.6, 0.1, 0.3, 1.0], [-1.0, 1.0, 0.9, 0.8], [-1.0, 0.0, 1.0]])
def test_the_weights_of_a_slope_tell_that_of_every_parabola_at_its_end(x: list[float]) -> None:
    weights = np.array(slope_weights(x))
    assert [weights @ np.power(x, k) for k in range(3)] == pytest.approx([0.0, 1.0, 2.0], abs=1e-12)


def test_the_weights_of_two_times_tell_the_slope_of_a_line() -> None:
    assert slope_weights([-1.0, -1.0, 1.0]) == [-0.25, -0.25, 0.5]


def test_how_fast_what_is_found_changes_is_told_apart_from_its_noise() -> None:
    rng, balance, span, curvature = np.random.default_rng(0), NoiseBalance(SLOPE), 1.0, 0.08
    for k in range(4000):
        balance.hear(k * 50_000_000, tuple(rng.normal(0.0, NOISE, 3).tolist()))
    square = SLOPE.noise * NOISE**2 * 0.05 / span**SLOPE.power
    times, told = np.cumsum([1.0, 1.5] * 2000), []
    for time in times.tolist():
        found = 0.5 * curvature * time * time + rng.normal(0.0, sqrt(square), 3)
        balance.found(round(1e9 * time), tuple(found.tolist()), span)
        # In a window of 10 s hardly anything but the lag errs.
        told.append((balance.error(10.0) / (SLOPE.lag * 10.0**2)) ** 2)
    # Noise makes second derivatives, uncorrected, as large again and half more; 6 % is what so many draws leave.
    assert np.mean(told) == pytest.approx(curvature**2, rel=0.15)


def coarse(rate: float, asked: float, noise: float = 0.0) -> tuple[str, ...]:
    """What is doubted of a deck of so many messages a second, at which a body is sampled so often."""
    deck = Deck(MovingDeck(window=0.0), GRAVITY, UP)
    every = round(RATE / rate)
    told = [sample for sample, _ in samples(1.5, noise, 60.0)][::every]
    for sample in told:
        deck.update(sample)
        for k in range(round(asked / rate)):
            deck.at(sample.stamp + round(1e9 * k / asked))
    return deck.doubts()


def test_a_deck_that_is_told_too_seldom_for_its_units_is_named_with_the_rate_that_is_needed() -> None:
    (doubt,) = coarse(rate=5.0, asked=50.0)
    assert "come every 0.2 s" in doubt
    needed = float(doubt.partition("; send ")[2].partition(" ")[0])
    assert 5.0 < needed <= RATE
    assert not coarse(rate=RATE, asked=50.0)


def test_units_that_are_sampled_with_a_seldom_told_deck_miss_nothing_of_it() -> None:
    assert not coarse(rate=5.0, asked=5.0)


def test_noise_of_a_deck_is_not_taken_for_too_few_messages() -> None:
    assert not coarse(rate=RATE, asked=100.0, noise=NOISE)
