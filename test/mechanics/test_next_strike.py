"""The next strike over a moving support: against Newton's law in the world's axes, against `rock`, and its edges."""

from __future__ import annotations

import math
import random
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from newton_in_world import DECK, SMOOTH, accelerated, strike_by_newton

from impact_predictor import InputError, TwoPointBody, cylinder, plate
from impact_predictor.mechanics.motion import Fall, MotionKind, PlanarState, next_strike, next_touchdown, rock, standing
from impact_predictor.mechanics.motion.support import FixedSupport, MovingSupport

G = 9.81
AGREES = 1e-9
"""The tolerance of `next_strike`; what is left of its errors is smaller, and the reference's are below 1e-11."""

CRATE = plate(length=0.8, height=1.0, mass=50.0, friction=0.8)
DRUM = cylinder(radius=0.3, gamma=0.5, gamma_new=0.7, mass=40.0, friction=0.5)


CONSTANT = accelerated(1.1, -0.8, turning=0.7, angle=0.1, rate=0.3, vy=0.4).at(2.0, -1.5)
SUPPORTS = {"constant": CONSTANT, "harmonic": DECK}


class Told:
    """What is felt on a support, told by a plain function of time."""

    def __init__(self, support: MovingSupport | FixedSupport, period: float = math.inf) -> None:
        self.felt = support.felt if isinstance(support, FixedSupport) else support.felt_exactly
        self.gravity, self.period = support.gravity, period


CASES = {
    "sticks": (CRATE, standing(CRATE, 0.2, -0.7), ["SO"], {"constant", "harmonic"}),
    "sticks on contact 1": (CRATE, standing(CRATE, -0.1, 0.5), ["OS"], {"constant", "harmonic"}),
    "slips": (SMOOTH, standing(SMOOTH, 0.15, -1.2, 0.9), ["+O"], {"constant", "harmonic"}),
    "slips backwards": (SMOOTH, standing(SMOOTH, 0.15, -0.4, -0.3), ["-O"], {"constant", "harmonic"}),
    "sticks after it slipped": (CRATE, standing(CRATE, 0.22, 0.0, 0.6), ["+O", "SO"], {"constant", "harmonic"}),
    "slips after it stuck": (CRATE, standing(CRATE, 0.437, -3.335), ["SO", "+O"], {"harmonic"}),
    "reverses its slip": (SMOOTH, standing(SMOOTH, 0.333, -1.337, 0.738), ["+O", "-O"], {"constant"}),
    "lifts off": (SMOOTH, standing(SMOOTH, 0.454, -3.64), ["+O", "OO"], {"harmonic"}),
    "sticks, slips and lifts off": (CRATE, standing(CRATE, 0.495, -3.638), ["SO", "+O", "OO"], {"harmonic"}),
    "lifts off under constant acceleration": (SMOOTH, standing(SMOOTH, 0.456, 0.835), ["-O", "OO"], {"constant"}),
    "flies": (CRATE, standing(CRATE, 0.1, -1.0)._replace(vx=0.4, vy=0.8), ["OO"], {"constant", "harmonic"}),
    "drum rolls": (DRUM, standing(DRUM, 0.147, -0.376), ["SO"], {"constant", "harmonic"}),
    "drum rolls back": (DRUM, standing(DRUM, -0.08, 0.5), ["OS", "O-"], {"constant", "harmonic"}),
    "drum spins": (DRUM, standing(DRUM, 0.264, -3.7, 1.5), ["+O"], {"constant", "harmonic"}),
    "drum spins and rolls": (DRUM, standing(DRUM, 0.376, -1.0, -0.6), ["-O", "SO"], {"constant", "harmonic"}),
    "drum leaves its edge": (DRUM, standing(DRUM, 0.223, -5.073), ["+O", "OO"], {"harmonic"}),
}
MOTIONS = {"S": MotionKind.TURNING, "+": MotionKind.SLIDING, "-": MotionKind.SLIDING, "O": MotionKind.FLIGHT}


