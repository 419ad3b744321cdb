"""From three dimensions to the impact plane and back.

The impact plane is spanned by the support normal n and d = axis x n, where `axis` is the direction in the support about
which the body turns; it turns clockwise, towards +d, about -axis. Everything is computed in the body frame, where the
contact points and the inertia do not move.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, hypot, inf, sqrt
from typing import TYPE_CHECKING, Final

from ..mechanics.impact.answer import mode_of
from ..mechanics.impact.solve import MODES
from ..mechanics.types import ContactState, Mode, Twist, Vector
from .scene import Scene
from .types import PointOutcome, Sample, SpatialTwist, Vector3
from .vectors import add, any_across, applied, axes_of, cross, dot, inverse, mean, times, to_body, to_world, total

if TYPE_CHECKING:
    from .scatter import Scatter

STANDING: Final = 0.2
"""A point within the contact tolerance stands while it moves along the normal slower than this part of the fastest
point: the stance of a body that turns about it, told from a body that only grazes the support."""

NEARER: Final = 0.5
"""... of which noise may hide up to this part: there a point is as near to rest as to the fastest one."""

RESTS: Final = 3e-4
"""A group of contacts holds that leaves more slowly than this part of the approach."""

ROUNDING: Final = 1e-12
"""The square of a direction this small, relative to the vector it is a part of, is none: points may be float32."""

ORIGIN = (0.0, 0.0, 0.0)  # of the body frame, where the mass centre often lies
TINY: Final = 1e-100  # below it the square of a length or of a speed has lost its digits
GRAZES: Final = 1e-9  # m/s: what reaches the support slower only grazes it


class Posture:
    """A sample over the support: its axes in the world frame; in the body frame the support normal, the velocity of
    the mass centre; and of each point the gap (m) and its rate (m/s).
    """

    def __init__(
        self,
        axes: tuple[Vector3, Vector3, Vector3],
        normal: Vector3,
        velocity: Vector3,
        gaps: list[float],
        rates: list[float],
    ) -> None:
        self.axes, self.normal, self.velocity, self.gaps, self.rates = axes, normal, velocity, gaps, rates


class ActiveContacts:
    """The points that stand, and those that strike next together."""

    def __init__(self, old: tuple[int, ...], new: tuple[int, ...]) -> None:
        self.old, self.new = old, new


class ImpactPlane:
    """The impact plane, in the body frame or in another, and the body in it.

    `axis`, `ahead` (d) and `normal` (n) are unit vectors; `old` (None in flight) and `new` the contacts from the mass
    centre along (d, n) in m; `twist` of the mass centre; `gravity` along (d, n, axis). Left over: `off_axis` (0..1),
    `lateral` velocity (m/s) and `offset` of the contacts along the axis (m).
    """

    def __init__(
        self,
        axis: Vector3,
        ahead: Vector3,
        normal: Vector3,
        old: Vector | None,
        new: Vector,
        twist: Twist,
        gravity: Vector3,
        off_axis: float,
        lateral: float,
        offset: float,
    ) -> None:
        self.axis, self.ahead, self.normal, self.old, self.new = axis, ahead, normal, old, new
        self.twist, self.gravity = twist, gravity
        self.off_axis, self.lateral, self.offset = off_axis, lateral, offset

    @property
    def half_distance(self) -> float:
        """Half the distance of the contacts, in m; 0 in flight."""
        return 0.0 if self.old is None else 0.5 * hypot(self.new[0] - self.old[0], self.new[1] - self.old[1])

    @property
    def width(self) -> float:
        """What the offset is measured by: half the distance, in flight that of the new contact from the mass centre."""
        return hypot(*self.new) if self.old is None else self.half_distance


def posture_of(scene: Scene, points: tuple[Vector3, ...], sample: Sample) -> Posture:
    axes = axes_of(sample.orientation)
    normal = nx, ny, nz = to_body(axes, scene.normal)
    linear, spin, center = sample.linear, sample.angular, scene.center_of_mass
    height = dot(scene.normal, sample.position) - scene.height
    rate = dot(normal, linear)
    wx, wy, wz = cross(normal, spin)
    velocity = linear if center == ORIGIN else add(linear, cross(spin, center))
    gaps = [height + nx * x + ny * y + nz * z for x, y, z in points]
    rates = [rate + wx * x + wy * y + wz * z for x, y, z in points]
    return Posture(axes=axes, normal=normal, velocity=velocity, gaps=gaps, rates=rates)


def center_of(scene: Scene, sample: Sample, posture: Posture) -> Vector3:
    return add(sample.position, to_world(posture.axes, scene.center_of_mass))


def contacts_of(scene: Scene, posture: Posture, scatter: Scatter | None = None) -> ActiveContacts | None:
    """Which points stand and which strike next; None where no point approaches.

    A point approaches faster than gravity moves it within the contact time; points that close within the contact time
    after the first one strike together with it. Where the first one hardly moves yet, none is known to strike next.
    Differences of gaps and of rates below their `scatter` count as none.
    """
    gaps, rates = posture.gaps, posture.rates
    slack, noise = (0.0, 0.0) if scatter is None else (scatter.gap, scatter.rate)
    slowest, tolerance = -hardly(scene), max(scene.tolerance, slack)
    if all(rate >= slowest for rate in rates):
        return None
    limit = still_of(rates, noise)
    old = [i for i, gap in enumerate(gaps) if gap <= tolerance and -limit <= rates[i] <= limit]
    # A point that hardly moves may still come first; one that is down counts as resting there.
    closing = [
        i for i, rate in enumerate(rates) if rate < 0.0 and i not in old and (rate < slowest or gaps[i] > tolerance)
    ]
    if not any(rates[i] < -noise or gaps[i] > tolerance for i in closing):
        return None
    base = total([gaps[i] for i in old]) / len(old) if old else 0.0
    due = [(base - gaps[i]) / rates[i] for i in closing]
    last = max(0.0, min(due)) + scene.contact_time
    new = [i for k, i in enumerate(closing) if due[k] + (slack + noise * max(0.0, due[k])) / rates[i] <= last]
    if min([rates[i] for i in new]) >= slowest:
        return None
    return ActiveContacts(tuple(old), tuple(new))


def still_of(rates: Sequence[float], noise: float) -> float:
    """The speed in m/s along the normal up to which a point stands, where rates of `noise` cannot be told from none."""
    fastest = 0.0
    for rate in rates:
        fastest = max(fastest, abs(rate))
    return max(STANDING * fastest, min(noise, NEARER * fastest))


def mode_of_contacts(old: Sequence[PointOutcome], new: Sequence[PointOutcome], normal: Vector3, least: float) -> Mode:
    """The mode of an impact, from its groups of contacts: one lifts when the mean of its gap rates exceeds `least`.

    An old contact that is not there counts as lifted.
    """
    speeds = []
    for group in (old, new):
        rate = total([dot(normal, contact.velocity) for contact in group]) / len(group) if group else inf
        speeds += [rate, inf if any(contact.state is ContactState.SLIPS for contact in group) else 0.0]
    return MODES[mode_of(least, *speeds)]


def planar_twist(twist: SpatialTwist, ahead: Vector3, normal: Vector3, axis: Vector3) -> Twist:
    """The part of a twist in the impact plane."""
    return Twist(dot(ahead, twist.linear), dot(normal, twist.linear), -dot(axis, twist.angular))


def along_plane(contacts: Sequence[PointOutcome], ahead: Vector3, normal: Vector3) -> Vector:
    """Normal and tangential part of the impulses of some contacts together."""
    return total([dot(normal, one.impulse) for one in contacts]), total([dot(ahead, one.impulse) for one in contacts])


def hardly(scene: Scene) -> float:
    """The speed in m/s that gravity gives within a contact time: slower is hardly moving."""
    x, y, z = scene.gravity
    return scene.contact_time * hypot(x, y, z)


def plane_of(
    scene: Scene,
    points: tuple[Vector3, ...],
    sample: Sample,
    posture: Posture,
    contacts: ActiveContacts,
    gravity: Vector3 | None = None,
) -> ImpactPlane:
    """The impact plane of a posture's contacts; `gravity` in the frame of the sample is the scene's unless given."""
    old, new, center = contacts.old, contacts.new, scene.center_of_mass
    struck = add(mean([points[i] for i in new]), center, -1.0)
    stood = add(mean([points[i] for i in old]), center, -1.0) if old else None
    edge = edge_of([points[i] for i in old]) if len(old) > 1 else None
    pull = to_body(posture.axes, scene.gravity if gravity is None else gravity)
    return plane_through(posture.normal, sample.angular, posture.velocity, stood, struck, edge, pull, hardly(scene))


def plane_through(
    n: Vector3,
    spin: Vector3,
    velocity: Vector3,
    stood: Vector3 | None,
    struck: Vector3,
    edge: Vector3 | None,
    gravity: Vector3,
    slow: float,
) -> ImpactPlane:
    """The impact plane along the normal n and through what stands and what is struck, seen from the mass centre.

    `edge` is the line on which the body stands; all is in one frame, of `slow` see `axis_of`.
    """
    arm = struck if stood is None else add(struck, stood, -1.0)
    axis = axis_of(n, spin, velocity, edge, arm, slow)
    ahead, rate = cross(axis, n), dot(axis, spin)
    offset, lateral, stance = abs(dot(axis, struck)), dot(axis, velocity), None
    if stood is not None:
        stance = dot(ahead, stood), dot(n, stood)
        offset = max(offset, abs(dot(axis, stood)))
        lateral += dot(axis, cross(spin, stood))
    return ImpactPlane(
        axis=axis,
        ahead=ahead,
        normal=n,
        old=stance,
        new=(dot(ahead, struck), dot(n, struck)),
        twist=Twist(dot(ahead, velocity), dot(n, velocity), -rate),
        gravity=(dot(ahead, gravity), dot(n, gravity), dot(axis, gravity)),
        off_axis=off_axis_of(spin, axis, rate),
        lateral=lateral,
        offset=offset,
    )


def off_axis_of(spin: Vector3, axis: Vector3, rate: float) -> float:
    """The part of the angular velocity off an axis about which it is `rate`."""
    turning, across = dot(spin, spin), add(spin, axis, -rate)
    return sqrt(min(1.0, dot(across, across) / turning)) if turning > 0.0 else 0.0


def axis_of(n: Vector3, spin: Vector3, velocity: Vector3, edge: Vector3 | None, arm: Vector3, slow: float) -> Vector3:
    """The direction in the support about which the body turns, or will turn, towards its new contact.

    It is the edge's on which it stands, else the spin's. A body that hardly turns, so that this moves the new contact
    slower than `slow`, is turned by the impact itself: towards the new contact from the old one (in flight from the
    mass centre; `arm` leads there), or against its sliding where it strikes right below.
    """
    if edge is not None:
        along = add(edge, n, -dot(edge, n))
        square = dot(along, along)
        if square > ROUNDING * dot(edge, edge) + TINY:
            return times(along, copysign(1.0 / sqrt(square), dot(along, spin)))
    along = add(spin, n, -dot(spin, n))
    square = dot(along, along)
    if square * dot(arm, arm) > slow * slow + TINY:
        return times(along, 1.0 / sqrt(square))
    return cross(n, direction_of(n, [(arm, ROUNDING * dot(arm, arm)), (velocity, slow * slow)]))


def direction_of(normal: Vector3, ways: list[tuple[Vector3, float]]) -> Vector3:
    """The unit vector in the support along the first of some ways whose part in it is large enough; else any.

    Each way comes with the square that its part must exceed.
    """
    for way, least in (*ways, (any_across(normal), 0.0)):
        flat = add(way, normal, -dot(normal, way))
        square = dot(flat, flat)
        if square > least + TINY:
            break
    return times(flat, 1.0 / sqrt(square))


def edge_of(points: list[Vector3]) -> Vector3:
    """The line between the two of the points that lie furthest apart."""
    best, longest = (0.0, 0.0, 0.0), -1.0
    for i, p in enumerate(points):
        for q in points[:i]:
            line = add(p, q, -1.0)
            square = dot(line, line)
            if square > longest:
                best, longest = line, square
    return best


def inertia_about(scene: Scene, axis: Vector3, blocked: bool) -> float:
    """Inertia about the axis: the tensor's own where the contacts block every other rotation, else the free body's."""
    if blocked:
        return dot(axis, applied(scene.inertia, axis))
    return 1.0 / dot(axis, applied(inverse(scene.inertia), axis))
