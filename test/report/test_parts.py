"""What parts cost: measured over motions of the body, and told so that the numbers add up."""

from __future__ import annotations

import io
import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_values
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.parts import EVENTS, PARTS, ladder
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample, Status
from impact_predictor.report.parts import measure, start
from impact_predictor.report.parts.measure import (
    COSTS,
    FEET,
    added_by,
    measure_parts,
    measured,
    monitor_of,
    steps_of,
    take,
    us_per_sample,
)
from impact_predictor.report.parts.record import OfSupport, Record, made, record_of
from impact_predictor.report.parts.start import NO_ROS, starts_of
from impact_predictor.report.parts.table import print_parts

CUBE = Path(__file__).parents[2] / "config/cube_tosses.yaml"
CRATE: dict[str, Any] = validate(
    {
        "body.mass": 12.0,
        "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
        "body.center_of_mass": [0.01, 0.0, 0.02],
        "contact.friction": 0.4,
        "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)],
        "support.normal": [0.6, 0.0, 0.8],
        "support.height": 2.0,
        "gravity": [0.0, 0.0, -9.81],
    }
)

DECK: dict[str, Any] = {
    "body.mass": 12.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.4,
    "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)],
    "support.motion": "odom",
    "support.frame": "world",
    "place.position": [3.0, 1.0, 0.2],
    "support.extent": [0.0, 6.0, -2.0, 4.0],
}
DRUM = validate(
    {
        "body.mass": 12.0,
        "body.inertia": [0.5],
        "contact.friction": 0.4,
        "body.radius": 0.3,
        "support.edges": [2.0, -0.2, 0.0, 2.0, 0.2, 0.0],
    }
)

ANSWER: dict[str, Any] = {
    "scene": "crate",
    "parts": [
        {
            "name": "core",
            "on": True,
            "why": "every scene",
            "us_per_sample": 60.0,
            "start_ms": 45.0,
            "start_mb": 2.25,
        },
        {
            "name": "friction",
            "on": True,
            "why": "contact.friction is 0.4",
            "us_per_sample": -20.0,
            "us_scatter": 25.0,
            "start_ms": None,
            "start_mb": None,
        },
        {
            "name": "margins",
            "on": False,
            "why": "margins is false: nobody asks how far an impact is from another mode",
            "us_per_sample": 1500.0,
            "us_scatter": 25.0,
            "start_ms": 4.0,
            "start_mb": 0.5,
        },
        {
            "name": "events executor",
            "on": False,
            "why": "executor is single",
            "us_per_sample": -150.0,
            "us_scatter": 25.0,
            "start_ms": 0.5,
            "start_mb": 0.0,
        },
    ],
    "us_per_sample": 40.0,
    "start_ms": 45.0,
    "start_mb": 2.25,
    "all_on": {"us_per_sample": 1540.0, "us_scatter": 30.0, "start_ms": 49.0, "start_mb": 2.75},
    "node": {
        "us_per_message": 210.0,
        "start_ms": 400.0,
        "start_mb": 60.0,
        "all_on": {"us_per_message": 60.0, "start_ms": 404.5, "start_mb": 60.5},
    },
    "why_no_node": "",
    "outputs": {"post_impact": 3.0, "mode": 0.2, "prediction": 21.0, "score": 2.0},
    "record": "300 samples of something",
}


def printed(answer: dict[str, Any], width: int) -> str:
    text = io.StringIO()
    print_parts(Console(file=text, width=width), answer)
    return text.getvalue()


def predictions(scene: Scene, record: Record) -> list[Any]:
    predictor = Predictor(scene)
    return [predictor.update(message) for message in record.messages if isinstance(message, Sample)]


def test_a_made_record_lets_the_body_fall_from_a_stance_and_throws_it() -> None:
    scene = Scene.from_parameters(CRATE)
    found = predictions(scene, made(scene))
    assert {one.status for one in found} == {Status.ACCEPTED}
    touchdowns = [one.touchdown for one in found if one.touchdown is not None]
    assert len(touchdowns) > 0.5 * len(found)
    standing = [one for one in touchdowns if one.old]
    assert 0.3 * len(touchdowns) < len(standing) < len(touchdowns)
    assert any(abs(one.lateral) > 0.1 for one in touchdowns)  # slip across the plane is among them


def test_falls_of_a_made_record_are_motions_that_the_predictor_follows() -> None:
    scene = Scene.from_parameters({**CRATE, "contact.friction": 100.0})  # nothing slips
    scores = [one.score for one in predictions(scene, made(scene)) if one.score is not None]
    announced = [score.touchdown.lead_time for score in scores if score.touchdown.old]
    assert len(announced) >= 8
    # The last prediction is of the last sample in the air, 1/200 s before the first on the ground.
    assert max(announced) < 0.005 + 0.001


