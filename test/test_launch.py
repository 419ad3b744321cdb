import runpy
from pathlib import Path

import pytest

from impact_predictor.prediction.scene import CONTACT_GEOMETRY, JOINTS, ODOM, SCHEDULE, TERRAIN, WRENCH

launch = pytest.importorskip("launch")
pytest.importorskip("launch_ros")  # of a sourced ROS: PyPI has no launch

LAUNCH = Path(__file__).parents[1] / "launch"


@pytest.mark.parametrize(
    ("file", "arguments"),
    [
        ("predictor.launch.py", ["params_file", "odom", "contact_geometry"]),
        ("deck.launch.py", ["scene", "params_file", "namespace", "support_odom", "support_imu"]),
        (
            "walker.launch.py",
            ["scene", "params_file", "namespace", ODOM, CONTACT_GEOMETRY, JOINTS, WRENCH, SCHEDULE, TERRAIN],
        ),
    ],
)
def test_a_launch_file_takes_a_scene_and_the_topics(file, arguments):
    description = runpy.run_path(str(LAUNCH / file))["generate_launch_description"]()
    assert [argument.name for argument in description.get_launch_arguments()] == arguments
