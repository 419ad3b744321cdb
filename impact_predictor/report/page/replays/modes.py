"""The modes that were predicted against the true ones, or what can be told of them without a truth."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Final

from ....wording import counted
from ...summary import summarize
from ..looks import marker_svg
from ..sections import Cell, Key, Section, Table
from .answers import NOTHING, Answer, confusion, landings_of, scored_of, touchdowns_of
from .words import MODES, SAYS, percent

UNTOLD: Final = (
    "The record does not tell in which modes the bodies truly went on, and its velocities do not either: whether a "
    "contact lifts shows in the vertical velocity, in which an impact is lost among what gravity and other contacts do "
    "before the next samples. What can be checked is how well the velocities agree that are told with each mode."
)
UNTOLD_FEET: Final = (
    "The record tells when feet stand, not what their impacts do: the modes of landings are predictions alone. In the "
    "table they are of an impact with the speed of the foot in its last sample in the air."
)


def modes(answers: Sequence[Answer]) -> Section | None:
    """The section of modes; None where nothing was predicted."""
    if not touchdowns_of(answers):
        return None
    counts = confusion(answers)
    landings = landings_of(answers)
    told = {one["landing_mode"] for one in landings} or {one["mode"] for one in touchdowns_of(answers)}
    known = {mode for pair in counts for mode in pair} | told
    key = [Key(marker_svg(looks), mode, SAYS[mode]) for mode, looks in MODES.items() if mode in known]
    if counts:
        return Section("modes", "Predicted against true modes", words_of(counts), key, [confusion_table(counts)])
    if landings:
        ahead = Counter(one["mode"] for one in landings)
        said = ", ".join(f"{ahead[mode]:,} {mode}" for mode in MODES if ahead[mode])
        words = [UNTOLD_FEET, f"As they were foretold, with the speed that was expected at the ground: {said}."]
        return Section("modes", "Modes of the landings", words, key, [landing_table(landings)])
    return Section("modes", "Predicted modes", [UNTOLD], key, [agreement_table(answers)])


def words_of(counts: Counter[tuple[str, str]]) -> list[str]:
    """How many modes are right."""
    found = {pair: count for pair, count in counts.items() if NOTHING not in pair}
    right, all_found = sum(count for (true, told), count in found.items() if true == told), sum(found.values())
    missed = sum(count for (_, told), count in counts.items() if told == NOTHING)
    false = sum(count for (true, _), count in counts.items() if true == NOTHING)
    said = f"The mode is right in {right:,} of the {counted(all_found, 'true touchdown')} that were found."
    rest = [f"{missed:,} missed" if missed else "", counted(false, "false alarm") if false else ""]
    besides = ", ".join(one for one in rest if one)
    return [f"{said} Besides: {besides}." if besides else said]


def confusion_table(counts: Counter[tuple[str, str]]) -> Table:
    """A row for each true mode, a column for each predicted one; what is right is marked."""
    order = [*MODES, NOTHING]
    true = [mode for mode in order if any(pair[0] == mode for pair in counts)]
    told = [mode for mode in order if any(pair[1] == mode for pair in counts)]
    rows = [
        [Cell("false alarm" if one == NOTHING else one), *(confusion_cell(counts, one, other) for other in told)]
        for one in true
    ]
    head = ["true mode", *("missed" if mode == NOTHING else mode for mode in told)]
    caption = "How many touchdowns of each true mode (a row) were predicted in which mode (a column)."
    return Table(caption, head, rows, cards=len(told) > 3)


def confusion_cell(counts: Counter[tuple[str, str]], true: str, told: str) -> Cell:
    """How many touchdowns of a true mode were predicted in which."""
    number = counts[true, told]
    return Cell(f"{number:,}" if number else "–", "", "best" if true == told != NOTHING else "" if number else "none")


def agreement_table(answers: Sequence[Answer]) -> Table:
    """How many touchdowns were predicted in each mode, and how well the velocities agree of those that are compared."""
    together: dict[str, list[float]] = defaultdict(list)
    for one in scored_of(answers):
        together[one["mode"]].append(one["relative_error"])
    all_modes = Counter(one["mode"] for one in touchdowns_of(answers))
    rows = []
    for mode in MODES:
        if all_modes[mode]:
            errors = summarize(together[mode])
            cells = [Cell(f"{all_modes[mode]:,}"), Cell(f"{errors.number:,}"), Cell(percent(errors.median))]
            rows.append([Cell(mode), *cells, Cell(percent(errors.p90))])
    return Table("", ["predicted mode", "touchdowns", "compared", "median error", "90 % below"], rows, cards=True)


def landing_table(landings: Sequence[Answer]) -> Table:
    """How many landings of each foot were predicted in which mode."""
    counts = Counter((one["foot"], one["landing_mode"]) for one in landings if one["landing_mode"])
    told = [mode for mode in MODES if any(pair[1] == mode for pair in counts)]
    feet = list(dict.fromkeys(one["foot"] for one in landings))
    rows = [[Cell(foot), *(Cell(f"{counts[foot, mode]:,}") for mode in told)] for foot in feet]
    return Table("Landings of each foot by the mode that its impact is predicted to have.", ["foot", *told], rows)
