"""The whole report: every method on every scene, measured tosses, and choices."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime, timezone
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from itertools import count
from math import inf, isfinite
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from ... import __version__
from . import (
    compliant_peer,
    impact_errors,
    impact_methods,
    impact_reference,
    impact_scenes,
    integrators,
    mujoco_peer,
    stepping,
    tosses,
    touchdown_methods,
    touchdown_problems,
    touchdown_reference,
    touchdown_scenes,
)
from .choices import choices_of, defaults_of
from .measuring import Effort, Measured, measure
from .methods import Method
from .rows import Family, Report, Row, Scene, quantiles

TIMING = (
    "CPU time of one prediction in plain Python unless the method says otherwise, methods in turns: the median over "
    "rounds, then over the problems of a scene."
)

NO_MUJOCO = "MuJoCo is not compared, because it is not installed; `pip install mujoco` or the extra `peers` brings it."


class Size(NamedTuple):
    """How much is measured: problems of a touchdown and of an impact scene, effort for each method on each scene,
    samples of the recorded tosses and runs over them.
    """

    falls: int
    strikes: int
    effort: Effort
    samples: int
    toss_runs: int


FULL = Size(32, 200, Effort(0.4, 0.2, 5), 100_000, 3)
QUICK = Size(6, 24, Effort(0.03, 0.02, 3), 4_000, 1)

TOUCHDOWN_METHODS: list[Method] = [
    *touchdown_methods.METHODS,
    *integrators.METHODS,
    *stepping.METHODS,
    *compliant_peer.METHODS,
]


def impact_methods_here() -> list[Method]:
    """The methods for impacts that can run on this machine."""
    peers = mujoco_peer.METHODS if mujoco_peer.is_installed() else []
    return [*impact_methods.METHODS, *stepping.IMPACT_METHODS, *compliant_peer.IMPACT_METHODS, *peers]


class Work(NamedTuple):
    """A part of the report: how many steps it has, and what makes its rows."""

    steps: int
    rows: Callable[[Callable[[], None]], list[Row]]


def works(size: Size) -> Iterator[Work]:
    """All that is measured, scene by scene."""
    for scene in touchdown_scenes.scenes():
        yield Work(len(TOUCHDOWN_METHODS), partial(touchdown_rows, scene, size))
    methods = impact_methods_here()
    for scene in impact_scenes.scenes():
        yield Work(len(methods), partial(impact_rows, scene, methods, size))
    yield Work(tosses.VARIANTS * size.toss_runs + len(TOUCHDOWN_METHODS), partial(toss_rows, size))


def touchdown_rows(scene: Scene, size: Size, tell: Callable[[], None]) -> list[Row]:
    """The methods for touchdowns on one scene."""
    problems = touchdown_problems.falls(scene.name, size.falls)
    references = [touchdown_reference.reference_of(problem) for problem in problems]
    rows = []
    for measured in measure(TOUCHDOWN_METHODS, problems, size.effort, tell):
        times, twists = [], []
        for problem, answer, reference in zip(problems, measured.answers, references, strict=False):
            times.append(touchdown_error(answer, reference))
            twists.append(landing_twist_error(problem, answer, reference))
        rows.append(row_of(scene, measured, times, twists, None))
    return rows


def touchdown_error(answer: Any, reference: touchdown_reference.Reference) -> float:
    return inf if answer is None or not isfinite(answer.time) else touchdown_reference.time_error(answer, reference)


def landing_twist_error(problem: Any, answer: Any, reference: touchdown_reference.Reference) -> float:
    """Error of the twist at the touchdown, relative to its size."""
    if answer is None:
        return inf
    square = problem.rho_squared
    apart = touchdown_reference.distance(answer.twist, reference.twist, square)
    return apart / touchdown_reference.size_of(reference.twist, square)


def impact_rows(scene: Scene, methods: Sequence[Method], size: Size, tell: Callable[[], None]) -> list[Row]:
    """The methods for impacts on one scene; problems without an answer or without motion are left out."""
    problems, references = [], []
    for problem in impact_scenes.strikes(scene.name, size.strikes):
        reference = impact_reference.reference_of(problem)
        if reference is not None and touchdown_reference.size_of(problem.twist, 1.0) > 0.0:
            problems.append(problem)
            references.append(reference)
    rows = []
    for measured in measure(methods, problems, size.effort, tell):
        errors, wrong = [], []
        for problem, answer, reference in zip(problems, measured.answers, references, strict=False):
            errors.append(inf if answer is None else impact_errors.twist_error(problem, answer, reference))
            wrong.append(answer is None or impact_errors.is_wrong(problem, answer, reference))
        rows.append(row_of(scene, measured, None, errors, sum(wrong) / len(wrong)))
    return rows


def toss_rows(size: Size, tell: Callable[[], None]) -> list[Row]:
    """The recorded tosses: the predictor's laws, and the methods for touchdowns on its planar bodies."""
    record = tosses.read(size.samples)
    rows = tosses.impact_rows(record, size.toss_runs, tell)
    seen = tosses.landings(record)
    for measured in measure(TOUCHDOWN_METHODS, [landing.fall for landing in seen], size.effort, tell):
        times = [
            inf if answer is None else abs(answer.time - landing.time) / landing.time
            for answer, landing in zip(measured.answers, seen, strict=False)
        ]
        rows.append(row_of(tosses.SCENES[0], measured, times, None, None))
    return rows


def row_of(
    scene: Scene, measured: Measured, times: list[float] | None, twists: list[float] | None, wrong: float | None
) -> Row:
    method, answers, us = measured
    costs = sorted(us)
    return Row(
        scene.question,
        scene.name,
        method.family,
        method.name,
        method.setting,
        median(costs),
        costs[len(costs) * 9 // 10],
        None if times is None else quantiles(times),
        None if twists is None else quantiles(twists),
        wrong,
        len(answers),
        sum(answer is None for answer in answers),
    )


def report(
    size: Size,
    command: str,
    tell: Callable[[int], None] = lambda done: None,
) -> Report:
    """Measure everything; `tell` is told how many steps are done of `steps(size)`."""
    done = count(1)
    rows = [row for work in works(size) for row in work.rows(lambda: tell(next(done)))]
    scenes = [*touchdown_scenes.scenes(), *impact_scenes.scenes(), *tosses.SCENES]
    return Report(
        made(command),
        defaults_of(rows, scenes),
        [] if mujoco_peer.is_installed() else [NO_MUJOCO],
        list(families_of(rows)),
        scenes,
        rows,
        choices_of(rows, scenes),
    )


def steps(size: Size) -> int:
    """How many steps a report has."""
    return sum(work.steps for work in works(size))


def families_of(rows: Sequence[Row]) -> Iterator[Family]:
    """The families that have a row, in the order in which they are defined."""
    there = {row.family for row in rows}
    said: dict[str, str] = {}
    for module in (touchdown_methods, integrators, impact_methods, stepping, compliant_peer, mujoco_peer, tosses):
        said |= module.FAMILIES
    return (Family(name, says) for name, says in said.items() if name in there)


def made(command: str) -> dict[str, str]:
    """Where, when and with what a report is made."""
    return {
        "version": __version__,
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "scipy": version("scipy"),
        "numba": installed("numba"),
        "mujoco": installed("mujoco"),
        "machine": f"{processor()}, {os.cpu_count()} cores",
        "date": datetime.now(timezone.utc).date().isoformat(),
        "command": command,
        "timing": TIMING,
    }


def installed(name: str) -> str:
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
