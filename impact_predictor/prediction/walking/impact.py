"""The impact that a landing foot makes, through contact space: `touchdown_of`."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot, inf

from ...mechanics.contact_space import ContactOutcome, solve, unchanged
from ...mechanics.types import Flag, Mode, Twist
from ..planar import GRAZES, ORIGIN, ROUNDING, direction_of, edge_of, hardly, off_axis_of
from ..scene import Scene
from ..types import Leftover, Sample, Status, Touchdown, Vector3
from ..vectors import add, axes_of, cross, dot, mean, to_body, to_world
from .mechanism import ImpulseResponse, LeggedMachine

USABLE = 0.2
"""The machine turns about the line of its standing points where the landing one is further from it than this part of
their distance: else that line says nothing of where the machine goes."""

NOTHING: Mapping[int, Vector3] = {}

COLLINEAR = 0.05
"""Standing points no further from a line than this part of its length stand on it."""


def touchdown_of(
    scene: Scene,
    machine: LeggedMachine,
    base: Sample,
    points: tuple[Vector3, ...],
    old: tuple[int, ...],
    new: tuple[int, ...],
    lead_time: float,
    velocity: Vector3,
    together: Mapping[int, Vector3] = NOTHING,
) -> Touchdown | Status:
    """The touchdown of the `new` points of one foot while the `old` ones stand, with its impact.

    `base` is the sample with the pose and the twist that the base has at the touchdown, `lead_time` s after its stamp;
    `points` (m, in its frame) are those of then, and `velocity` (m/s) is that of the new contact relative to the
    support, along the axes of the frame that the pose is in. The old contact is the mean of the points of other feet
    that land `together` with this one, and strikes with the mean of their velocities (Flag.BOTH_STRUCK). Else it rests:
    it is that of the same foot where other points of it stand, else the mean of all standing points. Joints are free
    during an impact, or held by a `machine` that has none. Leftover.OUT_OF_PLANE where a foot of a rigid machine
    would be pressed into the ground that these two contacts leave out. Feet that have braked before they land make no
    impact (Mode.NO_IMPACT). A status, where the machine has no response.
    """
    axes = axes_of(base.orientation)
    normal = to_body(axes, scene.normal)
    striking = to_body(axes, velocity)
    beside = to_body(axes, mean(list(together.values()))) if together else ORIGIN
    center = scene.center_of_mass
    struck = mean([points[i] for i in new])
    first = tuple(together) or standing_with(scene, old, new)
    watched = dict.fromkeys(old, 0.0) | {i: dot(scene.normal, moves) for i, moves in together.items()}
    leftover = Leftover.DRIVEN if first else Leftover.DRIVEN | Leftover.ONE_POINT
    approach = without_grazing(dot(normal, striking)), without_grazing(dot(normal, beside))
    # Of feet that land together the total law says the same whichever is the new one, also where one has braked.
    law = "total" if together and not approach[1] else scene.law
    kick = spin = ORIGIN
    while True:
        stood = [points[i] for i in first]
        ahead = ahead_of(scene, normal, stood, struck, striking)
        c = approach[1] if first else inf, dot(ahead, beside), approach[0], dot(ahead, striking)
        if approach == (0.0, 0.0):
            outcome = unchanged(c, scene.law, 0)
            break
        response = machine.response(first, new, normal, ahead, points)
        if isinstance(response, Status):
            return response
        restitution = (scene.restitution if approach[1] else 0.0), scene.restitution
        outcome = solve(response.W, c, (scene.friction, scene.friction), restitution, law)
        kick, spin = changes(response, outcome)
        rates = {i: rate + dot(normal, add(kick, cross(spin, points[i]))) for i, rate in watched.items()}
        pressed = [i for i, rate in rates.items() if rate < -GRAZES]
        if not (machine.is_rigid and pressed):
            break
        # The mean of several feet rolls freely, into the ground on one side: those that are pressed prevent it alone.
        held = tuple([i for i in pressed if i in first])
        if together or len(held) in (0, len(first)):
            leftover |= Leftover.OUT_OF_PLANE
            break
        first = held
    linear, angular = add(base.linear, kick), add(base.angular, spin)
    axis = cross(normal, ahead)

    arms = [add(point, center, -1.0) for point in ((mean(stood), struck) if first else (struck,))]
    span = add(arms[-1], arms[0], -1.0)
    gaps = [dot(normal, points[i]) for i in new]
    _, gravity, contact_time, share = scene.validity
    push = share * outcome.impulses[1][0]
    slow = outcome.mode is not Mode.NO_IMPACT and push < scene.mass * gravity * contact_time
    return Touchdown(
        lead_time=lead_time,
        mode=outcome.mode,
        before=planar_twist(base.linear, base.angular, center, ahead, normal, axis),
        after=planar_twist(linear, angular, center, ahead, normal, axis),
        impulses=outcome.impulses,
        segments=outcome.segments,
        energy_lost=outcome.energy_lost,
        flags=outcome.flags | (Flag.SLOW_IMPACT if slow else Flag.NONE),
        unique=outcome.unique,
        law=outcome.law,
        old=first,
        new=new,
        axis=to_world(axes, axis),
        position=base.position,
        orientation=base.orientation,
        linear=linear,
        angular=angular,
        half_distance=0.5 * hypot(dot(span, ahead), dot(span, normal)),
        off_axis=off_axis_of(base.angular, axis, dot(axis, base.angular)),
        lateral=dot(axis, striking),
        closing_spread=(max(gaps) - min(gaps)) / -c[2] if c[2] < 0.0 else 0.0,
        offset=max([abs(dot(axis, arm)) for arm in arms]),
        leftover=leftover,
    )


def standing_with(scene: Scene, old: tuple[int, ...], new: tuple[int, ...]) -> tuple[int, ...]:
    """The standing points that make the old contact: those of the landing foot, or else all."""
    count = 1 if scene.walking is None else scene.walking.points
    if count == 1:
        return old
    foot = new[0] // count
    return tuple([i for i in old if i // count == foot]) or old


def without_grazing(rate: float) -> float:
    """The speed at which a contact strikes, negative; 0 where it only grazes, or leaves."""
    return rate if rate < -GRAZES else 0.0


def changes(response: ImpulseResponse, outcome: ContactOutcome) -> tuple[Vector3, Vector3]:
    """The changes of linear and angular velocity of the base by an impact, along its axes."""
    (na, ta), (nb, tb) = outcome.impulses
    x, y, z, p, q, r = [row[0] * na + row[1] * ta + row[2] * nb + row[3] * tb for row in response.twist]
    return (x, y, z), (p, q, r)


def ahead_of(scene: Scene, normal: Vector3, stood: list[Vector3], struck: Vector3, velocity: Vector3) -> Vector3:
    """The unit vector in the support along which the impact plane lies, in the body frame.

    It leads from the old contact to the new one, across the line of standing points about which the machine turns.
    Where nothing stands it is the direction of the slip, which friction opposes.
    """
    slow = hardly(scene) ** 2
    ways = [(velocity, slow), (add(struck, scene.center_of_mass, -1.0), 0.0)]
    if stood:
        arm = add(struck, mean(stood), -1.0)
        square = dot(arm, arm)
        line = edge_of(stood) if len(stood) > 1 else ORIGIN
        across = cross(cross(line, arm), line)
        ways = [(arm, ROUNDING * square), (velocity, slow)]
        if is_line(stood, line) and dot(across, across) > USABLE**2 * dot(line, line) ** 2 * square:
            ways.insert(0, (across, 0.0))
    return direction_of(normal, ways)


def is_line(stood: list[Vector3], line: Vector3) -> bool:
    """Whether two or more standing points lie on one `line`, which leads from one end of them to the other."""
    least = (COLLINEAR * dot(line, line)) ** 2
    offsets = [cross(line, add(point, stood[0], -1.0)) for point in stood]
    return len(stood) > 1 and all(dot(offset, offset) <= least for offset in offsets)


def planar_twist(
    linear: Vector3, angular: Vector3, center: Vector3, ahead: Vector3, normal: Vector3, axis: Vector3
) -> Twist:
    """The twist of the mass centre in the impact plane, from that of the base."""
    velocity = add(linear, cross(angular, center))
    return Twist(dot(ahead, velocity), dot(normal, velocity), -dot(axis, angular))
