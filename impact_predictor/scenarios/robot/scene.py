"""The scene with which a replay predicts the walk of a simulated robot."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from ...errors import InputError
from ..record import FRAME
from .sensors import CELL
from .walk import Walk

HEAD: Final = "# The scene of a robot that `impact-predictor simulate robot` has made walk."


def scene_of(walk: Walk, *, by_joints: bool, on_terrain: bool) -> str:
    """A ROS 2 parameter file; `by_joints` takes feet, mass and inertia from URDF and joint_states, `on_terrain` the
    heights of the ground from terrain.
    """
    machine = walk.machine
    center, inertia = machine.inertia()
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia.tolist()
    feet, radius = ", ".join(machine.feet), machine.sole.radius
    balls = [f"      radius: [{radius!r}]"] if by_joints and radius > 0.0 else []
    soles = [f"      soles: {machine.sole.points.ravel().tolist()}"] if radius == 0.0 else []
    body = [
        "    body:",
        f"      mass: {machine.mass!r}",
        f"      inertia: {[xx, yy, zz, xy, xz, yz]}",
        f"      center_of_mass: {center.tolist()}",
    ]
    stiffness, damping = machine.gains
    robot = [
        "    robot:",
        f"      urdf: {machine.files.urdf.resolve()}",
        f"      frames: [{feet}]",
        *soles,
        f"      armature: [{float(machine.armature)!r}]",
        "      drives: pd",
        f"      kp: [{float(stiffness)!r}]",
        f"      kd: [{float(damping)!r}]",
    ]
    lines = [
        HEAD,
        "/**:",
        "  ros__parameters:",
        "    feet:",
        f"      names: [{feet}]",
        f"      points: {len(machine.sole.points)}",
        *balls,
        *([f"      terrain: {CELL!r}"] if on_terrain else []),
        *(robot if by_joints else body),
        "    contact:",
        f"      friction: {machine.physics.friction!r}",
        "    support:",
        f"      frame: {FRAME}",
        f"      normal: {list(walk.ground.normal)}",
    ]
    return "\n".join(lines) + "\n"


def check_replaceable(path: Path) -> None:
    """Whether a scene may take a place; InputError where there is a file that is no such scene."""
    if path.exists() and not (path.is_file() and path.read_bytes().startswith(HEAD.encode())):
        raise InputError(f"{path} is no scene of a simulated robot, so it stays as it is; give --params-out")
