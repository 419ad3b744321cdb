"""The approach to the next touchdown, from one sample: which points strike, when, and how the body moves then."""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from ..mechanics.impact import new_tuple
from ..mechanics.motion import PlanarState, next_touchdown
from ..mechanics.types import Contact, Twist, TwoPointBody, Vector
from .planar import Contacts, Plane, Posture, contacts_of, inertia_about, plane_of
from .scene import Scene
from .types import Moment, Sample, Vector3
from .vectors import total

GRAZES = 1e-9
"""m/s: what reaches the support slower only grazes it."""

ACCURACY = 1e-6
"""Of the motion before the touchdown, relative: a thousandth of what poses and twists are measured to."""


class Approach(NamedTuple):
    """A touchdown ahead, before its impact.

    `body` and its twist `before` are those of the impact, in the impact plane; `moved` how the body moves there until
    then, from the sample's pose; `lead_time` in s; `blocked` whether its contacts are edges, off whose line it cannot
    turn. `measured` is the speed in m/s at which the sample shows the new points to approach, `speed` that of the
    touchdown.
    """

    contacts: Contacts
    plane: Plane
    body: TwoPointBody
    before: Twist
    moved: PlanarState
    lead_time: float
    blocked: bool
    measured: float
    speed: float


def approach_of(
    scene: Scene, points: tuple[Vector3, ...], sample: Sample, posture: Posture, moment: Moment | None = None
) -> Approach | None:
    """The touchdown that a sample shows to be ahead; None where there is none within the horizon.

    Over a moving support the sample is seen from there, and `moment` is the support at its stamp.
    """
    contacts = contacts_of(scene, posture)
    if contacts is None:
        return None
    gravity = scene.gravity
    if moment is not None:
        from .deck.approach import fall_over, gravity_over, is_uniform  # only where the support moves

        gravity = gravity_over(scene, moment, sample, posture)
        if is_uniform(moment, scene.horizon):
            moment = None
    plane = plane_of(scene, points, sample, posture, contacts, gravity)
    on_edge = len(contacts.old) > 1
    inertia = inertia_about(scene, plane.axis, blocked=on_edge)
    # An averaged twist is that of half its window ago: the motion is followed from there.
    age = 0.5 * scene.twist_window
    vx, vy, omega = plane.twist
    old, new = plane.old, plane.new
    if old is None:
        striking: tuple[Vector, ...] = (new,)
        height = plane.gap - new[1]
    else:
        striking = (old, new)
        height = -old[1]
    start = new_tuple(PlanarState, (-vx * age, height - vy * age, -omega * age, vx, vy, omega))
    if moment is None:
        fall = next_touchdown(
            start,
            striking,
            None if old is None else 0,
            inertia / scene.mass,
            scene.friction,
            plane.gravity[:2],
            scene.horizon + age,
            ACCURACY,
        )
    else:
        fall = fall_over(scene, moment, sample, posture, plane, inertia, start, height)
    if fall.point != len(striking) - 1:
        return None
    x, y, angle, vx, vy, omega = fall.state
    body = body_at(scene, plane, inertia, angle)
    blocked = on_edge and body.old is not None and len(contacts.new) > 1
    if on_edge and not blocked:
        body = TwoPointBody(body.mass, inertia_about(scene, plane.axis, blocked=False), body.old, body.new)
    if body.old is not None and body.old.x >= body.new.x:
        return None  # it falls back, and other points strike before
    speed = -(vy + omega * body.new.x)
    if speed < GRAZES:
        return None
    measured = -total([posture.rates[i] for i in contacts.new]) / len(contacts.new)
    approach = (
        contacts,
        plane,
        body,
        new_tuple(Twist, (vx, vy, omega)),
        new_tuple(PlanarState, (x, y - height, angle, vx, vy, omega)),
        max(0.0, fall.time - age),
        blocked,
        measured,
        speed,
    )
    return new_tuple(Approach, approach)


def body_at(scene: Scene, plane: Plane, inertia: float, angle: float) -> TwoPointBody:
    """The body when it has turned by `angle` in the impact plane and the new contact is on the support."""
    c, s = cos(angle), sin(angle)
    x, y = plane.new
    new = Contact(c * x - s * y, s * x + c * y, scene.friction, restitution=scene.restitution)
    if plane.old is None:
        return TwoPointBody(scene.mass, inertia, None, new)
    x, y = plane.old
    if s * x + c * y - new.y > scene.tolerance:
        return TwoPointBody(scene.mass, inertia, None, new)  # it has lifted on the way
    # Where it stands both are on one level up to rounding; made exact, so that rounding does not make it a step.
    return TwoPointBody(scene.mass, inertia, Contact(c * x - s * y, new.y, scene.friction), new)
