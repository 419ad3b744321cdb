"""Messages in frames that transforms connect to those of the scene."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.flaws import flaw_of
from impact_predictor.prediction.frames import FrameTree
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import FeetStates, Geometry, Prediction, Sample, Status, Terrain, Transform
from impact_predictor.prediction.vectors import composed, conjugate, turned
from impact_predictor.stamps import NANOSECONDS

UNKNOWN = (0.0,) * 36
LEVEL = (0.0, 0.0, 0.0, 1.0)


def matrix(orientation: Any) -> NDArray[np.float64]:
    """The rotation of a quaternion, from its definition: the images of the three axes."""
    images = []
    for axis in np.eye(3):
        image = composed(composed(orientation, (*axis, 0.0)), conjugate(orientation))
        images.append(image[:3])
    return np.array(images).T


def pose(seed: int) -> tuple[Any, Any]:
    rng = np.random.default_rng(seed)
    return tuple(rng.normal(size=3).tolist()), turned(LEVEL, tuple(rng.normal(size=3).tolist()))


def fixed(parent: str, child: str, seed: int) -> Transform:
    return Transform(0, parent, child, *pose(seed))


def sample_of(child: str, frame: str, position: Any, orientation: Any, linear: Any, angular: Any) -> Sample:
    return Sample(10**9, frame, child, position, orientation, linear, angular, UNKNOWN, UNKNOWN)


def tree_of(*transforms: Transform, moving: tuple[Transform, ...] = ()) -> FrameTree:
    tree = FrameTree()
    assert tree.take(transforms, is_fixed=True) is Status.ACCEPTED
    assert tree.take(moving, is_fixed=False) is Status.ACCEPTED
    return tree


def test_a_sample_of_a_sensor_becomes_that_of_the_body_whichever_way_the_transforms_point() -> None:
    up, down, there = fixed("base", "imu", 1), fixed("mount", "base", 2), fixed("world", "map", 3)
    place, turn = pose(4)
    linear, angular = (0.3, -0.2, 0.5), (1.0, 2.0, -0.5)
    told = sample_of("imu", "map", place, turn, linear, angular)
    seen = tree_of(up, down, there).seen(told, ("world",), "mount")
    assert seen is not None
    # By matrices: from the mount to the sensor, and from the map to the world.
    to_imu, to_base, to_map = matrix(up.orientation), matrix(down.orientation), matrix(there.orientation)
    rotation = to_map @ matrix(turn)
    of_mount = rotation @ (to_base @ to_imu).T
    arm = -rotation @ (to_base @ to_imu).T @ (np.array(down.position) + to_base @ np.array(up.position))
    origin = to_map @ np.array(place) + there.position
    assert seen.frame_id == "world"
    assert seen.child_frame_id == "mount"
    np.testing.assert_allclose(seen.position, origin + arm, atol=1e-12)
    np.testing.assert_allclose(matrix(seen.orientation), of_mount, atol=1e-12)
    spin = rotation @ angular
    np.testing.assert_allclose(seen.angular, of_mount.T @ spin, atol=1e-12)
    np.testing.assert_allclose(seen.linear, of_mount.T @ (rotation @ linear + np.cross(spin, arm)), atol=1e-12)


def test_a_sensor_that_moves_on_the_body_takes_its_own_motion_out_of_the_twist() -> None:
    """A head that nods and slides on a trunk, which itself turns and falls: what the head tells is the trunk's."""
    step, rate, slide = 0.01, 1.5, (0.2, 0.0, -0.1)

    def head(time: float) -> tuple[Any, Any]:
        return (0.3 + slide[0] * time, 0.0, 0.4 + slide[2] * time), (
            0.0,
            sin(0.5 * rate * time),
            0.0,
            cos(0.5 * rate * time),
        )

    def trunk(time: float) -> tuple[Any, Any]:
        return (1.0 + 0.5 * time, -0.2 * time, 2.0 - time), turned(LEVEL, (0.4 * time, 0.0, -0.7 * time))

    def of_head(time: float) -> tuple[Any, Any]:
        (place, turn), (arm, nod) = trunk(time), head(time)
        return matrix(turn) @ arm + place, composed(turn, nod)

    moving = tuple(Transform(k * 10_000_000 + 1, "trunk", "head", *head(k * step)) for k in range(5))
    tree, tiny = tree_of(moving=moving), 1e-6
    for time in (0.02, 0.0234):
        (before, turned_so), (place, turn), (after, _) = (of_head(time + dt) for dt in (-tiny, 0.0, tiny))
        velocity = matrix(turn).T @ ((after - before) / (2.0 * tiny))
        turning = matrix(head(time)[1]).T @ np.array((0.4, rate, -0.7))
        told = sample_of("head", "world", tuple(place), turn, tuple(velocity), tuple(turning))
        seen = tree.seen(told._replace(stamp=round(time * NANOSECONDS) + 1), ("world",), "trunk")
        assert seen is not None
        np.testing.assert_allclose(seen.position, trunk(time)[0], atol=1e-9)
        np.testing.assert_allclose(matrix(seen.orientation), matrix(trunk(time)[1]), atol=1e-9)
        np.testing.assert_allclose(seen.linear, matrix(trunk(time)[1]).T @ (0.5, -0.2, -1.0), atol=1e-6)
        np.testing.assert_allclose(seen.angular, (0.4, 0.0, -0.7), atol=1e-9)
        assert turned_so != turn


