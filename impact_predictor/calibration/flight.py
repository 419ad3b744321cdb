"""What the free flight of a recorded body tells of its mass centre and its inertia."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..prediction.scene import Scene
from .impacts import MotionRecord
from .impulses import Weights, momenta, parts_of
from .motions import Reals
from .search import LEVEL, RESAMPLES, Estimate

NEEDED: Final = 10
"""Motions below which an interval would say nothing."""

WIDE: Final = 0.2
"""A moment whose interval is wider than this part of the mean moment is not known, nor is a component of the mass
centre whose interval is wider than half this part of the lever: a drawing tells them as well."""

SPAN: Final = 2
"""From one pose to the next but one a body in flight turns far enough for its angular velocity."""


class Flight(NamedTuple):
    """What free flight alone tells: the mass centre (m), how fast it falls (m/s^2), the moments over their mean."""

    flights: int
    center: tuple[Estimate, ...]
    fall: Estimate
    shape: tuple[Estimate, ...]


def resamples(owner: NDArray[np.int64], seed: int) -> Iterator[NDArray[np.int64]]:
    """How often each impact or flight counts when their motions are drawn anew."""
    owners = int(owner.max()) + 1
    for drawn in np.random.default_rng(seed).integers(0, owners, (RESAMPLES, owners)):
        yield np.bincount(drawn, minlength=owners)[owner]


def estimates(given: Reals, values: Reals, draws: Reals, widths: Reals) -> list[Estimate]:
    """Numbers with the intervals of their draws (resamples, n); known are those whose interval is not too wide."""
    low, high = np.quantile(draws, (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL), axis=0)
    columns = (each.tolist() for each in (given, values, low, high, high - low <= widths))
    return [Estimate(*one) for one in zip(*columns, strict=True)]


def flight_of(scene: Scene, records: Sequence[MotionRecord], lever: float, seed: int) -> Flight | None:
    """What free flight tells; None where there is too little of it.

    The mass centre lies on a line in time plus one parabola for all flights, whose bend is its fall. The angular
    momentum keeps to its mean over a flight: frames that share no pose have independent noise, so that the product of
    their deviations holds none.
    """
    falls, turns, owner = [], [], []
    for number, record in enumerate(records):
        for flight in record.flights:
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
