"""Decks as supports that move in their transverse plane: of a vessel that answers to waves from the side, or recorded.

A response is a complex number for each frequency: what it multiplies the amplitude of a wave by, and by how much it
leads the surface at the origin. Waves travel towards +y of the vessel (to port) in deep water, so the surface is
amplitude * exp(i (frequency t - k y)) with the wave number k = frequency^2 / g. Roll is about +x and raises port.
"""

from __future__ import annotations

import csv
import os
from itertools import pairwise
from math import inf, pi
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...bags.read import read_messages, topics
from ...errors import InputError
from ...mechanics.motion.support import MovingSupport, SupportMotion, sampled_support
from ...ros.messages import ODOMETRY, MalformedMessage, decode_odometry
from ...stamps import NANOSECONDS
from .sea import Waves


class SecondOrder(NamedTuple):
    """A damped oscillator: natural frequency (rad/s), part of the critical damping, and its answer to a slow drive.

    `drive` is what drives it: the height of the "surface" (heave), its "slope" (roll), or the "drift" of the water to
    and fro (sway).
    """

    frequency: float
    damping: float
    gain: float = 1.0
    drive: str = "surface"

    def at(self, frequencies: NDArray[np.float64], gravity: float) -> NDArray[np.complex128]:
        ratio = frequencies / self.frequency
        answer: NDArray[np.complex128] = np.divide(self.gain, 1.0 - ratio * ratio + 2j * self.damping * ratio)
        if self.drive == "slope":
            return answer * (-1j * frequencies**2 / gravity)
        return answer * -1j if self.drive == "drift" else answer


class ResponseTable(NamedTuple):
    """A response amplitude operator at increasing frequencies (rad/s): amplitude per wave amplitude, and phase (rad).

    Between them it is linear in the complex plane; outside it is that of the first or last one.
    """

    frequencies: tuple[float, ...]
    amplitudes: tuple[float, ...]
    phases: tuple[float, ...]

    def at(self, frequencies: NDArray[np.float64], gravity: float) -> NDArray[np.complex128]:
        answers = np.array(self.amplitudes) * np.exp(1j * np.array(self.phases))
        found: NDArray[np.complex128] = np.interp(frequencies, self.frequencies, answers)
        return found


PONTOON_ROLL: Final = SecondOrder(2.0 * pi / 4.0, 0.3, 0.6, "slope")
"""A pontoon narrower than the waves takes a part of their slope."""


class Vessel(NamedTuple):
    """The responses of a vessel in roll (rad per m), heave and sway (m per m), of the point about which it rolls.

    The deck lies `height` m above that point. Without a word it is a stiff pontoon of some ten metres.
    """

    roll: SecondOrder | ResponseTable = PONTOON_ROLL
    heave: SecondOrder | ResponseTable = SecondOrder(2.0 * pi / 3.0, 0.5, 1.0, "surface")
    sway: SecondOrder | ResponseTable = SecondOrder(2.0 * pi / 3.0, 0.7, 1.0, "drift")
    height: float = 1.0


class RecordedDeck(NamedTuple):
    """A recorded deck; its time counts from the first sample, and it lasts `duration` s."""

    support: MovingSupport
    duration: float
    topic: str


