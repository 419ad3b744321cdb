"""Pages of the package's templates: each is one file that opens without a network."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from ..files import whole


def render(template: str, **fields: Any) -> str:
    """A template of this package as HTML; all of its text is escaped."""
    environment = Environment(
        loader=PackageLoader(__package__),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(**fields)


def write(file: Path, page: str) -> None:
    """Write a page; an older one stays until it is whole.

    Raises:
        InputError: the file cannot be written.
    """
    with whole(file) as partial:
        partial.write_text(page, encoding="utf-8")
