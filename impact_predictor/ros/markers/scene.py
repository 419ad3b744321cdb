"""What a predictor sees, as markers for RViz 2 and Foxglove: support, bodies, contacts and the touchdowns ahead.

Over a moving support everything is in its frame, else in that of the samples, so that one fixed frame shows all of it
without any transform. Colours are never the only sign: levels and modes are written, kinds of contacts have a form.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Final

from ...prediction.scene import Scene
from ...prediction.types import Foot, Geometry, Moment, Prediction, Quaternion, Status
from ...prediction.vectors import add, axes_of, dot, to_body, to_world
from ...stamps import NANOSECONDS
from .drawing import BodyView, SeenPose, ShownTouchdown, draw_support, draw_unit
from .message import DELETE, DELETE_ALL, Marker, encode_markers
from .shapes import about, deck_of, patch_of, shape_of

if TYPE_CHECKING:
    from ...prediction.watch.watch import Report

PERIOD: Final = 100_000_000
"""ns from one message to the next."""
PAUSE: Final = 1_000_000_000
"""ns without news after which a body counts as stale; a clock that goes back by more has started anew."""
AFTERWARDS: Final = 1_000_000_000
"""ns for which a touchdown that has happened is still shown, where no other one is ahead."""
LETTER: Final = 0.2
"""Height of a letter, in the size of a body that is neither small nor large among the others."""
_OK, _STALE = 0, 3


class MarkerScene:
    """Collects what is known of the bodies of a scene, and draws it ten times for each second of stamps.

    `take...` and `set_geometry` take answers of the predictor and its other inputs; `due` gives the bytes of a
    visualization_msgs/MarkerArray when the time for one has come. All follows from stamps and values alone.
    """

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        """Draw the bodies of these names as their scenes describe them; "" is the name of a body alone."""
        self._bodies = {name: KnownBody(name, scene) for name, scene in scenes.items()}
        self._scene = next(iter(scenes.values()))
        self._slab = deck_of(self._scene)
        self._moment: Moment | None = None
        self._frame = ""
        self._last: int | None = None
        self._shown: frozenset[tuple[str, int]] = frozenset()

    def set_geometry(self, body: str, geometry: Geometry) -> None:
        """Take the contact points of a body that are no parameters."""
        self._bodies[body].set_points(geometry)

    def take(self, body: str, prediction: Prediction) -> None:
        """Take the answer to a sample of a body; a refused sample changes nothing."""
        if prediction.status is Status.ACCEPTED and self._bodies[body].take(prediction) and self._scene.deck is None:
            self._frame = prediction.sample.frame_id

    def take_tilt(self, body: str, stamp: int, orientation: Quaternion) -> None:
        """Take the orientation, relative to the support, of a body whose place nobody measures."""
        self._bodies[body].lean(stamp, orientation)

    def take_support(self, moment: Moment) -> None:
        """Take the state of a moving support, in whose frame all is drawn."""
        self._moment = moment
        self._frame = moment.child_frame_id

    def take_reports(self, reports: Iterable[Report]) -> None:
        """Take the levels of the bodies."""
        for report in reports:
            if report.body in self._bodies:
                one = self._bodies[report.body]
                one.level, one.message = int(report.level), "" if report.level == _OK else _why(report.values)

    def due(self, stamp: int) -> bytes | None:
        """The message of a stamp in ns, or None when it is too early for one, or nothing is known yet."""
        first: list[Marker] = []
        if self._last is not None and stamp - self._last < PERIOD:
            if self._last - stamp <= PAUSE:
                return None
            first = [Marker("", 0, action=DELETE_ALL)]
            self._shown = frozenset()
            for body in self._bodies.values():
                body.forget_after(stamp)
        drawn = self._draw(stamp)
        if not drawn and self._last is None:
            return None
        self._last = stamp
        now = frozenset([(marker.namespace, marker.number) for marker in drawn])
        first += [Marker(*key, action=DELETE) for key in sorted(self._shown - now)]
        self._shown = now
        return encode_markers(first + drawn, stamp, self._frame)

    def _draw(self, stamp: int) -> list[Marker]:
        scene, moment = self._scene, self._moment
        if scene.deck is not None and moment is None:
            return []
        found = [body.unit(number, stamp) for number, body in enumerate(self._bodies.values())]
        units = [unit for unit in found if unit is not None]
        slab = self._slab
        if slab is None:
            if not units:
                return []
            slab = patch_of(scene, [unit.seen.position for unit in units], max([unit.shape.size for unit in units]))
        sizes = sorted([unit.shape.size for unit in units]) or [0.1 * slab.half_x]
        letter = LETTER * sizes[len(sizes) // 2]
        drawn = draw_support(slab, scene, moment, letter)
        for unit in units:
            drawn += draw_unit(unit, stamp, letter)
        return drawn


def _why(values: Mapping[str, str]) -> str:
    """The level of a body in a line or two: what nothing is known of, or the margins and what comes next."""
    if values["status"] != Status.ACCEPTED.name or "unknown" in (values["tip_ratio"], values["slide_ratio"]):
        return values["status"].replace("_", " ")
    margins = f"margin used: tip {_part(values['tip_ratio'])}, slide {_part(values['slide_ratio'])}"
    due = [
        f"{verb} now" if float(values[key]) == 0.0 else f"{verb} in {float(values[key]):.1f} s"
        for verb, key in (("tips", "time_to_tip"), ("slides", "time_to_slide"))
        if values[key] != "inf"
    ]
    return "\n".join([margins, ", ".join(due)] if due else [margins])


def _part(ratio: str) -> str:
    """A part that is used of a margin; nothing holds a body that uses many times as much as there is."""
    return f"{100.0 * float(ratio):.0f} %" if float(ratio) < 10.0 else "all"


class KnownBody:
    """What is known of one body."""

    def __init__(self, name: str, scene: Scene) -> None:
        self.scene = scene
        self.seen: SeenPose | None = None
        self.level: int | None = None
        self.message = ""
        self._name = name
        self._points = scene.points
        self._shape = shape_of(scene, scene.points)
        self._ahead: ShownTouchdown | None = None
        self._feet: tuple[Foot, ...] = ()

    def set_points(self, geometry: Geometry) -> None:
        # Feet are drawn where the answers say that they are.
        if self.scene.walking is None and geometry.points != self._points:
            self._points = geometry.points
            self._shape = shape_of(self.scene, geometry.points)

    def take(self, prediction: Prediction) -> bool:
        """Note an answer; whether it says where the body is."""
        sample = prediction.sample if self.scene.deck is None else prediction.relative
        if sample is None:
            return False
        self.seen = SeenPose(sample.stamp, sample.position, sample.orientation)
        self._name = self._name or sample.child_frame_id
        self._feet = prediction.feet
        touchdown, score = prediction.touchdown, prediction.score
        if touchdown is not None:
            self._ahead = ShownTouchdown(sample.stamp + round(touchdown.lead_time * NANOSECONDS), touchdown)
        elif score is not None:
            self._ahead = ShownTouchdown(score.stamp, score.touchdown, happened=True, error=score.relative_error)
        elif self._ahead is not None and not self._ahead.happened:
            self._ahead = None
        return True

    def lean(self, stamp: int, orientation: Quaternion) -> None:
        """Stand with an orientation at the scene's place, on the lowest point."""
        scene, axes = self.scene, axes_of(orientation)
        position = scene.place
        if scene.radius == 0.0 and self._points:
            heights = [dot(scene.normal, add(position, to_world(axes, point))) for point in self._points]
            position = add(position, scene.normal, scene.height - min(heights))
        self.seen = SeenPose(stamp, position, orientation)

    def forget_after(self, stamp: int) -> None:
        """Forget what is later than a stamp in ns."""
        if self.seen is not None and self.seen.stamp > stamp:
            self.seen = self._ahead = None

    def unit(self, number: int, stamp: int) -> BodyView | None:
        """The body as it is to be drawn at a stamp in ns, or None where it cannot be."""
        scene, seen = self.scene, self.seen
        if seen is not None and self._feet:
            axes = axes_of(seen.orientation)
            places = [add(foot.position, seen.position, -1.0) for foot in self._feet if foot.position is not None]
            self._points = tuple(to_body(axes, place) for place in places)
            self._shape = shape_of(scene, self._points)
        shape = self._shape
        if seen is None and scene.deck is not None and scene.source != "odom":
            seen = SeenPose(stamp, scene.place, about(scene.normal, scene.yaw))
        if seen is None or shape is None:
            return None
        level = self.level
        if scene.watching is None and stamp - seen.stamp > PAUSE:
            level = _STALE
        ahead = self._ahead
        if ahead is not None and stamp - ahead.stamp > AFTERWARDS:
            ahead = None
        return BodyView(
            number=number,
            name=self._name,
            scene=scene,
            points=self._points,
            shape=shape,
            seen=seen,
            ahead=ahead,
            level=level,
            message=self.message,
            feet=self._feet,
        )
