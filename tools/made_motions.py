"""Motions that are made up for any scene: a body let fall and thrown, a walking machine that steps on the spot.

The fuzzer, tests and benchmarks use them where a scene has no recorded bag.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, hypot, pi, sin, sqrt
from random import Random
from typing import Final, NamedTuple

from impact_predictor.prediction.planar import inertia_about
from impact_predictor.prediction.scene import MovingDeck, Robot, Scene, Walking
from impact_predictor.prediction.types import Geometry, Imu, Joints, Quaternion, Sample, Schedule, Vector3, Wrench
from impact_predictor.prediction.vectors import add, axes_of, cross, dot, mean, times, to_body, to_world, turned
from impact_predictor.stamps import NANOSECONDS

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
LEAD: Final = 1.5
"""Seconds of them before the first motion, beyond their window: in less nobody believes what a sensor feels."""

WALK: Final = 400
"""Samples of a walk."""
STEP: Final = 60
"""Samples for which a foot stands, and then swings."""
DOWN: Final = 0.5
"""m from the body frame's origin down to feet that stand, and out to them."""
LIFT: Final = 0.05
"""m that a foot is lifted; or the whole machine, where a model tells where feet are but not how legs are bent."""
SOLE: Final = 0.1
"""m from heel to toe."""
FORCE: Final = 30.0
"""N on a foot that stands, where no more is asked for."""


Motion = list[Sample]


class OfSupport(NamedTuple):
    """A message about the support: its pose and twist, or what a sensor on it measures."""

    message: Sample | Imu


Message = Geometry | Sample | OfSupport | Joints | Wrench | Schedule


def made(scene: Scene) -> tuple[Message, ...]:
    """The body let fall from what it stands on, to every side, and thrown; its support lies still.

    A machine that walks steps on the spot.
    """
    if scene.walking is not None:
        return steps_of(scene, scene.walking)
    start = (scene.deck or MovingDeck()).window + LEAD
    motions: list[Motion] = []
    for motion in (*falls(scene), *(() if scene.radius else throws(scene))):
        motions.append([sample._replace(stamp=sample.stamp + round(start * NANOSECONDS)) for sample in motion])
        start = motions[-1][-1].stamp / NANOSECONDS + GAP
    messages: list[Message] = [*_still(scene, 0, round(start * NANOSECONDS))]
    points = points_of(scene)
    for motion in motions:
        messages += [Geometry(motion[0].stamp, "", points), *motion]
    # The support comes first where stamps are the same, and the points of the body before its state.
    return tuple(sorted(messages, key=_stamp_of))


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


def steps_of(scene: Scene, walking: Walking) -> tuple[Message, ...]:
    """Every second foot in turn; with what sensors and a planner would tell, whether the scene asks for it or not."""
    robot, place, upright = walking.robot, ground_of(scene), upright_of(scene)
    joints, fixed = ((), ()) if robot is None else _model_of(robot)
    down = -min([z for _, _, z in fixed], default=-DOWN)
    motion, points = [], []
    for k in range(WALK):
        high, rate = _lift(0, k) if fixed else (0.0, 0.0)
        motion.append((add(place, scene.normal, down + high), upright, (0.0, 0.0, rate), (0.0, 0.0, 0.0)))
        points.append(fixed or tuple(_points_at(walking, k)))
    samples = stamped(scene, motion)
    messages: list[Message] = [_plan_of(walking, samples, bool(fixed))]
    for k, sample in enumerate(samples):
        messages.append(Geometry(sample.stamp, "", points[k]))
        if fixed:
            messages.append(Joints(sample.stamp, joints, (0.0,) * len(joints), ()))
        for number, foot in enumerate(walking.feet):
            force = max(walking.force, FORCE) if _stands(0 if fixed else number, k) else 0.0
            messages.append(Wrench(sample.stamp, foot, (0.0, 0.0, force)))
        messages.append(sample)
    return tuple(messages)


def _stands(number: int, k: int) -> bool:
    """Whether a foot stands at a sample: those with odd numbers stand while the others swing."""
    return (k // STEP + number) % 2 == 1


def _lift(number: int, k: int) -> tuple[float, float]:
    """How high a foot is above the ground at a sample, in m, and how fast it rises, in m/s."""
    if _stands(number, k):
        return 0.0, 0.0
    share = k % STEP / STEP
    return 4.0 * LIFT * share * (1.0 - share), 4.0 * LIFT * (1.0 - 2.0 * share) * RATE / STEP


def _points_at(walking: Walking, k: int) -> list[Vector3]:
    """The contact points of the feet at a sample, in the body frame, on a circle about its origin."""
    points = []
    for number in range(len(walking.feet)):
        angle = pi * (2 * number + 1) / len(walking.feet)
        heel = DOWN * cos(angle), DOWN * sin(angle), _lift(number, k)[0] - DOWN
        points += [add(heel, (SOLE, 0.0, 0.0), float(i)) for i in range(walking.points)]
    return points


def _plan_of(walking: Walking, samples: list[Sample], hops: bool) -> Schedule:
    """When the feet are to stand: as they do."""
    changes = range(0, WALK, STEP)
    stands = [tuple(_stands(0 if hops else number, k) for number in range(len(walking.feet))) for k in changes]
    first = samples[0].stamp
    return Schedule(first, walking.feet, tuple(first + k * NANOSECONDS // RATE for k in changes), tuple(stands))


def _model_of(robot: Robot) -> tuple[tuple[str, ...], tuple[Vector3, ...]]:
    """The names of the joints of a model, and its contact points in the base's frame where every joint is at zero."""
    import numpy as np

    from impact_predictor.mechanics.articulated import WholeBody

    body = WholeBody(robot.urdf, robot.frames)
    body.place(np.zeros(len(body.joints)))
    return body.joints, tuple((float(x), float(y), float(z)) for x, y, z in body.points)
