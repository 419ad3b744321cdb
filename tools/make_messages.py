"""Write the files of the package impact_predictor_msgs from the tables that the predictor encodes its messages by.

    python tools/make_messages.py

A test compares the files with the tables. What the members of enumerations mean stands below them in their sources.
"""

from __future__ import annotations

import ast
import inspect
from enum import Enum
from pathlib import Path
from textwrap import dedent

from impact_predictor.prediction.checks import REMEDIES
from impact_predictor.prediction.types import Status
from impact_predictor.ros.messages.definitions import MESSAGES, definition

FOLDER = Path(__file__).resolve().parents[1] / "impact_predictor_msgs" / "msg"


def meanings(enumeration: type[Enum]) -> dict[str, str]:
    """What the members of an enumeration mean, as far as its source says so, by their names."""
    if enumeration is Status:
        return {status.name: remedy for status, remedy in REMEDIES.items()}
    (declared,) = ast.parse(dedent(inspect.getsource(enumeration))).body
    assert isinstance(declared, ast.ClassDef)
    found, name = {}, ""
    for line in declared.body:
        if isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name):
            name = line.targets[0].id
        elif name and isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant):
            found[name] = " ".join(str(line.value.value).split())
    return found


def files() -> dict[str, str]:
    """The text of each file by its name."""
    return {
        f"{name}.msg": definition(message, {one: meanings(one) for one in message.constants.values()})
        for name, message in MESSAGES.items()
    }


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, text in files().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
