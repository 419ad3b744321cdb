"""The pages of this program as a browser shows them, opened from disk without a network."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from replay_answers import TOSSES, TRUE, UNREADABLE, WALK, answer, touchdown

from impact_predictor.parameters.file import read_values
from impact_predictor.report.accuracy.page import write_accuracy_page
from impact_predictor.report.page.replay import write_replay_page, write_replay_pages

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
LEAST_CONTRAST = 4.5
"""Of text against its ground, by WCAG 2.2, level AA."""

EVIL = '<img src="http://example.com/x" onerror="alert(1)"><script>alert(2)</script>'

CHARTS = """() => [...document.querySelectorAll(".chart")].map((one) => ({id: one.id, traces: one.data.length,
  drawn: one.querySelectorAll(".main-svg").length > 0, right: one.getBoundingClientRect().right}))"""

TEXTS = """() => [...document.querySelectorAll("p, h1, h2, h3, th, td, dt, dd, a, figcaption, small, summary")]
  .filter((one) => one.checkVisibility() && one.textContent.trim()).map((one) => {
    let ground = one;
    const clear = () => getComputedStyle(ground).backgroundColor.endsWith(", 0)");
    while (ground.parentElement && clear()) ground = ground.parentElement;
    return [one.textContent.trim(), getComputedStyle(one).color, getComputedStyle(ground).backgroundColor];
  })"""


class Visit(NamedTuple):
    """An opened page, with what went wrong on it and what it asked for."""

    page: Any
    troubles: list[str]
    requests: list[str]


Open = Callable[..., AbstractContextManager[Visit]]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        # A container runs it as root, and has no sandbox for that.
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def visit(browser: Any) -> Open:
    @contextmanager
    def opened(file: Path, width: int = WIDE, scheme: str = "light") -> Iterator[Visit]:
        context = browser.new_context(
            viewport={"width": width, "height": 900}, color_scheme=scheme, offline=True, reduced_motion="reduce"
        )
        page = context.new_page()
        seen = Visit(page, [], [])
        page.on("console", lambda message: seen.troubles.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: seen.troubles.append(str(error)))
        page.on("request", lambda request: seen.requests.append(request.url))
        page.on("dialog", lambda dialog: seen.troubles.append(dialog.message) or dialog.dismiss())
        page.goto(file.as_uri())
        page.wait_for_load_state("networkidle")
        yield seen
        context.close()
        assert not seen.troubles

    return opened


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    answers, values = [TRUE, WALK, TOSSES, UNREADABLE], read_values("config/cube_tosses.yaml")
    write_replay_page(folder / "replay.html", answers, values)
    write_replay_pages(folder / "week", answers, values)
    write_accuracy_page(folder / "report.html", json.loads((Path(__file__).parent / "page_report.json").read_text()))
    return folder


@pytest.mark.parametrize("width", [WIDE, NARROW])
@pytest.mark.parametrize(("name", "count"), [("replay.html", 8), ("week/index.html", 8), ("report.html", 4)])
def test_the_page_draws_every_chart_inside_the_window_and_asks_no_network(
    visit: Open, folder: Path, name: str, count: int, width: int
) -> None:
    file = folder / name
    with visit(file, width) as (page, _, requests):
        charts = page.evaluate(CHARTS)
        assert len(charts) == count
        assert all(one["drawn"] and one["traces"] and one["right"] <= width for one in charts)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    beside = [file.with_name("plotly.min.js").as_uri()] if "/" in name else []
    assert requests == [file.as_uri(), *beside]


def test_text_of_a_bag_is_shown_as_text_and_nothing_of_it_is_run(visit: Open, tmp_path: Path) -> None:
    file = tmp_path / "evil.html"
    bag = answer(
        "evil.mcap", touchdowns=[touchdown(100, body=EVIL), touchdown(300, body="cube", flags=[EVIL])], notes=[EVIL]
    )
    write_replay_page(file, [bag, TRUE])
    with visit(file) as (page, _, requests):
        page.evaluate("document.querySelectorAll('.chart').forEach((one) => Plotly.Fx.hover(one, [{curveNumber: 1}]))")
        lanes = page.locator(".chart .ytick text").all_text_contents()
        assert f"{EVIL} predicted" in lanes
        assert page.locator("td", has_text=EVIL).count()
        assert page.locator("img").count() == 0
    assert requests == [file.as_uri()]


def luminance(colour: str) -> float:
    """Relative luminance of `rgb(r, g, b)`, by WCAG 2.2."""
    parts = [int(part) / 255.0 for part in colour.removeprefix("rgb(").rstrip(")").split(",")]
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_words_stand_out_from_their_ground(visit: Open, folder: Path, scheme: str) -> None:
    with visit(folder / "replay.html", scheme=scheme) as (page, *_):
        for text, colour, ground in page.evaluate(TEXTS):
            darker, lighter = sorted((luminance(colour), luminance(ground)))
            assert (lighter + 0.05) / (darker + 0.05) >= LEAST_CONTRAST, text
        paper = luminance(page.evaluate("getComputedStyle(document.body).backgroundColor"))
        assert paper > 0.8 if scheme == "light" else paper < 0.05
