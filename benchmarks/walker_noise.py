"""Predicted landings of a planned gait, with seeded noise on base and feet.

    python benchmarks/walker_noise.py [SEEDS [FIRST]]

Every sample gets noise of its own, standing feet included: 1 mm on each coordinate and 0.02 m/s on each part of each
velocity. Prints, without noise and for each seed: true landings found and missed, false alarms, the shortest time from
the first prediction of a landing to it, and the error of the times announced 20 ms and 50 ms ahead, its median and what
90 % are below. Then how many landings were told to have happened, and how often a foot is told to stand or to swing and
does not: of all samples, and of those more than 30 ms inside a true stance or swing. The feet are told in the world,
then by the robot, relative to a base that has noise too.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import track
from walker_sensors import noisy

from impact_predictor.bags.adapters import Adapted, readers
from impact_predictor.bags.read import Bag
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.prediction.types import Prediction
from impact_predictor.report.table import plain_table, show
from impact_predictor.scenarios.comparison import Comparison
from impact_predictor.scenarios.matching import Match

ROOT = Path(__file__).resolve().parents[1]
BAG = ROOT / "examples/hyq/hyq.bag"
TOPIC, TYPE = "/xpp/state_des", "xpp_msgs/msg/RobotStateCartesian"
LEAD_TIMES: Final = (20_000_000, 50_000_000)
NEAR: Final = 0.03
"""Seconds from a true change within which a stance may be told late."""


class Outcome(NamedTuple):
    """What came of a run: times in s, parts of 1."""

    found: int
    missed: int
    false: int
    least_lead_time: float
    errors: tuple[Sequence[float], ...]
    told: int
    wrong: float
    wrong_within: float


def plan() -> list[Adapted]:
    """The plan of HyQ."""
    with Bag(BAG) as bag:
        read = readers(bag, {TOPIC: TYPE})[TOPIC]
        return [read(message.data) for message in bag.messages({TOPIC: TYPE})]


def scene() -> Scene:
    """The scene of HyQ, as it is shipped."""
    return scenes_of(read_values(str(ROOT / "config/walker_hyq.yaml")))[""]


def run(record: Sequence[Adapted], machine: Scene, seed: int | None = None, on_robot: bool = False) -> Outcome:
    """Predict the landings of a record, with the noise of a seed."""
    rng = np.random.default_rng(seed)
    walker, landings = Predictor(machine), Comparison({"": machine})
    answers: list[Prediction] = []
    for one in record:
        assert one.sample is not None
        assert one.geometry is not None
        sample, geometry = one.sample, one.geometry
        if seed is not None:
            sample, geometry = noisy(sample, geometry, rng, on_robot=on_robot)
        landings.add_stances(sample.child_frame_id, sample.stamp, one.stands)
        walker.tell(geometry)
        answers.append(walker.update(sample))
        landings.add(answers[-1])
    scores = [one.score for one in answers if one.score is not None] + list(walker.finish())
    matches = landings.compare().matches
    true = [one for one in matches if one.stamp is not None]
    found = [one for one in true if one.predictions]
    stands = np.array([one.stands for one in record])
    wrong = np.array([[foot.stands for foot in one.feet] for one in answers]) != stands
    stamps = np.array([one.sample.stamp for one in answers])
    return Outcome(
        len(found),
        len(true) - len(found),
        len(matches) - len(true),
        min(one.first_lead_time for one in found),
        tuple(errors_of(found, lead_time * 1e-9) for lead_time in LEAD_TIMES),
        sum(one.landing is not None for one in scores),
        float(wrong.mean()),
        float(wrong[far_from_changes(stands, stamps)].mean()),
    )


def errors_of(found: Sequence[Match], lead_time: float) -> list[float]:
    """Errors in s of the times that were announced so many s before the landings."""
    return [error for one in found if (error := one.time_error(lead_time)) is not None]


def far_from_changes(stands: np.ndarray, stamps: np.ndarray) -> np.ndarray:
    """Of each sample and foot, whether the foot neither lands nor lifts within `NEAR`."""
    far = np.ones_like(stands)
    for foot in range(stands.shape[1]):
        changes = stamps[1:][stands[1:, foot] != stands[:-1, foot]]
        far[:, foot] = np.abs(stamps[:, None] - changes).min(axis=1) > NEAR * 1e9
    return far


def cells(name: str, seed: str, runs: Sequence[Outcome]) -> list[str]:
    """The row of one run, or of many together: sums, the worst lead time, and the errors of all."""
    errors = [np.concatenate([one.errors[k] for one in runs]) for k in range(len(LEAD_TIMES))]
    return [
        name,
        seed,
        *(str(sum(getattr(one, field) for one in runs)) for field in ("found", "missed", "false")),
        f"{1e3 * min(one.least_lead_time for one in runs):.0f}",
        *(f"{1e3 * np.quantile(one, part):.2f}" for one in errors for part in (0.5, 0.9)),
        str(sum(one.told for one in runs)),
        *(f"{100.0 * np.mean([getattr(one, field) for one in runs]):.2f}" for field in ("wrong", "wrong_within")),
    ]


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    numbers = range(first, first + count)
    record, machine = plan(), scene()
    table = plain_table()
    table.add_column("noise", no_wrap=True)
    ahead = ("20 ms\nahead\nms", "\n90 %\nms", "50 ms\nahead\nms", "\n90 %\nms")
    for header in ("seed", "found", "missed", "false", "lead\nms", *ahead, "told", "wrong\n%", "inside\n%"):
        table.add_column(header, justify="right", no_wrap=True)
    table.add_row(*cells("none", "", [run(record, machine)]))
    for on_robot, name in ((False, "world"), (True, "robot")):
        seeds = track(numbers, name, console=Console(stderr=True), transient=True)
        runs = [run(record, machine, seed, on_robot) for seed in seeds]
        table.add_section()
        for seed, one in zip(numbers, runs, strict=True):
            table.add_row(*cells(name, str(seed), [one]))
        table.add_row(*cells(name, "all", runs), style="bold")
    show(Console(), table)


if __name__ == "__main__":
    main()
