"""Sentences on the terminal are printed as they are."""

from __future__ import annotations

from io import StringIO

from rich.console import Console

from impact_predictor.report.table import say


def test_a_terminal_with_colours_gets_the_sentence_alone_whatever_is_in_it() -> None:
    console = Console(file=StringIO(), width=40, force_terminal=True, color_system="truecolor")
    sentence = "2 of 3 feet of [bold]/dog/odom[/bold] stand 'below' the ground by 0.05 m: see https://a.b/c."
    say(console, sentence)
    assert console.file.getvalue() == f"{sentence}\n"  # type: ignore[attr-defined]
