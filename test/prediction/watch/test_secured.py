"""Margins with lashings, chocks and wind: against statics by hand and against linear programmes."""

from __future__ import annotations

from math import cos, hypot, inf, pi, sin
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

from impact_predictor.prediction.vectors import add
from impact_predictor.prediction.watch.onset import FULL, Onset, OnsetMargins, motions
from impact_predictor.prediction.watch.stance import Holder, StandingBody, WindLoad, edges_of, outline

G = 9.81
MASS, FRICTION, HEIGHT, HALF = 1000.0, 0.3, 2.0, 1.0
FEET = [(x, y, 0.0) for x in (-HALF, HALF) for y in (-HALF, HALF)]
EDGES = tuple([edge for edge, _ in edges_of(outline(FEET, (0.0, 0.0, 1.0)), (0.0, 0.0, 1.0))])
INERTIA = ((1e3, 0.0, 0.0), (0.0, 1e3, 0.0), (0.0, 0.0, 1e3))
CRATE = StandingBody(MASS, FRICTION, (0.0, 0.0, 1.0), (0.0, 0.0, HEIGHT), INERTIA, EDGES)
"""2 m square, its mass centre 2 m high: alone it slides at 0.3 g and tips at 0.5 g."""


def margins(stance: StandingBody, *felt: float) -> OnsetMargins:
    zero = np.zeros((1, 3))
    return Onset([stance]).margins(motions(np.array([felt]), zero, zero)[:, 0])


def slide(holders: list[Holder], *felt: float, **changes: Any) -> float:
    return float(margins(CRATE._replace(holders=tuple(holders), **changes), *felt).slide[0])


def tip(holders: list[Holder], *felt: float, **changes: Any) -> float:
    return float(margins(CRATE._replace(holders=tuple(holders), **changes), *felt).tip[0])


def lashing(side: float, angle: float, msl: float, preload: float = 0.0, z: float = 1.0, k: float = 1e6) -> Holder:
    """From a face of the crate outwards, down by an angle to the deck."""
    return Holder((0.0, side * HALF, z), (0.0, side * cos(angle), -sin(angle)), msl, preload, k)


def chock(side: float, z: float, strength: float = inf) -> Holder:
    return Holder((0.0, side * HALF, z), (0.0, -side, 0.0), strength, 0.0, inf)


def test_lashings_hold_with_their_pull_and_with_the_friction_that_they_press_for() -> None:
    """Of a pair only the one that stretches counts: f (m g + T sin a) + T cos a."""
    a, msl = 0.6, 5e3
    pair = [lashing(1.0, a, msl), lashing(-1.0, a, msl)]
    held = FRICTION * (MASS * G + msl * sin(a)) + msl * cos(a)
    assert slide(pair, 0.0, 4.0, -G) == pytest.approx(MASS * 4.0 / held)
    assert slide(pair, 0.0, -4.0, -G) == pytest.approx(MASS * 4.0 / held)
    assert slide(pair, 4.0, 0.0, -G) == pytest.approx(4.0 / (FRICTION * G), rel=0.01)  # along, nothing holds it


def test_the_stiffer_lashing_bears_its_msl_while_the_other_one_is_still_loose() -> None:
    pair = [lashing(-1.0, 0.0, 5e3, k=1e6), lashing(-1.0, 0.0, 5e3, k=2e5)]
    assert slide(pair, 0.0, 4.0, -G) == pytest.approx(MASS * 4.0 / (FRICTION * MASS * G + 5e3 + 1e3))


def test_a_preload_over_the_top_presses_and_lashings_across_the_way_do_no_more() -> None:
    over = [lashing(side, pi / 2, 5e3, 2e3) for side in (1.0, -1.0)]
    assert slide(over, 0.0, 2.0, -G) == pytest.approx(MASS * 2.0 / (FRICTION * (MASS * G + 4e3)))
    across = [Holder((side, 0.0, 1.0), (side, 0.0, 0.0), 5e3, 0.0, 1e6) for side in (1.0, -1.0)]
    assert slide(across, 0.0, 2.0, -G) == pytest.approx(MASS * 2.0 / (FRICTION * MASS * G), rel=0.01)


