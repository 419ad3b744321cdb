"""The example of docs/testing.md: its commands print what stands there."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from impact_predictor.testing.plugin import PLACES, TOLERANCES

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/testing.md").read_text(encoding="utf-8")
PROGRAMS = f"""
impact-predictor() {{ {shlex.quote(sys.executable)} -m impact_predictor "$@"; }}
pytest() {{ {shlex.quote(sys.executable)} -m pytest -p impact_predictor.testing.plugin -p no:cacheprovider "$@"; }}
"""


def commands() -> list[tuple[str, list[str]]]:
    """Each command of the page with the lines that it prints."""
    found: list[tuple[str, list[str]]] = []
    for block in re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL):
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            else:
                found[-1][1].append(line)
    return found


@pytest.mark.slow
def test_the_commands_of_the_page_print_what_stands_there(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "config", tmp_path / "config")
    files = re.findall(r"`([\w.]+)`:\n\n```(?:ini|python)\n(.*?)```", PAGE, re.DOTALL)
    assert [name for name, _ in files] == ["pytest.ini", "test_plate.py"]
    for name, content in files:
        (tmp_path / name).write_text(content)
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
    environment = os.environ | {"PYTHONPATH": path, "COLUMNS": "80", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    for command, expected in commands():
        run = subprocess.run(
            ["bash", "-c", PROGRAMS + command],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
        )
        printed = [" ".join(line.split()) for line in run.stdout.splitlines()]
        for line in expected:
            assert any(" ".join(line.split()) in one for one in printed), f"{command}\n{line}\n{run.stdout}{run.stderr}"
        failed = "1 failed" in run.stdout or "2 worse" in run.stdout
        assert run.returncode == failed, run.stderr


def test_every_option_stands_on_the_page_with_its_default() -> None:
    for name in PLACES:
        assert f"--impact-{name}" in PAGE
    for name, (default, _) in TOLERANCES.items():
        assert f"`--impact-{name.replace('_', '-')} {default}`" in PAGE
