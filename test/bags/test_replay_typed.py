"""Replay with typed messages: a bag that every reader decodes by the definitions in it, with the numbers of strings."""

from __future__ import annotations

from math import isnan
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from mcap.reader import make_reader
from recordings import first_messages, write_bag, write_plan
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from test_replay_deck import CARGO, TYPES, recorded
from typed_scores import decode_scores

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.mechanics.types import ContactState, Mode
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import read_scenes, scenes_of
from impact_predictor.prediction.types import Leftover, Status
from impact_predictor.report.touchdowns import row_of_message
from impact_predictor.resources import find
from impact_predictor.ros.messages import Diagnostic, decode_diagnostic_array

NODE = "/impact_predictor"


class Message(NamedTuple):
    topic: str
    log_time: int
    content: Any


def by_their_definitions(path: Path) -> list[Message]:
    """The messages of an MCAP file, read by nothing but the definitions in it."""
    found, stores = [], {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            name = schema.name
            if name not in stores:
                stores[name] = get_typestore(Stores.EMPTY)
                stores[name].register(get_types_from_msg(schema.data.decode(), name))
            content = stores[name].deserialize_cdr(message.data, name)
            found.append(Message(channel.topic, message.log_time, content))
    return found


class Both(NamedTuple):
    """What a replay wrote in both forms, and where."""

    strings: dict[str, list[list[Diagnostic]]]
    typed: list[Message]
    paths: tuple[Path, Path]

    def of(self, topic: str) -> list[Any]:
        return [one.content for one in self.typed if one.topic == topic]


def both(folder: Path, bag: Path, scenes: Any) -> Both:
    paths = folder / "strings.mcap", folder / "typed.mcap"
    for path in paths:
        replay(bag, scenes, output=path, messages=path.stem)
    wanted = {topic: kind for topic, kind in topics(paths[0]).items() if kind.endswith("DiagnosticArray")}
    strings: dict[str, list[list[Diagnostic]]] = {topic: [] for topic in wanted}
    for topic, _, data in read_messages(paths[0], wanted):
        strings[topic].append(decode_diagnostic_array(data))
    return Both(strings, by_their_definitions(paths[1]), paths)


@pytest.fixture(scope="module")
def tosses(tmp_path_factory: pytest.TempPathFactory) -> Both:
    folder = tmp_path_factory.mktemp("tosses")
    scenes = read_scenes(find("config/cube_tosses.yaml"))
    scenes[""] = scenes[""]._replace(margins=True)
    return both(folder, write_bag(folder / "tosses.mcap", first_messages(400)), scenes)


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Both:
    folder = tmp_path_factory.mktemp("robot")
    scenes = read_scenes(find("config/walker_hyq.yaml"))
    return both(folder, write_plan(folder / "plan.bag", 4.0), scenes)


@pytest.fixture(scope="module")
def cargo(tmp_path_factory: pytest.TempPathFactory) -> Both:
    folder = tmp_path_factory.mktemp("cargo")
    return both(folder, write_bag(folder / "cargo.mcap", recorded(), TYPES), scenes_of(validate(CARGO)))


def numbers(message: Any) -> list[float]:
    """Those of a twist, a vector or an array, in their order."""
    if hasattr(message, "linear"):
        return [*numbers(message.linear), *numbers(message.angular)]
    names = ("vx", "vy", "omega") if hasattr(message, "omega") else ("x", "y", "z")
    return [getattr(message, name) for name in names]


AXES = tuple(f"{part}{axis}" for part in "vw" for axis in "xyz")
PLANE = ("vx", "vy", "omega")


def check_prediction(typed: Any, strings: list[Diagnostic]) -> None:
    """Both tell the same of an answer: of its touchdown, how sure it is, its contacts, and the feet."""
    values = strings[0].values
    assert (Status(typed.status).name, Mode(typed.mode).name) == (values["status"], values["mode"])
    assert typed.header.stamp.sec * 10**9 + typed.header.stamp.nanosec == int(values["stamp"])
    groups = {
        "before_6d": (typed.before, AXES),
        "after_6d": (typed.after, AXES),
        "before": (typed.planar_before, PLANE),
    }
    groups |= {"after": (typed.planar_after, PLANE), "deviation": (typed.planar_deviation, PLANE)}
    groups |= {"axis": (typed.axis, ("x", "y", "z")), "mean": (typed.planar_mean, PLANE)}
    for key, (message, ends) in groups.items():
        told = [float(values.get(f"{key}.{end}", "nan")) for end in ends]
        assert same(numbers(message), told), key
    for key in ("lead_time", "energy_lost", "half_distance", "off_axis", "lateral", "closing_spread", "offset"):
        assert same([getattr(typed, key)], [float(values.get(key, "nan"))]), key
    chances = [float(values.get(f"probability.{mode.name}", "nan")) for mode in Mode]
    assert same(typed.mode_probabilities.tolist(), chances)
    margin = [float(values.get(f"margin.{key}", "nan")) for key in ("friction", "slip")]
    assert same([typed.margin_friction.change, typed.margin_slip.change], margin)
    assert [ContactState(one.state).name for one in typed.contacts] == values.get("states", "").split()
    pushed = [part for one in typed.contacts for part in numbers(one.impulse)]
    assert same(pushed, [float(one) for one in values.get("impulses", "").split()])
    assert len(typed.feet) == len(strings) - 1
    for foot, its in zip(typed.feet, strings[1:], strict=True):
        assert (foot.name, foot.stands) == (its.values["name"], its.values["stands"] == "true")
        keys = ("gap", "approach", "lead_time", "landing_speed", "landing_deviation", "lands", "strikes", "late")
        assert same([getattr(foot, key) for key in keys], [float(its.values.get(key, "nan")) for key in keys])


def same(found: list[float], expected: list[float]) -> bool:
    pairs = zip(found, expected, strict=True)
    return all(one == other or (isnan(one) and isnan(other)) for one, other in pairs)


def check(found: Both, prefix: str = NODE) -> None:
    typed, strings = found.of(f"{prefix}/prediction"), found.strings[f"{prefix}/prediction"]
    assert len(typed) == len(strings) > 0
    for one, other in zip(typed, strings, strict=True):
        check_prediction(one, other)
    assert any(one.mode for one in typed)
    kinds = [topics(path)[f"{prefix}/score"] for path in found.paths]
    scores = [
        [one for _, _, data in read_messages(path, {f"{prefix}/score": kind}) for one in decode_scores(kind, data)]
        for path, kind in zip(found.paths, kinds, strict=True)
    ]
    assert kinds[0] != kinds[1]
    assert scores[0] == scores[1]
    assert scores[0]


def test_typed_messages_of_tosses_tell_the_numbers_of_strings(tosses: Both) -> None:
    check(tosses)


@pytest.mark.slow
def test_typed_messages_of_a_robot_tell_the_numbers_of_strings(robot: Both) -> None:
    check(robot)


def test_typed_messages_of_cargo_tell_the_numbers_of_strings(cargo: Both) -> None:
    check(cargo, f"{NODE}/falling")


def test_the_state_of_a_deck_tells_what_diagnostics_tell(cargo: Both) -> None:
    states, reports = cargo.of(f"{NODE}/deck"), cargo.strings["/diagnostics"]
    assert len(states) == len(reports) > 0
    keys = ("slide_ratio", "tip_ratio", "time_to_tip", "time_to_slide", "onset_probability", "tips_per_hour")
    for state, statuses in zip(states, reports, strict=True):
        *units, deck = statuses
        assert state.header.frame_id == deck.hardware_id == "deck"
        assert state.window_linear == float(deck.values["window.linear"])
        assert len(state.units) == len(units)
        for unit, its in zip(state.units, units, strict=True):
            assert (unit.body, unit.level, unit.message) == (its.hardware_id, its.level, its.message)
            told = [float("nan") if its.values[key] == "unknown" else float(its.values[key]) for key in keys]
            assert same([getattr(unit, key) for key in keys], told)


@pytest.mark.slow
def test_scores_of_a_robot_name_the_sample_whose_prediction_they_score(robot: Both) -> None:
    stamps = {0, *[stamp(one.header) for one in robot.of(f"{NODE}/prediction")]}
    assert stamps.issuperset(one.sample.sec * 10**9 + one.sample.nanosec for one in robot.of(f"{NODE}/score"))


def test_all_that_is_told_of_a_sample_can_be_paired_by_stamps(tosses: Both) -> None:
    by_stamp = {stamp(one.header): one for one in tosses.of(f"{NODE}/prediction")}
    assert len(by_stamp) == len(tosses.of(f"{NODE}/prediction"))
    announced = [one for one in by_stamp.values() if one.mode]
    after = tosses.of(f"{NODE}/post_impact")
    assert [stamp(one.header) for one in after] == [
        one.touchdown.sec * 10**9 + one.touchdown.nanosec for one in announced
    ]
    for one, then in zip(announced, after, strict=True):
        assert numbers(one.pose.pose.position) == numbers(then.pose.pose.position)
        assert numbers(one.twist.twist) == numbers(then.twist.twist)
        assert (one.twist.covariance == then.twist.covariance).all()
    scores = tosses.of(f"{NODE}/score")
    assert scores
    for score in scores:
        scored = by_stamp[score.sample.sec * 10**9 + score.sample.nanosec]
        assert (scored.mode, scored.lead_time) == (score.mode, score.lead_time)
        assert stamp(score.header) in by_stamp
        assert score.scored == (Leftover(score.leftover) is Leftover.NONE and not isnan(score.planar_relative_error))


def stamp(header: Any) -> int:
    return int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)


