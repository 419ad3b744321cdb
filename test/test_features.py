"""What a scene leaves out is told, and neither loaded nor subscribed to: in the node and in a replay."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from fuzz_messages import encode, made_course

from impact_predictor.bags.write import BagWriter
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import PARAMETERS, validate
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import features_of, scenes_of
from impact_predictor.ros.messages import INPUT_TYPES, OUTPUTS
from impact_predictor.stamps import NANOSECONDS

ROOT = Path(__file__).parents[1]
SHIPPED = {path.stem: dict(read_parameters(path)) for path in sorted((ROOT / "config").glob("*.yaml"))}
BODY: dict[str, Any] = {"body.mass": 12.0, "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0], "contact.friction": 0.0}
CRATE = {**BODY, "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)]}
CYLINDER = {**BODY, "body.radius": 0.3, "support.edges": [0.0, -0.2, 0.0, 0.0, 0.2, 0.0]}
WALKER = {**BODY, "feet.names": ["left", "right"]}
DECK = {**CRATE, "support.motion": "odom"}
WATCHED = {**DECK, "onset.watch": True, "place.position": [0.0, 0.0, 0.2]}
LASHED = {"lashings.points": [0.3, 0.0, 0.1], "lashings.anchors": [1.0, 0.0, 0.0], "lashings.msl": [100.0]}
SURE = {"uncertainty.samples": 16, "uncertainty.friction": 0.02}
WITHOUT_AND_WITH: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "friction": (CRATE, {**CRATE, "contact.friction": 0.4}),
    "restitution": (CRATE, {**CRATE, "contact.restitution": 0.3}),
    "twist window": (CRATE, {**CRATE, "odom.twist_window": 0.01}),
    "geometry topic": (CRATE, BODY),
    "moving support": (CRATE, DECK),
    "onset watch": (CRATE, {**CRATE, "onset.watch": True}),
    "lashings": (WATCHED, {**WATCHED, **LASHED}),
    "chocks": (WATCHED, {**WATCHED, "chocks.points": [0.3, 0.0, 0.0], "chocks.normals": [-1.0, 0.0, 0.0]}),
    "wind": (WATCHED, {**WATCHED, "wind.pressure": 100.0, "wind.area": [0.2, 0.3]}),
    "friction band": (WATCHED, {**WATCHED, "contact.friction_band": [0.0, 0.3]}),
    "cylinder": (CRATE, CYLINDER),
    "three dimensions": (CYLINDER, CRATE),
    "tilt": (WATCHED, {**WATCHED, "source": "imu"}),
    "feet": (BODY, WALKER),
    "force sensors": (WALKER, {**WALKER, "feet.force": 30.0}),
    "schedule": (WALKER, {**WALKER, "feet.has_schedule": True}),
    "terrain": (WALKER, {**WALKER, "feet.terrain": 0.02}),
    "friction of feet": (WALKER, {**WALKER, "feet.friction": [0.5, 0.6]}),
    "radius of feet": (WALKER, {**WALKER, "feet.radius": [0.02]}),
    "restitution of feet": (WALKER, {**WALKER, "feet.restitution": [0.1]}),
    "transforms": (CRATE, {**CRATE, "tf.body_frame": "crate"}),
    "margins": (CRATE, {**CRATE, "margins": True}),
    "uncertainty": (CRATE, {**CRATE, **SURE}),
    "several bodies": (CRATE, {**CRATE, "bodies": ["crate"]}),
    "events executor": (CRATE, {**CRATE, "executor": "events"}),
}
"""For each feature parameters of a scene that leaves it out, and of one that is the same but for the feature."""

HEAVY = {"matplotlib", "numba", "pinocchio", "plotly", "rich", "scipy"}
"""Packages whose import takes long, and that a running predictor needs for some features at most."""
LONGEST = 2 * NANOSECONDS
"""Stamps of the last messages: some falls, after a support has been watched for a while."""
NEEDED = {
    "numba": {"uncertainty", "three dimensions"},
    "scipy": {"uncertainty", "three dimensions"},
    "pinocchio": {"articulated inertia"},
}
"""... and the features of which one needs them."""

PROBE = """
import os, pickle, sys
from importlib import import_module
from importlib.machinery import ModuleSpec
in_node, heavy = sys.argv[1] == "node", sys.argv[2:]

