"""The documentation: its examples print what they say, its links lead somewhere, and every page is in the index."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from test_feet_messages import LANDING, STANDING, answer

import impact_predictor
from impact_predictor.parameters.table import PARAMETERS
from impact_predictor.prediction.types import Status
from impact_predictor.ros.diagnostics import Diagnostics
from impact_predictor.ros.feet_report import FeetReport
from impact_predictor.ros.inputs import Refusal

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("examples/*/README.md")]
CODE = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)")
PRINTS = re.compile(r"^    (?:(\w+=\w+) )?python (-c .*|-m pydoc .*)$", re.MULTILINE)
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


@pytest.mark.parametrize(
    ("page", "said"),
    [
        ("parameters", ["contact.friction", "contact.merge 0.0015"]),
        ("node", ["WRONG_JOINTS a joint of robot.urdf is missing", "NO_TRANSFORM"]),
        ("prediction", ["lead_time", "before.vx, .vy", "late s after the plan"]),
        ("api", ["solve_impact(body", "Input that no body can have gives Flag.INVALID_INPUT"]),
    ],
)
def test_what_the_site_fills_in_is_printed_at_once_by_the_commands_of_its_page(page: str, said: list[str]) -> None:
    commands = PRINTS.findall((ROOT / f"docs/{page}.md").read_text())
    printed = [
        subprocess.run(
            ["env", *setting.split(), sys.executable, *shlex.split(one)],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for setting, one in commands
    ]
    for words in said:
        assert words in "".join(printed)


@pytest.mark.parametrize("page", [pytest.param(page, id=str(page.relative_to(ROOT))) for page in PAGES])
def test_every_link_of_a_page_leads_somewhere(page: Path) -> None:
    for target, anchor in LINK.findall(CODE.sub("", page.read_text())):
        if target.startswith(("http", "mailto")):
            continue
        if page.parent.name == "docs" and target.startswith("../"):  # the site only names them: `fill` in docs/conf.py
            assert not anchor, target
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


def test_the_page_of_the_node_explains_every_key_of_its_diagnostics_and_no_other() -> None:
    page = (ROOT / "docs/node.md").read_text().partition("## Keys of `/diagnostics`")[2].partition("\n## ")[0]
    diagnostics, feet = Diagnostics("impact_predictor", 0.0), FeetReport("")
    diagnostics.feet[""] = feet
    diagnostics.refused(0.1, Refusal("odom", Status.NOT_FINITE))
    feet.take(answer(STANDING, landing=LANDING))
    named = {"refused.odom.NOT_FINITE": "refused.<input>.<status>", "feet.landings.RF": "feet.landings.<foot>"}
    keys = [named.get(key, key) for key, _, _ in diagnostics.figures(1.0)]
    assert sorted(re.findall(r"^\| `(\S+)` \|", page, re.MULTILINE)) == sorted(keys)


def test_the_page_of_reliability_names_every_parameter_that_cannot_be_set_while_the_node_runs() -> None:
    text = (ROOT / "docs/reliability.md").read_text()
    rows = text.partition("| cannot change while the node runs |")[2].partition("\n\n")[0].splitlines()[2:]
    told = {}
    for row in rows:
        _, names, why, _ = row.split("|")
        told |= dict.fromkeys(re.findall(r"`(.*?)`", names), why.strip())
    assert told == {name: one.fixed for name, one in PARAMETERS.items() if one.fixed}
