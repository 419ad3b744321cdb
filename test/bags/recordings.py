"""Bags of every format, with the first recorded tosses in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as McapWriter
from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode
from rosbags.typesys import Stores, get_typestore

from impact_predictor.bags.read import BagMessage, read_messages
from impact_predictor.bags.write import BagWriter
from impact_predictor.ros.messages import ODOMETRY, POLYGON

RECORDED = Path(__file__).parents[2] / "examples/cube_tosses/cube_tosses.mcap"
WANTED = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
NOETIC = get_typestore(Stores.ROS1_NOETIC)
CHUNK = 20_000
"""Bytes of the chunks of small bags: about 27 messages."""


@cache
def first_messages(count: int) -> list[BagMessage]:
    """The first messages of the recorded tosses."""
    stream = read_messages(RECORDED, WANTED)
    return [next(stream) for _ in range(count)]


def write_bag(path: Path, messages: Iterable[BagMessage], types: Mapping[str, str] = WANTED) -> Path:
    """A bag as the package writes it."""
    with BagWriter(path) as writer:
        for topic, log_time, data in messages:
            writer.write(topic, types[topic], log_time, data)
    return path


def write_plan(path: Path, seconds: float) -> Path:
    """The first seconds of the plan of HyQ: up to 4 s it walks and changes to a trot."""
    with Ros1Reader(RECORDED.parents[1] / "hyq/hyq.bag") as reader, Ros1Writer(path) as writer:
        (one,) = [one for one in reader.connections if one.topic == "/xpp/state_des"]
        written = writer.add_connection(one.topic, one.msgtype, msgdef=one.msgdef.data, md5sum=one.digest)
        for _, stamp, data in reader.messages([one], stop=round(seconds * 1e9)):
            writer.write(written, stamp, data)
    return path


def write_ros2(
    path: Path, messages: list[BagMessage], plugin: StoragePlugin, mode: CompressionMode = CompressionMode.NONE
) -> Path:
    """A rosbag2 folder."""
    writer = Writer(path, version=9, storage_plugin=plugin)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Connection] = {}
        for topic, log_time, data in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, WANTED[topic], typestore=TYPESTORE)
            writer.write(connections[topic], log_time, data)
    return path


def write_ros1(path: Path, messages: list[BagMessage], compression: Ros1Writer.CompressionFormat | None = None) -> Path:
    """A ROS 1 bag of small chunks."""
    writer = Ros1Writer(path)
    writer.chunk_threshold = CHUNK
    if compression is not None:
        writer.set_compression(compression)
    with writer:
        connections: dict[str, Connection] = {}
        for topic, log_time, data in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, WANTED[topic], typestore=NOETIC)
            writer.write(connections[topic], log_time, in_ros1(topic, data))
    return path


def in_ros1(topic: str, data: bytes) -> bytes:
    """A message as ROS 1 writes it."""
    return bytes(TYPESTORE.cdr_to_ros1(data, WANTED[topic]))


def write_mcap(
    path: Path,
    messages: list[BagMessage],
    compression: CompressionType = CompressionType.ZSTD,
    *,
    chunked: bool = True,
    indexed: bool = True,
    checksum: bool = False,
    encoding: str = "cdr",
    types: dict[str, str] = WANTED,
) -> Path:
    """An MCAP file of small chunks; one that is not indexed has neither index nor summary."""
    schema = "ros1msg" if encoding == "ros1" else "ros2msg"
    with path.open("wb") as file:
        writer = McapWriter(
            file,
            chunk_size=CHUNK,
            compression=compression,
            index_types=IndexType.ALL if indexed else IndexType.NONE,
            repeat_channels=indexed,
            repeat_schemas=indexed,
            use_chunking=chunked,
            use_statistics=indexed,
            use_summary_offsets=indexed,
            enable_data_crcs=checksum,
        )
        writer.start(profile="", library="test")
        channels: dict[str, int] = {}
        for topic, log_time, data in messages:
            if topic not in channels:
                name = types[topic]
                store = NOETIC if encoding == "ros1" else TYPESTORE
                definition = store.generate_msgdef(WANTED[topic], ros_version=1 if encoding == "ros1" else 2)[0]
                id_ = writer.register_schema(name, schema, definition.encode()) if name else 0
                channels[topic] = writer.register_channel(topic, encoding, id_)
            message = in_ros1(topic, data) if encoding == "ros1" else data
            writer.add_message(channels[topic], log_time, message, log_time)
        writer.finish()
    return path
