"""What is told of a foot, and the impulse that it gets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from .types import Bound, Touchdown, Vector3


# A named tuple takes seven times as long to make, and of a machine that walks there is one a foot in each sample.
class Foot:
    """A foot as one sample shows it.

    `stands` is inferred from gaps and velocities, `since` that stamp in ns (0 where it was so from the beginning);
    `gap` (m) of its lowest point and how fast that approaches the ground (m/s); `lead_time` in s until it lands and
    `landing_speed` in m/s then, None where no landing lies within the horizon; `late` in s after the planned landing,
    negative before it, None without a plan; `confirmed` whether a force sensor agrees, None without one. `position` of
    its lowest point, and the `place` where it lands, in m, in the frame of the sample. `impulse` in N s is what it gets
    in the impact of the touchdown ahead, and `bound` what that is; None where it takes no part.

    Of a landing that is announced: `landing_deviation`, the standard deviation of its time in s; the probability that
    the foot `lands` within the horizon, and that it then `strikes` the ground and does not brake to rest on it.
    """

    _fields: ClassVar[tuple[str, ...]] = (
        "name",
        "stands",
        "since",
        "gap",
        "approach",
        "lead_time",
        "landing_speed",
        "late",
        "confirmed",
        "position",
        "place",
        "impulse",
        "bound",
        "landing_deviation",
        "lands",
        "strikes",
    )

    def __init__(
        self,
        name: str,
        stands: bool,
        since: int,
        gap: float,
        approach: float,
        lead_time: float | None = None,
        landing_speed: float | None = None,
        late: float | None = None,
        confirmed: bool | None = None,
        position: Vector3 | None = None,
        place: Vector3 | None = None,
        impulse: Vector3 | None = None,
        bound: Bound | None = None,
        landing_deviation: float | None = None,
        lands: float | None = None,
        strikes: float | None = None,
    ) -> None:
        self.name, self.stands, self.since, self.gap, self.approach = name, stands, since, gap, approach
        self.lead_time, self.landing_speed, self.late, self.confirmed = lead_time, landing_speed, late, confirmed
        self.position, self.place, self.impulse, self.bound = position, place, impulse, bound
        self.landing_deviation, self.lands, self.strikes = landing_deviation, lands, strikes

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Foot) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def __repr__(self) -> str:
        return f"Foot({', '.join([f'{name}={value!r}' for name, value in self._asdict().items()])})"

    def __reduce__(self) -> tuple[type[Foot], tuple[object, ...]]:
        return Foot, self._values()

    def _asdict(self) -> dict[str, object]:
        return dict(zip(self._fields, self._values(), strict=True))

    def _replace(self, **changes: Any) -> Foot:
        return Foot(**{**self._asdict(), **changes})

    def _values(self) -> tuple[object, ...]:
        return tuple([getattr(self, name) for name in self._fields])


def impulse_at(touchdown: Touchdown, points: Sequence[int]) -> Vector3 | None:
    """The impulse in N s on some points together, None where none of them takes part in a touchdown."""
    x = y = z = 0.0
    takes_part = False
    for contact in touchdown.contacts:
        if contact.point in points:
            (u, v, w), takes_part = contact.impulse, True
            x, y, z = x + u, y + v, z + w
    return (x, y, z) if takes_part else None
