"""The next touchdown in three dimensions: against closed forms, Newton's and Euler's laws, and the planar engine.

golden/motion.json: falls of a body that turns about a fixed point, from the energy integral in 40-digit arithmetic.
"""

from __future__ import annotations

import json
import math
import random
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from newton_in_space import Newton, numbers_of, tensor
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.compiled import without_numba
from impact_predictor.mechanics.motion import Fall, PlanarState, next_touchdown, spatial, spatial_problem
from impact_predictor.mechanics.motion.spatial import Pull, SpatialFall, SpatialState, fall
from impact_predictor.native import as_python

PYTHON = as_python("mechanics.motion.spatial_problem")
crossing = as_python("mechanics.motion.falling").crossing
GOLDEN = json.loads((Path(__file__).parent / "golden" / "motion.json").read_text())
TIME, TWIST = 1e-6, 1e-5
"""What a touchdown is right to, relative to the scales of the motion: the method's tolerance over some ten steps."""
EDGE = 0.1
CUBE = tuple((x, y, z) for x, y, z in product((-0.5 * EDGE, 0.5 * EDGE), repeat=3))
ALIKE = (EDGE * EDGE / 6.0,) * 3 + (0.0,) * 3
GENERAL = tuple(ALIKE[0] * part for part in (1.0, 1.2, 1.4, 0.05, 0.02, -0.1))
DECK = Pull(gravity=(0.5, -0.3, -9.0), growth=(1.0, 0.5, -2.0), spin=(0.2, -0.1, 0.3), turning=(0.3, 0.2, -0.4))
FLAT = (0.0, 0.0, 0.0, 1.0)


def in_flight(draw: random.Random) -> SpatialState:
    v = draw.gauss(0.0, 1.0), draw.gauss(0.0, 1.0), draw.uniform(-1.0, 0.5)
    return SpatialState((0.0, 0.0, draw.uniform(0.1, 0.2)), quaternion(draw), v, vector(draw, 6.0))


def on_corner(draw: random.Random, slip: float) -> tuple[SpatialState, int]:
    """A cube on its lowest corner."""
    pose, w = quaternion(draw), vector(draw, 4.0)
    corners = Rotation.from_quat(pose).apply(CUBE)
    lowest = int(corners[:, 2].argmin())
    v = -np.cross(w, corners[lowest]) + [draw.gauss(0.0, slip), draw.gauss(0.0, slip), 0.0]
    return SpatialState((0.3, -0.2, -corners[lowest, 2]), pose, tuple(v), w), lowest


def nearly_flat(draw: random.Random) -> tuple[SpatialState, list[int]]:
    """A cube on some corners of a face that hardly leans and hardly lifts, but slips and turns on the support."""
    lean, spin = 10.0 ** draw.uniform(-9.0, 0.0), 10.0 ** draw.uniform(-8.0, 0.7)
    pose = draw.gauss(0.0, lean), draw.choice([0.0, draw.gauss(0.0, lean)]), draw.gauss(0.0, 1.0), 1.0
    heights = Rotation.from_quat(pose).apply(CUBE)[:, 2]
    standing = [int(i) for i in heights.argsort()[: draw.choice([1, 2, 3, 4])]]
    slip = 10.0 ** draw.uniform(-8.0, 0.3)
    v = draw.gauss(0.0, slip), draw.gauss(0.0, slip), draw.gauss(0.0, slip)
    lifts = draw.choice([0.0, spin])
    w = draw.gauss(0.0, lifts), draw.gauss(0.0, lifts), draw.gauss(0.0, spin)
    return SpatialState((0.0, 0.0, -float(heights.min())), pose, v, w), standing


def quaternion(draw: random.Random) -> tuple[float, float, float, float]:
    return draw.gauss(0.0, 1.0), draw.gauss(0.0, 1.0), draw.gauss(0.0, 1.0), draw.gauss(0.0, 1.0)


def vector(draw: random.Random, size: float) -> tuple[float, float, float]:
    return draw.gauss(0.0, size), draw.gauss(0.0, size), draw.gauss(0.0, size)


