"""Motions of a crate and of a drum on a deck in a swell, as the messages of both, for `bench_predictor.py`."""

from __future__ import annotations

from itertools import count
from math import hypot
from typing import Final, NamedTuple

import numpy as np
from harmonic_deck import Wave, harmonic_support

from impact_predictor import TwoPointBody, cylinder, plate
from impact_predictor.mechanics.motion import PlanarState, rock, standing
from impact_predictor.prediction.scene import MovingDeck, Scene
from impact_predictor.prediction.types import Sample, Vector3
from impact_predictor.scenarios.sensors import ACROSS, Mount, poses

RATE: Final = 100.0
"""Messages a second of deck and body."""
SPAN: Final = 2.0
"""Seconds of each motion."""
BREAK: Final = 1.0
"""Seconds until the next one, so that it is a record of its own."""
ZEROS: Final = (0.0,) * 36

CRATE: Final = plate(length=0.8, height=1.0, mass=50.0, friction=0.5)
DRUM: Final = cylinder(radius=0.3, gamma=0.6, mass=40.0, friction=0.5)
SWELL: Final = harmonic_support(angle=(Wave(0.1, 0.9, 0.4),), x=(Wave(0.8, 0.7, 1.0),), y=(Wave(1.0, 0.8, 0.2),))


class Motions(NamedTuple):
    """A body with the messages of its deck and its own; those of one stamp belong together."""

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
    found = []
    for number, angle in enumerate(angles):
        run = rock(body, standing(body, angle), SWELL, duration=SPAN)
        times = np.arange(0.0, SPAN, 1.0 / RATE)
        moves = SWELL.motion(times)
        frame = PlanarState(moves.x, moves.y, moves.angle, moves.vx, moves.vy, moves.rate)
        stamps = range(round(number * (SPAN + BREAK) * 1e9), 2**62, round(1e9 / RATE))
        found += list(zip(odometry(stamps, "deck", frame), odometry(stamps, "body", run.world(times)), strict=True))
    return found


def odometry(stamps: range, child: str, state: PlanarState) -> list[Sample]:
    """Messages in the world of a frame that moves as the arrays of `state` in the plane across a ship."""
    numbers = [part.tolist() for part in poses(state, ACROSS, Mount())]
    return [
        Sample(stamps[k], "world", child, *map(tuple, parts), ZEROS, ZEROS)
        for k, parts in zip(count(), zip(*numbers, strict=True), strict=False)
    ]
