"""The landing that a point of a foot announces: when one is sure enough, and when it is withdrawn."""

from __future__ import annotations

from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..planar import hardly
from ..scene import Scene
from ..types import Vector3
from ..vectors import add, dot
from .cubic import Fit
from .ground import Ground
from .rest import falls
from .trajectory import FootTrajectory

# A landing is announced when it is no further ahead than so many times as long as the point has descended: from less
# the cubic of a foot that need not follow one tells nothing.
AHEAD = 1.5
SOON = 0.5  # ... where noise leaves doubt that it lands at all
LASTS = 0.8  # ... once it has shown in every sample for the dead time

THROUGH = (
    0.5  # contact tolerances below the expected level a point that still comes down has surely met no ground there
)


class ExpectedLanding(NamedTuple):
    """A landing that is announced: `stamp` in ns, and where and how fast the point will be then (m, m/s)."""

    stamp: int
    position: Vector3
    velocity: Vector3


class LandingAnnouncement:
    """The landing that the trajectory of a point in the air shows, as far as it is announced."""

    def __init__(self, scene: Scene, dead_time: int) -> None:
        """Announce for a point of a scene; `dead_time` in ns."""
        self.due: ExpectedLanding | None = None
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        self.closed = False
        """Whether it was to land by now and is near the ground: it stands, though not yet for the dead time."""
        self.fit: Fit | None = None
        """The cubic of the last descent through the air, until it has been learnt from."""
        self._scene, self._dead_time = scene, dead_time
        # Stamps in ns since when the announcement is in doubt, and a landing shows.
        self._doubted: int | None = None
        self._shown: int | None = None

    def awaits(self, stamp: int) -> bool:
        """Whether a landing is surely ahead of a stamp in ns."""
        return self.due is not None and self._doubted is None and self.due.stamp > stamp

    def end(self) -> None:
        """Announce nothing any more: the point stands."""
        self.due = self._doubted = self._shown = None
        self.closed = False

    def revise(self, trajectory: FootTrajectory, stamp: int, ground: Ground, near: bool) -> ExpectedLanding | None:
        """The landing of a point in the air that is ahead of a stamp in ns.

        It is `near` where its gap is about that of the ground, or less.
        """
        due = self.due
        self.closed = due is not None and due.stamp <= stamp and near and not self._falls_on(trajectory, due, ground)
        if self.closed:
            return None  # What its trajectory shows is the ground already.
        fit = trajectory.fit(ground.noise, ground.prior)
        if fit is not None and not near:
            self.fit = fit
        # Near the ground it may be landing already where it breaks off its course: its last announcement stands.
        if due is None or not (near and trajectory.broke):
            self._announce(trajectory, fit, stamp, near, ground)
        due = self.due
        return due if due is not None and due.stamp > stamp else None

    def _announce(self, trajectory: FootTrajectory, fit: Fit | None, stamp: int, near: bool, ground: Ground) -> None:
        """Announce the landing that a fit shows, if that is sure enough, or withdraw what was announced."""
        due, landing = self.due, None
        if fit is not None:
            place = trajectory.frames[-1].position if due is None else due.position
            level = ground.level_at(place)
            if fit.gap[0] < level.height:  # It has met no ground there.
                level = level.below(fit.gap[0], fit.deviation_of(0, 0.0))
            landing = fit.landing(level.height, self._scene.tolerance, self._scene.horizon)
        if fit is None or landing is None:
            self._shown = None
            if self._doubted_for(stamp):
                self.due = self._doubted = None
            return
        self._shown = stamp if self._shown is None else self._shown
        descended, wait = fit.stamp - trajectory.top, landing.time * NANOSECONDS
        sure = landing.sure and (due is not None or wait < AHEAD * descended)
        sure |= landing.precise and wait < SOON * descended
        sure |= stamp - self._shown >= self._dead_time and wait < LASTS * descended
        # So near to the ground a little noise makes the curve of a foot that brakes pass through it at once.
        leaps = near and due is not None and due.stamp - fit.stamp - wait > self._dead_time
        if sure and not (trajectory.broke or leaps):
            self._doubted = None
        elif not self._doubted_for(stamp):
            return
        position, velocity = trajectory.motion(fit, landing.time)
        velocity = add(velocity, self._scene.normal, landing.rate - dot(velocity, self._scene.normal))
        self.due = ExpectedLanding(fit.stamp + round(landing.time * NANOSECONDS), position, velocity)

    def _falls_on(self, trajectory: FootTrajectory, due: ExpectedLanding, ground: Ground) -> bool:
        """Whether the point surely comes down still, through the ground where that was expected."""
        frames = trajectory.last(2)
        if len(frames) < 2 or frames[-1].gap > ground.level_at(due.position).height - THROUGH * self._scene.tolerance:
            return False
        return falls(frames, 2.0 * hardly(self._scene), ground.noise)

    def _doubted_for(self, stamp: int) -> bool:
        """Whether what is announced has not surely shown for the dead time."""
        if self.due is None:
            return False
        if self._doubted is None:
            self._doubted = stamp
        return stamp - self._doubted >= self._dead_time
