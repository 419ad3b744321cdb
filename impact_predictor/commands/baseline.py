"""What has changed against an earlier run, for `impact-predictor replay --baseline`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from ..errors import InputError

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..report.baseline import Happened


class Baseline:
    """An earlier run of some bags; it is read at once, because the output may take its place."""

    def __init__(self, path: str, bags: Sequence[str], time: float, error: float) -> None:
        """Read it; changes of times up to `time` in s and of relative errors up to `error` are none.

        Raises:
            InputError: it cannot be read, is the run of one bag where several are given, or lacks the only one.
        """
        from ..bags.find import names_of
        from ..report.baseline import Limits
        from ..report.earlier import Earlier

        self.has_changed = False
        self._path = path
        self._limits = Limits(time, error)
        self._runs: dict[str, tuple[Happened, ...]] = {}
        self._missing: dict[str, InputError] = {}
        earlier = Earlier(path)
        earlier.check_of_several(len(bags))
        for bag, name in zip(bags, names_of(bags), strict=True):
            try:
                self._runs[bag] = earlier.touchdowns_of(bag, name)
            except InputError as flaw:  # noqa: PERF203 (each bag is missed by itself)
                self._missing[bag] = flaw
        if len(bags) == 1 and self._missing:
            raise next(iter(self._missing.values()))

    def judge(self, result: Result, every: bool, as_json: bool) -> dict[str, Any]:
        """Print what has changed (the first changes, or `every` one), or give it as JSON.

        A bag that the earlier run does not have is a change: nothing vouches for it.
        """
        from ..report.baseline import compare_runs, run_of
        from ..report.changes import as_json as fields_of

        if result.bag in self._missing:
            self.has_changed = True
            flaw = str(self._missing[result.bag])
            click.echo(f"note: {flaw}", err=True)
            return {"baseline": {"file": self._path, "error": flaw}} if as_json else {}
        compared = compare_runs(self._runs[result.bag], run_of(result), self._limits)
        self.has_changed |= bool(compared.changes)
        if as_json:
            return {"baseline": fields_of(compared, self._path)}
        from rich.console import Console

        from ..report.changes import print_changes

        print_changes(Console(), compared, self._path, every)
        return {}
