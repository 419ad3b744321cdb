"""The page of a replay, made from the JSON answers of its bags alone."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ... import __version__
from .render import render, write
from .replays.answers import Answer, used
from .replays.bags import bags
from .replays.heads import headlines_of, lead_of, title_of
from .replays.modes import modes
from .replays.spreads import cost_section, early
from .replays.unused import scene, unused
from .replays.velocities import velocities
from .replays.when import anchors_of, when
from .sections import Section


def write_replay_page(
    path: str | os.PathLike[str], answers: Sequence[Answer], values: Mapping[str, Any] | None = None
) -> None:
    """Write one page that needs nothing else: no network, no other file.

    Args:
        path: to write, HTML.
        answers: of each bag, what `as_json` says of its replay; of one that could not be read its `bag` and `error`.
        values: all parameters of the scene, as `read_values` gives them; without them the page does not tell what the
            scene leaves out.

    Raises:
        InputError: the file cannot be written.
    """
    write(Path(path), page_of_replay(answers, values))


def page_of_replay(answers: Sequence[Answer], values: Mapping[str, Any] | None = None) -> str:
    """The page as HTML."""
    return render(
        "replay.html",
        made={"version": __version__},
        title=title_of(answers),
        lead=[lead_of(answers)],
        headlines=headlines_of(answers),
        sections=sections_of(answers, values),
    )


def sections_of(answers: Sequence[Answer], values: Mapping[str, Any] | None) -> list[Section]:
    """The sections in the order in which a stranger reads them."""
    found, anchors = used(answers), anchors_of(answers)
    sections = [
        bags(answers, anchors),
        when(answers, anchors),
        velocities(found),
        modes(found),
        early(found),
        cost_section(found),
        unused(answers),
        scene(values),
    ]
    return [section for section in sections if section]
