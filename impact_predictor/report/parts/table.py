"""What a scene pays for and what it leaves out, as a table and sentences for the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from ...prediction.parts import EVENTS, PARTS
from ..table import plain_table
from .measure import COSTS

OF_NODE: Final = frozenset(part.name for part in PARTS if part.of_node)
WHY_SHORTEST: Final = 24
"""Characters below which a column is no longer read well."""

Costs = Mapping[str, Any]


def print_parts(console: Console, answer: Costs) -> None:
    """Print the answer of `impact_predictor.report.parts.measure_parts`."""
    console.print(
        f"[bold]{escape(answer['scene'])}[/]: what this scene pays for, and what it leaves out", highlight=False
    )
    console.print()
    console.print(parts_table(answer))
    console.print()
    for sentence in sentences(answer):
        console.print(escape(sentence), highlight=False)


def parts_table(answer: Costs) -> Table:
    """Every part: those of the scene, those left out with what they would add, and what the node has besides."""
    table = plain_table()
    table.add_column("\npart", no_wrap=True)
    table.add_column("")
    for header in ("each\nsample\nus", "at the\nstart\nms", "\nstart\nMB"):
        table.add_column(header, justify="right", no_wrap=True)
    table.add_column("\n\nwhy", min_width=WHY_SHORTEST)
    predictor = [part for part in answer["parts"] if part["name"] not in OF_NODE]
    node = [part for part in answer["parts"] if part["name"] in OF_NODE]
    for part in predictor:
        if part["on"]:
            _add(table, part)
    _add_total(table, "this scene", answer, "")
    left_out = [part for part in predictor if not part["on"]]
    for part in left_out:
        _add(table, part)
    if left_out:
        _add_total(table, "everything on", answer["all_on"], "")
        _add_total(table, "saved", _saved(answer), "by what this scene leaves out")
    if answer["node"] is not None:
        _add(table, _rest_of_node(answer, node))
    for part in node:
        _add(table, part)
    if answer["node"] is not None:
        _add_total(table, "this node", _whole_node(answer), "this scene in the node, without its outputs")
    return table


def _add(table: Table, part: Costs) -> None:
    cells = [_us(part, signed=not part["on"]), *[_number(part[cost], signed=not part["on"]) for cost in COSTS[1:]]]
    table.add_row(part["name"], "on" if part["on"] else "off", *cells, part["why"], style="" if part["on"] else "dim")


def _add_total(table: Table, name: str, costs: Costs, why: str) -> None:
    table.add_section()
    table.add_row(
        name, "", _us(costs), *[_number(costs[cost]) for cost in COSTS[1:]], why, style="bold", end_section=True
    )


def _rest_of_node(answer: Costs, parts: list[Costs]) -> Costs:
    """What the node needs beyond its predictor and its own parts."""
    node = answer["node"]
    on = [part for part in parts if part["on"]]
    return {
        "name": "node",
        "on": True,
        "us_per_sample": node["us_per_message"] - sum(part["us_per_sample"] or 0.0 for part in on),
        **{
            cost: node[cost] - answer[cost] - sum(part[cost] or 0.0 for part in on) for cost in ("start_ms", "start_mb")
        },
        "why": "ROS: its start, and taking a message from a topic and decoding it",
    }


def _whole_node(answer: Costs) -> Costs:
    node = answer["node"]
    return {**node, "us_per_sample": answer["us_per_sample"] + node["us_per_message"]}


def _saved(answer: Costs) -> Costs:
    every = answer["all_on"]
    return {**{cost: every[cost] - answer[cost] for cost in COSTS}, "us_scatter": every["us_scatter"]}


def _us(costs: Costs, signed: bool = False) -> str:
    """Microseconds for a sample: about none within their scatter; below 0 only the executor, which replaces another."""
    us, scatter = costs["us_per_sample"], costs.get("us_scatter")
    if us is not None and scatter is not None and (abs(us) <= scatter or (us < 0.0 and costs.get("name") != EVENTS)):
        return "~0"
    return _number(us, signed)


def _number(value: float | None, signed: bool = False) -> str:
    if value is None:
        return ""
    text = f"{value:,.0f}" if abs(value) >= 9.95 else f"{value:.1f}"
    text = "0.0" if text == "-0.0" else text
    return f"+{text}" if signed and value >= 0.0 else text


def sentences(answer: Costs) -> list[str]:
    """The totals in words, what the outputs cost, and how all this was measured."""
    total = "; ".join(
        f"{name}: {_words(costs)}"
        for name, costs in (("This scene", answer), ("everything on", answer["all_on"]), ("saved", _saved(answer)))
    )
    outputs = ", ".join(f"~/{name} {_number(us)}" for name, us in answer["outputs"].items())
    said = [
        f"{total}.",
        f"To encode an output costs more, but only while somebody subscribes to it (us for each sample): {outputs}.",
        f"Measured over {answer['record']}: CPU time, medians; memory beyond Python's own.",
        "~0 us is no more than the scatter of repeated runs. Below 0 an executor saves against the other one.",
        "A support that may move tells 100 times a second that it is at rest; its messages count with the samples.",
    ]
    if any(part["name"] == "feet" and part["on"] for part in answer["parts"]):
        said.append("The core is here that of a body over the same samples, its contact points fixed to it.")
    return said if answer["node"] is not None else [*said, f"{answer['why_no_node']}."]


def _words(costs: Costs) -> str:
    us, (ms, mb) = _us(costs), (_number(costs[cost]) for cost in COSTS[1:])
    return f"{us} us per sample, {ms} ms and {mb} MB at the start"
