"""Touchdowns over a moving support against Newton's law in the world's axes.

The reference knows nothing of the support's frame: it integrates the mass centre and the angle in the world up to the
touchdown, finds the velocities there relative to the support, and places all of it anywhere in space.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from harmonic_deck import Wave, from_world, harmonic_support
from hypothesis import given, settings
from hypothesis import strategies as st
from newton_in_world import newton
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from impact_predictor import Contact, InputError, TwoPointBody, cylinder, plate, solve_impact
from impact_predictor.mechanics.motion import PlanarState, rock, standing
from impact_predictor.mechanics.motion.support import MovingSupport, SupportMotion, in_world
from impact_predictor.mechanics.types import Outcome, Twist
from impact_predictor.prediction.deck.frame import post_impact
from impact_predictor.prediction.deck.motion import ahead as constant
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import MovingDeck, Scene, triple
from impact_predictor.prediction.types import Felt, Moment, Prediction, Sample, Status, Vector3

AGREES = 1e-9
"""The reference integrates to 1e-12 and steps err by less than 1e-10, at up to 2 m/s and 2 rad/s."""

ZEROS = (0.0,) * 36
HALF_EDGE = 0.3
CRATE = plate(length=0.8, height=1.0, mass=50.0, friction=0.9, restitution=0.1)
SLIPPERY = TwoPointBody(50.0, 7.0, Contact(-0.4, -0.5, 0.1), Contact(0.4, -0.5, 0.1, restitution=0.1))
DRUM = cylinder(radius=0.3, gamma=0.6, mass=40.0, friction=0.6)
SPINNING = DRUM._replace(old=DRUM.old._replace(friction=0.1), new=DRUM.new._replace(friction=0.1))

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def accelerating(
    angle: tuple[float, float, float], x: tuple[float, float, float], y: tuple[float, float, float]
) -> MovingSupport:
    """A support with constant accelerations: place, rate and acceleration of each at time 0."""

    def motion(t: Any) -> SupportMotion:
        (a, da, dda), (px, vx, ax), (py, vy, ay) = (
            (p + (v + 0.5 * c * t) * t, v + c * t, c + 0.0 * t) for p, v, c in (angle, x, y)
        )
        return SupportMotion(a, da, dda, px, py, vx, vy, ax, ay)

    return MovingSupport(motion, 1.0)


DECK = accelerating((0.2, 0.3, -0.5), (1.0, -0.7, 1.1), (2.0, 0.9, -1.3))


class Placed(NamedTuple):
    """A planar body over a planar support, somewhere in space.

    The plane's axes, along the support, out of it and across, are turned by `plane` in the world and have their origin
    at `shift`. In them the support's frame is turned by `mount`, with its origin at `origin`, and the body frame by
    `own`, with the mass centre at `center` in it.
    """

    body: TwoPointBody
    support: MovingSupport
    plane: Rotation
    shift: Array
    mount: Rotation
    origin: Array
    own: Rotation
    center: Array

    def moment(self, time: float) -> Moment:
        """The support at a time in s."""
        motion = self.support.at(self.origin[0], self.origin[1]).motion(time)
        orientation = self.plane * Rotation.from_rotvec([0.0, 0.0, motion.angle]) * self.mount
        place = self.plane.apply([motion.x, motion.y, self.origin[2]]) + self.shift

        def along(x: float, y: float) -> Vector3:
            return triple(orientation.inv().apply(self.plane.apply([x, y, 0.0])))

        def about(rate: float) -> Vector3:
            return triple(self.mount.inv().apply([0.0, 0.0, rate]))

        def ahead(t: float) -> Felt:
            return self.moment(time + t).felt

        felt = Felt(
            along(-motion.ax, -self.support.gravity - motion.ay), about(motion.rate), about(motion.acceleration)
        )
        gravity = triple(self.plane.apply([0.0, -self.support.gravity, 0.0]))
        linear = along(motion.vx, motion.vy)
        return Moment(
            round(time * 1e9), "world", "deck", triple(place), quaternion(orientation), linear, felt, ahead, gravity
        )

    def at(self, stamp: int) -> Moment | Status:
        """As the tracker of a support answers."""
        return self.moment(stamp * 1e-9)

    def sample(self, time: float, state: PlanarState) -> Sample:
        """The body in the world, from its planar state there."""
        x, y, angle, vx, vy, omega = state
        orientation = self.plane * Rotation.from_rotvec([0.0, 0.0, angle]) * self.own
        spin = self.plane.apply([0.0, 0.0, omega])
        position = self.plane.apply([x, y, 0.0]) + self.shift - orientation.apply(self.center)
        linear = self.plane.apply([vx, vy, 0.0]) - np.cross(spin, orientation.apply(self.center))
        return self.message(time, "world", position, orientation, linear, spin)

    def relative(self, time: float, state: PlanarState) -> Sample:
        """The body in the support's frame, from its planar state there."""
        x, y, angle, vx, vy, omega = state
        out = self.mount.inv()
        orientation = out * Rotation.from_rotvec([0.0, 0.0, angle]) * self.own
        spin = out.apply([0.0, 0.0, omega])
        position = out.apply(np.array([x, y, 0.0]) - self.origin) - orientation.apply(self.center)
        linear = out.apply([vx, vy, 0.0]) - np.cross(spin, orientation.apply(self.center))
        return self.message(time, "deck", position, orientation, linear, spin)

    def message(
        self, time: float, frame: str, position: Array, orientation: Rotation, linear: Array, spin: Array
    ) -> Sample:
        back = orientation.inv()
        twist = triple(back.apply(linear)), triple(back.apply(spin))
        return Sample(round(time * 1e9), frame, "body", triple(position), quaternion(orientation), *twist, ZEROS, ZEROS)

    def scene(self, **changes: Any) -> Scene:
        old, new = self.body.old, self.body.new
        assert old is not None
        tensor = self.own.as_matrix().T @ np.diag([0.8, 1.3, 1.0]) @ self.own.as_matrix() * self.body.inertia
        normal = self.mount.inv().apply([0.0, 1.0, 0.0])
        drum = old.normal != (0.0, 1.0)
        edges = [[0.0, 0.0, 0.2], [new.x - old.x, new.y - old.y, 0.2]]
        points = [[c.x, c.y, side] for c in (old, new) for side in (-HALF_EDGE, HALF_EDGE)]
        points += [[-0.3, 0.4, 0.0], [0.3, 0.4, 0.0]]
        scene = Scene(
            mass=self.body.mass,
            inertia=(triple(tensor[0]), triple(tensor[1]), triple(tensor[2])),
            friction=new.friction,
            restitution=new.restitution,
            center_of_mass=triple(self.center),
            points=() if drum else tuple(triple(self.own.inv().apply(point) + self.center) for point in points),
            frame="deck",
            normal=triple(normal),
            height=float(-self.origin[1]),
            gravity=triple(self.plane.apply([0.0, -self.support.gravity, 0.0])),
            horizon=1.0,
            deck=MovingDeck(),
            radius=math.hypot(old.x, old.y) if drum else 0.0,
            edges=tuple(triple(self.mount.inv().apply(edge - self.origin)) for edge in edges) if drum else (),
        )
        return scene._replace(**changes)

    def falls(self, start: PlanarState, states: str) -> tuple[float, Callable[[float], PlanarState]]:
        """When contact 1 touches, and the body's planar state in the world until then; contacts are in `states`."""

        def gap(time: float, y: Array) -> float:
            x, height, angle, *_ = from_world(self.support.motion(time), PlanarState(*y))
            new, old = self.body.new, self.body.old
            if new.normal == (0.0, 1.0):
                return float(height + new.x * math.sin(angle) + new.y * math.cos(angle))
            return math.hypot(x - (new.x - old.x), height - (new.y - old.y)) - math.hypot(new.x, new.y)

        gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
        found = solve_ivp(
            lambda t, y: newton(self.body, self.support, states, t, y)[0],
            (0.0, 2.0),
            np.array(in_world(self.support.motion(0.0), start)),
            "DOP853",
            events=gap,
            rtol=1e-12,
            atol=1e-13,
            dense_output=True,
            max_step=0.02,
        )
        assert found.t_events[0].size == 1
        return float(found.t_events[0][0]), lambda time: PlanarState(*found.sol(time).tolist())


