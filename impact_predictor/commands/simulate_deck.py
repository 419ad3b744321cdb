"""`impact-predictor simulate deck`: cargo on a moving deck, as a table or a bag."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import click

from .options import choice, examples, number, refuse_given, seed_option, text, together
from .progress import progress, writing
from .simulated import Products, as_json_option, bag_option

if TYPE_CHECKING:
    from ..scenarios.deck.motion import DeckMotion

SCENE: Final = "config/deck_crate.yaml"
DURATION: Final = 3600.0
SEED: Final = 49
"""Of a sea that rocks the default crate from the beginning, and topples it not."""

EXAMPLES: Final = (
    "impact-predictor simulate deck --duration 600 --json",
    "impact-predictor simulate deck --params config/deck_many.yaml --hs 1.2 --seed 7 -o cargo.mcap",
    "impact-predictor simulate deck --rate 20 --noise-position 0.005 --noise-rate 0.01 -o noisy.mcap",
    "impact-predictor simulate deck --heading 45 --length 60 --breadth 12 --draught 3 --hs 4 --tp 7 --restand 60",
    "impact-predictor simulate deck --params config/deck_drum.yaml --gamma 1 --hs 2 --tp 6 --roll-period 5",
)

_SEA: Final = (
    ("--hs", 1.2, "Significant wave height, m."),
    ("--tp", 4.0, "Peak period of the waves, s."),
    ("--gamma", 3.3, "Peak enhancement of JONSWAP, 1 (Pierson and Moskowitz) to 10."),
    ("--heading", 90.0, "Direction of the waves, degrees: 0 from astern, 90 from the side, 180 from ahead."),
    ("--spread", 0.0, "Standard deviation of their directions, degrees."),
    ("--length", 24.0, "Length of the vessel, m."),
    ("--breadth", 10.0, "Its breadth, m."),
    ("--draught", 1.2, "Its draught, m."),
    ("--roll-period", 4.0, "Natural period of its roll, s."),
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


def parameter_of(option: str) -> str:
    """The name that click gives to the value of an option."""
    return option.removeprefix("--").replace("-", "_")


_OF_SEA: Final = [parameter_of(name) for name, *_ in _SEA]


@click.command("deck", short_help="Cargo on the deck of a vessel in a sea.", epilog=examples(*EXAMPLES))
@text("--params", "FILE", f"Parameter file of the units. [default: {SCENE}]")
@number("--duration", f"Seconds to simulate. [default: {DURATION:g}, or the recorded deck's]")
@seed_option("Makes the sea and the noise.", SEED)
@together(*[number(name, says, default) for name, default, says in (*_SEA, *_RATES)])
@together(
    *[number(name, f"Standard deviation of the {what}. [default: 0]", 0.0, show_default=False) for name, what in _NOISE]
)
@text("--record", "BAG", "A recorded deck in the place of a sea; with rigid contacts its roll, sway and heave.")
@text("--record-topic", "TOPIC", "Odometry of the recorded deck, where there are more.", default="")
@choice(
    "--contacts",
    "By impact laws and across the vessel, or springs with dampers and friction, in every direction and independent of "
    "impact laws; auto: rigid in waves straight from the side and on a recorded deck.",
    "auto",
    "rigid",
    "compliant",
    default="auto",
)
@number("--restand", "Seconds after which a unit that toppled stands again where it stood. [default: never]")
@as_json_option
@bag_option("the truth")
def simulate_deck(
    params: str | None,
    duration: float | None,
    seed: int,
    rate: float,
    deck_rate: float,
    record: str | None,
    contacts: str,
    restand: float | None,
    as_json: bool,
    output: str | None,
    **options: Any,
) -> int:
    """Units of a parameter file on the deck of a vessel in a sea.

    Each unit sticks, slides, rocks or topples, which ends its record unless it stands again. Units do not touch each
    other. The same options and seed make the same bytes.
    """
    from ..prediction.scene import MovingDeck, read_scenes, shared_by
    from ..resources import find
    from ..scenarios.deck.voyage import gravity_of, sail
    from ..scenarios.record import Sensors
    from ..scenarios.sensors import SensorNoise

    if record is None:
        refuse_given(["record_topic"], "is of a recorded deck: give --record")
    else:
        refuse_given(_OF_SEA, "is of a sea, but --record takes a recorded deck")
    scenes = read_scenes(find(SCENE) if params is None else params)
    loose = [name for name, one in scenes.items() if one.radius or contacts == "rigid" if one.lashings or one.chocks]
    if loose:
        click.echo(f"note: without lashings and chocks move here: {', '.join(loose)}", err=True)
    if blown := [name for name, scene in scenes.items() if scene.wind]:
        click.echo(f"note: without wind move here: {', '.join(blown)}", err=True)
    noise = SensorNoise(*[options.pop(parameter_of(name)) for name, _ in _NOISE])
    deck, longest = deck_of(record, contacts, seed, gravity_of(scenes), **options)
    if contacts == "rigid" and deck.plane is None:
        raise click.UsageError("rigid units move across the vessel alone: give --heading 90, or --contacts compliant")
    duration = min(longest, DURATION) if duration is None else duration
    if duration > longest:
        raise click.UsageError(f"the recorded deck ends after {longest:g} s, but --duration is {duration:g}")
    timeout = (shared_by(scenes).deck or MovingDeck()).timeout
    if output is not None and 1.0 / timeout > deck_rate > 0.0:
        raise click.UsageError(
            f"--deck-rate {deck_rate:g} is too slow: after support.timeout, {timeout:g} s, a message tells nothing more"
        )
    sensors = Sensors(rate, deck_rate, noise, seed)
    products = Products(as_json=as_json, output=output)
    seconds = round(duration) if duration < float("inf") else None
    with progress("simulated deck", "s", seconds) if output is None else writing(output, seconds) as tell:
        voyage = sail(scenes, deck, duration, contacts, output, sensors, tell, restand)
    from ..report.simulation import print_voyage
    from ..scenarios.as_json import voyage_as_json

    products.say(lambda: voyage_as_json(voyage), lambda console: print_voyage(console, voyage))
    return 1 if voyage.broke_off else 0


def deck_of(record: str | None, contacts: str, seed: int, gravity: float, **sea: Any) -> tuple[DeckMotion, float]:
    """The deck of a vessel in a sea by its options, or a recorded one, and how long it lasts in s."""
    if record is not None:
        from ..scenarios.deck.motion import planar_deck
        from ..scenarios.deck.vessel import read_deck

        recorded = read_deck(record, sea["record_topic"], gravity)
        return recorded.motion if contacts == "compliant" else planar_deck(recorded.plane), recorded.duration
    from ..mechanics.bodies import positive
    from ..scenarios.deck.sea import SeaState, directions, waves_of
    from ..scenarios.deck.vessel import Vessel, deck_in

    box = {name: sea[name] for name in ("length", "breadth", "draught", "roll_period", "roll_damping")}
    positive(**box)
    vessel = Vessel(**box, height=sea["deck_height"])
    waves = waves_of(SeaState(sea["hs"], sea["tp"], sea["gamma"]), seed)
    return deck_in(waves, vessel, directions(waves, sea["heading"], sea["spread"], seed), gravity), float("inf")
