"""Levels rise at once, and fall when their reason has stayed away for as long as they are held."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from impact_predictor.prediction.scene import Watching
from impact_predictor.prediction.watch.levels import ERROR, OK, STALE, WARN, Levels

STEP = 0.01
WATCHING = Watching(warn=0.7, error=1.0, hysteresis=0.1, hold=5.0)


def run(used: object, watching: Watching = WATCHING, other: int = OK) -> list[int]:
    """The places of one body's levels, a hundredth of a second apart."""
    levels, found = Levels([watching]), []
    for k, part in enumerate(np.asarray(used, dtype=float).tolist()):
        levels.update(round(k * STEP * 1e9), np.array([part]), np.array([other]))
        found.append(int(levels.ranks[0]))
    return found


def changes(places: list[int]) -> int:
    return sum(a != b for a, b in pairwise(places))


def test_a_level_rises_with_the_first_message_over_a_threshold() -> None:
    assert run([0.69, 0.7, 0.99, 1.0, 0.5]) == [OK, WARN, WARN, ERROR, ERROR]


def test_a_level_falls_once_its_reason_has_stayed_away_for_the_hold() -> None:
    places = run([1.0] + [0.5] * 600)
    assert places[500] == OK  # 5 s after the last reason at 0 s
    assert places[499] == ERROR


def test_within_the_hysteresis_a_level_is_held_for_ever() -> None:
    assert set(run([1.0] + [0.9] * 3000)) == {ERROR}
    assert set(run([0.7] + [0.6] * 3000)) == {WARN}


def test_a_level_falls_to_the_worst_of_its_hold_and_no_further() -> None:
    places = run([1.0] + [0.2] * 300 + [0.75] + [0.2] * 1000)
    assert places[499] == ERROR
    assert places[500] == WARN
    assert places[800] == WARN  # the warning was at 3.01 s
    assert places[801] == OK


def test_that_nothing_is_known_is_graver_than_a_warning_and_less_than_an_error() -> None:
    levels = Levels([WATCHING])
    for stamp, used, other, place in ((0, 0.8, OK, WARN), (1, 0.0, STALE, STALE), (2, 1.2, STALE, ERROR)):
        levels.update(stamp, np.array([used]), np.array([other]))
        assert levels.ranks[0] == place


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("near", [0.6, 0.7, 0.9, 1.0])
def test_noise_about_a_threshold_does_not_make_a_level_flicker(seed: int, near: float) -> None:
    rng = np.random.default_rng(seed)
    noise = rng.normal(0.0, rng.uniform(0.005, 0.2), 3000)
    places = run(near + noise)
    # In 30 s a level can fall at most once in its hold of 5 s, and rise before it falls again.
    assert changes(places) <= 2 * 6 + 1
    falls = [k for k in range(1, 3000) if places[k] < places[k - 1]]
    rises = [k for k in range(1, 3000) if places[k] > places[k - 1]]
    for fall in falls:
        since = max((k for k in rises + falls if k < fall), default=0)
        assert (fall - since) * STEP >= WATCHING.hold - 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_small_noise_within_the_hysteresis_changes_a_level_once(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places = run(np.clip(0.99 + rng.normal(0.0, 0.03, 3000), 0.91, 1.2))
    assert changes(places) <= 1


def test_each_body_has_its_own_thresholds() -> None:
    levels = Levels([WATCHING, Watching(warn=0.3, error=0.4), Watching(warn=2.0, error=3.0)])
    levels.update(0, np.array([0.5, 0.5, 1.5]), np.zeros(3, dtype=np.int64))
    assert levels.ranks.tolist() == [OK, ERROR, OK]
