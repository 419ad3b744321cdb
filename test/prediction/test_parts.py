"""What a scene leaves out is not loaded, and what it has is: in a process of its own for each scene."""

from __future__ import annotations

import pickle
import subprocess
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from impact_predictor.parameter_file import read_values
from impact_predictor.parameters import PARAMETERS, validate
from impact_predictor.prediction.parts import PARTS, Part, ladder, modules_of
from impact_predictor.prediction.scene import Scene
from impact_predictor.report.parts.record import made, points_of

PACKAGE = "impact_predictor"
ROOT = Path(__file__).parents[2]
SHIPPED = {path.stem: read_values(path) for path in sorted((ROOT / "config").glob("*.yaml"))}

CRATE = {
    "body.mass": 12.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.4,
    "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)],
}
MADE: dict[str, Any] = {
    "crate": validate(CRATE),
    "frictionless": validate({**CRATE, "contact.friction": 0.0}),
    "total law": validate({**CRATE, "law": "total"}),
    "margins": validate({**CRATE, "margins": True, "transverse_slip": False}),
    "nothing": ladder(validate(CRATE))[0][1],
    "everything": ladder(validate(CRATE))[-1][1],
}
SCENES = {**SHIPPED, **MADE}

EXTERNAL = {"matplotlib", "numba", "numpy", "rclpy", "rich", "rosbags", "ruamel", "scipy", "statistics"}

PREDICT = """
import pickle, sys
values, points, messages = pickle.load(sys.stdin.buffer)
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample
scene = Scene.from_parameters(values)
predictor = Predictor(scene._replace(points=points) if scene.points else scene)
touchdowns = 0
for message in messages:
    if isinstance(message, Sample):
        touchdown = predictor.update(message).touchdown
        touchdowns += touchdown is not None
        if touchdown is not None and touchdown.planar is not None:
            touchdown.planar.margins
    else:
        predictor.set_geometry(message)
assert touchdowns > 10, touchdowns
print(*sys.modules)
"""


def loaded(code: str, *given: Any) -> set[str]:
    """The modules that a program has loaded at its end."""
    program = [sys.executable, "-c", code]
    done = subprocess.run(program, input=pickle.dumps(given), stdout=subprocess.PIPE, check=True, cwd=ROOT)
    return set(done.stdout.decode().split())


def of_rooms(modules: set[str]) -> set[str]:
    """The modules of the three rooms, by their names in the package."""
    names = {name.removeprefix(f"{PACKAGE}.") for name in modules}
    return {name for name in names if name.split(".")[0] in ("mechanics", "prediction", "ros")}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_a_predictor_loads_the_core_and_the_parts_of_its_scene_and_nothing_else(name: str) -> None:
    values = SCENES[name]
    record = made(Scene.from_parameters(values))
    modules = loaded(PREDICT, values, record.points, record.messages)
    assert of_rooms(modules) == modules_of(values)
    needed = {"numpy", "statistics"} | ({"numba"} if find_spec("numba") else set())
    if values["uncertainty.samples"]:
        assert needed <= modules
    else:
        assert not EXTERNAL & modules


def test_shipped_scenes_and_made_ones_have_and_leave_out_every_part() -> None:
    for part in PARTS:
        assert {part.on(values) for values in SCENES.values()} == {False, True}, part.name


@pytest.mark.parametrize("part", PARTS, ids=[part.name for part in PARTS])
@pytest.mark.parametrize("name", SCENES)
def test_a_part_is_switched_by_its_parameters_and_its_reason_names_one_of_them(name: str, part: Part) -> None:
    values = SCENES[name]
    without = {**values, **part.to_leave_out}
    assert not part.on(without)
    with_friction = {**without, "contact.friction": 0.3} if part.name == "transverse slip" else without
    assert part.on({**with_friction, **part.to_have})
    for case in (values, without, {**with_friction, **part.to_have}):
        why = part.why(case)
        named = (*part.to_have, *part.to_leave_out, "contact_geometry", "contact.friction", "law")
        assert any(name in why for name in named), why


def test_parts_are_switched_by_parameters_that_exist() -> None:
    assert {name for part in PARTS for name in (*part.to_have, *part.to_leave_out)} <= set(PARAMETERS)
    for values in SCENES.values():
        for part, step in ladder(values):
            given = {name: value for name, value in step.items() if value != ()}
            assert validate(given) == step, part


@pytest.mark.parametrize("name", SCENES)
def test_the_ladder_leads_from_nothing_over_the_scene_to_everything(name: str) -> None:
    values = SCENES[name]
    steps = ladder(values)
    assert [part for part, _ in steps[:1]] == [None]
    on = [{part.name for part in PARTS if part.on(step)} for _, step in steps]
    assert on[0] == set()
    assert on[-1] == {part.name for part in PARTS}
    for (part, _), (before, after) in zip(steps[1:], pairwise(on), strict=True):
        assert part is not None
        assert before < after
        assert after - before == {part.name}
    own = {part.name for part in PARTS if part.on(values)}
    scene = Scene.from_parameters(steps[len(own)][1])
    assert on[len(own)] == own
    # What makes no difference then may differ: other points, and a switch of what is off for another reason too.
    free = {"points": (), "transverse_slip": False, "friction_deviation": 0.0, "restitution_deviation": 0.0}
    assert scene._replace(**free) == Scene.from_parameters(values)._replace(**free)


def test_where_points_come_with_a_topic_a_made_record_has_those_of_the_cube_of_the_inertia() -> None:
    scene = Scene(6.0, ((4.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 4.0)), 0.3, center_of_mass=(1.0, 2.0, 3.0))
    points = points_of(scene)
    assert len(points) == 8
    assert {abs(x - 1.0) for x, _, _ in points} == {1.0}  # (2/3) m h^2 = 4
