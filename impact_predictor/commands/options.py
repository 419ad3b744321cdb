"""Options of several commands, the numbers that options take, and the examples at the end of the help of a command."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from ..mechanics.impact import LAWS

if TYPE_CHECKING:
    ParamType = click.ParamType[Any]
else:
    ParamType = click.ParamType

F = TypeVar("F", bound=Callable[..., Any])


class _InWords(ParamType):
    """Numbers within limits; what is none is refused in words."""

    what: str

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number that is meant.

        Raises:
            click.BadParameter: it is none, or beyond the limits.
        """
        try:
            number = super().convert(value, param, ctx)
        except click.BadParameter:
            number = None
        # Limits do not keep out what is not a number.
        if number is None or number != number:
            self.fail(f"{value!r} is not {self.what} {_limits(self)}", param, ctx)
        return number


class Whole(_InWords, click.IntRange):
    """A whole number within limits."""

    name = "integer"
    what = "a whole number"


class Real(_InWords, click.FloatRange):
    """A number within limits."""

    name = "float"
    what = "a number"


def _limits(kind: Any) -> str:
    """The limits of a number, in words."""
    if kind.max is None:
        return f"of {kind.min:g} or more"
    if kind.min_open and kind.max_open:
        return f"between {kind.min:g} and {kind.max:g}"
    return f"from {kind.min:g} to {kind.max:g}"


ACUTE: Final[dict[str, Any]] = {"type": Real(-90.0, 90.0, min_open=True, max_open=True), "metavar": "DEGREES"}
"""An angle of less than a right one."""


def number(name: str, help_text: str, default: float | None = None, **more: Any) -> Callable[[F], F]:
    """An option that takes one number."""
    # To click, a default of None is one too.
    given = {} if default is None else {"default": default}
    return click.option(name, **{"type": float, "show_default": True, "help": help_text, **given, **more})


def text(*declared: str, **more: Any) -> Callable[[F], F]:
    """An option that takes a name: what it is called, what stands for the name in the help, and what it says."""
    *names, metavar, says = declared
    return click.option(*names, metavar=metavar, help=says, **more)


def choice(name: str, help_text: str, *choices: str, default: str) -> Callable[[F], F]:
    """An option that takes one of several words."""
    return click.option(name, type=click.Choice(choices), default=default, show_default=True, help=help_text)


def json_flag(help_text: str = "Print JSON only.") -> Callable[[F], F]:
    """The option that asks for what a program may read."""
    return click.option("--json", "as_json", is_flag=True, help=help_text)


def seed_option(help_text: str, default: int = 0) -> Callable[[F], F]:
    """The option that tells one run by random numbers from another."""
    return click.option("--seed", type=Whole(min=0), default=default, show_default=True, help=help_text)


def together(*options: Callable[[Any], Any]) -> Callable[[F], F]:
    """Several options, in the order in which the help shows them."""

    def decorate(command: F) -> F:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


BAGS: Final = click.argument("bags", nargs=-1, required=True, metavar="BAG...")
LAW: Final = choice("--law", "Impact law.", *LAWS, default="path")
PARAMS: Final = text("--params", "FILE", "ROS 2 parameter file of the scene.", required=True)


def remap_option(help_text: str) -> Callable[[F], F]:
    """The option that gives topics to inputs."""
    return text("-r", "--remap", "FROM:=TO", help_text, multiple=True)


def examples(*lines: str) -> str:
    """The epilog of a command's help; click wraps no paragraph that begins with a backspace."""
    return "\n  ".join(("\b\nExamples:", *lines))
