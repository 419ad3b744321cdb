"""Whether forces confirm that feet stand: `FootForces`. They decide none."""

from __future__ import annotations

from ...stamps import NANOSECONDS
from ..checks import LARGEST, followed
from ..scene import Walking
from ..types import Status, Wrench
from ..vectors import dot


class FootForces:
    """The last force on each foot of a machine."""

    def __init__(self, walking: Walking) -> None:
        self._feet = walking.feet
        self._least = walking.force**2
        self._timeout = round(walking.timeout * NANOSECONDS)
        self._pressed: dict[str, tuple[int, bool]] = {}

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

    def agree(self, foot: str, stands: bool, stamp: int) -> bool | None:
        """Whether the sensor of a foot shows the same stance near a stamp in ns; None where it shows nothing then."""
        pressed = self._pressed.get(foot)
        if pressed is None or abs(stamp - pressed[0]) > self._timeout:
            return None
        return pressed[1] is stands
