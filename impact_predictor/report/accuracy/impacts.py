"""The impact: bodies right before it, methods that tell what follows, and what they are held against.

The bodies of the paper are held against its closed forms, which share no code with the laws. For the others the law of
this program, the impulse path, counts as right, computed with the longest floats of the machine: so its own error is
rounding alone, and that the law itself is right is shown elsewhere, by exact arithmetic. Where a body slips across the
plane, no exact solution is known: there it is the finest tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from math import hypot, sqrt
from random import Random
from typing import Any, Final, NamedTuple

import numpy as np

from ...mechanics import bodies, closed_forms
from ...mechanics.compliant import compliant_impact
from ...mechanics.impact import LAWS, solve_impact
from ...mechanics.transverse import Transverse, solve_transverse_impact
from ...mechanics.types import Contact, Mode, Twist, TwoPointBody
from ...prediction.impact import TOLERANCE
from .measure import Method

FINEST: Final = 1e-7
"""Tolerance of the reference where a body slips across the plane, too."""


class Struck(NamedTuple):
    """A body and its twist right before the impact.

    `shape` is the name of the closed form that the paper has for it and `given` its arguments, "" where there is none;
    `across` is its slip across the impact plane in m/s.
    """

    body: TwoPointBody
    twist: Twist
    shape: str = ""
    given: tuple[tuple[str, float], ...] = ()
    across: float = 0.0


class Aftermath(NamedTuple):
    """Right after an impact: the twist of the mass centre, and the mode, None where a method tells none."""

    twist: Twist
    mode: Mode | None = None


def of_paper(source: Random, shape: str = "", stiff: bool = False) -> Struck:
    """A body of the paper, which turns about A at rest: no restitution, one friction.

    A `stiff` one is of any size and friction, slender or tall, or has its contacts nearly at one place.
    """
    shape = shape or source.choice(("rod", "plate", "cylinder"))

    def drawn(ordinary: tuple[float, float], wide: tuple[float, float]) -> float:
        return float(10.0 ** source.uniform(*(wide if stiff else ordinary)))

    size, mass = drawn((-1.0, 0.5), (-6.0, 6.0)), 10.0 ** source.uniform(-1.0, 1.0)
    given = {"mass": mass, "friction": 10.0 ** source.uniform(-3.0, 3.0) if stiff else source.uniform(0.0, 1.5)}
    if shape == "rod":
        a, b = (0.5 * size * drawn((-1.0, 0.0), (-6.0, 0.0)) for _ in range(2))
        given |= {"length": size, "thickness": size * drawn((-2.0, -1.0), (-8.0, -2.0)), "a": a, "b": b}
    elif shape == "plate":
        given |= {"length": size, "height": size * drawn((-0.7, 0.7), (-8.0, 3.0))}
    else:
        given |= {"radius": size, "gamma": 1.4 * drawn((-1.4, 0.0), (-6.0, 0.0))}
    body: TwoPointBody = getattr(bodies, shape)(**given)
    omega = -(10.0 ** source.uniform(-1.0, 1.0))
    return Struck(body, body.turning(omega), shape, tuple({**given, "omega": omega}.items()))


def tall(source: Random) -> Struck:
    """A block three to ten times as high as long; half of them slip at A, half of them bounce at B."""
    length = 10.0 ** source.uniform(-1.0, 0.5)
    restitution, friction = source.choice((0.0, 0.0, 0.125, 0.5)), source.uniform(0.0, 1.0)
    height = length * 10.0 ** source.uniform(0.5, 1.0)
    body = bodies.plate(length, height, 1.0, friction, restitution=restitution)
    twist = body.turning(-(10.0 ** source.uniform(-1.0, 1.0)))
    slip = source.choice((0.0, 1.0)) * source.uniform(-2.0, 2.0) * twist.omega * length
    return Struck(body, twist._replace(vx=twist.vx + slip))


def crossing(source: Random) -> Struck:
    """A cube that strikes with an edge and slips along it, too, as tossed ones do."""
    side, friction = source.uniform(0.05, 0.2), source.uniform(0.05, 0.5)
    body = bodies.plate(side, side, 1.0, friction, restitution=source.choice((0.0, 0.125, 0.3)))
    twist = body.turning(-source.uniform(2.0, 20.0))
    slip, across = (source.choice((-1.0, 1.0)) * source.uniform(0.05, 1.0) * twist.omega * side for _ in range(2))
    return Struck(body, twist._replace(vx=twist.vx + slip), across=across)


FORMULA: Final = "the paper's closed forms"
PATH: Final = "the impulse-path law with the longest floats of the machine: its own error is rounding alone"

SCENES: Final[dict[str, tuple[str, str, str, Callable[[Random], Struck]]]] = {
    "rod": (
        "Rod over two supports",
        "Rods of many sizes that turn about one support, plastic, friction to 1.5.",
        FORMULA,
        partial(of_paper, shape="rod"),
    ),
    "plate": (
        "Crate on a floor",
        "Plates with heights from a fifth to five times the length that turn about an edge, plastic, friction to 1.5.",
        FORMULA,
        partial(of_paper, shape="plate"),
    ),
    "cylinder": (
        "Cylinder between edges",
        "Cylinders that roll from one edge onto another, 6 to 160 degrees apart, plastic, friction to 1.5.",
        FORMULA,
        partial(of_paper, shape="cylinder"),
    ),
    "squat": (
        "Tall blocks",
        "Blocks three to ten times as high as long; half of them slip, half of them bounce.",
        PATH,
        tall,
    ),
    "stiff": (
        "Stiff bodies",
        "Rods, plates and cylinders of 1e-6 to 1e6 m, to 1e8 times as long as high, friction 0.001 to 1000.",
        FORMULA,
        partial(of_paper, stiff=True),
    ),
    "across": (
        "Slip across the plane",
        "Cubes that also slip along the edge that they strike with, as tossed ones do.",
        f"the path law with both slips at its finest tolerance, {FINEST:g}: no exact solution is known",
        crossing,
    ),
}
"""Title, description, reference, and what draws a body."""


def reference_of(strike: Struck) -> Aftermath:
    """What is held to be right."""
    if strike.shape:
        found = getattr(closed_forms, strike.shape)(**dict(strike.given))
        return Aftermath(Twist(*found.twist.tolist()), Mode(int(found.mode)))
    if strike.across:
        return across(strike, FINEST)
    return law(strike._replace(body=with_long_floats(strike.body), twist=with_long_floats(strike.twist)), "path")


def with_long_floats(value: Any) -> Any:
    """Nested tuples of numbers with more digits than a double has, where the machine has such numbers."""
    if isinstance(value, tuple):
        parts = [with_long_floats(part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return value if value is None else np.longdouble(value)


def law(strike: Struck, name: str) -> Aftermath:
    """One impact by one of the laws."""
    outcome = solve_impact(strike.body, strike.twist, name)
    return Aftermath(outcome.twist, outcome.mode)


def across(strike: Struck, tolerance: float) -> Aftermath:
    """One impact by the path law, with slip across the plane where there is any."""
    outcome = solve_transverse_impact(strike.body, strike.twist, Transverse(strike.across), tolerance).outcome
    return Aftermath(outcome.twist, outcome.mode)


def no_slip(strike: Struck) -> Aftermath:
    """The angular momentum about the new contact stays, and the body turns about it (Housner)."""
    (mass, inertia, _, new), (vx, vy, omega) = strike.body, strike.twist
    after = inertia * omega + mass * (new.y * vx - new.x * vy)
    after /= inertia + mass * (new.x * new.x + new.y * new.y)
    return Aftermath(Twist(after * new.y, -after * new.x, after), Mode.PIVOT)


def compliant(strike: Struck, stiffness: float) -> Aftermath | None:
    """One impact on springs; None where the integration does not come to its end."""
    found = compliant_impact(strike.body, strike.twist, stiffness)
    return None if found is None else Aftermath(found[1], found[0])


MUJOCO_STEPS: Final = 5
"""Steps of MuJoCo through an impact."""

MODEL: Final = """<mujoco>
<option timestep="{step:.17g}" gravity="0 0 0" cone="elliptic" solver="Newton" tolerance="1e-12" iterations="200"/>
<default><geom condim="3" solref="-1e-9 {damping:.17g}" solimp="0.9999 0.9999 0.001" margin="{margin:.17g}"/></default>
<worldbody>{planes}<body>
<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>
<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{inertia:.17g} {inertia:.17g} {inertia:.17g}"/>{spheres}
</body></worldbody></mujoco>"""
"""A body with planar joints over one plane per contact, with what serves an impact best: elliptic cones, and contacts
that are dampers strong enough to stop an approach within one step. MuJoCo has no restitution."""


def mujoco(strike: Struck, step: float) -> Callable[[], Aftermath]:
    """The model of a body is built once; what is timed is a reset, the state, and the steps."""
    import mujoco

    mass, inertia, old, new = strike.body
    contacts = [contact for contact in (old, new) if contact is not None]
    size = max(hypot(contact.x, contact.y) for contact in contacts)
    parts = [_geoms(contact, 1e-3 * size, 1 << index) for index, contact in enumerate(contacts)]
    planes, spheres = ("".join(column) for column in zip(*parts, strict=True))
    # With the margin both contacts are in the constraints from the start; without stiffness it pushes nothing.
    margin = 50.0 * step * size * abs(strike.twist.omega)
    made = MODEL.format(
        step=step,
        damping=-1.0 / step,
        margin=margin,
        mass=mass,
        inertia=inertia,
        planes=planes,
        spheres=spheres,
    )
    model = mujoco.MjModel.from_xml_string(made)
    data = mujoco.MjData(model)

    def run() -> Aftermath:
        mujoco.mj_resetData(model, data)
        data.qvel[:] = strike.twist
        mujoco.mj_step(model, data, MUJOCO_STEPS)
        return Aftermath(Twist(*data.qvel.tolist()))

    return run


def _geoms(contact: Contact, pad: float, bit: int) -> tuple[str, str]:
    """The plane of a contact, and the sphere of the body that touches it alone."""
    (nx, ny), x, y = contact.normal, contact.x, contact.y
    shared = f'friction="{contact.friction:.17g} 0 0" contype="{bit}" conaffinity="{bit}"'
    place, axis = f"{x:.17g} 0 {y:.17g}", f"{nx:.17g} 0 {ny:.17g}"
    plane = f'<geom type="plane" size="0 0 1" pos="{place}" zaxis="{axis}" {shared}/>'
    centre = f"{x + pad * nx:.17g} 0 {y + pad * ny:.17g}"
    return plane, f'<geom type="sphere" size="{pad:.17g}" pos="{centre}" {shared}/>'


ACROSS: Final = "path law with slip across"
USED: Final = (ACROSS, f"tolerance = {TOLERANCE:g}")
"""What the node uses; without slip across the plane it is the path law, to the bit."""

FAMILIES: Final = {
    "path law": "The impulse path of this program (Routh's hypothesis).",
    "total law": "The paper's laws on the impulses of the whole impact, at both contacts at once.",
    ACROSS: "The path law with friction against the slip across the plane, too, within a tolerance: the node's.",
    "no slip": "Housner's rocking model: the old contact leaves and the new one neither slips nor bounces.",
    "compliant": "Kelvin-Voigt springs of stiffness k with regularised friction, integrated by scipy.",
    "MuJoCo": "MuJoCo, five steps of dt: contacts are dampers as hard as the step allows; no restitution.",
    "predictor": "The whole predictor on each recorded sample, with the laws and parameters named.",
}
"""What the methods do."""


def methods() -> list[Method]:
    """The methods that can run on this machine."""
    found = [
        *(Method(f"{name} law", f"{name} law", "", partial(law, name=name)) for name in LAWS),
        Method(ACROSS, ACROSS, f"tolerance = {TOLERANCE:g}", partial(across, tolerance=TOLERANCE)),
        Method(ACROSS, ACROSS, "tolerance = 1e-06", partial(across, tolerance=1e-6)),
        Method("no slip", "no slip (Housner)", "", no_slip),
        Method("compliant", "compliant contacts", "k = 1e+08 N/m", partial(compliant, stiffness=1e8)),
    ]
    if has_mujoco():
        found.append(Method("MuJoCo", "MuJoCo", "dt = 0.0001 s", partial(mujoco, step=1e-4), suits_a_step, True))
    return found


def suits_a_step(strike: Struck) -> bool:
    """Whether a body moves in the plane alone and has a size at which a fixed time step means something."""
    return not strike.across and 1e-3 < hypot(strike.body.new.x, strike.body.new.y) < 1e3


def has_mujoco() -> bool:
    """Whether MuJoCo is installed."""
    return find_spec("mujoco") is not None


def error_of_twist(strike: Struck, after: Aftermath, reference: Aftermath) -> float:
    """Error of the twist after an impact, relative to the size of the twist before it, by their kinetic energy."""
    rho = sqrt(strike.body.inertia / strike.body.mass)
    apart = [one - other for one, other in zip(after.twist, reference.twist, strict=True)]
    before = strike.twist
    return hypot(apart[0], apart[1], rho * apart[2]) / hypot(before.vx, before.vy, rho * before.omega)
