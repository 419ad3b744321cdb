"""The page of a replay: what it says and draws of small answers, in exact numbers."""

from __future__ import annotations

import tracemalloc
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from read_page import PageReader, traces
from replay_answers import TOSSES, TRUE, UNREADABLE, WALK, answer, landing, touchdown, true
from replay_answers import ahead as spans

from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.types import Leftover
from impact_predictor.report.page.compared import MANY
from impact_predictor.report.page.document import part_words, time_words
from impact_predictor.report.page.found import BagAnswer, Kept
from impact_predictor.report.page.replay import (
    headlines_of,
    lead_of,
    page_of_replay,
    title_of,
    write_replay_page,
    write_replay_pages,
)
from impact_predictor.report.page.sections import DRAWN, LISTED
from impact_predictor.report.page.timeline import MOST
from impact_predictor.report.summary import WHY

ALL = [TRUE, WALK, TOSSES, UNREADABLE]
WALK_FOUND = WALK | {"truth": {"touchdowns": 2, "missed": 0, "false": 0, "unresolved": 0}}


def read(answers: Sequence[BagAnswer], values: dict[str, Any] | None = None) -> PageReader:
    """The page of some answers, without the script of plotly."""
    return PageReader(page_of_replay(answers, values, script=""))


@pytest.fixture(scope="module")
def page() -> PageReader:
    return read(ALL, read_values("config/cube_tosses.yaml"))


def test_a_page_is_one_file_with_the_script_once_and_refers_to_nothing_outside_itself(tmp_path: Path) -> None:
    file = tmp_path / "replay.html"
    write_replay_page(file, ALL)
    text = file.read_text(encoding="utf-8")
    assert text.count("plotly.js v") == 1
    page = PageReader(text)
    assert page.sources == []
    assert all(link.startswith("#") for link in page.links)
    assert {link[1:] for link in page.links} <= set(page.anchors)
    assert "@import" not in text.partition("</style>")[0]
    assert list(tmp_path.iterdir()) == [file]


def test_pages_of_several_bags_share_one_file_of_the_script(tmp_path: Path) -> None:
    write_replay_pages(tmp_path / "week", ALL)
    files = {file.name: file for file in (tmp_path / "week").iterdir()}
    assert sorted(files) == ["bag-1.html", "bag-2.html", "bag-3.html", "index.html", "plotly.min.js"]
    for name in set(files) - {"plotly.min.js"}:
        page = PageReader(files[name].read_text(encoding="utf-8"))
        assert page.sources == ["plotly.min.js"]
        assert {link for link in page.links if not link.startswith("#")} <= set(files)
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match=r"the folder .*taken cannot be made: File exists; give another name"):
        write_replay_pages(tmp_path / "taken", ALL)


def test_all_text_of_a_bag_is_escaped_on_the_page_and_in_its_figures() -> None:
    evil = '<script>alert("x")</script>'
    given = answer(evil, touchdowns=[touchdown(100, body=evil), landing(300, evil, 0.0)], notes=[evil], damaged=evil)
    text = page_of_replay([given, {**UNREADABLE, "error": evil}], script="")
    assert "<script>alert" not in text
    page = PageReader(text)
    assert page.text.count(evil) >= 3
    (lanes,) = [figure["layout"]["yaxis"]["ticktext"] for title, figure in page.figures.items() if title in evil]
    assert lanes[0] == '&lt;script&gt;alert("x")&lt;/script&gt; predicted'


def test_names_are_as_short_as_they_can_be_and_no_two_are_the_same() -> None:
    paths = ["/a/one/run.mcap", "/a/two/run.mcap", "/b/two/run.mcap", "x.bag"]
    rows = read([answer(path) for path in paths]).tables["bags"][0][1:]
    assert [row[0] for row in rows] == ["one/run.mcap", "a/two/run.mcap", "b/two/run.mcap", "x.bag"]


