"""The page of a replay: what it says of small answers, in exact numbers, and that it stays small and whole."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from itertools import pairwise
from math import inf
from pathlib import Path

import pytest
from replay_answers import TOSSES, TRUE, UNREADABLE, WALK, answer, landing, touchdown, true
from replay_answers import ahead as spans

from impact_predictor.mechanics.types import Mode
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.types import Leftover
from impact_predictor.report.page.replay import page_of_replay, write_replay_page
from impact_predictor.report.page.replays.answers import (
    NOTHING,
    Arrived,
    Refused,
    ahead,
    announced,
    arrived,
    badness,
    confusion,
    names_of,
    refused,
    uncompared,
    velocity_errors,
)
from impact_predictor.report.page.replays.bags import LISTED, bags
from impact_predictor.report.page.replays.extent import Extent, Piece, extent_of, nice, times_of, zooms_of
from impact_predictor.report.page.replays.heads import headlines_of, lead_of, title_of
from impact_predictor.report.page.replays.lanes import FALSE, MISSED, rows_of
from impact_predictor.report.page.replays.modes import modes
from impact_predictor.report.page.replays.spreads import AGAINST_MEASURED, bars_of, cost_section, early
from impact_predictor.report.page.replays.timeline import MOST, timeline
from impact_predictor.report.page.replays.unused import scene, unused
from impact_predictor.report.page.replays.velocities import (
    Pair,
    limits_of,
    pairs_of,
    squares_of,
    velocities,
    worst_table,
)
from impact_predictor.report.page.replays.when import SHOWN, anchors_of, cut_words, numbers, when
from impact_predictor.report.page.replays.words import MODES, percent, seconds_words
from impact_predictor.report.summary import WHY

MANY = [
    answer(f"day/{k}.mcap", touchdowns=[touchdown(100 + k, relative_error=0.001 * (k + 1))], notes=["took odom"])
    for k in range(LISTED + 10)
]
WALK_FOUND = WALK | {"truth": {"touchdowns": 2, "missed": 0, "false": 0, "unresolved": 0}}


class Outline(HTMLParser):
    """The attributes of all elements."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.attributes: list[dict[str, str | None]] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag not in ("link", "img", "iframe", "object", "base")
        self.attributes.append(dict(attrs))


@pytest.fixture(scope="module")
def page() -> str:
    return page_of_replay([TRUE, WALK, TOSSES, UNREADABLE])


def test_the_page_refers_to_nothing_outside_itself_and_to_what_stands_on_it_once(page: str) -> None:
    attributes = Outline(page).attributes
    assert "@import" not in page
    assert not any("src" in one for one in attributes)
    identifiers = [one["id"] for one in attributes if "id" in one]
    assert len(identifiers) == len(set(identifiers))
    references = {str(one["href"]) for one in attributes if "href" in one}
    assert all(one.startswith("#") for one in references)
    assert {one[1:] for one in references} <= set(identifiers)


def test_all_text_of_a_bag_is_escaped() -> None:
    evil = '<script>alert("x")</script>'
    given = answer(evil, touchdowns=[touchdown(100, body=evil), landing(300, evil, 0.0)], notes=[evil], damaged=evil)
    text = page_of_replay([given, {**UNREADABLE, "error": evil}])
    assert "<script>alert" not in text
    assert "&lt;script&gt;" in text


def test_names_are_as_short_as_they_can_be_and_no_two_are_the_same() -> None:
    paths = ["/a/one/run.mcap", "/a/two/run.mcap", "/b/two/run.mcap", "x.bag"]
    assert names_of([answer(path) for path in paths]) == ["one/run.mcap", "a/two/run.mcap", "b/two/run.mcap", "x.bag"]


