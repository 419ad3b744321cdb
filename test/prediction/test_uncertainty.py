"""What an uncertain impact does, against derivatives where it is linear and against many random samples where not."""

import subprocess
import sys
from math import cos, inf, nan, sin
from pathlib import Path

import numpy as np
import pytest
import uncertain_impact
from uncertain_impact import propagate

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, plate, solve_impact
from impact_predictor.mechanics.impact import batch
from impact_predictor.mechanics.sensitivity import sensitivity
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Covariance, Sample
from impact_predictor.prediction.uncertainty import factor_of, impacts, moments, normal_points

ROUNDING = 1e-12
"""Of sums of a few hundred terms of size one."""

CUBE = plate(length=0.1, height=0.1, mass=0.37, friction=0.18, inertia=8.1e-4, restitution=0.125)
SLIPPING = Twist(-0.3, -0.5, -10.0)


def linear_covariance(body, twist, covariance, friction, restitution, law="path"):
    """J C J^T with the derivatives by all inputs."""
    derivatives = sensitivity(body, twist, law)
    jacobian = np.array(derivatives.twist)
    by_friction = np.add(derivatives.friction_old, derivatives.friction_new)
    by_restitution = np.array(derivatives.restitution)
    return (
        jacobian @ covariance @ jacobian.T
        + friction**2 * np.outer(by_friction, by_friction)
        + restitution**2 * np.outer(by_restitution, by_restitution)
    )


@pytest.mark.parametrize("samples", [1, 16, 33, 64, 128])
@pytest.mark.parametrize("dimensions", [3, 5, 8])
def test_the_points_have_no_mean_unit_covariance_and_opposites(samples, dimensions):
    points = normal_points(samples, dimensions)
    count = points.shape[1]
    assert count == max(samples + samples % 2, 2 * dimensions)
    assert points @ points.T / count == pytest.approx(np.eye(dimensions), abs=ROUNDING)
    half = count // 2
    assert np.array_equal(points[:, :half], -points[:, half:])


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize(
    ("body", "twist"),
    [
        (CUBE, SLIPPING),
        (CUBE, CUBE.turning(-10.0)),
        (plate(length=1.0, height=0.4, mass=10.0, friction=0.2), Twist(0.4, -0.5, -1.0)),
        (TwoPointBody(2.0, 0.01, None, Contact(0.03, -0.1, 0.3, restitution=0.4)), Twist(2.0, -1.0, 1.0)),
    ],
)
def test_small_deviations_spread_as_the_derivatives_say(body, twist, law):
    small = 1e-5
    covariance = small**2 * np.array([[1.0, 0.3, 0.5], [0.3, 2.0, -0.2], [0.5, -0.2, 30.0]])
    restitution = small * (body.new.restitution > 0.0)  # else half of the deviations would be cut off
    spread = propagate(body, twist, covariance, friction=small, restitution=restitution, law=law)
    expected = linear_covariance(body, twist, covariance, small, restitution, law)
    # what is not linear is a deviation of 1e-5 more, and the terms of the twist have 1e-16 of rounding by 1e-5
    scale = np.sqrt(np.outer(expected.diagonal(), expected.diagonal())).max()
    assert np.abs(spread.covariance - expected).max() < 1e-3 * scale
    outcome = solve_impact(body, twist, law)
    assert spread.mean == pytest.approx(outcome.twist, abs=1e-8)
    assert spread.probabilities[outcome.mode] == 1.0
    assert spread.given is Covariance.USED


def test_a_linear_impact_has_its_mean_and_covariance_exactly():
    """In one mode and without deviations of friction or restitution an impact is linear in the twist."""
    covariance = np.diag([0.02, 0.03, 0.4]) ** 2
    for samples in (1, 64):
        spread = propagate(CUBE, SLIPPING, covariance, samples=samples)
        assert spread.probabilities[Mode.BACK_PIVOT] == 1.0
        assert spread.mean == pytest.approx(solve_impact(CUBE, SLIPPING).twist, abs=ROUNDING)
        expected = linear_covariance(CUBE, SLIPPING, covariance, 0.0, 0.0)
        assert spread.covariance == pytest.approx(expected, abs=ROUNDING)


BORDERS = {
    "plate that slides or stops": (plate(length=1.0, height=0.4, mass=10.0, friction=0.38), -1.0, 0.0),
    "plate that pivots, with slip or without": (plate(length=1.0, height=1.0, mass=10.0, friction=0.55), -1.0, 0.0),
    "plate that slips": (plate(length=1.0, height=0.8, mass=10.0, friction=0.3, restitution=0.1), -1.0, 0.2),
    "cube that bounces": (CUBE, -10.0, -0.3),
}


