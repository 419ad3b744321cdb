"""What a method is to the report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

Problem = Any
Answer = Any

Solve = Callable[[Problem], Answer]
"""Answers a problem, or None where it has no answer."""


def always(problem: Problem) -> bool:
    """Of a method that is for every problem."""
    return True


@dataclass(frozen=True)
class Method:
    """A method with one setting.

    `prepare` makes of a problem the function without arguments that is timed: what a user would do once, such as
    building a model, is left out of the time. `applies` says whether a problem is of the kind that the method is for.
    A method with `answers_of` takes all problems of a scene at once; it makes the list of answers of what they gave.
    """

    family: str
    name: str
    setting: str
    prepare: Callable[[Any], Callable[[], Any]]
    applies: Callable[[Problem], bool] = always
    answers_of: Callable[[Any], list[Answer]] | None = None


def method(family: str, name: str, setting: str, solve: Solve, applies: Callable[[Problem], bool] = always) -> Method:
    """A method that needs no preparation."""
    return Method(family, name, setting, partial(partial, solve), applies)


def over(
    family: str, name: str, form: str, settings: Sequence[Any], solve: Callable[[Problem, Any], Answer], **kind: Any
) -> list[Method]:
    """A method over its settings, each the last argument of `solve`; `form` writes a setting."""

    def with_setting(setting: Any) -> Solve:
        return lambda problem: solve(problem, setting)

    return [method(family, name, form.format(setting), with_setting(setting), **kind) for setting in settings]
