"""What could not be used of bags, and what the scene left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

from ....prediction.features import features_of
from ....prediction.remedies import REMEDIES
from ....prediction.types import Status
from ....wording import counted
from ...summary import WHY, without_bag, words
from ..sections import Cell, Section, Table
from ..words import share
from .answers import Answer, names_of, refused, uncompared, used

LISTED: Final = 40
"""Remarks that are listed, the commonest."""


def unused(answers: Sequence[Answer]) -> Section:
    """The section of what could not be used."""
    tables = [*refused_tables(answers), *uncompared_tables(answers), *remarks_tables(answers)]
    return Section("unused", "What could not be used", words_of(answers), tables=tables)


def words_of(answers: Sequence[Answer]) -> list[str]:
    """How much was refused, damaged and failed."""
    found, lost = used(answers), refused(used(answers))
    all_samples = sum(answer["samples"] for answer in found)
    said = [
        f"Of {counted(all_samples, 'sample')} none was refused, nor any other message."
        if not lost
        else f"{counted(sum(one.number for one in lost), 'message')} could not be used."
    ]
    damaged = sum("damaged" in answer for answer in answers)
    if damaged:
        said.append(f"{counted(damaged, 'bag')} could be read in part only: what was lost stands below.")
    else:
        said.append("No bag was damaged." if len(answers) > 1 else "The bag was not damaged.")
    return [" ".join(said)]


def refused_tables(answers: Sequence[Answer]) -> list[Table]:
    """Refused messages by input and reason, and what to do about each."""
    lost = refused(used(answers))
    if not lost:
        return []
    rows = [
        [
            Cell(one.input, words(one.status)),
            Cell(REMEDIES[Status[one.status]] if one.status in Status.__members__ else ""),
            Cell(f"{one.number:,}", f"of {one.all:,}, {share(one.number / one.all)}"),
        ]
        for one in lost
    ]
    return [Table("Messages that were refused, by input and reason.", ["input", "what is wrong", "messages"], rows, 2)]


def uncompared_tables(answers: Sequence[Answer]) -> list[Table]:
    """Touchdowns that are not compared with what was measured, by reason."""
    reasons = uncompared(used(answers))
    if not reasons:
        return []
    rows = [[Cell(WHY[flag]), Cell(f"{number:,}")] for flag, number in reasons.most_common()]
    several = "; some have several reasons" if len(reasons) > 1 else ""
    return [Table(f"Why touchdowns are not compared with what was measured{several}.", ["reason", "touchdowns"], rows)]


def remarks_tables(answers: Sequence[Answer]) -> list[Table]:
    """Damage, failures and notes, each with the bags that it was said of."""
    of: dict[tuple[str, str], list[str]] = {}
    for name, answer in zip(names_of(answers), answers, strict=True):
        for kind in ("error", "unpredictable", "damaged"):
            if answer.get(kind):
                of.setdefault((KINDS[kind], answer[kind]), []).append(name)
        for note in answer.get("notes", ()):
            of.setdefault((KINDS["notes"], without_bag(note, answer["bag"])), []).append(name)
    if not of:
        return []
    kinds = Counter(kind for kind, _ in of)
    ordered = sorted(of.items(), key=lambda one: (list(KINDS.values()).index(one[0][0]), -len(one[1])))
    rows = [
        [Cell(names[0], f"and {counted(len(names) - 1, 'more bag')}" if len(names) > 1 else kind), Cell(said)]
        for (kind, said), names in ordered[:LISTED]
    ]
    more = len(ordered) - len(rows)
    caption = f"What was said of the bags ({', '.join(f'{count:,} {kind}' for kind, count in kinds.items())})."
    caption += f" The first {LISTED:,} of {len(ordered):,}." if more else ""
    return [Table(caption, ["bag", "remark"], rows, 2)]


KINDS: Final = {"error": "unreadable", "unpredictable": "nothing predicted", "damaged": "damaged", "notes": "note"}
"""The kinds of remarks, by their keys in the answers; the gravest first."""


def scene(values: Mapping[str, Any] | None) -> Section | None:
    """The section of the scene's parts, from all its parameters; None where these are not known."""
    if values is None:
        return None
    features = sorted(features_of(values), key=lambda feature: not feature.on)
    features = [feature for feature in features if feature.name != "events executor"]
    rows = []
    for one in features:
        state = "on" if one.on else "off"
        rows.append([Cell(one.name, "" if one.on else "left out", state), Cell(one.why, "", state)])
    left_out = sum(not one.on for one in features)
    words = (
        f"The predictor took in {len(features) - left_out} of its parts for this scene and left out {left_out}, in "
        "grey. What is left out costs nothing; where a body needs it, the parameter that is named switches it on."
    )
    return Section("scene", "What the scene left out", [words], tables=[Table("", ["part", "why"], rows, 2)])
