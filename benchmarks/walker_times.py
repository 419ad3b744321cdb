"""How right the told landing times of walking machines are, beside the answers that anybody would try first.

    python benchmarks/walker_times.py [--seed N [--world]] [BAG SCENE]...

Each BAG has /odom, /contact_geometry or /feet_states, and the true landings on /truth/landings; a schedule and the
terrain are told too. Without bags it is the plan of HyQ.
Prints for each record, 50, 20 and 10 ms before its true landings: the median error of the told time and what 90 % are
below, the part of the landings that is told by then, and for the product how often the truth lies within one and two
told standard deviations. `false` counts rows of samples that told a landing, no more than 50 ms ahead, that did not
come within 30 ms. Of true landings `noticed` is the part after which the foot is told to stand within 10 ms, and
`stamped` that which is dated within 2 ms; `none` counts landings that are told to have happened, and did not within
50 ms. The simple answers are asked at the same samples, of feet that the product takes to swing:

- speed: the gap over its speed in the last 10 ms,
- parabola, cubic: those nearest to the gaps of the last 30 and 60 ms (least squares),
- clock: the planned landing next to come, or without a plan the last true landing and the true stride before it.

`worse` is the mean error 20 ms ahead less that of the gap over its speed, where both are told, with the 95 % interval
of a bootstrap over landings. With a seed all samples get noise of 1 mm on each coordinate and 0.02 m/s on each part of
each velocity, of the trunk and of the feet, which are told relative to the noisy trunk, or with --world beside it.
"""

from __future__ import annotations

import argparse
import sys
from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from rich.console import Console

from impact_predictor.bags.adapters import Adapted, readers
from impact_predictor.bags.read import Bag
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import (
    CONTACT_GEOMETRY,
    FEET_STATES,
    ODOM,
    SCHEDULE,
    TERRAIN,
    Scene,
    Walking,
    read_scenes,
)
from impact_predictor.prediction.types import FeetStates, Geometry, Sample, Schedule, Score, Terrain, Vector3
from impact_predictor.prediction.vectors import axes_of, to_world
from impact_predictor.report.table import plain_table, show
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, INPUT_TYPES
from impact_predictor.scenarios.truth import LANDING_TOPIC, TrueLanding, decode_truths

ROOT: Final = Path(__file__).resolve().parents[1]
PLAN: Final = ROOT / "examples/hyq/hyq.bag", "/xpp/state_des", "xpp_msgs/msg/RobotStateCartesian"
KINDS: Final = (ODOM, CONTACT_GEOMETRY, FEET_STATES, SCHEDULE, TERRAIN)
POSITION: Final = 1e-3
"""Standard deviation of the noise of each coordinate, in m ..."""
VELOCITY: Final = 0.02
"""... and of each part of a velocity, in m/s."""
LEAD_TIMES: Final = (0.05, 0.02, 0.01)
TOLD: Final = 0.05
"""A row of samples tells a landing when it does so no further ahead than this, in s."""
TRUE: Final = 0.03
"""Seconds from the told landing within which a true one makes it no false alarm."""
RESAMPLED: Final = 2000
NOTICED: Final = 10_000_000
"""Nanoseconds after a landing within which it is noticed ..."""
STAMPED: Final = 2_000_000
"""... within which its stamp is right ..."""
HAPPENED: Final = 50_000_000
"""... and within which it has happened at all."""
LINES: Final = ("product", "speed", "parabola", "cubic", "clock")


Message = Sample | Geometry | FeetStates | Schedule | Terrain


class Walk(NamedTuple):
    """A record of a machine that walks: its messages in order, and when each of its feet truly landed (ns)."""

    name: str
    scene: Scene
    messages: Sequence[Message]
    landings: Mapping[str, Sequence[int]]


class Told(NamedTuple):
    """What a line tells at a sample of a foot that swings: stamps in ns, the deviation in s."""

    seen: int
    stamp: int
    deviation: float | None = None


