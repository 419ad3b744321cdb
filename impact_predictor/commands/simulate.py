"""`impact-predictor simulate`: bodies that rock or roll from contact to contact, as a table, a picture or a bag."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import radians
from typing import TYPE_CHECKING, Any, Final

import click

from .options import ACUTE, LAW, F, edge_options, edges_of, examples, json_flag, number, text, together
from .simulate_deck import EXAMPLES as DECK_EXAMPLES
from .simulate_deck import simulate_deck
from .simulate_robot import EXAMPLES as ROBOT_EXAMPLES
from .simulate_robot import simulate_robot
from .simulated import RATES_AS_MAGNITUDES, Products, as_json_option, record_options

if TYPE_CHECKING:
    from rich.console import Console

    from ..scenarios.rocking import Rocker

STEPS: Final = 20
STICKS: Final = 100.0
"""Friction against which no spoke slips; that of config/wheel.yaml, too."""

EXAMPLES = {
    "rod": (
        "impact-predictor simulate rod --length 0.4 --a 0.1 --b 0.1 --angle 30 --json",
        "impact-predictor simulate rod --a 0.1 --a 0.075 --a 0.05 --plot rods.png",
        "impact-predictor simulate rod --a 0.05 -o rod.mcap",
    ),
    "plate": (
        "impact-predictor simulate plate --length 1 --height 1.6 --angle 10 -o plate.mcap",
        "impact-predictor simulate plate --friction 0.05 --plot plate.png",
        "impact-predictor simulate plate --height 0.4 --angle 20 --friction 0.3 --slope -15 --duration 3",
    ),
    "cylinder": (
        "impact-predictor simulate cylinder --radius 0.3 --gamma 40 --angle 15 --plot cylinder.png",
        "impact-predictor simulate cylinder --gamma 50 --gamma-new 30 --friction 0.5 --plot cylinder.svg",
    ),
    "wheel": (
        "impact-predictor simulate wheel -o wheel.mcap",
        "impact-predictor simulate wheel --slope 4.583662361046586 --inertia 1e-12 --gravity 9.8 --steps 40 --json",
        "impact-predictor simulate wheel --slope 3 --omega 1.5",
        "impact-predictor simulate wheel --friction 0.35",
    ),
}
"""Of each body; the second one of the rod makes a picture of the documentation.

The second one of the wheel is the point mass on the slope of 0.08 rad; the fourth one has less friction than it needs.
"""


def motion_options(angle: float) -> Callable[[F], F]:
    """The options that every body has: how it begins, by which laws it moves, and what is made of it."""
    return together(
        number("--angle", "Angle at which it is released at rest, degrees; negative stands on B.", angle, **ACUTE),
        number("--mass", "Mass, kg.", 1.0),
        number("--inertia", "Inertia about the mass centre, kg m^2 (a homogeneous body's unless given)."),
        number("--friction", "Coulomb friction coefficient (it sticks unless given)."),
        number("--restitution", "Restitution of a contact that strikes, 0 (plastic) to 1.", 0.0),
        LAW,
        number("--slope", "Slope of the support, degrees; positive is uphill from A to B.", 0.0, **ACUTE),
        number("--gravity", "Gravity, m/s^2.", 9.81),
        number("--duration", "Longest time that is simulated, s.", 10.0),
        text("--plot", "FILE", "Draw angular velocity, angle and contacts into a .png or .svg file."),
        json_flag(f"{RATES_AS_MAGNITUDES}: an object, or a list for several rods."),
    )


@click.group(
    short_help="Simulate bodies that rock, as a table, a picture or a bag.",
    no_args_is_help=False,
    epilog=examples(*(lines[0] for lines in (*EXAMPLES.values(), DECK_EXAMPLES, ROBOT_EXAMPLES))),
)
def simulate() -> None:
    """How a body moves from impact to impact: released at rest until it stays, down a slope, or on a moving deck.

    It rocks between two contacts, A behind and B ahead of its mass centre. The plane is x forward, y up, and
    counter-clockwise is positive. SI units; angles in degrees.
    """


simulate.add_command(simulate_deck)
simulate.add_command(simulate_robot)


@simulate.command("rod", short_help="A rod over two supports.", epilog=examples(*EXAMPLES["rod"]))
@number("--length", "Length, m.", 0.4)
@number("--thickness", "Thickness, m.", 0.0)
@number("--a", "Support A behind the middle, m; may be repeated for several rods. [default: 0.1]", multiple=True)
@number("--b", "Support B ahead of the middle, m, once for each rod (as --a unless given).", multiple=True)
@motion_options(angle=30.0)
@record_options
def simulate_rod(length: float, thickness: float, a: tuple[float, ...], b: tuple[float, ...], **options: Any) -> int:
    """A rod over two supports, the paper's Fig. 2; one for each --a."""
    from ..scenarios.rocking import rocking_rod

    behind = a or (0.1,)
    ahead = b or behind
    if len(ahead) != len(behind):
        raise click.UsageError(
            f"--a is given {len(behind)} times but --b {len(ahead)} times: give one of each for every rod"
        )
    return answer([partial(rocking_rod, length, thickness, *ab) for ab in zip(behind, ahead, strict=True)], **options)


