"""Reading a ROS 2 parameter file without ROS, by the rules of rcl_yaml_param_parser.

Those rules are not YAML's: `010` is eight, `on` is true, `1e-3` a number and `~` a text. So scalars are read as text
with their quoting and typed here. What another YAML library would read differently is refused, because nobody can know
which reading was meant.
"""

from __future__ import annotations

import logging
import math
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    CollectionStartEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from ..errors import InputError
from ..files import text_of
from .validation import Value, foreign, validate

Scalar = bool | int | float | str
FileValue = Scalar | list[Scalar]

_PARAMETERS_KEY: Final = "ros__parameters"

_SECTION_NAME: Final = re.compile(r"/|/?(\w+|\*\*?)(/(\w+|\*\*?))*", re.ASCII)

_BOOLEANS: Final = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_BOOLEANS_OF_SOME: Final = {"y", "yes", "on", "n", "no", "off"}
_NOTHING: Final = {"~", "null"}
_NAMED_FLOATS: Final = {
    **dict.fromkeys((".nan", ".NaN", ".NAN"), math.nan),
    **dict.fromkeys((".inf", ".Inf", ".INF", "+.inf", "+.Inf", "+.INF"), math.inf),
    **dict.fromkeys(("-.inf", "-.Inf", "-.INF"), -math.inf),
}
_INTEGER: Final = re.compile(r"[-+]?(0|[1-9][0-9]*|0[xX][0-9a-fA-F]+)")
_FLOAT: Final = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
# What is a number, a time or a date to one of strtol, strtod, YAML 1.1 and YAML 1.2, but not to all of them.
_NUMBER_OF_SOME: Final = re.compile(
    r"""[-+]?0[0-9_]+ | [-+]?0[xX].* | [-+]?0[oObB][0-9_]+
    | [-+]?[0-9][0-9_]*(:[0-9]+)*(\.[0-9_]*)?([eE][-+]?[0-9]+)? | [-+]?\.[0-9_]+([eE][-+]?[0-9]+)?
    | [-+]?\.?(inf|infinity|nan(\(\w*\))?)
    | [0-9]{4}-[0-9]{1,2}-[0-9]{1,2}.*""",
    re.VERBOSE | re.IGNORECASE,
)
_MOST_DIGITS: Final = 100
_MOST_SHOWN: Final = 40
_SMALLEST_NORMAL: Final = 2.0**-1022


class _Scalar(NamedTuple):
    text: str
    quoted: bool
    line: int


class _Sequence(NamedTuple):
    items: list[_Scalar]
    line: int


class _Mapping(NamedTuple):
    entries: list[tuple[_Scalar, _Node]]
    line: int


_Node = _Scalar | _Sequence | _Mapping


def read_parameters(path: str | os.PathLike[str], node: str = "impact_predictor") -> dict[str, FileValue]:
    """The parameters that a file sets for a node, by their full names, as in {"body.mass": 0.37}.

    `node` may have a namespace. Where several sections fit the node (`/**`, `/*`, its name), the last one in the file
    wins, as in rclpy. InputError where the file is not there, is not a parameter file, says nothing for the node, or
    has a value that is ambiguous.
    """
    path = Path(path)
    try:
        root = _parse(text_of(path))
        sections: dict[str, list[ParameterEntry]] = {}
        for name, entries in _sections(root) if root is not None else ():
            # A section that goes on further down keeps its place in the order, as in rcl.
            sections.setdefault(name, []).extend(entries)
        fitting = [entries for name, entries in sections.items() if _fits(name, node)]
        if not fitting:
            has = f"parameters for {', '.join(sections)}, but none" if sections else "no parameters"
            raise InputError(f"it has {has} for {node}; put them under `/**:` and `{_PARAMETERS_KEY}:`")
        return _merge(fitting)
    except OSError as error:
        raise InputError(f"the parameter file {path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(
            f"the parameter file {path} is not UTF-8 text: {error.reason} at byte {error.start}"
        ) from error
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = "" if mark is None else f", line {mark.line + 1}"
        raise InputError(f"the parameter file {path}{where} is not YAML: {error.problem or error.context}") from error
    except YAMLError as error:
        raise InputError(f"the parameter file {path} is not YAML: {' '.join(str(error).split())}") from error
    except RecursionError as error:
        raise InputError(f"the parameter file {path} is nested too deeply") from error
    except InputError as error:
        raise InputError(f"the parameter file {path}: {error}") from None


