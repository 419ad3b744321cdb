"""A picture of the first sections of a page that this program wrote, as a browser shows it: with playwright.

impact-predictor replay examples/cube_tosses --params config/cube_tosses.yaml --report out/replay.html
python tools/picture_of_page.py out/replay.html docs/replay_report.png
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from playwright.sync_api import sync_playwright

WIDTH, BELOW = 1180, 24
"""Pixels: of the picture, and below its last section."""


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path, help="an .html file")
    parser.add_argument("picture", type=Path, help="a .png file to write")
    parser.add_argument("--until", default="skill", help="anchor of the last section that is shown")
    arguments = parser.parse_args()
    with sync_playwright() as playwright:
        # A container runs it as root, and has no sandbox for that.
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": WIDTH, "height": WIDTH}, color_scheme="light")
        page.goto(arguments.page.resolve().as_uri())
        bottom = page.locator(f"#{arguments.until}").evaluate("(one) => one.getBoundingClientRect().bottom")
        clip = {"x": 0, "y": 0, "width": WIDTH, "height": bottom + BELOW}
        page.screenshot(path=arguments.picture, full_page=True, clip=clip)
        browser.close()


if __name__ == "__main__":
    main()
