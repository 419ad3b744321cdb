"""The landings of a machine: which points of a foot make one, which feet land together, and their impacts.

What a planner and force sensors say decides none: landings are compared with a schedule, and a force confirms them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from itertools import pairwise
from math import hypot
from operator import itemgetter
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..checks import LARGEST, PAUSE, order_of
from ..scene import Scene, Walking
from ..score import LONGEST, Pending
from ..types import Landing, Sample, Schedule, Score, Status, Touchdown, Vector3, Wrench
from ..vectors import add, axes_of, dot, mean, to_body
from .impact import touchdown_of
from .mechanism import BaseMotion, LeggedMachine, TwistLine, extrapolated
from .stance import ExpectedLanding, FootPoint

PLANNED = 10_000_000_000
"""ns for which what was planned is remembered."""

FURTHEST = 1_000_000_000
"""ns from a planned landing beyond which a landing is another one, which nobody planned."""


class FootCollision(NamedTuple):
    """What the impact of a landing is computed from, when somebody wants it.

    The base of a `sample` goes on along a `line` for `time` s; points are then at `places` (m, in the world), the `new`
    ones of a foot with a mean `velocity` (m/s), those of other feet that land `together` with theirs, and the `old`
    ones stand. `lead_time` in s is that of the foot itself.
    """

    sample: Sample
    line: TwistLine | None
    time: float
    lead_time: float
    places: Sequence[Vector3]
    old: tuple[int, ...]
    new: tuple[int, ...]
    velocity: Vector3
    together: dict[int, Vector3]


class AnnouncedLanding:
    """What was announced of one landing: when and how long ahead, and the last of it."""

    def __init__(self, last: FootCollision) -> None:
        self.times: deque[tuple[int, float]] = deque(maxlen=LONGEST)
        """Stamps in ns and lead times in s."""
        self.last = last
        self.settled = False
        """Whether one of its points has come to stand."""


class PendingLanding(NamedTuple):
    """A landing that is not settled yet: the samples after it, what was announced of it last, and what was seen."""

    pending: Pending
    landing: Landing
    announced: FootCollision | None
    seen: FootCollision | None


class LandingTracker:
    """The landings that the points of a machine's feet announce."""

    def __init__(
        self, scene: Scene, machine: LeggedMachine, points: Sequence[FootPoint], each: int, base: BaseMotion
    ) -> None:
        """Follow the points of the feet of a machine, `each` of which has so many."""
        self._scene = scene
        self._machine = machine
        self._points = points
        self._base = base
        self._each = each
        self._contact_time = round(scene.contact_time * NANOSECONDS)
        self._announced: dict[int, AnnouncedLanding] = {}

    def settle(self, i: int) -> AnnouncedLanding | None:
        """End the landing of a point, which has come to stand: what was announced of it.

        None where nothing was, or where it belongs to a landing that its foot has made already.
        """
        announcement = self._announced.pop(i, None)
        if announcement is None or announcement.settled:
            return None
        announcement.settled = True
        return announcement

    def impact(self, collision: FootCollision) -> Touchdown | Status:
        """The touchdown that a landing makes, with its impact."""
        base = extrapolated(collision.sample, collision.line, collision.time)
        axes, position = axes_of(base.orientation), base.position
        return touchdown_of(
            self._scene,
            self._machine,
            base,
            points=tuple([to_body(axes, add(place, position, -1.0)) for place in collision.places]),
            old=collision.old,
            new=collision.new,
            lead_time=collision.lead_time,
            velocity=collision.velocity,
            together=collision.together,
        )

    def struck(self, landed: PendingLanding) -> PendingLanding:
        """A landing with the impact that was seen, where one was."""
        pending, landing, announced, seen = landed
        impact = None if seen is None else self.impact(seen)
        if seen is not None and isinstance(impact, Touchdown):
            landing = landing._replace(speed=hypot(*seen.velocity), impact=impact)
        return PendingLanding(pending, landing, announced, None)

    def score(self, landed: PendingLanding) -> Score | None:
        """The score of a landing, as announced last, or else with the velocity that was seen; None without both."""
        pending, landing, announced, _ = landed if landed.seen is None else self.struck(landed)
        touchdown = landing.impact if announced is None else self.impact(announced)
        if not isinstance(touchdown, Touchdown):
            return None
        pending.track.add(landing.stamp, touchdown, 0.0)
        return (pending.score(self._scene) if pending.complete else pending.unmeasured())._replace(landing=landing)

    def soonest(self, sample: Sample, dues: list[ExpectedLanding | None]) -> Touchdown | Status | None:
        """The touchdown of the foot that lands next; None where none does.

        Feet that land within the contact time of each other strike together. Each is the old contact of the other.
        """
        points, now = self._points, sample.stamp
        feet = [range(first, first + self._each) for first in range(0, len(points), self._each)]
        landings = [(min([due.stamp for due in own.values()]), own) for foot in feet if (own := self._own(foot, dues))]
        for i in [i for i in self._announced if points[i].due is None]:
            del self._announced[i]
        if not landings:
            return None
        landings.sort(key=itemgetter(0))
        standing = [i for i, point in enumerate(points) if point.stands or point.closed]
        places = [
            point.trajectory.frames[-1].position if due is None else due.position
            for point, due in zip(points, dues, strict=True)
        ]
        next_one = None
        while landings:
            begin = landings[0][0]
            group = [one for one in landings if one[0] <= begin + self._contact_time]
            struck = sorted([(i, due.velocity) for _, own in group for i, due in own.items()])
            for stamp, own in group:
                collision = FootCollision(
                    sample=sample,
                    line=self._base.line,
                    time=(begin - now) / NANOSECONDS,
                    lead_time=(stamp - now) / NANOSECONDS,
                    places=places,
                    old=tuple(standing),
                    new=tuple(own),
                    velocity=mean([due.velocity for due in own.values()]),
                    together={i: velocity for i, velocity in struck if i not in own},
                )
                self._announce(collision)
                next_one = next_one or collision
            standing = sorted(standing + [i for i, _ in struck])
            landings = landings[len(group) :]
        return None if next_one is None else self.impact(next_one)

    def seen(self, i: int, new: tuple[int, ...]) -> FootCollision | None:
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
        stamp = frames[i].stamp
        others = [j for j in range(len(points)) if j not in new and j not in together]
        return FootCollision(
            sample=self._base.at(stamp),
            line=None,
            time=0.0,
            lead_time=0.0,
            places=[frame.position for frame in frames],
            old=tuple([j for j in others if points[j].stood(stamp)]),
            new=new,
            velocity=mean([moves[j] for j in new]),
            together={j: moves[j] for j in together if j in moves},
        )

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

    def _announce(self, collision: FootCollision) -> None:
        """Remember what is announced of a landing."""
        known = [one for i in collision.new if (one := self._announced.get(i)) and not one.settled]
        announcement = known[0] if known else AnnouncedLanding(collision)
        announcement.times.append((collision.sample.stamp, collision.lead_time))
        announcement.last = collision
        for i in collision.new:
            self._announced[i] = announcement


