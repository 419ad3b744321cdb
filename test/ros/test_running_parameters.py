"""Parameters that are set while the node runs, over the parameter services as `ros2 param set` uses them."""

import math
from array import array
from functools import reduce
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

import rclpy
import yaml
from graph import peer_of_node, running_node
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import QoSProfile

from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.table import PARAMETERS
from impact_predictor.parameters.validation import check_change, validate
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Geometry, Sample, Status
from impact_predictor.ros.messages import encode_odometry, encode_prediction

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "config/cube_tosses.yaml"
CUBE = [number for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05) for number in (x, y, z)]
GIVEN = {**read_parameters(SCENE), "body.contact_points": CUBE}
NOTHING = (0.0,) * 36
OTHER = {"single": "events", "events": "single"}


def sample(k, frame="cube"):
    """A cube that turns about its lower edge, which rests, onto the floor; sample k of 100 a second."""
    half, tilt, rate = 0.05, 0.1, -2.0
    sine, cosine = math.sin(tilt), math.cos(tilt)
    aside, height = half * (cosine - sine), half * (cosine + sine)
    x, z = rate * height, rate * aside
    linear = (cosine * x - sine * z, 0.0, sine * x + cosine * z)
    turned = (0.0, math.sin(0.5 * tilt), 0.0, math.cos(0.5 * tilt))
    stamp = k * 10_000_000
    return Sample(stamp, "world", frame, (0.0, 0.0, height), turned, linear, (0.0, rate, 0.0), NOTHING, NOTHING)


def scene_with(**changes):
    return scenes_of(validate({**GIVEN, **changes}))


def answer(scenes, *samples):
    monitor = Monitor(scenes)
    return [monitor.update("", one) for one in samples][-1]


@pytest.mark.slow
def test_what_a_node_dumps_of_its_parameters_starts_it_again_with_the_same(tmp_path):
    """As `ros2 param dump` does it: the names, all values at once, and what goes between dots as nested keys."""
    with peer_of_node() as peer:

        def dumped(scene):
            with running_node(scene):
                client = AsyncParameterClient(peer.node, "impact_predictor")
                peer.until(lambda: client.wait_for_services(0.02))
                listed = client.list_parameters([], 10)
                peer.until(listed.done)
                told = client.get_parameters(sorted(listed.result().result.names))
                peer.until(told.done)
            values = map(parameter_value_to_python, told.result().values)
            nested = {}
            for name, value in zip(sorted(listed.result().result.names), values, strict=True):
                *groups, key = name.split(".")
                reduce(lambda inner, group: inner.setdefault(group, {}), groups, nested)[key] = (
                    list(value) if isinstance(value, array) else value
                )
            return {"/impact_predictor": {"ros__parameters": nested}}

        first = dumped(ROOT / "config/deck_many.yaml")
        assert first["/impact_predictor"]["ros__parameters"]["crate"]["body"]
        (tmp_path / "dump.yaml").write_text(yaml.dump(first, default_flow_style=False))
        assert dumped(tmp_path / "dump.yaml") == first


def test_every_parameter_that_cannot_change_is_one_and_the_others_can():
    fixed = {name for name, parameter in PARAMETERS.items() if parameter.fixed}
    values = validate(GIVEN)
    free = {"contact.friction", "contact.restitution", "contact.tolerance", "horizon", "body.mass", "body.inertia"}
    assert not (free | {"uncertainty.samples", "margins", "law", "onset.warn"}) & fixed
    for name in fixed:
        with pytest.raises(InputError, match=f"the parameter {name} cannot change while the node runs, for "):
            check_change(values, {**values, name: object()})


def test_a_changed_scene_answers_the_next_sample_as_if_it_had_always_been_so():
    # All samples have the same pose: how the body moves is in the messages.
    twist = {"odom.twist": "message"}
    livelier = scene_with(**twist, **{"contact.friction": 1.5, "contact.restitution": 0.9})
    monitor = Monitor(scene_with(**twist))
    before = monitor.update("", sample(0)).touchdown
    change = monitor.changed(livelier)
    assert monitor.update("", sample(1)).touchdown.after == before.after
    change()
    changed = monitor.update("", sample(2))
    assert changed == answer(livelier, sample(2))
    assert changed.touchdown.after != before.after
    # The clock goes on: what is older is refused still.
    assert monitor.update("", sample(1)).status is Status.STAMP_WENT_BACK


