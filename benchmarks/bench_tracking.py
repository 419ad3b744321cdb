"""How well a moving deck is tracked, how far ahead its motion is known, and what a message costs.

    python benchmarks/bench_tracking.py [--seconds 600]

Decks: the recorded one of examples/vessel_deck (10.24 Hz), and two in simulated JONSWAP seas from the side (20 Hz).
Errors are root mean squares over a run; those of predictions are parts of the standard deviation of what is predicted,
so that 1 is no better than to expect the mean.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from time import perf_counter_ns
from typing import NamedTuple

import click
import harmonics
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from impact_predictor.bags.read import read_messages
from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.scene import MovingDeck
from impact_predictor.prediction.types import Felt, Imu, Sample, Vector3
from impact_predictor.ros.messages import IMU, ODOMETRY, decode_imu, decode_odometry
from impact_predictor.scenarios.deck.sea import SeaState, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in
from impact_predictor.scenarios.sensors import Odometer

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[1]
BAG = ROOT / "examples/vessel_deck"
UP: Vector3 = (0.0, 0.0, 1.0)
SHIP = Vessel(length=90.0, breadth=16.0, draught=5.0, roll_period=11.0, roll_damping=0.1, height=8.0)
LEADS = (0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0)
WINDOWS = (0.1, 0.2, 0.5, 1.0)
NOISES = (0.0, 0.002, 0.02)
"""m/s of each velocity; angular velocities have half of it in rad/s."""
SETTLING = 120.0
"""s until forecasts are judged: by then the sea is learnt."""


class Record(NamedTuple):
    """A deck: its messages, and what is felt on it at their stamps, (n, 9) as gravity, angular and turning."""

    name: str
    gravity: Vector3
    samples: list[Sample]
    felt: Array


def recorded() -> tuple[Record, list[Imu]]:
    """The recorded deck; what is felt on it is its own sensor's, with angular accelerations by central differences."""
    samples, sensed = [], []
    for topic, _, data in read_messages(BAG, {"/deck/odom": ODOMETRY, "/deck/imu": IMU}):
        if topic == "/deck/odom":
            samples.append(decode_odometry(data))
        else:
            sensed.append(decode_imu(data))
    times = np.array([imu.stamp for imu in sensed]) / 1e9
    angular = np.array([imu.angular for imu in sensed])
    force = np.array([imu.specific_force for imu in sensed])
    felt = np.concatenate([-force, angular, np.gradient(angular, times, axis=0)], axis=1)
    return Record("recorded vessel, 10.24 Hz", (0.0, 0.0, -9.80665), samples, felt), sensed


def simulated(name: str, vessel: Vessel, sea: SeaState, seconds: float) -> Record:
    times = np.arange(0.0, seconds, 0.05)
    deck = deck_in(waves_of(sea, seed=1), vessel)
    state = deck.at(times)
    samples = list(Odometer("world", "deck").samples([round(1e9 * time) for time in times.tolist()], state.poses))
    felt = np.hstack([state.gravity, state.poses.angular, state.turning])
    return Record(name, (0.0, 0.0, -deck.gravity), samples, felt)


def noisy(samples: Sequence[Sample], noise: float) -> list[Sample]:
    rng = np.random.default_rng(0)
    off = rng.standard_normal((len(samples), 6)) * np.repeat([noise, 0.5 * noise], 3)
    return [
        sample._replace(
            linear=tuple((off[i, :3] + sample.linear).tolist()), angular=tuple((off[i, 3:] + sample.angular).tolist())
        )
        for i, sample in enumerate(samples)
    ]


def rms(errors: Array) -> float:
    return float(np.sqrt(np.square(errors).sum(-1).mean()))


def tracking(record: Record, window: float, noise: float) -> tuple[float, float]:
    """Error of gravity (m/s^2) and of angular acceleration (rad/s^2) as the tracker estimates them."""
    deck = Deck(MovingDeck(window=window), record.gravity, UP)
    errors = []
    for sample, felt in zip(noisy(record.samples, noise), record.felt, strict=True):
        deck.update(sample)
        if deck.last is not None:
            errors.append(np.concatenate(deck.last.felt) - felt)
    found = np.array(errors)
    return rms(found[:, :3]), rms(found[:, 6:])


