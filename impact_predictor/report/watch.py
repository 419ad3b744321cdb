"""What a watch over a moving deck answers to programs: its log as JSON, thinned, and row by row for a table."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import product
from math import isfinite
from statistics import median
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..bags.watched import DECK, FORECAST, QUANTILES, UNIT, LevelSpell, WatchLog
from ..prediction.deck.forecast import ANGLES, LEADS
from ..prediction.watch.levels import UNKNOWN, Level
from ..stamps import NANOSECONDS
from ..wording import counted, percent

MOST: Final = 1500
"""Rows of the JSON; of a longer log it has the least and the greatest of each stretch, of units the greatest."""
GRAVE: Final = (Level.WARN, Level.ERROR)


def watch_as_json(log: WatchLog) -> dict[str, Any]:
    """The log of a watch: its motion, forecasts, levels and margins over time, events, warnings and statistics."""
    count = -(-len(log.stamps) // MOST) if len(log.stamps) > MOST else 1
    deck, units, stamps = _ends(log.deck, count), log.units, log.stamps
    if count > 1:
        units = np.repeat(np.fmax.reduce(_groups(units, count), axis=1), 2, axis=0)
        stamps = _groups(stamps, count)[:, [0, count // 2]].ravel()
    some = slice(None, None, -(-len(log.made) // MOST) or 1)
    told = log.forecasts[some]
    return {
        "stamps": stamps.tolist(),
        "deck": {name: _numbers(deck[:, k]) for k, name in enumerate(DECK)},
        "forecasts": {
            "made": log.stamps[log.made[some]].tolist(),
            "leads": LEADS,
            "quantiles": QUANTILES,
            **{
                name: [[_numbers(part) for part in of.T] for of in np.swapaxes(told[:, :, k], 0, 1)]
                for k, name in enumerate(FORECAST)
            },
        },
        "skill": forecast_skill(log),
        "tracked": _known(log.tracked),
        "knows_events": log.knows_events,
        "units": {
            name: {
                **{key: _numbers(units[:, place, k]) for k, key in enumerate(UNIT) if key != "level"},
                **unit_as_json(log, place),
            }
            for place, name in enumerate(log.names)
        },
    }


def unit_as_json(log: WatchLog, place: int) -> dict[str, Any]:
    """Levels, events and warnings of a unit, the most that was used of its margins, and what was reported last."""
    name = log.names[place]
    spells = [one for one in log.spells if one.unit == name]
    known = next((one.begin for one in spells if one.level != Level.STALE), None)
    events = {at: what for at, what in log.events.get(name, {}).items() if known is not None and at >= known}
    warnings = warnings_of(spells)
    return {
        "levels": [[Level(one.level).name, one.begin, one.end] for one in spells],
        "warnings": [
            {"begin": one.begin, "end": one.end, "vain": not any(one.begin <= stamp <= one.end for stamp in events)}
            for one in warnings
        ],
        "events": [
            {
                "stamp": stamp,
                "what": what,
                "warned_ahead": _stood(warnings, stamp),
                "error_ahead": _stood([one for one in spells if one.level == Level.ERROR], stamp),
            }
            for stamp, what in events.items()
        ],
        "most": {key: float(np.nanmax(log.units[:, place, k], initial=0.0)) for k, key in ((1, "slide"), (2, "tip"))},
        "reported": _known(log.last.get(name, {})),
    }


def _known(values: Mapping[str, str]) -> dict[str, float | str]:
    """The values of a report that are known, as numbers where they are some."""
    return {key: value for key, text in values.items() if (value := _value(text)) is not None}


def _value(text: str) -> float | str | None:
    with suppress(ValueError):
        return float(text) if isfinite(float(text)) else None
    return None if text == UNKNOWN else text


def warnings_of(spells: Sequence[LevelSpell]) -> list[LevelSpell]:
    """The times in which the level of a unit was WARN or ERROR without a break, each with the gravest of its levels."""
    found: list[LevelSpell] = []
    for one in spells:
        if one.level in GRAVE and found and found[-1].end == one.begin:
            found[-1] = found[-1]._replace(end=one.end, level=max(found[-1].level, one.level))
        elif one.level in GRAVE:
            found.append(one)
    return found


def warned_of(units: Iterable[Mapping[str, Any]]) -> tuple[str, str]:
    """How many events of units were warned of, and how early; how many warnings were vain, and the part of the time
    that they stood, in words.
    """
    units = list(units)
    events, warnings = ([one for unit in units for one in unit[key]] for key in ("events", "warnings"))
    leads = [one["warned_ahead"] for one in events if one["warned_ahead"] is not None]
    ahead = f"a warning had stood {median(leads):.1f} s in the median, {min(leads):.1f} s at least; " if leads else ""
    vain = f"{sum(one['vain'] for one in warnings):,} of {counted(len(warnings), 'warning')} vain"
    share = under_warning(units)
    stood = f"; units were under warning {percent(share)} % of the time: so many events a warning meets by chance"
    return f"{len(leads):,} of {len(events):,}" if events else "none happened", ahead + (
        vain + (stood if share is not None else "") if warnings else "no warning"
    )


def under_warning(units: Iterable[Mapping[str, Any]]) -> float | None:
    """The part of the time under warning, of that in which levels of units were known; None where none was."""
    units = list(units)
    known = sum(end - begin for unit in units for level, begin, end in unit["levels"] if level != Level.STALE.name)
    stood = sum(one["end"] - one["begin"] for unit in units for one in unit["warnings"])
    return stood / known if known else None


def _stood(spells: Sequence[LevelSpell], stamp: int) -> float | None:
    """How long in s one of the spells had lasted at a stamp; None where none had."""
    return next(((stamp - one.begin) / NANOSECONDS for one in spells if one.begin < stamp <= one.end), None)


def forecast_skill(log: WatchLog) -> list[dict[str, Any]]:
    """Root mean squares of the errors of the forecasts in rad or m/s^2, beside those of what is so now and of the mean,
    and the part of what came that was between the outer quantiles.
    """
    found = []
    for (lead, seconds), (part, name) in product(enumerate(LEADS), enumerate(FORECAST)):
        felt, due = log.deck[:, DECK.index(name)], log.stamps[log.made] + round(seconds * NANOSECONDS)
        came = np.interp(due, log.stamps, felt, right=np.nan) if len(felt) else np.zeros(0)
        known = np.isfinite(came) & np.isfinite(felt[log.made])
        if known.any():
            came, (low, middle, high) = came[known], log.forecasts[known, lead, part].T
            answers = {"forecast": middle, "now": felt[log.made][known], "mean": np.nanmean(felt)}
            errors = {key: float(np.sqrt(np.mean((answer - came) ** 2))) for key, answer in answers.items()}
            within = float(np.mean((low <= came) & (came <= high)))
            found.append({"of": name, "lead": seconds, "count": len(came), **errors, "within": within})
    return found


def _groups(values: NDArray[Any], count: int) -> NDArray[Any]:
    """Rows (n, ...) in groups of `count`, the last one filled up."""
    fill = np.repeat(values[-1:], -len(values) % count, axis=0)
    return np.concatenate((values, fill)).reshape(-1, count, *values.shape[1:])


def _ends(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Of each group the least and the greatest, as they follow each other; all rows where a group is one."""
    if count == 1:
        return values
    groups = _groups(values, count)
    places = np.sort(np.stack([groups.argmin(axis=1), groups.argmax(axis=1)], axis=1), axis=1)
    return np.take_along_axis(groups, places, axis=1).reshape(-1, *values.shape[1:])


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    return [round(value, 4) if isfinite(value) else None for value in values.tolist()]


