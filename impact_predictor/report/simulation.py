"""What `simulate` prints: the impacts of bodies that rock and of a wheel, cargo on a deck, and how each ended."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from itertools import islice
from math import degrees, hypot, inf
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from ..mechanics.motion import Accumulation, End, RockingImpact, Trajectory
from ..scenarios.deck.voyage import Followed, Voyage
from ..scenarios.rocking import Rocking
from ..scenarios.truth import TrueImpact, TrueOnset
from ..scenarios.wheel import RollEnd, Rolling
from ..scenarios.wheel_closed_forms import downhill, impact_friction, least_friction, steady
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, fixed
from .table import Column, say, show, table_of

MOST_ROWS: Final = 12
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
UNIT_ENDS: Final = {
    End.OVERTURNED: "toppled",
    End.RESTS: "rests",
    End.BALANCED: "is balanced",
    End.TIME_UP: "stands",
}

_REST: Final = 1e-12
"""An angular velocity (rad/s) this small is none."""


def strike_as_json(strike: RockingImpact) -> dict[str, Any]:
    """An impact of a motion in its plane, angular velocities as magnitudes in rad/s."""
    return {
        "time": strike.time,
        "mode": strike.outcome.mode.name,
        "omega_before": abs(strike.before.omega),
        "omega_after": abs(strike.after.omega),
    }


def strikes_table(header: str, strikes: Iterable[tuple[str, RockingImpact]], sign: float, rounding: float) -> Table:
    """The first impacts of a motion: where they were, and the angular velocities times a sign.

    Those below a `rounding` are none.
    """
    columns = [
        Column("impact\n", lambda row: str(row[0])),
        Column("time\ns", lambda row: f"{row[1].time:.6f}"),
        Column(header, lambda row: row[2], left=True),
        Column("mode\n", lambda row: row[1].outcome.mode.name, left=True),
        Column("before\nrad/s", lambda row: f"{row[3]:.6g}"),
        Column("after\nrad/s", lambda row: f"{row[4]:.6g}"),
        Column("ratio\n", lambda row: f"{row[4] / row[3]:.4f}" if row[3] and row[4] else NONE),
        Column("energy\nlost, J", lambda row: f"{row[1].outcome.energy_lost:.3g}"),
    ]
    rows = []
    for number, (place, strike) in enumerate(islice(strikes, MOST_ROWS), 1):
        rates = [sign * rate for rate in (strike.before.omega, strike.after.omega)]
        rows.append((number, strike, place, *(rate if abs(rate) > rounding else 0.0 for rate in rates)))
    return table_of(columns, rows)


def _more(impacts: int) -> list[str]:
    more = impacts - MOST_ROWS
    return [f"{counted(more, 'more impact')}: read them with --json"] if more > 0 else []


def rocking_as_json(run: Trajectory) -> dict[str, Any]:
    """A motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `accumulation_time` is when impacts last accumulated so that both contacts stayed closed; null if they never did.
    """
    return {
        "impacts": [strike_as_json(strike) for strike in run.impacts],
        "accumulation_time": next((one.time for one in reversed(run.accumulations) if _closes_both(one)), None),
        "end": run.end.name,
    }


def _closes_both(passed: Accumulation) -> bool:
    """Whether impacts accumulated so that both contacts stayed closed; else it was one that had stopped bouncing."""
    return len(passed.contacts) == 2


def print_rocking(console: Console, rocking: Rocking) -> None:
    """Print the impacts of a motion and how it ended."""
    run = rocking.run
    say(console, f"{rocking.rocker.name}, {rocking.rocker.label}")
    if run.impacts:
        strikes = [("AB"[one.new], one) for one in run.impacts]
        show(console, strikes_table("at\n", strikes, 1.0, _REST))
    say(console, *rocking_sentences(run))


def rocking_sentences(run: Trajectory) -> list[str]:
    """What came after the impacts that are listed, and how the motion ended."""
    said = _more(len(run.impacts))
    both = [passed for passed in run.accumulations if _closes_both(passed)]
    if bounces := len(run.accumulations) - len(both):
        said.append(f"{bounces} times the bounces of one contact accumulate, and it stays closed")
    for passed in both:
        goes_on = "slides on" if passed.slides else "stays on"
        said.append(f"Impacts accumulate at {passed.time:.6f} s; then the body {goes_on} both contacts")
    said.append(f"At {run.time:.6f} s it {ENDS[run.end]}")
    return [f"{sentence}." for sentence in said]


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
        "impacts": [{**strike_as_json(strike), "old": old, "new": new} for old, new, strike in rolling.impacts],
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
    if rolling.impacts:
        strikes = [(f"{NONE if old is None else old} > {new}", strike) for old, new, strike in rolling.impacts]
        show(console, strikes_table("from, to\nspoke", strikes, -1.0, _REST))
    say(console, *rolling_sentences(rolling))


def rolling_sentences(rolling: Rolling) -> list[str]:
    """What came after the impacts that are listed, how the motion ended, and what steady rolling would be."""
    way = f"{counted(rolling.steps, 'step')} and {rolling.distance:.3f} m ahead"
    ended = f"At {rolling.time:.6f} s it {ROLL_ENDS[rolling.end]}, {way}"
    return [f"{said}." for said in (*_more(len(rolling.impacts)), ended, *_steadily(rolling))]


def _steadily(rolling: Rolling) -> list[str]:
    """What steady rolling down the slope would be, and what this wheel does instead where it cannot roll so."""
    wheel, down = rolling.wheel, downhill(rolling.wheel)
    rolls = steady(down)
    if rolls is None:
        return ["On this slope it does not keep rolling: each impact takes more than a step gives (closed form)"]
    struck, needed = impact_friction(wheel.hub, wheel.alpha), least_friction(down)
    if needed == inf:
        none = "no friction is enough, the ground would have to hold its spokes down (closed form)"
        return [f"Without slip it cannot roll steadily: {none}"]
    rates = (
        f"{rolls.before:.9f} rad/s before each impact, {rolls.after:.9f} after it, "
        f"a step in {rolls.time:.6f} s, {rolls.speed:.4f} m/s"
    )
    friction = (
        f"needs a friction coefficient of {struck:.6f} in the impacts, between them {needed:.6f}; "
        f"it has {wheel.hub.friction:g}"
    )
    if wheel.hub.friction >= needed:
        backwards = " backwards" if wheel.hub.slope < 0.0 else ""
        return [f"Steady rolling{backwards}, closed form: {rates}", f"It {friction}"]
    without = f"Without slip it would come to steady rolling, closed form: {rates}"
    return [without, f"This {friction}"]


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
        "impacts": [{"unit": one.unit.name, **_impact(impact)} for impact, one in impacts],
        "accumulation_time": max((one.sums[-1] for one in voyage.units if one.sums), default=None),
        "end": end.name,
        "deck": {"most_rolled": voyage.most_rolled, "most_lateral": voyage.most_lateral},
        "units": {one.unit.name: _unit(one) for one in voyage.units},
    }


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
    """Print what happened to each unit and to all."""
    say(
        console,
        f"{voyage.duration / 60.0:.4g} min on a deck that rolls up to {degrees(voyage.most_rolled):.1f} degrees and "
        f"pushes to the side with up to {voyage.most_lateral:.2f} of the weight.",
    )
    show(console, units_table(voyage))
    say(console, *voyage_sentences(voyage))


def units_table(voyage: Voyage) -> Table:
    """The units: what they did first, how often they struck, and where they are."""
    columns = [
        Column("unit", lambda one: one.unit.name, left=True),
        Column("first\nslide\ns", lambda one: _first(onset for onset in one.onsets if onset.slides)),
        Column("first\nlift\ns", lambda one: _first(onset for onset in one.onsets if onset.lifts)),
        Column("impacts", lambda one: str(len(one.impacts))),
        Column(f"above\n{RESOLVED:g}\nm/s", lambda one: str(len(_resolved(one.impacts)))),
        Column("fastest\nm/s", lambda one: fixed(max((hit.approach for hit in one.impacts), default=None), 2)),
        Column("turned\nup to\ndegrees", lambda one: f"{degrees(one.most_turned):.1f}"),
        Column("moved\nto port\nm", lambda one: f"{one.moved:+.2f}"),
        Column("at the\nend", lambda one: UNIT_ENDS.get(one.end, "lost"), left=True),
    ]
    return table_of(columns, voyage.units)


def _first(onsets: Iterable[TrueOnset]) -> str:
    return fixed(min((onset.stamp / NANOSECONDS for onset in onsets), default=None), 2)


def voyage_sentences(voyage: Voyage) -> list[str]:
    """What the table comes to."""
    impacts = [impact for one in voyage.units for impact in one.impacts]
    said = ["No contact ever struck."]
    if impacts:
        modes = Counter(impact.mode.name for impact in _resolved(impacts))
        counts = ": " + ", ".join(f"{count} {mode}" for mode, count in modes.most_common()) if modes else ""
        said = [
            f"{counted(len(impacts), 'impact')}, {60.0 * len(impacts) / voyage.duration:.3g} a minute.",
            f"{modes.total()} of them came with more than {RESOLVED:g} m/s{counts}.",
        ]
    toppled = [f"{one.unit.name} at {one.time:.1f} s" for one in voyage.units if one.end is End.OVERTURNED]
    if toppled:
        said.append(f"Toppled, and not recorded after that: {', '.join(toppled)}.")
    return said
