"""The pages of this program as a browser shows them, opened from disk without a network.

They are the page of error against run time, of page_report.json, and that of a replay; or with
IMPACT_PREDICTOR_PAGE=FILE another. With IMPACT_PREDICTOR_SCREENSHOTS=FOLDER each test leaves a picture there.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from replay_answers import TOSSES, TRUE, UNREADABLE, WALK

from impact_predictor.parameters.file import read_values
from impact_predictor.report.page.replay import write_replay_page
from impact_predictor.report.page.write import write_page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
sync_api = pytest.importorskip(
    "playwright.sync_api", reason="the page is not looked at: no playwright; make test-extras"
)
pytestmark = [
    pytest.mark.extras,
    pytest.mark.slow,
    pytest.mark.skipif(
        not CHROMIUM, reason="the page is not looked at: no chromium; apt-get install chromium, then make test-extras"
    ),
]

WIDE, NARROW = 1280, 390
LEAST_TEXT = 10.0
"""Pixels; smaller letters are read by few people."""
LEAST_CONTRAST = 4.5
"""Of text against its ground, by WCAG 2.2, level AA."""


class Visit(NamedTuple):
    """An opened page, with what went wrong on it and what it asked the network for."""

    page: Any
    troubles: list[str]
    requests: list[str]


Open = Callable[..., AbstractContextManager[Visit]]
Look = Callable[..., dict[str, Any]]
"""What a page shows in a width and a scheme."""

SEEN = """() => {
  const shown = (one) => one.checkVisibility({visibilityProperty: true, opacityProperty: true});
  const box = (one) => one.getBoundingClientRect().toJSON();
  const texts = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (!node.data.trim() || parent.closest("script, style, title") || !shown(parent)) continue;
    const svg = parent.closest("svg");
    const scale = svg ? parent.getScreenCTM().a : 1;
    const style = getComputedStyle(parent);
    let ground = parent;
    const clear = () => getComputedStyle(ground).backgroundColor.endsWith(", 0)");
    while (ground.parentElement && clear()) ground = ground.parentElement;
    texts.push({text: node.data.trim(), size: parseFloat(style.fontSize) * scale, ...box(parent),
      colour: svg ? style.fill : style.color, ground: getComputedStyle(ground).backgroundColor,
      svg: svg ? [...document.querySelectorAll("svg")].indexOf(svg) : null});
  }
  const drawings = [...document.querySelectorAll(".drawing")].map((drawing) => {
    const svgs = [...drawing.querySelectorAll("svg:not(.shapes)")].filter(shown);
    return {title: drawing.closest("figure").firstElementChild.textContent, svgs: svgs.map(box),
      marks: svgs.flatMap((svg) => [...svg.querySelectorAll(".point use")].map(box)),
      others: svgs.flatMap((svg) => [...svg.querySelectorAll(":is(use, rect, line).point, .point > path")].map(box))};
  });
  const tables = [...document.querySelectorAll("table")].filter(shown).map((table) => ({
    ...box(table), inner: box(table.closest(".scroll")), scrolls: getComputedStyle(table.closest(".scroll")).overflowX,
    cut: [...table.querySelectorAll("th, td")].filter((one) => shown(one) && one.scrollWidth > one.clientWidth + 1)
      .map((one) => one.textContent.trim())}));
  return {texts, drawings, tables, width: document.documentElement.scrollWidth,
    paper: getComputedStyle(document.body).backgroundColor};
}"""

POINTS = """(all) => all.map((one) => ({...one.dataset, name: one.querySelector("title").textContent.split("\\n")[0],
  faded: one.classList.contains("misses"), cheapest: one.classList.contains("cheapest")}))"""


@pytest.fixture(scope="module", params=["report", "replay"])
def file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    if given := os.environ.get("IMPACT_PREDICTOR_PAGE"):
        return Path(given).resolve()
    file = tmp_path_factory.mktemp("page") / f"{request.param}.html"
    if request.param == "report":
        write_page(file, json.loads((Path(__file__).parent / "page_report.json").read_text()))
    else:
        write_replay_page(file, [TRUE, WALK, TOSSES, UNREADABLE], read_values("config/cube_tosses.yaml"))
    return file


only_the_report = pytest.mark.parametrize("file", ["report"], indirect=True)
only_the_replay = pytest.mark.parametrize("file", ["replay"], indirect=True)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        # A container runs it as root, and has no sandbox for that.
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def visit(browser: Any, file: Path) -> Open:
    @contextmanager
    def opened(width: int, **options: Any) -> Iterator[Visit]:
        viewport = {"width": width, "height": 900}
        context = browser.new_context(viewport=viewport, color_scheme="light", offline=True, **options)
        page = context.new_page()
        seen = Visit(page, [], [])
        page.on("console", lambda message: seen.troubles.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: seen.troubles.append(str(error)))
        page.on("request", lambda request: seen.requests.append(request.url))
        page.on("requestfailed", lambda request: seen.troubles.append(request.url))
        page.goto(file.as_uri())
        yield seen
        context.close()
        assert not seen.troubles

    return opened


@pytest.fixture(scope="module")
def opened(visit: Open) -> Iterator[Visit]:
    with visit(WIDE) as seen:
        seen.page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        yield seen


@pytest.fixture(scope="module")
def look(opened: Visit, file: Path) -> Look:
    page, folder = opened.page, os.environ.get("IMPACT_PREDICTOR_SCREENSHOTS")

    @cache
    def seen(width: int, scheme: str = "light") -> dict[str, Any]:
        page.set_viewport_size({"width": width, "height": 900})
        page.emulate_media(color_scheme=scheme)
        if folder:
            page.screenshot(path=Path(folder) / f"{file.stem}-{width}-{scheme}.png", full_page=True)
        found: dict[str, Any] = page.evaluate(SEEN)
        return found

    return seen


def luminance(colour: str) -> float:
    """Relative luminance of `rgb(r, g, b)`, by WCAG 2.2."""
    parts = [int(part) / 255.0 for part in colour.removeprefix("rgb(").rstrip(")").split(",")]
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def test_the_page_asks_for_nothing_but_itself(opened: Visit, file: Path) -> None:
    opened.page.wait_for_load_state("networkidle")
    assert opened.requests == [file.as_uri()]
    assert not opened.troubles


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_every_figure_shows_one_drawing_with_its_marks_inside_the_window(look: Look, width: int) -> None:
    drawings = look(width)["drawings"]
    assert len(drawings) > 2
    for drawing in drawings:
        (svg,) = drawing["svgs"]
        assert svg["left"] >= 0.0
        assert svg["right"] <= width
        assert svg["right"] - svg["left"] > 200.0
        assert svg["bottom"] - svg["top"] > 70.0
        assert drawing["marks"] or drawing["others"], drawing["title"]
        for other in drawing["others"]:
            assert svg["left"] - 8.0 <= other["left"] <= other["right"] <= svg["right"] + 8.0
            assert svg["top"] - 1.0 <= other["top"] <= other["bottom"] <= svg["bottom"] + 1.0
        for mark in drawing["marks"]:
            # A marker is 6.5 to 10 pixels wide in a drawing that is shown at 0.8 to 1.4 times its size.
            assert 4.0 < mark["right"] - mark["left"] < 18.0
            assert 4.0 < mark["bottom"] - mark["top"] < 18.0
            assert svg["left"] - 1.0 <= mark["left"] <= mark["right"] <= svg["right"] + 1.0
            assert svg["top"] - 1.0 <= mark["top"] <= mark["bottom"] <= svg["bottom"] + 1.0


# 1000 and 701 are the least widths of their layouts.
@pytest.mark.parametrize("width", [WIDE, 1000, 701, NARROW, 360])
def test_nothing_is_wider_than_the_window_and_no_letter_is_too_small(look: Look, width: int) -> None:
    seen = look(width)
    assert seen["width"] <= width
    small = {text["text"]: text["size"] for text in seen["texts"] if text["size"] < LEAST_TEXT}
    assert not small
    outside = [text["text"] for text in seen["texts"] if text["svg"] is not None and text["right"] > width]
    assert not outside


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_no_words_of_a_drawing_lie_on_each_other(look: Look, width: int) -> None:
    words: dict[int, list[dict[str, Any]]] = {}
    for text in look(width)["texts"]:
        if text["svg"] is not None:
            words.setdefault(text["svg"], []).append(text)
    assert words
    for mine in words.values():
        for one, other in combinations(mine, 2):
            across = min(one["right"], other["right"]) - max(one["left"], other["left"])
            up = min(one["bottom"], other["bottom"]) - max(one["top"], other["top"])
            # The box of a text is some 3 pixels higher than its letters, at the top and at the bottom.
            assert across <= 1.0 or up <= 6.0, (one["text"], other["text"])


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_tables_show_all_of_their_cells_and_scroll_inside_their_own_box(look: Look, width: int) -> None:
    tables = look(width)["tables"]
    assert len(tables) > 4
    for table in tables:
        assert not table["cut"]
        assert table["inner"]["right"] <= width
        assert table["scrolls"] == "auto" or table["right"] <= width
    # What a person came for is there without scrolling: at most a column of a table waits behind its edge.
    assert all(table["right"] - table["inner"]["right"] < 0.3 * width for table in tables)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_all_words_stand_out_from_their_ground(look: Look, width: int, scheme: str) -> None:
    seen = look(width, scheme)
    weak = {text["text"] for text in seen["texts"] if contrast(text["colour"], text["ground"]) < LEAST_CONTRAST}
    assert not weak
    paper = luminance(seen["paper"])
    assert paper > 0.8 if scheme == "light" else paper < 0.05


@only_the_report
@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_a_wanted_accuracy_shows_what_misses_it_and_names_the_cheapest(opened: Visit, width: int) -> None:
    page = opened.page
    page.set_viewport_size({"width": width, "height": 900})
    page.locator("#wanted label", has_text="10⁻⁶").click()
    figure = page.locator("#choose-touchdown figure")
    svg = figure.locator("svg:visible")
    points = svg.locator(".point").evaluate_all(POINTS)
    within = [point for point in points if float(point["error"]) <= 1e-6]
    assert [point for point in points if not point["faded"]] == within
    (chosen,) = [point for point in points if point["cheapest"]]
    assert float(chosen["us"]) == min(float(point["us"]) for point in within)
    assert chosen["name"] in figure.locator("output").text_content()
    lines = svg.locator("[data-accuracy].wanted")
    shown = lines.evaluate_all("(all) => all.map((one) => getComputedStyle(one).visibility)")
    assert shown == ["visible"]
    page.locator("#wanted label", has_text="any").click()
    assert page.locator(".misses, .cheapest, .wanted").count() == 0
    assert figure.locator("output").text_content() == ""


def test_the_page_is_whole_without_scripts(visit: Open) -> None:
    with visit(WIDE, java_script_enabled=False) as (page, *_):
        assert page.locator("#wanted:visible").count() == 0
        assert page.locator("figure svg.wide").first.is_visible()
        assert page.locator("figure svg.narrow").first.is_hidden()
        page.locator("summary").first.click()
        assert page.locator("details table").first.is_visible()


def test_the_page_prints_dark_on_white_without_what_is_to_be_clicked(opened: Visit) -> None:
    page = opened.page
    page.emulate_media(media="print", color_scheme="dark")
    try:
        assert luminance(page.evaluate("getComputedStyle(document.body).backgroundColor")) == pytest.approx(1.0)
        assert page.locator("form:visible").count() == 0
        assert page.locator("nav").is_hidden()
        assert page.locator("figure svg:visible").count() > 2
    finally:
        page.emulate_media(media="screen")


@only_the_replay
def test_a_timeline_is_magnified_and_scrolled_with_the_keyboard_alone(visit: Open) -> None:
    with visit(WIDE) as (page, *_):
        timeline = page.locator(".timeline").first
        box = timeline.locator(".scroll")
        timeline.locator("input").first.focus()
        page.keyboard.press("ArrowRight")
        assert timeline.locator("input:checked").get_attribute("value") == "4"
        wide = "(one) => one.scrollWidth / one.clientWidth"
        assert box.evaluate(wide) == pytest.approx(4.0, rel=0.05)
        shown = timeline.locator(".tick:visible").evaluate_all("(all) => all.map((one) => one.matches('.z4'))")
        assert shown
        assert all(shown)
        page.keyboard.press("Tab")
        before = box.evaluate("(one) => one.scrollLeft")
        page.keyboard.press("ArrowRight")
        page.wait_for_function("([one, before]) => one.scrollLeft > before", arg=[box.element_handle(), before])
        # What is magnified stays in sight.
        edges = box.bounding_box()
        marks = timeline.locator(".marks .point").evaluate_all(
            "(all) => all.map((one) => one.getBoundingClientRect().x)"
        )
        assert any(edges["x"] <= mark <= edges["x"] + edges["width"] for mark in marks)


@only_the_replay
def test_every_link_and_every_fold_of_a_replay_is_reached_with_the_tab_key(visit: Open) -> None:
    with visit(WIDE) as (page, *_):
        wanted = page.locator("a, summary").count()
        reached = 0
        for _ in range(200):
            page.keyboard.press("Tab")
            name = page.evaluate("document.activeElement.tagName")
            reached += name in ("A", "SUMMARY")
            if name == "BODY":
                break
        assert reached == wanted


@only_the_replay
def test_a_bag_leads_to_its_timeline(visit: Open) -> None:
    with visit(NARROW) as (page, *_):
        page.locator("#bags a", has_text="walk.bag").click()
        page.wait_for_function("document.querySelector('#bag-2').getBoundingClientRect().top < innerHeight")
        assert page.locator("#bag-2 h3").text_content() == "walk.bag"
