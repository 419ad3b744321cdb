"""The page of the demonstration: tosses that were played live, a watch over a deck, and a robot that walks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from ...files import write_text
from ...prediction.skill import SIMPLE
from ..skill import kind_scores
from ..touchdowns import TouchdownRow, row_as_json
from . import Headline, Section, page, part_words, script_inside
from .facts import FOUND, BagAnswer, ReplayFacts
from .landings import landings
from .replay import modes, velocities
from .skill import skill
from .timeline import timeline
from .watch import chart_of


class Shown(NamedTuple):
    """A part of the demonstration: its title, what was found in sentences, and the answer that `as_json` gives."""

    title: str
    sentences: Sequence[str]
    answer: BagAnswer


def live_answer(rows: Sequence[TouchdownRow]) -> BagAnswer:
    """The answer of touchdowns that were recorded from the topics of a node."""
    stamps = [row.stamp for row in rows]
    touchdowns = [row_as_json(row) for row in rows]
    return {"bag": "live", "touchdowns": touchdowns, "begin": min(stamps, default=0), "end": max(stamps, default=0)}


def write_demo_page(path: Path, tosses: Shown, deck: Shown, robot: Shown) -> None:
    """Write the page, which needs no network and no other file; InputError where it cannot be written."""
    live, watched, walked = [ReplayFacts([one.answer]) for one in (tosses, deck, robot)]
    told = {one.question: one for facts in (watched, walked) for one in facts.headlines()}
    sections = (
        Section("tosses", tosses.title, tosses.sentences, [*skill(live).parts, *velocities(live, [live]).parts]),
        Section("deck", deck.title, deck.sentences, [chart_of("Deck and crate", deck.answer), *modes(watched).parts]),
        Section(
            "robot", robot.title, robot.sentences, [timeline("Stances", robot.answer, ""), *landings("", robot.answer)]
        ),
    )
    headlines = (
        twists(live),
        told["events warned of"]._replace(question="on the deck, events warned of"),
        told[FOUND]._replace(question="of the robot, landings found"),
    )
    title = "A cube, a crate and a robot: the next touchdown, before it happens"
    lead = "Predicted as samples came in; what happened stands beside it."
    write_text(path, page(title, lead, headlines, sections, script_inside()))


def twists(live: ReplayFacts) -> Headline:
    """How right whole twists are, beside simple answers, and how many were not scored."""
    score = next(iter(kind_scores(live.rows, {})[-1:]), None)
    if score is None:
        return Headline("of the tosses", "no touchdown scored", "")
    simple = ", ".join(
        f"{said} {part_words(of.p50)}" for said, of in zip(SIMPLE.values(), score.simple, strict=True) if of.number
    )
    counts = f"{len(live.rows) - score.errors.number:,} of {len(live.rows):,} touchdowns could not be scored"
    more = f"in the median of the whole twist; simple answers: {simple}. {counts}."
    return Headline("of the tosses, live: error", part_words(score.errors.p50), more)
