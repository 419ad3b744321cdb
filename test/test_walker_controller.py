"""The example of a controller beside the predictor: its law, the robot in MuJoCo, what is published, and its node."""

import importlib.util
import json
import re
import sys
import time
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "walker_controller"))

from controller import CLEARANCE, GRAVITY, HEIGHT, HIPS, SWING, TICK, Gains, Landing, Measured, Trot, planned_height
from sources import GapOverSpeed, Plan, Predicted

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "walker_controller"
IN_PHYSICS = pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("mujoco", "cmeel")),
    reason="needs MuJoCo and example-robot-data: pip install '.[robot]'",
)
needs_ros = pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="needs ROS 2")
PATIENCE = 120.0
MASS = 2.5


def measured(tick, gaps=(0.0,) * 4, speeds=(0.0,) * 4, felt=(True,) * 4):
    """A level trunk over feet with some gaps to the ground (m), which near it with some speeds (m/s)."""
    return Measured(
        tick=tick,
        position=np.array([0.0, 0.0, HEIGHT]),
        velocity=np.zeros(3),
        axes=np.eye(3),
        spin=np.zeros(3),
        feet=np.column_stack([HIPS, np.array(gaps) - HEIGHT]),
        feet_velocity=np.column_stack([np.zeros((4, 2)), -np.array(speeds)]),
        felt=felt,
    )


def test_a_swing_is_planned_from_the_ground_over_the_clearance_to_the_ground():
    for descent in (0.2, 0.9):
        times = np.linspace(0.0, SWING + 0.02, 401)
        heights, rates = np.array([planned_height(-HEIGHT, time, descent) for time in times]).T
        assert heights.max() == pytest.approx(CLEARANCE - HEIGHT)
        assert planned_height(-HEIGHT, SWING, descent) == pytest.approx((-HEIGHT, -descent))
        assert np.gradient(heights, times)[1:-1] == pytest.approx(rates[1:-1], abs=0.02)


def test_a_foot_that_brakes_comes_down_by_the_gap_that_was_told():
    law = Trot(MASS, 0.0, Gains(lead=0.03, speed=0.1, late=9.0), Told(Landing(0.025, 0.01, 0.5)))
    run_until_swing(law)
    brake = law._brakes[0]
    assert (brake.first, brake.last) == (0.5, 0.1)
    speeds = [brake.speed(brake.since + part * brake.lasts) for part in (0.0, 0.5, 1.0)]
    assert np.mean(speeds) * brake.lasts == pytest.approx(0.01)


class Told:
    """Tells the same landing of every foot, always."""

    senses = True

    def __init__(self, landing):
        self.landing = landing

    def tell(self, measured, planned):
        return [self.landing] * 4


def run_until_swing(law, feels=False, ticks=260):
    """Stand for the time before the first swing, and then be in the air; the ticks after which feet stood."""
    stood = []
    for tick in range(ticks):
        felt = tuple(stands or feels for stands in law.stands)
        commands = law.commands(measured(tick, felt=felt))
        stood.append(list(law.stands))
    assert len(commands) == 4
    return np.array(stood)


def test_four_feet_that_stand_bear_the_weight_and_no_more():
    law = Trot(MASS, 0.0, Gains(), Plan(senses=True))
    commands = [law.commands(measured(tick)) for tick in range(50)][-1]
    assert sum(-each.force for each in commands) == pytest.approx((0.0, 0.0, MASS * GRAVITY), rel=1e-2, abs=1e-6)
    assert all(each.stiffness == 0.0 for each in commands)


def test_a_foot_bears_when_its_landing_is_due_or_felt_whichever_is_first():
    late = 0.02
    gains = Gains(lead=0.03, speed=0.5, late=late)
    told = Told(Landing(0.02, 0.01, 0.5))
    lifted = int(np.argmin(run_until_swing(Trot(MASS, 0.0, gains, told))[:, 0]))
    due = run_until_swing(Trot(MASS, 0.0, gains, told))[lifted:, 0]
    # It brakes once half of its swing is over.
    assert int(np.argmax(due)) * TICK == pytest.approx(0.5 * SWING + 0.02 + late, abs=2.5 * TICK)
    felt = run_until_swing(Trot(MASS, 0.0, gains, told), feels=True)[lifted:, 0]
    assert int(np.argmax(felt)) * TICK == pytest.approx(0.4 * SWING, abs=2.5 * TICK)


