"""What the launch files share: the arguments of all, and the node with its scene, found before it starts."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from ..errors import InputError
from ..resources import find


def described(inputs: Mapping[str, str], scene: str = "") -> LaunchDescription:
    """The launch of a predictor.

    Args:
        inputs: what comes on each input, whose topic is an argument of its name, with _ for /.
        scene: the shipped scene that is taken where nobody names another or gives a params_file; "" where the file must
            be given.
    """
    arguments = {
        "namespace": ("", "Namespace of the node and of its topics."),
        "name": ("impact_predictor", "Name of the node."),
        "use_sim_time": ("false", "Whether time is that of /clock."),
        "log_level": ("info", "Least severity of what the node logs."),
        **{name.replace("/", "_"): (name, says) for name, says in inputs.items()},
    }
    of_scene = [DeclareLaunchArgument("params_file", description="ROS 2 parameter file of the scene.")]
    if scene:
        of_scene = [
            DeclareLaunchArgument("scene", default_value=scene, description="Name of a shipped scene."),
            DeclareLaunchArgument(
                "params_file", default_value="", description="ROS 2 parameter file, in the place of a shipped scene."
            ),
        ]
    of_all = [
        DeclareLaunchArgument(name, default_value=default, description=says)
        for name, (default, says) in arguments.items()
    ]
    return LaunchDescription([*of_scene, *of_all, OpaqueFunction(function=_node, args=[list(inputs)])])


def _node(context: LaunchContext, inputs: list[str]) -> list[Any]:
    """The node; InputError where its scene is not there, which the launch says and ends with."""
    given = context.launch_configurations
    file = Path(given["params_file"] or _shipped(given["scene"])).expanduser()
    if not file.is_file():
        raise InputError(f"the parameter file {file} is not there; give params_file:=FILE")
    return [
        Node(
            package="impact_predictor",
            executable="predictor",
            name=LaunchConfiguration("name"),
            namespace=LaunchConfiguration("namespace"),
            output="screen",
            parameters=[str(file), {"use_sim_time": given["use_sim_time"].lower() in ("true", "1")}],
            arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
            remappings=[(name, LaunchConfiguration(name.replace("/", "_"))) for name in inputs],
        )
    ]


def _shipped(scene: str) -> str:
    """The file of a shipped scene, by its name with or without .yaml."""
    folder = find("config")
    scenes = sorted(one.stem for one in folder.glob("*.yaml"))
    if scene.removesuffix(".yaml") not in scenes:
        raise InputError(
            f"there is no shipped scene {scene}, but {', '.join(scenes)}; give params_file:=FILE for others"
        )
    return str(folder / f"{scene.removesuffix('.yaml')}.yaml")
