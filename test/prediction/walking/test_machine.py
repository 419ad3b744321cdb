"""One rigid body as a mechanism, beside its six by six mass matrix."""

import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.impact.spatial import ContactPoints
from impact_predictor.prediction.scene import Robot, Scene, inertia_matrix
from impact_predictor.prediction.types import Joints
from impact_predictor.prediction.walking.machine import RigidMachine

URDF = """<robot name="block">
  <link name="body"><inertial><origin xyz="{place}"/><mass value="{mass:.17g}"/>
    <inertia ixx="{xx:.17g}" iyy="{yy:.17g}" izz="{zz:.17g}" ixy="{xy:.17g}" ixz="{xz:.17g}" iyz="{yz:.17g}"/>
  </inertial></link>
  {feet}
</robot>
"""
FOOT = """<link name="foot_{k}"/><joint name="leg_{k}" type="fixed"><parent link="body"/><child link="foot_{k}"/>
    <origin xyz="{place}"/></joint>"""


def random_body(source):
    """A rigid body with its mass centre off the origin, and four feet."""
    parts = source.normal(size=(3, 8))
    moments = parts @ parts.T
    inertia = np.trace(moments) * np.eye(3) - moments
    scene = Scene(
        mass=source.uniform(1.0, 100.0),
        inertia=tuple(map(tuple, inertia.tolist())),
        friction=0.6,
        center_of_mass=tuple(source.uniform(-0.2, 0.2, 3).tolist()),
    )
    return scene, tuple(map(tuple, source.uniform(-0.5, 0.5, (4, 3)).tolist()))


def random_plane(source):
    normal, ahead = np.linalg.qr(source.normal(size=(3, 3)))[0].T[:2]
    return tuple(normal.tolist()), tuple(ahead.tolist())


def test_a_body_whose_inertia_has_no_inverse_is_refused_in_one_sentence():
    needle = Scene(mass=1.0, inertia=inertia_matrix((0.0, 1.0, 1.0, 0.0, 0.0, 0.0)), friction=0.5)
    with pytest.raises(InputError, match="has no inverse"):
        RigidMachine(needle)


@pytest.mark.extras
def test_a_machine_without_joints_is_a_trunk(tmp_path):
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    from impact_predictor.prediction.walking.articulated import ArticulatedMachine

    source = np.random.default_rng(2)
    path = tmp_path / "block.urdf"
    for _ in range(20):
        scene, points = random_body(source)
        normal, ahead = random_plane(source)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = scene.inertia
        feet = [FOOT.format(k=k, place="{:.17g} {:.17g} {:.17g}".format(*point)) for k, point in enumerate(points)]
        place = "{:.17g} {:.17g} {:.17g}".format(*scene.center_of_mass)
        numbers = {"xx": xx, "yy": yy, "zz": zz, "xy": xy, "xz": xz, "yz": yz}
        path.write_text(URDF.format(place=place, mass=scene.mass, feet="\n".join(feet), **numbers))
        machine = ArticulatedMachine(Robot(str(path), tuple(f"foot_{k}" for k in range(4))))
        geometry = machine.geometry_of(Joints(0, (), (), ()))
        assert np.array(geometry.points) == pytest.approx(np.array(points), abs=1e-15)
        for old in ([0], [0, 2], []):
            strikes = np.array(normal) - 0.3 * np.array(ahead)
            contacts = ContactPoints(
                positions=[points[i] for i in (*old, 1)],
                friction=[0.6] * (len(old) + 1),
                restitution=[0.2] * (len(old) + 1),
                normals=normal,
                velocities=[*[(0.0, 0.0, 0.0)] * len(old), strikes],
                gaps=[0.0] * (len(old) + 1),
            )
            axes = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
            told = [*old, 1], contacts, axes, scene._replace(normal=normal)
            one, other = RigidMachine(scene).struck(*told).impact, machine.struck(*told).impact
            assert one.states == other.states
            for field in ("twist", "impulses", "velocities"):
                # The tangents of the two differ, and so do the last sweeps of a step.
                same = np.array(getattr(one, field))
                assert np.array(getattr(other, field)) == pytest.approx(same, abs=1e-3 * np.abs(same).max())