Forecast = Callable[[Deck, Array], Array]
"""Gravity felt and angular velocity, (n, 6), at times in s after a deck's last message."""


def by_persistence(deck: Deck, times: Array) -> Array:
    assert deck.last is not None
    return np.tile(np.concatenate(deck.last.felt[:2]), (len(times), 1))


def by_ahead(deck: Deck, times: Array) -> Array:
    last = deck.last
    assert last is not None
    return np.array([np.concatenate(last.ahead(time)[:2]) for time in times.tolist()])


def by_outlook(deck: Deck, times: Array) -> Array:
    there, gravity, angular, *_ = deck.outlook(LEADS[-1] + 1.0)
    middle = np.concatenate([gravity.mean(0), angular.mean(0)], axis=1)
    return np.stack([np.interp(times, there, column) for column in middle.T], 1)


def by_harmonics(window: float) -> Forecast:
    rows: deque[Array] = deque(maxlen=round(window / harmonics.SECONDS))
    steps = harmonics.SECONDS * np.arange(harmonics.REACH + 1)

    def forecast(deck: Deck, times: Array) -> Array:
        assert deck.last is not None
        rows.append(np.concatenate(deck.last.felt[:2]))
        if len(rows) < harmonics.ORDER or not times.size:
            return np.zeros((0, 6))
        found = harmonics.predicted(np.array(rows))
        return np.stack([np.interp(times, steps, column) for column in found.T], 1)

    return forecast


METHODS: dict[str, Callable[[], Forecast]] = {
    "what is": lambda: by_persistence,
    "constant accelerations": lambda: by_ahead,
    "the same, fading to the mean": lambda: by_outlook,
    "harmonics of 20 s": lambda: by_harmonics(20.0),
    "harmonics of 60 s": lambda: by_harmonics(60.0),
    "learnt": lambda: by_outlook,
}
"""The mean has the error 1."""


def predicting(record: Record, name: str, noise: float, window: float) -> tuple[Array, float]:
    """Errors (2, leads) of gravity and of angular velocity, as parts of their deviations, and microseconds of each."""
    deck, method = Deck(MovingDeck(window=window), record.gravity, UP), METHODS[name]()
    if name == "learnt":
        deck.learn()
    stamps = np.array([sample.stamp for sample in record.samples]) / 1e9
    leads, due, spent = np.array(LEADS), stamps[0] + SETTLING, list[int]()
    errors, row = [], stamps[0] + window
    for sample, now in zip(noisy(record.samples, noise), stamps.tolist(), strict=True):
        deck.update(sample)
        if deck.last is None or now < row:
            continue
        row += harmonics.SECONDS
        if due <= now <= stamps[-1] - LEADS[-1]:
            due += 1.0
            later = np.stack([np.interp(now + leads, stamps, column) for column in record.felt[:, :6].T], 1)
            begin = perf_counter_ns()
            found = method(deck, leads)
            spent.append(perf_counter_ns() - begin)
            errors.append(found - later)
        elif name.startswith("harmonics"):
            method(deck, np.zeros(0))
    found, deviation = np.array(errors), record.felt.std(0)
    return np.array(
        [
            [rms(found[:, i, part]) / float(np.sqrt(np.square(deviation[part]).sum())) for i in range(len(LEADS))]
            for part in (slice(0, 3), slice(3, 6))
        ]
    ), float(np.median(spent)) / 1e3


def costs(record: Record, learns: bool) -> tuple[float, float, float, float]:
    """Least microseconds over runs: a message in the mean and the dearest of them, a moment, and what is ahead."""
    times: list[list[int]] = []
    samples = record.samples[:6000]
    for _ in range(3):
        deck, took = Deck(MovingDeck(), record.gravity, UP), []
        if learns:
            deck.learn()
        for sample in samples:
            begin = perf_counter_ns()
            deck.update(sample)
            took.append(perf_counter_ns() - begin)
        times.append(took)
    update = np.array(times).min(0) / 1e3
    moments, aheads = [], []
    for _ in range(300):
        begin = perf_counter_ns()
        moment = deck.at(samples[-1].stamp + 3_000_000)
        moments.append(perf_counter_ns() - begin)
        assert not isinstance(moment, int)
        begin = perf_counter_ns()
        moment.ahead(0.1)
        aheads.append(perf_counter_ns() - begin)
    return float(update.mean()), float(update.max()), min(moments) / 1e3, min(aheads) / 1e3


