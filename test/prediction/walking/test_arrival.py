"""When a point that has come to rest reached the ground, of descents whose arrival is known."""

import pytest

from impact_predictor.prediction.walking.arrival import MOST, ArrivalFit
from impact_predictor.prediction.walking.cubic import GapNoise, PointFrame
from impact_predictor.stamps import NANOSECONDS

RATE = 500
LEVEL, TOLERANCE, NOISE = 0.002, 0.005, GapNoise(2e-4, 2e-3)
# The foot strikes at 0.4 m/s, with a brake of 1 m/s^2, and moves along the ground meanwhile.
SPEED, BRAKE, ALONG = 0.4, 1.0, (0.3, -0.2)


def frame(step, landing, *, measured):
    """The frame of a step, of a foot that lands at a time in s."""
    left = landing - step / RATE
    speed = -(SPEED + BRAKE * left) if left > 0.0 else 0.0
    gap = LEVEL + (SPEED + 0.5 * BRAKE * left) * left if left > 0.0 else LEVEL
    x, y = (rate * -max(left, 0.0) for rate in ALONG)
    velocity = (*(ALONG if left > 0.0 else (0.0, 0.0)), speed)
    stamp = step * NANOSECONDS // RATE
    return PointFrame(stamp, gap, speed if measured else None, (x, y, gap), velocity if measured else None)


def arrival(frames):
    """Of frames in which the point comes near the ground at some time, and then rests."""
    near = next(k for k, one in enumerate(frames) if one.gap - LEVEL <= TOLERANCE)
    arriving = ArrivalFit(frames[max(0, near + 1 - MOST) : near + 1], 0, LEVEL, TOLERANCE, NOISE)
    for one in frames[near + 1 :]:
        assert not arriving.is_full
        arriving.add(one)
    return arriving.arrival()


@pytest.mark.parametrize("measured", [True, False])
@pytest.mark.parametrize("landing", [0.1, 0.1007, 0.1019])
def test_a_foot_that_strikes_arrives_where_its_cubic_meets_the_level(landing, measured):
    frames = [frame(step, landing, measured=measured) for step in range(70)]
    stamp, age, velocity = arrival(frames)
    # The level is that of the resting frames, which count beside what feet usually differ by: a few micrometres.
    assert stamp == pytest.approx(landing * NANOSECONDS, abs=2e4)
    last = max(step for step in range(70) if step / RATE < landing)
    assert age == len(frames) - last
    expected = frame(last, landing, measured=True).velocity
    assert velocity == pytest.approx(expected, abs=1e-12 if measured else 5e-3)


def test_of_too_few_frames_no_velocity_is_told():
    frames = [frame(step, 0.003, measured=False) for step in range(4)]
    stamp, _, velocity = arrival(frames)
    assert frames[0].stamp <= stamp <= frames[2].stamp
    assert velocity is None
