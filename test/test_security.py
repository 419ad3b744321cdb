"""Files from elsewhere decide no path, no code and not how much memory is taken; and what the node may do in a secured
graph is what it does.
"""

from __future__ import annotations

import os
import resource
import sqlite3
import struct
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from impact_predictor.bags import chunks
from impact_predictor.bags.chunks import LARGEST, zstd
from impact_predictor.bags.find import bags_of
from impact_predictor.bags.read import Bag, read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import inputs_of, scenes_of
from impact_predictor.ros.messages import ODOMETRY

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "config/rocking_rod.yaml"
MCAP = b"\x89MCAP0\r\n"
SQLITE = """CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
INSERT INTO topics VALUES(1, '/odom', 'nav_msgs/msg/Odometry', 'cdr');"""


def record(opcode: int, body: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(body)) + body


def text(words: str) -> bytes:
    return struct.pack("<I", len(words.encode())) + words.encode()


def channel(topic: str, type_name: str = ODOMETRY, definition: str = "") -> bytes:
    schema = struct.pack("<H", 1) + text(type_name) + text("ros2msg") + text(definition)
    return record(3, schema) + record(4, struct.pack("<HH", 1, 1) + text(topic) + text("cdr") + struct.pack("<I", 0))


def message(data: bytes = b"") -> bytes:
    return record(5, struct.pack("<HIQQ", 1, 0, 1, 1) + data)


def chunk(inner: bytes, says: int) -> bytes:
    """A compressed chunk that says how long it was before."""
    data = zstd.compress(inner)
    return record(6, struct.pack("<QQQI", 1, 1, says, 0) + text("zstd") + struct.pack("<Q", len(data)) + data)


def files_in(folder: Path) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*")}


@pytest.mark.parametrize("topic", ["/../../odom", "/etc/passwd", "/odom\x00.mcap", "/C:\\odom", "/$HOME/~"])
def test_a_topic_named_like_a_path_is_a_name(tmp_path: Path, topic: str) -> None:
    bag, output = tmp_path / "in/run.mcap", tmp_path / "in/predictions.mcap"
    bag.parent.mkdir()
    bag.write_bytes(
        MCAP + channel(topic) + message(b"no odometry") + record(15, bytes(4)) + record(2, bytes(20)) + MCAP
    )
    assert topics(bag) == {topic: ODOMETRY}
    result = replay(bag, scenes_of(read_values(SCENE)), {"/odom": topic}, output)
    assert {status.name for status in result.statuses} == {"MALFORMED"}
    assert files_in(tmp_path) == {Path("in"), Path("in/run.mcap"), Path("in/predictions.mcap")}


def folder(path: Path, metadata: str) -> Path:
    """A bag of one file with a topic /odom, with metadata."""
    path.mkdir()
    (path / "run_0.mcap").write_bytes(MCAP + channel("/odom"))
    (path / "metadata.yaml").write_text(f"rosbag2_bagfile_information: {metadata}\n")
    return path


@pytest.mark.parametrize("name", ["../other.mcap", "../../other.mcap", "sub/../../other.mcap", "{path}/other.mcap"])
def test_metadata_that_name_files_elsewhere_lead_to_none_of_them(tmp_path: Path, name: str) -> None:
    (tmp_path / "other.mcap").write_bytes(MCAP + channel("/secret"))
    names = f"['{name.format(path=tmp_path)}']"
    bag = folder(tmp_path / "run", f"{{relative_file_paths: {names}, topics_with_message_count: []}}")
    with pytest.raises(InputError, match=r"other\.mcap is missing"):
        topics(bag)


@pytest.mark.parametrize(
    "line",
    [
        "!!python/object/apply:os.system ['touch {mark}']",
        "!!python/object/new:os.system ['touch {mark}']",
        "!!python/name:os.system",
        "[!!python/object/apply:subprocess.check_output [['touch', '{mark}']]]",
    ],
)
def test_a_tag_of_yaml_makes_no_object(tmp_path: Path, line: str) -> None:
    mark = tmp_path / "mark"
    scene = tmp_path / "scene.yaml"
    # Where the metadata are none the files of the folder are read.
    assert topics(folder(tmp_path / "run", line.format(mark=mark))) == {"/odom": ODOMETRY}
    scene.write_text(f"/**:\n  ros__parameters:\n    law: {line.format(mark=mark)}\n")
    with pytest.raises(InputError, match=r"scene\.yaml"):
        read_values(scene)
    assert not mark.exists()


