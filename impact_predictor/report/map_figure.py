"""The picture of a map of modes: its regions, the borders by the paper's formulas, and a sketch of the body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from math import atan2, cos, degrees, pi, radians, sin
from pathlib import Path
from textwrap import wrap
from typing import Any, Final, NamedTuple

import contourpy
import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.colors import ListedColormap
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ..mechanics.closed_forms import cylindrical, flat
from ..mechanics.types import Mode
from ..scenarios.rocking import release, rocking_cylinder, rocking_plate, rocking_rod
from .map import SUBJECTS, Axis, ModeMap, ambiguous, axis_label, conditions, given_in, meaning_of, problem_at, shares
from .modes import MODES
from .motion_pictures import RockingScene
from .plot import Axes, Line2D, Patch, headline, picture

PAPER_NUMBERS: Final = {Mode.STOP: 1, Mode.SLIDE: 2}
"""The numbers that the paper uses for one mode all through; its 3 and 4 change places between its sections."""
HATCHES: Final = ("xx", "||", "///")
NODES: Final = 401
"""Points along each axis between which a border is interpolated."""

_LEAST_ROOM: Final = 0.04
"""A region is named inside if this part of the map's height is free above and below the name."""
_LETTER: Final = 8.0
"""Pixels that a letter of a formula takes, about."""
_LINE_OF_LEGEND: Final = 33
"""Letters that a line of the legend has room for."""
_SKETCHED: Final = {
    "plate": partial(rocking_plate, 2.0, 1.0, None, None),
    "rod": partial(rocking_rod, 2.6, 0.16, 0.75, 0.75),
    "cylinder": partial(rocking_cylinder, 1.0, radians(38.0), radians(38.0)),
}
"""The bodies of the sketches, from their mass, friction, inertia and restitution."""


class Border(NamedTuple):
    """A border on a map: its formula, and its curves, each (points, 2) as (x, y)."""

    formula: str
    curves: list[NDArray[np.float64]]


class BorderEquation(NamedTuple):
    """A formula, what is zero where it holds, and whether the modes that it parts meet there."""

    formula: str
    residual: Any
    parts: Any


def borders_of(modes: ModeMap) -> list[Border]:
    """The borders that cross the map; none where the formulas do not apply.

    They are for plastic impacts of a body that turned about its old contact at rest, with the same friction at both.
    """
    if modes.fixed.get("restitution") != 0.0 or modes.fixed.get("slip") != 0.0:
        return []
    if {"friction_old", "friction_new"} & given_in(modes):
        return []
    x, y = _nodes(modes.x), _nodes(modes.y)
    borders = []
    for number, equation in enumerate(_equations(modes, x, y[:, None])):
        # The equation is smooth all over the map, the modes end within a cell of it: so it is cut point by point.
        field = np.broadcast_to(equation.residual, (NODES, NODES))
        curves: list[NDArray[np.float64]] = []
        lines: Any = contourpy.contour_generator(x, y, field).lines(0.0)
        for curve in lines:
            parts = np.broadcast_to(_equations(modes, *curve.T)[number].parts, len(curve))
            ends = np.flatnonzero(np.diff(np.concatenate([[False], parts, [False]]).astype(int)))
            curves += [curve[begin:end] for begin, end in ends.reshape(-1, 2) if end - begin > 1]
        if curves:
            borders.append(Border(equation.formula, curves))
    return borders


def _equations(modes: ModeMap, x: NDArray[np.float64], y: NDArray[np.float64]) -> list[BorderEquation]:
    """The equations of the borders, at places on the map."""
    equations = cylinder_equations if modes.subject == "cylinder" else flat_equations
    return list(equations(modes.subject, {**modes.fixed, modes.x.name: x, modes.y.name: y}))


def _nodes(axis: Axis) -> NDArray[np.float64]:
    """Points along an axis; at its very ends there may be no body, such as a plate without height."""
    return np.asarray(axis.low + (axis.high - axis.low) * np.linspace(1e-9, 1.0 - 1e-9, NODES))


