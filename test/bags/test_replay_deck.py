"""Replay of several bodies on a moving deck: what is read, what is written, and that it is what the monitor answers."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, sin
from pathlib import Path
from typing import Any

import pytest
from recordings import write_bag

from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.replay import Result, replay
from impact_predictor.mechanics.types import Mode
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.prediction.types import Imu, Quaternion, Sample, Status
from impact_predictor.prediction.vectors import axes_of, cross, to_world
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    IMU,
    ODOMETRY,
    OUTPUTS,
    decode_diagnostic_array,
    decode_imu,
    decode_odometry,
    encode_imu,
    encode_odometry,
    encode_reports,
)
from impact_predictor.scenarios.truth import (
    ONSET_TOPIC,
    TRUTH_TOPIC,
    TrueImpact,
    TrueOnset,
    encode_truth,
)

NODE = "/impact_predictor"
ZEROS = (0.0,) * 36
HEIGHT = 0.8
BOX = [x for a in (-0.5, 0.5) for b in (-0.5, 0.5) for x in (a, b, -HEIGHT)]
CARGO: dict[str, Any] = {
    "bodies": ["crate", "falling", "blind", "leaning"],
    "body.mass": 100.0,
    "body.inertia": [20.0],
    "body.contact_points": BOX,
    "contact.friction": 0.5,
    "support.motion": "odom",
    "onset.watch": True,
    "place.position": [0.0, 0.0, HEIGHT],
    "blind.source": "none",
    "leaning.source": "imu",
}
TYPES = {
    **dict.fromkeys(("/support/odom", "/crate/odom", "/falling/odom"), ODOMETRY),
    "/leaning/imu": IMU,
    TRUTH_TOPIC: DIAGNOSTIC_ARRAY,
    ONSET_TOPIC: DIAGNOSTIC_ARRAY,
    "/other/odom": ODOMETRY,
}
END = 600
"""Hundredths of a second that are recorded."""


def rolled(angle: float) -> Quaternion:
    return sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle)


def stamp_of(time: int) -> int:
    return 10**9 + time * 10**7


def aboard(time: int, name: str, lean: float = 0.0, turning: float = 0.0) -> Sample:
    """A box on the rolling deck, which leans on its starboard edge by an angle in rad, at a rate, in the world."""
    roll, rate = rolling(time)
    orientation, spin = rolled(roll + lean), (rate + turning, 0.0, 0.0)
    edge = to_world(axes_of(rolled(roll)), (0.0, -0.5, 0.0))
    arm = to_world(axes_of(orientation), (0.0, 0.5, HEIGHT))
    position = (edge[0] + arm[0], edge[1] + arm[1], edge[2] + arm[2])
    moves = [u + v for u, v in zip(cross((rate, 0.0, 0.0), edge), cross(spin, arm), strict=True)]
    axes = axes_of(orientation)
    linear = tuple(sum(a * b for a, b in zip(axis, moves, strict=True)) for axis in axes)
    return Sample(stamp_of(time), "world", f"{name}_link", position, orientation, linear, spin, ZEROS, ZEROS)  # type: ignore[arg-type]


def rolling(time: int) -> tuple[float, float]:
    """Roll (rad) and its rate (rad/s) of a deck that has half a metre per second squared along it at most."""
    return 0.05 * sin(0.008 * time), 0.05 * 0.8 * cos(0.008 * time)


def deck(time: int) -> Sample:
    roll, rate = rolling(time)
    return Sample(stamp_of(time), "world", "deck", (0.0,) * 3, rolled(roll), (0.0,) * 3, (rate, 0.0, 0.0), ZEROS, ZEROS)


def falls(time: int) -> tuple[float, float]:
    """Lean and its rate of a box that falls onto its port edge once a second, roughly as gravity lets it."""
    left = max(0.0, 0.3 - 0.01 * (time % 100))
    return 0.4 * (0.09 - (0.3 - left) ** 2) if left else 0.0, -0.8 * (0.3 - left) if left else 0.0


def recorded() -> Iterator[BagMessage]:
    for time in range(END):
        log_time = stamp_of(time)
        yield BagMessage("/support/odom", log_time, encode_odometry(deck(time)))
        if time % 5 == 0:
            yield BagMessage("/crate/odom", log_time, encode_odometry(aboard(time, "crate")))
            imu = Imu(log_time, "leaning", rolled(rolling(time)[0]), (0.0,) * 3, (0.0, 0.0, 9.81))
            yield BagMessage("/leaning/imu", log_time, encode_imu(imu))
        yield BagMessage("/falling/odom", log_time, encode_odometry(aboard(time, "falling", *falls(time))))


@pytest.fixture(scope="module")
def scenes() -> dict[str, Scene]:
    return scenes_of(validate(CARGO))


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_bag(tmp_path_factory.mktemp("cargo") / "cargo.mcap", recorded(), TYPES)


@pytest.fixture(scope="module")
def output(tmp_path_factory: pytest.TempPathFactory, bag: Path, scenes: dict[str, Scene]) -> Path:
    path = tmp_path_factory.mktemp("out") / "out.mcap"
    replay(bag, scenes, output=path, markers=True)
    return path


@pytest.fixture(scope="module")
def result(bag: Path, scenes: dict[str, Scene]) -> Result:
    return replay(bag, scenes)


def read(path: Path, topic: str) -> list[BagMessage]:
    return list(read_messages(path, {topic: topics(path)[topic]}))


def test_a_bag_gives_what_the_monitor_gives_in_the_order_of_the_recording(
    output: Path, bag: Path, scenes: dict[str, Scene]
) -> None:
    monitor = Monitor(scenes)
    expected: dict[str, list[tuple[int, bytes]]] = {topic: [] for topic in topics(output)}
    del expected[f"{NODE}/markers"]
    # The log times of a deck message and of those of its bodies are one: the deck was recorded before them.
    for topic, log_time, data in recorded():
        if topic == "/support/odom":
            monitor.update_support(decode_odometry(data))
        elif topic == "/leaning/imu":
            monitor.update_imu("leaning", decode_imu(data))
        else:
            body = topic.split("/")[1]
            prediction = monitor.update(body, decode_odometry(data))
            if prediction.status is Status.ACCEPTED:
                for name, one in OUTPUTS.items():
                    encoded = one.encode(prediction)
                    if encoded is not None:
                        expected[f"{NODE}/{body}/{name}"].append((log_time, encoded))
        if reports := monitor.reports():
            stamp = max(report.stamp for report in reports)
            data = encode_reports(reports, stamp, deck=monitor.deck_report(reports))
            expected["/diagnostics"].append((log_time, data))
    monitor.finish()
    for topic, messages in expected.items():
        assert [(message.log_time, message.data) for message in read(output, topic)] == messages, topic


def test_a_body_that_is_not_in_the_bag_is_named_and_never_ok(tmp_path: Path, scenes: dict[str, Scene]) -> None:
    others = [message for message in recorded() if message.topic != "/crate/odom"]
    path = write_bag(tmp_path / "bag.mcap", others, TYPES)
    result = replay(path, scenes, output=tmp_path / "out.mcap")
    assert result.notes == (f"{path} has no crate/odom: nothing is predicted there",)
    for message in read(tmp_path / "out.mcap", "/diagnostics"):
        crate = decode_diagnostic_array(message.data)[0]
        assert (crate.name.rpartition("/")[2], crate.level == 0) == ("crate", False)


def test_a_deck_that_is_never_accepted_leaves_nothing_to_predict(tmp_path: Path, scenes: dict[str, Scene]) -> None:
    broken = [message._replace(data=b"x") if message.topic == "/support/odom" else message for message in recorded()]
    result = replay(write_bag(tmp_path / "bag.mcap", broken, TYPES), scenes)
    assert result.inputs["support/odom"] == {Status.MALFORMED: END}
    assert "840 of 840 messages on /crate/odom, /falling/odom, /leaning/imu are NO_SUPPORT: " in result.unpredictable


def test_the_truth_is_compared_for_each_body_and_says_who_was_warned(
    tmp_path: Path, result: Result, scenes: dict[str, Scene]
) -> None:
    zero = (0.0, 0.0, 0.0)
    first, second = (settled.score.stamp for settled in result.settled[:2])

    def impact(stamp: int, body: str) -> BagMessage:
        true = TrueImpact(stamp, body, Mode.PIVOT, (0, 2), (1, 3), 0.5, 0.5, 0.1, (1.0, 0.0, 0.0), zero, zero, zero)
        return BagMessage(TRUTH_TOPIC, stamp, encode_truth(true, "deck"))

    onset = TrueOnset(stamp_of(560), "blind", slides=True, lifts=False)
    told = [
        impact(first, "falling_link"),  # by its frame
        impact(second, "falling"),  # by its name
        impact(stamp_of(250), "crate_link"),
        impact(stamp_of(590), "blind"),
        BagMessage(ONSET_TOPIC, onset.stamp, encode_truth(onset, "deck")),
    ]
    messages = sorted([*recorded(), *told], key=lambda message: message.log_time)
    known = replay(write_bag(tmp_path / "known.mcap", messages, TYPES), scenes)
    assert known.truth is not None
    assert (known.truth.touchdowns, known.truth.missed) == (3, 1)
    assert set(known.truths) == set(CARGO["bodies"])
    falling, crate = known.truths["falling"], known.truths["crate"]
    assert falling.truth is not None
    assert crate.truth is not None
    assert (falling.truth.touchdowns, falling.truth.missed, falling.truth.false) == (2, 0, 4)
    assert (crate.truth.touchdowns, crate.truth.missed, crate.truth.false) == (1, 1, 0)
    assert known.truths["blind"].truth is None
    warned = known.truths["blind"].warned
    assert warned is not None
    assert (warned.first_slide, warned.first_impact) == (stamp_of(560), stamp_of(590))
    # The slide and the impact 0.3 s after it are one event.
    assert (warned.events, warned.events_warned) == (1, 0)
    assert falling.warned is not None
    assert falling.warned.first_impact == first
    assert falling.warned.warned_ahead is not None
