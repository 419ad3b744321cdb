"""Which messages scenes need, by the relative names of their topics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, NamedTuple

from .scene import Scene, shared_by

ODOM: Final = "odom"
IMU: Final = "imu"
CONTACT_GEOMETRY: Final = "contact_geometry"
JOINTS: Final = "joint_states"
WRENCH: Final = "contact_wrench"
SCHEDULE: Final = "schedule"

STATES: Final = (ODOM, IMU)
"""What tells how a body moves; everything else is told about it."""


class Input(NamedTuple):
    """A topic that is read: its relative name, what it carries, and of which body; None for the support."""

    name: str
    kind: str
    body: str | None


def inputs_of(scenes: Mapping[str, Scene]) -> tuple[Input, ...]:
    """Every input of the bodies, in the order in which messages that wait at the same time are best served.

    The support comes first and what is told about a body before its states, so that a state finds what it needs.
    """
    found = []
    deck = shared_by(scenes).deck
    if deck is not None:
        found.append(Input(f"support/{deck.source}", deck.source, None))
    names = {body: f"{body}/" if body else "" for body in scenes}
    found += [Input(names[body] + kind, kind, body) for body, scene in scenes.items() for kind in _told_about(scene)]
    found += [
        Input(names[body] + scene.source, scene.source, body)
        for body, scene in scenes.items()
        if scene.source in STATES
    ]
    return tuple(found)


def _told_about(scene: Scene) -> list[str]:
    """What is told about a body besides its states."""
    walking = scene.walking
    told = [CONTACT_GEOMETRY] if scene.needs_geometry else []
    if walking is not None:
        told += [JOINTS] if walking.robot is not None else []
        told += [WRENCH] if walking.force else []
        told += [SCHEDULE] if walking.has_schedule else []
    return told
