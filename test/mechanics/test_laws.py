"""What holds for every impact: friction, momentum, energy, symmetry, units of measurement."""

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
still, rigid = st.just(False), st.booleans()


@st.composite
def problems(draw, restitutions=restitutions, moving=rigid):
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
    if draw(moving):
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


def work(body, before, outcome):
    """Work of the impulses on the body relative to its supports."""
    total = 0.0
    for contact, impulse in zip((body.old, body.new), outcome.impulses, strict=True):
        velocities = (contact_velocity(contact, twist) for twist in (before, outcome.twist))
        total += sum(0.5 * part * (c + after) for part, c, after in zip(impulse, *velocities, strict=True))
    return total


@many
@given(problems(), LAWS)
def test_impulses_lie_in_their_cones_and_change_the_twist_by_themselves(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)
    largest = max(abs(part) for pair in outcome.impulses for part in pair)
    change = [0.0, 0.0, 0.0]
    for contact, (n, t) in zip((body.old, body.new), outcome.impulses, strict=True):
        assert n >= -CLOSE * largest
        assert abs(t) <= contact.friction * n + CLOSE * largest
        px, py = contact.normal[0] * n + contact.normal[1] * t, contact.normal[1] * n - contact.normal[0] * t
        for k, part in enumerate((px / body.mass, py / body.mass, (contact.x * py - contact.y * px) / body.inertia)):
            change[k] += part
    close = CLOSE * (size(body, twist) + largest / body.mass * (1.0 + 2.0 * body.mass / body.inertia))
    assert [after - before for before, after in zip(twist, outcome.twist, strict=True)] == pytest.approx(
        change, abs=close
    )


@many
@given(problems(), LAWS)
def test_no_contact_is_approached_after_an_impact(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)
    assert not outcome.flags & Flag.NO_SOLUTION
    for each in (outcome, *outcome.alternatives):
        for contact in (body.old, body.new):
            assert contact_velocity(contact, each.twist)[0] >= -CLOSE * size(body, twist)


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


@many
@given(problems(restitutions=st.just(0.0)), LAWS)
def test_a_plastic_impact_does_no_work_on_the_body(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)
    assert work(body, twist, outcome) <= CLOSE * body.mass * size(body, twist) ** 2
    assert not outcome.flags & Flag.ENERGY_GAINED


@many
@given(problems())
def test_the_path_law_never_gains_energy_whatever_the_restitution(problem):
    body, twist = problem
    outcome = solve_impact(body, twist)
    close = CLOSE * body.mass * size(body, twist) ** 2
    # A rests up to rounding, which must not count as an approach.
    assert not outcome.flags & Flag.BOTH_STRUCK
    assert outcome.energy_lost >= -close
    assert outcome.energy_lost == pytest.approx(-work(body, twist, outcome), abs=close)


@many
@given(problems(moving=still), LAWS)
def test_the_energy_lost_is_the_loss_of_kinetic_energy(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)

    def energy(v):
        return 0.5 * body.mass * (v[0] ** 2 + v[1] ** 2) + 0.5 * body.inertia * v[2] ** 2

    close = CLOSE * (energy(twist) + energy(outcome.twist))
    assert outcome.energy_lost == pytest.approx(energy(twist) - energy(outcome.twist), abs=close)


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


def mirrored(contact):
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    return contact._replace(x=-contact.x, normal=(-nx, ny), velocity=(-ux, uy))


@many
@given(problems(), LAWS)
def test_in_a_mirror_an_impact_is_the_mirrored_impact(problem, law):
    body, twist = problem
    outcome = solve_impact(body, twist, law)
    image = body._replace(old=mirrored(body.old), new=mirrored(body.new))
    reflected = solve_impact(image, Twist(-twist.vx, twist.vy, -twist.omega), law)
    assert reflected.unique == outcome.unique
    if not outcome.unique:
        return  # The order of preference, + before -, is not symmetrical.
    close = CLOSE * size(body, twist)
    assert reflected.twist == pytest.approx((-outcome.twist[0], outcome.twist[1], -outcome.twist[2]), abs=close)
    assert reflected.mode is outcome.mode
    swap = str.maketrans("+-", "-+")
    assert reflected.segments == tuple(segment.translate(swap) for segment in outcome.segments)


def scaled(contact, length, speed):
    ux, uy = contact.velocity
    return contact._replace(x=contact.x * length, y=contact.y * length, velocity=(ux * speed, uy * speed))


@many
@given(problems(), LAWS, *[st.integers(-30, 30)] * 3)
def test_units_of_mass_length_and_time_do_not_matter(problem, law, mass, length, time):
    # Powers of two change no digit, so that the answers agree in every bit.
    mass, length, time = 2.0**mass, 2.0**length, 2.0**time
    speed = length / time
    body, (vx, vy, omega) = problem
    outcome = solve_impact(body, Twist(vx, vy, omega), law)
    old, new = (scaled(contact, length, speed) for contact in (body.old, body.new))
    other = TwoPointBody(body.mass * mass, body.inertia * mass * length**2, old, new)
    same = solve_impact(other, Twist(vx * speed, vy * speed, omega / time), law)
    assert same.twist == (outcome.twist[0] * speed, outcome.twist[1] * speed, outcome.twist[2] / time)
    assert same.impulses == tuple((n * mass * speed, t * mass * speed) for n, t in outcome.impulses)
    assert (same.mode, same.segments, same.flags) == (outcome.mode, outcome.segments, outcome.flags)
    assert same.energy_lost == outcome.energy_lost * mass * speed**2


@many
@given(problems(), LAWS)
def test_the_outcome_is_continuous_in_friction_where_it_is_unique(problem, law):
    body, twist = problem
    step = 1e-9
    rougher = body._replace(
        old=body.old._replace(friction=body.old.friction + step),
        new=body.new._replace(friction=body.new.friction + step),
    )
    outcomes = [solve_impact(each, twist, law) for each in (body, rougher)]
    # A jam sets in suddenly, and where answers merge or part one of them ends.
    assume(all(each.unique and not each.flags & (Flag.JAMMED | Flag.LAST_RESORT) for each in outcomes))
    # 1e4: how much faster than friction the answer may change, short of a jam.
    assert outcomes[1].twist == pytest.approx(outcomes[0].twist, abs=1e4 * step * size(body, twist))


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
