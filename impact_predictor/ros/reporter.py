"""What goes to /diagnostics and ~/markers: the units whenever their reports are due, the node itself every second."""

from __future__ import annotations

import time
from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from ..prediction.flaws import flaw_of
from ..prediction.monitor import Monitor
from ..prediction.scene import CONTACT_GEOMETRY, Input
from ..prediction.types import Geometry, Prediction, Status
from ..stamps import NANOSECONDS
from .cdr import diagnostic_array
from .diagnostics import Diagnostics
from .endpoints import Outlet, publisher
from .feet_report import FeetReport
from .inputs import Refusal
from .messages.outputs import DIAGNOSTIC_ARRAY, MARKER_ARRAY, encode_reports, report_statuses

if TYPE_CHECKING:
    from ..prediction.watch.watch import Report
    from .markers.scene import MarkerScene


class MarkerTopic:
    """Publishes what a drawing of the scenes shows; `drawing` is there while somebody looks."""

    def __init__(self, node: Node, monitor: Monitor) -> None:
        self.publisher = publisher(node, "~/markers", MARKER_ARRAY)
        self.drawing: MarkerScene | None = None
        self._monitor = monitor
        self._geometries: dict[str, Geometry] = {}

    def take(self, one: Input, message: Any) -> None:
        """Take an accepted message on an input: contact points also for later."""
        if one.kind == CONTACT_GEOMETRY:
            body = one.body or ""
            message = self._geometries[body] = self._monitor.predictors[body].brought(message)
        if self.drawing is not None and self.drawing.hear(self._monitor, one, message):
            self.show(message.stamp)

    def begin_anew(self) -> None:
        """Draw from now on what the scenes have become."""
        self.drawing = None
        self.look_for_viewers()

    def look_for_viewers(self) -> None:
        """Begin to draw when somebody looks, and end when nobody does any more."""
        if not self.publisher.get_subscription_count():
            self.drawing = None
        elif self.drawing is None:
            from .markers.scene import MarkerScene

            self.drawing = MarkerScene(self._monitor.scenes)
            for body, geometry in self._geometries.items():
                self.drawing.set_geometry(body, geometry)

    def show(self, stamp: int) -> None:
        """Publish the drawing if the time for it has come."""
        data = None if self.drawing is None else self.drawing.due(stamp)
        if data is not None:
            self.publisher.publish(data)


