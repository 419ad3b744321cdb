"""The timeline of a bag as SVG that is as wide as its place, and wider when it is magnified.

Places along the time are percentages, so that one drawing serves windows of any width, and letters keep their size.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Final

from markupsafe import Markup, escape

from ....stamps import NANOSECONDS
from ....wording import counted
from ...summary import quantile
from ..looks import outline_of
from ..svg import tidy
from .extent import Extent, is_near, nice, times_of, zooms_of
from .lanes import FALSE, MISSED, Bar, Lane, Row, Spot, Stem
from .words import MODES, percent

LANE: Final = 24
"""Height of a lane in pixels."""
SPACE: Final = 14
"""Between two rows."""
AXIS: Final = 26
"""Below all rows, for the times."""
TICKS: Final = 4
"""Times at most on a window's width."""
SPARSE: Final = 64
"""From this magnification on only times are shown near which something happens."""
MOST: Final = 3000
"""Marks in a timeline above which they are counted in columns."""
COLUMNS: Final = 300


def timeline(rows: Sequence[Row], extent: Extent, name: str, anchor: str) -> Markup:
    """The timeline of a bag: names of its rows, the drawing, and a choice of its magnification."""
    zooms = zooms_of(rows, extent)
    height = sum(LANE * len(row.lanes) + SPACE for row in rows) + AXIS
    label = f"Timeline of {name}: {said_of(rows)}."
    drawn, top = [], 0
    for row in rows:
        for number, lane in enumerate(row.lanes):
            drawn.append(draw_lane(lane, top + LANE * number, extent, several_of(rows)))
        top += LANE * len(row.lanes) + SPACE
    ticks = "".join(ticks_of(rows, extent, zooms, height - AXIS))
    svg = (
        f'<svg class="times" role="img" aria-label="{escape(label)}" style="height:{height}px">'
        f"{ticks}{''.join(drawn)}</svg>"
    )
    names = "".join(names_of(rows))
    strip = (
        f'<div class="strip"><div class="names">{names}</div><div class="scroll" tabindex="0" role="region" '
        f'aria-label="{escape(name)}, over time">{svg}</div></div>'
    )
    return Markup(f'<div class="timeline">{choice_of(zooms, anchor)}{strip}</div>')


def several_of(rows: Sequence[Row]) -> bool:
    """Whether there are too many marks for one each."""
    return sum(len(lane.spots) for row in rows for lane in row.lanes) > MOST


def said_of(rows: Sequence[Row]) -> str:
    """How many marks each row has, for those who do not see them."""
    said = []
    for row in rows:
        lanes = [(lane.name, len(lane.spots) or len(lane.bars) or len(lane.stems)) for lane in row.lanes]
        said.append(f"{row.name} {', '.join(f'{count:,} {name}' for name, count in lanes)}")
    return "; ".join(said)


def choice_of(zooms: Sequence[int], anchor: str) -> str:
    """Buttons for the magnifications; none where there is nothing to choose."""
    if len(zooms) < 2:
        return ""
    buttons = "".join(
        f'<label><input type="radio" name="zoom-{anchor}" value="{zoom}"{" checked" if zoom == 1 else ""}>'
        f"<span>{f'{zoom:,} ×' if zoom > 1 else 'all'}</span></label>"
        for zoom in zooms
    )
    return f'<form class="choice zoom"><fieldset><legend>Magnify the time</legend>{buttons}</fieldset></form>'


def names_of(rows: Iterable[Row]) -> Iterable[str]:
    """The names of the rows and their lanes, beside the drawing."""
    for row in rows:
        lanes = [f"<span>{escape(lane.name)}{scale_of(lane)}</span>" for lane in row.lanes]
        yield f"<div><strong>{escape(row.name)}</strong>{''.join(lanes)}</div>"


def scale_of(lane: Lane) -> str:
    """How high the stems of a lane can be."""
    return f" to {percent(most_of(lane))}" if lane.stems else ""


def most_of(lane: Lane) -> float:
    """The value of the highest stem that is drawn in full: a few greater ones do not press down the others."""
    values = [stem.value for stem in lane.stems]
    return min(max(values), 3.0 * quantile(values, 0.9)) or 1.0


def draw_lane(lane: Lane, top: int, extent: Extent, crowded: bool) -> str:
    """The marks, bars or stems of a lane; what is told of it before them."""
    middle, low = top + LANE // 2, top + LANE - 3
    drawn = [f'<line class="lane" x1="0" x2="100%" y1="{middle}" y2="{middle}"/>']
    if lane.bars:
        bars = "".join(draw_bar(bar, top, extent) for bar in lane.bars)
        drawn.append(f'<g class="{lane.css_class}">{bars}</g>')
    if lane.stems:
        drawn[0] = f'<line class="lane" x1="0" x2="100%" y1="{low}" y2="{low}"/>'
        most = most_of(lane)
        stems = "".join(draw_stem(stem, low, most, extent) for stem in lane.stems)
        drawn.append(f'<g class="stems">{stems}</g>')
    if crowded:
        return "".join([*drawn, *draw_counts(lane.spots, low, extent)])
    told = [
        f'<line x1="{extent.at(spot.since)}" x2="{extent.at(spot.stamp)}" y1="{middle}" y2="{middle}"/>'
        for spot in lane.spots
        if spot.since is not None and spot.since < spot.stamp
    ]
    drawn += [f'<g class="told">{"".join(told)}</g>'] if told else []
    kinds = dict.fromkeys((spot.faint, spot.mark) for spot in lane.spots)
    # What counts lies above what does not.
    for faint, mark in sorted(kinds, key=lambda kind: not kind[0]):
        uses = "".join(
            draw_spot(spot, middle, extent) for spot in lane.spots if (spot.faint, spot.mark) == (faint, mark)
        )
        # Faint as one: marks that lie on each other stay as faint as each of them.
        drawn.append(f'<g class="marks{" faint" if faint else ""}" fill="{colour_of(mark)}">{uses}</g>')
    return "".join(drawn)


