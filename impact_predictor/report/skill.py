"""How right whole twists are: by kind of touchdown beside simple answers, by component, and whether contacts lift."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from math import hypot
from operator import attrgetter
from typing import Any, Final, NamedTuple

import numpy as np

from ..prediction.recorded import Announced
from ..prediction.skill import SIMPLE, SLOWS
from ..prediction.types import KINDS
from ..wording import NONE, fixed, percent
from .summary import Distribution, spread_of
from .table import Column
from .touchdowns import TouchdownRow

ALL: Final = "all"
COMPONENTS: Final = {
    "v along": "m/s",
    "v across": "m/s",
    "v up": "m/s",
    "w along": "rad/s",
    "w across": "rad/s",
    "w up": "rad/s",
}
"""Components of a whole twist and their units: along the velocity before the touchdown in the plane x y, across it to
the left, and along z.
"""


FROM_BEFORE: Final = {"nothing": (1.0,) * 6, "stops": (0.0,) * 6, "slows": (SLOWS, *(0.0,) * 5)}
"""Of simple answers what is left of each of `COMPONENTS` of the twist before."""


class KindScore(NamedTuple):
    """The touchdowns of a kind: how many the record shows, how many of these were announced by the last sample before
    them, and of those that are scored the `errors`, those of `SIMPLE` answers, and of the time in s.
    """

    kind: str
    touchdowns: int
    announced: int
    errors: Distribution
    simple: tuple[Distribution, ...]
    times: Distribution


class ComponentScore(NamedTuple):
    """A component of the twists after touchdowns: the mean of predicted less measured ones, the slope of the straight
    line of measured over predicted ones, and the part of the variance of measured ones that is predicted, beside that
    of the answers of `SIMPLE` in `FROM_BEFORE`.
    """

    name: str
    bias: float
    slope: float
    r2: float
    simple_r2: tuple[float, ...]


class LiftScore(NamedTuple):
    """Whether a group of contacts lifts: `counts` by (measured, told), and where probabilities are told the mean square
    of their errors (Brier), beside that of the base rate. `reliability` has for each fifth of the probabilities that
    were told how many there are, their mean, and the share of those that lifted.
    """

    name: str
    counts: Mapping[tuple[bool, bool], int]
    brier: float | None
    base: float | None
    reliability: tuple[tuple[int, float, float], ...]

    @property
    def balanced(self) -> float | None:
        """The mean of the shares of right answers among those that lifted and those that did not."""
        shares = []
        for measured in (True, False):
            number = self.counts[measured, True] + self.counts[measured, False]
            shares += [self.counts[measured, measured] / number] if number else []
        return sum(shares) / 2 if len(shares) == 2 else None


def _median(k: int, score: KindScore) -> str:
    return percent(score.simple[k].p50 if score.simple else None)


def _simple_r2(k: int, score: ComponentScore) -> str:
    return fixed(score.simple_r2[k], 2)


def _brier(score: float | None, lifted: bool) -> str:
    return fixed(score, 3) if lifted and score is not None else ""


KIND_COLUMNS: Final = (
    Column("kind", attrgetter("kind"), left=True),
    Column("touch-\ndowns", lambda one: f"{one.touchdowns:,}" if one.touchdowns else NONE, optional=True),
    Column(
        "an-\nnounced\n%",
        lambda one: percent(one.announced / one.touchdowns if one.touchdowns else None),
        optional=True,
    ),
    Column("scored", lambda one: f"{one.errors.number:,}"),
    Column("error %:\nmedian", lambda one: percent(one.errors.p50)),
    Column("\n90 %", lambda one: percent(one.errors.p90)),
    *[Column(said.replace(" ", "\n"), partial(_median, k), optional=True) for k, said in enumerate(SIMPLE.values())],
    Column("error of\nthe time\nms", lambda one: fixed(one.times.p50 and 1e3 * one.times.p50, 1)),
)
"""Medians of simple answers stand beside those of the predictions."""
COMPONENT_COLUMNS: Final = (
    Column("component", attrgetter("name"), left=True),
    Column("unit", lambda one: COMPONENTS[one.name], left=True),
    Column("bias", lambda one: fixed(one.bias, 3, "+")),
    Column("slope", lambda one: fixed(one.slope, 2)),
    Column("R2", lambda one: fixed(one.r2, 2)),
    *[Column(SIMPLE[name].replace(" ", "\n"), partial(_simple_r2, k)) for k, name in enumerate(FROM_BEFORE)],
)
"""The part of the variance that simple answers predict stands beside that of the predictions."""
LIFT_COLUMNS: Final = (
    Column("contact", lambda one: f"{one[0].name} {'lifted' if one[1] else 'stayed'}", left=True),
    Column("told\nto lift", lambda one: f"{one[0].counts[one[1], True]:,}"),
    Column("told\nto stay", lambda one: f"{one[0].counts[one[1], False]:,}"),
    Column("right %,\nbalanced", lambda one: percent(one[0].balanced) if one[1] else ""),
    Column("Brier\nscore", lambda one: _brier(one[0].brier, one[1]), optional=True),
    Column("of the\nbase rate", lambda one: _brier(one[0].base, one[1]), optional=True),
)
"""Two rows for a group of contacts: those that lifted, and those that stayed."""

KINDS_SAID: Final = (
    "The whole twist after the touchdowns that the record shows, by their kind: its relative error, and in the median "
    "that of simple answers to the same touchdowns: nothing happens; all stops; 0.85 of the velocity along the support "
    "and no turning; plastic without slip; the law in the impact plane."
)
COMPONENTS_SAID: Final = (
    "Its components: the mean of predicted less measured ones, the slope of measured over predicted ones, and the part "
    "of the variance that is predicted (R2), beside that of simple answers; below 0 it is worse than the mean of all."
)
LIFTS_SAID: Final = (
    "Do the contacts lift? They have if their mean gap grows by a tenth of the contact tolerance, and by more than the "
    "steps in which the predicted motion is computed."
)


def skill_tables(
    rows: Sequence[TouchdownRow], recorded: Mapping[str, Announced]
) -> list[tuple[str, Sequence[Column], list[Any]]]:
    """A sentence, columns and rows of each table about the skill of predictions; none where nothing is scored."""
    kinds = kind_scores(rows, recorded)
    if not any(one.errors.number for one in kinds):
        return []
    lifts = [(one, lifted) for one in lift_scores(rows) for lifted in (True, False)]
    tables = (KINDS_SAID, KIND_COLUMNS, kinds), (COMPONENTS_SAID, COMPONENT_COLUMNS, component_scores(rows))
    lift_columns = [one for one in LIFT_COLUMNS if not one.optional or any(one.cell(lift) for lift in lifts[:1])]
    return [table for table in (*tables, (LIFTS_SAID, lift_columns, lifts)) if table[2]]


def kind_scores(rows: Iterable[TouchdownRow], recorded: Mapping[str, Announced]) -> list[KindScore]:
    """Of each kind that there is, and of all; `recorded` counts the touchdowns that records show, by kind."""
    scored = [row for row in rows if row.error_6d is not None]
    found = []
    for kind in (*KINDS, ALL):
        of_kind = [row for row in scored if kind in (row.kind, ALL)]
        counts = [count for name, count in recorded.items() if kind in (name, ALL)]
        simple = [row.simple_errors_6d for row in of_kind if row.simple_errors_6d is not None]
        if of_kind or counts:
            one = KindScore(
                kind=kind,
                touchdowns=sum(count.touchdowns for count in counts),
                announced=sum(count.announced for count in counts),
                errors=spread_of([row.error_6d for row in of_kind if row.error_6d is not None]),
                simple=tuple(spread_of([errors[k] for errors in simple]) for k in range(len(SIMPLE))),
                times=spread_of([abs(row.time_error) for row in of_kind if row.time_error is not None]),
            )
            found.append(one)
    return found


def component_scores(rows: Iterable[TouchdownRow]) -> list[ComponentScore]:
    """Of each of `COMPONENTS`, over the scored touchdowns; none of fewer than three."""
    known = [
        [_turned(twist, before) for twist in (row.predicted_twist_6d, row.measured_twist_6d, before)]
        for row in rows
        if (before := row.before_twist_6d) and row.predicted_twist_6d and row.measured_twist_6d
        if row.error_6d is not None
    ]
    found = []
    parts = np.transpose(known) if len(known) > 2 else ()
    for place, (name, (told, seen, before)) in enumerate(zip(COMPONENTS, parts, strict=False)):
        spread, variance = told.var(), seen.var()
        if spread and variance:
            slope = float(np.mean((told - told.mean()) * (seen - seen.mean())) / spread)
            answers = told, *[left[place] * before for left in FROM_BEFORE.values()]
            r2, *simple = [float(1.0 - np.mean((answer - seen) ** 2) / variance) for answer in answers]
            found.append(ComponentScore(name, float(np.mean(told - seen)), slope, r2, tuple(simple)))
    return found


def _turned(twist: Sequence[float], before: Sequence[float]) -> tuple[float, ...]:
    x, y = before[:2]
    length = hypot(x, y)
    c, s = (x / length, y / length) if length else (1.0, 0.0)
    vx, vy, vz, wx, wy, wz = twist
    return c * vx + s * vy, c * vy - s * vx, vz, c * wx + s * wy, c * wy - s * wx, wz


def pair_of(row: TouchdownRow, component: str) -> tuple[float, float] | None:
    """What was measured and predicted of a component, in the impact plane where there is no whole twist; None where
    that has no such component that a record shows.
    """
    whole, before = (row.measured_twist_6d, row.predicted_twist_6d), row.before_twist_6d
    if row.error_6d is not None and whole[0] and whole[1] and before:
        measured, predicted = (_turned(twist, before)[list(COMPONENTS).index(component)] for twist in whole if twist)
        return measured, predicted
    name = {"v along": "vx", "w across": "omega"}.get(component)
    if name is None or row.measured_twist is None:
        return None
    return getattr(row.measured_twist, name), getattr(row.predicted_twist, name)


def lift_scores(rows: Iterable[TouchdownRow]) -> list[LiftScore]:
    """Of old and of new contacts, over the scored touchdowns; those that there are."""
    scored, found = [row for row in rows if row.error_6d is not None], []
    for name in ("old", "new"):
        lifts = [lift for row in scored if (lift := getattr(row, f"lift_{name}")) is not None]
        if not lifts:
            continue
        sure = np.array([(chance, measured) for _, measured, chance in lifts if chance is not None]).reshape(-1, 2)
        chances, measured = sure.T
        fifths = np.minimum(5.0 * chances, 4.0).astype(int)
        groups = [sure[fifths == fifth] for fifth in range(5) if fifth in fifths]
        found.append(
            LiftScore(
                name=name,
                counts=Counter((measured, told) for told, measured, _ in lifts),
                brier=float(np.mean((measured - chances) ** 2)) if len(sure) else None,
                base=float(measured.var()) if len(sure) else None,
                reliability=tuple((len(group), *group.mean(axis=0).tolist()) for group in groups),
            )
        )
    return found


def unscored(rows: Iterable[TouchdownRow]) -> dict[str, int]:
    """How many touchdowns are not scored for each reason, the commonest first; a touchdown may have several."""
    return dict(Counter(flag for row in rows if not row.foot for flag in row.not_scored_6d).most_common())


def skill_as_json(rows: Sequence[TouchdownRow], recorded: Mapping[str, Announced]) -> dict[str, Any]:
    """All of this for the JSON of a replay; nothing where no touchdown was seen."""
    kinds = kind_scores(rows, recorded)
    if not kinds:
        return {}
    names, fields = ("prediction", *SIMPLE), ComponentScore._fields[1:-1]
    return {
        "skill": {name: _short(one) for name, one in zip(names, (kinds[-1].errors, *kinds[-1].simple), strict=True)},
        "kinds": {
            one.kind: {"touchdowns": one.touchdowns, "announced": one.announced}
            | {name: _short(of) for name, of in zip(names, (one.errors, *one.simple), strict=True)}
            | {"time_error": _short(one.times)}
            for one in kinds
        },
        "components": {
            one.name: {key: getattr(one, key) for key in fields}
            | {"simple_r2": dict(zip(FROM_BEFORE, one.simple_r2, strict=True))}
            for one in component_scores(rows)
        },
        "lifts": {
            one.name: {
                "lifted": {"told": one.counts[True, True], "not_told": one.counts[True, False]},
                "stayed": {"told": one.counts[False, True], "not_told": one.counts[False, False]},
                "balanced": one.balanced,
                "brier": one.brier,
                "brier_of_base_rate": one.base,
                "reliability": one.reliability,
            }
            for one in lift_scores(rows)
        },
        "not_scored_6d": unscored(rows),
    }


def _short(spread: Distribution) -> dict[str, Any]:
    return {"count": spread.number, "median": spread.p50, "p90": spread.p90}
