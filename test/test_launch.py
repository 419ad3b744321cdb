import runpy
from pathlib import Path

import pytest

launch = pytest.importorskip("launch")
pytest.importorskip("launch_ros")  # of a sourced ROS: PyPI has no launch

LAUNCH_FILE = Path(__file__).parents[1] / "launch/predictor.launch.py"


def test_the_launch_file_takes_a_scene_and_the_topics_of_a_body():
    description = runpy.run_path(str(LAUNCH_FILE))["generate_launch_description"]()
    names = [argument.name for argument in description.get_launch_arguments()]
    assert names == ["params_file", "odom", "contact_geometry"]
