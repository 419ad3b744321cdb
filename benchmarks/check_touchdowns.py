"""Every touchdown of recorded cube tosses against predictions.mcap, in three dimensions, without the program itself.

    python benchmarks/check_touchdowns.py BAG PREDICTIONS [--half even|odd|all]

Reads the odometry and the corners of the bag, and post_impact of the predictions: stamp = touchdown, pose there, twist
right after, log time = stamp of the sample that caused it. Impacts are found from the heights of the corners alone. For
clear ones (> 0.2 m/s) it prints by kind: the part that is announced at the last sample before it; the error
|(dv, s dw)| / |(v, s w) before| over the third frame after the sample before it, for isolated ones, the told state
continued there by gravity and plastic contacts with friction; and the part of right answers to "does the old contact
lift?" and "does the new one?" (balanced over yes and no; a contact lifts when its corners rise by more than 0.5 mm in
the mean from the first to the third frame after it, in the record and in the told state continued). Halves are those of
the motions: one that is another one, turned about the vertical, has its number.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation

Reals = NDArray[np.float64]

DT, SIZE, FLOOR, GRAVITY = 1.0 / 148.0, 0.0524, -0.0019, 9.81
CENTER, INERTIA, MASS, FRICTION = np.array([0.0, 0.0, 0.0064]), 1.095e-3, 0.37, 0.17
"""With which told states are continued for two frames."""

LEVEL, STEP, CONTACT = 0.002, 2e-4, 2e-5
SLOWEST, CLEAR = 0.10, 0.2
TOLERANCE, TOGETHER, LIFT = 0.0035, 0.005, 0.0005
PAUSE = 250_000_000
NEAR = 1.2

KINDS = ("flight>corner", "flight>edge", "corner>corner", "corner>edge+", "edge>corner", "edge>face")


class Track(NamedTuple):
    """A recorded body: stamps (ns), positions, rotations, velocity and angular velocity in the world, corners."""

    stamps: NDArray[np.int64]
    positions: Reals
    rotations: Reals
    linear: Reals
    angular: Reals
    corners: Reals

    def part(self, begin: int, end: int) -> Track:
        some = slice(begin, end)
        return Track(
            self.stamps[some],
            self.positions[some],
            self.rotations[some],
            self.linear[some],
            self.angular[some],
            self.corners,
        )

    @property
    def gaps(self) -> Reals:
        heights: Reals = np.einsum("tj,kj->tk", self.rotations[:, 2], self.corners)
        return self.positions[:, 2, None] + heights - FLOOR


class Told(NamedTuple):
    """A state right after a touchdown, as it was told: stamp, pose, and twist in the body frame."""

    stamp: int
    position: Reals
    rotation: Reals
    linear: Reals
    angular: Reals


class Impact(NamedTuple):
    """An impact of a motion: its time in frames, the frame before it, the corners that strike, and how fast."""

    time: float
    frame: int
    new: list[int]
    approach: float


class Row(NamedTuple):
    """What became of one clear touchdown; lifts as (measured, told)."""

    kind: str
    announced: bool
    error: float | None = None
    old: tuple[bool, bool] | None = None
    new: tuple[bool, bool] | None = None


def state_of(message: Any) -> tuple[Reals, Reals, Reals, Reals]:
    """Position, quaternion, velocity and angular velocity of an odometry message."""
    pose, twist = message.pose.pose, message.twist.twist
    p, q, v, w = pose.position, pose.orientation, twist.linear, twist.angular
    return (
        np.array([p.x, p.y, p.z]),
        np.array([q.x, q.y, q.z, q.w]),
        np.array([v.x, v.y, v.z]),
        np.array([w.x, w.y, w.z]),
    )


def stamp_of(message: Any) -> int:
    return int(message.header.stamp.sec) * 10**9 + int(message.header.stamp.nanosec)


def read(bag: str, predictions: str = "") -> tuple[Track, dict[int, Told]]:
    """The recorded body, and the last told states by the stamps of the samples that caused them."""
    types = get_typestore(Stores.ROS2_JAZZY)
    stamps, states, corners, told = [], [], np.zeros((0, 3)), {}
    message: Any
    with AnyReader([Path(bag)], default_typestore=types) as reader:
        for connection, _, raw in reader.messages():
            if connection.topic.endswith("/odom"):
                message = reader.deserialize(raw, connection.msgtype)
                stamps.append(stamp_of(message))
                states.append(state_of(message))
            elif connection.topic.endswith("/contact_geometry"):
                message = reader.deserialize(raw, connection.msgtype)
                corners = np.array([(p.x, p.y, p.z) for p in message.polygon.points])
    if predictions:
        with AnyReader([Path(predictions)], default_typestore=types) as reader:
            topics = [one for one in reader.connections if one.topic.endswith("/post_impact")]
            for connection, log_time, raw in reader.messages(topics):
                message = reader.deserialize(raw, connection.msgtype)
                p, q, v, w = state_of(message)
                told[log_time] = Told(stamp_of(message), p, Rotation.from_quat(q).as_matrix(), v, w)
    positions, quaternions, linear, angular = (np.array(one) for one in zip(*states, strict=True))
    turns = Rotation.from_quat(quaternions).as_matrix()
    linear, angular = (np.einsum("tij,tj->ti", turns, one) for one in (linear, angular))
    return Track(np.array(stamps), positions, turns, linear, angular, corners), told


def motions_of(track: Track) -> list[tuple[int, Track]]:
    """The motions, between pauses, each with its number; one that is another one, turned, has the number of that."""
    cuts = [0, *(np.flatnonzero(np.diff(track.stamps) > PAUSE) + 1).tolist(), len(track.stamps)]
    numbers: dict[bytes, int] = {}
    found = []
    for begin, end in pairwise(cuts):
        motion = track.part(begin, end)
        key = (np.round(np.sort(motion.gaps), 6) + 0.0).tobytes()
        found.append((numbers.setdefault(key, len(numbers)), motion))
    return found


def goes_on(told: Told, corners: Reals, start: float, ends: Sequence[float]) -> list[tuple[Reals, Reals]]:
    """Poses at the times `ends`, from a told state at the time `start`: gravity, plastic contacts, Coulomb friction."""
    arms, turn = corners - CENTER, told.rotation
    spin = turn @ told.angular
    center, velocity = told.position + turn @ CENTER, turn @ told.linear + np.cross(spin, turn @ CENTER)
    gaps = center[2] + (arms @ turn.T)[:, 2] - FLOOR
    level = np.where(gaps < LEVEL, gaps, 0.0)
    found = []
    for end in ends:
        count = max(1, round((end - start) / STEP))
        h = (end - start) / count
        for _ in range(count):
            reach = arms @ turn.T
            velocity[2] -= GRAVITY * h
            gaps = center[2] + reach[:, 2] - FLOOR - level
            rates = velocity[2] + spin[0] * reach[:, 1] - spin[1] * reach[:, 0]
            near = np.flatnonzero(gaps + np.minimum(rates, 0.0) * h * 0.5 <= CONTACT)
            if (rates[near] < 0.0).any():
                press(reach[near], velocity, spin)
            center = center + velocity * h
            turn = Rotation.from_rotvec(spin * h).as_matrix() @ turn
        start = end
        found.append((center - turn @ CENTER, turn.copy()))
    return found


def press(reach: Reals, velocity: Reals, spin: Reals) -> None:
    """Change velocities by plastic impulses with friction at some points (Gauss and Seidel)."""
    impulses = np.zeros((len(reach), 3))
    for _ in range(30):
        most = 0.0
        for impulse, (x, y, z) in zip(impulses, reach, strict=True):
            rate = velocity[2] + spin[0] * y - spin[1] * x
            up = max(0.0, impulse[2] - rate / (1.0 / MASS + (x * x + y * y) / INERTIA)) - impulse[2]
            impulse[2] += up
            velocity[2] += up / MASS
            spin[0] += y * up / INERTIA
            spin[1] -= x * up / INERTIA
            weight = 1.0 / MASS + (x * x + y * y + z * z) / INERTIA
            along = impulse[0] - (velocity[0] + spin[1] * z - spin[2] * y) / weight
            across = impulse[1] - (velocity[1] + spin[2] * x - spin[0] * z) / weight
            drag, limit = np.hypot(along, across), FRICTION * impulse[2]
            if drag > limit:
                along, across = along * limit / drag, across * limit / drag
            dx, dy = along - impulse[0], across - impulse[1]
            impulse[:2] = along, across
            velocity[:2] += np.array([dx, dy]) / MASS
            spin += np.array([-z * dy, z * dx, x * dy - y * dx]) / INERTIA
            most = max(most, abs(up), abs(dx), abs(dy))
        if most < 1e-9:
            break


def impacts_of(gaps: Reals) -> list[Impact]:
    """The impacts that the heights of the corners show, those together that strike within the contact time."""
    rates, strikes = np.diff(gaps, axis=0) / DT, []
    for i in range(gaps.shape[1]):
        k = 1
        while k < len(gaps) - 2:
            rate, gap = rates[k - 1, i], gaps[k, i]
            reaches = gap + (rate - 0.5 * GRAVITY * DT) * DT < 0.5 * TOLERANCE
            stops = rates[k + 1, i] - rate > 0.5 * abs(rate) and min(gap, gaps[k + 1, i]) < TOLERANCE + 0.001
            if rate < -SLOWEST and -0.003 < gap < 0.05 and reaches and stops:
                rest = np.clip(gap / ((-rate + 0.25 * GRAVITY * DT) * DT), 0.0, 1.0)
                strikes.append((k + float(rest), k, i, float(rate)))
                k += 3
            else:
                k += 1
    strikes.sort(key=lambda strike: strike[0])
    found, used = [], set()
    for n, (time, *_) in enumerate(strikes):
        if n not in used:
            group = [m for m in range(n, len(strikes)) if m not in used and (strikes[m][0] - time) * DT <= TOGETHER]
            used.update(group)
            some = [strikes[m] for m in group]
            new = sorted(i for _, _, i, _ in some)
            found.append(Impact(time, min(k for _, k, _, _ in some), new, -min(rate for *_, rate in some)))
    return found


def kind_of(old: list[int], new: list[int]) -> str:
    return KINDS[2 * min(len(old), 2) + (len(new) > 1)]


def clear_of(motion: Track, seen: set[tuple[float, ...]]) -> Iterator[tuple[Impact, bool]]:
    """The clear impacts of a motion that were not `seen` before, and whether each is isolated."""
    gaps, impacts = motion.gaps, impacts_of(motion.gaps)
    times = [-9.0, *(impact.time for impact in impacts), 1e9]
    for j, impact in enumerate(impacts):
        k = impact.frame
        key = tuple(np.round(np.sort(gaps[k - 1 : k + 2].ravel()), 6))
        if k < 2 or k + 5 > len(gaps) or impact.approach < CLEAR or key in seen:
            continue
        seen.add(key)
        yield impact, times[j + 2] > k + 3 and times[j] < k - 1


def announced(motion: Track, told: dict[int, Told], impact: Impact) -> Told | None:
    """What the last sample before an impact told of it; None where it did not."""
    state = told.get(int(motion.stamps[impact.frame]))
    near = state is not None and abs((state.stamp - motion.stamps[0]) * 1e-9 / DT - impact.time) < NEAR
    return state if near else None


def missed(motion: Track, state: Told, k: int) -> tuple[float, Reals] | None:
    """The error of a told state after an impact after the frame k, and how far the corners rise by it; None if late."""
    start = (state.stamp - motion.stamps[0]) * 1e-9 - k * DT
    if start >= 1.9 * DT:
        return None
    first, second, third = goes_on(state, motion.corners, start, [max(start + 1e-6, DT), 2.0 * DT, 3.0 * DT])
    spin = Rotation.from_matrix(third[1] @ second[1].T).as_rotvec() / DT
    turn = motion.rotations[k + 3] @ motion.rotations[k + 2].T
    wrong = np.linalg.norm((third[0] - second[0] - motion.positions[k + 3] + motion.positions[k + 2]) / DT)
    wrong = np.hypot(wrong, SIZE * np.linalg.norm(spin - Rotation.from_matrix(turn).as_rotvec() / DT))
    before = np.hypot(np.linalg.norm(motion.linear[k]), SIZE * np.linalg.norm(motion.angular[k]))
    return float(wrong / before), third[0][2] - first[0][2] + motion.corners @ (third[1] - first[1])[2]


def rows_of(motion: Track, told: dict[int, Told], seen: set[tuple[float, ...]]) -> list[Row]:
    """What became of each clear touchdown of a motion that was not `seen` before."""
    gaps, rows = motion.gaps, []
    rates = np.diff(gaps, axis=0) / DT
    for impact, isolated in clear_of(motion, seen):
        k, new = impact.frame, impact.new
        still = max(0.08, 0.2 * np.abs(rates[k - 1]).max())
        old = [i for i in range(len(motion.corners)) if i not in new and gaps[k, i] < 0.005]
        old = [i for i in old if abs(rates[k - 1, i]) < still]
        state = announced(motion, told, impact)
        row = Row(kind_of(old, new), announced=state is not None)
        found = missed(motion, state, k) if state is not None and isolated else None
        if found is not None:
            error, rise = found
            risen = gaps[k + 3] - gaps[k + 1]
            lifts = [
                (bool(risen[group].mean() > LIFT), bool(rise[group].mean() > LIFT)) if group else None
                for group in (old, new)
            ]
            # A single corner always rises from flight.
            row = row._replace(error=error, old=lifts[0], new=lifts[1] if old or len(new) > 1 else None)
        rows.append(row)
    return rows


def balanced(lifts: list[tuple[bool, bool]]) -> float:
    """The part of right answers in the mean of those that lift and those that do not."""
    yes, no = [told for real, told in lifts if real], [not told for real, told in lifts if not real]
    return float(np.mean(yes) + np.mean(no)) / 2.0 if yes and no else float("nan")


class Verdict(NamedTuple):
    """Numbers of one kind of touchdowns, or of all of them."""

    number: int
    announced: float
    scored: int
    mean: float
    median: float
    p90: float
    old: float
    new: float

    def __str__(self) -> str:
        return (
            f"n {self.number:5d} announced {self.announced:.3f}  error (n {self.scored}) median {self.median:.3f} "
            f"90 % {self.p90:.3f}  lifts right, balanced: old {self.old:.2f} new {self.new:.2f}"
        )


def judged(bag: str, predictions: str, half: str = "all") -> dict[str, Verdict]:
    """The verdict for each kind of touchdowns of a half of the motions, and for "all" of them."""
    track, told = read(bag, predictions)
    rows: list[Row] = []
    seen: set[tuple[float, ...]] = set()
    for number, motion in motions_of(track):
        if half == "all" or number % 2 == ("even", "odd").index(half):
            rows += rows_of(motion, told, seen)
    found = {}
    for kind in (*KINDS, "all"):
        some = [row for row in rows if kind in (row.kind, "all")]
        errors = [row.error for row in some if row.error is not None]
        if some:
            found[kind] = Verdict(
                number=len(some),
                announced=float(np.mean([row.announced for row in some])),
                scored=len(errors),
                mean=float(np.mean(errors)) if errors else float("nan"),
                median=float(np.median(errors)) if errors else float("nan"),
                p90=float(np.percentile(errors, 90)) if errors else float("nan"),
                old=balanced([row.old for row in some if row.old is not None]),
                new=balanced([row.new for row in some if row.new is not None]),
            )
    return found


def main() -> int:
    """Print the verdicts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag")
    parser.add_argument("predictions")
    parser.add_argument("--half", choices=("even", "odd", "all"), default="all")
    given = parser.parse_args()
    for kind, verdict in judged(given.bag, given.predictions, given.half).items():
        print(f"{kind:14s} {verdict}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
