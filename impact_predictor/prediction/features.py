"""What a scene has and what it leaves out, with the reason in words of its parameters.

Everything else is the core, which every scene needs: reading of the samples, the impact plane, the motion until the
touchdown, the impact law, and the score.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from .scene import Scene, scenes_of

Rule = Callable[[Scene], tuple[bool, str]]


class Feature(NamedTuple):
    """Something that costs time or memory, and that a scene has, or leaves out; `why` names the parameter."""

    name: str
    on: bool
    why: str


def features_of(values: Mapping[str, Any]) -> tuple[Feature, ...]:
    """The features of a scene, from all its parameters (see `impact_predictor.parameters.validation.validate`).

    A feature is on if any body of the scene has it.
    """
    scenes = list(scenes_of(values).values())
    found = [_feature_of(name, rule, scenes) for name, rule in RULES.items()]
    count, events = len(values["bodies"]), values["executor"] == "events"
    several = f"bodies has {count} names: each has its topics and its predictor, one support and watch serve all"
    found.append(
        Feature("several bodies", count > 0, several if count else "bodies is not given: one body, without a name")
    )
    executor = "rclpy's experimental one, which costs less for each message" if events else "rclpy's default"
    found.append(Feature("events executor", events, f"executor is {values['executor']}: {executor}"))
    return tuple(found)


def _feature_of(name: str, rule: Rule, scenes: list[Scene]) -> Feature:
    found = [rule(scene) for scene in scenes]
    those = [why for on, why in found if on]
    few = f" (for {len(those)} of {len(scenes)} bodies)" if 0 < len(those) < len(scenes) else ""
    return Feature(name, bool(those), (those or [why for _, why in found])[0] + few)


def _friction(scene: Scene) -> tuple[bool, str]:
    if not scene.friction:
        return False, "contact.friction is 0: every stance slips, and its motion is integrated"
    what = "a stance may stick, and then moves in closed form"
    if scene.walking is not None:
        what = "what keeps the feet that stand and land from slipping"
    return True, f"contact.friction is {scene.friction:g}: {what}"


def _restitution(scene: Scene) -> tuple[bool, str]:
    if not scene.restitution:
        return False, "contact.restitution is 0: a plastic impact ends with the compression"
    return True, f"contact.restitution is {scene.restitution:g}: the new contact also pushes back"


def _twist_window(scene: Scene) -> tuple[bool, str]:
    if not scene.twist_window:
        return False, "odom.twist_window is 0: the twist is that of the very instant"
    window = f"odom.twist_window is {1e3 * scene.twist_window:g} ms"
    return True, f"{window}: the twist is older than its stamp, and may have the impact in it"


def _transverse_slip(scene: Scene) -> tuple[bool, str]:
    if scene.radius:
        return False, "body.radius makes the body a cylinder: friction acts in the impact plane alone"
    if scene.walking is not None:
        return False, "feet.names makes it a walking machine: friction acts in the impact plane alone"
    if not scene.transverse_slip:
        return False, "transverse_slip is false: friction acts in the impact plane alone"
    if scene.law != "path":
        return False, f"the law is {scene.law}, which knows no slip across the impact plane"
    if not scene.friction:
        return False, "contact.friction is 0: nothing opposes slip across the impact plane either"
    return True, "transverse_slip is true: friction also opposes slip across the impact plane"


def _geometry_topic(scene: Scene) -> tuple[bool, str]:
    if scene.walking is not None and scene.walking.robot is None:
        return True, "feet.names makes it a walking machine, whose points keep coming on the topic contact_geometry"
    if scene.needs_geometry:
        return True, "body.contact_points is not given, so the points come from the topic contact_geometry"
    why = "the contact points are parameters (body.contact_points)"
    if scene.walking is not None:
        why = "robot.urdf is given, so the feet are where joint_states says"
    elif scene.radius:
        why = "body.radius makes the body a cylinder"
    return False, f"{why}: no subscription to contact_geometry"


def _moving_support(scene: Scene) -> tuple[bool, str]:
    if scene.deck is None:
        return False, "support.motion is fixed: a floor, and no topic of its motion"
    source = "its pose and twist" if scene.deck.source == "odom" else "an inertial sensor on it"
    return True, f"support.motion is {scene.deck.source}: {source} tell what is felt on it, bodies are seen from it"


def _harmonic_extrapolation(scene: Scene) -> tuple[bool, str]:
    if scene.deck is None:
        return False, "support.motion is fixed, so there is no motion to extrapolate"
    if scene.deck.extrapolation != "harmonic":
        return False, "support.extrapolation is constant: the support goes on with the accelerations of now"
    window = f"the last {scene.deck.harmonic_window:g} s of the support's motion"
    return True, f"support.extrapolation is harmonic: waves are fitted to {window}"


def _onset_watch(scene: Scene) -> tuple[bool, str]:
    if scene.watching is None:
        return False, "onset.watch is false: nobody asks how near a body is to sliding and tipping"
    return True, "onset.watch is true: how near to sliding and tipping, now and in the forecast, with levels"


def _cylinder(scene: Scene) -> tuple[bool, str]:
    if not scene.radius:
        return False, "body.radius is 0: the body has contact points"
    return True, f"body.radius is {scene.radius:g} m: the body lies on two edges of the support"


def _tilt(scene: Scene) -> tuple[bool, str]:
    if scene.source != "imu":
        return False, f"source is {scene.source}: no inertial sensor on a body"
    return True, "source is imu: an inertial sensor tells the tilt of the body, and nothing its place"


def _feet(scene: Scene) -> tuple[bool, str]:
    if scene.walking is None:
        return False, "feet.names is not given: the contact points are fixed to the body"
    count = len(scene.walking.feet)
    return True, f"feet.names has {count}: the motion of each over the ground tells its stance and landings"


def _articulated_inertia(scene: Scene) -> tuple[bool, str]:
    if scene.walking is None:
        return False, "robot.urdf is not given: one rigid body, and no topic joint_states"
    if scene.walking.robot is None:
        return False, "robot.urdf is not given: one rigid body on legs without mass"
    return True, f"robot.urdf is {scene.walking.robot.urdf}: joint_states tell feet and inertia, through Pinocchio"


def _force_sensors(scene: Scene) -> tuple[bool, str]:
    if scene.walking is None or not scene.walking.force:
        return False, "feet.force is 0: no force sensors, and no subscription to contact_wrench"
    return True, f"feet.force is {scene.walking.force:g} N: the topic contact_wrench confirms which feet stand"


def _schedule(scene: Scene) -> tuple[bool, str]:
    if scene.walking is None or not scene.walking.has_schedule:
        return False, "feet.has_schedule is false: no planner tells when feet are to stand, and no such subscription"
    return True, "feet.has_schedule is true: the topic schedule tells when feet are to stand, so landings may be late"


def _margins(scene: Scene) -> tuple[bool, str]:
    if not scene.margins:
        return False, "margins is false: nobody asks how far an impact is from another mode"
    return True, "margins is true: how far each impact is from another mode, computed while somebody reads ~/prediction"


def _uncertainty(scene: Scene) -> tuple[bool, str]:
    if not scene.samples:
        return False, "uncertainty.samples is 0: no probabilities are asked for, which would need numpy and numba"
    return True, f"uncertainty.samples is {scene.samples}: so many points carry the uncertainty through each impact"


RULES: Final[Mapping[str, Rule]] = {
    "friction": _friction,
    "restitution": _restitution,
    "twist window": _twist_window,
    "transverse slip": _transverse_slip,
    "geometry topic": _geometry_topic,
    "moving support": _moving_support,
    "harmonic extrapolation": _harmonic_extrapolation,
    "onset watch": _onset_watch,
    "cylinder": _cylinder,
    "tilt": _tilt,
    "feet": _feet,
    "articulated inertia": _articulated_inertia,
    "force sensors": _force_sensors,
    "schedule": _schedule,
    "margins": _margins,
    "uncertainty": _uncertainty,
}
"""Whether a body has each feature, and why."""
