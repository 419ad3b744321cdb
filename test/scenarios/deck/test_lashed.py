"""Units with lashings and chocks on springs and friction, on a deck that lists ever further, against the margins that a
watch tells: two ways to the list at which a unit moves, that share no line.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from impact_predictor.mechanics.motion import End
from impact_predictor.prediction.scene import Chock, Lashing, MovingDeck, Scene
from impact_predictor.prediction.watch.onset import Onset, motions
from impact_predictor.prediction.watch.standing import Standing
from impact_predictor.scenarios.deck.cargo import unit_of
from impact_predictor.scenarios.deck.compliant import follow_compliant
from impact_predictor.scenarios.deck.motion import DeckMotion

LISTS, STAYS = 5.0, 6.5
"""s until the deck has its list, so slowly that this adds a few per cent to the load, and until it is over."""


def box(half: float, high: float, **changes: Any) -> Scene:
    """A box of 2 t that is 2 m long, as wide and as high as this."""
    points = tuple((x, y, z) for x in (-1.0, 1.0) for y in (-half, half) for z in (-0.5 * high, 0.5 * high))
    inertia = ((1000.0, 0.0, 0.0), (0.0, 1100.0, 0.0), (0.0, 0.0, 1200.0))
    place = 0.0, 0.0, 0.5 * high
    scene = Scene(mass=2000.0, inertia=inertia, friction=0.3, points=points, deck=MovingDeck(), place=place)
    return scene._replace(**changes)


def lashings(half: float, height: float, *stiffness: float) -> tuple[Lashing, ...]:
    """Four lashings athwartships that take hold so high above the mass centre, with MSL 6 kN and 1 kN of preload."""
    ends = [(x, y) for x in (-1.0, 1.0) for y in (-half, half)]
    return tuple(
        Lashing((x, y, height), (x, 3.0 * y, 0.0), 6000.0, 1000.0, stiff)
        for (x, y), stiff in zip(ends, stiffness, strict=True)
    )


WEDGED = (Chock((0.0, -0.8, 0.1), (0.0, 1.0, 0.0), 5000.0),)
EVEN = (4e5,) * 4
HELD = {
    "slides from its lashings": box(0.8, 2.0, lashings=lashings(0.8, 0.0, *EVEN)),
    "tips against its lashings": box(0.4, 2.4, friction=0.9, lashings=lashings(0.4, 0.8, *EVEN)),
    "slides over its chock": box(0.8, 2.0, chocks=WEDGED),
}


class Told(NamedTuple):
    slide: float
    tip: float


def told(scene: Scene, angle: float) -> Told:
    """The most that a unit uses of its margins on a deck that lists by an angle in rad."""
    deck = listing(angle).at(np.linspace(0.0, STAYS, 66))
    margins = Onset([Standing(scene).stance]).margins(motions(deck.gravity, deck.poses.angular, deck.turning))
    return Told(float(margins.slide.max()), float(margins.tip.max()))


ANGLES = np.linspace(0.0, 1.5, 301)


@cache
def used_at(scene: Scene) -> list[float]:
    """The part of its margins that a unit uses at each of the ANGLES."""
    return [max(told(scene, angle)) for angle in ANGLES]


def list_for(scene: Scene, used: float) -> float:
    """The list in rad at which this part of a margin is used."""
    return float(np.interp(used, used_at(scene), ANGLES))


def listing(angle: float) -> DeckMotion:
    def axes(times: Any) -> Any:
        part = np.clip(np.asarray(times) / LISTS, 0.0, 1.0)
        turn = 2.0 * np.pi * part
        found = np.zeros((3, 6, len(part)))
        found[:, 3] = part - np.sin(turn) / (2.0 * np.pi), (1.0 - np.cos(turn)) / LISTS, np.sin(turn) * 2.0 * np.pi
        found[2, 3] /= LISTS**2
        return angle * found

    return DeckMotion(axes, period=2.0)


def run(scene: Scene, angle: float) -> tuple[float, int]:
    """How far in m a unit moves on a deck that lists, inf where it topples, and how many onsets are told of it."""
    spans = list(follow_compliant(unit_of("unit", scene), listing(angle), STAYS))
    end = spans[-1]
    place = end.poses(np.array([end.time])).position[0]
    far = np.inf if end.end is End.OVERTURNED else float(np.linalg.norm(place - scene.place))
    return far, sum(len(span.onsets) for span in spans)


@pytest.mark.parametrize("name", HELD)
def test_a_held_unit_stays_below_one_and_moves_above(name: str) -> None:
    scene = HELD[name]
    slide, tip = told(scene, list_for(scene, 1.0))
    assert (tip > slide) == name.startswith("tips")
    far, onsets = run(scene, list_for(scene, 0.95))
    assert far < 0.05  # the lashings are tight
    assert onsets == 0
    far, onsets = run(scene, list_for(scene, 1.05))
    assert far > 0.3
    assert onsets >= 1


def test_without_what_holds_it_a_unit_moves_where_it_was_held() -> None:
    scene = HELD["slides from its lashings"]
    far, onsets = run(scene._replace(lashings=()), list_for(scene, 0.95))
    assert far > 0.3
    assert onsets >= 1


def test_of_lashings_that_share_unevenly_the_margin_is_on_the_safe_side() -> None:
    scene = box(0.8, 2.0, lashings=lashings(0.8, 0.0, 4e5, 4e5, 8e4, 8e4))
    far, _ = run(scene, list_for(scene, 1.0))
    assert far < 0.1