class Reporter:
    """Counts what happens to the messages, and publishes reports and markers of what came of them."""

    def __init__(self, node: Node, monitor: Monitor, counts_losses: bool, is_typed: bool = False) -> None:
        """Report for a node; `counts_losses` says whether its subscriptions are to tell what the middleware loses.

        Where messages are typed, the units under watch are told of on `~/deck` too.
        """
        self.on_lost = self._on_lost if counts_losses else None
        self.publisher = publisher(node, "/diagnostics", DIAGNOSTIC_ARRAY)
        self._outlet = Outlet(self.publisher)
        self._deck: Outlet | None = None
        if is_typed and monitor.watch is not None:
            from .messages.deck_state import DECK_STATE

            self._deck = Outlet(publisher(node, "~/deck", DECK_STATE.type_name))
        self.clock: Callable[[], int] = time.time_ns
        """The time (ns) with which stamps are compared."""
        self._node = node
        self._name = node.get_fully_qualified_name().lstrip("/")
        self._monitor = monitor
        # The stamp that counts, and when it came: that of the support where it has one.
        self._time: tuple[int, float] | None = None

    def listen(self, inputs: list[str]) -> None:
        """Expect messages on these inputs; the first is of the support where that moves."""
        # Last, because what is drawn takes the longest to load, and nobody waits for it.
        self.markers = MarkerTopic(self._node, self._monitor)
        self._support = inputs[0] if self._monitor.deck is not None else ""
        self.diagnostics = Diagnostics(self._name, perf_counter(), inputs, self._horizon)
        self._choose_clock()
        self.diagnostics.doubts = self._monitor.doubts
        self.diagnostics.lost = None if self.on_lost is None else 0
        for body, scene in self._monitor.scenes.items():
            if scene.walking is not None:
                self.diagnostics.feet[body] = FeetReport(body, self._monitor.predictors[body].contacts)

    def _horizon(self, name: str) -> float:
        return self._monitor.scenes[name.rpartition("/")[0]].horizon

    def _on_lost(self, event: Any) -> None:
        self.diagnostics.lost = (self.diagnostics.lost or 0) + event.total_count_change

    def answered(self, name: str, body: str, prediction: Prediction, latency: int, update: float, began: float) -> None:
        """A sample on an input was answered; costs as of `Diagnostics.accepted`, `began` by the steady clock."""
        now, sample = perf_counter(), prediction.sample
        if prediction.score is not None:
            self.diagnostics.settled(sample.child_frame_id, prediction.score)
        if prediction.feet:
            self.diagnostics.feet[body].take(prediction)
        if self.markers.drawing is not None:
            self.markers.drawing.take(body, prediction)
            self.markers.show(sample.stamp)
        if not self._support or self._time is None:
            self._time = sample.stamp, now
        self._publish(self.diagnostics.accepted(now, name, sample.stamp, latency, update, now - began))

    def took(self, one: Input, message: Any) -> None:
        """The monitor has accepted another message."""
        self.markers.take(one, message)
        now, name = perf_counter(), one.name
        if name in self.diagnostics.inputs.publishers and (
            name == self._support or not self._support or self._time is None
        ):
            self._time = message.stamp, now
        self._publish(self.diagnostics.taken(now, name))

    def refuse(self, name: str, status: Status, body: str | None = None, message: Any = None) -> None:
        """A message on an input, about a body, was refused."""
        reason = Refusal(name, status)
        flaw = flaw_of(self._monitor, body, status, message)
        changed = self.diagnostics.refused(perf_counter(), reason, flaw)
        if self.diagnostics.is_news(reason):
            self._node.get_logger().warning(f"refused a message on {reason.said(flaw)}")
        self._publish(changed)

    def second_over(self) -> None:
        """Sum up a second of the steady clock, in which time goes on for the units too."""
        now, latency = perf_counter(), self.diagnostics.latency
        had_flaw = latency.flaw
        self.diagnostics.second_over(now)
        if latency.flaw and not had_flaw:
            self._node.get_logger().warning(latency.flaw)
        self._choose_clock()
        if self._monitor.watch is not None and self._time is not None:
            stamp, heard = self._time
            self._monitor.silent(stamp + round((now - heard) * NANOSECONDS))
        self.markers.look_for_viewers()
        self._publish(True)

    def _choose_clock(self) -> None:
        """Compare stamps with simulated time where `use_sim_time`, which may be set at any time, says so.

        The clock of this machine is read in a tenth of the time that rclpy's takes.
        """
        is_simulated = self.diagnostics.latency.is_simulated = self._node.get_clock().ros_time_is_active
        self.clock = self._simulated_time if is_simulated else time.time_ns

    def _simulated_time(self) -> int:
        return int(self._node.get_clock().now().nanoseconds)

    def _publish(self, changed: bool) -> None:
        """Publish the reports on the units that are due, after that of the node if it has changed."""
        watch = self._monitor.watch
        if not (changed or (watch is not None and watch.is_due)):
            return
        reports = self._due()
        if reports and self._deck is not None and self._deck.listeners():
            from .messages.deck_state import encode_deck_state

            self._deck.send(encode_deck_state(reports, self._monitor.deck_report(reports)))
        if changed and self._outlet.listeners():
            statuses = [self.diagnostics.report(perf_counter())]
            statuses += report_statuses(reports, self._monitor.deck_report(reports), self._name)
            self._outlet.send(diagnostic_array(self._node.get_clock().now().nanoseconds, "", statuses))
        elif reports and self._outlet.listeners():
            stamp = max(report.stamp for report in reports)
            self._outlet.send(encode_reports(reports, stamp, self._name, self._monitor.deck_report(reports)))

    def _due(self) -> tuple[Report, ...]:
        """The reports on the units that are due, if anybody listens."""
        drawing = self.markers.drawing
        if drawing is None and not self._outlet.listeners() and not (self._deck and self._deck.listeners()):
            return ()
        reports = self._monitor.reports()
        if drawing is not None:
            drawing.take_reports(reports)
        return reports
