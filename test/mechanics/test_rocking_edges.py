"""Rocking where events hide: dips within a step, the edge of a disc's cone, slip that ends among impacts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from harmonic_deck import Wave, harmonic_support
from newton_in_world import strike_by_newton
from scipy.optimize import brentq

from impact_predictor import cylinder, plate
from impact_predictor.mechanics.motion import MotionKind, next_strike, rock, standing
from impact_predictor.mechanics.motion.accumulation import FollowedImpact, ImpactSequence
from impact_predictor.mechanics.motion.felt import FrameAcceleration
from impact_predictor.mechanics.motion.support import FixedSupport

G = 9.81


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-11, -1e-11])
@pytest.mark.parametrize("late", [0.4, 0.5, 0.6, 0.7])
def test_a_corner_that_dips_into_the_support_while_the_body_spins_past_strikes(depth: float, late: float) -> None:
    """A spinning plate rises, and its corner comes down to the support for less than a step of the search.

    The corner's height is y + vy t - g t^2/2 - R cos(w (t - t0)): its lowest value is found by itself.
    """
    body, spin, rise = plate(length=0.8, height=1.0, mass=1.0, friction=0.5), 20.0, 0.5
    corner = math.hypot(0.4, 0.5)
    lowest = late * 0.25 / spin

    def height(t: float) -> float:
        return rise * t - 0.5 * G * t * t - corner * math.cos(spin * (t - lowest))

    def rate(t: float) -> float:
        return rise - G * t + corner * spin * math.sin(spin * (t - lowest))

    bottom = brentq(rate, lowest - 0.05, lowest + 0.05, xtol=1e-15)
    # Contact 1, below and ahead of the mass centre, comes to the lowest place at angle -atan2(0.4, 0.5).
    angle = -math.atan2(0.4, 0.5) - spin * lowest
    start = standing(body, 0.0)._replace(y=-height(bottom) - depth, angle=angle, vx=0.0, vy=rise, omega=spin)
    run = rock(body, start, FixedSupport(), duration=0.03)
    fall = next_strike(body, start, None, FixedSupport(), 0.03)
    if depth < 0.0:
        assert not run.impacts
        assert fall is None
        return
    strikes = brentq(lambda t: start.y + height(t), 0.0, bottom, xtol=1e-16)
    assert run.impacts[0].new == 1
    # Where a dip is only `depth` deep a rounding of the height moves the time by its root.
    assert run.impacts[0].time == pytest.approx(strikes, abs=1e-14 / math.sqrt(depth) + 1e-12)
    assert fall is not None
    assert (fall.point, fall.time) == (1, run.impacts[0].time)


@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-7, -1e-7])
def test_without_weight_a_deck_that_comes_up_to_a_body_for_a_moment_strikes_it(depth: float) -> None:
    """The deck is at A sin(w t); a tilted crate hovers, its lower corner `depth` below the crest."""
    body, height, pace = plate(length=0.8, height=1.0, mass=1.0, friction=0.5), 0.1, 2.0
    deck = harmonic_support(y=(Wave(height, pace),), gravity=0.0)
    hovers = standing(body, 0.1)
    start = hovers._replace(y=hovers.y + height - depth, vy=-height * pace)
    for strike in (rock(body, start, deck, duration=1.5).impacts[:1], [next_strike(body, start, None, deck, 1.5)]):
        if depth < 0.0:
            assert not any(strike)
        else:
            (found,) = strike
            assert found is not None
            # The crest is flat: a rounding of its height moves the time by its root.
            wanted = math.asin(1.0 - depth / height) / pace
            assert found.time == pytest.approx(wanted, abs=1e-12 / math.sqrt(depth) + 1e-11)


class Recoil:
    """A deck without gravity that from `start` on accelerates away from a body with sin(PACE t) m/s^2."""

    gravity, PACE = 0.0, 2.0
    period = 2.0 * math.pi / PACE

    def __init__(self, start: float) -> None:
        self.start = start

    def felt(self, time: float) -> FrameAcceleration:
        return 0.0, math.sin(self.PACE * max(0.0, time - self.start)), 0.0, 0.0

    def away(self, time: float) -> float:
        """How far the deck has gone."""
        angle = self.PACE * max(0.0, time - self.start)
        return (angle - math.sin(angle)) / self.PACE**2


def test_a_gap_that_closes_and_opens_again_within_a_step_is_not_missed() -> None:
    """A crate drifts slowly to the deck, which recoils just as it comes: the gap is below zero for a moment."""
    body, depth, speed = plate(length=0.8, height=1.0, mass=1.0, friction=0.5), 3e-5, 0.0025
    flat = standing(body, 0.1)
    for begins in np.linspace(0.5, 0.9, 60).tolist():
        deck = Recoil(begins)
        least = begins + math.acos(1.0 - speed * deck.PACE) / deck.PACE
        gap = speed * least - deck.away(least) - depth
        fall = next_strike(body, flat._replace(y=flat.y + gap, vy=-speed), None, deck, 3.0)
        assert fall is not None
        assert fall.time < least
        # The recoil begins with a kink, and no order of extrapolation holds across it.
        assert gap - speed * fall.time + deck.away(fall.time) == pytest.approx(0.0, abs=0.2 * depth)


class Swell:
    """A heave of which the least weight, for a moment, is `least` m/s^2; `part` of its period is told as its period."""

    gravity, pace = G, 8.0

    def __init__(self, least: float, part: float) -> None:
        self.least, self.period = least, part * 2.0 * math.pi / self.pace

    def felt(self, time: float) -> FrameAcceleration:
        swing = 0.5 * (1.0 - math.cos(self.pace * (time - 0.05)))
        return 0.0, -self.least - (G - self.least) * swing, 0.0, 0.0


def test_a_contact_that_lifts_off_within_a_step_is_not_missed() -> None:
    body = plate(length=0.8, height=1.0, mass=1.0, friction=5.0)
    start, motions = standing(body, 0.3, -1.0), []
    for least in np.linspace(-0.5, 2.0, 41).tolist():
        found, finely = (next_strike(body, start, 0, Swell(least, part), 1.0) for part in (1.0, 0.05))
        assert found is not None
        assert finely is not None
        assert found.motion is finely.motion
        assert found.time == pytest.approx(finely.time, abs=1e-7)  # grazing lift-offs amplify what is left
        motions.append(found.motion)
    assert set(motions) == {MotionKind.TURNING, MotionKind.FLIGHT}


@pytest.mark.parametrize(
    ("edge", "gamma", "angle", "omega", "states"),
    [
        (0, 0.9, 0.5, 0.0, ["SO", "+O"]),  # it rolls into its gap
        (1, 0.9, 0.5, 0.0, ["OS", "O-"]),
        (0, 0.5, 0.6, 1.0, ["SO", "-O"]),  # it rolls over its edge
        (1, 0.5, 0.6, 1.0, ["OS", "O+"]),
    ],
)
def test_a_disc_on_an_edge_slips_where_the_cone_of_friction_ends(
    edge: int, gamma: float, angle: float, omega: float, states: list[str]
) -> None:
    body = cylinder(radius=0.3, gamma=gamma, mass=40.0, friction=0.2)
    side = 1.0 if edge == 0 else -1.0
    start = standing(body, side * angle, side * omega)
    run = rock(body, start, FixedSupport(), duration=2.0)
    course = strike_by_newton(body, FixedSupport(), start, states[0], 0.5)
    assert [phase.states for phase in run.phases[:2]] == course.states[:2] == states
    assert run.phases[0].end == pytest.approx(course.begins[1], abs=1e-9)


def limits_of(slips: float, now: float, count: int) -> list[object]:
    """What is said after each of some impacts, each the one before halved; the slip falls to `slips` at their end."""
    sequence = ImpactSequence(time=0.3, speed=3.0, length=1.0, tolerance=1e-12)
    found: list[object] = []
    for k in range(count):
        shrinks = 0.5**k
        place = 0.0, shrinks, 0.0, slips + (now - slips) * shrinks
        found.append(sequence.add(FollowedImpact((0, 1, 2), 0.01 * shrinks, place)))
    return found


@pytest.mark.parametrize(
    ("slips", "now", "count", "followed"),
    [
        (0.9, 1.0, 8, 7),  # the slip goes on: as soon as a sequence may be summed
        (0.1, 30.0, 12, 9),  # after the k-th impact 0.1 is less than half of 0.1 + 29.9/2^(k-1) until k is 10
        (-0.1, 30.0, 8, 8),  # friction would reverse the slip: it stops before, and all is different
    ],
)
def test_impacts_are_summed_while_they_leave_most_of_the_slip(
    slips: float, now: float, count: int, followed: int
) -> None:
    found = limits_of(slips, now, count)
    assert [limit is None for limit in found] == [True] * followed + [False] * (count - followed)
