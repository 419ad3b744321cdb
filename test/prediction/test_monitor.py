"""Several bodies on one support: each message goes to the predictor, the tracker or the watch that it concerns."""

from __future__ import annotations

from math import cos, inf, nan, pi, sin
from typing import Any

import pytest

from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import Input, Scene, inputs_of, scenes_of
from impact_predictor.prediction.types import Geometry, Imu, Quaternion, Sample, Schedule, Status, Vector3, Wrench
from impact_predictor.prediction.vectors import axes_of, composed, cross, to_world
from impact_predictor.prediction.watch.watch import Level, Report

SECOND = 10**9
PERIOD = SECOND // 100
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)
NOTHING: Vector3 = (0.0, 0.0, 0.0)
ZEROS = (0.0,) * 36
HEIGHT = 0.8
BOX = [x for a in (-0.5, 0.5) for b in (-0.5, 0.5) for x in (a, b, -HEIGHT)]
CARGO: dict[str, Any] = {
    "bodies": ["crate", "blind", "leaning"],
    "body.mass": 100.0,
    "body.inertia": [20.0],
    "body.contact_points": BOX,
    "contact.friction": 0.5,
    "support.motion": "odom",
    "onset.watch": True,
    "onset.hold": 0.0,
    "place.position": [0.0, 0.0, HEIGHT],
    "blind.source": "none",
    "leaning.source": "imu",
}


def scenes(**changes: Any) -> dict[str, Scene]:
    """The scenes of the cargo; a dot in the name of a parameter is written as two underscores."""
    given = {**CARGO, **{name.replace("__", "."): value for name, value in changes.items()}}
    return scenes_of(validate({name: value for name, value in given.items() if value is not None}))


def rolled(angle: float) -> Quaternion:
    return sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle)


def state(time: int, name: str, place: Vector3, angle: float, rate: float) -> Sample:
    """What is at a place of a deck that is rolled by an angle in rad and turns at a rate in rad/s."""
    orientation, spin = rolled(angle), (rate, 0.0, 0.0)
    position, linear = to_world(axes_of(orientation), place), cross(spin, place)
    return Sample(SECOND + time * PERIOD, "world", name, position, orientation, linear, spin, ZEROS, ZEROS)


def deck(time: int, angle: float = 0.0, rate: float = 0.0, **changes: Any) -> Sample:
    """The deck at a time in 1/100 s, rolled by an angle in rad about its origin."""
    return state(time, "deck", NOTHING, angle, rate)._replace(**changes)


def standing(time: int, angle: float = 0.0, rate: float = 0.0, **changes: Any) -> Sample:
    """The crate, which stands on that deck."""
    return state(time, "crate", (0.0, 0.0, HEIGHT), angle, rate)._replace(**changes)


def tilted(time: int, orientation: Quaternion | None = LEVEL, **changes: Any) -> Imu:
    """What the sensor on the leaning body measures."""
    return Imu(SECOND + time * PERIOD, "leaning", orientation, NOTHING, (0.0, 0.0, 9.81))._replace(**changes)


def afloat(monitor: Monitor, steps: int = 60) -> int:
    """Let the deck lie level for some hundredths of a second, long enough to be known, with its cargo; the next one."""
    for time in range(steps):
        monitor.update_support(deck(time))
        if time % 5 == 0:
            monitor.update("crate", standing(time))
            monitor.update_imu("leaning", tilted(time))
    return steps


def by_body(reports: tuple[Report, ...]) -> dict[str, Report]:
    return {report.body: report for report in reports}