def flat_equations(subject: str, values: Mapping[str, Any]) -> Iterator[BorderEquation]:
    """The borders of the plate and the rod, in the form of Fig. 5 where the plate is that of Fig. 5."""
    body, _ = problem_at(SUBJECTS[subject], values)
    assert body.old is not None
    f, a, b, h = body.new.friction, -body.old.x, body.new.x, -body.new.y
    rho2 = body.inertia / body.mass
    shape = flat.FlatBody(a, b, h, rho2)
    rectangle = "delta" in values and not {"a", "b", "inertia"} & values.keys()
    bar = "thickness" in values and "inertia" not in values
    with np.errstate(divide="ignore", invalid="ignore"):
        stop, lift, pivot = (
            np.isfinite(friction(shape)) for friction in (flat.stop_friction, flat.lift_friction, flat.pivot_friction)
        )
    formulas = (
        ("f = δ", "f = (2 − δ²) / 3δ", "f = 3δ / (4δ² + 1)", "δ = 1/√2")
        if rectangle
        else ("f = h/2a", "f = (12ab − l²) / 6ha", "f = 6hb / (l² + 3h²)", "12ab = l² + 3h²")
        if bar
        else ("f = h/2a", "f = 2(ab − ρ²) / ha", "f = 2hb / (4ρ² + h²)", "4ab = 4ρ² + h²")
        if subject == "rod"
        else ("f = H/2a", "f = 2(ab − ρ²) / Ha", "f = 2Hb / (4ρ² + H²)", "4ab = 4ρ² + H²")
    )
    stops, lifts, pivots, rests = formulas
    if bar and "b" not in values and np.ndim(values["length"]) == np.ndim(values["thickness"]) == 0:
        rests += f", a = {flat.stop_distance(values['length'], values['thickness']):.4f} m"
    yield BorderEquation(stops, h - f * a, stop)
    yield BorderEquation(lifts, a * b - rho2 - f * h * a, lift)
    yield BorderEquation(pivots, h * b - f * (rho2 + h * h), pivot)
    yield BorderEquation(rests, a * b - rho2 - h * h, f * a >= h)


def cylinder_equations(subject: str, values: Mapping[str, Any]) -> Iterator[BorderEquation]:
    """The borders of the cylinder; t is the tangent of the mean of both angles."""
    body, _ = problem_at(SUBJECTS[subject], values)
    f, radius, gamma = body.new.friction, values["radius"], values["gamma"]
    angle = (gamma + values.get("gamma_new", gamma)) * (pi / 360.0)
    k = np.asarray(body.inertia / (body.mass * radius * radius))
    sin, cos, t = np.sin(angle), np.cos(angle), np.tan(angle)
    homogeneous = "inertia" not in values
    with np.errstate(divide="ignore", invalid="ignore"):
        stop, spin, lift, pivot = (
            np.isfinite(friction)
            for friction in (
                cylindrical.stop_friction(t, k),
                cylindrical.spin_friction(t, k),
                cylindrical.lift_friction(t, k),
                cylindrical.pivot_friction(t, k),
            )
        )
        sticks = f >= cylindrical.pivot_friction(cylindrical.stop_tangent(k), k)
    # Each equation times cos γ or its square, which keeps it finite at 90 degrees.
    stops, middle = ((1.0 + k) * f * f + k) * cos - f * sin, t / (2.0 * (1.0 + k))
    yield BorderEquation(
        "f = (t − √(t² − 3)) / 3" if homogeneous else "f = (t − √(t² − 4k(1 + k))) / 2(1 + k)",
        stops,
        stop & (f <= middle),
    )
    yield BorderEquation("f = (t + √(t² − 4k(1 + k))) / 2(1 + k)", stops, spin & (f >= middle))
    yield BorderEquation("t = f + √(1 + f²)", sin * sin - cos * cos - 2.0 * f * sin * cos, lift)
    yield BorderEquation("f = t/3" if homogeneous else "f = kt / (1 + k)", k * sin - f * (1.0 + k) * cos, pivot)
    rests = "t = √3" if homogeneous else "t = √((1 + k) / (1 − k))"
    if homogeneous and "gamma_new" not in values:
        rests += ", γ = 60°"
    yield BorderEquation(
        rests,
        (1.0 - k) * sin * sin - (1.0 + k) * cos * cos,
        sticks,
    )


