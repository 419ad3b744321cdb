"""What the picture of rocking bodies shows: curves, and bars while contacts are closed."""

from __future__ import annotations

from math import radians
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from matplotlib.figure import Figure

from impact_predictor.report.rocking_figure import CONTACT_COLOURS, write_rocking_figure
from impact_predictor.scenarios.rocking import Rocking, release, rocking_plate, rocking_rod


def drawn(path: Path, rockings: list[Rocking]) -> Figure:
    with patch.object(Figure, "savefig", autospec=True) as save:
        save.side_effect = lambda figure, file, **_: file.write_bytes(b"")
        write_rocking_figure(path, rockings)
    (figure, _), _ = save.call_args
    assert isinstance(figure, Figure)
    return figure


def test_curves_and_bars_are_the_motion(tmp_path: Path) -> None:
    rod = release(rocking_rod(0.4, 0.0, 0.05, 0.05, 1.0, None, None, 0.0), radians(30.0))
    rates, angles, contacts = drawn(tmp_path / "rod.png", [rod]).axes
    for axes, of in ((rates, lambda state: state.omega), (angles, lambda state: np.degrees(state.angle))):
        time, values = (np.asarray(part, float) for part in axes.lines[0].get_data())
        assert values == pytest.approx(of(rod.run.state(time)), abs=1e-12)
        assert time[-1] > rod.run.time
    first = rod.run.impacts[0].time
    bars = [(one.get_y() + 0.3, one.get_x(), one.get_width()) for one in contacts.patches]
    assert bars[0] == (0.0, 0.0, pytest.approx(first))  # it stands on A until B strikes
    assert bars[1][:2] == (1.0, pytest.approx(first))
    assert all(one.get_facecolor() == contacts.patches[0].get_facecolor() for one in contacts.patches)
    # At rest on both it stays.
    assert sorted(row for row, begin, width in bars if begin + width == pytest.approx(float(time[-1]))) == [0.0, 1.0]


def test_the_curves_go_on_until_a_little_after_the_last_motion(tmp_path: Path) -> None:
    rods = [release(rocking_rod(length, 0.0, 0.05, 0.05, 1.0, None, None, 0.0), radians(30.0)) for length in (0.4, 1.6)]
    rates = drawn(tmp_path / "rods.png", rods).axes[0]
    last = max(rod.run.time for rod in rods)
    assert last > 2.0
    for line in rates.lines[:2]:
        assert last < line.get_xdata()[-1] < 1.2 * last


def test_a_contact_that_slips_has_another_colour(tmp_path: Path) -> None:
    plate = release(rocking_plate(1.0, 1.6, None, None, 1.0, 0.05, None, 0.0), radians(10.0))
    _, _, contacts = drawn(tmp_path / "plate.svg", [plate, plate]).axes
    labels = {one.get_text() for one in contacts.get_yticklabels()}
    assert labels == {"A", "B"}
    said = contacts.get_legend_handles_labels()[1]
    assert {"contact sticks", "contact slips"} == set(said)
    assert CONTACT_COLOURS["+"] == CONTACT_COLOURS["-"] != CONTACT_COLOURS["S"]