def test_samples_are_answered_once_the_deck_is_known_and_seen_from_it() -> None:
    monitor = Monitor(scenes())
    assert monitor.update("crate", standing(0)).status is Status.NO_SUPPORT
    answer = None
    for time in range(100):
        angle, rate = 0.1 * sin(0.01 * time), 0.1 * cos(0.01 * time)
        monitor.update_support(deck(time, angle, rate))
        if time % 5 == 0 and time:
            answer = monitor.update("crate", standing(time, angle, rate))
    assert answer is not None
    assert answer.status is Status.ACCEPTED
    assert answer.relative is not None
    # It stands still on the deck, up to rounding.
    assert answer.relative.position == pytest.approx((0.0, 0.0, HEIGHT), abs=1e-12)
    assert answer.relative.linear == pytest.approx(NOTHING, abs=1e-12)


def level_of(monitor: Monitor, body: str) -> Level:
    """The level of a body as it would be reported, whenever it was told last."""
    watch = monitor.watch
    assert watch is not None
    watch._reported = None
    return by_body(monitor.reports())[body].level


@pytest.mark.parametrize(
    ("spoil", "status"),
    [
        (lambda time: deck(time, angle=1.0), Status.SUPPORT_JUMPED),
        (lambda time: deck(time, orientation=rolled(pi)), Status.SUPPORT_JUMPED),
        (lambda time: deck(time, frame_id="map"), Status.WRONG_FRAME),
    ],
)
def test_a_support_that_cannot_be_right_leaves_no_unit_ok(spoil: Any, status: Status) -> None:
    monitor = Monitor(scenes())
    time = afloat(monitor)
    assert level_of(monitor, "blind") is Level.OK
    assert monitor.update_support(spoil(time)) is status
    for body in CARGO["bodies"]:
        assert level_of(monitor, body) is not Level.OK


def test_one_spoilt_message_takes_nothing_away_and_many_do() -> None:
    monitor = Monitor(scenes())
    time = afloat(monitor)
    nan_deck, nan_crate = {"position": (nan, 0.0, 0.0)}, {"angular": (inf, 0.0, 0.0)}
    assert monitor.update_support(deck(time, **nan_deck)) is Status.NOT_FINITE
    assert monitor.update("crate", standing(time, **nan_crate)).status is Status.NOT_FINITE
    assert monitor.update_imu("leaning", tilted(time, angular=(nan, 0.0, 0.0))) is Status.NOT_FINITE
    assert {level_of(monitor, body) for body in CARGO["bodies"]} == {Level.OK}
    for later in range(time, time + 60):
        monitor.update_support(deck(later))
        monitor.update("crate", standing(later, **nan_crate))
    assert level_of(monitor, "crate") is not Level.OK
    for later in range(time + 60, time + 120):
        monitor.update_support(deck(later, **nan_deck))
    assert level_of(monitor, "blind") is not Level.OK


def test_a_message_twice_changes_no_level() -> None:
    monitor = Monitor(scenes())
    time = afloat(monitor)
    assert monitor.update_support(deck(time - 1)) is Status.STAMP_REPEATED
    assert monitor.update_support(deck(time - 2)) is Status.STAMP_WENT_BACK
    assert monitor.update("crate", standing(time - 5)).status is Status.STAMP_REPEATED
    assert monitor.update_imu("leaning", tilted(time - 5)) is Status.STAMP_REPEATED
    assert {level_of(monitor, body) for body in CARGO["bodies"]} == {Level.OK}


def test_a_deck_that_falls_silent_is_noticed_by_the_bodies_and_by_the_clock() -> None:
    monitor = Monitor(scenes())
    time = afloat(monitor)
    later = time + 60
    for late in (later, later + 5):
        assert monitor.update("crate", standing(late)).status is Status.SUPPORT_STALE
    assert level_of(monitor, "blind") is not Level.OK

    monitor = Monitor(scenes())
    afloat(monitor)
    monitor.silent(SECOND + (time + 30) * PERIOD)
    assert level_of(monitor, "blind") is Level.OK
    monitor.silent(SECOND + later * PERIOD)
    assert level_of(monitor, "blind") is not Level.OK