def write_map(path: Path, modes: ModeMap) -> None:
    """Draw a map into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written.
    """
    with picture(path, 10.0, 6.0) as figure:
        title = SUBJECTS[modes.subject].title
        headline(figure, f"{title}: what follows when it turns about A and strikes B")
        grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 0.4), height_ratios=(0.36, 1.0))
        axes, sketch, side = (figure.add_subplot(place) for place in (grid[:, 0], grid[0, 1], grid[1, 1]))
        draw_sketch(sketch, modes.subject)
        _draw_regions(axes, modes)
        hatches = _draw_hatches(axes, modes)
        borders = borders_of(modes)
        side.set_axis_off()
        side.legend(handles=_legend(modes, borders, hatches), loc="upper left", borderaxespad=0.0, labelspacing=0.8)
        figure.draw_without_rendering()  # a text along a curve needs the final shape of the axes
        for border in borders:
            _draw_border(axes, border)


def _draw_regions(axes: Axes, modes: ModeMap) -> None:
    """The regions, each with its name inside where there is room."""
    axes.imshow(
        modes.mode,
        cmap=ListedColormap([MODES[mode].colour for mode in Mode]),
        vmin=-0.5,
        vmax=len(Mode) - 0.5,
        extent=(modes.x.low, modes.x.high, modes.y.low, modes.y.high),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
    )
    axes.grid(visible=False)
    axes.spines[["top", "right"]].set_visible(True)
    axes.set_xlabel(axis_label(modes.x, modes), fontsize=12)
    axes.set_ylabel(axis_label(modes.y, modes), fontsize=12)
    axes.set_title(conditions(modes), fontsize=10)
    for mode in shares(modes):
        place = _roomiest(modes.mode == mode)
        if place is not None:
            words: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "va": "center", "fontweight": "bold"}
            colour = "white" if MODES[mode].is_dark else "black"
            edge = [patheffects.withStroke(linewidth=4, foreground=MODES[mode].colour)]
            axes.text(*place, mode.name, color=colour, fontsize=11, path_effects=edge, zorder=4, **words)


