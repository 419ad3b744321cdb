"""Every parameter, declared once: of a body and its impacts, of a moving support and its watch, of feet."""

from __future__ import annotations

from math import tau
from typing import Final

from .types import (
    BEGINNING,
    COMPUTED,
    EXECUTOR,
    FURTHEST,
    SUPPORT,
    TOPICS,
    Parameter,
    boolean,
    double,
    doubles,
    edges_flaw,
    extent_flaw,
    feet_flaw,
    inertia_flaw,
    integer,
    metres,
    names_flaw,
    newtons,
    normal_flaw,
    places,
    points_flaw,
    ratio,
    seconds,
    text,
    texts,
)

_TABLE: Final = (
    double("body.mass", None, "Mass of the body.", unit="kg", low=1e-9, high=1e12, of_model=True),
    doubles(
        "body.inertia",
        None,
        "Inertia about the mass centre, in the axes of the body frame: ixx iyy izz ixy ixz iyz, the last three as "
        "elements of the matrix (URDF); or one number if it is the same about every axis (sphere, cube).",
        unit="kg m^2",
        lengths=(1, 6),
        flaw=inertia_flaw,
        of_model=True,
    ),
    metres("body.center_of_mass", (0.0, 0.0, 0.0), "Mass centre in the body frame.", lengths=(3,)),
    metres(
        "body.contact_points",
        (),
        "Points that can touch the support, in the body frame: x y z of each, one after the other. Left out, they "
        "come from the topic contact_geometry; given, there is no such subscription.",
        flaw=points_flaw,
        fixed=TOPICS,
    ),
    ratio("contact.friction", None, "Coulomb friction coefficient between body and support.", high=100.0),
    doubles(
        "contact.friction_band",
        (),
        "Lowest and highest friction that the deck may have, for which the watch tells the margin against sliding too.",
        unit="1",
        low=0.0,
        high=100.0,
        lengths=(2,),
    ),
    ratio(
        "contact.restitution",
        0.0,
        "Coefficient of restitution at the contact that strikes; 0 is a plastic impact.",
        high=1.0,
    ),
    double(
        "contact.tolerance",
        0.005,
        "Gap to the support below which a point counts as touching, if what is measured scatters less; 0 takes the "
        "scatter alone.",
        unit="m",
        low=0.0,
        high=1.0,
    ),
    seconds(
        "contact.time", 0.005, "Duration of a contact, in which gravity acts: slower approaches are rest.", high=1.0
    ),
    seconds(
        "contact.merge",
        0.0015,
        "How long a contact is compressed: impacts on points that close within it overlap; 0 keeps them apart.",
        high=1.0,
    ),
    integer(
        "contact.most_points",
        1000,
        "Number of contact points above which a message about them is refused.",
        unit="1",
        low=2,
        high=100_000,
    ),
    double(
        "contact.stiffness",
        0.0,
        "Stiffness of a foot on the ground, which tells how long the drives of a robot work until the force of a "
        "contact has its first peak; 0 where it is not known: contact.time and contact.merge tell it then.",
        unit="N/m",
        low=0.0,
        high=1e12,
    ),
    text("support.frame", "", "frame_id that odom must have; empty accepts any.", shared=True, fixed=SUPPORT),
    text(
        "tf.body_frame",
        "",
        "Name of the body's frame. Given, messages in other frames are brought to it, and to support.frame, by /tf and "
        "/tf_static; empty, these are not subscribed to.",
        fixed=TOPICS,
    ),
    doubles(
        "support.normal",
        (0.0, 0.0, 1.0),
        "Direction out of the support, in the frame of odom, or in the support's own where it moves; of any length "
        "but zero.",
        unit="1",
        lengths=(3,),
        flaw=normal_flaw,
        fixed=SUPPORT,
    ),
    double(
        "support.height",
        0.0,
        "Distance of the support's plane from the origin, along its normal.",
        unit="m",
        low=-FURTHEST,
        high=FURTHEST,
    ),
    text(
        "odom.twist",
        "message",
        "Where the twist comes from: the message, or the difference to the pose before, over odom.twist_window.",
        choices=("message", "poses"),
    ),
    seconds(
        "odom.twist_window",
        0.0,
        "Time over which the source of odom averages its twist; 0 for a twist of the very instant.",
        high=1.0,
    ),
    doubles(
        "gravity",
        (0.0, 0.0, -9.81),
        "Acceleration of a free body, in the frame of odom, or in the world frame where the support moves.",
        unit="m/s^2",
        low=-1000.0,
        high=1000.0,
        lengths=(3,),
        shared=True,
        fixed=SUPPORT,
    ),
    text(
        "law",
        "path",
        "Impact law: path follows the growing impulse (Routh), total solves for the whole impulse at once.",
        choices=("path", "total"),
    ),
    integer(
        "uncertainty.samples",
        0,
        "How many points carry the uncertainty of a sample through its impact, 16 or more and even; 0 for none.",
        unit="1",
        low=0,
        high=4096,
    ),
    ratio("uncertainty.friction", 0.0, "Standard deviation of contact.friction.", high=100.0),
    ratio("uncertainty.restitution", 0.0, "Standard deviation of contact.restitution.", high=1.0),
    double(
        "uncertainty.gap",
        -1.0,
        "Standard deviation of the gaps of points; negative takes the scatter of points that stand, and a tenth of "
        "contact.tolerance until it is known.",
        unit="m",
        low=-1.0,
        high=1.0,
    ),
    ratio(
        "uncertainty.law",
        0.15,
        "Standard deviation of what a contact does after an impact against what the law says, as a part of the speed "
        "before it.",
        high=1.0,
    ),
    boolean(
        "margins",
        False,
        "Whether a prediction tells how far its impact is from another mode, in friction, geometry and slip.",
    ),
    ratio(
        "validity.slenderness",
        0.01,
        "Thickness over length below which a body is flagged THIN_BODY: it bends while it strikes.",
        high=1.0,
    ),
    ratio(
        "validity.gravity_share",
        0.25,
        "Part of the new contact's impulse above which gravity's during contact.time gives the flag SLOW_IMPACT.",
        low=1e-6,
        high=1e6,
    ),
    seconds("horizon", 0.25, "How far ahead of a sample a touchdown is looked for.", low=1e-3, high=60.0),
    text(
        "executor",
        "single",
        "How the node waits for messages: single is rclpy's single-threaded executor, events its experimental one, "
        "which costs less per message.",
        choices=("single", "events"),
        shared=True,
        fixed=EXECUTOR,
    ),
    text(
        "messages",
        "auto",
        "Form of ~/prediction and ~/score: typed ones of the package impact_predictor_msgs, which tell of units on "
        "~/deck too, or strings in diagnostic arrays; auto takes typed ones where that package is installed.",
        choices=("auto", "typed", "strings"),
        shared=True,
        fixed=TOPICS,
    ),
    texts(
        "bodies",
        (),
        "Names of the bodies, where there are several: the topics of each lie under its name, and every parameter "
        "that is not of all may be given for one, as <body>.<parameter>. Left out, there is one body without a name.",
        flaw=names_flaw,
        shared=True,
        fixed=TOPICS,
    ),
    text(
        "source",
        "odom",
        "What is measured of the body: odom has its pose and twist, imu its tilt alone, and none nothing.",
        choices=("odom", "imu", "none"),
        fixed=TOPICS,
    ),
    metres(
        "place.position",
        (0.0, 0.0, 0.0),
        "Where the body frame's origin stands in the support's frame, as far as its source does not tell.",
        lengths=(3,),
        fixed=BEGINNING,
    ),
    double(
        "place.yaw",
        0.0,
        "How far the body frame is turned about the support's normal, as far as its source does not tell.",
        unit="rad",
        low=-tau,
        high=tau,
        fixed=BEGINNING,
    ),
    double(
        "body.radius",
        0.0,
        "Radius of a cylinder that lies on two edges of the support; 0 for a body of contact points.",
        unit="m",
        low=0.0,
        high=1000.0,
        fixed=COMPUTED,
    ),
    metres(
        "support.edges",
        (),
        "The two edges of the support on which a cylinder lies: x y z of one point of each, in the support's frame.",
        lengths=(6,),
        flaw=edges_flaw,
        fixed=SUPPORT,
    ),
    text(
        "support.motion",
        "fixed",
        "Whether the support moves, and what tells its motion: odom is its pose and twist on support/odom, imu an "
        "inertial sensor on support/imu.",
        choices=("fixed", "odom", "imu"),
        shared=True,
        fixed=TOPICS,
    ),
    metres(
        "support.imu_position",
        (0.0, 0.0, 0.0),
        "Where the support's inertial sensor lies in the support's frame, whose axes it has.",
        lengths=(3,),
        shared=True,
        fixed=SUPPORT,
    ),
    seconds(
        "support.window",
        0.2,
        "Time over which the accelerations of the support are estimated from what is measured of it; 0 takes the one "
        "that errs least, by the noise and the motion that the messages show.",
        low=0.0,
        high=10.0,
        shared=True,
        fixed=SUPPORT,
    ),
    seconds(
        "support.timeout",
        0.5,
        "Age above which a message about the support tells nothing any more.",
        low=0.01,
        high=60.0,
        shared=True,
        fixed=SUPPORT,
    ),
    metres(
        "support.extent",
        (),
        "Edges of the support in its frame: least x, greatest x, least y, greatest y. Left out, it has no end.",
        lengths=(4,),
        flaw=extent_flaw,
        shared=True,
        fixed=SUPPORT,
    ),
    boolean(
        "onset.watch",
        False,
        "Whether to watch how near the body is to sliding and to tipping, and to report it on /diagnostics.",
        fixed=COMPUTED,
    ),
    ratio(
        "onset.warn",
        0.7,
        "Part of the margin against sliding or tipping that is used up (1 at the onset) from which the level is WARN, "
        "until the sea is learnt.",
        low=0.01,
        high=100.0,
    ),
    ratio(
        "onset.error", 1.0, "Part of the margin that is used up from which the level is ERROR.", low=0.01, high=100.0
    ),
    ratio(
        "onset.hysteresis",
        0.1,
        "How far the part must fall below onset.warn or onset.error before the level falls.",
        high=100.0,
    ),
    seconds("onset.hold", 5.0, "How long the part must stay that low before the level falls.", high=3600.0),
    seconds("onset.horizon", 10.0, "How far ahead an onset is looked for; waves tell nothing further.", high=15.0),
    ratio(
        "onset.vain",
        0.5,
        "Part of the warnings that may be vain: less warns later. Once the sea is learnt, which takes a minute or two, "
        "the level is WARN when an onset within the horizon is likelier than one minus this, or one within three "
        "seconds a fifth as likely.",
        high=0.95,
    ),
    places("lashings.points", "Where each lashing takes hold of the body, in the body frame: x y z of each."),
    places("lashings.anchors", "Where each is made fast, in the support's frame: x y z of each, in the same order."),
    newtons("lashings.msl", "Maximum securing load of each lashing, or one number for all of them."),
    newtons("lashings.preload", "Tension of each lashing at rest, or one number for all of them. Left out, none."),
    newtons(
        "lashings.stiffness", "Stiffness of each, or of all. Left out, each stretches by 1 % under its MSL.", "N/m"
    ),
    places("chocks.points", "Where each chock or stopper touches the body, in the support's frame: x y z of each."),
    places("chocks.normals", "Where each can push the body to, in the support's frame: x y z, of any length.", "1"),
    newtons("chocks.strength", "What each chock bears, or one number for all of them. Left out, any force."),
    double("wind.pressure", 0.0, "Pressure of the wind, from the worst side.", unit="N/m^2", low=0.0, high=1e6),
    doubles(
        "wind.area", (), "What it meets along x and y of the body frame.", unit="m^2", low=0.0, high=1e6, lengths=(2,)
    ),
    metres("wind.center", (0.0, 0.0, 0.0), "Where the wind's force acts, in the body frame.", lengths=(3,)),
    texts(
        "feet.names",
        (),
        "Names of the feet of a walking machine, whose points move against the body. They come with contact_geometry, "
        "in this order, with feet_states, or with joint_states where robot.urdf is given. Left out, the contact points "
        "are the body's.",
        flaw=feet_flaw,
        fixed=TOPICS,
    ),
    integer(
        "feet.points",
        1,
        "Contact points of each foot, which follow each other: 1, 2 for a sole of heel and toe, or up to 4 corners.",
        unit="1",
        low=1,
        high=4,
        fixed=TOPICS,
    ),
    seconds(
        "feet.dead_time", 0.02, "How long a foot must seem to stand, or to swing, until that is believed.", high=1.0
    ),
    seconds(
        "feet.timeout", 0.1, "Age above which a message about the feet tells nothing any more.", low=1e-3, high=60.0
    ),
    double(
        "feet.delay",
        0.0,
        "By how much the stamps of the feet are later than those of the trunk, which is taken out of them; negative "
        "where they are earlier.",
        unit="s",
        low=-0.1,
        high=0.1,
    ),
    boolean(
        "feet.find_delay",
        False,
        "Whether the delay of the feet is found while they stand, and taken out; feet.delay is then what it begins "
        "with.",
    ),
    double(
        "feet.force",
        0.0,
        "Force on the sensor of a foot, on contact_wrench, from which it confirms that the foot stands; 0 where there "
        "are no sensors, and no subscription.",
        unit="N",
        low=0.0,
        high=1e9,
        fixed=TOPICS,
    ),
    text(
        "feet.force_source",
        "sensor",
        "What tells the force on a foot: its sensor, or the efforts in joint_states with robot.urdf, as if the machine "
        "rested.",
        choices=("sensor", "effort"),
        fixed=TOPICS,
    ),
    doubles(
        "feet.friction",
        (),
        "Coulomb friction coefficient between each foot and the ground, in the order of feet.names, or one for all of "
        "them. Left out, it is contact.friction.",
        unit="1",
        low=0.0,
        high=100.0,
    ),
    doubles(
        "feet.restitution",
        (),
        "Coefficient of restitution of each foot that lands, in the order of feet.names, or one for all of them. Left "
        "out, it is contact.restitution.",
        unit="1",
        low=0.0,
        high=1.0,
    ),
    boolean(
        "feet.has_schedule",
        False,
        "Whether a planner tells on schedule when the feet are to stand, so that landings are told to be early or "
        "late.",
        fixed=TOPICS,
    ),
    double(
        "feet.terrain",
        0.0,
        "Size of the cells in which the heights on the topic terrain are gathered, as large as those of the map; 0 "
        "where none tells of the ground, and no subscription.",
        unit="m",
        low=0.0,
        high=10.0,
        fixed=TOPICS,
    ),
    doubles(
        "feet.radius",
        (),
        "Radius of the balls about the feet's points, in the order of feet.names, or one for all of them: the lowest "
        "point of a ball touches. Left out, they are the spheres of robot.urdf, and without it the points touch.",
        unit="m",
        low=0.0,
        high=10.0,
    ),
    text(
        "robot.urdf",
        "",
        "File of the machine's model (URDF); a relative path begins in the folder where the process runs. Its feet "
        "and its inertia are then those of joint_states, which may tell of other joints too, and body.mass and "
        "body.inertia are neither needed nor used. Left out, the legs have no mass.",
        fixed=TOPICS,
    ),
    texts(
        "robot.frames",
        (),
        "The frame in robot.urdf of each contact point of the feet, in the order of feet.names; of each foot where "
        "robot.soles is given.",
        flaw=feet_flaw,
        fixed=TOPICS,
    ),
    doubles(
        "robot.soles",
        (),
        "x y z of each contact point of a foot along the axes of its frame, the same of all feet: heel, toe. Left out, "
        "the frames' origins touch.",
        unit="m",
        low=-100.0,
        high=100.0,
        fixed=TOPICS,
    ),
    texts(
        "robot.joints",
        (),
        "Names of the joints of robot.urdf, in whose order robot.armature, robot.kp and robot.kd are given; only where "
        "one of these has more than one number.",
        flaw=feet_flaw,
        fixed=COMPUTED,
    ),
    doubles(
        "robot.armature",
        (),
        "Inertia of the rotor of each joint, seen from the joint (of a prismatic one in kg), or one number for all of "
        "them. Left out, rotors weigh nothing.",
        unit="kg m^2",
        low=0.0,
        high=1e9,
        fixed=COMPUTED,
    ),
    text(
        "robot.drives",
        "free",
        "What the drives do in an impact: nothing (free), hold every joint (held), or follow the gains robot.kp and "
        "robot.kd over contact.time (pd).",
        choices=("free", "held", "pd"),
        fixed=COMPUTED,
    ),
    doubles(
        "robot.kp",
        (),
        "With robot.drives pd, gain of each joint on its position, or one for all of them.",
        unit="N m/rad",
        low=0.0,
        high=1e9,
        fixed=COMPUTED,
    ),
    doubles(
        "robot.kd",
        (),
        "With robot.drives pd, gain of each joint on its velocity, or one for all of them.",
        unit="N m s/rad",
        low=0.0,
        high=1e9,
        fixed=COMPUTED,
    ),
)

RETIRED: Final = {
    "support.extrapolation": "the watch learns the sea by itself now, so delete the line",
    "support.harmonic_window": "the watch learns the sea by itself now, so delete the line",
    "transverse_slip": "friction opposes the whole slip of every touchdown now, so delete the line",
}
"""Parameters that there were, and what to do about them."""

PARAMETERS: Final[dict[str, Parameter]] = {parameter.name: parameter for parameter in _TABLE}
"""Every parameter by its name."""
