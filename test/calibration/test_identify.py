"""Mass centre and inertia of bodies that are struck by arbitrary impulses come back, with what cannot be told."""

from __future__ import annotations

import numpy as np
import pytest
from free_flight import flight_of
from tossed_bodies import CENTER, CORNERS, GIVEN, MASS, RADIUS, SCENE, TRUE, tosses

from impact_predictor import read_scenes
from impact_predictor.bags.replay import replay
from impact_predictor.calibration.identify import Identification, identify
from impact_predictor.calibration.impacts import MotionRecord
from impact_predictor.calibration.motions import RecordedMotion, RecordingMonitor, distinct
from impact_predictor.calibration.search import Estimate
from impact_predictor.errors import InputError
from impact_predictor.prediction.scene import inertia_matrix
from impact_predictor.resources import find

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("few_resamples")]


def motions(number: int = 60, noise: float = 0.0, kind: str = "box") -> list[RecordedMotion]:
    return [toss.motion for toss in tosses(number, noise=noise, kind=kind)]


def within(one: Estimate, truth: float, slack: float = 1.0) -> bool:
    """Whether a truth lies in an interval, or in one that is wider by so much."""
    assert one.low is not None
    assert one.high is not None
    middle, half = 0.5 * (one.low + one.high), 0.5 * slack * (one.high - one.low)
    return abs(truth - middle) <= half


@pytest.fixture(scope="module")
def exact() -> Identification:
    return identify(SCENE, motions(), 6)


@pytest.fixture(scope="module")
def noisy() -> Identification:
    return identify(SCENE, motions(noise=1e-4), 6)


def test_without_noise_all_of_the_tensor_and_the_mass_centre_come_back(exact: Identification) -> None:
    assert [one.value for one in exact.inertia] == pytest.approx(TRUE, abs=1e-3 * GIVEN.mean())
    assert [one.value for one in exact.center] == pytest.approx(CENTER, abs=1e-5)
    assert np.median(exact.held_out) < 1e-3 < 0.05 < np.median(exact.given)
    # What differs between the axes is told only by as many moments.
    assert exact.choices[6] < 0.1 * exact.choices[3] < 0.1 * exact.choices[1]
    assert exact.lever == pytest.approx(np.sqrt((CORNERS**2).sum(axis=1).mean()))


def test_with_noise_the_truth_lies_within_the_intervals(noisy: Identification) -> None:
    parts = [*zip(noisy.inertia, TRUE, strict=True), *zip(noisy.center, CENTER, strict=True)]
    assert all(one.known for one, _ in parts)
    assert sum(within(one, truth) for one, truth in parts) >= 7
    assert all(within(one, truth, 2.0) for one, truth in parts)
    assert noisy.choices[6] == np.median(noisy.held_out)


def test_free_flight_alone_tells_the_mass_centre_the_fall_and_the_shape_of_the_tensor(noisy: Identification) -> None:
    records = [MotionRecord(SCENE, motion) for motion in motions(noise=1e-4)]
    flight = flight_of(SCENE, records, noisy.lever, 0)
    assert flight is not None
    truths = [*CENTER, 9.81, *(TRUE[:3] / TRUE[:3].mean())]
    for one, truth in zip((*flight.center, flight.fall, *flight.shape), truths, strict=True):
        assert within(one, truth, 2.0)
    assert not within(flight.shape[0], 1.2)


def test_the_mass_only_scales_what_is_found(exact: Identification) -> None:
    heavy = SCENE._replace(mass=2.0 * MASS, inertia=inertia_matrix([*(2.0 * GIVEN), 0.0, 0.0, 0.0]))
    found = identify(heavy, motions(), 6)
    assert [one.value for one in found.inertia] == pytest.approx([2.0 * one.value for one in exact.inertia])
    assert [one.value for one in found.center] == pytest.approx([one.value for one in exact.center])


def test_a_body_of_one_moment_needs_one_number_and_a_given_value_in_its_interval_stays() -> None:
    moment = float(TRUE[:3].mean())
    scene = SCENE._replace(inertia=inertia_matrix([moment]), center_of_mass=(0.0, -0.003, 0.0))
    found = identify(scene, motions(noise=1e-4, kind="isotropic"))
    assert found.inertia[0].value == moment
    assert found.center[1].value == -0.003
    assert found.center[2].value == pytest.approx(CENTER[2], abs=2e-4)


def test_a_body_that_is_given_as_it_is_stays(noisy: Identification) -> None:
    inertia = inertia_matrix([one.value for one in noisy.inertia])
    x, y, z = (one.value for one in noisy.center)
    again = identify(SCENE._replace(inertia=inertia, center_of_mass=(x, y, z)), motions(noise=1e-4), 6)
    assert all(one.value == one.given for one in again.inertia + again.center)


def test_what_no_impact_turns_is_not_told_and_stays_as_given() -> None:
    found = identify(SCENE, motions(noise=1e-5, kind="flat"), 3)
    assert [one.known for one in found.inertia] == [False, True, False]
    assert [found.inertia[k].value for k in (0, 2)] == [GIVEN[0], GIVEN[2]]
    assert found.inertia[1].value == pytest.approx(TRUE[:3].mean(), rel=0.01)
    assert found.roundings == ()


def test_round_corners_show_in_the_heights_at_which_they_turn_back(exact: Identification) -> None:
    found = identify(SCENE, motions(kind="round"), 6)
    assert exact.radius is not None
    assert found.radius is not None
    assert exact.radius.value == pytest.approx(0.0, abs=2e-4)
    assert found.radius.value == pytest.approx(RADIUS, abs=2e-4)
    # Sharp corners would make it too large; with the right ones nothing is left over.
    assert found.inertia[0].value > 1.03 * TRUE[0]
    radii = [one.radius for one in found.roundings]
    moments = [np.interp(RADIUS, radii, [one.inertia[k] for one in found.roundings]) for k in range(3)]
    assert moments == pytest.approx(TRUE[:3], rel=0.01)
    assert min(found.roundings, key=lambda one: one.left).radius == pytest.approx(RADIUS, abs=1e-3)


@pytest.mark.parametrize("number", [0, 3])
def test_too_few_impacts_are_refused_in_one_sentence(number: int) -> None:
    with pytest.raises(InputError, match=r"impacts? of a single point while nothing else touches, in .* are needed"):
        identify(SCENE, motions(3)[:number])


def test_two_halves_of_the_shipped_tosses_tell_the_same_body() -> None:
    scenes = read_scenes(str(find("config/cube_tosses.yaml")))
    # As published.
    scene = scenes[""]._replace(inertia=inertia_matrix([8.1e-4]), center_of_mass=(0.0, 0.0, 0.0))
    monitor = RecordingMonitor(scenes)
    replay(find("examples/cube_tosses"), scenes, monitor=monitor)
    single = distinct(scene, monitor.motions)
    even, odd = (identify(scene, single[half::2]) for half in (0, 1))
    for one, other in zip(even.inertia + even.center, odd.inertia + odd.center, strict=True):
        assert one.known
        assert (one.low or 0.0) <= (other.high or 0.0)
        assert (other.low or 0.0) <= (one.high or 0.0)
    for half in (even, odd):
        assert half.inertia[0].value == pytest.approx(1.06e-3, rel=0.02)
        assert half.center[2].value == pytest.approx(6.3e-3, abs=4e-4)
        assert np.median(half.held_out) < 0.3 * np.median(half.given)
