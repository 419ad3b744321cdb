"""The page of error against run time: what it says of page_report.json, a report with few of its scenes."""

from __future__ import annotations

import copy
import json
import re
from html.parser import HTMLParser
from itertools import combinations
from pathlib import Path
from statistics import median
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from impact_predictor.errors import InputError
from impact_predictor.report.page.choosing import headline, ranking
from impact_predictor.report.page.data import (
    Point,
    error_of,
    families_of,
    front_of,
    points_of,
    points_of_all,
    seen,
)
from impact_predictor.report.page.labels import Line, write_names
from impact_predictor.report.page.looks import looks_of
from impact_predictor.report.page.measured import alike
from impact_predictor.report.page.scenes import by_scene
from impact_predictor.report.page.study import studies_of
from impact_predictor.report.page.words import (
    error_words,
    name_of,
    neat,
    percent,
    share,
    time_words,
    unanswered,
)
from impact_predictor.report.page.write import page_of, write_page

REPORT: dict[str, Any] = json.loads((Path(__file__).parent / "page_report.json").read_text())
VOID = {"meta", "input", "br", "hr", "img", "link"}


class Outline(HTMLParser):
    """The elements of a page, with their attributes, and whether every one that is opened is closed."""

    def __init__(self) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.opened: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {key: value or "" for key, value in attrs}))
        if tag not in VOID:
            self.opened.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {key: value or "" for key, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.opened.pop() == tag


@pytest.fixture(scope="module")
def page() -> str:
    return page_of(REPORT)


@pytest.fixture(scope="module")
def outline(page: str) -> Outline:
    outline = Outline()
    outline.feed(page)
    outline.close()
    assert not outline.opened
    return outline


def drawings_of(page: str) -> list[ElementTree.Element]:
    return [
        ElementTree.fromstring(svg)
        for svg in re.findall(r"<svg [^>]*class=\"(?:wide|narrow)\".*?</svg>", page, re.DOTALL)
    ]


def small_report() -> dict[str, Any]:
    """One scene of one question: a page of it is made quickly."""
    report = copy.deepcopy(REPORT)
    for name in ("scenes", "rows"):
        report[name] = [one for one in report[name] if "rod" in (one.get("scene"), one.get("name"))][:30]
    return report


def a_row(**given: Any) -> dict[str, Any]:
    row = dict.fromkeys(f"{kind}_error{end}" for kind in ("time", "twist") for end in ("", "_90", "_worst"))
    return {**row, "question": "impact", "scene": "s", "family": "f", "method": "m", "setting": "", **given}


def test_the_page_refers_to_nothing_outside_itself(page: str, outline: Outline) -> None:
    assert "@import" not in page
    assert not re.search(r"url\((?!#)", page)
    for tag, attributes in outline.elements:
        assert tag not in ("link", "img", "iframe", "object", "base")
        assert "src" not in attributes
        assert attributes.get("href", "#").startswith("#"), attributes


def test_what_is_referred_to_stands_on_the_page_once(outline: Outline) -> None:
    identifiers = [attributes["id"] for _, attributes in outline.elements if "id" in attributes]
    assert len(identifiers) == len(set(identifiers))
    references = {attributes["href"].removeprefix("#") for _, attributes in outline.elements if "href" in attributes}
    references |= set(re.findall(r"url\(#([^)]+)\)", " ".join(str(attributes) for _, attributes in outline.elements)))
    assert references <= set(identifiers)


def test_every_figure_is_drawn_wide_and_narrow_with_a_tooltip_at_each_point(page: str) -> None:
    drawings = drawings_of(page)
    computed = [scene for scene in REPORT["scenes"] if not scene["measured"]]
    # Each scene once, all computed scenes of a question at once, and the two measured ones; all of them twice.
    assert len(drawings) == 2 * (len(computed) + 2 + 2)
    assert {drawing.get("class") for drawing in drawings} == {"wide", "narrow"}
    for drawing in drawings:
        assert drawing.get("aria-label")
        points = [element for element in drawing.iter() if element.get("class") == "point"]
        assert points
        for point in points:
            title = point.findtext("title") or ""
            assert re.search(r"(ns|µs|ms|s) per prediction", title)
            assert "error of the" in title


def test_every_row_of_a_computed_scene_with_an_error_has_its_point_and_its_tooltip(page: str) -> None:
    computed = {scene["name"] for scene in REPORT["scenes"] if not scene["measured"]}
    for row in REPORT["rows"]:
        if row["scene"] in computed and error_of(row) is not None:
            title = f"<title>{name_of(row['method'], row['setting'])}\n{time_words(row['us'])} per prediction"
            assert title in page


def test_every_point_carries_the_numbers_by_which_it_is_chosen(page: str) -> None:
    told = re.findall(r'<g data-error="([^"]+)" data-us="([^"]+)" class="point"><title>([^\n]+)\n', page)
    study = studies_of(REPORT)[1]
    points = [point for scene in study.scenes for point in points_of(REPORT, "impact", scene["name"])]
    points += points_of_all(REPORT, "impact")
    for point in points:
        if point.error is not None:
            assert (f"{point.error:.6g}", f"{point.us:.6g}", name_of(point.method, point.setting)) in told


def test_the_page_is_small_and_the_same_for_the_same_report(page: str) -> None:
    # The real report has some three times as many scenes, and the page is to stay below 2 MB.
    assert len(page.encode()) < 0.6e6
    assert page_of(small_report()) == page_of(small_report())


def test_names_of_a_report_cannot_become_part_of_the_page() -> None:
    report = small_report()
    report["made"]["machine"] = report["scenes"][0]["title"] = "<script>alert(1)</script>"
    for row in report["rows"]:
        row["setting"] = row["setting"].replace("n = 16", "<script>alert(1)</script>")
    assert "<script>alert" not in page_of(report)


def test_a_report_without_what_it_need_not_have_makes_a_page_too() -> None:
    report = {key: value for key, value in small_report().items() if key in ("made", "scenes", "rows", "choices")}
    page = page_of(report)
    assert "The node uses" not in page
    assert "Best, for the next touchdown" in page


def test_a_page_that_cannot_be_written_is_told_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written: No such file or directory"):
        write_page(tmp_path / "nowhere" / "report.html", small_report())


def test_the_error_is_the_larger_of_both_and_none_where_one_is_not_finite() -> None:
    both = a_row(time_error=1e-9, time_error_90=2e-9, twist_error=1e-12, twist_error_90=3e-9)
    assert error_of(both) == 3e-9
    assert error_of(a_row(twist_error=1e-12, twist_error_90=3e-9)) == 3e-9
    assert error_of({**both, "time_error_90": None}) is None  # no answer to more than a tenth
    assert error_of(a_row()) is None


@pytest.mark.parametrize("scene", ["rod", "stiff", "across"])
def test_no_method_is_both_quicker_and_as_accurate_as_one_on_the_front(scene: str) -> None:
    points = [point for point in points_of(REPORT, "impact", scene) if point.error is not None]
    front = front_of(points)
    for one in front:
        assert not any(p.us < one.us and seen(p.error) <= seen(one.error) for p in points)
    for other in {p.key for p in points} - {p.key for p in front}:
        point = next(p for p in points if p.key == other)
        assert any(p.us <= point.us and seen(p.error) <= seen(point.error) for p in front)


def test_all_scenes_together_count_by_the_worst_error_and_the_median_time() -> None:
    together = {point.key: point for point in points_of_all(REPORT, "impact")}
    key = ("contact space", "")
    rows = [row for row in REPORT["rows"] if (row["method"], row["setting"]) == key]
    assert len(rows) == 3
    assert together[key].us == median(row["us"] for row in rows)
    assert together[key].error == max(error_of(row) or 0.0 for row in rows)
    assert together[key].row["wrong_modes"] == max(row["wrong_modes"] for row in rows)
    assert together[key].row["count"] == sum(row["count"] for row in rows)


def test_a_method_that_leaves_a_scene_unanswered_is_not_among_those_for_all() -> None:
    assert not any(method == "closed forms" for method, _ in {p.key for p in points_of_all(REPORT, "impact")})
    report = copy.deepcopy(REPORT)
    for row in report["rows"]:
        if (row["scene"], row["method"]) == ("stiff", "contact space"):
            row.update(twist_error_90=None, twist_error_worst=None, failed=row["count"] // 2)
    assert not any(point.method == "contact space" for point in points_of_all(report, "impact"))


@pytest.mark.parametrize("number", [0, 1])
def test_the_ranking_marks_the_quickest_that_is_accurate_in_every_scene(number: int) -> None:
    study = studies_of(REPORT)[number]
    table = ranking(REPORT, study)
    for column, accuracy in enumerate(study.accuracies, start=1):
        marked = [(row[0].text, row[column].text) for row in table.rows if row[column].css_class == "best"]
        (choice,) = (
            choice
            for choice in REPORT["choices"]
            if (choice["question"], choice["scene"], choice["accuracy"]) == (study.question, "all", accuracy)
        )
        assert marked == ([(choice["family"], time_words(choice["us"]))] if choice["method"] else [])


def test_the_ranking_says_in_how_many_scenes_a_method_is_accurate() -> None:
    rows = {row[0].text: row[1:] for row in ranking(REPORT, studies_of(REPORT)[1]).rows}
    path_law = rows["path law"][0]
    assert path_law.below == "all of the scene at once, 2 of 3"  # not where there is slip across the plane
    assert path_law.css_class == "none"
    assert "no slip" not in rows  # accurate in none


def test_settings_stand_in_the_order_of_their_numbers() -> None:
    points = [Point("f", "m", setting, 1.0, 1.0, {}) for setting in ("rtol = 1e-9", "rtol = 0.001", "rtol = 1e-12")]
    ((_, ordered),) = families_of(points)
    assert [point.setting for point in ordered] == ["rtol = 1e-12", "rtol = 1e-9", "rtol = 0.001"]


def test_a_method_that_is_cheapest_for_several_accuracies_stands_once() -> None:
    study = studies_of(REPORT)[1]
    table = by_scene(REPORT, study)
    for row in table.rows:
        assert sum(cell.span for cell in row) == len(table.head)
    assert [cell.head for cell in table.rows[0][1:]] == ["10⁻² to 10⁻⁹"]
    assert [cell.text for cell in table.rows[2][1:]][-1] == "none"


def test_the_headline_says_what_the_node_uses_or_else_the_best_and_its_lead() -> None:
    study = studies_of(REPORT)[0]
    assert headline(REPORT, study)["name"] == REPORT["node"]["touchdown"]["method"]
    report = {key: value for key, value in REPORT.items() if key != "node"}
    touchdown, impact = (headline(report, study) for study in studies_of(report))
    assert touchdown["name"] == "next_touchdown"
    assert re.search(r"The next kind of method as accurate, .+, takes \d+ times as long", touchdown["why"])
    assert impact["why"] == "None is within 10⁻⁹ in every scene."


def test_settings_of_a_measured_method_that_read_the_same_stand_once() -> None:
    points = [point for point in points_of(REPORT, "touchdown", "cube tosses") if point.row["time_error"] is not None]
    rows = alike(points, "time_error")
    assert sum(count for _, count in rows) == len(points)
    assert len({(point.method, percent(point.row["time_error"])) for point, _ in rows}) == len(rows) < len(points)


@pytest.mark.parametrize(
    ("error", "words"),
    [(0.0, "below rounding"), (3.14e-7, "3.1·10⁻⁷"), (9.99e-7, "10⁻⁶"), (0.0234, "0.023"), (250.4, "250"), (None, "–")],
)
def test_errors_are_read_at_once(error: float | None, words: str) -> None:
    assert error_words(error) == words


@pytest.mark.parametrize(
    ("us", "words"),
    [(0.1263, "126 ns"), (0.9996, "1.0 µs"), (9.97, "10 µs"), (1234.0, "1.2 ms"), (1e6, "1 s"), (None, "–")],
)
def test_times_have_the_unit_that_suits_them_on_the_same_line(us: float | None, words: str) -> None:
    assert time_words(us) == words.replace(" ", "\N{NO-BREAK SPACE}")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("rtol = 1e-12", "rtol = 10⁻¹²"),
        ("k = 1e+08 N/m", "k = 10⁸ N/m"),
        ("dt = 2.5e-05 s", "dt = 2.5·10⁻⁵ s"),
        ("22 us; n = 16", "22 µs; n = 16"),
        ("tolerance = 0.0001", "tolerance = 10⁻⁴"),
        ("k = 10000 N/m, 0.0003, 1000", "k = 10⁴ N/m, 0.0003, 1000"),
        ("stage1e6", "stage1e6"),
    ],
)
def test_numbers_in_the_words_of_a_report_are_written_as_those_of_the_page(text: str, words: str) -> None:
    assert neat(text) == words


