"""Predicted against true touchdowns.

Predictions of one touchdown follow each other: the next sample announces the same contacts again, unless the announced
moment has passed. Such a row of predictions belongs to the true impact, of those after its last sample, that is nearest
to what it announced last, if they are within `NEAREST` of each other; a row without one was a false alarm. What was
announced for a time after the record is not counted. Touchdowns are those of impacts here, or of the landings of feet.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from math import dist, hypot
from statistics import median
from types import MappingProxyType
from typing import Final, NamedTuple

from ..prediction.planar import hardly
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Touchdown, Vector3
from ..prediction.vectors import add, axes_of, cross, to_world
from .truth import TrueImpact

NEAREST: Final = 20_000_000
"""ns between an announced touchdown and the true one that it is taken for."""

LEAD_TIMES: Final = (0.02, 0.05)
"""Seconds before a touchdown at which the predictions are made whose errors of time count; the first are the usual."""

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

    `time_error_by_lead_time` has that error for each of `LEAD_TIMES`, and `least_lead_time` is the shortest time in s
    from the first prediction of one to it.

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
    time_error_by_lead_time: Mapping[str, float | None] = {}
    least_lead_time: float | None = None


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
    """A true impact with the last prediction before it."""

    impact: TrueImpact
    last: Announcement


class Announced(NamedTuple):
    """The stamp of a true touchdown that was found, in ns, and its predictions in order."""

    stamp: int
    predictions: Sequence[Announcement]


class Rows:
    """The predictions of what touches down again and again, in rows of one touchdown each."""

    def __init__(self) -> None:
        self.all: list[list[Announcement]] = []
        self._goes_on = False

    def add(self, seen: int, touchdown: Touchdown | None) -> None:
        """Take what a sample of a stamp in ns announces; what has no lead time announces nothing."""
        if touchdown is None:
            self._goes_on = False
        elif touchdown.lead_time > 0.0:
            announced = Announcement(seen, seen + round(touchdown.lead_time * NANOSECONDS), touchdown)
            if self._goes_on and follows(announced, self.all[-1][-1]):
                self.all[-1].append(announced)
            else:
                self.all.append([announced])
            self._goes_on = True


class Announcements:
    """The predictions of each body.

    A body goes by its name, or where it has none by its frame.
    """

    def __init__(self) -> None:
        self.samples: dict[str, list[int]] = defaultdict(list)
        """Stamps in ns."""
        self.rows: dict[str, Rows] = defaultdict(Rows)
        self.names: dict[str, str] = {}
        """The names of bodies by their frames, by which a truth may call them too."""

    def add(self, prediction: Prediction, name: str = "") -> None:
        """Take the answer to an accepted sample."""
        sample = prediction.sample
        body = name or sample.child_frame_id
        self.names[sample.child_frame_id] = body
        self.samples[body].append(sample.stamp)
        self.rows[body].add(sample.stamp, prediction.touchdown)


def follows(announced: Announcement, last: Announcement) -> bool:
    """Whether a prediction is of the same touchdown as the one before it."""
    return announced.seen <= last.stamp and not set(announced.touchdown.new).isdisjoint(last.touchdown.new)


class Compared(NamedTuple):
    """What was found of the touchdowns of one body, and, where the truth tells them, of its impacts.

    `errors` are those of the velocities after the impacts.
    """

    announced: Sequence[Announced]
    touchdowns: int
    false: int
    unresolved: int = 0
    unresolved_wrong: int = 0
    found: Sequence[Found] = ()
    errors: Sequence[float] = ()


def compare(
    impacts: Iterable[TrueImpact],
    announcements: Announcements,
    scenes: Mapping[str, Scene],
    others: Mapping[str, Compared] = MappingProxyType({}),
) -> Comparison:
    """Compare the predictions of all bodies that have samples with the true impacts.

    `scenes` are those of the bodies by their names, or that of bodies without names by "". `others` are bodies that
    were compared with another truth.
    """
    of_body: dict[str, list[TrueImpact]] = defaultdict(list)
    for impact in impacts:
        of_body[announcements.names.get(impact.body, impact.body)].append(impact)
    compared = {
        body: _compare(
            of_body[body], announcements.rows[body].all, sorted(samples), scenes[body if body in scenes else ""]
        )
        for body, samples in announcements.samples.items()
    } | dict(others)
    return Comparison(_truth(compared.values()), {body: _truth([one]) for body, one in compared.items()})


def _compare(
    impacts: Sequence[TrueImpact], announced: Sequence[list[Announcement]], recorded: Sequence[int], scene: Scene
) -> Compared:
    happened = sorted((one for one in impacts if one.stamp <= recorded[-1]), key=lambda one: one.stamp)
    rows = [row for row in announced if row[-1].stamp <= recorded[-1]]
    matched, alarms = match([impact.stamp for impact in happened], rows)
    shown = resolved(happened, recorded, hardly(scene))
    found = [Found(happened[k], matched[k][-1]) for k in shown if k in matched]
    hidden = [Found(happened[k], matched[k][-1]) for k in set(matched) - set(shown)]
    return Compared(
        [Announced(happened[k].stamp, matched[k]) for k in shown if k in matched],
        len(shown),
        alarms,
        len(happened) - len(shown),
        sum(not is_right(one) for one in hidden),
        found,
        [velocity_error(one, scene.center_of_mass) for one in found],
    )


def _truth(bodies: Collection[Compared]) -> Truth:
    announced = [one for body in bodies for one in body.announced]
    found = [one for body in bodies for one in body.found]
    clear = [one for one in found if one.impact.border > BORDER]
    errors = [error for body in bodies for error in body.errors]
    touchdowns = sum(body.touchdowns for body in bodies)
    time_errors = {str(lead_time): median_time_error(announced, lead_time) for lead_time in LEAD_TIMES}
    return Truth(
        touchdowns,
        touchdowns - len(announced),
        sum(body.false for body in bodies),
        sum(body.unresolved for body in bodies),
        sum(map(is_right, found)) / len(found) if found else None,
        median(errors) if errors else None,
        time_errors[str(LEAD_TIMES[0])],
        len(clear),
        sum(map(is_right, clear)) / len(clear) if clear else None,
        sum(body.unresolved_wrong for body in bodies),
        time_errors,
        min(((one.stamp - one.predictions[0].seen) / NANOSECONDS for one in announced), default=None),
    )


def median_time_error(announced: Iterable[Announced], lead_time: float) -> float | None:
    """Median error in s of the times that were announced a lead time in s ahead, or last before that."""
    errors = []
    for stamp, predictions in announced:
        made = [one for one in predictions if one.seen <= stamp - round(lead_time * NANOSECONDS)]
        errors += [abs(one.stamp - stamp) / NANOSECONDS for one in made[-1:]]
    return median(errors) if errors else None


def is_right(found: Found) -> bool:
    """Whether the last prediction before an impact had its mode."""
    return found.last.touchdown.mode is found.impact.mode


def match(
    stamps: Sequence[int], rows: Iterable[list[Announcement]], late: int = 0
) -> tuple[dict[int, list[Announcement]], int]:
    """The predictions of each true touchdown by its place, from their stamps in order, and the number of false alarms.

    A row may go on for `late` ns after its touchdown.
    """
    matched: dict[int, list[Announcement]] = defaultdict(list)
    alarms = 0
    for row in rows:
        seen, announced, _ = row[-1]
        first = bisect_left(stamps, seen - late)
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
