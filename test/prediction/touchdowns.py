"""A sample and a touchdown with every field, of which a test replaces what it is about."""

from impact_predictor.mechanics.types import Flag, Mode, Twist
from impact_predictor.prediction.types import Leftover, Sample, Touchdown

SAMPLE = Sample(
    10**9, "world", "cube", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, (0.0,) * 36, (0.0,) * 36
)
TOUCHDOWN = Touchdown(
    lead_time=0.004,
    mode=Mode.PIVOT_SLIDE,
    before=Twist(1.0, -0.5, -4.0),
    after=Twist(0.75, 0.25, -3.0),
    impulses=((0.0, 0.0), (0.5, -0.125)),
    segments=("++", "O+"),
    energy_lost=0.25,
    flags=Flag.REVERSED_SLIP,
    unique=True,
    law="path",
    old=(0, 1),
    new=(2, 3),
    axis=(0.0, 1.0, 0.0),
    position=(0.0, 0.0, 0.0),
    orientation=(0.0, 0.0, 0.0, 1.0),
    linear=(0.0, 0.0, 0.0),
    angular=(0.0, 0.0, 0.0),
    half_distance=0.05,
    off_axis=0.125,
    lateral=0.0,
    closing_spread=0.001,
    offset=0.0,
    leftover=Leftover.NONE,
)
