"""Rod, plate and cylinder: how they are made, and the point where all modes of the cylinder meet.

Their impacts are compared with the closed forms in test_closed_forms.py.
"""

import math

import pytest

from impact_predictor import Mode, cylinder, plate, rod, solve_impact
from impact_predictor.errors import InputError

EXACT = 1e-13
"""Of the speed before the impact: formula and solver do a few dozen roundings each, in well conditioned problems."""

W = 1.7


def test_all_four_modes_of_the_cylinder_meet_at_one_point_of_figure_7():
    gamma, friction, step = math.radians(60.0), 1.0 / math.sqrt(3.0), 1e-4
    meeting = cylinder(0.3, gamma, 2.0, friction)
    assert solve_impact(meeting, meeting.turning(-W)).twist == pytest.approx((0.0, 0.0, 0.0), abs=EXACT * W)
    modes = set()
    for angle in range(0, 360, 5):
        aside = math.radians(angle)
        body = cylinder(0.3, gamma + step * math.cos(aside), 2.0, friction + step * math.sin(aside))
        outcome = solve_impact(body, body.turning(-W))
        modes.add(outcome.mode)
        # All four are continuous there: a step aside changes the answer by a few steps.
        assert outcome.twist == pytest.approx((0.0, 0.0, 0.0), abs=10.0 * step * W)
    assert modes == {Mode.STOP, Mode.SLIDE, Mode.PIVOT, Mode.PIVOT_SLIDE}


def test_bodies_are_homogeneous_unless_told_otherwise():
    assert plate(2.0, 1.0, 12.0, 0.3).inertia == pytest.approx(5.0)
    assert rod(2.0, 0.1, 0.5, 0.5, 12.0, 0.3).inertia == pytest.approx(4.0)
    assert cylinder(2.0, 0.5, 3.0, 0.3).inertia == pytest.approx(6.0)
    assert plate(2.0, 1.0, 12.0, 0.3, inertia=1.5).inertia == 1.5


def test_contacts_lie_where_the_body_touches():
    body = plate(2.0, 1.0, 12.0, 0.3, a=0.4, restitution=0.2)
    assert (body.old.x, body.old.y, body.new.x, body.new.y) == (-0.4, -0.5, 1.0, -0.5)
    assert (body.old.restitution, body.new.restitution) == (0.0, 0.2)
    drum_body = cylinder(2.0, 0.5, 3.0, 0.3, gamma_new=0.9)
    for contact in (drum_body.old, drum_body.new):
        # The normal points to the axis.
        assert (contact.x, contact.y) == pytest.approx((-2.0 * contact.normal[0], -2.0 * contact.normal[1]))
    assert (drum_body.old.x, drum_body.new.x) == pytest.approx((-2.0 * math.sin(0.5), 2.0 * math.sin(0.9)))


def test_a_body_turns_about_its_old_contact():
    body = plate(2.0, 1.0, 12.0, 0.3)
    vx, vy, omega = body.turning(-1.5)
    assert (vx - omega * body.old.y, vy + omega * body.old.x) == (0.0, 0.0)
    with pytest.raises(ValueError, match="turns about nothing"):
        body._replace(old=None).turning(1.0)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: plate(0.0, 1.0, 1.0, 0.3), "length is 0.0"),
        (lambda: plate(1.0, math.inf, 1.0, 0.3), "height is inf"),
        (lambda: plate("1", 1.0, 1.0, 0.3), "length is '1'; give a finite number above 0"),
        (lambda: plate(1.0, 1.0, 1.0, None), "friction is None"),
        (lambda: plate(1.0, 1.0, -1.0, 0.3), "mass is -1.0"),
        (lambda: plate(1.0, 1.0, 1.0, -0.3), "friction is -0.3"),
        (lambda: plate(1.0, 1.0, 1.0, math.inf), "friction is inf"),
        (lambda: plate(1.0, 1.0, 1.0, 0.3, restitution=1.1), "restitution is 1.1"),
        (lambda: plate(1.0, 1.0, 1.0, 0.3, inertia=math.nan), "inertia is nan"),
        (lambda: plate(1.0, 1.0, 1.0, 0.3, a=-0.5, b=0.5), "a + b > 0"),
        (lambda: plate(1.0, 1.0, 1.0, 0.3, a=math.inf), "a is inf"),
        (lambda: rod(1.0, -0.1, 0.2, 0.2, 1.0, 0.3), "thickness is -0.1"),
        (lambda: rod(1.0, 0.1, math.nan, 0.2, 1.0, 0.3), "a is nan"),
        (lambda: cylinder(-1.0, 0.5, 1.0, 0.3), "radius is -1.0"),
        (lambda: cylinder(1.0, 0.0, 1.0, 0.3), "gamma"),
        (lambda: cylinder(1.0, math.nan, 1.0, 0.3), "gamma"),
        (lambda: cylinder(1.0, 0.5, 1.0, 0.3, gamma_new=math.inf), "gamma"),
        (lambda: cylinder(1.0, 0.5, 1.0, 0.3, inertia=0.0), "inertia is 0.0"),
    ],
)
def test_a_body_that_cannot_be_is_refused_with_one_sentence_that_names_the_number(make, named):
    with pytest.raises(InputError) as refusal:
        make()
    assert named in str(refusal.value)
    assert "\n" not in str(refusal.value)
