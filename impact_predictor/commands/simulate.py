"""`impact-predictor simulate`: bodies that rock from contact to contact, as a table, a picture or a bag."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..mechanics.bodies import refuse
from ..mechanics.impact import LAWS
from .examples import examples
from .limits import Number
from .simulate_deck import EXAMPLES as DECK_EXAMPLES
from .simulate_deck import simulate_deck
from .simulate_wheel import EXAMPLES as WHEEL_EXAMPLES
from .simulate_wheel import simulate_wheel
from .simulated_files import RATE, check_pictures, draw_film, rate_of_bag, say_files

if TYPE_CHECKING:
    from ..scenarios.rocking import Rocker, Rocking

F = TypeVar("F", bound=Callable[..., Any])

ACUTE: dict[str, Any] = {"type": Number(-90.0, 90.0, min_open=True, max_open=True), "metavar": "DEGREES"}

EXAMPLES = {
    "rod": (
        "impact-predictor simulate rod --length 0.4 --a 0.1 --b 0.1 --angle 30 --json",
        "impact-predictor simulate rod --a 0.1 --a 0.075 --a 0.05 --plot rods.png --animate rods.gif",
        "impact-predictor simulate rod --a 0.05 -o rod.mcap",
    ),
    "plate": (
        "impact-predictor simulate plate --length 1 --height 1.6 --angle 10 --animate plate.gif",
        "impact-predictor simulate plate --friction 0.05 --plot plate.png",
        "impact-predictor simulate plate --height 0.4 --angle 20 --friction 0.3 --slope -15 --duration 3",
    ),
    "cylinder": (
        "impact-predictor simulate cylinder --radius 0.3 --gamma 40 --angle 15 --animate cylinder.gif",
        "impact-predictor simulate cylinder --gamma 50 --gamma-new 30 --friction 0.5 --plot cylinder.svg",
    ),
}
"""Of each body; the second ones of rod and plate make pictures of the documentation."""


def number(name: str, default: float | None, help_text: str, **more: Any) -> Callable[[F], F]:
    """An option that takes one number."""
    more = {"type": float, **more}
    return click.option(name, default=default, show_default=default is not None, help=help_text, **more)


def motion_options(angle: float) -> Callable[[F], F]:
    """The options that every body has: how it begins, by which laws it moves, and what is made of it."""
    options: tuple[Callable[[Any], Any], ...] = (
        number("--angle", angle, "Angle at which it is released at rest, degrees; negative stands on B.", **ACUTE),
        number("--mass", 1.0, "Mass, kg."),
        number("--inertia", None, "Inertia about the mass centre, kg m^2 (a homogeneous body's unless given)."),
        number("--friction", None, "Coulomb friction coefficient (it sticks unless given)."),
        number("--restitution", 0.0, "Restitution of a contact that strikes, 0 (plastic) to 1."),
        click.option("--law", type=click.Choice(LAWS), default="path", show_default=True, help="Impact law."),
        number("--slope", 0.0, "Slope of the support, degrees; positive is uphill from A to B.", **ACUTE),
        number("--gravity", 9.81, "Gravity, m/s^2."),
        number("--duration", 10.0, "Longest time that is simulated, s."),
        click.option("--plot", metavar="FILE", help="Draw angular velocity and angle into a .png or .svg file."),
        click.option("--animate", metavar="FILE", help="Draw a moving picture into a .gif file."),
        click.option(
            "--json",
            "as_json",
            is_flag=True,
            help="Print JSON, rates as magnitudes: an object, or a list for several rods.",
        ),
    )

    def decorate(command: F) -> F:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def bag_options(command: F) -> F:
    """The options of a body of which a bag can be written: points over a straight support."""
    command = click.option("--rate", type=float, help=f"Samples of the bag for each second. [default: {RATE:g}]")(
        command
    )
    return click.option(
        "-o",
        "--output",
        metavar="BAG",
        help="Write a bag for `replay`, with the true impacts: NAME.mcap is one file, any other name a rosbag2 folder.",
    )(command)


@click.group(
    short_help="Simulate bodies that rock, as a table, a picture or a bag.",
    no_args_is_help=False,
    epilog=examples(
        *(line for lines in EXAMPLES.values() for line in lines[:2]), *WHEEL_EXAMPLES[:1], *DECK_EXAMPLES[:1]
    ),
)
def simulate() -> None:
    """How a body moves from impact to impact: released at rest until it stays, down a slope, or on a moving deck.

    It rocks between two contacts, A behind and B ahead of its mass centre. The plane is x forward, y up, and
    counter-clockwise is positive. SI units; angles in degrees.
    """


simulate.add_command(simulate_deck)
simulate.add_command(simulate_wheel)


@simulate.command("rod", short_help="A rod over two supports.", epilog=examples(*EXAMPLES["rod"]))
@number("--length", 0.4, "Length, m.")
@number("--thickness", 0.0, "Thickness, m.")
@number("--a", None, "Support A behind the middle, m; may be repeated for several rods. [default: 0.1]", multiple=True)
@number("--b", None, "Support B ahead of the middle, m, once for each rod (as --a unless given).", multiple=True)
@motion_options(angle=30.0)
@bag_options
def simulate_rod(
    length: float,
    thickness: float,
    a: tuple[float, ...],
    b: tuple[float, ...],
    mass: float,
    friction: float | None,
    inertia: float | None,
    restitution: float,
    **options: Any,
) -> int:
    """A rod over two supports, the paper's Fig. 2; one for each --a."""
    from ..scenarios.rocking import rocking_rod

    behind = a or (0.1,)
    ahead = b or behind
    if len(ahead) != len(behind):
        raise click.UsageError(
            f"--a is given {len(behind)} times but --b {len(ahead)} times: give one of each for every rod"
        )
    return answer(
        [
            rocking_rod(length, thickness, one_a, one_b, mass, friction, inertia, restitution)
            for one_a, one_b in zip(behind, ahead, strict=True)
        ],
        **options,
    )


