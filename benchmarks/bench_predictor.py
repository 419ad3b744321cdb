"""What one sample costs: `Predictor.update` over the recorded tosses of a cube, and on a deck in a swell.

    python benchmarks/bench_predictor.py [RUNS]

Each run goes over the whole record; of each sample the fastest run counts, in the thread's own time, so that other
programs disturb little. The messages are decoded as they come, as in the node, but only the predictor is timed. On the
deck the cost of its tracker (`Deck.at`, at the stamp of the body) is part of the sample's; what a message of the deck
costs is told apart. What one impact costs is told by `bench_spatial.py`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from math import hypot
from pathlib import Path
from time import thread_time_ns
from typing import Final, NamedTuple

import numpy as np
from forms import in_both_forms
from harmonic_deck import Wave, harmonic_support
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from impact_predictor import TwoPointBody, cylinder, plate
from impact_predictor.bags.read import BagMessage, read_messages
from impact_predictor.mechanics.motion import PlanarState, rock, standing
from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import MovingDeck, Scene, read_scenes
from impact_predictor.prediction.types import Sample, Status, Vector3
from impact_predictor.ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon
from impact_predictor.scenarios.sensors import ACROSS, Mount, Odometer, poses

ROOT = Path(__file__).resolve().parents[1]
TOSSES = ROOT / "examples/cube_tosses/cube_tosses.mcap"
PARAMETERS = ROOT / "config/cube_tosses.yaml"

KINDS = ("no touchdown ahead", "in flight", "standing")

RATE: Final = 100.0
"""Messages a second of deck and body."""
SPAN: Final = 2.0
"""Seconds of each motion."""
BREAK: Final = 1.0
"""Seconds until the next one, so that it is a record of its own."""

CRATE: Final = plate(length=0.8, height=1.0, mass=50.0, friction=0.5)
DRUM: Final = cylinder(radius=0.3, gamma=0.6, mass=40.0, friction=0.5)
SWELL: Final = harmonic_support(angle=(Wave(0.1, 0.9, 0.4),), x=(Wave(0.8, 0.7, 1.0),), y=(Wave(1.0, 0.8, 0.2),))


def run(scene: Scene, record: Sequence[BagMessage]) -> tuple[list[float], list[int]]:
    """Microseconds of each sample, and the index of its kind."""
    body = Predictor(scene)
    costs, kinds = [], []
    for topic, _, data in record:
        if topic == "/cube/contact_geometry":
            body.tell(decode_polygon(data))
            continue
        sample = decode_odometry(data)
        started = thread_time_ns()
        touchdown = body.update(sample).touchdown
        costs.append((thread_time_ns() - started) * 1e-3)
        kinds.append(0 if touchdown is None else 2 if touchdown.old else 1)
    return costs, kinds


def fastest(scene: Scene, record: Sequence[BagMessage], runs: int) -> NDArray[np.float64]:
    """Microseconds of each sample in its fastest run."""
    return np.asarray(np.min([run(scene, record)[0] for _ in range(runs)], axis=0))


def by_kind(title: str, costs: NDArray[np.float64], kinds: list[int]) -> Table:
    """The costs by what the body does."""
    table = Table(f"us per sample: {title}", "samples", "median", "mean", "99 %", "most")
    for name, chosen in [("all", costs), *((kind, costs[np.equal(kinds, k)]) for k, kind in enumerate(KINDS))]:
        numbers = np.median(chosen), np.mean(chosen), np.percentile(chosen, 99), np.max(chosen)
        table.add_row(name, str(len(chosen)), *(f"{number:.1f}" for number in numbers))
    return table


class Motions(NamedTuple):
    """A body on a deck in a swell, with the messages of its deck and its own; those of one stamp belong together."""

    name: str
    scene: Scene
    messages: list[tuple[Sample, Sample]]


def motions() -> list[Motions]:
    """A crate and a drum, each at rest and rocking."""
    crate, drum = crate_scene(), drum_scene()
    return [
        Motions("crate at rest", crate, messages(CRATE, [0.0] * 3)),
        Motions("crate that rocks", crate, messages(CRATE, [0.1, 0.2, 0.3, -0.15, -0.25])),
        Motions("drum at rest", drum, messages(DRUM, [0.0] * 3)),
        Motions("drum that rocks", drum, messages(DRUM, [0.1, 0.2, 0.3, -0.15, -0.25])),
    ]


def crate_scene() -> Scene:
    points = tuple((x, y, -0.5) for x in (-0.3, 0.3) for y in (-0.4, 0.4))
    return Scene(CRATE.mass, principal(CRATE.inertia), 0.5, points=points, deck=MovingDeck())


def drum_scene() -> Scene:
    old, new = DRUM.old, DRUM.new
    assert old is not None
    edges = (0.0, 0.0, 0.0), (0.0, new.x - old.x, new.y - old.y)
    inertia = principal(DRUM.inertia)
    return Scene(DRUM.mass, inertia, 0.5, deck=MovingDeck(), radius=hypot(old.x, old.y), edges=edges)


def principal(about_x: float) -> tuple[Vector3, Vector3, Vector3]:
    return (about_x, 0.0, 0.0), (0.0, 1.3 * about_x, 0.0), (0.0, 0.0, 0.8 * about_x)


def messages(body: TwoPointBody, angles: list[float]) -> list[tuple[Sample, Sample]]:
    """Motions that start at these angles (rad), one after the other, as messages of the deck and of the body."""
    found, times = list[tuple[Sample, Sample]](), np.arange(0.0, SPAN, 1.0 / RATE)
    moves = SWELL.motion(times)
    frame = PlanarState(moves.x, moves.y, moves.angle, moves.vx, moves.vy, moves.rate)
    for number, angle in enumerate(angles):
        run = rock(body, standing(body, angle), SWELL, duration=SPAN)
        stamps = [round(number * (SPAN + BREAK) * 1e9) + k * round(1e9 / RATE) for k in range(len(times))]
        both = [
            Odometer("world", name).samples(stamps, poses(state, ACROSS, Mount()))
            for name, state in (("deck", frame), ("body", run.world(times)))
        ]
        found += zip(*both, strict=True)
    return found


def on_deck(moves: Motions) -> tuple[list[float], list[float], list[bool]]:
    """Microseconds of each message of the deck and of each sample of the body, and whether a touchdown is ahead."""
    scene = moves.scene
    assert scene.deck is not None
    deck = Deck(scene.deck, scene.gravity, scene.normal)
    body = Predictor(scene, deck)
    of_deck, of_body, ahead = [], [], []
    for deck_sample, sample in moves.messages:
        started = thread_time_ns()
        deck.update(deck_sample)
        between = thread_time_ns()
        prediction = body.update(sample)
        ended = thread_time_ns()
        if prediction.status is Status.ACCEPTED:
            of_deck.append((between - started) * 1e-3)
            of_body.append((ended - between) * 1e-3)
            ahead.append(prediction.touchdown is not None)
    return of_deck, of_body, ahead


def deck_table(runs: int) -> Table:
    """What messages cost on a deck, by the body and by what it does."""
    table = Table("us per sample: on a deck", "samples", "median", "mean", "99 %", "deck message: median")
    for moves in motions():
        measured = [on_deck(moves) for _ in range(runs)]
        of_deck = np.min([one[0] for one in measured], axis=0)
        of_body = np.min([one[1] for one in measured], axis=0)
        ahead = np.array(measured[0][2])
        for what, chosen in (("no touchdown ahead", of_body[~ahead]), ("touchdown ahead", of_body[ahead])):
            if chosen.size:
                numbers = np.median(chosen), np.mean(chosen), np.percentile(chosen, 99), np.median(of_deck)
                table.add_row(f"{moves.name}: {what}", str(chosen.size), *(f"{number:.1f}" for number in numbers))
    return table


def main() -> int:
    """Print what a sample costs, by what the body does."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    scene = read_scenes(PARAMETERS)[""]
    record = list(read_messages(TOSSES, {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}))
    kinds = run(scene, record)[1]
    whole = fastest(scene, record, runs)
    certain = scene._replace(samples=0)
    without = by_kind("without draws", fastest(certain, record, runs), run(certain, record)[1])
    shipped = by_kind(f"as shipped, with {scene.samples} draws", whole, kinds)
    Console(width=120).print(shipped, without, deck_table(runs))
    return 0


if __name__ == "__main__":
    sys.exit(in_both_forms(main))
