"""Maps of modes over two parameters (the paper, Fig. 5 and Fig. 7), by the general laws."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanics.batch import Outcomes, solve_impacts
from ...mechanics.types import Flag, Mode, Twist, TwoPointBody
from .parameters import OMEGA, SUBJECTS, Axis, problem_at

CELLS_AT_ONCE = 100_000
"""Cells that are solved between two calls of the progress bar; both laws keep their outcomes of that many."""


class ModeMap(NamedTuple):
    """What impacts do over the middles of a grid of cells; arrays (rows, columns), y growing with the row.

    `mode` numbers of Mode and `segments` contact states by the `law`; `unique` whether it allows no other answer;
    `omega_ratio` of angular velocities, after by before; `energy_lost` as part of the kinetic energy before. Whatever
    the `law`: whether the impulse path is `jammed`, and whether it and the total law are `path_unique`, `total_unique`.
    """

    subject: str
    x: Axis
    y: Axis
    fixed: dict[str, float]
    law: str
    mode: NDArray[np.uint8]
    segments: NDArray[np.int64]
    omega_ratio: NDArray[np.float64]
    energy_lost: NDArray[np.float64]
    jammed: NDArray[np.bool_]
    path_unique: NDArray[np.bool_]
    total_unique: NDArray[np.bool_]

    @property
    def unique(self) -> NDArray[np.bool_]:
        return self.path_unique if self.law == "path" else self.total_unique


def middles(axis: Axis, count: int) -> NDArray[np.float64]:
    """The middles of `count` cells along an axis."""
    return axis.low + (axis.high - axis.low) * ((np.arange(count) + 0.5) / count)


def map_modes(
    name: str,
    x: Axis,
    y: Axis,
    fixed: dict[str, float],
    law: str,
    resolution: int,
    tell: Callable[[int], object] = lambda cells: None,
) -> ModeMap:
    """The modes of the body `name` over `resolution` cells along each axis; `fixed` are all other parameters.

    `tell` is told how many cells are done.

    Raises:
        InputError: a parameter is out of its range.
    """
    subject, columns, rows = SUBJECTS[name], middles(x, resolution), middles(y, resolution)
    shape = (resolution, resolution)
    fields: Any = [np.empty(shape, kind) for kind in (np.uint8, np.int64, float, float, bool, bool, bool)]
    step = max(1, CELLS_AT_ONCE // resolution)
    for start in range(0, resolution, step):
        block = slice(start, min(start + step, resolution))
        values = {**fixed, x.name: columns, y.name: rows[block, None]}
        for field, part in zip(fields, solve_block(*problem_at(subject, values), law), strict=True):
            field[block] = part
        tell(block.stop * resolution)
    return ModeMap(name, x, y, fixed, law, *fields)


def solve_block(body: TwoPointBody, twist: Twist, law: str) -> tuple[NDArray[Any], ...]:
    """The arrays of a ModeMap, for some of its rows."""
    path, total = solve_impacts(body, twist, "path"), solve_impacts(body, twist, "total")
    outcomes: Outcomes = path if law == "path" else total
    vx, vy, omega = twist
    before = 0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * omega * omega)
    return (
        outcomes.mode,
        outcomes.segments,
        outcomes.twist[..., 2] / OMEGA,
        outcomes.energy_lost / before,
        (path.flags & np.uint16(Flag.JAMMED)) != 0,
        path.unique,
        total.unique,
    )


def shares(modes: ModeMap) -> dict[Mode, float]:
    """The part of the map that each mode takes, of those that occur."""
    counts = np.bincount(modes.mode.ravel(), minlength=len(Mode))
    return {mode: float(counts[mode] / modes.mode.size) for mode in Mode if counts[mode]}
