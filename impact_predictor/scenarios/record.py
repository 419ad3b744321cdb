"""Planar motions as bags: bodies sampled at a rate, with their true impacts.

The plane of a motion is x forward and z up of the bag's frame (REP-103); a body's frame lies at its mass centre.
"""

from __future__ import annotations

import heapq
import os
from collections.abc import Callable, Iterator, Sequence
from math import cos, hypot, sin
from typing import Final, NamedTuple

import numpy as np

from ..bags.write import BagWriter
from ..mechanics.motion import PlanarState
from ..mechanics.problem import approach
from ..mechanics.rocking import End, Run, Strike
from ..prediction.types import Geometry, Sample, Vector3
from ..ros.cdr import NANOSECONDS
from ..ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, POLYGON, encode_odometry, encode_polygon
from .truth import TRUTH_TOPIC, TrueImpact, encode_true_impact

FRAME: Final = "world"

REST: Final = 0.25
"""Seconds that are recorded of a body that has come to rest."""

_AT_ONCE: Final = 256
"""Samples whose states are computed together."""
_NO_COVARIANCE: Final = (0.0,) * 36


class Actor(NamedTuple):
    """A body of a record: the name of its frame, and how it moves on two points of it."""

    name: str
    run: Run


class Message(NamedTuple):
    """A message as a bag holds it; they are ordered by their log times, in ns."""

    log_time: int
    topic: str
    type_name: str
    data: bytes


def write_record(
    path: str | os.PathLike[str], actors: Sequence[Actor], rate: float, tell: Callable[[int], None] | None = None
) -> None:
    """Write a bag (see `BagWriter`) with the states of bodies at a rate in Hz, their contact points and true impacts.

    The topics are `/odom` and `/contact_geometry`, with several bodies `/<name>/odom` and `/<name>/contact_geometry`,
    and `TRUTH_TOPIC`. Stamps count from the beginning of a motion. `tell` takes now and then how many samples are done.

    Raises:
        InputError: the bag cannot be written.
    """
    alone = len(actors) == 1
    streams = [messages_of(actor, "" if alone else f"/{actor.name}", rate) for actor in actors]
    samples = 0
    with BagWriter(path) as writer:
        for message in heapq.merge(*streams, key=lambda message: message.log_time):
            writer.write(message.topic, message.type_name, message.log_time, message.data)
            samples += message.type_name == ODOMETRY
            if tell is not None and samples % _AT_ONCE == 0:
                tell(samples)


def messages_of(actor: Actor, namespace: str, rate: float) -> Iterator[Message]:
    """The messages of one body in the order of their log times."""
    return heapq.merge(_states(actor, namespace, rate), _truths(actor), key=lambda message: message.log_time)


def samples_in(run: Run, rate: float) -> int:
    """How many samples of a motion a record has."""
    rests = run.end in (End.RESTS, End.BALANCED)
    return 1 + int((run.time + (REST if rests else 0.0)) * rate)


def _states(actor: Actor, namespace: str, rate: float) -> Iterator[Message]:
    old, new = actor.run.body.old, actor.run.body.new
    assert old is not None
    geometry = Geometry(0, actor.name, ((old.x, 0.0, old.y), (new.x, 0.0, new.y)))
    yield Message(0, f"{namespace}/contact_geometry", POLYGON, encode_polygon(geometry))
    count = samples_in(actor.run, rate)
    for first in range(0, count, _AT_ONCE):
        stamps = [round(k * NANOSECONDS / rate) for k in range(first, min(first + _AT_ONCE, count))]
        states = np.array(actor.run.world(np.array(stamps) / NANOSECONDS)).T.tolist()
        for stamp, state in zip(stamps, states, strict=True):
            sample = sample_of(PlanarState(*state), stamp, actor.name)
            yield Message(stamp, f"{namespace}/odom", ODOMETRY, encode_odometry(sample))


def _truths(actor: Actor) -> Iterator[Message]:
    for strike in actor.run.impacts:
        impact = true_impact(strike, actor)
        yield Message(impact.stamp, TRUTH_TOPIC, DIAGNOSTIC_ARRAY, encode_true_impact(impact, FRAME))


def sample_of(state: PlanarState, stamp: int, name: str) -> Sample:
    """A planar state in space. Counter-clockwise in the plane of x and z is negative about y."""
    x, z, angle, vx, vz, omega = state
    c, s = cos(angle), sin(angle)
    return Sample(
        stamp,
        FRAME,
        name,
        (x, 0.0, z),
        (0.0, -sin(0.5 * angle), 0.0, cos(0.5 * angle)),
        (c * vx + s * vz, 0.0, c * vz - s * vx),
        (0.0, -omega, 0.0),
        _NO_COVARIANCE,
        _NO_COVARIANCE,
    )


def true_impact(strike: Strike, actor: Actor) -> TrueImpact:
    """An impact of a motion as the truth of a record."""
    body, before = strike.outcome.body, strike.outcome.before
    assert body is not None
    assert before is not None
    new, old = body.new, body.old
    half_distance = hypot(new.x, new.y) if old is None else 0.5 * hypot(new.x - old.x, new.y - old.y)
    tilt = actor.run.support.motion(strike.time).angle
    c, s = cos(tilt), sin(tilt)

    def linear(vx: float, vy: float) -> Vector3:
        return c * vx - s * vy, 0.0, s * vx + c * vy

    vx, vy, omega = strike.outcome.twist
    return TrueImpact(
        round(strike.time * NANOSECONDS),
        actor.name,
        strike.outcome.mode,
        () if strike.old is None else (strike.old,),
        (strike.new,),
        -approach(new, before)[0],
        half_distance,
        strike.outcome.energy_lost,
        linear(before.vx, before.vy),
        (0.0, -before.omega, 0.0),
        linear(vx, vy),
        (0.0, -omega, 0.0),
    )
