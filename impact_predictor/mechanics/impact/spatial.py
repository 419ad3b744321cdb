"""One impact on any number of contacts in three dimensions, `solve_spatial_impact`, and many at once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled import door
from ..types import ContactState, Flag
from . import spatial_body, spatial_path
from .solve import number_of
from .spatial_body import ANSWER, BODY, CONTACT, INVALID, RESULT, SYMMETRY, coordinates, room
from .spatial_path import BLENDED, NOT_CONVERGED

STEPS = 8
"""Steps for a quarter of an oscillation: they err by a tenth of what measured impacts scatter."""

MERGE = 1.5e-3
"""How long a compression lasts, in s, unless more is known."""

FLAGS = {NOT_CONVERGED: Flag.NOT_CONVERGED, BLENDED: Flag.ENERGY_GAINED, INVALID: Flag.INVALID_INPUT}
"""The flags of the law code by their names."""

UP = (0.0, 0.0, 1.0)
AT_REST = (0.0, 0.0, 0.0)


STATES = tuple(ContactState)


class Body(NamedTuple):
    """A rigid body: `mass` in kg, `inertia` about the mass centre in kg m^2, along the axes of the twist.

    The inertia is one number (the same about every axis), three (along the axes), six (ixx, iyy, izz, ixy, ixz, iyz),
    or a tensor (3, 3).
    """

    mass: ArrayLike
    inertia: ArrayLike


class ContactPoints(NamedTuple):
    """The n contacts that take part in an impact: those that strike, and those that rest.

    `positions` (n, 3) in m from the mass centre; `friction` and `restitution` (0 to 1) one number, or (n,); unit
    `normals` (n, 3) out of the supports; `velocities` (n, 3) of the supports at the contacts in m/s; `gaps` (n,) in m
    that are still open when the first contact closes (0 or below: none). One normal, or one velocity, is that of all.
    """

    positions: ArrayLike
    friction: ArrayLike
    restitution: ArrayLike = 0.0
    normals: ArrayLike = UP
    velocities: ArrayLike = AT_REST
    gaps: ArrayLike = 0.0


class SpatialOutcome(NamedTuple):
    """What an impact does to a body, or to a mechanism.

    `twist` (6,) right after it: vx, vy, vz of the mass centre in m/s, wx, wy, wz in rad/s; None of a mechanism.
    `impulses` (n, 3) in N s, and `velocities` (n, 3) of the contacts after it in m/s, relative to their supports: along
    the axes of the twist, of a mechanism along t1, t2 and the normal of each contact. `states` of the contacts;
    `energy_lost` in J, relative to the supports.
    """

    twist: NDArray[np.float64] | None
    impulses: NDArray[np.float64]
    velocities: NDArray[np.float64]
    states: tuple[ContactState, ...]
    flags: Flag
    energy_lost: float
    law: str


class SpatialOutcomes(NamedTuple):
    """What many impacts do: the fields of `SpatialOutcome`, each after the axes (...) of the problems.

    `states` (..., n) are the numbers of `ContactState`, `flags` (...) the bits of `Flag`.
    """

    twist: NDArray[np.float64]
    impulses: NDArray[np.float64]
    velocities: NDArray[np.float64]
    states: NDArray[np.uint8]
    flags: NDArray[np.uint16]
    energy_lost: NDArray[np.float64]


def solve_spatial_impact(
    body: Body | ArrayLike,
    contacts: ContactPoints,
    twist: ArrayLike,
    law: str = "path",
    merge: float = MERGE,
    threshold: float = 0.0,
    steps: int = STEPS,
) -> SpatialOutcome:
    """What an impact on any number of contacts does to a body in three dimensions.

    `body` is a `Body`, and `twist` (6,) its own right before: vx, vy, vz of the mass centre and wx, wy, wz. Or `body`
    is the Delassus matrix W (3 n, 3 n) = G M^-1 G^T of any mechanism, and `twist` (3 n,) has its contact velocities,
    both in the order t1, t2, normal of one contact after the other; of the contacts only friction and restitution are
    read.

    Contacts that approach faster than `threshold` (m/s) are struck, the others rest. One with a gap closes as the
    impact goes on, of which a compression lasts `merge` (s); with 0 it does not. `law` is "path" (Routh's path in
    three dimensions with energetic restitution; its error falls with `steps`, those of a quarter of an oscillation of a
    contact) or "total" (complementarity of the impulses of the whole impact, Newton's restitution).

    Numbers that no body can have give Flag.INVALID_INPUT, never an exception; an unknown law, settings that are no
    numbers and arrays of another shape raise ValueError. Sources: Routh and Keller (path), Stronge (restitution).
    """
    if not isinstance(body, Body):
        return _solve_mechanism(
            np.asarray(body, float), contacts, np.asarray(twist, float), law, merge, threshold, steps
        )
    positions = np.asarray(contacts.positions, float)
    if positions.ndim != 2:
        raise ValueError(f"the positions have the shape {positions.shape}; give (n, 3)")
    how, n = _settings(law, merge, threshold, steps), len(positions)
    problem = np.empty(BODY + n * CONTACT)
    # The same as `_together` for one problem, which takes a fifth of the time.
    of_each = problem[BODY:].reshape(n, CONTACT)
    try:
        problem[0], problem[1:7], problem[7:BODY] = body.mass, _six_numbers(np.asarray(body.inertia, float)), twist
        of_each[:, :3], of_each[:, 3:6], of_each[:, 6] = positions, contacts.normals, contacts.friction
        of_each[:, 7], of_each[:, 8:11], of_each[:, 11] = contacts.restitution, contacts.velocities, contacts.gaps
    except ValueError:
        solve_spatial_impacts(body, contacts, twist)  # says which array has another shape
        raise
    return solve_body(problem, law, *how[1:])


def solve_body(
    problem: NDArray[np.float64],
    law: str = "path",
    merge: float = MERGE,
    threshold: float = 0.0,
    steps: int = STEPS,
) -> SpatialOutcome:
    """`solve_spatial_impact` of a body, told by the numbers of a problem (see `spatial_body`)."""
    n, total = (len(problem) - BODY) // CONTACT, bool(number_of(law))
    answer, notes = np.empty(ANSWER + n * RESULT), np.empty(1, np.int64)
    solver()(n, problem[None], total, merge, threshold, steps, answer[None], notes, *workspace(n))
    of_each = answer[ANSWER:].reshape(n, RESULT)
    return SpatialOutcome(
        twist=answer[:6],
        impulses=of_each[:, :3],
        velocities=of_each[:, 3:6],
        states=tuple([STATES[int(number)] for number in of_each[:, 6].tolist()]),
        flags=flags_named(int(notes[0])),
        energy_lost=float(answer[6]),
        law=law,
    )


def solve_spatial_impacts(
    bodies: Body,
    contacts: ContactPoints,
    twist: ArrayLike,
    law: str = "path",
    merge: float = MERGE,
    threshold: float = 0.0,
    steps: int = STEPS,
) -> SpatialOutcomes:
    """What many impacts do: `solve_spatial_impact` for each element of arrays that broadcast together.

    Every field of `bodies` and `contacts`, and `twist`, may have more axes before its own; the number of contacts is
    one for all. An inertia of one number for each of many bodies has the shape (..., 1).
    """
    how = _settings(law, merge, threshold, steps)
    positions = _ending_in(3, contacts.positions, "the positions")
    if positions.ndim < 2:
        raise ValueError(f"the positions have the shape {positions.shape}; give (n, 3)")
    n = positions.shape[-2]
    of_contacts = _together(
        positions,
        _of_all(_ending_in(3, contacts.normals, "the normals")),
        _for_each(n, contacts.friction, "friction")[..., None],
        _for_each(n, contacts.restitution, "restitution")[..., None],
        _of_all(_ending_in(3, contacts.velocities, "the velocities")),
        _for_each(n, contacts.gaps, "the gaps")[..., None],
    )
    if of_contacts.shape[-2] != n:
        raise ValueError(f"there are {n} positions, and {of_contacts.shape[-2]} normals or velocities")
    problems = _together(
        np.asarray(bodies.mass, float)[..., None],
        _six_numbers(np.asarray(bodies.inertia, float)),
        _ending_in(6, twist, "a twist"),
        of_contacts.reshape(*of_contacts.shape[:-2], n * CONTACT),
    )
    shape = problems.shape[:-1]
    # Of another order of its numbers it would be compiled once more.
    problems = np.ascontiguousarray(problems.reshape(-1, BODY + n * CONTACT))
    answers, notes = np.zeros((len(problems), ANSWER + RESULT * n)), np.zeros(len(problems), np.int64)
    solver()(n, problems, *how, answers, notes, *workspace(n))
    answers = answers.reshape(*shape, ANSWER + RESULT * n)
    of_each = answers[..., ANSWER:].reshape(*shape, n, RESULT)
    return SpatialOutcomes(
        twist=answers[..., :6],
        impulses=of_each[..., :3],
        velocities=of_each[..., 3:6],
        states=of_each[..., 6].astype(np.uint8),
        flags=_flags(notes).reshape(shape),
        energy_lost=answers[..., 6],
    )


def _solve_mechanism(
    W: NDArray[np.float64],
    contacts: ContactPoints,
    c: NDArray[np.float64],
    law: str,
    merge: float,
    threshold: float,
    steps: int,
) -> SpatialOutcome:
    how, m = _settings(law, merge, threshold, steps), c.size
    if m % 3 or c.shape != (m,) or W.shape != (m, m):
        raise ValueError(f"W has the shape {W.shape} and the velocities {c.shape}; give (3 n, 3 n) and (3 n,)")
    n = m // 3
    friction = np.array(_for_each(n, contacts.friction, "friction"))
    restitution = np.array(_for_each(n, contacts.restitution, "restitution"))
    gaps = np.array(_for_each(n, contacts.gaps, "the gaps"))
    is_known = np.isfinite(friction) & (friction >= 0.0) & (restitution >= 0.0) & (restitution <= 1.0)
    if is_known.all() and np.isfinite(c).all() and _is_delassus(W):
        return solve_delassus(0.5 * (W + W.T), friction, restitution, gaps, c, law, *how[1:])
    return SpatialOutcome(
        twist=None,
        impulses=np.zeros((n, 3)),
        velocities=np.where(np.isfinite(c), c, 0.0).reshape(n, 3),
        states=(STATES[0],) * n,
        flags=flags_named(INVALID),
        energy_lost=0.0,
        law=law,
    )


def solve_delassus(
    W: NDArray[np.float64],
    friction: NDArray[np.float64],
    restitution: NDArray[np.float64],
    gaps: NDArray[np.float64],
    c: NDArray[np.float64],
    law: str = "path",
    merge: float = MERGE,
    threshold: float = 0.0,
    steps: int = STEPS,
) -> SpatialOutcome:
    """`solve_spatial_impact` of a mechanism, symmetric W (3 n, 3 n) and c (3 n,), without looking whether it is one.

    `friction`, `restitution` and `gaps` are (n,). This takes a third of the time.
    """
    n, total = len(friction), bool(number_of(law))
    impulse, after = np.zeros(3 * n), c.copy()
    work, marks = workspace(n, coordinates(n))
    notes = mechanism_solver()(
        n, W.ravel(), friction, restitution, gaps, total, merge, threshold, steps, c, after, impulse, work, marks
    )
    return SpatialOutcome(
        twist=None,
        impulses=impulse.reshape(n, 3),
        velocities=after.reshape(n, 3),
        states=tuple([STATES[mark] for mark in marks[:n].tolist()]),
        flags=flags_named(notes),
        energy_lost=-float((0.5 * impulse * (c + after)).sum()),
        law=law,
    )


def _settings(law: str, merge: float, threshold: float, steps: int) -> tuple[bool, float, float, int]:
    """How the law code solves a problem."""
    number = number_of(law)
    if not (0.0 <= merge < inf and 0.0 <= threshold < inf and 1 <= steps < inf):
        raise ValueError(
            f"merge is {merge}, threshold {threshold} and steps {steps}; give finite numbers, 0 or above, and a step"
        )
    return bool(number), float(merge), float(threshold), int(steps)


def _is_delassus(W: NDArray[np.float64]) -> bool:
    """Whether W is finite, symmetric and positive semidefinite, up to rounding on its diagonal."""
    if not np.isfinite(W).all():
        return False
    size = np.sqrt(np.abs(W.diagonal()))
    size[size == 0.0] = 1.0
    scaled = W / size / size[:, None]
    is_symmetric = (np.abs(scaled - scaled.T) <= SYMMETRY).all()
    return bool(is_symmetric and np.linalg.eigvalsh(scaled).min(initial=0.0) >= -SYMMETRY * len(W))


def _ending_in(size: int, field: ArrayLike, name: str) -> NDArray[np.float64]:
    array = np.asarray(field, float)
    if array.shape[-1:] != (size,):
        raise ValueError(f"{name} has the shape {array.shape}; the last axis has {size} numbers")
    return array


def _of_all(field: NDArray[np.float64]) -> NDArray[np.float64]:
    """A vector for each contact, of one for all of them."""
    return field if field.ndim > 1 else field[None]


def _for_each(n: int, field: ArrayLike, name: str) -> NDArray[np.float64]:
    """A number for each contact (..., n)."""
    array = np.asarray(field, float)
    if array.shape == (n,):
        return array
    if array.shape[-1:] not in ((), (1,), (n,)):
        raise ValueError(f"{name} has the shape {array.shape}; give one number, or one for each of {n} contacts")
    return np.broadcast_to(array, (*array.shape[:-1], n))


def _together(*fields: NDArray[np.float64]) -> NDArray[np.float64]:
    """Arrays that broadcast together but for their last axis, one after the other along it."""
    shape = np.broadcast_shapes(*(field.shape[:-1] for field in fields))
    return np.concatenate([np.broadcast_to(field, shape + field.shape[-1:]) for field in fields], axis=-1)


def _six_numbers(inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inertia as ixx, iyy, izz, ixy, ixz, iyz; a tensor that is not symmetric is no number."""
    if inertia.ndim > 1 and inertia.shape[-2:] == (3, 3):
        gap = np.abs(inertia - np.swapaxes(inertia, -1, -2)).max(axis=(-1, -2))
        known = gap <= SYMMETRY * np.abs(inertia).max(axis=(-1, -2))
        return np.where(known[..., None], inertia[..., (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)], np.nan)
    if inertia.shape[-1:] not in ((), (1,), (3,), (6,)):
        raise ValueError(f"an inertia has the shape {inertia.shape}; give one number, three, six, or (3, 3)")
    if inertia.shape[-1:] == (6,):
        return inertia
    moments = np.broadcast_to(inertia, (*inertia.shape[:-1], 3))
    return np.concatenate([moments, np.zeros_like(moments)], axis=-1)


@cache
def flags_named(notes: int) -> Flag:
    return Flag(sum(int(flag) for note, flag in FLAGS.items() if notes & note))


def _flags(notes: NDArray[np.int64]) -> NDArray[np.uint16]:
    flags = np.zeros(notes.shape, np.uint16)
    for note, flag in FLAGS.items():
        flags |= np.where(notes & note, int(flag), 0).astype(np.uint16)
    return flags


@lru_cache(maxsize=16)
def workspace(n: int, motion: int = 6) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Numbers and marks that the law code of n contacts works with, and `motion` coordinates.

    All that use it share it: law code keeps nothing in it, and holds Python's lock while it runs.
    """
    return np.empty(room(n, motion)), np.zeros(2 * n, np.int64)


@cache
def solver() -> Callable[..., None]:
    """The law code of many bodies, compiled if that can be; the first time on a machine this takes some seconds."""
    return door(spatial_body.strike_all, USED, INLINED)


@cache
def mechanism_solver() -> Callable[..., int]:
    """The law code of a mechanism, in the same way."""
    return door(spatial_body.strike_mechanism, USED, INLINED)


USED = (spatial_path,)
INLINED = (spatial_path.velocities, spatial_path.push)
