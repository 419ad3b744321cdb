"""What the watch says about the units, as one diagnostic_msgs/DiagnosticArray."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from ..cdr import DiagnosticForm, StatusBytes, diagnostic_array

if TYPE_CHECKING:
    from ...prediction.watch.watch import Report


NODE: Final = "impact_predictor"
"""The name of the node, which begins those of its units."""


def encode_reports(reports: Iterable[Report], nanoseconds: int, node: str = NODE) -> bytes:
    """A diagnostic_msgs/DiagnosticArray with one status for each unit of a node, stamped in ns."""
    return diagnostic_array(nanoseconds, "", [status_of(report, node) for report in reports])


def status_of(report: Report, node: str = NODE) -> StatusBytes:
    """One unit: its level, what was exceeded, its values; the hardware is the body."""
    values = report.values
    form = _form(f"{node}/unit/{report.body}" if report.body else f"{node}/unit", *values)
    return form.status(report.level, report.message, report.body, list(values.values()))


@lru_cache(maxsize=1024)
def _form(name: str, *keys: str) -> DiagnosticForm:
    return DiagnosticForm(name, *keys)
