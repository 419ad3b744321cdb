"""The documentation: its examples print what they say, its links lead somewhere, and every page is in the index."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import impact_predictor

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("examples/*/README.md")]
CODE = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)")
SAID = re.compile(r"^print\(.*\)  # (.*)$", re.MULTILINE)
EXAMPLES = [
    pytest.param(code, id=f"{page.stem}-{number}")
    for page in (ROOT / "README.md", ROOT / "docs/use.md")
    for number, code in enumerate(CODE.findall(page.read_text()))
]


@pytest.mark.parametrize("code", EXAMPLES)
def test_an_example_prints_what_stands_beside_it(
    code: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    exec(compile(code, "example", "exec"), {})
    printed = capsys.readouterr().out.splitlines()
    # What follows a colon or a comma explains the line.
    said = [re.split(r": |, up to", one)[0] for one in SAID.findall(code)]
    assert said
    assert [re.sub(r"-?\d\.\d{10,}(e-\d+)?", _rounded, line) for line in printed] == said


def _rounded(number: re.Match[str]) -> str:
    return repr(round(float(number[0]), 9) + 0.0)


@pytest.mark.parametrize("page", [pytest.param(page, id=str(page.relative_to(ROOT))) for page in PAGES])
def test_every_link_of_a_page_leads_somewhere(page: Path) -> None:
    for target, anchor in LINK.findall(CODE.sub("", page.read_text())):
        if target.startswith(("http", "mailto")):
            continue
        file = page.parent / target if target else page
        assert file.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)
            assert anchor in [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings], (
                anchor
            )


def test_every_page_can_be_reached_from_the_readme() -> None:
    known, ahead = set[Path](), [ROOT / "README.md"]
    while ahead:
        page = ahead.pop()
        known.add(page)
        linked = {
            (page.parent / target).resolve() for target, _ in LINK.findall(page.read_text()) if target.endswith(".md")
        }
        ahead.extend(linked - known - {*ahead})
    assert {*ROOT.glob("docs/*.md"), *ROOT.glob("*.md")} <= known


def test_the_reference_has_every_public_name() -> None:
    named = re.findall(r"^\.\. auto\w+:: impact_predictor\.(\w+)$", (ROOT / "docs/api.md").read_text(), re.MULTILINE)
    assert sorted(named) == sorted(impact_predictor.__all__)
