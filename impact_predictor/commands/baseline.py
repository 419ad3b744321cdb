"""What has changed against an earlier run, for `impact-predictor replay --baseline`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..bags.replay import Result


class Baseline:
    """An earlier run of some bags; it is read at once, because the output may take its place."""

    def __init__(self, path: str, bags: Sequence[str], time: float, error: float) -> None:
        """Read it; changes of times up to `time` in s and of relative errors up to `error` are none.

        Raises:
            InputError: it cannot be read, or lacks a bag.
        """
        from ..report.baseline import Limits
        from ..report.earlier import read_earlier

        self.has_changed = False
        self._path = path
        self._limits = Limits(time, error)
        self._earlier = {bag: read_earlier(path, bag) for bag in bags}

    def judge(self, result: Result, every: bool, as_json: bool) -> dict[str, Any]:
        """Print what has changed (the first changes, or `every` one), or give it as JSON."""
        from ..report.baseline import compare_runs, run_of
        from ..report.changes import as_json as fields_of

        compared = compare_runs(self._earlier[result.bag], run_of(result), self._limits)
        self.has_changed |= bool(compared.changes)
        if as_json:
            return {"baseline": fields_of(compared, self._path)}
        from rich.console import Console

        from ..report.changes import print_changes

        print_changes(Console(), compared, self._path, every)
        return {}
