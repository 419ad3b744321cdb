"""Which predictions belong to which true impacts and landings, and what is said of them, on records counted by hand."""

from __future__ import annotations

import pytest
import touchdowns

from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.prediction.scene import Scene, Walking, Watching
from impact_predictor.prediction.types import Foot, Leftover, Prediction, Sample, Status
from impact_predictor.scenarios.comparison import Comparison, Truth
from impact_predictor.scenarios.truth import LandingState, TrueImpact, TrueLanding

SCENE = Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5, contact_time=0.001)
MS = 1_000_000
NOTHING = Truth(0, 0, 0, 0, None, None, None)

TOUCHDOWN = touchdowns.TOUCHDOWN._replace(
    mode=Mode.PIVOT,
    before=Twist(0.0, -1.0, -2.0),
    after=Twist(0.0, 0.5, -1.0),
    impulses=((0.0, 0.0), (0.0, 1.5)),
    energy_lost=1.0,
    old=(0,),
    new=(1,),
    linear=(0.0, 0.0, 0.5),
    angular=(0.0, 1.0, 0.0),
    half_distance=0.5,
)


def impact(at: float, **changes: object) -> TrueImpact:
    """An impact at a time in ms, which `TOUCHDOWN` predicts exactly."""
    true = TrueImpact(
        stamp=round(at * MS),
        body="rod",
        mode=Mode.PIVOT,
        old=(0,),
        new=(1,),
        approach=1.0,
        half_distance=0.5,
        energy_lost=1.0,
        linear_before=(0.0, 0.0, -1.0),
        angular_before=(0.0, 2.0, 0.0),
        linear_after=(0.0, 0.0, 0.5),
        angular_after=(0.0, 1.0, 0.0),
    )
    return true._replace(**changes)  # type: ignore[arg-type]


def sample(at: float, body: str = "rod") -> Sample:
    return touchdowns.SAMPLE._replace(stamp=round(at * MS), child_frame_id=body)


def record(
    until: int, announced: dict[int, float] | None = None, scene: Scene = SCENE, **changes: object
) -> Comparison:
    """Samples each ms up to `until`, of which some announce a touchdown: both times in ms."""
    made = Comparison({"": scene})
    for at in range(until + 1):
        touchdown = None
        if announced is not None and at in announced:
            touchdown = TOUCHDOWN._replace(lead_time=(announced[at] - at) * 1e-3, **changes)  # type: ignore[arg-type]
        made.add(Prediction(Status.ACCEPTED, sample(at), touchdown))
    return made


def truth_of(impacts: list[TrueImpact], made: Comparison) -> Truth:
    """What is said of all bodies together."""
    made.impacts[:] = impacts
    together = made.compare().together
    assert together is not None
    return together


def compare(impacts: list[TrueImpact], made: Comparison) -> Truth:
    """What is said but of times ahead, which have tests of their own."""
    together = truth_of(impacts, made)
    return together._replace(time_error_by_lead_time=NOTHING.time_error_by_lead_time, least_lead_time=None)


def test_the_error_of_time_is_that_of_the_prediction_20_ms_ahead() -> None:
    made = record(100, {at: 60.0 + (60 - at) * 0.1 for at in range(20, 60)})
    assert compare([impact(60)], made).median_time_error == pytest.approx(0.002)
    late = record(100, dict.fromkeys(range(41, 60), 60.0))
    assert compare([impact(60)], late).median_time_error is None


def test_the_error_of_time_is_told_by_how_long_ahead_and_how_long_ahead_the_first_prediction_was() -> None:
    drifting = {at: 60.0 + (60 - at) * 0.1 for at in range(5, 60)} | dict.fromkeys(range(66, 90), 90.0)
    truth = truth_of([impact(60), impact(90)], record(100, drifting))
    assert truth.time_error_by_lead_time == {"0.02": pytest.approx(0.001), "0.05": pytest.approx(0.005)}
    assert truth.least_lead_time == pytest.approx(0.024)
    nothing = truth_of([impact(60)], record(100))
    assert nothing.time_error_by_lead_time == {"0.02": None, "0.05": None}
    assert nothing.least_lead_time is None


