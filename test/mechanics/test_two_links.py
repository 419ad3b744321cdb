"""Two links with a hinge, written out by hand, whose end points strike: an articulated machine in contact space."""

import math

import numpy as np
import pytest
from seen_by_contacts import condition, velocities

from impact_predictor import Contact, TwoPointBody, solve_impact
from impact_predictor.mechanics.contact_space import solve

LAWS = ("path", "total")

LINKS = (0.5, 2.0), (0.8, 1.2)
"""Length in m and mass in kg of the two links, homogeneous rods."""


def inertia(link):
    length, mass = link
    return mass * length * length / 12.0


def two_links(angles, turning, hinge_velocity):
    """Two links with a hinge, derived by hand: mass matrix, rows of the contacts and generalized velocities.

    The generalized velocities are those of the hinge (x, y) and of the two angles. Link i lies from the hinge in the
    direction (cos, sin) of its angle q_i; its mass centre is half its length away and its contact at its end. The
    velocity of a point at the distance s along it is that of the hinge plus s dq_i (-sin q_i, cos q_i), so that the
    kinetic energy 1/2 sum m_i |v_Ci|^2 + J_i dq_i^2 has these second derivatives.
    """
    mass = np.zeros((4, 4))
    rows = []
    for k, ((length, m), q) in enumerate(zip(LINKS, angles, strict=True)):
        lever = 0.5 * length
        mass[0, 0] += m
        mass[1, 1] += m
        mass[0, 2 + k] = mass[2 + k, 0] = -m * lever * math.sin(q)
        mass[1, 2 + k] = mass[2 + k, 1] = m * lever * math.cos(q)
        mass[2 + k, 2 + k] = m * lever**2 + inertia((length, m))
        normal, tangent = np.zeros(4), np.zeros(4)  # one flat floor: n = (0, 1), t = (1, 0)
        normal[1], normal[2 + k] = 1.0, length * math.cos(q)
        tangent[0], tangent[2 + k] = 1.0, -length * math.sin(q)
        rows += [normal, tangent]
    return mass, np.array(rows), np.array([*hinge_velocity, *turning])


def free_links(angles):
    """The same two links without the hinge: masses of (x, y, q) of each, rows of the contacts and of the hinge.

    Each is a free body with its mass centre as origin; the rows of the hinge are the velocity of link 1 less that of
    link 2 there, (x, y), and the difference of the angular velocities.
    """
    masses, rows, hinge = [], np.zeros((4, 6)), np.zeros((3, 6))
    for k, ((length, m), q) in enumerate(zip(LINKS, angles, strict=True)):
        x, y, sign = 0.5 * length * math.cos(q), 0.5 * length * math.sin(q), 1 - 2 * k
        masses += [m, m, inertia((length, m))]
        rows[2 * k, 3 * k + 1], rows[2 * k, 3 * k + 2] = 1.0, x
        rows[2 * k + 1, 3 * k], rows[2 * k + 1, 3 * k + 2] = 1.0, -y
        hinge[0, 3 * k], hinge[0, 3 * k + 2] = sign, sign * y
        hinge[1, 3 * k + 1], hinge[1, 3 * k + 2] = sign, -sign * x
        hinge[2, 3 * k + 2] = sign
    return np.array(masses), rows, hinge


def constrained_change(masses, hinge, push):
    """Change of the velocities of free bodies by generalized impulses and by those that keep a hinge together."""
    count = len(hinge)
    matrix = np.block([[np.diag(masses), -hinge.T], [hinge, np.zeros((count, count))]])
    return np.linalg.solve(matrix, np.vstack([push, np.zeros((count, push.shape[1]))]))[: len(masses)]


def velocities_of_free_links(angles, motion):
    """Velocities (x, y, q) of both mass centres in the motion of the linked ones."""
    ux, uy, *turning = motion
    return np.array(
        [
            part
            for (length, _), q, w in zip(LINKS, angles, turning, strict=True)
            for part in (ux - 0.5 * length * w * math.sin(q), uy + 0.5 * length * w * math.cos(q), w)
        ]
    )


