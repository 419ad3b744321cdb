"""A sample, a touchdown with every field and its score, of which a test replaces what it is about."""

from impact_predictor.mechanics.types import Flag, Mode, Twist
from impact_predictor.prediction.types import Landing, Leftover, Sample, Score, SpatialTwist, Touchdown

SAMPLE = Sample(
    10**9, "world", "cube", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, (0.0,) * 36, (0.0,) * 36
)
AT_REST = SpatialTwist((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
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
    before_6d=AT_REST,
    after_6d=AT_REST,
)
SCORE = Score(
    stamp=1_004_000_000,
    touchdown=TOUCHDOWN,
    measured=Twist(0.5, 0.125, -2.0),
    relative_error=0.25,
    scored=True,
    leftover=Leftover.NONE,
    history=((0.055, 0.5), (0.01, 0.3), (0.004, 0.25)),
    announced=0.055,
)
UNSCORED = SCORE._replace(scored=False, leftover=Leftover.OUT_OF_PLANE | Leftover.ONE_CORNER_FIRST)
UNMEASURED = SCORE._replace(measured=None, relative_error=None, scored=False, leftover=Leftover.TOO_SHORT, history=())
LANDING = Landing(
    foot="left",
    stamp=2_000_000_000,
    late=-0.015,
    confirmed=True,
    history=((0.2, 0.004), (0.06, 0.002), (0.004, -0.001)),
    speed=0.25,
    impact=TOUCHDOWN,
    gap_over_speed=((0.2, -0.05), (0.06, -0.012), (0.004, -0.001)),
)
LANDED = UNMEASURED._replace(stamp=2_000_000_000, leftover=Leftover.DRIVEN, landing=LANDING, announced=0.2)
