"""The whole report: every method on every scene, the recorded tosses of a cube, and what to choose."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator
from datetime import datetime, timezone
from importlib.metadata import PackageNotFoundError, version
from itertools import count
from math import inf, isfinite
from pathlib import Path
from statistics import median
from typing import Any, Final, NamedTuple

from ... import __version__
from ...bags.replay import replay
from ...parameters.file import read_values
from ...prediction.scene import Scene, scenes_of
from ...resources import find
from . import impacts, touchdowns
from .measure import (
    IMPACT,
    TOUCHDOWN,
    AccuracyRow,
    AccuracyScene,
    choices_of,
    computed,
    default_of,
    row_of,
    run,
)

TIMING: Final = (
    "CPU time of one prediction in plain Python unless the method says otherwise, of three runs the quickest."
)
NO_MUJOCO: Final = "MuJoCo is not compared: it is not installed; `pip install mujoco` or the extra `peers` brings it."

TOSSES: Final = AccuracyScene(
    "cube tosses",
    IMPACT,
    "Cube tosses, measured",
    "A cube of 0.1 m, tossed onto a hard floor: twist in the impact plane after an edge lands, published parameters.",
    "median of samples 2 to 4 after the touchdown, captured at 148 Hz",
    True,
)


class Size(NamedTuple):
    """How much is measured: problems of each touchdown and impact scene, seconds for a method on a scene, and how many
    of the `variants` replay the recorded tosses.
    """

    falls: int
    strikes: int
    seconds: float
    variants: int


FULL: Final = Size(32, 200, 0.6, 6)
QUICK: Final = Size(6, 24, 0.05, 3)


def variants(scene: Scene) -> Iterator[tuple[str, Scene]]:
    """The predictor with other laws and parameters."""
    yield "path law, slip across", scene
    yield "path law", scene._replace(transverse_slip=False)
    # The largest friction that is allowed holds any contact.
    yield "no slip", scene._replace(friction=100.0, restitution=0.0, transverse_slip=False)
    yield "total law", scene._replace(law="total", transverse_slip=False)
    yield "path law, plastic", scene._replace(restitution=0.0, transverse_slip=False)
    yield "total law, plastic", scene._replace(restitution=0.0, law="total", transverse_slip=False)


def report(size: Size, command: str, tell: Callable[[int], None] = lambda done: None) -> dict[str, Any]:
    """Measure everything; the report as its JSON has it. `tell` is told how many steps are done of `steps(size)`."""
    done = count(1)
    rows: list[AccuracyRow] = []
    for work in (touchdown_rows, impact_rows, toss_rows):
        for row in work(size):
            tell(next(done))
            rows += [row] if row else []
    scenes = [*touchdowns.scenes(), *impacts.scenes(), TOSSES]
    there = {row["family"] for row in rows}
    families = {**touchdowns.FAMILIES, **impacts.FAMILIES}.items()
    used = {TOUCHDOWN: touchdowns.USED, IMPACT: impacts.USED}
    node = {}
    for question, method in used.items():
        mine = [row for row in rows if row["question"] == question]
        node[question] = default_of(method, mine, computed(scenes, question))
    return {
        "made": made(command),
        "node": {question: default for question, default in node.items() if default},
        "notes": [] if impacts.has_mujoco() else [NO_MUJOCO],
        "families": [{"name": name, "says": says} for name, says in families if name in there],
        "scenes": [scene._asdict() for scene in scenes],
        "rows": rows,
        "choices": choices_of(rows, scenes),
    }


def steps(size: Size) -> int:
    """How many steps a report has."""
    planned = len(touchdowns.SCENES) * len(touchdowns.METHODS)
    return planned + len(impacts.SCENES) * len(impacts.methods()) + size.variants


def touchdown_rows(size: Size) -> Iterator[AccuracyRow]:
    """The methods for touchdowns on each scene."""
    for scene in touchdowns.scenes():
        problems = touchdowns.falls(scene.name, size.falls)
        references = [touchdowns.reference_of(problem) for problem in problems]
        for method in touchdowns.METHODS:
            found = run(method, problems, size.seconds)
            errors = [
                touchdowns.errors_of(fall, answer, right) if answer and isfinite(answer.time) else (inf, inf)
                for fall, answer, right in zip(problems, found.answers, references, strict=False)
            ]
            times, twists = zip(*errors, strict=True)
            yield row_of(scene, method[:3], found.us, times, twists)


def impact_rows(size: Size) -> Iterator[AccuracyRow]:
    """The methods for impacts on each scene; nothing where one does not apply."""
    for scene in impacts.scenes():
        problems = impacts.strikes(scene.name, size.strikes)
        references = [impacts.reference_of(problem) for problem in problems]
        for method in impacts.methods():
            if not all(map(method.applies, problems)):
                yield {}
                continue
            found = run(method, problems, size.seconds)
            both = list(zip(problems, found.answers, references, strict=False))
            errors = [inf if after is None else impacts.error_of_twist(one, after, right) for one, after, right in both]
            wrong = [after.mode != right.mode for _, after, right in both if after and after.mode is not None]
            yield row_of(scene, method[:3], found.us, None, errors, sum(wrong) / len(wrong) if wrong else None)


def toss_rows(size: Size) -> Iterator[AccuracyRow]:
    """The recorded tosses through the predictor, against what was measured after each landing."""
    (body,) = scenes_of(read_values(find("config/cube_tosses.yaml"))).values()
    body = body._replace(samples=0, margins=False)
    for name, scene in list(variants(body))[: size.variants]:
        found = replay(find("examples/cube_tosses"), scene)
        scores = [settled.score for settled in found.settled if settled.score.scored]
        errors = [inf if score.relative_error is None else score.relative_error for score in scores]
        costs = [1e6 * settled.cost for settled in found.settled if settled.cost is not None]
        yield row_of(TOSSES, ("predictor", name, ""), costs or [1e6 * median(found.costs)], None, errors)


def made(command: str) -> dict[str, str]:
    """Where, when and with what a report is made."""
    versions = {name: installed(name) for name in ("numpy", "scipy", "numba", "mujoco")}
    return {
        "version": __version__,
        "python": platform.python_version(),
        **versions,
        "machine": f"{processor()}, {os.cpu_count()} cores",
        "date": datetime.now(timezone.utc).date().isoformat(),
        "command": command,
        "timing": TIMING,
    }


def installed(name: str) -> str:
    """The version of a package, or that it is missing."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def processor() -> str:
    """The name of the processor, as far as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())