@pytest.mark.parametrize(
    ("name", "moves"), [(name, moves) for name, case in CASES.items() for moves in sorted(case[3])]
)
def test_the_next_strike_is_newtons_in_the_world(name: str, moves: str) -> None:
    body, start, states, _ = CASES[name]
    support = SUPPORTS[moves]
    old = None if states[0] == "OO" else states[0].index("O") ^ 1
    fall = next_strike(body, start, old, Told(support), 1.2)
    assert fall is not None
    course = strike_by_newton(body, support, start, states[0], 1.1 * fall.time + 0.02)
    assert course.states == states
    assert fall.point == course.point
    assert fall.time == pytest.approx(course.time, abs=AGREES)
    assert fall.state == pytest.approx(course.state, rel=AGREES, abs=AGREES)
    assert fall.motion is MOTIONS[states[-1].replace("O", "") or "O"]


def random_start(draw: random.Random, body: TwoPointBody) -> tuple[PlanarState, int | None]:
    angle, omega = draw.uniform(-0.4, 0.4), draw.uniform(-3.0, 3.0)
    state = standing(body, angle, omega, draw.choice([0.0, draw.uniform(-1.0, 1.0)]))
    if draw.random() < 0.3:
        return state._replace(y=state.y + 0.1, vx=draw.uniform(-0.5, 0.5), vy=draw.uniform(0.0, 1.0)), None
    return state, 0 if angle > 0.0 else 1


@pytest.mark.parametrize("support", [*SUPPORTS.values(), FixedSupport(0.05)], ids=[*SUPPORTS, "fixed"])
@pytest.mark.parametrize("body", [CRATE, SMOOTH, DRUM], ids=["crate", "smooth", "drum"])
def test_the_next_strike_is_the_first_impact_of_a_run(body: TwoPointBody, support: Any) -> None:
    draw, struck = random.Random(7), 0
    for _ in range(25):
        start, old = random_start(draw, body)
        run = rock(body, start, support, duration=1.0, max_events=50)
        fall = next_strike(body, start, old, support, 1.0, 1e-11)
        first = run.impacts[0] if run.impacts else None
        assert (fall is None) == (first is None)
        if fall is None or first is None:
            continue
        struck += 1
        assert fall.point == first.new
        # Both follow the motion in the same way, to 1e-11 of what happens in a step; grazes amplify what is left.
        assert fall.time == pytest.approx(first.time, abs=1e-9)
        assert fall.state == pytest.approx(first.before, rel=1e-8, abs=1e-8)
    assert struck >= 15


def later(support: Any, time: float) -> Any:
    """The support as it is seen from a later time on."""
    if isinstance(support, FixedSupport):
        return support
    return MovingSupport(lambda t: support.function(t + time), support.period, support.gravity, support.origin)


@pytest.mark.parametrize("support", [*SUPPORTS.values(), FixedSupport(0.05)], ids=[*SUPPORTS, "fixed"])
@pytest.mark.parametrize("body", [CRATE, SMOOTH, DRUM], ids=["crate", "smooth", "drum"])
def test_a_motion_that_is_followed_anew_from_a_state_on_the_way_comes_to_the_same_strike(
    body: TwoPointBody, support: Any
) -> None:
    draw, struck = random.Random(11), 0
    for _ in range(25):
        start, old = random_start(draw, body)
        fall = next_strike(body, start, old, support, 1.0)
        if fall is None:
            continue
        struck += 1
        time = draw.uniform(0.0, fall.time)
        run = rock(body, start, support, duration=1.0, max_events=50)
        states = run.states(time)
        stands = None if states == "OO" else states.index("O") ^ 1
        anew = next_strike(body, run.state(time), stands, later(support, time), 1.0)
        assert anew is not None
        assert anew.point == fall.point
        assert time + anew.time == pytest.approx(fall.time, abs=1e-7)
        assert anew.state == pytest.approx(fall.state, abs=1e-6)
    assert struck > 10


@pytest.mark.parametrize("old", [0, 1])
@pytest.mark.parametrize("tilt", [1e-9, 0.2])
def test_a_measured_gap_and_normal_velocity_of_the_standing_contact_are_dropped(old: int, tilt: float) -> None:
    side = 1.0 if old == 0 else -1.0
    start = standing(CRATE, side * tilt, side * 0.3)
    wanted = next_strike(CRATE, start, old, Told(CONSTANT), 1.0)
    for gap, speed in ((1e-3, 0.05), (-1e-3, -0.05), (1e-3, -0.05)):
        measured = start._replace(y=start.y + gap, vy=start.vy + speed)
        assert next_strike(CRATE, measured, old, Told(CONSTANT), 1.0) == wanted
    assert wanted is not None
    assert wanted.point == 1 - old


