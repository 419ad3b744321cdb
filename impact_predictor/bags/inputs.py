"""Which topics of a bag are the inputs of the predictor."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Final

from ..errors import InputError
from ..prediction.scene import CONTACT_GEOMETRY, FEET_STATES, IMU, ODOM, POINTS, STATES, Input
from ..ros.messages import INPUT_TYPES
from ..wording import listed
from .read import listing

GUESSED: Final = (ODOM, IMU, *POINTS)
"""Kinds of inputs that the only topic of their type is taken for; trajectories and wrenches may be of anything."""


def remapping(rules: Iterable[str]) -> dict[str, str]:
    """The remapping of rules like `odom:=/cube/odom`, as `find_topics` takes it; InputError where a rule is not of that
    form.
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

    A topic is that of the remapping, else that of the input's own name. For a body without a name it may also be the
    only other one of the type. Over a fixed floor a body without any gets its own name, so that the reader says what
    there is instead. InputError where a remapping is of no input, several topics could be an input, one topic would be
    two inputs, or nothing is told to be the support, or none of the bodies on it.
    """
    inputs = sorted(inputs, key=lambda one: one.kind == CONTACT_GEOMETRY)
    found = _remapped(inputs, remap)
    for one in inputs:
        if one not in found and recorded.get(f"/{one.name}") == _type(one):
            found[one] = f"/{one.name}"
    support = [one for one in inputs if one.body is None and one.kind in STATES]
    # No topic is ever guessed to be the support: over a wrong one every answer would be wrong, and look right.
    if any(one not in found for one in support):
        raise _untold(path, recorded, support)
    chosen = {}
    for one in inputs:
        taken = [topic for other, topic in found.items() if other.kind == one.kind]
        free = [topic for topic, kind in recorded.items() if kind == _type(one) and topic not in taken]
        if one in found or one.body or not free or one.kind not in GUESSED:
            continue
        if len(free) > 1:
            raise _ambiguous(path, free, one)
        chosen[one] = free[0]
    found |= chosen
    adapted = _adapted(path, recorded, inputs, found)
    found |= adapted
    _check_distinct({one: found[one] for one in inputs if one in found}, adapted_topics(recorded, found))
    states = [one for one in inputs if one.body is not None and one.kind in STATES]
    missing = [one for one in states if one not in found]
    if missing and len(missing) == len(states):
        if support:
            raise _untold(path, recorded, missing)
        found |= {one: f"/{one.name}" for one in missing[:1]}
    notes = []
    for guessed, why in ((chosen, "there is no other of the type"), (adapted, "its messages have an adapter")):
        named = {topic: [one.name for one in inputs if guessed.get(one) == topic] for topic in guessed.values()}
        if named:
            took = [f"{topic} as {listed(names, last='and')}" for topic, names in named.items()]
            notes.append(f"in {os.fspath(path)}, took {listed(took, last='and')}: {why}")
    if missing and len(missing) < len(states):
        names = listed([one.name for one in missing], last="and")
        notes.append(f"{os.fspath(path)} has no {names}: nothing is predicted there")
    return {one: found[one] for one in inputs if one in found}, tuple(notes)


def _adapted(
    path: str | os.PathLike[str], recorded: Mapping[str, str], inputs: Sequence[Input], found: Mapping[Input, str]
) -> dict[Input, str]:
    """Topics whose messages have an adapter, for inputs that have no topic: a message may tell all of a body.

    That is the topic of the body's state, else the one that tells something else of it, or for a body without a name
    the only one with such messages.
    """
    adapted: dict[Input, str] = {}
    for state in [one for one in inputs if one.kind == ODOM and one.body is not None]:
        # Adapters tell feet in the order of the scene.
        missing = [
            one for one in inputs if one.body == state.body and one.kind not in (IMU, FEET_STATES) and one not in found
        ]
        if not missing or recorded.get(found.get(state, "")) == INPUT_TYPES[ODOM].name:
            continue
        from .adapters import known  # only for bags without the usual messages

        adapters = known()
        known_as = [found[state]] if state in found else [found[one] for one in found if one.body == state.body]
        topics = [topic for topic in dict.fromkeys(known_as) if recorded.get(topic, "") in adapters]
        if not topics and not state.body and state not in found:
            topics = [topic for topic, kind in recorded.items() if kind in adapters]
        if len(topics) > 1:
            raise _ambiguous(path, topics, state)
        adapted |= {one: topic for one in missing for topic in topics}
    return adapted


def adapted_topics(recorded: Mapping[str, str], found: Mapping[Input, str]) -> dict[str, str]:
    """The topics of inputs whose messages have an adapter, with their types."""
    others = {topic for one, topic in found.items() if topic in recorded and recorded[topic] != _type(one)}
    if not others:
        return {}
    from .adapters import known

    adapters = known()
    return {topic: recorded[topic] for topic in sorted(others) if recorded[topic] in adapters}


def _type(one: Input) -> str:
    return INPUT_TYPES[one.kind].name


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
            names = listed(list(dict.fromkeys([*by_name, *unused])), last="and")
            raise InputError(f"the remapping {name}:={topic} is of no input; the inputs are {names}")
    return found


def _ambiguous(path: str | os.PathLike[str], free: Sequence[str], one: Input) -> InputError:
    could = f"{len(free)} topics that could be {one.name}: {listed(free)}"
    return InputError(f"{os.fspath(path)} has {could}; choose one: --remap {one.name}:={free[0]}")


def _untold(path: str | os.PathLike[str], recorded: Mapping[str, str], inputs: Sequence[Input]) -> InputError:
    """That no topic is told to be the support, or none to be any of the bodies on it, and what there is."""
    names = listed([one.name for one in inputs], last="or")
    what = "the deck" if inputs[0].body is None else "a unit"
    return InputError(
        f"nothing in {os.fspath(path)} is told to be {what} ({names}); it has {listing(recorded, _type(inputs[0]))}; "
        f"if {what} is among them, tell which: --remap {inputs[0].name}:=TOPIC"
    )


def _check_distinct(found: Mapping[Input, str], adapted: Collection[str]) -> None:
    """Whether each topic is one input, or several of one body if its messages have an adapter."""
    by_topic: dict[str, Input] = {}
    for one, topic in found.items():
        first = by_topic.setdefault(topic, one)
        if first is not one and not (topic in adapted and first.body == one.body):
            raise InputError(f"{first.name} and {one.name} cannot both be {topic}; remap one of them to another topic")
