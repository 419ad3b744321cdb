"""One impact of one body: one contact, both struck, restitution, shared friction, answers that are not unique."""

import math

import pytest
from seen_by_contacts import contact_velocity

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, Validity, cylinder, plate, rod, solve_impact

CLOSE = 1e-11
"""Of the largest contact speed: conditioning of up to 1e4 times a few dozen roundings."""


def test_a_new_contact_that_is_not_approached_changes_nothing():
    body = plate(1.0, 0.4, 10.0, 0.3)
    for omega in (0.0, 0.5):
        outcome = solve_impact(body, body.turning(omega))
        assert outcome.mode is Mode.NO_IMPACT
        assert outcome.twist == body.turning(omega)
        assert outcome.impulses == ((0.0, 0.0), (0.0, 0.0))
        assert (outcome.segments, outcome.flags, outcome.energy_lost) == ((), Flag.NONE, 0.0)


def test_two_contacts_struck_at_once_are_left_to_the_total_law():
    body = plate(1.0, 0.4, 10.0, 0.3)
    falling = Twist(0.2, -1.0, -0.1)
    outcome = solve_impact(body, falling)
    assert outcome.law == "total"
    assert outcome.flags & Flag.BOTH_STRUCK
    assert outcome.twist == solve_impact(body, falling, "total").twist
    assert not solve_impact(body, falling, "total").flags & Flag.BOTH_STRUCK
    # A level fall on a floor without slip stops a wide plate at once.
    assert solve_impact(body, Twist(0.0, -1.0, 0.0)).twist == pytest.approx((0.0, 0.0, 0.0), abs=CLOSE)


def test_newtons_restitution_returns_the_approach_of_each_struck_contact():
    body = plate(1.0, 0.4, 10.0, 0.0)
    body = body._replace(old=body.old._replace(restitution=0.3), new=body.new._replace(restitution=0.6))
    falling = Twist(0.2, -1.0, -0.1)
    outcome = solve_impact(body, falling, "total")
    for contact, restitution in ((body.old, 0.3), (body.new, 0.6)):
        before, after = (contact_velocity(contact, twist)[0] for twist in (falling, outcome.twist))
        assert after == pytest.approx(-restitution * before, rel=CLOSE)


def test_the_restitution_of_an_old_contact_at_rest_is_ignored_and_said_so():
    body = plate(1.0, 0.4, 10.0, 0.3)
    bouncy = body._replace(old=body.old._replace(restitution=0.8))
    for law in ("path", "total"):
        plain, flagged = (solve_impact(each, body.turning(-1.0), law) for each in (body, bouncy))
        assert not plain.flags & Flag.OLD_RESTITUTION_IGNORED
        assert flagged == plain._replace(flags=plain.flags | Flag.OLD_RESTITUTION_IGNORED, body=bouncy)


def test_an_old_contact_that_already_leaves_is_out_of_the_impact():
    body = plate(1.0, 0.4, 10.0, 0.3)
    leaving = Twist(0.3, 0.6, -2.0)
    assert contact_velocity(body.old, leaving)[0] > 0.0
    bouncy = body._replace(old=body.old._replace(restitution=0.5))
    for law in ("path", "total"):
        alone = solve_impact(body._replace(old=None), leaving, law)
        for each in (body, bouncy):
            assert solve_impact(each, leaving, law).twist == pytest.approx(alone.twist, abs=CLOSE)
    pressed = Twist(0.3, -0.4, -1.0)
    # Slower, it is closed again by the impulse at the new contact, and stays.
    for law in ("path", "total"):
        after = solve_impact(bouncy, pressed, law).twist
        assert contact_velocity(body.old, after)[0] == pytest.approx(0.0, abs=CLOSE)


def test_an_old_contact_that_comes_back_just_as_the_compression_ends_is_pressed_from_then_on():
    smooth = Contact(-1.0, 0.0, 0.0)
    body = TwoPointBody(1.0, 0.5, old=smooth, new=smooth._replace(x=1.0, restitution=0.5))
    # An impulse of 1 stops the new contact, at 3 m/s, and brings the old one back, which leaves at 1 m/s.
    outcome = solve_impact(body, Twist(1.0, -1.0, -2.0))
    assert [normal for normal, _ in outcome.impulses] == pytest.approx([1.0 / 6.0, 1.5], rel=CLOSE)
    after = [contact_velocity(contact, outcome.twist)[0] for contact in (body.old, body.new)]
    assert after == pytest.approx([0.0, 4.0 / 3.0], abs=CLOSE)


def test_two_sticking_contacts_share_friction_with_the_least_push_between_them():
    shares = {}
    for friction in (0.9, 0.45):
        body = plate(1.0, 0.4, 10.0, friction)
        outcome = solve_impact(body, body.turning(-1.0))
        assert outcome.mode is Mode.STOP
        assert outcome.flags & Flag.SHARED_FRICTION
        shares[friction] = outcome.impulses
    (_, t_old), (_, t_new) = shares[0.9]
    assert t_old == pytest.approx(t_new) == pytest.approx(-1.0)
    # With less friction the old contact, which is pressed less, gives all that it has.
    (n_old, t_old), (_, t_new) = shares[0.45]
    assert t_old == pytest.approx(-0.45 * n_old)
    assert t_old + t_new == pytest.approx(-2.0)


