"""The example of a controller beside the predictor: its machine, its walks, and its node over real topics."""

import importlib.util
import json
import re
import sys
import time
from math import cos, sin
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "walker_controller"))

from controller import Estimate, Feedback, FeedbackGains
from machine import FIRST_LEAN, PERIOD, Walk
from sensors import geometry_of, sample_of
from trials import predicted, scene_of, trial
from tune import GAINS, WALKS, foretold
from values import Failure, Ground, Machine

from impact_predictor import Mode
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.vectors import add, axes_of, to_world
from impact_predictor.scenarios.walking.stride import Hub, Stance, stride

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "walker_controller"
needs_ros = pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="needs ROS 2")
PATIENCE = 40.0


def even(slope, friction):
    return Ground(slope, (friction,) * 60, (0.0,) * 60)


def stiff(angle):
    """Feedback that only sets the legs at an angle."""
    return FeedbackGains(0.5 * angle, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("friction", [0.6, 0.33, 0.3])
def test_a_step_of_the_machine_is_the_stride_of_the_same_hub(friction):
    machine, slope, angle = Machine(), 0.05, 0.7
    walk = Walk(machine, even(slope, friction))
    controller = Feedback(machine, Estimate(slope, friction), stiff(angle))
    hub = Hub(machine.mass, machine.inertia, machine.leg, friction, slope, 9.81)
    expected = stride(hub, Stance(-FIRST_LEAN, 1.3), 0.5 * angle)
    while walk.steps == 0 and walk.failure is None:
        walk.tick(controller.command(walk.seen))
    assert walk.modes[0] is expected.outcome.mode
    if expected.outcome.mode is Mode.SLIDE:
        assert walk.failure is Failure.SLIP
        return
    # The tick goes on after the impact, with less than 10 rad/s^2.
    assert walk.ticks * PERIOD == pytest.approx(expected.time, abs=PERIOD)
    assert walk.rate == pytest.approx(expected.after.rate, abs=10.0 * PERIOD)


def test_the_feet_that_are_told_stand_where_the_machine_has_them():
    one = trial(3)
    walk = Walk(Machine(), one.ground)
    controller = Feedback(walk.machine, one.estimate, stiff(0.6))
    steps = set()
    while walk.failure is None and walk.steps < 4:
        walk.tick(controller.command(walk.seen))
        sample, points = sample_of(walk), geometry_of(walk).points
        standing = points[walk.steps % 2]
        foot = add(sample.position, to_world(axes_of(sample.orientation), standing))
        assert foot == pytest.approx((walk.foot_x, 0.0, walk.foot_z), abs=1e-12)
        steps.add(walk.steps)
    assert len(steps) > 2


def test_the_announced_rate_can_be_trusted_from_a_tenth_of_a_second_before_the_touchdown():
    machine, slope, friction = Machine(), 0.05, 0.6
    walk = Walk(machine, even(slope, friction))
    announce = predicted(scene_of(machine, Estimate(slope, friction), 1.0))
    controller, told = Feedback(machine, Estimate(slope, friction), stiff(0.6)), []
    while walk.steps == 0:
        ahead = announce(walk)
        if ahead is not None and walk.seen.ready:
            told.append((walk.stamp, ahead))
        walk.tick(controller.command(walk.seen))
    leads = [(1e-9 * (walk.stamp - stamp), ahead) for stamp, ahead in told]
    assert max(lead for lead, _ in leads) > 0.1
    for lead, ahead in leads:
        if lead < 0.1:
            assert ahead.mode is walk.modes[0]
            # The acceleration of a leg that falls over grows by gravity / leg * rate, some 12.3 rad/s^3; the predictor
            # has it constant, as it was in the middle of its last 50 ms, and keeps what it told for 6 ms (dead time).
            # A tick is 0.005 rad/s.
            early = lead + 0.006
            tolerance = 12.3 * (0.5 * early**2 + 0.025 * early) + 0.005
            assert ahead.rate == pytest.approx(walk.rate, abs=tolerance)


def test_what_the_gains_are_tuned_with_tells_the_rate_and_the_mode_of_the_impact():
    machine, slope, friction = Machine(), 0.05, 0.6
    walk = Walk(machine, even(slope, friction))
    announce = foretold(scene_of(machine, Estimate(slope, friction), 1.0))
    controller, told = Feedback(machine, Estimate(slope, friction), stiff(0.6)), []
    while walk.steps == 0:
        told.append(announce(walk))
        walk.tick(controller.command(walk.seen))
    told = [ahead for ahead in told if ahead is not None]
    assert len(told) > 50
    for ahead in told:
        assert ahead.mode is walk.modes[0]
        # The tick of the impact goes on after it, with less than 10 rad/s^2.
        assert ahead.rate == pytest.approx(walk.rate, abs=10.0 * PERIOD)


def test_the_shipped_scene_is_that_of_the_walks():
    scene = Scene.from_parameters(read_values(str(ROOT / "config" / "walker.yaml")))
    expected = scene_of(Machine(), Estimate(0.03, 0.45), 0.9)
    # The file gives gravity to 1e-4 m/s^2.
    assert scene.gravity == pytest.approx((9.81 * sin(0.03), 0.0, -9.81 * cos(0.03)), abs=1e-4)
    assert scene.friction == pytest.approx(expected.friction)
    same = {"gravity": expected.gravity, "friction": expected.friction, "validity": expected.validity}
    assert scene._replace(**same) == expected


def test_walks_repeat_to_the_last_bit():
    gains = json.loads(GAINS.read_text())["predictive"]["gains"]
    ends = [WALKS["predictive"](trial(37), gains) for _ in range(2)]
    assert ends[0] == ends[1]
    assert ends[0].steps > 0


@pytest.mark.parametrize("name", ["feedback", "informed"])
def test_walks_without_the_predictor_end_as_published(name):
    gains = json.loads(GAINS.read_text())[name]["gains"]
    for published in json.loads((EXAMPLE / "walks.json").read_text())["walks"][:12]:
        end = WALKS[name](trial(published["seed"]), gains)
        assert (end.failure.value if end.failure else None) == published[name]["failure"]
        # Published to 1e-3 s.
        assert end.time == pytest.approx(published[name]["time"], abs=1e-3)


@needs_ros
@pytest.mark.slow
def test_the_node_walks_with_the_real_predictor_over_topics():
    from impact_predictor.ros.processes import Child, ros_environment

    environment = {**ros_environment(), "PYTHONPATH": str(ROOT)}
    scene = str(ROOT / "config" / "walker.yaml")
    predictor = ("-m", "impact_predictor.ros.node", "--ros-args", "--params-file", scene)
    with Child("predictor", environment, *predictor) as listens:
        with Child("walker", environment, str(EXAMPLE / "node.py")) as walks:
            end = time.monotonic() + PATIENCE
            told = []
            while time.monotonic() < end and not (told and told[-1] > 100):
                time.sleep(0.5)
                walks.check()
                listens.check()
                told = [int(one) for one in re.findall(r"(\d+) announcements", walks.complained() + walks.said())]
            walks.end()
            words = walks.complained() + walks.said()
        listens.end()
    assert told[-1] > 100, words
    assert int(re.findall(r"(\d+) steps", words)[-1]) >= 3, words
