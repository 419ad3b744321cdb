"""An hour of heavy sea, predicted: what is found, how right it is, and whether warnings came in time.

    python benchmarks/heavy_sea.py [SECONDS]

Units of test/heavy_sea.yaml on a simulated deck, with sensor noise and without, and the crate of config/deck_crate.yaml
by impact laws and by stiff contacts that know none. Takes about ten minutes for an hour.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from impact_predictor.bags.replay import Result, replay
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.report.table import plain_table, show
from impact_predictor.scenarios.deck.sea import SeaState, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in
from impact_predictor.scenarios.deck.voyage import sail
from impact_predictor.scenarios.record import Sensors
from impact_predictor.scenarios.sensors import NO_NOISE, SensorNoise

ROOT: Final = Path(__file__).parents[1]
CRATE: Final = ROOT / "config" / "deck_crate.yaml"
TRACKER: Final = SensorNoise(position=0.0005, orientation=0.0002, velocity=0.002, rate=0.001)
FAIR: Final = SensorNoise(position=0.002, orientation=0.001, velocity=0.01, rate=0.005)
COLUMNS: Final = ("shown", "missed", "false", "modes\nright %", "velocity\nerror %", "time\nerror ms", "warned")


class Case(NamedTuple):
    """How a run is made and observed: seconds of it, the contacts, the noise of the sensors, samples a second of each
    unit and of the deck, wave height in m and its seed.
    """

    name: str
    seconds: float
    contacts: str = "rigid"
    noise: SensorNoise = NO_NOISE
    tolerance: float = 1e-5
    contact_time: float = 0.002
    window: float = 0.2
    scene: Path = ROOT / "test" / "heavy_sea.yaml"
    rate: float = 20.0
    height: float = 1.6
    seed: int = 1


def predicted(case: Case, bag: Path) -> Result:
    """Simulate a case, record it and replay the record."""
    scenes = scenes_of(read_values(case.scene))
    deck = deck_in(waves_of(SeaState(case.height, 4.0), case.seed), Vessel())
    sail(scenes, deck, case.seconds, case.contacts, bag, Sensors(case.rate, case.rate, case.noise, case.seed))
    return replay(bag, {name: observed(scene, case) for name, scene in scenes.items()})


def observed(scene: Scene, case: Case) -> Scene:
    """A scene whose tolerance, contact time and window fit the noise."""
    assert scene.deck is not None
    deck = scene.deck._replace(window=case.window)
    return scene._replace(tolerance=case.tolerance, contact_time=case.contact_time, deck=deck)


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 3600.0
    table = plain_table()
    table.add_column("run")
    for header in COLUMNS:
        table.add_column(header, justify="right", no_wrap=True)
    with tempfile.TemporaryDirectory() as folder:
        for case in (
            Case("impact laws", seconds),
            Case("... noise of a good tracker", seconds, noise=TRACKER, tolerance=0.005, contact_time=0.01),
            Case("... of a fair one", seconds, noise=FAIR, tolerance=0.01, contact_time=0.03, window=0.5),
            Case("a crate, impact laws", 180.0, scene=CRATE, rate=50.0, height=1.7, seed=19),
            Case("... stiff contacts", 180.0, "compliant", tolerance=1e-3, scene=CRATE, rate=50.0, height=1.7, seed=19),
        ):
            table.add_row(case.name, *words_of(predicted(case, Path(folder) / f"{len(table.rows)}.mcap")))
    show(Console(), table)


def words_of(result: Result) -> list[str]:
    truth = result.truth
    assert truth is not None
    numbers = (truth.clear_mode_accuracy, truth.median_velocity_error, truth.median_time_error)
    right, velocity, time = (
        "-" if number is None else f"{factor * number:.{digits}f}"
        for number, factor, digits in zip(numbers, (100.0, 100.0, 1e3), (1, 2, 2), strict=True)
    )
    warned = [one.warned.before_first_impact for one in result.truths.values() if one.warned is not None]
    in_time = f"{sum(one is True for one in warned)} of {sum(one is not None for one in warned)}"
    return [str(truth.touchdowns), str(truth.missed), str(truth.false), right, velocity, time, in_time]


if __name__ == "__main__":
    main()
