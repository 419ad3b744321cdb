"""What a page says of whole twists: errors by kind beside those of simple answers, and whether contacts lift."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from ...prediction.skill import SIMPLE
from ...wording import counted
from ..modes import PALETTE
from ..skill import KindScore, LiftScore, kind_scores, lift_scores, skill_tables
from . import GREY, Chart, Section, marks, page_table, part_words, safe
from .facts import ReplayFacts

ENOUGH: Final = 10
"""Contacts of which it is drawn whether they lift; of fewer the shares tell nothing."""
SYMBOLS: Final = ("x-thin", "cross-thin", "triangle-up", "square", "diamond")
"""Of the simple answers, in the order of `SIMPLE`."""


def skill(facts: ReplayFacts) -> Section:
    """How right the whole twists are, beside simple answers."""
    touchdowns = [row for row in facts.rows if not row.foot]
    tables = [page_table(columns, rows, said) for said, columns, rows in skill_tables(touchdowns, facts.recorded)]
    return Section("skill", "How right the whole twists are", [], [*tables, *skill_charts(facts)])


def skill_charts(facts: ReplayFacts) -> list[Chart]:
    """Errors by kind, and told probabilities of lifts against what happened; none where nothing or too little is
    scored.
    """
    kinds = [one for one in kind_scores(facts.scored, {}) if one.errors.number]
    lifts = [one for one in lift_scores(facts.scored) if sum(one.counts.values()) >= ENOUGH]
    return [*([kinds_chart(kinds)] if kinds else []), *([lifts_chart(lifts)] if lifts else [])]


def kinds_chart(kinds: Sequence[KindScore]) -> Chart:
    """The errors by kind in %: from the median to what 90 % are below, and the medians of simple answers."""
    traces = []
    for k, (said, symbol) in enumerate(zip(SIMPLE.values(), SYMBOLS, strict=True)):
        medians = [(place, one.kind, one.simple[k].p50) for place, one in enumerate(kinds) if one.simple]
        points = [
            (100.0 * half, -place, f"{kind}: {said} {part_words(half)}")
            for place, kind, half in medians
            if half is not None
        ]
        look = {"color": GREY, "symbol": f"{symbol}-open", "size": 9}
        traces += [marks(said, points, marker=look)] if points else []
    middles, ends = ([100.0 * (getattr(one.errors, part) or 0.0) for one in kinds] for part in ("p50", "p90"))
    points = [
        (middle, -place, f"{one.kind}: median {part_words(one.errors.p50)}, 90 % below {part_words(one.errors.p90)}")
        for place, (middle, one) in enumerate(zip(middles, kinds, strict=True))
    ]
    upwards = [end - middle for middle, end in zip(middles, ends, strict=True)]
    reach = {"type": "data", "symmetric": False, "array": upwards, "arrayminus": [0.0] * len(kinds)}
    look = {"marker": {"color": PALETTE[1], "size": 10}, "error_x": {**reach, "color": PALETTE[1], "thickness": 2.0}}
    traces.append(marks("prediction: median to 90 %", points, **look))
    names = [safe(f"{one.kind}\n({one.errors.number:,})") for one in kinds]
    places = {"tickvals": [-place for place in range(len(kinds))], "ticktext": names, "automargin": True}
    beside = "; of simple answers the median" if len(traces) > 1 else ""
    across = {"title": f"relative error, %{beside}", "rangemode": "tozero"}
    layout = {"height": 460, "showlegend": True, "xaxis": across, "yaxis": places}
    return Chart("Error of the whole twist, by kind", traces, layout, wide=False)


def lifts_chart(lifts: Sequence[LiftScore]) -> Chart:
    """How often contacts lifted, in %, over the probability of it that was told; each point says of how many."""
    traces: list[dict[str, Any]] = [
        {"type": "scatter", "mode": "lines", "x": [0, 100], "y": [0, 100], "line": {"color": GREY}, "name": "exact"}
    ]
    for one, colour in zip(lifts, PALETTE, strict=False):
        told = one.reliability or sure_answers(one)
        points = [
            (
                100.0 * chance,
                100.0 * share,
                f"{one.name}: told {chance:.0%}, {share:.0%} of {counted(number, 'contact')}",
            )
            for number, chance, share in told
        ]
        look = {"marker": {"color": colour, "size": 9}, "line": {"color": colour}, "textposition": "bottom right"}
        numbers = [f"{number:,}" for number, _, _ in told]
        traces.append(marks(f"{one.name} contact", points, mode="lines+markers+text", text=numbers, **look))
    ends = {"range": [-2.0, 104.0]}
    across = {"title": "told probability, %, and number of contacts", **ends}
    layout = {"height": 460, "showlegend": True, "xaxis": across, "yaxis": {"title": "share that lifted, %", **ends}}
    return Chart("Does the contact lift?", traces, layout, wide=False)


def sure_answers(one: LiftScore) -> list[tuple[int, float, float]]:
    """As its `reliability`, where no probabilities are told but yes or no."""
    counts = [(one.counts[True, lifts], one.counts[False, lifts]) for lifts in (False, True)]
    return [(sum(n), float(k), n[0] / sum(n)) for k, n in enumerate(counts) if sum(n)]
