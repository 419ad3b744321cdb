"""Predictions of bodies whose planar motion is known and which stand anywhere in space.

The reference integrates Newton's and Euler's equations of the planar body on its own, and places it with scipy's
rotations: any support, any position, any body frame.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, solve_spatial_impact
from impact_predictor.mechanics.types import Contact, Mode, Outcome, Twist, TwoPointBody
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, triple
from impact_predictor.prediction.types import Leftover, Prediction, Sample, Touchdown, Vector3

CLOSE = 1e-5
"""The reference integrates to 1e-12, a sliding stance is followed to 1e-6 of its turning, up to 10 m/s and 10 rad/s."""

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
ZEROS = (0.0,) * 36


def turn(angle: float, point: Array | tuple[float, float]) -> Array:
    sine, cosine = math.sin(angle), math.cos(angle)
    return np.array([cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]])


class PlanarBody(NamedTuple):
    """A body in its plane: contacts (x, y) from the mass centre at angle 0, old is None in flight; and where it is."""

    old: tuple[float, float] | None
    new: tuple[float, float]
    mass: float
    inertia: float
    friction: float
    gravity: tuple[float, float]
    angle: float
    omega: float
    slip: float = 0.0
    start: tuple[float, float] = (0.0, 0.0)
    velocity: tuple[float, float] = (0.0, 0.0)

    def motion(self) -> tuple[float, Callable[[float], tuple[Array, float, Array, float]]]:
        """Time of the touchdown, and mass centre, angle, velocity and angular velocity at any time up to it."""
        return self._flight() if self.old is None else self._stance(np.array(self.old))

    def _flight(self) -> tuple[float, Callable[[float], tuple[Array, float, Array, float]]]:
        start, velocity, gravity = np.array(self.start), np.array(self.velocity), np.array(self.gravity)

        def at(time: float) -> tuple[Array, float, Array, float]:
            place = start + velocity * time + 0.5 * gravity * time * time
            return place, self.angle + self.omega * time, velocity + gravity * time, self.omega

        def gap(time: float) -> float:
            place, angle, _, _ = at(time)
            return float(place[1] + turn(angle, self.new)[1])

        low, high = 0.0, 1e-3
        while gap(high) > 0.0:
            low, high = high, high + 1e-3
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if gap(middle) > 0.0 else (low, middle)
        return high, at

    def _stance(self, old: Array) -> tuple[float, Callable[[float], tuple[Array, float, Array, float]]]:
        direction = math.copysign(1.0, self.slip) if self.slip else 0.0
        rho_squared, g = self.inertia / self.mass, self.gravity

        def load(state: Array) -> tuple[float, float, float]:
            """Normal and tangential reaction per mass, and the angular acceleration."""
            angle, omega, _, _ = state
            x, y = turn(angle, -old)  # from the contact to the mass centre
            if not direction:
                alpha = (x * g[1] - y * g[0]) / (rho_squared + x * x + y * y)
                return alpha * x - omega * omega * y - g[1], -alpha * y - omega * omega * x - g[0], alpha
            lever = x + self.friction * direction * y
            push = -(omega * omega * y + g[1]) / (1.0 + x * lever / rho_squared)
            return push, -self.friction * direction * push, -push * lever / rho_squared

        def rates(_: float, state: Array) -> list[float]:
            angle, omega, _, slip = state
            x, y = turn(angle, -old)
            _, pull, alpha = load(state)
            return [omega, alpha, slip, pull + g[0] + alpha * y + omega * omega * x if direction else 0.0]

        def gap(_: float, state: Array) -> float:
            return float((turn(state[0], self.new) - turn(state[0], old))[1])

        gap.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            rates,
            (0.0, 2.0),
            [self.angle, self.omega, 0.0, self.slip],
            "DOP853",
            events=gap,
            rtol=1e-12,
            atol=1e-13,
            dense_output=True,
        )
        assert found.t_events[0].size == 1
        for time in np.linspace(0.0, found.t_events[0][0], 20):
            push, pull, _ = load(found.sol(time))
            assert push > 0.0, "the reference stance must stay loaded"
            if direction:
                assert found.sol(time)[3] * direction > 0.0, "the reference stance must go on slipping one way"
            else:
                assert abs(pull) < self.friction * push, "the reference stance must stay in its friction cone"

        def at(time: float) -> tuple[Array, float, Array, float]:
            angle, omega, place, slip = found.sol(time)
            x, y = turn(angle, -old)
            return np.array([place + x, y]), angle, np.array([slip - omega * y, omega * x]), omega

        return float(found.t_events[0][0]), at

    def impact(self, law: str, restitution: float) -> tuple[Twist, Outcome]:
        """Twist before, and what the impact does."""
        time, at = self.motion()
        _, angle, velocity, omega = at(time)
        before = Twist(float(velocity[0]), float(velocity[1]), float(omega))
        new = turn(angle, self.new)
        struck = Contact(new[0], new[1], self.friction, restitution=restitution)
        stood = None if self.old is None else Contact(turn(angle, self.old)[0], new[1], self.friction)
        rule = "energetic" if law == "path" else "poisson"
        return before, solve_impact(TwoPointBody(self.mass, self.inertia, stood, struck), before, law, restitution=rule)


class Placed(NamedTuple):
    """A planar body in space: the rotation from the plane's axes (d, n, d x n) to the world, the place of the plane's
    origin, the rotation from the body frame to the planar body, the mass centre in the body frame, the velocity across
    the plane, and the half width of the edges."""

    body: PlanarBody
    plane: Rotation
    place: Array
    mount: Rotation
    center: Vector3
    lateral: float = 0.0
    width: float = 0.1
    tensor: Array | None = None

    def scene(self, **changes: Any) -> Scene:
        body = self.body
        tensor = np.diag([0.7, 1.6, 1.0]) * body.inertia if self.tensor is None else self.tensor
        own = self.mount.as_matrix().T @ tensor @ self.mount.as_matrix()
        normal = self.plane.apply([0.0, 1.0, 0.0])
        scene = Scene(
            mass=body.mass,
            inertia=(triple(own[0]), triple(own[1]), triple(own[2])),
            friction=body.friction,
            restitution=0.2,
            center_of_mass=self.center,
            points=self.points(),
            frame="world",
            normal=triple(normal),
            height=float(normal @ self.place),
            gravity=triple(self.plane.apply([*body.gravity, 0.0])),
            horizon=1.0,
        )
        return scene._replace(**changes)

    def points(self) -> tuple[Vector3, ...]:
        """The two edges, the old one first, and two points that stay away from the support."""
        edges = [edge for edge in (self.body.old, self.body.new) if edge is not None]
        planar = [[*edge, side] for edge, side in product(edges, (-self.width, self.width))]
        planar += [[0.0, 0.5, 0.0], [0.1, 0.5, 0.1]]
        return tuple(triple(self.mount.inv().apply(point) + self.center) for point in planar)

    def pose(self, time: float, state: tuple[Array, float]) -> tuple[Array, Rotation]:
        """Of the body frame."""
        orientation = self.plane * Rotation.from_rotvec([0.0, 0.0, state[1]]) * self.mount
        center = self.place + self.plane.apply([*state[0], self.lateral * time])
        return center - orientation.apply(self.center), orientation

    def twist(self, orientation: Rotation, velocity: Array, omega: float) -> tuple[Array, Array]:
        """Of the body frame, in the body frame."""
        spin = self.plane.apply([0.0, 0.0, omega])
        linear = self.plane.apply([*velocity, self.lateral]) - np.cross(spin, orientation.apply(self.center))
        return orientation.inv().apply(linear), orientation.inv().apply(spin)

    def sample(self, time: float, at: Callable[[float], tuple[Array, float, Array, float]]) -> Sample:
        place, angle, velocity, omega = at(time)
        position, orientation = self.pose(time, (place, angle))
        linear, angular = self.twist(orientation, velocity, omega)
        return self.message(time, position, orientation, linear, angular)

    def averaged(self, time: float, window: float, at: Callable[[float], tuple[Array, float, Array, float]]) -> Sample:
        """A sample whose twist is the mean over the window before it, as a source that differences poses gives."""
        (early, before), (late, now) = (self.pose(moment, at(moment)[:2]) for moment in (time - window, time))
        linear = now.inv().apply((late - early) / window)
        angular = now.inv().apply((now * before.inv()).as_rotvec() / window)
        return self.message(time, late, now, linear, angular)

    def message(self, time: float, position: Array, orientation: Rotation, linear: Array, angular: Array) -> Sample:
        x, y, z, w = (float(part) for part in orientation.as_quat())
        stamp = round(time * 1e9)
        return Sample(
            stamp, "world", "body", triple(position), (x, y, z, w), triple(linear), triple(angular), ZEROS, ZEROS
        )


STICKING = PlanarBody((-0.12, -0.05), (0.10, -0.05), 0.8, 0.006, 1.2, (0.6, -9.7), math.radians(20.0), -0.8)
"""On a slope."""
SLIDING = STICKING._replace(friction=0.18, slip=0.9, omega=-1.5)
SLIDING_BACK = SLIDING._replace(slip=-0.9)
FLYING = STICKING._replace(old=None, start=(0.3, 0.2), velocity=(0.4, -0.3), omega=-3.0)
BODIES = {"sticking": STICKING, "sliding": SLIDING, "sliding back": SLIDING_BACK, "flying": FLYING}


def anywhere(body: PlanarBody, seed: int) -> Placed:
    """The body over a random support, seen in a random frame of its own."""
    rng = np.random.default_rng(seed)
    plane, mount = Rotation.random(2, random_state=rng)
    # What stays in its plane turns about a principal axis: any ellipse of inertia across it, with room for mass.
    half = rng.normal(size=(2, 2))
    tensor = np.diag([0.0, 0.0, body.inertia])
    across = half @ half.T
    tensor[:2, :2] = body.inertia * (0.6 * np.eye(2) + 0.6 * across / np.trace(across))
    return Placed(body, plane, rng.normal(size=3), mount, triple(0.1 * rng.normal(size=3)), 0.0, 0.1, tensor)


def announced(placed: Placed, time: float, **changes: Any) -> Touchdown:
    """What a single sample announces."""
    _, at = placed.body.motion()
    touchdown = Predictor(placed.scene(**changes)).update(placed.sample(time, at)).touchdown
    assert touchdown is not None
    return touchdown


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("kind", BODIES)
@pytest.mark.parametrize("seed", range(3))
def test_a_touchdown_is_foreseen_as_it_happens(kind: str, seed: int, law: str) -> None:
    placed = anywhere(BODIES[kind], seed)
    body = placed.body
    end, at = body.motion()
    before, outcome = body.impact(law, 0.2)
    place, angle, _, _ = at(end)
    position, orientation = placed.pose(end, (place, angle))
    linear, angular = placed.twist(orientation, np.array(outcome.twist[:2]), outcome.twist.omega)
    for part in (0.1, 0.5, 0.9, 0.999):
        stamp = round(part * end * 1e9) * 1e-9
        touchdown = announced(placed, stamp, law=law)
        assert touchdown.lead_time == pytest.approx(end - stamp, abs=CLOSE * end)
        assert touchdown.mode is outcome.mode
        assert touchdown.law == law
        assert touchdown.segments == outcome.segments
        assert touchdown.before == pytest.approx(before, abs=CLOSE)
        assert touchdown.after == pytest.approx(outcome.twist, abs=CLOSE)
        assert np.array(touchdown.impulses) == pytest.approx(np.array(outcome.impulses), abs=CLOSE)
        assert touchdown.energy_lost == pytest.approx(outcome.energy_lost, abs=CLOSE)
        assert (touchdown.old, touchdown.new) == (((), (0, 1)) if body.old is None else ((0, 1), (2, 3)))
        assert touchdown.axis == pytest.approx(placed.plane.apply([0.0, 0.0, -1.0]), abs=CLOSE)
        assert touchdown.position == pytest.approx(position, abs=CLOSE)
        assert (Rotation.from_quat(touchdown.orientation).inv() * orientation).magnitude() < CLOSE
        assert touchdown.linear == pytest.approx(linear, abs=CLOSE)
        assert touchdown.angular == pytest.approx(angular, abs=CLOSE)
        width = 0.0 if body.old is None else 0.11
        assert touchdown.half_distance == pytest.approx(width, abs=CLOSE)
        assert touchdown.lateral == pytest.approx(-placed.lateral, abs=CLOSE)
        assert (touchdown.off_axis, touchdown.offset) == pytest.approx((0.0, 0.0), abs=CLOSE)
        assert touchdown.leftover == (Leftover.ONE_POINT if body.old is None else Leftover.NONE)


def test_the_reference_covers_several_modes() -> None:
    assert {body.impact("path", 0.2)[1].mode for body in BODIES.values()} >= {Mode.BACK_PIVOT, Mode.FLIGHT}


@pytest.mark.parametrize("kind", BODIES)
def test_an_averaged_twist_is_taken_for_what_it_is(kind: str) -> None:
    placed = anywhere(BODIES[kind]._replace(velocity=(0.4, -0.6)), 1)._replace(center=(0.0, 0.0, 0.0))
    window = 0.02
    end, at = placed.body.motion()
    aware = Predictor(placed.scene(twist_window=window, tolerance=0.01))
    naive = Predictor(placed.scene(twist_window=0.0, tolerance=0.01))
    late: list[float] = []
    too_late: list[float] = []
    for time in np.arange(window, end - 1.5 * window, 0.005):
        sample = placed.averaged(time, window, at)
        answers = [predictor.update(sample).touchdown for predictor in (aware, naive)]
        for errors, touchdown in zip((late, too_late), answers, strict=True):
            assert touchdown is not None
            errors.append(abs(touchdown.lead_time - (end - time)))
    # Half a window of gravity is 0.1 m/s; what is left is of second order in the window.
    assert max(late) < 0.001
    assert max(late) < 0.25 * max(too_late)


@pytest.mark.parametrize("kind", BODIES)
def test_a_touchdown_is_announced_up_to_the_horizon(kind: str) -> None:
    placed = anywhere(BODIES[kind], 1)
    end, at = placed.body.motion()
    for horizon, announced_at_all in ((end - 1e-6, False), (end + 1e-6, True)):
        touchdown = Predictor(placed.scene(horizon=horizon)).update(placed.sample(0.0, at)).touchdown
        assert (touchdown is not None) is announced_at_all


def test_gravity_across_the_plane_moves_a_body_in_flight_only() -> None:
    alike = np.eye(3) * FLYING.inertia
    placed = anywhere(FLYING, 2)._replace(tensor=alike)
    end, at = placed.body.motion()
    sideways = placed.plane.apply([0.0, 0.0, 2.0])
    gravity = triple(np.add(placed.scene().gravity, sideways))
    level, tilted = announced(placed, 0.0), announced(placed, 0.0, gravity=gravity)
    assert np.subtract(tilted.position, level.position) == pytest.approx(0.5 * sideways * end**2, abs=CLOSE)
    moved = np.subtract(tilted.before_6d.linear, level.before_6d.linear)
    assert moved == pytest.approx(sideways * end, abs=CLOSE)
    # Friction opposes the whole slip.
    across = placed.plane.apply([0.0, 0.0, 1.0])
    assert 0.0 < np.dot(tilted.after_6d.linear, across) < 2.0 * end - 0.01

    stands = anywhere(STICKING, 2)
    sideways = stands.plane.apply([0.0, 0.0, 0.5])
    gravity = triple(np.add(stands.scene().gravity, sideways))
    level, tilted = announced(stands, 0.0), announced(stands, 0.0, gravity=gravity)
    assert tilted.position == pytest.approx(level.position, abs=CLOSE)


def test_an_edge_a_little_askew_strikes_as_one_and_says_how_askew() -> None:
    placed = anywhere(STICKING, 6)
    time = placed.body.motion()[0] - 0.02
    points = list(placed.points())
    points[3] = triple(points[3] + placed.mount.inv().apply([0.0, 0.002, 0.0]))
    even, askew = announced(placed, time), announced(placed, time, points=tuple(points))
    speed = 0.22 * abs(even.before.omega)
    assert even.closing_spread == pytest.approx(0.0, abs=CLOSE)
    assert askew.new == (2, 3)
    # The speed 20 ms before is a tenth less.
    assert askew.closing_spread == pytest.approx(0.002 / speed, rel=0.15)
    assert askew.leftover is Leftover.NONE


def test_a_body_that_turns_off_its_axis_is_out_of_plane() -> None:
    placed = anywhere(FLYING, 7)._replace(tensor=np.eye(3) * FLYING.inertia, width=0.0)
    end, at = placed.body.motion()
    sample = placed.sample(end - 0.01, at)
    spin = np.linalg.norm(sample.angular)
    up = Rotation.from_quat(sample.orientation).inv().apply(placed.plane.apply([0.0, 1.0, 0.0]))
    for part, leftover in ((0.2, Leftover.ONE_POINT), (0.4, Leftover.ONE_POINT | Leftover.OUT_OF_PLANE)):
        spun = sample._replace(angular=triple(np.array(sample.angular) + part * spin * up))
        touchdown = Predictor(placed.scene(center_of_mass=placed.center)).update(spun).touchdown
        assert touchdown is not None
        assert touchdown.off_axis == pytest.approx(part / math.hypot(1.0, part), abs=CLOSE)
        assert touchdown.leftover == leftover
        # A body alike about all its axes turns on as it did, up to the impact.
        assert np.linalg.norm(touchdown.before_6d.angular) == pytest.approx(spin * math.hypot(1.0, part), abs=CLOSE)
        now, then = (Rotation.from_quat(one.orientation) for one in (sample, touchdown))
        turned = np.array(touchdown.before_6d.angular) * touchdown.lead_time
        assert (then * now.inv()).as_rotvec() == pytest.approx(turned, abs=CLOSE)


def test_contacts_beside_the_mass_centre_are_out_of_plane() -> None:
    placed = anywhere(STICKING, 8)
    for side, leftover in ((0.02, Leftover.NONE), (0.03, Leftover.OUT_OF_PLANE)):
        aside = placed.mount.inv().apply([0.0, 0.0, side])
        points = tuple(triple(np.add(point, aside)) for point in placed.points())
        touchdown = announced(placed, 0.05, points=points)
        assert touchdown.offset == pytest.approx(side, abs=CLOSE)
        assert touchdown.leftover == leftover  # half the distance of the contacts is 0.11 m


def test_a_slow_approach_is_told_from_an_impact() -> None:
    """4 g t_c is 0.2 m/s."""
    for speed, leftover in ((0.18, Leftover.TOO_SLOW), (0.22, Leftover.NONE)):
        body = STICKING._replace(angle=math.radians(0.005), omega=-speed / 0.22)
        touchdown = announced(anywhere(body, 9), 0.0, tolerance=1e-6)
        assert touchdown.leftover == leftover


def on_its_edge(body: PlanarBody, seed: int, **changes: Any) -> tuple[Placed, Prediction]:
    """What is foreseen of a body that turns about its edge, from that moment alone."""
    assert body.old is not None
    placed = anywhere(body, seed)
    place = turn(body.angle, (-body.old[0], -body.old[1]))
    velocity = np.array([body.slip - body.omega * place[1], body.omega * place[0]])
    sample = placed.sample(0.0, lambda _: (place, body.angle, velocity, body.omega))
    return placed, Predictor(placed.scene(**changes)).update(sample)


def test_a_body_that_falls_back_before_it_touches_has_no_touchdown_ahead() -> None:
    """It stands too high on its edge to get over the balance; the points it falls on are not in the geometry."""
    body = STICKING._replace(angle=math.radians(80.0), omega=-0.8, gravity=(0.0, -9.8))
    for angle, ahead in ((80.0, False), (60.0, True)):
        body = body._replace(angle=math.radians(angle))
        _, prediction = on_its_edge(body, 10, horizon=5.0, contact_time=0.001)
        assert (prediction.touchdown is not None) is ahead


def test_a_body_that_hops_on_its_old_contact_has_no_touchdown_of_the_new_one_ahead() -> None:
    """It lifts off, and its stance edge comes down again first."""
    body = STICKING._replace(angle=math.radians(10.384), omega=-12.2111, slip=0.193, gravity=(0.0, -9.8))
    _, prediction = on_its_edge(body, 10)
    assert prediction.touchdown is None


def test_one_corner_of_an_edge_strikes_a_body_that_nothing_guides() -> None:
    """Up to the touchdown the stance edge holds the axis; the impact at one point turns the body off it."""
    placed = anywhere(STICKING, 13)
    body = placed.body
    tensor = placed.tensor
    assert tensor is not None
    points = tuple(point for i, point in enumerate(placed.points()) if i != 3)
    end, at = body.motion()
    touchdown = announced(placed, 0.05, points=points)
    before, _ = body.impact("path", 0.2)
    turned = placed.plane * Rotation.from_rotvec([0.0, 0.0, at(end)[1]])
    struck = [turned.apply(place) for place in ([-0.12, -0.05, -0.1], [-0.12, -0.05, 0.1], [0.1, -0.05, -0.1])]
    twist = [*placed.plane.apply([before.vx, before.vy, 0.0]), *placed.plane.apply([0.0, 0.0, before.omega])]
    contacts = ContactPoints(struck, body.friction, 0.2, placed.plane.apply([0.0, 1.0, 0.0]))
    inertia = turned.as_matrix() @ tensor @ turned.as_matrix().T
    slow = 0.005 * math.hypot(*body.gravity)
    outcome = solve_spatial_impact(Body(body.mass, inertia), contacts, twist, threshold=slow)
    assert (touchdown.old, touchdown.new) == ((0, 1), (2,))
    assert touchdown.leftover & Leftover.ONE_CORNER_FIRST
    assert touchdown.before == pytest.approx(before, abs=CLOSE)
    assert np.concatenate(touchdown.after_6d) == pytest.approx(outcome.twist, abs=10.0 * CLOSE)
    assert [contact.state for contact in touchdown.contacts] == list(outcome.states)
    assert np.linalg.norm(np.cross(touchdown.after_6d.angular, touchdown.axis)) > 0.1


def test_a_body_that_lifts_off_its_stance_strikes_with_one_point() -> None:
    """It turns so fast that the support would have to hold it down."""
    body = STICKING._replace(omega=-14.0, angle=math.radians(40.0))
    place = turn(body.angle, (0.12, 0.05))
    velocity = body.omega * np.array([-place[1], place[0]])
    flying = body._replace(old=None, start=triple([*place, 0.0])[:2], velocity=triple([*velocity, 0.0])[:2])
    end, at = flying.motion()
    lifted = at(end)[0][1] + turn(at(end)[1], (-0.12, -0.05))[1]
    assert lifted > 0.005
    placed, prediction = on_its_edge(body, 11)
    touchdown = prediction.touchdown
    assert touchdown is not None
    assert touchdown.lead_time == pytest.approx(end, abs=CLOSE)
    assert touchdown.old == ()
    tensor = placed.tensor
    assert tensor is not None
    x, y = turn(at(end)[1], body.new)
    struck = Contact(float(x), float(y), body.friction, restitution=0.2)
    before = Twist(float(at(end)[2][0]), float(at(end)[2][1]), body.omega)
    free = TwoPointBody(body.mass, 1.0 / np.linalg.inv(tensor)[2, 2], None, struck)
    assert touchdown.after == pytest.approx(solve_impact(free, before, restitution="energetic").twist, abs=CLOSE)
    assert touchdown.leftover & Leftover.ONE_POINT


def test_a_body_dropped_without_turning_is_foreseen_in_three_dimensions() -> None:
    """One corner strikes, beside the mass centre: the plane that holds both, the free inertia, and the fall by hand."""
    rng = np.random.default_rng(12)
    half = rng.normal(size=(3, 3))
    tensor = 0.01 * (half @ half.T + 0.3 * np.eye(3))
    orientation = Rotation.random(random_state=rng)
    corner = orientation.inv().apply([0.12, 0.05, -0.2])
    points = (triple(corner), triple(-corner))
    own = triple(tensor[0]), triple(tensor[1]), triple(tensor[2])
    scene = Scene(2.0, own, 0.0, points=points, horizon=1.0, contact_time=0.0, normal=(0, 0, 1))
    x, y, z, w = (float(part) for part in orientation.as_quat())
    down = triple(orientation.inv().apply([0.0, 0.0, -1.0]))
    sample = Sample(0, "", "", (0.0, 0.0, 0.5), (x, y, z, w), down, (0.0, 0.0, 0.0), (), ())
    touchdown = Predictor(scene).update(sample).touchdown
    assert touchdown is not None
    speed = math.sqrt(1.0 + 2.0 * 9.81 * 0.3)
    assert touchdown.lead_time == pytest.approx((speed - 1.0) / 9.81, abs=CLOSE)
    assert np.cross(touchdown.axis, [0.0, 0.0, 1.0]) == pytest.approx(np.array([0.12, 0.05, 0.0]) / 0.13, abs=CLOSE)
    # Without friction the impulse is along the normal; the planar body may turn about its axis only, and freely off it.
    inertia = orientation.as_matrix() @ tensor @ orientation.as_matrix().T
    lever = np.cross([0.12, 0.05, -0.2], [0.0, 0.0, 1.0])
    impulse = speed / (0.5 + lever @ np.linalg.solve(inertia, lever))
    assert touchdown.impulses[1] == pytest.approx((impulse, 0.0), abs=CLOSE)
    assert touchdown.after.vy == pytest.approx(impulse / 2.0 - speed, abs=CLOSE)


@pytest.mark.parametrize("kind", BODIES)
def test_both_laws_agree_where_one_takes_over_from_the_other(kind: str) -> None:
    """Less motion across the plane than the border allows, and more; the steps of the law in space err by 3 %."""
    placed = anywhere(BODIES[kind], 3)
    if placed.body.old is None:
        placed = placed._replace(tensor=np.diag([1.1, 1.3, 1.0]) * placed.body.inertia)
    end, at = placed.body.motion()
    planar = announced(placed, end - 0.002)
    approach = -float(np.dot(placed.plane.apply([0.0, 1.0, 0.0]), planar.before_6d.linear))
    approach += planar.half_distance * 2.0 * abs(planar.before.omega) if planar.old else 0.0
    beside = [announced(placed._replace(lateral=part * 1e-3 * abs(approach)), end - 0.002) for part in (0.1, 3.0)]
    assert [bool(touchdown.segments) for touchdown in beside] == [True, False]
    for touchdown in beside:
        assert touchdown.mode is planar.mode
        assert touchdown.after == pytest.approx(tuple(planar.after), abs=0.03 * (abs(planar.before.omega) + 1.0))


@pytest.mark.parametrize("double", [copy.deepcopy, pickle.dumps])
def test_a_predictor_is_neither_copied_nor_pickled_in_part(double: Callable[[Predictor], object]) -> None:
    with pytest.raises(TypeError, match="make another of its scene"):
        double(
            Predictor(Scene(1.0, ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)), 0.3, points=((0.0, 0.0, 0.0),)))
        )
