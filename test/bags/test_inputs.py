"""Which topics of a bag are taken for which inputs: by their names, or where there can be no doubt."""

from __future__ import annotations

import pytest

from impact_predictor.bags.inputs import find_topics
from impact_predictor.errors import InputError
from impact_predictor.prediction.scene import MovingDeck, Robot, Scene, Walking, inputs_of
from impact_predictor.ros.messages import IMU, JOINT_STATE, JOINT_TRAJECTORY, ODOMETRY, POLYGON, WRENCH

POINTS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
SCENE = Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5, points=POINTS)
DECK = SCENE._replace(deck=MovingDeck())
FLOOR = {"": SCENE}
ABOARD = {"": DECK}
CARGO = {
    "crate": DECK,
    "drum": DECK,
    "leaning": DECK._replace(source="imu"),
    "blind": DECK._replace(source="none"),
}


def found(
    recorded: dict[str, str], scenes: dict[str, Scene], remap: dict[str, str] | None = None
) -> tuple[dict[str, str], str]:
    """The topic of each input by its name, and the notes in one text."""
    topics, notes = find_topics("bag", recorded, inputs_of(scenes), remap or {})
    return {one.name: topic for one, topic in topics.items()}, " | ".join(notes)


def refusal(recorded: dict[str, str], scenes: dict[str, Scene], remap: dict[str, str] | None = None) -> str:
    with pytest.raises(InputError) as caught:
        found(recorded, scenes, remap)
    return str(caught.value)


def test_topics_of_the_names_of_the_inputs_are_taken_whatever_else_there_is() -> None:
    recorded = {
        **dict.fromkeys(("/crate/odom", "/drum/odom", "/support/odom", "/odom", "/tf/odom"), ODOMETRY),
        **dict.fromkeys(("/leaning/imu", "/support/imu"), IMU),
        "/crate/contact_geometry": POLYGON,
    }
    topics, notes = found(recorded, CARGO)
    assert topics == {name: f"/{name}" for name in ("support/odom", "crate/odom", "drum/odom", "leaning/imu")}
    assert notes == ""


def test_the_only_other_topic_of_the_type_is_taken_for_a_body_without_a_name() -> None:
    assert found({"/x": ODOMETRY}, FLOOR) == ({"odom": "/x"}, "in bag, took /x as odom: there is no other of the type")
    assert found({"/x": ODOMETRY, "/support/odom": ODOMETRY}, ABOARD)[0]["odom"] == "/x"


def test_nothing_is_taken_for_the_deck_that_is_not_told_to_be_it() -> None:
    assert refusal({"/cube/odom": ODOMETRY, "/imu": IMU}, ABOARD) == (
        "nothing in bag is told to be the deck (support/odom); it has /cube/odom (nav_msgs/msg/Odometry), "
        "/imu (sensor_msgs/msg/Imu); if the deck is among them, tell which: --remap support/odom:=TOPIC"
    )
    assert "(support/odom); it has no topics at all" in refusal({}, ABOARD)
    # What is left over may be another unit.
    for scenes, name in ((ABOARD, "/odom"), ({"crate": DECK}, "/crate/odom")):
        recorded = {name: ODOMETRY, "/barrel/odom": ODOMETRY}
        assert "is told to be the deck" in refusal(recorded, scenes)
        assert found(recorded, scenes, {"support/odom": "/barrel/odom"})[0]["support/odom"] == "/barrel/odom"
    topics, _ = found({"/x": ODOMETRY, "/y": ODOMETRY}, ABOARD, {"support/odom": "/x"})
    assert topics == {"support/odom": "/x", "odom": "/y"}


def test_of_several_topics_one_must_be_chosen() -> None:
    assert refusal({"/x": ODOMETRY, "/y": ODOMETRY}, FLOOR) == (
        "bag has 2 topics that could be odom: /x, /y; choose one: --remap odom:=/x"
    )


def test_a_body_with_a_name_takes_no_topic_of_another_name() -> None:
    recorded = {"/crate/odom": ODOMETRY, "/support/odom": ODOMETRY, "/barrel/odom": ODOMETRY, "/leaning/imu": IMU}
    topics, notes = found(recorded, CARGO)
    assert "drum/odom" not in topics
    assert notes == "bag has no drum/odom: nothing is predicted there"
    # What is left is neither the support nor the drum for that.
    del recorded["/support/odom"]
    assert refusal(recorded, CARGO).startswith("nothing in bag is told to be the deck (support/odom); it has")


def test_a_remapping_of_no_input_is_refused_with_those_there_are() -> None:
    assert refusal({}, CARGO, {"blind/odom": "/x"}) == (
        "the remapping blind/odom:=/x is of no input; the inputs are support/odom, crate/odom, drum/odom, leaning/imu, "
        "crate/contact_geometry and drum/contact_geometry"
    )
    assert found({"/odom": ODOMETRY}, FLOOR, {"contact_geometry": "/feet"})[0] == {"odom": "/odom"}
    many = {f"unit_{k}": DECK for k in range(50)}
    assert refusal({}, many, {"x": "/y"}).endswith("unit_18/odom and 81 more")


def test_no_topic_is_two_inputs() -> None:
    recorded = {"/x": ODOMETRY, "/support/odom": ODOMETRY}
    assert refusal(recorded, ABOARD, {"odom": "/support/odom"}) == (
        "support/odom and odom cannot both be /support/odom; remap one of them to another topic"
    )


def test_of_feet_the_points_and_joints_may_be_guessed_but_no_wrench_and_no_trajectory() -> None:
    walker = {"": SCENE._replace(points=(), walking=Walking(("left", "right"), force=30.0, has_schedule=True))}
    recorded = {"/x": ODOMETRY, "/feet": POLYGON, "/arm": JOINT_TRAJECTORY, "/wrist": WRENCH, "/joints": JOINT_STATE}
    assert found(recorded, walker)[0] == {"odom": "/x", "contact_geometry": "/feet"}
    named = {**recorded, "/contact_wrench": WRENCH, "/plan": JOINT_TRAJECTORY}
    topics, _ = found(named, walker, {"schedule": "/plan"})
    assert topics == {
        "odom": "/x",
        "contact_geometry": "/feet",
        "contact_wrench": "/contact_wrench",
        "schedule": "/plan",
    }
    modelled = {"": walker[""]._replace(walking=Walking(("left",), robot=Robot("robot.urdf", ("foot",))))}
    assert found(recorded, modelled)[0] == {"odom": "/x", "joint_states": "/joints"}
