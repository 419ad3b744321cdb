"""What a measured body does on its support."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from touchdowns import SAMPLE

from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample, Vector3
from impact_predictor.prediction.watch.standing import CONFIRMED, BodyMotion, Standing

CORNERS = tuple((x, y, z) for x in (-0.4, 0.4) for y in (-0.3, 0.3) for z in (-0.5, 0.5))
INERTIA = ((5.0, 0.0, 0.0), (0.0, 6.0, 0.0), (0.0, 0.0, 3.0))
CRATE = Scene(mass=50.0, inertia=INERTIA, friction=0.5, points=CORNERS, place=(2.0, 1.0, 0.5))
EDGES = ((2.0, 0.9, 0.0), (2.0, 1.1, 0.0))
HIGH = math.sqrt(0.3**2 - 0.1**2)
DRUM = Scene(mass=50.0, inertia=INERTIA, friction=0.5, radius=0.3, edges=EDGES, place=(2.0, 1.0, HIGH))


def sample(position: Vector3, rotation: Rotation | None = None, time: float = 0.0, **changes: Any) -> Sample:
    orientation = tuple((rotation or Rotation.identity()).as_quat())
    return SAMPLE._replace(stamp=round(time * 1e9), position=position, orientation=orientation, **changes)


def rested() -> Standing:
    """The crate, which has been seen where it is placed."""
    standing = Standing(CRATE)
    standing.update(sample((2.0, 1.0, 0.5)))
    return standing


def shown(standing: Standing, seen: Sample) -> bool:
    """Show it often enough to be believed; whether the stance has changed."""
    changed = [standing.update(seen) for _ in range(CONFIRMED)]
    return any(changed)


def tipped(angle: float) -> Sample:
    """The crate at (2, 1), turned about its port edge."""
    rotation, pivot = Rotation.from_euler("x", -angle), (0.0, 0.3, -0.5)
    x, y, z = np.add((2.0, 1.0, 0.5), pivot) - rotation.apply(pivot)
    return sample((x, y, z), rotation)


def test_a_body_stands_where_it_is_placed_before_anything_is_measured() -> None:
    standing = Standing(CRATE._replace(yaw=0.3))
    assert standing.motion is BodyMotion.UNKNOWN
    assert standing.tilt is None
    assert standing.solid
    assert len(standing.stance.edges) == 4
    assert standing.stance.center == pytest.approx((2.0, 1.0, 0.5))
    # Turned by 0.3 rad to port: its front edge looks 17 degrees to port of fore, which still is fore.
    assert sorted(edge.name for edge in standing.stance.edges) == ["aft", "fore", "port", "starboard"]


@pytest.mark.parametrize("angle", [0.05, 0.3])
def test_a_body_that_rocks_has_the_one_edge_it_turns_about(angle: float) -> None:
    standing = rested()
    assert shown(standing, tipped(angle))
    assert standing.motion is BodyMotion.ROCKS
    assert standing.tilt == pytest.approx(angle)
    (edge,) = standing.stance.edges
    assert edge.name == "port"
    assert edge.point[1:] == pytest.approx((1.3, 0.0))


def test_a_body_on_another_side_has_toppled_and_stands_there() -> None:
    standing = rested()
    standing.update(tipped(0.4))
    assert not standing.toppled
    standing.update(tipped(0.5 * math.pi))
    assert standing.toppled
    assert standing.motion is BodyMotion.STANDS
    assert standing.tilt == pytest.approx(0.5 * math.pi)
    assert len(standing.stance.edges) == 4
    # Its mass centre is as far from its new edges as it was high.
    assert max(abs(edge.point[1] - standing.stance.center[1]) for edge in standing.stance.edges) == pytest.approx(0.5)
    standing.update(sample((2.0, 1.0, 0.5)))
    assert (standing.toppled, standing.tilt) == (False, pytest.approx(0.0))
    standing.update(tipped(0.5 * math.pi))
    assert standing.toppled


@pytest.mark.parametrize(
    ("first", "then", "words"),
    [
        (0.5, 0.45, "sinks into the deck, by 0.050 m"),
        (0.5, 0.55, ""),
        (0.45, 0.5, "rises from where it stood, by 0.050 m"),
    ],
)
def test_a_body_that_moves_across_the_deck_does_not_slide(first: float, then: float, words: str) -> None:
    standing = Standing(CRATE)
    standing.update(sample((2.0, 1.0, first)))
    shown(standing, sample((2.0, 1.0, then), time=0.1))
    assert standing.slid == words


def test_the_side_on_which_it_is_first_seen_is_its_own() -> None:
    standing = Standing(CRATE)
    standing.update(tipped(0.5 * math.pi))
    assert not standing.toppled
    assert standing.tilt == pytest.approx(0.0, abs=1e-7)
    assert standing.motion is BodyMotion.STANDS


def test_a_body_that_is_first_seen_upside_down_stands_so() -> None:
    standing = Standing(CRATE)
    shown(standing, sample((2.0, 1.0, 0.5), Rotation.from_euler("x", math.pi)))
    assert standing.motion is BodyMotion.STANDS
    assert not standing.toppled
    assert standing.tilt == pytest.approx(0.0, abs=1e-7)  # the cosine rounds


def test_a_tilt_within_the_contact_tolerance_is_no_rocking() -> None:
    # The crate is 0.6 m wide and its far edge rises by 15 mm.
    standing = Standing(CRATE._replace(tolerance=0.01))
    standing.lean(sample((0.0, 0.0, 0.0), Rotation.from_euler("x", -0.025)).orientation)
    assert standing.motion is BodyMotion.STANDS
    standing.lean(sample((0.0, 0.0, 0.0), Rotation.from_euler("x", -0.04)).orientation)
    assert standing.motion is BodyMotion.ROCKS


def test_a_tilt_tells_rocking_of_a_body_whose_points_nobody_knows() -> None:
    standing = Standing(CRATE._replace(points=()))
    standing.lean(sample((0.0, 0.0, 0.0), Rotation.from_euler("xyz", (-0.03, 0.01, 0.02))).orientation)
    assert standing.motion is BodyMotion.ROCKS
    assert standing.stance.center == pytest.approx(CRATE.place)  # it leans where it is placed


def test_a_tilt_alone_tells_rocking_but_no_misalignment_of_sensors() -> None:
    standing = Standing(CRATE)
    for angle, motion in ((0.01, BodyMotion.STANDS), (0.1, BodyMotion.ROCKS), (0.0, BodyMotion.STANDS)):
        standing.lean(sample((0.0, 0.0, 0.0), Rotation.from_euler("x", -angle)).orientation)
        assert standing.motion is motion
        assert standing.tilt == pytest.approx(angle, abs=1e-7)
    standing.lean(sample((0.0, 0.0, 0.0), Rotation.from_euler("x", -0.1)).orientation)
    assert [edge.name for edge in standing.stance.edges] == ["port"]
    # It has turned about the port edge where it was placed.
    assert standing.stance.edges[0].point[1:] == pytest.approx((1.3, 0.0))


def test_a_drum_rolls_over_an_edge_spins_and_leaves() -> None:
    standing = Standing(DRUM)
    assert [edge.name for edge in standing.stance.edges] == ["starboard", "port"]
    standing.update(sample((2.0, 1.0, HIGH)))
    assert standing.motion is BodyMotion.STANDS
    angle = 0.2
    dy, dz = -0.1, HIGH
    y, z = (
        1.1 + dy * math.cos(angle) + dz * math.sin(angle),
        dz * math.cos(angle) - dy * math.sin(angle),
    )
    shown(standing, sample((2.0, y, z), Rotation.from_euler("x", -angle), time=0.1))
    assert standing.motion is BodyMotion.ROCKS
    assert [edge.name for edge in standing.stance.edges] == ["port"]
    standing.update(sample((2.0, 1.0, HIGH), time=0.2))
    assert standing.motion is BodyMotion.STANDS
    assert not standing.slid
    shown(standing, sample((2.0, 1.0, HIGH), Rotation.from_euler("x", 0.1), time=0.3))
    assert standing.slid.startswith("spins on its edges, by 0.030 m")
    shown(standing, sample((2.0, 2.0, 0.3), time=0.4))
    assert standing.motion is BodyMotion.LIFTS


def test_a_drum_that_is_placed_roughly_lies_on_its_edges() -> None:
    stance = Standing(DRUM._replace(place=(2.5, 1.02, 0.4))).stance
    assert stance.center == pytest.approx((2.5, 1.0, HIGH))
    assert [edge.point for edge in stance.edges] == [pytest.approx((2.5, 0.9, 0.0)), pytest.approx((2.5, 1.1, 0.0))]


def test_a_single_outlier_is_neither_rocking_nor_a_slide() -> None:
    standing = Standing(CRATE)
    for k in range(30):
        seen = (tipped(0.1), sample((2.0, 1.1, 0.5)), sample((2.0, 1.0, 0.7)))[k // 10] if k % 10 == 5 else None
        standing.update((seen or sample((2.0, 1.0, 0.5)))._replace(stamp=k * 50_000_000))
        assert standing.motion is BodyMotion.STANDS
        assert not standing.slid
        assert len(standing.stance.edges) == 4


@pytest.mark.parametrize(("speed", "slides"), [(0.01, True), (0.0005, False)])
def test_a_body_that_creeps_slides_and_one_whose_pose_drifts_does_not(speed: float, slides: bool) -> None:
    standing, slid = Standing(CRATE), ""
    for time in np.arange(100.0, 120.0, 0.05).tolist():
        standing.update(sample((2.0 + speed * (time - 100.0), 1.0, 0.5), time=time))
        slid = slid or standing.slid
    assert bool(slid) == slides


@pytest.mark.parametrize("seed", range(5))
def test_noise_of_a_pose_within_the_contact_tolerance_raises_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    standing = Standing(CRATE)
    for k in range(2000):
        x, y, z = rng.normal((2.0, 1.0, 0.5), 0.0015).tolist()
        standing.update(sample((x, y, z), Rotation.from_rotvec(rng.normal(0.0, 0.0015, 3)), time=0.05 * k))
        assert standing.motion is BodyMotion.STANDS
        assert not standing.slid
