"""When one rigid body is good enough for a walking machine: the landings of HyQ, its joints locked and its joints free.

    pip install -e '.[articulated,robot]'
    python benchmarks/articulated.py

For each of the 49 landings in examples/hyq the joint positions follow from the feet by inverse kinematics, so that the
same landing, with the same velocities, is computed three times: for the scene's rigid body, for the whole robot of the
URDF with every joint locked as it is then, and for the robot with free joints, which is what an impact finds where the
joints are driven by finite torques. The plan brakes its feet to nothing at the ground; the velocities are those of the
last sample before it, as if the ground came at most 2.5 ms early.

What the drives weigh at the joints (rotors behind gears) is in no URDF; the last table adds it, until the joints are as
good as locked.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, files
from itertools import pairwise
from math import hypot
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from impact_predictor.bags.adapters import readers
from impact_predictor.bags.read import Bag
from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Mode
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import Robot, Scene, inertia_matrix
from impact_predictor.prediction.types import Joints, Sample, Touchdown, Vector3
from impact_predictor.prediction.vectors import add, axes_of, cross, to_world
from impact_predictor.prediction.walking.impact import LandingPoint, touchdown_of
from impact_predictor.prediction.walking.mechanism import (
    ArticulatedMachine,
    LeggedMachine,
    RigidMachine,
)

ROOT = Path(__file__).resolve().parents[1]
BAG = ROOT / "examples/hyq/hyq.bag"
PARAMETERS = ROOT / "config/walker_hyq.yaml"
STATE = {"/xpp/state_des": "xpp_msgs/msg/RobotStateCartesian"}
URDF = "hyq_no_sensors.urdf"
FRAMES = ("lf_foot", "rf_foot", "lh_foot", "rh_foot")

BENT = (0.0, 0.7, -1.4), (0.0, -0.7, 1.4)
"""Joint positions in rad with which the search begins: knees of the front legs backwards, of the hind legs forwards."""

REACHED = 1e-9
"""m: a foot is placed where it is to be."""

ROTORS = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
"""kg m^2, inertia of a drive about its joint. An electric one of a robot of this size has 0.01 to 1."""

STICKS = (Mode.STOP, Mode.PIVOT)
LIFTS = (Mode.PIVOT, Mode.PIVOT_SLIDE, Mode.FLIGHT)

Array = NDArray[np.float64]


class Case(NamedTuple):
    """A landing: the base and the points then, the feet that stand, the one that lands and its velocity; the joints."""

    base: Sample
    points: tuple[Vector3, ...]
    old: tuple[int, ...]
    new: int
    velocity: Vector3
    joints: Joints


class Impact(NamedTuple):
    """What a mechanism makes of a landing: effective mass in kg under the foot, impulse in N s, changes of the base's
    velocities in mm/s and mrad/s, energy in J, and the mode.
    """

    mass: float
    impulse: float
    linear: float
    angular: float
    energy: float
    mode: Mode


QUANTITIES = (
    ("effective mass under the foot, kg", 0),
    ("normal impulse of the foot, N s", 1),
    ("change of the base's velocity, mm/s", 2),
    ("change of its angular velocity, mrad/s", 3),
    ("energy lost, J", 4),
)


def model() -> str:
    """The file of the robot's model."""
    try:
        listed = files("example-robot-data") or []
    except PackageNotFoundError:
        raise InputError("the benchmark needs HyQ's model: pip install example-robot-data") from None
    return next(str(path.locate()) for path in listed if path.name == URDF)


def posture(legs: ArticulatedMachine, points: tuple[Vector3, ...], start: Array) -> Array:
    """The joint positions that put the feet at some points of the base's frame, by Newton's method."""
    body, positions = legs.body, start
    for _ in range(100):
        body.place(positions)
        miss = np.array(points) - body.points
        if np.abs(miss).max() < REACHED:
            return positions
        step = np.linalg.lstsq(body.jacobians[:, :, 6:].reshape(-1, len(positions)), miss.ravel(), rcond=1e-6)[0]
        positions = positions + np.clip(step, -0.3, 0.3)
    raise InputError(f"{URDF} cannot put its feet at {points}")


def landings(legs: ArticulatedMachine) -> list[Case]:
    """The landings in the record, each from the last message before the foot stands."""
    with Bag(BAG) as bag:
        read = readers(bag, STATE)
        states = [read[message.topic](message.data) for message in bag.messages(STATE)]
    names = legs.body.joints
    start = np.concatenate([BENT[name[1] == "h"] for name in names[::3]])
    cases = []
    for before, after in pairwise(states):
        struck = [foot for foot in range(len(FRAMES)) if after.stands[foot] and not before.stands[foot]]
        if not struck:
            continue
        assert before.sample is not None
        assert before.geometry is not None
        base, (_, _, points, velocities) = before.sample, before.geometry
        start = posture(legs, points, start)
        joints = Joints(base.stamp, names, tuple(start.tolist()), ())
        old = tuple(foot for foot in range(len(FRAMES)) if before.stands[foot])
        for foot in struck:
            moving = add(add(base.linear, cross(base.angular, points[foot])), velocities[foot])
            cases.append(Case(base, points, old, foot, to_world(axes_of(base.orientation), moving), joints))
    return cases


