"""Which messages scenes need, by the relative names of their topics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, NamedTuple

from .scene import Scene, shared_by

ODOM: Final = "odom"
IMU: Final = "imu"
CONTACT_GEOMETRY: Final = "contact_geometry"


class Input(NamedTuple):
    """A topic that is read: its relative name, what it carries, and of which body; None for the support."""

    name: str
    kind: str
    body: str | None


def inputs_of(scenes: Mapping[str, Scene]) -> tuple[Input, ...]:
    """Every input of the bodies, in the order in which messages that wait at the same time are best served.

    The support comes first and contact points before the states of their body, so that a state finds what it needs.
    """
    found = []
    deck = shared_by(scenes).deck
    if deck is not None:
        found.append(Input(f"support/{deck.source}", deck.source, None))
    names = {body: f"{body}/" if body else "" for body in scenes}
    found += [
        Input(names[body] + CONTACT_GEOMETRY, CONTACT_GEOMETRY, body)
        for body, scene in scenes.items()
        if scene.needs_geometry
    ]
    found += [
        Input(names[body] + scene.source, scene.source, body)
        for body, scene in scenes.items()
        if scene.source in (ODOM, IMU)
    ]
    return tuple(found)
