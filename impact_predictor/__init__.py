"""Predict the next touchdown of a body that turns about one contact, and what the impact does to it."""

from typing import TYPE_CHECKING

from .errors import InputError
from .mechanics.bodies import cylinder, plate, rod
from .mechanics.impact import solve_impact
from .mechanics.types import Alternative, Contact, Flag, Mode, Outcome, Twist, TwoPointBody

if TYPE_CHECKING:
    from .mechanics.batch import Outcomes, solve_impacts

__all__ = [
    "Alternative",
    "Contact",
    "Flag",
    "InputError",
    "Mode",
    "Outcome",
    "Outcomes",
    "Twist",
    "TwoPointBody",
    "cylinder",
    "plate",
    "rod",
    "solve_impact",
    "solve_impacts",
]
__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    """`solve_impacts` and `Outcomes`, loaded when they are asked for: they need numpy, one impact does not."""
    if name in ("Outcomes", "solve_impacts"):
        from .mechanics import batch

        return getattr(batch, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
