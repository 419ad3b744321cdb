"""Parameter files with other values in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from boxes import TRUTH, touchdowns

from impact_predictor.calibration.fit import Calibration
from impact_predictor.calibration.scene_file import NewValues, changed, changes_of, number_text
from impact_predictor.calibration.search import Estimate
from impact_predictor.parameters.file import read_parameters
from impact_predictor.prediction.scene import inertia_matrix
from impact_predictor.resources import find

FRICTION = {"contact.friction": NewValues((0.2287,), "fitted")}


def parameters(tmp_path: Path, text: str) -> dict[str, object]:
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    return dict(read_parameters(path))


def test_everything_but_the_changed_lines_stays_to_the_last_character() -> None:
    text = find("config/cube_tosses.yaml").read_text()
    changes = {**FRICTION, "body.inertia": NewValues((7e-4,), "fitted", listed=True)}
    before, after = text.splitlines(), changed(text, changes).splitlines()
    assert [line for old, line in zip(before, after, strict=True) if old != line] == [
        "      inertia: [0.0007]  # fitted",
        "      friction: 0.2287  # fitted",
    ]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("/**:\n  ros__parameters:\n    contact:\n      friction: 1.0e-1\n", "      friction: 0.2287  # fitted"),
        ("/**:\n  ros__parameters:\n    contact.friction: 0.1", "    contact.friction: 0.2287  # fitted"),
        (
            "/**:\n  ros__parameters:\n    contact: {friction: 0.1, time: 0.01}\n",
            "    contact: {friction: 0.2287, time: 0.01}",
        ),
        ("/**:\n  ros__parameters:\n    contact.friction: 0.1  # wet\n", "    contact.friction: 0.2287  # fitted; wet"),
    ],
)
def test_a_value_is_replaced_however_it_is_written(tmp_path: Path, text: str, line: str) -> None:
    answer = changed(text, FRICTION)
    assert line in answer.splitlines()
    assert parameters(tmp_path, answer)["contact.friction"] == 0.2287


@pytest.mark.parametrize(
    "text",
    [
        "/**:\n  ros__parameters:\n    contact:\n      # Rough.\n      friction: 0.1\n",
        "/**:\n  ros__parameters:\n    contact.friction: 0.1\n",
        "/**:\n  ros__parameters:\n    contact: {friction: 0.1}\n",
    ],
)
def test_a_parameter_that_was_left_to_its_default_is_added(tmp_path: Path, text: str) -> None:
    answer = changed(text, {"contact.restitution": NewValues((0.1,), "fitted")})
    assert parameters(tmp_path, answer) == {"contact.friction": 0.1, "contact.restitution": 0.1}


def test_the_value_that_wins_is_changed_where_several_sections_set_it(tmp_path: Path) -> None:
    values = "  ros__parameters:\n    contact.friction"
    text = f"/**:\n{values}: 0.1\nimpact_predictor:\n{values}: 0.3\n"
    assert parameters(tmp_path, changed(text, FRICTION))["contact.friction"] == 0.2287


@pytest.mark.parametrize(
    ("value", "text"), [(1.0, "1.0"), (0.12344, "0.1234"), (1e-5, "1.0e-05"), (1234567.0, "1.235e+06")]
)
def test_a_number_is_written_as_a_double(value: float, text: str) -> None:
    assert number_text(value) == text


@pytest.mark.parametrize(
    ("given", "fitted"),
    [
        ((0.2,), (0.3,)),
        ((0.2, 0.4, 0.5, 0.0, 0.0, 0.0), (0.3, 0.6, 0.75, 0.0, 0.0, 0.0)),
        ((0.2, 0.2, 0.2, 0.0, 0.0, 0.1), (0.3, 0.3, 0.3, 0.0, 0.0, 0.15)),
    ],
)
def test_a_factor_multiplies_the_inertia_and_one_that_is_alike_about_all_axes_stays_one_number(
    given: tuple[float, ...], fitted: tuple[float, ...]
) -> None:
    (one,), none = touchdowns(number=1), np.zeros(1)
    one = one._replace(scene=one.scene._replace(inertia=inertia_matrix(given)))
    factor = Estimate(given=1.0, value=1.5, low=1.4, high=1.6, known=True)
    calibration = Calibration((one,), np.zeros(1, int), {"inertia": factor}, TRUTH, none, none, {})
    change = changes_of(calibration)["body.inertia"]
    assert change.values == pytest.approx(fitted)
    assert change.listed
