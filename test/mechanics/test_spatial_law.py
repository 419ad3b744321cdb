"""The law in three dimensions against references that share no code with it, and what it does with bad input.

Differences are relative to the fastest contact before the impact.
"""

from importlib import import_module

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from spatial_reference import Mechanism, MovingBody, delassus, on_springs, one_contact, planar_contact, rows
from test_spatial_reference import BALL, cases, chain

import impact_predictor
from impact_predictor import Body, ContactPoints, Flag, solve_spatial_impact
from impact_predictor.mechanics.compiled import without_numba
from impact_predictor.mechanics.impact import spatial
from impact_predictor.mechanics.types import ContactState
from impact_predictor.native import as_python

MASS, INERTIA = 50.0, 50.0 / 12.0 * np.diag([0.6**2 + 0.5**2, 1.0 + 0.5**2, 1.0 + 0.6**2])
CORNERS = np.array([[0.5, 0.3, -0.25], [0.5, -0.3, -0.25], [-0.5, 0.3, -0.25]])
TWIST = np.array([0.3, 0.2, -1.0, 0.4, -0.3, 0.5])
"""A crate of 1 x 0.6 x 0.5 m that strikes with three corners at once."""


def points(n, friction, restitution):
    """Of a mechanism, whose contacts lie nowhere."""
    return ContactPoints(np.zeros((n, 3)), friction, restitution)


def struck(w, c, friction, restitution, **settings):
    """Contact velocities (n, 3) after an impact of a mechanism."""
    outcome = solve_spatial_impact(w, points(len(c) // 3, friction, restitution), c, **settings)
    assert outcome.flags == Flag.NONE
    return outcome.velocities


@pytest.mark.slow
def test_one_contact_takes_the_path_of_routh_and_keller_and_converges_with_the_steps():
    # Second order in the median; where the slip stops or whips round within a step, an angle of that
    # step, pi / 2 / steps, of its speed is uncertain.
    steps = np.array([8, 32, 128, 512])
    errors = np.array(
        [
            [
                np.abs(struck(w, c, friction, restitution, steps=count)[0] - exact).max() / np.linalg.norm(c)
                for count in steps.tolist()
            ]
            for w, c, friction, restitution in cases(11, 200)
            for exact in [one_contact(w, c, friction, restitution).velocity]
        ]
    )
    assert (np.median(errors, 0) <= 0.1 / steps**2).all()
    assert (errors.max(0) <= 0.5 * np.pi / steps).all()


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.2, 0.3, 2.0])
def test_a_ball_slips_straight_on_until_it_rolls(friction, restitution):
    # Keller (1986): the direction of slip is constant, and a ball stops slipping at f (1 + e) |c_n| = 2/7 |c_t|.
    left = max(0.0, 1.0 - 3.5 * friction * (1.0 + restitution) * 1.3)
    outcome = solve_spatial_impact(BALL, points(1, friction, restitution), [0.6, -0.8, -1.3], steps=128)
    assert outcome.velocities[0] == pytest.approx([0.6 * left, -0.8 * left, 1.3 * restitution], abs=1e-4)
    rests = {True: ContactState.SLIPS, False: ContactState.STICKS}[left > 0.0]
    assert outcome.states == (ContactState.LEAVES if restitution else rests,)


def test_a_mechanism_that_moves_in_a_plane_alone_has_its_planar_impact():
    flat = np.diag([1.0, 0.0, 1.0])
    for w, c, friction, restitution in cases(12, 100, planar=True):
        found = struck(flat @ w @ flat, c, friction, restitution, steps=128)[0]
        expected, _ = planar_contact(w, c, friction, restitution)
        assert found == pytest.approx(expected, abs=0.5 * np.pi / 128 * np.linalg.norm(c))


