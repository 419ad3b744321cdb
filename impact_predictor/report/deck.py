"""What happened to the cargo on a simulated deck, as it is shown: each unit, and the whole."""

from __future__ import annotations

from collections import Counter
from math import degrees, hypot
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from ..mechanics.motion import End
from ..scenarios.deck.voyage import Followed, Voyage
from ..scenarios.truth import TrueImpact
from ..stamps import NANOSECONDS
from .table import plain_table, show

RESOLVED: Final = 0.05
"""Approach in m/s above which an impact is told from the last small ones of a unit that comes to rest."""

_ENDS: Final = {
    End.OVERTURNED: "toppled",
    End.RESTS: "rests",
    End.BALANCED: "is balanced",
    End.TIME_UP: "stands",
}


def as_json(voyage: Voyage) -> dict[str, Any]:
    """A voyage as JSON: times in s, angular velocities as magnitudes in rad/s, angles in rad, displacements in m.

    `impacts` are those of all units in order of time; `accumulation_time` is when impacts last accumulated so that a
    contact stayed closed, null if they never did. `units` has the same for each unit.
    """
    ordered = sorted(((impact.stamp, one, impact) for one in voyage.units for impact in one.impacts), key=_by_time)
    return {
        "duration": voyage.duration,
        "impacts": [{"unit": one.unit.name, **_impact(impact)} for _, one, impact in ordered],
        "accumulation_time": max((one.sums[-1] for one in voyage.units if one.sums), default=None),
        "end": _end(voyage),
        "deck": {"most_rolled": voyage.most_rolled, "most_lateral": voyage.most_lateral},
        "units": {one.unit.name: _unit(one) for one in voyage.units},
    }


def _by_time(entry: tuple[int, Followed, TrueImpact]) -> int:
    return entry[0]


def _end(voyage: Voyage) -> str:
    """The end of the voyage: of the only unit, of one that was lost, or TIME_UP."""
    ends = [one.end for one in voyage.units]
    return max(ends).name if len(ends) == 1 or voyage.broke_off else End.TIME_UP.name


def _impact(impact: TrueImpact) -> dict[str, Any]:
    return {
        "time": impact.stamp / NANOSECONDS,
        "mode": impact.mode.name,
        "omega_before": hypot(*impact.angular_before),
        "omega_after": hypot(*impact.angular_after),
    }


def _unit(one: Followed) -> dict[str, Any]:
    return {
        "impacts": [_impact(impact) for impact in one.impacts],
        "accumulation_time": one.sums[-1] if one.sums else None,
        "end": one.end.name,
        "time": one.time,
        "resolved_impacts": sum(impact.approach > RESOLVED for impact in one.impacts),
        "onsets": [
            {"time": onset.stamp / NANOSECONDS, "slides": onset.slides, "lifts": onset.lifts} for onset in one.onsets
        ],
        "most_turned": one.most_turned,
        "moved": one.moved,
    }


def print_voyage(console: Console, voyage: Voyage) -> None:
    """Print what happened to each unit and to all."""
    minutes = voyage.duration / 60.0
    _say(
        console,
        f"{minutes:.4g} min on a deck that rolls up to {degrees(voyage.most_rolled):.1f} degrees and pushes to the "
        f"side with up to {voyage.most_lateral:.2f} of the weight.",
    )
    show(console, unit_table(voyage))
    for sentence in sentences(voyage):
        _say(console, sentence)


def unit_table(voyage: Voyage) -> Table:
    """The units: what they did first, how often they struck, and where they are."""
    table = plain_table()
    headers = ("first\nslide\ns", "first\nlift\ns", "impacts", f"above\n{RESOLVED:g}\nm/s", "fastest\n\nm/s")
    table.add_column("unit", no_wrap=True)
    for header in (*headers, "turned\nup to\ndegrees", "moved\nto port\nm"):
        table.add_column(header, justify="right", no_wrap=True)
    table.add_column("at the\nend", no_wrap=True)
    for one in voyage.units:
        end = _ENDS.get(one.end, "lost")
        table.add_row(
            one.unit.name,
            _first(onset.stamp for onset in one.onsets if onset.slides),
            _first(onset.stamp for onset in one.onsets if onset.lifts),
            str(len(one.impacts)),
            str(sum(impact.approach > RESOLVED for impact in one.impacts)),
            f"{max(impact.approach for impact in one.impacts):.2f}" if one.impacts else "-",
            f"{degrees(one.most_turned):.1f}",
            f"{one.moved:+.2f}",
            end,
        )
    return table


def _first(stamps: Any) -> str:
    first = min(stamps, default=None)
    return "-" if first is None else f"{first / NANOSECONDS:.2f}"


def sentences(voyage: Voyage) -> list[str]:
    """What the table comes to."""
    impacts = [impact for one in voyage.units for impact in one.impacts]
    minutes = voyage.duration / 60.0
    said = ["No contact ever struck."]
    if impacts:
        modes = Counter(impact.mode.name for impact in impacts if impact.approach > RESOLVED)
        counts = ": " + ", ".join(f"{count} {mode}" for mode, count in modes.most_common()) if modes else ""
        said = [
            f"{len(impacts)} impact{'s' if len(impacts) > 1 else ''}, {len(impacts) / minutes:.3g} a minute.",
            f"{modes.total()} of them came with more than {RESOLVED:g} m/s{counts}.",
        ]
    toppled = [f"{one.unit.name} at {one.time:.1f} s" for one in voyage.units if one.end is End.OVERTURNED]
    if toppled:
        said.append(f"Toppled, and not recorded after that: {', '.join(toppled)}.")
    return said


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
