"""The motion until the next touchdown over a moving support, in an impact plane.

A body in a plane that is fixed in the support, with axes `ahead` and the support's normal, feels of the support's
rotation

- about the plane's axis: the accelerations of Euler, of the centrifugal force and of Coriolis in the plane, and minus
  the angular acceleration;
- about the other two: everything at the plane's origin. From there on Euler's and Coriolis' acceleration of a motion in
  the plane point along the axis, where the contacts take them up. What remains in the plane is of second order in these
  rates, times the body's size, and so is the gyroscopic moment where the axis is a principal one: both are left out.
  Coriolis' acceleration of a velocity along the axis lies in the plane and is kept.
"""

from __future__ import annotations

from math import cos, floor, hypot, inf, pi
from operator import mul

from ...mechanics.motion import Fall, MotionKind, PlanarState, next_strike
from ...mechanics.motion.support import FrameAcceleration, at_place
from ...mechanics.types import Contact, TwoPointBody
from ..planar import ORIGIN, ImpactPlane, Posture, center_of
from ..scene import Scene
from ..types import Moment, Sample, Vector3
from ..vectors import add, cross, dot, times, to_world, total
from .frame import pull_at

APART = 1e-6
"""Contacts nearer to each other in the plane than this part of their distance from the mass centre are one."""


PART = 0.25
"""Length in s of one polynomial."""

NODES = tuple(cos((k + 0.5) * pi / 7.0) for k in range(7))
"""The nodes of a polynomial on -1..1, Chebyshev's."""


def lagrange(node: float) -> list[float]:
    """Coefficients of the polynomial that is 1 at one of the nodes and 0 at the others, the highest power first."""
    row = [1.0]
    for other in NODES:
        if other != node:
            row = [(up - other * low) / (node - other) for up, low in zip([*row, 0.0], [0.0, *row], strict=True)]
    return row


POWERS = tuple(zip(*map(lagrange, NODES), strict=True))
"""What the values at the nodes count in the coefficient of each power."""


class PlanarSupport:
    """A moving support as an impact plane sees it, from `age` s before the moment on.

    The plane has its origin at `place` in the support's frame, and `ahead` and `normal` are its axes there; what is
    felt counts along them. The body moves with `lateral` m/s along the axis normal x ahead, which is against the
    plane's own z.
    """

    period = inf

    def __init__(
        self, moment: Moment, age: float, place: Vector3, ahead: Vector3, normal: Vector3, lateral: float
    ) -> None:
        self._later, self._age, self._place, self._ahead, self._normal = moment.ahead, age, place, ahead, normal
        self._axis = cross(normal, ahead)
        self._velocity = times(self._axis, lateral)
        self.gravity = hypot(*moment.felt.gravity)
        self._parts: dict[int, tuple[FrameAcceleration, ...]] = {}

    def felt(self, time: float) -> FrameAcceleration:
        """Acceleration felt at rest at the origin, ahead and along the normal; rate and angular acceleration, CCW.

        From polynomials through seven values for each quarter of a second, because a motion asks a hundred times. Of
        what swings at w rad/s they miss (w / 8 s)^7 / 322560: 2e-10 at 2 rad/s.
        """
        number = floor(time / PART)
        part = self._parts.get(number)
        if part is None:
            part = self._parts[number] = self._fit((number + 0.5) * PART)
        return at_place(part, (time / PART - number) * 2.0 - 1.0)

    def felt_exactly(self, time: float) -> FrameAcceleration:
        felt = self._later(time - self._age)
        pull = pull_at(felt, self._place, self._velocity)
        axis = self._axis
        return dot(self._ahead, pull), dot(self._normal, pull), -dot(axis, felt.angular), -dot(axis, felt.turning)

    def _fit(self, middle: float) -> tuple[FrameAcceleration, ...]:
        """Coefficients of the polynomials about the middle of a part, the highest power first."""
        values = [self.felt_exactly(middle + 0.5 * PART * node) for node in NODES]
        x, y, rate, turning = zip(*values, strict=True)
        return tuple(
            (
                total(map(mul, weights, x)),
                total(map(mul, weights, y)),
                total(map(mul, weights, rate)),
                total(map(mul, weights, turning)),
            )
            for weights in POWERS
        )


def gravity_over(scene: Scene, moment: Moment, sample: Sample, posture: Posture) -> Vector3:
    """Acceleration that the body would have now without contacts, in the support's frame."""
    return pull_at(moment.felt, center_of(scene, sample, posture), to_world(posture.axes, posture.velocity))


def is_uniform(moment: Moment, horizon: float) -> bool:
    """Whether what is felt stays as it is everywhere: the support does not turn, and keeps its acceleration."""
    felt = moment.felt
    return felt.angular == ORIGIN and felt.turning == ORIGIN and moment.ahead(horizon) == felt


def fall_over(
    scene: Scene,
    moment: Moment,
    sample: Sample,
    posture: Posture,
    plane: ImpactPlane,
    inertia: float,
    start: PlanarState,
    height: float,
) -> Fall:
    """The next touchdown of a body on points, from `start` in its impact plane, as `next_touchdown` tells it.

    The mass centre is at `height` above the support at the sample, half a twist window after the start.
    """
    age = 0.5 * scene.twist_window
    place = add(center_of(scene, sample, posture), scene.normal, -height)
    ahead = to_world(posture.axes, plane.ahead)
    support = PlanarSupport(moment, age, place, ahead, scene.normal, dot(plane.axis, posture.velocity))
    new = Contact(*plane.new, scene.friction)
    duration = scene.horizon + age
    old = None if plane.old is None else Contact(*plane.old, scene.friction)
    if old and hypot(new.x - old.x, new.y - old.y) <= APART * (hypot(new.x, new.y) + hypot(old.x, old.y)):
        return never(start)
    body = TwoPointBody(scene.mass, inertia, old, new)
    fall = next_strike(body, start, None if old is None else 0, support, duration)
    if fall is None:
        return never(start)
    return fall if old else fall._replace(point=0)


def never(state: PlanarState) -> Fall:
    """No touchdown."""
    return Fall(time=inf, point=-1, state=state, motion=MotionKind.FLIGHT)
