"""What the touchdowns of any number of bags say all together; a few numbers of each are kept, not the touchdowns."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..wording import counted
from .summary import WHY, TouchdownRow, reasons, row_of, summarize, words
from .table import percent

if TYPE_CHECKING:
    from ..bags.stream import Settled
    from .landing_tally import LandingTally


class Tally:
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


class Together:
    """Touchdowns that have happened, those of feet told apart from all others."""

    def __init__(self) -> None:
        """Begin with none."""
        self._others = Tally()
        self._landings: LandingTally | None = None

    def add(self, settled: Iterable[Settled]) -> None:
        """Count the touchdowns of a bag."""
        landings = []
        for one in settled:
            if one.score.landing is None:
                self._others.add(row_of(*one))
            else:
                landings.append(one)
        if landings:
            from .landing_tally import LandingTally  # only where feet have landed
            from .landings import landings_of

            self._landings = self._landings or LandingTally()
            for landing in landings_of(landings):
                self._landings.add(landing)

    def sentences(self) -> list[str]:
        """What they say, one sentence each."""
        if self._landings is None:
            return self._others.sentences()
        return self._landings.sentences() + (self._others.sentences() if self._others else [])
