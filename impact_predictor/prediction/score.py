"""Predicted against happened: the predictions of one touchdown, and the velocities measured after it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from math import hypot

from ..mechanics.types import Twist
from ..stamps import NANOSECONDS
from .planar import Posture
from .scene import Scene
from .types import Leftover, Sample, Score, Touchdown, Vector3
from .vectors import cross, dot, lines, to_world

MEASURED = slice(1, 4)
"""Samples 2 to 4 after a touchdown: the first may average the impact itself, later ones see friction and bounces."""

LONGEST = 1000  # how many predictions of one touchdown are remembered


class Track:
    """The predictions of one touchdown, from the first to the last."""

    def __init__(self) -> None:
        self.answers: deque[tuple[int, Touchdown]] = deque(maxlen=LONGEST)
        """Stamp (ns) of each sample that announced the touchdown, and how it did."""
        self.stamp = 0
        """When the touchdown is predicted, in ns."""
        self.approach = 0.0
        """How fast the new contact approached at that sample, in m/s."""

    def add(self, stamp: int, touchdown: Touchdown, approach: float) -> None:
        """A prediction made from the sample of `stamp`, which measured the approach."""
        self.stamp = stamp + round(touchdown.lead_time * NANOSECONDS)
        self.approach = approach
        self.answers.append((stamp, touchdown))

    def hold(self, stamp: int) -> Touchdown:
        """The last prediction as it reads at a later sample."""
        touchdown = self.last._replace(lead_time=max(0.0, self.lead_time(stamp)))
        self.answers.append((stamp, touchdown))
        return touchdown

    @property
    def last(self) -> Touchdown:
        return self.answers[-1][1]

    def lead_time(self, stamp: int) -> float:
        """Seconds from a stamp in ns to the predicted touchdown."""
        return (self.stamp - stamp) / NANOSECONDS


class Pending:
    """A touchdown that has happened and waits for the samples that measure it; `stamp` in ns."""

    def __init__(self, track: Track, stamp: int) -> None:
        self.track = track
        self.stamp = stamp
        self._measured: list[tuple[int, Vector3, Vector3]] = []

    def add(self, sample: Sample, posture: Posture) -> None:
        axes = posture.axes
        self._measured.append((sample.stamp, to_world(axes, posture.velocity), to_world(axes, sample.angular)))

    @property
    def complete(self) -> bool:
        return len(self._measured) >= MEASURED.stop

    def score(self, scene: Scene) -> Score:
        """The score; where the record ended before it was complete, without what was measured."""
        last = self.track.last
        score = Score(
            stamp=self.stamp,
            touchdown=last,
            measured=None,
            relative_error=None,
            scored=False,
            leftover=last.leftover | Leftover.TOO_SHORT,
            history=(),
        )
        if not self.complete:
            return score
        measured = self._twist(scene, last)
        score = score._replace(measured=measured, leftover=last.leftover)
        scale = hypot(last.before.vx, last.before.omega * last.half_distance)
        if not last.old or scale == 0.0:
            return score
        errors = []
        for stamp, touchdown in self.track.answers:
            if stamp <= self.stamp and touchdown.old == last.old and touchdown.new == last.new:
                seen = measured if touchdown.axis == last.axis else self._twist(scene, touchdown)
                error = _distance(touchdown.after, seen, last.half_distance) / scale
                errors.append(((self.stamp - stamp) / NANOSECONDS, error))
        error = _distance(last.after, measured, last.half_distance) / scale
        return score._replace(relative_error=error, scored=not last.leftover, history=tuple(errors))

    def _twist(self, scene: Scene, touchdown: Touchdown) -> Twist:
        ahead = cross(touchdown.axis, scene.normal)
        along = [dot(ahead, velocity) for _, velocity, _ in self._measured]
        up = [dot(scene.normal, velocity) for _, velocity, _ in self._measured]
        spin = [-dot(touchdown.axis, spin) for _, _, spin in self._measured]
        if scene.deck is None or scene.twist_window:
            vx, vy, omega = [median(values[MEASURED]) for values in (along, up, spin)]
        else:
            # What rocks on a deck comes slowly and has turned on by then: it is followed back to the touchdown.
            times = [(stamp - self.stamp) / NANOSECONDS for stamp, _, _ in self._measured]
            (vx, _), (vy, _), (omega, _) = lines(times, (along, up, spin))
        return Twist(vx, vy, omega)


def _distance(one: Twist, other: Twist, half_distance: float) -> float:
    """How far two twists are apart in the plane, as a speed in m/s."""
    return hypot(one.vx - other.vx, (one.omega - other.omega) * half_distance)


def median(numbers: Iterable[float]) -> float:
    """The middle one of some numbers, or halfway between the two; that of `statistics` takes a tenth of the start."""
    ordered = sorted(numbers)
    half = len(ordered) // 2
    return 0.5 * (ordered[half] + ordered[~half])
