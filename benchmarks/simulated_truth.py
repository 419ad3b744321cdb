"""Predictions of simulated bodies against their true impacts.

    python benchmarks/simulated_truth.py

Prints a row for each run: touchdowns that its record shows, those missed, false alarms, impacts that no record shows,
the part of right modes, and the errors of velocity and of the time told 20 ms ahead, medians.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from math import cos, radians, sin
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console

from impact_predictor.bags.replay import replay
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.report.table import plain_table, show
from impact_predictor.scenarios.comparison import Truth
from impact_predictor.scenarios.record import rocking_actor, write_record
from impact_predictor.scenarios.rocking import Rocker, Rocking, release, rocking_plate, rocking_rod


class Case(NamedTuple):
    """A run: its name, the body, angle of release and slope in degrees, samples a second and the contact time in s."""

    name: str
    rocker: Rocker
    angle: float
    slope: float = 0.0
    rate: float = 1000.0
    contact_time: float = 1e-4


def rod(a: float, friction: float | None = None, restitution: float = 0.0, thickness: float = 0.0) -> Rocker:
    return rocking_rod(0.4, thickness, a, a, 1.0, friction, None, restitution)


def plate(height: float, friction: float | None = None, restitution: float = 0.0) -> Rocker:
    return rocking_plate(1.0, height, None, None, 1.0, friction, None, restitution)


CASES: Final = (
    Case("rod, a = b = 0.1 m", rod(0.1), 30.0),
    Case("rod, a = b = 0.075 m", rod(0.075), 30.0),
    Case("rod, a = b = 0.05 m", rod(0.05), 30.0),
    Case("... released the other way", rod(0.05), -30.0),
    Case("... on a slope of 10 degrees", rod(0.05), 30.0, 10.0),
    Case("... 20 mm thick, friction 0.1", rod(0.05, 0.1, thickness=0.02), 30.0),
    Case("... restitution 0.3", rod(0.05, restitution=0.3), 30.0),
    Case("... 50 samples a second", rod(0.05), 30.0, 0.0, 50.0),
    Case("... and a contact.time of 5 ms", rod(0.05), 30.0, 0.0, 50.0, 5e-3),
    Case("rod, a = 0.05 m, b = 0.1 m", rocking_rod(0.4, 0.0, 0.05, 0.1, 1.0, None, None, 0.0), 30.0),
    Case("plate, height 1.6 m", plate(1.6), 10.0),
    Case("... friction 0.4", plate(1.6, 0.4), 10.0),
    Case("... friction 0.2", plate(1.6, 0.2), 10.0),
    Case("... friction 0.05", plate(1.6, 0.05), 10.0),
    Case("plate, 0.9 m, friction 0.5", plate(0.9, 0.5), 10.0),
    Case("plate, 0.4 m, f = 0.2, e = 0.2", plate(0.4, 0.2, 0.2), 20.0),
    Case("... downhill 15 degrees", plate(0.4, 0.2, 0.2), 20.0, -15.0),
)


def scene_of(rocking: Rocking, case: Case) -> Scene:
    """The scene that fits a run: what its file in config/ would say."""
    body = rocking.rocker.body
    return Scene(
        mass=body.mass,
        inertia=inertia_matrix([1e-3 * body.inertia, body.inertia, body.inertia, 0.0, 0.0, 0.0]),
        friction=body.new.friction,
        restitution=body.new.restitution,
        points=tuple((contact.x, 0.0, contact.y) for contact in (body.old, body.new) if contact is not None),
        normal=(-sin(radians(case.slope)), 0.0, cos(radians(case.slope))),
        tolerance=1e-6,
        contact_time=case.contact_time,
    )


def truth_of(case: Case, folder: Path) -> Truth:
    """Simulate a case, record it and replay the record."""
    rocking = release(case.rocker, radians(case.angle), radians(case.slope))
    path = folder / "run.mcap"
    write_record(path, [rocking_actor("body", rocking.run)], case.rate)
    truth = replay(path, scene_of(rocking, case)).truth
    assert truth is not None
    return truth


def main() -> None:
    table = plain_table()
    table.add_column("run")
    for header in ("shown", "missed", "false", "not\nshown", "modes\n%", "twist\n%", "time\nns"):
        table.add_column(header, justify="right", no_wrap=True)
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            truth = truth_of(case, Path(folder))
            table.add_row(
                case.name,
                *map(str, truth[:4]),
                told(truth.mode_accuracy, lambda part: f"{100.0 * part:.0f}"),
                told(truth.median_velocity_error, lambda error: f"{100.0 * error:.0e}"),
                told(truth.median_time_error, lambda error: f"{1e9 * error:.0f}"),
            )
    show(Console(), table)


def told(value: float | None, words: Callable[[float], str]) -> str:
    return "-" if value is None else words(value)


if __name__ == "__main__":
    main()
