"""What draws over gaps, twist and coefficients say of impacts in three dimensions."""

from __future__ import annotations

import sys
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from bodies_in_space import ALIKE, CUBE, MASS, MERGE, PULL, RESTITUTION, SLOW, Somewhere, somewhere, state_of
from newton_in_space import tensor
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.compiled import without_numba
from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, solve_spatial_impacts
from impact_predictor.mechanics.impact.spatial_body import BODY, CONTACT
from impact_predictor.mechanics.motion.spatial import SpatialState
from impact_predictor.mechanics.types import ContactState, Flag, Mode
from impact_predictor.prediction import spatial_impact
from impact_predictor.prediction.drawn import over, spread
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Covariance, Sample, Touchdown

DRAWN: dict[str, Any] = {"samples": 32, "gap_deviation": 5e-4, "friction_deviation": 0.05, "restitution_deviation": 0.1}


def falling(seed: int) -> tuple[Somewhere, SpatialState]:
    rng = np.random.default_rng(seed)
    spin, velocity = 5.0 * rng.normal(size=3), [*rng.normal(size=2), -0.8]
    return somewhere(seed, CUBE), state_of(0.12, Rotation.random(random_state=rng), velocity, spin)


def even_edge() -> tuple[Somewhere, SpatialState]:
    """A cube whose lowest edge is level, symmetric about the plane across it."""
    return somewhere(3, CUBE, inertia=ALIKE), state_of(
        0.1, Rotation.from_rotvec([0.0, 0.4, 0.0]), [0.2, 0.0, -1.0], [0.0, 1.0, 0.0]
    )


def announced(placed: Somewhere, start: SpatialState, covariance: Any = (), **changes: Any) -> Touchdown:
    sample = placed.sample(0.0, np.concatenate(start))._replace(twist_covariance=covariance)
    touchdown = Predictor(placed.scene(**changes)).update(sample).touchdown
    assert touchdown is not None
    return touchdown


def spread_by(deviation: float) -> tuple[float, ...]:
    return tuple((deviation**2 * np.diag([1.0, 1.0, 1.0, 100.0, 100.0, 100.0])).ravel().tolist())


def test_what_is_known_with_a_deviation_is_above_zero_with_the_probability_of_the_normal_distribution() -> None:
    for mean in (-0.3, 0.0, 0.1, 0.4):
        assert over(mean, 0.2) == pytest.approx(1.0 - NormalDist(mean, 0.2).cdf(0.0), rel=1e-12)


@pytest.mark.parametrize("turns", [True, False])
@pytest.mark.parametrize("deviations", [(0.2, 0.5, 1e-3), (0.2, 0.0, 1e-3), (0.0, 0.5, 0.0), (0.0, 0.0, 1e-3)])
def test_a_draw_moves_all_that_is_uncertain_and_its_gaps_count_from_the_first_that_closes(
    turns: bool, deviations: tuple[float, float, float]
) -> None:
    n, standing, count, rng = 4, 1, 50, np.random.default_rng(5)
    problem, rates = rng.uniform(0.1, 0.9, BODY + n * CONTACT), -rng.uniform(0.5, 1.5, n - standing)
    turning = rng.normal(size=(6, 6)) if turns else np.empty((0, 0))
    friction, restitution, gap = deviations
    of_contacts, of_gaps = friction > 0.0 or restitution > 0.0, gap > 0.0
    points = rng.normal(size=(len(turning) + 2 * of_contacts + (n - standing) * of_gaps, count))
    found = np.empty((count, len(problem)))
    without_numba(spread)(n, standing, problem, turning, points, np.array((*deviations, *rates)), found)

    expected = np.tile(problem, (count, 1))
    contacts = expected[:, BODY:].reshape(count, n, CONTACT)
    if turns:
        expected[:, 7:13] += (turning @ points[:6]).T
    if of_contacts:
        mu, e = points[len(turning) : len(turning) + 2]
        contacts[:, :, 6] = np.maximum(0.0, contacts[:, :, 6] + friction * mu[:, None])
        contacts[:, :, 7] = np.clip(contacts[:, :, 7] + restitution * e[:, None], 0.0, 1.0)
    if of_gaps:
        moved = contacts[:, standing:, 11] + gap * points[-(n - standing) :].T
        closing = moved / -rates
        contacts[:, standing:, 11] = (closing - closing.min(axis=1, keepdims=True)) * -rates
    assert np.array(found) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_the_probabilities_of_modes_sum_to_one_and_lifts_are_probabilities(seed: int) -> None:
    touchdown = announced(*falling(seed), spread_by(0.02), **DRAWN)
    assert touchdown.uncertainty is not None
    assert sum(touchdown.uncertainty.probabilities) == pytest.approx(1.0, abs=1e-12)
    assert min(touchdown.uncertainty.probabilities) >= 0.0
    lifts = [contact.lift_probability for contact in touchdown.contacts]
    assert all(lift is not None and 0.0 <= lift <= 1.0 for lift in lifts)
    assert touchdown.uncertainty.probabilities[touchdown.mode] > 0.0


