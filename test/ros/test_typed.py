"""Typed messages against other implementations: rosbags everywhere, Foxglove's decoder where it is installed.

The definitions are those that bags carry; numbers must come through exactly.
"""

import math
import random
import re
import sys
from enum import Enum
from pathlib import Path
from typing import Any

import make_messages
import numpy as np
import pytest
from messages_of_rosbags import FRAMES, random_sample
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from test_outputs import a_prediction, with_score

from impact_predictor.mechanics.bodies import plate
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import ContactState, Flag, Mode, Twist
from impact_predictor.prediction.types import Bound, Covariance, Foot, Leftover, PointOutcome, Status, Uncertainty
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, outputs_of
from impact_predictor.ros.messages.definitions import MESSAGES, register
from impact_predictor.ros.messages.kinds import PACKAGE, constants
from impact_predictor.ros.messages.typed import PREDICTION_MESSAGE, encode_typed_prediction, encode_typed_score

TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
register(TYPESTORE)
FILES = Path(__file__).parents[2] / PACKAGE / "msg"


def decoded(data: bytes | None, name: str = "Prediction") -> Any:
    """A message as rosbags reads it, which has to write the same bytes."""
    assert data is not None
    message: Any = TYPESTORE.deserialize_cdr(data, f"{PACKAGE}/msg/{name}")
    again = bytes(TYPESTORE.serialize_cdr(message, f"{PACKAGE}/msg/{name}"))
    assert data == again + bytes(-len(again) % 4)
    return message


def a_full_prediction(seed: int) -> Any:
    """One with everything that may be told, and texts of many lengths."""
    rng = random.Random(seed)
    prediction = with_score(a_prediction(seed))
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    twist = Twist(*(rng.random() for _ in range(3)))
    contacts = tuple(
        PointOutcome(
            point=k,
            is_new=k > 1,
            position=(rng.random(), 2.0, 3.0),
            normal=(0.0, 0.0, 1.0),
            impulse=(rng.random(), 0.5, 0.25),
            velocity=(rng.random(),) * 3,
            state=ContactState(k % 4),
            lift_probability=None if k % 2 else rng.random(),
        )
        for k in range(seed % 5)
    )
    touchdown = prediction.touchdown._replace(
        contacts=contacts,
        segments=("--", "O+")[: seed % 3],
        old=tuple(range(seed % 3)),
        uncertainty=Uncertainty(Covariance.REFUSED, tuple(rng.random() for _ in Mode), twist, twist, (0.5,) * 36),
        planar=solve_impact(body, body.turning(-1.0)),
        bound=Bound.ESTIMATE if seed % 2 else None,
        joints=("hip", "knee", "é")[: seed % 4],
        jumps=(0.1, -0.2, 0.3)[: seed % 4],
    )
    feet = tuple(
        Foot(name, stands=not k, since=k, gap=0.1, approach=0.2, lead_time=0.1 * k if k else None, lands=0.5)
        for k, name in enumerate(("LF", "hind right", "RF")[: seed % 4])
    )
    sample = random_sample(rng)._replace(stamp=prediction.sample.stamp, frame_id=FRAMES[seed % len(FRAMES)])
    return prediction._replace(touchdown=touchdown, feet=feet, sample=sample)


def test_messages_of_every_alignment_are_those_that_rosbags_writes() -> None:
    for seed in range(120):
        prediction = a_full_prediction(seed)
        decoded(encode_typed_prediction(prediction))
        decoded(encode_typed_prediction(prediction._replace(touchdown=None)))
        decoded(encode_typed_score(prediction), "Score")


def test_a_prediction_tells_where_when_and_how_the_body_goes_on() -> None:
    prediction = a_full_prediction(4)
    message, touchdown = decoded(encode_typed_prediction(prediction)), prediction.touchdown
    stamp = prediction.sample.stamp
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == stamp
    then = message.touchdown.sec * 10**9 + message.touchdown.nanosec
    assert then == stamp + round(touchdown.lead_time * 1e9)
    assert message.lead_time == touchdown.lead_time
    assert (message.mode, message.status) == (Mode.PIVOT_SLIDE, Status.ACCEPTED)
    place, turned = message.pose.pose.position, message.pose.pose.orientation
    assert (place.x, place.y, place.z) == touchdown.position
    assert (turned.x, turned.y, turned.z, turned.w) == touchdown.orientation
    assert message.twist.covariance.tolist() == list(touchdown.uncertainty.twist_covariance)
    after = message.after
    assert (after.linear.x, after.angular.z) == (touchdown.after_6d.linear[0], touchdown.after_6d.angular[2])
    assert message.mode_probabilities.tolist() == list(touchdown.uncertainty.probabilities)
    assert [(one.point, one.is_new, one.state) for one in message.contacts] == [
        (one.point, one.is_new, one.state) for one in touchdown.contacts
    ]
    assert [one.position.x for one in message.contacts] == [one.position[0] for one in touchdown.contacts]


