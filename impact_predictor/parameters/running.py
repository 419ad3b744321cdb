"""Which parameters may change while the node runs, and why the others may not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from ..errors import InputError
from .validation import parameter_of

FIXED: Final[Mapping[str, str]] = {
    **dict.fromkeys(
        ("bodies", "source", "support.motion", "body.contact_points", "feet.names", "feet.points", "feet.force"),
        "the topics follow from it",
    ),
    **dict.fromkeys(("feet.has_schedule", "robot.urdf", "robot.frames"), "the topics follow from it"),
    **dict.fromkeys(
        ("gravity", "support.normal", "support.frame", "support.edges", "support.extent", "support.imu_position"),
        "all that is known of the support rests on it",
    ),
    **dict.fromkeys(
        ("support.window", "support.timeout", "support.extrapolation", "support.harmonic_window"),
        "all that is known of the support rests on it",
    ),
    **dict.fromkeys(("place.position", "place.yaw"), "it tells where the body began"),
    **dict.fromkeys(("body.radius", "onset.watch"), "what is computed and loaded follows from it"),
    "executor": "messages are waited for by it",
}
"""Why a parameter cannot change while the node runs; every other one can."""


def check_change(before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Whether the node may go on from some validated values to others.

    Raises:
        InputError: a parameter has changed that cannot while the node runs.
    """
    for name in {**before, **after}:
        why = FIXED.get(parameter_of(name).name)
        if why is not None and before.get(name) != after.get(name):
            raise InputError(
                f"the parameter {name} cannot change while the node runs, for {why}: start the node again with it"
            )
