"""Cargo on compliant contacts against the rigid motion: two ways to the same impacts that share no impact law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cargo_scenes import a_deck as rolling_deck
from cargo_scenes import box
from harmonic_deck import Wave, harmonic_support

from impact_predictor.mechanics.motion import End, standing
from impact_predictor.mechanics.motion.support import MovingSupport
from impact_predictor.scenarios.deck import compliant as compliant_deck
from impact_predictor.scenarios.deck.cargo import follow, unit_of
from impact_predictor.scenarios.deck.compliant import follow_compliant
from impact_predictor.scenarios.truth import TrueImpact


def a_deck() -> MovingSupport:
    return rolling_deck().at(0.0, 0.9)


def impacts_of(spans: Any) -> list[TrueImpact]:
    return [impact for span in spans for impact in span.impacts if impact.approach > 0.05]


def test_its_impacts_are_those_of_the_rigid_motion() -> None:
    unit = unit_of("box", box())
    rigid, compliant = (impacts_of(way(unit, a_deck(), 4.65)) for way in (follow, follow_compliant))
    assert len(rigid) == len(compliant) >= 5
    for one, other in zip(rigid, compliant, strict=True):
        # Rocking carries on what differs: a part in a hundred, and milliseconds, after five impacts.
        assert other.stamp == pytest.approx(one.stamp, abs=2e6)
        assert (other.mode, other.old, other.new) == (one.mode, one.old, one.new)
        assert other.half_distance == pytest.approx(one.half_distance)
        scale = one.approach
        for name in ("linear_before", "linear_after"):
            assert getattr(other, name) == pytest.approx(getattr(one, name), abs=0.02 * scale)
        for name in ("angular_before", "angular_after"):
            assert getattr(other, name) == pytest.approx(getattr(one, name), abs=0.02 * scale / one.half_distance)
        assert other.energy_lost == pytest.approx(one.energy_lost, rel=0.03)
        # The rigid law judges both states before the impact.
        assert other.border == pytest.approx(one.border, rel=0.01)


@pytest.mark.parametrize(
    ("friction", "points"),
    [
        # Low and wide: both contacts stay; with little friction it slides on them.
        (0.9, tuple((0.0, y, -0.2) for y in (-0.7, 0.7))),
        (0.1, tuple((0.0, y, -0.2) for y in (-0.7, 0.7))),
        # Tall with little friction: it pivots and slides.
        (0.15, tuple((0.0, y, -0.8) for y in (-0.4, 0.4))),
        (0.6, tuple((0.0, y, -0.8) for y in (-0.4, 0.4))),
    ],
)
def test_the_mode_is_read_from_gaps_and_velocities_as_the_law_has_it(friction: float, points: Any) -> None:
    # Dropped from a tilt on a deck that hardly moves.
    unit = unit_of("box", box(friction=friction, points=points, place=(0.0, 0.0, 0.0)))
    deck = harmonic_support([Wave(1e-6, 1.0)])
    tilted = unit._replace(start=standing(unit.body, 0.03))
    (rigid, *_), (compliant, *_) = (impacts_of(way(tilted, deck, 0.7)) for way in (follow, follow_compliant))
    assert compliant.mode is rigid.mode
    assert compliant.linear_after == pytest.approx(rigid.linear_after, abs=0.03 * rigid.approach)


def test_it_goes_on_where_a_span_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compliant_deck, "SPAN", 0.5)
    unit = unit_of("box", box(friction=0.2))
    spans = list(follow_compliant(unit, a_deck(), 0.8))
    assert [span.time for span in spans] == pytest.approx([0.5, 0.8])
    ends, begins = (np.ravel(span.state(np.array([0.5]))) for span in spans)
    assert ends == pytest.approx(begins, abs=1e-9)


def test_a_toppled_unit_ends_there() -> None:
    tall = box(points=tuple((x, y, -2.0) for x in (-0.7, 0.7) for y in (-0.2, 0.2)))
    *_, last = follow_compliant(unit_of("tall", tall), a_deck(), 20.0)
    assert last.end is End.OVERTURNED
    assert last.time < 20.0
