"""`impact-predictor solve`: what a single impact does to a body."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import hypot, isfinite
from typing import Any, Final

import click

from ..errors import InputError
from ..mechanics.bodies import cylinder, fraction, not_negative, plate, positive, rod
from ..mechanics.impact import LAWS, approach, solve_impact
from ..mechanics.types import Contact, Flag, Mode, Outcome, Twist, TwoPointBody
from .options import F, choice, edge_options, edges_of, examples, json_flag, number, together

EXAMPLES: Final = {
    "plate": (
        "impact-predictor solve plate --length 1 --height 0.4 --mass 10 --friction 0.2 --omega -1",
        "impact-predictor solve plate --length 1 --height 1.6 --mass 10 --friction 0.2 --restitution 0.3 --omega -1",
        "impact-predictor solve plate --length 1 --height 0.4 --mass 10 --friction 0.2 --twist 0.3 -0.5 -1 --law both",
    ),
    "rod": (
        "impact-predictor solve rod --length 0.4 --a 0.1 --b 0.1 --mass 0.3 --friction 0.4 --omega -2 --json",
        "impact-predictor solve rod --length 0.4 --thickness 0.01 --a 0.13 --b 0.1 --mass 1 --friction 0.4 --omega -2",
    ),
    "cylinder": (
        "impact-predictor solve cylinder --radius 0.3 --gamma 50 --mass 2 --friction 0.5 --omega -1 --law both",
        "impact-predictor solve cylinder --radius 0.3 --gamma 70 --mass 2 --friction 0.9 --omega -1",
    ),
    "body": (
        "impact-predictor solve body --mass 10 --inertia 1 --old -0.5 -0.2 0.3 --new 0.5 -0.2 0.3 --omega -1",
        "impact-predictor solve body --mass 1 --inertia 0.1 --no-old --new 0.2 -0.5 0.3 --twist 1 -2 0 --json",
    ),
}

impact_options = together(
    number("--restitution", "Restitution at the new contact, 0 (plastic) to 1.", 0.0),
    number("--omega", "Angular velocity about the old contact at rest, rad/s; clockwise is negative."),
    click.option(
        "--twist",
        type=(float, float, float),
        callback=lambda context, option, parts: None if parts is None else Twist(*parts),
        metavar="VX VY OMEGA",
        help="Velocity of the mass centre (m/s) and angular velocity (rad/s), in the place of --omega.",
    ),
    choice("--law", "Impact law.", *LAWS, "both", default="path"),
    json_flag("Print JSON: an object, or a list of two for both laws."),
)
"""The options that every body has: how it moves, by which law it is solved, how the answer looks."""


@click.group(
    short_help="Solve a single impact of one body.",
    no_args_is_help=False,
    epilog=examples(*(lines[0] for lines in EXAMPLES.values())),
)
def solve() -> None:
    """What an impact at the new contact does to a body that turns about the old one.

    The plane is x forward, y up; counter-clockwise is positive, so a body that falls forwards onto its new contact
    turns with a negative omega. SI units; angles in degrees.
    """


matter_options = together(
    number("--mass", "Mass, kg.", required=True),
    number("--friction", "Coulomb friction coefficient.", required=True),
    number("--inertia", "Inertia about the mass centre, kg m^2 (a homogeneous body's unless given)."),
)


@solve.command("plate", epilog=examples(*EXAMPLES["plate"]))
@number("--length", "Length, m.", required=True)
@number("--height", "Height, m.", required=True)
@matter_options
@number("--a", "Distance of the old contact behind the mass centre, m (half the length unless given).")
@number("--b", "Distance of the new contact ahead of the mass centre, m (half the length unless given).")
@impact_options
def solve_plate(omega: float | None, twist: Twist | None, law: str, as_json: bool, **shape: Any) -> int:
    """A plate, crate or block on a flat floor."""
    return answer(plate(**shape), omega, twist, law, as_json)


@solve.command("rod", epilog=examples(*EXAMPLES["rod"]))
@number("--length", "Length, m.", required=True)
@number("--thickness", "Thickness, m.", 0.0)
@number("--a", "Distance of the old support behind the middle, m.", required=True)
@number("--b", "Distance of the new support ahead of the middle, m.", required=True)
@matter_options
@impact_options
def solve_rod(omega: float | None, twist: Twist | None, law: str, as_json: bool, **shape: Any) -> int:
    """A rod over two supports."""
    return answer(rod(**shape), omega, twist, law, as_json)


@solve.command("cylinder", epilog=examples(*EXAMPLES["cylinder"]))
@number("--radius", "Radius, m.", required=True)
@edge_options(default=None)
@matter_options
@impact_options
def solve_cylinder(omega: float | None, twist: Twist | None, law: str, as_json: bool, **shape: Any) -> int:
    """A cylinder that rolls from one edge onto another."""
    gamma, ahead = edges_of(shape.pop("gamma"), shape.pop("gamma_new"))
    return answer(cylinder(gamma=gamma, gamma_new=ahead, **shape), omega, twist, law, as_json)


PLACE: dict[str, Any] = {"type": (float, float, float), "metavar": "X Y FRICTION"}


def side(name: str, help_text: str, x: float, y: float) -> Callable[[F], F]:
    """An option that takes a vector."""
    says = f"{help_text} [default: {x:g} {y:g}]"
    return click.option(name, type=(float, float), metavar="X Y", default=(x, y), help=says)


@solve.command(
    "body", short_help="Any body with two contacts, or with one that strikes.", epilog=examples(*EXAMPLES["body"])
)
@number("--mass", "Mass, kg.", required=True)
@number("--inertia", "Inertia about the mass centre, kg m^2.", required=True)
@click.option("--old", **PLACE, help="Old contact, seen from the mass centre, m.")
@click.option("--no-old", is_flag=True, help="No old contact: a one-point impact, with --twist.")
@click.option("--new", **PLACE, required=True, help="New contact, seen from the mass centre, m.")
@side("--old-normal", "Direction out of the support, of any length.", 0.0, 1.0)
@side("--new-normal", "Direction out of the support, of any length.", 0.0, 1.0)
@side("--old-velocity", "Velocity of the support, m/s.", 0.0, 0.0)
@side("--new-velocity", "Velocity of the support, m/s.", 0.0, 0.0)
@impact_options
def solve_body(
    mass: float,
    inertia: float,
    old: tuple[float, float, float] | None,
    no_old: bool,
    new: tuple[float, float, float],
    restitution: float,
    omega: float | None,
    twist: Twist | None,
    law: str,
    as_json: bool,
    **sides: tuple[float, float],
) -> int:
    """Any body with two contacts, or with one that strikes, on supports of any direction that may move."""
    if (old is None) is not no_old:
        raise click.UsageError("Give either --old X Y FRICTION or --no-old")
    positive(mass=mass, inertia=inertia)
    fraction(restitution=restitution)
    struck = contact("new", new, sides)._replace(restitution=restitution)
    standing = None if old is None else contact("old", old, sides)
    return answer(TwoPointBody(mass, inertia, standing, struck), omega, twist, law, as_json)


def contact(which: str, place: tuple[float, float, float], sides: dict[str, tuple[float, float]]) -> Contact:
    """A contact of checked numbers, with its normal and velocity of both sides; a normal has any length but zero."""
    normal, velocity = sides[f"{which}_normal"], sides[f"{which}_velocity"]
    x, y, friction = place
    length = hypot(*normal)
    if not (length > 0.0 and isfinite(length)):
        raise InputError(
            f"--{which}-normal is {normal[0]:g} {normal[1]:g}, which has no direction; give for example 0 1"
        )
    not_negative(friction=friction)
    return Contact(x, y, friction, (normal[0] / length, normal[1] / length), velocity=velocity)


def answer(body: TwoPointBody, omega: float | None, twist: Twist | None, law: str, as_json: bool) -> int:
    """Solve the impact of a twist, or of turning about the old contact, and print the answer; the exit status."""
    if (omega is None) is (twist is None):
        raise click.UsageError("Give either --omega OMEGA or --twist VX VY OMEGA")
    if twist is None and body.old is None:
        raise click.UsageError("A body without an old contact turns about nothing: give --twist VX VY OMEGA")
    before = body.turning(omega or 0.0) if twist is None else twist
    outcomes = [solve_impact(body, before, one) for one in (LAWS if law == "both" else [law])]
    flags = Flag.NONE
    for outcome in outcomes:
        flags |= outcome.flags
    if flags & Flag.INVALID_INPUT:
        raise InputError("a number of the body or of its motion is infinite or not a number; give finite numbers")
    if as_json:
        answers = [fields_of(outcome, before) for outcome in outcomes]
        click.echo(json.dumps(answers if len(answers) > 1 else answers[0], indent=2, allow_nan=False))
    else:
        from rich.console import Console

        from ..report.outcome import print_outcomes

        print_outcomes(Console(), body, before, outcomes)
    if outcomes[0].mode is Mode.NO_IMPACT and not flags & Flag.NO_SOLUTION:
        rate = approach(body.new, before)[0]
        hint = f"the new contact is not approached: its normal velocity, {rate:.4g} m/s, is not negative"
        if omega and approach(body.new, body.turning(-omega))[0] < 0.0:
            sense = "clockwise, negative" if omega > 0.0 else "counter-clockwise, positive"
            hint += f"; towards it the body turns {sense}: --omega {-omega:g}"
        click.echo(f"hint: {hint}", err=True)
    return 1 if flags & Flag.NO_SOLUTION else 0


def fields_of(outcome: Outcome, before: Twist) -> dict[str, Any]:
    """An outcome with the names of its fields, in SI units: twists as [vx, vy, omega], impulses as [N, T] each."""
    return {
        "law": outcome.law,
        "mode": outcome.mode.name,
        "before": before,
        "twist": outcome.twist,
        "impulses": outcome.impulses,
        "segments": outcome.segments,
        "flags": [flag.name for flag in Flag if flag & outcome.flags],
        "energy_lost": outcome.energy_lost,
        "unique": outcome.unique,
        "alternatives": [
            {"mode": one.mode.name, "twist": one.twist, "segments": one.segments} for one in outcome.alternatives
        ],
        "margins": {
            name: None if mode is None else {"change": change, "mode": mode.name}
            for name, (change, mode) in outcome.margins._asdict().items()
        },
    }
