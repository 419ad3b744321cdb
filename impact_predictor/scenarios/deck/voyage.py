"""Deck cargo in a sea or on a recorded deck, from a parameter file's scenes to what happened, and as a bag."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from math import cos, degrees, hypot, pi, sin
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...mechanics.motion import End, PlanarState
from ...mechanics.motion.support import MovingSupport
from ...mechanics.types import Vector
from ...prediction.scene import Scene, shared_by
from ..record import Sensors, deck_messages, write_messages
from ..sensors import Poses
from ..truth import TrueImpact, TrueOnset
from .cargo import CargoUnit, Span, follow, units_of
from .motion import DeckMotion, planar_deck

_LONGEST = 7 * 24 * 3600.0
LOOKS: Final = 20.0
"""Hz at which the largest turn of a unit is looked for."""

_CAPSIZED = 0.25 * pi
"""rad: no vessel with cargo on deck comes back from there."""


class Followed:
    """What happened to a unit, as far as it was followed."""

    def __init__(self, unit: CargoUnit, spans: Iterator[Span]) -> None:
        self.unit = unit
        self.impacts: list[TrueImpact] = []
        self.onsets: list[TrueOnset] = []
        self.sums: list[float] = []
        self.end, self.time = End.TIME_UP, 0.0
        self.toppled = 0
        """How often it toppled."""
        self.stood = 0.0
        """Seconds in which it had not toppled, or had been put up again."""
        self.most_turned = 0.0
        """The largest angle (rad) from how it stood, as long as it had not toppled for good."""
        self.moved = 0.0
        """How far (m) it stands to port of where it began."""
        self._spans = spans

    def spans(self) -> Iterator[Span]:
        """The spans of the motion, as they are followed."""
        for span in self._spans:
            self.impacts += span.impacts
            self.onsets += span.onsets
            self.sums += span.sums
            self.end, self.time = span.end, span.time
            self.toppled += span.end is End.OVERTURNED
            self.stood += 0.0 if span.lies else span.time - span.start
            seen = span.poses(np.append(np.arange(span.start, span.time, 1.0 / LOOKS), span.time))
            half = 0.5 * self.unit.mount.yaw
            upright = np.abs(seen.orientation @ (0.0, 0.0, sin(half), cos(half)))
            self.most_turned = max(self.most_turned, 2.0 * float(np.arccos(np.clip(upright, 0.0, 1.0)).max()))
            self.moved = float(np.ravel(span.state(np.array([span.time])).x)[0]) - self.unit.start.x
            yield span


class Voyage(NamedTuple):
    """A deck with its units, and what happened to each of them."""

    deck: DeckMotion
    units: tuple[Followed, ...]
    duration: float
    most_rolled: float
    most_pitched: float
    """The largest angles of the deck in rad."""
    most_lateral: float
    """The largest acceleration felt along the deck, as a part of that felt out of it, at the deck's origin."""

    @property
    def standing(self) -> float:
        """The part of the time of all units in which they had not toppled, or had been put up again."""
        return sum(one.stood for one in self.units) / (self.duration * len(self.units))

    @property
    def broke_off(self) -> bool:
        """Whether the motion of a unit was lost before its end."""
        return any(one.end in (End.NO_SOLUTION, End.TOO_MANY_EVENTS, End.INVALID_INPUT) for one in self.units)


def gravity_of(scenes: Mapping[str, Scene]) -> float:
    """Gravity of the scenes of a moving deck in m/s^2; InputError where the support does not move, or gravity is not
    along -z of the world.
    """
    scene = shared_by(scenes)
    x, y, z = scene.gravity
    if scene.deck is None:
        raise InputError("the support of the parameter file is fixed; give support.motion odom or imu")
    if hypot(x, y) > 0.0 or z >= 0.0:
        raise InputError(f"gravity is {list(scene.gravity)}; a deck is simulated with z up, as in [0.0, 0.0, -9.81]")
    return -z


