"""How early and how often the watch over a deck warns, in eight seas, beside what simple rules would do.

    python benchmarks/deck_warnings.py [--hours 0.45] [--seed 5000] [--jobs 2]

A ship of 60 m meets seas of 6 to 14 s from the side, the quarter and ahead. Six units stand on its deck, as rough or as
broad below as their events are to come about so often; two of them never use more than 0.7 of their margins. They move
in three dimensions on springs and friction, which share no rule with the watch. Deck and units are measured 20 times a
second, with and without noise, recorded and replayed. The simple rules have the margins that the watch measures. The
watch's thresholds were chosen on the seeds 1000 to 1007. A second table has the probabilities of an onset within 10 s
that the watch told every 10 s, and how often there was one.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise, product
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

import click
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from impact_predictor.bags.replay import replay
from impact_predictor.bags.watched import WatchLog
from impact_predictor.prediction.scene import MovingDeck, Scene, Watching
from impact_predictor.prediction.watch.levels import Level
from impact_predictor.report.table import Column, show, table_of
from impact_predictor.report.watch import unit_as_json
from impact_predictor.scenarios.deck.motion import DeckMotion
from impact_predictor.scenarios.deck.sea import SeaState, directions, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in
from impact_predictor.scenarios.deck.voyage import sail
from impact_predictor.scenarios.record import Sensors
from impact_predictor.scenarios.sensors import NO_NOISE, SensorNoise
from impact_predictor.stamps import NANOSECONDS

RATE: Final = 20.0
NOISE: Final = SensorNoise(position=0.005, orientation=0.0035, velocity=0.02, rate=0.01)
LEARNT: Final = 180.0
"""Seconds after which events count: until then the watch learns the sea."""
CALM: Final = 0.69
"""Part of the margin that a unit on a calm deck uses at most."""
HOLD: Final = Watching().hold
LIMITS: Final = (0.7, 0.8, 1.0)
"""Margins used from which a simple rule warns; at 1 it takes what is felt now to stay."""
HORIZON: Final = Watching().horizon
BINS: Final = (0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.01)
"""Of the probabilities that are told."""


class Sea(NamedTuple):
    """Peak period (s), wave height (m), direction and spread (degrees), natural roll period (s)."""

    period: float
    height: float
    heading: float
    spread: float
    roll: float


SEAS: Final = (
    Sea(6.0, 2.0, 90.0, 0.0, 9.0),
    Sea(8.0, 2.5, 90.0, 20.0, 10.0),
    Sea(12.0, 3.0, 90.0, 0.0, 12.0),
    Sea(7.0, 2.5, 135.0, 15.0, 10.0),
    Sea(10.0, 3.0, 45.0, 15.0, 10.0),
    Sea(14.0, 3.5, 60.0, 15.0, 14.0),
    Sea(7.0, 3.0, 180.0, 15.0, 10.0),
    Sea(9.0, 3.0, 180.0, 15.0, 10.0),
)


class Unit(NamedTuple):
    """A box by its name: its place ahead of midships and to port (m), whether it is measured, whether it would rather
    tip than slide, and how often in an hour its margins are used up.
    """

    name: str
    ahead: float
    port: float
    source: str
    tips: bool
    rate: float


UNITS: Final = (
    Unit("crate", -12.0, 2.0, "odom", False, 30.0),
    Unit("case", 8.0, -3.0, "none", False, 30.0),
    Unit("pallet", 16.0, 0.0, "none", False, 20.0),
    Unit("rack", 0.0, 3.0, "odom", True, 20.0),
    Unit("tank", -4.0, -3.0, "odom", False, 0.0),
    Unit("silo", 4.0, 0.0, "none", True, 0.0),
)
HEIGHT: Final = 1.0
HALF: Final = 1.5
"""m: of the mass centre over the deck, and of the side of one that slides."""


def scene_of(unit: Unit, deck: DeckMotion, times: NDArray[np.float64], noisy: bool) -> Scene:
    """The unit on its deck, with margins that are used up as often as wanted."""
    felt = deck.at(times).felt_at((unit.ahead, unit.port, HEIGHT))
    pushes = np.hypot(felt[:, 0], felt[:, 1]) if not unit.tips else np.abs(felt[:, :2]).max(axis=1)
    parts = pushes / -felt[:, 2]
    # Of each ten seconds the largest; so many of them are to be above one.
    peaks = np.sort(parts[: len(parts) // 100 * 100].reshape(-1, 100).max(axis=1))[::-1]
    count = round(unit.rate * (times[-1] - LEARNT) / 3600.0)
    limit = float(0.5 * (peaks[count - 1] + peaks[count]) if count else peaks[0] / CALM)
    half = limit * HEIGHT if unit.tips else HALF
    friction = 4.0 * limit if unit.tips else limit
    about = 500.0 * HEIGHT**2
    return Scene(
        mass=1000.0,
        # Its turning counts little beside its weight, so that the limit above holds for tipping.
        inertia=((0.2 * about, 0.0, 0.0), (0.0, 0.2 * about, 0.0), (0.0, 0.0, 0.2 * about)),
        friction=friction,
        points=tuple((x, y, -HEIGHT) for x in (-half, half) for y in (-half, half)),
        place=(unit.ahead, unit.port, HEIGHT),
        # With noise window and tolerance follow it, as the shipped scenes have them.
        deck=MovingDeck(window=0.0) if noisy else MovingDeck(),
        tolerance=0.0 if noisy else 0.005,
        source=unit.source,
        watching=Watching(),
    )


class Course(NamedTuple):
    """What a rule, or the watch, said of a unit whose events are these (s): when it warned, how long an ERROR had stood
    at each event (s), and the probabilities of an onset (n,) that it told while there was none, with what happened.
    """

    rule: str
    calm: bool
    hours: float
    events: list[float]
    warnings: list[tuple[float, float]]
    errors: list[float]
    odds: list[tuple[float, bool]]


def odds_of(log: WatchLog, place: int, events: list[float]) -> list[tuple[float, bool]]:
    """What the watch told of a unit once a horizon, at levels below ERROR, and whether an event followed within it."""
    found = []
    for row in np.searchsorted(
        log.stamps / NANOSECONDS, np.arange(LEARNT, log.stamps[-1] / NANOSECONDS - HORIZON, HORIZON)
    ):
        level, _, _, told = log.units[row, place].tolist()
        now = log.stamps[row] / NANOSECONDS
        if level <= Level.WARN and np.isfinite(told):
            found.append((told, any(now < event <= now + HORIZON for event in events)))
    return found


def courses(task: tuple[int, float, bool, int]) -> list[Course]:
    """All units in a sea, by the watch and by each rule."""
    number, seconds, noisy, seed = task
    sea = SEAS[number]
    seed += number
    waves = waves_of(SeaState(sea.height, sea.period), seed)
    vessel = Vessel(60.0, 12.0, 3.5, sea.roll, 0.1, 4.0)
    deck = deck_in(waves, vessel, directions(waves, sea.heading, sea.spread, seed))
    times = np.arange(0.0, seconds, 0.1)
    scenes = {unit.name: scene_of(unit, deck, times, noisy) for unit in UNITS}
    sensors = Sensors(RATE, RATE, NOISE if noisy else NO_NOISE, seed)
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "sea.mcap"
        sail(scenes, deck, seconds, "compliant", bag, sensors, restand=30.0)
        log = replay(bag, scenes).watch
    assert log is not None
    found = []
    for place, unit in enumerate(UNITS):
        answer = unit_as_json(log, place)
        happened = [one for one in answer["events"] if one["stamp"] >= LEARNT * NANOSECONDS]
        events = [one["stamp"] / NANOSECONDS for one in happened]
        course = Course(
            rule=f"watch{', noise' if noisy else ''}",
            calm=not unit.rate,
            hours=seconds / 3600.0,
            events=events,
            warnings=[(one["begin"] / NANOSECONDS, one["end"] / NANOSECONDS) for one in answer["warnings"]],
            errors=[one["error_ahead"] or 0.0 for one in happened],
            odds=odds_of(log, place, events),
        )
        found.append(course)
        used, at = np.nan_to_num(log.units[:, place, 1:3]).max(axis=1), log.stamps / NANOSECONDS
        for limit in LIMITS:
            rule = f"margin above {limit:g}{', noise' if noisy else ''}"
            found.append(course._replace(rule=rule, warnings=over(at[used >= limit]), errors=[], odds=[]))
        if not noisy:
            found.append(course._replace(rule="always", warnings=[(0.0, seconds)], errors=[], odds=[]))
    return found


def over(times: NDArray[np.float64]) -> list[tuple[float, float]]:
    """The warnings of a rule that holds at some times (s), each held as long as the watch holds its own."""
    if not len(times):
        return []
    breaks = np.flatnonzero(np.diff(times) > HOLD)
    begins, ends = np.append(times[0], times[breaks + 1]), np.append(times[breaks], times[-1]) + HOLD
    return list(zip(begins.tolist(), ends.tolist(), strict=True))


class Score(NamedTuple):
    """What a rule is worth: `leads` (s) of the events, 0 where no warning stood; the parts of warnings that were vain,
    of time that was warned of, and how often in an hour a unit on a calm deck was warned of.
    """

    rule: str
    leads: list[float]
    warnings: int
    vain: int
    warned: float
    errors: list[float]
    calm: float


def score(rule: str, found: list[Course]) -> Score:
    lively, calm = ([one for one in found if one.rule == rule and one.calm is quiet] for quiet in (False, True))
    leads, warnings, vain, warned = list[float](), 0, 0, 0.0
    for one in lively:
        leads += [
            max((event - begin for begin, end in one.warnings if begin < event <= end), default=0.0)
            for event in one.events
        ]
        later = [(begin, end) for begin, end in one.warnings if begin >= LEARNT or end > LEARNT]
        warnings += len(later)
        vain += sum(not any(begin <= event <= end for event in one.events) for begin, end in later)
        warned += sum(end - begin for begin, end in one.warnings)
    return Score(
        rule=rule,
        leads=leads,
        warnings=warnings,
        vain=vain,
        warned=warned / sum(3600.0 * one.hours for one in lively),
        errors=[error for one in lively for error in one.errors],
        calm=sum(len(one.warnings) for one in calm) / sum(one.hours for one in calm),
    )


@click.command()
@click.option("--hours", default=0.45, show_default=True, help="Of each sea.")
@click.option("--seed", default=5000, show_default=True, help="Of the first sea; each has the next one.")
@click.option("--jobs", default=2, show_default=True, help="Seas at once.")
def main(hours: float, seed: int, jobs: int) -> None:
    """Print the table."""
    # The pool is as many threads as there are to be: more would wait for each other.
    os.environ["OMP_NUM_THREADS"] = "1"
    tasks = list(product(range(len(SEAS)), [3600.0 * hours], (False, True), [seed]))
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        found = [course for part in pool.map(courses, tasks) for course in part]
    columns = [
        Column("rule", lambda one: one.rule, left=True),
        Column("events", lambda one: f"{len(one.leads)}"),
        Column("lead\nmedian s", lambda one: f"{np.median(one.leads):.1f}"),
        Column("below\n2 s, %", lambda one: f"{100.0 * np.mean(np.array(one.leads) < 2.0):.1f}"),
        Column("un-\nwarned", lambda one: f"{sum(lead == 0.0 for lead in one.leads)}"),
        Column("warnings", lambda one: f"{one.warnings}"),
        Column("vain\n%", lambda one: f"{100.0 * one.vain / max(1, one.warnings):.0f}"),
        Column("of the\ntime, %", lambda one: f"{100.0 * one.warned:.0f}"),
        Column(
            "ERROR 0.5 s\nbefore, %",
            lambda one: f"{100.0 * np.mean(np.array(one.errors) >= 0.5):.0f}" if one.errors else "-",
        ),
        Column("calm decks\nan hour", lambda one: f"{one.calm:.2f}"),
    ]
    rules = sorted({one.rule for one in found}, reverse=True)
    show(Console(), table_of(columns, [score(rule, found) for rule in rules]))
    show(Console(), table_of(ODDS, [one for rule in rules for one in odds(rule, found)]))


class Odds(NamedTuple):
    """Of so many probabilities that were told: their mean, and the part of them that an event followed."""

    rule: str
    times: int
    told: float
    happened: float


ODDS: Final = [
    Column("rule", lambda one: one.rule, left=True),
    Column("times", lambda one: f"{one.times}"),
    Column("told", lambda one: f"{one.told:.2f}"),
    Column("happened", lambda one: f"{one.happened:.2f}"),
]


def odds(rule: str, found: list[Course]) -> list[Odds]:
    """The probabilities that a rule told of the units that are not calm, in bins, and all of them."""
    pairs = np.array([pair for one in found if one.rule == rule and not one.calm for pair in one.odds]).reshape(-1, 2)
    within = [pairs[(low <= pairs[:, 0]) & (pairs[:, 0] < high)] for low, high in pairwise(BINS)]
    return [Odds(rule, len(some), *some.mean(axis=0).tolist()) for some in (*within, pairs) if len(some)]


if __name__ == "__main__":
    main()
