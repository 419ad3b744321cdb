"""True landings of feet: like impacts, they are never an input."""

from __future__ import annotations

from typing import Final, NamedTuple

from ..prediction.types import Vector3
from ..prediction.vectors import dot

LANDING_TOPIC: Final = "/truth/landings"


class LandingState(NamedTuple):
    """A machine `time` s after a foot has touched the ground, 0 for the last moment before.

    `twist` of the trunk along its axes, linear of its origin in m/s and angular in rad/s; `rates` of the joints in
    rad/s or m/s, in the order of joint_states; of each foot in the order of the scene its velocity in m/s and the
    impulse in N s that the ground has given to it since, in the axes of the world.
    """

    time: float
    twist: tuple[float, ...]
    rates: tuple[float, ...]
    velocities: tuple[Vector3, ...]
    impulses: tuple[Vector3, ...]


class TrueLanding(NamedTuple):
    """A foot that came to the ground and stayed.

    `stamp` in ns of the first contact; `body` its trunk's frame; `foot` its name; `feet` the names of all, and those of
    them that were `standing`; `normal` of the ground under the foot; the `states` of the machine just before and after
    it. The last one is that of the first peak of the normal force on the foot.
    """

    stamp: int
    body: str
    foot: str
    feet: tuple[str, ...]
    standing: tuple[str, ...]
    normal: Vector3
    states: tuple[LandingState, ...]

    @property
    def said(self) -> str:
        """Its foot."""
        return self.foot

    @property
    def before(self) -> LandingState:
        """The machine just before it."""
        return self.states[0]

    @property
    def after(self) -> tuple[LandingState, ...]:
        """The machine after it."""
        return self.states[1:]

    @property
    def speed(self) -> float:
        """How fast the foot came down, in m/s."""
        return -dot(self.before.velocities[self.feet.index(self.foot)], self.normal)

    def impulse(self, state: LandingState) -> float:
        """What the ground has given to the foot until a state, along the normal, in N s."""
        return dot(state.impulses[self.feet.index(self.foot)], self.normal)
