"""Many impacts by several threads: each answer in its own place, to the last bit, whatever the fields look like."""

import math
import os
import threading
from functools import partial

import numpy as np
import pytest
from alone import alone

from impact_predictor import Flag, plate, solve_impact, solve_impacts
from impact_predictor.mechanics.impact import batch
from impact_predictor.mechanics.random_problems import problems_of

pytest.importorskip("numba")

PART = batch.PART
SIZES = (0, 1, PART - 1, PART, PART + 1, 2 * PART + batch.CHUNK + 1, 5 * PART + 3)
"""Of batches: within one part, at its border, within a chunk of a later part."""


def changed(values, change):
    """Values whose fields are arrays, each changed."""
    if isinstance(values, tuple):
        parts = [changed(part, change) for part in values]
        return type(values)(*parts) if hasattr(values, "_fields") else tuple(parts)
    return change(values) if isinstance(values, np.ndarray) else values


def by(threads, monkeypatch, *problem):
    """The outcomes on a machine with as many processors as `threads`, and the threads that solved them."""
    fill, names = batch.chunk_solver(), set()

    class Watched:
        def __call__(self, *given):
            names.add(threading.get_ident())
            fill(*given)

    with monkeypatch.context() as patch:
        patch.setattr(batch, "processors", lambda: threads)
        patch.setattr(batch, "FEWEST", 1)
        patch.setattr(batch, "chunk_solver", Watched)
        return solve_impacts(*problem), names


def bits(outcomes):
    return [(field.shape, field.tobytes()) for field in outcomes]


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("size", SIZES)
def test_several_threads_give_the_bits_of_one(size, law, monkeypatch):
    _, body, twist = problems_of("wedge", np.random.default_rng(3), size)
    alike, names = by(1, monkeypatch, body, twist, law)
    assert names <= {threading.get_ident()}
    for threads in (2, 3, 7):
        outcomes, names = by(threads, monkeypatch, body, twist, law)
        assert bits(outcomes) == bits(alike)
        assert len(names) <= threads


def test_by_threads_each_element_has_the_answer_that_it_has_alone(monkeypatch):
    _, body, twist = problems_of("tilted", np.random.default_rng(4), 3 * PART + 5)
    outcomes, _ = by(3, monkeypatch, body, twist)
    for i, problem in enumerate(zip(alone(body), alone(twist), strict=True)):
        if i % 7 == 0 or i % PART in (0, 1, PART - 1):
            one = solve_impact(*problem)
            assert (outcomes.mode[i], outcomes.flags[i], outcomes.unique[i]) == (one.mode, one.flags, one.unique)
            assert tuple(outcomes.twist[i]) == one.twist
            assert outcomes.impulses[i].tolist() == [list(pair) for pair in one.impulses]
            assert outcomes.energy_lost[i] == one.energy_lost


