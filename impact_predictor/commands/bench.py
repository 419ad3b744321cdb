"""`impact-predictor bench`: the laws put to the test."""

from __future__ import annotations

import json
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import click

from ..errors import InputError
from ..files import write_text
from ..mechanics.impact import LAWS
from .options import choice, examples, json_flag, seed_option, text

if TYPE_CHECKING:
    from ..mechanics.invariants import Soak

BROKEN: Final = 1
"""Exit status where an invariant is violated by more than rounding explains."""

INTERRUPTED: Final = 130

SAVE_EVERY: Final = 10.0
"""Seconds between two notes of where a soak stands."""


def whole_number(context: click.Context, option: click.Parameter, count: float) -> int:
    """A number that may be written as 1e8, as a whole one."""
    if not (count >= 1.0 and count.is_integer()):
        raise click.BadParameter(f"{count:g} is not a whole number above 0, such as 1000000 or 1e6")
    return int(count)


@click.group(
    short_help="Put the laws to the test: invariants of random impacts.",
    no_args_is_help=False,
    epilog=examples("impact-predictor bench invariants --count 1e6"),
)
def bench() -> None:
    """Put the laws to the test."""


@bench.command(
    epilog=examples(
        "impact-predictor bench invariants",
        "impact-predictor bench invariants --count 1e9 --seed 7 --resume soak.json",
        "impact-predictor bench invariants --law path --json",
    )
)
@click.option(
    "--count", type=float, callback=whole_number, default=1e6, metavar="N", help="How many problems. [default: 1e6]"
)
@seed_option("Which random problems.")
@choice("--law", "Impact law to be checked.", *LAWS, "both", default="both")
@text("--resume", "FILE", "Where it stands, kept as it goes; it goes on from there if the file exists.")
@json_flag()
def invariants(count: int, seed: int, law: str, resume: str | None, as_json: bool) -> int:
    """Solve random impacts of every kind and tell the worst violation of each invariant.

    Impulses in their friction cones, momentum, no approach left, no work and no energy gained, and an answer that does
    not depend on units, a mirror or the last digits. Beside each violation stands the problem that made it, in Python,
    to be solved again. The exit status is 1 if one is more than rounding explains. Units, mirror and continuity are
    looked at in one problem of eight, because they solve it again; of slender bodies no continuity is claimed, and of
    sizes over twelve decades only that numbers are finite and units. Ctrl-C tells what was found so far.
    """
    from ..mechanics.invariants import Soak
    from .progress import compiling_is_said, progress

    soak = Soak(count, seed, LAWS if law == "both" else (law,))
    if resume is not None and Path(resume).exists():
        go_on(soak, resume)
    began, before, interrupted = perf_counter(), soak.done, False
    saved = began

    def tell(done: int) -> None:
        nonlocal saved
        bar(done)
        if resume is not None and (done == count or perf_counter() - saved > SAVE_EVERY):
            saved = perf_counter()
            write_text(Path(resume), json.dumps(soak.state()))

    with compiling_is_said(), progress("invariants", "problems", count) as bar:
        try:
            soak.run(tell)
        except KeyboardInterrupt:
            interrupted = True
    seconds = perf_counter() - began
    speed = (soak.done - before) / seconds
    if as_json:
        click.echo(json.dumps(fields_of(soak, seconds, speed, interrupted), indent=2))
    else:
        say(soak, seconds, speed, interrupted)
    if soak.broken:
        return BROKEN
    return INTERRUPTED if interrupted else 0


def go_on(soak: Soak, file: str) -> None:
    """Go on from where the file says; InputError where it does not say so."""
    try:
        soak.go_on(json.loads(Path(file).read_text(encoding="utf-8")))
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{file} cannot be gone on from: {error}; give another name") from error


def fields_of(soak: Soak, seconds: float, speed: float, interrupted: bool) -> dict[str, Any]:
    """What a soak found; null stands for a violation that is no number."""
    return {
        "problems": soak.done,
        "seed": soak.seed,
        "laws": soak.laws,
        "interrupted": interrupted,
        "seconds": seconds,
        "problems_per_second": speed,
        "invariants": [
            {
                "invariant": worst.invariant,
                "law": worst.law,
                "worst": worst.violation if isfinite(worst.violation) else None,
                "limit": worst.limit,
                "problems": worst.checked,
                "kind": worst.kind or None,
                "broken_by": worst.broken_by,
                "replay": worst.replay if worst.problem else None,
            }
            for worst in soak.worst.values()
        ],
    }


def say(soak: Soak, seconds: float, speed: float, interrupted: bool) -> None:
    """Print what a soak found."""
    from rich.console import Console

    from ..report.table import Column, say, show, table_of

    columns = [
        Column("law", lambda worst: worst.law, left=True),
        Column("invariant", lambda worst: worst.invariant, left=True),
        Column("problems", lambda worst: f"{worst.checked:,}"),
        Column("worst violation", lambda worst: f"{worst.violation:.2g}"),
        Column("limit", lambda worst: f"{worst.limit:.2g}"),
        Column("by a problem of kind", lambda worst: worst.kind, left=True),
    ]
    console, found = Console(), list(soak.worst.values())
    show(console, table_of(columns, found, lambda worst: "bold red" if worst.broken_by else ""))
    if made := [worst for worst in found if worst.problem]:
        say(console, "", "from impact_predictor import Contact, Twist, TwoPointBody")
        say(console, "from impact_predictor.mechanics.invariants import violations")
        say(console, *(f"{worst.replay}  # {worst.violation:.3g}" for worst in made))
    told = f"{soak.done:,} problems; {seconds:.0f} s, {speed:,.0f} a second"
    say(console, "", f"{'Interrupted: ' if interrupted else ''}{told}.")
    if soak.broken:
        say(console, "Violated by more than rounding explains, with the kinds of problems:")
        say(console, *(f"  {one.invariant}, {one.law} law: {', '.join(one.broken_by)}" for one in soak.broken))
