"""The picture of a map of modes: its regions, the borders by the paper's formulas, and a sketch of the body."""

from __future__ import annotations

from functools import partial
from math import atan2, degrees, pi, radians, tau
from pathlib import Path
from textwrap import fill
from typing import Any, Final

import contourpy
import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.colors import ListedColormap
from numpy.typing import NDArray

from ..mechanics.closed_forms import cylindrical, flat
from ..mechanics.motion import standing
from ..mechanics.types import Mode, TwoPointBody
from ..scenarios.rocking import Rocker, rocking_cylinder, rocking_plate, rocking_rod
from .map import SUBJECTS, ModeMap, ambiguous, axis_label, conditions, given_in, problem_at, shares
from .modes import EDGE, MODES
from .plot import Axes, Line2D, Patch, picture

HATCHES: Final = ("xx", "||", "///")
SYMBOLS: Final = {"ρ": "ρ² = J/m", "t": "t = tan (γ₁ + γ₂)/2", "k": "k = J/mR²"}
"""What symbols in the formulas of the borders stand for."""
NODES: Final = 401
"""Points along each axis between which a border is interpolated."""

_LINE_OF_LEGEND: Final = 33
"""Letters that a line of the legend has room for."""
_SKETCHED: Final = {
    "plate": partial(rocking_plate, 2.0, 1.0, None, None),
    "rod": partial(rocking_rod, 2.6, 0.16, 0.75, 0.75),
    "cylinder": partial(rocking_cylinder, 1.0, radians(38.0), radians(38.0)),
}
"""The bodies of the sketches, from their mass, friction, inertia and restitution."""


def borders_of(modes: ModeMap) -> dict[str, list[NDArray[np.float64]]]:
    """The borders that cross the map by their formulas, each as curves (points, 2); none where no formula applies.

    They are for plastic impacts of a body that turned about its old contact at rest, with the same friction at both.
    """
    if modes.fixed.get("restitution") != 0.0 or modes.fixed.get("slip") != 0.0:
        return {}
    if {"friction_old", "friction_new"} & given_in(modes):
        return {}
    # At the very ends of an axis there may be no body, such as a plate without height.
    x, y = (axis.low + (axis.high - axis.low) * np.linspace(1e-9, 1.0 - 1e-9, NODES) for axis in (modes.x, modes.y))
    borders: dict[str, list[NDArray[np.float64]]] = {}
    equations = cylinder_equations if modes.subject == "cylinder" else flat_equations
    with np.errstate(divide="ignore", invalid="ignore"):
        for formula, (residual, _) in equations(modes, x, y[:, None]).items():
            # The equation is smooth all over the map, the modes end within a cell of it: so it is cut point by point.
            lines: Any = contourpy.contour_generator(x, y, np.broadcast_to(residual, (NODES, NODES))).lines(0.0)
            for curve in lines:
                _, parts = equations(modes, *curve.T)[formula]
                ends = np.flatnonzero(np.diff(np.broadcast_to(parts, len(curve)), prepend=False, append=False))
                pieces = [curve[begin:end] for begin, end in ends.reshape(-1, 2) if end - begin > 1]
                if pieces:
                    borders.setdefault(formula, []).extend(pieces)
    return borders


def flat_equations(modes: ModeMap, x: NDArray[np.float64], y: NDArray[np.float64]) -> dict[str, Any]:
    """The borders of the plate and the rod, in the form of Fig. 5 where the plate is that of Fig. 5.

    By formula: what is 0 where it holds, and whether the modes that it parts meet there.
    """
    body, values = _body_at(modes, x, y)
    assert body.old is not None
    f, a, b, h, rho2 = body.new.friction, -body.old.x, body.new.x, -body.new.y, body.inertia / body.mass
    shape = flat.FlatBody(a, b, h, rho2)
    high = "H" if modes.subject == "plate" else "h"
    formulas = [
        f"f = {high}/2a",
        f"f = 2(ab − ρ²) / {high}a",
        f"f = 2{high}b / (4ρ² + {high}²)",
        f"4ab = 4ρ² + {high}²",
    ]
    if "delta" in values and not {"a", "b", "inertia"} & values.keys():
        formulas = ["f = δ", "f = (2 − δ²) / 3δ", "f = 3δ / (4δ² + 1)", "δ = 1/√2"]
    return {
        formulas[0]: (h - f * a, np.isfinite(flat.stop_friction(shape))),
        formulas[1]: (a * b - rho2 - f * h * a, np.isfinite(flat.lift_friction(shape))),
        formulas[2]: (h * b - f * (rho2 + h * h), np.isfinite(flat.pivot_friction(shape))),
        formulas[3]: (a * b - rho2 - h * h, f * a >= h),
    }