EXACT = Truth(1, 0, 0, 0, 1.0, 0.0, 0.0, 1, 1.0)
EARLY = dict.fromkeys(range(20, 60), 60.0)


@pytest.mark.parametrize(
    ("happened", "announced", "truth"),
    [
        pytest.param([60], EARLY, EXACT, id="exact"),
        pytest.param([60], {at: 60.0 for at in EARLY if at not in (30, 31, 45)}, EXACT, id="pauses"),
        pytest.param([150], EARLY, Truth(1, 1, 1, 0, None, None, None), id="missed"),
        pytest.param([], EARLY, NOTHING._replace(false=1), id="false"),
        # The impact lies before the first prediction, so 5 ms between them make no match.
        pytest.param([50], {52: 55.0}, Truth(1, 1, 1, 0, None, None, None), id="of what has happened"),
        pytest.param([], {52: 52.0}, NOTHING, id="without lead time"),
        pytest.param([220], dict.fromkeys(range(150, 201), 220.0), NOTHING, id="beyond the record"),
        pytest.param(
            [198],
            dict.fromkeys(range(150, 198), 203.0),
            EXACT._replace(median_time_error=pytest.approx(0.005)),
            id="announced for after the end",
        ),
    ],
)
def test_a_touchdown_is_found_or_missed_and_an_announcement_is_of_it_or_false(
    happened: list[float], announced: dict[int, float], truth: Truth
) -> None:
    assert compare([impact(at) for at in happened], record(200, announced)) == truth


def test_velocities_are_compared_at_the_mass_centre() -> None:
    # The body frame lies 0.2 m behind the mass centre, which moves up by 0.2 m * 1 rad/s less there.
    made = record(100, EARLY, SCENE._replace(center_of_mass=(0.2, 0.0, 0.0)), linear=(0.0, 0.0, 0.7))
    assert compare([impact(60)], made).median_velocity_error == pytest.approx(0.0, abs=1e-15)


def test_mode_and_velocity_are_those_of_the_last_prediction() -> None:
    made = record(100, EARLY, mode=Mode.STOP, linear=(0.3, 0.0, 0.5), angular=(0.0, 1.8, 0.0))
    truth = compare([impact(60)], made)
    assert truth.mode_accuracy == 0.0
    # Wrong by 0.3 m/s and 0.8 rad/s at 0.5 m, of -1 m/s and 2 rad/s at 0.5 m.
    assert truth.median_velocity_error == pytest.approx(0.5 / 2.0**0.5)


@pytest.mark.parametrize(("away", "found"), [(-20.0, True), (20.0, True), (-20.1, False), (20.1, False)])
def test_a_prediction_is_of_a_touchdown_within_20_ms(away: float, found: bool) -> None:
    made = record(200, dict.fromkeys(range(20, 60), 100.0 + away))
    truth = compare([impact(100)], made)
    assert (truth.missed, truth.false) == ((0, 0) if found else (1, 1))


def test_of_two_touchdowns_close_together_each_has_its_own_predictions() -> None:
    first, second = dict.fromkeys(range(20, 50), 50.0), dict.fromkeys(range(51, 56), 56.0)
    truth = compare([impact(50), impact(56, mode=Mode.STOP)], record(100, first | second))
    assert truth == Truth(2, 0, 0, 0, 0.5, 0.0, 0.0, 2, 0.5)


