"""The parameters of a body, its contacts and its impacts; with those of decks and of feet they are all there are."""

from __future__ import annotations

from typing import Final

from .deck import DECK_PARAMETERS
from .flaws import inertia_flaw, normal_flaw, points_flaw
from .types import FURTHEST, Parameter
from .walking import WALKING_PARAMETERS

_BODY_PARAMETERS: Final = (
    Parameter("body.mass", "double", None, "kg", "Mass of the body.", low=1e-9, high=1e12),
    Parameter(
        "body.inertia",
        "double_array",
        None,
        "kg m^2",
        "Inertia about the mass centre, in the axes of the body frame: ixx iyy izz ixy ixz iyz, the last "
        "three as elements of the matrix (URDF); or one number if it is the same about every axis (sphere, cube).",
        lengths=(1, 6),
        flaw=inertia_flaw,
    ),
    Parameter(
        "body.center_of_mass",
        "double_array",
        (0.0, 0.0, 0.0),
        "m",
        "Mass centre in the body frame.",
        lengths=(3,),
        low=-FURTHEST,
        high=FURTHEST,
    ),
    Parameter(
        "body.contact_points",
        "double_array",
        (),
        "m",
        "Points that can touch the support, in the body frame: x y z of each, one after the other. Left out, they "
        "come from the topic contact_geometry; given, there is no such subscription.",
        flaw=points_flaw,
        low=-FURTHEST,
        high=FURTHEST,
    ),
    Parameter(
        "contact.friction",
        "double",
        None,
        "1",
        "Coulomb friction coefficient between body and support.",
        low=0.0,
        high=100.0,
    ),
    Parameter(
        "contact.restitution",
        "double",
        0.0,
        "1",
        "Coefficient of restitution at the contact that strikes; 0 is a plastic impact.",
        low=0.0,
        high=1.0,
    ),
    Parameter(
        "contact.tolerance",
        "double",
        0.005,
        "m",
        "Gap to the support below which a point counts as touching.",
        low=0.0,
        high=1.0,
    ),
    Parameter(
        "contact.time",
        "double",
        0.005,
        "s",
        "Duration of a contact: an edge strikes as one when its ends close within it.",
        low=0.0,
        high=1.0,
    ),
    Parameter("support.frame", "string", "", "", "frame_id that odom must have; empty accepts any.", shared=True),
    Parameter(
        "support.normal",
        "double_array",
        (0.0, 0.0, 1.0),
        "1",
        "Direction out of the support, in the frame of odom, or in the support's own where it moves; of any length but "
        "zero.",
        lengths=(3,),
        flaw=normal_flaw,
    ),
    Parameter(
        "support.height",
        "double",
        0.0,
        "m",
        "Distance of the support's plane from the origin, along its normal.",
        low=-FURTHEST,
        high=FURTHEST,
    ),
    Parameter(
        "odom.twist_window",
        "double",
        0.0,
        "s",
        "Time over which the source of odom averages its twist; 0 for a twist of the very instant.",
        low=0.0,
        high=1.0,
    ),
    Parameter(
        "gravity",
        "double_array",
        (0.0, 0.0, -9.81),
        "m/s^2",
        "Acceleration of a free body, in the frame of odom, or in the world frame where the support moves.",
        low=-1000.0,
        high=1000.0,
        lengths=(3,),
        shared=True,
    ),
    Parameter(
        "law",
        "string",
        "path",
        "",
        "Impact law: path follows the growing impulse (Routh), total solves for the whole impulse at once.",
        choices=("path", "total"),
    ),
    Parameter(
        "transverse_slip",
        "bool",
        True,
        "",
        "Whether friction also opposes slip across the impact plane, so that a body that slips there too has less "
        "friction left in the plane. Only the law path knows it.",
    ),
    Parameter(
        "uncertainty.samples",
        "integer",
        0,
        "1",
        "How many points carry the uncertainty of a sample through its impact, 16 or more and even; 0 for none.",
        low=0,
        high=4096,
    ),
    Parameter(
        "uncertainty.friction",
        "double",
        0.0,
        "1",
        "Standard deviation of contact.friction.",
        low=0.0,
        high=100.0,
    ),
    Parameter(
        "uncertainty.restitution",
        "double",
        0.0,
        "1",
        "Standard deviation of contact.restitution.",
        low=0.0,
        high=1.0,
    ),
    Parameter(
        "margins",
        "bool",
        False,
        "",
        "Whether a prediction tells how far its impact is from another mode, in friction, geometry and slip.",
    ),
    Parameter(
        "validity.slenderness",
        "double",
        0.01,
        "1",
        "Thickness over length below which a body is flagged THIN_BODY: it bends while it strikes.",
        low=0.0,
        high=1.0,
    ),
    Parameter(
        "validity.gravity_share",
        "double",
        0.25,
        "1",
        "Part of the new contact's impulse above which gravity's during contact.time gives the flag SLOW_IMPACT.",
        low=1e-6,
        high=1e6,
    ),
    Parameter(
        "horizon", "double", 0.25, "s", "How far ahead of a sample a touchdown is looked for.", low=1e-3, high=60.0
    ),
    Parameter(
        "executor",
        "string",
        "single",
        "",
        "How the node waits for messages: single is rclpy's single-threaded executor, events its experimental one, "
        "which costs less per message.",
        choices=("single", "events"),
        shared=True,
    ),
)

PARAMETERS: Final[dict[str, Parameter]] = {
    parameter.name: parameter for parameter in (*_BODY_PARAMETERS, *DECK_PARAMETERS, *WALKING_PARAMETERS)
}
"""Every parameter by its name."""
