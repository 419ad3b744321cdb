"""Planar motions in space: poses, twists and specific forces of a body's frame, for arrays over time."""

from __future__ import annotations

from math import cos, sin
from typing import Any, Final, NamedTuple

import numpy as np

from ..mechanics.motion import PlanarState
from ..prediction.types import Vector3
from .deck.sea import Array


class Plane(NamedTuple):
    """The plane of a motion: unit vectors along planar x (`ahead`) and y (`up`), and ahead x up (`axis`)."""

    ahead: Vector3
    up: Vector3
    axis: Vector3

    def vector(self, ahead: float, up: float) -> Vector3:
        """A vector of the plane in space."""
        (ax, ay, az), (ux, uy, uz), _ = self
        return ahead * ax + up * ux, ahead * ay + up * uy, ahead * az + up * uz

    def spin(self, omega: float) -> Vector3:
        """A rate of turning (rad/s) in space."""
        x, y, z = self.axis
        return omega * x, omega * y, omega * z


FORWARD: Final = Plane((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
"""x and z of the frame (REP-103): counter-clockwise in it is negative about y."""

ACROSS: Final = Plane((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
"""y and z of the frame: counter-clockwise in it is positive about x, as a ship rolls."""


class Mount(NamedTuple):
    """How the frame of a body moves with it.

    `beside` is the place of the mass centre along the plane's axis in m, `yaw` the turn in rad of the frame about `up`
    where the body's angle is 0, and `center` the mass centre in the frame in m.
    """

    beside: float = 0.0
    yaw: float = 0.0
    center: Vector3 = (0.0, 0.0, 0.0)


class Poses(NamedTuple):
    """Of a body's frame over time: position (n, 3) in m and orientation (n, 4) as x, y, z, w in the world; along its
    own axes the linear velocity (n, 3) in m/s of its origin and the angular one (n, 3) in rad/s.
    """

    position: Array
    orientation: Array
    linear: Array
    angular: Array


def poses(state: PlanarState, plane: Plane, mount: Mount) -> Poses:
    """The frame of a body whose mass centre moves as `state` (arrays (n,)) tells, in the world's axes."""
    x, y, angle, vx, vy, omega = state
    ahead, up, axis = (np.array(part) for part in plane)
    to_ahead, to_up, along = _center(plane, mount)
    c, s = np.cos(angle), np.sin(angle)
    dx, dy = c * to_ahead - s * to_up, s * to_ahead + c * to_up
    position = np.outer(x - dx, ahead) + np.outer(y - dy, up) + (mount.beside - along) * axis
    half_c, half_s = np.cos(0.5 * angle), np.sin(0.5 * angle)
    yaw_c, yaw_s = cos(0.5 * mount.yaw), sin(0.5 * mount.yaw)
    qx, qy, qz = (half_s * part for part in plane.axis)
    orientation = np.stack(
        [qx * yaw_c + qy * yaw_s, qy * yaw_c - qx * yaw_s, half_c * yaw_s + qz * yaw_c, half_c * yaw_c - qz * yaw_s], 1
    )
    linear = in_frame(plane, mount, angle, vx + omega * dy, vy - omega * dx)
    return Poses(position, orientation, linear, np.outer(omega, _unyawed(np.array(plane.axis), mount.yaw)))


def origin_velocity(state: PlanarState, plane: Plane, mount: Mount) -> tuple[Array, Array]:
    """The velocity of the frame's origin in the plane, along its two directions in the world."""
    to_ahead, to_up, _ = _center(plane, mount)
    c, s = np.cos(state.angle), np.sin(state.angle)
    return (
        state.vx + state.omega * (s * to_ahead + c * to_up),
        state.vy - state.omega * (c * to_ahead - s * to_up),
    )


def in_frame(plane: Plane, mount: Mount, angle: Any, ahead: Any, up: Any) -> Array:
    """A vector of the plane (arrays (n,) along its directions in the world) along the axes of the body's frame."""
    c, s = np.cos(angle), np.sin(angle)
    turned_back = np.outer(c * ahead + s * up, plane.ahead) + np.outer(c * up - s * ahead, plane.up)
    return _unyawed(turned_back, mount.yaw)


def _center(plane: Plane, mount: Mount) -> tuple[float, float, float]:
    """The mass centre seen from the frame's origin where the body's angle is 0: ahead, up and along the axis."""
    x, y, z = mount.center
    c, s = cos(mount.yaw), sin(mount.yaw)
    arm = np.array((c * x - s * y, s * x + c * y, z))
    ahead, up, axis = (float(arm @ np.array(part)) for part in plane)
    return ahead, up, axis


def _unyawed(vectors: Array, yaw: float) -> Array:
    """Vectors (..., 3) along axes that are turned by `yaw` about z."""
    c, s = cos(yaw), sin(yaw)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([c * x + s * y, c * y - s * x, z], axis=-1)
