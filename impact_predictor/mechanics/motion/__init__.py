"""What happens between impacts, by one engine: stick, slip, both contacts, flight, over fixed and moving supports.

`next_touchdown` follows a body on any points over a fixed support, turning in closed form; `next_strike` a body on two
contacts over any support, both up to the next impact. `rock` goes on through impacts and their accumulations.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .events import End
from .support import PlanarState
from .touchdown import Fall, MotionKind, next_touchdown

if TYPE_CHECKING:
    from .engine import next_strike
    from .run import rock, standing
    from .trajectory import Accumulation, Phase, RockingImpact, Trajectory

__all__ = [
    "Accumulation",
    "End",
    "Fall",
    "MotionKind",
    "Phase",
    "PlanarState",
    "RockingImpact",
    "Trajectory",
    "next_strike",
    "next_touchdown",
    "rock",
    "standing",
]


def __getattr__(name: str) -> Any:
    """What only bodies on two contacts need is loaded when it is first asked for."""
    if name not in __all__:
        raise AttributeError(name)
    module = {"next_strike": "engine", "rock": "run", "standing": "run"}.get(name, "trajectory")
    return getattr(import_module(f".{module}", __name__), name)
