"""Made motions as bags: bodies sampled at a rate, decks with their cargo, and the true impacts."""

from __future__ import annotations

import heapq
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..bags.write import BagWriter
from ..mechanics.motion import End, PlanarState, Trajectory
from ..mechanics.types import Vector
from ..prediction.scene import MovingDeck
from ..prediction.types import Geometry
from ..ros.cdr import diagnostic_array
from ..ros.messages import DIAGNOSTIC_ARRAY, IMU, ODOMETRY, POLYGON, encode_imu, encode_odometry, encode_polygon
from ..stamps import NANOSECONDS
from .sensors import (
    AT_ONCE,
    FORWARD,
    NO_NOISE,
    InertialSensor,
    Mount,
    Odometer,
    Poses,
    SensorNoise,
    carried,
    poses,
    rotated,
    rotations,
    stamps_of,
)
from .truth import (
    LANDING_TOPIC,
    ONSET_TOPIC,
    TRUTH_TOPIC,
    TrueImpact,
    TrueLanding,
    TrueOnset,
    encode_truth,
    true_impact,
)
from .wheel import RollEnd, Rolling

if TYPE_CHECKING:
    from .deck.cargo import Span
    from .deck.motion import DeckMotion
    from .deck.voyage import Followed

FRAME: Final = "world"

DECK: Final = "deck"
"""Frame of a moving support."""

WHEEL: Final = "wheel"
"""Frame of a wheel."""

_TOPICS: Final[Mapping[type, str]] = {TrueImpact: TRUTH_TOPIC, TrueOnset: ONSET_TOPIC, TrueLanding: LANDING_TOPIC}

REST: Final = 0.25
"""Seconds that are recorded of a body that has come to rest."""


class Sensors(NamedTuple):
    """How deck and units are observed: rates in Hz, noise and the seed that makes it."""

    rate: float = 50.0
    deck_rate: float = 100.0
    noise: SensorNoise = NO_NOISE
    seed: int = 0


class RecordedMessage(NamedTuple):
    """A message as a bag holds it; they are ordered by their log times, in ns."""

    log_time: int
    topic: str
    type_name: str
    data: bytes


class Actor(NamedTuple):
    """A body of a record, its frame at its mass centre.

    The `name` of its frame; its `points` (x, y) in m; the `duration` in s for which it is recorded; the `world` states
    of its mass centre at an array of times in s; its true `impacts`.
    """

    name: str
    points: tuple[Vector, ...]
    duration: float
    world: Callable[[NDArray[np.float64]], PlanarState]
    impacts: tuple[TrueImpact, ...]

    def samples(self, rate: float) -> int:
        """How many samples of it a record has at a rate in Hz."""
        return 1 + int(self.duration * rate)


def rocking_actor(name: str, run: Trajectory) -> Actor:
    """A body that moves on two points of it."""
    old, new = run.body.old, run.body.new
    assert old is not None
    tilts = [run.support.motion(strike.time).angle for strike in run.impacts]
    return Actor(
        name=name,
        points=((old.x, old.y), (new.x, new.y)),
        duration=run.time + (REST if run.end in (End.RESTS, End.BALANCED) else 0.0),
        world=run.world,
        impacts=tuple(
            true_impact(strike, name, FORWARD, tilt) for strike, tilt in zip(run.impacts, tilts, strict=True)
        ),
    )


def wheel_actor(rolling: Rolling) -> Actor:
    """A wheel that rolls down a slope through the origin of the frame."""
    impacts = []
    for old, new, strike in rolling.impacts:
        # Contacts 0 and 1 of a part are two neighbouring tips.
        other = new if old is None else old
        contacts = ((new,), (other,)) if strike.new == 0 else ((other,), (new,))
        impacts.append(true_impact(strike, WHEEL, FORWARD, rolling.wheel.hub.support.slope, contacts))
    return Actor(
        name=WHEEL,
        points=rolling.wheel.tips,
        duration=rolling.time + (REST if rolling.end in (RollEnd.RESTS, RollEnd.BALANCED) else 0.0),
        world=rolling.world,
        impacts=tuple(impacts),
    )