def test_both_who_measure_tell_when_a_foot_at_constant_speed_lands():
    speed, sources = 0.4, (GapOverSpeed(), Predicted())
    gap, told = np.zeros(4), []
    for tick in range(260):
        # Up for 0.1 s, and down again.
        rate = np.zeros(4)
        rate[0] = 0.0 if tick < 150 else -speed if tick < 200 else speed
        gap = np.maximum(gap - rate * TICK, 0.0)
        state = measured(tick, gap, rate, felt=(bool(gap[0] == 0.0), True, True, True))
        told.append([source.tell(state, Landing(1.0, 1.0, 0.4))[0] for source in sources])
    ahead = 10
    for landing in told[250 - ahead]:
        assert landing.time == pytest.approx(ahead * TICK, abs=0.003)
        assert landing.speed == pytest.approx(speed, abs=0.02)


@pytest.mark.extras
@IN_PHYSICS
def test_the_robot_stands_with_its_weight_on_its_feet_and_feels_them_late():
    from robot import DEBOUNCE, LATENCY, Robot, Trial

    robot = Robot(Trial(0, np.zeros((40, 6)), ()))
    law = Trot(robot.mass, 0.0, Gains(), Plan(senses=True))
    state, felt = robot.measure(), []
    for _ in range(140):
        robot.tick(law.commands(state))
        state = robot.measure()
        felt.append(all(state.felt))
    assert robot.mass == pytest.approx(MASS, abs=0.01)
    assert robot.forces.sum(axis=1).mean() == pytest.approx(robot.mass * GRAVITY, rel=0.1)
    assert felt.index(True) >= DEBOUNCE - 1
    assert len(robot._told) == LATENCY + 1


@pytest.mark.extras
@IN_PHYSICS
def test_it_walks_over_a_ground_of_the_experiment_with_the_published_gains():
    from experiment import ARMS, GAINS, trial, walk

    gains = json.loads(GAINS.read_text(encoding="utf-8"))
    for name in ("sensors", "predictor"):
        made = walk(ARMS[name], Gains(**gains[name]["gains"]), trial(2), 1000)
        assert not made.fell
        assert made.landings >= 10
        assert made.lag < 0.3


@pytest.mark.extras
@IN_PHYSICS
def test_what_is_published_sums_up_its_walks_which_no_gains_were_tuned_on():
    from experiment import FIRST, GAINS, GENERATIONS, POPULATION, TUNABLE, TUNED, summary

    told = json.loads((EXAMPLE / "walks.json").read_text(encoding="utf-8"))
    assert told["summary"] == summary(told["walks"])
    assert [each["seed"] for each in told["walks"]] == [*range(FIRST, FIRST + 60)]
    assert max(TUNED) < FIRST
    tuned = json.loads(GAINS.read_text(encoding="utf-8"))
    assert {tuned[name]["evaluations"] for name in TUNABLE} == {POPULATION * GENERATIONS}


@needs_ros
@pytest.mark.extras
@pytest.mark.slow
@IN_PHYSICS
def test_the_node_walks_with_the_real_predictor_over_topics():
    from impact_predictor.ros.processes import Child, ros_environment

    environment = {**ros_environment(), "PYTHONPATH": str(ROOT)}
    scene = str(ROOT / "config" / "walker.yaml")
    predictor = ("-m", "impact_predictor.ros.node", "--ros-args", "--params-file", scene, "-p", "messages:=strings")
    with Child("predictor", environment, *predictor) as listens:
        with Child("walker", environment, str(EXAMPLE / "node.py")) as walks:
            end, told = time.monotonic() + PATIENCE, 0
            while told < 100:
                assert time.monotonic() < end, walks.complained()
                time.sleep(0.5)
                walks.check()
                listens.check()
                told = max(map(int, re.findall(r"(\d+) ticks", walks.complained() + walks.said())), default=0)
            walks.end()
        listens.end()
