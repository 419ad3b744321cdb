"""The node for several bodies over a moving support: the same as a replay, and never OK where something is wrong."""

import struct
import time
from itertools import islice
from pathlib import Path

import pytest
from harmonic_deck import Wave, harmonic_support

from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Imu, Sample, Status
from impact_predictor.ros.cdr import OK, STALE, WARN
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    IMU,
    ODOMETRY,
    OUTPUTS,
    decode_diagnostic_array,
    encode_imu,
    encode_odometry,
)
from impact_predictor.ros.processes import Child
from impact_predictor.scenarios.deck.voyage import sail
from impact_predictor.scenarios.record import Sensors

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

from graph import arguments_of, serve, served_and_replayed, without_numba

from impact_predictor.ros.process import message_class

ROOT = Path(__file__).parents[2]
UNIT = "impact_predictor/unit/"
BODIES = ("rocker", "tilter", "plain")
CARGO = {
    "bodies": list(BODIES),
    "body.mass": 80.0,
    "body.inertia": [8.0, 8.0, 4.0, 0.0, 0.0, 0.0],
    "body.contact_points": [part for x in (-0.3, 0.3) for y in (-0.2, 0.2) for part in (x, y, -0.5)],
    "contact.friction": 0.6,
    "support.motion": "odom",
    "onset.watch": True,
    "tilter.source": "imu",
    "plain.source": "none",
    **{f"{body}.place.position": [2.0 * k, 0.0, 0.5] for k, body in enumerate(BODIES)},
}


def sailed(bag, **more):
    """A bag of three crates on a deck in a short steep sea, which rock for three seconds before they overturn."""
    sea = harmonic_support(angle=(Wave(0.1, 5.0),), x=(Wave(0.14, 5.0, 3.14),))
    voyage = sail(scenes_of(validate({**CARGO, **more})), sea, 3.3, bag=bag, sensors=Sensors(rate=20.0, deck_rate=50.0))
    assert len(voyage.units[0].impacts) == 3


def said_of_units(arrays):
    """What a sequence of diagnostics says about units, and not about the node."""
    return [one for data in arrays for one in decode_diagnostic_array(data) if one.name.startswith(UNIT)]


def test_a_deck_that_nobody_publishes_is_named_beside_what_stands_on_it():
    import rclpy

    from impact_predictor.ros.predictor_node import PredictorNode

    rclpy.init(args=["--ros-args", "--params-file", str(ROOT / "config/deck_crate.yaml")])
    try:
        node = PredictorNode()
        node._on_second()
        said, _ = node._reporter.diagnostics.inputs.flaw(time.perf_counter())
        node.destroy_node()
    finally:
        rclpy.shutdown()
    assert said == "no sample yet on support/odom and odom: nobody publishes there"


@pytest.mark.slow
@pytest.mark.parametrize(("executor", "motion"), [("single", "odom"), ("events", "odom"), ("events", "imu")])
def test_several_bodies_on_a_deck_are_told_live_what_the_replay_tells_byte_for_byte(tmp_path, executor, motion):
    more = {"executor": executor, "support.motion": motion}
    values = validate({**CARGO, **more, "messages": "strings"})
    bag, output = tmp_path / "deck.mcap", tmp_path / "replayed.mcap"
    sailed(bag, **more)
    heard, replayed, read = served_and_replayed(values, bag, output)
    of_rocker = {f"/impact_predictor/rocker/{name}" for name in OUTPUTS}
    assert replayed.keys() == {*of_rocker, "/diagnostics"}
    assert read - {"/parameter_events"} == {f"/support/{motion}", "/rocker/odom", "/tilter/imu"}
    for topic in of_rocker:
        assert len(heard[topic]) > 2
        assert heard[topic] == replayed[topic]
    assert said_of_units(heard["/diagnostics"]) == said_of_units(replayed["/diagnostics"])
    assert {one.name for one in said_of_units(heard["/diagnostics"])} == {UNIT + body for body in BODIES}


SECOND = 10**9
FAULT = 2 * SECOND
"""ns for which something is wrong, and for which all is well before and after it."""
GRACE = 600_000_000
"""ns in which it must be noticed: the timeout of the support, and a message of each."""
NOTHING, LEVEL = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
COVARIANCE = (0.0,) * 36


def deck(stamp):
    return Sample(stamp, "world", "deck", NOTHING, LEVEL, NOTHING, NOTHING, COVARIANCE, COVARIANCE)


def crate(stamp):
    return deck(stamp)._replace(child_frame_id="crate", position=(0.0, 0.0, 0.5))