class Line(NamedTuple):
    """A line's signed errors in s ahead of each landing by lead time (NaN: not told), deviations alike, and alarms."""

    errors: Mapping[float, np.ndarray]
    deviations: Mapping[float, np.ndarray]
    rows: int
    false: int


class Replayed(NamedTuple):
    """What each line tells of each foot, in order, the stamps in ns at which feet stand, and the scores."""

    told: dict[str, dict[str, list[Told]]]
    stands: dict[str, list[int]]
    scores: list[Score]


class FootCourse:
    """The gaps of a foot over the plane of the scene, for the simple answers."""

    def __init__(self) -> None:
        self._stamps: list[float] = []
        self._gaps: list[float] = []

    def add(self, stamp: int, gap: float) -> None:
        self._stamps.append(stamp * 1e-9)
        self._gaps.append(gap)

    def lead_times(self) -> dict[str, float | None]:
        """What the simple answers tell now."""
        return {
            "speed": self._descent(0.01, 1),
            "parabola": self._descent(0.03, 2),
            "cubic": self._descent(0.06, 3),
        }

    def _descent(self, span: float, degree: int) -> float | None:
        now = self._stamps[-1]
        first = bisect_left(self._stamps, now - span - 1e-6)
        times, gaps = np.array(self._stamps[first:]) - now, np.array(self._gaps[first:])
        if len(times) <= degree:
            return None
        if degree == 1:  # the mean speed, from the present gap
            fit = np.array([(gaps[-1] - gaps[0]) / (times[-1] - times[0]), gaps[-1]])
        else:
            fit = np.polyfit(times / span, gaps, degree) / span ** np.arange(degree, -1, -1)
        roots = np.roots(fit)
        ahead = [float(root.real) for root in roots if abs(root.imag) < 1e-9 and root.real > 0.0]
        falls = [time for time in ahead if np.polyval(np.polyder(fit), time) < 0.0]
        return min(falls, default=None)


def replayed(walk: Walk, lines: Sequence[str] = LINES) -> Replayed:
    """What the product tells of a record, and of these lines the simple ones."""
    machine, walker, courses = walk.scene, Predictor(walk.scene), defaultdict[str, FootCourse](FootCourse)
    assert machine.walking is not None
    stands, scores = defaultdict[str, list[int]](list), list[Score]()
    told: dict[str, dict[str, list[Told]]] = {line: defaultdict(list) for line in lines}
    planned: dict[str, list[int]] = defaultdict(list)
    points: Sequence[Vector3] = ()
    simple = len(lines) > 1
    for message in walk.messages:
        if not isinstance(message, Sample):
            walker.tell(message)
            if isinstance(message, Schedule):
                for name, landings in landings_of(message).items():
                    planned[name] = [stamp for stamp in planned[name] if stamp < message.times[0]] + landings
            elif isinstance(message, Geometry | FeetStates):
                points = points_of(message, machine.walking)
            continue
        now, axes = message.stamp, axes_of(message.orientation)
        gaps = []
        for arm in points if simple else ():
            place = np.add(message.position, to_world(axes, arm))
            gaps.append(float(np.dot(machine.normal, place)) - machine.height)
        each = machine.walking.points
        prediction = walker.update(message)
        scores += [] if prediction.score is None else [prediction.score]
        for number, foot in enumerate(prediction.feet):
            course = courses[foot.name]
            if simple:
                course.add(now, min(gaps[number * each : (number + 1) * each]))
            if foot.stands:
                stands[foot.name].append(now)
                continue
            answers: dict[str, float | None] = {"product": foot.lead_time}
            if simple:
                answers |= course.lead_times()
                answers["clock"] = clock(walk.landings.get(foot.name, ()), planned.get(foot.name, []), now)
            for line in lines:
                lead_time = answers[line]
                if lead_time is not None and 0.0 < lead_time <= machine.horizon:
                    deviation = foot.landing_deviation if line == "product" else None
                    told[line][foot.name].append(Told(now, now + round(lead_time * 1e9), deviation))
    return Replayed(told, stands, [*scores, *walker.finish()])


