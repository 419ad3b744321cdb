"""Robots with messages of their own: which types are known, and what becomes of bags that have them."""

from __future__ import annotations

import re
import sqlite3
import sys
from importlib.metadata import EntryPoint
from math import sqrt
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from impact_predictor.bags import adapters as known
from impact_predictor.bags.adapters import Adapted
from impact_predictor.bags.inputs import adapted_topics, find_topics
from impact_predictor.bags.read import Bag, UnusableMessage, read_messages
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import CONTACT_GEOMETRY, ODOM, Input, Scene, Walking
from impact_predictor.ros.messages import MalformedMessage

DOCUMENT = (Path(__file__).parents[3] / "docs/adapters.md").read_text()
TYPE = "my_robot_msgs/msg/State"
XPP = "xpp_msgs/msg/RobotStateCartesian"
ODOM_INPUT, FEET_INPUT = Input("odom", ODOM, ""), Input("contact_geometry", CONTACT_GEOMETRY, "")
INPUTS = (ODOM_INPUT, FEET_INPUT)


@pytest.fixture
def documented(monkeypatch: pytest.MonkeyPatch) -> None:
    """The robot of the document, as if its package were installed."""
    source = re.search(r"```python\n(.*?)```", DOCUMENT, re.S)
    entry = re.search(r'"(\S+)" = "(\S+):adapt"', DOCUMENT)
    assert source is not None
    assert entry is not None
    assert entry[1] == TYPE
    module = ModuleType(entry[2])
    exec(source[1], module.__dict__)
    monkeypatch.setitem(sys.modules, "my_robot", ModuleType("my_robot"))
    monkeypatch.setitem(sys.modules, entry[2], module)
    install(monkeypatch, EntryPoint(entry[1], f"{entry[2]}:adapt", known.GROUP))


def install(monkeypatch: pytest.MonkeyPatch, *installed: EntryPoint) -> None:
    monkeypatch.setattr(known, "entry_points", lambda group: installed if group == known.GROUP else ())


def typestore() -> Typestore:
    """The messages of the document's robot, beside those of ROS."""
    definition = re.search(r"`my_robot_msgs/msg/State`:\n\n(.*?)\n\n\w", DOCUMENT, re.S)
    assert definition is not None
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(definition[1], TYPE))
    return store


def states(store: Typestore, count: int = 3) -> list[bytes]:
    """Messages of a robot whose trunk is turned by 90 degrees about z, and which moves along its x, the world's y."""
    of = store.types
    vector, point = of["geometry_msgs/msg/Vector3"], of["geometry_msgs/msg/Point"]
    turn = of["geometry_msgs/msg/Quaternion"](0.0, 0.0, sqrt(0.5), sqrt(0.5))
    return [
        bytes(
            store.serialize_cdr(
                of[TYPE](
                    of["builtin_interfaces/msg/Time"](12, 500 * k),
                    of["geometry_msgs/msg/Pose"](point(1.0, 2.0, 0.5), turn),
                    of["geometry_msgs/msg/Twist"](vector(0.0, 3.0, 0.0), vector(0.0, 0.0, 0.0)),
                    [point(1.0, 2.3, 0.0), point(1.0, 1.7, 0.0)],
                    [vector(0.0, 0.0, 0.0), vector(0.0, 3.0, -1.0)],
                    np.array([True, False]),
                ),
                TYPE,
            )
        )
        for k in range(count)
    ]


def write(path: Path, store: Typestore, messages: list[bytes], topic: str = "/state", ros1: bool = False) -> Path:
    if ros1:
        with Ros1Writer(path) as writer:
            connection = writer.add_connection(topic, TYPE, typestore=store)
            for k, data in enumerate(messages):
                writer.write(connection, k, store.cdr_to_ros1(data, TYPE))
    else:
        with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connection = writer.add_connection(topic, TYPE, typestore=store)
            for k, data in enumerate(messages):
                writer.write(connection, k, data)
    return path


def reader_of(path: Path, topic: str = "/state", type_name: str = TYPE) -> known.AdapterReader:
    with Bag(path) as bag:
        return known.readers(bag, {topic: type_name})[topic]


def read(path: Path) -> list[Adapted]:
    reader = reader_of(path)
    return [reader(message.data) for message in read_messages(path, {"/state": TYPE})]


