"""The predictor: samples of one body in, a prediction for each out, scores once the touchdowns have happened."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import hypot
from typing import TYPE_CHECKING

from ..mechanics.impact import new_tuple, solve_impact
from ..mechanics.types import Outcome
from ..stamps import NANOSECONDS
from .approach import Approach, approach_of
from .checks import check_numbers, check_points, order_of
from .planar import Across, Posture, across_of, in_space, posture_of
from .scene import Scene
from .score import Pending, Track, leftover_of
from .types import Geometry, Moment, Prediction, Sample, Score, Status, Touchdown
from .vectors import to_world, total

if TYPE_CHECKING:
    from .deck.frame import SupportFrame
    from .deck.tracker import Deck
    from .drum import Drum
    from .uncertainty import Sampler

PAUSE = 250_000_000
"""ns without a sample after which the record begins anew."""

SETTLED = 0.5
"""A touchdown has happened when less than this part of the approach is left, within the contact tolerance, that the
predicting sample measured: the approach predicted for the touchdown has gravity's gain on the way added to it."""


class Predictor:
    """Predicts the touchdowns of one body of a scene.

    `update` answers each sample, in the order of their stamps; `set_geometry` tells the contact points when they are
    not in the scene; `finish` ends the record. Where the scene's support moves `deck` knows its motion.

    Raises:
        InputError: the edges do not carry the cylinder of the scene.
    """

    def __init__(self, scene: Scene, deck: Deck | None = None) -> None:
        self.scene = scene
        self._drum: Drum | None = None
        if scene.radius > 0.0:
            from .drum import Drum

            self._drum = Drum(scene)
        self._support_frame: SupportFrame | None = None
        if scene.deck is not None:
            from .deck.frame import SupportFrame

            self._support_frame = SupportFrame(scene, deck, self._drum)
        self._impact_across: Callable[..., tuple[Outcome, Across] | None] | None = None
        if scene.transverse_slip and scene.law == "path" and scene.friction > 0.0 and self._drum is None:
            from .transverse import impact_across

            self._impact_across = impact_across
        self._sampler: Sampler | None = None
        if scene.samples:
            from .uncertainty import Sampler

            self._sampler = Sampler(scene)
        if scene.margins:
            from ..mechanics import margins  # noqa: F401  # loaded now, not with the first sample
        self._points = scene.edges if self._drum else scene.points
        self._geometry_frame = ""
        self._last: int | None = None
        self._track: Track | None = None
        self._landed: Pending | None = None
        self._pending: list[Pending] = []
        self._scores: deque[Score] = deque()
        self._recent: deque[tuple[Sample, Posture]] = deque(maxlen=4)

    def become(self, other: Predictor) -> None:
        """Go on as the predictor of another scene of the body: what was told stays known, and the track begins anew."""
        if self._drum is None:
            other._points, other._geometry_frame = self._points, self._geometry_frame
        other._last = self._last
        other._scores.extend(self.finish())
        vars(self).update(vars(other))

    def set_geometry(self, geometry: Geometry) -> Status:
        """Take the body's contact points, in its frame, from now on. A refused geometry leaves the last one."""
        status = check_points(geometry.points)
        if status is Status.ACCEPTED:
            if geometry.points != self._points:
                self._points = geometry.points
                self._track = None
            self._geometry_frame = geometry.frame_id
        return status

    def update(self, sample: Sample) -> Prediction:
        """The prediction from a sample: its status, the touchdown ahead, and a score that the sample completed."""
        status = self._check(sample)
        if status is not Status.ACCEPTED:
            return Prediction(status, sample)
        moment, seen, support = None, sample, self._support_frame
        if support is not None:
            found = support.seen(sample)
            if isinstance(found, Status):
                return Prediction(found, sample)
            moment, seen = found
        posture = posture_of(self.scene, self._points, seen) if self._drum is None else self._drum.posture_of(seen)
        if support is not None:
            status = support.place_of(seen, posture, self._points)
            if status is not Status.ACCEPTED:
                return Prediction(status, sample, None, None, moment, seen)
        if self._last is not None and sample.stamp - self._last > PAUSE:
            self._forget()
        self._last = sample.stamp
        self._measure(seen, posture)
        touchdown = self._revise(seen, posture, moment)
        self._recent.append((seen, posture))
        score = self._scores.popleft() if self._scores else None
        if moment is None:
            return Prediction(status, sample, touchdown, score)
        return Prediction(status, sample, touchdown, score, moment, seen)

    def finish(self) -> tuple[Score, ...]:
        """End the record: the scores not yet handed out, those without enough samples after them included."""
        self._forget()
        scores = tuple(self._scores)
        self._scores.clear()
        self._last = None
        return scores

    def _check(self, sample: Sample) -> Status:
        status = check_numbers(sample)
        if status is not Status.ACCEPTED:
            return status
        if self._support_frame is None and self.scene.frame and sample.frame_id != self.scene.frame:
            return Status.WRONG_FRAME
        if not self._points:
            return Status.NO_GEOMETRY
        if self._geometry_frame and sample.child_frame_id and sample.child_frame_id != self._geometry_frame:
            return Status.WRONG_FRAME
        status = order_of(sample.stamp, self._last)
        if self._last is not None and self._last - sample.stamp > PAUSE:
            self._forget()
            self._last = None
        return status

    def _forget(self) -> None:
        """Begin anew; what waits for its measurement will not get it."""
        self._scores.extend(pending.unmeasured() for pending in self._pending)
        self._pending.clear()
        self._recent.clear()
        self._track = self._landed = None

    def _measure(self, sample: Sample, posture: Posture) -> None:
        """Hand the sample to the touchdowns that wait for it, and settle the tracked one if it has happened."""
        for pending in self._pending:
            pending.add(sample, posture)
        while self._pending and self._pending[0].complete:
            self._scores.append(self._pending.pop(0).score(self.scene))
        track = self._track
        if track is not None and self._has_landed(track, posture):
            self._track = None
            pending = Pending(track, min(track.stamp, sample.stamp))
            for earlier in self._recent:
                if earlier[0].stamp > pending.stamp:
                    pending.add(*earlier)
            pending.add(sample, posture)
            self._pending.append(pending)
            self._landed = pending

    def _has_landed(self, track: Track, posture: Posture) -> bool:
        gaps, rates = posture.gaps, posture.rates
        old, new = track.last.old, track.last.new
        gap = total([gaps[i] for i in new]) / len(new)
        if old:
            gap -= total([gaps[i] for i in old]) / len(old)
        approach = -total([rates[i] for i in new]) / len(new)
        return gap <= self.scene.tolerance and approach < SETTLED * track.approach

    def _revise(self, sample: Sample, posture: Posture, moment: Moment | None) -> Touchdown | None:
        """The touchdown ahead as this sample shows it, and keep track of it."""
        if self._drum is None:
            approach = approach_of(self.scene, self._points, sample, posture, moment)
        else:
            approach = self._drum.approach_of(sample, posture, moment)
        track = self._track
        if approach is None or self._is_echo(approach, sample):
            self._track = None
            return None
        if track is not None and set(approach.contacts.new).isdisjoint(track.last.new):
            track = None
        if track is None:
            track = self._track = Track()
        elif (
            min(approach.lead_time, abs(track.lead_time(sample.stamp))) < self.scene.twist_window
            or self._recent[-1][0].stamp <= track.stamp < sample.stamp
        ):
            # The impact itself may be in this twist, averaged or just begun: the last prediction stands.
            return track.hold(sample.stamp)
        touchdown = self._touchdown(sample, posture, approach)
        track.add(sample.stamp, touchdown, approach.measured)
        return touchdown

    def _is_echo(self, approach: Approach, sample: Sample) -> bool:
        """Whether the approach is what an averaged twist still has of the approach before the last touchdown."""
        landed = self._landed
        return (
            landed is not None
            and sample.stamp - landed.stamp < self.scene.twist_window * NANOSECONDS
            and not set(approach.contacts.new).isdisjoint(landed.track.last.new)
        )

    def _touchdown(self, sample: Sample, posture: Posture, approach: Approach) -> Touchdown:
        """The touchdown at the end of an approach, with its impact."""
        scene = self.scene
        contacts, plane, body, before, moved, lead_time, blocked, _, speed = approach
        across = across_of(sample, posture, plane, lead_time)
        slipped = None
        if self._impact_across is not None:
            slipped = self._impact_across(scene, plane, posture.normal, body, before, across, moved.angle, blocked)
        outcome, across = slipped or (solve_impact(body, before, scene.law, scene.validity), across)
        position, orientation, linear, angular = in_space(
            scene, sample, posture, plane, moved, outcome.twist, across, lead_time
        )
        gaps = [posture.gaps[i] for i in contacts.new]
        spread = (max(gaps) - min(gaps)) / speed
        half_distance = 0.0
        if body.old is not None:
            half_distance = 0.5 * hypot(body.new.x - body.old.x, body.new.y - body.old.y)
        uncertainty = planar = None
        if self._sampler is not None:
            uncertainty = self._sampler.uncertainty(sample, posture, plane, body, before, orientation)
        if scene.margins:
            planar = solve_impact(body, before, scene.law, scene.validity) if slipped else outcome
        touchdown = (
            lead_time,
            outcome.mode,
            before,
            outcome.twist,
            outcome.impulses,
            outcome.segments,
            outcome.energy_lost,
            outcome.flags,
            outcome.unique,
            outcome.law,
            contacts.old if body.old is not None else (),
            contacts.new,
            to_world(posture.axes, plane.axis),
            position,
            orientation,
            linear,
            angular,
            half_distance,
            plane.off_axis,
            plane.lateral,
            spread,
            plane.offset,
            leftover_of(scene, contacts, plane, body, speed, half_distance, spread),
            uncertainty,
            planar,
        )
        return new_tuple(Touchdown, touchdown)
