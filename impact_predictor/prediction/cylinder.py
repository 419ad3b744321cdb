"""A cylinder that lies on two parallel edges of its support and rocks from one to the other (the paper, section 4).

The edges take the place of the contact points, as numbers 0 and 1. They run through the two given points, across the
line between these and in the support, and so does the axis of the cylinder, on which its mass centre lies. The normals
point from the edges to the axis: a contact slips where the cylinder spins. Friction against slip along the axis is left
out.
"""

from __future__ import annotations

from math import atan2, hypot, sqrt

from ..errors import InputError
from ..mechanics.motion import PlanarState, next_strike
from ..mechanics.motion.support import FixedSupport
from ..mechanics.types import Contact, Twist, TwoPointBody, Vector
from .deck.approach import PlanarSupport, gravity_over, is_uniform
from .impact import Collision
from .planar import (
    GRAZES,
    ActiveContacts,
    ImpactPlane,
    Posture,
    center_of,
    contacts_of,
    inertia_about,
    off_axis_of,
)
from .points import PointContacts
from .scene import Scene
from .types import Moment, Sample, Vector3
from .vectors import add, axes_of, cross, dot, times, to_body, to_world

ASIDE = 0.5
"""A cylinder has left its edges when its axis is farther outside of them than this part of its radius: there it would
still balance over an edge of a support that leans by 30 degrees."""


class CylinderContacts(PointContacts):
    """The contacts of the cylinder of a scene with its edges."""

    slips_across = False

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
        if not 1e-6 * scene.radius < width <= length < 2.0 * scene.radius:
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
        """The sample over the edges."""
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
        contacts = contacts_of(scene, posture)
        if contacts is None:
            return None
        age = 0.5 * scene.twist_window
        struck = contacts.new[0]
        sides = (0, 1) if struck == 1 else (1, 0)
        forth = 1.0 if struck == 1 else -1.0
        axis, ahead = times(self._along, forth), times(self._ahead, forth)
        place = center_of(scene, sample, posture)
        arm = add(place, scene.edges[sides[0]], -1.0)
        x, y = dot(ahead, arm), dot(scene.normal, arm)
        plane = self._plane(sample, posture, moment, contacts, axis, ahead, (x, y))
        inertia = inertia_about(scene, plane.axis, blocked=True)
        vx, vy, omega = plane.twist
        start = PlanarState(x=x - vx * age, y=y - vy * age, angle=-omega * age, vx=vx, vy=vy, omega=omega)
        gx, gy, _ = plane.gravity
        support: FixedSupport | PlanarSupport
        if moment is None or is_uniform(moment, scene.horizon):
            support = FixedSupport(atan2(-gx, -gy), hypot(gx, gy))
        else:
            origin = add(scene.edges[sides[0]], self._along, dot(arm, self._along))
            support = PlanarSupport(moment, age, origin, ahead, scene.normal, plane.lateral)
        body = self._body(forth, inertia)
        fall = next_strike(body, start, 0 if contacts.old else None, support, scene.horizon + age)
        if fall is None or (contacts.old and fall.point != 1):
            return None
        body = self._body_at(body, forth, fall.point, fall.state, bool(contacts.old))
        nx, ny = body.new.normal
        speed = -(nx * fall.state.vx + ny * fall.state.vy)
        if speed < GRAZES:
            return None
        new = (sides[fall.point],)
        state = fall.state
        return Collision(
            contacts=ActiveContacts(contacts.old, new, contacts.base),
            plane=plane,
            body=body,
            before=Twist(state.vx, state.vy, state.omega),
            shift=(state.x - x, state.y - y),
            angle=state.angle,
            lead_time=max(0.0, fall.time - age),
            blocked=True,
            measured=-posture.rates[new[0]],
            speed=speed,
        )

    def _plane(
        self,
        sample: Sample,
        posture: Posture,
        moment: Moment | None,
        contacts: ActiveContacts,
        axis: Vector3,
        ahead: Vector3,
        center: Vector,
    ) -> ImpactPlane:
        """The impact plane, in the body frame; `axis` and `ahead` are given in the support's frame, and the axis of the
        cylinder in the plane from the edge behind.
        """
        scene, axes, velocity = self.scene, posture.axes, posture.velocity
        gravity = scene.gravity if moment is None else gravity_over(scene, moment, sample, posture)
        line = self._lines[0 if contacts.new[0] == 1 else 1]
        own_axis, own_ahead = to_body(axes, axis), to_body(axes, ahead)
        rate = dot(own_axis, sample.angular)
        return ImpactPlane(
            axis=own_axis,
            ahead=own_ahead,
            old=(-center[0], -center[1]) if contacts.old else None,
            new=(line[0] - center[0], line[1] - center[1]),
            twist=Twist(dot(own_ahead, velocity), dot(posture.normal, velocity), -rate),
            gravity=(dot(ahead, gravity), dot(scene.normal, gravity), dot(axis, gravity)),
            off_axis=off_axis_of(sample.angular, own_axis, rate),
            lateral=dot(own_axis, velocity),
            offset=0.0,
        )

    def _body(self, forth: float, inertia: float) -> TwoPointBody:
        """The body on both edges, `forth` being 1 from the first to the second and -1 back."""
        side = 0 if forth > 0.0 else 1
        return TwoPointBody(
            self.scene.mass,
            inertia,
            self._contact((0.0, 0.0), self._centers[side]),
            self._contact(self._lines[side], self._centers[side]),
        )

    def _body_at(self, body: TwoPointBody, forth: float, struck: int, state: PlanarState, stood: bool) -> TwoPointBody:
        """The body when it strikes: on both edges where it stood on the other one until then."""
        edges = (0.0, 0.0), self._lines[0 if forth > 0.0 else 1]
        other = edges[1 - struck]
        if stood and hypot(state.x - other[0], state.y - other[1]) - self.scene.radius <= self.scene.tolerance:
            return body
        return body._replace(old=None, new=self._contact(edges[struck], (state.x, state.y)))

    def _contact(self, edge: Vector, center: Vector) -> Contact:
        """A contact at an edge of a cylinder with its axis at `center`."""
        scene, (x, y) = self.scene, (edge[0] - center[0], edge[1] - center[1])
        distance = hypot(x, y)
        return Contact(x, y, scene.friction, (-x / distance, -y / distance), scene.restitution)