def cylinder_equations(modes: ModeMap, x: NDArray[np.float64], y: NDArray[np.float64]) -> dict[str, Any]:
    """The borders of the cylinder, as `flat_equations`; t is the tangent of the mean of both angles, k = J/mR².

    Each equation is multiplied by the cosine of that angle or its square, which keeps it finite at 90 degrees.
    """
    body, values = _body_at(modes, x, y)
    f, gamma = body.new.friction, values["gamma"]
    angle = (gamma + values.get("gamma_new", gamma)) * (pi / 360.0)
    k = np.asarray(body.inertia / (body.mass * values["radius"] ** 2))
    sin, cos, t = np.sin(angle), np.cos(angle), np.tan(angle)
    low, high = cylindrical.stop_friction(t, k), cylindrical.spin_friction(t, k)
    middle = t / (2.0 * (1.0 + k))
    stops = np.where(f <= middle, np.isfinite(low), np.isfinite(high))
    sticks = f >= cylindrical.pivot_friction(cylindrical.stop_tangent(k), k)
    lifts, turns = cylindrical.lift_friction(t, k), cylindrical.pivot_friction(t, k)
    return {
        "(1 + k) f² − t f + k = 0": (((1.0 + k) * f * f + k) * cos - f * sin, stops),
        "t = f + √(1 + f²)": (sin * sin - cos * cos - 2.0 * f * sin * cos, np.isfinite(lifts)),
        "f = kt / (1 + k)": (k * sin - f * (1.0 + k) * cos, np.isfinite(turns)),
        "t² = (1 + k) / (1 − k)": ((1.0 - k) * sin * sin - (1.0 + k) * cos * cos, sticks),
    }


def _body_at(modes: ModeMap, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[TwoPointBody, dict[str, Any]]:
    values = {**modes.fixed, modes.x.name: x, modes.y.name: y}
    return problem_at(SUBJECTS[modes.subject], values)[0], values


def write_map(path: Path, modes: ModeMap) -> None:
    """Draw a map into a PNG or SVG file; InputError where the file cannot be written."""
    with picture(path, 10.0, 6.0) as figure:
        title = SUBJECTS[modes.subject].title
        what = f"{title}: what follows when it turns about the old contact A and strikes the new one, B"
        figure.suptitle(what, x=0.01, ha="left", fontweight="bold", fontsize=11)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 0.4), height_ratios=(0.36, 1.0))
        axes, sketch, side = (figure.add_subplot(place) for place in (grid[:, 0], grid[0, 1], grid[1, 1]))
        _draw_sketch(sketch, _SKETCHED[modes.subject](1.0, None, None, 0.0))
        _draw_regions(axes, modes)
        borders = borders_of(modes)
        handles = _draw_hatches(axes, modes)
        side.set_axis_off()
        if borders:
            used = [said for symbol, said in SYMBOLS.items() if any(symbol in formula for formula in borders)]
            label = ",\n".join(["border by the paper's formula", *used])
            handles.append(Line2D([], [], color="black", linewidth=1.4, label=label))
        side.legend(handles=handles, loc="upper left", borderaxespad=0.0, labelspacing=0.8)
        for formula, curves in borders.items():
            _draw_border(axes, formula, curves)


def _draw_sketch(axes: Axes, rocker: Rocker) -> None:
    """Draw a body that stands on A and is about to strike with B."""
    body, (x, y, angle, *_) = rocker.body, standing(rocker.body, radians(14.0))
    assert body.old is not None
    c, s, flat = np.cos(angle), np.sin(angle), standing(body, 0.0)
    contacts = np.array([(one.x, one.y) for one in (body.old, body.new)])
    turns = np.linspace(0.0, tau, 73)
    circle = np.hypot(*contacts[0]) * np.column_stack((np.cos(turns), np.sin(turns)))
    outline = np.array(rocker.outline or circle) @ [[c, s], [-s, c]] + (x, y)
    # Where the contacts are closed: a cylinder rolls over two edges, others stand on a floor, or on a table if they
    # reach below it.
    (left, floor), (right, top) = edges = contacts + np.array((flat.x, flat.y))
    wide = right - left
    beyond = 0.0 if outline[:, 1].min() < floor - 1e-9 else 0.6 * wide
    supports = [(left - beyond, right + beyond, floor)]
    if not rocker.outline:
        supports = [(left - 0.6 * wide, left, floor), (right, right + 0.6 * wide, top)]
    for begin, end, height in supports:
        axes.fill_between([begin, end], height - 0.15 * wide, height, color="#b5ada0", linewidth=0.0)
    axes.fill(*outline.T, facecolor="#dbe4ee", edgecolor="#33475b", linewidth=1.3)
    axes.plot(x, y, "P", color="#33475b", markersize=6, markeredgewidth=0.0)
    places = contacts @ [[c, s], [-s, c]] + (x, y) if rocker.outline else edges
    for name, place, colour in zip("AB", places, (EDGE, "white"), strict=True):
        axes.plot(*place, "o", color=colour, markeredgecolor=EDGE, markersize=7)
        axes.annotate(name, place, (0.0, -15.0), textcoords="offset points", ha="center")
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.1)


