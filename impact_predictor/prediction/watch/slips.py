"""The friction of bodies on a moving support, from when they held and when they slid."""

from __future__ import annotations

from math import inf
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

BIN: Final = 250_000_000  # ns over which what is needed is averaged: noise counts less, and waves are longer
STANDARD_GRAVITY: Final = 9.80665
NOISE: Final = 0.02
"""What a body needs is never known better: the tilt and the mass centre of units are not."""

DEVIATIONS: Final = 3.0  # of what is felt, that noise adds now and then to the highest of many

BINS: Final = 8
"""A slide is seen once a body has moved, and so may have begun in any of the last bins."""

RESTS: Final = 4
"""Bins after a slide was seen in which it may still go on."""


class FrictionSeen(NamedTuple):
    """The highest friction that a body needed while it `held`, less what noise may add, and the lowest that did not do
    when it `slid`, with as much more, inf where it never did: its own is between them, if it does not change.
    """

    held: float = 0.0
    slid: float = inf

    def __str__(self) -> str:
        if self.slid < inf:
            return f"{min(self):.3f} to {max(self):.3f}"
        return f"above {self.held:.3f}" if self.held > 0.0 else "unknown"

    def and_also(self, other: FrictionSeen) -> FrictionSeen:
        """What both have seen."""
        return FrictionSeen(max(self.held, other.held), min(self.slid, other.slid))


class Slips:
    """What is seen of the friction of some bodies.

    `told` (n,) is whether friction alone holds one and its pose is measured; `unseen` (n,) how far in m it may slide
    before that is seen.
    """

    def __init__(self, told: NDArray[np.bool_]) -> None:
        self._told = told
        self.unseen = np.zeros(len(told))
        self._held, self._slid = np.zeros(len(told)), np.full(len(told), inf)
        self._sum, self._count = np.zeros((2, len(told), BINS))
        self._slid_in = np.full(len(told), -RESTS)
        self._bin, self._doubt = 0, NOISE

    def update(self, stamp: int, needed: NDArray[np.float64], stands: NDArray[np.bool_], error: float = 0.0) -> None:
        """Take the friction (n,) that bodies need at a stamp in ns, which of them stand, and the error in m/s^2 of what
        is felt.
        """
        self._doubt = NOISE + DEVIATIONS * error / STANDARD_GRAVITY
        now, at = stamp // BIN, stamp // BIN % BINS
        if now == self._bin + 1:
            # Nothing is seen to have moved since the bin that is the oldest now. In two bins of it a body that slid
            # would have gone farther than unseen with so much more than its friction.
            means = self._means()
            bound = np.minimum(means[:, at], means[:, (at + 1) % BINS])
            excess = 2.0 * self.unseen / (STANDARD_GRAVITY * (2e-9 * BIN) ** 2) + self._doubt
            np.maximum(self._held, bound - excess, out=self._held)
            self._sum[:, at] = self._count[:, at] = 0.0
        elif now != self._bin:
            self._sum[:] = self._count[:] = 0.0
        self._bin = now
        counts = stands & self._told & (self._slid_in + RESTS < now)
        self._sum[:, at] += np.where(counts, needed, 0.0)
        self._count[:, at] += counts

    def slid(self, number: int) -> None:
        """Know that a body is seen to have slid."""
        most = float(self._means()[number].max())
        if most > 0.0:
            self._slid[number] = min(self._slid[number], most + self._doubt)
        self._sum[number] = self._count[number] = 0.0
        self._slid_in[number] = self._bin

    def seen(self, number: int) -> FrictionSeen:
        """What is seen of the friction of a body."""
        return FrictionSeen(float(self._held[number]), float(self._slid[number]))

    def _means(self) -> NDArray[np.float64]:
        means: NDArray[np.float64] = self._sum / np.maximum(self._count, 1.0)
        return means