class LandingSchedule:
    """The planned landings of some feet; a schedule replaces what was planned from its first time on."""

    def __init__(self, feet: Sequence[str]) -> None:
        self._stances: dict[str, list[tuple[int, bool]]] = {foot: [] for foot in feet}
        self._landings: dict[str, list[int]] = {foot: [] for foot in feet}

    def set(self, schedule: Schedule) -> Status:
        """Take a schedule; what became of it."""
        times = schedule.times
        if not set(schedule.feet) <= set(self._stances):
            return Status.FEET_CHANGED
        if any(b <= a for a, b in pairwise(times)) or len(schedule.stands) != len(times):
            return Status.MALFORMED
        if any(len(stands) != len(schedule.feet) for stands in schedule.stands):
            return Status.MALFORMED
        if not times:
            return Status.ACCEPTED
        for number, foot in enumerate(schedule.feet):
            kept = [one for one in self._stances[foot] if times[0] - PLANNED < one[0] < times[0]]
            following = [(time, stands[number]) for time, stands in zip(times, schedule.stands, strict=True)]
            # Planners tell the same stance again and again: only its changes are kept.
            told = [*kept, *following]
            planned = told[:1] + [one for before, one in pairwise(told) if one[1] is not before[1]]
            self._stances[foot] = planned
            self._landings[foot] = [time for (_, before), (time, now) in pairwise(planned) if now and not before]
        return Status.ACCEPTED

    def late(self, foot: str, stamp: int) -> float | None:
        """How much later than planned, in s, a foot lands at a stamp in ns; None where none is planned near it."""
        late = min([stamp - planned for planned in self._landings[foot]], key=abs, default=None)
        return None if late is None or abs(late) > FURTHEST else late / NANOSECONDS


class FootForces:
    """The last force on each foot of a machine."""

    def __init__(self, walking: Walking) -> None:
        self._feet = walking.feet
        self._least = walking.force**2
        self._timeout = round(walking.timeout * NANOSECONDS)
        self._pressed: dict[str, tuple[int, bool]] = {}

    def set(self, wrench: Wrench) -> Status:
        """Take the force on a foot; what became of the message."""
        foot, square = wrench.frame_id, dot(wrench.force, wrench.force)
        if foot not in self._feet:
            return Status.WRONG_FRAME
        if not square < LARGEST:
            return Status.NOT_FINITE
        last = self._pressed[foot][0] if foot in self._pressed else None
        status = order_of(wrench.stamp, last)
        if status is Status.ACCEPTED:
            self._pressed[foot] = wrench.stamp, square >= self._least
        elif last is not None and last - wrench.stamp > PAUSE:
            del self._pressed[foot]
        return status

    def agree(self, foot: str, stands: bool, stamp: int) -> bool | None:
        """Whether the sensor of a foot shows the same stance near a stamp in ns; None where it shows nothing then."""
        pressed = self._pressed.get(foot)
        if pressed is None or abs(stamp - pressed[0]) > self._timeout:
            return None
        return pressed[1] is stands


def part_of(new: tuple[int, ...], each: int) -> str | None:
    """What the part of a foot with so many points is called that lands; None for all of it."""
    if len(new) == each:
        return None
    return " ".join([("heel", "toe")[i % 2] if each == 2 else str(i % each) for i in new])
