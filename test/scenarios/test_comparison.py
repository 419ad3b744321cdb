"""Which predictions belong to which true impacts, and what is said of them, on records that one can count by hand."""

from __future__ import annotations

from collections.abc import Iterable

import pytest
import touchdowns

from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Prediction, Sample, Status
from impact_predictor.scenarios.comparison import Truth
from impact_predictor.scenarios.comparison import compare as compare_all
from impact_predictor.scenarios.matching import Announcements
from impact_predictor.scenarios.truth import TrueImpact

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


def compare(impacts: Iterable[TrueImpact], announcements: Announcements, scene: Scene) -> Truth:
    """What is said but of times ahead, which have tests of their own."""
    together = compare_all(impacts, announcements, {"": scene}).together
    return together._replace(time_error_by_lead_time=NOTHING.time_error_by_lead_time, least_lead_time=None)


def impact(at: float, **changes: object) -> TrueImpact:
    """An impact at a time in ms, which `TOUCHDOWN` predicts exactly."""
    true = TrueImpact(
        round(at * MS),
        "rod",
        Mode.PIVOT,
        (0,),
        (1,),
        1.0,
        0.5,
        1.0,
        (0.0, 0.0, -1.0),
        (0.0, 2.0, 0.0),
        (0.0, 0.0, 0.5),
        (0.0, 1.0, 0.0),
    )
    return true._replace(**changes)  # type: ignore[arg-type]