def points_of(message: Geometry | FeetStates, walking: Walking) -> Sequence[Vector3]:
    """Where the points of the feet are, in the order of the scene."""
    if isinstance(message, Geometry):
        return message.points
    return [message.positions[i] for foot in walking.feet for i, name in enumerate(message.names) if name == foot]


def clock(landings: Sequence[int], planned: Sequence[int], now: int) -> float | None:
    """Seconds until the planned landing that comes next, or without a plan until a stride after the last true one."""
    if planned:
        ahead = [stamp for stamp in planned if stamp > now]
        return (min(ahead) - now) * 1e-9 if ahead else None
    past = bisect_right(landings, now)
    return None if past < 2 else (2 * landings[past - 1] - landings[past - 2] - now) * 1e-9


def landings_of(schedule: Schedule) -> dict[str, list[int]]:
    """The planned landings of each foot."""
    found: dict[str, list[int]] = {}
    for number, foot in enumerate(schedule.feet):
        stands = [one[number] for one in schedule.stands]
        found[foot] = [schedule.times[k] for k in range(1, len(stands)) if stands[k] and not stands[k - 1]]
    return found


def line_of(walk: Walk, told: Mapping[str, Sequence[Told]], samples: Sequence[int]) -> Line:
    """How right a line was; `samples` are the stamps at which it could tell something."""
    errors: dict[float, list[float]] = {lead: [] for lead in LEAD_TIMES}
    deviations: dict[float, list[float]] = {lead: [] for lead in LEAD_TIMES}
    rows = false = 0
    places = {stamp: k for k, stamp in enumerate(samples)}
    for foot, landings in walk.landings.items():
        of_foot = {one.seen: one for one in told.get(foot, ())}
        for landing in landings:
            for lead in LEAD_TIMES:
                k = bisect_right(samples, landing - round(lead * 1e9)) - 1
                one = of_foot.get(samples[k]) if k >= 0 else None
                # What is told of a foot that stands until later is none of this landing.
                errors[lead].append(np.nan if one is None else (one.stamp - landing) * 1e-9)
                deviations[lead].append(np.nan if one is None or one.deviation is None else one.deviation)
        near = [one for one in told.get(foot, ()) if one.stamp - one.seen <= TOLD * 1e9]
        for k, one in enumerate(near):
            goes_on = k + 1 < len(near) and places[near[k + 1].seen] == places[one.seen] + 1
            if not goes_on and one.stamp <= samples[-1] - TRUE * 1e9:
                rows += 1
                false += min([abs(one.stamp - landing) for landing in landings], default=10**12) > TRUE * 1e9
    return Line(
        {lead: np.array(ones) for lead, ones in errors.items()},
        {lead: np.array(ones) for lead, ones in deviations.items()},
        rows,
        false,
    )


def happened(walk: Walk, found: Replayed) -> dict[str, Any]:
    """How the landings are told that have happened."""
    noticed = stamped = none = 0
    for foot, landings in walk.landings.items():
        stamps = [one.landing.stamp for one in found.scores if one.landing is not None and one.landing.foot == foot]
        none += sum(min((abs(stamp - one) for one in landings), default=HAPPENED) >= HAPPENED for stamp in stamps)
        stamped += sum(min((abs(stamp - one) for stamp in stamps), default=HAPPENED) <= STAMPED for one in landings)
        stands = found.stands[foot]
        for landing in landings:
            k = bisect_right(stands, landing)
            noticed += k < len(stands) and stands[k] <= landing + NOTICED
    count = max(1, sum(map(len, walk.landings.values())))
    return {"noticed": noticed / count, "stamped": stamped / count, "none": none}


def worse(line: Line, other: Line, lead: float) -> tuple[float, float, float] | None:
    """The mean error in s less that of another line where both tell one, with the bootstrap's 95 % interval."""
    apart = np.abs(line.errors[lead]) - np.abs(other.errors[lead])
    apart = apart[~np.isnan(apart)]
    if len(apart) < 5:
        return None
    rng = np.random.default_rng(0)
    means = rng.choice(apart, (RESAMPLED, len(apart))).mean(axis=1)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(apart.mean()), float(low), float(high)


