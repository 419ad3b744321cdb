"""The impact of a landing foot: the laws of mechanics, in any frame, and the planar impact where it is one."""

from math import cos, sin

import numpy as np
import pytest

from impact_predictor import Mode, solve_impact
from impact_predictor.mechanics.types import Contact, Flag, TwoPointBody
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Leftover, Sample, Status
from impact_predictor.prediction.vectors import axes_of, cross
from impact_predictor.prediction.walking.impact import touchdown_of
from impact_predictor.prediction.walking.mechanism import RigidMachine

FEET = ((0.31, 0.29, -0.58), (0.31, -0.29, -0.58), (-0.31, 0.29, -0.58), (-0.31, -0.29, -0.58))
LEVEL = (0.0, 0.0, 0.0, 1.0)


def scene_of(**changes):
    inertia = (4.3, -0.2, 0.5), (-0.2, 9.0, 0.1), (0.5, 0.1, 8.3)
    given = {"mass": 83.0, "inertia": inertia, "friction": 0.6, "center_of_mass": (0.03, 0.01, -0.04)}
    walking = Walking(("LF", "RF", "LH", "RH"))
    return Scene(**{**given, "walking": walking, **changes})


def base_of(linear=(0.4, 0.1, -0.2), angular=(0.1, 0.2, -0.3), position=(0.0, 0.0, 0.58), orientation=LEVEL):
    return Sample(5, "world", "base", position, orientation, linear, angular, (), ())


def random_landing(source, **changes):
    """A scene, its base, its feet and the contacts of a landing, with the velocity that the base gives the foot.

    Where feet stand, the mean of them does not move. The base turns about it.
    """
    scene = scene_of(friction=source.uniform(0.1, 1.0), **changes)
    feet = tuple(tuple(foot) for foot in (np.array(FEET) + source.uniform(-0.1, 0.1, (4, 3)) * [1, 1, 0]).tolist())
    new = int(source.integers(4))
    others = [i for i in range(4) if i != new]
    old = tuple(sorted(source.permutation(others)[: source.integers(0, 4)].tolist()))
    angular = source.normal(size=3)
    linear = source.normal(size=3)
    if old:
        linear = -np.cross(angular, np.mean([feet[i] for i in old], axis=0))
    velocity = linear + np.cross(angular, feet[new])
    if velocity[2] > 0.0:
        linear, angular, velocity = -linear, -angular, -velocity
    orientation = source.normal(size=4)
    orientation = tuple((orientation / np.linalg.norm(orientation)).tolist())
    axes = np.array(axes_of(orientation))
    base = base_of(tuple(linear.tolist()), tuple(angular.tolist()), tuple(source.normal(size=3)), orientation)
    # The ground is the body's own xy plane, wherever that is turned.
    scene = scene._replace(normal=tuple(axes[2].tolist()))
    return scene, base, feet, old, (new,), tuple((velocity @ axes).tolist())


def landing(scene, base, feet, old, new, velocity, **together):
    return touchdown_of(scene, RigidMachine(scene), base, feet, old, new, 0.05, velocity, **together)


def motion_of_mass_centre(scene, linear, angular):
    return np.array(linear) + np.cross(angular, scene.center_of_mass), np.array(angular)


def impulse_vectors(scene, base, touchdown):
    """The impulses (old, new) as vectors of the body frame."""
    axes = np.array(axes_of(base.orientation))
    ahead = np.cross(touchdown.axis, scene.normal)
    return [axes @ (n * np.array(scene.normal) + t * ahead) for n, t in touchdown.impulses]


def landings(count, seed, **changes):
    source = np.random.default_rng(seed)
    for _ in range(count):
        case = random_landing(source, **changes)
        yield case, landing(*case)


