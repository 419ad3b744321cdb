"""True landings on their topic: every number comes back, and other messages are told from them."""

from __future__ import annotations

import random

import pytest

from impact_predictor.prediction.types import Vector3
from impact_predictor.ros.messages import MalformedMessage
from impact_predictor.scenarios.truth import LandingState, TrueLanding, TrueOnset, decode_truths, encode_truth

FEET = ("LF", "RF", "LH", "RH")


def a_landing(seed: int) -> TrueLanding:
    rng = random.Random(seed)

    def vector() -> Vector3:
        return rng.gauss(0.0, 1.0), rng.gauss(0.0, 1e-9), rng.gauss(0.0, 1e9)

    def state() -> LandingState:
        feet = [(vector(), vector()) for _ in FEET]
        velocities, impulses = zip(*feet, strict=True)
        return LandingState(rng.random(), vector() + vector(), vector() * rng.randrange(3), velocities, impulses)

    return TrueLanding(
        stamp=rng.randrange(2**31 * 10**9),
        body="base",
        foot=rng.choice(FEET),
        feet=FEET,
        standing=rng.choice([(), ("RF",), ("LF", "RH")]),
        normal=vector(),
        states=tuple([state() for _ in range(rng.randrange(2, 14))]),
    )


def test_a_landing_reads_back_as_it_was() -> None:
    for seed in range(100):
        landing = a_landing(seed)
        assert decode_truths(TrueLanding, encode_truth(landing, "world")) == [landing]


def test_the_speed_of_a_landing_is_that_along_the_normal() -> None:
    landing = a_landing(1)._replace(foot="RF", normal=(0.6, 0.0, 0.8))
    velocities = ((9.0, 9.0, 9.0), (1.0, 5.0, -2.0), (9.0, 9.0, 9.0), (9.0, 9.0, 9.0))
    assert landing._replace(states=(landing.before._replace(velocities=velocities),)).speed == pytest.approx(1.0)


def test_what_tells_no_landing_is_malformed() -> None:
    good = encode_truth(a_landing(1), "world")
    onset = encode_truth(TrueOnset(1, "crate", slides=True, lifts=False), "deck")
    for data in (b"", good[:-4], good.replace(b"stamp", b"stomp"), onset):
        with pytest.raises(MalformedMessage):
            decode_truths(TrueLanding, data)
