"""How a vessel answers to waves, and its deck in a sea, or a recorded one.

A response is a complex number for each frequency: what it multiplies the amplitude of a wave by, and by how much it
leads the surface at the origin. Waves travel in deep water in a direction b, counted from the bow to port: 0 comes from
astern, 90 degrees from starboard, 180 from ahead. So the surface is amplitude * exp(i (frequency t - k (x cos b + y sin
b))) with the wave number k = frequency^2 / g. Motions as in `motion`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...bags.read import read_messages, topics
from ...errors import InputError
from ...mechanics.motion.support import MovingSupport, SupportMotion, sampled_support
from ...ros.messages import ODOMETRY, MalformedMessage, decode_odometry
from ...stamps import NANOSECONDS
from .motion import ACROSS, AXES, DeckMotion
from .sea import Waves


class Vessel(NamedTuple):
    """A box of `length`, `breadth` and `draught` (m) that neither sails nor is moored, its deck `height` m above the
    point about which it turns. Without a word it is a stiff pontoon.

    Heave and pitch are the closed forms of Jensen, Mansour and Olsen, "Estimation of ship motions using closed-form
    expressions", Ocean Engineering 31 (2004). Roll is a damped oscillator, of `roll_period` (s) and with `roll_damping`
    of the critical one, that follows the plane which fits the surface across it best. Surge, sway and yaw are those of
    the water that the box displaces (Newman, Marine Hydrodynamics, 1977, on bodies that are small beside the waves).
    """

    length: float = 24.0
    breadth: float = 10.0
    draught: float = 1.2
    roll_period: float = 4.0
    roll_damping: float = 0.3
    height: float = 1.0

    def responses(
        self, frequencies: NDArray[np.float64], heading: NDArray[np.float64], gravity: float
    ) -> NDArray[np.complex128]:
        """The responses (n, 6) to waves of some frequencies (rad/s) in some directions (degrees)."""
        k, b = frequencies**2 / gravity, np.radians(heading)
        # A wave straight from the side or from ahead moves nothing the other way.
        cosine, sine = (np.where(np.abs(part) < 1e-12, 0.0, part) for part in (np.cos(b), np.sin(b)))
        along, across, deep = 0.5 * k * self.length * cosine, 0.5 * k * self.breadth * sine, k * self.draught
        width = k * self.breadth
        damping = 4.0 * np.square(np.sin(0.5 * width) * np.exp(-deep)) / width
        # Their force is that of a strip that moves against the surface, and its size is their f.
        strip = np.exp(-deep * np.abs(cosine)) * (1.0 - deep + 1j * damping) / (1.0 - 2.0 * deep + 1j * damping)
        heave = strip * _mean(along)
        pitch = strip * 1j * k * cosine * _slope(along)
        ratio = frequencies * self.roll_period / (2.0 * pi)
        oscillator = 1.0 / (1.0 - ratio * ratio + 2j * self.roll_damping * ratio)
        roll = -1j * k * sine * np.exp(-deep) * _slope(across) * _mean(along) * oscillator
        drift = -1j * (1.0 - np.exp(-deep)) / deep
        water = drift * _mean(along) * _mean(across)
        long, wide = self.length**2, self.breadth**2
        turn = (long * _slope(along) * _mean(across) - wide * _slope(across) * _mean(along)) / (long + wide)
        yaw = -1j * k * sine * cosine * drift * turn
        return np.stack([water * cosine, water * sine, heave, roll, pitch, yaw], axis=1)


def _mean(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """The mean of cos over -x..x."""
    found: NDArray[np.float64] = np.sinc(x / pi)
    return found


def _slope(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """The slope of the straight line that fits sin best over -x..x."""
    safe = np.where(np.abs(x) < 1e-2, 1.0, x)
    return np.where(safe == x, 3.0 * (np.sin(safe) - safe * np.cos(safe)) / safe**3, 1.0 - 0.1 * x * x)


class RecordedDeck(NamedTuple):
    """A recorded deck; its time counts from the first sample, and it lasts `duration` s.

    Its `motion` in all axes, and the `plane` in which it rolls, sways and heaves alone.
    """

    motion: DeckMotion
    plane: MovingSupport
    duration: float
    topic: str


def deck_in(
    waves: Waves, vessel: Vessel, heading: float | NDArray[np.float64] = 90.0, gravity: float = 9.81
) -> DeckMotion:
    """The vessel's deck in a sea whose waves travel in a direction (degrees), or each in its own."""
    frequencies = waves.frequencies
    answers = vessel.responses(frequencies, np.broadcast_to(heading, frequencies.shape), gravity)
    swings = answers * (waves.amplitudes * np.exp(1j * waves.phases))[:, None]
    period, sections = 2.0 * pi / float(frequencies.max()), _harmonics(frequencies, swings[:, ACROSS])

    def plane(time: Any) -> SupportMotion:
        (roll, sway, heave), (roll_rate, sway_rate, heave_rate), (roll_up, sway_up, heave_up) = sections(time)
        return SupportMotion(roll, roll_rate, roll_up, sway, heave, sway_rate, heave_rate, sway_up, heave_up)

    alone = not swings[:, [k for k in range(len(AXES)) if k not in ACROSS]].any()
    support = MovingSupport(plane, period, gravity, (0.0, vessel.height)) if alone else None
    return DeckMotion(_harmonics(frequencies, swings), period, gravity, vessel.height, support)


