"""What `~/prediction`, `~/score` and /diagnostics tell of the feet of a walking machine."""

import json
import math
from typing import Any

import numpy as np
import pytest
from messages_of_rosbags import TYPES, TYPESTORE, header, padded, serialize

from impact_predictor.mechanics.types import Flag, Mode, Twist
from impact_predictor.prediction.types import (
    Bound,
    Foot,
    Landing,
    Leftover,
    Prediction,
    Sample,
    Score,
    SpatialTwist,
    Status,
    Touchdown,
)
from impact_predictor.ros.cdr import OK, WARN, Diagnostic
from impact_predictor.ros.diagnostics import shown
from impact_predictor.ros.feet_report import FeetReport
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    POINT_CLOUD,
    MalformedMessage,
    decode_diagnostic_array,
    decode_terrain,
    encode_prediction,
    encode_score,
)

NOTHING, LEVEL, UNKNOWN = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0,) * 36
SAMPLE = Sample(2_000_000_000, "world", "base", NOTHING, LEVEL, NOTHING, NOTHING, UNKNOWN, UNKNOWN)
STANDING = Foot("LF", True, 1_250_000_000, 1e-4, 0.0, confirmed=True, late=0.012)
SWINGING = Foot(
    "RF", False, 1_900_000_000, 0.031, 0.4, 0.0625, 0.25, -0.01, None, (0.5, -0.3, 0.031), (0.625, -0.3, 0.0)
)
ALONE = Foot("LH", False, 0, 0.05, -0.1)
TWIST = Twist(0.1, -0.2, 0.3)
STILL = SpatialTwist(NOTHING, NOTHING)
TOUCHDOWN = Touchdown(
    *(0.0625, Mode.STOP, TWIST, TWIST, ((1.0, 0.0), (2.0, 0.0)), ("OO",), 0.5, Flag.NONE, True, "path", (0,), (1,)),
    *(NOTHING, NOTHING, LEVEL, NOTHING, NOTHING, 0.3, 0.0, 0.0, 0.0, 0.0, Leftover.DRIVEN, STILL, STILL),
)
LANDING = Landing("RF", 2_062_000_000, -0.003, True, ((0.11, 0.004), (0.002, -0.0005)))
SCORE = Score(LANDING.stamp, TOUCHDOWN, None, None, False, Leftover.DRIVEN, (), LANDING, announced=0.11)


def told(*feet: Foot, **changes: Any) -> list[Diagnostic]:
    prediction = Prediction(Status.ACCEPTED, SAMPLE, TOUCHDOWN, feet=feet)
    return decode_diagnostic_array(encode_prediction(prediction._replace(**changes)))


@pytest.mark.parametrize("touchdown", [TOUCHDOWN, None])
def test_a_status_for_each_foot_follows_that_of_the_prediction_which_stays_as_it_is(
    touchdown: Touchdown | None,
) -> None:
    feet = STANDING, SWINGING, ALONE
    first, *others = told(*feet, touchdown=touchdown)
    assert [first] == told(touchdown=touchdown)
    assert [one.name for one in others] == [f"impact_predictor/foot/{foot.name}" for foot in feet]
    for foot, status in zip(feet, others, strict=True):
        places = dict(zip(("place.x", "place.y", "place.z"), foot.place or (), strict=False))
        known = {name: value for name, value in foot._asdict().items() if value is not None} | places
        known = {name: value for name, value in known.items() if name not in ("position", "place")}
        texts = {name: value if name == "name" else json.loads(value) for name, value in status.values.items()}
        assert texts == known


def test_each_foot_has_its_impulse_and_every_impulse_stands_beside_its_bound() -> None:
    after = SpatialTwist((0.25, 0.0, 0.5), (0.0, -0.125, 0.0))
    estimate = TOUCHDOWN._replace(after_6d=after, bound=Bound.ESTIMATE, drives=0.25, joints=("hip", "knee"))
    foot = SWINGING._replace(impulse=(0.5, 0.0, 2.0), bound=Bound.ESTIMATE)
    whole, one = told(foot, touchdown=estimate._replace(jumps=(1.5, -2.0)))
    keys = ("bound", "impulse.drives", "joints", "joint_jumps", "trunk.vx", "trunk.vz", "trunk.wy")
    assert [whole.values[key] for key in keys] == ["estimate", "0.5", "hip knee", "1.5 -2.0", "0.25", "0.5", "-0.125"]
    keys = ("impulse.x", "impulse.y", "impulse.z", "bound")
    assert [one.values[key] for key in keys] == ["0.5", "0.0", "2.0", "estimate"]
    plain, other = told(SWINGING)
    assert not {"bound", "impulse.drives", "joints", "joint_jumps", "trunk.vx"} & plain.values.keys()
    assert not set(keys) & other.values.keys()


def test_an_impact_in_which_the_law_failed_is_a_warning() -> None:
    for flag, level in ((Flag.SHARED_FRICTION, OK), (Flag.NOT_CONVERGED, WARN), (Flag.BOTH_STRUCK, OK)):
        assert told(SWINGING, touchdown=TOUCHDOWN._replace(flags=flag))[0].level == level


def test_feet_are_the_bytes_that_rosbags_writes_and_their_hardware_is_the_foot() -> None:
    # Names of every length modulo four meet every alignment.
    feet = [SWINGING._replace(name="f" * length) for length in range(9)]
    data = encode_prediction(Prediction(Status.ACCEPTED, SAMPLE, TOUCHDOWN, feet=tuple(feet)))
    message: Any = TYPESTORE.deserialize_cdr(data, DIAGNOSTIC_ARRAY)
    assert padded(serialize(message, DIAGNOSTIC_ARRAY)) == data
    assert [one.hardware_id for one in message.status] == ["base", *[foot.name for foot in feet]]


