"""Many impacts at once: `solve_impacts`, the law code of `solve_impact` over arrays.

It is compiled where numba is installed, and then takes all processors; it runs as plain Python where numba is not. The
answers are the same to the last bit.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from inspect import isfunction
from math import prod
from numbers import Real
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from ...native import as_python
from ..compiled import compiled
from ..types import Contact, Twist, TwoPointBody, Validity
from .answer import VALIDITY
from .solve import NOWHERE, number_of

CHUNK = 2048
"""Impacts that are handed over at a time, so that the copies of broadcast fields stay small."""

PART = 4 * CHUNK
"""Impacts that a thread takes at a time: it is done with them within two milliseconds."""

FEWEST = 32768
"""Impacts for each thread: with fewer it is not worth its start, which takes milliseconds on a busy machine."""

LAW_CODE = tuple(
    as_python(f"mechanics.{name}")
    for name in (
        "types",
        "impact.contacts",
        "impact.rates",
        "impact.restitution",
        "impact.path_law",
        "impact.total_law",
        "impact.answer",
    )
)
"""As Python, which numba reads."""

_, _, _, _, path_law, total_law, answer = LAW_CODE

CALLED = (path_law.solve, total_law.solve, total_law.any_that_holds, total_law.all_that_hold)
"""Law functions that are compiled on their own. All others become a part of those that call them, which halves the
time: calls with so many numbers are slow."""


ChunkSolver = Callable[[Any, bool, int, Validity, int, "Outcomes"], None]
"""Solves a chunk: columns of the fields, whether a body stands, the law, validity, the index of the first, outcomes."""


class Outcomes(NamedTuple):
    """What many impacts do, in the shape (...) that the fields of the bodies and of the twist broadcast to.

    `mode` (...) uint8, the numbers of `Mode`; `twist` (..., 3) as vx, vy in m/s and omega in rad/s right after;
    `impulses` (..., 2, 2) as ((N_old, T_old), (N_new, T_new)) in N s; `segments` (...) int64, the contact states along
    the impulse path as `states_of` reads them; `flags` (...) uint16, the bits of `Flag`; `energy_lost` (...) in J,
    relative to the supports; `unique` (...) bool, False where the law allows other answers, which `solve_impact` tells.
    """

    mode: NDArray[np.uint8]
    twist: NDArray[np.float64]
    impulses: NDArray[np.float64]
    segments: NDArray[np.int64]
    flags: NDArray[np.uint16]
    energy_lost: NDArray[np.float64]
    unique: NDArray[np.bool_]


def solve_impacts(
    bodies: TwoPointBody,
    twist: Twist | NDArray[np.float64],
    law: str = "path",
    validity: Validity = VALIDITY,
    restitution: str = "poisson",
) -> Outcomes:
    """What many impacts do: `solve_impact` for each element of arrays that broadcast together.

    Any field of `bodies`, of its contacts (each part of a normal or a velocity on its own) and of `twist` may be an
    array; `twist` may also be one array (..., 3). `old` is None for all or for none; `validity` and `restitution` are
    one for all. Bad numbers give Flag.INVALID_INPUT in their own element; what is no number raises TypeError, an
    integer beyond all doubles OverflowError, an unknown law or rule and shapes that do not broadcast ValueError.

    Compiled, many impacts are shared out among threads, one on each processor that the process may use.
    """
    number = number_of(law, restitution)
    limits = Validity(*map(float, validity))
    mass, inertia, old, new = bodies
    if isinstance(twist, np.ndarray):
        if twist.shape[-1:] != (3,):
            raise ValueError(f"the twist has the shape {twist.shape}; give (..., 3), or a Twist of three arrays")
        twist = Twist(*np.moveaxis(twist, -1, 0))
    vx, vy, omega = twist
    given = mass, inertia, *numbers_of(old or NOWHERE), *numbers_of(new), vx, vy, omega
    # Converted here, because nditer of numpy 1.26 leaves its buffers unset where a single number is of another type.
    fields: Any = [doubles_of(field) for field in given]
    shape = np.broadcast_shapes(*(field.shape for field in fields))
    count = prod(shape)
    outcomes = Outcomes(
        mode=np.empty(count, np.uint8),
        twist=np.empty((count, 3)),
        impulses=np.empty((count, 2, 2)),
        segments=np.empty(count, np.int64),
        flags=np.empty(count, np.uint16),
        energy_lost=np.empty(count),
        unique=np.empty(count, np.bool_),
    )
    solver, each = chunk_solver(), cast(Any, ["readonly", "contig", "aligned"])

    def solve(start: int, most: int = PART) -> None:
        chunks: Any = np.nditer(
            fields,
            flags=["buffered", "external_loop", "ranged", "delay_bufalloc"],
            op_flags=[each] * len(fields),
            order="C",
            buffersize=CHUNK,
        )
        chunks.iterrange = start, min(start + most, count)
        for columns in chunks:
            solver(columns, old is not None, number, limits, start, outcomes)
            start += len(columns[0])

    parts = iter(range(0, count, PART))  # one for all threads

    def solve_parts() -> None:
        for start in parts:
            solve(start)

    # Of Python's own threads only one runs at a time.
    threads = 1 if isfunction(solver) else min(processors(), count // FEWEST)
    if threads > 1:
        solve(0, 1)  # compiles if nothing has yet: only the main thread can be interrupted
        with ThreadPoolExecutor(threads - 1) as pool:
            others = [pool.submit(solve_parts) for _ in range(threads - 1)]
            try:
                solve_parts()
            finally:  # nothing is left to the others
                list(parts)
        for other in others:
            other.result()  # raises what it has raised
    else:
        solve_parts()
    return Outcomes._make(field.reshape(shape + field.shape[1:]) for field in outcomes)


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def doubles_of(field: Any) -> NDArray[np.float64]:
    """A field as an array; what is no number raises TypeError, as in `solve_impact`, though numpy makes NaN of None."""
    array = np.asarray(field)
    if array.dtype.kind not in "biuf" and (odd := [one for one in array.flat if not isinstance(one, Real)]):
        raise TypeError(f"{odd[0]!r} is no number")
    return array.astype(np.float64, copy=False)


def numbers_of(contact: Contact) -> tuple[Any, ...]:
    """The eight numbers of a contact, or arrays of them."""
    x, y, friction, (nx, ny), restitution, (ux, uy) = contact
    return x, y, friction, nx, ny, restitution, ux, uy


@cache
def chunk_solver() -> ChunkSolver:
    """The function that solves a chunk, compiled if that can be."""
    found = compiled(solve_chunk, LAW_CODE, lambda function: function not in CALLED, nogil=True)
    if found is None:
        return lambda columns, *rest: solve_chunk(tuple(column.tolist() for column in columns), *rest)
    return found


def solve_chunk(columns: Any, stands: bool, law: int, validity: Validity, start: int, outcomes: Outcomes) -> None:
    """Fill in the outcomes of a chunk, of which the first has the index `start`."""
    m, j, ox, oy, of, onx, ony, oe, oux, ouy, nx, ny, nf, nnx, nny, ne, nux, nuy, vx, vy, omega = columns
    mode, twist, impulses, segments, flags, energy_lost, unique = outcomes
    for i in range(len(m)):
        old = ox[i], oy[i], of[i], (onx[i], ony[i]), oe[i], (oux[i], ouy[i])
        new = nx[i], ny[i], nf[i], (nnx[i], nny[i]), ne[i], (nux[i], nuy[i])
        k = start + i
        (
            mode[k],
            (twist[k, 0], twist[k, 1], twist[k, 2]),
            impulses[k, 0, 0],
            impulses[k, 0, 1],
            impulses[k, 1, 0],
            impulses[k, 1, 1],
            segments[k],
            flags[k],
            energy_lost[k],
            unique[k],
            _,
        ) = answer.answer(m[i], j[i], stands, old, new, (vx[i], vy[i], omega[i]), law, validity)
