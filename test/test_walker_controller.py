"""The example of a controller beside the predictor: its machine, its walks, and its node over real topics."""

import importlib.util
import json
import re
import sys
import time
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "walker_controller"))

from controller import STILL, Predictive, PredictiveGains
from experiment import NAMES, SEEDS, summary
from machine import FIRST_LEAN, PERIOD, Failure, Ground, Walk
from sensors import geometry_of, sample_of
from tune import EFFORT, FIRST_SEED, GAINS
from values import Command, Estimate, Machine
from walks import foretold, predicted, scene_of, trial, walk_with

from impact_predictor import Mode, solve_impact
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.vectors import add, axes_of, to_world
from impact_predictor.scenarios.wheel import Hub
from impact_predictor.scenarios.wheel_closed_forms import gained, impact_friction, kept, step_time

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "walker_controller"
needs_ros = pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="needs ROS 2")
PATIENCE = 120.0


def even(slope, friction):
    return Ground(slope, friction, (0.0,) * 60)


def published():
    return json.loads((EXAMPLE / "walks.json").read_text())


def gains_of(name):
    return json.loads(GAINS.read_text())[name]["gains"]


@pytest.mark.parametrize("friction", [0.6, 0.33, 0.3])
def test_a_step_of_the_machine_is_that_of_the_same_hub_in_closed_form(friction):
    machine, slope, angle = Machine(), 0.05, 0.7
    walk = Walk(machine, even(slope, friction))
    hub = Hub(machine.mass, machine.inertia, machine.leg, friction, slope, 9.81)
    while walk.steps == 0 and walk.failure is None:
        walk.tick(Command(angle, 0.0))
    body = hub.body(0.5 * angle)
    assert walk.modes[0] is solve_impact(body, body.turning(-1.0)).mode
    if walk.modes[0] is Mode.SLIDE:
        assert walk.failure is Failure.SLIP
        return
    # The tick goes on after the impact, with less than 10 rad/s^2.
    before = (1.3**2 + gained(hub, -FIRST_LEAN, 0.5 * angle)) ** 0.5
    assert walk.ticks * PERIOD == pytest.approx(step_time(hub, -FIRST_LEAN, 0.5 * angle, 1.3), abs=PERIOD)
    if friction > impact_friction(hub, 0.5 * angle):
        assert walk.rate == pytest.approx(kept(hub, 0.5 * angle) * before, abs=10.0 * PERIOD)


def test_a_push_off_before_the_impact_leaves_the_momentum_about_the_new_foot_that_it_adds():
    machine, angle, push = Machine(), 0.5, 4.0
    rates = []
    for wanted in (0.0, push):
        walk = Walk(machine, even(0.05, 0.6))
        while walk.steps == 0:
            walk.tick(Command(angle, wanted))
        rates.append(walk.rate)
    # The push along the leg behind has the lever leg * sin(angle) about the foot ahead; the gyration until the end of
    # the tick differs by less than 1 rad/s^2.
    expected = push * machine.leg * sin(angle) / machine.foot_inertia
    assert rates[1] - rates[0] == pytest.approx(expected, abs=1.0 * PERIOD)
    assert walk.work == pytest.approx(push**2 / (2.0 * machine.mass))


def test_the_feet_that_are_told_stand_where_the_machine_has_them():
    walk = Walk(Machine(), trial(3).ground)
    steps = set()
    while walk.failure is None and walk.steps < 4:
        walk.tick(Command(0.5, 8.0))
        sample, points = sample_of(walk), geometry_of(walk).points
        standing = points[walk.steps % 2]
        foot = add(sample.position, to_world(axes_of(sample.orientation), standing))
        assert foot == pytest.approx((walk.foot_x, 0.0, walk.foot_z), abs=1e-12)
        steps.add(walk.steps)
    assert len(steps) > 2


