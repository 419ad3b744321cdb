"""Impacts by compliant contacts, by MuJoCo and by draws over gaps, beside the laws: python benchmarks/bench_peers.py

The problems and what is held to be right are those of `impact-predictor report`. MuJoCo is compared where it is
installed (the extra `robot`): in three dimensions, and on bodies that move in the plane alone and have a size at which
a time step means something. It has no restitution, and the contacts that serve an impact best: elliptic cones, and
dampers as hard as the step allows. Compliant contacts are Kelvin-Voigt springs with regularised friction, integrated by
scipy. Over gaps that are known to 0.45 mm only, one solution is compared with draws: by the mean twist, and by how
likely each contact leaves.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import lru_cache, partial
from importlib.util import find_spec
from itertools import chain
from math import hypot
from random import Random
from types import SimpleNamespace
from typing import Any

import numpy as np
from compliant_impact import compliant_impact

from impact_predictor.mechanics import bodies, closed_forms
from impact_predictor.mechanics.impact.spatial import solve_spatial_impacts
from impact_predictor.mechanics.types import Contact, ContactState, Mode, Twist
from impact_predictor.prediction.uncertainty import normal_points
from impact_predictor.report.accuracy import IMPACT, SPATIAL, AccuracyScene, error_of, impacts, rows_of, spatial
from impact_predictor.report.accuracy.impacts import Aftermath, Struck
from impact_predictor.report.accuracy.spatial import SpatialAftermath, StruckBox

DRAWS, ALL = (16, 32, 64), 1024
"""Draws over uncertain gaps: those that are compared, and the reference's."""

DEVIATION = 4.5e-4
"""Standard deviation of uncertain gaps in m: as at the corners of a cube that was measured."""

STEPS = 5
"""Steps of MuJoCo through an impact."""

MODEL = """<mujoco>
<option timestep="{step:.17g}" gravity="0 0 0" cone="elliptic" solver="Newton" tolerance="1e-12" iterations="200"/>
<default><geom condim="3" solref="-1e-9 {damping:.17g}" solimp="0.9999 0.9999 0.001" margin="{margin:.17g}"/></default>
<worldbody>{planes}<body>
<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>
<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{inertia:.17g} {inertia:.17g} {inertia:.17g}"/>{spheres}
</body></worldbody></mujoco>"""
"""A body with planar joints over one plane per contact."""

BOX_MODEL = """<mujoco>
<option timestep="{step}" gravity="0 0 0" cone="elliptic" solver="Newton" tolerance="1e-12" iterations="200"/>
<default><geom friction="{friction:.17g} 0 0" solref="-1e-9 {damping}" solimp="0.9999 0.9999 0.001" margin="{margin}"/>
</default><worldbody><geom type="plane" size="0 0 1"/><body pos="0 0 {height:.17g}"><freejoint/>
<inertial pos="0 0 0" mass="{mass:.17g}" fullinertia="{inertia}"/>{spheres}</body></worldbody></mujoco>"""
"""A body on small spheres; without stiffness its contacts push nothing before they are struck."""


def ordinary(source: Random, shape: str) -> Struck:
    """A rod, plate or cylinder of the paper of an ordinary size, which turns about A at rest, friction to 1.5."""
    given = {"mass": 10.0 ** source.uniform(-1.0, 1.0), "friction": source.uniform(0.0, 1.5)}
    size = 10.0 ** source.uniform(-1.0, 0.5)
    if shape == "rod":
        a, b = (0.5 * size * 10.0 ** source.uniform(-1.0, 0.0) for _ in range(2))
        given |= {"length": size, "thickness": size * 10.0 ** source.uniform(-2.0, -1.0), "a": a, "b": b}
    elif shape == "plate":
        given |= {"length": size, "height": size * 10.0 ** source.uniform(-0.7, 0.7)}
    else:
        given |= {"radius": size, "gamma": 1.4 * 10.0 ** source.uniform(-1.4, 0.0)}
    body = getattr(bodies, shape)(**given)
    omega = -(10.0 ** source.uniform(-1.0, 1.0))
    right = getattr(closed_forms, shape)(**given, omega=omega)
    return Struck(body, body.turning(omega), known=Aftermath(Twist(*right.twist.tolist()), Mode(int(right.mode))))