def test_the_headlines_say_how_many_how_right_and_how_early() -> None:
    # Against the truth where a bag tells it (0.02 twice), else against what was measured (0.1 and 0.2).
    assert title_of([TRUE]) == "Touchdowns: 2 of 3 found, velocities within 2.0 %, 59.5 ms ahead"
    assert title_of([TRUE, TOSSES]) == "Touchdowns: 2 of 3 found, velocities within 6.0 %, 54.5 ms ahead"
    assert title_of([WALK]) == "Touchdowns: 2 of 3 landings announced, 50 ms ahead"
    assert title_of([answer(), UNREADABLE]) == "No touchdown was predicted"
    many, right, soon, cost = (f"{one.answer}: {one.more}" for one in headlines_of([TRUE, UNREADABLE]))
    told = "A touchdown is found where a prediction before it gave its time to 20 ms."
    assert many.startswith(f"2 of 3 found: 1 missed, 1 false alarm. {told} 1 more impact cannot be seen")
    assert headlines_of([WALK_FOUND])[0].more == "None missed, no false alarm."
    assert "The mode is right in 1 of 2." in right
    assert right.endswith("The time predicted 20 to 30 ms ahead is 2 ms wrong in the median.")
    both = [one.more for one in headlines_of([TRUE, TOSSES])]
    assert both[0].endswith("The truth is known of 1 of 2 bags.")
    assert "to the true ones, or the measured ones where a bag does not tell them" in both[1]
    assert headlines_of([TOSSES])[0].more == f"1 more could not be, because {WHY['TOO_SLOW']}."
    assert soon.startswith("59.5 ms ahead")
    assert cost.startswith("20 us a sample")
    assert lead_of([TRUE, UNREADABLE]).endswith("1 of them could not be read.")
    # The error of the time is that of the first span from 20 ms ahead on that has any.
    later = {**TRUE, "time_errors_ahead": spans({0.0: [0.5], 0.03: [0.004]})}
    assert headlines_of([later])[1].more.endswith("The time predicted 30 to 40 ms ahead is 4 ms wrong in the median.")


def marks(figure: dict[str, Any]) -> dict[str, list[tuple[float, int]]]:
    """The marks of a timeline by their names: where each stands, in ms and in which lane."""
    return {
        trace["name"]: [(round(1e3 * x), -y) for x, y in zip(trace["x"], trace["y"], strict=True)]
        for trace in figure["data"]
        if trace["type"] == "scatter" and trace["mode"] == "markers" and "error_y" not in trace
    }


def test_a_timeline_has_what_was_predicted_above_what_came(page: PageReader) -> None:
    figure = page.figures["simulated.mcap"]
    assert figure["layout"]["yaxis"]["ticktext"] == ["cube predicted", "true", "error to 2.0 %"]
    assert marks(figure) == {
        "STOP": [(500, 0)],
        "SLIDE": [(500, 1)],
        "PIVOT": [(101, 0), (100, 1)],
        "missed": [(700, 1)],
        "false alarm": [(800, 0)],
        "STOP, faint": [(900, 0)],
        "PIVOT, faint": [(900, 1)],
    }
    known = traces(figure)
    # Of the trace, not of each mark: faint ones on each other are no darker than one.
    assert [known[name]["opacity"] for name in ("STOP", "STOP, faint")] == [1.0, 0.3]
    assert known["false alarm"]["text"] == ["false alarm, predicted for 0.800 s: STOP"]
    assert known["STOP"]["text"][0].endswith(
        "first announced 60 ms ahead<br>the last predicted time is less than 1 us off"
    )
    # Back to when each was first announced.
    assert known["announced until it came"]["x"][:3] == [0.041, 0.101, None]
    # Against the truth, as in the headline, and not against the samples after it (0.1 and 0.3).
    assert known["error"]["text"] == ["relative error 2.0 %"] * 2
    tosses = page.figures["tosses.mcap"]
    assert tosses["layout"]["yaxis"]["ticktext"] == ["cube predicted", "error to 20.0 %", "not compared"]
    assert traces(tosses)["error"]["error_y"]["arrayminus"] == pytest.approx([0.4, 0.8])
    assert page.tables["when"][0][1:] == [
        ["0.700 s", "cube", "missed", "PIVOT"],
        ["0.800 s", "cube", "false alarm", "STOP"],
    ]


def test_the_timeline_of_a_walk_has_lanes_for_each_foot_with_its_stances(page: PageReader) -> None:
    figure = page.figures["walk.bag"]
    assert figure["layout"]["yaxis"]["ticktext"] == [
        *("left predicted", "stands", "truth"),
        *("right predicted", "stands", "truth"),
    ]
    assert marks(figure) == {"STOP": [(696, 0), (302, 3)], "missed": [(900, 3)]}
    bars = [trace for trace in figure["data"] if trace["type"] == "bar"]
    assert [trace["base"] for trace in bars[2:]] == [[0.3], [0.3]]
    assert bars[2]["x"] == pytest.approx([0.6])
    table = page.tables["when"][1]
    assert table[1][3] == "+2.0 ms"
    assert table[3][2:] == ["not announced", "–", "0.100 m/s", "5.00 N s", "STOP", "–"]
    assert [row[5] for row in table[1:]] == ["5.00 N s 13.00 N s at other feet", "5.00 N s", "5.00 N s"]