def test_a_foot_says_what_it_does_and_warns_where_its_force_sensor_does_not_agree() -> None:
    doubted = STANDING._replace(confirmed=False)
    said = [(one.level, one.message) for one in told(STANDING, SWINGING, ALONE, doubted)[1:]]
    assert said == [
        (OK, "stands"),
        (OK, "swings, lands in 62.5 ms"),
        (OK, "swings"),
        (WARN, "stands, but its force sensor does not agree"),
    ]


def score(landing: Landing) -> Diagnostic:
    data = encode_score(Prediction(Status.ACCEPTED, SAMPLE, None, SCORE._replace(landing=landing)))
    assert data is not None
    (status,) = decode_diagnostic_array(data)
    return status


def test_a_score_tells_which_foot_landed_how_late_and_how_well_that_was_foretold() -> None:
    status = score(LANDING)
    told = {key: status.values[key] for key in ("foot", "late", "confirmed", "time_error", "announced", "stamp")}
    assert told == {
        "foot": "RF",
        "late": "-0.003",
        "confirmed": "true",
        "time_error": "-0.0005",
        "announced": "0.11",
        "stamp": str(LANDING.stamp),
    }
    assert status.level == OK
    assert status.message.startswith("RF has landed, time error -0.5 ms: STOP predicted 62.5 ms ahead")


def test_a_score_leaves_out_what_nobody_knows_of_a_landing_and_warns_of_a_sensor_that_does_not_agree() -> None:
    status = score(LANDING._replace(late=None, confirmed=None, history=()))
    assert not {"late", "confirmed", "time_error"} & status.values.keys()
    assert (status.level, status.values["foot"]) == (OK, "RF")
    assert score(LANDING._replace(confirmed=False)).level == WARN


def answer(*feet: Foot, landing: Landing | None = None) -> Prediction:
    settled = None if landing is None else SCORE._replace(landing=landing)
    return Prediction(Status.ACCEPTED, SAMPLE, None, settled, feet=feet)


def test_diagnostics_count_the_landings_of_each_foot_and_how_late_they_were() -> None:
    report = FeetReport("")
    report.take(answer(STANDING, SWINGING))
    assert shown(report.figures()) == {"feet.standing": "LF", "feet.landings": "0"}
    for late, foot in ((-0.003, "RF"), (0.001, "RF"), (0.007, "LF")):
        report.take(answer(STANDING, STANDING._replace(name="RF"), landing=LANDING._replace(late=late, foot=foot)))
    assert shown(report.figures()) == {
        "feet.standing": "LF RF",
        "feet.landings": "3",
        "feet.landings.LF": "1",
        "feet.landings.RF": "2",
        "feet.landings.median_time_error": "0.0005",
        "feet.landings.early": "1",
        "feet.landings.late": "2",
        "feet.landings.median_late": "0.0010",
    }


def test_a_machine_with_a_name_has_it_before_its_feet_and_one_in_the_air_stands_on_none() -> None:
    report = FeetReport("dog")
    report.take(answer(SWINGING))
    assert shown(report.figures()) == {"dog/feet.standing": "none", "dog/feet.landings": "0"}


def test_a_force_sensor_disagrees_when_it_does_for_most_of_a_second_not_while_its_foot_lands() -> None:
    report = FeetReport("")
    for k in range(500):
        landing = 200 <= k < 230
        report.take(answer(STANDING._replace(confirmed=not landing), SWINGING._replace(confirmed=False)))
    report.second_over()
    assert report.flaw == "feet: the force sensor of RF does not agree"
    for _ in range(500):
        report.take(answer(STANDING, SWINGING))
    report.second_over()
    assert not report.flaw


@pytest.mark.parametrize("little_endian", [True, False])
@pytest.mark.parametrize("kind", [7, 8])
def test_heights_are_read_from_a_cloud_whatever_else_its_points_have(little_endian: bool, kind: int) -> None:
    number, mark = {7: "f4", 8: "f8"}[kind], "<" if little_endian else ">"
    layout = np.dtype([("ring", "u1"), *[(name, mark + number) for name in "xyz"], ("intensity", mark + "f4")])
    rows = np.zeros((2, 3), layout)
    for k, name in enumerate("xyz"):
        rows[name] = np.arange(6.0).reshape(2, 3) * 0.5 + k
    rows["z"][1, 2] = math.nan
    field, cloud = TYPES["sensor_msgs/msg/PointField"], TYPES[POINT_CLOUD]
    offsets = {name: layout.fields[name][1] for name in layout.names}
    fields = [field(name, offsets[name], kind if name in "xyz" else 2, 1) for name in layout.names]
    data = np.frombuffer(rows.tobytes(), np.uint8)
    step = layout.itemsize
    message = cloud(header(5, "map"), 2, 3, fields, not little_endian, step, 3 * step, data, False)
    told = decode_terrain(serialize(message, POINT_CLOUD, little_endian))
    assert (told.stamp, told.frame_id) == (5, "map")
    expected = np.stack([rows[name].ravel() for name in "xyz"], axis=1)
    np.testing.assert_array_equal(told.points, expected)
    for wrong in (message.fields[:3], [*fields[:3], field("z", 100, kind, 1)]):
        flawed = cloud(header(5, "map"), 2, 3, wrong, not little_endian, step, 3 * step, data, False)
        with pytest.raises(MalformedMessage):
            decode_terrain(serialize(flawed, POINT_CLOUD, little_endian))
