"""Impacts of bodies that move in an impact plane and also slip across it: friction opposes the whole slip."""

import numpy as np
import pytest

import impact_predictor
from impact_predictor import Twist, plate, solve_impact
from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, solve_spatial_impact

FINE = 64
"""Steps of a quarter of an oscillation, by which the cases here err by about 1e-4 of their speeds."""

OLD, NEW = (-0.3, 0.0, -0.2), (0.4, 0.0, -0.2)


def test_it_says_what_does_the_work_of_the_law_that_is_gone():
    with pytest.raises(ImportError, match="use solve_spatial_impact"):
        from impact_predictor import solve_transverse_impact  # noqa: F401
    with pytest.raises(ImportError, match="use solve_spatial_impact"):
        _ = impact_predictor.Transverse


def rows(position):
    """How a twist makes the velocity (x, y, z) of a contact."""
    return np.hstack([np.eye(3), np.cross(np.eye(3), position).T])


def in_small_steps(body, contacts, twist, steps):
    """The twist after a plastic impact whose last contact has a normal impulse that grows in small equal steps.

    In each the other impulses are such that at its end no contact at rest approaches or pulls, and that all slip
    against their friction or rest within it (Gauss, Seidel).
    """
    to_contacts = np.vstack([rows(position) for position in contacts.positions])
    inverse = np.diag([1.0 / body.mass] * 3 + [1.0 / part for part in body.inertia])
    W, c = to_contacts @ inverse @ to_contacts.T, to_contacts @ twist
    last, total = len(c) - 1, np.zeros(len(c))
    step = -c[last] / W[last, last] / steps
    p = np.zeros(len(c))
    while c[last] < 0.0:
        p[last] = step
        for _ in range(500):
            before = p.copy()
            for z in range(2, len(c), 3):
                if z != last:
                    p[z] = max(0.0, p[z] - (c[z] + W[z] @ p) / W[z, z])
                t = slice(z - 2, z)
                p[t] -= (c[t] + W[t] @ p) / np.linalg.eigvalsh(W[t, t])[-1]
                size, most = np.hypot(*p[t]), contacts.friction[z // 3] * p[z]
                p[t] *= min(1.0, most / size) if size > 0.0 else 1.0
            if np.abs(p - before).max() < 1e-9 * step:
                break
        total, c = total + p, c + W @ p
    return twist + inverse @ to_contacts.T @ total


def slipping_case(rng):
    """A box that turns about one point at rest or slipping there, and across, and strikes another; none jams."""
    sides = rng.uniform(0.2, 1.0, 3)
    body = Body(1.0, (np.dot(sides, sides) - sides**2) / 12.0)
    old, new = (-rng.uniform(0.1, 0.6), 0.0, -0.3), (rng.uniform(0.1, 0.6), 0.0, -0.3 - rng.uniform(-0.1, 0.1))
    spin = np.array([0.0, rng.uniform(1.0, 3.0), rng.uniform(-1.0, 1.0)])
    slip = np.array([rng.uniform(-0.5, 0.5), rng.uniform(-0.8, 0.8), 0.0])
    return body, ContactPoints([old, new], friction=rng.uniform(0.05, 0.4, 2)), [*(slip - np.cross(spin, old)), *spin]


def test_the_path_is_that_of_a_body_which_is_struck_in_small_steps():
    rng = np.random.default_rng(2)
    errors = []
    for _ in range(12):
        body, contacts, twist = slipping_case(rng)
        expected = in_small_steps(body, contacts, twist, 500)
        found = solve_spatial_impact(body, contacts, twist, steps=FINE).twist
        errors.append(np.abs(found - expected).max() / np.abs(twist).max())
    assert np.median(errors) < 1e-3
    assert max(errors) < 4e-3


@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.0])
def test_a_single_contact_below_the_mass_centre_slips_along_a_power_law(ratio):
    """d c_x / d c_y = (w_x c_x) / (w_y c_y), so that c_x ~ c_y^(w_x / w_y), whatever the normal impulse."""
    body = Body(2.0, (0.1, 0.15, 0.2))
    contacts = ContactPoints([(0.0, 0.0, -0.3)], friction=0.1)
    errors = []
    for steps in (FINE // 2, FINE):
        slip = solve_spatial_impact(body, contacts, (1.0, ratio, -2.0, 0.0, 0.0, 0.0), steps=steps).velocities[0]
        w_x, w_y = 0.5 + 0.09 / 0.15, 0.5 + 0.09 / 0.1
        errors.append(abs(slip[0] - (slip[1] / ratio) ** (w_x / w_y)))
    assert errors[1] < 1e-5
    assert errors[1] < 0.3 * errors[0]  # by the square of the steps


def test_a_box_on_edges_that_slips_along_them_turns_as_its_plate_with_what_friction_is_left():
    """Without slip along the edges it is the plate's planar impact; with much of it, one with hardly any friction."""
    body = plate(length=1.0, height=0.4, mass=3.0, friction=0.2)
    corners = ContactPoints([(x, y, -0.2) for x in (-0.5, 0.5) for y in (-0.35, 0.35)], friction=0.2)
    for slip in (0.0, 1e3):
        vx, vy, omega = body.turning(-1.0)
        box = Body(3.0, (0.3, body.inertia, 0.4))
        found = solve_spatial_impact(box, corners, (vx + 0.3, slip, vy, 0.0, -omega, 0.0), steps=FINE).twist
        smooth = plate(length=1.0, height=0.4, mass=3.0, friction=0.2 if slip == 0.0 else 0.0)
        expected = solve_impact(smooth, Twist(vx + 0.3, vy, omega)).twist
        assert (found[0], found[2], -found[4]) == pytest.approx(expected, abs=2e-3)
        assert found[1] < slip or abs(found[1]) < 1e-9


def test_a_contact_at_rest_slips_when_the_other_pulls_it_across():
    """The old contact rests with little friction, the new one slips across the plane and yaws it out of that hold."""
    spin = np.array([0.0, 1.0, 2.0])
    twist = [*-np.cross(spin, OLD), *spin]
    body, contacts = Body(1.0, (0.12, 0.13, 0.02)), ContactPoints([OLD, NEW], friction=[0.02, 0.8])
    outcome = solve_spatial_impact(body, contacts, twist, steps=FINE)
    assert abs(outcome.velocities[0, 1]) > 0.01
    assert outcome.twist == pytest.approx(in_small_steps(body, contacts, twist, 1000), abs=5e-3)
