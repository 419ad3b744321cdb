"""What a scene consists of: one body, the support it strikes, how it is observed, and so which messages it needs.

`features_of` tells what a scene has and what it leaves out, with the parameter that says so.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from math import hypot, inf
from typing import Any, Final, NamedTuple

from ..mechanics.impact.answer import VALIDITY
from ..mechanics.types import Validity
from ..parameters.types import values_of
from .types import Vector3

InertiaTensor = tuple[Vector3, Vector3, Vector3]

ODOM: Final = "odom"
IMU: Final = "imu"
CONTACT_GEOMETRY: Final = "contact_geometry"
FEET_STATES: Final = "feet_states"
JOINTS: Final = "joint_states"
WRENCH: Final = "contact_wrench"
SCHEDULE: Final = "schedule"
TERRAIN: Final = "terrain"
TRANSFORMS: Final = ("tf_static", "tf")  # for all bodies, and by these names for all nodes

POINTS: Final = (CONTACT_GEOMETRY, FEET_STATES, JOINTS)  # what tells where the contact points of a body are
STATES: Final = (ODOM, IMU)  # what tells how a body moves; everything else is told about it

SWITCHES: Final = {
    "friction": "contact.friction",
    "restitution": "contact.restitution",
    "twist window": "odom.twist_window",
    "geometry topic": "!body.contact_points !body.radius !robot.urdf",
    "moving support": "support.motion",
    "onset watch": "onset.watch",
    "lashings": "lashings.points",
    "chocks": "chocks.points",
    "wind": "wind.pressure",
    "friction band": "contact.friction_band",
    "cylinder": "body.radius",
    "three dimensions": "!body.radius",
    "tilt": "source",
    "feet": "feet.names",
    "articulated inertia": "feet.names robot.urdf",
    "drives": "feet.names robot.urdf robot.drives",
    "force sensors": "feet.names feet.force",
    "schedule": "feet.names feet.has_schedule",
    "terrain": "feet.names feet.terrain",
    "friction of feet": "feet.names feet.friction",
    "restitution of feet": "feet.names feet.restitution",
    "radius of feet": "feet.names feet.radius",
    "transforms": "tf.body_frame",
    "margins": "margins",
    "uncertainty": "uncertainty.samples",
    "several bodies": "bodies",
    "events executor": "executor",
}
"""For each feature the parameters that must all switch it on; those with a ! switch it off where they are given."""

ON: Final = {
    "support.motion": {"odom", "imu"},
    "source": {"imu"},
    "executor": {"events"},
    "robot.drives": {"held", "pd"},
}
"""The choices that switch a feature on; of every other parameter all values do but nothing, zero and false."""


class MovingDeck(NamedTuple):
    """How a moving support is observed; SI units.

    `source` is "odom" (pose and twist) or "imu", which lies at `imu_position` in the support's frame with its axes;
    `window` in s over which accelerations are estimated, 0 for the one that errs least; a message older than `timeout`
    s tells nothing any more; `extent` is (least x, greatest x, least y, greatest y) of the deck in its frame, () for
    one without end.
    """

    source: str = "odom"
    imu_position: Vector3 = (0.0, 0.0, 0.0)
    window: float = 0.2
    timeout: float = 0.5
    extent: tuple[float, ...] = ()


class Watching(NamedTuple):
    """When the margins of a body against sliding and tipping raise its level.

    `warn` and `error` are parts of the margin that is used up (1 at the onset); a level falls again when the part is
    `hysteresis` below them for `hold` s. Once the sea is learnt, it is warned of an onset within `horizon` s that is so
    likely that at most the part `vain` of the warnings are vain.
    """

    warn: float = 0.7
    error: float = 1.0
    hysteresis: float = 0.1
    hold: float = 5.0
    horizon: float = 10.0
    vain: float = 0.5


class Lashing(NamedTuple):
    """From a `point` on the body (m, in its frame) to an `anchor` on the support (m, in the support's frame).

    It bears up to its maximum securing load `msl` (N); at rest it has a `preload` (N), and it grows by `stiffness`
    (N/m), or, where that is 0, to its MSL on a hundredth of its length.
    """

    point: Vector3
    anchor: Vector3
    msl: float
    preload: float = 0.0
    stiffness: float = 0.0


class Chock(NamedTuple):
    """A one-sided contact at a `point` (m) that pushes the body along its `normal`, a unit vector, with up to
    `strength` (N), both in the support's frame.
    """

    point: Vector3
    normal: Vector3
    strength: float = inf


class Wind(NamedTuple):
    """A wind of a `pressure` (N/m^2) from any side on the areas (m^2) along x and along y, at `center` (m, body)."""

    pressure: float
    area: tuple[float, float]
    center: Vector3


class Robot(NamedTuple):
    """The model of an articulated machine: a file `urdf`, and the frame in it of each point of the feet, in order.

    With `soles` each foot has one frame, along whose axes these are x y z (m) of its points, of every foot the same.
    `armature` (kg m^2) of each joint is the inertia of its rotor, seen from the joint. Its `drives` are "free", "held",
    or "pd", with the gains `kp` (N m/rad) and `kd` (N m s/rad) of each joint. One number is that of all joints; several
    are in the order of the names `joints`. Of prismatic joints the units are kg, N/m and N s/m.
    """

    urdf: str
    frames: tuple[str, ...]
    joints: tuple[str, ...] = ()
    armature: tuple[float, ...] = ()
    drives: str = "free"
    kp: tuple[float, ...] = ()
    kd: tuple[float, ...] = ()
    soles: tuple[float, ...] = ()


class Walking(NamedTuple):
    """How a machine's feet are told to stand or to swing; SI units.

    `feet` are their names and each has `points` contact points (1, 2 for heel and toe, or corners), which follow each
    other in the geometry in this order. A change of stance is believed after `dead_time` s; contact points older than
    `timeout` s tell nothing any more. From `force` (N) on its `force_source`, the "sensor" or the "effort" of the
    joints, says that a foot stands; 0 where neither does. `has_schedule` tells that a planner does publish when the
    feet are to stand. Without a `robot` the legs have no mass and the body is rigid. `friction` and `restitution` of
    each foot, or one for all; empty where they are the scene's.
    The stamps of the feet are later than the trunk's by a `delay` in s, which is found by itself with `find_delay`.
    Its points are the centres of balls of a `radius` in m, of each foot or one for all; empty where they are the
    model's, and without one points. The ground is told as a map whose heights are gathered in cells of `terrain` m; 0
    where none is told.
    """

    feet: tuple[str, ...]
    points: int = 1
    dead_time: float = 0.02
    timeout: float = 0.1
    force: float = 0.0
    force_source: str = "sensor"
    delay: float = 0.0
    find_delay: bool = False
    has_schedule: bool = False
    terrain: float = 0.0
    radius: tuple[float, ...] = ()
    robot: Robot | None = None
    friction: tuple[float, ...] = ()
    restitution: tuple[float, ...] = ()

    def at_points(self, told: tuple[float, ...], points: list[int]) -> list[float]:
        """What is `told` of each foot, or of all, at some points of theirs, by the indices of these."""
        return [told[i // self.points] if len(told) > 1 else told[0] for i in points]


class Scene(NamedTuple):
    """A body over a plane; SI units, the body's quantities in the body frame.

    `inertia` is about the mass centre; `points` are the contact points, empty where they come with the samples;
    `body_frame` is the name of the body's frame where transforms may tell of it, "" where none are asked for;
    `normal` is the support's unit normal and `height` its distance from the origin along it, in the frame of the
    samples; `tolerance` the gap in m below which a point touches, if gaps scatter less; `contact_time` in s how long a
    contact lasts, and `merge` its compression, unless its `stiffness` in N/m tells that of a foot (0: it is not known);
    more than `most_points` contact points in a message are refused;
    `twist_window` in s the time over which the source averages its twist, 0 for a twist of the very instant;
    `horizon` in s how far ahead a touchdown is announced; `samples` how many points carry uncertainty through an
    impact, 0 for none, with the standard deviations of friction and restitution; `margins` whether a touchdown keeps
    the impact whose margins can be read; `validity` from where on rigid theory is too simple.

    `deck` tells that the support moves: then `normal`, `height` and the predicted impacts are in its frame, while
    `gravity` stays in the world's. `source` of the body's state is "odom", "imu" (its tilt alone) or "none"; it stands
    at `place` in the support's frame, turned by `yaw` about the normal, until its source says more. A `radius` above
    zero makes it a cylinder along the line between pairs of `edges` of the support, on which it lies, in the place of
    `points`: x y z of one point of each edge, in the support's frame. `watching` tells to watch its margins. `walking`
    makes it a machine whose contact points are its feet, which move against the body; with a robot, `mass` is that of
    its model once this is read, and `inertia` is not used. `lashings`, `chocks` and `wind` count in the margins under
    watch, and so do the lowest and the highest friction of the `friction_band`.
    """

    mass: float
    inertia: InertiaTensor
    friction: float
    restitution: float = 0.0
    center_of_mass: Vector3 = (0.0, 0.0, 0.0)
    points: tuple[Vector3, ...] = ()
    frame: str = ""
    body_frame: str = ""
    normal: Vector3 = (0.0, 0.0, 1.0)
    height: float = 0.0
    gravity: Vector3 = (0.0, 0.0, -9.81)
    tolerance: float = 0.005
    contact_time: float = 0.005
    merge: float = 0.0015
    stiffness: float = 0.0
    most_points: int = 1000
    poses: bool = False
    gap_deviation: float = -1.0
    law_deviation: float = 0.15
    twist_window: float = 0.0
    horizon: float = 0.25
    law: str = "path"
    samples: int = 0
    friction_deviation: float = 0.0
    restitution_deviation: float = 0.0
    margins: bool = False
    validity: Validity = VALIDITY
    deck: MovingDeck | None = None
    source: str = "odom"
    place: Vector3 = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    radius: float = 0.0
    edges: tuple[Vector3, ...] = ()
    watching: Watching | None = None
    walking: Walking | None = None
    lashings: tuple[Lashing, ...] = ()
    chocks: tuple[Chock, ...] = ()
    wind: Wind | None = None
    friction_band: tuple[float, ...] = ()

    @classmethod
    def from_parameters(cls, values: Mapping[str, Any]) -> Scene:
        """The scene of validated parameters (see `impact_predictor.parameters.validation`)."""
        normal = values["support.normal"]
        length = hypot(*normal)
        robot = _record(Robot, "robot", values) if values["robot.urdf"] else None
        motion, feet, pull = values["support.motion"], values["feet.names"], hypot(*values["gravity"])
        points = () if values["body.radius"] or feet else values["body.contact_points"]
        return cls(
            mass=values.get("body.mass", 1.0),
            inertia=inertia_matrix(values.get("body.inertia", (1.0,))),
            friction=values["contact.friction"],
            restitution=values["contact.restitution"],
            center_of_mass=triple(values["body.center_of_mass"]),
            points=triples(points),
            frame=values["support.frame"],
            body_frame=values["tf.body_frame"],
            normal=triple([part / length for part in normal]),
            height=values["support.height"],
            gravity=triple(values["gravity"]),
            tolerance=values["contact.tolerance"],
            contact_time=values["contact.time"],
            merge=values["contact.merge"],
            stiffness=values["contact.stiffness"],
            most_points=values["contact.most_points"],
            poses=values["odom.twist"] == "poses",
            gap_deviation=values["uncertainty.gap"],
            law_deviation=values["uncertainty.law"],
            twist_window=values["odom.twist_window"],
            horizon=values["horizon"],
            law=values["law"],
            samples=values["uncertainty.samples"],
            friction_deviation=values["uncertainty.friction"],
            restitution_deviation=values["uncertainty.restitution"],
            margins=values["margins"],
            validity=_record(Validity, "validity", values, gravity=pull, contact_time=values["contact.time"]),
            deck=None if motion == "fixed" else _record(MovingDeck, "support", values, source=motion),
            source=values["source"],
            place=triple(values["place.position"]),
            yaw=values["place.yaw"],
            radius=values["body.radius"],
            edges=triples(values["support.edges"]),
            watching=_record(Watching, "onset", values) if values["onset.watch"] else None,
            walking=_record(Walking, "feet", values, feet=feet, robot=robot) if feet else None,
            lashings=_lashings(values),
            chocks=_chocks(values),
            wind=_record(Wind, "wind", values) if values["wind.pressure"] else None,
            friction_band=values["contact.friction_band"],
        )

    @property
    def held_by_friction(self) -> bool:
        """Whether nothing else holds the body on its support, or pushes it."""
        return not (self.lashings or self.chocks or self.wind or self.radius)

    @property
    def needs_geometry(self) -> bool:
        """Whether the contact points come from a topic of their own."""
        return not (self.points or self.radius or (self.walking is not None and self.walking.robot is not None))


def scenes_of(values: Mapping[str, Any]) -> dict[str, Scene]:
    """The scene of each body of validated parameters, by its name; of the only one without a name by ""."""
    return {body: Scene.from_parameters(values_of(values, body)) for body in values["bodies"] or ("",)}


def read_scenes(path: str | os.PathLike[str]) -> dict[str, Scene]:
    """The scene of each body of a ROS 2 parameter file, by its name; of the only one without a name by "".

    Raises:
        InputError: the file cannot be read, or a parameter is wrong.
    """
    from ..parameters.file import read_values  # the node has its parameters from elsewhere

    return scenes_of(read_values(path))


def shared_by(scenes: Mapping[str, Scene]) -> Scene:
    """Any of the scenes, for what all of them share: the motion of the support, its frame, and gravity."""
    return next(iter(scenes.values()))


class Input(NamedTuple):
    """A topic that is read: its relative name, what it carries, and of which body; None for the support and frames."""

    name: str
    kind: str
    body: str | None


def inputs_of(scenes: Mapping[str, Scene]) -> tuple[Input, ...]:
    """Every input of the bodies, in the order in which messages that wait at the same time are best served.

    Frames and the support come first and what is told about a body before its states, so that each finds what it needs.
    """
    deck = shared_by(scenes).deck
    found = [Input(kind, kind, None) for kind in TRANSFORMS if any(scene.body_frame for scene in scenes.values())]
    found += [] if deck is None else [Input(f"support/{deck.source}", deck.source, None)]
    told = [(body, kind) for body, scene in scenes.items() for kind in _told_about(scene)]
    told += [(body, scene.source) for body, scene in scenes.items() if scene.source in STATES]
    return (*found, *[Input(f"{body}/{kind}" if body else kind, kind, body) for body, kind in told])


def _told_about(scene: Scene) -> list[str]:
    walking = scene.walking or Walking(())
    told = {
        CONTACT_GEOMETRY: scene.needs_geometry,
        FEET_STATES: scene.needs_geometry and scene.walking is not None,
        JOINTS: walking.robot is not None,
        WRENCH: walking.force > 0.0 and walking.force_source == "sensor",
        SCHEDULE: walking.has_schedule,
        TERRAIN: walking.terrain > 0.0,
    }
    return [kind for kind, is_told in told.items() if is_told]


def _record(record: Any, group: str, values: Mapping[str, Any], **others: Any) -> Any:
    """A record whose fields are the parameters of a group, or `others`."""
    names = [name for name in record._fields if name not in others]
    return record(**{name: values[f"{group}.{name}"] for name in names}, **others)


def each_of(numbers: Sequence[float], count: int, default: float) -> tuple[float, ...]:
    """What is given for each of some things, for all of them, or not at all."""
    return tuple(numbers) if len(numbers) == count else (*numbers, default)[:1] * count


def _lashings(values: Mapping[str, Any]) -> tuple[Lashing, ...]:
    points = triples(values["lashings.points"])
    loads = [each_of(values[f"lashings.{name}"], len(points), 0.0) for name in ("msl", "preload", "stiffness")]
    ends = triples(values["lashings.anchors"])
    return tuple([Lashing(*one) for one in zip(points, ends, *loads, strict=True)])


def _chocks(values: Mapping[str, Any]) -> tuple[Chock, ...]:
    found = []
    points = triples(values["chocks.points"])
    strengths = each_of(values["chocks.strength"], len(points), inf)
    for point, (x, y, z), strength in zip(points, triples(values["chocks.normals"]), strengths, strict=True):
        length = hypot(x, y, z)
        found.append(Chock(point, (x / length, y / length, z / length), strength))
    return tuple(found)


def inertia_matrix(numbers: Sequence[float]) -> InertiaTensor:
    """The inertia tensor of one number (the same about every axis) or of ixx, iyy, izz, ixy, ixz, iyz."""
    xx, yy, zz, xy, xz, yz = (*(numbers[0],) * 3, 0.0, 0.0, 0.0) if len(numbers) == 1 else numbers
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def triples(numbers: Sequence[float]) -> tuple[Vector3, ...]:
    return tuple(triple(numbers[i : i + 3]) for i in range(0, len(numbers), 3))


def triple(numbers: Sequence[float]) -> Vector3:
    x, y, z = numbers
    return float(x), float(y), float(z)


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
    """Whether a body has a feature, by the first parameter that leaves it out, or else by the last of all."""
    off = []
    for switch in switches:
        parameter = switch.lstrip("!")
        is_on = values[parameter] in ON[parameter] if parameter in ON else bool(values[parameter])
        off += [parameter] if is_on == switch.startswith("!") else []
    parameter = (off[0] if off else switches[-1]).lstrip("!")
    value = values[parameter]
    said = str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, int | float) else value
    if isinstance(value, tuple | list):
        said = "given"
    return Feature(name, not off, f"{parameter} is {said if value or said in ('0', 'false') else 'not given'}")