class Imported:
    def __init__(self):
        # But for what numba pickles with: it is asked for by its name in what it pickles.
        taken = [one for one in sys.modules if one.partition(".")[0] in heavy and "cloudpickle" not in one]
        self.modules = {name: sys.modules.pop(name) for name in taken}

    def find_spec(self, name, path, target=None):
        return ModuleSpec(name, self) if name in self.modules else None

    def create_module(self, spec):
        return self.modules[spec.name]

    def exec_module(self, module):
        pass

# Once for all of them: in each it counts only whether they are asked for.
import inspect, rosbags.highlevel, rosbags.typesys.stores.ros2_jazzy, scipy.optimize, scipy.special
cases, types = pickle.load(sys.stdin.buffer)
if in_node:
    import rclpy.executors, rclpy.node, rclpy.qos_overriding_options
    from rclpy.type_support import check_for_type_support
    for package, kind in types:
        check_for_type_support(getattr(import_module(package + ".msg"), kind))
try:
    import numba.core.event
    numba.njit(lambda value: value)(1.0)
except ImportError:
    pass
inspect.getframeinfo(inspect.currentframe())  # as the first line of a log looks for the place of its caller
sys.meta_path.insert(0, Imported())

def serve(arguments, messages):
    rclpy.init(args=arguments)
    import impact_predictor.ros.node
    from impact_predictor.ros import endpoints
    endpoints.Outlet.listeners = property(lambda self: lambda: 1, lambda self, listeners: None)
    from impact_predictor.ros.predictor_node import PredictorNode
    from impact_predictor.ros.process import executor_of
    node = PredictorNode()
    executor_of(node, node.executor_kind)
    callbacks = {one.topic_name: one.callback for one in node.subscriptions}
    for topic, data in messages:
        callbacks[topic](data)
    return set(callbacks) - {"/parameter_events"}

def play(values, bag):
    from impact_predictor.bags.replay import replay
    from impact_predictor.prediction.scene import scenes_of
    replay(bag, scenes_of(values), output=bag + ".out.mcap")
    return set()

for case in cases:
    read, write = os.pipe()
    if os.fork() == 0:
        sys.stdout = sys.stderr
        before = set(sys.modules)
        topics = serve(*case) if in_node else play(*case)
        os.write(write, pickle.dumps((set(sys.modules) - before, topics)))
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as answer:
        sys.stdout.buffer.write(answer.read())
    assert os.wait()[1] == 0
