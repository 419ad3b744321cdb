"""The gait diagram: what stands in it, for short records and long ones, with a truth and without."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

import matplotlib
import pytest
import touchdowns

from impact_predictor.bags.body import Gait
from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.scene import Walking
from impact_predictor.prediction.types import Foot, Prediction, Sample, Status
from impact_predictor.report.gait import FootLandings, feet_of, write_gait
from impact_predictor.report.touchdowns import TouchdownRow, row_of

SECOND = 10**9
STILL = (0.0, 0.0, 0.0)
LANDING = row_of("base", touchdowns.LANDED)._replace(mode=Mode.STOP)


def machine(
    name: str,
    seconds: int,
    *,
    error: float | None = 0.001,
    speed: float = 0.2,
    truth: bool = False,
    start: int = 0,
) -> list[FootLandings]:
    """Two feet that stand in turn, 0.5 s each, ten samples a second, announced by an error in s too late."""
    gait, landings = Gait(Walking(("left", "right"))), list[TouchdownRow]()
    for k in range(10 * seconds + 1):
        stamp = start + k * SECOND // 10
        half = k // 5 * SECOND // 2 + start
        stands = (k // 5 % 2 == 0, k // 5 % 2 == 1)
        feet = tuple(Foot(name, on, half, 0.0, 0.0) for name, on in zip(gait.feet, stands, strict=True))
        sample = Sample(stamp, "world", "base", STILL, (0.0, 0.0, 0.0, 1.0), STILL, STILL, (0.0,) * 36, (0.0,) * 36)
        gait.take(Prediction(Status.ACCEPTED, sample, feet=feet))
        if truth:
            gait.tell(stamp, stands)
        if k % 5 == 0 and k:
            foot = gait.feet[k // 5 % 2]
            landings.append(LANDING._replace(foot=foot, stamp=stamp, time_errors=(error, error), landing_speed=speed))
    return feet_of(name, gait, [one._replace(impulse=(40.0 * speed, 0.0)) for one in landings])


def texts(path: Path, *machines: list[FootLandings]) -> list[str]:
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        write_gait(path, [foot for feet in machines for foot in feet], "walk.bag")
    return [unescape(text) for text in re.findall(r"<text[^>]*>([^<]*)</text>", path.read_text())]


def test_it_says_how_well_landings_were_predicted_and_names_the_feet(tmp_path: Path) -> None:
    told = texts(tmp_path / "gait.svg", machine("walk.bag", 6, truth=True, start=7 * SECOND))
    title = "walk.bag: 12 landings, 12 predicted 50 ms ahead, half of them within 1.0 ms, 90 % within 1.0 ms"
    assert {title, "left", "right", "When each foot stands", "stands, as the record tells"} <= set(told)
    assert any("true time" in text for text in told)
    assert "no error: the record tells a landing up to one sample (100 ms) late" in told


def test_without_a_truth_errors_are_those_against_the_inferred_landings(tmp_path: Path) -> None:
    told = texts(tmp_path / "gait.svg", machine("walk.bag", 6, error=-0.002))
    assert "walk.bag: 12 landings, 12 predicted 50 ms ahead, half of them within 2.0 ms, 90 % within 2.0 ms" in told
    assert any("inferred time" in text for text in told)
    assert not any("the record tells" in text for text in told)


def test_landings_that_nobody_announced_are_said(tmp_path: Path) -> None:
    told = texts(tmp_path / "gait.svg", machine("walk.bag", 3, error=None))
    assert "walk.bag: 6 landings, none predicted 50 ms ahead" in told


def test_feet_of_several_machines_have_their_names(tmp_path: Path) -> None:
    told = texts(tmp_path / "gait.svg", *[machine(f"{name}.bag", 2) for name in "abc"])
    assert {"a.bag left", "c.bag right"} <= set(told)


@pytest.mark.parametrize("feet", [[], feet_of("", Gait(Walking(("left", "right"))), ()), machine("stands.bag", 0)])
def test_a_record_without_a_landing_makes_a_picture_without_a_warning(
    tmp_path: Path, feet: list[FootLandings], recwarn: pytest.WarningsRecorder
) -> None:
    write_gait(tmp_path / "gait.png", feet, "stands.bag")
    assert (tmp_path / "gait.png").stat().st_size > 5_000
    assert not recwarn.list