def compliant(strike: Struck, stiffness: float) -> Aftermath | None:
    """One impact on springs; None where the integration does not come to its end."""
    found = compliant_impact(strike.body, strike.twist, stiffness)
    return Aftermath(found.twist, found.mode) if found.over else None


def mujoco(strike: Struck, step: float) -> Aftermath:
    """Some steps; the model of a body is built once, which is not timed."""
    engine, model, data = model_of(strike, step)
    engine.mj_resetData(model, data)
    data.qvel[:] = strike.twist
    engine.mj_step(model, data, STEPS)
    return Aftermath(Twist(*data.qvel.tolist()))


@lru_cache(maxsize=1)
def model_of(strike: Struck, step: float) -> tuple[Any, Any, Any]:
    """MuJoCo, the model of a body, and its data."""
    import mujoco as engine

    mass, inertia, old, new = strike.body
    contacts = [contact for contact in (old, new) if contact is not None]
    size = max(hypot(contact.x, contact.y) for contact in contacts)
    parts = [geoms(contact, 1e-3 * size, 1 << index) for index, contact in enumerate(contacts)]
    planes, spheres = ("".join(column) for column in zip(*parts, strict=True))
    # With the margin both contacts are in the constraints from the start; without stiffness it pushes nothing.
    margin = 50.0 * step * size * abs(strike.twist.omega)
    sizes = {"step": step, "damping": -1.0 / step, "margin": margin, "mass": mass, "inertia": inertia}
    model = engine.MjModel.from_xml_string(MODEL.format(**sizes, planes=planes, spheres=spheres))
    return engine, model, engine.MjData(model)


def geoms(contact: Contact, pad: float, bit: int) -> tuple[str, str]:
    """The plane of a contact, and the sphere of the body that touches it alone."""
    (nx, ny), x, y = contact.normal, contact.x, contact.y
    shared = f'friction="{contact.friction:.17g} 0 0" contype="{bit}" conaffinity="{bit}"'
    plane = f'<geom type="plane" size="0 0 1" pos="{x:.17g} 0 {y:.17g}" zaxis="{nx:.17g} 0 {ny:.17g}" {shared}/>'
    centre = f"{x + pad * nx:.17g} 0 {y + pad * ny:.17g}"
    return plane, f'<geom type="sphere" size="{pad:.17g}" pos="{centre}" {shared}/>'


def mujoco_of_box(strike: StruckBox, step: float) -> SpatialAftermath:
    """Some steps of MuJoCo, which has no restitution; its model of a body is built once, which is not timed."""
    engine, model, data = model_of_box(strike, step)
    engine.mj_resetData(model, data)
    data.qvel[:] = strike.twist
    engine.mj_step(model, data, STEPS)
    turned = data.xmat[1].reshape(3, 3) @ data.qvel[3:]  # it tells the spin along the axes of the body
    return SpatialAftermath(np.concatenate((data.qvel[:3], turned)))


