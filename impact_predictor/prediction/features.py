"""What a scene has and what it leaves out, with the reason in words of its parameters.

Everything else is the core, which every scene needs: reading of the samples, the impact plane, the motion until the
touchdown, the impact law, and the score.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from ..parameters.types import values_of

SWITCHES: Final = {
    "friction": "contact.friction",
    "restitution": "contact.restitution",
    "twist window": "odom.twist_window",
    "transverse slip": "transverse_slip law contact.friction !body.radius !feet.names",
    "geometry topic": "!body.contact_points !body.radius !robot.urdf",
    "moving support": "support.motion",
    "harmonic extrapolation": "support.motion support.extrapolation",
    "onset watch": "onset.watch",
    "cylinder": "body.radius",
    "tilt": "source",
    "feet": "feet.names",
    "articulated inertia": "feet.names robot.urdf",
    "force sensors": "feet.names feet.force",
    "schedule": "feet.names feet.has_schedule",
    "margins": "margins",
    "uncertainty": "uncertainty.samples",
    "several bodies": "bodies",
    "events executor": "executor",
}
"""For each feature the parameters that must all switch it on; those with a ! switch it off where they are given."""

ON: Final = {
    "law": {"path"},
    "support.motion": {"odom", "imu"},
    "support.extrapolation": {"harmonic"},
    "source": {"imu"},
    "executor": {"events"},
}
"""The choices that switch a feature on; of every other parameter all values do but nothing, zero and false."""


class Feature(NamedTuple):
    """Something that costs time or memory, and that a scene has, or leaves out; `why` names the parameter."""

    name: str
    on: bool
    why: str


def features_of(values: Mapping[str, Any]) -> tuple[Feature, ...]:
    """The features of a scene, from all its parameters (see `impact_predictor.parameters.validation.validate`).

    A feature is on if any body of the scene has it.
    """
    bodies = [values_of(values, body) for body in values["bodies"] or ("",)]
    found = []
    for name, switches in SWITCHES.items():
        each = [_feature(name, switches.split(), body) for body in bodies]
        having = [feature for feature in each if feature.on]
        few = f" (for {len(having)} of {len(each)} bodies)" if 0 < len(having) < len(each) else ""
        first = (having or each)[0]
        found.append(first._replace(why=first.why + few))
    return tuple(found)


def _feature(name: str, switches: list[str], values: Mapping[str, Any]) -> Feature:
    """Whether a body has a feature, by the first parameter that leaves it out, or else by the first of all."""
    off = [one for one in switches if _is_on(one.lstrip("!"), values) == one.startswith("!")]
    parameter = (off or switches)[0].lstrip("!")
    value = values[parameter]
    said = str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, int | float) else value
    if isinstance(value, tuple | list):
        said = "given"
    return Feature(name, not off, f"{parameter} is {said if value or said in ('0', 'false') else 'not given'}")


def _is_on(parameter: str, values: Mapping[str, Any]) -> bool:
    return values[parameter] in ON[parameter] if parameter in ON else bool(values[parameter])
