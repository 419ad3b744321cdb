"""Cargo on compliant contacts against the rigid motion: two ways to the same impacts that share no impact law."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from cargo_scenes import a_deck as rolling_deck
from cargo_scenes import box
from harmonic_deck import Wave, harmonic_support
from numpy.typing import NDArray

from impact_predictor.errors import InputError
from impact_predictor.mechanics.motion import End, standing
from impact_predictor.prediction.watch.onset import Onset, motions
from impact_predictor.prediction.watch.standing import Standing
from impact_predictor.scenarios.deck.cargo import CargoUnit, follow, unit_of
from impact_predictor.scenarios.deck.compliant import follow_compliant
from impact_predictor.scenarios.deck.motion import DeckMotion, planar_deck
from impact_predictor.scenarios.deck.sea import SeaState, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in
from impact_predictor.scenarios.truth import TrueImpact


def margin_used(deck: DeckMotion, unit: CargoUnit, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """The larger part that is used of the margins of a unit against sliding and tipping, where it began."""
    state, stance = deck.at(times), Standing(unit.scene).stance
    assert stance is not None
    margins = Onset([stance]).margins(motions(state.gravity, state.poses.angular, state.turning))
    return np.maximum(margins.slide, margins.tip)[0]


def a_deck() -> DeckMotion:
    return planar_deck(rolling_deck().at(0.0, 0.9))


def rigid_motion(unit: CargoUnit, deck: DeckMotion, duration: float) -> Any:
    return follow(unit, deck.across(0.0, unit.foot), duration)


LOW = tuple((x, y, -0.2) for x in (-0.7, 0.7) for y in (-0.7, 0.7))
TALL = tuple((x, y, -0.8) for x in (-0.7, 0.7) for y in (-0.4, 0.4))


def impacts_of(spans: Any) -> list[TrueImpact]:
    return [impact for span in spans for impact in span.impacts if impact.approach > 0.05]


def test_its_impacts_are_those_of_the_rigid_motion() -> None:
    unit = unit_of("box", box())
    rigid, compliant = (impacts_of(way(unit, a_deck(), 4.65)) for way in (rigid_motion, follow_compliant))
    assert len(rigid) == len(compliant) >= 5
    for one, other in zip(rigid, compliant, strict=True):
        # Rocking carries on what differs: a part in a hundred, and milliseconds, after five impacts.
        assert other.stamp == pytest.approx(one.stamp, abs=2e6)
        assert (other.mode, other.old, other.new) == (one.mode, one.old, one.new)
        assert other.half_distance == pytest.approx(one.half_distance)
        scale = one.approach
        for name in ("linear_before", "linear_after"):
            assert getattr(other, name) == pytest.approx(getattr(one, name), abs=0.03 * scale)
        for name in ("angular_before", "angular_after"):
            assert getattr(other, name) == pytest.approx(getattr(one, name), abs=0.03 * scale / one.half_distance)
        assert other.energy_lost == pytest.approx(one.energy_lost, rel=0.08)
        # The rigid law judges both states before the impact.
        assert other.border == pytest.approx(one.border, rel=0.01)


@pytest.mark.parametrize(
    ("friction", "points"),
    [
        # Low and wide: both contacts stay; with little friction it slides on them.
        (0.9, LOW),
        (0.1, LOW),
        # Tall with little friction: it pivots and slides.
        (0.15, TALL),
        (0.6, TALL),
    ],
)
def test_the_mode_is_read_from_gaps_and_velocities_as_the_law_has_it(friction: float, points: Any) -> None:
    # Dropped from a tilt on a deck that hardly moves.
    unit = unit_of("box", box(friction=friction, points=points, place=(0.0, 0.0, 0.0)))
    deck = planar_deck(harmonic_support([Wave(1e-6, 1.0)]))
    tilted = unit._replace(start=standing(unit.body, 0.03))
    (rigid, *_), (compliant, *_) = (impacts_of(way(tilted, deck, 0.7)) for way in (rigid_motion, follow_compliant))
    assert compliant.mode is rigid.mode
    assert (compliant.old, compliant.new) == (rigid.old, rigid.new)
    assert compliant.linear_after == pytest.approx(rigid.linear_after, abs=0.02 * rigid.approach)


def test_it_begins_to_slide_and_to_tip_where_its_margins_are_used_up() -> None:
    # Waves from the quarter: which way it slides, and over which corner it tips, changes all the time.
    deck = deck_in(waves_of(SeaState(3.0, 5.0), 3), Vessel(height=4.0), 50.0)
    for scene in (box(friction=0.3), box(friction=0.9, points=tuple((x, y, -1.5) for x, y, _ in TALL))):
        unit = unit_of("box", scene._replace(place=(3.0, 2.0, -scene.points[0][2])))
        onset = next(one for span in follow_compliant(unit, deck, 20.0) for one in span.onsets)
        times = onset.stamp / 1e9 + np.array([-0.2, 0.0])
        before, there = margin_used(deck, unit, times)
        assert before < 1.0
        assert there == pytest.approx(1.0, abs=0.02)
        assert (onset.slides, onset.lifts) == (scene.friction < 0.5, scene.friction > 0.5)


def test_it_goes_on_where_a_span_ends() -> None:
    unit = unit_of("box", box(friction=0.2))
    for one, other in pairwise(follow_compliant(unit, a_deck(), 3.0)):
        assert one.time == other.start
        ends, begins = (np.ravel(span.state(np.array([one.time]))) for span in (one, other))
        assert ends == pytest.approx(begins, abs=1e-5)


@pytest.mark.parametrize("yaw", [0.0, np.pi])
def test_how_far_it_is_tilted_is_told_whichever_way_it_lies(yaw: float) -> None:
    unit = unit_of("box", box(yaw=yaw))
    tilted = unit._replace(start=standing(unit.body, 0.03))
    span = next(follow_compliant(tilted, planar_deck(harmonic_support([Wave(1e-6, 1.0)])), 0.2))
    assert span.state(np.zeros(1)).angle == pytest.approx([0.03])
    turns = span.poses(np.linspace(0.0, span.time, 999)).orientation
    assert np.square(turns).sum(axis=1) == pytest.approx(1.0, abs=1e-14)  # between steps of the motion, too


def test_a_toppled_unit_ends_there() -> None:
    tall = box(points=tuple((x, y, -2.0) for x in (-0.7, 0.7) for y in (-0.2, 0.2)))
    *_, last = follow_compliant(unit_of("tall", tall), a_deck(), 20.0)
    assert last.end is End.OVERTURNED
    assert last.time < 20.0


def test_a_unit_on_a_line_is_refused() -> None:
    thin = box(points=((0.0, -0.4, -1.0), (0.0, 0.4, -1.0)))
    with pytest.raises(InputError, match="thin stands on a line"):
        follow_compliant(unit_of("thin", thin), a_deck(), 1.0)
