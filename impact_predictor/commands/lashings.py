"""`impact-predictor lashings`: the balance of forces of the units of a scene after Annex 13 of the CSS Code."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from ..errors import InputError
from ..mechanics.annex13 import LONGITUDINAL, METHODS
from ..prediction.scene import read_scenes
from .options import choice, examples, json_flag, number, remap_option, text

if TYPE_CHECKING:
    from ..mechanics.annex13 import LashedUnit
    from ..prediction.scene import Scene
    from ..prediction.types import Vector3


@click.command(
    short_help="Balance the forces on lashed units after the CSS Code, Annex 13.",
    epilog=examples(
        "impact-predictor lashings config/deck_lashed.yaml --vessel 120 20 1.4 15 --position 0.7 --deck low",
        "impact-predictor lashings scene.yaml --vessel 160 24 1.5 18 --position 0.5 --deck tween --method alternative",
        "impact-predictor lashings scene.yaml --vessel 120 20 1.4 15 --position 0.7 --deck high --bag voyage.mcap",
    ),
)
@click.argument("params", metavar="PARAMS.yaml")
@click.option(
    "--vessel",
    nargs=4,
    type=float,
    required=True,
    metavar="LENGTH BREADTH GM SPEED",
    help="Four numbers: length, breadth and metacentric height GM in m, service speed in knots.",
)
@number("--position", "Where the units are stowed: part of the vessel's length, from 0 aft to 1.", required=True)
@choice("--deck", "Where: on deck, high or low, in the 'tween deck or in the lower hold.", *LONGITUDINAL, default="low")
@choice("--method", "The method of 7.2 (advanced) or of 7.3 (alternative).", *METHODS, default="advanced")
@click.option(
    "--spray",
    nargs=2,
    type=float,
    default=(0.0, 0.0),
    metavar="ALONG ACROSS",
    help="Two areas in m^2: in the spray along and across the vessel.",
)
@text("--bag", "BAG", "Show the largest accelerations that the deck of this bag gave the units beside the Annex's.")
@remap_option("Topic of an input of the bag, as for replay; may be repeated.")
@json_flag()
def lashings(
    params: str,
    vessel: tuple[float, float, float, float],
    position: float,
    deck: str,
    method: str,
    spray: tuple[float, float],
    bag: str | None,
    remap: tuple[str, ...],
    as_json: bool,
) -> None:
    """Balance the forces on the units of a scene after the CSS Code, Annex 13 (MSC.1/Circ.1623).

    PARAMS.yaml is the ROS 2 parameter file of the scene, whose deck has x forward and z up. Each unit stands at its
    place, with its contact points, mass, friction, lashings, chocks, and the area that the wind meets.
    """
    from ..mechanics.annex13 import VesselData, balances, design_accelerations, external_forces
    from ..report.lashings import fields, print_unit

    scenes = {name: scene for name, scene in read_scenes(params).items() if scene.points}
    if not scenes:
        raise InputError(f"{params} has no unit with contact points: give body.contact_points")
    if min(spray) < 0.0:
        raise InputError("--spray is areas of 0 or more")
    accelerations = design_accelerations(VesselData(*vessel), position, deck)
    measured = {} if bag is None else largest_felt(bag, scenes, remap)
    answer: dict[str, Any] = {}
    for name, scene in scenes.items():
        unit = unit_of(scene, spray, on_deck=deck in ("high", "low"))
        forces = external_forces(unit, accelerations)
        found = balances(unit, forces, method)
        if as_json:
            answer[name or "body"] = fields(unit, accelerations, measured.get(name), forces, found)
        else:
            print_unit(name or "body", unit, accelerations, measured.get(name), found)
    if as_json:
        click.echo(json.dumps({"method": method, "units": answer}, allow_nan=False))


def unit_of(scene: Scene, spray: tuple[float, float], *, on_deck: bool) -> LashedUnit:
    """A unit as the Annex sees it, where its scene places it; wind and spray act on deck alone."""
    from ..mechanics.annex13 import Device, LashedUnit
    from ..prediction.watch.stance import holders_of, placed, wind_load

    pose = placed(scene)
    xs, ys, _ = zip(*[pose.place(point) for point in scene.points], strict=True)
    wind, load = (0.0, 0.0), wind_load(scene, pose)
    if scene.wind is not None and load is not None and on_deck:
        along, across = load.along((1.0, 0.0, 0.0)), load.along((0.0, 1.0, 0.0))
        wind = along / scene.wind.pressure, across / scene.wind.pressure
    return LashedUnit(
        mass=scene.mass,
        friction=scene.friction,
        center=pose.place(scene.center_of_mass),
        footprint=(min(xs), max(xs), min(ys), max(ys)),
        deck=scene.height,
        devices=tuple([Device(one.point, one.direction, one.strength) for one in holders_of(scene, pose)]),
        wind=wind,
        spray=spray if on_deck else (0.0, 0.0),
    )


def largest_felt(bag: str, scenes: dict[str, Scene], remap: tuple[str, ...]) -> dict[str, Vector3]:
    """The largest accelerations (m/s^2) along, across and beyond gravity that the deck of a bag gave each unit;
    InputError where the bag cannot be used, or the support does not move.
    """
    from ..bags.replay import remapping
    from ..prediction.felt import FeltMonitor
    from .calibrate import read_all

    # Of the bag the deck alone counts: the units stand where they are placed, and nobody watches them.
    alone = {name: scene._replace(source="none", watching=None) for name, scene in scenes.items()}
    (monitor,), _ = read_all((bag,), alone, remapping(remap), FeltMonitor)
    if not monitor.largest:
        raise InputError(f"{bag} tells no motion of a deck: the scene needs support.motion, the bag its messages")
    return monitor.largest
