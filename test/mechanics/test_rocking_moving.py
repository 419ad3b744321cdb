"""Rocking on a moving support, against Newton's law in the world's axes and against cases known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from harmonic_deck import Wave, harmonic_support
from newton_in_world import DECK, accelerated, newton
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from impact_predictor import Contact, InputError, TwoPointBody, cylinder, plate
from impact_predictor.mechanics.motion import End, Trajectory, rock, standing
from impact_predictor.mechanics.motion.support import FixedSupport, MovingSupport, SupportMotion, sampled_support

G = 9.81
AGREES = 1e-9
"""What the motion on a moving support is made for: each step's error is below 1e-11 of what happens in it."""

CRATE = plate(length=0.8, height=1.0, mass=50.0, friction=0.4)
DRUM = cylinder(radius=0.3, gamma=0.5, gamma_new=0.7, mass=40.0, friction=0.3)
TALL = plate(length=0.4, height=1.2, mass=20.0, friction=0.8)


def worst_phase(run: Trajectory, shortest: float = 1e-3) -> float:
    """How far phases that begin alike end apart, integrated in the world and as followed."""
    worst = 0.0
    for start, end, states in run.phases:
        if end - start < shortest or states == "SS":
            continue
        # Just inside, where both ends belong to the phase.
        first, last = start + 1e-9 * (end - start), end - 1e-9 * (end - start)
        goes = solve_ivp(
            lambda t, y, states=states: newton(run.body, run.support, states, t, y)[0],
            (first, last),
            np.array(run.world(first)),
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
        )
        worst = max(worst, float(np.abs(goes.y[:, -1] - np.array(run.world(last))).max()))
    return worst


SLIPPERY = CRATE._replace(old=CRATE.old._replace(friction=0.1), new=CRATE.new._replace(friction=0.15))
BOUNCES = TwoPointBody(1.0, 0.15, Contact(-0.4, -0.5, 0.1, restitution=0.4), Contact(0.4, -0.5, 0.15))


def test_every_phase_is_newtons_law_in_the_world() -> None:
    seen = set()
    for body, start in (
        (CRATE, standing(CRATE, 0.05)),
        (CRATE, standing(CRATE, -0.2, -0.3)),
        (CRATE, standing(CRATE, 0.0)),
        (SLIPPERY, standing(SLIPPERY, 0.3)),
        (DRUM, standing(DRUM, 0.2)),
        (DRUM, standing(DRUM, -0.3, slip=0.5)),
        (DRUM, standing(DRUM, 0.0, slip=2.0)),
        (DRUM, standing(DRUM, 0.1)._replace(vx=0.3, vy=1.5)),
        (BOUNCES, standing(BOUNCES, 0.3)),
        (BOUNCES, standing(BOUNCES, 0.1)._replace(vx=-0.4, vy=1.0)),
        (TALL, standing(TALL, 0.05)),
    ):
        run = rock(body, start, DECK, duration=4.0)
        assert len(run.phases) >= 2
        assert worst_phase(run) < AGREES
        seen |= {phase.states for phase in run.phases}
    assert {"OO", "SS"} <= seen
    assert seen & {"SO", "OS"}
    assert seen & {"+O", "-O", "O+", "O-"}
    assert seen & {"++", "--"}


