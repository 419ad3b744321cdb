"""The landings ahead of a machine: which points of a foot make one, and the impact of each."""

from __future__ import annotations

from collections.abc import Sequence

from ..scene import Scene
from ..score import NANOSECONDS, Track
from ..types import Sample, Status, Touchdown, Vector3
from ..vectors import add, axes_of, dot, mean, to_body
from .base import Twists
from .impact import touchdown_of
from .mechanism import Mechanism
from .point import Due, Point


class Ahead:
    """The touchdowns that the points of a machine's feet announce, and their impacts."""

    def __init__(self, scene: Scene, mechanism: Mechanism, points: Sequence[Point], twists: Twists) -> None:
        assert scene.walking is not None
        self._scene = scene
        self._mechanism = mechanism
        self._points = points
        self._twists = twists
        self._each = scene.walking.points
        self._contact_time = round(scene.contact_time * NANOSECONDS)
        self._tracks: dict[int, Track] = {}
        self._joined: dict[int, int] = {}

    def settle(self, i: int, stamp: int) -> Track | None:
        """End the landing of a point, which came to stand at a stamp in ns: what was announced of it.

        None where nothing was, or where it belongs to a landing that its foot has made already.
        """
        track = self._tracks.pop(i, None)
        if self._joined.pop(i, None) is not None or track is None:
            return None
        for j in track.last.new:
            if j != i:
                self._joined[j] = stamp + self._contact_time
        return track

    def impact(
        self,
        base: Sample,
        standing: tuple[int, ...],
        new: tuple[int, ...],
        lead_time: float,
        places: Sequence[Vector3],
        velocity: Vector3,
    ) -> Touchdown | Status:
        """The touchdown of the `new` points at some `velocity`, all points being at `places` in the world then."""
        axes = axes_of(base.orientation)
        points = tuple([to_body(axes, add(place, base.position, -1.0)) for place in places])
        return touchdown_of(self._scene, self._mechanism, base, points, standing, new, lead_time, velocity)

    def touchdowns(self, sample: Sample, dues: list[Due | None]) -> tuple[Touchdown, ...] | Status:
        """The touchdowns of the feet, the soonest first; points of one foot that land together make one."""
        each = self._each
        found: list[Touchdown] = []
        for i, point in enumerate(self._points):
            if point.stands or point.due is None:
                self._joined.pop(i, None)
            if point.due is None:
                self._tracks.pop(i, None)
        for first in range(0, len(self._points), each):
            own = [(due, i) for i in range(first, first + each) if (due := dues[i]) and not self._has_joined(i, due)]
            if own and each > 1:
                own = self._without_joining(own, range(first, first + each), sample.stamp)
            if own:
                touchdown = self._touchdown(sample, own)
                if isinstance(touchdown, Status):
                    return touchdown
                found.append(touchdown)
        return tuple(sorted(found, key=lambda one: one.lead_time))

    def _has_joined(self, i: int, due: Due) -> bool:
        """Whether the landing of a point belongs to one that its foot has made already."""
        last = self._joined.get(i)
        if last is None or due.stamp <= last:
            return last is not None
        del self._joined[i]
        return False

    def _without_joining(self, own: list[tuple[Due, int]], foot: range, stamp: int) -> list[tuple[Due, int]]:
        """The landings ahead that do not belong to one that another point of the foot makes at this moment."""
        now = [due.stamp for i in foot if (due := self._points[i].due) is not None and due.stamp <= stamp]
        last = min(now, default=stamp) + self._contact_time
        return [one for one in own if one[0].stamp > last] if now else own

    def _touchdown(self, sample: Sample, own: list[tuple[Due, int]]) -> Touchdown | Status:
        """The touchdown that a foot makes with the first of its points, and with those that close soon after it."""
        stamp = min([due.stamp for due, _ in own])
        last = stamp + self._contact_time
        landing = [(due, i) for due, i in own if due.stamp <= last]
        new = tuple([i for _, i in landing])
        lead_time = (stamp - sample.stamp) / NANOSECONDS
        base = self._twists.ahead(sample, lead_time)
        places = [point.course.frames[-1].position for point in self._points]
        for due, i in landing:
            places[i] = due.position
        standing = tuple([i for i, point in enumerate(self._points) if point.stands])
        velocity = mean([due.velocity for due, _ in landing])
        touchdown = self.impact(base, standing, new, lead_time, places, velocity)
        if isinstance(touchdown, Touchdown):
            track = next((self._tracks[i] for i in new if i in self._tracks), None) or Track()
            track.add(sample.stamp, touchdown, -dot(self._scene.normal, velocity))
            for i in new:
                self._tracks[i] = track
        return touchdown


def point_of(new: tuple[int, ...], each: int) -> str | None:
    """What the part of a foot with so many points is called that lands; None for all of it."""
    if len(new) == each:
        return None
    return " ".join([("heel", "toe")[i % 2] if each == 2 else str(i % each) for i in new])
