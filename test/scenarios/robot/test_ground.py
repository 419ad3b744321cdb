"""What robots walk on."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.scenarios.robot.ground import stairs


@pytest.mark.parametrize("rise", [0.05, -0.05])
def test_stairs_begin_half_a_metre_ahead_and_go_up_or_down_every_40_cm(rise: float) -> None:
    ahead = np.array([-0.9, 0.0, 0.45, 0.55, 0.85, 0.95, 1.25, 1.35, 4.45, 4.55])
    heights = stairs(rise).heights(ahead, np.zeros(10))
    assert heights == pytest.approx(rise * np.array([0, 0, 0, 1, 1, 2, 2, 3, 10, 11]))
