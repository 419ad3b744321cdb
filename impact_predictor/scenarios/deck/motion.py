"""The motion of a deck in six degrees of freedom, and what is felt on it.

Surge, sway and heave are along the axes of the world (m), x ahead, y to port, z up; roll about x raises port, pitch
about y lowers the bow, yaw about z turns the bow to port (rad). The vessel is yawed first, then pitched, then rolled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanics.motion.support import MovingSupport, SupportMotion
from ..sensors import Poses, rotated, rotations

AXES: Final = ("surge", "sway", "heave", "roll", "pitch", "yaw")
ACROSS: Final = (3, 1, 2)
"""Roll, sway and heave: the motion in the transverse plane."""


class DeckState(NamedTuple):
    """A deck at n times: its `poses` in the world; the `gravity` (n, 3) in m/s^2 that is felt at its origin, and the
    derivative `turning` (n, 3) in rad/s^2 of its angular velocity, both along its axes.
    """

    poses: Poses
    gravity: NDArray[np.float64]
    turning: NDArray[np.float64]

    def felt_at(self, place: Any) -> NDArray[np.float64]:
        """The gravity (n, 3) that is felt at a place (m) of the deck's frame."""
        spin = self.poses.angular
        felt: NDArray[np.float64] = self.gravity - np.cross(self.turning, place) - np.cross(spin, np.cross(spin, place))
        return felt


class DeckMotion:
    """A deck that moves as `axes(times)` tells: the motions, their rates and accelerations (3, 6, n) at times (n,).

    Its frame lies `height` m above the point of which they are. No motion swings faster than in `period` s; `plane`
    tells the deck as a support in its transverse plane where nothing else moves.
    """

    def __init__(
        self,
        axes: Callable[[NDArray[np.float64]], NDArray[np.float64]],
        period: float,
        gravity: float = 9.81,
        height: float = 0.0,
        plane: MovingSupport | None = None,
    ) -> None:
        self.axes, self.period, self.gravity, self.height, self.plane = axes, period, gravity, height, plane

    def at(self, times: NDArray[np.float64]) -> DeckState:
        """The deck at times (n,) in s."""
        place, rate, acceleration = self.axes(times)
        half = 0.5 * place[3:]
        (cr, cp, cy), (sr, sp, sy) = np.cos(half), np.sin(half)
        orientation = np.stack(
            [
                sr * cp * cy - cr * sp * sy,
                cr * sp * cy + sr * cp * sy,
                cr * cp * sy - sr * sp * cy,
                cr * cp * cy + sr * sp * sy,
            ],
            axis=1,
        )
        matrices = rotations(orientation)
        _, sp, _ = np.sin(place[3:])
        (cr, cp, _), sr = np.cos(place[3:]), np.sin(place[3])
        (dr, dp, dy), (ddr, ddp, ddy) = rate[3:], acceleration[3:]
        # Along the deck's axes: roll about its own x, pitch about the y before the roll, yaw about the world's z.
        angular = np.stack([dr - dy * sp, dp * cr + dy * sr * cp, dy * cr * cp - dp * sr], axis=1)
        turning = np.stack(
            [
                ddr - ddy * sp - dy * dp * cp,
                ddp * cr - dp * dr * sr + ddy * sr * cp + dy * dr * cr * cp - dy * dp * sr * sp,
                ddy * cr * cp - dy * dr * sr * cp - dy * dp * cr * sp - ddp * sr - dp * dr * cr,
            ],
            axis=1,
        )
        up = np.array((0.0, 0.0, self.height))
        linear = rotated(matrices, rate[:3].T, back=True) + np.cross(angular, up)
        poses = Poses(place[:3].T + self.height * matrices[:, :, 2], orientation, linear, angular)
        weight = -acceleration[:3].T - np.array((0.0, 0.0, self.gravity))
        below = DeckState(poses, rotated(matrices, weight, back=True), turning)
        return below._replace(gravity=below.felt_at(up))

    def across(self, ahead: float, foot: tuple[float, float]) -> MovingSupport:
        """The deck as a support in the world's y-z plane, as far as it moves in it `ahead` m of its origin.

        The support's origin lies at the place `foot` (y, z) of the deck.
        """
        plane = self.plane or MovingSupport(lambda time: self._section(ahead, time), self.period, self.gravity)
        return plane.at(*foot)

    def _section(self, ahead: float, time: Any) -> SupportMotion:
        times = np.atleast_1d(np.asarray(time, dtype=float))
        state, place = self.at(times), np.array((ahead, 0.0, 0.0))
        poses, matrices = state.poses, rotations(state.poses.orientation)
        position = poses.position + ahead * matrices[:, :, 0]
        velocity = rotated(matrices, poses.linear + np.cross(poses.angular, place))
        acceleration = -rotated(matrices, state.felt_at(place)) - np.array((0.0, 0.0, self.gravity))
        angle, rate, turning = self.axes(times)[:, 3]
        rows = (angle, rate, turning, *position.T[1:], *velocity.T[1:], *acceleration.T[1:])
        return SupportMotion(*(rows if np.ndim(time) else (float(row[0]) for row in rows)))


def planar_deck(plane: MovingSupport) -> DeckMotion:
    """A deck that moves in its transverse plane alone, as a support does."""

    def axes(times: NDArray[np.float64]) -> NDArray[np.float64]:
        angle, rate, acceleration, x, y, vx, vy, ax, ay = plane.motion(times)
        found = np.zeros((3, len(AXES), len(times)))
        found[:, ACROSS] = (angle, x, y), (rate, vx, vy), (acceleration, ax, ay)
        return found

    return DeckMotion(axes, plane.period, plane.gravity, plane=plane)
