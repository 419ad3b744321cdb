"""The recorded tosses of a cube: how far predictions are from what was measured, and what they cost.

What is measured is no reference of many digits: the poses come at 148 Hz, the instrument's floor is about 0.01 of the
speed, and repeated impacts of one cube differ by some 0.045.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from math import atan2, cos, inf, sin
from statistics import median
from time import process_time_ns
from typing import NamedTuple

from ...bags.read import read_messages
from ...mechanics.motion import PlanarState
from ...parameters.file import read_parameters
from ...parameters.validation import validate
from ...prediction.planar import contacts_of, inertia_about, plane_of, posture_of
from ...prediction.predictor import Predictor
from ...prediction.scene import Scene as Body
from ...prediction.types import Geometry, Sample, Score
from ...resources import find
from ...ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon
from ...stamps import NANOSECONDS
from .measuring import undisturbed
from .rows import IMPACT, TOUCHDOWN, Row, Scene, quantiles
from .touchdown_scenes import Falling

NAME = "cube tosses"
TOPICS = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}

AHEAD = 0.04
"""s before a touchdown at which the methods for touchdowns are asked."""

FAMILIES = {
    "predictor": "Predictor.update of this program on each recorded sample, with the laws and parameters named.",
}

SCENES = (
    Scene(
        NAME,
        TOUCHDOWN,
        "Cube tosses, measured",
        "A cube of 0.1 m, tossed onto a hard floor: when does the raised edge land, asked 40 ms before.",
        "two poses right before the touchdown, extrapolated to the floor",
        True,
    ),
    Scene(
        NAME,
        IMPACT,
        "Cube tosses, measured",
        "The same tosses: twist in the impact plane after the landing of an edge, published parameters.",
        "median of samples 2 to 4 after the touchdown, captured at 148 Hz",
        True,
    ),
)


class Record(NamedTuple):
    """The samples of all tosses and the cube."""

    body: Body
    samples: list[Sample]
    geometry: Geometry


def read(most: int) -> Record:
    """The first samples of the tosses that are shipped, at most so many.

    Raises:
        InputError: they are not installed.
    """
    body = Body.from_parameters(validate(read_parameters(find("config/cube_tosses.yaml"))))
    samples, geometry = list[Sample](), None
    for topic, _, data in read_messages(find("examples/cube_tosses"), TOPICS):
        if topic != "/cube/odom":
            geometry = decode_polygon(data)
        elif len(samples) < most:
            samples.append(decode_odometry(data))
    assert geometry is not None
    return Record(body._replace(samples=0, margins=False), samples, geometry)


VARIANTS = 6


def variants(body: Body) -> Iterator[tuple[str, Body]]:
    """The predictor with other laws and parameters."""
    yield "path law, slip across", body
    yield "path law", body._replace(transverse_slip=False)
    yield "total law", body._replace(law="total", transverse_slip=False)
    yield "path law, plastic", body._replace(restitution=0.0, transverse_slip=False)
    yield "total law, plastic", body._replace(restitution=0.0, law="total", transverse_slip=False)
    # The largest friction that is allowed holds any contact.
    yield "no slip", body._replace(friction=100.0, restitution=0.0, transverse_slip=False)


class Replayed(NamedTuple):
    """us of each sample that announced a touchdown, and the scores."""

    us: list[float]
    scores: list[Score]


def replay(body: Body, record: Record) -> Replayed:
    """All samples through a predictor; only those that announce a touchdown are timed."""
    predictor = Predictor(body)
    predictor.set_geometry(record.geometry)
    us, scores = [], []
    for sample in record.samples:
        began = process_time_ns()
        prediction = predictor.update(sample)
        taken = process_time_ns() - began
        if prediction.touchdown is not None:
            us.append(taken * 1e-3)
        if prediction.score is not None:
            scores.append(prediction.score)
    return Replayed(us, [score for score in [*scores, *predictor.finish()] if score.scored])


def impact_rows(record: Record, runs: int, tell: Callable[[], None] = lambda: None) -> list[Row]:
    """The predictor's variants, in turns; of each sample the fastest run counts."""
    named = dict(variants(record.body))
    results: dict[str, list[Replayed]] = {name: [] for name in named}
    with undisturbed():
        for _ in range(runs):
            for name, body in named.items():
                results[name].append(replay(body, record))
                tell()
    rows = []
    for name, replays in results.items():
        us = sorted(map(min, zip(*(each.us for each in replays), strict=True)))
        errors = [inf if score.relative_error is None else score.relative_error for score in replays[0].scores]
        rows.append(
            Row(
                IMPACT,
                NAME,
                "predictor",
                name,
                "",
                median(us),
                us[len(us) * 9 // 10],
                None,
                quantiles(errors),
                None,
                len(errors),
                0,
            )
        )
    return rows


class Seen(NamedTuple):
    """A landing as a planar body shows it ahead, and the time from then until it was measured (s)."""

    fall: Falling
    time: float


def landings(record: Record) -> list[Seen]:
    """The scored landings, each from the sample nearest to 40 ms before it."""
    samples, body, points = record.samples, record.body, record.geometry.points
    stamps = [sample.stamp for sample in samples]
    found = []
    for score in replay(body, record).scores:
        old, new = score.touchdown.old, score.touchdown.new
        landed = touched(record, bisect_left(stamps, score.stamp), old, new)
        if landed is None:
            continue
        first = bisect_left(stamps, landed - AHEAD * NANOSECONDS)
        fall = falling_of(body, points, samples[first], old, new)
        age = 0.5 * body.twist_window
        if fall is not None:
            found.append(Seen(fall, (landed - stamps[first]) / NANOSECONDS + age))
    return found


def touched(record: Record, index: int, old: Sequence[int], new: Sequence[int]) -> float | None:
    """When the new points touch (ns), by the last two samples that are clear of the floor, in free air or turning."""
    body, points = record.body, record.geometry.points

    def gap(sample: Sample) -> float:
        gaps = posture_of(body, points, sample).gaps
        return sum(gaps[i] for i in new) / len(new) - sum(gaps[i] for i in old) / len(old)

    while index > 2 and gap(record.samples[index]) <= 2.0 * body.tolerance:
        index -= 1
    last, before = record.samples[index], record.samples[index - 1]
    above, higher = gap(last), gap(before)
    if not 0.0 < above < higher:
        return None
    return last.stamp + (last.stamp - before.stamp) * above / (higher - above)


def falling_of(
    body: Body, points: Sequence[tuple[float, float, float]], sample: Sample, old: Sequence[int], new: Sequence[int]
) -> Falling | None:
    """A sample as the planar body that it is on these contacts; None where it stands otherwise."""
    posture = posture_of(body, tuple(points), sample)
    contacts = contacts_of(body, posture)
    if contacts is None or tuple(contacts.old) != tuple(old) or tuple(contacts.new) != tuple(new):
        return None
    plane = plane_of(body, tuple(points), sample, posture, contacts)
    if plane.old is None:
        return None
    vx, vy, omega = plane.twist
    inertia = inertia_about(body, plane.axis, blocked=len(old) > 1)
    # Both contacts are level at angle 0. An averaged twist is that of half its window ago: so is the pose, put back.
    (ax, ay), (bx, by) = plane.old, plane.new
    angle, age = atan2(by - ay, bx - ax), 0.5 * body.twist_window
    c, s = cos(angle), sin(angle)
    level = (c * ax + s * ay, c * ay - s * ax), (c * bx + s * by, c * by - s * bx)
    state = PlanarState(-vx * age, -ay - vy * age, angle - omega * age, vx, vy, omega)
    return Falling(state, level, 0, inertia / body.mass, body.friction, plane.gravity[:2])
