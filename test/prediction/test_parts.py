"""What a scene leaves out is not loaded, and what it has is: in a process of its own for each scene."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Collection
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from impact_predictor.parameters.file import read_values
from impact_predictor.parameters.types import values_of
from impact_predictor.parameters.validation import PARAMETERS, validate
from impact_predictor.prediction.parts import PARTS, Part, ladder, modules_of
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.report.parts.measure import measured
from impact_predictor.report.parts.record import OfSupport, made, points_of
from impact_predictor.report.parts.start import with_poses

PACKAGE = "impact_predictor"
ROOT = Path(__file__).parents[2]
SHIPPED = {path.stem: read_values(path) for path in sorted((ROOT / "config").glob("*.yaml"))}

CRATE = {
    "body.mass": 12.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.4,
    "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)],
}
DRUM = {
    **{name: value for name, value in CRATE.items() if name != "body.contact_points"},
    "body.radius": 0.3,
    "support.edges": [0.0, -0.2, 0.0, 0.0, 0.2, 0.0],
}
CARGO = {
    **CRATE,
    "support.motion": "odom",
    "onset.watch": True,
    "bodies": ["blind", "crate", "drum", "leaning", "walker"],
    "place.position": [0.0, 0.0, 0.2],
    "blind.source": "none",
    "crate.contact.friction": 0.3,
    "drum.body.radius": 0.3,
    "drum.support.edges": [0.0, -0.2, 0.0, 0.0, 0.2, 0.0],
    "leaning.source": "imu",
}
FEET: dict[str, Any] = {
    **{name: value for name, value in CRATE.items() if name != "body.contact_points"},
    "feet.names": ["left", "right"],
}
MADE: dict[str, Any] = {
    "crate": validate(CRATE),
    "frictionless": validate({**CRATE, "contact.friction": 0.0}),
    "total law": validate({**CRATE, "law": "total"}),
    "margins": validate({**CRATE, "margins": True, "transverse_slip": False}),
    "watched": validate({**CRATE, "onset.watch": True}),
    "deck": validate({**CRATE, "support.motion": "odom"}),
    "sensor on deck": validate({**CRATE, "support.motion": "imu", "onset.watch": True}),
    "waves": validate({**CRATE, "support.motion": "odom", "support.extrapolation": "harmonic"}),
    "drum": validate(DRUM),
    "drum on deck": validate({**DRUM, "support.motion": "odom", "onset.watch": True}),
    "cargo": validate(CARGO),
    "feet": validate(FEET),
    "soles": validate({**FEET, "feet.points": 2, "feet.force": 30.0, "feet.has_schedule": True}),
    "feet and crate": validate(
        {**CRATE, "transverse_slip": False, "bodies": ["walker", "box"], "walker.feet.names": ["only"]}
    ),
    "nothing": ladder(validate(CRATE))[0][1],
    "everything": ladder(validate(CRATE))[-1][1],
}
SCENES = {**SHIPPED, **MADE}

LEG = """<robot name="hopper"><link name="base">{inertial}</link><link name="leg">{inertial}</link><link name="foot"/>
<joint name="hip" type="revolute"><parent link="base"/><child link="leg"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="end" type="fixed"><parent link="leg"/><child link="foot"/><origin xyz="0 0 -0.8"/></joint></robot>"""
INERTIAL = '<inertial><mass value="5"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
MODEL = {**FEET, "feet.names": ["only"], "robot.urdf": "hopper.urdf", "robot.frames": ["foot"]}

EXTERNAL = {"matplotlib", "numba", "numpy", "rclpy", "rich", "rosbags", "ruamel", "scipy", "statistics"}

PREDICT = """
import pickle, sys
values, body, points, messages = pickle.load(sys.stdin.buffer)
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Geometry, Imu, Joints, Sample, Schedule, Wrench
scenes = scenes_of(values)
if scenes[body].points:
    scenes[body] = scenes[body]._replace(points=points)
monitor = Monitor(scenes)
touchdowns = 0
for of_support, message in messages:
    if of_support and monitor.deck is not None:
        (monitor.update_support if isinstance(message, Sample) else monitor.update_support_imu)(message)
    elif isinstance(message, Sample) and not of_support:
        touchdown = monitor.update(body, message).touchdown
        touchdowns += touchdown is not None
        if touchdown is not None and touchdown.planar is not None:
            touchdown.planar.margins
    elif isinstance(message, Geometry) and scenes[body].needs_geometry:
        monitor.set_geometry(body, message)
    elif isinstance(message, Joints) and scenes[body].walking.robot:
        monitor.set_joints(body, message)
    elif isinstance(message, Wrench) and scenes[body].walking.force:
        monitor.set_wrench(body, message)
    elif isinstance(message, Schedule) and scenes[body].walking.has_schedule:
        monitor.set_schedule(body, message)
    monitor.reports()
