"""The exact solver that decides new cases agrees with golden/impacts.json, which it shares no code with."""

from fractions import Fraction
from itertools import pairwise

import exact
import pytest
from exact import NB
from exact_algebra import dot
from golden_impacts import CASES, KINDS, body_of

from impact_predictor import Contact, TwoPointBody, solve_impact

CLOSE = 2.0**-52
"""Of the terms that a contact velocity is the sum of: one rounding of the twist before and one of that after."""


SLIM = TwoPointBody(
    mass=0.104,
    inertia=0.0818,
    old=Contact(-1.6581, -1.4522, 1.8782),
    new=Contact(1.2691, -0.7467, 1.8782, (0.1611439001926167, 0.9869309213064064)),
)
"""Found by chance among wedges: A slips and jams again and again, and the body is 0.146 times as fast each time."""


def distance(problem, case, change, twist):
    """How far two twists after the impact are apart, as a part of the terms of the contact velocities."""
    before, after = (list(map(Fraction, each)) for each in (case["twist"], twist))
    apart = [v + d - w for v, d, w in zip(before, change, after, strict=True)]
    terms = [abs(v) + abs(w) for v, w in zip(before, after, strict=True)]
    return max(float(abs(dot(row, apart)) / dot(map(abs, row), terms)) for row in problem.rows)


@pytest.mark.parametrize("answer", ["routh", "routh_e0.5"])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "both"])
def test_the_path_is_the_golden_one(kind, answer):
    decided = 0
    for case in (case for case in CASES if case["kind"] == kind):
        restitution = 0.5 if answer == "routh_e0.5" else 0.0
        problem = exact.problem_of(body_of(case, restitution), case["twist"])
        path = exact.path(problem)
        assert path.jammed is (case[answer] is None)
        if not path.jammed:
            assert list(path.segments) == case[answer]["path"], case
            assert distance(problem, case, path.change, case[answer]["twist"]) <= CLOSE, case
            decided += 1
    assert decided > 50


@pytest.mark.parametrize("kind", KINDS)
def test_the_total_law_has_the_golden_solutions(kind):
    for case in (case for case in CASES if case["kind"] == kind):
        problem = exact.problem_of(body_of(case), case["twist"])
        answers = exact.total(problem)
        assert len(answers) == len(case["total"])
        for solution in case["total"]:
            nearest = min(distance(problem, case, each.change, solution["twist"]) for each in answers)
            assert nearest <= CLOSE, case


def test_jams_without_end_have_the_limit_that_more_and_more_of_them_come_near(monkeypatch):
    problem = exact.problem_of(SLIM, SLIM.turning(-0.4767))
    limit = exact.path(problem)
    assert limit.segments == ("O+", "OS", "-O", "SO") * 2
    assert limit.history[-1] == [0, 0, 0, 0]
    assert solve_impact(SLIM, SLIM.turning(-0.4767)).segments == limit.segments

    seen = []
    monkeypatch.setattr(exact, "rest_of_jams", lambda before, after, *_: seen.append(after[0]))
    with pytest.raises(exact.Undecided, match="too long"):
        exact.path(problem)
    factors = [float(after[NB] / before[NB]) for before, after in pairwise(seen)]
    assert factors == pytest.approx([factors[0]] * len(factors))
    assert 0.0 < seen[-1][NB] / problem.velocities[NB] < 1e-9


def test_restitution_goes_on_after_jams_without_end():
    plastic, elastic = (
        exact.path(exact.problem_of(SLIM._replace(new=SLIM.new._replace(restitution=each)), SLIM.turning(-0.4767)))
        for each in (0.0, 0.5)
    )
    assert elastic.segments[: len(plastic.segments)] == plastic.segments
    assert elastic.impulses[NB] == Fraction(3, 2) * plastic.impulses[NB]
    assert elastic.history[-1][NB] > 0
