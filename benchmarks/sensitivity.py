"""How the score of the recorded cube tosses depends on each choice of the prediction: every one halved and doubled.

    python benchmarks/sensitivity.py

Prints a row for each: scored touchdowns, median and 90 % of the relative error of the twist after them; and what a
simple answer scores on the same touchdowns.
"""

from __future__ import annotations

import sys
from math import hypot
from pathlib import Path
from types import ModuleType
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from impact_predictor.bags.read import read_messages
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction import impact, planar, points
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.prediction.types import Geometry, Sample, Score
from impact_predictor.ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon

ROOT = Path(__file__).resolve().parents[1]
TOSSES = ROOT / "examples/cube_tosses/cube_tosses.mcap"
PARAMETERS = ROOT / "config/cube_tosses.yaml"

HALF_SIDE = 0.0524
"""Of the cube, in m."""

SIMPLE = 0.85
"""The part of vx that is left after most landings of the cube."""

SCENE_FIELDS = ("tolerance", "contact_time", "twist_window", "horizon", "friction", "restitution")
CONSTANTS: tuple[tuple[ModuleType, str], ...] = (
    (planar, "STANDING"),
    (points, "SETTLED"),
    (impact, "OFF_AXIS"),
    (impact, "OFFSET"),
    (impact, "SLOWEST"),
)


def load() -> list[Sample | Geometry]:
    """The tosses as the predictor takes them."""
    topics = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
    return [
        (decode_odometry if topic == "/cube/odom" else decode_polygon)(data)
        for topic, _, data in read_messages(TOSSES, topics)
    ]


def scores_of(scene: Scene, record: list[Sample | Geometry]) -> list[Score]:
    """The touchdowns that count."""
    body = Predictor(scene)
    scores = []
    for message in record:
        if isinstance(message, Geometry):
            body.tell(message)
        else:
            scores.append(body.update(message).score)
    scores.extend(body.finish())
    return [score for score in scores if score is not None and score.scored]


def row_of(errors: list[float | None]) -> tuple[str, str, str]:
    """Count, median and 90 % of relative errors."""
    return str(len(errors)), f"{np.median(errors):.4f}", f"{np.percentile(errors, 90):.4f}"


def scored(scene: Scene, record: list[Sample | Geometry]) -> tuple[str, str, str]:
    """Count, median and 90 % of the scored relative errors."""
    return row_of([score.relative_error for score in scores_of(scene, record)])


def simple(scene: Scene, record: list[Sample | Geometry], part: float) -> tuple[str, str, str]:
    """The same of the simple answer "this part of vx as before, and no turning"."""
    errors: list[float | None] = []
    for score in scores_of(scene, record):
        before, s, measured = score.touchdown.before, score.touchdown.half_distance, score.measured
        assert measured is not None
        miss = hypot(part * before.vx - measured.vx, measured.omega * s)
        errors.append(miss / hypot(before.vx, before.omega * s))
    return row_of(errors)


class Variation(NamedTuple):
    """A choice changed: the scene to predict with, and a constant of a module that is set meanwhile."""

    choice: str
    value: float
    scene: Scene
    module: ModuleType = impact
    constant: str = "OFF_AXIS"


def variations(scene: Scene) -> list[Variation]:
    """Every choice halved and doubled, then the height of the floor and the physical constants."""
    changed = [
        Variation(field, factor * getattr(scene, field), scene._replace(**{field: factor * getattr(scene, field)}))
        for field in SCENE_FIELDS
        for factor in (0.5, 2.0)
    ]
    changed += [
        Variation(name, value, scene, module, name)
        for module, name in CONSTANTS
        for value in (0.5 * getattr(module, name), 2.0 * getattr(module, name))
    ]
    changed += [Variation("height", height, scene._replace(height=height)) for height in (-0.0029, -0.0009, 0.0)]
    solid = 2 / 3 * scene.mass * HALF_SIDE**2
    changed.append(Variation("inertia (solid cube)", solid, scene._replace(inertia=inertia_matrix([solid]))))
    changed.append(Variation("restitution (plastic)", 0.0, scene._replace(restitution=0.0)))
    changed.append(Variation("friction (no slip)", 1e3, scene._replace(friction=1e3)))
    changed.append(Variation("twist_window (none)", 0.0, scene._replace(twist_window=0.0)))
    changed.append(Variation("law (total)", 0.0, scene._replace(law="total")))
    return changed


def main() -> int:
    """Print the table."""
    record = load()
    scene = Scene.from_parameters(validate(read_parameters(PARAMETERS)))
    table = Table(
        "choice", "value", "scored", "median", "90 %", title="Recorded cube tosses: each choice changed alone"
    )
    table.add_row("as shipped", "", *scored(scene, record))
    table.add_row("simple answer: this part of vx, no turning", f"{SIMPLE}", *simple(scene, record, SIMPLE))
    for variation in track(variations(scene), "replaying", console=Console(stderr=True)):
        value = getattr(variation.module, variation.constant)
        if variation.scene is scene:
            value = variation.value
        with patch.object(variation.module, variation.constant, value):
            table.add_row(variation.choice, f"{variation.value:.4g}", *scored(variation.scene, record))
    Console().print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
