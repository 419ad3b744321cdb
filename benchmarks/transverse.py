"""What slip across the impact plane changes for the recorded cube tosses, without a fit and fitted on one half of them.

    python benchmarks/transverse.py

First the tosses are replayed with the published parameters, with friction against the slip in the plane alone and
against the whole slip: relative error of the twist in the plane, and error of the velocity along the edge over the same
speed. Then friction and restitution are fitted to one half of the tosses, by the least mean error over a grid, and the
other half is scored with them: for the tosses of even and of odd number, for the first and the last, and for random
halves.
"""

from __future__ import annotations

import sys
from bisect import bisect_left
from itertools import product
from math import hypot
from statistics import median
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table
from sensitivity import PARAMETERS, load

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.transverse import Transverse, TransverseOutcome, solve_transverse_impact
from impact_predictor.mechanics.types import Outcome, Twist, TwoPointBody
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.impact import TOLERANCE
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.score import MEASURED
from impact_predictor.prediction.types import Geometry, Sample, Score
from impact_predictor.prediction.vectors import axes_of, dot, to_world

FRICTIONS = np.arange(0.10, 0.341, 0.02)
RESTITUTIONS = np.arange(0.0, 0.251, 0.025)
RANDOM_HALVES = 200

FIRST_TOSS, TOSS = 10.0, 20.0
"""s: when the first toss begins in the record, and how far apart they are (examples/cube_tosses/README.md)."""

Errors = NDArray[np.float64]


class Landing(NamedTuple):
    """A scored touchdown: its toss; the impact as it was predicted; the twist and the relative speed of its score."""

    toss: int
    body: TwoPointBody
    before: Twist
    motion: Transverse | None
    measured: Twist
    half_distance: float

    def error(self, friction: float, restitution: float, spatial: bool) -> float:
        """The relative error of the twist in the plane."""
        old, new = self.body.old, self.body.new
        assert old is not None
        body = self.body._replace(
            old=old._replace(friction=friction), new=new._replace(friction=friction, restitution=restitution)
        )
        if spatial and self.motion is not None:
            after = solve_transverse_impact(body, self.before, self.motion, TOLERANCE).outcome.twist
        else:
            after = solve_impact(body, self.before).twist
        s = self.half_distance
        difference = hypot(after.vx - self.measured.vx, (after.omega - self.measured.omega) * s)
        return difference / hypot(self.before.vx, self.before.omega * s)


def replay(scene: Scene, record: list[Sample | Geometry]) -> list[Score]:
    """The scored touchdowns of a record."""
    predictor = Predictor(scene)
    scores = []
    for message in record:
        if isinstance(message, Geometry):
            predictor.tell(message)
        else:
            scores.append(predictor.update(message).score)
    return [score for score in [*scores, *predictor.finish()] if score is not None and score.scored]


def along_the_edge(scores: list[Score], record: list[Sample | Geometry]) -> list[float]:
    """Errors of the velocity along the axis after each touchdown, relative as the twist's."""
    samples = [message for message in record if isinstance(message, Sample)]
    stamps = [sample.stamp for sample in samples]
    errors = []
    for score in scores:
        touchdown = score.touchdown
        first = bisect_left(stamps, score.stamp)
        measured = [
            dot(touchdown.axis, to_world(axes_of(sample.orientation), sample.linear))
            for sample in samples[first:][MEASURED]
        ]
        predicted = dot(touchdown.axis, to_world(axes_of(touchdown.orientation), touchdown.linear))
        scale = hypot(touchdown.before.vx, touchdown.before.omega * touchdown.half_distance)
        errors.append(abs(predicted - median(measured)) / scale)
    return errors


