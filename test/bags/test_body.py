"""What is kept of a gait: stances, as they were inferred and as they were."""

from __future__ import annotations

from impact_predictor.bags.body import FootStance, Gait
from impact_predictor.prediction.scene import Walking
from impact_predictor.prediction.types import Foot, Prediction, Sample, Status

MS = 1_000_000
STILL = (0.0, 0.0, 0.0)


def sample(stamp: int) -> Sample:
    return Sample(stamp, "world", "base", STILL, (0.0, 0.0, 0.0, 1.0), STILL, STILL, (0.0,) * 36, (0.0,) * 36)


def answer(stamp: int, stands: tuple[bool, bool], since: int) -> Prediction:
    """Left stands from the beginning; right stands or swings since a stamp."""
    left, right = stands
    feet = Foot("left", left, 0, 0.0, 0.0), Foot("right", right, since, 0.0, 0.0)
    return Prediction(Status.ACCEPTED, sample(stamp), feet=feet)


def test_a_gait_has_the_stances_of_its_record() -> None:
    gait = Gait(Walking(("left", "right"), points=2))
    begin = 10 * MS
    for stamp, stands, since in (
        (begin, False, 0),
        (140 * MS, False, 0),
        (190 * MS, True, 182 * MS),
        (230 * MS, True, 182 * MS),
        (400 * MS, False, 390 * MS),
        (500 * MS, False, 390 * MS),
    ):
        gait.take(answer(stamp, (True, stands), since))
    assert (gait.begin, gait.end, gait.samples) == (begin, 500 * MS, 6)
    assert gait.stances == [FootStance(1, 182 * MS, 390 * MS), FootStance(0, begin, 500 * MS)]
    assert gait.true_stances == []


def test_the_truth_is_kept_beside() -> None:
    gait = Gait(Walking(("left", "right")))
    for stamp, stands in ((0, (True, False)), (10, (True, True)), (20, (False, True)), (30, (False, True))):
        gait.tell(stamp, stands)
        gait.take(answer(stamp, (True, False), 0))
    assert gait.true_stances == [FootStance(0, 0, 20), FootStance(1, 10, 30)]
