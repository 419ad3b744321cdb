"""The picture: written in both formats, for many touchdowns and for none."""

from __future__ import annotations

from html import unescape
from pathlib import Path
from xml.etree import ElementTree

import pytest
from touchdowns import SCORE

from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.prediction.skill import SIMPLE
from impact_predictor.prediction.types import KINDS
from impact_predictor.report.figures import write_touchdowns
from impact_predictor.report.summary import LEAD_TIME_EDGES, Distribution, SpanErrors
from impact_predictor.report.touchdowns import TouchdownRow, row_of

ROWS = [
    row_of("cube", SCORE)._replace(
        stamp=k * 10**9,
        mode=Mode(1 + k % 6),
        predicted_twist=Twist(0.05 * k, 0.1, -0.4 * k),
        measured_twist=Twist(0.05 * k + 0.02, 0.12, -0.39 * k),
        relative_error=0.01 * k,
    )
    for k in range(30)
]
OUTLIER = ROWS[0]._replace(relative_error=40.0)
UNMEASURED = ROWS[0]._replace(measured_twist=None, relative_error=None, scored=False)
WHOLE = [
    row._replace(
        kind=KINDS[k % 6],
        before_twist_6d=(1.0, 0.0, -1.0, 0.0, 4.0, 0.0),
        predicted_twist_6d=(0.8, 0.0, 0.1, 0.0, 0.1 * k, 0.0),
        measured_twist_6d=(0.8, 0.0, 0.2, 0.0, 0.1 * k + 0.2, 0.0),
        relative_error_6d=0.01 * k,
        not_scored_6d=(),
        simple_errors_6d=(0.9, 0.8, 0.3, 0.5, 0.2),
        lift_old=(True, k % 3 > 0, 0.6),
        lift_new=(k % 2 > 0, k % 3 > 0, None),
    )
    for k, row in enumerate(ROWS)
]
ERRORS = [
    SpanErrors(begin, begin + 0.01, Distribution(5, 0.05, 0.1) if begin < 0.035 else Distribution())
    for begin in LEAD_TIME_EDGES[:-1]
]
NO_ERRORS = [one._replace(errors=Distribution()) for one in ERRORS]


@pytest.mark.parametrize("suffix", [".png", ".svg", ".PNG"])
def test_it_is_written_in_the_format_of_its_name(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"picture{suffix}"
    write_touchdowns(path, [*ROWS, OUTLIER, UNMEASURED], ERRORS, "Thirty touchdowns")
    data = path.read_bytes()
    assert len(data) > 20_000
    assert ElementTree.fromstring(data).tag.endswith("svg") if suffix == ".svg" else data.startswith(b"\x89PNG")


def test_whole_twists_are_shown_by_kind_beside_simple_answers_and_lifts_beside_what_was_told(tmp_path: Path) -> None:
    write_touchdowns(tmp_path / "whole.svg", WHOLE, NO_ERRORS, "Thirty touchdowns")
    drawn = unescape((tmp_path / "whole.svg").read_text())
    for said in (*KINDS, *SIMPLE.values(), "old contact", "new contact", "upwards"):
        assert f"<!-- {said} -->" in drawn


@pytest.mark.parametrize("rows", [[], [UNMEASURED], ROWS[:1], ROWS[1:3], WHOLE[:1]])
def test_few_touchdowns_or_none_make_a_picture_without_a_warning(
    tmp_path: Path, rows: list[TouchdownRow], recwarn: pytest.WarningsRecorder
) -> None:
    write_touchdowns(tmp_path / "few.png", rows, NO_ERRORS, "Few")
    assert (tmp_path / "few.png").stat().st_size > 5_000
    assert not recwarn.list
