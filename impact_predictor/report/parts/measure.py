"""What the parts of a scene cost, measured: CPU time for each sample, CPU time and memory at the start."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from itertools import pairwise, zip_longest
from pathlib import Path
from statistics import median
from time import process_time_ns
from typing import Any, Final

from ...parameters.file import read_values
from ...prediction.monitor import Monitor
from ...prediction.parts import EVENTS, PARTS, Part, Values, ladder
from ...prediction.scene import Scene, Walking, scenes_of
from ...prediction.types import Geometry, Joints, Prediction, Sample, Schedule, Wrench
from ...ros.messages import OUTPUTS
from .record import Message, OfSupport, Record, record_of
from .start import Start, Starts, Steps, starts_of

Tell = Callable[[float], None]

CORE: Final = "core"
WHY_CORE: Final = "every scene: samples, impact plane, motion until the touchdown, impact, score"

FEET: Final = next(part for part in PARTS if part.name == "feet")

COSTS: Final = ("us_per_sample", "start_ms", "start_mb")
SAMPLES: Final = 400
RUNS: Final = 5
BUDGET: Final = 0.7
"""Seconds after which what is expensive, and so stands out from the noise, is not measured once more."""


def _nobody(done: float) -> None:
    """Nobody is told."""


def measure_parts(params: str | os.PathLike[str], tell: Tell = _nobody, runs: int = RUNS) -> dict[str, Any]:
    """What each part of the scene of a parameter file costs, and what those that it leaves out would.

    `tell` is told how much is done, 0 to 100. Keys:

    - `parts`, each with `name`, `on`, `why`, `us_per_sample`, `start_ms`, `start_mb`; None where there is no such cost;
      and `us_scatter`, that of `us_per_sample`: what is not above it cannot be told from no cost
    - `us_per_sample`, `start_ms`, `start_mb` of the whole scene; in `all_on` with every part instead, and `us_scatter`
      of what that adds
    - `node`, the same two of the start of the node, and `us_per_message`, in which a message without a touchdown is
      published, received and answered; or None for the reason in `why_no_node`
    - `outputs`, the microseconds for a sample in which each is encoded, paid only while somebody subscribes to it
    - `scene`, and `record`: over what it was measured

    Costs are CPU time, in medians of `runs` runs. The parts are switched on one after another, those of the scene
    first, so that the costs add up. The scatter is half the range of what a part adds in each of the runs: with five of
    them about twice the standard error of their median.

    Raises:
        InputError: the file cannot be read, or a parameter is wrong.
    """
    values, name = read_values(params), Path(params).stem
    steps = steps_of(values)
    body, one = measured(values)
    record = record_of(name, one, SAMPLES)
    costs = us_per_sample(steps, record, runs, lambda done: tell(0.5 * done))
    starts = starts_of(steps, runs, lambda done: tell(50 + 0.5 * done), 1 if FEET.on(values) else 0)
    scene = max(k for k, (part, _) in enumerate(steps) if part is None or part.on(values))
    medians = [median(cost) for cost in costs]
    added = [(medians[0], 0.0), *[added_by(before, after) for before, after in pairwise(costs)]]
    return {
        "scene": name,
        "parts": [
            {
                "name": CORE if part is None else part.name,
                "on": part is None or part.on(values),
                "why": WHY_CORE if part is None else part.why(values),
                **_us(part, us, starts),
                **_start(part, predictor, node),
            }
            for (part, _), us, predictor, node in zip_longest(steps, added, starts.predictor, starts.node)
        ]
        + [
            {"name": part.name, "on": part.on(values), "why": part.why(values), **dict.fromkeys((*COSTS, "us_scatter"))}
            for part in PARTS
            if part not in [step for step, _ in steps]
        ],
        "us_per_sample": medians[scene],
        **_sum(starts.predictor[: scene + 1]),
        "all_on": {
            "us_per_sample": medians[-1],
            "us_scatter": added_by(costs[scene], costs[-1])[1],
            **_sum(starts.predictor),
        },
        "node": _node(starts, scene, values["executor"] == "events"),
        "why_no_node": starts.why_no_node,
        "outputs": us_per_output(values, record),
        "record": record.origin + (f" (the body is {body})" if body else ""),
    }


def steps_of(values: Values) -> list[tuple[Part | None, Values]]:
    """The ladder of a scene. Where it has feet, these are a step of their own, after points that are fixed to the body.

    That is over the same record: the points are then where the last geometry has told them to be.
    """
    (core, first), *others = ladder(values)
    if not FEET.on(values):
        return [(core, first), *others]
    fixed = {name: () if name.rpartition("feet.")[2] == "names" else value for name, value in first.items()}
    return [(core, fixed), (FEET, first), *others]


def added_by(before: Sequence[float], after: Sequence[float]) -> tuple[float, float]:
    """What a step adds to the median of repeated runs, and the scatter of that."""
    added = [cost - other for other, cost in zip(before, after, strict=False)]
    return median(after) - median(before), 0.5 * (max(added) - min(added))


def _us(part: Part | None, added: tuple[float, float], starts: Starts) -> dict[str, float | None]:
    """What a part adds to a sample, with its scatter; the executor, to its way to the predictor."""
    if part is not None and part.of_node:
        if part.name != EVENTS or starts.messages is None:
            return {"us_per_sample": None, "us_scatter": None}
        single, events = starts.messages
        added = events - single, starts.messages_scatter
    return dict(zip(("us_per_sample", "us_scatter"), added, strict=True))


def _node(starts: Starts, scene: int, by_events: bool) -> dict[str, Any] | None:
    """What the node costs with the first steps of a ladder, up to those of the scene, and with all."""
    if starts.messages is None:
        return None
    single, events = starts.messages
    return {
        "us_per_message": events if by_events else single,
        **_sum(starts.node[: scene + 1]),
        "all_on": {"us_per_message": events, **_sum(starts.node)},
    }


def _start(part: Part | None, predictor: Start, node: Start | None) -> dict[str, float | None]:
    """What a part adds to the start: a part of the node to the node's."""
    if part is not None and part.of_node:
        return {"start_ms": node.ms, "start_mb": node.mb} if node else {"start_ms": None, "start_mb": None}
    if part is None or part.modules:
        return {"start_ms": predictor.ms, "start_mb": predictor.mb}
    return {"start_ms": None, "start_mb": None}


