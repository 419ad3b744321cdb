"""Quadrature of functions that begin like a power: what its rules promise, on powers."""

from __future__ import annotations

import pytest

from impact_predictor.mechanics.motion.quadrature import RESTING, STARTING, QuadratureRule, weighted

ROUNDING = 1e-14
"""Some ten roundings of sums of a few terms."""


@pytest.mark.parametrize(("rule", "force", "lag", "step"), [(STARTING, 2, 2, 1), (RESTING, 5, 4, 2)])
def test_integrals_are_exact_to_seven_terms_up_to_a_node_and_to_thirteen_in_the_whole(
    rule: QuadratureRule, force: int, lag: int, step: int
) -> None:
    for rows, last, first in ((rule.forces, rule.last_forces, force), (rule.lags, rule.last_lags, lag)):
        for terms in range(7):
            power = first + terms * step
            values = [s**power for s in rule.nodes]
            for row, end in zip(rows, rule.nodes, strict=True):
                # Relative to the whole integral: the parts of a short one cancel.
                assert weighted(row, values) == pytest.approx(end ** (power + 1) / (power + 1), abs=ROUNDING / power)
            if terms < 5:
                assert [weighted(row, values) for row in last] == pytest.approx([0.0, 0.0], abs=ROUNDING)
    for power in range(lag, lag + 13 * step, step):
        assert weighted(rule.lags[-1], [s**power for s in rule.nodes]) == pytest.approx(1 / (power + 1), rel=ROUNDING)
