"""What a calibration says of coefficients that are told and of those that are not."""

from __future__ import annotations

import numpy as np
from boxes import touchdowns

from impact_predictor.calibration.fit import Calibration
from impact_predictor.calibration.scene_file import changes_of
from impact_predictor.calibration.search import Estimate, interval
from impact_predictor.calibration.solver import Coefficients
from impact_predictor.prediction.scene import inertia_matrix
from impact_predictor.report.calibration import sentences, tables

TOLD = Estimate(0.4, 0.2, 0.15, 0.25, known=True)


def calibration(better: bool = True, **others: Estimate) -> Calibration:
    errors = np.full(20, 0.1)
    estimates = {"friction": TOLD, "restitution": TOLD._replace(given=0.2), **others}
    return Calibration(
        touchdowns=tuple(touchdowns(number=20)),
        blocks=np.arange(20),
        estimates=estimates,
        fitted=Coefficients(0.2, 0.2, 1e-3),
        given=errors,
        held_out=0.5 * errors if better else 2.0 * errors,
        simple={"all stops": 8.0 * errors},
    )


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
    friction, inertia = sentences(calibration(friction=bound, inertia=heavier), [])[-2:]
    assert friction == "The friction cannot be told: at least 0.32 predicts as well; it stays as given."
    assert inertia.startswith("The inertia cannot be told: at least 1.17 times the given one predicts as well; ")
    assert inertia.endswith("the given one predicts worse, but it stays as given.")


def test_a_fit_that_is_worth_nothing_says_so() -> None:
    assert any("not better than the given ones" in said for said in sentences(calibration(better=False), []))
    assert not any("not better than the given ones" in said for said in sentences(calibration(), []))


def test_errors_stand_beside_those_of_simple_answers_and_of_each_kind() -> None:
    _, errors, kinds = tables(calibration())
    assert list(errors.columns[0].cells) == ["given", "fitted, held out", "all stops"]
    assert list(errors.columns[1].cells) == ["10.0", "5.0", "80.0"]
    assert list(kinds.columns[0].cells) == ["flight>corner"]


def test_only_what_changed_is_written_and_an_inertia_as_a_whole() -> None:
    assert changes_of(calibration()).keys() == {"contact.friction"}
    one = calibration(inertia=Estimate(1.0, 1.5, 1.4, 1.6, known=True))
    scene = one.touchdowns[0].scene._replace(inertia=inertia_matrix([0.5, 1.0, 2.0, 0.0, 0.0, 0.1]))
    changes = changes_of(one._replace(touchdowns=(one.touchdowns[0]._replace(scene=scene),)))
    assert changes.keys() == {"contact.friction", "body.inertia"}
    assert changes["body.inertia"].text == "[0.75, 1.5, 3.0, 0.0, 0.0, 0.15]"
