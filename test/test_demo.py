import importlib.util
from pathlib import Path

import pytest

from impact_predictor.bags.read import topics
from impact_predictor.bags.write import BagWriter
from impact_predictor.commands.demo import demo, play, read_recording
from impact_predictor.errors import InputError
from impact_predictor.resources import find
from impact_predictor.ros.cdr import OK, diagnostic_array, diagnostic_status, pairs_of
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY
from impact_predictor.ros.player import NODE, RECORDED

needs_ros = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None,
    reason="the demonstration needs ROS 2: source it, or install the extra `ros`",
)
SECOND = 1_000_000_000
BEFORE = {"before.vx": "1.0", "before.vy": "-0.5", "before.omega": "-8.0"}
SCORE = {
    **BEFORE,
    "stamp": str(SECOND),
    "mode": "PIVOT",
    "scored": "true",
    "old": "0",
    "new": "1",
    "leftover": "NONE",
    "flags": "NONE",
    "announced": "0.058",
    "lead_time": "0.005",
    "half_distance": "0.05",
    "off_axis": "0.1",
    "predicted.vx": "0.8",
    "predicted.vy": "0.0",
    "predicted.omega": "-2.0",
    "measured.vx": "0.7",
    "measured.vy": "0.0",
    "measured.omega": "-2.0",
    "relative_error": "0.0928",
}


def message(values):
    return diagnostic_array(0, "", [diagnostic_status(OK, "impact_predictor/test", "", "", pairs_of(values))])


@pytest.fixture
def recording(tmp_path):
    """Writes a recording of messages given as topics and bytes, and reads it."""

    def read(*messages):
        with BagWriter(tmp_path / "recorded.mcap") as writer:
            for topic in (f"{NODE}/prediction", f"{NODE}/score", "/diagnostics"):
                writer.write(topic, DIAGNOSTIC_ARRAY, 0, message({"stamp": "0"}) if "score" not in topic else OTHER)
            for k, (topic, data) in enumerate(messages):
                writer.write(topic, DIAGNOSTIC_ARRAY, k + 1, data)
        return read_recording(tmp_path / "recorded.mcap")

    return read


OTHER = message({**SCORE, "scored": "false"})


def test_a_touchdown_costs_what_the_node_reports_next(recording):
    rows = recording(
        ("/diagnostics", message({"cost_us.update.median": "50.0"})),
        (f"{NODE}/score", message(SCORE)),
        (f"{NODE}/score", message(SCORE)),
        ("/diagnostics", message({"cost_us.update.median": "70.0"})),
        (f"{NODE}/score", message(SCORE)),
    )
    costs = [row.cost and round(row.cost * 1e6) for row in rows]
    assert costs == [50, 70, 70, None]


@needs_ros
@pytest.mark.slow
def test_the_demonstration_shows_tosses_that_were_played_live_a_deck_and_a_robot_on_one_page(tmp_path, capsys):
    demo(["-o", str(tmp_path / "demo"), "--tosses", "3"], standalone_mode=False)
    printed, page = capsys.readouterr().out, (tmp_path / "demo/demo.html").read_text()
    for said in ("scored by the whole twist", "Events warned of: 1 of 1", "49 of 49 touchdowns found", "old lifted"):
        assert said in printed
        assert said in page or said == "old lifted"
    assert "more touchdowns: listed are the first of each kind that are scored, 8 at most." in printed
    assert "nothing happens" in page
    assert topics(tmp_path / "demo/predictions.mcap").keys() == {*RECORDED}


@needs_ros
@pytest.mark.slow
def test_a_process_that_dies_ends_the_demonstration_with_its_own_sentence(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text("/**:\n  ros__parameters:\n    body:\n      mass: -1.0\n")
    with pytest.raises(
        InputError, match=r"the process of the node ended with status 1: .*body.mass is -1.0, but"
    ) as error:
        play(find("examples/cube_tosses"), scene, 1, tmp_path / "predictions.mcap")
    assert "\n" not in str(error.value)


def test_an_output_folder_that_cannot_be_made_is_one_sentence(tmp_path):
    Path(tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        demo(["-o", str(tmp_path / "file" / "demo")], standalone_mode=False)
