"""What is drawn for RViz 2 and Foxglove: its bytes against rosbags and rclpy, and that it shows what was predicted."""

from __future__ import annotations

import itertools
import random
from math import cos, dist, hypot, pi, sin
from typing import Any

import numpy as np
import pytest
from messages_of_rosbags import TYPESTORE, padded, serialize

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import MovingDeck, Scene, Watching
from impact_predictor.prediction.types import Felt, Geometry, Moment, Prediction, Sample, Status, Vector3
from impact_predictor.prediction.vectors import axes_of, to_world, turn_to
from impact_predictor.prediction.watch.watch import Level, Report
from impact_predictor.ros.markers.body import PAUSE, shape_of
from impact_predictor.ros.markers.message import (
    ARROW,
    CUBE,
    CUBE_LIST,
    CYLINDER,
    DELETE,
    DELETE_ALL,
    LINE_LIST,
    SPHERE_LIST,
    TEXT,
    Marker,
    encode_markers,
)
from impact_predictor.ros.markers.scene import PERIOD, MarkerScene, deck_of
from impact_predictor.ros.messages import MARKER_ARRAY

SECOND = 1_000_000_000
NO_COVARIANCE = (0.0,) * 36

WIDTH, HEIGHT, MASS = 1.0, 1.6, 10.0
BOTTOM: tuple[Vector3, ...] = tuple((x, y, -0.5 * HEIGHT) for x in (-0.4, 0.4) for y in (-0.5 * WIDTH, 0.5 * WIDTH))
INERTIA = tuple(tuple(2.0 * (i == k) for k in range(3)) for i in range(3))
BOX = Scene(MASS, INERTIA, 0.6, points=BOTTOM)  # type: ignore[arg-type]
DECK = MovingDeck(extent=(-10.0, 10.0, -4.0, 4.0))
ROLLED = Felt((0.0, 9.81 * sin(0.1), -9.81 * cos(0.1)), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
MOMENT = Moment(
    SECOND,
    "world",
    "deck",
    (0.0, 0.0, 0.0),
    (sin(0.05), 0.0, 0.0, cos(0.05)),
    (0.0, 0.0, 0.0),
    ROLLED,
    lambda _: ROLLED,
)


def tilted(stamp: int, angle: float = 0.05, omega: float = -0.8, frame: str = "world") -> Sample:
    """The box turned by `angle` in rad about the edge of points 0 and 2, at -y, and falling back about it."""
    y, z = -0.5 * WIDTH, 0.0
    arm_y, arm_z = 0.5 * WIDTH, 0.5 * HEIGHT
    c, s = cos(angle), sin(angle)
    across, up = c * arm_y - s * arm_z, s * arm_y + c * arm_z
    velocity = -omega * up, omega * across
    return Sample(
        stamp,
        frame,
        "box",
        (0.0, y + across, z + up),
        (sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle)),
        (0.0, c * velocity[0] + s * velocity[1], -s * velocity[0] + c * velocity[1]),
        (omega, 0.0, 0.0),
        NO_COVARIANCE,
        NO_COVARIANCE,
    )


def standing(stamp: int) -> Sample:
    return tilted(stamp, 0.0, 0.0)


def decode(data: bytes) -> list[Any]:
    return list(TYPESTORE.deserialize_cdr(data, MARKER_ARRAY).markers)  # type: ignore[attr-defined]


def find(markers: list[Any], namespace: str, number: int = 0) -> Any:
    (found,) = [marker for marker in markers if (marker.ns, marker.id) == (namespace, number)]
    return found


def triple(point: Any) -> tuple[float, float, float]:
    return point.x, point.y, point.z


def scene_of(prediction: Prediction, scene: Scene = BOX) -> MarkerScene:
    """The drawing of a body alone that has taken an answer."""
    found = MarkerScene({"": scene})
    found.take("", prediction)
    return found


