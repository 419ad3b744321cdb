"""Bytes read as choices, so that one string of bytes is one input, whoever makes it: chance, or atheris by coverage."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Final, TypeVar

One = TypeVar("One")

ODD_NUMBERS: Final = (
    *(0.0, -0.0, 1.0, -1.0, 0.5, 1e-3, 1e-9, 1e3, 1e6, 1e12, 1e18, -1e12, 1e-160, 1e150, -1e150),
    *(float("nan"), float("inf"), float("-inf"), 5e-324, -5e-324, 2.2250738585072014e-308),
    *(1.7976931348623157e308, -1.7976931348623157e308, 3.4028235e38, 1e-45, 9007199254740993.0),
)


class Choices:
    """Takes choices from the front of some bytes; where they have ended, every choice is the first, which is tame."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def raw(self, count: int) -> bytes:
        taken = self._data[self._at : self._at + count]
        self._at += count
        return taken.ljust(count, b"\0")

    def below(self, count: int) -> int:
        """A whole number from 0 to below a count."""
        size = 1 if count <= 256 else 4
        return int.from_bytes(self.raw(size), "little") % count

    def once_in(self, count: int) -> bool:
        """True about once in so many times."""
        return self.below(65536 if count > 256 else 256) % count == count - 1

    def of(self, ones: Sequence[One]) -> One:
        return ones[self.below(len(ones))]

    def number(self, near: float = 0.0) -> float:
        """A double: an odd one, one of a size near another one, or any bits."""
        kind = self.below(4)
        if kind == 0:
            return near * (0.5 + self.below(256) / 256)
        if kind == 1:
            return near + (self.below(256) - 128) * 10.0 ** (self.below(24) - 16)
        if kind == 2:
            return self.of(ODD_NUMBERS)
        return float(struct.unpack("<d", self.raw(8))[0])

    def damaged(self, data: bytes) -> bytes:
        """Bytes that were cut, lengthened, changed here and there, or given huge lengths."""
        changed = bytearray(data)
        for _ in range(1 + self.below(4)):
            at = self.below(max(len(changed), 1))
            kind = self.below(8)
            if kind == 0:
                changed[at : at + 1] = bytes([self.below(256)])
            elif kind == 1:
                changed[at : at + 1] = bytes([(changed[at] if changed else 0) ^ 1 << self.below(8)])
            elif kind == 2:
                del changed[at:]
            elif kind == 3:
                changed[at:at] = self.raw(self.below(16))
            elif kind == 4:
                at &= -4
                length = self.of((0, 1, 0xFFFFFFFF, 0x7FFFFFFF, 0x80000000, 0x00FFFFFF, 65536, len(changed)))
                changed[at : at + 4] = struct.pack("<I", length)
            elif kind == 5:
                at = at & -8 | 4
                changed[at : at + 8] = struct.pack("<d", self.number())
            elif kind == 6:
                del changed[at : at + self.below(16)]
            else:
                end = at + self.below(64)
                changed[at:at] = changed[at:end]
        return bytes(changed)
