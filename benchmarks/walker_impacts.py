"""What the landings of robots in physics do, beside what is told of them: impulses, changes of the trunk, modes.

    pip install -e '.[articulated,robots]'
    python benchmarks/walker_impacts.py BAG SCENE [BAG SCENE]...

The bags are those of `impact-predictor simulate robot --by-joints`, with their scenes and true landings. Each
landing is computed from the true velocities right before it and the joints of that moment, so that nothing but the
impact is judged: for all joints held (one rigid body), for free joints, for free joints with the armature, and as the
scene has it. Below stands what stops the mass that the foot has with free joints, and that no impact changes anything.

Of each the impulse along the normal, told over measured, until 1, 2, 5 ms after the landing and until the greatest
force; the change of the trunk's twist until 5 ms (less what its acceleration of the 5 ms before gives), told over
measured and the part of it that is wrong, angular velocities counted with 0.2 m; the same of the joints. All medians.
Then the modes: a foot slips that moves with more than 0.05 m/s along the ground 5 ms after it landed, told and true
alike, and a standing foot has lifted that gets no impulse between 2 and 5 ms; it is told to lift where it rises faster
than gravity takes back in contact.time. One that rises with 0.01 m/s before the landing stands no more, and one that
has landed in the 10 ms before it, or lands in the 5 ms after it, takes part as it moves then. Beside them stands the
more frequent answer, always given, and how far the told slip is off: median and 90 %, in m/s.
"""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Sequence
from operator import itemgetter
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from impact_predictor.bags.read import Bag
from impact_predictor.errors import InputError
from impact_predictor.prediction.planar import hardly
from impact_predictor.prediction.scene import Robot, Scene, read_scenes, triple
from impact_predictor.prediction.types import Geometry, Joints, Sample, Touchdown
from impact_predictor.prediction.vectors import add, axes_of, cross, to_world
from impact_predictor.prediction.walking.articulated import ArticulatedMachine
from impact_predictor.prediction.walking.base import twist_of
from impact_predictor.prediction.walking.impact import LandingPoint, touchdown_of
from impact_predictor.report.table import Column, say, show, table_of
from impact_predictor.ros.messages import JOINT_STATE, ODOMETRY
from impact_predictor.ros.messages.inputs import decode_joints, decode_odometry
from impact_predictor.scenarios.truth import LANDING_TOPIC, TrueLanding, decode_truths

SLIPS: Final = 0.05
RISES: Final = 0.01
"""m/s: what is slower along the ground sticks, and what rises faster stands no more."""
SLOW: Final = 0.1
"""m/s: landings that are slower make no impact that forces would not hide."""
LEVER: Final = 0.2
SPAN: Final = 5_000_000
JUST: Final = 10_000_000
"""ns before a landing in which others are not over."""
WEIGHTS: Final = np.array([1.0, 1.0, 1.0, LEVER, LEVER, LEVER])
TRUTH: Final = "diagnostic_msgs/msg/DiagnosticArray"

Array = NDArray[np.float64]


class Case(NamedTuple):
    """A landing and the robot right before it; what the base and the joints did in the 5 ms before, and the rates of
    the base's twist; how many s later the other feet land that do so together with it, by their indices.
    """

    landing: TrueLanding
    base: Sample
    joints: Joints
    drift: Array
    joint_drift: Array
    rates: tuple[float, ...]
    others: dict[int, float]


class Judged(NamedTuple):
    """Told over measured impulses at each mark; of trunk and joints told over measured, and the part that is wrong;
    whether the landing foot's slip is right, and of each standing foot whether it lifts; what they truly do; and how
    far the slip is off, in m/s.
    """

    impulses: list[float]
    trunk: tuple[float, float]
    joints: tuple[float, float]
    slip: bool
    lifts: list[bool]
    slips: bool
    lifted: list[bool]
    off: float


