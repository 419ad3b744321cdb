"""200 seeded walks over slopes and frictions, with the predictor and without it: tables, JSON and a picture.

    PYTHONPATH=. python examples/walker_controller/experiment.py --json walks.json --figure walks.png

What is compared is paired: every controller makes the same walks. Gains are those of gains.json, which tune.py found on
other seeds. It takes some minutes; `--read walks.json` prints and draws again what such a file holds.
"""

from __future__ import annotations

import json
from collections import Counter
from math import degrees
from pathlib import Path
from typing import Any, Final

import click
import numpy as np
from machine import Failure
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.stats import binomtest
from tune import GAINS
from walks import TRACK, trial, walk_with

NAMES: Final = {
    "feedback": "feedback, not told the ground",
    "informed": "feedback, told slope and friction",
    "predictive": "with the predictor, told the same",
}
"""Of the controllers, as a reader sees them."""

SEEDS: Final = range(200, 400)
"""None of them was walked before all gains were fixed."""

CONFIDENCE: Final = 0.95
LOOKS: Final = {"slip": ("#0072b2", "v", "slips"), "stop": ("#d55e00", "s", "stops"), "fall": ("#000000", "X", "falls")}


def walks_of(seed: int) -> dict[str, Any]:
    """The walks of all controllers over the ground of a seed."""
    gains, one = json.loads(GAINS.read_text()), trial(seed)
    ends = {name: walk_with(name, one, gains[name]["gains"]) for name in NAMES}
    return {
        "seed": seed,
        "slope": round(one.ground.slope, 5),
        "friction": round(one.ground.friction, 5),
        **{
            name: {
                "failure": end.failure.value if end.failure else None,
                "distance": round(end.distance, 3),
                "time": round(end.time, 3),
                "steps": end.steps,
                "work": round(end.work, 2),
            }
            for name, end in ends.items()
        },
    }


def summary(walks: list[dict[str, Any]]) -> dict[str, Any]:
    """Failures of each controller with Wilson's interval, and of each baseline against the predictor, in pairs.

    `work` in J is the mean over the walks that all controllers finish, which are `all_arrive`.
    """
    count = len(walks)
    finished = [walk for walk in walks if all(walk[name]["failure"] is None for name in NAMES)]
    found: dict[str, Any] = {"walks": count, "confidence": CONFIDENCE, "all_arrive": len(finished)}
    for name in NAMES:
        reasons = Counter(walk[name]["failure"] for walk in walks if walk[name]["failure"])
        failed = sum(reasons.values())
        interval = binomtest(failed, count).proportion_ci(CONFIDENCE, "wilson")
        found[name] = {
            "failed": failed,
            **{one.value: reasons[one.value] for one in Failure},
            "share": round(failed / count, 4),
            "interval": [round(interval.low, 4), round(interval.high, 4)],
            "work": round(float(np.mean([walk[name]["work"] for walk in finished])), 2),
        }
    found["pairs"] = {name: pairs(walks, name) for name in NAMES if name != "predictive"}
    return found


def pairs(walks: list[dict[str, Any]], name: str) -> dict[str, Any]:
    """How the walks of a baseline and those with the predictor end, in pairs.

    McNemar's exact test: of the walks that only one of the two fails, half would be the predictor's if it made no
    difference.
    """
    both = Counter((walk[name]["failure"] is None, walk["predictive"]["failure"] is None) for walk in walks)
    saved, lost = both[False, True], both[True, False]
    p = binomtest(lost, saved + lost).pvalue if saved + lost else 1.0
    return {
        "both_arrive": both[True, True],
        "both_fail": both[False, False],
        "saved_by_the_predictor": saved,
        "lost_by_it": lost,
        "p_mcnemar": float(f"{p:.3g}"),
    }


def tables(found: dict[str, Any]) -> list[Table]:
    """What a reader wants to know of the walks."""
    ends = Table(title=f"How {found['walks']} walks fail; push-off in the {found['all_arrive']} that none fails")
    ends.add_column("controller")
    for title in (*(one.value for one in Failure), "failed", "of all (95 %)", "push-off, J"):
        ends.add_column(title, justify="right")
    for name, title in NAMES.items():
        one = found[name]
        low, high = one["interval"]
        reasons = [str(one[reason.value]) for reason in Failure]
        share = f"{one['share']:.1%} ({low:.1%} to {high:.1%})"
        ends.add_row(title, *reasons, str(one["failed"]), share, f"{one['work']:.1f}")
    paired = Table(title="The same walks in pairs, against the predictor")
    for title in ("baseline", "only the baseline fails", "only the predictor fails", "both fail", "p (McNemar)"):
        paired.add_column(title, justify="left" if title == "baseline" else "right")
    for name, one in found["pairs"].items():
        counts = one["saved_by_the_predictor"], one["lost_by_it"], one["both_fail"]
        paired.add_row(NAMES[name], *map(str, counts), f"{one['p_mcnemar']:.2g}")
    return [ends, paired]


