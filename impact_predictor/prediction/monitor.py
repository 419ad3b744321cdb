"""Several bodies on one support: each message goes where it belongs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import TYPE_CHECKING

from ..stamps import NANOSECONDS
from .checks import check_numbers
from .predictor import Predictor
from .scene import MovingDeck, Scene, shared_by
from .types import ContactInput, Geometry, Imu, Moment, Prediction, Quaternion, Sample, Score, Status, Transform

if TYPE_CHECKING:
    from .deck.imu import Tilt
    from .deck.tracker import Deck
    from .frames import FrameTree
    from .watch.watch import Report, Watch

OF_SUPPORT = frozenset({Status.NO_SUPPORT, Status.SUPPORT_STALE})
"""Why a sample may be refused through no fault of its body: nobody knows then what any of the bodies feels."""

SPOILT = frozenset({Status.NOT_FINITE, Status.BAD_QUATERNION})
"""Messages that are bad in themselves: what was known stays known, until it is too old."""

AGAIN = frozenset({Status.STAMP_REPEATED, Status.STAMP_WENT_BACK})
"""Messages that tell nothing new, and so take nothing away from what is known either."""


class Monitor:
    """The bodies of some scenes, by their names, over the support that they share.

    It has a `Predictor` for each body whose pose is measured, a tracker of the support if that moves, and a watch over
    the margins of bodies if their scenes ask for it. It routes between them and computes
    nothing itself. Messages are taken as they arrive, and each stream in the order of its stamps.
    """

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        self.scenes = dict(scenes)
        self._told = dict(scenes)
        shared = shared_by(scenes)
        self.deck: Deck | None = None
        self.watch: Watch | None = None
        self._resting: Moment | None = None
        self._watched: dict[str, Scene] = {}
        self._tilts: dict[str, Tilt] = {}
        self.tilts: dict[str, Quaternion] = {}
        """The orientations, relative to the support, of bodies of which no more is measured."""
        self._known: dict[str, int] = {}
        self._unknown = Status.NO_SUPPORT  # why nothing can be told of the support, while that is so
        self._doubted = False  # whether a stamp made the support's last message too old
        self._timeout = (shared.deck or MovingDeck()).timeout * NANOSECONDS
        if shared.deck is not None:
            from .deck.tracker import Deck

            self.deck = Deck(shared.deck, shared.gravity, shared.normal)
        self.tree: FrameTree | None = None
        if any(scene.body_frame for scene in scenes.values()):
            from .frames import FrameTree

            self.tree = FrameTree()
        self.predictors = {
            body: Predictor(scene, self.deck, self.tree) for body, scene in scenes.items() if scene.source == "odom"
        }
        # The model of a robot tells its mass.
        self.scenes |= {body: predictor.scene for body, predictor in self.predictors.items()}
        if any(scene.watching is not None for scene in scenes.values()):
            if self.deck is None:
                from .deck.motion import resting

                self._resting = resting(shared.gravity)
            self.watch = self._begin_to_watch(scenes)
        if any(scene.source == "imu" for scene in scenes.values()):
            from .deck.imu import Tilt

            self._tilts = {body: Tilt(scene) for body, scene in scenes.items() if scene.source == "imu"}

    def _begin_to_watch(self, scenes: Mapping[str, Scene]) -> Watch:
        from .watch.watch import Watch

        self._watched = {body: scene for body, scene in scenes.items() if scene.watching is not None}
        if self._resting is not None:
            from .deck.forecast import single

            return Watch(self._watched, partial(single, self._resting, None))
        assert self.deck is not None
        self.deck.learn()
        return Watch(self._watched, self.deck.outlook)

    def changed(self, scenes: Mapping[str, Scene]) -> Callable[[], None]:
        """What makes other scenes of the same bodies those of this monitor: nothing has changed before it is called.

        Bodies whose scene is another one then begin anew, with the contact points that are known, and so does the watch
        over all bodies if one of them is watched. What is known of the support stays.

        Raises:
            InputError: there is no predictor for a scene.
        """
        others = {body: scene for body, scene in scenes.items() if scene != self._told[body]}
        begun = {
            body: Predictor(scene, self.deck, self.tree) for body, scene in others.items() if body in self.predictors
        }

        def change() -> None:
            self._told |= others
            self.scenes |= others
            for body, other in begun.items():
                self.predictors[body].become(other)
                self.scenes[body] = other.scene
            if any(body in self._watched for body in others):
                self.watch = self._begin_to_watch({body: self.scenes[body] for body in self._watched})
                for body, predictor in self.predictors.items():
                    geometry = predictor.contacts.geometry
                    if geometry is not None and body in self._watched:
                        self.watch.set_points(body, geometry.points)

        return change

    def update(self, body: str, sample: Sample) -> Prediction:
        """The answer to a sample of a body."""
        prediction = self.predictors[body].update(sample)
        watch = self.watch
        if watch is not None:
            if prediction.status is not Status.ACCEPTED:
                self._refused(watch, body, prediction.status, sample.stamp)
            elif self._heard(watch, body, sample.stamp):
                slack = self.predictors[body].contacts.slack
                watch.update_body(body, prediction.relative or prediction.sample, prediction.touchdown, slack)
        return prediction

    def update_imu(self, body: str, imu: Imu) -> Status:
        """Take the tilt of a body; what became of the message."""
        watch, tilt = self.watch, self._tilts[body]
        status = tilt.check(imu)
        moment = None
        if status is Status.ACCEPTED and self.deck is not None:
            moment = self.deck.at(imu.stamp)
            status = moment if isinstance(moment, Status) else status
        if imu.orientation is None or isinstance(moment, Status) or status is not Status.ACCEPTED:
            if watch is not None:
                self._refused(watch, body, status, imu.stamp)
            return status
        orientation = self.tilts[body] = tilt.on(moment, imu.orientation)
        if watch is not None and self._heard(watch, body, imu.stamp):
            watch.update_tilt(body, imu.stamp, orientation)
        return status

    def update_support(self, sample: Sample) -> Status:
        """Take pose and twist of the support; what became of the message."""
        assert self.deck is not None
        if self.tree is not None and check_numbers(sample) is Status.ACCEPTED:
            seen = self.tree.seen(sample, (), shared_by(self.scenes).frame)
            if seen is None:
                return self._moved(Status.NO_TRANSFORM, sample.stamp)
            sample = seen
        return self._moved(self.deck.update(sample), sample.stamp)

    def update_support_imu(self, imu: Imu) -> Status:
        """Take what an inertial sensor on the support measures; what became of the message."""
        assert self.deck is not None
        return self._moved(self.deck.update_imu(imu), imu.stamp)

    def update_frames(self, transforms: Iterable[Transform], is_fixed: bool) -> Status:
        """Take transforms between frames, `is_fixed` those that hold at any time; what became of the message."""
        assert self.tree is not None
        return self.tree.take(transforms, is_fixed)

    def tell(self, body: str, message: ContactInput) -> Status:
        """Take what is told about the contacts of a body; what became of the message."""
        status = self.predictors[body].tell(message)
        geometry = self.predictors[body].contacts.geometry
        if status is Status.ACCEPTED and isinstance(message, Geometry) and geometry and body in self._watched:
            assert self.watch is not None
            self.watch.set_points(body, geometry.points)
        return status

    def silent(self, stamp: int) -> None:
        """Know that no message came until a stamp (ns), so that what is too old by then counts as lost."""
        watch, deck = self.watch, self.deck
        if watch is None:
            return
        if deck is None:
            self._rest(watch, stamp)
        elif deck.last is None:
            watch.support_lost(self._unknown, stamp)
        elif stamp - deck.last.stamp > self._timeout:
            watch.support_lost(Status.SUPPORT_STALE, stamp)

    def reports(self) -> tuple[Report, ...]:
        """What the watch has to say now; mostly nothing."""
        return () if self.watch is None else self.watch.reports()

    def deck_report(self, reports: tuple[Report, ...]) -> Report | None:
        """What is to be said of a moving support besides reports on the bodies that it carries."""
        if self.deck is None or not reports:
            return None
        forecast = self.deck.forecast
        doubts = [*self.deck.doubts(), *([] if forecast is None else [f"forecast: {forecast.value}"])]
        first = reports[0]
        return first._replace(
            level=type(first.level).OK, body=self.deck.frames[1], message="; ".join(doubts), values=self.deck.values()
        )

    def doubts(self) -> tuple[str, ...]:
        """What speaks against the parameters of a scene, as what is measured shows it, a sentence each."""
        found = [] if self.deck is None else list(self.deck.doubts())
        for body, predictor in self.predictors.items():
            if predictor.scene.walking is None:  # of feet it is told with what else is known of them
                found += [f"{body}: {doubt}" if body else doubt for doubt in predictor.contacts.doubts()]
        return tuple(found)

    def finish(self) -> dict[str, tuple[Score, ...]]:
        """End the record: the scores that were not handed out yet, by the names of their bodies."""
        return {body: predictor.finish() for body, predictor in self.predictors.items()}

    def _moved(self, status: Status, stamp: int) -> Status:
        watch, last = self.watch, None if self.deck is None else self.deck.last
        if watch is None or status in AGAIN:
            return status
        self._doubted = False
        if status is Status.ACCEPTED and last is not None:
            watch.update_support(last, (0.0, 0.0) if self.deck is None else self.deck.errors)
        elif status is Status.ACCEPTED:
            self._unknown = Status.NO_SUPPORT
            watch.support_lost(Status.NO_SUPPORT, stamp)
        elif not (status in SPOILT and last is not None and stamp - last.stamp <= self._timeout):
            self._unknown = status
            watch.support_lost(status, stamp)
        return status

    def _rest(self, watch: Watch, stamp: int) -> None:
        if self._resting is not None:
            watch.update_support(self._resting._replace(stamp=stamp))

    def _heard(self, watch: Watch, body: str, stamp: int) -> bool:
        """Know that a body, and a fixed support, are there at a stamp; whether the body is watched."""
        self._rest(watch, stamp)
        self._known[body] = stamp
        return body in self._watched

    def _refused(self, watch: Watch, body: str, status: Status, stamp: int) -> None:
        if status in OF_SUPPORT and self._lost(status):
            watch.support_lost(status, stamp)
        elif body in self._watched and status not in AGAIN:
            known = self._known.get(body)
            if not (status in SPOILT and known is not None and stamp - known <= self._timeout):
                watch.body_lost(body, status, stamp)

    def _lost(self, status: Status) -> bool:
        """Whether the support is lost to all of its bodies when one of them is refused for its sake.

        A stamp from before the support was known says nothing of now, and the clock of one body may be ahead. Silence
        makes a second message too old before the next one of the support.
        """
        if status is Status.NO_SUPPORT:
            return self.deck is None or self.deck.last is None
        doubted, self._doubted = self._doubted, True
        return doubted
