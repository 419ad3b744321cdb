"""What `simulate` prints: the impacts of bodies that rock and of a wheel, cargo on a deck, and how each ended."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from math import degrees, hypot, inf
from typing import Any, Final, NamedTuple

from rich.console import Console

from ..mechanics.motion import End, PlanarState, RockingImpact, Trajectory
from ..mechanics.types import Mode
from ..scenarios.deck.voyage import Followed, Voyage
from ..scenarios.rocking import Rocking
from ..scenarios.truth import TrueImpact, TrueOnset
from ..scenarios.wheel import RollEnd, Rolling
from ..scenarios.wheel_closed_forms import downhill, impact_friction, least_friction, steady
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, fixed, words
from .table import Column, more, say, show, table_of

MOST_IMPACTS: Final = 12
"""Impacts that are listed; the others of an accumulation say no more."""
RESOLVED: Final = 0.05
"""Approach in m/s above which an impact is told from the last small ones of a unit that comes to rest."""
ENDS: Final = {
    End.RESTS: "rests on both contacts",
    End.BALANCED: "stands still on one contact, balanced",
    End.OVERTURNED: "has overturned",
    End.TIME_UP: "still moves: the time is up (--duration)",
    End.TOO_MANY_EVENTS: "has too many events to go on",
    End.NO_SOLUTION: "cannot go on: the impact law has no answer",
    End.INVALID_INPUT: "cannot be computed: a number is out of its range",
}
ROLL_ENDS: Final = {
    RollEnd.STEPS_DONE: "is over its last spoke (--steps)",
    RollEnd.RESTS: "rests on two spokes",
    RollEnd.BALANCED: "stands still on one spoke, balanced",
    RollEnd.TIME_UP: "still moves: the time is up (--duration)",
    RollEnd.TAKES_OFF: "leaves the ground: it turns too fast to roll",
    RollEnd.LOST: "cannot go on: the impact law has no answer, or there are too many events",
}
_UNIT_ENDS: Final = {End.OVERTURNED: "toppled", End.TIME_UP: "stands"}
_REST: Final = 1e-12
"""An angular velocity (rad/s) this small is none."""


def impact_as_json(time: float, mode: Mode, before: float, after: float) -> dict[str, Any]:
    """An impact: time in s, angular velocities as magnitudes in rad/s."""
    return {"time": time, "mode": mode.name, "omega_before": abs(before), "omega_after": abs(after)}


def _planar(strike: RockingImpact) -> dict[str, Any]:
    return impact_as_json(strike.time, strike.outcome.mode, strike.before.omega, strike.after.omega)


def _spatial(impact: TrueImpact) -> dict[str, Any]:
    before, after = hypot(*impact.angular_before), hypot(*impact.angular_after)
    return impact_as_json(impact.stamp / NANOSECONDS, impact.mode, before, after)


class ListedImpact(NamedTuple):
    """An impact in a table, and where it was."""

    number: int
    place: str
    strike: RockingImpact


def _print_impacts(console: Console, header: str, places: Iterable[str], strikes: Sequence[RockingImpact]) -> None:
    """Print the first impacts of a motion, angular velocities as magnitudes."""
    listed = [ListedImpact(k, *one) for k, one in enumerate(zip(places, strikes[:MOST_IMPACTS], strict=False), 1)]
    columns = [
        Column("impact\n", lambda row: f"{row.number}"),
        Column("time\ns", lambda row: f"{row.strike.time:.6f}"),
        Column(header, lambda row: row.place, left=True),
        Column("mode\n", lambda row: row.strike.outcome.mode.name, left=True),
        Column("before\nrad/s", lambda row: f"{_rate(row.strike.before):.6g}"),
        Column("after\nrad/s", lambda row: f"{_rate(row.strike.after):.6g}"),
        Column("ratio\n", lambda row: _ratio(row.strike)),
        Column("energy\nlost, J", lambda row: f"{row.strike.outcome.energy_lost:.3g}"),
    ]
    if listed:
        show(console, table_of(columns, listed))
    say(console, *more(len(strikes) - MOST_IMPACTS, "impact", "read them with --json"))


def _rate(state: PlanarState) -> float:
    return abs(state.omega) if abs(state.omega) > _REST else 0.0


def _ratio(strike: RockingImpact) -> str:
    kept = strike.after.omega / strike.before.omega if _rate(strike.before) and _rate(strike.after) else None
    return fixed(kept, 4)


def rocking_as_json(run: Trajectory) -> dict[str, Any]:
    """A motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `accumulation_time` is when impacts last accumulated so that both contacts stayed closed; null if they never did.
    """
    times = [one.time for one in run.accumulations if len(one.contacts) == 2]
    return {
        "impacts": [_planar(strike) for strike in run.impacts],
        "accumulation_time": times[-1] if times else None,
        "end": run.end.name,
    }


def print_rocking(console: Console, rocking: Rocking) -> None:
    """Print the impacts of a motion and how it ended."""
    run = rocking.run
    say(console, f"{rocking.rocker.name}, {rocking.rocker.label}")
    _print_impacts(console, "at\n", ["AB"[one.new] for one in run.impacts], run.impacts)
    for one in run.accumulations:
        then = f"the body {'slides' if one.slides else 'stays'} on both contacts"
        if len(one.contacts) == 1:
            then = f"contact {'AB'[one.contacts[0]]} stays closed"
        say(console, f"Impacts accumulate at {one.time:.6f} s; then {then}.")
    say(console, f"At {run.time:.6f} s it {ENDS[run.end]}.")


def rolling_as_json(rolling: Rolling) -> dict[str, Any]:
    """A rolling motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `steps` and `speed` count ahead. `steady` is the closed form of rolling down the slope without slip, with the least
    friction coefficient for it; null where the wheel stops, or no friction is enough.
    """
    wheel = rolling.wheel
    down = downhill(wheel)
    rolls, known = steady(down), None
    if rolls is not None and (needed := least_friction(down)) < inf:
        known = {
            "omega_before": rolls.before,
            "omega_after": rolls.after,
            "step_time": rolls.time,
            "speed": rolls.speed,
            "friction": needed,
        }
    return {
        "impacts": [{**_planar(strike), "old": old, "new": new} for old, new, strike in rolling.impacts],
        "steps": rolling.steps,
        "speed": rolling.distance / rolling.time if rolling.time > 0.0 else 0.0,
        "steady": known,
        "impact_friction": impact_friction(wheel.hub, wheel.alpha),
        "time": rolling.time,
        "end": rolling.end.name,
    }


def print_rolling(console: Console, rolling: Rolling) -> None:
    """Print the impacts of a wheel and how it ended."""
    wheel = rolling.wheel
    slope = f"{degrees(wheel.hub.slope):.4g} degrees"
    say(console, f"wheel, {wheel.spokes} spokes {wheel.hub.leg:g} m long, slope {slope}")
    places = [f"{NONE if one.old is None else one.old} > {one.new}" for one in rolling.impacts]
    _print_impacts(console, "from, to\nspoke", places, [one.strike for one in rolling.impacts])
    say(console, *rolling_sentences(rolling))


def rolling_sentences(rolling: Rolling) -> list[str]:
    """How the motion ended, and what steady rolling down the slope would be."""
    way = f"{counted(rolling.steps, 'step')} and {rolling.distance:.3f} m ahead"
    said = [f"At {rolling.time:.6f} s it {ROLL_ENDS[rolling.end]}, {way}."]
    wheel, down = rolling.wheel, downhill(rolling.wheel)
    rolls = steady(down)
    if rolls is None:
        return [
            *said,
            "On this slope it does not keep rolling: each impact takes more than a step gives (closed form).",
        ]
    needed = least_friction(down)
    if needed == inf:
        none = "no friction is enough, the ground would have to hold its spokes down (closed form)"
        return [*said, f"Without slip it cannot roll steadily: {none}."]
    struck = impact_friction(wheel.hub, wheel.alpha)
    rates = f"{rolls.before:.9f} rad/s before each impact, {rolls.after:.9f} after it"
    friction = f"a friction coefficient of {struck:.6f} in the impacts, between them {needed:.6f}"
    return [
        *said,
        f"Steady rolling without slip, closed form: {rates}, a step in {rolls.time:.6f} s, {rolls.speed:.4f} m/s.",
        f"It needs {friction}; the wheel has {wheel.hub.friction:g}.",
    ]


def voyage_as_json(voyage: Voyage) -> dict[str, Any]:
    """A voyage as JSON: times in s, angular velocities as magnitudes in rad/s, angles in rad, displacements in m.

    `impacts` are those of all units in order of time; `accumulation_time` is when impacts last accumulated so that a
    contact stayed closed, null if they never did. `units` has the same for each unit.
    """
    impacts = [(impact, one) for one in voyage.units for impact in one.impacts]
    impacts.sort(key=lambda pair: pair[0].stamp)
    ends = [one.end for one in voyage.units]
    # Of the only unit, of one that was lost, or TIME_UP.
    end = max(ends) if len(ends) == 1 or voyage.broke_off else End.TIME_UP
    return {
        "duration": voyage.duration,
        "impacts": [{"unit": one.unit.name, **_spatial(impact)} for impact, one in impacts],
        "accumulation_time": max((one.sums[-1] for one in voyage.units if one.sums), default=None),
        "end": end.name,
        "deck": {"most_rolled": voyage.most_rolled, "most_lateral": voyage.most_lateral},
        "units": {one.unit.name: _unit(one) for one in voyage.units},
    }


def _unit(one: Followed) -> dict[str, Any]:
    return {
        "impacts": [_spatial(impact) for impact in one.impacts],
        "accumulation_time": one.sums[-1] if one.sums else None,
        "end": one.end.name,
        "time": one.time,
        "resolved_impacts": len(_resolved(one.impacts)),
        "onsets": [
            {"time": onset.stamp / NANOSECONDS, "slides": onset.slides, "lifts": onset.lifts} for onset in one.onsets
        ],
        "most_turned": one.most_turned,
        "moved": one.moved,
    }


def _resolved(impacts: Iterable[TrueImpact]) -> list[TrueImpact]:
    return [impact for impact in impacts if impact.approach > RESOLVED]


def print_voyage(console: Console, voyage: Voyage) -> None:
    """Print what happened to each unit and to all: what they did first, how often they struck, and where they are."""
    say(
        console,
        f"{voyage.duration / 60.0:.4g} min on a deck that rolls up to {degrees(voyage.most_rolled):.1f} degrees and "
        f"pushes to the side with up to {voyage.most_lateral:.2f} of the weight.",
    )
    columns = [
        Column("unit", lambda one: one.unit.name, left=True),
        Column("first\nslide\ns", lambda one: _first(onset for onset in one.onsets if onset.slides)),
        Column("first\nlift\ns", lambda one: _first(onset for onset in one.onsets if onset.lifts)),
        Column("impacts", lambda one: f"{len(one.impacts)}"),
        Column(f"above\n{RESOLVED:g}\nm/s", lambda one: f"{len(_resolved(one.impacts))}"),
        Column("fastest\nm/s", lambda one: fixed(max((hit.approach for hit in one.impacts), default=None), 2)),
        Column("turned\nup to\ndegrees", lambda one: f"{degrees(one.most_turned):.1f}"),
        Column("moved\nto port\nm", lambda one: f"{one.moved:+.2f}"),
        Column("at the\nend", lambda one: _UNIT_ENDS.get(one.end, words(one.end.name)), left=True),
    ]
    show(console, table_of(columns, voyage.units))
    impacts = [impact for one in voyage.units for impact in one.impacts]
    modes = Counter(impact.mode.name for impact in _resolved(impacts))
    counts = ", ".join(f"{count} {mode}" for mode, count in modes.most_common()) or "none"
    every = f"{counted(len(impacts), 'impact')}, {60.0 * len(impacts) / voyage.duration:.3g} a minute"
    say(console, f"{every}, with more than {RESOLVED:g} m/s: {counts}.")
    toppled = [f"{one.unit.name} at {one.time:.1f} s" for one in voyage.units if one.end is End.OVERTURNED]
    if toppled:
        say(console, f"Toppled, and not recorded after that: {', '.join(toppled)}.")


def _first(onsets: Iterable[TrueOnset]) -> str:
    return fixed(min((onset.stamp / NANOSECONDS for onset in onsets), default=None), 2)