@pytest.mark.usefixtures("documented")
@pytest.mark.parametrize("ros1", [False, True])
def test_the_documented_robot_is_read_from_ros_1_and_ros_2(tmp_path: Path, ros1: bool) -> None:
    store = typestore()
    first, *_, last = read(write(tmp_path / "robot.bag", store, states(store), ros1=ros1))
    assert last.sample.stamp == last.geometry.stamp == 12_000_001_000
    assert first.sample.linear == pytest.approx((3.0, 0.0, 0.0))
    assert first.geometry.points[0] == pytest.approx((0.3, 0.0, -0.5))
    assert first.geometry.velocities == (pytest.approx((-3.0, 0.0, 0.0)), pytest.approx((0.0, 0.0, -1.0)))
    assert first.stands == (True, False)


@pytest.mark.usefixtures("documented")
def test_the_only_topic_with_an_adapter_is_odom_and_contact_geometry() -> None:
    recorded = {"/camera": "sensor_msgs/msg/Image", "/state": TYPE}
    found, notes = find_topics("robot.bag", recorded, INPUTS, {})
    assert found == {ODOM_INPUT: "/state", FEET_INPUT: "/state"}
    assert notes == ("in robot.bag, took /state as odom and contact_geometry: its messages have an adapter",)
    assert adapted_topics(recorded, found) == {"/state": TYPE}


@pytest.mark.usefixtures("documented")
def test_of_two_topics_with_adapters_one_must_be_chosen() -> None:
    recorded = {"/state": TYPE, "/plan": XPP}
    with pytest.raises(
        InputError, match="2 topics that could be odom: /state, /plan; choose one: --remap odom:=/state"
    ):
        find_topics("robot.bag", recorded, INPUTS, {})
    found, notes = find_topics("robot.bag", recorded, INPUTS, {"odom": "/plan"})
    assert found == {ODOM_INPUT: "/plan", FEET_INPUT: "/plan"}


def test_an_installed_adapter_goes_before_the_one_that_is_built_in(monkeypatch: pytest.MonkeyPatch) -> None:
    mine = EntryPoint(XPP, "mine:adapt", known.GROUP)
    assert known.known()[XPP] in known.BUILT_IN
    install(monkeypatch, mine)
    assert known.known()[XPP] is mine


def test_an_adapter_that_cannot_be_imported_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = typestore()
    bag = write(tmp_path / "robot", store, states(store))
    install(monkeypatch, EntryPoint(TYPE, "nowhere.at_all:adapt", known.GROUP))
    with pytest.raises(InputError, match=rf"the adapter nowhere.at_all:adapt of {TYPE} cannot be imported \(No module"):
        reader_of(bag)


@pytest.mark.usefixtures("documented")
def test_damaged_bytes_are_malformed(tmp_path: Path) -> None:
    store = typestore()
    whole = states(store)[0]
    reader = reader_of(write(tmp_path / "robot", store, [whole]))
    for size in range(0, len(whole) - 4, 7):
        with pytest.raises(MalformedMessage):
            reader(whole[:size])


def test_what_an_adapter_raises_says_whose_fault_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("faulty")
    monkeypatch.setitem(sys.modules, "faulty", module)
    install(monkeypatch, EntryPoint(TYPE, "faulty:adapt", known.GROUP))
    store = typestore()
    bag = write(tmp_path / "robot", store, states(store))

    def refuse(message: object) -> Adapted:
        raise ValueError("no fix yet")

    module.adapt = refuse  # type: ignore[attr-defined]
    with pytest.raises(UnusableMessage, match=rf"the adapter faulty:adapt of {TYPE} refuses it: no fix yet"):
        read(bag)
    said = replay(bag, FEET).unpredictable
    assert f"3 of 3 messages on /state are MALFORMED: the adapter faulty:adapt of {TYPE} refuses it: no fix yet" in said
    assert "who else publishes" not in said
    module.adapt = lambda message: None  # type: ignore[attr-defined]
    with pytest.raises(InputError, match=rf"the adapter faulty:adapt of {TYPE} returns None, not an Adapted"):
        read(bag)
    module.adapt = lambda message: Adapted(message.odometry)  # type: ignore[attr-defined]
    with pytest.raises(InputError, match=rf"the adapter faulty:adapt of {TYPE} fails with AttributeError \(.*odometry"):
        read(bag)


