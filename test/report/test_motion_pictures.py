"""What the pictures of rocking bodies and of wheels show: curves, stances, impacts, and the pace of the films."""

from __future__ import annotations

from math import radians
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from impact_predictor.report.motion_pictures import (
    CONTACT_COLOURS,
    RockingScene,
    WheelScene,
    draw_rates,
    draw_wheel_rate,
    rocking_film,
    wheel_film,
    write_wheel_figure,
)
from impact_predictor.report.plot import STEP
from impact_predictor.report.simulation import rolling_sentences
from impact_predictor.scenarios.as_json import rolling_as_json
from impact_predictor.scenarios.rocking import Rocking, release, rocking_cylinder, rocking_rod
from impact_predictor.scenarios.wheel import Hub, Rolling, Wheel, roll


@pytest.fixture(scope="module")
def rod() -> Rocking:
    return release(rocking_rod(0.4, 0.0, 0.05, 0.05, 1.0, None, None, 0.0), radians(30.0))


@pytest.fixture(scope="module")
def slips() -> Rolling:
    return roll(Wheel(Hub(inertia=0.1, friction=0.35, slope=radians(5.0))), 0.0, steps=3)


@pytest.fixture(scope="module")
def stops() -> Rolling:
    return roll(Wheel(Hub(inertia=0.1, friction=100.0, slope=radians(3.0))), 1.5, steps=None)


def test_curves_are_the_motion(rod: Rocking, slips: Rolling) -> None:
    axes, other = Figure().add_subplot(), Figure().add_subplot()
    draw_rates([rod], axes)
    time, rate = (np.asarray(part, float) for part in axes.lines[0].get_data())
    assert rate == pytest.approx(rod.run.state(time).omega, abs=1e-12)
    assert time[-1] > rod.run.time
    draw_wheel_rate(slips, other)
    time, rate = (np.asarray(part, float) for part in other.lines[0].get_data())
    assert rate == pytest.approx(-slips.world(time).omega, abs=1e-12)  # positive ahead
    marked = [line.get_ydata()[0] for line in other.lines if str(line.get_label()).startswith("after an impact")]
    assert marked == [pytest.approx(-slips.impacts[0].strike.after.omega)]


def test_the_film_lasts_as_long_as_one_can_look(rod: Rocking, stops: Rolling) -> None:
    for duration in (1e-4, 0.01, 0.3, 2.0, 9.9, 40.0):
        motion = release(rod.rocker, radians(30.0), duration=duration)
        film = rocking_film([motion])
        assert 5.0 < len(film.times) * STEP < 16.0
        assert film.times[-1] >= motion.run.time
    assert wheel_film(stops).times[-1] >= stops.time


@pytest.mark.parametrize("slope", [0.0, 4.0])
@pytest.mark.parametrize("body", ["rod", "drum", "slipping rod"])
def test_a_body_is_seen_whole_wherever_it_goes(body: str, slope: float) -> None:
    rocker = rocking_rod(0.4, 0.0, 0.05, 0.05, 1.0, 0.3 if "slipping" in body else None, None, 0.0)
    if body == "drum":
        rocker = rocking_cylinder(0.3, radians(40.0), radians(40.0), 1.0, None, None, 0.0)
    rocking = release(rocker, radians(15.0), radians(slope))
    scene = RockingScene(rocking)
    for time in np.linspace(0.0, rocking.run.time, 20):
        axes = Figure().add_subplot()
        scene.draw(axes, float(time))
        corners = np.asarray(axes.patches[-1].get_path().vertices)
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        assert (corners >= (left, bottom)).all()
        assert (corners <= (right, top)).all()


def test_the_film_shows_how_contacts_stand_and_says_the_last_impact(rod: Rocking) -> None:
    (scene,) = rocking_film([rod]).scenes
    first = rod.run.impacts[0]
    shown = []
    for time in (0.5 * first.time, first.time + 1e-6, rod.run.time):
        axes = Figure().add_subplot()
        said = scene.draw(axes, time)
        shown.append((said, *[line.get_markerfacecolor() for line in axes.lines if line.get_marker() == "o"]))
    sticks, is_open = CONTACT_COLOURS["S"], CONTACT_COLOURS["O"]
    assert shown[:2] == [("", sticks, is_open), (f"impact 1: {first.outcome.mode.name}", is_open, sticks)]
    assert shown[2][0].startswith(f"impact {len(rod.run.impacts)}: ")
    assert shown[2][1:] == (sticks, sticks)


def test_the_spokes_that_are_drawn_end_where_the_standing_one_touches_the_slope(slips: Rolling) -> None:
    axes = Figure().add_subplot()
    WheelScene(slips).draw(axes, 1.5)
    state = slips.world(1.5)
    tips = np.array([line.get_xydata()[1] for line in axes.lines[:8]])
    standing = slips.stood(1.5)[0][0]
    out = np.array([np.sin(radians(5.0)), np.cos(radians(5.0))])
    assert tips[standing] @ out == pytest.approx(0.0, abs=1e-12)
    assert np.hypot(*(tips - [state.x, state.y]).T) == pytest.approx(1.0, abs=1e-12)


def test_titles_and_sentences_say_what_rolls_and_what_it_needs(slips: Rolling, stops: Rolling) -> None:
    assert WheelScene(slips).title == "A rimless wheel of 8 spokes on a slope of 5° with friction 0.35"
    assert "between them 0.375327; the wheel has 0.35" in rolling_sentences(slips)[-1]
    assert rolling_sentences(slips)[-2].startswith("Steady rolling without slip, closed form: 1.605412029 rad/s")
    assert rolling_sentences(stops)[-1].startswith("On this slope it cannot roll steadily")
    assert rolling_as_json(stops)["steady"] is None
    rests = rolling_sentences(roll(slips.wheel._replace(hub=slips.wheel.hub._replace(friction=0.2)), 0.0))
    assert ": rests, 0 steps and 0.905 m ahead" in rests[0]
    assert rests[1].startswith("Steady rolling without slip")


@pytest.mark.parametrize(("slope", "lines"), [(5.0, 2), (-5.0, 2), (3.0, 0), (40.0, 0)])
def test_steady_rolling_is_drawn_downhill_and_not_where_there_is_none(slope: float, lines: int) -> None:
    axes = Figure().add_subplot()
    draw_wheel_rate(roll(Wheel(Hub(inertia=0.1, slope=radians(slope))), steps=1), axes)
    steady = [one for one in axes.lines if one.get_label() == "steady rolling without slip"]
    rates = [float(np.asarray(one.get_ydata())[0]) for one in steady]
    assert len(rates) == lines
    assert all(rate * slope > 0.0 for rate in rates)


@pytest.mark.slow
def test_a_picture_of_any_end_is_written(tmp_path: Path, stops: Rolling) -> None:
    hub = Hub(inertia=0.1, friction=100.0)
    for number, rolling in enumerate((stops, roll(Wheel(hub), 3.3), roll(Wheel(hub), 0.0), roll(Wheel(hub), -1.0))):
        write_wheel_figure(tmp_path / f"{number}.png", rolling)
        assert (tmp_path / f"{number}.png").stat().st_size > 10_000