def read_values(path: str | os.PathLike[str]) -> dict[str, Value]:
    """The values of all parameters with a file: those that it sets, and the defaults of the others; InputError as of
    `read_parameters`, or where a parameter is wrong.
    """
    given = read_parameters(path)
    try:
        values = validate(given)
        for name in foreign(given):
            logging.getLogger(__name__).warning(
                "note: %s of %s is no parameter of impact_predictor, and passed over", name, os.fspath(path)
            )
        return values
    except InputError as error:
        raise InputError(f"the parameter file {os.fspath(path)}: {error}") from error


def _parse(text: str) -> _Mapping | None:
    """The only document of a file; None where there is none."""
    if re.search(r"^%", text, re.MULTILINE):
        raise InputError("it has a line that begins with %; leave the directive out")
    root: _Mapping | None = None
    events = iter(YAML(typ="rt", pure=True).parse(text))
    for event in events:
        if not isinstance(event, DocumentStartEvent):
            continue
        first = next(events)
        if root is not None:
            raise InputError(f"line {_line(first)} begins a second document; put everything into one")
        node = _node(first, events)
        if isinstance(node, _Mapping):
            root = node
        elif node != _Scalar("", False, node.line):
            raise InputError(f"line {node.line} is not a section; begin with `/**:` and `{_PARAMETERS_KEY}:`")
    return root


def _line(event: Event) -> int:
    return int(event.start_mark.line) + 1


def _node(event: Event, events: Iterator[Event], in_brackets: bool = False) -> _Node:
    line = _line(event)
    if isinstance(event, AliasEvent):
        raise InputError(f"line {line} has the alias *{event.anchor}, which ROS does not read; write the value itself")
    if isinstance(event, ScalarEvent | CollectionStartEvent) and event.tag is not None:
        raise InputError(f"line {line} has the tag {event.tag}; leave it out, and put a text into quotes")
    if isinstance(event, ScalarEvent):
        if event.style in ("|", ">"):
            raise InputError(f"line {line} has a block of text; write it in quotes on one line")
        if in_brackets and event.style is None and ":" in event.value:
            # The libyaml of ROS stops at most of these, ruamel.yaml at none.
            raise InputError(f"line {line} has a colon in {event.value}; put it into quotes")
        return _Scalar(event.value, event.style is not None, line)
    if isinstance(event, SequenceStartEvent):
        items = []
        while not isinstance(item := next(events), SequenceEndEvent):
            if isinstance(item, CollectionStartEvent):
                raise InputError(f"line {_line(item)} has a list or a section inside a list; write one flat list")
            value = _node(item, events, in_brackets or event.flow_style)
            assert isinstance(value, _Scalar)
            items.append(value)
        return _Sequence(items, line)
    assert isinstance(event, MappingStartEvent)
    entries = []
    while not isinstance(item := next(events), MappingEndEvent):
        key = _node(item, events, in_brackets or event.flow_style)
        if not isinstance(key, _Scalar) or not key.text:
            raise InputError(f"line {key.line} has a name that is empty or a list; write `name: value`")
        value = _node(next(events), events, in_brackets or event.flow_style)
        # A value that is missing is seen only where the next thing begins.
        entries.append((key, value if value != _Scalar("", False, value.line) else value._replace(line=key.line)))
    return _Mapping(entries, line)


ParameterEntry = tuple[str, _Scalar | _Sequence]


def _sections(mapping: _Mapping, pattern: str = "") -> Iterator[tuple[str, list[ParameterEntry]]]:
    """The node name patterns of a file with their parameters, in the order of the file."""
    for key, value in mapping.entries:
        if key.text == _PARAMETERS_KEY:
            if not pattern:
                raise InputError(f"line {key.line} has `{_PARAMETERS_KEY}:` outside a section; indent it under `/**:`")
            if len(mapping.entries) > 1:
                raise InputError(f"line {mapping.line} has more than `{_PARAMETERS_KEY}:` in the section {pattern}")
            if not isinstance(value, _Mapping):
                raise InputError(f"line {value.line} has no `name: value` under `{_PARAMETERS_KEY}:`")
            yield pattern, list(_flatten(value))
        elif not isinstance(value, _Mapping):
            raise InputError(
                f"line {key.line} sets `{key.text}` outside `{_PARAMETERS_KEY}:`; indent it under `/**:` and "
                f"`{_PARAMETERS_KEY}:`"
            )
        elif not _SECTION_NAME.fullmatch(key.text):
            raise InputError(f"line {key.line} begins a section {key.text!r}, which is no name of a node")
        else:
            yield from _sections(value, f"{pattern}/{key.text}" if pattern else key.text)


