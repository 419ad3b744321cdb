"""Values that flow through the predictor: samples in; predictions and scores out."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, IntEnum, IntFlag
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Protocol

from ..mechanics.types import ContactState, Flag, Mode, Outcome, Twist, Vector
from ..mechanics.types import Quaternion as Quaternion
from ..mechanics.types import Vector3 as Vector3
from .foot import Foot as Foot

if TYPE_CHECKING:
    from .spatial_score import SpatialScore


class Status(IntEnum):
    """What became of an input message. A refused message predicts nothing; `checks.REMEDIES` says why, and what to do.

    A stamp that is older than the last one by more than a pause shows that the clock has started anew: so does the
    predictor with the next sample. A support that has jumped is trusted again when new messages agree.
    """

    ACCEPTED = 0
    NOT_FINITE = 1
    BAD_QUATERNION = 2
    STAMP_REPEATED = 3
    STAMP_WENT_BACK = 4
    WRONG_FRAME = 5
    NO_GEOMETRY = 6
    TOO_FEW_POINTS = 7
    COINCIDENT_POINTS = 8
    MALFORMED = 9
    NO_SUPPORT = 10
    SUPPORT_STALE = 11
    CLOCKS_APART = 12
    SUPPORT_JUMPED = 13
    GRAVITY_WRONG = 14
    OFF_SUPPORT = 15
    BELOW_SUPPORT = 16
    BODY_STALE = 17
    GEOMETRY_STALE = 18
    FEET_CHANGED = 19
    BELOW_GROUND = 20
    WRONG_JOINTS = 21
    SINGULAR_INERTIA = 22
    TOO_MANY_POINTS = 23
    NO_TRANSFORM = 24


class Bound(Enum):
    """What the impulses of a walking machine are, for legs and drives give way as no scene tells exactly."""

    LOWER = "lower bound"
    """Joints without drives and rotors, which give way as much as they can."""
    ESTIMATE = "estimate"
    """Armature or drives are known."""
    UPPER = "upper bound"
    """One rigid body, or joints that are held."""


class Leftover(IntFlag):
    """Why a touchdown is not a planar two-point impact that a record can score, seen from the state before it."""

    NONE = 0
    ONE_POINT = 1
    """Nothing stands before the touchdown."""
    OUT_OF_PLANE = 2
    """The body also turns off the impact plane, or its contacts do not lie in the plane of the mass centre."""
    ONE_CORNER_FIRST = 4
    """One corner of the striking edge closes earlier than the other, by more than the contact time."""
    TOO_SHORT = 8
    """The record ends, or pauses, before the velocities after the touchdown are known."""
    TOO_SLOW = 16
    """The approach is too slow against gravity for an impact to be told from rest."""
    DRIVEN = 32
    """The feet are driven: what a record shows after the touchdown is not the impact alone."""
    OTHER_POINTS = 64
    """The points that were predicted to strike did not come to the support, others did."""
    UNSEEN = 128
    """The record shows no point that comes to the support then."""
    UNANNOUNCED = 1024
    """No sample before it announced it."""
    NOT_ISOLATED = 256
    """Another touchdown is too near for the twist between them to be told."""
    MOVING_CONTACTS = 512
    """The contacts move over the body, so that it does not go on as one on points."""


class Covariance(IntEnum):
    """What became of the covariance of a twist."""

    USED = 0
    REFUSED = 1
    """It is not finite, not symmetric or not positive semidefinite, or too large: the twist counted as exact."""


class Sample(NamedTuple):
    """The state of a body: pose in the world, twist in the body frame, at the body frame's origin.

    `stamp` in ns; `position` in m; `orientation` as (x, y, z, w); `linear` in m/s; `angular` in rad/s;
    the covariances as 36 row-major numbers, as in nav_msgs/Odometry: zeros where nothing is known of them.
    """

    stamp: int
    frame_id: str
    child_frame_id: str
    position: Vector3
    orientation: Quaternion
    linear: Vector3
    angular: Vector3
    pose_covariance: tuple[float, ...] = (0.0,) * 36
    twist_covariance: tuple[float, ...] = (0.0,) * 36


class Transform(NamedTuple):
    """Where the frame `child_frame_id` is in the frame `frame_id`: `stamp` in ns, `position` in m, `orientation` as
    (x, y, z, w), as in geometry_msgs/TransformStamped.
    """

    stamp: int
    frame_id: str
    child_frame_id: str
    position: Vector3
    orientation: Quaternion


class Imu(NamedTuple):
    """A measurement of an inertial sensor, along its own axes.

    `stamp` in ns; `orientation` as (x, y, z, w) in the world, None where the sensor gives none; `angular` velocity in
    rad/s; `specific_force` in m/s^2: acceleration less gravity, so that a sensor at rest measures 9.81 upwards.
    """

    stamp: int
    frame_id: str
    orientation: Quaternion | None
    angular: Vector3
    specific_force: Vector3


class Felt(NamedTuple):
    """What moves a body in the frame of a moving support, along the support's axes.

    `gravity`: acceleration that is felt at rest at the frame's origin, R^T (g - A), in m/s^2; `angular` velocity in
    rad/s and `turning`, its derivative, in rad/s^2, both of the support.
    """

    gravity: Vector3
    angular: Vector3
    turning: Vector3


class Moment(NamedTuple):
    """A moving support at one instant.

    `stamp` in ns; pose of its frame `child_frame_id` in the world frame `frame_id` ("" where nobody measures it);
    `linear` velocity of its origin in m/s along its axes; what is `felt` now, and `ahead(t)`, t seconds later;
    `gravity` in m/s^2 in the world frame.
    """

    stamp: int
    frame_id: str
    child_frame_id: str
    position: Vector3
    orientation: Quaternion
    linear: Vector3
    felt: Felt
    ahead: Callable[[float], Felt]
    gravity: Vector3 = (0.0, 0.0, -9.81)


class SupportTracker(Protocol):
    """What knows how a support moves: its `frames`, that of its motion and its own, and where it is `at` a stamp in ns,
    or why that is not known.
    """

    @property
    def frames(self) -> tuple[str, str]: ...

    def at(self, stamp: int) -> Moment | Status: ...


class Geometry(NamedTuple):
    """The points of a body that can touch the support, in m, in the body frame.

    `velocities` in m/s are those of moving points relative to the body, along its axes; () where they are not measured.
    """

    stamp: int
    frame_id: str
    points: tuple[Vector3, ...]
    velocities: tuple[Vector3, ...] = ()


class FeetStates(NamedTuple):
    """Where the points of feet are, by the `names` of their feet, as in sensor_msgs/MultiDOFJointState.

    The points of one foot follow each other. `positions` in m, in the body frame; `velocities` in m/s relative to the
    body and `forces` in N, along its axes; () where they are not measured.
    """

    stamp: int
    frame_id: str
    names: tuple[str, ...]
    positions: tuple[Vector3, ...]
    velocities: tuple[Vector3, ...] = ()
    forces: tuple[Vector3, ...] = ()


class Joints(NamedTuple):
    """Positions (rad or m), velocities (rad/s or m/s) and efforts (N m or N) of joints by their names, as in
    sensor_msgs/JointState; velocities and efforts are () where they are not measured.
    """

    stamp: int
    names: tuple[str, ...]
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    efforts: tuple[float, ...] = ()


class Wrench(NamedTuple):
    """What the force sensor of a foot measures: `force` in N; `frame_id` is the name of the foot."""

    stamp: int
    frame_id: str
    force: Vector3


class Schedule(NamedTuple):
    """When a planner wants feet to stand: from each of the `times` (ns, rising) on they stand as `stands` says."""

    stamp: int
    feet: tuple[str, ...]
    times: tuple[int, ...]
    stands: tuple[tuple[bool, ...], ...]


class Terrain(NamedTuple):
    """Heights of the ground as a map tells them: `points` (n, 3) in m, in the frame of the samples, NaN for unknown."""

    stamp: int
    frame_id: str
    points: Any


ContactInput = Geometry | FeetStates | Joints | Wrench | Schedule | Terrain
"""What may be told about the contacts of a body besides its scene."""


class Landing(NamedTuple):
    """A foot that has come to stand: `stamp` in ns, inferred from its motion; `late` and `confirmed` as in `Foot`.

    `history` has the (lead time in s, error of the announced time in s) of every prediction of it, `gap_over_speed` the
    same of that simple answer, where the foot came down. `speed` in m/s is
    that of the foot in its last frame in the air, and `impact` the touchdown that it makes with it: a planned foot may
    brake to rest just as it reaches the ground, a real one has that speed when the ground comes one frame earlier.
    `point` names what of a foot with several points has landed, "heel" or "toe" of two; None for all of it. A landing
    that was not announced has no `history`.
    """

    foot: str
    stamp: int
    late: float | None
    confirmed: bool | None
    history: tuple[tuple[float, float], ...]
    speed: float | None = None
    impact: Touchdown | None = None
    point: str | None = None
    gap_over_speed: tuple[tuple[float, float], ...] = ()


class SpatialTwist(NamedTuple):
    """Velocity of the mass centre (m/s) and angular velocity (rad/s) relative to the support, along the axes of the
    frame in which the support is given.
    """

    linear: Vector3
    angular: Vector3


class PointOutcome(NamedTuple):
    """What an impact does at a contact point, by its index in the geometry.

    `is_new` tells that it strikes. Its `position` in m then, the unit `normal` out of the support, `impulse` in N s,
    and `velocity` right after the impact in m/s relative to the support, have the axes of a `SpatialTwist`.
    `lift_probability` is None where nobody asks for it.
    """

    point: int
    is_new: bool
    position: Vector3
    normal: Vector3
    impulse: Vector3
    velocity: Vector3
    state: ContactState
    lift_probability: float | None = None


class Uncertainty(NamedTuple):
    """How sure the impact of a touchdown is, under the planar law.

    `given` says what became of the covariance of the sample's twist; `probabilities` of the modes, by their numbers;
    `mean` and standard `deviation` of the twist after the impact, in the impact plane; `twist_covariance` of the body's
    twist after it, as in `Sample`: the sample's own where that was refused.
    """

    given: Covariance
    probabilities: tuple[float, ...]
    mean: Twist
    deviation: Twist
    twist_covariance: tuple[float, ...]


KINDS: Final = ("flight>corner", "flight>edge", "corner>corner", "corner>edge+", "edge>corner", "edge>face")
"""The kinds of touchdowns: what stood and what strikes, a corner being one point, an edge two or more."""


def kind_of(old: tuple[int, ...], new: tuple[int, ...]) -> str:
    """The kind of a touchdown, from the points that stood and those that strike."""
    return KINDS[2 * min(len(old), 2) + (len(new) > 1)]


class Touchdown(NamedTuple):
    """The touchdown that a sample announces, with the impact it makes.

    `lead_time` in s from the sample's stamp; `old` and `new` the indices of the geometry's points that stand and
    that strike; `axis` the unit vector about which the body turns, in the world frame (omega of the planar twists is
    minus the angular velocity about it); twists of the mass centre relative to the support, in the impact plane;
    `position` (m), `orientation`, `linear` (m/s) and `angular` (rad/s) right after the impact, as in `Sample`;
    `half_distance` between the two contacts in m; `off_axis` the part of the angular velocity off the axis (0..1);
    `lateral` the velocity along the axis in m/s; `closing_spread` the time in s between the closing of the two ends of
    the striking edge; `uncertainty` and `planar` where the scene asks for them, `planar` being the impact in the plane
    whose margins can be read. `before_6d` and `after_6d` are the whole twists, `contacts` the points that take part.

    Of a walking machine `bound` tells what the impulses are, and `drives` which part of them its drives make; `jumps`
    are the changes of the velocities of its `joints` (rad/s or m/s), of which one rigid body has none.
    """

    lead_time: float
    mode: Mode
    before: Twist
    after: Twist
    impulses: tuple[Vector, Vector]
    segments: tuple[str, ...]
    energy_lost: float
    flags: Flag
    unique: bool
    law: str
    old: tuple[int, ...]
    new: tuple[int, ...]
    axis: Vector3
    position: Vector3
    orientation: Quaternion
    linear: Vector3
    angular: Vector3
    half_distance: float
    off_axis: float
    lateral: float
    closing_spread: float
    offset: float
    leftover: Leftover
    before_6d: SpatialTwist
    after_6d: SpatialTwist
    contacts: tuple[PointOutcome, ...] = ()
    uncertainty: Uncertainty | None = None
    planar: Outcome | None = None
    bound: Bound | None = None
    drives: float = 0.0
    joints: tuple[str, ...] = ()
    jumps: tuple[float, ...] = ()

    @property
    def kind(self) -> str:
        """What stands and what strikes (`kind_of`)."""
        return kind_of(self.old, self.new)


class Score(NamedTuple):
    """A settled touchdown: the last prediction before it against what was measured after it.

    `stamp` in ns, the predicted touchdown, which was `announced` so many s ahead by the first prediction of it; the
    last one is that of the `sample` with that stamp, 0 without any;
    `measured` None when the record ends too early; `relative_error` None when there is nothing to compare; `history`
    the (lead time in s, relative error) of every prediction of it that had the same contacts. Of a walking machine
    `stamp` is when its foot came to stand, and `landing` tells of that. All this is in the impact plane; `spatial`
    compares the whole twists, where the record shows the touchdown, and counts where `leftover_6d` does not say why
    not.
    """

    stamp: int
    touchdown: Touchdown
    measured: Twist | None
    relative_error: float | None
    scored: bool
    leftover: Leftover
    history: tuple[tuple[float, float], ...]
    landing: Landing | None = None
    leftover_6d: Leftover = Leftover.MOVING_CONTACTS
    spatial: SpatialScore | None = None
    announced: float = 0.0
    sample: int = 0

    @property
    def kind(self) -> str:
        """What stood and what struck, as the record shows it, or else as it was predicted."""
        return self.touchdown.kind if self.spatial is None else self.spatial.kind

    @property
    def before_6d(self) -> SpatialTwist:
        """The whole twist before the touchdown, as it was predicted."""
        return (self.touchdown if self.spatial is None else self.spatial.told).before_6d


class Prediction(NamedTuple):
    """The answer to one sample.

    `touchdown` is None when none lies within the horizon; `score` is the touchdown that this sample's measurement
    completed, if any. Over a moving `support` both are in its frame, as is `relative`, the sample seen from there.
    Of a walking machine `touchdown` is that of the foot that lands next, and `feet` has when each one lands.
    """

    status: Status
    sample: Sample
    touchdown: Touchdown | None = None
    score: Score | None = None
    support: Moment | None = None
    relative: Sample | None = None
    feet: tuple[Foot, ...] = ()
