"""The impact that landing feet make, each of their points a contact beside those that stand: `touchdown_of`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, sqrt
from typing import Final

from ...mechanics.impact.answer import is_slow
from ...mechanics.impact.spatial import ContactPoints
from ...mechanics.types import ContactState, Flag, Mode
from ..planar import (
    GRAZES,
    ORIGIN,
    ROUNDING,
    along_plane,
    direction_of,
    edge_of,
    hardly,
    mode_of_contacts,
    off_axis_of,
    planar_twist,
)
from ..scene import Scene
from ..types import Bound, Leftover, PointOutcome, Sample, SpatialTwist, Status, Touchdown, Vector3
from ..vectors import add, axes_of, cross, dot, mean, times, to_body, to_world
from .articulated import LeggedMachine
from .base import NOTHING

USABLE: Final = 0.2
"""The machine turns about the line of its standing points where the landing one is further from it than this part of
their distance: else that line says nothing of where the machine goes."""

LIFTS: Final = 1e-3
"""Contacts lift together when they do so faster than this part of the fastest one before: steps of the law err so."""

COLLINEAR: Final = 0.05
"""Standing points no further from a line than this part of its length stand on it."""


class LandingPoint:
    """A point that lands: its `velocity` (m/s) relative to the support, along the axes of the frame that the pose is
    in, and how many s it lands after the first one.
    """

    def __init__(self, velocity: Vector3, delay: float = 0.0) -> None:
        self.velocity, self.delay = velocity, delay


AT_REST = LandingPoint(ORIGIN)


def touchdown_of(
    scene: Scene,
    machine: LeggedMachine,
    base: Sample,
    places: Sequence[Vector3],
    stood: tuple[int, ...],
    new: tuple[int, ...],
    landing: Mapping[int, LandingPoint],
    lead_time: float,
    rates: tuple[float, ...] = NOTHING,
) -> Touchdown | Status:
    """The touchdown of the `new` points of one foot, with its impact.

    `base` is the sample with the pose and the twist that the base has at the touchdown, `lead_time` s after its stamp;
    the points are then at `places` (m, in the world). Those that are `landing` are the new ones, and those of feet that
    land together with them; those that `stood` rest on the support. Each is a contact of the law in three dimensions.
    The old contacts, which give the impact plane and the mode, are those that land together with the new ones, else
    those that stood of the same foot, else all that stood. Feet that have braked before they land make no impact
    (Mode.NO_IMPACT). A status, where the machine has no response.

    The twist of the base changes with `rates`, linear and angular along the axes of the world.
    """
    walking, normal, those = scene.walking, scene.normal, sorted({*stood, *landing})
    assert walking is not None
    axes = axes_of(base.orientation)
    moves, arms, gaps, fastest, strikes = {}, [], [], 0.0, False
    for i in those:
        point = landing.get(i, AT_REST)
        velocity, rate = point.velocity, dot(normal, point.velocity)
        # What only grazes the support, or leaves it, rests.
        approach = rate if rate < -GRAZES else 0.0
        velocity = add(velocity, normal, approach - rate)
        moves[i] = velocity
        arms.append(add(places[i], base.position, -1.0))
        gaps.append(-approach * point.delay)
        fastest, strikes = max(fastest, dot(velocity, velocity)), strikes or approach < 0.0
    met = ContactPoints(
        positions=arms,
        friction=walking.at_points(walking.friction or (scene.friction,), those),
        restitution=walking.at_points(walking.restitution or (scene.restitution,), those),
        normals=normal,
        velocities=[times(velocity, -1.0) for velocity in moves.values()],
        gaps=gaps,
    )
    (a, b, c, u, v, w), lasts = rates, strikes and not machine.is_rigid and any(rates)
    pulls = [add((a, b, c), cross((u, v, w), arm)) for arm in arms] if lasts else []
    found = machine.struck(those, met, axes, scene, pulls)
    if isinstance(found, Status):
        return found
    impact = found.impact
    assert impact.twist is not None
    x, y, z, p, q, r = impact.twist.tolist()
    kick, spin, center = (x, y, z), (p, q, r), to_world(axes, scene.center_of_mass)
    told = zip(those, impact.impulses.tolist(), impact.velocities.tolist(), impact.states, strict=True)
    contacts = tuple(
        [
            PointOutcome(i, i in landing, places[i], normal, impulse=tuple(u), velocity=tuple(v), state=state)
            for i, u, v, state in told
        ]
    )
    same_foot = [i for i in stood if i // walking.points == new[0] // walking.points]
    old = tuple([i for i in landing if i not in new] or same_foot or stood)
    others, struck = ([contact for contact in contacts if contact.point in group] for group in (old, new))
    striking, middle = mean([moves[i] for i in new]), mean([places[i] for i in new])
    feet, delays, masses = [places[i] for i in old], [landing[i].delay for i in new], add(base.position, center)
    ahead = ahead_of(scene, feet, middle, striking, masses)
    axis = cross(normal, ahead)
    impulses = along_plane(others, ahead, normal), along_plane(struck, ahead, normal)
    # An estimate goes on for the contact time: what rises no faster than gravity takes back in it does not lift.
    least = hardly(scene) if found.bound is Bound.ESTIMATE else LIFTS * sqrt(fastest)
    mode = mode_of_contacts(others, struck, normal, least) if strikes else Mode.NO_IMPACT
    flags = impact.flags
    if strikes and is_slow(impulses[1][0] / scene.mass, scene.validity):
        flags |= Flag.SLOW_IMPACT
    if machine.is_rigid and shares_freely(contacts, normal):
        flags |= Flag.SHARED_FRICTION
    stance = mean(feet) if feet else middle
    span = add(middle, stance, -1.0)
    linear, angular = to_world(axes, base.linear), to_world(axes, base.angular)
    before = SpatialTwist(add(linear, cross(angular, center)), angular)
    after = SpatialTwist(add(add(before.linear, kick), cross(spin, center)), add(angular, spin))
    return Touchdown(
        lead_time=lead_time,
        mode=mode,
        before=planar_twist(before, ahead, normal, axis),
        after=planar_twist(after, ahead, normal, axis),
        impulses=impulses,
        segments=(),
        energy_lost=impact.energy_lost,
        flags=flags,
        unique=True,
        law=impact.law,
        old=old,
        new=new,
        axis=axis,
        position=base.position,
        orientation=base.orientation,
        linear=add(base.linear, to_body(axes, kick)),
        angular=add(base.angular, to_body(axes, spin)),
        half_distance=0.5 * hypot(dot(span, ahead), dot(span, normal)),
        off_axis=off_axis_of(angular, axis, dot(axis, angular)),
        lateral=dot(axis, striking),
        closing_spread=max(delays) - min(delays),
        offset=max([abs(dot(axis, add(place, masses, -1.0))) for place in (stance, middle)]),
        leftover=Leftover.DRIVEN if old else Leftover.DRIVEN | Leftover.ONE_POINT,
        before_6d=before,
        after_6d=after,
        contacts=contacts,
        bound=found.bound,
        drives=found.drives,
        joints=machine.joints,
        jumps=found.jumps,
    )


def shares_freely(contacts: tuple[PointOutcome, ...], normal: Vector3) -> bool:
    """Whether the contacts of a rigid body may share their impulses otherwise, with the same twist after them.

    Two that stick may push each other along their line, and on four that hold the normal impulses have no one answer.
    """
    holding = [one.state for one in contacts if dot(normal, one.impulse) > 0.0]
    return len(holding) > 3 or holding.count(ContactState.STICKS) > 1


def ahead_of(scene: Scene, stood: list[Vector3], struck: Vector3, velocity: Vector3, center: Vector3) -> Vector3:
    """The unit vector in the support along which the impact plane lies.

    It leads from the old contacts to the new one, across the line of standing points about which the machine turns.
    Where nothing stands it is the direction of the slip, which friction opposes; `center` is the mass centre's place.
    """
    normal, slow = scene.normal, hardly(scene) ** 2
    if not stood:
        return direction_of(normal, [(velocity, slow), (add(struck, center, -1.0), 0.0)])
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
