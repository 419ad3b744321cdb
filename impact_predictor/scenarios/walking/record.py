"""A rolling wheel as a bag: its hub sampled at a rate, its spokes' tips, and its true impacts."""

from __future__ import annotations

import heapq
import os
from collections.abc import Callable, Iterator
from typing import Final

import numpy as np

from ...prediction.types import Geometry
from ...ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, POLYGON, encode_odometry, encode_polygon
from ...stamps import NANOSECONDS
from ..deck.sensors import AT_ONCE, Odometer
from ..record import FRAME, REST, Message, true_impact, write_messages
from ..space import FORWARD, Mount
from ..truth import TRUTH_TOPIC, encode_true_impact
from .wheel import RollEnd, Rolling

BODY: Final = "wheel"


def write_wheel(
    path: str | os.PathLike[str], rolling: Rolling, rate: float, tell: Callable[[int], None] | None = None
) -> None:
    """Write a bag (see `BagWriter`) with the states of a wheel at a rate in Hz, its tips and its true impacts.

    The topics are `/odom`, `/contact_geometry` and `TRUTH_TOPIC`; the plane is x forward (downhill) and z up of the
    frame `world`, and the slope goes through its origin. `tell` takes now and then how many samples are done.

    Raises:
        InputError: the bag cannot be written.
    """
    by_time = heapq.merge(_states(rolling, rate), _truths(rolling), key=lambda message: message.log_time)
    write_messages(path, [by_time], tell)


def samples_in(rolling: Rolling, rate: float) -> int:
    """How many samples of a wheel its record has."""
    rests = rolling.end in (RollEnd.RESTS, RollEnd.BALANCED)
    return 1 + int((rolling.time + (REST if rests else 0.0)) * rate)


def _states(rolling: Rolling, rate: float) -> Iterator[Message]:
    tips = tuple((x, 0.0, y) for x, y in rolling.wheel.tips)
    yield Message(0, "/contact_geometry", POLYGON, encode_polygon(Geometry(0, BODY, tips)))
    count = samples_in(rolling, rate)
    odometer = Odometer(FRAME, BODY, FORWARD, Mount())
    for first in range(0, count, AT_ONCE):
        stamps = [round(k * NANOSECONDS / rate) for k in range(first, min(first + AT_ONCE, count))]
        for sample in odometer.samples(stamps, rolling.world(np.array(stamps) / NANOSECONDS)):
            yield Message(sample.stamp, "/odom", ODOMETRY, encode_odometry(sample))


def _truths(rolling: Rolling) -> Iterator[Message]:
    tilt = rolling.wheel.hub.support.slope
    for old, new, strike in rolling.impacts:
        # Contacts 0 and 1 of a part are two neighbouring tips.
        other = new if old is None else old
        contacts = ((new,), (other,)) if strike.new == 0 else ((other,), (new,))
        impact = true_impact(strike, BODY, FORWARD, tilt, contacts)
        yield Message(impact.stamp, TRUTH_TOPIC, DIAGNOSTIC_ARRAY, encode_true_impact(impact, FRAME))