def assert_agrees(found: SpatialFall, point: int, time: float, state: Any) -> None:
    speed = 1.0 + float(np.linalg.norm(state[7:10]))
    assert found.point == point
    assert found.time == pytest.approx(time, abs=TIME)
    ours = numbers_of(found.state)
    ours[3:7] *= np.sign(ours[3:7] @ state[3:7])
    state[3:7] /= np.linalg.norm(state[3:7])
    assert ours[:7] == pytest.approx(state[:7], abs=5.0 * TIME)
    assert ours[7:10] == pytest.approx(state[7:10], abs=TWIST * speed)
    assert EDGE * ours[10:] == pytest.approx(EDGE * state[10:], abs=TWIST * speed)
    assert min(found.gaps) > -1e-8 * EDGE or found.standing
    assert found.gaps[found.point] == pytest.approx(0.0, abs=1e-12)
    assert [found.gaps[i] for i in found.standing] == pytest.approx([0.0] * len(found.standing), abs=EDGE * TIME)


def test_a_free_body_alike_about_all_axes_keeps_its_twist_but_for_gravity() -> None:
    draw = random.Random(1)
    for _ in range(100):
        start = in_flight(draw)
        found = fall(start, ALIKE, CUBE)
        t = found.time
        turned = Rotation.from_rotvec(np.array(start.angular_velocity) * t) * Rotation.from_quat(start.orientation)
        x, v = np.array(start.position), np.array(start.velocity)
        g = np.array([0.0, 0.0, -9.81])
        end = np.concatenate([x + (v + 0.5 * g * t) * t, turned.as_quat(), v + g * t, start.angular_velocity])
        gaps = end[2] + turned.apply(CUBE)[:, 2]
        assert_agrees(found, int(gaps.argmin()), t, end)
        assert min(gaps) == pytest.approx(0.0, abs=EDGE * TIME)
        before = np.linspace(0.0, t, 200)[1:-1]
        turns = Rotation.from_rotvec(np.outer(before, start.angular_velocity)) * Rotation.from_quat(start.orientation)
        lows = (turns.as_matrix()[:, 2] @ np.transpose(CUBE)).min(axis=1)
        assert (x[2] + (v[2] + 0.5 * g[2] * before) * before + lows).min() > 0.0


@pytest.mark.parametrize("pull", [Pull(), DECK], ids=["fixed", "deck"])
@pytest.mark.parametrize("inertia", [ALIKE, GENERAL], ids=["alike", "general"])
def test_free_bodies_touch_down_by_eulers_equations(inertia: tuple[float, ...], pull: Pull) -> None:
    draw = random.Random(2)
    for _ in range(10):
        start = in_flight(draw)
        course = Newton(inertia, CUBE, {}, 0.0, pull).strike(start, 1.0)
        assert_agrees(fall(start, inertia, CUBE, (), 0.0, pull), course.point, course.time, course.state)


def test_a_body_that_flips_over_keeps_energy_and_angular_momentum() -> None:
    inertia = tuple(ALIKE[0] * part for part in (0.6, 1.0, 1.4, 0.0, 0.0, 0.0))
    start = SpatialState((0.0, 0.0, 10.0), FLAT, (0.0, 0.0, -1.0), (1e-2, 15.0, 1e-2))
    found = fall(start, inertia, CUBE, horizon=10.0)
    parts = []
    for state in (start, found.state):
        turn = Rotation.from_quat(state.orientation).as_matrix()
        momentum = turn @ tensor(inertia) @ turn.T @ state.angular_velocity
        parts.append([*momentum, momentum @ state.angular_velocity / 2.0])
    assert abs(turn[1, 1]) < 0.9 or turn[1, 1] < 0.0  # it has left its unstable axis
    assert parts[1] == pytest.approx(parts[0], rel=1e-4, abs=1e-4 * max(parts[0]))


