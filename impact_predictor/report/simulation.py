"""What `simulate` prints: the impacts of bodies that rock and of a wheel, cargo on a deck, robots; how each ended."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import partial
from math import degrees
from statistics import median
from typing import Final

from rich.console import Console

from ..mechanics.motion import End, RockingImpact
from ..scenarios.as_json import rolling_as_json
from ..scenarios.deck.voyage import Followed, Voyage
from ..scenarios.robot.walk import Walk
from ..scenarios.rocking import Rocking
from ..scenarios.truth import TrueLanding, TrueOnset
from ..scenarios.wheel import Rolling
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, fixed, words
from .table import Column, more, say, show, table_of

MOST_IMPACTS: Final = 12
"""Impacts that are listed; the others of an accumulation say no more."""


def _print_impacts(console: Console, header: str, places: Sequence[str], strikes: Sequence[RockingImpact]) -> None:
    """Print the first impacts of a motion and where they were, angular velocities as magnitudes."""
    columns = [
        Column("time\ns", lambda k: f"{strikes[k].time:.6f}"),
        Column(header, lambda k: places[k], left=True),
        Column("mode\n", lambda k: strikes[k].outcome.mode.name, left=True),
        Column("before\nrad/s", lambda k: f"{abs(strikes[k].before.omega):.6f}"),
        Column("after\nrad/s", lambda k: f"{abs(strikes[k].after.omega):.6f}"),
        Column("ratio\n", lambda k: _ratio(strikes[k])),
        Column("energy\nlost, J", lambda k: f"{strikes[k].outcome.energy_lost + 0.0:.3g}"),
    ]
    if strikes:
        show(console, table_of(columns, range(min(len(strikes), MOST_IMPACTS))))
    say(console, *more(len(strikes) - MOST_IMPACTS, "impact", "read them with --json"))


def _ratio(strike: RockingImpact) -> str:
    return fixed(strike.after.omega / strike.before.omega if strike.before.omega else None, 4)


def print_rocking(console: Console, rocking: Rocking) -> None:
    """Print the impacts of a motion and how it ended."""
    run = rocking.run
    say(console, f"{rocking.rocker.name}, {rocking.rocker.label}")
    _print_impacts(console, "at\n", ["AB"[one.new] for one in run.impacts], run.impacts)
    for one in run.accumulations:
        if len(one.contacts) == 2:
            then = "slides" if one.slides else "stays"
            say(console, f"Impacts accumulate at {one.time:.6f} s; then the body {then} on both contacts.")
    say(console, f"The motion ends at {run.time:.6f} s: {words(run.end.name)}.")


def print_rolling(console: Console, rolling: Rolling) -> None:
    """Print the impacts of a wheel and how it ended."""
    wheel = rolling.wheel
    slope = f"{degrees(wheel.hub.slope):.4g} degrees"
    say(console, f"wheel, {wheel.spokes} spokes {wheel.hub.leg:g} m long, slope {slope}")
    places = [f"{NONE if old is None else old} > {new}" for old, new, _ in rolling.impacts]
    _print_impacts(console, "from, to\nspoke", places, [one.strike for one in rolling.impacts])
    say(console, *rolling_sentences(rolling))


def rolling_sentences(rolling: Rolling) -> list[str]:
    """How the motion ended, and what steady rolling down the slope would be."""
    answer = rolling_as_json(rolling)
    way = f"{counted(rolling.steps, 'step')} and {rolling.distance:.3f} m ahead"
    ended = f"The motion ends at {rolling.time:.6f} s: {words(rolling.end.name)}, {way}."
    if (known := answer["steady"]) is None:
        return [ended, "On this slope it cannot roll steadily without slip, with any friction (closed form)."]
    rates = f"{known['omega_before']:.9f} rad/s before each impact, {known['omega_after']:.9f} after it"
    steps = f"{known['step_time']:.6f} s a step, {known['speed']:.4f} m/s"
    friction = f"{answer['impact_friction']:.6f} in the impacts, between them {known['friction']:.6f}"
    return [
        ended,
        f"Steady rolling without slip, closed form: {rates}, {steps}.",
        f"It needs a friction coefficient of {friction}; the wheel has {rolling.wheel.hub.friction:g}.",
    ]


def _end(one: Followed) -> str:
    if one.toppled and one.end is End.TIME_UP:
        return f"toppled\n{counted(one.toppled, 'time')}"
    return "stands" if one.end is End.TIME_UP else f"{words(one.end.name)}\nat {one.time:.1f} s"


def _first(onsets: Iterable[TrueOnset]) -> str:
    return fixed(min((onset.stamp / NANOSECONDS for onset in onsets), default=None), 2)


def print_voyage(console: Console, voyage: Voyage) -> None:
    """Print what happened to each unit and to all: what they did first, how often they struck, and where they are."""
    angles = f"rolls up to {degrees(voyage.most_rolled):.1f} degrees"
    if voyage.most_pitched:
        angles += f", pitches up to {degrees(voyage.most_pitched):.1f}"
    say(
        console,
        f"{voyage.duration / 60.0:.4g} min on a deck that {angles} "
        f"and pushes along with up to {voyage.most_lateral:.2f} of the weight.",
    )
    columns = [
        Column("unit", lambda one: one.unit.name, left=True),
        Column("first\nslide\ns", lambda one: _first(onset for onset in one.onsets if onset.slides)),
        Column("first\nlift\ns", lambda one: _first(onset for onset in one.onsets if onset.lifts)),
        Column("impacts", lambda one: f"{len(one.impacts)}"),
        Column("fastest\nm/s", lambda one: fixed(max((hit.approach for hit in one.impacts), default=None), 2)),
        Column("turned\nup to\ndegrees", lambda one: f"{degrees(one.most_turned):.1f}"),
        Column("moved\nto port\nm", lambda one: f"{one.moved:+.2f}"),
        Column("at the\nend", _end, left=True),
    ]
    show(console, table_of(columns, voyage.units))
    impacts = [impact for one in voyage.units for impact in one.impacts]
    modes = Counter(impact.mode.name for impact in impacts).most_common()
    counts = ", ".join(f"{count:,} {mode}" for mode, count in modes) or "none"
    say(console, f"{counted(len(impacts), 'impact')}, {60.0 * len(impacts) / voyage.duration:.3g} a minute: {counts}.")
    if any(one.toppled for one in voyage.units):
        say(console, f"Cargo stands in {voyage.standing:.0%} of the time; --restand puts up again what has toppled.")


def print_walk(console: Console, walk: Walk, landings: Sequence[TrueLanding]) -> None:
    """Print how the feet of a robot landed: how often, how fast, and with what impulses, in the median."""
    machine = walk.machine
    stiffness, damping = machine.gains
    end = "it falls" if walk.fallen else "the walk ends"
    say(
        console,
        f"{machine.mass:.4g} kg on {len(machine.feet)} feet, {machine.height:.2f} m high, armature "
        f"{machine.armature:.3g} kg m^2, drives of {stiffness:.3g} N m/rad and {damping:.3g} N m s/rad: {end} after "
        f"{walk.duration:.4g} s and {walk.positions[-1, 0]:+.2f} m.",
    )
    impulses = [
        Column(f"impulse\n{when}\nN s", partial(_median_impulse, place=place))
        for place, when in enumerate(("1 ms", "2 ms", "5 ms", "peak"))
    ]
    columns = [
        Column("foot", lambda of: of[0].foot, left=True),
        Column("landings", lambda of: f"{len(of)}"),
        Column("speed\nm/s", lambda of: f"{median(one.speed for one in of):.2f}"),
        Column("fastest\nm/s", lambda of: f"{max(one.speed for one in of):.2f}"),
        *impulses,
    ]
    by_foot = [[one for one in landings if one.foot == foot] for foot in machine.feet]
    show(console, table_of(columns, [of for of in by_foot if of]))


def _median_impulse(landings: Sequence[TrueLanding], place: int) -> str:
    return f"{median(one.impulse(one.after[place]) for one in landings):.2f}"
