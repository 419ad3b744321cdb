"""What the pictures of a motion show: its curves, how it stands on its contacts, and the pace of the moving one."""

from __future__ import annotations

import itertools
from math import degrees, radians
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.report.motions.animation import SPEEDS, speed_of, times_of
from impact_predictor.report.motions.figure import curve_of, stance_of, stances
from impact_predictor.report.motions.stage import Stage, placed
from impact_predictor.report.whole import whole
from impact_predictor.scenarios.rocking import Rocking, release, rocking_cylinder, rocking_rod

matplotlib.use("agg")


@pytest.fixture(scope="module")
def rod() -> Rocking:
    return release(rocking_rod(0.4, 0.0, 0.05, 0.05, 1.0, None, None, 0.0), radians(30.0))


def test_a_curve_is_the_motion_with_a_gap_at_each_impact(rod: Rocking) -> None:
    curve = curve_of(rod.run, end=1.1)
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


def test_the_moving_picture_lasts_as_long_as_one_can_look(rod: Rocking) -> None:
    for duration in (1e-4, 0.01, 0.3, 2.0, 9.9, 40.0):
        motion = release(rod.rocker, radians(30.0), duration=duration)
        times = times_of([motion])
        assert speed_of([motion]) in SPEEDS
        assert 2 <= len(times) < 170
        assert times[-1] >= motion.run.time
    assert speed_of([rod]) == 0.1


def test_a_body_is_seen_whole_wherever_it_goes(rod: Rocking) -> None:
    from matplotlib.figure import Figure

    drum = release(rocking_cylinder(0.3, radians(40.0), radians(40.0), 1.0, None, None, 0.0), radians(15.0))
    for rocking in (rod, drum):
        stage = Stage(Figure().add_subplot(), rocking, 0.1)
        low, high = stage.extent()
        reach = max(np.hypot(x, y) for x, y in rocking.rocker.outline or [(0.3, 0.0)])
        for time in np.linspace(0.0, rocking.run.time, 50):
            state = rocking.run.state(float(time))
            stage.show(float(time))
            if rocking.rocker.outline:
                corners = placed(np.array(rocking.rocker.outline), state)
            else:
                corners = np.array([(state.x - reach, state.y), (state.x + reach, state.y + reach)])
            # The extent is looked at in 400 moments.
            assert (corners >= low - 1e-3).all()
            assert (corners <= high + 1e-3).all()


def test_a_file_that_fails_is_not_there_and_an_older_one_stays(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("older")

    def fail(error: BaseException) -> None:
        with whole(path) as partial:
            assert partial == tmp_path / "file.partial"
            partial.write_text("half")
            raise error

    with pytest.raises(KeyboardInterrupt):
        fail(KeyboardInterrupt())
    with pytest.raises(InputError, match="file cannot be written: No space left"):
        fail(OSError(28, "No space left on device"))
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [("file", "older")]
    with whole(path) as partial:
        partial.write_text("newer")
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [("file", "newer")]
