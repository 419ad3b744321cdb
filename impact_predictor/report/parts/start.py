"""What the start of a scene costs, and of each of its parts: measured in processes of their own."""

from __future__ import annotations

import json
import marshal
import subprocess
import sys
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any, Final, NamedTuple

from ...errors import InputError
from ...prediction.parts import Part, Values
from ...ros.processes import ros_environment

Steps = Sequence[tuple[Part | None, Values]]

PROBE: Final = Path(__file__).with_name("start_probe.py")
EXPENSIVE: Final = 250.0
"""ms of a step that is measured once: it stands out from the noise."""
PATIENCE: Final = 120.0
"""Seconds, in which numba can compile."""
NO_ROS: Final = "ROS 2 is not here, so these are the costs of the library without the node"


class Start(NamedTuple):
    """CPU time in ms and memory in MB that something adds to a start."""

    ms: float
    mb: float


class Starts(NamedTuple):
    """What each step of a ladder adds to the start of a predictor, and of the node.

    `messages` are the microseconds in which the node receives and answers a message without a touchdown, with the
    executors single and events, `messages_scatter` that of their difference; `why_no_node` says why the node was not
    measured, or "".
    """

    predictor: list[Start]
    node: list[Start]
    messages: tuple[float, float] | None
    why_no_node: str
    messages_scatter: float = 0.0


def starts_of(steps: Steps, runs: int, tell: Callable[[float], None], first: int = 0) -> Starts:
    """Measure a ladder (see `impact_predictor.prediction.parts.ladder`); `tell` is told 0 to 100.

    The node starts with the `first` of the steps, which counts for those before it, too.
    """
    predictor, _ = _measured(steps, (), runs, lambda done: tell(0.35 * done))
    if find_spec("rclpy") is None:
        return Starts(predictor, [], None, NO_ROS)
    try:
        arguments = arguments_of(with_poses(steps[first][1]))
        node, messages = _measured(steps[first:], arguments, runs // 2 + 1, lambda done: tell(35 + 0.65 * done))
    except InputError as error:
        return Starts(predictor, [], None, str(error))
    single, events = zip(*messages, strict=True)
    added = [other - one for one, other in messages]
    node = [Start(0.0, 0.0)] * first + node
    return Starts(predictor, node, (median(single), median(events)), "", 0.5 * (max(added) - min(added)))


def _measured(
    steps: Steps, arguments: tuple[str, ...], runs: int, tell: Callable[[float], None]
) -> tuple[list[Start], list[tuple[float, float]]]:
    """The median of what each step adds (parts of the node: only with arguments), and what messages cost each time."""
    taken = [k for k, (part, _) in enumerate(steps) if not part or (arguments if part.of_node else part.modules)]
    found: list[list[Start]] = [[] for _ in steps]
    messages = []
    for run in range(runs):
        # The first step is what the others stand on.
        again = [k for k in taken if not k or not found[k] or found[k][0].ms < EXPENSIVE]
        *starts, last = _probe([_step(*steps[k]) for k in again], arguments)
        for k, start in zip(again, starts, strict=True):
            found[k].append(Start(*start))
        messages.append(last)
        tell(100 * (run + 1) / runs)
    return [Start(*map(median, zip(*one, strict=True))) if one else Start(0.0, 0.0) for one in found], messages


def _step(part: Part | None, values: Values) -> dict[str, Any] | str:
    return part.name if part is not None and part.of_node else dict(values)


def _probe(steps: Sequence[dict[str, Any] | str], arguments: tuple[str, ...]) -> list[tuple[float, float]]:
    """What each step adds in one process, and what a message costs there."""
    probe = subprocess.run(
        [sys.executable, str(PROBE), *arguments],
        input=marshal.dumps(list(steps)),
        capture_output=True,
        timeout=PATIENCE,
        env=ros_environment() if arguments else None,
    )
    numbers = [float(word) for word in probe.stdout.split()]
    if probe.returncode or len(numbers) != 2 * len(steps) + 2:
        said = probe.stderr.decode(errors="replace").strip().splitlines()
        raise InputError(f"the start cannot be measured: {said[-1] if said else f'status {probe.returncode}'}")
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def with_poses(values: Values) -> dict[str, Any]:
    """The values with a source of the pose of each body: without one, a node that watches nothing has nothing to do."""
    own = [f"{body}.source" for body in values["bodies"]]
    return {**values, **{name: "odom" for name in ("source", *own) if name in values}}


def arguments_of(values: Values) -> tuple[str, ...]:
    """The parameters as arguments of a node."""
    given = [f"{name}:={json.dumps(value)}" for name, value in values.items() if value not in ((), "")]
    return "--ros-args", *[word for one in given for word in ("-p", one)]