@pytest.mark.parametrize("pull", [Pull(), DECK], ids=["fixed", "deck"])
@pytest.mark.parametrize("inertia", [ALIKE, GENERAL], ids=["alike", "general"])
@pytest.mark.parametrize(("friction", "slip"), [(3.0, 0.0), (0.2, 1.0)], ids=["sticks", "slips"])
def test_a_body_on_one_corner_turns_about_it_or_slips_on_it(
    friction: float, slip: float, inertia: tuple[float, ...], pull: Pull
) -> None:
    draw, compared = random.Random(3), 0
    while compared < 5:
        start, corner = on_corner(draw, slip)
        newton = Newton(inertia, CUBE, {corner: "+" if slip else "S"}, friction, pull)
        if (
            slip
            and np.hypot(
                *(
                    np.cross(start.angular_velocity, Rotation.from_quat(start.orientation).apply(CUBE[corner]))
                    + start.velocity
                )[:2]
            )
            < 0.7
        ):
            continue  # its slip may stop on the way
        course = newton.strike(start, 0.25)
        if course.margin < 0.0 or course.point < 0:
            continue
        compared += 1
        found = fall(start, inertia, CUBE, (corner,), friction, pull)
        assert_agrees(found, course.point, course.time, course.state)
        assert found.standing == (corner,)


def planar(draw: random.Random, friction: float) -> tuple[Fall, SpatialState, tuple[Any, ...]]:
    """A body on its edge, and its touchdown by the planar engine."""
    a, h, angle, omega = 0.05, draw.uniform(0.02, 0.08), draw.uniform(0.02, 0.75), draw.uniform(-6.0, 2.0)
    slip = draw.choice([0.0, draw.uniform(-1.0, 1.0)])
    corners = ((-a, -h), (a, -h), (a, h), (-a, h))
    c, s = math.cos(angle), math.sin(angle)
    x, y = c * a - s * h, s * a + c * h
    start = PlanarState(x=x, y=y, angle=angle, vx=slip - omega * y, vy=omega * x, omega=omega)
    found = next_touchdown(start, corners, 0, ALIKE[0], friction, (0.0, -9.81), 0.4)
    pose = (0.0, -math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle))
    state = SpatialState((x, 0.0, y), pose, (start.vx, 0.0, start.vy), (0.0, -omega, 0.0))
    return found, state, tuple((x, depth, z) for depth in (-0.05, 0.05) for x, z in corners)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.18, 0.5, 1.0])
def test_a_body_on_an_edge_in_its_plane_moves_as_the_planar_engine_says(friction: float) -> None:
    draw = random.Random(4)
    for _ in range(40):
        expected, state, points = planar(draw, friction)
        found = fall(state, ALIKE, points, (0, 4), friction, horizon=0.4)
        if expected.point < 0:
            assert found.point < 0
            continue
        end = expected.state
        assert found.point % 4 == expected.point
        assert found.time == pytest.approx(expected.time, abs=TIME)
        twist = [end.vx, 0.0, end.vy, 0.0, -EDGE * end.omega, 0.0]
        ours = [*found.state.velocity, *(EDGE * w for w in found.state.angular_velocity)]
        assert ours == pytest.approx(twist, abs=TWIST)


SEEN = [case for case in GOLDEN["falls"] if float(case["phi0"]) > 1e-6 and abs(float(case["omega0"])) < 100.0]
"""A lower gap counts as none, and a faster body leaves an edge that is no hinge."""


@pytest.mark.parametrize("case", SEEN, ids=lambda case: f"phi0={case['phi0']} omega0={case['omega0']}")
def test_golden_falls_come_out_on_an_edge(case: dict[str, str]) -> None:
    a, h, rho_squared, gravity, angle, omega, time, rate = (float(value) for value in case.values())
    c, s = math.cos(angle), math.sin(angle)
    x, z = c * a - s * h, s * a + c * h
    pose = (0.0, -math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle))
    state = SpatialState((x, 0.0, z), pose, (-omega * z, 0.0, omega * x), (0.0, -omega, 0.0))
    points = [(side, depth, -h) for depth in (-0.1, 0.1) for side in (-a, 2.0 * a)]
    pull = Pull(gravity=(0.0, 0.0, -gravity))
    found = fall(state, (rho_squared,) * 3 + (0.0,) * 3, points, (0, 2), 1e6, pull, 2.0 * time)
    assert found.point % 2 == 1
    assert found.time == pytest.approx(time, rel=TIME)
    assert found.state.angular_velocity[1] == pytest.approx(-rate, rel=TIME)


