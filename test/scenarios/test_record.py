"""A motion as a bag: what stands on each topic, and that the predictor finds its way through it."""

from __future__ import annotations

from math import cos, hypot, radians, sin
from pathlib import Path

import numpy as np
import pytest
from records import impacts_of, samples_of

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.prediction.vectors import axes_of, to_world
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, POLYGON, decode_polygon
from impact_predictor.scenarios.record import REST, Actor, rocking_actor, write_record
from impact_predictor.scenarios.rocking import Rocking, release, rocking_rod
from impact_predictor.scenarios.truth import TRUTH_TOPIC

RATE = 1000.0


def a_rod(a: float = 0.1, slope: float = 0.0) -> Rocking:
    return release(rocking_rod(0.4, 0.02, a, a, 1.0, None, None, 0.0), radians(30.0), slope)


def recorded(path: Path, *actors: Actor, rate: float = RATE) -> Path:
    write_record(path, actors, rate)
    return path


def test_one_body_stands_on_the_topics_of_the_node_and_several_on_their_own(tmp_path: Path) -> None:
    alone, told = tmp_path / "alone.mcap", list[int]()
    write_record(alone, [rocking_actor("rod", a_rod().run)], RATE, told.append)
    # In seconds: it is over before the first one.
    assert told
    assert set(told) == {0}
    assert topics(alone) == {"/contact_geometry": POLYGON, "/odom": ODOMETRY, TRUTH_TOPIC: DIAGNOSTIC_ARRAY}
    (message,) = read_messages(alone, {"/contact_geometry": POLYGON})
    geometry = decode_polygon(message.data)
    # float32, as the message has it
    assert np.ravel(geometry.points) == pytest.approx((-0.1, 0.0, -0.01, 0.1, 0.0, -0.01), rel=1e-7)
    assert geometry.frame_id == samples_of(alone)[0].child_frame_id == "rod"
    both = recorded(tmp_path / "both", rocking_actor("one", a_rod().run), rocking_actor("two", a_rod(0.05).run))
    of_each = {f"/{name}/{topic}" for name in ("one", "two") for topic in ("odom", "contact_geometry")}
    assert set(topics(both)) == {*of_each, TRUTH_TOPIC}
    times = [message.log_time for message in read_messages(both, topics(both))]
    assert times == sorted(times)


def test_a_rod_may_stand_on_its_very_ends() -> None:
    assert a_rod(0.2).run.impacts


def test_the_states_are_those_of_the_motion_in_space_at_the_rate(tmp_path: Path) -> None:
    slope = radians(5.0)
    run = a_rod(slope=slope).run
    samples = samples_of(recorded(tmp_path / "rod.mcap", rocking_actor("rod", run), rate=700.0))
    assert len(samples) == rocking_actor("rod", run).samples(700.0) == 1 + int((run.time + REST) * 700.0)
    assert [sample.stamp for sample in samples] == [round(k * 1e9 / 700.0) for k in range(len(samples))]
    for sample in samples[::7]:
        state = run.state(sample.stamp / 1e9)
        axes = axes_of(sample.orientation)
        # The body's x axis in the world, and its rates: counter-clockwise in x and z is negative about y.
        assert axes[0] == pytest.approx((cos(state.angle + slope), 0.0, sin(state.angle + slope)), abs=1e-14)
        assert sample.angular == pytest.approx((0.0, -state.omega, 0.0), abs=1e-14)
        place = state.x * cos(slope) - state.y * sin(slope), 0.0, state.x * sin(slope) + state.y * cos(slope)
        assert sample.position == pytest.approx(place, abs=1e-14)
        speed = to_world(axes, sample.linear)
        assert (hypot(*speed), speed[1]) == (pytest.approx(hypot(state.vx, state.vy), abs=1e-14), 0.0)
    # The twist is the derivative of the pose; a difference misses a sixth of the third one, which is 46 m/s^3 at most,
    # times the square of the step.
    for before, now, after in zip(samples[40:90], samples[41:91], samples[42:92], strict=True):
        moved = (np.array(after.position) - before.position) / ((after.stamp - before.stamp) / 1e9)
        assert to_world(axes_of(now.orientation), now.linear) == pytest.approx(moved, abs=2e-5)


def test_the_true_impacts_are_those_of_the_motion(tmp_path: Path) -> None:
    slope = radians(5.0)
    run = a_rod(slope=slope).run
    path = recorded(tmp_path / "rod.mcap", rocking_actor("rod", run))
    messages, impacts = list(read_messages(path, {TRUTH_TOPIC: DIAGNOSTIC_ARRAY})), impacts_of(path)
    assert len(impacts) == len(run.impacts) > 5
    for message, impact, strike in zip(messages, impacts, run.impacts, strict=True):
        assert message.log_time == impact.stamp == round(strike.time * 1e9)
        assert (impact.mode, impact.old, impact.new) == (strike.outcome.mode, (strike.old,), (strike.new,))
        assert impact.half_distance == pytest.approx(0.1)
        assert impact.approach == pytest.approx(0.2 * abs(strike.before.omega))
        assert impact.angular_after == (0.0, -strike.outcome.twist.omega, 0.0)
        vx, vy = strike.before.vx, strike.before.vy
        in_world = vx * cos(slope) - vy * sin(slope), 0.0, vx * sin(slope) + vy * cos(slope)
        assert impact.linear_before == pytest.approx(in_world, abs=1e-12)