@pytest.mark.parametrize("seed", range(8))
def test_deviations_of_zero_change_nothing(seed: int) -> None:
    placed, start = falling(seed)
    told = announced(placed, start, gap_deviation=0.0)
    drawn = announced(placed, start, gap_deviation=0.0, samples=32)
    assert drawn.uncertainty is not None
    contacts = tuple(contact._replace(lift_probability=None) for contact in drawn.contacts)
    assert drawn._replace(uncertainty=None, contacts=contacts) == told
    assert drawn.uncertainty.deviation == (0.0, 0.0, 0.0)


def test_deviations_of_zero_cost_one_impact(monkeypatch: pytest.MonkeyPatch) -> None:
    counts: list[int] = []
    solve = spatial_impact.solver()

    def counted(n: int, problems: Any, *others: Any) -> None:
        counts.append(len(problems))
        solve(n, problems, *others)

    monkeypatch.setattr(spatial_impact, "solver", lambda: counted)
    announced(*falling(1), gap_deviation=0.0, samples=32)
    # One more is the one that loads the law.
    assert counts == [1, 1]


def test_the_corners_of_an_even_edge_lift_as_likely_as_each_other() -> None:
    touchdown = announced(*even_edge(), samples=32, gap_deviation=1e-3, law_deviation=0.0)
    first, second = touchdown.contacts
    assert first.lift_probability == pytest.approx(second.lift_probability, abs=1e-9)
    assert touchdown.uncertainty is not None
    # What the order turns the body by to one side in half of the draws it turns it by to the other in the rest.
    _, _, omega = touchdown.uncertainty.deviation
    assert omega > 0.0


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("deviation", [0.0, 0.02])
def test_nothing_that_has_closed_approaches_after_what_is_told(seed: int, deviation: float) -> None:
    """And impulses, twists and contacts belong together."""
    placed, start = even_edge() if seed == 0 else falling(seed)
    touchdown = announced(placed, start, spread_by(deviation), samples=32, gap_deviation=5e-3)
    assert touchdown.uncertainty is not None
    before, after, scene = touchdown.before_6d, touchdown.after_6d, placed.scene()
    arms = Rotation.from_quat(touchdown.orientation).apply(np.subtract(scene.points, scene.center_of_mass))
    struck = np.sum([contact.impulse for contact in touchdown.contacts], axis=0)
    # The mean twist before the draws that are told is near that of the sample where the twist is uncertain, too.
    slack = 1e-9 if deviation == 0.0 else 3.0 * deviation
    assert np.subtract(after.linear, before.linear) == pytest.approx(struck / MASS, abs=slack)
    for contact in touchdown.contacts:
        moving = np.add(after.linear, np.cross(after.angular, arms[contact.point]))
        assert np.array(contact.velocity) == pytest.approx(moving, abs=1e-9)
        assert np.dot(contact.velocity, scene.normal) > -1e-3 or contact.state is ContactState.NEARS
    assert not touchdown.flags & Flag.POINT_APPROACHES


def test_what_is_told_is_the_mean_over_the_draws_of_the_likeliest_mode() -> None:
    """In all draws of this fall the one corner leaves, so that it is the mean of all of them."""
    placed, start = falling(2)
    touchdown = announced(placed, start, spread_by(1e-3), samples=64, gap_deviation=0.0)
    assert touchdown.uncertainty is not None
    assert touchdown.after == pytest.approx(touchdown.uncertainty.mean, abs=1e-9)


