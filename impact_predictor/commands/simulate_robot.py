"""`impact-predictor simulate robot`: a robot of a URDF that walks in MuJoCo, as a table or a bag."""

from __future__ import annotations

import json
from math import inf, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from .options import (
    ACUTE,
    FINITE,
    FROM_0,
    POSITIVE,
    examples,
    json_flag,
    number,
    refuse_given,
    seed_option,
    text,
    within,
)
from .progress import progress
from .simulated import bag_option

if TYPE_CHECKING:
    from ..scenarios.robot.description import RobotFiles, Sole
    from ..scenarios.robot.ground import SimulatedGround

NAMES: Final = ("a1", "anymal", "bolt", "go1", "hyq", "solo12", "talos")
GAITS: Final = ("trot", "amble", "step")
DURATION: Final = 12.0
BIPED: Final = 2
SENSED: Final = ("rate", "noise_position", "noise_velocity", "delay", "drift", "seed", "by_names")
"""What `WalkSensors` take."""
OF_BAG: Final = (*SENSED[:5], "params_out", "by_joints", "by_names", "terrain")
RATE: Final = within(lambda value: 0.0 < value <= 4000.0, "a number above 0, up to 4000")
"""Hz: the physics makes no more steps."""

EXAMPLES: Final = (
    "impact-predictor simulate robot -o trot.mcap",
    "impact-predictor simulate robot solo12 --blocks 0.005 --rate 1000 -o blocks.mcap",
    "impact-predictor simulate robot talos --strike 0.3 --json",
    "impact-predictor simulate robot --noise-position 0.001 --noise-velocity 0.02 --delay 0.005 -o noisy.mcap",
    "impact-predictor simulate robot --urdf dog.urdf --feet LF,RF,LH,RH --radius 0.02 -o dog.mcap",
)


