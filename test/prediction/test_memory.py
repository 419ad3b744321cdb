"""That a predictor which runs for days needs no more memory than one that runs for a minute."""

import gc
import sys
from itertools import islice
from pathlib import Path

from impact_predictor.bags.read import read_messages
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.ros.messages import ODOMETRY, decode_odometry, encode_prediction
from impact_predictor.stamps import NANOSECONDS

ROOT = Path(__file__).parents[2]
SAMPLES = 1200
"""Of recorded tosses: a dozen touchdowns."""


def test_the_same_samples_again_take_no_more_memory():
    scene = scenes_of(read_values(str(ROOT / "config/cube_tosses.yaml")))[""]
    half = 0.05
    corners = tuple((x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half))
    predictor = Predictor(scene._replace(points=corners))
    messages = read_messages(ROOT / "examples/cube_tosses", {"/cube/odom": ODOMETRY})
    samples = [decode_odometry(message.data) for message in islice(messages, SAMPLES)]
    assert len(samples) == SAMPLES
    told = []

    def run(turn):
        touchdowns = 0
        for sample in samples:
            prediction = predictor.update(type(sample)(sample.stamp + turn * 1000 * NANOSECONDS, *sample[1:]))
            touchdowns += prediction.score is not None
            encode_prediction(prediction)
        told.append(touchdowns)
        return sys.getallocatedblocks()

    # CPython keeps up to 2,000 tuples of each length below 20 that are not in use any more: these are there already.
    kept = [tuple([None] * length) for length in range(1, 20) for _ in range(2000)]
    kept.clear()
    gc.disable()  # it would hide what grows until the next time that it comes
    try:
        blocks = [run(turn) for turn in range(5)]
    finally:
        gc.enable()
    assert min(told) > 12
    # The first turns fill caches: a place where these become more with every touchdown would show in the last turns.
    assert blocks[-1] - blocks[-3] < 20
