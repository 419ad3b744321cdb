"""Why a body has a part of the predictor or leaves it out, in words of its scene, from the values of that body."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Values = Mapping[str, Any]


def why_friction(values: Values) -> str:
    if values["feet.names"]:
        return (
            f"contact.friction is {values['contact.friction']:g}: what keeps the feet that stand and land from slipping"
        )
    if values["contact.friction"]:
        return f"contact.friction is {values['contact.friction']:g}: a stance may stick, and then moves in closed form"
    return "contact.friction is 0: every stance slips, and its motion is integrated"


def why_restitution(values: Values) -> str:
    if values["contact.restitution"]:
        return f"contact.restitution is {values['contact.restitution']:g}: the new contact also pushes back"
    return "contact.restitution is 0: a plastic impact ends with the compression"


def why_twist_window(values: Values) -> str:
    if values["odom.twist_window"]:
        window = f"odom.twist_window is {1e3 * values['odom.twist_window']:g} ms"
        return f"{window}: the twist is older than its stamp, and may have the impact in it"
    return "odom.twist_window is 0: the twist is that of the very instant"


def has_geometry(values: Values) -> bool:
    if values["feet.names"]:
        return not values["robot.urdf"]
    return values["source"] == "odom" and not (values["body.contact_points"] or values["body.radius"])


def why_geometry(values: Values) -> str:
    if values["robot.urdf"]:
        return "robot.urdf is given, so the feet are where joint_states says, and there is no contact_geometry"
    if values["feet.names"]:
        return "feet.names makes it a machine that walks, so its points keep coming with the topic contact_geometry"
    if values["body.radius"]:
        return "body.radius makes the body a cylinder, so there is no subscription to contact_geometry"
    if values["body.contact_points"]:
        return "the contact points are parameters, so there is no subscription to contact_geometry"
    return "body.contact_points is not given, so the points come from the topic contact_geometry"


def has_transverse(values: Values) -> bool:
    in_scene = values["transverse_slip"] and values["law"] == "path"
    in_scene = in_scene and not (values["body.radius"] or values["feet.names"])
    return bool(in_scene and values["contact.friction"] > 0.0)


def why_transverse(values: Values) -> str:
    if values["body.radius"]:
        return "body.radius makes the body a cylinder: friction acts in the impact plane alone"
    if values["feet.names"]:
        return "feet.names makes it a machine that walks: friction acts in the impact plane alone"
    if not values["transverse_slip"]:
        return "transverse_slip is false: friction acts in the impact plane alone"
    if values["law"] != "path":
        return f"the law is {values['law']}, which knows no slip across the impact plane"
    if not values["contact.friction"]:
        return "contact.friction is 0: nothing opposes slip across the impact plane either"
    return "transverse_slip is true: friction also opposes slip across the impact plane"


def why_margins(values: Values) -> str:
    if values["margins"]:
        return "margins is true: how far each impact is from another mode, told while somebody reads ~/prediction"
    return "margins is false: nobody asks how far an impact is from another mode"


def why_uncertainty(values: Values) -> str:
    samples = values["uncertainty.samples"]
    if samples:
        return f"uncertainty.samples is {samples}: so many points carry the uncertainty through each impact"
    return "uncertainty.samples is 0: no probabilities are asked for, which would need numpy and numba"


def why_moving(values: Values) -> str:
    motion = values["support.motion"]
    if motion == "fixed":
        return "support.motion is fixed: a floor, and no topic of its motion"
    told = "its pose and twist" if motion == "odom" else "an inertial sensor on it"
    return f"support.motion is {motion}: {told} tell what is felt on it, each body is seen from it"


def has_harmonic(values: Values) -> bool:
    return bool(values["support.motion"] != "fixed" and values["support.extrapolation"] == "harmonic")


def why_harmonic(values: Values) -> str:
    if values["support.extrapolation"] == "constant":
        return "support.extrapolation is constant: the support goes on with the accelerations of now"
    if values["support.motion"] == "fixed":
        return "support.motion is fixed, so there is no motion to extrapolate"
    window = f"{values['support.harmonic_window']:g} s"
    return f"support.extrapolation is harmonic: waves are fitted to the last {window} of the support's motion"


def why_watch(values: Values) -> str:
    if values["onset.watch"]:
        return "onset.watch is true: how near to sliding and tipping, now and in the forecast, with levels"
    return "onset.watch is false: nobody asks how near a body is to sliding and tipping"


def why_cylinder(values: Values) -> str:
    if values["body.radius"]:
        return f"body.radius is {values['body.radius']:g} m: the body lies on two edges of the support"
    return "body.radius is 0: the body has contact points"


def why_tilt(values: Values) -> str:
    if values["source"] == "imu":
        return "source is imu: an inertial sensor tells the tilt of the body, and nothing its place"
    return f"source is {values['source']}: no inertial sensor on a body"


def why_feet(values: Values) -> str:
    if values["feet.names"]:
        feet = len(values["feet.names"])
        return f"feet.names has {feet}: the motion of each over the ground tells its stance and landings"
    return "feet.names is not given: the contact points are fixed to the body"


def why_articulated(values: Values) -> str:
    if values["robot.urdf"]:
        return f"robot.urdf is {values['robot.urdf']}: feet and inertia are those of joint_states, through Pinocchio"
    if values["feet.names"]:
        return "robot.urdf is not given: one rigid body on legs without mass"
    return "robot.urdf is not given: one rigid body, and no topic joint_states"


def why_force(values: Values) -> str:
    if values["feet.names"] and values["feet.force"]:
        return f"feet.force is {values['feet.force']:g} N: the topic contact_wrench confirms which feet stand"
    return "feet.force is 0: no force sensors, and no subscription to contact_wrench"


def why_schedule(values: Values) -> str:
    if values["feet.names"] and values["feet.has_schedule"]:
        return (
            "feet.has_schedule is true: the topic schedule tells when feet are to stand, so landings are early or late"
        )
    return "feet.has_schedule is false: nobody tells when feet are to stand, and there is no such subscription"


def why_several(values: Values) -> str:
    count = len(values["bodies"])
    if count:
        return f"bodies has {count} names: each has topics and a predictor of its own, one support and watch serve all"
    return "bodies is not given: one body, without a name"


def why_events(values: Values) -> str:
    if values["executor"] == "events":
        return "executor is events: rclpy's experimental one, which costs less for each message"
    return "executor is single: rclpy's usual one; events would be its experimental one"
