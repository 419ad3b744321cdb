"""A cylinder that lies on two parallel edges of its support and rocks from one to the other (the paper, section 4).

The edges take the place of the contact points, as numbers 0 and 1. They run through the two given points, across the
line between these and in the support, and so does the axis of the cylinder, on which its mass centre lies. The normals
point from the edges to the axis: a contact slips where the cylinder spins, and where it slides along its axis. This
changes the impact; up to it the cylinder keeps its velocity along the axis.
"""

from __future__ import annotations

from math import atan2, hypot, inf, sqrt
from typing import Any, Final

import numpy as np

from ..errors import InputError
from ..mechanics.compiled import without_numba
from ..mechanics.impact import spatial_body
from ..mechanics.impact.answer import mode_of
from ..mechanics.impact.solve import MODES, number_of
from ..mechanics.impact.spatial import STEPS, flags_named, workspace
from ..mechanics.impact.spatial_body import ANSWER, RESULT
from ..mechanics.motion import PlanarState, next_strike
from ..mechanics.motion.support import FeltSupport, FixedSupport
from ..mechanics.types import Contact, ContactState, Twist, TwoPointBody, Vector
from .deck.frame import gravity_over, is_uniform, planar_support
from .impact import Collision, collision_after
from .planar import (
    RESTS,
    ActiveContacts,
    ImpactPlane,
    Posture,
    center_of,
    contacts_of,
    hardly,
    inertia_about,
    off_axis_of,
)
from .points import PointContacts
from .scene import Scene
from .spatial import PLANAR
from .spatial_impact import SpatialCollision, outcomes_of
from .types import Moment, Sample, SpatialTwist, Touchdown, Vector3
from .vectors import add, axes_of, cross, dot, times, to_body, to_world

ASIDE: Final = 0.5
"""A cylinder has left its edges when its axis is farther outside of them than this part of its radius: there it would
still balance over an edge of a support that leans by 30 degrees."""

BLOCKED: Final = 1e9
"""What does not turn has so many times the inertia about the axis."""

SOLVE: Final = without_numba(spatial_body.strike_all)
"""The law code: a cylinder that slides along its axis is rare, and needs nothing compiled."""


