"""What an identification prints, as tables, sentences and JSON, and what it changes in the parameter file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.table import Table

from ..calibration.identify import Identification, six_of
from ..calibration.scene_file import NewValues, number_text
from ..calibration.search import FOLDS, Estimate, interval
from ..wording import counted, listed, percent
from .table import Column, table_of

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def named(found: Identification) -> dict[str, Estimate]:
    """The estimates by what they are called."""
    moments = MOMENTS if len(found.inertia) > 1 else ("inertia",)
    center = zip(("center x", "center y", "center z"), found.center, strict=True)
    return {**dict(zip(moments, found.inertia, strict=False)), **dict(center)}


def tables(found: Identification) -> list[Table]:
    """Given and identified numbers with their intervals; and what corners of several radii make of them."""
    body = [
        Column("of the body", lambda row: f"{row[0]} ({'m' if 'center' in row[0] else 'kg m^2'})", left=True),
        Column("given", lambda row: f"{row[1].given:.4g}"),
        Column("identified", lambda row: f"{row[1].value:.4g}" if row[1].known else "not told"),
        Column("95 % interval", lambda row: interval(row[1])),
    ]
    rounding = [
        Column("corner radius (mm)", lambda row: f"{1e3 * row.radius:.1f}"),
        Column("inertia (kg m^2)", lambda row: ", ".join(f"{one:.4g}" for one in row.inertia)),
        Column("center (mm)", lambda row: ", ".join(f"{1e3 * one:.2f}" for one in row.center)),
        Column("left of dw (rad/s)", lambda row: f"{row.left:.3f}"),
    ]
    rounded = [table_of(rounding, found.roundings)] if found.roundings else []
    return [table_of(body, named(found).items()), *rounded]


def sentences(found: Identification) -> list[str]:
    """What was identified from what, how consistent it is, and what cannot be told; one sentence each."""
    copies = f" ({found.repeated} more are the same, turned)" if found.repeated else ""
    motions = counted(found.motions, "motion") + copies
    folds = f"each impact with what was fitted to the other {FOLDS - 1} of {FOLDS} parts of the motions"
    given, held_out = (
        f"{percent(float(np.median(errors)))} % in the median, 90 % below {percent(float(np.quantile(errors, 0.9)))} %"
        for errors in (found.given, found.held_out)
    )
    identified = f"identified {held_out}, {folds}"
    medians = [f"{percent(median)} % with {counted(number, 'moment')}" for number, median in found.choices.items()]
    said = [
        f"{counted(found.impacts, 'impact')} of a single point while nothing else touches, in {motions}.",
        f"Inconsistency, |J dw - (r - d) x m dv| / (m |dv| {1e3 * found.lever:.1f} mm): given {given}; {identified}.",
        f"Held out, its median is {listed(medians, last='and')} fitted.",
        f"The mass cannot be told, only the inertia over it: {found.scene.mass:g} kg is the given one.",
    ]
    for name, one in named(found).items():
        if not one.known:
            said.append(
                f"{name} cannot be told ({interval(one)}): the impacts hardly turn that way; it stays as given."
            )
    if found.radius is not None:
        low, high = (1e3 * (end or 0.0) for end in (found.radius.low, found.radius.high))
        round_by = f"{low:.1f} to {high:.1f} mm" if found.radius.known else "an unknown radius"
        said.append(
            f"By the heights at which corners turn back they are round by {round_by}, or the body is smaller by that; "
            "the identified inertia is the one for sharp corners, as the predictor has them."
        )
    return said


def changes_of(found: Identification) -> dict[str, NewValues]:
    """What is changed in the parameter file of the scene."""
    changes = {}
    for parameter, parts in (("body.inertia", found.inertia), ("body.center_of_mass", found.center)):
        told = {name: one for name, one in named(found).items() if one in parts and one.value != one.given}
        if told:
            values = [one.value for one in parts]
            intervals = listed([f"{name} {interval(one)}" for name, one in told.items()], last="and")
            remark = f"identified from {counted(found.impacts, 'impact')}; {intervals} with 95 %"
            changes[parameter] = NewValues(
                six_of(found.scene, values) if "inertia" in parameter else tuple(values), remark, listed=True
            )
    return changes


def as_json(found: Identification, bags: Sequence[str]) -> dict[str, Any]:
    """An identification as JSON: SI units, inconsistencies as fractions of 1."""
    errors = {"given": found.given, "held_out": found.held_out}
    return {
        "bags": list(bags),
        "motions": found.motions,
        "repeated_motions": found.repeated,
        "impacts": found.impacts,
        "body": {name.replace(" ", "_"): _plain(one) for name, one in named(found).items()},
        "lever": found.lever,
        "inconsistency": {
            name: {"median": float(np.median(one)), "p90": float(np.quantile(one, 0.9))} for name, one in errors.items()
        },
        "held_out_by_moments": found.choices,
        "corner_radius": _plain(found.radius),
        "roundings": _plain(found.roundings),
        "parameters": {name: [float(number_text(one)) for one in to.values] for name, to in changes_of(found).items()},
    }


def _plain(value: Any) -> Any:
    """A record as JSON has it."""
    if hasattr(value, "_asdict"):
        names = {"known": "told"}
        return {names.get(name, name): _plain(one) for name, one in value._asdict().items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_plain(one) for one in value] if isinstance(value, tuple) else value