def write_record(
    path: str | os.PathLike[str], actors: Sequence[Actor], rate: float, tell: Callable[[int], None] | None = None
) -> None:
    """Write a bag (see `BagWriter`) with the states of bodies at a rate in Hz, their contact points and true impacts.

    The topics are `/odom` and `/contact_geometry`, with several bodies `/<name>/odom` and `/<name>/contact_geometry`,
    and `TRUTH_TOPIC`. The plane of the motions is x forward and z up of the frame `FRAME`. Stamps count from the
    beginning of a motion. `tell` takes now and then how many seconds are done. InputError where the bag cannot be
    written.
    """
    alone = len(actors) == 1
    write_messages(path, [_messages_of(actor, "" if alone else f"/{actor.name}", rate) for actor in actors], tell)


def write_messages(
    path: str | os.PathLike[str],
    streams: Sequence[Iterator[RecordedMessage]],
    tell: Callable[[int], None] | None = None,
) -> None:
    """Write a bag of messages, each stream of them ordered, while they are made: a long record takes no more memory.

    `tell` takes now and then how many seconds of it are done. InputError where the bag cannot be written.
    """
    with BagWriter(path) as writer:
        for count, (log_time, topic, type_name, data) in enumerate(_by_time(*streams), 1):
            writer.write(topic, type_name, log_time, data)
            if tell is not None and count % AT_ONCE == 0:
                tell(log_time // NANOSECONDS)


def deck_messages(
    followed: Sequence[Followed], deck: DeckMotion, alone: bool, duration: float, sensors: Sensors
) -> list[Iterator[RecordedMessage]]:
    """The streams of messages of a deck and its units, each ordered by its log times.

    The deck's are on `/support/odom` or `/support/imu`, a unit's on `/<name>/odom` or `/<name>/imu` as its scene tells;
    the unit of a scene file without bodies, `alone`, is on `/odom` or `/imu`.
    """
    watched = followed[0].unit.scene.deck or MovingDeck()
    return [
        nothing_happened((TRUTH_TOPIC, ONSET_TOPIC), DECK),
        _deck(deck, watched, duration, sensors),
        *(
            _unit(one, deck, "" if alone else f"/{one.unit.name}", duration, sensors, number)
            for number, one in enumerate(followed, 1)
        ),
    ]


def _by_time(*streams: Iterable[RecordedMessage]) -> Iterator[RecordedMessage]:
    return heapq.merge(*streams, key=lambda message: message.log_time)


def _messages_of(actor: Actor, namespace: str, rate: float) -> Iterator[RecordedMessage]:
    """The messages of one body in the order of their log times."""
    geometry = Geometry(0, actor.name, tuple((x, 0.0, y) for x, y in actor.points))
    yield RecordedMessage(0, f"{namespace}/contact_geometry", POLYGON, encode_polygon(geometry))
    stamps = [round(k * NANOSECONDS / rate) for k in range(actor.samples(rate))]
    odometer = Odometer(FRAME, actor.name)
    seen = _odometry(odometer, stamps, lambda times: poses(actor.world(times), FORWARD, Mount()), f"{namespace}/odom")
    yield from _by_time(seen, truth_messages(actor.impacts, FRAME))


def _odometry(
    odometer: Odometer, stamps: list[int], seen: Callable[[NDArray[np.float64]], Poses], topic: str
) -> Iterator[RecordedMessage]:
    """An odometer's messages at stamps (ns) from the poses at an array of times in s."""
    for block in _blocks(stamps):
        for sample in odometer.samples(block, seen(np.array(block) / NANOSECONDS)):
            yield RecordedMessage(sample.stamp, topic, ODOMETRY, encode_odometry(sample))


def truth_messages(events: Iterable[TrueImpact | TrueOnset | TrueLanding], frame: str) -> list[RecordedMessage]:
    """The messages of what truly happened, in the order of their stamps."""
    messages = [
        RecordedMessage(one.stamp, _TOPICS[type(one)], DIAGNOSTIC_ARRAY, encode_truth(one, frame)) for one in events
    ]
    return sorted(messages, key=lambda message: message.log_time)


def nothing_happened(topics: Iterable[str], frame: str) -> Iterator[RecordedMessage]:
    """Empty messages with which topics of the truth begin: where no other follows, that is the truth."""
    return iter([RecordedMessage(0, topic, DIAGNOSTIC_ARRAY, diagnostic_array(0, frame, ())) for topic in topics])


def _deck(deck: DeckMotion, watched: MovingDeck, duration: float, sensors: Sensors) -> Iterator[RecordedMessage]:
    rng = np.random.default_rng((sensors.seed, 0))
    stamps = stamps_of(0.0, duration, sensors.deck_rate, last=True)
    if watched.source == "odom":
        odometer = Odometer(FRAME, DECK, sensors.noise, rng)
        yield from _odometry(odometer, stamps, lambda times: deck.at(times).poses, "/support/odom")
        return
    sensor = InertialSensor(DECK, sensors.noise, rng)
    for block in _blocks(stamps):
        state = deck.at(np.array(block) / NANOSECONDS)
        for imu in sensor.measurements(block, state.poses, -state.felt_at(watched.imu_position)):
            yield RecordedMessage(imu.stamp, "/support/imu", IMU, encode_imu(imu))


def _unit(
    one: Followed, deck: DeckMotion, namespace: str, duration: float, sensors: Sensors, number: int
) -> Iterator[RecordedMessage]:
    unit, rng = one.unit, np.random.default_rng((sensors.seed, number))
    name, source = unit.name, unit.scene.source
    # Nobody measures where a deck is of which only an inertial sensor tells: its units are seen from it.
    relative = unit.scene.deck is not None and unit.scene.deck.source == "imu"
    frame = unit.scene.frame or DECK if relative else FRAME
    odometer, inertial = Odometer(frame, name, sensors.noise, rng), InertialSensor(name, sensors.noise, rng)
    for span in one.spans():
        seen = span.poses if relative else partial(_in_world, deck, span)
        last = span.end is not End.TIME_UP or span.time >= duration
        stamps = stamps_of(span.start, span.time, sensors.rate, last) if source != "none" else []
        sensed: Iterator[RecordedMessage] = iter(())
        if source == "odom":
            sensed = _odometry(odometer, stamps, seen, f"{namespace}/odom")
        elif source == "imu":
            sensed = _inertial(deck, span, stamps, inertial, f"{namespace}/imu", 0.5 / sensors.rate)
        yield from _by_time(sensed, truth_messages([*span.impacts, *span.onsets], DECK))


def _in_world(deck: DeckMotion, span: Span, times: NDArray[np.float64]) -> Poses:
    return carried(deck.at(times).poses, span.poses(times))


def _inertial(
    deck: DeckMotion, span: Span, stamps: list[int], sensor: InertialSensor, topic: str, half: float
) -> Iterator[RecordedMessage]:
    """An inertial sensor's messages in a span; `half` the time of a sample in s, cut off where the span ends."""
    for block in _blocks(stamps):
        times = np.array(block) / NANOSECONDS
        before, after = np.maximum(times - half, span.start), np.minimum(times + half, span.time)
        now, early, late = (_in_world(deck, span, moment) for moment in (times, before, after))
        speeds = [rotated(rotations(one.orientation), one.linear) for one in (early, late)]
        force = (speeds[1] - speeds[0]) / (after - before)[:, None] + (0.0, 0.0, deck.gravity)
        for imu in sensor.measurements(block, now, rotated(rotations(now.orientation), force, back=True)):
            yield RecordedMessage(imu.stamp, topic, IMU, encode_imu(imu))


def _blocks(stamps: list[int]) -> Iterator[list[int]]:
    return (stamps[first : first + AT_ONCE] for first in range(0, len(stamps), AT_ONCE))
