"""The page of a replay: what it says and draws of small answers, in exact numbers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from read_page import PageReader, traces
from replay_answers import TOSSES, TRUE, UNREADABLE, WALK, answer, landing, touchdown
from replay_answers import ahead as spans

from impact_predictor.errors import InputError
from impact_predictor.prediction.types import Leftover
from impact_predictor.report.page import part_words, time_words
from impact_predictor.report.page.facts import BagAnswer, ReplayFacts
from impact_predictor.report.page.replay import DRAWN, page_of_replay, write_replay_page
from impact_predictor.report.page.timeline import MANY
from impact_predictor.report.summary import WHY

ALL = [TRUE, WALK, TOSSES, UNREADABLE]
WALK_FOUND = WALK | {"truth": {"touchdowns": 2, "missed": 0, "false": 0, "unresolved": 0}}


def read(answers: Sequence[BagAnswer]) -> PageReader:
    """The page of some answers, without the script of plotly."""
    return PageReader(page_of_replay(answers))


@pytest.fixture(scope="module")
def page() -> PageReader:
    return read(ALL)


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
    write_replay_page(tmp_path / "week", ALL)
    files = {file.name: file for file in (tmp_path / "week").iterdir()}
    assert sorted(files) == ["bag-1.html", "bag-2.html", "bag-3.html", "index.html", "plotly.min.js"]
    for name in set(files) - {"plotly.min.js"}:
        page = PageReader(files[name].read_text(encoding="utf-8"))
        assert page.sources == ["plotly.min.js"]
        assert {link for link in page.links if not link.startswith("#")} <= set(files)
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match=r"the folder .*taken cannot be made: File exists; give another name"):
        write_replay_page(tmp_path / "taken", ALL)


def test_all_text_of_a_bag_is_escaped_on_the_page_and_in_its_figures() -> None:
    evil = '<script>alert("x")</script>'
    marks = [touchdown(100, body=evil), landing(300, evil, 0.0)]
    given = answer(f"{evil}.mcap", touchdowns=marks, notes=[evil], damaged=evil)
    text = page_of_replay([given, {**UNREADABLE, "error": evil}])
    assert "<script>alert" not in text
    page = PageReader(text)
    assert page.text.count(evil) >= 3
    (lanes,) = [figure["layout"]["yaxis"]["ticktext"] for title, figure in page.figures.items() if ".mcap" in title]
    assert lanes[0] == '&lt;script&gt;alert("x")&lt;/script&gt; predicted'


def facts(*answers: BagAnswer) -> dict[str, str]:
    return {fact.question: f"{fact.answer}: {fact.more}" for fact in ReplayFacts(answers).headlines()}


def test_the_head_says_how_many_how_right_how_early_and_at_what_cost(page: PageReader) -> None:
    assert facts(TRUE, UNREADABLE) == {
        "touchdowns predicted": "2: 2 compared with measured velocities",
        "true ones found": "2 of 3: 1 missed, 1 false alarm; 1 more, too slow or too close to be seen, do not count",
        "velocity error": "2.0 %: median of 2 touchdowns against the true velocities; 90 % below 2.0 %. "
        "The mode is right in 1 of 2.",
        "time error": "2 ms: median 20 to 30 ms ahead; 90 % below 2.8 ms",
        "first ahead": "50 ms: median; 90 % at least 50 ms, the latest 50 ms",
        "cost of a sample": "20 us: median; 99 % below 289 us",
    }
    tosses = facts(TOSSES)
    assert (
        tosses["touchdowns predicted"]
        == f"3: 2 compared with measured velocities; most of the others not, as {WHY['TOO_SLOW']}"
    )
    assert tosses["velocity error"].startswith("15.0 %: median of 2 touchdowns against the measured velocities")
    assert (tosses["true ones found"], tosses["time error"][:1]) == ("–: ", "–")
    # Against the truth where a bag tells it (0.02 twice), else against what was measured (0.1 and 0.2).
    assert facts(TRUE, TOSSES)["velocity error"].startswith("6.0 %")
    assert facts(WALK)["true ones found"] == "2 of 3: of the landings that the feet's motion shows"
    assert facts(WALK_FOUND)["true ones found"] == "2 of 2: 0 missed, 0 false alarms"
    # The error of the time is that of the first span from 20 ms ahead on that has any.
    later = {**TRUE, "time_errors_ahead": spans({0.0: [0.5], 0.03: [0.004]})}
    assert facts(later)["time error"].startswith("4 ms: median 30 to 40 ms ahead")
    head = "touchdowns predicted 2, true ones found 2 of 3, velocity error 2.0 %, time error 2 ms, first ahead 50 ms"
    assert head in read([TRUE]).text
    assert "4 records, 30 samples, went through the predictor as if live." in page.text


def marks(figure: dict[str, Any]) -> dict[str, list[tuple[float, int]]]:
    """The marks of a timeline by their names: where each stands, in ms and in which lane."""
    return {
        trace["name"]: [(round(1e3 * x), -y) for x, y in zip(trace["x"], trace["y"], strict=True)]
        for trace in figure["data"]
        if trace["type"] != "bar"
    }


def test_a_timeline_has_what_was_predicted_above_what_came(page: PageReader) -> None:
    figure = page.figures["simulated.mcap"]
    assert figure["layout"]["yaxis"]["ticktext"] == ["cube predicted", "true"]
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
    assert known["false alarm"]["hovertext"] == ["0.800 s: false alarm, STOP was predicted"]
    # Against the truth, as in the headline, and not against the samples after it (0.1 and 0.3).
    off = "announced 60 ms ahead, the last predicted time +0.0 ms off"
    assert known["STOP"]["hovertext"] == [f"0.500 s: STOP<br>{off}<br>relative error 2.0 %"]
    # Back to when each was first announced.
    assert known["PIVOT"]["error_x"]["arrayminus"] == pytest.approx([0.06, 0.0])
    tosses = page.figures["tosses.mcap"]
    assert tosses["layout"]["yaxis"]["ticktext"] == ["cube predicted", "not compared"]
    assert traces(tosses)["PIVOT, faint"]["hovertext"][0].endswith("not compared: too slow")


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
    known = traces(figure)
    speed, impulse = "right lands with 0.100 m/s", "impulse 5.00 N s"
    assert known["missed"]["hovertext"] == [f"0.900 s: {speed}<br>{impulse}<br>not announced"]
    others = f"{impulse}<br>impulse 13.00 N s at other feet"
    off = "STOP<br>announced 50 ms ahead, the last predicted time +2.0 ms off"
    assert known["STOP"]["hovertext"][1] == f"0.302 s: {speed}<br>{others}<br>{off}"


def test_points_stand_where_measured_and_predicted_velocities_say() -> None:
    along, turning = list(read([TOSSES]).figures.values())[1:3]
    assert traces(along)["PIVOT (1)"]["x"] == [0.4]
    assert traces(along)["PIVOT (1)"]["y"] == [0.5]
    assert [(trace["x"], trace["y"]) for trace in turning["data"][1:]] == [([-2.0], [-2.0]), ([-1.0], [-2.0])]
    assert traces(along)["PIVOT (1)"]["hovertext"] == ["tosses.mcap, 0.100 s, cube<br>relative error 10.0 %"]
    # The graphics card draws many points, and a browser draws few without one.
    many = read([answer(touchdowns=[touchdown(k) for k in range(MANY + 1)])])
    assert along["data"][-1]["type"] == "scatter"
    for title in ("run.mcap", "Along the support"):
        trace = many.figures[title]["data"][-1]
        assert (trace["type"], len(trace["x"])) == ("scattergl", MANY + 1)


def test_modes_are_confused_as_the_truth_tells_and_what_no_record_shows_does_not_count() -> None:
    page = read([TRUE])
    (head, *rows) = page.tables["modes"][0]
    assert head == ["true mode", "STOP", "PIVOT", "missed"]
    assert [[row[0].split()[0], *row[1:]] for row in rows] == [
        ["SLIDE", "1", "0", "0"],
        ["PIVOT", "0", "1", "1"],
        ["false", "1", "0", "0"],
    ]
    assert "The mode is right in 1 of 2." in page.text


WHOLE = touchdown(
    200,
    scored=False,
    relative_error=None,
    kind="flight>corner",
    before_twist_6d=[0.0, 2.0, -1.0, 0.0, 0.0, 0.0],
    predicted_twist_6d=[0.1, 1.5, 0.4, -3.0, 0.0, 0.0],
    measured_twist_6d=[0.2, 1.25, 0.5, -4.0, 0.0, 0.0],
    relative_error_6d=0.125,
    not_scored_6d=[],
    simple_errors_6d=[0.9, 0.8, 0.3, 0.4, 0.2],
    lift_old=[True, False, None],
    time_error=0.001,
)


def test_whole_twists_are_drawn_along_the_velocity_before_and_have_tables_beside_simple_answers() -> None:
    kinds = {"flight>corner": {"touchdowns": 3, "announced": 2}, "all": {"touchdowns": 3, "announced": 2}}
    page = read([answer(touchdowns=[WHOLE], kinds=kinds)] * 2)
    figures = page.figures
    compared = "4 compared with measured velocities, 2 as whole twists and the others in the impact plane alone"
    planar = answer(touchdowns=[WHOLE, touchdown(300)])
    assert facts(planar, planar)["touchdowns predicted"].endswith(compared)
    along, up, turning = (traces(figures[name])["PIVOT (2)"] for name in ("Along the support", "Upwards", "Turning"))
    assert [(one["x"][0], one["y"][0]) for one in (along, up, turning)] == [(1.25, 1.5), (0.5, 0.4), (4.0, 3.0)]
    skill, lifts = page.tables["skill"]
    assert skill[1] == [
        "flight>corner",
        "6",
        "66.7",
        "2",
        "12.5",
        "12.5",
        "90.0",
        "80.0",
        "30.0",
        "40.0",
        "20.0",
        "1.0",
    ]
    assert lifts[1:] == [["old lifted", "0", "0", "-"], ["old stayed", "2", "0", ""]]
    assert "modes" not in page.tables
    assert "skill" not in read([WALK]).tables


def test_errors_ahead_and_costs_are_told_in_numbers(page: PageReader) -> None:
    title = "Velocities in the impact plane, against measured ones"
    ahead = traces(read([TRUE]).figures[title])
    assert (ahead["median"]["x"], ahead["median"]["y"]) == ([5.0], [pytest.approx(20.0)])
    assert ahead["90 % below"]["y"] == [pytest.approx(28.0)]
    # Of several bags a bin of the merged spreads is 2.3 % wide.
    assert traces(page.figures[title])["90 % below"]["y"] == [pytest.approx(30.0, rel=0.024)]
    time = traces(page.figures["Time of the touchdown"])
    assert (time["median"]["x"], time["median"]["y"]) == ([25.0], [pytest.approx(2.0)])


def test_what_could_not_be_used_is_told_with_its_reason_and_its_remedy() -> None:
    page = read([{**TOSSES, "damaged": "it ends early", "notes": ["took odom"]}, TRUE, UNREADABLE])
    lost, others, remarks = (table[1:] for table in page.tables["unused"])
    assert lost == [["odom not finite", "a field is NaN or infinite; look at its source", "2 of 20, 10.0 %"]]
    assert others == [[WHY["TOO_SLOW"], "1"]]
    assert remarks == [
        ["broken.mcap could not be read", "it cannot be read: it is empty"],
        ["tosses.mcap damaged", "it ends early"],
        ["tosses.mcap note", "took odom"],
    ]
    assert set(WHY) == {reason.name for reason in Leftover if reason}
    assert "Everything could be used." in read([answer(statuses={"ACCEPTED": 10})]).text


def test_a_row_for_each_bag_leads_to_its_timeline_and_the_worst_stand_first(page: PageReader) -> None:
    head, *rows = page.tables["bags"][0]
    assert head[:3] == ["bag", "touchdowns predicted", "true ones found"]
    assert rows[0] == ["broken.mcap could not be read"]
    assert rows[1][:2] == ["simulated.mcap", "2"]
    assert rows[1][2].startswith("2 of 3 1 missed, 1 false alarm")
    assert [link for link in page.links if link.startswith("#bag-")] == ["#bag-1", "#bag-3", "#bag-2"]
    assert "bags" not in read([TRUE]).tables
    # Names are as short as they can be, and no two are the same.
    paths = ["/a/one/run.mcap", "/a/two/run.mcap", "/b/two/run.mcap", "x.bag"]
    rows = read([answer(path) for path in paths]).tables["bags"][0][1:]
    assert [row[0] for row in rows] == ["one/run.mcap", "a/two/run.mcap", "b/two/run.mcap", "x.bag"]


def test_of_many_bags_all_are_listed_and_the_worst_are_drawn() -> None:
    number = DRAWN + 30
    many = [
        answer(f"day/{k}.mcap", touchdowns=[touchdown(100 + k, relative_error=0.001 * (k + 1))], notes=["took odom"])
        for k in range(number)
    ]
    page = read([*many, UNREADABLE])
    names = [row[0] for row in page.tables["bags"][0][1:]]
    assert names[:2] == ["broken.mcap could not be read", f"{number - 1}.mcap"]
    assert len(names) == number + 1
    drawn = [title for title in page.figures if title.endswith(".mcap")]
    assert drawn == [f"{number - 1 - k}.mcap" for k in range(DRAWN)]
    assert page.tables["unused"][-1][2][0] == f"0.mcap and {number - 1} more bags note"


def test_parts_and_times_are_told_to_what_can_be_told_apart() -> None:
    parts = {0.0: "0.0 %", 8e-15: "< 0.01 %", 0.00123: "0.12 %", 0.0609: "6.1 %", 0.105: "10.5 %", None: "–"}
    assert {part: part_words(part) for part in parts} == parts
    times = {0.0: "less than 1 us", 0.00123: "1.23 ms", 5681.4: "5,681 s", None: "–"}
    assert {time: time_words(time) for time in times} == times


def test_the_page_of_a_record_without_anything_says_so() -> None:
    page = read([answer(cost_us=None, begin=None, end=None, relative_errors_ahead=[], unpredictable="no message")])
    assert "No touchdown was predicted" in page.text
    assert "no message" in page.text
    assert page.figures == {}
