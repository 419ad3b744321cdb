"""A picture of the first sections of a page that this program wrote, or of the charts of one, with playwright.

impact-predictor replay examples/cube_tosses --params config/cube_tosses.yaml --report out/replay.html
python tools/picture_of_page.py out/replay.html docs/replay_report.png
python tools/picture_of_page.py out/replay.html docs/touchdowns.png --only velocities --width 1560
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from playwright.sync_api import sync_playwright

BELOW = 24
"""Pixels below the last section."""


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path, help="an .html file")
    parser.add_argument("picture", type=Path, help="a .png file to write")
    parser.add_argument("--until", default="skill", help="anchor of the last section that is shown")
    parser.add_argument("--only", help="anchor of a section: its charts are shown, and nothing else")
    parser.add_argument("--width", type=int, default=1180, help="pixels, which the page fills")
    arguments = parser.parse_args()
    width = arguments.width
    with sync_playwright() as playwright:
        # A container runs it as root, and has no sandbox for that.
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": width, "height": width}, color_scheme="light")
        page.goto(arguments.page.resolve().as_uri())
        page.add_style_tag(content="header, main { max-width: none }")
        if arguments.only is not None:
            page.add_style_tag(content=".scroll { display: none }")
            page.locator(f"#{arguments.only} .parts").screenshot(path=arguments.picture)
            return
        bottom = page.locator(f"#{arguments.until}").evaluate("(one) => one.getBoundingClientRect().bottom")
        clip = {"x": 0, "y": 0, "width": width, "height": bottom + BELOW}
        page.screenshot(path=arguments.picture, full_page=True, clip=clip)
        browser.close()


if __name__ == "__main__":
    main()
