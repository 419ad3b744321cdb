"""Numbers within limits, as the values of options; what is none is refused in words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

N = TypeVar("N", int, float)


class Whole(click.IntRange):
    """A whole number within limits."""

    name = "integer"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The number that is meant.

        Raises:
            click.BadParameter: it is none, or beyond the limits.
        """
        return _converted(super().convert, self, "a whole number", value, param, ctx)


class Number(click.FloatRange):
    """A number within limits."""

    name = "float"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number that is meant.

        Raises:
            click.BadParameter: it is none, or beyond the limits.
        """
        return _converted(super().convert, self, "a number", value, param, ctx)


def _converted(
    convert: Callable[..., N],
    limits: click.IntRange | click.FloatRange,
    what: str,
    value: Any,
    param: click.Parameter | None,
    ctx: click.Context | None,
) -> N:
    try:
        number = convert(value, param, ctx)
    except click.BadParameter:
        number = None
    # Limits do not keep out what is not a number.
    if number is None or number != number:
        limits.fail(f"{value!r} is not {what} {_words(limits)}", param, ctx)
    return number


def _words(limits: click.IntRange | click.FloatRange) -> str:
    """The limits, in words."""
    if limits.max is None:
        return f"of {limits.min:g} or more"
    if limits.min_open and limits.max_open:
        return f"between {limits.min:g} and {limits.max:g}"
    return f"from {limits.min:g} to {limits.max:g}"