def sail(
    scenes: Mapping[str, Scene],
    deck: DeckMotion | MovingSupport,
    duration: float,
    contacts: str = "auto",
    bag: str | os.PathLike[str] | None = None,
    sensors: Sensors = Sensors(),  # noqa: B008 - it is immutable
    tell: Callable[[int], None] | None = None,
    restand: float | None = None,
) -> Voyage:
    """Follow all units of the scenes for `duration` s, and write a `bag` with what their sensors told.

    `contacts` are rigid, by the impact law of each scene and in the transverse plane, or compliant (see `compliant`);
    auto: they are rigid on a deck that moves in that plane alone, but for units with lashings or chocks. Drums lie in
    their chocks and have rigid ones in any case. A unit that toppled stands again after `restand` s where it stood at
    first. `tell` takes now and then how many seconds are done. InputError where a unit cannot be simulated, a number is
    out of its range, or the bag cannot be written.
    """
    if not 0.0 < duration <= _LONGEST:
        raise InputError(f"the duration is {duration}; give seconds above 0, up to a week")
    if restand is not None and not 0.0 < restand <= _LONGEST:
        raise InputError(f"units stand again after {restand} s; give seconds above 0")
    for name, rate in (("rate", sensors.rate), ("deck rate", sensors.deck_rate)):
        if not 0.0 < rate <= 1e4:
            raise InputError(f"the {name} is {rate}; give Hz above 0, up to 10000")
    for name, deviation in sensors.noise._asdict().items():
        if not 0.0 <= deviation < 1e3:
            raise InputError(f"the noise of the {name} is {deviation}; give a standard deviation of 0 or more")
    deck = planar_deck(deck) if isinstance(deck, MovingSupport) else deck
    rolled, pitched, lateral = _extremes(deck, duration)
    supports: dict[tuple[float, Vector], MovingSupport] = {}
    followed = []
    for unit in units_of(scenes):
        motion: Callable[[float], Iterator[Span]]
        is_held = bool(unit.scene.lashings or unit.scene.chocks)
        is_rigid = deck.plane is not None and not is_held if contacts == "auto" else contacts == "rigid"
        if is_rigid or unit.scene.radius > 0.0:
            where = 0.0 if deck.plane is not None else unit.mount.beside, unit.foot
            support = supports.setdefault(where, deck.across(*where))
            motion = partial(follow, unit, support, duration)
        else:
            from .compliant import follow_compliant

            motion = partial(follow_compliant, unit, deck, duration)
        followed.append(Followed(unit, _put_up(motion, duration, restand)))
    if bag is None:
        done = 0.0
        for one in followed:
            for span in one.spans():
                if tell is not None:
                    tell(round((done + span.time) / len(followed)))
            done += duration
    else:
        write_messages(bag, deck_messages(followed, deck, "" in scenes, duration, sensors), tell)
    return Voyage(deck, tuple(followed), duration, rolled, pitched, lateral)


def _put_up(motion: Callable[[float], Iterator[Span]], duration: float, restand: float | None) -> Iterator[Span]:
    """The motion of a unit from time 0 on, and again from where it stood at first after it has toppled and lain."""
    begin = 0.0
    while begin < duration:
        for span in motion(begin):
            yield span
            begin = span.time
        if span.end is not End.OVERTURNED or restand is None or begin >= duration:
            return
        start, begin = begin, min(duration, begin + restand)
        yield span._replace(
            start=start,
            time=begin,
            state=partial(_lying_state, span),
            poses=partial(_lying_poses, span),
            impacts=(),
            onsets=(),
            sums=(),
            end=End.TIME_UP,
            lies=True,
        )


def _lying_state(fallen: Span, times: NDArray[np.float64]) -> PlanarState:
    """A unit that lies as it fell, at rest."""
    now = np.array(fallen.state(np.full(np.shape(times), fallen.time)))
    now[3:] = 0.0
    return PlanarState(*now)


def _lying_poses(fallen: Span, times: NDArray[np.float64]) -> Poses:
    seen = fallen.poses(np.full(np.shape(times), fallen.time))
    return seen._replace(linear=0.0 * seen.linear, angular=0.0 * seen.angular)


def _extremes(deck: DeckMotion, duration: float) -> tuple[float, float, float]:
    """The largest roll and pitch in rad, and the largest push along the deck as a part of the weight on it; InputError
    where no deck with cargo on it moves like that.
    """
    times = np.arange(0.0, duration, deck.period / 16.0)
    tilted, lateral = np.zeros(2), 0.0
    for block in np.array_split(times, 1 + len(times) // 4096):
        felt = deck.at(block).gravity
        tilted = np.maximum(tilted, np.abs(deck.axes(block)[0, 3:5]).max(axis=1))
        rolled, pitched = tilted.tolist()
        if max(rolled, pitched) > _CAPSIZED or felt[:, 2].max() >= 0.0:
            what = f"{'rolls' if rolled > pitched else 'pitches'} to {degrees(max(rolled, pitched)):.0f} degrees"
            if max(rolled, pitched) <= _CAPSIZED:
                what = "falls away under its cargo"
            raise InputError(f"the deck {what}, which no cargo is simulated on; give a lower sea, or another record")
        lateral = max(lateral, float((np.hypot(felt[:, 0], felt[:, 1]) / -felt[:, 2]).max()))
    return rolled, pitched, lateral
