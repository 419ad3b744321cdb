"""Touchdowns in three dimensions: a body on points falls on those that come first, and is struck there.

What a body over a plane support does is computed along the support's axes: z out of it, the origin on it.
"""

from __future__ import annotations

from functools import cache
from math import hypot, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.impact.solve import number_of
from ..mechanics.impact.spatial import STEPS, flags_named, solvers, workspace
from ..mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT
from ..mechanics.motion.spatial import Pull, SpatialState, fall
from ..mechanics.types import ContactState
from .impact import OFF_AXIS, OFFSET, leftover_of
from .planar import (
    ORIGIN,
    RESTS,
    ActiveContacts,
    Posture,
    along_plane,
    axis_of,
    center_of,
    edge_of,
    hardly,
    mode_of_contacts,
    off_axis_of,
    planar_twist,
    plane_of,
    still_of,
)
from .scatter import SLACK, Scatter
from .scene import Scene, six_numbers
from .types import (
    Moment,
    PointOutcome,
    Quaternion,
    Sample,
    SpatialTwist,
    Touchdown,
    Vector3,
)
from .vectors import (
    add,
    applied,
    axes_of,
    composed,
    conjugate,
    cross,
    dot,
    mean,
    tensor_to_world,
    times,
    to_body,
    to_world,
    total,
    turned,
)

if TYPE_CHECKING:
    from .draws import Draws

WINDOW = 2.0
"""Points take part in an impact that close within so many compressions after the first one."""

PLANAR = 1e-3
"""A touchdown is planar whose motion across its plane, with what pulls it there until then, is below this part of the
new contact's approach, and whose contacts and inertia lie as near to the plane: there both laws agree to that. Motion
and gaps are also those of a plane where they cannot be told from it by how far they scatter."""

STATES = tuple(ContactState)


class SpatialCollision(NamedTuple):
    """The collision that a sample shows to be ahead, before its impact, in the frame in which the support is given.

    `position` in m is that of the mass centre, and `before` its twist; of each of the `points`, those of `contacts`,
    `arms` lead there from the mass centre, `gaps` in m are still open when the first one closes, and `rates`
    in m/s are those of the gaps. The rest is as in `Collision`.
    """

    contacts: ActiveContacts
    lead_time: float
    position: Vector3
    orientation: Quaternion
    before: SpatialTwist
    points: tuple[int, ...]
    arms: tuple[Vector3, ...]
    gaps: tuple[float, ...]
    rates: tuple[float, ...]
    measured: float
    speed: float


class NearestPlane(NamedTuple):
    """The impact plane of a touchdown in three dimensions: fields as those of `Touchdown`.

    `width` in m is what the offset is measured by: half the distance of the contacts, in flight that of the new one
    from the mass centre.
    """

    axis: Vector3
    half_distance: float
    width: float
    off_axis: float
    lateral: float
    offset: float


