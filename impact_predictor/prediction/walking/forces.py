"""Whether forces confirm that feet stand: `FootForces`. They decide none."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ...stamps import NANOSECONDS
from ..checks import LARGEST, followed
from ..scene import Walking
from ..types import Status, Vector3, Wrench
from ..vectors import dot, total

EVERY: Final = 10_000_000  # ns between efforts that are looked at


class FootForces:
    """The last force on each foot of a machine."""

    def __init__(self, walking: Walking) -> None:
        self._feet = walking.feet
        self._each = walking.points
        self._least = walking.force**2
        self._timeout = round(walking.timeout * NANOSECONDS)
        self._pressed: dict[str, tuple[int, bool]] = {}
        self.are_missing = False
        """Whether efforts were to tell the forces, and did not."""

    def set(self, wrench: Wrench) -> Status:
        foot, square = wrench.frame_id, dot(wrench.force, wrench.force)
        if foot not in self._feet:
            return Status.WRONG_FRAME
        if not square < LARGEST:
            return Status.NOT_FINITE
        status, last = followed(wrench.stamp, self._pressed[foot][0] if foot in self._pressed else None)
        if status is Status.ACCEPTED:
            self._pressed[foot] = wrench.stamp, square >= self._least
        elif last is None:
            self._pressed.pop(foot, None)
        return status

    def is_due(self, stamp: int) -> bool:
        """Whether efforts of a stamp in ns are to be looked at: that costs, and need not be done all the time."""
        last, _ = self._pressed.get(self._feet[0], (stamp - EVERY, False))
        return not 0 <= stamp - last < EVERY

    def press(self, stamp: int, forces: Sequence[Vector3]) -> None:
        """Take the forces (N) on all points of the feet at a stamp in ns."""
        for number, foot in enumerate(self._feet):
            own = zip(*forces[number * self._each : (number + 1) * self._each], strict=True)
            x, y, z = (total(parts) for parts in own)
            self.set(Wrench(stamp, foot, (x, y, z)))

    def agree(self, foot: str, stands: bool, stamp: int) -> bool | None:
        """Whether the sensor of a foot shows the same stance near a stamp in ns; None where it shows nothing then."""
        pressed = self._pressed.get(foot)
        if pressed is None or abs(stamp - pressed[0]) > self._timeout:
            return None
        return pressed[1] == stands