def to_and_fro(sample):
    """Another place every fifth of a second."""
    return sample._replace(position=(3.0 * (sample.stamp // 200_000_000 % 2), 0.0, 0.0))


FAULTS = {
    Status.SUPPORT_STALE: (lambda sample: None, lambda sample: sample),
    Status.CLOCKS_APART: (lambda sample: sample, lambda sample: sample._replace(stamp=sample.stamp + 3 * SECOND)),
    Status.WRONG_FRAME: (lambda sample: sample, lambda sample: sample._replace(frame_id="elsewhere")),
    Status.SUPPORT_JUMPED: (to_and_fro, lambda sample: sample),
    Status.OFF_SUPPORT: (lambda sample: sample, lambda sample: sample._replace(position=(0.0, 0.0, 9.0))),
    Status.BELOW_SUPPORT: (lambda sample: sample, lambda sample: sample._replace(position=(0.0, 0.0, -9.0))),
    Status.BODY_STALE: (lambda sample: sample, lambda sample: None),
}
"""What becomes of the messages of deck and crate while something is wrong, by the status that must tell it."""


def troubled():
    """Each fault in its turn, and time to get over it: the messages, and from when to when it is there."""
    found, times, now = [], {}, 100 * SECOND
    for status, (of_deck, of_crate) in FAULTS.items():
        times[status] = now + FAULT, now + 2 * FAULT
        for stamp in range(now, now + 2 * FAULT, SECOND // 20):
            both = ("/support/odom", deck(stamp), of_deck), ("/crate/odom", crate(stamp), of_crate)
            for topic, sample, fault in both[: 1 + stamp // 50_000_000 % 2]:
                told = fault(sample) if stamp >= now + FAULT else sample
                if told is not None:
                    found.append((topic, ODOMETRY, encode_odometry(told)))
        now += 2 * FAULT
    return found, times


def one_crate(**more):
    places = {name: value for name, value in CARGO.items() if name.partition(".")[0] not in BODIES}
    return validate({**places, "bodies": ["crate"], "crate.place.position": [0.0, 0.0, 0.5], "onset.hold": 0.0, **more})


def units_between(arrays, begin, end):
    """What is said about units with stamps in ns from a beginning to an end."""
    within = []
    for data in arrays:
        seconds, nanoseconds = struct.unpack_from("<iI", data, 4)
        if begin <= seconds * SECOND + nanoseconds <= end:
            within.append(data)
    return said_of_units(within)


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_what_goes_wrong_on_a_deck_is_named_and_the_unit_is_not_ok_while_it_lasts(executor):
    messages, times = troubled()
    heard, _ = serve(one_crate(executor=executor), messages, {"/diagnostics": DIAGNOSTIC_ARRAY})
    for status, (begin, end) in times.items():
        # What is said of a unit alone has the stamp of the deck's last message, which may be from before.
        before = units_between(heard["/diagnostics"], begin - SECOND, begin - SECOND // 10)
        assert [one.level for one in before[-1:]] == [OK], (status, before[-1:])
        while_it_lasts = units_between(heard["/diagnostics"], begin + GRACE, end - 1)
        assert while_it_lasts, status
        assert not [one for one in while_it_lasts if one.level == OK], status
        assert any(status.name in one.message for one in while_it_lasts), (status, while_it_lasts[-1])


@pytest.mark.slow
def test_a_sensor_that_feels_gravity_the_wrong_way_round_is_named_and_nothing_is_ok():
    imus = [Imu(k * SECOND // 20, "deck", LEVEL, NOTHING, (0.0, 0.0, -9.81)) for k in range(100, 200)]
    messages = [("/support/imu", IMU, encode_imu(imu)) for imu in imus]
    values = one_crate(**{"support.motion": "imu", "source": "none"})
    heard, _ = serve(values, messages, {"/diagnostics": DIAGNOSTIC_ARRAY})
    said = said_of_units(heard["/diagnostics"])
    assert said
    assert OK not in {one.level for one in said}
    assert "GRAVITY_WRONG" in said[-1].message


@pytest.mark.slow
def test_a_deck_and_its_cargo_that_fall_silent_are_stale_though_no_message_comes(peer):
    values = one_crate(executor="events")
    with Child("node", without_numba(), "-m", "impact_predictor.ros.node", *arguments_of(values)) as node:
        kind = message_class(ODOMETRY)
        support, body = (peer.publisher(kind, topic, 100) for topic in ("support/odom", "crate/odom"))
        stamps = iter(range(100 * SECOND, 200 * SECOND, SECOND // 20))

        def speak():
            stamp = next(stamps)
            support.publish(encode_odometry(deck(stamp)))
            body.publish(encode_odometry(crate(stamp)))

        def until(of_node, of_unit, act):
            levels = {"impact_predictor: predictions": of_node, UNIT + "crate": of_unit}
            peer.until(lambda: levels.items() <= {one.name: one.level for one in peer.statuses()}.items(), act)

        until(OK, OK, speak)
        until(WARN, STALE, node.check)
        assert any("SUPPORT_STALE" in one.message for one in peer.statuses())
        until(OK, OK, speak)
        # Messages wait while the node is asked to end.
        for stamp in islice(stamps, 20):
            body.publish(encode_odometry(crate(stamp)))
        node.end()
        assert node.complained().count("\n") <= 3