def random_two_links(source):
    """Angles and a motion of two links whose ends point down, the first on the floor and the second about to strike."""
    angles = source.uniform(-2.6, -1.8), source.uniform(-1.3, -0.5)
    turning, ux = source.normal(size=2), source.choice([0.0, 1.0]) * source.normal()
    slips = source.random() < 0.5
    mass, rows, motion = two_links(angles, turning, (ux, 0.0))
    motion[1] -= rows[0] @ motion
    if not slips:
        motion[0] -= rows[1] @ motion
    return angles, mass, rows, motion if rows[2] @ motion < 0.0 else -motion


def test_w_of_two_links_by_hand_is_that_of_two_bodies_held_together_by_their_hinge():
    source = np.random.default_rng(1)
    for _ in range(50):
        angles, mass, rows, motion = random_two_links(source)
        masses, free_rows, hinge = free_links(angles)
        free = velocities_of_free_links(angles, motion)
        assert hinge[:2] @ free == pytest.approx(0.0, abs=1e-14)
        assert free_rows @ free == pytest.approx(rows @ motion, abs=1e-14)
        assert free @ (masses * free) == pytest.approx(motion @ mass @ motion, rel=1e-13)
        w = rows @ np.linalg.solve(mass, rows.T)
        assert free_rows @ constrained_change(masses, hinge[:2], free_rows.T) == pytest.approx(w, rel=1e-11, abs=1e-12)
        assert np.linalg.matrix_rank(w) == 4


@pytest.mark.parametrize("restitution", [0.0, 0.4])
@pytest.mark.parametrize("law", LAWS)
def test_an_impact_of_two_links_moves_them_as_two_bodies_with_a_hinge(law, restitution):
    source = np.random.default_rng(2)
    modes = set()
    for _ in range(300):
        angles, mass, rows, motion = random_two_links(source)
        w, c = rows @ np.linalg.solve(mass, rows.T), rows @ motion
        friction = tuple(source.uniform(0.0, 1.2, 2))
        outcome = solve(w, c, friction, (0.0, restitution), law)
        impulses = np.array(outcome.impulses).ravel()
        close = 1e-14 * condition(w) * max(map(abs, c))

        masses, free_rows, hinge = free_links(angles)
        free = velocities_of_free_links(angles, motion)
        after = free + constrained_change(masses, hinge[:2], (free_rows.T @ impulses)[:, None])[:, 0]
        assert hinge[:2] @ after == pytest.approx(0.0, abs=close)
        assert free_rows @ after == pytest.approx(outcome.velocities, abs=close)
        energy_lost = 0.5 * (free @ (masses * free) - after @ (masses * after))
        assert outcome.energy_lost == pytest.approx(energy_lost, abs=close)
        # The generalized velocities change by M^-1 G^T P.
        assert velocities_of_free_links(angles, motion + np.linalg.solve(mass, rows.T @ impulses)) == pytest.approx(
            after, abs=close
        )
        modes.add(outcome.mode)
    assert len(modes) > (3 if restitution == 0.0 else 1)


@pytest.mark.parametrize("law", LAWS)
def test_two_links_whose_hinge_is_locked_are_one_planar_body(law):
    source = np.random.default_rng(5)
    for _ in range(100):
        angles, *_ = random_two_links(source)
        masses, free_rows, hinge = free_links(angles)
        w = free_rows @ constrained_change(masses, hinge, free_rows.T)

        centres = [
            (0.5 * length * math.cos(q), 0.5 * length * math.sin(q))
            for (length, _), q in zip(LINKS, angles, strict=True)
        ]
        mass = masses[0] + masses[3]
        x, y = ((masses[0] * p + masses[3] * q) / mass for p, q in zip(*centres, strict=True))
        turned = sum(
            inertia(one) + one[1] * ((p - x) ** 2 + (q - y) ** 2) for one, (p, q) in zip(LINKS, centres, strict=True)
        )
        friction = source.uniform(0.0, 1.2)
        old, new = (Contact(2.0 * p - x, 2.0 * q - y, friction) for p, q in centres)
        body = TwoPointBody(mass, turned, old, new)
        twist = body.turning(-1.0)
        c, expected = velocities(body, twist)[0], solve_impact(body, twist, law)
        outcome = solve(w, (0.0, 0.0, *c[2:]), (friction, friction), law=law)
        close = 1e-14 * condition(w) * max(map(abs, c))
        assert outcome.velocities == pytest.approx(velocities(body, expected.twist)[0], abs=close)
        assert outcome.mode is expected.mode
        assert outcome.energy_lost == pytest.approx(expected.energy_lost, abs=mass * close)
