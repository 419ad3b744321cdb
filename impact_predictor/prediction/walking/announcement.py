"""The landing that a point of a foot announces: when one is sure enough, and when it is withdrawn."""

from __future__ import annotations

from math import erf, sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..planar import hardly
from ..scene import Scene
from ..types import Vector3
from ..vectors import add, dot
from .cubic import PointFrame
from .descent import LEAST_RATE, DescentEstimator
from .ground import Ground
from .rest import falls
from .trajectory import FootTrajectory

AHEAD: Final = (
    2.0  # a landing is announced when it is no further ahead than so many times as long as the point has come down,
)
LEAST_DESCENT: Final = 0.02  # ... and that for so many s,
SURE: Final = 0.01  # ... once its time has a standard deviation below so many s ...
UNSURE: Final = 2.0  # ... and kept until it has one that is so many times larger

BEYOND: Final = 2.0  # standard deviations by which the ground may lie elsewhere, and a landing is told all the same

# A point that still comes down so many contact tolerances below the expected level has surely met no ground there.
THROUGH: Final = 0.5


class ExpectedLanding:
    """A landing that is announced: `stamp` in ns, and where and how fast the point will be then (m, m/s).

    `deviation` in s is the standard deviation of its time; the foot lands within the horizon with the probability
    `lands`, and then strikes the ground, and does not brake to rest on it, with the probability `strikes`.
    """

    def __init__(
        self, stamp: int, position: Vector3, velocity: Vector3, deviation: float, lands: float, strikes: float
    ) -> None:
        self.stamp, self.position, self.velocity, self.deviation = stamp, position, velocity, deviation
        self.lands, self.strikes = lands, strikes


class LandingAnnouncement:
    """The landing that the trajectory of a point in the air shows, as far as it is announced."""

    def __init__(self, scene: Scene, dead_time: int) -> None:
        """Announce for a point of a scene; `dead_time` in ns."""
        self.due: ExpectedLanding | None = None
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        self.closed = False
        """Whether it was to land by now and is near the ground: it stands, though not yet for the dead time."""
        self._scene, self._dead_time = scene, dead_time
        self._estimator = DescentEstimator()
        self._doubted: int | None = None  # stamp in ns since which no landing shows

    def awaits(self, stamp: int) -> bool:
        """Whether a landing is ahead of a stamp in ns, or so little before it that few frames show it."""
        return self.due is not None and self.due.stamp + self._dead_time // 2 > stamp

    def end(self) -> None:
        """Announce nothing any more: the point stands."""
        self.due = self._doubted = None
        self.closed = False
        self._estimator.rest()

    def learn(self, stamp: int, last: PointFrame, ground: Ground) -> None:
        """Take that the point has landed at a stamp in ns, after its `last` frame in the air."""
        self._count(ground, came=1.0)
        self._estimator.learn(stamp, last.stamp, ground.level_at(last.position), ground.prior)

    def revise(self, trajectory: FootTrajectory, stamp: int, ground: Ground, near: bool) -> ExpectedLanding | None:
        """The landing of a point in the air that is ahead of a stamp in ns.

        It is `near` where its gap is about that of the ground, or less.
        """
        due, filtered = self.due, trajectory.filter
        self.closed = due is not None and due.stamp <= stamp and near and not self._falls_on(trajectory, due, ground)
        if self.closed or filtered is None:
            return None  # What its trajectory shows is the ground already.
        # Near the ground it may be landing already where it breaks off its course: its last announcement stands.
        if due is None or not (near and filtered.broke):
            self._announce(trajectory, stamp, ground)
        due = self.due
        return due if due is not None and due.stamp > stamp else None

    def _announce(self, trajectory: FootTrajectory, stamp: int, ground: Ground) -> None:
        """Announce the landing that the filter shows, if that is sure enough, or withdraw what was announced."""
        filtered, scene, due = trajectory.filter, self._scene, self.due
        assert filtered is not None
        # From a short descent its filter tells little, and not how little.
        descended = (filtered.stamp - trajectory.top) / NANOSECONDS
        if due is None and descended < LEAST_DESCENT:
            return
        level = ground.level_at(trajectory.frames[-1].position if due is None else due.position)
        gap = filtered.rows[0][0]
        if gap < level.height - ground.yields:  # It has met no ground there.
            level = level.below(gap, sqrt(filtered.covariance[0]))
        found = self._estimator.estimate(filtered, level, ground.prior)
        most = SURE * (1.0 if due is None else UNSURE)
        # Where nobody knows the ground, a landing is told all the same, with the deviation that it then has.
        unsure = BEYOND * level.deviation / max(LEAST_RATE, -filtered.rows[0][1])
        if found is not None and due is None and found.time > AHEAD * descended:
            found = None
        if found is None or found.time > scene.horizon or found.deviation**2 > most * most + unsure * unsure:
            if due is not None:
                self._doubted = stamp if self._doubted is None else self._doubted
                if stamp - self._doubted >= self._dead_time:
                    self._count(ground, came=0.0)
                    self.due = self._doubted = None
            return
        self._doubted = None
        position, velocity = filtered.motion(found.time)
        velocity = add(velocity, scene.normal, found.rate - dot(velocity, scene.normal))
        deviation = ground.prior.deviations.told(found.time, found.deviation)
        within = 0.5 * (1.0 + erf((scene.horizon - found.time) / (deviation * sqrt(2.0))))
        self.due = ExpectedLanding(
            stamp=filtered.stamp + round(found.time * NANOSECONDS),
            position=position,
            velocity=velocity,
            deviation=deviation,
            lands=ground.prior.came_true * within,
            strikes=found.strikes,
        )

    def _falls_on(self, trajectory: FootTrajectory, due: ExpectedLanding, ground: Ground) -> bool:
        """Whether the point surely comes down still, through the ground where that was expected."""
        frames = trajectory.last(2)
        stops = ground.level_at(due.position).height - ground.yields - THROUGH * self._scene.tolerance
        if len(frames) < 2 or frames[-1].gap > stops:
            return False
        return falls(frames, 2.0 * hardly(self._scene), ground.noise)

    def _count(self, ground: Ground, came: float) -> None:
        if self.due is not None:
            ground.prior.announced += 1.0
            ground.prior.came += came
