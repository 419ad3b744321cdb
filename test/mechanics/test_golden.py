"""Impacts decided in exact rational arithmetic: golden/impacts.json (see golden/README.md)."""

import sys

import pytest
from exact_error import error_of
from golden_impacts import CASES, KINDS, body_of
from seen_by_contacts import velocities

from impact_predictor import Flag, Twist, solve_impact

CLOSE = 1e-11
"""Largest error of a contact velocity, as a part of the largest contact speed before the impact."""
ANSWERS = {"routh": ("path", 0.0), "routh_e0.5": ("path", 0.5), "total": ("total", 0.0)}


def sizes_of(case, twist):
    """The sizes of the terms of the contact velocities that a rounding of the twist is a part of."""
    vx, vy, omega = map(abs, twist)
    return [vx + vy + omega * (abs(each["x"]) + abs(each["y"])) for each in case["contacts"] for _ in range(2)]


def is_close(case, twist, reference):
    """Up to CLOSE or, where the body is far faster than its contacts, up to the rounding of the two twists."""
    body = body_of(case)
    largest = max(map(abs, velocities(body, case["twist"])[0]))
    ours, theirs = velocities(body, twist)[0], velocities(body, reference)[0]
    return all(
        abs(one - other) <= max(CLOSE * largest, 2.0 * sys.float_info.epsilon * size)
        for one, other, size in zip(ours, theirs, sizes_of(case, twist), strict=True)
    )


@pytest.mark.parametrize("answer", ["routh", "routh_e0.5"])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "both"])
def test_the_path_law_ends_where_exact_arithmetic_ends(kind, answer):
    law, restitution = ANSWERS[answer]
    decided = [case for case in CASES if case["kind"] == kind and case[answer] is not None]
    assert len(decided) > 50
    for case in decided:
        outcome = solve_impact(body_of(case, restitution), Twist(*case["twist"]), law)
        assert outcome.law == "path"
        assert is_close(case, outcome.twist, case[answer]["twist"]), case


@pytest.mark.parametrize("kind", KINDS)
def test_the_total_law_finds_every_solution_and_answers_with_one_of_them(kind):
    for case in (case for case in CASES if case["kind"] == kind):
        outcome = solve_impact(body_of(case), Twist(*case["twist"]), "total")
        found = [outcome.twist, *(other.twist for other in outcome.alternatives)]
        references = [solution["twist"] for solution in case["total"]]
        assert any(is_close(case, outcome.twist, reference) for reference in references), case
        assert all(any(is_close(case, twist, reference) for twist in found) for reference in references), case
        assert outcome.unique == (len(found) == 1)


def test_impulses_and_segments_are_those_of_exact_arithmetic_where_no_segment_leaves_a_choice():
    compared = 0
    for case in CASES:
        for answer in ("routh", "routh_e0.5"):
            reference = case.get(answer)
            if reference is None or "SS" in reference["path"] or case["kind"] == "extreme":
                continue
            law, restitution = ANSWERS[answer]
            outcome = solve_impact(body_of(case, restitution), Twist(*case["twist"]), law)
            size = max(abs(part) for pair in reference["impulses"] for part in pair)
            for ours, theirs in zip(outcome.impulses, reference["impulses"], strict=True):
                # The impulses of slender bodies have a condition number of up to 1e4.
                assert ours == pytest.approx(theirs, abs=1e-11 * size), case
            assert outcome.segments == tuple(reference["path"]), case
            compared += 1
    assert compared > 500


def test_a_path_that_jams_ends_where_exact_arithmetic_ends_without_approach_or_gain_of_energy():
    jammed = [case for case in CASES if "routh" in case and case["routh"] is None]
    assert jammed
    for case in jammed:
        for restitution in (0.0, 0.5):
            outcome = solve_impact(body_of(case, restitution), Twist(*case["twist"]))
            assert outcome.flags & Flag.JAMMED
            assert outcome.energy_lost >= 0.0
            error_of(outcome.body, outcome.before, "path")
            speeds = velocities(outcome.body, outcome.twist)[0]
            assert min(speeds[0], speeds[2]) >= -1e-12 * max(sizes_of(case, outcome.twist))
