"""The bytes of outputs against two other implementations: rosbags, and rclpy where ROS is installed.

Samples are random with a fixed seed; numbers must come through exactly, since nothing is computed on the way.
"""

import random
from math import hypot
from typing import Any

import numpy as np
import pytest
from messages_of_rosbags import TYPES, TYPESTORE, header, odometry, padded, random_sample, serialize
from test_score import run
from test_spatial_score import HALF, TOSS, falling, gone_on, samples_of, told_after

from impact_predictor.mechanics.bodies import plate
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import ContactState, Flag, Mode, Twist
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.types import (
    Covariance,
    Leftover,
    PointOutcome,
    Prediction,
    Score,
    SpatialTwist,
    Status,
    Touchdown,
    Uncertainty,
)
from impact_predictor.prediction.watch.watch import Level, Report
from impact_predictor.ros.cdr import seconds_and_rest
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    ODOMETRY,
    OUTPUTS,
    UINT8,
    Diagnostic,
    decode_diagnostic_array,
    decode_odometry,
    encode_mode,
    encode_post_impact,
    encode_prediction,
    encode_reports,
    encode_score,
)

ENDIAN = pytest.mark.parametrize("little_endian", [True, False], ids=["little", "big"])


def random_touchdown(rng: random.Random, mode: Mode = Mode.PIVOT_SLIDE) -> Touchdown:
    def numbers(count: int) -> Any:
        return tuple(rng.gauss(0.0, 10.0) for _ in range(count))

    return Touchdown(
        lead_time=rng.uniform(0.0, 0.5),
        mode=mode,
        before=Twist(*numbers(3)),
        after=Twist(*numbers(3)),
        impulses=(numbers(2), numbers(2)),
        segments=("--", "O+"),
        energy_lost=rng.random(),
        flags=Flag.NONE,
        unique=True,
        law="path",
        old=(0, 4),
        new=(1, 5),
        axis=numbers(3),
        position=numbers(3),
        orientation=numbers(4),
        linear=numbers(3),
        angular=numbers(3),
        half_distance=0.0524,
        off_axis=rng.random(),
        lateral=rng.gauss(0.0, 1.0),
        closing_spread=rng.random(),
        offset=rng.gauss(0.0, 0.1),
        leftover=Leftover.NONE,
        before_6d=SpatialTwist((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        after_6d=SpatialTwist((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    )


def read(data: bytes | None) -> Diagnostic:
    """The only status of an array."""
    assert data is not None
    (status,) = decode_diagnostic_array(data)
    return status


def a_prediction(seed: int = 1, **changes: Any) -> Prediction:
    rng = random.Random(seed)
    sample = random_sample(rng)._replace(stamp=rng.randrange(2**31 * 10**9 - 10**10))
    return Prediction(Status.ACCEPTED, sample, random_touchdown(rng)._replace(**changes))


def test_a_post_impact_state_is_the_odometry_that_rosbags_writes() -> None:
    for seed in range(100):
        prediction = a_prediction(seed)
        touchdown = prediction.touchdown
        assert touchdown is not None
        expected = prediction.sample._replace(
            stamp=prediction.sample.stamp + round(touchdown.lead_time * 1e9),
            position=touchdown.position,
            orientation=touchdown.orientation,
            linear=touchdown.linear,
            angular=touchdown.angular,
        )
        assert encode_post_impact(prediction) == serialize(odometry(expected), ODOMETRY)


@pytest.mark.parametrize("mode", list(Mode))
def test_a_mode_is_the_uint8_that_rosbags_writes(mode: Mode) -> None:
    assert encode_mode(a_prediction(mode=mode)) == padded(serialize(TYPES[UINT8](mode), UINT8))


def test_without_a_touchdown_the_mode_is_no_impact_and_no_state_follows() -> None:
    prediction = a_prediction()._replace(touchdown=None)
    assert encode_mode(prediction) == padded(serialize(TYPES[UINT8](Mode.NO_IMPACT), UINT8))
    assert encode_post_impact(prediction) is None
    assert encode_score(prediction) is None
    status = read(encode_prediction(prediction))
    assert (status.level, status.message) == (0, "no touchdown within the horizon")
    assert status.values == {"status": "ACCEPTED", "stamp": str(prediction.sample.stamp), "mode": "NO_IMPACT"}


def test_diagnostics_are_the_bytes_that_rosbags_writes() -> None:
    for seed in range(100):
        prediction = with_score(a_prediction(seed))
        for data in (encode_prediction(prediction), encode_score(prediction)):
            assert data is not None
            message: Any = TYPESTORE.deserialize_cdr(data, DIAGNOSTIC_ARRAY)
            assert padded(serialize(message, DIAGNOSTIC_ARRAY)) == data


def test_a_prediction_holds_every_number_of_its_touchdown_exactly() -> None:
    prediction = a_prediction(7)
    touchdown = prediction.touchdown
    assert touchdown is not None
    data = encode_prediction(prediction)
    message: Any = TYPESTORE.deserialize_cdr(data, DIAGNOSTIC_ARRAY)
    assert message.header == header(prediction.sample.stamp, prediction.sample.frame_id)
    (theirs,) = message.status
    (ours,) = decode_diagnostic_array(data)
    assert (theirs.name, theirs.level, theirs.message) == (ours.name, ours.level, ours.message)
    assert theirs.hardware_id == prediction.sample.child_frame_id
    assert {pair.key: pair.value for pair in theirs.values} == ours.values
    assert ours.name == "impact_predictor/prediction"
    assert ours.message == f"PIVOT_SLIDE in {touchdown.lead_time * 1e3:.1f} ms"
    texts = {"status": "ACCEPTED", "mode": "PIVOT_SLIDE", "law": "path", "unique": "true", "flags": "NONE"}
    texts |= {
        "leftover": "NONE",
        "segments": "-- O+",
        "old": "0 4",
        "new": "1 5",
        "kind": "edge>face",
        "stamp": str(prediction.sample.stamp),
    }
    assert {key: ours.values[key] for key in texts} == texts
    twists = {"before": touchdown.before, "after": touchdown.after}
    pairs = {"impulse.old": touchdown.impulses[0], "impulse.new": touchdown.impulses[1]}
    alone = ("lead_time", "energy_lost", "half_distance", "off_axis", "lateral", "closing_spread", "offset")
    assert {key: float(value) for key, value in ours.values.items() if key not in texts} == {
        **{f"{name}.{part}": value for name, twist in twists.items() for part, value in twist._asdict().items()},
        **{f"{name}.{part}": one[k] for name, one in pairs.items() for k, part in enumerate(("normal", "tangent"))},
        **dict(zip(("axis.x", "axis.y", "axis.z"), touchdown.axis, strict=True)),
        **{name: getattr(touchdown, name) for name in alone},
        **{
            f"{name}_6d.{'vw'[part]}{axis}": twist[part][k]
            for name, twist in (("before", touchdown.before_6d), ("after", touchdown.after_6d))
            for part in range(2)
            for k, axis in enumerate("xyz")
        },
    }


def test_a_prediction_tells_of_each_contact_what_it_does() -> None:
    common: Any = {"position": (0.0,) * 3, "normal": (0.0, 0.0, 1.0), "velocity": (0.0,) * 3}
    contacts = (
        PointOutcome(4, is_new=False, **common, impulse=(0.0, 0.5, 0.25), state=ContactState.LEAVES),
        PointOutcome(1, is_new=True, **common, impulse=(1.0, -0.5, 2.0), state=ContactState.STICKS),
    )
    prediction = a_prediction()
    touchdown = prediction.touchdown
    assert touchdown is not None
    values = read(encode_prediction(prediction._replace(touchdown=touchdown._replace(contacts=contacts)))).values
    told = {"contacts": "4 1", "states": "LEAVES STICKS", "impulses": "0.0 0.5 0.25 1.0 -0.5 2.0"}
    assert {key: values[key] for key in told} == told
    assert "lifts" not in values
    likely = tuple(one._replace(lift_probability=0.75) for one in contacts)
    values = read(encode_prediction(prediction._replace(touchdown=touchdown._replace(contacts=likely)))).values
    assert values["lifts"] == "0.75 0.75"


def test_a_prediction_tells_its_uncertainty_and_its_margins_where_they_are_asked_for() -> None:
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    outcome = solve_impact(body, body.turning(-1.0))
    probabilities = (0.0, 0.25, 0.5, 0.125, 0.125, 0.0, 0.0)
    covariance = tuple(0.1 * k for k in range(36))
    mean, deviation = Twist(0.1, 0.2, 0.3), Twist(0.01, 0.02, 0.03)
    uncertainty = Uncertainty(Covariance.USED, probabilities, mean, deviation, covariance)
    plain = read(encode_prediction(a_prediction())).values
    of_uncertainty = {
        "covariance": "USED",
        **{f"probability.{mode.name}": repr(probabilities[mode]) for mode in Mode},
        **{f"mean.{part}": repr(value) for part, value in mean._asdict().items()},
        **{f"deviation.{part}": repr(value) for part, value in deviation._asdict().items()},
    }
    of_margins = {}
    for name, margin in outcome.margins._asdict().items():
        of_margins[f"margin.{name}"] = repr(float(margin.change))
        of_margins[f"margin.{name}.mode"] = "NONE" if margin.mode is None else margin.mode.name
    for changes, added in (
        ({"uncertainty": uncertainty}, of_uncertainty),
        ({"planar": outcome}, of_margins),
        ({"uncertainty": uncertainty, "planar": outcome}, of_uncertainty | of_margins),
    ):
        assert read(encode_prediction(a_prediction(**changes))).values == plain | added
    # What was carried through the impact is that of the state after it.
    data = encode_post_impact(a_prediction(uncertainty=uncertainty))
    assert data is not None
    after = decode_odometry(data)
    assert (after.twist_covariance, after.pose_covariance) == (covariance, a_prediction().sample.pose_covariance)


@pytest.mark.parametrize(
    ("changes", "level"),
    [
        ({}, 0),
        ({"flags": Flag.REVERSED_SLIP | Flag.SHARED_FRICTION}, 0),
        ({"leftover": Leftover.ONE_POINT}, 0),
        ({"leftover": Leftover.OUT_OF_PLANE, "unique": False}, 0),
        ({"flags": Flag.JAMMED}, 0),
        ({"flags": Flag.REVERSED_SLIP | Flag.LAST_RESORT}, 1),
        ({"flags": Flag.NOT_CONVERGED}, 1),
        ({"flags": Flag.INVALID_INPUT}, 1),
    ],
)
def test_only_an_answer_in_which_the_law_failed_is_a_warning(changes: dict[str, Any], level: int) -> None:
    assert decode_diagnostic_array(encode_prediction(a_prediction(**changes)))[0].level == level


def test_flags_and_leftovers_of_one_number_have_their_own_names() -> None:
    prediction = a_prediction(
        flags=Flag.JAMMED | Flag.REVERSED_SLIP, leftover=Leftover.OUT_OF_PLANE | Leftover.ONE_POINT
    )
    status = read(encode_prediction(prediction))
    assert status.values["flags"] == "REVERSED_SLIP|JAMMED"
    assert status.values["leftover"] == "ONE_POINT|OUT_OF_PLANE"


def test_a_refused_sample_is_a_warning_that_says_why() -> None:
    prediction = Prediction(Status.STAMP_WENT_BACK, a_prediction().sample)
    status = read(encode_prediction(prediction))
    assert (status.level, status.message) == (1, "sample refused: STAMP_WENT_BACK")
    assert status.values["status"] == "STAMP_WENT_BACK"


def with_score(prediction: Prediction, **changes: Any) -> Prediction:
    assert prediction.touchdown is not None
    score = Score(
        stamp=prediction.sample.stamp - 20_000_000,
        touchdown=prediction.touchdown,
        measured=Twist(0.1, -0.2, 0.3),
        relative_error=0.081,
        scored=True,
        leftover=Leftover.NONE,
        history=((0.01, 0.09),),
    )
    return prediction._replace(score=score._replace(**changes))


def test_a_score_holds_the_predicted_and_the_measured_twist() -> None:
    prediction = with_score(a_prediction(lead_time=0.00678))
    touchdown = prediction.touchdown
    data = encode_score(prediction)
    assert touchdown is not None
    assert data is not None
    message: Any = TYPESTORE.deserialize_cdr(data, DIAGNOSTIC_ARRAY)
    assert message.header == header(prediction.sample.stamp - 20_000_000, prediction.sample.frame_id)
    status = read(data)
    assert (status.name, status.level) == ("impact_predictor/score", 0)
    assert status.message == "PIVOT_SLIDE predicted 6.8 ms ahead, error 0.081"
    numbers = [float(status.values[f"{kind}.{part}"]) for kind in KINDS for part in ("vx", "vy", "omega")]
    assert numbers == [*touchdown.before, *touchdown.after, 0.1, -0.2, 0.3]
    assert float(status.values["relative_error"]) == 0.081
    assert status.values["scored"] == "true"
    assert float(status.values["lead_time"]) == 0.00678


KINDS = ("before", "predicted", "measured")


@pytest.mark.parametrize("measured", [None, Twist(1.0, 2.0, 3.0)])
@pytest.mark.parametrize("error", [None, 0.5])
def test_a_score_leaves_out_what_was_not_measured(measured: Twist | None, error: float | None) -> None:
    prediction = with_score(
        a_prediction(), measured=measured, relative_error=error, scored=False, leftover=Leftover.TOO_SHORT
    )
    status = read(encode_score(prediction))
    assert status.level == 0
    assert status.message.endswith("not scored: TOO_SHORT")
    assert ("measured.vx" in status.values) == (measured is not None)
    assert ("relative_error" in status.values) == (error is not None)


@pytest.mark.parametrize(
    ("frames_after", "whole", "in_plane"),
    [
        (6, "error 0.023", "nothing to compare, not scored: ONE_POINT"),
        (2, "nothing to compare, not scored: TOO_SHORT", "nothing to compare, not scored: ONE_POINT|TOO_SHORT"),
    ],
)
def test_a_score_of_a_corner_that_struck_says_how_right_the_whole_twist_was(
    frames_after: int, whole: str, in_plane: str
) -> None:
    toss, faster = falling(), (0.03, -0.02, 0.01)
    predictor = Predictor(TOSS)
    answers = run(predictor, samples_of(toss, gone_on(toss, told_after(toss), faster))[: 10 + frames_after])
    (score,) = [*(answer.score for answer in answers if answer.score is not None), *predictor.finish()]
    assert hypot(*faster) / hypot(*toss.velocity, *(HALF * toss.spin)) == pytest.approx(0.0232, abs=1e-4)
    status = read(encode_score(a_prediction()._replace(score=score)))
    said = f"by the whole twist {whole}; in the impact plane {in_plane}"
    assert status.message == f"FLIGHT predicted 4.0 ms ahead; {said}"


def test_a_stamp_beyond_the_range_of_a_message_stays_at_its_end() -> None:
    prediction = a_prediction(lead_time=0.5)
    last = (2**31 - 1) * 10**9 + 999_999_999
    data = encode_post_impact(prediction._replace(sample=prediction.sample._replace(stamp=last)))
    assert data is not None
    assert decode_odometry(data).stamp == (2**31 - 1) * 10**9 + 499_999_999


def test_numbers_of_numpy_are_written_like_those_of_python() -> None:
    prediction = a_prediction(3)
    assert prediction.touchdown is not None
    same = prediction.touchdown._replace(energy_lost=np.float64(prediction.touchdown.energy_lost))
    assert encode_prediction(prediction._replace(touchdown=same)) == encode_prediction(prediction)


@ENDIAN
def test_an_array_of_several_statuses_is_read(little_endian: bool) -> None:
    pair = TYPES["diagnostic_msgs/msg/KeyValue"]
    one = TYPES["diagnostic_msgs/msg/DiagnosticStatus"]
    statuses = [
        one(2, "a", "mé", "hardware", [pair("k", "v"), pair("key", "")]),
        one(0, "", "", "", []),
        one(3, "stale", "!", "h", [pair("1", "22")]),
    ]
    data = serialize(TYPES[DIAGNOSTIC_ARRAY](header(5, "odom"), statuses), DIAGNOSTIC_ARRAY, little_endian)
    assert decode_diagnostic_array(data) == [
        ("a", 2, "mé", {"k": "v", "key": ""}, "hardware"),
        ("", 0, "", {}, ""),
        ("stale", 3, "!", {"1": "22"}, "h"),
    ]


def test_rclpy_reads_what_is_written_and_writes_what_is_read() -> None:
    serialization = pytest.importorskip("rclpy.serialization", reason="ROS is not installed: rclpy is not compared")
    from diagnostic_msgs.msg import DiagnosticArray
    from nav_msgs.msg import Odometry
    from std_msgs.msg import UInt8

    classes = {ODOMETRY: Odometry, UINT8: UInt8, DIAGNOSTIC_ARRAY: DiagnosticArray}
    for seed in range(50):
        prediction = with_score(a_prediction(seed))
        for type_name, encode, _ in OUTPUTS.values():
            data = encode(prediction)
            assert data is not None
            message = serialization.deserialize_message(data, classes[type_name])
            again = serialization.serialize_message(message)
            # rclpy leaves old memory in the padding between fields; rosbags writes zeros, as this package does.
            assert padded(serialize(TYPESTORE.deserialize_cdr(again, type_name), type_name)) == data
            if type_name == DIAGNOSTIC_ARRAY:
                assert decode_diagnostic_array(again) == decode_diagnostic_array(data)


@pytest.mark.parametrize(("second", "told"), [(-(2**31) - 5, -(2**31)), (2**31 - 1, 2**31 - 1), (2**31, 2**31 - 1)])
def test_a_time_beyond_the_range_of_a_message_is_told_as_the_end_of_it(second: int, told: int) -> None:
    assert seconds_and_rest(second * 10**9 + 7) == (told, 7)


def test_reports_on_several_units_are_one_array_as_rosbags_writes_it() -> None:
    # Texts of every length modulo four, and units without any value.
    for length in range(9):
        values = [{f"{k}" * length: "v" * k for k in range(length)}, {}, {"level": "0.5", "reason": "x" * length}]
        bodies = "a" * length, "", "crate"
        reports = [
            Report(body, 7, Level(level), "m" * length, texts)
            for level, (body, texts) in enumerate(zip(bodies, values, strict=True))
        ]
        data = encode_reports(reports, 7 * 10**9 + 5)
        message: Any = TYPESTORE.deserialize_cdr(data, DIAGNOSTIC_ARRAY)
        assert message.header == header(7 * 10**9 + 5, "")
        assert padded(serialize(message, DIAGNOSTIC_ARRAY)) == data
        assert decode_diagnostic_array(data) == [
            ("impact_predictor/unit" + f"/{one.body}" * bool(one.body), one.level, one.message, one.values, one.body)
            for one in reports
        ]
