"""What the landings of feet say all together, in sentences."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable
from statistics import median
from typing import Final

from ..mechanics.types import Mode
from ..wording import counted
from .landings import Landed

NOISY: Final = "a foot came down too suddenly, or the noise of base and feet hides how it comes down"


class LandingTally:
    """Landings counted; a few numbers of each are kept, so that any number of them can be added."""

    def __init__(self) -> None:
        """Begin with none."""
        self._firsts = self._seconds = self._missing = 0
        self._feet: set[tuple[str, str]] = set()
        self._least: float | None = None
        self._modes: Counter[Mode] = Counter()
        self._speeds, self._late = array("d"), array("d")
        self._impulse = self._change = 0.0

    def add(self, landing: Landed) -> None:
        """Count a landing."""
        self._modes[landing.mode] += 1
        if landing.second:
            self._seconds += 1
        else:
            self._firsts += 1
            self._feet.add((landing.body, landing.foot.split()[0]))
            if landing.announced is None:
                self._missing += 1
            else:
                self._least = landing.announced if self._least is None else min(self._least, landing.announced)
        if landing.speed is not None:
            self._speeds.append(landing.speed)
            self._impulse = max(self._impulse, landing.impulse or 0.0)
            self._change = max(self._change, landing.velocity or 0.0)
        if landing.late is not None:
            self._late.append(landing.late)

    def sentences(self) -> list[str]:
        """What they say, one sentence each."""
        if not self._modes:
            return []
        modes = ", ".join(f"{self._modes[mode]:,} {mode.name}" for mode in sorted(self._modes))
        braked = ": every foot brakes to rest as it reaches the ground" if set(self._modes) == {Mode.NO_IMPACT} else ""
        said = [*self._announced(), f"Predicted modes: {modes}{braked}"]
        if self._speeds:
            said.append(
                f"Speeds are those of the last sample in the air, {median(self._speeds):.3f} m/s in the median, "
                f"at most {max(self._speeds):.3f} m/s; impulses are those of an impact with that speed, as if the foot "
                f"braked no more: at most {self._impulse:.2f} N s. By that and by what the others get, which stand "
                f"or land together with it, the body's velocity changes by at most {self._change:.3f} m/s"
            )
        if self._late:
            said.append(
                f"Against the plan {counted(len(self._late), 'landing')} came {median(self._late) * 1e3:+.1f} ms late "
                f"in the median, from {min(self._late) * 1e3:+.1f} to {max(self._late) * 1e3:+.1f} ms"
            )
        return [f"{sentence}." for sentence in said]

    def _announced(self) -> list[str]:
        """How long before, without the point."""
        feet = "1 foot" if len(self._feet) == 1 else f"{len(self._feet)} feet"
        there = f"{counted(self._firsts, 'landing')} of {feet}"
        more = f"{counted(self._seconds, 'second contact')} of feet that stood already"
        besides = f", besides {more}" if self._seconds else ""
        if self._least is None:
            return [f"{there}, none of them announced{besides}: {NOISY}"]
        who = "each" if not self._missing else f"{self._firsts - self._missing:,} of them"
        told = f"{who} told {self._least * 1e3:.0f} ms ahead or earlier{besides}"
        said = [f"{there}, {told}; errors are of that time, by when the foot's motion ends"]
        if self._missing:
            stances = "1 landing was" if self._missing == 1 else f"{self._missing:,} landings were"
            said.append(f"{stances} not announced: {NOISY}")
        return said


def landing_sentences(landings: Iterable[Landed]) -> list[str]:
    """What some landings say all together, one sentence each."""
    tally = LandingTally()
    for landing in landings:
        tally.add(landing)
    return tally.sentences()