def deck_in(waves: Waves, vessel: Vessel, gravity: float = 9.81) -> MovingSupport:
    """The vessel's deck in a sea from the side, in its y-z plane: x of the support is y of the deck, y is z."""
    frequencies = waves.frequencies
    swings = waves.amplitudes * np.exp(1j * waves.phases)
    places = np.stack([r.at(frequencies, gravity) * swings for r in (vessel.roll, vessel.sway, vessel.heave)], axis=1)
    rates = 1j * frequencies[:, None] * places
    moves = np.hstack([places, rates, 1j * frequencies[:, None] * rates])
    # The real part of each complex swing times exp(i frequency t): all motions share its sine and cosine.
    parts = np.concatenate([moves.real, -moves.imag])

    def motion(time: Any) -> SupportMotion:
        turns = np.multiply.outer(np.asarray(time, dtype=float), frequencies)
        both = np.concatenate([np.cos(turns), np.sin(turns)], axis=-1)
        # Not as a product of matrices: its threads would wait for each other on a busy machine.
        now = np.einsum("...i,ij->j...", both, parts)
        # Numbers at a single time are Python's: they go through motions whose steps are too short for numpy.
        roll, sway, heave, roll_rate, sway_rate, heave_rate, *accelerations = now if now.ndim > 1 else now.tolist()
        roll_up, sway_up, heave_up = accelerations
        return SupportMotion(roll, roll_rate, roll_up, sway, heave, sway_rate, heave_rate, sway_up, heave_up)

    return MovingSupport(motion, 2.0 * pi / float(frequencies.max()), gravity, (0.0, vessel.height))


def read_vessel(path: str, height: float) -> Vessel:
    """A vessel of tables in a CSV file: frequency, roll, roll_phase, heave, heave_phase, sway, sway_phase.

    The first line names the columns; units are rad/s, rad/m, m/m and rad.

    Raises:
        InputError: the file cannot be read, or its numbers are no tables.
    """
    names = ("frequency", *(f"{motion}{part}" for motion in ("roll", "heave", "sway") for part in ("", "_phase")))
    try:
        with Path(path).open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        columns: dict[str, Any] = {name: tuple(float(row[name]) for row in rows) for name in names}
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
    except (KeyError, TypeError, ValueError, csv.Error) as error:
        raise InputError(f"{path} is no table of responses ({error}); give numbers under {','.join(names)}") from error
    frequencies = columns["frequency"]
    finite = all(-inf < number < inf for column in columns.values() for number in column)
    if len(rows) < 2 or not finite or not all(0.0 < one < two for one, two in pairwise(frequencies)):
        raise InputError(f"{path}: give finite numbers at two or more frequencies above 0, in increasing order")
    roll, heave, sway = (
        ResponseTable(frequencies, columns[motion], columns[f"{motion}_phase"]) for motion in ("roll", "heave", "sway")
    )
    return Vessel(roll, heave, sway, height)


def read_deck(path: str | os.PathLike[str], topic: str = "", gravity: float = 9.81) -> RecordedDeck:
    """The deck of a bag's odometry in its transverse plane.

    Roll is the angle about the deck's x axis, sway the place across its mean heading and heave the height, both from
    the first sample on; pitch, yaw and surge are left out. Without `topic` the bag's only nav_msgs/Odometry is taken.

    Raises:
        InputError: the bag cannot be read, or has no such samples.
    """
    if not topic:
        found = [name for name, kind in topics(path).items() if kind == ODOMETRY]
        if not found:
            raise InputError(f"{os.fspath(path)} has no {ODOMETRY}; give a bag with a recorded deck")
        if len(found) > 1:
            raise InputError(
                f"{os.fspath(path)} has {len(found)} topics with {ODOMETRY}; name the deck's: --record-topic {found[0]}"
            )
        topic = found[0]
    try:
        samples = [decode_odometry(message.data) for message in read_messages(path, {topic: ODOMETRY})]
    except MalformedMessage as error:
        raise InputError(f"{topic} of {os.fspath(path)} has a message that cannot be read: {error}") from None
    if not samples:
        raise InputError(f"{os.fspath(path)} has no message on {topic}; give a bag with a recorded deck")
    first = samples[0].stamp
    times = np.array([(sample.stamp - first) / NANOSECONDS for sample in samples])
    x, y, z, w = np.array([sample.orientation for sample in samples]).T
    places = np.array([sample.position for sample in samples])
    roll = np.unwrap(np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)))
    heading = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    mean = np.angle(np.exp(1j * heading).mean())
    moved = places - places[0]
    sway = np.cos(mean) * moved[:, 1] - np.sin(mean) * moved[:, 0]
    return RecordedDeck(sampled_support(times, roll, sway, moved[:, 2], gravity), float(times[-1]), topic)
