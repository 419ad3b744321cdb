"""The page of error against run time, made from the report's JSON alone."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .choosing import choosing, headline
from .data import Entry
from .measured import measured
from .oldsections import Section
from .render import render, write
from .scenes import scenes
from .study import Study, accuracies_of, studies_of
from .words import accuracy_words, neat


def write_page(file: Path, report: Mapping[str, Any]) -> None:
    """Write one page that needs nothing else: no network, no other file.

    Args:
        file: to write, HTML.
        report: as `report.json` has it.

    Raises:
        InputError: the file cannot be written.
    """
    write(file, page_of(report))


def page_of(report: Mapping[str, Any]) -> str:
    """The page as HTML."""
    studies = studies_of(report)
    return render(
        "page.html",
        made=report["made"],
        notes=[neat(note) for note in report.get("notes", ())],
        headlines=[headline(report, study) for study in studies],
        sections=sections_of(report, studies),
        accuracies=[(f"{accuracy:g}", accuracy_words(accuracy)) for accuracy in accuracies_of(report)],
    )


def sections_of(report: Entry, studies: list[Study]) -> list[Section]:
    """The sections in the order in which a stranger reads them."""
    choice = Section(
        "choose",
        "Which method for a wanted accuracy",
        sections=[choosing(report, study) for study in studies],
    )
    found = [
        choice,
        *(scenes(report, study) for study in studies),
        measured(report, studies),
    ]
    return [section for section in found if section]
