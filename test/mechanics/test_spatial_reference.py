"""The references for impacts in three dimensions against what is known in closed form, and against each other."""

import numpy as np
import pytest
from spatial_reference import (
    STEEP,
    Mechanism,
    delassus,
    on_springs,
    one_contact,
    planar_contact,
    resumed_slip,
    rows,
    stick_friction,
)

CLOSED_FORM = 1e-10
"""Of the contact's speed. The integrator holds 1e-12 a step and takes some tens of steps."""

BALL = delassus(1.0, 0.4 * np.eye(3), rows([[0.0, 0.0, -1.0]], [np.eye(3)]))
"""W of a homogeneous ball of one kilogram and one metre: diag(7/2, 7/2, 1)."""


def some_point(source, planar=False):
    """W of any body that is struck anywhere; with `planar` in a plane of symmetry."""
    axes = np.eye(3) if planar else np.linalg.qr(source.normal(size=(3, 3)))[0]
    inertia = axes @ np.diag(source.uniform(0.05, 1.0, 3)) @ axes.T
    place = source.normal(size=3)
    place[1] *= not planar
    return delassus(1.0, inertia, rows([place], [np.eye(3)]))


def some_velocity(source, planar=False):
    c = source.normal(size=3)
    c[1] *= not planar
    return np.array([c[0], c[1], -abs(c[2])])


def cases(seed, count, planar=False):
    source = np.random.default_rng(seed)
    for _ in range(count):
        yield (
            some_point(source, planar),
            some_velocity(source, planar),
            source.choice([0.0, 0.1, 0.5, 1.0, 3.0]),
            source.choice([0.0, 0.3, 0.7, 1.0]),
        )


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_slip_of_a_body_struck_below_its_mass_centre_turns_along_a_power_law(restitution):
    # A balanced impact (J. A. Batlle, Rough balanced collisions, Journal of Applied Mechanics 63 (1996)): no coupling.
    w, friction = np.diag([2.0, 1.0, 1.5]), 0.3
    c = np.array([1.0, 1.0, -1.1])
    found = one_contact(w, c, friction, restitution)
    x, y, n = found.velocity
    assert n == pytest.approx(1.1 * restitution, abs=CLOSED_FORM)
    assert x == pytest.approx(y * y, abs=CLOSED_FORM)
    # f w_2 dN = -sqrt(1 + y^2) dy along x = y^2.
    passed = 0.5 * (np.sqrt(2.0) + np.arcsinh(1.0) - y * np.hypot(1.0, y) - np.arcsinh(y))
    assert passed == pytest.approx(friction * found.impulse[2], abs=CLOSED_FORM)


def test_in_a_plane_of_symmetry_segments_of_the_path_are_exact():
    phases = set()
    for w, c, friction, restitution in cases(1, 200, planar=True):
        found = one_contact(w, c, friction, restitution)
        velocity, impulse = planar_contact(w, c, friction, restitution)
        assert found.velocity == pytest.approx(velocity, abs=CLOSED_FORM * np.linalg.norm(c))
        assert found.impulse == pytest.approx(impulse, abs=CLOSED_FORM * np.linalg.norm(c) / np.linalg.eigvalsh(w)[0])
        phases.add(found.phases)
    assert phases == {"s", "sS", "sr"}


def test_restitution_is_energetic_when_slip_reverses():
    # Stronge (1990): the work that the normal force gives back is e^2 of what it took, by hand for one case. Slip from
    # 0.5 stops at N = 0.1, before c_n does at N_c, and turns.
    w = np.array([[4.0, 0.0, -3.0], [0.0, 1.0, 0.0], [-3.0, 0.0, 4.0]])
    found = one_contact(w, np.array([0.5, 0.0, -1.0]), 0.5, 0.6)
    # First dc/dN = (-5, 5.5), then the slip grows backwards by (-1, 2.5).
    assert found.phases == "sr"
    at_stop = -1.0 + 0.1 * 5.5
    taken = 0.1 * 0.5 * (1.0 - at_stop) + 0.5 * at_stop**2 / 2.5
    rebound = np.sqrt(2.0 * 2.5 * 0.36 * taken)
    assert found.velocity == pytest.approx([-(rebound - at_stop) / 2.5, 0.0, rebound], abs=CLOSED_FORM)


