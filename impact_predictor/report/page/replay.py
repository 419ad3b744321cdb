"""The page of a replay, made from the JSON answers of its bags alone: each section is a function of what they say."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from ...files import make_folder, write_text
from ...prediction.checks import REMEDIES
from ...prediction.types import Status
from ...stamps import NANOSECONDS
from ...wording import counted, words
from ..modes import MODES, PALETTE
from ..skill import pair_of
from ..summary import WHY, without_bag
from . import GREY, Cell, Chart, Headline, PageTable, Section, marks, page, part_words, script_inside
from .facts import FOUND, NOTHING, BagAnswer, ReplayFacts
from .landings import landings
from .skill import skill
from .timeline import FALSE, MANY, MISSED, ORDER, look_of, timeline
from .watch import watched

EXPLAINED: Final = (FOUND, "events warned of")
"""Of what a bag's row tells, that of which it tells more."""
NOT_ASKED: Final = Headline("", "–", "")

DRAWN: Final = 8
"""Bags of which a timeline is drawn; of more the worst."""

READING: Final = (
    "A mark is a touchdown where it was predicted last; the line before it leads back to when it was first announced. "
    "Below it stand the true touchdowns, where the record tells them, or the stances of a foot. A red star is a "
    "touchdown that was missed, a red cross a false alarm. What such a record cannot show or compare is faint. Drag "
    "over a part of the time to magnify it, with shift to move on, and double-click to see all of it again; point at a "
    "mark for more."
)
AGAINST: Final = (
    "Each point is a touchdown: to the right what the record shows after it, upwards what was predicted for the same "
    "time. On the line both are the same. Of a body on points it is the whole twist between the second and the third "
    "frame after it, along the velocity before, along z, and about the horizontal axis across that velocity; of others "
    "the twist in the impact plane, as the samples 2 to 4 after it show it."
)
COMPARED: Final = (
    ("Along the support", "m/s", "v along"),
    ("Upwards", "m/s", "v up"),
    ("Turning", "rad/s", "w across"),
)
"""Titles, units and components of the charts."""
REMARKS: Final = {
    "error": "could not be read",
    "unpredictable": "nothing predicted",
    "damaged": "damaged",
    "notes": "note",
}
"""What is said of a bag, by its key in the answers; the gravest first."""


def write_replay_page(path: str | os.PathLike[str], answers: Sequence[BagAnswer]) -> None:
    """Write one page that needs no network and no other file, or a folder with a page for each bag, too.

    Args:
        path: to write, HTML. Without a suffix it is a folder: index.html about all bags, a page for each, and one file
            of plotly's script that they share.
        answers: of each bag, what `as_json` says of its replay; of one that could not be read its `bag` and `error`.

    Raises:
        InputError: a file cannot be written.
    """
    from plotly.offline import get_plotlyjs

    path = Path(path)
    if path.suffix:
        write_text(path, page_of_replay(answers, script_inside()))
        return
    make_folder(path)
    write_text(path / "plotly.min.js", get_plotlyjs())
    script = '<script src="plotly.min.js"></script>'
    # The name of a bag is no name of a file: it comes from elsewhere.
    links = {place: f"bag-{place + 1}.html" for place, answer in enumerate(answers) if "error" not in answer}
    for place, name in links.items():
        write_text(path / name, page_of_replay([answers[place]], script))
    write_text(path / "index.html", page_of_replay(answers, script, links))


def page_of_replay(answers: Sequence[BagAnswer], script: str = "", links: Mapping[int, str] | None = None) -> str:
    """The page as HTML; `script` is plotly's, `links` where the bags lead, by their places."""
    facts, each = ReplayFacts(answers), [ReplayFacts([answer]) for answer in answers]
    order = sorted(range(len(answers)), key=lambda place: each[place].badness(), reverse=True)
    drawn = [place for place in order if each[place].rows or each[place].true][:DRAWN]
    charts = [
        chart
        for place in drawn
        for chart in (
            timeline(facts.names[place], answers[place], f"bag-{place + 1}"),
            *landings(facts.names[place], answers[place]),
        )
    ]
    parts = (
        bags(facts, each, order, links or {place: f"#bag-{place + 1}" for place in drawn}),
        watched([facts.names[place] for place in order], [answers[place] for place in order], DRAWN),
        Section("when", "When the touchdowns came", [READING], charts),
        skill(facts),
        velocities(facts, each),
        modes(facts),
        lead_times(facts),
        unused(facts),
    )
    known = told(facts)
    what = facts.names[0] if len(answers) == 1 else f"{len(answers):,} records"
    samples = counted(sum(answer.get("samples", 0) for answer in answers), "sample")
    lead = f"{what}, {samples}, went through the predictor as if live."
    title = ", ".join(f"{one.question} {one.answer}" for one in known if "cost" not in one.question)
    title = title or "No touchdown was predicted"
    return page(title, lead, known, [one for one in parts if one.parts or one.anchor == "unused"], script)