SERIES: Final = {
    "bag": ("string", ""),
    "stamp": ("int64", "ns"),
    **dict.fromkeys(DECK[:2], ("float64", "rad")),
    **dict.fromkeys(DECK[2:], ("float64", "m/s^2")),
    **{
        f"{name}_in_{lead:g}s_{quantile:g}": ("float64", "rad" if name in ANGLES else "m/s^2")
        for lead, name, quantile in product(LEADS, FORECAST, QUANTILES)
    },
    "unit": ("string", ""),
    "level": ("string", ""),
    **dict.fromkeys(UNIT[1:], ("float64", "1")),
}
"""The columns of a table of watches, with types of Arrow and units: a row for each unit at each stamp."""


def series_of(bag: str, log: WatchLog) -> Iterator[dict[str, Any]]:
    """The rows of `SERIES`, none thinned; a forecast stands where it was made."""
    made = dict(zip(log.made.tolist(), log.forecasts, strict=True))
    names, start = list(SERIES), len(DECK) + 2
    for row, (stamp, deck) in enumerate(zip(log.stamps.tolist(), log.deck.tolist(), strict=True)):
        told = dict(zip(names[start:], made[row].ravel().tolist(), strict=False)) if row in made else {}
        for name, (level, *used) in zip(log.names, log.units[row].tolist(), strict=True):
            known = dict(zip((*DECK, *UNIT[1:]), (*deck, *used), strict=True))
            yield {
                "bag": bag,
                "stamp": stamp,
                **{key: value for key, value in (known | told).items() if isfinite(value)},
                "unit": name,
                "level": Level(int(level)).name if isfinite(level) else None,
            }
