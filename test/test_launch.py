import runpy
from pathlib import Path

import pytest

launch = pytest.importorskip("launch")
pytest.importorskip("launch_ros")  # of a sourced ROS: PyPI has no launch

LAUNCH = Path(__file__).parents[1] / "launch"
OF_ALL = ["namespace", "name", "use_sim_time", "log_level"]
FEET = ["contact_geometry", "feet_states", "joint_states", "contact_wrench", "schedule", "terrain"]


def description_of(file):
    return runpy.run_path(str(LAUNCH / file))["generate_launch_description"]()


@pytest.mark.parametrize(
    ("file", "arguments"),
    [
        ("predictor.launch.py", ["params_file", *OF_ALL, "odom", "contact_geometry"]),
        ("deck.launch.py", ["scene", "params_file", *OF_ALL, "support_odom", "support_imu"]),
        ("walker.launch.py", ["scene", "params_file", *OF_ALL, "odom", *FEET]),
    ],
)
def test_a_launch_file_takes_a_scene_and_the_topics(file, arguments):
    assert [argument.name for argument in description_of(file).get_launch_arguments()] == arguments


@pytest.mark.parametrize(
    ("file", "given", "said"),
    [
        ("predictor.launch.py", {"param_file": "x.yaml"}, "params_file"),
        ("predictor.launch.py", {"params_file": "~/nowhere.yaml"}, f"{Path.home()}/nowhere.yaml is not there"),
        ("deck.launch.py", {"scene": "deck_crat"}, "there is no shipped scene deck_crat, but cube_tosses, deck_crate"),
    ],
)
def test_a_scene_that_is_not_there_starts_nothing(file, given, said):
    context = launch.LaunchContext()
    context.launch_configurations.update(given)
    with pytest.raises(Exception, match=said):
        for entity in description_of(file).entities:
            entity.visit(context)


@pytest.mark.parametrize("scene", ["deck_many", "deck_many.yaml"])
def test_a_shipped_scene_is_called_with_or_without_its_suffix(scene):
    context = launch.LaunchContext()
    context.launch_configurations["scene"] = scene
    (*_, nodes) = [entity.visit(context) for entity in description_of("deck.launch.py").entities]
    assert len(nodes) == 1