FEET = Scene.from_parameters(
    validate({"body.mass": 9.0, "body.inertia": [1.0], "contact.friction": 0.6, "feet.names": ["left", "right"]})
)


@pytest.mark.usefixtures("documented")
def test_the_first_refusal_is_said_where_other_messages_are_used(tmp_path: Path) -> None:
    store = typestore()
    whole = states(store)
    turn = store.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 0.0)
    message = store.deserialize_cdr(whole[0], TYPE)
    message.trunk.orientation = turn
    bag = write(tmp_path / "robot", store, [bytes(store.serialize_cdr(message, TYPE)), *whole])
    took, refused = replay(bag, FEET).notes
    assert "took /state" in took
    assert refused.endswith(
        "1 of 4 messages on /state were refused as MALFORMED: the adapter my_robot.impact_adapter:adapt of "
        f"{TYPE} refuses it: the orientation is a zero quaternion"
    )


def test_points_have_velocities_of_their_own_number_or_none() -> None:
    still, level = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    with pytest.raises(ValueError, match="shorter"):
        known.of_world(1, still, level, still, still, [still, still], [still])
    _, geometry = known.of_world(1, still, level, still, still, [(1.0, 2.0, 3.0)])
    assert (geometry.points, geometry.velocities) == (((1.0, 2.0, 3.0),), ())


@pytest.mark.usefixtures("documented")
def test_flags_of_another_number_of_feet_are_a_fault_of_the_adapter(tmp_path: Path) -> None:
    store = typestore()
    bag = write(tmp_path / "robot", store, states(store))
    with pytest.raises(InputError, match=r"tells in `stands` of 2 feet, but feet.names has 3; give a flag for each"):
        replay(bag, FEET._replace(walking=Walking(("left", "right", "tail"))))


@pytest.mark.usefixtures("documented")
@pytest.mark.parametrize("given", [{}, {"body.contact_points": [0.0, 0.3, -0.5, 0.0, -0.3, -0.5]}])
def test_feet_that_the_scene_does_not_name_are_told_where_nothing_was_predicted(
    tmp_path: Path, given: dict[str, list[float]]
) -> None:
    store = typestore()
    bag = write(tmp_path / "robot", store, states(store))
    body = {"body.mass": 9.0, "body.inertia": [1.0], "contact.friction": 0.6}
    result = replay(bag, Scene.from_parameters(validate({**body, **given})))
    assert result.settled == ()
    assert result.unpredictable == (
        "no touchdown was predicted, and /state tells which feet stand, but the scene is of a body without feet; give "
        "that of a machine that walks, with feet.names, as config/walker_hyq.yaml has them"
    )


def test_a_bag_without_definitions_is_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install(monkeypatch)
    store = typestore()
    path = tmp_path / "robot"
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/state", TYPE, typestore=store)
        writer.write(connection, 0, states(store)[0])
    # As the distributions before Iron recorded.
    with sqlite3.connect(path / "robot.db3") as database:
        database.execute("DELETE FROM message_definitions")
    with pytest.raises(InputError, match=r"holds no definition of my_robot_msgs/msg/State on /state; record it again"):
        reader_of(path)


def test_definitions_may_be_in_idl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "places", places := ModuleType("places"))
    places.adapt = lambda message: Adapted(stands=(message.where.z == 3.0,))  # type: ignore[attr-defined]
    install(monkeypatch, EntryPoint("places_msgs/msg/Place", "places:adapt", known.GROUP))
    line = "=" * 80
    idl = (
        f"{line}\nIDL: places_msgs/msg/Place\n"
        "module places_msgs { module msg { struct Place { geometry_msgs::msg::Point where; }; }; };\n"
        f"{line}\nIDL: geometry_msgs/msg/Point\n"
        "module geometry_msgs { module msg { struct Point { double x; double y; double z; }; }; };\n"
    )
    store = get_typestore(Stores.ROS2_JAZZY)
    point = store.types["geometry_msgs/msg/Point"](1.0, 2.0, 3.0)
    data = bytes(store.serialize_cdr(point, "geometry_msgs/msg/Point"))
    with Writer(tmp_path / "places", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/place", "places_msgs/msg/Place", msgdef=idl, rihs01="RIHS01_0")
        writer.write(connection, 0, data)
    reader = reader_of(tmp_path / "places", "/place", "places_msgs/msg/Place")
    assert reader(data) == Adapted(stands=(True,))
