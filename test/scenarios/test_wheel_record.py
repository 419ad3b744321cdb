"""A rolling wheel as a bag: what stands on each topic, and that the predictor finds every impact of it."""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from records import impacts_of, samples_of

from impact_predictor.mechanics.types import Mode
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.prediction.types import Prediction
from impact_predictor.scenarios.record import REST, wheel_actor, write_record
from impact_predictor.scenarios.truth import TrueImpact
from impact_predictor.scenarios.wheel import Hub, RollEnd, Rolling, Wheel, roll

CONFIG = Path(__file__).parents[2] / "config/wheel.yaml"
SHIPPED = Wheel(Hub(inertia=0.1, friction=100.0, slope=radians(5.0)))


def scene_of(wheel: Wheel) -> Scene:
    """The shipped scene with what its comments say to change."""
    hub, shipped = wheel.hub, Scene.from_parameters(read_values(CONFIG))
    return shipped._replace(
        inertia=inertia_matrix([hub.inertia]),
        friction=hub.friction,
        normal=(sin(hub.slope), 0.0, cos(hub.slope)),
        points=tuple((x, 0.0, y) for x, y in wheel.tips),
    )


def predicted(path: Path, rolling: Rolling, rate: float = 200.0) -> tuple[list[TrueImpact], list[Prediction]]:
    """The true impacts of a bag, and the prediction of each sample."""
    write_record(path, [wheel_actor(rolling)], rate)
    predictor = Predictor(scene_of(rolling.wheel))
    return impacts_of(path), [predictor.update(sample) for sample in samples_of(path)]


def last_before(truth: TrueImpact, answers: list[Prediction]) -> Any:
    """The last touchdown that was announced before an impact."""
    return [one.touchdown for one in answers if one.touchdown is not None and one.sample.stamp < truth.stamp][-1]


def test_a_wheel_that_rocks_to_rest_is_announced_nothing_but_its_impacts(tmp_path: Path) -> None:
    rolling = roll(Wheel(Hub(inertia=1e-9, friction=100.0, slope=0.05)), 1.5, steps=None)
    truths, answers = predicted(tmp_path / "wheel.mcap", rolling, 1000.0)
    assert rolling.end is RollEnd.RESTS
    stamps = np.array([truth.stamp for truth in truths])
    announced = [one.sample.stamp + 1e9 * one.touchdown.lead_time for one in answers if one.touchdown is not None]
    # Once it moves by less than the scene's tolerance, its next spoke but one may be announced for after its rest.
    until = [stamp for stamp in announced if stamp < 1e9 * (rolling.time + REST)]
    assert len(until) > 1000
    # In ns: while it comes to rest, what its gaps bend by from sample to sample is not told from noise.
    late = [np.abs(stamps - stamp).min() for stamp in until]
    assert np.quantile(late, 0.98) < 10.0
    assert max(late) < 1000.0
    clear = [truth for truth in truths if truth.approach > 0.05]
    assert len(clear) > 10
    for truth in clear:
        touchdown = last_before(truth, answers)
        assert (touchdown.new, touchdown.mode) == (truth.new, truth.mode)
        assert touchdown.angular[1] == pytest.approx(truth.angular_after[1], rel=1e-6)
    assert answers[-1].touchdown is None


def test_the_shipped_scene_is_that_of_the_simulated_wheel() -> None:
    shipped = Scene.from_parameters(read_values(CONFIG))
    made = scene_of(SHIPPED)
    assert np.array(shipped.points) == pytest.approx(np.array(made.points), abs=1e-15)
    assert shipped.normal == pytest.approx(made.normal, abs=1e-15)
    assert shipped._replace(points=made.points, normal=made.normal) == made
    assert shipped.walking is None


@pytest.mark.parametrize("inertia", [1e-12, 1e-3, 0.1])
def test_every_impact_of_a_wheel_that_does_not_slip_is_predicted_exactly(tmp_path: Path, inertia: float) -> None:
    wheel = SHIPPED._replace(hub=SHIPPED.hub._replace(inertia=inertia))
    truths, answers = predicted(tmp_path / "wheel.mcap", roll(wheel, 0.8, steps=9))
    assert len(truths) == 9
    for number, truth in enumerate(truths, 1):
        touchdown = last_before(truth, answers)
        assert (touchdown.old, touchdown.new) == (truth.old, truth.new) == (((number - 1) % 8,), (number % 8,))
        assert touchdown.mode is truth.mode is Mode.PIVOT
        assert touchdown.before.omega == pytest.approx(truth.angular_before[1] * -1.0, rel=1e-9)
        assert touchdown.after.omega == pytest.approx(truth.angular_after[1] * -1.0, rel=1e-9)
        assert np.array(touchdown.angular) == pytest.approx(np.array(truth.angular_after), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("inertia", "friction"), [(0.1, 0.36), (0.1, 0.3), (1e-3, 0.4), (1.0, 0.18)])
def test_below_the_limit_the_predictor_says_slip_and_the_simulation_slips(
    tmp_path: Path, inertia: float, friction: float
) -> None:
    wheel = SHIPPED._replace(hub=SHIPPED.hub._replace(inertia=inertia, friction=friction))
    rolling = roll(wheel, 0.0, steps=5)
    truths, answers = predicted(tmp_path / "slips.mcap", rolling)
    for one, truth in zip(rolling.impacts, truths, strict=True):
        touchdown = last_before(truth, answers)
        assert touchdown.mode is truth.mode
        assert touchdown.mode in (Mode.PIVOT_SLIDE, Mode.SLIDE)
        # The tip that struck moves along the slope right after it, in the simulation and in the prediction.
        run = next(part.run for part in rolling.parts if one.strike in part.run.impacts)
        assert run.states(one.strike.time)[one.strike.new] in "+-"
        slip = one.strike.after.vx - one.strike.after.omega * one.strike.outcome.body.new.y  # type: ignore[union-attr]
        body = wheel.hub.body(wheel.alpha).new
        # The predictor's plane looks from the old tip to the new one, uphill too.
        assert abs(touchdown.after.vx - touchdown.after.omega * body.y) == pytest.approx(abs(slip), rel=1e-6)
        assert abs(slip) > 1e-3
