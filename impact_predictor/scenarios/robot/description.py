"""Where robots are described: URDFs and postures, those of example-robot-data by their names."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError

Values = NDArray[np.float64]

_NO_MASS: Final = 1e-5
"""kg: what URDFs give to links that stand for nothing."""


class Sole(NamedTuple):
    """What of a foot touches the ground, in m: a ball about the origin of its frame, or where `radius` is 0 a flat sole
    from `heel` to `toe` along the frame's x axis, whose `width` is across.
    """

    radius: float = 0.0
    heel: float = 0.0
    toe: float = 0.0
    width: float = 0.0

    @property
    def points(self) -> Values:
        """The points of it that can touch first, in the frame of the foot: the ball's centre, or heel and toe."""
        return np.array([[0.0, 0.0, 0.0]] if self.radius > 0.0 else [[self.heel, 0.0, 0.0], [self.toe, 0.0, 0.0]])


class RobotFiles(NamedTuple):
    """Where a robot is described: its `urdf`, the links of its `feet`, and the file of its postures, or None.

    Without a `sole` its feet are balls, as large as the URDF has them.
    """

    urdf: Path
    feet: tuple[str, ...]
    srdf: Path | None = None
    sole: Sole | None = None


_NAMED: Final = {
    "a1": ("a1_description/urdf/a1.urdf", "a1_description/srdf/a1.srdf", "FL_foot FR_foot RL_foot RR_foot", None),
    "anymal": (
        "anymal_b_simple_description/robots/anymal.urdf",
        "anymal_b_simple_description/srdf/anymal.srdf",
        "LF_FOOT RF_FOOT LH_FOOT RH_FOOT",
        Sole(radius=0.031),
    ),
    "bolt": ("bolt_description/robots/bolt.urdf", "bolt_description/srdf/bolt.srdf", "FL_FOOT FR_FOOT", Sole(0.016)),
    "go1": ("go1_description/urdf/go1.urdf", "go1_description/srdf/go1.srdf", "FL_foot FR_foot RL_foot RR_foot", None),
    "hyq": (
        "hyq_description/robots/hyq_no_sensors.urdf",
        "hyq_description/srdf/hyq.srdf",
        "lf_foot rf_foot lh_foot rh_foot",
        Sole(radius=0.021),
    ),
    "solo12": (
        "solo_description/robots/solo12.urdf",
        "solo_description/srdf/solo.srdf",
        "FL_FOOT FR_FOOT HL_FOOT HR_FOOT",
        Sole(radius=0.016),
    ),
    "talos": (
        "talos_data/robots/talos_reduced.urdf",
        "talos_data/srdf/talos.srdf",
        "left_sole_link right_sole_link",
        Sole(heel=-0.1, toe=0.1, width=0.12),
    ),
}
"""URDF, postures, feet and soles of the robots of example-robot-data."""

NAMES: Final = tuple(_NAMED)
"""The robots that are known by name."""


def robot_named(name: str) -> RobotFiles:
    """The files of a robot of example-robot-data; InputError where they are not installed."""
    urdf, srdf, feet, sole = _NAMED[name]
    try:
        listed = {str(path): path.locate() for path in files("example-robot-data") or ()}
    except PackageNotFoundError:
        raise InputError(
            f"{name} needs the models of example-robot-data, which is not installed: install the extra `robot`, or "
            "give --urdf"
        ) from None

    places = [next(Path(str(listed[one])) for one in listed if one.endswith(f"/{path}")) for path in (urdf, srdf)]
    return RobotFiles(places[0], tuple(feet.split()), places[1], sole)


def read_xml(path: Path) -> ET.Element:
    """The root of a file; InputError where it is not there, or no XML."""
    try:
        return ET.parse(path).getroot()
    except (OSError, ET.ParseError) as error:
        raise InputError(f"{path} cannot be read as XML: {error}") from error


def simplify(root: ET.Element) -> None:
    """Leave out what is seen, what feet and drives replace, and the masses of links that stand for nothing."""
    for link in root.iter("link"):
        for part in [part for part in link if part.tag in ("visual", "collision")]:
            link.remove(part)
        inertial = link.find("inertial")
        if inertial is not None and not _has_mass(inertial):
            link.remove(inertial)
    for joint in root.iter("joint"):
        for part in joint.findall("dynamics"):
            joint.remove(part)
    for part in [part for part in root if part.tag not in ("link", "joint")]:
        root.remove(part)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", fusestatic="false", balanceinertia="true")


def _has_mass(inertial: ET.Element) -> bool:
    mass, tensor = inertial.find("mass"), inertial.find("inertia")
    if mass is None or tensor is None or float(mass.get("value", 0.0)) < _NO_MASS:
        return False
    six = [float(tensor.get(name, 0.0)) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")]
    matrix = np.array(six)[[0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(3, 3)
    return bool(np.linalg.eigvalsh(matrix)[0] > 0.0)


def ball_of(root: ET.Element, robot: RobotFiles) -> Sole:
    """The ball that all feet of a URDF have."""
    radii = {
        float(sphere.get("radius", 0.0))
        for link in root.iter("link")
        if link.get("name") in robot.feet
        for sphere in link.iterfind("collision/geometry/sphere")
    }
    if len(radii) != 1:
        raise InputError(f"the feet of {robot.urdf} are not balls of one size; give --radius")
    return Sole(radius=radii.pop())


def posture_of(srdf: Path, joints: Sequence[str]) -> Values:
    """The first posture of an SRDF whose name has "stand" or "half_sitting" in it; joints that it leaves out are 0."""
    for state in read_xml(srdf).iter("group_state"):
        if any(word in state.get("name", "") for word in ("stand", "half_sitting")):
            told = {joint.get("name"): joint.get("value", "0").split()[0] for joint in state.iter("joint")}
            return np.array([float(told.get(name, 0.0)) for name in joints])
    raise InputError(f"{srdf} has no group_state whose name says that the robot stands; leave --srdf out")
