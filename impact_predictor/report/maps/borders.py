"""Borders between modes by the paper's formulas, as curves on a map."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi
from typing import Any, Final, NamedTuple

import contourpy
import numpy as np
from numpy.typing import NDArray

from ...mechanics.closed_forms import cylindrical, flat
from .modes import ModeMap
from .parameters import SUBJECTS, Axis, Values, problem_at

NODES: Final = 401
"""Points along each axis between which a border is interpolated."""

Array = NDArray[np.float64]


class Border(NamedTuple):
    """A border on a map: its formula, and its curves, each (points, 2) as (x, y)."""

    formula: str
    curves: list[Array]


class Equation(NamedTuple):
    """A formula, what is zero where it holds, and whether the modes that it parts meet there."""

    formula: str
    residual: Any
    parts: Any


def borders_of(modes: ModeMap) -> list[Border]:
    """The borders that cross the map; none where the formulas do not apply.

    They are for plastic impacts of a body that turned about its old contact at rest, with the same friction at both.
    """
    varied = {modes.x.name, modes.y.name}
    if modes.fixed.get("restitution") != 0.0 or modes.fixed.get("slip") != 0.0:
        return []
    if {"friction_old", "friction_new"} & (varied | modes.fixed.keys()):
        return []
    equations = cylinder_equations if modes.subject == "cylinder" else flat_equations

    def at(x: Array, y: Array) -> Iterator[Equation]:
        return equations(modes.subject, {**modes.fixed, modes.x.name: x, modes.y.name: y})

    x, y = nodes(modes.x), nodes(modes.y)
    borders = []
    for number, equation in enumerate(at(x, y[:, None])):
        # The equation is smooth all over the map, the modes end within a cell of it: so it is cut point by point.
        field = np.broadcast_to(equation.residual, (NODES, NODES))
        whole: Any = contourpy.contour_generator(x, y, field).lines(0.0)
        curves = [piece for curve in whole for piece in cut(curve, number, at)]
        if curves:
            borders.append(Border(equation.formula, curves))
    return borders


def nodes(axis: Axis) -> Array:
    """Points along an axis; at its very ends there may be no body, such as a plate without height."""
    return np.asarray(axis.low + (axis.high - axis.low) * np.linspace(1e-9, 1.0 - 1e-9, NODES))


def cut(curve: Array, number: int, at: Callable[[Array, Array], Iterator[Equation]]) -> list[Array]:
    """The pieces of a curve where the equation of this number parts modes."""
    parts = [equation.parts for equation in at(*curve.T)][number]
    there = np.concatenate([[False], np.broadcast_to(parts, len(curve)), [False]])
    ends = np.flatnonzero(there[1:] != there[:-1])
    return [curve[begin:end] for begin, end in ends.reshape(-1, 2) if end - begin > 1]


def flat_equations(subject: str, values: Values) -> Iterator[Equation]:
    """The borders of the plate and the rod, in the form of Fig. 5 where the plate is that of Fig. 5."""
    body, _ = problem_at(SUBJECTS[subject], values)
    assert body.old is not None
    f, a, b, h = body.new.friction, -body.old.x, body.new.x, -body.new.y
    rho2 = body.inertia / body.mass
    shape = flat.Shape(a, b, h, rho2)
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
    if bar and "b" not in values and {"length", "thickness"} <= single(values):
        rests += f", a = {flat.stop_distance(values['length'], values['thickness']):.4f} m"
    yield Equation(stops, h - f * a, stop)
    yield Equation(lifts, a * b - rho2 - f * h * a, lift)
    yield Equation(pivots, h * b - f * (rho2 + h * h), pivot)
    yield Equation(rests, a * b - rho2 - h * h, f * a >= h)


def cylinder_equations(subject: str, values: Values) -> Iterator[Equation]:
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
    yield Equation(
        "f = (t − √(t² − 3)) / 3" if homogeneous else "f = (t − √(t² − 4k(1 + k))) / 2(1 + k)",
        stops,
        stop & (f <= middle),
    )
    yield Equation("f = (t + √(t² − 4k(1 + k))) / 2(1 + k)", stops, spin & (f >= middle))
    yield Equation("t = f + √(1 + f²)", sin * sin - cos * cos - 2.0 * f * sin * cos, lift)
    yield Equation("f = t/3" if homogeneous else "f = kt / (1 + k)", k * sin - f * (1.0 + k) * cos, pivot)
    rests = "t = √3" if homogeneous else "t = √((1 + k) / (1 − k))"
    if homogeneous and "gamma_new" not in values:
        rests += ", γ = 60°"
    yield Equation(
        rests,
        (1.0 - k) * sin * sin - (1.0 + k) * cos * cos,
        sticks,
    )


def single(values: Values) -> set[str]:
    """The names of the parameters that are single numbers."""
    return {name for name, value in values.items() if np.ndim(value) == 0}
