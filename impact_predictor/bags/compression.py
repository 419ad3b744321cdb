"""Decompressing files, chunks and messages of bags."""

from __future__ import annotations

import sys
from bz2 import BZ2Decompressor
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from lz4.frame import LZ4FrameDecompressor

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

ZSTD_MAGIC: Final = b"\x28\xb5\x2f\xfd"
"""What zstd begins with, and no message in CDR does."""

_DECOMPRESSORS: Final[dict[str, Callable[[], Any]]] = {
    "zstd": zstd.ZstdDecompressor,
    "lz4": LZ4FrameDecompressor,
    "bz2": BZ2Decompressor,
}
_PIECE: Final = 1 << 20

LARGEST: Final = 1 << 30
"""Bytes above which nothing is read or decompressed at once: a bag of a few bytes may claim any number."""


def decompressed(data: bytes, name: str, most: int) -> bytes:
    """What there is without a compression of some name ("" and "none" are none), and never more than `most` bytes.

    Of data that were cut off it is the beginning.

    Raises:
        KeyError: there is no such compression.
        Exception: the data are damaged; each library raises errors of its own.
    """
    if name in ("", "none"):
        return data
    decompressor = _DECOMPRESSORS[name]()
    pieces: list[bytes] = []
    while most > 0:
        piece = decompressor.decompress(data, most)
        pieces.append(piece)
        most -= len(piece)
        data = b""
        if decompressor.eof:
            data = decompressor.unused_data or b""
            if not data:
                break
            decompressor = _DECOMPRESSORS[name]()
        elif not piece:
            break
    return b"".join(pieces)


def decompressed_message(data: bytes) -> bytes:
    """A message that is compressed by itself.

    Raises:
        Exception: it is damaged, or larger than `LARGEST`.
    """
    message = decompressed(data, "zstd", LARGEST + 1)
    if len(message) > LARGEST:
        raise ValueError(f"a message has more than {LARGEST:,} bytes")
    return message


def decompress_file(source: Path, target: Path) -> bool:
    """Decompress a file as far as it goes; whether that is to its end.

    Raises:
        OSError: a file cannot be read or written.
    """
    with target.open("wb") as file:
        try:
            for piece in _pieces(source):
                file.write(piece)
        except (EOFError, zstd.ZstdError):
            return False
    return True


def _pieces(path: Path) -> Iterator[bytes]:
    with zstd.open(path, "rb") as source:
        # Not `read`: it keeps back what comes right before the damage.
        while piece := source.read1(_PIECE):
            yield piece