def test_a_landing_keeps_the_momentum_balance_about_any_point():
    source = np.random.default_rng(1)
    for (scene, base, feet, _, new, _), touchdown in landings(200, seed=2):
        before = motion_of_mass_centre(scene, base.linear, base.angular)
        after = motion_of_mass_centre(scene, touchdown.linear, touchdown.angular)
        pushes = impulse_vectors(scene, base, touchdown)
        places = [np.mean([feet[i] for i in those], axis=0) if those else np.zeros(3) for those in (touchdown.old, new)]
        momentum = scene.mass * (after[0] - before[0])
        assert momentum == pytest.approx(sum(pushes), abs=1e-11)  # rounding of momenta of about 100 N s
        about = source.normal(size=3)
        turned = np.array(scene.inertia) @ (after[1] - before[1])
        turned += np.cross(np.array(scene.center_of_mass) - about, momentum)
        assert turned == pytest.approx(
            sum(np.cross(place - about, push) for place, push in zip(places, pushes, strict=True)), abs=1e-11
        )


def test_a_landing_leaves_no_approach_and_its_impulses_are_in_their_cones():
    modes = set()
    for (scene, _, feet, old, new, _), touchdown in landings(400, seed=3):
        for normal, tangent in touchdown.impulses:
            assert normal >= 0.0
            assert abs(tangent) <= scene.friction * normal + 1e-10
        for those in (old, new):
            if those:
                place = np.mean([feet[i] for i in those], axis=0)
                rate = touchdown.linear[2] + np.cross(touchdown.angular, place)[2]
                assert rate >= -1e-12
        modes.add(touchdown.mode)
    assert {Mode.SLIDE, Mode.PIVOT, Mode.PIVOT_SLIDE} <= modes


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_landing_loses_the_kinetic_energy_that_it_says_it_loses(restitution):
    for (scene, base, _, old, *_), touchdown in landings(200, seed=4, restitution=restitution):
        if touchdown.old != old:
            continue  # Here the mean of the standing feet is at rest, and a single one of them is not.
        energies = []
        for state in (base, touchdown):
            velocity, spin = motion_of_mass_centre(scene, state.linear, state.angular)
            energies.append(0.5 * (scene.mass * velocity @ velocity + spin @ np.array(scene.inertia) @ spin))
        assert touchdown.energy_lost == pytest.approx(energies[0] - energies[1], abs=1e-11)
        assert touchdown.energy_lost >= -1e-12


@pytest.mark.parametrize("friction", [0.1, 0.4, 2.0])
@pytest.mark.parametrize("law", ["path", "total"])
def test_a_wheel_in_its_plane_lands_as_the_planar_body(friction, law):
    angle, length, rate = np.pi / 8, 1.0, 1.5
    x, y = length * sin(angle), -length * cos(angle)
    scene = scene_of(
        mass=2.0,
        inertia=((0.3, 0, 0), (0, 0.5, 0), (0, 0, 0.3)),
        friction=friction,
        law=law,
        center_of_mass=(0.0, 0.0, 0.0),
    )
    body = TwoPointBody(2.0, 0.5, Contact(-x, y, friction), Contact(x, y, friction))
    twist = body.turning(-rate)
    expected = solve_impact(body, twist, law)
    base = base_of((twist.vx, 0.0, twist.vy), (0.0, rate, 0.0))
    velocity = twist.vx + rate * y, 0.0, twist.vy - rate * x
    touchdown = landing(scene, base, ((x, 0.0, y), (-x, 0.0, y)), (1,), (0,), velocity)
    assert touchdown.mode is expected.mode
    assert touchdown.before == pytest.approx(twist, abs=1e-15)
    assert touchdown.after == pytest.approx(expected.twist, abs=1e-13)
    assert touchdown.energy_lost == pytest.approx(expected.energy_lost, abs=1e-13)
    assert touchdown.axis == pytest.approx((0.0, 1.0, 0.0))
    assert touchdown.linear == pytest.approx((expected.twist.vx, 0.0, expected.twist.vy), abs=1e-13)
    assert touchdown.angular == pytest.approx((0.0, -expected.twist.omega, 0.0), abs=1e-13)
    assert (touchdown.old, touchdown.new, touchdown.lead_time) == ((1,), (0,), 0.05)


