"""What it costs to draw: the markers of 1 and of 50 units on a moving deck, none or all with a touchdown ahead.

    python benchmarks/bench_markers.py

Prints minima: microseconds for a message of `MarkerScene.due` and for one answer that it takes, the length of the
message, and the part of a core at 10 messages a second with answers at 20 Hz for each unit.
"""

from __future__ import annotations

from math import cos, sin
from time import perf_counter_ns

from rich.console import Console
from rich.table import Table

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import MovingDeck, Scene
from impact_predictor.prediction.types import Felt, Moment, Prediction, Sample, Status
from impact_predictor.ros.markers.scene import PERIOD, MarkerScene

TURNS = 60
CASES = ((1, 0), (1, 1), (50, 0), (50, 5), (50, 50))
"""Units, and how many of them have a touchdown ahead."""
ANSWERS = 20.0
"""Hz of the samples of each unit."""

POINTS = tuple((x, y, -0.8) for x in (-0.4, 0.4) for y in (-0.5, 0.5))
BOX = Scene(10.0, ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)), 0.6, points=POINTS)
FELT = Felt((0.0, 0.5, -9.7), (0.1, 0.0, 0.0), (0.0, 0.0, 0.0))


def rocking(angle: float, omega: float) -> Sample:
    """The box on two of its edges, turned by `angle` in rad about one of them, on which it falls back."""
    across, up = cos(angle) * 0.5 - sin(angle) * 0.8, sin(angle) * 0.5 + cos(angle) * 0.8
    return Sample(
        *(0, "deck", "box", (0.0, across - 0.5, up), (sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle))),
        *((0.0, -0.8 * omega, 0.5 * omega), (omega, 0.0, 0.0), (0.0,) * 36, (0.0,) * 36),
    )


def measure(count: int, ahead: int) -> tuple[float, float, int]:
    """Microseconds for a message and for an answer, and the length of a message."""
    moment = Moment(0, "world", "deck", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), FELT, lambda _: FELT)
    names = [f"unit_{k}" for k in range(count)]
    scene = MarkerScene(dict.fromkeys(names, BOX._replace(deck=MovingDeck(extent=(-30.0, 30.0, -8.0, 8.0)))))
    scene.take_support(moment)
    sample = rocking(0.05, -0.8)
    touchdown = Predictor(BOX).update(sample).touchdown
    assert touchdown is not None
    answer = Prediction(Status.ACCEPTED, sample, touchdown, support=moment, relative=sample)
    drawing, taking, size = [], [], 0
    for turn in range(TURNS):
        stamp = turn * PERIOD
        now = answer._replace(relative=sample._replace(stamp=stamp))
        answers = [now if k < ahead else now._replace(touchdown=None) for k in range(count)]
        start = perf_counter_ns()
        for name, one in zip(names, answers, strict=True):
            scene.take(name, one)
        taken = perf_counter_ns()
        data = scene.due(stamp)
        drawing.append(perf_counter_ns() - taken)
        taking.append((taken - start) / count)
        assert data is not None
        size = len(data)
    return min(drawing) / 1e3, min(taking) / 1e3, size


def main() -> None:
    table = Table()
    for header in ("units", "touchdowns ahead", "message, us", "answer, us", "bytes", "part of a core, %"):
        table.add_column(header, justify="right")
    for count, ahead in CASES:
        message, answer, size = measure(count, ahead)
        part = 1e-4 * (message * 1e9 / PERIOD + answer * ANSWERS * count)
        table.add_row(str(count), str(ahead), f"{message:.0f}", f"{answer:.1f}", str(size), f"{part:.2f}")
    Console().print(table)


if __name__ == "__main__":
    main()