def cases(bag_path: str) -> list[Case]:
    """The landings in a bag."""
    wanted = {"/odom": ODOMETRY, "/joint_states": JOINT_STATE, LANDING_TOPIC: TRUTH}
    bases, joints, landings = [], [], []
    with Bag(bag_path) as bag:
        for message in bag.messages(wanted):
            if message.topic == "/odom":
                bases.append(decode_odometry(message.data))
            elif message.topic == "/joint_states":
                joints.append(decode_joints(message.data))
            else:
                landings += decode_truths(TrueLanding, message.data)
    found = []
    for landing in landings:
        k = bisect_right(bases, landing.stamp, key=lambda sample: sample.stamp) - 1
        j = bisect_right(joints, landing.stamp, key=lambda one: one.stamp) - 1
        before = bisect_right(bases, landing.stamp - SPAN, key=lambda sample: sample.stamp) - 1
        if min(before, j - (k - before)) < 0 or landing.speed < SLOW:
            continue
        earlier = joints[j - (k - before)]
        ahead = 1e-9 * (landing.stamp - joints[j].stamp)
        rates = np.array(landing.before.rates)
        placed = np.array(joints[j].positions) + ahead * rates
        posture = joints[j]._replace(positions=tuple(placed.tolist()), velocities=landing.before.rates)
        base = bases[k]._replace(linear=triple(landing.before.twist[:3]), angular=triple(landing.before.twist[3:]))
        share = 1e-9 * SPAN / (1e-9 * (landing.stamp - bases[before].stamp))
        drift = share * (np.array(landing.before.twist) - [*bases[before].linear, *bases[before].angular])
        moved = share * (rates - np.array(earlier.velocities))
        gained = np.subtract(twist_of(base), twist_of(bases[before])) / (1e-9 * (landing.stamp - bases[before].stamp))
        ages = [(landing.feet.index(one.foot), one.stamp - landing.stamp) for one in landings if one is not landing]
        others = {i: 1e-9 * max(age, 0) for i, age in ages if -JUST <= age <= SPAN}
        found.append(Case(landing, base, posture, drift, moved, tuple(gained.tolist()), others))
    return found


