"""Samples over which the cost of a scene is measured: recorded ones where the package has them, else made ones."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, hypot, pi, sqrt
from pathlib import Path
from random import Random
from typing import Final, NamedTuple

from ...errors import InputError
from ...prediction.planar import inertia_about
from ...prediction.predictor import PAUSE
from ...prediction.scene import MovingDeck, Scene
from ...prediction.types import Geometry, Imu, Joints, Quaternion, Sample, Schedule, Vector3, Wrench
from ...prediction.vectors import add, axes_of, cross, dot, mean, times, to_body, to_world, turned
from ...resources import find
from ...stamps import NANOSECONDS

RATE: Final = 200
"""Samples per second of a made motion."""
STEPS: Final = 20
"""Steps of the integration from one sample to the next."""
LONGEST: Final = 80
"""Samples that are taken of one motion."""
SHARES: Final = (0.1, 0.3, 0.6, 0.9)
"""Tilts from which a body falls, as parts of the way to its balance or of LARGEST_TILT rad, whichever is less."""
LARGEST_TILT: Final = 0.5
THROWS: Final = 6
LEVEL: Final = 1e-3
"""Points that lie higher by less than this part of the body's size are on one level."""
COVARIANCE: Final = tuple(1e-4 if i % 7 == 0 else 0.0 for i in range(36))

GAP: Final = 0.3
"""Seconds between two made motions: longer than a pause."""
SUPPORT_RATE: Final = 100
"""Messages per second about a support at rest, which count where the support is said to move."""
BEFORE: Final = 0.4
"""Seconds of them before each recorded motion: twice the usual window."""
LEAD: Final = 1.5
"""Seconds of them before the first motion, beyond their window: in less nobody believes what a sensor feels."""

Motion = list[Sample]


class OfSupport(NamedTuple):
    """A message about the support: its pose and twist, or what a sensor on it measures."""

    message: Sample | Imu


Message = Geometry | Sample | OfSupport | Joints | Wrench | Schedule


class Record(NamedTuple):
    """Motions of a body, each after its contact points, and of its support; `origin` says where they are from."""

    messages: tuple[Message, ...]
    points: tuple[Vector3, ...]
    origin: str

    @property
    def samples(self) -> int:
        return sum(isinstance(message, Sample) for message in self.messages)


def record_of(name: str, scene: Scene, samples: int) -> Record:
    """About so many samples for the scene of a name: of examples/NAME where that exists, else made ones."""
    if scene.deck is not None or scene.radius or scene.walking is not None:
        return made(scene)
    try:
        bag = find(f"examples/{name}")
    except InputError:
        return made(scene)
    motions, points = _motions_of(bag, scene)
    if scene.frame not in ("", motions[0][0].frame_id):
        return made(scene)  # another scene of that name
    motions = motions[:: max(1, round(sum(map(len, motions)) / samples))]
    origin = f"{sum(map(len, motions))} samples of examples/{name}, taken from all over it"
    support = [
        message
        for motion in motions
        for message in _still(scene, motion[0].stamp - round(BEFORE * NANOSECONDS), motion[-1].stamp)
    ]
    return _record(motions, points, origin, support)


def made(scene: Scene) -> Record:
    """The body let fall from what it stands on, to every side, and thrown; its support lies still.

    A machine that walks steps on the spot.
    """
    if scene.walking is not None:
        from .steps import steps_of

        return steps_of(scene, scene.walking)
    start = (scene.deck or MovingDeck()).window + LEAD
    motions: list[Motion] = []
    for motion in (*falls(scene), *(() if scene.radius else throws(scene))):
        motions.append([sample._replace(stamp=sample.stamp + round(start * NANOSECONDS)) for sample in motion])
        start = motions[-1][-1].stamp / NANOSECONDS + GAP
    origin = f"{sum(map(len, motions))} samples at {RATE} Hz of falls and throws of this body, made up for this"
    return _record(motions, points_of(scene), origin, _still(scene, 0, round(start * NANOSECONDS)))