@pytest.mark.parametrize("offset", [60, 100_000])
def test_a_body_whose_clock_is_ahead_is_lost_alone_however_seldom_it_is_heard(offset: int) -> None:
    monitor = Monitor(scenes())
    time = afloat(monitor)
    assert level_of(monitor, "crate") is Level.OK
    for step in range(time, time + 300):
        monitor.update_support(deck(step))
        if step % 100 == 0:
            assert monitor.update("crate", standing(step + offset)).status is Status.SUPPORT_STALE
            assert level_of(monitor, "crate") is not Level.OK
        assert level_of(monitor, "blind") is Level.OK


def test_a_body_that_is_behind_at_the_start_does_not_make_the_support_unknown_again() -> None:
    monitor = Monitor(scenes())
    for time in range(60):
        monitor.update_support(deck(time))
    assert level_of(monitor, "blind") is Level.OK
    assert monitor.update("crate", standing(15)).status is Status.NO_SUPPORT
    assert level_of(monitor, "crate") is Level.STALE
    assert level_of(monitor, "blind") is Level.OK


def test_a_body_in_a_wrong_frame_is_lost_alone() -> None:
    monitor = Monitor(scenes())
    time = afloat(monitor)
    assert monitor.update("crate", standing(time, frame_id="map")).status is Status.WRONG_FRAME
    assert level_of(monitor, "crate") is not Level.OK
    assert level_of(monitor, "blind") is Level.OK


def test_points_from_a_topic_reach_predictor_and_watch() -> None:
    monitor = Monitor(scenes(body__contact_points=None, bodies=["crate"], blind__source=None, leaning__source=None))
    for time in range(60):
        monitor.update_support(deck(time))
    assert monitor.update("crate", standing(60)).status is Status.NO_GEOMETRY
    points = tuple((BOX[i], BOX[i + 1], BOX[i + 2]) for i in range(0, len(BOX), 3))
    assert monitor.tell("crate", Geometry(0, "crate", points[:1])) is Status.TOO_FEW_POINTS
    assert monitor.tell("crate", Geometry(0, "crate", points)) is Status.ACCEPTED
    monitor.update_support(deck(61))
    assert monitor.update("crate", standing(61)).status is Status.ACCEPTED
    for time in range(62, 800):
        monitor.update_support(deck(time))
        monitor.update("crate", standing(time))
    assert level_of(monitor, "crate") is Level.OK


def test_on_a_floor_bodies_can_be_watched_too() -> None:
    monitor = Monitor(scenes(support__motion=None, gravity=[0.0, 4.0, -8.0], contact__friction=0.6))
    for time in range(0, 600, 5):
        monitor.update("crate", standing(time))
        monitor.update_imu("leaning", tilted(time))
    reports = by_body(monitor.reports())
    # Half of its weight along the floor, of 0.6 that friction holds.
    assert {report.level for report in reports.values()} == {Level.WARN}


def test_the_inputs_are_those_that_the_scenes_need() -> None:
    assert inputs_of(scenes()) == (
        Input("support/odom", "odom", None),
        Input("crate/odom", "odom", "crate"),
        Input("leaning/imu", "imu", "leaning"),
    )
    alone = scenes_of(validate({"body.mass": 1.0, "body.inertia": [1.0], "contact.friction": 0.5}))
    assert inputs_of(alone) == (Input("contact_geometry", "contact_geometry", ""), Input("odom", "odom", ""))


@pytest.mark.parametrize("heading", [0.0, 1.0, pi])
def test_a_tilt_is_that_on_the_deck_whatever_the_heading_of_the_sensors(heading: float) -> None:
    monitor = Monitor(scenes())
    for time in range(60):
        monitor.update_support(deck(time, angle=0.2))
    turned = (0.0, 0.0, sin(0.5 * heading), cos(0.5 * heading))
    # Rolled by 0.3 rad with the deck's 0.2 in it, in a world that is turned for this sensor.
    assert monitor.update_imu("leaning", tilted(60, composed(turned, rolled(0.3)))) is Status.ACCEPTED
    assert monitor.tilts["leaning"] == pytest.approx(rolled(0.1), abs=1e-12)


