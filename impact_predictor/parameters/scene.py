"""Whether values that are each allowed also make a scene together."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from math import copysign, cos, hypot, inf, sin
from typing import Any

from ..errors import InputError
from .table import PARAMETERS

INCLINED = 1e-6
"""A unit normal that differs from z by more than this is inclined: less is rounding."""

OF_FEET = {
    "source": ("odom", "its pose and twist must be measured"),
    "support.motion": ("fixed", "its ground must not move"),
    "body.radius": (0.0, "it touches the ground with its feet"),
    "onset.watch": (False, "it is not watched for sliding and tipping"),
    "margins": (False, "the margins of its impacts are not known"),
    "uncertainty.samples": (0, "no uncertainty is carried through its impacts"),
    "odom.twist_window": (0.0, "its twist must be that of the very instant"),
    "odom.twist": ("message", "its twist must be that of the very instant"),
}
"""What a parameter must be for a machine that walks, and why."""

ROBOT = tuple(name for name in PARAMETERS if name.startswith("robot.") and name != "robot.urdf")

SECURING = ("lashings.points", "chocks.points", "wind.pressure", "contact.friction_band")
"""What the margins under watch know of besides friction."""

NO_LENGTH = 1e-3  # m: a lashing that is shorter has no direction
LONGEST_LASHING = 100.0  # m

OFF = 0.01
"""A body may be placed this part of its size above or below its support: its place was measured with a tape."""


class _Given:
    """The values that hold for one body, and the names under which they were given."""

    def __init__(self, body: str, values: Mapping[str, Any], given: Collection[str]) -> None:
        self.values = values
        self.of = f" of {body}" if body else ""
        self._prefix = f"{body}." if body else ""
        self._given = given

    def is_own(self, name: str) -> bool:
        """Whether a value was given for this body alone, or is that of the only body."""
        return self._prefix + name in self._given

    def named(self, name: str) -> str:
        """The name under which a value was given, to be changed there."""
        return self._prefix + name if self.is_own(name) else name


def check_body(body: str, values: Mapping[str, Any], given: Collection[str]) -> None:
    """Whether the values that hold for a body fit together.

    `given` has the names that were given, and so shows which values were chosen. InputError where they do not fit.
    """
    one = _Given(body, values, given)
    _check_feet(one)
    _check_source(one)
    _check_cylinder(one)
    _check_securing(one)
    is_felt = values["support.motion"] != "fixed" or values["onset.watch"]
    if is_felt and sum(g * n for g, n in zip(values["gravity"], values["support.normal"], strict=True)) > 0.0:
        raise InputError(
            f"gravity points out of the support{one.of}, so everything falls off it: it is the acceleration of a free "
            "body, [0.0, 0.0, -9.81] where z points up"
        )
    if values["onset.watch"] and values["source"] != "odom":
        _check_place(one)
    if values["onset.warn"] > values["onset.error"]:
        raise InputError(
            f"{one.named('onset.warn')} is {values['onset.warn']:g}, above {one.named('onset.error')}, which is "
            f"{values['onset.error']:g}: the level is WARN before it is ERROR"
        )


def _check_source(one: _Given) -> None:
    values = one.values
    if values["source"] == "odom":
        return
    source = f"{one.named('source')} is {values['source']}"
    if values["support.motion"] == "fixed" and not values["onset.watch"]:
        raise InputError(
            f"{source}, so no impact can be predicted: set onset.watch: true to watch the body, or source: odom"
        )
    if not (values["body.contact_points"] or values["body.radius"]):
        raise InputError(f"{source}, so the contact points{one.of} must be parameters: give body.contact_points")
    if not _is_on(values["support.extent"], *values["place.position"][:2]):
        raise InputError(f"{one.named('place.position')}{one.of} is outside support.extent: put the body on it")


def _check_cylinder(one: _Given) -> None:
    radius, edges, points = "body.radius", "support.edges", "body.contact_points"
    if not one.values[radius]:
        if one.values[edges] and one.is_own(edges):
            raise InputError(f"{one.named(edges)} carry a cylinder: give the radius of the body as {radius}")
        return
    if not one.values[edges]:
        raise InputError(f"{one.named(radius)} makes the body a cylinder: give the {edges} on which it lies")
    # Points that are common to the other bodies may stand beside the radius of one.
    if one.values[points] and one.is_own(points) >= one.is_own(radius):
        raise InputError(f"{one.named(points)} and {one.named(radius)} are both given: a cylinder has no points")


def _check_securing(one: _Given) -> None:
    """Whether lashings, chocks, wind and the band of friction make sense for a body."""
    values = one.values
    for name in SECURING:
        if values[name] and one.is_own(name) and (values["body.radius"] or not values["onset.watch"]):
            wanted = "not for a cylinder" if values["body.radius"] else "so set onset.watch: true"
            raise InputError(f"{one.named(name)} counts in the margins{one.of} under watch alone, {wanted}")
    for group, other in (("lashings", "anchors"), ("chocks", "normals")):
        points, others = values[f"{group}.points"], values[f"{group}.{other}"]
        if len(points) != len(others):
            raise InputError(
                f"{one.named(f'{group}.points')} has {len(points) // 3} points{one.of}, but {group}.{other} has "
                f"{len(others) // 3}: give one for each"
            )
        for name in ("lashings.msl", "lashings.preload", "lashings.stiffness", "chocks.strength"):
            if name.startswith(group) and len(values[name]) not in (0, 1, len(points) // 3):
                raise InputError(
                    f"{one.named(name)} has {len(values[name])} numbers{one.of}, but {group}.points has "
                    f"{len(points) // 3} points: give one number for each, or one for all of them"
                )
    if values["lashings.points"]:
        _check_lashings(one)
    chocks = values["chocks.normals"]
    if any(not hypot(*chocks[k : k + 3]) for k in range(0, len(chocks), 3)):
        raise InputError(f"{one.named('chocks.normals')}{one.of} has a direction of length zero: tell where it pushes")
    if values["wind.pressure"] and not values["wind.area"]:
        raise InputError(f"{one.named('wind.pressure')} is given{one.of}, but no wind.area that it acts on: give both")
    lowest, highest = values["contact.friction_band"] or (0.0, inf)
    if not lowest <= values["contact.friction"] <= highest:
        raise InputError(
            f"{one.named('contact.friction_band')}{one.of} is {lowest:g} to {highest:g}, and contact.friction is "
            f"{values['contact.friction']:g}: it must lie between them"
        )


def _check_lashings(one: _Given) -> None:
    values = one.values
    points, anchors, msl = values["lashings.points"], values["lashings.anchors"], values["lashings.msl"]
    count = len(points) // 3
    if not msl or min(msl) <= 0.0:
        raise InputError(f"lashings.msl{one.of} must be above 0 N: give what each of the {count} lashings may bear")
    preload = values["lashings.preload"] or (0.0,)
    x, y, z = values["place.position"]
    turn, back = cos(values["place.yaw"]), sin(values["place.yaw"])
    for k in range(count):
        its, most = preload[k % len(preload)], msl[k % len(msl)]
        if its > most:
            raise InputError(f"lashing {k}{one.of} has an MSL of {most:g} N, below its preload of {its:g} N")
        (px, py, pz), (ax, ay, az) = points[3 * k : 3 * k + 3], anchors[3 * k : 3 * k + 3]
        length = hypot(x + turn * px - back * py - ax, y + back * px + turn * py - ay, z + pz - az)
        if length < NO_LENGTH:
            raise InputError(f"lashing {k}{one.of} has no length: its point and its anchor are at one place")
        if not _is_on(values["support.extent"], ax, ay):
            raise InputError(f"lashing {k}{one.of} goes nowhere: its anchor is outside support.extent")
        if length > LONGEST_LASHING:
            raise InputError(f"lashing {k}{one.of} goes nowhere: its anchor is {length:g} m away")


def _is_on(extent: tuple[float, ...], x: float, y: float) -> bool:
    return not extent or (extent[0] <= x <= extent[1] and extent[2] <= y <= extent[3])


def _check_feet(one: _Given) -> None:
    values, feet = one.values, "feet.names"
    if not values[feet]:
        for name, parameter in PARAMETERS.items():
            of_feet = name.startswith(("feet.", "robot."))
            if of_feet and values[name] != parameter.default and one.is_own(name):
                raise InputError(f"{one.named(name)} is for a machine that walks: give the names of its feet as {feet}")
        return
    for name, (needed, why) in OF_FEET.items():
        if values[name] != needed:
            given, wanted = (str(value).lower() for value in (values[name], needed))
            raise InputError(
                f"{one.named(name)} is {given}, but {one.named(feet)} makes the body{one.of} a machine that walks, "
                f"and {why}: give {wanted}"
            )
    if not values["contact.tolerance"]:
        raise InputError(f"{one.named('contact.tolerance')} is 0, which feet do not learn: give it in m")
    # Points that are common to the other bodies may stand beside the feet of one.
    points = "body.contact_points"
    if values[points] and one.is_own(points) >= one.is_own(feet):
        raise InputError(
            f"{one.named(points)} and {one.named(feet)} are both given: feet move, so their points come with messages"
        )
    for name in ("feet.friction", "feet.restitution", "feet.radius"):
        if len(values[name]) not in (0, 1, len(values[feet])):
            raise InputError(
                f"{one.named(name)} has {len(values[name])} numbers{one.of}, but feet.names has {len(values[feet])}: "
                "give one number for each foot, or one for all of them"
            )
    if values["feet.force_source"] == "effort" and not (values["robot.urdf"] and values["feet.force"]):
        raise InputError(
            f"{one.named('feet.force_source')} is effort{one.of}: give robot.urdf, by which joints tell the force on "
            "a foot, and feet.force, from which on it stands"
        )
    frames, named = len(values["robot.frames"]), one.named("robot.frames")
    for name in ROBOT:
        if not values["robot.urdf"] and values[name] != PARAMETERS[name].default and one.is_own(name):
            raise InputError(f"{one.named(name)} is for the model of a machine: give its file as robot.urdf")
    soles, points = len(values["robot.soles"]), values["feet.points"]
    if soles not in (0, 3 * points):
        raise InputError(
            f"{one.named('robot.soles')} has {soles} numbers{one.of}, but feet.points is {points}: give x y z of each "
            "point of a foot, which all feet have alike"
        )
    if values["robot.urdf"] and frames != len(values[feet]) * (1 if soles else points):
        raise InputError(
            f"{named} has {frames} names{one.of}, but feet.names has {len(values[feet])} and feet.points "
            f"is {points}: give one frame for each point of each foot, or for each foot with robot.soles"
        )

    gains = [name for name in ("robot.kp", "robot.kd") if values[name]]
    if bool(gains) is not (values["robot.drives"] == "pd"):
        raise InputError(
            f"{one.named('robot.drives')} is {values['robot.drives']}{one.of} with "
            f"{' and '.join(gains) or 'no gains'}: give pd and at least one of robot.kp and robot.kd, or neither"
        )
    for name in ("robot.armature", *gains):
        if len(values[name]) not in (0, 1, len(values["robot.joints"])):
            raise InputError(
                f"{one.named(name)} has {len(values[name])} numbers{one.of}, but robot.joints has "
                f"{len(values['robot.joints'])} names: give one number for all joints, or name each joint there"
            )


def _check_place(one: _Given) -> None:
    """Whether a body that is watched where it was placed, for nothing tells its pose, stands on its support there."""
    values = one.values
    x, y, z = values["support.normal"]
    length = hypot(x, y, z)
    if hypot(x, y, z - length) > INCLINED * length:
        raise InputError(
            f"{one.named('support.normal')}{one.of} is not along z, and {one.named('source')} is {values['source']}: "
            "the place of a body is not turned onto an inclined support, so give source: odom, or choose the support's "
            "frame with z along the normal"
        )
    gap, size = _gap_of_cylinder(values) if values["body.radius"] else _gap_of_points(values)
    if abs(gap) > max(values["contact.tolerance"], OFF * size):
        place, support = one.named("place.position"), "edges" if values["body.radius"] else "support"
        wrong = f"floats {gap:.3g} m above its {support}" if gap > 0.0 else f"sinks {-gap:.3g} m into its {support}"
        raise InputError(f"at {place} the body{one.of} {wrong}: correct {place}, or where its {support} is")


def _gap_of_points(values: Mapping[str, Any]) -> tuple[float, float]:
    """How far the lowest contact point is above a level support, and the size of the body, in m."""
    points = values["body.contact_points"]
    lowest = values["place.position"][2] + min(points[2::3]) - values["support.height"]
    return lowest, hypot(*(max(points[i::3]) - min(points[i::3]) for i in range(3)))


def _gap_of_cylinder(values: Mapping[str, Any]) -> tuple[float, float]:
    """How far a cylinder is from that of its edges from which it is wrong most, and its size, in m."""
    radius, (ax, ay, az, bx, by, bz) = values["body.radius"], values["support.edges"]
    width, rise = hypot(bx - ax, by - ay), bz - az
    if width == 0.0:  # no edges for a cylinder, whatever its place: that is refused with the cylinder
        return 0.0, 2.0 * radius
    (x, y, z), (cx, cy, cz), yaw = values["place.position"], values["body.center_of_mass"], values["place.yaw"]
    x, y, high = x + cx * cos(yaw) - cy * sin(yaw), y + cx * sin(yaw) + cy * cos(yaw), z + cz - az
    aside = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / width
    side = copysign(1.0, width * high - rise * aside)  # an axis below the line between the edges hangs under them
    gaps = side * hypot(aside, high) - radius, side * hypot(aside - width, high - rise) - radius
    return max(gaps, key=abs), 2.0 * radius
