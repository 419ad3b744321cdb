"""Predicted against true touchdowns: what was found, how early, and how right; `matching` tells which belong together.

Touchdowns are those of impacts, or landings of feet. The truth of these is what a plan says of every foot, whether it
stands, or what a simulation says of every landing. It comes beside the samples and is never an input of a prediction;
modes and velocities after landings are not compared.

A body under watch may be warned of before something happens to it. A warning counts only if it stands: a level of WARN
or ERROR from its beginning up to what happens, without a report of another level between them.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from math import dist, hypot, inf
from typing import TYPE_CHECKING, Final, NamedTuple, TypeVar

from ..prediction.planar import hardly
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Vector3
from ..prediction.vectors import add, axes_of, cross, to_world
from ..ros.cdr import ERROR, STALE, WARN
from ..stamps import NANOSECONDS
from .matching import LEAD_TIMES as LEAD_TIMES
from .matching import NEAREST, Announcement, Match, Rows, match, truth_of
from .matching import Truth as Truth
from .truth import TrueImpact, TrueLanding, TrueOnset

if TYPE_CHECKING:
    from ..prediction.watch.watch import Report

SEEN: Final = 2
"""Samples between two impacts of which the last one shows the second ahead: a body that rocks rises before it falls."""

HappenedTo = TypeVar("HappenedTo", TrueImpact, TrueOnset)

APART: Final = 5_000_000_000
"""ns without slide, lift or impact after which the next one is an event of its own: half a roll of a ship, as long as
levels are usually held. A body that rocks strikes many times within it."""


class Warned(NamedTuple):
    """How a body was warned of.

    Stamps in ns of the first report on it with another level than STALE and of the first with WARN or ERROR; from that
    on which it was known at all, of its first slide, its first impact and the first time that it lifted a contact.
    `warned_ahead`: how long before the first event a warning had been standing, in s. None where there was none.

    `events`: slides, lifts and impacts that follow each other by less than `APART` are one; of them `events_warned`
    found a warning standing when they began.
    """

    first_known: int | None = None
    first_warning: int | None = None
    first_slide: int | None = None
    first_impact: int | None = None
    first_lift: int | None = None
    warned_ahead: float | None = None
    events: int = 0
    events_warned: int = 0

    @property
    def first_event(self) -> int | None:
        """The first slide or impact; of a body that only lifted, as one that topples may, that."""
        happened = [stamp for stamp in (self.first_slide, self.first_impact) if stamp is not None]
        return min(happened, default=self.first_lift)

    @property
    def before_first_impact(self) -> bool | None:
        """Whether a warning stood before the first slide or impact; None where there was none."""
        if self.first_slide is None and self.first_impact is None:
            return None
        return self.warned_ahead is not None


class BodyTruth(NamedTuple):
    """How the predictions of a body compare with what happened to it, and whether it was warned of; None where not."""

    truth: Truth | None
    warned: Warned | None


class Compared(NamedTuple):
    """All bodies together (None where no truth is known), each body, and each touchdown and false alarm."""

    together: Truth | None
    bodies: dict[str, BodyTruth]
    matches: list[Match]


class Comparison:
    """What was predicted of the bodies of some scenes, and what truly happened to them.

    A body goes by its name, or where it has none by its frame. `impacts`, `onsets` and `landings` are the true ones;
    where `knows_impacts` is False, a record tells of no impacts, and only bodies are compared whose true stances are
    told, and with `knows_landings` those that have feet.
    """

    def __init__(
        self, scenes: Mapping[str, Scene], *, knows_impacts: bool = True, knows_landings: bool = False
    ) -> None:
        self.impacts: list[TrueImpact] = []
        self.onsets: list[TrueOnset] = []
        self.landings: list[TrueLanding] = []
        self._knows_impacts, self._knows_landings = knows_impacts, knows_landings
        self._scenes = scenes
        # The names of bodies by their frames, by which a truth may call them too.
        self._names: dict[str, str] = {}
        self._samples: dict[str, list[int]] = defaultdict(list)
        # Of the touchdowns of each body, under "", and of the landings of each foot.
        self._rows: dict[str, dict[str, Rows]] = defaultdict(lambda: defaultdict(Rows))
        self._stands: dict[str, tuple[bool, ...]] = {}
        self._landings: dict[tuple[str, str], list[int]] = defaultdict(list)
        self._known: dict[str, int] = {}
        # When each warning began, and when another level ended it.
        self._stood: dict[str, list[tuple[int, float]]] = defaultdict(list)

    def add(self, prediction: Prediction, name: str = "") -> None:
        """Take the answer to an accepted sample: a foot that stands lands no more, though more of it may touch down."""
        stamp, frame, soonest = prediction.sample.stamp, prediction.sample.child_frame_id, prediction.touchdown
        body = self._names[frame] = name or frame
        self._samples[body].append(stamp)
        self._rows[body][""].add(stamp, None if soonest is None else soonest.lead_time, soonest)
        walking = self._scene(body).walking
        if walking is not None:
            first = None if soonest is None else walking.feet[soonest.new[0] // walking.points]
            for foot in prediction.feet:
                lead_time = None if foot.stands else foot.lead_time
                self._rows[body][foot.name].add(stamp, lead_time, soonest if foot.name == first else None)

    def add_stances(self, body: str, stamp: int, stands: tuple[bool, ...]) -> None:
        """Take which feet of a body truly stand at a stamp in ns, in the order of the scene.

        Feet that stand from the beginning have not landed.
        """
        walking = self._scene(body).walking
        if walking is not None:
            before = self._stands.get(body, stands)
            self._stands[body] = stands
            for foot, stood, now in zip(walking.feet, before, stands, strict=False):
                if now and not stood:
                    self._landings[body, foot].append(stamp)

    def add_reports(self, reports: Iterable[Report]) -> None:
        """Take reports of the watch in the order of their stamps."""
        for report in reports:
            if report.level != STALE:
                self._known.setdefault(report.body, report.stamp)
            stood = self._stood[report.body]
            stands = bool(stood) and stood[-1][1] == inf
            if report.level in (WARN, ERROR):
                if not stands:
                    stood.append((report.stamp, inf))
            elif stands:
                stood[-1] = stood[-1][0], report.stamp

    def later_landings(self) -> int:
        """How many true landings come after the last sample of their body that was accepted: they are not compared."""
        last, landings = {body: stamps[-1] for body, stamps in self._samples.items()}, self._all_landings()
        return sum(stamp > last.get(body, stamp) for (body, _), stamps in landings.items() for stamp in stamps)

    def compare(self) -> Compared:
        """Compare the predictions of all bodies that have samples with what truly happened to them."""
        impacts, onsets = self._of_bodies(self.impacts), self._of_bodies(self.onsets)
        matches: dict[str, list[Match]] = {}
        for body in self._samples:
            walks = self._knows_landings and self._scene(body).walking is not None
            if walks or body in self._stands:
                matches[body] = self._matched_landings(body)
            elif self._knows_impacts:
                matches[body] = self._matched_impacts(body, impacts[body])
        warned: dict[str, Warned] = {}
        alone = self._alone()
        for name, scene in self._scenes.items():
            if self._knows_impacts and scene.watching is not None:
                warned[name or alone] = self._warned(name, impacts[name or alone], onsets[name or alone])
        everything = [one for of_body in matches.values() for one in of_body]
        return Compared(
            truth_of(everything) if self._knows_impacts or matches else None,
            {
                body: BodyTruth(truth_of(matches[body]) if body in matches else None, warned.get(body))
                for body in {**matches, **warned}
            },
            everything,
        )

    def events(self) -> dict[str, dict[int, str]] | None:
        """When (ns) something begins to happen to each watched body, and what; None where no truth is known."""
        if not self._knows_impacts:
            return None
        impacts, onsets, alone = self._of_bodies(self.impacts), self._of_bodies(self.onsets), self._alone()
        found = {}
        for name in self._scenes:
            what = {impact.stamp: f"impact, {impact.mode.name}" for impact in impacts[name or alone]}
            what |= {onset.stamp: onset.said for onset in onsets[name or alone]}
            found[name] = {stamp: what[stamp] for stamp in events_of(what)}
        return found

    def _of_bodies(self, happened: Iterable[HappenedTo]) -> dict[str, list[HappenedTo]]:
        """What happened to each body by its name."""
        found: dict[str, list[HappenedTo]] = defaultdict(list)
        for one in happened:
            found[self._names.get(one.body, one.body)].append(one)
        return found

    def _alone(self) -> str:
        """A body alone may have no name; it goes by its frame."""
        return next(iter([*self._names.values(), *[one.body for one in self.impacts]]), "")

    def _scene(self, body: str) -> Scene:
        return self._scenes[body if body in self._scenes else ""]

    def _matched_impacts(self, body: str, impacts: Iterable[TrueImpact]) -> list[Match]:
        """The impacts of a body until its last sample, and its false alarms."""
        scene, samples = self._scene(body), sorted(self._samples[body])
        happened = sorted((one for one in impacts if one.stamp <= samples[-1]), key=lambda one: one.stamp)
        matched, alarms = match([impact.stamp for impact in happened], self._rows[body][""].all, samples[-1])
        found, before = list[Match](), 0
        for k, impact in enumerate(happened):
            # A record at its rate shows an impact only with enough samples since the one before.
            until = bisect_right(samples, impact.stamp)
            shown = until - before >= SEEN and impact.approach > hardly(scene)
            before, predictions = until, matched.get(k, [])
            found.append(
                Match(
                    body=body,
                    foot="",
                    stamp=impact.stamp,
                    mode=impact.mode,
                    predictions=predictions,
                    shown=shown,
                    velocity_error=_velocity_error(impact, predictions[-1], scene.center_of_mass)
                    if shown and predictions
                    else None,
                    border=impact.border,
                )
            )
        return found + [Match(body, "", None, None, row) for row in alarms]

    def _matched_landings(self, body: str) -> list[Match]:
        """The landings of a body until its last sample, foot by foot, and its false alarms."""
        found, end, landings = list[Match](), self._samples[body][-1], self._all_landings()
        rows = {foot: rows.all for foot, rows in self._rows[body].items() if foot}
        # What a scene does not call a foot is predicted no landing.
        for foot in [*rows, *sorted({foot for of, foot in landings if of == body} - set(rows))]:
            stamps = sorted(stamp for stamp in landings.get((body, foot), ()) if stamp <= end)
            # A foot comes down softly: it may seem to come down still when the plan says that it stands.
            matched, alarms = match(stamps, rows.get(foot, ()), end, late=NEAREST)
            found += [Match(body, foot, stamp, None, matched.get(k, ())) for k, stamp in enumerate(stamps)]
            found += [Match(body, foot, None, None, row) for row in alarms]
        return found

    def _all_landings(self) -> dict[tuple[str, str], list[int]]:
        """The stamps of the true landings of each foot of each body."""
        found = defaultdict(list, {place: list(stamps) for place, stamps in self._landings.items()})
        for landing in self.landings:
            found[self._names.get(landing.body, landing.body), landing.foot].append(landing.stamp)
        return found

    def _warned(self, name: str, impacts: Sequence[TrueImpact], onsets: Sequence[TrueOnset]) -> Warned:
        """How a body was warned of, with what happened to it since something was known of it."""
        known, stood = self._known.get(name), self._stood[name]
        if known is None:
            return Warned()
        slides = [onset.stamp for onset in onsets if onset.slides]
        lifts = [onset.stamp for onset in onsets if onset.lifts]
        struck = [impact.stamp for impact in impacts]
        first_slide, first_impact, first_lift = (
            min((stamp for stamp in stamps if stamp >= known), default=None) for stamps in (slides, struck, lifts)
        )
        events = [stamp for stamp in events_of([*slides, *lifts, *struck]) if stamp >= known]
        warned = Warned(
            first_known=known,
            first_warning=stood[0][0] if stood else None,
            first_slide=first_slide,
            first_impact=first_impact,
            first_lift=first_lift,
            events=len(events),
            events_warned=sum(_standing(stood, stamp) is not None for stamp in events),
        )
        first = warned.first_event
        return warned._replace(warned_ahead=None if first is None else _standing(stood, first))


def events_of(stamps: Iterable[int]) -> list[int]:
    """The stamps, in ns, at which something begins to happen after a time of `APART` in which nothing did."""
    happened = sorted(stamps)
    return happened[:1] + [after for before, after in pairwise(happened) if after - before >= APART]


def _standing(stood: Iterable[tuple[int, float]], stamp: int) -> float | None:
    """How long a warning had been standing at a stamp, in s; None where none stood."""
    begun = [begin for begin, end in stood if begin < stamp <= end]
    return (stamp - begun[-1]) / NANOSECONDS if begun else None


def _velocity_error(impact: TrueImpact, last: Announcement, center: Vector3) -> float:
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
