"""The trajectory of a body that rocks: its impacts, accumulations, phases and end, and its state at any time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from ..types import Outcome, TwoPointBody
from .events import End
from .phases import MotionPhase
from .support import PlanarState, Support, in_world

_STATES = "OS+-"
"""Letters of the contact states: open, sticks, slips along +t and along -t."""


class RockingImpact(NamedTuple):
    """An impact at `time` (s) of contact `new` of a body that stood on contact `old`, or on none.

    States are in the support's frame; `outcome` is that of `solve_impact`.
    """

    time: float
    old: int | None
    new: int
    before: PlanarState
    after: PlanarState
    outcome: Outcome


class Accumulation(NamedTuple):
    """Infinitely many impacts that end at `time` (s), known to `error` s.

    `contacts` are closed from then on, in `states` (as those of `Phase`); `impacts` of them, from the first on, were
    followed one by one, the rest is summed.
    """

    time: float
    error: float
    contacts: tuple[int, ...]
    states: str
    impacts: int

    @property
    def slides(self) -> bool:
        """Whether the body slides on its contacts then."""
        return "+" in self.states or "-" in self.states


class Phase(NamedTuple):
    """A phase between two events (s); `states` of contacts 0 and 1: O open, S sticks, + or - slips along +t or -t.

    "OO" is flight, "SO" turning about contact 0, "SS" rest, "++" sliding on both.
    """

    start: float
    end: float
    states: str


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A rocking motion in the support's frame, until `time` (s).

    `jams` are times (s) at which slip that no finite reaction can go with ended at once (Painleve). `motions` are the
    phases with their dense output; their angles count from the pose with both contacts closed, less `shift` rad.
    """

    body: TwoPointBody
    support: Support
    law: str
    start: PlanarState
    time: float
    end: End
    impacts: tuple[RockingImpact, ...] = ()
    accumulations: tuple[Accumulation, ...] = ()
    jams: tuple[float, ...] = ()
    motions: tuple[MotionPhase, ...] = ()
    shift: float = 0.0

    @property
    def phases(self) -> tuple[Phase, ...]:
        """The phases between events."""
        return tuple(Phase(one.start, one.end, letters(one.states)) for one in self.motions)

    def states(self, time: float) -> str:
        """Contact states at a time, as those of `Phase`."""
        if not self.motions:
            return "OO"
        return letters(next((one for one in reversed(self.motions) if one.start <= time), self.motions[0]).states)

    def state(self, time: Any) -> PlanarState:
        """State in the support's frame at a time in s (numbers) or at an array of times (arrays).

        At an impact it is the state after it; before the start and after the end it is the state there.
        """
        import numpy as np

        times = np.asarray(time, dtype=float)
        flat = times.ravel()
        values = np.repeat(np.array(self.start)[:, None], flat.size, axis=1)
        order = np.argsort(flat, kind="stable")
        borders = np.searchsorted(flat[order], [phase.start for phase in self.motions[1:]])
        for phase, chosen in zip(self.motions, np.split(order, borders), strict=False):
            if chosen.size:
                values[:, chosen] = phase.at(np.clip(flat[chosen], phase.start, phase.end))
                values[2, chosen] += self.shift
        return PlanarState(*(values.reshape(6, *times.shape) if times.ndim else values[:, 0].tolist()))

    def world(self, time: Any) -> PlanarState:
        """As `state`, in the world's axes."""
        return in_world(self.support.motion(time), self.state(time))


def letters(states: tuple[int, int]) -> str:
    """The letters of the states of contacts 0 and 1, as those of `Phase`."""
    return _STATES[states[0]] + _STATES[states[1]]
