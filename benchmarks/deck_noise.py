"""What noise of a deck's sensor does to the watch over units that stand: levels and announcements that nothing causes.

    python benchmarks/deck_noise.py [--seconds 1800]

The crate of config/deck_crate.yaml amidships and one 8 m forward and 3 m to port, on decks in seas in which they stand:
exact poses of the crates in the world, at 20 Hz, and those of the deck with noise of 5 mm, 0.2 degrees, 0.02 m/s and
0.01 rad/s. Window and tolerance are given, or follow what is measured (0).
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Final, NamedTuple

import click
import numpy as np
from bench_tracking import SHIP, simulated
from rich.console import Console
from rich.table import Table

from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import Scene, read_scenes, triple
from impact_predictor.prediction.types import Sample, Vector3
from impact_predictor.prediction.vectors import add, axes_of, composed, cross, to_world
from impact_predictor.prediction.watch.levels import Level
from impact_predictor.scenarios.deck.sea import SeaState
from impact_predictor.scenarios.deck.vessel import Vessel
from impact_predictor.scenarios.sensors import SensorNoise

SCENE: Final = Path(__file__).parents[1] / "config" / "deck_crate.yaml"
ORDINARY: Final = SensorNoise(position=0.005, orientation=0.0035, velocity=0.02, rate=0.01)
PLACES: Final[dict[str, Vector3]] = {"amidships": (0.0, 0.0, 2.1), "forward": (8.0, 3.0, 2.1)}
DECKS: Final = (("pontoon", Vessel(), SeaState(0.5, 4.5)), ("ship", SHIP, SeaState(2.0, 9.0)))
CASES: Final = (
    (0.0, 0.2, 1e-5),
    (1.0, 0.2, 1e-5),
    (1.0, 0.2, 0.02),
    (1.0, 1.0, 0.02),
    (0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0),
)
"""Part of the noise, window in s, tolerance in m."""


class Seen(NamedTuple):
    """How often levels rose to ERROR and to WARN and touchdowns were announced, and what was doubted at the end."""

    errors: int
    warnings: int
    announced: int
    doubts: tuple[str, ...]


def noisy(sample: Sample, part: float, rng: np.random.Generator) -> Sample:
    """A sample of the deck with a part of the noise of its sensor."""
    place, angles, linear, angular = (part * rng.normal(0.0, np.repeat(ORDINARY[:4], 3))).reshape(4, 3).tolist()
    x, y, z = (0.5 * angle for angle in angles)
    return sample._replace(
        position=add(sample.position, triple(place)),
        orientation=composed(sample.orientation, (x, y, z, (1.0 - x * x - y * y - z * z) ** 0.5)),
        linear=add(sample.linear, triple(linear)),
        angular=add(sample.angular, triple(angular)),
    )


def standing(deck: Sample, place: Vector3) -> Sample:
    """A unit that stands at a place of the deck, without noise."""
    return deck._replace(
        child_frame_id="unit",
        position=add(deck.position, to_world(axes_of(deck.orientation), place)),
        linear=add(deck.linear, cross(deck.angular, place)),
    )


def watched(samples: list[Sample], scenes: dict[str, Scene], part: float) -> Seen:
    """The samples of a deck, with noise, and of the units on it through a monitor."""
    monitor, rng, counts = Monitor(scenes), np.random.default_rng(0), Counter[Level]()
    levels, ahead = dict.fromkeys(scenes, Level.OK), dict.fromkeys(scenes, False)
    announced = 0
    for deck in samples:
        monitor.update_support(noisy(deck, part, rng) if part else deck)
        for name, scene in scenes.items():
            was = ahead[name]
            ahead[name] = monitor.update(name, standing(deck, scene.place)).touchdown is not None
            announced += ahead[name] and not was
        for report in monitor.reports():
            if report.level is not levels[report.body]:
                counts[report.level] += 1
            levels[report.body] = report.level
    return Seen(counts[Level.ERROR], counts[Level.WARN], announced, monitor.doubts())


@click.command()
@click.option("--seconds", default=1800.0)
def main(seconds: float) -> None:
    """Print the table."""
    table = Table("deck", "noise", "window", "tolerance", "ERROR/h", "WARN/h", "announced/h", "doubts")

    scene = read_scenes(SCENE)[""]
    for name, vessel, sea in DECKS:
        samples = simulated(name, vessel, sea, seconds).samples
        for part, window, tolerance in CASES:
            assert scene.deck is not None
            tried = scene._replace(deck=scene.deck._replace(window=window), tolerance=tolerance)
            seen = watched(samples, {key: tried._replace(place=place) for key, place in PLACES.items()}, part)
            row = [f"{one * 3600.0 / seconds:.0f}" for one in seen[:3]]
            table.add_row(name, f"{part:g}", f"{window:g}", f"{tolerance:g}", *row, "; ".join(seen.doubts))
    Console(width=150).print(table)


if __name__ == "__main__":
    main()
