"""The approach in three dimensions: a body on points falls on those that come first.

What a body over a plane support does is computed along the support's axes: z out of it, the origin on it.
"""

from __future__ import annotations

from functools import cache
from math import sqrt
from typing import Final

from ..mechanics.motion.spatial import Pull, SpatialState, fall
from ..mechanics.types import ContactState
from .planar import ORIGIN, ActiveContacts, Posture, center_of, hardly, plane_of, still_of
from .scatter import SLACK, Scatter
from .scene import Scene
from .spatial_impact import SpatialCollision, SpatialImpactModel
from .types import Moment, Quaternion, Sample, SpatialTwist, Touchdown, Vector3
from .vectors import (
    add,
    applied,
    axes_of,
    composed,
    conjugate,
    dot,
    times,
    to_body,
    to_world,
    total,
    turn_to,
    turned,
)

WINDOW: Final = 2.0
"""Points take part in an impact that close within so many compressions after the first one."""

PLANAR: Final = 1e-3
"""A touchdown is planar whose motion across its plane, with what pulls it there until then, is below this part of the
new contact's approach, and whose contacts and inertia lie as near to the plane: there both laws agree to that. Motion
and gaps are also those of a plane where they cannot be told from it by how far they scatter."""


class SpatialModel:
    """How the body of a scene, on some points, falls; everything that can be prepared is."""

    def __init__(self, scene: Scene, points: tuple[Vector3, ...], scatter: Scatter) -> None:
        self._scene, self._points = scene, points
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = scene.inertia
        self._inertia = [part / scene.mass for part in (xx, yy, zz, xy, xz, yz)]
        self._arms = [add(point, scene.center_of_mass, -1.0) for point in points]
        self._frame = turn_to(scene.normal)
        self._axes = axes_of(self._frame)
        self.scatter, self.impact = scatter, SpatialImpactModel(scene)
        prepare()

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
        swing = applied(scene.inertia, plane.axis)
        across = add(swing, plane.axis, -dot(plane.axis, swing))
        return dot(across, across) * reach * reach <= aside * aside * dot(swing, swing)

    def collision(self, sample: Sample, posture: Posture, moment: Moment | None) -> SpatialCollision | None:
        """The collision that a sample shows to be ahead; None where there is none within the horizon."""
        scene, gaps, rates = self._scene, posture.gaps, posture.rates
        limit = max(2.0 * hardly(scene), still_of(rates, self.scatter.rate))
        near = max(scene.tolerance, self.scatter.gap)
        stands = [gap <= near and -limit <= rates[i] <= limit for i, gap in enumerate(gaps)]
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
        old, state, gaps = end.standing, end.state, end.gaps
        window = WINDOW * scene.merge
        slack = SLACK * self.gap_deviation if scene.samples else 0.0
        new = tuple(
            [
                i
                for i, rate in enumerate(end.rates)
                if i == end.point or (i not in old and rate < 0.0 and gaps[i] <= slack - window * rate)
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
            gaps=tuple([0.0 if i in old or i == end.point else max(0.0, gaps[i]) for i in points]),
            rates=tuple([end.rates[i] for i in points]),
            places=self._arms,
            measured=-total([rates[i] for i in new]) / len(new),
            speed=-end.rates[end.point],
        )

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
