"""When feet are planned to land, and how late they are."""

from __future__ import annotations

import pytest

from impact_predictor.prediction.types import Schedule, Status
from impact_predictor.prediction.walking.schedule import LandingSchedule

MS = 1_000_000


def test_a_landing_is_compared_with_the_nearest_planned_one() -> None:
    plan = LandingSchedule(("left", "right"))
    assert plan.late("left", 5) is None
    times = tuple(k * 100 * MS for k in range(5))
    stands = ((True, True), (False, True), (True, True), (False, True), (True, True))
    assert plan.set(Schedule(0, ("left", "right"), times, stands)) is Status.ACCEPTED
    assert plan.late("left", 210 * MS) == pytest.approx(0.01)
    assert plan.late("left", 380 * MS) == pytest.approx(-0.02)
    assert plan.late("right", 210 * MS) is None


def test_a_new_schedule_replaces_what_is_ahead_and_keeps_what_was_before() -> None:
    plan = LandingSchedule(("left",))
    plan.set(Schedule(0, ("left",), (0, 200 * MS, 400 * MS, 600 * MS), ((False,), (True,), (False,), (True,))))
    plan.set(Schedule(0, ("left",), (300 * MS, 500 * MS, 700 * MS), ((True,), (False,), (True,))))
    assert plan.late("left", 200 * MS) == 0.0
    assert plan.late("left", 600 * MS) == pytest.approx(-0.1)


def test_a_foot_that_stands_from_the_first_time_on_is_not_planned_to_land_then() -> None:
    plan = LandingSchedule(("left",))
    plan.set(Schedule(0, ("left",), (100 * MS,), ((True,),)))
    assert plan.late("left", 100 * MS) is None


@pytest.mark.parametrize(
    ("schedule", "status"),
    [
        (Schedule(0, ("nose",), (0,), ((True,),)), Status.FEET_CHANGED),
        (Schedule(0, ("left",), (5, 5), ((True,), (False,))), Status.MALFORMED),
        (Schedule(0, ("left",), (5,), ()), Status.MALFORMED),
        (Schedule(0, ("left",), (5,), ((True, False),)), Status.MALFORMED),
        (Schedule(0, ("left",), (), ()), Status.ACCEPTED),
    ],
)
def test_a_schedule_that_is_none_is_refused(schedule: Schedule, status: Status) -> None:
    plan = LandingSchedule(("left",))
    plan.set(Schedule(0, ("left",), (0, 200 * MS), ((False,), (True,))))
    assert plan.set(schedule) is status
    assert plan.late("left", 200 * MS) == 0.0


def test_a_plan_that_is_told_again_and_again_does_not_grow() -> None:
    plan = LandingSchedule(("LF",))
    for k in range(1000):
        times = tuple((k + j) * 10_000_000 for j in range(50))
        assert plan.set(Schedule(0, ("LF",), times, tuple((time % 500_000_000 > 250_000_000,) for time in times))) == 0
    # 10 s that are remembered and the half second ahead, with a change each quarter of a second.
    assert len(plan._stances["LF"]) < 50


def test_a_landing_far_from_every_planned_one_is_not_late() -> None:
    plan = LandingSchedule(("LF",))
    plan.set(Schedule(0, ("LF",), (0, 1_000_000_000), ((False,), (True,))))
    assert plan.late("LF", 1_900_000_000) == 0.9
    assert plan.late("LF", 60_000_000_000) is None


@pytest.mark.parametrize(("offset", "said"), [(1_700_000_000_000, "1.7e+09 s after"), (-3_000, "3 s before")])
def test_a_plan_in_another_clock_is_named_with_how_far_it_is_off(offset: int, said: str) -> None:
    plan = LandingSchedule(("left",))
    times = tuple((offset + k * 250 + 50_000) * MS for k in range(200))
    plan.set(Schedule(0, ("left",), times, tuple((k % 2 == 1,) for k in range(200))))
    first = 50_250 if offset > 0 else 99_750
    for _ in range(5):
        assert not plan.doubt
        assert plan.landed("left", first * MS) is None
    assert plan.doubt.startswith("the last 5 landings are more than 1 s from what schedule plans")
    assert f"which is {said} them: let the planner stamp by the clock of odom" in plan.doubt
    assert plan.landed("left", times[1]) == 0.0
    assert not plan.doubt


def test_feet_of_which_nothing_is_planned_put_no_plan_in_doubt() -> None:
    plan = LandingSchedule(("left", "right"))
    plan.set(Schedule(0, ("right",), (0, 200 * MS), ((False,), (True,))))
    for k in range(20):
        plan.landed("left", k * 10_000 * MS)
    assert not plan.doubt
