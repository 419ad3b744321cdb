"""A predicted course of what is felt on a support, between the steps at which it was predicted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..types import Vector3

Array = NDArray[np.float64]

STEP = 100_000_000
"""ns between two steps."""

SECONDS = STEP / 1e9


class Course:
    """Cubic pieces through predicted rows, each the acceleration felt (m/s^2) and the angular velocity (rad/s).

    `tick` is the stamp, in steps, of row `past`, where the prediction begins. Slopes at the steps are those of the
    parabola of fourth order through two neighbours on each side. Before the first row and after the last they stand.
    """

    def __init__(self, tick: int, rows: Array, past: int) -> None:
        self._begin = (tick - past) * STEP
        padded = np.concatenate([rows[:1], rows[:1], rows, rows[-1:], rows[-1:]])
        slopes = (8.0 * (padded[3:-1] - padded[1:-3]) - (padded[4:] - padded[:-4])) / 12.0
        first, second, m0, m1 = rows[:-1], rows[1:], slopes[:-1], slopes[1:]
        # a + b s + c s^2 + d s^3 for s = 0..1 from each row to the next
        pieces = np.stack([first, m0, 3.0 * (second - first) - 2.0 * m0 - m1, 2.0 * (first - second) + m0 + m1])
        areas = SECONDS * (pieces / np.arange(1.0, 5.0)[:, None, None]).sum(0)[:, 3:]
        self._areas = np.concatenate([np.zeros((1, 3)), np.cumsum(areas, axis=0)])
        self._pieces = pieces
        self._plain = np.concatenate([*pieces, self._areas[:-1]], axis=1).tolist()
        self._last = len(first) - 1

    def time_of(self, stamp: int) -> float:
        """The time in s of a stamp since the first row."""
        return (stamp - self._begin) / 1e9

    def at(self, time: float) -> tuple[Vector3, Vector3, Vector3, Vector3]:
        """Acceleration felt, angular velocity, its derivative and its integral since the first row."""
        x = min(max(time / SECONDS, 0.0), self._last + 1.0)
        i = min(int(x), self._last)
        s = x - i
        a0, a1, a2, a3, a4, a5, b0, b1, b2, b3, b4, b5, c0, c1, c2, c3, c4, c5, d0, d1, d2, d3, d4, d5, *area = (
            self._plain[i]
        )
        u, v, w = SECONDS * s, 2.0 * s / SECONDS, 3.0 * s * s / SECONDS
        half, third, fourth = 0.5 * s, s * s / 3.0, 0.25 * s * s * s
        return (
            (a0 + s * (b0 + s * (c0 + s * d0)), a1 + s * (b1 + s * (c1 + s * d1)), a2 + s * (b2 + s * (c2 + s * d2))),
            (a3 + s * (b3 + s * (c3 + s * d3)), a4 + s * (b4 + s * (c4 + s * d4)), a5 + s * (b5 + s * (c5 + s * d5))),
            (b3 / SECONDS + v * c3 + w * d3, b4 / SECONDS + v * c4 + w * d4, b5 / SECONDS + v * c5 + w * d5),
            (
                area[0] + u * (a3 + half * b3 + third * c3 + fourth * d3),
                area[1] + u * (a4 + half * b4 + third * c4 + fourth * d4),
                area[2] + u * (a5 + half * b5 + third * c5 + fourth * d5),
            ),
        )
