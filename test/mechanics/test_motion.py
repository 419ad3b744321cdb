"""The next touchdown against 40-digit falls, Newton's law in the world, and what holds of every touchdown.

golden/motion.json: falls of a body that turns about a fixed point, from the energy integral in 40-digit arithmetic.
"""

from __future__ import annotations

import json
import math
import random
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from newton_in_world import HELD, Polygon, strike_by_newton
from scipy.special import ellipkinc

from impact_predictor import Contact
from impact_predictor.mechanics.motion import Fall, MotionKind, PlanarState, next_touchdown
from impact_predictor.mechanics.motion.support import FixedSupport
from impact_predictor.mechanics.types import Vector

GOLDEN = json.loads((Path(__file__).parent / "golden" / "motion.json").read_text())
ROUNDING = 1e-13
"""Some hundred roundings: what is exact but for the arithmetic."""
SLIDING = 1e-9
"""What the integration of a sliding stance is made for, in the time of the touchdown."""
MOTIONS = {"S": MotionKind.TURNING, "+": MotionKind.SLIDING, "-": MotionKind.SLIDING, "": MotionKind.FLIGHT}


class Case(NamedTuple):
    state: PlanarState
    points: tuple[Vector, ...]
    stance: int | None
    rho_squared: float
    friction: float
    gravity: Vector = (0.0, -9.81)
    horizon: float = 10.0
    tolerance: float = 1e-10

    def fall(self) -> Fall:
        return next_touchdown(*self)


def from_centre(angle: float, point: Vector) -> Vector:
    sine, cosine = math.sin(angle), math.cos(angle)
    return cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]


def standing(point: Vector, angle: float, omega: float, slip: float = 0.0, x: float = 0.0) -> PlanarState:
    """The state of a body that stands on a point and turns about it, the point slipping."""
    rx, ry = from_centre(angle, point)
    return PlanarState(x, -ry, angle, slip + omega * ry, -omega * rx, omega)


def gap(state: PlanarState, point: Vector) -> float:
    return state.y + from_centre(state.angle, point)[1]


def velocity(state: PlanarState, point: Vector) -> Vector:
    rx, ry = from_centre(state.angle, point)
    return state.vx - state.omega * ry, state.vy + state.omega * rx


def energy(state: PlanarState, rho_squared: float, gravity: Vector) -> float:
    kinetic = 0.5 * (state.vx**2 + state.vy**2 + rho_squared * state.omega**2)
    return kinetic - gravity[0] * state.x - gravity[1] * state.y


PLATE = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
RHO_SQUARED = (1.0**2 + 0.6**2) / 12.0


def drawn(rng: random.Random, kind: MotionKind) -> Case:
    """A body of two to five points and a stance on its lowest one, or thrown, over a support that slopes."""
    points = tuple(
        (radius * math.cos(bearing), radius * math.sin(bearing))
        for radius, bearing in [(rng.uniform(0.2, 0.6), rng.uniform(0, 2 * math.pi)) for _ in range(rng.randint(2, 5))]
    )
    slope, angle = rng.uniform(-0.4, 0.4), rng.uniform(-4.0, 4.0)
    gravity = 9.81 * math.sin(slope), -9.81 * math.cos(slope)
    heights = [from_centre(angle, point)[1] for point in points]
    lowest = heights.index(min(heights))
    friction = rng.choice([0.1, 0.2, 0.4, 0.8, 1.2, HELD if kind is MotionKind.TURNING else 0.6])
    rho_squared = rng.uniform(0.02, 0.2)
    if kind is MotionKind.FLIGHT:
        height = rng.uniform(0.0, 1.0) - heights[lowest]
        thrown = PlanarState(0.0, height, angle, rng.uniform(-2, 2), rng.uniform(-3, 3), rng.uniform(-30, 30))
        return Case(thrown, points, None, rho_squared, friction, gravity, 3.0)
    slip = rng.uniform(-2.0, 2.0) * rng.choice([0.01, 1.0]) if kind is MotionKind.SLIDING else 0.0
    omega = rng.uniform(-8.0, 8.0) * rng.choice([0.0, 0.1, 1.0, 1.0])
    state = standing(points[lowest], angle, omega, slip, 0.3)
    return Case(state, points, lowest, rho_squared, friction, gravity, 3.0)


