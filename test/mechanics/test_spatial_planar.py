"""The law in three dimensions in the plane: it ends where the exact planar path with energetic restitution ends."""

from functools import cache

import numpy as np
import pytest
from alone import random_impacts
from golden_impacts import CASES, body_of
from seen_by_contacts import velocities

from impact_predictor import Flag, Mode, Twist, cylinder, plate, solve_impact
from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, ContactState, solve_spatial_impact

THIN = 1e-6
"""Below this square of the radius of gyration over the distance of the contacts one contact's impulse is lost beside
the other's: steps with a tolerance do not resolve it."""

COARSE, FINE = 8, 128
"""Steps for a quarter of an oscillation, the first as usual."""


SLOW = 421
"""A rough floor under a tall body: while the compression ends there the sweeps of a step do not converge."""


def spatial_outcome(body, twist, steps):
    """The impact in three dimensions of the same body: x forward, z up, points in one plane."""
    contacts = [contact for contact in (body.old, body.new) if contact is not None]
    points = ContactPoints(
        positions=[(contact.x, 0.0, contact.y) for contact in contacts],
        friction=[contact.friction for contact in contacts],
        restitution=[contact.restitution for contact in contacts],
        normals=[(contact.normal[0], 0.0, contact.normal[1]) for contact in contacts],
        velocities=[(contact.velocity[0], 0.0, contact.velocity[1]) for contact in contacts],
    )
    vx, vy, omega = twist
    return solve_spatial_impact(Body(body.mass, body.inertia), points, (vx, 0.0, vy, 0.0, -omega, 0.0), steps=steps)


def spatial_twist(body, twist, steps):
    """The planar twist after it."""
    outcome = spatial_outcome(body, twist, steps)
    assert np.abs(outcome.twist[[1, 3, 5]]).max() <= 1e-12 * np.abs(outcome.twist).max()  # it stays in the plane
    return outcome.twist[0], outcome.twist[2], -outcome.twist[4]


def error_of(body, twist, steps):
    """How far the contacts are from their planar velocities after the impact: a part of the fastest one before."""
    expected = velocities(body, solve_impact(body, twist, restitution="energetic").twist)[0]
    found = velocities(body, spatial_twist(body, twist, steps))[0]
    apart = [abs(one - other) for one, other in zip(found, expected, strict=True)]
    return max(apart) / max(map(abs, velocities(body, twist)[0]))


def compared(restitution):
    """Numbers and problems of the golden geometries that are unique, do not jam and are not thin."""
    for number, case in enumerate(CASES):
        body, twist = body_of(case, restitution), Twist(*case["twist"])
        outcome = solve_impact(body, twist, restitution="energetic")
        distance = np.hypot(body.new.x - body.old.x, body.new.y - body.old.y)
        thin = body.inertia / body.mass < THIN * distance**2
        if case["kind"] != "both" and outcome.unique and not outcome.flags & Flag.JAMMED and not thin:
            yield number, body, twist


@cache
def errors(restitution, steps):
    """The errors of the golden geometries by their numbers."""
    return {number: error_of(body, twist, steps) for number, body, twist in compared(restitution)}


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_every_golden_geometry_ends_where_the_planar_path_ends(restitution):
    assert len(errors(restitution, FINE)) > 390
    assert max(errors(restitution, COARSE).values()) < 0.04
    assert max(error for number, error in errors(restitution, FINE).items() if number != SLOW) < 0.003
    assert errors(restitution, FINE)[SLOW] < 0.02


def test_the_error_falls_with_the_steps():
    # By their square where no contact at rest opens, closes, stops or turns back within a step; else in proportion.
    coarse, fine = (np.array(list(errors(0.5, steps).values())) for steps in (COARSE, FINE))
    ratio = FINE / COARSE
    assert np.median(coarse) / np.median(fine) > ratio**2 / 4.0
    assert np.quantile(coarse, 0.9) / np.quantile(fine, 0.9) > ratio / 2.0


@pytest.mark.parametrize("kind", ["plate", "cylinder", "floor", "wedge", "one-point"])
def test_random_impacts_of_any_friction_and_restitution_end_where_the_planar_path_ends(kind):
    far = compared = 0
    for body, twist in random_impacts(kind, 500, seed=6):
        old = body.old and body.old._replace(restitution=0.0)
        outcome = solve_impact(body._replace(old=old), twist, restitution="energetic")
        if outcome.mode is Mode.NO_IMPACT or outcome.flags & Flag.JAMMED or not outcome.unique:
            continue
        compared += 1
        far += error_of(body._replace(old=old), twist, 64) > 0.01
    assert compared > 300
    assert far <= 0.004 * compared  # a slip or a gap that ends at a border within a step


@pytest.mark.parametrize("restitution", [0.5, 0.99, 1.0])
def test_a_contact_that_gives_all_its_work_back_leaves(restitution):
    points = ContactPoints(positions=[(0.0, 0.0, -0.3)], friction=0.3, restitution=restitution)
    outcome = solve_spatial_impact(Body(1.0, 0.1), points, (0.1, 0.0, -1.0, 0.0, 0.0, 0.0), steps=FINE)
    assert outcome.states == (ContactState.LEAVES,)
    assert outcome.twist[2] == pytest.approx(restitution, abs=1e-6)


def test_a_body_that_locks_in_its_wedge_comes_to_its_end():
    body = cylinder(radius=1.0, gamma=1.3, mass=2.0, friction=2.0, restitution=0.5)
    outcome = spatial_outcome(body, body.turning(-1.0), COARSE)
    assert outcome.flags == Flag.NONE
    assert np.abs(outcome.twist).max() < 1e-4


def test_a_box_on_edges_that_slips_along_them_turns_as_its_plate_with_what_friction_is_left():
    """Without slip along the edges it is the plate's planar impact; with much of it, one with hardly any friction."""
    body = plate(length=1.0, height=0.4, mass=3.0, friction=0.2)
    corners = ContactPoints([(x, y, -0.2) for x in (-0.5, 0.5) for y in (-0.35, 0.35)], friction=0.2)
    for slip in (0.0, 1e3):
        vx, vy, omega = body.turning(-1.0)
        box = Body(3.0, (0.3, body.inertia, 0.4))
        found = solve_spatial_impact(box, corners, (vx + 0.3, slip, vy, 0.0, -omega, 0.0), steps=64).twist
        smooth = plate(length=1.0, height=0.4, mass=3.0, friction=0.2 if slip == 0.0 else 0.0)
        expected = solve_impact(smooth, Twist(vx + 0.3, vy, omega)).twist
        assert (found[0], found[2], -found[4]) == pytest.approx(expected, abs=2e-3)
        assert found[1] < slip or abs(found[1]) < 1e-9
