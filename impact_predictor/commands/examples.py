"""Examples at the end of a command's help."""

from __future__ import annotations


def examples(*lines: str) -> str:
    """The epilog of a command's help; click wraps no paragraph that begins with a backspace."""
    return "\n  ".join(("\b\nExamples:", *lines))
