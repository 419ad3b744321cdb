"""Where the total law is known to have one answer, trying all contact states finds no other."""

from itertools import product

import numpy as np
import pytest
from alone import random_impacts

from impact_predictor import solve_impact
from impact_predictor.mechanics.impact import total_law
from impact_predictor.mechanics.impact.contacts import planar_contacts
from impact_predictor.mechanics.impact.total_law import one_answer
from impact_predictor.mechanics.random_problems import KINDS


def least_determinant(pair):
    """The least of the determinants of the pieces of the law's map, written out."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    normal_a, tangent_a = np.array([0.0, 1.0, qa]), np.array([1.0, 0.0, sa])
    normal_b, tangent_b = np.array([-sin, cos, qb]), np.array([cos, sin, sb])

    def det(*rows):
        return np.linalg.det(np.array(rows))

    determinants = []
    for sign_a, sign_b in product((-1.0, 1.0), repeat=2):
        ray_a, ray_b = normal_a + sign_a * fa * tangent_a, normal_b + sign_b * fb * tangent_b
        normals = np.cross(normal_a, normal_b)
        determinants += [
            normal_a @ ray_a,
            normal_b @ ray_b,
            det(normal_a, tangent_a, normal_b) * det(normal_a, tangent_a, ray_b),
            det(normal_b, tangent_b, normal_a) * det(normal_b, tangent_b, ray_a),
            det(normals, ray_a, ray_b),
        ]
    return min(determinants)


def test_one_answer_is_known_exactly_where_all_determinants_are_positive():
    source, known = np.random.default_rng(3), 0
    for _ in range(2000):
        angle, *moments = source.uniform(-3.0, 3.0), *source.uniform(-2.0, 2.0, 4)
        pair = (np.cos(angle), np.sin(angle), *moments, *source.uniform(0.0, 1.0, 2))
        assert one_answer(planar_contacts(*pair), 0.0, 0.0) == (least_determinant(pair) > 0.0)
        known += one_answer(planar_contacts(*pair), 0.0, 0.0)
    assert 500 < known < 1500


@pytest.mark.parametrize(
    ("angle", "numbers"),
    [
        (-1.9, (0.1, -1.2, 1.7, 1.9, 0.7, 1.1)),  # slips of opposite directions alone can have another answer
        (-0.4, (0.0, -1.1, -1.1, -1.1, 0.9, 0.6)),  # slips of the same direction alone
    ],
)
def test_slips_of_both_relative_directions_count(angle, numbers):
    pair = (np.cos(angle), np.sin(angle), *numbers)
    assert least_determinant(pair) < 0.0
    assert not one_answer(planar_contacts(*pair), 0.1, 0.3)


@pytest.mark.parametrize(("fa", "fb", "known"), [(2.0, 2.0, True), (0.2, 0.9, True), (0.0, 3.0, False)])
def test_on_a_flat_floor_the_two_frictions_may_be_any_that_differ_little(fa, fb, known):
    # both contacts 1 from the middle of the body and 0.7 below: their slips are one
    pair = (1.0, 0.0, -1.0, 0.7, 1.0, 0.7, fa, fb)
    assert one_answer(planar_contacts(*pair), 0.3, 0.3) == known
    assert one_answer(planar_contacts(*pair), 0.3, -0.3) == (least_determinant(pair) > 0.0)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("extreme")])
def test_trying_all_states_gives_the_same_outcome(kind, monkeypatch):
    problems = random_impacts(kind, 200, seed=11)
    outcomes = [solve_impact(*problem, "total") for problem in problems]
    monkeypatch.setattr(total_law, "one_answer", lambda *_: False)
    assert outcomes == [solve_impact(*problem, "total") for problem in problems]
