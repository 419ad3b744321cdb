"""What a replay says of the truth in its bag."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from impact_predictor.bags.replay import Result
from impact_predictor.prediction.types import Status
from impact_predictor.report.replay import print_replay, truth_sentences
from impact_predictor.scenarios.comparison import BodyTruth, Truth, Warned


def test_the_truth_is_said_in_whole_sentences() -> None:
    found, missed, right, time, unseen = truth_sentences(Truth(4, 1, 2, 3, 0.75, 0.0123, 1.5e-6))
    assert found == "Against the truth in the bag: 3 of 4 touchdowns found, 2 false alarms."
    assert missed == (
        "A touchdown is found where a prediction before it has its time to 20 ms; the other was predicted too late, "
        "too far off, or not at all."
    )
    assert right == (
        "Of those found, 75.0 % have the right mode; the velocities after them are within 1.2 % of the true ones in "
        "the median."
    )
    assert time == "The time predicted 20 ms ahead is 1.5 us wrong in the median."
    assert unseen.startswith("3 more impacts cannot be seen at this rate of samples")


def test_of_landings_the_truth_tells_times_alone() -> None:
    truth = Truth(
        49, 0, 0, 0, None, None, 1.1e-3, time_error_by_lead_time={"0.02": 1.1e-3, "0.05": 0.0016}, least_lead_time=0.063
    )
    assert truth_sentences(truth) == [
        "Against the truth in the bag: 49 of 49 touchdowns found, 0 false alarms.",
        "The time predicted 20 ms ahead is 1.1 ms wrong in the median, that predicted 50 ms ahead 1.6 ms.",
        "The first prediction of each came 63 ms ahead of it or earlier.",
    ]


def test_modes_near_a_border_and_wrong_ones_that_no_record_shows_are_told_apart() -> None:
    _, _, _, clear, unseen = truth_sentences(Truth(4, 1, 2, 3, 0.75, 0.0123, None, 2, 1.0, 1))
    assert clear == (
        "2 of them are farther than 2 % of friction or geometry from another mode; of these 100.0 % have the right one."
    )
    assert unseen.endswith("from rest; 1 of them was predicted all the same, with another mode.")


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
    statuses={Status.ACCEPTED: 1239, Status.NO_SUPPORT: 10, Status.OFF_SUPPORT: 1},
    geometry_statuses={},
    notes=(),
    unpredictable="",
    damaged="",
    truth=TRUTH,
    truths={
        "crate": BodyTruth(TRUTH, Warned(1, 10**9, None, 3 * 10**9, warned_ahead=2.0, events=12, events_warned=11)),
        "drum": BodyTruth(
            Truth(0, 0, 0, 0, None, None, None), Warned(1, 2 * 10**9, 10**9, None, events=1, events_warned=0)
        ),
        "blind": BodyTruth(None, Warned(1, None, None, None, 10**9, warned_ahead=0.5, events=1, events_warned=1)),
        "still": BodyTruth(None, Warned(1, 10**9, None, None)),
    },
    inputs={
        "support/odom": {Status.ACCEPTED: 990, Status.SUPPORT_JUMPED: 10},
        "crate/odom": {Status.ACCEPTED: 1000},
        "drum/odom": {Status.ACCEPTED: 239, Status.NO_SUPPORT: 10, Status.OFF_SUPPORT: 1},
    },
)


def rows_of(text: str, body: str) -> list[list[str]]:
    """The cells of a body in every table, without its name."""
    lines = [line.split() for line in text.replace("\u00a0", "_").splitlines()]
    return [cells[1:] for cells in lines if cells[:1] == [body]]


@pytest.mark.parametrize("width", [80, 120])
def test_several_bodies_have_tables_of_their_own(width: int) -> None:
    text = printed(CARGO, width)
    assert "…" not in text
    assert "\n\n\n" not in text
    assert "No touchdown was predicted." in text
    assert rows_of(text, "crate") == [
        ["1,000", "0", "-", "-"],
        ["47_of_50", "1", "98.0", "0.5", "11_of_12", "2.0"],
    ]
    assert rows_of(text, "drum") == [["250", "1", "-", "-"], ["-", "0", "-", "-", "0_of_1", "not"]]
    assert rows_of(text, "blind")[1] == ["-", "-", "-", "-", "1_of_1", "0.5"]
    assert rows_of(text, "still")[1][-2:] == ["-", "-"]
    assert "2 bodies slid or struck; a warning stood before the first time in 1 of 2." in text
    assert "14 events in all" in text
    assert "a warning stood before 12 of 14." in text
    assert "Refused messages of support/odom: 10 support jumped." in text


def test_the_tables_of_a_long_record_fit_a_narrow_terminal() -> None:
    truth = Truth(1_234, 100, 123, 0, 1.0, 0.0123, None)
    warned = Warned(1, 2, 3, 4, warned_ahead=3599.9, events=120, events_warned=100)
    long = CARGO._replace(
        truths={"container_7": BodyTruth(truth, warned)},
        inputs={"container_7/odom": {Status.ACCEPTED: 3_600_000, Status.OFF_SUPPORT: 36_000}},
    )
    tables = printed(long).split("No touchdown")[0].splitlines()
    assert max(map(len, tables)) <= 80
    assert sum("container_7" in line for line in tables) == 2


def test_what_comes_before_the_deck_is_known_is_no_fault_of_the_samples() -> None:
    text = printed(CARGO)
    assert "10 samples came before the deck's motion was known." in text
    assert "Refused samples: 1 off support." in text
    early = {"crate/odom": {Status.ACCEPTED: 5, Status.NO_SUPPORT: 1}}
    text = printed(CARGO._replace(statuses=early["crate/odom"], inputs=early))
    assert "1 sample came before" in text
    # What no body has takes no column.
    assert "refused" not in text.lower()


def test_a_sample_before_the_first_contact_points_is_not_told_as_an_error() -> None:
    first = {"odom": {Status.ACCEPTED: 5, Status.NO_GEOMETRY: 1}}
    text = printed(CARGO._replace(truth=None, truths={}, statuses=first["odom"], inputs=first))
    assert "1 sample came before the first contact points." in text
    assert "refused" not in text.lower()
    none = {"odom": {Status.NO_GEOMETRY: 6}}
    text = printed(CARGO._replace(truth=None, truths={}, statuses=none["odom"], inputs=none))
    assert "Refused samples: 6 no geometry." in text


def test_what_was_refused_of_every_input_is_said() -> None:
    inputs = {
        "odom": {Status.ACCEPTED: 5},
        "contact_geometry": {Status.FEET_CHANGED: 1},
        "contact_wrench": {Status.ACCEPTED: 3, Status.WRONG_FRAME: 2},
        "schedule": {Status.ACCEPTED: 1},
    }
    walked = CARGO._replace(
        truth=None, truths={}, statuses=inputs["odom"], geometry_statuses=inputs["contact_geometry"], inputs=inputs
    )
    refused = [line for line in printed(walked).splitlines() if line.startswith("Refused")]
    assert refused == [
        "Refused messages of contact_geometry: 1 feet changed.",
        "Refused messages of contact_wrench: 2 wrong frame.",
    ]


def test_a_body_alone_has_no_such_table() -> None:
    alone = CARGO._replace(truths={"cube": BodyTruth(TRUTH, None)}, inputs={"odom": {Status.ACCEPTED: 5}})
    assert "body" not in printed(alone)


def test_of_nothing_found_nothing_more_is_said() -> None:
    assert truth_sentences(Truth(0, 0, 0, 0, None, None, None)) == [
        "Against the truth in the bag: no touchdown that this rate of samples can show, 0 false alarms."
    ]


def test_one_of_a_kind_is_said_as_one() -> None:
    found, _, unseen = truth_sentences(Truth(1, 0, 1, 1, 1.0, 0.0123, None))
    assert found.endswith("1 of 1 touchdown found, 1 false alarm.")
    assert unseen.startswith("1 more impact cannot be seen")