def _still(scene: Scene, begin: int, end: int) -> list[OfSupport]:
    """Messages about a support at rest from one stamp to another, in ns."""
    return [OfSupport(still(scene, stamp)) for stamp in range(begin, end, NANOSECONDS // SUPPORT_RATE)]


def _stamp_of(message: Message) -> int:
    return message.message.stamp if isinstance(message, OfSupport) else message.stamp


def still(scene: Scene, stamp: int) -> Sample | Imu:
    """A message about a moving support that lies level at a stamp in ns, at the origin of its world."""
    level, nothing, deck = (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), scene.deck
    if deck is not None and deck.source == "imu":
        return Imu(stamp, frame_of(scene), level, nothing, times(scene.gravity, -1.0))
    return Sample(stamp, frame_of(scene), "support", nothing, level, nothing, nothing, COVARIANCE, COVARIANCE)


def frame_of(scene: Scene) -> str:
    """The frame of made samples."""
    return scene.frame or "world"


def _record(motions: list[Motion], points: tuple[Vector3, ...], origin: str, support: list[OfSupport]) -> Record:
    messages: list[Message] = [*support]
    for motion in motions:
        messages += [Geometry(motion[0].stamp, "", points), *motion]
    # The support comes first where stamps are the same, and the points of the body before its state.
    return Record(tuple(sorted(messages, key=_stamp_of)), points, origin)


def _motions_of(bag: Path, scene: Scene) -> tuple[list[Motion], tuple[Vector3, ...]]:
    """The motions in a bag, cut where it pauses and where they are long; and the contact points of the body."""
    from ...bags.read import read_messages, topics
    from ...ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon

    types = {kind: topic for topic, kind in topics(bag).items()}
    points = scene.points
    motions: list[Motion] = []
    last = 0
    for topic, _, data in read_messages(bag, {types[kind]: kind for kind in (ODOMETRY, POLYGON) if kind in types}):
        if topic == types.get(POLYGON):
            points = points or decode_polygon(data).points
            continue
        sample = decode_odometry(data)
        if not motions or sample.stamp - last > PAUSE or len(motions[-1]) >= LONGEST:
            motions.append([])
        motions[-1].append(sample)
        last = sample.stamp
    return motions, points


def points_of(scene: Scene) -> tuple[Vector3, ...]:
    """The contact points of a scene; where they come with the samples, the corners of the cube of its inertia.

    Those of a cylinder are its edges as it lies on them, seen from its axis.
    """
    if scene.radius:
        first, second = scene.edges
        line = add(second, first, -1.0)
        high = sqrt(scene.radius * scene.radius - 0.25 * dot(line, line))
        rest = add(times(add(first, second), 0.5), scene.normal, high)
        return tuple(add(add(edge, rest, -1.0), scene.center_of_mass) for edge in scene.edges)
    if scene.points:
        return scene.points
    # A cube has the inertia (2/3) m h^2 about its middle, h being half its side.
    h = sqrt(0.5 * sum(scene.inertia[i][i] for i in range(3)) / scene.mass)
    return tuple(add(scene.center_of_mass, (x, y, z)) for x in (-h, h) for y in (-h, h) for z in (-h, h))


def falls(scene: Scene) -> Iterator[Motion]:
    """The body tilted about one side of what it stands on, and let go; nothing where it has no such side."""
    points, center, up = points_of(scene), scene.center_of_mass, (0.0, 0.0, 1.0)
    lowest = min(z for _, _, z in points)
    base = [point for point in points if point[2] - lowest <= LEVEL * _size(points, center)]
    for ahead in ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)):
        behind = min(dot(ahead, point) for point in base)
        foot = mean([point for point in base if dot(ahead, point) - behind <= LEVEL * _size(points, center)])
        arm = add(center, foot, -1.0)
        balance = 0.5 * pi - atan2(arm[2], dot(ahead, arm))
        if behind < max(dot(ahead, point) for point in base) and balance > 0.0:
            for share in SHARES:
                side = cross(up, ahead)
                yield _fall(scene, foot, side, (dot(ahead, arm), arm[2]), share * min(balance, LARGEST_TILT))