def test_between_two_stamps_a_frame_moves_on_a_line_and_turns_about_one_axis() -> None:
    first, second = Transform(1, "a", "b", (0.0, 0.0, 0.0), LEVEL), Transform(NANOSECONDS // 5 + 1, "a", "b", *pose(6))
    tree = tree_of(moving=(second, first))
    asked = Geometry(NANOSECONDS // 20 + 1, "b", ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    places = tree.brought(asked, "a").points
    np.testing.assert_allclose(places[0], 0.25 * np.array(second.position), atol=1e-12)
    # Four quarters of the turn are the whole.
    quarter, whole = np.subtract(places[1], places[0]), matrix(second.orientation)[:, 0]
    cosine, axis = (np.trace(matrix(second.orientation)) - 1.0) / 2.0, np.array(second.orientation[:3])
    angle, axis = 0.25 * np.arccos(cosine), axis / np.linalg.norm(axis)
    turned_once = turned(LEVEL, tuple(angle * axis))
    np.testing.assert_allclose(quarter, matrix(turned_once)[:, 0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.matrix_power(matrix(turned_once), 4)[:, 0], whole, atol=1e-12)


def test_points_velocities_forces_and_heights_are_brought_too() -> None:
    link = fixed("base", "leg", 7)
    turn, arm = matrix(link.orientation), np.array(link.position)
    tree = tree_of(link)
    points, rates = ((0.1, 0.2, -0.5), (0.0, 0.0, 0.3)), ((1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    feet = tree.brought(FeetStates(5, "leg", ("left", "right"), points, rates, rates), "base")
    np.testing.assert_allclose(feet.positions, np.array(points) @ turn.T + arm, atol=1e-12)
    np.testing.assert_allclose(feet.velocities, np.array(rates) @ turn.T, atol=1e-12)
    np.testing.assert_allclose(feet.forces, feet.velocities, atol=1e-12)
    terrain = tree.brought(Terrain(5, "leg", np.array(points)), "base")
    np.testing.assert_allclose(terrain.points, feet.positions, atol=1e-12)
    assert (feet.frame_id, terrain.frame_id) == ("base", "base")
    same = Geometry(5, "base", points)
    assert tree.brought(same, "base") is same


def test_covariances_are_those_of_many_samples_that_are_brought_each() -> None:
    """What noise of a sensor's pose and twist makes of the body's, in first order."""
    link, world = fixed("base", "imu", 8), fixed("world", "map", 9)
    tree, size = tree_of(link, world), 1e-5
    rng = np.random.default_rng(10)
    root = np.tril(rng.normal(size=(6, 6)))
    pose_root = np.tril(rng.normal(size=(6, 6)))
    told = sample_of("imu", "map", *pose(11), (0.3, -0.2, 0.5), (1.0, 2.0, -0.5))
    told = told._replace(
        twist_covariance=tuple((root @ root.T).ravel()), pose_covariance=tuple((pose_root @ pose_root.T).ravel())
    )
    seen = tree.seen(told, ("world",), "base")
    assert seen is not None
    moves = []
    for column in (size * root).T:
        other = tree.seen(
            told._replace(linear=tuple(told.linear + column[:3]), angular=tuple(told.angular + column[3:])),
            ("world",),
            "base",
        )
        assert other is not None
        moves.append(np.subtract([*other.linear, *other.angular], [*seen.linear, *seen.angular]) / size)
    expected = np.array(moves).T @ np.array(moves)
    np.testing.assert_allclose(np.reshape(seen.twist_covariance, (6, 6)), expected, atol=1e-8)
    moves = []
    for column in (size * pose_root).T:
        # A rotation about axes of the header, as the message defines it.
        turn = composed(turned(LEVEL, tuple(column[3:])), told.orientation)
        place = tuple(told.position + column[:3])
        other = tree.seen(told._replace(position=place, orientation=turn), ("world",), "base")
        assert other is not None
        change = composed(other.orientation, conjugate(seen.orientation))
        moves.append([*np.subtract(other.position, seen.position) / size, *(2.0 * np.array(change[:3]) / size)])
    expected = np.array(moves).T @ np.array(moves)
    np.testing.assert_allclose(np.reshape(seen.pose_covariance, (6, 6)), expected, atol=1e-3)
    # What a source fills in where it knows nothing stays as it is.
    unknown = tree.seen(told._replace(twist_covariance=(1.7e308,) * 36), ("world",), "base")
    assert unknown is not None
    assert unknown.twist_covariance == (1.7e308,) * 36


@pytest.mark.parametrize(
    ("transforms", "moving", "flaw"),
    [
        ((), (), "no transforms on /tf and /tf_static connect 'base' and 'imu'"),
        ((fixed("base", "leg", 1),), (), "connect 'base' and 'imu'"),
        ((fixed("base", "imu", 1), fixed("imu", "base", 2)), (), "connect 'base' and 'imu', which lie in a loop"),
        ((fixed("imu", "imu", 1), fixed("base", "leg", 2)), (), "connect 'base' and 'imu', which lie in a loop"),
        (
            (),
            (
                Transform(NANOSECONDS // 2, "base", "imu", *pose(1)),
                Transform(NANOSECONDS - 10**7, "base", "imu", *pose(2)),
            ),
            "what /tf tells of 'imu' in 'base' ended 0.01 s before the stamp",
        ),
        ((), (Transform(NANOSECONDS + 10**7, "base", "imu", *pose(1)),), "begins 0.01 s after the stamp"),
    ],
)
def test_where_no_transform_leads_to_the_frame_it_is_said_why(
    transforms: tuple[Transform, ...], moving: tuple[Transform, ...], flaw: str
) -> None:
    tree = tree_of(*transforms, moving=moving)
    assert tree.seen(sample_of("imu", "world", *pose(1), (0.0,) * 3, (0.0,) * 3), (), "base") is None
    assert flaw in tree.flaw
    assert tree.brought(Geometry(NANOSECONDS, "imu", ((0.0, 0.0, 0.0),)), "base") is None


def test_of_several_frames_that_will_do_the_nearest_is_taken() -> None:
    """A hold that is fixed in a ship is at rest there; in the world it is not, whatever connects the two."""
    told = sample_of("crate", "hold", *pose(1), (0.0,) * 3, (0.0,) * 3)
    tree = tree_of(fixed("map", "world", 1), fixed("world", "deck", 2), fixed("deck", "hold", 3))
    for frame, nearest in (("hold", "deck"), ("map", "world")):
        seen = tree.seen(told._replace(frame_id=frame), ("world", "deck"), "")
        assert seen is not None
        assert seen.frame_id == nearest


def test_what_is_remembered_is_bounded_and_a_clock_that_starts_anew_begins_anew() -> None:
    tree = FrameTree()
    for k in range(2_000):
        tree.take([Transform(k * 10**7 + 1, "a", "b", (float(k), 0.0, 0.0), LEVEL)], is_fixed=False)
    (branch,) = tree._branches.values()
    assert len(branch.poses) == 1_001
    tree.take([Transform(2 * 10**9 + 1, "a", "b", (5.0, 0.0, 0.0), LEVEL)], is_fixed=False)
    assert tree.brought(Geometry(0, "b", ((0.0, 0.0, 0.0),)), "a").points == ((5.0, 0.0, 0.0),)
    assert tree.brought(Geometry(19 * 10**9, "b", ((0.0, 0.0, 0.0),)), "a") is None
    # Another parent, or none that moves any more, leaves nothing of before.
    tree.take([Transform(7, "c", "b", (1.0, 0.0, 0.0), LEVEL)], is_fixed=True)
    assert tree.brought(Geometry(99, "b", ((0.0, 0.0, 0.0),)), "c").points == ((1.0, 0.0, 0.0),)


def test_a_fixed_frame_that_is_told_anew_is_where_it_was_told_last() -> None:
    tree, asked = tree_of(fixed("a", "b", 1), fixed("b", "c", 2)), Geometry(5, "c", ((0.0, 0.0, 0.0),))
    before = tree.brought(asked, "a").points
    assert tree.brought(asked, "a").points == before
    tree.take([Transform(0, "b", "c", (0.0, 0.0, 0.0), LEVEL)], is_fixed=True)
    np.testing.assert_allclose(tree.brought(asked, "a").points, [fixed("a", "b", 1).position], atol=1e-15)


def test_transforms_that_are_none_are_refused_and_change_nothing() -> None:
    tree = tree_of(fixed("a", "b", 1))
    nan, long = float("nan"), (0.0, 0.0, 0.0, 2.0)
    assert tree.take([Transform(0, "a", "b", (nan, 0.0, 0.0), LEVEL)], is_fixed=True) is Status.NOT_FINITE
    assert tree.take([Transform(0, "a", "b", (0.0,) * 3, long), fixed("b", "c", 2)], True) is Status.BAD_QUATERNION
    assert tree.brought(Geometry(0, "c", ((0.0, 0.0, 0.0),)), "a") is not None


DECK = {
    "body.mass": 12.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.3,
    "support.motion": "odom",
    "support.frame": "deck",
    "support.window": 0.1,
    "odom.twist": "message",
}
CRATE = tuple((a, b, c) for a in (-0.3, 0.3) for b in (-0.2, 0.2) for c in (-0.2, 0.2))


def on_deck(monitor: Monitor, k: int, tree: FrameTree | None) -> Prediction:
    """The answer to a crate that falls on a deck that rolls; as sensors elsewhere tell it, where a tree has them."""
    stamp = (100 + k) * 10**7
    deck = sample_of(
        "deck", "world", (0.0, 0.0, 2.0), turned(LEVEL, (0.2 * k * 0.01, 0.0, 0.0)), (0.0,) * 3, (0.2, 0.0, 0.0)
    )
    crate = sample_of(
        "crate", "deck", (0.5, -0.4, 0.25), turned(LEVEL, (0.1, 0.05, 0.0)), (0.0, 0.0, -0.3), (0.1, 0.0, 0.0)
    )
    points = Geometry(stamp, "crate", CRATE)
    if tree is not None:
        (away, aside), (low, askew) = pose(21), pose(22)
        tree.take([Transform(0, "deck", "mru", away, aside), Transform(0, "deck", "hold", low, askew)], is_fixed=True)
        tree.take([Transform(0, "crate", "tag", (0.0, 0.0, 0.1), (0.0, 0.0, 1.0, 0.0))], is_fixed=True)
        sensed, seen = tree.seen(deck, (), "mru"), tree.seen(crate, ("hold",), "tag")
        assert sensed is not None
        assert seen is not None
        deck, crate, points = sensed, seen, tree.brought(points, "tag")
    assert monitor.update_support(deck._replace(stamp=stamp)) is Status.ACCEPTED
    assert monitor.tell("", points) is Status.ACCEPTED
    return monitor.update("", crate._replace(stamp=stamp))


def test_a_crate_in_a_hold_under_a_sensor_elsewhere_on_the_ship_is_told_as_on_the_deck() -> None:
    plain, elsewhere = (Monitor(scenes_of(validate({**DECK, **more}))) for more in ({}, {"tf.body_frame": "crate"}))
    assert elsewhere.tree is not None
    for k in range(12):
        expected, told = on_deck(plain, k, None), on_deck(elsewhere, k, elsewhere.tree)
        assert told.status is expected.status
    assert expected.touchdown is not None
    assert told.touchdown is not None
    assert (told.sample.frame_id, told.sample.child_frame_id) == ("deck", "crate")
    assert told.touchdown.lead_time == pytest.approx(expected.touchdown.lead_time, rel=1e-6)
    np.testing.assert_allclose(told.touchdown.after_6d, expected.touchdown.after_6d, atol=1e-6)


def test_what_no_transform_connects_is_refused_with_its_frames_and_so_is_another_support() -> None:
    plain, asked = (Monitor(scenes_of(validate({**DECK, **more}))) for more in ({}, {"tf.body_frame": "crate"}))
    told = sample_of("mru", "world", (0.0,) * 3, LEVEL, (0.0,) * 3, (0.0,) * 3)
    assert asked.update_support(told) is Status.NO_TRANSFORM
    said = flaw_of(asked, None, Status.NO_TRANSFORM, told)
    assert said == "no transforms on /tf and /tf_static connect 'deck' and 'mru'"
    assert asked.tell("", Geometry(0, "leg", CRATE)) is Status.NO_TRANSFORM
    assert "'leg' and 'crate'" in flaw_of(asked, "", Status.NO_TRANSFORM, told)
    assert plain.update_support(told) is Status.ACCEPTED
    other = told._replace(stamp=told.stamp + 10**7, frame_id="map")
    assert plain.update_support(other) is Status.WRONG_FRAME
    said = flaw_of(plain, None, Status.WRONG_FRAME, other)
    assert said == "it tells of 'mru' in 'map', but those before of 'mru' in 'world': one source may tell"
