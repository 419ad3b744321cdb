"""Quadrature of functions that begin like a power: what its rules promise, on powers."""

from __future__ import annotations

import math

import pytest

from impact_predictor.mechanics.motion.quadrature import RESTING, STARTING, QuadratureRule, weighted

ROUNDING = 1e-14
"""Some ten roundings of sums of a few terms."""
RULES = [(STARTING, 2, 2, 1), (RESTING, 5, 4, 2)]
"""A rule, the powers that a force and a lag begin with, and the step from one power to the next."""


@pytest.mark.parametrize(("rule", "force", "lag", "step"), RULES)
def test_integrals_up_to_a_node_are_exact_to_seven_terms(rule: QuadratureRule, force: int, lag: int, step: int) -> None:
    for rows, first in ((rule.forces, force), (rule.lags, lag)):
        for power in range(first, first + 7 * step, step):
            values = [s**power for s in rule.nodes]
            for row, end in zip(rows, rule.nodes, strict=True):
                # Relative to the whole integral: the parts of a short one cancel.
                assert weighted(row, values) == pytest.approx(end ** (power + 1) / (power + 1), abs=ROUNDING / power)


@pytest.mark.parametrize(("rule", "force", "lag", "step"), RULES)
def test_a_whole_integral_of_a_lag_is_exact_to_thirteen_terms(
    rule: QuadratureRule, force: int, lag: int, step: int
) -> None:
    for power in range(lag, lag + 13 * step, step):
        assert weighted(rule.lags[-1], [s**power for s in rule.nodes]) == pytest.approx(1 / (power + 1), rel=ROUNDING)


@pytest.mark.parametrize(("rule", "force", "lag", "step"), RULES)
def test_the_last_coefficients_vanish_for_fewer_terms_and_fall_as_a_smooth_function_is_met(
    rule: QuadratureRule, force: int, lag: int, step: int
) -> None:
    for rows, first in ((rule.last_forces, force), (rule.last_lags, lag)):
        for terms in range(5):
            values = [s ** (first + terms * step) for s in rule.nodes]
            assert [weighted(row, values) for row in rows] == pytest.approx([0.0, 0.0], abs=ROUNDING)
        sizes = [
            max(abs(weighted(row, [s**first * math.exp(rate * s**step) for s in rule.nodes])) for row in rows)
            for rate in (0.5, 1.0, 2.0)
        ]
        assert 0.0 < sizes[0] < 0.1 * sizes[1] < 0.01 * sizes[2]
