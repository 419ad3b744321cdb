"""Predict the next touchdown of a body, and what the impact does to it."""

from typing import TYPE_CHECKING

from . import native as native
from .errors import InputError

if TYPE_CHECKING:
    from .bags.replay import replay
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
    from .mechanics.motion import PlanarState, next_touchdown, rock, standing
    from .mechanics.sensitivity import Sensitivity, sensitivity
    from .mechanics.types import Alternative, Contact, ContactState, Flag, Mode, Outcome, Twist, TwoPointBody, Validity
    from .prediction.predictor import Predictor
    from .prediction.scene import read_scenes
    from .prediction.types import Foot, Geometry, Prediction, Sample, Status

__all__ = [
    "Alternative",
    "Body",
    "Contact",
    "ContactPoints",
    "ContactState",
    "Flag",
    "Foot",
    "Geometry",
    "InputError",
    "Margin",
    "Margins",
    "Mode",
    "Outcome",
    "Outcomes",
    "PlanarState",
    "Prediction",
    "Predictor",
    "Sample",
    "Sensitivity",
    "SpatialOutcome",
    "SpatialOutcomes",
    "Status",
    "Twist",
    "TwoPointBody",
    "Validity",
    "cylinder",
    "next_touchdown",
    "plate",
    "read_scenes",
    "replay",
    "rock",
    "rod",
    "sensitivity",
    "solve_impact",
    "solve_impacts",
    "solve_spatial_impact",
    "solve_spatial_impacts",
    "standing",
]
__version__ = "1.0.0"


LATER = {
    **dict.fromkeys(
        ("Alternative", "Contact", "ContactState", "Flag", "Mode", "Outcome", "Twist", "TwoPointBody", "Validity"),
        "mechanics.types",
    ),
    **dict.fromkeys(
        ("Body", "ContactPoints", "SpatialOutcome", "SpatialOutcomes", "solve_spatial_impact", "solve_spatial_impacts"),
        "mechanics.impact.spatial",
    ),
    **dict.fromkeys(("Margin", "Margins"), "mechanics.margins"),
    **dict.fromkeys(("Outcomes", "solve_impacts"), "mechanics.impact.batch"),
    **dict.fromkeys(("PlanarState", "next_touchdown", "rock", "standing"), "mechanics.motion"),
    **dict.fromkeys(("Foot", "Geometry", "Prediction", "Sample", "Status"), "prediction.types"),
    **dict.fromkeys(("Sensitivity", "sensitivity"), "mechanics.sensitivity"),
    **dict.fromkeys(("cylinder", "plate", "rod"), "mechanics.bodies"),
    "Predictor": "prediction.predictor",
    "read_scenes": "prediction.scene",
    "replay": "bags.replay",
    "solve_impact": "mechanics.impact",
}
"""Names that are loaded when they are asked for, and their modules: every start of pytest loads this package for its
plugin, the node needs none of them, and some need numpy."""

RETIRED = "Transverse", "TransverseOutcome", "solve_transverse_impact"
"""Names that there were, for impacts of bodies that also slip across their plane."""


def __getattr__(name: str) -> object:
    if name in LATER:
        from importlib import import_module

        globals()[name] = found = getattr(import_module(f".{LATER[name]}", __name__), name)
        return found
    if name in RETIRED:
        # Of an AttributeError `from impact_predictor import` would not say the reason.
        raise ImportError(
            f"there is no {__name__}.{name} any more: use solve_spatial_impact, which takes the whole twist of a body",
            name=__name__,
        )
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