def figures(walk: Walk, asked: Sequence[str] = LINES) -> list[dict[str, Any]]:
    """What is printed of a record, in ms and parts of 1, a row for each line that is asked for."""
    replay, found = replayed(walk, asked), list[dict[str, Any]]()
    samples = [message.stamp for message in walk.messages if isinstance(message, Sample)]
    lines = {name: line_of(walk, told, samples) for name, told in replay.told.items()}
    for name, line in lines.items():
        row: dict[str, Any] = {"record": walk.name, "line": name, "landings": sum(map(len, walk.landings.values()))}
        for lead in LEAD_TIMES:
            errors, deviations = line.errors[lead], line.deviations[lead]
            known = ~np.isnan(errors)
            ahead: dict[str, Any] = {"told": float(known.mean()) if known.size else 0.0}
            if known.any():
                off = np.abs(errors[known])
                ahead |= {"median": 1e3 * float(np.median(off)), "most": 1e3 * float(np.quantile(off, 0.9))}
                ahead |= {"bias": 1e3 * float(np.median(errors[known]))}
            if (sure := ~np.isnan(deviations)).any():
                off = np.abs(errors[sure]) / deviations[sure]
                ahead |= {"within_one": float((off <= 1.0).mean()), "within_two": float((off <= 2.0).mean())}
            row[f"{1e3 * lead:.0f}"] = ahead
        row |= {"rows": line.rows, "false": line.false} | (happened(walk, replay) if name == LINES[0] else {})
        if name != "speed" and "speed" in lines and (apart := worse(line, lines["speed"], 0.02)) is not None:
            row["worse"] = [1e3 * one for one in apart]
        found.append(row)
    return found


def table_of(rows: Iterable[Mapping[str, Any]]) -> Any:
    table = plain_table()
    table.add_column("record", no_wrap=True)
    table.add_column("line", no_wrap=True)
    for lead in LEAD_TIMES:
        for header in (f"{1e3 * lead:.0f} ms\nahead", "90 %\nms", "told\n%"):
            table.add_column(header, justify="right", no_wrap=True)
    for header in ("20 ms: in\n1, 2 sd", "false\nof rows", "worse\nms", "noticed,\nstamped %", "none"):
        table.add_column(header, justify="right", no_wrap=True)
    for row in rows:
        cells = [f"{row['record']} ({row['landings']})" if row["line"] == LINES[0] else "", row["line"]]
        for lead in LEAD_TIMES:
            ahead = row[f"{1e3 * lead:.0f}"]
            cells += [f"{ahead[key]:.1f}" if key in ahead else "" for key in ("median", "most")]
            cells.append(f"{100.0 * ahead['told']:.0f}")
        ahead = row["20"]
        cells.append(
            f"{100 * ahead['within_one']:.0f}, {100 * ahead['within_two']:.0f}" if "within_one" in ahead else ""
        )
        cells.append(f"{row['false']} / {row['rows']}")
        cells.append("{:+.1f} ({:+.1f}, {:+.1f})".format(*row["worse"]) if "worse" in row else "")
        if row["line"] == LINES[0]:
            cells += [f"{100.0 * row['noticed']:.0f}, {100.0 * row['stamped']:.0f}", str(row["none"])]
            table.add_section()
        table.add_row(*cells)
    return table


@cache
def plan() -> tuple[Adapted, ...]:
    """The plan of HyQ."""
    path, topic, kind = PLAN
    with Bag(path) as bag:
        read = readers(bag, {topic: kind})[topic]
        return tuple(read(message.data) for message in bag.messages({topic: kind}))


def scene() -> Scene:
    """The scene of HyQ, as it is shipped."""
    return read_scenes(ROOT / "config/walker_hyq.yaml")[""]