@pytest.mark.parametrize("fall", GOLDEN["falls"], ids=lambda fall: f"phi0={fall['phi0']} omega0={fall['omega0']}")
def test_golden_falls_come_out_to_rounding(fall: dict[str, str]) -> None:
    a, h, rho_squared, gravity, angle, omega, time, rate = (float(value) for value in fall.values())
    points = ((-a, -h), (2.0 * a, -h))
    found = Case(standing(points[0], angle, omega), points, 0, rho_squared, HELD, (0.0, -gravity)).fall()
    assert found.time == pytest.approx(time, rel=ROUNDING)
    assert found.state.omega == pytest.approx(rate, rel=ROUNDING)
    assert (found.point, found.motion) == (1, MotionKind.TURNING)


def agrees(case: Case, max_step: float) -> list[MotionKind]:
    """Compare with Newton's law in the world; the motions on the way."""
    body = Polygon(1.0, case.rho_squared, tuple(Contact(x, y, case.friction) for x, y in case.points))
    support = FixedSupport(math.atan2(-case.gravity[0], -case.gravity[1]), math.hypot(*case.gravity))
    slip = 0.0 if case.stance is None else velocity(case.state, case.points[case.stance])[0]
    sign = "S" if abs(slip) < 1e-12 else "+" if slip > 0.0 else "-"
    states = "".join(sign if index == case.stance else "O" for index in range(len(case.points)))
    course = strike_by_newton(body, support, case.state, states, case.horizon, max_step)
    motions = [MOTIONS[states.strip("O")] for states in course.states]
    found = case.fall()
    assert found.point == course.point
    assert found.motion is motions[-1]
    if course.point >= 0:
        assert found.time == pytest.approx(course.time, rel=SLIDING)
        assert found.state == pytest.approx(course.state, rel=1e-8, abs=1e-8)  # a speed gains by the rates it has
    return motions


@pytest.mark.parametrize("kind", MotionKind, ids=lambda kind: kind.name.lower())
def test_drawn_bodies_touch_down_as_an_integration_in_the_world_frame_says(kind: MotionKind) -> None:
    rng = random.Random(8)  # the bodies drawn go through every change of motion, and none jams
    changes: set[tuple[MotionKind, MotionKind]] = set()
    for _ in range(30):
        # An event is seen only between two steps; spin makes them short.
        changes.update(pairwise(agrees(drawn(rng, kind), 0.003 if kind is MotionKind.FLIGHT else 0.01)))
    if kind is not MotionKind.FLIGHT:
        slip_starts, slip_stops = (MotionKind.TURNING, MotionKind.SLIDING), (MotionKind.SLIDING, MotionKind.TURNING)
        assert {slip_starts, slip_stops, (MotionKind.SLIDING, MotionKind.FLIGHT)} <= changes


def test_a_coarser_tolerance_keeps_itself() -> None:
    rng = random.Random(29)
    for _ in range(300):
        case = drawn(rng, MotionKind.SLIDING)
        fine, coarse = case.fall(), case._replace(tolerance=1e-6).fall()
        assert (coarse.point, coarse.motion) == (fine.point, fine.motion)
        if fine.point >= 0:
            # Aimed at 1e-6.
            assert coarse.time == pytest.approx(fine.time, rel=1e-5)
            assert math.dist(coarse.state[3:], fine.state[3:]) < 1e-5 * math.hypot(*fine.state[3:])