def _flatten(mapping: _Mapping, prefix: str = "") -> Iterator[ParameterEntry]:
    for key, value in mapping.entries:
        name = prefix + key.text
        if not isinstance(value, _Mapping):
            yield name, value
        elif value.entries:
            yield from _flatten(value, name + ".")
        else:
            raise InputError(f"line {value.line} gives `{name}` no value")


def _fits(pattern: str, node: str) -> bool:
    """Whether a section is for a node: `*` stands for one part of its name, `**` for any number of them."""
    parts = {"*": r"/\w+", "**": r"(/\w+)*"}
    expression = "".join(parts.get(part, f"/{part}") for part in pattern.split("/") if part)
    return re.fullmatch(expression, "/" + node.strip("/"), re.ASCII) is not None


def _merge(sections: list[list[ParameterEntry]]) -> dict[str, FileValue]:
    merged: dict[str, FileValue] = {}
    for entries in sections:
        lines: dict[str, int] = {}
        for name, node in entries:
            if name in lines:
                raise InputError(f"`{name}` is set twice, in the lines {lines[name]} and {node.line}; keep one")
            lines[name] = node.line
            merged[name] = _value(name, node)
        for name in lines:
            parts = name.split(".")
            for above in (".".join(parts[:k]) for k in range(1, len(parts))):
                if above in lines:
                    raise InputError(f"`{above}` has a value in line {lines[above]} and holds `{name}` too; keep one")
    return merged


def _value(name: str, node: _Scalar | _Sequence) -> FileValue:
    if isinstance(node, _Scalar):
        return _scalar(name, node)
    if not node.items:
        raise InputError(f"line {node.line} sets `{name}` to [], which ROS reads as no value; leave the line out")
    values = [_scalar(name, item) for item in node.items]
    kinds = {type(value) for value in values}
    if kinds == {int, float}:
        raise InputError(f"line {node.line} mixes integers and doubles in `{name}`; write 1.0 for 1")
    if len(kinds) > 1:
        raise InputError(f"line {node.line} mixes texts, numbers or truth values in `{name}`; write one kind")
    return values


def _scalar(name: str, scalar: _Scalar) -> Scalar:
    """The value that rcl gives a scalar, where every YAML library agrees; `1e-3` is a number although YAML 1.1 errs."""
    text = scalar.text
    if scalar.quoted:
        return text
    if not text:
        raise InputError(f"line {scalar.line} gives `{name}` no value")
    if text in _BOOLEANS:
        return _BOOLEANS[text]
    if text.lower() in _BOOLEANS_OF_SOME:
        raise _ambiguous(name, scalar, "true or false")
    if text.lower() in _NOTHING:
        raise _ambiguous(name, scalar, "a value")
    if text in _NAMED_FLOATS:
        return _NAMED_FLOATS[text]
    if _INTEGER.fullmatch(text):
        # Python itself refuses to read thousands of digits.
        if len(text) <= _MOST_DIGITS and -(2**63) <= (integer := int(text, 0)) < 2**63:
            return integer
        raise _ambiguous(name, scalar, "a number that fits in 64 bits, or one with a point")
    if _FLOAT.fullmatch(text) and not re.fullmatch(r"[-+]?0[0-9]+", text):
        number = float(text)
        if number == 0.0 and not re.search("[1-9]", re.split("[eE]", text)[0]):
            return number
        if _SMALLEST_NORMAL <= abs(number) < math.inf:
            return number
        raise _ambiguous(name, scalar, "a number between 1e-307 and 1e308, or 0.0")
    if _NUMBER_OF_SOME.fullmatch(text):
        raise _ambiguous(name, scalar, "a plain number such as 8, 8.0 or 0x8")
    return text


def _ambiguous(name: str, scalar: _Scalar, better: str) -> InputError:
    text = scalar.text if len(scalar.text) <= _MOST_SHOWN else f"{scalar.text[:_MOST_SHOWN]}..."
    return InputError(
        f"line {scalar.line} sets `{name}` to {text}, which YAML readers understand differently; write {better}, "
        f'or "{text}" in quotes for a text'
    )
