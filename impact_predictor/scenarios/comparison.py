"""Predicted against true touchdowns: what was found, how early, and how right; `matching` tells which belong together.

Touchdowns are those of impacts, or landings of feet. The truth of these is what a plan or a simulation says of every
foot: whether it stands. It comes beside the samples, is never an input of a prediction, and knows neither modes nor
velocities, so that these are not compared.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from math import dist, hypot
from statistics import median
from types import MappingProxyType
from typing import Final, NamedTuple

from ..prediction.planar import hardly
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Vector3
from ..prediction.vectors import add, axes_of, cross, to_world
from .matching import NEAREST, Announcement, Announcements, Match, Rows, match
from .truth import TrueImpact

LEAD_TIMES: Final = (0.02, 0.05)
"""Seconds before a touchdown at which the predictions are made whose errors of time count."""

BORDER: Final = 0.02
"""Relative change of friction or geometry within which another mode may be as right as the true one."""

SEEN: Final = 2
"""Samples between two impacts of which the last one shows the second ahead: a body that rocks rises before it falls."""


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


class Compared(NamedTuple):
    """How the predictions of all bodies together compare with what happened, those of each body, and each touchdown."""

    together: Truth
    bodies: dict[str, Truth]
    matches: list[Match]


def compare(
    impacts: Iterable[TrueImpact],
    announcements: Announcements,
    scenes: Mapping[str, Scene],
    others: Mapping[str, list[Match]] = MappingProxyType({}),
) -> Compared:
    """Compare the predictions of all bodies that have samples with the true impacts.

    `scenes` are those of the bodies by their names, or that of bodies without names by "". `others` are the
    matches of bodies with another truth.
    """
    of_body: dict[str, list[TrueImpact]] = defaultdict(list)
    for impact in impacts:
        of_body[announcements.names.get(impact.body, impact.body)].append(impact)
    matches = {
        body: _matches(
            body, of_body[body], announcements.rows[body].all, sorted(samples), scenes[body if body in scenes else ""]
        )
        for body, samples in announcements.samples.items()
    } | dict(others)
    everything = [one for of_one in matches.values() for one in of_one]
    return Compared(_truth(everything), {body: _truth(of_one) for body, of_one in matches.items()}, everything)


def _matches(
    body: str,
    impacts: Sequence[TrueImpact],
    announced: Sequence[list[Announcement]],
    recorded: Sequence[int],
    scene: Scene,
) -> list[Match]:
    """The impacts of a body until its last sample, and its false alarms."""
    happened = sorted((one for one in impacts if one.stamp <= recorded[-1]), key=lambda one: one.stamp)
    matched, alarms = match([impact.stamp for impact in happened], announced, recorded[-1])
    shown = resolved(happened, recorded, hardly(scene))
    true = [
        Match(
            body=body,
            foot="",
            stamp=impact.stamp,
            mode=impact.mode,
            predictions=matched.get(k, ()),
            shown=k in shown,
            velocity_error=velocity_error(impact, matched[k][-1], scene.center_of_mass)
            if k in shown and k in matched
            else None,
            border=impact.border,
        )
        for k, impact in enumerate(happened)
    ]
    return true + [Match(body, "", None, None, row) for row in alarms]


def _truth(matches: Sequence[Match]) -> Truth:
    shown = [one for one in matches if one.stamp is not None and one.shown]
    hidden = [one for one in matches if one.stamp is not None and not one.shown]
    found = [one for one in shown if one.predictions]
    right = [one.mode_is_right for one in found if one.mode is not None]
    clear = [one.mode_is_right for one in found if one.mode is not None and one.border > BORDER]
    errors = [one.velocity_error for one in matches if one.velocity_error is not None]
    time_errors = {str(lead_time): median_time_error(found, lead_time) for lead_time in LEAD_TIMES}
    return Truth(
        touchdowns=len(shown),
        missed=len(shown) - len(found),
        false=sum(one.stamp is None for one in matches),
        unresolved=len(hidden),
        mode_accuracy=sum(right) / len(right) if right else None,
        median_velocity_error=median(errors) if errors else None,
        median_time_error=time_errors[str(LEAD_TIMES[0])],
        clear=len(clear),
        clear_mode_accuracy=sum(clear) / len(clear) if clear else None,
        unresolved_wrong=sum(bool(one.predictions) and not one.mode_is_right for one in hidden),
        time_error_by_lead_time=time_errors,
        least_lead_time=min((one.first_lead_time for one in found), default=None),
    )


def median_time_error(found: Iterable[Match], lead_time: float) -> float | None:
    """Median error in s of the times that were announced a lead time in s ahead, or last before that."""
    errors = [error for one in found if (error := one.time_error(lead_time)) is not None]
    return median(errors) if errors else None


def resolved(happened: Sequence[TrueImpact], samples: Sequence[int], slowest: float) -> list[int]:
    """The places of the impacts that a record shows, from the stamps of its samples, in order."""
    shown = []
    for k, impact in enumerate(happened):
        before = bisect_right(samples, happened[k - 1].stamp) if k else 0
        if bisect_right(samples, impact.stamp) - before >= SEEN and impact.approach > slowest:
            shown.append(k)
    return shown


def velocity_error(impact: TrueImpact, last: Announcement, center: Vector3) -> float:
    """Error of the twist after an impact, as announced last, relative to the twist before it; `center`: mass centre in
    the body frame.

    Angular velocities count as speeds at half the contacts' distance.
    """
    touchdown = last.touchdown
    assert touchdown is not None
    axes = axes_of(touchdown.orientation)
    linear = to_world(axes, add(touchdown.linear, cross(touchdown.angular, center)))
    angular = to_world(axes, touchdown.angular)
    wrong = hypot(dist(linear, impact.linear_after), dist(angular, impact.angular_after) * impact.half_distance)
    return wrong / hypot(*impact.linear_before, *[part * impact.half_distance for part in impact.angular_before])


class TrueLanding(NamedTuple):
    """A foot that comes to stand: `stamp` in ns; `body` by its name, or where it has none its frame; `foot` by name."""

    stamp: int
    body: str
    foot: str


class Landings:
    """The true landings of feet and those that are announced, of the bodies of some scenes by their names.

    A body goes by its name, or where it has none by its frame.
    """

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        self.true: list[TrueLanding] = []
        self._scenes = scenes
        self._stands: dict[str, tuple[bool, ...]] = {}
        self._rows: dict[str, dict[str, Rows]] = defaultdict(lambda: defaultdict(Rows))
        self._last: dict[str, int] = {}

    def tell(self, body: str, stamp: int, stands: tuple[bool, ...]) -> None:
        """Take which feet of a body truly stand at a stamp in ns, in the order of the scene.

        Feet that stand from the beginning have not landed.
        """
        walking = self._scene(body).walking
        before = self._stands.get(body, stands)
        self._stands[body] = stands
        if walking is not None:
            changes = zip(walking.feet, before, stands, strict=False)
            self.true += [TrueLanding(stamp, body, foot) for foot, stood, now in changes if now and not stood]

    def add(self, prediction: Prediction, name: str = "") -> None:
        """Take the answer to an accepted sample: a foot that stands lands no more, though more of it may touch down."""
        sample = prediction.sample
        body = name or sample.child_frame_id
        walking = self._scene(body).walking
        if walking is None:
            return
        soonest = prediction.touchdown
        first = None if soonest is None else walking.feet[soonest.new[0] // walking.points]
        for foot in prediction.feet:
            lead_time = None if foot.stands else foot.lead_time
            self._rows[body][foot.name].add(sample.stamp, lead_time, soonest if foot.name == first else None)
        self._last[body] = sample.stamp

    def matches(self) -> dict[str, list[Match]]:
        """The landings of each body whose truth is known, foot by foot, and its false alarms."""
        return {body: self._matches(body, last) for body, last in self._last.items() if body in self._stands}

    def later(self) -> int:
        """How many true landings come after the last sample of their body that was accepted: they are not compared."""
        return sum(one.stamp > self._last.get(one.body, one.stamp) for one in self.true)

    def _matches(self, body: str, end: int) -> list[Match]:
        found: list[Match] = []
        for foot, rows in self._rows[body].items():
            stamps = sorted(one.stamp for one in self.true if (one.body, one.foot) == (body, foot) and one.stamp <= end)
            # A foot comes down softly: it may seem to come down still when the plan says that it stands.
            matched, alarms = match(stamps, rows.all, end, late=NEAREST)
            found += [Match(body, foot, stamp, None, matched.get(k, ())) for k, stamp in enumerate(stamps)]
            found += [Match(body, foot, None, None, row) for row in alarms]
        return found

    def _scene(self, body: str) -> Scene:
        return self._scenes[body if body in self._scenes else ""]
