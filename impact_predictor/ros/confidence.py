"""How sure a predicted impact is, as keys and values of `~/prediction`."""

from __future__ import annotations

from typing import Final

from ..mechanics.types import Mode
from ..prediction.types import Touchdown

UNCERTAINTY_KEYS: Final = (
    "covariance",
    *(f"probability.{mode.name}" for mode in sorted(Mode)),
    *("mean.vx", "mean.vy", "mean.omega", "deviation.vx", "deviation.vy", "deviation.omega"),
)

MARGIN_KEYS: Final = tuple(
    f"margin.{name}{part}" for name in ("friction", "center", "height", "reach", "slip") for part in ("", ".mode")
)


def uncertainty_values(touchdown: Touchdown) -> list[str]:
    """The values of UNCERTAINTY_KEYS, none where the scene does not ask for them."""
    uncertainty = touchdown.uncertainty
    if uncertainty is None:
        return []
    numbers = (*uncertainty.probabilities, *uncertainty.mean, *uncertainty.deviation)
    return [uncertainty.given.name, *map(repr, numbers)]


def margin_values(touchdown: Touchdown) -> list[str]:
    """The values of MARGIN_KEYS, none where the scene does not ask for them: a mode is NONE where none was found."""
    if touchdown.planar is None:
        return []
    values = []
    for change, mode in touchdown.planar.margins:
        values += [repr(change), "NONE" if mode is None else mode.name]
    return values