def test_turning_the_scene_about_the_normal_and_mirroring_it_turns_and_mirrors_the_touchdown() -> None:
    draw = random.Random(5)
    for _ in range(20):
        start, corner = on_corner(draw, 0.5)
        found = fall(start, GENERAL, CUBE, (corner,), 0.3)
        if found.point < 0:
            continue
        turn = Rotation.from_rotvec([0.0, 0.0, draw.uniform(-3.0, 3.0)])
        position, velocity, spin = (
            turn.apply(part) for part in (start.position, start.velocity, start.angular_velocity)
        )
        pose = (turn * Rotation.from_quat(start.orientation)).as_quat()
        turned = fall(SpatialState(position, pose, velocity, spin), GENERAL, CUBE, (corner,), 0.3)
        assert turned.point == found.point
        assert turned.time == pytest.approx(found.time, abs=TIME)
        assert turned.state.velocity == pytest.approx(turn.apply(found.state.velocity), abs=TWIST)
        # Mirrored in y: places and velocities change the sign of y, turns those of x and z.
        mirror = np.array([1.0, -1.0, 1.0])
        x, y, z, w = start.orientation
        mirrored = fall(
            SpatialState(
                mirror * start.position, (-x, y, -z, w), mirror * start.velocity, -mirror * start.angular_velocity
            ),
            tuple(np.array(GENERAL) * [1, 1, 1, -1, 1, -1]),
            [(x, -y, z) for x, y, z in CUBE],
            (corner,),
            0.3,
        )
        assert mirrored.point == found.point
        assert mirrored.time == pytest.approx(found.time, abs=TIME)
        assert mirrored.state.velocity == pytest.approx(mirror * found.state.velocity, abs=TWIST)


