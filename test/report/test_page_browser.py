"""The pages of this program as a browser shows them, opened from disk without a network."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from replay_answers import TOSSES, TRUE, UNREADABLE, WALK, answer, touchdown

from impact_predictor.files import write_text
from impact_predictor.report.accuracy.page import accuracy_page
from impact_predictor.report.page import script_inside
from impact_predictor.report.page.replay import write_replay_page

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
EVIL = '<img src="http://example.com/x" onerror="alert(1)"><script>alert(2)</script>'

CHARTS = """() => [...document.querySelectorAll(".chart")].map((one) => ({id: one.id, traces: one.data.length,
  drawn: one.querySelectorAll(".main-svg").length > 0, right: one.getBoundingClientRect().right}))"""


CLEAR = """() => [...document.querySelectorAll(".ytitle")].map((title) => {
  const end = title.getBoundingClientRect().right, ticks = title.closest(".main-svg").parentElement;
  return Math.min(...[...ticks.querySelectorAll(".ytick text")].map((one) => one.getBoundingClientRect().left)) - end;
})"""
"""Pixels between each title of an axis and the leftmost of its numbers."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        # A container runs it as root, and has no sandbox for that.
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@contextmanager
def visit(browser: Any, file: Path, width: int = WIDE) -> Iterator[tuple[Any, list[str]]]:
    """An opened page, and what it asks for; nothing may go wrong on it."""
    context = browser.new_context(viewport={"width": width, "height": 900}, offline=True, reduced_motion="reduce")
    page, requests, troubles = context.new_page(), list[str](), list[str]()
    page.on("console", lambda message: troubles.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.on("dialog", lambda dialog: troubles.append(dialog.message) or dialog.dismiss())
    page.goto(file.as_uri())
    page.wait_for_load_state("networkidle")
    yield page, requests
    context.close()
    assert not troubles


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    answers = [TRUE, WALK, TOSSES, UNREADABLE]
    write_replay_page(folder / "replay.html", answers)
    write_replay_page(folder / "week", answers)
    report = json.loads((Path(__file__).parent / "page_report.json").read_text())
    write_text(folder / "report.html", accuracy_page(report, script_inside()))
    return folder


@pytest.mark.parametrize("width", [WIDE, NARROW])
@pytest.mark.parametrize(("name", "count"), [("replay.html", 8), ("week/index.html", 8), ("report.html", 4)])
def test_the_page_draws_every_chart_inside_the_window_and_asks_no_network(
    browser: Any, folder: Path, name: str, count: int, width: int
) -> None:
    file = folder / name
    with visit(browser, file, width) as (page, requests):
        charts = page.evaluate(CHARTS)
        assert len(charts) == count
        assert all(one["drawn"] and one["traces"] and one["right"] <= width for one in charts)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    beside = [file.with_name("plotly.min.js").as_uri()] if "/" in name else []
    assert requests == [file.as_uri(), *beside]


def test_the_title_of_an_axis_stands_beside_its_numbers_however_long_they_are(browser: Any, folder: Path) -> None:
    with visit(browser, folder / "report.html") as (page, _):
        clear = page.evaluate(CLEAR)
    assert len(clear) == 4
    assert all(0.0 < pixels < 100.0 for pixels in clear)


def test_text_of_a_bag_is_shown_as_text_and_nothing_of_it_is_run(browser: Any, tmp_path: Path) -> None:
    file = tmp_path / "evil.html"
    bag = answer(
        "evil.mcap", touchdowns=[touchdown(100, body=EVIL), touchdown(300, body="cube", flags=[EVIL])], notes=[EVIL]
    )
    write_replay_page(file, [bag, TRUE])
    with visit(browser, file) as (page, requests):
        page.evaluate("document.querySelectorAll('.chart').forEach((one) => Plotly.Fx.hover(one, [{curveNumber: 1}]))")
        lanes = page.locator(".chart .ytick text").all_text_contents()
        assert f"{EVIL} predicted" in lanes
        assert page.locator("td", has_text=EVIL).count()
        assert page.locator("img").count() == 0
    assert requests == [file.as_uri()]