def test_a_machine_turns_about_the_line_of_two_standing_feet_towards_the_third():
    touchdown = landing(scene_of(), base_of(), FEET, (1, 2), (0,), (0.0, 0.0, -0.2))
    line = np.array(FEET[1]) - FEET[2]
    assert np.cross(touchdown.axis, line) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert np.dot(cross(touchdown.axis, (0.0, 0.0, 1.0)), FEET[0]) > 0.0


@pytest.mark.parametrize("old", [(2,), (2, 3, 0)])
def test_otherwise_it_turns_across_the_arm_from_the_middle_of_the_standing_feet(old):
    touchdown = landing(scene_of(), base_of(), FEET, old, (1,), (0.0, 0.0, -0.2))
    arm = np.array(FEET[1]) - np.mean([FEET[i] for i in old], axis=0)
    assert np.dot(touchdown.axis, arm) == pytest.approx(0.0, abs=1e-12)
    assert np.dot(cross(touchdown.axis, (0.0, 0.0, 1.0)), arm) > 0.0
    assert touchdown.old == old


def test_a_toe_strikes_about_the_heel_of_its_own_foot_whatever_else_stands():
    scene = scene_of(walking=Walking(("left", "right"), points=2))
    touchdown = landing(scene, base_of(), FEET, (0, 1, 2), (3,), (0.0, 0.0, -0.2))
    assert touchdown.old == (2,)
    # The impulses at the right foot, behind the mass centre, press the left one, ahead of it, into the ground.
    turn = np.subtract(touchdown.angular, base_of().angular)
    rise = touchdown.linear[2] - base_of().linear[2]
    assert min(rise + np.cross(turn, FEET[i])[2] for i in (0, 1)) < 0.0
    assert Leftover.OUT_OF_PLANE in touchdown.leftover
    touchdown = landing(scene, base_of(), FEET, (0, 1), (3,), (0.0, 0.0, -0.2))
    assert set(touchdown.old) <= {0, 1}
    assert touchdown.old


@pytest.mark.parametrize("standing", [1, 2, 3])
def test_no_standing_foot_of_a_rigid_machine_is_driven_into_the_ground(standing):
    source = np.random.default_rng(standing)
    scene, dropped = scene_of(), 0
    for _ in range(100):
        feet = [tuple(np.add(foot, (*source.uniform(-0.1, 0.1, 2), 0.0))) for foot in FEET]
        old = tuple(sorted(source.choice([1, 2, 3], standing, replace=False).tolist()))
        slip = source.uniform(-0.3, 0.3, 2)
        touchdown = landing(scene, base_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), tuple(feet), old, (0,), (*slip, -1.0))
        # What the legs do else does not change while the impact lasts: a standing foot gets the change of the twist.
        rates = [touchdown.linear[2] + np.cross(touchdown.angular, feet[i])[2] for i in old]
        assert min(rates) > -1e-9
        dropped += touchdown.old != old
    assert dropped > 0 or standing == 1


def test_a_body_with_next_to_no_inertia_is_answered_although_its_standing_foot_is_pressed_by_rounding():
    scene = scene_of(mass=20.0, inertia=((1e-9, 0.0, 0.0), (0.0, 1e-9, 0.0), (0.0, 0.0, 1e-9)), friction=0.405)
    scene = scene._replace(center_of_mass=(0.0, 0.0, 0.0), walking=Walking(("left", "right")))
    feet = (3e-17, 0.5, -0.49999999999887373), (-9e-17, -0.5, -0.5)
    rest = base_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.5))
    touchdown = landing(scene, rest, feet, (1,), (0,), (0.0, 0.0, -0.6666655474983967))
    assert touchdown.old == (1,)
    assert touchdown.leftover & Leftover.OUT_OF_PLANE


def test_the_corners_of_a_sole_that_strike_together_tell_how_far_apart_they_close():
    scene = scene_of(walking=Walking(("left", "right"), points=2))
    feet = (*FEET[:2], (-0.2, 0.3, -0.58), (-0.4, 0.3, -0.579))
    touchdown = landing(scene, base_of(), feet, (0, 1), (2, 3), (0.0, 0.0, -0.2))
    assert touchdown.closing_spread == pytest.approx(0.001 / 0.2)


