"""What a calibration prints, as sentences, a table and JSON, and what it changes in the parameter file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from ..calibration.fit import Calibration
from ..calibration.scene_file import NewValues, number_text
from ..calibration.search import FOLDS, Estimate
from ..prediction.types import Leftover, Score
from ..wording import counted, percent, words
from .summary import Distribution, spread_of
from .table import plain_table

NAMES: Final = ("friction", "restitution", "inertia")
PARAMETERS: Final = {"friction": "contact.friction", "restitution": "contact.restitution", "inertia": "body.inertia"}


def estimates_of(calibration: Calibration) -> dict[str, Estimate]:
    """The estimates by the names of the coefficients."""
    return {name: getattr(calibration, name) for name in NAMES}


def estimates_table(calibration: Calibration) -> Table:
    """Given and fitted coefficients with their intervals."""
    table = plain_table()
    for header in ("coefficient", "given", "fitted", "95 % interval"):
        table.add_column(header, justify="left" if header == "coefficient" else "right", no_wrap=True)
    for name, one in estimates_of(calibration).items():
        label = "inertia, of the given one" if name == "inertia" else name
        fitted = (
            f"{one.value:.4g}" if one.known else "not told" if one.value == one.given else f"raised to {one.value:.4g}"
        )
        table.add_row(label, f"{one.given:.4g}", fitted, interval(one), style="" if one.known else "dim")
    return table


def interval(one: Estimate) -> str:
    """An interval in words."""
    if one.low is None and one.high is None:
        return "any"
    if one.low is None:
        return f"at most {one.high:.3g}"
    if one.high is None:
        return f"at least {one.low:.3g}" if one.low > 0.0 else "any"
    # As many digits as tell the ends apart.
    digits = next((n for n in range(3, 9) if f"{one.low:.{n}g}" != f"{one.high:.{n}g}"), 9)
    return f"{one.low:.{digits}g} to {one.high:.{digits}g}"


def sentences(calibration: Calibration, scores: Sequence[Score]) -> list[str]:
    """What was fitted to, what it is worth, and what is not told and why; one sentence each."""
    number = len(calibration.touchdowns)
    blocks = int(calibration.blocks.max()) + 1
    said = [f"Fitted to {counted(number, 'scored touchdown')} in {counted(blocks, 'block')} of time."]
    if calibration.left_out:
        said.append(
            f"{counted(calibration.left_out, 'scored touchdown')} left out: the body strikes again, or gravity turns "
            "it, within the four samples that measure it."
        )
    if reasons := unscored(scores):
        counts = ", ".join(f"{count:,} {words(reason)}" for reason, count in reasons.items())
        said.append(f"{counted(sum(not score.scored for score in scores), 'more touchdown')} not scored: {counts}.")
    given, held_out = (spread_of(one.tolist()) for one in (calibration.given_errors, calibration.held_out))
    said.append(
        f"Relative error: given {_error(given)}; fitted {_error(held_out)}, each touchdown predicted with what "
        f"was fitted to the other {min(FOLDS, blocks) - 1} of {min(FOLDS, blocks)} parts of the blocks."
    )
    if calibration.held_out.mean() > calibration.given_errors.mean():
        said.append("Held out, the fitted values are not better than the given ones: these touchdowns add nothing.")
    return said + [_not_told(name, one) for name, one in estimates_of(calibration).items() if not one.known]


def unscored(scores: Sequence[Score]) -> dict[str, int]:
    """How many touchdowns are not scored for each reason, the commonest first."""
    flags = [flag.name or "" for score in scores if not score.scored for flag in Leftover if flag & score.leftover]
    return dict(Counter(flags).most_common())


def changes_of(calibration: Calibration) -> dict[str, NewValues]:
    """What the fit changes in the parameter file of the scene."""
    changes = {}
    for name, one in estimates_of(calibration).items():
        if one.value == one.given:
            continue
        values: tuple[float, ...] = (one.value,)
        of = ""
        if name == "inertia":
            (xx, xy, xz), (_, yy, yz), (_, _, zz) = calibration.touchdowns[0].scene.inertia
            given = (xx,) if xx == yy == zz and not (xy or xz or yz) else (xx, yy, zz, xy, xz, yz)
            values, of = tuple(one.value * part for part in given), "factor "
        remark = f"fitted to {len(calibration.touchdowns)} touchdowns; {of}{interval(one)} with 95 %"
        changes[PARAMETERS[name]] = NewValues(values, remark, listed=name == "inertia")
    return changes


def as_json(calibration: Calibration, bags: Sequence[str], scores: Sequence[Score]) -> dict[str, Any]:
    """A calibration as JSON; relative errors as fractions of 1, the inertia as a factor on the given one."""
    return {
        "bags": list(bags),
        "touchdowns": len(calibration.touchdowns),
        "not_scored": unscored(scores),
        "left_out": calibration.left_out,
        "blocks": int(calibration.blocks.max()) + 1,
        "coefficients": {name: _fields(one) for name, one in estimates_of(calibration).items()},
        "given_error": _error_fields(calibration.given_errors),
        "held_out_error": _error_fields(calibration.held_out),
        "inertia_profile": [list(pair) for pair in calibration.inertias],
        "parameters": {name: list(change.values) for name, change in changes_of(calibration).items()},
    }


def _error_fields(errors: NDArray[np.float64]) -> dict[str, Any]:
    spread = spread_of(errors.tolist())
    return {"number": spread.number, "median": spread.p50, "p90": spread.p90, "mean": float(errors.mean())}


def _fields(one: Estimate) -> dict[str, Any]:
    return {"given": one.given, "value": one.value, "low": one.low, "high": one.high, "told": one.known}


def _error(errors: Distribution) -> str:
    return f"{percent(errors.p50)} % in the median, 90 % below {percent(errors.p90)} %"


def _not_told(name: str, one: Estimate) -> str:
    if name == "friction":
        if not one.low:
            return "The friction cannot be told: these impacts hardly depend on it."
        stays = (
            f"it stays {number_text(one.value)}" if one.value == one.given else f"it becomes {number_text(one.value)}"
        )
        return f"Of the friction only a lower bound is told, {one.low:.3g}, because nothing slips beyond: {stays}."
    if name == "restitution":
        return f"The restitution cannot be told: any above {one.low or 0.0:.3g} predicts as well; it stays as given."
    if one.low is None and one.high is None:
        return "The inertia cannot be told: these impacts hardly depend on it; it stays as given."
    worse = not (one.low or 0.0) <= 1.0 <= (one.high or 1.0)
    but = "the given one predicts worse, but stays" if worse else "it stays as given"
    return f"The inertia cannot be told: {interval(one)} times the given one predicts as well; {but}."
