"""The impact that a landing foot makes, through contact space: `touchdown_of`."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot, inf

from ...mechanics.contact_space import solve, unchanged
from ...mechanics.impact.answer import is_slow
from ...mechanics.types import Flag, Mode, Twist
from ..planar import GRAZES, ORIGIN, ROUNDING, direction_of, edge_of, hardly, off_axis_of
from ..scene import Scene
from ..types import Leftover, Sample, SpatialTwist, Status, Touchdown, Vector3
from ..vectors import Axes, add, axes_of, cross, dot, mean, to_body, to_world
from .mechanism import LeggedMachine

USABLE = 0.2
"""The machine turns about the line of its standing points where the landing one is further from it than this part of
their distance: else that line says nothing of where the machine goes."""

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
    together: Mapping[int, Vector3] | None = None,
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
    together = together or {}
    axes = axes_of(base.orientation)
    normal, striking = to_body(axes, scene.normal), to_body(axes, velocity)
    beside = to_body(axes, mean(list(together.values()))) if together else ORIGIN
    struck = mean([points[i] for i in new])
    first = tuple(together)
    if not together:
        each = 1 if scene.walking is None else scene.walking.points
        same_foot = [i for i in old if each > 1 and i // each == new[0] // each]
        first = tuple(same_foot) or old
    leftover = Leftover.DRIVEN if first else Leftover.DRIVEN | Leftover.ONE_POINT
    # Negative; 0 where a contact only grazes, or leaves.
    fall, other = [rate if rate < -GRAZES else 0.0 for rate in (dot(normal, striking), dot(normal, beside))]
    # Of feet that land together the total law says the same whichever is the new one, also where one has braked.
    law = "total" if together and not other else scene.law
    kick = spin = ORIGIN
    while True:
        stood = [points[i] for i in first]
        ahead = ahead_of(scene, normal, stood, struck, striking)
        c = other if first else inf, dot(ahead, beside), fall, dot(ahead, striking)
        if fall == 0.0 and other == 0.0:
            outcome = unchanged(c, scene.law, 0)
            break
        response = machine.response(first, new, normal, ahead, points)
        if isinstance(response, Status):
            return response
        restitution = (scene.restitution if other else 0.0), scene.restitution
        outcome = solve(response.W, c, (scene.friction, scene.friction), restitution, law)
        (na, ta), (nb, tb) = outcome.impulses
        x, y, z, p, q, r = [row[0] * na + row[1] * ta + row[2] * nb + row[3] * tb for row in response.twist]
        kick, spin = (x, y, z), (p, q, r)
        # The mean of several feet rolls freely, into the ground on one side: those that are pressed prevent it alone.
        rates = dict.fromkeys(old, 0.0) | {i: dot(scene.normal, moves) for i, moves in together.items()}
        pressed = [i for i in rates if rates[i] + dot(normal, add(kick, cross(spin, points[i]))) < -GRAZES]
        if not (machine.is_rigid and pressed):
            break
        held = tuple([i for i in pressed if i in first])
        if together or len(held) in (0, len(first)):
            leftover |= Leftover.OUT_OF_PLANE
            break
        first = held
    axis = cross(normal, ahead)
    linear, angular = add(base.linear, kick), add(base.angular, spin)
    arms = [add(point, scene.center_of_mass, -1.0) for point in ((mean(stood), struck) if first else (struck,))]
    span = add(arms[-1], arms[0], -1.0)
    gaps = [dot(normal, points[i]) for i in new]
    slow = outcome.mode is not Mode.NO_IMPACT and is_slow(outcome.impulses[1][0] / scene.mass, scene.validity)
    return Touchdown(
        lead_time=lead_time,
        mode=outcome.mode,
        before=planar_twist(scene, base.linear, base.angular, ahead, normal, axis),
        after=planar_twist(scene, linear, angular, ahead, normal, axis),
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
        closing_spread=(max(gaps) - min(gaps)) / -fall if fall < 0.0 else 0.0,
        offset=max([abs(dot(axis, arm)) for arm in arms]),
        leftover=leftover,
        before_6d=spatial_twist(scene, axes, base.linear, base.angular),
        after_6d=spatial_twist(scene, axes, linear, angular),
    )


def ahead_of(scene: Scene, normal: Vector3, stood: list[Vector3], struck: Vector3, velocity: Vector3) -> Vector3:
    """The unit vector in the support along which the impact plane lies, in the body frame.

    It leads from the old contact to the new one, across the line of standing points about which the machine turns.
    Where nothing stands it is the direction of the slip, which friction opposes.
    """
    slow = hardly(scene) ** 2
    if not stood:
        return direction_of(normal, [(velocity, slow), (add(struck, scene.center_of_mass, -1.0), 0.0)])
    arm = add(struck, mean(stood), -1.0)
    square = dot(arm, arm)
    ways = [(arm, ROUNDING * square), (velocity, slow)]
    if len(stood) > 1:
        line = edge_of(stood)
        across = cross(cross(line, arm), line)
        length, offsets = dot(line, line), [cross(line, add(point, stood[0], -1.0)) for point in stood]
        straight = all(dot(offset, offset) <= (COLLINEAR * length) ** 2 for offset in offsets)
        if straight and dot(across, across) > (USABLE * length) ** 2 * square:
            ways.insert(0, (across, 0.0))
    return direction_of(normal, ways)


def spatial_twist(scene: Scene, axes: Axes, linear: Vector3, angular: Vector3) -> SpatialTwist:
    """The twist of the mass centre in the world frame, from that of the base in its own."""
    velocity = add(linear, cross(angular, scene.center_of_mass))
    return SpatialTwist(to_world(axes, velocity), to_world(axes, angular))


def planar_twist(
    scene: Scene, linear: Vector3, angular: Vector3, ahead: Vector3, normal: Vector3, axis: Vector3
) -> Twist:
    """The twist of the mass centre in the impact plane, from that of the base."""
    velocity = add(linear, cross(angular, scene.center_of_mass))
    return Twist(dot(ahead, velocity), dot(normal, velocity), -dot(axis, angular))