assert touchdowns > 10, touchdowns
print(*sys.modules)
"""


def loaded(code: str, *given: Any) -> set[str]:
    """The modules that a program has loaded at its end."""
    program = [sys.executable, "-c", code]
    done = subprocess.run(program, input=pickle.dumps(given), stdout=subprocess.PIPE, check=True, cwd=ROOT)
    return set(done.stdout.decode().split())


def of_rooms(modules: set[str]) -> set[str]:
    """The modules of the three rooms and the unit of their stamps, by their names in the package."""
    names = {name.removeprefix(f"{PACKAGE}.") for name in modules}
    return {name for name in names if name.split(".")[0] in ("mechanics", "prediction", "ros", "stamps")}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_a_predictor_loads_the_core_and_the_parts_of_its_scene_and_nothing_else(name: str) -> None:
    check_what_is_loaded(SCENES[name])


@pytest.mark.slow
@pytest.mark.extras
def test_a_machine_with_a_model_loads_its_mechanics_too(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    file = tmp_path / "hopper.urdf"
    file.write_text(LEG.format(inertial=INERTIAL))
    check_what_is_loaded(validate({**MODEL, "robot.urdf": str(file)}), {"pinocchio"})


def check_what_is_loaded(values: dict[str, Any], more: Collection[str] = ()) -> None:
    body, scene = measured(values)
    record = made(scene)
    messages = [
        (isinstance(one, OfSupport), one.message if isinstance(one, OfSupport) else one) for one in record.messages
    ]
    modules = loaded(PREDICT, values, body, record.points, messages)
    assert of_rooms(modules) == modules_of(values)
    on = {part.name for part in PARTS if part.on(values)}
    needed = {"numpy"} if on & {"onset watch", "harmonic extrapolation", "feet"} else set()
    if "uncertainty" in on:
        needed |= {"numpy", "statistics"} | ({"numba"} if find_spec("numba") else set())
        assert needed <= modules
    else:
        assert {*EXTERNAL, "pinocchio"} & modules == {*needed, *more}


def test_shipped_scenes_and_made_ones_have_and_leave_out_every_part() -> None:
    for part in PARTS:
        assert {part.on(values) for values in [*SCENES.values(), validate(MODEL)]} == {False, True}, part.name


OF_POINTS = {"geometry topic", "transverse slip"}
"""Parts that a cylinder on two edges cannot have."""
OF_FEET = {"force sensors", "schedule"}
"""Parts that only a machine that walks can have."""
SWITCHED = [part for part in PARTS if part.to_have]


def impossible(values: dict[str, Any]) -> set[str]:
    """The parts that cannot be switched in a scene."""
    if any(values_of(values, body)["feet.names"] for body in values["bodies"] or ("",)):
        return {part.name for part in SWITCHED if not part.with_feet}
    return OF_FEET | (OF_POINTS if values["body.radius"] else set())


@pytest.mark.parametrize("part", SWITCHED, ids=[part.name for part in SWITCHED])
@pytest.mark.parametrize("name", [name for name in SCENES if not SCENES[name]["bodies"]])
def test_a_part_is_switched_by_its_parameters_and_its_reason_names_one_of_them(name: str, part: Part) -> None:
    values = SCENES[name]
    if part.name in impossible(values):
        pytest.skip("such a body cannot have it, or cannot be without it")
    without = {**values, **part.to_leave_out}
    assert not part.on(without)
    needs = {"transverse slip": {"contact.friction": 0.3}, "harmonic extrapolation": {"support.motion": "odom"}}
    without = {**without, **needs.get(part.name, {})}
    assert part.on({**without, **part.to_have})
    for case in (values, without, {**without, **part.to_have}):
        why = part.why(case)
        named = (*part.to_have, *part.to_leave_out, "contact_geometry", "contact.friction", "law", "support.motion")
        assert any(name in why for name in named), why


def test_parts_are_switched_by_parameters_that_exist() -> None:
    assert {name for part in PARTS for name in (*part.to_have, *part.to_leave_out)} <= set(PARAMETERS)
    for values in SCENES.values():
        for part, step in ladder(values):
            # A node that leaves out the watch has nothing to do for a body of which nothing is measured.
            given = {name: value for name, value in with_poses(step).items() if value != ()}
            assert validate(given) == with_poses(step), part


@pytest.mark.parametrize("name", SCENES)
def test_the_ladder_leads_from_nothing_over_the_scene_to_everything(name: str) -> None:
    values = SCENES[name]
    steps = ladder(values)
    assert [part for part, _ in steps[:1]] == [None]
    on = [{part.name for part in PARTS if part.on(step)} for _, step in steps]
    own = {part.name for part in PARTS if part.on(values)}
    fixed = impossible(values)
    kept = {part.name for part in PARTS if (not part.to_have or part.name in fixed) and part.on(values)}
    assert on[0] == kept
    assert on[-1] - kept == {part.name for part, _ in steps if part is not None}
    assert {part.name for part in SWITCHED} - on[-1] == fixed - kept
    for (part, _), (before, after) in zip(steps[1:], pairwise(on), strict=True):
        assert part is not None
        assert before < after
        assert after - before == {part.name}
    place = len(own - kept)
    assert on[place] == own
    # What makes no difference then may differ: other points, and a switch of what is off for another reason too.
    free = {"points": (), "transverse_slip": False, "friction_deviation": 0.0, "restitution_deviation": 0.0}

    def same(scene: Scene) -> Scene:
        deck = scene.deck and scene.deck._replace(harmonic_window=0.0)
        return scene._replace(**free, deck=deck)

    wanted = {body: same(scene) for body, scene in scenes_of(values).items()}
    assert {body: same(scene) for body, scene in scenes_of(steps[place][1]).items()} == wanted


def test_a_reason_tells_for_how_many_bodies_it_holds() -> None:
    parts = {part.name: part for part in PARTS}
    cargo = SCENES["cargo"]
    assert parts["tilt"].why(cargo).endswith("nothing its place (for 1 of 5 bodies)")
    assert parts["onset watch"].why(cargo).endswith("with levels")
    assert "bodies has 5 names" in parts["several bodies"].why(cargo)


def test_where_points_come_with_a_topic_a_made_record_has_those_of_the_cube_of_the_inertia() -> None:
    scene = Scene(6.0, ((4.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 4.0)), 0.3, center_of_mass=(1.0, 2.0, 3.0))
    points = points_of(scene)
    assert len(points) == 8
    assert {abs(x - 1.0) for x, _, _ in points} == {1.0}  # (2/3) m h^2 = 4
