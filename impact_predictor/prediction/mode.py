"""The mode of an impact in three dimensions, from what its contacts do: `mode_of`."""

from __future__ import annotations

from collections.abc import Sequence

from ..mechanics.types import ContactState, Mode
from .types import PointOutcome, Vector3
from .vectors import dot, total


def mode_of(old: Sequence[PointOutcome], new: Sequence[PointOutcome], normal: Vector3, least: float) -> Mode:
    """The mode of an impact: a group of contacts lifts when the mean of its gap rates exceeds `least` m/s.

    It slides when a contact that holds slips. Where there is no old contact, it counts as lifted.
    """
    old_lifts, new_lifts = (
        total([dot(normal, contact.velocity) for contact in group]) > least * len(group) for group in (old, new)
    )
    old_lifts |= not old
    if new_lifts:
        return Mode.FLIGHT if old_lifts else Mode.BACK_PIVOT
    slips = any(contact.state is ContactState.SLIPS for contact in (*new, *([] if old_lifts else old)))
    if old_lifts:
        return Mode.PIVOT_SLIDE if slips else Mode.PIVOT
    return Mode.SLIDE if slips else Mode.STOP
