"""Deck cargo as a record: what its sensors tell, and the truth, made while the motions are followed."""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from ...mechanics.motion import PlanarState
from ...mechanics.rocking import End
from ...mechanics.rocking.flight import in_world
from ...mechanics.support import MovingSupport
from ...prediction.scene import MovingDeck, Scene
from ...ros.cdr import diagnostic_array
from ...ros.messages import DIAGNOSTIC_ARRAY, IMU, ODOMETRY, encode_imu, encode_odometry
from ...stamps import NANOSECONDS
from ..record import FRAME, Message
from ..space import ACROSS, Mount
from ..truth import ONSET_TOPIC, TRUTH_TOPIC, TrueImpact, TrueOnset, encode_true_impact, encode_true_onset
from .cargo import Span, Unit
from .sea import Array
from .sensors import AT_ONCE, NO_NOISE, InertialSensor, Noise, Odometer, stamps_of

DECK: Final = "deck"
"""Frame of the support."""

LOOKS: Final = 20.0
"""Hz at which the largest turn of a unit is looked for."""


class Sensors(NamedTuple):
    """How deck and units are observed: rates in Hz, noise and the seed that makes it."""

    rate: float = 50.0
    deck_rate: float = 100.0
    noise: Noise = NO_NOISE
    seed: int = 0


class Followed:
    """What happened to a unit, as far as it was followed."""

    def __init__(self, unit: Unit, support: MovingSupport, spans: Iterator[Span]) -> None:
        self.unit, self.support = unit, support
        self.impacts: list[TrueImpact] = []
        self.onsets: list[TrueOnset] = []
        self.sums: list[float] = []
        self.end, self.time = End.TIME_UP, 0.0
        self.most_turned = 0.0
        """The largest angle (rad) from where it stood, as long as it had not toppled for good."""
        self.moved = 0.0
        """How far (m) it stands to port of where it began."""
        self._spans = spans

    def spans(self) -> Iterator[Span]:
        """The spans of the motion, as they are followed."""
        start = self.unit.start
        for span in self._spans:
            self.impacts += span.impacts
            self.onsets += span.onsets
            self.sums += span.sums
            self.end, self.time = span.end, span.time
            seen = span.state(np.append(np.arange(span.start, span.time, 1.0 / LOOKS), span.time))
            turned = np.abs(seen.angle - start.angle)
            self.most_turned = max(self.most_turned, float(turned.max()))
            self.moved = float(np.asarray(seen.x)[-1]) - start.x
            yield span

    def in_world(self, span: Span, times: Array) -> PlanarState:
        """The states of the mass centre in the world."""
        return in_world(self.support.motion(times), span.state(times))

    def on_deck(self, span: Span, times: Array) -> PlanarState:
        """The states of the mass centre seen from the deck's frame."""
        state, (y, z) = span.state(times), self.unit.foot
        return state._replace(x=state.x + y, y=state.y + z)


def messages_of(
    followed: Sequence[Followed],
    deck: MovingSupport,
    alone: bool,
    duration: float,
    sensors: Sensors,
    truths: Sequence[str] = (TRUTH_TOPIC, ONSET_TOPIC),
) -> list[Iterator[Message]]:
    """The streams of messages of a deck and its units, each ordered by its log times.

    The deck's are on `/support/odom` or `/support/imu`, a unit's on `/<name>/odom` or `/<name>/imu` as its scene tells;
    the unit of a scene file without bodies, `alone`, is on `/odom` or `/imu`. The topics of the `truths` that are told
    begin with an empty message: where nothing happened, that is the truth.
    """
    watched = followed[0].unit.scene.deck or MovingDeck()
    nothing = diagnostic_array(0, DECK, ())
    streams = [
        iter([Message(0, topic, DIAGNOSTIC_ARRAY, nothing) for topic in truths]),
        _deck(deck, watched, duration, sensors),
    ]
    for number, one in enumerate(followed, 1):
        streams.append(_unit(one, "" if alone else f"/{one.unit.name}", duration, sensors, number))
    return streams


def messages_in(scenes: Mapping[str, Scene], duration: float, sensors: Sensors) -> int:
    """How many messages of sensors a record has at most."""
    observed = sum(scene.source != "none" for scene in scenes.values())
    return round(duration * (sensors.deck_rate + observed * sensors.rate))


