"""`impact-predictor simulate wheel`: a rimless wheel down a slope, as a table, a picture or a bag."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from ..mechanics.impact import LAWS
from .examples import examples
from .limits import Number, Whole
from .simulated_files import RATE, check_pictures, draw_film, rate_of_bag, say_files

if TYPE_CHECKING:
    from ..scenarios.wheel import Rolling

F = TypeVar("F", bound=Callable[..., Any])

STEPS: Final = 20
DURATION: Final = 60.0
STICKS: Final = 100.0
"""Friction against which no spoke slips; that of config/wheel.yaml, too."""

EXAMPLES: Final = (
    "impact-predictor simulate wheel --plot wheel.png --animate wheel.gif -o wheel.mcap",
    "impact-predictor simulate wheel --slope 4.583662361046586 --inertia 1e-12 --gravity 9.8 --steps 40 --json",
    "impact-predictor simulate wheel --slope 3 --omega 1.5 --animate stop.gif",
    "impact-predictor simulate wheel --friction 0.35 --plot slips.png",
)
"""The second one is the point mass on the slope of 0.08 rad; the fourth one has less friction than it needs."""

_ACUTE: Final = Number(-90.0, 90.0, min_open=True, max_open=True)
_NUMBERS: Final[tuple[tuple[str, Any, float, str], ...]] = (
    ("--slope", _ACUTE, 5.0, "Slope of the ground, degrees; positive is downhill ahead."),
    ("--alpha", float, 22.5, "Half the angle between two spokes, degrees: 180 divided by their number."),
    ("--leg", float, 1.0, "Length of the spokes, m."),
    ("--mass", float, 1.0, "Mass, kg."),
    ("--inertia", float, 0.1, "Inertia about the mass centre, kg m^2, above 0; a point mass has hardly any."),
    ("--omega", float, 0.0, "Rate at which it is let go over its first spoke, rad/s; positive rolls ahead."),
    ("--gravity", float, 9.81, "Gravity, m/s^2."),
)


def numbers(command: F) -> F:
    """The options that take one number each."""
    for name, kind, default, text in reversed(_NUMBERS):
        metavar = "DEGREES" if name in ("--slope", "--alpha") else None
        command = click.option(name, type=kind, default=default, metavar=metavar, show_default=True, help=text)(command)
    return command


@click.command("wheel", short_help="A rimless wheel down a slope.", epilog=examples(*EXAMPLES))
@numbers
@click.option("--friction", type=float, help="Coulomb friction coefficient (it sticks unless given).")
@click.option("--law", type=click.Choice(LAWS), default="path", show_default=True, help="Impact law.")
@click.option(
    "--steps",
    type=Whole(min=1),
    help=f"Steps to make, ahead or backwards. [default: {STEPS}, or those of --duration]",
)
@click.option("--duration", type=float, help=f"Longest time that is simulated, s. [default: {DURATION:g}]")
@click.option("--plot", metavar="FILE", help="Draw the wheel, its rate and its stance into a .png or .svg file.")
@click.option("--animate", metavar="FILE", help="Draw a moving picture into a .gif file.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON, rates as magnitudes.")
@click.option("--rate", type=float, help=f"Samples of the bag for each second. [default: {RATE:g}]")
@click.option(
    "-o",
    "--output",
    metavar="BAG",
    help="Write a bag for `replay`, with the true impacts: NAME.mcap is one file, any other name a rosbag2 folder.",
)
def simulate_wheel(
    slope: float,
    alpha: float,
    leg: float,
    mass: float,
    inertia: float,
    omega: float,
    gravity: float,
    friction: float | None,
    law: str,
    steps: int | None,
    duration: float | None,
    plot: str | None,
    animate: str | None,
    as_json: bool,
    rate: float | None,
    output: str | None,
) -> int:
    """A rimless wheel: spokes without a rim roll down a slope, one after the other, until they stop.

    It is let go with spoke 0 at right angles to the slope. Each spoke strikes without bouncing; where friction does not
    hold it, it slips. What is printed tells the steady rolling by its closed form, too.
    """
    from ..scenarios.wheel import Hub, RollEnd, Wheel, roll

    rate = rate_of_bag(rate, output)
    check_pictures(plot, animate)
    if steps is None and duration is None:
        steps = STEPS
    hub = Hub(mass, inertia, leg, STICKS if friction is None else friction, radians(slope), gravity)
    rolling = roll(Wheel(hub, radians(alpha)), omega, steps, DURATION if duration is None else duration, law)
    if output is not None:
        write_bag(output, rolling, rate)
    if plot is not None:
        from ..report.wheel_pictures import write_wheel_figure

        write_wheel_figure(plot, rolling)
    if animate is not None:
        from ..report.wheel_pictures import wheel_film

        draw_film(animate, wheel_film(rolling))
    say(rolling, as_json)
    if not as_json:
        say_files(output, plot, animate)
    return 1 if rolling.end is RollEnd.LOST else 0


def write_bag(output: str, rolling: Rolling, rate: float) -> None:
    """Write the motion into a bag."""
    from ..scenarios.record import wheel_actor, write_record
    from .progress import progress
    from .unfinished import unfinished_is_told

    actor = wheel_actor(rolling)
    with unfinished_is_told(output), progress(Path(output).name, total=actor.samples(rate)) as tell:
        write_record(output, [actor], rate, tell)


def say(rolling: Rolling, as_json: bool) -> None:
    """Print what happened."""
    from ..report.motions.wheel_words import as_json as fields_of
    from ..report.motions.wheel_words import print_rolling

    if as_json:
        click.echo(json.dumps(fields_of(rolling), allow_nan=False))
        return
    from rich.console import Console

    print_rolling(Console(), rolling)
