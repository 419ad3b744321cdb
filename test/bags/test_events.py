"""What is kept of a gait: stances, landings, and how those were announced 50 ms ahead."""

from __future__ import annotations

from impact_predictor.bags.events import FootStance, Gait, GaitLanding
from impact_predictor.prediction.scene import Walking
from impact_predictor.prediction.types import Foot, Landing, Leftover, Prediction, Sample, Score, Status, Touchdown

MS = 1_000_000
STILL = (0.0, 0.0, 0.0)


def sample(stamp: int) -> Sample:
    return Sample(stamp, "world", "base", STILL, (0.0, 0.0, 0.0, 1.0), STILL, STILL, (0.0,) * 36, (0.0,) * 36)


def touchdown(point: int, lead_time: float, impulse: tuple[float, float] = (0.0, 0.0)) -> Touchdown:
    """Only what a gait reads of one."""
    nothing: Touchdown = Touchdown._make([None] * len(Touchdown._fields))
    return nothing._replace(lead_time=lead_time, new=(point,), impulses=((0.0, 0.0), impulse))


def answer(stamp: int, stands: tuple[bool, bool], since: int, score: Score | None = None) -> Prediction:
    """Left stands from the beginning; right stands or swings since a stamp."""
    left, right = stands
    feet = Foot("left", left, 0, 0.0, 0.0), Foot("right", right, since, 0.0, 0.0)
    return Prediction(Status.ACCEPTED, sample(stamp), score=score, feet=feet)


def landed(foot: str, stamp: int, history: tuple[tuple[float, float], ...] = (), point: str | None = None) -> Score:
    landing = Landing(foot, stamp, None, None, history, 0.3, touchdown(1, 0.0, (6.0, 8.0)), point)
    return Score(stamp, touchdown(1, 0.0), None, None, False, Leftover.DRIVEN, (), landing)


def test_a_gait_has_the_stances_and_each_landing_as_it_was_announced_50_ms_ahead() -> None:
    gait = Gait(Walking(("left", "right"), points=2))
    begin = 10 * MS
    gait.take(answer(begin, (True, False), 0))
    # Heel and toe of the right foot are the points 2 and 3.
    gait.take(answer(100 * MS, (True, False), 0))
    gait.take(answer(120 * MS, (True, False), 0))
    gait.take(answer(140 * MS, (True, False), 0))
    gait.take(answer(190 * MS, (True, True), 182 * MS))
    history = ((0.082, -0.002), (0.062, -0.001), (0.042, 0.0))
    gait.take(answer(195 * MS, (True, True), 182 * MS, score=landed("right", 182 * MS, history, "heel")))
    # The toe of a foot that stands is no other landing.
    gait.take(answer(230 * MS, (True, True), 182 * MS, score=landed("right", 220 * MS, history, "toe")))
    gait.take(answer(400 * MS, (True, False), 390 * MS))
    gait.take(answer(500 * MS, (True, False), 390 * MS))
    assert (gait.begin, gait.end, gait.samples) == (begin, 500 * MS, 9)
    assert gait.stances == [FootStance(1, 182 * MS, 390 * MS), FootStance(0, begin, 500 * MS)]
    assert gait.landings == [GaitLanding(1, 182 * MS, 181 * MS, 0.3, 10.0)]
    assert gait.true_stances == []


def test_a_landing_that_the_end_settles_is_kept_and_one_that_came_too_late_is_not_announced() -> None:
    gait = Gait(Walking(("left", "right")))
    gait.take(answer(0, (True, False), 0))
    gait.take(answer(50 * MS, (True, True), 41 * MS))
    gait.end_with([landed("right", 41 * MS, ((0.041, -0.001),))])
    assert gait.landings == [GaitLanding(1, 41 * MS, None, 0.3, 10.0)]
    assert gait.begin == 0


def test_the_truth_is_kept_beside() -> None:
    gait = Gait(Walking(("left", "right")))
    for stamp, stands in ((0, (True, False)), (10, (True, True)), (20, (False, True)), (30, (False, True))):
        gait.tell(stamp, stands)
        gait.take(answer(stamp, (True, False), 0))
    assert gait.true_stances == [FootStance(0, 0, 20), FootStance(1, 10, 30)]
    assert gait.landings == []
