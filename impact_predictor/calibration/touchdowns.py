"""Touchdowns that a record scores, each with the impact behind its prediction, so that it can be solved anew."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import hypot, inf
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from ..mechanics.types import Twist, TwoPointBody
from ..prediction.impact import Collision
from ..prediction.monitor import Monitor
from ..prediction.planar import Posture
from ..prediction.points import PointContacts, collision_of
from ..prediction.predictor import Predictor
from ..prediction.scene import InertiaTensor, Scene
from ..prediction.score import MEASURED
from ..prediction.types import Prediction, Sample, Score, Vector3
from ..prediction.vectors import add, axes_of, cross, dot, to_world
from ..stamps import NANOSECONDS

if TYPE_CHECKING:
    from ..prediction.deck.tracker import Deck

_REMEMBERED: Final = 64
"""Predictions behind whose touchdowns the impact is kept; a touchdown is settled a few samples after its last one."""


class Coefficients(NamedTuple):
    """What is fitted: friction, restitution, and the factor on the scene's inertia."""

    friction: float
    restitution: float
    inertia: float = 1.0


class Start(NamedTuple):
    """What a prediction was made from: the sample, its posture, and the contact points in the body frame."""

    sample: Sample
    posture: Posture
    points: tuple[Vector3, ...]


class ScoredTouchdown(NamedTuple):
    """A scored touchdown.

    `body` is the name of the body, `stamp` (ns) that of its score, `measured` the twist of the mass centre right after
    it, in the impact plane, and `half_distance` that of the contacts in m. `bend` is by how much, relative to `speed`,
    the twists after it leave the straight line on which they were followed back to it: 0 where none was needed.
    `start` is None where the support moves.
    """

    body: str
    stamp: int
    scene: Scene
    impact: Collision
    measured: Twist
    half_distance: float
    bend: float = 0.0
    start: Start | None = None

    @property
    def speed(self) -> float:
        """What errors are relative to: the length of (vx, omega s) before the impact, in m/s."""
        return hypot(self.impact.before.vx, self.impact.before.omega * self.half_distance)

    def approached(self, coefficients: Coefficients) -> ScoredTouchdown:
        """The same touchdown where friction and inertia of the motion before it, too, are those of the coefficients."""
        if self.start is None:
            return self
        friction, restitution, factor = coefficients
        inertia = scaled(self.scene.inertia, factor)
        scene = self.scene._replace(friction=friction, restitution=restitution, inertia=inertia)
        sample, posture, points = self.start
        approach = collision_of(scene, points, sample, posture)
        body = self.impact.body
        if not isinstance(approach, Collision) or (approach.body.old is None) != (body.old is None):
            return self
        # The inertia is that of the scene as it was given: `Solver` scales it.
        return self._replace(impact=approach._replace(body=approach.body._replace(inertia=body.inertia)))


def with_coefficients(body: TwoPointBody, coefficients: Coefficients) -> TwoPointBody:
    """A body, or several as arrays, with other coefficients; the restitution of the old contact stays as it is."""
    friction, restitution, factor = coefficients
    return body._replace(
        inertia=factor * body.inertia,
        old=None if body.old is None else body.old._replace(friction=friction),
        new=body.new._replace(friction=friction, restitution=restitution),
    )


def scaled(inertia: InertiaTensor, factor: float) -> InertiaTensor:
    x, y, z = [(factor * row[0], factor * row[1], factor * row[2]) for row in inertia]
    return x, y, z


class Observer(Predictor):
    """A predictor that also collects the `touchdowns` that it scores, under the name of its body."""

    def __init__(self, name: str, scene: Scene, deck: Deck | None = None) -> None:
        super().__init__(scene, deck)
        self.name = name
        self.touchdowns: list[ScoredTouchdown] = []
        self._impacts: deque[tuple[Collision, Start | None]] = deque(maxlen=_REMEMBERED)
        self._samples: deque[Sample] = deque(maxlen=_REMEMBERED)

    def update(self, sample: Sample) -> Prediction:
        contacts = self.contacts
        assert isinstance(contacts, PointContacts)
        before = contacts.collision
        prediction = super().update(sample)
        if contacts.collision is not None and contacts.collision is not before:
            seen, posture, collision = contacts.collision
            fixed = self.scene.deck is None and not self.scene.radius
            start = Start(seen, posture, contacts.points) if fixed else None
            if isinstance(collision, Collision):
                self._impacts.append((collision, start))
        self._samples.append(sample)
        if prediction.score is not None:
            self._collect(prediction.score)
        return prediction

    def finish(self) -> tuple[Score, ...]:
        scores = super().finish()
        for score in scores:
            self._collect(score)
        return scores

    def _collect(self, score: Score) -> None:
        touchdown = score.touchdown
        behind = [one for one in self._impacts if one[0].before == touchdown.before]
        if score.scored and score.measured is not None and behind:
            impact, start = behind[-1]
            one = ScoredTouchdown(
                self.name, score.stamp, self.scene, impact, score.measured, touchdown.half_distance, start=start
            )
            if self.scene.deck is None and not self.scene.twist_window:
                one = self._followed_back(one, touchdown.axis)
            self.touchdowns.append(one)

    def _followed_back(self, one: ScoredTouchdown, axis: Vector3) -> ScoredTouchdown:
        """With the twist at the touchdown itself, on the straight line through the samples after it.

        Twists of the very instant are as sharp as that: what gravity adds in three samples would count as friction.
        Where gravity adds as much as the whole approach the samples are of another motion already.
        """
        normal, body = self.scene.normal, one.impact.body
        ahead = cross(axis, normal)
        times, twists = [], []
        for sample in [each for each in self._samples if each.stamp > one.stamp][: MEASURED.stop]:
            axes = axes_of(sample.orientation)
            velocity = to_world(axes, add(sample.linear, cross(sample.angular, self.scene.center_of_mass)))
            times.append((sample.stamp - one.stamp) / NANOSECONDS)
            twists.append((dot(ahead, velocity), dot(normal, velocity), -dot(axis, to_world(axes, sample.angular))))
        line = np.polynomial.polynomial.polyfit(times, np.array(twists), 1)
        bends = (np.array(twists) - line[0] - np.outer(times, line[1]))[:, (0, 2)] * (1.0, one.half_distance)
        _, vy, omega = one.impact.before
        if -(vy + omega * body.new.x) < hypot(*self.scene.gravity) * times[-1]:
            bends[:] = inf
        return one._replace(measured=Twist(*line[0].tolist()), bend=float(np.abs(bends).max()) / one.speed)


class ObservingMonitor(Monitor):
    """A monitor whose predictors collect the touchdowns that they score; the feet of walking machines are driven."""

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        super().__init__(scenes)
        self._observers = {
            body: Observer(body, scenes[body], self.deck)
            for body, predictor in self.predictors.items()
            if isinstance(predictor.contacts, PointContacts)
        }
        self.predictors = {**self.predictors, **self._observers}

    @property
    def touchdowns(self) -> list[ScoredTouchdown]:
        """Those of each body in the order of time, one body after the other."""
        return [one for observer in self._observers.values() for one in observer.touchdowns]
