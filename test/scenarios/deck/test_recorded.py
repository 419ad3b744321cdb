"""A recorded vessel as a deck: its roll, sway and heave, whichever way it heads."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

from impact_predictor.bags.write import BagWriter
from impact_predictor.errors import InputError
from impact_predictor.prediction.types import Sample
from impact_predictor.ros.messages import ODOMETRY, encode_odometry
from impact_predictor.scenarios.deck.vessel import read_deck

RATE, DURATION = 10.0, 20.0
FREQUENCY = 0.8


def roll(time: float) -> float:
    return 0.1 * sin(FREQUENCY * time)


def sway(time: float) -> float:
    return 0.5 * cos(FREQUENCY * time) - 0.5


def heave(time: float) -> float:
    return 0.7 * sin(0.5 * time)


def recorded(path: Path, heading: float, topics: tuple[str, ...] = ("/deck/odom",), count: int = 201) -> Path:
    with BagWriter(path) as writer:
        for k in range(count):
            time, stamp = k / RATE, 10**18 + round(k * 1e9 / RATE)
            # Heading about z, then roll about x; sway is to port.
            cr, sr, ch, sh = cos(0.5 * roll(time)), sin(0.5 * roll(time)), cos(0.5 * heading), sin(0.5 * heading)
            place = 40.0 - sin(heading) * sway(time), -7.0 + cos(heading) * sway(time), 3.0 + heave(time)
            zero = (0.0, 0.0, 0.0)
            pose = (sr * ch, sr * sh, cr * sh, cr * ch)
            sample = Sample(stamp, "map", "deck", place, pose, zero, zero, (0.0,) * 36, (0.0,) * 36)
            for topic in topics:
                writer.write(topic, ODOMETRY, stamp, encode_odometry(sample))
    return path


@pytest.mark.parametrize("heading", [0.0, 1.0, pi, -2.5])
def test_roll_sway_and_heave_come_back(tmp_path: Path, heading: float) -> None:
    deck = read_deck(recorded(tmp_path / "deck", heading))
    assert deck.duration == pytest.approx(DURATION)
    assert deck.topic == "/deck/odom"
    times = np.linspace(1.0, 19.0, 37)
    motion = deck.support.motion(times)
    # A spline of degree 5 over samples every 0.1 s.
    assert motion.angle == pytest.approx(np.array([roll(time) for time in times]), abs=1e-8)
    assert motion.x == pytest.approx(np.array([sway(time) for time in times]), abs=1e-8)
    assert motion.y == pytest.approx(np.array([heave(time) for time in times]), abs=1e-8)
    assert motion.ax == pytest.approx(-0.5 * FREQUENCY**2 * np.cos(FREQUENCY * times), abs=1e-6)


def test_one_of_several_topics_is_named(tmp_path: Path) -> None:
    path = recorded(tmp_path / "deck", 0.0, ("/deck/odom", "/bridge/odom"))
    with pytest.raises(InputError, match="2 topics with nav_msgs/msg/Odometry; name the deck's: --record-topic"):
        read_deck(path)
    assert read_deck(path, "/bridge/odom").topic == "/bridge/odom"


def test_too_few_samples_are_said_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give 6 or more"):
        read_deck(recorded(tmp_path / "deck", 0.0, count=5))


def test_a_bag_without_odometry_is_said_in_one_sentence(tmp_path: Path) -> None:
    path = tmp_path / "none"
    with BagWriter(path) as writer:
        writer.write("/x", "std_msgs/msg/UInt8", 0, b"\x00\x01\x00\x00\x01\x00\x00\x00")
    with pytest.raises(InputError, match="no nav_msgs/msg/Odometry"):
        read_deck(path)
