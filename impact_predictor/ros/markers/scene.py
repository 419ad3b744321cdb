"""What a predictor sees, as markers for RViz 2 and Foxglove: support, bodies, contacts and the touchdowns ahead.

Over a moving support everything is in its frame, else in that of the samples, so that one fixed frame shows all of it
without any transform. Colours are never the only sign: levels and modes are written, kinds of contacts have a form.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache, partial
from math import acos, degrees, floor, hypot, log10
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ...prediction.scene import CONTACT_GEOMETRY, IMU, STATES, Input, Scene
from ...prediction.types import Geometry, Moment, Prediction, Quaternion, Status, Vector3
from ...prediction.vectors import Axes, add, axes_of, combine, dot, turn_to
from .body import PAUSE, BodyMarkers
from .message import DELETE, DELETE_ALL, NO_LOOK, NOWHERE, Marker, encode_markers

if TYPE_CHECKING:
    from ...prediction.monitor import Monitor
    from ...prediction.watch.watch import Report

PERIOD: Final = 100_000_000
"""ns from one message to the next."""
LETTER: Final = 0.2
"""Height of a letter, in the size of a body that is neither small nor large among the others."""


class MarkerScene:
    """Collects what is known of the bodies of a scene, and draws it ten times for each second of stamps.

    `take...` and `set_geometry` take answers of the predictor and its other inputs; `due` gives the bytes of a
    visualization_msgs/MarkerArray when the time for one has come. All follows from stamps and values alone.
    """

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        """Draw the bodies of these names as their scenes describe them; "" is the name of a body alone."""
        self._bodies = {name: BodyMarkers(number, name, scene) for number, (name, scene) in enumerate(scenes.items())}
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

    def hear(self, monitor: Monitor, one: Input, message: Any) -> bool:
        """Take what the monitor has made of an accepted message that is no state of a body; whether something moved."""
        body, deck = one.body or "", monitor.deck
        if one.kind == CONTACT_GEOMETRY:
            self.set_geometry(body, monitor.predictors[body].brought(message))
        elif one.kind in STATES and one.body is None and deck is not None and deck.last is not None:
            self.take_support(deck.last)
            return True
        elif one.kind == IMU and one.body is not None:
            self.take_tilt(body, message.stamp, monitor.tilts[body])
            return True
        return False

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
                one.level, one.message = int(report.level), _why(report.values) if report.level else ""

    def due(self, stamp: int) -> bytes | None:
        """The message of a stamp in ns, or None when it is too early for one, or nothing is known yet."""
        first: list[Marker] = []
        gone = partial(Marker, scale=NOWHERE, look=NO_LOOK)
        if self._last is not None and stamp - self._last < PERIOD:
            if self._last - stamp <= PAUSE:
                return None
            first = [gone("", 0, action=DELETE_ALL)]
            self._shown = frozenset()
            for body in self._bodies.values():
                body.forget_after(stamp)
        drawn = self._draw(stamp)
        if not drawn and self._last is None:
            return None
        self._last = stamp
        now = frozenset([(marker.namespace, marker.number) for marker in drawn])
        first += [gone(*key, action=DELETE) for key in sorted(self._shown - now)]
        self._shown = now
        return encode_markers(first + drawn, stamp, self._frame)

    def _draw(self, stamp: int) -> list[Marker]:
        scene, moment = self._scene, self._moment
        if scene.deck is not None and moment is None:
            return []
        found = [(body, known) for body in self._bodies.values() if (known := body.at(stamp)) is not None]
        sizes = sorted([shape.size for _, (_, shape) in found])
        slab = self._slab
        if slab is None:
            if not found:
                return []
            slab = patch_of(scene, [seen.position for _, (seen, _) in found], sizes[-1])
        letter = LETTER * (sizes[len(sizes) // 2] if sizes else 0.1 * slab.half_x)
        drawn = draw_support(slab, scene, moment, letter)
        for body, (seen, shape) in found:
            drawn += body.draw(seen, shape, stamp, letter)
        return drawn


def _why(values: Mapping[str, str]) -> str:
    """The level of a body in a line or two: what nothing is known of, or the margins and what comes next."""
    if values["status"] != Status.ACCEPTED.name or "unknown" in (values["tip_ratio"], values["slide_ratio"]):
        return values["status"].replace("_", " ")
    # Nothing holds a body that uses many times as much as there is.
    used = {key: float(values[f"{key}_ratio"]) for key in ("tip", "slide")}
    parts = [f"{key} {100.0 * ratio:.0f} %" if ratio < 10.0 else f"{key} all" for key, ratio in used.items()]
    margins = f"margin used: {', '.join(parts)}"
    due = [
        f"{verb} now" if float(values[key]) == 0.0 else f"{verb} in {float(values[key]):.1f} s"
        for verb, key in (("tips", "time_to_tip"), ("slides", "time_to_slide"))
        if values[key] != "inf"
    ]
    return "\n".join([margins, ", ".join(due)] if due else [margins])


class Slab(NamedTuple):
    """A part of the support in its frame: the middle of its surface, half its sides in m, its axes (x, y, normal)."""

    middle: Vector3
    half_x: float
    half_y: float
    axes: Axes


def deck_of(scene: Scene) -> Slab | None:
    """The whole support, or None where it has no end."""
    if scene.deck is None or not scene.deck.extent:
        return None
    x0, x1, y0, y1 = scene.deck.extent
    return _slab(scene, (0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0), 0.5 * (x1 - x0), 0.5 * (y1 - y0))


def patch_of(scene: Scene, places: list[Vector3], size: float) -> Slab:
    """A part of the support with room of at least `size` around places; it moves and grows in steps."""
    axes, step = axes_of(turn_to(scene.normal)), 2.0 * size
    along = [[dot(axis, place) for place in places] for axis in axes[:2]]
    (x0, x1), (y0, y1) = [(floor(min(one) / step - 0.5), floor(max(one) / step + 1.5)) for one in along]
    middle = combine(0.5 * step * (x0 + x1), axes[0], 0.5 * step * (y0 + y1), axes[1], 0.0, axes[2])
    return _slab(scene, middle, 0.5 * step * (x1 - x0), 0.5 * step * (y1 - y0))


def _slab(scene: Scene, middle: Vector3, half_x: float, half_y: float) -> Slab:
    on_plane = add(middle, scene.normal, scene.height - dot(scene.normal, middle))
    return Slab(middle=on_plane, half_x=half_x, half_y=half_y, axes=axes_of(turn_to(scene.normal)))


@lru_cache(maxsize=8)
def grid_of(slab: Slab) -> tuple[float, tuple[Vector3, ...]]:
    """The spacing in m, a 1, 2 or 5 with zeros, of about ten lines on a slab, and their ends seen from its middle."""
    longest = 2.0 * max(slab.half_x, slab.half_y)
    decade = 10.0 ** floor(log10(longest / 10.0))
    spacing = next(step * decade for step in (1.0, 2.0, 5.0, 10.0) if longest <= 12.0 * step * decade)
    ends: list[Vector3] = []
    for half, across, along_x in ((slab.half_x, slab.half_y, True), (slab.half_y, slab.half_x, False)):
        count = floor(half / spacing)
        inside = [k * spacing for k in range(-count, count + 1) if half - abs(k * spacing) > 0.3 * spacing]
        for place in (-half, *inside, half):
            ends += [(place, end, 0.0) if along_x else (end, place, 0.0) for end in (-across, across)]
    return spacing, tuple(ends)


def draw_support(slab: Slab, scene: Scene, moment: Moment | None, letter: float) -> list[Marker]:
    """The support with a grid; over a moving one also a plumb line beside the normal, which shows what is felt.

    A `letter` of the words is so many m high.
    """
    normal, longest = slab.axes[2], 2.0 * max(slab.half_x, slab.half_y)
    turned, thickness, width = turn_to(normal), 0.01 * longest, 0.002 * longest
    spacing, grid = grid_of(slab)
    below, above = add(slab.middle, normal, -0.5 * thickness), add(slab.middle, normal, 5e-4 * longest)
    sides = 2.0 * slab.half_x, 2.0 * slab.half_y, thickness
    drawn = [
        Marker("support", 0, position=below, orientation=turned, scale=sides),
        Marker("support/grid", 0, width, grid, above, turned),
    ]
    corner = combine(-slab.half_x, slab.axes[0], slab.half_y, slab.axes[1], 1.0, slab.middle)
    words = f"grid {spacing:g} m"
    if moment is not None:
        gravity = moment.felt.gravity
        size, high = hypot(*gravity), 0.15 * longest
        away = degrees(acos(max(-1.0, min(1.0, -dot(gravity, normal) / size)))) if size > 0.0 else 0.0
        words = f"felt gravity {size:.2f} m/s², {away:.1f}° off the normal\n{words}"
        top = add(corner, normal, high)
        hangs = add(top, gravity, high / hypot(*scene.gravity))
        drawn.append(Marker("support/plumb", 0, 0.006 * longest, (top, hangs)))
        drawn.append(Marker("support/normal", 0, width, (corner, top)))
        corner = top
    return [*drawn, Marker("support/text", 0, letter, position=add(corner, normal, 2.0 * letter), text=words)]