def told(facts: ReplayFacts) -> list[Headline]:
    """What is known of touchdowns, or of units under watch."""
    return [one for one in facts.headlines() if one.answer != "–"] if facts.rows or facts.true or facts.units else []


def bags(facts: ReplayFacts, each: Sequence[ReplayFacts], order: Sequence[int], links: Mapping[int, str]) -> Section:
    """A row for each of several bags, the worst first."""
    head, rows = ["bag", *(one.question for one in facts.headlines())], list[list[Cell | str]]()
    for place in order:
        answer = facts.answers[place]
        remark = next((kind for key, kind in REMARKS.items() if key != "notes" and answer.get(key)), "")
        told = {one.question: one for one in each[place].headlines()}
        # A bag without a watch beside others with one tells nothing of events.
        asked = [(question, told.get(question, NOT_ASKED)) for question in head[1:]]
        cells = [Cell(one.answer, one.more if question in EXPLAINED else "") for question, one in asked]
        name = Cell(facts.names[place], remark, to=links.get(place, ""))
        rows.append([name, *(cells if "error" not in answer else [])])
    said = (
        "First those that could not be used, then by what was missed or announced in vain, then by the error. The "
        f"timelines of the first {DRAWN} with touchdowns are drawn."
    )
    return Section("bags", "The bags", [said], [PageTable(head, rows)] if len(each) > 1 else [])


def velocities(facts: ReplayFacts, each: Sequence[ReplayFacts]) -> Section:
    """Predicted against measured velocities (m/s) right after the touchdowns."""
    kind, charts = "scattergl" if len(facts.scored) > MANY else "scatter", []
    for title, unit, part in COMPARED:
        points: dict[str, list[tuple[float, float, str]]] = {}
        for name, of in zip(facts.names, each, strict=True):
            for row in of.scored:
                if (pair := pair_of(row, part)) is None:
                    continue
                said = f"{name}, {(row.stamp - of.answers[0]['begin']) / NANOSECONDS:.3f} s, {row.body}"
                said += f"\nrelative error {part_words(row.best_error)}"
                points.setdefault(row.mode.name, []).append((*pair, said))
        if points:
            values = [value for of_mode in points.values() for point in of_mode for value in point[:2]]
            ends = [min(values), max(values) + 1e-9]
            line = {"type": "scatter", "mode": "lines", "x": ends, "y": ends, "line": {"color": GREY}}
            traces: list[dict[str, Any]] = [line | {"hoverinfo": "skip", "showlegend": False}]
            hover = f"measured %{{x:.3f}}, predicted %{{y:.3f}} {unit}<br>%{{hovertext}}<extra></extra>"
            for mode in sorted(points, key=ORDER.index):
                look = {"type": kind, "marker": look_of(mode) | {"size": 8}, "opacity": 0.75, "hovertemplate": hover}
                traces.append(marks(f"{mode} ({len(points[mode]):,})", points[mode], **look))
            layout = {"height": 460, "xaxis": {"title": f"measured, {unit}"}}
            layout["yaxis"] = {"title": f"predicted, {unit}", "scaleanchor": "x"}
            charts.append(Chart(title, traces, layout, wide=False))
    return Section("velocities", "Predicted against measured velocities", [AGAINST], charts)


