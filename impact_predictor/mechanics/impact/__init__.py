"""One impact on two contacts: the engine in contact space, and its doors for a planar body and for many of them."""

from .answer import VALIDITY
from .solve import LAWS, MODES, NOWHERE, flags_of, number_of, solve_impact, states_of

__all__ = ["LAWS", "MODES", "NOWHERE", "VALIDITY", "flags_of", "number_of", "solve_impact", "states_of"]