def _harmonics(frequencies: NDArray[np.float64], swings: NDArray[np.complex128]) -> Callable[[Any], Any]:
    """The sums of the real parts of swings (n, c) times exp(i frequency t), their rates and accelerations, by the time
    or an array of times.
    """
    rates = 1j * frequencies[:, None] * swings
    moves = np.hstack([swings, rates, 1j * frequencies[:, None] * rates])
    # All motions share the sine and cosine.
    parts, count = np.concatenate([moves.real, -moves.imag]), swings.shape[1]

    def values(time: Any) -> Any:
        turns = np.multiply.outer(np.asarray(time, dtype=float), frequencies)
        both = np.concatenate([np.cos(turns), np.sin(turns)], axis=-1)
        # Not as a product of matrices: its threads would wait for each other on a busy machine.
        now = np.einsum("...i,ij->j...", both, parts)
        # Numbers at a single time are Python's: they go through motions whose steps are too short for numpy.
        return now.reshape(3, count, *now.shape[1:]) if now.ndim > 1 else now.reshape(3, count).tolist()

    return values


def read_deck(path: str | os.PathLike[str], topic: str = "", gravity: float = 9.81) -> RecordedDeck:
    """The deck of a bag's odometry.

    Its place counts from the first sample, its yaw, surge and sway from its mean heading; splines of degree 5 go
    through the samples. Without `topic` the bag's only nav_msgs/Odometry is taken. InputError where the bag cannot be
    read, or has no such samples.
    """
    from scipy.interpolate import make_interp_spline

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
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    heading = np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    mean = np.angle(np.exp(1j * heading).mean())
    moved, c, s = places - places[0], np.cos(mean), np.sin(mean)
    surge, sway, heave = c * moved[:, 0] + s * moved[:, 1], c * moved[:, 1] - s * moved[:, 0], moved[:, 2]
    plane = sampled_support(times, roll, sway, heave, gravity)
    yaw = heading - mean - 2.0 * pi * np.round((heading[0] - mean) / (2.0 * pi))
    spline = make_interp_spline(times, np.column_stack([surge, sway, heave, roll, pitch, yaw]), k=5)
    splines = spline, spline.derivative(), spline.derivative(2)

    def axes(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([one(np.clip(at, times[0], times[-1])).T for one in splines])

    motion = DeckMotion(axes, plane.period, gravity)
    return RecordedDeck(motion, plane, float(times[-1]), topic)