@pytest.mark.parametrize("count", [3, 6])
def test_a_ball_that_strikes_a_row_of_balls_at_rest_moves_them_as_one(count):
    # Contacts at rest do not give way: the row is one body, of count - 1 times the mass (for three: -1/3, 2/3, 2/3).
    found = struck(*chain(count), 0.0, 1.0, steps=128)[:, 2]
    assert found == pytest.approx([1.0, *[0.0] * (count - 2)], abs=1e-4)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_contacts_that_strike_at_once_are_springs_of_one_stiffness(n):
    source = np.random.default_rng(n)
    for _ in range(8):
        place = np.column_stack([source.uniform(-1.0, 1.0, (n, 2)), np.full(n, -0.5)])
        w = delassus(1.0, np.diag(source.uniform(0.1, 0.4, 3)), rows(place, [np.eye(3)] * n))
        c = np.column_stack([source.normal(size=(n, 2)), -source.uniform(0.2, 2.0, n)]).ravel()
        friction, restitution = source.choice([0.1, 0.4, 1.0]), source.choice([0.2, 0.5, 1.0])
        reference = on_springs(Mechanism(w, c), friction, restitution, 1.0)
        assert reference.over
        found = struck(w, c, friction, restitution, steps=256)
        assert found == pytest.approx(reference.velocities, abs=2e-3 * np.abs(c).max())


@pytest.mark.parametrize("n", [2, 3])
def test_a_contact_at_rest_is_the_limit_of_a_stiff_spring(n):
    source = np.random.default_rng(n)
    for _ in range(8):
        place = np.column_stack([source.uniform(-1.0, 1.0, (n, 2)), np.full(n, -0.5)])
        g = rows(place, [np.eye(3)] * n)
        w = delassus(1.0, np.diag(source.uniform(0.1, 0.4, 3)), g)
        normals, twist = g[2:-1:3], source.normal(size=6)
        twist -= np.linalg.pinv(normals) @ (normals @ twist)
        c = g @ twist * -np.sign(g[-1] @ twist)
        friction, restitution = source.choice([0.1, 0.4, 1.0]), source.choice([0.3, 0.6, 1.0])
        found = struck(w, c, friction, restitution, steps=512)
        differences = []
        for stiffness in (1e2, 1e4):
            rests = np.arange(n) < n - 1
            reference = on_springs(
                Mechanism(w, c),
                friction,
                np.where(rests, 1.0, restitution),
                np.where(rests, stiffness, 1.0),
                # It keeps a spring at rest from swinging, and so the difference falls with the stiffness, not its root.
                np.where(rests, np.sqrt(stiffness), 0.0),
            )
            differences.append(np.abs(reference.velocities - found).max() / np.abs(c).max())
        assert differences[0] <= 5e-2
        assert differences[1] <= max(0.05 * differences[0], 1e-3)


def test_a_contact_with_a_gap_closes_as_the_others_are_compressed():
    source, merge, compared = np.random.default_rng(9), 1.5e-3, 0
    for n in (2, 3) * 10:
        place = np.column_stack([source.uniform(-1.0, 1.0, (n, 2)), np.full(n, -0.5)])
        w = delassus(1.0, np.diag(source.uniform(0.1, 0.4, 3)), rows(place, [np.eye(3)] * n))
        c = np.column_stack([source.normal(size=(n, 2)), -source.uniform(0.5, 2.0, n)]).ravel()
        friction, restitution = source.choice([0.1, 0.4, 1.0]), source.choice([0.3, 0.5, 1.0])
        gaps = source.uniform(0.0, 2e-3, n) * (np.arange(n) > 0)
        # A quarter of an oscillation on the spring, of one stiffness for all, lasts `merge`.
        distances = gaps / merge * 0.5 * np.pi / np.sqrt(np.diag(w)[2::3])
        reference = on_springs(
            Mechanism(w, c), friction, restitution, 1.0, gaps=True, distances=distances, longest=8.0, tolerance=1e-8
        )
        # A contact that closes a second time has its gap to come back through there, which the law does not know.
        if reference.over and (reference.closed_again <= (gaps > 0.0)).all():
            contacts = points(n, friction, restitution)._replace(gaps=gaps)
            outcome = solve_spatial_impact(w, contacts, c, merge=merge, steps=256)
            assert outcome.velocities == pytest.approx(reference.velocities, abs=1e-3 * np.abs(c).max())
            nears = [state == ContactState.NEARS for state in outcome.states]
            assert nears == ((gaps > 0.0) & (reference.closed_again == 0)).tolist()
            compared += 1
    assert compared >= 10