def modes(facts: ReplayFacts) -> Section:
    """The modes that were predicted against the true ones, where the record tells them."""
    looks = {mode.name: Cell(mode.name, look.meaning) for mode, look in MODES.items()}
    tables = []
    if counts := facts.confusion():
        true, predicted = ([one for one in (*looks, NOTHING) if one in kinds] for kinds in zip(*counts, strict=True))
        looks[NOTHING] = Cell(FALSE)
        rows: list[list[Cell | str]] = []
        for row in true:
            cells = [Cell(f"{counts[row, one]:,}", css="best" if row == one else "") for one in predicted]
            rows.append([looks[row], *cells])
        caption = "How many touchdowns of each true mode (a row) were predicted in which mode (a column)."
        tables = [PageTable(["true mode", *(MISSED if one == NOTHING else one for one in predicted)], rows, caption)]
    return Section("modes", "Predicted against true modes", [], tables)


def lead_times(facts: ReplayFacts) -> Section:
    """Errors over the time ahead at which a prediction is made."""
    charts = []
    for key, title, axis, factor in (
        ("relative_errors_ahead", "Velocities in the impact plane, against measured ones", "relative error, %", 100.0),
        ("time_errors_ahead", "Time of the touchdown", "error of the time, ms", 1e3),
    ):
        spans, traces = facts.errors_ahead(key), []
        for name, part, colour in (("median", "p50", PALETTE[0]), ("90 % below", "p90", PALETTE[1])):
            points = []
            for one in spans:
                made = f"{1e3 * one.begin:.0f} to {1e3 * one.end:.0f} ms ahead"
                error, number = factor * getattr(one.errors, part), counted(one.errors.number, "prediction")
                points.append((500.0 * (one.begin + one.end), error, f"{number}, {made}\n{name} {error:.3g} ({axis})"))
            if points:
                look = {"marker": {"color": colour, "size": 8}, "line": {"color": colour}}
                traces.append(marks(name, points, mode="lines+markers", **look))
        if traces:
            across = {"title": "made before the touchdown, ms", "range": [0.0, 1e3 * spans[-1].end]}
            layout = {"height": 320, "xaxis": across, "yaxis": {"title": axis, "rangemode": "tozero"}}
            charts.append(Chart(title, traces, layout, wide=False))
    said = "Every sample before a touchdown makes a prediction of it. Does one that is made earlier do as well?"
    return Section("ahead", "Error against the time ahead", [said], charts)


def unused(facts: ReplayFacts) -> Section:
    """What could not be used: refused messages, touchdowns that are not compared, damage, failures and notes."""
    inputs: dict[str, Counter[str]] = {}
    for answer in facts.answers:
        known = {"odom": answer.get("statuses", {}), "contact_geometry": answer.get("geometry_statuses", {})}
        for name, counts in (answer.get("inputs") or known).items():
            inputs.setdefault(name, Counter()).update(counts)
    refused: list[list[Cell | str]] = []
    for name, all_of in inputs.items():
        every = sum(all_of.values())
        for status, number in all_of.most_common():
            if status != Status.ACCEPTED.name:
                remedy = REMEDIES[Status[status]] if status in Status.__members__ else ""
                of = Cell(f"{number:,}", f"of {every:,}, {part_words(number / every)}")
                refused.append([Cell(name, words(status)), remedy, of])
    reasons = [[WHY[flag], f"{number:,}"] for flag, number in facts.uncompared.most_common()]
    said: dict[tuple[str, str], list[str]] = {}
    for key, kind in REMARKS.items():
        for name, answer in zip(facts.names, facts.answers, strict=True):
            of_bag = answer.get(key) or []
            for one in [of_bag] if isinstance(of_bag, str) else of_bag:
                said.setdefault((kind, without_bag(one, answer["bag"])), []).append(name)
    remarks: list[list[Cell | str]] = []
    for (kind, one), bags in said.items():
        more = f" and {counted(len(bags) - 1, 'more bag')}" if len(bags) > 1 else ""
        remarks.append([Cell(bags[0] + more, kind), one])
    caption = "Messages that were refused, by input and reason."
    tables = (
        PageTable(["input", "what is wrong", "messages"], refused, caption, words=2),
        PageTable(["touchdowns that are not compared, for one or several reasons", "touchdowns"], reasons),
        PageTable(["bag", "remark"], remarks, "What was said of the bags.", words=2),
    )
    there = [table for table in tables if table.rows]
    return Section("unused", "What could not be used", [] if there else ["Everything could be used."], there)
