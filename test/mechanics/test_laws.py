"""What the laws tell of every impact besides its invariants: modes, flags, and a finite answer to any number."""

import math
import random
import sys

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, solve_impact

CLOSE = 1e-10
"""Of the speeds: a few dozen roundings, times the condition number of bodies up to 1e3 times as long as thick."""

LAWS = st.sampled_from(["path", "total"])


def between(low, high):
    """Numbers of six decimals, so that none is too small to be scaled."""
    return st.integers(round(low * 1e6), round(high * 1e6)).map(lambda number: number * 1e-6)


lengths, speeds = between(0.02, 2.0), between(0.01, 3.0)
frictions, restitutions = between(0.0, 2.0), between(0.0, 1.0)
signs = st.sampled_from([-1.0, 1.0])
many = settings(max_examples=300, deadline=None, derandomize=True)


@st.composite
def problems(draw):
    """A body that stands on A, turns about it or also slides on it, and approaches B; its supports move as one body."""
    kind = draw(st.sampled_from(["flat", "step", "wedge", "any"]))
    a, b, h = draw(lengths), draw(lengths), draw(lengths)
    old_at, new_at = (-a, -h), (b, -h)
    angle = 0.0
    if kind in ("wedge", "any"):
        angle = draw(between(-1.4, 1.4))
        new_at = (b, draw(between(-2.0, 0.5)))
    if kind == "step":
        new_at = (b, -draw(lengths))
        # B's tangent passes through A.
        angle = math.atan2(old_at[1] - new_at[1], old_at[0] - new_at[0]) + math.pi
    if kind == "any":
        turn = draw(between(-3.0, 3.0))
        old_normal = (-math.sin(turn), math.cos(turn))
    else:
        old_normal = (0.0, 1.0)
    new_normal = (-math.sin(angle), math.cos(angle))
    inertia, mass = draw(between(0.01, 2.0)), draw(between(0.1, 10.0))

    omega, slip = draw(signs) * draw(speeds), draw(st.sampled_from([0.0, 1.0])) * draw(signs) * draw(speeds)
    vx, vy = omega * old_at[1] + slip * old_normal[1], -omega * old_at[0] - slip * old_normal[0]
    approach = new_normal[0] * (vx - omega * new_at[1]) + new_normal[1] * (vy + omega * new_at[0])
    largest = math.hypot(vx - omega * new_at[1], vy + omega * new_at[0]) + abs(slip)
    assume(abs(approach) > 1e-3 * largest)
    if approach > 0.0:
        vx, vy, omega = -vx, -vy, -omega
    ux, uy, turning = 0.0, 0.0, 0.0
    if draw(st.booleans()):
        ux, uy, turning = draw(between(-2.0, 2.0)), draw(between(-2.0, 2.0)), draw(between(-2.0, 2.0))
    old, new = (
        Contact(x, y, draw(frictions), normal, restitution, (ux - turning * y, uy + turning * x))
        for (x, y), normal, restitution in ((old_at, old_normal, 0.0), (new_at, new_normal, draw(restitutions)))
    )
    return TwoPointBody(mass, inertia * mass, old, new), Twist(vx + ux, vy + uy, omega + turning)


def contact_velocity(contact, twist):
    """Normal and tangential velocity of the body at a contact, relative to its support."""
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    cx, cy = twist[0] - twist[2] * contact.y - ux, twist[1] + twist[2] * contact.x - uy
    return nx * cx + ny * cy, ny * cx - nx * cy


def size(body, twist):
    """The speed that roundings are a part of."""
    supports = [abs(part) for contact in (body.old, body.new) for part in contact.velocity]
    return max(abs(twist[0]), abs(twist[1]), 2.0 * abs(twist[2]), *supports)


@many
@given(problems(), LAWS)
def test_the_mode_says_what_the_contacts_do(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)
    (vna, vta), (vnb, vtb) = (contact_velocity(contact, outcome.twist) for contact in (body.old, body.new))
    close = 1e-8 * size(body, twist)
    leaves = {Mode.PIVOT: (1, 0), Mode.PIVOT_SLIDE: (1, 0), Mode.BACK_PIVOT: (0, 1), Mode.FLIGHT: (1, 1)}
    for velocity, left in zip((vna, vnb), leaves.get(outcome.mode, (0, 0)), strict=True):
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


decades = st.floats(-6.0, 6.0).map(lambda exponent: 10.0**exponent)


@st.composite
def extremes(draw):
    """Numbers over twelve decades, with zeros and signs."""

    def some():
        return draw(st.sampled_from([-1.0, 0.0, 1.0])) * draw(decades)

    def contact():
        angle = draw(st.sampled_from([0.0, 1e-9, 0.5, -1.2, math.pi / 2, math.pi]))
        friction = draw(st.one_of(st.just(0.0), decades))
        normal = (-math.sin(angle), math.cos(angle))
        return Contact(some(), some(), friction, normal, draw(st.sampled_from([0.0, 0.5, 1.0])), (some(), some()))

    old = draw(st.sampled_from([None, contact()]))
    body = TwoPointBody(draw(decades), draw(decades), old, contact())
    if old is not None and draw(st.booleans()):
        return body, body.turning(some())
    return body, Twist(some(), some(), some())


@settings(max_examples=600, deadline=None, derandomize=True)
@given(extremes(), LAWS)
def test_no_number_within_twelve_decades_raises_or_gives_a_number_that_is_not_finite(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)
    assert not outcome.flags & Flag.INVALID_INPUT
    numbers = (*outcome.twist, *outcome.impulses[0], *outcome.impulses[1], outcome.energy_lost)
    assert all(math.isfinite(number) for number in numbers)
    if outcome.flags & Flag.NO_SOLUTION:
        assert outcome.mode is Mode.NO_IMPACT
        assert outcome.twist == twist


@many
@given(problems(), LAWS, *[between(-2.0, 2.0)] * 2)
def test_supports_that_move_apart_give_an_answer_or_say_that_there_is_none(problem, law, ux, uy):
    body, twist = problem
    body = body._replace(new=body.new._replace(velocity=(ux, uy)))
    outcome = solve_impact(body, twist, law)
    if outcome.flags & Flag.NO_SOLUTION:
        assert outcome.twist == twist
    elif not outcome.flags & Flag.INVALID_INPUT:
        for contact in (body.old, body.new):
            assert contact_velocity(contact, outcome.twist)[0] >= -CLOSE * size(body, twist)


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
