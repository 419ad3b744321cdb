"""Sketches of the bodies of maps: what turns about A and strikes B."""

from __future__ import annotations

from math import cos, radians, sin
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Polygon

LINE, BODY, SUPPORT = "#333333", "#dddddd", "#999999"
TILT: Final = radians(14.0)
"""How far a sketched body is from its touchdown."""

Point = tuple[float, float]


def draw_sketch(axes: Axes, subject: str) -> None:
    """Draw the body right before it strikes, with the names that its parameters have."""
    axes.set_axis_off()
    axes.set_aspect("equal")
    {"plate": draw_plate, "rod": draw_rod, "cylinder": draw_cylinder}[subject](axes)
    axes.autoscale_view()
    axes.margins(0.06)


def draw_plate(axes: Axes) -> None:
    length, height = 2.0, 1.0
    corners = turned([(0.0, 0.0), (length, 0.0), (length, height), (0.0, height)])
    axes.plot([-0.35, length + 0.5], [0.0, 0.0], color=SUPPORT, linewidth=2.5, solid_capstyle="butt")
    axes.add_patch(Polygon(corners, closed=True, facecolor=BODY, edgecolor=LINE))
    (centre,) = turned([(0.5 * length, 0.5 * height)])
    mark(axes, corners[0], "A", (-9, 5))
    mark(axes, corners[1], "B", (9, 1))
    mark(axes, centre, "C", (0, 8))
    turning_arrow(axes, centre, 0.36)
    along(axes, turned([(0.0, height), (length, height)]), "L", (0, 8))
    along(axes, turned([(0.0, 0.0), (0.0, height)]), "H", (-9, 0))


def draw_rod(axes: Axes) -> None:
    length, thickness, a, b = 2.6, 0.16, 0.75, 0.75
    outline = [(-0.5 * length, 0.0), (0.5 * length, 0.0), (0.5 * length, thickness), (-0.5 * length, thickness)]
    corners = turned([(x + a, y) for x, y in outline])
    axes.add_patch(Polygon(corners, closed=True, facecolor=BODY, edgecolor=LINE))
    for x in (0.0, a + b):
        axes.add_patch(Polygon([(x, 0.0), (x - 0.12, -0.45), (x + 0.12, -0.45)], facecolor=SUPPORT))
    axes.plot([-0.7, a + b + 0.6], [-0.45, -0.45], color=SUPPORT, linewidth=2.5, solid_capstyle="butt")
    old, centre, new = turned([(0.0, 0.0), (a, 0.5 * thickness), (a + b, 0.0)])
    mark(axes, old, "A", (10, -9))
    mark(axes, (a + b, 0.0), "B", (10, -9))
    mark(axes, centre, "C", (2, 8))
    turning_arrow(axes, centre, 0.42)
    axes.plot(a, -1.05, "")  # makes room for the letters
    for begin, end, name in ((0.0, a, "a"), (a, a + b, "b")):
        axes.annotate("", (begin, -0.72), (end, -0.72), arrowprops={"arrowstyle": "<->", "color": LINE})
        axes.annotate(
            name, (0.5 * (begin + end), -0.72), (0, -10), textcoords="offset points", ha="center", va="center"
        )


def draw_cylinder(axes: Axes) -> None:
    gamma = radians(38.0)
    a, b = (-sin(gamma), -cos(gamma)), (sin(gamma), -cos(gamma))
    # Turned about A until its touchdown, the axis comes down to the origin.
    x, y = -a[0], -a[1]
    axis = a[0] + x * cos(TILT) - y * sin(TILT), a[1] + x * sin(TILT) + y * cos(TILT)
    axes.add_patch(Circle(axis, 1.0, facecolor=BODY, edgecolor=LINE))
    for edge, outer in ((a, -1.0), (b, 1.0)):
        ground = [edge, (edge[0], edge[1] - 0.35), (outer * 1.25, edge[1] - 0.35), (outer * 1.25, edge[1])]
        axes.add_patch(Polygon(ground, facecolor=SUPPORT))
    # The angles are those at the touchdown, when the axis is at the origin.
    for edge, name, side in ((a, "$γ_1$", -1.0), (b, "$γ_2$", 1.0)):
        axes.plot([0.0, edge[0]], [0.0, edge[1]], color=LINE, linewidth=0.9, linestyle="--")
        middle = 0.62 * sin(0.5 * gamma) * side, -0.62 * cos(0.5 * gamma)
        axes.text(*middle, name, ha="center", va="center")
    axes.plot([0.0, 0.0], [0.0, -1.0], color=LINE, linewidth=0.9, linestyle=":")
    axes.add_patch(Arc((0.0, 0.0), 0.9, 0.9, theta1=270.0 - 38.0, theta2=270.0 + 38.0, color=LINE, linewidth=0.9))
    mark(axes, a, "A", (-9, -9))
    mark(axes, b, "B", (9, -9))
    mark(axes, axis, "C", (0, 8))
    turning_arrow(axes, axis, 0.5)


def turned(points: list[Point]) -> list[Point]:
    """Points of a body that has still to turn by TILT about the origin."""
    return [(x * cos(TILT) - y * sin(TILT), x * sin(TILT) + y * cos(TILT)) for x, y in points]


def mark(axes: Axes, place: Point, name: str, offset: Point) -> None:
    axes.plot(*place, "o", color=LINE, markersize=4, zorder=5)
    axes.annotate(name, place, offset, textcoords="offset points", ha="center", va="center", fontweight="bold")


def along(axes: Axes, side: list[Point], name: str, offset: Point) -> None:
    (x1, y1), (x2, y2) = side
    middle = 0.5 * (x1 + x2), 0.5 * (y1 + y2)
    axes.annotate(name, middle, offset, textcoords="offset points", ha="center", va="center")


def turning_arrow(axes: Axes, centre: Point, radius: float) -> None:
    """An arrow clockwise about a point."""
    ends: Any = [
        (centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)) for angle in np.radians((150.0, 30.0))
    ]
    axes.add_patch(
        FancyArrowPatch(*ends, connectionstyle="arc3,rad=-0.55", arrowstyle="-|>", mutation_scale=11, color=LINE)
    )
