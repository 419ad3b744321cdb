"""Whole twists after touchdowns: as made motions have them, as predicted, and as simple answers say."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import product
from math import hypot
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_score import SCENE, after, before, only_score, run

from impact_predictor.prediction.course import CONVERGED, Course, Pose, between
from impact_predictor.prediction.planar import Posture
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.recorded import Announced, TouchdownRecorder
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.skill import SIMPLE
from impact_predictor.prediction.spatial_score import SpatialScore
from impact_predictor.prediction.types import KINDS, Leftover, Sample, Score, SpatialTwist, kind_of

HALF = 0.05
CUBE = tuple((x, y, z) for x, y, z in product((-HALF, HALF), repeat=3))
TOSS = Scene(0.4, ((1e-3, 0, 0), (0, 1e-3, 0), (0, 0, 1e-3)), 0.2, restitution=0.5, points=CUBE)
STEP = 7_000_000
"""ns between the samples of a toss; its touchdown is at 0."""
CLOSE = 1e-8
"""Free flights are exact."""

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


class Toss(NamedTuple):
    """A cube in flight at the instant 0: mass centre, orientation, velocity and angular velocity."""

    center: Array
    turn: Rotation
    velocity: Array
    spin: Array

    def at(self, stamp: int) -> Sample:
        t = stamp * 1e-9
        turn = Rotation.from_rotvec(t * self.spin) * self.turn
        place = self.center + t * self.velocity + 0.5 * t * t * np.array(TOSS.gravity)
        linear = turn.inv().apply(self.velocity + t * np.array(TOSS.gravity))
        return Sample(
            stamp,
            "map",
            "cube",
            tuple(place.tolist()),
            tuple(turn.as_quat().tolist()),
            tuple(linear.tolist()),
            tuple(turn.inv().apply(self.spin).tolist()),
            (),
            (),
        )


def falling(tilt: tuple[float, float, float] = (0.6, 0.4, 0.3)) -> Toss:
    turn = Rotation.from_euler("xyz", tilt)
    lowest = float(turn.apply(np.array(CUBE))[:, 2].min())
    return Toss(np.array((0.0, 0.0, -lowest)), turn, np.array((0.5, -0.3, -1.5)), np.array((1.0, -2.0, 0.5)))


def samples_of(before_it: Toss, after_it: Toss, late: int = 3_000_000) -> list[Sample]:
    """Ten samples before the touchdown, the last one 4 ms, and six after it."""
    stamps = [late + k * STEP for k in range(-10, 6)]
    return [(before_it if stamp < 0 else after_it).at(stamp)._replace(stamp=stamp + 10**9) for stamp in stamps]


def told_after(toss: Toss) -> SpatialTwist:
    answers = run(Predictor(TOSS), samples_of(toss, toss)[:10])
    assert answers[-1].touchdown is not None
    return answers[-1].touchdown.after_6d


def gone_on(
    toss: Toss, twist: SpatialTwist, dv: tuple[float, ...] = (0, 0, 0), dw: tuple[float, ...] = (0, 0, 0)
) -> Toss:
    return toss._replace(velocity=np.add(twist.linear, dv), spin=np.add(twist.angular, dw))


def spatial_of(score: Score) -> SpatialScore:
    assert score.spatial is not None
    return score.spatial


def test_a_touchdown_that_went_on_as_predicted_has_no_error() -> None:
    toss = falling()
    score = only_score(TOSS, samples_of(toss, gone_on(toss, told_after(toss))))
    spatial = spatial_of(score)
    assert (score.kind, score.leftover_6d) == ("flight>corner", Leftover.NONE)
    assert spatial.error == pytest.approx(0.0, abs=1e-6)
    assert spatial.stamp == pytest.approx(10**9, abs=300_000)  # ns: extrapolated with the last mean rate
    assert spatial.late == pytest.approx(0.0, abs=3e-4)
    assert score.leftover & Leftover.ONE_POINT
    # The first of ten samples announced it, and the last one before it, 4 ms ahead.
    assert (score.announced, score.touchdown.lead_time) == pytest.approx((0.067, 0.004), abs=3e-4)


def test_the_error_is_that_of_all_components_relative_to_the_twist_before() -> None:
    toss, dv, dw = falling(), (0.03, -0.02, 0.05), (0.5, -0.2, 0.3)
    twist = told_after(toss)
    spatial = spatial_of(only_score(TOSS, samples_of(toss, gone_on(toss, twist, dv, dw))))
    scale = hypot(*toss.velocity, *(HALF * toss.spin))
    assert spatial.size == HALF
    assert spatial.error == pytest.approx(hypot(*dv, *(HALF * np.array(dw))) / scale, rel=1e-3)
    # The twist between the frames 10 and 17 ms after it, whose middle is 13.5 ms after it.
    assert spatial.measured.linear == pytest.approx(
        np.add(twist.linear, dv) + 0.0135 * np.array(TOSS.gravity), abs=CLOSE
    )
    assert spatial.measured.angular == pytest.approx(np.add(twist.angular, dw), abs=CLOSE)
    assert np.subtract(spatial.measured.linear, spatial.predicted.linear) == pytest.approx(dv, abs=1e-6)


def test_the_simple_answers_have_the_errors_that_follow_by_hand() -> None:
    toss = falling()
    twist = told_after(toss)
    spatial = spatial_of(only_score(TOSS, samples_of(toss, gone_on(toss, twist))))
    errors = dict(zip(SIMPLE, spatial.simple_errors, strict=True))
    scale = hypot(*toss.velocity, *(HALF * toss.spin))
    dv, dw = np.subtract(twist.linear, toss.velocity), np.subtract(twist.angular, toss.spin)
    assert errors["nothing"] == pytest.approx(hypot(*dv, *(HALF * dw)) / scale, rel=1e-6)
    # What stopped on a corner has hardly begun to fall 13.5 ms later.
    left = np.add(twist.linear, 0.0135 * np.array(TOSS.gravity))
    assert errors["stops"] == pytest.approx(hypot(*left, *(HALF * np.array(twist.angular))) / scale, abs=0.05)
    assert min(errors.values()) > spatial.error


def test_in_a_planar_landing_the_planar_law_is_the_prediction() -> None:
    spatial = spatial_of(only_score(SCENE, before() + after(5)))
    assert spatial.kind == "edge>face"
    assert spatial.simple_errors[-1] == pytest.approx(spatial.error, abs=CLOSE)


def test_a_plastic_impact_without_slip_stops_its_corner_and_conserves_momentum() -> None:
    toss = falling()
    corner = int(np.argmin(toss.turn.apply(np.array(CUBE))[:, 2]))
    start = Pose(tuple(toss.center.tolist()), tuple(toss.turn.as_quat().tolist()))
    linear, angular = Course(TOSS, CUBE, TOSS.gravity, start, (corner,)).stopped(
        SpatialTwist(tuple(toss.velocity.tolist()), tuple(toss.spin.tolist()))
    )
    arm = toss.turn.apply(CUBE[corner])
    assert np.add(linear, np.cross(angular, arm)) == pytest.approx(np.zeros(3), abs=1e-3)
    impulse = TOSS.mass * np.subtract(linear, toss.velocity)
    assert 1e-3 * np.subtract(angular, toss.spin) == pytest.approx(np.cross(arm, impulse), abs=1e-9)


def test_a_body_goes_on_by_gravity_and_comes_to_rest_on_its_face() -> None:
    start = Pose((0.0, 0.0, HALF + 0.01), (0.0, 0.0, 0.0, 1.0))
    course, level = Course(TOSS, CUBE, TOSS.gravity, start, ()), SpatialTwist((0.0, 0.0, -0.5), (0.0, 0.0, 0.0))
    early, late, later = course.poses(level, (0.01, 0.1, 0.15))
    assert early.center[2] == pytest.approx(HALF + 0.01 - 0.5 * 0.01 - 0.5 * 9.81 * 0.01**2, abs=CLOSE)
    assert late.center[2] == pytest.approx(HALF, abs=1e-5)
    assert between(late, later, 0.05).linear == pytest.approx((0.0, 0.0, 0.0), abs=CONVERGED)


@pytest.mark.parametrize("resting", [(), tuple(range(0, 8, 2))])
def test_a_body_over_a_higher_support_goes_on_as_much_higher(resting: tuple[int, ...]) -> None:
    twist = SpatialTwist((0.1, 0.0, 0.0 if resting else -0.5), (0.0, 0.0, 0.0))
    ends = []
    for up in (0.0, 0.25):
        start = Pose((0.0, 0.0, HALF + 0.01 + up), (0.0, 0.0, 0.0, 1.0))
        ends.append(Course(TOSS._replace(height=up), CUBE, TOSS.gravity, start, resting).poses(twist, (0.01, 0.1)))
    for low, high in zip(*ends, strict=True):
        assert np.subtract(high.center, low.center) == pytest.approx((0.0, 0.0, 0.25), abs=1e-9)
    # What rests stays as high as it seems to be.
    assert (ends[0][1].center[2] == pytest.approx(HALF + 0.01, abs=1e-4)) == bool(resting)


def test_a_body_that_slides_is_slowed_by_friction() -> None:
    start = Pose((0.0, 0.0, HALF), (0.0, 0.0, 0.0, 1.0))
    flat = TOSS._replace(friction=0.1)
    sliding = SpatialTwist((0.6, 0.8, 0.0), (0.0, 0.0, 0.0))
    one, other = Course(flat, CUBE, flat.gravity, start, tuple(range(0, 8, 2))).poses(sliding, (0.05, 0.1))
    # Gravity presses half of a step less at the first of them.
    way = 0.05 - 0.05 * 0.1 * 9.81 * 0.075
    assert np.subtract(other.center, one.center) == pytest.approx((0.6 * way, 0.8 * way, 0.0), abs=2e-4)


@pytest.mark.parametrize("angle", [0.3, 2.5, -3.0])
def test_the_twist_between_two_poses_turns_the_first_into_the_second(angle: float) -> None:
    axis = np.array((1.0, 2.0, -2.0)) / 3.0
    first = Rotation.from_euler("xyz", (0.3, -0.2, 0.9))
    second = Rotation.from_rotvec(angle * axis) * first
    for sign in (1.0, -1.0):  # both quaternions of an orientation
        other = tuple((sign * second.as_quat()).tolist())
        twist = between(Pose((0.0, 0.0, 0.0), tuple(first.as_quat().tolist())), Pose((1.0, 2.0, 3.0), other), 0.5)
        assert twist.linear == pytest.approx((2.0, 4.0, 6.0))
        assert twist.angular == pytest.approx(2.0 * angle * axis)


def test_lifts_are_told_and_measured_by_the_same_rise_of_the_gaps() -> None:
    resting = spatial_of(only_score(SCENE, before() + after(5)))
    old, new = resting.lifts
    assert old is not None
    assert new is not None
    assert (old.measured, new.measured, old.probability) == (False, False, None)
    assert (old.told, new.told) == (resting.told.after.omega < 0.0, False)
    corner = spatial_of(only_score(TOSS, samples_of(falling(), gone_on(falling(), told_after(falling())))))
    assert corner.lifts == (None, None)  # it always rises


def test_a_contact_about_which_the_body_turns_is_told_to_stay_however_small_the_tolerance() -> None:
    """The steps of the predicted course are chords, which leave the arc by micrometres."""
    turning = spatial_of(only_score(SCENE, before() + after(5)))
    exact = replace(turning, course=turning.course._replace(scene=SCENE._replace(tolerance=1e-9)))
    old, new = exact.lifts
    assert exact.told.after.omega < 0.0  # about the new contact
    assert (old and old.told, new and new.told) == (True, False)


@pytest.mark.parametrize(
    ("old", "new", "kind"), [*zip(((), (), (1,), (1,), (0, 1), (0, 1, 2)), ((3,), (3, 4)) * 3, KINDS, strict=True)]
)
def test_a_kind_tells_what_stood_and_what_struck(old: tuple[int, ...], new: tuple[int, ...], kind: str) -> None:
    assert kind_of(old, new) == kind


def recorded(
    *strikes: float, speeds: tuple[float, ...] = (-1.0, 0.5), frames: Iterable[float] = range(14)
) -> TouchdownRecorder:
    """A recorder that has seen points fall to their strikes and rise again; strikes and frames count from 0."""
    recorder = TouchdownRecorder(TOSS, 0.2)
    fall, rise = (0.007 * speed for speed in speeds)
    for k in frames:
        gaps = [(fall if k < strike else rise) * (k - strike) for strike in strikes]
        upright = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        posture = Posture(axes=upright, normal=upright[2], velocity=(0.0,) * 3, gaps=gaps, rates=[0.0] * len(gaps))
        sample = Sample(round(k * STEP), "", "", (0.0,) * 3, (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, (), ())
        recorder.take(sample, posture)
    return recorder


def test_a_strike_is_found_where_the_approach_ends_and_those_at_once_are_one() -> None:
    (found,) = recorded(4.5, 4.9, 20.0).found
    assert (found.new, found.old, found.kind) == ((0, 1), (), "flight>edge")
    assert found.stamp == pytest.approx(4.5 * STEP, rel=0.01)
    assert found.approach == pytest.approx(1.0)
    assert [frame.stamp for frame in found.frames[:3]] == [3 * STEP, 4 * STEP, 5 * STEP]


@pytest.mark.parametrize(
    ("second", "isolated"),
    [(5.4, [False, False]), (5.9, [False, False]), (6.9, [False, True]), (7.4, [True, True])],
    ids=["in the first frame after it", "a frame later", "before its third frame", "after its third frame"],
)
def test_a_touchdown_is_isolated_if_no_other_one_spoils_its_frames(second: float, isolated: list[bool]) -> None:
    first = 4.5
    assert [one.is_isolated for one in recorded(first, second).found] == isolated


def test_what_is_slow_or_only_grazes_is_no_strike() -> None:
    assert not recorded(4.5, speeds=(-0.09, 0.05)).found  # gravity adds 0.07 m/s in a frame
    assert not recorded(4.5, speeds=(-1.0, -0.7)).found


def test_frames_may_differ_in_length_but_a_pause_hides_a_strike() -> None:
    (found,) = recorded(4.3, frames=(0, 1, 2, 3, 4.4, 5.8, 7, 8, 9)).found
    assert found.stamp == pytest.approx(4.3 * STEP, rel=0.02)  # extrapolated as if it fell freely
    assert not recorded(4.5, frames=(0, 1, 2, 3, 5, 6, 7, 8, 9)).found


def test_what_was_seen_is_known_until_it_is_forgotten() -> None:
    recorder = recorded(4.5, 10.5)
    assert recorder.knows(round(4.5 * STEP))
    assert not recorder.knows(round(10.5 * STEP))  # its frames are still to come
    recorder.forget()
    assert not recorder.knows(0)


def test_a_touchdown_that_nobody_announced_is_counted_as_missed() -> None:
    assert recorded(4.5, frames=range(20)).counts == {"flight>corner": Announced(1, 0)}
    assert recorded(4.5, frames=range(8)).counts == {}  # it may still find its prediction


@pytest.mark.parametrize(("sees", "announced"), [(10, 1), (0, 0)], ids=["seen coming", "seen at once"])
def test_a_touchdown_that_was_predicted_for_its_time_is_counted_as_announced(sees: int, announced: int) -> None:
    toss, predictor = falling(), Predictor(TOSS)
    samples = samples_of(toss, gone_on(toss, told_after(toss)))
    # Until it is seen coming its twist tells that it rises, so fast that no touchdown lies within the horizon.
    rising = (0.0, 0.0, 0.5 * 9.81 * TOSS.horizon**2 + 2.0)
    run(predictor, [one if k >= 10 - sees else one._replace(linear=rising) for k, one in enumerate(samples)])
    predictor.finish()
    assert predictor.contacts.recorded == {"flight>corner": Announced(1, announced)}


def test_touchdowns_that_follow_at_once_are_not_scored() -> None:
    """A body comes down with 1 m/s, rises for 5.75 ms, and is back after 11.5 ms, on another corner."""
    still = {"velocity": np.array((0.0, 0.0, -1.0)), "spin": np.zeros(3)}
    one, other = falling()._replace(**still), falling((-0.6, -0.4, -0.3))._replace(**still)
    samples = []
    for sample in samples_of(one, one):
        time = (sample.stamp - 10**9) * 1e-9
        toss = one if time < 0.00575 else other
        height = -time if time < 0.0 else time if time < 0.00575 else abs(time - 0.0115)
        upwards = 1.0 if 0.0 < time < 0.00575 or time > 0.0115 else -1.0
        center, velocity = np.add(toss.center, (0.0, 0.0, height)), np.array((0.0, 0.0, upwards))
        moved = toss._replace(center=center, velocity=velocity).at(0)
        samples.append(moved._replace(stamp=sample.stamp))
    scores = [answer.score for answer in run(Predictor(TOSS), samples) if answer.score is not None]
    assert scores
    assert scores[0].leftover_6d is Leftover.NOT_ISOLATED


def test_a_record_that_ends_too_early_says_so() -> None:
    predictor = Predictor(TOSS)
    toss = falling()
    run(predictor, samples_of(toss, gone_on(toss, told_after(toss)))[:13])
    (score,) = predictor.finish()
    assert (score.leftover_6d, score.spatial) == (Leftover.TOO_SHORT, None)


def test_a_prediction_of_other_points_is_scored_as_a_whole_twist_alone() -> None:
    """Told is an edge, a corner strikes first: the plane of the edge is not that of what happens."""
    toss = falling(tilt=(0.5, 0.002, 0.0))
    answers = run(Predictor(TOSS), samples_of(toss, toss)[:10])
    assert answers[-1].touchdown is not None
    assert len(answers[-1].touchdown.new) == 2
    tilted = falling(tilt=(0.5, 0.05, 0.0))
    samples = samples_of(toss, toss)[:10] + samples_of(tilted, gone_on(tilted, told_after(tilted)))[10:]
    score = only_score(TOSS, samples)
    assert not score.scored
    assert score.spatial is not None