def test_a_timeline_is_without_its_long_pauses_where_they_are_most_of_it() -> None:
    at = (100, 300, 60_260, 60_400)  # ms, announced 50 ms before
    page = read([answer(touchdowns=[touchdown(one) for one in at], end=60_500 * 10**6)])
    figure = page.figures["run.mcap"]
    # What is kept begins at a whole tenth of a second, and 0.1 s or more before what comes after the pause.
    assert figure["layout"]["meta"]["pieces"] == [[0.0, 0.4, 0.0], [60.1, 60.5, 0.4]]
    assert marks(figure)["PIVOT"] == [(100, 0), (300, 0), (560, 0), (700, 0)]
    assert [one["x0"] for one in figure["layout"]["shapes"]] == [0.4]
    assert "Pauses are cut out, each at a dotted line: 800 ms of 60.5 s are shown." in page.text
    walk = answer(touchdowns=[touchdown(one) for one in (100, 1_900, 3_800)], end=5_000 * 10**6)
    assert "meta" not in read([walk]).figures["run.mcap"]["layout"]


def test_where_marks_are_too_many_those_that_do_not_count_are_left_out() -> None:
    faint = [touchdown(0.3 * k + 0.1, scored=False, flags=["TOO_SLOW"]) for k in range(10)]
    page = read([answer(touchdowns=[*faint, *(touchdown(0.3 * k) for k in range(MOST + 1))])])
    assert "There are too many marks: of each lane the first 3,000 are drawn, and no faint ones." in page.text
    assert {name: len(places) for name, places in marks(page.figures["run.mcap"]).items()} == {"PIVOT": MOST}


def test_points_stand_where_measured_and_predicted_velocities_say(page: PageReader) -> None:
    along, turning = (read([TOSSES]).figures[title] for title in list(page.figures)[3:5])
    assert traces(along)["PIVOT (1)"]["x"] == [0.4]
    assert traces(along)["PIVOT (1)"]["y"] == [0.5]
    assert [(trace["x"], trace["y"]) for trace in turning["data"][1:]] == [([-0.2], [-0.2]), ([-0.1], [-0.2])]
    assert traces(along)["PIVOT (1)"]["text"] == [
        "0.100 s<br>measured 0.400, predicted 0.500 m/s<br>relative error 10.0 %"
    ]
    rows = read([TOSSES]).tables["velocities"][0][1:]
    assert [row[:2] for row in rows] == [["0.300 s", "STOP"], ["0.100 s", "PIVOT"]]
    assert "Half of the points are within 0.050 m/s of the line" in read([TOSSES]).text
    many = read([answer(touchdowns=[touchdown(k) for k in range(MANY + 1)])])
    squares = many.figures["Along the support: vx"]["data"][1]
    assert squares["type"] == "histogram2d"
    assert len(squares["x"]) == MANY + 1


def test_the_page_says_why_measured_velocities_differ_more_than_true_ones(page: PageReader) -> None:
    said = "90 % of the predictions are within 2.0 % of them, but within 28.0 % of the measured ones."
    assert said in page.text
    assert "The errors of the velocities are against the measured ones, which are not the true ones." in page.text
    none_found = answer(
        touchdowns=[touchdown(100)],
        true_touchdowns=[true(700, "PIVOT", None, None)],
        truth={"touchdowns": 1, "missed": 1, "false": 0, "unresolved": 0, "median_time_error": None},
    )
    for one in (TOSSES, none_found):
        assert "The true velocities are known too" not in read([one]).text


def test_modes_are_confused_as_the_truth_tells_and_what_no_record_shows_does_not_count() -> None:
    page = read([TRUE])
    assert page.tables["modes"] == [
        [
            ["true mode", "STOP", "PIVOT", "missed"],
            ["SLIDE", "1", "–", "–"],
            ["PIVOT", "–", "1", "1"],
            ["false alarm", "1", "–", "–"],
        ]
    ]
    assert "right in 1 of the 2 true touchdowns that were found. Besides: 1 missed, 1 false alarm." in page.text


def test_without_a_truth_the_page_says_that_modes_cannot_be_told() -> None:
    page = read([TOSSES])
    assert "does not tell in which modes" in page.text
    assert page.tables["modes"][0][1:] == [
        ["STOP", "1", "1", "20.0 %", "20.0 %"],
        ["PIVOT", "2", "1", "10.0 %", "10.0 %"],
    ]
    assert read([WALK]).tables["modes"][0][1:] == [["STOP", "3", "0", "–", "–"]]