def test_random_lashings_hold_no_more_than_statics_allow() -> None:
    """The largest load that the friction cone and tensions from 0 to MSL can carry: an upper bound by a linear
    programme.
    """
    random = np.random.default_rng(4)
    corners = 720
    for _ in range(40):
        holders = []
        for _ in range(int(random.integers(1, 6))):
            angle, down = random.uniform(0.0, 2.0 * pi), random.uniform(0.1, 1.2)
            direction = (cos(angle) * cos(down), sin(angle) * cos(down), -sin(down))
            holders.append(Holder((0.0, 0.0, 1.0), direction, random.uniform(1e3, 6e3), 0.0, random.uniform(1e5, 1e6)))
        heading, load = random.uniform(0.0, 2.0 * pi), 3.0
        acts = np.array((cos(heading), sin(heading))) * MASS * load
        angles = 2.0 * pi * np.arange(corners) / corners
        cone = np.stack((np.cos(angles), np.sin(angles)), axis=1)
        # Unknown are the factor on the load and the tensions; friction is what is left, inside of its cone.
        flat = np.array([holder.direction[:2] for holder in holders]).T
        down = np.array([-holder.direction[2] for holder in holders])
        least = np.concatenate(((cone @ acts)[:, None], cone @ flat - FRICTION * down), axis=1)
        bounds = [(0.0, None), *[(0.0, holder.strength) for holder in holders]]
        best = linprog(
            [-1.0] + [0.0] * len(holders),
            least,
            np.full(corners, FRICTION * MASS * G / cos(pi / corners)),
            bounds=bounds,
        )
        ratio = slide(holders, *(acts / MASS), -G)
        assert ratio >= 0.99 / best.x[0]
        assert ratio <= 1.01 * load / (FRICTION * G)


def test_a_chock_holds_its_side_alone_up_to_its_strength() -> None:
    assert slide([chock(1.0, 0.1)], 0.0, 9.0, -G) == pytest.approx(0.0, abs=1e-9)
    assert slide([chock(1.0, 0.1)], 0.0, -2.0, -G) == pytest.approx(2.0 / (FRICTION * G), rel=0.01)
    assert slide([chock(1.0, 0.1)], 2.0, 2.0, -G) == pytest.approx(2.0 / (FRICTION * G))  # along the chock
    assert slide([chock(1.0, 0.1, 2e3)], 0.0, 4.0, -G) == pytest.approx(4e3 / (FRICTION * MASS * G + 2e3))


def test_a_chock_and_a_lashing_do_not_add_up_as_one_is_stiffer() -> None:
    both = [chock(1.0, 0.1, 2e3), lashing(-1.0, 0.0, 5e3)]
    assert slide(both, 0.0, 4.0, -G) == pytest.approx(4e3 / (FRICTION * MASS * G + 5e3))


def test_lashings_hold_against_tipping_by_their_lever_arms() -> None:
    """By hand: a flat lashing 1.5 m up has the arm 1.5 m, a vertical one on the other side 2 m."""
    flat = [lashing(-1.0, 0.0, 4e3, z=1.5)]
    assert tip(flat, 0.0, 6.0, -G) == pytest.approx(HEIGHT * MASS * 6.0 / (HALF * MASS * G + 1.5 * 4e3))
    vertical = [lashing(-1.0, pi / 2, 4e3, z=0.5)]
    assert tip(vertical, 0.0, 6.0, -G) == pytest.approx(HEIGHT * MASS * 6.0 / (HALF * MASS * G + 2.0 * 4e3))
    assert tip(vertical, 0.0, -6.0, -G) == pytest.approx(HEIGHT * 6.0 / (HALF * G))


def test_a_crate_against_a_chock_tips_over_its_top() -> None:
    """What acts 2 m high is pushed back 0.5 m high, and no chock bears more than what acts."""
    assert tip([chock(1.0, 0.5)], 0.0, 6.0, -G) == pytest.approx((HEIGHT - 0.5) * 6.0 / (HALF * G))
    weak = HEIGHT * MASS * 6.0 / (HALF * MASS * G + 0.5 * 1e3)
    assert tip([chock(1.0, 0.5, 1e3)], 0.0, 6.0, -G) == pytest.approx(weak)
    clip = Holder((0.0, -HALF, 0.0), (0.0, 0.0, -1.0), 3e3, 0.0, inf)
    assert tip([clip], 0.0, 6.0, -G) == pytest.approx(HEIGHT * MASS * 6.0 / (HALF * MASS * G + 2.0 * 3e3))


