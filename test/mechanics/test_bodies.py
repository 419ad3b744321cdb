"""Rod, plate and cylinder: how they are made, and their impacts against the closed forms of the paper.

The closed forms (sections 2 to 4 of the paper, misprints corrected) hold without restitution for a body that turns
about the old contact, at rest, with the clockwise speed w. The domains of the modes are those of Fig. 5 and Fig. 7.
"""

import math

import pytest

from impact_predictor import Mode, cylinder, plate, rod, solve_impact
from impact_predictor.errors import InputError

EXACT = 1e-13
"""Of the speed before the impact: formula and solver do a few dozen roundings each, in well conditioned problems."""

W = 1.7


def block(a, b, h, rho_squared, f):
    """Mode, (vx, vy, omega), S_NA, S_NB and S_FA + S_FB of a plate or rod with mass 1; distance from the borders."""
    room = a * b - rho_squared - h * h
    borders = [abs(room)]
    if room >= 0.0:
        borders.append(abs(f * a - h))
        if f * a >= h:
            na, nb = W * room / (a + b), W * (a * a + h * h + rho_squared) / (a + b)
            return Mode.STOP, (0.0, 0.0, 0.0), na, nb, -W * h, min(borders)
    if room >= 0.0 or f * h * a <= a * b - rho_squared:
        borders.append(abs(f * h * a - a * b + rho_squared))
        na = W * (a * b - rho_squared - f * h * a) / (a + b)
        nb = W * (a * a + rho_squared + f * h * a) / (a + b)
        return Mode.SLIDE, (W * (h - f * a), 0.0, 0.0), na, nb, -f * (na + nb), min(borders)
    borders += [abs(f * h * a - a * b + rho_squared), abs(f * (rho_squared + h * h) - h * b)]
    if f * (rho_squared + h * h) < h * b:
        d = rho_squared + b * b - f * h * b
        w1 = W * (rho_squared + f * h * a - a * b) / d
        slip = W * (a + b) * (h * b - f * (rho_squared + h * h)) / d
        nb = W * rho_squared * (a + b) / d
        return Mode.PIVOT_SLIDE, (w1 * h + slip, w1 * b, -w1), 0.0, nb, -f * nb, min(borders)
    size = rho_squared + h * h + b * b
    w1 = -W * room / size
    nb = W * (rho_squared + h * h) * (a + b) / size
    return Mode.PIVOT, (w1 * h, w1 * b, -w1), 0.0, nb, -W * h * b * (a + b) / size, min(borders)


def drum(t, f):
    """Mode, (vx, vy, omega) R and distance from the borders of a cylinder of radius 1 with tan gamma = t."""
    sine, cosine = t / math.hypot(1.0, t), 1.0 / math.hypot(1.0, t)
    stops = t >= math.sqrt(3.0) and f >= (t - math.sqrt(t * t - 3.0)) / 3.0
    root = t - math.sqrt(max(t * t - 3.0, 0.0))
    distance = min(abs(t - math.sqrt(3.0)), abs(f - t / 3.0), abs(t - f - math.sqrt(1.0 + f * f)), abs(3.0 * f - root))
    if stops:
        return Mode.STOP, (0.0, 0.0, 0.0), distance
    if t < math.sqrt(3.0) and f >= t / 3.0:
        w1, slip, mode = W * (3.0 - t * t) / (3.0 * (1.0 + t * t)), 0.0, Mode.PIVOT
    elif f < t / 3.0 and t < f + math.sqrt(1.0 + f * f):
        w1 = W * (t * t - 4.0 * f * t + 1.0) / (1.0 + t * t)
        slip, mode = 2.0 * W * t * (3.0 * f - t) / (1.0 + t * t), Mode.PIVOT_SLIDE
    else:
        w1 = W * (1.0 + 3.0 * f * f - 2.0 * f * t) / (1.0 + f * f)
        return Mode.SLIDE, (0.0, 0.0, -w1), distance
    return mode, (w1 * cosine + slip * cosine, w1 * sine + slip * sine, -w1), distance


def assert_block(body, a, b, h, law):
    outcome = solve_impact(body, body.turning(-W), law)
    f = body.new.friction
    mode, twist, na, nb, friction, distance = block(a, b, h, body.inertia / body.mass, f)
    assert outcome.twist == pytest.approx(twist, abs=EXACT * W * (1.0 + h))
    (our_na, our_ta), (our_nb, our_tb) = outcome.impulses
    # Up to the common friction of two sticking contacts, whose shares are a choice, the impulses are determined.
    measured = [part / body.mass for part in (our_na, our_nb, our_ta + our_tb)]
    assert measured == pytest.approx([na, nb, friction], abs=EXACT * (1.0 + h) * W)
    if distance > 1e-9:
        assert outcome.mode is mode
        assert outcome.unique


