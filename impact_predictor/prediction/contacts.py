"""The contacts of a body with its support, whatever kind of body it is: `Contacts`, and `contacts_for` a scene."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque

from .scene import Scene
from .types import Foot, Geometry, Joints, Moment, Sample, Schedule, Score, Status, Touchdown, Vector3, Wrench

DEEP = 0.05
"""A contact is below its support when it lies deeper than this part of the body's size, or of its foot's distance from
the base ..."""

DEEP_TOLERANCES = 4.0
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

    @abstractmethod
    def tell(self, message: Geometry | Joints | Wrench | Schedule) -> Status:
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

    def feet(self) -> tuple[Foot, ...]:
        """The feet as the last sample shows them, of a body that has feet."""
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