@pytest.mark.slow
@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.3, 0.6, 1.0])
def test_a_crate_on_three_corners_moves_on_as_on_stiff_springs(restitution):
    crate, rough = MovingBody(MASS, INERTIA, CORNERS, TWIST), {"regularisation": 1e-4, "tolerance": 1e-6}
    reference = on_springs(crate, 0.4, restitution, 1e10, gaps=True, **rough)
    assert reference.over
    outcome = solve_spatial_impact(Body(MASS, INERTIA), ContactPoints(CORNERS, 0.4, restitution), TWIST)
    radius = np.linalg.norm(CORNERS[0])
    scale = np.repeat([1.0, radius], 3)
    difference = np.linalg.norm((outcome.twist - reference.state[:6]) * scale)
    assert difference <= 0.02 * np.linalg.norm(TWIST * scale)
    assert outcome.velocities[:, 2].min() >= -1e-9
    assert outcome.flags == Flag.NONE


def test_contacts_without_restitution_are_the_limit_of_little():
    w, c = (
        delassus(MASS, INERTIA, rows(CORNERS, [np.eye(3)] * 3)),
        np.array([0.1, 0.2, -1.2, 0.3, 0.0, -0.7, 0.1, -0.2, 0]),
    )
    for friction in (0.0, 0.4, 1.0):
        plastic = struck(w, c, friction, 0.0, steps=512)
        assert struck(w, c, friction, 1e-3, steps=4096) == pytest.approx(plastic, abs=2e-3 * np.abs(c).max())


def test_an_impact_that_would_gain_energy_by_newtons_restitution_keeps_all_of_it():
    rng, told = np.random.default_rng(0), 0
    for _ in range(100):
        twist = rng.normal(0.0, [2.0, 2.0, 0.5, 2.0, 2.0, 2.0]) - [0.0, 0.0, 1.5, 0.0, 0.0, 0.0]
        contacts = ContactPoints(CORNERS, rng.uniform(0.2, 1.5), 1.0)
        outcome = solve_spatial_impact(Body(MASS, INERTIA), contacts, twist, "total")
        if Flag.ENERGY_GAINED in outcome.flags:
            before, after = (
                MASS * (one[:3] @ one[:3]) + one[3:] @ INERTIA @ one[3:] for one in (twist, np.array(outcome.twist))
            )
            assert after == pytest.approx(before, rel=1e-12)
            told += 1
    assert told > 1


def test_a_body_is_the_mechanism_of_its_mobilities():
    g = rows(CORNERS, [np.eye(3)] * 3)
    body = solve_spatial_impact(Body(MASS, INERTIA), ContactPoints(CORNERS, 0.4, 0.3), TWIST)
    w = delassus(MASS, INERTIA, g)
    assert struck(w, g @ TWIST, 0.4, 0.3) == pytest.approx(body.velocities, abs=1e-9)


PLACES = [[0.3, 0.2, -0.5], [-0.3, 0.2, -0.5]]
FALLS = [0.3, 0.1, -1.0, 0.2, 0.4, -0.1]
UP, DOWN = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
GOOD = Body(1.0, [0.1, 0.12, 0.15]), ContactPoints(PLACES, 0.4, 0.3), FALLS
NAN, INF = np.nan, np.inf


LAW = "mechanics.impact.spatial_body"


