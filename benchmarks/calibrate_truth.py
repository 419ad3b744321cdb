"""Whether `impact-predictor calibrate` gives the friction and restitution back that simulated bags were made with.

    python benchmarks/calibrate_truth.py

Each row is a body that is released at a dozen angles, as `impact-predictor simulate` does it, recorded at 1 kHz; the
scene says friction 0.4 and no restitution.
"""

from __future__ import annotations

import sys
from math import radians
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.progress import track
from rich.table import Table

from impact_predictor.bags.replay import replay
from impact_predictor.calibration.fit import Calibration, calibrate
from impact_predictor.calibration.search import interval
from impact_predictor.calibration.touchdowns import touchdowns_of
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.scenarios.record import rocking_actor, write_record
from impact_predictor.scenarios.rocking import Rocker, release, rocking_plate, rocking_rod

ANGLES = range(3, 27, 2)
RATE = 1000.0


def cases() -> list[tuple[str, str, float, Rocker]]:
    """Name, friction, restitution and body of each row."""
    made = [
        ("plate 1 m x 0.4 m", "sticks" if friction is None else f"{friction}", 0.1, plate(friction))
        for friction in (0.05, 0.15, 0.3, None)
    ]
    thick = rocking_rod(0.4, 0.05, 0.1, 0.1, 1.0, 0.1, None, 0.0)
    thin = rocking_rod(0.4, 0.0, 0.1, 0.1, 1.0, 0.1, None, 0.0)
    return [*made, ("rod, 50 mm thick", "0.1", 0.0, thick), ("rod, thin", "0.1", 0.0, thin)]


def plate(friction: float | None) -> Rocker:
    return rocking_plate(1.0, 0.4, None, None, 1.0, friction, None, 0.1)


def fitted(rocker: Rocker, folder: Path) -> Calibration:
    """What bags of the body, released at each angle, tell."""
    scene = Scene(
        rocker.body.mass,
        inertia_matrix([rocker.body.inertia]),
        friction=0.4,
        tolerance=1e-3,
        contact_time=1e-3,
    )
    records = []
    for angle in ANGLES:
        path = folder / f"{angle}.mcap"
        write_record(path, [rocking_actor(rocker.name, release(rocker, radians(angle)).run)], RATE)
        records.append(touchdowns_of(replay(path, scene).settled, {"": scene}))
    return calibrate(records)


def main() -> int:
    """Print the table."""
    table = Table("body", "friction", "told", "restitution", "told", "touchdowns")
    for name, friction, restitution, rocker in track(cases(), "simulating", console=Console(stderr=True)):
        with TemporaryDirectory() as folder:
            one = fitted(rocker, Path(folder))
        told = [interval(one.estimates[name]) for name in ("friction", "restitution")]
        table.add_row(name, friction, told[0], f"{restitution}", told[1], str(len(one.touchdowns)))
    Console(width=120).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
