"""The tracker of a moving support on a vessel's recorded deck: its poses against its own sensor, and what comes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from vessel import read_vessel

from impact_predictor.prediction.deck.tracker import Deck
from impact_predictor.prediction.scene import MovingDeck
from impact_predictor.prediction.types import Imu, Moment, Sample, Status

GRAVITY = (0.0, 0.0, -9.80665)
UP = (0.0, 0.0, 1.0)


@pytest.fixture(scope="module")
def record() -> list[tuple[Sample, Imu]]:
    return read_vessel()


def rms(errors: Any) -> float:
    return float(np.sqrt(np.square(np.array(errors)).sum(-1).mean()))


def test_what_is_felt_by_the_poses_is_what_the_sensor_measures(record: list[tuple[Sample, Imu]]) -> None:
    deck, errors, sizes = Deck(MovingDeck(), GRAVITY, UP), [], []
    for sample, imu in record:
        assert deck.update(sample) is Status.ACCEPTED
        if deck.last is not None:
            errors.append(np.add(deck.last.felt.gravity, imu.specific_force))
            sizes.append(np.subtract(imu.specific_force, (0.0, 0.0, 9.80665)))
    assert len(errors) == 3683  # all but those before the window is full
    assert rms(sizes) > 0.25
    # 0.1 (w T)^2 of it with T = 0.29 s, four messages, and waves of 1 rad/s at most: 0.3 % of it would be much.
    assert rms(errors) < 4e-4
    assert np.abs(errors).max() < 2e-3


@pytest.mark.parametrize("oriented", [True, False])
def test_what_is_felt_by_the_sensor_is_what_the_poses_tell(record: list[tuple[Sample, Imu]], oriented: bool) -> None:
    by_pose, by_sensor = Deck(MovingDeck(), GRAVITY, UP), Deck(MovingDeck(source="imu"), GRAVITY, UP)
    gravity, turning = [], []
    for sample, imu in record:
        by_pose.update(sample)
        assert by_sensor.update_imu(imu if oriented else imu._replace(orientation=None)) is Status.ACCEPTED
        if by_pose.last is not None and by_sensor.last is not None:
            gravity.append(np.subtract(by_pose.last.felt.gravity, by_sensor.last.felt.gravity))
            turning.append(np.subtract(by_pose.last.felt.turning, by_sensor.last.felt.turning))
    assert len(gravity) > 3670
    assert rms(gravity) < 2e-4
    assert rms(turning) < 1e-12  # both know the same angular velocities


def test_between_messages_the_pose_is_that_of_the_message_left_out(record: list[tuple[Sample, Imu]]) -> None:
    deck, places, tilts, pulls = Deck(MovingDeck(window=0.5), GRAVITY, UP), [], [], []
    for number, (sample, _) in enumerate(record[:1000]):
        if number % 2 == 0:
            deck.update(sample)
            left_out, force = record[number - 1][0], record[number - 1][1].specific_force
            if number > 10:
                moment = deck.at(left_out.stamp)
                assert isinstance(moment, Moment)
                places.append(np.subtract(moment.position, left_out.position))
                tilts.append(np.subtract(moment.orientation, left_out.orientation))
                pulls.append(np.add(moment.felt.gravity, force))
    assert rms(places) < 1e-4  # over 0.1 s a jerk of up to 0.3 m/s^3 moves it by 5e-5 m
    assert rms(tilts) < 1e-5
    assert rms(pulls) < 5e-3  # of the window of 0.6 s