@pytest.mark.parametrize("shape", [(3, PART - 1), (PART + 1, 3), (2, 3, PART // 2 + 1)])
def test_by_threads_fields_of_any_shape_broadcast_together(shape, monkeypatch):
    heights = np.linspace(0.1, 3.0, shape[0]).reshape(-1, *[1] * (len(shape) - 1))
    body = plate(length=1.0, height=heights, mass=10.0, friction=np.linspace(0.0, 1.2, shape[-1]))
    body = body._replace(inertia=body.inertia * np.linspace(0.5, 1.0, math.prod(shape[1:])).reshape(shape[1:]))
    twist = body.turning(omega=-1.0)
    outcomes, _ = by(2, monkeypatch, body, twist)
    assert outcomes.mode.shape == shape
    whole = changed((body, twist), lambda field: np.ascontiguousarray(np.broadcast_to(field, shape).ravel()))
    alike, _ = by(1, monkeypatch, *whole)
    assert [field.tobytes() for field in outcomes] == [field.tobytes() for field in alike]


def reversed_in_memory(field):
    return np.ascontiguousarray(field[::-1])[::-1]


def each_third_of_another(field):
    return np.repeat(field, 3)[1::3]


def unaligned(field):
    records = np.zeros(field.shape, [("byte", "u1"), ("field", "f8")])
    records["field"] = field
    return records["field"]


def of_other_bytes(field):
    return field.astype(field.dtype.newbyteorder())


@pytest.mark.parametrize("change", [reversed_in_memory, each_third_of_another, unaligned, of_other_bytes])
def test_by_threads_fields_may_lie_in_memory_as_they_like(change, monkeypatch):
    problem = problems_of("floor", np.random.default_rng(5), 2 * PART + 77)[1:]
    alike, _ = by(1, monkeypatch, *problem)
    for threads in (1, 2):
        outcomes, _ = by(threads, monkeypatch, *changed(problem, change))
        assert bits(outcomes) == bits(alike)


def test_the_fields_are_left_as_they_are(monkeypatch):
    problem = problems_of("plate", np.random.default_rng(6), 2 * PART)[1:]
    before = changed(problem, np.copy)
    by(2, monkeypatch, *problem)
    for now, then in zip(alone(problem), alone(before), strict=True):
        assert now == then


def test_by_threads_a_bad_number_spoils_its_own_element_alone(monkeypatch):
    _, body, twist = problems_of("plate", np.random.default_rng(6), 3 * PART + 1)
    good, _ = by(2, monkeypatch, body, twist)
    bad = [0, PART - 1, PART, 2 * PART + 5, 3 * PART]
    body.mass[bad] = [math.nan, -1.0, math.inf, 0.0, math.nan]
    outcomes, _ = by(2, monkeypatch, body, twist)
    assert np.flatnonzero(outcomes.flags & Flag.INVALID_INPUT).tolist() == bad
    others = np.setdiff1d(np.arange(3 * PART + 1), bad)
    assert bits(field[others] for field in outcomes) == bits(field[others] for field in good)


def replaced(monkeypatch, fill):
    """Solve with another function than the compiled one, on a machine of two processors."""
    monkeypatch.setattr(batch, "processors", lambda: 2)
    monkeypatch.setattr(batch, "chunk_solver", lambda: partial(fill))


def bodies(count):
    body = plate(length=1.0, height=np.full(count, 0.4), mass=10.0, friction=0.2)
    return body, body.turning(omega=-1.0)


def test_two_threads_solve_at_the_same_time(monkeypatch):
    barrier, starts = threading.Barrier(2, timeout=60), []

    def fill(columns, stands, law, validity, start, outcomes):
        if len(columns[0]) > 1:  # else what is to be compiled first
            starts.append(start)
            barrier.wait()

    replaced(monkeypatch, fill)
    solve_impacts(*bodies(2 * batch.FEWEST))
    assert sorted(starts) == list(range(0, 2 * batch.FEWEST, batch.CHUNK))


def test_few_impacts_are_solved_without_threads(monkeypatch):
    names = set()
    replaced(monkeypatch, lambda *given: names.add(threading.get_ident()))
    solve_impacts(*bodies(2 * batch.FEWEST - 1))
    assert names == {threading.get_ident()}


@pytest.mark.parametrize("failing_is_main", [False, True])
def test_what_a_thread_raises_is_raised(failing_is_main, monkeypatch):
    both, failed, calls = threading.Barrier(2, timeout=60), threading.Event(), []

    def fill(columns, stands, law, validity, start, outcomes):
        if len(columns[0]) == 1:
            return
        calls.append(start)
        is_main = threading.get_ident() == main
        if len(calls) <= 2:
            both.wait()
        if is_main == failing_is_main:
            failed.set()
            raise MemoryError("of one thread")
        failed.wait(60)

    main = threading.get_ident()
    replaced(monkeypatch, fill)
    with pytest.raises(MemoryError, match="of one thread"):
        solve_impacts(*bodies(2 * batch.FEWEST))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs Linux")
def test_threads_are_as_many_as_the_processors_that_the_process_may_use():
    usual = os.sched_getaffinity(0)
    assert batch.processors() == len(usual)
    try:
        os.sched_setaffinity(0, {min(usual)})
        assert batch.processors() == 1
    finally:
        os.sched_setaffinity(0, usual)


def test_bodies_without_an_old_contact_are_solved_by_threads_too(monkeypatch):
    problem = problems_of("one-point", np.random.default_rng(9), PART + 9)[1:]
    assert problem[0].old is None
    assert bits(by(2, monkeypatch, *problem)[0]) == bits(by(1, monkeypatch, *problem)[0])
