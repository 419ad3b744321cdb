"""Options of several commands, the numbers that options take, and the examples at the end of the help of a command."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import inf, isfinite, radians
from typing import Any, Final, TypeVar

import click
from click.core import ParameterSource

from ..errors import InputError
from ..mechanics.bodies import refuse
from ..mechanics.impact import LAWS

F = TypeVar("F", bound=Callable[..., Any])


ACUTE: Final[dict[str, Any]] = {
    "type": click.FloatRange(-90.0, 90.0, min_open=True, max_open=True),
    "metavar": "DEGREES",
}
"""An angle of less than a right one."""


def within(allowed: Callable[[Any], bool], wanted: str) -> dict[str, Any]:
    """A range of the numbers that an option takes, as an argument of `number`; one that is not given passes."""

    def check(context: click.Context, option: click.Parameter, value: Any) -> Any:
        if value is not None:
            refuse({option.opts[0].removeprefix("--"): value}, allowed, wanted)
        return value

    return {"callback": check}


POSITIVE: Final = within(lambda value: 0.0 < value < inf, "a finite number above 0")
FROM_0: Final = within(lambda value: value >= 0.0, "a number from 0")
FINITE: Final = within(isfinite, "a finite number")


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
    return click.option("--seed", type=click.IntRange(min=0), default=default, show_default=True, help=help_text)


def together(*options: Callable[[Any], Any]) -> Callable[[F], F]:
    """Several options, in the order in which the help shows them."""

    def decorate(command: F) -> F:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def refuse_given(names: Iterable[str], why: str) -> None:
    """Refuse options, by the names of their values, that would change nothing, with a reason; UsageError where one was
    given.
    """
    context = click.get_current_context()
    for name in names:
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            raise click.UsageError(f"--{name.replace('_', '-')} {why}")


BAGS: Final = click.argument("bags", nargs=-1, required=True, metavar="BAG...")
LAW: Final = choice("--law", "Impact law.", *LAWS, default="path")
PARAMS: Final = text("--params", "FILE", "ROS 2 parameter file of the scene.", required=True)


def remap_option(help_text: str) -> Callable[[F], F]:
    """The option that gives topics to inputs."""
    return text("-r", "--remap", "FROM:=TO", help_text, multiple=True)


def edge_options(default: float | None) -> Callable[[F], F]:
    """The options that tell on which edges a cylinder lies."""
    says = "Central angle of the old edge, A, behind the vertical, degrees."
    ahead = "Central angle of the new edge, B, ahead of the vertical, degrees (--gamma unless given)."
    return together(number("--gamma", says, default, required=default is None), number("--gamma-new", ahead))


def edges_of(gamma: float, gamma_new: float | None) -> tuple[float, float]:
    """The central angles of both edges in rad; InputError where no cylinder lies on such edges."""
    ahead = gamma if gamma_new is None else gamma_new
    if not 0.0 < gamma + ahead < 180.0:
        if gamma_new is None:
            raise InputError(f"--gamma is {gamma:g}, for both edges; give degrees between 0 and 90")
        raise InputError(f"--gamma and --gamma-new have the sum {gamma + ahead:g}; give degrees between 0 and 180")
    return radians(gamma), radians(ahead)


def examples(*lines: str) -> str:
    """The epilog of a command's help; click wraps no paragraph that begins with a backspace."""
    return "\n  ".join(("\b\nExamples:", *lines))