def locked(scene: Scene, inertia: Array) -> Scene:
    """The scene with a whole-body inertia as if every joint were locked."""
    mass = inertia[0, 0]
    lever = inertia[3:6, :3] / mass
    center = float(lever[2, 1]), float(lever[0, 2]), float(lever[1, 0])
    about = inertia[3:6, 3:6] + mass * lever @ lever
    six = about[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist()
    return scene._replace(mass=float(mass), center_of_mass=center, inertia=inertia_matrix(six))


def impact(scene: Scene, mechanism: LeggedMachine, case: Case) -> Impact:
    """The impact of a landing, and how it changes the base."""
    found = touchdown(scene, mechanism, case)
    # What stops the foot alone, were it not for friction.
    alone = touchdown(scene._replace(friction=0.0), mechanism, case._replace(old=(), velocity=(0.0, 0.0, -1.0)))
    linear, angular = add(found.linear, case.base.linear, -1.0), add(found.angular, case.base.angular, -1.0)
    mass, impulse = alone.impulses[1][0], found.impulses[1][0]
    return Impact(mass, impulse, 1e3 * hypot(*linear), 1e3 * hypot(*angular), found.energy_lost, found.mode)


def touchdown(scene: Scene, mechanism: LeggedMachine, case: Case) -> Touchdown:
    axes = axes_of(case.base.orientation)
    places = [add(case.base.position, to_world(axes, point)) for point in case.points]
    landing = {case.new: LandingPoint(case.velocity)}
    found = touchdown_of(scene, mechanism, case.base, places, case.old, (case.new,), landing, 0.0)
    assert isinstance(found, Touchdown)
    return found


def cost(call: Callable[[Case], object], cases: list[Case]) -> float:
    """Time of a call in us: of each landing the least of several runs, and the median of those."""
    runs = np.zeros((7, len(cases)))
    for run in runs:
        for k, case in enumerate(cases):
            begin = perf_counter()
            call(case)
            run[k] = perf_counter() - begin
    return 1e6 * float(np.median(runs.min(axis=0)))


def agree(ones: list[Impact], others: list[Impact], of: Callable[[Mode], object]) -> str:
    """In how many landings, in %, two models give the same of what `of` takes from a mode."""
    return f"{100.0 * float(np.mean([of(a.mode) == of(b.mode) for a, b in zip(ones, others, strict=True)])):.0f}"


def spread(numbers: Array) -> str:
    """The median and the 90 % quantile."""
    return f"{np.median(numbers):.3g} / {np.percentile(numbers, 90):.3g}"


def table_of(models: dict[str, list[Impact]], costs: list[float], stood: list[bool]) -> Table:
    """What each model says of the landings; the last one has free joints, and the others are set against it."""
    table = Table("median / 90 % below, or as told", *models, title=f"{len(stood)} landings of HyQ")
    numbers = [np.array([one[:5] for one in impacts]) for impacts in models.values()]
    for quantity, k in QUANTITIES:
        table.add_row(quantity, *(spread(rows[:, k]) for rows in numbers))
    table.add_section()
    *simple, free = models.values()
    ratios = [rows / numbers[-1] for rows in numbers[:-1]]
    for quantity, k in QUANTITIES[:4]:
        table.add_row(f"{quantity.partition(',')[0]}, times free", *(spread(rows[:, k]) for rows in ratios), "1")
    table.add_row("the least of the impulse, times free", *(f"{rows[:, 1].min():.3g}" for rows in ratios), "1")
    table.add_section()
    table.add_row("same mode as free, %", *(agree(one, free, lambda mode: mode) for one in simple), "")
    table.add_row("agree whether a foot slips, %", *(agree(one, free, STICKS.__contains__) for one in simple), "")
    *simple, free = ([one for one, old in zip(all_, stood, strict=True) if old] for all_ in models.values())
    lifts = [agree(one, free, LIFTS.__contains__) for one in simple]
    table.add_row(f"of {sum(stood)} with others on the ground: agree whether those lift, %", *lifts, "")
    table.add_section()
    table.add_row("cost of an impact, us", *(f"{one:.0f}" for one in costs))
    return table


def main() -> int:
    """Print the tables."""
    scene = Scene.from_parameters(validate(read_parameters(PARAMETERS)))
    legs = ArticulatedMachine(Robot(model(), FRAMES))
    cases = landings(legs)
    trunk = RigidMachine(scene)
    rotor = np.diag([0.0] * 6 + [1.0] * len(legs.body.joints))
    one: list[Impact] = []
    whole: list[Impact] = []
    driven: dict[float, list[Impact]] = {inertia: [] for inertia in ROTORS}
    for case in cases:
        one.append(impact(scene, trunk, case))
        legs.geometry_of(case.joints)
        bare = legs.body.inertia
        robot = locked(scene, bare)
        whole.append(impact(robot, RigidMachine(robot), case))
        for inertia, impacts in driven.items():
            legs.body.inertia = bare + inertia * rotor
            impacts.append(impact(robot, legs, case))

    def placed(case: Case) -> None:
        legs.geometry_of(case.joints)
        touchdown(scene, legs, case)

    by_trunk = cost(lambda case: touchdown(scene, trunk, case), cases)
    models = {"one rigid body (scene)": one, "all joints locked (URDF)": whole, "free joints (URDF)": driven[0.0]}
    console = Console()
    console.print(table_of(models, [by_trunk, by_trunk, cost(placed, cases)], [bool(case.old) for case in cases]))

    table = Table("inertia of each drive, kg m^2", "impulse", "same mode, %", title="Locked joints, times driven ones")
    for inertia, impacts in driven.items():
        ratios = np.array([a.impulse / b.impulse for a, b in zip(whole, impacts, strict=True)])
        table.add_row(f"{inertia:g}", spread(ratios), agree(whole, impacts, lambda mode: mode))
    console.print(table)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        sys.exit(str(error))
