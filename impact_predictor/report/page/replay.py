"""The page of a replay, made from the JSON answers of its bags alone: its title, its headlines and its sections."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...wording import counted
from . import facts, sections
from .document import page, script_beside, script_inside, write_html
from .facts import BagAnswer


def write_replay_page(
    path: str | os.PathLike[str], answers: Sequence[BagAnswer], values: Mapping[str, Any] | None = None
) -> None:
    """Write one page that needs no network and no other file, or a folder with a page for each bag, too.

    Args:
        path: to write, HTML. Without a suffix it is a folder: index.html about all bags, a page for each, and one file
            of plotly's script that they share.
        answers: of each bag, what `as_json` says of its replay; of one that could not be read its `bag` and `error`.
        values: all parameters of the scene, as `read_values` gives them; without them the page does not tell what the
            scene leaves out.

    Raises:
        InputError: a file cannot be written.
    """
    path = Path(path)
    if path.suffix:
        write_html(path, page_of_replay(answers, values, script_inside()))
        return
    script = script_beside(path)
    # The name of a bag is no name of a file: it comes from elsewhere.
    links = {place: f"bag-{place + 1}.html" for place, answer in enumerate(answers) if "error" not in answer}
    for place, name in links.items():
        write_html(path / name, page_of_replay([answers[place]], values, script))
    write_html(path / "index.html", page_of_replay(answers, values, script, links))


def page_of_replay(
    answers: Sequence[BagAnswer],
    values: Mapping[str, Any] | None = None,
    script: str = "",
    links: Mapping[int, str] | None = None,
) -> str:
    """The page as HTML; `script` is plotly's, `links` where the bags lead, by their places."""
    order = sorted(range(len(answers)), key=lambda place: facts.badness(answers[place]), reverse=True)
    there = [place for place in order if answers[place].get("touchdowns") or answers[place].get("true_touchdowns")]
    drawn = there[: sections.DRAWN]
    parts = (
        sections.bags(answers, order, links or {place: f"#bag-{place + 1}" for place in drawn}),
        sections.when(answers, drawn),
        sections.velocities(answers),
        sections.modes(answers),
        sections.lead_times(answers),
        sections.cost(answers),
        sections.unused(answers),
        sections.scene(values),
    )
    known = [fact for fact in facts.facts_of(answers) if fact.answer != "–"] if there else []
    title = ", ".join(f"{fact.question} {fact.answer}" for fact in known[:-1]) or "No touchdown was predicted"
    what = facts.names_of(answers)[0] if len(answers) == 1 else f"{len(answers):,} records"
    samples = counted(sum(answer.get("samples", 0) for answer in answers), "sample")
    lead = f"{what}, {samples}, went through the predictor as if live."
    return page(title, lead, known, [one for one in parts if one is not None], script)
