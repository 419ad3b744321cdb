"""Errors and CPU times of methods on the problems of a scene."""

from __future__ import annotations

import gc
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from statistics import median
from time import process_time_ns
from typing import Any, NamedTuple

from .methods import Answer, Method, Problem

SPAN = 200_000
"""ns of calls that are timed together, or one call that takes longer: far above the resolution of the clock."""


class Effort(NamedTuple):
    """How much a method may be measured on a scene: seconds for the answers, seconds for the repetitions, and in how
    many rounds.
    """

    answering: float
    timing: float
    rounds: int


class Measured(NamedTuple):
    """A method on the first problems of a scene: its answers, None where it has none, and us per prediction.

    `us` are the medians over the rounds, for each problem; for all problems together one for each round.
    """

    method: Method
    answers: list[Answer]
    us: list[float]


@contextmanager
def undisturbed() -> Iterator[None]:
    """Without the garbage collector and without warnings of methods that lose their way."""
    collects = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        if collects:
            gc.enable()


def measure(
    methods: Sequence[Method], problems: Sequence[Problem], effort: Effort, tell: Callable[[], None] = lambda: None
) -> list[Measured]:
    """Answers and times of every method that applies to the problems; what it applies to in part it does not meet.

    The methods take turns, so that a slow moment of the machine meets all of them. One that is slow gets fewer
    problems, the first ones, and at least one.
    """
    with undisturbed():
        runs = []
        for each in methods:
            if all(map(each.applies, problems)):
                runs.append(Together(each, problems) if each.answers_of else Run(each, problems, effort))
            tell()
        for _ in range(effort.rounds):
            for run in runs:
                run.repeat(effort)
    return [run.measured() for run in runs]


class Run:
    """A method on one problem after the other."""

    def __init__(self, method: Method, problems: Sequence[Problem], effort: Effort) -> None:
        self.method = method
        self.calls: list[Callable[[], Answer]] = []
        self.answers: list[Answer] = []
        self.times: list[list[float]] = []
        self.cost = 0.0
        began = process_time_ns()
        for problem in problems:
            call = prepared(method, problem)
            ns, answer = timed(call)
            self.calls.append(call)
            self.answers.append(answer)
            self.times.append([ns])
            if process_time_ns() - began > effort.answering * 1e9:
                break

    def repeat(self, effort: Effort) -> None:
        """Time the problems once more, as many as there is time for."""
        least = [min(times) for times in self.times]
        left = effort.timing * 1e9 / effort.rounds
        for index, call in enumerate(self.calls):
            repeats = max(1, round(SPAN / max(1.0, least[index])))
            left -= repeats * least[index]
            if left < 0.0:
                break
            began = process_time_ns()
            try:
                for _ in range(repeats):
                    call()
            except Exception:  # it failed the first time, too
                continue
            self.times[index].append((process_time_ns() - began) / repeats)

    def measured(self) -> Measured:
        # The first call warms up: it counts only where there was no time for another.
        us = [median(times[1:] or times) * 1e-3 for times in self.times]
        return Measured(self.method, self.answers, us)


class Together(Run):
    """A method on all problems at once."""

    def __init__(self, method: Method, problems: Sequence[Problem]) -> None:
        self.method, self.count = method, len(problems)
        call = prepared(method, problems)
        timed(call)  # compiles
        ns, found = timed(call)
        self.calls, self.times = [call], [[ns, ns]]
        assert method.answers_of is not None
        self.answers = [None] * self.count if found is None else method.answers_of(found)

    def measured(self) -> Measured:
        return Measured(self.method, self.answers, [ns * 1e-3 / self.count for ns in self.times[0][1:]])


def prepared(method: Method, problem: Any) -> Callable[[], Answer]:
    """What is timed; a method that breaks before answers None, too."""
    try:
        return method.prepare(problem)
    except Exception:  # as in `timed`
        return lambda: None


def timed(call: Callable[[], Answer]) -> tuple[int, Answer]:
    """ns of CPU time, and the answer: None from a method that breaks, which must not break the report."""
    began = process_time_ns()
    try:
        answer = call()
    except Exception:  # whatever a method raises, it has no answer
        answer = None
    return process_time_ns() - began, answer
