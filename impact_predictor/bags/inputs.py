"""Which topics of a bag are the inputs of the predictor."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from ..errors import InputError
from ..prediction.inputs import CONTACT_GEOMETRY, IMU, ODOM, Input
from ..ros import messages

TYPES: Final = {ODOM: messages.ODOMETRY, IMU: messages.IMU, CONTACT_GEOMETRY: messages.POLYGON}
"""The types of the messages on each kind of input."""

_MOST_NAMED: Final = 20


def remapping(rules: Iterable[str]) -> dict[str, str]:
    """The remapping of rules like `odom:=/cube/odom`, as `find_topics` takes it.

    Raises:
        InputError: a rule is not of that form.
    """
    remap = {}
    for rule in rules:
        name, separator, topic = rule.partition(":=")
        if not (name and separator and topic):
            raise InputError(f"the remapping {rule!r} is not of the form from:=to; write for example odom:=/cube/odom")
        remap[name] = topic
    return remap


def find_topics(
    path: str | os.PathLike[str], recorded: Mapping[str, str], inputs: Sequence[Input], remap: Mapping[str, str]
) -> tuple[dict[Input, str], tuple[str, ...]]:
    """The topic of each input that the bag has, and sentences about what was chosen or left out without being told.

    A topic is that of the remapping, else that of the input's own name. For the support and for a body without a name
    it may also be the only one of the type, where no other input looks for one. An input that is needed and has none
    gets its own name, so that the reader says what there is instead: the support, and the state of at least one body.

    Raises:
        InputError: a remapping is of no input, several topics could be an input, or one topic would be two inputs.
    """
    inputs = sorted(inputs, key=lambda one: one.kind == CONTACT_GEOMETRY)
    found = _remapped(inputs, remap)
    for one in inputs:
        if one not in found and recorded.get(f"/{one.name}") == TYPES[one.kind]:
            found[one] = f"/{one.name}"
    open_ = [one for one in inputs if one not in found]
    chosen = {}
    for one in open_:
        taken = [topic for other, topic in found.items() if other.kind == one.kind]
        free = [topic for topic, kind in recorded.items() if kind == TYPES[one.kind] and topic not in taken]
        rivals = [other for other in open_ if other.kind == one.kind]
        if one.body or not free:
            continue
        if len(free) > 1 or len(rivals) > 1:
            raise InputError(_ambiguous(path, free, rivals))
        chosen[one] = free[0]
    found |= chosen
    _check_distinct({one: found[one] for one in inputs if one in found})
    states = [one for one in inputs if one.body is not None and one.kind != CONTACT_GEOMETRY]
    missing = [one for one in states if one not in found]
    if len(missing) == len(states):
        found |= {one: f"/{one.name}" for one in missing[:1]}
    found |= {one: f"/{one.name}" for one in inputs if one.body is None and one not in found}
    notes = []
    if chosen:
        took = " and ".join(f"{topic} as {one.name}" for one, topic in chosen.items())
        notes.append(f"in {os.fspath(path)}, took {took}: there is no other of the type")
    if missing and len(missing) < len(states):
        names = _listing([one.name for one in missing], "and")
        notes.append(f"{os.fspath(path)} has no {names}: nothing is predicted there")
    return {one: found[one] for one in inputs if one in found}, tuple(notes)


def _remapped(inputs: Sequence[Input], remap: Mapping[str, str]) -> dict[Input, str]:
    by_name = {one.name: one for one in inputs}
    # Points that are parameters need no topic, but a rule for one is no mistake.
    states = [one.name for one in inputs if one.kind == ODOM and one.body is not None]
    unused = [name.removesuffix(ODOM) + CONTACT_GEOMETRY for name in states]
    found = {}
    for name, topic in remap.items():
        relative = name.removeprefix("/")
        if relative in by_name:
            found[by_name[relative]] = "/" + topic.removeprefix("/")
        elif relative not in unused:
            names = _listing(list(dict.fromkeys([*by_name, *unused])), "and")
            raise InputError(f"the remapping {name}:={topic} is of no input; the inputs are {names}")
    return found


def _ambiguous(path: str | os.PathLike[str], free: Sequence[str], rivals: Sequence[Input]) -> str:
    names = [one.name for one in rivals]
    could = f"{len(free)} topic{'s' if len(free) > 1 else ''} that could be {_listing(names, 'or')}"
    return f"{os.fspath(path)} has {could}: {_listing(free)}; choose one: --remap {names[0]}:={free[0]}"


def _check_distinct(found: Mapping[Input, str]) -> None:
    by_topic: dict[str, str] = {}
    for one, topic in found.items():
        if topic in by_topic:
            raise InputError(
                f"{by_topic[topic]} and {one.name} cannot both be {topic}; remap one of them to another topic"
            )
        by_topic[topic] = one.name


def _listing(names: Sequence[str], last: str = "") -> str:
    """Some names as a part of a sentence."""
    if len(names) > _MOST_NAMED:
        return f"{', '.join(names[:_MOST_NAMED])} and {len(names) - _MOST_NAMED} more"
    if not last or len(names) < 2:
        return ", ".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"
