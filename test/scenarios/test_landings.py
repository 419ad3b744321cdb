"""Which announcements belong to which true landings of a foot, on records that one can count by hand."""

from __future__ import annotations

import pytest
import touchdowns

from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Foot, Leftover, Prediction, Sample, Status
from impact_predictor.scenarios.comparison import Compared, Landings, TrueLanding, Truth, compare
from impact_predictor.scenarios.matching import Announcements

UNIT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SCENE = Scene(1.0, UNIT, 0.5, walking=Walking(("left", "right")))
MS = 1_000_000
NOTHING = Truth(0, 0, 0, 0, None, None, None, time_error_by_lead_time={"0.02": None, "0.05": None})

TOUCHDOWN = touchdowns.TOUCHDOWN._replace(old=(), new=(0,), leftover=Leftover.DRIVEN)

Told = dict[int, float]
"""For when a landing is announced, by when: both in ms."""


def answer(
    at: int, announced: dict[int, Told], standing: tuple[str, ...], feet: tuple[str, ...], each: int = 1
) -> Prediction:
    """What is told at a time in ms of points, by their indices, `each` foot having so many."""
    zeros = (0.0,) * 36
    sample = Sample(at * MS, "world", "base", (0.0,) * 3, (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, zeros, zeros)
    touchdowns = [
        TOUCHDOWN._replace(lead_time=(told[at] - at) * 1e-3, new=(point,))
        for point, told in announced.items()
        if at in told
    ]
    touchdowns.sort(key=lambda one: one.lead_time)
    soonest = {one.new[0] // each: one.lead_time for one in reversed(touchdowns)}
    states = tuple(Foot(foot, foot in standing, 0, 0.1, 0.0, soonest.get(i)) for i, foot in enumerate(feet))
    return Prediction(Status.ACCEPTED, sample, touchdowns[0] if touchdowns else None, feet=states)


def record(
    until: int,
    stands: dict[str, tuple[int, ...]],
    announced: dict[int, Told],
    scene: Scene = SCENE,
    standing: tuple[str, ...] = (),
) -> Landings:
    """Samples each ms up to `until`; `stands` has the times in ms at which each foot begins and ends to stand."""
    assert scene.walking is not None
    made = Landings({"": scene})
    for at in range(until + 1):
        made.tell(
            "base", at * MS, tuple(sum(at >= change for change in stands[foot]) % 2 == 1 for foot in scene.walking.feet)
        )
        made.add(answer(at, announced, standing, scene.walking.feet, scene.walking.points))
    return made


def compared(landings: Landings) -> Compared:
    return compare((), Announcements(), {"": SCENE}, landings.matches())


def test_a_foot_lands_when_its_flag_rises_but_not_with_the_first_one() -> None:
    made = record(100, {"left": (0, 20, 60), "right": (30, 80)}, {})
    assert made.true == [TrueLanding(30 * MS, "base", "right"), TrueLanding(60 * MS, "base", "left")]


def test_landings_of_feet_are_found_foot_by_foot_and_modes_are_not_compared() -> None:
    announced = {0: dict.fromkeys(range(5, 70), 70.0), 1: dict.fromkeys(range(10, 71), 71.0)}
    together, bodies, _ = compared(record(100, {"left": (70,), "right": (71,)}, announced))
    assert together == bodies["base"]
    assert together == NOTHING._replace(
        touchdowns=2,
        median_time_error=0.0,
        time_error_by_lead_time={"0.02": 0.0, "0.05": 0.0},
        least_lead_time=pytest.approx(0.061),
    )


def test_an_announcement_of_the_wrong_foot_is_false_and_the_landing_missed() -> None:
    truth = compared(record(100, {"left": (60,), "right": ()}, {1: dict.fromkeys(range(20, 60), 60.0)})).together
    assert (truth.touchdowns, truth.missed, truth.false, truth.least_lead_time) == (1, 1, 1, None)


def test_a_foot_may_still_seem_to_come_down_when_the_plan_says_that_it_stands() -> None:
    announced = {0: {at: max(60.0, at + 2.0) for at in range(20, 75)}}
    truth = compared(record(200, {"left": (60,), "right": ()}, announced)).together
    assert (truth.missed, truth.false, truth.time_error_by_lead_time["0.02"]) == (0, 0, 0.0)
    longer = {0: {at: max(60.0, at + 2.0) for at in range(20, 85)}}
    assert compared(record(200, {"left": (60,), "right": ()}, longer)).together.false == 1


def test_two_feet_that_take_turns_to_be_the_soonest_are_not_mixed_up() -> None:
    announced = {0: {at: 60.0 + at % 2 for at in range(20, 60)}, 1: {at: 61.0 - at % 2 for at in range(20, 60)}}
    truth = compared(record(100, {"left": (60,), "right": (60,)}, announced)).together
    assert (truth.touchdowns, truth.missed, truth.false) == (2, 0, 0)


def test_the_toe_of_a_foot_that_stands_on_its_heel_lands_no_more() -> None:
    soles = SCENE._replace(walking=Walking(("left", "right"), points=2))
    toe = {1: dict.fromkeys(range(20, 60), 60.0)}
    stands: dict[str, tuple[int, ...]] = {"left": (0,), "right": (0, 10, 90)}
    assert compared(record(100, stands, toe, soles, standing=("left",))).together.false == 0
    assert compared(record(100, stands, toe, soles)).together.false == 1
    heel = {2: dict.fromkeys(range(20, 90), 90.0)}
    assert (
        compared(record(100, stands, heel, soles)).together
        == compared(record(100, stands, {3: heel[2]}, soles)).together
    )


def test_where_no_foot_lands_every_announcement_is_false() -> None:
    truth = compared(record(100, {"left": (), "right": ()}, {0: dict.fromkeys(range(20, 60), 60.0)})).together
    assert truth == NOTHING._replace(false=1)


def test_true_landings_after_the_last_answer_are_counted_apart() -> None:
    landings = Landings({"": SCENE})
    landings.add(answer(100, {}, (), ("left", "right")))
    for at, stands in ((50, (False, False)), (90, (True, False)), (130, (True, True))):
        landings.tell("base", at * MS, stands)
    assert landings.later() == 1
    assert len(landings.matches()["base"]) == 1


def test_of_other_bodies_nothing_is_compared_here() -> None:
    made = Landings({"walker": SCENE, "crate": SCENE._replace(walking=None)})
    for at in range(100):
        made.tell("crate", at * MS, (at > 50,))
        made.tell("walker", at * MS, (at > 50, True))
        made.add(answer(at, {0: dict.fromkeys(range(20, 51), 51.0)}, (), ("left", "right")), "walker")
        made.add(answer(at, {}, (), ()), "crate")
    assert made.true == [TrueLanding(51 * MS, "walker", "left")]
    assert list(made.matches()) == ["walker"]
