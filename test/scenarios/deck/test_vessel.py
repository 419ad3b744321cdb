"""Responses of a vessel against closed forms, its deck in a sea, and a recorded one whichever way it heads."""

from __future__ import annotations

from math import cos, exp, hypot, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from touchdowns import SAMPLE

from impact_predictor.bags.write import BagWriter
from impact_predictor.errors import InputError
from impact_predictor.ros.messages import ODOMETRY, encode_odometry
from impact_predictor.scenarios.deck.sea import SeaState, Waves, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in, read_deck
from impact_predictor.scenarios.sensors import rotated, rotations

G = 9.81
TIMES = np.linspace(0.0, 300.0, 1001)

RATE, DURATION = 10.0, 20.0
FREQUENCY = 0.8


def one_wave(frequency: float, amplitude: float = 1.0, phase: float = 0.0) -> Waves:
    return Waves(np.array([frequency]), np.array([amplitude]), np.array([phase]))


def answers(vessel: Vessel, frequency: float, heading: float) -> Any:
    return vessel.responses(np.array([frequency]), np.array([heading]), G)[0]


@pytest.mark.parametrize("heading", [0.0, 30.0, 90.0, 180.0, 240.0])
def test_a_long_wave_carries_the_vessel_as_it_carries_the_water(heading: float) -> None:
    frequency = 0.02
    k, c, s = frequency**2 / G, cos(radians(heading)), sin(radians(heading))
    # The water goes round; the surface a cos(w t - k (x c + y s)) slopes ahead and to port; its drift does not turn.
    expected = [-1j * c, -1j * s, 1.0, -1j * k * s, 1j * k * c, -1j * k * s * c * -1j * (100.0 - 4.0) / 104.0]
    found = answers(Vessel(length=10.0, breadth=2.0, roll_period=0.1), frequency, heading)
    assert found[:5] == pytest.approx(expected[:5], rel=1e-3, abs=1e-9)
    assert found[5] == pytest.approx(expected[5], rel=1e-3, abs=1e-9)


def test_heave_and_pitch_have_the_printed_amplitudes() -> None:
    # Jensen, Mansour and Olsen (2004) at no speed, written out: F and G of the force, and eta.
    length, breadth, draught, frequency, heading = 80.0, 18.0, 5.0, 0.7, 150.0
    k = frequency**2 / G
    effective = k * abs(cos(radians(heading)))
    strip = 2.0 * sin(0.5 * k * breadth) * exp(-k * draught)
    f = hypot(1.0 - k * draught, strip**2 / (k * breadth))
    eta = 1.0 / hypot(1.0 - 2.0 * k * draught, strip**2 / (k * breadth))
    x = 0.5 * effective * length
    heave = exp(-effective * draught) * f * 2.0 / (effective * length) * sin(x)
    pitch = exp(-effective * draught) * f * 24.0 / ((effective * length) ** 2 * length) * (sin(x) - x * cos(x))
    found = np.abs(answers(Vessel(length, breadth, draught), frequency, heading))
    assert found[2] == pytest.approx(eta * abs(heave), rel=1e-12)
    assert found[4] == pytest.approx(eta * abs(pitch), rel=1e-12)


def test_roll_swings_at_its_natural_period() -> None:
    vessel = Vessel()
    frequency = 2.0 * pi / vessel.roll_period
    # At resonance an oscillator answers with 1 / (2 damping) of the slope, a quarter of a period later.
    still = answers(vessel._replace(roll_period=1e-9), frequency, 90.0)[3]
    assert answers(vessel, frequency, 90.0)[3] == pytest.approx(still / (2j * vessel.roll_damping), rel=1e-9)


def test_waves_from_the_side_or_ahead_move_nothing_the_other_way() -> None:
    waves = waves_of(SeaState(2.0, 6.0), 4, count=40)
    for heading, still in ((90.0, (0, 4, 5)), (180.0, (1, 3, 5))):
        deck = deck_in(waves, Vessel(), heading)
        moves = np.abs(deck.axes(TIMES)).max(axis=(0, 2))
        assert [k for k, most in enumerate(moves) if most == 0.0] == list(still)
        assert (deck.plane is None) is (heading == 180.0)