def test_contact_points_that_were_told_stay_known_when_the_scene_changes():
    given = read_parameters(SCENE)
    monitor = Monitor(scenes_of(validate(given)))
    points = tuple(tuple(CUBE[i : i + 3]) for i in range(0, 24, 3))
    monitor.tell("", Geometry(0, "cube", points))
    monitor.changed(scenes_of(validate({**given, "contact.friction": 0.9})))()
    assert monitor.update("", sample(0)).status is Status.ACCEPTED
    assert monitor.update("", sample(1, "other")).status is Status.WRONG_FRAME


def test_a_machine_that_walks_goes_on_with_the_next_message_about_its_feet():
    given = read_parameters(ROOT / "config/walker.yaml")
    monitor = Monitor(scenes_of(validate(given)))
    feet = tuple((x, y, -0.5) for x in (0.2, -0.2) for y in (0.1, -0.1))
    base = Sample(0, "", "", (0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0), *2 * [(0.0, 0.0, 0.0)], NOTHING, NOTHING)
    base = base._replace(frame_id=monitor.scenes[""].frame)

    def status_of(k, told=True):
        if told:
            monitor.tell("", Geometry(k * 10_000_000, "", feet))
        return monitor.update("", base._replace(stamp=k * 10_000_000)).status

    assert [status_of(k) for k in (1, 2)] == [Status.ACCEPTED] * 2
    monitor.changed(scenes_of(validate({**given, "feet.dead_time": 0.05, "contact.friction": 0.9})))()
    assert status_of(3, told=False) is Status.NO_GEOMETRY
    assert status_of(4) is Status.ACCEPTED
    assert monitor.scenes[""].friction == 0.9


def test_only_the_bodies_whose_scene_changes_begin_anew():
    given = {**read_parameters(ROOT / "config/deck_many.yaml")}
    before = scenes_of(validate(given))
    monitor = Monitor(before)
    deck, watch = monitor.deck, monitor.watch
    was = {body: (one.scene, one.contacts) for body, one in monitor.predictors.items()}
    monitor.changed(scenes_of(validate({**given, "crate.contact.friction": 0.77})))()
    assert monitor.deck is deck
    assert monitor.watch is not watch
    changed = {body for body, one in monitor.predictors.items() if (one.scene, one.contacts) != was[body]}
    assert changed == {"crate"}
    assert monitor.scenes["crate"].friction == 0.77


def settings(**values):
    return [Parameter(name.replace("__", "."), value=value) for name, value in values.items()]


@pytest.fixture
def deck_node():
    from impact_predictor.ros.predictor_node import PredictorNode

    rclpy.init(args=["--ros-args", "--params-file", str(ROOT / "config/deck_many.yaml")])
    node = PredictorNode()
    yield node
    node.destroy_node()
    rclpy.shutdown()


