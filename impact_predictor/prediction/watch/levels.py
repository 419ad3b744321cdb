"""Levels of bodies under watch, why each is what it is, and what a report says of it."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from math import degrees, inf
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanics.types import Mode
from ...stamps import NANOSECONDS
from ..checks import REMEDIES
from ..scene import Scene, Watching
from ..types import Status, Touchdown, Vector3
from .slips import FrictionSeen
from .standing import BodyMotion, Standing


class Level(IntEnum):
    """As in diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


GRAVITY: Final = (Level.OK, Level.WARN, Level.STALE, Level.ERROR)
"""From the least to the gravest: that something tips is graver than that nothing is known."""

OK, WARN, STALE, ERROR = (GRAVITY.index(level) for level in (Level.OK, Level.WARN, Level.STALE, Level.ERROR))
"""Ranks in that order."""

SILENT: Final = frozenset({Status.NO_SUPPORT, Status.SUPPORT_STALE, Status.BODY_STALE, Status.NO_GEOMETRY})
"""Where nothing is known, rather than something wrong, the level is STALE; every other status is an ERROR."""

OFF_ITS_FEET: Final = frozenset({BodyMotion.ROCKS, BodyMotion.LIFTS})

UNKNOWN: Final = "unknown"

_RAISED: Final = np.array([[WARN], [STALE], [ERROR]])
_NEVER: Final = -(2**62)


class Levels:
    """Levels of several bodies, by the thresholds of each, as their ranks in the order of gravity.

    `changed` tells that one is another than when this was last set to false.
    """

    def __init__(self, watchings: Sequence[Watching]) -> None:
        self.warn = np.array([one.warn for one in watchings])
        self.error = np.array([one.error for one in watchings])
        self._hysteresis = np.array([one.hysteresis for one in watchings])
        self._hold = np.array([one.hold * NANOSECONDS for one in watchings])
        count = len(watchings)
        self.ranks: NDArray[np.int64] = np.zeros(count, dtype=np.int64)
        self.changed = True
        self._justified: NDArray[np.int64] = np.full((len(_RAISED), count), _NEVER)

    def update(self, stamp: int, used: NDArray[np.float64], other: NDArray[np.int64]) -> None:
        """Take the parts (n,) of the margins that are used up at a stamp in ns, and the ranks that `other` reasons ask
        for at least.
        """
        # What is below a threshold but within the hysteresis holds up a level, and does not raise one.
        kept = np.maximum(self._asked(used + self._hysteresis), other)
        ranks = np.maximum(np.maximum(self._asked(used), other), np.minimum(kept, self.ranks))
        justified = ranks >= _RAISED
        self._justified[justified] = stamp
        held = (self.ranks >= _RAISED) & (stamp - self._justified < self._hold)
        ranks = np.maximum(ranks, (held * _RAISED).max(axis=0))
        if (ranks != self.ranks).any():
            self.ranks = ranks
            self.changed = True

    def quiet(self, number: int, stamp: int) -> bool:
        """Whether nothing justifies the level of a body at the last stamp but that it is held."""
        rank = int(self.ranks[number])
        return rank > OK and bool(self._justified[rank - 1, number] < stamp)

    def release(self, number: int) -> None:
        """Do not hold that nothing was known of a body: it is known for the first time."""
        if self.ranks[number] == STALE:
            self.ranks = self.ranks.copy()
            self.ranks[number] = OK
            self._justified[:, number] = _NEVER
            self.changed = True

    def _asked(self, used: NDArray[np.float64]) -> NDArray[np.int64]:
        ranks: NDArray[np.int64] = np.where(used >= self.error, ERROR, np.where(used >= self.warn, WARN, OK))
        return ranks

    def begin_anew(self) -> None:
        self._justified[:] = _NEVER


class MarginsUsed(NamedTuple):
    """The parts of the margins against tipping about an edge, by its name, and against sliding that are used up."""

    tip: float
    edge: str
    slide: float

    @property
    def most(self) -> float:
        return max(self.tip, self.slide)


NOTHING: Final = MarginsUsed(0.0, "", 0.0)


class BodyOutlook(NamedTuple):
    """What the watch finds for one body: its `status` or that of the support; the margins `used`, None where support or
    body are not known; whether it weighs nothing (`lifted`); the times in s until tip and slide are likely, inf where
    they do not become so, and the `chance` of either within the horizon; when it `strikes`, with the mode; the
    `barrier` in J that it takes to topple over `barrier_edge`.
    """

    status: Status
    used: MarginsUsed | None
    lifted: bool
    time_to_tip: float
    time_to_slide: float
    chance: float
    strikes: tuple[float, Mode] | None
    barrier: float
    barrier_edge: str