@pytest.mark.parametrize("name", BORDERS)
def test_modes_have_the_probabilities_of_many_random_samples(name):
    body, omega, slip = BORDERS[name]
    turning = body.turning(omega)
    twist = turning._replace(vx=turning.vx + slip)
    deviations = np.array([0.1, 0.1, 0.15 * abs(omega)])
    count = 100_000
    draws = np.random.default_rng(1).normal(size=(5, count))
    many = impacts(body, twist, deviations[:, None] * draws[:3], 0.1 * draws[3], 0.05 * draws[4], "path")
    expected = np.bincount(many.mode, minlength=len(Mode)) / count
    mean, covariance = moments(many.twist.T)
    assert np.sum(expected > 0.02) > 1
    # 128 points of low discrepancy miss a probability by 0.012 in the root mean square over 40 such plates
    for samples, room in ((128, 0.05), (4096, 0.01)):
        spread = propagate(body, twist, np.diag(deviations**2), 0.1, 0.05, samples=samples)
        assert np.array(spread.probabilities) == pytest.approx(expected, abs=room)
        assert sum(spread.probabilities) == pytest.approx(1.0)
        scale = np.sqrt(covariance.diagonal())
        assert np.abs((np.array(spread.mean) - mean) / scale).max() < room
        assert np.abs((spread.covariance - covariance) / np.outer(scale, scale)).max() < 3.0 * room


def test_twists_that_do_not_approach_are_no_impact():
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    spread = propagate(body, body.turning(-1.0), np.diag([0.0, 0.0, 1.0]), samples=4096)
    assert spread.probabilities[Mode.NO_IMPACT] == pytest.approx(0.1587, abs=2e-3)  # of a normal: above one deviation
    assert spread.probabilities[Mode.SLIDE] == pytest.approx(1.0 - 0.1587, abs=2e-3)


def test_friction_and_restitution_stay_in_their_range():
    points = normal_points(64, 5)
    outcomes = impacts(CUBE, SLIPPING, 0.0 * points[:3], 5.0 * points[3], 5.0 * points[4], "path")
    assert not np.any(outcomes.flags & Flag.INVALID_INPUT)
    ends = impacts(CUBE, SLIPPING, np.zeros((3, 2)), np.array([-9.0, 0.0]), np.array([-9.0, 9.0]), "path")
    for twist, friction, restitution in ((ends.twist[0], 0.0, 0.0), (ends.twist[1], 0.18, 1.0)):
        limited = plate(0.1, 0.1, 0.37, friction, 8.1e-4, restitution=restitution)
        assert tuple(twist) == solve_impact(limited, SLIPPING, restitution="energetic").twist