def test_errors_ahead_and_costs_are_told_in_numbers(page: PageReader) -> None:
    ahead = traces(read([TRUE]).figures["Velocities after the impact"])
    assert (ahead["median"]["x"], ahead["median"]["y"]) == ([5.0], [pytest.approx(20.0)])
    assert ahead["90 % below"]["y"] == [pytest.approx(28.0)]
    # Of several bags a bin of the merged spreads is 2.3 % wide.
    assert traces(page.figures["Velocities after the impact"])["90 % below"]["y"] == [pytest.approx(30.0, rel=0.024)]
    time = traces(page.figures["Time of the touchdown"])
    assert (time["median"]["x"], time["median"]["y"]) == ([25.0], [pytest.approx(2.0)])
    one = read([TOSSES])
    assert one.tables["cost"][0][1] == ["5 samples", "20 us", "192 us", "289 us", "300 us"]
    (bars,) = one.figures["Time for a sample"]["data"]
    assert bars["y"] == [1, 2, 1, 1]
    assert bars["text"][:2] == ["10 us to 12.6 us: 1 sample", "20 us to 25.1 us: 2 samples"]


def test_what_could_not_be_used_is_told_with_its_reason_and_its_remedy() -> None:
    page = read([{**TOSSES, "damaged": "it ends early", "notes": ["took odom"]}, TRUE, UNREADABLE])
    lost, others, remarks = (table[1:] for table in page.tables["unused"])
    assert lost == [["odom not finite", "a field is NaN or infinite; look at its source", "2 of 20, 10.0 %"]]
    assert others == [[WHY["TOO_SLOW"], "1"]]
    assert remarks == [
        ["broken.mcap unreadable", UNREADABLE["error"]],
        ["tosses.mcap damaged", "it ends early"],
        ["tosses.mcap note", "took odom"],
    ]
    assert "1 bag could be read in part only" in page.text
    assert set(WHY) == {reason.name for reason in Leftover if reason}


def test_a_row_for_each_bag_leads_to_its_timeline(page: PageReader) -> None:
    head, *rows = page.tables["bags"][0]
    assert head == ["bag", "touchdowns", "found", "velocity error", "time error", "first ahead", "a sample"]
    assert rows[0][2] == "2 of 3 1 false alarm"
    assert rows[3][0] == "broken.mcap could not be read"
    assert [link for link in page.links if link.startswith("#bag-")] == ["#bag-1", "#bag-2", "#bag-3"]
    assert "bags" not in read([TRUE]).tables


def test_of_many_bags_the_worst_are_listed_and_the_page_stays_small() -> None:
    many = [
        answer(f"day/{k}.mcap", touchdowns=[touchdown(100 + k, relative_error=0.001 * (k + 1))], notes=["took odom"])
        for k in range(LISTED + 10)
    ]
    page = read([*many, UNREADABLE])
    names = [row[0] for row in page.tables["bags"][0][1:]]
    assert names[:2] == ["broken.mcap could not be read", f"{LISTED + 9}.mcap"]
    assert len(names) == LISTED
    assert len([title for title in page.figures if title.endswith(".mcap")]) == DRAWN
    assert page.tables["unused"][-1][2][0] == f"0.mcap and {LISTED + 9} more bags note"


def test_what_the_scene_leaves_out_stands_after_what_it_takes_in(page: PageReader) -> None:
    rows = page.tables["scene"][0][1:]
    states = [row[0].endswith("left out") for row in rows]
    assert states == sorted(states)
    assert {"moving support left out", "friction"} <= {row[0] for row in rows}
    assert "scene" not in read([TRUE]).tables


def test_answers_that_are_kept_make_the_same_page_and_take_little_memory() -> None:
    kept = Kept()
    for one in (TOSSES, UNREADABLE):
        kept.append(one)
    assert page_of_replay(kept, script="") == page_of_replay([TOSSES, UNREADABLE], script="")
    bag = answer("run.mcap", touchdowns=[touchdown(100 + j) for j in range(50)])
    tracemalloc.start()
    try:
        for _ in range(200):
            kept.append(bag)
        assert sum(len(one["touchdowns"]) for one in kept if "touchdowns" in one) == 200 * 50 + 3
        assert tracemalloc.get_traced_memory()[0] < 200 * 3_000
    finally:
        tracemalloc.stop()
    assert kept[-1] == bag


@pytest.mark.parametrize(
    ("part", "words"),
    [(0.0, "0.0 %"), (8e-15, "< 0.01 %"), (0.00123, "0.12 %"), (0.0609, "6.1 %"), (0.105, "10.5 %"), (None, "–")],
)
def test_parts_of_one_read_as_in_the_tables_of_the_terminal(part: float | None, words: str) -> None:
    assert part_words(part) == words


def test_times_have_the_unit_that_suits_and_nothing_is_told_below_a_microsecond() -> None:
    assert [time_words(one) for one in (0.0, 0.00123, 5681.4, None)] == ["less than 1 us", "1.23 ms", "5,681 s", "–"]


def test_the_page_of_a_record_without_anything_says_so() -> None:
    page = read([answer(cost_us=None, begin=None, end=None, relative_errors_ahead=[], unpredictable="no message")])
    assert "No touchdown was predicted" in page.text
    assert "no message" in page.text
    assert page.figures == {}
