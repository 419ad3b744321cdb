"""What is felt on a moving support over time, as polynomials."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache

FrameAcceleration = tuple[float, float, float, float]
"""Acceleration felt at rest at the origin, along the support's axes (m/s^2); rate (rad/s); angular acceleration."""

_MAX_PARTS = 4096
"""Polynomials that are kept."""


class FeltPolynomials:
    """What is felt, from polynomials in time: a motion asks for it a hundred times, and a sum of waves takes long.

    Each has a `length` in s and goes through the values that `exactly` gives at `nodes` Chebyshev nodes of it. Where
    the last two terms of one are above `fit` of what is felt, `exactly` is asked itself.
    """

    def __init__(
        self,
        exactly: Callable[[list[float]], Sequence[Sequence[float]]],
        length: float,
        nodes: int,
        gravity: float = 9.81,
        fit: float = math.inf,
    ) -> None:
        self._exactly, self._length, self._nodes = exactly, length, _nodes(nodes)
        self.gravity, self._fit = gravity, fit
        self.period = math.inf
        self._parts: dict[int, list[tuple[float, float, float, float, float]]] = {}

    def felt(self, time: float) -> FrameAcceleration:
        """What a body feels at rest at the support's origin."""
        place = time / self._length
        number = math.floor(place)
        part = self._parts.get(number)
        if part is None:
            if len(self._parts) >= _MAX_PARTS:
                self._parts.clear()
            part = self._parts[number] = self._polynomials(number)
        if not part:
            x, y, w, a = self._exactly([time])[0]
            return x, y, w, a
        s = 2.0 * (place - number) - 1.0
        x = y = w = a = 0.0
        for node, cx, cy, cw, ca in part:
            s_node = s - node
            x = x * s_node + cx
            y = y * s_node + cy
            w = w * s_node + cw
            a = a * s_node + ca
        return x, y, w, a

    def _polynomials(self, number: int) -> list[tuple[float, float, float, float, float]]:
        """Nodes and divided differences of one part (Newton's form), the highest first; none where they do not fit."""
        nodes, length = self._nodes, self._length
        exact = self._exactly([(number + 0.5 + 0.5 * node) * length for node in nodes])
        columns: list[list[float]] = [list(column) for column in zip(*exact, strict=True)]
        for column in columns:
            for order in range(1, len(nodes)):
                for k in range(len(nodes) - 1, order - 1, -1):
                    column[k] = (column[k] - column[k - 1]) / (nodes[k] - nodes[k - order])
        rows = list(zip(nodes, *columns, strict=True))
        if self._fit < math.inf and not self._fits(exact, rows):
            return []
        return rows[::-1]

    def _fits(self, exact: Sequence[Sequence[float]], rows: list[tuple[float, ...]]) -> bool:
        """Whether the last two terms are small enough."""
        x, y, w, a = [max(map(abs, column)) for column in zip(*exact, strict=True)]
        sizes = max(x, y), max(x, y), w, max(a, w / self._length)
        # As terms of Chebyshev's series: those of the powers are so many times as large.
        large = self._fit * 2.0 ** (len(rows) - 3)
        return all(abs(end) <= large * size for row in rows[-2:] for end, size in zip(row[1:], sizes, strict=True))


@cache
def _nodes(count: int) -> list[float]:
    """Chebyshev's nodes on -1..1, each as far from those before it as can be: Newton's form keeps its digits then."""
    left = [math.cos((k + 0.5) * math.pi / count) for k in range(count)]
    nodes: list[float] = []
    while left:
        apart = [math.prod([abs(node - other) for other in nodes]) for node in left]
        nodes.append(left.pop(apart.index(max(apart))))
    return nodes