def draw_spot(spot: Spot, y: int, extent: Extent) -> str:
    """A mark."""
    return (
        f'<use class="point" href="#mark-{spot.mark}" x="{extent.at(spot.stamp)}" y="{y}">'
        f"<title>{escape(spot.told)}</title></use>"
    )


def draw_bar(bar: Bar, top: int, extent: Extent) -> str:
    """A bar."""
    width = extent.part(extent.shown(bar.end) - extent.shown(bar.begin))
    return (
        f'<rect class="point" x="{extent.at(bar.begin)}" width="{width}" y="{top + 5}" height="{LANE - 10}">'
        f"<title>{escape(bar.told)}</title></rect>"
    )


def draw_stem(stem: Stem, low: int, most: float, extent: Extent) -> str:
    """A stem, red where it goes on."""
    high = low - max(1.0, (LANE - 5) * min(stem.value / most, 1.0))
    x, over = extent.at(stem.stamp), " over" if stem.value > most else ""
    place = f'x1="{x}" x2="{x}" y1="{low}" y2="{high:.4g}"'
    return f'<line class="point{over}" {place}><title>{escape(stem.told)}</title></line>'


def draw_counts(spots: Sequence[Spot], low: int, extent: Extent) -> list[str]:
    """How many marks fall into each column."""
    counts = Counter(COLUMNS * extent.shown(spot.stamp) // extent.length for spot in spots)
    most, width = max(counts.values(), default=1), 100.0 / COLUMNS
    bars = []
    for column, count in sorted(counts.items()):
        height = (LANE - 5) * count / most
        place = f'x="{width * column:.6g}%" width="{width:.4g}%" y="{low - height:.4g}" height="{height:.4g}"'
        bars.append(f'<rect class="point" {place}><title>{counted(count, "touchdown")}</title></rect>')
    return [f'<g class="counts">{"".join(bars)}</g>'] if bars else []


def ticks_of(rows: Sequence[Row], extent: Extent, zooms: Iterable[int], height: int) -> Iterable[str]:
    """Times below the rows, for each magnification its own, and where pauses are cut out."""
    busy = sorted({spot.stamp - extent.begin for row in rows for lane in row.lanes for spot in lane.spots})
    levels: dict[tuple[int, int], list[int]] = {}
    for zoom in zooms:
        step = nice(extent.length / zoom / TICKS)
        for time, unit in times_of(extent, step):
            digits = next(number for number in range(10) if unit % 10 ** (9 - number) == 0)
            if zoom < SPARSE or is_near(time, busy, step):
                levels.setdefault((time, digits), []).append(zoom)
    for (time, digits), mine in levels.items():
        at = extent.at(extent.begin + time)
        yield (
            f'<g class="tick {classes(mine)}"><line x1="{at}" x2="{at}" y1="0" y2="{height}"/>'
            f'<text x="{at}" y="{height + 18}">{time / NANOSECONDS:.{digits}f} s</text></g>'
        )
    if apart := classes(zoom for zoom in zooms if extent.is_cut_at(zoom)):
        for before, piece in pairwise(extent.pieces):
            at, length = extent.part(piece.place), (piece.begin - before.end) / NANOSECONDS
            told = f"a pause of {length:,.1f} s is cut out"
            yield (
                f'<line class="tick cut {apart}" x1="{at}" x2="{at}" y1="0" y2="{height}"><title>{told}</title></line>'
            )


def classes(zooms: Iterable[int]) -> str:
    """The classes of what is shown at some magnifications."""
    return " ".join(f"z{zoom}" for zoom in zooms)


def colour_of(mark: str) -> str:
    """The colour of a mark."""
    return "var(--family-8)" if mark in (MISSED, FALSE) else tidy(MODES[mark].colour)


def marks() -> Markup:
    """The shapes of all marks, to which the timelines of a page refer."""
    shapes = {mode: looks.marker for mode, looks in MODES.items()} | {MISSED: "*", FALSE: "X"}
    paths = "".join(
        f'<polygon id="mark-{name}" points="{outline_of(marker)}" transform="scale({18 if name == MISSED else 9})"/>'
        for name, marker in shapes.items()
    )
    return Markup(f'<svg class="shapes" width="0" height="0" aria-hidden="true"><defs>{paths}</defs></svg>')
