"""The impact in three dimensions at the end of an approach: the body after it, what its contacts do, how sure it is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanics.impact.solve import number_of
from ..mechanics.impact.spatial import STATES, STEPS, flags_named, solver, workspace
from ..mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT
from ..mechanics.impact.spatial_path import NEARS
from ..mechanics.types import Flag
from .impact import OFF_AXIS, OFFSET, leftover_of
from .planar import (
    ORIGIN,
    RESTS,
    ActiveContacts,
    ImpactPlane,
    along_plane,
    edge_of,
    hardly,
    mode_of_contacts,
    planar_twist,
    plane_through,
)
from .scene import Scene
from .types import PointOutcome, Quaternion, Sample, SpatialTwist, Touchdown, Vector3
from .vectors import Axes, add, axes_of, cross, dot, mean, six_numbers, tensor_to_world, to_body, to_world

if TYPE_CHECKING:
    from .draws import Draws


FAR = 1e9
"""m: the gap of a contact that takes no part."""

MOVES = 1e-3
"""m/s: slower approaches are none."""


class SpatialCollision:
    """The collision that a sample shows to be ahead, before its impact, in the frame in which the support is given.

    `position` in m is that of the mass centre, and `before` its twist; of each of the `points`, those of `contacts`,
    `arms` lead there from the mass centre, `gaps` in m are still open when the first one closes, and `rates`
    in m/s are those of the gaps. `places` are those of all points of the body from the mass centre, along its axes. The
    rest is as in `Collision`.
    """

    def __init__(
        self,
        contacts: ActiveContacts,
        lead_time: float,
        position: Vector3,
        orientation: Quaternion,
        before: SpatialTwist,
        points: tuple[int, ...],
        arms: tuple[Vector3, ...],
        gaps: tuple[float, ...],
        rates: tuple[float, ...],
        places: Sequence[Vector3],
        measured: float,
        speed: float,
    ) -> None:
        self.contacts, self.lead_time, self.measured, self.speed = contacts, lead_time, measured, speed
        self.position, self.orientation, self.before = position, orientation, before
        self.points, self.arms, self.gaps, self.rates, self.places = points, arms, gaps, rates, places


class SpatialImpactModel:
    """How the body of a scene is struck in three dimensions; the law code is compiled, where it can be, and loaded."""

    def __init__(self, scene: Scene) -> None:
        self._scene, self._law = scene, bool(number_of(scene.law))
        self._draws: Draws | None = None
        if scene.samples:
            from .draws import Draws

            self._draws = Draws(scene, self._solve)
        self._solve(np.zeros((1, BODY + CONTACT)), np.zeros((1, ANSWER + RESULT)), np.zeros(1, np.int64))

    def touchdown(self, sample: Sample, axes: Axes, collision: SpatialCollision, deviation: float) -> Touchdown:
        """The touchdown at the end of an approach, with its impact.

        `axes` are those of the body in the sample; `deviation` in m is that of the gaps.
        """
        scene, old, new = self._scene, collision.contacts.old, collision.contacts.new
        count = len(old)
        before, speed, normal = collision.before, collision.speed, scene.normal
        plane, now, least = plane_at(scene, collision), axes_of(collision.orientation), RESTS * speed
        problem, uncertainty = self._problem(collision, now), None
        positions = [add(collision.position, arm) for arm in collision.arms]
        normals = [normal] * len(positions)
        if self._draws is None:
            answers: Any = np.empty((1, ANSWER + RESULT * len(collision.points)))
            flags: Any = np.empty(1, np.int64)
            self._solve(problem[None], answers, flags)
            answer, notes = answers[0].tolist(), int(flags[0])
            contacts = outcomes_of(answer, collision.contacts, positions, normals)
            mode = mode_of_contacts(contacts[:count], contacts[count:], normal, least)
        else:
            rates = list(collision.rates[count:])
            mode, drawn, notes, lifts, uncertainty = self._draws.drawn(
                sample, axes, problem, count, rates, deviation, now, plane.axis
            )
            answer = self._stopped(problem, drawn, least)
            contacts = outcomes_of(answer, collision.contacts, positions, normals, lifts)
        vx, vy, vz, wx, wy, wz, lost = answer[:ANSWER]
        after = SpatialTwist((vx, vy, vz), (wx, wy, wz))
        stood, struck = contacts[:count], contacts[count:]
        axis, ahead, center, angular = plane.axis, plane.ahead, scene.center_of_mass, to_body(now, after.angular)
        spread, told = max(collision.gaps[count:]) / speed, flags_named(notes)
        if self._leaves_out(collision, after, now):
            told |= Flag.POINT_APPROACHES
        return Touchdown(
            lead_time=collision.lead_time,
            mode=mode,
            before=planar_twist(before, ahead, normal, axis),
            after=planar_twist(after, ahead, normal, axis),
            impulses=(along_plane(stood, ahead, normal), along_plane(struck, ahead, normal)),
            segments=(),
            energy_lost=lost,
            flags=told,
            unique=True,
            law=scene.law,
            old=old,
            new=new,
            axis=axis,
            position=add(collision.position, to_world(now, center), -1.0),
            orientation=collision.orientation,
            linear=add(to_body(now, after.linear), cross(angular, center), -1.0),
            angular=angular,
            half_distance=plane.half_distance,
            off_axis=plane.off_axis,
            lateral=plane.lateral,
            closing_spread=spread,
            offset=plane.offset,
            leftover=leftover_of(
                scene,
                stands=bool(old),
                strays=plane.off_axis > OFF_AXIS or plane.offset > OFFSET * plane.width,
                apart=spread > scene.contact_time or (count > 1 and len(new) == 1),
                speed=speed,
            ),
            before_6d=before,
            after_6d=after,
            contacts=tuple(contacts),
            uncertainty=uncertainty,
        )

    def _solve(
        self,
        problems: NDArray[np.float64],
        answers: NDArray[np.float64],
        notes: NDArray[np.int64],
        steps: int = STEPS,
    ) -> None:
        """Fill in the answers to problems with as many contacts each."""
        scene, n = self._scene, (problems.shape[1] - BODY) // CONTACT
        how = self._law, scene.merge, hardly(scene), steps
        solver()(n, problems, *how, answers, notes, *workspace(n))

    def _stopped(self, problem: NDArray[np.float64], mean: list[float], least: float) -> list[float]:
        """A mean answer of draws in which no contact that has closed approaches by more than `least`, in m/s.

        In some of the draws it has not closed: what is left of its approach is stopped plastically.
        """
        normal, spots = self._scene.normal, range(ANSWER, len(mean), RESULT)
        nears = [mean[at + 6] == NEARS for at in spots]
        approaches = [mean[at + 3] * normal[0] + mean[at + 4] * normal[1] + mean[at + 5] * normal[2] for at in spots]
        if all(near or rate >= -least for near, rate in zip(nears, approaches, strict=True)):
            return mean
        again = problem[None].copy()
        again[0, 7:BODY] = mean[:6]
        again[0, BODY + 7 :: CONTACT] = 0.0
        again[0, BODY + 11 :: CONTACT] = np.where(nears, FAR, 0.0)
        answers = np.empty((1, len(mean)))
        self._solve(again, answers, np.empty(1, np.int64))
        answer: list[float] = answers[0].tolist()
        answer[6] += mean[6]
        for at in spots:
            for j in range(at, at + 3):
                answer[j] += mean[j]
        return answer

    def _leaves_out(self, collision: SpatialCollision, after: SpatialTwist, now: Axes) -> bool:
        """Whether with a twist a point that took no part closes within a compression after the impact."""
        scene, normal = self._scene, to_body(now, self._scene.normal)
        height, rate = dot(collision.position, scene.normal) - scene.height, dot(after.linear, scene.normal)
        turning = cross(normal, to_body(now, after.angular))
        for i, place in enumerate(collision.places):
            speed = -rate - dot(turning, place)
            if speed > MOVES and i not in collision.points and height + dot(normal, place) < speed * scene.merge:
                return True
        return False

    def _problem(self, collision: SpatialCollision, axes: Axes) -> NDArray[np.float64]:
        """The numbers of a collision as the law takes them (see `mechanics.impact.spatial_body`)."""
        scene, (linear, angular) = self._scene, collision.before
        numbers = [scene.mass, *six_numbers(tensor_to_world(axes, scene.inertia)), *linear, *angular]
        for i, arm in enumerate(collision.arms):
            numbers += (*arm, *scene.normal, scene.friction, scene.restitution, 0.0, 0.0, 0.0, collision.gaps[i])
        return np.array(numbers)


def plane_at(scene: Scene, collision: SpatialCollision) -> ImpactPlane:
    """The impact plane that is nearest to a collision, and what it leaves over."""
    (linear, angular), count = collision.before, len(collision.contacts.old)
    stood, struck = list(collision.arms[:count]), mean(list(collision.arms[count:]))
    edge = edge_of(stood) if count > 1 else None
    middle = mean(stood) if stood else None
    return plane_through(scene.normal, angular, linear, middle, struck, edge, ORIGIN, hardly(scene))


def outcomes_of(
    answer: list[float],
    contacts: ActiveContacts,
    positions: Sequence[Vector3],
    normals: Sequence[Vector3],
    lifts: Sequence[float] = (),
) -> list[PointOutcome]:
    """What an answer of the law says of each contact, at its position, with the normal there, and with the probability
    that it lifts, where that is known.
    """
    found, count = [], len(contacts.old)
    for k, point in enumerate(contacts.old + contacts.new):
        at = ANSWER + RESULT * k
        impulse = answer[at], answer[at + 1], answer[at + 2]
        velocity = answer[at + 3], answer[at + 4], answer[at + 5]
        state, lift = STATES[int(answer[at + 6])], lifts[k] if lifts else None
        # By place, which takes half the time.
        found.append(PointOutcome(point, k >= count, positions[k], normals[k], impulse, velocity, state, lift))
    return found