def table(title: str, *columns: str) -> Table:
    made = Table(*columns, title=title, title_justify="left")
    for column in made.columns[1:]:
        column.justify = "right"
    return made


def check_of_sensor(record: Record, sensed: Sequence[Imu], console: Console) -> None:
    """The recorded deck by its poses and by its sensor."""
    shown = table(
        "Recorded deck: what is felt, against the sensor's own message (root mean square)",
        *("tracked from", "gravity, m/s^2", "angular, rad/s"),
    )
    ways: tuple[tuple[str, str, bool], ...] = (
        ("odometry", "odom", True),
        ("sensor", "imu", True),
        ("sensor without orientation", "imu", False),
    )
    for name, source, oriented in ways:
        deck, errors = Deck(MovingDeck(source=source), record.gravity, UP), []
        for sample, imu, felt in zip(record.samples, sensed, record.felt, strict=True):
            if source == "odom":
                deck.update(sample)
            else:
                deck.update_imu(imu if oriented else imu._replace(orientation=None))
            if deck.last is not None:
                errors.append(np.concatenate(deck.last.felt) - felt)
        found = np.array(errors)
        shown.add_row(name, f"{rms(found[:, :3]):.6f}", f"{rms(found[:, 3:6]):.6f}")
    console.print(shown)


@click.command()
@click.option(
    "--seconds",
    type=click.FloatRange(min=200.0),
    default=600.0,
    show_default=True,
    help="How long the simulated seas last.",
)
def main(seconds: float) -> None:
    """Print the tables."""
    console = Console(width=130 if not sys.stdout.isatty() else None)
    vessel, sensed = recorded()
    pontoon = simulated("pontoon, 5 s waves of 1 m", Vessel(), SeaState(1.0, 5.0), seconds)
    ship = simulated("ship, 9 s waves of 4 m", SHIP, SeaState(4.0, 9.0), seconds)
    check_of_sensor(vessel, sensed, console)

    windows = table(
        "Tracking: error of gravity, m/s^2, and of angular acceleration, rad/s^2",
        *("deck", "noise, m/s", *(f"{window:g} s" for window in WINDOWS)),
    )
    cases = list(product((vessel, pontoon, ship), NOISES))
    for record, noise in track(cases, "tracking", console=Console(stderr=True), transient=True):
        errors = [tracking(record, window, noise) for window in WINDOWS]
        windows.add_row(record.name, f"{noise:g}", *(f"{felt:.4f}, {turning:.4f}" for felt, turning in errors))
    console.print(windows)

    for noise, window in ((0.0, 0.2), (0.02, 1.0)):
        shown = table(
            f"Forecasts, noise {noise:g} m/s, window {window:g} s: error by lead time, part of the deviation",
            *("deck", "method", "of", *(f"{lead:g} s" for lead in LEADS), "us"),
        )
        for record, name in track(
            list(product((vessel, pontoon, ship), METHODS)), "forecasts", console=Console(stderr=True), transient=True
        ):
            found, spent = predicting(record, name, noise, window)
            for of, row in zip(Felt._fields, found, strict=False):
                shown.add_row(record.name, name, of, *(f"{error:.3f}" for error in row), f"{spent:.0f}")
        console.print(shown)

    spent_on = table("Microseconds, deck at 20 Hz", "the sea", "message", "dearest", "moment", "ahead")
    for learns in (False, True):
        spent_on.add_row("is learnt" if learns else "is not", *(f"{cost:.1f}" for cost in costs(ship, learns)))
    console.print(spent_on)


if __name__ == "__main__":
    main()