def quaternion(rotation: Rotation) -> tuple[float, float, float, float]:
    x, y, z, w = (float(part) for part in rotation.as_quat())
    return x, y, z, w


def anywhere(body: TwoPointBody, support: MovingSupport, seed: int) -> Placed:
    """The body over a support, given by its own origin, anywhere in space."""
    rng = np.random.default_rng(seed)
    plane, mount, own = Rotation.random(3, random_state=rng)
    shift, origin, center = rng.normal(size=3), rng.normal(size=3), 0.1 * rng.normal(size=3)
    support = support.at(-float(origin[0]), -float(origin[1]))
    return Placed(body, support, plane, shift, mount, origin, own, center)


def at_touchdown(placed: Placed, time: float, state: PlanarState, stands: bool) -> tuple[Twist, Outcome]:
    """The twist relative to the support along its axes, and what the impact does."""
    relative = from_world(placed.support.motion(time), state)
    body = placed.body
    old, new = body.old, body.new
    assert old is not None
    if new.normal == (0.0, 1.0):
        c, s = math.cos(relative.angle), math.sin(relative.angle)
        old = old._replace(x=c * old.x - s * old.y, y=s * old.x + c * old.y)
        new = new._replace(x=c * new.x - s * new.y, y=old.y if stands else s * new.x + c * new.y)
    elif not stands:
        edge = new.x - old.x - relative.x, new.y - old.y - relative.y
        size = math.hypot(*edge)
        new = new._replace(x=edge[0], y=edge[1], normal=(-edge[0] / size, -edge[1] / size))
    twist = Twist(*relative[3:])
    return twist, solve_impact(body._replace(old=old if stands else None, new=new), twist, restitution="energetic")


