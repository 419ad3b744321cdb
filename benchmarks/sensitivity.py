"""How right predictions of the recorded cube tosses are: with each choice changed by itself, and by the time ahead.

    python benchmarks/sensitivity.py

Prints of the whole twist (six numbers) the relative error, in the median and what 90 % stay below, and in how many of a
hundred whether the old and the new contact lift is told right (balanced over those that do and those that do not). Then
the same error, and that of the time, by how long before the touchdown a prediction was made.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from impact_predictor.bags.read import read_messages
from impact_predictor.prediction.course import Pose
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, inertia_matrix, read_scenes
from impact_predictor.prediction.spatial_score import SpatialScore
from impact_predictor.prediction.types import Geometry, Sample, Touchdown
from impact_predictor.prediction.vectors import add, axes_of, to_world
from impact_predictor.ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon

ROOT = Path(__file__).resolve().parents[1]
TOSSES = ROOT / "examples/cube_tosses/cube_tosses.mcap"
PARAMETERS = ROOT / "config/cube_tosses.yaml"

PUBLISHED = {"inertia": inertia_matrix([8.1e-4]), "center_of_mass": (0.0, 0.0, 0.0)}
SPANS = (0.0, 0.01, 0.02, 0.03, 0.05, 0.1)
"""s before the touchdown."""

Made = tuple[int, Touchdown]
"""A prediction and the stamp in ns of its sample."""


class Scored(NamedTuple):
    """A scored touchdown, and what was predicted of it, the last prediction first."""

    score: SpatialScore
    predictions: list[Made]


class Variation(NamedTuple):
    """A choice changed, and the scene to predict with then."""

    choice: str
    value: str
    scene: Scene


def load() -> list[Sample | Geometry]:
    """The tosses as the predictor takes them."""
    topics = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
    return [
        (decode_odometry if topic == "/cube/odom" else decode_polygon)(data)
        for topic, _, data in read_messages(TOSSES, topics)
    ]


def scored(scene: Scene, record: list[Sample | Geometry]) -> list[Scored]:
    """The touchdowns whose whole twist counts."""
    body, made, scores = Predictor(scene), list[Made](), []
    for message in record:
        if isinstance(message, Geometry):
            body.tell(message)
            continue
        prediction = body.update(message)
        if prediction.touchdown is not None:
            made.append((message.stamp, prediction.touchdown))
        scores.append((prediction.score, len(made)))
    scores += [(score, len(made)) for score in body.finish()]
    return [
        Scored(score.spatial, list(of_one(score.spatial, made[max(0, count - 200) : count])))
        for score, count in scores
        if score is not None and score.spatial is not None and not score.leftover_6d
    ]


def of_one(score: SpatialScore, made: list[Made]) -> Iterator[Made]:
    """The predictions of one touchdown, backwards: a point that strikes is the same in each and in the next one."""
    new = set(score.told.new)
    for stamp, told in reversed(made):
        if stamp < score.stamp:
            if new.isdisjoint(told.new):
                return
            new = set(told.new)
            yield stamp, told


def errors_of(score: SpatialScore, made: Made) -> tuple[float, float]:
    """The error of the whole twist of a prediction, and of its time in ms."""
    stamp, told = made
    late = stamp * 1e-9 + told.lead_time - score.stamp * 1e-9
    shift = score.late - late
    center = add(told.position, to_world(axes_of(told.orientation), score.course.scene.center_of_mass))
    course = score.course._replace(start=Pose(center, told.orientation), resting=told.old + told.new)
    first, second, third = score.moments
    moments = first + shift, second + shift, third + shift
    return replace(score, told=told, course=course, moments=moments).error, 1e3 * abs(late)


def is_within(touchdown: Scored, made: Made, begin: float, end: float) -> bool:
    """Whether a prediction was made so many s before the touchdown."""
    return begin <= (touchdown.score.stamp - made[0]) * 1e-9 < end


def row_of(touchdowns: list[Scored]) -> list[str]:
    """How many there are, how right their twists are, and how right their lifts."""
    errors = [one.score.error for one in touchdowns]
    row = [str(len(errors)), f"{np.median(errors):.3f}", f"{np.percentile(errors, 90):.3f}"]
    for group in (0, 1):
        lifts = [lift for one in touchdowns if (lift := one.score.lifts[group]) is not None]
        shares = [np.mean([lift.told == real for lift in lifts if lift.measured == real]) for real in (True, False)]
        row.append(f"{50.0 * sum(shares):.0f}")
    return row


def variations(scene: Scene) -> Iterator[Variation]:
    """Every choice changed by itself."""
    changes: list[tuple[str, str, dict[str, Any]]] = [
        ("body", "as published", PUBLISHED),
        ("body.inertia", "8.1e-4, published", {"inertia": PUBLISHED["inertia"]}),
        ("body.center_of_mass", "0, published", {"center_of_mass": PUBLISHED["center_of_mass"]}),
        ("contact.friction", "0.18, published", {"friction": 0.18}),
        *[("contact.friction", str(value), {"friction": value}) for value in (0.09, 0.35)],
        ("contact.restitution", "0.125, published", {"restitution": 0.125}),
        *[("contact.restitution", str(value), {"restitution": value}) for value in (0.0, 0.5)],
        *[("contact.merge", f"{1e3 * value:g} ms", {"merge": value}) for value in (0.0, 1e-3, 4e-3)],
        *[("contact.tolerance", f"{1e3 * value:g} mm", {"tolerance": value}) for value in (2.5e-3, 0.01)],
        ("odom.twist", "message", {"poses": False}),
        *[("uncertainty.samples", str(value), {"samples": value}) for value in (0, 64)],
        *[("uncertainty.gap", f"{1e3 * value:g} mm", {"gap_deviation": value}) for value in (0.0, 2e-4, 8e-4)],
        ("law", "total", {"law": "total"}),
    ]
    yield Variation("as shipped", "", scene)
    for choice, value, fields in changes:
        yield Variation(choice, value, scene._replace(**fields))


def main() -> int:
    """Print both tables, each row as soon as it is known."""
    record = load()
    scene = read_scenes(PARAMETERS)[""]
    shipped: list[Scored] = []
    show("choice", "value", "scored", "median", "90 %", "old lifts", "new lifts")
    for variation in variations(scene):
        touchdowns = scored(variation.scene, record)
        shipped = shipped or touchdowns
        show(variation.choice, variation.value, *row_of(touchdowns))
        if touchdowns is shipped:
            show("made ms ahead", "", "number", "median", "90 %", "time: ms", "90 %")
            for begin, end in pairwise(SPANS):
                # Of each touchdown the last prediction that was made so early.
                made = [next((one for one in of.predictions if is_within(of, one, begin, end)), None) for of in shipped]
                some = [errors_of(of.score, one) for of, one in zip(shipped, made, strict=True) if one is not None]
                spreads = [(np.median(errors), np.percentile(errors, 90)) for errors in zip(*some, strict=True)]
                numbers = [f"{value:.3g}" for spread in spreads for value in spread]
                show(f"  {1e3 * begin:.0f} to {1e3 * end:.0f}", "", str(len(some)), *numbers)
    return 0


def show(choice: str, value: str, *numbers: str) -> None:
    """Print a row."""
    print(f"{choice:22s}{value:18s}" + "".join(f"{number:>11s}" for number in numbers), flush=True)


if __name__ == "__main__":
    sys.exit(main())
