"""Records of deck cargo: what their sensors tell fits together, and the truth is in them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cargo_scenes import a_deck as rolling_deck
from cargo_scenes import a_drum, box
from records import impacts_of, samples_of

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.mechanics.motion import End
from impact_predictor.mechanics.motion.support import MovingSupport
from impact_predictor.prediction.scene import MovingDeck, Scene
from impact_predictor.prediction.types import Imu
from impact_predictor.prediction.vectors import axes_of
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, IMU, ODOMETRY, decode_imu
from impact_predictor.scenarios.deck.voyage import gravity_of, sail
from impact_predictor.scenarios.record import Sensors
from impact_predictor.scenarios.sensors import SensorNoise
from impact_predictor.scenarios.truth import (
    ONSET_TOPIC,
    TRUTH_TOPIC,
    TrueImpact,
    TrueOnset,
    decode_truths,
)

H = 1.0
DURATION = 12.0
RATE = 100.0


def a_deck(angle: float = 0.12) -> MovingSupport:
    return rolling_deck(angle).at(0.0, 0.3 * angle / 0.12)


def recorded(path: Path, scenes: dict[str, Scene], deck: MovingSupport | None = None, **changes: Any) -> Path:
    sensors = Sensors(RATE, RATE)._replace(**changes)
    sail(scenes, deck or a_deck(), DURATION, bag=path, sensors=sensors)
    return path


def measurements(path: Path, topic: str) -> list[Imu]:
    return [decode_imu(message.data) for message in read_messages(path, {topic: IMU})]


def rotations(values: list[Any]) -> Any:
    """From the body's axes to the world's, (n, 3, 3)."""
    return np.array([axes_of(value.orientation) for value in values]).transpose(0, 2, 1)


def quiet(stamps: Any, impacts: list[TrueImpact]) -> Any:
    """Whether no impact lies within two samples of each one."""
    hits = np.array([impact.stamp for impact in impacts])
    return (np.abs(stamps[:, None] - hits[None, :]) > 2.5e9 / RATE).all(axis=1)


@pytest.mark.parametrize(
    ("scene", "topic"),
    [
        (box(), "/odom"),
        (box(yaw=np.pi / 2, center_of_mass=(0.1, 0.2, -0.3)), "/odom"),
        (box(), "/support/odom"),
        (a_drum(edges=((0.0, 4.13, 0.1), (0.0, 3.87, 0.1)), center_of_mass=(0.0, 0.0, 0.2)), "/odom"),
    ],
)
def test_twists_are_the_derivatives_of_poses(tmp_path: Path, scene: Scene, topic: str) -> None:
    path = recorded(tmp_path / "deck.mcap", {"": scene})
    found = samples_of(path, topic)
    assert [sample.stamp for sample in found] == [round(k * 1e9 / RATE) for k in range(1 + int(DURATION * RATE))]
    stamps = np.array([sample.stamp for sample in found])
    places = np.array([sample.position for sample in found])
    turns = rotations(found)
    linear = np.einsum("nij,nj->ni", turns, np.array([sample.linear for sample in found]))
    angular = np.einsum("nij,nj->ni", turns, np.array([sample.angular for sample in found]))
    step = 2.0 / RATE
    moved = (places[2:] - places[:-2]) / step
    # d R / dt R^T is the cross product with the angular velocity.
    spun = np.einsum("nij,nkj->nik", (turns[2:] - turns[:-2]) / step, turns[1:-1])
    spin = np.stack([spun[:, 2, 1], spun[:, 0, 2], spun[:, 1, 0]], axis=1)
    still = quiet(stamps, impacts_of(path))[1:-1]
    assert still.sum() > 400
    # A sixth of the third derivative, some 30 m/s^3, times the square of 0.01 s; slips begin and end within a step.
    good = np.abs(linear[1:-1] - moved)[still].max(axis=1) < 2e-3
    assert good.mean() > 0.99
    assert np.abs(angular[1:-1] - spin)[still].max(axis=1) == pytest.approx(0.0, abs=1e-2)
    assert np.median(np.abs(linear[1:-1] - moved)) < 2e-4


@pytest.mark.parametrize("topic", ["/imu", "/support/imu"])
def test_an_imu_feels_the_second_derivative_of_its_place_less_gravity(tmp_path: Path, topic: str) -> None:
    position = (0.0, 1.5, 0.5)
    seen = box(source="imu", center_of_mass=(0.0, 0.1, 0.3), deck=MovingDeck("imu", imu_position=position))
    path = recorded(tmp_path / "imu.mcap", {"": seen})
    impacts = impacts_of(path)
    # The same voyage, measured otherwise.
    as_odom = recorded(tmp_path / "odom.mcap", {"": seen._replace(source="odom", deck=MovingDeck())})
    poses = samples_of(as_odom, topic.replace("imu", "odom"))
    turns = rotations(poses)
    places = np.array([sample.position for sample in poses])
    if topic == "/support/imu":
        places = places + turns @ np.array(position)
    found = measurements(path, topic)
    assert [imu.stamp for imu in found] == [sample.stamp for sample in poses]
    force = np.array([imu.specific_force for imu in found])
    acceleration = (places[2:] - 2.0 * places[1:-1] + places[:-2]) * RATE**2
    expected = np.einsum("nji,nj->ni", turns[1:-1], acceleration + np.array((0.0, 0.0, 9.81)))
    good = np.abs(force[1:-1] - expected).max(axis=1) < 0.05
    stamps = np.array([imu.stamp for imu in found])[1:-1]
    # A twelfth of the fourth derivative times the square of the step, but where slip begins or ends.
    assert good[quiet(stamps, impacts)].mean() > 0.98
    for imu, sample in zip(found, poses, strict=True):
        assert imu.angular == pytest.approx(sample.angular, abs=1e-12)
        assert imu.orientation == pytest.approx(sample.orientation, abs=1e-12)


def test_the_forces_of_an_imu_sum_up_to_the_velocity_also_over_impacts(tmp_path: Path) -> None:
    higher = a_deck().at(0.0, 0.6)
    path = recorded(tmp_path / "imu.mcap", {"": box(source="imu")}, higher)
    other = recorded(tmp_path / "odom.mcap", {"": box()}, higher)
    found, poses = measurements(path, "/imu"), samples_of(other, "/odom")
    turns = rotations(poses)
    felt = np.einsum("nij,nj->ni", turns, np.array([imu.specific_force for imu in found])) - np.array((0.0, 0.0, 9.81))
    velocity = np.einsum("nij,nj->ni", turns, np.array([sample.linear for sample in poses]))
    fast = max(impact.approach for impact in impacts_of(path))
    assert fast > 0.1
    # From the middle of a sample to the middle of another.
    summed = felt[100:1101].sum(axis=0) / RATE
    gone = 0.5 * (velocity[1101] + velocity[1100]) - 0.5 * (velocity[100] + velocity[99])
    assert summed == pytest.approx(gone, abs=0.02)


def test_each_unit_has_the_topics_of_its_sensors(tmp_path: Path) -> None:
    scenes = {"a": box(), "b": box(source="imu"), "c": box(source="none")}
    assert topics(recorded(tmp_path / "deck", scenes)) == {
        "/support/odom": ODOMETRY,
        "/a/odom": ODOMETRY,
        "/b/imu": IMU,
        TRUTH_TOPIC: DIAGNOSTIC_ARRAY,
        ONSET_TOPIC: DIAGNOSTIC_ARRAY,
    }
    # Nobody measures the third one, but it strikes like the others.
    struck = {impact.body for impact in impacts_of(tmp_path / "deck")}
    assert struck == {"a", "b", "c"}


def test_messages_are_ordered_and_the_truth_is_what_happened(tmp_path: Path) -> None:
    path = tmp_path / "deck.mcap"
    voyage = sail({"a": box(), "b": a_drum()}, a_deck(), DURATION, bag=path)
    messages = list(read_messages(path, topics(path)))
    assert [message.log_time for message in messages] == sorted(message.log_time for message in messages)
    happened = sorted((impact for one in voyage.units for impact in one.impacts), key=lambda impact: impact.stamp)
    assert sorted(impacts_of(path), key=lambda impact: impact.stamp) == happened
    onsets = [
        onset
        for message in read_messages(path, {ONSET_TOPIC: DIAGNOSTIC_ARRAY})
        for onset in decode_truths(TrueOnset, message.data)
    ]
    assert onsets == sorted(onset for one in voyage.units for onset in one.onsets)
    assert len(onsets) > 0


def test_over_a_deck_with_an_imu_alone_units_are_seen_from_the_deck(tmp_path: Path) -> None:
    aboard = {"a": box(deck=MovingDeck("imu")), "b": a_drum(deck=MovingDeck("imu"))}
    path = recorded(tmp_path / "deck.mcap", aboard, a_deck(0.0))
    assert "/support/odom" not in topics(path)
    for name, place in (("a", (3.0, 5.0, H)), ("b", (0.0, 4.0, 0.1 + 0.6 * np.sqrt(0.75)))):
        for sample in samples_of(path, f"/{name}/odom")[::50]:
            assert sample.frame_id == "deck"
            assert sample.position == pytest.approx(place, abs=1e-9)
            assert sample.linear == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_noise_has_its_deviations_and_says_so_in_the_covariances(tmp_path: Path) -> None:
    noise = SensorNoise(0.01, 0.02, 0.03, 0.04, 0.5, 0.06)
    scenes = {"a": box(), "b": box(source="imu")}
    clean = recorded(tmp_path / "clean", scenes, a_deck(0.0))
    noisy = recorded(tmp_path / "noisy", scenes, a_deck(0.0), noise=noise)

    def scatter(name: str, reading: Any, topic: str) -> float:
        one, other = ([getattr(value, name) for value in reading(path, topic)] for path in (clean, noisy))
        return float((np.array(one) - np.array(other)).std())

    # Three times 1,201 numbers: their deviation is known to 1.2 %.
    for topic in ("/a/odom", "/support/odom"):
        assert scatter("position", samples_of, topic) == pytest.approx(0.01, rel=0.06)
        assert scatter("linear", samples_of, topic) == pytest.approx(0.03, rel=0.06)
        assert scatter("angular", samples_of, topic) == pytest.approx(0.04, rel=0.06)
    assert scatter("specific_force", measurements, "/b/imu") == pytest.approx(0.5, rel=0.06)
    assert scatter("angular", measurements, "/b/imu") == pytest.approx(0.06, rel=0.06)
    for value in (*samples_of(noisy, "/a/odom"), *measurements(noisy, "/b/imu")):
        orientation = value.orientation
        assert orientation is not None
        assert np.linalg.norm(orientation) == pytest.approx(1.0, abs=1e-12)
    turned = np.array([sample.orientation for sample in samples_of(noisy, "/a/odom")])
    still = np.array([sample.orientation for sample in samples_of(clean, "/a/odom")])
    # The angle between two unit quaternions that are near, about three axes.
    angles = 2.0 * np.sqrt(np.maximum(0.0, 1.0 - (turned * still).sum(axis=1) ** 2))
    assert np.sqrt((angles**2).mean() / 3.0) == pytest.approx(0.02, rel=0.06)
    sample = samples_of(noisy, "/a/odom")[0]
    assert np.diag(np.reshape(sample.pose_covariance, (6, 6))) == pytest.approx([1e-4] * 3 + [4e-4] * 3)
    assert np.diag(np.reshape(sample.twist_covariance, (6, 6))) == pytest.approx([9e-4] * 3 + [16e-4] * 3)
    # SensorNoise is of the sensors: what happened stays.
    assert impacts_of(clean) == impacts_of(noisy)


def test_a_toppled_unit_tells_nothing_more_and_the_others_go_on(tmp_path: Path) -> None:
    path = tmp_path / "deck.mcap"
    # Twice as high, it topples.
    tall = box(points=tuple((x, y, z) for z in (-2 * H, 0.0) for x in (-0.7, 0.7) for y in (-0.2, 0.2)))
    voyage = sail({"tall": tall, "low": box(friction=0.1)}, a_deck(), DURATION, bag=path, sensors=Sensors(RATE, RATE))
    toppled, low = voyage.units
    assert toppled.end is End.OVERTURNED
    assert toppled.time < DURATION == low.time
    last = samples_of(path, "/tall/odom")[-1].stamp / 1e9
    assert toppled.time - 1.0 / RATE < last <= toppled.time
    assert samples_of(path, "/low/odom")[-1].stamp == samples_of(path, "/support/odom")[-1].stamp == DURATION * 1e9


@pytest.mark.parametrize(
    ("scene", "sentence"),
    [
        (box(deck=None), "the support of the parameter file is fixed; give support.motion odom or imu"),
        (box(gravity=(0.0, 1.0, -9.0)), r"gravity is \[0.0, 1.0, -9.0\]"),
        (box(gravity=(0.0, 0.0, 9.81)), "gravity is"),
    ],
)
def test_a_scene_without_a_moving_deck_is_refused(scene: Scene, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        gravity_of({"": scene})


def test_a_box_that_rocks_in_noise_beyond_its_tolerance_stands_on_an_edge_still(tmp_path: Path) -> None:
    scene = box(tolerance=1e-5, contact_time=0.002)
    noise = SensorNoise(position=0.002, orientation=0.001, velocity=0.02, rate=0.01)
    path = recorded(tmp_path / "deck.mcap", {"": scene}, a_deck(0.15), noise=noise)
    truth = replay(path, scene).truth
    assert truth is not None
    assert truth.clear >= 9
    assert truth.clear_mode_accuracy is not None
    assert truth.clear_mode_accuracy > 0.9
    assert truth.median_velocity_error is not None
    # Where nothing stood it would be 1.3: the noise is 0.023 m/s, of approaches of 0.1 to 0.3 m/s.
    assert truth.median_velocity_error < 0.15
    assert truth.false < 25
