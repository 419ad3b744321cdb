"""The picture of a watch over a deck: its motion and forecast, and the levels and margins of its units over time."""

from __future__ import annotations

import os
from math import degrees
from typing import Any, Final

import numpy as np

from ..bags.watched import DECK, FORECAST, WatchLog
from ..prediction.deck.forecast import ANGLES, LEADS
from ..prediction.watch.levels import Level
from ..stamps import NANOSECONDS
from ..wording import counted
from .modes import EDGE, LEVELS, PALETTE
from .plot import Axes, common_legend, headline, picture
from .watch import unit_as_json, warned_of

MOST: Final = 6
"""Units that are drawn; of more those that came nearest to an onset."""
LEAD: Final = LEADS.index(5.0)
"""The forecast that is drawn."""


def write_watch(path: str | os.PathLike[str], log: WatchLog, title: str) -> None:
    """Draw the log of a watch into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    units = [unit_as_json(log, place) for place in range(len(log.names))]
    near = [(len(unit["events"]), max(unit["most"].values()), -place) for place, unit in enumerate(units)]
    shown = sorted([-place for *_, place in sorted(near, reverse=True)[:MOST]])
    start = log.stamps[0] if len(log.stamps) else 0
    times = (log.stamps - start) / NANOSECONDS
    felt = max(FORECAST[2:], key=lambda name: np.nanmax(log.deck[:, DECK.index(name)], initial=0.0))
    with picture(path, 11.0, 4.6 + 1.35 * len(shown)) as figure:
        panels = figure.subplots(3 + len(shown), 1, sharex=True)
        warned, said = warned_of(units)
        headline(figure, f"{title}: events warned of: {warned}; {said}")
        for name, axes in zip((*ANGLES, felt), panels, strict=False):
            _draw_deck(axes, log, times, name)
        for place, axes in zip(shown, panels[3:], strict=True):
            _draw_unit(axes, log, place, times)
        figure.axes[-1].set(xlabel="time (s)", xlim=(0.0, times.max(initial=1.0)))
        figure.align_ylabels(figure.axes)
        common_legend(figure)


def _draw_deck(axes: Axes, log: WatchLog, times: Any, name: str) -> None:
    """A number of the deck, and the forecast of it."""
    scale = degrees(1.0) if name in ANGLES else 1.0
    low, middle, high = scale * log.forecasts[:, LEAD, FORECAST.index(name)].T
    due, said = times[log.made] + LEADS[LEAD], f"forecast {LEADS[LEAD]:g} s before"
    axes.fill_between(due, low, high, color=PALETTE[4], alpha=0.35, linewidth=0.0, label=f"{said}: 90 % band")
    axes.plot(due, middle, "--", color=PALETTE[0], linewidth=1.0, label=said)
    axes.plot(times, scale * log.deck[:, DECK.index(name)], color=EDGE, linewidth=1.0, label="measured")
    axes.set_ylabel(f"{name} (°)" if name in ANGLES else f"felt {name}\n(m/s²)")


def _draw_unit(axes: Axes, log: WatchLog, place: int, times: Any) -> None:
    """The part that is used of the margins of a unit, below a ribbon of its levels."""
    _, slide, tip, chance = log.units[:, place].T
    start = log.stamps[0] if len(log.stamps) else 0
    axes.fill_between(times, 0.0, tip, color=PALETTE[1], alpha=0.3, linewidth=0.0)
    axes.plot(times, tip, color=PALETTE[1], linewidth=1.0, label="margin used against tipping")
    axes.plot(times, slide, color=PALETTE[0], linewidth=1.0, label="margin used against sliding")
    axes.plot(times, chance, ":", color=PALETTE[2], linewidth=1.2, label="probability of an onset")
    axes.axhline(1.0, color=LEVELS["ERROR"], linewidth=0.8)
    for level, colour in LEVELS.items():
        spells = [one for one in log.spells if (one.unit, Level(one.level).name) == (log.names[place], level)]
        spans = [((one.begin - start) / NANOSECONDS, (one.end - one.begin) / NANOSECONDS) for one in spells]
        if spans:
            axes.broken_barh(spans, (1.55, 0.2), facecolor=colour, label=level)
    events = [(stamp - start) / NANOSECONDS for stamp in log.events.get(log.names[place], ())]
    axes.plot(events, [1.0] * len(events), "v", color=EDGE, markersize=6, label="event")
    axes.set(ylabel="margin used", ylim=(0.0, 1.78), yticks=(0.0, 0.5, 1.0, 1.5))
    axes.set_title(f"{log.names[place] or 'the unit'}: {counted(len(events), 'event')}", fontsize=10, pad=3)