def test_where_no_touchdown_is_ahead_numbers_are_nan_and_the_mode_is_no_impact() -> None:
    message = decoded(encode_typed_prediction(a_prediction()._replace(touchdown=None)))
    assert message.mode == Mode.NO_IMPACT
    assert (message.touchdown.sec, message.touchdown.nanosec) == (0, 0)
    assert math.isnan(message.lead_time)
    assert np.isnan(message.pose.covariance).all()
    assert len(message.contacts) == 0


def test_a_foot_tells_of_its_landing_and_what_nobody_knows_is_not_a_number() -> None:
    prediction = a_full_prediction(3)
    standing, landing, _ = decoded(encode_typed_prediction(prediction)).feet
    assert (standing.name, standing.stands, standing.confirmed) == ("LF", True, -1)
    assert math.isnan(standing.lead_time)
    assert (landing.name, landing.lead_time, landing.lands) == ("hind right", 0.1, 0.5)
    assert math.isnan(landing.place.x)


@pytest.mark.parametrize("name", sorted(MESSAGES))
def test_the_files_of_the_package_are_made_of_the_tables(name: str) -> None:
    made = make_messages.files()[f"{name}.msg"]
    assert (FILES / f"{name}.msg").read_text(encoding="utf-8") == made, "run python tools/make_messages.py"


def test_the_package_builds_every_file() -> None:
    built = set(re.findall(r"msg/(\w+)\.msg", (FILES.parent / "CMakeLists.txt").read_text(encoding="utf-8")))
    assert built == {path.stem for path in FILES.iterdir()} == set(MESSAGES)


ENUMERATIONS = [
    ("Prediction", "STATUS", Status),
    ("Prediction", "MODE", Mode),
    ("Prediction", "FLAG", Flag),
    ("Prediction", "LEFTOVER", Leftover),
    ("Prediction", "COVARIANCE", Covariance),
    ("Contact", "STATE", ContactState),
]


@pytest.mark.parametrize(("name", "prefix", "enumeration"), ENUMERATIONS)
def test_the_constants_in_the_files_are_the_members_of_the_enumerations(
    name: str, prefix: str, enumeration: type[Enum]
) -> None:
    text = (FILES / f"{name}.msg").read_text(encoding="utf-8")
    (declared, *_), *_ = get_types_from_msg(text, f"{PACKAGE}/msg/{name}").values()
    found = {one: value for one, _, value in declared if one.startswith(f"{prefix}_")}
    assert found == {f"{prefix}_{one}": int(member.value) for one, member in enumeration.__members__.items()}


def test_what_has_no_number_of_its_own_is_counted_from_one() -> None:
    assert constants(Bound) == {"LOWER": 1, "ESTIMATE": 2, "UPPER": 3}
    assert decoded(encode_typed_prediction(a_full_prediction(1))).bound == 2
    assert decoded(encode_typed_prediction(a_full_prediction(2))).bound == 0


@pytest.fixture
def importable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The only folder from which packages are imported."""
    monkeypatch.delitem(sys.modules, PACKAGE)
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    (tmp_path / PACKAGE).mkdir()
    return tmp_path / PACKAGE


def test_auto_is_typed_where_the_package_can_be_imported(importable: Path) -> None:
    (importable / "__init__.py").touch()
    assert outputs_of("auto")["prediction"].type_name == f"{PACKAGE}/msg/Prediction"
    assert outputs_of("strings")["prediction"].type_name == DIAGNOSTIC_ARRAY


def test_a_folder_of_a_clone_is_no_package_of_messages(importable: Path) -> None:
    assert outputs_of("auto")["prediction"].type_name == DIAGNOSTIC_ARRAY
    assert outputs_of("typed")["score"].type_name == f"{PACKAGE}/msg/Score"


def test_foxglove_decodes_the_definitions_that_a_bag_carries() -> None:
    decoders = pytest.importorskip("mcap_ros2.decoder")
    records = pytest.importorskip("mcap.records")
    text, _ = TYPESTORE.generate_msgdef(PREDICTION_MESSAGE.type_name, ros_version=2)
    schema = records.Schema(1, text.encode(), "ros2msg", PREDICTION_MESSAGE.type_name.replace("/msg", ""))
    read = decoders.DecoderFactory().decoder_for("cdr", schema)
    for seed in range(12):
        prediction = a_full_prediction(seed)
        theirs, ours = read(encode_typed_prediction(prediction)), decoded(encode_typed_prediction(prediction))
        for name in ("status", "mode", "flags", "leftover", "law", "kind", "body", "lead_time"):
            assert getattr(theirs, name) == getattr(ours, name)
        assert list(theirs.pose.covariance) == list(ours.pose.covariance)
        assert [one.impulse.x for one in theirs.contacts] == [one.impulse.x for one in ours.contacts]
        assert [one.name for one in theirs.feet] == [one.name for one in ours.feet]
        assert list(theirs.joint_jumps) == list(ours.joint_jumps)