def judge(scene: Scene, machine: ArticulatedMachine, case: Case, alone: bool = False) -> Judged | None:
    """What a machine tells of a landing, against the physics; a foot `alone` meets its own mass, and no friction."""
    landing, base = case.landing, case.base
    geometry, foot = machine.geometry_of(case.joints), landing.feet.index(landing.foot)
    assert isinstance(geometry, Geometry)
    axes, normal = axes_of(base.orientation), np.array(landing.normal)
    places = [add(base.position, to_world(axes, point)) for point in geometry.points]
    carried = [add(base.linear, cross(base.angular, point)) for point in geometry.points]
    moves = [to_world(axes, add(*both)) for both in zip(carried, geometry.velocities, strict=True)]
    each, heights, rises = len(places) // len(landing.feet), np.array(places) @ normal, np.array(moves) @ normal
    feet = [range(i * each, (i + 1) * each) for i in range(len(landing.feet))]
    others = {} if alone else case.others
    loaded = [i for name in landing.standing if not alone for i in feet[landing.feet.index(name)]]
    stood = tuple([i for i in loaded if rises[i] <= RISES and i // each not in others])
    lands: dict[int, LandingPoint] = {}
    for number, delay in {foot: 0.0, **others}.items():
        gaps = {i: float(heights[i] - heights[feet[number]].min()) for i in feet[number]}
        later = {i: delay + gap / max(-rises[i], SLOW) for i, gap in gaps.items()}
        lands |= {i: LandingPoint(moves[i], time) for i, time in later.items() if time <= scene.contact_time}
    new = tuple([i for i in lands if i // each == foot])
    scene = scene._replace(mass=machine.body.mass, normal=landing.normal, friction=0.0 if alone else scene.friction)
    told = touchdown_of(scene, machine, base, places, stood, new, lands, 0.0, case.rates)
    if not isinstance(told, Touchdown):
        return None
    own = [contact for contact in told.contacts if contact.point in new]
    pressed = sum(float(normal @ contact.impulse) for contact in own)
    impulses = [pressed / float(normal @ state.impulses[foot]) for state in landing.after]
    (_, second, last), peak = landing.after[:3], landing.after[-1]
    assert peak is not None
    change = np.concatenate([np.subtract(told.linear, base.linear), np.subtract(told.angular, base.angular)])
    true_change = np.subtract(last.twist, landing.before.twist) - case.drift
    order = [case.joints.names.index(name) for name in machine.joints]
    true_jumps = (np.subtract(last.rates, landing.before.rates) - case.joint_drift)[order]
    pushed = np.array(last.impulses) - np.array(second.impulses)
    told_slip, slip = (np.array(one) - (normal @ one) * normal for one in (own[0].velocity, last.velocities[foot]))
    holds = {c.point // each for c in told.contacts if float(normal @ c.velocity) <= hardly(scene)}
    standing = sorted({i // each for i in stood})
    slips, lifted = bool(np.linalg.norm(slip) > SLIPS), [not pushed[i].any() for i in standing]
    return Judged(
        impulses=impulses,
        trunk=compared(WEIGHTS * change, WEIGHTS * true_change),
        joints=compared(np.array(told.jumps), true_jumps),
        slip=bool(np.linalg.norm(told_slip) > SLIPS) is slips,
        lifts=[(i not in holds) is is_lifted for i, is_lifted in zip(standing, lifted, strict=True)],
        slips=slips,
        lifted=lifted,
        off=float(np.linalg.norm(told_slip - slip)),
    )


def compared(told: Array, true: Array) -> tuple[float, float]:
    """The size of what is told over that of what is true, and the part of the latter that is wrong."""
    size = float(np.linalg.norm(true))
    return float(np.linalg.norm(told)) / size, float(np.linalg.norm(told - true)) / size


def models(scene: Scene, robot: Robot) -> dict[str, tuple[ArticulatedMachine, bool]]:
    """The machines that are compared, and whether they meet the mass of their foot alone."""
    free = robot._replace(armature=(), drives="free", kp=(), kd=())
    rotors = free._replace(joints=robot.joints, armature=robot.armature)
    made = {"one rigid body": free._replace(drives="held"), "free joints": free, "armature": rotors, "scene": robot}
    assert scene.walking is not None
    radii = scene.walking.radius * (len(robot.frames) // max(len(scene.walking.radius), 1))
    machines = {name: (ArticulatedMachine(one, radii), False) for name, one in made.items()}
    return machines | {"foot's own mass": (machines["free joints"][0], True)}


def right(answers: Sequence[bool]) -> str:
    """How many answers are right, in %."""
    return f"{100.0 * np.mean(answers):.0f}" if answers else "-"


def most(answers: Sequence[bool]) -> str:
    """How often the more frequent answer is right, in %."""
    return right([one is (2 * sum(answers) > len(answers)) for one in answers])


def row(name: str, run: str, found: Sequence[Judged]) -> tuple[str, ...]:
    """The medians of what was judged, as texts."""

    def middle(numbers: Sequence[float]) -> str:
        return f"{np.median(numbers):.2f}"

    impulses = [middle([one.impulses[k] for one in found]) for k in range(4)]
    moved = [middle([getattr(one, of)[k] for one in found]) for of in ("trunk", "joints") for k in (0, 1)]
    modes = right([one.slip for one in found]), right([lift for one in found for lift in one.lifts])
    off = "{:.2f}, {:.2f}".format(*np.percentile([one.off for one in found], [50, 90]))
    return run, name, str(len(found)), *impulses, *moved, *modes, off


HEADERS: Final = (
    *("run", "told by", "landings", "impulse\nto 1 ms", "\n2 ms", "\n5 ms", "\npeak"),
    *("trunk\ntold", "\nwrong", "joints\ntold", "\nwrong", "slips\nright %", "lifts\nright %", "slip off\nm/s"),
)


def main(arguments: Sequence[str]) -> int:
    """Print the table."""
    if not arguments or len(arguments) % 2:
        raise InputError("give a bag of simulate robot and its scene, or several such pairs")
    rows = []
    for bag, file in zip(arguments[::2], arguments[1::2], strict=True):
        (scene,) = read_scenes(file).values()
        if scene.walking is None or scene.walking.robot is None:
            raise InputError(f"{file} has no robot.urdf: give a scene of `simulate robot --by-joints`")
        landings = cases(bag)
        judged = defaultdict(list)
        for name, (machine, alone) in models(scene, scene.walking.robot).items():
            judged[name] = [one for case in landings if (one := judge(scene, machine, case, alone))]
        rows += [row(name, Path(bag).stem, answers) for name, answers in judged.items()]
        found = judged["scene"]
        usual = most([one.slips for one in found]), most([is_lifted for one in found for is_lifted in one.lifted])
        rows.append((Path(bag).stem, "nothing", str(len(landings)), *["0.00"] * 5, "1.00", "0.00", "1.00", *usual, ""))
    columns = [Column(name, itemgetter(k), left=k < 2) for k, name in enumerate(HEADERS)]
    console = Console()
    show(console, table_of(columns, rows))
    say(console, "Impulses, trunk and joints: told over measured, and the part of the measured change that is wrong.")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except InputError as error:
        sys.exit(str(error))
