"""Simple answers to a touchdown, which a prediction has to beat."""

from __future__ import annotations

from typing import Final

from ..mechanics.impact import solve_impact
from ..mechanics.types import Contact, Twist, TwoPointBody
from .course import Course
from .planar import ORIGIN, inertia_about
from .types import SpatialTwist, Touchdown
from .vectors import add, axes_of, combine, cross, dot, mean, times, to_body, to_world

SIMPLE: Final = {
    "nothing": "nothing happens",
    "stops": "all stops",
    "slows": "0.85 v",
    "no_slip": "no slip",
    "planar": "planar law",
}
"""The simple answers in words."""

SLOWS: Final = 0.85
"""What is left of the velocity along the support in most planar landings of a recorded cube."""


def simple_answers(told: Touchdown, course: Course) -> tuple[tuple[Course, SpatialTwist], ...]:
    """For each of `SIMPLE` the twist right after the touchdown, and how the body goes on from there.

    If nothing happens it goes on as if there were no support. In the plastic answer the points that take part stop, and
    those that would leave do.
    """
    (linear, _), normal = told.before_6d, course.scene.normal
    along = add(linear, normal, -dot(normal, linear))
    return (
        (course._replace(points=(), resting=()), told.before_6d),
        (course, SpatialTwist(ORIGIN, ORIGIN)),
        (course, SpatialTwist(times(along, SLOWS), ORIGIN)),
        (course, course.stopped(told.before_6d)),
        (course, _planar(told, course)),
    )


def _planar(told: Touchdown, course: Course) -> SpatialTwist:
    """What the path law says in the impact plane; the motion across it goes on."""
    scene, axes, (linear, angular) = course.scene, axes_of(course.start.orientation), told.before_6d
    ahead = cross(told.axis, scene.normal)
    places = []
    for group in (told.old, told.new):
        if group:
            middle = add(mean([course.points[i] for i in group]), scene.center_of_mass, -1.0)
            arm = to_world(axes, middle)
            places.append((dot(ahead, arm), dot(scene.normal, arm)))
    x, y = places[-1]
    new = Contact(x, y, scene.friction, restitution=scene.restitution)
    # The old contact stands on the level of the new one.
    old = Contact(places[0][0], y, scene.friction) if told.old and places[0][0] < x else None
    body = TwoPointBody(scene.mass, inertia_about(scene, to_body(axes, told.axis), blocked=False), old, new)
    before = Twist(dot(ahead, linear), dot(scene.normal, linear), -dot(told.axis, angular))
    after = solve_impact(body, before, "path", scene.validity).twist
    gain = combine(after.vx - before.vx, ahead, after.vy - before.vy, scene.normal, 0.0, ahead)
    return SpatialTwist(add(linear, gain), add(angular, told.axis, before.omega - after.omega))