def test_paths_keep_the_balance_of_momentum_the_friction_cone_and_the_energy():
    for w, c, friction, restitution in cases(3, 100):
        v, impulse, _ = one_contact(w, c, friction, restitution)
        assert v == pytest.approx(c + w @ impulse, abs=CLOSED_FORM * np.linalg.norm(c))
        assert np.hypot(*impulse[:2]) <= friction * impulse[2] * (1.0 + 1e-9)
        assert impulse @ (c + v) <= 1e-12 * c @ c


def test_slip_that_starts_from_rest_keeps_its_direction():
    source = np.random.default_rng(4)
    seen = 0
    for _ in range(50):
        w = some_point(source)
        friction = 0.5 * stick_friction(w)
        u = resumed_slip(w, friction)
        rate = (w @ [*(-friction * u), 1.0])[:2]
        assert rate @ u > 0.0
        assert abs(rate[0] * u[1] - rate[1] * u[0]) <= 1e-13 * np.trace(w)
        found = one_contact(w, np.array([0.0, 0.0, -1.0]), friction, 0.5)
        assert found.velocity[:2] == pytest.approx(u * np.linalg.norm(found.velocity[:2]), abs=1e-12)
        seen += found.phases == "r"
    assert seen == 50


@pytest.mark.parametrize("case", list(cases(5, 8)))
def test_one_contact_on_a_spring_takes_the_path(case):
    w, c, friction, restitution = case
    exact = one_contact(w, c, friction, restitution).velocity
    # Friction is less than full while the slip is below this part of the speed, and no spring is without restitution.
    for regularisation in (1e-4, 1e-6):
        found = on_springs(Mechanism(w, c), friction, restitution, 7.0, regularisation=regularisation)
        assert found.over
        within = (10.0 * regularisation + 1e-6 + (STEEP if restitution == 0.0 else 0.0)) * np.linalg.norm(c)
        assert found.velocities[0] == pytest.approx(exact, abs=within)


def test_two_springs_without_friction_swing_in_their_two_modes():
    # Sum and difference of the depths swing by themselves as long as both springs press.
    w = np.diag([1.0, 1.0, 2.0, 1.0, 1.0, 2.0])
    w[2, 5] = w[5, 2] = 0.5
    c = np.array([0.0, 0.0, -1.0, 0.0, 0.0, -0.8])
    found = on_springs(Mechanism(w, c), 0.0, 1.0, 1.0).velocities[:, 2]
    fast, slow = np.sqrt(2.5), np.sqrt(1.5)
    times = np.linspace(1.0, 3.0, 2_000_001)
    depths = np.array(
        [0.9 * np.sin(fast * times) / fast + sign * 0.1 * np.sin(slow * times) / slow for sign in (1, -1)]
    )
    first = int(np.argmin((depths > 0.0).all(0)))
    number = int(np.argmin(depths[:, first]))
    t = times[first]
    speeds = [-0.9 * np.cos(fast * t) - sign * 0.1 * np.cos(slow * t) for sign in (1, -1)]
    # The other spring goes on alone: its energy becomes its speed.
    other = 1 - number
    mobility, pulled = 2.0, 0.5
    end = np.sqrt(speeds[other] ** 2 + mobility * depths[other, first] ** 2)
    impulse = (end - speeds[other]) / mobility
    expected = {other: end, number: speeds[number] + pulled * impulse}
    assert found == pytest.approx([expected[0], expected[1]], abs=3e-6)


def chain(count):
    """W and c of balls in a row at rest, all of one mass, the first of which comes with speed 1: contacts along n."""
    links = count - 1
    w = np.eye(3 * links)
    w[2::3, 2::3] = 2.0 * np.eye(links) - np.eye(links, k=1) - np.eye(links, k=-1)
    c = np.zeros(3 * links)
    c[2] = -1.0
    return w, c


@pytest.mark.parametrize("stiffness", [1e3, 1e5])
def test_three_balls_in_a_row_come_to_those_of_a_stiff_second_contact(stiffness):
    # V. Acary and B. Brogliato (2003): velocities (-1/3, 2/3, 2/3) where the second contact is stiff.
    w, c = chain(3)
    found = on_springs(Mechanism(w, c), 0.0, 1.0, [1.0, stiffness], [0.0, np.sqrt(stiffness)])
    assert found.velocities[:, 2] == pytest.approx([1.0, 0.0], abs=2.0 / stiffness)
