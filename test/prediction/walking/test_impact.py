"""The impact of landing feet: the laws of mechanics, in any frame, and the planar impact where it is one."""

import sys
from math import cos, sin

import numpy as np
import pytest

from impact_predictor import Mode, solve_impact
from impact_predictor.mechanics.impact import spatial
from impact_predictor.mechanics.types import Contact, ContactState, Flag, Twist, TwoPointBody
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Leftover, Sample, Status
from impact_predictor.prediction.vectors import add, axes_of, cross, to_world
from impact_predictor.prediction.walking.impact import LandingPoint, touchdown_of
from impact_predictor.prediction.walking.machine import RigidMachine

FEET = ((0.31, 0.29, -0.58), (0.31, -0.29, -0.58), (-0.31, 0.29, -0.58), (-0.31, -0.29, -0.58))
LEVEL = (0.0, 0.0, 0.0, 1.0)
STEPS = 1e-3
"""The law follows a plastic impact in steps, which err by less than this part of its speeds; an elastic one ..."""
OF_RESTITUTION = 2e-2


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


def landing(scene, base, feet, stood, new, velocity, together=None, delays=None, machine=None, rates=(0.0,) * 6):
    """The touchdown of feet in the base's frame; those that land `together` with the new one have their velocities."""
    delays, axes = delays or {}, axes_of(base.orientation)
    struck = {**dict.fromkeys(new, velocity), **(together or {})}
    return touchdown_of(
        scene,
        machine or RigidMachine(scene),
        base,
        places=[add(base.position, to_world(axes, foot)) for foot in feet],
        stood=stood,
        new=new,
        landing={i: LandingPoint(one, delays.get(i, 0.0)) for i, one in struck.items()},
        lead_time=0.05,
        rates=rates,
    )


def motion_of_mass_centre(scene, linear, angular):
    return np.array(linear) + np.cross(angular, scene.center_of_mass), np.array(angular)


def in_base(base, touchdown):
    """Of each contact the foot, and its impulse and its velocity after the impact as vectors of the base's frame."""
    axes = np.array(axes_of(base.orientation))
    return [(one.point, axes @ one.impulse, axes @ one.velocity) for one in touchdown.contacts]


def landings(count, seed, **changes):
    source = np.random.default_rng(seed)
    for _ in range(count):
        case = random_landing(source, **changes)
        yield case, landing(*case)


def test_a_landing_keeps_the_momentum_balance_about_any_point():
    source = np.random.default_rng(1)
    for (scene, base, feet, *_), touchdown in landings(200, seed=2):
        before = motion_of_mass_centre(scene, base.linear, base.angular)
        after = motion_of_mass_centre(scene, touchdown.linear, touchdown.angular)
        pushes = [(feet[i], push) for i, push, _ in in_base(base, touchdown)]
        momentum = scene.mass * (after[0] - before[0])
        assert momentum == pytest.approx(sum(push for _, push in pushes), abs=1e-11)  # rounding of about 100 N s
        about = source.normal(size=3)
        turned = np.array(scene.inertia) @ (after[1] - before[1])
        turned += np.cross(np.array(scene.center_of_mass) - about, momentum)
        assert turned == pytest.approx(sum(np.cross(place - about, push) for place, push in pushes), abs=1e-11)


def test_no_foot_is_driven_into_the_ground_and_impulses_are_in_their_cones():
    modes = set()
    for (scene, base, feet, old, new, velocity), touchdown in landings(400, seed=3):
        before = np.array(axes_of(base.orientation)) @ velocity
        for i, (x, y, normal), after in in_base(base, touchdown):
            assert np.hypot(x, y) <= scene.friction * normal + 1e-10
            assert normal >= 0.0
            assert after[2] >= -1e-9
            # Legs without mass move on: a foot gets what the twist of the base changes where it is.
            change = np.subtract(touchdown.linear, base.linear)
            change += np.cross(np.subtract(touchdown.angular, base.angular), feet[i])
            assert after == pytest.approx(change + (before if i in new else 0.0), abs=1e-11)
        assert [(one.point, one.is_new) for one in touchdown.contacts] == sorted((i, i in new) for i in old + new)
        modes.add(touchdown.mode)
    assert {Mode.SLIDE, Mode.PIVOT, Mode.PIVOT_SLIDE} <= modes


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_landing_loses_the_kinetic_energy_that_it_says_it_loses(restitution):
    for (scene, base, _, old, *_), touchdown in landings(200, seed=4, restitution=restitution):
        if len(old) > 1:
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
    # The path law errs by its steps, the other one by its sweeps.
    near = {"path": 1e-5, "total": 1e-10}[law]
    assert touchdown.after == pytest.approx(expected.twist, abs=near)
    assert touchdown.energy_lost == pytest.approx(expected.energy_lost, abs=near)
    assert np.array(touchdown.impulses) == pytest.approx(np.array(expected.impulses), abs=near)
    assert touchdown.axis == pytest.approx((0.0, 1.0, 0.0))
    assert touchdown.linear == pytest.approx((expected.twist.vx, 0.0, expected.twist.vy), abs=near)
    assert touchdown.angular == pytest.approx((0.0, -expected.twist.omega, 0.0), abs=near)
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


