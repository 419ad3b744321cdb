"""What a calibration prints, as sentences, tables and JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import inf
from typing import Any, Final

import numpy as np
from rich.table import Table

from ..calibration.fit import Calibration
from ..calibration.motions import Reals
from ..calibration.scene_file import changes_of, number_text
from ..calibration.search import FOLDS, interval
from ..prediction.types import KINDS, Leftover, Score
from ..wording import counted, percent, words
from .summary import spread_of
from .table import Column, table_of

NAMES: Final = {"merge": "merge time (s)", "inertia": "inertia, of the given one"}
"""What coefficients are called that go by more than their names."""


def errors_of(calibration: Calibration) -> dict[str, Reals]:
    """The errors of each way to predict, by what it is called."""
    return {"given": calibration.given, "fitted, held out": calibration.held_out, **calibration.simple}


def tables(calibration: Calibration) -> list[Table]:
    """Given and fitted coefficients with their intervals; errors, those of simple answers too; errors by kind."""
    coefficients = [
        Column("coefficient", lambda row: NAMES.get(row[0], row[0]), left=True),
        Column("given", lambda row: f"{row[1].given:.4g}"),
        Column("fitted", lambda row: f"{row[1].value:.4g}" if row[1].known else "not told"),
        Column("95 % interval", lambda row: interval(row[1])),
    ]
    spread = [
        Column("median (%)", lambda row: percent(float(np.median(row[-1])))),
        Column("90 % below (%)", lambda row: percent(float(np.quantile(row[-1], 0.9)))),
    ]
    kinds = np.array([one.kind for one in calibration.touchdowns])
    by_kind = [(kind, calibration.held_out[kinds == kind]) for kind in KINDS if kind in kinds]
    return [
        table_of(coefficients, calibration.estimates.items()),
        table_of([Column("relative error", lambda row: row[0], left=True), *spread], errors_of(calibration).items()),
        table_of(
            [
                Column("fitted, held out", lambda row: row[0], left=True),
                Column("touchdowns", lambda row: f"{len(row[1])}"),
                *spread,
            ],
            by_kind,
        ),
    ]


def sentences(calibration: Calibration, scores: Sequence[Score]) -> list[str]:
    """What was fitted to, what it is worth, and what is not told and why; one sentence each."""
    blocks = int(calibration.blocks.max()) + 1
    touchdowns = counted(len(calibration.touchdowns), "touchdown")
    folds = min(FOLDS, blocks)
    stretches = f"{counted(blocks, 'motion')} or stretches of time"
    said = [
        f"Fitted to {touchdowns} in {stretches}.",
        f"Held out, each is predicted with what was fitted to the other {folds - 1} of {folds} parts of them.",
    ]
    if reasons := unscored(scores):
        counts = ", ".join(f"{count:,} {words(reason)}" for reason, count in reasons.items())
        number = sum(bool(_reasons(score)) for score in scores)
        said.append(f"{counted(number, 'more touchdown')} not scored: {counts}.")
    if calibration.held_out.mean() > calibration.given.mean():
        said.append("Held out, the fitted values are not better than the given ones: these touchdowns add nothing.")
    for name, one in calibration.estimates.items():
        called = NAMES.get(name, name).partition(" (")[0].partition(",")[0]
        if not one.known:
            kept = "it stays as given" if one.value == one.given else f"it becomes {number_text(one.value)}"
            worse = not (one.low or 0.0) <= one.value <= (inf if one.high is None else one.high)
            times = " times the given one" if name == "inertia" else ""
            but = "the given one predicts worse, but " if worse else ""
            said.append(f"The {called} cannot be told: {interval(one)}{times} predicts as well; {but}{kept}.")
    return said


def unscored(scores: Sequence[Score]) -> dict[str, int]:
    """How many touchdowns are not scored for each reason, the commonest first."""
    reasons = [_reasons(score) for score in scores]
    flags = [flag.name or "" for one in reasons for flag in Leftover if flag & one]
    return dict(Counter(flags).most_common())


def _reasons(score: Score) -> Leftover:
    """Why a touchdown is not scored: by its whole twist, or else in its plane."""
    return score.leftover_6d if score.spatial is not None or not score.scored else Leftover.NONE


def as_json(calibration: Calibration, bags: Sequence[str], scores: Sequence[Score]) -> dict[str, Any]:
    """A calibration as JSON; relative errors as fractions of 1, the inertia as a factor on the given one."""
    return {
        "bags": list(bags),
        "touchdowns": len(calibration.touchdowns),
        "not_scored": unscored(scores),
        "blocks": int(calibration.blocks.max()) + 1,
        "coefficients": {
            name: {"given": one.given, "value": one.value, "low": one.low, "high": one.high, "told": one.known}
            for name, one in calibration.estimates.items()
        },
        "given_error": _errors_as_json(calibration.given),
        "held_out_error": _errors_as_json(calibration.held_out),
        "simple_errors": {said: _errors_as_json(errors) for said, errors in calibration.simple.items()},
        "parameters": {name: list(change.values) for name, change in changes_of(calibration).items()},
    }


def _errors_as_json(errors: Reals) -> dict[str, Any]:
    spread = spread_of(errors.tolist())
    return {"number": spread.number, "median": spread.p50, "p90": spread.p90, "mean": float(errors.mean())}