@pytest.mark.parametrize(
    "covariance",
    [
        np.diag([1.0, -1.0, 1.0]),
        np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        np.array([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        np.array([[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0]]),
        np.full((3, 3), nan),
        np.diag([1.0, inf, 1.0]),
        np.diag([1.0, 1e30, 1.0]),
        -np.eye(3),
    ],
)
def test_what_is_no_covariance_is_refused_by_name_and_the_twist_counts_as_exact(covariance):
    spread = propagate(CUBE, SLIPPING, covariance, friction=0.02)
    assert spread.given is Covariance.REFUSED
    assert spread.mean == propagate(CUBE, SLIPPING, np.zeros((3, 3)), friction=0.02).mean


def test_odd_bodies_and_twists_give_numbers():
    for body, twist in (
        (CUBE._replace(mass=-1.0), SLIPPING),
        (CUBE, Twist(nan, 0.0, 0.0)),
        (CUBE, Twist(1e100, -1e100, 1e100)),
        (CUBE, CUBE.turning(10.0)),
    ):
        spread = propagate(body, twist, np.eye(3))
        assert sum(spread.probabilities) == pytest.approx(1.0)
        assert spread.probabilities[Mode.NO_IMPACT] > 0.0 or twist.vx > 1.0


DIGEST = """
from impact_predictor import Twist, plate
from uncertain_impact import propagate
body = plate(length=0.1, height=0.1, mass=0.37, friction=0.18, inertia=8.1e-4, restitution=0.125)
covariance = [[0.1, 0.02, 0.3], [0.02, 0.2, -0.1], [0.3, -0.1, 3.0]]
spread = propagate(body, Twist(-0.3, -0.5, -10.0), covariance, 0.05, 0.05, samples=64)
bits = [number.hex() for number in (*spread.probabilities, *spread.mean, *spread.covariance.ravel().tolist())]
"""


def bits():
    """All numbers of a spread in which everything varies, to the last bit."""
    names = {}
    exec(DIGEST, names)
    return names["bits"]


def test_every_run_gives_the_same_bits_with_numba_and_without(monkeypatch):
    here = bits()
    normal_points.cache_clear()
    factor_of.cache_clear()
    assert bits() == here
    program = f"import sys; sys.path.append({str(Path(uncertain_impact.__file__).parent)!r})" + DIGEST + "print(*bits)"
    elsewhere = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert elsewhere.stdout.split() == here
    monkeypatch.setitem(sys.modules, "numba", None)  # an import of it fails
    batch.chunk_solver.cache_clear()
    try:
        assert bits() == here
    finally:
        batch.chunk_solver.cache_clear()


POINTS = ((-0.1, -0.3, -0.05), (-0.1, 0.3, -0.05), (0.12, -0.3, -0.05), (0.12, 0.3, -0.05))
TILT = 1e-4
"""rad: the touchdown is 20 um away, so that gravity adds nothing to the twist before it."""


def scene(**changes):
    standing = Scene(
        mass=2.0,
        inertia=((0.03, 0.0, 0.0), (0.0, 0.02, 0.0), (0.0, 0.0, 0.04)),
        friction=0.25,
        restitution=0.3,
        center_of_mass=(0.01, 0.0, 0.02),
        points=POINTS,
    )
    return standing._replace(**changes)


def tipping_box(change=(0.0,) * 6, covariance=(0.0,) * 36):
    """A box that slips on its edge x = -0.1 and tips about it onto the other one; its twist changed."""
    x, height = 0.1, 0.05
    angular = np.array([0.0, 1.5, 0.0])
    # its standing edge slips along x
    linear = np.array([0.4, 0.0, 0.0]) - np.cross(angular, (-x, 0.0, -height))
    linear, angular = linear + change[:3], angular + change[3:]
    orientation = (0.0, -sin(0.5 * TILT), 0.0, cos(0.5 * TILT))
    lifted = height + x * TILT
    linear, angular = tuple(linear.tolist()), tuple(angular.tolist())
    return Sample(0, "", "", (0.0, 0.0, lifted), orientation, linear, angular, (0.0,) * 36, covariance)


def predicted(scene, sample):
    touchdown = Predictor(scene).update(sample).touchdown
    assert touchdown is not None
    return touchdown


def test_a_prediction_carries_the_covariance_of_the_twist_to_space():
    """Against differences of the whole prediction by each part of the twist that the sample measured."""
    root = np.random.default_rng(3).normal(size=(6, 6)) * 1e-4
    covariance = root @ root.T
    step = 1e-5
    columns = []
    for axis in np.eye(6):
        ends = [predicted(scene(), tipping_box(sign * step * axis)) for sign in (1.0, -1.0)]
        high, low = (np.array([*end.linear, *end.angular]) for end in ends)
        columns.append((high - low) / (2.0 * step))
    jacobian = np.array(columns).T
    touchdown = predicted(scene(samples=64), tipping_box(covariance=tuple(covariance.ravel())))
    assert touchdown.uncertainty.given is Covariance.USED
    expected = jacobian @ covariance @ jacobian.T
    found = np.reshape(touchdown.uncertainty.twist_covariance, (6, 6))
    # A plane that turns with the angular velocity of a sample, and the lead time of 1e-3 s, are left out.
    assert found == pytest.approx(expected, abs=0.02 * np.abs(expected).max())
    assert touchdown.uncertainty.probabilities[touchdown.mode] == 1.0


def test_uncertainty_changes_nothing_else_of_a_prediction():
    covariance = tuple((1e-4 * np.eye(6)).ravel())
    plain = predicted(scene(), tipping_box(covariance=covariance))
    unsure = predicted(
        scene(samples=32, friction_deviation=0.1, restitution_deviation=0.1, margins=True),
        tipping_box(covariance=covariance),
    )
    assert unsure._replace(uncertainty=None, planar=None) == plain
    assert unsure.uncertainty.deviation != (0.0, 0.0, 0.0)
    assert unsure.planar.twist == plain.after
    assert unsure.planar.margins.friction.mode is not None


def test_a_covariance_that_is_none_is_said_and_kept_as_it_came():
    unknown = (-1.0, *(0.0,) * 35)
    touchdown = predicted(scene(samples=32, friction_deviation=0.1), tipping_box(covariance=unknown))
    assert touchdown.uncertainty.given is Covariance.REFUSED
    assert touchdown.uncertainty.twist_covariance == unknown
    assert touchdown.uncertainty.deviation.vx > 0.0  # by friction


def test_the_sample_path_compiles_nothing():
    """What numba compiles, it compiles when the predictor is made."""
    predictor = Predictor(scene(samples=32))
    compiled = getattr(batch.chunk_solver(), "signatures", None)
    before = None if compiled is None else list(compiled)
    predictor.update(tipping_box())
    predictor.update(tipping_box()._replace(stamp=1_000_000))
    after = getattr(batch.chunk_solver(), "signatures", None)
    assert (None if after is None else list(after)) == before