def _deck(deck: MovingSupport, watched: MovingDeck, duration: float, sensors: Sensors) -> Iterator[Message]:
    rng = np.random.default_rng((sensors.seed, 0))
    stamps = stamps_of(0.0, duration, sensors.deck_rate, last=True)
    blocks = _blocks(stamps)
    if watched.source == "imu":
        _, y, z = watched.imu_position
        place = deck.at(y, z)
        sensor = InertialSensor(DECK, ACROSS, Mount(), deck.gravity, sensors.noise, rng)
        for block in blocks:
            motion = place.motion(np.array(block) / NANOSECONDS)
            state = PlanarState(motion.x, motion.y, motion.angle, motion.vx, motion.vy, motion.rate)
            for imu in sensor.told(block, state, motion.ax, motion.ay + deck.gravity):
                yield Message(imu.stamp, "/support/imu", IMU, encode_imu(imu))
        return
    odometer = Odometer(FRAME, DECK, ACROSS, Mount(), sensors.noise, rng)
    for block in blocks:
        motion = deck.motion(np.array(block) / NANOSECONDS)
        state = PlanarState(motion.x, motion.y, motion.angle, motion.vx, motion.vy, motion.rate)
        for sample in odometer.samples(block, state):
            yield Message(sample.stamp, "/support/odom", ODOMETRY, encode_odometry(sample))


def _unit(one: Followed, namespace: str, duration: float, sensors: Sensors, number: int) -> Iterator[Message]:
    """A unit's messages, and its truth."""
    unit, rng = one.unit, np.random.default_rng((sensors.seed, number))
    name, source = unit.name, unit.scene.source
    # Nobody measures where a deck is of which only an inertial sensor tells: its units are seen from it.
    aboard = unit.scene.deck is not None and unit.scene.deck.source == "imu"
    seen = one.on_deck if aboard else one.in_world
    frame = unit.scene.frame or DECK if aboard else FRAME
    odometer = Odometer(frame, name, ACROSS, unit.mount, sensors.noise, rng)
    inertial = InertialSensor(name, ACROSS, unit.mount, one.support.gravity, sensors.noise, rng)
    for span in one.spans():
        told: list[Message] = [
            Message(impact.stamp, TRUTH_TOPIC, DIAGNOSTIC_ARRAY, encode_true_impact(impact, DECK))
            for impact in span.impacts
        ]
        told += [
            Message(onset.stamp, ONSET_TOPIC, DIAGNOSTIC_ARRAY, encode_true_onset(onset, DECK)) for onset in span.onsets
        ]
        told.sort(key=lambda message: message.log_time)
        last = span.end is not End.TIME_UP or span.time >= duration
        stamps = stamps_of(span.start, span.time, sensors.rate, last) if source != "none" else []
        sensed: Iterator[Message] = iter(())
        if source == "odom":
            sensed = (
                Message(sample.stamp, f"{namespace}/odom", ODOMETRY, encode_odometry(sample))
                for block in _blocks(stamps)
                for sample in odometer.samples(block, seen(span, np.array(block) / NANOSECONDS))
            )
        elif source == "imu":
            sensed = _inertial(one, span, stamps, inertial, f"{namespace}/imu", 0.5 / sensors.rate)
        yield from heapq.merge(sensed, told, key=lambda message: message.log_time)


def _inertial(
    one: Followed, span: Span, stamps: list[int], sensor: InertialSensor, topic: str, half: float
) -> Iterator[Message]:
    """An inertial sensor's messages in a span; `half` the time of a sample in s, cut off where the span ends."""
    for block in _blocks(stamps):
        times = np.array(block) / NANOSECONDS
        before, after = np.maximum(times - half, span.start), np.minimum(times + half, span.time)
        measured = sensor.measurements(
            block, one.in_world(span, times), one.in_world(span, before), one.in_world(span, after), after - before
        )
        for imu in measured:
            yield Message(imu.stamp, topic, IMU, encode_imu(imu))


def _blocks(stamps: list[int]) -> Iterator[list[int]]:
    return (stamps[first : first + AT_ONCE] for first in range(0, len(stamps), AT_ONCE))
