"""The section on what a scene does not need: which parts are on, what each costs, and the gain against all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from .data import Entry
from .sections import Cell, Section, Table
from .words import digits, time_words

COSTS: Final = {"us_per_sample": "per sample", "start_ms": "start", "start_mb": "memory"}
"""What a part costs: the names in the report, and in a table."""


def parts(report: Entry) -> Section | None:
    """The parts of each shipped scene; None where the report has none."""
    scenes = report.get("parts") or []
    if not scenes:
        return None
    words = (
        "A scene pays only for the parts that its parameters ask for; the others are not even imported. Each part "
        "costs time for each sample of the body's motion, and time and memory when the program starts. What a part "
        "that is off would add stands in grey."
    )
    inner = [of_scene(scene) for scene in scenes]
    return Section("parts", "What a scene does not need", [words], tables=[overview(scenes)], sections=inner)


def overview(scenes: Sequence[Entry]) -> Table:
    """All scenes, each against all parts on."""
    rows = []
    for scene in scenes:
        on = sum(part["on"] for part in scene["parts"])
        count = Cell(scene["scene"], f"{on} of {len(scene['parts'])} parts on")
        rows.append([count, *(gain(scene, scene["all_on"], key) for key in COSTS)])
    caption = (
        "Each scene as it is, and below each number what it would be with every part on, and how many times that is."
    )
    return Table(caption, ["scene", *COSTS.values()], rows, cards=True)


def gain(mine: Mapping[str, Any], full: Mapping[str, Any], key: str) -> Cell:
    """What a scene costs, and how many times that all parts would."""
    if mine[key] is None or full[key] is None:
        return Cell(cost(mine[key], key))
    ratio = f", {digits(full[key] / mine[key])} ×" if mine[key] > 0.0 else ""
    return Cell(cost(mine[key], key), f"all on {cost(full[key], key)}{ratio}")


def cost(number: float | None, key: str) -> str:
    """A cost with its unit; a part may save something, and then its cost is negative."""
    if number is None:
        return "–"
    size = abs(number)
    if key == "start_mb":
        words = f"{digits(size)} MB" if size >= 0.05 else "0"
    else:
        us = size if key == "us_per_sample" else 1e3 * size
        words = time_words(us) if us >= 0.05 else "0"
    return f"−{words}" if number < 0.0 and words != "0" else words


def of_scene(scene: Entry) -> Section:
    """The parts of one scene, those that are on first."""
    rows = []
    for part in sorted(scene["parts"], key=lambda part: not part["on"]):
        state = "on" if part["on"] else "off"
        costs = [Cell(cost(part[key], key), "", "empty" if part[key] is None else state) for key in COSTS]
        rows.append([Cell(part["name"], state, state), Cell(part["why"], "", state), *costs])
    node = scene.get("node") or {}
    rows.append(total("as it is", scene, node, "total"))
    rows.append(total("every part on", scene["all_on"], node.get("all_on", {})))
    table = Table("", ["part", "why", *COSTS.values()], rows, words=2, cards=True)
    return Section(f"parts-{scene['scene']}", scene["scene"], words_of(scene), tables=[table], summary=summary(scene))


def summary(scene: Entry) -> str:
    """The parts that are on, by name."""
    return ", ".join(part["name"] for part in scene["parts"] if part["on"])


def total(name: str, whole: Mapping[str, Any], node: Mapping[str, Any], css_class: str = "") -> list[Cell]:
    """What a scene costs as a whole, and below it with what ROS adds, where that is known."""
    costs = [Cell(cost(whole[key], key), f"{cost(node[key], key)} with ROS" if key in node else "") for key in COSTS]
    return [Cell(name, "", css_class), Cell("", "", "empty"), *costs]


def words_of(scene: Entry) -> list[str]:
    """Over what the costs of a scene are measured, and what it pays only while somebody listens."""
    words = [f"Measured: {record.removesuffix('.')}."] if (record := scene.get("record")) else []
    if outputs := scene.get("outputs"):
        said = ", ".join(f"{name} {time_words(us)}" for name, us in outputs.items())
        words.append(f"Messages of the node, only while somebody subscribes: {said}.")
    return words