def test_what_is_lashed_down_lifts_later() -> None:
    down = [lashing(side, pi / 2, 5e3) for side in (1.0, -1.0)]
    assert margins(CRATE, 0.0, 0.0, 1.0).lifted[0]
    assert not margins(CRATE._replace(holders=tuple(down)), 0.0, 0.0, 9.0).lifted[0]
    lifted = margins(CRATE._replace(holders=tuple(down)), 0.0, 0.0, 11.0)
    assert lifted.lifted[0]
    assert (lifted.slide[0], lifted.tip[0]) == (FULL, FULL)


def test_wind_pushes_from_the_worst_side() -> None:
    wind = WindLoad((500.0, 800.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), (0.0, 0.0, 1.5))
    for sign in (1.0, -1.0):
        pushed = slide([], 0.0, sign * 2.0, -G, wind=wind)
        assert pushed == pytest.approx((MASS * 2.0 + 800.0) / (FRICTION * MASS * G), rel=0.02)
        assert pushed >= (MASS * 2.0 + 800.0) / (FRICTION * MASS * G) * (1.0 - 1e-12)
        tipped = tip([], 0.0, sign * 2.0, -G, wind=wind)
        assert tipped == pytest.approx((HEIGHT * MASS * 2.0 + 1.5 * 800.0) / (HALF * MASS * G))


def test_a_chock_takes_what_wind_and_deck_push_at_its_height() -> None:
    wind = WindLoad((0.0, 800.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), (0.0, 0.0, 1.5))
    moment = HEIGHT * MASS * 2.0 + 1.5 * 800.0 - 0.3 * (MASS * 2.0 + 800.0)
    assert tip([chock(1.0, 0.3)], 0.0, 2.0, -G, wind=wind) == pytest.approx(moment / (HALF * MASS * G))


def test_a_crate_with_wind_and_a_chock_has_the_same_margins_wherever_its_support_is_told_from() -> None:
    wind, shift = WindLoad((0.0, 800.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), (0.0, 0.0, 1.5)), (0.3, -0.2, 0.7)
    held = chock(1.0, 0.3)
    moved = {
        "center": add(CRATE.center, shift),
        "edges": tuple([edge._replace(point=add(edge.point, shift)) for edge in EDGES]),
        "wind": wind._replace(center=add(wind.center, shift)),
    }
    here = [held._replace(point=add(held.point, shift))]
    assert tip(here, 0.0, 2.0, -G, **moved) == pytest.approx(tip([held], 0.0, 2.0, -G, wind=wind))
    assert slide(here, 0.0, 2.0, -G, **moved) == pytest.approx(slide([held], 0.0, 2.0, -G, wind=wind))


def test_bodies_beside_a_lashed_one_keep_their_margins_and_many_times_are_as_one() -> None:
    free = CRATE._replace(friction=0.4)
    lashed = CRATE._replace(holders=(lashing(1.0, 0.6, 5e3, 1e3), chock(-1.0, 0.3, 4e3)))
    random = np.random.default_rng(5)
    felt, rates = random.normal((0.0, 0.0, -G), 2.0, (50, 3)), random.normal(0.0, 0.1, (2, 50, 3))
    together = Onset([free, lashed, free]).margins(motions(felt, *rates))
    alone = Onset([free]).margins(motions(felt, *rates))
    for body in (0, 2):
        np.testing.assert_allclose(together.slide[body], alone.slide[0], rtol=1e-13)
        np.testing.assert_allclose(together.tip[body], alone.tip[0], rtol=1e-13)
    single = Onset([free, lashed]).margins(motions(felt[:1], *rates[:, :1])[:, 0])
    np.testing.assert_allclose(single.slide, together.slide[:2, 0], rtol=1e-13)
    np.testing.assert_allclose(single.tip, together.tip[:2, 0], rtol=1e-13)


def test_an_unlashed_body_that_the_formulas_know_has_the_margins_of_one_with_a_slack_lashing() -> None:
    slack = [lashing(1.0, 0.5, 1e-9)]
    for felt in ((3.0, 0.0, -G), (1.0, 2.0, -9.0), (0.0, -3.0, -8.0)):
        bare = margins(CRATE, *felt)
        assert slide(slack, *felt) == pytest.approx(bare.slide[0], rel=0.009)
        assert slide(slack, *felt) <= bare.slide[0] * (1.0 + 1e-9)
        assert tip(slack, *felt) == pytest.approx(bare.tip[0])
        assert bare.slide[0] == pytest.approx(hypot(*felt[:2]) / (FRICTION * -felt[2]))
