"""Maps of modes over two parameters (the paper, Fig. 5 and Fig. 7) by the general laws: bodies, data and words."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from math import inf, pi
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from ..errors import InputError
from ..files import whole
from ..mechanics.bodies import cylinder, plate, refuse, rod
from ..mechanics.impact import states_of
from ..mechanics.impact.batch import solve_impacts
from ..mechanics.types import Flag, Mode, Twist, TwoPointBody
from .modes import MODES
from .table import Column, table_of

OMEGA: Final = -1.0
"""Angular velocity before the impact (rad/s); without a slip the mode does not depend on it."""


class MapParameter(NamedTuple):
    """A parameter: its symbol in the picture, unit and meaning; its value unless given, or the formula that it follows.

    What has neither is given in the place of another.
    """

    symbol: str
    unit: str
    meaning: str
    default: float | str = ""


class Axis(NamedTuple):
    """A parameter along an axis of the map, from `low` to `high`."""

    name: str
    low: float
    high: float


class Subject(NamedTuple):
    """A body of which maps are drawn, and what its map shows unless something else is asked for."""

    parameters: dict[str, MapParameter]
    x: Axis
    y: Axis
    build: Callable[..., TwoPointBody]
    title: str


def plate_of(delta: Any = 1.0, **values: Any) -> TwoPointBody:
    return plate(**{"height": delta * values["length"], **values})


def rod_of(a: Any, b: Any = None, **values: Any) -> TwoPointBody:
    return rod(a=a, b=a if b is None else b, **values)


def cylinder_of(gamma: Any, gamma_new: Any = None, **values: Any) -> TwoPointBody:
    ahead = gamma if gamma_new is None else gamma_new
    between = "angles in degrees with a sum between 0 and 180"
    refuse({"gamma + gamma-new": gamma + ahead}, lambda value: (value > 0.0) & (value < 180.0), between)
    return cylinder(gamma=gamma * (pi / 180.0), gamma_new=ahead * (pi / 180.0), **values)


INERTIA: Final = "inertia about the mass centre by mass"
CONTACTS: Final = {
    "friction": MapParameter("$f$", "", "friction coefficient of both contacts", 0.5),
    "friction_old": MapParameter("$f_A$", "", "friction coefficient of the old contact A", "friction"),
    "friction_new": MapParameter("$f_B$", "", "friction coefficient of the new contact B", "friction"),
    "restitution": MapParameter("$e$", "", "restitution at the new contact B", 0.0),
    "slip": MapParameter("$v_{tA}$", "m/s", "slip of the old contact A before the impact, at ω = −1 rad/s", 0.0),
}
SUBJECTS: Final = {
    "plate": Subject(
        {
            "delta": MapParameter("δ = H/L", "", "height by length", 1.0),
            "length": MapParameter("$L$", "m", "length", 1.0),
            "height": MapParameter("$H$", "m", "height, in the place of δ"),
            "a": MapParameter("$a$", "m", "distance of the old contact A behind the mass centre", "L/2"),
            "b": MapParameter("$b$", "m", "distance of the new contact B ahead of the mass centre", "L/2"),
            "inertia": MapParameter("J/m", "m²", INERTIA, "(L² + H²)/12"),
            **CONTACTS,
        },
        Axis("delta", 0.0, 2.0),
        Axis("friction", 0.0, 1.5),
        plate_of,
        "Plate on a floor",
    ),
    "rod": Subject(
        {
            "length": MapParameter("$l$", "m", "length", 0.4),
            "thickness": MapParameter("$h$", "m", "thickness", 0.005),
            "a": MapParameter("$a$", "m", "distance of the old support A behind the middle", 0.1),
            "b": MapParameter("$b$", "m", "distance of the new support B ahead of the middle", "a"),
            "inertia": MapParameter("J/m", "m²", INERTIA, "l²/12"),
            **CONTACTS,
        },
        Axis("a", 0.0, 0.2),
        Axis("friction", 0.0, 0.05),
        rod_of,
        "Rod over two supports",
    ),
    "cylinder": Subject(
        {
            "gamma": MapParameter("$γ_1$", "°", "central angle of the old edge A behind the vertical", 45.0),
            "gamma_new": MapParameter("$γ_2$", "°", "central angle of the new edge B ahead of it", "gamma"),
            "radius": MapParameter("$R$", "m", "radius", 1.0),
            "inertia": MapParameter("J/m", "m²", INERTIA, "R²/2"),
            **CONTACTS,
        },
        Axis("gamma", 0.0, 90.0),
        Axis("friction", 0.0, 1.5),
        cylinder_of,
        "Cylinder between two edges",
    ),
}


def fixed_values(subject: Subject, axes: tuple[Axis, Axis], given: Mapping[str, float]) -> dict[str, float]:
    """The parameters that are the same all over the map: as given, else their defaults; InputError where an axis is
    none of the parameters, or is given as a number too, or has no extent.
    """
    for axis in axes:
        option = option_of(axis.name)
        if axis.name not in subject.parameters:
            allowed = ", ".join(map(option_of, subject.parameters))
            raise InputError(f"there is no parameter {axis.name!r} for an axis; give one of {allowed}")
        if axis.name in given:
            raise InputError(f"{option} is an axis of the map and --{option} a number; leave one of them out")
        if not -inf < axis.low < axis.high < inf:
            ends = f"{axis.low:g} to {axis.high:g}; give two finite numbers, the lower one first"
            raise InputError(f"the axis {option} goes from {ends}")
    if axes[0].name == axes[1].name:
        raise InputError(f"both axes, --x and --y, are {option}; give two parameters")
    chosen = {axes[0].name, axes[1].name, *given}
    if {"delta", "height"} <= chosen:
        raise InputError("delta and height are one thing, height = delta length; leave one of them out")
    if "height" in chosen:
        chosen.add("delta")
    if {"friction_old", "friction_new"} <= chosen:
        chosen.add("friction")  # it is the friction of none
    defaults = {
        name: one.default
        for name, one in subject.parameters.items()
        if isinstance(one.default, float) and name not in chosen
    }
    return {**defaults, **given}


def problem_at(subject: Subject, values: Mapping[str, Any]) -> tuple[TwoPointBody, Twist]:
    """The body with these parameters, and its twist right before the impact; InputError where a parameter is out of its
    range.
    """
    values = {"friction": 0.0, **values}
    frictions = {name: values.pop(name, values["friction"]) for name in ("friction_old", "friction_new")}
    refuse(frictions, lambda value: (value >= 0.0) & (value < inf), "a finite number, 0 or above")
    slip = values.pop("slip")
    refuse({"slip": slip}, lambda value: abs(value) <= 1e6, "a number of at most 1e6")
    body = subject.build(mass=1.0, **values)
    assert body.old is not None  # each of the bodies stands on one
    (nx, ny), turning, old = body.old.normal, body.turning(OMEGA), body.old._replace(friction=frictions["friction_old"])
    body = body._replace(old=old, new=body.new._replace(friction=frictions["friction_new"]))
    return body, Twist(turning.vx + slip * ny, turning.vy - slip * nx, turning.omega)


def option_of(name: str) -> str:
    """The name of a parameter as it is written on the command line."""
    return name.replace("_", "-")


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

    `tell` is told how many cells are done. InputError where a parameter is out of its range.
    """
    subject, columns, rows = SUBJECTS[name], middles(x, resolution), middles(y, resolution)
    step, blocks = max(1, CELLS_AT_ONCE // resolution), []
    for start in range(0, resolution, step):
        body, twist = problem_at(subject, {**fixed, x.name: columns, y.name: rows[start : start + step, None]})
        path, total = solve_impacts(body, twist, "path"), solve_impacts(body, twist, "total")
        outcomes = path if law == "path" else total
        energy = 0.5 * (body.mass * (twist.vx**2 + twist.vy**2) + body.inertia * twist.omega**2)
        blocks.append(
            {
                "mode": outcomes.mode,
                "segments": outcomes.segments,
                "omega_ratio": outcomes.twist[..., 2] / OMEGA,
                "energy_lost": outcomes.energy_lost / energy,
                "jammed": (path.flags & np.uint16(Flag.JAMMED)) != 0,
                "path_unique": path.unique,
                "total_unique": total.unique,
            }
        )
        tell(min(start + step, resolution) * resolution)
    fields: dict[str, Any] = {key: np.concatenate([block[key] for block in blocks]) for key in blocks[0]}
    return ModeMap(subject=name, x=x, y=y, fixed=fixed, law=law, **fields)


def shares(modes: ModeMap) -> dict[Mode, float]:
    """The part of the map that each mode takes, of those that occur."""
    counts = np.bincount(modes.mode.ravel(), minlength=len(Mode))
    return {mode: float(counts[mode] / modes.mode.size) for mode in Mode if counts[mode]}


def write_csv(path: Path, modes: ModeMap) -> None:
    """Write a line for each cell: its parameters, and the fields of a ModeMap; InputError where the file cannot be
    written.
    """
    x, y = (middles(axis, len(modes.mode)).tolist() for axis in (modes.x, modes.y))
    names = [mode.name for mode in Mode]
    flags = ("unique", "jammed", "path_unique", "total_unique")
    with whole(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([modes.x.name, modes.y.name, "mode", "segments", *flags, "omega_ratio", "energy_lost"])
        for row, height in enumerate(y):
            mode = [names[mode] for mode in modes.mode[row]]
            segments = [" ".join(states_of(code)) for code in modes.segments[row].tolist()]
            truths = [getattr(modes, flag)[row].astype(int).tolist() for flag in flags]
            numbers = modes.omega_ratio[row].tolist(), modes.energy_lost[row].tolist()
            writer.writerows(zip(x, [height] * len(x), mode, segments, *truths, *numbers, strict=True))


def summary_of(modes: ModeMap) -> dict[str, Any]:
    """What a map shows, in the names and units of the command line: shares are parts of its area."""
    return {
        "body": modes.subject,
        "law": modes.law,
        "x": modes.x._asdict(),
        "y": modes.y._asdict(),
        "fixed": modes.fixed,
        "resolution": modes.mode.shape[0],
        "shares": {mode.name: share for mode, share in shares(modes).items()},
        "jammed": float(np.mean(modes.jammed)),
        "path_not_unique": float(np.mean(~modes.path_unique)),
        "total_not_unique": float(np.mean(~modes.total_unique)),
    }


def shares_table(modes: ModeMap) -> Table:
    """The modes of a map, and how much of it each takes."""
    rows = [(mode.name, share, MODES[mode].meaning) for mode, share in shares(modes).items()]
    rows += [("", float(np.mean(region)), meaning) for meaning, region in ambiguous(modes).items()]
    columns = [
        Column("mode", lambda row: row[0], left=True),
        Column("% of the map", lambda row: f"{100.0 * row[1]:.1f}"),
        Column("", lambda row: row[2], left=True, fold=30),
    ]
    return table_of(columns, rows)


def ambiguous(modes: ModeMap) -> dict[str, NDArray[np.bool_]]:
    """Where a law has no single answer, by what there is to say; the map shows one answer there."""
    regions = {
        "the impulse path jams (Painlevé)": modes.jammed,
        "the path law has more answers": ~modes.path_unique,
        "the total law has more answers": ~modes.total_unique,
    }
    return {meaning: region for meaning, region in regions.items() if region.any()}


def given_in(modes: ModeMap) -> set[str]:
    """The parameters that are given, or an axis; the others follow from them."""
    return {*modes.fixed, modes.x.name, modes.y.name}


def axis_label(axis: Axis, modes: ModeMap) -> str:
    """Symbol, meaning and unit of what changes along an axis."""
    parameter = SUBJECTS[modes.subject].parameters[axis.name]
    return f"{parameter.symbol}, {parameter.meaning}" + (f" ({parameter.unit})" if parameter.unit else "")


def conditions(modes: ModeMap) -> str:
    """What is the same all over the map, and which parameters follow others."""
    parameters, said = SUBJECTS[modes.subject].parameters, []
    for name, one in parameters.items():
        if name in modes.fixed:
            said.append(f"{one.symbol} = {modes.fixed[name]:g} {one.unit}".rstrip())
        elif isinstance(one.default, str) and one.default not in ("", "friction") and name not in given_in(modes):
            leader = parameters.get(one.default)
            said.append(f"{one.symbol} = {leader.symbol if leader else one.default}")
    return ", ".join((*said, f"{modes.law} law"))