class SpatialModel:
    """How the body of a scene, on some points, falls and is struck; everything that can be prepared is."""

    def __init__(self, scene: Scene, points: tuple[Vector3, ...], scatter: Scatter) -> None:
        self._scene, self._points = scene, points
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = scene.inertia
        self._inertia = [part / scene.mass for part in (xx, yy, zz, xy, xz, yz)]
        self._arms = [add(point, scene.center_of_mass, -1.0) for point in points]
        self._frame = frame_of(scene.normal)
        self._axes = axes_of(self._frame)
        self._solver = solvers().bodies
        prepare()
        self._law = number_of(scene.law)
        self.scatter = scatter
        self._draws: Draws | None = None
        if scene.samples:
            from .draws import Draws

            self._draws = Draws(scene, self._solve)

    @property
    def gap_deviation(self) -> float:
        """Standard deviation of the gaps in m: as the scene tells, else as standing points do."""
        told, learnt = self._scene.gap_deviation, self.scatter.deviation
        return told if told >= 0.0 else 0.1 * self._scene.tolerance if learnt is None else learnt

    def is_planar(self, sample: Sample, posture: Posture, contacts: ActiveContacts, gravity: Vector3) -> bool:
        """Whether a touchdown that a sample shows on some contacts is one in the impact plane.

        `gravity` in the frame of the sample, in m/s^2, is what the body would be accelerated by without contacts.
        """
        scene, old, new = self._scene, contacts.old, contacts.new
        gaps = [posture.gaps[i] for i in new]
        approach = -total([posture.rates[i] for i in new]) / len(new)
        # What noise may be is not told from none.
        least, even = max(PLANAR * approach, self.scatter.rate), max(PLANAR * approach * scene.merge, self.scatter.gap)
        if max(gaps) - min(gaps) > even or (len(old) > 1 and len(new) == 1):
            return False
        plane = plane_of(scene, self._points, sample, posture, contacts, gravity)
        if abs(plane.gravity[2]) * max(0.0, *gaps) > least * approach:
            return False
        reach = sqrt(plane.new[0] * plane.new[0] + plane.new[1] * plane.new[1])
        aside = max(PLANAR * reach, self.scatter.noise)
        for group in (old, new):
            places = [dot(plane.ahead, self._points[i]) for i in group]
            if places and max(places) - min(places) > aside:
                return False
        spin = sqrt(dot(sample.angular, sample.angular))
        if plane.offset > aside or max(abs(plane.lateral), plane.off_axis * spin * reach) > least:
            return False
        turned = applied(scene.inertia, plane.axis)
        across = add(turned, plane.axis, -dot(plane.axis, turned))
        return dot(across, across) * reach * reach <= aside * aside * dot(turned, turned)

    def collision(self, sample: Sample, posture: Posture, moment: Moment | None) -> SpatialCollision | None:
        """The collision that a sample shows to be ahead; None where there is none within the horizon."""
        scene, gaps, rates = self._scene, posture.gaps, posture.rates
        limit = max(2.0 * hardly(scene), still_of(rates, self.scatter.rate))
        near = max(scene.tolerance, self.scatter.gap)
        stands = [gap <= near and -limit <= rate <= limit for gap, rate in zip(gaps, rates, strict=True)]
        # An averaged twist is that of half its window ago: the motion is followed from there.
        age = 0.5 * scene.twist_window
        velocity, spin = to_world(posture.axes, posture.velocity), to_world(posture.axes, sample.angular)
        center = add(center_of(scene, sample, posture), velocity, -age)
        if True not in stands:
            pull = scene.gravity if moment is None else moment.felt.gravity
            center = add(center, pull, -0.5 * age * age)
        return self._followed(
            center=center,
            orientation=turned(sample.orientation, times(sample.angular, -age)),
            twist=SpatialTwist(velocity, spin),
            stands=stands,
            age=age,
            rates=rates,
            moment=moment,
        )

    def collision_after(
        self, last: Touchdown, age: float, posture: Posture, moment: Moment | None
    ) -> SpatialCollision | None:
        """The collision ahead of a body that was struck `age` s ago, as the touchdown tells: no twist shows it yet."""
        axes, stands = axes_of(last.orientation), [False] * len(self._points)
        for contact in last.contacts:
            stands[contact.point] = contact.state in (ContactState.SLIPS, ContactState.STICKS)
        return self._followed(
            center=add(last.position, to_world(axes, self._scene.center_of_mass)),
            orientation=last.orientation,
            twist=last.after_6d,
            stands=stands,
            age=age,
            rates=posture.rates,
            moment=moment,
        )

    def _followed(
        self,
        *,
        center: Vector3,
        orientation: Quaternion,
        twist: SpatialTwist,
        stands: list[bool],
        age: float,
        rates: list[float],
        moment: Moment | None,
    ) -> SpatialCollision | None:
        """The collision at the end of a motion that began `age` s before the sample, with the rates that this shows."""
        scene, n, frame = self._scene, len(self._points), self._axes
        x, y, z = to_body(frame, center)
        start = SpatialState(
            position=(x, y, z - scene.height),
            orientation=composed(conjugate(self._frame), orientation),
            velocity=to_body(frame, twist.linear),
            angular_velocity=to_body(frame, twist.angular),
        )
        standing = [i for i in range(n) if stands[i]]
        end = fall(
            start, self._inertia, self._arms, standing, scene.friction, self._pull(moment, age), scene.horizon + age
        )
        if end.point < 0:
            return None
        old, state = end.standing, end.state
        window = WINDOW * scene.merge
        slack = 0.0 if self._draws is None else SLACK * self.gap_deviation
        new = tuple(
            [
                i
                for i, (gap, rate) in enumerate(zip(end.gaps, end.rates, strict=True))
                if i == end.point or (i not in old and rate < 0.0 and gap <= slack - window * rate)
            ]
        )
        orientation = composed(self._frame, state.orientation)
        axes, points = axes_of(orientation), old + new
        return SpatialCollision(
            contacts=ActiveContacts(old, new),
            lead_time=max(0.0, end.time - age),
            position=add(to_world(frame, state.position), scene.normal, scene.height),
            orientation=orientation,
            before=SpatialTwist(to_world(frame, state.velocity), to_world(frame, state.angular_velocity)),
            points=points,
            arms=tuple([to_world(axes, self._arms[i]) for i in points]),
            gaps=tuple([0.0 if i in old or i == end.point else max(0.0, end.gaps[i]) for i in points]),
            rates=tuple([end.rates[i] for i in points]),
            measured=-total([rates[i] for i in new]) / len(new),
            speed=-end.rates[end.point],
        )

    def touchdown(self, sample: Sample, posture: Posture, collision: SpatialCollision) -> Touchdown:
        """The touchdown at the end of an approach, with its impact."""
        scene, (old, new) = self._scene, collision.contacts
        before, speed = collision.before, collision.speed
        problem, n = self._problem(collision), len(collision.points)
        answer, notes = np.zeros(ANSWER + RESULT * n), np.zeros(1, np.int64)
        self._solve(problem[None], answer[None], notes)
        numbers = answer.tolist()
        contacts = outcomes_of(numbers, old, new)
        vx, vy, vz, wx, wy, wz, lost = numbers[:ANSWER]
        plane, now = self._plane(collision), axes_of(collision.orientation)
        after, drawn = SpatialTwist((vx, vy, vz), (wx, wy, wz)), None
        if self._draws is not None:
            rates = list(collision.rates[len(old) :])
            drawn = self._draws.drawn(
                *(sample, posture.axes, problem, answer, len(old), rates, self.gap_deviation, now, plane.axis)
            )
            mode, after = drawn.mode, drawn.after
            contacts = [
                contact._replace(lift_probability=chance) for contact, chance in zip(contacts, drawn.lifts, strict=True)
            ]
            if drawn.many:
                contacts = [
                    moving(contact, add(after.linear, cross(after.angular, arm)), scene.normal, RESTS * speed)
                    for contact, arm in zip(contacts, collision.arms, strict=True)
                ]
        else:
            mode = mode_of_contacts(contacts[: len(old)], contacts[len(old) :], scene.normal, RESTS * speed)
        axis, ahead = plane.axis, cross(plane.axis, scene.normal)
        angular, center = to_body(now, after.angular), scene.center_of_mass
        spread = max(collision.gaps[len(old) :]) / speed
        return Touchdown(
            lead_time=collision.lead_time,
            mode=mode,
            before=planar_twist(before, ahead, scene.normal, axis),
            after=planar_twist(after, ahead, scene.normal, axis),
            impulses=(
                along_plane(contacts[: len(old)], ahead, scene.normal),
                along_plane(contacts[len(old) :], ahead, scene.normal),
            ),
            segments=(),
            energy_lost=lost,
            flags=flags_named(int(notes[0])),
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
                apart=spread > scene.contact_time or (len(old) > 1 and len(new) == 1),
                speed=speed,
            ),
            before_6d=before,
            after_6d=after,
            contacts=tuple(contacts),
            uncertainty=None if drawn is None else drawn.uncertainty,
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
        how = bool(self._law), scene.merge, hardly(scene), steps
        self._solver(n, problems, *how, answers, notes, *workspace(n))

    def _plane(self, collision: SpatialCollision) -> NearestPlane:
        """The impact plane that is nearest to a collision, and what it leaves over."""
        scene, before, count = self._scene, collision.before, len(collision.contacts.old)
        stood, struck = collision.arms[:count], mean(list(collision.arms[count:]))
        arm = add(struck, mean(list(stood)), -1.0) if stood else struck
        edge = edge_of(list(stood)) if count > 1 else None
        axis = axis_of(scene.normal, before.angular, before.linear, edge, arm, hardly(scene))
        ahead, rate = cross(axis, scene.normal), dot(axis, before.angular)
        lateral, offset = dot(axis, before.linear), abs(dot(axis, struck))
        half, width = 0.0, hypot(dot(ahead, struck), dot(scene.normal, struck))
        if stood:
            middle = mean(list(stood))
            offset = max(offset, abs(dot(axis, middle)))
            lateral += dot(axis, cross(before.angular, middle))
            half = width = 0.5 * hypot(dot(ahead, arm), dot(scene.normal, arm))
        return NearestPlane(
            axis=axis,
            half_distance=half,
            width=width,
            off_axis=off_axis_of(before.angular, axis, rate),
            lateral=lateral,
            offset=offset,
        )

    def _problem(self, collision: SpatialCollision) -> np.ndarray:
        """The numbers of a collision as the law takes them (see `mechanics.impact.spatial_body`)."""
        scene = self._scene
        (linear, angular), normal, n = collision.before, scene.normal, len(collision.points)
        problem = np.zeros(BODY + CONTACT * n)
        moments = six_numbers(tensor_to_world(axes_of(collision.orientation), scene.inertia))
        problem[:BODY] = (scene.mass, *moments, *linear, *angular)
        friction, restitution = scene.friction, scene.restitution
        problem[BODY:] = [
            number
            for arm, gap in zip(collision.arms, collision.gaps, strict=True)
            for number in (*arm, *normal, friction, restitution, 0.0, 0.0, 0.0, gap)
        ]
        return problem

    def _pull(self, moment: Moment | None, age: float) -> Pull:
        """What pulls the body from `age` s ago on."""
        scene, frame = self._scene, self._axes
        if moment is None:
            return Pull(to_body(frame, scene.gravity))
        from .deck.frame import pull_at  # only where the support moves

        felt, later = moment.felt, moment.ahead(scene.horizon)
        origin = times(scene.normal, scene.height)
        now, then = pull_at(felt, origin, ORIGIN), pull_at(later, origin, ORIGIN)
        growth = times(add(then, now, -1.0), 1.0 / scene.horizon)
        return Pull(
            gravity=to_body(frame, add(now, growth, -age)),
            growth=to_body(frame, growth),
            spin=to_body(frame, felt.angular),
            turning=to_body(frame, felt.turning),
        )


