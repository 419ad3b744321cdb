"""The made-up trot: feet that stand do not move, those that swing meet the ground with the stated speed, as planned."""

from itertools import pairwise

import pytest

from impact_predictor.prediction.vectors import add
from impact_predictor.scenarios.walking.trot import DUTY, FEET, LIFT, PERIOD, plan, trot

RATE = 1000.0


def courses() -> list[list[tuple[float, float, float]]]:
    """Where each foot is over the ground at each sample."""
    steps = [[add(point, sample.position) for point in geometry.points] for geometry, sample in trot(RATE, 3.0)]
    return [[step[foot] for step in steps] for foot in range(len(FEET))]


@pytest.mark.parametrize("foot", range(len(FEET)))
def test_a_foot_stands_still_for_its_part_of_a_stride_and_never_jumps(foot: int) -> None:
    course = courses()[foot]
    stands = [abs(z) < 1e-12 for _, _, z in course]
    assert sum(stands) / len(stands) == pytest.approx(DUTY, abs=0.02)
    for (a, b), before, after in zip(pairwise(course), stands, stands[1:], strict=False):
        moved = max(abs(p - q) for p, q in zip(a, b, strict=True))
        # The swing is fastest where it lifts off: 4 LIFT / ((1 - DUTY) PERIOD) = 1.3 m/s, and forwards 1.5 m/s.
        assert moved < (1e-12 if before and after else 2.0 / RATE)


def test_a_foot_lands_with_the_stated_speed_when_the_plan_says() -> None:
    planned = plan(3.0)
    for foot, course in enumerate(courses()):
        landings = [k for k, (a, b) in enumerate(pairwise(course), 1) if a[2] > 1e-9 >= b[2]]
        stands = [now[foot] for now in planned.stands]
        times = [
            time for time, before, now in zip(planned.times[1:], stands[:-1], stands[1:], strict=True) if now > before
        ]
        assert [time for time in times if time < 3e9] == [pytest.approx(k / RATE * 1e9) for k in landings]
        for k in landings:
            speed = (course[k - 1][2] - course[k][2]) * RATE
            # One sample before the ground the foot is that much faster or slower: 1 % in 1 ms.
            assert speed == pytest.approx(4.0 * LIFT * 0.2 / ((1.0 - DUTY) * PERIOD), rel=0.03)


def test_a_plan_that_is_earlier_has_the_same_stances_at_earlier_times() -> None:
    usual, early = plan(3.0, 10**9), plan(3.0, 10**9, earlier=0.01)
    assert early.stands == usual.stands
    assert [b - a for a, b in zip(early.times, usual.times, strict=True)] == [10_000_000] * len(usual.times)
