"""The watch over bodies on a support: how near each is to sliding and tipping, and a level with its reason.

What is used up of the margins is judged at each message of the support, for all bodies at once. Nothing is ever OK
while the support or a measured body is not known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import Final, NamedTuple

import numpy as np

from ...stamps import NANOSECONDS
from ..scene import MovingDeck, Scene
from ..types import Moment, Quaternion, Sample, Status, Touchdown, Vector3
from .counts import OnsetCounts
from .levels import GRAVITY, OK, WARN, Array, Level, Levels, Numbers
from .onset import Onset, first_times, motion_of, motions
from .unit import Unit, place_of
from .words import Known, Used, message, reasons, values

__all__ = ["Level", "Report", "Watch"]

SECOND: Final = 1_000_000_000
"""ns between two reports without news, and how far stamps may go back before time has begun anew."""

JUDGED_EVERY: Final = 15_000_000
"""ns: a message that comes sooner after the last judgement waits for the next: margins hardly move."""

FORECAST_EVERY: Final = 250_000_000
"""ns from one look ahead to the next."""

FORECAST_TIMES: Final = 50
"""How many times ahead are looked at: 0.1 s apart in the usual horizon of 5 s, in which no deck rolls to and fro."""

Forecast = Callable[[Array], tuple[Array, ...]]


class Report(NamedTuple):
    """What is said of a body at a stamp in ns; `values` are numbers and names as text, always the same in one order."""

    body: str
    stamp: int
    level: Level
    message: str
    values: dict[str, str]


class Watch:
    """Watches bodies, by their names, over one support whose motion `forecast(times)` tells ahead.

    Time is that of the support's stamps.
    """

    def __init__(self, scenes: Mapping[str, Scene], forecast: Forecast) -> None:
        self._units = [Unit(name, scene) for name, scene in scenes.items()]
        self._numbers = {name: number for number, name in enumerate(scenes)}
        self._forecast = forecast
        units = self._units
        self._onset = Onset([unit.standing.stance for unit in units])
        self._levels = Levels([unit.watching for unit in units])
        self._counts = OnsetCounts(np.array([unit.watching.hysteresis for unit in units]))
        self._timeout = int((units[0].scene.deck or MovingDeck()).timeout * NANOSECONDS)
        self._warn = np.array([unit.watching.warn for unit in units])
        self._horizons = np.array([unit.watching.horizon for unit in units])
        self._times = np.linspace(0.0, float(self._horizons.max()), FORECAST_TIMES + 1)
        self._measured = np.array([unit.scene.source != "none" for unit in units])
        self._heard: Numbers = np.zeros(len(units), dtype=np.int64)
        self._others: Numbers = np.array([unit.place() for unit in units])
        self._support = Status.NO_SUPPORT
        self._motion: Array = np.zeros(12)
        self._tip, self._slide, self._used, self._top = (np.zeros(len(units)) for _ in range(4))
        self._edge = np.zeros(len(units), dtype=np.intp)
        self._lifted = np.zeros(len(units), dtype=bool)
        self._time_to_tip: Array = np.full(len(units), inf)
        self._time_to_slide: Array = np.full(len(units), inf)
        self._due: Numbers = np.zeros(len(units), dtype=np.int64)
        self._looked: int | None = None
        self._judged: int | None = None
        self._now: int | None = None
        self._told: int | None = None
        self._judged_at = 0
        self._begun = False

    def update_support(self, moment: Moment) -> None:
        """Take the support's motion now."""
        self._go_on(moment.stamp)
        judged = self._judged
        known, self._support = self._support is Status.ACCEPTED, Status.ACCEPTED
        if not self._begun:
            self._begun = True
            for number in range(len(self._units)):
                self._levels.release(number)
        since = moment.stamp - judged if judged is not None and known else None
        if since is not None and 0 <= since < JUDGED_EVERY:
            return
        self._judged = moment.stamp
        self._motion = motion_of(moment.felt)
        self._slide, self._tip, self._edge, self._lifted = self._onset.margins(self._motion)
        self._used = np.maximum(self._slide, self._tip)
        self._counts.update(self._tip, self._slide, since / NANOSECONDS if since and since <= self._timeout else 0.0)
        if self._looked is None or not 0 <= moment.stamp - self._looked < FORECAST_EVERY:
            self._look_ahead(moment.stamp)
        self._hush(moment.stamp)
        self._judge()

    def update_body(self, body: str, relative: Sample, touchdown: Touchdown | None) -> None:
        """Take a body's pose and twist relative to the support, and the touchdown that they announce."""
        number = self._numbers[body]
        unit = self._units[number]
        self._hear(number, relative.stamp)
        stance = unit.standing.update(relative)
        if unit.struck(relative.stamp, touchdown):
            self._counts.struck(number)
        self._changed(number, stance)

    def update_tilt(self, body: str, stamp: int, orientation: Quaternion) -> None:
        """Take a body's orientation relative to the support."""
        number = self._numbers[body]
        unit = self._units[number]
        self._hear(number, stamp)
        self._changed(number, unit.standing.lean(orientation))

    def set_points(self, body: str, points: tuple[Vector3, ...]) -> None:
        """Take the contact points of a body, in its frame."""
        number = self._numbers[body]
        if self._units[number].set_points(points):
            self._changed(number, True)

    def support_lost(self, status: Status, stamp: int) -> None:
        """Know that nothing is known of the support at a stamp in ns, and why."""
        self._go_on(stamp)
        self._support = status
        self._used = np.zeros(len(self._units))
        self._time_to_tip[:] = self._time_to_slide[:] = inf
        self._judged = self._looked = None
        self._judge()

    def body_lost(self, body: str, status: Status, stamp: int) -> None:
        """Know that nothing is known of a body at a stamp in ns, and why."""
        number = self._numbers[body]
        self._units[number].status = status
        self._changed(number, False)

    def reports(self) -> tuple[Report, ...]:
        """A report of each body where a second of stamps is over or a level has changed since this was last asked."""
        now, told = self._now, self._told
        if now is None or not (self._levels.changed or told is None or now // SECOND != told // SECOND):
            return ()
        self._levels.changed = False
        self._told = now
        work, edges = self._onset.barriers(self._motion)
        return tuple(
            self._report(number, now, float(work[number]), int(edges[number])) for number in range(len(self._units))
        )

    def _go_on(self, stamp: int) -> None:
        """Let time go on; where it has begun anew so does all that waits for a stamp."""
        if self._now is not None and stamp < self._now - SECOND:
            self._levels.begin_anew()
            self._judged = self._looked = self._told = None
            self._begun = False
            for number, unit in enumerate(self._units):
                unit.begin_anew()
                self._others[number] = unit.place()
            self._heard[:] = self._now = stamp
        self._now = stamp if self._now is None else max(stamp, self._now)

    def _look_ahead(self, stamp: int) -> None:
        self._looked = stamp
        ahead = self._onset.margins(motions(*self._forecast(self._times)))
        found = [first_times(ratios, self._times) for ratios in (ahead.tip, ahead.slide)]
        for times in found:
            times[times > self._horizons] = inf
        self._time_to_tip, self._time_to_slide = found
        self._due = np.where(np.minimum(*found) < inf, WARN, OK)

    def _hear(self, number: int, stamp: int) -> None:
        """A body's source is heard, at the time that the support's stamps tell."""
        self._heard[number] = stamp if self._now is None else self._now
        unit = self._units[number]
        unit.status = Status.ACCEPTED
        if not unit.heard:
            unit.heard = True
            self._levels.release(number)

    def _hush(self, stamp: int) -> None:
        """Find the bodies of which nothing is heard any more."""
        quiet = self._measured & (stamp - self._heard > self._timeout)
        if quiet.any():
            for number in np.flatnonzero(quiet).tolist():
                unit = self._units[number]
                if unit.status is Status.ACCEPTED:
                    unit.status = Status.BODY_STALE
                    self._others[number] = unit.place()

    def _changed(self, number: int, stance: bool) -> None:
        """Something of a body is known anew; its level rises at once."""
        unit = self._units[number]
        if stance:
            self._onset.replace(number, unit.standing.stance)
        self._others[number] = place = unit.place()
        if self._now is None:
            return
        if place > self._levels.places[number]:
            self._judge()
        elif unit.standing.slid:
            self._remember(number)

    def _judge(self) -> None:
        assert self._now is not None
        self._judged_at = self._now
        others = self._others
        if self._support is not Status.ACCEPTED:
            others = np.maximum(others, place_of(self._support))
        else:
            others = np.maximum(others, self._due)
        before = self._levels.places
        self._levels.update(self._now, self._used, others)
        places = self._levels.places
        if places is not before:
            anew = (places > before) | (places == OK)
            self._top[anew] = 0.0
            for number in np.flatnonzero(anew).tolist():
                self._units[number].top = Used(0.0, "", 0.0)
                self._remember(number)
        more = (self._used > self._top) & (self._used >= self._warn)
        if more.any():
            self._top[more] = self._used[more]
            for number in np.flatnonzero(more).tolist():
                self._units[number].top, self._units[number].raised = self._used_of(number), self._now

    def _remember(self, number: int) -> None:
        """Keep what raises the level of a body now, for when it is only held."""
        assert self._now is not None
        unit = self._units[number]
        unit.why, unit.raised = "; ".join(reasons(self._known(number, inf, -1))), self._now

    def _used_of(self, number: int) -> Used:
        edges = self._units[number].standing.stance.edges
        edge = edges[self._edge[number]].name if self._edge[number] < len(edges) else ""
        return Used(float(self._tip[number]), edge, float(self._slide[number]))

    def _known(self, number: int, work: float, edge: int) -> Known:
        """What is known of a body now; `work` in J topples it over its edge of that number."""
        unit = self._units[number]
        standing, edges = unit.standing, unit.standing.stance.edges
        status = unit.status
        if status in (Status.ACCEPTED, Status.BODY_STALE) and self._support is not Status.ACCEPTED:
            status = self._support  # a body that is refused for the support's sake is not silent
        felt = self._support is Status.ACCEPTED and unit.known and self._judged is not None
        tips, slides, impacts = self._counts.per_hour(number)
        assert self._now is not None
        return Known(
            status=status,
            rolls=bool(unit.scene.radius),
            solid=standing.solid,
            motion=standing.motion,
            tilt=standing.tilt,
            toppled=standing.toppled,
            slid=standing.slid,
            kinetic=standing.kinetic,
            strike=unit.strike(self._now),
            used=self._used_of(number) if felt else None,
            lifted=felt and bool(self._lifted[number]),
            time_to_tip=self._until(self._time_to_tip[number]),
            time_to_slide=self._until(self._time_to_slide[number]),
            barrier=work,
            barrier_edge=edges[edge].name if 0 <= edge < len(edges) else "",
            slides_per_hour=slides,
            tips_per_hour=tips,
            impacts_per_hour=impacts if unit.scene.source == "odom" else None,
        )

    def _until(self, time: float) -> float:
        """What is left in s of a time found when it was last looked ahead."""
        if self._looked is None or self._now is None:
            return inf
        return max(0.0, float(time) - (self._now - self._looked) / NANOSECONDS)

    def _report(self, number: int, now: int, work: float, edge: int) -> Report:
        unit = self._units[number]
        known = self._known(number, work, edge)
        held = None
        if self._levels.quiet(number, self._judged_at):
            held = (now - unit.raised) / NANOSECONDS, unit.reason()
        elif words := reasons(known):
            unit.why, unit.raised = "; ".join(words), now
        level = GRAVITY[self._levels.places[number]]
        return Report(unit.name, now, level, message(known, unit.watching, held), values(known))