def test_a_deck_in_a_quartering_sea_is_what_its_derivatives_say() -> None:
    deck, step = deck_in(waves_of(SeaState(2.0, 6.0), 4), Vessel(height=3.0), 40.0), 1e-4
    times = np.linspace(0.0, 60.0, 101)
    early, now, late = (deck.at(times + shift) for shift in (-step, 0.0, step))
    turns = [rotations(one.poses.orientation) for one in (early, now, late)]
    assert rotated(turns[1], now.poses.linear) == pytest.approx(
        (late.poses.position - early.poses.position) / (2.0 * step), abs=1e-7
    )
    spun = np.einsum("nij,nkj->nik", (turns[2] - turns[0]) / (2.0 * step), turns[1])
    spin = np.stack([spun[:, 2, 1], spun[:, 0, 2], spun[:, 1, 0]], axis=1)
    assert rotated(turns[1], now.poses.angular) == pytest.approx(spin, abs=1e-7)
    assert now.turning == pytest.approx((late.poses.angular - early.poses.angular) / (2.0 * step), abs=1e-7)
    speeds = [rotated(turn, one.poses.linear) for turn, one in zip(turns[::2], (early, late), strict=True)]
    weight = np.array((0.0, 0.0, -G)) - (speeds[1] - speeds[0]) / (2.0 * step)
    assert rotated(turns[1], now.gravity) == pytest.approx(weight, abs=1e-6)
    # Ahead of the midships the plane across the vessel heaves with the pitch.
    section, place = deck.across(5.0, (0.0, 0.0)).motion(times), rotated(turns[1], np.tile((5.0, 0.0, 0.0), (101, 1)))
    assert np.array((section.x, section.y)) == pytest.approx((now.poses.position + place).T[1:], abs=1e-12)
    assert np.abs(deck.axes(times)).max(axis=(0, 2)).min() > 1e-3


def test_a_deck_across_waves_is_its_plane() -> None:
    deck = deck_in(waves_of(SeaState(2.0, 6.0), 4), Vessel(height=3.0))
    assert deck.plane is not None
    motion, state, felt = deck.plane.motion(TIMES), deck.at(TIMES), np.array(deck.plane.felt_exactly(TIMES))
    assert np.array((motion.x, motion.y)) == pytest.approx(state.poses.position.T[1:], abs=1e-12)
    assert felt[:2] == pytest.approx(state.gravity.T[1:], abs=1e-12)
    assert felt[2:] == pytest.approx(np.stack([state.poses.angular[:, 0], state.turning[:, 0]]), abs=1e-12)
    # One time as well as an array of them, and what is felt from the polynomials.
    assert deck.plane.felt(7.0) == pytest.approx(deck.plane.felt_exactly(7.0), abs=1e-9)


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
    motion = deck.plane.motion(times)
    # A spline of degree 5 over samples every 0.1 s.
    assert np.array((motion.angle, motion.x, motion.y)) == pytest.approx(np.array(moved(times)), abs=1e-8)
    assert deck.motion.axes(times)[0, [3, 1, 2]] == pytest.approx(np.array(moved(times)), abs=1e-8)
    assert deck.motion.axes(times)[:, [0, 4, 5]] == pytest.approx(0.0, abs=1e-8)
    assert motion.ax == pytest.approx(-0.5 * FREQUENCY**2 * np.cos(FREQUENCY * times), abs=1e-6)


def test_a_bag_without_samples_enough_is_said_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give 6 or more"):
        read_deck(recorded(tmp_path / "deck", 0.0, count=5))
    path = tmp_path / "none"
    with BagWriter(path) as writer:
        writer.write("/x", "std_msgs/msg/UInt8", 0, b"\x00\x01\x00\x00\x01\x00\x00\x00")
    with pytest.raises(InputError, match="no nav_msgs/msg/Odometry"):
        read_deck(path)