def _fall(scene: Scene, foot: Vector3, side: Vector3, arm: tuple[float, float], tilt: float) -> Motion:
    """From a tilt in rad about the foot, against the direction `side`, until the body lies flat, and a bit longer."""
    radius, bearing = hypot(*arm), atan2(arm[1], arm[0])
    stiffness = _pull(scene) * radius / (inertia_about(scene, side, True) / scene.mass + radius * radius)
    upright, ground = upright_of(scene), ground_of(scene, foot)
    states, rate, flat = [], 0.0, 0
    while flat < 5:  # what a touchdown is measured by, and one more
        states.append((tilt, rate))
        for _ in range(STEPS):
            rate -= stiffness * cos(bearing + tilt) / (RATE * STEPS)
            tilt += rate / (RATE * STEPS)
        if tilt <= 0.0:
            tilt, rate, flat = 0.0, 0.0, flat + 1
    motion = []
    for tilt, rate in states[-LONGEST:]:
        orientation, spin = turned(upright, times(side, -tilt)), times(side, -rate)
        position = add(ground, to_world(axes_of(orientation), foot), -1.0)
        motion.append((position, orientation, cross(foot, spin), spin))
    return stamped(scene, motion)


def throws(scene: Scene) -> Iterator[Motion]:
    """The body thrown every which way, until it touches."""
    points, center, random = points_of(scene), scene.center_of_mass, Random(1)
    size, pull, normal = _size(points, center), _pull(scene), scene.normal
    for _ in range(THROWS):
        orientation = turned(upright_of(scene), _any(random, 1.5))
        spin, velocity = _any(random, 0.3 * sqrt(pull / size)), _any(random, 0.3 * sqrt(pull * size))
        height = random.uniform(0.2, 1.0) * size - min(
            dot(normal, to_world(axes_of(orientation), point)) for point in points
        )
        place = add(add(ground_of(scene), normal, height), to_world(axes_of(orientation), center))
        motion, gap = [], size
        while gap > 0.0:
            axes = axes_of(orientation)
            position = add(place, to_world(axes, center), -1.0)
            gap = min(dot(normal, add(position, to_world(axes, point))) for point in points) - scene.height
            motion.append((position, orientation, add(to_body(axes, velocity), cross(center, spin)), spin))
            place = add(place, velocity, 1.0 / RATE)
            velocity = add(velocity, normal, -pull / RATE)
            orientation = turned(orientation, times(spin, 1.0 / RATE))
        yield stamped(scene, motion[-LONGEST:])


def stamped(scene: Scene, motion: list[tuple[Vector3, Quaternion, Vector3, Vector3]]) -> Motion:
    period = NANOSECONDS // RATE
    return [
        Sample(k * period, frame_of(scene), "", position, orientation, linear, angular, COVARIANCE, COVARIANCE)
        for k, (position, orientation, linear, angular) in enumerate(motion)
    ]


def ground_of(scene: Scene, foot: Vector3 | None = None) -> Vector3:
    """Where a foot of the body stands on its support: a cylinder on an edge, else where the body is placed."""
    if scene.radius and foot is not None:
        return next(edge for edge, point in zip(scene.edges, points_of(scene), strict=True) if point == foot)
    return add(scene.place, scene.normal, scene.height - dot(scene.normal, scene.place))


def _any(random: Random, largest: float) -> Vector3:
    return random.uniform(-largest, largest), random.uniform(-largest, largest), random.uniform(-largest, largest)


def _size(points: tuple[Vector3, ...], center: Vector3) -> float:
    return max(hypot(*add(point, center, -1.0)) for point in points)


def _pull(scene: Scene) -> float:
    """Gravity towards the support; the Earth's where there is none."""
    pull = -dot(scene.gravity, scene.normal)
    return pull if pull > 0.0 else 9.81


def upright_of(scene: Scene) -> Quaternion:
    """The orientation that turns z into the support's normal."""
    x, y, z = scene.normal
    if z < -0.999:
        return 1.0, 0.0, 0.0, 0.0
    length = sqrt(2.0 * (1.0 + z))
    return -y / length, x / length, 0.0, 0.5 * length
