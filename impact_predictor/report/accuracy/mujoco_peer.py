"""Impacts in MuJoCo, where it is installed (the extra `peers`): a body with planar joints over one plane per contact.

Its contacts are regularised and convex; it has no restitution. The settings are those that serve an impact best:
elliptic cones, Newton's method, and contacts that are dampers strong enough to stop an approach within one step
(solref with no stiffness and the damping 1 / dt), with the highest impedance (solimp 0.9999). With its usual contacts,
springs of 20 ms, a body turns on before an impact is over. A margin keeps both contacts in the constraints from the
start; without stiffness it pushes nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from math import hypot

from ...mechanics.types import Contact, Twist
from .impact_scenes import After, Strike
from .methods import Method

TIME_STEPS = (1e-3, 1e-4, 1e-5)

STEPS = 5
"""Steps through an impact."""

PAD = 1e-3
"""Radius of the spheres that are the contacts, as a part of the distance of the contacts from the mass centre."""

REACH = 50.0
"""How many steps ahead a contact is in the constraints."""

FAMILIES = {
    "MuJoCo": "MuJoCo, planar joints, five steps of dt: contacts are dampers as hard as the step allows, friction is "
    "convex; no restitution.",
}

MODEL = """
<mujoco>
  <option timestep="{step:.17g}" gravity="0 0 0" cone="elliptic" solver="Newton" tolerance="1e-12" iterations="200"/>
  <default>
    <geom condim="3" solref="-1e-9 {damping:.17g}" solimp="0.9999 0.9999 0.001" margin="{margin:.17g}"/>
  </default>
  <worldbody>
    {planes}
    <body>
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 0 1"/>
      <joint type="hinge" axis="0 -1 0"/>
      <inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{inertia:.17g} {inertia:.17g} {inertia:.17g}"/>
      {spheres}
    </body>
  </worldbody>
</mujoco>
"""


def is_installed() -> bool:
    return find_spec("mujoco") is not None


def prepare(step: float) -> Callable[[Strike], Callable[[], After]]:
    """The model of a body is built once; what is timed is a reset, the state, and the steps."""

    def build(strike: Strike) -> Callable[[], After]:
        import mujoco

        mass, inertia, old, new = strike.body
        contacts = [contact for contact in (old, new) if contact is not None]
        size = max(hypot(contact.x, contact.y) for contact in contacts)
        parts = [geoms_of(contact, PAD * size, 1 << index) for index, contact in enumerate(contacts)]
        model = mujoco.MjModel.from_xml_string(
            MODEL.format(
                step=step,
                damping=-1.0 / step,
                margin=REACH * step * size * abs(strike.twist.omega),
                mass=mass,
                inertia=inertia,
                planes="".join(plane for plane, _ in parts),
                spheres="".join(sphere for _, sphere in parts),
            )
        )
        data = mujoco.MjData(model)

        def run() -> After:
            mujoco.mj_resetData(model, data)
            data.qvel[:] = strike.twist
            mujoco.mj_step(model, data, STEPS)
            return After(Twist(*data.qvel.tolist()))

        return run

    return build


def geoms_of(contact: Contact, pad: float, bit: int) -> tuple[str, str]:
    """The plane of a contact, and the sphere of the body that touches it alone."""
    nx, ny = contact.normal
    shared = f'friction="{contact.friction:.17g} 0 0" contype="{bit}" conaffinity="{bit}"'
    plane = (
        f'<geom type="plane" size="0 0 1" pos="{contact.x:.17g} 0 {contact.y:.17g}" zaxis="{nx:.17g} 0 {ny:.17g}" '
        f"{shared}/>"
    )
    x, y = contact.x + pad * nx, contact.y + pad * ny
    return plane, f'<geom type="sphere" size="{pad:.17g}" pos="{x:.17g} 0 {y:.17g}" {shared}/>'


def suits(strike: Strike) -> bool:
    """Whether MuJoCo can be asked: bodies of ordinary size that move in the plane."""
    return strike.ordinary and strike.across is None


METHODS: list[Method] = [Method("MuJoCo", "MuJoCo", f"dt = {step:g} s", prepare(step), suits) for step in TIME_STEPS]
