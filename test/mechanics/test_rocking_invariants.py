"""What holds of every rocking motion: energy, no penetration, symmetry, continuity; and that none ends unnamed.

Bodies, supports and starts are drawn without regard to what is likely: slender and squat, self-locking and
frictionless, with restitution that differs between the contacts, thrown, sliding, turning fast.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from harmonic_deck import Wave, harmonic_support
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from newton_in_world import touch

from impact_predictor import Contact, Flag, TwoPointBody, cylinder, plate
from impact_predictor.mechanics.motion import End, PlanarState, Trajectory, rock, standing
from impact_predictor.mechanics.motion.support import FixedSupport, Support

G = 9.81
frictions = st.one_of(st.sampled_from([0.0, 0.3, 1.0, 1e3]), st.floats(0.02, 3.0))
restitutions = st.one_of(st.just(0.0), st.just(0.0), st.floats(0.05, 0.8))


@st.composite
def points(draw: st.DrawFn, plastic: bool = False) -> TwoPointBody:
    length = draw(st.floats(0.05, 5.0))
    half_height = length * draw(st.floats(0.02, 2.0))
    a, b = (length * draw(st.floats(0.1, 0.6)) for _ in range(2))
    inertia = (length**2 + 4.0 * half_height**2) / 12.0 * draw(st.floats(0.4, 1.5))
    contacts = [
        Contact(x, -half_height, draw(frictions), restitution=0.0 if plastic else draw(restitutions)) for x in (-a, b)
    ]
    return TwoPointBody(1.0, inertia, *contacts)


@st.composite
def discs(draw: st.DrawFn) -> TwoPointBody:
    radius = draw(st.floats(0.05, 2.0))
    gamma, gamma_new = (draw(st.floats(0.15, 1.2)) for _ in range(2))
    return cylinder(radius, gamma, 1.0, draw(frictions), gamma_new, restitution=draw(restitutions))


bodies = st.one_of(points(), points(), discs())
fixed = st.builds(FixedSupport, st.one_of(st.just(0.0), st.floats(-0.5, 0.5)), st.just(G))
waves = st.builds(Wave, st.floats(0.0, 0.4), st.floats(0.5, 4.0), st.floats(0.0, 6.0))
moving = st.builds(
    lambda angle, x, y, px, py: harmonic_support(angle, x, y).at(px, py),
    st.tuples(waves, waves),
    st.tuples(waves),
    st.tuples(waves),
    st.floats(-4.0, 4.0),
    st.floats(-3.0, 4.0),
)


@st.composite
def starts(draw: st.DrawFn, body: TwoPointBody) -> PlanarState:
    speed = math.sqrt(G * size_of(body))
    kind = draw(st.sampled_from(["rests", "turns", "turns", "thrown"]))
    if kind == "rests":
        return standing(body, 0.0, 0.0, draw(st.sampled_from([0.0, 0.7, -1.3])) * speed)
    angle, pace = draw(st.floats(-0.8, 0.8)), st.one_of(st.just(0.0), st.floats(-1.0, 1.0))
    if kind == "turns":
        return standing(body, angle, draw(pace) * speed / size_of(body), draw(pace) * speed)
    state = standing(body, angle)
    vx, vy, spin = (draw(pace) * speed for _ in range(3))
    return state._replace(y=state.y + 0.3 * size_of(body), vx=vx, vy=vy, omega=spin / size_of(body))


def size_of(body: TwoPointBody) -> float:
    assert body.old is not None
    return math.hypot(body.new.x - body.old.x, body.new.y - body.old.y)


def energy(run: Trajectory, state: PlanarState) -> float:
    gx, gy, _, _ = run.support.felt(0.0)
    body = run.body
    kinetic = 0.5 * (state.vx**2 + state.vy**2 + body.inertia / body.mass * state.omega**2)
    return kinetic - gx * state.x - gy * state.y


calm = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@given(st.data())
@calm
def test_over_a_fixed_support_energy_never_grows(data: st.DataObject) -> None:
    body = data.draw(bodies)
    run = rock(body, data.draw(starts(body)), data.draw(fixed), duration=5.0)
    times = np.linspace(0.0, run.time, 300)
    values = energy(run, run.state(times))
    scale = np.abs(values).max() + G * size_of(body)
    # Each step is made to 1e-11, and a slide of 5 s takes some dozens of them.
    assert np.diff(values).max() < 1e-9 * scale
    for strike in run.impacts:
        assert energy(run, strike.after) <= energy(run, strike.before) + 1e-11 * scale


@given(st.data())
@calm
def test_contacts_never_go_into_the_support(data: st.DataObject) -> None:
    body = data.draw(bodies)
    support: Support = data.draw(st.one_of(fixed, moving))
    run = rock(body, data.draw(starts(body)), support, duration=5.0)
    times = np.linspace(0.0, run.time, 300)
    far = size_of(body) + np.abs(run.state(times).x).max() + np.abs(support.motion(times).x).max()
    for time, state in zip(times, np.array(run.world(times)).T, strict=True):
        for i in (0, 1):
            assert touch(body, support, i, time, state).gap > -1e-11 * far


@given(st.data())
@calm
def test_mirrored_bodies_move_as_mirror_images(data: st.DataObject) -> None:
    body = data.draw(points(plastic=True))
    assert body.old is not None
    angle, pace = data.draw(st.floats(-0.7, 0.7)), data.draw(st.floats(-1.0, 1.0))
    slope = data.draw(st.floats(-0.4, 0.4))
    mirrored = TwoPointBody(body.mass, body.inertia, *(c._replace(x=-c.x) for c in (body.new, body.old)))
    start = standing(body, angle, pace, 0.3)
    image = start._replace(x=-start.x, angle=-start.angle, vx=-start.vx, omega=-start.omega)
    one = rock(body, start, FixedSupport(slope), duration=3.0)
    other = rock(mirrored, image, FixedSupport(-slope), duration=3.0)
    assert one.end is other.end
    assert len(one.impacts) == len(other.impacts)
    for mine, theirs in zip(one.impacts[:6], other.impacts[:6], strict=True):
        assert mine.time == pytest.approx(theirs.time, rel=1e-9)
        assert (mine.after.vx, mine.after.omega) == pytest.approx(
            (-theirs.after.vx, -theirs.after.omega), rel=1e-6, abs=1e-9
        )


@given(st.data())
@calm
def test_impacts_keep_the_balance_of_momentum(data: st.DataObject) -> None:
    body = data.draw(bodies)
    run = rock(body, data.draw(starts(body)), data.draw(st.one_of(fixed, moving)), duration=3.0)
    for strike in run.impacts[:20]:
        struck = strike.outcome.body
        assert struck is not None
        x = y = turn = 0.0
        for contact, (n, t) in zip((struck.old, struck.new), strike.outcome.impulses, strict=True):
            if contact is not None:
                nx, ny = contact.normal
                px, py = n * nx + t * ny, n * ny - t * nx
                x, y, turn = x + px, y + py, turn + contact.x * py - contact.y * px
        before, after = strike.before, strike.after
        change = (after.vx - before.vx, after.vy - before.vy, (after.omega - before.omega) * body.inertia)
        size = abs(before.vx) + abs(before.vy) + size_of(body) * abs(before.omega)
        assert change == pytest.approx((x, y, turn), abs=1e-10 * size * (1.0 + size_of(body)))


@given(st.data())
@calm
def test_the_motion_does_not_depend_on_the_tolerance_of_its_steps(data: st.DataObject) -> None:
    body = data.draw(points(plastic=True))
    support = data.draw(st.one_of(fixed, moving))
    start = data.draw(starts(body))
    fine, coarse = (rock(body, start, support, duration=3.0, tolerance=t) for t in (1e-12, 1e-9))
    # As far as both see the same: behind a border that one just passes and the other does not they are two motions.
    assume([p.states for p in fine.phases[:4]] == [p.states for p in coarse.phases[:4]])
    time = 0.999 * min(fine.phases[: min(4, len(fine.phases))][-1].end, fine.time)
    moved = max(1.0, abs(fine.state(time).x), abs(fine.state(time).omega))
    assert coarse.state(time) == pytest.approx(fine.state(time), abs=1e-5 * moved)


@given(st.data())
@calm
def test_the_pose_is_continuous_and_the_velocity_jumps_only_at_impacts(data: st.DataObject) -> None:
    body = data.draw(bodies)
    run = rock(body, data.draw(starts(body)), data.draw(st.one_of(fixed, moving)), duration=5.0)
    size, speed = size_of(body), math.sqrt(G * size_of(body))
    jumps = {strike.time for strike in run.impacts} | set(run.jams)
    summed = [accumulation.time for accumulation in run.accumulations]
    for one, other in pairwise(run.phases):
        before, after = run.state(math.nextafter(other.start, -math.inf)), run.state(other.start)
        # A velocity times the rounding of the time goes by between the two.
        moving_on = 1e-14 * (1.0 + other.start) * (abs(before.vx) + abs(before.vy) + size * abs(before.omega))
        far = size + abs(after.x)
        assert abs(after.x - before.x) + abs(after.y - before.y) < 1e-9 * far + moving_on
        assert abs(after.angle - before.angle) < 1e-9 + 1e-14 * (1.0 + other.start) * abs(before.omega)
        if other.start not in jumps and not any(abs(other.start - time) < 1e-6 for time in summed):
            step = abs(after.vx - before.vx) + abs(after.vy - before.vy) + size * abs(after.omega - before.omega)
            assert step < 1e-7 * (speed + abs(before.vx) + size * abs(before.omega))
        assert one.end <= other.start + 1e-12


@given(st.data())
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_every_motion_comes_to_a_named_end(data: st.DataObject) -> None:
    body = data.draw(bodies)
    law = data.draw(st.sampled_from(["path", "total"]))
    run = rock(body, data.draw(starts(body)), data.draw(st.one_of(fixed, moving)), law, duration=8.0)
    assert run.end in (End.RESTS, End.BALANCED, End.OVERTURNED, End.TIME_UP, End.TOO_MANY_EVENTS)
    assert np.isfinite(np.array(run.state(np.linspace(0.0, 8.0, 50)))).all()
    assert run.time <= 8.0 + 1e-12


@pytest.mark.parametrize("value", [0.0, 1e-300, 1e-30, 1e30, 1e150, -1e30])
def test_numbers_of_any_size_raise_nothing(value: float) -> None:
    body = TwoPointBody(1.0, 0.2, Contact(-0.5, -0.4, 0.5), Contact(0.5, -0.4, 0.5))
    start = standing(body, 0.2)
    for field in start._fields:
        run = rock(body, start._replace(**{field: value}), duration=1.0, max_events=200)
        assert isinstance(run.end, End)
    for heavy in (body._replace(mass=abs(value) + 1e-300), body._replace(inertia=abs(value) + 1e-300)):
        assert isinstance(rock(heavy, start, duration=1.0, max_events=200).end, End)
    assert isinstance(rock(body, start, FixedSupport(0.1, value), duration=1.0, max_events=200).end, End)


@pytest.mark.parametrize(("height", "restitution"), [(6.0, 0.9), (6.0, 0.95), (3.0, 0.9)])
def test_a_tall_plate_that_bounces_on_one_contact_before_the_other_lands_gains_nothing_and_goes_on(
    height: float, restitution: float
) -> None:
    body = plate(1.0, height, 1.0, 0.0, restitution=restitution)
    run = rock(body, standing(body, 0.03), max_events=10_000)
    assert run.end in (End.RESTS, End.TIME_UP)
    energies = [energy(run, state) for strike in run.impacts for state in (strike.before, strike.after)]
    released = energies[0]
    # Hops that are summed are known to 1e-12.
    assert all(then <= before + 1e-12 * released for before, then in pairwise(energies))


@pytest.mark.parametrize(("gravity", "slow"), [(0.0981, False), (9.81, True), (981.0, True)])
def test_an_impact_is_slow_or_not_under_the_gravity_of_the_support(gravity: float, slow: bool) -> None:
    # The impulse grows with the root of gravity, that of gravity during the contact with gravity itself.
    body = plate(1.0, 1.0, 1.0, 1.0)
    first = rock(body, standing(body, 0.001), FixedSupport(0.0, gravity)).impacts[0]
    assert bool(first.outcome.flags & Flag.SLOW_IMPACT) is slow