"""


class Loaded(NamedTuple):
    """What a scene brings: modules of the package, other packages, and topics by their last names."""

    modules: set[str]
    packages: set[str]
    topics: set[str]


def loaded(where: str, scenes: list[dict[str, Any]], folder: Path) -> list[Loaded]:
    """What each scene brings, in the node or in a replay, while messages are answered."""
    cases: list[tuple[Any, Any]] = []
    for number, values in enumerate(scenes):
        course = made_course(str(number), values)
        messages = [
            (f"/{one.name}", one.kind, value.stamp, encode(value))
            for one, value in course.messages
            if value.stamp < LONGEST
        ]
        if where == "node":
            given = [f"{name}:={json.dumps(value)}" for name, value in values.items()]
            arguments = ["--ros-args", *(word for one in given for word in ("-p", one))]
            cases.append((arguments, [(topic, data) for topic, _, _, data in messages]))
        else:
            bag = folder / f"{number}.mcap"
            with BagWriter(bag) as writer:
                for topic, kind, stamp, data in messages:
                    writer.write(topic, INPUT_TYPES[kind].name, stamp, data)
            cases.append((validate(values), str(bag)))
    # What is compiled here is kept: the probe cannot keep it, for its modules are not those that they seem.
    for values in scenes:
        Monitor(scenes_of(validate(values)))
    names = [*(one.name for one in INPUT_TYPES.values()), *(one.type_name for one in OUTPUTS.values())]
    types = {(one.partition("/")[0], one.rpartition("/")[2]) for one in names}
    done = subprocess.run(
        [sys.executable, "-c", PROBE, where, *HEAVY],
        input=pickle.dumps((cases, [one for one in types if find_spec(one[0])])),
        stdout=subprocess.PIPE,
        check=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])},
    )
    found, answers = [], BytesIO(done.stdout)
    for _ in cases:
        modules, topics = pickle.load(answers)
        own = {name for name in modules if name.startswith("impact_predictor.")}
        packages = {name.partition(".")[0] for name in modules}
        found.append(Loaded(own, packages, {topic.rpartition("/")[2] for topic in topics}))
    return found


def names_on(values: dict[str, Any]) -> set[str]:
    return {feature.name for feature in features_of(values) if feature.on}


def test_each_feature_is_switched_alone_and_its_reasons_name_a_parameter() -> None:
    features = features_of(validate(CRATE))
    assert {feature.name for feature in features} == {*WITHOUT_AND_WITH, "articulated inertia", "drives"}
    legs = {**WALKER, "robot.urdf": "robot.urdf", "robot.frames": WALKER["feet.names"]}
    assert names_on(validate({**legs, "robot.drives": "held"})) - names_on(validate(legs)) == {"drives"}
    (inertia,) = [one for one in features_of(validate(legs)) if one.name == "articulated inertia"]
    assert inertia == ("articulated inertia", True, "robot.urdf is robot.urdf")
    for name, (without, those) in WITHOUT_AND_WITH.items():
        assert names_on(validate(those)) - names_on(validate(without)) == {name}
    for feature in features:
        assert any(word in feature.why for word in PARAMETERS), feature


@pytest.mark.slow
@pytest.mark.parametrize("where", ["node", "replay"])
def test_no_shipped_scene_loads_or_subscribes_to_what_only_features_need_that_it_leaves_out(
    where: str, tmp_path: Path
) -> None:
    if where == "node":
        pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")
    # PyPI does not have tf2_msgs, which a node with transforms needs.
    tried = {k: v for k, v in WITHOUT_AND_WITH.items() if where != "node" or k != "transforms" or find_spec("tf2_msgs")}
    scenes = [one for pair in tried.values() for one in pair]
    different = [one for k, one in enumerate(scenes) if one not in scenes[:k]]
    found = loaded(where, [*different, *SHIPPED.values()], tmp_path)
    added = {}
    for name, pair in tried.items():
        without, those = (found[different.index(one)] for one in pair)
        added[name] = (those.modules - without.modules) | (those.topics - without.topics)
    if where == "node":
        assert "contact_geometry" in added["geometry topic"]
        assert added["force sensors"] == {"contact_wrench"}
    else:
        assert added["transforms"] == {"impact_predictor.prediction.frames"}
    # Else what all scenes load would be left out by none.
    assert all(added[name] for name in ("feet", "moving support", "onset watch", "uncertainty"))
    bare = found[different.index(CRATE)]
    assert "numba" in bare.packages or find_spec("numba") is None
    for (scene, values), one in zip(SHIPPED.items(), found[len(different) :], strict=True):
        on = names_on(validate(values))
        needed = set().union(bare.modules, bare.topics, *(added[name] for name in on & added.keys()))
        left_out = set().union(*(added[name] for name in added.keys() - on)) - needed
        assert not left_out & (one.modules | one.topics), scene
        assert one.packages & HEAVY <= {package for package, features in NEEDED.items() if features & on}, scene
