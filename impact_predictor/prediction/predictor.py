"""The predictor: samples of one body in, a prediction for each out, scores once the touchdowns have happened.

What differs between bodies are their `Contacts`, which `contacts_for` makes for a scene.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, NoReturn

from .checks import PAUSE, check_numbers, in_floats, order_of
from .scene import Scene
from .types import (
    ContactInput,
    FeetStates,
    Foot,
    Geometry,
    Moment,
    Prediction,
    Sample,
    Score,
    Status,
    SupportTracker,
    Terrain,
    Touchdown,
    Vector3,
)

if TYPE_CHECKING:
    from .frames import FrameTree
    from .recorded import Announced
    from .walking.clock import Delay


DEEP: Final = 0.05
"""A contact is below its support when it lies deeper than this part of the body's size, or of its foot's distance from
the base ..."""

DEEP_TOLERANCES: Final = 4.0
"""... and so many contact tolerances. A tolerance is about three standard deviations of the gap of a point that rests,
and an orientation that is wrong by 3 degrees (0.05 rad) moves a point by 0.05 of the body's size."""


class Contacts(ABC):
    """Where a body may touch its support: which contacts there are now, how they move, and what touches down next.

    A `Predictor` asks for no more than this of any body. It hands over every sample that it accepts, as seen from the
    support, and asks for the touchdown ahead.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.stamp: int | None = None
        """Stamp in ns of the last sample that was taken, since the record began."""
        self.frame_id = ""
        """Frame of the contact points, "" where nobody named it."""
        self.geometry: Geometry | None = None
        """Where the contact points are, as it was told last."""
        self.settled: deque[Score] = deque()
        """Scores of touchdowns that have happened, the oldest first."""
        self.joints: tuple[str, ...] = ()
        """The joints that the robot's model moves by, where it has one."""
        self.unknown_joints: tuple[str, ...] = ()
        """Joints that were told last and that the model does not know."""
        self.depth: float | None = None
        """How deep in m the lowest contact was in the ground when a message was refused for that; None before."""

    @abstractmethod
    def tell(self, message: ContactInput) -> Status:
        """Take what is told about the contacts; what became of the message. A refused one leaves the last."""

    @abstractmethod
    def check(self, stamp: int) -> Status:
        """Whether enough is known of the contacts to take a sample of a stamp in ns."""

    @abstractmethod
    def take(self, sample: Sample, moment: Moment | None) -> Status:
        """Take a sample, as seen from the support, which is at a `moment` of its motion if it moves."""

    @abstractmethod
    def touchdown(self) -> Touchdown | Status | None:
        """The touchdown that the last sample shows to be next; None where none lies within the horizon."""

    @property
    def recorded(self) -> Mapping[str, Announced]:
        """The touchdowns that the samples show, by kind, of a body on points."""
        return {}

    def feet(self) -> tuple[Foot, ...]:
        """The feet as the last sample shows them, of a body that has feet."""
        return ()

    @property
    def delay(self) -> Delay | None:
        """How much later than the body its feet are told; None where it has none, or nothing has shown it yet."""
        return None

    @property
    def slack(self) -> float:
        """Gaps in m that cannot be told from none, by what the samples show."""
        return 0.0

    def doubts(self) -> tuple[str, ...]:
        """What looks wrong in that which is told about the contacts, and what to do; a clause each."""
        return ()

    @abstractmethod
    def forget(self) -> None:
        """Begin anew with the next sample; what waits for its measurement is settled without it."""

    @abstractmethod
    def follow(self, other: Contacts) -> None:
        """Take over what was told to the contacts of the same body in another scene."""

    def has_left(self, center: Vector3) -> bool:
        """Whether a body with its mass centre at a place in the support's frame cannot come back to its contacts."""
        return False


def contacts_for(scene: Scene) -> Contacts:
    """The contacts of a scene's body: feet that move against it, a cylinder on edges, or points.

    Raises:
        InputError: there are none for the scene.
    """
    if scene.walking is not None:
        from .walking.feet import FeetContacts

        return FeetContacts(scene)
    if scene.radius > 0.0:
        from .cylinder import CylinderContacts

        return CylinderContacts(scene)
    from .points import PointContacts

    return PointContacts(scene)


