"""The picture of the walks: where on the map of slope and friction each controller fails, and how often."""

from __future__ import annotations

from math import degrees
from pathlib import Path
from typing import Any, Final

from matplotlib.figure import Figure

COLOURS: Final = {"slip": "#0072b2", "stop": "#d55e00", "fall": "#000000"}
MARKS: Final = {"slip": "v", "stop": "s", "fall": "X"}


def draw(walks: list[dict[str, Any]], found: dict[str, Any], names: dict[str, str], path: Path) -> None:
    """One map for each controller, and below them how many walks fail."""
    figure = Figure(figsize=(13.0, 7.6), layout="constrained")
    grid = figure.add_gridspec(2, len(names), height_ratios=(2.6, 1.0))
    first = None
    for column, (name, title) in enumerate(names.items()):
        axes = figure.add_subplot(grid[0, column], sharex=first, sharey=first)
        first = first or axes
        arrived = [walk for walk in walks if walk[name]["failure"] is None]
        axes.plot(*places(arrived), "o", mfc="none", color="#999999", ms=4.5, label="arrives")
        for reason in COLOURS:
            failed = [walk for walk in walks if walk[name]["failure"] == reason]
            axes.plot(*places(failed), MARKS[reason], color=COLOURS[reason], ms=7, label=WORDS[reason])
        axes.set_title(f"{title}\n{found[name]['failed']} of {len(walks)} walks fail", fontsize=11)
        axes.set_xlabel("slope in degrees (uphill < 0 < downhill)")
        axes.axvline(0.0, color="#cccccc", lw=0.8, zorder=0)
        if column == 0:
            axes.set_ylabel("friction coefficient of the ground")
            handles, words = axes.get_legend_handles_labels()
            figure.legend(handles, words, loc="outside lower center", ncols=len(words), title="each mark is one walk")
    bars(figure.add_subplot(grid[1, :]), found, names)
    title = f"A simulated biped walks 6 m in gusts over worn slabs: the same {len(walks)} walks with three controllers"
    figure.suptitle(title, fontsize=12.5)
    figure.savefig(path, dpi=110)


WORDS: Final = {"slip": "slips", "stop": "stops", "fall": "falls"}


def places(walks: list[dict[str, Any]]) -> tuple[list[float], list[float]]:
    return [degrees(walk["slope"]) for walk in walks], [walk["friction"] for walk in walks]


def bars(axes: Any, found: dict[str, Any], names: dict[str, str]) -> None:
    """How many walks fail, by reason, with the interval; and what the pairs say."""
    for row, name in enumerate(names):
        one, left = found[name], 0.0
        for reason, colour in COLOURS.items():
            width = 100.0 * one[reason] / found["walks"]
            axes.barh(row, width, left=left, color=colour, alpha=0.75, height=0.55)
            left += width
        low, high = (100.0 * end for end in one["interval"])
        axes.plot([low, high], [row, row], color="#555555", lw=1.5, marker="|", ms=10)
        text = f"{left:.1f} %  (95 %: {low:.1f} to {high:.1f})"
        pair = found["pairs"].get(name)
        if pair:
            saved, lost = pair["saved_by_the_predictor"], pair["lost_by_it"]
            text += f"\n{saved} walks fail only here, {lost} only with the predictor"
            if pair["p_mcnemar"] is not None:
                ends = [100.0 * end for end in pair["lost_share_interval"]]
                text += (
                    f" ({lost} of {saved + lost}: 95 % {ends[0]:.0f} to {ends[1]:.0f} %; McNemar p = "
                    f"{pair['p_mcnemar']:.1g})"
                )
        axes.text(max(high, left) + 0.7, row, text, va="center", fontsize=10)
    axes.set_yticks(
        range(len(names)), [name.replace(", ", ",\n").replace(" without", "\nwithout") for name in names.values()]
    )
    axes.invert_yaxis()
    axes.set_xlim(0.0, max(60.0, 2.7 * max(100.0 * found[name]["interval"][1] for name in names)))
    axes.set_xlabel("walks that fail, %")
    axes.spines[["top", "right"]].set_visible(False)
