"""Landings of feet that are driven along known courses: found, in time, once, and never where there are none."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
import pytest
from walker_times import noisy

from impact_predictor.prediction.checks import PAUSE
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import (
    Bound,
    Geometry,
    Leftover,
    Prediction,
    Sample,
    Schedule,
    Score,
    Status,
    Vector3,
    Wrench,
)
from impact_predictor.prediction.vectors import add, axes_of, cross, to_body, turned
from impact_predictor.scenarios.comparison import Comparison

MS = 1_000_000
RATE = 400
START = 10**9
ZEROS = (0.0,) * 36
FEET = ("LF", "RF", "LH", "RH")
HIPS: tuple[Vector3, ...] = ((0.3, 0.3, 0.0), (0.3, -0.3, 0.0), (-0.3, 0.3, 0.0), (-0.3, -0.3, 0.0))
INERTIA = ((4.3, 0.0, 0.0), (0.0, 9.0, 0.0), (0.0, 0.0, 9.9))

Height = Callable[[float], tuple[float, float]]
"""Gap in m and its rate in m/s, at a time in s."""


class Message(NamedTuple):
    sample: Sample
    geometry: Geometry


def machine(feet: tuple[str, ...] = FEET, **walking: Any) -> Scene:
    return Scene(83.0, INERTIA, 0.8, frame="world", walking=Walking(feet, **walking))


BIPED = machine(("left", "right"), points=2)
SOLES: tuple[Vector3, ...] = ((-0.1, 0.1, 0.0), (0.1, 0.1, 0.0), (-0.1, -0.1, 0.0), (0.1, -0.1, 0.0))
"""Heel and toe of its left foot, and of its right one."""


def swing(lift: float, land: float, height: float = 0.08, speed: float = 0.0) -> Height:
    """A foot that is lifted and lowered by two cubics, between them at rest; it lands with a speed."""
    top = 0.5 * (lift + land)

    def at(time: float) -> tuple[float, float]:
        if not lift < time < land:
            return 0.0, 0.0
        begin, span = (lift, top - lift) if time < top else (top, land - top)
        s = (time - begin) / span
        if time < top:
            return height * s * s * (3.0 - 2.0 * s), height * 6.0 * s * (1.0 - s) / span
        fall = speed * span
        gap = height * (1.0 - s * s * (3.0 - 2.0 * s)) + fall * s * s * (1.0 - s)
        return gap, (-height * 6.0 * s * (1.0 - s) + fall * s * (2.0 - 3.0 * s)) / span

    return at


def stands(time: float) -> tuple[float, float]:
    return 0.0, 0.0


def record(
    courses: Iterable[Height],
    duration: float,
    rate: float = RATE,
    seed: int | None = None,
    places: tuple[Vector3, ...] = HIPS,
) -> list[Message]:
    """A base that drifts ahead and sways, over feet with known gaps; a seed puts noise on all of it."""
    rng = None if seed is None else np.random.default_rng(seed)
    messages = []
    courses = list(courses)
    for k in range(round(duration * rate)):
        time = k / rate
        stamp = START + round(time * 1e9)
        position = (0.2 * time, 0.0, 0.5 + 0.01 * math.sin(5.0 * time))
        linear = (0.2, 0.0, 0.05 * math.cos(5.0 * time))
        orientation = turned((0.0, 0.0, 0.0, 1.0), (0.02 * math.sin(4.0 * time), 0.0, 0.0))
        angular = (0.08 * math.cos(4.0 * time), 0.0, 0.0)
        axes = axes_of(orientation)
        points, velocities = [], []
        for (x, y, _), course in zip(places, courses, strict=True):
            gap, fall = course(time)
            point = to_body(axes, add((x, y, gap), position, -1.0))
            velocity = add(to_body(axes, add((0.0, 0.0, fall), linear, -1.0)), cross(angular, point), -1.0)
            points.append(point)
            velocities.append(velocity)
        twist = to_body(axes, linear)
        sample = Sample(stamp, "world", "base", position, orientation, twist, angular, ZEROS, ZEROS)
        geometry = Geometry(stamp, "base", tuple(points), tuple(velocities))
        messages.append(Message(sample, geometry) if rng is None else Message(*noisy(sample, geometry, rng)))
    return messages


class Seen(NamedTuple):
    predictions: list[Prediction]
    scores: list[Score]

    def announced(self, foot: int) -> list[tuple[float, float]]:
        """Times in s at which a landing of a foot was announced, and when it was to be."""
        return [
            ((one.sample.stamp - START) * 1e-9, (one.sample.stamp - START) * 1e-9 + lead_time)
            for one in self.predictions
            if (lead_time := one.feet[foot].lead_time) is not None
        ]


def walk(scene: Scene, messages: Iterable[Message]) -> Seen:
    walker = Predictor(scene)
    predictions = []
    for sample, geometry in messages:
        assert walker.tell(geometry) is Status.ACCEPTED
        predictions.append(walker.update(sample))
    scores = [one.score for one in predictions if one.score is not None]
    return Seen(predictions, [*scores, *walker.finish()])


@pytest.mark.parametrize("speed", [0.0, 0.05, 0.4])
@pytest.mark.parametrize("measured", [True, False])
def test_a_landing_is_announced_in_time_whether_the_foot_brakes_or_strikes(speed: float, measured: bool) -> None:
    messages = record([swing(0.3, 0.6, speed=speed), stands, stands, stands], 0.8)
    if not measured:
        messages = [one._replace(geometry=one.geometry._replace(velocities=())) for one in messages]
    seen = walk(machine(), messages)
    told = seen.announced(0)
    # Of a machine that has not landed yet nobody knows whether its feet strike or brake.
    assert told[0][0] < 0.6 - 0.035
    # A slow strike stays in doubt: it is told to brake to rest 2.5 ms later.
    assert max(abs(stamp - 0.6) for _, stamp in told) < (3e-3 if speed == 0.05 else 1.5e-3)
    (score,) = seen.scores
    assert score.landing is not None
    assert score.landing.foot == "LF"
    assert score.landing.stamp == pytest.approx(START + 600 * MS, abs=0.5 * MS)
    errors = [(0.6 - made, stamp - 0.6) for made, stamp in told]
    assert np.array(score.landing.history) == pytest.approx(np.array(errors), abs=0.5e-3)
    if speed == 0.0:
        # At its speed of now a foot that brakes evenly would be there in half the time.
        simple = [(ahead, error) for ahead, error in score.landing.gap_over_speed if ahead < 0.03]
        assert len(simple) > 5
        assert all(abs(error + 0.5 * ahead) < 0.1 * ahead + 2e-3 for ahead, error in simple)
    told_speeds = [one.feet[0].landing_speed for one in seen.predictions if one.feet[0].landing_speed is not None]
    assert told_speeds[-1] == pytest.approx(0.0 if speed == 0.05 else speed, abs=0.02)
    # Up to 2.5 ms before, or in the mean of the 2.5 ms before that, it still brakes at 20 m/s^2.
    assert score.landing.speed == pytest.approx(speed, abs=0.1)
    assert score.landing.impact is not None
    assert score.landing.impact.impulses[1][0] > 0.0
    assert score.touchdown.old == (1, 2, 3)
    assert Leftover.DRIVEN in score.leftover
    assert not score.scored
    assert not any(seen.announced(point) for point in (1, 2, 3))


def arc(shape: str, speed: float) -> Height:
    """A foot that swings 6 cm high from 0.3 s to 0.55 s along a curve that is no cubic; a quartic may strike."""
    begin, span, height = 0.3, 0.25, 0.06
    fall = speed * span
    # u^2, u^3 and u^4, with which the foot is at rest at first, half way up in the middle, and falls at the end.
    powers = np.linalg.solve([[1.0, 1.0, 1.0], [2.0, 3.0, 4.0], [0.25, 0.125, 0.0625]], [0.0, -fall, height])

    def gap(u: float) -> float:
        if shape == "quartic":
            return float(powers @ [u**2, u**3, u**4])
        if shape == "sine":
            return height * math.sin(math.pi * u)
        if shape == "cycloid":
            return 0.5 * height * (1.0 - math.cos(2.0 * math.pi * u))
        s = 1.0 - abs(2.0 * u - 1.0)  # Up and down with the least jerk.
        return height * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)

    def at(time: float) -> tuple[float, float]:
        u = (time - begin) / span
        if not 0.0 < u < 1.0:
            return 0.0, 0.0
        return gap(u), (gap(u + 1e-6) - gap(u - 1e-6)) / (2e-6 * span)

    return at


def rough(messages: Iterable[Message], deviation: float, seed: int = 0, measured: bool = False) -> list[Message]:
    """Messages with float32 points, with noise on all positions and twice as much (rad per m) on the orientation."""
    rng = np.random.default_rng(seed)
    made = []
    for sample, geometry in messages:
        points = np.array(geometry.points) + rng.normal(0.0, deviation, (len(geometry.points), 3))
        velocities = np.array(geometry.velocities) + rng.normal(0.0, 20.0 * deviation, (len(geometry.points), 3))
        x, y, z = (np.array(sample.position) + rng.normal(0.0, deviation, 3)).tolist()
        p, q, r = rng.normal(0.0, 2.0 * deviation, 3).tolist()
        base = sample._replace(position=(x, y, z), orientation=turned(sample.orientation, (p, q, r)))
        vectors = [tuple(map(tuple, one.astype(np.float32).tolist())) for one in (points, velocities)]
        made.append(Message(base, Geometry(geometry.stamp, "base", vectors[0], vectors[1] if measured else ())))
    return made


SHAPES = [("quartic", 0.0), ("quartic", 0.25), ("quartic", 0.5), ("sine", 0.75), ("cycloid", 0.0), ("least jerk", 0.0)]


@pytest.mark.parametrize("rate", [100.0, 200.0, 1000.0])
@pytest.mark.parametrize(("shape", "speed"), SHAPES)
@pytest.mark.parametrize("deviation", [0.0, 1e-5])
def test_a_swing_that_no_cubic_follows_is_announced_however_little_noise_there_is(
    shape: str, speed: float, rate: float, deviation: float
) -> None:
    messages = rough(record([arc(shape, speed), stands, stands, stands], 0.7, rate=rate), deviation)
    seen = walk(machine(), messages)
    told = seen.announced(0)
    assert told[0][0] < 0.55 - 0.04
    # What comes down like u^3 is within the tolerance, and slow, 20 ms before its curve ends.
    late = [abs(stamp - 0.55) for made, stamp in told if made > 0.53 - 1.0 / rate]
    assert max(late, default=0.0) < (0.02 if shape == "least jerk" else 0.0125)
    (score,) = seen.scores
    assert score.landing is not None
    assert score.landing.history
    assert score.landing.stamp == pytest.approx(START + 550 * MS, abs=(11 if shape == "least jerk" else 3) * MS)


@pytest.mark.parametrize(
    ("shape", "speed", "rate", "measured", "told", "lead"),
    [
        ("quartic", 0.25, 200.0, False, 0.9, 0.04),
        ("quartic", 0.25, 400.0, False, 0.95, 0.04),
        ("least jerk", 0.0, 200.0, True, 0.95, 0.04),
        # Without velocities such noise hides the end of a foot that creeps to the ground.
        ("least jerk", 0.0, 200.0, False, 0.6, 0.02),
    ],
)
def test_with_the_noise_of_sensors_on_base_feet_and_orientation_landings_are_announced_in_time(
    shape: str, speed: float, rate: float, measured: bool, told: float, lead: float
) -> None:
    step = arc(shape, speed)
    courses = [lambda time, late=late: step(0.3 + (time - late) % 0.6) for late in (0.2, 0.5, 0.5, 0.2)]
    lands = [[late + 0.25 + 0.6 * k for k in range(6)] for late in (0.2, 0.5, 0.5, 0.2)]
    # A fifth of the contact tolerance on each coordinate.
    seen = walk(machine(), rough(record(courses, 3.9, rate=rate), 1e-3, measured=measured))
    leads = []
    for point, own in enumerate(lands):
        announced = seen.announced(point)
        for land in own[1:]:
            made = [land - when for when, stamp in announced if when < land and abs(stamp - land) < 0.02]
            leads.append(max(made, default=0.0))
    assert sum(one > 0.0 for one in leads) >= told * len(leads)
    assert np.median(leads) >= lead


@pytest.mark.parametrize("measured", [True, False])
@pytest.mark.parametrize("deviation", [0.0, 1e-4])
def test_the_last_frame_in_the_air_is_one_in_the_air(measured: bool, deviation: float) -> None:
    course = arc("quartic", 0.35)
    for late in np.arange(0.0, 0.01, 1.1e-3).tolist():
        messages = record([lambda time, late=late: course(time - late), stands, stands, stands], 0.7, rate=200.0)
        (score,) = walk(machine(), rough(messages, deviation, measured=measured)).scores
        assert score.landing is not None
        # One frame before, 5 ms, a foot that brakes at 20 m/s^2 is faster by 0.1 m/s; noise adds as much.
        assert score.landing.speed == pytest.approx(0.4, abs=0.2)
        assert score.landing.stamp == pytest.approx(START + (550 + 1e3 * late) * MS, abs=3 * MS)


def test_a_landing_is_stamped_by_what_was_measured_after_it_and_not_by_what_was_announced() -> None:
    def stopped(time: float) -> tuple[float, float]:
        return (0.0, 0.0) if time > 0.57 else swing(0.3, 0.6)(time)

    seen = walk(machine(), record([stopped, stands, stands, stands], 0.8))
    (score,) = seen.scores
    assert score.landing is not None
    assert score.landing.stamp == seen.predictions[-1].feet[0].since == pytest.approx(START + 570 * MS, abs=3 * MS)
    assert score.landing.history[-1][1] == pytest.approx(0.03, abs=4e-3)


def test_a_foot_that_sinks_in_as_the_standing_ones_have_lands_when_it_touches() -> None:
    def sunk(course: Height) -> Height:
        return lambda time: (course(time)[0] - 6e-4, course(time)[1])

    courses = [sunk(one) for one in (swing(0.3, 0.6, speed=0.4), stands, stands, stands)]
    (score,) = walk(machine(), record(courses, 0.8)).scores
    assert score.landing is not None
    # It comes down with 0.4 m/s and brakes, so that it has touched 1.4 ms before it has sunk in.
    assert score.landing.stamp == pytest.approx(START + 598.6 * MS, abs=0.4 * MS)


def yielding(time_constant: float) -> Height:
    """A contact with critical damping that is stepped on with 0.6 m/s at 0.6 s: it sinks in, and comes back slowly."""

    def course(time: float) -> tuple[float, float]:
        if time < 0.6:
            return swing(0.3, 0.6, speed=0.6)(time)
        t = (time - 0.6) / time_constant
        return -0.6 * (time - 0.6) * math.exp(-t), -0.6 * (1.0 - t) * math.exp(-t)

    return course


@pytest.mark.parametrize("time_constant", [0.01, 0.02, 0.03])
@pytest.mark.parametrize("rate", [400.0, 1000.0])
def test_a_foot_on_soft_ground_lands_when_that_begins_to_brake_it(rate: float, time_constant: float) -> None:
    (score,) = walk(machine(), record([yielding(time_constant), stands, stands, stands], 0.9, rate=rate)).scores
    assert score.stamp == pytest.approx(START + 600 * MS, abs=0.8 * MS)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("time_constant", [0.02, 0.025])
def test_in_noise_feet_land_on_soft_ground_once_each_and_when_they_touch_it(time_constant: float, seed: int) -> None:
    step = yielding(time_constant)
    courses = [lambda time, late=late: step(0.3 + (time - late) % 0.6) for late in (0.2, 0.5, 0.5, 0.2)]
    scores = walk(machine(), rough(record(courses, 2.9), 1e-3, seed, measured=True)).scores
    assert len(scores) == 18
    # They land at 0.5 s, 0.8 s and so on, and have stopped one time constant later.
    late = np.array([((score.stamp - START) / MS - 350.0) % 300.0 - 150.0 for score in scores])
    assert np.median(np.abs(late)) < 2.5
    assert np.max(np.abs(late)) < 15.0


@pytest.mark.parametrize("rises", [0.0, 0.02])
def test_a_foot_that_slips_off_an_edge_has_landed_there_unless_it_rises_in_between(rises: float) -> None:
    def course(time: float) -> tuple[float, float]:
        if time < 0.6:
            gap, rate = swing(0.3, 0.6, speed=0.6)(time)
            return gap + 0.03 * min(1.0, max(0.0, (time - 0.3) / 0.05)), rate
        if time < 0.615:
            return 0.03, 0.0
        # It comes further down in 0.06 s, evenly or over a hop.
        part = (time - 0.615) / 0.06
        hop = 4.0 * rises * part * (1.0 - part)
        return (
            (0.03 * (1.0 - part) + hop, (4.0 * rises * (1.0 - 2.0 * part) - 0.03) / 0.06) if part < 1.0 else (0.0, 0.0)
        )

    (score,) = walk(machine(), record([course, stands, stands, stands], 0.9)).scores
    assert score.stamp == pytest.approx(START + (675 if rises else 600) * MS, abs=2.0 * MS)


def test_a_landing_that_was_not_announced_is_told_without_a_history() -> None:
    def drops(time: float) -> tuple[float, float]:
        if not 0.3 < time < 0.5:
            return 0.0, 0.0
        return (0.02, 0.0) if time < 0.4975 else (0.02 - 8.0 * (time - 0.4975), -8.0)

    (score,) = walk(machine(), record([drops, stands, stands, stands], 0.8)).scores
    assert score.landing is not None
    assert score.landing.foot == "LF"
    assert score.landing.history == ()
    assert score.landing.stamp == pytest.approx(START + 500 * MS, abs=10 * MS)


@pytest.mark.parametrize(("deviation", "late"), [(0.0, 3.0), (1e-3, 20.0)])
def test_a_swing_is_dated_back_to_when_the_foot_left_the_ground(deviation: float, late: float) -> None:
    messages = rough(record([swing(0.3, 0.6), stands, stands, stands], 0.5), deviation)
    foot = walk(machine(), messages).predictions[-1].feet[0]
    assert not foot.stands
    # It lifts by 10 m/s^2 t^2, out of the tolerance of 5 mm after 22 ms, and out of the noise after less.
    assert -3.0 <= (foot.since - START) / MS - 300.0 <= late


def test_a_foot_that_only_comes_down_a_little_lands_nowhere() -> None:
    def dips(time: float) -> tuple[float, float]:
        return 0.06 + 0.03 * math.cos(12.0 * time), -0.36 * math.sin(12.0 * time)

    seen = walk(machine(), record([dips, stands, stands, stands], 2.0))
    assert seen.announced(0) == []
    assert not any(one.feet[0].stands for one in seen.predictions)
    assert seen.scores == []


@pytest.mark.parametrize("seed", range(4))
def test_with_noise_on_everything_all_landings_are_found_and_no_other(seed: int) -> None:
    lands = [0.7, 1.3, 1.9, 2.5]

    def steps(first: float) -> Height:
        swings = [swing(land - 0.3 + first, land + first) for land in lands]
        return lambda time: max((one(time) for one in swings), key=lambda course: course[0])

    courses = [steps(0.0), steps(0.3), steps(0.3), steps(0.0)]
    seen = walk(machine(), record(courses, 3.1, seed=seed))
    landings = [score.landing for score in seen.scores if score.landing is not None]
    assert sorted(one.foot for one in landings) == sorted(FEET * len(lands))
    for point, first in enumerate((0.0, 0.3, 0.3, 0.0)):
        told = seen.announced(point)
        # 20 ms is what an announced landing may be off to be that of a true one; a first guess may be off by more.
        assert all(min(abs(stamp - land - first) for land in lands) < 0.025 for _, stamp in told)
        for land in lands:
            assert any(abs(stamp - land - first) < 0.02 and seen <= land + first - 0.03 for seen, stamp in told)


def test_a_foot_that_lifts_for_less_than_the_dead_time_has_stood_all_along() -> None:
    def hops(time: float) -> tuple[float, float]:
        return (0.008, 0.0) if 0.3 <= time < 0.31 else (0.0, 0.0)

    seen = walk(machine(), record([hops, stands, stands, stands], 0.6))
    assert all(one.feet[0].stands for one in seen.predictions)
    assert all(one.feet[0].since == 0 for one in seen.predictions)


def test_feet_that_start_in_the_air_swing_from_the_first_sample_and_land() -> None:
    seen = walk(machine(), record([swing(-0.15, 0.15), stands, stands, swing(-0.15, 0.15)], 0.4))
    first, last = seen.predictions[0].feet, seen.predictions[-1].feet
    assert [foot.stands for foot in first] == [False, True, True, False]
    assert all(foot.stands for foot in last)
    assert sorted(score.landing.foot for score in seen.scores if score.landing) == ["LF", "RH"]
    # Feet that land together strike together: each is the old contact of the other.
    assert {(score.touchdown.old, score.touchdown.new) for score in seen.scores} == {((0,), (3,)), ((3,), (0,))}


@pytest.mark.parametrize("apart", [0.0, 0.003])
def test_feet_that_land_together_make_one_impact(apart: float) -> None:
    courses = [swing(0.3, 0.6, speed=0.4), stands, stands, swing(0.3, 0.6 + apart, speed=0.3)]
    seen = walk(machine(), record(courses, 0.8, places=((0.3, 0.2, 0.0), *HIPS[1:])))
    told = [one.touchdown for one in seen.predictions if one.touchdown is not None]
    # Of two that land at once either may be told first.
    assert {(one.old, one.new) for one in told[20:-5]} <= {((3,), (0,)), *([] if apart else [((0,), (3,))])}
    assert {tuple((it.point, it.is_new) for it in one.contacts) for one in told[20:-5]} == {
        ((0, True), (1, False), (2, False), (3, True))
    }
    assert [score.touchdown.new for score in seen.scores] == [(0,), (3,)]
    one, other = (score.landing.impact for score in seen.scores if score.landing and score.landing.impact)
    assert (one.old, one.new) == (other.new, other.old) == ((3,), (0,))
    if apart == 0.0:
        assert one.linear == pytest.approx(other.linear, abs=1e-9)
        assert one.angular == pytest.approx(other.angular, abs=1e-9)
        first, second = (score.touchdown for score in seen.scores)
        assert first.linear == pytest.approx(second.linear, abs=1e-9)


def test_of_feet_that_land_shortly_after_each_other_both_impacts_begin_with_the_twist_before_the_first() -> None:
    jump = (0.0, 0.0, 0.2)
    messages = []
    for sample, geometry in record([swing(0.3, 0.6, speed=0.4), stands, stands, swing(0.3, 0.604, speed=0.3)], 0.8):
        if sample.stamp >= START + 600 * MS:
            # The impact changes the twist of the base; the feet move on as before.
            up = to_body(axes_of(sample.orientation), jump)
            sample = sample._replace(linear=add(sample.linear, up))
            geometry = geometry._replace(velocities=tuple(add(one, up, -1.0) for one in geometry.velocities))
        messages.append(Message(sample, geometry))
    one, other = (score.landing.impact for score in walk(machine(), messages).scores if score.landing is not None)
    assert one is not None
    assert other is not None
    assert (one.old, one.new) == (other.new, other.old) == ((3,), (0,))
    # Both are told from the same frame; when the other one lands was predicted for the first, and seen for the second.
    assert one.linear == pytest.approx(other.linear, abs=1e-3)
    assert one.angular == pytest.approx(other.angular, abs=1e-3)


def test_a_foot_that_lands_sooner_stands_when_the_next_one_lands() -> None:
    courses = [swing(0.3, 0.6), swing(0.3, 0.56), stands, stands]
    seen = walk(machine(), record(courses, 0.8))
    told = {score.touchdown.new: score.touchdown.old for score in seen.scores}
    assert told == {(1,): (2, 3), (0,): (1, 2, 3)}
    # Between its landing and the end of the dead time, too, when the soonest landing ahead is that of the other foot.
    between = [one for one in seen.predictions if START + 562 * MS < one.sample.stamp < START + 578 * MS]
    assert {one.touchdown.old for one in between if one.touchdown is not None} == {(1, 2, 3)}
    assert all(one.feet[1].stands for one in between)


def test_a_foot_that_rises_already_carries_nothing_and_no_impact_meets_it() -> None:
    courses = [swing(0.3, 0.6, speed=0.3), stands, swing(0.585, 0.9), stands]
    seen = walk(machine(), record(courses, 0.7))
    last = [one for one in seen.predictions if one.sample.stamp < START + 600 * MS][-1]
    assert last.feet[2].stands  # for its dead time
    assert last.touchdown is not None
    assert last.touchdown.old == (1, 3)
    assert [foot.impulse is None for foot in last.feet] == [False, False, True, False]
    assert {foot.bound for foot in last.feet} == {None, Bound.UPPER}


def test_the_toe_of_a_foot_that_has_just_landed_on_its_heel_makes_no_false_alarm() -> None:
    courses = [swing(0.3, 0.6, speed=0.2), swing(0.3, 0.68, height=0.12), stands, stands]
    scene = BIPED
    walker, landings = Predictor(scene), Comparison({"": scene})
    for sample, geometry in record(courses, 0.9, places=SOLES):
        landings.add_stances("base", sample.stamp, (not START + 300 * MS < sample.stamp < START + 600 * MS, True))
        walker.tell(geometry)
        landings.add(walker.update(sample))
    (landing,) = landings.compare().matches
    assert landing.stamp is not None
    assert landing.predictions


def test_heel_and_toe_strike_one_after_the_other_and_the_foot_stands_from_the_first() -> None:
    courses = [swing(0.3, 0.6), swing(0.3, 0.68, height=0.12), stands, stands]
    seen = walk(BIPED, record(courses, 0.9, places=SOLES))
    heel, toe = seen.scores
    assert heel.touchdown.new == (0,)
    assert heel.touchdown.old == (2, 3)
    assert [one.landing.point for one in seen.scores if one.landing is not None] == ["heel", "toe"]
    assert toe.touchdown.new == (1,)
    assert toe.touchdown.old == (0,)
    foot = seen.predictions[-1].feet[0]
    assert foot.stands
    assert foot.since == pytest.approx(START + 600 * MS, abs=MS)


def test_a_sole_lands_with_the_mean_velocity_of_heel_and_toe() -> None:
    courses = [swing(0.3, 0.6, speed=0.2), swing(0.3, 0.6, speed=0.5), stands, stands]
    (score,) = walk(BIPED, record(courses, 0.9, places=SOLES)).scores
    assert score.landing is not None
    assert score.touchdown.new == (0, 1)
    # In the last frame before, at most 2.5 ms, they brake at 20 m/s^2.
    assert score.landing.speed == pytest.approx(0.35, abs=0.05)


def test_a_foot_that_sinks_into_soft_ground_lands_where_it_comes_to_rest() -> None:
    def sinks(time: float) -> tuple[float, float]:
        if time < 0.3:
            return swing(0.0, 0.3)(time)
        return (-0.08 * (time - 0.3), -0.08) if time < 0.7 else (-0.032, 0.0)

    (score,) = walk(machine(), record([sinks, stands, stands, stands], 0.9, rate=1000.0)).scores
    assert score.stamp == pytest.approx(START + 700 * MS, abs=MS)


def test_landings_are_told_late_or_early_against_the_plan() -> None:
    walker = Predictor(machine(has_schedule=True))
    swings, stance = (False, True, True, True), (True,) * 4
    times = (START + 300 * MS, START + 580 * MS)
    assert walker.tell(Schedule(START, FEET, times, (swings, stance))) is Status.ACCEPTED
    late, scores = [], []
    for sample, geometry in record([swing(0.3, 0.6), stands, stands, stands], 0.8):
        walker.tell(geometry)
        prediction = walker.update(sample)
        late += [foot.late for foot in prediction.feet[:1] if foot.lead_time is not None]
        scores += [prediction.score] if prediction.score else []
    assert late == pytest.approx([0.02] * len(late), abs=1e-3)
    assert scores[0].landing is not None
    assert scores[0].landing.late == pytest.approx(0.02, abs=1e-3)
    assert all(foot.late is None for foot in prediction.feet[1:])


def test_a_force_sensor_confirms_and_never_decides() -> None:
    messages = record([swing(0.3, 0.6), stands, stands, stands], 0.8)
    walker, blind = Predictor(machine(force=20.0)), Predictor(machine())
    for sample, geometry in messages:
        pressed = (0.0, 0.0, 0.0 if 300 * MS < sample.stamp - START < 600 * MS else 200.0)
        assert walker.tell(Wrench(sample.stamp, "LF", pressed)) is Status.ACCEPTED
        assert walker.tell(Wrench(sample.stamp, "RF", (0.0, 0.0, 1.0))) is Status.ACCEPTED
        walker.tell(geometry)
        blind.tell(geometry)
        left, right, *others = walker.update(sample).feet
        assert [foot.stands for foot in (left, right, *others)] == [foot.stands for foot in blind.update(sample).feet]
        assert right.confirmed is False
        assert [foot.confirmed for foot in others] == [None, None]
    assert left.confirmed is True
    assert walker.tell(Wrench(START, "nose", (0.0, 0.0, 1.0))) is Status.WRONG_FRAME
    assert walker.tell(Wrench(START + 10**10, "LF", (math.nan, 0.0, 1.0))) is Status.NOT_FINITE


@pytest.mark.parametrize("offset", [-1.1, 0.7])
def test_geometry_between_the_samples_is_carried_with_the_base(offset: float) -> None:
    courses = [swing(0.3, 0.6), stands, stands, stands]
    fast = record(courses, 0.8, rate=RATE * 25)
    samples, feet = fast[500::25], fast[500 + round(10 * offset) :: 25]
    walker, told = Predictor(machine()), []
    messages = sorted([one.sample for one in samples] + [one.geometry for one in feet], key=lambda one: one.stamp)
    for message in messages:
        if isinstance(message, Geometry):
            walker.tell(message)
        else:
            feet = walker.update(message).feet
            told += [message.stamp + round(one.lead_time * 1e9) for one in feet if one.lead_time]
    assert len(told) > 30
    # A base that is carried 1 ms at constant velocity is wrong by 0.1 um; 0.1 s ahead that makes 3 ms.
    assert told == pytest.approx([START + 600 * MS] * len(told), abs=4 * MS)


def test_odd_messages_get_a_named_status_and_the_walker_goes_on() -> None:
    messages = record([swing(0.3, 0.6), stands, stands, stands], 0.8)
    walker = Predictor(machine())
    sample, geometry = messages[0]
    assert walker.update(sample).status is Status.NO_GEOMETRY
    assert walker.tell(geometry._replace(points=geometry.points[:3])) is Status.FEET_CHANGED
    assert walker.tell(geometry._replace(velocities=geometry.velocities[:3])) is Status.FEET_CHANGED
    broken = ((math.nan, 0.0, 0.0), *geometry.points[1:])
    assert walker.tell(geometry._replace(points=broken)) is Status.NOT_FINITE
    told = []
    for sample, geometry in messages:
        assert walker.tell(geometry) is Status.ACCEPTED
        assert walker.tell(geometry) is Status.STAMP_REPEATED
        assert walker.tell(geometry._replace(stamp=geometry.stamp - MS)) is Status.STAMP_WENT_BACK
        assert walker.tell(geometry._replace(stamp=geometry.stamp + 1, points=broken)) is Status.NOT_FINITE
        assert walker.update(sample._replace(child_frame_id="cube")).status is Status.WRONG_FRAME
        prediction = walker.update(sample)
        assert prediction.status is Status.ACCEPTED
        told += [sample.stamp + round(one.lead_time * 1e9) - START for one in prediction.feet if one.lead_time]
    assert told == pytest.approx([600 * MS] * len(told), abs=0.5 * MS)


def test_feet_far_below_the_ground_are_refused() -> None:
    messages = record([stands] * 4, 0.2)
    walker = Predictor(machine())
    sunk = [
        one._replace(sample=one.sample._replace(position=add(one.sample.position, (0.0, 0.0, -0.2))))
        for one in messages
    ]
    for sample, geometry in sunk[:20]:
        walker.tell(geometry)
        prediction = walker.update(sample)
        assert prediction.status is Status.BELOW_GROUND
        assert prediction.feet == ()
    for sample, geometry in messages[20:]:
        walker.tell(geometry)
        assert walker.update(sample).status is Status.ACCEPTED


def test_feet_that_are_told_no_more_are_stale() -> None:
    messages = record([stands] * 4, 0.4)
    walker = Predictor(machine(timeout=0.1))
    walker.tell(messages[0].geometry)
    statuses = [walker.update(one.sample).status for one in messages]
    assert statuses == [Status.ACCEPTED] * 41 + [Status.GEOMETRY_STALE] * (len(messages) - 41)
    walker.tell(messages[-1].geometry)
    assert walker.update(messages[-1].sample).status is Status.ACCEPTED


def test_after_a_pause_or_a_new_clock_the_feet_are_learnt_anew() -> None:
    messages = record([swing(0.3, 0.6), stands, stands, stands], 0.8)
    later = PAUSE + 10**9
    shifted = [Message(s._replace(stamp=s.stamp + later), g._replace(stamp=g.stamp + later)) for s, g in messages]
    seen = walk(machine(), messages[:200] + shifted)
    assert len(seen.scores) == 1
    walker = Predictor(machine())
    for sample, geometry in messages:
        walker.tell(geometry)
        walker.update(sample)
    assert walker.tell(messages[0].geometry) is Status.STAMP_WENT_BACK
    scores = []
    for sample, geometry in messages[1:]:
        walker.tell(geometry)
        prediction = walker.update(sample)
        assert prediction.status is Status.ACCEPTED
        scores += [prediction.score] if prediction.score else []
    assert len(scores) == 1


def test_a_record_that_ends_at_the_landing_still_tells_of_it() -> None:
    messages = record([swing(0.3, 0.6), stands, stands, stands], 0.8, rate=50.0)
    seen = walk(machine(), messages[:32])
    (score,) = seen.scores
    assert score.landing is not None
    assert score.measured is None
    assert Leftover.TOO_SHORT in score.leftover


def test_landings_whose_turn_did_not_come_before_a_pause_are_told_measured_with_the_samples_after_it() -> None:
    messages = record([swing(0.3, 0.6), swing(0.3, 0.6), stands, stands], 0.8)
    told = next(k for k, one in enumerate(walk(machine(), messages).predictions) if one.score is not None)
    later = PAUSE + 10**9
    rest = [Message(s._replace(stamp=s.stamp + later), g._replace(stamp=g.stamp + later)) for s, g in messages[:2]]
    after = [one.score for one in walk(machine(), messages[: told + 1] + rest).predictions[told:]]
    feet = [score.landing.foot for score in after if score is not None and score.landing is not None]
    assert feet == ["LF", "RF"]
    assert all(score.measured is not None for score in after if score is not None)


def test_stamps_of_one_instant_break_no_fit() -> None:
    messages = record([swing(0.3, 0.6), stands, stands, stands], 0.8)
    crowded = []
    for k, (sample, geometry) in enumerate(messages):
        stamp = START + k // 6 * 15 * MS + k % 6
        crowded.append(Message(sample._replace(stamp=stamp), geometry._replace(stamp=stamp)))
    for one in walk(machine(), crowded).predictions:
        assert one.status is Status.ACCEPTED
        assert all(foot.lead_time is None or math.isfinite(foot.lead_time) for foot in one.feet)


def test_balls_touch_with_their_lowest_points() -> None:
    messages = record([swing(0.3, 0.6, speed=0.3), stands, stands, stands], 0.8)
    raised = []
    for sample, geometry in messages:
        up = to_body(axes_of(sample.orientation), (0.0, 0.0, 0.02))
        raised.append(Message(sample, geometry._replace(points=tuple(add(one, up) for one in geometry.points))))
    points, balls = walk(machine(), messages), walk(machine(radius=(0.02,)), raised)
    assert np.array(balls.announced(0)) == pytest.approx(np.array(points.announced(0)), abs=1e-6)
    # Without their radius the feet are seen to stand as high.
    unknown = walk(machine(), raised)
    assert [foot.stands for foot in unknown.predictions[-1].feet] == [True] * 4
    (score,) = unknown.scores
    assert score.landing is not None
    assert score.landing.stamp == pytest.approx(START + 600 * MS, abs=MS)


def test_feet_step_down_below_the_ground_of_the_scene() -> None:
    def deep(time: float) -> tuple[float, float]:
        gap, rate = swing(0.3, 0.6)(time)
        part = min(1.0, max(0.0, (time - 0.3) / 0.3))
        return gap - 0.12 * part, rate - (0.4 if 0.0 < part < 1.0 else 0.0)

    messages = record([deep, stands, stands, stands], 0.8)
    seen = walk(machine(), messages)
    assert {one.status for one in seen.predictions} == {Status.ACCEPTED}
    (score,) = seen.scores
    assert score.landing is not None
    assert score.landing.stamp == pytest.approx(START + 600 * MS, abs=2 * MS)
