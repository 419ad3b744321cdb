"""Impacts and free flights are found from the heights of the corners alone, at any rate."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from free_flight import flights_of
from scipy.spatial.transform import Rotation
from tossed_bodies import CENTER, CORNERS, HALF, SCENE, tosses

from impact_predictor import read_scenes
from impact_predictor.bags.replay import replay
from impact_predictor.calibration.impacts import MotionRecord
from impact_predictor.calibration.motions import Reals, RecordedMotion, RecordingMonitor, distinct
from impact_predictor.errors import InputError
from impact_predictor.prediction.scene import MovingDeck, Scene
from impact_predictor.prediction.types import KINDS, Geometry, Sample
from impact_predictor.resources import find

NUMBER = 30


@pytest.mark.parametrize("rate", [100.0, 200.0, 500.0, 1000.0])
def test_the_first_impact_of_each_toss_is_found_at_its_corner_at_any_rate(rate: float) -> None:
    for toss in tosses(NUMBER, rate):
        time, corner, approach = toss.strikes[0]
        first = MotionRecord(SCENE, toss.motion).impacts[0]
        assert first.time == pytest.approx(time, abs=2e-3)
        assert first.frame / rate <= time <= (first.frame + first.stride) / rate + 2e-3
        assert corner in first.new
        assert not first.old
        if len(first.new) == 1:
            # Until then gravity adds to it, and the body turns.
            assert first.approach == pytest.approx(approach, rel=0.1)
            scene = SCENE._replace(center_of_mass=tuple(CENTER.tolist()))
            met, height = first.meeting(scene, toss.motion.points[corner])
            if first.isolated:
                # The strike itself is a step of the simulation long.
                assert met == pytest.approx(time, abs=5e-4)
                assert height == pytest.approx(0.0, abs=1e-3)


def test_clear_impacts_that_are_alone_are_found_within_a_frame_and_hardly_any_besides() -> None:
    alone = missed = found = invented = 0
    for toss in tosses(NUMBER, noise=1e-4):
        times = [time for time, _, _ in toss.strikes]
        impacts = MotionRecord(SCENE, toss.motion).impacts
        assert [one.time for one in impacts] == sorted(one.time for one in impacts)
        found += len(impacts)
        invented += sum(min(abs(one.time - time) for time in times) > 7.5e-3 for one in impacts)
        for k, (time, corner, approach) in enumerate(toss.strikes):
            if (
                all(abs(time - other) > 0.025 for other in times[:k] + times[k + 1 :])
                and approach > 0.3
                and time < 0.58
            ):
                alone += 1
                missed += not any(abs(one.time - time) < 5e-3 and corner in one.new for one in impacts)
    assert alone > NUMBER
    assert missed <= 0.02 * alone
    assert invented <= 0.04 * found


def test_velocities_around_an_impact_are_those_of_the_poses_before_and_after_it() -> None:
    toss = tosses(NUMBER)[0]
    first = MotionRecord(SCENE, toss.motion).impacts[0]
    k, motion = first.frame, toss.motion
    for seen, one in ((first.before, k - 1), (first.after, k + 2)):
        assert seen.time == pytest.approx((one + 0.5) / 200.0)
        places = motion.positions + motion.rotations @ CENTER
        assert seen.linear + seen.turning @ CENTER == pytest.approx((places[one + 1] - places[one]) * 200.0)
        turned = Rotation.from_rotvec(seen.angular / 200.0).as_matrix() @ motion.rotations[one]
        assert turned == pytest.approx(motion.rotations[one + 1])


def laid(tilts: Reals, axis: tuple[float, float, float]) -> RecordedMotion:
    """A box that turns by angles (rad) about an axis through a corner of its lower face, at 200 Hz."""
    turns = Rotation.from_rotvec(np.outer(tilts, axis)).as_matrix()
    return RecordedMotion(np.arange(len(tilts)) * 5_000_000, turns @ HALF, turns, CORNERS)


TILTING = np.concatenate((np.linspace(0.1, 0.0, 11), np.zeros(9)))


@pytest.mark.parametrize(
    ("axis", "kind", "old", "new"),
    [
        ((0.0, -1.0, 0.0), "edge>face", 2, 2),
        ((1.0, -1.0, 0.0), "corner>edge+", 1, 3),
    ],
)
def test_a_box_that_falls_onto_its_face_strikes_beside_the_edge_or_corner_on_which_it_stood(
    axis: tuple[float, float, float], kind: str, old: int, new: int
) -> None:
    (impact,) = MotionRecord(SCENE, laid(TILTING, axis)).impacts
    assert impact.kind == kind
    assert (len(impact.old), len(impact.new)) == (old, new)
    assert impact.isolated


def test_a_body_at_rest_strikes_nothing_however_noisy_it_is() -> None:
    for noise in (0.0, 1e-4, 1e-3):
        still = laid(np.zeros(400), (1.0, 0.0, 0.0))
        shaken = still.positions + np.random.default_rng(0).normal(0.0, noise, still.positions.shape)
        record = MotionRecord(SCENE, still._replace(positions=shaken))
        assert record.impacts == []
        assert flights_of(record) == []


def test_a_body_that_turns_back_above_its_support_between_two_poses_has_not_struck_it() -> None:
    far = 0.006 * np.arange(7, 0, -1)  # at 1.2 m/s
    for missed, struck in ((0.0, 1), (0.007, 0)):
        heights = np.concatenate([0.003 + far, [0.003, 0.003 + missed], 0.003 + missed + far[::-1]])
        flat = laid(np.zeros(len(heights)), (1.0, 0.0, 0.0))
        motion = flat._replace(positions=flat.positions + np.outer(heights, [0.0, 0.0, 1.0]))
        assert len(MotionRecord(SCENE, motion).impacts) == struck


def test_free_flights_hold_no_impact_and_leave_out_what_is_near_the_support() -> None:
    for toss in tosses(NUMBER):
        record = MotionRecord(SCENE, toss.motion)
        assert flights_of(record)
        for flight in flights_of(record):
            begin, end = record.motion.times[flight][[0, -1]]
            assert not any(begin < time < end for time, _, _ in toss.strikes)
            assert record.motion.gaps(SCENE)[flight].min() > SCENE.tolerance


def test_a_pause_ends_a_flight_and_hides_an_impact() -> None:
    stamps, positions, rotations, points = tosses(NUMBER)[0].motion
    whole = MotionRecord(SCENE, tosses(NUMBER)[0].motion)
    flight, impact = max(flights_of(whole), key=lambda run: run.stop - run.start), whole.impacts[0]
    for lost in ((flight.start + flight.stop) // 2, impact.frame + 1):
        kept = np.delete(np.arange(len(stamps)), [lost, lost + 1])
        record = MotionRecord(SCENE, RecordedMotion(stamps[kept], positions[kept], rotations[kept], points))
        assert flights_of(record)
        assert max(np.diff(record.motion.times[run]).max() for run in flights_of(record)) < 1.5 / 200.0
    assert impact.time < min(one.time for one in record.impacts) - 0.01


def test_a_motion_turned_about_the_vertical_or_numbered_anew_counts_once() -> None:
    one, other = (toss.motion for toss in tosses(NUMBER)[:2])
    turn = Rotation.from_rotvec([0.0, 0.0, 1.0]).as_matrix()
    turned = one._replace(positions=one.positions @ turn.T + [1.0, 2.0, 0.0], rotations=turn @ one.rotations)
    renumbered = one._replace(points=one.points[::-1])
    assert distinct(SCENE, [one, turned, other, renumbered]) == [one, other]


@pytest.mark.parametrize("number", [1, 2, 4])
def test_a_record_that_is_too_short_holds_nothing(number: int) -> None:
    stamps, positions, rotations, points = tosses(NUMBER)[0].motion
    motion = RecordedMotion(stamps[:number], positions[:number], rotations[:number], points)
    record = MotionRecord(SCENE, motion)
    assert record.impacts == []
    assert flights_of(record) == []


def test_motions_end_at_pauses_and_where_the_points_change() -> None:
    monitor = RecordingMonitor({"": SCENE})
    corners = tuple(map(tuple, CORNERS.tolist()))
    stamps = [0, 10, 20, 500, 510]
    for stamp in stamps:
        if stamp == 510:
            monitor.tell("", Geometry(0, "", corners[:4]))
        if stamp == 0:
            monitor.tell("", Geometry(0, "", corners))
        still = (0.0, 0.0, 0.0)
        monitor.update("", Sample(stamp * 1_000_000, "", "", still, (0.0, 0.0, 0.0, 1.0), still, still, (), ()))
    assert [motion.stamps.tolist() for motion in monitor.motions] == [[0, 10**7, 2 * 10**7], [5 * 10**8], [51 * 10**7]]
    assert [len(motion.points) for motion in monitor.motions] == [8, 8, 4]


@pytest.mark.parametrize("scenes", [{"": SCENE._replace(deck=MovingDeck())}, {"a": SCENE, "b": SCENE}], ids=len)
def test_a_body_on_a_deck_or_several_are_refused_in_one_sentence(scenes: dict[str, Scene]) -> None:
    with pytest.raises(InputError, match="one body on contact points over a fixed support"):
        RecordingMonitor(scenes)


@pytest.mark.slow
def test_the_shipped_tosses_hold_every_kind_of_impact() -> None:
    scenes = read_scenes(str(find("config/cube_tosses.yaml")))
    monitor = RecordingMonitor(scenes)
    replay(find("examples/cube_tosses"), scenes, monitor=monitor)
    single = distinct(scenes[""], monitor.motions)
    assert (len(monitor.motions), len(single)) == (285, 279)
    impacts = [impact for motion in single for impact in MotionRecord(scenes[""], motion).impacts]
    kinds = Counter(impact.kind for impact in impacts if impact.approach > 0.2)
    assert kinds.keys() == set(KINDS)
    assert kinds["flight>corner"] == pytest.approx(578, abs=10)
    assert kinds["edge>face"] == pytest.approx(280, abs=10)
    assert kinds.total() == pytest.approx(1446, abs=15)
