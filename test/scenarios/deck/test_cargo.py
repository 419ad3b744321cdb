"""Units of a scene on a deck: where they stand, and how they move, against the motion in one piece."""

from __future__ import annotations

import itertools
from math import asin, pi, sqrt
from typing import Any

import numpy as np
import pytest
from cargo_scenes import a_deck, a_drum
from cargo_scenes import box as a_box

from impact_predictor.errors import InputError
from impact_predictor.mechanics.bodies import cylinder, plate
from impact_predictor.mechanics.motion import rock
from impact_predictor.mechanics.motion.support import FixedSupport
from impact_predictor.prediction.scene import Scene
from impact_predictor.scenarios.deck import cargo as deck_module
from impact_predictor.scenarios.deck.cargo import CargoUnit, Span, follow, remembered_border, unit_of

B, H, MASS, FRICTION = 0.4, 1.0, 500.0, 0.6


def box(**changes: Any) -> Scene:
    """The box with its upper points too."""
    points = tuple((x, y, z) for z in (-H, H) for x in (-0.7, 0.7) for y in (-B, B))
    return a_box(**{"points": points, **changes})


def motion_of(unit: CargoUnit, duration: float) -> list[Span]:
    return list(follow(unit, a_deck().at(*unit.foot), duration))


def test_a_box_stands_on_the_lower_edges_that_lie_along_the_deck() -> None:
    unit = unit_of("box", box())
    assert unit.contacts == ((0, 2), (1, 3))
    # About x, and turning off it is blocked by the edges.
    assert unit.body == plate(2 * B, 2 * H, MASS, FRICTION, inertia=200.0)
    assert unit.start[:3] == pytest.approx((5.0, H, 0.0), abs=1e-15)


def test_a_turned_box_stands_on_its_other_edges() -> None:
    unit = unit_of("box", box(yaw=0.5 * pi))
    # Its own x axis points to port: the points with x > 0 are to port.
    assert unit.contacts == ((0, 1), (2, 3))
    assert unit.body.new.x == pytest.approx(0.7)
    assert unit.body.inertia == pytest.approx(300.0)


def test_the_mass_centre_stands_where_the_frame_and_its_offset_say() -> None:
    unit = unit_of("box", box(center_of_mass=(0.1, 0.2, -0.3)))
    assert unit.start[:2] == pytest.approx((5.2, H - 0.3))
    assert unit.mount.beside == pytest.approx(3.1)
    old = unit.body.old
    assert old is not None
    assert (old.x, old.y, unit.body.new.x) == pytest.approx((-B - 0.2, 0.3 - H, B - 0.2))


def test_two_points_without_edges_are_a_free_body_s_contacts() -> None:
    scene = box(
        points=((0.0, -B, -H), (0.0, B, -H)), inertia=((200.0, 30.0, 0.0), (30.0, 300.0, 0.0), (0.0, 0.0, 50.0))
    )
    # 1 / (axis . I^-1 . axis): the body is free to turn off the axis.
    assert unit_of("box", scene).body.inertia == pytest.approx(200.0 - 30.0**2 / 300.0)


def test_a_drum_lies_between_its_edges_from_starboard_to_port() -> None:
    unit = unit_of("drum", a_drum())
    assert unit.contacts == ((1,), (0,))
    assert unit.foot == (3.7, 0.1)
    expected = cylinder(0.6, asin(0.5), MASS, FRICTION, inertia=90.0)
    assert expected.old is not None
    assert unit.body.old is not None
    for ours, theirs in ((unit.body.old, expected.old), (unit.body.new, expected.new)):
        assert (*ours[:3], *ours.normal) == pytest.approx((*theirs[:3], *theirs.normal))
    # Seen from the edge to starboard.
    assert unit.start[:2] == pytest.approx((0.3, 0.6 * sqrt(0.75)))


def test_a_drum_on_chocks_of_two_heights_touches_both() -> None:
    unit = unit_of("drum", a_drum(edges=((0.0, 3.7, 0.1), (0.0, 4.3, 0.3))))
    body, (x, y, *_) = unit.body, unit.start
    assert body.old is not None
    edges = [(x + contact.x, y + contact.y) for contact in (body.old, body.new)]
    assert edges[0] == pytest.approx((0.0, 0.0), abs=1e-12)
    assert edges[1] == pytest.approx((0.6, 0.2))