def _sum(starts: Sequence[Start]) -> dict[str, float]:
    return {"start_ms": sum(start.ms for start in starts), "start_mb": sum(start.mb for start in starts)}


def us_per_sample(steps: Steps, record: Record, runs: int, tell: Tell = _nobody) -> list[list[float]]:
    """Microseconds of CPU time for each sample of a record, at every step of a ladder, in each of some runs in turn."""
    costs: list[list[float]] = [[] for _ in steps]
    for run in range(runs + 1):
        for k, (part, values) in enumerate(steps):
            if part is not None and part.of_node:
                costs[k] = costs[k - 1]
            elif 1e-6 * record.samples * sum(costs[k]) < BUDGET:
                cost = _run(values, record)
                if run or cost * 1e-6 * record.samples > BUDGET:  # the first run warms up, if there is time for it
                    costs[k].append(cost)
            tell(100 * (run * len(steps) + k + 1) / ((runs + 1) * len(steps)))
    return costs


def measured(values: Values) -> tuple[str, Scene]:
    """The body that costs are measured of, with its scene: the first whose pose is measured, if there is one."""
    scenes = scenes_of(values)
    body = next((body for body, scene in scenes.items() if scene.source == "odom"), next(iter(scenes)))
    return body, scenes[body]


def monitor_of(values: Values, record: Record) -> tuple[str, Monitor]:
    """The predictors of a scene, and the body of the record, with its contact points where they are parameters."""
    scenes = scenes_of(values)
    body, scene = measured(values)
    if scene.points:
        scenes[body] = scene._replace(points=record.points)
    return body, Monitor(scenes)


def _run(values: Values, record: Record) -> float:
    body, monitor = monitor_of(values, record)
    wants_margins = monitor.scenes[body].margins
    began = process_time_ns()
    for message in record.messages:
        prediction = take(monitor, body, message)
        touchdown = None if prediction is None else prediction.touchdown
        if wants_margins and touchdown is not None and touchdown.planar is not None:
            touchdown.planar.margins  # noqa: B018  # found when they are read
    return 1e-3 * (process_time_ns() - began) / record.samples


def take(monitor: Monitor, body: str, message: Message) -> Prediction | None:
    """Hand a message of a record to whom it concerns, if anybody; the answer to a sample."""
    if isinstance(message, OfSupport):
        if monitor.deck is not None:
            if isinstance(message.message, Sample):
                monitor.update_support(message.message)
            else:
                monitor.update_support_imu(message.message)
            monitor.reports()
    elif body in monitor.predictors:
        if isinstance(message, Sample):
            prediction = monitor.update(body, message)
            monitor.reports()
            return prediction
        scene = monitor.scenes[body]
        if isinstance(message, Geometry):
            if scene.needs_geometry:
                monitor.set_geometry(body, message)
        elif scene.walking is not None:
            _take_of_feet(monitor, body, scene.walking, message)
    return None


def _take_of_feet(monitor: Monitor, body: str, walking: Walking, message: Joints | Wrench | Schedule) -> None:
    if isinstance(message, Joints):
        if walking.robot is not None:
            monitor.set_joints(body, message)
    elif isinstance(message, Wrench):
        if walking.force:
            monitor.set_wrench(body, message)
    elif walking.has_schedule:
        monitor.set_schedule(body, message)


def us_per_output(values: Values, record: Record) -> dict[str, float]:
    """Microseconds of CPU time in which each output of the scene is encoded, for each sample of a record."""
    body, monitor = monitor_of(values, record)
    answers = [take(monitor, body, message) for message in record.messages]
    predictions = [answer for answer in answers if answer is not None]
    if not predictions:
        return {}
    costs = {}
    for name, output in OUTPUTS.items():
        began = process_time_ns()
        for prediction in predictions:
            output.encode(prediction)
        costs[name] = 1e-3 * (process_time_ns() - began) / len(predictions)
    return costs