@pytest.mark.parametrize(("until", "false"), [(100, 1), (99, 0), (90, 0), (81, 0)])
def test_what_is_announced_for_the_last_20_ms_of_a_record_is_neither_found_nor_false(until: int, false: int) -> None:
    made = record(until, dict.fromkeys(range(20, 80), 80.0))
    # It comes 5 ms after the record, or never: nobody can tell.
    for impacts in ([], [impact(until + 5)]):
        together = truth_of(impacts, made)
        assert (together.touchdowns, together.missed, together.false) == (0, 0, false)
        assert made.compare().bodies["rod"].truth == together
        assert len(made.compare().matches) == false
    # One that the record shows is found.
    found = compare([impact(70)], made)
    assert (found.touchdowns, found.missed, found.false) == (1, 1, false)
    assert compare([impact(80)], made).missed == 0


def test_impacts_that_no_sample_shows_are_not_missed() -> None:
    # At 10.2 ms there was no sample since 10.1 ms, at 11.4 ms one; gravity makes 0.00981 m/s in the 1 ms of a contact.
    impacts = [impact(10.1), impact(10.2), impact(11.4), impact(20.5, approach=0.0098)]
    assert compare(impacts, record(100, {5: 10.1, 6: 10.1})) == Truth(1, 0, 0, 3, 1.0, 0.0, None, 1, 1.0)
    assert compare(impacts, record(100)) == Truth(1, 1, 0, 3, None, None, None)


def test_bodies_are_told_apart_and_those_without_samples_do_not_count() -> None:
    made = record(100, EARLY)
    for at in range(101):
        made.add(Prediction(Status.ACCEPTED, sample(at, "plate"), None))
    impacts = [impact(60), impact(60, body="plate"), impact(60, body="cylinder")]
    assert compare(impacts, made) == Truth(2, 1, 0, 0, 1.0, 0.0, 0.0, 1, 1.0)
    assert compare([impact(60)], Comparison({"": SCENE})) == NOTHING


def test_the_mode_counts_where_a_small_error_does_not_change_it() -> None:
    first, second = dict.fromkeys(range(20, 50), 50.0), dict.fromkeys(range(51, 90), 90.0)
    made = record(100, first | second)
    near = impact(50, mode=Mode.STOP, border=0.019)
    truth = compare([near, impact(90, border=0.021)], made)
    assert (truth.mode_accuracy, truth.clear, truth.clear_mode_accuracy) == (0.5, 1, 1.0)
    truth = compare([near], record(100, first))
    assert (truth.mode_accuracy, truth.clear, truth.clear_mode_accuracy) == (0.0, 0, None)


def test_a_wrong_prediction_of_an_impact_that_no_record_shows_is_counted_apart() -> None:
    slow = impact(60, approach=0.001, mode=Mode.STOP)
    truth = compare([slow], record(100, EARLY))
    assert (truth.touchdowns, truth.false, truth.unresolved, truth.unresolved_wrong) == (0, 0, 1, 1)
    right = compare([slow._replace(mode=Mode.PIVOT)], record(100, EARLY))
    assert (right.unresolved, right.unresolved_wrong) == (1, 0)
    assert compare([slow], record(100)).unresolved_wrong == 0


def test_bodies_go_by_their_names_are_compared_in_their_own_scenes_and_truths_may_call_them_by_their_frames() -> None:
    # Gravity makes 0.981 m/s in the 0.1 s of a contact of the barrel, so that 0.5 m/s cannot be told from rest there.
    frames = {"crate": "crate_link", "drum": "drum", "barrel": "barrel"}
    made = Comparison({"crate": SCENE, "drum": SCENE, "barrel": SCENE._replace(contact_time=0.1)})
    for at in range(100):
        for name, frame in frames.items():
            ahead = TOUCHDOWN._replace(lead_time=(60.0 - at) / 1000) if 20 <= at < 60 else None
            made.add(Prediction(Status.ACCEPTED, sample(at, frame), ahead), name)
    modes = {"crate_link": Mode.PIVOT, "drum": Mode.STOP, "barrel": Mode.PIVOT}
    truth = truth_of([impact(60, body=frame, mode=mode, approach=0.5) for frame, mode in modes.items()], made)
    assert (truth.touchdowns, truth.missed, truth.mode_accuracy, truth.unresolved) == (2, 0, 0.5, 1)
    truths = {name: one.truth for name, one in made.compare().bodies.items()}
    assert {name: truth and truth.mode_accuracy for name, truth in truths.items()} == {
        "crate": 1.0,
        "drum": 0.0,
        "barrel": None,
    }


