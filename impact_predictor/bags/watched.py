"""What a watch over cargo on a moving deck saw and said during a replay, four times a second of the deck's time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..prediction.deck.forecast import ANGLES, LEADS, angles_of
from ..prediction.types import Moment
from ..prediction.vectors import axes_of, to_body

if TYPE_CHECKING:
    from ..prediction.deck.tracker import Deck
    from ..prediction.watch.watch import Report, Watch

STEP: Final = 250_000_000
"""ns between two rows; after more than `GAP` of them without a message a row of NaN says that nothing is known."""
GAP: Final = 8
FORECAST_EVERY: Final = 2
"""Rows from one forecast that is kept to the next; it is kept `LEADS` ahead."""
QUANTILES: Final = (0.05, 0.5, 0.95)
"""What is kept of the courses of a forecast: nine tenths of them are between the ends."""
DECK: Final = (*ANGLES, "along", "across", "down")
"""Columns of the deck: its angles in rad, above 0 with port up and with the bow down, and what is felt at its origin
along its axes (forward, to port, and down) in m/s^2.
"""
FORECAST: Final = (*ANGLES, "along", "across")
"""Of those, the ones that are forecast."""
UNIT: Final = ("level", "slide", "tip", "probability")
"""Columns of a unit: its level (0 OK, 1 WARN, 2 ERROR, 3 STALE), the most that was used of its margins since the last
row, and how likely the onset was of which it warned.
"""


class LevelSpell(NamedTuple):
    """A unit that has a level from `begin` to `end` (ns)."""

    unit: str
    level: int
    begin: int
    end: int


class WatchLog(NamedTuple):
    """What became of a watch: `stamps` (n,) of the rows in ns; `deck` (n, 5) and `units` (n, units, 4), the columns of
    `DECK` and of `UNIT`, NaN where nothing is known; `spells` of the levels; the `last` values reported of each unit.

    `forecasts` (m, leads, 4, quantiles) of `FORECAST` were made at the rows `made` (m,). `events` tells when (ns)
    something began to happen to each unit, and what, as the bag tells it where it `knows_events`, else as the watch saw
    it.
    """

    names: tuple[str, ...]
    stamps: NDArray[np.int64]
    deck: NDArray[np.float64]
    units: NDArray[np.float64]
    made: NDArray[np.int64]
    forecasts: NDArray[np.float64]
    spells: tuple[LevelSpell, ...]
    last: Mapping[str, Mapping[str, str]]
    tracked: Mapping[str, str] = {}
    """What was reported last of the deck itself."""
    events: Mapping[str, Mapping[int, str]] = {}
    knows_events: bool = False


class WatchRecorder:
    """Keeps what the watch over a deck sees and says."""

    def __init__(self, watch: Watch, deck: Deck, names: Iterable[str]) -> None:
        self._watch, self._deck = watch, deck
        self._names = {name: place for place, name in enumerate(names)}
        self._rows: list[tuple[int, Sequence[float], NDArray[np.float64]]] = []
        self._forecasts: list[tuple[int, NDArray[np.float64]]] = []
        self._spells: list[LevelSpell] = []
        self._begun: dict[str, int] = {}
        self._last: dict[str, dict[str, str]] = {}
        self._now: NDArray[np.float64] = np.full((len(self._names), len(UNIT)), np.nan)
        self._stamp = 0

    def look(self) -> None:
        """Look at the deck and at the margins after a message."""
        moment = self._deck.last
        if moment is None or moment.stamp == self._stamp:
            return
        before, self._stamp = self._stamp, moment.stamp
        self._now[:, 1:3] = np.fmax(self._now[:, 1:3], np.stack(self._watch.margins, axis=1))
        if moment.stamp // STEP == before // STEP:
            return
        if self._rows and not 0 < moment.stamp - self._rows[-1][0] <= GAP * STEP:
            nothing = np.full_like(self._now, np.nan)
            self._rows.append((self._rows[-1][0] + STEP, [np.nan] * len(DECK), nothing))
        if len(self._rows) % FORECAST_EVERY == 0:
            self._forecast()
        self._rows.append((moment.stamp, deck_row(moment), self._now.copy()))
        self._now[:, 1:3] = np.nan

    def take(self, reports: Iterable[Report]) -> None:
        """Take reports in the order of their stamps."""
        for report in reports:
            place, level = self._names[report.body], int(report.level)
            if self._now[place, 0] != level:
                self._end(report.body, report.stamp)
                self._begun[report.body] = report.stamp
            self._now[place, 0] = level
            chance = report.values["onset_probability"]
            self._now[place, 3] = float(chance) if chance[0].isdecimal() else np.nan
            self._last[report.body] = report.values

    def log(self, events: Mapping[str, Mapping[int, str]] | None = None) -> WatchLog:
        """All of it at the end, with the events of each unit where the bag tells them."""
        for name in self._names:
            self._end(name, self._stamp)
        log = WatchLog(
            names=tuple(self._names),
            stamps=np.array([stamp for stamp, _, _ in self._rows], dtype=np.int64),
            deck=np.array([row for _, row, _ in self._rows]).reshape(-1, len(DECK)),
            units=np.array([now for _, _, now in self._rows]).reshape(-1, *self._now.shape),
            made=np.array([row for row, _ in self._forecasts], dtype=np.int64),
            forecasts=np.array([one for _, one in self._forecasts]).reshape(
                -1, len(LEADS), len(FORECAST), len(QUANTILES)
            ),
            spells=tuple(sorted(self._spells, key=lambda spell: spell.begin)),
            last=self._last,
            tracked=self._deck.values(),
        )
        return log._replace(events=seen_events(log) if events is None else events, knows_events=events is not None)

    def _forecast(self) -> None:
        """Keep how the deck will lie and what it will feel, where its sea is learnt."""
        then = self._deck.outlook(LEADS[-1]).at(LEADS)
        if then.angles is not None:
            found: NDArray[np.float64] = np.quantile(
                np.concatenate((then.angles, then.gravity[:, :, :2]), axis=2), QUANTILES, axis=0
            )
            self._forecasts.append((len(self._rows), np.moveaxis(found, 0, -1)))

    def _end(self, name: str, stamp: int) -> None:
        """The level of a unit ends that it has had, if any."""
        if name in self._begun:
            self._spells.append(LevelSpell(name, int(self._now[self._names[name], 0]), self._begun.pop(name), stamp))


def deck_row(moment: Moment) -> tuple[float, ...]:
    """The numbers of `DECK` at a moment."""
    roll, pitch = angles_of(to_body(axes_of(moment.orientation), moment.gravity))
    along, across, down = moment.felt.gravity
    return float(roll), float(pitch), along, across, -down


def seen_events(log: WatchLog) -> dict[str, dict[int, str]]:
    """When (ns) a margin of each unit was used up, after five seconds in which none was, and which."""
    from ..scenarios.comparison import events_of

    found = {}
    for place, name in enumerate(log.names):
        _, slide, tip, _ = log.units[:, place].T
        stamps = log.stamps[np.fmax(slide, tip) >= 1.0].tolist()
        tips = dict(zip(log.stamps.tolist(), tip >= slide, strict=True))
        found[name] = {stamp: f"{'tips' if tips[stamp] else 'slides'}, by its margin" for stamp in events_of(stamps)}
    return found
