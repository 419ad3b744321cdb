"""Odd input to the predictor: a named status, and it goes on; never an exception, never a NaN."""

from __future__ import annotations

import math
import re
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from impact_predictor.errors import InputError
from impact_predictor.prediction.checks import PAUSE
from impact_predictor.prediction.flaws import flaw_of
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Geometry, Imu, Prediction, Sample, Status, Transform, Vector3

ZEROS = (0.0,) * 36
POSE = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


def flying_sample(stamp: int = 0, **changes: Any) -> Sample:
    """A cube above the floor that turns and comes down."""
    sample = Sample(
        stamp, "map", "cube", (0.0, 0.0, 0.2), (0.0, 0.0, 0.0, 1.0), (0.1, 0.0, -1.0), (0.0, 2.0, 0.0), ZEROS, ZEROS
    )
    return sample._replace(**changes)


CUBE: tuple[Vector3, ...] = tuple((x, y, z) for x, y, z in product((-0.05, 0.05), repeat=3))
CUBE_SCENE = Scene(1.0, ((0.002, 0.0, 0.0), (0.0, 0.002, 0.0), (0.0, 0.0, 0.002)), 0.3, points=CUBE)
BARE_SCENE = CUBE_SCENE._replace(points=())


def with_bad_number(sample: Sample, field: str, index: int, bad: float) -> Sample:
    numbers = list(getattr(sample, field))
    numbers[index] = bad
    changed: dict[str, Any] = {field: tuple(numbers)}
    return sample._replace(**changed)


def goes_on(predictor: Predictor, stamp: int = 1_000_000) -> bool:
    """Whether a good sample is answered in full after a bad one."""
    prediction = predictor.update(flying_sample(stamp))
    return prediction.status is Status.ACCEPTED and prediction.touchdown is not None


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(
    ("field", "count"),
    [
        ("position", 3),
        ("orientation", 4),
        ("linear", 3),
        ("angular", 3),
        ("pose_covariance", 36),
        ("twist_covariance", 36),
    ],
)
def test_a_number_that_is_none_is_refused_in_any_field(field: str, count: int, bad: float) -> None:
    for index in range(count):
        predictor = Predictor(CUBE_SCENE)
        sample = with_bad_number(flying_sample(), field, index, bad)
        assert predictor.update(sample) == Prediction(Status.NOT_FINITE, sample)
        assert goes_on(predictor)


@pytest.mark.parametrize("told", [list, np.array, np.float32])
def test_a_sample_of_lists_or_arrays_is_that_of_their_numbers(told: Any) -> None:
    sample = flying_sample(position=(0.25, 0.0, 0.125))
    fields = ("position", "orientation", "linear", "angular", "pose_covariance", "twist_covariance")
    numbers = {name: told(getattr(sample, name)) for name in fields}
    other = Predictor(CUBE_SCENE).update(sample._replace(stamp=np.int64(0), **numbers))
    assert other.touchdown is not None
    lead_time = Predictor(CUBE_SCENE).update(sample).touchdown.lead_time
    assert other.touchdown.lead_time == pytest.approx(lead_time, rel=1e-6 if told is np.float32 else 1e-15)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"position": None}, "position of a sample is None; give 3 numbers"),
        ({"linear": (0.0, 1.0)}, "linear of a sample is (0.0, 1.0); give 3 numbers"),
        ({"twist_covariance": 0.1}, "twist_covariance of a sample is 0.1; give 36 numbers"),
        ({"stamp": 4e9}, "the stamp of a sample is 4000000000.0; give whole nanoseconds"),
    ],
)
def test_a_field_without_numbers_is_named(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=re.escape(sentence)):
        Predictor(CUBE_SCENE).update(flying_sample(**changes))


def test_numbers_that_no_body_has_are_refused() -> None:
    predictor = Predictor(CUBE_SCENE)
    for field in ("position", "linear", "angular"):
        sample = with_bad_number(flying_sample(), field, 0, 1e200)
        assert predictor.update(sample).status is Status.NOT_FINITE
    assert goes_on(predictor)


def test_an_unknown_covariance_may_be_the_largest_double() -> None:
    unknown = (1.7976931348623157e308,) * 36
    predictor = Predictor(CUBE_SCENE)
    assert predictor.update(flying_sample(pose_covariance=unknown)).status is Status.ACCEPTED
    assert predictor.update(flying_sample(1, twist_covariance=unknown)).status is Status.ACCEPTED


@pytest.mark.parametrize(
    ("orientation", "status"),
    [
        ((0.0, 0.0, 0.0, 0.0), Status.BAD_QUATERNION),
        ((0.0, 0.0, 0.0, 1.001), Status.BAD_QUATERNION),
        ((0.0, 0.0, 0.0, 0.999), Status.BAD_QUATERNION),
        ((1e200, 0.0, 0.0, 0.0), Status.BAD_QUATERNION),
        ((0.0, 0.0, 0.0, 1.0002), Status.ACCEPTED),
        ((0.0, 0.0, 0.0, -1.0), Status.ACCEPTED),
    ],
)
def test_an_orientation_must_be_a_unit_quaternion(orientation: Any, status: Status) -> None:
    predictor = Predictor(CUBE_SCENE)
    prediction = predictor.update(flying_sample(orientation=orientation))
    assert prediction.status is status
    if prediction.touchdown is not None:
        assert math.hypot(*prediction.touchdown.orientation) == pytest.approx(1.0, abs=1e-15)
    assert goes_on(predictor)


