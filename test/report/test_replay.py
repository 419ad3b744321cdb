"""What a replay says of the truth in its bag."""

from __future__ import annotations

from impact_predictor.report.replay import truth_sentences
from impact_predictor.scenarios.comparison import Truth


def test_the_truth_is_said_in_whole_sentences() -> None:
    found, right, time, unseen = truth_sentences(Truth(4, 1, 2, 3, 0.75, 0.0123, 1.5e-6))
    assert found == "Against the truth in the bag: 3 of 4 touchdowns found, 2 false alarms."
    assert (
        right == "Of those found, 75.0 % have the right mode; the velocities after them are 1.2 % wrong in the median."
    )
    assert time == "The time told 20 ms ahead is 1.5 us wrong in the median."
    assert unseen.startswith("3 more impacts cannot be seen at this rate of samples")


def test_of_nothing_found_nothing_more_is_said() -> None:
    assert truth_sentences(Truth(0, 0, 0, 0, None, None, None)) == [
        "Against the truth in the bag: 0 of 0 touchdowns found, 0 false alarms."
    ]
