"""The deck of a recorded vessel as a support: its roll, sway and heave."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np

from ...bags.read import read_messages, topics
from ...errors import InputError
from ...mechanics.support import MovingSupport, sampled_support
from ...ros.messages import ODOMETRY, MalformedMessage, decode_odometry
from ...stamps import NANOSECONDS


class RecordedDeck(NamedTuple):
    """A recorded deck; its time counts from the first sample, and it lasts `duration` s."""

    support: MovingSupport
    duration: float
    topic: str


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