@pytest.mark.parametrize("beyond", [1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
def test_a_slip_that_begins_as_slowly_as_rounding_ends_and_the_body_rests_again(beyond: float) -> None:
    """The deck's acceleration passes that of friction by so much, for the time of sqrt(8 beyond) of its phase.

    The slip goes on until its area is made up for, in cubics half as long again.
    """
    low = plate(length=0.8, height=0.3, mass=1.0, friction=0.3)
    run = rock(low, standing(low, 0.0), harmonic_support(x=(Wave(0.3 * G * (1.0 + beyond) / 9.0, 3.0),)), duration=1.0)
    assert run.end is End.TIME_UP
    assert [phase.states for phase in run.phases] == ["SS", "++", "SS"]
    _, slip, rest = run.phases
    assert rest.start - slip.start == pytest.approx(1.5 * math.sqrt(8.0 * beyond) / 3.0, rel=0.01)
    under = harmonic_support(x=(Wave(0.3 * G * (1.0 - beyond) / 9.0, 3.0),))
    assert [phase.states for phase in rock(low, standing(low, 0.0), under, duration=10.0).phases] == ["SS"]


@pytest.mark.parametrize(("body", "angle"), [(CRATE, 0.3), (DRUM, 0.2)])
def test_constant_acceleration_of_the_support_is_tilted_gravity(body: TwoPointBody, angle: float) -> None:
    tilted = FixedSupport(math.atan(1.5 / G), math.hypot(1.5, G))
    one = rock(body, standing(body, angle), accelerated(1.5), duration=3.0)
    other = rock(body, standing(body, angle), tilted, duration=3.0)
    assert [s.outcome.mode for s in one.impacts[:6]] == [s.outcome.mode for s in other.impacts[:6]]
    times = np.linspace(0.0, 0.9999 * other.impacts[:6][-1].time, 200)
    for mine, theirs in zip(one.state(times), other.state(times), strict=True):
        assert np.abs(mine - theirs).max() < AGREES


def test_on_a_support_in_free_fall_a_body_turns_and_moves_for_ever() -> None:
    start = standing(CRATE, 0.2)._replace(vx=0.1, vy=0.5, omega=0.3)
    run = rock(CRATE, start, accelerated(0.0, -G), duration=2.0)
    assert [phase.states for phase in run.phases] == ["OO"]
    end = run.state(2.0)
    assert end.omega == pytest.approx(0.3, abs=1e-12)
    assert end.angle == pytest.approx(0.2 + 0.6, abs=1e-12)
    assert (end.x - start.x, end.y - start.y) == pytest.approx((0.2, 1.0), abs=1e-12)


def test_a_body_rests_on_a_support_in_free_fall() -> None:
    run = rock(CRATE, standing(CRATE, 0.0), accelerated(0.0, -G), duration=2.0)
    assert run.end is End.TIME_UP
    assert run.state(2.0) == pytest.approx(run.state(0.0), abs=1e-12)


@pytest.mark.parametrize(("offset", "rests"), [(0.99, True), (1.01, False)])
def test_without_gravity_a_turning_support_throws_outwards(offset: float, rests: bool) -> None:
    """3 m inside a turning drum the crate, its mass centre at 2.5 m, rests where x < f 2.5 m."""
    run = rock(
        CRATE, standing(CRATE, 0.0), accelerated(rate=2.0, gravity=0.0).at(offset * 0.4 * 2.5 - 0.4, -3.0), duration=0.5
    )
    assert (run.phases[0].states == "SS") is rests
    if not rests:
        assert run.phases[0].states == "++"


SWAY, PACE = 1.0, 3.0


@pytest.mark.parametrize(
    ("length", "height", "friction", "holds", "states"),
    [(0.8, 0.3, 0.3, 0.3, "++"), (0.4, 1.6, 1.0, 0.25, "OS")],  # slides; tips
)
def test_a_crate_begins_to_slide_or_tip_when_the_felt_forces_say_so(
    length: float, height: float, friction: float, holds: float, states: str
) -> None:
    crate = plate(length=length, height=height, mass=1.0, friction=friction)
    # A wave without height changes only how often the margins are looked at.
    for faster in range(1, 13):
        support = harmonic_support(x=(Wave(SWAY, PACE), Wave(0.0, faster * PACE)))
        run = rock(crate, standing(crate, 0.0), support, duration=0.2)
        assert [phase.states for phase in run.phases[:2]] == ["SS", states]
        # A root of a smooth function, from polynomials exact to 1e-13.
        assert run.phases[1].start == pytest.approx(math.asin(holds * G / (SWAY * PACE**2)) / PACE, abs=1e-10)


def test_rolling_of_the_deck_tips_with_the_moment_of_the_bodys_own_inertia() -> None:
    tall = plate(length=0.5, height=1.6, mass=1.0, friction=1.0)
    theta, pace, x, y = 0.35, 1.7, 2.0, 3.0
    rho_squared = (0.5**2 + 1.6**2) / 12.0

    def margin(t: float) -> float:
        angle, rate = theta * math.sin(pace * t), theta * pace * math.cos(pace * t)
        spin_up = -(pace**2) * angle
        cx, cy = x + 0.25, y + 0.8  # the mass centre in the deck's frame
        along = -G * math.sin(angle) + spin_up * cy + rate**2 * cx
        load = G * math.cos(angle) + spin_up * cx - rate**2 * cy
        return 0.25 * load - abs(0.8 * along + rho_squared * spin_up)

    times = np.linspace(0.0, 3.0, 3001)
    first = next(t for t in times if margin(t) < 0.0)
    onset = brentq(margin, first - 1e-3, first, xtol=1e-14)
    run = rock(tall, standing(tall, 0.0), harmonic_support(angle=(Wave(theta, pace),)).at(x, y), duration=3.0)
    assert run.phases[1].states in ("SO", "OS")
    assert run.phases[1].start == pytest.approx(onset, abs=1e-9)


def test_sliding_stops_and_starts_again_with_the_sea() -> None:
    low = plate(length=0.8, height=0.3, mass=1.0, friction=0.3)
    run = rock(low, standing(low, 0.0), harmonic_support(x=(Wave(SWAY, PACE),)), duration=70.0)
    states = [phase.states for phase in run.phases]
    assert states.count("++") > 5
    assert states.count("--") > 5
    # Once the beginning is forgotten a half wave to the right is one to the left mirrored: the crate comes back.
    period = 2.0 * math.pi / PACE
    assert run.state(25.0 * period).x == pytest.approx(run.state(30.0 * period).x, abs=1e-9)


def test_a_sampled_support_is_the_support_that_was_sampled() -> None:
    times = np.linspace(0.0, 12.0, 1201)
    deck = harmonic_support(angle=(Wave(0.2, 1.1),), x=(Wave(0.5, 0.9),), y=(Wave(0.6, 1.3),))
    moves = deck.motion(times)
    sampled = sampled_support(times, moves.angle, moves.x, moves.y)
    start = standing(CRATE, 0.1)
    one, other = rock(CRATE, start, deck, duration=2.0), rock(CRATE, start, sampled, duration=2.0)
    # Second derivatives of a quintic spline through samples 10 ms apart.
    assert other.state(0.5) == pytest.approx(one.state(0.5), abs=1e-7)


def test_a_support_at_another_point_moves_with_the_first() -> None:
    times = np.linspace(0.0, 3.0, 7)
    deck = harmonic_support(angle=(Wave(0.2, 1.1),), x=(Wave(0.5, 0.9),))
    moves, there = deck.motion(times), deck.at(2.0, -1.0).motion(times)
    assert there.x == pytest.approx(moves.x + 2.0 * np.cos(moves.angle) + np.sin(moves.angle))
    step = 1e-4
    ahead, behind = deck.at(2.0, -1.0).motion(times + step), deck.at(2.0, -1.0).motion(times - step)
    rates = {"x": "vx", "y": "vy", "vx": "ax", "vy": "ay", "angle": "rate", "rate": "acceleration"}
    for name, rate in rates.items():
        central = (getattr(ahead, name) - getattr(behind, name)) / (2.0 * step)
        assert central == pytest.approx(getattr(there, rate), abs=1e-7)  # step^2 times the third derivative


def test_what_a_body_feels_comes_from_polynomials_exact_to_rounding() -> None:
    times = np.linspace(0.0, 30.0, 997)
    for time in times:
        exact, fitted = DECK.felt_exactly(float(time)), DECK.felt(float(time))
        assert fitted == pytest.approx(exact, abs=1e-12)


def test_what_no_polynomial_fits_is_felt_as_it_is() -> None:
    """A record whose stamps jitter, up to its end where it stops; a function of one time, faster than its period."""
    rng = np.random.default_rng(1)
    times = np.cumsum(rng.uniform(0.5, 1.5, 100) / 50.0)
    angle = 0.1 * np.sin(0.8 * times) + 1e-4 * rng.standard_normal(100)
    recorded = sampled_support(times, angle, 0.5 * np.sin(0.5 * times), np.cos(0.7 * times)).at(1.0, 0.5)

    def shaken(time: float) -> SupportMotion:
        return SupportMotion(0.0, 0.0, 0.0, math.sin(9.0 * time), 0.0, 9.0 * math.cos(9.0 * time), 0.0, *(2 * [0.0]))

    for support, end in ((recorded, times[-1] + 0.2), (MovingSupport(shaken, 20.0), 5.0)):
        for time in np.linspace(0.0, end, 701).tolist():
            assert support.felt(time) == pytest.approx(support.felt_exactly(time), abs=1e-8)


def test_supports_refuse_what_they_cannot_use() -> None:
    with pytest.raises(InputError):
        MovingSupport(lambda t: SupportMotion(*[0.0 * t] * 9), period=0.0)
    with pytest.raises(InputError):
        sampled_support(range(5), [0.0] * 5, [0.0] * 5, [0.0] * 5)
    assert sampled_support(range(6), [0.0] * 6, [0.0] * 6, [0.0] * 6).gravity == 9.81