WALKER = SCENE._replace(walking=Walking(("left", "right")))
LANDING = touchdowns.TOUCHDOWN._replace(old=(), new=(0,), leftover=Leftover.DRIVEN)
NO_LANDING = NOTHING._replace(time_error_by_lead_time={"0.02": None, "0.05": None})

Told = dict[int, float]
"""For when a landing is announced, by when: both in ms."""


def test_warnings_are_compared_of_bodies_that_are_watched_where_impacts_are_known() -> None:
    for scene, knows, is_compared in (
        (SCENE, True, False),
        (SCENE._replace(watching=Watching()), True, True),
        (SCENE._replace(watching=Watching()), False, False),
    ):
        made = Comparison({"": scene}, knows_impacts=knows)
        made.add(Prediction(Status.ACCEPTED, sample(0)))
        assert any(body.warned is not None for body in made.compare().bodies.values()) == is_compared


def answer(
    at: int, announced: dict[int, Told], standing: tuple[str, ...], feet: tuple[str, ...], each: int = 1
) -> Prediction:
    """What is told at a time in ms of points, by their indices, `each` foot having so many."""
    touchdowns = [
        LANDING._replace(lead_time=(told[at] - at) * 1e-3, new=(point,))
        for point, told in announced.items()
        if at in told
    ]
    touchdowns.sort(key=lambda one: one.lead_time)
    soonest = {one.new[0] // each: one.lead_time for one in reversed(touchdowns)}
    states = tuple(Foot(foot, foot in standing, 0, 0.1, 0.0, soonest.get(i)) for i, foot in enumerate(feet))
    return Prediction(Status.ACCEPTED, sample(at, "base"), touchdowns[0] if touchdowns else None, feet=states)


def landings(
    until: int,
    stands: dict[str, tuple[int, ...]],
    announced: dict[int, Told],
    scene: Scene = WALKER,
    standing: tuple[str, ...] = (),
) -> Comparison:
    """Samples each ms up to `until`; `stands` has the times in ms at which each foot begins and ends to stand."""
    assert scene.walking is not None
    made = Comparison({"": scene}, knows_impacts=False)
    for at in range(until + 1):
        stands_now = [sum(at >= change for change in stands[foot]) % 2 == 1 for foot in scene.walking.feet]
        made.add_stances("base", at * MS, tuple(stands_now))
        made.add(answer(at, announced, standing, scene.walking.feet, scene.walking.points))
    return made


def together_of(made: Comparison) -> Truth:
    return truth_of([], made)


def landed(made: Comparison) -> list[tuple[str, int | None]]:
    return [(one.foot, one.stamp) for one in made.compare().matches]


def true_landing(foot: str, stamp: int) -> TrueLanding:
    state = LandingState(0.0, (0.0,) * 6, (), ((0.0, 0.0, -1.0),), ((0.0, 0.0, 0.0),))
    return TrueLanding(stamp, "base", foot, (foot,), (), (0.0, 0.0, 1.0), states=(state, state))


def test_a_foot_lands_when_its_flag_rises_but_not_with_the_first_one() -> None:
    made = landings(100, {"left": (0, 20, 60), "right": (30, 80)}, {})
    assert landed(made) == [("left", 60 * MS), ("right", 30 * MS)]


def test_landings_of_feet_are_found_foot_by_foot_and_modes_are_not_compared() -> None:
    announced = {0: dict.fromkeys(range(5, 70), 70.0), 1: dict.fromkeys(range(10, 71), 71.0)}
    made = landings(100, {"left": (70,), "right": (71,)}, announced)
    assert made.compare().bodies["base"].truth == together_of(made)
    assert together_of(made) == NO_LANDING._replace(
        touchdowns=2,
        median_time_error=0.0,
        time_error_by_lead_time={"0.02": 0.0, "0.05": 0.0},
        least_lead_time=pytest.approx(0.061),
    )


def test_an_announcement_of_the_wrong_foot_is_false_and_the_landing_missed() -> None:
    nobody = together_of(landings(100, {"left": (), "right": ()}, {0: dict.fromkeys(range(20, 60), 60.0)}))
    assert nobody == NO_LANDING._replace(false=1)
    truth = together_of(landings(100, {"left": (60,), "right": ()}, {1: dict.fromkeys(range(20, 60), 60.0)}))
    assert (truth.touchdowns, truth.missed, truth.false, truth.least_lead_time) == (1, 1, 1, None)


def test_a_foot_may_still_seem_to_come_down_when_the_plan_says_that_it_stands() -> None:
    announced = {0: {at: max(60.0, at + 2.0) for at in range(20, 75)}}
    truth = together_of(landings(200, {"left": (60,), "right": ()}, announced))
    assert (truth.missed, truth.false, truth.time_error_by_lead_time["0.02"]) == (0, 0, 0.0)
    longer = {0: {at: max(60.0, at + 2.0) for at in range(20, 85)}}
    assert together_of(landings(200, {"left": (60,), "right": ()}, longer)).false == 1


def test_the_toe_of_a_foot_that_stands_on_its_heel_lands_no_more() -> None:
    soles = WALKER._replace(walking=Walking(("left", "right"), points=2))
    toe = {1: dict.fromkeys(range(20, 60), 60.0)}
    stands: dict[str, tuple[int, ...]] = {"left": (0,), "right": (0, 10, 90)}
    assert together_of(landings(100, stands, toe, soles, standing=("left",))).false == 0
    assert together_of(landings(100, stands, toe, soles)).false == 1
    heel = {2: dict.fromkeys(range(20, 90), 90.0)}
    assert together_of(landings(100, stands, heel, soles)) == together_of(landings(100, stands, {3: heel[2]}, soles))


def test_true_landings_after_the_last_answer_are_counted_apart() -> None:
    made = Comparison({"": WALKER}, knows_impacts=False)
    made.add(answer(100, {}, (), ("left", "right")))
    for at, stands in ((50, (False, False)), (90, (True, False)), (130, (True, True))):
        made.add_stances("base", at * MS, stands)
    assert made.later_landings() == 1
    assert landed(made) == [("left", 90 * MS)]


def test_true_landings_of_a_simulation_are_found_like_those_of_a_plan() -> None:
    announced = {0: dict.fromkeys(range(5, 70), 70.0), 1: dict.fromkeys(range(10, 71), 71.0)}
    made = Comparison({"": WALKER}, knows_impacts=False, knows_landings=True)
    for at in range(100):
        made.add(answer(at, announced, (), ("left", "right")))
    nothing = together_of(made)
    assert (nothing.touchdowns, nothing.false) == (0, 2)
    made.landings += [true_landing("left", 70 * MS), true_landing("right", 72 * MS), true_landing("tail", 50 * MS)]
    assert landed(made) == [("left", 70 * MS), ("right", 72 * MS), ("tail", 50 * MS)]
    truth = together_of(made)
    assert (truth.touchdowns, truth.missed, truth.false) == (3, 1, 0)
    assert truth.median_time_error == pytest.approx(0.0005)


def test_of_bodies_without_feet_no_landing_is_compared() -> None:
    made = Comparison({"walker": WALKER, "crate": SCENE}, knows_impacts=False)
    for at in range(100):
        made.add_stances("crate", at * MS, (at > 50,))
        made.add_stances("walker", at * MS, (at > 50, True))
        made.add(answer(at, {0: dict.fromkeys(range(20, 51), 51.0)}, (), ("left", "right")), "walker")
        made.add(answer(at, {}, (), ()), "crate")
    assert landed(made) == [("left", 51 * MS)]
    assert list(made.compare().bodies) == ["walker"]
