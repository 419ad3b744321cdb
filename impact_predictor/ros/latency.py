"""How old samples are when they come, by the clock of the node, and in words where that makes predictions useless."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from ..stamps import NANOSECONDS

RECORDED: Final = 60.0
"""Seconds by which stamps are at least behind this machine's clock where a recording is played: it takes that long to
make one. Clocks that are merely wrong are seldom so far apart."""


class Latency:
    """Compares the stamps of samples with a clock: this machine's, or the simulated one.

    `flaw` is what is wrong with the samples of the last second, and `note` what is to be known of them, each "" where
    there is nothing; `seconds` is how old the last one was, None where no sample came, or from a recording.
    """

    def __init__(self, horizon: Callable[[str], float]) -> None:
        """Know for each input of samples how far ahead of them touchdowns are predicted, in s."""
        self.flaw = self.note = ""
        self.seconds: float | None = None
        self.is_simulated = False
        """Whether the clock is the simulated one, by which no sample is from a recording."""
        self._horizon = horizon
        self._last: dict[str, tuple[int, int]] = {}

    def take(self, name: str, stamp: int, latency: int) -> None:
        """Know of a sample on an input with a stamp that it was so old when it came, both in ns."""
        self._last[name] = stamp, latency

    def second_over(self) -> None:
        """Judge the last sample of the second on each input, and begin the next second."""
        self.flaw = self.note = ""
        self.seconds = None
        for name, (stamp, latency) in self._last.items():
            late = latency / NANOSECONDS
            if late > RECORDED and not self.is_simulated:
                day = time.strftime("%Y-%m-%d %H:%M", time.gmtime(stamp // NANOSECONDS))
                self.note = (
                    f"stamps are of {day} UTC, as those of a recording; if none is played set both clocks by one"
                )
                continue
            self.seconds = late
            if abs(late) > (horizon := self._horizon(name)):
                order, or_else = ("ahead of", "") if late < 0.0 else ("behind", ", or look what holds samples up")
                clock = "the simulated clock" if self.is_simulated else "this machine's clock"
                self.flaw = (
                    f"stamps on {name} are {abs(late):,.1f} s {order} {clock}, and predictions reach {horizon:g} s "
                    f"ahead of them: set both clocks by one{or_else}"
                )
        self._last.clear()
