"""The impact at the end of an approach: its outcome in the impact plane, the body after it in space, how sure it is."""

from __future__ import annotations

from functools import cache
from math import hypot
from typing import TYPE_CHECKING, Final

from ..mechanics.impact import solve_impact
from ..mechanics.motion import Fall
from ..mechanics.types import Twist, TwoPointBody, Vector
from .planar import GRAZES, ORIGIN, ActiveContacts, ImpactPlane, Posture, hardly
from .scene import Scene
from .types import Leftover, Sample, SpatialTwist, Touchdown, Vector3
from .vectors import add, axes_of, combine, cross, dot, to_body, to_world, total, turned

if TYPE_CHECKING:
    from .uncertainty import Sampler

OFF_AXIS: Final = 0.3
"""A touchdown is planar up to this part of the angular velocity off the axis: 9 % of the turning energy."""

OFFSET: Final = 0.2
"""... and up to this part of the contacts' half distance between their plane and the mass centre (in flight of the
distance between contact and mass centre)."""

RESTITUTION = {"path": "energetic", "total": "poisson"}
"""The rule of each law's restitution: that of the law in three dimensions, which answers beside the planar one."""

SLOWEST: Final = 4.0
"""An impact can be told from rest when it approaches this many times faster than gravity moves it in a contact time."""


class Collision:
    """The collision that a sample shows to be ahead, before its impact.

    `body` and its twist `before` are those of the impact, in the impact plane, and `across` is the motion across it:
    velocity of the mass centre along the axis (m/s), angular velocities about d (roll) and about the support normal
    (yaw) in rad/s; `shift` (m) is how far the mass centre moves there until then, and `angle` how far the body turns;
    `lead_time` in s; `measured` is the speed in m/s at which the sample shows the new points to approach, `speed` that
    of the touchdown.
    """

    def __init__(
        self,
        contacts: ActiveContacts,
        plane: ImpactPlane,
        body: TwoPointBody,
        before: Twist,
        across: Vector3,
        shift: Vector,
        angle: float,
        lead_time: float,
        measured: float,
        speed: float,
    ) -> None:
        self.contacts, self.plane, self.body, self.before, self.across = contacts, plane, body, before, across
        self.shift, self.angle, self.lead_time, self.measured = shift, angle, lead_time, measured
        self.speed = speed


def collision_after(
    sample: Sample,
    posture: Posture,
    contacts: ActiveContacts,
    plane: ImpactPlane,
    body: TwoPointBody,
    fall: Fall,
    start: Vector,
    age: float,
) -> Collision | None:
    """The collision of a body after a fall; None where it only grazes its support.

    The fall began `age` s before the sample, at which its mass centre was at `start` (m, in the impact plane).
    """
    x, y, angle, vx, vy, omega = fall.state
    nx, ny = body.new.normal
    speed = -(nx * (vx - omega * body.new.y) + ny * (vy + omega * body.new.x))
    if speed < GRAZES:
        return None
    time = max(0.0, fall.time - age)
    # The contacts leave what is across the plane as it is; in flight gravity adds to it.
    pull = plane.gravity[2] if plane.old is None else 0.0
    velocity, spin = dot(plane.axis, posture.velocity) + pull * time, sample.angular
    return Collision(
        contacts=contacts,
        plane=plane,
        body=body,
        before=Twist(vx, vy, omega),
        across=(velocity, dot(plane.ahead, spin), dot(posture.normal, spin)),
        shift=(x - start[0], y - start[1]),
        angle=angle,
        lead_time=time,
        measured=-total([posture.rates[i] for i in contacts.new]) / len(contacts.new),
        speed=speed,
    )


