"""What a calibration says of coefficients that are told and of those that are not."""

from __future__ import annotations

from typing import Any

import numpy as np

from impact_predictor.calibration.fit import Calibration
from impact_predictor.calibration.scene_file import changes_of
from impact_predictor.calibration.search import Estimate, interval
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.report.calibration import sentences

TOLD = Estimate(0.4, 0.2, 0.15, 0.25, known=True)
AS_GIVEN = Estimate(1.0, 1.0, None, None, known=False)


class One:
    scene = Scene(1.0, inertia_matrix([0.5, 1.0, 2.0, 0.0, 0.0, 0.1]), 0.4)


def calibration(friction: Estimate = TOLD, inertia: Estimate = AS_GIVEN, better: bool = True) -> Calibration:
    touchdowns: Any = (One(),) * 20
    errors = np.full(20, 0.1)
    nothing: Any = None
    held_out = 0.5 * errors if better else 2.0 * errors
    restitution = TOLD._replace(given=0.2)
    return Calibration(touchdowns, np.arange(20), friction, restitution, inertia, errors, held_out, nothing, (), 0)


def test_an_interval_in_words() -> None:
    ends = {
        (None, None): "any",
        (0.0, None): "any",
        (0.32, None): "at least 0.32",
        (None, 1.05): "at most 1.05",
        (0.29999, 0.30001): "0.29999 to 0.30001",
    }
    for (low, high), said in ends.items():
        assert interval(Estimate(1.0, 1.0, low, high, known=False)) == said


def test_a_bound_is_told_and_a_contradicted_inertia_is_not_hidden() -> None:
    bound, heavier = (Estimate(given, given, low, None, known=False) for given, low in ((0.4, 0.32), (1.0, 1.17)))
    friction, inertia = sentences(calibration(bound, heavier), [])[-2:]
    assert friction == "The friction cannot be told: at least 0.32 predicts as well; it stays as given."
    assert inertia.startswith("The inertia cannot be told: at least 1.17 times the given one predicts as well; ")
    assert inertia.endswith("the given one predicts worse, but it stays as given.")


def test_a_fit_that_is_worth_nothing_says_so() -> None:
    assert any("not better than the given ones" in said for said in sentences(calibration(better=False), []))
    assert not any("not better than the given ones" in said for said in sentences(calibration(), []))


def test_only_what_changed_is_written_and_an_inertia_as_a_whole() -> None:
    assert changes_of(calibration()).keys() == {"contact.friction"}
    inertia = Estimate(1.0, 1.5, 1.4, 1.6, known=True)
    change = changes_of(calibration(inertia=inertia))["body.inertia"]
    assert change.text == "[0.75, 1.5, 3.0, 0.0, 0.0, 0.15]"