@pytest.mark.parametrize(("friction", "angle"), [(0.3, 0.3), (0.5, 0.3), (0.5, 0.5)])
def test_an_edge_that_is_pulled_along_itself_touches_down_alike_whichever_way_it_lies(
    friction: float, angle: float
) -> None:
    tilt, found = Rotation.from_rotvec([0.0, angle, 0.0]), []
    for turn in (Rotation.from_rotvec([0.0, 0.0, way]) for way in (0.0, 0.7, 2.0)):
        pose, pull = turn * tilt, Pull(gravity=tuple(turn.apply([1.0, 2.0, -9.0])))
        state = SpatialState((0.0, 0.0, -pose.apply(CUBE[4])[2]), pose.as_quat(), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        one = fall(state, GENERAL, CUBE, (4, 6), friction, pull)
        twist = [turn.inv().apply(part) for part in (one.state.velocity, EDGE * np.array(one.state.angular_velocity))]
        found.append((one.point, one.time, np.concatenate(twist)))
    for point, time, twist in found[1:]:
        assert point == found[0][0] == 2
        assert time == pytest.approx(found[0][1], abs=TIME)
        assert twist == pytest.approx(found[0][2], abs=TWIST)


def test_an_edge_that_hardly_leans_and_lies_nearly_along_an_axis_touches_down_as_one_that_lies_across() -> None:
    draw, pull = random.Random(1), np.array([-0.9, 2.2, -8.8])
    tall = [(x, y, 1.5 * z) for x, y, z in CUBE]
    inertia = *(EDGE * EDGE * part / 12.0 for part in (3.25, 3.25, 2.0)), 0.0, 0.0, 0.0
    for _ in range(60):
        lean, way, tilt = 10.0 ** draw.uniform(-8.0, -3.0), 10.0 ** draw.uniform(-4.0, -1.0), draw.uniform(0.003, 0.1)
        pose, rate, found = Rotation.from_euler("xyz", [-tilt, lean, way]), draw.uniform(0.0, 0.5), []
        for turn in (Rotation.from_rotvec([0.0, 0.0, 0.7]), Rotation.identity()):
            lies = turn * pose
            position, spin = -lies.apply([0.0, *tall[2][1:]]), lies.apply([rate, 0.0, 0.0])
            state = SpatialState(position, lies.as_quat(), np.cross(spin, position), spin)
            found.append(fall(state, inertia, tall, (2, 6), 0.7, Pull(gravity=tuple(turn.apply(pull)))))
        assert found[0].point in (0, 4)
        assert found[1].point in (0, 4)
        assert found[1].time == pytest.approx(found[0].time, abs=TIME)


def test_a_body_that_lies_on_a_face_has_no_touchdown_and_what_it_takes_is_short() -> None:
    for velocity, spin in (((0.0, 0.0, 0.0), 0.0), ((0.5, 0.2, 0.0), 2.0)):
        state = SpatialState((0.0, 0.0, 0.5 * EDGE), FLAT, velocity, (0.0, 0.0, spin))
        for standing in ((0, 2, 4, 6), (0, 2, 4), (2, 4, 0, 6)):
            assert fall(state, ALIKE, CUBE, standing, 0.3).point < 0


def test_a_tall_body_that_slides_on_a_rough_support_tips_over_and_strikes() -> None:
    tall = [(x, y, 4.0 * z) for x, y, z in CUBE]
    state = SpatialState((0.0, 0.0, 2.0 * EDGE), FLAT, (2.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    found = fall(state, (0.0142, 0.0142, 0.00167, 0.0, 0.0, 0.0), tall, (0, 2, 4, 6), 0.8, horizon=2.0)
    assert found.point in (5, 7)
    assert max(found.rates[5], found.rates[7]) < -0.5


def test_a_point_beside_those_that_stand_strikes_at_once_where_it_is_on_the_support_and_approaches() -> None:
    state = SpatialState((0.0, 0.0, 0.5 * EDGE), FLAT, (0.0, 0.0, -0.2), (0.0, 4.0, 0.0))
    found = fall(state, ALIKE, CUBE, (0, 2), 0.3)
    assert found.time == 0.0
    assert found.point in (4, 6)


def test_of_several_points_on_the_support_the_fastest_strikes() -> None:
    level = SpatialState((0.0, 0.0, 0.5 * EDGE), FLAT, (0.0, 0.0, 0.0), (0.5, 1.0, 0.0))
    found = fall(level, ALIKE, CUBE)
    assert (found.time, CUBE[found.point]) == (0.0, (0.5 * EDGE, -0.5 * EDGE, -0.5 * EDGE))


def test_a_body_that_is_thrown_up_from_the_support_comes_down_with_its_speed() -> None:
    found = fall(SpatialState((0.0, 0.0, 0.5 * EDGE), FLAT, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)), ALIKE, CUBE)
    assert found.time == pytest.approx(2.0 / 9.81, abs=TIME)
    assert found.state.velocity == pytest.approx((0.0, 0.0, -1.0), abs=TWIST)


@pytest.mark.parametrize("scale", [1e-4, 1e4])
def test_a_body_that_is_larger_falls_as_long_as_the_root_of_its_size(scale: float) -> None:
    draw, root = random.Random(3), math.sqrt(scale)
    for _ in range(4):
        start = in_flight(draw)._replace(position=(0.0, 0.0, 0.15))
        larger = SpatialState(
            (0.0, 0.0, 0.15 * scale),
            start.orientation,
            tuple(root * v for v in start.velocity),  # type: ignore[arg-type]
            tuple(w / root for w in start.angular_velocity),  # type: ignore[arg-type]
        )
        one = fall(start, GENERAL, CUBE)
        other = fall(larger, np.multiply(scale**2, GENERAL).tolist(), np.multiply(scale, CUBE).tolist(), horizon=root)
        assert other.point == one.point >= 0
        assert other.time / root == pytest.approx(one.time, abs=1e-12)


def test_the_first_fall_of_a_gap_that_is_a_cubic_over_a_step_is_found_wherever_it_is() -> None:
    source, h, falls = np.random.default_rng(8), 0.1, 0
    for roots in source.uniform(-0.5, 1.5, (300, 3)):
        gap = np.polynomial.Polynomial.fromroots(roots) * source.choice([-1.0, 1.0])
        ends = [[gap(s), gap.deriv()(s) / h, gap.deriv(2)(s) / h**2] for s in (0.0, 1.0)]
        expected = min([s for s in roots if 0.0 < s < 1.0 and gap.deriv()(s) < 0.0], default=2.0)
        if ends[0][0] > 0.0:
            assert crossing(*ends, 0, h, 0.0, 0.0) == pytest.approx(expected, abs=1e-4)
            falls += expected < 1.0
    assert falls > 50


def test_a_point_below_the_support_that_rises_and_falls_back_comes_to_rest_and_the_body_goes_on() -> None:
    state = SpatialState((0.0, 0.0, 0.045), FLAT, (0.0, 0.0, 0.1), (0.0, 0.5, 0.0))
    found = fall(state, ALIKE, CUBE, horizon=1.0)
    assert found.point < 0  # one edge stops rising first, then the other comes to rest on it
    above = fall(state._replace(angular_velocity=(0.0, 6.0, 0.0)), ALIKE, CUBE, (0, 2), horizon=1.0)
    assert above.point in (4, 6)


def test_a_corner_that_lifts_does_not_strike_as_it_leaves() -> None:
    pose = (0.0, -math.sin(0.3), 0.0, math.cos(0.3))
    corner = Rotation.from_quat(pose).apply(CUBE[4])
    for spin in ((0.0, 11.0, 0.0), (-4.0, 11.0, 0.1), (3.0, -12.0, 2.0)):
        v = -np.cross(spin, corner) + [0.3, 0.1, 0.0]
        found = fall(SpatialState((0.0, 0.0, -corner[2]), pose, tuple(v), spin), ALIKE, CUBE, (4,), 0.2)
        assert found.point != 4 or found.time > 0.05


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The lengths in s of all steps of integration that are tried, as Python."""
    falling, tried = as_python("mechanics.motion.falling"), list[float]()
    step = falling.step

    def counted(time: float, h: float, *given: Any) -> tuple[float, int]:
        tried.append(h)
        return step(time, h, *given)

    monkeypatch.setattr(falling, "step", counted)
    monkeypatch.setattr(spatial, "solver", lambda: without_numba(PYTHON.fall))
    return tried


# A toss that comes to rest: on two corners of its face it lies, the third lifts and the fourth is below the ground.
TOSSED = (
    SpatialState(
        position=(0.0, 0.0, 0.04637319676404812),
        orientation=(0.3481868013580559, 0.9374133730865669, 0.004589549766589046, 0.0010273029985814475),
        velocity=(0.44033849560780725, -0.45332442439613957, 0.024105598334132387),
        angular_velocity=(-1.1949950281394515, -0.10963740239632569, -3.1344336427110346),
    ),
    (0.002859459459459459,) * 3 + (0.0,) * 3,
    [(x, y, z - 0.0063) for x, y, z in product((-0.0524, 0.0524), repeat=3)],
    (3, 5, 7),
    0.1734,
)
# A box that rests on an edge and turns on the spot, with a corner 0.1 mm below the support that sinks on.
SINKING = (
    SpatialState(
        position=(0.0, 0.0, 0.109044),
        orientation=(1.15962e-06, 0.0, -0.686102, 0.727505),
        velocity=(-2.4e-07, 3.45e-07, 1.6e-07),
        angular_velocity=(0.0, 0.0, -3.25e-05),
    ),
    (0.00576012, 0.00540292, 0.0032223, 0.0, 0.0, 0.0),
    list(product((-0.0655564, 0.0655564), (-0.0732752, 0.0732752), (-0.109138, 0.109138))),
    (4, 0, 6),
    0.17,
)
# A cube that turns ever more slowly on a very rough support: how its corners share its weight never settles.
SHARING = (
    SpatialState((0.0, 0.0, 0.05), (1.4e-10, -8.4e-10, 1.1, 1.0), (-1.9e-6, 7.6e-7, -1.5e-6), (0.0, 0.0, -0.0075)),
    ALIKE,
    CUBE,
    (2, 0, 6, 4),
    2.0,
)


@pytest.mark.parametrize(
    ("resting", "most"), [(TOSSED, 30), (SINKING, 30), (SHARING, 60)], ids=["tossed", "sinking", "sharing"]
)
def test_points_that_rest_and_lift_in_turns_do_not_hold_a_motion_up(
    resting: Any, most: int, steps: list[float]
) -> None:
    assert fall(*resting, horizon=0.25).point < 0
    assert len(steps) < most


def test_of_bodies_that_nearly_lie_flat_none_takes_more_than_600_steps(steps: list[float]) -> None:
    draw, most = random.Random(4), 0
    for _ in range(700):
        before = len(steps)
        start, standing = nearly_flat(draw)
        fall(start, ALIKE, CUBE, standing, draw.choice([0.0, 0.1, 0.5, 1.0, 2.0]), horizon=0.25)
        most = max(most, len(steps) - before)
    assert len(steps) < 25 * 700
    assert most < 600


# A long body that hangs over: on its corner it is 50 times as light one way along the support as the other.
SLENDER = (
    (-0.6549, 0.0208, 0.1121, 0.7471),
    (0.0019, 1.5646, -0.0794),
    (0.0, 0.0, 0.0),
    (0.006667, 0.336667, 0.336667, 0.0, 0.0, 0.0),
    [(1.1039, 0.0753, -0.0907), (0.1039, 1.0753, -0.0907), (-0.8961, 0.0753, -0.0907), (0.1039, -0.9247, -0.0907)],
    1,
    0.1,
)
# A column that falls over one corner, whose slip has come to its end before.
COLUMN = (
    (-0.1665, 0.1665, 0.6872, 0.6872),
    (-0.0012, 0.5383, -0.0047),
    (0.0298, 0.0217, 0.0),
    (0.086667, 0.096667, 0.016667, 0.0, 0.0, 0.0),
    [(0.2, 0.0, -0.5), (0.0, 0.2, -0.5), (-0.2, 0.0, -0.5), (0.0, -0.2, -0.5)],
    0,
    0.3,
)


# By Newton's and Euler's laws and Radau's method, with friction against slip / hypot(slip, 1e-6 m/s) that never sticks.
@pytest.mark.parametrize(
    ("body", "point", "time"), [(SLENDER, 0, 0.2978897), (COLUMN, 3, 0.4747278)], ids=["slender", "column"]
)
def test_a_corner_that_sticks_begins_to_slip_as_smoothed_friction_says_whichever_way_it_is_turned_and_nudged(
    body: Any, point: int, time: float, steps: list[float]
) -> None:
    pose, spin, slip, inertia, points, corner, friction = body
    draw = random.Random(8)
    for _ in range(8):
        turn = Rotation.from_rotvec([0.0, 0.0, draw.uniform(-3.0, 3.0)])
        turned = turn * Rotation.from_quat(pose)
        arm, w = turned.apply(points[corner]), turn.apply(spin) + vector(draw, 1e-13)
        v = turn.apply(slip) - np.cross(w, arm)
        start = SpatialState((0.0, 0.0, -arm[2]), turned.as_quat(), v, w)
        steps.clear()
        found = fall(start, inertia, points, (corner,), friction)
        assert found.point == point
        assert found.time == pytest.approx(time, abs=3.0 * TIME)
        assert len(steps) < 150


# The time is that of smoothed friction again. Both ends of the upper edge touch down together.
def test_two_corners_whose_slip_comes_to_its_end_turn_each_its_friction_with_its_slip() -> None:
    a, b, c = 0.04, 0.06, 0.0623
    box = list(product((-a, a), (-b, b), (-c, c)))
    pose = Rotation.from_rotvec([0.0, 0.0, 0.34]) * Rotation.from_rotvec([-0.075, 0.0, 0.0])
    start = SpatialState((0.0, 0.0, -pose.apply(box[2])[2]), pose.as_quat(), (-4e-4, -9e-4, -3.3e-4), (0.0, 0.0, 0.0))
    inertia = ((b * b + c * c) / 3.0, (a * a + c * c) / 3.0, (a * a + b * b) / 3.0, 0.0, 0.0, 0.0)
    found = fall(start, inertia, box, (6, 2), 0.17)
    assert found.point in (0, 4)
    assert found.time == pytest.approx(0.0415742326, abs=TIME)


# The times are those of thousands of steps, without the limit on their number.
@pytest.mark.parametrize(
    ("across", "lean", "spin", "slip", "corner", "time"),
    [
        (-0.0011, 0.013, -0.9, (-0.02, 0.01, 0.0), 6, 0.007264227363041287),
        (0.0017, 0.005, -1.9, (-0.01, -0.01, 0.0), 4, 0.008874167087373732),
        (-0.0017, 0.014, -0.2, (-0.03, 0.01, 0.0), 6, 0.008817290822902338),
    ],
)
def test_a_slip_whose_end_would_take_thousands_of_steps_is_ended_and_the_touchdown_after_it_told(
    across: float, lean: float, spin: float, slip: tuple[float, ...], corner: int, time: float
) -> None:
    pose = Rotation.from_euler("xyz", [across, lean, 0.0])
    arm, w = pose.apply(CUBE[corner]), np.array([0.0, 0.0, spin])
    start = SpatialState((0.0, 0.0, -arm[2]), pose.as_quat(), -np.cross(w, arm) + slip, w)
    found = fall(start, ALIKE, CUBE, (corner,), 0.9, horizon=0.3)
    assert found.point == {4: 6, 6: 4}[corner]
    assert found.time == pytest.approx(time, abs=TIME)


@pytest.mark.parametrize("plain", [False, True], ids=["compiled", "plain"])
def test_odd_numbers_have_no_touchdown_and_raise_nothing(plain: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if plain:
        monkeypatch.setattr(spatial, "solver", lambda: without_numba(PYTHON.fall))
    good = SpatialState((0.0, 0.0, 0.2), FLAT, (0.0, 0.0, -1.0), (1.0, 2.0, 3.0))
    bad = [
        fall(good._replace(position=(0.0, math.nan, 0.2)), ALIKE, CUBE),
        fall(good._replace(velocity=(0.0, math.inf, 0.2)), ALIKE, CUBE),
        fall(good._replace(orientation=(0.0, 0.0, 0.0, 0.0)), ALIKE, CUBE),
        fall(good, (1.0, -1.0, 1.0, 0.0, 0.0, 0.0), CUBE),
        fall(good, (1.0, 1.0, 1.0, 5.0, 0.0, 0.0), CUBE),
        fall(good, (0.0,) * 6, CUBE),
        fall(good, ALIKE, CUBE, (), -0.1),
        fall(good, ALIKE, CUBE, (), math.nan),
        fall(good, ALIKE, CUBE, (), 0.1, Pull(gravity=(0.0, 0.0, math.nan))),
        fall(good, ALIKE, CUBE, (), 0.1, horizon=-1.0),
        fall(good, ALIKE, ()),
    ]
    assert {(found.time, found.point) for found in bad} == {(math.inf, -1)}
    assert fall(good, ALIKE, [(0.0, 0.0, 0.0)]).point == 0
    assert fall(good, ALIKE, [(0.0, 0.0, 0.0)] * 3, (0, 1, 2), 1e4).point == -1
    weightless = fall(good, ALIKE, CUBE, (0, 1), 0.5, Pull(gravity=(0.0, 0.0, 0.0)))
    assert all(math.isfinite(number) for number in numbers_of(weightless.state))


def test_random_stances_give_finite_touchdowns_above_the_support() -> None:
    draw = random.Random(6)
    for _ in range(400):
        start, corner = on_corner(draw, draw.choice([0.0, 0.5]))
        others = [i for i in range(8) if i != corner and draw.random() < 0.2]
        friction = draw.choice([0.0, 0.2, 0.7, 1.5, 1e4])
        found = fall(start, draw.choice([ALIKE, GENERAL]), CUBE, (corner, *others), friction, horizon=0.3)
        assert np.isfinite(numbers_of(found.state)).all()
        if found.point >= 0:
            assert 0.0 <= found.time <= 0.3
            assert found.rates[found.point] < 0.0
            free = [gap for i, gap in enumerate(found.gaps) if i not in (corner, *others)]
            assert min(free) > -1e-6 * EDGE or found.time == 0.0


def test_parts_of_one_array_to_work_with_are_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiled law code works in one array, where Python has a list for each of its parts."""
    start, corner = on_corner(random.Random(2), 0.5)
    cases = [(start, GENERAL, points, (0,), 0.2) for points in ([CUBE[corner]], [CUBE[corner], CUBE[corner ^ 1]])]
    found = [fall(*case) for case in cases]
    monkeypatch.setattr(spatial, "solver", lambda: PYTHON.fall)
    assert [fall(*case) for case in cases] == found
    assert found[1].point == 1


@pytest.mark.extras
def test_every_form_of_the_law_code_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    draw, cases = random.Random(7), []
    for k in range(30):
        start, corner = on_corner(draw, 0.5 * (k % 2))
        standing = (corner, corner ^ 1) if k % 3 == 0 else (corner,)
        cases.append((start, GENERAL, CUBE, standing, 0.2, DECK, 0.3))
    found = [fall(*case) for case in cases]
    for law in (PYTHON, spatial_problem):
        monkeypatch.setattr(spatial, "solver", lambda law=law: without_numba(law.fall))
        assert [fall(*case) for case in cases] == found
    assert any(one.point >= 0 for one in found)
