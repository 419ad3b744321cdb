"""`impact-predictor simulate deck`: cargo on a moving deck, as a table or a bag."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click
from click.core import ParameterSource

from .examples import examples
from .limits import Whole
from .simulated_files import check_pictures, draw_film, say_files

if TYPE_CHECKING:
    from ..mechanics.motion.support import MovingSupport
    from ..report.deck_pictures import DeckMotion
    from ..scenarios.deck.voyage import Voyage

F = TypeVar("F", bound=Callable[..., Any])

SCENE: Final = "config/deck_crate.yaml"
DURATION: Final = 3600.0
SEED: Final = 34
"""Of a sea that rocks the default crate from the beginning, and topples it not."""

EXAMPLES: Final = (
    "impact-predictor simulate deck --duration 600 --json",
    "impact-predictor simulate deck --params config/deck_many.yaml --hs 1.2 --seed 7 -o cargo.mcap",
    "impact-predictor simulate deck --rate 20 --noise-position 0.005 --noise-rate 0.01 -o noisy.mcap",
    "impact-predictor simulate deck --params config/deck_drum.yaml --spectrum pm --hs 2 --tp 6 --roll-period 5",
)

_SEA: Final = (
    ("--hs", 1.4, "Significant wave height, m."),
    ("--tp", 4.0, "Peak period of the waves, s."),
    ("--gamma", 3.3, "Peak enhancement of JONSWAP, 1 to 10."),
    ("--roll-period", 4.0, "Natural period of the vessel's roll, s."),
    ("--roll-damping", 0.3, "Damping of the roll, as part of the critical one."),
    ("--deck-height", 1.0, "Height of the deck above the axis of the roll, m."),
)
_RATES: Final = (
    ("--rate", 50.0, "Samples of each unit for each second."),
    ("--deck-rate", 100.0, "Samples of the deck for each second."),
)
_NOISE: Final = (
    ("--noise-position", "position, m"),
    ("--noise-orientation", "orientation, rad"),
    ("--noise-velocity", "velocity, m/s"),
    ("--noise-rate", "rate of turning, rad/s"),
    ("--noise-accelerometer", "accelerometers, m/s^2"),
    ("--noise-gyro", "gyroscopes, rad/s"),
)


def numbers(command: F) -> F:
    """The options that take one number each."""
    for name, what in reversed(_NOISE):
        command = click.option(name, type=float, default=0.0, help=f"Standard deviation of the {what}. [default: 0]")(
            command
        )
    for name, default, text in reversed((*_SEA, *_RATES)):
        command = click.option(name, type=float, default=default, show_default=True, help=text)(command)
    return command


@click.command("deck", short_help="Cargo on the deck of a vessel in a sea.", epilog=examples(*EXAMPLES))
@click.option("--params", metavar="FILE", help=f"Parameter file of the units. [default: {SCENE}]")
@click.option("--duration", type=float, help=f"Seconds to simulate. [default: {DURATION:g}, or the recorded deck's]")
@click.option("--seed", type=Whole(min=0), default=SEED, show_default=True, help="Makes the sea and the noise.")
@click.option(
    "--spectrum",
    type=click.Choice(["jonswap", "pm"]),
    default="jonswap",
    show_default=True,
    help="Of the waves: JONSWAP or Pierson and Moskowitz.",
)
@numbers
@click.option("--rao", metavar="CSV", help="Responses of the vessel, in the place of those by --roll-period.")
@click.option("--record", metavar="BAG", help="A recorded deck in the place of a sea: its roll, sway and heave.")
@click.option(
    "--record-topic", metavar="TOPIC", default="", help="Odometry of the recorded deck, where there are more."
)
@click.option(
    "--contacts",
    type=click.Choice(["rigid", "compliant"]),
    default="rigid",
    show_default=True,
    help="By impact laws, or stiff springs with dampers and friction: slow, and independent of every impact law.",
)
@click.option("--plot", metavar="FILE", help="Draw the deck, and the units that moved most, into a .png or .svg file.")
@click.option("--animate", metavar="FILE", help="Draw a moving picture of the liveliest seconds into a .gif file.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON, rates as magnitudes.")
@click.option(
    "-o",
    "--output",
    metavar="BAG",
    help="Write a bag for `replay`, with the truth: NAME.mcap is one file, any other name a rosbag2 folder.",
)
def simulate_deck(
    params: str | None,
    duration: float | None,
    seed: int,
    rate: float,
    deck_rate: float,
    record: str | None,
    contacts: str,
    plot: str | None,
    animate: str | None,
    as_json: bool,
    output: str | None,
    **options: Any,
) -> int:
    """Units of a parameter file on the deck of a vessel in beam seas.

    Each unit moves in the deck's y-z plane: it sticks, slides, rocks from edge to edge, or topples, which ends its
    record. Units do not touch each other. The same options and seed make the same bytes.
    """
    from ..parameters.file import read_values
    from ..prediction.scene import MovingDeck, scenes_of, shared_by
    from ..resources import find
    from ..scenarios.deck.voyage import gravity_of, sail, total
    from ..scenarios.record import Sensors
    from ..scenarios.sensors import SensorNoise
    from .progress import progress
    from .unfinished import unfinished_is_told

    check_options(recorded=record is not None)
    scenes = scenes_of(read_values(find(SCENE) if params is None else params))
    noise = SensorNoise(*[options.pop(name.removeprefix("--").replace("-", "_")) for name, _ in _NOISE])
    deck, longest = deck_of(record, seed, gravity_of(scenes), **options)
    duration = min(longest, DURATION) if duration is None else duration
    if duration > longest:
        raise click.UsageError(f"the recorded deck ends after {longest:g} s, but --duration is {duration:g}")
    timeout = (shared_by(scenes).deck or MovingDeck()).timeout
    if output is not None and 1.0 / timeout > deck_rate > 0.0:
        raise click.UsageError(
            f"--deck-rate {deck_rate:g} is too slow: after support.timeout, {timeout:g} s, a message tells nothing more"
        )
    sensors = Sensors(rate, deck_rate, noise, seed)
    motion = motion_for(plot, animate, duration)
    seen = {} if motion is None else {"seen": motion.taking}
    what = "simulated deck" if output is None else Path(output).name
    unit = "s" if output is None else "messages"
    work = total(scenes, duration, output is not None, sensors)
    with unfinished_is_told(output), progress(what, unit, work) as tell:
        voyage = sail(scenes, deck, duration, contacts, output, sensors, tell, **seen)
    if motion is not None:
        draw(deck, motion, plot, animate)
    say(voyage, as_json)
    if not as_json:
        say_files(output, plot, animate)
    return 1 if voyage.broke_off else 0


def check_options(*, recorded: bool) -> None:
    """Refuse options that would not change anything: those of a sea beside a recorded deck, or the reverse.

    Raises:
        UsageError: such an option was given.
    """
    context = click.get_current_context()
    sea = ("spectrum", "rao", *[name.removeprefix("--").replace("-", "_") for name, _, _ in _SEA])
    for name in sea if recorded else ("record_topic",):
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            option = "--" + name.replace("_", "-")
            why = "of a sea, but --record takes a recorded deck" if recorded else "of a recorded deck: give --record"
            raise click.UsageError(f"{option} is {why}")


def motion_for(plot: str | None, animate: str | None, duration: float) -> DeckMotion | None:
    """What takes up the motions for pictures, where some are asked for.

    Raises:
        InputError: they cannot be written.
    """
    if plot is None and animate is None:
        return None
    from ..report.deck_pictures import DeckMotion

    check_pictures(plot, animate)
    return DeckMotion(duration)


def draw(deck: MovingSupport, motion: DeckMotion, plot: str | None, animate: str | None) -> None:
    """Draw the pictures that are asked for."""
    if plot is not None:
        from ..report.deck_pictures import write_deck_figure

        write_deck_figure(plot, deck, motion.units)
    if animate is not None:
        from ..report.deck_pictures import deck_film

        draw_film(animate, deck_film(deck, motion.units))


def deck_of(
    record: str | None,
    seed: int,
    gravity: float,
    hs: float,
    tp: float,
    gamma: float,
    spectrum: str,
    roll_period: float,
    roll_damping: float,
    deck_height: float,
    rao: str | None,
    record_topic: str,
) -> tuple[MovingSupport, float]:
    """The deck of a vessel in a sea, or a recorded one, and how long it lasts in s."""
    if record is not None:
        from ..scenarios.deck.vessel import read_deck

        recorded = read_deck(record, record_topic, gravity)
        return recorded.support, recorded.duration
    from ..mechanics.bodies import positive
    from ..scenarios.deck.sea import SeaState, waves_of
    from ..scenarios.deck.vessel import PONTOON_ROLL, Vessel, deck_in, read_vessel

    positive(roll_period=roll_period, roll_damping=roll_damping)
    if rao is None:
        roll = PONTOON_ROLL._replace(frequency=2.0 * pi / roll_period, damping=roll_damping)
        vessel = Vessel(roll, height=deck_height)
    else:
        vessel = read_vessel(rao, deck_height)
    waves = waves_of(SeaState(hs, tp, spectrum, gamma), seed)
    return deck_in(waves, vessel, gravity), float("inf")


def say(voyage: Voyage, as_json: bool) -> None:
    """Print what happened."""
    if as_json:
        from ..report.deck import as_json as fields_of

        click.echo(json.dumps(fields_of(voyage), allow_nan=False))
        return
    from rich.console import Console

    from ..report.deck import print_voyage

    print_voyage(Console(), voyage)
