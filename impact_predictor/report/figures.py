"""The pictures of replays and of calibrations: predicted against measured velocities, errors, and what was fitted."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from itertools import chain, cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.ticker import PercentFormatter

from ..files import named
from ..prediction.skill import SIMPLE
from ..wording import listed, percent
from .gait import FootLandings, feet_of, write_gait
from .modes import PALETTE
from .plot import GREY, PICTURE, Axes, Figure, headline, picture
from .skill import KindScore, LiftScore, kind_scores, lift_scores, pair_of
from .summary import LEAD_TIME_EDGES, SpanErrors, Tally, errors_ahead
from .touchdowns import TouchdownRow, rows_of

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..bags.watched import WatchLog
    from ..calibration.fit import Calibration

_BLUE, _VERMILION = PALETTE[:2]
MOST: Final = 3
"""Bags whose names stand in the title, and machines in one picture."""


class ReplayPicture:
    """Takes the replays of bags one by one: of machines that walk it shows their gait, of the first watch over a deck
    its motion and margins, else predicted velocities.

    Only what it shows is kept of each.
    """

    def __init__(self, path: str) -> None:
        """Draw into `path`, a .png or .svg file.

        Raises:
            InputError: it is no such file, or its folder does not exist.
        """
        self.path = named(path, *PICTURE)
        self._names: list[str] = []
        self._machines: list[list[FootLandings]] = []
        self._watch: WatchLog | None = None
        self._tally = Tally()
        self._scored: list[TouchdownRow] = []
        self._ahead: list[tuple[float, float]] = []  # lead time and error

    def add(self, result: Result) -> None:
        """Take a replay."""
        bag, rows = Path(result.bag).name, rows_of(result.settled)
        self._names.append(bag)
        self._tally.add(rows)
        self._watch = self._watch or result.watch
        for body, gait in list(result.gaits.items())[: MOST - len(self._machines)]:
            mine = [row for row in rows if row.body == (body or row.body)]
            self._machines.append(feet_of(f"{bag} {body}".rstrip(), gait, mine))
        self._scored += [row for row in rows if row.is_scored]
        scores = [settled.score for settled in result.settled if settled.score.scored]
        self._ahead += [made for one in scores for made in one.history if made[0] < LEAD_TIME_EDGES[-1]]

    def write(self) -> None:
        """Draw it.

        Raises:
            InputError: the file cannot be written.
        """
        names = listed(self._names, MOST)
        if self._machines:
            write_gait(self.path, list(chain.from_iterable(self._machines)), names)
            return
        if self._watch is not None:
            from .watch_figure import write_watch

            write_watch(self.path, self._watch, names)
            return
        write_touchdowns(
            self.path, self._scored, errors_ahead(self._ahead), f"{names}: {self._tally.sentences()[0].rstrip('.')}"
        )


def write_touchdowns(
    path: str | os.PathLike[str], rows: Sequence[TouchdownRow], errors: Sequence[SpanErrors], title: str
) -> None:
    """Draw the scored rows into a PNG or SVG file: velocities, and errors by kind and lifts, or against lead time.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scored = [row for row in rows if row.is_scored]
    kinds = kind_scores(scored, {})
    with picture(path, 16.0, 4.9) as figure:
        headline(figure, title)
        if not scored:
            figure.text(0.5, 0.5, "no touchdown was scored", ha="center", color=GREY)
            return
        left, middle, *others = figure.subplots(
            1, 4 if kinds else 3, width_ratios=(1.0, 1.0, 1.3, 1.0)[: 3 + bool(kinds)]
        )
        _draw_pairs(
            left, scored, "Velocity after the touchdown", "m/s", {"v along": "along the support", "v up": "upwards"}
        )
        _draw_pairs(
            middle, scored, "Turning after the touchdown", "rad/s", {"w across": "about the level axis across v"}
        )
        if kinds:
            _draw_kinds(others[0], kinds)
            _draw_lifts(others[1], lift_scores(scored))
        else:
            _draw_lead_times(others[0], errors)


