"""The recorded tosses in the report."""

from __future__ import annotations

from statistics import median

import pytest

from impact_predictor.report.accuracy import tosses
from impact_predictor.report.accuracy.rows import IMPACT
from impact_predictor.report.accuracy.touchdown_methods import constant_twist, exact


@pytest.fixture(scope="module")
def record() -> tosses.Record:
    return tosses.read(2000)


def test_the_laws_are_scored_by_what_was_measured(record: tosses.Record) -> None:
    rows = {row.method: row for row in tosses.impact_rows(record, 1)}
    assert len(rows) == tosses.VARIANTS
    used, no_slip = rows["path law, slip across"], rows["no slip"]
    assert used.question == IMPACT
    assert used.twist_error is not None
    assert no_slip.twist_error is not None
    assert used.count > 10
    assert used.twist_error.median < 0.1  # 0.06 over all tosses
    assert no_slip.twist_error.median > 3.0 * used.twist_error.median
    assert all(0.0 < row.us <= row.us_90 for row in rows.values())


def test_the_landings_are_asked_forty_milliseconds_ahead(record: tosses.Record) -> None:
    seen = tosses.landings(record)
    assert len(seen) > 5
    for landing in seen:
        # A sample may be one period off, and its twist half a window old.
        assert abs(landing.time - tosses.AHEAD) < 0.011
    off = {
        solve: median(abs(found.time - landing.time) if (found := solve(landing.fall)) else 1.0 for landing in seen)
        for solve in (exact, constant_twist)
    }
    assert off[exact] < 0.5 * off[constant_twist]
    assert off[exact] < 0.006
