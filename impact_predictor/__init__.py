"""Predict the next touchdown of a body that turns about one contact, and what the impact does to it."""

from typing import TYPE_CHECKING

from .errors import InputError

if TYPE_CHECKING:
    from .mechanics.bodies import cylinder, plate, rod
    from .mechanics.impact import solve_impact
    from .mechanics.impact.batch import Outcomes, solve_impacts
    from .mechanics.impact.spatial import (
        Body,
        ContactPoints,
        SpatialOutcome,
        SpatialOutcomes,
        solve_spatial_impact,
        solve_spatial_impacts,
    )
    from .mechanics.margins import Margin, Margins
    from .mechanics.sensitivity import Sensitivity, sensitivity
    from .mechanics.transverse import Transverse, TransverseOutcome, solve_transverse_impact
    from .mechanics.types import Alternative, Contact, ContactState, Flag, Mode, Outcome, Twist, TwoPointBody, Validity

__all__ = [
    "Alternative",
    "Body",
    "Contact",
    "ContactPoints",
    "ContactState",
    "Flag",
    "InputError",
    "Margin",
    "Margins",
    "Mode",
    "Outcome",
    "Outcomes",
    "Sensitivity",
    "SpatialOutcome",
    "SpatialOutcomes",
    "Transverse",
    "TransverseOutcome",
    "Twist",
    "TwoPointBody",
    "Validity",
    "cylinder",
    "plate",
    "rod",
    "sensitivity",
    "solve_impact",
    "solve_impacts",
    "solve_spatial_impact",
    "solve_spatial_impacts",
    "solve_transverse_impact",
]
__version__ = "0.1.0"


LATER = {
    **dict.fromkeys(
        ("Alternative", "Contact", "ContactState", "Flag", "Mode", "Outcome", "Twist", "TwoPointBody", "Validity"),
        "types",
    ),
    **dict.fromkeys(("Body", "ContactPoints", "SpatialOutcome", "SpatialOutcomes"), "impact.spatial"),
    "Margin": "margins",
    "Margins": "margins",
    "Outcomes": "impact.batch",
    "Sensitivity": "sensitivity",
    "Transverse": "transverse",
    "TransverseOutcome": "transverse",
    "cylinder": "bodies",
    "plate": "bodies",
    "rod": "bodies",
    "sensitivity": "sensitivity",
    "solve_impact": "impact",
    "solve_impacts": "impact.batch",
    "solve_spatial_impact": "impact.spatial",
    "solve_spatial_impacts": "impact.spatial",
    "solve_transverse_impact": "transverse",
}
"""Names that are loaded when they are asked for, and their modules: every start of pytest loads this package for its
plugin, the node needs none of them, and some need numpy."""


def __getattr__(name: str) -> object:
    if name in LATER:
        from importlib import import_module

        globals()[name] = found = getattr(import_module(f".mechanics.{LATER[name]}", __name__), name)
        return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
