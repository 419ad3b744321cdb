"""Samples that wait: all are answered while that takes a moment only, else the newest alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from heapq import merge
from math import inf
from operator import itemgetter
from time import perf_counter
from typing import Any, Final

from rclpy.qos import ReliabilityPolicy

from .endpoints import QUEUE

LONGEST: Final = 0.1
"""Seconds that a node may spend on samples that wait before it drops all of them but the newest."""


class Backlog:
    """What waits on the topics of one body when the executor hands over a sample.

    A node that was held up for a moment answers what it missed. One that cannot keep up drops samples, and then answers
    the newest alone until none waits behind it any more, so that it is never behind by more than `longest` and one
    answer. What else is told about the body meanwhile is heard, between the samples as it came between them. A user
    who makes the subscription reliable wants every sample: then none is dropped.
    """

    def __init__(
        self, samples: Any, others: Iterable[Any], answer: Callable[[bytes], None], longest: float = LONGEST
    ) -> None:
        """Watch a subscription to samples and those to all else that the answers depend on, each to bytes.

        `answer` takes a sample, and `longest` is in s.
        """
        self._samples, self._others, self._answer = samples, others, answer
        self._longest = inf if samples.qos_profile.reliability == ReliabilityPolicy.RELIABLE else longest
        self._is_behind = False

    def take(self, sample: bytes) -> int:
        """Answer a sample that the executor hands over, and what waits behind it; how many samples were dropped."""
        waiting = _waiting_on(self._samples, self._answer)
        if not waiting:
            self._is_behind = False
            self._answer(sample)
            return 0
        began, newest, dropped = perf_counter(), waiting[-1], 0
        told = [_waiting_on(other, other.callback) for other in self._others]
        # What came on one topic stays in its order, also where the clock was set back meanwhile.
        for message in [(0, self._answer, sample), *merge(*told, waiting, key=itemgetter(0))]:
            _, take, data = message
            if take is self._answer and message is not newest:
                self._is_behind = self._is_behind or perf_counter() - began > self._longest
                if self._is_behind:
                    dropped += 1
                    continue
            take(data)
        return dropped


_Message = tuple[int, Callable[[bytes], None], bytes]


def _waiting_on(subscription: Any, take: Callable[[bytes], None]) -> list[_Message]:
    """The messages that wait on a subscription: when each came (ns), who takes it, and its bytes."""
    found: list[_Message] = []
    # Whoever publishes faster than this takes must not keep the node here.
    while len(found) < QUEUE:
        message = subscription.handle.take_message(subscription.msg_type, True)
        if message is None:
            break
        data, about = message
        found.append((about["received_timestamp"], take, data))
    return found
