"""The page of a replay, made from the JSON answers of its bags alone: its title, its headlines and its sections."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, Final

from ...scenarios.matching import NEAREST
from ...stamps import NANOSECONDS
from ...wording import counted
from ..summary import WHY, SpanErrors, quantile
from . import compared, found, sections
from .document import Headline, page, script_beside, script_inside, time_words, within_words, write_html
from .found import BagAnswer

LEAST_LEAD_TIME: Final = 0.02
"""Seconds before a touchdown, from which on the errors of the times are given."""


COST: Final = "At what cost"


def write_replay_page(
    path: str | os.PathLike[str], answers: Sequence[BagAnswer], values: Mapping[str, Any] | None = None
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
    write_html(Path(path), page_of_replay(answers, values))


def write_replay_pages(
    folder: str | os.PathLike[str], answers: Sequence[BagAnswer], values: Mapping[str, Any] | None = None
) -> None:
    """Write a folder: index.html about all bags, a page for each, and one file of plotly's script that they share.

    Raises:
        InputError: a file cannot be written.
    """
    folder = Path(folder)
    script = script_beside(folder)
    links = {}
    for place, answer in enumerate(answers):
        if "error" not in answer:
            # The name of a bag is no name of a file: it comes from elsewhere.
            links[place] = f"bag-{place + 1}.html"
            write_html(folder / links[place], page_of_replay([answer], values, script))
    write_html(folder / "index.html", page_of_replay(answers, values, script, links))


def page_of_replay(
    answers: Sequence[BagAnswer],
    values: Mapping[str, Any] | None = None,
    script: str | None = None,
    links: Mapping[int, str] | None = None,
) -> str:
    """The page as HTML; `script` is plotly's, inside unless given, `links` where the bags lead, by their places."""
    places = [k for k, one in enumerate(answers) if one.get("touchdowns") or one.get("true_touchdowns")]
    drawn = sorted(found.worst_of(answers, places, sections.DRAWN))
    all_sections = (
        sections.bags(answers, links or {place: f"#bag-{place + 1}" for place in drawn}),
        sections.when(answers, drawn),
        compared.velocities(answers),
        compared.modes(answers),
        sections.lead_times(answers),
        sections.cost(answers),
        sections.unused(answers),
        sections.scene(values),
    )
    there = [section for section in all_sections if section is not None]
    script = script_inside() if script is None else script
    return page(title_of(answers), [lead_of(answers)], headlines_of(answers), there, script)


def title_of(answers: Sequence[BagAnswer]) -> str:
    """How many touchdowns, how right and how early, in one line."""
    said = [one.answer for one in headlines_of(answers) if one.question != COST]
    return f"Touchdowns: {', '.join(said)}" if said else "No touchdown was predicted"


def error_at(answers: Sequence[BagAnswer]) -> SpanErrors | None:
    """The errors in s of the times told 20 ms ahead or somewhat more; None where nothing tells the true ones."""
    spans = found.errors_ahead(answers, "time_errors_ahead")
    return next((one for one in spans if one.begin >= LEAST_LEAD_TIME and one.errors.number), None)


def lead_of(answers: Sequence[BagAnswer]) -> str:
    """Which bags these are."""
    samples = counted(sum(answer["samples"] for answer in found.used(answers)), "sample")
    if len(answers) > 1:
        failed = sum("error" in answer for answer in answers)
        unread = f"; {failed:,} of them could not be read" if failed else ""
        return f"{len(answers):,} records, {samples}, went through the predictor as if they came live{unread}."
    begin, end = (answers[0].get(name) for name in ("begin", "end"))
    over = "" if begin is None or end is None else f" over {time_words((end - begin) / NANOSECONDS)}"
    return f"The record {found.names_of(answers)[0]}, {samples}{over}, went through the predictor as if it came live."


def headlines_of(answers: Sequence[BagAnswer]) -> list[Headline]:
    """How many touchdowns, how right, how early, and at what cost."""
    if next(found.touchdowns_of(answers), None) is None:
        return []
    known = [_many(answers), _right(answers), _early(answers), _cost(answers)]
    return [one for one in known if one is not None]


