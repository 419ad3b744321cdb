"""The command line, as tests call it and read what it prints."""

from __future__ import annotations

import json
from typing import Any

from click.testing import CliRunner, Result

from impact_predictor.cli import main


def invoke(*arguments: str) -> Result:
    """What a command does, on a terminal of 100 columns."""
    return CliRunner().invoke(main, arguments, terminal_width=100)


def answer_of(result: Result) -> Any:
    """What a command has printed as JSON."""
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


def refusal_of(result: Result) -> str:
    """The one line on standard error after which nothing was done."""
    assert result.exit_code == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("error: ")
    return line