def test_the_record_of_the_shipped_scene_is_its_example_and_of_another_scene_of_that_name_is_made() -> None:
    scene = Scene.from_parameters(read_values(CUBE))
    record = record_of("cube_tosses", scene, 300)
    assert "examples/cube_tosses" in record.origin
    assert 250 < record.samples < 600
    assert len(record.points) == 8
    assert "made" in record_of("cube_tosses", scene._replace(frame="map"), 300).origin
    assert "made" in record_of("crate", scene, 300).origin


@pytest.mark.parametrize("motion", ["odom", "imu"])
def test_a_record_over_a_moving_support_has_messages_of_it_too(motion: str) -> None:
    values = validate({**DECK, "support.motion": motion})
    body, scene = measured(values)
    record = made(scene)
    monitor = monitor_of(values, record)[1]
    answers = [take(monitor, body, message) for message in record.messages]
    statuses = Counter(answer.status for answer in answers if answer is not None)
    assert statuses == {Status.ACCEPTED: record.samples}
    touchdowns = sum(answer is not None and answer.touchdown is not None for answer in answers)
    assert touchdowns > 0.5 * record.samples
    of_support = sum(isinstance(message, OfSupport) for message in record.messages)
    assert 0.5 * record.samples < of_support < 2.0 * record.samples


def test_a_cylinder_falls_from_edge_to_edge() -> None:
    scene = Scene.from_parameters(DRUM)
    touchdowns = [one.touchdown for one in predictions(scene, made(scene)) if one.touchdown is not None]
    assert {(touchdown.old, touchdown.new) for touchdown in touchdowns} == {((0,), (1,)), ((1,), (0,))}


@pytest.mark.parametrize("points", [1, 2])
def test_a_machine_that_walks_steps_from_foot_to_foot_as_it_was_planned(points: int) -> None:
    given = {"feet.names": ["left", "right"], "feet.points": points, "feet.force": 20.0, "feet.has_schedule": True}
    tilted = {"support.normal": [0.6, 0.0, 0.8], "support.height": 2.0, "support.frame": "map"}
    values = validate({"body.mass": 9.0, "body.inertia": [0.5], "contact.friction": 0.4, **tilted, **given})
    body, scene = measured(values)
    record = record_of("walker", scene, 100)
    monitor = monitor_of(values, record)[1]
    answers = [answer for one in record.messages if (answer := take(monitor, body, one)) is not None]
    assert Counter(answer.status for answer in answers) == {Status.ACCEPTED: record.samples}
    landings = [answer.score.landing for answer in answers if answer.score is not None]
    # Every second stretch of 0.3 s a foot stands; the left one swings first.
    assert [(landing.foot, landing.confirmed) for landing in landings if landing is not None][:4] == [
        ("left", True),
        ("right", True),
        ("left", True),
        ("right", True),
    ]
    late = [None if landing is None else landing.late for landing in landings]
    assert all(one is not None and abs(one) < 0.01 for one in late), late


