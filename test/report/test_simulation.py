"""What `simulate` prints in sentences."""

from __future__ import annotations

from math import radians

from impact_predictor.report.simulation import rolling_sentences
from impact_predictor.scenarios.as_json import rolling_as_json
from impact_predictor.scenarios.wheel import Hub, Wheel, roll

SLIPPERY = Wheel(Hub(inertia=0.1, friction=0.35, slope=radians(5.0)))


def test_sentences_say_how_a_wheel_ended_and_what_steady_rolling_needs() -> None:
    ended, steady, needs = rolling_sentences(roll(SLIPPERY, 0.0, steps=3))
    assert ": steps done, 3 steps and" in ended
    assert steady.startswith("Steady rolling without slip, closed form: 1.605412029 rad/s")
    assert "between them 0.375327; the wheel has 0.35" in needs
    rests = rolling_sentences(roll(SLIPPERY._replace(hub=SLIPPERY.hub._replace(friction=0.2)), 0.0))
    assert ": rests, 0 steps and 0.905 m ahead" in rests[0]
    assert rests[1].startswith("Steady rolling without slip")


def test_a_wheel_that_stops_has_no_steady_rolling() -> None:
    stops = roll(Wheel(Hub(inertia=0.1, friction=100.0, slope=radians(3.0))), 1.5, steps=None)
    assert rolling_sentences(stops)[-1].startswith("On this slope it cannot roll steadily")
    assert rolling_as_json(stops)["steady"] is None
