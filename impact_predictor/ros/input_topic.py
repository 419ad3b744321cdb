"""A topic whose messages the monitor takes without an answer."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..prediction.types import Status
from .messages import MalformedMessage
from .reporter import Reporter

if TYPE_CHECKING:
    from .markers.scene import MarkerScene


class InputTopic:
    """Decodes the messages on a topic, hands them over and tells the reporter what became of them.

    `update` hands a message to the monitor, and `draw` an accepted one to the markers while somebody looks.
    """

    def __init__(
        self,
        reporter: Reporter,
        name: str,
        decode: Callable[[bytes], Any],
        update: Callable[[Any], Status],
        draw: Callable[[MarkerScene, Any], None] | None = None,
    ) -> None:
        self._reporter, self._name = reporter, name
        self._decode, self._update, self._draw = decode, update, draw

    def take(self, data: bytes) -> None:
        """A message, as bytes."""
        try:
            message = self._decode(data)
        except MalformedMessage:
            self._reporter.refuse(self._name, Status.MALFORMED)
            return
        status = self._update(message)
        markers = self._reporter.markers
        if markers.drawing is not None and self._draw is not None and status is Status.ACCEPTED:
            self._draw(markers.drawing, message)
            markers.show(message.stamp)
        self._reporter.took(self._name, status, message.stamp)
