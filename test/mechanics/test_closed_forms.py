"""The closed forms against the general solver: dense maps of every body, both laws, borders included.

Maps are 300 x 300, so that a border of either law that is off by 1 % of a map shows in hundreds of points.
"""

import math

import numpy as np
import pytest

from impact_predictor import Mode, solve_impacts
from impact_predictor.errors import InputError
from impact_predictor.mechanics import bodies, closed_forms
from impact_predictor.mechanics.closed_forms import cylindrical, flat

EXACT = 1e-13
"""Of the speeds and impulses: formula and solver do a few dozen roundings each, in well conditioned problems."""

ASIDE = 1e-9
"""A point nearer to a border than this part of its friction and its geometry may be given the mode beyond it."""

W = 1.7
LAWS = ("path", "total")
STOP, SLIDE, PIVOT_SLIDE, PIVOT = MODES = Mode.STOP, Mode.SLIDE, Mode.PIVOT_SLIDE, Mode.PIVOT

down = np.linspace(0.005, 1.0, 300)[:, np.newaxis]
right = np.linspace(0.0, 1.0, 300)
"""The two directions of a map."""

MAPS = {
    # Fig. 5
    "rectangle": ("plate", "height", {"length": 1.0, "height": 2.0 * down, "mass": 3.0, "friction": 2.0 * right}),
    "mass ahead": (
        "plate",
        "height",
        {"length": 1.0, "height": 2.0 * down, "mass": 3.0, "friction": 3.0 * right, "a": 0.7, "b": 0.2, "inertia": 0.1},
    ),
    "supports beyond the ends": (
        "plate",
        "a",
        {"length": 1.0, "height": 0.6, "mass": 3.0, "friction": right, "a": 3.0 * down, "b": 1.1, "inertia": 0.9},
    ),
    "slender rod": (
        "rod",
        "a",
        {"length": 0.4, "thickness": 0.0, "a": 0.2 * down, "b": 0.2 * down.T, "mass": 0.3, "friction": 0.4},
    ),
    "thick rod": (
        "rod",
        "a",
        {"length": 0.4, "thickness": 0.08, "a": 0.2 * down, "b": 0.11, "mass": 0.3, "friction": 0.8 * right},
    ),
    # Fig. 7
    "cylinder": ("cylinder", "gamma", {"radius": 0.3, "gamma": 1.56 * down, "mass": 2.0, "friction": 3.0 * right}),
    "cylinder on a step": (
        "cylinder",
        "gamma",
        {"radius": 0.3, "gamma": 2.2 * down - 0.4, "gamma_new": 0.9, "mass": 2.0, "friction": 2.0 * right},
    ),
    **{
        f"cylinder of inertia {k}": (
            "cylinder",
            "gamma",
            {"radius": 2.0, "gamma": 1.56 * down, "mass": 0.5, "inertia": 2.0 * k, "friction": 3.0 * right},
        )
        for k in (0.02, 0.4, 0.5 - 1e-6, 0.6, 1.0, 1.5)
    },
}


@pytest.fixture(scope="module", params=MAPS)
def case(request):
    return request.param


@pytest.fixture(scope="module", params=LAWS)
def law(request):
    return request.param


@pytest.fixture(scope="module")
def outcomes(case, law):
    """What the general solver answers over a map."""
    name, _, numbers = MAPS[case]
    return solved(name, numbers, law)


def solved(name, numbers, law):
    """What the general solver answers for a body, by the arguments of its builder."""
    body = getattr(bodies, name)(**numbers)
    return solve_impacts(body, body.turning(-W), law=law)


def closed(name, numbers):
    # A division by zero, an overflow or a nan is an error, in a branch that is not used too.
    with np.errstate(all="raise", under="ignore"):
        return getattr(closed_forms, name)(**numbers, omega=-W)


