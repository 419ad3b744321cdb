"""What the pictures of a deck show: how its units moved, and the seconds in which they did."""

from __future__ import annotations

from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from harmonic_deck import Wave, harmonic_support
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from impact_predictor.prediction.scene import MovingDeck, Scene
from impact_predictor.prediction.types import Vector3
from impact_predictor.report.deck_pictures import (
    LONGEST,
    UnitMotion,
    UnitScene,
    busiest,
    deck_film,
    deck_frames,
    margin_used,
    picture_times,
    write_deck_figure,
)
from impact_predictor.report.plot import write_film
from impact_predictor.scenarios.deck.motion import DeckMotion, planar_deck
from impact_predictor.scenarios.deck.voyage import sail

DURATION = 60.0


def box(width: float, height: float, friction: float, place: Vector3, yaw: float = 0.0) -> Scene:
    mass, across = 1000.0, width * width + height * height
    points = tuple((x, y, -0.5 * height) for x in (-0.6, 0.6) for y in (-0.5 * width, 0.5 * width))
    inertia = ((mass * across / 12.0, 0.0, 0.0), (0.0, 500.0, 0.0), (0.0, 0.0, 500.0))
    return Scene(mass, inertia, friction, points=points, deck=MovingDeck(), place=place, yaw=yaw)


SCENES = {
    "crate": box(2.4, 3.0, 0.6, (0.0, 0.0, 1.5)),
    "cabinet": box(0.9, 1.9, 0.9, (4.0, 2.0, 0.95)),
    "pallet": box(1.2, 0.6, 0.35, (-4.0, -2.0, 0.3)),
    "tank": box(1.3, 3.0, 0.8, (-8.0, 1.0, 1.5)),
}
ROLL = (
    Wave(radians(6.5), 2.0 * pi / 4.1, 0.3),
    Wave(radians(4.5), 2.0 * pi / 5.0, 1.0),
    Wave(radians(3.0), 2.0 * pi / 3.4, 2.0),
)


@pytest.fixture(scope="module")
def deck() -> DeckMotion:
    return planar_deck(harmonic_support(ROLL, [Wave(0.5, 0.5 * pi)], [Wave(0.7, 2.0 * pi / 4.5, 2.0)]).at(0.0, 2.0))


@pytest.fixture(scope="module")
def units(deck: DeckMotion) -> list[UnitMotion]:
    return motions_of(deck, SCENES)


def motions_of(deck: DeckMotion, scenes: dict[str, Scene], duration: float = DURATION) -> list[UnitMotion]:
    return [UnitMotion(one) for one in sail(scenes, deck, duration, times=picture_times(duration)).units]


def test_units_rock_slide_topple_and_stay(units: list[UnitMotion]) -> None:
    crate, cabinet, pallet, tank = units
    still, rocks = (np.abs([one.slid, one.tilt]).max(axis=1) for one in (crate, cabinet))
    assert (still == 0.0).all()
    assert cabinet.impacts
    assert not crate.impacts
    assert 0.0 < np.degrees(rocks[1]) < 20.0
    assert rocks[0] < 1e-9  # it sticks: turning about an edge is no slide
    assert np.abs(pallet.slid).max() > 0.1
    assert np.abs(pallet.tilt).max() == 0.0
    assert tank.toppled
    assert np.isnan(tank.tilt[tank.times > tank.ended]).all()


def test_a_margin_is_used_up_when_a_unit_leaves_its_rest_and_not_before(
    deck: DeckMotion, units: list[UnitMotion]
) -> None:
    for one, followed in zip(units, sail(SCENES, deck, DURATION).units, strict=True):
        used = margin_used(deck, one.unit, one.times)
        begun = followed.onsets[0].stamp * 1e-9 if followed.onsets else DURATION
        assert (used[one.times < begun - one.times[1]] < 1.0).all()
        if followed.onsets:
            assert margin_used(deck, one.unit, np.array([begun])) == pytest.approx(1.0, abs=1e-3)


def outline_of(deck: DeckMotion, scene: Scene) -> NDArray[np.float64]:
    """What the film draws of a unit before it moves, from where its old contact stands, on a deck that is level."""
    (motion,) = motions_of(deck, {"one": scene}, 1.0)
    axes = Figure().add_subplot()
    UnitScene(deck, motion, motion.times.tolist()).draw(axes, 0.0)
    return np.asarray(axes.patches[-1].get_path().vertices)


def test_a_box_and_a_drum_are_seen_along_the_deck() -> None:
    level = planar_deck(harmonic_support([Wave(0.0, 1.0)]))
    corners = outline_of(level, box(1.0, 2.0, 0.5, (0.0, 0.0, 1.0), yaw=0.5 * pi))
    assert (*corners.min(axis=0), *corners.max(axis=0)) == pytest.approx((0.0, 0.0, 1.2, 2.0))
    drum = Scene(
        *(200.0, ((16.0, 0.0, 0.0), (0.0, 16.0, 0.0), (0.0, 0.0, 16.0)), 0.5),
        radius=0.4,
        edges=((0.0, -0.4 * sin(0.5), 0.0), (0.0, 0.4 * sin(0.5), 0.0)),
        place=(0.0, 0.0, 0.4 * cos(0.5)),
        deck=MovingDeck(),
    )
    centre = (0.4 * sin(0.5), 0.4 * cos(0.5))
    assert np.hypot(*(outline_of(level, drum) - centre).T) == pytest.approx(0.4)


def test_the_film_shows_the_seconds_about_the_fastest(deck: DeckMotion, units: list[UnitMotion]) -> None:
    frames, tank = deck_frames(units), units[-1]
    assert frames[-1] - frames[0] == pytest.approx(LONGEST, abs=0.1)
    assert frames[0] <= tank.ended <= frames[-1]  # it topples, which is faster than what else happens
    assert deck_frames(units[:1])[0] == 0.0  # nothing moves
    assert deck_frames(motions_of(deck, {"crate": SCENES["crate"]}, 1.0))[-1] <= 1.0


def test_the_busiest_units_are_drawn_in_their_order(units: list[UnitMotion]) -> None:
    assert [one.unit.name for one in busiest(units, 2)] == ["cabinet", "tank"]


def test_the_film_says_what_a_unit_does(deck: DeckMotion, units: list[UnitMotion]) -> None:
    crate, cabinet, pallet, tank = (UnitScene(deck, one, one.times) for one in units)
    axes = Figure().add_subplot()
    said = [one.draw(axes, time) for one in (crate, cabinet, pallet, tank) for time in units[0].times[::4]]
    for words in ("stands, margin used: ", "rocks, tilted by ", "slides at ", "has toppled"):
        assert any(one.startswith(words) for one in said)
    assert tank.draw(axes, units[0].times[-1]) == "has toppled"


def test_moments_of_a_long_motion_are_not_too_many() -> None:
    assert len(picture_times(1e6)) == 200_000
    assert picture_times(10.0)[1] == pytest.approx(0.05)


def test_the_pictures_are_written_the_same_every_time(
    deck: DeckMotion, units: list[UnitMotion], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("impact_predictor.report.deck_pictures.LONGEST", 0.6)
    told: list[int] = []
    for name in ("one", "two"):
        write_deck_figure(tmp_path / f"{name}.svg", deck, units)
        write_film(tmp_path / f"{name}.gif", deck_film(deck, units), told.append)
    for suffix in ("svg", "gif"):
        assert (tmp_path / f"one.{suffix}").read_bytes() == (tmp_path / f"two.{suffix}").read_bytes()
    with Image.open(tmp_path / "one.gif") as film:
        assert film.n_frames == len(told) / 2  # type: ignore[attr-defined]
