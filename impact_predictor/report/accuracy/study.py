"""The whole report: every method on every scene, the recorded tosses of a cube, and what to choose."""

from __future__ import annotations

import os
import platform
import re
from collections.abc import Callable, Iterator, Mapping
from datetime import datetime, timezone
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from itertools import count
from math import inf, isfinite
from pathlib import Path
from statistics import median
from typing import Any, Final, NamedTuple

import numpy as np

from ... import __version__
from ...bags.replay import replay
from ...mechanics.impact import LAWS
from ...mechanics.impact.batch import solve_impacts
from ...mechanics.invariants import UNANSWERED, violations
from ...mechanics.random_problems import problems_of
from ...parameters.file import read_values
from ...prediction.scene import Scene, scenes_of
from ...resources import find
from . import impacts, touchdowns
from .measure import (
    IMPACT,
    STABILITY,
    TOUCHDOWN,
    AccuracyRow,
    AccuracyScene,
    choices_of,
    computed,
    default_of,
    problems,
    row_of,
    run,
    seconds_of,
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

OVER_ARRAYS: Final = "over arrays"
"""The setting of a law that solves many impacts in one call."""

MECHANICS: Final = ("cone", "momentum", "approach", "work", "energy")
"""The invariants that one outcome violates or not."""

RANDOM: Final = [
    AccuracyScene(kind, STABILITY, title, description, "mechanics itself: no other solution is needed")
    for kind, title, description in (
        ("tilted", "Ordinary bodies", "Two contacts anywhere with any normals, sizes of 0.1 to 2 m, friction to 4."),
        ("slender", "Slender bodies", "Lengths and frictions over eight decades, on a floor or a slope."),
        ("close", "Close contacts", "Both contacts nearly at one place, 1e-9 to 0.1 m from each other."),
        ("parallel", "Parallel normals", "Normals that are parallel or opposed but for 1e-12 to 0.1 rad."),
        ("extreme", "Extreme bodies", "Every length, mass, friction and speed over eight to twelve decades."),
        ("extreme-apart", "Extreme supports", "The same on supports that move apart."),
    )
]
"""The scenes of the stability, by the kinds of `random_problems`."""


class Size(NamedTuple):
    """How much is measured: problems of each touchdown, impact and random scene, seconds for a method on a scene, and
    how many of the `variants` replay the recorded tosses.
    """

    falls: int
    strikes: int
    random: int
    seconds: float
    variants: int


FULL: Final = Size(falls=32, strikes=200, random=20_000, seconds=0.6, variants=6)
QUICK: Final = Size(falls=6, strikes=24, random=2_000, seconds=0.05, variants=3)


def variants(scene: Scene) -> Iterator[tuple[str, Scene]]:
    """The predictor with other laws and parameters."""
    yield "path law, slip across", scene
    yield "path law", scene._replace(transverse_slip=False)
    # The largest friction that is allowed holds any contact.
    yield "no slip", scene._replace(friction=100.0, restitution=0.0, transverse_slip=False)
    yield "total law", scene._replace(law="total", transverse_slip=False)
    yield "path law, plastic", scene._replace(restitution=0.0, transverse_slip=False)
    yield "total law, plastic", scene._replace(restitution=0.0, law="total", transverse_slip=False)


def scenes_of_question(question: str) -> list[AccuracyScene]:
    """The scenes of touchdowns or of impacts."""
    drawn: Mapping[str, tuple[str, str, str, Any]] = touchdowns.SCENES if question == TOUCHDOWN else impacts.SCENES
    return [
        AccuracyScene(name, question, title, description, reference)
        for name, (title, description, reference, _) in drawn.items()
    ]


def report(size: Size, command: str, tell: Callable[[int], None] = lambda done: None) -> dict[str, Any]:
    """Measure everything; the report as its JSON has it. `tell` is told how many steps are done of `steps(size)`."""
    done = count(1)
    rows: list[AccuracyRow] = []
    for work in (touchdown_rows, impact_rows, stability_rows, toss_rows):
        for row in work(size):
            tell(next(done))
            rows += [row] if row else []
    scenes = [*scenes_of_question(TOUCHDOWN), *scenes_of_question(IMPACT), *RANDOM, TOSSES]
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
    return planned + len(impacts.SCENES) * len(impacts.methods()) + len(RANDOM) * len(LAWS) + size.variants


def touchdown_rows(size: Size) -> Iterator[AccuracyRow]:
    """The methods for touchdowns on each scene."""
    for scene in scenes_of_question(TOUCHDOWN):
        falls = problems(touchdowns.SCENES, scene.name, size.falls)
        references = list(map(touchdowns.reference_of, falls))
        for method in touchdowns.METHODS:
            found = run(method, falls, size.seconds)
            errors = [
                touchdowns.errors_of(fall, answer, right) if answer and isfinite(answer.time) else (inf, inf)
                for fall, answer, right in zip(falls, found.answers, references, strict=False)
            ]
            times, twists = zip(*errors, strict=True)
            yield row_of(scene, method[:3], found.us, times, twists)


def impact_rows(size: Size) -> Iterator[AccuracyRow]:
    """The methods for impacts on each scene; nothing where one does not apply."""
    for scene in scenes_of_question(IMPACT):
        strikes = problems(impacts.SCENES, scene.name, size.strikes)
        references = list(map(impacts.reference_of, strikes))
        for method in impacts.methods():
            if not all(map(method.applies, strikes)):
                yield {}
                continue
            found = run(method, strikes, size.seconds)
            both = list(zip(strikes, found.answers, references, strict=False))
            errors = [inf if after is None else impacts.error_of_twist(one, after, right) for one, after, right in both]
            wrong = [after.mode != right.mode for _, after, right in both if after and after.mode is not None]
            part = sum(wrong) / len(wrong) if wrong else None
            yield row_of(scene, method[:3], found.us, twists=errors, wrong_modes=part)


def stability_rows(size: Size) -> Iterator[AccuracyRow]:
    """Each law on random impacts of ordinary, stiff and extreme kinds: by how much the outcomes violate mechanics."""
    for scene in RANDOM:
        _, body, twist = problems_of(scene.name, np.random.default_rng(4), size.random)
        for law in LAWS:
            # Sizes over many decades overflow in sums of squares; what is not a number counts as endlessly wrong.
            with np.errstate(all="ignore"):
                outcomes, found = violations(body, twist, law)
                us = 1e6 * seconds_of(partial(solve_impacts, body, twist, law)) / size.random
            worst = np.nan_to_num(np.maximum.reduce([found[name] for name in MECHANICS]), nan=inf)
            answered = (outcomes.flags & UNANSWERED) == 0
            row = row_of(scene, (f"{law} law", f"{law} law", OVER_ARRAYS), [us], violations=worst[answered].tolist())
            yield row | {"count": size.random, "failed": int(size.random - answered.sum())}


def toss_rows(size: Size) -> Iterator[AccuracyRow]:
    """The recorded tosses through the predictor, against what was measured after each landing."""
    (body,) = scenes_of(read_values(find("config/cube_tosses.yaml"))).values()
    body = body._replace(samples=0, margins=False)
    for name, scene in list(variants(body))[: size.variants]:
        found = replay(find("examples/cube_tosses"), scene)
        scores = [settled.score for settled in found.settled if settled.score.scored]
        errors = [inf if score.relative_error is None else score.relative_error for score in scores]
        costs = [1e6 * settled.cost for settled in found.settled if settled.cost is not None]
        yield row_of(TOSSES, ("predictor", name, ""), costs or [1e6 * median(found.costs)], twists=errors)


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
    file = Path("/proc/cpuinfo")
    found = re.search(r"^model name\s*:\s*(.+)", file.read_text(encoding="utf-8") if file.exists() else "", re.M)
    return found[1] if found else platform.processor() or platform.machine()
