"""What the pictures of rocking bodies and of wheels show: curves, stances, impacts, and the pace of the films."""

from __future__ import annotations

import itertools
from math import degrees, radians
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from impact_predictor.report.motion_pictures import (
    RockingScene,
    WheelScene,
    curves_of,
    rate_of,
    rocking_film,
    stance_of,
    stances,
    steady_rates,
    title_of,
    wheel_film,
    wheel_stance_of,
    wheel_stances,
    write_wheel_figure,
)
from impact_predictor.report.plot import SPEEDS
from impact_predictor.report.simulation import rolling_as_json, rolling_sentences
from impact_predictor.scenarios.rocking import Rocking, release, rocking_cylinder, rocking_rod
from impact_predictor.scenarios.wheel import Hub, Rolling, Stand, Wheel, roll

matplotlib.use("agg")


@pytest.fixture(scope="module")
def rod() -> Rocking:
    return release(rocking_rod(0.4, 0.0, 0.05, 0.05, 1.0, None, None, 0.0), radians(30.0))


@pytest.fixture(scope="module")
def slips() -> Rolling:
    return roll(Wheel(Hub(inertia=0.1, friction=0.35, slope=radians(5.0))), 0.0, steps=3)


@pytest.fixture(scope="module")
def stops() -> Rolling:
    return roll(Wheel(Hub(inertia=0.1, friction=100.0, slope=radians(3.0))), 1.5, steps=None)


def test_a_curve_is_the_motion_with_a_gap_at_each_impact(rod: Rocking) -> None:
    curve = curves_of(rod.run, end=1.1)
    gaps = np.isnan(curve.time)
    assert (np.isnan(curve.omega) == gaps).all()
    assert gaps.sum() >= len(rod.run.impacts)
    shown = ~gaps
    assert (np.diff(curve.time[shown]) >= 0.0).all()
    assert curve.time[shown][0] == 0.0
    assert (curve.time[-1], curve.omega[-1], curve.angle[-1]) == (1.1, pytest.approx(0.0, abs=1e-6), pytest.approx(0.0))
    for time, angle in zip(curve.time[shown][::100], curve.angle[shown][::100], strict=True):
        assert angle == pytest.approx(degrees(rod.run.state(float(time)).angle), abs=1e-9)
    # Right before the first impact and right after it: dense enough that the ends are those of the impact.
    first = rod.run.impacts[0]
    place = int(np.flatnonzero(gaps)[0])
    assert curve.omega[place - 1] == pytest.approx(first.before.omega, rel=1e-9)
    assert curve.omega[place + 1] == pytest.approx(first.after.omega, rel=1e-9)


@pytest.mark.parametrize(
    ("states", "stance"),
    [
        ("SO", "turns about A"),
        ("-O", "turns about A, which slips"),
        ("OS", "turns about B"),
        ("O+", "turns about B, which slips"),
        ("SS", "rests"),
        ("--", "slides on both"),
        ("OO", "flies"),
    ],
)
def test_a_stance_is_named(states: str, stance: str) -> None:
    assert stance_of(states) == stance


def test_the_stances_follow_each_other_until_the_body_rests(rod: Rocking) -> None:
    found = stances(rod.run, 1.1)
    assert [name for _, _, name in found[:3]] == ["turns about A", "turns about B", "turns about A"]
    assert found[0][:2] == (0.0, pytest.approx(rod.run.impacts[0].time))
    assert found[-1][1:] == (1.1, "rests")
    assert all(one[1] == other[0] for one, other in itertools.pairwise(found))


def test_the_film_lasts_as_long_as_one_can_look(rod: Rocking, stops: Rolling) -> None:
    for duration in (1e-4, 0.01, 0.3, 2.0, 9.9, 40.0):
        motion = release(rod.rocker, radians(30.0), duration=duration)
        film = rocking_film([motion])
        assert film.speed in SPEEDS
        assert 2 <= len(film.times) < 170
        assert film.times[-1] >= motion.run.time
    assert rocking_film([rod]).speed == 0.1
    assert wheel_film(stops).times[-1] >= stops.time


def test_a_body_is_seen_whole_wherever_it_goes(rod: Rocking) -> None:
    drum = release(rocking_cylinder(0.3, radians(40.0), radians(40.0), 1.0, None, None, 0.0), radians(15.0))
    for rocking in (rod, drum):
        scene = RockingScene(rocking)
        for time in np.linspace(0.0, rocking.run.time, 50):
            corners = np.concatenate([one.points for one in scene.outlines(float(time)) if one.face != "none"])
            # The extent is looked at in 400 moments; the names of the contacts are below them.
            assert (corners[:, 0] >= scene.low[0] - 1e-3).all()
            assert (corners <= scene.high + 1e-3).all()


def test_each_impact_flashes_where_the_body_strikes(rod: Rocking) -> None:
    (view,) = rocking_film([rod]).views
    assert len(view.flashes) == len(rod.run.impacts)
    first = view.flashes[0]
    assert first.words == f"impact 1: {rod.run.impacts[0].outcome.mode.name}"
    assert first.place == pytest.approx([0.1, 0.0], abs=1e-9)  # B, 0.1 m ahead of A, on the support
    assert view.flashes[-1].words == "impacts accumulate"


