"""One body under watch: what is known of it besides its margins."""

from __future__ import annotations

from typing import Final

from ...mechanics.types import Mode
from ...stamps import NANOSECONDS
from ..scene import Scene, Watching
from ..types import Status, Touchdown, Vector3
from .levels import ERROR, OK, STALE
from .standing import Motion, Standing
from .words import Used, margins

SILENT: Final = frozenset({Status.NO_SUPPORT, Status.SUPPORT_STALE, Status.BODY_STALE, Status.NO_GEOMETRY})
"""Where nothing is known, rather than something wrong, the level is STALE; every other status is an ERROR."""


OFF_ITS_FEET: Final = frozenset({Motion.ROCKS, Motion.LIFTS})


class Unit:
    """A body by its name: how it stands, its status, and why its level is what it is."""

    def __init__(self, name: str, scene: Scene) -> None:
        self.name, self.scene = name, scene
        self.watching = scene.watching or Watching()
        self.standing = Standing(scene)
        self.status = Status.ACCEPTED
        if scene.source != "none":
            self.status = Status.BODY_STALE
        if scene.needs_geometry:
            self.status = Status.NO_GEOMETRY
        self.heard = False
        """Whether its source was ever heard."""
        self.top = Used(0.0, "", 0.0)
        """Where the margins were used up most since the level rose."""
        self.why = ""
        """What else raised it."""
        self.raised = 0
        """The stamp in ns of what is the later one of both."""
        self._strike: tuple[int, Mode] | None = None

    @property
    def known(self) -> bool:
        """Whether its margins mean something: a body that has fallen silent is taken to stand as it stood."""
        return self.status in (Status.ACCEPTED, Status.BODY_STALE)

    def place(self) -> int:
        """The place of the level that it asks for, its margins left aside."""
        standing, asked = self.standing, place_of(self.status)
        if standing.toppled or standing.slid or standing.motion in OFF_ITS_FEET:
            return max(asked, ERROR)
        if not standing.solid and self.status is not Status.NO_GEOMETRY:
            return max(asked, ERROR)
        return asked

    def struck(self, stamp: int, touchdown: Touchdown | None) -> bool:
        """Take the touchdown that a sample announces, or that it announces none; whether the last one has happened.

        What a body that stands announces is noise of its twist.
        """
        happened = self._strike is not None and self._strike[0] <= stamp
        self._strike = None
        if touchdown is not None and touchdown.lead_time > 0.0 and self.standing.motion in OFF_ITS_FEET:
            self._strike = stamp + round(touchdown.lead_time * NANOSECONDS), touchdown.mode
        return happened

    def strike(self, stamp: int) -> tuple[float, Mode] | None:
        """The time in s until the touchdown ahead, and its mode."""
        if self._strike is None or self._strike[0] < stamp:
            return None
        return (self._strike[0] - stamp) / NANOSECONDS, self._strike[1]

    def reason(self) -> str:
        """Why its level rose, in words."""
        top, words = self.top, [self.why] if self.why else []
        if max(top.tip, top.slide) >= self.watching.warn:
            words.append(margins(top, self.watching, bool(self.scene.radius)))
        return "; ".join(words)

    def set_points(self, points: tuple[Vector3, ...]) -> bool:
        """Take its contact points; it stands anew on them if they are others."""
        if points == self.scene.points and self.status is not Status.NO_GEOMETRY:
            return False
        self.scene = self.scene._replace(points=points)
        self.standing = Standing(self.scene)
        if self.status is Status.NO_GEOMETRY:
            self.status = Status.BODY_STALE if self.scene.source != "none" else Status.ACCEPTED
        return True

    def begin_anew(self) -> None:
        """Wait for no stamp any more, but for its source to be heard."""
        self._strike = None
        self.heard = False
        if self.status is Status.ACCEPTED and self.scene.source != "none":
            self.status = Status.BODY_STALE


def place_of(status: Status) -> int:
    """The place of the level that a status asks for."""
    if status is Status.ACCEPTED:
        return OK
    return STALE if status in SILENT else ERROR
