"""The recorded deck of a vessel: `read_vessel`."""

from __future__ import annotations

from pathlib import Path

from impact_predictor.bags.read import read_messages
from impact_predictor.prediction.types import Imu, Sample
from impact_predictor.ros.messages import IMU, ODOMETRY, decode_imu, decode_odometry

BAG = Path(__file__).parents[2] / "examples/vessel_deck"


def read_vessel() -> list[tuple[Sample, Imu]]:
    """Poses with twists, and what the sensor measured at the same stamps."""
    samples, sensed = [], []
    for topic, _, data in read_messages(BAG, {"/deck/odom": ODOMETRY, "/deck/imu": IMU}):
        if topic == "/deck/odom":
            samples.append(decode_odometry(data))
        else:
            sensed.append(decode_imu(data))
    assert [sample.stamp for sample in samples] == [imu.stamp for imu in sensed]
    assert len(samples) == 3686
    return list(zip(samples, sensed, strict=True))