LAUGHS = "\n".join(f"    l{k}: &l{k} [{', '.join([f'*l{k - 1}'] * 9)}]" for k in range(1, 40))


def test_aliases_of_aliases_of_yaml_are_refused_and_not_written_out(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    laughs = f"    l0: &l0 [ha]\n{LAUGHS}\n"
    told = f"\n{laughs}    relative_file_paths: [*l39]\n    topics_with_message_count: []"
    assert topics(folder(tmp_path / "run", told)) == {"/odom": ODOMETRY}
    scene.write_text(f"/**:\n  ros__parameters:\n{laughs}")
    with pytest.raises(InputError, match=r"scene\.yaml"):
        read_values(scene)


ZEROS = bytes(1 << 26)
BOMBS = {
    "a chunk that says less than it has": chunk(message() + record(0x80, ZEROS), says=1000),
    "a chunk that says a terabyte": chunk(message() + record(0x80, ZEROS), says=1 << 40),
    "a chunk that says a terabyte of itself": record(
        6, struct.pack("<QQQI", 1, 1, 1 << 40, 0) + text("") + b"\xff" * 7
    ),
    "a message that says a terabyte": struct.pack("<BQ", 5, 1 << 40) + bytes(40),
    "a schema that says a terabyte": struct.pack("<BQ", 3, 1 << 40) + bytes(40),
    "a name that says four gigabytes": record(3, struct.pack("<HI", 1, 0xFFFFFFFF)),
    "a compressed message that becomes large": message(zstd.compress(ZEROS)),
}


@pytest.mark.parametrize("bomb", BOMBS)
def test_a_length_that_lies_is_damage_and_takes_no_memory(
    tmp_path: Path, bomb: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chunks, "LARGEST", 1 << 20)
    bag = tmp_path / "bomb.mcap"
    bag.write_bytes(MCAP + channel("/odom") + BOMBS[bomb])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match="damaged or cut off"):
        list(read_messages(bag, {"/odom": ODOMETRY}))
    # In kB: what the bombs would become is 64 MB, or a terabyte.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 32_000


def test_a_chunk_without_content_as_large_as_a_disk_is_not_read(tmp_path: Path) -> None:
    bag = tmp_path / "sparse.mcap"
    head = struct.pack("<QQQI", 1, 1, LARGEST + 1, 0) + text("") + struct.pack("<Q", LARGEST + 1)
    with bag.open("wb") as file:
        file.write(MCAP + channel("/odom") + struct.pack("<BQ", 6, len(head) + LARGEST + 1) + head)
        file.truncate(8 * LARGEST)
    with pytest.raises(InputError, match="more than the 268,435,456 that any may have"):
        list(read_messages(bag, {"/odom": ODOMETRY}))


def test_many_chunks_that_become_a_thousand_times_as_long_end_soon(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chunks, "LARGEST", 1 << 20)
    zeros, bag = bytes(1 << 19), tmp_path / "bomb.mcap"
    inner = message() + record(0x80, zeros)
    whole, bomb = message(b"first"), chunk(inner, says=len(inner))
    bag.write_bytes(
        MCAP
        + channel("/odom")
        + record(6, struct.pack("<QQQI", 1, 1, len(whole), 0) + text("") + struct.pack("<Q", len(whole)) + whole)
        + 100 * bomb
    )
    messages = read_messages(bag, {"/odom": ODOMETRY})
    assert next(messages).data == b"first"
    with pytest.raises(InputError, match="it decompresses to more than 100 times its size"):
        list(messages)


