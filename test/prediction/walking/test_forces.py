"""Whether sensors of force agree that a foot stands."""

from __future__ import annotations

from impact_predictor.prediction.scene import Walking
from impact_predictor.prediction.types import Status, Wrench
from impact_predictor.prediction.walking.forces import FootForces

SECOND = 10**9


def test_a_force_that_comes_late_is_refused_and_after_a_clock_that_jumps_back_none_is_known() -> None:
    forces = FootForces(Walking(("left", "right")))

    def told(stamp: int) -> Status:
        return forces.set(Wrench(stamp, "left", (0.0, 0.0, 1e3)))

    assert told(10 * SECOND) is Status.ACCEPTED
    assert told(10 * SECOND - 1_000_000) is not Status.ACCEPTED
    assert forces.agree("left", True, 10 * SECOND)
    assert told(5 * SECOND) is not Status.ACCEPTED
    assert forces.agree("left", True, 10 * SECOND) is None
    assert told(5 * SECOND + 1_000_000) is Status.ACCEPTED
    assert forces.agree("left", True, 5 * SECOND)