def drawn(scene: MarkerScene, stamp: int) -> list[Any]:
    data = scene.due(stamp)
    assert data is not None
    return decode(data)


def report(body: str, level: Level, **values: str) -> Report:
    usual = {"status": "ACCEPTED", "tip_ratio": "0.820", "slide_ratio": "0.410"}
    usual |= {"time_to_tip": "1.50", "time_to_slide": "inf"}
    return Report(body, SECOND, level, "words", usual | values)


@pytest.fixture
def predicted() -> Prediction:
    prediction = Predictor(BOX).update(tilted(SECOND))
    assert prediction.touchdown is not None
    return prediction


def test_the_bytes_are_those_of_rosbags_and_rclpy_at_every_alignment() -> None:
    rng = random.Random(3)
    serialization = pytest.importorskip("rclpy.serialization", reason="ROS is not installed: rclpy is not compared")
    from visualization_msgs.msg import MarkerArray

    for length in range(9):
        markers = [
            Marker(
                namespace="n" * rng.randrange(9),
                number=rng.randrange(-5, 99),
                points=tuple((rng.gauss(0, 1), 2.0, 3.0) for _ in range(rng.randrange(3))),
                position=(rng.gauss(0, 1), rng.gauss(0, 1), 5e-324),
                orientation=(0.0, 0.6, 0.0, 0.8),
                text="é" * rng.randrange(5),
                scale=(1.0, 2.0, 3.0),
                look=(rng.randrange(10), (0.25, 0.5, 0.75, 1.0)),
                action=DELETE if rng.random() < 0.2 else 0,
            )
            for _ in range(length)
        ]
        data = encode_markers(markers, 12 * SECOND + 5, "f" * length)
        message = TYPESTORE.deserialize_cdr(data, MARKER_ARRAY)
        assert data == padded(serialize(message, MARKER_ARRAY))
        of_rclpy = serialization.deserialize_message(data, MarkerArray)
        for marker, of_rosbags, one in zip(markers, message.markers, of_rclpy.markers, strict=True):  # type: ignore[attr-defined]
            assert (one.ns, one.id, (one.type, (one.color.r, one.color.g, one.color.b, one.color.a))) == (
                *marker[:2],
                marker.look,
            )
            assert (one.action, one.text) == (marker.action, marker.text)
            assert triple(one.pose.position) == marker.position == triple(of_rosbags.pose.position)
            assert [triple(point) for point in one.points] == list(marker.points)
            assert (one.header.frame_id, one.header.stamp.sec, one.header.stamp.nanosec) == ("f" * length, 12, 5)
            assert one.lifetime.sec > 0
            assert one.frame_locked


@pytest.mark.parametrize(
    ("center", "points", "position", "scale"),
    [
        # As high above its mass centre as its points lie below.
        ((0.0, 0.0, 0.0), BOTTOM, (0.0, 0.0, 0.0), (0.8, WIDTH, HEIGHT)),
        # All its corners are known.
        ((0.4, 0.5, 0.6), tuple(itertools.product((0.0, 1.0), repeat=3)), (0.5, 0.5, 0.5), (1.0, 1.0, 1.0)),
    ],
)
def test_points_that_are_corners_of_a_box_are_drawn_as_one(
    center: Vector3, points: tuple[Vector3, ...], position: Vector3, scale: Vector3
) -> None:
    shape = shape_of(BOX._replace(center_of_mass=center), points)
    assert shape is not None
    assert (shape.shape, shape.position) == (CUBE, position)
    assert shape.scale == pytest.approx(scale)
    edges = {frozenset(ends) for ends in zip(shape.outline[::2], shape.outline[1::2], strict=True)}
    lengths = sorted(dist(*edge) for edge in edges)
    assert lengths == pytest.approx(sorted(4 * scale))  # twelve, four along each side


