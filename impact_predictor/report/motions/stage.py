"""A body that rocks, as a moving picture shows it: its outline, its contacts, what it stands on, and its impacts.

Everything is drawn in the support's frame and turned by its slope.
"""

from __future__ import annotations

from math import cos, hypot, pi, sin
from typing import Any, Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D, ScaledTranslation
from numpy.typing import NDArray

from ...mechanics.motion import PlanarState
from ...scenarios.rocking import Rocking
from .figure import CONTACTS, stance_of

BODY, LINE, SUPPORT, STRUCK = "#dbe4ee", "#33475b", "#b5ada0", "#d62728"
CLOSED, SLIPS, OPEN = "#1a1a1a", "#e69f00", "#ffffff"

_LOOKS: Final = 400
"""Moments of a motion at which its extent is looked at."""
_POST: Final = 0.05
"""Half the width of a post's top; a body that reaches below its contacts by more stands on posts. In their distance."""
_FLASH: Final = 0.8
"""Seconds of the picture for which an impact is seen."""

Points = NDArray[np.float64]


class Stage:
    """One body on its axes; `show` puts it where it is at a time. `speed` is that of the picture."""

    def __init__(self, axes: Axes, rocking: Rocking, speed: float) -> None:
        self._run, self._speed = rocking.run, speed
        body = rocking.rocker.body
        assert body.old is not None
        self._contacts = np.array([(body.old.x, body.old.y), (body.new.x, body.new.y)])
        self._distance = float(hypot(*(self._contacts[1] - self._contacts[0])))
        self._is_disc = not rocking.rocker.outline
        self._outline = circle(hypot(body.old.x, body.old.y)) if self._is_disc else np.array(rocking.rocker.outline)
        moments = np.linspace(0.0, self._run.time, _LOOKS)
        self._seen = [PlanarState(*state) for state in np.array(self._run.state(moments)).T.tolist()]
        self._stood = [self._run.states(float(moment)) for moment in moments]
        self._turned = Affine2D().rotate(self._run.support.motion(0.0).angle)
        self._supports = self._edges() if self._is_disc else self._posts()
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set_title(rocking.rocker.label, fontsize=11, loc="center", pad=17.0)
        self._draw(axes)

    def extent(self) -> tuple[Points, Points]:
        """The lower left and the upper right corner of all that is ever seen, in m."""
        bodies = [placed(self._outline, state) for state in self._seen]
        seen = self._turned.transform(np.concatenate([*bodies, *self._supports]))
        return seen.min(axis=0), seen.max(axis=0)

    def show(self, time: float) -> None:
        """Draw the body as it is at `time` in s."""
        state, states = self._run.state(time), self._run.states(time)
        self._shape.set_xy(placed(self._outline, state))
        self._spoke.set_data(*placed(self._axis, state).T)
        self._centre.set_data([state.x], [state.y])
        for mark, name, place, how in zip(self._marks, self._names, self._places(state), states, strict=True):
            mark.set_data(*place[:, None])
            name.set_position(place.tolist())
            mark.set_markerfacecolor(OPEN if how == "O" else CLOSED if how == "S" else SLIPS)
        stance = stance_of(states)
        self._says.set(text=stance, bbox={"facecolor": CONTACTS[stance], "edgecolor": "none", "pad": 3.0})
        self._show_impact(time)

    def _show_impact(self, time: float) -> None:
        happened = [strike for strike in self._run.impacts if strike.time <= time]
        age = (time - happened[-1].time) / (self._speed * _FLASH) if happened else 1.0
        for artist in (self._burst, self._mode):
            artist.set_visible(age < 1.0)
        if age < 1.0:
            last = happened[-1]
            self._burst.set_data(*self._places(last.before)[last.new][:, None])
            self._burst.set(markersize=8.0 + 20.0 * age, markeredgewidth=3.0 * (1.0 - age))
            passed = [one for one in self._run.accumulations if last.time <= one.time <= time]
            number = f"impact {len(happened)}: {last.outcome.mode.name}"
            self._mode.set_text("impacts accumulate" if passed else number)

    def _draw(self, axes: Axes) -> None:
        place: dict[str, Any] = {"transform": self._turned + axes.transData}
        for support in self._supports:
            axes.add_patch(Polygon(support, closed=True, facecolor=SUPPORT, edgecolor="none", zorder=1, **place))
        self._shape = Polygon(self._outline, closed=True, facecolor=BODY, edgecolor=LINE, linewidth=1.3, **place)
        axes.add_patch(self._shape)
        # A disc shows by a spoke how it turns.
        self._axis = np.array([(0.0, 0.0), self._outline[0]]) if self._is_disc else np.zeros((2, 2))
        (self._spoke,) = axes.plot([], [], color=LINE, linewidth=1.0, **place)
        (self._centre,) = axes.plot([], [], "P", color=LINE, markersize=6, markeredgewidth=0, **place)
        self._marks = [
            axes.plot([], [], "o", markersize=7, markeredgecolor=CLOSED, zorder=5, **place)[0] for _ in self._contacts
        ]
        (self._burst,) = axes.plot([], [], "o", markerfacecolor="none", markeredgecolor=STRUCK, **place)
        self._burst.set(zorder=6)
        words: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "fontsize": 9}
        self._mode = axes.text(0.5, 1.0, "", va="bottom", color=STRUCK, fontweight="bold", **words)
        lower = {**words, "transform": axes.transAxes + points(axes, -16.0)}
        self._says = axes.text(0.5, 0.0, "", va="top", **lower)
        below = {**words, "transform": place["transform"] + points(axes, -12.0), "color": LINE}
        self._names = [axes.text(0.0, 0.0, name, va="center", **below) for name in "AB"]
        self.moving: list[Artist] = [self._shape, self._spoke, self._centre, self._burst, *self._marks]
        self.moving += [*self._names, self._mode, self._says]
        """What `show` changes, from the back to the front."""

    def _places(self, state: PlanarState) -> Points:
        """Where both contacts are: points of the body, or edges of the support."""
        return self._contacts - self._contacts[0] if self._is_disc else placed(self._contacts, state)

    def _edges(self) -> list[Points]:
        """The blocks whose edges carry a disc."""
        depth, width = 0.35 * self._distance, 0.6 * self._distance
        blocks = []
        for (x, y), outwards in zip(self._contacts - self._contacts[0], (-1.0, 1.0), strict=True):
            far = x + outwards * width
            blocks.append(np.array([(x, y), (far, y), (far, y - depth), (x, y - depth)]))
        return blocks

    def _posts(self) -> list[Points]:
        """The floor, or what carries both contacts wherever they stand, if the body reaches below them."""
        lowest = min(placed(self._outline, state)[:, 1].min() for state in self._seen)
        widest = np.concatenate([placed(self._outline, state)[:, 0] for state in self._seen])
        left, right = widest.min() - 0.1 * self._distance, widest.max() + 0.1 * self._distance
        thickness = 0.08 * self._distance
        if lowest > -_POST * self._distance:
            return [np.array([(left, 0.0), (right, 0.0), (right, -thickness), (left, -thickness)])]
        ground = lowest - 0.1 * self._distance
        supports = [
            np.array([(left, ground), (right, ground), (right, ground - thickness), (left, ground - thickness)])
        ]
        half = _POST * self._distance
        for k in range(2):
            stood = [
                placed(self._contacts, state)[k, 0]
                for state, states in zip(self._seen, self._stood, strict=True)
                if states[k] != "O"
            ]
            if stood:
                begin, end = min(stood), max(stood)
                top = [(begin - 0.4 * half, 0.0), (end + 0.4 * half, 0.0)]
                supports.append(np.array([*top, (end + 2.0 * half, ground), (begin - 2.0 * half, ground)]))
        return supports


def points(axes: Axes, upwards: float) -> ScaledTranslation:
    """A way up the picture in points (1/72 inch)."""
    return ScaledTranslation(0.0, upwards / 72.0, axes.figure.dpi_scale_trans)


def circle(radius: float) -> Points:
    """The outline of a disc."""
    turns = np.linspace(0.0, 2.0 * pi, 73)
    return radius * np.column_stack((np.cos(turns), np.sin(turns)))


def placed(points: Points, state: PlanarState) -> Points:
    """Points (n, 2) of a body in the frame in which its state is given."""
    c, s = cos(state.angle), sin(state.angle)
    return np.asarray(np.array([state.x, state.y]) + points @ np.array([[c, s], [-s, c]]))
