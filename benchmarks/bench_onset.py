"""What it costs to watch the margins of 1 and of 50 units, boxes alone, with cylinders among them, or lashed.

    python benchmarks/bench_onset.py

Prints microseconds, the least and the median: the margins at one message of the deck and at all times ahead of 96
courses, the whole of `Watch.update_support` with and without a look ahead, `Watch.update_body` of a unit that rests and
of one that rocks, and `Watch.reports` with nothing due and with a report of each unit.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from statistics import median
from time import perf_counter_ns

import numpy as np
from rich.console import Console
from rich.table import Table

from impact_predictor.prediction.deck.forecast import COURSES, STEP, DeckOutlook
from impact_predictor.prediction.scene import Chock, Lashing, MovingDeck, Scene, Watching
from impact_predictor.prediction.types import Felt, Moment, Sample
from impact_predictor.prediction.watch.onset import Onset, motion_of, motions
from impact_predictor.prediction.watch.standing import Standing
from impact_predictor.prediction.watch.watch import Watch

TURNS = 1000
CASES = ((1, 0, 0), (50, 0, 0), (50, 10, 0), (1, 0, 1), (50, 0, 50))
"""Units, how many of them are cylinders, and how many have eight lashings and a chock."""
LEVEL = (0.0, 0.0, 0.0, 1.0)
ORIGIN = (0.0, 0.0, 0.0)

BOX = Scene(
    50.0,
    ((8.0, 0.0, 0.0), (0.0, 8.0, 0.0), (0.0, 0.0, 4.0)),
    0.4,
    points=tuple((x, y, z) for x in (-0.4, 0.4) for y in (-0.3, 0.3) for z in (-0.6, 0.6)),
    place=(0.0, 0.0, 0.6),
    deck=MovingDeck(),
    source="none",
    watching=Watching(),
)
DRUM = BOX._replace(points=(), radius=0.3, edges=((0.0, -0.1, 0.0), (0.0, 0.1, 0.0)), place=(0.0, 0.0, 0.28))

LASHED = BOX._replace(
    lashings=tuple(
        Lashing((x, 0.3 * side, 0.0), (x, 1.2 * side, 0.0), 500.0, 50.0)
        for side in (-1.0, 1.0)
        for x in (-0.4, -0.2, 0.2, 0.4)
    ),
    chocks=(Chock((0.4, 0.0, 0.1), (-1.0, 0.0, 0.0), 300.0),),
)


def felt(time: float) -> Felt:
    """On a deck that rolls and sways."""
    return Felt((0.1, -3.0 * sin(time), -9.6), (0.1 * cos(time), 0.0, 0.0), (-0.1 * sin(time), 0.0, 0.0))


def outlook(horizon: float) -> DeckOutlook:
    """As many courses, and as many times of each, as of a sea that is learnt."""
    times = np.arange(0.0, horizon, STEP / 1e9)
    values = np.array([felt(time) for time in times.tolist()])
    gravity, angular, turning = np.tile(values, (2 * COURSES, 1, 1, 1)).transpose(2, 0, 1, 3)
    return DeckOutlook(times=times, gravity=gravity, angular=angular, turning=turning, is_learnt=True)


def timed(*actions: Callable[[int], object]) -> list[tuple[float, float]]:
    """The least and the median time in microseconds of each action, which take turns."""
    costs: list[list[int]] = [[] for _ in actions]
    for turn in range(TURNS):
        for action, cost in zip(actions, costs, strict=True):
            start = perf_counter_ns()
            action(turn)
            cost.append(perf_counter_ns() - start)
    return [(1e-3 * min(cost), 1e-3 * median(cost)) for cost in costs]


def measure(count: int, drums: int, lashed: int) -> list[tuple[str, float, float]]:
    scenes = {f"unit_{k}": DRUM if k < drums else LASHED if k < lashed else BOX for k in range(count)}
    onset = Onset([Standing(scene).stance for scene in scenes.values()])
    now, ahead = motion_of(felt(0.5)), motions(*(part.reshape(-1, 3) for part in outlook(10.0)[1:4]))
    found = list(
        zip(
            ("margins, one message", "margins, all courses"),
            timed(lambda _: onset.margins(now), lambda _: onset.margins(ahead)),
            strict=True,
        )
    )
    watch = Watch(scenes, outlook)
    updates: dict[str, list[int]] = {"deck message": [], "deck message, looks ahead": []}
    reports: dict[str, list[int]] = {"reports, nothing due": [], "reports, due": []}
    for turn in range(TURNS):
        time = 0.01 * turn
        moment = Moment(turn * 10_000_000, "world", "deck", ORIGIN, LEVEL, ORIGIN, felt(time), felt)
        start = perf_counter_ns()
        watch.update_support(moment)
        updates["deck message, looks ahead" if turn % 25 == 0 else "deck message"].append(perf_counter_ns() - start)
        start = perf_counter_ns()
        due = watch.reports()
        reports["reports, due" if due else "reports, nothing due"].append(perf_counter_ns() - start)
    for name, cost in (*updates.items(), *reports.items()):
        found.append((name, (1e-3 * min(cost), 1e-3 * median(cost))))
    body = Watch({"unit": BOX._replace(source="odom")}, outlook)
    rests = Sample(0, "deck", "unit", BOX.place, LEVEL, ORIGIN, ORIGIN, (), ())
    rocks = [rests._replace(orientation=(sin(half), 0.0, 0.0, cos(half))) for half in (0.05, 0.06)]
    resting = timed(lambda turn: body.update_body("unit", rests._replace(stamp=turn), None))
    rocking = timed(lambda turn: body.update_body("unit", rocks[turn % 2]._replace(stamp=turn), None))
    found += [("pose of a unit that rests", resting[0]), ("pose of a unit that rocks", rocking[0])]
    return [(name, *cost) for name, cost in found]


def main() -> None:
    table = Table(
        "us: least / median", *(f"{count} ({drums} round, {lashed} lashed)" for count, drums, lashed in CASES)
    )
    rows = zip(*(measure(*case) for case in CASES), strict=True)
    for row in rows:
        table.add_row(row[0][0], *(f"{least:.1f} / {middle:.1f}" for _, least, middle in row))
    Console().print(table)


if __name__ == "__main__":
    main()