@pytest.mark.extras
def test_a_machine_with_a_model_hops_on_all_feet(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    mass = '<inertial><mass value="5"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    hip = '<joint name="hip" type="revolute"><parent link="base"/><child link="leg"/><axis xyz="0 1 0"/>'
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    foot = '<joint name="end" type="fixed"><parent link="leg"/><child link="foot"/><origin xyz="0 0 -0.8"/></joint>'
    links = f'<link name="base">{mass}</link><link name="leg">{mass}</link><link name="foot"/>'
    file = tmp_path / "hopper.urdf"
    file.write_text(f'<robot name="hopper">{links}{hip}{limit}{foot}</robot>')
    model = {"feet.names": ["foot"], "robot.urdf": str(file), "robot.frames": ["foot"]}
    values = validate({"body.mass": 9.0, "body.inertia": [0.5], "contact.friction": 0.4, **model})
    steps = ladder(values)
    assert [part.name for part, step in steps if part is not None and part.on(values)][-1] == "articulated inertia"
    for _, step in steps:
        record = made(measured(values)[1])
        monitor = monitor_of(step, record)[1]
        answers = [answer for one in record.messages if (answer := take(monitor, "", one)) is not None]
        assert sum(answer.touchdown is not None for answer in answers) > 30


def test_the_body_of_a_record_is_the_first_whose_pose_is_measured() -> None:
    blind = {"blind.source": "none", "onset.watch": True}
    body, scene = measured(validate({**DECK, **blind, "bodies": ["blind", "crate", "box"], "crate.body.mass": 7.0}))
    assert (body, scene.mass) == ("crate", 7.0)


def short(record: Record) -> Record:
    """A quarter of a record, some falls, which is enough to be measured once."""
    return record._replace(messages=record.messages[: len(record.messages) // 4])


@pytest.mark.slow
def test_parts_that_are_about_what_the_scene_has_are_told_without_costs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(measure, "record_of", lambda *given: short(record_of(*given)))
    file = tmp_path / "cargo.yaml"
    lines = [f"    {name}: {json.dumps(value)}" for name, value in {**DECK, "bodies": ["crate", "box"]}.items()]
    file.write_text("/**:\n  ros__parameters:\n" + "\n".join(lines) + "\n", encoding="utf-8")
    answer = measure_parts(file, runs=1)
    assert {part["name"] for part in answer["parts"]} == {"core", *(part.name for part in PARTS)}
    kept = {part["name"]: part for part in answer["parts"] if part["name"] in ("cylinder", "tilt", "several bodies")}
    assert {name: part["on"] for name, part in kept.items()} == {
        "cylinder": False,
        "tilt": False,
        "several bodies": True,
    }
    assert all(part[cost] is None for part in kept.values() for cost in COSTS)
    assert answer["record"].endswith("(the body is crate)")
    moving = next(part for part in answer["parts"] if part["name"] == "moving support")
    assert moving["on"]
    assert moving["us_per_sample"] > 0.0
    assert moving["start_ms"] > 0.0
    assert "several bodies" in printed(answer, 100)


def test_what_is_switched_on_costs_time() -> None:
    steps = ladder(CRATE)
    steps = steps[: 1 + [part.name if part else "" for part, _ in steps].index("margins")]
    *_, (before,), (with_margins,) = us_per_sample(steps, short(made(Scene.from_parameters(CRATE))), 1)
    # A search in five directions, with several impacts in each, against one.
    assert with_margins > 3.0 * before > 0.0


def test_what_a_part_adds_is_told_with_the_scatter_of_its_repetitions() -> None:
    # The machine was slower in the third and fourth run, for both.
    before, after = [50.0, 51.0, 70.0, 80.0, 50.0], [60.0, 62.0, 79.0, 91.0, 60.0]
    assert added_by(before, after) == (11.0, 1.0)
    assert added_by([50.0], [900.0]) == (850.0, 0.0)


@pytest.mark.parametrize(
    ("us", "scatter", "name", "told"),
    [
        (-54.0, 60.0, "friction", "~0"),
        (8.0, 8.5, "friction", "~0"),
        (9.0, 8.5, "friction", "9.0"),
        (-8.4, 3.0, "friction", "~0"),  # a part saves nothing: its scatter was larger than what the runs showed
        (-20.0, 30.0, EVENTS, "~0"),
        (-150.0, 30.0, EVENTS, "-150"),
    ],
)
def test_a_cost_within_its_scatter_is_about_none_and_only_an_executor_saves(
    us: float, scatter: float, name: str, told: str
) -> None:
    part = {**ANSWER["parts"][1], "name": name, "us_per_sample": us, "us_scatter": scatter}
    rows = [line.split() for line in printed({**ANSWER, "node": None, "parts": [part]}, 100).splitlines()]
    assert [row[row.index("on") + 1] for row in rows if row[:1] == name.split()[:1]] == [told]


def test_the_feet_of_a_scene_have_a_row_of_their_own_beside_what_a_body_costs() -> None:
    given = {"body.mass": 9.0, "body.inertia": [0.5], "contact.friction": 0.4, "feet.names": ["left", "right"]}
    values = validate(given)
    (core, fixed), (feet, first), *_ = steps = steps_of(values)
    assert (core, feet, first) == (None, FEET, ladder(values)[0][1])
    assert fixed == {**first, "feet.names": ()}
    body, scene = measured(values)
    record = made(scene)
    assert measured(fixed)[1].walking is None
    (alone,), (with_feet,) = us_per_sample(steps[:2], record, 1)
    # A curve for each foot and its landing, against a body that stands.
    assert with_feet > 1.5 * alone > 0.0
    monitor = monitor_of(fixed, record)[1]
    answers = [answer for one in record.messages if (answer := take(monitor, body, one)) is not None]
    assert Counter(answer.status for answer in answers) == {Status.ACCEPTED: record.samples}


@pytest.mark.slow
def test_the_start_of_what_is_left_out_is_measured_and_without_ros_that_of_the_node_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(start, "find_spec", lambda name: None)
    told: list[float] = []
    steps = ladder(CRATE)
    starts = starts_of(steps, 1, told.append)
    assert (starts.node, starts.messages, starts.why_no_node) == ([], None, NO_ROS)
    added = {part.name if part else "core": start for (part, _), start in zip(steps, starts.predictor, strict=True)}
    assert added["core"].ms > added["transverse slip"].ms > 0.5
    assert added["uncertainty"].ms > added["core"].ms  # numpy, and numba where it is installed
    assert added["uncertainty"].mb > 5.0
    assert added["friction"] == (0.0, 0.0)
    assert told == sorted(told)


def test_a_start_that_fails_is_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    probe = tmp_path / "probe.py"
    probe.write_text("raise SystemExit('something is missing')")
    monkeypatch.setattr(start, "PROBE", probe)
    with pytest.raises(InputError, match=r"^the start cannot be measured: something is missing$"):
        starts_of(ladder(CRATE), 1, lambda done: None)


@pytest.mark.slow
def test_the_measured_costs_of_the_parts_add_up_to_those_of_the_scene_and_of_everything() -> None:
    told: list[float] = []
    answer = measure_parts(CUBE, told.append, runs=1)
    json.dumps(answer, allow_nan=False)
    assert (told[-1], told) == (100.0, sorted(told))
    assert [part["name"] for part in answer["parts"][:1]] == ["core"]
    assert {part["name"] for part in answer["parts"][1:]} == {part.name for part in PARTS}
    of_node = {part.name for part in PARTS if part.of_node}
    parts = [part for part in answer["parts"] if part["name"] not in of_node]
    for cost in ("us_per_sample", "start_ms", "start_mb"):
        for whole, chosen in ((answer, [part for part in parts if part["on"]]), (answer["all_on"], parts)):
            assert whole[cost] == pytest.approx(sum(part[cost] or 0.0 for part in chosen))
        assert answer["all_on"][cost] > 1.5 * answer[cost] > 0.0
    assert set(answer["outputs"]) == {"post_impact", "mode", "prediction", "score"}
    assert answer["outputs"]["prediction"] > answer["outputs"]["mode"] > 0.0
    if answer["node"] is None:
        assert answer["why_no_node"]
    else:
        assert answer["node"]["start_ms"] > answer["start_ms"]
        assert answer["node"]["us_per_message"] > answer["node"]["all_on"]["us_per_message"] > 0.0


@pytest.mark.parametrize("width", [80, 120])
def test_the_table_says_what_each_part_costs_and_what_is_saved(width: int) -> None:
    text = printed(ANSWER, width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    rows = {line[:15].strip(): line[15:].split() for line in text.splitlines()}
    assert rows["core"][:4] == ["on", "60", "45", "2.2"]
    assert rows["friction"][:2] == ["on", "~0"]
    assert rows["this scene"][:3] == ["40", "45", "2.2"]
    assert rows["margins"][:4] == ["off", "+1,500", "+4.0", "+0.5"]
    assert rows["everything on"][:3] == ["1,540", "49", "2.8"]
    assert rows["saved"][:3] == ["1,500", "4.0", "0.5"]
    assert rows["events executor"][:4] == ["off", "-150", "+0.5", "+0.0"]
    assert rows["this node"][:3] == ["250", "400", "60"]
    assert rows["node"][:4] == ["on", "210", "355", "58"]


def test_what_the_core_of_a_machine_that_walks_is_is_told() -> None:
    feet = {**ANSWER["parts"][1], "name": "feet"}
    said = "The core is here that of a body over the same samples"
    assert said in printed({**ANSWER, "parts": [*ANSWER["parts"], feet]}, 120)
    assert said not in printed({**ANSWER, "parts": [*ANSWER["parts"], {**feet, "on": False}]}, 120)


def test_the_totals_are_told_in_words() -> None:
    text = " ".join(printed(ANSWER, 80).split())
    assert (
        "This scene: 40 us per sample, 45 ms and 2.2 MB at the start; everything on: 1,540 us per sample, 49 ms and "
        "2.8 MB at the start; saved: 1,500 us per sample, 4.0 ms and 0.5 MB at the start."
    ) in text
    assert "~/prediction 21" in text
    assert "300 samples of something" in text


def test_without_ros_one_line_says_so() -> None:
    text = printed({**ANSWER, "node": None, "why_no_node": NO_ROS}, 120)
    assert f"{NO_ROS}." in text
    assert "this node" not in text