def test_a_parameter_may_be_given_to_one_body_while_the_node_runs_and_takes_nothing_from_the_others(deck_node):
    common = deck_node.get_parameter("contact.friction").value
    wrong = [Parameter("crate.contact.friction", value=0.77), Parameter("crate.contact.restitution", value=-1.0)]
    refused = deck_node.set_parameters_atomically(wrong)
    assert refused.reason.startswith("the parameter crate.contact.restitution is -1.0, but it must be")
    assert not deck_node.has_parameter("crate.contact.friction")
    assert deck_node.set_parameters_atomically(wrong[:1]).successful
    assert deck_node.get_parameter("crate.contact.friction").value == 0.77
    frictions = {body: scene.friction for body, scene in deck_node._monitor.scenes.items()}
    assert frictions["crate"] == 0.77
    # One body has another one in the file.
    assert set(frictions.values()) - {0.77} >= {common}
    simulated = [Parameter("use_sim_time", value=True), Parameter("crate.horizon", value=0.5)]
    assert deck_node.set_parameters_atomically(simulated).successful
    assert deck_node._monitor.scenes["crate"].horizon == 0.5


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_parameters_are_taken_all_together_for_the_next_sample_or_refused_in_the_sentence_of_the_start(executor):
    given = {"body.contact_points": CUBE, "executor": executor}
    arguments = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
    every_sample = ("-p", "qos_overrides./odom.subscription.reliability:=reliable")
    with peer_of_node() as peer, running_node(SCENE, *arguments, *every_sample) as node:
        client = AsyncParameterClient(peer.node, "impact_predictor")
        samples = peer.connected(peer.publisher(Odometry, "odom", QoSProfile(depth=100)))
        peer.until(lambda: client.wait_for_services(0.02))

        def told(future):
            peer.until(future.done)
            return future.result()

        def answered(k):
            count = len(peer.heard["prediction"])
            samples.publish(encode_odometry(sample(k)))
            peer.until(lambda: len(peer.heard["prediction"]) > count)
            return peer.heard["prediction"][-1]

        def refusal(**values):
            result = told(client.set_parameters_atomically(settings(**values))).result
            assert not result.successful
            return result.reason

        first = scene_with()
        assert answered(0) == encode_prediction(answer(first, sample(0)))
        with pytest.raises(InputError) as at_start:
            validate({**GIVEN, "contact.restitution": 2.0})
        assert refusal(contact__friction=0.9, contact__restitution=2.0) == str(at_start.value)
        assert "cannot change while the node runs, for the topics follow from it" in refusal(bodies=["a"])
        assert "messages are waited for by it" in refusal(contact__friction=0.9, executor=OTHER[executor])
        assert "there is no parameter horizn, did you mean horizon?" in refusal(horizn=0.5)
        assert refusal(body__mass="heavy").startswith("the parameter body.mass is 'heavy', but it must be")
        assert refusal(body__mass=3).endswith("ROS takes no integer for a double, so write 3.0 for 3")
        assert "cannot be deleted" in refusal(contact__friction=None)
        kept = told(client.get_parameters(["contact.friction", "contact.restitution"])).values
        assert [one.double_value for one in kept] == [GIVEN["contact.friction"], GIVEN["contact.restitution"]]
        assert answered(1) == encode_prediction(answer(first, sample(0), sample(1)))
        result = told(client.set_parameters_atomically(settings(contact__friction=1.5, contact__restitution=0.9)))
        assert result.result.successful, result.result.reason
        after = scene_with(**{"contact.friction": 1.5, "contact.restitution": 0.9})
        assert answered(2) == encode_prediction(answer(after, sample(2)))
        # As from a file: what does not change may be given again, also where it could not change.
        results = told(client.set_parameters(settings(executor=executor, law="path", horizon=0.5)))
        assert all(one.successful for one in results.results)
        names = told(client.list_parameters([], 10)).result.names
        values = told(client.get_parameters(names)).values
        # As `ros2 param dump` asks for them: one without a value, and none would be told.
        assert len(values) == len(names) > 30
        assert all(one.type for one in values)
        for service, kind in (
            ("set_parameters", SetParameters),
            ("set_parameters_atomically", SetParametersAtomically),
        ):
            unknown = ParameterMessage(name="horizon", value=ParameterValue(type=77))
            asked = peer.node.create_client(kind, f"/impact_predictor/{service}")
            answer_of = told(asked.call_async(kind.Request(parameters=[unknown])))
            (refused,) = answer_of.results if service == "set_parameters" else [answer_of.result]
            assert refused.reason == "the parameter horizon has the type 77, which ROS does not have"
        assert "there is no parameter zzz" in refusal(zzz=0.5)
        assert "from now on contact.friction is 1.5, contact.restitution is 0.9" in node.complained()
        assert "Traceback" not in node.complained()