def test_contacts_that_lock_a_body_between_parting_supports_push_no_more_than_the_impulse_path_does():
    # The supports move along the line of the contacts, so that a push along it would do work on the body.
    friction = 3.5515415522
    away, along = (-1.0730894431, -0.7665511523), (0.0847138886, -1.7347607377)
    old = Contact(-0.9700825128, -0.9066655917, friction, (0.8067893330, 0.5908392101), velocity=away)
    new = Contact(0.8882888901, -1.5238547451, friction, (-0.5657579758, -0.8245713510), 1.0, along)
    body = TwoPointBody(mass=6.9022259719, inertia=3.7484073131, old=old, new=new)
    outcome = solve_impact(body, Twist(-0.8756105166, 1.2887165346, 1.1692605588))
    assert outcome.segments[-1] == "SS"
    assert Flag.WORK_LIMITED in outcome.flags
    assert not outcome.flags & (Flag.SHARED_FRICTION | Flag.ENERGY_GAINED)
    assert outcome.energy_lost > 0.0
    assert contact_velocity(body.new, outcome.twist)[0] > 0.1


def test_a_cylinder_that_could_also_lock_itself_in_the_wedge_pivots_and_says_so():
    # tan gamma < sqrt 3, but friction above tan(gamma / 2) holds a body in the wedge for ever.
    body = cylinder(radius=0.3, gamma=0.9, mass=2.0, friction=1.5)
    path, total = (solve_impact(body, body.turning(-1.0), law) for law in ("path", "total"))
    assert path.mode is total.mode is Mode.PIVOT
    assert total.twist == pytest.approx(path.twist, abs=CLOSE)
    assert (path.unique, total.unique) == (True, False)
    assert [(other.mode, other.segments) for other in total.alternatives] == [(Mode.STOP, ("SS",))]
    assert total.alternatives[0].twist == pytest.approx((0.0, 0.0, 0.0), abs=CLOSE)


def test_where_newtons_restitution_has_no_answer_the_impact_is_plastic_and_says_so():
    # Two facing walls that do not let the body out as fast as the new contact would have to leave.
    old = Contact(-1.0, -1.0, 1.0, (-math.sin(2.0), math.cos(2.0)))
    body = TwoPointBody(1.0, 1.0, old, Contact(1.0, 0.0, 2.0, restitution=1.0))
    outcome = solve_impact(body, body.turning(-1.0), "total")
    assert outcome.flags & Flag.LAST_RESORT
    plastic = body._replace(new=body.new._replace(restitution=0.0))
    assert outcome.twist == solve_impact(plastic, body.turning(-1.0), "total").twist
    for contact in (body.old, body.new):
        assert contact_velocity(contact, outcome.twist)[0] >= -CLOSE


def test_normals_are_made_unit_before_they_are_used():
    body = plate(1.0, 0.4, 10.0, 0.3)
    old, new = (
        each._replace(normal=(0.0, length)) for each, length in ((body.old, 1.0 + 4e-7), (body.new, 1.0 - 4e-7))
    )
    rounded = body._replace(old=old, new=new)
    twist = body.turning(-1.0)
    assert solve_impact(rounded, twist).twist == pytest.approx(solve_impact(body, twist).twist, abs=CLOSE)


def falling_block(speed):
    """A block that turns about its old edge and strikes with this speed (m/s) at the new one, a metre away."""
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    return body, body.turning(omega=-speed)


def test_an_impact_that_gravity_outweighs_while_it_lasts_is_flagged_as_slow():
    body, twist = falling_block(1.0)
    normal = solve_impact(body, twist).impulses[1][0]
    # The impulse is proportional to the speed: this speed makes gravity's a quarter of it.
    border = body.mass * 9.81 * 5e-3 / (0.25 * normal)
    assert solve_impact(*falling_block(0.999 * border)).flags & Flag.SLOW_IMPACT
    assert not solve_impact(*falling_block(1.001 * border)).flags & Flag.SLOW_IMPACT


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_thickness_over_length_decides_whether_a_rod_is_thin(scale):
    for thickness, thin in ((0.0099, True), (0.0101, False)):
        body = rod(length=scale, thickness=thickness * scale, a=0.2 * scale, b=0.3 * scale, mass=2.0, friction=0.4)
        assert bool(solve_impact(body, body.turning(omega=-1.0)).flags & Flag.THIN_BODY) is thin
        everyone = solve_impact(body, body.turning(omega=-1.0), validity=Validity(slenderness=0.02))
        assert everyone.flags & Flag.THIN_BODY
