"""Parameters and parameter files that were changed: taken or refused in one sentence, and good for predictions."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final

from fuzz_choices import Choices
from fuzz_messages import ROOT, Course, Flaw, courses, feed, robot_of_stick, sequence

from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_parameters, read_values
from impact_predictor.parameters.table import PARAMETERS
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import inputs_of, scenes_of

LONGEST_SENTENCE: Final = 4000
ODD: Final[tuple[Any, ...]] = (
    *(None, True, False, 0, 1, -1, 2**63, -(2**70), "", "odom", "imu", "none", "path", "total", "events", "\n", "a\0b"),
    *((), [], [1.0], [1.0] * 3, [0.0] * 6, [1.0, "a"], ["a", "a"], [True], [[1.0]], {}, {"a": 1}, b"x", object, 1j),
)
TEXTS: Final = (
    *("~", "null", ".nan", "-.inf", "1e400", "1e-400", "0x1F", "010", "on", "yes", "1_000", "1:30", "2001-01-01"),
    *("[]", "[1.0, 2.0]", "[[1]]", "{}", "{a: b}", "&a 1", "*a", "!!str 1", "|\n  text", "'", '"', '"\\x00"', "- 1"),
    *("/**:", "ros__parameters:", "%YAML 1.1", "---", "...", "\t", "? a", "\ufeff", "\u2028", "#", "9" * 200),
)


@cache
def shipped() -> tuple[tuple[str, bytes, dict[str, Any]], ...]:
    """The scenes that are shipped: name, bytes of the file and parameters."""
    paths = sorted((ROOT / "config").glob("*.yaml"))
    return tuple((path.stem, path.read_bytes(), dict(read_parameters(path))) for path in paths)


@cache
def _file() -> Path:
    return Path(tempfile.mkdtemp(prefix="fuzz_")) / "scene.yaml"


def check_sentence(error: InputError) -> None:
    """See that it is one sentence for a person.

    Raises:
        Flaw: it is not.
    """
    said = str(error)
    if not said.strip() or not said.isprintable() or "Traceback" in said or len(said) > LONGEST_SENTENCE:
        raise Flaw(f"no sentence: {said!r}")


def fuzz_parameters(choices: Choices) -> str:
    """One input: the values of a scene, the bytes of its file, or those of a robot's; what it was about.

    Raises:
        Flaw: the property does not hold.
    """
    name, data, given = choices.of(shipped())
    if choices.once_in(2):
        take_file(choices, data)
        return "a file"
    if choices.once_in(2) and (robot := robot_of_stick()):
        take_robot(choices, robot)
        return "a robot"
    changed = dict(given)
    for _ in range(1 + choices.below(4)):
        _change(choices, changed)
    try:
        scenes = scenes_of(validate(changed))
        by_name = {course.name: course for course in courses()}
        topics = {one: f"/{one.name}" for one in inputs_of(scenes)}
        course = Course(name, scenes, topics, tuple(one for one in by_name[name].messages if one[0] in topics))
        if any(scene.samples for scene in scenes.values()) and not choices.once_in(8):
            return "a value, but sampling is slow"
        feed(course, sequence(choices, course, 60), markers=choices.once_in(4))
    except InputError as error:
        check_sentence(error)
        return "a value, refused"
    return "a value, taken"


ATTRIBUTES: Final = (
    "0",
    "-1",
    "nan",
    "inf",
    "1e400",
    "1e-300",
    "a",
    "",
    "0 0",
    "1 2 3 4",
    "left",
    "sphere",
    "\u00e4",
    "9" * 400,
)


def take_robot(choices: Choices, values: Mapping[str, Any]) -> None:
    """Change the bytes of a URDF, or attributes in it, and make the scene of a machine of it.

    Raises:
        Flaw: it is not refused in one sentence.
    """
    data = Path(values["robot.urdf"]).read_bytes()
    if choices.once_in(2):
        data = choices.damaged(data)
    else:
        places = [match.span(1) for match in re.finditer(rb'"([^"]*)"', data)]
        start, end = choices.of(places)
        data = data[:start] + choices.of(ATTRIBUTES).encode() + data[end:]
    path = _file().with_suffix(".urdf")
    path.write_bytes(data)
    walker = next(given for name, _, given in shipped() if name == "walker_hyq")
    feet = {"feet.names": ("left", "right"), "feet.points": 1}
    try:
        Monitor(scenes_of(validate(walker | feet | dict(values) | {"robot.urdf": str(path)})))
    except InputError as error:
        check_sentence(error)


def _change(choices: Choices, given: dict[str, Any]) -> None:
    bodies = [body for body in ("crate", "drum", "reefer") if f"{body}.place.position" in given]
    name = choices.of(list(PARAMETERS))
    if choices.once_in(12):
        name = choices.of(("", ".", "bodies.", "body", "a.b.c", "\n", "use_sim_time", "qos_overrides./odom", "horizn"))
    if bodies and choices.once_in(2):
        name = f"{choices.of(bodies)}.{name}"
    was = given.get(name, PARAMETERS[name].default if name in PARAMETERS else None)
    kind = choices.below(8)
    if kind == 0:
        given.pop(name, None)
    elif kind == 1:
        given[name] = choices.of(ODD)
    elif isinstance(was, float) or (was is None and kind < 5):
        given[name] = choices.number(was or 1.0)
    elif isinstance(was, list | tuple) and was and isinstance(was[0], float):
        numbers = [*was]
        numbers[choices.below(len(numbers))] = choices.number(numbers[0])
        scale = choices.of((1.0, 1.0, 1.0, 1e-150, 1e-9, 1e9, 1e150))
        given[name] = [number * scale for number in numbers]
    elif isinstance(was, bool):
        given[name] = not was
    elif isinstance(was, int):
        given[name] = choices.of((16, 17, 0, 4, was + 1))
    else:
        length = choices.below(10)
        given[name] = choices.of((choices.of(ODD), [choices.number(1.0) for _ in range(length)]))


def take_file(choices: Choices, data: bytes) -> None:
    """Change the bytes of a parameter file, and read it.

    Raises:
        Flaw: it is not refused in one sentence.
    """
    if choices.once_in(2):
        data = choices.damaged(data)
    else:
        lines = re.sub(rb"(?m)^\s*#.*\n", b"", data).splitlines(keepends=True)
        for _ in range(1 + choices.below(4)):
            at = choices.below(len(lines))
            kind = choices.below(5)
            if kind == 0:
                lines[at] = lines[at].partition(b":")[0] + b": " + choices.of(TEXTS).encode() + b"\n"
            elif kind == 1:
                lines[at] = b" " * choices.below(9) + lines[at].lstrip()
            elif kind == 2:
                lines.insert(at, lines[choices.below(len(lines))])
            elif kind == 3:
                lines.insert(at, b" " * choices.below(9) + choices.of(TEXTS).encode() + b"\n")
            else:
                lines[at] = choices.damaged(lines[at])
        data = b"".join(lines)
    _file().write_bytes(data)
    try:
        read_values(_file())
    except InputError as error:
        check_sentence(error)
