"""Many impacts at once: the same answers as one by one, to the last bit, in the shape that the fields broadcast to."""

import math
import os
import shutil
import subprocess
import sys
from pathlib import Path
from struct import pack

import numpy as np
import pytest
from alone import alone

import impact_predictor
from impact_predictor import (
    Contact,
    Flag,
    InputError,
    Twist,
    TwoPointBody,
    Validity,
    cylinder,
    plate,
    rod,
    solve_impact,
    solve_impacts,
)
from impact_predictor.mechanics.impact import batch, states_of
from impact_predictor.mechanics.random_problems import KINDS, problems_of

EACH = 100_000 // len(KINDS) + 1
"""Random problems of each kind, 1e5 in all."""

LAWS = ("path", "total")


def row(outcome):
    """The numbers of one outcome as `rows_of` has them."""
    numbers = (*outcome.twist, *outcome.impulses[0], *outcome.impulses[1], outcome.energy_lost)
    return (pack("8d", *numbers), outcome.mode, outcome.segments, outcome.flags, outcome.unique)


def rows_of(outcomes):
    """Numbers as bytes, mode, segments, flags and uniqueness of each of the outcomes (n,)."""
    numbers = np.column_stack([outcomes.twist, outcomes.impulses.reshape(-1, 4), outcomes.energy_lost])
    segments = map(states_of, outcomes.segments.tolist())
    return list(
        zip(
            map(bytes, numbers),
            outcomes.mode.tolist(),
            segments,
            outcomes.flags.tolist(),
            outcomes.unique.tolist(),
            strict=True,
        )
    )


def row_of(outcomes, i):
    return rows_of(type(outcomes)(*(field[i][None] for field in outcomes)))[0]


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_many_impacts_have_the_answers_of_each_alone_to_the_last_bit(kind, law):
    _, body, twist = problems_of(kind, np.random.default_rng(7), EACH)
    outcomes = solve_impacts(body, twist, law)
    each = [row(solve_impact(*problem, law)) for problem in zip(alone(body), alone(twist), strict=True)]
    assert each == rows_of(outcomes)


def test_many_impacts_have_one_validity_of_rigid_theory():
    bodies = rod(length=0.4, thickness=np.array([0.002, 0.02]), a=0.1, b=0.1, mass=0.3, friction=0.4)
    usual = solve_impacts(bodies, bodies.turning(omega=-3.0)).flags
    strict = solve_impacts(bodies, bodies.turning(omega=-3.0), validity=Validity(slenderness=1, contact_time=1)).flags
    both = Flag.THIN_BODY | Flag.SLOW_IMPACT
    assert list(usual & both) == [Flag.THIN_BODY, 0]
    assert list(strict & both) == [both, both]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_without_numba_the_same_code_gives_the_same_bits(kind, law, monkeypatch):
    _, body, twist = problems_of(kind, np.random.default_rng(8), 50)
    compiled = solve_impacts(body, twist, law)
    monkeypatch.setitem(sys.modules, "numba", None)  # an import of it fails
    batch.chunk_solver.cache_clear()
    try:
        plain = solve_impacts(body, twist, law)
    finally:
        batch.chunk_solver.cache_clear()
    assert [field.tobytes() for field in plain] == [field.tobytes() for field in compiled]


def test_fields_of_any_shape_broadcast_together():
    heights, frictions = np.linspace(0.1, 3.0, 7)[:, None], np.linspace(0.0, 1.2, 5)
    bodies = plate(length=1.0, height=heights, mass=10.0, friction=frictions)
    outcomes = solve_impacts(bodies, bodies.turning(omega=-1.0))
    assert outcomes.mode.shape == (7, 5)
    assert outcomes.twist.shape == (7, 5, 3)
    assert outcomes.impulses.shape == (7, 5, 2, 2)
    for i in range(7):
        for j in range(5):
            body = plate(length=1.0, height=float(heights[i, 0]), mass=10.0, friction=float(frictions[j]))
            assert row_of(outcomes, (i, j)) == row(solve_impact(body, body.turning(omega=-1.0)))


