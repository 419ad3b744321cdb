"""The sections of the page of a replay: each function gives a heading, sentences, and tables or charts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

from ...prediction.checks import REMEDIES
from ...prediction.scene import features_of
from ...prediction.types import Status
from ...stamps import NANOSECONDS
from ...wording import counted, words
from ..modes import MODES, PALETTE
from ..summary import PER_DECADE, WHY, quantile, without_bag
from . import facts
from .document import GREY, Cell, Chart, PageTable, Section, marks, part_words, time_words
from .facts import NOTHING, BagAnswer
from .timeline import FALSE, MANY, MISSED, in_order, look_of, timeline

DRAWN: Final = 8
"""Bags of which a timeline is drawn; of more the worst."""


def bags(answers: Sequence[BagAnswer], order: Sequence[int], links: Mapping[int, str]) -> Section | None:
    """A row for each of several bags, the worst first; None where there is only one."""
    if len(answers) < 2:
        return None
    names, rows = facts.names_of(answers), list[list[Cell | str]]()
    for place in order:
        answer, found = answers[place], facts.facts_of([answers[place]])
        remark = next((kind for key, kind in REMARKS.items() if key != "notes" and answer.get(key)), "")
        cells = [Cell(fact.answer, fact.more if fact.question == "found" else "") for fact in found]
        rows.append([Cell(names[place], remark, to=links.get(place, "")), *(cells if "error" not in answer else [])])
    said = (
        "First those that could not be used, then by what was missed or announced in vain, then by the error. The "
        f"timelines of the first {DRAWN} with touchdowns are drawn."
    )
    return Section("bags", "The bags", [said], [PageTable(["bag", *(fact.question for fact in found)], rows)])


READING: Final = (
    "A mark is a touchdown where it was predicted last; the line before it leads back to when it was first announced. "
    "Below it stand the true touchdowns, where the record tells them, or the stances of a foot. A red star is a "
    "touchdown that was missed, a red cross a false alarm. What such a record cannot show or compare is faint. Drag "
    "over a part of the time to magnify it, with shift to move on, and double-click to see all of it again; point at a "
    "mark for more."
)


def when(answers: Sequence[BagAnswer], places: Sequence[int]) -> Section | None:
    """The timelines of some bags; None where nothing was predicted."""
    names = facts.names_of(answers)
    charts = [timeline(names[one], answers[one], f"bag-{one + 1}") for one in places]
    return Section("when", "When the touchdowns came", [READING], charts) if charts else None


AGAINST: Final = (
    "Each point is a touchdown: to the right the velocity that the samples 2 to 4 after it show, upwards the one that "
    "was predicted last before it. On the line both are the same. The relative error of a touchdown is the distance of "
    "both its points from the line, over its velocities before the impact. By the time of those samples gravity, "
    "further impacts and a moving support have changed what the impact left."
)


def velocities(answers: Sequence[BagAnswer]) -> Section | None:
    """Predicted against measured velocities right after the touchdowns; None where none were measured."""
    compared = [
        (f"{name}, {(one['stamp'] - answer['begin']) / NANOSECONDS:.3f} s, {one['body']}", one)
        for name, answer in zip(facts.names_of(answers), answers, strict=True)
        for one in facts.scored_of([answer])
    ]
    if not compared:
        return None
    charts = [
        _against("Along the support: vx", compared, 0),
        _against("From turning: ω times half the contacts' distance", compared, 2),
    ]
    return Section("velocities", "Predicted against measured velocities", [AGAINST], charts)


def _against(title: str, compared: Sequence[tuple[str, BagAnswer]], part: int) -> Chart:
    """The measured and the predicted velocity (m/s) of each touchdown, of one part of the twist."""
    points: dict[str, list[tuple[float, float, str]]] = {}
    for name, one in compared:
        arm = one["half_distance"] if part == 2 else 1.0
        measured, predicted = (round(arm * one[key][part], 6) for key in ("measured_twist", "predicted_twist"))
        said = f"{name}\nrelative error {part_words(one['relative_error'])}"
        points.setdefault(one["mode"], []).append((measured, predicted, said))
    every = [point for of_mode in points.values() for point in of_mode]
    values = [value for point in every for value in point[:2]]
    ends = [min(values), max(values) + 1e-9]
    line = {"type": "scatter", "mode": "lines", "x": ends, "y": ends, "line": {"color": GREY}}
    traces: list[dict[str, Any]] = [line | {"hoverinfo": "skip", "showlegend": False}]
    kind = "scattergl" if len(every) > MANY else "scatter"
    hover = "measured %{x:.3f}, predicted %{y:.3f} m/s<br>%{hovertext}<extra></extra>"
    for mode in in_order(points):
        look = {"type": kind, "marker": look_of(mode) | {"size": 8}, "opacity": 0.75, "hovertemplate": hover}
        traces.append(marks(f"{mode} ({len(points[mode]):,})", points[mode], **look))
    layout = {"height": 460, "xaxis": {"title": "measured, m/s"}}
    layout["yaxis"] = {"title": "predicted, m/s", "scaleanchor": "x"}
    return Chart(title, traces, layout, wide=False)


UNTOLD: Final = (
    "The record does not tell in which modes the bodies truly went on, and its velocities do not either: whether a "
    "contact lifts shows in the vertical velocity, in which an impact is lost among what gravity and other contacts "
    "do before the next samples. What can be checked is how well the velocities agree that each mode comes with."
)


def modes(answers: Sequence[BagAnswer]) -> Section | None:
    """The modes that were predicted against the true ones, or what can be told of them without a truth."""
    # Of a landing it is the mode of an impact with the speed of the foot in its last sample in the air.
    found = Counter(one.get("landing_mode") or one["mode"] for one in facts.touchdowns_of(answers))
    if not found:
        return None
    looks = {mode.name: Cell(mode.name, look.meaning) for mode, look in MODES.items()}
    if counts := facts.confusion(answers):
        true, predicted = ([one for one in (*looks, NOTHING) if one in kinds] for kinds in zip(*counts, strict=True))
        looks[NOTHING] = Cell(FALSE)
        rows: list[list[Cell | str]] = []
        for row in true:
            cells = [Cell(f"{counts[row, one]:,}", css="best" if row == one else "") for one in predicted]
            rows.append([looks[row], *cells])
        caption = "How many touchdowns of each true mode (a row) were predicted in which mode (a column)."
        table = PageTable(["true mode", *(MISSED if one == NOTHING else one for one in predicted)], rows, caption)
        return Section("modes", "Predicted against true modes", [facts.right_modes(counts)], [table])
    rows = []
    for mode in in_order(found):
        errors = [one["relative_error"] for one in facts.scored_of(answers) if one["mode"] == mode]
        parts = [part_words(quantile(errors, part) if errors else None) for part in (0.5, 0.9)]
        rows.append([looks[mode], f"{found[mode]:,}", f"{len(errors):,}", *parts])
    head = ["predicted mode", "touchdowns", "compared", "median error", "90 % below"]
    return Section("modes", "Predicted modes", [UNTOLD], [PageTable(head, rows)])


def lead_times(answers: Sequence[BagAnswer]) -> Section | None:
    """Errors over the time ahead at which a prediction is made; None where there are none."""
    charts = []
    for key, title, axis, factor in (
        ("relative_errors_ahead", "Velocities after the impact, against measured ones", "relative error, %", 100.0),
        ("time_errors_ahead", "Time of the touchdown", "error of the time, ms", 1e3),
    ):
        spans, traces = facts.errors_ahead(answers, key), []
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
    return Section("ahead", "Error against the time ahead", [said], charts) if charts else None


def cost(answers: Sequence[BagAnswer]) -> Section | None:
    """What the answer to a sample costs; None where nothing is known of it."""
    spread = facts.costs(answers)
    if not spread.number:
        return None
    said = (
        "The time from a sample to its prediction, as this machine took it: without reading the bag and writing "
        "messages, which a node does besides. A sample that shows no touchdown ahead takes the least."
    )
    # Ten steps for each factor of ten.
    counts: Counter[int] = Counter()
    for place, count in spread.bins.items():
        counts[10 * place // PER_DECADE] += count
    points = []
    for place in range(min(counts) - 1, max(counts) + 2):
        begin, middle, end = (10.0 ** (0.1 * (place + part)) for part in (0.0, 0.5, 1.0))
        between = f"{time_words(1e-6 * begin)} to {time_words(1e-6 * end)}"
        points.append((middle, counts[place], f"{between}: {counted(counts[place], 'sample')}"))
    steps = marks("samples", points, mode="lines", line={"shape": "hvh", "color": PALETTE[0]}, fill="tozeroy")
    across = {"title": "time for a sample, us", "type": "log", "dtick": 1}
    layout = {"height": 300, "xaxis": across, "yaxis": {"title": "samples"}}
    known = (time_words(1e-6 * (one or 0.0)) for one in (spread.p50, spread.p90, spread.p99, spread.most))
    caption = "The median of {} is {}, 90 % are below {}, 99 % below {}, the longest is {}."
    chart = Chart("Time for a sample", [steps], layout, caption.format(counted(spread.number, "sample"), *known))
    return Section("cost", "What a sample costs", [said], [chart])


REMARKS: Final = {
    "error": "could not be read",
    "unpredictable": "nothing predicted",
    "damaged": "damaged",
    "notes": "note",
}
"""What is said of a bag, by its key in the answers; the gravest first."""


def unused(answers: Sequence[BagAnswer]) -> Section:
    """What could not be used: refused messages, touchdowns that are not compared, damage, failures and notes."""
    inputs: dict[str, Counter[str]] = {}
    for answer in answers:
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
    reasons = [[WHY[flag], f"{number:,}"] for flag, number in facts.uncompared(answers).most_common()]
    names, said = facts.names_of(answers), dict[tuple[str, str], list[str]]()
    for key, kind in REMARKS.items():
        for name, answer in zip(names, answers, strict=True):
            of_bag = answer.get(key) or []
            for one in [of_bag] if isinstance(of_bag, str) else of_bag:
                said.setdefault((kind, without_bag(one, answer["bag"])), []).append(name)
    remarks: list[list[Cell | str]] = []
    for (kind, one), bags in said.items():
        more = f" and {counted(len(bags) - 1, 'more bag')}" if len(bags) > 1 else ""
        remarks.append([Cell(bags[0] + more, kind), one])
    tables = (
        PageTable(
            ["input", "what is wrong", "messages"], refused, "Messages that were refused, by input and reason.", 2
        ),
        PageTable(["touchdowns that are not compared, for one or several reasons", "touchdowns"], reasons),
        PageTable(["bag", "remark"], remarks, "What was said of the bags.", 2),
    )
    there = [table for table in tables if table.rows]
    return Section("unused", "What could not be used", [] if there else ["Everything could be used."], there)


def scene(values: Mapping[str, Any] | None) -> Section | None:
    """What the scene has and leaves out, from all its parameters; None where these are not known."""
    if values is None:
        return None
    # The events executor is the node's.
    features = [feature for feature in features_of(values) if feature.name != "events executor"]
    rows: list[list[Cell | str]] = []
    for one in sorted(features, key=lambda feature: not feature.on):
        css = "" if one.on else "none"
        rows.append([Cell(one.name, "" if one.on else "left out", css), Cell(one.why, css=css)])
    left_out = sum(not feature.on for feature in features)
    said = (
        f"The predictor took in {len(features) - left_out} of its parts for this scene and left out {left_out}, in "
        "grey. What is left out costs nothing; where a body needs it, the parameter that is named switches it on."
    )
    return Section("scene", "What the scene left out", [said], [PageTable(["part", "why"], rows, "", 2)])