def test_points_that_are_no_corners_of_a_box_are_drawn_as_lines_from_the_mass_centre() -> None:
    feet = ((0.4, 0.3, -0.5), (0.5, -0.3, -0.5), (-0.4, 0.2, -0.4), (-0.3, -0.3, -0.5))
    shape = shape_of(BOX, feet)
    assert shape is not None
    assert shape.shape == LINE_LIST
    assert shape.outline[0::2] == ((0.0, 0.0, 0.0),) * 4
    assert shape.outline[1::2] == feet
    assert shape_of(BOX, ()) is None


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.6, 0.0, -0.8)])
def test_z_is_turned_to_any_direction(direction: Vector3) -> None:
    turn = turn_to(direction)
    assert hypot(*turn) == pytest.approx(1.0)
    assert axes_of(turn)[2] == pytest.approx(direction, abs=1e-12)  # rounding of a unit quaternion


def test_the_ghost_stands_where_the_body_is_predicted_to_touch_down(predicted: Prediction) -> None:
    scene = scene_of(predicted)
    ghost = find(drawn(scene, SECOND), "touchdown/body")
    touchdown = predicted.touchdown
    assert touchdown is not None
    assert triple(ghost.pose.position) == touchdown.position
    # Back on its bottom.
    assert touchdown.position == pytest.approx((0.0, 0.0, 0.5 * HEIGHT), abs=1e-9)
    assert ghost.type == LINE_LIST


def test_the_arrows_are_the_impulses_that_change_the_momentum_of_the_mass_centre() -> None:
    # Of so little inertia that both contacts push.
    compact = BOX._replace(inertia=((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)))
    predicted = Predictor(compact).update(tilted(SECOND))
    markers = drawn(scene_of(predicted, compact), SECOND)
    touchdown = predicted.touchdown
    assert touchdown is not None
    arrows = [find(markers, "touchdown/impulse", k) for k in range(2)]
    ways = np.array([np.subtract(triple(arrow.points[1]), triple(arrow.points[0])) for arrow in arrows])
    # In the plane d, n of the impact; d = axis x n = +-y here.
    d = np.cross(touchdown.axis, BOX.normal)
    change = np.subtract(touchdown.after[:2], touchdown.before[:2])
    total = ways.sum(axis=0)
    assert [total @ d, total[2]] == pytest.approx(total[2] / change[1] * change, rel=1e-9)
    longest = hypot(*ways[1])
    assert longest == pytest.approx(hypot(*touchdown.impulses[1]) / MASS * (WIDTH / 9.81) ** 0.5, rel=1e-9)
    # At the edges that stand, and that strike; on the way down it slips by less than 0.1 mm.
    assert triple(arrows[0].points[0]) == pytest.approx((0.0, -0.5 * WIDTH, 0.0), abs=1e-4)
    assert triple(arrows[1].points[0]) == pytest.approx((0.0, 0.5 * WIDTH, 0.0), abs=1e-4)
    assert {arrow.type for arrow in arrows} == {ARROW}


def test_contacts_that_stand_that_strike_and_that_are_open_differ_in_form(predicted: Prediction) -> None:
    corners = BOTTOM + tuple((x, y, -z) for x, y, z in BOTTOM)
    markers = drawn(scene_of(predicted, BOX._replace(points=corners)), SECOND)
    forms = {}
    for kind in ("standing", "striking", "open"):
        marker = find(markers, f"contacts/{kind}")
        forms[kind] = marker.type, marker.scale.x
        places = {triple(point) for point in marker.points}
        wanted = {"standing": BOTTOM[0::2], "striking": BOTTOM[1::2], "open": corners[4:]}[kind]
        assert places == set(wanted)
    assert forms["standing"][0] == CUBE_LIST
    assert forms["striking"][0] == forms["open"][0] == SPHERE_LIST
    assert forms["striking"][1] > 1.5 * forms["open"][1]