def _roomiest(region: NDArray[np.bool_]) -> tuple[float, float] | None:
    """Where a word fits best into a region, as parts of the width and height of the map; None if it fits nowhere."""
    rows, columns = region.shape
    step = max(1, rows // 200)
    coarse = np.pad(region[::step, ::step], 1)  # the edge of the map is an edge of the region too
    # A word is three times as wide as high.
    room = distance_transform_edt(coarse, sampling=(step / rows, 0.3 * step / columns))
    row, column = np.unravel_index(int(np.argmax(room)), room.shape)
    if room[row, column] < _LEAST_ROOM:
        return None
    return float((column - 0.5) * step / columns), float((row - 0.5) * step / rows)


def _draw_hatches(axes: Axes, modes: ModeMap) -> list[Any]:
    """Hatch where the laws have no single answer; the entries of the legend for it."""
    dark = np.isin(modes.mode, [mode for mode in Mode if MODES[mode].is_dark])
    extent = (modes.x.low, modes.x.high, modes.y.low, modes.y.high)
    handles = []
    for (region, meaning), hatch in zip(ambiguous(modes), HATCHES, strict=True):
        if not region.any():
            continue
        for part, colour in ((region & dark, "white"), (region & ~dark, "black")):
            if part.any():
                with matplotlib.rc_context({"hatch.color": colour}):
                    axes.contourf(part, levels=[0.5, 2.0], colors="none", hatches=[hatch], extent=extent)
        label = "\n".join(wrap(meaning, _LINE_OF_LEGEND))
        handles.append(Patch(facecolor="white", edgecolor="black", hatch=hatch, label=label))
    return handles


def _draw_border(axes: Axes, border: Border) -> None:
    """The curves of a border, with its formula beside the longest."""
    for curve in border.curves:
        axes.plot(*curve.T, color="white", linewidth=3.0, solid_capstyle="round")
        axes.plot(*curve.T, color="black", linewidth=1.4, solid_capstyle="round")
    pixels = axes.transData.transform(max(border.curves, key=len))
    place, angle = _straightest(pixels, _LETTER * len(border.formula))
    axes.annotate(
        border.formula,
        tuple(axes.transAxes.inverted().transform(place)),
        (-5.0 * sin(angle), 5.0 * cos(angle)),
        xycoords="axes fraction",
        textcoords="offset points",
        rotation=degrees(angle),
        rotation_mode="anchor",
        ha="center",
        va="bottom",
        path_effects=[patheffects.withStroke(linewidth=3, foreground="white")],
    )


def _straightest(points: NDArray[np.float64], width: float) -> tuple[NDArray[np.float64], float]:
    """Where a text of this width follows a curve best, and its angle there in rad; all in pixels."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    half = 0.5 * min(width, length[-1])
    places = np.linspace(half, length[-1] - half, 41)
    at, before, after = (
        np.column_stack([np.interp(places + shift, length, part) for part in points.T]) for shift in (0.0, -half, half)
    )
    # As near to the middle as may be.
    bend = np.hypot(*(at - 0.5 * (before + after)).T) + 0.05 * np.abs(places - 0.5 * length[-1])
    best = int(np.argmin(bend))
    dx, dy = after[best] - before[best]
    return at[best], 0.5 * pi - (0.5 * pi - atan2(dy, dx)) % pi


def _legend(modes: ModeMap, borders: list[Border], hatches: list[Any]) -> list[Any]:
    """The modes that occur in the order of their numbers, the hatches and the borders."""
    handles: list[Any] = []
    for mode, share in shares(modes).items():
        number = f", {PAPER_NUMBERS[mode]} in the paper" if mode in PAPER_NUMBERS else ""
        meaning = "\n".join(wrap(meaning_of(mode), _LINE_OF_LEGEND))
        label = f"{mode.name} ({100.0 * share:.0f} %{number}):\n{meaning}"
        handles.append(Patch(facecolor=MODES[mode].colour, edgecolor="black", linewidth=0.5, label=label))
    handles += hatches
    if borders:
        handles.append(Line2D([], [], color="black", linewidth=1.4, label=_formula_note(modes)))
    return handles


def _formula_note(modes: ModeMap) -> str:
    """What the legend says of the borders."""
    symbols, given = [], given_in(modes)
    if modes.subject == "cylinder":
        symbols.append(f"t = tan {'(γ₁ + γ₂)/2' if 'gamma_new' in given else 'γ'}")
        if "inertia" in given:
            symbols.append("k = J/mR²")
    elif "inertia" in given or (modes.subject == "plate" and {"a", "b", "height"} & given):
        symbols.append("ρ² = J/m")
    return ",\n".join(("border by the paper's formula", *filter(None, [", ".join(symbols)])))


def draw_sketch(axes: Axes, subject: str) -> None:
    """Draw the body right before it strikes, as the film of its motion shows it, with A and B."""
    axes.set_axis_off()
    axes.set_aspect("equal")
    falls = release(_SKETCHED[subject](1.0, None, None, 0.0), radians(14.0), duration=1.0)
    RockingScene(falls).draw(axes, 0.0)
