"""Charts of a page as a PNG or SVG file: what plotly draws in a browser, drawn by matplotlib."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from html import unescape
from typing import Any, Final

import numpy as np

from ..plot import Axes, SubFigure, common_legend, headline, picture
from . import GREY, Chart

WIDTH: Final = 13.5
PIXELS: Final = 100.0
"""Of a page, for each inch of a picture."""
BESIDE: Final = 3
"""Charts that stand beside each other, where they are not wide."""

SYMBOLS: Final = {
    "circle": "o",
    "square": "s",
    "diamond": "D",
    "triangle-right": ">",
    "triangle-left": "<",
    "triangle-up": "^",
    "triangle-down": "v",
    "cross": "P",
    "cross-thin": "+",
    "x": "X",
    "x-thin": "x",
    "star": "*",
    "line-ns": "|",
}
"""Markers of matplotlib, by those of plotly."""
DASHES: Final = {"solid": "-", "dash": "--", "dot": ":"}


def write_charts(path: str | os.PathLike[str], title: str, charts: Sequence[Chart]) -> None:
    """Draw charts, in their order, below a title.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    rows: list[list[Chart]] = []
    for chart in charts:
        if rows and not (chart.wide or rows[-1][0].wide or len(rows[-1]) == BESIDE):
            rows[-1].append(chart)
        else:
            rows.append([chart])
    heights = [max(chart.layout["height"] for chart in row) / PIXELS for row in rows] or [1.5]
    with picture(path, WIDTH, 0.4 + sum(heights)) as figure:
        headline(figure, title)
        if not rows:
            figure.text(0.5, 0.4, "there is nothing to draw", ha="center", color=GREY)
        parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
        for row, part in zip(rows, parts, strict=False):
            for chart, place in zip(row, part.subfigures(1, len(row), squeeze=False)[0], strict=True):
                _draw(place, chart)


def _draw(figure: SubFigure, chart: Chart) -> None:
    looks = {key.removeprefix("yaxis"): look for key, look in chart.layout.items() if key.startswith("yaxis")}
    ends = [look.get("domain", (0.0, 1.0)) for look in looks.values()]
    heights = [high - low for low, high in ends]
    panels = figure.subplots(len(looks), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    by_name = dict(zip(looks, panels, strict=True)) | {"1": panels[0]}
    for trace in chart.traces:
        if trace.get("visible", True) is True:
            _draw_trace(by_name[trace.get("yaxis", "y")[1:]], trace)
    for axes, look in zip(panels, looks.values(), strict=True):
        _set_axis(axes, "y", look)
    _set_axis(panels[-1], "x", chart.layout["xaxis"])
    panels[0].set_title(chart.title)
    if chart.layout.get("showlegend", len(chart.traces) > 1):
        common_legend(figure, columns=8 if chart.wide else 3)


def _draw_trace(axes: Axes, trace: Mapping[str, Any]) -> None:
    marker, line, mode = trace.get("marker", {}), trace.get("line", {}), trace.get("mode", "")
    x, y = (np.array(trace[side], float) for side in "xy")
    label = _plain(trace.get("name", "")) if trace.get("showlegend", True) else ""
    if trace["type"] == "bar":
        axes.barh(y, x, trace["width"], trace["base"], color=marker["color"], label=label)
        return
    colour, steps = line.get("color") or marker.get("color") or GREY, line.get("shape") == "hvh"
    if fill := trace.get("fill"):
        other = axes.lines[-1].get_ydata() if fill == "tonexty" else 0.0
        face = trace.get("fillcolor", f"{colour}40")
        axes.fill_between(x, np.asarray(other, float), y, color=face, linewidth=0.0, step="mid" if steps else None)
    for side, at, beside, draw in (("error_x", x, y, axes.hlines), ("error_y", y, x, axes.vlines)):
        if error := trace.get(side):
            least, most = at - error["arrayminus"], at + error["array"]
            draw(beside, least, most, color=error["color"], linewidth=error["thickness"], zorder=1.5)
    symbol = marker.get("symbol", "circle")
    axes.plot(
        x,
        y,
        linestyle=DASHES[line.get("dash", "solid")] if "lines" in mode else "",
        linewidth=line.get("width", 1.5),
        drawstyle="steps-mid" if steps else "default",
        color=colour,
        marker=SYMBOLS[symbol.removesuffix("-open")] if "markers" in mode else "",
        markersize=0.65 * marker.get("size", 6),
        markeredgecolor=marker.get("line", {}).get("color", colour),
        markeredgewidth=1.0 if symbol.endswith("-open") else marker.get("line", {}).get("width", 0.0),
        fillstyle="none" if symbol.endswith("-open") else "full",
        alpha=trace.get("opacity"),
        label=label,
    )
    for place, said in zip(zip(x, y, strict=True), trace.get("text", ()), strict=False):
        axes.annotate(said, place, (4, -11), textcoords="offset points", fontsize=8)


def _set_axis(axes: Axes, side: str, look: Mapping[str, Any]) -> None:
    axis = axes.xaxis if side == "x" else axes.yaxis
    axes.set(**{f"{side}label": _plain(look.get("title", "")), f"{side}scale": look.get("type", "linear")})
    if not look.get("showticklabels", True):
        axis.set_ticks([])
    elif "tickvals" in look:
        axis.set_ticks(look["tickvals"], list(map(_plain, look["ticktext"])))
    if "range" in look:
        axes.set(**{f"{side}lim": look["range"]})
    elif look.get("rangemode") == "tozero":
        axes.set(**{f"{side}lim": (0.0, None)})
    if not look.get("showgrid", True):
        axis.grid(visible=False)
    if "scaleanchor" in look:
        axes.set_aspect("equal", adjustable="datalim")


def _plain(text: str) -> str:
    return unescape(text.replace("<br>", "\n"))