def sample(at: float, body: str = "rod") -> Sample:
    zeros = (0.0,) * 36
    return Sample(round(at * MS), "world", body, (0.0,) * 3, (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, zeros, zeros)


def record(until: int, announced: dict[int, float] | None = None, **changes: object) -> Announcements:
    """Samples each ms up to `until`, of which some announce a touchdown: both times in ms."""
    made = Announcements()
    for at in range(until + 1):
        touchdown = None
        if announced is not None and at in announced:
            touchdown = TOUCHDOWN._replace(lead_time=(announced[at] - at) * 1e-3, **changes)  # type: ignore[arg-type]
        made.add(Prediction(Status.ACCEPTED, sample(at), touchdown))
    return made


def test_a_touchdown_that_is_predicted_exactly_has_no_error() -> None:
    made = record(100, dict.fromkeys(range(20, 60), 60.0))
    assert compare([impact(60)], made, SCENE) == Truth(1, 0, 0, 0, 1.0, 0.0, 0.0, 1, 1.0)


def test_the_error_of_time_is_that_of_the_prediction_20_ms_ahead() -> None:
    made = record(100, {at: 60.0 + (60 - at) * 0.1 for at in range(20, 60)})
    assert compare([impact(60)], made, SCENE).median_time_error == pytest.approx(0.002)
    late = record(100, dict.fromkeys(range(41, 60), 60.0))
    assert compare([impact(60)], late, SCENE).median_time_error is None


def test_the_error_of_time_is_told_by_how_long_ahead_and_how_long_ahead_the_first_prediction_was() -> None:
    drifting = {at: 60.0 + (60 - at) * 0.1 for at in range(5, 60)} | dict.fromkeys(range(66, 90), 90.0)
    truth = compare_all([impact(60), impact(90)], record(100, drifting), {"": SCENE}).together
    assert truth.time_error_by_lead_time == {"0.02": pytest.approx(0.001), "0.05": pytest.approx(0.005)}
    assert truth.least_lead_time == pytest.approx(0.024)
    nothing = compare_all([impact(60)], record(100), {"": SCENE}).together
    assert nothing.time_error_by_lead_time == {"0.02": None, "0.05": None}
    assert nothing.least_lead_time is None


def test_mode_and_velocity_are_those_of_the_last_prediction() -> None:
    made = record(
        100, dict.fromkeys(range(20, 60), 60.0), mode=Mode.STOP, linear=(0.3, 0.0, 0.5), angular=(0.0, 1.8, 0.0)
    )
    truth = compare([impact(60)], made, SCENE)
    assert truth.mode_accuracy == 0.0
    # Wrong by 0.3 m/s and 0.8 rad/s at 0.5 m, of -1 m/s and 2 rad/s at 0.5 m.
    assert truth.median_velocity_error == pytest.approx(0.5 / 2.0**0.5)


def test_a_touchdown_without_a_prediction_is_missed_and_a_prediction_without_a_touchdown_is_false() -> None:
    made = record(200, dict.fromkeys(range(20, 60), 60.0))
    assert compare([impact(150)], made, SCENE) == Truth(1, 1, 1, 0, None, None, None)
    assert compare([], made, SCENE) == NOTHING._replace(false=1)


@pytest.mark.parametrize(("away", "found"), [(-20.0, True), (20.0, True), (-20.1, False), (20.1, False)])
def test_a_prediction_is_of_a_touchdown_within_20_ms(away: float, found: bool) -> None:
    made = record(200, dict.fromkeys(range(20, 60), 100.0 + away))
    truth = compare([impact(100)], made, SCENE)
    assert (truth.missed, truth.false) == ((0, 0) if found else (1, 1))


def test_a_prediction_that_pauses_is_of_one_touchdown() -> None:
    made = record(100, {at: 60.0 for at in range(20, 60) if at not in (30, 31, 45)})
    assert compare([impact(60)], made, SCENE) == Truth(1, 0, 0, 0, 1.0, 0.0, 0.0, 1, 1.0)


def test_of_two_touchdowns_close_together_each_has_its_own_predictions() -> None:
    first, second = dict.fromkeys(range(20, 50), 50.0), dict.fromkeys(range(51, 56), 56.0)
    truth = compare([impact(50), impact(56, mode=Mode.STOP)], record(100, first | second), SCENE)
    assert truth == Truth(2, 0, 0, 0, 0.5, 0.0, 0.0, 2, 0.5)


def test_nothing_is_predicted_of_what_has_happened() -> None:
    # The impact lies before the first prediction, so 5 ms between them make no match.
    assert compare([impact(50)], record(100, {52: 55.0}), SCENE) == Truth(1, 1, 1, 0, None, None, None)


def test_a_prediction_without_lead_time_announces_nothing() -> None:
    assert compare([], record(100, {52: 52.0}), SCENE) == NOTHING


def test_what_the_record_does_not_reach_is_not_counted() -> None:
    assert compare([impact(120)], record(100, dict.fromkeys(range(50, 101), 120.0)), SCENE) == NOTHING


@pytest.mark.parametrize(("until", "false"), [(100, 1), (99, 0), (90, 0), (81, 0)])
def test_what_is_announced_for_the_last_20_ms_of_a_record_is_neither_found_nor_false(until: int, false: int) -> None:
    made = record(until, dict.fromkeys(range(20, 80), 80.0))
    # It comes 5 ms after the record, or never: nobody can tell.
    for impacts in ([], [impact(until + 5)]):
        together, bodies, matches = compare_all(impacts, made, {"": SCENE})
        assert (together.touchdowns, together.missed, together.false) == (0, 0, false)
        assert bodies["rod"] == together
        assert len(matches) == false
    # One that the record shows is found.
    found = compare([impact(70)], made, SCENE)
    assert (found.touchdowns, found.missed, found.false) == (1, 1, false)
    assert compare([impact(80)], made, SCENE).missed == 0


def test_a_touchdown_that_was_told_for_after_the_end_and_came_before_it_is_found() -> None:
    truth = compare([impact(98)], record(100, dict.fromkeys(range(50, 98), 103.0)), SCENE)
    assert (truth.touchdowns, truth.missed, truth.false, truth.median_time_error) == (1, 0, 0, pytest.approx(0.005))


def test_impacts_that_no_sample_shows_are_not_missed() -> None:
    # At 10.2 ms there was no sample since 10.1 ms, at 11.4 ms one; gravity makes 0.00981 m/s in the 1 ms of a contact.
    impacts = [impact(10.1), impact(10.2), impact(11.4), impact(20.5, approach=0.0098)]
    assert compare(impacts, record(100, {5: 10.1, 6: 10.1}), SCENE) == Truth(1, 0, 0, 3, 1.0, 0.0, None, 1, 1.0)
    assert compare(impacts, record(100), SCENE) == Truth(1, 1, 0, 3, None, None, None)


def test_bodies_are_told_apart_and_those_without_samples_do_not_count() -> None:
    made = record(100, dict.fromkeys(range(20, 60), 60.0))
    for at in range(101):
        made.add(Prediction(Status.ACCEPTED, sample(at, "plate"), None))
    impacts = [impact(60), impact(60, body="plate"), impact(60, body="cylinder")]
    assert compare(impacts, made, SCENE) == Truth(2, 1, 0, 0, 1.0, 0.0, 0.0, 1, 1.0)
    assert compare([impact(60)], Announcements(), SCENE) == NOTHING


def test_velocities_are_compared_at_the_mass_centre() -> None:
    # The body frame lies 0.2 m behind the mass centre, which moves up by 0.2 m * 1 rad/s less there.
    scene = SCENE._replace(center_of_mass=(0.2, 0.0, 0.0))
    made = record(100, dict.fromkeys(range(20, 60), 60.0), linear=(0.0, 0.0, 0.7))
    assert compare([impact(60)], made, scene).median_velocity_error == pytest.approx(0.0, abs=1e-15)


def test_the_mode_counts_where_a_small_error_does_not_change_it() -> None:
    first, second = dict.fromkeys(range(20, 50), 50.0), dict.fromkeys(range(51, 90), 90.0)
    made = record(100, first | second)
    near = impact(50, mode=Mode.STOP, border=0.019)
    truth = compare([near, impact(90, border=0.021)], made, SCENE)
    assert (truth.mode_accuracy, truth.clear, truth.clear_mode_accuracy) == (0.5, 1, 1.0)
    truth = compare([near], record(100, first), SCENE)
    assert (truth.mode_accuracy, truth.clear, truth.clear_mode_accuracy) == (0.0, 0, None)


def test_a_wrong_prediction_of_an_impact_that_no_record_shows_is_counted_apart() -> None:
    slow = impact(60, approach=0.001, mode=Mode.STOP)
    truth = compare([slow], record(100, dict.fromkeys(range(20, 60), 60.0)), SCENE)
    assert (truth.touchdowns, truth.false, truth.unresolved, truth.unresolved_wrong) == (0, 0, 1, 1)
    right = compare([slow._replace(mode=Mode.PIVOT)], record(100, dict.fromkeys(range(20, 60), 60.0)), SCENE)
    assert (right.unresolved, right.unresolved_wrong) == (1, 0)
    assert compare([slow], record(100), SCENE).unresolved_wrong == 0


def named(names: dict[str, str], announced: float) -> Announcements:
    """What is announced for a time in ms of bodies by their names, whose frames are given."""
    made = Announcements()
    for at in range(100):
        for name, frame in names.items():
            ahead = TOUCHDOWN._replace(lead_time=(announced - at) / 1000) if 20 <= at < announced else None
            made.add(Prediction(Status.ACCEPTED, sample(at, frame), ahead), name)
    return made


def test_bodies_go_by_their_names_and_truths_may_call_them_by_their_frames() -> None:
    made = named({"crate": "crate_link", "drum": "drum"}, 60.0)
    impacts = [impact(60, body="crate_link"), impact(60, body="drum", mode=Mode.STOP)]
    together, bodies, _ = compare_all(impacts, made, {"crate": SCENE, "drum": SCENE})
    assert (together.touchdowns, together.missed, together.mode_accuracy) == (2, 0, 0.5)
    assert {name: truth.mode_accuracy for name, truth in bodies.items()} == {"crate": 1.0, "drum": 0.0}


def test_each_body_is_compared_in_its_own_scene() -> None:
    # Gravity makes 0.981 m/s in the 0.1 s of a contact of the drum, so that 0.5 m/s cannot be told from rest there.
    made = named({"crate": "crate", "drum": "drum"}, 60.0)
    impacts = [impact(60, body=name, approach=0.5) for name in ("crate", "drum")]
    _, bodies, _ = compare_all(impacts, made, {"crate": SCENE, "drum": SCENE._replace(contact_time=0.1)})
    assert [(truth.touchdowns, truth.unresolved) for truth in bodies.values()] == [(1, 0), (0, 1)]