def test_a_rate_that_is_not_zero_never_reads_as_zero() -> None:
    assert [share(rate) for rate in (0.0, 1e-4, 0.05, None)] == ["0", "< 0.1 %", "5.0 %", "–"]


def test_methods_without_an_answer_are_counted_over_their_settings() -> None:
    rows = [a_row(method=m, failed=f, count=300) for m, f in (("compliant", 3), ("compliant", 2), ("exact", 0))]
    assert unanswered(rows) == "No answer: compliant 5 of 600."
    assert unanswered(rows[2:]) == ""


def test_no_two_families_look_the_same() -> None:
    looks = looks_of(f"family {number}" for number in range(13))
    assert len(set(looks.values())) == 13
    assert len({one.marker for one in looks.values()}) == 13


def test_names_beside_lines_cover_no_other_name() -> None:
    figure = Figure(figsize=(5.0, 4.0), dpi=72)
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set(xlim=(0.0, 10.0), ylim=(0.0, 10.0))
    # Six lines through one place, where names at their first marks would lie on each other.
    lines = [Line(f"family {n}", "black", np.array([[5.0, 5.0 + 0.05 * n], [6.0, 4.0 + 0.5 * n]])) for n in range(6)]
    write_names(axes, lines, 12.0)
    renderer = figure.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in axes.texts]
    assert len(boxes) == 6
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