def _draw_pairs(axes: Axes, rows: Sequence[TouchdownRow], title: str, unit: str, parts: Mapping[str, str]) -> None:
    """Predicted over measured components of twists."""
    for (part, said), color in zip(parts.items(), (_BLUE, _VERMILION), strict=False):
        if pairs := [pair for row in rows if (pair := pair_of(row, part)) is not None]:
            axes.plot(
                *zip(*pairs, strict=True), "o", color=color, label=said, alpha=0.5, markersize=4, markeredgewidth=0
            )
    axes.axline((0.0, 0.0), slope=1.0, color="black", linewidth=1.0, zorder=1, label="exact")
    axes.set_title(title)
    axes.set(xlabel=f"measured ({unit})", ylabel=f"predicted ({unit})")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left")


def _draw_kinds(axes: Axes, kinds: Sequence[KindScore]) -> None:
    """The errors of whole twists by kind, beside those of simple answers."""
    shown = [one for one in kinds if one.errors.number]
    places = range(len(shown))
    for k, (said, marker) in enumerate(zip(SIMPLE.values(), "x+^sD", strict=True)):
        medians = [
            (100.0 * half, place)
            for place, one in enumerate(shown)
            if one.simple and (half := one.simple[k].p50) is not None
        ]
        if medians:
            axes.plot(*zip(*medians, strict=True), marker, color=GREY, markersize=5, fillstyle="none", label=said)
    middles, ends = ([100.0 * (getattr(one.errors, part) or 0.0) for one in shown] for part in ("p50", "p90"))
    axes.hlines(places, middles, ends, color=_VERMILION, linewidth=2.0)
    axes.plot(ends, places, "|", color=_VERMILION, markersize=10, markeredgewidth=2.0, label="prediction: 90 % below")
    axes.plot(middles, places, "o", color=_VERMILION, label="prediction: median")
    axes.set_yticks(places, [f"{one.kind}\n({one.errors.number:,})" for one in shown])
    axes.set_title("Error of the whole twist, by kind")
    beside = "; of simple answers the median" if any(of.number for one in shown for of in one.simple) else ""
    axes.set(xlabel=f"relative error (%){beside}", xlim=(0.0, None))
    # Room for the legend below the last kind.
    axes.set_ylim(len(shown) + 1.3, -0.5)
    axes.legend(loc="lower center", ncols=2, fontsize=8)


def _draw_lifts(axes: Axes, lifts: Sequence[LiftScore]) -> None:
    """How often contacts lifted, over the probability of it that was told."""
    for one, color in zip(lifts, (_BLUE, _VERMILION), strict=False):
        told = one.reliability
        if not told:
            counts = [(one.counts[True, lifts], one.counts[False, lifts]) for lifts in (False, True)]
            told = tuple((sum(n), k, n[0] / sum(n)) for k, n in enumerate(counts) if sum(n))
        numbers, chances, shares = zip(*told, strict=True)
        axes.plot(
            [100.0 * part for part in chances],
            [100.0 * part for part in shares],
            "o-",
            color=color,
            label=f"{one.name} contact",
        )
        for number, chance, share in told:
            axes.annotate(
                f"{number:,}", (100.0 * chance, 100.0 * share), (4, -11), textcoords="offset points", fontsize=8
            )
    axes.axline((0.0, 0.0), slope=1.0, color="black", linewidth=1.0, zorder=1, label="exact")
    axes.set_title("Does the contact lift?")
    axes.set(xlabel="told probability (%), and number", ylabel="share that lifted (%)", xlim=(0, 104), ylim=(0, 104))
    axes.legend(loc="upper left")


