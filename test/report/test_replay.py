"""What a replay says of the truth in its bag."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from impact_predictor.bags.replay import BodyTruth, Result
from impact_predictor.prediction.types import Status
from impact_predictor.report.replay import print_replay, truth_sentences
from impact_predictor.scenarios.comparison import Truth
from impact_predictor.scenarios.warned import Warned


def test_the_truth_is_said_in_whole_sentences() -> None:
    found, right, time, unseen = truth_sentences(Truth(4, 1, 2, 3, 0.75, 0.0123, 1.5e-6))
    assert found == "Against the truth in the bag: 3 of 4 touchdowns found, 2 false alarms."
    assert (
        right == "Of those found, 75.0 % have the right mode; the velocities after them are 1.2 % wrong in the median."
    )
    assert time == "The time told 20 ms ahead is 1.5 us wrong in the median."
    assert unseen.startswith("3 more impacts cannot be seen at this rate of samples")


def test_modes_near_a_border_and_wrong_ones_that_no_record_shows_are_told_apart() -> None:
    _, _, clear, unseen = truth_sentences(Truth(4, 1, 2, 3, 0.75, 0.0123, None, 2, 1.0, 1))
    assert clear == (
        "2 of them are farther than 2 % of friction or geometry from another mode; of these 100.0 % have the right one."
    )
    assert unseen.endswith("from rest; 1 of them were predicted all the same, with another mode.")


def printed(result: Result, width: int = 80) -> str:
    text = io.StringIO()
    print_replay(Console(file=text, width=width), result)
    return text.getvalue()


TRUTH = Truth(50, 3, 1, 0, 0.98, 0.005, None)
CARGO = Result(
    bag="cargo.mcap",
    samples=1250,
    seconds=1.0,
    settled=(),
    statuses={Status.ACCEPTED: 1240, Status.NO_SUPPORT: 10},
    geometry_statuses={},
    notes=(),
    unpredictable="",
    damaged="",
    truth=TRUTH,
    truths={
        "crate": BodyTruth(TRUTH, Warned(1, 10**9, None, 3 * 10**9)),
        "drum": BodyTruth(Truth(0, 0, 0, 0, None, None, None), Warned(1, 2 * 10**9, 10**9, None)),
        "blind": BodyTruth(None, Warned(1, None, None, 10**9)),
        "still": BodyTruth(None, Warned(1, 10**9, None, None)),
    },
    inputs={
        "support/odom": {Status.ACCEPTED: 990, Status.SUPPORT_JUMPED: 10},
        "crate/odom": {Status.ACCEPTED: 1000},
        "drum/odom": {Status.ACCEPTED: 240, Status.NO_SUPPORT: 10},
    },
)


@pytest.mark.parametrize("width", [80, 120])
def test_several_bodies_have_a_table_of_their_own(width: int) -> None:
    text = printed(CARGO, width)
    assert "…" not in text
    rows = {line.split()[0]: line.split()[1:] for line in text.replace("\u00a0", "_").splitlines() if line.strip()}
    assert rows["crate"] == ["1,000", "0", "-", "-", "47_of_50", "1", "98.0", "0.5", "2.0"]
    assert rows["drum"] == ["250", "10", "-", "-", "-", "0", "-", "-", "-1.0"]
    assert rows["blind"] == ["0", "0", "-", "-", "-", "-", "-", "-", "never"]
    assert rows["still"][-1] == "-"
    assert "3 bodies slid or struck; a warning came before that in 1 of 3 cases." in text
    assert "Refused messages of support/odom: 10 support jumped." in text


def test_what_no_body_has_takes_no_column() -> None:
    plain = CARGO._replace(truth=None, truths={}, inputs={"crate/odom": {Status.ACCEPTED: 5}})
    lines = printed(plain).splitlines()
    assert any(line.split() == ["crate", "5", "-", "-"] for line in lines)
    assert "refused" not in printed(plain)


def test_a_body_alone_has_no_such_table() -> None:
    alone = CARGO._replace(truths={"cube": BodyTruth(TRUTH, None)}, inputs={"odom": {Status.ACCEPTED: 5}})
    assert "body" not in printed(alone)


def test_of_nothing_found_nothing_more_is_said() -> None:
    assert truth_sentences(Truth(0, 0, 0, 0, None, None, None)) == [
        "Against the truth in the bag: 0 of 0 touchdowns found, 0 false alarms."
    ]