def assert_same(ours, outcomes):
    reach = np.abs(outcomes.twist).max(initial=W)
    assert np.abs(ours.twist - outcomes.twist).max() <= EXACT * reach
    largest = np.abs(outcomes.impulses).max(axis=(-1, -2), keepdims=True)
    assert (np.abs(ours.impulses - outcomes.impulses) <= EXACT * largest).all()


def modes_around(name, numbers, geometry):
    """The modes of the closed forms in a point and a little aside, in each direction."""
    points = [numbers]
    for key in ("friction", geometry):
        points += [{**numbers, key: numbers[key] * (1.0 + side * ASIDE)} for side in (-1.0, 1.0)]
    return [closed(name, point).mode for point in points]


def tangent(numbers):
    """tan(gamma) of a cylinder whose edges may lie at two angles."""
    return np.tan(0.5 * (numbers["gamma"] + numbers.get("gamma_new", numbers["gamma"])))


def test_velocities_impulses_and_modes_are_those_of_the_general_solver(case, outcomes):
    name, geometry, numbers = MAPS[case]
    assert_same(closed(name, numbers), outcomes)
    assert np.logical_or.reduce([mode == outcomes.mode for mode in modes_around(name, numbers, geometry)]).all()


def test_only_the_total_law_has_two_answers_and_only_where_edges_lock_a_cylinder(case, law, outcomes):
    name, _, numbers = MAPS[case]
    if law == "total" and name == "cylinder":
        # The other answer is STOP.
        locks = cylindrical.locks(tangent(numbers), numbers["friction"])
        assert (outcomes.unique == (~locks | (outcomes.mode == STOP))).all()
        assert not outcomes.unique.all()
    else:
        assert outcomes.unique.all()


FLAT_BORDERS = {
    flat.stop_friction: (SLIDE, STOP),
    flat.lift_friction: (SLIDE, PIVOT_SLIDE),
    flat.pivot_friction: (PIVOT_SLIDE, PIVOT),
}
CYLINDER_BORDERS = {
    cylindrical.stop_friction: (SLIDE, STOP),
    cylindrical.spin_friction: (STOP, SLIDE),
    cylindrical.lift_friction: (SLIDE, PIVOT_SLIDE),
    cylindrical.pivot_friction: (PIVOT_SLIDE, PIVOT),
}


def assert_border(name, numbers, friction, modes):
    """On the border all agree, and a little below and above it the modes are these."""
    for law in LAWS:
        on = {**numbers, "friction": friction}
        assert_same(closed(name, on), solved(name, on, law))
        for side, mode in zip((-1.0, 1.0), modes, strict=True):
            beside = {**numbers, "friction": friction * (1.0 + 1e-6 * side)}
            assert (closed(name, beside).mode == mode).all()
            assert (solved(name, beside, law).mode == mode).all()


@pytest.mark.parametrize("border", FLAT_BORDERS, ids=lambda border: border.__name__)
@pytest.mark.parametrize(("a", "b"), [(0.5, 0.5), (0.3, 0.6), (0.8, 0.4)])
def test_a_border_of_the_plate_lies_between_its_two_modes(border, a, b):
    delta = np.linspace(0.01, 2.0, 500)
    friction = border(flat.rectangle(delta, a, b))
    on = friction > 0.01
    assert 50 < on.sum() < 500
    assert_border(
        "plate", {"length": 1.0, "height": delta[on], "mass": 2.0, "a": a, "b": b}, friction[on], FLAT_BORDERS[border]
    )


@pytest.mark.parametrize("border", FLAT_BORDERS, ids=lambda border: border.__name__)
def test_a_border_of_the_rod_lies_between_its_two_modes(border):
    a, b = 0.2 * np.linspace(0.01, 1.0, 500), 0.13
    friction = border(flat.bar(0.4, 0.05, a, b))
    on = friction > 0.01
    # Supports between which a rod can slide but not stop lie in a narrow band.
    assert 5 < on.sum() < 500
    numbers = {"length": 0.4, "thickness": 0.05, "a": a[on], "b": b, "mass": 0.3}
    assert_border("rod", numbers, friction[on], FLAT_BORDERS[border])