def test_a_blob_of_a_database_that_is_larger_than_any_message_is_damage(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("impact_predictor.bags.sqlite_file.LARGEST", 1 << 20)
    bag = tmp_path / "run.db3"
    database = sqlite3.connect(bag)
    database.executescript(
        SQLITE + "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
        "INSERT INTO messages VALUES(1, 1, 1, x'0102'), (2, 1, 2, zeroblob(64000000)), (3, 1, 3, x'03');"
    )
    database.close()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    messages = read_messages(bag, {"/odom": ODOMETRY})
    assert next(messages).data == b"\1\2"
    with pytest.raises(InputError, match="a message has 64,000,000 bytes, more than"):
        list(messages)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 32_000


@pytest.mark.parametrize("name", ["run.mcap", "run.db3", "run/metadata.yaml", "scene.yaml"])
def test_a_pipe_in_the_place_of_a_file_is_refused_at_once_though_nobody_ever_writes_into_it(
    tmp_path: Path, name: str
) -> None:
    bag = folder(tmp_path / "run", "{}")
    (tmp_path / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / name)
    if name == "scene.yaml":
        with pytest.raises(InputError, match=r"scene\.yaml: it is no file, but a pipe or a device"):
            read_values(tmp_path / name)
    elif name.startswith("run/"):
        # Where the metadata are none the files of the folder are read.
        assert topics(bag) == {"/odom": ODOMETRY}
    else:
        with pytest.raises(InputError, match="is not a bag, but a pipe or a device"):
            topics(tmp_path / name)


def test_a_parameter_file_that_is_far_too_long_is_not_read(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    with scene.open("w") as file:
        file.truncate(1 << 40)
    with pytest.raises(InputError, match="more than the 1,048,576 that are read"):
        read_values(scene)


COMPUTED = {
    "a view without end": """CREATE VIEW messages AS WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM r)
        SELECT n AS id, 1 AS topic_id, n AS timestamp, zeroblob(1000) AS data FROM r;""",
    "a computed column": """CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,
        data BLOB AS (zeroblob(900000000))); INSERT INTO messages VALUES(1, 1, 1);""",
    "a virtual table": "CREATE VIRTUAL TABLE messages USING fts5(id, topic_id, timestamp, data);",
}


@pytest.mark.parametrize("messages", COMPUTED)
def test_a_database_that_computes_its_messages_is_refused(tmp_path: Path, messages: str) -> None:
    bag = tmp_path / "run.db3"
    database = sqlite3.connect(bag)
    database.executescript(SQLITE + COMPUTED[messages])
    database.close()
    with pytest.raises(InputError, match="as no recorder makes them"):
        topics(bag)


EVIL = (
    "float64 x; import os; os.system('touch {mark}')",
    "float64 x\nfloat64 __import__('os').system('touch {mark}')",
    "string s \"' + str(__import__('os').system('touch {mark}')) + '\"\nfloat64 x",
    "string S='''\nimport os\nos.system(\"touch {mark}\")\n'''\nfloat64 x",
    "pkg/__import__ x\n" + "=" * 80 + "\nMSG: pkg/__import__('os').system('touch {mark}')\nfloat64 y",
    "uint8[99999999999999] x",
    "robots_msgs/State x",
)


@pytest.mark.parametrize("definition", EVIL)
@pytest.mark.parametrize(
    "type_name", ["robots_msgs/msg/State", "robots_msgs/msg/State\nimport os\nos.system('touch {mark}')"]
)
def test_a_definition_of_a_type_runs_nothing(tmp_path: Path, definition: str, type_name: str) -> None:
    mark, bag = tmp_path / "mark", tmp_path / "run.mcap"
    type_name = type_name.format(mark=mark)
    bag.write_bytes(MCAP + channel("/state", type_name, definition.format(mark=mark)) + message(bytes(64)))
    # What is refused, and bytes that are none of such a message, is for other tests: nothing may have run.
    with suppress(Exception), Bag(bag) as opened:
        opened.decoders({"/state": type_name})["/state"](bytes(64))
    assert not mark.exists()


@pytest.mark.parametrize(
    "type_name", ["os:system", "impact_predictor.bags.adapters:of_xpp", "../xpp", "builtins/msg/exec"]
)
def test_a_type_named_like_code_has_no_adapter(tmp_path: Path, type_name: str) -> None:
    bag = tmp_path / "run.mcap"
    bag.write_bytes(MCAP + channel("/odom", type_name) + message(b"1 + 1"))
    with pytest.raises(InputError, match="nav_msgs/msg/Odometry"):
        replay(bag, scenes_of(read_values(SCENE)))


def test_a_folder_of_bags_is_not_left_through_a_link(tmp_path: Path) -> None:
    runs, elsewhere = tmp_path / "runs", tmp_path / "elsewhere"
    runs.mkdir()
    elsewhere.mkdir()
    (elsewhere / "other.mcap").write_bytes(MCAP)
    (runs / "run.mcap").write_bytes(MCAP)
    (runs / "link").symlink_to(elsewhere)
    assert bags_of([str(runs)]) == [str(runs / "run.mcap")]


POLICY = ElementTree.parse(ROOT / "config/sros2_policy.xml").getroot()
OF_TIME = {"/clock", "/parameter_events"}
"""Topics that nodes read with simulated time, some versions of ROS in any case."""


def allowed(kind: str, tag: str, permission: str) -> set[str]:
    """Full names of the topics or services that the policy allows in scenes of a kind."""
    profile = POLICY.find(f"enclaves/enclave[@path='/impact_predictor/{kind}']/profiles/profile")
    assert profile is not None
    assert (profile.get("ns"), profile.get("node")) == ("/", "impact_predictor")
    names = [one.text or "" for one in profile.findall(f"{tag}s[@{permission}='ALLOW']/{tag}")]
    assert len(set(names)) == len(names)
    return {name.replace("~", "/impact_predictor") if name[0] in "~/" else f"/{name}" for name in names}


KINDS: dict[str, list[dict[str, Any]]] = {
    "body": [{"file": "cube_tosses"}],
    "deck": [{"file": "deck_crate", "body.contact_points": ()}, {"file": "deck_crate", "support.motion": "imu"}],
    "cargo": [{"file": "deck_many"}, {"file": "deck_many", "support.motion": "imu"}],
    "walker": [
        {"file": "walker", "feet.has_schedule": True, "feet.force": 50.0, "feet.terrain": 0.02},
        {"file": "walker", "robot.urdf": "machine.urdf", "robot.frames": ("FL", "FR", "HL", "HR")},
    ],
}
"""Scenes that together have all that the policy allows for one of their kind: shipped ones, and what is changed."""


def values_of_scene(scene: dict[str, Any]) -> dict[str, Any]:
    changes = {name: value for name, value in scene.items() if name != "file"}
    return {**read_values(ROOT / f"config/{scene['file']}.yaml"), **changes}


def test_the_policy_has_an_enclave_for_each_kind_of_scene_and_denies_nothing_that_it_allows() -> None:
    assert POLICY.get("version") == "0.2.0"
    assert {one.get("path") for one in POLICY.iter("enclave")} == {f"/impact_predictor/{kind}" for kind in KINDS}
    assert {one.tag for one in POLICY.iter()} == {
        *("policy", "enclaves", "enclave", "profiles", "profile", "topics", "topic", "services", "service")
    }
    assert "DENY" not in {value for one in POLICY.iter() for value in one.attrib.values()}


@pytest.mark.parametrize("kind", KINDS)
def test_the_policy_allows_the_inputs_of_its_scenes_and_no_other(kind: str) -> None:
    read = {f"/{one.name}" for scene in KINDS[kind] for one in inputs_of(scenes_of(values_of_scene(scene)))}
    assert allowed(kind, "topic", "subscribe") - OF_TIME == read


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_what_the_running_node_has_in_the_graph_is_what_the_policy_allows(kind: str) -> None:
    pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")
    from graph import peer_of_node, running_node

    scene = {name: value for name, value in KINDS[kind][0].items() if value != ()}
    given = [word for name, value in scene.items() if name != "file" for word in ("-p", f"{name}:={value}")]
    read = {f"/{one.name}" for one in inputs_of(scenes_of(values_of_scene(scene)))}
    file = ROOT / f"config/{scene['file']}.yaml"
    with peer_of_node() as peer, running_node(file, "-p", "use_sim_time:=true", *given):
        peer.until(lambda: peer.heard["diagnostics"])

        def names(what: str) -> set[str]:
            found = getattr(peer.node, f"get_{what}_names_and_types_by_node")("impact_predictor", "/")
            return {name for name, _ in found}

        def all_names() -> tuple[set[str], ...]:
            return names("publisher"), names("service"), names("client"), names("subscriber") - OF_TIME

        wanted = allowed(kind, "topic", "publish"), allowed(kind, "service", "reply"), set(), read
        # What the graph tells of a node grows while it is discovered.
        with suppress(AssertionError):
            peer.until(lambda: all_names() == wanted)
        assert all_names() == wanted
        assert names("subscriber") <= allowed(kind, "topic", "subscribe")
