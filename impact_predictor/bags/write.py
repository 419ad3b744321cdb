"""Writing messages as bytes into one MCAP file or into a rosbag2 folder, so that nothing written is lost."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Final

from rosbags.interfaces import Connection
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode
from rosbags.typesys import Stores, get_typestore

from ..errors import InputError
from ..ros.messages.kinds import PACKAGE

_METADATA_VERSION: Final = 9
# One name for every output: it stands inside the file, and the same messages shall make the same bytes.
_BAG: Final = "bag"
_FILES: Final = (f"{_BAG}.mcap", "metadata.yaml")
_REPLACED: Final = "replaced"
_MARK: Final = ("written_by", "impact_predictor")

_MCAP_MAGIC: Final = b"\x89MCAP0\r\n"
_MCAP_FOOTER_SIZE: Final = 37
_LARGEST_METADATA: Final = 1 << 16


class BagWriter:
    """Writes a bag; a context manager.

    `X.mcap` becomes one MCAP file, any other name a rosbag2 folder. Until the end it is the bag `bag` in the folder
    `<name>.partial`. After an exception it stays there, complete up to the last message (without any it is removed),
    and an older output stays as it was. Only an output of this class is ever replaced. The bytes depend on the messages
    alone, not on the name.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Write to `path`; nothing happens before the context is entered."""
        self.path = Path(path)
        self.partial = Path(f"{self.path.absolute()}.partial")
        self._staged = self.partial / _BAG
        self._is_file = self.path.suffix == ".mcap"
        self._typestore = get_typestore(Stores.ROS2_JAZZY)
        self._connections: dict[tuple[str, str], Connection] = {}

    def __enter__(self) -> BagWriter:
        """Begin the bag; InputError where the place is taken by something that this class did not write, cannot be
        written, or is in no folder that there is.
        """
        if not self.path.absolute().parent.exists():
            raise InputError(f"the folder of {self.path} does not exist; make it, or give another name")
        try:
            _check_replaceable(self.path, self._is_file)
            _remove_partial(self.partial)
            self._writer = Writer(self._staged, version=_METADATA_VERSION, storage_plugin=StoragePlugin.MCAP)
            self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            self._writer.set_custom_data(*_MARK)
            self._writer.open()
        except OSError as error:
            raise self._unwritable(error) from error
        return self

    def write(self, topic: str, type_name: str, log_time: int, data: bytes) -> None:
        """Add a message in CDR; `log_time` in ns. InputError where the disk does not take it."""
        connection = self._connections.get((topic, type_name))
        if connection is None:
            if type_name.startswith(PACKAGE) and type_name not in self._typestore.fielddefs:
                from ..ros.messages.definitions import register

                register(self._typestore)
            connection = self._writer.add_connection(topic, type_name, typestore=self._typestore)
            self._connections[topic, type_name] = connection
        try:
            self._writer.write(connection, log_time, data)
        except OSError as error:
            raise self._unwritable(error) from error

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """End the bag and, unless an exception passes, give it its name; InputError where the disk does not take it."""
        if kind is not None:
            # What was written so far becomes a readable bag; the exception that passes matters more than a second one.
            with suppress(Exception):
                self._writer.close()
                if not self._connections:
                    _remove_partial(self.partial)
            return
        try:
            self._writer.close()
            if self._is_file:
                (self._staged / _FILES[0]).replace(self.path)
            else:
                if self.path.exists():
                    self.path.rename(self.partial / _REPLACED)
                self._staged.rename(self.path)
            _remove_partial(self.partial)
        except OSError as failure:
            raise self._unwritable(failure) from failure

    def _unwritable(self, error: OSError) -> InputError:
        kept = f"; what was written stays in {self._staged}" if self._staged.exists() else ""
        return InputError(f"{self.path} cannot be written: {error.strerror or error}{kept}")


def left_of(path: str | os.PathLike[str]) -> Path | None:
    """The bag that a `BagWriter` to `path` has left unfinished; it is cut off where the process was ended.

    None where there is none. One in which there is no message to be read is removed.
    """
    from .read import Bag

    partial = Path(f"{os.fspath(path)}.partial")
    try:
        with Bag(partial / _BAG) as bag:
            if bag.topics():
                return partial / _BAG
    except InputError:
        pass
    with suppress(InputError):
        _remove_partial(partial)
    return None


def _check_replaceable(path: Path, is_file: bool) -> None:
    """Refuse to replace anything that this module did not write; InputError where something else has the name."""
    if not os.path.lexists(path):
        return
    if path.is_dir():
        names = {child.name for child in path.iterdir()}
        replaceable = not is_file and (not names or (names <= set(_FILES) and _is_marked(path / _FILES[0])))
    else:
        replaceable = is_file and (path.stat().st_size == 0 or _is_marked(path))
    if not replaceable:
        raise InputError(f"{path} is there and is not an output of impact_predictor; move it away or give another name")


def _is_marked(file: Path) -> bool:
    """Whether the metadata of an MCAP file, which lie right before its summary, carry the mark of this module."""
    if not file.is_file() or file.stat().st_size < _MCAP_FOOTER_SIZE:
        return False
    with file.open("rb") as stream:
        stream.seek(-_MCAP_FOOTER_SIZE, os.SEEK_END)
        footer = stream.read()
        if not footer.endswith(_MCAP_MAGIC):
            return False
        summary = int.from_bytes(footer[9:17], "little")
        start = max(0, min(summary, file.stat().st_size) - _LARGEST_METADATA)
        stream.seek(start)
        return ": ".join(_MARK).encode() in stream.read(summary - start)


def _remove_partial(partial: Path) -> None:
    """Remove what this class leaves in a partial output, file by file: never anything else; InputError where something
    else is in there.
    """
    if not partial.exists():
        return
    try:
        for folder in (partial / _BAG, partial / _REPLACED):
            for name in (*_FILES, f"{_FILES[1]}.tmp"):
                (folder / name).unlink(missing_ok=True)
            if folder.exists():
                folder.rmdir()
        partial.rmdir()
    except OSError as error:
        raise InputError(f"{partial} cannot be removed ({error.strerror}); move it away") from error