def test_what_the_gains_are_tuned_with_is_what_the_predictor_tells():
    gains, one = PredictiveGains(), trial(10_003)
    scene = scene_of(one.machine, one.estimate, gains.trust)
    announce, tell = predicted(one.machine, scene), foretold(one.machine, scene)
    controller, walk = Predictive(one.machine, one.estimate, gains), Walk(one.machine, one.ground, one.gusts)
    held, both, ahead, still, angle = 0, [], None, 0, 0.0
    while walk.failure is None and walk.steps < 6:
        command = controller.command(walk.seen, ahead)
        still = still + 1 if walk.seen.ready and abs(walk.angle - angle) < 1e-6 else 0
        angle = walk.angle
        ahead, same = announce(walk), tell(walk)
        if same is not None and still > STILL:
            held += 1
            both += [] if ahead is None else [(ahead, same)]
        walk.tick(command)
    # The predictor is silent in the first ticks of some stretches, until its fit is sure.
    assert len(both) > 0.9 * held > 200
    assert sum(one.mode is other.mode for one, other in both) > 0.99 * len(both)
    # It fits the course of the foot, which the other knows, and so is some ms off while the landing is far. In these ms
    # the rate changes by less than 5 rad/s^2.
    assert np.quantile([1e-9 * abs(one.stamp - other.stamp) for one, other in both], 0.95) < 0.01
    rates = [one.rate - other.rate for one, other in both if one.mode is other.mode is Mode.PIVOT]
    assert np.quantile(np.abs(rates), 0.95) < 0.05


def test_the_shipped_scene_is_that_of_the_walks():
    scene = Scene.from_parameters(read_values(str(ROOT / "config" / "walker.yaml")))
    expected = scene_of(Machine(), Estimate(0.03, 0.45), gains_of("predictive")["trust"])
    # The file gives gravity to 1e-4 m/s^2, friction to 1e-3.
    assert scene.gravity == pytest.approx((9.81 * sin(0.03), 0.0, -9.81 * cos(0.03)), abs=1e-4)
    assert scene.friction == pytest.approx(expected.friction, abs=5e-4)
    same = {"gravity": expected.gravity, "friction": expected.friction, "validity": expected.validity}
    assert scene._replace(**same) == expected


@pytest.mark.parametrize(("name", "count"), [("feedback", 8), ("informed", 8), ("predictive", 1)])
def test_walks_end_as_published(name, count):
    for walk in published()["walks"][:count]:
        end = walk_with(name, trial(walk["seed"]), gains_of(name))
        assert (end.failure.value if end.failure else None) == walk[name]["failure"]
        # Published to 1e-3 m and s, and to 1e-2 J.
        assert (end.distance, end.time) == pytest.approx((walk[name]["distance"], walk[name]["time"]), abs=1e-3)
        assert end.work == pytest.approx(walk[name]["work"], abs=1e-2)


def test_what_is_published_sums_up_its_walks_which_no_gains_were_tuned_on():
    told = published()
    assert told["summary"] == summary(told["walks"])
    assert [walk["seed"] for walk in told["walks"]] == list(SEEDS)
    assert not set(SEEDS) & set(range(FIRST_SEED, FIRST_SEED + EFFORT.walks))
    tuned = json.loads(GAINS.read_text())
    assert {(tuned[name]["evaluations"], tuned[name]["walks"]) for name in NAMES} == {
        (EFFORT.population * EFFORT.generations, EFFORT.walks)
    }


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
            steps = announced = 0
            while not (steps >= 3 and announced > 100):
                assert time.monotonic() < end, walks.complained()
                time.sleep(0.5)
                walks.check()
                listens.check()
                words = walks.complained() + walks.said()
                # A walk that ended begins anew, so the most steps count.
                steps = max(map(int, re.findall(r"(\d+) steps", words)), default=0)
                announced = max(map(int, re.findall(r"(\d+) announcements", words)), default=0)
            walks.end()
        listens.end()
