"""Bags whose bytes were changed: replayed as far as they go, or refused in one sentence."""

from __future__ import annotations

import json
import shutil
import tempfile
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any, Final

from fuzz_choices import Choices
from fuzz_messages import ROOT
from fuzz_parameters import check_sentence

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.prediction.scene import read_scenes
from impact_predictor.report.answers import as_json

MESSAGES: Final = 120
SOURCE: Final = ROOT / "examples/cube_tosses"
NAMES: Final = ("plain.mcap", "zstd.mcap", "lz4.mcap", "folder", "sqlite", "packed", "old.bag")


@cache
def bags() -> tuple[tuple[str, dict[str, bytes]], ...]:
    """Small bags of every format: the name of each, and the bytes of its files."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz_"))
    types = topics(SOURCE)
    messages = list(islice(read_messages(SOURCE, types), MESSAGES))
    made = {name: _write(folder / name, types, messages) for name in NAMES}
    shutil.rmtree(folder)
    return tuple(made.items())


def _write(path: Path, types: dict[str, str], messages: list[Any]) -> dict[str, bytes]:
    from rosbags import rosbag1, rosbag2
    from rosbags.rosbag2.enums import CompressionFormat, CompressionMode
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    if path.suffix == ".bag":
        old = get_typestore(Stores.ROS1_NOETIC)
        with rosbag1.Writer(path) as bag:
            known = {topic: bag.add_connection(topic, kind, typestore=old) for topic, kind in types.items()}
            for number, (topic, log_time, data) in enumerate(messages):
                value: Any = store.deserialize_cdr(data, types[topic])
                object.__setattr__(value.header, "seq", number)
                bag.write(known[topic], log_time, old.serialize_ros1(value, types[topic]))
        return {path.name: path.read_bytes()}
    plugin = rosbag2.StoragePlugin.SQLITE3 if path.name == "sqlite" else rosbag2.StoragePlugin.MCAP
    storage = path.with_suffix("") if path.suffix else path
    writer = rosbag2.Writer(storage, version=9, storage_plugin=plugin)
    if path.name in ("zstd.mcap", "packed"):
        mode = CompressionMode.FILE if path.name == "packed" else CompressionMode.STORAGE
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer as written:
        its = {topic: written.add_connection(topic, kind, typestore=store) for topic, kind in types.items()}
        for topic, log_time, data in messages:
            written.write(its[topic], log_time, data)
    files = {file.name: file.read_bytes() for file in sorted(storage.iterdir())}
    if not path.suffix:
        return files
    return {path.name: next(data for name, data in files.items() if name.endswith(".mcap"))}


@cache
def _scene() -> Any:
    return read_scenes(ROOT / "config/cube_tosses.yaml")


@cache
def _folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="fuzz_"))


def fuzz_bags(choices: Choices) -> str:
    """One input: a bag; what it was about.

    Raises:
        Flaw: the property does not hold.
    """
    name, files = choices.of(bags())
    folder = _folder()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    damaged = choices.below(len(files))
    for number, (file, data) in enumerate(files.items()):
        (folder / file).write_bytes(choices.damaged(data) if number == damaged else data)
    path = folder / name if len(files) == 1 else folder
    output = folder.with_suffix(".mcap") if choices.once_in(4) else None
    try:
        result = replay(path, _scene(), output=output)
    except InputError as error:
        check_sentence(error)
        return f"{name}, refused"
    json.dumps(as_json(result), allow_nan=False)
    return f"{name}, {'damaged' if result.damaged else 'whole'}"