class Predictor:
    """Predicts the touchdowns of one body of a scene.

    `update` answers each sample, in the order of their stamps; `tell` takes what is told about its contacts besides
    the scene; `finish` ends the record. Where the scene's support moves `deck` knows its motion; `tree` has the frames
    that transforms connect, where the scene asks for them.

    Raises:
        InputError: there are no contacts for the scene: edges that do not carry a cylinder, a robot without a model.
    """

    def __init__(self, scene: Scene, deck: SupportTracker | None = None, tree: FrameTree | None = None) -> None:
        self.contacts = contacts_for(scene)
        self.scene = self.contacts.scene
        self._deck = deck
        self.tree = tree if scene.body_frame else None

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            "a Predictor is neither copied nor pickled: make another of its scene, and give it the same samples"
        )

    @property
    def frames(self) -> tuple[str, ...]:
        """The frames in which samples may be; none where any will do."""
        of_deck = () if self._deck is None else self._deck.frames
        return tuple(dict.fromkeys(one for one in (*of_deck, self.scene.frame) if one))

    def become(self, other: Predictor) -> None:
        """Go on as the predictor of another scene of the body: what was told stays known, and the track begins anew."""
        last = self.contacts.stamp
        other.contacts.follow(self.contacts)
        other.contacts.settled.extend(self.finish())
        other.contacts.stamp = last
        self.contacts, self.scene, self._deck = other.contacts, other.scene, other._deck

    def tell(self, message: ContactInput) -> Status:
        """Take what is told about the contacts of the body; what became of the message. A refused one changes nothing.

        Contact points are in the body's frame and hold from now on; those of feet have a stamp, and hold then.
        """
        brought = self.brought(message)
        return Status.NO_TRANSFORM if brought is None else self.contacts.tell(brought)

    def brought(self, message: ContactInput) -> Any:
        """What is told about the contacts, in the frames of the scene; None where no transforms lead there."""
        if self.tree is None or not isinstance(message, Geometry | FeetStates | Terrain):
            return message
        return self.tree.brought(message, self.scene.frame if isinstance(message, Terrain) else self.scene.body_frame)

    def update(self, sample: Sample) -> Prediction:
        """The prediction from a sample: its status, the touchdown ahead, and a score that is complete.

        Raises:
            InputError: a field of the sample has no numbers, or not as many as it has to.
        """
        try:
            status = check_numbers(sample)
        except (TypeError, ValueError, IndexError):
            # Told by numpy's arrays, for one: what machine code refuses, and Python would calculate with.
            sample = in_floats(sample)
            status = check_numbers(sample)
        if status is Status.ACCEPTED and self.tree is not None:
            seen = self.tree.seen(sample, self.frames, self.scene.body_frame)
            if seen is None:
                return Prediction(Status.NO_TRANSFORM, sample)
            sample = seen
        status = status or self._check(sample)
        if status is not Status.ACCEPTED:
            return Prediction(status, sample)
        contacts = self.contacts
        moment = relative = None
        if self.scene.deck is not None:
            from .deck.frame import seen_from  # only where the support moves

            known = Status.NO_SUPPORT if self._deck is None else self._deck.at(sample.stamp)
            if isinstance(known, Status):
                return Prediction(known, sample)
            moment, relative = known, seen_from(known, self.scene.frame, sample)
            if relative is None:
                return Prediction(Status.WRONG_FRAME, sample)
        status = contacts.take(relative or sample, moment)
        if status is not Status.ACCEPTED:
            return Prediction(status, sample, support=moment, relative=relative)
        touchdown = contacts.touchdown()
        if isinstance(touchdown, Status):
            return Prediction(touchdown, sample)
        feet = contacts.feet()
        score = contacts.settled.popleft() if contacts.settled else None
        return Prediction(status, sample, touchdown, score, moment, relative, feet)

    def finish(self) -> tuple[Score, ...]:
        """End the record: the scores not yet handed out, those without enough samples after them included."""
        self.contacts.forget()
        scores = tuple(self.contacts.settled)
        self.contacts.settled.clear()
        return scores

    def _check(self, sample: Sample) -> Status:
        """Whether a sample can be taken; after a pause, or a clock that has started anew, the record begins anew."""
        scene, contacts = self.scene, self.contacts
        if scene.deck is None and scene.frame and sample.frame_id != scene.frame:
            return Status.WRONG_FRAME
        known = contacts.check(sample.stamp)
        if known is Status.NO_GEOMETRY:
            return known
        if contacts.frame_id and sample.child_frame_id and sample.child_frame_id != contacts.frame_id:
            return Status.WRONG_FRAME
        last = contacts.stamp
        status = order_of(sample.stamp, last)
        if last is not None and abs(sample.stamp - last) > PAUSE:
            contacts.forget()
        return known if status is Status.ACCEPTED else status
