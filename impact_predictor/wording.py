"""Words that fit what is counted, for whoever says something: bags, reports, commands."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """A number of things, in words that fit one of them and many."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"