CASES = {
    "crate turning": (CRATE, standing(CRATE, 0.15, -0.2), "SO"),
    "crate sliding": (SLIPPERY, standing(SLIPPERY, 0.15, -0.2, slip=1.6), "+O"),
    "crate flying": (CRATE, standing(CRATE, -0.15, -0.5)._replace(y=0.8, vx=0.3, vy=-0.4), "OO"),
    "drum turning": (DRUM, standing(DRUM, 0.2, -0.3), "SO"),
    "drum slipping": (SPINNING, standing(SPINNING, 0.25, -0.3, slip=-1.5), "-O"),
    "drum flying": (DRUM, standing(DRUM, 0.1)._replace(x=0.25, y=0.45, vx=0.3, vy=-0.1), "OO"),
}


@pytest.mark.parametrize("in_deck", [False, True], ids=["in the world", "on the deck"])
@pytest.mark.parametrize("kind", CASES)
@pytest.mark.parametrize("seed", range(2))
def test_a_touchdown_over_a_support_with_constant_accelerations_is_foreseen(
    kind: str, seed: int, in_deck: bool
) -> None:
    body, start, states = CASES[kind]
    placed = anywhere(body, DECK, seed)
    end, state = placed.falls(start, states)
    before, outcome = at_touchdown(placed, end, state(end), states[0] != "O")
    for part in (0.0, 0.5, 0.9):
        stamp = round(part * end * 1e9) * 1e-9
        sample = placed.sample(stamp, state(stamp))
        if in_deck:
            sample = placed.relative(stamp, from_world(placed.support.motion(stamp), state(stamp)))
        prediction = Predictor(placed.scene(), placed).update(sample)
        touchdown = prediction.touchdown
        assert touchdown is not None
        assert touchdown.lead_time == pytest.approx(end - stamp, abs=AGREES)
        assert touchdown.mode is outcome.mode
        assert touchdown.before == pytest.approx(before, abs=AGREES)
        assert touchdown.after == pytest.approx(outcome.twist, abs=AGREES)
        motion = placed.support.motion(end)
        relative = from_world(motion, state(end))
        after = relative._replace(vx=outcome.twist.vx, vy=outcome.twist.vy, omega=outcome.twist.omega)
        expected = placed.relative(end, after) if in_deck else placed.sample(end, in_world(motion, after))
        position, orientation, linear, angular = post_impact(prediction)
        assert position == pytest.approx(expected.position, abs=AGREES)
        turned = Rotation.from_quat(orientation).inv() * Rotation.from_quat(expected.orientation)
        assert turned.magnitude() < AGREES
        assert linear == pytest.approx(expected.linear, abs=AGREES)
        assert angular == pytest.approx(expected.angular, abs=AGREES)


