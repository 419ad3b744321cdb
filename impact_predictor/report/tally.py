"""What the touchdowns of any number of bags say all together, in sentences; a few numbers of each are kept."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable
from statistics import median
from typing import TYPE_CHECKING, Final

from ..mechanics.types import Mode
from ..wording import counted, percent, words
from .summary import WHY, TouchdownRow, reasons, row_of, summarize

if TYPE_CHECKING:
    from ..bags.stream import Settled
    from .landings import LandingRow

NOISY: Final = "a foot came down too suddenly, or the noise of base and feet hides how it comes down"


class TouchdownTally:
    """Rows of touchdowns: how wrong the scored ones are, and why others are not scored."""

    def __init__(self, rows: Iterable[TouchdownRow] = ()) -> None:
        """Count some rows."""
        self._rows = 0
        self._errors = array("d")
        self._reasons: Counter[str] = Counter()
        for row in rows:
            self.add(row)

    def __bool__(self) -> bool:
        """Whether there is any row."""
        return bool(self._rows)

    def add(self, row: TouchdownRow) -> None:
        """Count a row."""
        self._rows += 1
        self._reasons.update(reasons([row]))
        if row.scored and row.relative_error is not None:
            self._errors.append(row.relative_error)

    def sentences(self) -> list[str]:
        """How wrong the scored touchdowns were, and why the others are not scored, one sentence each."""
        if not self._rows:
            return ["No touchdown was predicted."]
        errors = summarize(self._errors)
        said = [f"{errors.number:,} of {counted(self._rows, 'touchdown')} scored"]
        if errors.number:
            said[0] += f": relative error {percent(errors.median)} % in the median, 90 % below {percent(errors.p90)} %"
        said[0] += "."
        if self._reasons:
            several = ", for one or several reasons each" if len(self._reasons) > 1 else ""
            said.append(
                "A touchdown is scored where the samples after it show the velocities that the impact left; they "
                f"do not for {self._rows - errors.number:,}{several}:"
            )
            said += [f"  {count:,} {words(reason)}: {WHY[reason]}" for reason, count in self._reasons.most_common()]
        return said


class LandingTally:
    """Landings of feet: how long before they were predicted, their modes, speeds and impulses."""

    def __init__(self) -> None:
        """Begin with none."""
        self._firsts = self._seconds = self._missing = 0
        self._feet: set[tuple[str, str]] = set()
        self._least: float | None = None
        self._modes: Counter[Mode] = Counter()
        self._speeds, self._late = array("d"), array("d")
        self._impulse = self._change = 0.0

    def add(self, landing: LandingRow) -> None:
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
        """How long before they were predicted, without the point."""
        feet = "1 foot" if len(self._feet) == 1 else f"{len(self._feet)} feet"
        there = f"{counted(self._firsts, 'landing')} of {feet}"
        more = f"{counted(self._seconds, 'second contact')} of feet that stood already"
        besides = f", besides {more}" if self._seconds else ""
        if self._least is None:
            return [f"{there}, none of them predicted{besides}: {NOISY}"]
        who = "each" if not self._missing else f"{self._firsts - self._missing:,} of them"
        when = f"{who} predicted {self._least * 1e3:.0f} ms ahead or earlier{besides}"
        said = [f"{there}, {when}; errors are of that time, by when the foot's motion ends"]
        if self._missing:
            landings = "1 landing was" if self._missing == 1 else f"{self._missing:,} landings were"
            said.append(f"{landings} not predicted: {NOISY}")
        return said


class ReplayTally:
    """Touchdowns that have happened, those of feet told apart from all others."""

    def __init__(self) -> None:
        """Begin with none."""
        self._others, self._landings = TouchdownTally(), LandingTally()

    def add(self, settled: Iterable[Settled]) -> None:
        """Count the touchdowns of a bag."""
        for one in settled:
            if one.score.landing is None:
                self._others.add(row_of(*one))
            else:
                from .landings import landing_row  # only where feet have landed

                self._landings.add(landing_row(one.body, one.score))

    def sentences(self) -> list[str]:
        """What they say, one sentence each."""
        said = self._landings.sentences()
        return said + (self._others.sentences() if self._others or not said else [])
