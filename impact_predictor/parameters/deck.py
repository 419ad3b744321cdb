"""The parameters of several bodies, of a support that moves, and of the watch over the bodies on it."""

from __future__ import annotations

from math import tau
from typing import Final

from .flaws import edges_flaw, extent_flaw, names_flaw
from .types import (
    BEGINNING,
    COMPUTED,
    SUPPORT,
    TOPICS,
    boolean,
    double,
    metres,
    ratio,
    seconds,
    text,
    texts,
)

DECK_PARAMETERS: Final = (
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
        "Time over which the accelerations of the support are estimated from what is measured of it.",
        low=0.005,
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
    text(
        "support.extrapolation",
        "constant",
        "How the support's motion goes on: constant keeps its accelerations, harmonic fits waves to the last "
        "support.harmonic_window.",
        choices=("constant", "harmonic"),
        shared=True,
        fixed=SUPPORT,
    ),
    seconds(
        "support.harmonic_window",
        20.0,
        "Time to which the harmonic extrapolation is fitted; several periods of the support's motion.",
        low=1.0,
        high=600.0,
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
        "Part of the margin against sliding or tipping that is used up (1 at the onset) from which the level is WARN.",
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
    seconds("onset.horizon", 5.0, "How far ahead an onset is looked for.", high=60.0),
)
