"""How a body goes on after an impact, by gravity and plastic contacts with friction, until it is measured.

Small steps at the level of velocities: at the end of each no point is below the support, and friction is within its
cone (Stewart and Trinkle 1996; Anitescu and Potra 1997). A point that comes down within a step is on the support at its
end, so that poses are right even after steps as long as a third of a frame.
"""

from __future__ import annotations

from math import ceil, sqrt
from typing import Final, NamedTuple

from .scene import InertiaTensor, Scene
from .types import Quaternion, SpatialTwist, Vector3
from .vectors import (
    Axes,
    add,
    any_across,
    applied,
    axes_of,
    conjugate,
    cross,
    dot,
    inverse,
    rotation_between,
    times,
    to_body,
    to_world,
    turned,
)

STEP: Final = 2.5e-3
"""s, at most."""

SWEEPS: Final = 100
"""Over the points on the support, one after the other (Gauss and Seidel); two points need a few."""

STICKY: Final = 1e6
"""Friction with which nothing slips."""

CONVERGED: Final = 1e-4
"""m/s: changes of velocities in a sweep that end them."""

Row = tuple[float, float, float, float, float, float, float, float, float, float]
"""A direction at a contact (3), its moment about the mass centre (3), how a unit impulse along it turns the body (3),
and the impulse for a unit of speed.
"""

FlatTwist = tuple[float, float, float, float, float, float]
"""The velocity of the mass centre and the angular velocity, along the axes of the world."""


class Pose(NamedTuple):
    """Where a body is: its mass centre (m), and its orientation as (x, y, z, w)."""

    center: Vector3
    orientation: Quaternion


class Course(NamedTuple):
    """What decides how a body goes on after an impact, besides its twist.

    `points` of the body in m, in its frame; `gravity` the acceleration of a free body in m/s^2; `start` the pose at the
    impact; `resting` the points that are on the support then, whatever their gaps say.
    """

    scene: Scene
    points: tuple[Vector3, ...]
    gravity: Vector3
    start: Pose
    resting: tuple[int, ...]

    def poses(self, twist: SpatialTwist, moments: tuple[float, ...]) -> list[Pose]:
        """The poses at some moments, in s after the impact and rising, of a body with this twist right after it."""
        scene, normal, mobility = self.scene, self.scene.normal, inverse(self.scene.inertia)
        arms = [add(point, scene.center_of_mass, -1.0) for point in self.points]
        (center, orientation), (linear, spin) = self.start, twist
        upright = to_body(axes_of(orientation), normal)
        height = dot(normal, center) - scene.height
        levels = [max(0.0, height + dot(upright, arms[i])) if i in self.resting else 0.0 for i in range(len(arms))]
        now, found = 0.0, []
        for moment in moments:
            count = max(1, ceil((moment - now) / STEP - 1e-9))
            h = max(0.0, moment - now) / count
            for _ in range(count if h > 0.0 else 0):
                axes = axes_of(orientation)
                own = to_body(axes, spin)
                spin = add(spin, to_world(axes, applied(mobility, cross(applied(scene.inertia, own), own))), h)
                linear = add(linear, self.gravity, h)
                own, upright = to_body(axes, spin), to_body(axes, normal)
                swing, rate = cross(upright, own), dot(normal, linear)
                # Over a step a free body falls by half of gravity's gain less than its last velocity says.
                height, gain = dot(normal, center) - scene.height, 0.5 * h * dot(normal, self.gravity)
                contacts = []
                for arm, level in zip(arms, levels, strict=True):
                    limit = gain - max(0.0, height - level + dot(upright, arm)) / h
                    if rate + dot(swing, arm) < limit:
                        contacts.append((_rows(scene, mobility, axes, arm), limit))
                if contacts:
                    linear, spin = _pressed(contacts, scene.friction, 1.0 / scene.mass, linear, spin)
                    own = to_body(axes, spin)
                center = add(add(center, linear, h), self.gravity, -0.5 * h * h)
                orientation = turned(orientation, times(own, h))
            now = moment
            found.append(Pose(center, orientation))
        return found

    def stopped(self, twist: SpatialTwist) -> SpatialTwist:
        """The twist after a plastic impact without slip: the points that rest stop, or leave."""
        scene, axes = self.scene, axes_of(self.start.orientation)
        mobility = inverse(scene.inertia)
        arms = [add(self.points[i], scene.center_of_mass, -1.0) for i in self.resting]
        contacts = [(_rows(scene, mobility, axes, arm), 0.0) for arm in arms]
        return SpatialTwist(*_pressed(contacts, STICKY, 1.0 / scene.mass, *twist))


