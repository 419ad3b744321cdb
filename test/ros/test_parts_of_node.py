"""What a scene leaves out is neither loaded by the node nor subscribed to, and what it has is."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from impact_predictor.parameters.file import read_values
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.inputs import inputs_of
from impact_predictor.prediction.parts import ladder, modules_of
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Geometry, Joints, Sample, Schedule, Wrench
from impact_predictor.report.parts.measure import measured
from impact_predictor.report.parts.record import made
from impact_predictor.report.parts.start import arguments_of
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    IMU,
    JOINT_STATE,
    JOINT_TRAJECTORY,
    ODOMETRY,
    POLYGON,
    WRENCH,
    encode_imu,
    encode_joints,
    encode_odometry,
    encode_polygon,
    encode_schedule,
    encode_wrench,
)

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

ROOT = Path(__file__).parents[2]
BOX = {
    "body.mass": 12.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.4,
    "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)],
}
SOLES = {
    **{name: value for name, value in BOX.items() if name != "body.contact_points"},
    "feet.names": ["left", "right"],
    "feet.points": 2,
    "feet.force": 30.0,
    "feet.has_schedule": True,
}
SCENES: dict[str, Any] = {
    **{path.stem: read_values(path) for path in sorted((ROOT / "config").glob("*.yaml"))},
    "nothing": ladder(validate(BOX))[0][1],
    "everything": ladder(validate(BOX))[-1][1],
    "events": validate({**BOX, "executor": "events"}),
    "soles": validate(SOLES),
}

SERVE = Path(__file__).with_name("serve.py")


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_the_node_loads_the_core_and_the_parts_of_its_scene_and_nothing_else(name: str) -> None:
    values = SCENES[name]
    body, scene = measured(values)
    prefix = f"/{body}/" if body else "/"
    record = made(scene)
    messages: list[tuple[str, str, bytes]] = []
    for message in record.messages[:300]:
        if isinstance(message, Geometry):
            messages.append((f"{prefix}contact_geometry", POLYGON, encode_polygon(message)))
        elif isinstance(message, Sample):
            messages.append((f"{prefix}odom", ODOMETRY, encode_odometry(message)))
        elif isinstance(message, Joints):
            messages.append((f"{prefix}joint_states", JOINT_STATE, encode_joints(message)))
        elif isinstance(message, Wrench):
            messages.append((f"{prefix}contact_wrench", WRENCH, encode_wrench(message)))
        elif isinstance(message, Schedule):
            messages.append((f"{prefix}schedule", JOINT_TRAJECTORY, encode_schedule(message)))
        elif isinstance(message.message, Sample):
            messages.append(("/support/odom", ODOMETRY, encode_odometry(message.message)))
        else:
            messages.append(("/support/imu", IMU, encode_imu(message.message)))
    outputs = {f"/impact_predictor{prefix}prediction": DIAGNOSTIC_ARRAY, "/diagnostics": DIAGNOSTIC_ARRAY}
    done = subprocess.run(
        [sys.executable, str(SERVE), *arguments_of(values)],
        input=pickle.dumps((messages, outputs)),
        capture_output=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        timeout=90.0,  # numba may have to compile
    )
    assert done.returncode == 0, done.stderr.decode()
    _, topics, loaded = pickle.loads(done.stdout)
    modules = {name.removeprefix("impact_predictor.") for name in loaded}
    rooms = {name for name in modules if name.split(".")[0] in ("mechanics", "prediction", "ros", "stamps")}
    assert rooms == modules_of(values, node=True)
    unwanted = {"click", "matplotlib", "rich", "rosbags", "ruamel", "scipy", "statistics"}
    assert not (unwanted if not values["uncertainty.samples"] else unwanted - {"statistics", "scipy"}) & modules
    assert ("numba" in modules) <= bool(values["uncertainty.samples"])
    assert topics - {"/parameter_events"} == {f"/{one.name}" for one in inputs_of(scenes_of(values))}