def test_the_rate_has_a_gap_at_each_impact_and_its_values_on_both_sides(slips: Rolling) -> None:
    time, rate = rate_of(slips)
    gaps = np.flatnonzero(np.isnan(time))
    assert (np.isnan(rate) == np.isnan(time)).all()
    assert len(gaps) == len(slips.impacts) + 1
    for gap, impact in zip(gaps, slips.impacts, strict=False):
        assert rate[gap - 1] == pytest.approx(-impact.strike.before.omega, rel=1e-9)
        assert rate[gap + 1] == pytest.approx(-impact.strike.after.omega, rel=1e-9)


def test_the_stances_of_a_wheel_follow_each_other_and_say_where_it_slips(slips: Rolling) -> None:
    found = wheel_stances(slips, slips.time)
    assert [wheel_stance_of(one) for one in found] == [
        "stands on a spoke",
        *["on a spoke that slips", "stands on a spoke"] * 3,
    ]
    assert [one.tips[0][0] for one in found] == [0, 1, 1, 2, 2, 3, 3]
    assert (found[0].start, found[-1].end) == (0.0, slips.time)
    assert all(one.end == other.start for one, other in itertools.pairwise(found))


def test_a_wheel_that_rests_is_shown_to_stay(stops: Rolling) -> None:
    last = wheel_stances(stops, stops.time + 1.0)[-1]
    assert (wheel_stance_of(last), last.end) == ("rests on two", stops.time + 1.0)
    assert [tip for tip, _ in last.tips] == [4, 5]


@pytest.mark.parametrize(
    ("tips", "name"),
    [(((3, "+"), (4, "+")), "slides on two"), (((3, "-"),), "on a spoke that slips"), ((), "")],
)
def test_a_stance_of_a_wheel_is_named(tips: tuple[tuple[int, str], ...], name: str) -> None:
    assert wheel_stance_of(Stand(0.0, 1.0, tips)) == name


def test_the_spokes_that_are_drawn_end_where_the_standing_one_touches_the_slope(slips: Rolling) -> None:
    state = slips.world(1.5)
    tips = np.array([one.points[1] for one in WheelScene(slips).outlines(1.5) if len(one.points) == 2])
    standing = slips.stood(1.5)[0][0]
    out = np.array([np.sin(radians(5.0)), np.cos(radians(5.0))])
    assert tips[standing] @ out == pytest.approx(0.0, abs=1e-12)
    assert np.hypot(*(tips - [state.x, state.y]).T) == pytest.approx(1.0, abs=1e-12)


def test_titles_and_sentences_say_what_rolls_and_what_it_needs(slips: Rolling, stops: Rolling) -> None:
    assert title_of(slips.wheel) == "A rimless wheel of 8 spokes with friction 0.35 on a slope of 5°"
    assert title_of(stops.wheel) == "A rimless wheel of 8 spokes that does not slip on a slope of 3°"
    assert "between them 0.375327; it has 0.35" in rolling_sentences(slips)[-1]
    assert rolling_sentences(slips)[-2].startswith(
        "Without slip it would come to steady rolling, closed form: 1.605412029 rad/s"
    )
    assert rolling_sentences(stops)[-1].startswith("On this slope it does not keep rolling")
    assert rolling_as_json(stops)["steady"] is None


def test_steady_rolling_is_drawn_downhill_and_not_where_there_is_none(slips: Rolling) -> None:
    before, after = steady_rates(slips.wheel)
    assert before > after > 1.0
    hub = slips.wheel.hub
    assert steady_rates(Wheel(hub._replace(slope=-hub.slope))) == (-before, -after)
    assert steady_rates(Wheel(hub._replace(slope=radians(3.0)))) == ()  # it stops
    assert steady_rates(Wheel(hub._replace(slope=radians(40.0)))) == ()  # no friction is enough


def test_a_wheel_that_came_to_rest_is_told_with_its_way() -> None:
    wheel = Wheel(Hub(inertia=0.1, friction=0.0, slope=radians(5.0)))
    rests = rolling_sentences(roll(wheel._replace(hub=wheel.hub._replace(friction=0.2)), 0.0))
    assert "it rests on two spokes, 0 steps and 0.905 m ahead" in rests[0]
    assert rests[1].startswith("Without slip")


@pytest.mark.slow
def test_a_picture_of_any_end_is_written(tmp_path: Path, stops: Rolling) -> None:
    hub = Hub(inertia=0.1, friction=100.0)
    for number, rolling in enumerate((stops, roll(Wheel(hub), 3.3), roll(Wheel(hub), 0.0), roll(Wheel(hub), -1.0))):
        write_wheel_figure(tmp_path / f"{number}.png", rolling)
        assert (tmp_path / f"{number}.png").stat().st_size > 10_000