def landings_of(scene: Scene, record: list[Sample | Geometry]) -> list[Landing]:
    """The scored touchdowns with the impacts that the predictor solved for them."""
    motions: dict[Twist, tuple[TwoPointBody, Transverse | None]] = {}

    def spatial(body: TwoPointBody, before: Twist, motion: Transverse, *choices: Any) -> TransverseOutcome:
        motions[before] = body, motion
        return solve_transverse_impact(body, before, motion, *choices)

    def planar(body: TwoPointBody, before: Twist, *choices: Any) -> Outcome:
        motions[before] = body, None
        return solve_impact(body, before, *choices)

    with (
        patch("impact_predictor.mechanics.transverse.solve_transverse_impact", spatial),
        patch("impact_predictor.prediction.impact.solve_impact", planar),
    ):
        scores = replay(scene, record)
    landings = []
    for score in scores:
        touchdown = score.touchdown
        body, motion = motions[touchdown.before]
        assert score.measured is not None
        toss = int((score.stamp * 1e-9 - FIRST_TOSS) / TOSS)
        landings.append(Landing(toss, body, touchdown.before, motion, score.measured, touchdown.half_distance))
    return landings


def numbers(errors: Errors | list[float]) -> tuple[str, str, str]:
    return f"{np.median(errors):.4f}", f"{np.percentile(errors, 90):.4f}", f"{np.mean(errors):.4f}"


def held_out(table: Errors, half: NDArray[np.bool_]) -> tuple[tuple[int, int], Errors]:
    """Where on the grid the mean error of one half is least, and the errors of the other half there."""
    best = np.unravel_index(np.argmin(table[:, :, half].mean(axis=2)), table.shape[:2])
    i, j = int(best[0]), int(best[1])
    return (i, j), table[i, j, ~half]


def main() -> int:
    """Print the tables."""
    console = Console()
    record = load()
    scene = Scene.from_parameters(validate(read_parameters(PARAMETERS)))._replace(transverse_slip=True)
    names: tuple[tuple[str, bool], ...] = (("in the plane", False), ("whole slip", True))

    table = Table("friction opposes", "scored", "median", "90 %", "mean", "along: median", "90 %", "mean")
    for name, spatial in names:
        scores = replay(scene._replace(transverse_slip=spatial), record)
        errors = [score.relative_error for score in scores if score.relative_error is not None]
        table.add_row(name, str(len(errors)), *numbers(errors), *numbers(along_the_edge(scores, record)))
    table.title = "Published parameters, nothing fitted"
    console.print(table)

    landings = landings_of(scene, record)
    tosses = np.array([landing.toss for landing in landings])
    grids = {
        name: np.array(
            [
                [landing.error(float(friction), float(restitution), spatial) for landing in landings]
                for friction, restitution in track(
                    list(product(FRICTIONS, RESTITUTIONS)), name, console=Console(stderr=True)
                )
            ]
        ).reshape(len(FRICTIONS), len(RESTITUTIONS), -1)
        for name, spatial in names
    }
    table = Table("friction opposes", "fitted on", "friction", "restitution", "scored on", "median", "90 %", "mean")
    halves = (("even", "odd", tosses % 2 == 0), ("first", "last", tosses <= np.median(tosses)))
    for (name, _), (one, other, half) in product(names, halves):
        for fitted, scored, chosen in ((one, other, half), (other, one, ~half)):
            (i, j), errors = held_out(grids[name], chosen)
            values = f"{FRICTIONS[i]:.2f}", f"{RESTITUTIONS[j]:.3f}"
            table.add_row(name, fitted, *values, f"{scored} ({len(errors)})", *numbers(errors))
    table.title = "Fitted on one half of the tosses, scored on the other"
    console.print(table)

    rng = np.random.default_rng(0)
    all_tosses = np.unique(tosses)
    means: dict[str, list[tuple[float, float, float]]] = {name: [] for name, _ in names}
    for _ in range(RANDOM_HALVES):
        half = np.isin(tosses, rng.permutation(all_tosses)[: len(all_tosses) // 2])
        for name, _ in names:
            errors = held_out(grids[name], half)[1]
            means[name].append((float(np.median(errors)), float(np.percentile(errors, 90)), float(np.mean(errors))))
    table = Table(
        "friction opposes", "median", "90 %", "mean", title=f"Mean of {RANDOM_HALVES} random halves, held out"
    )
    for name, _ in names:
        table.add_row(name, *(f"{value:.4f}" for value in np.mean(means[name], axis=0)))
    better = np.sum(np.array(means["whole slip"]) < np.array(means["in the plane"]), axis=0)
    table.add_row("whole slip better in", *(str(count) for count in better))
    console.print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
