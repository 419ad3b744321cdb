"""Predicted against true touchdowns: what was found, how early, and how right; `matching` tells which belong together.

Touchdowns are those of impacts, or landings of feet. The truth of these is what a plan or a simulation says of every
foot: whether it stands. It is told beside the samples, is never an input of a prediction, and knows neither modes nor
velocities, so that these are not compared.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from math import dist, hypot
from statistics import median
from types import MappingProxyType
from typing import Final, NamedTuple

from ..prediction.planar import hardly
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Vector3
from ..prediction.vectors import add, axes_of, cross, to_world
from ..stamps import NANOSECONDS
from .matching import NEAREST, Announced, Announcement, Announcements, Match, Rows, match, matches_of
from .truth import TrueImpact

LEAD_TIMES: Final = (0.02, 0.05)
"""Seconds before a touchdown at which the predictions are made whose errors of time count; the first are the usual."""

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


class Comparison(NamedTuple):
    """How the predictions of all bodies together compare with what happened, and those of each body."""

    together: Truth
    bodies: dict[str, Truth]
    matches: list[Match]


class FoundImpact(NamedTuple):
    """A true impact with the last prediction before it."""

    impact: TrueImpact
    last: Announcement


class Compared(NamedTuple):
    """What was found of the touchdowns of one body, and, where the truth tells them, of its impacts.

    `errors` are those of the velocities after the impacts; `matches` has all, the false alarms too.
    """

    announced: Sequence[Announced]
    touchdowns: int
    false: int
    unresolved: int = 0
    unresolved_wrong: int = 0
    found: Sequence[FoundImpact] = ()
    errors: Sequence[float] = ()
    matches: Sequence[Match] = ()


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
            body, of_body[body], announcements.rows[body].all, sorted(samples), scenes[body if body in scenes else ""]
        )
        for body, samples in announcements.samples.items()
    } | dict(others)
    return Comparison(
        _truth(compared.values()),
        {body: _truth([one]) for body, one in compared.items()},
        [match for one in compared.values() for match in one.matches],
    )


def _compare(
    body: str,
    impacts: Sequence[TrueImpact],
    announced: Sequence[list[Announcement]],
    recorded: Sequence[int],
    scene: Scene,
) -> Compared:
    happened = sorted((one for one in impacts if one.stamp <= recorded[-1]), key=lambda one: one.stamp)
    matched, alarms = match([impact.stamp for impact in happened], announced, recorded[-1])
    shown = resolved(happened, recorded, hardly(scene))
    found = {k: FoundImpact(happened[k], matched[k][-1]) for k in shown if k in matched}
    errors = {k: velocity_error(one, scene.center_of_mass) for k, one in found.items()}
    hidden = [FoundImpact(happened[k], matched[k][-1]) for k in set(matched) - set(shown)]
    return Compared(
        [Announced(happened[k].stamp, matched[k]) for k in shown if k in matched],
        len(shown),
        len(alarms),
        len(happened) - len(shown),
        sum(not is_right(one) for one in hidden),
        list(found.values()),
        list(errors.values()),
        matches_of(body, "", [(one.stamp, one.mode) for one in happened], matched, alarms, set(shown), errors),
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


def is_right(found: FoundImpact) -> bool:
    """Whether the last prediction before an impact had its mode."""
    return found.last.touchdown is not None and found.last.touchdown.mode is found.impact.mode


def resolved(happened: Sequence[TrueImpact], samples: Sequence[int], slowest: float) -> list[int]:
    """The places of the impacts that a record shows, from the stamps of its samples, in order."""
    shown = []
    for k, impact in enumerate(happened):
        before = bisect_right(samples, happened[k - 1].stamp) if k else 0
        if bisect_right(samples, impact.stamp) - before >= SEEN and impact.approach > slowest:
            shown.append(k)
    return shown


def velocity_error(found: FoundImpact, center: Vector3) -> float:
    """Error of the twist after an impact relative to the twist before it; `center`: mass centre in the body frame.

    Angular velocities count as speeds at half the contacts' distance.
    """
    impact, touchdown = found.impact, found.last.touchdown
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
            told = zip(walking.feet, before, stands, strict=False)
            self.true += [TrueLanding(stamp, body, foot) for foot, stood, now in told if now and not stood]

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

    def compared(self) -> dict[str, Compared]:
        """What was found of the landings of each body of which the truth is told, foot by foot."""
        return {body: self._compare(body, last) for body, last in self._last.items() if body in self._stands}

    def later(self) -> int:
        """How many true landings come after the last sample of their body that was accepted: they are not compared."""
        return sum(one.stamp > self._last.get(one.body, one.stamp) for one in self.true)

    def _compare(self, body: str, end: int) -> Compared:
        announced: list[Announced] = []
        matches: list[Match] = []
        touchdowns = false = 0
        for foot, rows in self._rows[body].items():
            stamps = sorted(one.stamp for one in self.true if (one.body, one.foot) == (body, foot) and one.stamp <= end)
            # A foot comes down softly: it may seem to come down still when the plan says that it stands.
            matched, alarms = match(stamps, rows.all, end, late=NEAREST)
            announced += [Announced(stamps[k], predictions) for k, predictions in sorted(matched.items())]
            touchdowns += len(stamps)
            false += len(alarms)
            matches += matches_of(body, foot, [(one, None) for one in stamps], matched, alarms, range(len(stamps)))
        return Compared(announced, touchdowns, false, matches=matches)

    def _scene(self, body: str) -> Scene:
        return self._scenes[body if body in self._scenes else ""]
