"""What speaks against the ground of a scene, as feet that stand, or never do, show it: `GroundDoubts`."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..scatter import AVERAGED, DifferenceNoise
from ..scene import Scene
from .cubic import PointFrame
from .ground import Ground

LONGEST = NANOSECONDS  # ns for which none may stand: runners fly for a part of that
NEAR: Final = 4.0  # contact tolerances by which the ground that feet show may lie off the scene's
SURE: Final = 3.0  # standard deviations of a gap that the contact tolerance must be ...
ROOM: Final = 4.0  # ... and that it had better be
LARGEST_BALL: Final = 0.1  # m: no foot is a larger one
SHOWN: Final = 20  # footholds from which on a map that tells nothing under them is worth a word


class GroundDoubts:
    """How near the feet of a machine came to its ground, whether any stood, and how their gaps scatter."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._nearest = inf
        self._lifted: int | None = None  # stamp in ns since when none has stood
        self._longest = 0
        self._drift = 0.0
        self._footholds = self._unmapped = 0
        self._noise = DifferenceNoise()

    def begin(self, ground: Ground | None) -> None:
        """Know that the feet are learnt anew, and what was known of the ground until then."""
        self._lifted = None
        self._noise.clear()
        if ground is not None:
            self._footholds, self._unmapped = self._footholds + ground.footholds, self._unmapped + ground.unmapped

    def see(self, frames: Sequence[PointFrame], stands: bool, ground: Ground) -> None:
        """Take the points at one instant, and whether any of them stands."""
        stamp = frames[0].stamp
        if stands:
            self._lifted, self._drift = None, ground.drift
        else:
            self._lifted = stamp if self._lifted is None else self._lifted
            self._longest = max(self._longest, stamp - self._lifted)
            self._nearest = min([self._nearest, *[abs(frame.gap) for frame in frames]])
        self._noise.add(stamp, (frames[0].gap,))

    def texts(self, ground: Ground) -> list[str]:
        """What is doubtful, one sentence each, with the parameter to change."""
        scene, found = self._scene, list[str]()
        assert scene.walking is not None
        off, noise = self._drift, sqrt(self._noise.square)
        is_noisy = self._noise.seen == AVERAGED and SURE * noise > scene.tolerance
        if self._longest > LONGEST and self._nearest > scene.tolerance:
            found.append(f"no foot came nearer to the ground than {self._nearest:.3g} m: {self._raise(self._nearest)}")
        elif self._longest > LONGEST and not is_noisy:
            dead_time = scene.walking.dead_time
            found.append(
                f"no foot stood for {self._longest / NANOSECONDS:.1f} s: if they walked, they rested for less than "
                f"feet.dead_time, so set that below {dead_time:g}, or they never rested, so compare the units of their "
                "points (m)"
            )
        elif abs(off) > NEAR * scene.tolerance:
            found.append(
                f"feet stand {abs(off):.3g} m {'above' if off > 0.0 else 'below'} the ground: {self._raise(off)}"
            )
        if is_noisy:
            found.append(
                f"the gaps of feet scatter by {noise:.2g} m, too much for a contact.tolerance of {scene.tolerance:g}: "
                f"set that to {ROOM * noise:.2g}"
            )
        footholds, unmapped = self._footholds + ground.footholds, self._unmapped + ground.unmapped
        if footholds >= SHOWN and 2 * unmapped > footholds:
            found.append(
                f"the terrain told no height under {unmapped} of {footholds} footholds, so that levels are those that "
                "feet have shown: look at its extent, and compare feet.terrain with the size of its cells"
            )
        return found

    def _raise(self, off: float) -> str:
        """What to do about feet that are off the ground by so many m."""
        height = f"set support.height to {self._scene.height + off:.4f}"
        walking = self._scene.walking
        # A model of the robot has its balls.
        is_point = walking is not None and not walking.radius and walking.robot is None and 0.0 < off <= LARGEST_BALL
        balls = f", or feet.radius to [{off:.3g}] if the points are the centres of balls" if is_point else ""
        return (
            f"{height}{balls}, or compare the units of the points (m), the frames of body and points, and the order of "
            "quaternions (x, y, z, w)"
        )
