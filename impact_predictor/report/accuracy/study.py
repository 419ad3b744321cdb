"""The whole report: every method on every scene, the recorded tosses of a cube, and what to choose."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator
from contextlib import suppress
from datetime import datetime, timezone
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from itertools import islice
from math import inf
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
from . import impacts, measure, touchdowns
from .measure import IMPACT, STABILITY, TOSSES, TOUCHDOWN, AccuracyRow, AccuracyScene

USED: Final = {TOUCHDOWN: touchdowns.USED, IMPACT: impacts.USED}
"""What the node uses."""

TIMING: Final = (
    "CPU time of one prediction in plain Python unless the method says otherwise, of three runs the quickest."
)

CUBE: Final = AccuracyScene(
    name="cube tosses",
    question=TOSSES,
    title="Cube tosses",
    description="A cube of 0.1 m, tossed onto a hard floor: twist in the impact plane after an edge lands.",
    reference="measurement: median of samples 2 to 4 after the touchdown, captured at 148 Hz",
)

MECHANICS: Final = ("cone", "momentum", "approach", "work", "energy")
"""The invariants that one outcome violates or not."""

RANDOM: Final = [
    AccuracyScene(kind, STABILITY, title, description, "mechanics itself: no other solution is needed")
    for kind, title, description in (
        ("tilted", "Ordinary bodies", "Two contacts anywhere with any normals, sizes of 0.1 to 2 m, friction to 4."),
        ("slender", "Slender bodies", "Lengths and frictions over eight decades, on a floor or a slope."),
        ("extreme", "Extreme bodies", "Every length, mass, friction and speed over eight to twelve decades."),
        ("extreme-apart", "Extreme supports", "The same on supports that move apart."),
    )
]
"""The scenes of the stability, by the kinds of `random_problems`."""


class Size(NamedTuple):
    """How many problems each scene has, s for a method on a scene, and how many `variants` replay the tosses."""

    falls: int
    strikes: int
    random: int
    seconds: float
    variants: int


FULL: Final = Size(falls=32, strikes=200, random=20_000, seconds=0.6, variants=6)
QUICK: Final = Size(falls=6, strikes=24, random=2_000, seconds=0.05, variants=3)


def variants(scene: Scene) -> dict[str, Scene]:
    """The predictor with other laws and parameters."""
    planar = scene._replace(transverse_slip=False)
    return {
        "path law, slip across": scene,
        "path law": planar,
        # The largest friction that is allowed holds any contact.
        "no slip": planar._replace(friction=100.0, restitution=0.0),
        "total law": planar._replace(law="total"),
        "path law, plastic": planar._replace(restitution=0.0),
        "total law, plastic": planar._replace(restitution=0.0, law="total"),
    }


def report(size: Size, command: str, tell: Callable[[int], None] = lambda done: None) -> dict[str, Any]:
    """Measure everything; the report as its JSON has it. `tell` is told how many rows are done of `steps(size)`."""
    rows: list[AccuracyRow] = []
    for work in (
        measure.rows_of(touchdowns, touchdowns.METHODS, size.falls, size.seconds),
        measure.rows_of(impacts, impacts.METHODS, size.strikes, size.seconds),
        stability_rows(size.random),
        toss_rows(size.variants),
    ):
        for row in work:
            rows.append(row)
            tell(len(rows))
    used = {name: measure.used_of(one, rows, name) for name, one in USED.items()}
    return {
        "made": made(command),
        "node": {name: method for name, method in used.items() if method},
        "scenes": [scene._asdict() for scene in (*touchdowns.SCENES, *impacts.SCENES, *RANDOM, CUBE)],
        "rows": rows,
        "choices": [one for name in used for one in measure.choices_of(rows, name)],
    }


def steps(size: Size) -> int:
    """How many rows a report has."""
    drawn = len(touchdowns.SCENES) * len(touchdowns.METHODS) + len(impacts.SCENES) * len(impacts.METHODS)
    return drawn + len(RANDOM) * len(LAWS) + size.variants


def stability_rows(count: int) -> Iterator[AccuracyRow]:
    """Each law on random impacts of ordinary, stiff and extreme kinds: by how much the outcomes violate mechanics."""
    for scene in RANDOM:
        _, body, twist = problems_of(scene.name, np.random.default_rng(4), count)
        for law in LAWS:
            # Sizes over many decades overflow in sums of squares; what is not a number counts as endlessly wrong.
            with np.errstate(all="ignore"):
                outcomes, found = violations(body, twist, law)
                us = 1e6 * measure.seconds_of(partial(solve_impacts, body, twist, law)) / count
            worst = np.nan_to_num(np.maximum.reduce([found[name] for name in MECHANICS]), nan=inf)
            answered = (outcomes.flags & UNANSWERED) == 0
            errors = [{"violation": one} if known else {} for one, known in zip(worst.tolist(), answered, strict=True)]
            yield measure.row_of(scene, (f"{law} law", f"{law} law", "over arrays"), [us], errors)


def toss_rows(count: int) -> Iterator[AccuracyRow]:
    """The recorded tosses through `count` variants of the predictor, against what was measured after each landing."""
    (scene,) = scenes_of(read_values(find("config/cube_tosses.yaml"))).values()
    for name, variant in islice(variants(scene._replace(samples=0, margins=False)).items(), count):
        found = replay(find("examples/cube_tosses"), variant)
        scored = [one.score.relative_error for one in found.settled if one.score.scored]
        errors = [{"twist_error": inf if error is None else error} for error in scored]
        costs = [1e6 * settled.cost for settled in found.settled if settled.cost is not None]
        yield measure.row_of(CUBE, ("predictor", name, ""), costs or [1e6 * median(found.costs)], errors)


def made(command: str) -> dict[str, str]:
    """Where, when and with what a report is made."""
    versions = dict.fromkeys(("numpy", "scipy", "numba"), "not installed")
    for name in versions:
        with suppress(PackageNotFoundError):
            versions[name] = version(name)
    machine = f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores"
    date = datetime.now(timezone.utc).date().isoformat()
    own = {"version": __version__, "python": platform.python_version()}
    return {**own, **versions, "machine": machine, "date": date, "command": command, "timing": TIMING}