class CylinderContacts(PointContacts):
    """The contacts of the cylinder of a scene with its edges."""

    is_spatial = False

    def __init__(self, scene: Scene) -> None:
        """Take the cylinder with `scene.radius` on `scene.edges`.

        Raises:
            InputError: the edges are not two lines next to each other, nearer than the cylinder is wide.
        """
        first, second = scene.edges
        line = add(second, first, -1.0)
        rise = dot(scene.normal, line)
        level = add(line, scene.normal, -rise)
        width, length = sqrt(dot(level, level)), sqrt(dot(line, line))
        if not (1e-6 * scene.radius < width and length < 2.0 * scene.radius):
            raise InputError(
                f"the edges at {first} and {second} do not carry a cylinder of radius {scene.radius} m; "
                "give two that lie beside each other, nearer than its diameter"
            )
        super().__init__(scene)
        self.points, self.size = scene.edges, 2.0 * scene.radius
        self._ahead = times(level, 1.0 / width)
        self._along = cross(scene.normal, self._ahead)
        # From either edge to the other, and from there to the axis when it lies on both.
        high = sqrt(scene.radius * scene.radius - 0.25 * length * length) / length
        self._lines = (width, rise), (width, -rise)
        self._centers = tuple((0.5 * x - high * y, 0.5 * y + high * x) for x, y in self._lines)

    def posture_of(self, sample: Sample) -> Posture:
        scene, spin = self.scene, sample.angular
        axes = axes_of(sample.orientation)
        velocity = add(sample.linear, cross(spin, scene.center_of_mass))
        center = add(sample.position, to_world(axes, scene.center_of_mass))
        moves = to_world(axes, velocity)
        gaps, rates = [], []
        for edge in scene.edges:
            arm = add(center, edge, -1.0)
            arm = add(arm, self._along, -dot(arm, self._along))
            distance = sqrt(dot(arm, arm))
            gaps.append(distance - scene.radius)
            rates.append(dot(arm, moves) / distance if distance > 0.0 else 0.0)
        return Posture(axes=axes, normal=to_body(axes, scene.normal), velocity=velocity, gaps=gaps, rates=rates)

    def has_left(self, center: Vector3) -> bool:
        """Whether the axis, which runs through `center`, is beside its edges."""
        first, second = self.scene.edges
        beyond = max(dot(self._ahead, add(center, second, -1.0)), -dot(self._ahead, add(center, first, -1.0)))
        return beyond > ASIDE * self.scene.radius

    def collision_of(self, sample: Sample, posture: Posture, moment: Moment | None) -> Collision | None:
        scene = self.scene
        contacts = contacts_of(scene, posture, self.scatter)
        if contacts is None:
            return None
        age = 0.5 * scene.twist_window
        # The plane runs from one edge to the other, which closes next.
        behind = 1 - contacts.new[0]
        forth = 1.0 - 2.0 * behind
        axis, ahead = times(self._along, forth), times(self._ahead, forth)
        arm = add(center_of(scene, sample, posture), scene.edges[behind], -1.0)
        x, y = dot(ahead, arm), dot(scene.normal, arm)
        pull = scene.gravity if moment is None else gravity_over(scene, moment, sample, posture)
        gx, gy = dot(ahead, pull), dot(scene.normal, pull)
        edges, center = ((0.0, 0.0), self._lines[behind]), self._centers[behind]
        own_axis, own_ahead = to_body(posture.axes, axis), to_body(posture.axes, ahead)
        rate, lateral = dot(own_axis, sample.angular), dot(own_axis, posture.velocity)
        vx, vy, omega = dot(own_ahead, posture.velocity), dot(posture.normal, posture.velocity), -rate
        plane = ImpactPlane(
            axis=own_axis,
            ahead=own_ahead,
            normal=posture.normal,
            old=(-x, -y) if contacts.old else None,
            new=(edges[1][0] - x, edges[1][1] - y),
            twist=Twist(vx, vy, omega),
            gravity=(gx, gy, dot(axis, pull)),
            off_axis=off_axis_of(sample.angular, own_axis, rate),
            lateral=lateral,
            offset=0.0,
        )
        inertia = inertia_about(scene, plane.axis, blocked=True)
        start = PlanarState(x=x - vx * age, y=y - vy * age, angle=-omega * age, vx=vx, vy=vy, omega=omega)
        support: FeltSupport
        if moment is None or is_uniform(moment, scene.horizon):
            support = FixedSupport(atan2(-gx, -gy), hypot(gx, gy))
        else:
            origin = add(scene.edges[behind], self._along, dot(arm, self._along))
            support = planar_support(moment, age, origin, ahead, scene.normal, lateral)
        body = TwoPointBody(scene.mass, inertia, self._contact(edges[0], center), self._contact(edges[1], center))
        fall = next_strike(body, start, 0 if contacts.old else None, support, scene.horizon + age)
        if fall is None or (contacts.old and fall.point != 1):
            return None
        other, place = edges[1 - fall.point], (fall.state.x, fall.state.y)
        if not contacts.old or hypot(place[0] - other[0], place[1] - other[1]) - scene.radius > scene.tolerance:
            body = body._replace(old=None, new=self._contact(edges[fall.point], place))
        contacts = ActiveContacts(contacts.old, (abs(behind - fall.point),))
        return collision_after(sample, posture, contacts, plane, body, fall, (x, y), age)

    def touchdown_of(self, sample: Sample, posture: Posture, collision: Collision | SpatialCollision) -> Touchdown:
        assert isinstance(collision, Collision)
        told, body = super().touchdown_of(sample, posture, collision), collision.body
        drift, roll, yaw = collision.across
        touching = [body.new] if body.old is None else [body.old, body.new]
        slips = [drift - roll * one.y + yaw * one.x for one in touching]
        if max(map(abs, slips)) <= max(PLANAR * collision.speed, self.scatter.rate) or self.scene.friction == 0.0:
            return told
        return self._struck(told, collision, touching)

    def _struck(self, told: Touchdown, collision: Collision, touching: list[Contact]) -> Touchdown:
        """A touchdown whose contacts slip along the axis too: its impact is that of the law in three dimensions.

        The cylinder lies on its edges all along: they do not let it turn across its axis. Along the axis their
        impulses have no lever then, wherever they are.
        """
        scene, before, (drift, roll, yaw) = self.scene, collision.before, collision.across
        n, along = len(touching), told.axis
        # In the impact plane and against the axis: these are the principal axes, in which what is blocked stays so.
        axes = cross(along, scene.normal), scene.normal, times(along, -1.0)
        inertia = collision.body.inertia
        problem = [scene.mass, BLOCKED * inertia, BLOCKED * inertia, inertia, 0.0, 0.0, 0.0]
        problem += [before.vx, before.vy, -drift, roll, yaw, before.omega]
        for one in touching:
            problem += [one.x, one.y, 0.0, *one.normal, 0.0, scene.friction, scene.restitution, 0.0, 0.0, 0.0, 0.0]
        answer: Any = np.zeros(ANSWER + RESULT * n)
        notes: Any = np.zeros(1, np.int64)
        how = bool(number_of(scene.law)), scene.merge, hardly(scene), STEPS
        SOLVE(n, np.array([problem]), *how, answer[None], notes, *workspace(n))
        numbers = answer.tolist()
        center = add(told.position, to_world(axes_of(told.orientation), scene.center_of_mass))
        positions = [add(center, to_world(axes, (one.x, one.y, 0.0))) for one in touching]
        normals = [to_world(axes, (*one.normal, 0.0)) for one in touching]
        found = outcomes_of(numbers, collision.contacts, positions, normals)
        speeds, impulses = [] if told.old else [inf, inf], [] if told.old else [(0.0, 0.0)]
        for one, contact in zip(touching, found, strict=True):
            (nx, ny), (a, b, _), (u, v, _) = one.normal, contact.impulse, contact.velocity
            impulses.append((nx * a + ny * b, ny * a - nx * b))
            speeds += [nx * u + ny * v, inf if contact.state is ContactState.SLIPS else 0.0]
        vx, vy, vz, wx, wy, wz, lost = numbers[:ANSWER]
        after = SpatialTwist(to_world(axes, (vx, vy, vz)), to_world(axes, (wx, wy, wz)))
        now = axes_of(told.orientation)
        angular = to_body(now, after.angular)
        return told._replace(
            mode=MODES[mode_of(RESTS * collision.speed, *speeds)],
            after=Twist(vx, vy, wz),
            impulses=(impulses[0], impulses[1]),
            segments=(),
            energy_lost=lost,
            flags=flags_named(int(notes[0])),
            unique=True,
            linear=add(to_body(now, after.linear), cross(angular, scene.center_of_mass), -1.0),
            angular=angular,
            after_6d=after,
            contacts=tuple(
                contact._replace(impulse=to_world(axes, contact.impulse), velocity=to_world(axes, contact.velocity))
                for contact in found
            ),
            uncertainty=None,
            planar=None,
        )

    def _contact(self, edge: Vector, center: Vector) -> Contact:
        scene, (x, y) = self.scene, (edge[0] - center[0], edge[1] - center[1])
        distance = hypot(x, y)
        return Contact(x, y, scene.friction, (-x / distance, -y / distance), scene.restitution)
