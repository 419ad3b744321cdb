"""What a scene has and what it leaves out, with the reason in words of its parameters.

Everything else is the core, which every scene needs: reading of the samples, the impact plane, the motion until the
touchdown, the impact law, and the score.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from ..parameters.types import values_of

RULES: Final = (
    ("friction", "contact.friction", "a stance may stick, and moves in closed form then", "every stance slips"),
    ("restitution", "contact.restitution", "the new contact also pushes back", "impacts end with the compression"),
    ("twist window", "odom.twist_window", "a twist is older than its stamp", "a twist is that of the very instant"),
    ("moving support", "support.motion", "bodies are seen from there", "a floor, and no topic of its motion"),
    (
        "harmonic extrapolation",
        "support.motion support.extrapolation",
        "waves are fitted to the last seconds of the support's motion",
        "no waves are fitted",
    ),
    (
        "onset watch",
        "onset.watch",
        "how near to sliding and tipping, now and in the forecast, with levels",
        "nobody asks how near a body is to sliding and tipping",
    ),
    ("cylinder", "body.radius", "the body lies on two edges of the support", "the body has contact points"),
    ("tilt", "source", "an inertial sensor tells the tilt of the body, and nothing its place", "no sensor of the tilt"),
    (
        "feet",
        "feet.names",
        "the motion of each foot over the ground tells its stance and landings",
        "the contact points are fixed to the body",
    ),
    (
        "articulated inertia",
        "feet.names robot.urdf",
        "joint_states tell feet and inertia, through Pinocchio",
        "one rigid body, and no topic joint_states",
    ),
    (
        "force sensors",
        "feet.names feet.force",
        "the topic contact_wrench confirms which feet stand",
        "no force sensors, and no subscription to contact_wrench",
    ),
    (
        "schedule",
        "feet.names feet.has_schedule",
        "the topic schedule tells when feet are to stand, so landings may be late",
        "no planner tells when feet are to stand, and no such subscription",
    ),
    (
        "margins",
        "margins",
        "how far each impact is from another mode, computed while somebody reads ~/prediction",
        "nobody asks how far an impact is from another mode",
    ),
    (
        "uncertainty",
        "uncertainty.samples",
        "so many points carry the uncertainty through each impact",
        "no probabilities are asked for, which would need numpy and numba",
    ),
    ("several bodies", "bodies", "each has its topics and its predictor", "one body, without a name"),
    ("events executor", "executor", "rclpy's experimental one, which costs less for each message", "rclpy's default"),
)
"""For each feature the parameters that must all switch it on, what a scene has with it and what one has without."""

ON: Final = {
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
    bodies = [_features(values_of(values, body)) for body in values["bodies"] or ("",)]
    found = []
    for each in zip(*bodies, strict=True):
        having = [feature for feature in each if feature.on]
        few = f" (for {len(having)} of {len(each)} bodies)" if 0 < len(having) < len(each) else ""
        first = (having or each)[0]
        found.append(first._replace(why=first.why + few))
    return tuple(found)


def _features(values: Mapping[str, Any]) -> list[Feature]:
    """What one body has and lacks."""
    found = [_geometry_topic(values), _transverse_slip(values)]
    for feature, parameters, has, lacks in RULES:
        names = parameters.split()
        off = [name for name in names if not _switches_on(name, values[name])]
        name = off[0] if off else names[-1]
        found.append(Feature(feature, not off, f"{name} is {_said(values[name])}: {lacks if off else has}"))
    return found


def _switches_on(name: str, value: Any) -> bool:
    return value in ON[name] if name in ON else bool(value)


def _said(value: Any) -> str:
    if isinstance(value, tuple | list | str):
        words = value if isinstance(value, str) else ", ".join(map(str, value))
        return words or "not given"
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


def _transverse_slip(values: Mapping[str, Any]) -> Feature:
    name, alone = "transverse slip", "friction acts in the impact plane alone"
    if values["body.radius"]:
        return Feature(name, False, f"body.radius makes the body a cylinder: {alone}")
    if values["feet.names"]:
        return Feature(name, False, f"feet.names makes it a walking machine: {alone}")
    if not values["transverse_slip"]:
        return Feature(name, False, f"transverse_slip is false: {alone}")
    if values["law"] != "path":
        return Feature(name, False, f"the law is {values['law']}, which knows no slip across the impact plane")
    if not values["contact.friction"]:
        return Feature(name, False, "contact.friction is 0: nothing opposes slip across the impact plane either")
    return Feature(name, True, "transverse_slip is true: friction also opposes slip across the impact plane")


def _geometry_topic(values: Mapping[str, Any]) -> Feature:
    name, no_topic = "geometry topic", "no subscription to contact_geometry"
    if values["robot.urdf"]:
        return Feature(name, False, f"robot.urdf is given, so the feet are where joint_states says: {no_topic}")
    if values["feet.names"]:
        return Feature(name, True, "feet.names makes it a walking machine, whose points keep coming on a topic")
    if values["body.radius"]:
        return Feature(name, False, f"body.radius makes the body a cylinder: {no_topic}")
    if values["body.contact_points"]:
        return Feature(name, False, f"the contact points are parameters (body.contact_points): {no_topic}")
    return Feature(name, True, "body.contact_points is not given, so the points come from the topic contact_geometry")
