"""One stretch of a body's stance, and the event that ends it."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple


class End(IntEnum):
    """How a stretch of stance ends."""

    TOUCHES = 0
    """Another point reaches the support."""
    TURNS = 1
    """The angular velocity is zero and changes its sign."""
    LIFTS = 2
    """The support would have to pull: the body leaves it (so it does where it might as well press on, Painleve)."""
    STOPS = 3
    """The slip is zero."""
    SLIPS = 4
    """A stance that stuck begins to slip."""
    JAMS = 5
    """No finite reaction keeps the slipping contact on the support (Painleve)."""
    NEVER = 6
    """No touchdown follows, or none within the horizon."""


class Stretch(NamedTuple):
    """One stretch of stance and how it ends.

    `time` it lasts in s; `turned` meanwhile in rad, CCW positive; `omega` in rad/s and `slip`, the velocity of the
    stance contact in m/s, at its end; `moved`, how far the contact slipped, in m; `direction` +1 or -1, of the slip
    that begins (SLIPS) or of the turning (TOUCHES).
    """

    end: End
    time: float
    turned: float
    omega: float
    slip: float = 0.0
    moved: float = 0.0
    direction: int = 0
