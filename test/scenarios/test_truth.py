"""True impacts on their topic: every number comes back, and they are a message that any ROS tool reads."""

from __future__ import annotations

import random
from math import inf

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore
from touchdowns import SAMPLE

from impact_predictor.mechanics.bodies import plate
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.types import Prediction, Status
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, MalformedMessage, encode_mode
from impact_predictor.scenarios.truth import (
    TrueImpact,
    TrueOnset,
    border_of,
    decode_truths,
    encode_truth,
)


def an_impact(seed: int) -> TrueImpact:
    rng = random.Random(seed)

    def vector() -> tuple[float, float, float]:
        return rng.gauss(0.0, 1.0), rng.gauss(0.0, 1e-9), rng.gauss(0.0, 1e9)

    return TrueImpact(
        stamp=rng.randrange(2**31 * 10**9),
        body=rng.choice(["rod", "crate_2", "Ölfaß"]),
        mode=rng.choice(list(Mode)),
        old=rng.choice([(), (0,), (2, 3)]),
        new=rng.choice([(1,), (0, 4)]),
        approach=rng.random(),
        half_distance=np.float64(rng.random()),  # written as a number, too
        energy_lost=rng.random(),
        linear_before=vector(),
        angular_before=vector(),
        linear_after=vector(),
        angular_after=vector(),
        border=rng.choice([inf, rng.random()]),
    )


def test_an_impact_reads_back_as_it_was() -> None:
    for seed in range(100):
        impact = an_impact(seed)
        assert decode_truths(TrueImpact, encode_truth(impact, "world")) == [impact]


def test_what_tells_no_impact_is_malformed() -> None:
    good = encode_truth(an_impact(1), "world")
    for data in (b"", good[:-4], encode_mode(Prediction(Status.ACCEPTED, SAMPLE)), good.replace(b"stamp", b"stomp")):
        with pytest.raises(MalformedMessage):
            decode_truths(TrueImpact, data)


def test_a_bag_without_borders_says_that_none_was_looked_for() -> None:
    impact = an_impact(2)
    # The key of another length would be another message.
    data = encode_truth(impact, "world").replace(b"border", b"nobody")
    assert decode_truths(TrueImpact, data) == [impact._replace(border=inf)]


@pytest.mark.parametrize(("slides", "lifts"), [(True, False), (False, True), (True, True)])
def test_an_onset_reads_back_as_it_was(slides: bool, lifts: bool) -> None:
    onset = TrueOnset(12_345_678_901, "crate", slides, lifts)
    data = encode_truth(onset, "deck")
    assert decode_truths(TrueOnset, data) == [onset]
    (status,) = get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(data, DIAGNOSTIC_ARRAY).status
    assert status.message == " and ".join(["slides"] * slides + ["lifts"] * lifts)
    for broken in (b"", data[:-4], encode_truth(an_impact(1), "world")):
        with pytest.raises(MalformedMessage):
            decode_truths(TrueOnset, broken)


def test_a_border_is_the_nearest_of_friction_and_geometry() -> None:
    # A plate that turns about its old contact, near the border f = 3 d / (4 d^2 + 1) of d = height / length.
    border = 3.0 * 0.8 / (4.0 * 0.8**2 + 1.0)
    for part in (0.5, 0.98, 1.001, 1.5):
        body = plate(1.0, 0.8, 2.0, part * border)
        found = border_of(solve_impact(body, body.turning(-1.0)))
        margins = solve_impact(body, body.turning(-1.0)).margins
        shifts = [abs(one.change) / 0.5 for one in (margins.center, margins.height, margins.reach)]
        assert found == pytest.approx(min(abs(border / (part * border) - 1.0), *shifts), rel=1e-6)
    assert found < inf
    assert border_of(solve_impact(body, body.turning(1.0))) == inf  # nothing is struck
