"""Predicted against true touchdowns.

Predictions of one touchdown follow each other: the next sample announces the same contacts again, unless the announced
moment has passed. Such a row of predictions belongs to the true impact, of those after its last sample, that is nearest
to what it announced last, if they are within `NEAREST` of each other; a row without one was a false alarm. What was
announced for a time after the record is not counted.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from math import dist, hypot
from statistics import median
from typing import Final, NamedTuple

from ..prediction.planar import hardly
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Touchdown, Vector3
from ..prediction.vectors import add, axes_of, cross, to_world
from .truth import TrueImpact

NEAREST: Final = 20_000_000
"""ns between an announced touchdown and the true one that it is taken for."""

AHEAD: Final = 20_000_000
"""ns before a touchdown at which the prediction is made whose error of time counts."""

BORDER: Final = 0.02
"""Relative change of friction or geometry within which another mode may be as right as the true one."""

SEEN: Final = 2
"""Samples between two impacts of which the last one shows the second ahead: a body that rocks rises before it falls."""

NANOSECONDS: Final = 1e9


class Truth(NamedTuple):
    """How the predictions compare with what happened.

    `touchdowns` that a record can show, and how many of them were `missed`; `false` alarms; `unresolved` impacts that
    no record shows at its rate: fewer than two samples lie between them and the one before, or they come slower than
    gravity moves a body within the contact time. Of those found: the part whose mode the last prediction had right; the
    median relative error of the velocities after them, all three in the plane; the median error in s of the time that
    was announced 20 ms ahead, or last before that. None where there is none.

    `clear` of those found are far enough from another mode to tell it: so small an error as `BORDER` does not change
    theirs; then the part of them whose mode was right. `unresolved_wrong` of the unresolved impacts were predicted all
    the same, with another mode than they had.
    """

    touchdowns: int
    missed: int
    false: int
    unresolved: int
    mode_accuracy: float | None
    median_velocity_error: float | None
    median_time_error: float | None
    clear: int = 0
    clear_mode_accuracy: float | None = None
    unresolved_wrong: int = 0


class Comparison(NamedTuple):
    """How the predictions of all bodies together compare with what happened, and those of each body."""

    together: Truth
    bodies: dict[str, Truth]


class Announcement(NamedTuple):
    """A prediction: the stamps of its sample and of the touchdown that it announces, in ns."""

    seen: int
    stamp: int
    touchdown: Touchdown


class Found(NamedTuple):
    """A true impact with the last prediction before it, and the last that was made 20 ms before it."""

    impact: TrueImpact
    last: Announcement
    ahead: Announcement | None


class Announcements:
    """The predictions of each body, in rows of one touchdown each.

    A body goes by its name, or where it has none by its frame.
    """

    def __init__(self) -> None:
        self.samples: dict[str, list[int]] = defaultdict(list)
        """Stamps in ns."""
        self.rows: dict[str, list[list[Announcement]]] = defaultdict(list)
        self.names: dict[str, str] = {}
        """The names of bodies by their frames, by which a truth may call them too."""
        self._goes_on: dict[str, bool] = {}

    def add(self, prediction: Prediction, name: str = "") -> None:
        """Take the answer to an accepted sample; what has no lead time announces nothing."""
        sample, touchdown = prediction.sample, prediction.touchdown
        body = name or sample.child_frame_id
        self.names[sample.child_frame_id] = body
        self.samples[body].append(sample.stamp)
        if touchdown is None:
            self._goes_on[body] = False
        elif touchdown.lead_time > 0.0:
            rows = self.rows[body]
            announced = Announcement(sample.stamp, sample.stamp + round(touchdown.lead_time * NANOSECONDS), touchdown)
            if self._goes_on.get(body) and follows(announced, rows[-1][-1]):
                rows[-1].append(announced)
            else:
                rows.append([announced])
            self._goes_on[body] = True


def follows(announced: Announcement, last: Announcement) -> bool:
    """Whether a prediction is of the same touchdown as the one before it."""
    return announced.seen <= last.stamp and not set(announced.touchdown.new).isdisjoint(last.touchdown.new)


class _Compared(NamedTuple):
    """What was found of the impacts of one body."""

    found: list[Found]
    touchdowns: int
    false: int
    unresolved: int
    unresolved_wrong: int
    errors: list[float]


def compare(impacts: Iterable[TrueImpact], announcements: Announcements, scenes: Mapping[str, Scene]) -> Comparison:
    """Compare the predictions of all bodies that have samples with the true impacts.

    `scenes` are those of the bodies by their names, or that of bodies without names by "".
    """
    of_body: dict[str, list[TrueImpact]] = defaultdict(list)
    for impact in impacts:
        of_body[announcements.names.get(impact.body, impact.body)].append(impact)
    compared = {
        body: _compare(of_body[body], announcements.rows[body], sorted(samples), scenes[body if body in scenes else ""])
        for body, samples in announcements.samples.items()
    }
    return Comparison(_truth(compared.values()), {body: _truth([one]) for body, one in compared.items()})


def _compare(
    impacts: Sequence[TrueImpact], announced: Sequence[list[Announcement]], recorded: Sequence[int], scene: Scene
) -> _Compared:
    happened = sorted((one for one in impacts if one.stamp <= recorded[-1]), key=lambda one: one.stamp)
    rows = [row for row in announced if row[-1].stamp <= recorded[-1]]
    matched, alarms = match(happened, rows)
    shown = resolved(happened, recorded, hardly(scene))
    found = [find(happened[k], matched[k]) for k in shown if k in matched]
    hidden = [find(happened[k], matched[k]) for k in set(matched) - set(shown)]
    return _Compared(
        found,
        len(shown),
        alarms,
        len(happened) - len(shown),
        sum(not is_right(one) for one in hidden),
        [velocity_error(one, scene.center_of_mass) for one in found],
    )


def _truth(bodies: Collection[_Compared]) -> Truth:
    found = [one for body in bodies for one in body.found]
    clear = [one for one in found if one.impact.border > BORDER]
    errors = [error for body in bodies for error in body.errors]
    times = [abs(one.ahead.stamp - one.impact.stamp) / NANOSECONDS for one in found if one.ahead]
    touchdowns = sum(body.touchdowns for body in bodies)
    return Truth(
        touchdowns,
        touchdowns - len(found),
        sum(body.false for body in bodies),
        sum(body.unresolved for body in bodies),
        sum(map(is_right, found)) / len(found) if found else None,
        median(errors) if errors else None,
        median(times) if times else None,
        len(clear),
        sum(map(is_right, clear)) / len(clear) if clear else None,
        sum(body.unresolved_wrong for body in bodies),
    )


def is_right(found: Found) -> bool:
    """Whether the last prediction before an impact had its mode."""
    return found.last.touchdown.mode is found.impact.mode


def match(
    happened: Sequence[TrueImpact], rows: Iterable[list[Announcement]]
) -> tuple[dict[int, list[Announcement]], int]:
    """The predictions of each true impact by its place, in order, and the number of false alarms."""
    stamps = [impact.stamp for impact in happened]
    matched: dict[int, list[Announcement]] = defaultdict(list)
    alarms = 0
    for row in rows:
        seen, announced, _ = row[-1]
        first = bisect_left(stamps, seen)
        later = bisect_left(stamps, announced, lo=first)
        near = [k for k in (later - 1, later) if first <= k < len(stamps) and abs(stamps[k] - announced) <= NEAREST]
        if near:
            matched[min(near, key=lambda k: abs(stamps[k] - announced))] += row
        else:
            alarms += 1
    return matched, alarms


def resolved(happened: Sequence[TrueImpact], samples: Sequence[int], slowest: float) -> list[int]:
    """The places of the impacts that a record shows, from the stamps of its samples, in order."""
    shown = []
    for k, impact in enumerate(happened):
        before = bisect_right(samples, happened[k - 1].stamp) if k else 0
        if bisect_right(samples, impact.stamp) - before >= SEEN and impact.approach > slowest:
            shown.append(k)
    return shown


def find(impact: TrueImpact, announced: Sequence[Announcement]) -> Found:
    early = [one for one in announced if one.seen <= impact.stamp - AHEAD]
    return Found(impact, announced[-1], early[-1] if early else None)


def velocity_error(found: Found, center: Vector3) -> float:
    """Error of the twist after an impact relative to the twist before it; `center`: mass centre in the body frame.

    Angular velocities count as speeds at half the contacts' distance.
    """
    impact, touchdown = found.impact, found.last.touchdown
    axes = axes_of(touchdown.orientation)
    linear = to_world(axes, add(touchdown.linear, cross(touchdown.angular, center)))
    angular = to_world(axes, touchdown.angular)
    wrong = hypot(dist(linear, impact.linear_after), dist(angular, impact.angular_after) * impact.half_distance)
    return wrong / hypot(*impact.linear_before, *[part * impact.half_distance for part in impact.angular_before])