def test_the_words_tell_mode_time_impulses_and_velocities(predicted: Prediction) -> None:
    scene = scene_of(predicted)
    name, when, impulses, after = find(drawn(scene, SECOND), "units/text").text.split("\n")
    touchdown = predicted.touchdown
    assert touchdown is not None
    assert name == "box"
    assert when == f"{touchdown.mode.name.replace('_', ' ')} in {1e3 * touchdown.lead_time:.0f} ms"
    assert impulses.startswith("impulses ")
    assert "N s" in impulses
    assert "e" not in impulses.removeprefix("impulses ")
    assert after.endswith("rad/s")


def test_a_touchdown_that_is_withdrawn_is_deleted_and_one_that_happened_shown_for_a_while(
    predicted: Prediction,
) -> None:
    scene = scene_of(predicted)
    shown = drawn(scene, SECOND)
    scene.take("", Prediction(Status.ACCEPTED, standing(SECOND + PERIOD)))
    after = drawn(scene, SECOND + PERIOD)
    gone = {(marker.ns, marker.id) for marker in after if marker.action == DELETE}
    assert ("touchdown/body", 0) in gone
    assert gone <= {(marker.ns, marker.id) for marker in shown}
    # Deleted once.
    scene.take("", Prediction(Status.ACCEPTED, standing(SECOND + 2 * PERIOD)))
    assert all(marker.action != DELETE for marker in drawn(scene, SECOND + 2 * PERIOD))


def test_a_message_is_due_ten_times_a_second_of_stamps_whatever_comes() -> None:
    scene = MarkerScene({"": BOX})
    sent = []
    for k in range(1000):
        stamp = SECOND + 4_000_000 * k
        scene.take("", Prediction(Status.ACCEPTED, standing(stamp)))
        if scene.due(stamp) is not None:
            sent.append(stamp)
    assert len(sent) == 40
    assert all(later - earlier >= PERIOD for earlier, later in itertools.pairwise(sent))