class WatchedBody:
    """A body by its name: how it stands, its status, and why its level is what it is."""

    def __init__(self, name: str, scene: Scene) -> None:
        self.name, self.scene = name, scene
        self.watching = scene.watching or Watching()
        self.standing = Standing(scene)
        self.status = Status.NO_GEOMETRY if scene.needs_geometry else self._unheard
        self._heard: int | None = None  # when its source was, in ns
        self.top = NOTHING
        """Where the margins were used up most since the level rose."""
        self.why = ""
        """What else raised it."""
        self.raised = 0
        """The stamp in ns of what is the later one of both."""
        self.band: tuple[float, float] | None = None
        """The parts used up of the margins against sliding with the highest and with the lowest friction."""
        self.friction_seen = FrictionSeen()
        self._strike: tuple[int, Mode] | None = None
        rolls = scene.radius > 0.0
        self._verbs = ("rolls", "rolling", "spins", "spinning") if rolls else ("tips", "tipping", "slides", "sliding")

    @property
    def _unheard(self) -> Status:
        return Status.BODY_STALE if self.scene.source != "none" else Status.ACCEPTED

    @property
    def known(self) -> bool:
        """Whether its margins mean something: a body that has fallen silent is taken to stand as it stood."""
        return self.status in (Status.ACCEPTED, Status.BODY_STALE)

    def rank(self) -> int:
        """The rank of the level that it asks for, its margins left aside."""
        standing = self.standing
        wavers = not standing.solid and self.status is not Status.NO_GEOMETRY
        if wavers or standing.toppled or standing.slid or standing.motion in OFF_ITS_FEET:
            return ERROR
        return rank_of(self.status)

    def struck(self, stamp: int, touchdown: Touchdown | None) -> bool:
        """Take the touchdown that a sample announces, or that it announces none; whether the last one has happened.

        What a body that stands announces is noise of its twist.
        """
        happened = self._strike is not None and self._strike[0] <= stamp
        self._strike = None
        if touchdown is not None and touchdown.lead_time > 0.0 and self.standing.motion in OFF_ITS_FEET:
            self._strike = stamp + round(touchdown.lead_time * NANOSECONDS), touchdown.mode
        return happened

    def strikes(self, stamp: int) -> tuple[float, Mode] | None:
        """The time in s until the touchdown ahead, and its mode."""
        if self._strike is None or self._strike[0] < stamp:
            return None
        return (self._strike[0] - stamp) / NANOSECONDS, self._strike[1]

    def set_points(self, points: tuple[Vector3, ...]) -> bool:
        """Take its contact points; it stands anew on them if they are others."""
        if points == self.scene.points and self.status is not Status.NO_GEOMETRY:
            return False
        self.scene = self.scene._replace(points=points)
        self.standing = Standing(self.scene)
        if self.status is Status.NO_GEOMETRY:
            self.status = self._unheard
        return True

    def hear(self, stamp: int) -> bool:
        """Know that its source is heard at a stamp in ns; whether that is for the first time."""
        first, self._heard, self.status = self._heard is None, stamp, Status.ACCEPTED
        return first

    def check_silence(self, stamp: int, timeout: int) -> None:
        """Know at a stamp whether its source is not heard any more, of which nothing came for so many ns."""
        if self._heard is not None and self.status is Status.ACCEPTED and stamp - self._heard > timeout:
            self.status = Status.BODY_STALE

    def begin_anew(self) -> None:
        """Forget all stamps: its source was not heard yet."""
        self._strike = self._heard = None
        if self.status is Status.ACCEPTED:
            self.status = self._unheard

    def reasons(self, outlook: BodyOutlook) -> list[str]:
        """What raises the level besides the margins, the gravest first."""
        found, standing, used = [], self.standing, outlook.used
        if outlook.status is not Status.ACCEPTED:
            found.append(f"{outlook.status.name}: {REMEDIES[outlook.status]}")
        elif not standing.solid:
            found.append("stands on a single point: look at its contact points and at how it is placed")
        if standing.toppled:
            found.append("has toppled: it lies on another side")
        if standing.motion in OFF_ITS_FEET:
            found.append(standing.motion.value)
        if standing.motion is BodyMotion.ROCKS:
            left, edge = outlook.barrier - standing.kinetic, outlook.barrier_edge
            if standing.tilt is not None:
                found[-1] += f", tilted by {degrees(standing.tilt):.1f} degrees"
            if used is not None and edge and left > 0.0:
                found[-1] += f", {left:.3g} J short of toppling over its {edge} edge"
            elif used is not None and edge:
                found[-1] += f", would topple over its {edge} edge if the deck stayed so"
        if standing.slid:
            found.append(standing.slid)
        if outlook.strikes is not None:
            time, mode = outlook.strikes
            found.append(f"strikes in {time:.2f} s: {mode.name}")
        if used is not None:
            times = outlook.time_to_tip, outlook.time_to_slide
            for part, time, verb in zip((used.tip, used.slide), times, self._verbs[::2], strict=True):
                if part < 1.0 and 0.0 < time < inf:
                    found.append(f"{verb} in {time:.1f} s if the deck goes on so ({outlook.chance:.0%} likely)")
        return found

    def message(self, outlook: BodyOutlook, held: float | None) -> str:
        """The message of a report; `held` is how long ago (s) the level was raised, where nothing justifies it now."""
        words, used, motion = self.reasons(outlook), outlook.used, self.standing.motion
        if not words and motion is not BodyMotion.UNKNOWN and (used is None or used.most < 1.0):
            words.append(motion.value)
        if outlook.lifted:
            words.append("weighs nothing on the deck: it lifts off")
        elif used is not None:
            words.append(self._margins(used))
            if self.band is not None and used.slide < 1.0 <= self.band[1]:
                words.append(f"slides if friction is {self.scene.friction_band[0]:g}")
        past = ""
        if held is not None:
            rose = [self.why] if self.why else []
            if self.top.most >= self.watching.warn:
                rose.append(self._margins(self.top))
            past = f" ({held:.1f} s ago: {'; '.join(rose)})"
        return "; ".join(words) + past

    def values(self, outlook: BodyOutlook, per_hour: Sequence[float], odds: dict[str, str]) -> dict[str, str]:
        """The values of a report, always the same in the same order, with the `odds` among them; `per_hour` are tips,
        slides and impacts.
        """
        used, tilt, (tips, slides, impacts) = outlook.used or NOTHING, self.standing.tilt, per_hour
        margins = {
            "slide_ratio": f"{used.slide:.3f}",
            **({} if self.band is None else {"slide_ratio_band": "{:.3f} to {:.3f}".format(*self.band)}),
            "tip_ratio": f"{used.tip:.3f}",
            "edge": used.edge or "none",
            "time_to_tip": f"{outlook.time_to_tip:.2f}",
            "time_to_slide": f"{outlook.time_to_slide:.2f}",
            "onset_probability": f"{outlook.chance:.2f}",
            **odds,
            "energy_to_topple": f"{max(0.0, outlook.barrier - self.standing.kinetic):.3f}",
        }
        return {
            **(dict.fromkeys(margins, UNKNOWN) if outlook.used is None else margins),
            "friction_seen": str(self.friction_seen),
            "tilt": UNKNOWN if tilt is None else f"{tilt:.4f}",
            "slides_per_hour": f"{slides:.1f}",
            "tips_per_hour": f"{tips:.1f}",
            "impacts_per_hour": f"{impacts:.1f}" if self.scene.source == "odom" else UNKNOWN,
            "status": outlook.status.name,
        }

    def _margins(self, used: MarginsUsed) -> str:
        """The parts of the margins that are used up, in words, the larger one first."""
        tips, tipping, slides, sliding = self._verbs
        about = f" {'over' if self.scene.radius else 'about'} its {used.edge} edge" if used.edge else ""
        found = []
        for part, does, doing, where in ((used.tip, tips, tipping, about), (used.slide, slides, sliding, "")):
            near = "near " if part >= self.watching.warn else ""
            found.append((part, (does if part >= 1.0 else near + doing) + where))
        (first, what), (second, other) = sorted(found, key=lambda one: -one[0])
        return f"{what}: {first:.2f} of the margin used; {other}: {second:.2f}"


def rank_of(status: Status) -> int:
    """The rank of the level that a status asks for."""
    if status is Status.ACCEPTED:
        return OK
    return STALE if status in SILENT else ERROR