def test_where_nothing_stands_one_foot_is_struck_in_the_plane_of_its_slip():
    touchdown = landing(scene_of(), base_of(), FEET, (), (1,), (0.0, -0.3, -0.2))
    assert touchdown.leftover == Leftover.DRIVEN | Leftover.ONE_POINT
    assert cross(touchdown.axis, (0.0, 0.0, 1.0)) == pytest.approx((0.0, -1.0, 0.0))
    assert touchdown.lateral == pytest.approx(0.0)
    assert touchdown.impulses[0] == (0.0, 0.0)
    assert touchdown.half_distance == 0.0


@pytest.mark.parametrize("speed", [0.0, 1e-14, -0.1])
def test_a_foot_that_has_braked_makes_no_impact(speed):
    touchdown = landing(scene_of(), base_of(), FEET, (1, 2), (0,), (0.1, 0.0, -speed))
    assert touchdown.mode is Mode.NO_IMPACT
    assert (touchdown.linear, touchdown.angular) == (base_of().linear, base_of().angular)
    assert touchdown.before == touchdown.after
    assert touchdown.energy_lost == 0.0


def test_a_landing_that_gravity_matters_in_is_flagged():
    slow, fast = (landing(scene_of(), base_of(), FEET, (1, 2), (0,), (0.0, 0.0, -v)) for v in (0.1, 5.0))
    assert slow.flags & Flag.SLOW_IMPACT
    assert not fast.flags & Flag.SLOW_IMPACT


def test_what_a_mechanism_cannot_answer_is_handed_on():
    class Unknown:
        def response(self, old, new, normal, ahead, points):
            return Status.SINGULAR_INERTIA

    found = touchdown_of(scene_of(), Unknown(), base_of(), FEET, (1, 2), (0,), 0.05, (0.0, 0.0, -0.2))
    assert found is Status.SINGULAR_INERTIA


def test_a_touchdown_tells_how_far_from_planar_it_is():
    scene = scene_of(center_of_mass=(0.0, 0.05, 0.0))
    base = base_of(angular=(0.3, 0.4, 0.0))
    touchdown = landing(scene, base, ((0.3, 0.0, -0.5), (-0.3, 0.0, -0.58)), (1,), (0,), (0.1, 0.2, -0.3))
    assert touchdown.axis == pytest.approx((0.0, 1.0, 0.0))
    assert touchdown.lateral == pytest.approx(0.2)
    assert touchdown.half_distance == pytest.approx(0.5 * np.hypot(0.6, 0.08))
    assert touchdown.offset == pytest.approx(0.05)
    # The part of (0.3, 0.4, 0) off the y axis.
    assert touchdown.off_axis == pytest.approx(0.6)


SYMMETRIC = {"inertia": ((4.3, 0, 0), (0, 9.0, 0), (0, 0, 8.3)), "center_of_mass": (0.0, 0.0, 0.0)}
DOWN = (0.0, 0.0, -0.7)


def falls(feet, struck, **changes):
    """The touchdown of a symmetric machine that falls without turning, its first struck foot being the new contact."""
    base = base_of(linear=DOWN, angular=(0.0, 0.0, 0.0))
    first, *others = struck
    return landing(
        scene_of(**SYMMETRIC, **changes), base, feet, (), (first,), DOWN, together=dict.fromkeys(others, DOWN)
    )


@pytest.mark.parametrize("restitution", [0.0, 0.4])
def test_two_front_feet_that_land_together_pitch_the_machine_by_newton_and_euler(restitution):
    touchdown = falls(FEET, (0, 1), restitution=restitution)
    ahead, side = FEET[0][:2]
    # Both together push with one impulse at (ahead, 0): what it takes to turn the speed of the feet round.
    push = (1.0 + restitution) * -DOWN[2] / (1.0 / 83.0 + ahead**2 / 9.0)
    assert touchdown.impulses == (pytest.approx((0.5 * push, 0.0)), pytest.approx((0.5 * push, 0.0)))
    assert touchdown.linear == pytest.approx((0.0, 0.0, DOWN[2] + push / 83.0), abs=1e-12)
    assert touchdown.angular == pytest.approx((0.0, -ahead * push / 9.0, 0.0), abs=1e-12)
    assert Flag.BOTH_STRUCK in touchdown.flags
    assert touchdown.leftover == Leftover.DRIVEN
    assert (touchdown.old, touchdown.new) == ((1,), (0,))
    assert touchdown.half_distance == pytest.approx(side)


