"""A rolling wheel as it is told: what each impact did, how it ended, and what the closed form says."""

from __future__ import annotations

from math import degrees, hypot, inf
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from ...scenarios.wheel import RollEnd, Rolling, Wheel
from ...scenarios.wheel_closed_forms import downhill, impact_friction, least_friction, steady
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

ROUNDING: Final = 1e-12
"""A rate (rad/s) this small is none."""


def as_json(rolling: Rolling) -> dict[str, Any]:
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
        before, after = (-rate if abs(rate) > ROUNDING else 0.0 for rate in (strike.before.omega, strike.after.omega))
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
    said.append(f"At {rolling.time:.6f} s it {ENDS[rolling.end]}, {_way(rolling)}")
    return [*said, *_steadily(rolling)]


def _way(rolling: Rolling) -> str:
    """How far a wheel has come, and where to."""
    steps, metres = rolling.steps, rolling.distance
    ways = [_ahead(rolling.wheel) if one >= 0 else _backwards(rolling.wheel) for one in (steps, metres)]
    made, come = f"{abs(steps)} step{'' if abs(steps) == 1 else 's'}", f"{abs(metres):.3f} m"
    if steps == 0 or ways[0] == ways[1]:
        return f"{made} and {come} {ways[1]}"
    return f"{made} {ways[0]} and {come} {ways[1]}"


def _ahead(wheel: Wheel) -> str:
    return "up the slope" if wheel.hub.slope < 0.0 else "down the slope"


def _backwards(wheel: Wheel) -> str:
    return f"backwards, {'down' if wheel.hub.slope < 0.0 else 'up'} the slope"


def _steadily(rolling: Rolling) -> list[str]:
    """What steady rolling down the slope would be, and what this wheel does instead where it cannot roll so."""
    wheel, down = rolling.wheel, downhill(rolling.wheel)
    rolls = steady(down)
    if rolls is None:
        return ["On this slope it does not keep rolling: each impact takes more than a step gives (closed form)"]
    struck, needed = impact_friction(wheel.hub, wheel.alpha), least_friction(down)
    if needed == inf:
        none = "no friction is enough, the ground would have to hold its spokes down (closed form)"
        return [*_really(rolling), f"Without slip it cannot roll steadily: {none}"]
    rates = (
        f"{rolls.before:.9f} rad/s before each impact, {rolls.after:.9f} after it, "
        f"a step in {rolls.time:.6f} s, {rolls.speed:.4f} m/s"
    )
    friction = (
        f"needs a friction coefficient of {struck:.6f} in the impacts, between them {needed:.6f}; "
        f"it has {wheel.hub.friction:g}"
    )
    if wheel.hub.friction >= needed:
        return [
            f"Steady rolling{' backwards' if wheel.hub.slope < 0.0 else ''}, closed form: {rates}",
            f"It {friction}",
        ]
    return [
        *_really(rolling),
        f"Without slip it would come to steady rolling, closed form: {rates}",
        f"This {friction}",
    ]


def _really(rolling: Rolling) -> list[str]:
    """What a wheel does that has less friction than steady rolling needs; nothing where its end has told it."""
    if rolling.end in (RollEnd.RESTS, RollEnd.BALANCED, RollEnd.TAKES_OFF):
        return []
    slips = any(state != "S" for stand in rolling.stands for _, state in stand.tips)
    state, said = rolling.world(rolling.time), "Its spokes slip: in" if slips else "In"
    if abs(state.omega) > ROUNDING and rolling.impacts:
        last = rolling.impacts[-1].strike
        before, after = abs(last.before.omega), abs(last.after.omega)
        return [f"{said} its last impact it slows down from {before:.9f} to {after:.9f} rad/s"]
    turns = "" if abs(state.omega) > ROUNDING else " and it does not turn"
    return [f"{said} the end its hub moves at {hypot(state.vx, state.vy):.4g} m/s{turns}"]


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