@pytest.mark.parametrize(("kind", "friction"), [(MotionKind.TURNING, HELD), (MotionKind.SLIDING, 0.0)])
def test_a_stance_that_sticks_and_one_without_friction_keep_the_energy(kind: MotionKind, friction: float) -> None:
    rng, allowed = random.Random(31), ROUNDING if friction else SLIDING
    touched = 0
    for _ in range(200):
        case = drawn(rng, kind)._replace(friction=friction)
        found = case.fall()
        if found.point < 0 or found.motion is MotionKind.FLIGHT:
            continue
        touched += 1
        before, after = (energy(state, case.rho_squared, case.gravity) for state in (case.state, found.state))
        assert after == pytest.approx(before, rel=allowed, abs=allowed)
        if not friction:
            vx = case.state.vx + case.gravity[0] * found.time
            assert found.state.vx == pytest.approx(vx, rel=ROUNDING, abs=ROUNDING)
    assert touched > 100


@pytest.mark.parametrize("lean", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_stance_that_slips_leaves_its_balance_as_fast_as_the_lean_grows(lean: float) -> None:
    # A needle whose foot slides without friction: its lean grows as exp(rate t) while it is small.
    needle, rate = ((0.0, -1.0), (0.3, 1.0)), math.sqrt(3 * 9.81)
    falls = [Case(standing(needle[0], -a, 0.0, 1.0), needle, 0, 1 / 3, 0.0).fall() for a in (lean, 0.1 * lean)]
    # The next terms are of the order of lean^2.
    assert falls[1].time - falls[0].time == pytest.approx(math.log(10) / rate, rel=10 * lean**2 + 10 * SLIDING)
    assert falls[1].state.omega == pytest.approx(falls[0].state.omega, rel=10 * lean**2 + SLIDING)


def test_a_slip_that_stops_for_an_instant_between_two_steps_is_seen() -> None:
    points = ((-0.17213607098819128, -0.11331649207924821), (0.014220000073014482, -0.24738588785682125))
    foot, angle = points[1], -1.9075677532500057
    state = standing(foot, angle, 0.4236022204360406)._replace(vx=0.046468952726561076)
    agrees(Case(state, points, 1, 0.04256341295719136, 0.6, (0.9898680859818764, -9.759931412277167)), 2e-4)


def test_a_slip_that_bends_both_ways_and_stops_for_an_instant_between_two_long_steps_is_seen() -> None:
    points, slope = ((-0.926, -0.123), (0.824, -0.123)), 0.24
    gravity = 9.81 * math.sin(slope), -9.81 * math.cos(slope)
    case = Case(standing(points[0], 0.13, 0.38, 0.03), points, 0, 0.326, 0.3, gravity)
    assert agrees(case, 1e-3) == [MotionKind.SLIDING, MotionKind.TURNING, MotionKind.SLIDING]
    assert case._replace(tolerance=1e-6).fall().time == pytest.approx(case.fall().time, rel=1e-6)


def test_a_stance_that_can_neither_stick_nor_be_left_slips_the_one_way_that_keeps_it_down() -> None:
    # Turning so fast that sticking would take a pull, but not so fast that the foot would rise by itself.
    for omega, friction in ((-4.9, 1.0), (-4.9, 4.0), (-5.3, 4.0)):
        for mirror in (1.0, -1.0):
            points = ((-0.25 * mirror, -0.3), (0.5 * mirror, -0.2))
            trail = agrees(Case(standing(points[0], 0.0, mirror * omega), points, 0, 0.02, friction), 1e-3)
            assert trail == [MotionKind.SLIDING]


@pytest.mark.parametrize("omega", [1e-9, 1e-7, 1e-5, 1e-3])
def test_a_rod_that_slips_and_hops_by_next_to_nothing_comes_down_when_its_mirror_image_does(omega: float) -> None:
    falls = []
    for mirror in (1.0, -1.0):
        points = ((-0.9 * mirror, 0.0), (0.8 * mirror, 0.0))
        start = standing(points[0], 0.0, mirror * omega, 0.5 * mirror)
        falls.append(Case(start, points, 0, 0.25, 0.3).fall())
    assert [fall.point for fall in falls] == [1, 1]
    assert falls[1].time == falls[0].time
    assert falls[1].state.omega == -falls[0].state.omega


@pytest.mark.parametrize("kind", MotionKind, ids=lambda kind: kind.name.lower())
@pytest.mark.parametrize(("length", "second"), [(1e-3, 1.0), (1.0, 1e4), (250.0, 0.01)])
def test_units_of_length_and_time_do_not_matter(kind: MotionKind, length: float, second: float) -> None:
    rng = random.Random(7)
    speed = length / second

    def scaled(state: PlanarState) -> PlanarState:
        x, y, angle, vx, vy, omega = state
        return PlanarState(x * length, y * length, angle, vx * speed, vy * speed, omega / second)

    for _ in range(20):
        case = drawn(rng, kind)
        other = case._replace(
            state=scaled(case.state),
            points=tuple((px * length, py * length) for px, py in case.points),
            rho_squared=case.rho_squared * length**2,
            gravity=(case.gravity[0] * speed / second, case.gravity[1] * speed / second),
            horizon=case.horizon * second,
        )
        fall, found = case.fall(), other.fall()
        assert (found.point, found.motion) == (fall.point, fall.motion)
        assert found.time == pytest.approx(fall.time * second, rel=1e-11)  # near a balance roundings grow
        if fall.point >= 0:
            expected = tuple(scaled(fall.state))
            assert found.state[2] == pytest.approx(expected[2], rel=1e-11)
            assert found.state[3:5] == pytest.approx(expected[3:5], rel=1e-10, abs=1e-10 * speed)


@pytest.mark.parametrize("kind", MotionKind, ids=lambda kind: kind.name.lower())
def test_the_point_that_strikes_is_on_the_support_and_moves_down_while_the_stance_stays(kind: MotionKind) -> None:
    rng = random.Random(11)
    for _ in range(100):
        case = drawn(rng, kind)
        found = case.fall()
        if found.point < 0:
            continue
        assert gap(found.state, case.points[found.point]) == pytest.approx(0.0, abs=ROUNDING)
        assert velocity(found.state, case.points[found.point])[1] <= 0.0
        for point in case.points:
            assert gap(found.state, point) >= -ROUNDING
        if found.motion is not MotionKind.FLIGHT:
            assert case.stance is not None
            tangential, normal = velocity(found.state, case.points[case.stance])
            assert normal == pytest.approx(0.0, abs=4e-15)
            if found.motion is MotionKind.TURNING:
                assert tangential == pytest.approx(0.0, abs=4e-15)


def passing(excess: float) -> tuple[Case, float, float, float]:
    """A plate on its corner, thrown up with this much more than the speed that brings it to its balance."""
    height = math.hypot(0.5, 0.3)
    stiffness = height * 9.81 / (RHO_SQUARED + height**2)
    lean = math.pi / 2 - math.atan2(0.3, 0.5) - 0.2
    omega = math.sqrt(4 * stiffness) * math.sin(lean / 2) * (1 + excess)
    return Case(standing(PLATE[0], 0.2, omega), PLATE, 0, RHO_SQUARED, HELD), stiffness, lean, omega


@pytest.mark.parametrize("excess", [1.0, 0.1, 1e-3, 1e-6, 1e-9])
def test_a_body_that_passes_its_balance_falls_to_the_other_side(excess: float) -> None:
    case, stiffness, lean, omega = passing(excess)
    found = case.fall()
    assert found.point == 3
    assert found.state.angle == pytest.approx(math.pi / 2, rel=ROUNDING)
    # The pendulum's time by scipy's elliptic integral, from the rate on top.
    top_squared = omega**2 - 4 * stiffness * math.sin(lean / 2) ** 2
    parameter, beyond = -4 * stiffness / top_squared, math.pi / 2 - 0.2 - lean
    half = [ellipkinc(angle / 2, parameter) for angle in (lean, beyond)]
    # The rate on top is a difference: it has the rounding of omega over the excess.
    assert found.time == pytest.approx(2 / math.sqrt(top_squared) * sum(half), rel=1e-12 + 1e-16 / excess)


@pytest.mark.parametrize("excess", [-1e-3, -1e-6, -1e-9, -1e-12])
def test_a_body_that_fails_to_reach_its_balance_falls_back(excess: float) -> None:
    case, stiffness, lean, omega = passing(excess)
    found = case.fall()
    assert found.point == 1
    assert found.state.angle == pytest.approx(0.0, abs=ROUNDING)
    assert found.state.omega == pytest.approx(
        -math.sqrt(omega**2 + 4 * stiffness * math.sin(0.1) * math.sin(lean + 0.1)), rel=1e-12
    )


def test_the_exact_speed_of_the_balance_takes_long_or_for_ever_and_never_fails() -> None:
    case, *_ = passing(0.0)
    omega = case.state.omega
    for _ in range(40):
        omega = math.nextafter(omega, 0.0)
    times = []
    for _ in range(80):
        omega = math.nextafter(omega, math.inf)
        found = case._replace(state=standing(PLATE[0], 0.2, omega), horizon=math.inf).fall()
        assert found.point in (1, 3, -1)
        times.append(found.time)
    assert min(times) > 3.0
    assert max(times) > 7.0


def test_a_balanced_body_stays_and_the_slightest_lean_makes_it_fall() -> None:
    needle = ((0.0, -1.0), (0.0, 1.0))
    for angle in (0.0, 1e-140, 1e-15, -1e-15, 1e-9):
        found = Case(standing(needle[0], angle, 0.0), needle, 0, 1 / 3, HELD, horizon=math.inf).fall()
        assert found.point == (1 if angle else -1)
        if angle:
            # From a small lean the angle grows as cosh of time, later by a time that the lean does not change.
            assert found.time == pytest.approx(math.log(1 / abs(angle)) / math.sqrt(0.75 * 9.81), abs=1.0)
            assert math.copysign(1.0, found.state.angle) == math.copysign(1.0, angle)


@pytest.mark.parametrize("lean", [1e-3, 1e-6, 1e-9, 1e-12])
def test_the_last_way_up_to_the_balance_takes_its_time_however_short_it_is(lean: float) -> None:
    needle = ((0.0, -1.0), (0.0, 1.0))
    growth = math.sqrt(0.75 * 9.81)
    rate_on_top = growth * lean
    rate = math.hypot(rate_on_top, 2 * growth * math.sin(lean / 2))
    way_up = Case(standing(needle[0], -lean, rate), needle, 0, 1 / 3, HELD, horizon=100.0).fall()
    from_top = Case(standing(needle[0], 0.0, rate_on_top), needle, 0, 1 / 3, HELD, horizon=100.0).fall()
    # For small leans the way up is asinh(1) over the rate of growth; the next term is of the order of lean^2.
    assert way_up.time - from_top.time == pytest.approx(math.asinh(1.0) / growth, rel=lean**2 + 1e-9)


def test_of_points_on_one_line_with_the_stance_the_farthest_strikes() -> None:
    for points in ((PLATE[0], (0.1, -0.3), PLATE[1]), (PLATE[0], PLATE[1], (0.1, -0.3))):
        found = Case(standing(PLATE[0], 0.4, 0.0), points, 0, RHO_SQUARED, HELD).fall()
        assert points[found.point] == PLATE[1]


def test_no_touchdown_is_told_beyond_the_horizon() -> None:
    cases = [
        Case(standing(PLATE[0], 0.4, 0.0), PLATE, 0, RHO_SQUARED, HELD),
        Case(standing(PLATE[0], 0.4, 0.0, 0.5), PLATE, 0, RHO_SQUARED, 0.2),
        Case(PlanarState(0.0, 2.0, 0.3, 1.0, 0.5, 4.0), PLATE, None, RHO_SQUARED, 0.2),
    ]
    hopper = ((0.0, -0.5), (0.2, 0.5))
    lifts = Case(standing(hopper[0], 0.9, -4.9), hopper, 0, 0.05, 0.3)
    motions = MotionKind.TURNING, MotionKind.SLIDING, MotionKind.FLIGHT, MotionKind.FLIGHT
    for case, motion in zip([*cases, lifts], motions, strict=True):
        time = case.fall().time
        assert case._replace(horizon=1.000001 * time).fall().time == pytest.approx(time, rel=SLIDING)
        assert case._replace(horizon=0.999999 * time).fall() == Fall(math.inf, -1, case.state, motion)


def test_a_body_at_rest_on_two_points_has_no_touchdown_and_one_that_approaches_has_it_now() -> None:
    for friction in (0.0, 0.5, HELD):
        assert Case(standing(PLATE[0], 0.0, 0.0), PLATE, 0, RHO_SQUARED, friction).fall().point == -1
        assert Case(standing(PLATE[1], 0.0, 0.0), PLATE, 1, RHO_SQUARED, friction).fall().point == -1
        for slip in (0.0, 0.3):
            found = Case(standing(PLATE[0], 0.0, -1e-3, slip), PLATE, 0, RHO_SQUARED, friction).fall()
            assert (found.time, found.point) == (0.0, 1)
    # It slides flat on both points until it stops.
    assert Case(standing(PLATE[0], 0.0, 0.0, 0.3), PLATE, 0, RHO_SQUARED, 0.5).fall().point == -1


def test_a_rounding_beside_the_support_is_no_touchdown_of_a_body_at_rest() -> None:
    for angle in (2e-16, -2e-16, 6e-16):
        assert Case(standing(PLATE[0], angle, 0.0), PLATE, 0, RHO_SQUARED, HELD).fall().point == -1
    low = math.radians(720.0)
    assert Case(standing(PLATE[0], low, 0.0), PLATE, 0, RHO_SQUARED, HELD).fall().point == -1


def test_a_point_below_the_support_strikes_when_it_moves_down_and_not_before_it_has_risen() -> None:
    sunk = standing(PLATE[0], -1e-3, -0.2)
    assert Case(sunk, PLATE, 0, RHO_SQUARED, HELD).fall()[:2] == (0.0, 1)
    rising = Case(standing(PLATE[0], -1e-3, 0.2), PLATE, 0, RHO_SQUARED, HELD).fall()
    assert rising.point == 1
    assert rising.state.angle == pytest.approx(0.0, abs=ROUNDING)
    height, speed = 0.3 - 1e-3, 0.5
    thrown = PlanarState(0.0, height, 0.0, 0.0, speed, 0.0)
    flying = Case(thrown, PLATE, None, RHO_SQUARED, HELD).fall()
    # It rises through the support and comes back to it.
    assert flying.time == pytest.approx((speed + math.sqrt(speed**2 - 2 * 9.81 * 1e-3)) / 9.81, rel=1e-12)
    falling = Case(thrown._replace(vy=-speed), PLATE, None, RHO_SQUARED, HELD).fall()
    assert (falling.time, falling.point) == (0.0, 0)


def test_flight_without_spin_is_free_fall() -> None:
    angle = 0.3
    lowest = from_centre(angle, PLATE[0])[1]
    for vy, height in ((0.0, 1.0), (2.0, 0.0), (-1.0, 1e-6), (3.0, 1e5)):
        found = Case(PlanarState(0.0, height - lowest, angle, 1.0, vy, 0.0), PLATE, None, 1.0, 0.0, horizon=1e4).fall()
        assert found.point == 0
        assert found.time == pytest.approx((vy + math.sqrt(vy**2 + 2 * 9.81 * height)) / 9.81, rel=1e-9)
        assert found.state.x == pytest.approx(found.time, rel=ROUNDING)


def test_a_fast_spinning_body_strikes_with_the_first_dip_however_short() -> None:
    rng = random.Random(17)
    for _ in range(10):
        omega, rise, height = rng.uniform(100.0, 2000.0), rng.uniform(-0.3, 0.3), rng.uniform(0.5, 0.6)
        rod = ((-0.5, 0.0), (0.5, 0.0))
        state = PlanarState(0.0, height, rng.uniform(0.0, 3.0), 0.0, rise, omega)
        found = Case(state, rod, None, 1 / 12, 0.0).fall()
        times = np.linspace(0.0, 0.5, 1_000_001)
        reach = 0.5 * np.abs(np.sin(state.angle + omega * times))
        below = height + rise * times - 4.905 * times**2 < reach
        first = times[np.argmax(below)] if below.any() else math.inf
        assert found.time == pytest.approx(first, abs=times[1])


def test_a_body_that_spins_fast_and_falls_far_strikes_within_half_a_turn_of_being_as_near_as_it_is_long() -> None:
    rod = ((-0.5, 0.0), (0.5, 0.0))
    for height, omega in ((10.0, 1e3), (1e4, 1e5), (1e6, 1e6)):
        found = Case(PlanarState(0.0, height, 0.3, 0.0, 0.0, omega), rod, None, 1 / 12, 0.0, horizon=math.inf).fall()
        near = math.sqrt((height - 0.5) / 4.905)
        assert near * (1 - 1e-12) <= found.time <= (near + math.pi / omega) * (1 + 1e-12)
    # Here the spin is too fast for the rounding of the time; it still comes down.
    vy, omega, pull = 12708390.2454907, 10857.480090298392, 1.0598201754900908e-05
    rod = ((4376.709455235796, -6795.448147405907), (-4376.709455235796, 6795.448147405907))
    thrown = PlanarState(0.0, -rod[0][1], 0.0, 0.0, vy, omega)
    found = Case(thrown, rod, None, 1.0, 0.0, (0.0, -pull), math.inf).fall()
    assert found.time == pytest.approx(2 * vy / pull, rel=1e-6)


def test_a_slip_of_one_rounding_is_none() -> None:
    state = standing(PLATE[0], 0.4, -1.0)
    sticking = Case(state, PLATE, 0, RHO_SQUARED, 1.5).fall()
    assert sticking.motion is MotionKind.TURNING
    nudged = Case(state._replace(vx=math.nextafter(state.vx, 1.0)), PLATE, 0, RHO_SQUARED, 1.5).fall()
    assert nudged == sticking


def test_a_foot_that_slips_while_nothing_turns_the_body_stops_after_the_time_of_a_block() -> None:
    friction, slip = 0.5, -0.3
    points = ((-0.25, -0.5), (2.0, -0.5 + 2**-40))  # the reaction of the slipping foot points at the mass centre
    found = Case(standing(points[0], 0.0, 0.0, slip), points, 0, 0.1, friction).fall()
    stopped = Case(standing(points[0], 0.0, 0.0), points, 0, 0.1, friction).fall()
    assert found.point == stopped.point == 1
    assert found.time - stopped.time == pytest.approx(0.3 / (friction * 9.81), rel=1e-9)
    assert stopped.state.x - found.state.x == pytest.approx(0.3**2 / (2 * friction * 9.81), rel=1e-9)
    assert Case(standing(points[0], 0.0, 0.0, slip), points, 0, 0.1, friction, horizon=0.01).fall().point == -1


def test_gap_and_normal_velocity_of_the_stance_are_dropped() -> None:
    exact = standing(PLATE[0], 0.4, -0.5)
    measured = exact._replace(y=exact.y + 1e-3, vy=exact.vy + 0.02)
    falls = [Case(state, PLATE, 0, RHO_SQUARED, 1.5).fall() for state in (exact, measured)]
    assert falls[0] == falls[1]


@pytest.mark.parametrize("slip", [0.0, 0.7])
def test_a_stance_that_would_have_to_pull_is_left(slip: float) -> None:
    state = standing(PLATE[0], 0.5, -30.0, slip)
    found = Case(state, PLATE, 0, RHO_SQUARED, 0.5).fall()
    flying = Case(state, PLATE, None, RHO_SQUARED, 0.5).fall()
    assert found == flying
    assert found.motion is MotionKind.FLIGHT
    assert Case(state, PLATE, 0, RHO_SQUARED, HELD).fall().motion is MotionKind.TURNING


def test_a_jammed_slip_stops_at_once_and_the_body_turns_on() -> None:
    rod = ((-0.5, -0.5), (0.5, -0.5))
    rho_squared, friction = 0.02, 3.0
    # Painleve: the slip pushes the foot into the support, rho^2 + dx^2 < friction dx dy.
    state = standing(rod[0], 0.1, 0.0, -2.0)
    found = Case(state, rod, 0, rho_squared, friction).fall()
    dx, dy = from_centre(0.1, (0.5, 0.5))
    omega = 2.0 * dy / (rho_squared + dx * dx + dy * dy)
    assert found == Case(standing(rod[0], 0.1, omega, x=state.x), rod, 0, rho_squared, friction).fall()
    assert energy(found.state, rho_squared, (0.0, -9.81)) < energy(state, rho_squared, (0.0, -9.81))


def test_extremes_give_numbers() -> None:
    rng = random.Random(19)

    def magnitude(low: float, high: float) -> float:
        return float(rng.choice([-1, 1]) * 10 ** rng.uniform(low, high))

    ends = set()
    for _ in range(1500):
        length = abs(magnitude(-6, 6))
        points = tuple((rng.uniform(-length, length), rng.uniform(-length, length)) for _ in range(rng.randint(1, 4)))
        angle = rng.choice([0.0, math.pi / 2, rng.uniform(-7.0, 7.0), magnitude(-18, 3)])
        omega = rng.choice([0.0, magnitude(-9, 6)])
        foot = rng.randrange(len(points))
        state = standing(points[foot], angle, omega, rng.choice([0.0, magnitude(-9, 6)]))
        gravity = rng.choice([(0.0, -9.81), (magnitude(-6, 1), -abs(magnitude(-6, 4))), (0.0, 0.0), (3.0, 5.0)])
        stance = rng.choice([foot, None])
        friction = rng.choice([0.0, abs(magnitude(-6, 6)), HELD])
        horizon = rng.choice([10.0, 0.01, math.inf])
        found = Case(state, points, stance, length**2 * abs(magnitude(-6, 2)), friction, gravity, horizon).fall()
        assert found.time >= 0.0
        assert all(map(math.isfinite, found.state))
        assert (found.point >= 0) == (found.time <= horizon and found.time < math.inf)
        ends.add((found.motion, found.point >= 0))
    assert len(ends) == 6


def test_a_stance_that_slips_towards_a_pole_of_its_acceleration_has_an_answer():
    # Found by drawing at random: the midpoint rule's substeps overflow on the way to a jam.
    state = PlanarState(
        -0.13584663077251424,
        0.3634949098923138,
        1.0020691939681101,
        0.2716932615450285,
        -0.0890451346299408,
        -2.0041383879362202,
    )
    points = (-0.005943468502318652, -0.3189723425773434), (0.1370640837641705, -0.41914710518108506)
    gravity = (-6.123233995736766e-16, -9.809999999999999)
    fall = next_touchdown(state, points, 0, 1.1948580678431976e-05, 0.2, gravity, 0.75, 1e-6)
    assert fall.time >= 0.0
    assert all(map(math.isfinite, fall.state))
