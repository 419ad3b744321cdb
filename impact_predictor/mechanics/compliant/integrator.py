"""Integration of stiff equations of contact up to an end that they reach, with every ending named. Needs scipy."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from enum import IntEnum
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import integrate

Array = NDArray[np.float64]
Rates = Callable[[float, Array], Any]

METHODS = ("Radau", "BDF", "LSODA", "DOP853", "RK45")
"""The integrators of scipy: three for stiff equations, two explicit ones for comparison."""

EXPLICIT = ("DOP853", "RK45")

HALVINGS = 40
"""Of the last step, to find the end in it."""


class Status(IntEnum):
    """How a run on compliant contacts ended; all but the first two give the state that was reached."""

    OVER = 0
    """It went to its end."""
    NO_IMPACT = 1
    """No contact is approached."""
    TIME_UP = 2
    """The contacts were not at peace within the longest time."""
    TOO_COSTLY = 3
    """The right-hand side was evaluated as often as allowed."""
    FAILED = 4
    """The integrator could not reach its tolerance."""
    INVALID_INPUT = 5
    """A number is not finite, or out of range."""


class Run(NamedTuple):
    """An integration: its status, the time and state at its end, the evaluations, and what it kept of the way: the
    times of its steps and a function of time for each step.
    """

    status: Status
    time: float
    state: Array
    evaluations: int
    times: list[float]
    steps: list[Any]


def run(
    rates: Rates,
    jacobian: Callable[[float, Array], Array],
    state: Array,
    longest: float,
    method: str,
    tolerances: tuple[float, float | Array],
    evaluations: int,
    remaining: Callable[[float, Array], float] | None = None,
    keep: bool = False,
    start_time: float = 0.0,
    longest_step: float = inf,
) -> Run:
    """Integrate until `remaining` of time and state falls to zero, or without it for the time `longest`.

    `tolerances` are relative and absolute; `method` is one of `METHODS`. The way is kept if asked.
    """
    options: dict[str, Any] = {"rtol": tolerances[0], "atol": tolerances[1], "max_step": longest_step}
    if method not in EXPLICIT:
        options["jac"] = jacobian
    # What the integrator has to say of its troubles, the status says.
    with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
        solver = getattr(integrate, method)(rates, start_time, state, start_time + longest, **options)
        times, steps = [start_time], []
        status, time = Status.TIME_UP if remaining else Status.OVER, start_time
        while solver.status == "running":
            try:
                solver.step()
            except (ArithmeticError, ValueError):  # a number beyond the range of floats, or an angle that is none
                status = Status.FAILED
                break
            if solver.status == "failed" or not np.isfinite(solver.y).all():
                status = Status.FAILED
                break
            time, state = float(solver.t), solver.y
            ended = remaining is not None and remaining(time, state) <= 0.0
            if keep or ended:
                step = solver.dense_output()
            if ended and remaining is not None:
                status = Status.OVER
                time = _end(remaining, step, times[-1], time)
                state = step(time)
            times.append(time)
            if keep:
                steps.append(step)
            if ended:
                break
            if solver.nfev > evaluations:
                status = Status.TOO_COSTLY
                break
    return Run(status, time, state, int(solver.nfev), times, steps)


def _end(remaining: Callable[[float, Array], float], step: Any, low: float, high: float) -> float:
    """When `remaining` falls to zero within a step at the end of which it has."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if remaining(middle, step(middle)) > 0.0:
            low = middle
        else:
            high = middle
    return high