@pytest.mark.parametrize("struck", [(0, 3), (3, 0), (1, 2), (0, 1, 2, 3), (2, 3, 0, 1)])
def test_feet_that_land_together_around_the_mass_centre_stop_the_machine(struck):
    touchdown = falls(FEET, struck)
    assert touchdown.linear == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert touchdown.angular == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert touchdown.impulses[1][0] == pytest.approx(83.0 * 0.7 / len(struck))
    assert touchdown.energy_lost == pytest.approx(0.5 * 83.0 * 0.7**2)


def test_feet_that_land_together_make_one_impact_whichever_is_looked_at():
    source = np.random.default_rng(9)
    for _ in range(100):
        base = base_of(tuple(source.normal(size=3)), tuple(source.normal(size=3)))
        one, other = ((*source.normal(size=2), -source.uniform(0.1, 1.0)) for _ in range(2))
        scene = scene_of(friction=source.uniform(0.1, 1.0))
        here = landing(scene, base, FEET, (), (0,), one, together={3: other})
        there = landing(scene, base, FEET, (), (3,), other, together={0: one})
        if not (here.unique and there.unique):
            continue
        assert here.linear == pytest.approx(there.linear, abs=1e-11)
        assert here.angular == pytest.approx(there.angular, abs=1e-11)
        assert here.energy_lost == pytest.approx(there.energy_lost, abs=1e-10)
        assert here.impulses[0] == pytest.approx((there.impulses[1][0], -there.impulses[1][1]), abs=1e-10)
        before, after = (motion_of_mass_centre(scene, state.linear, state.angular) for state in (base, here))
        pushes = impulse_vectors(scene, base, here)
        assert scene.mass * (after[0] - before[0]) == pytest.approx(sum(pushes), abs=1e-10)
        arms = np.subtract([FEET[3], FEET[0]], scene.center_of_mass)
        turned = np.cross(arms, pushes).sum(axis=0)
        assert np.array(scene.inertia) @ (after[1] - before[1]) == pytest.approx(turned, abs=1e-10)
        for i, before in ((0, one), (3, other)):
            change = np.subtract(here.linear, base.linear) + np.cross(np.subtract(here.angular, base.angular), FEET[i])
            assert before[2] + change[2] > -1e-12


def test_standing_feet_that_the_others_press_into_the_ground_are_told_to_be_left_out():
    turns = {**SYMMETRIC, "inertia": ((4.3, 0, 0), (0, 4.0, 0), (0, 0, 8.3))}
    base = base_of(linear=DOWN, angular=(0.0, 0.0, 0.0))
    for inertia, pressed in ((turns, True), (SYMMETRIC, False)):
        touchdown = landing(scene_of(**inertia), base, FEET, (2, 3), (0,), DOWN, together={1: DOWN})
        assert (Leftover.OUT_OF_PLANE in touchdown.leftover) is pressed
        assert touchdown.old == (1,)


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_foot_that_lands_with_one_that_has_braked_turns_the_machine_about_it(restitution):
    scene, rest = scene_of(restitution=restitution), (0.0, 0.0, 0.0)
    touchdown = landing(scene, base_of(), FEET, (), (0,), DOWN, together={3: rest})
    assert touchdown == landing(scene._replace(law="total"), base_of(), FEET, (3,), (0,), DOWN)
    assert Flag.BOTH_STRUCK not in touchdown.flags
    other = landing(scene, base_of(), FEET, (), (3,), rest, together={0: DOWN})
    assert other.linear == pytest.approx(touchdown.linear, abs=1e-12)
    assert other.angular == pytest.approx(touchdown.angular, abs=1e-12)
