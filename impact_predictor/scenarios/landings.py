"""Predicted against true landings of the feet of machines that walk.

The truth is what a plan or a simulation says of every foot: whether it stands. It is told beside the samples, and is
never an input of a prediction. It knows no modes and no velocities, so these are not compared.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import NamedTuple

from ..prediction.scene import Scene
from ..prediction.types import Prediction
from .comparison import Compared
from .matching import NEAREST, Announced, Match, Rows, match, matches_of


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