def test_a_stamp_a_little_back_is_refused_until_the_clock_has_caught_up() -> None:
    predictor = Predictor(CUBE_SCENE)
    assert predictor.update(flying_sample(PAUSE)).status is Status.ACCEPTED
    for stamp in (PAUSE - 1, 0):
        assert predictor.update(flying_sample(stamp)).status is Status.STAMP_WENT_BACK
    assert predictor.update(flying_sample(PAUSE)).status is Status.STAMP_REPEATED
    assert goes_on(predictor, PAUSE + 1)


def test_a_clock_that_starts_anew_costs_one_sample() -> None:
    predictor = Predictor(CUBE_SCENE)
    assert predictor.update(flying_sample(2 * PAUSE)).status is Status.ACCEPTED
    assert predictor.update(flying_sample(PAUSE - 1)).status is Status.STAMP_WENT_BACK
    assert predictor.update(flying_sample(PAUSE - 1)).status is Status.ACCEPTED


def test_one_stamp_far_in_the_future_does_not_stop_the_predictor_for_long() -> None:
    predictor = Predictor(CUBE_SCENE)
    statuses = [predictor.update(flying_sample(stamp)).status for stamp in (1, 2, 10**18, 3, 4, 5)]
    assert statuses.count(Status.STAMP_WENT_BACK) == 1
    assert statuses[-2:] == [Status.ACCEPTED, Status.ACCEPTED]


def test_the_geometry_must_be_of_the_samples_body() -> None:
    predictor = Predictor(BARE_SCENE)
    assert predictor.tell(Geometry(0, "crate", CUBE)) is Status.ACCEPTED
    assert predictor.update(flying_sample()).status is Status.WRONG_FRAME
    assert predictor.update(flying_sample(child_frame_id="")).status is Status.ACCEPTED
    assert predictor.tell(Geometry(0, "cube", CUBE)) is Status.ACCEPTED
    assert goes_on(predictor)


@pytest.mark.parametrize(
    ("points", "status"),
    [
        ((), Status.TOO_FEW_POINTS),
        (((0.0, 0.0, 0.0),), Status.TOO_FEW_POINTS),
        (((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), Status.COINCIDENT_POINTS),
        (((0.0, 5e-10, 0.0), (0.5, 0.0, 0.0), (4e-10, 0.0, 1.0), (6e-10, 0.0, 0.0)), Status.COINCIDENT_POINTS),
        (tuple((0.1 * k, 0.0, 0.0) for k in range(1001)), Status.TOO_MANY_POINTS),
        (((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1e-12, 0.0)), Status.COINCIDENT_POINTS),
        (((0.1, 0.0, 0.0), (0.1, 1e-10, 0.0)), Status.COINCIDENT_POINTS),
        (((1.0, 0.0, 0.0), (math.nan, 1.0, 0.0)), Status.NOT_FINITE),
        (((1.0, 0.0, 0.0), (0.0, math.inf, -math.inf)), Status.NOT_FINITE),
        (((1.0, 0.0, 0.0), (0.0, 0.0, 1e200)), Status.NOT_FINITE),
    ],
)
def test_a_bad_geometry_is_refused_and_the_last_one_kept(points: tuple[Vector3, ...], status: Status) -> None:
    predictor = Predictor(BARE_SCENE)
    assert predictor.tell(Geometry(0, "cube", points)) is status
    assert predictor.update(flying_sample()).status is Status.NO_GEOMETRY
    predictor.tell(Geometry(0, "cube", CUBE))
    assert predictor.tell(Geometry(0, "cube", points)) is status
    assert goes_on(predictor)


NUMBERS = st.floats(width=64)
LIKELY = st.floats(-10.0, 10.0) | st.sampled_from([0.0, -0.0, 1e-300, 5e-324, 1e-8, 1e6, 1e11, -1e11]) | NUMBERS
UNIT_QUATERNIONS = (
    st.tuples(*[st.floats(-1.0, 1.0)] * 4)
    .filter(lambda q: math.hypot(*q) > 0.1)
    .map(lambda q: tuple(part / math.hypot(*q) for part in q))
)
SAMPLES = st.builds(
    Sample,
    st.integers(0, 50_000_000),
    st.just("map"),
    st.just("cube"),
    st.tuples(LIKELY, LIKELY, LIKELY | st.floats(-0.1, 0.3)),
    UNIT_QUATERNIONS | st.tuples(LIKELY, LIKELY, LIKELY, LIKELY),
    st.tuples(LIKELY, LIKELY, LIKELY),
    st.tuples(LIKELY, LIKELY, LIKELY),
    st.just(ZEROS) | st.tuples(*[NUMBERS] * 36),
    st.just(ZEROS),
)
SCENES = [
    CUBE_SCENE,
    CUBE_SCENE._replace(friction=0.0, contact_time=0.0, tolerance=0.0),
    CUBE_SCENE._replace(friction=100.0, restitution=1.0, twist_window=0.01, center_of_mass=(0.02, 0.0, 0.01)),
    CUBE_SCENE._replace(gravity=(0.0, 0.0, 0.0), law="total", normal=(0.6, 0.0, 0.8), height=0.1),
    CUBE_SCENE._replace(inertia=((1.0, 0.1, 0.2), (0.1, 2.0, 0.3), (0.2, 0.3, 2.9)), mass=1e3, horizon=60.0),
]


def numbers_of(value: Any) -> list[float]:
    """Every float of nested tuples."""
    if isinstance(value, tuple):
        return [number for part in value for number in numbers_of(part)]
    return [value] if isinstance(value, float) else []


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(SCENES), st.lists(SAMPLES, min_size=1, max_size=6))
def test_no_sample_whatever_its_numbers_raises_or_makes_a_nan(scene: Scene, samples: list[Sample]) -> None:
    predictor = Predictor(scene)
    for k, sample in enumerate(samples):
        # Stamps in order, now and then not.
        prediction = predictor.update(sample._replace(stamp=sample.stamp if k == 3 else 10_000_000 * k))
        touchdown = prediction.touchdown
        if touchdown is not None:
            assert prediction.status is Status.ACCEPTED
            assert all(map(math.isfinite, numbers_of(touchdown))), touchdown
            assert math.hypot(*touchdown.orientation) == pytest.approx(1.0, abs=1e-12)
            assert math.hypot(*touchdown.axis) == pytest.approx(1.0, abs=1e-9)
            assert 0.0 <= touchdown.lead_time <= scene.horizon
            assert 0.0 <= touchdown.off_axis <= 1.0
            assert touchdown.new
        for score in [prediction.score] if prediction.score else []:
            assert all(map(math.isfinite, numbers_of(score))), score
    assert all(math.isfinite(number) for score in predictor.finish() for number in numbers_of(score))


