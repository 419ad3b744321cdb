"""Touchdowns in blocks that are independent of each other: motions, or stretches of time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..stamps import NANOSECONDS
from .touchdowns import ScoredTouchdown

Blocks = NDArray[np.int64]
"""The block of each touchdown: (n,), counting from 0."""

APART: Final = 1.0
"""s: touchdowns further apart than this are of different motions, or of different times."""

ENOUGH: Final = 10
"""Blocks below which a record is cut at ever shorter pauses, down to single touchdowns."""


def blocks_of(records: Sequence[Sequence[ScoredTouchdown]]) -> Blocks:
    """The blocks of the touchdowns of some records, one record after the other.

    A block is a stretch of one body's time in one record, between pauses of a second without touchdowns; where that
    gives too few of them, between the longest pauses that there are.
    """
    pauses = [
        np.inf if one.body != other.body else (other.stamp - one.stamp) / NANOSECONDS
        for touchdowns in records
        for one, other in pairwise((*touchdowns, *touchdowns[:1]))
    ]
    # The pause after the last touchdown of a record has no end.
    ends = np.cumsum([len(touchdowns) for touchdowns in records if touchdowns]) - 1
    breaks = np.array(pauses)
    breaks[ends] = np.inf
    longest = np.sort(breaks)[::-1][:ENOUGH]
    return np.concatenate(([0], np.cumsum(breaks[:-1] >= min(APART, longest[-1]))))