@cache
def prepare() -> None:
    """Have the law code compiled, where it can be, or loaded: for the first touchdown that would take too long."""
    still = SpatialState((0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), ORIGIN, ORIGIN)
    fall(still, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0), [ORIGIN], horizon=1e-3)
    problem, answer = np.zeros((1, BODY + CONTACT)), np.zeros((1, ANSWER + RESULT))
    solvers().bodies(1, problem, False, 0.0, 0.0, 1, answer, np.zeros(1, np.int64), *workspace(1))


def outcomes_of(answer: list[float], old: tuple[int, ...], new: tuple[int, ...]) -> list[PointOutcome]:
    """What an answer of the law says of each contact."""
    found = []
    for k, point in enumerate(old + new):
        a, b, c, u, v, w, state, _ = answer[ANSWER + RESULT * k : ANSWER + RESULT * (k + 1)]
        found.append(
            PointOutcome(
                point=point, is_new=k >= len(old), impulse=(a, b, c), velocity=(u, v, w), state=STATES[int(state)]
            )
        )
    return found


def moving(contact: PointOutcome, velocity: Vector3, normal: Vector3, least: float) -> PointOutcome:
    """A contact of a body with the mean twist of some draws: what approaches in it has not closed in all of them."""
    rate, state = dot(normal, velocity), contact.state
    if rate < -least:
        state = ContactState.NEARS
    elif rate > least or state is ContactState.NEARS:
        state = ContactState.LEAVES
    return contact._replace(velocity=velocity, state=state)


def frame_of(normal: Vector3) -> Quaternion:
    """The shortest rotation that takes z to a unit normal."""
    x, y, z = normal
    if z < -1.0 + 1e-12:
        return 1.0, 0.0, 0.0, 0.0
    scale = 1.0 / sqrt(2.0 * (1.0 + z))
    return -y * scale, x * scale, 0.0, (1.0 + z) * scale