def draw(walks: list[dict[str, Any]], found: dict[str, Any], path: Path) -> None:
    """One map of slope and friction for each controller, and below them how many walks fail."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.0, 7.8), layout="constrained")
    grid = figure.add_gridspec(2, len(NAMES), height_ratios=(2.6, 1.0))
    first = None
    for column, (name, title) in enumerate(NAMES.items()):
        axes = figure.add_subplot(grid[0, column], sharex=first, sharey=first)
        first = first or axes
        arrived = [walk for walk in walks if walk[name]["failure"] is None]
        axes.plot(*places(arrived), "o", mfc="none", color="#999999", ms=4.5, label="arrives")
        for reason, (colour, mark, word) in LOOKS.items():
            failed = [walk for walk in walks if walk[name]["failure"] == reason]
            axes.plot(*places(failed), mark, color=colour, ms=7, label=word)
        axes.set_title(f"{title}\n{found[name]['failed']} of {len(walks)} walks fail", fontsize=12)
        axes.set_xlabel("slope, degrees:  uphill < 0 < downhill")
        axes.axvline(0.0, color="#cccccc", lw=0.8, zorder=0)
        if column == 0:
            axes.set_ylabel("friction coefficient of the ground")
            handles, words = axes.get_legend_handles_labels()
            figure.legend(handles, words, loc="outside lower center", ncols=len(words), title="each mark is one walk")
    bars(figure.add_subplot(grid[1, :]), found)
    title = f"A simulated biped is to walk {TRACK:g} m in gusts, over {len(walks)} grounds, with three controllers each"
    figure.suptitle(title, fontsize=13)
    figure.savefig(path, dpi=110)


def places(walks: list[dict[str, Any]]) -> tuple[list[float], list[float]]:
    return [degrees(walk["slope"]) for walk in walks], [walk["friction"] for walk in walks]


def bars(axes: Any, found: dict[str, Any]) -> None:
    """How many walks fail, by reason, with the interval; and what the pairs say."""
    for row, name in enumerate(NAMES):
        one, left = found[name], 0.0
        for reason, (colour, _, _) in LOOKS.items():
            width = 100.0 * one[reason] / found["walks"]
            axes.barh(row, width, left=left, color=colour, alpha=0.75, height=0.55)
            left += width
        low, high = (100.0 * end for end in one["interval"])
        axes.plot([low, high], [row, row], color="#555555", lw=1.5, marker="|", ms=10)
        text = f"{left:.1f} %  (95 %: {low:.1f} to {high:.1f});  push-off {one['work']:.1f} J a walk"
        pair = found["pairs"].get(name)
        if pair:
            saved, lost, p = pair["saved_by_the_predictor"], pair["lost_by_it"], pair["p_mcnemar"]
            text += f"\n{saved} walks fail only here, {lost} only with the predictor (McNemar p = {p:.1g})"
        axes.text(max(high, left) + 0.5, row, text, va="center", fontsize=10.5)
    axes.set_yticks(range(len(NAMES)), [name.replace(", ", ",\n") for name in NAMES.values()])
    axes.invert_yaxis()
    axes.set_xlim(0.0, 2.2 * max(100.0 * found[name]["interval"][1] for name in NAMES))
    axes.set_xlabel("walks that fail, % (colours as above; the line is the 95 % interval)")
    axes.spines[["top", "right"]].set_visible(False)


@click.command()
@click.option("--json", "target", type=click.Path(path_type=Path), help="File for every walk and the summary.")
@click.option("--figure", type=click.Path(path_type=Path), help="File for the picture.")
@click.option("--read", type=click.Path(path_type=Path, exists=True), help="Take the walks of such a file.")
def main(target: Path | None, figure: Path | None, read: Path | None) -> None:
    """Walk with and without the predictor, and tell how often it failed."""
    if read:
        walks = json.loads(read.read_text())["walks"]
    else:
        walks = [walks_of(seed) for seed in track(SEEDS, "walking", transient=True)]
    found = summary(walks)
    console = Console()
    for table in tables(found):
        console.print(table)
    if target:
        target.write_text(json.dumps({"summary": found, "walks": walks}) + "\n")
    if figure:
        draw(walks, found, figure)


if __name__ == "__main__":
    main()
