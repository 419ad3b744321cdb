"""What a calibration prints, as sentences, a table and JSON, and what it changes in the parameter file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from ..calibration.fit import Calibration
from ..calibration.scene_file import changes_of, estimates_of, number_text
from ..calibration.search import FOLDS, interval
from ..prediction.types import Leftover, Score
from ..wording import counted, percent, words
from .summary import spread_of
from .table import Column, table_of


def estimates_table(calibration: Calibration) -> Table:
    """Given and fitted coefficients with their intervals."""
    columns = [
        Column("coefficient", lambda row: "inertia, of the given one" if row[0] == "inertia" else row[0], left=True),
        Column("given", lambda row: f"{row[1].given:.4g}"),
        Column("fitted", lambda row: f"{row[1].value:.4g}" if row[1].known else "not told"),
        Column("95 % interval", lambda row: interval(row[1])),
    ]
    return table_of(columns, estimates_of(calibration).items())


def sentences(calibration: Calibration, scores: Sequence[Score]) -> list[str]:
    """What was fitted to, what it is worth, and what is not told and why; one sentence each."""
    blocks = int(calibration.blocks.max()) + 1
    touchdowns = counted(len(calibration.touchdowns), "scored touchdown")
    said = [f"Fitted to {touchdowns} in {counted(blocks, 'block')} of time."]
    if calibration.left_out:
        said.append(
            f"{counted(calibration.left_out, 'scored touchdown')} left out: the body strikes again, or gravity turns "
            "it, within the four samples that measure it."
        )
    if reasons := unscored(scores):
        counts = ", ".join(f"{count:,} {words(reason)}" for reason, count in reasons.items())
        said.append(f"{counted(sum(not score.scored for score in scores), 'more touchdown')} not scored: {counts}.")
    given, held_out = (
        f"{percent(spread.p50)} % in the median, 90 % below {percent(spread.p90)} %"
        for spread in (spread_of(one.tolist()) for one in (calibration.given_errors, calibration.held_out))
    )
    said.append(
        f"Relative error: given {given}; fitted {held_out}, each touchdown predicted with what "
        f"was fitted to the other {min(FOLDS, blocks) - 1} of {min(FOLDS, blocks)} parts of the blocks."
    )
    if calibration.held_out.mean() > calibration.given_errors.mean():
        said.append("Held out, the fitted values are not better than the given ones: these touchdowns add nothing.")
    for name, one in estimates_of(calibration).items():
        if not one.known:
            kept = "it stays as given" if one.value == one.given else f"it becomes {number_text(one.value)}"
            worse = not (one.low or 0.0) <= one.value <= (inf if one.high is None else one.high)
            times = " times the given one" if name == "inertia" else ""
            but = "the given one predicts worse, but " if worse else ""
            said.append(f"The {name} cannot be told: {interval(one)}{times} predicts as well; {but}{kept}.")
    return said


def unscored(scores: Sequence[Score]) -> dict[str, int]:
    """How many touchdowns are not scored for each reason, the commonest first."""
    flags = [flag.name or "" for score in scores if not score.scored for flag in Leftover if flag & score.leftover]
    return dict(Counter(flags).most_common())


def as_json(calibration: Calibration, bags: Sequence[str], scores: Sequence[Score]) -> dict[str, Any]:
    """A calibration as JSON; relative errors as fractions of 1, the inertia as a factor on the given one."""
    estimates = estimates_of(calibration).items()
    return {
        "bags": list(bags),
        "touchdowns": len(calibration.touchdowns),
        "not_scored": unscored(scores),
        "left_out": calibration.left_out,
        "blocks": int(calibration.blocks.max()) + 1,
        "coefficients": {
            name: {"given": one.given, "value": one.value, "low": one.low, "high": one.high, "told": one.known}
            for name, one in estimates
        },
        "given_error": _errors_as_json(calibration.given_errors),
        "held_out_error": _errors_as_json(calibration.held_out),
        "inertia_profile": [list(pair) for pair in calibration.inertias],
        "parameters": {name: list(change.values) for name, change in changes_of(calibration).items()},
    }


def _errors_as_json(errors: NDArray[np.float64]) -> dict[str, Any]:
    spread = spread_of(errors.tolist())
    return {"number": spread.number, "median": spread.p50, "p90": spread.p90, "mean": float(errors.mean())}
