"""The page of error against run time as a browser shows it, opened from disk without a network.

It is the page of page_report.json, or with IMPACT_PREDICTOR_PAGE=FILE another. With IMPACT_PREDICTOR_SCREENSHOTS=FOLDER
each test leaves a picture there.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pytest

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
    const svgs = [...drawing.querySelectorAll("svg")].filter(shown);
    return {title: drawing.closest("figure").firstElementChild.textContent, svgs: svgs.map(box),
      marks: svgs.flatMap((svg) => [...svg.querySelectorAll(".point use")].map(box))};
  });
  const tables = [...document.querySelectorAll("table")].filter(shown).map((table) => ({
    ...box(table), inner: box(table.closest(".scroll")), scrolls: getComputedStyle(table.closest(".scroll")).overflowX,
    cut: [...table.querySelectorAll("th, td")].filter((one) => shown(one) && one.scrollWidth > one.clientWidth + 1)
      .map((one) => one.textContent.trim())}));
  return {texts, drawings, tables, width: document.documentElement.scrollWidth};
}"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if given := os.environ.get("IMPACT_PREDICTOR_PAGE"):
        return Path(given).resolve()
    file = tmp_path_factory.mktemp("page") / "report.html"
    write_page(file, json.loads((Path(__file__).parent / "page_report.json").read_text()))
    return file


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        # A container runs it as root, and has no sandbox for that.
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def visit(browser: Any, file: Path, request: pytest.FixtureRequest) -> Open:
    @contextmanager
    def opened(width: int, scheme: str = "light", **options: Any) -> Iterator[Visit]:
        viewport = {"width": width, "height": 900}
        context = browser.new_context(viewport=viewport, color_scheme=scheme, offline=True, **options)
        page = context.new_page()
        seen = Visit(page, [], [])
        page.on("console", lambda message: seen.troubles.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: seen.troubles.append(str(error)))
        page.on("request", lambda request: seen.requests.append(request.url))
        page.on("requestfailed", lambda request: seen.troubles.append(request.url))
        page.goto(file.as_uri())
        yield seen
        if folder := os.environ.get("IMPACT_PREDICTOR_SCREENSHOTS"):
            Path(folder).mkdir(parents=True, exist_ok=True)
            page.screenshot(path=Path(folder) / f"{request.node.name}-{width}-{scheme}.png", full_page=True)
        context.close()
        assert not seen.troubles

    return opened


def unfold(page: Any) -> None:
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")


def luminance(colour: str) -> float:
    """Relative luminance of `rgb(r, g, b)`, by WCAG 2.2."""
    parts = [int(part) / 255.0 for part in colour.removeprefix("rgb(").rstrip(")").split(",")]
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_the_page_asks_for_nothing_but_itself(visit: Open, file: Path, width: int) -> None:
    with visit(width) as (page, troubles, requests):
        page.wait_for_load_state("networkidle")
        assert requests == [file.as_uri()]
        assert not troubles


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_every_figure_shows_one_drawing_with_its_marks_inside_the_window(visit: Open, width: int) -> None:
    with visit(width) as (page, *_):
        drawings = page.evaluate(SEEN)["drawings"]
        assert len(drawings) > 2
        for drawing in drawings:
            (svg,) = drawing["svgs"]
            assert svg["left"] >= 0.0
            assert svg["right"] <= width
            assert svg["right"] - svg["left"] > 300.0
            assert svg["bottom"] - svg["top"] > 90.0
            assert drawing["marks"], drawing["title"]
            for mark in drawing["marks"]:
                # A marker is 6.5 to 10 pixels wide in a drawing that is shown at 0.8 to 1.4 times its size.
                assert 4.0 < mark["right"] - mark["left"] < 18.0
                assert 4.0 < mark["bottom"] - mark["top"] < 18.0
                assert svg["left"] - 1.0 <= mark["left"] <= mark["right"] <= svg["right"] + 1.0
                assert svg["top"] - 1.0 <= mark["top"] <= mark["bottom"] <= svg["bottom"] + 1.0


@pytest.mark.parametrize("width", [WIDE, 1000, 999, 701, 700, NARROW, 360])
def test_nothing_is_wider_than_the_window_and_no_letter_is_too_small(visit: Open, width: int) -> None:
    with visit(width) as (page, *_):
        unfold(page)
        seen = page.evaluate(SEEN)
        assert seen["width"] <= width
        small = {text["text"]: text["size"] for text in seen["texts"] if text["size"] < LEAST_TEXT}
        assert not small
        outside = [text["text"] for text in seen["texts"] if text["svg"] is not None and text["right"] > width]
        assert not outside


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_no_words_of_a_drawing_lie_on_each_other(visit: Open, width: int) -> None:
    with visit(width) as (page, *_):
        words: dict[int, list[dict[str, Any]]] = {}
        for text in page.evaluate(SEEN)["texts"]:
            if text["svg"] is not None:
                words.setdefault(text["svg"], []).append(text)
        assert words
        for mine in words.values():
            for number, one in enumerate(mine):
                for other in mine[:number]:
                    across = min(one["right"], other["right"]) - max(one["left"], other["left"])
                    up = min(one["bottom"], other["bottom"]) - max(one["top"], other["top"])
                    # The box of a text is some 3 pixels higher than its letters, at the top and at the bottom.
                    assert across <= 1.0 or up <= 6.0, (one["text"], other["text"])


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_tables_show_all_of_their_cells_and_scroll_inside_their_own_box(visit: Open, width: int) -> None:
    with visit(width) as (page, *_):
        unfold(page)
        tables = page.evaluate(SEEN)["tables"]
        assert len(tables) > 4
        for table in tables:
            assert not table["cut"]
            assert table["inner"]["right"] <= width
            assert table["scrolls"] == "auto" or table["right"] <= width
        # What a person came for is there without scrolling: at most a column of a table waits behind its edge.
        assert all(table["right"] - table["inner"]["right"] < 0.3 * width for table in tables)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_all_words_stand_out_from_their_ground(visit: Open, width: int, scheme: str) -> None:
    with visit(width, scheme) as (page, *_):
        unfold(page)
        texts = page.evaluate(SEEN)["texts"]
        weak = {text["text"] for text in texts if contrast(text["colour"], text["ground"]) < LEAST_CONTRAST}
        assert not weak
        paper = luminance(page.evaluate("getComputedStyle(document.body).backgroundColor"))
        assert paper > 0.8 if scheme == "light" else paper < 0.05


@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_a_wanted_accuracy_shows_what_misses_it_and_names_the_cheapest(visit: Open, width: int) -> None:
    with visit(width) as (page, *_):
        page.locator("#wanted label", has_text="10⁻⁶").click()
        figure = page.locator("#choose-touchdown figure")
        svg = figure.locator("svg:visible")
        for point in svg.locator(".point").all():
            error, faded = float(point.get_attribute("data-error")), "misses" in (point.get_attribute("class") or "")
            assert faded == (error > 1e-6)
        chosen = svg.locator(".point.cheapest")
        assert chosen.count() == 1
        costs = [float(one.get_attribute("data-us")) for one in svg.locator(".point:not(.misses)").all()]
        assert float(chosen.get_attribute("data-us")) == min(costs)
        name = chosen.locator("title").text_content().splitlines()[0]
        assert name in figure.locator("output").text_content()
        lines = svg.locator("[data-accuracy].wanted")
        shown = lines.evaluate_all("(all) => all.map((one) => getComputedStyle(one).visibility)")
        assert shown == ["visible"]
        page.locator("#wanted label", has_text="any").click()
        assert page.locator(".misses, .cheapest, .wanted").count() == 0
        assert figure.locator("output").text_content() == ""


def test_the_page_is_whole_without_scripts(visit: Open) -> None:
    with visit(WIDE, java_script_enabled=False) as (page, *_):
        assert page.locator("#wanted").is_hidden()
        assert page.locator("figure svg.wide").first.is_visible()
        assert page.locator("figure svg.narrow").first.is_hidden()
        page.locator("summary").first.click()
        assert page.locator("details table").first.is_visible()


def test_the_page_prints_dark_on_white_without_what_is_to_be_clicked(visit: Open) -> None:
    with visit(WIDE, "dark") as (page, *_):
        page.emulate_media(media="print", color_scheme="dark")
        assert luminance(page.evaluate("getComputedStyle(document.body).backgroundColor")) == pytest.approx(1.0)
        assert page.locator("#wanted").is_hidden()
        assert page.locator("nav").is_hidden()
        assert page.locator("figure svg:visible").count() > 2
