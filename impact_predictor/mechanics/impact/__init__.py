"""One impact on two contacts: the engine in contact space, and its doors for a planar body and for many of them."""

from .answer import VALIDITY
from .contacts import approach, see
from .solve import LAWS, MODES, NOWHERE, flags_of, number_of, solve_impact, states_of

__all__ = [
    "LAWS",
    "MODES",
    "NOWHERE",
    "VALIDITY",
    "approach",
    "flags_of",
    "number_of",
    "see",
    "solve_impact",
    "states_of",
]
