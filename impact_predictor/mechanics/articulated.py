"""Whole-body mechanics of a machine with joints, from its URDF through Pinocchio: `WholeBody`.

Its generalized velocities are the linear and the angular velocity of the base, the root link of the URDF, along the
base's axes, and then one for each joint. The mobility of its contacts is W = G M^-1 G^T with the whole-body inertia M,
which has the armature on its diagonal: a rotor behind a gear weighs, seen from its joint, its inertia times the square
of the gear's ratio (Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 9.6).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

SINGULAR = 1e-12
"""A pivot of the inertia matrix below this part of its diagonal is rounding: something moves that has no mass."""

CROSSED = np.array([[0, 0, 0, 0, 0, 1, 0, -1, 0], [0, 0, -1, 0, 0, 0, 1, 0, 0], [0, 1, 0, -1, 0, 0, 0, 0, 0]], float)
"""Times an arm it is the matrix, row by row, of the cross product of a spin with it; NumPy's function takes longer."""


class WholeBody:
    """A model of `urdf`, a file, with the points at the origins of its `frames` (links or joints) as contacts.

    A link whose only collision shape is a sphere touches with the lowest point of that ball instead, which moves over
    it as it rolls; `radii` (m) make balls in the place of the file's, where they are given. With `soles` each frame has
    as many contacts, one after the other: these points (m) along its axes, in the place of its origin.
    `joints` are the names of the joints that move, in the model's order, and `mass` in kg is that of all links. `place`
    it before anything else is read: `inertia` (n, n) is then M(q), with the `armature` of each joint (kg m^2, or kg),
    `points` (k, 3) in m and `jacobians` (k, 3, n) are those of the contacts, along the base's axes.

    Raises:
        InputError: Pinocchio is not installed, there is no such file or frame, or the file is not the URDF of a machine
            whose joints have one degree of freedom each.
    """

    def __init__(
        self,
        urdf: str,
        frames: Sequence[str],
        radii: Sequence[float] = (),
        soles: Sequence[tuple[float, float, float]] = (),
    ) -> None:
        self._pinocchio = _pinocchio()
        self._model = _model(self._pinocchio, urdf)
        self._data = self._model.createData()
        places = list(soles) * len(frames) or [(0.0, 0.0, 0.0)] * len(frames)
        balls = [(0.0, place) for place in places] if soles or radii else _balls(urdf, frames)
        frames = [name for name in frames for _ in soles or (name,)]
        self._frames = [_frame(self._model, name, urdf) for name in frames]
        self.radii = list(radii) or [radius for radius, _ in balls]
        self._balls = np.array(self.radii)[:, None]
        self._centers = np.array([center for _, center in balls]).reshape(-1, 3)
        self._are_off = [any(center) for _, center in balls]
        # The first joint is the universe, the second the base's.
        moving = list(self._model.joints)[2:]
        self.joints: tuple[str, ...] = tuple(self._model.names)[2:]
        self.mass: float = self._pinocchio.computeTotalMass(self._model)
        for name, joint in zip(self.joints, moving, strict=True):
            if joint.nv != 1:
                raise InputError(
                    f"{urdf}: joint {name} has {joint.nv} degrees of freedom; give a model whose joints have one each"
                )
        self._plain = [(i, joint.idx_q) for i, joint in enumerate(moving) if joint.nq == 1]
        self._endless = [(i, joint.idx_q) for i, joint in enumerate(moving) if joint.nq == 2]
        low, high = self._model.lowerPositionLimit, self._model.upperPositionLimit
        self.limits = [
            (i, float(low[place]), float(high[place])) for i, place in self._plain if low[place] < high[place]
        ]
        """Of each joint that has limits its place among `joints`, the lower and the upper one in rad or m."""
        # The base is at the origin and not turned, so that the model's world is its frame.
        self._q: NDArray[np.float64] = self._pinocchio.neutral(self._model)
        self.inertia: NDArray[np.float64] = np.zeros((self._model.nv, self._model.nv))
        self._joint = np.arange(6, self._model.nv)
        self._twists: NDArray[np.float64] = np.zeros((len(frames), 6, self._model.nv))
        self._arms: NDArray[np.float64] = np.zeros((len(frames), 3))
        self.points: NDArray[np.float64] = np.zeros((len(frames), 3))
        self.jacobians: NDArray[np.float64] = self._twists[:, :3]

    def place(self, positions: NDArray[np.float64], down: Sequence[float] = (0.0, 0.0, -1.0)) -> bool:
        """Take the `positions` (rad or m) of `joints`; whether the inertia there has an inverse.

        The ground lies `down` from balls, a unit vector along the base's axes.
        """
        for i, place in self._plain:
            self._q[place] = positions[i]
        for i, place in self._endless:
            self._q[place : place + 2] = np.cos(positions[i]), np.sin(positions[i])
        pinocchio, model, data = self._pinocchio, self._model, self._data
        pinocchio.computeJointJacobians(model, data, self._q)
        pinocchio.updateFramePlacements(model, data)
        aligned = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        for k, frame in enumerate(self._frames):
            place = data.oMf[frame]
            self._twists[k] = pinocchio.getFrameJacobian(model, data, frame, aligned)
            self.points[k] = place.translation
            if self._are_off[k]:
                self._arms[k] = place.rotation @ self._centers[k]
        self.jacobians = self._twists[:, :3].copy()
        if any(self.radii) or any(self._are_off):
            # The contacts are the lowest points of balls, at the ends of these arms.
            arms = self._arms + self._balls * np.array(down)
            self.points += arms
            self.jacobians += (arms @ CROSSED).reshape(-1, 3, 3) @ self._twists[:, 3:]
        self.inertia = pinocchio.crba(model, data, self._q).copy()
        # A leg whose mass is at its end moves without mass where it is stretched, and only there.
        pinocchio.cholesky.decompose(model, data)
        return bool((SINGULAR * self.inertia.diagonal() < data.D).all())

    @property
    def armature(self) -> NDArray[np.float64]:
        """That of each joint, which the inertia has in it from the next place on."""
        found: NDArray[np.float64] = self._model.armature[6:]
        return found

    @armature.setter
    def armature(self, values: NDArray[np.float64]) -> None:
        self._model.armature = np.concatenate([np.zeros(6), values])

    def velocities(self, rates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Velocities (k, 3) of the points relative to the base, by the `rates` of `joints` (rad/s or m/s)."""
        moved: NDArray[np.float64] = self.jacobians[:, :, 6:] @ rates
        return moved

    def inertia_with(self, added: NDArray[np.float64]) -> NDArray[np.float64]:
        """M with more inertia `added` at each joint."""
        inertia = self.inertia.copy()
        inertia[self._joint, self._joint] += added
        return inertia

    def foot_forces(self, efforts: NDArray[np.float64], gravity: Sequence[float]) -> NDArray[np.float64]:
        """Forces (k, 3) in N on the points, along the base's axes, that hold `joints` with their `efforts` (N m or N).

        As if the machine rested under `gravity` (m/s^2, along the base's axes): J^T f = g(q) - efforts, by least
        squares (Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 3.2, without accelerations).
        """
        self._model.gravity.linear = np.array(gravity)
        pull = self._pinocchio.computeGeneralizedGravity(self._model, self._data, self._q)[6:]
        arms = self.jacobians[:, :, 6:].reshape(-1, len(pull))
        forces: NDArray[np.float64] = np.linalg.lstsq(arms.T, pull - efforts, rcond=None)[0]
        return forces.reshape(-1, 3)

    def mobility(
        self,
        points: Sequence[int],
        ways: NDArray[np.float64],
        added: NDArray[np.float64] | None = None,
        are_held: bool = False,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """W = G M^-1 G^T in 1/kg, and M^-1 G^T, the change of the generalized velocities by each unit impulse.

        A row of G is the velocity of one of the `points`, given by their indices, along one of the `ways` (k, 3), unit
        vectors; rows of one point follow each other. M may have more inertia `added` at each joint; joints that
        `are_held` do not move.
        """
        inertia = self.inertia if added is None else self.inertia_with(added)
        size = 6 if are_held else len(inertia)
        rows = (ways @ self.jacobians[list(points), :, :size]).reshape(-1, size)
        moved = np.zeros((len(inertia), len(rows)))
        moved[:size] = np.linalg.solve(inertia[:size, :size], rows.T)
        W = rows @ moved[:size]
        return 0.5 * (W + W.T), moved


def _pinocchio() -> Any:
    try:
        import pinocchio
    except ImportError as error:
        raise InputError(
            "robot.urdf needs Pinocchio, which is not installed: install it with `pip install pin` or the extra "
            "`articulated`"
        ) from error
    return pinocchio


def _model(pinocchio: Any, urdf: str) -> Any:
    if not Path(urdf).is_file():
        where = f" in {Path.cwd()}, where this program runs" if not Path(urdf).is_absolute() else ""
        raise InputError(f"robot.urdf: there is no file {urdf!r}{where}; give the whole path of the machine's URDF")
    try:
        return pinocchio.buildModelFromUrdf(urdf, pinocchio.JointModelFreeFlyer())
    except (ValueError, RuntimeError) as error:
        # The parser, which is no Python, prints what is wrong on standard error itself.
        raise _unreadable(urdf) from error


def _unreadable(urdf: str) -> InputError:
    return InputError(f"robot.urdf: {urdf} is not a URDF that Pinocchio can read; check it with `check_urdf`")


def _frame(model: Any, name: str, urdf: str) -> int:
    if not model.existFrame(name):
        raise InputError(f"robot.frames: {urdf} has no link or joint {name!r}; give one for each contact point")
    number: int = model.getFrameId(name)
    return number


def _balls(urdf: str, frames: Sequence[str]) -> list[tuple[float, tuple[float, ...]]]:
    """Radius (m) and centre of the ball at each frame: the sphere that is the only collision shape of its link.

    Where there is none the radius is zero.
    """
    try:
        root = ElementTree.parse(urdf).getroot()
    except ElementTree.ParseError as error:  # Pinocchio takes more than XML
        raise _unreadable(urdf) from error
    children = {joint.get("name"): joint.find("child") for joint in root.iter("joint")}
    of_joints = {name: child.get("link") for name, child in children.items() if child is not None}
    links = {link.get("name"): link.findall("collision") for link in root.findall("link")}
    found: list[tuple[float, tuple[float, ...]]] = []
    center: tuple[float, ...] = ()
    for frame in frames:
        shapes = links.get(frame, links.get(of_joints.get(frame), []))
        sphere = shapes[0].find("geometry/sphere") if len(shapes) == 1 else None
        origin = shapes[0].find("origin") if sphere is not None else None
        try:
            center = tuple(map(float, ("" if origin is None else origin.get("xyz", "")).split())) or (0.0, 0.0, 0.0)
            radius = 0.0 if sphere is None else float(sphere.get("radius", 0.0))
        except ValueError:
            radius = nan
        if not (0.0 <= radius < inf and len(center) == 3 and all(map(isfinite, center))):
            raise InputError(
                f"robot.urdf: the sphere of {frame!r} in {urdf} has no radius from 0 or no centre of three numbers; "
                "correct it"
            )
        found.append((radius, center))
    return found
