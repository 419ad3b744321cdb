"""How far gaps and rates scatter is learnt from any motion, and what is as small is told from nothing else."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from impact_predictor.prediction.planar import Posture, contacts_of
from impact_predictor.prediction.scatter import SLACK, DifferenceNoise, Scatter
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.spatial import SpatialModel

SCENE = Scene(
    mass=1.0,
    inertia=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    friction=0.5,
    tolerance=1e-5,
    contact_time=0.002,
)
FLAT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
POINTS = ((0.5, 0.5, 0.0), (0.5, -0.5, 0.0), (-0.5, 0.5, 0.0), (-0.5, -0.5, 0.0))
STEP = 20_000_000
GAP, RATE = 2e-3, 0.02


def over_floor(gaps: list[float], rates: list[float]) -> Posture:
    return Posture(axes=FLAT, normal=(0.0, 0.0, 1.0), velocity=(0.0, 0.0, 0.0), gaps=gaps, rates=rates)


def swinging(count: int, amplitude: float, gap: float, rate: float) -> Iterator[tuple[int, Posture]]:
    """Four points that swing by an amplitude in m, 3 rad/s fast, with noise."""
    rng = np.random.default_rng(1)
    for k in range(count):
        phases = 3.0 * 1e-9 * k * STEP + np.array([0.0, 0.3, 2.0, 2.5])
        gaps = amplitude * (1.0 + np.sin(phases)) + gap * rng.normal(size=4)
        rates = 3.0 * amplitude * np.cos(phases) + rate * rng.normal(size=4)
        yield k * STEP, over_floor(gaps.tolist(), rates.tolist())


def learnt(samples: Iterator[tuple[int, Posture]], scene: Scene = SCENE) -> Scatter:
    scatter = Scatter(scene)
    for stamp, posture in samples:
        scatter.take(stamp, posture)
    return scatter


@pytest.mark.parametrize("amplitude", [0.0, 0.1])
def test_noise_is_learnt_whether_the_body_moves_or_not(amplitude: float) -> None:
    scatter = learnt(swinging(1001, amplitude, GAP, RATE))
    assert scatter.gap == pytest.approx(SLACK * GAP, rel=0.3)  # a median of 100
    assert scatter.rate == pytest.approx(SLACK * RATE, rel=0.3)


def test_a_motion_without_noise_scatters_by_what_a_sample_step_hides() -> None:
    scatter = learnt(swinging(1001, 0.1, 0.0, 0.0))
    # Of the third derivative of sin 3t over 0.02 s, by the trapezoid rule and by the middle of two.
    assert scatter.gap < SLACK * 0.1 * 27 * 0.02**3 / 12
    assert scatter.rate < SLACK * 0.1 * 27 * 0.02**2 / 2


def test_what_pauses_and_repeated_stamps_hide_is_no_noise() -> None:
    still, away = over_floor([0.0] * 4, [0.0] * 4), over_floor([1.0] * 4, [0.0] * 4)
    samples = [(k * 10**10 + j * STEP, still if k % 2 else away) for k in range(300) for j in (0, 0, 1)]
    scatter = learnt(iter(samples))
    assert (scatter.gap, scatter.rate) == (0.0, 0.0)


def test_points_that_stand_tell_what_stays_from_sample_to_sample() -> None:
    # One corner is 0.8 mm lower on the body than the scene says: no two samples differ.
    low = over_floor([0.0, 0.0, 0.0, -8e-4], [0.0] * 4)
    scene = SCENE._replace(tolerance=0.005, samples=16)
    model = SpatialModel(scene, POINTS, Scatter(scene))
    assert model.gap_deviation == pytest.approx(5e-4)  # a tenth of the tolerance
    model.scatter = learnt(((k * STEP, low) for k in range(200)), scene)
    assert model.gap_deviation == pytest.approx(8e-4 * 3**0.5 / 4)
    assert SpatialModel(scene._replace(gap_deviation=3e-4), POINTS, model.scatter).gap_deviation == 3e-4


NOISY = learnt(swinging(1001, 0.0, GAP, RATE))


@pytest.mark.parametrize(
    ("gaps", "rates", "expected"),
    [
        # Nothing within the tolerance: the edge that neither comes nor goes stands, and both ends of the other strike.
        ([0.004, 0.002, 0.05, 0.054], [0.02, -0.02, -0.4, -0.36], ((0, 1), (2, 3))),
        # What noise may be is no approach ...
        ([0.004, 0.002, 0.001, -0.002], [0.02, -0.02, 0.0, -0.04], None),
        # ... of a point that may stand; what is surely above the support comes down.
        ([0.004, 0.002, 0.05, 0.05], [0.0, 0.0, -0.04, -0.04], ((0, 1), (2, 3))),
        # Of two points near the support the slower one does not stand that is nearer to the faster one.
        ([0.001, 0.0, 0.003, 0.002], [0.0, 0.0, -0.08, -0.05], ((0, 1), (2, 3))),
        # Corners that close surely apart do not strike together.
        ([0.0, 0.0, 0.02, 0.2], [0.0, 0.0, -0.4, -0.8], ((0, 1), (2,))),
        # A body in flight stays one.
        ([0.3, 0.3, 0.301, 0.5], [-1.0, -1.0, -1.01, -1.0], ((), (0, 1, 2))),
    ],
)
def test_what_noise_hides_is_not_told_from_standing(
    gaps: list[float], rates: list[float], expected: tuple[tuple[int, ...], tuple[int, ...]] | None
) -> None:
    contacts = contacts_of(SCENE, over_floor(gaps, rates), NOISY)
    assert (None if contacts is None else (contacts.old, contacts.new)) == expected


def test_third_differences_tell_noise_from_motion_whatever_the_stamps_are() -> None:
    rng, noise = np.random.default_rng(2), DifferenceNoise()
    for stamp in np.cumsum(rng.uniform(0.01, 0.05, 400)):
        motion = np.array((np.sin(stamp), 5.0 - stamp * stamp))
        noise.add(round(1e9 * stamp), (motion + 0.02 * rng.normal(size=2)).tolist())
    assert noise.square == pytest.approx(0.02**2, rel=0.25)