def _draw_border(axes: Axes, formula: str, curves: list[NDArray[np.float64]]) -> None:
    """Draw the curves of a border, and its formula along the middle of the longest."""
    for curve in curves:
        axes.plot(*curve.T, color="white", linewidth=3.0)
        axes.plot(*curve.T, color="black", linewidth=1.4)
    longest = max(curves, key=len)
    before, (x, y), after = (longest[len(longest) * k // 6] for k in (2, 3, 4))
    slope = 90.0 - (90.0 - degrees(atan2(*(after - before)[::-1]))) % 180.0
    edge = [patheffects.withStroke(linewidth=3, foreground="white")]
    look: Any = {"rotation_mode": "anchor", "transform_rotates_text": True, "ha": "center", "path_effects": edge}
    axes.text(x, y, f"{formula}\n", rotation=slope, va="bottom", linespacing=0.8, **look)  # a little above the curve


def _draw_regions(axes: Axes, modes: ModeMap) -> None:
    """The regions, each with its name inside where there is room."""
    colours = ListedColormap([MODES[mode].colour for mode in Mode])
    extent = (modes.x.low, modes.x.high, modes.y.low, modes.y.high)
    axes.imshow(modes.mode, colours, vmin=-0.5, vmax=len(Mode) - 0.5, extent=extent, origin="lower", aspect="auto")
    axes.grid(visible=False)
    axes.spines[["top", "right"]].set_visible(True)
    axes.set_xlabel(axis_label(modes.x, modes), fontsize=12)
    axes.set_ylabel(axis_label(modes.y, modes), fontsize=12)
    axes.set_title(conditions(modes), fontsize=10)
    for mode, share in shares(modes).items():
        if share >= 0.02:  # a smaller region has no room for its name
            places = np.argwhere(modes.mode == mode)
            inside = places[np.argmin(np.hypot(*(places - places.mean(axis=0)).T))]  # the centroid may be outside
            y, x = (inside + 0.5) / modes.mode.shape
            look: Any = {"color": "white" if MODES[mode].is_dark else "black", "fontweight": "bold", "fontsize": 11}
            edge = [patheffects.withStroke(linewidth=4, foreground=MODES[mode].colour)]
            axes.text(x, y, mode.name, transform=axes.transAxes, ha="center", va="center", path_effects=edge, **look)


def _draw_hatches(axes: Axes, modes: ModeMap) -> list[Any]:
    """Hatch where the laws have no single answer; the legend's entries for the modes that occur and for the hatches."""
    handles: list[Any] = []
    for mode, share in shares(modes).items():
        label = f"{mode.name} ({share:.0%}):\n{fill(MODES[mode].meaning, _LINE_OF_LEGEND)}"
        handles.append(Patch(facecolor=MODES[mode].colour, edgecolor="black", linewidth=0.5, label=label))
    dark = np.isin(modes.mode, [mode for mode in Mode if MODES[mode].is_dark])
    extent = (modes.x.low, modes.x.high, modes.y.low, modes.y.high)
    for (meaning, region), hatch in zip(ambiguous(modes).items(), HATCHES, strict=False):
        for part, colour in ((region & dark, "white"), (region & ~dark, "black")):
            if part.any():
                with matplotlib.rc_context({"hatch.color": colour}):
                    axes.contourf(part, levels=[0.5, 2.0], colors="none", hatches=[hatch], extent=extent)
        label = fill(meaning, _LINE_OF_LEGEND)
        handles.append(Patch(facecolor="white", edgecolor="black", hatch=hatch, label=label))
    return handles
