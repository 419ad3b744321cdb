"""The landings of a machine: which points of a foot make one, which feet land together, and their impacts.

What a planner and force sensors say decides none: landings are compared with a schedule, and a force confirms them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from math import hypot, inf
from operator import itemgetter
from typing import Final

from ...stamps import NANOSECONDS
from ..planar import hardly, posture_of
from ..scene import Scene
from ..score import LONGEST, MEASURED, Pending, Track
from ..types import Landing, Sample, Score, Status, Touchdown, Vector3
from ..vectors import mean
from .announcement import ExpectedLanding
from .articulated import LeggedMachine
from .base import NOTHING, BaseMotion, TwistLine, extrapolated
from .cubic import PointFrame
from .forces import FootForces
from .ground import Ground
from .impact import LandingPoint, touchdown_of
from .schedule import LandingSchedule
from .stance import FootPoint
from .trajectory import FootTrajectory

LEAVING: Final = (
    0.2  # a point that stands leaves the ground when it rises with this part of a speed that is hardly one ...
)
RISES: Final = 3.0  # ... and with so many standard deviations of the noise


class FootCollision:
    """What the impact of a landing is computed from, when somebody wants it.

    The base of a `sample` goes on along a `line` for `time` s; points are then at `places` (m, in the world). The `old`
    ones stand, and those that are `landing` are the `new` ones of a foot, with those of other feet that land together
    with it. `lead_time` in s is that of the foot itself.
    """

    def __init__(
        self,
        sample: Sample,
        line: TwistLine | None,
        time: float,
        lead_time: float,
        places: Sequence[Vector3],
        old: tuple[int, ...],
        new: tuple[int, ...],
        landing: dict[int, LandingPoint],
    ) -> None:
        self.sample, self.line, self.time, self.lead_time = sample, line, time, lead_time
        self.places, self.old, self.new, self.landing = places, old, new, landing


def _gap_over_speed(trajectories: Iterable[FootTrajectory]) -> float:
    """When the first of some points would land at the speed of now, in s; inf if none comes down."""
    return min([one.frames[-1].gap / -one.rate for one in trajectories if one.rate < 0.0], default=inf)


class PendingLanding:
    """A landing that was announced or has happened, until it is scored.

    `times` has the stamps in ns at which it was `announced`, its lead times in s then, and the gap over its speed;
    `seen` is what was seen of it, until its impact is computed, `landing` set once one of its points stands, and
    `after` has the samples after it.
    """

    def __init__(self) -> None:
        self.times: deque[tuple[int, float, float]] = deque(maxlen=LONGEST)
        self.announced: FootCollision | None = None
        self.seen: FootCollision | None = None
        self.landing: Landing | None = None
        self.after = Pending(Track(), 0)


class LandingTracker:
    """The landings that the points of a machine's feet announce and make."""

    def __init__(
        self,
        scene: Scene,
        machine: LeggedMachine,
        points: Sequence[FootPoint],
        base: BaseMotion,
        schedule: LandingSchedule,
        forces: FootForces,
        ground: Ground,
    ) -> None:
        assert scene.walking is not None
        self._scene, self._walking, self._machine = scene, scene.walking, machine
        self._points, self._base, self._schedule, self._forces = points, base, schedule, forces
        self._ground, self._slow = ground, LEAVING * hardly(scene)
        self._each = scene.walking.points
        self._feet = [range(first, first + self._each) for first in range(0, len(points), self._each)]
        self._contact_time = round(scene.contact_time * NANOSECONDS)
        self._announced: dict[int, PendingLanding] = {}
        self._landed: deque[PendingLanding] = deque()

    def soonest(self, sample: Sample, dues: list[ExpectedLanding | None]) -> Touchdown | Status | None:
        """The touchdown of the foot that lands next; None where none does.

        Feet that land within the contact time of each other make one impact.
        """
        points, now = self._points, sample.stamp
        for i in [i for i in self._announced if points[i].due is None]:
            del self._announced[i]
        owns = [self._own(foot, dues) for foot in self._feet]
        landings = [(min([due.stamp for due in own.values()]), own) for own in owns if own]
        if not landings:
            return None
        landings.sort(key=itemgetter(0))
        standing = [
            i
            for i, point in enumerate(points)
            if (point.stands or point.closed) and self._holds(point.trajectory.frames[-1])
        ]
        places = [
            points[i].trajectory.frames[-1].position if due is None else due.position for i, due in enumerate(dues)
        ]
        following = None
        while landings:
            begin = landings[0][0]
            group = [one for one in landings if one[0] <= begin + self._contact_time]
            struck = sorted([one for _, own in group for one in own.items()])
            landing = {i: LandingPoint(due.velocity, (due.stamp - begin) / NANOSECONDS) for i, due in struck}
            for stamp, own in group:
                collision = FootCollision(
                    sample=sample,
                    line=self._base.line,
                    time=(begin - now) / NANOSECONDS,
                    lead_time=(stamp - now) / NANOSECONDS,
                    places=places,
                    old=tuple(standing),
                    new=tuple(own),
                    landing=landing,
                )
                known = [one for i in own if (one := self._announced.get(i)) and one.landing is None]
                pending = known[0] if known else PendingLanding()
                pending.times.append((now, collision.lead_time, _gap_over_speed([points[i].trajectory for i in own])))
                pending.announced = collision
                self._announced |= dict.fromkeys(own, pending)
                following = following or collision
            standing = sorted(standing + [i for i, _ in struck])
            landings = landings[len(group) :]
        return None if following is None else self._impact(following)

    def land(self, i: int) -> None:
        """Take that a point has come to stand, alone or as the first of its foot.

        The first contact of a foot is told even where it was not announced.
        """
        point, each, number = self._points[i], self._each, i // self._each
        pending = self._announced.pop(i, None)
        if pending is None or pending.landing is not None:
            if any(self._points[k].stands for k in range(number * each, (number + 1) * each) if k != i):
                return
            pending = PendingLanding()
        stamp, foot, announced = point.since, self._walking.feet[number], pending.announced
        new = announced.new if announced is not None and i in announced.new else (i,)
        made = [((stamp - at) / NANOSECONDS, *answers) for at, *answers in pending.times if at <= stamp]
        part = [("heel", "toe")[j % 2] if each == 2 else str(j % each) for j in new]
        pending.landing = Landing(
            foot=foot,
            stamp=stamp,
            late=self._schedule.landed(foot, stamp),
            confirmed=self._forces.agree(foot, True, self._base.samples[-1].stamp),
            history=tuple([(ahead, lead_time - ahead) for ahead, lead_time, _ in made]),
            gap_over_speed=tuple([(ahead, simple - ahead) for ahead, _, simple in made if simple < inf]),
            point=None if len(new) == each else " ".join(part),
        )
        pending.seen = self._seen(i, new)
        pending.after.stamp = stamp
        self._landed.append(pending)
        self._base.begin(stamp)

    def settle(self) -> Score | None:
        """The score of the next landing that is complete; of its two impacts a sample computes one."""
        if not self._landed:
            return None
        pending = self._landed[0]
        self._measure(pending.after)
        if not pending.after.complete:
            return None
        if pending.seen is not None:
            self._strike(pending)
            return None
        return self._score(self._landed.popleft())

    def finish(self) -> list[Score]:
        """End the record: the scores of the landings that have happened."""
        for pending in self._landed:
            self._measure(pending.after)
            self._strike(pending)
        return [score for pending in self._landed if (score := self._score(pending)) is not None]

    def _impact(self, collision: FootCollision) -> Touchdown | Status:
        return touchdown_of(
            self._scene,
            self._machine,
            base=extrapolated(collision.sample, collision.line, collision.time),
            places=collision.places,
            stood=collision.old,
            new=collision.new,
            landing=collision.landing,
            lead_time=collision.lead_time,
            rates=collision.line[1] if collision.line else NOTHING,
        )

    def _measure(self, after: Pending) -> None:
        """Hand the samples after a landing to it, once there are enough of them."""
        samples = [sample for sample in self._base.samples if sample.stamp > after.stamp][: MEASURED.stop]
        if len(samples) == MEASURED.stop and not after.complete:
            for sample in samples:
                after.add(sample, posture_of(self._scene, (), sample))

    def _strike(self, pending: PendingLanding) -> None:
        seen, pending.seen = pending.seen, None
        impact = None if seen is None else self._impact(seen)
        if seen is not None and pending.landing is not None and isinstance(impact, Touchdown):
            speed = hypot(*mean([seen.landing[i].velocity for i in seen.new]))
            pending.landing = pending.landing._replace(speed=speed, impact=impact)

    def _score(self, pending: PendingLanding) -> Score | None:
        """The score of a landing, as announced last, or else with the velocity that was seen; None without both."""
        landing, announced, after = pending.landing, pending.announced, pending.after
        assert landing is not None
        touchdown = landing.impact if announced is None else self._impact(announced)
        if not isinstance(touchdown, Touchdown):
            return None
        after.track.add(landing.stamp, touchdown, 0.0)
        told = 0 if announced is None else announced.sample.stamp
        score = after.score(self._scene)._replace(landing=landing, sample=told)
        return score._replace(announced=landing.history[0][0]) if landing.history else score

    def _seen(self, i: int, new: tuple[int, ...]) -> FootCollision | None:
        """The landing of the `new` points of a foot, of which `i` has come to stand, as the last frame before shows it.

        No foot that lands together with it has landed then: the base has still the twist of before their impact. None
        where the velocity is not known.
        """
        points, arrival = self._points, self._points[i].arrival
        if arrival is None or arrival.velocity is None:
            return None
        landed = {j: stamp for j, point in enumerate(points) if (stamp := point.lands) is not None}
        near = {j: stamp for j, stamp in landed.items() if abs(stamp - arrival.stamp) <= self._contact_time}
        together = [j for j in near if j // self._each != i // self._each]
        begin, k = min([arrival.stamp, *[near[j] for j in together]]), -arrival.age
        trajectory = points[i].trajectory.frames
        while trajectory[k].stamp >= begin and k > -len(trajectory):
            k -= 1
        frames = [point.trajectory.frames[k] for point in points]
        moves = {j: frame.velocity for j, frame in enumerate(frames) if frame.velocity is not None}
        if not moves:  # no velocities are measured
            known = {j: points[j].due or points[j].arrival for j in together}
            moves = dict.fromkeys(new, arrival.velocity)
            moves |= {j: one.velocity for j, one in known.items() if one is not None and one.velocity is not None}
        delays = {j: max(0, landed.get(j, begin) - begin) / NANOSECONDS for j in (*new, *together)}
        stamp = frames[i].stamp
        others = [j for j in range(len(points)) if j not in new and j not in together]
        return FootCollision(
            sample=self._base.at(stamp),
            line=self._base.line_until(stamp),
            time=0.0,
            lead_time=0.0,
            places=[frame.position for frame in frames],
            old=tuple([j for j in others if points[j].stood(stamp) and self._holds(frames[j])]),
            new=new,
            landing={j: LandingPoint(moves[j], delays[j]) for j in sorted(delays) if j in moves},
        )

    def _holds(self, frame: PointFrame) -> bool:
        """Whether a point that stands does not rise already: then it carries nothing, and no impact meets it."""
        return frame.rate is None or frame.rate <= max(self._slow, RISES * self._ground.noise.rate)

    def _own(self, foot: range, dues: list[ExpectedLanding | None]) -> dict[int, ExpectedLanding]:
        """The points that make the next landing of a foot: the first, and those that close soon after it.

        What closes soon after another point of the foot has landed belongs to the landing of that one.
        """
        own = {i: due for i in foot if (due := dues[i]) is not None}
        if own and self._each > 1:
            landed = [since for i in foot if (since := self._points[i].landed) is not None]
            last = max(landed, default=-self._contact_time) + self._contact_time
            own = {i: due for i, due in own.items() if due.stamp > last}
            last = min([due.stamp for due in own.values()], default=0) + self._contact_time
            own = {i: due for i, due in own.items() if due.stamp <= last}
        return own