def test_a_toe_strikes_about_the_heel_of_its_own_foot_while_every_foot_that_stands_is_a_contact():
    scene = scene_of(walking=Walking(("left", "right"), points=2))
    touchdown = landing(scene, base_of(), FEET, (0, 1, 2), (3,), (0.0, 0.0, -0.2))
    assert touchdown.old == (2,)
    assert [one.point for one in touchdown.contacts] == [0, 1, 2, 3]
    assert min(one.velocity[2] for one in touchdown.contacts) > -1e-9
    assert touchdown.leftover == Leftover.DRIVEN


def test_a_body_with_next_to_no_inertia_is_answered_or_flagged():
    for inertia in (1e-9, 1e-6, 1e-3):
        tensor = (inertia, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia)
        scene = scene_of(mass=20.0, inertia=tensor, friction=0.405, walking=Walking(("left", "right")))
        feet = (3e-17, 0.5, -0.49999999999887373), (-9e-17, -0.5, -0.5)
        rest = base_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.5))
        touchdown = landing(scene, rest, feet, (1,), (0,), (0.0, 0.0, -0.6666655474983967))
        sinks = min(one.velocity[2] for one in touchdown.contacts) < -1e-9
        assert bool(touchdown.flags & Flag.NOT_CONVERGED) is sinks
        assert np.all(np.isfinite((touchdown.linear, touchdown.angular)))


def test_a_trunk_with_four_feet_on_the_ground_shares_its_impulses_as_the_solver_chooses():
    scene, rest = scene_of(**SYMMETRIC, friction=2.0), base_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    falling = dict.fromkeys((1, 2, 3), DOWN)
    for feet, shares in ((FEET, True), (((0.02, 0.01, -0.58), *FEET[1:]), False)):
        touchdown = landing(scene, rest, feet, (), (0,), DOWN, together=falling if shares else None)
        assert bool(touchdown.flags & Flag.SHARED_FRICTION) is shares


@pytest.mark.parametrize(("told", "expected"), [((0.1, 0.2, 0.3, 0.4), (0.1, 0.2, 0.3, 0.4)), ((0.25,), (0.25,) * 4)])
def test_each_foot_has_its_own_friction_and_restitution(told, expected):
    walking = Walking(("LF", "RF", "LH", "RH"), friction=told, restitution=told)
    scene, touching = scene_of(walking=walking), ((0.0, 0.0, -0.58),) * 4
    for foot, number in enumerate(expected):
        slips = (3.0, 0.0, -1.0)
        (one,) = landing(scene_of(**SYMMETRIC, walking=walking), base_of(), touching, (), (foot,), slips).contacts
        assert one.state is ContactState.LEAVES
        assert one.velocity[2] == pytest.approx(number, abs=OF_RESTITUTION)
        assert one.impulse[0] == pytest.approx(-number * one.impulse[2])
        # Where nothing is told of the feet, they are as every other contact.
        plain = scene._replace(walking=Walking(walking.feet), friction=number, restitution=number)
        same = [landing(one, base_of(), FEET, (), (foot,), slips) for one in (scene, plain)]
        assert same[0] == same[1]


def test_a_foot_that_lands_a_little_later_strikes_what_the_first_one_has_left():
    def strike(delay):
        return landing(scene_of(**SYMMETRIC), base_of(), FEET, (), (0,), DOWN, {3: DOWN}, {3: delay})

    at_once, soon, later = (strike(delay) for delay in (0.0, 1e-6, 4e-3))
    assert soon.linear == pytest.approx(at_once.linear, abs=2e-3)
    assert soon.angular == pytest.approx(at_once.angular, abs=2e-3)
    # The first one stops before the other strikes, and is lifted by that.
    first, second = later.contacts
    assert first.velocity[2] > 0.1
    assert second.velocity[2] == pytest.approx(0.0, abs=STEPS)
    assert later.mode is Mode.BACK_PIVOT