def test_a_tilted_body_keeps_the_heading_at_which_it_was_placed() -> None:
    monitor = Monitor(scenes(leaning__place__yaw=0.5 * pi))
    for time in range(60):
        monitor.update_support(deck(time))
    placed = (0.0, 0.0, sin(0.25 * pi), cos(0.25 * pi))
    # Pitched by 0.1 rad about its own y axis, which points against the deck's x.
    pitched = composed(placed, (0.0, sin(0.05), 0.0, cos(0.05)))
    assert monitor.update_imu("leaning", tilted(60, pitched)) is Status.ACCEPTED
    assert monitor.tilts["leaning"] == pytest.approx(pitched, abs=1e-12)


@pytest.mark.parametrize(
    ("imu", "status"),
    [
        (tilted(60, None), Status.BAD_QUATERNION),
        (tilted(60, (0.0, 0.0, 0.0, 0.0)), Status.BAD_QUATERNION),
        (tilted(60, (nan, 0.0, 0.0, 1.0)), Status.NOT_FINITE),
        (tilted(60, specific_force=(0.0, 0.0, inf)), Status.NOT_FINITE),
        (tilted(130), Status.SUPPORT_STALE),
        (tilted(60), Status.ACCEPTED),
    ],
)
def test_a_tilt_that_cannot_be_used_has_a_named_status(imu: Imu, status: Status) -> None:
    monitor = Monitor(scenes())
    for time in range(60):
        monitor.update_support(deck(time))
    assert monitor.update_imu("leaning", imu) is status
    assert ("leaning" in monitor.tilts) == (status is Status.ACCEPTED)


WALKER = {"walker.feet.names": ["left", "right"], "walker.feet.force": 30.0, "walker.feet.has_schedule": True}


def walking(**changes: Any) -> dict[str, Scene]:
    """The scenes of a crate and of a machine that walks, on a floor."""
    given = {name: CARGO[name] for name in ("body.mass", "body.inertia", "body.contact_points", "contact.friction")}
    return scenes_of(validate({**given, "bodies": ["crate", "walker"], **WALKER, **changes}))


def test_what_is_told_about_feet_goes_to_the_machine_that_has_them() -> None:
    monitor = Monitor(walking())
    feet = Geometry(SECOND, "walker", ((0.0, 0.2, -HEIGHT), (0.0, -0.2, -HEIGHT)))
    assert monitor.update("walker", standing(0, child_frame_id="walker")).status is Status.NO_GEOMETRY
    assert monitor.tell("walker", feet) is Status.ACCEPTED
    assert monitor.tell("walker", feet._replace(points=feet.points[:1])) is Status.FEET_CHANGED
    assert monitor.tell("walker", Wrench(SECOND, "left", (0.0, 0.0, 50.0))) is Status.ACCEPTED
    assert monitor.tell("walker", Schedule(SECOND, ("left",), (SECOND,), ((False,),))) is Status.ACCEPTED
    answer = monitor.update("walker", standing(0, child_frame_id="walker"))
    assert [(foot.name, foot.stands, foot.confirmed) for foot in answer.feet] == [
        ("left", True, True),
        ("right", True, None),
    ]
    assert monitor.update("crate", standing(0)).feet == ()
    assert monitor.finish() == {"crate": (), "walker": ()}


def test_the_inputs_of_feet_come_before_the_states_of_their_body() -> None:
    names = ["contact_geometry", "feet_states", "contact_wrench", "schedule", "odom"]
    names = [*[f"walker/{name}" for name in names[:4]], "crate/odom", "walker/odom"]
    assert [one.name for one in inputs_of(walking())] == names
    modelled = {"walker.robot.urdf": "robot.urdf", "walker.robot.frames": ["a", "b"], "walker.feet.force": 0.0}
    names[:3] = ["walker/joint_states"]
    assert [one.name for one in inputs_of(walking(**modelled))] == names
