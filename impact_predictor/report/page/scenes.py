"""A picture of each scene, and the cheapest method of each."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from .chart import NARROW, WIDE, draw_chart
from .data import Entry, Point, choices_of, front_of, points_of, seen
from .looks import marker_svg
from .oldsections import Cell, Figure, Key, Section, Table
from .study import Study
from .words import accuracy_words, error_words, name_of, neat, share, time_words, unanswered


def scenes(report: Entry, study: Study) -> Section:
    """A picture of each scene."""
    words = (
        f"Asked is {study.asked}. All pictures have the same axes: the time of one prediction, and the relative error "
        "that 90 % of the predictions stay below (the larger of the errors of the time and of the twist, where both "
        "are predicted). Point at a mark, or open the numbers below a picture, for more."
    )
    says = {entry["name"]: entry["says"] for entry in report.get("families", ())}
    key = [Key(marker_svg(looks), family, says.get(family, "")) for family, looks in study.frame.looks.items()]
    figures = [scene_figure(report, study, scene) for scene in study.scenes]
    cheapest_of_each = Section(
        f"{study.question}-cheapest", "The cheapest method of each scene", tables=[by_scene(report, study)]
    )
    return Section(study.question, f"Scene by scene: {study.name}", [words], key, (), figures, [cheapest_of_each])


def scene_figure(report: Entry, study: Study, scene: Entry) -> Figure:
    points = points_of(report, study.question, scene["name"])
    title = scene["title"]
    front = ", ".join(
        f"{name_of(p.method, p.setting)} ({time_words(p.us)}, {error_words(p.error)})" for p in front_of(points)
    )
    label = f"Error against time, {title}. On the front: {front}."
    name = f"{study.question}-{scene['name']}".replace(" ", "-")
    drawings = [draw_chart(points, study.frame, shape, name, label) for shape in (WIDE, NARROW)]
    notes = [unanswered(point.row for point in points)]
    caption = neat(f"{scene['description']} Reference: {scene['reference']}.")
    return Figure(title, caption, drawings, [note for note in notes if note], numbers_of(points))


def numbers_of(points: Sequence[Point]) -> Table:
    """The numbers of a picture."""
    keys = [
        (key, head)
        for key, head in (("time_error", "time, 90 %"), ("twist_error", "twist, 90 %"))
        if any(point.row[key] is not None for point in points)
    ]
    modes = any(point.row["wrong_modes"] is not None for point in points)
    rows = []
    for point in sorted(points, key=lambda point: (point.us, seen(point.error))):
        cells = [Cell(point.method, neat(point.setting)), Cell(time_words(point.us))]
        cells += [Cell(error_words(point.row[f"{key}_90"])) for key, _ in keys]
        if modes:
            cells.append(Cell(share(point.row["wrong_modes"])))
        rows.append(cells)
    head = ["method", "run time", *(head for _, head in keys), *(["wrong mode"] if modes else [])]
    return Table("", head, rows)


def by_scene(report: Entry, study: Study) -> Table:
    """The cheapest method of each scene; what is the same for several accuracies stands once."""
    rows = []
    for scene, choices in choices_of(report, study.question):
        if scene in study.titles:
            by_accuracy = sorted(choices, key=lambda choice: -float(choice["accuracy"]))
            same = groupby(by_accuracy, key=lambda choice: (choice["method"], choice["setting"]))
            rows.append([Cell(study.titles[scene]), *(choice_cell(list(group)) for _, group in same)])
    head = ["scene", *(accuracy_words(accuracy) for accuracy in study.accuracies)]
    caption = "For an error that 90 % of the predictions stay below."
    return Table(caption, head, rows, words=len(head), cards=True, accuracies=study.accuracies)


def choice_cell(choices: Sequence[Entry]) -> Cell:
    """A method that is the cheapest for some accuracies, the coarsest first."""
    first, last = choices[0], choices[-1]
    head = " to ".join(dict.fromkeys(accuracy_words(choice["accuracy"]) for choice in (first, last)))
    if first["method"] is None:
        return Cell("none", "", "none", len(choices), head)
    below = ", ".join(filter(None, (neat(first["setting"]), time_words(first["us"]))))
    return Cell(first["method"], below, "", len(choices), head)
