"""Mass centre and inertia over mass of a recorded body, without any impact law, and what cannot be told of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..parameters.types import inertia_flaw
from ..prediction.scene import Scene
from ..prediction.types import KINDS
from ..wording import counted
from .impacts import DEVIATIONS, MotionRecord
from .impulses import AGAIN, Impulses, SinglePoint, SinglePoints, Weights, is_solid, least_lengths, parts_of, rounded
from .motions import Reals, RecordedMotion, distinct
from .search import FOLDS, Estimate, estimates, resamples

NEEDED: Final = 10
"""Motions below which an interval would say nothing."""

WIDE: Final = 0.2
"""A moment whose interval is wider than this part of the mean moment is not known, nor is a component of the mass
centre whose interval is wider than half this part of the lever: a drawing tells them as well."""

RADII: Final = (0.0, 0.02, 0.04, 0.06, 0.08, 0.1)
"""Radii of the corners, of the lever, with which everything is fitted anew."""

CHOICES: Final = (1, 3, 6)
"""How many moments may be fitted: one for all axes, those about the axes of the body frame, or all numbers."""


class Rounding(NamedTuple):
    """What is found with corners of a radius (m): the moments (kg m^2), the mass centre (m), and what is left of dw in
    the mean (rad/s), which unlike the inconsistency does not shrink with the way to the contact.
    """

    radius: float
    inertia: Reals
    center: Reals
    left: float


class Identification(NamedTuple):
    """A body identified from recorded motions.

    `inertia` (kg m^2 at the scene's mass, as many moments as were fitted) and `center` (m) come from `impacts` of a
    single point in the `motions`, of which `repeated` more are turned copies. What is not known, or has the given value
    in its interval, stays as given. The inconsistency of an impact is |J dw - (r - d) x m dv| / (m |dv| lever), with
    the root mean square distance of the points from their mean as `lever` (m): as `given`, and `held_out`, with what
    was fitted to the motions of the other folds, (n,) each. `choices` are the medians held out with 1, 3 and 6 moments.
    """

    scene: Scene
    motions: int
    repeated: int
    impacts: int
    inertia: tuple[Estimate, ...]
    center: tuple[Estimate, ...]
    lever: float
    given: Reals
    held_out: Reals
    choices: dict[int, float]
    radius: Estimate | None
    roundings: tuple[Rounding, ...]


def identify(
    scene: Scene,
    motions: Sequence[RecordedMotion],
    moments: int = 1,
    seed: int = 0,
    tell: Callable[[int], None] = lambda done: None,
) -> Identification:
    """Find mass centre and inertia of the body of a scene, with 1, 3 or 6 moments.

    Motions that are one, turned about the vertical, count once. Intervals are those of the bootstrap over motions
    (percentiles), the same for the same `seed`. `tell` takes how many fits are done, from 0. InputError where there are
    too few impacts of a single point, or the inertia that is found is that of no body.
    """
    single = distinct(scene, motions)
    records = [MotionRecord(scene, motion) for motion in single]
    struck, owner = _single_points(scene, records)
    tell(0)
    lever = float(np.mean([np.sqrt(one.points.var(axis=0).sum()) for one in struck]))
    equations = Impulses(scene, struck, moments)
    whole, every = np.ones(len(struck)), np.ones(moments + 3, dtype=bool)
    best = equations.solve(whole, every, equations.start)
    draws = []
    for weights in resamples(owner, seed):
        draws.append(equations.solve(weights, every, best, AGAIN))
        tell(len(draws))
    scales = np.array([scene.mass] * moments + [1.0] * 3)
    widths = np.array([WIDE * best[: min(moments, 3)].mean()] * moments + [0.5 * WIDE * lever] * 3)
    rough = estimates(equations.start * scales, best * scales, np.array(draws) * scales, widths * scales)
    free = np.array([one.known and not (one.low or 0.0) <= one.given <= (one.high or 0.0) for one in rough])
    final = equations.solve(whole, free, equations.start) * scales
    found = [one._replace(value=float(value)) for one, value in zip(rough, final, strict=True)]
    inertia = tuple(found[:moments])
    if flaw := inertia_flaw(six_of(scene, [one.value for one in inertia])):
        raise InputError(f"the inertia that is found is that of no body: {flaw}; give more bags, or fit fewer moments")

    held_out = {}
    for number in CHOICES:
        some, held_out[number] = Impulses(scene, struck, number), np.empty(len(struck))
        for fold in range(FOLDS):
            told = owner % FOLDS == fold
            x = some.solve(1.0 - told, np.ones(number + 3, dtype=bool), some.start)
            held_out[number][told] = some.inconsistency(x, lever)[told]
    solid = all(is_solid(one.points) for one in struck)
    corners = corner_radius(scene, struck, owner, lever, seed) if solid else None
    roundings = []
    for radius in np.array(RADII) * lever if solid else ():
        some = Impulses(scene, struck, moments, float(radius))
        x = some.solve(whole, every, best)
        left = np.linalg.norm(some.misses(x)[0], axis=1).mean() / x[: min(moments, 3)].mean()
        roundings.append(Rounding(float(radius), scene.mass * x[:moments], x[moments:], float(left)))
    given = Impulses(scene, struck, 6)
    return Identification(
        scene=scene,
        motions=len(single),
        repeated=len(motions) - len(single),
        impacts=len(struck),
        inertia=inertia,
        center=tuple(found[moments:]),
        lever=lever,
        given=given.inconsistency(given.start, lever),
        held_out=held_out[moments],
        choices={number: float(np.median(errors)) for number, errors in held_out.items()},
        radius=corners,
        roundings=tuple(roundings),
    )


def six_of(scene: Scene, moments: Sequence[float]) -> tuple[float, ...]:
    """Moments as an inertia parameter: one number, or six, of which those that were not fitted are the scene's."""
    return tuple(moments) if len(moments) == 1 else (*moments, *parts_of(scene.inertia)[len(moments) :])


def _single_points(scene: Scene, records: Sequence[MotionRecord]) -> tuple[SinglePoints, NDArray[np.int64]]:
    """The impacts of a single point while nothing else touches, and which of their motions each is of (n,)."""
    found = [
        (number, record.motion, impact)
        for number, record in enumerate(records)
        for impact in record.impacts
        if impact.kind == KINDS[0] and impact.isolated and impact.clear > scene.tolerance / DEVIATIONS
    ]
    owners, owner = np.unique([number for number, _, _ in found], return_inverse=True)
    if len(owners) < NEEDED:
        raise InputError(
            f"{counted(len(found), 'impact')} of a single point while nothing else touches, in "
            f"{counted(len(owners), 'motion')}, cannot tell mass centre and inertia: such impacts in {NEEDED} motions "
            "are needed; give more bags of free falls onto a corner"
        )
    struck = [
        SinglePoint(motion.points, impact, *impact.meeting(scene, motion.points[impact.new[0]]))
        for _, motion, impact in found
    ]
    return struck, owner


def corner_radius(scene: Scene, struck: SinglePoints, owner: NDArray[np.int64], lever: float, seed: int) -> Estimate:
    """The radius of the corners by the heights at which they turn back.

    The tip of the sharp corner lies R e outward of the centre of the sphere of radius R that touches its faces, and so
    R (1 + n . e) above the support when the sphere touches: below it. A compliant contact turns back deeper the faster
    it is struck.
    """
    outward = [one.turn @ one.of_struck(one.points - rounded(one.points, 1.0)) for one in struck]
    lower = 1.0 + np.array(outward) @ np.array(scene.normal)
    slopes = np.array([[[each, 1.0, one.impact.approach]] for each, one in zip(lower, struck, strict=True)])
    heights = np.array([[one.height] for one in struck])

    def linear(x: Reals) -> tuple[Reals, Reals]:
        return slopes @ x - heights, slopes

    def told(weights: Weights, start: Reals) -> Reals:
        return least_lengths(linear, weights, np.ones(3, dtype=bool), start, AGAIN)

    best = told(np.ones(len(owner)), np.zeros(3))
    draws = np.array([told(weights, best)[:1] for weights in resamples(owner, seed)])
    (found,) = estimates(np.zeros(1), best[:1], draws, np.array([0.1 * WIDE * lever]))
    return found
