"""Which method is chosen."""

from __future__ import annotations

from math import inf

from impact_predictor.report.accuracy.choices import USED, choices_of, defaults_of
from impact_predictor.report.accuracy.rows import ALL_SCENES, IMPACT, TOUCHDOWN, Errors, Row, Scene

SCENES = [
    Scene("one", TOUCHDOWN, "", "", ""),
    Scene("two", TOUCHDOWN, "", "", ""),
    Scene("real", TOUCHDOWN, "", "", "", True),
]


def row(scene: str, name: str, us: float, error: float, setting: str = "") -> Row:
    errors = Errors(0.1 * error, error, 10.0 * error)
    return Row(TOUCHDOWN, scene, name, name, setting, us, us, errors, Errors(0.0, 0.0, 0.0), None, 10, 0)


ROWS = [
    row("one", "rough", 1.0, 1e-3),
    row("two", "rough", 1.0, 0.5),
    row("one", "sharp", 20.0, 1e-12),
    row("two", "sharp", 30.0, 1e-11),
    row("one", "special", 5.0, 1e-12),
    row("real", "rough", 1.0, 1e-9),
]


def test_the_cheapest_that_is_good_enough_is_chosen_for_each_scene() -> None:
    chosen = {(scene, accuracy): found and found.method for _, scene, accuracy, found in choices_of(ROWS, SCENES)}
    assert chosen["one", 1e-2] == "rough"
    assert chosen["one", 1e-4] == chosen["one", 1e-9] == "special"
    assert chosen["two", 1e-2] == "sharp"
    assert not any(scene == "real" for scene, _ in chosen)


def test_for_all_scenes_only_what_applies_to_all_is_chosen_with_its_largest_error() -> None:
    everywhere = {accuracy: found for _, scene, accuracy, found in choices_of(ROWS, SCENES) if scene == ALL_SCENES}
    found = everywhere[1e-9]
    assert found is not None
    assert (found.method, found.us, found.error) == ("sharp", 25.0, 1e-11)


def test_where_nothing_is_good_enough_nothing_is_chosen() -> None:
    rows = [row("one", "lost", 1.0, inf)]
    assert all(found is None for _, _, _, found in choices_of(rows, SCENES[:1]))


def test_the_default_of_the_node_is_told_with_its_numbers() -> None:
    name, setting = USED[TOUCHDOWN]
    rows = [*ROWS, row("one", name, 10.0, 1e-15, setting), row("two", name, 10.0, 1e-14, setting)]
    default = defaults_of(rows, SCENES)[TOUCHDOWN]
    assert default.method == name
    assert "1e-14, for 10 us" in default.why
    assert "rough, is 0.5 off" in default.why
    assert IMPACT not in defaults_of(rows, SCENES)