@simulate.command("plate", epilog=examples(*EXAMPLES["plate"]))
@number("--length", 1.0, "Length, m.")
@number("--height", 1.6, "Height, m.")
@number("--a", None, "Contact A behind the mass centre, m (half the length unless given).")
@number("--b", None, "Contact B ahead of the mass centre, m (half the length unless given).")
@motion_options(angle=10.0)
@bag_options
def simulate_plate(
    length: float,
    height: float,
    a: float | None,
    b: float | None,
    mass: float,
    friction: float | None,
    inertia: float | None,
    restitution: float,
    **options: Any,
) -> int:
    """A plate, crate or block on a flat floor."""
    from ..scenarios.rocking import rocking_plate

    return answer([rocking_plate(length, height, a, b, mass, friction, inertia, restitution)], **options)


@simulate.command("cylinder", epilog=examples(*EXAMPLES["cylinder"]))
@number("--radius", 0.3, "Radius, m.")
@number("--gamma", 40.0, "Central angle of the edge A behind the vertical, degrees.")
@number("--gamma-new", None, "Central angle of the edge B ahead of the vertical, degrees (--gamma unless given).")
@motion_options(angle=15.0)
def simulate_cylinder(
    radius: float,
    gamma: float,
    gamma_new: float | None,
    mass: float,
    friction: float | None,
    inertia: float | None,
    restitution: float,
    **options: Any,
) -> int:
    """A cylinder that rolls from edge to edge.

    The predictor knows straight supports only, so no bag is written of it.
    """
    from ..scenarios.rocking import rocking_cylinder

    ahead = gamma if gamma_new is None else gamma_new
    between = "angles in degrees with a sum between 0 and 180"
    refuse({"the angle between the edges": gamma + ahead}, lambda value: 0.0 < value < 180.0, between)
    return answer(
        [rocking_cylinder(radius, radians(gamma), radians(ahead), mass, friction, inertia, restitution)], **options
    )


def answer(
    rockers: Sequence[Rocker],
    angle: float,
    slope: float,
    gravity: float,
    law: str,
    duration: float,
    plot: str | None,
    animate: str | None,
    as_json: bool,
    output: str | None = None,
    rate: float | None = None,
) -> int:
    """Simulate the bodies, write what is asked for and say what happened; the exit status, 1 where it broke off."""
    rate = rate_of_bag(rate, output)
    check_pictures(plot, animate)
    from ..scenarios.rocking import release

    rockings = [release(rocker, radians(angle), radians(slope), gravity, law, duration) for rocker in rockers]
    if output is not None:
        write_bag(output, rockings, rate)
    if plot is not None:
        from ..report.rocking_pictures import write_rocking_figure

        write_rocking_figure(plot, rockings)
    if animate is not None:
        from ..report.rocking_pictures import rocking_film

        draw_film(animate, rocking_film(rockings))
    say(rockings, as_json)
    if not as_json:
        say_files(output, plot, animate)
    return 1 if any(rocking.broke_off for rocking in rockings) else 0


def write_bag(output: str, rockings: Sequence[Rocking], rate: float) -> None:
    """Write the motions into one bag."""
    from ..scenarios.record import rocking_actor, write_record
    from .progress import progress
    from .unfinished import unfinished_is_told

    actors = [
        rocking_actor(f"{rocking.rocker.name}_{k}" if len(rockings) > 1 else rocking.rocker.name, rocking.run)
        for k, rocking in enumerate(rockings, 1)
    ]
    samples = sum(actor.samples(rate) for actor in actors)
    with unfinished_is_told(output), progress(Path(output).name, total=samples) as tell:
        write_record(output, actors, rate, tell)


def say(rockings: Sequence[Rocking], as_json: bool) -> None:
    """Print what happened."""
    if as_json:
        from ..report.motions.words import as_json as fields_of

        answers = [fields_of(rocking.run) for rocking in rockings]
        click.echo(json.dumps(answers if len(answers) > 1 else answers[0], allow_nan=False))
        return
    from rich.console import Console

    from ..report.motions.words import print_motion

    for k, rocking in enumerate(rockings):
        if k:
            click.echo()
        print_motion(Console(), rocking)
