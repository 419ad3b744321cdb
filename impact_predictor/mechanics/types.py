"""Values of planar impact mechanics: contacts, bodies, twists, modes and outcomes.

Plane x (forward), y (up), rotation counter-clockwise positive, SI units (REP-103).
"""

from __future__ import annotations

from enum import IntEnum, IntFlag
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from .margins import Margins

Vector = tuple[float, float]
Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""As (x, y, z, w)."""


class Mode(IntEnum):
    """How a body goes on after it struck the new contact (the paper, sections 2 to 4).

    The numbers are part of the ROS interface (`~/mode`) and never change.
    """

    NO_IMPACT = 0
    """The new contact is not approached."""
    STOP = 1
    """Both contacts hold and neither slips."""
    SLIDE = 2
    """Both contacts hold and the body slides on them."""
    PIVOT_SLIDE = 3
    """The old contact lifts; the body turns about the new one, which slips."""
    PIVOT = 4
    """The old contact lifts; the body turns about the new one, which sticks."""
    BACK_PIVOT = 5
    """The new contact lifts again; the body turns back about the old one."""
    FLIGHT = 6
    """Both contacts lift."""


class ContactState(IntEnum):
    """What a contact does right after an impact in three dimensions."""

    LEAVES = 0
    SLIPS = 1
    STICKS = 2
    NEARS = 3
    """It had a gap and has not closed: it strikes later, or not."""


class Flag(IntFlag):
    """What a reader of an outcome should know besides its mode."""

    NONE = 0
    REVERSED_SLIP = 1
    """A contact slips against the direction in which it slipped, or first began to slip."""
    JAMMED = 2
    """The impulse path had no consistent rates (Painleve); a tangential impact at the old contact resolved it."""
    WORK_LIMITED = 4
    """Restitution ended when the stored normal work was returned, before Poisson's impulse was reached."""
    OLD_RESTITUTION_IGNORED = 8
    """The old contact does not approach, so its restitution had no effect."""
    ENERGY_GAINED = 16
    """Newton's restitution of the total law raised the kinetic energy."""
    SHARED_FRICTION = 32
    """Both contacts stick: how they share the push along their line is a choice, not mechanics."""
    BOTH_STRUCK = 64
    """Both contacts approach, so the total law answered."""
    LAST_RESORT = 128
    """The law had no answer, so a simpler one gave it: the total law without restitution, or, where the body slips
    across its plane, the planar law."""
    NO_SOLUTION = 256
    """No law has a solution (supports that move apart); the twist is left as it was."""
    INVALID_INPUT = 512
    """A number is not finite, or mass, inertia, friction, restitution or a normal is out of range."""
    THIN_BODY = 1024
    """The body is so thin that it bends while it strikes: rigid theory says too little (`Validity.slenderness`)."""
    SLOW_IMPACT = 2048
    """The impact is so weak that gravity matters while it lasts (`Validity.gravity_share`)."""
    NOT_CONVERGED = 4096
    """The impulses of an impact in three dimensions still changed when the sweeps ended; the answer is near."""
    POINT_APPROACHES = 8192
    """A point that took no part in the impact is about to touch the support, as the body moves after it."""


class Validity(NamedTuple):
    """Where the theory of rigid impact stops (the paper, section 2.2): beyond these an outcome is flagged.

    A body that stands on its old contact is thin (Flag.THIN_BODY) when the mass centre is nearer to the supports'
    tangents at both contacts than `slenderness` times half the length of the uniform rod of its inertia, sqrt(3) rho.
    For a rod on its long side `slenderness` is thickness over length; of the paper's rods that of 0.005 rebounded at
    both supports and that of 0.0125 did not.

    An impact is slow (Flag.SLOW_IMPACT) when the impulse of `gravity` (m/s^2) during `contact_time` (s), the longest
    that the contact may last, is more than `gravity_share` of the normal impulse at the new contact.
    """

    slenderness: float = 0.01
    gravity: float = 9.81
    contact_time: float = 5e-3
    gravity_share: float = 0.25


class Twist(NamedTuple):
    """Velocity of the mass centre (m/s) and angular velocity (rad/s)."""

    vx: float
    vy: float
    omega: float


class Contact(NamedTuple):
    """A contact point seen from the mass centre.

    `x`, `y` in m; `normal` is the unit normal out of the support; `restitution` in 0..1; `velocity` is the
    support's at the contact in m/s. The tangent is (normal_y, -normal_x).
    """

    x: float
    y: float
    friction: float
    normal: Vector = (0.0, 1.0)
    restitution: float = 0.0
    velocity: Vector = (0.0, 0.0)


class TwoPointBody(NamedTuple):
    """A rigid body with the contact it stands on (`old`, or None) and the one that strikes (`new`).

    `mass` in kg, `inertia` about the mass centre in kg m^2.
    """

    mass: float
    inertia: float
    old: Contact | None
    new: Contact

    def turning(self, omega: float) -> Twist:
        """The twist of the body while it turns about the old contact, which moves with its support."""
        if self.old is None:
            raise ValueError("a body without an old contact turns about nothing; give the twist itself")
        ux, uy = self.old.velocity
        return Twist(omega * self.old.y + ux, -omega * self.old.x + uy, omega)


class Alternative(NamedTuple):
    """Another answer that the law allows as well."""

    mode: Mode
    twist: Twist
    segments: tuple[str, ...]


class Outcome(NamedTuple):
    """What an impact does to a body.

    `twist` right after it; `impulses` as ((N_old, T_old), (N_new, T_new)) in N s along normal and tangent;
    `segments` the contact states along the impulse path (old contact first; O open, S stick, + or - slip);
    `energy_lost` in J, relative to the supports; `unique` is False when `alternatives` exist. `body` and `before` are
    what it was asked about; `restitution` is the rule of it.
    """

    mode: Mode
    twist: Twist
    impulses: tuple[Vector, Vector]
    segments: tuple[str, ...]
    flags: Flag
    energy_lost: float
    unique: bool
    alternatives: tuple[Alternative, ...]
    law: str
    body: TwoPointBody
    before: Twist
    restitution: str

    @property
    def margins(self) -> Margins:
        """How far the impact is from another mode, computed when it is asked for."""
        from .margins import margins

        # Where the total law answered for the path law, it was the path law that was asked.
        asked = "path" if self.flags & (Flag.BOTH_STRUCK | Flag.LAST_RESORT) else self.law
        return margins(self.body, self.before, asked, self.restitution)