def _many(answers: Sequence[BagAnswer]) -> Headline:
    there, landings = found.found_of(answers), list(found.landings_of(answers))
    if there is None and landings:
        number, of = sum(one["time_error"] is not None for one in landings), counted(len(landings), "landing")
        all_of = of if number == len(landings) else f"{number:,} of {of}"
        return Headline("How many", f"{all_of} announced", "Their motion shows when feet landed.")
    if there is None:
        number, reasons = sum(1 for _ in found.scored_of(answers)), found.uncompared(answers)
        others = sum(1 for _ in found.touchdowns_of(answers)) - number
        because = "because" if len(reasons) == 1 else "most often because"
        said = "".join(f", {because} {WHY[reason]}" for reason, _ in reasons.most_common(1))
        more = f"{others:,} more could not be{said}." if others else "That is all that were predicted."
        return Headline("How many", f"{number:,} compared with measured velocities", more)
    missed = there.there - there.found
    alarms = counted(there.false, "false alarm") if there.false else "no false alarm"
    more = f"{f'{missed:,}' if missed else 'None'} missed, {alarms}."
    if missed:
        more += f" A touchdown is found where a prediction before it gave its time to {NEAREST / 1e6:.0f} ms."
    truths = [answer["truth"] for answer in found.used(answers) if "truth" in answer]
    if unseen := sum(truth["unresolved"] for truth in truths):
        more += f" {counted(unseen, 'more impact')} cannot be seen in the samples: too slow, or too soon after another."
    if len(truths) < (all_bags := sum(1 for _ in found.used(answers))):
        more += f" The truth is known of {len(truths):,} of {all_bags:,} bags."
    return Headline("How many", f"{there.found:,} of {there.there:,} found", more)


def _right(answers: Sequence[BagAnswer]) -> Headline | None:
    errors, time, counts = found.velocity_errors(found.used(answers)), error_at(answers), found.confusion(answers)
    span = "" if time is None else f"{time.begin * 1e3:.0f} to {time.end * 1e3:.0f} ms ahead"
    if errors.number:
        truths = [("truth" in answer) for answer in found.used(answers)]
        of = "the true ones" if any(truths) else "the measured ones"
        of += ", or the measured ones where a bag does not tell them" if any(truths) and not all(truths) else ""
        more = (
            f"So close are half of the velocities after the impact to {of}; 90 % are within {within_words(errors.p90)}."
        )
        if counts:
            right = sum(count for (true, predicted), count in counts.items() if true == predicted)
            both = sum(count for pair, count in counts.items() if found.NOTHING not in pair)
            more += f" The mode is right in {right:,} of {both:,}."
        if time is not None:
            more += f" The time predicted {span} is {time_words(time.errors.p50)} wrong in the median."
        return Headline("How right", f"velocities within {within_words(errors.p50)}", more)
    if time is None:
        return None
    more = f"So close are half of the times that were predicted {span}; 90 % are within {time_words(time.errors.p90)}."
    return Headline("How right", f"times within {time_words(time.errors.p50)}", more)


def _early(answers: Sequence[BagAnswer]) -> Headline | None:
    times = found.announced(answers)
    if not times:
        return None
    more = f"The first prediction of each, in the median. 90 % came at least {time_words(quantile(times, 0.1))} ahead"
    latest = "only as it happened" if min(times) < 1e-6 else f"{time_words(min(times))} ahead"
    return Headline("How early", f"{time_words(median(times))} ahead", f"{more}, the latest one {latest}.")


def _cost(answers: Sequence[BagAnswer]) -> Headline | None:
    spread = found.costs(answers)
    if spread.p50 is None or spread.p99 is None:
        return None
    more = f"In the median, without reading and writing; 99 % take less than {time_words(1e-6 * spread.p99)}."
    return Headline(COST, f"{time_words(1e-6 * spread.p50)} a sample", more)
