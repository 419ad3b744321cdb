"""The life of a touchdown: announced, revised, held, settled, measured, scored."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Contact, Twist, TwoPointBody
from impact_predictor.prediction.checks import PAUSE
from impact_predictor.prediction.planar import posture_of
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.score import LONGEST, Pending, Track
from impact_predictor.prediction.types import Geometry, Leftover, Prediction, Sample, Score, Status, Vector3

PERIOD = 5_000_000
"""ns between samples."""
CLOSE = 1e-8
"""The reference fall is integrated to 1e-12."""

BACK, FRONT, LOW = -0.1, 0.1, -0.15
BLOCK: tuple[Vector3, ...] = tuple((x, y, LOW) for x, y in product((BACK, FRONT), (-0.1, 0.1)))
SCENE = Scene(1.0, ((0.006, 0, 0), (0, 0.006, 0), (0, 0, 0.006)), 1.2, points=BLOCK)
"""A tall block that stands on its back edge and falls on its front edge, about which it goes on turning."""
ARM = math.hypot(BACK, LOW)
SQUARE = 0.006 + ARM * ARM


Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def fall(angle: float, omega: float) -> tuple[float, Callable[[float], Array]]:
    """When the block touches that turns about its back edge, and its angle (rad) and rate (rad/s) until then."""

    def rates(_: float, state: Array) -> list[float]:
        bearing = state[0] + math.atan2(-LOW, -BACK)
        return [state[1], -9.81 * ARM * math.cos(bearing) / SQUARE]

    def level(_: float, state: Array) -> float:
        return float(state[0])

    level.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        rates, (0.0, 1.0), [angle, omega], "DOP853", events=level, rtol=1e-12, atol=1e-13, dense_output=True
    )
    return float(found.t_events[0][0]), found.sol


END, STATE = fall(angle=0.1, omega=-1.0)
TOUCH = round(END * 1e9)
"""ns of the touchdown; it lies between two samples, 2 to 5 ms after the first."""
BEFORE_SAMPLES = TOUCH // PERIOD + 1
RATE = float(STATE(END)[1])
BEFORE = Twist(RATE * LOW, RATE * -BACK, RATE)
AFTER = solve_impact(TwoPointBody(1.0, 0.006, Contact(BACK, LOW, 1.2), Contact(FRONT, LOW, 1.2)), BEFORE).twist
SCALE = math.hypot(BEFORE.vx, BEFORE.omega * 0.1)


def block(stamp: int, angle: float, twist: Twist, height: float = 0.0) -> Sample:
    """The block with its back edge at x = BACK on the floor, turned up by an angle (CCW, so about -y)."""
    sine, cosine = math.sin(angle), math.cos(angle)
    x, z = BACK - (BACK * cosine - LOW * sine), -(BACK * sine + LOW * cosine) + height
    velocity = (twist.vx * cosine + twist.vy * sine, 0.0, twist.vy * cosine - twist.vx * sine)
    orientation = 0.0, -math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)
    return Sample(stamp, "map", "block", (x, 0.0, z), orientation, velocity, (0.0, -twist.omega, 0.0), (), ())


def falling(stamp: int, spin: float = 1.0, height: float = 0.0, lag: float = 0.0) -> Sample:
    """A sample of the fall, its rates multiplied by a factor, or those of some seconds before."""
    angle, _ = (float(part) for part in STATE(stamp * 1e-9))
    _, omega = (spin * float(part) for part in STATE(stamp * 1e-9 - lag))
    bearing = angle + math.atan2(-LOW, -BACK)
    twist = Twist(-omega * ARM * math.sin(bearing), omega * ARM * math.cos(bearing), omega)
    return block(stamp, angle, twist, height)


def landed(stamp: int, vx: float = AFTER.vx, omega: float = AFTER.omega, vy: float = AFTER.vy) -> Sample:
    """A sample of the block lying flat, with any twist."""
    return block(stamp, 0.0, Twist(vx, vy, omega))


def before() -> list[Sample]:
    return [falling(k * PERIOD) for k in range(BEFORE_SAMPLES)]


def after(count: int, first: int = BEFORE_SAMPLES) -> list[Sample]:
    return [landed(k * PERIOD) for k in range(first, first + count)]


def run(predictor: Predictor, samples: list[Sample]) -> list[Prediction]:
    answers = [predictor.update(sample) for sample in samples]
    assert {answer.status for answer in answers} == {Status.ACCEPTED}
    return answers


def only_score(scene: Scene, samples: list[Sample]) -> Score:
    scores = [answer.score for answer in run(Predictor(scene), samples) if answer.score is not None]
    (score,) = scores
    return score


def test_a_touchdown_that_happened_as_predicted_has_no_error() -> None:
    score = only_score(SCENE, before() + after(4))
    assert score.scored
    assert score.leftover is Leftover.NONE
    assert score.stamp == pytest.approx(TOUCH, abs=10)  # ns: CLOSE of a second
    assert score.touchdown.before == pytest.approx(BEFORE, abs=CLOSE)
    assert score.measured == pytest.approx(AFTER, abs=CLOSE)
    assert score.relative_error == pytest.approx(0.0, abs=CLOSE)


def test_a_body_that_is_seen_a_little_too_low_has_landed_where_the_points_on_which_it_stood_are_as_low() -> None:
    low = [one._replace(position=(one.position[0], 0.0, one.position[2] - 0.004)) for one in before() + after(4)]
    score = only_score(SCENE, low)
    assert score.scored
    assert len(score.touchdown.old) == 2
    assert score.relative_error == pytest.approx(0.0, abs=CLOSE)


def test_the_median_of_the_samples_two_to_four_after_the_touchdown_is_what_is_measured() -> None:
    twists = [(0.9, 0.0, 0.9), (0.3, -0.1, 0.2), (0.1, -0.3, 0.0), (0.2, -0.2, -0.2), (0.8, 0.0, 0.8)]
    stamps = [sample.stamp for sample in after(5)]
    samples = [landed(stamp, vx, omega, vy) for stamp, (vx, omega, vy) in zip(stamps, twists, strict=True)]
    score = only_score(SCENE, before() + samples)
    assert score.measured == pytest.approx((0.2, 0.0, -0.2), abs=CLOSE)


def test_the_error_is_that_of_the_velocities_relative_to_those_before() -> None:
    vx, omega = AFTER.vx + 0.03, AFTER.omega - 0.4
    samples = [landed(sample.stamp, vx, omega) for sample in after(4)]
    score = only_score(SCENE, before() + samples)
    assert score.relative_error == pytest.approx(math.hypot(0.03, 0.4 * 0.1) / SCALE, abs=CLOSE)


def test_the_history_has_the_lead_time_and_the_error_of_every_prediction() -> None:
    samples = before()
    samples[5] = falling(samples[5].stamp, spin=0.9)
    odd = Predictor(SCENE).update(samples[5]).touchdown
    assert odd is not None
    score = only_score(SCENE, samples + after(4))
    leads = [lead for lead, _ in score.history]
    assert leads == pytest.approx([END - sample.stamp * 1e-9 for sample in samples], abs=CLOSE)
    errors = [error for _, error in score.history]
    wrong = math.hypot(odd.after.vx - AFTER.vx, (odd.after.omega - AFTER.omega) * 0.1) / SCALE
    assert wrong > 0.01
    assert errors == pytest.approx([wrong if k == 5 else 0.0 for k in range(len(samples))], abs=CLOSE)


def test_each_earlier_prediction_is_measured_in_its_own_plane() -> None:
    """A sample that spins about the normal as well, and whose edge is turned: its plane is, and so is what it sees."""
    samples = before()
    yaw = 0.2
    x, _, z = samples[4].position
    _, y_part, _, w_part = samples[4].orientation
    half = (math.sin(0.5 * yaw), math.cos(0.5 * yaw))
    turned = samples[4]._replace(
        position=(x * math.cos(yaw), x * math.sin(yaw), z),
        orientation=(-half[0] * y_part, half[1] * y_part, half[0] * w_part, half[1] * w_part),
    )
    plain = only_score(SCENE, samples + after(4))
    samples[4] = turned
    score = only_score(SCENE, samples + after(4))
    assert score.history[3] == plain.history[3]
    seen = math.hypot(AFTER.vx * math.cos(yaw) - AFTER.vx, (AFTER.omega * math.cos(yaw) - AFTER.omega) * 0.1)
    assert score.history[4][1] == pytest.approx(seen / SCALE, abs=CLOSE)


def test_a_touchdown_that_is_due_is_held_within_the_twist_window() -> None:
    """Up to then a twist averaged over what was counts, however short the time that is left."""
    window = 0.012
    predictor = Predictor(SCENE._replace(twist_window=window))
    samples = [falling(sample.stamp, lag=0.5 * window) for sample in before()[2:]]
    vx, vy, omega = (0.7 * part for part in BEFORE)
    blurred = [landed((BEFORE_SAMPLES + k) * PERIOD, vx, omega, vy) for k in range(2)]
    answers = [answer.touchdown for answer in run(predictor, samples + blurred)]
    fresh = Predictor(SCENE._replace(twist_window=window)).update(samples[-1]).touchdown
    last = answers[len(samples) - 1]
    assert last is not None
    assert last == fresh
    assert 0.0 < last.lead_time < window
    assert answers[-2:] == 2 * [last._replace(lead_time=0.0)]


@pytest.mark.parametrize(("window", "announced"), [(0.0, True), (0.012, False)])
def test_what_an_averaged_twist_has_left_of_an_impact_is_no_new_touchdown(window: float, announced: bool) -> None:
    predictor = Predictor(SCENE._replace(twist_window=window))
    left = 0.4
    blurred = landed(BEFORE_SAMPLES * PERIOD, left * BEFORE.vx, left * BEFORE.omega, left * BEFORE.vy)
    answer = run(predictor, [*before(), blurred])[-1]
    assert (answer.touchdown is not None) is announced


def test_a_touchdown_that_does_not_come_is_not_held_for_ever() -> None:
    """The body springs back and hovers, still approaching: when the touchdown is overdue each sample counts again."""
    predictor = Predictor(SCENE._replace(twist_window=0.012))
    hover = falling(30_000_000)
    late = [hover._replace(stamp=k * PERIOD) for k in range(BEFORE_SAMPLES, BEFORE_SAMPLES + 10)]
    answers = [answer.touchdown for answer in run(predictor, before() + late)]
    fresh = Predictor(SCENE._replace(twist_window=0.012)).update(hover).touchdown
    assert answers[BEFORE_SAMPLES] != fresh
    assert answers[-6:] == 6 * [fresh]


def test_the_stamp_is_that_of_the_prediction_and_not_after_the_sample_that_settles() -> None:
    assert only_score(SCENE, before() + after(4)).stamp == pytest.approx(TOUCH, abs=10)
    # It lands before its time, on something that lies there.
    early = [*before()[:-2], *after(5, BEFORE_SAMPLES - 2)]
    assert only_score(SCENE, early).stamp == (BEFORE_SAMPLES - 2) * PERIOD


def test_samples_between_touchdown_and_settling_count_as_after_it() -> None:
    """Half the approach is left in the first sample after the touchdown, so that the second settles it."""
    samples = [landed(TOUCH // PERIOD * PERIOD + (k + 1) * PERIOD) for k in range(4)]
    samples[0] = landed(samples[0].stamp, 0.6 * BEFORE.vx, 0.6 * BEFORE.omega, 0.6 * BEFORE.vy)
    answers = run(Predictor(SCENE._replace(twist_window=0.006)), before() + samples)
    (score,) = [answer.score for answer in answers if answer.score is not None]
    assert answers[BEFORE_SAMPLES + 3].score is score
    assert [lead for lead, _ in score.history] == sorted([lead for lead, _ in score.history], reverse=True)
    assert score.history[-1][0] > 0.0  # what was still announced after the touchdown foretold nothing


def test_a_body_that_is_caught_in_the_air_has_not_landed() -> None:
    caught = [falling(30_000_000, spin=0.0)._replace(stamp=k * PERIOD) for k in range(7, 20)]
    predictor = Predictor(SCENE)
    assert not any(answer.score for answer in run(predictor, before()[:7] + caught))
    assert predictor.finish() == ()


@pytest.mark.parametrize("count", [1, 3])
def test_a_record_that_ends_too_early_leaves_a_touchdown_without_measurement(count: int) -> None:
    predictor = Predictor(SCENE)
    assert not any(answer.score for answer in run(predictor, before() + after(count)))
    (score,) = predictor.finish()
    assert (score.measured, score.relative_error, score.scored, score.history) == (None, None, False, ())
    assert score.leftover is Leftover.TOO_SHORT
    assert score.stamp == pytest.approx(TOUCH, abs=10)
    assert predictor.finish() == ()


@pytest.mark.parametrize("shift", [0, 2 * PAUSE])
def test_a_pause_or_a_clock_that_starts_anew_ends_what_waits_for_its_measurement(shift: int) -> None:
    predictor = Predictor(SCENE)
    run(predictor, [sample._replace(stamp=sample.stamp + shift) for sample in before() + after(2)])
    late = before()[0] if shift else landed(2 * PERIOD * BEFORE_SAMPLES + PAUSE)
    if shift:
        assert predictor.update(late).status is Status.STAMP_WENT_BACK
    score = predictor.update(late).score
    assert score is not None
    assert score.leftover is Leftover.TOO_SHORT
    assert predictor.finish() == ()


@pytest.mark.parametrize(
    ("seen", "shift", "scored"),
    [(0, 0.001, []), (0, 0.0, [True]), (1, 0.001, [True])],
    ids=["changes in the fall", "comes again", "changes after the touchdown"],
)
def test_only_a_geometry_that_changes_during_the_fall_ends_the_touchdown(
    seen: int, shift: float, scored: list[bool]
) -> None:
    predictor = Predictor(SCENE)
    run(predictor, before() + after(seen))
    other = tuple((x, y, z + shift) for x, y, z in BLOCK)
    assert predictor.tell(Geometry(0, "block", other)) is Status.ACCEPTED
    assert predictor.tell(Geometry(0, "block", ())) is Status.TOO_FEW_POINTS
    scores = [answer.score for answer in run(predictor, after(6 - seen, BEFORE_SAMPLES + seen)) if answer.score]
    assert [score.scored for score in scores] == scored


def test_whether_a_touchdown_is_scored_is_decided_before_it() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        garbage = [landed(sample.stamp, *rng.normal(scale=5.0, size=3).tolist()) for sample in after(4)]
        garbage[0] = after(1)[0]
        score = run(Predictor(SCENE), before() + garbage)[-1].score
        assert score is not None
        assert (score.scored, score.leftover) == (True, Leftover.NONE)
        assert score.relative_error is not None


def test_a_touchdown_in_flight_has_a_measurement_but_no_error() -> None:
    """The error is relative to the half distance of two contacts."""
    drop = [block(k * PERIOD, 0.1, Twist(0.3, -1.0, -0.5), height=0.05 - 0.005 * k) for k in range(10)]
    rest = [block(k * PERIOD, 0.1, Twist(0.1, 0.0, -0.2)) for k in range(10, 15)]
    scores = [answer.score for answer in run(Predictor(SCENE), drop + rest) if answer.score]
    assert scores
    assert scores[0].touchdown.old == ()
    assert scores[0].measured == pytest.approx((0.1, 0.0, -0.2), abs=CLOSE)
    assert (scores[0].relative_error, scores[0].scored, scores[0].history) == (None, False, ())
    assert scores[0].leftover & Leftover.ONE_POINT


ROCKER: tuple[Vector3, ...] = tuple((x, y, z) for x, z in ((-0.1, 0.0), (0.0, -0.001), (0.1, 0.0)) for y in (-0.1, 0.1))
"""Three edges on a bow: from each it falls on the next."""
ROCKER_SCENE = SCENE._replace(points=ROCKER, tolerance=1e-4, contact_time=5e-4)


def rocking(stamp: int, edge: int, angle: float, omega: float) -> Sample:
    """The rocker, turned up by an angle, turning about one of its edges."""
    x, _, z = ROCKER[2 * edge]
    sine, cosine = math.sin(angle), math.cos(angle)
    rx, rz = cosine * x - sine * z, sine * x + cosine * z
    velocity = np.array([omega * rz, -omega * rx])
    linear = (float(velocity @ (cosine, sine)), 0.0, float(velocity @ (-sine, cosine)))
    orientation = 0.0, -math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)
    return Sample(stamp, "map", "rocker", (-rx, 0.0, -rz), orientation, linear, (0.0, -omega, 0.0), (), ())


def test_what_is_but_rounding_before_a_touchdown_is_no_speed_of_which_an_error_is_a_part() -> None:
    track = Track()
    told = only_score(SCENE, before() + after(4)).touchdown
    track.add(0, told._replace(before=Twist(2e-323, 0.0, 0.0)), 1.0)
    pending = Pending(track, 0)
    for sample in after(4):
        pending.add(sample, posture_of(SCENE, BLOCK, sample))
    score = pending.score(SCENE)
    assert score.measured == pytest.approx(AFTER, abs=CLOSE)
    assert score.relative_error is None
    assert not score.scored


def test_touchdowns_shortly_after_one_another_are_both_scored() -> None:
    period, slope = 2_000_000, 0.01
    predictor = Predictor(ROCKER_SCENE)
    samples = []
    for k in range(12):
        time = (k - 5.5) * period * 1e-9  # the second edge touches at 0 with -2 rad/s, the third 10 ms later
        edge, angle, omega = (0, slope - 2.0 * time, -2.0) if time < 0.0 else (1, slope - 2.0 * time, -2.0)
        if angle < -slope:
            edge, angle, omega = 2, -slope, 0.0
        samples.append(rocking(k * period, edge, angle, omega))
    answers = run(predictor, samples + [samples[-1]._replace(stamp=k * period) for k in range(12, 20)])
    scores = {k: answer.score for k, answer in enumerate(answers) if answer.score is not None}
    assert [score.touchdown.new for score in scores.values()] == [(2, 3), (4, 5)]
    # Every second pose measures them: the fourth of these after 0 is sample 12, the fourth after 10 ms sample 18.
    assert list(scores) == [12, 18]
    assert all(score.scored for score in scores.values())


def test_the_memory_of_a_touchdown_that_never_comes_is_bounded() -> None:
    predictor = Predictor(SCENE)
    hover = [falling(30_000_000)._replace(stamp=k * PERIOD) for k in range(LONGEST + 50)]
    run(predictor, hover)
    answers = run(predictor, after(5, LONGEST + 50))
    score = answers[-1].score
    assert score is not None
    assert 0 < len(score.history) <= LONGEST


@pytest.mark.parametrize("points", [BLOCK, ((BACK, 0.0, LOW), (FRONT, 0.0, LOW))])
def test_a_touchdown_that_takes_some_samples_is_scored_once(points: tuple[Vector3, ...]) -> None:
    predictor = Predictor(SCENE._replace(points=points))
    samples = [falling(k * PERIOD) for k in range(BEFORE_SAMPLES)]
    for k, part in enumerate((0.4, 0.15, *[0.0] * 20)):
        still = Twist(part * BEFORE.vx, part * BEFORE.vy, part * BEFORE.omega)
        samples.append(block((BEFORE_SAMPLES + k) * PERIOD, 0.0, still))
    scores = [score for score in (predictor.update(sample).score for sample in samples) if score is not None]
    assert [score.touchdown.new for score in [*scores, *predictor.finish()]] == [(2, 3) if len(points) > 2 else (1,)]


@pytest.mark.parametrize("rise", [0.0, 0.2])
def test_points_that_rose_in_between_come_down_anew(rise: float) -> None:
    predictor = Predictor(SCENE)
    samples = [falling(k * PERIOD) for k in range(BEFORE_SAMPLES)]
    for k, part in enumerate((0.0, -rise, -rise, 0.5, 0.0, *[0.0] * 20)):
        twist = Twist(part * BEFORE.vx, part * BEFORE.vy, part * BEFORE.omega)
        samples.append(block((BEFORE_SAMPLES + k) * PERIOD, 0.0, twist))
    scores = [score for score in (predictor.update(sample).score for sample in samples) if score is not None]
    assert len([*scores, *predictor.finish()]) == (2 if rise else 1)
