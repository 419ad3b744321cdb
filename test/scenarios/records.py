"""What several tests read from a record of a made motion."""

from pathlib import Path

from impact_predictor.bags.read import read_messages
from impact_predictor.prediction.types import Sample
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, decode_odometry
from impact_predictor.scenarios.truth import TRUTH_TOPIC, TrueImpact, decode_truths


def samples_of(path: Path | str, topic: str = "/odom") -> list[Sample]:
    return [decode_odometry(message.data) for message in read_messages(path, {topic: ODOMETRY})]


def impacts_of(path: Path | str) -> list[TrueImpact]:
    messages = read_messages(path, {TRUTH_TOPIC: DIAGNOSTIC_ARRAY})
    return [impact for message in messages for impact in decode_truths(TrueImpact, message.data)]
