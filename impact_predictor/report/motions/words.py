"""A motion with impacts as it is shown: what each impact did, when they accumulated and how it ended."""

from __future__ import annotations

from math import hypot
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from ...mechanics.motion import Accumulation, End, PlanarState, Trajectory
from ...mechanics.types import TwoPointBody
from ...scenarios.rocking import Rocking
from ..table import plain_table, show

ENDS: Final = {
    End.RESTS: "rests on both contacts",
    End.BALANCED: "stands still on one contact, balanced",
    End.OVERTURNED: "has overturned",
    End.TIME_UP: "still moves: the time is up (--duration)",
    End.TOO_MANY_EVENTS: "has too many events to go on",
    End.NO_SOLUTION: "cannot go on: the impact law has no answer",
    End.INVALID_INPUT: "cannot be computed: a number is out of its range",
}
ROUNDING: Final = 1e-13
"""An angular velocity below this part of what the speeds come to is none."""
MOST_ROWS: Final = 12
"""Impacts that are listed; the others of an accumulation say no more."""


def as_json(run: Trajectory) -> dict[str, Any]:
    """A motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `accumulation_time` is when impacts last accumulated so that both contacts stayed closed; null if they never did.
    """
    return {
        "impacts": [
            {
                "time": strike.time,
                "mode": strike.outcome.mode.name,
                "omega_before": abs(strike.before.omega),
                "omega_after": abs(strike.after.omega),
            }
            for strike in run.impacts
        ],
        "accumulation_time": next((one.time for one in reversed(run.accumulations) if closes_both(one)), None),
        "end": run.end.name,
    }


def closes_both(passed: Accumulation) -> bool:
    """Whether impacts accumulated so that both contacts stayed closed; else it was one that had stopped bouncing."""
    return len(passed.contacts) == 2


def print_motion(console: Console, rocking: Rocking) -> None:
    """Print the impacts of a motion and how it ended."""
    run = rocking.run
    _say(console, f"{rocking.rocker.name}, {rocking.rocker.label}")
    if run.impacts:
        show(console, impact_table(run))
    for sentence in sentences(run):
        _say(console, sentence)


def impact_table(run: Trajectory) -> Table:
    """The first impacts of a motion."""
    table = plain_table()
    rounding = ROUNDING * max([_turning(strike.before, run.body) for strike in run.impacts])
    for header in ("impact\n", "time\ns"):
        table.add_column(header, justify="right", no_wrap=True)
    for header in ("at\n", "mode\n"):
        table.add_column(header, no_wrap=True)
    for header in ("before\nrad/s", "after\nrad/s", "ratio\n", "energy\nlost, J"):
        table.add_column(header, justify="right", no_wrap=True)
    for number, strike in enumerate(run.impacts[:MOST_ROWS], 1):
        rates = strike.before.omega, strike.after.omega
        before, after = (rate if abs(rate) > rounding else 0.0 for rate in rates)
        table.add_row(
            str(number),
            f"{strike.time:.6f}",
            "AB"[strike.new],
            strike.outcome.mode.name,
            f"{before:.4g}",
            f"{after:.4g}",
            f"{after / before:.4f}" if before and after else "-",
            f"{strike.outcome.energy_lost:.3g}",
        )
    return table


def _turning(state: PlanarState, body: TwoPointBody) -> float:
    """Angular velocity of a state, or of the size of its velocity."""
    return abs(state.omega) + hypot(state.vx, state.vy) / hypot(body.new.x, body.new.y)


def sentences(run: Trajectory) -> list[str]:
    """What came after the impacts that are listed, and how the motion ended."""
    said = []
    more = len(run.impacts) - MOST_ROWS
    if more > 0:
        said.append(f"{more} more impacts: read them with --json")
    both = [passed for passed in run.accumulations if closes_both(passed)]
    if bounces := len(run.accumulations) - len(both):
        said.append(f"{bounces} times the bounces of one contact accumulate, and it stays closed")
    for passed in both:
        goes_on = "slides on" if passed.slides else "stays on"
        said.append(f"Impacts accumulate at {passed.time:.6f} s; then the body {goes_on} both contacts")
    said.append(f"At {run.time:.6f} s it {ENDS[run.end]}")
    return [f"{sentence}." for sentence in said]


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
