"""The watch: levels with their reasons, reports when they are due, and never OK where something is not known."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from touchdowns import SAMPLE, TOUCHDOWN

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.checks import REMEDIES
from impact_predictor.prediction.deck.forecast import LEADS, DeckOutlook
from impact_predictor.prediction.deck.motion import resting
from impact_predictor.prediction.scene import Chock, MovingDeck, Scene, Watching
from impact_predictor.prediction.types import Quaternion, Status, Touchdown, Vector3
from impact_predictor.prediction.watch.slips import NOISE
from impact_predictor.prediction.watch.standing import CONFIRMED
from impact_predictor.prediction.watch.watch import Level, Report, Watch

G = 9.81
CORNERS = tuple((x, y, z) for x in (-0.4, 0.4) for y in (-0.3, 0.3) for z in (-0.5, 0.5))
INERTIA = ((5.0, 0.0, 0.0), (0.0, 6.0, 0.0), (0.0, 0.0, 3.0))
TALL = Scene(
    mass=50.0,
    inertia=INERTIA,
    friction=0.9,
    points=CORNERS,
    place=(0.0, 0.0, 0.5),
    deck=MovingDeck(),
    source="none",
    watching=Watching(),
)
"""It tips about its port edge at a list of atan(0.3 / 0.5), and slides at one of atan(0.9)."""
DRUM = TALL._replace(points=(), radius=0.3, edges=((0.0, -0.1, 0.0), (0.0, 0.1, 0.0)), place=(0.0, 0.0, 0.28))
ODDS = "probability_30_s", "probability_hour", "maximum_hour", "peaks"
KEYS = [
    *("slide_ratio", "tip_ratio", "edge", "time_to_tip", "time_to_slide", "onset_probability"),
    *(f"{name}_{what}" for name in ("tip", "slide") for what in ODDS),
    *("energy_to_topple", "friction_seen", "tilt"),
    *("slides_per_hour", "tips_per_hour", "impacts_per_hour", "status"),
    *(f"felt{what}.{lead:g}_s" for lead in LEADS for what in ("", ".deviation")),
]
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)
ORIGIN: Vector3 = (0.0, 0.0, 0.0)
STILL: Vector3 = (0.0, 0.0, -G)


def leaning(part: float) -> Vector3:
    """What is felt on a deck that lists to port so far that this part of TALL's margin against tipping is used."""
    angle = math.atan(0.6 * part)
    return 0.0, G * math.sin(angle), -G * math.cos(angle)