def hyq() -> Walk:
    """The plan of HyQ, whose own contact flags are the truth."""
    machine = scene()
    assert machine.walking is not None
    landings: dict[str, list[int]] = {foot: [] for foot in machine.walking.feet}
    messages: list[Message] = []
    before: tuple[bool, ...] = ()
    for one in plan():
        assert one.sample is not None
        assert one.geometry is not None
        for foot, stood, now in zip(machine.walking.feet, before, one.stands):  # noqa: B905 (the first has none before)
            if now and not stood:
                landings[foot].append(one.sample.stamp)
        before = one.stands
        messages += [one.geometry, one.sample]
    return Walk("HyQ, plan", machine, messages, landings)


def noisy(
    sample: Sample, geometry: Geometry, rng: np.random.Generator, *, on_robot: bool = True
) -> tuple[Sample, Geometry]:
    """A sample and the geometry of its stamp, with white noise on all positions and velocities of base and feet.

    The feet are told `on_robot`, as by the joints, with these deviations relative to the base, and the base's own on
    top of them; or in the world, as by motion capture.
    """
    count = len(geometry.points)
    place, speed = (rng.normal(0.0, deviation, (1 + count, 3)) for deviation in (POSITION, VELOCITY))
    feet, rates = place[1:], speed[1:]
    if not on_robot:
        feet = feet - place[0]
        rates = rates - speed[0] - np.cross(sample.angular, feet)
    shift = to_world(axes_of(sample.orientation), tuple(place[0].tolist()))
    return (
        sample._replace(
            position=tuple((np.array(sample.position) + shift).tolist()),
            linear=tuple((np.array(sample.linear) + speed[0]).tolist()),
        ),
        geometry._replace(
            points=tuple(map(tuple, (np.array(geometry.points) + feet).tolist())),
            velocities=tuple(map(tuple, (np.array(geometry.velocities) + rates).tolist())),
        ),
    )


def with_noise(walk: Walk, seed: int, *, on_robot: bool = True) -> Walk:
    """The same record with noise on feet and trunk."""
    rng, messages, geometry = np.random.default_rng(seed), list(walk.messages), None
    for k, message in enumerate(messages):
        if isinstance(message, Geometry):
            geometry = k
        elif isinstance(message, Sample) and geometry is not None:
            known = messages[geometry]
            assert isinstance(known, Geometry)
            messages[k], messages[geometry] = noisy(message, known, rng, on_robot=on_robot)
            geometry = None
    return walk._replace(name=f"{walk.name}, noise", messages=messages)


def recorded(bag_path: str, scene_path: str) -> Walk:
    """A bag with its scene."""
    machine = read_scenes(scene_path)[""]
    assert machine.walking is not None
    landings: dict[str, list[int]] = {foot: [] for foot in machine.walking.feet}
    messages: list[Message] = []
    left_out = {SCHEDULE: not machine.walking.has_schedule, TERRAIN: machine.walking.terrain == 0.0}
    decoders: dict[str, tuple[str, Callable[[bytes], Any]]] = {
        f"/{kind}": INPUT_TYPES[kind] for kind in KINDS if not left_out.get(kind)
    }
    with Bag(bag_path) as bag:
        wanted = {topic: kind for topic, (kind, _) in decoders.items()} | {LANDING_TOPIC: DIAGNOSTIC_ARRAY}
        for message in bag.messages({topic: kind for topic, kind in wanted.items() if topic in bag.topics()}):
            if message.topic == LANDING_TOPIC:
                for landing in decode_truths(TrueLanding, message.data):
                    landings[landing.foot].append(landing.stamp)
            else:
                messages.append(decoders[message.topic][1](message.data))
    return Walk(Path(bag_path).stem, machine, messages, landings)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int)
    parser.add_argument("--world", action="store_true")
    parser.add_argument("records", nargs="*", metavar="BAG SCENE")
    told = parser.parse_args()
    if len(told.records) % 2:
        parser.error("give the scene of each bag after it")
    walks = [recorded(*pair) for pair in zip(told.records[::2], told.records[1::2], strict=True)] or [hyq()]
    if told.seed is not None:
        walks = [with_noise(walk, told.seed, on_robot=not told.world) for walk in walks]
    rows = [row for walk in walks for row in figures(walk)]
    show(Console(width=170), table_of(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
