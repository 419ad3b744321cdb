"""`impact-predictor bench`: the laws put to the test."""

from __future__ import annotations

import json
from math import isfinite
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import click

from ..mechanics.impact import LAWS
from ..wording import NONE
from .options import choice, examples, json_flag, seed_option

if TYPE_CHECKING:
    from ..mechanics.invariants import Soak

BROKEN: Final = 1
"""Exit status where an invariant is violated by more than rounding explains."""

INTERRUPTED: Final = 130


def whole(context: click.Context, option: click.Parameter, count: float) -> int:
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
        "impact-predictor bench invariants --count 1e8 --seed 7",
        "impact-predictor bench invariants --law path --json",
    )
)
@click.option(
    "--count", type=float, callback=whole, default=1e6, show_default="1e6", metavar="N", help="Problems to solve."
)
@seed_option("Which random problems.")
@choice("--law", "Impact law to be checked.", *LAWS, "both", default="both")
@json_flag()
def invariants(count: int, seed: int, law: str, as_json: bool) -> int:
    """Solve random impacts of every kind and tell the worst violation of each invariant.

    Impulses in their friction cones, momentum, no approach left, no work and no energy gained, and an answer that does
    not depend on units, a mirror or the last digits. Beside each violation stands the problem that made it, in Python,
    to be solved again. The exit status is 1 if one is more than rounding explains. Stiff problems (slender bodies,
    close contacts, sizes over twelve decades) multiply rounding, so that most of theirs have no limit. Ctrl-C tells
    what was found so far.
    """
    from ..mechanics.invariants import Soak
    from .progress import compiling_is_said, progress

    soak = Soak(count, seed, LAWS if law == "both" else (law,))
    began, interrupted = perf_counter(), False
    with compiling_is_said(), progress("invariants", "problems", count) as tell:
        try:
            soak.run(tell)
        except KeyboardInterrupt:
            interrupted = True
    seconds = perf_counter() - began
    if as_json:
        click.echo(json.dumps(fields_of(soak, seconds, interrupted), indent=2))
    else:
        say(soak, seconds, interrupted)
    if soak.broken:
        return BROKEN
    return INTERRUPTED if interrupted else 0


def fields_of(soak: Soak, seconds: float, interrupted: bool) -> dict[str, Any]:
    """What a soak found; null stands for a violation that is no number, and for no limit."""
    return {
        "problems": soak.done,
        "seed": soak.seed,
        "laws": soak.laws,
        "interrupted": interrupted,
        "seconds": seconds,
        "problems_per_second": soak.done / seconds,
        "invariants": [
            {
                "invariant": worst.invariant,
                "law": worst.law,
                "worst": worst.violation if isfinite(worst.violation) else None,
                "stiff": worst.stiff,
                "limit": worst.limit if isfinite(worst.limit) else None,
                "kind": worst.kind or None,
                "broken_by": worst.broken_by,
                "replay": worst.replay if worst.body else None,
            }
            for worst in soak.worst.values()
        ],
    }


def say(soak: Soak, seconds: float, interrupted: bool) -> None:
    """Print what a soak found."""
    from rich.console import Console

    from ..report.table import Column, say, show, table_of

    columns = [
        Column("law", lambda worst: worst.law, left=True),
        Column("problems", lambda worst: "stiff" if worst.stiff else "ordinary", left=True),
        Column("invariant", lambda worst: worst.invariant, left=True),
        Column("worst violation", lambda worst: f"{worst.violation:.2g}"),
        Column("limit", lambda worst: f"{worst.limit:.2g}" if isfinite(worst.limit) else NONE),
        Column("by a problem of kind", lambda worst: worst.kind, left=True),
    ]
    console, found = Console(), list(soak.worst.values())
    show(console, table_of(columns, found, lambda worst: "bold red" if worst.broken_by else ""))
    if any(worst.stiff and worst.violation > 0.0 for worst in found):
        say(console, "", "A stiff problem multiplies rounding by its condition number, without limit: - is no failure.")
    if made := [worst for worst in found if worst.body is not None]:
        say(console, "", "from impact_predictor import Contact, Twist, TwoPointBody")
        say(console, "from impact_predictor.mechanics.invariants import violations")
        say(console, *(f"{worst.replay}  # {worst.violation:.3g}" for worst in made))
    speed = f"{soak.done:,} problems in {seconds:.0f} s, {soak.done / seconds:,.0f} a second"
    say(console, "", f"{'Interrupted: ' if interrupted else ''}{speed}.")
    if soak.broken:
        say(console, "Violated by more than rounding explains, with the kinds of problems:")
        say(console, *(f"  {one.invariant}, {one.law} law: {', '.join(one.broken_by)}" for one in soak.broken))