class Known:
    """A support that is known exactly now, and goes on with constant accelerations."""

    def __init__(self, placed: Placed) -> None:
        self.placed = placed

    def at(self, stamp: int) -> Moment | Status:
        moment = self.placed.moment(stamp * 1e-9)
        return moment._replace(ahead=partial(constant, *moment.felt))


def rocking(body: TwoPointBody, start: PlanarState, exactly: bool) -> list[tuple[float, float, float]]:
    """Lead time in s, its error, and that of the velocity before over the speed, of every prediction from samples at
    100 Hz on a deck in a swell.
    """
    swell = harmonic_support(angle=(Wave(0.12, 0.9, 0.4),), x=(Wave(0.8, 0.7, 1.0),), y=(Wave(1.2, 0.8, 0.2),))
    support = swell.at(3.0, 2.0)
    placed = anywhere(body, support, 3)._replace(origin=np.array([-3.0, -2.0, 0.4]), support=support)
    run = rock(body, start, support, duration=4.0)
    predictor = Predictor(placed.scene(), placed if exactly else Known(placed))
    found = []
    for strike in run.impacts[:4]:
        earlier = max((one.time for one in run.impacts if one.time < strike.time), default=0.0)
        for count in range(math.ceil(earlier * 100.0 + 1.0), math.floor(strike.time * 100.0)):
            time = 0.01 * count
            touchdown = predictor.update(placed.sample(time, run.world(time))).touchdown
            if touchdown is not None:
                speed = math.hypot(strike.before.vx, strike.before.vy)
                forth = 1.0 if strike.new == 1 else -1.0  # the impact plane leads towards the contact that strikes
                errors = forth * touchdown.before.vx - strike.before.vx, touchdown.before.vy - strike.before.vy
                lead = strike.time - time
                found.append((lead, abs(touchdown.lead_time - lead), math.hypot(*errors) / speed))
    return found


@pytest.mark.parametrize(("body", "angle"), [(CRATE, 0.25), (DRUM, 0.3)])
def test_rocking_in_a_swell_is_foreseen_at_each_sample(body: TwoPointBody, angle: float) -> None:
    start = standing(body, angle)
    exact, constant_on = rocking(body, start, True), rocking(body, start, False)
    assert len(exact) >= 30
    assert max(error for _, error, _ in exact) < 1e-8
    assert max(error for _, _, error in exact) < 1e-8
    # What is felt drifts by about 1 m/s^3, a tenth of g a second.
    for least, time_error, twist_error in ((0.0, 3e-5, 2e-3), (0.1, 5e-4, 5e-3), (0.2, 2e-3, 1.5e-2)):
        chosen = [one for one in constant_on if least <= one[0] < least + 0.05]
        assert chosen
        assert max(one[1] for one in chosen) < time_error, least
        assert max(one[2] for one in chosen) < twist_error, least


POSES = st.tuples(st.floats(-0.3, 0.3), st.floats(-1.5, 1.5), st.floats(-1.0, 1.0), st.integers(0, 1000))


def same_touchdown(one: Prediction, other: Prediction, close: float) -> None:
    mine, theirs = one.touchdown, other.touchdown
    assert (mine is None) is (theirs is None)
    if mine is not None and theirs is not None:
        assert (mine.mode, mine.old, mine.new) == (theirs.mode, theirs.old, theirs.new)
        for name in ("lead_time", "before", "after", "position", "linear", "angular", "axis", "half_distance"):
            assert getattr(mine, name) == pytest.approx(getattr(theirs, name), abs=close), name