@pytest.mark.parametrize("border", CYLINDER_BORDERS, ids=lambda border: border.__name__)
@pytest.mark.parametrize("k", [0.1, 0.5, 0.6, 1.0, 1.5])
def test_a_border_of_the_cylinder_lies_between_its_two_modes(border, k):
    # In a deeper wedge the push between edges that lock, which goes with 1 / (f t - 1), loses more digits than EXACT.
    gamma = np.linspace(0.01, 1.5, 5000)
    friction = border(np.tan(gamma), k)
    # A millionth of less friction than that is less than the solver takes for a change of mode.
    on = friction > 0.01
    if border is cylindrical.spin_friction and k <= 0.5:
        assert not on.any()
        return
    assert on.sum() > 10
    numbers = {"radius": 0.3, "gamma": gamma[on], "mass": 2.0, "inertia": k * 2.0 * 0.09}
    assert_border("cylinder", numbers, friction[on], CYLINDER_BORDERS[border])


@pytest.mark.parametrize(("a", "b"), [(0.5, 0.5), (0.3, 0.6), (0.8, 0.4)])
def test_no_plate_stops_that_is_higher_than_the_highest_one(a, b):
    height = flat.stop_height(1.0, a, b)
    least = flat.stop_friction(flat.rectangle(height * (1.0 - 1e-12), a, b))
    friction = least * np.linspace(1.001, 5.0, 50)
    for law in LAWS:
        for side, mode in ((1.0 - 1e-6, STOP), (1.0, None), (1.0 + 1e-6, PIVOT)):
            numbers = {"length": 1.0, "height": side * height, "mass": 2.0, "friction": friction, "a": a, "b": b}
            ours, outcomes = closed("plate", numbers), solved("plate", numbers, law)
            assert_same(ours, outcomes)
            assert mode is None or ((ours.mode == mode) & (outcomes.mode == mode)).all()


def test_between_supports_too_near_each_other_no_plate_stops():
    assert flat.stop_height(1.0, 0.2, 0.3) == 0.0
    numbers = {"length": 1.0, "height": 1e-6, "mass": 2.0, "friction": 2.0, "a": 0.2, "b": 0.3}
    assert closed("plate", numbers).mode == solved("plate", numbers, "path").mode == PIVOT


def test_the_borders_are_the_curves_of_figure_5():
    delta = np.array([0.05, 0.3, 0.7, 0.72, 1.0, 1.4, 3.0])
    shape, squat = flat.rectangle(delta), delta < math.sqrt(0.5)
    assert flat.stop_height(1.0, 0.5, 0.5) == pytest.approx(math.sqrt(0.5), rel=EXACT)
    curves = {
        flat.stop_friction: np.where(squat, delta, np.nan),
        flat.lift_friction: np.where(~squat & (delta < math.sqrt(2.0)), (2.0 - delta**2) / (3.0 * delta), np.nan),
        flat.pivot_friction: np.where(~squat, 3.0 * delta / (4.0 * delta**2 + 1.0), np.nan),
    }
    for border, curve in curves.items():
        np.testing.assert_allclose(border(shape), curve, rtol=EXACT)


def test_the_borders_are_the_curves_of_figure_7():
    t = np.tan(np.radians([10.0, 44.0, 46.0, 59.0, 61.0, 80.0, 89.0]))
    deep = t > math.sqrt(3.0)
    assert cylindrical.stop_tangent() == pytest.approx(math.sqrt(3.0), rel=EXACT)
    curves = {
        cylindrical.stop_friction: np.where(deep, (t - np.sqrt(np.maximum(t * t - 3.0, 0.0))) / 3.0, np.nan),
        cylindrical.pivot_friction: np.where(~deep, t / 3.0, np.nan),
    }
    for border, curve in curves.items():
        # The printed difference loses up to four digits at 89 degrees.
        np.testing.assert_allclose(border(t), curve, rtol=1e-11)
    f = cylindrical.lift_friction(t)
    np.testing.assert_array_equal(np.isnan(f), deep | (t < 1.0))
    np.testing.assert_allclose((f + np.sqrt(1.0 + f * f))[~np.isnan(f)], t[~np.isnan(f)], rtol=EXACT)