def test_typed_scores_tell_what_strings_tell(tosses: Both) -> None:
    topic = f"{NODE}/score"
    strings, typed = (
        [
            row_of_message(name, values)
            for _, _, data in read_messages(path, {topic: kind})
            for name, values in decode_scores(kind, data)
        ]
        for path in tosses.paths
        for kind in [topics(path)[topic]]
    )
    assert strings == typed
    assert strings


def test_foxglove_reads_what_a_replay_writes(tosses: Both) -> None:
    factory = pytest.importorskip("mcap_ros2.decoder").DecoderFactory()
    with tosses.paths[1].open("rb") as file:
        reader = make_reader(file, decoder_factories=[factory])
        theirs = [one.decoded_message for one in reader.iter_decoded_messages(topics=[f"{NODE}/prediction"])]
    ours = tosses.of(f"{NODE}/prediction")
    assert len(theirs) == len(ours)
    for one, other in zip(theirs, ours, strict=True):
        assert (one.mode, one.law, one.kind, list(one.old_points)) == (
            other.mode,
            other.law,
            other.kind,
            other.old_points.tolist(),
        )
        assert same([*numbers(one.after), one.margin_slip.change], [*numbers(other.after), other.margin_slip.change])
        assert [contact.impulse.z for contact in one.contacts] == [contact.impulse.z for contact in other.contacts]
