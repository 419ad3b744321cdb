"""Start the predictor with a scene and the topics of one body.

ros2 launch impact_predictor predictor.launch.py params_file:=my_scene.yaml odom:=/robot/odom
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    scene = PathJoinSubstitution([FindPackageShare("impact_predictor"), "config", "cube_tosses.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("params_file", default_value=scene, description="ROS 2 parameter file of the scene."),
            DeclareLaunchArgument("odom", default_value="odom", description="Topic of the body's state."),
            DeclareLaunchArgument(
                "contact_geometry", default_value="contact_geometry", description="Topic of the body's contact points."
            ),
            Node(
                package="impact_predictor",
                executable="predictor",
                name="impact_predictor",
                output="screen",
                parameters=[LaunchConfiguration("params_file")],
                remappings=[
                    ("odom", LaunchConfiguration("odom")),
                    ("contact_geometry", LaunchConfiguration("contact_geometry")),
                ],
            ),
        ]
    )
