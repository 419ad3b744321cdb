"""A rolling wheel as it is told: what each impact did, how it ended, and what the closed form says."""

from __future__ import annotations

from math import degrees, inf
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from ...scenarios.walking.closed_forms import impact_friction, least_friction, steady
from ...scenarios.walking.wheel import RollEnd, Rolling
from ..table import plain_table, show
from .words import MOST_ROWS

ENDS: Final = {
    RollEnd.STEPS_DONE: "is over its last spoke (--steps)",
    RollEnd.RESTS: "rests on two spokes",
    RollEnd.BALANCED: "stands still on one spoke, balanced",
    RollEnd.TIME_UP: "still moves: the time is up (--duration)",
    RollEnd.TAKES_OFF: "leaves the ground: it turns too fast to roll",
    RollEnd.LOST: "cannot go on: the impact law has no answer, or there are too many events",
}


def as_json(rolling: Rolling) -> dict[str, Any]:
    """A rolling motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `steady` is the closed form without slip, with the least friction coefficient for it (null where some part of a step
    needs more than any); null where the wheel stops.
    """
    wheel = rolling.wheel
    rolls = steady(wheel)
    known = None
    if rolls is not None:
        needed = least_friction(wheel)
        known = {
            "omega_before": rolls.before,
            "omega_after": rolls.after,
            "step_time": rolls.time,
            "speed": rolls.speed,
            "friction": needed if needed < inf else None,
        }
    return {
        "impacts": [
            {
                "time": strike.time,
                "mode": strike.outcome.mode.name,
                "old": old,
                "new": new,
                "omega_before": abs(strike.before.omega),
                "omega_after": abs(strike.after.omega),
            }
            for old, new, strike in rolling.impacts
        ],
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
    _say(console, f"wheel, {wheel.spokes} spokes {wheel.hub.leg:g} m long, slope {slope}")
    if rolling.impacts:
        show(console, impact_table(rolling))
    for sentence in sentences(rolling):
        _say(console, f"{sentence}.")


def impact_table(rolling: Rolling) -> Table:
    """The first impacts of a wheel."""
    table = plain_table()
    for header in ("impact\n", "time\ns"):
        table.add_column(header, justify="right", no_wrap=True)
    for header in ("from, to\nspoke", "mode\n"):
        table.add_column(header, no_wrap=True)
    for header in ("before\nrad/s", "after\nrad/s", "ratio\n", "energy\nlost, J"):
        table.add_column(header, justify="right", no_wrap=True)
    for number, (old, new, strike) in enumerate(rolling.impacts[:MOST_ROWS], 1):
        before, after = (-rate if abs(rate) > 1e-12 else 0.0 for rate in (strike.before.omega, strike.after.omega))
        table.add_row(
            str(number),
            f"{strike.time:.6f}",
            f"{'-' if old is None else old} > {new}",
            strike.outcome.mode.name,
            f"{before:.6g}",
            f"{after:.6g}",
            f"{after / before:.4f}" if before and after else "-",
            f"{strike.outcome.energy_lost:.3g}",
        )
    return table


def sentences(rolling: Rolling) -> list[str]:
    """What came after the impacts that are listed, how the motion ended, and what steady rolling would be."""
    said = []
    more = len(rolling.impacts) - MOST_ROWS
    if more > 0:
        said.append(f"{more} more impacts: read them with --json")
    steps, metres = rolling.steps, rolling.distance
    farther = f"{steps} step{'' if abs(steps) == 1 else 's'} and {metres:.3f} m down the slope"
    said.append(f"At {rolling.time:.6f} s it {ENDS[rolling.end]}, {farther}")
    wheel = rolling.wheel
    rolls = steady(wheel)
    if rolls is None:
        said.append("On this slope it does not keep rolling: each impact takes more than a step gives (closed form)")
        return said
    said.append(
        f"Steady rolling, closed form: {rolls.before:.9f} rad/s before each impact, {rolls.after:.9f} after it, "
        f"a step in {rolls.time:.6f} s, {rolls.speed:.4f} m/s"
    )
    needed, struck = least_friction(wheel), impact_friction(wheel.hub, wheel.alpha)
    between = f"{needed:.6f}" if needed < inf else "none is enough: the ground would have to pull"
    said.append(
        f"It needs a friction coefficient of {struck:.6f} in the impacts, between them {between}; "
        f"it has {wheel.hub.friction:g}"
    )
    return said


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
