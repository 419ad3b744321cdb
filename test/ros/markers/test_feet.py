"""What is drawn of a walking machine: which feet stand, where the others land and when, and the impulse there."""

from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore
from trot import FEET, PERIOD, trot

from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Prediction
from impact_predictor.ros.markers.message import CUBE_LIST, SPHERE_LIST
from impact_predictor.ros.markers.scene import MarkerScene
from impact_predictor.ros.messages import MARKER_ARRAY

TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
SCENE = Scene.from_parameters(read_values(Path(__file__).parents[3] / "config/walker_hyq.yaml"))
LANDS = round(1.5 * PERIOD * 1e9)
"""When RF and LH land, in ns."""


def seen_at(stamp: int) -> tuple[Prediction, dict[str, Any]]:
    """The answer at a stamp in ns, and what is drawn of it, by namespaces."""
    walker, drawing = Predictor(SCENE), MarkerScene({"": SCENE})
    for geometry, sample in trot(500.0, 2.0):
        walker.tell(geometry)
        # Feet are drawn from the answers, wherever they were told.
        drawing.set_geometry("", geometry._replace(points=()))
        prediction = walker.update(sample)
        if sample.stamp >= stamp:
            drawing.take("", prediction)
            data = drawing.due(sample.stamp)
            assert data is not None
            message: Any = TYPESTORE.deserialize_cdr(data, MARKER_ARRAY)
            markers: dict[str, Any] = {}
            for marker in message.markers:
                markers.setdefault(marker.ns, []).append(marker)
            return prediction, markers
    raise AssertionError("the trot ends before")


def places(marker: Any) -> list[tuple[float, float, float]]:
    origin = marker.pose.position
    return [(origin.x + p.x, origin.y + p.y, origin.z + p.z) for p in marker.points]


def test_standing_feet_are_cubes_and_those_that_land_are_marked_where_they_will_stand_with_name_and_time() -> None:
    before = 40_000_000
    prediction, markers = seen_at(LANDS - before)
    (stand,), (strike,) = markers["contacts/standing"], markers["contacts/striking"]
    assert (stand.type, strike.type) == (CUBE_LIST, SPHERE_LIST)
    where = dict(zip(FEET, [foot.position for foot in prediction.feet], strict=True))
    assert places(stand) == [pytest.approx(where[name], abs=1e-9) for name in ("LF", "RH")]
    assert places(strike) == [pytest.approx(where[name], abs=1e-9) for name in ("RF", "LH")]
    (landing,) = markers["feet/landing"]
    after, _ = seen_at(LANDS + before)
    # Predicted 40 ms ahead, within the size of the mark: the feet still move forward.
    for place, name in zip(places(landing), ("RF", "LH"), strict=True):
        stood = after.feet[FEET.index(name)].position
        assert place == pytest.approx(stood, abs=0.02)
    times = {text.text.split()[0]: float(text.text.split()[1]) for text in markers["feet/text"]}
    assert times == pytest.approx({"RF": 40.0, "LH": 40.0}, abs=5.0)


def test_the_impulse_of_the_soonest_landing_begins_where_that_foot_lands() -> None:
    prediction, markers = seen_at(LANDS - 40_000_000)
    touchdown = prediction.touchdown
    assert touchdown is not None
    starts = [places(arrow)[0] for arrow in markers["touchdown/impulse"]]
    assert pytest.approx(prediction.feet[touchdown.new[0]].place, abs=1e-9) in starts
    # A ghost of the legs as they are now would be where they will not be.
    assert "touchdown/body" not in markers


def test_a_machine_on_all_feet_has_nothing_ahead() -> None:
    _, markers = seen_at(LANDS + 40_000_000)
    assert len(places(markers["contacts/standing"][0])) == len(FEET)
    assert not {"contacts/striking", "feet/landing", "feet/text"} & markers.keys()
