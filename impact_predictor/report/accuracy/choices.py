"""Which method to choose for a wanted accuracy, and what the node uses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf
from statistics import mean

from ...prediction.impact import TOLERANCE
from ...prediction.points import ACCURACY
from .impact_methods import ACROSS
from .rows import ACCURACIES, ALL_SCENES, IMPACT, TOUCHDOWN, Choice, Default, Row, Scene

USED = {TOUCHDOWN: ("next_touchdown", f"tolerance = {ACCURACY:g}"), IMPACT: (ACROSS, f"tolerance = {TOLERANCE:g}")}
"""Method and setting that the node uses by default. Without slip across the plane it is the path law, to the bit."""


def choices_of(rows: Sequence[Row], scenes: Sequence[Scene]) -> list[Choice]:
    """For each scene and wanted accuracy the cheapest method; then for all computed scenes of a question together."""
    found = []
    for scene in scenes:
        if not scene.measured:
            there = [row for row in rows if (row.question, row.scene) == (scene.question, scene.name)]
            found += [Choice(scene.question, scene.name, wanted, cheapest(there, wanted)) for wanted in ACCURACIES]
    for question in dict.fromkeys(scene.question for scene in scenes):
        names = [scene.name for scene in scenes if scene.question == question and not scene.measured]
        everywhere = list(on_all([row for row in rows if row.question == question], names))
        found += [Choice(question, ALL_SCENES, wanted, cheapest(everywhere, wanted)) for wanted in ACCURACIES]
    return found


def cheapest(rows: Sequence[Row], wanted: float) -> Row | None:
    return min((row for row in rows if row.error <= wanted), key=lambda row: row.us, default=None)


def on_all(rows: Sequence[Row], scenes: Sequence[str]) -> Iterator[Row]:
    """The methods that answer on every scene, each with its mean cost and its largest errors."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row.scene in scenes:
            groups.setdefault((row.method, row.setting), []).append(row)
    for group in groups.values():
        if len(group) == len(scenes):
            worst = max(group, key=lambda row: row.error)
            yield worst._replace(
                scene=ALL_SCENES, us=mean(row.us for row in group), us_90=max(row.us_90 for row in group)
            )


def defaults_of(rows: Sequence[Row], scenes: Sequence[Scene]) -> dict[str, Default]:
    """What the node uses, with what this report says for it."""
    found = {}
    for question, (name, setting) in USED.items():
        names = [scene.name for scene in scenes if scene.question == question and not scene.measured]
        everywhere = list(on_all([row for row in rows if row.question == question], names))
        used = next((row for row in everywhere if (row.method, row.setting) == (name, setting)), None)
        if used is not None:
            found[question] = Default(name, setting, why(used, everywhere))
    return found


def why(used: Row, everywhere: Sequence[Row]) -> str:
    """A sentence on the method that is used, and on the ones that are cheaper or more accurate on all scenes."""
    said = f"Of every scene 90 % are within {used.error:.1g}, for {used.us:.0f} us in the mean of the scenes"
    others = (row for row in everywhere if row.us < used.us and row.method != used.method)
    cheaper = min(others, key=lambda row: row.error, default=None)
    if cheaper is None:
        return f"{said}; no other method that answers on all scenes is cheaper."
    error = f"is {cheaper.error:.1g} off" if cheaper.error < inf else "has no answer on some"
    name = f"{cheaper.method}, {cheaper.setting}" if cheaper.setting else cheaper.method
    return f"{said}; the most accurate of the other methods that are cheaper and apply to all, {name}, {error}."