def test_a_clock_that_starts_anew_clears_the_picture(predicted: Prediction) -> None:
    scene = scene_of(predicted._replace(sample=tilted(100 * SECOND)))
    assert scene.due(100 * SECOND) is not None
    assert scene.due(100 * SECOND - PAUSE // 2) is None
    scene.take("", predicted)
    first, *rest = drawn(scene, SECOND)
    assert first.action == DELETE_ALL
    assert find(rest, "units").action == 0


def test_nothing_is_drawn_before_anything_is_known_and_a_refused_sample_changes_nothing(predicted: Prediction) -> None:
    scene = MarkerScene({"": BOX})
    assert scene.due(SECOND) is None
    scene.take("", Prediction(Status.NOT_FINITE, standing(SECOND)))
    assert scene.due(SECOND) is None
    scene.take("", predicted)
    before = scene.due(SECOND)
    scene.take("", Prediction(Status.WRONG_FRAME, standing(SECOND)._replace(frame_id="elsewhere")))
    assert scene_of(predicted).due(SECOND) == before


def test_a_body_that_is_no_longer_measured_turns_grey() -> None:
    scene = scene_of(Prediction(Status.ACCEPTED, standing(SECOND)))
    fresh = find(drawn(scene, SECOND), "units").color
    late = drawn(scene, SECOND + PAUSE + PERIOD)
    grey = find(late, "units").color
    assert find(late, "units/text").text == "box STALE"
    assert grey.r == grey.g == grey.b
    assert (fresh.r, fresh.b) != (grey.r, grey.b)


def test_levels_are_colours_and_words_and_come_back_to_neutral_only_with_a_report() -> None:
    scenes = {name: BOX._replace(deck=DECK, watching=Watching(), source="none") for name in ("a", "b", "c", "d")}
    scene = MarkerScene(scenes)
    scene.take_support(MOMENT)
    scene.take_reports(
        (
            report("a", Level.OK),
            report("b", Level.WARN),
            report("c", Level.ERROR, time_to_tip="0.00", tip_ratio="99.000"),
            report("d", Level.STALE, status="SUPPORT_STALE", tip_ratio="unknown", slide_ratio="unknown"),
        )
    )
    markers = drawn(scene, SECOND)
    words = [find(markers, "units/text", k).text for k in range(4)]
    assert words == [
        "a OK",
        "b WARN\nmargin used: tip 82 %, slide 41 %\ntips in 1.5 s",
        "c ERROR\nmargin used: tip all, slide 41 %\ntips now",
        "d STALE\nSUPPORT STALE",
    ]
    colours = [find(markers, "units", k).color for k in range(4)]
    assert colours[0].g > 2 * colours[0].r
    assert colours[2].r > 2 * colours[2].g
    assert colours[1].r > colours[1].g > 2 * colours[1].b
    assert colours[3].r == colours[3].g == colours[3].b


def test_over_a_moving_deck_everything_is_in_the_decks_frame() -> None:
    moving = BOX._replace(deck=DECK)
    scene = MarkerScene({"box": moving})
    relative = standing(SECOND)
    answer = Prediction(Status.ACCEPTED, relative._replace(position=(5.0, 6.0, 7.0)), support=MOMENT, relative=relative)
    scene.take("box", answer)
    assert scene.due(SECOND) is None  # nothing is known of the deck yet
    scene.take_support(MOMENT)
    markers = drawn(scene, SECOND)
    assert {marker.header.frame_id for marker in markers} == {"deck"}
    assert triple(find(markers, "units").pose.position) == relative.position
    slab = find(markers, "support")
    assert (slab.scale.x, slab.scale.y) == (20.0, 8.0)
    assert slab.pose.position.z + 0.5 * slab.scale.z == pytest.approx(0.0, abs=1e-12)


def test_the_plumb_line_leans_as_what_is_felt() -> None:
    scene = MarkerScene({"box": BOX._replace(deck=DECK, source="none")})
    scene.take_support(MOMENT)
    markers = drawn(scene, SECOND)
    start, tip = (np.array(triple(point)) for point in find(markers, "support/plumb").points)
    assert (tip - start) / np.linalg.norm(tip - start) == pytest.approx(np.array(ROLLED.gravity) / 9.81, rel=1e-9)
    assert find(markers, "support/text").text == "felt gravity 9.81 m/s², 5.7° off the normal\ngrid 2 m"


def test_units_that_nobody_measures_stand_at_their_place_and_those_with_an_imu_tilt_on_their_lowest_point() -> None:
    placed = BOX._replace(deck=DECK, place=(3.0, -2.0, 0.5 * HEIGHT), yaw=0.5 * pi)
    scene = MarkerScene({"none": placed._replace(source="none"), "imu": placed._replace(source="imu"), "odom": placed})
    scene.take_support(MOMENT)
    markers = drawn(scene, SECOND)
    unit = find(markers, "units", 0)
    assert triple(unit.pose.position) == (3.0, -2.0, 0.5 * HEIGHT)
    turned = unit.pose.orientation
    assert axes_of((turned.x, turned.y, turned.z, turned.w))[0] == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    # A body of odometry is nowhere until its first sample.
    assert not [marker for marker in markers if marker.id == 2 and marker.ns == "units"]
    tilt = (sin(0.1), 0.0, 0.0, cos(0.1))
    scene.take_tilt("imu", SECOND + PERIOD, tilt)
    position = triple(find(drawn(scene, SECOND + PERIOD), "units", 1).pose.position)
    lowest = min(position[2] + to_world(axes_of(tilt), point)[2] for point in BOTTOM)
    assert lowest == pytest.approx(0.0, abs=1e-12)


def test_a_drum_lies_along_its_edges() -> None:
    drum = Scene(
        *(200.0, INERTIA, 0.5),  # type: ignore[arg-type]
        radius=0.4,
        edges=((5.0, -0.2, 0.0), (5.0, 0.2, 0.0)),
        deck=DECK,
        source="none",
        place=(5.0, 0.0, 0.35),
        yaw=0.3,
    )
    scene = MarkerScene({"drum": drum})
    scene.take_support(MOMENT)
    markers = drawn(scene, SECOND)
    body = find(markers, "units")
    assert (body.type, body.scale.x, body.scale.y) == (CYLINDER, 0.8, 0.8)
    turned = body.pose.orientation
    along = axes_of((turned.x, turned.y, turned.z, turned.w))[2]
    assert np.abs(along) == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
    edges = find(markers, "contacts/standing")
    assert edges.type == LINE_LIST
    assert {point.y for point in edges.points} == {-0.2, 0.2}
    assert {(point.x, point.z) for point in edges.points} == {(4.6, 0.0), (5.4, 0.0)}


def test_the_floor_is_below_the_bodies_and_does_not_creep_with_them() -> None:
    scene = MarkerScene({"": BOX._replace(height=0.1)})
    patches = set()
    for k in range(20):
        sample = standing(SECOND + k * PERIOD)
        scene.take("", Prediction(Status.ACCEPTED, sample._replace(position=(0.02 * k, 0.0, 0.9))))
        slab = find(drawn(scene, sample.stamp), "support")
        assert abs(slab.pose.position.x - 0.02 * k) < 0.5 * slab.scale.x - 0.5 * WIDTH
        assert slab.pose.position.z + 0.5 * slab.scale.z == pytest.approx(0.1, abs=1e-12)
        patches.add((slab.pose.position.x, slab.scale.x))
    assert len(patches) == 1


def test_the_grid_lies_a_little_above_the_support_however_wide_it_is() -> None:
    """Two faces at one height flicker."""
    for half in (1.0, 1000.0):
        deck = MovingDeck(extent=(-half, half, -half, half))
        scene = MarkerScene({"box": BOX._replace(deck=deck, source="none")})
        scene.take_support(MOMENT)
        markers = drawn(scene, SECOND)
        slab, grid = find(markers, "support"), find(markers, "support/grid")
        above = grid.pose.position.z - slab.pose.position.z - 0.5 * slab.scale.z
        assert 1e-4 < above / half < 1e-2


def test_contact_points_may_come_with_the_samples() -> None:
    scene = scene_of(Prediction(Status.ACCEPTED, standing(SECOND)), BOX._replace(points=()))
    assert scene.due(SECOND) is None
    scene.set_geometry("", Geometry(SECOND, "box", BOTTOM))
    assert find(drawn(scene, SECOND), "units").type == CUBE


def test_a_deck_that_is_inclined_in_its_frame_is_drawn_about_the_middle_of_its_extent() -> None:
    normal = (0.6, 0.0, 0.8)
    slab = deck_of(BOX._replace(deck=MovingDeck(extent=(-2.0, 6.0, -4.0, 4.0)), normal=normal, height=0.5))
    assert slab is not None
    # The point of its plane that is nearest to (2, 0, 0): it lies 0.6 * 2 - 0.5 above it.
    assert slab.middle == pytest.approx((2.0 - 0.7 * 0.6, 0.0, -0.7 * 0.8))
    assert (slab.half_x, slab.half_y) == (4.0, 4.0)


def test_every_marker_that_is_shown_has_an_extent_and_words_are_not_empty(predicted: Prediction) -> None:
    """RViz warns of scales of zero, and shows nothing of them."""
    scene = scene_of(predicted)
    for marker in drawn(scene, SECOND):
        assert marker.color.a > 0.0
        if marker.type == TEXT:
            assert marker.text
            assert marker.scale.z > 0.0
        else:
            assert marker.scale.x > 0.0
        if marker.type in (LINE_LIST, CUBE_LIST, SPHERE_LIST, ARROW):
            assert len(marker.points) >= 1
        if marker.type in (CUBE, CYLINDER, CUBE_LIST, SPHERE_LIST, ARROW):
            assert min(triple(marker.scale)) > 0.0