class Run:
    """A watch over some bodies on a deck that does what it is told, ten times a second."""

    def __init__(self, *scenes: Scene, later: Callable[[float], Vector3] | None = None) -> None:
        self.time = 0.0
        self.looked = 0
        self.later = later
        self.felt = STILL
        self.courses: list[Callable[[float], Vector3]] = []
        self.watch = Watch({f"u{k}": scene for k, scene in enumerate(scenes)}, self.outlook)

    def outlook(self, horizon: float) -> DeckOutlook:
        self.looked += 1
        times = np.linspace(0.0, horizon, 101)
        courses = self.courses or [self.later or (lambda _: self.felt)]
        felt = np.array([[course(time) for time in times] for course in courses])
        still = np.zeros(felt.shape)
        return DeckOutlook(times=times, gravity=felt, angular=still, turning=still, is_learnt=bool(self.courses))

    @property
    def stamp(self) -> int:
        return round(self.time * 1e9)

    def deck(
        self,
        gravity: Vector3 = STILL,
        seconds: float = 0.1,
        each: Callable[[], None] | None = None,
        errors: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Let the deck tell that this is felt, until so many seconds later."""
        self.felt = gravity
        support = resting(gravity)
        for _ in range(round(seconds * 10)):
            self.time = round(self.time + 0.1, 1)
            self.watch.update_support(support._replace(stamp=self.stamp), errors)
            if each is not None:
                each()

    def see(
        self,
        position: Vector3 = (0.0, 0.0, 0.5),
        rotation: Rotation | None = None,
        touchdown: Touchdown | None = None,
        angular: Vector3 = ORIGIN,
        times: int = 1,
    ) -> None:
        orientation = tuple((rotation or Rotation.identity()).as_quat())
        sample = SAMPLE._replace(stamp=self.stamp, position=position, orientation=orientation, angular=angular)
        for _ in range(times):
            self.watch.update_body("u0", sample, touchdown)

    def rocks(self, angle: float, times: int = CONFIRMED, **changes: Any) -> float:
        """Let the first body turn about its port edge; the height of its mass centre then."""
        rotation = Rotation.from_euler("x", -angle)
        _, y, z = rotation.apply((0.0, 0.3, -0.5)).tolist()
        self.see((0.0, 0.3 - y, -z), rotation, times=times, **changes)
        return -z

    def reports(self) -> tuple[Report, ...]:
        return self.watch.reports()

    def report(self) -> Report:
        """What is said of the first body once the next second is over, whatever was said of it already."""
        self.reports()
        self.watch._reported = None
        return self.reports()[0]


def touchdown(lead_time: float) -> Touchdown:
    return TOUCHDOWN._replace(lead_time=lead_time, mode=Mode.PIVOT)


def listing(degrees: float) -> Vector3:
    return 0.0, G * math.sin(math.radians(degrees)), -G * math.cos(math.radians(degrees))


def test_friction_is_between_the_highest_list_on_which_a_unit_held_and_the_lowest_on_which_it_slid() -> None:
    run = Run(TALL._replace(source="odom"))
    # Of a size of 0.77 m, 4 times 5 mm are not seen, which half a second of 0.016 g makes.
    ten, twelve, fourteen = [math.tan(math.radians(degrees)) for degrees in (10.0, 12.0, 14.0)]
    unseen = 8.0 * 0.02 / 9.80665 + NOISE
    run.deck(each=run.see)
    assert run.report().values["friction_seen"] == "unknown"
    for degrees in (4.0, 10.0, 0.0):
        run.deck(listing(degrees), 3.0, run.see)
    assert run.report().values["friction_seen"] == f"above {ten - unseen:.3f}"
    run.deck(listing(14.0), 0.5, run.see)
    run.deck(listing(14.0), 0.5, lambda: run.see((0.0, 0.1, 0.5)))
    assert run.watch.friction_seen()["u0"] == pytest.approx((ten - unseen, fourteen + NOISE))
    run.deck(listing(12.0), 4.5, lambda: run.see((0.0, 0.1, 0.5)))
    assert run.watch.friction_seen()["u0"] == pytest.approx((twelve - unseen, fourteen + NOISE))
    assert run.report().values["friction_seen"] == f"{twelve - unseen:.3f} to {fourteen + NOISE:.3f}"


def test_nothing_is_seen_of_the_friction_of_a_unit_that_more_holds_or_that_is_not_measured() -> None:
    chock = Chock((0.0, 0.3, 0.1), (0.0, -1.0, 0.0))
    for scene in (TALL, TALL._replace(source="odom", chocks=(chock,))):
        run = Run(scene)
        run.deck(listing(10.0), 4.0, run.see if scene.source == "odom" else None)
        assert run.report().values["friction_seen"] == "unknown"


def test_a_band_of_friction_has_the_margin_of_both_ends_and_is_told_where_the_lowest_does_not_do() -> None:
    run = Run(TALL._replace(friction_band=(0.2, 1.8)))
    run.deck((0.0, 0.45 * G, -G))
    report = run.report()
    assert report.values["slide_ratio"] == "0.500"
    assert report.values["slide_ratio_band"] == "0.250 to 2.250"
    assert report.message.endswith("slides if friction is 0.2")
    run.deck((0.0, 0.09 * G, -G))
    assert not run.report().message.endswith("slides if friction is 0.2")


def test_a_unit_without_a_sensor_is_watched_by_the_motion_of_the_deck_alone() -> None:
    run = Run(TALL)
    run.deck(leaning(0.3))
    (report,) = run.reports()
    assert (report.body, report.stamp, report.level) == ("u0", 100_000_000, Level.OK)
    assert report.message == "tipping about its port edge: 0.30 of the margin used; sliding: 0.20"
    assert list(report.values) == KEYS
    assert report.values["tip_ratio"] == "0.300"
    assert report.values["slide_ratio"] == "0.200"
    assert report.values["edge"] == "port"
    assert report.values["time_to_tip"] == "inf"
    assert report.values["tilt"] == "unknown"
    assert report.values["impacts_per_hour"] == "unknown"
    assert report.values["status"] == "ACCEPTED"


def test_the_message_says_what_was_exceeded_by_how_much_and_where() -> None:
    run = Run(TALL)
    run.deck(leaning(1.08))
    report = run.report()
    assert report.level == Level.ERROR
    assert report.message == "tips about its port edge: 1.08 of the margin used; near sliding: 0.72"
    run = Run(TALL._replace(friction=0.3))
    run.deck(leaning(0.6))
    assert run.report().message == "slides: 1.20 of the margin used; tipping about its port edge: 0.60"
    run = Run(DRUM)
    run.deck((0.0, -0.5 * G, -G))
    assert run.report().message.startswith("rolls over its starboard edge: 1.4")


def test_reports_come_once_in_a_second_and_at_once_when_a_level_changes() -> None:
    run = Run(TALL, TALL._replace(friction=0.3))
    told: list[tuple[float, int, Level]] = []

    def each() -> None:
        found = run.reports()
        assert run.reports() == ()
        if found:
            told.append((run.time, len(found), found[1].level))

    run.deck(leaning(0.1), 2.5, each)
    assert told == [(0.1, 2, Level.OK), (1.0, 2, Level.OK), (2.0, 2, Level.OK)]
    told.clear()
    run.deck(leaning(0.4), 0.5, each)
    assert told == [(2.6, 2, Level.WARN), (3.0, 2, Level.WARN)]
    told.clear()
    run.deck(leaning(0.6), 0.2, each)
    assert told == [(3.1, 2, Level.ERROR)]


def test_a_level_that_is_held_says_why_it_was_raised_and_when() -> None:
    run = Run(TALL)
    run.deck(leaning(1.02))
    run.deck(leaning(1.3))
    run.deck(leaning(0.2), 2.0)
    report = run.report()
    assert report.level == Level.ERROR
    assert report.message == (
        "tipping about its port edge: 0.20 of the margin used; sliding: 0.13 "
        "(2.0 s ago: tips about its port edge: 1.30 of the margin used; near sliding: 0.87)"
    )
    run.deck(leaning(0.2), 3.5)
    assert run.report().level == Level.OK


def test_noise_about_a_threshold_does_not_make_a_unit_flicker() -> None:
    rng = np.random.default_rng(1)
    for part in (0.7, 1.0):
        run, levels = Run(TALL), []
        for _ in range(400):
            run.deck(leaning(part + rng.normal(0.0, 0.03)))
            levels.append(run.report().level)
        assert sum(a != b for a, b in pairwise(levels)) <= 2


def test_an_onset_ahead_within_the_horizon_warns_and_says_when() -> None:
    near = TALL._replace(watching=Watching(horizon=1.5))
    run = Run(TALL, near, later=lambda time: leaning(0.2 + 0.4 * time))
    run.deck(leaning(0.2))
    report, beyond = run.reports()
    assert report.level == Level.WARN
    assert report.message.startswith("tips in 2.0 s if the deck goes on so (100% likely); ")
    assert report.values["time_to_tip"] == "2.00"
    assert report.values["time_to_slide"] == "3.25"
    assert (beyond.level, beyond.values["time_to_tip"]) == (Level.OK, "inf")
    run.deck(leaning(0.2))
    assert run.report().values["time_to_tip"] == "1.90"


@pytest.mark.parametrize(
    ("tipping", "level"), [(3, Level.OK), (4, Level.WARN), (10, Level.WARN)], ids=["unlikely", "likely", "sure"]
)
def test_once_the_sea_is_learnt_the_part_of_the_courses_that_tip_warns(tipping: int, level: Level) -> None:
    run = Run(TALL._replace(watching=Watching(vain=0.6)))
    run.courses = [lambda t, k=k: leaning(0.8 + (0.05 * t if k < tipping else 0.0)) for k in range(10)]
    run.deck(leaning(0.8))  # above onset.warn, which says nothing any more
    report = run.report()
    assert (report.level, report.values["onset_probability"]) == (level, f"{tipping / 10:.2f}")
    assert report.values["time_to_tip"] == ("4.00" if level else "inf")


@pytest.mark.parametrize(("seconds", "level"), [(2.5, Level.WARN), (3.5, Level.OK)])
def test_an_onset_that_is_close_is_warned_of_where_it_is_a_fifth_as_likely(seconds: float, level: Level) -> None:
    run = Run(TALL._replace(watching=Watching(vain=0.5)))
    run.courses = [lambda t, k=k: leaning(0.5 + (0.5 * t / seconds if k < 1 else 0.0)) for k in range(10)]
    run.deck(leaning(0.5))
    assert run.report().level == level


def test_a_unit_tells_what_it_will_feel_where_it_stands_and_how_unsure_that_is() -> None:
    times = np.linspace(0.0, 15.0, 61)
    gravity, still = np.tile(STILL, (2, len(times), 1)), np.zeros((2, len(times), 3))
    gravity[:, :, 1] += times / 10.0 * np.array([[0.9], [1.1]])
    turning = still + np.array([0.2, 0.0, 0.0])
    ahead = DeckOutlook(times=times, gravity=gravity, angular=still, turning=turning, is_learnt=True)
    watch = Watch({"u": TALL._replace(place=(5.0, 3.0, 0.5))}, lambda _: ahead)
    watch.update_support(resting(STILL)._replace(stamp=10**9))
    (report,) = watch.reports()
    told = {name: [float(one) for one in report.values[name].split()] for name in ("felt.5_s", "felt.deviation.5_s")}
    # Above the axis it turns about it is pushed to port, and the deck to port of that falls away under it.
    assert told["felt.5_s"] == pytest.approx([0.0, 0.5 + 0.2 * 0.5, -G - 0.2 * 3.0], abs=1e-3)
    assert told["felt.deviation.5_s"] == pytest.approx([0.0, 0.05, 0.0], abs=1e-3)


def test_an_onset_that_is_near_and_likelier_than_not_is_an_error() -> None:
    run = Run(TALL, TALL._replace(watching=Watching(horizon=0.5)))
    run.courses = [lambda t, k=k: leaning(0.2 + (t if k < 6 else 0.0)) for k in range(10)]
    run.deck(leaning(0.2))
    near, beyond = run.reports()
    assert near.level == Level.ERROR
    assert beyond.level == Level.OK
    run.courses = [lambda t: leaning(0.2 + 0.4 * t)] * 10
    run.deck(leaning(0.2), 6.0)  # longer than a level is held
    assert run.report().level == Level.WARN


def test_noise_of_an_angular_acceleration_counts_by_how_far_away_a_unit_stands() -> None:
    run = Run(TALL, TALL._replace(place=(16.0, 0.0, 0.5)))
    run.courses = [lambda t: leaning(0.5)]
    run.deck(leaning(1.1), errors=(0.0, 0.03))
    assert [report.level for report in run.reports()] == [Level.ERROR, Level.OK]


def test_a_warning_stands_while_any_course_has_an_onset() -> None:
    run = Run(TALL._replace(watching=Watching(vain=0.4, hold=1.0)))
    for tipping, level in ((12, Level.WARN), (1, Level.WARN), (0, Level.OK), (11, Level.OK)):
        run.courses = [lambda t, k=k, n=tipping: leaning(0.5 + (0.1 * t if k < n else 0.0)) for k in range(20)]
        run.deck(leaning(0.5), 2.0)
        assert run.report().level == level


def test_each_body_has_its_own_thresholds() -> None:
    strict, loose = Watching(warn=0.2, error=0.3), Watching(warn=0.9, error=1.2)
    run = Run(*(TALL._replace(watching=watching) for watching in (Watching(), strict, loose)))
    for part, levels in ((0.4, [Level.OK, Level.ERROR, Level.OK]), (1.1, [Level.ERROR, Level.ERROR, Level.WARN])):
        run.deck(leaning(part))
        assert [report.level for report in run.reports()] == levels


@pytest.mark.parametrize("status", [status for status in Status if status is not Status.ACCEPTED])
def test_no_fault_of_the_support_is_ever_ok(status: Status) -> None:
    run = Run(TALL)
    run.deck(leaning(0.1), 3.0)
    assert run.report().level == Level.OK
    run.reports()
    run.watch.support_lost(status, run.stamp + 1)
    (report,) = run.reports()  # at once
    assert report.level in (Level.ERROR, Level.STALE)
    assert report.message == f"{status.name}: {REMEDIES[status]}"
    assert report.values["status"] == status.name
    assert report.values["tip_ratio"] == "unknown"
    run.watch.support_lost(status, run.stamp + 60_000_000_000)
    assert run.reports()[0].level == report.level


@pytest.mark.parametrize("status", [status for status in Status if status is not Status.ACCEPTED])
def test_no_fault_of_a_body_is_ever_ok(status: Status) -> None:
    run = Run(TALL._replace(source="odom"), TALL)
    run.deck()
    run.see()
    run.deck(STILL, 6.0, run.see)
    assert run.report().level == Level.OK
    run.watch.body_lost("u0", status, run.stamp)
    report, other = run.reports()
    assert report.level in (Level.ERROR, Level.STALE)
    assert report.message.startswith(f"{status.name}: {REMEDIES[status]}")
    assert other.level == Level.OK
    run.deck(STILL, 20.0)
    assert run.report().level in (Level.ERROR, Level.STALE)
    run.see()
    run.deck(STILL, 6.0, run.see)
    assert run.report().level == Level.OK


@pytest.mark.parametrize("source", ["odom", "imu"])
def test_a_measured_unit_is_stale_until_it_is_heard_and_when_it_falls_silent(source: str) -> None:
    run = Run(TALL._replace(source=source))
    hear = run.see if source == "odom" else lambda: run.watch.update_tilt("u0", run.stamp, LEVEL)
    run.deck(STILL, 8.0)
    report = run.report()
    assert report.level == Level.STALE
    assert report.message.startswith("BODY_STALE: ")
    assert report.values["tip_ratio"] == "0.000"  # the deck is known, and the unit taken to stand where it is placed
    hear()
    run.deck(STILL, 6.0, hear)
    for silent, level in ((0.0, Level.OK), (0.5, Level.OK), (0.2, Level.STALE)):
        run.deck(STILL, silent)
        assert run.report().level == level


def test_what_becomes_known_for_the_first_time_is_not_held_as_stale() -> None:
    run = Run(TALL._replace(source="odom"))
    assert run.reports() == ()  # no stamp is known
    for _ in range(2):
        run.time = 0.0  # then time begins anew
        # A body is not called silent while it is the support that is not known.
        run.watch.support_lost(Status.NO_SUPPORT, 1)
        report = run.report()
        assert (report.level, report.message[:10]) == (Level.STALE, "NO_SUPPORT")
        run.deck()
        report = run.report()
        assert (report.level, report.message[:10]) == (Level.STALE, "BODY_STALE")
        run.see()
        run.deck()
        assert run.report().level == Level.OK
        run.deck(STILL, 100.0, each=run.see)
    run.watch.support_lost(Status.SUPPORT_STALE, run.stamp)
    run.deck(each=run.see)
    assert run.report().level == Level.STALE


def test_something_wrong_is_told_though_nothing_is_known_besides() -> None:
    run = Run(TALL._replace(source="odom"))
    run.deck(leaning(1.1))
    report = run.report()
    assert report.level == Level.ERROR
    assert "BODY_STALE" in report.message
    assert "tips about its port edge: 1.10" in report.message


def test_a_unit_whose_points_are_not_known_yet_is_stale_until_they_are() -> None:
    run = Run(TALL._replace(points=()))
    run.deck()
    report = run.report()
    assert report.level == Level.STALE
    assert report.message.startswith("NO_GEOMETRY")
    run.watch.set_points("u0", CORNERS)
    run.deck(leaning(0.3), 6.0)
    assert run.report().values["tip_ratio"] == "0.300"
    assert run.report().level == Level.OK


def test_a_unit_on_one_point_is_an_error() -> None:
    run = Run(TALL._replace(points=((0.0, 0.0, -0.5), (0.0, 0.0, 0.5))))
    run.deck()
    assert run.report().level == Level.ERROR
    assert "stands on a single point" in run.report().message


def test_a_unit_that_rocks_is_an_error_at_once_and_says_what_is_missing_to_topple() -> None:
    run = Run(TALL._replace(source="odom"))
    run.see()
    run.deck(STILL, 6.0, run.see)
    run.reports()
    high = run.rocks(0.2)
    (report,) = run.reports()
    assert report.level == Level.ERROR
    # m g (R - z) over the port edge.
    missing = 50.0 * G * (math.hypot(0.3, 0.5) - high)
    assert report.message.startswith(
        f"rocks, tilted by 11.5 degrees, {missing:.3g} J short of toppling over its port edge; "
    )
    assert float(report.values["energy_to_topple"]) == pytest.approx(missing, abs=1e-3)
    assert report.values["tilt"] == "0.2000"
    fast = math.sqrt(2.2 * missing / 5.0)
    run.rocks(0.2, times=1, angular=(-fast, 0.0, 0.0))
    report = run.report()
    assert "would topple over its port edge if the deck stayed so" in report.message
    assert float(report.values["energy_to_topple"]) == 0.0


def test_a_unit_that_slides_lifts_or_has_toppled_is_an_error() -> None:
    run = Run(TALL._replace(source="odom"))
    run.deck()
    run.see()
    run.deck(STILL, 6.0, run.see)
    run.see((0.0, 0.05, 0.5), times=CONFIRMED)
    assert run.report().level == Level.ERROR
    assert "slides to port, by 0.050 m; " in run.report().message
    run.deck(STILL, 1.0, lambda: run.see((0.0, 0.05, 0.5)))
    assert "s ago: slides to port" in run.report().message
    run.deck(STILL, 6.0, lambda: run.see((0.0, 0.05, 0.5)))
    assert run.report().level == Level.OK
    run.see((0.0, 0.05, 0.7), times=CONFIRMED)
    assert run.report().level == Level.ERROR
    assert run.report().message.startswith("is off the deck")
    run.deck(STILL, 6.0, lambda: run.see((0.0, 0.8, 0.3), Rotation.from_euler("x", -90, degrees=True)))
    report = run.report()
    assert report.level == Level.ERROR
    assert report.message.startswith("has toppled: it lies on another side")


def test_a_touchdown_ahead_of_a_unit_that_rocks_is_told_with_its_mode_and_when() -> None:
    run = Run(TALL._replace(source="odom"))
    run.deck()
    run.see()
    run.rocks(0.1, touchdown=touchdown(0.12))
    assert "; strikes in 0.12 s: PIVOT; " in run.report().message
    run.deck(STILL, 0.2)
    assert "strikes" not in run.report().message.split(" (")[0]


def test_a_touchdown_that_noise_announces_for_a_unit_that_stands_raises_nothing() -> None:
    run = Run(TALL._replace(source="odom"))
    run.deck()
    for _ in range(20):
        run.see(touchdown=touchdown(0.02))
        run.deck()
    report = run.report()
    assert report.level == Level.OK
    assert report.values["impacts_per_hour"] == "0.0"


def test_impacts_are_counted_when_an_announced_touchdown_has_come_to_pass() -> None:
    run = Run(TALL._replace(source="odom"))
    run.deck()
    for _ in range(3):
        for lead_time in (0.25, 0.15, 0.05):  # one touchdown, announced again and again
            run.rocks(0.1, touchdown=touchdown(lead_time))
            run.deck()
        run.see()
        run.deck()
    run.rocks(0.1, touchdown=touchdown(0.25))  # one that does not come
    run.deck()
    run.see()
    run.deck()
    run.see()
    assert run.report().values["impacts_per_hour"] == "180.0"  # 3 in less than a minute


def test_onsets_are_counted_once_for_each_crossing_of_one() -> None:
    run = Run(TALL)
    run.deck(STILL, 100.0)
    for _ in range(4):
        run.deck(leaning(1.1))
        run.deck(leaning(0.95))  # within the hysteresis: not yet below
        run.deck(leaning(1.1))
        run.deck(leaning(0.5))
    run.deck(leaning(1.6))  # both
    run.deck(STILL, 98.4)
    report = run.report()
    # 5 tips and a slide in 200 s between the first and the last message
    assert float(report.values["tips_per_hour"]) == pytest.approx(90.0, abs=0.1)
    assert float(report.values["slides_per_hour"]) == pytest.approx(18.0, abs=0.1)


def test_an_imu_gives_the_tilt_and_the_edge() -> None:
    run = Run(TALL._replace(source="imu"))
    run.deck()
    x, y, z, w = Rotation.from_euler("x", -0.1).as_quat()
    run.watch.update_tilt("u0", run.stamp, (x, y, z, w))
    report = run.report()
    assert report.level == Level.ERROR
    assert report.message.startswith("rocks, tilted by 5.7 degrees")
    assert report.values["tilt"] == "0.1000"
    assert report.values["impacts_per_hour"] == "unknown"


def test_time_that_begins_anew_is_followed() -> None:
    run = Run(TALL)
    run.deck(leaning(1.1), 100.0)
    run.time = 0.0
    run.deck(leaning(0.1), 6.0)
    report = run.report()
    assert report.stamp == 6_000_000_000
    assert report.level == Level.OK


def test_values_are_plain_numbers_and_names_whatever_happens() -> None:
    run = Run(TALL, DRUM, TALL._replace(source="odom"), TALL._replace(points=()))
    for gravity in (STILL, (0.0, 0.0, 0.0), (99.0, 0.0, 5.0), leaning(2.0)):
        run.deck(gravity)
        for report in run.reports():
            assert list(report.values) == KEYS
            assert "nan" not in "".join(report.values.values())
            assert report.message