def test_the_numbers_of_all_bags_are_those_of_all_their_touchdowns() -> None:
    both = [TRUE, TOSSES]
    # Against the truth where a bag tells it (0.02 twice), else against what was measured (0.1 and 0.2).
    assert (velocity_errors(both).number, velocity_errors(both).median) == (4, pytest.approx(0.06))
    assert arrived(both) == Arrived(3, 2, 1)
    assert arrived([TOSSES]) is None
    assert announced([*both, WALK]) == pytest.approx([0.059, 0.06, *[0.05] * 4])
    assert uncompared(both) == {"TOO_SLOW": 1}
    (first,) = [one for one in ahead(both, "relative_errors_ahead") if one.errors.number]
    assert (first.begin, first.end, first.errors.number) == (0.0, 0.01, 4)
    assert first.errors.p90 == pytest.approx(0.3, rel=0.024)  # a bin of the merged spreads is 2.3 % wide
    assert refused(both) == [Refused("odom", "NOT_FINITE", 2, 20)]


def test_modes_are_confused_as_the_truth_tells_and_what_no_record_shows_does_not_count() -> None:
    assert confusion([TRUE]) == {
        ("PIVOT", "PIVOT"): 1,
        ("SLIDE", "STOP"): 1,
        ("PIVOT", NOTHING): 1,
        (NOTHING, "STOP"): 1,
    }
    section = modes([TRUE])
    assert section is not None
    (table,) = section.tables
    assert table.head == ["true mode", "STOP", "PIVOT", "missed"]
    rows = {row[0].text: [cell.text for cell in row[1:]] for row in table.rows}
    assert rows == {"SLIDE": ["1", "–", "–"], "PIVOT": ["–", "1", "1"], "false alarm": ["1", "–", "–"]}
    assert [cell.css_class for row in table.rows for cell in row].count("best") == 1
    assert section.words == [
        "The mode is right in 1 of the 2 true touchdowns that were found. Besides: 1 missed, 1 false alarm."
    ]


def test_without_a_truth_the_page_says_that_modes_cannot_be_told() -> None:
    section = modes([TOSSES])
    assert section is not None
    assert "does not tell" in section.words[0]
    (table,) = section.tables
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["STOP", "1", "1", "20.0\N{NO-BREAK SPACE}%", "20.0\N{NO-BREAK SPACE}%"],
        ["PIVOT", "2", "1", "10.0\N{NO-BREAK SPACE}%", "10.0\N{NO-BREAK SPACE}%"],
    ]
    walking = modes([WALK])
    assert walking is not None
    assert [[cell.text for cell in row] for row in walking.tables[0].rows] == [["right", "2"], ["left", "1"]]
    assert confusion([{**WALK, "true_touchdowns": [true(300, None, 300, "STOP")]}]) == {}


def test_the_error_of_the_time_is_that_of_the_first_span_from_20_ms_ahead_on_that_has_any() -> None:
    later = {**TRUE, "time_errors_ahead": spans({0.0: [0.5], 0.03: [0.004]})}
    (right,) = (one.why for one in headlines_of([later]) if one.term == "How right")
    assert right.replace("\N{NO-BREAK SPACE}", " ").endswith(
        "The time told 30 to 40 ms ahead is 4 ms wrong in the median."
    )


def test_the_headlines_say_how_many_how_right_and_how_early() -> None:
    def neat(text: str) -> str:
        return text.replace("\N{NO-BREAK SPACE}", " ")

    within = "half of the last predictions within"
    assert neat(title_of([TOSSES])) == f"2 touchdowns first predicted 50 ms ahead, {within} 15.0 %"
    assert neat(title_of([TRUE])) == f"2 of 3 touchdowns first predicted 60 ms ahead, {within} 2.0 %"
    assert neat(title_of([TRUE, TOSSES])) == f"4 touchdowns first predicted 54 ms ahead, {within} 6.0 %"
    assert neat(title_of([WALK])) == "2 of 3 landings first predicted 50 ms ahead"
    assert title_of([answer(), UNREADABLE]) == "No touchdown was predicted"
    many, right, soon, cost = (neat(f"{one.name}: {one.why}") for one in headlines_of([TRUE, UNREADABLE]))
    told = "A touchdown is found where a prediction before it told its time to 20 ms."
    assert many.startswith(f"2 of 3 found: 1 missed, 1 false alarm. {told} 1 more impact cannot be seen")
    assert headlines_of([WALK_FOUND])[0].why == "None missed, no false alarm."
    assert "The mode is right in 1 of 2." in right
    assert right.endswith("The time told 20 to 30 ms ahead is 2 ms wrong in the median.")
    both = [neat(one.why) for one in headlines_of([TRUE, TOSSES])]
    assert both[0].endswith("The truth is known of 1 of 2 bags.")
    assert "to the true ones, or the measured ones where a bag does not tell them" in both[1]
    assert headlines_of([TOSSES])[0].why == f"1 more could not be, because {WHY['TOO_SLOW']}."
    assert soon.startswith("60 ms ahead")
    assert cost.startswith("20 µs a sample")
    assert lead_of([TRUE, UNREADABLE]).endswith("1 of them could not be read.")