@settings(max_examples=40, deadline=None)
@given(POSES, st.sampled_from([CRATE, SLIPPERY, DRUM]))
def test_over_a_support_at_rest_all_is_as_over_a_fixed_one(
    pose: tuple[float, float, float, int], body: TwoPointBody
) -> None:
    angle, omega, slip, seed = pose
    start = standing(body, angle, omega, slip)
    placed = anywhere(body, accelerating((0.1, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0)), seed)
    moment = placed.moment(0.0)
    scene = placed.scene()
    fixed = Predictor(scene._replace(deck=None, gravity=moment.felt.gravity))
    relative = placed.relative(0.0, start)
    expected = fixed.update(relative)
    on_deck = Predictor(scene, placed).update(relative)
    assert on_deck.touchdown == expected.touchdown
    assert on_deck.relative is relative
    from_world_frame = Predictor(scene, placed).update(placed.sample(0.0, in_world(placed.support.motion(0.0), start)))
    same_touchdown(from_world_frame, expected, 1e-10)  # rounding of the way there, through a slip that is followed


def test_what_rests_on_a_deck_that_moves_announces_nothing() -> None:
    for body in (CRATE, DRUM):
        placed = anywhere(body, DECK, 5)
        predictor = Predictor(placed.scene(), placed)
        for count in range(20):
            time = 0.01 * count
            state = in_world(placed.support.motion(time), standing(body, 0.0))
            prediction = predictor.update(placed.sample(time, state))
            assert prediction.status is Status.ACCEPTED
            assert prediction.touchdown is None
            relative = prediction.relative
            assert relative is not None
            assert (*relative.linear, *relative.angular) == pytest.approx((0.0,) * 6, abs=1e-12)
            assert prediction.support is not None
            assert prediction.support.stamp == prediction.sample.stamp == relative.stamp


def test_a_score_compares_velocities_relative_to_the_support() -> None:
    start = standing(CRATE, 0.12)
    support = harmonic_support(angle=(Wave(0.1, 0.9, 0.4),), x=(Wave(0.8, 0.7, 1.0),), y=(Wave(1.2, 0.8, 0.2),))
    placed = anywhere(CRATE, support, 7)
    run = rock(CRATE, start, placed.support, duration=1.5)
    predictor = Predictor(placed.scene(), placed)
    scores = []
    for count in range(150):
        answer = predictor.update(placed.sample(0.01 * count, run.world(0.01 * count)))
        if answer.score is not None:
            scores.append(answer.score)
    assert scores
    score, strike = scores[0], run.impacts[0]
    assert score.scored
    assert score.stamp * 1e-9 == pytest.approx(strike.time, abs=1e-8)
    assert score.touchdown.mode is strike.outcome.mode
    assert score.relative_error is not None
    # Two samples later it has turned a little.
    assert score.relative_error < 0.15
    assert score.touchdown.after.omega == pytest.approx(strike.after.omega, abs=1e-7)


def sample_at_rest(placed: Placed, **changes: Any) -> Sample:
    return placed.relative(0.0, standing(placed.body, 0.0))._replace(**changes)


@pytest.mark.parametrize(
    ("support_frames", "accepted"), [(("world", "deck"), {"deck"}), (("", "imu_link"), {"deck", "imu_link"})]
)
def test_a_sample_of_a_frame_that_is_not_the_supports_is_refused(
    support_frames: tuple[str, str], accepted: set[str]
) -> None:
    placed = anywhere(CRATE, DECK, 8)
    world, own = support_frames
    support = SimpleNamespace(at=lambda stamp: placed.moment(0.0)._replace(frame_id=world, child_frame_id=own))
    for frame in ("deck", "imu_link", "map", ""):
        status = Predictor(placed.scene(), support).update(sample_at_rest(placed, frame_id=frame)).status
        assert status is (Status.ACCEPTED if frame in accepted else Status.WRONG_FRAME)