@pytest.mark.parametrize("old", [0, 1])
def test_a_drum_measured_off_its_edge_or_into_it_rolls_on_the_edge(old: int) -> None:
    side = 1.0 if old == 0 else -1.0
    start = standing(DRUM, side * 0.2, -side * 0.3)
    edge = (0.0, 0.0) if old == 0 else (DRUM.new.x - DRUM.old.x, DRUM.new.y - DRUM.old.y)
    out = np.array([start.x - edge[0], start.y - edge[1]]) / 0.3
    wanted = next_strike(DRUM, start, old, Told(CONSTANT), 1.0)
    for part in (1e-4, -1e-4):
        gap, speed = 0.3 * part * out, 0.05 * out * math.copysign(1.0, part)
        # Farther out the axis moves faster at the same rate about the edge.
        measured = PlanarState(
            start.x + gap[0],
            start.y + gap[1],
            start.angle,
            start.vx * (1.0 + part) + speed[0],
            start.vy * (1.0 + part) + speed[1],
            start.omega,
        )
        fall = next_strike(DRUM, measured, old, Told(CONSTANT), 1.0)
        assert fall is not None
        assert wanted is not None
        assert (fall.time, *fall.state) == pytest.approx((wanted.time, *wanted.state), abs=1e-9)


@pytest.mark.parametrize("steps", [False, True], ids=["closed form", "stepped"])
@pytest.mark.parametrize(("friction", "angle", "slip"), [(0.8, 0.2, 0.0), (0.1, 0.3, 0.4), (0.3, 0.1, -0.2)])
def test_over_a_support_that_does_not_move_it_is_the_next_touchdown(
    friction: float, angle: float, slip: float, steps: bool
) -> None:
    slope = FixedSupport(0.1)
    body = plate(length=0.8, height=1.0, mass=50.0, friction=friction)
    points = ((-0.4, -0.5), (0.4, -0.5))
    start = standing(body, angle, 0.1, slip)
    touchdown = next_touchdown(start, points, 0, body.inertia / body.mass, friction, slope.felt(0.0)[:2], 1.0)
    fall = next_strike(body, start, 0, Told(slope) if steps else slope, 1.0)
    assert fall is not None
    assert fall.motion is touchdown.motion
    assert (fall.time, *fall.state) == pytest.approx((touchdown.time, *touchdown.state), abs=1e-8)


@pytest.mark.parametrize("angle", [0.0, -1e-3])
def test_a_contact_on_the_support_or_below_it_strikes_at_once_when_it_moves_down(angle: float) -> None:
    start = standing(CRATE, -angle, -0.5)  # turned about contact 0, so that contact 1 may be below
    fall = next_strike(CRATE, start._replace(angle=angle), 0, Told(CONSTANT), 1.0)
    assert fall is not None
    assert (fall.time, fall.point, fall.state.angle) == (0.0, 1, 0.0)
    assert fall.state.omega == -0.5


@pytest.mark.parametrize("angle", [0.0, -1e-3])
def test_a_contact_on_the_support_or_below_it_that_rises_strikes_after_it_has_risen(angle: float) -> None:
    fall = next_strike(CRATE, standing(CRATE, 0.0, 0.5)._replace(angle=angle), 0, Told(CONSTANT), 1.0)
    assert fall is not None
    assert fall.time > 0.1
    assert fall.state.omega < -0.3


def test_in_flight_a_contact_below_the_support_strikes_at_once_when_it_moves_down_and_later_when_it_rises() -> None:
    start = standing(CRATE, 0.05)
    falls = start._replace(y=start.y - 1e-3, vy=-0.2)
    fall = next_strike(CRATE, falls, None, Told(CONSTANT), 1.0)
    assert fall == Fall(0.0, 0, falls, MotionKind.FLIGHT)
    rises = next_strike(CRATE, falls._replace(vy=0.6), None, Told(CONSTANT), 1.0)
    assert rises is not None
    assert rises.time > 0.05
    assert rises.motion is MotionKind.FLIGHT


