"""The shipped view of RViz 2 and layout of Foxglove name what is published, with the types and fields it has.

The keys of panels are those that Foxglove Studio's own panels save (packages/studio-base/src/panels of its source).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore
from ruamel.yaml import YAML

from impact_predictor.bags.replay import NODE
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.deck.forecast import single
from impact_predictor.prediction.deck.motion import resting
from impact_predictor.prediction.scene import ODOM, MovingDeck, Scene, Watching, inputs_of, scenes_of
from impact_predictor.prediction.types import Felt, Moment
from impact_predictor.prediction.watch.watch import Report, Watch
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    MARKER_ARRAY,
    OUTPUTS,
    decode_diagnostic_array,
    encode_reports,
)

CONFIG = Path(__file__).parents[3] / "config"
TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
BODIES = [
    one.body for one in inputs_of(scenes_of(read_values(CONFIG / "deck_many.yaml"))) if one.kind == ODOM and one.body
]
PUBLISHED = {
    **{f"{NODE}/{name}": output.type_name for name, output in OUTPUTS.items()},
    **{f"{NODE}/{body}/{name}": output.type_name for body in BODIES for name, output in OUTPUTS.items()},
    f"{NODE}/markers": MARKER_ARRAY,
    "/diagnostics": DIAGNOSTIC_ARRAY,
}
PANELS = {
    "3D": {
        *("foxglovePanelTitle", "cameraState", "followMode", "followTf", "scene", "transforms", "topics", "layers"),
        *("publish", "imageMode"),
    },
    "DiagnosticSummary": {
        *("foxglovePanelTitle", "minLevel", "pinnedIds", "topicToRender", "hardwareIdFilter", "sortByLevel"),
    },
    "DiagnosticStatusPanel": {"foxglovePanelTitle", "topicToRender", "selectedHardwareId", "selectedName"},
    "Plot": {
        *("foxglovePanelTitle", "paths", "minYValue", "maxYValue", "xAxisVal", "showLegend", "legendDisplay"),
        *("showPlotValuesInLegend", "showXAxisLabels", "showYAxisLabels", "isSynced", "sidebarDimension"),
    },
    "StateTransitions": {"foxglovePanelTitle", "paths", "isSynced"},
}
PATH = {"value", "label", "color", "enabled", "timestampMethod", "showLine"}


@pytest.fixture(scope="module")
def layout() -> dict[str, Any]:
    found: dict[str, Any] = json.loads((CONFIG / "deck.foxglove.json").read_text())
    return found


@pytest.fixture(scope="module")
def view() -> dict[str, Any]:
    found: dict[str, Any] = YAML(typ="safe").load((CONFIG / "deck.rviz").read_text())
    return found


@pytest.fixture(scope="module")
def report() -> Report:
    scene = Scene(
        mass=10.0,
        inertia=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        friction=0.5,
        center_of_mass=(0.0, 0.0, 0.5),
        points=((0.5, 0.5, 0.0), (0.5, -0.5, 0.0), (-0.5, 0.5, 0.0), (-0.5, -0.5, 0.0)),
        deck=MovingDeck(),
        watching=Watching(),
        source="none",
    )
    felt = Felt((0.0, 0.0, -9.81), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    watch = Watch({"": scene}, partial(single, resting((0.0, 0.0, -9.81)), None))
    place = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    watch.update_support(Moment(10**9, "world", "deck", *place, felt, lambda _: felt))
    (found,) = watch.reports()
    return found


def leaves(tree: Any) -> Iterator[str]:
    if isinstance(tree, str):
        yield tree
        return
    assert set(tree) == {"direction", "first", "second", "splitPercentage"}
    assert tree["direction"] in ("row", "column")
    assert 0.0 < tree["splitPercentage"] < 100.0
    yield from leaves(tree["first"])
    yield from leaves(tree["second"])


def paths(layout: dict[str, Any]) -> list[str]:
    return [path["value"] for panel in layout["configById"].values() for path in panel.get("paths", ())]


def type_of(path: str) -> str:
    """The type of the field at a message path, by the definitions of the messages."""
    topic, fields = re.fullmatch(r"(/[\w/]+)((?:\.[\w]+|\[[^]]*\]|\{[^}]*\})*)", path).groups()  # type: ignore[union-attr]
    kind: Any = (1, PUBLISHED[topic])  # as rosbags describes it: 1 base type by name, 3 and 4 arrays
    name = PUBLISHED[topic]
    for field in re.findall(r"\.(\w+)", fields):
        _, definition = TYPESTORE.fielddefs[name]
        kind = dict(definition)[field]
        described = kind[1][0] if kind[0] in (3, 4) else kind
        name = described[1] if isinstance(described[1], str) else described[1][0]
    return name


def test_the_layout_has_a_place_for_every_panel_and_a_panel_for_every_place(layout: dict[str, Any]) -> None:
    shown = list(leaves(layout["layout"]))
    assert sorted(shown) == sorted(layout["configById"])
    assert len(set(shown)) == len(shown)
    assert set(layout) == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}


def test_panels_have_the_keys_that_foxglove_saves(layout: dict[str, Any]) -> None:
    for name, panel in layout["configById"].items():
        kind, _, number = name.partition("!")
        assert number
        assert set(panel) <= PANELS[kind]
        for path in panel.get("paths", ()):
            assert set(path) <= PATH
            assert path["timestampMethod"] in ("receiveTime", "headerStamp")


def test_every_topic_of_the_layout_is_published_with_the_type_of_its_panel(layout: dict[str, Any]) -> None:
    for name, panel in layout["configById"].items():
        if name.startswith("Diagnostic"):
            assert PUBLISHED[panel["topicToRender"]] == DIAGNOSTIC_ARRAY
        for topic in panel.get("topics", ()):
            assert PUBLISHED[topic] == MARKER_ARRAY


def test_every_path_ends_at_a_number_or_at_a_text_of_a_number(layout: dict[str, Any], report: Report) -> None:
    drawn = paths(layout)
    assert len(drawn) >= 6
    for path in drawn:
        if path == "1":  # a line of reference
            continue
        assert type_of(path) in ("float64", "uint8", "byte", "octet", "string")
        for key in re.findall(r'key=="(\w+)"', path):
            assert float(report.values[key]) >= 0.0
        assert set(re.findall(r"\$(\w+)", path)) <= set(layout["globalVariables"])
    # It begins with the body alone.
    (status,) = decode_diagnostic_array(encode_reports([report], report.stamp))
    assert (report.body, status.name) == ("", layout["globalVariables"]["unit"])


def test_the_view_of_rviz_shows_the_markers_in_the_frame_of_the_deck(view: dict[str, Any]) -> None:
    manager = view["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == "deck"
    (markers,) = [one for one in manager["Displays"] if one["Class"] == "rviz_default_plugins/MarkerArray"]
    assert PUBLISHED[markers["Topic"]["Value"]] == MARKER_ARRAY
    # The publisher is reliable and volatile: any other demand of the viewer would match, but these are its own.
    assert markers["Topic"]["Reliability Policy"] == "Reliable"
    assert markers["Topic"]["Durability Policy"] == "Volatile"
    assert markers["Enabled"] is True
    assert manager["Views"]["Current"]["Class"] == "rviz_default_plugins/Orbit"
