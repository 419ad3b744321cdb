"""The parameters of a walking machine: its feet, and the model of its joints."""

from __future__ import annotations

from typing import Final

from .flaws import feet_flaw
from .types import Parameter

OF_MODEL: Final = ("body.mass", "body.inertia")
"""Parameters that a machine with robot.urdf does without."""

WALKING_PARAMETERS: Final = (
    Parameter(
        "feet.names",
        "string_array",
        (),
        "",
        "Names of the feet of a walking machine, whose points move against the body. They come with contact_geometry, "
        "in this order, or with joint_states where robot.urdf is given. Left out, the contact points are the body's.",
        flaw=feet_flaw,
    ),
    Parameter(
        "feet.points",
        "integer",
        1,
        "1",
        "Contact points of each foot, which follow each other: 1, or 2 for a sole of heel and toe.",
        low=1,
        high=2,
    ),
    Parameter(
        "feet.dead_time",
        "double",
        0.02,
        "s",
        "How long a foot must seem to stand, or to swing, until that is believed.",
        low=0.0,
        high=1.0,
    ),
    Parameter(
        "feet.timeout",
        "double",
        0.1,
        "s",
        "Age above which a message about the feet tells nothing any more.",
        low=1e-3,
        high=60.0,
    ),
    Parameter(
        "feet.force",
        "double",
        0.0,
        "N",
        "Force on the sensor of a foot, on contact_wrench, from which it confirms that the foot stands; 0 where there "
        "are no sensors, and no subscription.",
        low=0.0,
        high=1e9,
    ),
    Parameter(
        "feet.has_schedule",
        "bool",
        False,
        "",
        "Whether a planner tells on schedule when the feet are to stand, so that landings are told to be early or "
        "late.",
    ),
    Parameter(
        "robot.urdf",
        "string",
        "",
        "",
        "File of the machine's model (URDF); a relative path begins in the folder where the process runs. Its feet "
        "and its inertia are then those of joint_states, which may tell of other joints too, and body.mass and "
        "body.inertia are neither needed nor used. Left out, the legs have no mass.",
    ),
    Parameter(
        "robot.frames",
        "string_array",
        (),
        "",
        "The frame in robot.urdf of each contact point of the feet, in the order of feet.names.",
        flaw=feet_flaw,
    ),
)