@pytest.mark.parametrize(("stamp", "said"), [(0, "its stamp is 0, as the one before: fill in header.stamp"), (5, "")])
def test_stamps_that_nobody_fills_in_are_told_from_those_that_repeat(stamp: int, said: str) -> None:
    monitor, sample = Monitor({"": CUBE_SCENE}), flying_sample(stamp)
    assert monitor.update("", sample).status is Status.ACCEPTED
    assert monitor.update("", sample).status is Status.STAMP_REPEATED
    flaw = flaw_of(monitor, "", Status.STAMP_REPEATED, sample)
    assert flaw.startswith(said)
    assert bool(flaw) == bool(said)


@pytest.mark.parametrize(
    ("message", "status", "flaw"),
    [
        (flying_sample(position=(0.0, 0.0, math.nan)), Status.NOT_FINITE, "position[2] is nan: look at its source"),
        (flying_sample(linear=(1e200, 0.0, 0.0)), Status.NOT_FINITE, "linear[0] is 1e+200: look at its source"),
        (
            flying_sample(pose_covariance=(1e308,) * 36, twist_covariance=(*ZEROS[:35], math.inf)),
            Status.NOT_FINITE,
            "twist_covariance[35] is inf: look at its source",
        ),
        (
            Geometry(0, "cube", (*CUBE, (0.0, math.nan, 0.0))),
            Status.NOT_FINITE,
            "points[8][1] is nan: look at its source",
        ),
        (
            (Transform(0, "a", "b", *POSE), Transform(0, "b", "c", (math.inf, 0.0, 0.0), POSE[1])),
            Status.NOT_FINITE,
            "'c' in 'b': position[0] is inf: look at its source",
        ),
        (
            flying_sample(orientation=(0.0, 0.0, 0.0, 0.5)),
            Status.BAD_QUATERNION,
            "orientation is (0, 0, 0, 0.5), not of unit length: look at its source",
        ),
        (
            (Transform(0, "a", "b", *POSE), Transform(0, "b", "c", POSE[0], (0.0,) * 4)),
            Status.BAD_QUATERNION,
            "'c' in 'b': orientation is (0, 0, 0, 0), not of unit length: look at its source",
        ),
        (
            Imu(0, "imu", None, (0.0,) * 3, (0.0, 0.0, 9.81)),
            Status.BAD_QUATERNION,
            "orientation_covariance[0] is -1, so no orientation is measured, but this input needs one",
        ),
    ],
)
def test_the_field_of_a_message_that_is_bad_is_named(message: Any, status: Status, flaw: str) -> None:
    assert flaw_of(Monitor({"": CUBE_SCENE}), "", status, message) == flaw