def test_of_two_contacts_below_the_support_the_faster_one_strikes() -> None:
    for omega, point in ((0.3, 0), (-0.3, 1)):
        start = standing(CRATE, 0.0)._replace(vy=-0.5, omega=omega)
        fall = next_strike(CRATE, start._replace(y=start.y - 1e-3), None, Told(CONSTANT), 1.0)
        assert fall is not None
        assert (fall.time, fall.point) == (0.0, point)


@pytest.mark.parametrize("support", [Told(CONSTANT), FixedSupport()], ids=["moving", "fixed"])
def test_a_body_that_has_overturned_is_not_followed_even_as_it_falls_back(support: Any) -> None:
    assert next_strike(CRATE, standing(CRATE, 1.5, -4.0), 0, support, 2.0) is not None
    assert next_strike(CRATE, standing(CRATE, 1.6, -4.0), 0, support, 2.0) is None


def test_what_does_not_strike_within_the_duration_has_no_next_strike() -> None:
    for start, old in (
        (standing(CRATE, 0.0), 0),  # rests on both contacts
        (standing(CRATE, 0.5, 1.5), 0),  # overturns
        (standing(CRATE, 1.6), 0),  # has overturned
        (standing(CRATE, 0.3, 0.5), 0),  # takes longer
        (standing(CRATE, 0.3)._replace(vy=3.0), None),  # flies longer
    ):
        assert next_strike(CRATE, start, old, Told(CONSTANT), 0.1) is None


@pytest.mark.parametrize("wrong", [math.nan, math.inf, 1e300])
def test_numbers_that_cannot_be_followed_have_no_next_strike(wrong: float) -> None:
    start = standing(CRATE, 0.2)
    for name in start._fields:
        for old in (0, None):
            fall = next_strike(CRATE, start._replace(**{name: wrong}), old, Told(CONSTANT), 1.0)
            assert fall is None or math.isfinite(sum(fall.state))


@pytest.mark.parametrize("turns", [-2, 1])
def test_a_body_that_has_turned_around_strikes_as_one_that_has_not(turns: int) -> None:
    start = standing(CRATE, 0.2)
    shift = 2.0 * math.pi * turns
    one, other = (
        next_strike(CRATE, start._replace(angle=start.angle + by), 0, Told(CONSTANT), 1.0) for by in (0.0, shift)
    )
    assert one is not None
    assert other is not None
    assert other.state == pytest.approx(one.state._replace(angle=one.state.angle + shift), abs=1e-12)


def test_a_body_of_neither_shape_is_refused() -> None:
    with pytest.raises(InputError):
        next_strike(CRATE._replace(old=None), standing(CRATE, 0.1), 0, Told(CONSTANT), 1.0)


def test_the_next_strike_needs_no_numpy() -> None:
    code = """
import math, sys
from impact_predictor import plate
from impact_predictor.mechanics.motion import next_strike, standing
class Support:
    period, gravity = math.inf, 9.81
    def felt(self, time):
        return 0.3 + 0.4 * time, -9.7 + 0.3 * time * time, 0.05 + 0.1 * time, 0.1
body = plate(length=0.6, height=1.2, mass=500.0, friction=0.3)
for start, old in ((standing(body, 0.1), 0), (standing(body, 0.1, slip=0.5), 0), (standing(body, 0.0, slip=1.0), 0),
                   (standing(body, 0.1)._replace(vy=1.0), None)):
    next_strike(body, start, old, Support(), 1.0)
assert "numpy" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("stance", [None, 0])
@pytest.mark.parametrize("omega", [0.0, -0.5])
def test_numbers_of_numpy_are_numbers(stance: int | None, omega: float) -> None:
    state, points = PlanarState(0.0, 0.5, 0.02, 0.3, 0.0, omega), ((-0.4, -0.5), (0.4, -0.5))
    here = next_touchdown(state, points, stance, 0.1, 0.3)
    as_numpy = PlanarState(*map(np.float64, state)), tuple((np.float64(x), np.float64(y)) for x, y in points)
    there = next_touchdown(*as_numpy, stance, np.float64(0.1), np.float64(0.3))
    assert (there.time, there.point) == (here.time, here.point)
    assert here.point >= 0