@lru_cache(maxsize=1)
def model_of_box(strike: StruckBox, step: float) -> tuple[Any, Any, Any]:
    """MuJoCo, the model of a box, and its data."""
    import mujoco as engine

    arms, inertia = np.asarray(strike.contacts.positions), np.asarray(strike.body.inertia)
    pad = 1e-3 * float(np.abs(arms).max())
    spheres = [f'<geom type="sphere" size="{pad}" pos="{x} {y} {z + pad}"/>' for x, y, z in arms]
    sizes = {"step": step, "damping": -1.0 / step, "margin": 50.0 * step, "height": -arms[0, 2]}
    sizes |= {"mass": strike.body.mass, "friction": strike.contacts.friction, "spheres": "".join(spheres)}
    text = " ".join(str(inertia[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    model = engine.MjModel.from_xml_string(BOX_MODEL.format(**sizes, inertia=text))
    return engine, model, engine.MjData(model)


def over_gaps(strike: StruckBox, draws: int) -> SpatialAftermath:
    """The mean over draws of the gaps at the contacts that strike."""
    points = DEVIATION * normal_points(draws, len(strike.strikes)).T
    gaps = np.where(strike.strikes, points - points[:, strike.strikes].min(axis=1, keepdims=True), 0.0)
    found = solve_spatial_impacts(strike.body, strike.contacts._replace(gaps=gaps), strike.twist)
    leaves = found.states == list(ContactState).index(ContactState.LEAVES)
    return SpatialAftermath(found.twist.mean(axis=0), leaves.mean(axis=0))


def uncertain() -> SimpleNamespace:
    """What follows where gaps are known to a part of a millimetre only."""
    sets = ("gaps, edge", 2, 2), ("gaps, face", 0, 4)
    return SimpleNamespace(
        SCENES={
            AccuracyScene(name, SPATIAL, name, "", f"{ALL} draws"): partial(
                spatial.box, tilt=0, stand=stand, strike=strike, bounces=True
            )
            for name, stand, strike in sets
        },
        METHODS={("one solution", ""): spatial.solved}
        | {("mean", f"{draws} draws"): partial(over_gaps, draws=draws) for draws in DRAWS},
        reference_of=partial(over_gaps, draws=ALL),
        errors_of=spatial.errors_of,
    )


def questions(step: float = 1e-4) -> list[SimpleNamespace]:
    """Ordinary bodies of the paper and any on a floor, and boxes in three dimensions, with what this machine has."""
    draws: dict[str, Callable[[Random], Struck]] = {"floor": partial(impacts.drawn, kind="floor")}
    draws |= {shape: partial(ordinary, shape=shape) for shape in ("rod", "plate", "cylinder")}
    scenes = {AccuracyScene(name, IMPACT, name, "", ""): draw for name, draw in draws.items()}
    planar: dict[tuple[str, str], Callable[[Any], Any]] = {("path law", ""): partial(impacts.law, name="path")}
    planar["compliant contacts", "k = 1e+08 N/m"] = partial(compliant, stiffness=1e8)
    boxes: dict[tuple[str, str], Callable[[Any], Any]] = {("path law in three dimensions", ""): spatial.solved}
    if find_spec("mujoco"):
        planar["MuJoCo", f"dt = {step:g} s"] = partial(mujoco, step=step)
        boxes["MuJoCo", f"dt = {step:g} s"] = partial(mujoco_of_box, step=step)
    return [
        SimpleNamespace(SCENES=drawn, METHODS=methods, reference_of=of.reference_of, errors_of=of.errors_of)
        for drawn, methods, of in ((scenes, planar, impacts), (spatial.SCENES, boxes, spatial))
    ]


def main() -> None:
    """Print a row for each method on each scene."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=30, help="problems of each scene")
    arguments = parser.parse_args()
    print(f"{'scene':12}{'method':36}{'median error':>14}{'90 % below':>12}{'leaves':>9}{'us':>11}{'problems':>10}")
    for row in chain.from_iterable(rows_of(question, arguments.count) for question in (*questions(), uncertain())):
        median = float("inf") if row["twist_error"] is None else row["twist_error"]
        method, wrong = f"{row['method']} {row['setting']}", row["wrong_modes"]
        numbers = f"{median:14.2g}{error_of(row):12.2g}{'' if wrong is None else format(wrong, '.2g'):>9}"
        print(f"{row['scene']:12}{method:36}{numbers}{row['us']:11.1f}{row['count']:10,}")


if __name__ == "__main__":
    main()