GRID = [0.02 * k for k in range(1, 100, 3)]
RECTANGLE_BORDERS = [
    border(delta)
    for border in (lambda d: d, lambda d: (2.0 - d * d) / (3.0 * d), lambda d: 3.0 * d / (4.0 * d * d + 1.0))
    for delta in (0.3, 0.5, math.sqrt(0.5), 0.8, 1.2)
]


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("delta", [0.1, 0.3, 0.5, 0.7, math.sqrt(0.5), 0.72, 0.8, 1.0, 1.2, 1.6])
def test_a_rectangle_strikes_the_floor_as_in_figure_5(delta, law):
    for friction in [0.0, *GRID, *RECTANGLE_BORDERS]:
        if friction >= 0.0:
            assert_block(plate(length=1.0, height=delta, mass=3.0, friction=friction), 0.5, 0.5, 0.5 * delta, law)


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize(
    ("a", "b", "rho_squared"), [(0.2, 0.7, 0.1), (0.7, 0.2, 0.1), (0.9, 0.4, 0.02), (0.05, 1.0, 0.3)]
)
def test_a_plate_with_its_mass_off_the_middle_strikes_as_the_closed_forms_say(a, b, rho_squared, law):
    for height in (0.1, 0.4, 0.9):
        for friction in [0.0, *GRID]:
            body = plate(1.0, height, 3.0, friction, inertia=3.0 * rho_squared, a=a, b=b)
            assert_block(body, a, b, 0.5 * height, law)


@pytest.mark.parametrize("law", ["path", "total"])
def test_a_slender_rod_stops_only_if_its_supports_are_far_enough_apart(law):
    length = 0.4
    for a in (0.02, 0.09, 0.11, 0.1154, 0.1156, 0.13, 0.19):
        for b in (0.05, a, 0.2):
            for thickness in (0.0, 0.002):
                body = rod(length, thickness, a, b, mass=0.3, friction=0.4)
                assert_block(body, a, b, 0.5 * thickness, law)
            body = rod(length, 0.0, a, b, mass=0.3, friction=0.4)
            outcome = solve_impact(body, body.turning(-W), law)
            stops = 12.0 * a * b > length * length
            assert outcome.mode is (Mode.STOP if stops else Mode.PIVOT)
            if not stops:
                ratio = (length**2 - 12.0 * a * b) / (length**2 + 12.0 * b**2)
                assert -outcome.twist.omega / W == pytest.approx(ratio, abs=EXACT)


@pytest.mark.parametrize("law", ["path", "total"])
def test_a_cylinder_strikes_an_edge_as_in_figure_7(law):
    modes = set()
    for gamma in [math.radians(angle) for angle in (5, 20, 35, 50, 58, 59.5, 60, 60.5, 62, 66, 72, 80, 85)]:
        for friction in [0.0, *GRID, 1.0 / math.sqrt(3.0), math.tan(gamma) / 3.0]:
            body = cylinder(radius=0.3, gamma=gamma, mass=2.0, friction=friction)
            outcome = solve_impact(body, body.turning(-W), law)
            mode, (vx, vy, omega), distance = drum(math.tan(gamma), friction)
            # tan gamma multiplies the roundings of the geometry.
            close = EXACT * W * (1.0 + math.tan(gamma))
            assert outcome.twist == pytest.approx((0.3 * vx, 0.3 * vy, omega), abs=close)
            if distance > 1e-9:
                assert outcome.mode is mode
                modes.add(mode)
    assert modes == {Mode.STOP, Mode.SLIDE, Mode.PIVOT, Mode.PIVOT_SLIDE}


def test_a_cylinder_that_rolls_over_an_edge_gets_the_impulses_of_the_closed_forms():
    t, mass, radius = math.tan(0.7), 2.0, 0.3
    body = cylinder(radius, 0.7, mass, friction=0.6)
    normal, friction = solve_impact(body, body.turning(-W)).impulses[1]
    assert normal == pytest.approx(mass * W * radius * 2.0 * t / (1.0 + t * t), rel=EXACT)
    assert friction == pytest.approx(mass * W * radius * 2.0 * t * t / (3.0 * (1.0 + t * t)), rel=EXACT)


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
        (lambda: plate(1.0, 1.0, -1.0, 0.3), "mass is -1.0"),
        (lambda: plate(1.0, 1.0, 1.0, -0.3), "friction is -0.3"),
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
