"""What free flight alone tells of the mass centre and the inertia of the tossed cube: python benchmarks/free_flight.py

Beside what `impact-predictor identify` finds from impacts of single corners, which is sharper.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from impact_predictor import read_scenes
from impact_predictor.bags.replay import replay
from impact_predictor.calibration.identify import NEEDED, WIDE
from impact_predictor.calibration.impacts import MotionRecord
from impact_predictor.calibration.impulses import Weights, momenta, parts_of
from impact_predictor.calibration.motions import Reals, RecordingMonitor, distinct
from impact_predictor.calibration.search import Estimate, estimates, interval, resamples
from impact_predictor.prediction.scene import Scene
from impact_predictor.resources import find

SHORTEST = 6
"""Poses of the shortest flight from which a straight line and gravity leave something to be told."""

SPAN = 2
"""From one pose to the next but one a body in flight turns far enough for its angular velocity."""


class Flight(NamedTuple):
    """What free flight alone tells: the mass centre (m), how fast it falls (m/s^2), the moments over their mean."""

    flights: int
    center: tuple[Estimate, ...]
    fall: Estimate
    shape: tuple[Estimate, ...]


def flights_of(record: MotionRecord) -> list[slice]:
    """The poses of its `motion` in free flight: all points are farther from the support than the tolerance."""
    free = record._gaps.min(axis=1) > record._scene.tolerance
    breaks = {strike.k + 1 for event in record._events for strike in event}
    breaks |= {int(k) + 1 for k in np.flatnonzero(record._steps > 1.5 * record._step)}
    edges = [k for k in range(len(free) + 1) if k in (0, len(free)) or free[k] != free[k - 1] or k in breaks]
    runs = [slice(begin, end) for begin, end in pairwise(edges) if free[begin]]
    return [run for run in runs if run.stop - run.start >= SHORTEST]


def flight_of(scene: Scene, records: Sequence[MotionRecord], lever: float, seed: int) -> Flight | None:
    """What free flight tells; None where there is too little of it.

    The mass centre lies on a line in time plus one parabola for all flights, whose bend is its fall. The angular
    momentum keeps to its mean over a flight: frames that share no pose have independent noise, so that the product of
    their deviations holds none.
    """
    falls, turns, owner = [], [], []
    for number, record in enumerate(records):
        for flight in flights_of(record):
            times, rotations = record.motion.times[flight], record.motion.rotations[flight]
            times = times - times.mean()
            bend = np.multiply.outer(-0.5 * times**2, np.eye(3))
            columns = np.concatenate((rotations, bend, record.motion.positions[flight][..., None]), axis=2)
            line = np.linalg.qr(np.vander(times, 2))[0]
            columns -= np.einsum("sk,tk,tij->sij", line, line, columns)
            falls.append(np.einsum("sij,sik->jk", columns, columns))
            turn = Rotation.from_matrix(rotations[SPAN:] @ rotations[:-SPAN].transpose(0, 2, 1)).as_rotvec()
            halfway = Rotation.from_rotvec(0.5 * turn).as_matrix() @ rotations[:-SPAN]
            spin = momenta(halfway, turn / (times[SPAN:] - times[:-SPAN])[:, None])[:, :, :3]
            spin -= spin.mean(axis=0)
            product = np.einsum("tij,tik->jk", spin[SPAN + 1 :], spin[: -SPAN - 1])
            turns.append(product + product.T)
            owner.append(number)
    owners, place = np.unique(owner, return_inverse=True)
    if len(owners) < NEEDED:
        return None
    fallen, turned = np.array(falls), np.array(turns)

    def told(weights: Weights) -> Reals:
        fall = np.tensordot(weights, fallen, 1)
        found = -np.linalg.lstsq(fall[:6, :6], fall[:6, 6], rcond=1e-12)[0]
        shape = np.linalg.lstsq(np.tensordot(weights, turned, 1), np.ones(3), rcond=1e-12)[0]
        return np.array([*found[:3], np.linalg.norm(found[3:]), *(shape / shape.mean())])

    draws = np.array([told(weights) for weights in resamples(place, seed)])
    moments, fall = np.array(parts_of(scene.inertia)[:3]), float(np.linalg.norm(scene.gravity))
    given = np.array([*scene.center_of_mass, fall, *(moments / moments.mean())])
    widths = WIDE * np.array([0.5 * lever] * 3 + [0.5 * fall] + [1.0] * 3)
    found = estimates(given, told(np.ones(len(place))), draws, widths)
    return Flight(len(place), tuple(found[:3]), found[3], tuple(found[4:]))


def main() -> None:
    """Print it."""
    scenes = read_scenes(str(find("config/cube_tosses.yaml")))
    scene, monitor = scenes[""], RecordingMonitor(scenes)
    replay(find("examples/cube_tosses"), scenes, monitor=monitor)
    records = [MotionRecord(scene, motion) for motion in distinct(scene, monitor.motions)]
    lever = float(np.sqrt(records[0].motion.points.var(axis=0).sum()))
    found = flight_of(scene, records, lever, 0)
    assert found is not None
    print(f"{found.flights} free flights, with 95 %:")
    for axis, one in zip("xyz", found.center, strict=True):
        print(f"  mass centre {axis}, m: {interval(one)}")
    print(f"  fall, m/s^2: {interval(found.fall)} (given {found.fall.given:.4g})")
    print(f"  moments over their mean: {', '.join(map(interval, found.shape))}")


if __name__ == "__main__":
    main()