@pytest.mark.parametrize("shape", [(), (3,), (0, 4)])
def test_the_outcome_has_the_shape_of_its_fields_and_begins_another_impact(shape):
    body = plate(length=1.0, height=np.full(shape, 0.4), mass=10.0, friction=0.2, restitution=0.5)
    outcomes = solve_impacts(body, body.turning(omega=-1.0))
    assert (outcomes.mode.shape, outcomes.twist.shape) == (shape, (*shape, 3))
    again = solve_impacts(body, outcomes.twist)
    assert again.mode.shape == shape
    if outcomes.mode.size:
        one = plate(1.0, 0.4, 10.0, 0.2, restitution=0.5)
        last = again.twist.reshape(-1, 3)[-1]
        assert tuple(last) == solve_impact(one, solve_impact(one, one.turning(-1.0)).twist).twist


def test_normals_and_velocities_of_supports_may_be_arrays_part_by_part():
    speeds = np.array([0.0, 0.5, 1.0])
    old, new = Contact(-0.5, -0.2, 0.3), Contact(0.5, -0.2, 0.3, normal=(0.0, np.ones(3)), velocity=(speeds, 0.0))
    outcomes = solve_impacts(TwoPointBody(1.0, 0.1, old, new), Twist(0.0, -0.5, -1.0))
    for i, speed in enumerate(speeds):
        body = TwoPointBody(1.0, 0.1, old, new._replace(normal=(0.0, 1.0), velocity=(float(speed), 0.0)))
        assert row_of(outcomes, i) == row(solve_impact(body, Twist(0.0, -0.5, -1.0)))


def test_whole_numbers_and_single_precision_are_taken_as_they_are():
    body = TwoPointBody(np.int32(2), np.float32(0.5), Contact(-1, -1, 0), Contact(1, -1, np.array([0, 1])))
    outcomes = solve_impacts(body, Twist(0, -1, -1))
    second = solve_impact(TwoPointBody(2.0, 0.5, Contact(-1, -1, 0), Contact(1, -1, 1)), Twist(0, -1, -1))
    assert row_of(outcomes, 1) == row(second)


def test_a_bad_number_spoils_its_own_element_alone():
    masses = np.array([1.0, math.nan, -1.0, 2.0])
    body = TwoPointBody(masses, 0.1, Contact(-0.5, -0.2, 0.3), Contact(0.5, -0.2, 0.3))
    outcomes = solve_impacts(body, Twist(0.0, -0.5, -1.0))
    assert list(outcomes.flags & Flag.INVALID_INPUT > 0) == [False, True, True, False]
    assert np.isfinite(outcomes.twist).all()


def test_shapes_that_do_not_fit_and_unknown_laws_are_refused():
    body = TwoPointBody(np.ones(3), np.ones(4), Contact(-0.5, -0.2, 0.3), Contact(0.5, -0.2, 0.3))
    with pytest.raises(ValueError, match="broadcast"):
        solve_impacts(body, Twist(0.0, -0.5, -1.0))
    with pytest.raises(ValueError, match="law is 'newton'"):
        solve_impacts(body, Twist(0.0, -0.5, -1.0), law="newton")
    with pytest.raises(ValueError, match=r"the twist has the shape \(3, 2\)"):
        solve_impacts(body, np.zeros((3, 2)))


def test_an_array_with_a_number_that_no_body_can_have_is_refused_with_that_number():
    with pytest.raises(InputError, match=r"friction is -0\.1"):
        plate(length=1.0, height=1.0, mass=1.0, friction=np.array([0.3, -0.1]))
    with pytest.raises(InputError, match="gamma"):
        cylinder(radius=1.0, gamma=np.array([0.5, 2.0]), mass=1.0, friction=0.3)


READ_ONLY = """
from impact_predictor.mechanics.impact.batch import chunk_solver
fill = chunk_solver()
print(type(fill).__module__.split(".")[0], fill.stats.cache_path)
"""


@pytest.mark.slow
def test_an_installation_in_which_nothing_can_be_written_works_too(tmp_path):
    pytest.importorskip("numba")
    package = Path(impact_predictor.__file__).parent
    copy = tmp_path / "impact_predictor"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("__pycache__"))
    nowhere = tmp_path / "nowhere"
    nowhere.write_text("a file, in which no folder can be made")
    # A file where numba would make its folder beside the code: that holds for root too.
    (copy / "mechanics" / "__pycache__").write_text("")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "HOME": str(nowhere), "XDG_CACHE_HOME": str(nowhere)}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", READ_ONLY]
    ran = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
    # Where the compiled code would be kept is decided here; that it answers right is shown above.
    assert ran.stdout.split() == ["numba", "None"]
