"""Walks of Solo12 with each source of landings: tunes the gains, and makes the walks that analysis.md asks for.

    PYTHONPATH=. python examples/walker_controller/experiment.py --seeds 60 --json walks.json --figure walks.png
    PYTHONPATH=. python examples/walker_controller/experiment.py --tune predictor

A walk of 5 s takes a second or two.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple

import click
import numpy as np
from controller import Array, Gains, Source, Trot
from rich.console import Console
from rich.progress import track
from rich.table import Table
from robot import Robot, Trial
from scipy.optimize import differential_evolution
from scipy.stats import binomtest, qmc, wilcoxon
from sources import GapOverSpeed, Plan, Predicted

GAINS: Final = Path(__file__).with_name("gains.json")
SPEED: Final = 0.35
"""m/s, to walk with."""
TICKS: Final = 2500
FALL: Final = 5.0
"""Cost of a walk that ends in a fall."""
FIRST: Final = 1000
"""The first seed of the walks that are judged ..."""
TUNED: Final = (1, 2, 3)
"""... and those on which the gains are tuned ..."""
TUNED_TICKS: Final = 2000
"""... over so many ticks ..."""
POPULATION, GENERATIONS = 10, 3
"""... with so many evaluations of differential evolution, of each arm alike."""
BOUNDS: Final = {
    "descent": (0.2, 0.9),
    "lead": (0.0, 0.06),
    "speed": (0.05, 0.6),
    "soft": (0.2, 1.0),
    "late": (-0.012, 0.06),
}
NEVER: Final = 9.0
"""Seconds, or m/s, that no foot comes to."""


class Arm(NamedTuple):
    """What is compared: a name for the reader, what tells landings, whose gains it has, and which are set instead."""

    title: str
    source: Callable[[], Source]
    gains: str
    fixed: dict[str, float]
    most: int = 1000
    """Walks that it makes at most."""


ARMS: Final = {
    "plan": Arm("plan alone", lambda: Plan(senses=False), "plan", {}),
    "sensors": Arm("plan and contact sensors", lambda: Plan(senses=True), "sensors", {}),
    "gap": Arm("gap over speed", GapOverSpeed, "gap", {}),
    "predictor": Arm("predictor", Predicted, "predictor", {}),
    "brakes": Arm("predictor, brakes only", Predicted, "predictor", {"late": NEVER}, 20),
    "bears": Arm("predictor, bears only", Predicted, "predictor", {"speed": NEVER, "soft": 1.0, "late": -0.006}, 20),
}
TUNABLE: Final = [name for name, arm in ARMS.items() if arm.gains == name]
PARTS: Final = ("cost", "peak", "turning", "lag")


class Walk(NamedTuple):
    """How a walk went, as analysis.md defines it."""

    fell: bool
    landings: int
    peak: float
    turning: float
    lag: float

    @property
    def cost(self) -> float:
        """What is tuned and compared."""
        return FALL if self.fell else self.peak + self.turning + self.lag

    def rounded(self) -> dict[str, Any]:
        """Its fields, to five decimals."""
        return {key: round(value, 5) if isinstance(value, float) else value for key, value in self._asdict().items()}


def trial(seed: int) -> Trial:
    """The walk of a seed: slabs of 10 by 20 cm up to 5 mm off the plane, and pushes of 50 ms, two or so a second."""
    random = np.random.default_rng([2026, seed])
    heights = random.uniform(-0.005, 0.005, (40, 6))
    pushes, tick = [], 400
    while tick < TICKS:
        pushes.append((tick, random.normal(0.0, (10.0, 10.0, 10.0, 1.3, 1.3, 0.4))))
        tick += 50 + int(random.exponential(250.0))
    return Trial(seed, heights, tuple(pushes))


def walk(arm: Arm, gains: Gains, trial: Trial, ticks: int = TICKS) -> Walk:
    """Make a walk."""
    robot = Robot(trial)
    trot = Trot(robot.mass, SPEED, gains, arm.source())
    measured = robot.measure()
    peaks: list[float] = []
    lifted: list[int | None] = [None] * 4
    # Of each foot the index of its last landing in `peaks`, and how many ticks that still lasts.
    open_: list[tuple[int, int]] = [(0, 0)] * 4
    turning, speeds = [], []
    for tick in range(ticks):
        stood = trot.stands.copy()
        robot.tick(trot.commands(measured))
        measured = robot.measure()
        forces = robot.forces.max(axis=0).tolist()
        for i in range(4):
            if stood[i] and not trot.stands[i]:
                lifted[i] = tick
            since = lifted[i]
            if since is not None and tick - since > 45 and forces[i] > 1.0:
                peaks.append(0.0)
                lifted[i], open_[i] = None, (len(peaks) - 1, 5)
            number, left = open_[i]
            if left:
                peaks[number], open_[i] = max(peaks[number], forces[i]), (number, left - 1)
        turning.append(float(np.hypot(*robot.data.qvel[3:5])))
        speeds.append(float(robot.data.qvel[0]))
        if robot.fallen:
            break
    weight = 9.81 * robot.mass
    return Walk(
        fell=bool(robot.fallen),
        landings=len(peaks),
        peak=float(np.mean(peaks or [0.0])) / weight,
        turning=float(np.sqrt(np.mean(np.square(turning)))),
        lag=abs(float(np.mean(speeds[500:] or [0.0])) / SPEED - 1.0),
    )


def tune(name: str) -> dict[str, Any]:
    """The best gains of an arm."""
    arm, trials = ARMS[name], [trial(seed) for seed in TUNED]

    def evaluate(values: Any) -> float:
        gains = Gains(*map(float, values))
        return float(np.mean([walk(arm, gains, one, TUNED_TICKS).cost for one in trials]))

    low, high = np.array(list(BOUNDS.values())).T
    found = differential_evolution(
        evaluate,
        list(BOUNDS.values()),
        init=qmc.scale(qmc.LatinHypercube(len(BOUNDS), seed=1).random(POPULATION), low, high),
        maxiter=GENERATIONS - 1,
        polish=False,
        seed=1,
        tol=0.0,
        callback=lambda best, convergence: print(name, np.round(best, 4).tolist(), flush=True),
    )
    tuned = dict(zip(BOUNDS, (round(float(value), 4) for value in found.x), strict=True))
    return {"gains": tuned, "cost": round(float(found.fun), 4), "evaluations": int(found.nfev)}


def compare(walks: list[dict[str, Any]], one: str, other: str) -> dict[str, Any]:
    """How the walks of an arm differ from those of another: mean differences with intervals, and tests, in pairs."""
    pairs = [(Walk(**each[one]), Walk(**each[other])) for each in walks if other in each]
    upright = [pair for pair in pairs if not (pair[0].fell or pair[1].fell)]
    only = [sum(a.fell > b.fell for a, b in pairs), sum(b.fell > a.fell for a, b in pairs)]
    found: dict[str, Any] = {
        "fell_only": only,
        "p_mcnemar": _rounded(binomtest(only[0], sum(only)).pvalue if sum(only) else 1.0),
    }
    for part in PARTS:
        differences = np.array([getattr(a, part) - getattr(b, part) for a, b in (pairs if part == "cost" else upright)])
        found[part] = [_rounded(value) for value in (differences.mean(), *_interval(differences))]
        if part == "cost":
            found["p_wilcoxon"] = _rounded(wilcoxon(differences).pvalue if differences.any() else 1.0)
    return found


def summary(walks: list[dict[str, Any]]) -> dict[str, Any]:
    """What analysis.md asks of the walks."""
    found: dict[str, Any] = {}
    for name in ARMS:
        made = [Walk(**each[name]) for each in walks if name in each]
        parts = {part: [getattr(one, part) for one in made if part == "cost" or not one.fell] for part in PARTS}
        found[name] = {
            "walks": len(made),
            "falls": sum(one.fell for one in made),
            **{
                part: [_rounded(v) for v in (np.mean(values), *_interval(np.array(values)))]
                for part, values in parts.items()
            },
        }
    return {
        "arms": found,
        "predictor less": {name: compare(walks, "predictor", name) for name in ARMS if name != "predictor"},
    }


def _interval(values: Array) -> tuple[float, float]:
    draws = np.random.default_rng(0).integers(0, len(values), (10_000, len(values)))
    low, high = np.quantile(values[draws].mean(axis=1), (0.025, 0.975))
    return float(low), float(high)


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")


def tables(found: dict[str, Any], count: int) -> list[Table]:
    """The summary for a reader."""
    means = Table(
        "arm", *PARTS, "falls", title=f"Means of {count} walks, 95 % intervals; parts of the walks that end upright"
    )
    for name, arm in ARMS.items():
        one = found["arms"][name]
        means.add_row(arm.title, *("{:.3g} ({:.3g} to {:.3g})".format(*one[part]) for part in PARTS), str(one["falls"]))
    paired = Table("predictor less", *PARTS, "only one falls", "p: cost, falls", title="Differences, in pairs")
    for name, one in found["predictor less"].items():
        parts = ("{:+.3g} ({:+.3g} to {:+.3g})".format(*one[part]) for part in PARTS)
        falls = "{}, {}".format(*one["fell_only"])
        paired.add_row(ARMS[name].title, *parts, falls, f"{one['p_wilcoxon']:.2g}, {one['p_mcnemar']:.2g}")
    return [means, paired]


def draw(walks: list[dict[str, Any]], found: dict[str, Any], path: Path) -> None:
    """The parts of the cost of every walk, with means and their intervals."""
    from matplotlib.figure import Figure

    titles = ("cost", "peak of a landing, weights", "turning of the trunk, rad/s", "lag of the speed, parts of it")
    figure = Figure(figsize=(13.0, 4.0), layout="constrained")
    rows = np.arange(len(ARMS))[::-1]
    for axes, part, title in zip(figure.subplots(1, 4, sharey=True), PARTS, titles, strict=True):
        for row, name in zip(rows, ARMS, strict=True):
            made = [Walk(**each[name]) for each in walks if name in each]
            values = [getattr(one, part) for one in made if part == "cost" or not one.fell]
            spread = row + 0.25 * np.random.default_rng(0).uniform(-1.0, 1.0, len(values))
            colour = "#d55e00" if name == "predictor" else "#0072b2"
            axes.plot(values, spread, ".", color=colour, alpha=0.3, ms=4)
            mean, low, high = found["arms"][name][part]
            axes.errorbar(mean, row, xerr=[[mean - low], [high - mean]], fmt="D", color="black", ms=4, capsize=3)
        axes.set_xlabel(title)
        axes.grid(axis="x", color="#dddddd")
    axes.set_yticks(rows, [arm.title for arm in ARMS.values()])
    figure.savefig(path, dpi=110)


@click.command()
@click.option("--seeds", default=60, show_default=True, help="How many walks each arm makes.")
@click.option("--json", "file", type=click.Path(path_type=Path), help="Write the walks and what they tell.")
@click.option("--read", type=click.Path(exists=True, path_type=Path), help="Tell the walks of such a file again.")
@click.option("--figure", type=click.Path(path_type=Path), help="Draw the costs.")
@click.option("--tune", "names", multiple=True, type=click.Choice(TUNABLE), help="Tune the gains of an arm instead.")
def main(seeds: int, file: Path | None, read: Path | None, figure: Path | None, names: tuple[str, ...]) -> None:
    """Make the walks of every arm and compare them, or tune the gains."""
    known = json.loads(GAINS.read_text(encoding="utf-8")) if GAINS.exists() else {}
    if names:
        known |= {name: tune(name) for name in names}
        GAINS.write_text(json.dumps(known, indent=2, sort_keys=True) + "\n", encoding="utf-8")
        return
    if read:
        walks = json.loads(read.read_text(encoding="utf-8"))["walks"]
    else:
        gains = {name: Gains(**{**known[arm.gains]["gains"], **arm.fixed}) for name, arm in ARMS.items()}
        walks = []
        for seed in track(range(FIRST, FIRST + seeds), "walks"):
            arms = {name: arm for name, arm in ARMS.items() if seed < FIRST + arm.most}
            ends = {name: walk(arm, gains[name], trial(seed)) for name, arm in arms.items()}
            walks.append({"seed": seed, **{name: end.rounded() for name, end in ends.items()}})
    found = summary(walks)
    if file:
        lines = ",\n".join(json.dumps(each) for each in walks)
        file.write_text(f'{{"summary": {json.dumps(found)},\n"walks": [\n{lines}\n]}}\n', encoding="utf-8")
    Console(width=150).print(*tables(found, len(walks)))
    if figure:
        draw(walks, found, figure)


if __name__ == "__main__":
    main()
