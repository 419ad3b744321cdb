"""Planar motions as bags: bodies sampled at a rate, with their true impacts."""

from __future__ import annotations

import heapq
import os
from collections.abc import Callable, Iterator, Sequence
from math import cos, hypot, inf, sin
from typing import Final, NamedTuple

import numpy as np

from ..bags.write import BagWriter
from ..mechanics.problem import approach
from ..mechanics.rocking import End, Run, Strike
from ..prediction.types import Geometry
from ..ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, POLYGON, encode_odometry, encode_polygon
from ..stamps import NANOSECONDS
from .deck.sensors import AT_ONCE, Odometer
from .space import FORWARD, Mount, Plane
from .truth import TRUTH_TOPIC, TrueImpact, encode_true_impact

FRAME: Final = "world"

REST: Final = 0.25
"""Seconds that are recorded of a body that has come to rest."""


class Actor(NamedTuple):
    """A body of a record, its frame at its mass centre: the name of its frame, and how it moves on two points of it."""

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
    and `TRUTH_TOPIC`. The plane of the motions is x forward and z up of the frame `FRAME`. Stamps count from the
    beginning of a motion. `tell` takes now and then how many samples are done.

    Raises:
        InputError: the bag cannot be written.
    """
    alone = len(actors) == 1
    write_messages(path, [messages_of(actor, "" if alone else f"/{actor.name}", rate) for actor in actors], tell)


def write_messages(
    path: str | os.PathLike[str], streams: Sequence[Iterator[Message]], tell: Callable[[int], None] | None = None
) -> None:
    """Write a bag of messages, each stream of them ordered, while they are made: a long record takes no more memory.

    `tell` takes now and then how many messages are done.

    Raises:
        InputError: the bag cannot be written.
    """
    with BagWriter(path) as writer:
        ordered = heapq.merge(*streams, key=lambda message: message.log_time)
        for count, (log_time, topic, type_name, data) in enumerate(ordered, 1):
            writer.write(topic, type_name, log_time, data)
            if tell is not None and count % AT_ONCE == 0:
                tell(count)


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
    odometer = Odometer(FRAME, actor.name, FORWARD, Mount())
    for first in range(0, count, AT_ONCE):
        stamps = [round(k * NANOSECONDS / rate) for k in range(first, min(first + AT_ONCE, count))]
        state = actor.run.world(np.array(stamps) / NANOSECONDS)
        for sample in odometer.samples(stamps, state):
            yield Message(sample.stamp, f"{namespace}/odom", ODOMETRY, encode_odometry(sample))


def _truths(actor: Actor) -> Iterator[Message]:
    for strike in actor.run.impacts:
        tilt = actor.run.support.motion(strike.time).angle
        impact = true_impact(strike, actor.name, FORWARD, tilt)
        yield Message(impact.stamp, TRUTH_TOPIC, DIAGNOSTIC_ARRAY, encode_true_impact(impact, FRAME))


def true_impact(
    strike: Strike,
    name: str,
    plane: Plane,
    tilt: float = 0.0,
    contacts: Sequence[tuple[int, ...]] = ((0,), (1,)),
    border: float = inf,
    since: float = 0.0,
) -> TrueImpact:
    """An impact of a motion as the truth of a record.

    Its velocities are along axes that are turned by -`tilt` (rad) from the support's; `contacts` are the indices of the
    points, in the scene, that the two contacts stand for; the times of the motion count from `since` (s).
    """
    body, before = strike.outcome.body, strike.outcome.before
    assert body is not None
    assert before is not None
    after = strike.outcome.twist
    c, s = cos(tilt), sin(tilt)
    return TrueImpact(
        round((since + strike.time) * NANOSECONDS),
        name,
        strike.outcome.mode,
        () if strike.old is None else contacts[strike.old],
        contacts[strike.new],
        -approach(body.new, before)[0],
        half_distance(strike),
        strike.outcome.energy_lost,
        plane.vector(c * before.vx - s * before.vy, s * before.vx + c * before.vy),
        plane.spin(before.omega),
        plane.vector(c * after.vx - s * after.vy, s * after.vx + c * after.vy),
        plane.spin(after.omega),
        border,
    )


def half_distance(strike: Strike) -> float:
    """Half the distance of the contacts in m, for one contact its distance from the mass centre."""
    body = strike.outcome.body
    assert body is not None
    new, old = body.new, body.old
    return hypot(new.x, new.y) if old is None else 0.5 * hypot(new.x - old.x, new.y - old.y)
