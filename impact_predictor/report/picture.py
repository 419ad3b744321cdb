"""The one picture of any number of bags, of which only what it shows is kept."""

from __future__ import annotations

from array import array
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

from .figure import check_figure, write_figure
from .gait import MOST, Machine, machines_of, write_gait
from .summary import LEAD_TIME_EDGES, TouchdownRow, errors_ahead, row_of
from .tally import TouchdownTally

if TYPE_CHECKING:
    from ..bags.replay import Result

_NAMED: Final = 3
"""Bags whose names stand in the title."""


class Picture:
    """Takes the replays of bags one by one: of machines that walk it shows their gait, else predicted velocities."""

    def __init__(self, path: str) -> None:
        """Draw into `path`, a .png or .svg file.

        Raises:
            InputError: it is no such file, or its folder does not exist.
        """
        self.path = check_figure(path)
        self._names: list[str] = []
        self._bags = 0
        self._machines: list[Machine] = []
        self._tally = TouchdownTally()
        self._scored: list[TouchdownRow] = []
        # Lead time and error in turns.
        self._ahead = array("d")

    def add(self, result: Result) -> None:
        """Take a replay."""
        self._bags += 1
        if self._bags <= _NAMED:
            self._names.append(Path(result.bag).name)
        # One more than it shows tells that there are more.
        self._machines += islice(machines_of([result]), MOST + 1 - len(self._machines))
        for settled in result.settled:
            row = row_of(*settled)
            self._tally.add(row)
            if row.scored:
                self._scored.append(row)
                for lead_time, error in settled.score.history:
                    if lead_time < LEAD_TIME_EDGES[-1]:
                        self._ahead.extend((lead_time, error))

    def write(self) -> None:
        """Draw it.

        Raises:
            InputError: the file cannot be written.
        """
        if self._machines:
            write_gait(self.path, self._machines)
            return
        names = ", ".join(self._names) + (", ..." if self._bags > len(self._names) else "")
        errors = errors_ahead(zip(self._ahead[::2], self._ahead[1::2], strict=True))
        write_figure(self.path, self._scored, errors, f"{names}: {self._tally.sentences()[0].rstrip('.')}")