@simulate.command("plate", epilog=examples(*EXAMPLES["plate"]))
@number("--length", "Length, m.", 1.0)
@number("--height", "Height, m.", 1.6)
@number("--a", "Contact A behind the mass centre, m (half the length unless given).")
@number("--b", "Contact B ahead of the mass centre, m (half the length unless given).")
@motion_options(angle=10.0)
@record_options
def simulate_plate(length: float, height: float, a: float | None, b: float | None, **options: Any) -> int:
    """A plate, crate or block on a flat floor."""
    from ..scenarios.rocking import rocking_plate

    return answer([partial(rocking_plate, length, height, a, b)], **options)


@simulate.command("cylinder", epilog=examples(*EXAMPLES["cylinder"]))
@number("--radius", "Radius, m.", 0.3)
@edge_options(default=40.0)
@motion_options(angle=15.0)
def simulate_cylinder(radius: float, gamma: float, gamma_new: float | None, **options: Any) -> int:
    """A cylinder that rolls from edge to edge.

    The predictor knows straight supports only, so no bag is written of it.
    """
    from ..scenarios.rocking import rocking_cylinder

    return answer([partial(rocking_cylinder, radius, *edges_of(gamma, gamma_new))], **options)


def answer(
    bodies: Sequence[Callable[..., Rocker]],
    angle: float,
    slope: float,
    gravity: float,
    law: str,
    duration: float,
    **options: Any,
) -> int:
    """Simulate the bodies, write what is asked for and say what happened; the exit status, 1 where it broke off."""
    material = [options.pop(name) for name in ("mass", "friction", "inertia", "restitution")]
    products = Products(**options)
    products.check()
    from ..report.simulation import print_rocking
    from ..scenarios.as_json import rocking_as_json
    from ..scenarios.rocking import release

    rockings = [release(body(*material), radians(angle), radians(slope), gravity, law, duration) for body in bodies]
    if products.output is not None:
        from ..scenarios.record import rocking_actor

        names = [one.rocker.name for one in rockings]
        names = [f"{name}_{k}" for k, name in enumerate(names, 1)] if len(names) > 1 else names
        products.record([rocking_actor(name, one.run) for name, one in zip(names, rockings, strict=True)])
    if products.plot is not None:
        from ..report.rocking_figure import write_rocking_figure

        write_rocking_figure(products.plot, rockings)
    answers = [rocking_as_json(rocking.run) for rocking in rockings]

    def show(console: Console) -> None:
        for k, rocking in enumerate(rockings):
            if k:
                console.print()
            print_rocking(console, rocking)

    products.say(lambda: answers if len(answers) > 1 else answers[0], show)
    return 1 if any(rocking.broke_off for rocking in rockings) else 0


@simulate.command("wheel", short_help="A rimless wheel down a slope.", epilog=examples(*EXAMPLES["wheel"]))
@number("--slope", "Slope of the ground, degrees; positive is downhill ahead.", 5.0, **ACUTE)
@number("--alpha", "Half the angle between two spokes, degrees: 180 divided by their number.", 22.5, metavar="DEGREES")
@number("--leg", "Length of the spokes, m.", 1.0)
@number("--mass", "Mass, kg.", 1.0)
@number("--inertia", "Inertia about the mass centre, kg m^2, above 0; a point mass has hardly any.", 0.1)
@number("--omega", "Rate at which it is let go over its first spoke, rad/s; positive rolls ahead.", 0.0)
@number("--gravity", "Gravity, m/s^2.", 9.81)
@number("--friction", "Coulomb friction coefficient (it sticks unless given).")
@LAW
@number(
    "--steps",
    f"Steps to make, ahead or backwards. [default: {STEPS}, or those of --duration]",
    type=click.IntRange(min=1),
)
@number("--duration", "Longest time that is simulated, s. [default: 60]")
@as_json_option
@record_options
def simulate_wheel(
    omega: float, alpha: float, law: str, steps: int | None, duration: float | None, slope: float, **options: Any
) -> int:
    """A rimless wheel: spokes without a rim roll down a slope, one after the other, until they stop.

    It is let go with spoke 0 at right angles to the slope. Each spoke strikes without bouncing; where friction does not
    hold it, it slips. What is printed tells the steady rolling by its closed form, too.
    """
    from ..report.simulation import print_rolling
    from ..scenarios.as_json import rolling_as_json
    from ..scenarios.wheel import Hub, RollEnd, Wheel, roll

    hub = Hub(slope=radians(slope), **{name: options.pop(name) for name in ("mass", "inertia", "leg", "gravity")})
    friction = options.pop("friction")
    hub = hub._replace(friction=STICKS if friction is None else friction)
    products = Products(**options)
    products.check()
    if steps is None and duration is None:
        steps = STEPS
    rolling = roll(Wheel(hub, radians(alpha)), omega, steps, 60.0 if duration is None else duration, law)
    if products.output is not None:
        from ..scenarios.record import wheel_actor

        products.record([wheel_actor(rolling)])
    products.say(partial(rolling_as_json, rolling), lambda console: print_rolling(console, rolling))
    return 1 if rolling.end is RollEnd.LOST else 0
