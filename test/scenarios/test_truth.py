"""True impacts on their topic: every number comes back, and they are a message that any ROS tool reads."""

from __future__ import annotations

import random

import pytest
from rosbags.typesys import Stores, get_typestore

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.types import Prediction, Sample, Status
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, MalformedMessage, encode_mode
from impact_predictor.scenarios.truth import TrueImpact, decode_true_impacts, encode_true_impact


def an_impact(seed: int) -> TrueImpact:
    rng = random.Random(seed)

    def vector() -> tuple[float, float, float]:
        return rng.gauss(0.0, 1.0), rng.gauss(0.0, 1e-9), rng.gauss(0.0, 1e9)

    return TrueImpact(
        rng.randrange(2**31 * 10**9),
        rng.choice(["rod", "crate_2", "Ölfaß"]),
        rng.choice(list(Mode)),
        rng.choice([(), (0,), (2, 3)]),
        rng.choice([(1,), (0, 4)]),
        rng.random(),
        rng.random(),
        rng.random(),
        *(vector(), vector(), vector(), vector()),
    )


def test_an_impact_reads_back_as_it_was() -> None:
    for seed in range(100):
        impact = an_impact(seed)
        assert decode_true_impacts(encode_true_impact(impact, "world")) == [impact]


def test_it_is_a_diagnostic_array_stamped_with_the_impact() -> None:
    impact = an_impact(1)
    message = get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(encode_true_impact(impact, "world"), DIAGNOSTIC_ARRAY)
    assert message.header.frame_id == "world"
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == impact.stamp
    (status,) = message.status
    assert (status.hardware_id, status.message) == (impact.body, impact.mode.name)


def test_what_tells_no_impact_is_malformed() -> None:
    sample = Sample(0, "", "", (0.0,) * 3, (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, (0.0,) * 36, (0.0,) * 36)
    good = encode_true_impact(an_impact(1), "world")
    for data in (b"", good[:-4], encode_mode(Prediction(Status.ACCEPTED, sample)), good.replace(b"stamp", b"stomp")):
        with pytest.raises(MalformedMessage):
            decode_true_impacts(data)