@pytest.mark.parametrize(("gap", "approaches"), [(1e-4, True), (2e-3, False)])
def test_a_point_that_took_no_part_and_is_pressed_into_its_support_is_named(gap: float, approaches: bool) -> None:
    """The far end of a beam still rises when its near end strikes, which turns it down again."""
    scene = Scene(
        mass=1.0,
        inertia=((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01)),
        friction=0.1,
        restitution=0.3,
        points=((0.2, 0.0, 0.0), (-0.2, 0.0, 0.0), (0.0, 0.3, 0.3)),
    )
    low, rising, lead = -1.0, 0.5, 1e-3
    tilt = np.arcsin((gap - (rising - low) * lead) / 0.4)
    turn = Rotation.from_rotvec([0.0, tilt, 0.0])
    x, y, z, w = turn.as_quat()
    sample = Sample(
        stamp=10**9,
        frame_id="",
        child_frame_id="",
        position=(0.0, 0.0, 0.5 * (gap - (rising + low) * lead)),
        orientation=(x, y, z, w),
        linear=tuple(turn.inv().apply([0.0, 0.0, 0.5 * (low + rising)])),
        angular=tuple(turn.inv().apply([1.0, (rising - low) / 0.4, 0.0])),
        pose_covariance=(),
        twist_covariance=(),
    )
    touchdown = Predictor(scene).update(sample).touchdown
    assert touchdown is not None
    assert touchdown.new == (0,)
    assert bool(touchdown.flags & Flag.POINT_APPROACHES) is approaches


def struck(placed: Somewhere, course: Any, twists: Any, friction: Any, restitution: Any) -> Any:
    """The twists after a corner has struck, each with a twist before it, a friction and a restitution of its own."""
    turn = Rotation.from_quat(course.state[3:7])
    body = Body(MASS, MASS * turn.as_matrix() @ tensor(placed.inertia) @ turn.as_matrix().T)
    contacts = ContactPoints(turn.apply(placed.points)[[course.point]], friction, restitution)
    slow = SLOW * float(np.linalg.norm(PULL.gravity))
    return solve_spatial_impacts(body, contacts, twists, merge=MERGE, threshold=slow).twist


def test_uncertain_friction_and_restitution_spread_the_twist_as_in_a_big_sample() -> None:
    placed, start = falling(4)
    told = announced(placed, start, samples=64, gap_deviation=0.0, friction_deviation=0.3, restitution_deviation=0.3)
    assert told.uncertainty is not None
    course, draw = placed.newton({}).strike(start, 0.6), np.random.default_rng(0).normal(size=(2, 20000, 1))
    # Neither is below 0, and no restitution above 1.
    friction, restitution = np.maximum(0.0, placed.friction + 0.3 * draw[0]), np.clip(RESTITUTION + 0.3 * draw[1], 0, 1)
    after = struck(placed, course, course.state[7:13], friction, restitution)
    axis, normal = placed.support.inv().apply(told.axis), np.array((0.0, 0.0, 1.0))
    planar = np.stack([after[:, :3] @ np.cross(axis, normal), after[:, 2], -after[:, 3:] @ axis])
    assert told.uncertainty.mean == pytest.approx(planar.mean(axis=1), rel=0.03)
    assert told.uncertainty.deviation == pytest.approx(planar.std(axis=1), rel=0.1)


