"""What the laws tell of an impact besides its numbers: modes, gains of energy, jams, and what counts as zero."""

import math
import random
import sys

import pytest
from alone import random_impacts
from seen_by_contacts import contact_velocity, velocities

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, solve_impact

LEAVES = {Mode.PIVOT: (1, 0), Mode.PIVOT_SLIDE: (1, 0), Mode.BACK_PIVOT: (0, 1), Mode.FLIGHT: (1, 1)}
"""Which contacts leave, the old one first."""


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("kind", ["plate", "cylinder", "floor", "wedge", "tilted", "deck"])
def test_the_mode_says_what_the_contacts_do(kind, law):
    for body, twist in random_impacts(kind, 100, seed=1):
        outcome = solve_impact(body, twist, law)
        if outcome.mode is Mode.NO_IMPACT:
            continue
        vna, vta, vnb, vtb = velocities(body, outcome.twist)[0]
        close = 1e-9 * max(velocities(body, twist)[1])
        for velocity, left in zip((vna, vnb), LEAVES.get(outcome.mode, (0, 0)), strict=True):
            assert velocity > 0.0 if left else velocity == pytest.approx(0.0, abs=close)
        if outcome.mode in (Mode.STOP, Mode.PIVOT):
            assert vtb == pytest.approx(0.0, abs=close)
        if outcome.mode is Mode.STOP:
            assert vta == pytest.approx(0.0, abs=close)


def test_newtons_restitution_can_gain_energy_and_the_outcome_says_so():
    source, gained = random.Random(8), 0
    for _ in range(5000):
        angle = source.uniform(-1.5, 1.5)
        old = Contact(source.uniform(-2, 0), source.uniform(-2, 0), source.uniform(0, 2))
        normal = (-math.sin(angle), math.cos(angle))
        new = Contact(source.uniform(0, 2), source.uniform(-2, 0), source.uniform(0, 2), normal, restitution=1.0)
        body = TwoPointBody(1.0, source.uniform(0.05, 1.0), old, new)
        outcome = solve_impact(body, body.turning(source.choice((-1.0, 1.0))), "total")
        assert bool(outcome.flags & Flag.ENERGY_GAINED) is (outcome.energy_lost < -1e-9)
        gained += bool(outcome.flags & Flag.ENERGY_GAINED)
    assert gained > 10


def test_a_speed_of_one_rounding_counts_as_zero():
    # A plate on a deck that moves with 1e3 m/s: the old contact's velocity is a rounding of that, not zero.
    for velocity in ((1e3, 0.0), (1e3 / 3.0, 1e3 / 7.0)):
        old, new = Contact(-0.5, -0.2, 0.9, velocity=velocity), Contact(0.5, -0.2, 0.9, velocity=velocity)
        body = TwoPointBody(1.0, 0.09, old, new)
        for speed in (0.1, 0.3, 0.7, 1.1):
            outcome = solve_impact(body, body.turning(-speed))
            assert outcome.mode is Mode.STOP
            assert outcome.segments == ("SS",)
            assert outcome.twist == pytest.approx((*velocity, 0.0), abs=4e3 * sys.float_info.epsilon)


def sliding_on_the_floor(a, b, height, rho_squared, friction_old, friction_new, slip):
    """A body of mass 1 on one flat floor that tips onto B while it slides on A, and its twist."""
    old, new = Contact(-a, -height, friction_old), Contact(b, -height, friction_new)
    return TwoPointBody(1.0, rho_squared, old, new), Twist(slip - height, -a, -1.0)


def random_sliders(count):
    """Bodies that slide backwards, with what decides about them: f_A over its threshold, and the lever of B."""
    source = random.Random(2)
    for _ in range(count):
        a, b, height, rho_squared = (source.uniform(0.05, 2.0) for _ in range(4))
        threshold = (rho_squared + a * a) / (a * height)
        friction_old, friction_new = threshold * source.uniform(0.5, 2.0), source.uniform(0.0, 1.0)
        slip = -source.uniform(0.1, 2.0)
        body, twist = sliding_on_the_floor(a, b, height, rho_squared, friction_old, friction_new, slip)
        yield body, twist, friction_old > threshold, rho_squared < a * b + friction_new * a * height


def test_a_body_that_slides_backwards_on_a_flat_floor_jams_under_two_conditions():
    counted = {True: 0, False: 0}
    for body, twist, self_locking, pressed in random_sliders(2000):
        outcome = solve_impact(body, twist)
        jams = self_locking and pressed
        counted[jams] += 1
        assert bool(outcome.flags & Flag.JAMMED) is jams
        assert outcome.unique is (not self_locking or pressed)
    assert min(counted.values()) > 300


def test_alternatives_are_different_answers_of_the_same_law():
    for body, twist, self_locking, pressed in random_sliders(500):
        if self_locking and not pressed:
            outcome = solve_impact(body, twist)
            assert outcome.alternatives
            for other in outcome.alternatives:
                assert other.twist != pytest.approx(outcome.twist, abs=1e-9)
                for contact in (body.old, body.new):
                    assert contact_velocity(contact, other.twist)[0] >= -1e-11 * max(map(abs, twist))
