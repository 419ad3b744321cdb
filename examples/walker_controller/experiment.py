"""200 seeded walks over slopes and frictions, with the predictor and without it: a table, JSON and a picture.

    PYTHONPATH=. python examples/walker_controller/experiment.py --json walks.json --figure docs/walker_controller.png

What is compared is paired: every controller makes the same walks. Gains are those of gains.json, by tune.py.
"""

from __future__ import annotations

import json
from collections import Counter
from multiprocessing import Pool
from pathlib import Path
from typing import Any, Final

import click
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.stats import binomtest
from trials import trial
from tune import GAINS, WALKS
from values import Failure

NAMES: Final = {
    "feedback": "feedback without the predictor",
    "informed": "the same, told ground and load",
    "predictive": "with the predictor",
}
"""Of the controllers, as a reader sees them."""

CONFIDENCE: Final = 0.95


def run(seeds: range) -> list[dict[str, Any]]:
    """The walks of all controllers over the grounds of some seeds, on all processors."""
    with Pool() as pool:
        return list(track(pool.imap(walks_of, seeds), "walking", len(seeds), transient=True))


def walks_of(seed: int) -> dict[str, Any]:
    """The walks of all controllers over the ground of a seed."""
    gains, one = json.loads(GAINS.read_text()), trial(seed)
    ends = {name: WALKS[name](one, gains[name]["gains"]) for name in NAMES}
    return {
        "seed": seed,
        "slope": round(one.ground.slope, 5),
        "friction": round(max(one.ground.frictions), 5),
        "inertia": round(one.machine.inertia, 5),
        **{
            name: {
                "failure": end.failure.value if end.failure else None,
                "distance": round(end.distance, 3),
                "time": round(end.time, 3),
                "steps": end.steps,
            }
            for name, end in ends.items()
        },
    }


def summary(walks: list[dict[str, Any]]) -> dict[str, Any]:
    """Failures of each controller with Wilson's interval, and of each baseline against the predictor, in pairs.

    McNemar's exact test: of the walks that only one of two controllers fails, half would be the predictor's if it made
    no difference.
    """
    count = len(walks)
    found: dict[str, Any] = {"walks": count, "confidence": CONFIDENCE}
    for name in NAMES:
        reasons = Counter(walk[name]["failure"] for walk in walks if walk[name]["failure"])
        failed = sum(reasons.values())
        interval = binomtest(failed, count).proportion_ci(CONFIDENCE, "wilson")
        found[name] = {
            "failed": failed,
            **{one.value: reasons[one.value] for one in Failure},
            "share": round(failed / count, 4),
            "interval": [round(interval.low, 4), round(interval.high, 4)],
        }
    found["pairs"] = {name: pairs(walks, name) for name in NAMES if name != "predictive"}
    return found


def pairs(walks: list[dict[str, Any]], name: str) -> dict[str, Any]:
    """How the walks of a baseline and those with the predictor end, in pairs."""
    both = Counter((walk[name]["failure"] is None, walk["predictive"]["failure"] is None) for walk in walks)
    saved, lost = both[False, True], both[True, False]
    test = binomtest(lost, saved + lost) if saved + lost else None
    interval = test.proportion_ci(CONFIDENCE, "wilson") if test else None
    return {
        "both_arrive": both[True, True],
        "both_fail": both[False, False],
        "saved_by_the_predictor": saved,
        "lost_by_it": lost,
        "lost_share_interval": [round(interval.low, 4), round(interval.high, 4)] if interval else None,
        "p_mcnemar": float(f"{test.pvalue:.3g}") if test else None,
    }


def tables(found: dict[str, Any]) -> list[Table]:
    """What a reader wants to know of the walks."""
    count = found["walks"]
    ends = Table(title=f"{count} walks of a biped over slopes and frictions: how they failed")
    ends.add_column("controller")
    for title in (*(one.value for one in Failure), "failed", "of all (95 %)"):
        ends.add_column(title, justify="right")
    for name, title in NAMES.items():
        one = found[name]
        low, high = one["interval"]
        reasons = [str(one[reason.value]) for reason in Failure]
        ends.add_row(title, *reasons, str(one["failed"]), f"{one['share']:.1%} ({low:.1%} to {high:.1%})")
    paired = Table(title="The same walks in pairs, against the predictor")
    for title in ("baseline", "only the baseline fails", "only the predictor fails", "both fail", "p (McNemar)"):
        paired.add_column(title, justify="left" if title == "baseline" else "right")
    for name, one in found["pairs"].items():
        p = one["p_mcnemar"]
        paired.add_row(
            NAMES[name],
            str(one["saved_by_the_predictor"]),
            str(one["lost_by_it"]),
            str(one["both_fail"]),
            "" if p is None else f"{p:.2g}",
        )
    return [ends, paired]


@click.command()
@click.option("--walks", "count", default=200, show_default=True, help="Number of seeds.")
@click.option("--json", "target", type=click.Path(path_type=Path), help="File for every walk and the summary.")
@click.option("--figure", type=click.Path(path_type=Path), help="File for the picture.")
@click.option("--read", type=click.Path(path_type=Path, exists=True), help="Draw the walks of such a file again.")
def main(count: int, target: Path | None, figure: Path | None, read: Path | None) -> None:
    """Walk with and without the predictor, and tell how often it failed."""
    walks = json.loads(read.read_text())["walks"] if read else run(range(count))
    found = summary(walks)
    console = Console()
    for table in tables(found):
        console.print(table)
    if target:
        target.write_text(json.dumps({"summary": found, "walks": walks}) + "\n")
    if figure:
        from picture import draw

        draw(walks, found, NAMES, figure)


if __name__ == "__main__":
    main()