@pytest.fixture(params=["numba", "machine code", "Python"])
def code(request, monkeypatch):
    """The law code in all of its forms: in the two without numba a division by zero raises."""
    if request.param != "numba":
        law = as_python(LAW) if request.param == "Python" else import_module(f"impact_predictor.{LAW}")
        for solver, function in (("solver", law.strike_all), ("mechanism_solver", law.strike_mechanism)):
            plain = without_numba(function)
            monkeypatch.setattr(spatial, solver, lambda plain=plain: plain)


def finite(outcome):
    found = [outcome.impulses, outcome.velocities, outcome.energy_lost]
    return all(np.isfinite(each).all() for each in [*found, *([] if outcome.twist is None else [outcome.twist])])


@pytest.mark.usefixtures("code")
@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize(
    "change",
    [
        *[{"inertia": each} for each in ([0.1, 0.1, 0.3], [0.1, -0.1, 0.1], [0.1, 0.1, 0.1, 0.2, 0.0, 0.0], 0.0, NAN)],
        {"inertia": [[0.1, 0.05, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]},
        *[{"mass": each} for each in (0.0, -1.0, NAN, INF)],
        *[{"friction": each} for each in (-0.1, NAN, INF)],
        *[{"restitution": each} for each in (-0.1, 1.1, NAN)],
        *[{"normals": each} for each in ([0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, NAN, 1.0])],
        *[{"positions": [[each, 0.0, 0.0]] * 2} for each in (NAN, INF)],
        {"velocities": [0.0, INF, 0.0]},
        *[{"twist": [each] * 6} for each in (NAN, INF, 1e308)],
    ],
    ids=str,
)
def test_numbers_that_no_body_has_are_flagged(change, law):
    body, contacts, twist = GOOD
    body = body._replace(**{name: value for name, value in change.items() if name in body._fields})
    contacts = contacts._replace(**{name: value for name, value in change.items() if name in contacts._fields})
    outcome = solve_spatial_impact(body, contacts, change.get("twist", twist), law)
    assert outcome.flags == Flag.INVALID_INPUT
    assert finite(outcome)
    assert not outcome.impulses.any()


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("moments", [(1.0, 2.0, 3.0), (1.0, 1.0, 1e-9)], ids=["plate", "needle"])
def test_plates_and_needles_are_bodies_in_all_units(moments, scale):
    turn = Rotation.from_rotvec([0.3, -0.5, 0.7]).as_matrix()
    inertia = scale * (turn * moments) @ turn.T
    _, contacts, twist = GOOD
    outcome = solve_spatial_impact(Body(scale, 0.5 * (inertia + inertia.T)), contacts, twist)
    assert not outcome.flags & Flag.INVALID_INPUT


@pytest.mark.usefixtures("code")
@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("friction", [0.0, 0.5, 1e4])
@pytest.mark.parametrize(
    ("positions", "normals"),
    [
        (np.zeros((3, 3)), UP),
        (np.zeros((0, 3)), UP),
        (PLACES, [UP, DOWN]),
        (PLACES, [UP, UP]),
        ([PLACES[0]] * 4, UP),
        (np.random.default_rng(0).uniform(-1.0, 0.0, (100, 3)), UP),
        ([[0.1, 0.0, -0.3], [0.2, 0.0, -0.3], [0.3, 0.0, -0.3]], UP),
    ],
    ids=["mass centre", "none", "opposed", "parallel", "coincident", "hundred", "line"],
)
def test_places_that_are_odd_have_an_answer(positions, normals, friction, law):
    outcome = solve_spatial_impact(GOOD[0], ContactPoints(positions, friction, 0.3, normals), FALLS, law)
    assert finite(outcome)
    assert not outcome.flags & Flag.INVALID_INPUT
    along = (outcome.velocities * normals).sum(-1)
    assert along.min(initial=0.0) >= -1e-5


@pytest.mark.usefixtures("code")
@pytest.mark.parametrize("law", ["path", "total"])
def test_a_vice_that_closes_is_told_to_have_no_answer(law):
    vice = ContactPoints([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]], 0.4, 0.3, [UP, DOWN], [UP, DOWN])
    outcome = solve_spatial_impact(GOOD[0], vice, np.zeros(6), law)
    assert outcome.flags & (Flag.NOT_CONVERGED | Flag.NO_SOLUTION)
    assert finite(outcome)


