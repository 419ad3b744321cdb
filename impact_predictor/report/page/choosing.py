"""Which method for a wanted accuracy: the answer in a sentence, a table over all families, and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from statistics import median
from typing import NamedTuple

from .chart import LARGE, NARROW, draw_chart
from .data import Entry, Point, points_by_method, points_of_all
from .oldsections import Cell, Figure, Section, Table
from .study import Study
from .words import accuracy_words, name_of, neat, time_words


def headline(report: Entry, study: Study) -> Entry:
    """What is best for a question at the finest accuracy, and by how much."""
    points = points_of_all(report, study.question)
    accuracy = study.accuracies[-1]
    best = cheapest(points, accuracy)
    answer = {"question": study.name, "name": "", "why": "", "used": bool(study.used)}
    if study.used:
        return answer | {"name": name_of(study.used["method"], study.used["setting"]), "why": neat(study.used["why"])}
    if best is None:
        return answer | {"name": "no method", "why": f"None is within {accuracy_words(accuracy)} in every scene."}
    scenes = len(study.scenes)
    why = f"Within {accuracy_words(accuracy)} in each of {scenes} scenes, and {time_words(best.us)} in the median one."
    second = cheapest([point for point in points if point.family != best.family], accuracy)
    if second:
        ratio = second.us / best.us
        times = f"{ratio:.0f} times" if ratio >= 9.95 else f"{ratio:.1f} times"
        why += f" The next kind of method as accurate, {name_of(second.method, second.setting)}, takes {times} as long."
    return answer | {"name": name_of(best.method, best.setting), "why": why}


def choosing(report: Entry, study: Study) -> Section:
    """Which method for a wanted accuracy, over all computed scenes of a question."""
    points = points_of_all(report, study.question)
    everywhere = {point.family for point in points}
    missing = [family for family in study.frame.looks if family not in everywhere]
    worst = {point.key: study.titles[point.row["scene"]] for point in points}
    label = f"Error against time of all methods for {study.name}, over all scenes; the table above has the numbers."
    drawings = [
        draw_chart(points, study.frame, shape, f"{study.question}-all", label, worst) for shape in (LARGE, NARROW)
    ]
    caption = (
        "Each point is a method with one setting, at the time of the median scene and the error of the worst of "
        f"the {len(study.scenes)} computed scenes. Further left is quicker, further down more accurate. The broad line "
        "is the least error within a time: no method is below it, and those on it are filled."
    )
    notes = []
    if study.used:
        notes.append(f"The name in bold is the node's method, {name_of(study.used['method'], study.used['setting'])}.")
    if missing:
        notes.append(f"Not for every scene, and so only in the pictures further down: {'; '.join(missing)}.")
    return Section(
        f"choose-{study.question}",
        f"For {study.name}",
        tables=[ranking(report, study)],
        figures=[Figure("All scenes at once", caption, drawings, notes)],
    )


class Offer(NamedTuple):
    """What a family has for an accuracy: a setting, in how many scenes it is within it, and its time in the median one.

    Offers compare by these: the more scenes the better, then the less time.
    """

    scenes: int
    minus_us: float
    setting: str


def ranking(report: Entry, study: Study) -> Table:
    """What each family costs for each wanted accuracy, the quickest of those that do for every scene marked."""
    families: dict[str, list[list[Point]]] = {}
    for points in points_by_method(report, study.question):
        families.setdefault(points[0].family, []).append(points)
    offers = {
        family: [max(offer(points, accuracy) for points in mine) for accuracy in study.accuracies]
        for family, mine in families.items()
    }
    best = [max(column) for column in zip(*offers.values(), strict=True)]
    rows = []
    for family, mine in sorted(offers.items(), key=lambda item: max(item[1]), reverse=True):
        if max(mine).scenes:
            cells = [offer_cell(one, one == top, len(study.scenes)) for one, top in zip(mine, best, strict=True)]
            rows.append([Cell(family, "the node's" if family == study.frame.marked else ""), *cells])
    caption = (
        "The time of a prediction, in the median scene, for an error that 90 % of the predictions stay below in every "
        "scene. The quickest is marked; what is only as accurate in some of the scenes is grey, with their number."
    )
    return Table(caption, ["method", *map(accuracy_words, study.accuracies)], rows, accuracies=study.accuracies)


def offer(points: Sequence[Point], accuracy: float) -> Offer:
    """What a method with one setting has for an accuracy; its points are of different scenes."""
    within = [point.us for point in points if point.error is not None and point.error <= accuracy]
    return Offer(len(within), -median(within) if within else -inf, points[0].setting)


def offer_cell(offer: Offer, best: bool, scenes: int) -> Cell:
    """An offer in the table, of so many scenes."""
    if not offer.scenes:
        return Cell("–", "", "none")
    everywhere = offer.scenes == scenes
    below = [neat(offer.setting), "" if everywhere else f"{offer.scenes} of {scenes}"]
    css_class = "none" if not everywhere else "best" if best else ""
    return Cell(time_words(-offer.minus_us), ", ".join(filter(None, below)), css_class)


def cheapest(points: Sequence[Point], accuracy: float) -> Point | None:
    """The cheapest point within an accuracy."""
    return min(
        (point for point in points if point.error is not None and point.error <= accuracy),
        key=lambda point: point.us,
        default=None,
    )
