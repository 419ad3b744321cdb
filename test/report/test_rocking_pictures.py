"""What the pictures of a motion show: its curves, how it stands on its contacts, and the pace of the moving one."""

from __future__ import annotations

import itertools
from math import degrees, radians

import matplotlib
import numpy as np
import pytest

from impact_predictor.report.film import SPEEDS
from impact_predictor.report.rocking_pictures import RockingScene, curves_of, rocking_film, stance_of, stances
from impact_predictor.scenarios.rocking import Rocking, release, rocking_cylinder, rocking_rod

matplotlib.use("agg")


@pytest.fixture(scope="module")
def rod() -> Rocking:
    return release(rocking_rod(0.4, 0.0, 0.05, 0.05, 1.0, None, None, 0.0), radians(30.0))


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


def test_the_film_lasts_as_long_as_one_can_look(rod: Rocking) -> None:
    for duration in (1e-4, 0.01, 0.3, 2.0, 9.9, 40.0):
        motion = release(rod.rocker, radians(30.0), duration=duration)
        film = rocking_film([motion])
        assert film.speed in SPEEDS
        assert 2 <= len(film.times) < 170
        assert film.times[-1] >= motion.run.time
    assert rocking_film([rod]).speed == 0.1


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
    (view,) = rocking_film([rod]).rows[0]
    assert len(view.flashes) == len(rod.run.impacts)
    first = view.flashes[0]
    assert first.words == f"impact 1: {rod.run.impacts[0].outcome.mode.name}"
    assert first.place == pytest.approx([0.1, 0.0], abs=1e-9)  # B, 0.1 m ahead of A, on the support
    assert view.flashes[-1].words == "impacts accumulate"
