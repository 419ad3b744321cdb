"""Which parameters may change while the node runs, and why the others may not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from ..errors import InputError
from .validation import parameter_of

_REASONS: Final = {
    "the topics follow from it": (
        *("bodies", "source", "support.motion", "body.contact_points", "feet.names", "feet.points", "feet.force"),
        *("feet.has_schedule", "robot.urdf", "robot.frames"),
    ),
    "all that is known of the support rests on it": (
        *("gravity", "support.normal", "support.frame", "support.edges", "support.extent", "support.imu_position"),
        *("support.window", "support.timeout", "support.extrapolation", "support.harmonic_window"),
    ),
    "it tells where the body began": ("place.position", "place.yaw"),
    "what is computed and loaded follows from it": ("body.radius", "onset.watch"),
    "messages are waited for by it": ("executor",),
}

FIXED: Final[Mapping[str, str]] = {name: why for why, names in _REASONS.items() for name in names}
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