@pytest.mark.parametrize(
    ("body", "along", "up", "status"),
    [
        (CRATE, 0.0, 0.9 * math.hypot(0.7, 0.9, 0.3), Status.ACCEPTED),
        (CRATE, 0.0, 2.0 * math.hypot(0.7, 0.9, 0.3), Status.OFF_SUPPORT),
        (CRATE, 0.0, -0.064, Status.ACCEPTED),
        (CRATE, 0.0, -0.128, Status.BELOW_SUPPORT),
        (CRATE, 1.5, 0.0, Status.ACCEPTED),
        (CRATE, 2.5, 0.0, Status.OFF_SUPPORT),
        (DRUM, 0.0, 0.54, Status.ACCEPTED),
        (DRUM, 0.0, 1.2, Status.OFF_SUPPORT),
        (DRUM, 0.0, -0.04, Status.ACCEPTED),
        (DRUM, 0.0, -0.08, Status.BELOW_SUPPORT),
        (DRUM, 0.3, 0.0, Status.ACCEPTED),
        (DRUM, 0.4, 0.0, Status.OFF_SUPPORT),
        (DRUM, -0.4, 0.0, Status.OFF_SUPPORT),
    ],
)
def test_a_body_far_from_the_support_deep_in_it_or_beyond_its_edges_is_refused(
    body: TwoPointBody, along: float, up: float, status: Status
) -> None:
    """The deck ends 2 m ahead; a drum has left its edges by half a radius."""
    placed = anywhere(body, DECK, 9)._replace(mount=Rotation.identity(), origin=np.zeros(3))
    start = standing(body, 0.0)
    sample = placed.relative(0.0, start._replace(x=start.x + along, y=start.y + up))
    deck = MovingDeck(extent=(-1.0, 2.0, -9.0, 9.0))
    assert Predictor(placed.scene(deck=deck), placed).update(sample).status is status


@pytest.mark.parametrize("edges", [((0.0, 0.0, 0.0), (0.0, 0.7, 0.0)), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.1))])
def test_edges_that_carry_no_cylinder_are_refused(edges: tuple[Vector3, Vector3]) -> None:
    scene = Scene(40.0, ((1.8, 0, 0), (0, 3.0, 0), (0, 0, 3.0)), 0.5, radius=0.3, edges=edges)
    with pytest.raises(InputError, match="carry"):
        Predictor(scene)


ANY = st.floats(-5.0, 5.0) | st.sampled_from([0.0, 1e-300, 1e-8, 1e3, -1e6, 1e11])
TRIPLES = st.tuples(ANY, ANY, ANY)
UNITS = st.integers(0, 100).map(lambda seed: quaternion(Rotation.random(random_state=seed)))
PLACES = st.tuples(ANY, ANY, ANY | st.floats(-0.1, 1.0))
FELT = st.builds(Felt, st.tuples(ANY, ANY, st.floats(-12.0, 0.0)), TRIPLES, TRIPLES)
SAMPLES = st.builds(
    partial(Sample, 0, child_frame_id="body", pose_covariance=ZEROS, twist_covariance=ZEROS),
    st.sampled_from(["world", "deck"]),
    position=PLACES,
    orientation=UNITS | st.just((0.0, 0.0, 0.0, 1.0)),
    linear=TRIPLES,
    angular=TRIPLES,
)


def numbers_of(value: Any) -> list[float]:
    """Every float of nested tuples."""
    if isinstance(value, tuple):
        return [number for part in value for number in numbers_of(part)]
    return [value] if isinstance(value, float) else []


@settings(max_examples=200, deadline=None)
@given(st.sampled_from([CRATE, DRUM]), FELT, UNITS, TRIPLES, st.lists(SAMPLES, min_size=1, max_size=4))
def test_no_sample_over_any_support_raises_or_makes_a_nan(
    body: TwoPointBody, felt: Felt, orientation: Any, place: Vector3, samples: list[Sample]
) -> None:
    upright, identity = Rotation.from_rotvec([0.5 * math.pi, 0.0, 0.0]), Rotation.identity()
    placed = Placed(body, DECK, identity, np.zeros(3), upright, np.zeros(3), identity, np.zeros(3))
    moment = Moment(0, "world", "deck", place, orientation, place, felt, partial(constant, *felt))
    predictor = Predictor(placed.scene(), SimpleNamespace(at=lambda stamp: moment))
    for count, sample in enumerate(samples):
        prediction = predictor.update(sample._replace(stamp=10_000_000 * count))
        if prediction.touchdown is not None:
            assert prediction.status is Status.ACCEPTED
            assert all(map(math.isfinite, numbers_of(prediction.touchdown))), prediction.touchdown
            assert all(map(math.isfinite, numbers_of(post_impact(prediction))))