def test_a_slender_rod_stops_if_its_supports_are_far_enough_apart():
    assert flat.stop_distance(1.0) == pytest.approx(0.289, abs=5e-4)
    assert flat.stop_distance(0.40) == pytest.approx(0.1155, abs=5e-5)
    for thickness in (0.0, 0.05):
        limit = flat.stop_distance(0.4, thickness)
        a = limit * np.array([1.0 - 1e-6, 1.0 + 1e-6])
        numbers = {"length": 0.4, "thickness": thickness, "a": a, "b": a, "mass": 0.3, "friction": 1.0}
        assert [*solved("rod", numbers, "path").mode] == [*closed("rod", numbers).mode] == [PIVOT, STOP]


def test_a_rod_that_turns_on_keeps_the_part_of_its_speed_that_the_paper_gives():
    a = 0.11 * down
    numbers = {"length": 0.4, "thickness": 0.02, "a": a, "b": 0.05, "mass": 0.3, "friction": 1.0}
    outcomes = solved("rod", numbers, "path")
    assert (outcomes.mode == PIVOT).all()
    np.testing.assert_allclose(outcomes.twist[..., 2] / -W, flat.rod_ratio(0.4, 0.02, a, 0.05), atol=EXACT)


def test_friction_without_end_and_a_body_without_height_have_answers():
    for friction in (0.0, 1e-300, 1e12):
        for numbers in ({"height": 1e-9}, {"height": 1e9}, {"height": 0.4, "inertia": 1e-9}):
            assert np.isfinite(
                closed("plate", {"length": 1.0, "mass": 1.0, "friction": friction, **numbers}).twist
            ).all()
        for gamma in (1e-9, math.pi / 3.0, 0.5 * math.pi - 1e-9):
            numbers = {"radius": 1.0, "gamma": gamma, "mass": 1.0, "friction": friction}
            assert np.isfinite(closed("cylinder", numbers).impulses).all()
    assert np.isnan(flat.lift_friction(flat.bar(1.0, 0.0, 0.2, 0.2)))


def test_plain_numbers_give_arrays_without_dimensions():
    ours = closed_forms.plate(1.0, 0.4, 10.0, 0.2, omega=-1.0)
    assert (ours.mode.shape, ours.twist.shape, ours.slip.shape, ours.impulses.shape) == ((), (3,), (), (2, 2))
    assert ours.mode == SLIDE
    assert [*ours.twist] == pytest.approx([0.1, 0.0, 0.0], abs=EXACT)


@pytest.mark.parametrize(
    ("ask", "named"),
    [
        (lambda: closed_forms.plate(1.0, 0.4, 10.0, 0.2, omega=1.0), "omega is 1.0"),
        (lambda: closed_forms.plate(1.0, 0.4, 10.0, 0.2, omega=np.array([-1.0, math.nan])), "omega is nan"),
        (lambda: closed_forms.plate(1.0, 0.4, 10.0, 0.2, a=-0.1, omega=-1.0), "a is -0.1"),
        (lambda: closed_forms.rod(1.0, 0.4, 0.2, 0.0, 10.0, 0.2, omega=-1.0), "b is 0.0"),
        (lambda: closed_forms.cylinder(1.0, 0.4, 10.0, -0.2, omega=-1.0), "friction is -0.2"),
    ],
)
def test_what_the_closed_forms_do_not_hold_for_is_refused_with_one_sentence(ask, named):
    with pytest.raises(InputError) as refusal:
        ask()
    assert named in str(refusal.value)
    assert "\n" not in str(refusal.value)