@pytest.mark.parametrize(
    ("scene", "sentence"),
    [
        (box(points=()), "box has no contact points; give body.contact_points"),
        (box(yaw=0.3), "box would turn out of the deck's y-z plane"),
        (box(normal=(0.0, 0.6, 0.8)), "support.normal of box"),
        (box(points=((-0.7, 0.0, -H), (0.7, 0.0, -H))), "box stands on one line along the deck's x axis"),
        (a_drum(edges=()), "box lies on 0 edges"),
        (a_drum(radius=0.2), "a drum of radius 0.2 m falls through"),
    ],
)
def test_what_cannot_be_simulated_in_the_plane_is_said_in_one_sentence(scene: Scene, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        unit_of("box", scene)


@pytest.mark.parametrize("scene", [box(), a_drum(edges=((0.0, 4.13, 0.1), (0.0, 3.87, 0.1)))], ids=["box", "drum"])
def test_the_truth_is_that_of_the_motion_in_one_piece(monkeypatch: pytest.MonkeyPatch, scene: Scene) -> None:
    # The spans cut through rest and motion alike.
    monkeypatch.setattr(deck_module, "SPAN", 3.7)
    unit = unit_of("one", scene)
    spans = motion_of(unit, 30.0)
    whole = rock(unit.body, unit.start, a_deck().at(*unit.foot), duration=30.0)
    assert len(spans) > 5
    for one, other in itertools.pairwise(spans):
        assert one.time == other.start
        ends, begins = one.state(np.array([one.time])), other.state(np.array([one.time]))
        assert np.ravel(ends) == pytest.approx(np.ravel(begins), abs=1e-9)
    large = [impact for span in spans for impact in span.impacts if impact.approach > 1e-3]
    assert len(large) > 10
    # What is carried on from span to span differs by rounding, which rocking magnifies.
    for impact in large:
        strike = min(whole.impacts, key=lambda one: abs(one.time - impact.stamp / 1e9))
        assert impact.stamp / 1e9 == pytest.approx(strike.time, abs=1e-6)
        assert impact.mode is strike.outcome.mode
        assert impact.new == unit.contacts[strike.new]
        # y to port and z up are the plane, and it turns about x.
        assert impact.linear_before == pytest.approx((0.0, strike.before.vx, strike.before.vy), abs=1e-5)
        assert impact.angular_after == pytest.approx((strike.after.omega, 0.0, 0.0), abs=1e-5)
        assert impact.energy_lost == pytest.approx(strike.outcome.energy_lost, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize("friction", [0.1, 0.6])
def test_onsets_are_where_a_unit_at_rest_begins_to_move(friction: float) -> None:
    unit = unit_of("box", box(friction=friction))
    whole = rock(unit.body, unit.start, a_deck().at(*unit.foot), duration=20.0)
    onsets = [onset for span in motion_of(unit, 20.0) for onset in span.onsets]
    left = [then for now, then in itertools.pairwise(whole.phases) if now.states == "SS" != then.states]
    assert len(onsets) == len(left) > 0
    for onset, phase in zip(onsets, left, strict=True):
        assert onset.stamp / 1e9 == pytest.approx(phase.start, abs=1e-6)
        assert onset.lifts == ("O" in phase.states)
        assert onset.slides == ("+" in phase.states or "-" in phase.states)


def test_a_border_is_the_smallest_relative_change_to_another_mode() -> None:
    # A plate that turns about a resting contact slips at the new one below f = 3 d / (4 d^2 + 1), d = height / length.
    delta = H / B
    border = 3.0 * delta / (4.0 * delta * delta + 1.0)
    inertia = MASS * (B * B + H * H) / 3.0
    for friction in (0.99 * border, 1.01 * border):
        scene = box(friction=friction, inertia=((inertia, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, 50.0)))
        unit = unit_of("box", scene)
        start = unit.start._replace(angle=0.05, y=unit.start.y + 0.02)
        strike = rock(unit.body, start, FixedSupport(), duration=5.0).impacts
        found = next(remembered_border(one, {}) for one in strike if one.old is not None)
        # The change against friction is the smallest: no shift of a hundredth of the half distance does as much.
        assert found == pytest.approx(0.01, rel=0.3)