def test_the_covariance_is_that_of_a_big_sample() -> None:
    placed, start = falling(4)
    deviation = 0.005
    told = announced(placed, start, spread_by(deviation), samples=64, gap_deviation=0.0, center_of_mass=placed.center)
    assert told.uncertainty is not None
    assert told.uncertainty.given is Covariance.USED
    course = placed.newton({}).strike(start, 0.6)
    at_sample = placed.pose(np.concatenate(start))[1]
    own = at_sample.apply(np.eye(3))
    noise = deviation * np.random.default_rng(0).normal(size=(20000, 6)) * [1.0, 1.0, 1.0, 10.0, 10.0, 10.0]
    spin = noise[:, 3:] @ own
    linear = noise[:, :3] @ own + np.cross(spin, at_sample.apply(placed.center))
    twists = course.state[7:13] + np.hstack([placed.support.inv().apply(linear), placed.support.inv().apply(spin)])
    after = struck(placed, course, twists, placed.friction, RESTITUTION)
    now = placed.pose(course.state)[1].inv()
    spins = now.apply(placed.support.apply(after[:, 3:]))
    velocities = now.apply(placed.support.apply(after[:, :3])) - np.cross(spins, placed.center)
    expected = np.cov(np.hstack([velocities, spins]).T)
    scale = np.sqrt(np.outer(expected.diagonal(), expected.diagonal()))
    found = np.reshape(told.uncertainty.twist_covariance, (6, 6))
    assert (found - expected) / scale == pytest.approx(np.zeros((6, 6)), abs=0.15)


def test_a_contact_that_leaves_faster_lifts_more_likely() -> None:
    placed, start = falling(2)
    found = []
    for restitution in np.linspace(0.0, 1.0, 6):
        touchdown = announced(placed, start, samples=16, gap_deviation=0.0, restitution=float(restitution))
        (contact,) = touchdown.contacts
        rate = float(np.dot(contact.velocity, placed.scene().normal))
        found.append((rate, contact.lift_probability))
    assert found == sorted(found)
    assert found[0][1] < 0.5 < found[-1][1]
    # The law is right to a part of the speed with which all moves before the impact.
    scene, linear, angular = placed.scene(), *touchdown.before_6d
    arm = np.linalg.norm(np.subtract(scene.points[contact.point], scene.center_of_mass))
    speed = float(np.linalg.norm(linear) + np.linalg.norm(angular) * arm)
    margin = NormalDist(rate - SLOW * float(np.linalg.norm(PULL.gravity)), scene.law_deviation * speed)
    assert contact.lift_probability == pytest.approx(1.0 - margin.cdf(0.0), rel=1e-9)


def test_contacts_that_strike_together_lift_together_as_likely_as_their_mean() -> None:
    touchdown = announced(*even_edge(), samples=32, gap_deviation=0.0, law_deviation=0.3)
    assert touchdown.uncertainty is not None
    lifts = [contact.lift_probability for contact in touchdown.contacts]
    assert min(lifts) < touchdown.uncertainty.probabilities[Mode.FLIGHT] < max(lifts)


@pytest.mark.parametrize("first", [(-1.0, 0.0), (1e30, 0.0), (1.0, 0.5)], ids=["negative", "huge", "askew"])
def test_an_odd_covariance_is_refused_and_leaves_numbers(first: tuple[float, float]) -> None:
    covariance = first + 34 * (0.0,)
    touchdown = announced(*falling(3), covariance, **DRAWN)
    assert touchdown.uncertainty is not None
    assert touchdown.uncertainty.given is Covariance.REFUSED
    assert np.isfinite([*touchdown.uncertainty.probabilities, *touchdown.after, *touchdown.linear]).all()
    assert touchdown.uncertainty.twist_covariance == covariance


def test_draws_have_the_same_bits_with_numba_and_without(monkeypatch: pytest.MonkeyPatch) -> None:
    from impact_predictor.mechanics.impact import spatial
    from impact_predictor.mechanics.motion import spatial as motion
    from impact_predictor.prediction import draws

    compiled = [announced(*falling(seed), spread_by(0.02), **DRAWN) for seed in range(2)]
    prepared = spatial.solver, motion.solver, draws.law_code
    try:
        for one in prepared:
            one.cache_clear()
        monkeypatch.setitem(sys.modules, "numba", None)  # an import of it fails
        assert [announced(*falling(seed), spread_by(0.02), **DRAWN) for seed in range(2)] == compiled
    finally:
        for one in prepared:
            one.cache_clear()


def test_a_mode_is_one_that_a_draw_has() -> None:
    for seed in range(8):
        touchdown = announced(*falling(seed), **DRAWN)
        leaves = touchdown.contacts[0].state is ContactState.LEAVES
        assert len(touchdown.contacts) > 1 or (touchdown.mode is Mode.FLIGHT) is leaves
