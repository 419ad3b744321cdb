"""The picture of bodies that rock: angular velocities, angles and contacts (Fig. 2 of the paper for any of them)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from math import degrees
from typing import Any, Final

import numpy as np

from ..scenarios.rocking import Rocking
from . import plot
from .modes import EDGE, PALETTE

CONTACT_COLOURS: Final = {"S": "#1a1a1a", "+": "#e69f00", "-": "#e69f00"}
"""By the state of a closed contact: it sticks, or slips forwards or back."""

_POINTS: Final = 2000
"""Points of a curve that is as long as the picture."""


def write_rocking_figure(path: str | os.PathLike[str], rockings: Sequence[Rocking]) -> None:
    """Draw angular velocities, angles and contacts of motions into a PNG or SVG file; InputError where the file cannot
    be written, or is of another format.
    """
    rocker, run = rockings[0]
    bodies = f"{rocker.name}s" if len(rockings) > 1 else f"a {rocker.name}, {rocker.label},"
    with plot.picture(path, 9.0, 6.0 + 0.4 * len(rockings)) as figure:
        heights = (2.7, 2.7, 0.3 + 0.4 * len(rockings))
        rates, angles, contacts = figure.subplots(3, 1, sharex=True, height_ratios=heights)
        released = f"released at {degrees(run.state(0.0).angle):.3g}°"
        rates.set_title(f"Angular velocity and angle of {bodies} {released}", fontweight="bold")
        # Until a little after the last motion.
        times = np.linspace(0.0, 1.06 * max(one.run.time for one in rockings) or 1.0, _POINTS)
        for k, (of, one) in enumerate(rockings):
            colour = PALETTE[k % len(PALETTE)]
            rates.plot(times, one.state(times).omega, color=colour, label=of.label)
            angles.plot(times, np.degrees(one.state(times).angle), color=colour)
            _draw_contacts(contacts, 2 * k, rockings[k], float(times[-1]))
        if accumulated := [one.time for rocking in rockings for one in rocking.run.accumulations]:
            rates.plot(accumulated, [0.0] * len(accumulated), "o", color=EDGE, markersize=5, label="impacts accumulate")
        rates.set(ylabel="ω (rad/s)", xlim=(0.0, times[-1]))
        angles.set_ylabel("φ (degrees)")
        contacts.set_xlabel("time (s)")
        contacts.grid(visible=False, axis="y")
        contacts.invert_yaxis()
        contacts.set_yticks(range(2 * len(rockings)), ["A", "B"] * len(rockings))
        for row, label in enumerate(contacts.get_yticklabels()):
            label.set(color=PALETTE[row // 2 % len(PALETTE)], fontweight="bold")
        # One legend of all axes, in which each label stands once.
        found = [axes.get_legend_handles_labels() for axes in figure.axes]
        entries = {label: handle for handles, labels in found for handle, label in zip(handles, labels, strict=True)}
        says: Any = {"title": "contact A: behind the mass centre, B: ahead of it", "title_fontsize": 9}
        figure.legend(list(entries.values()), list(entries), loc="outside lower center", ncols=4, **says)


def _draw_contacts(axes: plot.Axes, row: int, rocking: Rocking, end: float) -> None:
    """Draw bars while the contacts of a motion are closed, A in a row, B below; at its end it stays so until `end`."""
    phases = rocking.run.phases
    ends = [*[phase.start for phase in phases[1:]], end]
    for phase, until in zip(phases, ends, strict=True):
        for i, how in enumerate(phase.states):
            if how != "O":
                label = "contact sticks" if how == "S" else "contact slips"
                width = until - phase.start
                axes.barh(row + i, width, 0.6, phase.start, color=CONTACT_COLOURS[how], label=label)