def between(one: Pose, other: Pose, seconds: float) -> SpatialTwist:
    """The mean twist from one pose to the other."""
    # Along the axes of the world: between the ways back.
    turn = rotation_between(conjugate(other.orientation), conjugate(one.orientation), 1.0 / seconds)
    return SpatialTwist(times(add(other.center, one.center, -1.0), 1.0 / seconds), turn)


def _rows(scene: Scene, mobility: InertiaTensor, axes: Axes, arm: Vector3) -> list[Row]:
    """The rows of a contact along the normal and across it, at an arm in the body's frame."""
    normal, reach, rows = scene.normal, to_world(axes, arm), list[Row]()
    across = any_across(normal)
    across = add(across, normal, -dot(across, normal))
    across = times(across, 1.0 / sqrt(dot(across, across)))
    for along in (normal, across, cross(normal, across)):
        moment = cross(reach, along)
        turning = to_world(axes, applied(mobility, to_body(axes, moment)))
        rows.append((*along, *moment, *turning, 1.0 / (1.0 / scene.mass + dot(moment, turning))))
    return rows


def _pressed(
    contacts: list[tuple[list[Row], float]], friction: float, per_mass: float, linear: Vector3, spin: Vector3
) -> tuple[Vector3, Vector3]:
    """The velocities after plastic impulses with which no contact comes down faster than its limit."""
    motion, impulses = (*linear, *spin), [(0.0, 0.0, 0.0)] * len(contacts)
    for _ in range(SWEEPS):
        most = 0.0
        for which, ((upward, first, second), limit) in enumerate(contacts):
            press, along, across = impulses[which]
            change = max(0.0, press - upward[9] * (_speed(upward, motion) - limit)) - press
            motion = _pushed(upward, motion, change, per_mass)
            press += change
            wanted = along - first[9] * _speed(first, motion), across - second[9] * _speed(second, motion)
            drag = sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1])
            part = friction * press / drag if drag > friction * press else 1.0
            x, y = part * wanted[0], part * wanted[1]
            motion = _pushed(first, motion, x - along, per_mass)
            motion = _pushed(second, motion, y - across, per_mass)
            most = max(most, abs(change), abs(x - along), abs(y - across))
            impulses[which] = press, x, y
        if most * per_mass < CONVERGED:
            break
    vx, vy, vz, wx, wy, wz = motion
    return (vx, vy, vz), (wx, wy, wz)


def _speed(row: Row, motion: FlatTwist) -> float:
    dx, dy, dz, mx, my, mz, ux, uy, uz, unit = row
    vx, vy, vz, wx, wy, wz = motion
    return vx * dx + vy * dy + vz * dz + wx * mx + wy * my + wz * mz


def _pushed(row: Row, motion: FlatTwist, impulse: float, per_mass: float) -> FlatTwist:
    dx, dy, dz, mx, my, mz, ux, uy, uz, unit = row
    vx, vy, vz, wx, wy, wz = motion
    gain = impulse * per_mass
    return (
        vx + gain * dx,
        vy + gain * dy,
        vz + gain * dz,
        wx + impulse * ux,
        wy + impulse * uy,
        wz + impulse * uz,
    )
