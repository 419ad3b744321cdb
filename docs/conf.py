"""How Sphinx builds the site: `make docs`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import impact_predictor
from impact_predictor.parameters.table import PARAMETERS
from impact_predictor.parameters.types import Parameter, allowed
from impact_predictor.prediction.checks import REMEDIES
from impact_predictor.ros.messages.fields import TABLES
from impact_predictor.ros.messages.kinds import Field

project = "impact_predictor"
author = "impact_predictor maintainers"
project_copyright = "the impact_predictor maintainers, Apache-2.0"
release = impact_predictor.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
]
html_theme = "furo"
html_title = f"impact_predictor {release}"
myst_heading_anchors = 4
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_use_unqualified_type_names = True


sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    # An example is there to be copied: no notebooks, no archive, no times of this machine.
    "download_all_examples": False,
    "min_reported_time": 1e9,
    "show_memory": False,
    "write_computation_times": False,
    "show_signature": False,
}
# The last three are what rosdoc2 adds; index.md is its front page, too.
exclude_patterns = ["examples", "sg_execution_times.rst", "index.rst", "__readme_include.rst", "standard*"]


def row(parameter: Parameter) -> str:
    default = "" if parameter.default in (None, ()) else f"`{yaml(parameter.default)}`"
    said = parameter.description.replace("|", "\\|")
    return f"| `{parameter.name}` | {default} | {said} | {allowed(parameter)} |"


def yaml(value: Any) -> str:
    return json.dumps(list(value) if isinstance(value, tuple) else value)


def keys(field: Field) -> str:
    first, *others = field.kind.ends
    named = ", ".join([field.key + first, *others])
    return f"| `{named}` | {field.unit} | {field.meaning} |"


def keys_of(topic: str) -> str:
    """The tables of the keys on a topic."""
    found = ["| key | unit | meaning |", "| --- | --- | --- |"]
    for table in TABLES[topic]:
        found += [f"| **{table.title}** | | |", *map(keys, table.fields.values())]
    return "\n".join(found)


def messages() -> str:
    """The files of impact_predictor_msgs, each under its name."""
    files = sorted((Path(impact_predictor.__file__).parents[1] / "impact_predictor_msgs" / "msg").glob("*.msg"))
    return "\n\n".join([f"### {file.stem}\n\n```\n{file.read_text(encoding='utf-8')}```" for file in files])


def statuses() -> str:
    """The table of why a message is refused, and what to do."""
    rows = ["| | status | what is wrong | what to do |", "| --- | --- | --- | --- |"]
    for status, remedy in sorted(REMEDIES.items()):
        wrong, _, to_do = remedy.partition("; ")
        rows.append(f"| {status:d} | {status.name} | {wrong} | {to_do} |")
    return "\n".join(rows)


def fill(app: Any, page: str, source: list[str]) -> None:
    """Put tables where a page wants them; name by its path what is no page of the site."""
    table = ["| parameter | default | | may be |", "| --- | --- | --- | --- |", *map(row, PARAMETERS.values())]
    named = re.sub(r"\[([^\]]+)\]\(\.\./([\w/.-]+)\)", r"\1 (`\2`)", source[0])
    named = named.replace("<!-- parameters -->", "\n".join(table)).replace("<!-- statuses -->", statuses())
    for topic in TABLES:
        named = named.replace(f"<!-- keys of {topic} -->", keys_of(topic))
    source[0] = named.replace("<!-- messages -->", messages())


def is_field(app: Any, what: str, name: str, member: Any, skip: bool, options: Any) -> bool | None:
    """Leave out the fields of records: the text of the record tells of them, and they have none of their own."""
    return True if type(member).__name__ == "_tuplegetter" else None


def setup(app: Any) -> None:
    app.connect("autodoc-skip-member", is_field)
    app.connect("source-read", fill)