@click.command("robot", short_help="A robot of a URDF that walks in MuJoCo.", epilog=examples(*EXAMPLES))
@click.argument("name", required=False, type=click.Choice(NAMES), metavar="[NAME]")
@text("--urdf", "FILE", "URDF of another robot.")
@text("--feet", "LINKS", "Links of its feet, left and right ones in turn, front ones first: LF,RF,LH,RH.")
@text("--srdf", "FILE", "Its postures; its legs are bent as their limits allow unless given.")
@number("--radius", "Radius of its feet, m: balls about the links' origins (those of the URDF unless given).", **FROM_0)
@text("--sole", "X,X,Y", "Flat soles in its place, m: where heel and toe are along their links' x axes, and the width.")
@click.option(
    "--gait", type=click.Choice(GAITS), help="Which feet swing together. [default: trot on four feet, step on two]"
)
@number("--swing", "Duration of a swing, s.", 0.2, **POSITIVE)
@number("--strike", "Speed with which a swing is planned to end on the ground, m/s; 0 brakes to rest.", 0.6, **FROM_0)
@number("--speed", "Planned speed ahead, m/s (that of a robot of its size unless given).", **FROM_0)
@number("--clearance", "How high feet swing, m (that of a robot of its size unless given).", **FROM_0)
@number("--slope", "Slope of the ground, degrees; positive is uphill.", 0.0, **ACUTE)
@number("--blocks", "Height of blocks on half of the ground, m.", 0.0, **FROM_0)
@number("--stairs", "Rise of stairs ahead, m; negative go down.", 0.0, **FINITE)
@number(
    "--gantry",
    "Springs that hold the trunk of a robot on two feet upright, weight times height to a rad.",
    1.0,
    **FROM_0,
)
@number(
    "--armature", "Inertia of each drive at its joint, kg m^2 (that of a robot of its size unless given).", **FROM_0
)
@number("--friction", "Coulomb friction coefficient of the feet.", 0.8, **FROM_0)
@number("--contact-time", "Time constant with which a contact stops a foot, s: less is stiffer.", 0.002, **POSITIVE)
@number("--duration", "Seconds to simulate.", DURATION, **POSITIVE)
@number("--rate", "Samples of the bag for each second.", 400.0, **RATE)
@number("--noise-position", "Standard deviation of positions, m.", 0.0, **FROM_0)
@number("--noise-velocity", "Standard deviation of velocities, m/s.", 0.0, **FROM_0)
@number("--delay", "By how much feet, joints and forces are told late, s.", 0.0, **FINITE)
@number("--drift", "Drift of the told height, m/s.", 0.0, **FINITE)
@seed_option("Makes blocks and noise.")
@json_flag()
@bag_option("the true landings")
@text("--params-out", "FILE", "The scene for a replay. [default: the name of the bag, with .yaml]")
@click.option("--by-joints", is_flag=True, help="The scene takes feet and inertia from URDF and joints.")
@click.option("--by-names", is_flag=True, help="Tell feet by their names, with velocities and forces.")
@click.option("--terrain", is_flag=True, help="The scene takes the heights of blocks or stairs from a map.")
def simulate_robot(
    gait: str | None,
    duration: float,
    gantry: float,
    as_json: bool,
    output: str | None,
    params_out: str | None,
    by_joints: bool,
    terrain: bool,
    **options: Any,
) -> int:
    """A robot that walks with drives which follow a gait, whatever happens: a1, anymal, bolt, go1 (unless named), hyq,
    solo12 or talos, or that of a URDF.

    Those on two feet hang on a gantry, springs that hold the trunk upright: nothing balances them.
    The same options and seed make the same bytes.
    """
    scene = None if output is None else Path(params_out or Path(output).with_suffix(".yaml"))
    if scene is None:
        refuse_given(OF_BAG, "is that of a bag: give -o BAG too")
    else:
        from ..scenarios.robot.scene import check_replaceable

        check_replaceable(scene)
    if terrain and not (options["blocks"] or options["stairs"]):
        raise click.UsageError("--terrain is that of --blocks or --stairs: give one of them too")
    from ..files import write_text
    from ..scenarios.as_json import walk_as_json
    from ..scenarios.record import write_messages
    from ..scenarios.robot.gait import PlannedGait
    from ..scenarios.robot.machine import Machine, Physics
    from ..scenarios.robot.scene import scene_of
    from ..scenarios.robot.sensors import WalkSensors, walk_messages
    from ..scenarios.robot.walk import landings_of, walk

    ground = ground_of(*[options[one] for one in ("seed", "slope", "blocks", "stairs")])
    robot = robot_of(*[options[one] for one in ("name", "urdf", "feet", "srdf", "radius", "sole")])
    machine = Machine(robot, ground, Physics(*[options[one] for one in Physics._fields]))
    is_biped = len(machine.feet) == BIPED
    told = PlannedGait(gait or ("step" if is_biped else "trot"), *[options[one] for one in PlannedGait._fields[1:]])
    sensors = WalkSensors(*[options[one] for one in SENSED])
    with progress("simulated robot", "s", round(duration)) as tell:
        walked = walk(machine, ground, told, duration, gantry if is_biped else 0.0, tell)
    landings = landings_of(walked)
    if output is not None and scene is not None:
        write_messages(output, walk_messages(walked, landings, sensors))
        write_text(scene, scene_of(walked, by_joints=by_joints, on_terrain=terrain))
    if as_json:
        click.echo(json.dumps(walk_as_json(walked, landings), allow_nan=False))
    else:
        from rich.console import Console

        from ..report.simulation import print_walk

        print_walk(Console(), walked, landings)
        if output is not None:
            click.echo(f"Bag: {output}\nScene: {scene}")
    return 1 if walked.fallen else 0


def robot_of(
    name: str | None, urdf: str | None, feet: str | None, srdf: str | None, radius: float | None, sole: str | None
) -> RobotFiles:
    from ..scenarios.robot.description import RobotFiles, Sole, robot_named

    if urdf is None:
        if (feet, srdf, radius, sole) != (None, None, None, None):
            raise click.UsageError("--feet, --srdf, --radius and --sole are those of a robot by --urdf")
        return robot_named(name or NAMES[3])
    if name is not None or feet is None:
        raise click.UsageError("--urdf takes the place of a name, and needs --feet")
    ball = None if radius is None else Sole(radius=radius)
    return RobotFiles(
        urdf=Path(urdf),
        feet=tuple(feet.split(",")),
        srdf=None if srdf is None else Path(srdf),
        sole=ball if sole is None else flat(sole),
    )


def flat(sole: str) -> Sole:
    """A sole from --sole."""
    from ..scenarios.robot.description import Sole

    try:
        heel, toe, width = map(float, sole.split(","))
    except ValueError:
        heel, toe, width = 0.0, 0.0, 0.0
    if not (heel < toe < inf and 0.0 < width < inf):
        raise click.UsageError(f"--sole is {sole}: give heel, toe and width in m, as in -0.1,0.1,0.12")
    return Sole(heel=heel, toe=toe, width=width)


def ground_of(seed: int, slope: float, blocks: float, stairs: float) -> SimulatedGround:
    from ..scenarios.robot import ground

    if sum(value != 0.0 for value in (slope, blocks, stairs)) > 1:
        raise click.UsageError("--slope, --blocks and --stairs are three grounds; give one of them")
    if blocks:
        return ground.blocks(blocks, seed)
    return ground.stairs(stairs) if stairs else ground.SimulatedGround(radians(slope))
