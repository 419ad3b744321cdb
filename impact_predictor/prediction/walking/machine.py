"""What impulses at the feet of a machine do to it, as one rigid body on legs without mass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from ...errors import InputError
from ...mechanics.impact.spatial import ContactPoints, SpatialOutcome, solve_body
from ..planar import GRAZES, ORIGIN
from ..scene import Scene
from ..types import Bound, Status, Vector3
from ..vectors import Axes, add, cross, six_numbers, tensor_to_world, to_world
from .base import NOTHING

SINGULAR: Final = 1e-12  # a principal moment of inertia below this part of the largest one is rounding


class MachineOutcome:
    """What an impact does to a machine, the bound that it is, and of a robot more.

    The twist of the impact is the change of that of the base, at its origin. `jumps` are the changes of the joint
    velocities (rad/s or m/s), `drives` is the part of the impulses' work that the drives oppose, 0 to 1.
    """

    def __init__(
        self, impact: SpatialOutcome, bound: Bound, jumps: tuple[float, ...] = (), drives: float = 0.0
    ) -> None:
        self.impact, self.bound, self.jumps, self.drives = impact, bound, jumps, drives


class RigidMachine:
    """One rigid body, the scene's, with its whole inertia tensor; its legs have no mass and are held by their joints.

    Raises:
        InputError: the inertia of the scene has no inverse.
    """

    is_rigid = True
    """Whether the feet move with the base alone."""
    joints: tuple[str, ...] = ()

    def __init__(self, scene: Scene) -> None:
        moments = np.linalg.eigvalsh(np.array(scene.inertia))
        if not moments[0] > SINGULAR * moments[-1]:
            raise InputError(
                f"the inertia {scene.inertia} of the body has no inverse: give one that is positive about every axis"
            )
        self._scene = scene
        # What can be compiled is compiled before the first landing.
        axes = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        self.struck([0], ContactPoints([ORIGIN], [0.0], [0.0], velocities=[ORIGIN], gaps=[0.0]), axes, scene)

    def struck(
        self,
        points: list[int],
        contacts: ContactPoints,
        axes: Axes,
        scene: Scene,
        pulls: Sequence[Vector3] = (),
    ) -> MachineOutcome | Status:
        """What an impact at some points of the feet does to the machine; a status where it has no response.

        The `contacts`, with one normal and each with its own numbers else, are told from the base's origin, as if the
        machine were at rest and the support came with the velocities of the feet; they and the outcome are along the
        axes of the world, those of the base are `axes`.
        The `scene` has normal and law. Each contact gains as many m/s in a second as `pulls` have: what lasts for some
        time is not over before they show.
        """
        center = to_world(axes, self._scene.center_of_mass)
        problem = [self._scene.mass, *six_numbers(tensor_to_world(axes, self._scene.inertia)), *NOTHING]
        told: Any = contacts
        each = zip(told.positions, told.friction, told.restitution, told.velocities, told.gaps, strict=True)
        for place, friction, restitution, velocity, gap in each:
            problem += (*add(place, center, -1.0), *told.normals, friction, restitution, *velocity, gap)
        found = solve_body(np.array(problem), scene.law, scene.merge, GRAZES)
        assert found.twist is not None
        x, y, z, p, q, r = found.twist.tolist()
        found.twist[:3] = add((x, y, z), cross((p, q, r), center), -1.0)
        return MachineOutcome(impact=found, bound=Bound.UPPER)
