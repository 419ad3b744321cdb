"""Levels that rise at once, and fall when their reason has stayed away for long enough."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ...stamps import NANOSECONDS
from ..scene import Watching

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


class Level(IntEnum):
    """As in diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


GRAVITY: Final = (Level.OK, Level.WARN, Level.STALE, Level.ERROR)
"""From the least to the gravest: that something tips is graver than that nothing is known."""

OK, WARN, STALE, ERROR = (GRAVITY.index(level) for level in (Level.OK, Level.WARN, Level.STALE, Level.ERROR))
"""Places in that order."""

_RAISED: Final = np.array([[WARN], [STALE], [ERROR]])
_NEVER: Final = -(2**62)


class Levels:
    """Levels of several bodies, by the thresholds of each, as their places in the order of gravity.

    `places` are the levels; `changed` tells that one is another than when this was last set to false.
    """

    def __init__(self, watchings: Sequence[Watching]) -> None:
        self._warn = np.array([one.warn for one in watchings])
        self._error = np.array([one.error for one in watchings])
        self._hysteresis = np.array([one.hysteresis for one in watchings])
        self._hold = np.array([one.hold * NANOSECONDS for one in watchings])
        count = len(watchings)
        self.places: Numbers = np.zeros(count, dtype=np.int64)
        self.changed = True
        self._justified: Numbers = np.full((len(_RAISED), count), _NEVER)

    def update(self, stamp: int, used: Array, other: Numbers) -> None:
        """Take the parts (n,) of the margins that are used up at a stamp in ns, and the places that `other` reasons
        ask for at least.
        """
        # What is below a threshold but within the hysteresis holds up a level, and does not raise one.
        kept = np.maximum(self._asked(used + self._hysteresis), other)
        places = np.maximum(np.maximum(self._asked(used), other), np.minimum(kept, self.places))
        justified = places >= _RAISED
        self._justified[justified] = stamp
        held = (self.places >= _RAISED) & (stamp - self._justified < self._hold)
        places = np.maximum(places, (held * _RAISED).max(axis=0))
        if (places != self.places).any():
            self.places = places
            self.changed = True

    def quiet(self, number: int, stamp: int) -> bool:
        """Whether nothing justifies the level of a body at the last stamp but that it is held."""
        place = int(self.places[number])
        return place > OK and bool(self._justified[place - 1, number] < stamp)

    def release(self, number: int) -> None:
        """Do not hold that nothing was known of a body: it is known for the first time."""
        if self.places[number] == STALE:
            self.places = self.places.copy()
            self.places[number] = OK
            self._justified[:, number] = _NEVER
            self.changed = True

    def begin_anew(self) -> None:
        """Hold nothing that was before."""
        self._justified[:] = _NEVER

    def _asked(self, used: Array) -> Numbers:
        """The places that used parts ask for."""
        asked: Numbers = np.where(used >= self._error, ERROR, np.where(used >= self._warn, WARN, OK))
        return asked