def _draw_lead_times(axes: Axes, errors: Sequence[SpanErrors]) -> None:
    known = [one for one in errors if one.errors.number]
    middles = [500.0 * (one.begin + one.end) for one in known]
    for part, style, label in (("p90", "s--", "90 % below"), ("p50", "o-", "median")):
        values = [100.0 * getattr(one.errors, part) for one in known]
        axes.plot(middles, values, style, color=_VERMILION, label=label)
    axes.set_title("Relative error against lead time")
    axes.set_xticks(middles, [f"{500.0 * (one.begin + one.end):.0f}\n({one.errors.number})" for one in known])
    axes.set(xlabel="lead time (ms), and number of predictions", ylabel="relative error (%)")
    axes.set(xlim=(1e3 * errors[-1].end, 1e3 * errors[0].begin))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="lower left", ncols=2)


def write_calibration(path: str | os.PathLike[str], calibration: Calibration, name: str) -> None:
    """Draw a calibration to the bags of a name into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    with picture(path, 10.5, 5.0) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 0.85))
        given, held_out = (float(np.median(one)) for one in (calibration.given, calibration.held_out))
        headline(
            figure,
            f"{name}: {len(calibration.touchdowns)} touchdowns. Error in the median: {percent(given)} % with the given "
            f"values, {percent(held_out)} % with values\nfitted to other touchdowns",
        )
        _draw_map(figure, left, calibration)
        _draw_parts(right, calibration)


def _draw_map(figure: Figure, axes: Axes, calibration: Calibration) -> None:
    from ..calibration.search import interval  # which needs scipy, as no other picture here does

    frictions, restitutions, losses = calibration.map
    friction, restitution = (calibration.estimates[name] for name in ("friction", "restitution"))
    wide, high = float(frictions[-1]), float(restitutions[-1])
    levels = np.linspace(float(losses.min()), float(np.quantile(losses, 0.5)) + 1e-9, 14)
    looks: Any = {"levels": levels, "cmap": "cividis_r", "extend": "max", "zorder": 0}
    drawn = axes.contourf(frictions, restitutions, losses.T, **looks)
    bar = figure.colorbar(drawn, ax=axes, format=PercentFormatter(1.0, decimals=1), pad=0.02)
    bar.set_label("mean relative error (darker is worse)")
    across, upwards = (
        [[max(one.value - (one.low or 0.0), 0.0)], [max((end if one.high is None else one.high) - one.value, 0.0)]]
        for one, end in ((friction, wide), (restitution, high))
    )
    label = f"fitted, with 95 % interval:\nfriction {interval(friction)}\nrestitution {interval(restitution)}"
    axes.errorbar(friction.value, restitution.value, upwards, across, "o", color=_VERMILION, capsize=4, label=label)
    label = f"given: {friction.given:.3g} and {restitution.given:.3g}"
    axes.plot(friction.given, restitution.given, "ws", markeredgecolor="black", clip_on=False, zorder=4, label=label)
    axes.set_title("Mean error over friction and restitution")
    axes.set(xlabel="friction", ylabel="restitution", xlim=(0.0, wide), ylim=(0.0, high))
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    axes.grid(visible=False)


def _draw_parts(axes: Axes, calibration: Calibration) -> None:
    """What part of the touchdowns has a smaller error, with the given and the fitted values and by simple answers."""
    parts = np.arange(1, len(calibration.given) + 1) / len(calibration.given)
    axes.plot(np.sort(calibration.held_out), parts, color=_VERMILION, linewidth=2.0, label="fitted, held out")
    axes.plot(np.sort(calibration.given), parts, color="black", label="given values")
    for (said, errors), color in zip(calibration.simple.items(), cycle((_BLUE, *PALETTE[2:])), strict=False):
        axes.plot(np.sort(errors), parts, color=color, linestyle="--", label=said)
    axes.set_title("Part of the touchdowns with less error")
    axes.set(xlabel="relative error", xlim=(0.0, 2.0 * float(np.quantile(calibration.given, 0.9))), ylim=(0.0, 1.0))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    axes.legend(loc="lower right", frameon=True)
