"""Deck cargo in a sea or on a recorded deck, from a parameter file's scenes to what happened, and as a bag."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from math import degrees, hypot, pi
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...mechanics.motion import End, PlanarState
from ...mechanics.motion.support import MovingSupport, in_world
from ...prediction.scene import Scene, shared_by
from ..record import Sensors, deck_messages, write_messages
from ..truth import ONSET_TOPIC, TRUTH_TOPIC, TrueImpact, TrueOnset
from .cargo import CargoUnit, Span, follow, units_of

CONTACTS = ("rigid", "compliant")

_LONGEST = 7 * 24 * 3600.0
LOOKS: Final = 20.0
"""Hz at which the largest turn of a unit is looked for."""

_CAPSIZED = 0.25 * pi
"""rad: no vessel with cargo on deck comes back from there."""


class Followed:
    """What happened to a unit, as far as it was followed; its `states` (6, n) at `times` (n,) in s, else NaN."""

    def __init__(
        self, unit: CargoUnit, support: MovingSupport, spans: Iterator[Span], times: NDArray[np.float64]
    ) -> None:
        self.unit, self.support, self.times = unit, support, times
        self.states: NDArray[np.float64] = np.full((6, len(times)), np.nan)
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
            within = (self.times >= span.start) & (self.times <= span.time)
            if within.any():
                self.states[:, within] = np.array(span.state(self.times[within]))
            seen = span.state(np.append(np.arange(span.start, span.time, 1.0 / LOOKS), span.time))
            turned = np.abs(seen.angle - start.angle)
            self.most_turned = max(self.most_turned, float(turned.max()))
            self.moved = float(np.asarray(seen.x)[-1]) - start.x
            yield span

    def in_world(self, span: Span, times: NDArray[np.float64]) -> PlanarState:
        """The states of the mass centre in the world."""
        return in_world(self.support.motion(times), span.state(times))

    def on_deck(self, span: Span, times: NDArray[np.float64]) -> PlanarState:
        """The states of the mass centre seen from the deck's frame."""
        state, (y, z) = span.state(times), self.unit.foot
        return state._replace(x=state.x + y, y=state.y + z)


class Voyage(NamedTuple):
    """A deck with its units, and what happened to each of them."""

    deck: MovingSupport
    units: tuple[Followed, ...]
    duration: float
    most_rolled: float
    """The largest angle of the deck in rad."""
    most_lateral: float
    """The largest acceleration felt along the deck, as a part of that felt out of it, at the deck's origin."""

    @property
    def broke_off(self) -> bool:
        """Whether the motion of a unit was lost before its end."""
        return any(one.end in (End.NO_SOLUTION, End.TOO_MANY_EVENTS, End.INVALID_INPUT) for one in self.units)


def gravity_of(scenes: Mapping[str, Scene]) -> float:
    """Gravity of the scenes of a moving deck in m/s^2.

    Raises:
        InputError: the support does not move, or gravity is not along -z of the world.
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
    deck: MovingSupport,
    duration: float,
    contacts: str = "rigid",
    bag: str | os.PathLike[str] | None = None,
    sensors: Sensors = Sensors(),  # noqa: B008 - it is immutable
    tell: Callable[[int], None] | None = None,
    times: NDArray[np.float64] = np.zeros(0),  # noqa: B008 - nothing is written into it
) -> Voyage:
    """Follow all units of the scenes for `duration` s, and write a `bag` with what their sensors told.

    `contacts` are rigid, by the impact law of each scene, or compliant (see `compliant`). `tell` takes now and
    then how many seconds are done. The states of the units at `times` in s are kept.

    Raises:
        InputError: a unit cannot be simulated, a number is out of its range, or the bag cannot be written.
    """
    if not 0.0 < duration <= _LONGEST:
        raise InputError(f"the duration is {duration}; give seconds above 0, up to a week")
    for name, rate in (("rate", sensors.rate), ("deck rate", sensors.deck_rate)):
        if not 0.0 < rate <= 1e4:
            raise InputError(f"the {name} is {rate}; give Hz above 0, up to 10000")
    for name, deviation in sensors.noise._asdict().items():
        if not 0.0 <= deviation < 1e3:
            raise InputError(f"the noise of the {name} is {deviation}; give a standard deviation of 0 or more")
    motion_of: Callable[[CargoUnit, MovingSupport, float, str], Iterator[Span]] = follow
    truths: tuple[str, ...] = (TRUTH_TOPIC, ONSET_TOPIC)
    if contacts == "compliant":
        from .compliant import follow_compliant

        motion_of, truths = follow_compliant, (TRUTH_TOPIC,)
    rolled, lateral = _extremes(deck, duration)
    supports: dict[tuple[float, float], MovingSupport] = {}
    followed = []
    for unit in units_of(scenes):
        support = supports.setdefault(unit.foot, deck.at(*unit.foot))
        followed.append(Followed(unit, support, motion_of(unit, support, duration, unit.scene.law), times))
    if bag is None:
        done = 0.0
        for one in followed:
            for span in one.spans():
                if tell is not None:
                    tell(round((done + span.time) / len(followed)))
            done += duration
    else:
        write_messages(bag, deck_messages(followed, deck, "" in scenes, duration, sensors, truths), tell)
    return Voyage(deck, tuple(followed), duration, rolled, lateral)


def _extremes(deck: MovingSupport, duration: float) -> tuple[float, float]:
    """The largest roll in rad, and the largest push along the deck as a part of the weight on it.

    Raises:
        InputError: no deck with cargo on it moves like that.
    """
    times = np.arange(0.0, duration, deck.period / 16.0)
    rolled = lateral = 0.0
    for block in np.array_split(times, 1 + len(times) // 4096):
        ahead, up, *_ = deck.felt_exactly(block)
        rolled = max(rolled, float(np.abs(deck.motion(block).angle).max()))
        if rolled > _CAPSIZED or up.max() >= 0.0:
            what = f"rolls to {degrees(rolled):.0f} degrees" if rolled > _CAPSIZED else "falls away under its cargo"
            raise InputError(f"the deck {what}, which no cargo is simulated on; give a lower sea, or another record")
        lateral = max(lateral, float(np.abs(ahead / up).max()))
    return rolled, lateral