def test_a_timeline_has_what_was_predicted_above_what_came() -> None:
    (cube,) = rows_of(TRUE)
    told, came, error = cube.lanes
    assert [(spot.stamp // 10**6, spot.mark, spot.faint) for spot in told.spots] == [
        (101, "PIVOT", False),
        (500, "STOP", False),
        (800, FALSE, False),
        (900, "STOP", True),
    ]
    assert [(spot.stamp // 10**6, spot.mark) for spot in came.spots] == [
        (100, "PIVOT"),
        (500, "SLIDE"),
        (700, MISSED),
        (900, "PIVOT"),
    ]
    # Against the truth, as in the headline, and not against the samples after it (0.1 and 0.3).
    assert [stem.value for stem in error.stems] == [0.02, 0.02]
    assert [stem.value for stem in rows_of(TOSSES)[0].lanes[1].stems] == [0.1, 0.2]
    assert [lane.name for lane in rows_of(TOSSES)[0].lanes] == ["predicted", "error", "not compared"]


def test_the_timeline_of_a_walk_has_a_row_for_each_foot_with_its_stances() -> None:
    left, right = rows_of(WALK)
    assert (left.name, right.name) == ("left", "right")
    assert [lane.name for lane in right.lanes] == ["predicted", "stands", "truth"]
    told, stands, _ = right.lanes
    assert [(spot.stamp // 10**6, spot.mark) for spot in told.spots] == [(302, "STOP"), (900, MISSED)]
    assert [(bar.begin, bar.end) for bar in stands.bars] == [(300 * 10**6, 900 * 10**6)]
    table = numbers(WALK)
    assert table is not None
    assert table.rows[0][3].text == "+2.0\N{NO-BREAK SPACE}ms"
    assert [cell.text for cell in table.rows[2][2:]] == ["not announced", "–", "0.100 m/s", "5.00 N s"]
    assert [row[5].below for row in table.rows] == ["13.00 N s at other feet", "", ""]


def test_the_key_of_the_timelines_has_the_marks_that_are_drawn_and_no_others() -> None:
    assert len(WALK["touchdowns"]) == 3  # two STOP, foretold as NO_IMPACT, and one that nothing announced
    for one, drawn in ((WALK, {"STOP"}), (TRUE, {"PIVOT", "STOP", "SLIDE"})):
        section = when([one], anchors_of([one]))
        assert section is not None
        assert {key.name for key in section.key} == drawn


def test_where_marks_are_too_many_for_one_each_the_page_says_that_columns_count_them() -> None:
    crowd = answer(touchdowns=[touchdown(k) for k in range(MOST + 1)])
    section = when([crowd], anchors_of([crowd]))
    assert section is not None
    assert section.key == []
    assert section.figures[0].caption.startswith("There are more than 3,000 marks")
    assert "#mark-" not in str(section.figures[0].drawings[-1])


def test_faint_marks_on_each_other_are_no_darker_than_one_and_lie_below_what_counts() -> None:
    one = answer(touchdowns=[], true_touchdowns=[true(100 + k, "PIVOT", None, None, shown=k < 2) for k in range(4)])
    rows = rows_of(one)
    drawn = str(timeline(rows, extent_of(one, rows), "", ""))
    groups = re.findall(r'<g class="(marks[^"]*)"[^>]*>(.*?)</g>', drawn, re.DOTALL)
    assert [(name, shapes.count("<use")) for name, shapes in groups] == [("marks faint", 2), ("marks", 2)]
    assert "point faint" not in drawn


def test_places_in_a_timeline_are_parts_of_the_time_that_is_shown() -> None:
    extent = extent_of(TRUE, rows_of(TRUE))
    assert (extent.begin, extent.length, extent.cut) == (0, 1000 * 10**6, 0)
    assert extent.at(250 * 10**6) == "25%"
    assert [time // 10**6 for time, _ in times_of(extent, nice(extent.length / 3))] == [0, 500, 1000]
    assert zooms_of(rows_of(TRUE), extent) == [1, 4]  # a quarter of the marks are within 25 ms of the next one
    assert zooms_of([], extent) == [1]
    assert [nice(length) for length in (1.0, 1.2, 2.0, 4.9e9, 5.1e9)] == [1, 2, 2, 5 * 10**9, 10**10]


def test_a_timeline_is_without_its_long_pauses_where_they_are_most_of_it() -> None:
    at = (100, 300, 60_260, 60_400)  # ms, announced 50 ms before
    long = answer(touchdowns=[touchdown(one) for one in at], end=60_500 * 10**6)
    extent = extent_of(long, rows_of(long))
    # What is kept begins at a whole tenth of a second, and 0.1 s or more before what comes after the pause.
    assert [(piece.begin // 10**6, piece.end // 10**6) for piece in extent.pieces] == [(0, 400), (60_100, 60_500)]
    assert [extent.shown(stamp * 10**6) // 10**6 for stamp in (300, 30_000, 60_100, 60_260)] == [300, 400, 400, 560]
    assert [time // 10**6 for time, _ in times_of(extent, 2 * 10**8)] == [0, 200, 60_200, 60_400]
    assert cut_words(extent).startswith("Pauses are cut out: 800\N{NO-BREAK SPACE}ms of 60")
    short = answer(touchdowns=[touchdown(100), touchdown(2_500)], end=6000 * 10**6)
    assert extent_of(short, rows_of(short)).cut > 0
    walk = answer(touchdowns=[touchdown(one) for one in (100, 1_900, 3_800)], end=5_000 * 10**6)
    assert cut_words(extent_of(walk, rows_of(walk))) == ""


def test_times_are_round_and_even_within_each_stretch() -> None:
    """Stretches of half a second to one, 19 s apart and a bit: none of them begins at a round time."""
    at = [19_130 * k + 400 for k in range(60)]
    long = answer(touchdowns=[touchdown(one) for one in at], end=(at[-1] + 400) * 10**6)
    extent = extent_of(long, rows_of(long))
    assert len(extent.pieces) == 60
    for step in (10**8, 2 * 10**8, 10**9, 5 * 10**9):
        told = list(times_of(extent, step))
        places = [extent.shown(time) for time, _ in told]
        assert all(later - earlier >= step for earlier, later in pairwise(places))
        assert all(time % unit == 0 for time, unit in told)
        assert len(told) >= extent.length / (2 * step) - 1
        # Some half a second is shown of each: a tenth is the least that is told where no multiple of the step fits.
        assert {unit for _, unit in told} <= {10**8 * factor for factor in (1, 2, 5, 10, 20, 50, 100, 200)}
        of_piece = [
            [unit for time, unit in told if 0 <= time + extent.begin - one.begin < one.end - one.begin]
            for one in extent.pieces
        ]
        assert all(len(units) < 2 or set(units) == {step} for units in of_piece)
    svg = timeline(rows_of(long), extent, "long", "bag-1")
    labels = re.findall(r"<text[^>]*>([\d.]+) s</text>", svg)
    assert "0" in labels
    assert all(len(label.partition(".")[2]) <= 3 for label in labels)


def test_no_time_stands_at_a_cut_where_the_next_stretch_begins() -> None:
    pieces = [(0, 300, 0), (60_200, 60_400, 300), (120_100, 120_500, 500)]
    extent = Extent([Piece(*(10**6 * stamp for stamp in piece)) for piece in pieces])
    told = [(time // 10**6, unit // 10**6) for time, unit in times_of(extent, 2 * 10**8)]
    assert told == [(0, 200), (200, 200), (60_300, 100), (120_200, 200), (120_400, 200)]


def test_points_stand_where_measured_and_predicted_velocities_say() -> None:
    assert [pair[:3] for pair in pairs_of([TOSSES])["vx"]] == [(0.4, 0.5, "PIVOT"), (0.5, 0.5, "STOP")]
    turning = pairs_of([TOSSES])["turning"]
    assert [(pair.measured, pair.predicted) for pair in turning] == [(-0.1, -0.2), (-0.2, -0.2)]
    assert turning[0].told.splitlines()[-1] == "relative error 10.0\N{NO-BREAK SPACE}%"
    assert limits_of(turning) == pytest.approx((-0.206, -0.094))
    assert limits_of(turning, 0.3) == pytest.approx((-0.3, 0.0))
    rows = worst_table([TOSSES]).rows
    assert [(row[0].text, row[1].text) for row in rows] == [("0.300 s", "STOP"), ("0.100 s", "PIVOT")]


def test_the_page_says_why_measured_velocities_differ_more_than_true_ones() -> None:
    measured, ahead_of = velocities([TRUE, TOSSES]), early([TRUE, TOSSES])
    assert measured is not None
    assert ahead_of is not None
    said = measured.words[1].replace("\N{NO-BREAK SPACE}", " ")
    assert said.startswith(
        "The true velocities are known too: 90 % of the predictions are within 2.0 % of them, but within 28.0 % of the "
        "measured ones. These are of the samples 2 to 4 after a touchdown"
    )
    assert [list(figure.notes) for figure in ahead_of.figures] == [[AGAINST_MEASURED], []]
    none_found = answer(
        touchdowns=[touchdown(100)],
        true_touchdowns=[true(700, "PIVOT", None, None)],
        truth={"touchdowns": 1, "missed": 1, "false": 0, "unresolved": 0},
    )
    for one in (TOSSES, none_found):
        plain = velocities([one])
        assert plain is not None
        assert len(plain.words) == 1
    of_tosses = early([TOSSES])
    assert of_tosses is not None
    assert [list(figure.notes) for figure in of_tosses.figures] == [[]]


def test_squares_count_all_touchdowns_in_them_and_those_beyond_at_the_edge() -> None:
    pairs = [Pair(0.0, 0.0, "STOP", ""), Pair(0.001, 0.001, "SLIDE", ""), Pair(9.0, -9.0, "STOP", "")]
    squares = squares_of(pairs, (-1.0, 1.0))
    assert squares == {(18, 18): {"STOP": 1, "SLIDE": 1}, (35, 0): {"STOP": 1}}


def test_errors_ahead_and_costs_are_told_in_numbers() -> None:
    section = early([TRUE])
    assert section is not None
    velocity, time = section.figures
    assert velocity.data is not None
    assert time.data is not None
    neat = [[cell.text.replace("\N{NO-BREAK SPACE}", " ") for cell in row] for row in velocity.data.rows]
    assert neat == [["0 to 10 ms", "2", "20.0 %", "28.0 %"], ["10 to 20 ms", "0", "–", "–"]]
    neat = [[cell.text.replace("\N{NO-BREAK SPACE}", " ") for cell in row] for row in time.data.rows]
    assert neat == [["20 to 30 ms", "2", "2 ms", "2.8 ms"]]
    costs = cost_section([TOSSES])
    assert costs is not None
    cells = [cell.text.replace("\N{NO-BREAK SPACE}", " ") for cell in costs.tables[0].rows[0]]
    assert cells == ["5 samples", "20 µs", "192 µs", "289 µs", "300 µs"]
    assert bars_of({100: 1, 109: 2, 110: 3, -1: 4}) == {10: 3, 11: 3, -1: 4}


def test_what_could_not_be_used_is_told_with_its_reason_and_its_remedy() -> None:
    section = unused([{**TOSSES, "damaged": "it ends early", "notes": ["took odom"]}, TRUE, UNREADABLE])
    lost, others, remarks = section.tables
    assert [[cell.text for cell in row] for row in others.rows] == [[WHY["TOO_SLOW"], "1"]]
    assert [cell.text for cell in lost.rows[0]] == [
        "odom",
        "a field is NaN or infinite; look at its source",
        "2",
    ]
    assert (lost.rows[0][0].below, lost.rows[0][2].below) == ("not finite", "of 20, 10 %")
    assert [(row[0].text, row[0].below, row[1].text) for row in remarks.rows] == [
        ("broken.mcap", "unreadable", UNREADABLE["error"]),
        ("tosses.mcap", "damaged", "it ends early"),
        ("tosses.mcap", "note", "took odom"),
    ]
    assert "1 bag could be read in part only" in section.words[0]


def test_a_row_for_each_bag_leads_to_its_timeline() -> None:
    answers = [TRUE, WALK, TOSSES, UNREADABLE]
    anchors = anchors_of(answers)
    assert anchors == {0: "bag-1", 1: "bag-2", 2: "bag-3"}
    section = bags(answers, anchors)
    assert section is not None
    rows = section.tables[0].rows
    assert [row[0].to for row in rows] == ["bag-1", "bag-2", "bag-3", ""]
    assert rows[3][0].below == "could not be read"
    assert section.tables[0].head == ["bag", "touchdowns", "found", "error", "time error", "ahead", "a sample"]
    assert (rows[0][2].text, rows[0][2].below) == ("2 of 3", "1 false alarm")
    assert bags([TRUE], {}) is None


def test_of_many_bags_the_worst_are_listed_and_the_page_stays_small() -> None:
    answers = [*MANY, UNREADABLE]
    assert badness(UNREADABLE) == (inf,)
    assert badness(TRUE)[0] == pytest.approx(2 / 3)
    anchors = anchors_of(answers)
    assert list(anchors) == list(range(LISTED + 10 - SHOWN, LISTED + 10))
    section = bags(answers, anchors)
    assert section is not None
    names = [row[0].text for row in section.tables[0].rows]
    assert names[:2] == ["broken.mcap", f"{LISTED + 9}.mcap"]
    assert len(names) == LISTED
    assert len(section.figures) == 1
    (table,) = [table for table in unused(answers).tables if table.head[0] == "bag"]
    assert (table.rows[1][0].text, table.rows[1][0].below) == ("0.mcap", f"and {LISTED + 9} more bags")


def test_what_the_scene_leaves_out_stands_after_what_it_takes_in() -> None:
    section = scene(read_values("config/cube_tosses.yaml"))
    assert section is not None
    states = [row[0].below for row in section.tables[0].rows]
    assert states == sorted(states)
    rows = {row[0].text: row for row in section.tables[0].rows}
    assert rows["moving support"][0].below == "left out"
    assert rows["friction"][0].below == ""
    assert scene(None) is None


def test_every_mode_has_its_own_looks_and_every_reason_its_words() -> None:
    assert set(WHY) == {reason.name for reason in Leftover if reason}
    assert set(MODES) == {mode.name for mode in Mode}
    assert len(set(MODES.values())) == len(MODES)


@pytest.mark.parametrize(
    ("part", "words"),
    [(0.0, "0 %"), (8e-15, "< 0.01 %"), (0.00123, "0.12 %"), (0.0609, "6.1 %"), (0.105, "10.5 %"), (None, "–")],
)
def test_parts_of_one_read_as_in_the_tables_of_the_terminal(part: float | None, words: str) -> None:
    assert percent(part).replace("\N{NO-BREAK SPACE}", " ") == words


def test_what_is_below_a_microsecond_is_not_told_apart_from_nothing() -> None:
    assert seconds_words(0.0).replace("\N{NO-BREAK SPACE}", " ") == "less than 1 µs"
    assert seconds_words(0.00123).replace("\N{NO-BREAK SPACE}", " ") == "1.2 ms"


def test_the_page_of_a_record_without_anything_says_so(tmp_path: Path) -> None:
    file = tmp_path / "replay.html"
    nothing = answer(cost_us=None, begin=None, end=None, relative_errors_ahead=[], unpredictable="no message")
    write_replay_page(file, [nothing])
    text = file.read_text(encoding="utf-8")
    assert re.search(r"<h1>No touchdown was predicted</h1>", text)
    assert "no message" in text
