"""Stamps are whole nanoseconds, as in ROS messages."""

from typing import Final

NANOSECONDS: Final = 1_000_000_000
"""In a second."""
