"""The watch over bodies on a support: how near each is to sliding and tipping, and a level with its reason.

What is used up of the margins is judged at each message of the support, for all bodies at once. Nothing is ever OK
while the support or a measured body is not known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...stamps import NANOSECONDS
from ..deck.forecast import LEADS
from ..scene import MovingDeck, Scene
from ..types import Moment, Quaternion, Sample, Status, Touchdown, Vector3
from .levels import (
    ERROR,
    GRAVITY,
    NOTHING,
    OFF_ITS_FEET,
    OK,
    UNKNOWN,
    WARN,
    BodyOutlook,
    Level,
    Levels,
    MarginsUsed,
    WatchedBody,
    rank_of,
)
from .onset import FULL, Onset, OnsetCounts, first_times, motion_of, motions
from .peaks import HOUR, SOON, MarginPeaks
from .slips import FrictionSeen, Slips
from .standing import BodyMotion

if TYPE_CHECKING:
    from ..deck.forecast import DeckOutlook
    from .stance import StandingBody

__all__ = ["Level", "Report", "Watch"]

SECOND: Final = 1_000_000_000
"""ns between two reports without news, and how far stamps may go back before time has begun anew."""

JUDGED_EVERY: Final = 15_000_000
"""ns: a message that comes sooner after the last judgement waits for the next: margins hardly move."""

FORECAST_EVERY: Final = 500_000_000  # ns from one look ahead to the next

_NO_FORECAST: Final = {f"felt{kind}.{lead:g}_s": UNKNOWN for lead in LEADS for kind in ("", ".deviation")}

IMMINENT: Final = 1.5
"""s: the level is ERROR when the onset is likelier than not within so long."""

CLOSE: Final = 3.0
CLOSELY: Final = 0.2
"""An onset within so many s is warned of where it is so many times as likely as one within the horizon must be: there
is no time to wait until it is surer."""

SURE: Final = 3.0
"""Standard deviations by which a margin is used up beyond doubt: noise alone passes thresholds that the deck nears."""


class Report(NamedTuple):
    """What is said of a body at a stamp in ns; `values` are numbers and names as text, always the same in one order."""

    body: str
    stamp: int
    level: Level
    message: str
    values: dict[str, str]


class Watch:
    """Watches bodies, by their names, over one support of which `outlook(horizon)` tells courses ahead.

    Time is that of the support's stamps.
    """

    def __init__(
        self,
        scenes: Mapping[str, Scene],
        outlook: Callable[[float], DeckOutlook],
    ) -> None:
        self._bodies = bodies = [WatchedBody(name, scene) for name, scene in scenes.items()]
        self._numbers = {name: number for number, name in enumerate(scenes)}
        self._outlook_of = outlook
        watchings = [body.watching for body in bodies]
        self._onset = Onset([body.standing.stance for body in bodies])
        self._levels = Levels(watchings)
        self._counts = OnsetCounts(np.array([one.hysteresis for one in watchings]))
        self._told = np.array([one.source == "odom" and one.held_by_friction for one in scenes.values()])
        self._slips = Slips(self._told)
        self._friction = np.array([scene.friction for scene in scenes.values()])
        self._banded = [number for number, body in enumerate(bodies) if body.scene.friction_band]
        self._band: tuple[list[StandingBody], Onset] | None = None
        self._peaks = MarginPeaks(2 * len(bodies))
        self._timeout = int((bodies[0].scene.deck or MovingDeck()).timeout * NANOSECONDS)
        self._horizons = np.array([one.horizon for one in watchings])
        self._horizon = float(self._horizons.max())
        self._likely = 1.0 - np.array([one.vain for one in watchings])
        self._is_learnt = False
        self._motion = np.zeros(12)
        self._margins = self._onset.margins(self._motion)
        self._now: int | None = None
        self._reported: int | None = None
        self._judged: int | None
        self._looked: int | None
        self._support: Status
        self._judged_at = 0
        self._begun = False
        self._lose(Status.NO_SUPPORT)

    def update_support(self, moment: Moment, errors: tuple[float, float] = (0.0, 0.0)) -> None:
        """Take the support's motion now; its felt gravity (m/s^2) and angular acceleration (rad/s^2) have `errors`."""
        self._go_on(moment.stamp)
        judged = self._judged
        known, self._support = self._support is Status.ACCEPTED, Status.ACCEPTED
        if not self._begun:
            self._begun = True
            for number in range(len(self._bodies)):
                self._levels.release(number)
        since = moment.stamp - judged if judged is not None and known else None
        if since is not None and 0 <= since < JUDGED_EVERY:
            return
        self._judged = moment.stamp
        self._motion = motion_of(moment.felt)
        self._margins = margins = self._onset.margins(self._motion)
        self._used = np.maximum(margins.slide, margins.tip)
        seconds = since / NANOSECONDS if since and since <= self._timeout else 0.0
        self._counts.update(margins.tip, margins.slide, seconds)
        on_feet = np.array([body.standing.motion not in OFF_ITS_FEET for body in self._bodies])
        self._peaks.update(np.concatenate((margins.tip * on_feet, margins.slide * on_feet)), seconds)
        if self._told.any():
            stands = [
                one.status is Status.ACCEPTED and one.standing.motion is BodyMotion.STANDS for one in self._bodies
            ]
            needed, counts = margins.slide * self._friction, np.array(stands) & (margins.slide < FULL)
            self._slips.update(moment.stamp, needed, counts, errors[0])
        if self._looked is None or not 0 <= moment.stamp - self._looked < FORECAST_EVERY:
            self._look_ahead(moment.stamp)
            self._scatter = self._shaken(errors)
        for watched in self._bodies:
            watched.check_silence(moment.stamp, self._timeout)
        self._judge()

    def update_body(self, body: str, relative: Sample, touchdown: Touchdown | None, slack: float = 0.0) -> None:
        """Take a body's pose and twist relative to the support, the touchdown that they announce, and the gaps in m
        that cannot be told from none.
        """
        number = self._numbers[body]
        watched = self._bodies[number]
        self._hear(number, relative.stamp)
        stance = watched.standing.update(relative, slack)
        self._slips.unseen[number] = watched.standing.unseen
        if watched.standing.slid.startswith("slides"):
            self._slips.slid(number)
        if watched.struck(relative.stamp, touchdown):
            self._counts.struck(number)
        self._changed(number, stance)

    def update_tilt(self, body: str, stamp: int, orientation: Quaternion) -> None:
        """Take a body's orientation relative to the support."""
        number = self._numbers[body]
        self._hear(number, stamp)
        self._changed(number, self._bodies[number].standing.lean(orientation))

    def set_points(self, body: str, points: tuple[Vector3, ...]) -> None:
        """Take the contact points of a body, in its frame."""
        number = self._numbers[body]
        if self._bodies[number].set_points(points):
            self._changed(number, True)

    def support_lost(self, status: Status, stamp: int) -> None:
        """Know that nothing is known of the support at a stamp in ns, and why."""
        self._go_on(stamp)
        self._lose(status)
        self._judge()

    def body_lost(self, body: str, status: Status, stamp: int) -> None:
        """Know that nothing is known of a body at a stamp in ns, and why."""
        number = self._numbers[body]
        self._bodies[number].status = status
        self._changed(number, False)

    @property
    def margins(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The parts (n,) of the margins against sliding and tipping that are used up now, of all bodies in order."""
        return self._margins.slide, self._margins.tip

    def friction_seen(self) -> dict[str, FrictionSeen]:
        """What is seen of the friction of each body."""
        return {name: self._slips.seen(number) for name, number in self._numbers.items()}

    @property
    def is_due(self) -> bool:
        """Whether a second of stamps is over, or a level has changed, since reports were last asked for."""
        now, last = self._now, self._reported
        return now is not None and (self._levels.changed or last is None or now // SECOND != last // SECOND)

    def reports(self) -> tuple[Report, ...]:
        """A report of each body where they are due."""
        now = self._now
        if now is None or not self.is_due:
            return ()
        self._levels.changed = False
        self._reported = now
        work, edges = self._onset.barriers(self._motion)
        bands = self._bands()
        for number, body in enumerate(self._bodies):
            body.band, body.friction_seen = bands.get(number), self._slips.seen(number)
        return tuple(
            [self._report(number, now, float(work[number]), int(edges[number])) for number in range(len(self._bodies))]
        )

    def _bands(self) -> dict[int, tuple[float, float]]:
        """The parts used up of the margins against sliding with the highest and with the lowest friction."""
        stances = [self._bodies[number].standing.stance for number in self._banded]
        if not stances:
            return {}
        if self._band is None or any(one is not other for one, other in zip(stances, self._band[0], strict=True)):
            ends = [self._bodies[number].scene.friction_band[::-1] for number in self._banded]
            pairs = zip(stances, ends, strict=True)
            self._band = stances, Onset([stance._replace(friction=f) for stance, its in pairs for f in its])
        slides = self._band[1].margins(self._motion).slide.tolist()
        return {number: (slides[2 * k], slides[2 * k + 1]) for k, number in enumerate(self._banded)}

    def _go_on(self, stamp: int) -> None:
        """Let time go on; where it has begun anew so does all that waits for a stamp."""
        if self._now is not None and stamp < self._now - SECOND:
            self._levels.begin_anew()
            self._lose(self._support)
            self._reported = None
            self._begun = False
            for watched in self._bodies:
                watched.begin_anew()
            self._now = stamp
        self._now = stamp if self._now is None else max(stamp, self._now)

    def _lose(self, status: Status) -> None:
        self._support = status
        count = len(self._bodies)
        self._used, self._time_to_tip, self._time_to_slide = np.zeros(count), np.full(count, inf), np.full(count, inf)
        self._chance, self._chances, self._scatter = np.zeros(count), np.zeros((2, count)), np.zeros(count)
        self._due = np.full(count, rank_of(status))
        self._felt = [_NO_FORECAST] * count
        self._judged = self._looked = None

    def _look_ahead(self, stamp: int) -> None:
        """Find how likely an onset is within the horizon, and when it has become so likely that a warning is due."""
        self._looked = stamp
        whole = self._outlook_of(self._horizon)
        self._is_learnt = whole.is_learnt
        self._felt = self._felt_ahead(whole) if whole.is_learnt else [_NO_FORECAST] * len(self._bodies)
        ahead = whole.until(self._horizon)
        courses, count = ahead.gravity.shape[:2]
        flat = [each.reshape(-1, 3) for each in (ahead.gravity, ahead.angular, ahead.turning)]
        margins = self._onset.margins(motions(*flat))
        bodies, found = len(self._bodies), []
        for ratios in (margins.tip, margins.slide):
            times = first_times(ratios.reshape(-1, count), ahead.times).reshape(bodies, courses)
            found.append(np.where(times > self._horizons[:, None], inf, times))
        either = np.minimum(*found)
        self._chance, self._chances = np.isfinite(either).mean(axis=1), np.isfinite(found).mean(axis=2)
        # The course of so many from which on the onset is as likely as one that is warned of.
        due = np.maximum(np.ceil(self._likely * courses).astype(int) - 1, 0)
        self._time_to_tip, self._time_to_slide = [np.sort(times)[np.arange(bodies), due] for times in found]
        close = (either <= CLOSE).mean(axis=1) >= CLOSELY * self._likely
        # A group of waves is one warning: it stands while any course has an onset.
        stands = (self._levels.ranks >= WARN) & (self._chance > 0.0)
        self._due = np.where((self._chance >= self._likely) | close | stands, WARN, OK)
        if ahead.is_learnt:
            self._due[(either <= IMMINENT).mean(axis=1) > 0.5] = ERROR

    def _felt_ahead(self, ahead: DeckOutlook) -> list[dict[str, str]]:
        """What each body is likely to feel: of the courses `LEADS` ahead the mean, and the deviation."""
        then = ahead.at(LEADS)
        flat = [each.reshape(-1, 3) for each in (then.gravity, then.angular, then.turning)]
        felt = self._onset.felt(motions(*flat)).reshape(len(self._bodies), 3, -1, len(LEADS))
        parts = np.stack((felt.mean(axis=2), felt.std(axis=2)), axis=1).transpose(0, 3, 1, 2)
        told = parts.reshape(len(felt), -1, 3).tolist()
        said = [["{:.3f} {:.3f} {:.3f}".format(*one) for one in each] for each in told]
        return [dict(zip(_NO_FORECAST, each, strict=True)) for each in said]

    def _shaken(self, errors: tuple[float, float]) -> NDArray[np.float64]:
        """What the parts (n,) of the margins err by where felt gravity and angular acceleration err by so much."""
        motions = np.repeat(self._motion[:, None], 6, axis=1)
        motions[:6] += np.diag(np.repeat(errors, 3))
        margins = self._onset.margins(motions)
        changes = np.maximum(margins.slide, margins.tip) - self._used[:, None]
        scatter: NDArray[np.float64] = np.sqrt(np.square(changes).sum(axis=1))
        return np.minimum(scatter, 1.0 / SURE)  # what is used up twice is so in any noise

    def _hear(self, number: int, stamp: int) -> None:
        """A body's source is heard, at the time that the support's stamps tell."""
        if self._bodies[number].hear(stamp if self._now is None else self._now):
            self._levels.release(number)

    def _changed(self, number: int, stance: bool) -> None:
        """Something of a body is known anew; its level rises at once."""
        watched = self._bodies[number]
        if stance:
            self._onset.replace(number, watched.standing.stance)
        if self._now is None:
            return
        if watched.rank() > self._levels.ranks[number]:
            self._judge()
        elif watched.standing.slid:
            self._remember(number)

    def _judge(self) -> None:
        assert self._now is not None
        self._judged_at = self._now
        others = np.array([body.rank() for body in self._bodies])
        before = self._levels.ranks
        parts = self._used - SURE * self._scatter
        # Once the sea is learnt, how likely an onset is warns of it, and not how near the deck has come to one.
        if self._is_learnt:
            parts = np.where(parts < self._levels.error, 0.0, parts)
        self._levels.update(self._now, parts, np.maximum(others, self._due))
        ranks = self._levels.ranks
        for number in np.flatnonzero((ranks > before) | ((ranks == OK) & (ranks != before))).tolist():
            self._bodies[number].top = NOTHING
            self._remember(number)
        for number in np.flatnonzero(self._used >= self._levels.warn).tolist():
            watched, used = self._bodies[number], self._used_of(number)
            if used.most > watched.top.most:
                watched.top, watched.raised = used, self._now

    def _remember(self, number: int) -> None:
        """Keep what raises the level of a body now, for when it is only held."""
        assert self._now is not None
        body = self._bodies[number]
        body.why, body.raised = "; ".join(body.reasons(self._outlook(number, inf, -1))), self._now

    def _used_of(self, number: int) -> MarginsUsed:
        margins = self._margins
        edge = self._bodies[number].standing.edge_name(int(margins.edge[number]))
        return MarginsUsed(float(margins.tip[number]), edge, float(margins.slide[number]))

    def _outlook(self, number: int, work: float, edge: int) -> BodyOutlook:
        """What is found for a body now; `work` in J topples it over its edge of that number."""
        assert self._now is not None
        body = self._bodies[number]
        # A body that is refused for the support's sake is not silent.
        felt = body.known and self._support is Status.ACCEPTED and self._judged is not None
        passed = 0.0 if self._looked is None else (self._now - self._looked) / NANOSECONDS
        return BodyOutlook(
            status=self._support if body.known and self._support is not Status.ACCEPTED else body.status,
            used=self._used_of(number) if felt else None,
            lifted=felt and bool(self._margins.lifted[number]),
            time_to_tip=max(0.0, float(self._time_to_tip[number]) - passed),
            time_to_slide=max(0.0, float(self._time_to_slide[number]) - passed),
            chance=float(self._chance[number]),
            strikes=body.strikes(self._now),
            barrier=work,
            barrier_edge=body.standing.edge_name(edge),
        )

    def _report(self, number: int, now: int, work: float, edge: int) -> Report:
        body, outlook = self._bodies[number], self._outlook(number, work, edge)
        held = None
        if self._levels.quiet(number, self._judged_at):
            held = (now - body.raised) / NANOSECONDS
        elif words := body.reasons(outlook):
            body.why, body.raised = "; ".join(words), now
        return Report(
            body=body.name,
            stamp=now,
            level=GRAVITY[self._levels.ranks[number]],
            message=body.message(outlook, held),
            values=body.values(outlook, self._counts.per_hour(number), self._odds(number, outlook.used or NOTHING))
            | self._felt[number],
        )

    def _odds(self, number: int, used: MarginsUsed) -> dict[str, str]:
        """What a report tells of what is to be expected of the margins of a body."""
        found = dict[str, str]()
        for row, (name, part) in enumerate((("tip", used.tip), ("slide", used.slide))):
            law = self._peaks.law(row * len(self._bodies) + number)
            # The forecast tells of its horizon, and the peaks of the rest.
            horizon = float(self._horizons[number]) if self._is_learnt else 0.0
            ahead = float(self._chances[row, number]) if self._is_learnt else 0.0
            soon = 1.0 - (1.0 - ahead) * (1.0 - law.probability(max(0.0, SOON - horizon)))
            hour = 1.0 - (1.0 - ahead) * (1.0 - law.probability(HOUR - horizon))
            found |= law.values(name, *((1.0, 1.0) if part >= 1.0 else (soon, hour)))
        return found