class ImpactModel:
    """How the body of a scene is struck."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._sampler: Sampler | None = None
        # What is loaded for some scenes only is loaded now, not with the first touchdown.
        if scene.margins:
            from ..mechanics import margins  # noqa: F401
        if scene.samples:
            from .uncertainty import Sampler

            self._sampler = Sampler(scene)

    def touchdown(self, sample: Sample, posture: Posture, collision: Collision) -> Touchdown:
        """The touchdown at the end of an approach, with its impact."""
        scene, contacts, plane, body = self._scene, collision.contacts, collision.plane, collision.body
        before, time, (drift, roll, yaw) = collision.before, collision.lead_time, collision.across
        n, center = scene.normal, scene.center_of_mass
        outcome = solve_impact(body, before, scene.law, scene.validity, RESTITUTION[scene.law])
        # From the plane to space: the pose then, and the twist of the body frame after the impact.
        along = to_world(posture.axes, plane.axis)
        ahead = cross(along, n)
        rotation = combine(-collision.angle, plane.axis, roll * time, plane.ahead, yaw * time, posture.normal)
        orientation = turned(sample.orientation, rotation)
        now = axes_of(orientation)
        before_6d, after_6d = [
            SpatialTwist(
                combine(twist.vx, ahead, twist.vy, n, drift, along),
                combine(-twist.omega, along, roll, ahead, yaw, n),
            )
            for twist in (before, outcome.twist)
        ]
        linear, angular = to_body(now, after_6d.linear), to_body(now, after_6d.angular)
        pull = plane.gravity[2] if plane.old is None else 0.0
        x, y = collision.shift
        glide = combine(x, ahead, y, n, (drift - 0.5 * pull * time) * time, along)
        position = add(sample.position, glide)
        if center != ORIGIN:
            linear = add(linear, cross(angular, center), -1.0)
            position = add(add(position, to_world(posture.axes, center)), to_world(now, center), -1.0)
        gaps = [posture.gaps[i] for i in contacts.new]
        spread = (max(gaps) - min(gaps)) / collision.speed
        half_distance, width = 0.0, hypot(body.new.x, body.new.y)
        if body.old is not None:
            half_distance = width = 0.5 * hypot(body.new.x - body.old.x, body.new.y - body.old.y)
        uncertainty = None
        if self._sampler is not None:
            uncertainty = self._sampler.uncertainty(sample, posture, plane, body, before, orientation)
        return Touchdown(
            lead_time=collision.lead_time,
            mode=outcome.mode,
            before=before,
            after=outcome.twist,
            impulses=outcome.impulses,
            segments=outcome.segments,
            energy_lost=outcome.energy_lost,
            flags=outcome.flags,
            unique=outcome.unique,
            law=outcome.law,
            old=contacts.old if body.old is not None else (),
            new=contacts.new,
            axis=along,
            position=position,
            orientation=orientation,
            linear=linear,
            angular=angular,
            half_distance=half_distance,
            off_axis=plane.off_axis,
            lateral=plane.lateral,
            closing_spread=spread,
            offset=plane.offset,
            leftover=leftover_of(
                scene,
                stands=body.old is not None,
                strays=plane.off_axis > OFF_AXIS or plane.offset > OFFSET * width,
                apart=spread > scene.contact_time
                or (body.old is not None and len(contacts.old) > 1 and len(contacts.new) == 1),
                speed=collision.speed,
            ),
            before_6d=before_6d,
            after_6d=after_6d,
            uncertainty=uncertainty,
            planar=outcome if scene.margins else None,
        )


def leftover_of(scene: Scene, *, stands: bool, strays: bool, apart: bool, speed: float) -> Leftover:
    """Why a touchdown is no planar two-point impact that can be scored, from the state before it alone.

    Of it are told: whether anything stands, whether the motion or the contacts stray from the impact plane, whether the
    ends of the striking edge close apart from each other, and how fast it approaches (m/s).
    """
    bits = 0 if stands else ONE_POINT
    bits |= OUT_OF_PLANE if strays else 0
    bits |= ONE_CORNER_FIRST if apart else 0
    bits |= TOO_SLOW if speed < SLOWEST * hardly(scene) else 0
    return leftover_named(bits)


@cache
def leftover_named(bits: int) -> Leftover:
    """What is left over, by its bits: looked up once, because making a flag is slow."""
    return Leftover(bits)


ONE_POINT, OUT_OF_PLANE, ONE_CORNER_FIRST, TOO_SLOW = (
    int(flag) for flag in (Leftover.ONE_POINT, Leftover.OUT_OF_PLANE, Leftover.ONE_CORNER_FIRST, Leftover.TOO_SLOW)
)
