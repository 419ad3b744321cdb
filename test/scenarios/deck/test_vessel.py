"""Responses of a vessel against closed forms, its deck in a sea, and a recorded one whichever way it heads."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from harmonic_deck import Wave, harmonic_support
from touchdowns import SAMPLE

from impact_predictor.bags.write import BagWriter
from impact_predictor.errors import InputError
from impact_predictor.ros.messages import ODOMETRY, encode_odometry
from impact_predictor.scenarios.deck.sea import SeaState, Waves, waves_of
from impact_predictor.scenarios.deck.vessel import ResponseTable, SecondOrder, Vessel, deck_in, read_deck, read_vessel

G = 9.81
NONE = ResponseTable((0.1, 10.0), (0.0, 0.0), (0.0, 0.0))
TIMES = np.linspace(0.0, 300.0, 1001)
COLUMNS = "frequency,roll,roll_phase,heave,heave_phase,sway,sway_phase"

RATE, DURATION = 10.0, 20.0
FREQUENCY = 0.8


def one_wave(frequency: float, amplitude: float = 1.0, phase: float = 0.0) -> Waves:
    return Waves(np.array([frequency]), np.array([amplitude]), np.array([phase]))


def test_a_second_order_response_solves_its_equation() -> None:
    # x'' + 2 z w0 x' + w0^2 x = gain w0^2 cos(w t): the deck's own derivatives, put into it.
    natural, damping, gain, frequency = 1.3, 0.2, 0.8, 0.9
    vessel = Vessel(NONE, SecondOrder(natural, damping, gain), NONE, height=0.0)
    motion = deck_in(one_wave(frequency, 2.0, 0.4), vessel).motion(TIMES)
    left = motion.ay + 2.0 * damping * natural * motion.vy + natural**2 * motion.y
    assert left == pytest.approx(gain * natural**2 * 2.0 * np.cos(frequency * TIMES + 0.4), abs=1e-12)


def test_a_slow_wave_is_followed_by_the_surface_its_slope_and_its_drift() -> None:
    # Far below the natural frequencies, with k = w^2 / g and the wave towards port.
    frequency, amplitude = 1e-2, 3.0
    system = SecondOrder(50.0, 0.1)
    vessel = Vessel(system._replace(drive="slope"), system, system._replace(drive="drift"), 0.0)
    motion = deck_in(one_wave(frequency, amplitude), vessel).motion(TIMES)
    k = frequency**2 / G
    # eta = a cos(w t - k y): at y = 0 its slope is a k sin(w t), and the water drifts with a sin(w t).
    # The system is 2 damping w / w0 behind.
    assert motion.y == pytest.approx(amplitude * np.cos(frequency * TIMES), abs=2e-4)
    assert motion.angle == pytest.approx(amplitude * k * np.sin(frequency * TIMES), abs=1e-8)
    assert motion.x == pytest.approx(amplitude * np.sin(frequency * TIMES), abs=2e-4)


def test_a_table_is_met_at_its_frequencies_and_linear_between_them() -> None:
    table = ResponseTable((0.5, 1.0), (0.2, 0.4), (0.0, 0.5 * pi))
    at = table.at(np.array([0.3, 0.5, 0.75, 1.0, 2.0]), G)
    assert at == pytest.approx([0.2, 0.2, 0.1 + 0.2j, 0.4j, 0.4j], abs=1e-15)


def test_the_deck_is_the_sum_of_its_waves_above_the_axis_of_the_roll() -> None:
    waves, vessel = waves_of(SeaState(2.0, 6.0), 4, count=40), Vessel(height=3.0)
    roll, sway, heave = (
        [
            Wave(amplitude * abs(answer), frequency, phase + np.angle(answer) + 0.5 * pi)
            for frequency, amplitude, phase, answer in zip(*waves, response.at(waves.frequencies, G), strict=True)
        ]
        for response in (vessel.roll, vessel.sway, vessel.heave)
    )
    expected = harmonic_support(roll, sway, heave).at(0.0, 3.0)
    deck = deck_in(waves, vessel)
    assert deck.period == pytest.approx(expected.period)
    for ours, theirs in zip(deck.motion(TIMES), expected.motion(TIMES), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-11)
    # One time as well as an array of them, and what is felt from the polynomials.
    assert deck.motion(7.0) == pytest.approx(expected.motion(7.0), abs=1e-11)
    assert deck.felt(7.0) == pytest.approx(expected.felt_exactly(7.0), abs=1e-9)


@pytest.mark.parametrize(
    "numbers", ["1,1,1,1,1,1,1", "1,1,1,1,1,1,1;0.5,1,1,1,1,1,1", "1,1,1,1,1,1,1;2,nan,1,1,1,1,1", "1,x,1,1,1,1,1"]
)
def test_what_is_no_table_is_said_in_one_sentence(tmp_path: Path, numbers: str) -> None:
    file = tmp_path / "rao.csv"
    with pytest.raises(InputError, match=r"rao\.csv cannot be read"):
        read_vessel(str(file), 1.0)
    for text in (f"{COLUMNS}\n" + numbers.replace(";", "\n"), "frequency,roll\n1,2\n"):
        file.write_text(text)
        with pytest.raises(InputError, match=r"rao\.csv.*give (finite )?numbers"):
            read_vessel(str(file), 1.0)


def moved(time: Any) -> Any:
    """Roll, sway and heave."""
    return 0.1 * np.sin(FREQUENCY * time), 0.5 * np.cos(FREQUENCY * time) - 0.5, 0.7 * np.sin(0.5 * time)


def recorded(path: Path, heading: float, topics: tuple[str, ...] = ("/deck/odom",), count: int = 201) -> Path:
    with BagWriter(path) as writer:
        for k in range(count):
            time, stamp = k / RATE, 10**18 + round(k * 1e9 / RATE)
            # Heading about z, then roll about x; sway is to port.
            roll, sway, heave = moved(time)
            cr, sr, ch, sh = cos(0.5 * roll), sin(0.5 * roll), cos(0.5 * heading), sin(0.5 * heading)
            place = 40.0 - sin(heading) * sway, -7.0 + cos(heading) * sway, 3.0 + heave
            sample = SAMPLE._replace(stamp=stamp, position=place, orientation=(sr * ch, sr * sh, cr * sh, cr * ch))
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
    assert np.array((motion.angle, motion.x, motion.y)) == pytest.approx(np.array(moved(times)), abs=1e-8)
    assert motion.ax == pytest.approx(-0.5 * FREQUENCY**2 * np.cos(FREQUENCY * times), abs=1e-6)


def test_a_bag_without_samples_enough_is_said_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give 6 or more"):
        read_deck(recorded(tmp_path / "deck", 0.0, count=5))
    path = tmp_path / "none"
    with BagWriter(path) as writer:
        writer.write("/x", "std_msgs/msg/UInt8", 0, b"\x00\x01\x00\x00\x01\x00\x00\x00")
    with pytest.raises(InputError, match="no nav_msgs/msg/Odometry"):
        read_deck(path)