@pytest.mark.parametrize(("apart", "flags"), [(0.012, Flag.NONE), (0.009, Flag.NOT_CONVERGED)])
def test_sweeps_of_contacts_that_are_nearly_one_end_before_they_settle_and_that_is_told_where_it_counts(apart, flags):
    w = np.eye(6)
    w[2, 5] = w[5, 2] = 1.0 - apart
    outcome = solve_spatial_impact(w, points(2, 0.3, 0.0), [0.0, 0.0, -1.0, 0.0, 0.0, -1.0], "total")
    assert outcome.flags == flags
    # Either is near: each contact has half of what both need, and hardly approaches.
    assert outcome.impulses[:, 2] == pytest.approx([0.5, 0.5], abs=0.01)
    assert np.abs(outcome.velocities[:, 2]).max() < 1e-5


BLOCKED = np.diag([1.0, 1.0, 0.0, 1.0, 1.0, 0.0])
INDEFINITE = np.eye(6) + 2.0 * (np.eye(6, k=3) + np.eye(6, k=-3)) @ np.diag([0.0, 0.0, 1.0, 0.0, 0.0, 1.0])


@pytest.mark.usefixtures("code")
@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize(
    ("w", "flags"),
    [
        (-np.eye(6), Flag.INVALID_INPUT),
        (INDEFINITE, Flag.INVALID_INPUT),
        (np.eye(6) + 0.5 * np.eye(6, k=2), Flag.INVALID_INPUT),
        (np.full((6, 6), NAN), Flag.INVALID_INPUT),
        (np.full((6, 6), INF), Flag.INVALID_INPUT),
        (np.zeros((6, 6)), Flag.NOT_CONVERGED | Flag.NO_SOLUTION | Flag.INVALID_INPUT),
        (BLOCKED, Flag.NOT_CONVERGED | Flag.NO_SOLUTION | Flag.INVALID_INPUT),
    ],
    ids=["negative", "indefinite", "not symmetric", "nan", "inf", "zero", "blocked"],
)
def test_mobilities_that_no_mechanism_has_are_flagged(w, flags, law):
    outcome = solve_spatial_impact(w, points(2, 0.4, 0.3), [0.1, 0.0, -1.0, 0.0, 0.2, -1.0], law)
    assert outcome.flags & flags
    assert finite(outcome)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ((np.eye(5), points(2, 0.4, 0.3), np.zeros(6)), "W has the shape"),
        ((Body(1.0, [1.0, 2.0]), GOOD[1], FALLS), "an inertia has the shape"),
        ((GOOD[0], ContactPoints([1.0, 2.0, 3.0], 0.4), FALLS), "the positions have the shape"),
        ((GOOD[0], ContactPoints(PLACES, [0.4] * 3), FALLS), "friction has the shape"),
        ((GOOD[0], GOOD[1], [1.0, 2.0]), "a twist has the shape"),
        ((*GOOD, "newton"), "law is 'newton'"),
        *[((*GOOD, "path", *each), "merge is") for each in ((NAN,), (-1.0,), (0.0, NAN), (0.0, 0.0, 0))],
    ],
    ids=["W", "inertia", "positions", "friction", "twist", "law", "merge", "sign", "threshold", "steps"],
)
def test_arrays_of_another_shape_and_odd_settings_end_in_a_sentence(given, says):
    with pytest.raises(ValueError, match=says):
        solve_spatial_impact(*given)


def test_it_says_what_does_the_work_of_the_law_that_is_gone():
    with pytest.raises(ImportError, match="use solve_spatial_impact"):
        from impact_predictor import solve_transverse_impact  # noqa: F401
    with pytest.raises(ImportError, match="use solve_spatial_impact"):
        _ = impact_predictor.Transverse