def test_the_corners_of_a_sole_that_strike_together_tell_how_far_apart_they_close():
    scene = scene_of(walking=Walking(("left", "right"), points=2))
    touchdown = landing(scene, base_of(), FEET, (0, 1), (2, 3), (0.0, 0.0, -0.2), delays={3: 0.004})
    assert touchdown.closing_spread == pytest.approx(0.004)


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
        is_rigid = False

        def struck(self, points, contacts, axes, scene, pulls):
            assert pulls == [(0.0, -z, y - 1.0) for _, y, z in contacts.positions]
            return Status.SINGULAR_INERTIA

    rates = (0.0, 0.0, -1.0, 1.0, 0.0, 0.0)
    found = landing(scene_of(), base_of(), FEET, (1, 2), (0,), (0.0, 0.0, -0.2), machine=Unknown(), rates=rates)
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


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.6])
def test_two_front_feet_that_land_together_pitch_the_machine_as_one_contact_of_its_plane(friction):
    touchdown = falls(FEET, (0, 1), friction=friction)
    ahead, side, down = FEET[0]
    body = TwoPointBody(83.0, 9.0, None, Contact(ahead, down, friction))
    expected = solve_impact(body, Twist(0.0, DOWN[2], 0.0))
    assert touchdown.linear == pytest.approx((expected.twist.vx, 0.0, expected.twist.vy), abs=STEPS)
    assert touchdown.angular == pytest.approx((0.0, -expected.twist.omega, 0.0), abs=STEPS)
    pushes = np.sum([one.impulse for one in touchdown.contacts], axis=0)
    normal, tangent = expected.impulses[1]
    assert pushes == pytest.approx((tangent, 0.0, normal), rel=STEPS, abs=STEPS)
    assert [one.is_new for one in touchdown.contacts] == [True, True]
    assert touchdown.leftover == Leftover.DRIVEN
    assert (touchdown.old, touchdown.new) == ((1,), (0,))
    assert touchdown.half_distance == pytest.approx(side)


@pytest.mark.parametrize("struck", [(0, 3), (3, 0), (1, 2), (0, 1, 2, 3), (2, 3, 0, 1)])
def test_feet_that_land_together_around_the_mass_centre_stop_the_machine(struck):
    touchdown = falls(FEET, struck)
    assert touchdown.mode is Mode.STOP
    assert touchdown.linear == pytest.approx((0.0, 0.0, 0.0), abs=STEPS)
    assert touchdown.angular == pytest.approx((0.0, 0.0, 0.0), abs=STEPS)
    # How four feet share it is the solver's choice.
    assert sum(one.impulse[2] for one in touchdown.contacts) == pytest.approx(83.0 * 0.7, rel=STEPS)
    assert touchdown.impulses[1][0] == pytest.approx(83.0 * 0.7 / len(struck), rel=0.01)
    assert touchdown.energy_lost == pytest.approx(0.5 * 83.0 * 0.7**2, rel=STEPS)


def test_feet_that_land_together_make_one_impact_whichever_is_looked_at():
    source = np.random.default_rng(9)
    for _ in range(100):
        base = base_of(tuple(source.normal(size=3)), tuple(source.normal(size=3)))
        one, other = ((*source.normal(size=2), -source.uniform(0.1, 1.0)) for _ in range(2))
        scene = scene_of(friction=source.uniform(0.1, 1.0))
        here = landing(scene, base, FEET, (1,), (0,), one, together={3: other})
        there = landing(scene, base, FEET, (1,), (3,), other, together={0: one})
        assert here.contacts == there.contacts
        assert (here.old, here.new) == (there.new, there.old) == ((3,), (0,))
        assert (here.linear, here.angular, here.energy_lost) == (there.linear, there.angular, there.energy_lost)
        assert here.impulses[0] == pytest.approx((there.impulses[1][0], -there.impulses[1][1]), abs=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_foot_that_lands_with_one_that_has_braked_turns_the_machine_about_it(restitution):
    scene, rest = scene_of(restitution=restitution), (0.0, 0.0, 0.0)
    touchdown = landing(scene, base_of(), FEET, (), (0,), DOWN, together={3: rest})
    stands = landing(scene, base_of(), FEET, (3,), (0,), DOWN)
    assert (touchdown.linear, touchdown.angular, touchdown.mode) == (stands.linear, stands.angular, stands.mode)
    other = landing(scene, base_of(), FEET, (), (3,), rest, together={0: DOWN})
    assert (other.linear, other.angular) == (touchdown.linear, touchdown.angular)
    assert other.impulses[0][0] == pytest.approx(touchdown.impulses[1][0])


def test_every_landing_has_the_same_bits_with_numba_and_without(monkeypatch):
    here = [touchdown for _, touchdown in landings(20, seed=11, restitution=0.3)]
    monkeypatch.setitem(sys.modules, "numba", None)  # an import of it fails
    spatial.solver.cache_clear()
    try:
        assert [touchdown for _, touchdown in landings(20, seed=11, restitution=0.3)] == here
    finally:
        spatial.solver.cache_clear()


def test_a_thin_plate_whose_inertia_was_rounded_is_struck_as_any_other_body():
    for zz, flag in ((0.2, False), (0.202, False), (0.22, True)):
        scene = scene_of(mass=5.0, inertia=((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, zz)))
        touchdown = landing(scene, base_of(), FEET, (1, 2, 3), (0,), (0.0, 0.0, -0.5))
        assert bool(touchdown.flags & Flag.INVALID_INPUT) is flag
